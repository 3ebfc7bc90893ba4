"""Tests of live motions against the simulator, in virtual time."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest
from coordinator.virtual import World, codes, coordinating, done, run

from yarclang.coordinator.attached import Here
from yarclang.coordinator.live.steering import JointVelocity, Master, Twist
from yarclang.coordinator.messages import orders, wants
from yarclang.runtime.actions import Trouble
from yarclang.runtime.state import State

READY = [0, 10, 10, 0, 40, 0]
DEG = np.pi / 180.0


def joint(number, speed):
    velocity = np.zeros(6)
    velocity[number - 1] = speed * DEG
    return JointVelocity(velocity)


async def keep(drive, target, seconds, rate=50.0):
    """Send a target repeatedly for a time."""
    loop = asyncio.get_running_loop()
    until = loop.time() + seconds
    while loop.time() < until and drive.alive:
        drive.want(target)
        await asyncio.sleep(1.0 / rate)


def test_a_joint_is_jogged_as_long_as_it_is_wanted():
    async def session():
        async with coordinating(joints=READY, record=True) as (world, coordinator, client):
            began = world.machine.now
            drive = (await client.live.drive(joint(3, 5.0))).value
            took = await world.until(lambda: world.moving, each=0.001)
            assert took < 0.12
            await keep(drive, joint(3, 5.0), 2.0)
            assert coordinator.state is State.MOVE
            drive.stop()
            took = await world.until(lambda: not world.moving, each=0.001)
            assert took <= world.robot.controller.hold_time + 0.02
            ended = await drive.ended()
            assert (ended.well, ended.what) == (False, "stopped on its path")
            moved = world.stands() - READY
            assert moved[2] == pytest.approx(10.0, abs=1.2)
            assert np.abs(np.delete(moved, 2)).max() < 1e-3
            within_limits(world, began)
            await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")

    run(session())


def within_limits(world, since, speed=0.25):
    """Check each velocity, acceleration and tool speed of the recorded motion, except during holds."""
    from yarclang.robot.actuation import from_counts
    from yarclang.robot.kinematics.fk import tool_poses

    world.catch_up()
    times = np.arange(since, world.machine.now, 0.002)
    counts = world.machine.positions(times, world.robot.controller.motors)
    q = from_counts(world.robot, counts)
    limits = world.robot.limits
    rate = np.diff(q, axis=0) / 0.002
    assert (np.abs(rate) <= limits.velocity * (1.0 + 1e-3)).all()
    place = tool_poses(world.robot.chain, q, world.robot.flange_from_frame["TCP"])[:, :3, 3]
    assert np.linalg.norm(np.diff(place, axis=0), axis=1).max() / 0.002 <= speed * 1.001


def test_nobody_says_anything_and_it_rests():
    async def session():
        async with coordinating(joints=READY) as (world, _, client):
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 1.0)
            took = await world.until(lambda: not world.moving, each=0.002)
            assert took <= 0.2 + world.robot.controller.hold_time + 0.05
            assert not (await drive.ended()).well
            with pytest.raises(Trouble, match="the live motion has ended"):
                drive.want(joint(1, 5.0))

    run(session())


def test_a_drive_that_finishes_rests_within_the_limits():
    async def session():
        async with coordinating(joints=READY) as (world, coordinator, client):
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 1.0)
            drive.finish()
            ended = await drive.ended()
            assert ended.well
            assert coordinator.state is State.STOP
            assert world.stands() == pytest.approx(ended.joints / world.robot.axis_units, abs=1e-3)
            assert not any("H" in line for _, _, line in world.lines if line.startswith("&1H"))

    run(session())


@pytest.mark.parametrize("axes", ["base", "tool"])
def test_a_twist_moves_the_tool_along_its_axis(axes):
    async def session():
        async with coordinating(joints=[10, 10, 10, 30, 60, 0], record=True) as (world, _, client):
            before = (await client.motion.where()).value.base_from_moving
            since = world.machine.now
            target = Twist(np.array([0.0, 0.0, -0.05]), np.zeros(3), axes)
            drive = (await client.live.drive(target)).value
            await keep(drive, target, 2.0)
            drive.stop()
            await drive.ended()
            after = (await client.motion.where()).value.base_from_moving
            way = after[:3, 3] - before[:3, 3]
            axis = np.array([0, 0, 1.0]) if axes == "base" else before[:3, 2]
            assert way @ axis == pytest.approx(-0.1, abs=0.015)
            assert np.linalg.norm(way - (way @ axis) * axis) < 1.5e-3
            assert np.abs(after[:3, :3] - before[:3, :3]).max() < 2e-3
            within_limits(world, since)

    run(session())


def test_the_tool_is_never_faster_than_250_mm_a_second():
    async def session():
        async with coordinating(joints=READY, record=True) as (world, _, client):
            since = world.machine.now
            drive = (await client.live.drive(joint(1, 60.0))).value
            await keep(drive, joint(1, 60.0), 2.0)
            drive.stop()
            await drive.ended()
            within_limits(world, since)
            assert world.stands()[0] > 10.0

    run(session())


def test_the_robot_says_how_fast_the_tool_may_be():
    async def session():
        world = World(joints=READY, record=True)
        world.robot = replace(world.robot, jog_speed=0.05)
        async with coordinating(world=world) as (_, _, client):
            since = world.machine.now
            drive = (await client.live.drive(joint(1, 60.0))).value
            await keep(drive, joint(1, 60.0), 1.0)
            drive.stop()
            await drive.ended()
            within_limits(world, since, speed=0.05)
            assert world.stands()[0] > 0.5

    run(session())


def test_it_rests_in_front_of_a_joint_limit_and_goes_back():
    async def session():
        async with coordinating(joints=[165, 10, 10, 0, 40, 0]) as (world, _, client):
            events = client.session.events()
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 3.0)
            assert 169.9 < world.stands()[0] <= 170.0
            assert any("J1 would go past its limit" in getattr(one, "text", "") for one in events.waiting())
            await keep(drive, joint(1, -5.0), 2.0)
            assert world.stands()[0] < 165.0
            drive.stop()
            await drive.ended()

    run(session())


def test_a_singularity_is_approached_slowly_and_left_freely():
    async def session():
        async with coordinating(joints=[0, 10, 10, 0, 20, 0]) as (world, _, client):
            turn = Twist(np.zeros(3), np.array([-0.2, 0.0, 0.0]))
            drive = (await client.live.drive(turn)).value
            await keep(drive, turn, 4.0)
            near = world.stands()[4]
            assert abs(near) < 10.0
            back = Twist(np.zeros(3), np.array([0.2, 0.0, 0.0]))
            await keep(drive, back, 2.0)
            assert abs(world.stands()[4]) > abs(near) + 5.0
            drive.stop()
            await drive.ended()

    run(session())


CELL = """
units = "mm,deg"
[[obstacles]]
name = "WALL"
shape = "box"
frame = "B"
xyz = [600, 1174, 1000]
size = [200, 1000, 2000]
margin = 20

[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
xyz = [0, 0, 1600]
"""


@pytest.mark.parametrize(
    ("way", "why"),
    [([0.2, 0.0, 0.0], "too close to WALL"), ([0.0, 0.0, -0.2], "the zone FLOOR would be violated")],
)
def test_it_rests_in_front_of_what_is_around_it_and_goes_away_from_it(tmp_path, way, why):
    (tmp_path / "cell.toml").write_text(CELL)

    async def session():
        async with coordinating(joints=READY, folder=tmp_path) as (world, _, client):
            await done(client, 'CELL "cell.toml"')
            events = client.session.events()
            there = Twist(np.array(way), np.zeros(3))
            drive = (await client.live.drive(there)).value
            await keep(drive, there, 6.0)
            near = world.stands()
            await keep(drive, there, 0.5)
            assert world.stands() == pytest.approx(near, abs=1e-4)
            texts = [getattr(one, "text", "") for one in events.waiting()]
            assert any(why in text for text in texts), texts
            back = Twist(-np.array(way), np.zeros(3))
            await keep(drive, back, 1.5)
            assert np.abs(world.stands() - near).max() > 2.0
            drive.stop()
            await drive.ended()

    run(session())


def test_a_master_is_followed_with_bounded_lag():
    async def session():
        async with coordinating(joints=READY, record=True) as (world, _, client):
            loop = asyncio.get_running_loop()
            start = np.array(READY) * DEG
            since = loop.time()

            def master(now):
                phase = 2.0 * np.pi * 0.2 * (now - since)
                swing = np.array([8.0, 3.0, 3.0, 0.0, 5.0, 0.0]) * DEG
                # The amplitude grows within a second, so that the motion begins at rest.
                grown = min(1.0, (now - since) ** 2)
                return start + grown * swing * np.sin(phase), grown * swing * np.cos(
                    phase
                ) * 2.0 * np.pi * 0.2

            began = world.machine.now
            drive = (await client.live.drive(Master(*master(loop.time())))).value
            times, wanted = [], []
            while loop.time() < since + 8.0:
                drive.follow(*master(loop.time()))
                times.append(world.machine.now)
                wanted.append(master(loop.time())[0])
                await asyncio.sleep(0.02)
                world.catch_up()
            drive.finish()
            assert (await drive.ended()).well
            within_limits(world, began)
            from yarclang.robot.actuation import from_counts

            lag = 0.36
            late = np.array(times)[(np.array(times) > began + 3.0) & (np.array(times) < times[-1] - lag)]
            real = from_counts(
                world.robot, world.machine.positions(late + lag, world.robot.controller.motors)
            )
            asked = np.array([np.interp(late, times, column) for column in np.array(wanted).T]).T
            assert np.abs(real - asked).max() / DEG < 0.7

    run(session())


@pytest.mark.parametrize("moment", [0.0, 0.02, 0.04, 0.06, 0.1, 0.4])
def test_a_stop_at_any_moment(moment):
    async def session():
        async with coordinating(joints=READY) as (world, coordinator, client):
            beginning = asyncio.create_task(client.live.drive(joint(1, 5.0)))
            await asyncio.sleep(moment)
            client.motion.stop()
            made = await beginning
            assert not (await made.value.ended()).well
            assert not world.moving
            assert coordinator.state is State.STOP
            await done(client, "MOVEJ 0 0 0 0 0 0 [4] (deg,s)")

    run(session())


def test_a_process_that_sleeps_is_held_by_the_guard():
    async def session():
        async with coordinating(joints=READY) as (world, coordinator, client):
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 1.0)
            slow = world.delay
            # this delay is less than the longest allowed time of a reply, but more than the duration of the
            # buffered lines
            world.delay = lambda: 0.6
            await asyncio.sleep(1.5)
            world.delay = slow
            await drive.ended()
            assert not world.moving
            assert coordinator.state in (State.STOP, State.FAULT)

    run(session())


def test_who_gives_the_robot_away_steers_it_no_more():
    async def session():
        async with coordinating(joints=READY) as (world, coordinator, client):
            other = coordinator.attach("other")
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 0.5)
            client.session.give("other")
            with pytest.raises(Trouble, match="other owns the robot"):
                drive.want(joint(1, 5.0))
            await world.until(lambda: not world.moving, within=0.6)
            await drive.ended()
            await done(other, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")

    run(session())


def test_a_live_motion_is_logged(tmp_path):
    from yarclang.report.runs.log import read_run
    from yarclang.report.runs.planned import planned_motion

    async def session():
        async with coordinating(joints=READY, log=tmp_path / "jog.mcap") as (_, _, client):
            drive = (await client.live.drive(joint(1, 5.0))).value
            await keep(drive, joint(1, 5.0), 0.5)
            drive.stop()
            await drive.ended()
            await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")

    run(session())
    found = read_run(str(tmp_path / "jog.mcap"))
    assert found.value is not None, found.diagnostics
    assert not [one for one in found.diagnostics if one.is_error]
    (told,) = planned_motion(found.value).diagnostics
    assert "this run was a jog or followed a master, and has no plan to compare with" in told.message


def test_what_cannot_be_driven():
    async def session():
        async with coordinating(joints=READY) as (_, coordinator, client):
            other = coordinator.attach("other")
            with pytest.raises(Trouble, match="to move the robot is for"):
                await other.live.drive(joint(1, 5.0))
            with pytest.raises(Trouble, match="isn't finite"):
                await client.live.drive(joint(1, np.nan))
            assert codes(await client.live.drive(joint(1, 5.0), moving="{NOWHERE}")) == ["Y0301"]
            drive = (await client.live.drive(joint(1, 5.0))).value
            with pytest.raises(Trouble, match="there is no joint J9"):
                drive.joint("J9", 0.1)
            with pytest.raises(Trouble, match="jog is under way"):
                await client.live.drive(joint(1, 5.0))
            drive.stop()
            await drive.ended()

    run(session())


def test_worlds_are_quiet():
    async def session():
        assert not World(joints=READY).moving

    run(session())


@pytest.mark.parametrize("order", [orders.Stop(), orders.Hold(), orders.Abort()], ids=lambda one: one.order)
def test_a_master_that_goes_on_speaking_does_not_undo_a_stop(order):
    async def session():
        async with coordinating(joints=READY) as (world, coordinator, client):
            client.session.leave()
            master, other = Here(coordinator, "master"), Here(coordinator, "other")
            await master.ask(orders.Own())
            want = wants.MoveJoints(velocity={"J1": 5.0})

            async def goes_on(times):
                """Send the target several times. Return two values: True if it was denied, and True if
                anything moved.
                """
                denied = moved = False
                for _ in range(times):
                    try:
                        await master.ask(want)
                    except Trouble as trouble:
                        denied = denied or "stopped or held" in trouble.what
                    await asyncio.sleep(0.02)
                    moved = moved or world.moving
                return denied, moved

            assert await goes_on(40) == (False, True)
            other.send(order)
            await world.until(lambda: not coordinator.under_way)
            assert await goes_on(100) == (True, False)
            await master.ask(wants.Finish())  # now the master accepts the stop
            assert await goes_on(20) == (False, True)

    run(session())
