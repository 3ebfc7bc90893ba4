"""Tests of holds, stops, aborts and the override at any moment and with any delays. After a stop the robot
rests on its path without delay.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from runtime.virtual import (
    example_of,
    moved_along,
    path_of,
    prepared,
    stopped_at_once,
    well_behaved,
    world_of,
)

from yarclang.robot.actuation import from_counts, to_counts
from yarclang.runtime.notices import Abort, Changed, Fail, Hold, Override, Resume, Stop
from yarclang.runtime.pmac.messages import Ask, Control, Write
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.state import State

ORDERS = st.one_of(
    st.sampled_from([Hold(), Hold(), Resume(), Resume(), Stop(), Abort(), Fail("the disk is full")]),
    st.integers(1, 100).map(lambda percent: Override(float(percent))),
)
TIMED = st.lists(st.tuples(st.floats(0.0, 6.0), ORDERS), max_size=6)


def run(world, job):
    ended = world.perform(perform(world.operation, job))
    well_behaved(world)
    stopped_at_once(world)
    assert world.refused == [], "the buffer never overflows"
    assert not world.moving
    return ended


def lands(world, job, ended):
    """Check that the robot stands still, and at the reported position."""
    stands = world.stands(job.robot)
    world.machine.advance(2.0)
    world.now = world.machine.now
    assert world.stands(job.robot) == pytest.approx(stands, abs=1e-6)
    assert to_counts(job.robot, ended.joints) == pytest.approx(stands, abs=0.01)


def goes_again(world, job):
    """Check that a new run is possible, after an approach."""
    world.at.clear()
    world.stall_at.clear()
    if world.operation.state is State.FAULT:
        world.prepare(job.robot)
    if np.abs(world.stands(job.robot) - to_counts(job.robot, job.start)).max() > 0.01:
        assert world.approach(job.robot, job.start).well
    assert run(world, job).well
    assert np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() <= 1.0


@exercises(well=0.1)
@settings(max_examples=20)
@given(
    TIMED,
    st.sampled_from([5, 10, 20, 50]),
    st.sampled_from([0.0005, 0.005, 0.02, 0.05]),
    st.lists(st.tuples(st.floats(2.0, 6.0), st.floats(0.1, 4.0)), max_size=1),
    st.integers(0, 2**32),
)
def test_whatever_is_ordered_whenever(tally, orders, tm, delay, stalls, seed):
    job, plan = prepared(tm=tm)
    world = world_of(job, record=True, seed=seed)
    world.delay = lambda: world.random.uniform(0.0, delay)
    since = world.now
    for after, order in orders:
        world.order(order, after)
    # Make sure that every run ends.
    for after in (7.0, 9.0, 12.0):
        world.order(Override(100.0), after)
        world.order(Resume(), after)
    world.stall_at = [(since + after, seconds) for after, seconds in stalls]
    ended = run(world, job)
    lands(world, job, ended)
    if "aborted" not in ended.what:
        assert moved_along(world, job, plan, since, step=0.02) < 1.0
    kinds = {type(order) for _, order in orders}
    tally.count("well", ended.well)
    if ended.well:
        assert world.stands(job.robot) == pytest.approx(to_counts(job.robot, job.end), abs=1.0)
    else:
        assert kinds & {Stop, Abort, Fail, Hold}
        assert ("aborted" in ended.what) <= (Abort in kinds)
        assert world.operation.state is (State.FAULT if "disk" in ended.what else State.STOP)
        goes_again(world, job)


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
@pytest.mark.parametrize("at", [3.3, 11.1])
def test_a_stop_is_on_the_path_of_the_examples(robot, at):
    job, plan = example_of(robot, tm=20)
    world = world_of(job, record=True, delay=0.01)
    since = world.now
    world.order(Stop(), at)
    ended = run(world, job)
    lands(world, job, ended)
    assert ended.what == "stopped on its path"
    assert path_of(plan).distance(world.stands(job.robot)) < 1.0
    assert moved_along(world, job, plan, since + 0.5, step=0.02) < 1.0
    (command,) = [each for each in job.commands if each.begins <= ended.done < each.ends]
    assert (ended.command, ended.command_index) == (command.title, command.index)
    # The robot brakes within the hold time, on average at half of its speed. So on the plan it is half of the
    # hold time further than at the order to stop.
    assert ended.done == pytest.approx(at, abs=0.5)
    goes_again(world, job)


@pytest.mark.parametrize("at", [0.4, 1.7, 3.2])
def test_an_abort_is_at_rest_within_what_ixx15_takes(at):
    job, _ = prepared(tm=10)
    world = world_of(job, record=True)
    since = world.now
    world.order(Abort(), at)
    ended = run(world, job)
    lands(world, job, ended)
    assert ended.what == "aborted: off its path"
    times = np.arange(since, world.machine.now, 1e-3)
    motors = job.robot.controller.motors
    speed = np.stack([world.machine.record.velocities(motor, times) for motor in motors], axis=1)
    still = times[np.abs(speed).max(axis=1) > 0.0].max()
    sent = next(sent.time for sent in world.sent if sent.request == Control("\x01"))
    assert still - sent < 0.5
    goes_again(world, job)


def test_an_abort_overtakes_a_stop():
    """An abort is executed even while the robot brakes on its path after a stop."""
    job, _ = prepared(tm=10)
    world = world_of(job)
    world.order(Stop(), 1.0)
    world.order(Abort(), 1.1)
    ended = run(world, job)
    lands(world, job, ended)
    place, order = world.given[1]
    assert order == Abort()
    assert world.sent[place].request == Control("\x01")
    assert world.sent[place].time < world.sent[0].time + 2.0
    goes_again(world, job)


def test_all_orders_at_once_are_an_abort():
    job, _ = prepared(tm=10)
    world = world_of(job)
    for order in (Override(50), Resume(), Hold(), Stop(), Resume(), Abort()):
        world.order(order, 1.0)
    assert run(world, job).what == "aborted: off its path"
    goes_again(world, job)


def test_a_hold_and_a_stop_at_once_are_a_stop():
    job, plan = prepared(tm=10)
    world = world_of(job, record=True)
    since = world.now
    for order in (Hold(), Stop(), Hold()):
        world.order(order, 1.0)
    assert run(world, job).what == "stopped on its path"
    assert moved_along(world, job, plan, since) < 1.0


def test_a_resume_before_a_hold_is_forgotten_and_one_behind_it_is_not():
    job, plan = prepared(tm=10)
    world = world_of(job, record=True)
    since = world.now
    world.order(Hold(), 1.0)
    for order in (Resume(), Hold()):
        world.order(order, 2.0)
    for order in (Hold(), Resume()):
        world.order(order, 5.0)
    assert run(world, job).well
    moves = [
        notice.time - since
        for notice in world.told
        if isinstance(notice, Changed) and notice.state is State.MOVE
    ]
    assert len(moves) == 2
    assert 5.0 < moves[1] < 5.5
    assert moved_along(world, job, plan, since) < 1.0


def test_a_long_hold_refills_and_goes_on():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.order(Hold(), 1.0)
    world.order(Resume(), 20.0)
    assert run(world, job).well
    assert world.states[-4:] == [State.MOVE, State.HOLD, State.MOVE, State.STOP]
    assert moved_along(world, job, plan, since) < 1.0


def test_the_robot_stands_before_anything_else_is_asked_in_a_hold():
    """If a resume follows a hold at once, R is sent only when the robot is at rest, and nothing else is
    requested before.
    """
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.0)
    world.order(Resume(), 1.02)
    run(world, job)
    held = next(n for n, sent in enumerate(world.sent) if sent.request == Ask("&1H"))
    again = next(sent for sent in world.sent[held:] if sent.request == Ask("R"))
    assert again.time - world.sent[held].time > job.robot.controller.hold_time
    assert not again.moving


@pytest.mark.parametrize("order", [Hold(), Stop(), Abort(), Fail("x", "y")])
def test_before_the_motion_every_stop_ends_the_run(order):
    job, _ = prepared(tm=5)
    for after in (0.001, 0.01, 0.06, 0.1, 0.15, 0.19, 0.21):
        world = world_of(job, delay=lambda: 0.01)
        world.order(order, after)
        ended = run(world, job)
        assert not ended.well
        assert "R" not in world.asked
        assert world.stands(job.robot) == pytest.approx(to_counts(job.robot, job.start), abs=1e-6)


def test_an_order_between_two_jobs_stops_the_second():
    """A stop between the approach and the program prevents the program."""
    job, _ = prepared(tm=20)
    world = world_of(job)
    assert run(world, job).well
    world.operation.orders.append(Stop())
    asked = len(world.asked)
    assert run(world, job).what == "stopped on its path"
    assert "R" not in world.asked[asked:]
    # The stop applies only once.
    assert run(world, job).well


def test_a_stop_while_the_controller_is_busy_goes_by_a_control_character():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.spoil_by("busy@1.0:0.5")
    world.order(Stop(), 1.2)
    ended = run(world, job)
    lands(world, job, ended)
    place, _ = world.given[0]
    times = {sent.request: sent.time for sent in world.sent[place:]}
    assert times[Control("\x0f")] - since < 1.2 + 0.05
    assert moved_along(world, job, plan, since) < 1.0


def test_an_abort_while_the_controller_is_busy():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.spoil_by("busy@1.0:0.5")
    world.order(Abort(), 1.2)
    ended = run(world, job)
    lands(world, job, ended)
    assert ended.what == "aborted: off its path"


def test_a_failed_log_ends_the_run_on_the_path():
    job, plan = prepared(tm=10)
    world = world_of(job, record=True)
    since = world.now
    world.order(Fail("the log can't be written", "make room"), 2.0)
    ended = run(world, job)
    lands(world, job, ended)
    assert (ended.what, ended.remedy) == ("the log can't be written", "make room")
    assert world.operation.state is State.FAULT
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


def test_lines_are_fed_during_a_hold():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.0)
    world.order(Resume(), 3.0)
    assert run(world, job).well
    held = [sent for sent in world.sent if sent.state is State.HOLD and isinstance(sent.request, Write)]
    assert held
    assert from_counts(job.robot, world.stands(job.robot)) == pytest.approx(job.end, abs=1e-6)


def test_an_abort_behind_a_stop_is_told():
    """An abort after a stop is reported: the robot has left its path."""
    job, _ = prepared(tm=5)
    world = world_of(job, record=True, seed=0)
    world.order(Stop(), 1.0)
    world.order(Abort(), 1.0)
    ended = run(world, job)
    lands(world, job, ended)
    assert "aborted" in ended.what
