"""Tests of single joint positions: they are free exactly if the distances of all pairs are large enough."""

import numpy as np
import pytest

from tests.collision.test_proof import cell_of, drawn, mount
from tests.robot.made_arms import DATA, REAL, made
from yarclang.cell.model import Obstacle
from yarclang.collision.free import _can_meet, free_space, gaps, plain_free_space
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.scene import scene_of
from yarclang.robot.description import load_robot
from yarclang.shapes import Sphere

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


@pytest.mark.parametrize("seed", range(8))
def test_positions_are_free_where_no_distance_is_too_small(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    scene = scene_of(robot, drawn(random)).value
    q = random.uniform(robot.limits.lower, robot.limits.upper, (150, robot.size))
    space = plain_free_space(scene)
    for one in q:
        left = gaps(scene, one)
        # Distances that are too near to zero can't be told from a touch.
        if abs(left.min()) > 3e-5:
            assert space.has(one) is bool(left.min() > 0.0)


def test_pairs_can_be_asked_to_stay_farther_apart():
    random = np.random.default_rng(3)
    robot = load_robot("INDUSTRIAL6").value
    scene = scene_of(robot, drawn(random)).value
    q = random.uniform(robot.limits.lower, robot.limits.upper, (200, robot.size))
    more = random.uniform(0.0, 0.03, len(scene.pairs.first))
    wide = free_space(scene, more)
    seen = set()
    for one in q:
        left = (gaps(scene, one) - more).min()
        if abs(left) > 3e-5:
            seen.add(wide.has(one))
            assert wide.has(one) is bool(left > 0.0)
    assert seen == {True, False}


def test_pairs_left_out_by_their_boxes_change_no_answer():
    """All pairs checked one by one give the same result as only those whose boxes overlap."""
    import pinocchio

    seen = set()
    for seed in range(6):
        random = np.random.default_rng(seed)
        robot = load_robot(ROBOTS[seed % 2]).value
        scene = scene_of(robot, drawn(random)).value
        more = random.uniform(0.0, 0.1, len(scene.pairs.first)) * (random.random() < 0.7)
        space = free_space(scene, more)
        for one in random.uniform(robot.limits.lower, robot.limits.upper, (800, robot.size)):
            touches = pinocchio.computeCollisions(
                space.model, space.data, space.geometry, space.pairs, one, True
            )
            assert space.has(one) is not touches
            seen.add(touches)
    assert seen == {True, False}


@pytest.mark.parametrize("name", [*ROBOTS, "ur5", "panda"])
def test_what_no_joint_position_reaches_is_left_out(name, tmp_path):
    """Balls around the arm: each one that is left out is far away in all joint positions, and those out of
    reach are left out.
    """
    if name in ROBOTS:
        robot = load_robot(name).value
    else:
        urdf, arguments, _ = REAL[name]
        robot = made(DATA / urdf, tmp_path / name, *arguments)
    random = np.random.default_rng(7)
    reach = float(np.linalg.norm(robot.chain.base_from_flange[:3, 3])) + 0.5
    balls = []
    for number in range(60):
        way = random.normal(size=3)
        at = way / np.linalg.norm(way) * random.uniform(0.3, 2.5) * reach
        balls.append(Obstacle(f"BALL{number}", Sphere(0.05), mount(at, np.zeros(3)), 0.0))
    scene = scene_of(robot, cell_of(*balls)).value
    every = np.arange(len(scene.pairs.first))
    apart = np.full(len(every), 0.02)
    out = ~_can_meet(scene, apart)
    lower, upper = np.maximum(robot.limits.lower, -np.pi), np.minimum(robot.limits.upper, np.pi)
    q = random.uniform(lower, upper, (400, robot.size))
    placed = place(scene, q)
    least = np.full(len(every), np.inf)
    for at in range(len(q)):
        seen = relative(placed, np.full_like(every, at), every)
        least = np.minimum(least, distances(scene, every, seen))
    assert (least[out] > apart[out]).all()
    assert out.sum() > 20
    assert (~out).sum() > 20
