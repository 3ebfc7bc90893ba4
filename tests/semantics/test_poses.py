"""Tests of named poses: a name has the same meaning as the pose's numbers in the pose's own frame."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import checked, codes, compiled

HEAD = """DEFAULT {TCP} [5] (mm,deg,s) {B}
FRAME {TABLE} 100 1074.4 900 0 5 30 (mm,deg) {B}
JOINTS READY 0 -10 -40 0 50 0 (deg)
P0001 MOVEJ READY
"""
ONE, OTHER = "0 40 276 0 0 10", "20 0 320 5 0 0"


@pytest.mark.parametrize(
    ("named", "written"),
    [
        ("P0010 MOVEL A", "P0010 MOVEL ONE {TABLE}"),
        ("P0010 MOVEL_QUAT A", "P0010 MOVEL ONE {TABLE}"),
        ("P0010 MOVEJ A", "P0010 MOVEJ_RPY ONE {TABLE}"),
        ("P0010 MOVEJ_RPY A NEAR READY", "P0010 MOVEJ_RPY ONE {TABLE} NEAR READY"),
        ("P0010 MOVEJ A NEAR READY", "P0010 MOVEJ_RPY ONE {TABLE} NEAR READY"),
        ("P0010 MOVEJ_SPLINE READY; A [9]", "P0010 MOVEJ_SPLINE_RPY READY; ONE [9] {TABLE}"),
        ("P0010 MOVEL_SPLINE A; B", "P0010 MOVEL_SPLINE ONE; OTHER {TABLE}"),
        ("P0010 MOVEL_SPLINE ONE; B {TABLE}", "P0010 MOVEL_SPLINE ONE; OTHER {TABLE}"),
        ("P0010 MOVEC A; B", "P0010 MOVEC 0 40 276; OTHER {TABLE}"),
        ("P0010 MOVEC 0 40 276; B {TABLE}", "P0010 MOVEC 0 40 276; OTHER {TABLE}"),
        ("P0010 MOVEL {TABLED} A", "P0010 MOVEL {TABLED} ONE {TABLE}"),
        (("SUB GO P\n"
            "  P0011 MOVEL P\n"
            "END\n"
            "P0010 CALL GO A"), ("SUB GO\n"
            "  P0011 MOVEL ONE {TABLE}\n"
            "END\n"
            "P0010 CALL GO")),
        (("REPEAT I 2\n"
            "  POSE C $(20*I) 0 320 5 0 0 {TABLE}\n"
            "  P0010 MOVEL C\n"
            "END"), ("REPEAT I 2\n"
            "  P0010 MOVEL $(20*I) 0 320 5 0 0 {TABLE}\n"
            "END")),
    ],
)  # fmt: skip
def test_a_name_is_its_numbers(named, written):
    tool = "FRAME {TABLED} 0 0 30 0 0 0 (mm,deg) {FLANGE}\n"
    poses = f"POSE A {ONE} {{TABLE}}\nPOSE B {OTHER} {{TABLE}}\n"
    texts = [
        HEAD + head + line.replace("ONE", ONE).replace("OTHER", OTHER).replace("[9]", "[20]") + "\n"
        for head, line in ((tool + poses, named), (tool, written))
    ]
    made = [compiled(text) for text in texts]
    assert [[one for one in found if one.is_error] for _, found in made] == [[], []]
    lines = [[line for line in one.text.splitlines() if not line.startswith(";")] for one, _ in made if one]
    assert lines[0] == lines[1]


@pytest.mark.parametrize("name", ["P1", "P0010", "PICK", "p7"])
def test_a_pose_may_be_called_as_on_other_pendants(name):
    program, found = checked(f"{HEAD}POSE {name} {ONE} {{TABLE}}\nP0010 MOVEL {name.upper()}\n")
    assert codes(found) == []
    assert program.steps[-1].goal.base_from_moving.shape == (4, 4)
    assert program.steps[-1].origin.base.name == "TABLE"


@pytest.mark.parametrize("word", ["LET P1 = 1", "JOINTS P1 0 0 0 0 0 0 (deg)", "INPUT P1 M11"])
def test_nothing_else_may(word):
    assert "Y0211" in codes(checked(f"{HEAD}{word}\n")[1])


numbers = st.floats(-300, 300).map(lambda one: round(one, 3))
angles = st.floats(-170, 170).map(lambda one: round(one, 3))


@given(
    st.tuples(numbers, numbers, numbers, angles, angles, angles),
    st.tuples(numbers, numbers, numbers, angles, angles, angles),
)
@settings(max_examples=50, deadline=None)
def test_a_pose_stands_in_its_frame(frame, pose):
    head = f"DEFAULT {{TCP}} [5] (mm,deg,s) {{B}}\nFRAME {{F}} {' '.join(map(str, frame))}\n"
    values = " ".join(map(str, pose))
    named, _ = checked(f"{head}POSE A {values} {{F}}\nP0010 MOVEL A\n")
    written, _ = checked(f"{head}P0010 MOVEL {values} {{F}}\n")
    one, other = (program.steps[-1].goal for program in (named, written))
    assert np.array_equal(one.base_from_moving, other.base_from_moving)
    assert np.array_equal(one.flange_from_moving, other.flange_from_moving)
