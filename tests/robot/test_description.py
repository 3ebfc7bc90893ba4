"""Tests of reading robots: the two robots of the library, one test for each finding, and no exception for any
bytes.
"""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from yarclang.diagnostics import Diagnostic, Result
from yarclang.findings import CATALOGUE, y13_chain, y13_joints, y13_robot, y13_urdf
from yarclang.robot.bare_links import bare_links
from yarclang.robot.description import list_robots, load_robot, stdlib_folder
from yarclang.robot.kinematics.fk import flange_poses, poses_and_jacobians, tool_poses
from yarclang.robot.model import Robot

ROBOTS = stdlib_folder() / "robots"
NAMES = ("industrial6", "tracked_manipulator")
TOML = (ROBOTS / "industrial6" / "robot.toml").read_text()
URDF = (ROBOTS / "industrial6" / "industrial6.urdf").read_text()


def robot(name: str) -> Robot:
    result = load_robot(name)
    assert result.value is not None, result.diagnostics
    assert result.diagnostics == ()
    return result.value


def load_texts(folder: Path, toml: str | bytes = TOML, urdf: str | bytes = URDF) -> Result[Robot]:
    """Return the result of loading a robot from the two texts."""
    for name, text in (("robot.toml", toml), ("industrial6.urdf", urdf)):
        (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return load_robot(str(folder))


# ------------------------------------------------------------------------------------- the library


def test_the_library_lists_its_robots() -> None:
    summaries = list_robots()
    assert [(robot.name, robot.size) for robot in summaries] == [
        ("INDUSTRIAL6", 6),
        ("TRACKED_MANIPULATOR", 6),
    ]
    for summary in summaries:
        assert summary.folder.name == summary.name.lower()
        assert summary.title == robot(summary.name).title


@pytest.mark.parametrize("name", ["INDUSTRIAL6", "industrial6", "Industrial6"])
def test_a_name_is_read_in_any_case(name: str) -> None:
    assert robot(name).name == "INDUSTRIAL6"


def test_a_path_to_the_file_or_its_folder(tmp_path: Path) -> None:
    assert load_texts(tmp_path).ok
    assert load_robot(str(tmp_path / "robot.toml")).ok


def test_an_unknown_name() -> None:
    (finding,) = load_robot("industrail6").diagnostics
    assert finding.code == "Y1301"
    assert "Did you mean INDUSTRIAL6?" in finding.help
    assert "TRACKED_MANIPULATOR" in finding.help


@pytest.mark.parametrize("name", ["", "a\0b", "x" * 5000, "no/such/folder", "robot.toml", "/", "~", "é"])
def test_odd_names_and_paths_are_one_finding(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (finding,) = load_robot(name).diagnostics
    assert finding.code in {"Y1301", "Y1302"}


def test_the_import_is_light() -> None:
    code = (
        "import sys, yarclang.robot.description; print({'pydantic', 'pinocchio', 'scipy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


# --------------------------------------------------------------------------------- the robot as read


def test_industrial6_in_si() -> None:
    arm = robot("industrial6")
    assert arm.joint_names == ("J1", "J2", "J3", "J4", "J5", "J6")
    assert arm.joint_kinds == ("revolute",) * 6
    assert np.allclose(np.rad2deg(arm.limits.lower), [-170, -80, -170, -180, -120, -360])
    assert np.allclose(np.rad2deg(arm.limits.velocity), 60)
    assert np.allclose(arm.limits.stop_acceleration, arm.limits.acceleration)
    assert arm.actuation.velocity[2] == 3_520_000.0
    assert arm.controller.axes == ("X", "Y", "Z", "A", "B", "C")
    assert arm.controller.largest_segment == pytest.approx(0.05)
    assert arm.controller.smallest_segment == pytest.approx(3 * 3 * 0.4427e-3, rel=1e-4)
    assert arm.tolerance.position == pytest.approx(2e-5)
    assert np.array_equal(arm.flange_from_frame["FLANGE"], np.eye(4))
    assert np.allclose(arm.flange_from_frame["TCP"][:3, 3], [0, 0.1, 0])
    assert np.array_equal(arm.home, np.zeros(6))
    arrays = (
        arm.chain.screws,
        arm.chain.base_from_flange,
        arm.limits.lower,
        arm.home,
        arm.actuation.coupling,
    )
    assert all(array.dtype == np.float64 and not array.flags.writeable for array in arrays)


@pytest.mark.parametrize("name", NAMES)
def test_no_motor_limit_is_narrower_than_the_joints(name: str) -> None:
    arm = robot(name)
    fastest = np.abs(arm.actuation.gear[:, None] * arm.actuation.coupling) @ (
        arm.limits.velocity / arm.axis_units
    )
    assert np.all(arm.actuation.velocity >= fastest)
    assert np.all(arm.actuation.velocity <= 1.05 * fastest)


def test_forward_kinematics_of_the_paper(
    conformance_kinematics: dict[str, list[dict[str, list[float]]]],
) -> None:
    arm = robot("industrial6")
    cases = conformance_kinematics["forward_kinematics"]
    poses = tool_poses(arm.chain, np.deg2rad([case["q_deg"] for case in cases]), arm.flange_from_frame["TCP"])
    assert np.allclose(poses[:, :3, 3] * 1e3, [case["tcp_mm"] for case in cases], atol=2e-6)
    assert np.allclose(poses[:, :3, :3], [case["rotation"] for case in cases], atol=2e-9)


@pytest.fixture
def conformance_kinematics() -> dict[str, list[dict[str, list[float]]]]:
    text = (Path(__file__).parents[1] / "conformance" / "industrial6_kinematics.json").read_text()
    data: dict[str, list[dict[str, list[float]]]] = json.loads(text)
    return data


@pytest.mark.parametrize("name", NAMES)
def test_kinematics_against_pinocchio(name: str) -> None:
    import pinocchio as pin

    arm = robot(name)
    model = pin.buildModelFromUrdf(str(arm.folder / arm.urdf))
    data = model.createData()
    base, flange = (model.getFrameId(link, pin.FrameType.BODY) for link in ("base_link", "flange"))
    q = np.random.default_rng(1).uniform(-3, 3, (20, arm.size))
    poses, jacobians = poses_and_jacobians(arm.chain, q, np.eye(4))
    for row, pose, jacobian in zip(q, poses, jacobians, strict=True):
        there = pin.computeFrameJacobian(model, data, row, flange, pin.LOCAL_WORLD_ALIGNED)
        pin.updateFramePlacements(model, data)
        base_from_world = data.oMf[base].inverse()
        assert np.allclose((base_from_world * data.oMf[flange]).homogeneous, pose, atol=1e-12)
        assert np.allclose(np.kron(np.eye(2), base_from_world.rotation) @ there, jacobian, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["VISUAL", "COLLISION"])
def test_pinocchio_keeps_every_shape(name: str, kind: str) -> None:
    import pinocchio as pin

    arm = robot(name)
    path = str(arm.folder / arm.urdf)
    geometry = pin.buildGeomFromUrdf(pin.buildModelFromUrdf(path), path, getattr(pin.GeometryType, kind))
    assert geometry.ngeoms == Path(path).read_text().count(f"<{kind.lower()}>")


@pytest.mark.parametrize("name", NAMES)
def test_named_positions_are_free_of_collision(name: str) -> None:
    import pinocchio as pin

    arm = robot(name)
    path = str(arm.folder / arm.urdf)
    model = pin.buildModelFromUrdf(path)
    shapes = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    parents = [shape.parentJoint for shape in shapes.geometryObjects]
    for first in range(shapes.ngeoms):
        for second in range(first + 1, shapes.ngeoms):
            if abs(parents[first] - parents[second]) > 1:
                shapes.addCollisionPair(pin.CollisionPair(first, second))
    data, results = model.createData(), shapes.createData()
    for position in arm.positions.values():
        pin.computeDistances(model, data, shapes, results, np.array(position))
        assert min(result.min_distance for result in results.distanceResults) > 0.004


def test_the_tracked_arm_has_a_closed_form_and_a_regular_home() -> None:
    arm = robot("tracked_manipulator")
    axes = arm.chain.screws[:, 3:]
    assert np.allclose(np.cross(axes[1], axes[2]), 0)
    assert abs(axes[0] @ axes[1]) < 1e-12
    # A point is on the axis of a screw if its velocity is zero.
    wrist = np.array([0.0, 0.75, 1.1])
    for screw in arm.chain.screws[3:]:
        assert np.allclose(screw[:3] + np.cross(screw[3:], wrist), 0, atol=1e-12)
    _, jacobians = poses_and_jacobians(arm.chain, arm.home[None], np.eye(4))
    assert np.linalg.cond(jacobians[0]) < 50
    reach = np.linalg.norm(flange_poses(arm.chain, np.deg2rad([[0, -90, 90, 0, 0, 0]]))[0, :2, 3])
    assert 1.55 < reach < 1.6


def test_a_chain_with_sliding_and_endless_joints(tmp_path: Path) -> None:
    urdf = URDF.replace('"J1" type="revolute"', '"J1" type="prismatic"').replace(
        '"J6" type="revolute"', '"J6" type="continuous"'
    )
    urdf = urdf.replace(
        'lower="-2.9670597" upper="2.9670597" velocity="1.0471976"', 'effort="1" velocity="9"', 1
    )
    urdf = urdf.replace('effort="1" velocity="9" effort="2000"', 'effort="1" velocity="9"')
    toml = TOML.replace("position = [-360, 360]\n", "").replace("[-170, 170]  # deg", "[-500, 500]")
    result = load_texts(tmp_path, toml, urdf)
    assert result.diagnostics == ()
    assert result.value is not None
    arm = result.value
    assert arm.joint_kinds == ("prismatic", *["revolute"] * 4, "continuous")
    assert arm.axis_unit_names == ("mm", *["deg"] * 5)
    assert np.allclose(arm.chain.screws[0], [0, 0, 1, 0, 0, 0])
    assert arm.limits.upper[0] == pytest.approx(0.5)
    assert arm.limits.upper[5] == math.inf
    assert arm.limits.velocity[0] == pytest.approx(0.06)


def test_an_axis_of_any_length_and_frames_on_frames(tmp_path: Path) -> None:
    frames = '[frames.far]\nparent = "A"\nxyz = [0, 0, 10]\n[frames.a]\nparent = "Tcp"\nrpy = [90, 0, 90]\n'
    toml = TOML.replace("[positions]", frames + "[positions]")
    result = load_texts(tmp_path, toml, URDF.replace('<axis xyz="0 -1 0"/>', '<axis xyz="0 -7 0"/>'))
    assert result.value is not None, result.diagnostics
    assert np.allclose(result.value.chain.screws, robot("industrial6").chain.screws, atol=1e-12)
    frame = result.value.flange_from_frame
    assert sorted(frame) == ["A", "FAR", "FLANGE", "TCP"]
    # Rz(90) Rx(90) turns z to -y, and then to x.
    assert np.allclose(frame["A"][:3, :3], [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    assert np.allclose(frame["FAR"][:3, 3], [0.01, 0.1, 0])


def test_the_fingerprint_is_of_the_content(tmp_path: Path) -> None:
    ours = robot("industrial6").fingerprint
    bare = re.sub(r" +#.*", "", TOML).replace("velocity = 60", "velocity = 60.0")
    same = load_texts(tmp_path, bare, re.sub(r"\n\s+", "\n ", URDF)).value
    assert same is not None
    assert same.fingerprint == ours
    for toml, urdf in (
        (
            TOML.replace("velocity = 60 ", "velocity = 61 "),
            URDF.replace('velocity="1.0471976"', 'velocity="2"'),
        ),
        (TOML, URDF.replace('xyz="0 0 0.23"', 'xyz="0 0 0.24"')),
        (TOML, URDF.replace('radius="0.06"', 'radius="0.061"')),
    ):
        other = load_texts(tmp_path, toml, urdf).value
        assert other is not None
        assert other.fingerprint != ours


def test_the_speed_of_jogs_is_the_robots_and_no_programs(tmp_path: Path) -> None:
    ours = robot("industrial6")
    assert ours.jog_speed == pytest.approx(0.25)
    other = load_texts(tmp_path, TOML.replace("speed = 250 ", "speed = 100 "), URDF).value
    assert other is not None
    assert other.jog_speed == pytest.approx(0.1)
    assert other.fingerprint == ours.fingerprint  # compiled programs stay valid
    without = load_texts(tmp_path, TOML[: TOML.index("# How fast")], URDF).value
    assert without is not None
    assert without.jog_speed == pytest.approx(0.25)


# ---------------------------------------------------------------------------- one test for each finding

J1 = "[joints.J1]\nposition = [-170, 170]  # deg\nvelocity = 60           # deg/s\n"
I6 = "    [0, 0, 0, 0, 0, 1],\n"
FIRST_LIMIT = '<limit lower="-2.9670597" upper="2.9670597" velocity="1.0471976" effort="2000"/>'

IN_TOML = [
    # code, text, replacement, a part of the reported line
    ("Y1302", 'urdf = "industrial6.urdf"', 'urdf = "other.urdf"', "other.urdf"),
    ("Y1302", 'urdf = "industrial6.urdf"', 'urdf = "."', 'urdf = "."'),
    ("Y1302", 'urdf = "industrial6.urdf"', 'urdf = "\\u0000"', "urdf ="),
    ("Y1303", "velocity = 60  ", "velocity = 60 deg", "60 deg"),
    ("Y1303", "velocity = 60  ", "velocity = " + "9" * 5000, "99999"),
    ("Y1304", 'name = "INDUSTRIAL6"\n', "", ""),
    ("Y1362", 'base = "', 'ignored_joints = ["J9"]\nbase = "', "J9"),
    ("Y1362", 'base = "', 'ignored_joints = ["J1"]\nbase = "', "J1"),
    ("Y1304", 'flange = "flange" ', "# ", ""),
    ("Y1304", J1, J1.replace("velocity", "# "), "[joints.J1]"),
    ("Y1304", "HOME =", "START =", "[positions]"),
    ("Y1304", "K = [", "#  [", "[actuation]"),
    ("Y1304", "velocity = [1540", "# [1540", "[motors]"),
    ("Y1304", "feedback =", "# ", "[controller]"),
    ("Y1305", "jerk = 2000             #", "jerk = 2000\nstop_aceleration = 300 #", "stop_aceleration"),
    ("Y1305", "axes = ", "axis = ", "axis ="),
    ("Y1305", "[motors]", "[motor]", "[motor]"),
    ("Y1305", "# How far", "[extra]\na = 1\n#", "[extra]"),
    ("Y1306", "velocity = 60  ", 'velocity = "60"', '"60"'),
    ("Y1306", "velocity = 60  ", "velocity = true", "true"),
    ("Y1306", "[-170, 170]", '[-170, "170"]', '"170"'),
    ("Y1306", "[1, 2, 3, 4, 5, 6]", "[1, 2, 3.0, 4, 5, 6]", "3.0"),
    ("Y1306", "    [0, 1, 1, 0, 0, 0],", "    0,", "    0,"),
    ("Y1306", "[tolerance]\nposition = 0.02  # mm\nangle = 0.002    # deg\n", "[[tolerance]]", "tolerance"),
    ("Y1307", "velocity = 60  ", "velocity = nan ", "nan"),
    ("Y1307", "velocity = 60  ", "velocity = inf ", "inf"),
    ("Y1307", "velocity = 60  ", "velocity = 1e30 ", "1e30"),
    ("Y1307", "velocity = 60  ", "velocity = 1" + "0" * 400, "1000"),
    ("Y1307", "i8 = 2", "i8 = 1" + "0" * 400, "1000"),
    ("Y1307", I6, "    [0, 0, 0, 0, 0, nan],\n", "nan"),
    ("Y1308", "velocity = 60  ", "velocity = -60 ", "-60"),
    ("Y1308", "acceleration = 240  ", "acceleration = 0 ", "= 0"),
    ("Y1308", "jerk = 2000  ", "jerk = -1 ", "-1"),
    ("Y1308", "velocity = [1540", "velocity = [0", "[0,"),
    ("Y1308", "numbers = [1, ", "numbers = [33, ", "33"),
    ("Y1308", "numbers = [1, ", "numbers = [0, ", "[0,"),
    ("Y1308", "coordinate_system = 1", "coordinate_system = 17", "17"),
    ("Y1308", "rapid_share = 0.1", "rapid_share = 1.5", "1.5"),
    ("Y1308", "speed = 250", "speed = 0", "0"),
    ("Y1308", "speed = 250", "speed = -250", "-250"),
    ("Y1308", "speed = 250", "speed = 250000", "250000"),
    ("Y1307", "speed = 250", "speed = nan", "nan"),
    ("Y1306", "speed = 250", 'speed = "slow"', '"slow"'),
    ("Y1306", "[jog]\nspeed = 250", "[[jog]]", "jog"),
    ("Y1308", '"turbo-pmac"', '"power-pmac"', "power-pmac"),
    ("Y1309", "position = [-170, 170]", "position = [-170]", "[-170]"),
    ("Y1309", "HOME = [0, ", "HOME = [", "HOME"),
    ("Y1309", "xyz = [0, 100, 0]", "xyz = [0, 100]", "xyz"),
    ("Y1309", "K = [25532.8278, ", "K = [", "K ="),
    ("Y1309", "a0 = [0, ", "a0 = [", "a0"),
    ("Y1309", I6, "", "J = ["),
    ("Y1309", I6, "    [0, 0, 0, 0, 1],\n", "    [0, 0, 0, 0, 1],"),
    ("Y1309", 'axes = ["X", ', "axes = [", "axes"),
    ("Y1309", 'feedback = ["P1", ', "feedback = [", "feedback"),
    ("Y1309", "numbers = [1, ", "numbers = [", "numbers"),
    ("Y1309", "velocity = [1540, ", "velocity = [", "velocity = [1550"),
    ("Y1310", 'name = "INDUSTRIAL6"', 'name = "MY ROBOT"', "MY ROBOT"),
    ("Y1310", "[frames.TCP]", "[frames.FLANGE]", "FLANGE"),
    ("Y1310", "[frames.TCP]", "[frames.b]", "[frames.b]"),
    ("Y1310", "[frames.TCP]", '[frames."T é"]', "T é"),
    ("Y1310", "HOME =", "P12 = [0, 0, 0, 0, 0, 0]\nHOME =", "P12"),
    ("Y1311", "[positions]", "[frames.tcp]\n[positions]", "[frames.tcp]"),
    ("Y1312", TOML[TOML.index("[joints.J6]") : TOML.index("# Makes y")], "", "[joints.J1]"),
    ("Y1313", "[joints.J6]", "[joints.J7]", "J7"),
    ("Y1313", "# Makes y", "[joints.J7]\nvelocity = 1\nacceleration = 1\njerk = 1\n# Makes y", "J7"),
    ("Y1315", "position = [-170, 170]", "", "[joints.J1]"),
    ("Y1316", "position = [-170, 170]", "position = [170, -170]", "[170, -170]"),
    ("Y1316", "position = [-170, 170]", "position = [5, 5]", "[5, 5]"),
    ("Y1317", "HOME = [0, 0,", "HOME = [0, 91.5,", "91.5"),
    ("Y1317", "HOME =", "Other = [0, 0, 0, 0, -121, 0]\nHOME =", "-121"),
    ("Y1319", "K = [25532.8278,", "K = [0.0,", "0.0"),
    ("Y1320", I6, "    [0, 0, 0, 0, 0, 1e-9],\n", "J = ["),
    ("Y1320", "    [0, 1, 0, 0, 0, 0],\n", "    [0, 1, 1, 0, 0, 0],\n", "J = ["),
    ("Y1321", '"X", "Y"', '"Q", "Y"', '"Q"'),
    ("Y1321", '"X", "Y"', '"x", "Y"', '"x"'),
    ("Y1321", '"X", "Y"', '"XY", "Y"', '"XY"'),
    ("Y1322", '"A", "B"', '"A", "A"', '"A", "A"'),
    ("Y1323", "[1, 2, 3, 4, 5, 6]", "[1, 2, 3, 3, 5, 6]", "3, 3"),
    ("Y1324", '"Y", "Z"', '"Y", "U"', "[0, 1, 1, 0, 0, 0]"),
    ("Y1324", I6, "    [0, 0, 0, 0, 1, 1],\n", "    [0, 0, 0, 0, 1, 1],"),
    ("Y1325", I6, "    [0, 0, 0, 0, 0, 0],\n", "    [0, 0, 0, 0, 0, 0],"),
    ("Y1325", I6, "    [0, 0, 0, 0, 1, 0],\n", "[0, 0, 0, 0, 1, 0],"),
    ("Y1326", '"P1"', '"Q1"', "Q1"),
    ("Y1326", '"P1"', '"P8100"', "P8100"),
    ("Y1326", '"P1"', '"P01"', "P01"),
    ("Y1326", '"P1"', '"P٣"', "feedback"),
    ("Y1327", '"P1", "P2"', '"P1", "P1"', '"P1", "P1"'),
    ("Y1328", "largest_tm = 50 ", "largest_tm = 3.9 ", "3.9"),
    ("Y1328", "largest_tm = 50 ", "largest_tm = 4097 ", "4097"),
    ("Y1328", "i8 = 2 ", "i8 = 255 ", "largest_tm"),
    ("Y1329", 'parent = "FLANGE"', 'parent = "FLANG"', "FLANG"),
    ("Y1330", 'parent = "FLANGE"', 'parent = "TCP"', 'parent = "TCP"'),
    ("Y1330", 'parent = "FLANGE"', 'parent = "A1"\n[frames.A1]\nparent = "TCP"', 'parent = "A1"'),
    ("Y1347", 'base = "base_link"', 'base = "base_lnk"', "base_lnk"),
    ("Y1347", 'flange = "flange"', 'flange = "Flange"', "Flange"),
    ("Y1353", 'base = "base_link"', 'base = "flange"', 'base = "flange"'),
]

SHAPE = 'capsule radius="0.06" length="0.1"'
BALL = '<geometry><capsule radius="0.06" length="0.1"/></geometry>\n    </collision>'
LOOP = """<link name="p"/><link name="q"/>
<joint name="r" type="fixed"><parent link="p"/><child link="q"/></joint>
<joint name="s" type="fixed"><parent link="q"/><child link="p"/></joint></robot>"""


STRAY = """<link name="p"/>
<joint name="r" type="continuous"><parent link="link_2"/><child link="p"/></joint></robot>"""
MANY = "".join(f'\n<link name="x{at}"/>' for at in range(1001))
IN_URDF = [
    ("Y1340", '<link name="flange"/>', '<link name="flange">', "</robot>"),
    ("Y1340", "</robot>", "</robot>&", "</robot>&"),
    ("Y1340", 'radius="0.06"', 'radius="0.06" radius="1"', "radius="),
    ("Y1341", "<robot name", "<!DOCTYPE robot [<!ENTITY a 'b'>]>\n<robot name", "DOCTYPE"),
    ("Y1341", '<link name="flange"/>', '<link name="flange"/><xacro:if value="1"/>', "xacro"),
    ("Y1341", 'version="1.1">', 'version="2.0">', '"2.0"'),
    ("Y1341", '<link name="flange"/>', '<link name="flange"/>' + "<a>" * 40 + "</a>" * 40, "<a>"),
    ("Y1341", '<link name="flange"/>', MANY, "<link"),
    ("Y1341", 'xyz="0 0 0.23"', 'xyz="0 0 0.23" quat_xyzw="0 0 0 1"', "quat_xyzw"),
    ("Y1342", '<robot name="industrial6"', "<robot", "<robot"),
    ("Y1342", '<link name="flange"/>', '<link name="flange"/>\n<link/>', "<link/>"),
    ("Y1342", '    <parent link="base_link"/>\n', "", 'name="J1"'),
    ("Y1342", '<parent link="base_link"/>', "<parent/>", "<parent/>"),
    ("Y1342", '    <child link="link_6"/>\n', "", 'name="J6"'),
    ("Y1342", '<axis xyz="0 0 1"/>', "<axis/>", "<axis/>"),
    ("Y1342", FIRST_LIMIT, "", 'name="J1"'),
    ("Y1342", FIRST_LIMIT, FIRST_LIMIT.replace(' effort="2000"', ""), "<limit"),
    ("Y1342", '<joint name="J1" type="revolute"', '<joint name="J1"', "J1"),
    ("Y1342", FIRST_LIMIT, FIRST_LIMIT + "\n<dynamics/>", "<dynamics/>"),
    ("Y1342", '<link name="flange"/>', '<link name="flange">\n<inertial/></link>', "<inertial/>"),
    ("Y1342", '<material name="grey"><color', "<material><color", "<material><color"),
    ("Y1343", 'joint name="flange_mount"', 'joint name="flange mount"', "flange mount"),
    ("Y1343", 'joint name="flange_mount"', 'joint name="universe"', "universe"),
    ("Y1344", '<link name="flange"/>', '<link name="flange"/>\n<link name="flange" />', 'flange" />'),
    ("Y1344", 'joint name="J2"', 'joint name="J1"', 'joint name="J1" type="revolute"'),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0 0 abc"', "abc"),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0 0 nan"', "nan"),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0 0 1e400"', "1e400"),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0, 0, 0.23"', "0, 0"),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0\t0 0.23"', "0.23"),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0 0"', '"0 0"'),
    ("Y1345", 'xyz="0 0 0.23"', 'xyz="0 0 ٣"', "٣"),
    ("Y1345", 'effort="2000"', 'effort="x"', 'effort="x"'),
    ("Y1345", 'rgba="0.35 0.36 0.38 1"', 'rgba="0.35 0.36 0.38 2"', "0.38 2"),
    ("Y1346", 'size="0.22 0.26 0.34"', 'size="0.22 0 0.34"', "0.22 0 0.34"),
    ("Y1346", BALL, BALL.replace("0.06", "-0.06"), "-0.06"),
    ("Y1346", FIRST_LIMIT, FIRST_LIMIT.replace('velocity="1', 'velocity="-1'), "-1.04"),
    ("Y1346", FIRST_LIMIT, FIRST_LIMIT.replace('effort="', 'effort="-'), "-2000"),
    ("Y1346", FIRST_LIMIT, FIRST_LIMIT + '\n<dynamics damping="-1"/>', "damping"),
    ("Y1347", '<child link="link_3"/>', '<child link="lnk_3"/>', "lnk_3"),
    ("Y1347", '<parent link="link_3"/>', '<parent link="lnk_3"/>', "lnk_3"),
    ("Y1348", '<child link="link_3"/>', '<child link="link_2"/>', '<child link="link_2"/>'),
    ("Y1349", '<link name="flange"/>', '<link name="flange"/>\n<link name="loose"/>', "loose"),
    ("Y1350", "</robot>", LOOP, 'name="r"'),
    ("Y1351", '"J1" type="revolute"', '"J1" type="Revolute"', "Revolute"),
    ("Y1351", '"J1" type="revolute"', '"J1" type="planar"', "planar"),
    ("Y1351", '"J1" type="revolute"', '"J1" type="floating"', "floating"),
    ("Y1351", FIRST_LIMIT, FIRST_LIMIT + '\n<mimic joint="J2"/>', "mimic"),
    ("Y1352", '<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "0 0 0"),
    ("Y1354", "</robot>", STRAY, 'name="r"'),
    ("Y1355", FIRST_LIMIT, FIRST_LIMIT.replace('upper="2.9', 'upper="2.8'), "upper"),
    ("Y1355", FIRST_LIMIT, FIRST_LIMIT.replace('velocity="1.0', 'velocity="0.9'), "0.9"),
    ("Y1356", BALL, BALL.replace(SHAPE, 'cone radius="1"'), "<cone"),
    ("Y1356", BALL, "<geometry/>\n    </collision>", "<geometry/>"),
    ("Y1356", BALL, "</collision>", "<collision>"),
    ("Y1357", BALL, BALL.replace(SHAPE, 'mesh filename="a.stl"'), "a.stl"),
    ("Y1357", BALL, BALL.replace(SHAPE, 'mesh filename="package://x/a.stl"'), "a.stl"),
    ("Y1361", '<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/>\n<axis xyz="0 1 0"/>', '"0 1 0"'),
    ("Y1361", BALL, BALL.replace("</geo", '<sphere radius="1"/></geo'), "sphere"),
]  # fmt: skip


def cases(table: list[tuple[str, str, str, str]]) -> list[object]:
    return [pytest.param(*row, id=f"{row[0]}-{at}") for at, row in enumerate(table)]


def check_one(findings: tuple[Diagnostic, ...], code: str, file: str, mark: str) -> None:
    assert [(finding.code, finding.message) for finding in findings if finding.code != code] == []
    (finding,) = findings
    assert finding.source is not None
    assert finding.span is not None
    assert Path(finding.source.name).name == file
    assert mark in finding.source.line(finding.span.line), (finding.message, finding.span)
    assert finding.message.endswith(".")
    assert finding.help
    assert len(finding.message) < 300


@pytest.mark.parametrize(("code", "old", "new", "mark"), cases(IN_TOML))
def test_a_finding_about_robot_toml(tmp_path: Path, code: str, old: str, new: str, mark: str) -> None:
    assert old in TOML
    result = load_texts(tmp_path, TOML.replace(old, new, 1))
    check_one(result.diagnostics, code, "robot.toml", mark)
    assert result.value is None


@pytest.mark.parametrize(("code", "old", "new", "mark"), cases(IN_URDF))
def test_a_finding_about_the_urdf(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], code: str, old: str, new: str, mark: str
) -> None:
    assert old in URDF
    result = load_texts(tmp_path, TOML, URDF.replace(old, new, 1))
    check_one(result.diagnostics, code, "industrial6.urdf", mark)
    assert (result.value is None) == (CATALOGUE[code].severity == "error")
    assert capfd.readouterr().err == ""  # Pinocchio hasn't read it, and so has printed nothing


def test_what_else_can_be_wrong_with_the_chain(tmp_path: Path) -> None:
    still = URDF.replace('type="revolute"', 'type="fixed"')
    findings = load_texts(tmp_path, TOML, still).diagnostics
    check_one(findings, "Y1353", "robot.toml", "base =")
    link = URDF[URDF.index('  <link name="link_4">') : URDF.index('  <link name="link_5">')]
    result = load_texts(tmp_path, TOML, URDF.replace(link, '  <link name="link_4"/>\n'))
    assert result.value is not None
    assert result.diagnostics == ()  # not repeated by each command of a program
    check_one(bare_links(result.value), "Y1359", "industrial6.urdf", "link_4")
    result = load_texts(tmp_path, TOML, URDF.replace(' version="1.1"', "", 1).replace('version="1.1">', ">"))
    assert {finding.code for finding in result.diagnostics} == {"Y1358"}
    assert len(result.diagnostics) == URDF.count("<capsule ")


def test_tables_in_another_order_than_the_chain(tmp_path: Path) -> None:
    first, second = TOML.index("[joints.J1]"), TOML.index("[joints.J2]")
    moved = TOML[:first] + TOML[second:].replace("# Makes y", TOML[first:second] + "# Makes y")
    result = load_texts(tmp_path, moved)
    check_one(result.diagnostics, "Y1314", "robot.toml", "[joints.J2]")
    assert result.value is not None


def test_ten_joints_are_too_many(tmp_path: Path) -> None:
    tables, joints, links = "", "", ""
    for at in range(1, 11):
        tables += f"[joints.J{at}]\nvelocity = 1\nacceleration = 1\njerk = 1\n"
        links += f'<link name="l{at}"><collision><geometry><sphere radius="1"/></geometry></collision></link>'
        joints += (
            f'<joint name="J{at}" type="continuous"><parent link="l{at - 1}"/><child link="l{at}"/></joint>'
        )
    urdf = f'<robot name="snake"><link name="l0"/>{links}{joints}</robot>'
    rows = [[int(row == at) for at in range(10)] for row in range(10)]
    toml = (
        f'name = "SNAKE"\nurdf = "industrial6.urdf"\nbase = "l0"\nflange = "l10"\n{tables}'
        f"[positions]\nHOME = {[0] * 10}\n[actuation]\nK = {[1] * 10}\nJ = {rows}\n"
        f"[motors]\nnumbers = {list(range(1, 11))}\nvelocity = {[1] * 10}\n[controller]\n"
    )
    findings = load_texts(tmp_path, toml, urdf).diagnostics
    assert sorted(finding.code for finding in findings) == ["Y1304", "Y1304", "Y1318"]


def test_what_pinocchio_refuses_is_a_finding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import pinocchio as pin

    def refuse(text: str) -> None:
        raise ValueError("no model")

    monkeypatch.setattr(pin, "buildModelFromXML", refuse)
    check_one(load_texts(tmp_path).diagnostics, "Y1360", "industrial6.urdf", "<robot")


def test_the_mistakes_of_both_files_come_in_one_run(tmp_path: Path) -> None:
    toml = TOML.replace('name = "INDUSTRIAL6"\n', "").replace("velocity = 60  ", 'velocity = "60"', 1)
    toml = toml.replace("[-80, 90]", "[90, -80]").replace('"P1"', '"Q1"').replace("K = [25532.8278", "K = [0")
    urdf = URDF.replace('radius="0.05"', 'radius="-1"').replace('<child link="link_3"/>', '<child link="x"/>')
    codes = sorted(finding.code for finding in load_texts(tmp_path, toml, urdf).diagnostics)
    assert codes == ["Y1304", "Y1306", "Y1316", "Y1319", "Y1326", "Y1346", "Y1346", "Y1347"]


@pytest.mark.parametrize("mimic", ["", '<mimic joint="J2"/>'])
@pytest.mark.parametrize("kind", ["revolute", "planar", "floating"])
def test_a_joint_off_the_chain_may_be_ignored(kind: str, mimic: str, tmp_path: Path) -> None:
    urdf = URDF.replace("</robot>", STRAY.replace("revolute", kind).replace("</joint>", mimic + "</joint>"))
    (finding,) = load_texts(tmp_path, urdf=urdf).diagnostics
    assert finding.code == "Y1354"
    toml = TOML.replace('base = "', 'ignored_joints = ["r"]\nbase = "', 1)
    result = load_texts(tmp_path, toml, urdf)
    assert result.diagnostics == ()
    assert result.value is not None
    assert result.value.fingerprint != ""


def test_a_visual_mesh_may_miss(tmp_path: Path) -> None:
    visual = '<visual><geometry><mesh filename="package://x/a.stl"/></geometry></visual>\n<collision>'
    assert load_texts(tmp_path, urdf=URDF.replace("<collision>", visual, 1)).diagnostics == ()


def test_a_fixed_joint_needs_no_axis(tmp_path: Path) -> None:
    urdf = re.sub(r'(<joint[^>]*type="fixed">)', r'\1<axis xyz="0 0 0"/>', URDF, count=1)
    assert urdf != URDF
    assert load_texts(tmp_path, urdf=urdf).ok


def test_every_finding_of_the_family_is_tested() -> None:
    tested = {row[0] for row in (*IN_TOML, *IN_URDF)}
    tested |= {"Y1301", "Y1314", "Y1318", "Y1358", "Y1359", "Y1360"}
    tested |= {"Y1365"}  # tested by the tests of `yarc robot new`
    families = (y13_robot, y13_joints, y13_urdf, y13_chain)
    assert {finding.code for family in families for finding in family.FINDINGS} == tested


def test_a_mesh_is_found_beside_the_urdf(tmp_path: Path) -> None:
    arm = tmp_path / "arm"
    shutil.copytree(ROBOTS / "industrial6", arm)
    (tmp_path / "meshes").mkdir()
    for name in ("arm/a b.stl", "meshes/c.stl"):
        (tmp_path / name).write_bytes(b"solid a\nendsolid a\n")
    for name in ("a b.stl", "package://meshes/c.stl", f"file://{tmp_path}/meshes/c.stl"):
        mesh = BALL.replace(SHAPE, f'mesh filename="{name}"')
        assert load_texts(arm, TOML, URDF.replace(BALL, mesh)).diagnostics == ()


# ------------------------------------------------------------------------------ whatever the bytes are


def check_any(result: Result[Robot]) -> None:
    """Check that the result is a robot or errors, and what holds for each finding."""
    assert (result.value is None) == any(finding.is_error for finding in result.diagnostics)
    for finding in result.diagnostics:
        assert finding.message.endswith(".")
        assert finding.help
        if finding.span is not None:
            assert finding.source is not None
            assert 1 <= finding.span.line <= max(1, len(finding.source.lines))
            assert finding.span.column >= 1
    assert len(set(result.diagnostics)) == len(result.diagnostics)


QUICK = settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    derandomize=True,
)


@QUICK
@given(content=st.binary(max_size=200))
@example(content=b"")
@example(content=b"\xff\xfe\x00")
@example(content=b"\xef\xbb\xbf")
@example(content=b"[" * 50_000)
@example(content=b"a = " + b"[" * 50_000)
@example(content=b"a." * 5_000 + b"b = 1")
@example(content=b"joints = 1979-05-27T07:32:00Z\nname = 2000-01-01")
def test_any_bytes_as_robot_toml(tmp_path: Path, content: bytes) -> None:
    check_any(load_texts(tmp_path, content))


@QUICK
@given(content=st.binary(max_size=200))
@example(content=b"")
@example(content=b"\xff")
@example(content=b"\xef\xbb\xbf<robot/>")
@example(content=b"<a>" * 100_000)
@example(content=b"<?xml version='1.0' encoding='utf-16'?><robot/>")
@example(content=b"<?xml version='1.0' encoding='nonsense'?><robot/>")
@example(content=b"<robot name='" + b"a" * 100_000)
@example(content=b"<robot name='a'><joint/><joint><parent/><child/></joint></robot>")
def test_any_bytes_as_urdf(tmp_path: Path, content: bytes) -> None:
    check_any(load_texts(tmp_path, TOML, content))


def changes(text: str, tokens: str) -> st.SearchStrategy[str]:
    """Return a strategy of texts with some tokens removed, doubled or replaced."""
    places = [match.span() for match in re.finditer(tokens, text)]
    odd = [
        "",
        "nan",
        "-inf",
        "1e400",
        '""',
        '"x"',
        "[]",
        "{}",
        "<",
        ">",
        "-1",
        "0",
        "[[1]]",
        "\x00",
        "é",
        "\n",
    ]

    def apply(edits: list[tuple[int, str]]) -> str:
        changed = text
        for at, new in sorted(edits, reverse=True):
            start, end = places[at]
            changed = changed[:start] + (changed[start:end] * 2 if new == "twice" else new) + changed[end:]
        return changed

    edit = st.tuples(st.integers(0, len(places) - 1), st.sampled_from([*odd, "twice"]))
    return st.lists(edit, min_size=1, max_size=4, unique_by=lambda pair: pair[0]).map(apply)


@QUICK
@given(toml=changes(TOML, r'[\w.]+|"[^"]*"|[\[\]=,]|\n'))
def test_any_change_of_robot_toml(tmp_path: Path, toml: str) -> None:
    check_any(load_texts(tmp_path, toml))


@QUICK
@given(urdf=changes(URDF, r'<[^>]*>|[-\w.]+|"[^"]*"|[/=]'))
def test_any_change_of_the_urdf(tmp_path: Path, capfd: pytest.CaptureFixture[str], urdf: str) -> None:
    check_any(load_texts(tmp_path, TOML, urdf))
    assert capfd.readouterr().err == ""
