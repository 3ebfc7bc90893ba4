"""Test of the natural cubic spline, by comparison with scipy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from yarclang.motion.natural import NaturalSpline

widths = st.lists(st.floats(0.05, 3), min_size=1, max_size=12)
seeds = st.integers(0, 2**32 - 1)


def both(widths, seed, size=3):
    knots = np.concatenate(([0.0], np.cumsum(widths)))
    knots /= knots[-1]
    values = np.random.default_rng(seed).uniform(-2, 2, (len(knots), size))
    return NaturalSpline.through(knots, values), CubicSpline(knots, values, bc_type="natural")


@given(widths, seeds)
def test_values_and_slopes_are_scipy_s(widths, seed):
    ours, theirs = both(widths, seed)
    s = np.concatenate((np.linspace(0, 1, 200), ours.knots))
    assert ours.at(s) == pytest.approx(theirs(s), abs=1e-9)
    assert ours.slope_at(s) == pytest.approx(theirs(s, 1), abs=1e-8 / min(widths))


@given(widths, seeds)
def test_it_ends_without_bend_and_meets_its_knots(widths, seed):
    ours, theirs = both(widths, seed)
    assert np.all(ours.bends[[0, -1]] == 0)
    assert ours.bends == pytest.approx(theirs(ours.knots, 2), rel=1e-6, abs=1e-6)
    assert ours.at(ours.knots) == pytest.approx(ours.values, abs=1e-12)


@given(widths, seeds)
def test_extremes_are_those_of_a_dense_sampling(widths, seed):
    ours, _ = both(widths, seed)
    low, low_at, high, high_at = ours.extremes()
    dense = ours.at(np.linspace(0, 1, 20001))
    assert np.all(low <= dense.min(axis=0) + 1e-12)
    assert np.all(high >= dense.max(axis=0) - 1e-12)
    assert low == pytest.approx(dense.min(axis=0), abs=1e-4)
    assert high == pytest.approx(dense.max(axis=0), abs=1e-4)
    for component in range(3):
        assert ours.at(low_at)[component, component] == pytest.approx(low[component])
        assert ours.at(high_at)[component, component] == pytest.approx(high[component])


def test_two_points_are_a_line():
    ours, _ = both([1.0], 3)
    s = np.linspace(0, 1, 11)
    assert ours.at(s) == pytest.approx(ours.values[0] + s[:, None] * (ours.values[1] - ours.values[0]))
