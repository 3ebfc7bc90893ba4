"""Tests of splines of poses: they pass all waypoints, are twice differentiable, and have constant speed over
the share of the length.
"""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from programs import codes, planned
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from yarclang.motion.paths.pose_spline import (
    AtConstantSpeed,
    PoseSpline,
    rotations,
    through_poses,
    unit_quaternions,
)

seeds = st.integers(0, 2**32 - 1)


def drawn(seed, count=None):
    """Return random poses (w, 4, 4). Neighbours are less than half a turn apart."""
    random = np.random.default_rng(seed)
    count = count or int(random.integers(2, 8))
    poses = np.tile(np.eye(4), (count, 1, 1))
    rotation = Rotation.random(random_state=random)
    for number in range(count):
        poses[number, :3, 3] = random.uniform(-1, 1, 3)
        poses[number, :3, :3] = rotation.as_matrix()
        rotation = Rotation.from_rotvec(random.uniform(-1.7, 1.7, 3)) * rotation
    return poses


@given(seeds)
def test_the_curve_goes_through_all_way_points(seed):
    poses = drawn(seed)
    spline = through_poses(poses)
    assert isinstance(spline, PoseSpline)
    assert spline.poses(spline.positions.knots) == pytest.approx(poses, abs=1e-9)


@given(seeds)
def test_position_and_orientation_are_smooth_twice(seed):
    """The one-sided second differences at each waypoint agree, to the order of the step."""
    spline = through_poses(drawn(seed, 5))
    knots = spline.positions.knots
    assume(np.diff(knots).min() > 0.02)
    step = 1e-4
    for knot in knots[1:-1]:
        left = spline.poses(knot + step * np.arange(-3, 1))[:, :3].reshape(4, -1)
        right = spline.poses(knot + step * np.arange(4))[:, :3].reshape(4, -1)
        slopes = [
            (11 * left[3] - 18 * left[2] + 9 * left[1] - 2 * left[0]) / 6 / step,
            (-11 * right[0] + 18 * right[1] - 9 * right[2] + 2 * right[3]) / 6 / step,
        ]
        bends = [
            (2 * left[3] - 5 * left[2] + 4 * left[1] - left[0]) / step**2,
            (2 * right[0] - 5 * right[1] + 4 * right[2] - right[3]) / step**2,
        ]
        size = 1 + np.abs(bends).max()
        assert slopes[0] == pytest.approx(slopes[1], abs=1e-4 * size)
        assert bends[0] == pytest.approx(bends[1], abs=0.05 * size)


@given(seeds)
def test_it_is_scipy_s_natural_spline_over_distance_and_turn(seed):
    poses = drawn(seed)
    turns = Rotation.from_matrix(poses[:, :3, :3])
    quaternions = turns.as_quat()
    for number in range(1, len(quaternions)):
        if quaternions[number] @ quaternions[number - 1] < 0:
            quaternions[number] *= -1
    angles = (turns[:-1].inv() * turns[1:]).magnitude()
    chords = np.hypot(np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1), 0.1 * angles)
    knots = np.concatenate(([0], np.cumsum(chords))) / chords.sum()
    s = np.linspace(0, 1, 101)
    made = through_poses(poses).poses(s)
    assert made[:, :3, 3] == pytest.approx(
        CubicSpline(knots, poses[:, :3, 3], bc_type="natural")(s), abs=1e-9
    )
    expected = Rotation.from_quat(CubicSpline(knots, quaternions, bc_type="natural")(s))
    assert (expected.inv() * Rotation.from_matrix(made[:, :3, :3])).magnitude() == pytest.approx(0, abs=1e-6)


@given(seeds)
def test_tangents_are_the_derivatives(seed):
    spline = through_poses(drawn(seed, 4))
    s, step = np.linspace(0.05, 0.95, 19), 1e-6
    before, behind = spline.poses(s - step), spline.poses(s + step)
    spin = Rotation.from_matrix(behind[:, :3, :3]) * Rotation.from_matrix(before[:, :3, :3]).inv()
    tangents = spline.tangents(s)
    size = np.abs(tangents).max()
    assert tangents[:, :3] == pytest.approx(
        (behind[:, :3, 3] - before[:, :3, 3]) / (2 * step), abs=1e-3 * size
    )
    assert tangents[:, 3:] == pytest.approx(spin.as_rotvec() / (2 * step), abs=1e-3 * size)


@given(seeds)
def test_at_constant_speed_equal_shares_are_equal_ways(seed):
    spline = through_poses(drawn(seed, 4))
    assume(spline.slowest > 0.02 * spline.length)
    steady = AtConstantSpeed(spline)
    shares = np.linspace(0, 1, 41)
    # Measure the length up to each share by Simpson's rule along the chord parameter.
    ends = spline.at_length(shares)
    fine = np.linspace(ends[:-1], ends[1:], 401, axis=1)
    speed = np.linalg.norm(spline.positions.slope_at(fine.ravel()), axis=1).reshape(fine.shape)
    weights = np.ones(401)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    ways = (speed @ weights) * (fine[:, 1] - fine[:, 0]) / 3
    assert ways == pytest.approx(spline.length / 40, rel=1e-5)
    assert np.linalg.norm(steady.tangents(shares)[:, :3], axis=1) == pytest.approx(spline.length, rel=1e-9)
    step = 1e-6
    inner = shares[1:-1]
    moved = steady.poses(inner + step)[:, :3, 3] - steady.poses(inner - step)[:, :3, 3]
    assert np.linalg.norm(moved, axis=1) / (2 * step) == pytest.approx(spline.length, rel=1e-4)


def test_equal_neighbours_count_once():
    poses = drawn(1, 4)
    doubled = poses[[0, 0, 1, 2, 2, 2, 3]]
    s = np.linspace(0, 1, 50)
    assert through_poses(doubled).poses(s) == pytest.approx(through_poses(poses).poses(s), abs=1e-12)
    assert through_poses(poses[[0, 0, 0]]) is None


def test_half_a_turn_between_neighbours_is_told_by_its_number():
    poses = drawn(2, 4)
    poses[2, :3, :3] = Rotation.from_rotvec([np.pi, 0, 0]).as_matrix() @ poses[1, :3, :3]
    assert through_poses(poses) == 2


@given(st.lists(seeds, min_size=1, max_size=5))
def test_quaternions_and_rotations_are_each_other_s_inverse(several):
    matrices = np.array([Rotation.random(random_state=seed).as_matrix() for seed in several])
    quaternions = unit_quaternions(matrices)
    assert np.linalg.norm(quaternions, axis=1) == pytest.approx(1)
    assert rotations(quaternions) == pytest.approx(matrices, abs=1e-12)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, -1, 1)])
def test_quaternions_of_half_turns(axis):
    unit = np.array(axis) / np.linalg.norm(axis)
    matrix = Rotation.from_rotvec(np.pi * unit).as_matrix()
    assert rotations(unit_quaternions(matrix[None]))[0] == pytest.approx(matrix, abs=1e-12)


def test_a_program_s_curve_goes_through_its_poses():
    text = """DEFAULT {TCP} [6] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0
P0020 MOVEL_SPLINE 60 1134.4 1176 0 0 10; 120 1174.4 1226 0 0 20; 180 1174.4 1126 5 0 0
"""
    plan, diagnostics = planned(text)
    assert codes(diagnostics) == []
    path = plan.motions[1].path
    knots = path.frame.positions.knots
    expected = [[0, 1174.4, 1176], [60, 1134.4, 1176], [120, 1174.4, 1226], [180, 1174.4, 1126]]
    assert path.frame.poses(knots)[:, :3, 3] * 1e3 == pytest.approx(np.array(expected), abs=1e-6)


@pytest.mark.parametrize("count", [3, 17, 300, 5_000, 40_000])
def test_pieces_of_a_leg_are_as_many_as_its_bends_need(count):
    angles = np.linspace(0.0, count / 40.0, count)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, 0, 3], poses[:, 1, 3] = 0.08 * np.cos(angles), 0.08 * np.sin(angles)
    poses[:, 2, 3] = 1e-5 * np.arange(count)
    spline = through_poses(poses)
    pieces = len(spline._fine) - 1
    assert pieces <= max(16_384 * 2, 8 * (count - 1))
    length = np.linalg.norm([0.08 * angles[-1], 1e-5 * (count - 1)])
    assert spline.length == pytest.approx(length, rel=1e-3)


@pytest.mark.parametrize("count", [40, 1_500])
def test_legs_with_cusps_have_no_end_of_pieces(count):
    """The path goes back and forth, so the velocity is zero at some point of each leg. The number of pieces
    is still limited.
    """
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, 0, 3] = np.where(np.arange(count) % 2, 0.01, 0.0)
    spline = through_poses(poses)
    assert len(spline._fine) <= 1024 * count
    assert spline.length == pytest.approx(0.01 * (count - 1), rel=0.2)


@given(seeds)
def test_poses_that_creep_count_as_far_as_they_get(seed):
    random = np.random.default_rng(seed)
    poses = drawn(seed, 4)
    several = np.repeat(poses, random.integers(1, 6, 4), axis=0)
    several[:, :3, 3] += random.uniform(-2e-13, 2e-13, several[:, :3, 3].shape)
    spline = through_poses(several)
    assert len(spline.positions.knots) == 4
    assert np.diff(spline.positions.knots).min() > 0
