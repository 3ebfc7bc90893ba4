"""Tests of analogue signals, which are groups whose numbers count steps; conditions on them are decided with
integers.
"""

from fractions import Fraction

import pytest
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes

from yarclang.decisions import evaluated
from yarclang.hir import SetOutput, WaitUntil, When

HEAD = (
    "INPUT PRESSURE M80..M91 STEP 0.01\n"
    "OUTPUT FLOW M92..M99 STEP 0.5 1\n"
    "REGISTER N 0..9\n"
    "REGISTER USED 0..9\n"
)
SIDES = {
    "<": lambda one, other: one < other,
    "<=": lambda one, other: one <= other,
    ">": lambda one, other: one > other,
    ">=": lambda one, other: one >= other,
    "=": lambda one, other: one == other,
    "<>": lambda one, other: one != other,
}


def steps(program):
    made, found = checked(HEAD + program)
    assert [one.code for one in found if one.is_error] == []
    return made.steps


@exercises(between=0.2, beyond=0.02)
@given(
    st.sampled_from(sorted(SIDES)),
    st.integers(-200, 45_000),
    st.sampled_from(["0.01", "0.05", "0.1", "0.3", "1", "2.5"]),
    st.booleans(),
    st.data(),
)
def test_a_comparison_holds_for_the_readings_for_which_the_values_compare(
    tally, operator, thousandths, step, mirrored, data
):
    value = Fraction(thousandths, 1000)
    raw = Fraction(value / Fraction(step))
    between = raw.denominator != 1
    tally.count("between", between)
    tally.count("beyond", not 0 <= raw <= 4095)
    number = f"{float(value):.3f}"
    sides = (number, "P") if mirrored else ("P", number)
    program = f"INPUT P M80..M91 STEP {step}\nWHEN {sides[0]} {operator} {sides[1]}\nP0010 WAIT [1] (s)\nEND"
    made, found = checked(program)
    if between and operator in ("=", "<>"):
        assert codes(found) == ["Y0472"]
        return
    assert codes(found) == []
    (when, *_) = made.steps
    assert isinstance(when, When)
    near = int(raw)
    variable = next(iter(_inputs(when.condition)))
    for reading in {
        0,
        4095,
        *(min(max(near + off, 0), 4095) for off in (-1, 0, 1)),
        data.draw(st.integers(0, 4095)),
    }:
        physical = reading * Fraction(step)
        pair = (value, physical) if mirrored else (physical, value)
        assert bool(evaluated(when.condition, {}, {variable: float(reading)})) == SIDES[operator](*pair)


def _inputs(value):
    from yarclang.decisions import inputs_of

    return [one.variable for one in inputs_of(value)]


def test_outputs_are_set_in_steps_and_their_safe_value_too():
    made, _ = checked(HEAD + "P0010 SET FLOW 2.5\nP0020 SET FLOW $(4*2)\nP0030 SET FLOW 0")
    bits = [int(one.value) for one in made.steps if isinstance(one, SetOutput)]
    numbers = [sum(bit << place for place, bit in enumerate(bits[at : at + 8])) for at in (0, 8, 16)]
    assert numbers == [5, 16, 0]
    assert [one.safe for one in made.outputs] == [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]


def test_waits_and_whens():
    wait, when, *_ = steps("P0010 WAIT PRESSURE > 4.505 [5] (s)\nWHEN PRESSURE 4.5\nP0020 WAIT [1] (s)\nEND")
    assert isinstance(wait, WaitUntil)
    (variable,) = set(_inputs(wait.condition))
    for reading, holds in ((450, False), (451, True)):
        assert bool(evaluated(wait.condition, {}, {variable: float(reading)})) is holds
    for reading, holds in ((449, False), (450, True), (451, False)):
        assert bool(evaluated(when.condition, {}, {variable: float(reading)})) is holds


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("P0010 SET FLOW 2.2", ["Y0472"]),
        ("P0010 SET FLOW 400", ["Y0470"]),
        ("P0010 SET FLOW -1", ["Y0470"]),
        ("P0010 SET FLOW N", ["Y0472"]),
        ("P0010 SET FLOW = N + 1", ["Y0472"]),
        ("P0010 SET FLOW = 2", ["Y0209"]),
        ("P0010 SET N = PRESSURE", ["Y0472"]),
        ("P0010 SET N = PRESSURE * 2", ["Y0472"]),
        ("P0010 WAIT PRESSURE = 4.505 [5] (s)", ["Y0472"]),
        ("P0010 WAIT PRESSURE > N [5] (s)", ["Y0472"]),
        ("P0010 WAIT PRESSURE + 1 > 4 [5] (s)", ["Y0472"]),
        ("P0010 WAIT PRESSURE ON [5] (s)", ["Y0471"]),
        ("CASE PRESSURE\nOF 1\nP0010 WAIT [1] (s)\nELSE\nP0020 WAIT [1] (s)\nEND", ["Y0472"]),
        ("INPUT X M11 STEP 0.1", ["Y0470"]),
        ("INPUT X M60..M63 STEP", ["Y0472"]),
        ("INPUT X M60..M63 STEP 0", ["Y0472"]),
        ("INPUT X M60..M63 STEP -1", ["Y0472"]),
        ("INPUT X M60..M63 STEP ON OFF", ["Y0401"]),
        ("OUTPUT X M60..M63 STEP 0.5 1.2", ["Y0472"]),
        ("INPUT X M60..M63 STEP 0.5\nP0010 WAIT X > PRESSURE [5] (s)", ["Y0472"]),
        ("INPUT X M60..M63 STEP 0.01\nP0010 WAIT X > PRESSURE [5] (s)", []),
    ],
)
def test_faults(line, expected):
    found = checked(f"{HEAD}{line}\nP0090 STOP")[1]
    assert [one.code for one in found if one.is_error] == expected
