"""Tests of changes that another terminal makes while a program runs. The run is held, and the change is named
and must be undone. Also tests of a host that dies: the robot comes to rest.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from runtime.virtual import World, example_of, moved_along, prepared, well_behaved, world_of

from yarclang.pipeline.settings import items_of
from yarclang.runtime.notices import Fail, Hold, Override, Remark, Resume, Stop
from yarclang.runtime.pmac.messages import Ask, Write
from yarclang.runtime.pmac.performance import connect, end_what_runs, look, perform
from yarclang.runtime.pmac.supervision import patience_for, wound_up
from yarclang.runtime.state import State

AT = 1.3
"""Time of the change in the run [s]."""

AT_ONCE = {
    "a faster pace": ("&1%200", "", "the override was 100 %, and is 1", 0.1),
    "a slower pace": ("&1%40", "", "the override was 100 %, and is", 0.1),
    "the guard's flag": ("P8100=0", "", "P8100, was 1, and is 0", 0.1),
    "the guard's flag, something else": ("P8100=7", "", "P8100, was 1, and is 7", 0.1),
    "the watchdog's flag": ("P8104=0", "", "P8104, was 1, and is 0", 0.1),
    "the guard PLC": ("DISABLE PLC 29", "ENABLE PLC 29", "PLC 29, the guard, has stopped", 0.16),
    "the feedback PLC": ("DISABLE PLC 0", "ENABLE PLC 0", "PLC 0, the feedback, has stopped", 0.1),
    "all PLCs": ("I5=0", "I5=3", "I5 (foreground and background PLCs run) was 3, and is 0", 0.16),
}
WITHIN_A_SECOND = {
    "a limit": ("I113=1000000", "I113=4340581",
        "I113 (positive software limit, counts) was 4340581, and is 1000000"),
    "the deceleration of an abort": ("I115=0.01", "I115=6.1279", "was 6.1279, and is 0.01"),
    "the following error": ("I111=0", None, "I111 (fatal following error) was"),
    "the guard's mark": ("I16=0", "I16=45", "I16 (lines below which the guard holds) was 45, and is 0"),
    "limit switches": ("I324=$20000", "I324=0", "I324 (flags and limit switches) was"),
    "the hold's slew rate": ("I5195=1", "I5195=6576", "was 6576, and is 1"),
    "the override's slew rate": ("I5194=1", "I5194=6576", "was 6576, and is 1"),
    "the source of the time base": ("I5193=$3509", "I5193=0", "I5193 (source of the time base) was"),
}  # fmt: skip
LATER = {
    "a register": ("M161->D:$0", "M161->D:$000088", "address of M161 was D:$000088, and is D:$000000"),
}


def disturbed(line, *, within, orders=(), **options):
    """Perform a run that another terminal disturbs. Return the world, the time of the hold, and the messages
    at this time.
    """
    job, plan = prepared(tm=5)
    world = world_of(job, record=True, **options)
    since = world.now
    world.do(lambda: world.say(line), AT)
    for after, order in orders:
        if isinstance(order, str):
            world.do(lambda order=order: world.say(order), after)
        else:
            world.order(order, after)
    ended = world.perform(perform(world.operation, job))
    well_behaved(world)
    held = next(sent.time for sent in world.sent if sent.request == Ask("&1H")) - since
    assert held - AT <= within + 0.005, held - AT
    assert moved_along(world, job, plan, since) < 1.0
    return world, ended


def said(world):
    return [notice.text for notice in world.told if isinstance(notice, Remark) and notice.warning]


@pytest.mark.parametrize("what", AT_ONCE)
def test_what_decides_over_the_motion_is_seen_with_the_next_question(what):
    line, undo, words, within = AT_ONCE[what]
    undone = [(4.0, undo)] if undo else []
    world, ended = disturbed(line, within=within, orders=[*undone, (5.0, Resume())])
    assert ended.well, ended
    (warning,) = [text for text in said(world) if words in text]
    assert "another client uses this controller" in warning
    assert world.states[-4:] == [State.MOVE, State.HOLD, State.MOVE, State.STOP]
    assert world.say("&1%") == ("100",)


@pytest.mark.parametrize("what", WITHIN_A_SECOND)
def test_settings_are_compared_each_second(what):
    line, undo, words = WITHIN_A_SECOND[what]
    undo = undo or f"I111={prepared(tm=5) and world_of(prepared(tm=5)[0]).say('I111')[0]}"
    world, ended = disturbed(line, within=1.1, orders=[(4.0, undo), (8.0, Resume())])
    assert ended.well, ended
    assert any(words in text for text in said(world)), said(world)


@pytest.mark.parametrize("what", LATER)
def test_definitions_are_compared_by_turns(what):
    line, undo, words = LATER[what]
    world, ended = disturbed(line, within=4.1, orders=[(7.0, undo), (9.0, Resume())])
    assert ended.well, ended
    assert any(words in text for text in said(world)), said(world)


def test_another_guard_is_seen():
    """A changed text of the guard PLC is noticed. The text was read at the inspection, and is read again from
    time to time.
    """
    job, _ = prepared(tm=5)
    world = world_of(job)

    def load():
        for text in ("OPEN PLC 29 CLEAR", "P8103=P8103+1", "CLOSE", "ENABLE PLC 29"):
            world.say(text)

    world.do(load, AT)
    world.order(Resume(), 6.0)
    world.order(Hold(), 3.0)
    with pytest.raises(AssertionError, match="too long"):
        world.perform(perform(world.operation, job), within=12.0)
    assert world.operation.state is State.HOLD
    assert any("PLC 29 has changed" in text for text in said(world))


def test_nothing_moves_if_it_was_changed_since_the_look():
    """Nothing moves if a setting has changed since the inspection, which may have been hours before."""
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.say("I115=0.01")
    ended = world.perform(perform(world.operation, job))
    assert not ended.well
    assert "since it was checked, I115" in ended.what
    assert "was 6.1279, and is 0.01" in ended.what
    assert "R" not in world.asked
    assert world.operation.state is State.FAULT


def test_nobody_goes_on_before_it_is_put_back():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.do(lambda: world.say("I115=0.01"), AT)
    for after in (4.0, 5.0):
        world.order(Resume(), after)
    world.do(lambda: world.say("I115=6.1279"), 7.0)
    world.order(Resume(), 8.0)
    since = world.now
    assert world.perform(perform(world.operation, job)).well
    assert len([text for text in said(world) if "I115" in text]) == 3
    runs = [sent.time - since for sent in world.sent if sent.request == Ask("R")]
    assert len(runs) == 2
    assert runs[1] > 8.0


def test_what_another_pace_was_is_what_it_goes_on_with():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.order(Override(50), 0.5)
    world.do(lambda: world.say("&1%100"), 2.0)
    world.order(Resume(), 4.0)
    assert world.perform(perform(world.operation, job)).well
    assert any("the override was 50 %, and is" in text for text in said(world))
    assert world.now - since > 8.0
    assert moved_along(world, job, plan, since) < 1.0


def test_who_resumes_what_is_held_is_held_again():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.order(Hold(), 1.0)
    world.do(lambda: world.say("&1R"), 3.0)
    world.order(Resume(), 6.0)
    assert world.perform(perform(world.operation, job)).well
    assert any("the robot moves during a hold" in text for text in said(world))
    assert moved_along(world, job, plan, since) < 1.0
    assert len([sent for sent in world.sent if sent.request == Ask("&1H")]) == 2


def test_a_jog_in_a_hold_is_stopped():
    """A jog from another terminal during a hold is stopped. H doesn't affect a jog, so the second attempt
    stops all motors.
    """
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.0)
    world.do(lambda: world.say("#1J+"), 2.0)
    ended = world.perform(perform(world.operation, job), within=30.0)
    assert not ended.well
    assert "a second hold doesn't stop it" in ended.what
    assert not world.moving


@pytest.mark.parametrize("order", [Stop(), Fail("the disk", "x")])
def test_a_stop_stops_a_jog_too(order):
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.order(Hold(), 1.0)
    world.do(lambda: world.say("#1J+"), 2.0)
    world.order(order, 2.1)
    ended = world.perform(perform(world.operation, job), within=30.0)
    assert not ended.well
    assert "aborted" in ended.what
    assert not world.moving


@pytest.mark.parametrize("flags", [("P8100=2",), ("P8104=2",), ("P8100=2", "P8104=2")])
def test_flags_without_a_hold_are_held(flags):
    """If another terminal sets the flags that the guard PLC sets after a hold, the motion is held."""
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    for flag in flags:
        world.do(lambda flag=flag: world.say(flag), AT)
    assert world.perform(perform(world.operation, job)).well
    assert moved_along(world, job, plan, since) < 1.0
    assert next(sent.time for sent in world.sent if sent.request == Ask("&1H")) - since < AT + 0.1


def test_a_limit_that_somebody_has_moved_is_named_when_a_motor_meets_it():
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.do(lambda: world.say("I113=1"), AT)
    ended = world.perform(perform(world.operation, job))
    assert not ended.well
    assert "motor 1: it was stopped by the positive limit" in ended.what
    assert "I113 (positive software limit, counts) was 4340581, and is 1" in ended.what


def test_pace_and_flags_of_our_own_alarm_nobody():
    """The runtime's own changes cause no alarm: rapid overrides, holds, arming and disarming the
    guard PLC.
    """
    job, _ = prepared(tm=5)
    world = world_of(job, delay=0.01)
    for number, percent in enumerate((50, 100, 10, 70, 30, 100, 60, 100)):
        world.order(Override(percent), 0.6 + 0.09 * number)
    for after in (2.0, 2.8):
        world.order(Hold(), after)
        world.order(Resume(), after + 0.4)
    assert world.perform(perform(world.operation, job)).well
    assert not any("another client" in text for text in said(world))


def test_holds_of_the_guard_near_the_end_are_nobody_elses():
    """When all lines are sent, the guard PLC is disarmed as soon as the motion continues. It stays disarmed,
    even if the watchdog of the controller holds the motion several times after that.
    """
    job, _ = prepared(tm=5)
    world = world_of(job)
    for held in (3.5, 4.3):
        world.do(lambda: world.say("P8104=2"), held)
    assert world.perform(perform(world.operation, job), within=20.0).well
    assert not any("another client" in text for text in said(world))
    assert world.states.count(State.HOLD) == 2


def test_nobody_waits_for_somebody_who_is_not_there():
    """Without a terminal, on a simulator of its own, a hold that only a user could resume ends the run."""
    job, _ = prepared(tm=5)
    world = world_of(job)
    world.operation.unattended = True
    world.do(lambda: world.say("%50"), AT)
    ended = world.perform(perform(world.operation, job), within=10.0)
    assert not ended.well
    assert ended.code == "Y1605"
    assert "the override was 100 %, and is" in ended.what
    assert not world.moving


def test_a_motor_that_somebody_homes_ends_the_run():
    job, _ = prepared(tm=5)
    world = world_of(job)

    def unhome():
        world.machine.motors[2].homed = False

    world.do(unhome, AT)
    ended = world.perform(perform(world.operation, job))
    assert not ended.well
    assert "motor 2: it isn't homed any more" in ended.what


# death of the host


@exercises(moving=0.5)
@settings(max_examples=50)
@given(st.floats(0.05, 4.4), st.sampled_from([5, 50]))
def test_a_host_that_dies_leaves_a_robot_at_rest_within_a_second(tally, at, tm):
    """After kill -9 or SIGSTOP of the host, no byte arrives any more. The robot rests within a second."""
    job, plan = prepared(tm=tm)
    world = world_of(job, record=True)
    since = world.now
    world.do(lambda: 1 / 0, at)
    with pytest.raises(ZeroDivisionError):
        world.perform(perform(world.operation, job))
    tally.count("moving", world.moving)
    silence, hold = world.operation.silence, job.robot.controller.hold_time
    assert silence + hold < 0.95
    world.machine.advance(silence + hold + 0.05)
    assert not world.moving
    assert moved_along(world, job, plan, since) < 1.0
    world.now = world.machine.now
    # The next client ends the rest of the motion.
    again = World(world.machine)
    again.perform(connect(again.operation))
    again.perform(end_what_runs(again.operation, job.robot, abort=False))
    assert not again.perform(look(again.operation, job.robot, items_of(job.robot))).errors


def test_a_link_that_pauses_is_held_and_goes_on():
    job, plan = prepared(tm=5)
    world = world_of(job, record=True)
    since = world.now
    world.stall_at = [(since + 1.0, 0.9)]
    assert world.perform(perform(world.operation, job)).well
    assert any("--patience" in text for text in said(world))
    assert moved_along(world, job, plan, since) < 1.0


def test_with_more_patience_it_is_not_held():
    job, _ = prepared(tm=20)
    world = world_of(job, prepare=False)
    world.operation.wanted_silence = 1.5
    world.prepare(job.robot)
    world.stall_at = [(world.now + 1.0, 0.6)]
    assert world.perform(perform(world.operation, job)).well
    assert State.HOLD not in world.states


@pytest.mark.parametrize("slowest", [0.0, 0.005, 0.1, 0.15, 0.3, 1.0])
@pytest.mark.parametrize("hold_time", [0.1, 0.25, 0.5, 0.8, 2.0])
def test_the_time_is_chosen_from_the_link(slowest, hold_time):
    patience = patience_for(slowest, hold_time)
    assert patience >= max(3.0 * slowest + 0.1, 0.25) - 1e-12
    if max(3.0 * slowest + 0.1, 0.25) + hold_time <= 0.95:
        assert patience + hold_time <= 0.95 + 1e-12
    if slowest <= 0.1 and hold_time <= 0.5:
        assert patience >= 0.4


def test_the_watchdog_is_wound_up_in_servo_cycles(industrial6):
    cycles = float(wound_up(industrial6.controller, 1.0).partition("=")[2])
    assert cycles == pytest.approx(np.ceil(2**23 / 3713.707), abs=1)


# lines that were changed in transit


@exercises(changed=0.6, found=0.1)
@settings(max_examples=30)
@given(st.integers(0, 2**31), st.sampled_from([5, 20, 50]))
def test_one_changed_digit_of_a_line_is_found_before_it_leads_far(tally, seed, tm):
    """A changed digit is noticed at the next report of the positions, if it leads off the path by more than
    the following error. A single point of 5 ms may be between two reports. A point far away trips its motor
    first.
    """
    job, plan = prepared(tm=tm)
    world = world_of(job, record=True)
    since, changed = world.now, []
    random = np.random.default_rng(seed)
    at = since + random.uniform(0.2, 3.0)
    answer = world._answers

    def spoilt(request, data):
        if isinstance(request, Write) and world.now >= at and not changed:
            lines = request.lines
            row = 1 + int(random.integers(len(lines) - 2))
            digits = [n for n, one in enumerate(lines[row]) if one.isdigit()]
            if digits and lines[row][0] in "XYZABC" and len(lines[row]) > 20:
                place = digits[int(random.integers(len(digits)))]
                other = str((int(lines[row][place]) + int(random.integers(1, 10))) % 10)
                line = lines[row][:place] + other + lines[row][place + 1 :]
                changed.append((lines[row], line))
                data = data.replace(lines[row].encode() + b"\0", line.encode() + b"\0")
        return answer(request, data)

    world._answers = spoilt
    ended = world.perform(perform(world.operation, job))
    tally.count("changed", bool(changed))
    if not changed:
        return
    away = moved_along(world, job, plan, since, step=0.005)
    found = "off the proved path" in ended.what
    tally.count("found", found)
    assert found or ended.well or "ended" in ended.what or "following error" in ended.what, ended
    if ended.well and tm > 5:
        # 0.04 deg, which is within the following error of a moving motor
        assert away < 1000.0, (away, changed)
    assert not world.moving


def test_lines_of_somebody_else_in_the_rotary_are_found():
    job, _ = prepared(tm=5)
    world = world_of(job)

    def meddle():
        for line in ("&1OPEN ROT", "X5Y0Z0A0B0C0", "CLOSE"):
            world.say(line)

    world.do(meddle, AT)
    ended = world.perform(perform(world.operation, job))
    assert not ended.well
    words = ("in reply to PR", "off the path", "following error")  # any of them may come first
    assert any(one in ended.what for one in words), ended.what


def test_the_paths_of_all_examples_are_on_their_course():
    """Correct programs cause no alarm: with couplings, BLENDs, dwells, arcs, and other overrides."""
    for robot in ("INDUSTRIAL6", "TRACKED_MANIPULATOR"):
        job, _ = example_of(robot, tm=10)
        world = world_of(job, delay=0.02)
        world.order(Override(60), 3.0)
        assert world.perform(perform(world.operation, job)).well
