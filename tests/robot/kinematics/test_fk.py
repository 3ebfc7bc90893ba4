"""Tests of forward kinematics and Jacobians, by the paper's arm, finite differences and Pinocchio."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import flange_poses, poses_and_jacobians, reach_radii, tool_poses
from yarclang.robot.kinematics.fk import BLOCK, joint_transform
from yarclang.robot.model import Chain

DATA = Path(__file__).parents[2] / "conformance"
ALL = [arms.industrial6, arms.offset6, arms.skewed6, arms.scara4, arms.seven7, arms.planar3, arms.slider9]


def test_the_papers_poses():
    cases = json.loads((DATA / "industrial6_kinematics.json").read_text())["forward_kinematics"]
    chain, _ = arms.industrial6()
    poses = tool_poses(chain, np.radians([case["q_deg"] for case in cases]), arms.TCP)
    np.testing.assert_allclose(poses[:, :3, 3] * 1e3, [case["tcp_mm"] for case in cases], atol=2e-6)
    np.testing.assert_allclose(poses[:, :3, :3], [case["rotation"] for case in cases], atol=2e-9)


@pytest.mark.parametrize("arm", ALL)
def test_product_of_exponentials(arm):
    chain, _ = arm()
    q = np.random.default_rng(1).uniform(-3, 3, (7, chain.size))
    expected = np.broadcast_to(np.eye(4), (7, 4, 4))
    for joint, screw in enumerate(chain.screws):
        step = np.broadcast_to(np.eye(4), (7, 4, 4)).copy()
        step[:, :3, :3], step[:, :3, 3] = joint_transform(screw, q[:, joint])
        expected = expected @ step
    np.testing.assert_allclose(flange_poses(chain, q), expected @ chain.base_from_flange, atol=1e-13)


@pytest.mark.parametrize("arm", ALL)
def test_jacobian_against_finite_differences(arm):
    chain, _ = arm()
    q = np.random.default_rng(2).uniform(-2, 2, (5, chain.size))
    poses, jacobians = poses_and_jacobians(chain, q, arms.TCP)
    np.testing.assert_array_equal(poses, tool_poses(chain, q, arms.TCP))
    step = 1e-6
    for joint in range(chain.size):
        shift = step * np.eye(chain.size)[joint]
        after, before = tool_poses(chain, q + shift, arms.TCP), tool_poses(chain, q - shift, arms.TCP)
        linear = (after[:, :3, 3] - before[:, :3, 3]) / (2 * step)
        turn = Rotation.from_matrix(after[:, :3, :3] @ before[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
        np.testing.assert_allclose(jacobians[:, :3, joint], linear, atol=1e-8)
        np.testing.assert_allclose(jacobians[:, 3:, joint], turn / (2 * step), atol=1e-8)


def test_screws_of_any_length_and_pitch():
    """A joint may have other units than rad or m, and may be a screw joint."""
    chain, _ = arms.industrial6()
    screws = chain.screws.copy()
    screws[1] *= 0.5
    screws[4, :3] += 0.02 * screws[4, 3:]
    odd = Chain(arms.frozen(screws), chain.base_from_flange)
    q = np.random.default_rng(3).uniform(-2, 2, (4, 6))
    poses, jacobians = poses_and_jacobians(odd, q, np.eye(4))
    halved = q.copy()
    halved[:, 1] *= 0.5
    advanced = Chain(arms.frozen(np.vstack([chain.screws[:4], screws[4:]])), chain.base_from_flange)
    np.testing.assert_allclose(poses, flange_poses(advanced, halved), atol=1e-13)
    step = 1e-6 * np.eye(6)
    for joint in (1, 4):
        difference = flange_poses(odd, q + step[joint]) - flange_poses(odd, q - step[joint])
        np.testing.assert_allclose(jacobians[:, :3, joint], difference[:, :3, 3] / 2e-6, atol=1e-8)


def test_blocks_join():
    chain, _ = arms.industrial6()
    q = np.random.default_rng(4).uniform(-3, 3, (2 * BLOCK + 5, 6))
    poses, jacobians = poses_and_jacobians(chain, q, arms.TCP)
    for index in (0, BLOCK - 1, BLOCK, 2 * BLOCK + 4):
        one, jacobian = poses_and_jacobians(chain, q[index : index + 1], arms.TCP)
        np.testing.assert_allclose(poses[index], one[0], atol=1e-14)
        np.testing.assert_allclose(jacobians[index], jacobian[0], atol=1e-14)
    assert flange_poses(chain, q[:0]).shape == (0, 4, 4)


def test_against_pinocchio():
    pinocchio = pytest.importorskip("pinocchio")
    joints, parent = [], "l0"
    for index, (origin, axis) in enumerate(arms.JOINTS_SEED6, start=1):
        joints.append(
            f'<link name="l{index}"/><joint name="j{index}" type="revolute"><parent link="{parent}"/>'
            f'<child link="l{index}"/><origin xyz="{" ".join(map(str, origin))}"/>'
            f'<axis xyz="{" ".join(map(str, axis))}"/>'
            '<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>'
        )
        parent = f"l{index}"
    model = pinocchio.buildModelFromXML(f'<robot name="r"><link name="l0"/>{"".join(joints)}</robot>')
    data = model.createData()
    chain, _ = arms.industrial6()
    q = np.random.default_rng(5).uniform(-3, 3, (20, 6))
    poses, jacobians = poses_and_jacobians(chain, q, np.eye(4))
    frame = model.getFrameId("l6")
    for index in range(20):
        reference = pinocchio.LOCAL_WORLD_ALIGNED
        jacobian = pinocchio.computeFrameJacobian(model, data, q[index], frame, reference)
        pinocchio.framesForwardKinematics(model, data, q[index])
        np.testing.assert_allclose(poses[index], data.oMf[frame].homogeneous, atol=1e-13)
        np.testing.assert_allclose(jacobians[index], jacobian, atol=1e-13)


@pytest.mark.parametrize("arm", ALL)
def test_reach_radii_bound_the_lever(arm):
    chain, limits = arm()
    rng = np.random.default_rng(6)
    lower, upper = (
        np.where(chain.is_prismatic, limits.lower, -3.2),
        np.where(chain.is_prismatic, limits.upper, 3.2),
    )
    q = rng.uniform(lower, upper, (4000, chain.size))
    bounds = reach_radii(chain, limits, arms.TCP)
    _, jacobians = poses_and_jacobians(chain, q, arms.TCP)
    levers = np.linalg.norm(jacobians[:, :3], axis=1).max(axis=0)
    assert (levers <= bounds + 1e-12).all()
    # The bounds aren't much too large.
    assert (bounds <= 2.5 * levers + 1e-9).all()


def test_reach_radii_of_the_paper_arm():
    chain, limits = arms.industrial6()
    bounds = reach_radii(chain, limits, np.eye(4))
    np.testing.assert_allclose(bounds[3:], [0.238, 0.238, 0.0], atol=1e-12)
    np.testing.assert_allclose(bounds[2], np.hypot(0.195, 0.6364) + 0.238, atol=1e-12)
    np.testing.assert_allclose(bounds[1], 0.89 + bounds[2], atol=1e-12)
