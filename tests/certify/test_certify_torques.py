"""Tests of torques along a text: the bounds between instants hold, and findings name the joint, the position,
the part of gravity, and a sufficient time.
"""

import json
import re

import numpy as np
import pinocchio as pin
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled

from tests.robot.heavy_chains import heavy, tool
from tests.robot.made_arms import DATA, REAL, made
from yarclang.certify.bodies.torque import REMAINDER
from yarclang.certify.bodies.torque_bounds import torque_bends
from yarclang.certify.motion.bounds import Cubics
from yarclang.cli.table import certificate_table
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.robot.dynamics import torques

SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=60, deadline=None)
@given(SEEDS, st.integers(1, 7), st.floats(0.05, 3.0))
def test_no_torque_bends_more(seed, size, pace):
    """The second differences of the torques on segments of constant jerk are never above the bound."""
    arm = heavy(seed, size, (tool(),))
    random = np.random.default_rng(seed)
    x, v, a, j = (
        random.uniform(-1, 1, (4, 6, size)) * np.array([1.0, pace, 4 * pace, 30 * pace])[:, None, None]
    )
    h = 0.03
    cubics = Cubics(x, v, a, j, np.full(6, h))
    low, high = cubics.position_range()
    travel = np.maximum(np.abs(low), np.abs(high))
    peaks = cubics.velocity_peaks(), cubics.acceleration_peaks(), np.abs(cubics.j)
    bound = torque_bends(arm.chain, arm.dynamics, travel, peaks)
    times = np.linspace(0, h, 61)
    along = []
    for time in times:
        q, rate = cubics.at(np.full(6, time))
        along.append(torques(arm.chain, arm.dynamics, q, rate, a + time * j))
    bends = np.abs(np.diff(along, 2, axis=0)).max(axis=0) / times[1] ** 2
    assert (bends <= bound * (1 + 1e-6) + 1e-9 * np.abs(along).max() / times[1] ** 2).all()


@pytest.fixture(scope="module")
def ur5(tmp_path_factory):
    """Fixture: UR5 with its own masses and efforts."""
    robot = made(DATA / REAL["ur5"][0], tmp_path_factory.mktemp("torques") / "ur5")
    text = (robot.folder / "robot.toml").read_text()
    return robot, text


def with_effort(tmp_path, ur5, joint="shoulder_lift_joint", effort=None, more=""):
    """Return a copy of the robot with another effort."""
    import shutil

    robot, text = ur5
    folder = tmp_path / "arm"
    shutil.copytree(robot.folder, folder, dirs_exist_ok=True)
    if effort is not None:
        text = re.sub(rf"(\[joints\.{joint}\].*\n)", rf"\1effort = {effort}\n", text)
    (folder / "robot.toml").write_text(text + more)
    return str(folder)


def pinocchio_peaks(folder, plan, robot):
    """Return the largest torques (n,) of a plan in very many instants."""
    model = pin.buildModelFromUrdf(f"{folder}/{robot.urdf}")
    data = model.createData()
    most = np.zeros(robot.size)
    for motion in plan.motions:
        q, v, a = motion.curve.sample(np.linspace(0, motion.curve.duration, 2000))
        for one in zip(q, v, a, strict=True):
            most = np.maximum(most, np.abs(pin.rnea(model, data, *one)))
    return most


def test_what_is_certified_is_pinocchios(tmp_path, ur5):
    program = "P10 MOVEJ 40 -90 60 0 20 0 [MIN] (deg)\nP20 MOVEJ HOME [2.2] (s)"
    value, found = compiled(program, with_effort(tmp_path, ur5))
    assert found == ()
    most = pinocchio_peaks(tmp_path / "arm", value.plan, ur5[0]) / ur5[0].dynamics.effort
    told = max((command.torque for command in value.certificate.commands), key=lambda load: load.share)
    assert told.name == ur5[0].joint_names[int(np.argmax(most))]
    assert most.max() <= told.share <= most.max() + 2 * REMAINDER
    assert "torque shoulder_lift_joint" not in value.text
    assert re.search(r"torque \d+ % of the limits", value.text)
    assert "shoulder_lift_joint" in certificate_table(value.certificate)
    assert "torque" in certificate_table(value.certificate).splitlines()[0]


def test_a_motion_is_judged_by_itself(tmp_path, ur5):
    """The torques of a motion don't depend on the motions before and after it."""
    folder = with_effort(tmp_path, ur5)
    last = "P30 MOVEJ 0 -40 30 0 0 0 [1.7] (deg,s)"
    whole = compiled(
        f"P10 MOVEJ 90 -20 0 0 0 0 [4] (deg,s)\nP20 MOVEJ 40 -90 60 0 20 0 [2] (deg,s)\n{last}", folder
    )[0]
    alone = compiled(f"START 40 -90 60 0 20 0 (deg)\n{last}", folder)[0]
    assert whole.certificate.commands[-1].torque == alone.certificate.commands[0].torque


def test_slower_it_works(tmp_path, ur5):
    """The proposed time is sufficient, and a time that is a few percent shorter isn't."""
    program = "START 0 -90 0 0 0 0 (deg)\nP10 MOVEJ 0 -20 0 0 0 0 [{}] (deg,s)"
    quick = compiled(program.format("0.9"), with_effort(tmp_path, ur5))[0].certificate.commands[0].torque
    effort = quick.share * 150 * 0.97
    folder = with_effort(tmp_path, ur5, effort=f"{effort:.3f}")
    value, (finding,) = compiled(program.format("0.9"), folder)
    assert (value, finding.code) == (None, "Y1801")
    shown = re.match(
        r"shoulder_lift_joint needs ([\d.]+) N m, 1\d\d\.\d% of its effort of ([\d.]+) N m, [\d.]+ s after its start \(\d+ %\)",  # noqa: E501
        finding.message,
    )
    assert float(shown[1]) == pytest.approx(quick.share * 150, rel=2 * REMAINDER)
    assert "hold the arm against gravity" in finding.message
    time = float(finding.fix.edits[0].text.strip("[]"))
    assert 0.9 < time < 1.0
    assert codes(compiled(program.format(time), folder)[1]) == []
    assert codes(compiled(program.format("0.92"), folder)[1]) == ["Y1801"]


def test_a_timetable_is_stretched_to_where_the_torque_holds(tmp_path, ur5):
    program = "START 0 -90 0 0 0 0 (deg)\nP10 MOVEJ_TIMED 0 -50 0 0 0 0 [0.5]; 0 -20 0 0 0 0 [1] (deg,s){}"
    quick = compiled(program.format(""), with_effort(tmp_path, ur5))[0].certificate.commands[0].torque
    folder = with_effort(tmp_path, ur5, effort=f"{quick.share * 150 * 0.97:.3f}")
    value, (finding,) = compiled(program.format(""), folder)
    assert (value, finding.code) == (None, "Y1801")
    (edit,) = finding.fix.edits
    assert f"a STRETCH that works is about{edit.text[8:]}" in finding.help
    assert 1.0 < float(edit.text.split()[1]) < 1.1
    assert compiled(program.format(edit.text), folder)[0] is not None


def test_gravity_alone_is_too_much(tmp_path, ur5):
    program = "START 0 -90 0 0 0 0 (deg)\nP10 MOVEJ 0 0 0 0 0 0 [9] (deg,s)"
    (finding,) = compiled(program, with_effort(tmp_path, ur5, effort=30))[1]
    assert finding.code == "Y1802"
    assert "only to hold the arm against gravity" in finding.message
    assert finding.fix is None
    load = "\n[tools.BLOCK]\nmass = 40\ncenter_of_mass = [0, 100, 0]\n"
    (finding,) = compiled(program, with_effort(tmp_path, ur5, more=load))[1]
    assert finding.code == "Y1802"


def test_what_flows_together_takes_longer_together(tmp_path, ur5):
    program = (
        "START 0 -90 0 0 0 0 (deg)\n"
        "P10 MOVEJ 0 -50 0 0 0 0 [0.8] (deg,s) BLEND 5\n"
        "P20 MOVEJ 0 -20 30 0 0 0 [0.8] (deg,s)"
    )
    value, found = compiled(program, with_effort(tmp_path, ur5))
    assert codes(found) == []
    effort = value.certificate.worst("torque").share * 150 * 0.97
    found = compiled(program, with_effort(tmp_path, ur5, effort=effort))[1]
    assert set(codes(found)) == {"Y1801"}
    assert "times as long" in found[0].help


def test_told_everywhere(tmp_path, ur5):
    """Torques are reported in the table, the JSON and the inspection, and for a text without its source."""
    program = tmp_path / "a.yarc"
    program.write_text(f'ROBOT "{with_effort(tmp_path, ur5)}"\nP10 MOVEJ 40 -90 60 0 20 0 [3] (deg,s)\n')
    told = CliRunner().invoke(yarcc, [str(program), "--certificate", str(tmp_path / "c.json")])
    assert told.exit_code == 0, told.output
    data = json.loads((tmp_path / "c.json").read_text())
    assert data["commands"][0]["torque"]["name"] == "shoulder_lift_joint"
    assert data["loads"]["torque"] == data["commands"][0]["torque"]
    share = data["commands"][0]["torque"]["share"]
    assert f"shoulder_lift_joint {share:.0%}" in told.output
    shown = CliRunner().invoke(main, ["inspect", str(program), "P10"])
    assert f"torque shoulder_lift_joint {share:.0%}".replace("%", " %") in shown.output


def test_without_masses_nothing_is_said():
    value, found = compiled("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)")
    assert codes(found) == []
    assert value.certificate.commands[0].torque is None
    assert "torque" not in certificate_table(value.certificate)
    assert "torque" not in value.text
