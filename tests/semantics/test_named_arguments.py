"""Tests of arguments with names, and of parameters with defaults."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, source

from yarclang.hir import JointMove
from yarclang.syntax.form import usual_form

SUB = """\
LET D = 20
JOINTS READY 0 0 0 0 -30 0 (deg)
SUB TURN {F} A (deg) T=2 (s) B=$(D/2) (deg) AT=HOME
  FRAME {G} 0 0 0 $A $B 0 (mm,deg) {F}
  P0010 MOVEJ $A $B 0 0 -30 0 [$T] (deg,s)
  P0020 MOVEJ AT [5] (s)
END
FRAME {TABLE} 0 800 300 0 0 0 (mm,deg) {B}
"""


def moved(*calls):
    """Return the goals and timings of the motions of some calls."""
    lines = "\n".join(f"P0{number}00 {call}" for number, call in enumerate(calls, 1))
    made, findings = checked(SUB + lines)
    assert codes(findings) == []
    steps = [step for step in made.steps if isinstance(step, JointMove)]
    return [(tuple(step.goal.q), step.timing) for step in steps]


@pytest.mark.parametrize(
    ("short", "long"),
    [
        ("CALL TURN {TABLE} 5", "CALL TURN {TABLE} 5 2 10 HOME"),
        ("CALL TURN {TABLE} 5 B=7", "CALL TURN {TABLE} 5 2 7 HOME"),
        ("CALL TURN {TABLE} 5 3 AT=READY", "CALL TURN {TABLE} 5 3 10 READY"),
        ("CALL TURN A=5 F={TABLE}", "CALL TURN {TABLE} 5 2 10 HOME"),
        ("call turn f = {table} t=3000 (ms) a = $(D/4)", "CALL TURN {TABLE} 5 3 10 HOME"),
        ("CALL TURN {TABLE} A=0.1 (rad) B=-4", "CALL TURN {TABLE} 0.1 (rad) 2 -4 HOME"),
    ],
)
def test_the_same_motions(short, long):
    assert moved(short) == moved(long)


VALUES = {"F": "{TABLE}", "A": "5", "T": "3", "B": "$(D/5)", "AT": "READY"}


@given(data=st.data(), by_position=st.integers(0, 5))
def test_names_in_any_order(data, by_position):
    """Values by position followed by values by name, in any order, give the same motions as all values by
    position.
    """
    names = list(VALUES)
    rest = data.draw(st.permutations(names[by_position:]))
    call = " ".join(
        [
            "CALL TURN",
            *(VALUES[one] for one in names[:by_position]),
            *(f"{one}={VALUES[one]}" for one in rest),
        ]
    )
    assert moved(call) == moved("CALL TURN " + " ".join(VALUES.values()))


def test_a_left_out_name_is_its_default_or_a_finding():
    """A CALL compiles if it has all arguments without a default; else the finding names the missing ones."""
    for size in range(6):
        for some in itertools.combinations(VALUES, size):
            text = SUB + "P0100 CALL TURN " + " ".join(f"{one}={VALUES[one]}" for one in some)
            _, findings = checked(text)
            lacking = [one for one in ("F", "A") if one not in some]
            assert codes(findings) == ["Y0411"] * bool(lacking)
            if lacking and some:
                shown = ", ".join("{F}" if one == "F" else one for one in lacking)
                assert findings[0].message == f"TURN needs a value for {shown}"


def test_a_frame_and_a_number_of_one_name():
    text = (
        "SUB GO {A} A (deg)\n"
        "  FRAME {C} 0 0 0 0 0 0 (mm,deg) {A}\n"
        "  P0010 MOVEJ $A 0 0 0 -30 0 [5] (deg,s)\n"
        "END\n"
        "P0020 CALL GO A=4 A={B}"
    )
    made, findings = checked(text)
    assert codes(findings) == []
    assert made.steps


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("SUB GO A=2 (kg)", "`kg` is no unit"),
        ("SUB GO A=HOMEE", "no name HOMEE is declared"),
        ("SUB GO A=$X", "X"),
        ("SUB GO A=HOME (mm)", "A is a number of mm, not a joint position"),
        ("SUB GO B=1 A=$B", "B"),
    ],
)
def test_defaults_are_checked_where_they_stand(head, message):
    _, findings = checked(f"{head}\n  P0010 MOVEJ HOME [5] (s)\nEND\nP0020 MOVEJ HOME [5] (s)")
    assert len(findings) == 1
    assert message in findings[0].message
    assert findings[0].span.line == 1


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("CALL TURN A=", "no value follows `A=`"),
        ("CALL TURN A= [3]", "no value follows `A=`"),
        ("CALL TURN A=$(3)4", "`4` runs into `A=$(3)`"),
        ("SUB GO A=", "no value follows `A=`"),
        ("SUB GO A=3 4 (mm)", "A can have only one default; `4` is a second one"),
        ("SUB GO A={B}", "no value follows `A=`"),
    ],
)
def test_what_can_not_be_read(line, message):
    _, findings = checked(f"{line}\nP0010 MOVEJ HOME [5] (s)")
    assert findings[0].message == message


def test_the_usual_form():
    text = "sub go a = 2(mm) b=$( x*2 )\nend\np0010 call go a = 3 (mm)   b=home  c = {b}\n"
    assert usual_form(source(text)).value == (
        "SUB GO A=2 (mm) B=$(X*2)\nEND\nP0010 CALL GO A=3 (mm) B=HOME C={B}\n"
    )


def test_counts_of_loops_know_names_and_defaults():
    text = (
        "SUB MANY N=3\n  REPEAT $N\n    P0010 MOVEJ HOME [5] (s)\n  END\nEND\n"
        "P0020 CALL MANY\nP0030 CALL MANY N=2\nLET K = 4\nP0040 CALL MANY N=$K"
    )
    made, findings = checked(text)
    assert codes(findings) == []
    assert sum(isinstance(step, JointMove) for step in made.steps) == 9
    _, findings = checked("SUB MANY N=3000000\n  REPEAT $N\n    P0010 STOP\n  END\nEND\nP0020 CALL MANY")
    assert codes(findings) == ["Y1004"]
