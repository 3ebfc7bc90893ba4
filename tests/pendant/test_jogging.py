"""Tests of hold-to-run through the API, in virtual time: the robot moves while a button is pressed, and rests
when the button is released or the page falls silent.
"""

import asyncio

import numpy as np
import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role

TURN = {"velocity": {"J1": 20.0}}


async def pressed(line, press, want, seconds):
    """Send a request for a time, with fresh heartbeats. Return all received messages."""
    loop = asyncio.get_running_loop()
    until = loop.time() + seconds
    heard = line.waiting()
    while loop.time() < until:
        message = await line.hear()
        heard.append(message)
        if "beat" in message:
            line.say({"press": press, "beat": message["beat"], **want})
    return heard


async def rested(world, within=1.0):
    return await world.until(lambda: not world.moving, within)


def trial(monkeypatch, tmp_path, work, **options):
    """Run a test coroutine with a pendant, a programmer who controls the robot, and the programmer's socket
    for jogs.
    """

    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            anna = place.logged_in("anna", Role.PROGRAMMER)
            assert (await anna.post("/api/control")).told["given"]
            await asyncio.sleep(0.1)
            line = anna.socket("/api/jog")
            try:
                await work(place, anna, line)
            finally:
                await line.close()
                await asyncio.sleep(1.0)

    run(whole())


def test_it_moves_as_long_as_it_is_pressed(monkeypatch, tmp_path):
    async def work(place, anna, line):
        await pressed(line, 1, TURN, 0.5)
        assert place.world.moving
        line.say({"release": 1})
        assert await rested(place.world, 0.5) < 0.35
        assert place.world.stands()[0] > 2.0
        await line.until(lambda message: message.get("state") == "ended")
        await asyncio.sleep(0.5)
        assert next(one[1:3] for one in place.deeds() if one[1] == "jog")[1] == (
            '{"velocity":{"J1":20.0},"twist":null,"step":null,"axes":"{B}","moving":"{TCP}","share":1.0}'
        )

    trial(monkeypatch, tmp_path, work)


def test_silence_ends_it(monkeypatch, tmp_path):
    async def work(place, anna, line):
        await pressed(line, 1, TURN, 0.5)
        held = await place.world.until(lambda: place.coordinator.state.value != "move", 2.0)
        assert held <= 0.3
        ended = await line.until(lambda message: message.get("state") == "ended")
        assert "0.2 s" in ended["why"]
        await rested(place.world)
        # The reason is shown on the page Jog. It isn't an alarm, whose bar would shift the buttons.
        page = anna.socket("/api/robot")
        told = await page.until(
            lambda message: message.get("event") == "display" and message["mode"] == "idle"
        )
        assert told["alarm"]["number"] == 0
        await page.close()
        # A press that has ended never moves the robot again.
        before = place.world.stands()
        await pressed(line, 1, TURN, 0.5)
        assert np.allclose(place.world.stands(), before)
        await pressed(line, 2, TURN, 0.5)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_messages_from_before_a_suspension_of_the_process_move_nothing(monkeypatch, tmp_path):
    """While the pendant's process is suspended, it sends no heartbeats. So a page that has died meanwhile has
    left messages with the newest heartbeat.
    """

    async def work(place, anna, line):
        loop = asyncio.get_running_loop()
        before = place.world.stands()
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        loop.virtual += 1.5  # nothing runs in this time
        line.say({"press": 1, "beat": beat, **TURN})
        line.say({"press": 2, "beat": beat, **TURN})
        for press in (1, 2):
            ended = await line.until(lambda message: message.get("state"))
            assert (ended["press"], ended["state"]) == (press, "ended")
            assert "too late" in ended["why"]
        await asyncio.sleep(1.0)
        assert np.allclose(place.world.stands(), before)
        await pressed(line, 3, TURN, 0.5)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_a_stop_before_it_begins_is_respected(monkeypatch, tmp_path):
    """The next jog waits until the previous one has come to rest. It doesn't begin after another user's
    stop.
    """

    async def work(place, anna, line):
        vic = place.logged_in("vic", Role.VIEWER)
        await pressed(line, 1, TURN, 0.5)
        line.say({"release": 1})
        await pressed(line, 2, TURN, 0.1)
        assert (await vic.order("stop")).status == 200
        heard = await pressed(line, 2, TURN, 0.5)
        assert [one["state"] for one in heard if one.get("press") == 2] == ["ended"]
        assert not place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_a_closed_page_ends_it(monkeypatch, tmp_path):
    async def work(place, anna, line):
        await pressed(line, 1, TURN, 0.5)
        await line.close()
        assert await rested(place.world, 0.5) < 0.35

    trial(monkeypatch, tmp_path, work)


def test_the_end_of_the_session_ends_it(monkeypatch, tmp_path):
    async def work(place, anna, line):
        await pressed(line, 1, TURN, 0.5)
        assert (await anna.post("/api/logout")).status == 200
        assert await rested(place.world, 0.5) < 0.35
        with pytest.raises(AssertionError, match="4401"):
            await line.until(lambda message: False)
        assert place.coordinator.owner == ""

    trial(monkeypatch, tmp_path, work)


def test_messages_that_come_late_move_nothing(monkeypatch, tmp_path):
    """A network delays all messages for a second, and then delivers them at once."""

    async def work(place, anna, line):
        await line.until(lambda message: message.get("beat", 0) >= 10)
        before = place.world.stands()
        for number in range(20):
            line.say({"press": 1 + number // 10, "beat": 3, **TURN})
        ended = await line.until(lambda message: message.get("state") == "ended")
        assert "too late" in ended["why"]
        await asyncio.sleep(0.5)
        assert np.allclose(place.world.stands(), before)

    trial(monkeypatch, tmp_path, work)


def test_a_heartbeat_of_the_future_moves_nothing(monkeypatch, tmp_path):
    async def work(place, anna, line):
        before = place.world.stands()
        line.say({"press": 1, "beat": 10**9, **TURN})
        await line.until(lambda message: message.get("state") == "ended")
        await asyncio.sleep(0.5)
        assert np.allclose(place.world.stands(), before)

    trial(monkeypatch, tmp_path, work)


def test_let_go_before_it_began(monkeypatch, tmp_path):
    async def work(place, anna, line):
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        before = place.world.stands()
        line.say({"press": 1, "beat": beat, **TURN})
        line.say({"release": 1})
        await asyncio.sleep(1.0)
        assert np.allclose(place.world.stands(), before, atol=0.05)
        assert not place.world.moving
        await pressed(line, 2, TURN, 0.5)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_a_second_press_ends_nothing_and_begins_nothing(monkeypatch, tmp_path):
    """While a press is under way, a second press on the same line isn't started. (A page joins all held
    buttons into one press.)
    """

    async def work(place, anna, line):
        await pressed(line, 1, TURN, 0.3)
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        line.say({"press": 2, "beat": beat, "velocity": {"J2": 20.0}})
        ended = await line.until(lambda message: message.get("state") == "ended")
        assert ended["press"] == 2
        assert "already" in ended["why"]
        await rested(place.world)
        assert abs(place.world.stands()[1]) < 0.01

    trial(monkeypatch, tmp_path, work)


def test_a_second_page_of_the_same_person_takes_nothing_over(monkeypatch, tmp_path):
    """Two pages of a user hold a jog button. After a STOP, a page moves the robot only if its button has been
    released and pressed again.
    """

    async def work(place, anna, line):
        second = anna.socket("/api/jog")
        await pressed(line, 1, TURN, 0.4)
        heard = await pressed(second, 1, TURN, 0.2)
        assert any("another of your pages is jogging" in one.get("why", "") for one in heard)
        await pressed(line, 1, TURN, 0.2)
        assert (await anna.order("stop")).status == 200
        for _ in range(4):
            await pressed(line, 1, TURN, 0.2)
            await pressed(second, 1, TURN, 0.2)
        await rested(place.world)
        before = place.world.stands()
        await pressed(second, 1, TURN, 0.4)
        await pressed(line, 1, TURN, 0.4)
        assert np.allclose(place.world.stands(), before)
        await pressed(second, 2, TURN, 0.5)
        assert place.world.moving
        await second.close()

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    ("step", "axes", "joint"),
    [
        ({"axis": "J3", "by": 1.0}, "{B}", 2),
        ({"axis": "z", "by": -10.0}, "{B}", None),
        ({"axis": "a", "by": 1.0}, "{TCP}", None),
    ],
)
def test_a_step_goes_so_far_and_no_farther(monkeypatch, tmp_path, step, axes, joint):
    async def work(place, anna, line):
        before = (await anna.order("where")).told
        heard = []
        press = 1
        while not any(one.get("state") == "reached" for one in heard):
            heard += await pressed(line, press, {"step": step, "axes": axes}, 0.2)
        await rested(place.world)
        await asyncio.sleep(0.5)
        # The step is complete, so the same press moves nothing more.
        await pressed(line, press, {"step": step, "axes": axes}, 0.3)
        assert not place.world.moving
        after = (await anna.order("where")).told
        old, new = np.array(before["pose"]), np.array(after["pose"])
        if joint is not None:
            assert after["joints"]["J3"] - before["joints"]["J3"] == pytest.approx(1.0, abs=0.005)
        elif step["axis"] == "z":
            assert (new - old)[:3, 3] * 1e3 == pytest.approx([0.0, 0.0, -10.0], abs=0.05)
        else:
            turned = old[:3, :3].T @ new[:3, :3]
            assert np.degrees(np.arctan2(turned[2, 1], turned[2, 2])) == pytest.approx(1.0, abs=0.01)
            assert np.allclose(new[:3, 3], old[:3, 3], atol=5e-5)

    trial(monkeypatch, tmp_path, work, joints=[10.0, 5.0, 20.0, 10.0, 30.0, 0.0])


def test_what_keeps_it_is_said(monkeypatch, tmp_path):
    async def work(place, anna, line):
        heard = await pressed(line, 1, {"velocity": {"J1": 60.0}}, 2.0)
        assert any("J1" in one["why"] for one in heard if one.get("state") == "moves")
        line.say({"release": 1})
        await rested(place.world)
        assert place.world.stands()[0] <= 170.0

    trial(monkeypatch, tmp_path, work, joints=[160.0, 0.0, 0.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("role", "what"),
    [(Role.VIEWER, "for programmers"), (Role.OPERATOR, "for programmers"), (Role.PROGRAMMER, "take control")],
)
def test_who_may_not_moves_nothing(monkeypatch, tmp_path, role, what):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            somebody = place.logged_in("eve", role)
            line = somebody.socket("/api/jog")
            before = place.world.stands()
            beat = (await line.until(lambda message: "beat" in message))["beat"]
            line.say({"press": 1, "beat": beat, **TURN})
            ended = await line.until(lambda message: message.get("state") == "ended")
            assert what in f"{ended['why']} {ended['help']}"
            await asyncio.sleep(0.5)
            assert np.allclose(place.world.stands(), before)
            await line.close()

    run(whole())


@pytest.mark.parametrize(
    "text",
    ["", "[]", "null", "{", '{"press": 0, "beat": 1}', '{"press": 1}',
        '{"press": 1, "beat": 1, "velocity": {"J1": 1e400}}',
     '{"press": 1, "beat": 1, "twist": [1]}', '{"press": 1, "beat": 1, "share": 2}', '{"release": "x"}',
         "[" * 100_000],
)  # fmt: skip
def test_what_isnt_understood_is_said(monkeypatch, tmp_path, text):
    async def work(place, anna, line):
        line.say(text)
        assert (await line.until(lambda message: "ok" in message))["ok"] is False
        await pressed(line, 1, TURN, 0.4)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)
