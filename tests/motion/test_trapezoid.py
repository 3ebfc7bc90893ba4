"""Tests of laws with ramps, blends and a cruise, by comparison with their definition in continuous time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.motion.curve import knot_values
from yarclang.motion.trapezoid import cruising, trapezoid, trapezoid_strain


@st.composite
def forms(draw):
    segments = draw(st.integers(4, 300))
    blend = draw(st.integers(2, segments // 2))
    return segments, blend, draw(st.integers(1, blend // 2))


def integrated(times, accelerations, at):
    """Return the second integral of a piecewise linear acceleration at the knots `at`. Velocity and position
    are zero at the beginning.
    """
    fine = np.arange(at[-1] * 20 + 1) / 20
    a = np.interp(fine, times, accelerations)
    v = np.concatenate(([0], np.cumsum((a[1:] + a[:-1]) / 2))) / 20
    # Exact for linear accelerations, with h = 1/20: v h + a h^2 / 2, plus the change of a times h^2 / 6.
    x = np.concatenate(([0], np.cumsum(v[:-1] / 20 + a[:-1] / 800 + np.diff(a) / 2400)))
    return x[::20]


@given(forms())
def test_the_trapezoid_is_its_law_exactly(form):
    segments, blend, ramp = form
    control = trapezoid(segments, blend, ramp)
    acceleration = np.diff(control, 2)
    top = 1 / (segments - blend) / (blend - ramp)
    corners = [
        0,
        ramp,
        blend - ramp,
        blend,
        segments - blend,
        segments - blend + ramp,
        segments - ramp,
        segments,
    ]
    heights = np.array([0, 1, 1, 0, 0, -1, -1, 0]) * top
    if 2 * blend == segments:  # without a cruise, two corners coincide
        corners = corners[:4] + corners[5:]
        heights = np.delete(heights, 4)
    assert acceleration == pytest.approx(np.interp(np.arange(segments + 1), corners, heights), abs=1e-12)
    law = integrated(corners, heights, np.arange(segments + 1))
    assert knot_values(control) == pytest.approx(law, abs=1e-9)


@given(forms())
def test_strain_is_what_differences_say(form):
    segments, blend, ramp = form
    control = trapezoid(segments, blend, ramp)
    peaks = [np.abs(np.diff(control, order)).max() for order in (1, 2, 3)]
    assert trapezoid_strain(segments, np.array([[blend, ramp]]))[0] == pytest.approx(peaks, rel=1e-9)


@given(st.integers(8, 400), st.floats(0, 1), st.floats(0, 1))
def test_a_cruise_takes_what_is_asked(segments, share, steepness):
    cruise = segments / 2 + share * (segments / 2 - 2)
    ramp = 1 + int(steepness * (int(segments - cruise) // 2 - 1))
    control = cruising(segments, cruise, ramp)
    steps = np.diff(control)
    assert np.all(control[:3] == 0)
    assert np.all(control[-3:] == 1)
    assert steps.min() > -1e-12
    # The speed is never above the cruise speed, and equals it between the two blends.
    assert steps.max() == pytest.approx(1 / cruise, rel=1e-9)
    blend = segments - cruise
    middle = steps[int(np.ceil(blend)) + 2 : -int(np.ceil(blend)) - 2]
    if len(middle):
        assert middle == pytest.approx(1 / cruise, rel=1e-9)
    assert control + control[::-1] == pytest.approx(np.ones(segments + 3), abs=1e-9)


@pytest.mark.parametrize("cruise", [17.0, 17.0 + 4e-15, 17.0 - 4e-15])
def test_rounding_isn_t_a_segment_less(cruise):
    exact = cruising(19, 17.0, 1)
    assert cruising(19, cruise, 1) == pytest.approx(exact, abs=1e-12)
