"""Tests with URDFs like those of manufacturers: the joints of the arm are found, and Pinocchio, which reads
the original text, checks everything up to the emitted path.
"""

from __future__ import annotations

import numpy as np
import pytest
from programs import compiled

from tests.robot.made_arms import made, yarc
from tests.robot.trap_arms import HAND, X, Y, arm, follows, joint, link, poses, robot, written
from yarclang.independent.reading import read
from yarclang.robot.kinematics import flange_poses, reaching
from yarclang.robot.kinematics.search import within

SIX = tuple(f"joint_{number}" for number in range(1, 7))
WORLD = link("world", shape=False)
PATH = 0.01
"""Largest allowed distance of an emitted line from the straight line [mm]."""


def fixed(name, parent, child, xyz=(0, 0, 0)):
    return joint(name, parent, child, xyz, kind="fixed")


CAMERA = link("camera_link") + fixed("cam", "tool0", "camera_link", (0.05, 0, 0))
CAMERA += link("camera_optical_frame", shape=False) + fixed("lens", "camera_link", "camera_optical_frame")
FEET = (
    WORLD
    + link("base_footprint", shape=False)
    + fixed("w", "world", "base_footprint")
    + arm(base=("base_footprint", ""))
)
CONTROL = """<gazebo reference="link_1"><material>Gazebo/Orange</material></gazebo><transmission name="t1">
<type>transmission_interface/SimpleTransmission</type><joint name="joint_1"/><actuator name="m"/></transmission>
<ros2_control name="c" type="system"><hardware><plugin>mock</plugin></hardware><joint name="joint_1"/></ros2_control>"""  # noqa: E501
LIFT = link("foot") + link("torso") + joint("lift", "foot", "torso", kind="prismatic")
HEAD = link("pan") + link("tilt") + joint("head_pan", "torso", "pan", (0, 0, 0.5))
HEAD += joint("head_tilt", "pan", "tilt", axis=Y)
CHASSIS = (
    WORLD
    + link("bx", shape=False)
    + link("by", shape=False)
    + link("chassis")
    + joint("x", "world", "bx", axis=X, kind="prismatic")
    + joint("y", "bx", "by", axis=Y, kind="prismatic")
    + joint("turn", "by", "chassis")
)
TABLE = link("cradle") + link("table") + joint("cradle_joint", "world", "cradle", (1, 0, 0.5), Y)
TABLE += joint("table_joint", "cradle", "table")
CUP = link("cup") + joint("cup_slide", "tool0", "cup", (0, 0, 0.1), kind="prismatic")

GANTRY = (
    WORLD
    + "".join(map(link, ("x", "x2", "y", "z")))
    + joint("jx", "world", "x", axis=X, kind="prismatic")
    + joint("jx2", "world", "x2", (0, 1, 0), X, "prismatic", follows("jx"))
    + joint("jy", "x", "y", axis=Y, kind="prismatic")
    + joint("jz", "y", "z", kind="prismatic")
)
SCARA = (
    "".join(map(link, ("base_link", "l1", "l2", "quill", "tool0")))
    + joint("j1", "base_link", "l1", (0, 0, 0.3))
    + joint("j2", "l1", "l2", (0.3, 0, 0))
    + joint("j3", "l2", "quill", (0.3, 0, 0), kind="prismatic")
    + joint("j4", "quill", "tool0", kind="continuous")
)
ENDLESS = robot(arm(effort=0)).replace('lower="-2.5" upper="2.5"', 'lower="-999999" upper="999999"')
ZEROS = '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'

FILES = {
    # text, base, flange, joints
    "gripper and camera": (robot(arm(), HAND, CAMERA), "base_link", "tool0", SIX),
    "one finger is called so": (
        robot(arm(), HAND.replace("right_drive", "right_finger")),
        "base_link",
        "tool0",
        SIX,
    ),
    "a cup that slides": (robot(arm(), CUP), "base_link", "tool0", SIX),
    "world, base_footprint, base": (
        robot(FEET, link("base", shape=False), fixed("b", "base_link", "base")),
        "base_link",
        "tool0",
        SIX,
    ),
    "flange, tool0, ee_link": (
        robot(arm(), link("ee_link"), fixed("e", "tool0", "ee_link")),
        "base_link",
        "tool0",
        SIX,
    ),
    "torso and head": (robot(LIFT, arm(base=("torso", "")), HEAD), "foot", "tool0", ("lift", *SIX)),
    "mobile base of three joints": (
        robot(CHASSIS, arm(base=("chassis", ""))),
        "world",
        "tool0",
        ("x", "y", "turn", *SIX),
    ),
    "positioner beside it": (robot(WORLD, arm(base=("world", "")), TABLE), "base_link", "tool0", SIX),
    "gantry of two rails": (robot(GANTRY), "world", "z", ("jx", "jy", "jz")),
    "SCARA": (robot(SCARA), "base_link", "tool0", ("j1", "j2", "j3", "j4")),
    "limits of 999999, effort 0": (ENDLESS, "base_link", "tool0", SIX),
    "masses of 0": (
        robot(arm()).replace("<collision>", f"{ZEROS}<collision>"),
        "base_link",
        "tool0",
        SIX,
    ),
    "ros2_control and gazebo": (
        f'<?xml version="1.0"?>\n<!-- exported -->\n{robot(arm(), CONTROL)}',
        "base_link",
        "tool0",
        SIX,
    ),
    "axes of other lengths": (
        robot(arm()).replace('<axis xyz="1 0 0"/>', '<axis xyz="2 0 0"/>'),
        "base_link",
        "tool0",
        SIX,
    ),
}


@pytest.mark.parametrize("name", FILES)
def test_the_arm_of_the_file(name, tmp_path):
    text, base, flange, names = FILES[name]
    arm_ = made(written(tmp_path, text), tmp_path / "r", "--tcp", "0,0,0")
    assert arm_.joint_names == names
    q = within(arm_.chain, arm_.limits, 200)
    true = poses(text, base, flange, names, q)
    np.testing.assert_allclose(flange_poses(arm_.chain, q), true, atol=1e-9)
    found, solved = reaching(arm_.chain, arm_.limits, true)
    assert solved.mean() >= 0.99
    np.testing.assert_allclose(poses(text, base, flange, names, found[solved]), true[solved], atol=3e-6)


@pytest.mark.parametrize("name", [name for name, file in FILES.items() if len(file[3]) >= 6])
def test_the_emitted_line_is_straight_by_the_original(name, tmp_path):
    text, base, flange, names = FILES[name]
    arm_ = made(written(tmp_path, text), tmp_path / "r", "--tcp", "0,0,0")
    way = np.array([25.0, 10.0, -15.0])
    result, diagnostics = compiled(
        f"DEFAULT {{TCP}} [MIN] (mm,deg,s) {{B}}\nP0020 DMOVE {way[0]} {way[1]} {way[2]} 0 0 0\n",
        str(tmp_path / "r"),
    )
    assert result is not None, diagnostics
    (line,) = read(result.text)[1].values()
    q = line.sample(per_segment=16) * arm_.axis_units
    assert len(q) > 50
    passed = poses(text, base, flange, names, q)
    shift = (passed[:, :3, 3] - passed[0, :3, 3]) * 1e3
    np.testing.assert_allclose(shift[-1], way, atol=PATH)
    along = shift @ way / (way @ way)
    assert np.linalg.norm(shift - along[:, None] * way, axis=1).max() < PATH
    turned = np.einsum("nij,kj->nik", passed[:, :3, :3], passed[0, :3, :3])
    assert np.abs(turned - np.eye(3)).max() < np.radians(0.002)


def closed_chains(count: int) -> str:
    """Return a delta robot: arms and rods side by side, with the platform on one of the rods."""
    parts = [link("base_link")]
    for number in range(count):
        parts += [link(f"arm{number}"), link(f"rod{number}")]
        parts.append(joint(f"drive{number}", "base_link", f"arm{number}", (0.1 * number, 0, 0), Y))
        parts.append(joint(f"passive{number}", f"arm{number}", f"rod{number}", (0.2, 0, 0), Y))
    return robot(*parts, link("platform"), fixed("on", "rod0", "platform"))


ASKED = {
    "two arms": robot(link("torso"), arm("left_", base=("torso", "")), arm("right_", base=("torso", ""))),
    "torso and two arms": robot(LIFT, arm("left_", base=("torso", "")), arm("right_", base=("torso", ""))),
    "delta": closed_chains(3),
}


@pytest.mark.parametrize("name", ASKED)
def test_what_could_be_another_robot_is_asked(name, tmp_path):
    result = yarc("robot", "new", written(tmp_path, ASKED[name]), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1365" in result.output
    assert "--tip" in result.output
    assert not (tmp_path / "r").exists()


REFUSED = {
    "no limits": (robot(arm()).replace("<limit ", "<limits "), "Y1342"),
    "an axis of length 0": (robot(arm()).replace('<axis xyz="1 0 0"/>', '<axis xyz="0 0 0"/>'), "Y1352"),
    "limits the wrong way round": (robot(arm()).replace('"-2.5" upper="2.5"', '"2.5" upper="-2.5"'), "Y1316"),
    "commas": (robot(arm()).replace("0 0 0.78", "0,0,0.78"), "Y1345"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_no_reader_understands_is_refused_at_its_place(name, tmp_path):
    text, code = REFUSED[name]
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert f"error {code}" in result.output
