"""Tests of a controller that isn't ready: the coordinator runs, nothing moves, motors are enabled and homed,
and settings are compared and sent.
"""

import asyncio
from pathlib import Path

import numpy as np
import pytest
from coordinator.virtual import World, coordinating, done, planned_here, run

from yarclang.coordinator.attached import Here
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.messages import orders, replies
from yarclang.coordinator.ordered import OrderedSession
from yarclang.pmac.variables import HOMING, HOMING_PLC
from yarclang.runtime.actions import Trouble
from yarclang.runtime.pmac import homing

J1 = 25532.8278


def trial(work, prepare=lambda world: None, **options):
    """Run a test with a patient coordinator, its owner, and a controller that `prepare` has changed."""

    async def whole():
        world = World(**options)
        prepare(world)
        async with coordinating(world=world, patient=True) as (_, coordinator, client):
            client.session.leave()
            here = Here(coordinator, "anna")
            here.send(orders.Own())
            await work(world, coordinator, here)
            await asyncio.sleep(1.5)
            assert not world.moving

    run(whole())


def killed(*motors):
    def prepare(world):
        for motor in motors:
            world.machine.motors[motor].kill(world.machine.now)

    return prepare


def unhomed(*motors, at=2.0):
    """Return a function that makes motors unhomed, each `at` [counts] away from its home flag."""

    def prepare(world):
        for motor in motors:
            world.machine.motors[motor].homed = False
            world.machine.motors[motor].stand = at

    return prepare


async def asked(here, order):
    return await asyncio.wait_for(here.ask(order), 400.0)


async def held(here, order, seconds):
    """Send an order and confirm it for a time. Return the task that waits for its reply."""
    task = asyncio.ensure_future(here.ask(order))
    until = asyncio.get_running_loop().time() + seconds
    while asyncio.get_running_loop().time() < until and not task.done():
        here.send(orders.Keep())
        await asyncio.sleep(0.05)
    return task


async def ended(task):
    """Return the reply of a task, or the error that the connection was lost."""
    try:
        return await asyncio.wait_for(task, 10.0)
    except Trouble as trouble:
        if "connection" not in trouble.what:
            raise
        return trouble


def test_it_is_there_and_nothing_moves_until_the_motors_are_enabled():
    async def work(world, coordinator, here):
        assert coordinator.state.value == "fault"
        with pytest.raises(Trouble, match="fault"):
            await done(here.client, "MOVEJ 10 0 0 0 0 0 [2] (deg,s)")
        told = await asked(here, orders.AskSettings())
        assert {one.name for one in told.things if one.verdict == "error"} == {"motor 2", "motor 5"}
        assert not (await asked(here, orders.AskHealth())).guard
        before = world.stands()
        told = await asked(here, orders.Enable())
        assert (told.what, told.wrong) == ("", ())
        assert coordinator.state.value == "stop"
        assert (await asked(here, orders.AskHealth())).guard
        assert np.allclose(world.stands(), before)
        await done(here.client, "MOVEJ 10 0 0 0 0 0 [2] (deg,s)")
        assert world.stands()[0] == pytest.approx(10.0, abs=1e-3)

    trial(work, killed(2, 5))


def test_today_it_refuses_to_start():
    async def whole():
        world = World()
        killed(2)(world)
        with pytest.raises(Trouble, match="motor 2"):
            async with coordinating(world=world):
                pass

    run(whole())


def test_a_motor_that_runs_away_as_its_loop_closes_is_told_and_the_rest_stays_open():
    async def work(world, coordinator, here):
        motor = world.machine.motors[2]
        close = motor.close

        def slips(time):
            close(time)
            motor.disturbance = 7000.0  # 0.27 deg, as if the encoder had slipped

        motor.close = slips
        told = await asked(here, orders.Enable())
        assert "motor 2" in told.what
        assert coordinator.state.value == "fault"
        assert not world.machine.motors[5].closed

    trial(work, killed(2, 5))


@pytest.mark.parametrize("how", ["fault", "deactivated", "watcher", "moving", "program"])
def test_what_is_not_enabled(how):
    async def work(world, coordinator, here):
        if how == "fault":
            world.machine.fault_amplifier(2)
            assert "amplifier" in (await asked(here, orders.Enable())).what
        elif how == "deactivated":
            world.machine.command("I200=0")
            assert "I200" in (await asked(here, orders.Enable())).what
        elif how == "watcher":
            with pytest.raises(Trouble, match="anna"):
                await asked(Here(coordinator, "bob"), orders.Enable())
        elif how == "moving":
            world.machine.command("#1J+")
            with pytest.raises(Trouble, match="motor 1 moves"):
                await asked(here, orders.Enable())
            world.machine.command("#1J/")
        else:
            world.machine.command("&1 DEFINE ROT 100")
            world.machine.command("&1B0")
            world.machine.motors[2].close(world.machine.now)
            world.machine.command("&1R")
            with pytest.raises(Trouble, match="program"):
                await asked(here, orders.Enable())
            return
        assert not world.machine.motors[2].closed
        assert coordinator.state.value == "fault"

    trial(work, killed(2))


def test_disabled_it_is_a_fault_until_it_is_enabled():
    async def work(world, coordinator, here):
        told = await asked(here, orders.Disable())
        assert told.what == ""
        assert not any(motor.closed for motor in world.machine.motors.values())
        assert coordinator.state.value == "fault"
        await asyncio.sleep(1.0)
        assert coordinator.why == "the motors were disabled"
        assert (await asked(here, orders.Enable())).wrong == ()
        assert coordinator.state.value == "stop"

    trial(work)


# homing searches


def test_a_search_goes_on_as_long_as_it_is_held():
    async def work(world, coordinator, here):
        (first, second, *_), _ = (await asked(here, orders.AskHoming())).searches, None
        assert (first.unit, first.refused, first.homed) == ("deg", "", False)
        assert "coupled" in second.refused
        assert coordinator.state.value == "fault"
        task = await held(here, orders.Home(motors=(1,)), 1.0)
        (told,) = [one.position for one in (await asked(here, orders.AskStatus())).joints if one.name == "J1"]
        assert told == pytest.approx(world.stands()[0], abs=0.2)
        assert told > -2.9
        assert not task.done() or task.result().well is False
        await asyncio.sleep(1.0)
        task = await held(here, orders.Home(motors=(1,)), 60.0)
        ended = task.result()
        assert ended.well, ended
        assert world.machine.motors[1].homed
        assert coordinator.state.value == "stop"
        assert world.stands()[0] == pytest.approx(0.0, abs=1e-3)
        assert world.machine.command(f"LIST PLC {HOMING_PLC}").items == ("RETURN",)
        await done(here.client, "MOVEJ 10 0 0 0 0 0 [2] (deg,s)")

    trial(work, unhomed(1, at=-3.0 * J1))


def test_several_are_homed_in_their_order():
    async def work(world, coordinator, here):
        ended = (await held(here, orders.Home(motors=(6, 1, 4)), 60.0)).result()
        assert ended.well, ended
        told = [text.split()[0] for _, _, text in world.lines if text.endswith("HM")]
        assert told == ["#6HM", "#1HM", "#4HM"]
        assert coordinator.state.value == "stop"

    trial(work, unhomed(1, 4, 6, at=30000.0))


@pytest.mark.parametrize("how", ["let go", "stop", "abort", "hold", "other", "leave", "unplug", "slow"])
def test_what_ends_a_search(how):
    """However the client that holds the button fails, the motor comes to rest at once, and isn't ready."""

    async def work(world, coordinator, here):
        task = await held(here, orders.Home(motors=(1,)), 2.0)
        assert world.moving
        match how:
            case "stop":
                Here(coordinator, "bob").send(orders.Stop())
            case "abort":
                Here(coordinator, "bob").send(orders.Abort())
            case "hold":
                here.send(orders.Hold())
            case "other":
                Here(coordinator, "bob")
                here.send(orders.Give(to="bob"))
            case "leave":
                await here.leave()
            case "unplug":
                world.unplug()
            case "slow":
                world.delay = lambda: 3.0
            case _:
                pass
        took = await world.until(lambda: not world.moving, 1.3)
        assert took < {"let go": 0.35, "unplug": 0.6, "slow": 0.6}.get(how, 0.2)
        if how in ("unplug", "slow"):
            world.plug()
            world.delay = lambda: 0.001
        assert not isinstance(await ended(task), replies.Ended) or not task.result().well
        await world.until(lambda: coordinator.state.value == "fault", 10.0)
        await asyncio.sleep(1.0)
        assert not world.moving
        assert not world.machine.motors[1].homed
        assert world.machine.motors[1].closed

    trial(work, unhomed(1, at=60.0 * J1))


def test_nobody_lives_who_could_stop_a_search():
    """If the computer and its connection are dead, the controller's own PLC stops the motor."""

    async def work(world, coordinator, here):
        await held(here, orders.Home(motors=(1,)), 1.0)
        assert world.moving
        world.unplugged = True  # no data arrives any more, and the connection isn't closed either
        assert await world.until(lambda: not world.moving, 2.0) < coordinator.engine.operation.silence + 0.2
        assert world.machine.command(HOMING).items == ("2",)
        world.unplug()
        world.plug()
        await world.until(lambda: not coordinator.engine.lost and coordinator.engine.inspection.errors, 10.0)
        assert coordinator.state.value == "fault"

    trial(work, unhomed(1, at=60.0 * J1))


@pytest.mark.parametrize(
    "how",
    [
        "watcher",
        "coupled",
        "open",
        "stopped",
        "no speed",
        "too fast",
        "running",
        "taken",
        "plcs",
        "unknown",
        "fatal",
        "never",
    ],
)
def test_what_is_not_homed(how, monkeypatch):
    async def work(world, coordinator, here):
        machine, motors, match = world.machine, (1,), ""
        if how == "watcher":
            with pytest.raises(Trouble, match="anna"):
                await asked(Here(coordinator, "bob"), orders.Home(motors=(1,)))
            return
        if how == "running":
            assert (await held(here, orders.Home(motors=(1,)), 60.0)).result().well
            made = await here.client.motion.offer("MOVEJ 30 0 0 0 0 0 [3] (deg,s)")
            moving = asyncio.ensure_future(here.client.motion.go(made.value))
            await asyncio.sleep(1.0)
            with pytest.raises(Trouble, match="under way"):
                await asked(here, orders.Home(motors=(1,)))
            assert (await moving).well
            return
        if how == "unknown":
            with pytest.raises(Trouble, match="no motor 9"):
                await asked(here, orders.Home(motors=(1, 9)))
            return
        match how:
            case "coupled":
                motors, match = (2,), "coupled"
            case "open":
                machine.motors[5].kill(machine.now)
                match = "open-loop"
            case "stopped":
                task = asyncio.ensure_future(here.ask(orders.Home(motors=(1,))))
                await asyncio.sleep(0.0)
                here.send(orders.Stop())
                assert not (await task).well
                assert not any(text.endswith("HM") for _, _, text in world.lines)
                return
            case "no speed":
                machine.command("I123=0")
                match = "Ixx23|I123"
            case "too fast":
                machine.command("I123=9000")
                match = "limit"
            case "taken":
                for line in (f"OPEN PLC {HOMING_PLC} CLEAR", "P1=P1+1", "CLOSE"):
                    machine.command(line)
                match = "has a foreign program"
            case "plcs":
                machine.command("I5=0")
                match = "PLC"
            case "fatal":
                machine.command("I111=16")
                match = "following error"
            case "never":
                monkeypatch.setattr(homing, "_RESERVE", 0.1)  # otherwise the wait would take two minutes
                machine.motors[1].home = lambda time: machine.motors[1].jog(time, 1)
                machine.command("I113=0")
                machine.command("I122=0.001")
                match = "within"
        ended = (await held(here, orders.Home(motors=motors), 400.0)).result()
        assert not ended.well
        assert ended.what is not None
        assert any(one in f"{ended.what} {ended.help}" for one in match.split("|")), ended
        assert coordinator.state.value == "fault"
        if how == "fatal":
            await asyncio.sleep(1.0)
            assert not machine.motors[1].closed  # the loop of a killed motor isn't closed automatically
        if how == "taken":
            assert machine.command(f"LIST PLC {HOMING_PLC}").items[0].startswith("P1=P1+1")

    trial(work, unhomed(1, at=3.0 * J1))


# settings


def blank(world):
    """Reset the controller to the state in which it was delivered, without settings of a robot."""
    world.machine.initialise()
    for motor in world.robot.controller.motors:
        world.machine.command(f"I{motor}00=1")


async def sending(here):
    told = await asked(here, orders.AskSettings())
    return told, orders.SendSettings(known=told.sha256)


def test_a_blank_controller_gets_ready():
    async def work(world, coordinator, here):
        assert coordinator.state.value == "fault"
        told, send = await sending(here)
        wrong = {one.name for one in told.things if one.verdict == "error"}
        assert {"I113", "PLC 0", "PLC 29", "axis definition of motor 1", "motor 1"} <= wrong
        assert next(one for one in told.things if one.name == "I113").about.startswith("positive software")
        sent = await asked(here, send)
        assert (sent.sent, sent.what) == (sent.of, "")
        assert sent.of == told.lines
        assert all(one.startswith("motor") for one in sent.wrong)
        await asked(here, orders.SaveSettings())
        assert world.machine._saved is not None
        assert (await asked(here, orders.Enable())).what == ""
        for motor in world.robot.controller.motors:
            world.machine.command(f"#{motor}HMZ")
        await here.client.motion.clear()
        assert coordinator.state.value == "stop"

    trial(work, blank)


@pytest.mark.parametrize("how", ["closed", "others", "watcher", "scale", "error", "stop", "unplug"])
def test_settings_that_are_not_sent_or_in_part(how):
    async def work(world, coordinator, here):
        _, send = await sending(here)
        machine = world.machine
        if how == "closed":
            with pytest.raises(Trouble, match="closed-loop"):
                await asked(here, send)
            return
        await asked(here, orders.Disable())
        if how == "others":
            with pytest.raises(Trouble, match="compare"):
                await asked(here, orders.SendSettings(known="0" * 64))
            assert not any(text.startswith("#1->2") for _, _, text in world.lines)
            return
        if how == "watcher":
            with pytest.raises(Trouble, match="anna"):
                await asked(Here(coordinator, "bob"), send)
            return
        if how == "scale":
            machine.command("I108=32")
            with pytest.raises(Trouble, match="I108"):
                await asked(here, send)
            return
        count = 0
        answer = machine.command

        def refuses(line, port=0):
            nonlocal count
            if not line.startswith("P1=M162"):
                return answer(line, port)
            count += 1
            if how == "error":
                return answer("NONSENSE!", port)
            if how == "stop":
                Here(coordinator, "bob").send(orders.Stop())
                return answer(line, port)
            world.unplug()
            return answer(line, port)

        machine.command = refuses
        sent = await ended(asyncio.ensure_future(here.ask(send)))
        if isinstance(sent, Trouble):
            assert how == "unplug"
        else:
            assert 0 < sent.sent < sent.of
            assert ("ERR" if how == "error" else "person") in sent.what
        machine.command = answer
        world.plug()
        await asyncio.sleep(2.0)
        assert count == 1
        assert not coordinator.engine.lost
        assert coordinator.state.value == "fault"
        assert not any(port.open for port in machine.ports.values())
        assert any("PLC 0" in one for one in (await asked(here, orders.Look())).wrong)
        with pytest.raises(Trouble, match="fault"):
            await done(here.client, "MOVEJ 10 0 0 0 0 0 [2] (deg,s)")
        # When the settings are sent again, they are complete.
        sent = await asked(here, send)
        assert sent.sent == sent.of
        assert (await asked(here, orders.Enable())).wrong == ()
        assert coordinator.state.value == "stop"

    trial(work)


def test_two_people_send_at_once():
    async def work(world, coordinator, here):
        _, send = await sending(here)
        await asked(here, orders.Disable())
        told = await asyncio.gather(here.ask(send), here.ask(send), return_exceptions=True)
        assert sorted(type(one).__name__ for one in told) == ["SettingsSent", "Trouble"]

    trial(work)


# the connection


def test_a_controller_that_isnt_there_yet_is_waited_for():
    async def whole():
        world = World()
        world.unplug()
        session = OrderedSession("sim", 1025, connector=world.connect)
        async with Coordinator(
            world.robot, session, log=NO_LOG, folder=Path(), plan=planned_here, patient=True
        ) as coordinator:
            here = Here(coordinator, "anna")
            here.send(orders.Own())
            assert coordinator.state.value == "disconnected"
            await asyncio.sleep(3.0)
            assert "reached" in (await here.ask(orders.AskHealth())).link
            for order in (orders.Connect(), orders.Enable(), orders.AskSettings(), orders.Home(motors=(1,))):
                with pytest.raises(Trouble, match="connection"):
                    await asked(here, order)
            world.plug()
            await asked(here, orders.Connect())
            assert coordinator.state.value == "stop"
            assert (await here.ask(orders.AskHealth())).link == ""
            await asked(here, orders.Connect())  # does nothing, since there is a connection

    run(whole())


def test_a_bug_of_ours_ends_a_search():
    async def work(world, coordinator, here):
        with pytest.MonkeyPatch.context() as patch:
            task = await held(here, orders.Home(motors=(1,)), 1.0)
            assert world.moving
            patch.setattr("yarclang.runtime.pmac.homing.sample", lambda *_: 1 / 0)
            with pytest.raises(ZeroDivisionError):
                await task
        assert not world.moving
        assert world.machine.motors[1].closed
        assert not coordinator.engine.operation.searches
        assert coordinator.state.value == "fault"

    trial(work, unhomed(1, at=60.0 * J1))
