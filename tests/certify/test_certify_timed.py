"""Tests of the deviation of a text from a timetable at equal times. The bound is never below dense samples
and hardly above them, and texts that differ from the table are refused.
"""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import BPoly, CubicSpline

from tests.certify.certify_bench import (
    DEG,
    Job,
    emit,
    industrial6,
    inverted,
    origin,
    program,
    railed,
    sample,
)
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.timed import largest_difference, programmed
from yarclang.robot.model import Tolerance

START = np.array([10, 20, -30, 40, 50, -60]) * DEG
TIMES = np.array([0.73, 1.5, 2.31, 2.4, 4.0])
KINDS = ("positions", "velocities", "accelerations")


def table_of(kind, *, begins=False, start=START, seed=3):
    """Return a table of a gentle motion from `start`, and its path by another library."""
    random = np.random.default_rng(seed)
    times = np.concatenate(([0.0], TIMES))
    shape = CubicSpline(
        [0, 1.1, 2.6, 4.0],
        start + np.concatenate((np.zeros((1, 6)), random.uniform(-0.15, 0.15, (3, 6)))),
        bc_type="clamped",
    )
    q, v, a = (shape(times, order) for order in range(3))
    v[[0, -1]] = 0.0
    a[0] = a[0] if begins else 0.0
    rows = slice(0 if begins else 1, None)
    table = hir.Timetable(
        times[rows],
        q[rows],
        None if kind == "positions" else v[rows],
        a[rows] if kind == "accelerations" else None,
    )
    if kind == "positions":
        return table, CubicSpline(times, q, bc_type="clamped")
    parts = [q, v] if kind == "velocities" else [q, v, a]
    return table, BPoly.from_derivatives(times, np.stack(parts, axis=1))


def timed(table, within=1e-4, stretch=1.0):
    duration = float(table.times[-1]) * stretch
    return hir.TimedMove(origin(0, "MOVEJ_TIMED"), table, np.full(6, within), stretch, hir.Timing(duration))


def executed(path, duration, segments):
    """Return move lines through the path at nearly all knots."""
    return inverted(path(np.linspace(0.0, duration, segments + 1)))


def proved(motion, points, tm, robot=None, start=START):
    robot = robot or industrial6()
    job = Job(motion, points, tm)
    return certify(emit(robot, start, [job]), program(start, [job]), robot, Tolerance())


def codes(result):
    return sorted({one.code for one in result.diagnostics if one.is_error})


@pytest.mark.parametrize("begins", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_the_path_of_a_table_is_that_of_another_library(kind, begins):
    table, path = table_of(kind, begins=begins)
    way = programmed(table, START)
    u = np.linspace(0.0, 1.0, 33)
    for piece, bezier in enumerate(way.bezier):
        begin, end = way.times[piece : piece + 2]
        own = BPoly(bezier[:, None], [0.0, 1.0])(u)
        np.testing.assert_allclose(own, path(begin + u * (end - begin)), atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("segments", "tm"), [(80, "50"), (160, "25"), (200, "20")])
def test_the_bound_is_never_below_the_truth_and_close_to_it(kind, segments, tm):
    table, path = table_of(kind)
    points = np.round(executed(path, 4.0, segments) / DEG, 9) * DEG
    result = proved(timed(table, within=1.0), points, tm)
    deviation = result.value.commands[0].deviation
    t, q, *_ = sample(START, points, float(tm) * 1e-3, per_segment=40)
    truth = np.abs(q - path(t)).max()
    assert truth - 1e-10 <= deviation.angle <= 4.0 * truth
    # If the tolerance is exceeded, intervals are halved, so the bound becomes close.
    near = proved(timed(table, within=1.02 * truth), points, tm)
    assert near.value.commands[0].deviation.angle <= 1.02 * truth + 1e-9
    assert "Y1159" not in codes(near)
    assert "Y1159" in codes(proved(timed(table, within=0.999 * truth), points, tm))


def test_a_text_in_time_but_early_on_the_way_is_refused():
    table, path = table_of("positions")
    duration, count = 4.0, 160
    at = np.linspace(0.0, duration, count + 1)
    early = inverted(path(at + 0.004 * np.sin(np.pi * at / duration)))
    result = proved(timed(table), early, "25")
    assert "Y1159" in codes(result)
    message = next(one.message for one in result.diagnostics if one.code == "Y1159")
    assert "of its timetable" in message
    assert "after its start" in message


@pytest.mark.parametrize("point", [0, 40, 156])
@pytest.mark.parametrize("joint", [0, 5])
def test_each_point_counts(point, joint):
    table, path = table_of("velocities")
    points = executed(path, 4.0, 160)
    well = proved(timed(table, within=2e-3), points, "25")
    assert "Y1159" not in codes(well)
    points[point, joint] += 5e-3
    assert "Y1159" in codes(proved(timed(table, within=2e-3), points, "25"))


def test_another_end_is_refused():
    table, path = table_of("positions")
    points = executed(path, 4.0, 160)
    points[-1, 2] += 2e-4
    assert "Y1160" in codes(proved(timed(table), points, "25"))


@pytest.mark.parametrize(
    ("tm", "fits"), [("25", True), ("25.0048828125", True), ("25.00732421875", False), ("24.9921875", False)]
)
def test_it_takes_the_time_of_the_table_within_a_millisecond(tm, fits):
    table, path = table_of("positions")
    points = executed(path, 4.0, 160)
    assert ("Y1156" not in codes(proved(timed(table, within=1e-2), points, tm))) == fits


def test_a_stretched_table_takes_longer_and_is_the_same_way():
    table, path = table_of("accelerations")
    points = executed(path, 4.0, 160)
    assert codes(proved(timed(table, within=1e-2, stretch=2.0), points, "50")) == []
    assert "Y1156" in codes(proved(timed(table, within=1e-2), points, "50"))


def test_a_table_that_begins_elsewhere_is_refused():
    table, path = table_of("positions", begins=True)
    points = executed(path, 4.0, 160)
    assert "Y1159" not in codes(proved(timed(table, within=1e-2), points, "25"))
    moved = table.positions.copy()
    moved[0, 1] += 2e-2
    elsewhere = replace(table, positions=moved)
    result = proved(timed(elsewhere, within=1e-2), points, "25")
    assert any("begins with J2" in one.message for one in result.diagnostics if one.code == "Y1159")


def test_a_text_that_stands_still_is_refused():
    table, _ = table_of("positions")
    job = Job(timed(table), np.tile(START, (158, 1)), "25")
    found = codes(
        certify(emit(industrial6(), START, [job]), program(START, [job]), industrial6(), Tolerance())
    )
    assert found == ["Y1160"]


def test_the_jerk_is_not_judged_and_limits_are():
    table, path = table_of("positions")
    points = executed(path, 4.0, 160)
    quick = replace(table, times=table.times / 5.0)
    result = proved(timed(quick, within=1e-2), points, "5")
    assert "Y1157" in codes(result)
    (command,) = result.value.commands
    assert command.kind == "timed"


def test_sliding_joints_are_held_to_lengths():
    robot = railed()
    start = np.zeros(5)
    end = np.array([0.2, 0.1, 0.1, 0.05, 0.2])
    table = hir.Timetable(np.array([4.0]), end[None])
    path = CubicSpline([0.0, 4.0], np.stack([start, end]), bc_type="clamped")
    motion = hir.TimedMove(origin(0), table, np.array([1e-4, 1e-3, 1e-3, 1e-4, 1e-3]), 1.0, hir.Timing(4.0))
    points = executed(path, 4.0, 160)
    assert "Y1159" not in codes(proved(motion, points, "25", robot, start))
    points[80, 3] += 3e-4
    result = proved(motion, points, "25", robot, start)
    assert any(
        "J4" in one.message and " mm" in one.message for one in result.diagnostics if one.code == "Y1159"
    )
    assert result.value.commands[0].tolerance == Tolerance(1e-4, 1e-3)


def test_a_long_text_that_is_far_away_costs_no_more_memory():
    """If the deviation is too large already at the border of an interval, the interval isn't divided any
    further.
    """
    rows = 3000
    times = np.arange(1, rows + 1) * 0.1
    table = hir.Timetable(times, np.sin(times)[:, None] * np.ones(6), None, None)
    way = programmed(table, np.zeros(6))
    still = np.zeros((rows, 6))
    cubics = Cubics(still + 2.0, still, still, still, np.full(rows, 0.1))
    tracemalloc.start()
    most, _ = largest_difference(cubics, way, np.full(6, 1e-4))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert (most > 2.9).all()
    assert peak < 40 * way.bezier.nbytes
