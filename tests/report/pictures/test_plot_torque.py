"""The row of torques in the picture of a plan: it exists if masses are known, and has Pinocchio's values."""

import numpy as np
import pinocchio as pin
import pytest
from programs import planned

from tests.robot.made_arms import DATA, REAL, made
from yarclang.report.pictures.plot import draw
from yarclang.report.pictures.trace import MOST_SAMPLES, peak_of, trace_of

PROGRAM = "P10 MOVEJ 40 -90 60 0 20 0 [1.5] (deg,s)\nP20 MOVEJ HOME [2] (s)"


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    return made(DATA / REAL["ur5"][0], tmp_path_factory.mktemp("torques") / "ur5")


def test_the_torques_are_those_of_the_executed_curve(arm):
    plan = planned(PROGRAM, str(arm.folder))[0]
    trace = trace_of(plan)
    model = pin.buildModelFromUrdf(str(arm.folder / arm.urdf))
    data = model.createData()
    row = int(np.searchsorted(trace.times, 0.4))
    q, v, a = plan.motions[0].curve.sample(trace.times[row : row + 1])
    theirs = pin.rnea(model, data, q[0], v[0], a[0]) / arm.dynamics.effort
    assert trace.torque[row] == pytest.approx(theirs, abs=1e-9)
    peak = peak_of(trace, trace.torque)
    assert arm.joint_names[peak.column] == "shoulder_lift_joint"
    assert b"joint torque" in draw(plan, "svg")


def test_without_masses_there_is_no_row():
    plan = planned("P10 MOVEJ 40 0 0 0 0 0 [3] (deg,s)")[0]
    assert trace_of(plan).torque is None


def test_still_and_long(arm):
    still = trace_of(planned("P10 STOP", str(arm.folder))[0])
    assert still.torque.shape == still.position.shape
    assert np.abs(still.torque).max() > 0.1
    many = "\n".join(f"P{10 * k} MOVEJ {30 * (k % 2)} -90 60 0 20 0 [40] (deg,s)" for k in range(1, 12))
    long = trace_of(planned(many, str(arm.folder))[0])
    assert long.torque.shape == long.position.shape
    assert len(long.times) <= MOST_SAMPLES
