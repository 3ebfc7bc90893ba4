"""Tests of MOVEL ... UNTIL TOUCH. The motion ends on its line where the input changes, and the following
motions are planned and proved from there.

Usually 15 searches are drawn; with YARCLANG_RANDOM_SEARCHES=1000 in the environment, that many, which takes
some minutes of one core.
"""

import os
from dataclasses import replace

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled
from runtime.virtual import moved_along, path_of, well_behaved, world_of

from yarclang.certify.certifying import certify
from yarclang.certify.flow import check_rests
from yarclang.coordinator.backwards import known_behind_searches, passed
from yarclang.decisions import Searched
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.parts import beginning, can_begin_at, chains, part
from yarclang.pipeline.replanning import replanned
from yarclang.pipeline.stages import Request
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.notices import Abort, Hold, Resume, Stop
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.state import State

HEAD = """INPUT TOUCH M12
OUTPUT LAMP M1
REGISTER DEPTH 0..50000
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEL 0 1174.4 1000 0 0 0 [2]
"""
PROGRAM = (
    HEAD
    + """P0020 MOVEL 0 1174.4 800 0 0 0 [V 100] UNTIL TOUCH INTO DEPTH
P0030 SET LAMP ON
P0040 WAIT [0.3]
P0050 MOVEL 0 1174.4 1000 0 0 0 [2]
P0060 MOVEJ 0 0 0 0 30 0 [2]
"""
)
ELSE = PROGRAM.replace(
    "INTO DEPTH\n",
    "INTO DEPTH ELSE\nP0025 MOVEL 0 1174.4 900 0 0 0 [1]\nP0026 MOVEL 0 1174.4 800 0 0 0 [1]\nEND\n",
)
BEGINS, ENDS = 2.0, 4.15
"""Times at which the line of the search begins and ends [s]."""
COUNT = int(os.environ.get("YARCLANG_RANDOM_SEARCHES", "15"))
REPLANNED = 0.05
"""Time that planning takes in virtual time [s]."""


def made(text=PROGRAM, *, touch=0, known=True, **options):
    """Return a world before the run, a job that searches for M12, and the compiled program."""
    value, found = compiled(text)
    assert value is not None, found
    job = job_of_compiled(value, "test")
    world = world_of(job, **options)
    for line in ("M12->*", f"M12={touch}", "M1->*", "M1=0"):
        world.say(line)
    anew = []

    def replan(wanted):
        commands = [one.begins for one in job.commands]
        number = int(np.argmin(np.abs(np.array(commands) - wanted.begins)))
        answer = replanned(value.plan, number, wanted.joints, Request(value.plan.robot))
        anew.append((wanted, answer))
        return answer

    if known:
        world.replan = replan
    world.anew = anew
    return world, job, value


def run(world, job):
    ended = world.perform(perform(world.operation, job))
    assert not world.moving
    return ended


def frame(robot, joints):
    return tool_poses(robot.chain, np.atleast_2d(joints), np.eye(4))[0, :3, 3]


def at_its_end(world, job):
    return np.abs(world.stands(job.robot) - to_counts(job.robot, job.end)).max() <= 1.0


@exercises(found=0.5)
@settings(max_examples=COUNT)
@given(st.floats(0.0, 6.0), st.floats(0.0, 0.003), st.integers(0, 2**32))
def test_a_touch_at_any_instant(tally, after, delay, seed):
    """The robot rests on its line, within the stated distance of the touch. All other motions are as without
    the touch.
    """
    world, job, value = made(record=True, delay=delay, seed=seed)
    robot, edge = job.robot, []

    def touch():
        world.say("M12=1")
        edge.append(from_counts(robot, world.stands(robot)))

    world.do(touch, after)
    ended = run(world, job)
    tally.count("found", bool(world.anew))
    if not world.anew:
        # The touch came after the line, or too late to be noticed.
        assert (ended.well, ended.code) == (False, "Y1635")
        return
    assert ended.well, ended
    assert at_its_end(world, job)
    ((wanted, answer),) = world.anew
    # The line is proved, and the robot brakes along it.
    assert path_of(value.plan).distance(to_counts(robot, wanted.joints)[None]) < 1.0
    came = np.linalg.norm(frame(robot, wanted.joints) - frame(robot, edge[0]))
    speed, hold = 0.1, robot.controller.hold_time
    # If the input already has the wanted value, the search ends at the beginning of its line.
    assert answer.length < 1e-6 or came <= speed * (0.005 + 6.0 * delay + 0.007 + hold) + 1e-5
    begin = frame(robot, value.plan.motions[1].curve.points[0])
    assert answer.length == pytest.approx(np.linalg.norm(frame(robot, wanted.joints) - begin), abs=1e-6)
    assert abs(dict(ended.registers)["DEPTH"] - answer.length * 1e5) <= 0.51
    assert world.say("M1") == ("1",)


def test_what_follows_is_proved_before_it_moves():
    world, job, value = made(record=True)
    world.do(lambda: world.say("M12=1"), 3.5)
    since = world.now
    assert run(world, job).well
    ((wanted, answer),) = world.anew
    (behind,) = answer.jobs
    assert behind.start == pytest.approx(wanted.joints, abs=1e-5)
    assert '"certified": true' in behind.certificate or behind.certificate
    assert [one.index for one in behind.commands] == ["P0050"]
    # The way down and the way up are the same line.
    assert moved_along(world, job, value.plan, since, step=0.05) < 1.0
    assert "TOUCH found" in world.words
    assert "SEARCH_1" not in world.words


def test_nothing_is_found():
    world, job, _ = made()
    ended = run(world, job)
    assert (ended.well, ended.code) == (False, "Y1635")
    assert "TOUCH was not ON up to the end of P0020" in ended.what
    world, job, _ = made(ELSE)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert not world.anew


def test_it_is_found_where_the_line_begins():
    world, job, _ = made(touch=1)
    ended = run(world, job)
    assert ended.well
    assert dict(ended.registers)["DEPTH"] == 0
    assert at_its_end(world, job)


def test_an_else_isn_t_taken_when_it_is_found():
    world, job, _ = made(ELSE)
    world.do(lambda: world.say("M12=1"), 3.0)
    ended = run(world, job)
    assert ended.well
    assert at_its_end(world, job)
    assert len(world.anew) == 1


@pytest.mark.parametrize("order", [Stop(), Abort()])
@pytest.mark.parametrize("after", [0.0, 0.02, 0.2])
def test_a_stop_just_behind_the_touch(order, after):
    world, job, _ = made()
    world.do(lambda: world.say("M12=1"), 3.0)
    world.order(order, 3.0 + after)
    ended = run(world, job)
    assert not ended.well
    assert world.operation.state is State.STOP


def test_a_hold_on_the_line():
    world, job, _ = made()
    world.order(Hold(), 3.0)
    world.do(lambda: world.say("M12=1"), 3.5)
    world.order(Resume(), 5.0)
    assert run(world, job).well
    assert at_its_end(world, job)


@pytest.mark.parametrize("after", [0.0, 0.02, 0.2, 0.4])
def test_a_hold_while_it_comes_to_rest(after):
    """A hold during braking lasts until a user resumes, wherever the robot comes to rest."""
    world, job, _ = made()
    since = world.now
    world.do(lambda: world.say("M12=1"), 3.0)
    world.order(Hold(), 3.0 + after)
    world.order(Resume(), 8.0)
    assert run(world, job).well
    assert at_its_end(world, job)
    assert world.now - since > 8.0
    assert State.HOLD in world.states


def test_nobody_knows_what_follows():
    world, job, _ = made(known=False)
    world.do(lambda: world.say("M12=1"), 3.0)
    ended = run(world, job)
    assert (ended.well, ended.code) == (False, "Y1638")


def test_a_register_that_is_too_small():
    world, job, _ = made(PROGRAM.replace("0..50000", "0..100"))
    world.do(lambda: world.say("M12=1"), 3.0)
    ended = run(world, job)
    assert (ended.well, ended.code) == (False, "Y1630")


def test_joints_search_too_and_in_a_loop():
    text = (
        "INPUT TOUCH M12\nREGISTER N 0..9\nDEFAULT (deg,s)\nLOOP\n"
        "  P10 MOVEJ 20 0 0 0 30 0 [1] UNTIL TOUCH OFF ELSE\n    P15 WAIT [0.1]\n  END\n"
        "  P20 MOVEJ 0 0 0 0 30 0 [1]\n  P30 SET N = N + 1\nUNTIL N = 3\n"
    ).replace("LOOP\n", "P5 MOVEJ 0 0 0 0 30 0 [1]\nLOOP\n", 1)
    world, job, _ = made(text, touch=1)
    world.do(lambda: world.say("M12=0"), 3.5)
    world.do(lambda: world.say("M12=1"), 4.3)
    ended = run(world, job)
    assert ended.well, ended
    assert len(world.anew) == 1
    assert at_its_end(world, job)


def test_well_behaved():
    world, job, _ = made(PROGRAM.replace("P0030 SET LAMP ON\n", ""))
    world.do(lambda: world.say("M12=1"), 3.0)
    assert run(world, job).well
    well_behaved(world)


SEARCH = "; search 2 M12=1 TOUCH SEARCH_1 DEPTH\n"


@pytest.mark.parametrize(
    "change",
    [
        (SEARCH, ""),
        (SEARCH, SEARCH * 2),
        (SEARCH, SEARCH.replace(" 2 ", " 0 ")),
        (SEARCH, SEARCH.replace("=1", "=0")),
        (SEARCH, SEARCH.replace("M12", "M13")),
        (SEARCH, SEARCH.replace("TOUCH", "DOOR")),
        (SEARCH, SEARCH.replace("SEARCH_1", "DEPTH")),
        (SEARCH, SEARCH.replace(" DEPTH", " -")),
        (SEARCH, SEARCH.replace(" DEPTH", " SEARCH_1")),
        (SEARCH, SEARCH.replace(" DEPTH", "")),
    ],
)
def test_the_certificate_refuses_a_text_that_searches_otherwise(change, industrial6):
    program, _ = compiled(PROGRAM)
    assert change[0] in program.text, [line for line in program.text.splitlines() if "search" in line]
    changed = program.text.replace(*change, 1)
    judged = certify(changed, program.program, industrial6, industrial6.tolerance)
    assert any(one.is_error for one in judged.diagnostics), change


@pytest.mark.parametrize(("index", "alone"), [("P0020", True), ("P0060", False), ("P0070", False)])
def test_what_is_streamed_with_others_is_never_ended(index, alone):
    """P0060 and P0070 are in one leg, so an input that ends one of them would end both. A forged certificate
    for this is refused.
    """
    program, found = compiled(PROGRAM + "P0070 MOVEJ 0 0 0 0 40 0 [2]\n")
    assert program is not None, found
    content = program.certificate.text
    step = next(entry.step for entry in content.entries if entry.index == index and entry.first)
    forged = replace(content, searches=(Searched(step, "M12", 1.0, "TOUCH", "SEARCH_1"),))
    told = [message for _, message in check_rests(forged, program.plan.program.start, np.full(6, 1e-3))]
    assert any("streamed together" in one for one in told) != alone


def test_step_by_step_a_search_goes_on_to_where_it_is_known_again():
    value, _ = compiled(PROGRAM)
    assert chains(value.plan) == [(0, 1), (1, 3), (3, 4)]


@pytest.mark.parametrize("fault", ["drop@3.05", "drop@3.3", "freeze@3.02", "reset@3.1"])
def test_what_fails_while_it_comes_to_rest(fault):
    """If the connection or the controller is lost just after the touch, the run ends, and nothing continues
    by itself.
    """
    world, job, _ = made()
    world.do(lambda: world.say("M12=1"), 3.0)
    world.spoil_by(fault)
    ended = run(world, job)
    assert not ended.well
    assert world.anew == [] or "TOUCH" in world.words


@pytest.mark.parametrize("place", ["P0030", "P0040", "P0050"])
def test_no_run_begins_where_a_search_has_ended(place):
    """No run can begin with the motion after a search. Only the run with the search knows where it has ended,
    and the way from the robot's position to the line's end may not be free.
    """
    value, _ = compiled(PROGRAM)
    number, step = beginning(value.plan, place)
    assert not can_begin_at(value.plan, place)
    made = part(value.plan, Request(value.plan.robot), number, 4, with_lead=False, step=step)
    assert [one.code for one in made.diagnostics] == ["Y1608"]
    assert "P0020" in made.diagnostics[0].help
    for begins in ("P0020", "P0060"):
        number, step = beginning(value.plan, begins)
        assert (
            part(value.plan, Request(value.plan.robot), number, 4, with_lead=False, step=step).value
            is not None
        )


def test_no_way_back_leads_to_the_end_of_a_search():
    value, _ = compiled(PROGRAM)
    motions = passed(value.plan)
    assert [one.step.origin.index for one in motions] == ["P0010", "P0020", "P0050", "P0060"]
    assert [one.step.origin.index for one in known_behind_searches(motions)] == ["P0060"]
    assert known_behind_searches(motions[:3]) == []
    assert known_behind_searches(motions[:1]) == list(motions[:1])
    # A search that was stopped on its line can be driven back along this line.
    stopped = passed(value.plan, value.plan.sample(np.array([3.0]))[0][0], 3.0)
    assert [one.step.origin.index for one in known_behind_searches(stopped)] == ["P0010", "P0020"]
