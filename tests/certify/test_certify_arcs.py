"""Tests of arcs: their bounds are compared with dense sampling, and other paths are refused."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    Job,
    curve_points,
    emit,
    industrial6,
    joint_points,
    origin,
    program,
)
from tests.certify.certify_paths import arc_poses, arm_curve, moved, off_path
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.motion.programmed import Arcs
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()
Q0 = np.array([10, 20, -30, 40, 50, -60]) * DEG
N, H = 40, 0.05


@cache
def made(way=(0.08, 0.04, 0.02), bulge=(0.0, 0.05, -0.03), rotvec=(0.1, 0.2, -0.1), n=N):
    """Return start, via, goal and move lines of an arc."""
    robot = industrial6()
    start = tool_poses(robot.chain, Q0[None], FLANGE_FROM_TCP)[0]
    goal = moved(start, np.array(way), np.array(rotvec))
    via = start[:3, 3] + np.array(way) / 2 + np.array(bulge)
    curve = arm_curve(robot, Q0, lambda s: arc_poses(start, via, goal, s))
    return start, via, goal, curve_points(curve, n)


def judge(via, goal, points, tm="50", **changes):
    robot = industrial6()
    timing = hir.Timing((len(points) + 2) * float(tm) * 1e-3)
    motion = hir.ArcMove(origin(0, "MOVEC"), via, hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", timing)
    job = Job(replace(motion, **changes), points, tm)
    return certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE)


def codes(result):
    return [finding.code for finding in result.diagnostics]


ARCS = [
    {},
    {"bulge": (0.0, 0.002, 0.0)},
    {"way": (0.03, 0.0, 0.01), "bulge": (0.0, 0.06, -0.05), "n": 80},  # more than a semicircle
    {"rotvec": (0.0, 0.0, 0.0)},
]


@pytest.mark.parametrize("shape", ARCS)
def test_planned_arcs(shape):
    start, via, goal, points = made(**shape)
    result = judge(via, goal, points)
    assert codes(result) == []
    command = result.value.commands[0]
    assert command.kind == "arc"
    bound = command.deviation
    least, truth = off_path(
        industrial6(), Q0, points, H, lambda s: arc_poses(start, via, goal, s), per_segment=5
    )
    assert least - 1e-10 <= bound.position <= 1.5 * truth[0] + TOLERANCE.position / 20
    assert bound.angle <= 1.5 * truth[1] + TOLERANCE.angle / 20
    assert truth[0] < TOLERANCE.position
    assert bound.remainder_position <= 0.05 * TOLERANCE.position
    # Check the speed at each sample, and that the largest bound is near the largest sample.
    from tests.certify.certify_bench import sample

    t, q, *_ = sample(Q0, points, H, 200)
    p = tool_poses(industrial6().chain, q, FLANGE_FROM_TCP)[:, :3, 3]
    step = np.diff(t) > 0
    speed = (np.linalg.norm(np.diff(p, axis=0), axis=1)[step] / np.diff(t)[step]).max()
    assert speed * (1 - 1e-6) <= command.tool_speed.largest <= speed * 1.002
    assert not command.tool_speed.turns


def test_another_via_or_goal_is_another_arc():
    _, via, goal, points = made()
    for off in (1e-6, 1e-4, 1e-3):
        other = via + np.array([0, 0, off])
        assert codes(judge(other, goal, points)) == ([] if off < 1e-5 else ["Y1159"])
    # A via on the other part of the same circle is refused.
    start = tool_poses(industrial6().chain, Q0[None], FLANGE_FROM_TCP)[0]
    far = arc_poses(start, via, goal, np.array([0.5]))[0, :3, 3]
    chord = (start[:3, 3] + goal[:3, 3]) / 2
    across = chord - far
    x = goal[:3, 3] - start[:3, 3]
    radius = (np.linalg.norm(x) ** 2 / 4 + across @ across) / (2 * np.linalg.norm(across))
    opposite = far + across / np.linalg.norm(across) * 2 * radius
    assert codes(judge(opposite, goal, points)) == ["Y1159"]
    # A via elsewhere on the arc gives the same arc.
    for s in (0.2, 0.9):
        assert codes(judge(arc_poses(start, via, goal, np.array([s]))[0, :3, 3], goal, points)) == []
    off = moved(goal, np.array([0, 0, 1e-4]), np.zeros(3))
    assert codes(judge(via, off, points)) == ["Y1160"]
    turned = moved(goal, np.zeros(3), np.array([0, 0, 0.01 * DEG]))
    assert codes(judge(via, turned, points)) == ["Y1160"]


def test_no_circle_is_never_proved():
    start, _, goal, points = made()
    middle = (start[:3, 3] + goal[:3, 3]) / 2
    for via in (middle, start[:3, 3], goal[:3, 3], start[:3, 3] + 3 * (goal - start)[:3, 3]):
        result = judge(via, goal, points)
        assert codes(result) == ["Y1159"]
        assert result.value.commands[0].deviation.position == np.inf
    assert codes(judge(middle, start, points)) == ["Y1160"]
    # Without moves, the full circle isn't executed.
    motion = hir.ArcMove(origin(0), middle, hir.PoseGoal(start, FLANGE_FROM_TCP), "LSPB", hir.Timing(None))
    job = Job(motion, None)
    robot = industrial6()
    assert codes(certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE)) == ["Y1159"]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-7, -3), st.integers(0, 3))
def test_arcs_with_a_point_moved(seed, size, which):
    """The bound is never below the true deviation, and not far above it."""
    rng = np.random.default_rng(seed)
    start, via, goal, points = made(**ARCS[which])
    points = points.copy()
    points[rng.integers(2, len(points) - 2)] += 10**size * rng.normal(size=6)
    bound = judge(via, goal, points).value.commands[0].deviation
    least, truth = off_path(
        industrial6(), Q0, points, H, lambda s: arc_poses(start, via, goal, s), per_segment=2
    )
    assert bound.position >= least - 1e-9
    if size < -4:
        assert bound.position <= 2.5 * truth[0] + TOLERANCE.position / 10


def test_many_arcs_at_once_are_as_one_by_one():
    rng = np.random.default_rng(3)
    frames = np.tile(np.eye(4), (6, 1, 1))
    starts = np.array([moved(np.eye(4), rng.normal(size=3), rng.normal(size=3)) for _ in range(6)])
    vias = rng.normal(size=(6, 3))
    goals = np.array([moved(np.eye(4), rng.normal(size=3), rng.normal(size=3)) for _ in range(6)])
    arcs = Arcs.through(starts, vias, goals, frames)
    s = np.linspace(0, 1, 50)
    for k in range(6):
        at = arcs.at(np.full(50, k), s)
        truth = arc_poses(starts[k], vias[k], goals[k], s)
        assert np.abs(at.p - truth[:, :3, 3]).max() < 1e-9
        assert np.abs(at.rotation - truth[:, :3, :3]).max() < 1e-9
        assert np.allclose(np.gradient(at.p, s, axis=0)[1:-1], at.along[1:-1], rtol=0.01, atol=0.05)
        bounds = arcs.bounds(np.full(1, k), np.zeros(1), np.ones(1)).position[0]
        norm = np.linalg.norm(at.p - arcs.centre[k], axis=1)
        assert np.allclose(bounds, norm[0] * arcs.sweep[k] ** np.arange(1, 5))


def test_joint_motion_isnt_an_arc():
    _, via, goal, points = made()
    end = points[-1]
    assert codes(judge(via, goal, joint_points(Q0, end, N))) == ["Y1159"]


def test_its_own_tolerance():
    _, via, goal, points = made()
    points = points.copy()
    points[18, 2] += 0.003 * DEG
    bound = judge(via, goal, points).value.commands[0].deviation.position
    assert 1e-5 < bound < 5e-5
    assert codes(judge(via, goal, points, tolerance=bound * 1.1)) == []
    assert codes(judge(via, goal, points, tolerance=bound * 0.9)) == ["Y1159"]
