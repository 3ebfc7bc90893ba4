"""Tests of tables of poses and joint positions, whose elements are used as waypoints."""

import numpy as np
import pytest
from programs import checked, codes, compiled

from yarclang.hir import JointGoal, PoseGoal

HEAD = """DEFAULT {TCP} [4] (mm,deg,s) {B}
FRAME {TABLE} 0 1074.4 900 0 0 0
TABLE SPOTS POSE 60 40 250 0 0 10; 60 40 150 0 0 10; $(60 + 20) 40 150 0 0 10 {TABLE}
TABLE STANDS JOINTS 0 0 0 0 20 0; 10 0 0 0 20 0
"""
SAME = """POSE A0 60 40 250 0 0 10 {TABLE}
POSE A1 60 40 150 0 0 10 {TABLE}
POSE A2 80 40 150 0 0 10 {TABLE}
JOINTS B0 0 0 0 0 20 0
JOINTS B1 10 0 0 0 20 0
"""


def steps(program):
    made, found = checked(HEAD + SAME + program)
    assert codes(found) == []
    return made.steps


def shown(goal):
    match goal:
        case JointGoal(q=q):
            return q.tobytes()
        case PoseGoal(base_from_moving=pose, flange_from_moving=frame, told=told):
            return pose.tobytes(), frame.tobytes(), told.numbers.tobytes(), told.base.name, told.moving.name
    return np.asarray(goal).tobytes()


@pytest.mark.parametrize(
    ("by_index", "by_name"),
    [
        ("MOVEJ $(STANDS[1])", "MOVEJ B1"),
        ("MOVEJ $(SPOTS[0])", "MOVEJ A0"),
        ("MOVEJ_RPY $(SPOTS[0]) NEAR B1", "MOVEJ_RPY A0 NEAR B1"),
        ("MOVEL $(SPOTS[4 - 2])", "MOVEL A2"),
        ("MOVEL_SPLINE $(SPOTS[1]); 60 1074.4 1200 0 0 0", "MOVEL_SPLINE A1; 60 1074.4 1200 0 0 0"),
        ("MOVEJ_SPLINE $(STANDS[0]); $(SPOTS[0]); HOME", "MOVEJ_SPLINE B0; A0; HOME"),
        ("MOVEC $(SPOTS[0]); $(SPOTS[2])", "MOVEC A0; A2"),
    ],
)
def test_an_element_is_what_a_name_is(by_index, by_name):
    one, other = (steps(f"P0010 {line}")[0] for line in (by_index, by_name))
    assert list(map(shown, (*one.goals, *one.besides))) == list(map(shown, (*other.goals, *other.besides)))


def test_a_loop_goes_through_a_table_and_a_sub_is_given_elements():
    program = (
        "SUB GO THERE\n"
        "  P0005 MOVEJ THERE\n"
        "END\n"
        "REPEAT I 3\n"
        "  P0010 MOVEL $(SPOTS[I])\n"
        "  P0020 CALL GO $(STANDS[I % 2])\n"
        "END"
    )
    goals = [shown(step.goals[0]) for step in steps(program)]
    named = steps("".join(f"P{n + 1}10 MOVEL A{n}\nP{n + 1}20 MOVEJ B{n % 2}\n" for n in range(3)))
    assert goals == [shown(step.goals[0]) for step in named]


def test_the_certificate_is_that_of_the_named_pose():
    one, found = compiled(HEAD + SAME + "P0005 MOVEJ $(STANDS[0])\nP0010 MOVEJ $(SPOTS[0])")
    other, _ = compiled(HEAD + SAME + "P0005 MOVEJ B0\nP0010 MOVEJ A0")
    assert codes(found) == []
    assert one.text.split("\nOPEN", 1)[1] == other.text.split("\nOPEN", 1)[1]


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("P0010 MOVEL $(STANDS[1])", ["Y0209"]),
        ("P0010 MOVEJ $(SPOTS[3])", ["Y0456"]),
        ("P0010 MOVEJ $(SPOTS[-1])", ["Y0456"]),
        ("P0010 MOVEJ $(SPOTS[0.5])", ["Y0457"]),
        ("P0010 MOVEJ $(SPOTS[0, 1])", ["Y0457"]),
        ("P0010 MOVEJ $(SPOTS[0]) 0 0 0 0 0", ["Y0209"]),
        ("P0010 DMOVE $(SPOTS[0])", ["Y0209"]),
        ("P0010 DMOVEJ $(STANDS[0])", ["Y0209"]),
        ("P0010 MOVEL $(SPOTS[0]) {B}", ["Y0408"]),
        ("P0010 MOVEJ $(SPOT[0]) 0 0 0 0 0", ["Y0210"]),
        ("LET X = SPOTS[0]\nP0010 STOP", ["Y0209"]),
        ("LET X = SPOTS\nP0010 STOP", ["Y0209"]),
        ("FUNC F(A) = SPOTS[A]\nP0010 STOP", ["Y0209"]),
        ("TABLE E POSE\nP0010 STOP", ["Y0401"]),
        ("TABLE E POSE 1 2 3 0 0 0; 1 2 3 0 0\nP0010 STOP", ["Y0401"]),
        ("TABLE E POSE 1 2 3 0 0 0 {TCP}\nP0010 STOP", ["Y0303"]),
        ("TABLE E JOINTS 0 0 0 0 0 0 {B}\nP0010 STOP", ["Y0408"]),
        ("TABLE E JOINTS 0 0 0 0 0 0; 0 0 0 0 700 0\nP0010 STOP", ["Y0502"]),
        ("TABLE SPOTS JOINTS 0 0 0 0 0 0\nP0010 STOP", ["Y0206"]),
        ("SUB S H (mm)\nP0010 DMOVE 0 0 $H 0 0 0\nEND\nP0020 CALL S $(SPOTS[0])", ["Y0411"]),
        ("SUB S A\nP0010 MOVEJ A\nEND\nP0020 CALL S $(SPOTS[8])", ["Y0456"]),
        ("REGISTER N 0..3\nP0010 MOVEJ $(STANDS[N])", ["Y0209"]),
    ],
)
def test_faults(program, expected):
    assert codes(checked(HEAD + program)[1]) == expected
