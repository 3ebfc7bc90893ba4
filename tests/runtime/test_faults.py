"""Tests of faults. After each one the robot is at rest, the user is told its position and the command, and no
motion begins before the controller was inspected.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from runtime.virtual import asks_flow, moved_along, prepared, well_behaved, world_of

from yarclang.pipeline.settings import items_of
from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Abort, Hold, Resume
from yarclang.runtime.pmac.memory import Memory
from yarclang.runtime.pmac.messages import Ask, AskControl, Control, Write
from yarclang.runtime.pmac.performance import connect, end_what_runs, look, perform
from yarclang.runtime.state import State

AT = 2.2
"""Time of the fault, in the second motion [s]."""

GUARD_HELD = ("2",)


def run(world, job):
    ended = world.perform(perform(world.operation, job))
    well_behaved(world)
    return ended


def fails(world, job, words, command=1):
    """Run a job that a fault ends, and check what holds after each fault."""
    ended = run(world, job)
    assert not ended.well
    assert words in ended.what, ended
    assert ended.remedy
    assert world.operation.state is State.FAULT
    assert (ended.command, ended.command_index) == (job.commands[command].title, job.commands[command].index)
    assert job.commands[command].begins <= ended.done <= job.commands[command].ends
    if ended.joints is not None:
        assert not world.moving
        stands = world.stands(job.robot)
        assert to_counts(job.robot, ended.joints) == pytest.approx(stands, abs=0.01)
        world.machine.advance(3.0)
        world.now = world.machine.now
        assert world.stands(job.robot) == pytest.approx(stands, abs=1e-6)
    refuses(world, job)
    return ended


def refuses(world, job):
    """Check that without an inspection a run is refused before anything is requested."""
    requests = len(world.sent)
    assert "check the controller" in run(world, job).remedy
    assert len(world.sent) == requests


def looked_at(world, job):
    """Return the subjects of the failed checks of an inspection."""
    world.perform(connect(world.operation))
    found = world.perform(look(world.operation, job.robot, items_of(job.robot)))
    return [error.subject for error in found.errors]


def goes_again(world, job):
    assert looked_at(world, job) == []
    assert world.operation.state is State.STOP
    assert world.approach(job.robot, job.start).well
    assert run(world, job).well
    assert world.stands(job.robot) == pytest.approx(to_counts(job.robot, job.end), abs=1.0)


def held_within(world, since, seconds):
    """Check that a hold or an abort was sent in time."""
    times = [
        sent.time for sent in world.sent if sent.request in (Control("\x0f"), Control("\x01"), Ask("&1H"))
    ]
    assert times
    assert times[0] - since < seconds


# the connection


def test_a_connection_that_is_closed():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True, faults=[f"drop@{AT}"])
    since = world.now
    ended = fails(world, job, "the controller has closed the connection")
    assert ended.joints is not None
    assert "--from" in ended.remedy
    held_within(world, since, AT + 0.1)
    assert world.states[-2:] == [State.DISCONNECTED, State.FAULT]
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


def test_a_controller_that_does_not_answer_for_a_while():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True, faults=[f"freeze@{AT}:3"])
    since = world.now
    ended = fails(world, job, "in time")
    assert ended.joints is not None
    # In the meantime, the guard PLC has held the motion on its path.
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


def test_a_reply_that_is_late():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    late = iter([1.5])
    world.delay = lambda: next(late, 0.001) if world.now > since + AT else 0.001
    fails(world, job, "in time")
    held_within(world, since, AT + 1.1)
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


def test_a_controller_that_stays_out_of_reach():
    """If the controller stays unreachable, its guard PLC holds the motion on the path. A new run is refused
    until the held program has been ended.
    """
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.reachable = lambda now: now < since + AT
    ended = fails(world, job, "can't be reached again: the cable is out")
    assert ended.joints is None
    assert "guard PLC" in ended.remedy
    assert not world.moving
    assert world.say("P8104") == GUARD_HELD
    assert moved_along(world, job, plan, since) < 1.0
    # The cable is plugged in again.
    world.reachable = lambda now: True
    assert looked_at(world, job) == ["coordinate system 1"]
    assert world.operation.state is State.FAULT
    refuses(world, job)
    joints = world.perform(end_what_runs(world.operation, job.robot, abort=False))
    assert to_counts(job.robot, joints) == pytest.approx(world.stands(job.robot), abs=0.01)
    goes_again(world, job)


def test_a_program_whose_lines_are_all_in_is_held_too():
    job, plan = prepared(tm=50)
    world = world_of(job, record=True)
    since = world.now
    world.reachable = lambda now: now < since + AT
    ended = fails(world, job, "can't be reached again")
    assert "0.4 s without data from this computer" in ended.remedy
    assert not world.moving
    assert np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() > 1000.0
    assert moved_along(world, job, plan, since) < 1.0
    world.reachable = lambda now: True
    assert looked_at(world, job) == ["coordinate system 1"]


def test_a_connection_that_comes_back_in_time():
    """The connection comes back after five seconds: the guard PLC has held the motion, and the runtime ends
    it.
    """
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.reachable = lambda now: not since + AT < now < since + AT + 5.0
    ended = fails(world, job, "the connection was lost")
    assert ended.joints is not None
    assert moved_along(world, job, plan, since) < 1.0
    assert world.say("P8100") == ("0",)
    goes_again(world, job)


def test_an_abort_is_given_to_the_new_connection_too():
    job, _ = prepared(tm=5)
    world = world_of(job)
    since = world.now
    world.reachable = lambda now: not since + AT < now < since + AT + 1.3
    world.order(Abort(), AT + 0.2)
    fails(world, job, "the connection was lost")
    later = [sent.request for sent in world.sent if isinstance(sent.request, Control) and sent.time > since]
    assert Control("\x01") in later
    assert Control("\x0f") not in later
    goes_again(world, job)


def test_a_connection_that_is_lost_before_the_motion():
    job, _ = prepared(tm=5)
    world = world_of(job, faults=["drop@line30"])
    ended = run(world, job)
    assert not ended.well
    assert ended.command == ""
    assert "R" not in world.asked
    assert looked_at(world, job) == []


def test_a_controller_that_cannot_be_reached_at_all():
    job, _ = prepared(tm=5)
    world = world_of(job, prepare=False)
    world.reachable = lambda now: False
    with pytest.raises(Trouble, match="the cable is out") as trouble:
        world.perform(connect(world.operation))
    assert "check the address" in trouble.value.remedy
    assert world.operation.state is State.DISCONNECTED
    assert "disconnected" in run(world, job).what


@pytest.mark.parametrize("late", ["slow:1.3", "freeze@0"])
def test_a_controller_that_answers_too_slowly_or_not_at_all(late):
    job, _ = prepared(tm=5)
    world = world_of(job, prepare=False)
    world.spoil_by(late)
    with pytest.raises(
        Trouble, match=r"answers too slowly, or not at all: no reply to .* in time"
    ) as trouble:
        world.perform(connect(world.operation))
    assert "PMAC" not in trouble.value.what
    assert trouble.value.remedy
    assert world.operation.state is State.DISCONNECTED


def test_something_else_at_the_address():
    job, _ = prepared(tm=5)
    world = world_of(job, prepare=False)
    world.spoil = lambda request, reply: b"HTTP/1.1 400 Bad Request\r\n"
    with pytest.raises(Trouble, match="doesn't answer like a PMAC"):
        world.perform(connect(world.operation))


# replies


GARBLED = {
    "PR": (asks_flow, [b"2a\r1\r5\r1\r5\r100\r\x06", b"99999\r1\r5\r1\r5\r100\r\x06",
        b"-3\r1\r5\r1\r5\r100\r\x06", b"\r\x06", b"17\r\n\x06", b"1\r2\r\x06", b"\x07ERR00\r", b"\x00\x00"]),
    "status": (AskControl("\x02"), [b"8820000184\r", b"\x80\r", b"88200001840_ " * 8 + b"\r"]),
    "positions": (AskControl("\x10"), [b"1 2 3\r", b"1 2 3 4 5 x 7 8\r", b"nan " * 8 + b"\r"]),
    "following errors": (AskControl("\x06"), [b"1 2 3\r", b"0x0 " * 8 + b"\r"]),
    "lines": (Write, [b"\x00\x00\x00\x40", b"\x01\x00\x00\x80", b"\xff\xff\x06\x80"]),
}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "number"), [(kind, n) for kind in GARBLED for n in range(len(GARBLED[kind][1]))]
)
def test_a_garbled_reply(kind, number):
    asked, replies = GARBLED[kind]
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since, done = world.now, []

    def spoil(request, reply):
        fits = (
            isinstance(request, asked)
            if isinstance(asked, type)
            else asked(request)
            if callable(asked)
            else request == asked
        )
        if done or not fits or world.now < since + AT:
            return reply
        done.append(world.now)
        return replies[number]

    world.spoil = spoil
    ended = fails(world, job, "the connection was lost")
    assert ended.joints is not None
    held_within(world, done[0], 0.05)
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


@exercises(begun=0.1)
@settings(max_examples=8)
@given(st.integers(0, 2**31), st.sampled_from([0.002, 0.01, 0.05]))
def test_any_byte_of_any_reply(tally, seed, share):
    """One byte of a reply is changed. If the change is detectable, the run ends on the path. A wrong position
    or status does no more harm than this.
    """
    job, plan = prepared(tm=10)
    world = world_of(job, record=True, seed=seed)
    since = world.now
    generator = np.random.default_rng(seed)

    def spoil(request, reply):
        if reply and generator.random() < share:
            place = int(generator.integers(len(reply)))
            return reply[:place] + bytes((int(generator.integers(256)),)) + reply[place + 1 :]
        return reply

    world.spoil = spoil
    for after in range(6, 120, 3):
        world.order(Resume(), after)
    ended = run(world, job)
    world.spoil = lambda request, reply: reply
    world.machine.advance(10.0)
    world.now = world.machine.now
    assert not world.moving
    assert moved_along(world, job, plan, since, step=0.02) < 1.0
    tally.count("begun", ended.well or ended.command_index is not None)
    if not ended.well:
        assert world.operation.state is State.FAULT
        world.perform(connect(world.operation))
        world.perform(end_what_runs(world.operation, job.robot, abort=False))
        goes_again(world, job)


# a busy controller


def test_a_controller_that_is_busy_for_a_moment():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.spoil_by(f"busy@{AT}:0.8")
    assert run(world, job).well
    assert moved_along(world, job, plan, since) < 1.0


def test_a_controller_that_is_busy_for_long():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.spoil_by(f"busy@{AT}:6")
    ended = fails(world, job, "the controller has been busy for 2 s")
    assert ended.joints is not None
    assert "SAVE" in ended.remedy
    # The hold was sent as a control character, which even a busy controller accepts.
    assert Control("\x0f") in [sent.request for sent in world.sent]
    assert moved_along(world, job, plan, since) < 1.0
    goes_again(world, job)


def test_a_controller_that_stays_busy():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.spoil_by(f"busy@{AT}:60")
    ended = fails(world, job, "busy for 2 s")
    assert ended.joints is None
    assert "then: the controller has been busy for 10 s" in ended.what
    assert not world.moving
    assert moved_along(world, job, plan, since) < 1.0


# the controller and its motors


@pytest.mark.parametrize("saved", [False, True])
def test_a_controller_that_is_reset(saved):
    """If the format of replies is saved in the controller, a reset is recognized only by the motors."""
    job, _ = prepared(tm=5)
    world = world_of(job)
    if saved:
        world.say("I6=1I3=2SAVE")
    else:
        world.say("I6=1I3=1SAVE")
        world.say("I3=2")
    world.spoil_by(f"reset@{AT}")
    ended = fails(world, job, "was reset" if saved else "was it reset?")
    # Nobody closes the motors' loops again, so the checks of all motors fail.
    assert looked_at(world, job) == [f"motor {motor}" for motor in job.robot.controller.motors]
    assert world.operation.state is State.FAULT
    # The position registers count from the position at the reset, so the position is unknown.
    assert ended.joints is None
    assert "home it" in ended.remedy
    assert "--from" not in ended.remedy


@pytest.mark.parametrize("alone", [True, False])
def test_a_following_error(alone):
    job, _ = prepared(tm=5)
    world = world_of(job)
    if alone:
        world.say("I324=$400000")
        world.prepare(job.robot)
    world.spoil_by(f"following@{AT}:3")
    fails(world, job, "motor 3: its following error is beyond Ixx11")
    wrong = looked_at(world, job)
    assert wrong == (["motor 3"] if alone else [f"motor {n}" for n in range(1, 7)])
    for motor in range(1, 7):
        world.say(f"#{motor}J/")
    goes_again(world, job)


@pytest.mark.parametrize("alone", [True, False])
def test_an_amplifier_that_fails(alone):
    job, _ = prepared(tm=5)
    world = world_of(job)
    if alone:
        world.say("I124=$400000")
        world.prepare(job.robot)
    world.spoil_by(f"amplifier@{AT}:1")
    ended = fails(world, job, "motor 1: its amplifier reports a fault")
    assert "#1J/" in ended.remedy
    assert "motor 1" in looked_at(world, job)
    world.machine.clear_fault(1)
    for motor in range(1, 7):
        world.say(f"#{motor}J/")
    goes_again(world, job)


@pytest.mark.parametrize("side", ["+", "-"])
def test_a_limit_switch(side):
    """In the second motion, motor 2 moves upwards: only the positive limit switch stops it."""
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.spoil_by(f"limit@{AT}:2{side}")
    if side == "-":
        ended = run(world, job)
        assert not ended.well
        assert "negative limit" in ended.what
        assert ended.command_index == "P0030"
        return
    fails(world, job, "motor 2: it was stopped by the positive limit")
    assert looked_at(world, job) == ["motor 2"]
    # Move the motor off the limit switch.
    world.machine.set_limit_switch(2, 1, False)
    world.say("#2J^-2000")
    world.machine.advance(1.0)
    goes_again(world, job)


def test_a_software_limit():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.operation.memory = Memory()  # without the settings that are compared before a run
    world.say("I113=470000")
    ended = run(world, job)
    assert "motor 1: it was stopped by the positive limit" in ended.what
    assert not world.moving


@pytest.mark.parametrize("delay", [0.03, 0.05])
def test_a_fault_is_seen_over_a_slow_link(delay):
    """The status words are read often enough, even if other requests are frequent."""
    job, _ = prepared(tm=20)
    world = world_of(job, delay=lambda: delay)
    since = world.now
    # Loading the lines also takes time.
    world.spoil_by(f"amplifier@{AT + 20 * delay}:1")
    fails(world, job, "motor 1: its amplifier reports a fault")
    held_within(world, since, AT + 20 * delay + 1.0)


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("amplifier@line30:1", "motor 1: its amplifier reports a fault"),
        ("following@line30:3", "motor 3: its following error is beyond Ixx11"),
    ],
)
def test_a_fault_while_the_program_is_loaded(fault, words):
    """A fault while the program is loaded. Nothing has moved and no command was executed. The message names
    the motor, not the refused R.
    """
    job, _ = prepared(tm=5)
    world = world_of(job, faults=[fault])
    ended = run(world, job)
    assert not ended.well
    assert words in ended.what
    assert "ERR012" not in ended.what
    assert "close its loop" in ended.remedy
    assert (ended.command, ended.command_index, ended.done) == ("", "", 0.0)
    assert State.MOVE not in world.states
    assert world.operation.state is State.FAULT


def test_all_motors_killed_by_somebody():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.do(lambda: world.machine.control(11), AT)
    fails(world, job, "it is open-loop")
    assert looked_at(world, job) == [f"motor {n}" for n in range(1, 7)]


def test_faults_in_a_hold_are_seen():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.8)
    world.spoil_by("amplifier@4:1")
    fails(world, job, "motor 1: its amplifier reports a fault")
