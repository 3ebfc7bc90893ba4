"""Tests that a single joint position gives the same result as a batch of one, for turning and
sliding joints.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.kinematics.elimination import polished
from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.kinematics.numeric import pose_columns, pose_error
from yarclang.robot.kinematics.single import pose_with_jacobian, twist_between

ARMS = (arms.industrial6, arms.offset6, arms.skewed6, arms.scara4, arms.seven7, arms.planar3, arms.slider9)


@pytest.mark.parametrize("arm", ARMS)
def test_poses_jacobians_and_errors_are_those_of_batches(arm):
    chain, _ = arm()
    random = np.random.default_rng(0)
    for _ in range(100):
        q, other = random.uniform(-3.0, 3.0, (2, chain.size))
        pose, jacobian = pose_with_jacobian(chain, q)
        columns, true = walk_with_jacobian(chain, q[:, None], np.eye(4))
        np.testing.assert_allclose(pose[:3].T, columns[:, :, 0], atol=1e-13)
        np.testing.assert_allclose(pose, flange_poses(chain, q[None])[0], atol=1e-13)
        np.testing.assert_allclose(jacobian, true[:, :, 0], atol=1e-13)
        target = pose_with_jacobian(chain, other)[0]
        twist = twist_between(pose, target)
        np.testing.assert_allclose(twist, pose_error(columns, pose_columns(target[None]))[:, 0], atol=1e-9)


@pytest.mark.parametrize(
    "turn", [(0, 0, 0), (1e-12, 0, 0), (np.pi, 0, 0), (0, np.pi, 0), (0, 0, np.pi - 1e-10)]
)
def test_errors_of_no_turn_and_of_half_a_turn(turn):
    from scipy.spatial.transform import Rotation

    pose, target = np.eye(4), np.eye(4)
    target[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    batch = pose_error(pose_columns(pose[None]), pose_columns(target[None]))[:, 0]
    np.testing.assert_allclose(twist_between(pose, target), batch, atol=1e-9)


@pytest.mark.parametrize("arm", [arms.offset6, arms.skewed6])
def test_one_candidate_is_polished_as_among_others(arm):
    chain, _ = arm()
    random = np.random.default_rng(1)
    true = random.uniform(-2.5, 2.5, (60, 6))
    poses = flange_poses(chain, true)
    candidates = true + random.normal(size=true.shape) * random.choice([1e-6, 1e-3, 0.1, 1.0], (60, 1))
    together, misses = polished(chain, poses, candidates)
    alone = [polished(chain, poses[at : at + 1], candidates[at : at + 1]) for at in range(60)]
    np.testing.assert_allclose([miss[0] < 1e-8 for _, miss in alone], misses < 1e-8)
    solved = misses < 1e-8
    assert 20 <= solved.sum() < 60
    np.testing.assert_allclose(np.array([q[0] for q, _ in alone])[solved], together[solved], atol=1e-7)
