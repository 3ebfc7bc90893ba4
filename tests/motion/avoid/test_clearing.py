"""Tests of lines of arms with spare joints: the elbow moves aside, so that the line passes obstacles."""

from __future__ import annotations

import numpy as np
import pytest

from tests.motion.avoid.cells import box, cell_of
from tests.motion.avoid.test_self_motion import solver_and_goal
from tests.robot.made_arms import DATA, REAL, made
from yarclang.collision.free import gaps
from yarclang.collision.placing import place
from yarclang.motion.avoid.room import Room
from yarclang.motion.cartesian import CartesianPath, along
from yarclang.motion.leading import clearing
from yarclang.motion.leading.clearing import kept_clear
from yarclang.motion.leading.solving import Solver
from yarclang.motion.paths.line import line_between
from yarclang.motion.singular import nearest_singularity
from yarclang.robot.kinematics import flange_poses

FAR = box("FAR", [0, 5, 0], [0.1, 0.1, 0.1])


@pytest.fixture(scope="module")
def panda(tmp_path_factory):
    file, arguments, _ = REAL["panda"]
    return made(DATA / file, tmp_path_factory.mktemp("arm") / "panda", *arguments)


def drawn_lines(robot, count, seed):
    """Yield lines of 300 mm that begin near HOME."""
    rng = np.random.default_rng(seed)
    low, high = robot.limits.lower + 0.05, robot.limits.upper - 0.05
    for _ in range(count):
        q = np.clip(robot.home + rng.uniform(-0.4, 0.4, 7), low, high)
        pose = flange_poses(robot.chain, q[None])[0]
        end, way = pose.copy(), rng.normal(size=3)
        end[:3, 3] += 0.3 * way / np.linalg.norm(way)
        path = along(robot.chain, robot.limits, np.eye(4), line_between(pose, end), q, reason="any")
        if isinstance(path, CartesianPath):
            yield path, rng


def test_a_post_in_the_way_of_the_elbow_is_passed(panda):
    """Small posts are placed where the upper arm would be. Most of them are passed. The motion found is free,
    on the line, and begins where the robot stands.
    """
    _, _, step = solver_and_goal(panda, FAR)
    scene = Solver(panda, cell_of(FAR)).room(step).scene
    links = [
        number
        for number, body in enumerate(scene.bodies)
        if body.name.startswith(("panda_link3", "panda_link4"))
    ]
    assert links
    blocked = passed = 0
    for path, rng in drawn_lines(panda, 30, 0):
        there = path.followed.at(np.array([rng.uniform(0.5, 1.0)]))
        middle = place(scene, there).middle[rng.choice(links), 0] + 0.04 * rng.normal(size=3)
        solver = Solver(panda, cell_of(box("POST", middle, [0.04, 0.04, 0.04])), measures=False)
        room = solver.room(step)
        if not room.is_free(path.start) or clearing._is_free(room, path):
            continue
        blocked += 1
        other = kept_clear(solver, step, path)
        if other is path:
            continue
        passed += 1
        s = np.linspace(0.0, 1.0, 200)
        q = other.followed.at(s)
        assert min(float(gaps(room.scene, one).min()) for one in q) > 0.0
        np.testing.assert_array_equal(other.followed.q[0], path.followed.q[0])
        poses = path.frame.poses(other.followed.s)
        assert np.abs(flange_poses(panda.chain, other.followed.q) - poses).max() < 1e-8
        # Check the path everywhere, not only at the samples.
        assert np.abs(flange_poses(panda.chain, q) - path.frame.poses(s)).max() < 1e-3
    assert blocked >= 8, blocked
    assert passed >= 0.6 * blocked, (passed, blocked)


def test_a_line_that_is_free_stays_as_it_is(panda):
    _, _, step = solver_and_goal(panda, FAR)
    solver = Solver(panda, cell_of(FAR), measures=False)
    room, same = solver.room(step), 0
    for path, _ in drawn_lines(panda, 12, 1):
        if clearing._is_free(room, path) and nearest_singularity(path, panda.limits.velocity) is None:
            assert kept_clear(solver, step, path) is path
            same += 1
    assert same >= 3, same


def test_clearances_are_those_of_single_positions(panda):
    """Many positions at once have the same clearances as each position alone."""
    _, _, step = solver_and_goal(panda, FAR)
    rng = np.random.default_rng(2)
    post = box("POST", [0.4, 0.1, 0.5], [0.1, 0.1, 0.1])
    room = Solver(panda, cell_of(post)).room(step)
    q = np.clip(panda.home + rng.uniform(-0.8, 0.8, (60, 7)), panda.limits.lower, panda.limits.upper)
    together = room.clearances(q, 0.05)
    alone = np.array([min(0.05, float(gaps(room.scene, one).min())) for one in q])
    np.testing.assert_allclose(together, alone, atol=1e-9)
    assert (alone < 0.05).sum() >= 5
    assert (alone < 0.0).sum() >= 1


def test_where_nothing_helps_the_line_is_as_it_was(panda):
    """An obstacle is at the goal of the hand, so moving the elbow doesn't help. The line stays as it was."""
    _, _, step = solver_and_goal(panda, FAR)
    done = 0
    for path, _ in drawn_lines(panda, 4, 3):
        hand = path.frame.poses(np.ones(1))[0][:3, 3]
        solver = Solver(panda, cell_of(box("POST", hand, [0.04, 0.04, 0.04])), measures=False)
        if clearing._is_free(solver.room(step), path):
            continue
        other = kept_clear(solver, step, path)
        assert other is path or clearing._is_free(solver.room(step), other)
        done += 1
    assert done >= 1


def test_joint_positions_asked_together_are_as_free_as_alone(panda, monkeypatch):
    """Joint positions that are checked together have the same results as alone. They are checked in order,
    and hardly more of them than the requested results need. Of positions that differ by full turns, only one
    is checked.
    """
    rng = np.random.default_rng(4)
    post = box("POST", [0.3, 0.1, 0.5], [0.3, 0.3, 0.4])
    _, _, step = solver_and_goal(panda, post)
    room = Solver(panda, cell_of(post)).room(step)
    q = list(panda.home + rng.uniform(-0.8, 0.8, (60, 7)))
    expected = [one for one in q if room.obstruction(one) is None]
    assert 10 <= len(expected) <= 50, len(expected)
    found = list(room.free_among(q))
    np.testing.assert_array_equal(found, expected)
    turned = [one + 2.0 * np.pi * rng.integers(-1, 2, 7) for one in q[:3] for _ in range(20)]
    asked = []
    clearances = Room.clearances
    monkeypatch.setattr(
        Room, "clearances", lambda self, q, near: asked.append(len(q)) or clearances(self, q, near)
    )
    list(room.free_among(turned))
    assert sum(asked) == 3
    asked.clear()
    assert next(room.free_among([expected[0], *q])) is expected[0]
    assert sum(asked) <= 16
