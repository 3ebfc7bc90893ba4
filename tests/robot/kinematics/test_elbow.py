"""Tests of finding the elbow, the point at which an arm bends."""

import numpy as np
import pytest

from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.elbow import elbow_of
from yarclang.robot.model import Chain
from yarclang.transforms import rpy_rotation

X, Y, Z = np.eye(3)


def chain(*joints, flange):
    """Return a chain of axes through points. If the axis is zero, the joint slides along the
    point's vector.
    """
    screws = [
        np.concatenate([-np.cross(axis, point), axis]) if np.any(axis) else np.concatenate([point, axis])
        for axis, point in joints
    ]
    placed = np.eye(4)
    placed[:3, 3] = flange
    return Chain(np.array(screws, dtype=float), placed)


UR = chain(
    (Z, Z * 0),
    (Y, Z * 0.1),
    (Y, Z * 0.1 + X * 0.42),
    (Y, Z * 0.1 + X * 0.82),
    (-Z, X * 0.82 + Y * 0.11),
    (Y, X * 0.82 + Y * 0.11 + Z * 0.01),
    flange=X * 0.82 + Y * 0.2 + Z * 0.01,
)
SEVEN = chain(
    (Z, Z * 0),
    (Y, Z * 0.34),
    (Z, Z * 0.5),
    (-Y, Z * 0.74),
    (Z, Z * 0.9),
    (Y, Z * 1.14),
    (Z, Z * 1.2),
    flange=Z * 1.26,
)
SCARA = chain((Z, Z * 0), (Z, X * 0.4), (Z * 0, Z), (Z, X * 0.7), flange=X * 0.7 + Z * 0.1)


@pytest.mark.parametrize(
    ("arm", "joint", "point"),
    [(UR, 2, [0.42, 0, 0.1]), (SEVEN, 3, [0, 0, 0.74]), (SCARA, 1, [0.4, 0, 0])],
    ids=["UR", "seven joints", "SCARA"],
)
def test_common_arms(arm, joint, point):
    found = elbow_of(arm)
    assert found.joint == joint
    assert found.point == pytest.approx(point, abs=1e-9)


@pytest.mark.parametrize("name", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_the_library(name):
    robot = load_robot(name).value
    assert robot.joint_names[elbow_of(robot.chain).joint] == "J3"


def test_where_the_arm_stands_changes_nothing():
    """If the base is rotated and shifted, the elbow is rotated and shifted in the same way."""
    turn, shift = rpy_rotation(np.array([0.3, 0.5, -0.7])), np.array([1.0, -2.0, 0.5])
    linear, angular = SEVEN.screws[:, :3] @ turn.T, SEVEN.screws[:, 3:] @ turn.T
    moved = np.eye(4)
    moved[:3, :3], moved[:3, 3] = turn, turn @ SEVEN.base_from_flange[:3, 3] + shift
    other = elbow_of(Chain(np.hstack([linear + np.cross(shift, angular), angular]), moved))
    assert other.joint == 3
    assert other.point == pytest.approx(turn @ elbow_of(SEVEN).point + shift)


@pytest.mark.parametrize(
    "arm", [chain((Z, Z * 0), flange=X), chain((Z * 0, X), (Z * 0, Y), (Z, Z * 0), flange=X)]
)
def test_without_an_elbow(arm):
    assert elbow_of(arm) is None
