"""Tests of `yarc robot check`: each check can fail, and then says what to do."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path

import pytest
from conftest import EXAMPLES

from tests.robot.made_arms import DATA, REAL, made, yarc
from tests.robot.trap_arms import arm, robot, written
from yarclang.robot.checklist import check_robot
from yarclang.robot.checklist.geometry import geometry_items
from yarclang.robot.description import list_robots, stdlib_folder

INDUSTRIAL6 = stdlib_folder() / "robots" / "industrial6"
MINUS = "-2.9670597"


def changed(folder: Path, *changes: tuple[str, str], file: str = "robot.toml") -> str:
    """Return the path of a copy of INDUSTRIAL6 with texts replaced."""
    shutil.copytree(INDUSTRIAL6, folder, dirs_exist_ok=True)
    text = (folder / file).read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / file).write_text(text)
    return str(folder)


@pytest.mark.parametrize("name", [one.name for one in list_robots()])
def test_nothing_is_to_do_for_the_library(name):
    result = yarc("robot", "check", name)
    assert result.exit_code == 0, result.output
    assert "0 to do" in result.output
    subjects = {item.subject for item in check_robot(name).items}
    assert subjects >= {
        "files", "chain", "position limits", "velocity limits", "acceleration limits", "jerk limits", "units",
        "inverse kinematics", "forward kinematics", "inverse of forward", "HOME", "reach", "TCP", "frames",
        "actuation matrix", "encoder resolution", "motor speeds", "axes", "segments", "guesses",
    }  # fmt: skip


POINTS = [
    # replaced texts, the check, its verdict, a part of its message
    ([("velocity = 60  ", "velocity = 6000")], "velocity limits", "to do", "6000 deg/s"),
    ([("acceleration = 240\njerk", "acceleration = 2\njerk")], "acceleration limits", "to do", "30 s"),
    ([("jerk = 2000\n", "jerk = 20\n")], "jerk limits", "to do", "12 s"),
    ([("position = [-120, 120]", "position = [0, 2]")], "position limits", "to do", "range of 2 deg"),
    ([("xyz = [0, 100, 0]", "xyz = [0, 100000, 0]")], "frames", "to do", "100000 mm"),
    ([("[frames.TCP]", "[frames.HAND]")], "TCP", "to do", "no frame TCP"),
    ([("xyz = [0, 100, 0]", "xyz = [0, 0, 0]")], "TCP", "note", "the flange itself"),
    ([("HOME = [0, 0, 0, 0, 0, 0]", "HOME = [0, 0, 0, 0, 30, 0]")], "HOME", "ok", "not near"),
    ([("a0 = [0", "a0 = [1")], "HOME", "note", "J4 and J6"),
    ([("7110.1274", "71.1")], "encoder resolution", "to do", "half a count"),
    ([("[1540, 1550", "[154, 1550")], "motor speeds", "note", "motor 1 reaches 10"),
    ([("[1540, 1550, 3520", "[1540, 1550, 2000")], "motor speeds", "note", "motor 3 limits"),
    ([("[1540, 1550", "[99999, 1550")], "motor speeds", "note", "three times"),
    ([("a0 = [0, 0, 0, 0, 0, 0]  # counts", "a0 = [0, 0, 0, 0, 0, 0]  # guess: none")], "guess", "to do",
        "none"),
    ([("velocity = 60  ", 'velocity = "60"')], "Y1306", "to do", "text"),
    ([("velocity = [1540, ", "velocity = [")], "Y1309", "to do", "5"),
    ([("speed = 250 ", "speed = 400 ")], "jogs", "note", "up to 400 mm/s"),
    ([("jerk = 2000  ", "jerk = 2000\nstop_acceleration = 100  ")], "stops", "note", "J1"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "subject", "verdict", "word"), POINTS)
def test_a_point(changes, subject, verdict, word, tmp_path):
    items = [item for item in check_robot(changed(tmp_path, *changes)).items if item.subject == subject]
    assert [item.verdict for item in items if word in item.found] == [verdict], items
    if verdict != "ok":
        assert all(item.remedy for item in items if item.verdict == verdict)


def test_a_urdf_in_millimetres(tmp_path):
    folder = changed(tmp_path, ('xyz="0 0 0.89"', 'xyz="0 0 890"'), file="industrial6.urdf")
    (units,) = [item for item in check_robot(folder).items if item.subject == "units"]
    assert units.verdict == "to do"
    assert "m and rad" in units.remedy


def test_continuous_joints_are_told(tmp_path):
    text = 'name="J6" type="revolute"'
    folder = changed(tmp_path, (text, text.replace("revolute", "continuous")), file="industrial6.urdf")
    (one,) = [item for item in check_robot(folder).items if item.subject == "continuous joints"]
    assert one.verdict == "ok"
    toml = (tmp_path / "robot.toml").read_text().replace("position = [-360, 360]\n", "")
    (tmp_path / "robot.toml").write_text(toml)
    (one,) = [item for item in check_robot(folder).items if item.subject == "continuous joints"]
    assert one.verdict == "note"
    assert "J6" in one.found


@pytest.mark.parametrize("words", [["no-such-robot"], ["."], []])
def test_what_is_no_robot(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = yarc("robot", "check", *words)
    assert result.exit_code == 1
    assert "to do" in result.output
    assert "Traceback" not in result.output


def heavy(center, effort=500):
    """Return the URDF of a large arm in which each link has a mass with its center at `center`."""
    inside = (
        f'<inertial><origin xyz="{center}"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" '
        'iyz="0" izz="0.1"/></inertial>'
    )
    return robot(arm(effort=effort)).replace("</collision></link>", f"</collision>{inside}</link>")


@pytest.mark.parametrize(
    ("center", "joints"), [("0 0 0.1", ""), ("0 0 3", "joint_1"), ("0 2.5 0", "joint_4")]
)
def test_centres_of_mass_far_from_their_links(center, joints, tmp_path):
    yarc("robot", "new", written(tmp_path, heavy(center)), "--yes", "-o", tmp_path / "r")
    items = [one for one in check_robot(str(tmp_path / "r")).items if one.subject == "centres of mass"]
    assert [one.verdict for one in items] == ["note"] * bool(joints)
    assert all(joints in one.found and "the arm is" in one.found for one in items)


def test_an_arm_that_cannot_stand_says_how_often(tmp_path):
    yarc("robot", "new", written(tmp_path, heavy("0 0 0.1", 40)), "--yes", "-o", tmp_path / "r")
    (item,) = [one for one in check_robot(str(tmp_path / "r")).items if one.subject == "torques"]
    assert item.verdict == "note"
    assert "of them a joint needs more than all of its effort" in item.found
    assert "checked = false in [dynamics]" in item.remedy


def test_json(tmp_path):
    yarc("robot", "new", EXAMPLES / "scara.urdf", "--yes", "-o", tmp_path / "r")
    result = yarc("robot", "check", tmp_path / "r", "--format", "json")
    assert result.exit_code == 1
    document = json.loads(result.stdout)
    assert {point["verdict"] for point in document["checks"]} == {"ok", "note", "to do"}


def test_a_new_robot_is_done_when_its_marks_are_gone(tmp_path):
    yarc("robot", "new", EXAMPLES / "scara.urdf", "--yes", "-o", tmp_path / "r")
    path = tmp_path / "r" / "robot.toml"
    path.write_text(
        "\n".join(
            line.split("guess:")[0]
            for line in path.read_text().splitlines()
            if "guess" not in line or "=" in line
        )
    )
    result = yarc("robot", "check", path)
    assert result.exit_code == 0, result.output


def test_the_old_name_is_told():
    result = yarc("robots")
    assert result.exit_code == 2
    assert "Did you mean robot?" in result.output


def test_lines_and_times_are_tried(tmp_path):
    """A normal arm can follow all lines. With a wrist that can hardly move, none is possible with constant
    orientation.
    """
    result = yarc("robot", "check", "INDUSTRIAL6")
    assert "all 12 lines of" in result.output
    assert "µs a pose, of 500 at once" in result.output
    narrow = changed(tmp_path, ("position = [-120, 120]", "position = [-0.2, 0.2]"))
    (lines,) = [item for item in check_robot(narrow).items if item.subject == "lines"]
    assert lines.verdict == "to do"
    assert "J5 is at its limit" in lines.found
    assert "yarc reach" in lines.remedy


def test_seven_joints_follow_their_lines_quickly(tmp_path):
    file, more, _ = REAL["panda"]
    robot = made(DATA / file, tmp_path / "r", *more)
    begun = time.process_time()
    (lines,) = [item for item in geometry_items(robot) if item.subject == "lines"]
    assert time.process_time() - begun < 3
    assert "all 12 lines" in lines.found


def test_lines_that_end_are_told_with_the_joint(tmp_path):
    narrow = changed(tmp_path, ("position = [-120, 120]", "position = [-6, 6]"))
    (lines,) = [item for item in check_robot(narrow).items if item.subject == "lines"]
    assert lines.verdict == "note"
    assert " of 6 lines" in lines.found
    assert "ends after" in lines.found
    assert "J5 is at its limit" in lines.found


@pytest.mark.parametrize(
    ("rpy", "verdict", "words"),
    [
        ("[0, 0, 0]", "note", "neither out nor back"),
        ("[-90, 0, 0]", "note", "out along the tool"),
        ("[90, 0, 0]", "ok", "back along the tool"),
    ],
)
@pytest.mark.parametrize("place", ["[0, 100, 0]", "[0, 0, 0]"])
def test_the_tools_axis_is_told(place, rpy, verdict, words, tmp_path):
    """The check reports the axis along which the tool points: y of the flange, according to both the wrist
    and the tool's tip.
    """
    old = "xyz = [0, 100, 0]  # mm\nrpy = [0, 0, 0]    #"
    robot = changed(tmp_path, (old, f"xyz = {place}  # mm\nrpy = {rpy}    #"))
    (axis,) = [item for item in check_robot(robot).items if item.subject == "tool axis"]
    assert axis.verdict == verdict
    assert words in axis.found
    assert "rpy in [frames.TCP]" in axis.remedy or verdict == "ok"
