"""Single joint positions are free just where the distances of all pairs say so."""

import numpy as np
import pytest

from tests.collision.test_proof import drawn
from yarclang.collision.free import free_space, gaps, plain_free_space
from yarclang.collision.scene import scene_of
from yarclang.robot.description import load_robot

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
        # between a touch and what is told from one lies a hair
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
    """All pairs one by one say the same as those whose boxes overlap."""
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
