"""Tests of the beginning of live motions: at once, from the robot's position, and from no other position."""

import asyncio
import re
from contextlib import contextmanager

import numpy as np
import pytest
from coordinator.live.test_drive import keep
from coordinator.live.test_proof import START, H, judge_at, text
from coordinator.virtual import coordinating, done, run
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from yarclang.backend_pmac.live import LIVE
from yarclang.certify.motion.bounds import Cubics
from yarclang.coordinator.live import opening
from yarclang.coordinator.live.generator import Generator, rates_of
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.proof import Judge
from yarclang.coordinator.live.steering import JointVelocity, Steering
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.simulator.commissioning import stand

QUICK = (Phase.explicit, Phase.reuse, Phase.generate)
"""Phases without shrinking: shrinking a session takes longer than reading it."""

SOON = 0.02
"""Longest allowed time from a key to the first motion [s], if replies take at most 0.5 ms and planning takes
no time.
"""


def turning(speed):
    velocity = np.zeros(6)
    velocity[0] = np.deg2rad(speed)
    return JointVelocity(velocity)


async def first_motion(world, client, speed):
    """Jog a joint. Return the time from the key until a motor has moved by two counts [s], and the drive."""
    before, loop = world.machine.positions(motors=[1]), asyncio.get_running_loop()
    begun = loop.time()
    drive = asyncio.ensure_future(client.live.drive(turning(speed)))

    def moved():
        world.catch_up()
        return abs(world.machine.positions(motors=[1]) - before) > 2.0

    await world.until(moved, within=1.0, each=0.0005)
    return loop.time() - begun, (await drive).value


def test_a_jog_moves_at_once_behind_whatever_was_before():
    """A jog moves at once, whatever motion came before. It doesn't begin with a RAPID, which would take 94 ms
    even over a fraction of a count.
    """

    async def session():
        async with coordinating(joints=START) as (world, _, client):
            await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            took, drive = await first_motion(world, client, 5.0)
            assert took < SOON
            for _ in range(3):
                await asyncio.sleep(0.1)
                drive.stop()  # the hold stops the robot between two counts
                await drive.ended()
                await asyncio.sleep(0.1)
                took, drive = await first_motion(world, client, -5.0)
                assert took < SOON
            drive.stop()
            await drive.ended()
            await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            written = "\0".join(line for _, _, line in world.lines).split("\0")
            assert written.count("RAPID") == 2  # one for each of the two commands, none for the jogs

    run(session())


SPEEDS = st.lists(st.floats(-0.5, 0.5), min_size=5, max_size=5)
BESIDE = st.lists(st.floats(-0.5, 0.5), min_size=6, max_size=6)


@contextmanager
def admitted():
    """Return the position at which a live motion begins, and the control points of all lines that its judge
    admits, in order [rad or m].
    """
    points = []

    class Seen(Judge):
        def __init__(self, robot, start, *others, **named):
            super().__init__(robot, start, *others, **named)
            points.append(np.tile(start, (3, 1)))

        def admit(self, lines):
            super().admit(lines)
            points.append(self._points(self._robot, lines))

    opening.Judge = Seen
    try:
        yield points
    finally:
        opening.Judge = Judge


@settings(max_examples=12, deadline=None, phases=QUICK)
@given(BESIDE, SPEEDS, st.sampled_from([0.004, 0.01, 0.02, 0.05]))
def test_what_moves_is_what_was_proved(beside, speeds, segment):
    """Wherever between two counts the motors stand, the robot is on the proved curve from the first instant
    on, to a step of the registers.
    """

    async def session(points):
        async with coordinating(joints=START, record=True) as (world, _, client):
            robot, machine, count = world.robot, world.machine, 8
            stand(machine, robot, START * robot.axis_units + from_counts(robot, np.array(beside)))
            target = JointVelocity(np.array([0.1, *speeds]))
            made = await client.live.drive(target, settings=Settings(segment=segment))
            await world.until(lambda: "R" in [line for _, _, line in world.lines], each=segment / 8.0)
            await keep(made.value, target, (count + 1) * segment)
            made.value.stop()
            await made.value.ended()
            world.catch_up()
            control = np.concatenate(points)[: count + 3]
            curve = Cubics.of_spline(control, np.arange(count), np.full(count, segment))
            row, u = np.repeat(np.arange(count), 8), np.tile(np.arange(8) / 8.0, count)
            proved = curve.take(row).at(u * segment)[0]
            begins = next(at for at, _, line in world.lines if line == "R")
            moved = machine.positions(begins + (row + u) * segment, robot.controller.motors)
            assert np.abs(moved - to_counts(robot, proved)).max() < 1.0 / 3072.0
            assert abs(moved[-1, 0] - moved[0, 0]) > 10.0

    with admitted() as points:
        run(session(points))


@pytest.mark.parametrize(("moved", "begins"), [(0.0, True), (1e-4, True), (3.0, False), (-40.0, False)])
def test_it_begins_only_where_it_was_proved_from(moved, begins):
    """Motor 1 is moved by some counts while the live motion is planned. Then the motion begins only within
    the slack of the proof.
    """

    async def session():
        async with coordinating(joints=START) as (world, coordinator, client):
            plan = coordinator.plan

            async def planned(function, *arguments):
                made = await plan(function, *arguments)
                motor = world.machine.motors[1]
                motor.stand += moved
                world.machine.changed([motor])
                return made

            coordinator.plan = planned
            drive = (await client.live.drive(turning(5.0))).value
            await asyncio.sleep(0.05)
            assert world.moving == begins
            drive.stop()
            ended = await drive.ended()
            if begins:
                assert ended.what == "stopped on its path"
            else:
                assert "the robot doesn't stand where jog starts: J1" in ended.what
                assert ended.remedy == "begin again"
                assert "R" not in [line for _, _, line in world.lines]

    run(session())


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_who_stands_at_a_limit_may_leave_it(side):
    """A robot at a limit may jog away from it, even if it is beyond the limit by up to a step of the
    registers.
    """

    async def session():
        at = np.array([170.0 * side, *START[1:]])
        async with coordinating(joints=at) as (world, _, client):
            motor = world.machine.motors[1]
            for beside in (-2e-4, 0.0, 2e-4, 1e-3):
                motor.stand = to_counts(world.robot, at * world.robot.axis_units)[0] + beside
                world.machine.changed([motor])
                drive = (await client.live.drive(turning(5.0 * side))).value
                await keep(drive, turning(5.0 * side), 0.2)
                assert drive.why == "J1 would go past its limit"
                assert abs(world.stands()[0] - at[0]) < 1e-6
                await keep(drive, turning(-5.0 * side), 1.0)
                assert abs(world.stands()[0] - at[0]) > 1.0
                drive.stop()
                await drive.ended()

    run(session())


def test_where_a_command_has_ended_nearly_is_not_where_a_jog_begins():
    """A command begins at the planned end of the previous command if the robot is within one count of it. A
    jog begins at the robot's own position.
    """

    async def session():
        async with coordinating(joints=START) as (world, _, client):
            await done(client, "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)")
            motor = world.machine.motors[1]
            motor.stand = float(motor.place(world.machine.now)[0]) + 0.8
            world.machine.changed([motor])
            took, drive = await first_motion(world, client, 5.0)
            assert took < SOON
            drive.stop()
            await drive.ended()

    run(session())


def jerking(share):
    """Return points from rest to rest at which J1 uses a share of its jerk limit, with almost no rounding."""
    robot, _ = judge_at()
    step = share * robot.limits.jerk[0] * H**3 / robot.axis_units[0]
    third = np.concatenate([[1, 0, -1, -1, 0, 1], np.zeros(3)]) * step
    points = np.tile(START, (9, 1))
    points[:, 0] += np.cumsum(np.cumsum(np.cumsum(third)))
    return points


def test_what_the_start_may_be_off_by_counts_where_it_matters():
    """The possible deviation of the start matters only for the first segments: a motion at 99 % of the jerk
    limit is refused there, and accepted later.
    """
    robot, judge = judge_at()
    assert judge.objection(text(robot, jerking(0.9)), ()) == ""
    assert "jerk limit" in judge.objection(text(robot, jerking(0.99)), ())
    stands = text(robot, np.tile(START, (3, 1)))
    assert judge.objection((*stands, *text(robot, jerking(0.99))), ()) == ""
    judge.admit(stands)
    assert judge.objection(text(robot, jerking(0.99)), ()) == ""


@settings(max_examples=25, deadline=None, phases=QUICK)
@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6), SPEEDS, st.sampled_from([0.1, 1.0, 20.0]))
def test_all_limits_are_kept_from_wherever_it_may_begin(off, speeds, faster):
    """An admitted text respects the full limits for each start position within the slack."""
    robot, judge = judge_at()
    rates, limits = rates_of(robot), robot.limits
    start, tool = START * robot.axis_units, robot.flange_from_frame["TCP"]
    made = Generator(
        robot,
        start,
        lambda points: LIVE.lines(robot, points, 7),
        H,
        Steering(robot, tool, rates, robot.jog_speed),
        judge,
        rates,
    )
    made.want(JointVelocity(np.array([0.5, *speeds]) * faster), 0.0)
    lines = made.more(0.0, 12)
    made.finish()
    while not made.ended:
        lines += made.more(0.1, 3)
    printed = np.array([[float(word) for word in re.findall(r"[A-Z]([-.\d]+)", line)] for line in lines])
    stands = start + np.array(off) * judge.slack
    control = np.concatenate([np.tile(stands, (3, 1)), printed * robot.axis_units])
    count = len(control) - 3
    curve = Cubics.of_spline(control, np.arange(count), np.full(count, H))
    assert (curve.velocity_peaks() <= limits.velocity).all()
    assert (curve.acceleration_peaks() <= limits.acceleration).all()
    assert (np.abs(curve.j) <= limits.jerk).all()
