"""Tests of the nearest solution of arms with spare joints and no closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.robot.kinematics import arms
from tests.robot.kinematics.test_redundant import line
from yarclang.robot.kinematics import Solutions, Track, flange_poses, nearest_solutions, track
from yarclang.robot.kinematics.nearest_spare import nearest_along
from yarclang.robot.kinematics.postures import seeds_near
from yarclang.robot.kinematics.pulling import nearest_pulled
from yarclang.robot.kinematics.redundant import null_spaces
from yarclang.robot.kinematics.spare import spare_form
from yarclang.robot.kinematics.within import beyond, clear_of_limits

ARMS = {
    "yumi": arms.yumi7,
    "base": arms.on_base,
    "slider9": arms.slider9,
    "panda": lambda: arms.seven("panda"),
}


def tasks(arm, count, seed):
    """Return joint positions, their poses, and reference positions for the search. Every second reference is
    near.
    """
    chain, limits = arm()
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.95 * limits.lower, 0.95 * limits.upper, (count, chain.size))
    near = rng.uniform(0.95 * limits.lower, 0.95 * limits.upper, (count, chain.size))
    near[::2] = np.clip(q[::2] + rng.normal(0.0, 0.1, q[::2].shape), limits.lower, limits.upper)
    return chain, limits, q, flange_poses(chain, q), near


@pytest.mark.parametrize("name", ["yumi", "base", "slider9"])
def test_no_joint_position_near_the_found_one_is_nearer(name):
    """At the nearest solution, the direction to the reference has no component in the null space, except for
    joints at their limits.
    """
    chain, limits, q, poses, near = tasks(ARMS[name], 12, 0)
    free = 0
    for given_, pose, reference in zip(q, poses, near, strict=True):
        for is_only in (False, True):
            found = nearest_solutions(chain, limits, pose, reference, is_only=is_only)
            assert isinstance(found, Solutions)
            assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
            assert np.abs(beyond(limits, found.q)).max() == 0.0
        low, high = clear_of_limits(limits, reference)
        first = found.q[0]
        if ((given_ >= low) & (given_ <= high)).all():
            assert np.linalg.norm(first - reference) < np.linalg.norm(given_ - reference) + 1e-2
        if (np.minimum(first - low, high - first) < 1e-3).any():
            continue
        free += 1
        ways = null_spaces(chain, first[None], np.ones(chain.size))[0]
        assert np.abs(ways @ (reference - first)).max() < 1e-2
    assert free >= 3, free


def test_it_is_about_as_near_as_that_of_all_branches():
    """For the Panda, the result is about as near as the nearest of all branches along the self-motion, found
    by its closed form.
    """
    chain, limits, _, poses, near = tasks(ARMS["panda"], 40, 1)
    form, farther = spare_form(chain), 0
    assert form is not None
    for pose, reference in zip(poses, near, strict=True):
        best = [
            np.linalg.norm(found - reference, axis=1).min()
            for found in (
                nearest_along(chain, limits, form, pose, reference),
                nearest_pulled(chain, limits, pose, reference, is_only=True),
            )
        ]
        farther += best[1] > best[0] + 1e-2
    assert farther <= 3, farther


@pytest.mark.parametrize("name", ARMS)
def test_seeds_nearly_reach_the_pose(name):
    """The seeds nearly reach the pose: they are rows of the table, with the first and last joint turned as
    the pose requires.
    """
    chain, limits, _, poses, near = tasks(ARMS[name], 10, 2)
    off, at_random = [], []
    for pose, reference in zip(poses, near, strict=True):
        seeds = seeds_near(chain, limits, limits.lower, limits.upper, pose, reference)
        np.testing.assert_array_equal(seeds[0], reference)
        assert np.abs(beyond(limits, seeds)).max() == 0.0
        off.append(np.median(np.abs(flange_poses(chain, seeds[1:]) - pose).max(axis=(1, 2))))
        spread = np.random.default_rng(0).uniform(limits.lower, limits.upper, (48, chain.size))
        at_random.append(np.median(np.abs(flange_poses(chain, spread) - pose).max(axis=(1, 2))))
    assert np.median(off) < 0.5 * np.median(at_random), (np.median(off), np.median(at_random))


@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(0, 10**6))
def test_arms_by_chance(seed):
    """For random arms of seven joints, some of them sliding, solutions reach the pose within limits. Poses of
    known joint positions are solved.
    """
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(7, 3))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    points = np.cumsum(0.3 * rng.normal(size=(7, 3)), axis=0)
    screws = np.hstack([-np.cross(axes, points), axes])
    slides = np.flatnonzero(rng.random(7) < 0.15)
    screws[slides] = np.hstack([axes[slides], np.zeros((len(slides), 3))])
    home = np.eye(4)
    home[:3, 3] = points[-1] + 0.1
    chain = arms.Chain(arms.frozen(screws), arms.frozen(home))
    high = rng.uniform(1.0, 3.5, 7)
    high[slides] = rng.uniform(0.2, 1.0, len(slides))
    limits = arms.limits_of(-high, high)
    q = rng.uniform(-0.9 * high, 0.9 * high)
    pose = flange_poses(chain, q[None])[0]
    found = nearest_solutions(chain, limits, pose, rng.uniform(-high, high), is_only=True)
    assert isinstance(found, Solutions)
    assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
    assert np.abs(beyond(limits, found.q)).max() == 0.0


LIMITS = {
    "turns without limits": (
        np.r_[-np.inf, -1.0, np.full(7, -np.inf)],
        np.r_[np.inf, 1.0, np.full(7, np.inf)],
    ),
    "as good as none": (np.r_[-1e6, -1e6], np.r_[1e6, 1e6]),
    "a slide without limits": (np.r_[-3.0, -np.inf], np.r_[3.0, np.inf]),
    "limits on one side": (np.r_[-3.0, -0.2], np.r_[3.0, np.inf]),
    "a locked joint": (np.r_[0.3, -1.0], np.r_[0.3, 1.0]),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", LIMITS)
def test_limits_of_all_kinds(name):
    """With various limits of the base's joints, poses are reached and lines are followed, also far away."""
    chain, own = arms.on_base()
    lower, upper = (
        np.r_[given_, own_[len(given_) :]]
        for given_, own_ in zip(LIMITS[name], (own.lower, own.upper), strict=True)
    )
    limits = arms.limits_of(lower, upper)
    rng = np.random.default_rng(0)
    away = np.zeros(9)
    away[1] = 40.0 if upper[1] - lower[1] > 1e3 else 0.0
    followed = 0
    for number in range(8):
        q, near = away + rng.uniform(np.maximum(lower, -2.5), np.minimum(upper, 2.5), (2, 9))
        pose = flange_poses(chain, q[None])[0]
        found = nearest_solutions(chain, limits, pose, near, is_only=bool(number % 2))
        assert isinstance(found, Solutions)
        assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
        assert np.abs(beyond(limits, found.q)).max() == 0.0
        followed += isinstance(track(chain, limits, line(pose, np.r_[0.2, 0, 0]), q, reason="any"), Track)
    assert followed >= 5, followed
