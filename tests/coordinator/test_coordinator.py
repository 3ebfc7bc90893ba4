"""Tests of the coordinator against the simulator, in virtual time: offers, motions, stops,
ownership, events.
"""

import asyncio

import numpy as np
import pytest
from coordinator.virtual import World, codes, coordinating, done, run

from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.lines import read_event
from yarclang.coordinator.ownership import NotOwner
from yarclang.runtime.actions import Trouble
from yarclang.runtime.state import State

MOVE = "MOVEJ 10 0 0 0 20 0 [1] (deg,s)"


def test_a_line_is_offered_and_then_carried_out():
    async def session():
        async with coordinating() as (world, coordinator, client):
            made = await client.motion.offer(MOVE)
            offer = made.value
            assert offer.duration == pytest.approx(1.0)
            assert [one.title for one in offer.motions] == ["P0010 MOVEJ"]
            assert 0.0 < offer.motions[0].proved.velocity.share < 1.0
            assert offer.end / world.robot.axis_units == pytest.approx([10, 0, 0, 0, 20, 0])
            assert world.stands() == pytest.approx(np.zeros(6), abs=1e-4)  # an offer moves nothing
            ended = await client.motion.go(offer)
            assert ended.well
            assert world.stands() == pytest.approx([10, 0, 0, 0, 20, 0], abs=1e-4)
            assert coordinator.state is State.STOP

    run(session())


def test_each_line_is_planned_from_where_the_robot_stands():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, "DMOVEJ 5 0 0 0 30 0 [1] (deg,s)")
            await done(client, "P0010 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)")
            line = await done(client, "DMOVE {TCP} 0 0 -30 0 0 0 [2] (mm,deg,s) {B}")
            assert line.start / world.robot.axis_units == pytest.approx([10, 0, 0, 0, 30, 0], abs=1e-3)

    run(session())


def test_declarations_stay():
    async def session():
        async with coordinating() as (_, coordinator, client):
            await done(client, "DEFAULT {TCP} [50%] (mm,deg,s) {B}")
            await done(client, "JOINTS READY 0 10 10 0 30 0 (deg)")
            await done(
                client, "LET N = 2\nSUB NOD\n  DMOVEJ 0 0 0 0 10 0 [1]\n  DMOVEJ 0 0 0 0 -10 0 [1]\nEND"
            )
            await done(client, "MOVEJ READY")
            nods = await done(client, "REPEAT $N\n  CALL NOD\nEND")
            assert len(nods.motions) == 4
            again = await client.motion.offer("JOINTS READY 0 0 0 0 0 0 (deg)")
            assert again.value is None
            assert codes(again) == ["Y0206"]
            assert len(coordinator.lines.declarations) == 4

    run(session())


def test_findings_have_their_places_in_the_line():
    async def session():
        async with coordinating() as (_, _, client):
            await done(client, "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nJOINTS READY 0 10 10 0 30 0 (deg)")
            made = await client.motion.offer("MOVEJ REDY")
            assert made.value is None
            (found,) = made.diagnostics
            assert (found.code, found.span.line, found.span.column) == ("Y0205", 1, 7)
            assert found.source.text == "MOVEJ REDY\n"
            made = await client.motion.offer("MOVEJ 200 0 0 0 0 0")
            assert [(one.code, one.span.line, one.span.column) for one in made.diagnostics] == [
                ("Y0502", 1, 7)
            ]

    run(session())


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("MOVEX 1", "Y0202"),
        ("START 0 0 0 0 0 0 (deg)", "Y1615"),
        ("ROBOT TRACKED_MANIPULATOR", "Y1392"),
        ("MOVEJ 10 0 0 0 0 0 [0.05] (deg,s)", "Y0601"),
        ("REPEAT 3\n  MOVEJ 10 0 0 0 0 0 [1] (deg,s)", "Y0113"),
        ("MOVEL {TCP} 0 5000 0 0 0 0 [1] (mm,deg,s) {B}", "Y0501"),
        ("\x00", "Y0101"),
    ],
)
def test_a_wrong_line_is_found_and_nothing_moves(text, code):
    async def session():
        async with coordinating() as (world, coordinator, client):
            made = await client.motion.offer(text)
            assert made.value is None
            assert any(one.is_error for one in made.diagnostics), made
            found = [one.code for one in made.diagnostics]
            assert found[0][:3] == code[:3], found
            assert not coordinator.lines.declarations
            assert not any("OPEN ROT" in line for _, _, line in world.lines)

    run(session())


@pytest.mark.parametrize("text", ["", "   ", "! only a comment"])
def test_an_empty_line_offers_nothing(text):
    async def session():
        async with coordinating() as (_, _, client):
            made = await client.motion.offer(text)
            assert (made.value, made.diagnostics) == (None, ())

    run(session())


@pytest.mark.parametrize("after", [0.0, 0.005, 0.02, 0.5, 1.0])
def test_a_stop_overtakes_everything(after):
    async def session():
        async with coordinating() as (world, coordinator, client):
            offer = (await client.motion.offer("MOVEJ 30 0 0 0 20 0 [2] (deg,s)")).value
            going = asyncio.create_task(client.motion.go(offer))
            await asyncio.sleep(after)
            client.motion.stop()
            took = await world.until(lambda: not world.moving)
            assert took <= world.robot.controller.hold_time + 0.05
            ended = await going
            assert not ended.well
            assert coordinator.state is State.STOP
            stood = world.stands()
            await asyncio.sleep(2.0)
            assert world.stands() == pytest.approx(stood, abs=1e-6)
            # the next motion begins at the position of the stop
            await done(client, "MOVEJ 0 0 0 0 0 0 [2] (deg,s)")

    run(session())


def test_hold_and_resume():
    async def session():
        async with coordinating() as (world, coordinator, client):
            offer = (await client.motion.offer(MOVE)).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            client.motion.hold()
            await world.until(lambda: coordinator.state is State.HOLD and not world.moving)
            client.motion.resume()
            assert (await going).well
            assert world.stands() == pytest.approx([10, 0, 0, 0, 20, 0], abs=1e-4)

    run(session())


def test_an_abort_ends_it():
    async def session():
        async with coordinating() as (world, _, client):
            offer = (await client.motion.offer(MOVE)).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            await asyncio.sleep(0.3)
            client.motion.abort()
            ended = await going
            assert (ended.well, ended.what) == (False, "aborted: off its path")

    run(session())


def test_the_override_holds_for_what_comes():
    async def session():
        async with coordinating() as (world, coordinator, client):
            client.motion.override(50.0)
            since = world.machine.now
            await done(client, MOVE)
            assert world.machine.now - since > 1.9
            assert coordinator.override == pytest.approx(50.0)
            with pytest.raises(Trouble, match="an override of 0 %"):
                client.motion.override(0.0)

    run(session())


def test_one_owns_the_robot_and_all_others_watch():
    async def session():
        async with coordinating() as (world, coordinator, client):
            other = coordinator.attach("pendant")
            with pytest.raises(NotOwner, match="test owns the robot; pendant can only watch") as refused:
                other.session.own()
            assert refused.value.code == "Y1611"
            offer = (await other.motion.offer(MOVE)).value  # every client may ask for an offer
            for wanted in (other.motion.go(offer), other.motion.clear(), other.signals.set("X", 1.0)):
                with pytest.raises(NotOwner):
                    await wanted
            for wanted in (
                other.motion.resume,
                lambda: other.motion.override(50.0),
                lambda: other.session.give("test"),
            ):
                with pytest.raises(NotOwner):
                    wanted()
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            other.motion.stop()  # every client may stop
            assert not (await going).well
            client.session.give("pendant")
            assert (other.session.owns, client.session.owns) == (True, False)
            with pytest.raises(NotOwner, match="there is no client 'nobody'"):
                other.session.give("nobody")
            other.session.release()
            client.session.own()

    run(session())


def test_who_goes_away_leaves_the_robot_at_rest():
    async def session():
        async with coordinating() as (world, coordinator, client):
            offer = (await client.motion.offer(MOVE)).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            client.session.leave()
            await world.until(lambda: not world.moving, within=0.5)
            assert coordinator.owner == ""
            assert not (await going).well
            coordinator.attach("next").session.own()

    run(session())


def test_what_was_offered_before_does_not_hold_for_ever():
    async def session():
        async with coordinating() as (_, _, client):
            old = (await client.motion.offer(MOVE)).value
            await done(client, "MOVEJ 5 0 0 0 0 0 [1] (deg,s)")
            with pytest.raises(Trouble, match="isn't any more at the position") as refused:
                await client.motion.go(old)
            assert refused.value.code == "Y1613"
            old = (await client.motion.offer(MOVE)).value
            await done(client, "LET A = 1")
            with pytest.raises(Trouble, match="a declaration was added"):
                await client.motion.go(old)

    run(session())


def test_while_it_moves_nothing_else_begins():
    async def session():
        async with coordinating() as (world, _, client):
            offer = (await client.motion.offer(MOVE)).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            for wanted in (
                client.motion.offer(MOVE),
                client.motion.go(offer),
                client.motion.where(),
                client.motion.clear(),
            ):
                with pytest.raises(Trouble, match="is under way") as refused:
                    await wanted
                assert refused.value.code == "Y1612"
            assert (await going).well

    run(session())


def test_events_tell_what_happens():
    async def session():
        async with coordinating() as (_, _, client):
            with client.session.events() as stream:
                await done(client, MOVE)
                told = [event async for event in _until(stream, events.Finished)]
            names = [one.event for one in told]
            states = [one.state for one in told if isinstance(one, events.StateChanged)]
            assert states == [State.INIT, State.MOVE, State.STOP]
            assert names[0] == "began"
            assert names.count("began") == 1
            assert all(read_event(one.to_json()) == one for one in told)

    run(session())


async def _until(stream, kind):
    async for event in stream:
        yield event
        if isinstance(event, kind):
            return


def test_positions_come_fifty_times_a_second():
    async def session():
        async with coordinating() as (world, _, client):
            offer = (await client.motion.offer("MOVEJ 10 0 0 0 20 0 [2] (deg,s)")).value
            stream = client.session.events()
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            count, since = 0, world.machine.now
            while not going.done():
                if isinstance(await stream.next(), events.Position):
                    count += 1
            assert count / (world.machine.now - since) == pytest.approx(50.0, rel=0.15)

    run(session())


def test_a_slow_client_slows_nothing_and_knows_what_it_missed():
    async def session():
        async with coordinating() as (world, coordinator, client):
            slow = client.session.events(capacity=8)
            for number in range(40):
                coordinator.tell(f"message {number}")
            since = world.machine.now
            await done(client, "MOVEJ 10 0 0 0 20 0 [2] (deg,s)")
            assert world.machine.now - since < 2.2
            waiting = slow.waiting()
            assert len(waiting) <= 9
            missed = [one.count for one in waiting if isinstance(one, events.Missed)]
            told = [one for one in waiting if not isinstance(one, events.COALESCED)]
            # Forty messages, three states, a beginning and an end.
            assert sum(missed) + len(told) - len(missed) >= 45

    run(session())


def test_a_lost_connection_is_made_again():
    async def session():
        async with coordinating() as (world, coordinator, client):
            world.unplug()
            await world.until(lambda: coordinator.state is State.DISCONNECTED)
            with pytest.raises(Trouble, match="no connection"):
                await client.motion.offer(MOVE)
            world.plug()
            await world.until(lambda: coordinator.state is State.STOP)
            await done(client, MOVE)

    run(session())


def test_a_connection_that_is_lost_in_motion_leaves_it_at_rest_and_a_fault():
    async def session():
        async with coordinating() as (world, coordinator, client):
            offer = (await client.motion.offer("MOVEJ 60 0 0 0 20 0 [6] (deg,s)")).value
            going = asyncio.create_task(client.motion.go(offer))
            await world.until(lambda: world.moving)
            await asyncio.sleep(1.0)
            world.unplug()
            await asyncio.sleep(3.0)
            assert not world.moving  # the guard PLC has stopped the robot
            world.plug()
            ended = await going
            assert not ended.well
            assert coordinator.state is State.FAULT
            with pytest.raises(Trouble, match="after a fault the controller must be checked"):
                await client.motion.go((await client.motion.offer(MOVE)).value)
            await client.motion.clear()
            await done(client, MOVE)

    run(session())


def test_a_fault_at_rest_is_seen():
    async def session():
        async with coordinating() as (world, coordinator, client):
            world.machine.command("#2K", 9)
            await world.until(lambda: coordinator.state is State.FAULT, within=1.0)
            with pytest.raises(Trouble, match="checks failed"):
                await client.motion.clear()
            world.machine.command("#2J/", 9)
            await client.motion.clear()
            await done(client, MOVE)

    run(session())


def test_outputs_are_set_and_inputs_read():
    async def session():
        async with coordinating() as (world, _, client):
            await done(client, "OUTPUT GRIP M1 OFF\nINPUT DOOR M11")
            assert (await client.signals.set("GRIP", "ON")).value == 1.0
            assert world.machine.command("M1", 9).items == ("1",)
            world.machine.command("M11=1", 9)
            assert (await client.signals.read("DOOR")).value == 1.0
            missing = await client.signals.read("DOR")
            assert missing.value is None
            assert missing.diagnostics

    run(session())


def test_where_tells_joints_and_pose():
    async def session():
        async with coordinating() as (_, _, client):
            await done(client, "FRAME {TABLE} 100 200 300 0 0 0 (mm,deg) {B}")
            home = (await client.motion.where()).value
            assert home.base_from_moving[:3, 3] == pytest.approx([0.0, 1.1744, 1.764], abs=1e-6)
            there = (await client.motion.where("{TABLE}")).value
            assert there.base_from_moving[:3, 3] == pytest.approx([-0.1, 0.9744, 1.464], abs=1e-6)
            assert (await client.motion.where("{TABEL}")).value is None

    run(session())


def test_several_machines_begin_where_they_stand():
    async def session():
        async with coordinating(joints=[1, 2, 3, 4, 5, 6]) as (world, _, client):
            await done(client, "DMOVEJ 1 1 1 1 1 1 [1] (deg,s)")
            assert world.stands() == pytest.approx([2, 3, 4, 5, 6, 7], abs=1e-3)

    run(session())


def test_the_world_can_be_made():
    async def session():
        assert not World().moving

    run(session())
