"""Tests of the time that a click on the path selects."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.view.picking import beside, picked_time
from yarclang.view.stage import Way

EYE = np.array([0.0, 0.0, 5.0])
SHARES = st.floats(0.0, 1.0)


def way(*stretches):
    points = np.concatenate([np.array(one, dtype=float) for one in stretches])
    breaks = np.cumsum([0, *(len(one) for one in stretches)])
    times = np.arange(len(points), dtype=float)
    return Way(times, points, np.zeros(len(points)), breaks, np.arange(len(stretches)))


TWO = way([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[3, 3, 0], [3, 4, 0]])


@given(SHARES, st.integers(0, 1))
def test_a_click_on_the_path_is_the_time_there(share, line):
    a, b = TWO.points[line], TWO.points[line + 1]
    assert picked_time(TWO, EYE, a + share * (b - a) - EYE) == pytest.approx(line + share, abs=1e-6)


@pytest.mark.parametrize("place", [[0.5, 0.5, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 10.0]])
def test_beside_the_path_nothing_is_meant(place):
    """A click beside the path, between two sections of the path, or behind the eye selects nothing."""
    assert picked_time(TWO, EYE, np.array(place) - EYE) is None


def test_a_single_point_is_no_path():
    assert picked_time(way([[0, 0, 0]]), EYE, -EYE) is None


def test_the_nearest_marker():
    points = np.array([[0.0, 0.0, 9.0], [0.1, 0.0, 0.0], [1.0, 0.0, 0.0]])
    number, angle = beside(points, EYE, -EYE)
    assert (number, angle) == (1, pytest.approx(np.arctan2(0.1, 5.0)))
    assert beside(points[:1], EYE, -EYE) == (-1, np.inf)
    assert beside(points[:0], EYE, -EYE) == (-1, np.inf)
