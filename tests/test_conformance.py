"""Tests of the pipeline against independently computed numbers."""

import numpy as np
import pytest
from conftest import EXAMPLES
from programs import compiled, planned

from yarclang.motion.curve import Curve, knot_values
from yarclang.motion.limits import Bounds
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.profile import load_profile

START = "START 0.0 -6.158742074 -46.519197172 0 52.677939245 0 (deg)\n"

LINE = JointPath(np.zeros(1), np.ones(1))
BOUNDS = Bounds(np.ones(1), np.ones(1), np.ones(1), np.eye(1), np.ones(1))


def test_listing4_compiles_as_it_stands_for_40_seconds():
    made, diagnostics = compiled((EXAMPLES / "01_listing4.yarc").read_text())
    assert [one.code for one in diagnostics] == ["Y0505"]
    assert [motion.curve.duration for motion in made.plan.motions] == [20.0, 20.0]


def test_listing4_goes_to_the_nearest_solution(conformance):
    plan, _ = planned((EXAMPLES / "01_listing4.yarc").read_text())
    expected = conformance("industrial6_kinematics")["listing4_P0001"]["nearest_to_home_deg"]
    assert np.degrees(plan.motions[0].curve.points[-1]) == pytest.approx(expected, abs=1e-8)


def test_lspb_is_the_paper_s_law(conformance):
    data = conformance("lspb")
    law = load_profile("LSPB").law(LINE, BOUNDS).pure
    assert law(np.array(data["t"]) / data["T"]) == pytest.approx(np.array(data["s"]), abs=1e-12)


def test_the_executed_lspb_is_near_the_law():
    """Ramps have one segment: for 400 segments, the law is within 4.1e-4 of the ideal one, with peaks 1.498
    and 4.54.
    """
    made = load_profile("LSPB").law(LINE, BOUNDS)
    control = made.control(400, tuple(made.forms(400)[0].tolist()))
    law = made.pure(np.arange(401) / 400)
    assert np.abs(knot_values(control) - law).max() < 4.1e-4
    assert np.abs(np.diff(control)).max() * 400 == pytest.approx(1.498, abs=2e-3)
    assert np.abs(np.diff(control, 2)).max() * 400**2 == pytest.approx(4.54, abs=5e-3)


def test_movel_follows_the_line_of_the_conformance(conformance):
    """At any time, the executed motion is on the line where the grid's law has it. The joint positions of the
    independent inverse kinematics belong to the same line.
    """
    data = conformance("movel_line")
    plan, diagnostics = planned(START + data["command"])
    assert diagnostics == ()
    (motion,) = plan.motions
    assert motion.curve.duration == pytest.approx(4.0, abs=1e-9)
    samples = data["samples"]
    s = np.array([sample["s"] for sample in samples])
    expected = np.array([sample["q_deg"] for sample in samples])
    assert np.degrees(motion.path.joints(s)) == pytest.approx(expected, abs=1e-6)
    # the executed law differs from the ideal one in time, because it has ramps, and because its acceleration
    # takes 27 segments instead of 26.7
    q, _, _ = plan.sample(np.array([sample["t"] for sample in samples]))
    assert np.abs(np.degrees(q) - expected).max() < 0.2


@pytest.mark.parametrize("number", range(3))
def test_dmove_ends_where_the_conformance_says(conformance, number):
    case = conformance("dmove")["cases"][number]
    start = " ".join(map(str, case["start_deg"]))
    plan, diagnostics = planned(f"START {start} (deg)\n{case['command']}")
    assert [one.code for one in diagnostics] == []
    assert np.degrees(plan.motions[0].curve.points[-1]) == pytest.approx(case["end_deg"], abs=1e-6)


def test_the_curve_is_the_controller_s_spline(conformance):
    data = conformance("spline1")
    points = np.array([data["start"]] * 3 + data["points"] + [data["points"][-1]] * 2)
    x, v, a = Curve(points, data["tm_ms"] / 1e3, np.zeros(len(points))).sample(np.array(data["t"]))
    for computed, name in ((x, "x"), (v, "v"), (a, "a")):
        # the file has nine decimals, and its velocities and accelerations are rounded likewise
        assert computed == pytest.approx(np.array(data[name]), abs=1e-6), name


def test_listing4_compiles_as_it_stands_for_the_tracked_arm():
    made, diagnostics = compiled((EXAMPLES / "01_listing4.yarc").read_text(), "TRACKED_MANIPULATOR")
    assert not [one for one in diagnostics if one.is_error]
    assert [motion.curve.duration for motion in made.plan.motions] == [20.0, 20.0]
