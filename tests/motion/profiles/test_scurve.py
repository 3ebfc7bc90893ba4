"""Tests of S-curves, by comparison with the closed form of the shortest jerk-limited motion from rest to
rest.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, planned

from yarclang.motion.curve import Curve
from yarclang.motion.fit import fit
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.profile import load_profile
from yarclang.robot.model import Tolerance

SCURVE = load_profile("SCURVE")
GRID = Grid(0.0013281, 0.05, 1 / 4096e3)


def optimal(way, velocity, acceleration, jerk):
    """Return the shortest time of a motion from rest to rest [s]. It has seven phases, some of which may be
    missing.
    """
    if (way / (2 * jerk)) ** (1 / 3) * jerk <= acceleration:  # only jerk phases: four equal ones
        ramp, blend = (way / (2 * jerk)) ** (1 / 3), 2 * (way / (2 * jerk)) ** (1 / 3)
    else:
        ramp = acceleration / jerk
        blend = ramp / 2 + np.sqrt(ramp**2 / 4 + way / acceleration)
    if jerk * ramp * (blend - ramp) <= velocity:
        return 2 * blend
    if velocity * jerk >= acceleration**2:
        ramp = acceleration / jerk
        blend = ramp + velocity / acceleration
    else:
        blend = 2 * np.sqrt(velocity / jerk)
    return blend + way / velocity


@pytest.mark.parametrize(
    ("way", "limits", "expected"),
    [
        # four jerk phases, each of t = 1 s: the distance is 2 j t^3
        (2.0, (9, 9, 1), 4.0),
        (100.0, (10, 10, 1e9), 11.0),  # a trapezoid: v / a + distance / v
        (100.0, (1e9, 4, 1e9), 10.0),  # a triangle
    ],
)
def test_the_closed_form_is_right_where_it_is_known(way, limits, expected):
    assert optimal(way, *limits) == pytest.approx(expected, rel=1e-6)


@settings(max_examples=80)
@given(st.floats(0.02, 3), st.floats(0.3, 3), st.floats(0.5, 10), st.floats(0.06, 0.5), st.floats(0.02, 1))
def test_the_shortest_time_is_within_a_percent_of_the_optimum(way, velocity, acceleration, rise, other):
    # the jerk is limited, because ramps that are much faster than those of real arms would be shorter than a
    # segment
    jerk = acceleration / rise
    bounds = Bounds(
        np.array([velocity, 9.0]),
        np.array([acceleration, 90.0]),
        np.array([jerk, 900.0]),
        np.eye(2),
        np.full(2, 99.0),
    )
    curve = fit(
        JointPath(np.zeros(2), np.array([way, -way * other])), SCURVE, None, bounds, GRID, Tolerance()
    )
    assert isinstance(curve, Curve)
    shortest = optimal(
        1.0,
        min(velocity / way, 9 / way / other),
        min(acceleration / way, 90 / way / other),
        min(jerk / way, 900 / way / other),
    )
    assert shortest * (1 - 1e-9) <= curve.duration <= shortest * 1.01 + 2 * GRID.smallest
    _, v, a = curve.sample(np.linspace(0, curve.duration, 5000))
    assert np.abs(v[:, 0]).max() <= velocity * (1 + 1e-9)
    assert np.abs(a[:, 0]).max() <= acceleration * (1 + 1e-9)
    assert np.abs(np.diff(curve.points[:, 0], 3)).max() / curve.segment**3 <= jerk * (1 + 1e-9)


def test_a_given_time_stretches_the_shape_of_the_shortest():
    shortest, _ = planned("P0010 MOVEJ_SCURVE 40 0 0 0 0 0 [MIN] (deg)\n")
    stretched, diagnostics = planned("P0010 MOVEJ_SCURVE 40 0 0 0 0 0 [10] (deg,s)\n")
    assert codes(diagnostics) == []
    shares = np.linspace(0, 1, 101)
    one, other = (plan.motions[0].curve for plan in (shortest, stretched))
    assert other.duration == pytest.approx(10, abs=1e-3)
    gone = [curve.sample(shares * curve.duration)[0][:, 0] for curve in (one, other)]
    assert gone[1] == pytest.approx(gone[0], abs=np.radians(40) * 0.01)


def test_it_beats_the_default_law():
    for way in (1, 10, 60):
        times = [
            planned(f"P0010 MOVEJ{law} {way} 0 0 0 0 0 [MIN] (deg)\n")[0].duration
            for law in ("_SCURVE", "_LSPB", "_POLY5")
        ]
        assert times[0] == min(times)
