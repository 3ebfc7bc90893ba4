"""Tests of streaming: loading, feeding, low buffer, the end, refusals before anything moves, and events that
end a run.
"""

from dataclasses import replace

import numpy as np
import pytest
from runtime.virtual import (
    SHORT,
    ahead_in,
    asks_flow,
    example_of,
    lines_of,
    moved_along,
    prepared,
    robot_with,
    well_behaved,
    with_ahead,
    world_of,
)

from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.actuation import to_counts
from yarclang.runtime.notices import Abort, Changed, Hold, Override, Progress, Remark, Resume
from yarclang.runtime.pmac.feed import Feed
from yarclang.runtime.pmac.loading import capacity_of, loading_of
from yarclang.runtime.pmac.memory import Memory
from yarclang.runtime.pmac.messages import Ask, Control, Write
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.sample import Sample
from yarclang.runtime.state import State
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


def run(world, job, **options):
    """Perform a job, and check what holds for each run."""
    ended = world.perform(perform(world.operation, job), **options)
    well_behaved(world)
    assert not world.moving
    return ended


def at_its_end(world, job):
    """Return True if the robot is at the job's end, to one count."""
    return np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() <= 1.0


def written(world):
    return [line for sent in world.sent if isinstance(sent.request, Write) for line in lines_of(sent.request)]


# runs to the end


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("tm", [50, 10])
def test_the_examples_run_to_their_end(robot, tm):
    job, plan = example_of(robot, tm=tm)
    world = world_of(job, record=tm == 50, delay=0.02)
    since = world.now
    ended = run(world, job)
    assert ended.well, ended
    assert at_its_end(world, job)
    assert ended.joints == pytest.approx(job.end)
    assert ended.done == pytest.approx(job.duration)
    assert world.states[-3:] == [State.INIT, State.MOVE, State.STOP]
    # Each line was sent once and in order, into an open buffer.
    assert tuple(written(world)) == job.lines
    assert "buffer low" not in world.words
    assert world.say("P8100") == ("0",)
    assert world.say("&1%") == ("100",)
    assert world.now - since == pytest.approx(job.duration, abs=1.5)
    if tm == 50:
        assert moved_along(world, job, plan, since, step=0.05) < 1.0


def test_several_packets_go_behind_one_pr():
    job, _ = prepared(tm=5)
    world = world_of(job)
    run(world, job)
    requests = [sent.request for sent in world.sent]
    first = requests.index(Ask("CLEAR")) + 2
    prefill = requests[first : next(n for n, request in enumerate(requests) if asks_flow(request))]
    assert len(prefill) > 5
    assert all(isinstance(request, Write) for request in prefill)
    # Before the motion begins, as many lines are loaded as fit.
    assert sum(len(lines_of(request)) for request in prefill) == job.capacity


def test_the_end_is_when_the_motion_has_ended():
    job, _ = prepared(tm=50)
    world = world_of(job, record=True)
    assert run(world, job).well
    (end,) = [
        notice.time for notice in world.told if isinstance(notice, Changed) and "to a count" in notice.why
    ]
    motors = job.robot.controller.motors
    last = max(
        time
        for time in np.arange(end - 1.0, end, 1e-3)
        for motor in motors
        if world.machine.record.velocities(motor, np.array([time]))[0]
    )
    assert last < end < last + 0.2
    emptied = next(
        notice.time for notice in world.told if isinstance(notice, Progress) and not notice.command
    )
    assert emptied == end


def test_what_is_told_on_the_way():
    job, _ = prepared(tm=20)
    world = world_of(job, record=True)
    began = world.now
    run(world, job)
    samples = [notice for notice in world.told if isinstance(notice, Sample)]
    assert len(samples) > 20 * job.duration
    for sample in samples[::10]:
        truth = world.machine.positions(np.array([sample.time]), job.robot.controller.motors)[0]
        assert sample.commanded == pytest.approx(truth, abs=1000.0)
    progress = [notice for notice in world.told if isinstance(notice, Progress)]
    assert len(progress) > 4 * job.duration
    done = [notice.done for notice in progress]
    assert done == sorted(done)
    moved = [notice for notice in progress if notice.command]
    assert {notice.command for notice in moved} == {command.title for command in job.commands}
    for notice in moved[1:-1]:
        assert notice.done + notice.left == pytest.approx(job.duration)
        (begin,) = [
            each.time for each in world.told if isinstance(each, Changed) and each.state is State.MOVE
        ]
        assert notice.done == pytest.approx(notice.time - begin, abs=0.1)
    assert began < progress[0].time


def test_a_program_that_fits_is_loaded_whole():
    job, _ = prepared("P0010 MOVEJ_LSPB 5 0 0 0 0 0 [1] (deg,s)\n", tm=50)
    assert job.fits
    # This link would be too slow for a job that doesn't fit into the buffer.
    world = world_of(job, delay=lambda: 0.3)
    assert run(world, job).well
    first = world.asked.index("R")
    assert tuple(written(world)) == job.lines
    assert any(" PR " in line for line in world.asked[:first])
    assert at_its_end(world, job)


def test_two_groups_of_motors(tmp_path):
    """A robot on motors 5 to 10, which a single ^B, ^F or ^P doesn't report."""
    robot, world = robot_with(tmp_path, range(5, 11))
    made = compile_module(parse(SourceFile("two groups", SHORT)).value, Request(robot, tm=20)).value
    job = job_of_compiled(made, "two groups")
    world.prepare(robot)
    since = world.now
    world.order(Hold(), 1.0)
    world.order(Resume(), 2.0)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert moved_along(world, job, made.plan, since) < 1.0
    assert {len(notice.actual) for notice in world.told if isinstance(notice, Sample)} == {6}
    world.order(Abort(), 1.0)
    assert run(world, job).what == "aborted: off its path"
    stands = world.stands(robot)
    world.machine.advance(1.0)
    assert world.stands(robot) == pytest.approx(stands)


# pace


def test_ten_seconds_at_tm_5_with_up_to_20_ms_a_reply():
    text = "".join(
        f"P{n:04d} MOVEJ_LSPB {'20 -10 10 0 20 0' if n % 20 else '0 0 0 0 0 0'} [5] (deg,s)\n"
        for n in (10, 20)
    )
    job, _ = prepared(text, tm=5)
    world = world_of(job, delay=0.02, seed=3)
    ahead, feed = [], Feed(job)

    def spoil(request, reply):
        if asks_flow(request) and len(written(world)) < len(job.lines):
            ahead.append(ahead_in(reply))
        return reply

    world.spoil = spoil
    assert run(world, job).well
    assert "buffer low" not in world.words
    assert len(job.lines) > 2000
    assert len(ahead) > 100
    assert min(ahead) > feed.plenty


@pytest.mark.parametrize("percent", [100, 50, 10])
def test_override(percent):
    job, plan = prepared(tm=20)
    world = world_of(job, record=True, delay=0.01)
    since = world.now
    world.order(Override(percent), 0.0)
    assert run(world, job).well
    begin, end = (
        notice.time
        for notice in world.told
        if isinstance(notice, Changed) and notice.state in (State.MOVE, State.STOP) and notice.time > since
    )
    assert end - begin == pytest.approx(job.duration * 100.0 / percent, abs=1.0)
    assert moved_along(world, job, plan, since) < 1.0
    world.machine.advance(1.0)
    assert world.say("&1%") == ("100",), "whoever comes next finds 100 %"


def test_an_override_stays_for_the_next_job():
    """The next job, such as the next pass of a loop, keeps the override that the user has ordered."""
    job, _ = prepared(tm=20)
    world = world_of(job)
    world.order(Override(50), 1.0)
    assert run(world, job).well
    began = world.now
    assert run(world, job).well
    assert world.now - began > 1.9 * job.duration
    assert "override 50 %" in [
        notice.text for notice in world.told if isinstance(notice, Remark) and notice.time > began
    ]


def test_an_override_of_somebody_else_is_undone_before_the_motion():
    job, _ = prepared(tm=20)
    world = world_of(job)
    world.say("&1%200")
    began = world.now
    assert run(world, job).well
    assert world.now - began > job.duration


# refusals before any motion


def never_began(world, job, words):
    ended = run(world, job)
    assert not ended.well
    assert words in ended.what
    assert "R" not in world.asked
    assert ended.command == ""
    assert world.operation.state is State.FAULT
    return ended


@pytest.mark.parametrize(
    ("delay", "words"), [(0.2, "lines/s; the program needs 200"), (0.062, "takes 62 ms for a packet")]
)
def test_a_link_that_is_too_slow(delay, words):
    job, _ = prepared(tm=5)
    world = world_of(job, delay=lambda: delay)
    ended = never_began(world, job, words)
    assert "--tm" in ended.remedy


@pytest.mark.parametrize("tm", [5, 10, 20])
def test_a_link_that_was_found_fast_enough_is(tm):
    """With a delay near the limit, a job is refused, or the buffer never runs low."""
    job, _ = prepared(tm=tm)
    outcomes = set()
    reserve = (job.capacity - Feed(job).low) * job.segment
    for exchanges in (40, 20, 15, 13, 12.2, 11, 8, 5):
        delay = reserve / exchanges
        world = world_of(job, delay=lambda delay=delay: delay)
        ended = run(world, job)
        if not ended.well:
            assert "the link carries" in ended.what or "ms are allowed" in ended.what, ended
        else:
            assert "buffer low" not in world.words, delay
        outcomes.add(ended.well)
    assert outcomes == {True, False}


def test_a_rotary_that_holds_less_than_a_second():
    job, _ = prepared(tm=5)
    own = replace(loading_of(job), words=480)
    small = replace(job, own=own, capacity=capacity_of(job.robot, 480))
    never_began(world_of(job), small, "holds 0.40 s of the program")


def test_a_start_that_is_off_says_how_far_each_joint_is():
    job, _ = prepared(tm=20)
    robot = job.robot
    world = world_of(job)
    off = job.slack * np.array([0.9, 1.1, -1.2, 0.9, -0.9, 2.0])
    for motor, counts in zip(robot.controller.motors, to_counts(robot, job.start + off), strict=True):
        world.say(f"#{motor}J={counts:.4f}")
    world.machine.advance(1.0)
    ended = never_began(world, job, "doesn't stand where test starts")
    units = off / robot.axis_units
    assert ended.what.endswith(f"J2 {units[1]:+.4f} deg, J3 {units[2]:+.4f} deg, J6 {units[5]:+.4f} deg")
    assert "--approach" in ended.remedy
    assert "OPEN ROT" not in world.asked
    assert ended.joints == pytest.approx(job.start + off, abs=1e-8)


def test_a_start_within_a_twentieth_of_the_first_segments_acceleration():
    job, plan = prepared(tm=50)
    robot = job.robot
    world = world_of(job, record=True)
    for motor, counts in zip(
        robot.controller.motors, to_counts(robot, job.start + 0.9 * job.slack), strict=True
    ):
        world.say(f"#{motor}J={counts:.4f}")
    world.machine.advance(1.0)
    world.now = world.machine.now
    assert run(world, job).well
    assert at_its_end(world, job)
    assert plan.robot is robot


def test_a_controller_that_counts_other_lines():
    job, _ = prepared(tm=20)
    world = world_of(job)
    world.spoil = lambda request, reply: with_ahead(reply, b"17") if asks_flow(request) else reply
    never_began(world, job, f"counts 17 lines in its buffer, but only {job.capacity} were sent")


def test_a_line_of_the_preparation_that_is_refused():
    job, _ = prepared(tm=20)
    world = world_of(job)
    own = loading_of(job)
    wrong = replace(job, own=replace(own, setup=(*own.setup[:-1], "FOO")))
    never_began(world, wrong, "refuses 'FOO': ERR003")


def test_a_rotary_that_is_smaller_than_was_asked_for():
    job, _ = prepared(tm=20)
    world = world_of(job)
    setup = tuple(
        "DEFINE ROT 100" if line.startswith("DEFINE ROT") else line for line in loading_of(job).setup
    )
    ended = never_began(world, replace(job, own=replace(loading_of(job), setup=setup)), "ERR006")
    assert "although there should be" in ended.what


def test_nothing_is_begun_in_a_fault():
    job, _ = prepared(tm=20)
    world = world_of(job)
    world.say("#1J=5000")
    world.machine.advance(1.0)
    assert not run(world, job).well
    requests = len(world.sent)
    again = run(world, job)
    assert not again.well
    assert "state fault" in again.what
    assert len(world.sent) == requests
    world.prepare(job.robot)
    assert world.approach(job.robot, job.start).well
    assert run(world, job).well


# low water


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("tm", [5, 20, 50])
def test_a_host_that_stood_still_for_seconds(robot, tm):
    """While the host stands still, the guard PLC holds the motion. The host then refills the buffer and
    continues on the path.
    """
    job, plan = example_of(robot, tm=tm)
    world = world_of(job, record=True, delay=0.005)
    since = world.now
    world.stall_at = [(since + 7.0, 6.0)]
    ended = run(world, job)
    assert ended.well, ended
    assert at_its_end(world, job)
    assert tuple(written(world)) == job.lines
    assert moved_along(world, job, plan, since + 0.5, step=0.03) < 1.0
    # Either message may come first.
    assert "received nothing from this computer for 0.4 s" in world.words or "buffer low" in world.words
    held = world.states[world.states.index(State.MOVE) :]
    assert held == [State.MOVE, State.HOLD, State.MOVE, State.STOP]
    assert any(isinstance(notice, Remark) and notice.warning for notice in world.told)


@pytest.mark.parametrize("asleep", [12.0, 300.0])
def test_a_host_that_slept_for_long_waits_for_a_person(asleep):
    """After a long sleep of the host, the motion stays held until a user resumes, because somebody may be at
    the robot by now.
    """
    job, plan = prepared(tm=5)
    world = world_of(job, record=True, delay=0.005)
    since = world.now
    world.stall_at = [(since + 1.0, asleep)]
    world.order(Resume(), 1.0 + asleep + 20.0)
    ended = run(world, job)
    assert ended.well, ended
    assert at_its_end(world, job)
    assert tuple(written(world)) == job.lines
    assert moved_along(world, job, plan, since) < 1.0
    assert "yarc resume" in world.words
    moves = [
        notice.time - since
        for notice in world.told
        if isinstance(notice, Changed) and notice.state is State.MOVE
    ]
    assert len(moves) == 2
    assert moves[1] == pytest.approx(1.0 + asleep + 20.0, abs=0.5)


def test_an_order_to_continue_that_came_during_a_long_sleep():
    """A user has held the motion, and orders to continue while the host sleeps. Minutes later, when the host
    wakes up, this order moves nothing: the user may be at the robot by now.
    """
    job, _ = prepared(tm=5)
    world = world_of(job, delay=0.005)
    since, stands = world.now, []
    world.order(Hold(), 1.0)
    world.stall_at = [(since + 3.0, 300.0)]
    world.order(Resume(), 10.0)
    world.order(Resume(), 303.2)
    world.do(lambda: stands.append(world.moving), 303.5)
    world.order(Resume(), 320.0)
    ended = run(world, job)
    assert ended.well, ended
    assert stands == [False]
    assert world.now - since > 320.0
    assert "is ignored, because it was given while this process was suspended" in world.words


@pytest.mark.parametrize("line", ["CLEAR", "R"])
def test_a_host_that_slept_before_the_motion(line):
    """The host sleeps after the checks, before the motion begins: it begins only after a resume."""
    job, _ = prepared(tm=20)
    world = world_of(job)
    since = []

    def spoil(request, reply):
        if not since and getattr(request, "line", "") == line:
            since.append(world.now)
            world.stall_at = [(world.now, 60.0)]
            world.order(Resume(), 90.0)
        return reply

    world.spoil = spoil
    assert run(world, job).well
    assert world.now - since[0] > 90.0
    assert at_its_end(world, job)


def test_a_host_that_slept_through_the_end():
    """The host sleeps after it has sent all lines. The watchdog has held the motion, and the motion continues
    only after a resume.
    """
    job, _ = prepared(tm=50)
    world = world_of(job)
    since = world.now
    world.stall_at = [(since + 3.8, 60.0)]
    world.order(Resume(), 90.0)
    assert run(world, job).well
    assert world.now - since > 90.0
    assert at_its_end(world, job)


def test_the_host_holds_before_the_guard_does():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since, ahead = world.now, []
    world.operation.silence = 5.0

    def spoil(request, reply):
        if asks_flow(request) and world.now > since + 1.0:
            ahead.append(ahead_in(reply))
        return reply

    world.spoil = spoil
    # When the host wakes up, fewer lines are buffered than the host wants, but more than the guard PLC
    # requires.
    world.stall_at = [
        (since + 1.0, (job.capacity - (loading_of(job).low + Feed(job).low) / 2.0 - 22) * job.segment)
    ]
    assert run(world, job).well
    assert loading_of(job).low < ahead[0] < Feed(job).low + 4
    assert "buffer low" in world.words
    assert moved_along(world, job, plan, since) < 1.0


@pytest.mark.parametrize("left", [15, 40, 60, 80, 140, 190])
def test_a_stall_when_few_lines_are_left(left):
    """Fewer lines remain than the guard PLC requires. The PLC mustn't hold the motion for ever."""
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    lines = len(job.lines) - job.capacity - left
    world.stall_at = [(since + lines * job.segment, 3.0)]
    assert run(world, job, within=30.0).well
    assert moved_along(world, job, plan, since) < 1.0


def test_many_stalls():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.stall_at = [(since + 1.0 + 2.5 * n, 1.5) for n in range(4)]
    assert run(world, job).well
    assert moved_along(world, job, plan, since) < 1.0
    assert world.words.count("received nothing from this computer") + world.words.count("buffer low:") >= 3


def test_a_person_who_holds_meanwhile_is_heard():
    """If a user orders a hold in the meantime, the refilled program doesn't continue by itself."""
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.stall_at = [(since + 1.0, 3.0)]
    world.order(Hold(), 4.05)
    world.order(Resume(), 9.0)
    assert run(world, job).well
    moves = [
        notice.time - since
        for notice in world.told
        if isinstance(notice, Changed) and notice.state is State.MOVE
    ]
    assert len(moves) == 2
    assert moves[1] == pytest.approx(9.0, abs=0.3)
    assert moved_along(world, job, plan, since) < 1.0


def test_without_a_guard_a_stall_ends_in_an_underrun():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.do(lambda: world.say("DISABLE PLC 29"), 1.0)
    world.stall_at = [(world.now + 1.0, 3.0)]
    ended = run(world, job)
    assert not ended.well
    assert "underrun: the rotary buffer ran dry with" in ended.what
    assert "guard PLC" in ended.remedy
    assert ended.command == job.commands[1].title
    assert world.operation.state is State.FAULT
    assert ended.joints == pytest.approx(joints(world, job))
    # No line was sent after the missing one.
    assert len(written(world)) < len(job.lines)
    world.say("ENABLE PLC 29")
    goes_again(world, job)


def joints(world, job):
    from yarclang.robot.actuation import from_counts

    return from_counts(job.robot, world.stands(job.robot))


def goes_again(world, job):
    world.prepare(job.robot)
    assert world.approach(job.robot, job.start).well
    assert run(world, job).well
    assert at_its_end(world, job)


# another client at the same controller


def test_somebody_else_holds_and_nobody_goes_on_but_a_person():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.do(lambda: world.say("&1H"), 1.0)
    world.order(Resume(), 6.0)
    assert run(world, job).well
    assert "held or slowed down, but not by this run" in world.words
    assert "another client uses this controller" in world.words
    assert world.states[-4:] == [State.MOVE, State.HOLD, State.MOVE, State.STOP]
    assert world.now - since > 6.0 + 3.0
    assert moved_along(world, job, plan, since) < 1.0


def test_a_guard_that_holds_although_lines_are_ahead():
    """The guard PLC holds although enough lines are buffered, because its flag was changed. The run continues
    as after a low buffer.
    """
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.do(lambda: world.say("&1H") or world.say("P8100=2"), 1.0)
    assert run(world, job).well
    assert "the guard PLC has held the motion" in world.words
    assert moved_along(world, job, plan, since) < 1.0


OTHERS = {
    "aborts": ("&1A", "doesn't run the program any more"),
    "quits": ("&1Q", "doesn't run the program any more"),
}


@pytest.mark.parametrize("what", OTHERS)
def test_somebody_else_ends_the_program(what):
    line, words = OTHERS[what]
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.do(lambda: world.say(line), 1.5)
    ended = run(world, job)
    assert not ended.well
    assert words in ended.what
    assert ended.joints == pytest.approx(joints(world, job))
    goes_again(world, job)


def test_somebody_else_closes_all_buffers():
    """Another terminal sends CLOSE ALL. The rotary buffer is open only within a packet, so no line
    is lost.
    """
    job, _ = prepared(tm=5)
    world = world_of(job)
    for after in (1.0, 1.5, 2.0):
        world.do(lambda: world.say("CLOSE ALL"), after)
    assert run(world, job).well
    assert tuple(written(world)) == job.lines


def test_somebody_else_has_a_buffer_open():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.do(lambda: world.say("OPEN PLC 5"), 1.0)
    ended = run(world, job)
    assert not ended.well
    assert "refuses 'OPEN ROT': ERR007" in ended.what
    assert "CLOSE the buffer there" in ended.remedy
    assert moved_along(world, job, plan, since) < 1.0
    world.say("CLOSE")
    goes_again(world, job)


def test_somebody_else_moves_the_robot_during_a_hold():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.0)
    world.do(lambda: world.say("#1J^2000"), 2.0)
    world.order(Resume(), 5.0)
    ended = run(world, job)
    assert not ended.well
    assert "ERR017" in ended.what
    goes_again(world, job)


def test_an_end_at_another_place_is_a_fault():
    """If the robot ends at another position than planned, because the controller has lost the last line, this
    is a fault.
    """
    job, _ = prepared(tm=20)
    world = world_of(job)
    wrong = replace(job, end=job.end + 1e-3)
    ended = run(world, wrong)
    assert not ended.well
    assert "the program has ended" in ended.what
    assert "counts from its last point (motor" in ended.what


# refusals in WRITEBUFFER during motion


@pytest.mark.parametrize("error", [3, 5, 6])
@pytest.mark.parametrize("line", [1, 4])
def test_a_line_that_is_refused_in_motion(error, line):
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now

    def spoil(request, reply):
        if isinstance(request, Write) and world.now > since + 1.0:
            return bytes((line + 1, 0, error, 0x80))  # the first line of the packet is OPEN ROT
        return reply

    world.spoil = spoil
    ended = run(world, job)
    assert not ended.well
    assert f"ERR{error:03d}" in ended.what
    sent = [lines_of(sent.request) for sent in world.sent if isinstance(sent.request, Write)]
    number = sum(map(len, sent[:-1])) + line
    assert f"refuses line {number} of the motion, {job.lines[number - 1]!r}" in ended.what
    assert ended.command == job.commands[0].title
    # The robot rests on its path because of a hold (H), not by an empty buffer.
    assert "&1H" in world.asked
    assert moved_along(world, job, plan, since) < 1.0
    world.spoil = lambda request, reply: reply
    goes_again(world, job)


def test_a_run_that_cannot_be_calculated_in_time():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.operation.memory = Memory()
    world.do(lambda: world.say("I8=20"), 1.0)
    ended = run(world, job)
    assert not ended.well
    assert "couldn't calculate a move in time" in ended.what
    assert "--tm" in ended.remedy


def test_control_characters_are_only_those_of_a_stop():
    job, _ = prepared(tm=20)
    world = world_of(job)
    assert run(world, job).well
    assert {sent.request.character for sent in world.sent if isinstance(sent.request, Control)} == {"\x0c"}
