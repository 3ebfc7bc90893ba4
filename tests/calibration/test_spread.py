"""Tests of the errors of calibrations that errors of touches cause, compared with finite differences."""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from yarclang.calibration.frame import find_frame
from yarclang.calibration.spread import frame_spread, helpful_tilt, tip_spread
from yarclang.calibration.tool import find_tip
from yarclang.units import DEG

STEP = 1e-6


def poses(rotations, tip=(0.02, 0.13, 0.21)):
    made = np.tile(np.eye(4), (len(rotations), 1, 1))
    made[:, :3, :3] = rotations.as_matrix()
    made[:, :3, 3] = np.array([0.9, 0.2, 0.5]) - rotations.apply(tip)
    return made


def moved(solve, places):
    """Return the derivatives of the result with respect to all coordinates of the places (m, 3 k), by central
    differences.
    """
    columns = []
    for index in np.ndindex(places.shape):
        ends = []
        for side in (STEP, -STEP):
            other = places.copy()
            other[index] += side
            ends.append(solve(other))
        columns.append((ends[0] - ends[1]) / (2 * STEP))
    return np.array(columns).T


@exercises(told=0.5)
@given(st.integers(4, 8), st.integers(0, 10**6), st.floats(0.2, 1.5))
def test_the_tip_errs_as_its_touches_say(tally, count, seed, tilt):
    turns = Rotation.from_rotvec(tilt * np.random.default_rng(seed).uniform(-1, 1, (count, 3)))
    stand = poses(turns)
    spread = tip_spread(stand[:, :3, :3], error=1.0)
    tally.count("told", find_tip(stand).value is not None)
    if find_tip(stand).value is None:
        return

    def tip(places):
        other = stand.copy()
        other[:, :3, 3] = places
        return find_tip(other).value.flange_from_tip

    slope = moved(tip, stand[:, :3, 3].copy())
    covariance = spread.directions.T @ np.diag(spread.axes**2) @ spread.directions
    np.testing.assert_allclose(covariance, slope @ slope.T, rtol=1e-4, atol=1e-6 * covariance.max())
    assert spread.axes[0] >= spread.axes[1] >= spread.axes[2]


@exercises(told=0.4)
@given(st.integers(1, 5), st.integers(0, 10**6))
def test_the_frame_errs_as_its_points_say(tally, count, seed):
    chance = np.random.default_rng(seed)
    flat = np.column_stack(
        (chance.uniform(-0.5, 0.5, count), chance.uniform(0.05, 0.5, count), np.zeros(count))
    )
    flat = np.vstack(([0, 0, 0], [chance.uniform(0.05, 0.6), 0, 0], flat))
    turn = Rotation.random(random_state=seed)
    points = turn.apply(flat) + np.array([0.9, 0.1, 0.4])
    if find_frame(points[0], points[1], list(points[2:])).value is None:
        return
    tally.count("told", True)

    def turned(places):
        found = find_frame(places[0], places[1], list(places[2:])).value.base_from_frame
        return Rotation.from_matrix(turn.as_matrix().T @ found[:3, :3]).as_rotvec()

    slope = moved(turned, points)
    spread = frame_spread(points, error=1.0)
    np.testing.assert_allclose(spread.turns, np.linalg.norm(slope, axis=1), rtol=1e-4)
    # `spread.at` bounds the error at any place, however errors of origin and orientation are correlated
    for way in Rotation.random(5, random_state=seed).as_matrix()[:, 0]:
        place = points[0] + 0.5 * way
        parts = np.hstack((np.eye(3), np.zeros((3, 3 * len(points) - 3))))
        crossed = turn.as_matrix() @ slope
        errors = (
            parts
            + np.array([np.cross(crossed[:, at], place - points[0]) for at in range(crossed.shape[1])]).T
        )
        assert np.sqrt(np.linalg.eigvalsh(errors @ errors.T)[-1]) <= spread.at(0.5) * (1 + 1e-9)


def test_tilts_about_one_axis_leave_the_tip_open_along_it():
    about_y = Rotation.from_rotvec(np.outer(np.radians([0, 20, 40, -25]), [0, 1, 0])).as_matrix()
    spread = tip_spread(about_y)
    assert np.isinf(spread.axes[0])
    np.testing.assert_allclose(np.abs(spread.directions[0]), [0, 1, 0], atol=1e-9)
    tilt = helpful_tilt(about_y)
    assert tilt.axis != 1
    more = np.concatenate(
        (about_y, about_y[-1:] @ Rotation.from_euler("xyz"[tilt.axis], tilt.angle).as_matrix())
    )
    assert np.isfinite(tip_spread(more).axes[0])


@pytest.mark.parametrize("tilt", [5.0, 10.0, 20.0])
def test_a_touch_that_is_advised_does_what_is_said(tilt):
    sides = Rotation.from_rotvec(
        np.radians(tilt) * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0]])
    ).as_matrix()
    found = helpful_tilt(sides)
    turn = Rotation.from_euler("xyz"[found.axis], found.angle).as_matrix()
    reached = tip_spread(np.concatenate((sides, sides[-1:] @ turn))).axes[0]
    assert reached == pytest.approx(found.longest)
    assert found.longest < tip_spread(sides).axes[0]


def test_first_touches():
    assert np.isinf(tip_spread(np.eye(3)[None]).axes).all()
    assert np.isinf(frame_spread(np.zeros((1, 3))).turns).all()
    two = frame_spread(np.array([[0, 0, 0], [0.1, 0, 0]]), error=0.0005)
    assert two.turns[2] == pytest.approx(0.0005 * np.sqrt(2) / 0.1)
    assert np.isinf(two.turns[0])
    line = frame_spread(np.array([[0, 0, 0], [0.1, 0, 0], [0.3, 0, 0]]))
    assert np.isinf(line.turns[0])
    assert line.turns[2] > 0.1 * DEG
    same = frame_spread(np.zeros((4, 3)))
    assert np.isinf(same.turns).all()
