"""Goals as programs: the waypoints that count, their times, and the meaning of the text."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.certify.certify_bench import railed
from yarclang.hir import TimedMove
from yarclang.pipeline.stages import Request, check_program
from yarclang.robot.description import load_robot
from yarclang.ros.goal import LEAD_SHARE, START_WITHIN, goal_text, timetable
from yarclang.ros.motion import Goal
from yarclang.ros.simple_message import TrajectoryPoint
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

ROBOT = load_robot("INDUSTRIAL6").value
LIMITS = ROBOT.limits


def goal(rows, durations):
    points = (
        TrajectoryPoint(n, (*np.float32(row).tolist(), *(0.0,) * (10 - len(row))), 0.1, duration)
        for n, (row, duration) in enumerate(zip(rows, durations, strict=True))
    )
    return Goal(1, tuple(points))


def test_a_first_point_where_the_robot_stands_is_the_start():
    stands = np.full(6, 0.1)
    rows = [stands + 0.5 * START_WITHIN, stands + 0.1, stands + 0.2]
    positions, times = timetable(ROBOT, goal(rows, [10.0, 0.5, 0.25]), stands)
    assert np.allclose(positions, rows[1:], atol=1e-6)
    assert times.tolist() == [0.5, 0.75]


def test_another_first_point_takes_a_time_of_the_limits():
    stands = np.zeros(6)
    far = np.array([0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    for junk in (10.0, 0.5, -3.0, float("nan")):
        positions, times = timetable(ROBOT, goal([far, far + 0.1], [junk, 0.5]), stands)
        assert len(positions) == 2
        lead = times[0]
        assert times[1] - lead == pytest.approx(0.5)
        assert 1.875 * 0.5 / lead <= LEAD_SHARE * LIMITS.velocity[0] * 1.0001
        assert 5.774 * 0.5 / lead**2 <= LEAD_SHARE * LIMITS.acceleration[0] * 1.0001
        assert lead < 10.0


def test_a_single_point_is_gone_to_however_near():
    near = np.full(6, 0.5 * START_WITHIN)
    positions, times = timetable(ROBOT, goal([near], [10.0]), np.zeros(6))
    assert len(positions) == len(times) == 1
    assert 0.1 <= times[0] < 1.0


def test_a_single_point_where_the_robot_stands_is_nothing():
    stands = np.full(6, 0.3)
    positions, times = timetable(ROBOT, goal([stands], [2.0]), stands)
    assert positions.shape == (0, 6)
    assert times.shape == (0,)


def test_a_limit_in_single_precision_is_the_limit():
    limit = np.where(np.isfinite(LIMITS.upper), LIMITS.upper, 1.0)
    rounded = np.nextafter(np.float32(limit), np.float32(np.inf)).astype(float)
    assert (rounded > limit).all()
    (found,), _ = timetable(ROBOT, goal([rounded], [1.0]), np.zeros(6))
    assert (found <= LIMITS.upper).all()
    beyond = limit + 1e-3
    (found,), _ = timetable(ROBOT, goal([beyond], [1.0]), np.zeros(6))
    assert np.allclose(found, beyond, atol=1e-6)  # the position isn't clipped, because the proof refuses it


rows = st.lists(st.lists(st.floats(-1.0, 1.0, width=32), min_size=6, max_size=6), min_size=1, max_size=8)


@given(rows, st.floats(0.0078125, 5.0, width=32))
@settings(max_examples=40, deadline=None)
def test_the_text_means_the_timetable(rows, duration):
    means_the_timetable(ROBOT, rows, duration, np.full(6, -1.5))


def test_sliding_joints_are_metres_on_the_wire_and_mm_in_the_text():
    means_the_timetable(
        railed(), [[0.8, 0.1, -0.2, 0.15, 0.3], [-0.5, 0.2, 0.1, -0.1, 0.0]], 2.0, np.zeros(5)
    )


def means_the_timetable(robot, rows, duration, stands):
    """Check that the text of a goal means its waypoints and times."""
    positions, times = timetable(robot, goal(rows, [duration] * len(rows)), stands)
    assert len(times) == len(rows)
    text = goal_text(robot, positions, times)
    checked = check_program(parse(SourceFile("goal", text)).value, Request(robot, start=stands))
    assert [one.code for one in checked.diagnostics if one.is_error] == []
    (step,) = checked.value.steps
    assert isinstance(step, TimedMove)
    found = step.table
    assert np.abs(found.positions - positions).max() < 1e-9
    assert np.abs(found.times - times).max() < 1e-6
