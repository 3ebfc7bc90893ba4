"""Tests of System > Controller through the API, in virtual time: rights to enable, home and send settings,
ends of a home search, restart and shut-down.
"""

import asyncio
import json
import re

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant
from pendant.test_jogging import pressed, rested

from yarclang.pendant.accounts.roles import Role
from yarclang.runtime.actions import Trouble

FAR = -60.0 * 25532.8278
HOME = {"home": [1]}


def with_pin(browser):
    browser.session.pin_until = asyncio.get_running_loop().time() + 300.0
    return browser


def trial(monkeypatch, tmp_path, work, role=Role.SERVICE, **options):
    """Run a test coroutine with a pendant, a user who controls the robot, and the user's socket for jogs."""

    async def whole():
        async with pendant(monkeypatch, tmp_path, patient=True, **options) as place:
            anna = place.logged_in("anna", role)
            assert (await anna.post("/api/control")).told["given"]
            await asyncio.sleep(0.1)
            line = anna.socket("/api/jog")
            try:
                await work(place, anna, line)
            finally:
                await line.close()
                await asyncio.sleep(1.5)
            assert not place.world.moving

    run(whole())


async def unhomed(place, at=FAR):
    motor = place.world.machine.motors[1]
    motor.homed, motor.stand = False, at
    await asyncio.sleep(0.3)
    assert place.coordinator.state.value == "fault"
    return motor


async def states(line, press):
    return [one["state"] for one in line.waiting() if one.get("press") == press]


def test_enabled_by_an_operator_and_written_down(monkeypatch, tmp_path):
    async def work(place, anna, line):
        place.world.machine.motors[2].kill(place.world.machine.now)
        await asyncio.sleep(0.3)
        told = (await anna.order("settings")).told
        assert [one["name"] for one in told["things"] if one["verdict"] == "error"] == ["motor 2"]
        assert (await anna.order("enable")).told == {"ok": True, "what": "", "wrong": []}
        assert place.coordinator.state.value == "stop"
        bea = place.logged_in("bea", Role.OPERATOR)
        refused = await bea.order("disable")
        assert refused.status == 409
        assert "anna" in refused.told["error"]
        guest = place.logged_in("guest", Role.VIEWER)
        for word in ("enable", "disable", "connect", "settings", "homing", "clear"):
            assert (await guest.order(word)).status == 403
        await asyncio.sleep(0.2)
        deeds = [(user, action, outcome) for user, action, _, outcome in place.deeds()]
        assert ("anna", "enable", "done") in deeds
        assert any(one[:2] == ("bea", "disable") and "refused" in one[2] for one in deeds)

    trial(monkeypatch, tmp_path, work, Role.OPERATOR)


def test_what_needs_the_pin(monkeypatch, tmp_path):
    async def work(place, anna, line):
        motor = await unhomed(place)
        sha = (await anna.order("settings")).told["sha256"]
        for word, fields in (
            ("home", {"motors": [1]}),
            ("send-settings", {"known": sha}),
            ("save-settings", {}),
        ):
            refused = await anna.order(word, **fields)
            assert (refused.status, refused.told["code"]) == (403, "pin"), word
            ben = place.logged_in("ben", Role.PROGRAMMER)
            with_pin(ben)
            assert (await ben.order(word, **fields)).told["code"] != "pin"
            assert (await ben.order(word, **fields)).status == 403
        for path in ("/api/system/restart", "/api/system/shut-down"):
            assert (await anna.post(path)).told["code"] == "pin"
            assert (await place.logged_in("ben").post(path)).status == 403
            assert (await place.browser().post(path)).status == 401
        heard = await pressed(line, 1, HOME, 0.4)
        assert next(one for one in heard if one.get("state") == "ended")["code"] == "pin"
        assert not motor.homing
        assert not place.service.life.wanted
        # Malformed lists of motors, and numbers that no motor has, are refused.
        with_pin(anna)
        for motors in ([], [0], [33], [1] * 33, "1", [1.5], None):
            assert (await anna.order("home", motors=motors)).status == 400
        assert (await anna.order("send-settings", known="x" * 65)).status == 400

    trial(monkeypatch, tmp_path, work)


def test_a_search_goes_on_as_long_as_the_button_is_held(monkeypatch, tmp_path):
    async def work(place, anna, line):
        motor = await unhomed(place, FAR / 20)
        with_pin(anna)
        heard = await pressed(line, 1, HOME, 0.5)
        assert place.world.moving
        line.say({"release": 1})
        assert await rested(place.world, 0.5) < 0.3
        assert not motor.homed
        await asyncio.sleep(0.5)
        assert place.coordinator.state.value == "fault"
        # A press that has ended moves nothing any more. A new press begins the search again.
        await pressed(line, 1, HOME, 0.3)
        assert not place.world.moving
        heard = await pressed(line, 2, HOME, 12.0)
        assert "reached" in [one.get("state") for one in heard]
        assert motor.homed
        assert place.coordinator.state.value == "stop"
        assert place.world.stands()[0] == pytest.approx(0.0, abs=1e-3)
        await asyncio.sleep(0.2)
        deeds = [(detail, outcome) for _, action, detail, outcome in place.deeds() if action == "home"]
        assert any("[1]" in detail for detail, _ in deeds)
        assert deeds[-1][1] == "ended"

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    "how", ["silence", "late", "socket", "stop", "logout", "end", "pin", "give", "restart"]
)
def test_what_ends_a_search(monkeypatch, tmp_path, how):
    """A search ends if its page is killed, frozen or behind a slow network, after another user's STOP, and
    with the session.
    """

    async def work(place, anna, line):
        motor = await unhomed(place)
        with_pin(anna)
        await pressed(line, 1, HOME, 1.2)
        assert place.world.moving
        match how:
            case "late":
                beat = (await line.until(lambda message: "beat" in message))["beat"]
                line.say({"press": 1, "beat": beat - 10, **HOME})
            case "socket":
                await line.close()
            case "stop":
                await place.logged_in("guest", Role.VIEWER).order("stop")
            case "logout":
                await anna.post("/api/logout")
            case "end":
                line.say({"release": 1, "end": True})
            case "give":
                bea = place.logged_in("bea", Role.OPERATOR)
                await bea.get("/api/robot")
                await bea.post("/api/control")
                await anna.post("/api/control/give", {"to": bea.session.id})
            case "restart":
                assert (await anna.post("/api/system/restart")).told["code"] == "under-way"
                assert (await anna.post("/api/system/restart", {"stop": True})).status == 200
            case "pin":
                # the PIN expires; a search that has begun continues while the button is held
                anna.session.pin_until = 0.0
                await pressed(line, 1, HOME, 0.5)
                assert place.world.moving
            case _:
                pass
        assert await rested(place.world, 0.8) < 0.55
        await asyncio.sleep(0.5)
        assert not motor.homed
        assert motor.closed
        assert place.coordinator.state.value == "fault"
        assert not place.coordinator.under_way

    trial(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("moment", [0.0, 0.001, 0.005, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3])
def test_let_go_at_any_moment(monkeypatch, tmp_path, moment):
    async def work(place, anna, line):
        await unhomed(place)
        with_pin(anna)
        beat = (await line.until(lambda message: "beat" in message))["beat"]
        line.say({"press": 1, "beat": beat, **HOME})
        await asyncio.sleep(moment)
        line.say({"release": 1})
        await asyncio.sleep(0.6)
        assert not place.world.moving
        assert not place.coordinator.under_way
        await asyncio.sleep(1.0)
        assert not place.world.moving

    trial(monkeypatch, tmp_path, work)


def test_while_a_program_runs_nothing_of_it_is_done(monkeypatch, tmp_path):
    (tmp_path / "p.yarc").write_text("P0010 MOVEJ 40 0 0 0 30 0 [6] (deg,s)\n")

    async def work(place, anna, line):
        with_pin(anna)
        number = (await anna.order("load", file="p.yarc")).told["program"]["number"]
        running = asyncio.ensure_future(anna.order("run", program=number))
        await asyncio.sleep(1.5)
        assert place.world.moving
        sha = "0" * 64
        for word, fields in (
            ("enable", {}),
            ("disable", {}),
            ("home", {"motors": [1]}),
            ("homing", {}),
            ("settings", {}),
            ("send-settings", {"known": sha}),
            ("save-settings", {}),
        ):
            told = await anna.order(word, **fields)
            assert told.status == 409, (word, told.told)
        assert "under way" in (await pressed_once(line, HOME))["why"]
        assert (await anna.post("/api/system/restart")).told["code"] == "under-way"
        assert (await running).told["well"]
        assert place.world.stands()[0] == pytest.approx(40.0, abs=1e-3)
        assert not any(re.fullmatch(r"#\d+(HM|K|J/)|SAVE", text) for _, _, text in place.world.lines)

    trial(monkeypatch, tmp_path, work)


async def pressed_once(line, want):
    heard = await pressed(line, 1, want, 0.3)
    return next(one for one in heard if one.get("state") == "ended")


def test_settings_are_sent_once_and_by_one(monkeypatch, tmp_path):
    async def work(place, anna, line):
        with_pin(anna)
        bea = with_pin(place.logged_in("bea", Role.SERVICE))
        place.world.machine.command("I113=0")
        told = (await anna.order("settings")).told
        (wrong,) = [one for one in told["things"] if one["verdict"] == "error"]
        assert (wrong["name"], wrong["about"]) == ("I113", "positive software limit, counts")
        order = ("send-settings", {"known": told["sha256"]})
        assert "closed-loop" in (await anna.order(order[0], **order[1])).told["error"]
        await anna.order("disable")
        assert "anna" in (await bea.order(order[0], **order[1])).told["error"]
        answers = await asyncio.gather(*(anna.order(order[0], **order[1]) for _ in range(3)))
        assert sorted(one.status for one in answers) == [200, 409, 409]
        assert (await anna.order("enable")).told["wrong"] == []
        assert (await anna.order("save-settings")).status == 200
        await asyncio.sleep(0.2)
        deeds = [(action, outcome) for _, action, _, outcome in place.deeds()]
        assert ("send-settings", f"all {told['lines']} lines") in deeds

    trial(monkeypatch, tmp_path, work)


# the process


def test_restart_and_shut_down(monkeypatch, tmp_path):
    (tmp_path / "p.yarc").write_text("P0010 MOVEJ 40 0 0 0 30 0 [6] (deg,s)\n")

    async def work(place, anna, line):
        life = place.service.life
        with_pin(anna)
        number = (await anna.order("load", file="p.yarc")).told["program"]["number"]
        running = asyncio.ensure_future(anna.order("run", program=number))
        await asyncio.sleep(1.5)
        assert (await anna.post("/api/system/shut-down")).told["code"] == "under-way"
        assert not life.wanted
        answers = await asyncio.gather(
            *(anna.post("/api/system/restart", {"stop": True}) for _ in range(5)),
            anna.post("/api/system/shut-down", {"stop": True}),
        )
        assert not place.world.moving  # the robot comes to rest before the process ends
        assert not (await running).told["well"]
        assert [one.status for one in answers].count(200) == 1
        assert life.wanted
        await asyncio.wait_for(life.ended(), 1.0)
        assert (await anna.post("/api/system/restart")).told["code"] == "busy"
        assert any(action == "restart" for _, action, _, _ in place.deeds())

    trial(monkeypatch, tmp_path, work)


def test_a_restart_that_would_not_start_is_refused(monkeypatch, tmp_path):
    def wouldnt():
        raise Trouble("robot.toml: J1 has no limits", "give them", "Y1302")

    async def work(place, anna, line):
        with_pin(anna)
        monkeypatch.setattr(place.service.life, "_check", wouldnt)
        told = await anna.post("/api/system/restart")
        assert (told.status, told.told["error"]) == (409, "robot.toml: J1 has no limits")
        assert not place.service.life.wanted
        assert (await anna.post("/api/system/shut-down")).status == 200

    trial(monkeypatch, tmp_path, work)


def test_changed_files_wait_for_a_restart(monkeypatch, tmp_path):
    async def work(place, anna, line):
        guest = place.logged_in("guest", Role.VIEWER)

        async def waiting():
            return (await guest.get("/api/system/controller")).told["waiting"]

        assert await waiting() == []
        (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
        assert [one["file"] for one in await waiting()] == ["yarc.toml"]
        (tmp_path / "yarc.toml").unlink()
        assert await waiting() == []
        copied = tmp_path / "robot.toml"
        monkeypatch.setattr(place.service.descriptions, "_described", copied)
        text = (place.world.robot.folder / "robot.toml").read_text()
        robot = place.service.descriptions._robot
        monkeypatch.setattr("yarclang.pendant.life.load_robot", lambda _: _read(copied, robot.folder))
        copied.write_text(text)
        assert await waiting() == []
        copied.write_text(text + "\n# a remark changes nothing\n")
        assert await waiting() == []
        copied.write_text(text.replace("hold_time = ", "hold_time = 1"))
        assert "another robot" in json.dumps(await waiting()) or "loaded" in json.dumps(await waiting())
        copied.write_text("nonsense = [")
        assert "can no longer be loaded" in (await waiting())[0]["what"]

    trial(monkeypatch, tmp_path, work)


def _read(path, folder):
    from yarclang.robot.description import read_robot
    from yarclang.source import SourceFile

    return read_robot(SourceFile(str(path), path.read_text()), folder)
