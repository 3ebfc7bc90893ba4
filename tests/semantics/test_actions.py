"""Tests of WAIT, SET, HOLD and WHEN, and of the options of motions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, planned

from yarclang.hir import Dwell, Else, EndWhen, Hold, JointMove, SetOutput, WaitInput, When

HEAD = "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nINPUT DOOR M11\nOUTPUT GLUE M1 OFF\nJOINTS LOW 0 0 0 0 20 0\n"


def one(line):
    program, found = checked(f"{HEAD}P0010 {line}")
    (step,) = program.steps
    return step, codes(found)


@given(st.integers(1, 3_600_000))
def test_a_wait_is_a_dwell_of_its_time(ms):
    step, found = one(f"WAIT [{ms}] (ms)")
    assert isinstance(step, Dwell)
    assert step.duration == pytest.approx(ms / 1000)
    assert found == []


def test_steps():
    text = (
        "P0010 WAIT DOOR ON [5]\n"
        "P0020 WAIT DOOR 3\n"
        "P0030 SET GLUE ON\n"
        "P0040 SET GLUE $(1.5+2)\n"
        'P0050 HOLD "go ! on"'
    )
    program, found = checked(HEAD + text)
    first, second, third, fourth, fifth = program.steps
    assert isinstance(first, WaitInput)
    assert (first.value, first.timeout, second.value, second.timeout) == (1.0, 5.0, 3.0, None)
    assert isinstance(third, SetOutput)
    assert (third.output.name, third.value, fourth.value) == ("GLUE", 1.0, 3.5)
    assert isinstance(fifth, Hold)
    assert fifth.text == "go ! on"
    assert codes(found) == ["Y1003"]
    (output,) = program.outputs
    assert (output.signal.variable, output.safe) == ("M1", 0.0)


@pytest.mark.parametrize("time", ["[0.5]", "[500] (ms)", "[$(1/2)]"])
def test_a_pulse_is_on_for_its_time(time):
    program, found = checked(f"{HEAD}P0010 PULSE GLUE {time}")
    on, stands, off = program.steps
    assert (on.output.name, on.value, off.output.name, off.value) == ("GLUE", 1.0, "GLUE", 0.0)
    assert isinstance(stands, Dwell)
    assert stands.duration == pytest.approx(0.5)
    assert on.origin == stands.origin == off.origin
    assert codes(found) == []


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("PULSE GLUE", "Y0406"),
        ("PULSE GLUE [MIN]", "Y0407"),
        ("PULSE GLUE [0]", "Y0407"),
        ("PULSE GLUE [3601]", "Y0407"),
        ("PULSE GLUE ON [1]", "Y0401"),
        ("PULSE [1]", "Y0401"),
        ("PULSE DOOR [1]", "Y0209"),
        ("PULSE GLUE [1] BLEND 5", "Y0408"),
    ],
)
def test_a_pulse_that_is_refused(line, code):
    assert codes(checked(f"{HEAD}P0010 {line}")[1]) == [code]


def test_when_keeps_both_ways():
    text = "WHEN DOOR OFF\nP0010 MOVEJ LOW\nELSE\nREPEAT 2\nP0020 MOVEJ LOW\nEND\nEND"
    kinds = [type(step) for step in checked(HEAD + text)[0].steps]
    assert kinds == [When, JointMove, Else, JointMove, JointMove, EndWhen]
    assert "Y1002" not in codes(planned(HEAD + text)[1])


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("WHEN DOOR OFF\nP0010 MOVEJ LOW\nEND", 5),
        ("WHEN DOOR OFF\nP0010 MOVEJ LOW\nELSE\nP0020 MOVEJ 5 0 0 0 0 0\nEND", 5),
        (
            "WHEN DOOR OFF\nWHEN DOOR ON\nP0010 MOVEJ LOW\nELSE\nP0015 MOVEJ LOW\nEND\nELSE\nP0020 HOLD\nEND",
            5,
        ),
    ],
)
def test_ways_that_end_apart_are_one_finding_at_the_when(text, line):
    found = [each for each in planned(HEAD + text)[1] if each.code == "Y1002"]
    assert [each.span.line for each in found] == [line]


def test_stop_in_a_way_ends_it_and_what_follows_stays():
    program, found = checked(f"{HEAD}WHEN DOOR OFF\nP0010 STOP\nEND\nP0020 MOVEJ LOW")
    assert codes(found) == []
    assert [type(one).__name__ for one in program.steps] == ["When", "Finish", "EndWhen", "JointMove"]


@pytest.mark.parametrize(
    ("text", "codes_"),
    [
        # the command after the WHEN can be reached if any branch goes on
        ("WHEN DOOR OFF\nP10 STOP\nELSE\nP20 SET GLUE ON\nEND\nP30 SET GLUE OFF", []),
        ("WHEN DOOR OFF\nP10 STOP\nP20 SET GLUE ON\nEND", ["Y1001"]),
        ('WHEN DOOR OFF\nP10 ABORT "a"\nREPEAT 2\nP20 SET GLUE ON\nEND\nEND', ["Y1001"]),
        ('WHEN DOOR OFF\nP10 STOP\nELSE\nP20 ABORT "a"\nEND\nP30 SET GLUE ON', ["Y1001"]),
        ('WHEN DOOR OFF\nP10 STOP\nELSE\nP20 ABORT "a"\nEND\nWHEN DOOR OFF\nP30 SET GLUE ON\nEND', ["Y1001"]),
        ('CASE DOOR\nOF 1\nP10 STOP\nOF 2\nP20 ABORT "a"\nELSE\nP30 STOP\nEND\nP40 SET GLUE ON', ["Y1001"]),
        ('CASE DOOR\nOF 1\nP10 STOP\nOF 2\nP20 ABORT "a"\nELSE\nEND\nP40 SET GLUE OFF', []),
        ('P10 ABORT "a"\nP20 SET GLUE ON', ["Y1001"]),
        ("P10 ABORT", ["Y0401"]),
        ("WHEN DOOR OFF\nP10 ABORT DOOR\nEND", ["Y0401"]),
    ],
)  # fmt: skip
def test_what_is_reached_after_ways_that_end_the_program(text, codes_):
    _, found = checked(f"{HEAD}{text}")
    assert codes(found) == codes_


@pytest.mark.parametrize(
    ("text", "codes_"),
    [
        # a branch that ends the program may end anywhere; without an ELSE, the robot stays where it is
        ("WHEN DOOR OFF\nP10 MOVEJ LOW\nP20 STOP\nEND\nP30 MOVEJ HOME", []),
        ("WHEN DOOR OFF\nP10 MOVEJ LOW\nELSE\nP20 MOVEJ 1 0 0 0 0 0 [5] (deg,s)\nP30 STOP\nEND", []),
        ("WHEN DOOR OFF\nP10 MOVEJ LOW\nWHEN DOOR ON\nP20 STOP\nELSE\nP30 STOP\nEND\nEND\nP40 MOVEJ LOW", []),
        ("WHEN DOOR OFF\nP10 MOVEJ LOW\nWHEN DOOR ON\nP20 STOP\nEND\nEND\nP40 MOVEJ LOW", ["Y1002"]),
    ],
)  # fmt: skip
def test_a_way_that_ends_the_program_may_end_anywhere(text, codes_):
    found = [one.code for one in planned(f"{HEAD}{text}")[1] if one.is_error]
    assert found == codes_


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("WAIT", "Y0406"),
        ("WAIT [0]", "Y0407"),
        ("WAIT [3601]", "Y0407"),
        ("WAIT [MIN]", "Y0407"),
        ("WAIT [$(5 (mm))]", "Y0307"),
        ("WAIT DOOR [5]", "Y0401"),
        ("WAIT GLUE ON [5]", "Y0209"),
        ("WAIT DOR ON [5]", "Y0210"),
        ("WAIT {TCP} [5]", "Y0408"),
        ("SET GLUE", "Y0401"),
        ("SET DOOR ON", "Y0209"),
        ("SET GLUE OPEN", "Y0402"),
        ("SET GLUE $(2 (mm))", "Y0307"),
        ("SET GLUE ON [5]", "Y0408"),
        ("HOLD 5", "Y0401"),
        ('HOLD "a" [5]', "Y0408"),
        ("MOVEJ LOW ACC 101%", "Y0412"),
        ("MOVEJ LOW ACC 30", "Y0412"),
        ("MOVEJ LOW TOL -1", "Y0412"),
        ("MOVEJ LOW TOL $(1 (s))", "Y0307"),
        ("MOVEJ LOW NEAR HOME", "Y0412"),
        ("MOVEJ_RPY 0 1174.4 1176 0 0 0 NEAR DOOR", "Y0209"),
        ("MOVEJ_RPY 0 1174.4 1176 0 0 0 NEAR 5", "Y0412"),
        ("MOVEJ LOW [0%]", "Y0407"),
        ("MOVEJ LOW [$(5 (mm))%]", "Y0307"),
    ],
)
def test_refused(line, code):
    assert one(line)[1] == [code]


def test_near_picks_the_solution():
    pose = "MOVEJ_RPY 0 1174.4 1176 0 0 0"
    ends = {}
    for near in ("0 0 0 0 60 0", "0 0 0 170 -60 -170"):
        text = f"{HEAD}JOINTS HERE {near}\nP0010 {pose} NEAR HERE"
        plan, found = planned(text)
        assert codes(found) == []
        ends[near] = np.degrees(plan.motions[0].waypoints[-1])
        goal = checked(text)[0].steps[0].goal
        assert np.degrees(goal.near) == pytest.approx([float(part) for part in near.split()])
    first, second = ends.values()
    assert np.abs(first - second).max() > 90


def test_time_and_acc_and_tol_reach_the_plan():
    plain = one("MOVEJ LOW")[0].timing
    assert (plain.duration, plain.share, plain.ramp) == (None, 1.0, 1.0)
    step = one("MOVEL 0 1174.4 1176 0 0 0 [50%] ACC 30% TOL 0.05")[0]
    assert (step.timing.share, step.timing.ramp) == (0.5, 0.3)
    assert step.tolerance == pytest.approx(5e-5)
    assert one("MOVEJ LOW [$(2*3)]")[0].timing.duration == 6.0
    assert one("MOVEJ LOW [$(200 (ms))]")[0].timing.duration == pytest.approx(0.2)
    assert one("MOVEJ LOW [$(5*5)%]")[0].timing.share == 0.25
