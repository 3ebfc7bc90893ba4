"""Tests of timetables that are fitted to the controller's segments."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled, planned, robot_of
from scipy.interpolate import CubicSpline

from yarclang.hir import Timetable
from yarclang.motion.curve import Curve, knot_values
from yarclang.motion.limits import Grid, bounds_of
from yarclang.motion.paths.timed import along
from yarclang.motion.timed import LATE, TooShort, _divided, _least_squares, fit_timed

ROBOT = robot_of("INDUSTRIAL6")
QUANTUM = 1e-3 / 4096
GRID = Grid(ROBOT.controller.smallest_segment, ROBOT.controller.largest_segment, QUANTUM)
DEG = np.pi / 180.0
STANDS = np.zeros(6)
WITHIN = np.full(6, 1e-4)


def path(times, degrees):
    return along(Timetable(np.array(times, float), np.array(degrees, float) * DEG), STANDS)


@settings(max_examples=300, deadline=None)
@given(st.floats(0.02, 4900.0), st.floats(0.0, 1.0))
def test_the_duration_is_divided_with_at_most_a_millisecond_more(duration, share):
    wanted = GRID.smallest * (GRID.largest / GRID.smallest) ** share
    segments, segment = _divided(duration, wanted, GRID)
    assert segment >= GRID.smallest - 1e-12
    assert segment / QUANTUM == pytest.approx(round(segment / QUANTUM), abs=1e-6)
    assert -1e-9 <= segments * segment - duration <= LATE
    # The number of segments isn't much larger than wanted.
    assert segments <= max(4, np.ceil(duration / wanted)) + 4096


@pytest.mark.parametrize("weight", [0.0, 1.0, 1e4])
@pytest.mark.parametrize("segments", [4, 5, 6, 7, 40])
def test_least_squares_are_those_of_the_whole_system(segments, weight):
    random = np.random.default_rng(segments)
    knots = np.cumsum(random.normal(size=(segments + 1, 2)), axis=0)
    found = _least_squares(knots, weight)
    ends = np.concatenate((np.tile(knots[0], (3, 1)), np.tile(knots[-1], (3, 1))))
    np.testing.assert_allclose(found[[0, 1, 2, -3, -2, -1]], ends)

    def misses(inner):
        points = np.concatenate((ends[:3], inner, ends[3:]))
        near = (knot_values(points) - knots)[1:-1]
        bend = np.diff(points, 2, axis=0)[1:-1] - np.diff(knots, 2, axis=0)
        return np.concatenate((near, np.sqrt(weight) * bend))

    count = segments - 3
    constant = misses(np.zeros((count, 2)))
    columns = []
    for number in range(count):
        unit = np.zeros((count, 2))
        unit[number] = 1.0
        columns.append((misses(unit) - constant)[:, 0])
    best = np.linalg.lstsq(np.stack(columns, axis=1), -constant, rcond=None)[0]
    np.testing.assert_allclose(found[3:-3], best, atol=1e-8)


def test_a_coarse_grid_is_taken_where_it_is_enough():
    times = np.arange(1, 21) * 0.5
    curve = fit_timed(
        path(times, np.outer(np.sin(times / 3.0), [3, 2, 1, 4, 5, 6])), WITHIN * 20, bounds_of(ROBOT), GRID
    )
    assert isinstance(curve, Curve)
    assert curve.segment == pytest.approx(GRID.largest, rel=0.05)


def test_a_larger_tolerance_takes_fewer_segments_and_overshoots_less():
    asked = path([1.0], [[20, 0, 0, 0, 0, 0]])
    curves = [fit_timed(asked, WITHIN * factor, bounds_of(ROBOT), GRID) for factor in (0.2, 1.0, 5.0)]
    assert [one.segments for one in curves] == sorted((one.segments for one in curves), reverse=True)
    peaks = [np.abs(np.diff(one.points, 2, axis=0)).max() / one.segment**2 for one in curves]
    assert peaks[2] < 1.1 * 120 * DEG
    assert peaks == sorted(peaks, reverse=True)


def test_a_table_that_is_shorter_than_any_motion():
    found = fit_timed(path([0.005], [[0.001, 0, 0, 0, 0, 0]]), WITHIN, bounds_of(ROBOT), GRID)
    assert isinstance(found, TooShort)
    assert found.shortest == pytest.approx(4 * GRID.smallest)


def test_the_clamped_spline_is_that_of_another_library():
    times, rows = [0.4, 1.0, 1.1, 2.5], np.random.default_rng(5).normal(size=(4, 6)) * 10.0
    own = path(times, rows)
    other = CubicSpline([0.0, *times], np.concatenate((np.zeros((1, 6)), rows)) * DEG, bc_type="clamped")
    at = np.linspace(0.0, 2.5, 200)
    for order in range(3):
        np.testing.assert_allclose(own.at(at, order), other(at, order), atol=1e-9)


def test_where_a_table_begins_says_where_the_robot_has_to_stand():
    _, found = planned(
        "DEFAULT (deg,s)\nP0010 MOVEJ_TIMED 5 0 0 0 0 0 [2]\nP0020 MOVEJ_TIMED 0 0 0 0 0 0 [2]"
    )
    assert codes(found) == []


def test_a_computed_stretch_is_left_to_people():
    """A fix would replace the name by a number, so none is offered."""
    program = "DEFAULT (deg,s)\nLET F = 1.1\nP0010 MOVEJ_TIMED 60 0 0 0 0 0 [1] STRETCH $F"
    _, (finding,) = compiled(program)
    assert finding.code == "Y0616"
    assert "the shortest STRETCH that works is" in finding.help
    assert finding.fix is None
    _, (finding,) = compiled(program.replace("$F", "1.1"))
    (edit,) = finding.fix.edits
    assert compiled(program.replace("$F", edit.text))[0] is not None
