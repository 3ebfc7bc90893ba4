"""Tests of torques: many instants at once give Pinocchio's torques; masses and efforts come from the URDF,
tools and robot.toml.
"""

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.collision.test_bodies import changed
from tests.robot.heavy_chains import heavy, tool
from tests.robot.made_arms import DATA, REAL, made
from yarclang.cli.yarc import main
from yarclang.robot.description import load_robot
from yarclang.robot.dynamics import BLOCK, holding_torques, torques

SEEDS = st.integers(0, 2**32 - 1)


def moved(arm, seed, count=4):
    random = np.random.default_rng(seed)
    return random.uniform(-1, 1, (3, count, arm.size)) * np.array([3.0, 4.0, 20.0])[:, None, None]


@settings(max_examples=120, deadline=None)
@given(SEEDS, st.integers(1, 9))
def test_torques_are_pinocchios(seed, size):
    arm = heavy(seed, size)
    q, v, a = moved(arm, seed)
    theirs = arm.rnea(q, v, a)
    assert torques(arm.chain, arm.dynamics, q, v, a) == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())
    still = np.zeros_like(q)
    assert holding_torques(arm.chain, arm.dynamics, q) == pytest.approx(
        arm.rnea(q, still, still), abs=1e-9 * np.abs(theirs).max()
    )


@settings(max_examples=30, deadline=None)
@given(SEEDS, st.integers(1, 7))
def test_tools_and_gravity_are_in_them(seed, size):
    arm = heavy(seed, size, (tool(), tool(9.0, mounted=False)), gravity=[3.0, -9.0, 1.0])
    q, v, a = moved(arm, seed)
    theirs = arm.rnea(q, v, a)
    assert torques(arm.chain, arm.dynamics, q, v, a) == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())


def test_more_than_a_block():
    arm = heavy(1, 6)
    q, v, a = moved(arm, 2, BLOCK + 3)
    whole = torques(arm.chain, arm.dynamics, q, v, a)
    assert whole[-3:] == pytest.approx(torques(arm.chain, arm.dynamics, q[-3:], v[-3:], a[-3:]))
    assert torques(arm.chain, arm.dynamics, q[:0], v[:0], a[:0]).shape == (0, 6)


def test_efforts():
    arm = heavy(5, 3, efforts=[None, 7.0, None])
    assert arm.dynamics.effort[1] == 7.0
    assert np.isfinite(arm.dynamics.effort).all()
    assert arm.dynamics.is_checked


@pytest.mark.parametrize("name", ["ur5", "panda", "kinova", "z1"])
def test_real_arms(tmp_path, name):
    import pinocchio as pin

    robot = made(DATA / REAL[name][0], tmp_path / "a", *REAL[name][1])
    model = pin.buildModelFromUrdf(str(robot.folder / robot.urdf))
    data = model.createData()
    joints = [model.joints[model.getJointId(one)] for one in robot.joint_names]
    q, v, a = np.random.default_rng(0).normal(size=(3, 20, robot.size))
    ours = torques(robot.chain, robot.dynamics, q, v, a)
    for row in range(20):
        full, rate, change = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for at, joint in enumerate(joints):
            angle = q[row, at]
            full[joint.idx_q : joint.idx_q + joint.nq] = (
                angle if joint.nq == 1 else (np.cos(angle), np.sin(angle))
            )
            rate[joint.idx_v], change[joint.idx_v] = v[row, at], a[row, at]
        theirs = pin.rnea(model, data, full, rate, change)[[joint.idx_v for joint in joints]]
        assert ours[row] == pytest.approx(theirs, abs=1e-9)


def test_what_the_files_say(tmp_path):
    """Masses are read from the URDF, an effort and the direction of gravity from robot.toml. Without masses,
    nothing is checked.
    """
    plain = load_robot("INDUSTRIAL6").value
    assert not plain.dynamics.is_checked
    assert plain.dynamics.effort == pytest.approx([2000, 2000, 1000, 200, 200, 100])
    told = CliRunner().invoke(main, ["robot", "check", "INDUSTRIAL6"]).output
    assert "torques aren't checked: the links moved by J1, J2, J3 and 3 more have no mass" in told
    folder = heavy_industrial6(tmp_path)
    robot = load_robot(folder).value
    assert robot.dynamics.is_checked
    assert robot.dynamics.mass == pytest.approx([10.0] * 6)
    assert robot.dynamics.effort == pytest.approx([50, 2000, 1000, 200, 200, 100])
    assert robot.dynamics.gravity == pytest.approx([0, 9.81, 0])
    told = CliRunner().invoke(main, ["robot", "check", folder]).output
    assert "torques" in told
    assert "aren't checked" not in told
    before = robot.fingerprint
    changed(tmp_path, ("effort = 50", "effort = 60"))
    assert load_robot(folder).value.fingerprint != before
    changed(tmp_path, ("[dynamics]", "[dynamics]\nchecked = false"))
    assert not load_robot(folder).value.dynamics.is_checked
    told = CliRunner().invoke(main, ["robot", "check", folder]).output
    assert "torques aren't checked: robot.toml says so" in told


def heavy_industrial6(tmp_path):
    """Give each link of INDUSTRIAL6 a mass of 10 kg."""
    mass = (
        '<inertial><mass value="10"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" '
        'iyz="0"/></inertial>'
    )
    changed(
        tmp_path,
        *[(f'<link name="link_{k}">', f'<link name="link_{k}">{mass}') for k in range(1, 7)],
        file="industrial6.urdf",
    )
    return changed(
        tmp_path,
        ("[joints.J1]", "[joints.J1]\neffort = 50"),
        ("[tolerance]", "[dynamics]\ngravity = [0, 9.81, 0]\n\n[tolerance]"),
    )


@pytest.mark.parametrize(
    ("before", "after", "code"),
    [
        ("effort = 50", "effort = 0", "Y1308"),
        ("[0, 9.81, 0]", "[0, 9.81]", "Y1309"),
        ("[0, 9.81, 0]", '"down"', "Y1306"),
        ("gravity", "gravitation", "Y1305"),
    ],
)
def test_mistakes(tmp_path, before, after, code):
    folder = heavy_industrial6(tmp_path)
    changed(tmp_path, (before, after))
    found = load_robot(folder)
    assert found.value is None
    assert [one.code for one in found.diagnostics] == [code]
