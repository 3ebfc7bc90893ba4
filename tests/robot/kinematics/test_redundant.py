"""Tests of arms with spare joints: their self-motion, and lines that need it to stay within limits."""

from __future__ import annotations

import numpy as np
import pytest

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import Track, flange_poses, follow, track
from yarclang.robot.kinematics.march import march
from yarclang.robot.kinematics.redundant import reaches, self_motion, weights
from yarclang.robot.kinematics.track import followed
from yarclang.robot.kinematics.within import beyond

REDUNDANT = [arms.seven7, arms.slider9]


def line(pose, way):
    """Return a straight path (3,) [m] from a pose, with constant orientation."""

    def pose_at(s):
        poses = np.repeat(pose[None], len(s), axis=0)
        poses[:, :3, 3] += s[:, None] * way
        return poses

    return pose_at


def starts(arm, count, seed=0):
    chain, limits = arm()
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.8 * limits.lower, 0.8 * limits.upper, (count, chain.size))
    return chain, limits, q, rng


@pytest.mark.parametrize("arm", REDUNDANT)
def test_the_flange_stays_where_it_is(arm):
    chain, limits, starting, _ = starts(arm, 8)
    total = 0
    for q in starting:
        pose = flange_poses(chain, q[None])[0]
        assert reaches(chain, pose, q)
        found = self_motion(chain, limits, pose, q[None])
        assert np.abs(flange_poses(chain, found) - pose).max(initial=0.0) < 1e-9
        assert np.abs(beyond(limits, found)).max(initial=0.0) <= 1e-8
        total += len(found)
        # Each position of the self-motion is a small step away from another one.
        every = np.vstack([q, found])
        apart = np.abs((every[:, None] - every[None]) / weights(chain, limits) * np.pi).max(axis=2)
        np.fill_diagonal(apart, 9.0)
        assert len(found) == 0 or apart.min(axis=1).max() < 0.4
    assert total > 8 * 20


def test_it_goes_all_round_as_far_as_limits_allow():
    """The self-motion is found completely: the elbow of an arm with seven joints moves on a circle, up to
    joint limits at both ends, or all round.
    """
    chain, limits = arms.seven7()
    free = arms.limits_of(np.full(7, -np.inf), np.full(7, np.inf))
    q = np.array([0.2, 0.5, 0.3, 1.2, -0.4, 0.8, 0.1])
    pose = flange_poses(chain, q[None])[0]
    found = self_motion(chain, free, pose, q[None])
    assert np.ptp(found[:, 2]) > 4.0
    narrow = self_motion(chain, limits, pose, q[None])
    assert 0 < len(narrow) < len(found)


def test_arms_without_a_spare_joint_have_none():
    chain, limits = arms.industrial6()
    assert self_motion(chain, limits, chain.base_from_flange, np.zeros((1, 6))).shape == (0, 6)
    chain, limits = arms.seven7()
    assert self_motion(chain, limits, chain.base_from_flange, np.empty((0, 7))).shape == (0, 7)
    assert not reaches(chain, chain.base_from_flange, np.full(7, 0.5))


def test_lines_keep_within_limits_by_the_null_space():
    """On some lines, the smallest joint motion of a rail with eight revolute joints would exceed a joint
    limit. On these lines, a motion within the limits is found by using the null space.
    """
    chain, limits, starting, rng = starts(arms.slider9, 40)
    plain = kept = 0
    for q in starting:
        way = rng.normal(size=3)
        pose_at = line(flange_poses(chain, q[None])[0], 0.35 * way / np.linalg.norm(way))
        least = march(chain, pose_at, q)
        is_plain = least.end == "whole" and np.abs(beyond(limits, least.q)).max() <= 1e-8
        found = track(chain, limits, pose_at, q, reason="any")
        plain += is_plain
        kept += isinstance(found, Track)
        if isinstance(found, Track):
            assert np.abs(flange_poses(chain, found.q) - pose_at(found.s)).max() < 1e-8
            assert np.abs(beyond(limits, found.q)).max() <= 1e-8
            assert np.abs(np.diff(found.q, axis=0)).max() <= 0.2
        if is_plain:
            assert isinstance(found, Track)
            np.testing.assert_array_equal(found.q, least.q)
    assert kept >= plain + 3, (plain, kept)


@pytest.mark.parametrize("arm", [arms.slider9, arms.on_base, lambda: arms.seven("panda")])
def test_joints_at_their_limits_stay_there_and_the_others_make_up_for_it(arm):
    """Lines that begin next to limits, above all of sliding joints, are followed even if neither the least
    motion nor a motion away from limits stays within the limits.
    """
    chain, limits, starting, rng = starts(arm, 24, 7)
    slides = np.flatnonzero(chain.is_prismatic)
    more = 0
    for q in 1.2 * starting:
        q[slides] = rng.choice((limits.lower + 0.02, limits.upper - 0.02))[slides]
        way = rng.normal(size=3)
        pose_at = line(flange_poses(chain, q[None])[0], 0.3 * way / np.linalg.norm(way))
        found = track(chain, limits, pose_at, q, reason="any")
        is_followed = followed(chain, limits, [pose_at], q[None])
        assert is_followed.tolist() == [isinstance(found, Track)]
        if not isinstance(found, Track):
            continue
        before = (march(chain, pose_at, q), march(chain, pose_at, q, 0, limits))
        if any(one.end == "whole" and np.abs(beyond(limits, one.q)).max() <= 1e-8 for one in before):
            continue
        more += 1
        # Between the samples, where the joints are solved from the curve through the samples, this holds as
        # well.
        s = np.linspace(0.0, 1.0, 301)
        joints, miss, turn = follow(chain, pose_at(s), found.at(s))
        assert max(miss.max(), turn.max()) < 1e-8
        assert np.abs(beyond(limits, joints)).max() <= 1e-8
        moves = np.diff(joints, axis=0)
        assert np.abs(moves).max() < 0.2
        assert np.abs(np.diff(moves, axis=0)).max() < 0.02
    assert more >= (2 if len(slides) else 1), more
