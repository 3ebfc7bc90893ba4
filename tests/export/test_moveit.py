"""Tests of the exported configuration of MoveIt, read back as XML and YAML, by Pinocchio's reader of URDF,
and by our own readers.
"""

import os
import shutil
import xml.etree.ElementTree as ET
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pinocchio
import pytest
import yaml
from click.testing import CliRunner
from programs import codes, robot_of

from yarclang.cli.yarc import main
from yarclang.collision.scene import scene_of
from yarclang.convert.course import Wishes
from yarclang.convert.srdf import content_of_srdf
from yarclang.diagnostics import Collector
from yarclang.export.moveit.package import package_of
from yarclang.export.moveit.urdf import PackageMeshes
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile

SCARA = Path(__file__).parents[2] / "examples" / "scara.urdf"
TOOL = """
[tools.GRIPPER]
frame = "TCP"
mounted = true

[[bodies]]
tool = "GRIPPER"
shape = "capsule"
radius = 20
length = 60
xyz = [0, 0, -200]
rpy = [0, 90, 0]
"""


def new_robot(folder):
    made = CliRunner().invoke(
        main, ["robot", "new", str(SCARA), "-y", "-o", str(folder), "--name", "LITTLE_ARM"]
    )
    assert made.exit_code == 0, made.output
    robot = load_robot(str(folder))
    assert robot.value is not None
    return robot.value


@pytest.fixture(params=["INDUSTRIAL6", "TRACKED_MANIPULATOR", "LITTLE_ARM", "with a tool"])
def robot(request, tmp_path):
    if request.param == "LITTLE_ARM":
        return new_robot(tmp_path / "arm")
    if request.param == "with a tool":
        return with_tool(tmp_path)
    return robot_of(request.param)


def with_tool(tmp_path, text=TOOL):
    folder = tmp_path / "tooled"
    shutil.copytree(robot_of("INDUSTRIAL6").folder, folder)
    with (folder / "robot.toml").open("a") as file:
        file.write(text)
    found = load_robot(str(folder))
    assert found.value is not None, [one.message for one in found.diagnostics]
    return found.value


def exported(robot):
    result = package_of(robot)
    assert not [one for one in result.diagnostics if one.is_error]
    name = robot.name.lower()
    assert result.value.name == f"{name}_moveit_config"
    return {path.replace(name, "NAME"): data.decode() for path, data in result.value.files.items()}


def read(files, name):
    return yaml.safe_load(files[f"config/{name}.yaml"])


def test_limits_are_equal(robot):
    said = read(exported(robot), "joint_limits")["joint_limits"]
    assert tuple(said) == robot.joint_names
    for at, one in enumerate(said.values()):
        bounded = np.isfinite(robot.limits.lower[at])
        assert one["has_position_limits"] is bool(bounded)
        assert one.get("min_position", -np.inf) == robot.limits.lower[at]
        assert one.get("max_position", np.inf) == robot.limits.upper[at]
        for kind in ("velocity", "acceleration", "jerk"):
            assert one[f"has_{kind}_limits"] is True
            assert one[f"max_{kind}"] == getattr(robot.limits, kind)[at]


def test_plans_leave_room_for_the_way_between_their_points(robot):
    said = read(exported(robot), "joint_limits")
    assert said["default_velocity_scaling_factor"] == 0.9
    assert said["default_acceleration_scaling_factor"] == 0.6


def test_controllers_name_the_joints_in_order(robot):
    files = exported(robot)
    joints = list(robot.joint_names)
    assert read(files, "joint_names") == {"controller_joint_names": joints}
    (one,) = read(files, "ros_controllers")["controller_list"]
    assert one == {
        "name": "",
        "action_ns": "joint_trajectory_action",
        "type": "FollowJointTrajectory",
        "default": True,
        "joints": joints,
    }
    two = read(files, "moveit_controllers")["moveit_simple_controller_manager"]
    (name,) = two["controller_names"]
    assert two[name]["joints"] == joints
    assert two[name]["action_ns"] == "follow_joint_trajectory"
    assert list(read(files, "kinematics")) == ["manipulator"]


def test_the_srdf_by_our_reader_and_by_xml(robot):
    text = exported(robot)["config/NAME.srdf"]
    findings = Collector(SourceFile("a.srdf", text))
    content = content_of_srdf(findings.source, robot, Wishes(), findings)
    assert findings.found == []
    positions = dict(content.positions)
    assert {name.upper() for name in positions} == {*robot.positions}
    for name, values in positions.items():
        np.testing.assert_allclose(values * robot.axis_units, robot.positions[name.upper()], atol=1e-15)
    root = ET.fromstring(text)
    assert [one.get("name") for one in root.iter("group")] == ["manipulator", "end_effector"]
    home = next(one for one in root.iter("group_state") if one.get("name") == "home")
    assert [one.get("name") for one in home.iter("joint")] == list(robot.joint_names)
    np.testing.assert_array_equal([float(one.get("value")) for one in home.iter("joint")], robot.home)
    (end,) = root.iter("end_effector")
    (chain,) = root.iter("chain")
    assert end.get("parent_link") == chain.get("tip_link")


def test_moveit_looks_at_the_pairs_that_are_checked(robot):
    root = ET.fromstring(exported(robot)["config/NAME.srdf"])
    urdf = ET.fromstring(exported(robot)["urdf/NAME.urdf"])
    shaped = {link.get("name") for link in urdf.iter("link") if link.find("collision") is not None}
    off = {frozenset((one.get("link1"), one.get("link2"))) for one in root.iter("disable_collisions")}
    left = {frozenset(pair) for pair in combinations(shaped, 2)} - off
    scene = scene_of(robot, None).value
    checked = {
        frozenset(name.lower() if name == "GRIPPER" else name for name in scene.names(pair))
        for pair in range(len(scene.pairs.first))
    }
    assert left == checked
    assert all(pair <= shaped for pair in off)


def test_the_urdf_is_the_same_arm(robot, tmp_path):
    files = exported(robot)
    path = tmp_path / "exported.urdf"
    path.write_text(files["urdf/NAME.urdf"])
    root = ET.fromstring(files["urdf/NAME.urdf"])
    assert root.get("version", "1.0") == "1.0"
    assert not list(root.iter("capsule"))
    assert ET.fromstring(files["config/NAME.srdf"]).get("name") == root.get("name")
    model = pinocchio.buildModelFromUrdf(str(path))
    before = pinocchio.buildModelFromUrdf(str(robot.folder / robot.urdf))
    assert list(model.names) == list(before.names)
    q = np.random.default_rng(1).uniform(-1, 1, len(robot.joint_names))
    data = model.createData()
    whole = pinocchio.neutral(model)
    for name, value in zip(robot.joint_names, q, strict=True):
        joint = model.joints[model.getJointId(name)]
        if joint.nq == 2:  # a continuous joint, which Pinocchio stores as cosine and sine
            whole[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            whole[joint.idx_q] = value
    pinocchio.framesForwardKinematics(model, data, whole)
    flange = ET.fromstring(files["config/NAME.srdf"]).find("end_effector").get("parent_link")
    for name, pose in robot.flange_from_frame.items():
        if name != "FLANGE":
            found = data.oMf[model.getFrameId(flange)].inverse() * data.oMf[model.getFrameId(name.lower())]
            np.testing.assert_allclose(found.homogeneous, pose, atol=1e-9)


def test_a_capsule_becomes_bodies_of_the_same_room(tmp_path):
    robot = with_tool(tmp_path)
    root = ET.fromstring(exported(robot)["urdf/NAME.urdf"])
    tool = next(one for one in root.iter("link") if one.get("name") == "gripper")
    bodies = tool.findall("collision")
    assert [one.find("geometry")[0].tag for one in bodies] == ["cylinder", "sphere", "sphere"]
    places = [np.array(one.find("origin").get("xyz").split(), dtype=float) for one in bodies]
    middle = robot.flange_from_frame["TCP"][:3, 3] + [0, 0, -0.2]
    aside = np.array([0.03, 0.0, 0.0])
    np.testing.assert_allclose(places, [middle, middle - aside, middle + aside], atol=1e-12)
    # each capsule of a link becomes three bodies, too
    links = {one.get("name"): one for one in root.iter("link")}
    said = ET.parse(robot.folder / robot.urdf).getroot()
    for link in said.iter("link"):
        count = sum(3 if one.find("geometry/capsule") is not None else 1 for one in link.findall("collision"))
        assert len(links[link.get("name")].findall("collision")) == count


def test_meshes_go_with_it(tmp_path):
    robot = with_tool(tmp_path, "")
    folder = robot.folder
    mesh = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0\nendloop\nendfacet\nendsolid a\n"  # noqa: E501
    (folder / "meshes").mkdir()
    (folder / "meshes" / "a.stl").write_bytes(mesh)
    (folder / "meshes" / "ö b.stl").write_bytes(mesh)
    urdf = (folder / robot.urdf).read_text()
    visuals = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        for name in ("meshes/a.stl", "meshes/ö b.stl", "meshes/none.stl")
    )
    (folder / robot.urdf).write_text(urdf.replace('<link name="link_1">', f'<link name="link_1">{visuals}'))
    robot = load_robot(str(folder)).value
    result = package_of(robot)
    assert codes(result.diagnostics) == ["Y1537"]
    assert "none.stl" in result.diagnostics[0].message
    files = result.value.files
    root = ET.fromstring(files["urdf/industrial6.urdf"].decode())
    names = [one.get("filename") for one in root.iter("mesh")]
    assert names[0] == "package://industrial6_moveit_config/urdf/meshes/a.stl"
    for name in names[:2]:
        assert name.isascii()
        assert files[name.removeprefix("package://industrial6_moveit_config/")] == mesh


def test_names_that_ros_does_not_take_are_refused(tmp_path):
    robot = with_tool(tmp_path, "")
    for file in (robot.urdf, "robot.toml"):
        path = robot.folder / file
        path.write_text(
            path.read_text().replace('name="J2"', 'name="J-2.a"').replace("[joints.J2]", '[joints."J-2.a"]')
        )
    renamed = load_robot(str(robot.folder)).value
    result = package_of(renamed)
    assert result.value is None
    assert codes(result.diagnostics) == ["Y1534"]
    assert "J-2.a" in result.diagnostics[0].message


def test_motors_that_hold_joints_back_are_told(tmp_path):
    robot = with_tool(tmp_path, "")
    path = robot.folder / "robot.toml"
    path.write_text(path.read_text().replace("1550, 3520,", "1550, 2640,"))
    result = package_of(load_robot(str(robot.folder)).value)
    assert codes(result.diagnostics) == ["Y1535"]
    assert "motor 3 allows J2, J3 together only 75.1 % of their speed limits" in result.diagnostics[0].message
    assert result.value is not None


@pytest.fixture
def there(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path / "industrial6_moveit_config"


def run(*arguments):
    return CliRunner().invoke(main, ["export", "--moveit", "--robot", "INDUSTRIAL6", *arguments])


def everything(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_what_an_export_has_written_it_writes_again(there):
    assert run().exit_code == 0
    before = everything(there)
    (there / "config" / "mine.yaml").write_text("mine")
    assert run().exit_code == 0
    assert everything(there) == {**before, there / "config" / "mine.yaml": b"mine"}


def test_what_is_not_its_own_it_leaves(there):
    there.mkdir()
    (there / "package.xml").write_text("mine")
    made = run()
    assert made.exit_code == 1
    assert "error Y1536: industrial6_moveit_config: package.xml was not written by an export" in made.stderr
    assert everything(there) == {there / "package.xml": b"mine"}
    assert run("--overwrite").exit_code == 0
    path = there / "config" / "kinematics.yaml"
    path.write_text("another solver")
    made = run()
    assert (made.exit_code, "config/kinematics.yaml was changed since" in made.stderr) == (1, True)
    assert path.read_text() == "another solver"


def test_a_link_that_leads_nowhere_is_not_written_through(there):
    there.mkdir()
    (there / "package.xml").symlink_to(there.parent / "elsewhere")
    made = run()
    assert (made.exit_code, "package.xml was not written by an export" in made.stderr) == (1, True)
    assert not (there.parent / "elsewhere").exists()


def test_a_comment_behind_the_end_and_a_wrong_encoding(tmp_path):
    robot = with_tool(tmp_path, "")
    path = robot.folder / robot.urdf
    text = path.read_text()
    assert text.startswith('<?xml version="1.0"')
    text = (
        '<?xml version="1.0" encoding="latin-1"?>\n<!-- é -->'
        + text.partition("?>")[2]
        + "<!-- </robot> -->\n"
    )
    path.write_text(text)
    files = exported(load_robot(str(robot.folder)).value)
    root = ET.fromstring(files["urdf/NAME.urdf"].encode())
    assert "tcp" in {one.get("name") for one in root.iter("link")}


def test_what_it_does_not_write_any_more_goes(there):
    assert run().exit_code == 0
    before = everything(there)
    old = there / "urdf" / "old.stl"
    old.write_bytes(b"old")
    kept = there / "urdf" / "kept.stl"
    kept.write_bytes(b"changed")
    import hashlib
    import json

    path = there / "yarc-export.json"
    said = json.loads(path.read_text())
    said["files"]["urdf/old.stl"] = hashlib.sha256(b"old").hexdigest()
    said["files"]["urdf/kept.stl"] = hashlib.sha256(b"before").hexdigest()
    said["files"]["../outside"] = hashlib.sha256(b"out").hexdigest()
    (there.parent / "outside").write_bytes(b"out")
    path.write_text(json.dumps(said))
    assert run().exit_code == 0
    assert everything(there) == {**before, kept: b"changed"}
    assert (there.parent / "outside").exists()


@pytest.mark.parametrize("said", ["", "[]", '{"files": 3}', "[" * 100000, "\x00"])
def test_a_damaged_list_makes_all_files_foreign(there, said):
    assert run().exit_code == 0
    (there / "yarc-export.json").write_text(said)
    assert run().exit_code == 1
    assert run("--overwrite").exit_code == 0
    assert run().exit_code == 0


def test_folders_that_cannot_be_written(there):
    there.write_text("a file")
    made = run()
    assert (made.exit_code, "isn't a folder" in made.stderr) == (1, True)
    made = run("-o", "/proc/there")
    assert (made.exit_code, "Y0107" in made.stderr) == (1, True)
    made = run("-o", str(there / "inside"))
    assert (made.exit_code, "can't be written" in made.stderr) == (1, True)
    made = run("-o", "x" * 300)
    assert (made.exit_code, "file name too long" in made.stderr) == (1, True)
    odd = there.parent / "odd"
    (odd / "package.xml").mkdir(parents=True)
    assert "package.xml isn't a regular file" in run("-o", str(odd)).stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no such device")  # noqa: PTH110
def test_a_full_disk_is_told(there, monkeypatch):
    def full(path, data):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("yarclang.export.folder.replace_file", full)
    made = run()
    assert (made.exit_code, "no space left on device" in made.stderr) == (1, True)


def test_meshes_with_one_name_have_files_of_their_own(tmp_path):
    """A mesh outside the robot's folder doesn't replace the robot's own mesh of that name in any order."""
    beside, own = tmp_path / "shared" / "foo.stl", tmp_path / "robot" / "meshes" / "foo.stl"
    for path in (beside, own):
        path.parent.mkdir(parents=True)
        path.write_bytes(path.parent.name.encode())
    for order in ((beside, own), (own, beside)):
        meshes = PackageMeshes(SimpleNamespace(folder=tmp_path / "robot"), "arm")
        urls = [meshes.url_of(path) for path in order]
        assert len(set(urls)) == 2
        for path, url in zip(order, urls, strict=True):
            assert meshes.files[url.removeprefix("package://arm/")] == path.read_bytes()
