"""Tests of programs with barriers: outputs, dwells, waits for inputs, holds, and branches of WHEN, for both
kinds of controller text.
"""

import numpy as np
import pytest
from programs import compiled

from tests.runtime.virtual import World
from yarclang.backend_pmac.settings import settings_text
from yarclang.certify.certifying import certify
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.robot.actuation import from_counts
from yarclang.runtime.notices import Abort, Changed, Hold, Progress, Resume, Stop
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.runtime.signals import OutputSet, WaitBegan, WaitEnded, signal_text
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import commissioned

HEAD = "INPUT DOOR M11\nOUTPUT GLUE M1 OFF\nOUTPUT LAMP M2\n"
OUT = "MOVEJ 20 0 0 0 0 0 [1] (deg,s)"
HOME = "MOVEJ 0 0 0 0 0 0 [1] (deg,s)"


def world(robot):
    machine = commissioned(robot, settings_text(robot))
    made = World(machine)
    for line in ("M1->*", "M2->*", "M11->*", "M1=0", "M2=0", "M11=0"):
        assert machine.command(line, 7).error is None
    made.perform(connect(made.operation))
    return made


def value(made, name):
    return float(made.machine.command(name, 7).items[0])


def job(robot, *lines, target="rotary"):
    text = HEAD + "\n".join(lines) + "\n"
    program, _ = compiled(text, robot.name, target=target)
    return program if target == "prog" else job_of_compiled(program, "legs")


def joints(made, robot):
    counts = made.machine.positions(motors=robot.controller.motors)
    return np.degrees(from_counts(robot, counts))


def states(made):
    return [one.state for one in made.told if isinstance(one, Changed)]


def progress(made):
    return [one for one in made.told if isinstance(one, Progress)]


@pytest.fixture
def robot(industrial6):
    return industrial6


def test_an_output_is_set_when_the_motion_before_it_has_ended(robot):
    made = world(robot)
    run = job(robot, f"P10 {OUT}", "P20 SET LAMP ON", f"P30 {HOME}", "P40 SET LAMP 2.5")
    seen = []
    for k in range(400):
        made.at.append(
            (made.now + 0.01 * k, lambda: seen.append((value(made, "M2"), joints(made, robot)[0])))
        )
    assert made.perform(perform(made.operation, run)).well
    before = [place for lamp, place in seen if lamp == 0.0]
    on = [place for lamp, place in seen if lamp == 1.0]
    assert before[-1] == pytest.approx(20.0, abs=1e-3)
    assert on[0] == pytest.approx(20.0, abs=1e-3)
    assert on[-1] == pytest.approx(0.0, abs=1e-3)
    assert value(made, "M2") == 2.5


def test_a_wait_for_an_input(robot):
    made = world(robot)
    made.at.append((made.now + 3.0, lambda: made.machine.command("M11=1", 7)))
    ended = made.perform(
        perform(made.operation, job(robot, f"P10 {OUT}", "P20 WAIT DOOR ON [5] (s)", f"P30 {HOME}"))
    )
    assert ended.well
    assert State.HOLD in states(made)
    assert made.now > 4.0


def test_sets_and_waits_are_told(robot):
    """Each SET is reported when it is carried out, and each WAIT at its beginning and end, even if its
    condition is fulfilled at once. Between two legs, no reported state says that the program has ended.
    """
    made = world(robot)
    made.operation.outputs = {"M2": "LAMP"}
    made.at.append((made.now + 3.0, lambda: made.machine.command("M11=1", 7)))
    lines = (
        f"P10 {OUT}",
        "P20 SET LAMP ON",
        "P30 WAIT DOOR ON",
        "P40 WAIT DOOR ON",
        f"P50 {HOME}",
        "P60 SET GLUE OFF",
    )
    assert made.perform(perform(made.operation, job(robot, *lines))).well
    told = [one for one in made.told if isinstance(one, OutputSet | WaitBegan | WaitEnded)]
    assert [type(one) for one in told] == [OutputSet, WaitBegan, WaitEnded, WaitBegan, WaitEnded, OutputSet]
    lamp, begins, ends, at_once, met, glue = told
    assert (lamp.name, lamp.value, glue.name, glue.value) == ("LAMP", 1.0, "M1", 0.0)
    assert (begins.place, begins.name, begins.wanted, begins.value) == ("P0030", "DOOR", 1.0, 0.0)
    assert (ends.value, ends.met) == (1.0, True)
    assert ends.waited == pytest.approx(ends.time - begins.time, abs=0.01)
    assert (at_once.place, at_once.value, met.waited) == ("P0040", 1.0, 0.0)
    why = [one.why for one in made.told if isinstance(one, Changed) and one.why]
    assert why == [
        "loading legs",
        "at P0030 WAIT",
        "P0030 WAIT waits for DOOR to be ON",
        "at the end of legs, to a count",
    ]


def test_a_wait_that_is_over_is_told(robot):
    made = world(robot)
    assert not made.perform(
        perform(made.operation, job(robot, "P10 WAIT DOOR ON [1] (s)", f"P20 {OUT}"))
    ).well
    ends = next(one for one in made.told if isinstance(one, WaitEnded))
    assert not ends.met
    assert ends.waited == pytest.approx(1.0, abs=0.1)
    assert signal_text(ends) == "P0010 WAIT: DOOR is still OFF after 1.0 s"


DWELLS = (f"P10 {OUT}", "P20 WAIT [2] (s)", "P21 WAIT [1] (s)", f"P30 {HOME}", "P40 WAIT [1.5] (s)")


def test_dwells_count(robot):
    made, run = world(robot), job(robot, *DWELLS)
    assert run.duration == run.lasting.most == pytest.approx(6.5)
    since = made.now
    assert made.perform(perform(made.operation, run)).done == pytest.approx(6.5)
    # The dwell of the last leg is executed, although the leg contains no motion.
    assert made.now - since > 6.5
    told = progress(made)
    for one in told:
        assert one.done + one.left == pytest.approx(6.5)
    done = np.array([one.done for one in told])
    times = np.array([one.time for one in told])
    assert (np.diff(done) >= -1e-9).all()
    # During a dwell, the progress increases with the clock.
    late = times - done
    assert np.ptp(late[(done > 0.2) & (done < 6.4)]) < 0.4


def test_an_override_slows_no_dwell(robot):
    made, run = world(robot), job(robot, *DWELLS)
    made.operation.override = 0.5
    since = made.now
    assert made.perform(perform(made.operation, run)).well
    assert made.now - since == pytest.approx(2 * 2.0 + 4.5, abs=1.0)
    for one in progress(made)[1:]:
        assert one.done + one.left >= 6.5 - 1e-9
        assert one.left <= 2 * 2.0 + 4.5 + 1e-9


def test_a_dwell_before_a_wait_is_carried_out(robot):
    made = world(robot)
    run = job(robot, f"P10 {OUT}", "P20 WAIT [3] (s)", "P30 WAIT DOOR OFF [1] (s)", "P40 SET LAMP ON")
    since, seen = made.now, []
    for k in range(60):
        made.at.append((made.now + 0.1 * k, lambda k=k: seen.append((0.1 * k, value(made, "M2")))))
    assert made.perform(perform(made.operation, run)).well
    assert made.now - since > 4.0
    assert not any(lamp for time, lamp in seen if time < 4.0)


def test_what_is_left_counts_all_legs(robot):
    made = world(robot)
    lines = (f"P10 {OUT}", "P20 WAIT DOOR ON [5] (s)", f"P30 {HOME}", "P40 WAIT [1] (s)")
    run = job(robot, *lines)
    assert (run.lasting.most, run.lasting.waits) == (pytest.approx(3.0), 1)
    made.do(lambda: made.machine.command("M11=1", 7), 3.0)
    assert made.perform(perform(made.operation, run)).well
    for one in progress(made):
        assert one.done + one.left == pytest.approx(3.0)


def test_ways_count_the_longer_one(robot):
    made = world(robot)
    way = ("WHEN DOOR ON", "P20 WAIT [4] (s)", "ELSE", "P30 WAIT [1] (s)", "END")
    run = job(robot, f"P10 {OUT}", *way, f"P40 {HOME}")
    assert (run.lasting.least, run.lasting.most) == pytest.approx((3.0, 6.0))
    assert made.perform(perform(made.operation, run)).well
    told = progress(made)
    for one in told:
        assert one.done + one.left == pytest.approx(6.0)
    # Both branches begin at 1 s. The shorter one ends at 2 s, and progress then jumps to the end of the
    # longer one at 5 s.
    assert not any(2.1 < one.done < 4.9 for one in told)


def test_an_input_that_never_comes(robot):
    made = world(robot)
    ended = made.perform(
        perform(made.operation, job(robot, f"P10 {OUT}", "P20 WAIT DOOR ON [2] (s)", f"P30 {HOME}"))
    )
    assert not ended.well
    assert "P0020 WAIT has waited 2 s for DOOR (M11) to be ON: it is OFF" in ended.what
    assert ended.command_index == "P0020"
    assert np.degrees(ended.joints)[0] == pytest.approx(20.0, abs=1e-3)
    assert made.operation.state is State.FAULT


@pytest.mark.parametrize(("door", "lamp"), [(0, 1.0), (1, 0.0)])
def test_ways(robot, door, lamp):
    made = world(robot)
    made.machine.command(f"M11={door}", 7)
    lines = (
        "WHEN DOOR OFF",
        f"P10 {OUT}",
        "P20 SET LAMP ON",
        f"P30 {HOME}",
        "ELSE",
        "P40 DMOVEJ 0 5 0 0 0 0 [1] (deg,s)",
        f"P50 {HOME}",
        "END",
        f"P60 {OUT}",
    )
    seen = []
    for k in range(200):
        made.at.append((made.now + 0.02 * k, lambda: seen.append(joints(made, robot)[1])))
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert ended.well
    assert value(made, "M2") == lamp
    assert (max(seen) > 4.9) == bool(door)
    assert joints(made, robot)[0] == pytest.approx(20.0, abs=1e-3)


def test_nested_ways(robot):
    made = world(robot)
    lines = (
        "WHEN DOOR ON",
        f"P10 {OUT}",
        f"P20 {HOME}",
        "ELSE",
        "WHEN DOOR OFF",
        "P30 SET LAMP 3",
        "ELSE",
        "P40 SET LAMP 4",
        "END",
        "END",
        f"P60 {OUT}",
    )
    assert made.perform(perform(made.operation, job(robot, *lines))).well
    assert value(made, "M2") == 3.0


def test_outputs_are_safe_while_the_operator_is_waited_for(robot):
    made = world(robot)
    run = job(robot, "P10 SET GLUE ON", f"P20 {OUT}", 'P30 HOLD "look"', f"P40 {HOME}")
    seen = {}
    made.at.append((made.now + 0.7, lambda: seen.setdefault("moving", value(made, "M1"))))
    made.at.append((made.now + 2.0, lambda: seen.setdefault("held", value(made, "M1"))))
    made.at.append((made.now + 3.0, lambda: made.operation.orders.append(Resume())))
    made.at.append((made.now + 3.6, lambda: seen.setdefault("resumed", value(made, "M1"))))
    assert made.perform(perform(made.operation, run)).well
    assert seen == {"moving": 1.0, "held": 0.0, "resumed": 1.0}
    assert value(made, "M1") == 0.0, "the program has ended"


def test_an_output_that_was_set_in_a_blend_comes_back_after_a_hold(robot):
    """In a blend, the output is set in step with a move (M1==1), not at rest."""
    made = world(robot)
    run = job(
        robot, f"P10 {OUT} BLEND 4", "P20 SET GLUE ON", "P30 MOVEJ 40 0 0 0 0 0 [2] (deg,s)", f"P40 {OUT}"
    )
    assert "M1==1" in run.lines
    seen = {}
    made.at.append((made.now + 2.2, lambda: seen.setdefault("moving", value(made, "M1"))))
    made.at.append((made.now + 2.3, lambda: made.operation.orders.append(Hold())))
    made.at.append((made.now + 3.5, lambda: seen.setdefault("held", value(made, "M1"))))
    made.at.append((made.now + 4.0, lambda: made.operation.orders.append(Resume())))
    made.at.append((made.now + 4.6, lambda: seen.setdefault("resumed", value(made, "M1"))))
    assert made.perform(perform(made.operation, run)).well
    assert seen == {"moving": 1.0, "held": 0.0, "resumed": 1.0}


@pytest.mark.parametrize("order", [Stop(), Abort()])
def test_a_stop_at_a_barrier(robot, order):
    made = world(robot)
    run = job(robot, "P10 SET GLUE ON", f"P20 {OUT}", "P30 WAIT DOOR ON [50] (s)", f"P40 {HOME}")
    made.at.append((made.now + 3.0, lambda: made.operation.orders.append(order)))
    ended = made.perform(perform(made.operation, run))
    assert not ended.well
    assert made.now < 5.0
    assert value(made, "M1") == 0.0
    assert made.operation.state is State.STOP
    assert joints(made, robot)[0] == pytest.approx(20.0, abs=1e-3)


def test_outputs_are_safe_behind_a_stop_in_motion(robot):
    made = world(robot)
    made.at.append((made.now + 0.6, lambda: made.operation.orders.append(Stop())))
    ended = made.perform(perform(made.operation, job(robot, "P10 SET GLUE ON", f"P20 {OUT}")))
    assert not ended.well
    assert value(made, "M1") == 0.0


def test_a_program_buffer_waits_by_itself(robot):
    machine = commissioned(robot, settings_text(robot))
    program = job(
        robot,
        "P10 SET LAMP ON",
        f"P20 {OUT}",
        "P30 WAIT DOOR ON [2] (s)",
        "WHEN DOOR ON",
        f"P40 {HOME}",
        "ELSE",
        "P45 SET LAMP 9",
        f"P46 {HOME}",
        "END",
        'P50 HOLD "look"',
        f"P60 {OUT}",
        target="prog",
    )
    for line in program.text.splitlines():
        if not line.startswith(";"):
            assert machine.command(line).error is None, line
    for line in ("M1->*", "M2->*", "M11->*", "M11=0", "&1B1R"):
        assert machine.command(line).error is None, line
    machine.advance(2.0)
    assert machine.command("M2").items == ("1",)
    machine.advance(4.0)
    assert machine.messages() == ("YARC: DOOR IS NOT 1 AFTER 2 S",)
    machine.command("R")
    machine.advance(4.0)
    assert machine.messages() == ("YARC: DOOR IS NOT 1 AFTER 2 S",), "R doesn't get past it"
    machine.command("M11=1")
    machine.command("R")
    machine.advance(3.0)
    assert machine.messages() == ("YARC: look",)
    assert machine.command("M2").items == ("1",)
    machine.command("R")
    machine.advance(3.0)
    assert not machine.systems[1].running
    assert machine.command("P1").items[0].startswith(("20", "19.99"))


PROGRAM = (
    f"P10 {OUT}\n"
    "P20 SET LAMP ON\n"
    "P30 WAIT DOOR ON [5] (s)\n"
    "WHEN DOOR ON\n"
    f"P40 {HOME}\n"
    "ELSE\n"
    f"P50 {HOME}\n"
    "END\n"
    "P60 WAIT [1] (s)\n"
)


@pytest.mark.parametrize(
    "change",
    [
        ("M2=1\n", ""),  # an output is missing
        ("M2=1\n", "M2=0\n"),
        ("M2=1\n", "M2=1\nM2=1\n"),
        ("DWELL1000\n", "DWELL100\n"),
        ("DWELL1000\n", ""),
        ("STOP\n", "DWELL0\n"),  # a barrier is missing
        (" M11=1 5 ", " M11=0 5 "),
        (" M11=1 5 ", " M11=1 50 "),
        (" wait ", " hold "),
        ("M1=0\nENDIF", "M1=1\nENDIF"),  # another value than the safe one
        ("DWELL0\nM2=1", "M2=1"),  # set while the robot moves
    ],
)
def test_the_certificate_refuses_another_flow(robot, change):
    program, _ = compiled(HEAD + PROGRAM, robot.name)
    assert change[0] in program.text
    changed = program.text.replace(*change, 1)
    judged = certify(changed, program.program, robot, robot.tolerance)
    assert any(one.is_error for one in judged.diagnostics), change


def test_a_part_never_begins_or_ends_inside_a_when(robot):
    from yarclang.pipeline.parts import part
    from yarclang.pipeline.stages import Request

    program, _ = compiled(HEAD + PROGRAM, robot.name)
    request = Request(robot)
    assert part(program.plan, request, 0).value is not None
    for first, last in ((1, None), (2, None), (0, 2), (1, 2)):
        refused = part(program.plan, request, first, last)
        assert refused.value is None
        assert [one.code for one in refused.diagnostics] == ["Y1164"]


@pytest.mark.parametrize(
    "wait",
    [
        ("P20 WAIT DOOR ON [5] (s)",),
        ("P20 WAIT DOOR > 0 [5] (s)",),
        ("P20 WAIT DOOR ON [5] (s) ELSE", "END"),
        ("WHILE DOOR OFF", "END"),
    ],
)
def test_a_hold_during_a_wait(robot, wait):
    """A person holds during a wait: the robot doesn't move although the input comes, outputs have their safe
    values, and the time limit doesn't run. The program goes on after a resume.
    """
    made, seen = world(robot), []

    def look():
        seen.append((value(made, "M1"), joints(made, robot)[0]))

    orders = made.operation.orders
    made.at += [
        (made.now + 3.0, lambda: orders.extend((Resume(), Hold()))),
        (made.now + 4.0, lambda: made.machine.command("M11=1", 7)),
        (made.now + 12.0, look),
        (made.now + 13.0, lambda: orders.append(Resume())),
        (made.now + 13.5, look),
    ]
    lines = (f"P10 {OUT}", "P15 SET GLUE ON", *wait, f"P40 {HOME}")
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert ended.well, ended
    (held, there), (glue, under_way) = seen
    assert (held, glue) == (0.0, 1.0)
    assert there == pytest.approx(20.0, abs=1e-3)
    assert under_way < 19.9
    assert any("held " in one.why for one in made.told if isinstance(one, Changed))


def test_a_wait_after_a_hold(robot):
    """After a resume the wait continues, and its time limit runs from there."""
    made = world(robot)
    orders = made.operation.orders
    made.at += [
        (made.now + 3.0, lambda: orders.append(Hold())),
        (made.now + 13.0, lambda: orders.append(Resume())),
    ]
    lines = (f"P10 {OUT}", "P20 WAIT DOOR ON [5] (s)", f"P40 {HOME}")
    ended = made.perform(perform(made.operation, job(robot, *lines)))
    assert (ended.well, ended.code) == (False, "Y1604")
    assert made.now == pytest.approx(1.0 + 5.0 + 10.0, abs=1.5)
    whys = [one.why for one in made.told if isinstance(one, Changed)]
    assert whys.count("P0020 WAIT waits for DOOR to be ON") == 2


@pytest.mark.parametrize("wait", ["WAIT DOOR ON", "WAIT DOOR > 0", 'HOLD "look"'])
def test_a_host_that_slept_in_a_wait(robot, wait):
    """The host sleeps for long while the program waits. Neither the input, which comes meanwhile, nor an
    order to continue that was given meanwhile moves the robot: somebody may be near it by now.
    """
    made, seen = world(robot), []
    since, orders = made.now, made.operation.orders
    made.stall_at = [(since + 3.0, 60.0)]
    made.at += [
        (since + 20.0, lambda: made.machine.command("M11=1", 7)),
        (since + 21.0, lambda: orders.append(Resume())),
        (since + 62.9, lambda: orders.append(Resume())),
        (since + 80.0, lambda: seen.append(joints(made, robot)[0])),
        (since + 81.0, lambda: orders.append(Resume())),
    ]
    ended = made.perform(perform(made.operation, job(robot, f"P10 {OUT}", f"P20 {wait}", f"P40 {HOME}")))
    assert ended.well, ended
    assert seen == [pytest.approx(20.0, abs=1e-3)]
    assert made.now > since + 81.0
    assert any("is ignored" in getattr(one, "text", "") for one in made.told)
