"""Tests of inverse kinematics: all branches, and the solution next to a seed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import branches, flange_poses, follow
from yarclang.robot.kinematics.closed_form import BLOCK
from yarclang.robot.kinematics.geometry import form_of, wristed_arm
from yarclang.robot.kinematics.wrist import HOLD
from yarclang.robot.model import Chain

WRISTED = [arms.industrial6, arms.skewed6]
OTHER = [arms.offset6, arms.scara4, arms.seven7, arms.planar3, arms.slider9]
angles = st.floats(-3.1, 3.1, allow_nan=False)
positions = st.lists(angles, min_size=6, max_size=6).map(np.array)


def apart(first, second):
    """Return the largest difference between two joint positions, without full turns."""
    away = np.asarray(first) - np.asarray(second)
    return np.abs(away - 2 * np.pi * np.round(away / (2 * np.pi))).max(axis=-1)


def pose_error(chain, q, poses):
    return np.abs(flange_poses(chain, q) - poses).max(axis=(1, 2))


def test_which_arms_have_a_closed_form():
    assert all(wristed_arm(arm()[0]) is not None for arm in WRISTED)
    assert all(form_of(arm()[0]) is None for arm in OTHER)
    chain, _ = arms.industrial6()
    # An offset of a micrometre is enough to lose the closed form.
    screws = chain.screws.copy()
    screws[5, 2] += 1e-6
    assert wristed_arm(Chain(arms.frozen(screws), chain.base_from_flange)) is None


@pytest.mark.parametrize("arm", WRISTED)
@settings(max_examples=60, deadline=None)
@given(q=positions)
def test_every_branch_reaches_the_pose_and_one_is_the_origin(arm, q):
    chain, _ = arm()
    pose = flange_poses(chain, q[None])
    # The joint position from which the pose was computed is one of the solutions, unless it is singular and
    # belongs to a continuum.
    found, valid = branches(chain, pose, hold=q)
    assert pose_error(chain, found[0, valid[0]], pose).max() < 1e-9
    gap = apart(found[0, valid[0]], q).min()
    _, singular = np.linalg.svd(_jacobian(chain, q))[:2]
    assert gap < 1e-12 / max(singular[-1], 1e-9) + 1e-9 or singular[-1] < 1e-4


def _jacobian(chain, q):
    from yarclang.robot.kinematics import poses_and_jacobians

    return poses_and_jacobians(chain, q[None], np.eye(4))[1][0]


@pytest.mark.parametrize("arm", WRISTED)
def test_branches_of_a_batch(arm):
    chain, _ = arm()
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (2 * BLOCK + 7, 6))
    poses = flange_poses(chain, q)
    found, valid = branches(chain, poses)
    assert found.shape == (len(q), 8, 6)
    errors = pose_error(chain, found.reshape(-1, 6), np.repeat(poses, 8, axis=0)).reshape(valid.shape)
    assert errors[valid].max() < 1e-12
    assert errors[~valid].min() > 1e-8
    assert np.where(valid, apart(found, q[:, None]), 9.0).min(axis=1).max() < 1e-8
    # The order is fixed: nearby poses have nearby branches.
    near, near_valid = branches(chain, flange_poses(chain, q + 1e-7))
    both = valid & near_valid
    assert np.median(apart(found, near)[both]) < 1e-5


@pytest.mark.parametrize("arm", OTHER)
def test_numeric_branches(arm):
    chain, limits = arm()
    q = np.random.default_rng(1).uniform(limits.lower, limits.upper, (4, chain.size))
    poses = flange_poses(chain, q)
    found, valid = branches(chain, poses)
    assert valid.any(axis=1).all()
    repeated = np.repeat(poses, found.shape[1], axis=0)
    errors = pose_error(chain, found.reshape(-1, chain.size), repeated).reshape(valid.shape)
    assert errors[valid].max() < 1e-9
    if chain.size <= 6:
        distance = np.where(valid, np.abs(_modulo(chain, found - q[:, None])).max(axis=2), 9.0)
        assert distance.min(axis=1).max() < 1e-6
    again, _ = branches(chain, poses)
    np.testing.assert_array_equal(found, again)


def _modulo(chain, away):
    return away - np.where(chain.is_prismatic, 0.0, 2 * np.pi * np.round(away / (2 * np.pi)))


@pytest.mark.parametrize("arm", WRISTED + OTHER)
def test_follow_finds_the_solution_next_to_the_seed(arm):
    chain, limits = arm()
    rng = np.random.default_rng(2)
    q = rng.uniform(limits.lower, limits.upper, (300, chain.size))
    poses = flange_poses(chain, q)
    seeds = q + rng.uniform(-0.01, 0.01, q.shape)
    found, miss, turn = follow(chain, poses, seeds)
    assert max(miss.max(), turn.max()) < 1e-10
    assert np.abs(found - seeds).max() < 0.3
    np.testing.assert_allclose(pose_error(chain, found, poses), 0.0, atol=1e-10)
    if chain.size <= 6:
        assert np.median(np.abs(found - q).max(axis=1)) < 1e-8


@pytest.mark.parametrize("arm", WRISTED)
def test_the_digits_of_the_seed_say_nothing(arm):
    """The seed only chooses a branch and full turns. The joint positions depend only on the pose, to the last
    bit.
    """
    chain, limits = arm()
    rng = np.random.default_rng(3)
    q = rng.uniform(limits.lower, limits.upper, (300, chain.size))
    q = q[[np.linalg.svd(_jacobian(chain, one))[1][-1] > 1e-2 for one in q]]
    assert len(q) > 200
    poses, seeds = flange_poses(chain, q), q + rng.uniform(-0.005, 0.005, q.shape)
    found = follow(chain, poses, seeds)[0]
    for size in (1e-15, 1e-9, 1e-4):
        assert np.array_equal(follow(chain, poses, seeds + rng.uniform(-size, size, q.shape))[0], found)


def test_follow_keeps_the_turn_of_the_seed():
    chain, _ = arms.industrial6()
    q = np.array([0.3, 0.2, -0.4, 0.5, 0.6, 0.7])
    turns = 2 * np.pi * np.array([[0, 0, 0, 1, 0, -1], [0, 0, 0, 0, 0, 2], [1, 0, 0, -1, 0, 0]])
    poses = np.repeat(flange_poses(chain, q[None]), 3, axis=0)
    found = follow(chain, poses, q + turns + 0.01)[0]
    np.testing.assert_allclose(found, q + turns, atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(
    exponent=st.floats(-16, -2),
    q4=angles,
    held=st.floats(-1.2, 1.2),
    q6=angles,
    sign=st.sampled_from([-1, 1]),
)
def test_accurate_as_the_wrist_straightens(exponent, q4, held, q6, sign):
    """However small sin q5 is, the pose is reached to 1e-9, and q4 changes smoothly from the seed's value to
    the value that the pose determines.
    """
    chain, _ = arms.industrial6()
    q5 = sign * 10.0**exponent
    q = np.array([[0.3, 0.2, -0.4, q4, q5, q6]])
    seed = q + np.array([0, 0, 0, held, 0, -held])
    pose = flange_poses(chain, q)
    found, miss, turn = follow(chain, pose, seed)
    assert max(miss[0], turn[0]) < 1e-9
    assert pose_error(chain, found, pose)[0] < 1e-9
    # q4 is at most 1.2 rad from the seed, and q4 of the flipped wrist at least 1.9 rad. So the result is q,
    # unless q5 is so small that q4 is held.
    if abs(q5) > 1e3 * HOLD:
        np.testing.assert_allclose(found, q, atol=1e-5)
    if abs(q5) < 1e-3 * HOLD:
        np.testing.assert_allclose(found, seed + np.array([0, 0, 0, 0, -q5, 0]), atol=1e-5)


def test_smooth_through_the_straight_wrist():
    """Neighbouring poses have neighbouring solutions, at any distance from the singularity."""
    chain, _ = arms.industrial6()
    q5 = np.concatenate([-np.geomspace(1e-2, 1e-15, 400), [0.0], np.geomspace(1e-15, 1e-2, 400)])
    q = np.zeros((len(q5), 6))
    q[:, :] = [0.3, 0.2, -0.4, 0.7, 0.0, -0.2]
    q[:, 4] = q5
    found, miss, turn = follow(chain, flange_poses(chain, q), q)
    assert max(miss.max(), turn.max()) < 1e-10
    np.testing.assert_allclose(found, q, atol=1e-5)


def test_held_shoulder_over_axis_1():
    chain, _ = arms.industrial6()
    form = wristed_arm(chain)
    # With the wrist center on axis 1, q1 is free.
    stretch = form.upper + form.fore
    goal = np.eye(4)
    goal[:3, 3] = [0.0, 0.238, 0.679 + 0.7 * stretch]
    for q1 in (-1.0, 0.0, 0.4):
        seed = np.array([[q1, -0.3, 0.5, 0.1, 0.2, 0.0]])
        found, miss, turn = follow(chain, goal[None], seed)
        assert max(miss[0], turn[0]) < 1e-10
        assert abs(found[0, 0] - q1) < 1e-6


def test_out_of_reach_misses_by_the_distance():
    chain, _ = arms.industrial6()
    poses = np.repeat(chain.base_from_flange[None], 3, axis=0)
    poses[:, 0, 3] += [5.0, 6.0, 7.0]
    _, miss, _ = follow(chain, poses, np.zeros((3, 6)))
    np.testing.assert_allclose(np.diff(miss), 1.0, atol=0.15)


def test_nothing_to_do():
    for arm in (arms.industrial6, arms.offset6):
        chain, _ = arm()
        q, miss, turn = follow(chain, np.empty((0, 4, 4)), np.empty((0, 6)))
        assert q.shape == (0, 6)
        assert miss.shape == turn.shape == (0,)
