"""Tests of an arm with seven joints: before a pose counts as blocked, the arm moves aside while its flange
rests.
"""

from __future__ import annotations

import numpy as np
import pytest
from programs import codes

from tests.motion.avoid.cells import box, cell_of
from tests.robot.made_arms import DATA, REAL, made
from yarclang.collision.placing import place
from yarclang.collision.scene import scene_of
from yarclang.diagnostics import Collector
from yarclang.hir import PoseGoal
from yarclang.motion.leading import solving
from yarclang.motion.leading.solving import Solver
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.stages import check_program
from yarclang.robot.kinematics import Solutions, flange_poses
from yarclang.source import SourceFile


@pytest.fixture(scope="module")
def panda(tmp_path_factory):
    file, arguments, _ = REAL["panda"]
    return made(DATA / file, tmp_path_factory.mktemp("arm") / "panda", *arguments)


def solver_and_goal(panda, obstacle):
    """Return a solver with an obstacle, and the pose at which the robot stands."""
    text = (
        f'ROBOT "{panda.folder}"\n'
        f"DEFAULT {{FLANGE}} [MIN] (mm,deg,s) {{B}}\n"
        "P0010 MOVEJ_RPY 400 0 500 180 0 0\n"
    )
    opened = open_source(SourceFile("line.yarc", text), panda.folder, Options()).value
    step = check_program(opened.module, opened.request).value.steps[0]
    pose = flange_poses(panda.chain, panda.home[None])[0]
    goal = PoseGoal(pose, np.eye(4), None)
    return Solver(panda, cell_of(obstacle), measures=False), goal, step


def at_the_elbow(panda, q):
    """Return a small box in the middle of a link at given joint positions."""
    scene = scene_of(panda, cell_of(box("FAR", [0, 5, 0], [0.1, 0.1, 0.1]))).value
    placed = place(scene, q[None])
    names = [body.name for body in scene.bodies]
    link = next(number for number, name in enumerate(names) if "link4" in name)
    return box("POST", placed.middle[link, 0], [0.04, 0.04, 0.04])


def test_it_is_searched_before_a_pose_is_blocked(panda, monkeypatch):
    """The search finds only one solution, which is blocked. The self-motion leads from it to a free one."""
    post = at_the_elbow(panda, panda.home)
    solver, goal, step = solver_and_goal(panda, post)
    monkeypatch.setattr(solving, "nearest_solutions", lambda *_, **__: Solutions(panda.home[None]))
    findings = Collector(step.origin.source)
    room = solver.room(step)
    assert room.obstruction(panda.home) is not None
    q = solver.chosen(goal, panda.home, step, findings)
    assert codes(findings.found) == ["Y0924"]
    assert room.obstruction(q) is None
    np.testing.assert_allclose(flange_poses(panda.chain, q[None])[0], goal.base_from_moving, atol=1e-9)
    # If no position of the self-motion is free, the pose counts as blocked.
    monkeypatch.setattr(solving, "self_motion", lambda *_: np.empty((0, 7)))
    findings = Collector(step.origin.source)
    solver.chosen(goal, panda.home, step, findings)
    assert codes(findings.found) == ["Y0925"]


def test_the_very_position_in_which_it_stands(panda, monkeypatch):
    """The search finds another solution, which is blocked. The robot's present position is checked as well,
    and is free.
    """
    chain, limits = panda.chain, panda.limits
    pose = flange_poses(chain, panda.home[None])[0]
    samples = solving.self_motion(chain, limits, pose, panda.home[None])
    other = samples[np.argmax(np.abs(samples[:, :4] - panda.home[:4]).max(axis=1))]
    post = at_the_elbow(panda, other)
    solver, goal, step = solver_and_goal(panda, post)
    monkeypatch.setattr(solving, "nearest_solutions", lambda *_, **__: Solutions(other[None]))
    room = solver.room(step)
    assert room.obstruction(other) is not None
    assert room.obstruction(panda.home) is None
    q = solver.chosen(goal, panda.home, step, Collector(step.origin.source))
    np.testing.assert_allclose(q, panda.home, atol=1e-12)


def test_full_turns_are_asked_once(panda, monkeypatch):
    """Positions that differ by full turns have the same collisions, so only one of them is checked. But a
    zone may allow one of them and forbid another.
    """
    from yarclang.motion.avoid.room import Room

    post = at_the_elbow(panda, panda.home)
    solver, _, step = solver_and_goal(panda, post)
    room, asked = solver.room(step), []
    once = Room.obstruction
    monkeypatch.setattr(Room, "obstruction", lambda self, q: asked.append(q) or once(self, q))
    turned = [panda.home + turn * 2 * np.pi * np.eye(7)[6] for turn in (0, 1, -1)]
    said = list(room.obstructions(turned))
    assert len(asked) == 1
    assert said[0] is not None
    assert all(one is said[0] for one in said)
