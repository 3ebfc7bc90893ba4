"""Tests of hold-to-run of an offer through the API, in virtual time: the robot moves while the button is
held, rests on its path in between, and other actions end the motion.
"""

import asyncio
import json

import numpy as np
import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant
from pendant.test_jogging import TURN, pressed, rested, trial

from yarclang.coordinator.attached import Here
from yarclang.coordinator.messages import orders
from yarclang.pendant.accounts.roles import Role

GOAL = [20.0, 10.0, 0.0, 0.0, 0.0, 0.0]
WAY = "MOVEJ 20 10 0 0 0 0 [4] (deg,s)"


async def offered(anna, text=WAY):
    told = (await anna.order("offer", text=text)).told
    assert told["offer"] is not None, told
    return told["offer"]["number"]


def off_the_line(place):
    """Return the distance of the robot from the straight path to the goal [deg]."""
    stands, goal = place.world.stands(), np.array(GOAL)
    along = stands @ goal / (goal @ goal)
    return float(np.abs(stands - along * goal).max())


def states(heard, press):
    return [one["state"] for one in heard if one.get("press") == press]


async def held_once(place, anna, line, seconds=1.5):
    """Hold an offer for a time, then release it. Return the number of the offer."""
    number = await offered(anna)
    await pressed(line, 1, {"go": number}, seconds)
    assert place.world.moving
    line.say({"release": 1})
    assert await rested(place.world, 0.8) < 0.6
    return number


async def stays(place, seconds=1.0):
    before = place.world.stands()
    await asyncio.sleep(seconds)
    assert np.allclose(place.world.stands(), before)
    assert not place.world.moving


def test_it_goes_while_it_is_held_and_goes_on_along_its_path(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await held_once(place, anna, line)
        assert place.coordinator.state.value == "hold"
        assert off_the_line(place) < 0.01
        assert 0.5 < place.world.stands()[0] < 15.0
        await stays(place)
        heard, press = [], 2
        while "reached" not in states(heard, press) and press < 12:
            press += 1
            heard = await pressed(line, press, {"go": number}, 0.9)
            assert off_the_line(place) < 0.01
            line.say({"release": press})
            await rested(place.world)
        assert place.world.stands() == pytest.approx(GOAL, abs=1e-3)
        assert place.coordinator.state.value == "stop"
        # The motion is complete: neither the same press nor the same offer moves the robot again.
        await pressed(line, press, {"go": number}, 0.3)
        heard = await pressed(line, press + 1, {"go": number}, 0.4)
        assert "ended" in states(heard, press + 1)
        assert place.world.stands() == pytest.approx(GOAL, abs=1e-3)
        await asyncio.sleep(0.3)
        deeds = [
            (action, outcome) for _, action, detail, outcome in place.deeds() if action in ("go", "resume")
        ]
        assert deeds[0] == ("go", deeds[0][1])
        assert ("go", "ended") in deeds
        assert any(action == "resume" for action, _ in deeds)
        assert WAY in next(detail for _, action, detail, _ in place.deeds() if action == "go")

    trial(monkeypatch, tmp_path, work)


def test_silence_rests_and_the_press_is_over(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await offered(anna)
        await pressed(line, 1, {"go": number}, 1.5)
        assert await place.world.until(lambda: not place.world.moving, 2.0) < 0.9
        ended = await line.until(lambda message: message.get("state") == "ended")
        assert "0.2 s" in ended["why"]
        await pressed(line, 1, {"go": number}, 0.5)
        assert not place.world.moving
        await pressed(line, 2, {"go": number}, 0.6)
        assert place.world.moving
        assert off_the_line(place) < 0.01

    trial(monkeypatch, tmp_path, work)


def test_the_coordinator_has_a_watchdog_of_its_own(monkeypatch, tmp_path):
    """The pendant's process hangs, its connection stays open, and no message arrives. The coordinator's own
    watchdog brings the robot to rest.
    """

    async def work(place, anna, line):
        await held_once(place, anna, line)
        line.say({"release": 1, "end": True})
        await place.world.until(lambda: not place.coordinator.under_way)
        assert (await anna.order("release")).status == 200
        here = Here(place.coordinator, "hanging")
        await here.ask(orders.Own())
        told = await here.ask(orders.Offer(text="MOVEJ 0 0 0 0 0 0 [6] (deg,s)"))
        going = asyncio.create_task(here.ask(orders.Go(offer=told.offer.number, held=True)))
        for _ in range(20):
            await asyncio.sleep(0.05)
            here.send(orders.Keep())
        assert place.world.moving
        assert await rested(place.world, 1.2) < 1.0
        # After a `resume` from another client, the robot moves only until the watchdog's next check.
        before = place.world.stands()
        here.send(orders.Resume())
        await asyncio.sleep(1.0)
        assert not place.world.moving
        assert np.abs(place.world.stands() - before).max() < 1.0
        here.send(orders.Keep())
        here.send(orders.Resume())
        await asyncio.sleep(0.15)
        # The new owner of the robot doesn't hold the button, so the motion ends.
        await here.ask(orders.Give(to=place.service.seats.name(anna.session)))
        assert not (await asyncio.wait_for(going, 5.0)).well
        await rested(place.world)

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("moment", [0.0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2])
def test_let_go_at_any_moment(monkeypatch, tmp_path, moment):
    """Release the button before the motion begins, while it begins, or just after."""

    async def work(place, anna, line):
        number = await offered(anna)
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        line.say({"press": 1, "beat": beat, "go": number})
        if moment:
            await asyncio.sleep(moment)
        line.say({"release": 1})
        await asyncio.sleep(1.2)
        assert not place.world.moving
        assert np.abs(place.world.stands()).max() < 0.5
        await stays(place)
        # A new press continues the motion, or the page is told that a new offer is needed.
        heard = await pressed(line, 2, {"go": number}, 1.0)
        assert place.world.moving or "ended" in states(heard, 2)

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("how", ["page", "socket", "stop", "logout", "jog", "another"])
def test_what_ends_it(monkeypatch, tmp_path, how):
    """A motion that is held or rests on its path is ended for good by leaving the page, another press, STOP,
    or the end of the session.
    """

    async def work(place, anna, line):
        number = await held_once(place, anna, line)
        press = 2
        match how:
            case "page":
                line.say({"release": 1, "end": True})
            case "socket":
                await line.close()
            case "stop":
                guest = place.logged_in("guest", Role.VIEWER)
                assert (await guest.order("stop")).status == 200
            case "logout":
                assert (await anna.post("/api/logout")).status == 200
            case "jog":
                heard = await pressed(line, 2, TURN, 0.8)
                assert "moves" in states(heard, 2)
                line.say({"release": 2})
                press = 3
            case "another":
                told = (await anna.order("offer", text="MOVEJ 0 0 0 0 0 0 [2] (deg,s)")).told
                assert (
                    told.get("ok") is not True or told["offer"] is None
                )  # nothing can be planned during a motion
                heard = await pressed(line, 2, {"go": 999_999}, 0.4)
                assert any("no offer" in one.get("why", "") for one in heard)
                press = 3
        await place.world.until(lambda: not place.coordinator.under_way, 3.0)
        await rested(place.world)
        await stays(place, 0.5)
        if how in ("socket", "logout"):
            return
        heard = await pressed(line, press, {"go": number}, 0.5)
        assert "ended" in states(heard, press)
        await stays(place, 0.5)

    trial(monkeypatch, tmp_path, work)


def test_somebody_elses_stop_while_it_is_held(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await offered(anna)
        await pressed(line, 1, {"go": number}, 1.0)
        assert (await anna.order("stop")).status == 200
        heard = await pressed(line, 1, {"go": number}, 1.0)
        assert "ended" in states(heard, 1)
        assert "stopped" in next(one["why"] for one in heard if one.get("state") == "ended")
        await rested(place.world)
        before = place.world.stands()
        await pressed(line, 1, {"go": number}, 0.5)
        assert np.allclose(place.world.stands(), before)

    trial(monkeypatch, tmp_path, work)


def test_somebody_elses_hold_needs_a_new_press(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await offered(anna)
        await pressed(line, 1, {"go": number}, 1.0)
        assert (await anna.order("hold")).status == 200
        await pressed(line, 1, {"go": number}, 1.0)
        assert not place.world.moving
        line.say({"release": 1})
        await pressed(line, 2, {"go": number}, 0.6)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_late_messages_and_a_second_page(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await offered(anna)
        await line.until(lambda message: message.get("beat", 0) >= 10)
        for beat in (3, 10**9):
            for _ in range(5):
                line.say({"press": 1 + (beat > 3), "beat": beat, "go": number})
        await asyncio.sleep(0.5)
        assert np.allclose(place.world.stands(), 0.0)
        second = anna.socket("/api/jog")
        await pressed(line, 5, {"go": number}, 1.0)
        heard = await pressed(second, 1, {"go": number}, 0.15)
        assert any("another of your pages is jogging" in one.get("why", "") for one in heard)
        line.say({"release": 5})
        await rested(place.world)
        # The robot rests on the path of the first page's motion. The second page can neither continue nor end
        # this motion.
        for press, want in ((2, {"go": number}), (3, TURN)):
            heard = await pressed(second, press, want, 0.3)
            assert any("under way" in one.get("why", "") for one in heard)
        await stays(place, 0.3)
        await second.close()
        await pressed(line, 6, {"go": number}, 0.6)
        assert place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_it_is_planned_from_where_the_robot_stands(monkeypatch, tmp_path):
    """An offer can't be carried out if the robot has moved since it was planned."""

    async def work(place, anna, line):
        number = await offered(anna)
        await pressed(line, 1, TURN, 0.6)
        line.say({"release": 1})
        await rested(place.world)
        await asyncio.sleep(0.3)
        before = place.world.stands()
        heard = await pressed(line, 2, {"go": number}, 0.5)
        assert any("isn't any more at the position" in one.get("why", "") for one in heard)
        assert np.allclose(place.world.stands(), before)

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR, Role.PROGRAMMER])
def test_who_may_not_moves_nothing(monkeypatch, tmp_path, role):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            somebody = place.logged_in("eve", role)
            line = somebody.socket("/api/jog")
            heard = await pressed(line, 1, {"go": 1}, 0.4)
            told = " ".join(f"{one['why']} {one['help']}" for one in heard if one.get("state") == "ended")
            assert ("take control" if role is Role.PROGRAMMER else "for programmers") in told
            assert np.allclose(place.world.stands(), 0.0)
            await line.close()

    run(whole())


def test_an_audit_trail_that_cant_be_written_moves_nothing(monkeypatch, tmp_path):
    async def work(place, anna, line):
        from yarclang.runtime.actions import Trouble

        number = await offered(anna)
        database = place.service.accounts.database

        async def broken(*arguments, **named):
            raise Trouble("the audit trail can't be written", "make room", "")

        monkeypatch.setattr(database, "call", broken)
        heard = await pressed(line, 1, {"go": number}, 0.5)
        monkeypatch.undo()
        assert any("audit trail" in one.get("why", "") for one in heard)
        assert np.allclose(place.world.stands(), 0.0)

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("go", [0, -1, 1.5, "1", None, [1], 10**400])
def test_what_is_no_offer(monkeypatch, tmp_path, go):
    async def work(place, anna, line):
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        line.say(json.dumps({"press": 1, "beat": beat, "go": go}))
        told = await line.until(lambda message: message.get("ok") is False or "state" in message)
        assert told.get("ok") is False or told["state"] == "ended"
        assert np.allclose(place.world.stands(), 0.0)

    trial(monkeypatch, tmp_path, work)


def test_a_stop_while_the_audit_trail_is_written_cancels_it(monkeypatch, tmp_path):
    async def work(place, anna, line):
        vic = place.logged_in("vic", Role.VIEWER)
        number = await offered(anna)
        place.slow_disk(monkeypatch, 2.0)
        await pressed(line, 1, {"go": number}, 1.0)
        assert (await vic.order("stop")).status == 200
        heard = await pressed(line, 1, {"go": number}, 2.0)
        assert states(heard, 1)[-1] == "ended"
        assert not place.world.moving
        # The same for its continuation.
        await pressed(line, 2, {"go": number}, 3.5)
        assert place.world.moving
        line.say({"release": 2})
        await rested(place.world)
        assert place.coordinator.state.value == "hold"
        await pressed(line, 3, {"go": number}, 1.0)
        assert (await vic.order("stop")).status == 200
        await pressed(line, 3, {"go": number}, 2.0)
        assert not place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_a_press_stays_what_it_has_begun_as(monkeypatch, tmp_path):
    async def work(place, anna, line):
        number = await offered(anna)
        await pressed(line, 1, {"go": number}, 1.0)
        assert place.world.moving
        heard = await pressed(line, 1, TURN, 1.0)
        assert states(heard, 1)[-1] == "ended"
        assert not place.world.moving
        assert off_the_line(place) < 0.01
        await pressed(line, 2, TURN, 1.0)  # the socket still serves
        assert place.world.moving
        await pressed(line, 2, {"go": number}, 1.0)
        assert not place.world.moving

    trial(monkeypatch, tmp_path, work)
