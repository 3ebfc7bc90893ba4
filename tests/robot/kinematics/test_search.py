"""Tests of joint positions for many poses at once, without a seed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import flange_poses, reaching
from yarclang.robot.kinematics.search import span, within

ALL = [
    (arms.industrial6, 1.0),
    (arms.skewed6, 1.0),
    (arms.offset6, 0.995),
    (arms.seven7, 0.995),
    (arms.scara4, 0.995),
    (arms.planar3, 0.995),
    (arms.slider9, 0.99),
]


@pytest.mark.parametrize(("arm", "share"), ALL)
def test_random_reachable_poses_are_solved_within_limits(arm, share):
    chain, limits = arm()
    q = np.random.default_rng(5).uniform(limits.lower, limits.upper, (400, chain.size))
    poses = flange_poses(chain, q)
    found, solved = reaching(chain, limits, poses)
    assert solved.mean() >= share
    assert ((found >= limits.lower) & (found <= limits.upper)).all()
    tolerance = 1e-8 if chain.size >= 6 else 3e-6
    assert np.abs(flange_poses(chain, found) - poses)[solved].max() < tolerance


def test_what_is_out_of_reach_is_not_solved():
    chain, limits = arms.offset6()
    poses = flange_poses(chain, np.zeros((3, 6)))
    poses[:, 0, 3] += 50.0
    assert not reaching(chain, limits, poses)[1].any()


def test_no_poses():
    for arm in (arms.industrial6, arms.offset6):
        chain, limits = arm()
        found, solved = reaching(chain, limits, np.empty((0, 4, 4)))
        assert found.shape == (0, 6)
        assert solved.shape == (0,)


@pytest.mark.parametrize(("arm", "_share"), ALL)
def test_spread_positions_are_within_limits_and_differ(arm, _share):
    chain, limits = arm()
    q = within(chain, limits, 64)
    low, high = span(chain, limits)
    assert ((q >= limits.lower) & (q <= limits.upper)).all()
    assert (np.ptp(q, axis=0) > 0.8 * (high - low)).all()


def test_joints_without_limits_get_a_full_turn():
    chain, _ = arms.scara4()
    endless = arms.limits_of([-np.inf] * 4, [np.inf] * 4)
    low, high = span(chain, endless)
    np.testing.assert_allclose((high - low)[[0, 1, 3]], 2 * np.pi)
    assert np.isfinite(low).all()
    assert np.isfinite(high).all()
    found, solved = reaching(chain, endless, flange_poses(chain, within(chain, endless, 30)))
    assert solved.all()
    assert np.isfinite(found).all()
