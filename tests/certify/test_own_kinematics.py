"""Tests of the judge's own kinematics: they agree with Pinocchio, and find errors in code that planner and
judge shared before.
"""

import re
import shutil
import tomllib
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

import yarclang
from yarclang.cell import measures
from yarclang.certify.kinematics import arm, motors, rotations
from yarclang.certify.kinematics import pinocchio as witness
from yarclang.certify.kinematics.described import ContradictionError, own_robot
from yarclang.collision import placing
from yarclang.collision.zones import watched
from yarclang.motion import limits
from yarclang.robot import actuation, description, dynamics, link_shapes
from yarclang.robot import tools as robot_tools
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import elbow, fk
from yarclang.robot.kinematics.geometry import form_of
from yarclang.robot.library import stdlib_folder
from yarclang.semantics.values import poses as program_poses
from yarclang.shapes import Box, Capsule, Cylinder, Sphere
from yarclang.transforms import rpy_rotation

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")
angles = st.floats(-3.2, 3.2)


def _robot(name="INDUSTRIAL6"):
    robot = load_robot(name).value
    assert robot is not None
    return robot


@pytest.mark.parametrize("name", ROBOTS)
def test_poses_jacobians_and_placements_are_pinocchios(name):
    robot = _robot(name)
    own = own_robot(robot)
    rng = np.random.default_rng(5)
    q = rng.uniform(-2.0, 2.0, (2500, robot.size))
    tool = rotations.of_numbers(np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6]))
    poses, jacobians = arm.poses_and_jacobians(own.chain, q, tool)
    other, others = fk.poses_and_jacobians(robot.chain, q, tool)
    np.testing.assert_allclose(poses, other, atol=1e-13)
    np.testing.assert_allclose(jacobians, others, atol=1e-13)
    model = pin.buildModelFromXML(robot.written.urdf)
    data = model.createData()
    chosen = [model.joints[model.getJointId(joint)] for joint in robot.joint_names]
    placed = arm.KINEMATICS.placements(own.chain, q[:50])
    for row in range(50):
        full = pin.neutral(model)
        for joint, value in zip(chosen, q[row], strict=True):
            full[joint.idx_q : joint.idx_q + joint.nq] = (
                [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
            )
        pin.framesForwardKinematics(model, data, full)
        base = data.oMf[model.getFrameId(_end(robot, "base"))]
        flange = data.oMf[model.getFrameId(_end(robot, "flange"))]
        np.testing.assert_allclose(
            (base.inverse() * flange).homogeneous,
            arm.flange_poses(own.chain, q[row : row + 1])[0],
            atol=1e-12,
        )
        moved = np.vstack([placed[-1, :, :, row], [0, 0, 0, 1]]) @ own.chain.base_from_flange
        np.testing.assert_allclose(moved, arm.flange_poses(own.chain, q[row : row + 1])[0], atol=1e-12)


def _end(robot, key):
    return tomllib.loads(robot.written.toml)[key]


@pytest.mark.parametrize("name", ROBOTS)
def test_what_is_read_is_what_the_planner_reads(name):
    robot = _robot(name)
    own = own_robot(robot)
    np.testing.assert_allclose(own.chain.screws, robot.chain.screws, atol=1e-12)
    np.testing.assert_allclose(own.chain.base_from_flange, robot.chain.base_from_flange, atol=1e-12)
    for name_ in robot.flange_from_frame:
        np.testing.assert_allclose(own.flange_from_frame[name_], robot.flange_from_frame[name_], atol=1e-12)
    for key in ("lower", "upper", "velocity", "acceleration", "jerk", "stop_acceleration"):
        np.testing.assert_allclose(getattr(own.limits, key), getattr(robot.limits, key), rtol=1e-15)
    for key in ("gear", "coupling", "offset", "velocity"):
        np.testing.assert_array_equal(getattr(own.actuation, key), getattr(robot.actuation, key))
    for one, other in zip(own.shapes, robot.shapes, strict=True):
        assert (one.link, one.joint) == (other.link, other.joint)
        np.testing.assert_allclose(one.base_from_shape, other.base_from_shape, atol=1e-12)
    for one, other in zip(own.tools, robot.tools, strict=True):
        assert one.mass == other.mass
        np.testing.assert_allclose(one.center, other.center, atol=1e-12)
        np.testing.assert_allclose(one.inertia, other.inertia, atol=1e-12)
        for part, known in zip(one.shapes, other.shapes, strict=True):
            np.testing.assert_allclose(part.flange_from_shape, known.flange_from_shape, atol=1e-12)
    np.testing.assert_allclose(motors.counts_per_joint(own), actuation.counts_per_joint(robot), rtol=1e-14)
    np.testing.assert_allclose(motors.joints_per_count(own), actuation.joints_per_count(robot), rtol=1e-12)
    if robot.dynamics is not None:
        np.testing.assert_allclose(own.dynamics.effort, robot.dynamics.effort)
        np.testing.assert_allclose(own.dynamics.gravity, robot.dynamics.gravity)
    found, known = arm.KINEMATICS.elbow(own.chain), elbow.elbow_of(robot.chain)
    assert (found is None) == (known is None)
    if found is not None and known is not None:
        assert found[0] == known.joint
        np.testing.assert_allclose(found[1], known.point, atol=1e-12)


@given(angles, angles, angles)
def test_roll_pitch_yaw_is_pinocchios(roll, pitch, yaw):
    made = rotations.of_roll_pitch_yaw(np.array([roll, pitch, yaw]))
    np.testing.assert_allclose(made, pin.rpy.rpyToMatrix(roll, pitch, yaw), atol=1e-14)
    quaternion = pin.Quaternion(made)
    again = rotations.of_quaternion(3.0 * np.array([quaternion.x, quaternion.y, quaternion.z, quaternion.w]))
    np.testing.assert_allclose(again, made, atol=1e-13)


def test_another_arm_than_its_texts_is_refused():
    robot = _robot()
    written = replace(robot.written, urdf=robot.written.urdf.replace('name="J3"', 'name="J9"'))
    with pytest.raises(ContradictionError):
        own_robot(replace(robot, written=written))


# with an error in the planner's kinematics or in the judge's, no text is written

PROGRAM = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ 20 -10 -30 40 50 60 [6]
P0020 MOVEJ_RPY 100 1074.4 1276 10 20 -15 [9]
P0030 MOVEL 200 974.4 1226 10 -5 20 [6]
P0040 DMOVE 0 0 -50 5 10 15 [3]
"""
MASSES = (
    "<inertial><origin xyz='0.01 0.02 0.1'/><mass value='12'/><inertia ixx='0.2' iyy='0.3' izz='0.25' "
    "ixy='0.01' ixz='0' iyz='0.02'/></inertial>"
)


@pytest.fixture
def arms(tmp_path):
    """Return a function that makes a separate folder for each compilation, so that nothing of the robot is
    cached.
    """
    made = []

    def new(*, weighed=False):
        folder = tmp_path / f"arm{len(made)}"
        made.append(folder)
        shutil.copytree(stdlib_folder() / "robots" / "industrial6", folder)
        if weighed:
            urdf = folder / "industrial6.urdf"
            urdf.write_text(re.sub(r'(<link name="link_[1-6]">)', rf"\1{MASSES}", urdf.read_text()))
        return folder

    return new


def _compiled(arms, text=PROGRAM, cell=None, *, weighed=False):
    folder = arms(weighed=weighed)
    if cell is not None:
        (folder / "cell.toml").write_text(cell)
    return yarclang.compile(
        text, robot=str(folder / "robot.toml"), folder=folder, cell=folder / "cell.toml" if cell else None
    )


def _codes(made):
    return {one.code for one in made.diagnostics if one.severity == "error"}


def test_without_an_error_all_are_written(arms):
    for weighed in (False, True):
        made = _compiled(arms, weighed=weighed)
        assert made.ok, made.diagnostics


def _longer(walk):
    def longer(chain, q, flange_from_tool):
        shifted = flange_from_tool.copy()
        shifted[1, 3] += 1e-3
        return walk(chain, q, shifted)

    return longer


WALKS = {
    "joints by a thousandth": lambda walk: lambda chain, q, tool: walk(chain, q * 1.001, tool),
    "the last link 1 mm longer": _longer,
    "a joint backwards": lambda walk: (
        lambda chain, q, tool: walk(chain, q * np.array([[1], [1], [1], [1], [1], [-1]]), tool)
    ),
}


@pytest.mark.parametrize("name", WALKS)
def test_a_wrong_forward_kinematics_is_refused(name, arms, monkeypatch):
    """With wrong forward kinematics, nothing is written, whether or not the planner notices that its parts
    disagree.
    """
    monkeypatch.setattr(fk, "walk", WALKS[name](fk.walk))
    assert not _compiled(arms).ok


def _reversed(chain):
    return replace(chain, screws=chain.screws * np.array([[1], [1], [1], [1], [-1], [1]]))


def _lengthened(chain):
    flange = chain.base_from_flange.copy()
    flange[1, 3] += 1e-3
    return replace(chain, base_from_flange=flange)


def _tilted(chain):
    screws = chain.screws.copy()
    screws[3, 3:] += [1e-3, 0.0, 0.0]
    return replace(chain, screws=screws)


@pytest.mark.parametrize("wrong", [_reversed, _lengthened, _tilted])
def test_an_arm_that_was_read_wrongly_is_refused(wrong, arms, monkeypatch):
    """The whole planner uses a wrong arm, consistently. Only the judge has the right one."""
    right = description.screws
    monkeypatch.setattr(description, "screws", lambda *given: wrong(right(*given)))
    assert _codes(_compiled(arms)) & {"Y1159", "Y1160", "Y1161"}


def _swapped(rpy):
    return rpy_rotation(np.asarray(rpy)[::-1])


def test_swapped_roll_and_yaw_are_refused(arms, monkeypatch):
    for module in (program_poses, measures, robot_tools, link_shapes):
        monkeypatch.setattr(module, "rpy_rotation", _swapped)
    program_poses._rpy_rotation.cache_clear()
    made = _compiled(arms)
    program_poses._rpy_rotation.cache_clear()
    assert "Y1161" in _codes(made)


WALL = """units = "mm,deg"
[[obstacles]]
name = "WALL"
frame = "B"
shape = "box"
size = [200, 200, 200]
xyz = [0, 1250, 1176]
rpy = [0, 0, 35]
"""


def test_a_cell_that_was_read_wrongly_is_refused(arms, monkeypatch):
    text = "P0010 MOVEJ 90 0 0 0 0 0 [6] (deg,s)\n"
    assert "Y1161" not in _codes(_compiled(arms, text, WALL))
    monkeypatch.setattr(measures, "rpy_rotation", _swapped)
    assert "Y1161" in _codes(_compiled(arms, text, WALL))


def test_wrong_placements_of_the_planner_hide_no_collision(arms, monkeypatch):
    """A wall is in the path of the flange, but the planner's placements turn in the other direction."""
    text = "P0010 MOVEJ 40 0 0 0 0 0 [6] (deg,s)\nP0020 MOVEJ 60 0 0 0 0 0 [6] (deg,s)\n"
    wall = WALL.replace("0, 1250, 1176", "-800, 680, 1764")
    assert _codes(_compiled(arms, text, wall)) & {"Y0901", "Y0903"}
    right = placing.placements
    monkeypatch.setattr(placing, "placements", lambda screws, q: right(screws, -q))
    assert _codes(_compiled(arms, text, wall)) & {"Y0901", "Y0903"}


def _thinner(shape):
    match shape:
        case Box(size=size):
            return Box(size * 0.2)
        case Cylinder(radius=radius, length=length):
            return Cylinder(0.2 * radius, length)
        case Capsule(radius=radius, length=length):
            return Capsule(0.2 * radius, length)
        case Sphere(radius=radius):
            return Sphere(0.2 * radius)
        case _:
            return shape


def test_wrong_sizes_of_links_hide_no_collision(arms, monkeypatch):
    """The planner and all other users of shapes get links that are too thin; only the judge has the right
    ones.
    """
    text = "P0010 MOVEJ 42 0 0 0 0 0 [6] (deg,s)\n"
    wall = WALL.replace("0, 1250, 1176", "-800, 680, 1764")
    assert _codes(_compiled(arms, text, wall)) & {"Y0901", "Y0903"}
    right = link_shapes.shape_of
    monkeypatch.setattr(link_shapes, "shape_of", lambda *given: _thinner(right(*given)))
    assert _codes(_compiled(arms, text, wall)) & {"Y0901", "Y0903"}


def test_a_wrong_elbow_of_the_planner_hides_no_breach(arms, monkeypatch):
    zone = """units = "mm,deg"
[[zones]]
name = "ROOM"
rule = "forbidden"
watch = ["elbow"]
frame = "B"
shape = "box"
size = [400, 400, 400]
xyz = [0, 200, 1569]
"""
    text = "P0010 MOVEJ 20 0 0 0 0 0 [6] (deg,s)\n"
    assert "Y0908" in _codes(_compiled(arms, text, zone))
    monkeypatch.setattr(watched, "elbow_of", lambda chain: None)
    assert "Y0908" in _codes(_compiled(arms, text, zone))


def test_wrong_counts_of_the_planner_break_no_motor_limit(arms, monkeypatch):
    text = "P0010 MOVEJ 0 40 40 0 0 0 [MIN] (deg,s)\n"
    assert _compiled(arms, text).ok
    monkeypatch.setattr(limits, "counts_per_joint", lambda robot: actuation.counts_per_joint(robot) * 0.4)
    folder = arms()
    toml = folder / "robot.toml"
    toml.write_text(
        toml.read_text().replace("velocity = [1540, 1550, 3520,", "velocity = [1540, 1550, 1760,")
    )
    made = yarclang.compile(text, robot=str(toml), folder=folder)
    assert "Y1158" in _codes(made)


def test_wrong_torques_are_refused(arms, monkeypatch):
    right = dynamics._torques
    for wrong in (
        lambda *given: right(*given) * 1.001,
        lambda chain, masses, q, v, a: right(chain, masses, q, v, 0.0 * a),
    ):
        monkeypatch.setattr(dynamics, "_torques", wrong)
        assert "Y1194" in _codes(_compiled(arms, weighed=True))


def test_a_lost_mass_is_refused(arms, monkeypatch):
    """The masses of the robot's reader are compared with those that Pinocchio reads."""
    right = description.dynamics_of
    monkeypatch.setattr(
        description, "dynamics_of", lambda *given: replace(right(*given), mass=0.9 * right(*given).mass)
    )
    assert "Y1194" in _codes(_compiled(arms, weighed=True))


def test_a_link_without_mass_keeps_its_inertia(arms):
    """CAD exports contain links without a mass but with an inertia. Pinocchio counts the inertia, and so do
    we.
    """
    folder = arms(weighed=True)
    urdf = folder / "industrial6.urdf"
    turned = MASSES.replace("<mass value='12'/>", "<mass value='0'/>")
    urdf.write_text(urdf.read_text().replace('<link name="flange"/>', f'<link name="flange">{turned}</link>'))
    made = yarclang.compile(PROGRAM, robot=str(folder / "robot.toml"), folder=folder)
    assert made.ok, made.diagnostics


FAR = """<link name="world"/>
<joint name="far" type="fixed"><parent link="world"/><child link="base_link"/>
<origin xyz="{0}.123 -{0}.456 3.1" rpy="0.1 0.2 0.3"/></joint>
<link name="base_link">"""


@pytest.mark.parametrize("metres", [10, 100, 1000])
@pytest.mark.parametrize("base", ["base_link", "world"])
def test_an_arm_far_from_its_root_keeps_its_closed_form(arms, metres, base):
    """The URDF's root and {B} are far away, for example at a hall's origin. Rounding must not be taken for a
    sliding joint.
    """
    folder = arms()
    urdf, toml = folder / "industrial6.urdf", folder / "robot.toml"
    urdf.write_text(urdf.read_text().replace('<link name="base_link">', FAR.format(metres)))
    toml.write_text(toml.read_text().replace('base = "base_link"', f'base = "{base}"'))
    robot = load_robot(str(folder)).value
    assert robot is not None
    assert not fk.links_of(robot.chain).slide.any()
    assert not arm.axes_of(own_robot(robot).chain).slide.any()
    assert form_of(robot.chain) is not None
    text = re.sub(r"P0020.*\nP0030.*\n", "", PROGRAM)
    made = yarclang.compile(text, robot=str(toml), folder=folder)
    assert made.ok, made.diagnostics


def test_an_error_of_the_judges_own_kinematics_is_refused(arms, monkeypatch):
    right = arm._hinged
    monkeypatch.setattr(arm, "_hinged", lambda chain, q: right(chain, q * 1.001))
    assert "Y1194" in _codes(_compiled(arms))


def test_pinocchio_is_asked_of_every_motion(arms, monkeypatch):
    asked = []
    right = witness._asked
    monkeypatch.setattr(
        witness, "_asked", lambda *given, **named: asked.append(given) or right(*given, **named)
    )
    assert _compiled(arms).ok
    assert len(asked) == 1 + 2 * 4 + 1  # at zero, twice for each motion, and at the end


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("<robot ", '<robot xmlns="http://drake.mit.edu" '),
        ("</robot>", '<gazebo><sensor:camera name="x"/></gazebo></robot>'),
        *(
            ("", f'<?xml version="1.0" encoding="{code}"?><!-- Länge -->')
            for code in ("UTF8", "ascii", "gb2312", "utf-16", "foo")
        ),
    ],
)
def test_the_judge_reads_whatever_form_readers_of_urdf_read(arms, old, new):
    """The judge reads a URDF with namespaces or a declared encoding, like other readers."""
    folder = arms()
    urdf = folder / "industrial6.urdf"
    text = re.sub(r"<\?xml.*?\?>\s*", "", urdf.read_text())
    assert old in text
    urdf.write_text(text.replace(old, new, 1))
    made = yarclang.compile(PROGRAM, robot=str(folder / "robot.toml"), folder=folder)
    assert made.ok, made.diagnostics
