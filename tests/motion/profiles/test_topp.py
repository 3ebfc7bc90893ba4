"""Tests of time-optimal laws: no limit is exceeded at any instant, one limit is always reached, and no other
law is faster.
"""

import numpy as np
import pytest
from programs import codes, planned

from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.description import load_robot

LINE = "P0020 MOVEL_TOPP 200 1074.4 1326 10 -5 20 [MIN]"
PROGRAMS = {
    "joints": "P0020 MOVEJ_TOPP 60 10 -20 30 40 -50 [MIN]",
    "spline": "P0020 MOVEJ_SPLINE_TOPP 10 0 5 0 10 0; 40 25 -30 20 60 50; 10 -20 0 0 30 0; 60 0 0 0 -30 90 [MIN]",  # noqa: E501
    "line": LINE,
    "arc": "P0020 MOVEC_TOPP 60 1134.4 1176; 120 1174.4 1176 0 0 20 [MIN]",
    "poses": "P0020 MOVEL_SPLINE_TOPP 60 1134.4 1176 0 0 10; 120 1174.4 1226 0 0 20; 180 1174.4 1126 5 0 0 [MIN]",  # noqa: E501
}


def motion(line, robot="INDUSTRIAL6"):
    plan, diagnostics = planned(
        f"DEFAULT {{TCP}} (mm,deg,s) {{B}}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]\n{line}\n", robot
    )
    assert not [code for code in codes(diagnostics) if code != "Y0505"]
    return plan.motions[1].curve


def shares(curve, robot):
    """Return the largest used shares of the limits of velocity, motor speed and acceleration, at many
    instants.
    """
    _, v, a = curve.sample(np.linspace(0, curve.duration, 40 * curve.segments + 1))
    return np.stack(
        [
            np.abs(v / robot.limits.velocity).max(axis=1),
            np.abs(v @ counts_per_joint(robot).T / robot.actuation.velocity).max(axis=1),
            np.abs(a / robot.limits.acceleration).max(axis=1),
        ]
    )


@pytest.mark.parametrize("name", PROGRAMS)
def test_no_limit_is_broken_and_one_is_always_used_up(name, industrial6):
    used = shares(motion(PROGRAMS[name]), industrial6)
    assert used.max() <= 1.0
    busy = used.max(axis=0)
    # Exceptions are the changes from limit to limit, which take a segment or two, and both ends.
    assert np.median(busy) > 0.99
    assert np.quantile(busy, 0.15) > 0.9


def test_coupled_motors_keep_their_speed(tracked):
    plan, diagnostics = planned("P0010 DMOVEJ_TOPP 0 0 0 0 60 -60 [MIN] (deg)\n", "TRACKED_MANIPULATOR")
    assert codes(diagnostics) == []
    used = shares(plan.motions[0].curve, tracked)
    assert used.max() <= 1.0
    assert 0.8 < used[1].max() < used[0].max()


@pytest.mark.parametrize("name", PROGRAMS)
@pytest.mark.parametrize("other", ["_LSPB", "_POLY5", "_SCURVE"])
def test_no_other_law_is_faster(name, other):
    assert motion(PROGRAMS[name]).duration < motion(PROGRAMS[name].replace("_TOPP", other)).duration


@pytest.mark.parametrize(("way", "velocity_limited"), [(2, False), (100, True)])
def test_a_line_of_one_joint_takes_the_time_of_the_textbook(way, velocity_limited, industrial6):
    plan, _ = planned(f"P0010 MOVEJ_TOPP {way} 0 0 0 0 0 [MIN] (deg)\n")
    velocity, acceleration = (
        np.degrees(one[0]) for one in (industrial6.limits.velocity, industrial6.limits.acceleration)
    )
    velocity = min(
        velocity,
        np.degrees(
            (industrial6.actuation.velocity / np.abs(counts_per_joint(industrial6)[:, 0]).clip(1e-9)).min()
        ),
    )
    textbook = (
        way / velocity + velocity / acceleration if velocity_limited else 2 * np.sqrt(way / acceleration)
    )
    curve = plan.motions[0].curve
    assert textbook < curve.duration < textbook * 1.002 + 2 * curve.segment + 1e-3


@pytest.mark.parametrize("time", ["[6]", "[50%]"])
def test_a_longer_time_stretches_it(time):
    fastest, stretched = motion(LINE), motion(LINE.replace("[MIN]", time))
    gone = [np.linspace(0, 1, 201) * curve.duration for curve in (fastest, stretched)]
    positions = [curve.sample(times)[0] for curve, times in zip((fastest, stretched), gone, strict=True)]
    robot = load_robot("INDUSTRIAL6").value
    assert shares(stretched, robot).max() <= 1.0
    if time == "[6]":
        assert stretched.duration == pytest.approx(6, abs=1e-3)
        assert positions[1] == pytest.approx(positions[0], abs=0.02)
    else:
        assert stretched.duration == pytest.approx(2 * fastest.duration, rel=0.3)
        assert shares(stretched, robot)[:2].max() <= 0.5
        assert shares(stretched, robot)[2].max() <= 0.5


def shortest(text):
    """Return the duration of the last motion of a program. The program must be planned."""
    plan, diagnostics = planned("DEFAULT {TCP} (mm,deg,s) {B}\n" + text)
    assert plan is not None, diagnostics
    return plan.motions[-1].curve.duration


@pytest.mark.parametrize("length", [1e-7, 1e-5, 1e-4, 0.0016, 0.01, 0.1])
@pytest.mark.parametrize("time", ["[MIN]", "[1]", "[50%]"])
def test_the_shortest_lines_have_a_law(length, time):
    start = "START 10 10 -20 0 30 0 (deg)\n"
    duration = shortest(f"{start}P0010 DMOVE_TOPP {length:.7f} 0 0 0 0 0 {time}\n")
    assert duration == pytest.approx(1, abs=1e-3) if time == "[1]" else duration < 0.05


def test_a_line_of_a_micrometre_in_too_short_a_time_is_told_one_that_works():
    start = "DEFAULT {TCP} (mm,deg,s) {B}\nSTART 10 10 -20 0 30 0 (deg)\n"
    _, diagnostics = planned(f"{start}P0010 DMOVE_TOPP 0.0016 0 0 0 0 0 [0.01]\n")
    (found,) = diagnostics
    assert found.code == "Y0601"
    assert "the shortest time that works is [0.016]" in found.help


@pytest.mark.parametrize("j5", [0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6, -3e-6])
@pytest.mark.parametrize("way", ["6 0 0", "0 6 0", "0 0 6"])
@pytest.mark.parametrize("time", ["[MIN]", "[99%]"])
def test_beside_a_singularity_it_takes_about_as_long_as_the_wrist_needs(j5, way, time):
    """J4 turns by at most 90 deg, in about 1.8 s at 60 deg/s. Other laws take minutes here, because they
    aren't adapted to the turn.
    """
    start = f"START 10 10 -20 0 {j5:.7f} 0 (deg)\n"
    duration = shortest(f"{start}P0010 DMOVE_TOPP {way} 0 0 0 {time}\n")
    assert duration < 5.0
    if time == "[MIN]":
        assert duration < 1.1 * shortest(f"{start}P0010 DMOVE_POLY5 {way} 0 0 0 [MIN]\n")


def test_a_path_without_a_law_is_a_finding(monkeypatch):
    """If the solver fails, a finding says so, with the place. No path is known that makes it fail, so the
    test simulates this.
    """
    from toppra.algorithm import TOPPRA

    compute = TOPPRA.compute_parameterization

    def lost(self, *arguments, return_data=False):
        controllable = compute(self, *arguments, return_data=True)[3]
        controllable[100] = np.nan
        return None, None, None, controllable

    monkeypatch.setattr(TOPPRA, "compute_parameterization", lost)
    _, diagnostics = planned("P0010 MOVEJ_TOPP 10 0 0 0 0 0 [MIN] (deg)\n")
    (found,) = diagnostics
    assert found.code == "Y0614"
    assert "failed at 25 % of the path" in found.message
    _, diagnostics = planned(
        "P0010 MOVEJ_TOPP 10 0 0 0 0 0 [MIN] (deg) BLEND 1\nP0020 MOVEJ_TOPP 20 0 0 0 0 0 [2] (deg,s)\n"
    )
    assert codes(diagnostics) == ["Y0614", "Y0614"]
