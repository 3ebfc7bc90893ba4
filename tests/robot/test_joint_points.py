"""Tests of the joints' positions, which equal those of Pinocchio for the original URDF, and of the bars that
are drawn between them.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from tests.robot.made_arms import DATA, REAL, yarc
from tests.robot.trap_arms import arm, robot, written
from yarclang.report.pictures.bodies import _links
from yarclang.robot.description import load_robot
from yarclang.robot.joint_points import joint_points
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.visuals import sticks, visual_shapes
from yarclang.shapes import Capsule
from yarclang.view.bodies import robot_items


@pytest.fixture
def bare(tmp_path):
    """Return a robot whose URDF has no shapes, and the text of this URDF."""
    text = re.sub("<collision>.*?</collision>", "", robot(arm()))
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    return load_robot(str(tmp_path / "r")).value, text


def places(text, names):
    """Return the origins (n, 3) of the joints' frames with all joints at zero, by Pinocchio."""
    model = pin.buildModelFromXML(text)
    state = model.createData()
    pin.forwardKinematics(model, state, pin.neutral(model))
    return np.array([state.oMi[model.getJointId(name)].translation for name in names])


def test_points_are_pinocchios(bare):
    made, text = bare
    points = joint_points(made)
    assert points[:-1] == pytest.approx(places(text, made.joint_names), abs=1e-9)
    assert points[-1] == pytest.approx(made.chain.base_from_flange[:3, 3], abs=1e-9)


def test_points_of_a_makers_arm_are_pinocchios(tmp_path):
    text = (DATA / REAL["ur5"][0]).read_text()
    text = text.replace("package://example-robot-data/robots", str(DATA))
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "--meshes", DATA, "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    made = load_robot(str(tmp_path / "r")).value
    shift = joint_points(made)[:-1] - places(text, made.joint_names)
    assert shift == pytest.approx(np.tile(shift[0], (6, 1)), abs=1e-6)


def test_bars_lead_from_joint_to_joint(bare):
    made, _ = bare
    assert visual_shapes(made) == ()
    points = np.vstack((np.zeros(3), joint_points(made)))
    long = np.linalg.norm(np.diff(points, axis=0), axis=1)
    for bar in sticks(made):
        assert isinstance(bar.shape, Capsule)
        half = bar.base_from_shape[:3, 2] * bar.shape.length / 2.0
        ends = bar.base_from_shape[:3, 3] - half, bar.base_from_shape[:3, 3] + half
        assert np.array(ends) == pytest.approx(points[bar.joint : bar.joint + 2], abs=1e-9)
        assert np.linalg.det(bar.base_from_shape[:3, :3]) == pytest.approx(1.0)
    assert {bar.joint for bar in sticks(made)} == set(np.flatnonzero(long > 0.1))


def test_pictures_show_the_bars_where_the_arm_is(bare):
    made, _ = bare
    q = np.linspace(0.3, 1.1, 6)
    *_, (name, kind, pose, shape) = _links(made, q)
    flange = flange_poses(made.chain, q[None])[0][:3, 3]
    assert (name, kind) == ("joint_5", "robot")
    end = pose[:3, 3] + pose[:3, 2] * shape.length / 2.0
    assert np.linalg.norm(end - flange) < 1e-9, "the axis of the last joint leads through the flange"
    items, notes = robot_items(made)
    assert [item.kind for item in items] == ["robot"] * len(sticks(made))
    assert [one for one in notes if "the robot is shown by bars from joint to joint" in one] == [*notes]


def test_nothing_is_drawn_of_files_that_are_gone(bare):
    made, _ = bare
    lost = replace(made, folder=Path("/nowhere"))
    assert joint_points(lost) is None
    assert sticks(lost) == ()
    assert robot_items(lost) == ((), ())


def test_arms_with_shapes_have_no_bars(tmp_path):
    yarc("robot", "new", written(tmp_path, robot(arm())), "--yes", "-o", tmp_path / "r")
    made = load_robot(str(tmp_path / "r")).value
    items, notes = robot_items(made)
    assert items
    assert notes == ()
