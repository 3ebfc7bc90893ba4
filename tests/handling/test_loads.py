"""Tests of the loads of parts: torques with loads and inertias of shapes equal those of Pinocchio."""

from types import SimpleNamespace as Bare

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.robot.heavy_chains import heavy
from yarclang.cell.model import Mount, Obstacle
from yarclang.handling.surroundings import load_cases
from yarclang.robot.dynamics import torques
from yarclang.shapes import Box, Cylinder, Sphere


class Thing(Bare):
    """A robot or a cell with only the attributes that loads need; hashed by identity, as the real classes
    are.
    """

    __hash__ = object.__hash__


SHAPES = {
    "box": (Box(np.array([0.1, 0.2, 0.3])), lambda mass: pin.Inertia.FromBox(mass, 0.1, 0.2, 0.3)),
    "sphere": (Sphere(0.1), lambda mass: pin.Inertia.FromSphere(mass, 0.1)),
    "cylinder": (Cylinder(0.05, 0.3), lambda mass: pin.Inertia.FromCylinder(mass, 0.05, 0.3)),
}


def carried(shape, mass, turn, shift, *, is_sure=True):
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = turn, shift
    return Obstacle("BOX", shape, Mount(placed, on_flange=True), 0.0, mass, is_sure, is_part=True)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 7), st.sampled_from(sorted(SHAPES)), st.floats(0.1, 30.0))
def test_torques_with_a_part_are_pinocchios(seed, size, kind, mass):
    arm, random = heavy(seed, size), np.random.default_rng(seed)
    shape, inertia = SHAPES[kind]
    turn, shift = Rotation.from_rotvec(random.uniform(-3, 3, 3)).as_matrix(), random.uniform(-0.3, 0.3, 3)
    q, v, a = random.uniform(-1, 1, (3, 4, size)) * np.array([3.0, 4.0, 20.0])[:, None, None]
    robot = Thing(chain=arm.chain, dynamics=arm.dynamics)
    one, maybe = carried(shape, mass, turn, shift), carried(shape, mass, turn, shift, is_sure=False)
    (loaded,) = load_cases(robot, Thing(obstacles=(one,)))
    cases = load_cases(robot, Thing(obstacles=(maybe,)))
    bare = torques(arm.chain, arm.dynamics, q, v, a)
    frame = arm.model.frames[arm.model.getFrameId("flange", pin.FrameType.BODY)]
    arm.model.appendBodyToJoint(frame.parentJoint, inertia(mass), frame.placement * pin.SE3(turn, shift))
    theirs = arm.rnea(q, v, a)
    close = 1e-9 * np.abs(theirs).max()
    assert torques(arm.chain, loaded, q, v, a) == pytest.approx(theirs, abs=close)
    assert len(cases) == 2
    assert torques(arm.chain, cases[0], q, v, a) == pytest.approx(bare, abs=close)
    assert torques(arm.chain, cases[1], q, v, a) == pytest.approx(theirs, abs=close)


def test_without_a_mass_nothing_is_heavier():
    arm = heavy(3, 4)
    robot = Thing(chain=arm.chain, dynamics=arm.dynamics)
    one = carried(SHAPES["box"][0], None, np.eye(3), np.zeros(3))
    assert load_cases(robot, Thing(obstacles=(one,))) == (arm.dynamics,)
    assert load_cases(Thing(dynamics=None), None) == ()
