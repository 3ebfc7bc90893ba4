"""Tests of choosing the points of a path to draw: its shape and its slow places are kept, whatever its
length.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.view.detail import FINEST, drawn_lines, exact_lines
from yarclang.view.stage import Way


def way_of(places):
    """Return a path through places (N, 3) [m], in which each segment begins and ends at rest."""
    points = np.repeat(places, 2, axis=0)[1:-1]
    count = len(points) // 2
    return Way(
        np.arange(len(points)) * 0.02,
        points,
        np.full(len(points), 0.05),
        np.arange(0, len(points) + 1, 2),
        np.arange(count),
    )


def spiral(count):
    turn = np.arange(count) * 0.025
    radius = 0.08 + 0.02 * np.cos(turn / 40)
    return np.column_stack((0.2 + radius * np.cos(turn), 1.05 + radius * np.sin(turn), np.full(count, 1.0)))


def away(point, first, second):
    """Return the distance of each point (N, 3) from the nearest of the lines (L, 3) [m]."""
    chord = second - first
    square = np.maximum(np.einsum("li,li->l", chord, chord), 1e-30)
    found = np.empty(len(point))
    for number, one in enumerate(point):
        share = np.clip(((one - first) * chord).sum(axis=1) / square, 0.0, 1.0)
        found[number] = np.linalg.norm(first + share[:, None] * chord - one, axis=1).min()
    return found


@pytest.mark.parametrize("count", [1_000, 100_000])
def test_the_lines_are_bounded_and_near_the_path(count):
    way = way_of(spiral(count))
    values = np.full(len(way.points), 50.0)
    slow = len(values) // 3
    values[slow] = 5.0
    drawn = drawn_lines(way, values, 100.0)
    assert len(drawn.first) <= min(count, 20_000)
    assert slow in drawn.first, "a slow place isn't seen"
    assert drawn.first[0] == 0
    assert drawn.second[-1] == len(way.points) - 1
    some = way.points[:: max(len(way.points) // 300, 1)]
    assert away(some, way.points[drawn.first], way.points[drawn.second]).max() <= drawn.off * (1.0 + 1e-6)
    assert (drawn.off == FINEST) == (count == 1_000)


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(*[st.integers(-3, 3)] * 3), min_size=2, max_size=40),
    st.lists(st.floats(0.0, 1.0), min_size=80, max_size=80),
)
def test_any_path_is_drawn_as_it_is(places, values):
    way = way_of(np.array(places, dtype=np.float64) * 0.01)
    shown = np.array(values)[: len(way.points)]
    drawn = drawn_lines(way, shown)
    assert (drawn.first < drawn.second).all()
    assert away(way.points, way.points[drawn.first], way.points[drawn.second]).max() <= FINEST * (1.0 + 1e-6)
    # the colours of omitted points are between those of the drawn ones
    for first, second in zip(drawn.first, drawn.second, strict=True):
        assert np.ptp(shown[first : second + 1]) <= abs(shown[second] - shown[first]) + 2 * 0.02 + 1e-9


def test_nothing_is_drawn_where_nothing_hangs_together():
    places = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.5, 0, 0], [0.6, 0, 0]])
    way = Way(np.arange(4.0), places, np.zeros(4), np.array([0, 2, 4]), np.array([0, 1]))
    assert drawn_lines(way).first.tolist() == [0, 2]
    assert exact_lines(way).tolist() == [0, 2]
    alone = Way(np.zeros(1), places[:1], np.zeros(1), np.array([0, 1]), np.array([-1]))
    assert len(drawn_lines(alone).first) == 0
