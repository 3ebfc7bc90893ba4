"""Tests of the HOME that `yarc robot new` proposes: away from singularities and limits, and free of
collisions according to Pinocchio, which reads the original URDF.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from programs import compiled

from tests.robot.made_arms import DATA, REAL, made, yarc
from tests.robot.trap_arms import arm, robot, written
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.kinematics.search import within
from yarclang.robot.new.home import STANDS, standing

ARMS = {"ur5": "base_link", "panda": "panda_link0"}
"""An arm of six joints and one of seven, each with the link to which balls are fixed."""


def blocked(name: str, places, radius: float = 0.12) -> str:
    """Return the URDF with balls at places (K, 3) [m], fixed to the base."""
    text = (DATA / REAL[name][0]).read_text(encoding="utf-8")
    text = text.replace("package://example-robot-data/robots", str(DATA))
    balls = "".join(
        f'<link name="ball{number}"><collision><geometry><sphere '
        f'radius="{radius}"/></geometry></collision></link><joint name="to_ball{number}" '
        f'type="fixed"><parent link="{ARMS[name]}"/><child link="ball{number}"/><origin '
        f'xyz="{" ".join(map(str, place))}"/></joint>'
        for number, place in enumerate(places)
    )
    return text.replace("</robot>", balls + "</robot>")


def balls_that_are_hit(text: str, robot, q) -> list[str]:
    """Return the balls that a link touches, by Pinocchio's geometry of the URDF."""
    model = pin.buildModelFromXML(text)
    geometry = pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    state, pairs = model.createData(), geometry.createData()
    full = pin.neutral(model)
    for joint, value in zip(robot.joint_names, q, strict=True):
        full[model.joints[model.getJointId(joint)].idx_q] = value
    pin.computeCollisions(model, state, geometry, pairs, full, False)
    names = [one.name for one in geometry.geometryObjects]
    hit = [
        (names[pair.first], names[pair.second])
        for pair, found in zip(geometry.collisionPairs, pairs.collisionResults, strict=True)
        if found.isCollision()
    ]
    return [pair for pair in hit if sum(one.startswith("ball") for one in pair) == 1]


def smallest(text: str, robot, tip: str, rows) -> np.ndarray:
    """Return the smallest singular values (N,) of the Jacobian of `tip`, with lengths in m, by Pinocchio."""
    model = pin.buildModelFromXML(text)
    state = model.createData()
    joints = [model.joints[model.getJointId(name)] for name in robot.joint_names]
    frame = model.getFrameId(tip, pin.FrameType.BODY)
    found = []
    for row in rows:
        full = pin.neutral(model)
        for joint, value in zip(joints, row, strict=True):
            full[joint.idx_q] = value
        jacobian = pin.computeFrameJacobian(model, state, full, frame, pin.LOCAL_WORLD_ALIGNED)
        found.append(np.linalg.svd(jacobian[:, [joint.idx_v for joint in joints]], compute_uv=False)[5])
    return np.array(found)


@pytest.mark.parametrize("name", ARMS)
def test_home_moves_out_of_what_is_fixed_to_the_base(name, tmp_path):
    """A ball is placed at the flange of the proposed HOME, then a second one at the flange of the next
    proposed HOME.
    """
    tip = {"ur5": "tool0", "panda": "panda_link8"}[name]
    places: list[list[float]] = []
    before: list[list[float]] = []
    for number in range(3):
        text = blocked(name, places)
        file = tmp_path / f"{number}.urdf"
        file.write_text(text, encoding="utf-8")
        folder = tmp_path / f"r{number}"
        robot = made(file, folder, "--meshes", DATA)
        home = robot.home
        assert not balls_that_are_hit(text, robot, home)
        assert home.tolist() not in before
        for other in before:
            assert balls_that_are_hit(text, robot, other)
        # Compared with random positions of the arm, HOME is well conditioned and far from limits.
        values = smallest(text, robot, tip, [home, *within(robot.chain, robot.limits, 300)])
        assert values[0] >= np.median(values[1:]) * 0.6
        room = np.minimum(home - robot.limits.lower, robot.limits.upper - home)
        assert (room >= 0.05 * (robot.limits.upper - robot.limits.lower)).all()
        line = next(one for one in (folder / "robot.toml").read_text().splitlines() if one.startswith("HOME"))
        assert "no links touch there" in line or not places
        assert "singularit" in line
        before.append(home.tolist())
        places.append([round(float(value), 6) for value in flange_poses(robot.chain, home[None])[0, :3, 3]])


def test_no_free_home_is_said(tmp_path):
    """If a ball surrounds the whole arm except the links of its foot, the message says that no HOME
    is free.
    """
    file = tmp_path / "a.urdf"
    file.write_text(blocked("ur5", [[0.0, 0.0, 1.35]], radius=1.3), encoding="utf-8")
    given = ("--home", "0,-90,0,0,0,0", "--meshes", DATA)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "given", *given)
    assert result.exit_code == 0, result.output
    assert "note: in HOME " in result.output
    assert "choose another with --home" in result.output
    assert "positions that were tried" not in result.output
    home = load_robot(str(tmp_path / "given")).value
    assert (home.home / home.axis_units).tolist() == pytest.approx(
        [0, -90, 0, 0, 0, 0]
    )  # a given HOME isn't changed


MASS = '<inertial><mass value="50"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def heavy(effort: float) -> str:
    """Return an arm with 50 kg in each link. When it is stretched, its second and third joints hold 1,220 N
    m.
    """
    return robot(arm(effort=effort)).replace("<collision>", f"{MASS}<collision>")


def test_home_is_held_by_the_efforts_where_some_position_is(tmp_path):
    strong = made(written(tmp_path, heavy(5000)), tmp_path / "strong")
    assert standing(strong, strong.home[None]).max() > 0.2  # this HOME needs more than 900 N m
    weak = made(written(tmp_path, heavy(1000)), tmp_path / "weak")
    assert standing(weak, weak.home[None]).max() <= STANDS
    assert standing(weak, strong.home[None]).max() > STANDS
    result, diagnostics = compiled("P0010 DMOVEJ 1 1 1 1 1 1 [5] (deg,mm,s)\n", str(tmp_path / "weak"))
    assert result is not None, diagnostics


def test_efforts_that_hold_no_position_are_named(tmp_path):
    result = yarc("robot", "new", written(tmp_path, heavy(40)), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0
    assert "of its effort to stand, so that motions are refused" in " ".join(result.output.split())
    assert "checked = false" in result.output
    given = yarc(
        "robot", "new", written(tmp_path, heavy(1000)), "--yes", "--home", "0,0,0,0,0,0", "-o", tmp_path / "s"
    )
    assert "joint_3 needs 122% of its effort" in given.output or "joint_2 needs 122%" in given.output


def test_masses_that_are_not_known_leave_home_as_it_is(tmp_path):
    light = made(written(tmp_path, robot(arm(effort=5))), tmp_path / "r")
    assert not standing(light, light.home[None]).any()
