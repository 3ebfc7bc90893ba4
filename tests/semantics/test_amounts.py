"""Tests of expressions: units in operators and functions; values are compared with Python's arithmetic."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes

from yarclang.semantics.values.amounts import Amount, AmountError, binary, function, unary
from yarclang.units import UNITS

NUMBERS = st.floats(-1e6, 1e6)
UNIT = st.sampled_from(sorted(UNITS.values(), key=lambda unit: unit.name))
DEFAULT = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"


def value_of(expression: str, before: str = "") -> float:
    """Return the value of an expression as J1 of a motion [deg]."""
    program, found = checked(f"{DEFAULT}{before}\nP0010 MOVEJ $({expression}) 0 0 0 0 0")
    assert codes(found) == []
    return math.degrees(program.steps[-1].goal.q[0])


def code_of(expression: str) -> list[str]:
    return codes(checked(f"{DEFAULT}LET X = {expression}\nP0010 STOP")[1])


@given(NUMBERS, NUMBERS, UNIT, UNIT)
def test_sums_and_comparisons_are_those_of_si(a, b, one, other):
    left, right = Amount(a, one), Amount(b, other)
    if one.kind != other.kind:
        for operator in ("+", "-", "=", "<>", "<", "<=", ">", ">=", "/", "%", "*"):
            if operator in "/%" and b == 0:
                continue
            with pytest.raises(AmountError) as error:
                binary(operator, left, right)
            assert error.value.code == "Y0307"
        return
    si, other_si = a * one.factor, b * other.factor
    size = max(abs(si), abs(other_si), 1e-300)
    found = binary("+", left, right)
    assert found.unit == one
    assert found.value * one.factor == pytest.approx(si + other_si, abs=1e-12 * size)
    if abs(si - other_si) > 1e-9 * size:
        assert binary("<", left, right).value == (si < other_si)
        assert binary(">=", left, right).value == (si >= other_si)
        least = function("MIN", (left, right))
        assert least.value * least.unit.factor == pytest.approx(min(si, other_si), abs=1e-12 * size)
    if abs(b) > 1e-6:
        ratio = binary("/", left, right)
        assert ratio.unit is None
        assert ratio.value == pytest.approx(si / other_si)


@given(NUMBERS, NUMBERS, UNIT)
def test_a_plain_number_takes_its_partners_unit(a, b, unit):
    assert binary("+", Amount(a), Amount(b, unit)) == Amount(a + b, unit)
    assert binary("-", Amount(a, unit), Amount(b)) == Amount(a - b, unit)
    assert binary("*", Amount(a), Amount(b, unit)) == Amount(a * b, unit)
    assert binary("<", Amount(a), Amount(b, unit)) == Amount(float(a < b))
    assert function("MAX", (Amount(a), Amount(b, unit))) == Amount(max(a, b), unit)
    assert unary("-", Amount(a, unit)) == Amount(-a + 0.0, unit)


@given(NUMBERS, UNIT, UNIT)
def test_a_number_is_converted_where_it_stands(a, unit, place):
    if unit.kind == place.kind:
        assert Amount(a, unit).in_unit(place) * place.factor == pytest.approx(a * unit.factor)
    else:
        with pytest.raises(AmountError):
            Amount(a, unit).in_unit(place)
    assert Amount(a).in_unit(place) == a


@given(st.floats(-1000, 1000))
def test_angles_of_functions(a):
    assert function("SIN", (Amount(a),)).value == math.sin(math.radians(a))
    assert function("COS", (Amount(a, UNITS["rad"]),)).value == pytest.approx(math.cos(a), abs=1e-9)
    assert function("ATAN2", (Amount(a), Amount(2.0))) == Amount(
        math.degrees(math.atan2(a, 2.0)), UNITS["deg"]
    )


@given(st.integers(-9, 9), st.integers(-9, 9), st.integers(1, 9), st.integers(0, 3))
def test_precedence_is_pythons(a, b, c, d):
    pairs = [
        (f"{a} + {b} * {c} ** {d}", a + b * c**d),
        (f"({a} + {b}) / {c}", (a + b) / c),
        (f"10 * ({a} < {b} AND NOT {c} = {d})", 10 * (a < b and c != d)),
        (f"-{c} ** 2 - {d}", -(c**2) - d),
        (f"{a} - {b} - {c}", a - b - c),
    ]
    for text, expected in pairs:
        if abs(expected) <= 100:
            assert value_of(text) == pytest.approx(expected, abs=1e-9), text


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("0.5 (rad)", math.degrees(0.5)),
        ("ATAN2(1, 1)", 45.0),
        ("30 * SIN(90)", 30.0),
        ("30 * SIN(PI / 2 * 1 (rad))", 30.0),
        ("FLOOR(2.7) + CEIL(2.1)", 5.0),
        ("ABS(-7) % 4", 3.0),
        ("-7 % 4", -3.0),
        ("SQRT(16) + MIN(3, 2, 4)", 6.0),
        ("20 (mm) / 1 (cm)", 2.0),
        ("1 + 0.1 (rad)", math.degrees(1.1)),
        ("(3 > 2) + (2 (cm) = 20 (mm))", 2.0),
    ],
)
def test_value(expression, expected):
    assert value_of(expression) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("1 (mm) + 1 (deg)", "Y0307"),
        ("1 (mm) * 1 (mm)", "Y0307"),
        ("1 / 1 (mm)", "Y0307"),
        ("2 (mm) ** 2", "Y0307"),
        ("SIN(1 (mm))", "Y0307"),
        ("SQRT(4 (mm))", "Y0307"),
        ("ATAN2(1 (mm), 1 (s))", "Y0307"),
        ("MAX(1 (mm), 2, 3 (deg))", "Y0307"),
        ("1 / 0", "Y0410"),
        ("1 % (2 - 2)", "Y0410"),
        ("SQRT(-1)", "Y0410"),
        ("(-8) ** 0.5", "Y0410"),
        ("10 ** 400", "Y0410"),
        ("5 (parsec)", "Y0305"),
        ("1e10", "Y0403"),
    ],
)
def test_refused(expression, code):
    assert code_of(expression) == [code]


def test_what_grows_beyond_all_reason_is_refused_where_it_stands():
    program = f"{DEFAULT}LET A = 1e9 * 1e9\nP0010 MOVEJ $A 0 0 0 0 0\nP0020 WAIT [$A]"
    assert codes(checked(program)[1]) == ["Y0403", "Y0403"]
