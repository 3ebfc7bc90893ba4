"""Tests of taught lines: read back, they lead to where the robot stands, up to the rounding of the written
digits.
"""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import checked, codes, robot_of

from yarclang.robot.kinematics.fk import flange_poses
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.teaching.declaring import declare
from yarclang.teaching.edits import Program, applied
from yarclang.teaching.holding import around
from yarclang.teaching.motions import Taught, teach
from yarclang.teaching.points import touch_up

ROBOT = robot_of("INDUSTRIAL6")
HERE = Path(__file__).parent
STANDS = np.radians([12.3456789, -20.1, -30.7, 5.5, -40.3, 7.7])
HEAD = """ROBOT INDUSTRIAL6
FRAME {TABLE} 100 900 300 5 6 70 (mm,deg) {B}
FRAME {TORCH} 0 150 20 30 40 50 (mm,deg) {FLANGE}
DEFAULT {TORCH} [50%] (mm,deg,s) {TABLE}
P0010 MOVEJ 0 -20 -30 0 -50 0
"""


def named(text):
    return around(Program(SourceFile(str(HERE / "test.yarc"), text)), HERE, ROBOT)


def made(text, after, taught, joints=STANDS):
    edited = teach(named(text), after, taught, joints)
    return applied(text, edited.edits), edited


def last_flange(text):
    """Return the flange's pose at the goal of the last motion, as the checks read it."""
    program, found = checked(text)
    assert [one for one in found if one.is_error] == []
    goal = program.steps[-1].goal
    if hasattr(goal, "q"):
        return flange_poses(ROBOT.chain, goal.q[None])[0]
    if hasattr(goal, "base_from_moving"):
        return goal.base_from_moving @ np.linalg.inv(goal.flange_from_moving)
    stood = flange_poses(ROBOT.chain, program.steps[-2].goal.q[None])[0]
    tool = stood @ goal.flange_from_moving
    axes = stood[:3, :3] @ goal.axes if goal.axes_on_flange else goal.axes
    moved = np.eye(4)
    moved[:3, 3] = tool[:3, 3] + axes @ goal.shift
    moved[:3, :3] = axes @ goal.turn @ axes.T @ tool[:3, :3]
    return moved @ np.linalg.inv(goal.flange_from_moving)


def same(one, other):
    assert np.abs(one[:3, 3] - other[:3, 3]).max() < 6e-5  # 0.01 mm at the tool, plus a rotation by 0.001 deg
    assert np.abs(one[:3, :3] - other[:3, :3]).max() < 5e-5


KINDS = (
    Taught("MOVEJ", "joints"),
    Taught("MOVEJ", "joints", name="PARK"),
    Taught("MOVEJ"),
    Taught("MOVEL"),
    Taught("MOVEL", name="PICK", time="V 100"),
    Taught("MOVEL", name="P7"),
    Taught("MOVEJ", name="PICK"),
    Taught("MOVEC", via=STANDS * 0.9),
    Taught("MOVEC", via=STANDS * 0.9, name="PICK"),
    Taught("DMOVE"),
    Taught("DMOVE", axes="tool"),
)


@pytest.mark.parametrize("units", ["(mm,deg,s)", "(m,rad)", "", "(in)"])
@pytest.mark.parametrize("taught", KINDS, ids=lambda one: f"{one.motion} {one.target} {one.name} {one.axes}")
def test_taught_is_where_the_robot_stands(taught, units):
    text = HEAD.replace("(mm,deg,s) {TABLE}", f"{units} {{TABLE}}").replace("-50 0\n", "-50 0 (deg)\n")
    new, _ = made(text, 5, taught)
    same(last_flange(new), flange_poses(ROBOT.chain, STANDS[None])[0])
    touched = touch_up(named(new), new.count("\n"), STANDS) if taught.motion != "DMOVE" else None
    # the numbers of an arc to a named frame are relative to that frame, so that they are rounded once more
    # when its end is touched up
    assert touched is None or (taught.motion == "MOVEC" and taught.name) or touched.edits == ()
    assert new.startswith(text[: text.index("P0010")].splitlines(keepends=True)[0])


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-1, 1), min_size=12, max_size=12))
def test_touched_up_is_where_the_robot_stands_then(shares):
    width = np.minimum(ROBOT.limits.upper, -ROBOT.limits.lower) * 0.9
    first, then = np.array(shares[:6]) * width, np.array(shares[6:]) * width
    for taught in (
        Taught("MOVEJ", "joints"),
        Taught("MOVEL"),
        Taught("MOVEL", name="PICK"),
        Taught("MOVEJ", "joints", name="P_"),
    ):
        text, edited = made(HEAD, 5, taught, first)
        edited = touch_up(named(text), edited.line, then)
        same(last_flange(applied(text, edited.edits)), flange_poses(ROBOT.chain, then[None])[0])


def test_numbers_stay_within_the_limits_of_the_joints():
    at_limit = ROBOT.limits.upper.copy()
    at_limit[0] -= 1e-7
    new, _ = made(HEAD, 5, Taught("MOVEJ", "joints"), at_limit)
    assert "Y0502" not in codes(checked(new)[1])
    assert "MOVEJ 170 90 80 180 120 360\n" in new


def test_a_line_says_only_what_default_doesnt():
    assert "P0020 MOVEJ 12.346 -20.1 -30.7 5.5 -40.3 7.7\n" in made(HEAD, 5, Taught("MOVEJ", "joints"))[0]
    bare, _ = made("", 0, Taught("MOVEL"))
    assert bare.startswith("P0010 MOVEL {TCP} ")
    assert bare.endswith(" [50%] (mm,deg) {B}\n")
    speed = HEAD.replace("[50%]", "[V 100]")
    assert " [50%]\n" in made(speed, 4, Taught("MOVEJ", "joints"))[0]
    assert "[" not in made(speed, 4, Taught("MOVEL"))[0].splitlines()[4]


def test_it_stands_where_it_may():
    new, edited = made(HEAD, 0, Taught("MOVEJ", "joints"))
    assert new.splitlines()[4].startswith("P0005 ")
    assert "it comes after DEFAULT" in edited.what
    full = HEAD + "P0011 STOP\n"
    new, edited = made(full, 5, Taught("MOVEJ", "joints"))
    assert [line.split()[0] for line in new.splitlines()[4:]] == ["P0010", "P0020", "P0030"]
    assert "no index was free" in edited.what
    inside = HEAD + "REPEAT 3\nEND\n"
    assert "\n  P0020 MOVEJ" in made(inside, 6, Taught("MOVEJ", "joints"))[0]
    rows = HEAD + "P0020 MOVEJ_SPLINE 1 0 0 0 0 0;\n 2 0 0 0 0 0 ! b"
    assert made(rows, 6, Taught("MOVEJ", "joints"))[0].splitlines()[7].startswith("P0030 ")


@pytest.mark.parametrize(
    ("text", "after", "taught", "said"),
    [
        (("DEFAULT {TCP} [5] (mm,deg,s) {AT}\n"
            "SUB A {AT}\n"
            " P0010 MOVEL 0 0 0 0 0 0 {AT}\n"
            "END\n"), 3, Taught("MOVEL"), "parameter of A"),
        ("DEFAULT {TCP} [5] (mm,deg,s) {NOWHERE}\n", 1, Taught("MOVEL"), r"\{NOWHERE\} can't be resolved"),
        (("DEFAULT {TCP} [5] (mm,deg,s) {T}\n"
            "P0010 STOP\n"
            "FRAME {T} 0 0 0 0 0 0 {B}\n"), 2, Taught("MOVEL"), "only below, in line 3"),
        ("DEFAULT {B} [5] (mm,deg,s) {B}\n", 1, Taught("MOVEL"), "stands still"),
        ("ROBOT TRACKED_MANIPULATOR\n", 1, Taught("MOVEL"), "the program is for TRACKED_MANIPULATOR"),
        (HEAD, 5, Taught("MOVEC"), "also needs a via point"),
        (HEAD, 5, Taught("MOVEC", via=STANDS), "is the end of the arc"),
        (HEAD, 5, Taught("MOVEL", "joints"), "to a pose"),
        (HEAD, 5, Taught("MOVEJ", "joints", name="HOME"), "declared already, by the robot"),
        (HEAD + "POSE PICK 0 0 0 0 0 0 (mm,deg)\n", 5, Taught("MOVEL", name="PICK"),
            "declared already, in line 6"),
        (HEAD, 5, Taught("MOVEJ", "joints", name="P7"), "is a word of the language"),
        (HEAD, 5, Taught("MOVEJ", "joints", name="A b"), "is no name"),
        (HEAD, 5, Taught("MOVEJ", "joints", name="MOVEJ"), "is a word of the language"),
        (HEAD, 99, Taught("MOVEL"), "there is no line 99"),
        (HEAD + "SUB A\n", 6, Taught("DMOVE"), "depends on the CALL"),
        (HEAD + "P0020 MOVEJ NOBODY\n", 6, Taught("DMOVE"), "the pose before this line isn't known"),
    ],
)  # fmt: skip
def test_what_cant_be_taught_says_why(text, after, taught, said):
    with pytest.raises(Trouble, match=said):
        teach(named(text), after, taught, STANDS)


def test_an_increment_goes_on_from_where_the_program_is():
    text = HEAD + "REPEAT I 3\n  P0020 DMOVE 0 0 $(10*I) 0 0 0\nEND\nIF 0\n  P0030 STOP\nEND\n"
    edited = teach(named(text), 11, Taught("DMOVE"), STANDS)
    program, _ = checked(applied(text, edited.edits))
    delta = program.steps[-1].goal
    frame = named(text).scope.frame("TABLE").transform[:3, :3]
    tool = named(text).scope.frame("TORCH").transform
    begin = flange_poses(ROBOT.chain, np.radians([[0, -20, -30, 0, -50, 0]]))[0] @ tool
    end = flange_poses(ROBOT.chain, STANDS[None])[0] @ tool
    # the loop has shifted the frame by 0 + 10 + 20 mm along z
    assert frame @ delta.shift == pytest.approx(end[:3, 3] - begin[:3, 3] - frame[:, 2] * 0.03, abs=1e-5)


def test_a_declaration_is_touched_up_and_tells_who_uses_it():
    text = (
        "JOINTS PARK 0 0 0 0 0 0 (deg) ! here\r\n"
        "P0010 MOVEJ PARK [2] (s)\r\n"
        "P0020 MOVEJ HOME [2] (s)\r\n"
        "P0030 MOVEJ PARK [2] (s)"
    )
    edited = touch_up(named(text), 2, STANDS)
    assert edited.what == "touched up the declaration of PARK in line 1, which 2 lines use"
    assert applied(text, edited.edits) == text.replace("0 0 0 0 0 0", "12.346 -20.1 -30.7 5.5 -40.3 7.7")
    with pytest.raises(Trouble, match="HOME isn't declared in this file"):
        touch_up(named(text), 3, STANDS)
    with pytest.raises(Trouble, match="has no target"):
        touch_up(named("P0010 STOP\n"), 1, STANDS)
    tool = "FRAME {T} 0 0 1 0 0 0 (mm,deg) {FLANGE}\n"
    with pytest.raises(Trouble, match="declares a tool"):
        touch_up(named(tool), 1, STANDS)
    assert (
        applied("", declare(named(""), "joints", "park", STANDS).edits)
        == "JOINTS PARK 12.346 -20.1 -30.7 5.5 -40.3 7.7 (deg)\n"
    )


def test_a_pose_is_declared_and_touched_up_by_its_name():
    edited = declare(named(HEAD), "pose", "p7", STANDS)
    text = applied(HEAD, edited.edits) + "P0020 MOVEL P7\nP0030 MOVEJ P7\nP0040 MOVEC 0 0 0; P7\n"
    assert text.splitlines()[4].startswith("POSE P7 ")
    assert "{" not in text.splitlines()[4]  # the frame of DEFAULT applies
    there = last_flange(text.partition("P0030")[0])
    same(there, flange_poses(ROBOT.chain, STANDS[None])[0])
    elsewhere = STANDS * 0.9
    edited = touch_up(named(text), 7, elsewhere)
    assert "the declaration of P7 in line 5, which 3 lines use" in edited.what
    again = applied(text, edited.edits)
    same(last_flange(again.partition("P0030")[0]), flange_poses(ROBOT.chain, elsewhere[None])[0])
    with pytest.raises(Trouble, match="can't be touched up"):
        touch_up(named(text + "P0050 MOVEC P7; 0 0 0 0 0 0\n"), 10, elsewhere, 1)
    with pytest.raises(Trouble, match="declared already"):
        declare(named(text), "pose", "P7", STANDS)
