"""Tests that poses solved together have the same solutions as poses solved one after the other."""

import numpy as np
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import Solutions, nearest_solutions
from yarclang.robot.kinematics.closed_form import closed_form, one_branch
from yarclang.robot.kinematics.fk import flange_poses, tool_poses
from yarclang.robot.kinematics.geometry import wristed_arm
from yarclang.robot.kinematics.in_turn import nearest_in_turn


def one_by_one(chain, limits, poses, q):
    found = []
    for pose in poses:
        solved = nearest_solutions(chain, limits, pose, q, measures=False)
        if not isinstance(solved, Solutions):
            break
        q = solved.q[0]
        found.append(q)
    return np.array(found).reshape(-1, chain.size)


@exercises(whole=0.2, cut=0.05)
@given(st.integers(0, 2**32 - 1), st.floats(0.002, 1.5))
def test_together_as_one_after_the_other(tally, seed, size):
    chance = np.random.default_rng(seed)
    chain, limits = arms.industrial6()
    q = chance.uniform(np.maximum(limits.lower, -2.5), np.minimum(limits.upper, 2.5))
    start = tool_poses(chain, q[None], np.eye(4))[0]
    poses = np.tile(start, (40, 1, 1))
    way = np.linspace(0.0, 1.0, 40)[:, None]
    poses[:, :3, 3] += size * way * chance.uniform(-1, 1, 3)
    turned = Rotation.from_rotvec(2.0 * size * way * chance.uniform(-1, 1, 3)).as_matrix()
    poses[:, :3, :3] = turned @ start[:3, :3]
    expected = one_by_one(chain, limits, poses, q)
    found = nearest_in_turn(chain, limits, poses, q)
    assert len(found) <= len(expected)
    np.testing.assert_allclose(found, expected[: len(found)], rtol=0, atol=1e-9)
    tally.count("whole", len(found) == len(poses))
    tally.count("cut", len(found) < len(poses))


def test_nothing_to_solve_and_no_closed_form():
    chain, limits = arms.industrial6()
    assert nearest_in_turn(chain, limits, np.empty((0, 4, 4)), np.zeros(6)).shape == (0, 6)


@exercises(held=0.05, compared=0.2)
@given(st.integers(0, 2**32 - 1), st.integers(0, 7), st.sampled_from([2, 3, 7, 700]))
def test_one_branch_is_that_of_all_to_the_last_bit(tally, seed, branch, count):
    chance = np.random.default_rng(seed)
    chain, limits = arms.industrial6()
    arm = wristed_arm(chain)
    assert arm is not None
    q = chance.uniform(np.maximum(limits.lower, -3.0), np.minimum(limits.upper, 3.0), (count, 6))
    # Some poses have a straight wrist, and some are out of reach.
    q[chance.random(count) < 0.1 * (seed % 2), 4] = 0.0
    poses = flange_poses(chain, q)
    poses[chance.random(count) < 0.1, :3, 3] *= 2.0
    every = closed_form(arm, poses, np.zeros((6, 1)))
    found, valid, singular = one_branch(arm, poses, branch)
    free = every.singular.any(axis=0)
    assert (singular | ~free).all()
    assert not (singular & ~free).any()
    assert np.array_equal(valid[~free], every.valid[branch, ~free])
    tally.count("held", free.any())
    tally.count("compared", not free.any())
    if not free.any():
        assert np.array_equal(found, every.q[:, branch])
