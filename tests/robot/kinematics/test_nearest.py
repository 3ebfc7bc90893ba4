"""Tests of the solutions of a pose within limits, nearest first, and of the reasons if there is none."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.robot.kinematics import arms
from yarclang.robot.kinematics import (
    Solutions,
    Unreachable,
    branches,
    flange_poses,
    full_turns,
    nearest_solutions,
    tool_poses,
)
from yarclang.robot.kinematics.nearest import surely_reached
from yarclang.robot.kinematics.within import clear_of_limits

DATA = Path(__file__).parents[2] / "conformance"
FLANGE_FROM_TCP = arms.TCP
TCP_FROM_FLANGE = np.linalg.inv(arms.TCP)


def pose_of(mm, rpy_deg):
    pose = np.eye(4)
    pose[:3, 3] = np.array(mm) * 1e-3
    pose[:3, :3] = Rotation.from_euler("ZYX", rpy_deg[::-1], degrees=True).as_matrix()
    return pose


def test_listing_4():
    case = json.loads((DATA / "industrial6_kinematics.json").read_text())["listing4_P0001"]
    chain, limits = arms.industrial6()
    goal = pose_of(case["pose_mm_deg"][:3], case["pose_mm_deg"][3:]) @ TCP_FROM_FLANGE
    found = nearest_solutions(chain, limits, goal, np.zeros(6))
    np.testing.assert_allclose(np.degrees(found.q[0]), case["nearest_to_home_deg"], atol=1e-8)


def test_dmove_ends():
    chain, limits = arms.industrial6()
    for case in json.loads((DATA / "dmove.json").read_text())["cases"]:
        words = case["command"].split()
        values = [float(word) for word in words[3:9]]
        start = np.radians(case["start_deg"])
        at = tool_poses(chain, start[None], FLANGE_FROM_TCP)[0]
        step = pose_of(values[:3], values[3:])
        frame = at[:3, :3] if words[-1] == "{TCP}" else np.eye(3)
        goal = np.eye(4)
        goal[:3, 3] = at[:3, 3] + frame @ step[:3, 3]
        goal[:3, :3] = frame @ step[:3, :3] @ frame.T @ at[:3, :3]
        found = nearest_solutions(chain, limits, goal @ TCP_FROM_FLANGE, start)
        np.testing.assert_allclose(np.degrees(found.q[0]), case["end_deg"], atol=2e-7)


def test_home_is_home():
    chain, limits = arms.industrial6()
    for q4 in (0.0, 0.4, -1.0):
        home = np.array([0, 0, 0, q4, 0, -q4])
        found = nearest_solutions(chain, limits, chain.base_from_flange, home)
        # Where both wrist axes coincide, a rounding error of 1e-16 in the pose gives an error of 1e-11 in the
        # joints, on some processors.
        np.testing.assert_allclose(found.q[0], home, atol=1e-10)
        # The two solutions of the wrist have become one.
        assert np.abs(np.diff(found.q, axis=0)).max(axis=1).min() > 1e-3


def test_straight_wrist_lets_q4_help_where_joint_6_has_to_stop():
    chain, _ = arms.industrial6()
    high = np.radians([170, 135, 150, 190, 130, 60])
    limits = arms.limits_of(-high, high)
    goal = flange_poses(chain, np.radians([[0, 10, -10, 0, 0, 100]]))[0]
    found = nearest_solutions(chain, limits, goal, np.zeros(6))
    np.testing.assert_allclose(np.degrees(found.q[0]), [0, 10, -10, 40, 0, 60], atol=1e-9)


def brute_force(chain, limits, pose, reference):
    q, valid = branches(chain, pose[None])
    best = math.inf
    for branch in q[0, valid[0]]:
        for lifted in full_turns(chain, limits, branch):
            best = min(best, np.square(lifted - reference).sum())
    return best


positions = st.lists(st.floats(-1, 1), min_size=6, max_size=6).map(np.array)


@pytest.mark.parametrize("arm", [arms.industrial6, arms.skewed6])
@settings(max_examples=60, deadline=None)
@given(share=positions, start=positions)
def test_nearest_of_all(arm, share, start):
    chain, limits = arm()
    q, reference = share * limits.upper, start * limits.upper
    pose = flange_poses(chain, q[None])[0]
    found = nearest_solutions(chain, limits, pose, reference)
    assert isinstance(found, Solutions)
    assert not found.q.flags.writeable
    assert (found.q >= limits.lower).all()
    assert (found.q <= limits.upper).all()
    errors = np.abs(flange_poses(chain, found.q) - pose).max(axis=(1, 2))
    on_limit = (np.abs(found.q - limits.lower) < 1e-12) | (np.abs(found.q - limits.upper) < 1e-12)
    assert errors[~on_limit.any(axis=1)].max(initial=0.0) < 1e-9
    assert errors.max() < 3e-8
    cost = np.square(found.q - reference).sum(axis=1)
    assert (np.diff(cost) >= -1e-8).all()
    if abs(math.sin(q[4])) > 1e-6:
        assert cost[0] <= brute_force(chain, limits, pose, reference) + 1e-7


@pytest.mark.parametrize("arm", [arms.offset6, arms.scara4, arms.seven7, arms.planar3, arms.slider9])
def test_nearest_of_arms_without_closed_form(arm):
    chain, limits = arm()
    rng = np.random.default_rng(7)
    for _ in range(3):
        q = rng.uniform(limits.lower, limits.upper)
        reference = q + rng.uniform(-0.2, 0.2, chain.size)
        pose = flange_poses(chain, q[None])[0]
        found = nearest_solutions(chain, limits, pose, reference)
        assert isinstance(found, Solutions)
        assert np.abs(flange_poses(chain, found.q) - pose).max() < 1e-8
        assert (found.q >= limits.lower).all()
        assert (found.q <= limits.upper).all()
        low, high = clear_of_limits(limits, reference)
        if chain.size > 6 and ((q < low) | (q > high)).any():
            assert ((found.q[0] >= low - 1e-8) & (found.q[0] <= high + 1e-8)).all()
            continue
        # The solution is at least as near as the joint position from which the pose was computed.
        assert np.square(found.q[0] - reference).sum() <= np.square(q - reference).sum() + 1e-6


def test_full_turns():
    chain, limits = arms.industrial6()
    q = np.radians([10, 20, 30, 175, 40, -100])
    lifts = np.degrees(full_turns(chain, limits, q))
    expected = [[10, 20, 30, q4, 40, q6] for q4 in (-185, 175) for q6 in (-100, 260)]
    np.testing.assert_allclose(lifts, expected, atol=1e-9)
    endless = arms.limits_of(np.full(6, -np.inf), np.full(6, np.inf))
    assert len(full_turns(chain, arms.limits_of(-np.ones(6), np.ones(6)), q)) == 0
    found = nearest_solutions(chain, endless, flange_poses(chain, q[None])[0], q + 40 * np.pi)
    np.testing.assert_allclose(found.q[0], q + 40 * np.pi, atol=1e-9)


def stretched(chain, q):
    """Return `q` with a straight elbow, and the direction from shoulder to wrist."""
    fore = math.hypot(0.195, 0.4369 + 0.1995)
    q = q.copy()
    # Turn joint 3 so that axis 2, axis 3 and the wrist center are in line.
    q[2] = math.pi / 2 - math.atan2(0.195, 0.6364)
    pose = flange_poses(chain, q[None])[0]
    wrist = pose[:3, 3] - pose[:3, :3] @ [0, 0.238, 0]
    turn = Rotation.from_rotvec([0, 0, q[0]]).as_matrix()
    shoulder = turn @ [0, 0.2, 0.679]
    assert abs(np.linalg.norm(wrist - shoulder) - 0.89 - fore) < 1e-12
    return pose, (wrist - shoulder) / np.linalg.norm(wrist - shoulder)


@pytest.mark.parametrize("miss", [0.001, 0.041, 0.5])
def test_out_of_reach_by_a_known_distance(miss):
    chain, limits = arms.industrial6()
    pose, outwards = stretched(chain, np.array([0.3, -0.9, 0, 0.2, 0.4, 0.1]))
    pose[:3, 3] += miss * outwards
    found = nearest_solutions(chain, limits, pose, np.zeros(6))
    assert isinstance(found, Unreachable)
    assert found.kind == "reach"
    assert abs(found.miss - miss) < 1e-3
    assert found.miss_angle < 1e-3
    # Just within reach, there is a solution.
    pose[:3, 3] -= (miss + 1e-6) * outwards
    free = arms.limits_of(np.full(6, -7.0), np.full(6, 7.0))
    assert isinstance(nearest_solutions(chain, free, pose, np.zeros(6)), Solutions)


def test_out_of_reach_of_an_arm_without_closed_form():
    chain, limits = arms.planar3()
    pose = np.eye(4)
    pose[:3, 3] = [0.8 + 0.041, 0.0, 0.0]
    found = nearest_solutions(chain, limits, pose, np.full(3, 0.3))
    assert found.kind == "reach"
    assert abs(found.miss - 0.041) < 1e-3
    # A position out of the arm's plane: the miss is this position's distance from the plane.
    pose[:3, 3] = [0.5, 0.1, 0.25]
    found = nearest_solutions(chain, limits, pose, np.full(3, 0.3))
    assert found.kind == "reach"
    assert abs(found.miss - 0.25) < 1e-3
    assert found.miss_angle < 1e-3
    # An orientation that the arm can't reach.
    pose[:3, :3] = Rotation.from_euler("x", 0.2).as_matrix()
    pose[2, 3] = 0.0
    found = nearest_solutions(chain, limits, pose, np.full(3, 0.3))
    assert found.kind == "reach"
    assert abs(found.miss_angle - 0.2) < 1e-3


@pytest.mark.parametrize("sign", [-1, 1])
def test_limits_name_the_joint_and_the_excess(sign):
    chain, _ = arms.industrial6()
    q = np.radians([10, 20, -30, 40, 50, 60])
    lower, upper = q - 0.3, q + 0.3
    if sign > 0:
        upper[2] = q[2] - 0.1
    else:
        lower[2] = q[2] + 0.1
    limits = arms.limits_of(lower, upper)
    found = nearest_solutions(chain, limits, flange_poses(chain, q[None])[0], q)
    assert isinstance(found, Unreachable)
    assert found.kind == "limits"
    assert found.joint == 2
    assert abs(found.excess - sign * 0.1) < 1e-9
    np.testing.assert_allclose(found.q, q, atol=1e-9)


def test_limits_of_a_slide():
    chain, limits = arms.scara4()
    q = np.array([0.3, 0.5, 0.23, 0.1])
    found = nearest_solutions(chain, limits, flange_poses(chain, q[None])[0], np.zeros(4))
    assert isinstance(found, Unreachable)
    assert found.kind == "limits"
    assert found.joint == 2
    assert abs(found.excess - 0.03) < 1e-8


def test_the_same_every_time():
    """Results are equal each time, for arms that are read anew, and the limits aren't changed."""
    chain, limits = arms.industrial6()
    ends = limits.lower.copy(), limits.upper.copy()
    home = np.zeros(6)
    goal = flange_poses(chain, np.radians([[0, 20, -30, 90, 60, -90]]))[0]
    first = nearest_solutions(chain, limits, goal, home)
    second = nearest_solutions(*arms.industrial6(), goal, home)
    np.testing.assert_array_equal(first.q, second.q)
    np.testing.assert_array_equal((limits.lower, limits.upper), ends)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_what_is_surely_reached_has_a_solution_and_hardly_anything_is_left_unseen(seed):
    chain, limits = arms.industrial6()
    random = np.random.default_rng(seed)
    stands = random.uniform(limits.lower, limits.upper, (20, 6))
    poses = flange_poses(chain, stands)
    poses[10:, :3, 3] *= random.uniform(0.5, 3.0, (10, 1))  # some of them are out of reach
    poses[-1] = chain.base_from_flange  # a straight wrist
    sure = surely_reached(chain, limits, poses)
    found = [
        isinstance(nearest_solutions(chain, limits, pose, np.zeros(6), measures=False), Solutions)
        for pose in poses
    ]
    assert not (sure & ~np.array(found)).any()
    assert sure[:10].sum() >= 9
