"""Tests of taking and releasing parts in any pose: no part moves when a gripper acts, and none is lost."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from yarclang.cell.model import Grip, Item, Mount, Obstacle, Part, Parts, Removal
from yarclang.handling.parts import arrive, close, either, open_, remove
from yarclang.shapes import Box, Capsule, Cylinder, Sphere

SHAPES = (Box(np.array([0.06, 0.08, 0.1])), Sphere(0.03), Cylinder(0.02, 0.1), Capsule(0.02, 0.05))
GRIP = Grip("GRIPPER", np.eye(4), 0.01, 1.0)


def pose(seed):
    random = np.random.default_rng(seed)
    made = np.eye(4)
    made[:3, :3] = Rotation.from_rotvec(random.uniform(-3, 3, 3)).as_matrix()
    made[:3, 3] = random.uniform(-1, 1, 3)
    return made


def part(at, shape=SHAPES[0], name="BOX", count=1):
    return Part(Obstacle(name, shape, Mount(at, on_flange=False), 0.0, is_part=True), count)


def lying(*parts):
    return Parts(tuple(Item(one, 1, one.body.mount.transform.tobytes()) for one in parts))


SEEDS = st.integers(0, 2**32 - 1)


@given(SEEDS, SEEDS, st.sampled_from(SHAPES))
def test_a_part_goes_along_and_stays_where_it_is_left(seed, other, shape):
    here, there = pose(seed), pose(other)
    before = lying(part(here, shape))
    held, near = close(before, "M1", GRIP, here, 7)
    assert near.distance == 0.0
    assert [one.name for one in held.held("M1")] == ["BOX"]
    # directly after the grip, nothing has moved
    assert np.allclose(open_(held, "M1", here).items[0].transform, here, atol=1e-9)
    left = open_(held, "M1", there)
    assert np.allclose(left.items[0].transform, there, atol=1e-9)
    assert not left.held()
    assert left.closed == frozenset()


@given(SEEDS, st.floats(0.0, 0.03), st.sampled_from(SHAPES))
def test_only_what_is_within_reach_is_taken(seed, away, shape):
    """The gripper is at a known distance beyond the end of the shape's z axis, and takes the shape only
    within its reach.
    """
    here = pose(seed)
    half = {Box: 0.05, Sphere: 0.03, Cylinder: 0.05, Capsule: 0.045}[type(shape)]
    flange = here.copy()
    flange[:3, 3] += here[:3, 2] * (half + away)
    state, near = close(lying(part(here, shape)), "M1", GRIP, flange, 7)
    assert near.distance == pytest.approx(away, abs=1e-5)
    if abs(away - GRIP.reach) > 1e-4:
        assert bool(state.held()) is (away < GRIP.reach)


@given(SEEDS)
def test_the_nearest_middle_wins(seed):
    here = pose(seed)
    beside = here.copy()
    beside[:3, 3] += here[:3, 0] * 0.02
    state, _ = close(lying(part(beside, name="FAR"), part(here, name="NEAR")), "M1", GRIP, here, 7)
    assert [one.name for one in state.held()] == ["NEAR"]


@given(SEEDS, SEEDS)
def test_either_of_two_states_has_all_places(seed, other):
    assume(seed != other)
    here, there = pose(seed), pose(other)
    one = lying(part(here))
    two, _ = close(one, "M1", GRIP, here, 7)
    moved = open_(two, "M1", there)
    both = either(one, moved)
    assert {item.pose for item in both.items} == {item.pose for item in (*one.items, *moved.items)}
    assert not any(item.is_sure for item in both.items)
    assert set(both.items) == set(either(moved, one).items)
    assert either(one, one) is one


def test_parts_come_one_after_the_other():
    here = np.eye(4)
    state = lying(part(here, count=3))
    names = []
    for step in range(3):
        assert len(state.items) == step + 1
        state, near = close(state, "M1", GRIP, here, step)
        names.append(near.item.name)
        assert arrive(state, {step}) == state  # the robot hasn't left yet, so that no new part arrives
        away = here.copy()
        away[0, 3] = 0.5 + step
        state = open_(arrive(state, ()), "M1", away)
    assert names == ["BOX 1", "BOX 2", "BOX 3"]
    assert state.expected == ()
    _, near = close(state, "M1", GRIP, here, 9)
    assert near.distance > GRIP.reach


def test_a_machine_removes_what_lies_there_and_not_what_is_held():
    here = np.eye(4)
    state = lying(part(here))
    machine = Removal("PRESS", here, 0.01, 1.0)
    assert remove(state, machine).items == ()
    held, _ = close(state, "M1", GRIP, here, 7)
    assert remove(held, machine) == held
    away = replace(machine, base_from_place=pose(3))
    assert remove(state, away) == state
