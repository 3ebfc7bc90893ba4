"""Tests of single details on which a certificate depends."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.certify.certify_bench import industrial6, origin
from yarclang import hir
from yarclang.certify.flow import _stands_elsewhere
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.joint import JointLines, straight_deviations
from yarclang.certify.read.layout import Layout, Place, moving_at_ends
from yarclang.certify.read.text import Barred, Run, Stood
from yarclang.motion.limits import Bounds
from yarclang.robot.model import Tolerance


def _cubics(x=0.0, v=0.0, a=0.0, j=0.0, h=0.5):
    one = np.ones((1, 1))
    return Cubics(x * one, v * one, a * one, j * one, np.array([h]))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_peaks_at_a_segments_end_count(sign):
    assert _cubics(j=sign * 4.0).acceleration_peaks()[0, 0] == 2.0
    assert _cubics(a=sign, j=sign * 4.0).acceleration_peaks()[0, 0] == 3.0
    assert _cubics(a=sign * 3.0, j=-sign * 4.0).acceleration_peaks()[0, 0] == 3.0
    assert _cubics(v=sign, a=sign * 2.0).velocity_peaks()[0, 0] == 2.0
    assert _cubics(v=-sign, a=sign * 8.0).velocity_peaks()[0, 0] == 3.0
    assert _cubics(j=sign * 4.0).jerk_peaks()[0, 0] == 4.0
    low, high = _cubics(v=sign).position_range()
    assert {low[0, 0], high[0, 0]} == {0.0, sign * 0.5}


@pytest.mark.parametrize("moved", [1, 2, 3, None])
def test_rest_takes_three_equal_points(moved):
    control = np.zeros((6, 2))
    if moved is not None:
        control[-moved, 1] = 1e-12
    motion = hir.JointMove(origin(0), hir.JointGoal(np.zeros(2)), "LSPB", hir.Timing(1.0))
    place = Place(0, motion, 0, 3, (1, 3))
    layout = Layout(control, np.arange(3), np.full(3, 0.1), (place,), control[:1], control[-1:])
    assert moving_at_ends(layout) == ([] if moved is None else [place])


def _run(*point):
    return Run(5.0, 1, np.array([point]), np.array([2]))


def _barrier(kind):
    return Barred(9, kind, 1, "-", None, "")


@pytest.mark.parametrize(
    ("off", "is_fault"), [(0.0, False), (0.99, False), (1.01, True), (-1.01, True), (1.5, True)]
)
def test_where_a_rapid_leads_is_where_the_robot_stands_but_for_the_slack(off, is_fault):
    slack = np.array([1e-3, 2e-3])
    for joint in range(2):
        there = np.array([1.0, 2.0])
        there[joint] += off * slack[joint]
        course = (_run(1.0, 2.0), _barrier("wait"), Stood(4, there))
        found = list(_stands_elsewhere(SimpleNamespace(course=course), np.zeros(2), slack))
        assert bool(found) == is_fault
        ways = (_barrier("when"), _run(1.0, 2.0), _barrier("else"), _run(*there), _barrier("end"))
        found = list(_stands_elsewhere(SimpleNamespace(course=ways), np.zeros(2), slack))
        assert bool(found) == is_fault
        # A branch without commands ends at the position of the WHEN.
        ways = (_run(1.0, 2.0), _barrier("when"), _run(*there), _barrier("end"))
        found = list(_stands_elsewhere(SimpleNamespace(course=ways), np.zeros(2), slack))
        assert bool(found) == is_fault


def test_ways_have_a_beginning_and_an_end():
    for course in (
        (_barrier("when"),),
        (_barrier("else"),),
        (_barrier("end"),),
        (_barrier("when"), _barrier("else"), _barrier("else")),
    ):
        assert list(_stands_elsewhere(SimpleNamespace(course=course), np.zeros(2), np.ones(2)))


@pytest.mark.parametrize("short", [0.0, 1e-6, 1e-2])
def test_a_line_that_stops_short_is_as_far_off_as_it_stops_short(short):
    robot = industrial6()
    goal = np.array([[1.0, -0.5, 0.0, 0.2, 0.0, 0.0]])
    share = np.minimum(np.linspace(0.0, 1.0, 8), 1.0 - short)
    control = share[:, None] * goal
    first = np.array([0])
    held = JointLines(np.zeros((1, 6)), goal, np.array([[False, False]]))
    off, covered = straight_deviations(control, first, held, robot, Tolerance())
    np.testing.assert_allclose(off[0], short * np.abs(goal[0]), atol=1e-15)
    assert covered.tolist() == [[0.0, 1.0]]
    # A motion that flows on into the next one may leave its line before the end.
    free = JointLines(np.zeros((1, 6)), goal, np.array([[False, True]]))
    off, covered = straight_deviations(control, first, free, robot, Tolerance())
    assert off.max() < 1e-15
    assert covered[0, 1] < 1.0


def _bounds():
    counts = np.array([[2.0, 0.0], [1.0, -3.0]])
    return Bounds(
        np.array([1.0, 2.0]), np.array([3.0, 5.0]), np.array([7.0, 11.0]), counts, np.array([13.0, 17.0])
    )


@pytest.mark.parametrize("joint", [0, 1])
@pytest.mark.parametrize("at", range(6))
def test_each_control_point_asks_for_its_segment_time(at, joint):
    points = np.zeros((6, 2))
    points[at:, joint] = 1.0  # one step, before point `at`
    if at == 0:
        points[0, joint] = 0.0
    bounds = _bounds()
    step = np.diff(points, axis=0)
    wanted = {
        "velocity": (np.abs(step) / bounds.velocity).max(),
        "motor speed": (np.abs(step @ bounds.counts.T) / bounds.motor_velocity).max(),
        "acceleration": np.sqrt((np.abs(np.diff(step, axis=0)) / bounds.acceleration).max()),
        "jerk": np.cbrt((np.abs(np.diff(step, axis=0, n=2)) / bounds.jerk).max()),
    }
    found = {demand.kind: demand.segment for demand in bounds.demands(points)}
    assert set(found) == set(wanted)
    for kind, segment in wanted.items():
        assert found[kind] == pytest.approx(segment, rel=1e-12), kind
