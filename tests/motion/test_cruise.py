"""Tests of motions at a given speed: between its ramps, the frame has this speed, and the ramps are as short
as limits allow.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled, planned

from yarclang.robot.kinematics.fk import tool_poses

START = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]\n"


def run(line, start=START):
    plan, diagnostics = planned(f"{start}{line}\n")
    return plan, codes(diagnostics)


def speeds(plan, number=1):
    """Return the frame's speed [mm/s] and angular speed [deg/s] at many instants, and these instants."""
    curve = plan.motions[number].curve
    robot = plan.robot
    times = np.linspace(0, curve.duration, 20 * curve.segments + 1)
    poses = tool_poses(robot.chain, curve.sample(times)[0], robot.flange_from_frame["TCP"])
    step = times[1]
    turns = poses[1:, :3, :3] @ poses[:-1, :3, :3].transpose(0, 2, 1)
    angles = np.arccos(np.clip((np.trace(turns, axis1=1, axis2=2) - 1) / 2, -1, 1))
    moved = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1)
    return moved / step * 1e3, np.degrees(angles) / step, times[:-1] + step / 2


LINES = {
    "line": ("P0020 MOVEL{} 200 1174.4 1276 0 0 10 [V 80]", 80),
    "arc": ("P0020 MOVEC{} 60 1134.4 1176; 120 1174.4 1176 0 0 20 [V 60]", 60),
    "poses": ("P0020 MOVEL_SPLINE{} 60 1134.4 1176 0 0 10; 120 1174.4 1226 0 0 20 [V 50]", 50),
    "delta": ("P0020 DMOVE{} 0 0 -150 0 0 0 [V 100]", 100),
}


@pytest.mark.parametrize("law", ["", "_LSPB", "_SCURVE"])
@pytest.mark.parametrize("name", LINES)
def test_the_speed_is_kept_between_the_ramps(name, law):
    line, wanted = LINES[name]
    plan, found = run(line.format(law))
    assert found == []
    speed, _, times = speeds(plan)
    assert speed.max() <= wanted * 1.001
    # From the first to the last sample at the requested speed: the cruise between the two ramps.
    reached = np.flatnonzero(speed > wanted * 0.999)
    assert speed[reached[0] : reached[-1]].min() > wanted * 0.999
    assert times[reached[-1]] - times[reached[0]] > 0.5 * times[-1]


def test_a_pure_turn_has_an_angular_speed():
    plan, found = run("P0020 DMOVE 0 0 0 0 0 40 [V 20]")
    assert found == []
    speed, turning, _ = speeds(plan)
    assert turning.max() == pytest.approx(20, rel=1e-3)
    assert np.median(turning) == pytest.approx(20, rel=1e-3)
    assert speed.max() < 1


@settings(max_examples=15)
@given(st.floats(5, 300))
def test_the_time_is_that_of_the_way_and_one_blend(wanted):
    """The duration is that of the path at the speed, plus the duration of one ramp."""
    plan, found = run(f"P0020 DMOVE 0 0 -150 0 0 0 [V {wanted:.3f}]")
    assert found == []
    duration = plan.motions[1].curve.duration
    assert duration > 150 / wanted
    _, v, a = plan.motions[1].curve.sample(np.linspace(0, duration, 3000))
    assert (np.abs(v) <= plan.robot.limits.velocity).all()
    assert (np.abs(a) <= plan.robot.limits.acceleration).all()
    speed, _, times = speeds(plan)
    blend = times[np.flatnonzero(speed > wanted * 0.999)[0]]
    assert duration == pytest.approx(150 / wanted + blend, rel=0.03, abs=0.03)


def test_less_acceleration_means_longer_ramps():
    durations = [
        run(f"P0020 MOVEL 200 1174.4 1276 0 0 10 [V 80]{option}")[0].motions[1].curve.duration
        for option in ("", " ACC 50%", " ACC 20%")
    ]
    assert durations == sorted(durations)
    assert durations[2] > durations[0] * 1.02


def test_default_gives_a_speed_to_motions_of_a_frame():
    start = START.replace("(mm,deg,s)", "[V 80] (mm,deg,s)")
    plan, found = run("P0020 MOVEL 200 1174.4 1276 0 0 0\nP0030 MOVEL 200 1174.4 1176 0 0 0 [4]", start)
    assert found == []
    assert speeds(plan)[0].max() == pytest.approx(80, rel=1e-3)
    assert plan.motions[2].curve.duration == pytest.approx(4, abs=1e-3)
    plan, found = run("P0020 MOVEJ 0 0 0 0 -30 0", start)
    assert found == ["Y0407"]


def test_units_of_the_line_count():
    plan, _ = run("P0020 MOVEL 20 117.44 127.6 0 0 0 [V 6] (cm,deg,min)")
    assert speeds(plan)[0].max() == pytest.approx(1, rel=1e-3)


def test_a_speed_that_is_named_works():
    fast = "P0020 MOVEL 200 1174.4 1176 0 0 0 [V 5000]"
    _, diagnostics = planned(f"{START}{fast}\n")
    (one,) = diagnostics
    assert one.code == "Y0605"
    (edit,) = one.fix.edits
    fixed = fast[: edit.span.column - 1] + edit.text + fast[edit.span.end_column - 1 :]
    assert run(fixed)[1] == []
    value = float(edit.text[2:-1])
    # With 5 % more, a limit would be exceeded, or the certificate says that the speed isn't reached.
    _, found = compiled(f"{START}{fast.replace('5000', f'{value * 1.05:g}')}\n")
    assert found[0].code in ("Y0605", "Y0610")


@pytest.mark.parametrize("x", ["0.0001", "0.0002", "0.0009"])
def test_a_turn_whose_origin_moves_only_by_rounding_is_a_turn(x):
    """The origin moves by 0.0001 mm in a rotation of 2 deg. Its speed would be useless and couldn't be
    proved.
    """
    made, found = compiled(f"{START}P0020 MOVEL {x} 1174.4 1176 0 0 2 [V 5]\n")
    assert found == ()
    assert speeds(made.plan)[1].max() == pytest.approx(5, rel=1e-3)
    assert made.plan.motions[1].kept == 1.0


def test_a_turn_whose_origin_moves_only_by_rounding_in_a_chain():
    lines = "".join(
        f"P00{20 + 10 * place} MOVEL {x} 1174.4 1176 0 0 {angle} [V 20] TOL 0.05{blend}\n"
        for place, (x, angle, blend) in enumerate(
            ((2, 0, " BLEND 0.3"), (4, 1, " BLEND 0.3"), (4.0001, 2, " BLEND 0.3"), (6, 3, ""))
        )
    )
    made, found = compiled(START + lines)
    assert made is not None
    assert [one for one in found if one.is_error] == []
