"""Tests of finding all solutions of arms with six turning joints: by elimination, with three parallel axes,
and for calibrated arms.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import (
    Solutions,
    Track,
    branches,
    flange_poses,
    follow,
    nearest_solutions,
    reaching,
    track,
)
from yarclang.robot.kinematics.elimination import (
    _bent,
    _elimination,
    candidates,
    distinct,
    every_solution,
    polished,
)
from yarclang.robot.kinematics.geometry import form_of, nominal_form, parallel_arm, wristed_arm
from yarclang.robot.kinematics.march import march

POSES = 200


def drawn(chain, seed=1, count=POSES):
    q = np.random.default_rng(seed).uniform(-3.0, 3.0, (count, 6))
    return q, flange_poses(chain, q)


def apart(one, other):
    away = one - other
    return np.abs(away - 2 * np.pi * np.round(away / (2 * np.pi))).max(axis=-1)


def held(chain, poses, q, valid):
    """Check that each solution reaches its pose, and that no two are equal."""
    stand = flange_poses(chain, q.reshape(-1, 6)).reshape(*valid.shape, 4, 4)
    assert np.abs(stand - poses[:, None])[valid].max(initial=0.0) < 1e-8
    gap = apart(q[:, :, None], q[:, None]) + np.where(np.eye(q.shape[1], dtype=bool), 9.0, 0.0)
    both = valid[:, :, None] & valid[:, None]
    assert gap[both].min(initial=9.0) > 1e-7


def origin(q, found, valid):
    """Return the distances of the joint positions from which the poses were computed to the nearest
    solutions.
    """
    return np.where(valid, apart(found, q[:, None]), 9.0).min(axis=1)


@pytest.mark.parametrize("name", arms.COBOTS)
def test_cobots(name):
    chain = arms.COBOTS[name]
    q, poses = drawn(chain)
    found, valid = branches(chain, poses)
    assert origin(q, found, valid).max() < 1e-5
    # Both functions find equally many solutions.
    again, there = every_solution(chain, poses)
    held(chain, poses, again, there)
    assert valid.sum() == there.sum()
    most = {"ur5": 8, "lite6": 8, "crx10": 16, "hc10": 16, "crb15000": 16, "gen3_lite": 12}[name]
    assert valid.sum(axis=1).max() >= most - 2


def test_random_arms_have_as_many_solutions_as_all_eliminations_together():
    rng = np.random.default_rng(3)
    total = 0
    for _ in range(60):
        chain = arms.random6(rng)
        q = rng.uniform(-3.0, 3.0, (3, 6))
        poses = flange_poses(chain, q)
        found, valid = branches(chain, poses)
        held(chain, poses, found, valid)
        assert origin(q, found, valid).max() < 1e-5
        forms = [_elimination(chain, order) for order in range(6)] + [_bent(chain, 2)]
        parts = [candidates(form, poses) for form in forms]
        rows = np.concatenate([part[0] for part in parts])
        _, there = distinct(chain, poses, rows, np.concatenate([part[1] for part in parts]))
        assert (valid.sum(axis=1) >= there.sum(axis=1)).all()
        total += int(valid.sum())
    assert total > 60 * 3 * 3


def test_search_finds_nothing_that_elimination_doesnt():
    """A search from many joint positions, independent of the elimination, finds no further solution."""
    chain = arms.COBOTS["crb15000"]
    _, poses = drawn(chain, 5, 6)
    found, valid = branches(chain, poses)
    seeds = np.random.default_rng(6).uniform(-3.1, 3.1, (1500, 6))
    for pose, q, there in zip(poses, found, valid, strict=True):
        solved, miss, turn = follow(chain, np.repeat(pose[None], len(seeds), axis=0), seeds)
        solved = solved[np.hypot(miss, turn) < 1e-9]
        assert len(solved) > 100
        near = apart(solved[:, None], q[there][None])
        assert near.min(axis=1).max() < 1e-5
        assert near.min(axis=0).max() < 1e-5


@pytest.mark.parametrize("seed", range(8))
def test_three_parallel_axes(seed):
    chain = arms.parallel6(np.random.default_rng(seed))
    assert wristed_arm(chain) is None
    assert parallel_arm(chain) is form_of(chain) is not None
    q, poses = drawn(chain, seed, 400)
    found, valid = branches(chain, poses)
    held(chain, poses, found, valid)
    assert origin(q, found, valid).max() < 1e-6
    assert valid[:60].sum() == every_solution(chain, poses[:60])[1].sum()
    near, near_valid = branches(chain, flange_poses(chain, q + 1e-7))
    both = valid & near_valid
    assert np.median(apart(found, near)[both]) < 1e-5  # the order of the solutions is fixed


@pytest.mark.parametrize("exponent", [-1, -4, -8, -12, -16])
def test_the_last_axis_all_but_parallel_to_the_three(exponent):
    chain = arms.COBOTS["ur5"]
    q = np.array([[0.3, -1.2, 1.4, 0.5, 10.0**exponent, 0.7]])
    pose = flange_poses(chain, q)
    # In the seed, joint 2 is turned by 1 mrad, and joint 3 is turned back by as much.
    seed = q + np.array([0.0, 1e-3, -1e-3, 0.0, 0.0, 0.0])
    found, miss, turn = follow(chain, pose, seed)
    assert max(miss[0], turn[0]) < 1e-9
    assert apart(found, seed)[0] < 0.05


def test_an_arm_that_is_off_parallel_has_no_closed_form():
    chain = arms.off_nominal(arms.COBOTS["ur5"], np.random.default_rng(0), 1e-6)
    assert form_of(chain) is None
    assert nominal_form(chain) is not None
    assert nominal_form(arms.off_nominal(arms.COBOTS["ur5"], np.random.default_rng(0), 0.1)) is None
    assert nominal_form(arms.COBOTS["ur5"]) is None


@pytest.mark.parametrize("size", [1e-8, 1e-5, 1e-4, 5e-4])
@pytest.mark.parametrize("name", ["ur5", "lite6", "industrial6"])
def test_calibrated_arms(name, size):
    nominal = arms.industrial6()[0] if name == "industrial6" else arms.COBOTS[name]
    chain = arms.off_nominal(nominal, np.random.default_rng(2), size)
    q, poses = drawn(chain)
    found, valid = branches(chain, poses)
    held(chain, poses, found, valid)
    assert origin(q, found, valid).max() < 1e-5
    assert valid.sum() >= every_solution(chain, poses)[1].sum()
    # The solutions have the order of the nominal arm.
    meant, there = branches(nominal, poses)
    both = valid[:, :8] & there
    assert both.sum() > 0.9 * there.sum()
    assert np.median(apart(found[:, :8], meant)[both]) < 60 * size
    limits = arms.limits_of(np.full(6, -3.1), np.full(6, 3.1))
    reached, solved = reaching(chain, limits, poses)
    assert solved.all()
    assert np.abs(flange_poses(chain, reached) - poses).max() < 1e-8


def test_solutions_within_limits_nearest_first():
    chain = arms.COBOTS["crx10"]
    high = np.radians([190, 180, 317, 190, 180, 225])
    limits = arms.limits_of(-high, high)
    q, poses = drawn(chain, 4, 30)
    for pose, here in zip(poses, q, strict=True):
        solved = nearest_solutions(chain, limits, pose, here + 0.05)
        assert isinstance(solved, Solutions)
        assert np.abs(solved.q - here).max(axis=1).min() < 1e-5
        cost = np.square(solved.q - here - 0.05).sum(axis=1)
        assert (np.diff(cost) > -1e-8).all()
        assert (solved.q <= limits.upper).all()
        assert (solved.q >= limits.lower).all()


@pytest.mark.parametrize("name", arms.COBOTS)
def test_poses_that_leave_a_joint_free(name):
    """Poses with a straight arm or wrist leave a joint free, which is difficult for the elimination."""
    chain = arms.COBOTS[name]
    limits = arms.limits_of(np.full(6, -4.0), np.full(6, 4.0))
    for q in np.array(
        [[0.0] * 6, [0, 0, 0, 0, 0, 1.0], [0.3, -0.5, 0.4, 0.2, 0, 1], [0.3, 0.5, -0.5, 0, 0, 0]]
    ):
        pose = flange_poses(chain, q[None])
        solved = nearest_solutions(chain, limits, pose[0], q)
        assert isinstance(solved, Solutions)
        assert np.abs(solved.q[0] - q).max() < 1e-3, solved.q
        found, valid = branches(chain, pose)
        if form_of(chain) is None:  # in a closed form, equal solutions stay in separate places
            held(chain, pose, found, valid)
        assert valid.any()


@pytest.mark.parametrize("name", ["crx10", "ur5", "crb15000"])
def test_out_of_reach(name):
    chain = arms.COBOTS[name]
    far = chain.base_from_flange.copy()
    far[0, 3] += 5.0
    found, valid = branches(chain, far[None])
    assert not valid.any()
    assert np.isfinite(found).all()
    limits = arms.limits_of(np.full(6, -3.0), np.full(6, 3.0))
    assert not isinstance(nearest_solutions(chain, limits, far, np.zeros(6)), Solutions)


def test_no_poses_and_no_candidates():
    chain = arms.COBOTS["crx10"]
    found, valid = branches(chain, np.empty((0, 4, 4)))
    assert found.shape[0] == valid.shape[0] == 0
    q, miss = polished(chain, np.empty((0, 4, 4)), np.empty((0, 6)))
    assert q.shape == (0, 6)
    assert miss.shape == (0,)


Z = (0.0, 0.0, 1.0)
ODD = {
    "all axes parallel": [((0.3, 0, 0), Z)] * 6,
    "all axes in one": [((0, 0, 0.1), Z)] * 6,
    "all axes through a point": [((0, 0, 0), axis) for axis in np.vstack([np.eye(3), np.eye(3) + 0.3])],
    "two in one": [
        ((0, 0, 0.1), Z),
        ((0, 0, 0.1), Z),
        ((0.3, 0, 0), (0, 1, 0)),
        ((0.3, 0, 0), (0, 1, 0)),
        ((0, 0, 0.1), (1, 0, 0)),
        ((0.1, 0, 0), (0, 1, 0)),
    ],
    "far away": [((1e3, 0, 0), (0, 1, 0)), *arms.JOINTS_SEED6[1:]],
    "tiny": [(1e-4 * np.array(point), axis) for point, axis in arms.JOINTS_SEED6],
}
"""Arms that nobody builds, but that a URDF may describe."""


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize("name", ODD)
def test_odd_arms_are_answered(name):
    """Each solution reaches its pose, and no exception is raised."""
    chain = arms.chain_of(ODD[name], flange=(0.1, 0.02, 0.0))
    limits = arms.limits_of(np.full(6, -3.0), np.full(6, 3.0))
    q = np.random.default_rng(8).uniform(-2.5, 2.5, (3, 6))
    poses = flange_poses(chain, q)
    found, valid = branches(chain, poses)
    stand = flange_poses(chain, found.reshape(-1, 6)).reshape(*valid.shape, 4, 4)
    assert np.abs(stand - poses[:, None])[valid].max(initial=0.0) < 1e-6
    for pose, here in zip(poses, q, strict=True):
        solved = nearest_solutions(chain, limits, pose, here)
        assert isinstance(solved, Solutions)
        assert np.abs(flange_poses(chain, solved.q[:1])[0] - pose).max() < 1e-6


def straight(pose, way):
    def pose_at(s):
        poses = np.repeat(pose[None], len(s), axis=0)
        poses[:, :3, 3] += s[:, None] * way
        return poses

    return pose_at


def test_lines_of_three_parallel_axes_are_those_that_iteration_follows():
    chain = arms.COBOTS["ur5"]
    limits = arms.limits_of(np.full(6, -6.2), np.full(6, 6.2))
    rng = np.random.default_rng(4)
    whole = 0
    for _ in range(30):
        q = rng.uniform(-2.5, 2.5, 6)
        way = rng.normal(size=3)
        pose_at = straight(flange_poses(chain, q[None])[0], 0.15 * way / np.linalg.norm(way))
        found, least = track(chain, limits, pose_at, q, reason="any"), march(chain, pose_at, q)
        assert isinstance(found, Track) == (least.end == "whole")
        if isinstance(found, Track):
            whole += 1
            assert np.abs(flange_poses(chain, found.q) - pose_at(found.s)).max() < 1e-9
            assert np.abs(found.q[-1] - least.q[-1]).max() < 1e-7
    assert whole > 10


@pytest.mark.parametrize("bend", [0.0, 1e-12, 1e-7])
def test_a_line_that_begins_where_the_last_axis_is_parallel_to_the_three(bend):
    """At the start, the last axis is parallel to the three parallel axes. A line out of their plane is
    impossible, because the hand would have to swing. A line in the plane across the parallel axes is
    possible.
    """
    chain = arms.COBOTS["ur5"]
    limits = arms.limits_of(np.full(6, -6.2), np.full(6, 6.2))
    q = np.array([0.0, -1.2, 1.4, 0.5, bend, 0.7])
    pose = flange_poses(chain, q[None])[0]
    # If the line is in the plane in which the three joints move, axis 1 stands still.
    found = track(chain, limits, straight(pose, np.array([0.05, 0.0, 0.04])), q, reason="any")
    assert isinstance(found, Track)
    assert (
        np.abs(
            flange_poses(chain, found.q)[-1] - straight(pose, np.array([0.05, 0.0, 0.04]))(np.ones(1))[0]
        ).max()
        < 1e-9
    )
    assert np.abs(np.diff(found.q, axis=0)).max() <= 0.2
    aside = track(chain, limits, straight(pose, np.array([0.0, 0.08, 0.0])), q, reason="any")
    assert not isinstance(aside, Track) or np.abs(np.diff(aside.q, axis=0)).max() <= 0.2
