"""Tests of thinning: scipy's spline through the kept points is within the tolerance of all points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from tests.convert.conversions import NAMES, converted, numbers, program_of
from yarclang.convert.course import Course
from yarclang.convert.thinning import thinned


def wave(count, seed=1.0):
    s = np.linspace(0.0, 1.0, count)[:, None]
    return 30.0 * np.sin(seed * 7.0 * s + np.arange(6)) + 10.0 * s


def farthest(points, kept):
    """Return the largest distance of `points` from the natural spline through `kept`."""
    way = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(np.radians(kept), axis=0), axis=1))))
    curve = CubicSpline(way, kept, bc_type="natural")(np.linspace(0, way[-1], 100_000))
    return cKDTree(curve).query(points)[0].max()


@settings(max_examples=8)
@given(tolerance=st.sampled_from([0.01, 0.1, 1.0]), seed=st.floats(0.2, 3.0))
def test_the_spline_keeps_the_tolerance(industrial6, tolerance, seed):
    points = wave(300, seed)
    kept = thinned(Course("JOINTS", points), 1, tolerance, industrial6, "spline").values
    assert len(kept) < 150
    assert farthest(points, kept) <= tolerance * 1.02 + 1e-3


@settings(max_examples=8)
@given(tolerance=st.sampled_from([0.01, 0.1, 1.0]), seed=st.floats(0.2, 3.0))
def test_the_path_in_time_keeps_the_tolerance(industrial6, tolerance, seed):
    points = wave(300, seed)
    times = np.linspace(0.0, 10.0, 300)
    kept = thinned(Course("JOINTS", points, times), 1, tolerance, industrial6, "timed")
    assert 2 < kept.size < 150
    spline = CubicSpline(kept.times, kept.values, bc_type="clamped")
    assert np.linalg.norm(spline(times) - points, axis=1).max() <= tolerance * (1.0 + 1e-9)


def test_thinned_points_keep_their_velocities(industrial6):
    times = np.linspace(0.0, 10.0, 300)
    points = wave(300)
    velocities = np.gradient(points, times, axis=0)
    course = Course("JOINTS", points, times, velocities=velocities)
    kept = thinned(course, 3, 0.1, industrial6, "timed")
    at = np.searchsorted(times, kept.times)
    assert (kept.values == points[at]).all()
    assert (kept.velocities == velocities[at]).all()


def test_straight_lines_need_their_ends_only(industrial6):
    points = np.linspace(np.zeros(6), np.arange(6.0), 50)
    kept = thinned(Course("JOINTS", points), 1, 1e-6, industrial6, "moves").values
    assert kept.tolist() == points[[0, -1]].tolist()


def test_corners_stay(industrial6):
    points = np.array([[0.0] * 6, [10.0] + [0.0] * 5, [10.0, 10.0] + [0.0] * 4])
    dense = np.vstack([np.linspace(points[0], points[1], 20)[:-1], np.linspace(points[1], points[2], 20)])
    kept = thinned(Course("JOINTS", dense), 1, 0.01, industrial6, "moves").values
    assert kept.tolist() == points.tolist()


def test_turns_of_poses_count(industrial6):
    turning = np.array([[0.0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 20], [2, 0, 0, 0, 0, 0]])
    assert thinned(Course("RPY", turning), 1, 1.0, industrial6, "moves").size == 3
    assert thinned(Course("RPY", turning), 1, 30.0, industrial6, "moves").size == 2


def test_a_full_turn_is_no_jump(industrial6):
    angles = np.linspace(170, 190, 21)
    poses = np.zeros((21, 6))
    poses[:, 5] = np.where(angles > 180, angles - 360, angles)
    assert thinned(Course("RPY", poses), 1, 0.5, industrial6, "moves").size == 2


def test_every_keeps_both_ends():
    rows = "".join(f"{n},0,0,0,0,0\n" for n in range(11))
    program = program_of(f"{NAMES}\n{rows}", said="deg", every=4)
    assert numbers(program)[:, 0].tolist() == [0, 4, 8, 10]
    assert "4 of 11 points are kept (one in 4)" in program


def dense(count, seconds):
    header = ",".join([*(f"j{n} [deg]" for n in range(1, 7)), "t [s]"])
    rows = "".join(
        ",".join(f"{value:.6f}" for value in (*q, seconds * number / count)) + "\n"
        for number, q in enumerate(wave(count))
    )
    return f"{header}\n{rows}"


def test_too_dense_is_told_and_thinning_cures_it():
    program, found = converted(dense(2000, 4.0))
    assert program is not None
    assert codes(found) == ["Y1512"]
    assert "--every" in found[0].help
    assert codes(converted(dense(2000, 4.0), tolerance=0.01)[1]) == []


def test_ten_thousand_rows_are_a_legal_program():
    text = dense(10_000, 100.0)
    program = program_of(text, form="spline")
    assert len(numbers(program)) == 10_000
    assert len(numbers(program_of(text))) == 10_000
    thin = program_of(text, tolerance=0.01)
    assert 10 < len(numbers(thin)) < 300
    assert "the others are within 0.01 (deg and mm) of the way" in thin


@pytest.mark.parametrize("count", [1, 2])
def test_few_points_stay(industrial6, count):
    assert thinned(Course("JOINTS", wave(count)), 1, 5.0, industrial6, "spline").size == count
