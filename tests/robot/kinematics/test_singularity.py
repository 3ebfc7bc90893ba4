"""Tests of the distance from singularities, by numpy's SVD and finite differences."""

from __future__ import annotations

import numpy as np
import pytest

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import (
    arm_length,
    flange_poses,
    nearness,
    smallest_singular_values,
    tool_poses,
)

ALL = [arms.industrial6, arms.offset6, arms.scara4, arms.seven7, arms.planar3, arms.slider9]
TOOL = np.array([[0, -1, 0, 0.05], [1, 0, 0, -0.1], [0, 0, 1, 0.2], [0, 0, 0, 1]], float)


def drawn(arm, count=20, seed=3):
    chain, limits = arm()
    random = np.random.default_rng(seed)
    return chain, random.uniform(limits.lower, limits.upper, (count, chain.size))


def differences(chain, q, tool, step=1e-6):
    """Return the Jacobian (6, n) at `q` (n,), by central differences of forward kinematics."""
    columns = []
    (here,) = tool_poses(chain, q[None], tool)
    for joint in range(chain.size):
        move = np.eye(chain.size)[joint] * step
        after, before = tool_poses(chain, np.stack([q + move, q - move]), tool)
        spin = (after[:3, :3] - before[:3, :3]) / (2 * step) @ here[:3, :3].T
        columns.append([*((after - before)[:3, 3] / (2 * step)), spin[2, 1], spin[0, 2], spin[1, 0]])
    return np.array(columns).T


@pytest.mark.parametrize("arm", ALL)
def test_smallest_is_that_of_the_weighted_jacobian(arm):
    chain, q = drawn(arm)
    length = arm_length(chain, TOOL)
    near = nearness(chain, q, TOOL)
    weights = np.where(chain.is_prismatic, length, 1.0)
    for row, joints in enumerate(q):
        jacobian = differences(chain, joints, TOOL)
        scaled = np.diag([1 / length] * 3 + [1.0] * 3) @ jacobian @ np.diag(weights)
        values = np.linalg.svd(scaled, compute_uv=False)
        assert near.smallest[row] == pytest.approx(values[min(6, chain.size) - 1], abs=1e-8)
        # The reported joint motion moves the tool by the smallest singular value, in the reported direction.
        np.testing.assert_allclose(scaled @ near.joints[row], near.smallest[row] * near.twist[row], atol=1e-8)
        assert np.linalg.norm(near.joints[row]) == pytest.approx(1.0)
    np.testing.assert_allclose(smallest_singular_values(chain, q, TOOL), near.smallest, atol=1e-12)


def test_a_straight_wrist_is_singular_and_names_its_joints():
    chain, _ = arms.industrial6()
    for bend in (1e-1, 1e-2, 1e-3, 0.0):
        near = nearness(chain, np.array([[0.3, 0.2, -0.4, 0.5, bend, 0.1]]), np.eye(4))
        assert near.smallest[0] <= bend + 1e-12
        if bend < 0.05:
            assert set(np.flatnonzero(np.abs(near.joints[0]) > 0.5)) == {3, 5}


@pytest.mark.parametrize("arm", ALL)
def test_no_pose_is_farther_than_the_length(arm):
    chain, q = drawn(arm, 200)
    q = np.where(chain.is_prismatic, 0.0, q)
    turning = np.flatnonzero(~chain.is_prismatic)[0]
    linear, axis = chain.screws[turning, :3], chain.screws[turning, 3:]
    if chain.is_prismatic[:turning].any():
        pytest.skip("the first axis slides")
    points = flange_poses(chain, q)[:, :3, 3] - np.cross(axis, linear)
    away = np.linalg.norm(points - np.outer(points @ axis, axis), axis=1)
    assert away.max() <= arm_length(chain, np.eye(4)) + 1e-9
