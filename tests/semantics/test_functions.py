"""Tests of FUNC, which names an expression of its parameters."""

import math
import tracemalloc

import pytest
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, source

from yarclang.hir import JointMove
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module

START = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"


def first_joint(program):
    """Return the first joint at the end of the last motion [deg]."""
    made, findings = checked(START + program)
    assert codes(findings) == []
    step = made.steps[-1]
    assert isinstance(step, JointMove)
    return math.degrees(step.goal.q[0])


@pytest.mark.parametrize(
    ("functions", "value", "expected"),
    [
        ("FUNC MID(A, B) = (A + B) / 2", "MID(2, 6)", 4),
        ("func mid (a,b)=(a+b)/2", "Mid(2, 6)", 4),
        ("FUNC TWICE(A) = 2*A\nFUNC FOUR(A) = TWICE(TWICE(A))", "FOUR(3)", 12),
        ("LET K = 3\nFUNC MORE(A) = A + K", "MORE(1)", 4),
        ("TABLE T 5 6 7\nFUNC AT(I) = T[I]", "AT(2)", 7),
        ("FUNC TURN(A (deg)) = A + 1", "TURN(PI*1 (rad) / PI)", 180 / math.pi + 1),
        ("FUNC ROOT(A) = SQRT(A)", "ROOT(16) - ROOT(4)", 2),
        ("FUNC LARGER(A, B) = (A > B)*A + (A <= B)*B", "LARGER(3, 8)", 8),
    ],
)
def test_values(functions, value, expected):
    assert first_joint(f"{functions}\nP0010 MOVEJ $({value}) 0 0 0 0 0") == pytest.approx(expected)


def test_a_parameter_without_a_unit_takes_what_it_is_given():
    program = "FUNC HALF(A) = A / 2\nP0010 MOVEJ_RPY 0 1174.4 $(HALF(235.2 (cm))) 0 0 0"
    made, findings = checked(START + program)
    assert codes(findings) == []
    assert made.steps[0].goal.base_from_moving[2, 3] == pytest.approx(1.176)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("FUNC SIN(A) = A", ["Y0211"]),
        ("FUNC MOVEJ(A) = A", ["Y0211"]),
        ("FUNC P1(A) = A", ["Y0211"]),
        ("FUNC F(A) = A + C", ["Y0210"]),
        ("FUNC F(A, A) = A", ["Y0206"]),
        ("LET A = 1\nFUNC F(A) = A", ["Y0206"]),
        ("FUNC F(A) = F(A - 1)", ["Y0109"]),
        ("FUNC F(A) = G(A)\nFUNC G(A) = A", ["Y0109"]),
        ("FUNC F(A (foo)) = A", ["Y0305"]),
        ("FUNC F(A) = 1 / A\nLET X = F(0)", ["Y0410"]),
        ("FUNC F(A (mm)) = A\nLET X = F(3 (deg))", ["Y0307"]),
        ("FUNC F(A) = A\nLET X = F(1, 2)", ["Y0110"]),
        ("FUNC F(A) = A\nLET X = F", ["Y0209"]),
        ("FUNC F(A) = A\nLET X = FF(3)", ["Y0109"]),
        ("LET X = SQR(4)", ["Y0109"]),
        ("LET H = 3\nLET X = H(2)", ["Y0109"]),
        ("LET H = 3\nLET X = H (mm)", ["Y0109"]),
        ("FUNC F(A) = A\nFUNC F(B) = B", ["Y0206"]),
        ("TABLE T 1 2\nFUNC F(A) = T[A, 0]", ["Y0457"]),
        ("REPEAT 2\nFUNC F(A) = A\nEND", ["Y0116"]),
        ("REGISTER N 0..3\nFUNC F(A) = A\nP0010 SET N = F(N)", ["Y0430"]),
        ("REGISTER N 0..3\nFUNC F(A) = A*2\nP0010 SET N = F(1)", []),
    ],
)
def test_faults(program, expected):
    assert codes(checked(f"{START}{program}\nP0090 STOP")[1]) == expected


@pytest.mark.parametrize(
    "line",
    [
        "FUNC",
        "FUNC F",
        "FUNC F(A)",
        "FUNC F() = 3",
        "FUNC F A = 3",
        "FUNC F(A B) = 3",
        "FUNC F(A) =",
        "FUNC F(A, ) = 3",
    ],
)
def test_heads_that_are_none(line):
    (found,) = parse(source(f"{line}\nP0010 STOP")).diagnostics
    assert found.code in ("Y0101", "Y0102")


def test_a_fault_inside_names_the_function_and_stands_where_it_is_used():
    found = checked(f"{START}FUNC F(A) = SQRT(A)\nP0010 MOVEJ $(1 + F(-4)) 0 0 0 0 0")[1]
    assert [(one.code, one.span.line, one.span.column) for one in found] == [("Y0410", 3, 19)]
    assert found[0].message.startswith("in F: ")


def test_many_functions_inside_each_other_are_refused_in_time():
    lines = ["FUNC F0(A) = A + A"]
    lines += [f"FUNC F{n}(A) = F{n - 1}(A + 1) + F{n - 1}(A + 2)" for n in range(1, 30)]
    found = checked(START + "\n".join([*lines, "LET X = F29(1)", "P0010 STOP"]))[1]
    assert {one.code for one in found} == {"Y0112"}


def test_a_long_chain_of_functions_is_refused():
    lines = ["FUNC F0(A) = A"] + [f"FUNC F{n}(A) = F{n - 1}(A)" for n in range(1, 400)]
    found = checked(START + "\n".join([*lines, "LET X = F399(1)", "P0010 STOP"]))[1]
    assert {one.code for one in found} == {"Y0112"}


numbers = st.integers(-50, 50)


@exercises(negative=0.1)
@given(numbers, numbers, numbers)
def test_a_function_is_its_expression_with_what_it_is_given(tally, a, b, k):
    tally.count("negative", a < 0)
    program = f"LET K = {k} / 10\nFUNC F(A, B) = A*K - B + MAX(A, B)\nFUNC G(A) = F(A, 1) + F(2, A)"
    expected = (a * k / 10 - 1 + max(a, 1)) + (2 * k / 10 - a + max(2, a))
    made, findings = checked(f"{START}{program}\nLET X = G({a})\nP0010 WAIT [$(ABS(X - {expected!r}) + 1)]")
    assert codes(findings) == []
    assert made.steps[0].duration == pytest.approx(1.0)


def test_it_is_written_in_its_usual_form():
    made = parse(source("func  f ( a ,b (MM) ) =a*( b+1 )\nP0010 stop"))
    assert print_module(made.value) == "FUNC F(A, B (mm)) = A*(B + 1)\nP0010 STOP\n"


def test_what_is_declared_behind_a_function_changes_nothing_in_it():
    program = "LET K = 3\nFUNC F(A) = A + K\nLET A = 100\nLET L = 7\nP0010 MOVEJ $(F(1)) 0 0 0 0 0"
    assert first_joint(program) == pytest.approx(4)
    assert codes(checked(f"{START}FUNC F(A) = A + K\nLET K = 3\nP0010 MOVEJ $(F(1)) 0 0 0 0 0")[1]) == [
        "Y0210"
    ]


def test_memory_is_linear_in_the_number_of_functions():
    def held(count):
        text = (
            "".join(f"FUNC F{n}(A) = A + {n}\n" for n in range(count))
            + "P0010 MOVEJ $(F9(1)) 0 0 0 0 0 [5] (deg,s)"
        )
        tracemalloc.start()
        made = checked(text)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert made[0] is not None
        return peak

    held(50)  # imports modules, whose memory must not be counted below
    # measured: 6 MB; 295 MB when each function had a copy of all names
    assert held(3200) < 30e6
