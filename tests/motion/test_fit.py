"""Tests of laws, curves, and fitting both to the controller's segments."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import planned

from yarclang.motion.curve import Curve, knot_values, middle_values, through_knots
from yarclang.motion.fit import fit
from yarclang.motion.limits import Bounds, Grid
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.profile import load_profile, profile_names
from yarclang.robot.model import Tolerance

PROFILES = [load_profile(name) for name in profile_names()]
LINE = JointPath(np.zeros(2), np.array([1.0, -0.4]))
BOUNDS = Bounds(np.full(2, 1.0), np.full(2, 4.0), np.full(2, 40.0), np.eye(2), np.full(2, 10.0))


@pytest.mark.parametrize("profile", PROFILES, ids=lambda one: one.name)
@given(segments=st.integers(4, 400), share=st.floats(0, 1))
def test_a_grid_law_goes_from_rest_to_rest_and_never_back(profile, segments, share):
    law = profile.law(LINE, BOUNDS)
    forms = law.forms(segments)
    form = tuple(forms[int(share * (len(forms) - 1))].tolist())
    control = law.control(segments, form)
    assert len(control) == segments + 3
    assert np.all(control[:3] == 0)
    assert np.all(control[-3:] == 1)
    assert np.diff(control).min() > -1e-12
    accuracy = 1e-12 if profile.name != "TOPP" else 1e-6
    assert control + control[::-1] == pytest.approx(np.ones(segments + 3), abs=accuracy)


@pytest.mark.parametrize("profile", PROFILES, ids=lambda one: one.name)
@pytest.mark.parametrize("segments", [60, 300, 1200])
def test_the_executed_law_tends_to_the_pure_one(profile, segments):
    law = profile.law(LINE, BOUNDS)
    pure = law.pure(np.arange(segments + 1) / segments)
    form = tuple(law.forms(segments)[0].tolist())
    slack = {"TOPP": 4.0, "SCURVE": 1.0}.get(
        profile.name, 0.2
    )  # two more segments; a ramp of a quarter is rounded
    assert np.abs(knot_values(law.control(segments, form)) - pure).max() < slack / segments


@pytest.mark.parametrize("profile", PROFILES, ids=lambda one: one.name)
@given(segments=st.integers(4, 200))
def test_strain_tells_the_peaks_of_the_differences(profile, segments):
    law = profile.law(LINE, BOUNDS)
    forms = law.forms(segments)
    for row in (forms[:1], forms[-1:]):
        control = law.control(segments, tuple(row[0].tolist()))
        peaks = [np.abs(np.diff(control, order)).max() for order in (1, 2, 3)]
        foreseen = law.strain(segments, row)[0]
        if profile.has_cruise:
            assert peaks == pytest.approx(foreseen, rel=1e-9)
        elif profile.name == "TOPP":
            assert peaks[:2] == pytest.approx(foreseen[:2], rel=0.06) or segments < 40
        elif segments > 40:
            assert peaks == pytest.approx(foreseen, rel=0.06)


@given(segments=st.integers(4, 300), other=st.integers(4, 600), share=st.floats(0, 1))
def test_a_form_can_be_scaled_to_any_number_of_segments(segments, other, share):
    law = load_profile("SCURVE").law(LINE, BOUNDS)
    forms = law.forms(segments)
    blend, ramp = law.scaled(segments, tuple(forms[int(share * (len(forms) - 1))].tolist()), other)
    assert 2 * ramp <= blend <= other / 2
    assert ramp >= 1


@given(
    st.integers(4, 60),
    st.lists(st.floats(-3, 3), min_size=4, max_size=4),
    st.integers(0, 2**32 - 1),
)
def test_the_curve_passes_through_its_knots(segments, ends, seed):
    inner = np.random.default_rng(seed).uniform(-2, 2, (segments - 3, 2))
    start, end = np.array(ends[:2]), np.array(ends[2:])
    points = through_knots(inner.copy(), start, end)
    curve = Curve(points, 0.01, np.zeros(len(points)))
    knots, v, _ = curve.sample(np.arange(segments + 1) * 0.01)
    assert knots[2:-2] == pytest.approx(inner, abs=1e-9)
    assert knots[0] == pytest.approx(start)
    assert knots[-1] == pytest.approx(end)
    assert v[[0, -1]] == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    assert knot_values(points) == pytest.approx(knots, abs=1e-12)
    middles, _, _ = curve.sample((np.arange(segments) + 0.5) * 0.01)
    assert middle_values(points) == pytest.approx(middles, abs=1e-12)


@pytest.mark.parametrize("profile", ["LSPB", "POLY5"])
@pytest.mark.parametrize("way", [0.01, 1, 20, 150])
def test_the_shortest_time_uses_a_limit_up_and_loses_little(profile, way):
    """Compare the shortest duration with that of the ideal law in continuous time. A plan may be longer by a
    few segments, since its duration is a number of segments of up to 50 ms.
    """
    plan, diagnostics = planned(f"P0010 MOVEJ_{profile} {way} 0 0 0 0 0 [MIN] (deg)\n")
    assert not [one for one in diagnostics if one.is_error]
    peaks = {"LSPB": (1.5, 4.5, None), "POLY5": (1.875, 10 / 3**0.5, 60.0)}[profile]
    needed = [way * peaks[0] / 60, (way * peaks[1] / 240) ** 0.5]
    if peaks[2]:
        needed.append((way * peaks[2] / 2000) ** (1 / 3))
    # The jerk of the quintic is largest at both ends, where the grid averages it over a segment.
    assert plan.duration >= max(needed) * (0.97 if profile == "LSPB" else 0.8)
    assert plan.duration <= max(*needed, 4 * 0.0045) * 1.35 + 0.25


def test_samples_of_a_plan_are_those_of_its_motions():
    plan, _ = planned("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\nP0020 MOVEJ 0 20 0 0 0 0 [3] (deg,s)\n")
    times = np.array([4.0, -1.0, 0.5, 2.0, 99.0, 1.0])
    q, v, _ = plan.sample(times)
    assert np.degrees(q[[1, 4, 3, 5]]) == pytest.approx(
        np.array([[0] * 6, [0, 20, 0, 0, 0, 0], [10] + [0] * 5, [5] + [0] * 5]), abs=1e-9
    )
    assert v[[1, 4]] == pytest.approx(np.zeros((2, 6)))


def test_a_point_to_where_the_robot_stands_is_spent_at_rest():
    plan, diagnostics = planned("P0010 MOVEJ HOME [1.5] (s)\nP0020 MOVEJ HOME [MIN]\n")
    assert [one.code for one in diagnostics] == ["Y0603", "Y0603"]
    assert plan.motions[0].curve.duration == pytest.approx(1.5)
    assert plan.motions[1].curve.duration < 0.02


def test_equal_neighbours_of_a_spline_count_once():
    once, _ = planned("P0010 MOVEJ_SPLINE 10 0 0 0 0 0; 20 9 0 0 0 0 [5] (deg,s)\n")
    twice, _ = planned(
        "P0010 MOVEJ_SPLINE 0 0 0 0 0 0; 10 0 0 0 0 0; 10 0 0 0 0 0; 20 9 0 0 0 0; 20 9 0 0 0 0 [5] (deg,s)\n"
    )
    assert np.array_equal(once.motions[0].curve.points, twice.motions[0].curve.points)


def test_a_spline_is_scipy_s_natural_one():
    from scipy.interpolate import CubicSpline

    plan, _ = planned("P0010 MOVEJ_SPLINE 10 5 0 0 9 0; 20 -9 4 0 0 0; 0 0 30 1 2 3 [9] (deg,s)\n")
    through = np.radians([[0] * 6, [10, 5, 0, 0, 9, 0], [20, -9, 4, 0, 0, 0], [0, 0, 30, 1, 2, 3]])
    knots = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(through, axis=0), axis=1))))
    s = np.linspace(0, 1, 500)
    expected = CubicSpline(knots / knots[-1], through, bc_type="natural")(s)
    assert plan.motions[0].path.joints(s) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_a_motion_that_comes_back_but_for_rounding_goes_nowhere(robot):
    text = """DEFAULT {TCP} [5] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 800 700 10 20 30
P0020 MOVEL 0 800 720 10 20 30
P0030 MOVEJ_RPY 0 800 720 10 20 30
P0040 DMOVE 0 0 -20 0 0 0
P0050 MOVEJ_RPY 0 800 700 10 20 30
P0060 DMOVEJ 0.000001 0 0 0 0 0"""
    plan, diagnostics = planned(text, robot)
    assert plan is not None
    assert [(one.code, one.span.line) for one in diagnostics] == [("Y0603", 4), ("Y0603", 6)]


@pytest.mark.parametrize("profile", PROFILES, ids=lambda one: one.name)
@pytest.mark.parametrize("way", np.geomspace(0.001, 1, 8))
def test_a_few_segments_more_would_not_be_faster(profile, way):
    """The time of a short motion can't be reduced by a few more segments. For a short motion, one segment
    makes a large difference.
    """
    bounds = BOUNDS if profile.has_jerk_limit else BOUNDS.without_jerk()
    grid, path = Grid(0.004, 0.05, 2.0**-12 * 1e-3), JointPath(np.zeros(2), np.array([way, -0.4 * way]))
    found = fit(path, profile, None, BOUNDS, grid, Tolerance())
    law = profile.law(path, bounds)
    for segments in range(found.segments + 1, found.segments + 5):
        control = [law.control(segments, tuple(form.tolist())) for form in law.forms(segments)]
        times = [
            segments
            * grid.not_below(max(demand.segment for demand in bounds.demands(one[:, None] * path.end)))
            for one in control
        ]
        assert found.duration <= min(times) * 1.05
