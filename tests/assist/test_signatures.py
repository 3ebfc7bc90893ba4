"""Tests of the hints of names and units of values while they are typed."""

import pytest

from tests.assist.texts import HEAD, looked_at, marked
from yarclang.assist.signatures import signature_at

POSE = "x (mm) y (mm) z (mm) roll (deg) pitch (deg) yaw (deg)"
JOINTS = "J1 (deg) J2 (deg) J3 (deg) J4 (deg) J5 (deg) J6 (deg)"


def signature(line: str, head: str = HEAD):
    text, number, column = marked(head + line)
    return signature_at(looked_at(text), number, column)


@pytest.mark.parametrize(
    ("line", "values", "active"),
    [
        ("P0010 MOVEL |", POSE, 0),
        ("P0010 MOVEL {TCP} |", POSE, 0),
        ("P0010 MOVEL {TCP} 1|", POSE, 0),
        ("P0010 MOVEL {TCP} 1 |", POSE, 1),
        ("P0010 MOVEL {TCP} 1 2 $(3*|", POSE, 2),
        ("P0010 MOVEL {TCP} 1 2 $(3*4) |", POSE, 3),
        ("P0010 MOVEL {TCP} 1 2 3 4 5 6 |", POSE, None),
        ("P0010 MOVEC {TCP} 1 2 |", "x (mm) y (mm) z (mm)", 2),
        ("P0010 MOVEC {TCP} 1 2 3; 4 |", POSE, 1),
        ("P0010 MOVEL_SPLINE 1 2 3 4 5 6;\n  1 |", POSE, 1),
        ("P0010 MOVEJ 1 2 |", JOINTS, 2),
        ("P0010 MOVEJ_TIMED 1 2 3 4 5 6 [2] VEL 0 0 0 0 0 0; 1 2 |", JOINTS, 2),
        ("P0010 MOVEJ_RPY 1 2 |", POSE, 2),
        ("P0010 MOVEL_QUAT |", "x (mm) y (mm) z (mm) qx qy qz qw", 0),
        ("P0010 MOVEL 1 | 3 4 5 6 (in,rad)", "x (in) y (in) z (in) roll (rad) pitch (rad) yaw (rad)", 1),
        ("FRAME {A} 1 2 |", POSE, 2),
        ("JOINTS READY 1 |", JOINTS, 1),
    ],
)
def test_values(line: str, values: str, active: int | None):
    found = signature(line)
    assert " ".join(one.label for one in found.values) == values
    assert found.active == active


@pytest.mark.parametrize(
    "line",
    [
        "P0010 |",
        "P0010 MOV|",
        "P0010 MOVEL 1 2 3 4 5 6 [|",
        "P0010 MOVEL 1 2 3 4 5 6 [MIN] |",
        "P0010 MOVEL {TCP} 1 2 3 4 5 6 {B} |",
        "P0010 MOVEL 1 2 3 4 5 6 BLEND |",
        "P0010 STOP |",
        "P0010 MOVEL 1 ! |",
        "P0010 CALL NOBODY |",
        "LET A = |",
        "|",
    ],
)
def test_no_values(line: str):
    assert signature(line) is None


def test_without_units_the_kinds_are_told():
    found = signature("P0010 MOVEL |", "")
    assert [one.label for one in found.values][::3] == ["x (length)", "roll (angle)"]


def test_parameters_of_subs():
    found = signature("USE PICKPLACE\nP0010 CALL PICKPLACE.PICK {TCP} {B} 60 (mm) |")
    assert [one.label for one in found.values] == ["{TOOL}", "{AT}", "ABOVE (mm)", "GRIP", "T (s)"]
    assert found.active == 3
    assert found.values[3].meaning == "output that shuts the gripper"
    named = "USE PICKPLACE\nP0010 CALL PICKPLACE.PICK {TCP} "
    assert signature(f"{named}T=|").active == 4
    assert signature(f"{named}T=$(2*3) |").active == 1
    assert signature(f"{named}T=2 AT={{B}} |").active == 2
    assert signature(f"{named}T=2 AT={{B}} GRIP=GRIP ABOVE=60 (mm) |").active is None
    assert signature(f"{named}TT=|").active is None
    default = signature("SUB GO {AT} DEPTH=20 (mm)\nEND\nP0010 CALL GO |")
    assert [one.label for one in default.values] == ["{AT}", "DEPTH=20 (mm)"]
    own = signature("! Goes.\n!   DEPTH (mm)  how far\nSUB GO {AT} DEPTH (mm)\nEND\nP0010 CALL GO |")
    assert (own.active, own.values[1].meaning, own.summary) == (0, "how far", "Goes.")
