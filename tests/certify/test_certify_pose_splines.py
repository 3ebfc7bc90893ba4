"""Tests of splines of poses: their bounds are compared with dense sampling, with and without claims, and
other curves are refused.
"""

import itertools
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.certify.certify_bench import (
    DEG,
    FLANGE_FROM_TCP,
    Job,
    curve_points,
    emit,
    grid_law,
    industrial6,
    origin,
    program,
)
from tests.certify.certify_paths import arm_curve, chord, joined, moved, off_path, pose, spline_poses
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.claims import Claims
from yarclang.certify.motion.posespline import PoseSpline
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()
Q0 = np.array([10, 20, -30, 40, 50, -60]) * DEG
H = 0.05
CURVES = {
    "wave": [
        ((0.05, 0.03, 0.0), (0.1, 0, 0)),
        ((0.1, -0.02, 0.03), (0.1, 0.2, 0)),
        ((0.13, 0.02, 0.0), (0, 0.1, -0.3)),
    ],
    "there and back": [((0.06, 0.03, 0.02), (0.2, 0, 0.1)), ((0.0, 0.0, 0.0), (0, 0, 0))],
    "one": [((0.08, 0.02, -0.03), (0.0, 0.3, 0))],
    "doubled": [
        ((0.05, 0.03, 0.0), (0.1, 0, 0)),
        ((0.05, 0.03, 0.0), (0.1, 0, 0)),
        ((0.1, -0.02, 0.03), (0.1, 0.2, 0)),
    ],
    "only turns": [((0, 0, 0), (0.3, 0.1, 0)), ((0, 0, 0), (0.2, -0.2, 0.4))],
}


def way_points(name):
    start = tool_poses(industrial6().chain, Q0[None], FLANGE_FROM_TCP)[0]
    return start, [moved(start, np.array(way), np.array(vector)) for way, vector in CURVES[name]]


def distinct(start, way):
    return [start, *(p for p, before in zip(way, [start, *way], strict=False) if p is not before)]


@cache
def made(name, n=80, bc_type="natural"):
    start, way = way_points(name)
    through = [start]
    for one in way:
        if np.abs(one - through[-1]).max() > 1e-12:
            through.append(one)
    curve = arm_curve(industrial6(), Q0, lambda s: spline_poses(through, s, bc_type))
    return through, way, curve_points(curve, n)


def judge(way, points, laws=None, tm="50"):
    robot = industrial6()
    goals = tuple(hir.PoseGoal(p, FLANGE_FROM_TCP) for p in way)
    timing = hir.Timing((len(points) + 2) * float(tm) * 1e-3)
    job = Job(hir.PoseSplineMove(origin(0, "MOVEL_SPLINE"), goals, "LSPB", timing), points, tm)
    return certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE, Claims(laws=laws or {}))


def codes(result):
    return [finding.code for finding in result.diagnostics]


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("claimed", [False, True])
def test_planned_curves(name, claimed):
    through, way, points = made(name)
    result = judge(way, points, {0: grid_law(80)} if claimed else None)
    assert codes(result) == []
    command = result.value.commands[0]
    assert command.kind == "pose_spline"
    bound = command.deviation
    least, truth = off_path(industrial6(), Q0, points, H, lambda s: spline_poses(through, s), per_segment=3)
    assert least - 1e-9 <= bound.position <= 2.0 * truth[0] + TOLERANCE.position / 10
    assert bound.angle <= 2.0 * truth[1] + TOLERANCE.angle / 10
    assert truth[0] < TOLERANCE.position
    assert command.tool_speed.turns == (name == "only turns")


@pytest.mark.parametrize(
    "law", [np.zeros(83), np.full(83, np.nan), np.ones(12), np.linspace(0, 1, 83), grid_law(80)[::-1]]
)
def test_a_wrong_claim_proves_no_less(law):
    _, way, points = made("wave")
    good = judge(way, points).value.commands[0].deviation
    assert judge(way, points, {0: law}).value.commands[0].deviation == good
    # A wrong claim doesn't make a wrong path pass, either.
    points = points.copy()
    points[40, 2] += 0.03 * DEG
    assert codes(judge(way, points, {0: law})) == ["Y1159"]


def test_other_curves_through_the_same_poses():
    for bc_type in ("clamped", "not-a-knot"):
        _, way, points = made("wave", bc_type=bc_type)
        assert codes(judge(way, points)) == ["Y1159"]
    # The text is refused for a curve through fewer poses, or in another order.
    _, way, points = made("wave")
    assert codes(judge(way[1:], points)) == ["Y1159"]
    assert codes(judge([way[1], way[0], way[2]], points)) == ["Y1159"]
    assert codes(judge(way, made("one")[2])) == ["Y1160"]
    for k in range(2):
        for change in ((1e-4, 0, 0), (0, 0, 0)):
            other = [*way]
            other[k] = moved(
                way[k], np.array(change), np.zeros(3) if any(change) else np.array([0, 0, 0.02 * DEG])
            )
            assert codes(judge(other, points)) == ["Y1159"]


def test_another_parameter_is_another_curve():
    """A spline whose parameter is the distance alone, without the rotation, is another curve."""
    start, way = way_points("wave")
    through = [start, *way]

    def by_distance(s):
        from scipy.interpolate import CubicSpline

        u = np.r_[0, np.cumsum(np.linalg.norm(np.diff([p[:3, 3] for p in through], axis=0), axis=1))]
        q = np.array([Rotation.from_matrix(p[:3, :3]).as_quat() for p in through])
        signs = np.cumprod(np.r_[1, np.where((q[1:] * q[:-1]).sum(axis=1) < 0, -1, 1)])
        table = np.hstack([[p[:3, 3] for p in through], q * signs[:, None]])
        at = CubicSpline(u, table, bc_type="natural")(np.asarray(s) * u[-1])
        return joined(at[:, :3], Rotation.from_quat(at[:, 3:]).as_matrix())

    points = curve_points(arm_curve(industrial6(), Q0, by_distance), 80)
    assert codes(judge(way, points)) == ["Y1159"]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(-7, -3), st.sampled_from(["wave", "there and back", "doubled"]))
def test_curves_with_a_point_moved(seed, size, name):
    rng = np.random.default_rng(seed)
    through, way, points = made(name)
    points = points.copy()
    points[rng.integers(2, len(points) - 2)] += 10**size * rng.normal(size=6)
    for laws in ({}, {0: grid_law(80)}):
        bound = judge(way, points, laws).value.commands[0].deviation
        least, _ = off_path(industrial6(), Q0, points, H, lambda s: spline_poses(through, s), per_segment=1)
        assert bound.position >= least - 1e-9


def test_the_way_stands_still():
    start, _ = way_points("one")
    robot = industrial6()
    for points, found in ((None, []), (made("one")[2], ["Y1160"])):
        goals = (hir.PoseGoal(start, FLANGE_FROM_TCP),) * 3
        job = Job(hir.PoseSplineMove(origin(0), goals, "LSPB", hir.Timing(None)), points)
        result = certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE)
        assert codes(result) == found
    far = moved(start, np.array([0, 0, 0.01]), np.zeros(3))
    goals = tuple(hir.PoseGoal(p, FLANGE_FROM_TCP) for p in (far, start))
    job = Job(hir.PoseSplineMove(origin(0), goals, "LSPB", hir.Timing(None)), None)
    assert codes(certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE)) == ["Y1159"]


def test_half_a_turn_is_never_proved():
    start, _ = way_points("one")
    for angle, lawful in ((np.pi, False), (np.pi - 1e-4, True)):
        goal = moved(start, np.array([0.1, 0, 0]), np.array([0, 0, angle]))
        made_of = PoseSpline.through(np.array([start, goal]), FLANGE_FROM_TCP)
        assert bool(made_of.lawful[0]) == lawful
        bounds = made_of.bounds(np.zeros(1, dtype=int), np.zeros(1), np.ones(1))
        assert np.isfinite(bounds.position).all()
        result = judge([goal], made("one")[2])
        assert "Y1160" in codes(result)
        assert (result.value.commands[0].deviation.angle == np.inf) == (not lawful)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.floats(0.05, 2.8))
def test_derivatives_of_the_curve(seed, count, largest):
    """Values equal scipy's. Divided differences of each order are never above the bounds, and the bounds
    aren't much larger.
    """
    rng = np.random.default_rng(seed)
    poses = [pose(rng.normal(size=3) * 0.1, Rotation.random(random_state=seed % 1000).as_matrix())]
    for _ in range(count - 1):
        vector = rng.normal(size=3)
        vector *= rng.uniform(0.01, largest) / np.linalg.norm(vector)
        poses.append(moved(poses[-1], rng.normal(size=3) * 0.05, vector))
    curve = PoseSpline.through(np.array(poses), np.eye(4))
    assert np.allclose(curve.total, chord(poses)[-1], rtol=1e-9)
    s = np.linspace(0, 1, 400)
    zero = np.zeros(len(s), dtype=int)
    at = curve.at(zero, s)
    truth = spline_poses(poses, s)
    assert np.abs(at.p - truth[:, :3, 3]).max() < 1e-9
    assert np.abs(at.rotation - truth[:, :3, :3]).max() < 1e-9
    step = 1e-6
    ahead, back = curve.at(zero, s + step), curve.at(zero, s - step)
    scale = 1 + np.abs(at.spin).max()
    assert np.abs((ahead.rotation - back.rotation) / (2 * step) - at.spin).max() < 1e-4 * scale
    assert np.abs((ahead.p - back.p) / (2 * step) - at.along).max() < 1e-4 * scale
    # A divided difference inside a span is the derivative at some point of the span.
    u = chord(poses) / chord(poses)[-1]
    for low, high in itertools.pairwise(u):
        a, b = np.sort(rng.uniform(low, high, 2))
        if b - a < 1e-2:
            continue
        places = np.linspace(a, b, 5)
        five = curve.at(np.zeros(5, dtype=int), places)
        bounds = curve.bounds(np.zeros(1, dtype=int), places[:1], places[-1:])
        gap = (b - a) / 4
        for values, bound in (
            (five.p, bounds.position[0]),
            (five.rotation.reshape(5, 9), bounds.rotation[0]),
        ):
            for order in range(1, 5):
                difference = np.diff(values, order, axis=0) / gap**order
                noise = 1e-14 * 16 / gap**order
                assert np.linalg.norm(difference, axis=1).max() <= bound[order - 1] * (1 + 1e-9) + noise


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 4), st.floats(5e-4, 3e-3))
def test_a_short_curve_is_bounded_some_micrometres_beyond_its_ends(seed, count, span):
    """A frame that accelerates from rest begins slightly before its path. This is also proved for a path of 2
    mm.
    """
    rng = np.random.default_rng(seed)
    poses = [pose(np.zeros(3), Rotation.random(random_state=seed % 1000).as_matrix())]
    for _ in range(count - 1):
        way = rng.normal(size=3)
        poses.append(moved(poses[-1], span * way / np.linalg.norm(way), rng.normal(size=3) * 0.02))
    curve = PoseSpline.through(np.array(poses), np.eye(4))
    aside = 4e-6 / curve.total
    for begin, end in ((-aside, 0.0), (1.0, 1.0 + aside)):
        bounds = curve.bounds(np.zeros(1, dtype=int), np.array([begin]), np.array([end]))
        assert np.isfinite(bounds.position).all()
        assert np.isfinite(bounds.rotation).all()
        at = curve.at(np.zeros(50, dtype=int), np.linspace(begin, end, 50))
        assert np.linalg.norm(at.along, axis=1).max() <= bounds.position[0, 0] * (1 + 1e-9)
        assert np.linalg.norm(at.spin.reshape(50, 9), axis=1).max() <= bounds.rotation[0, 0] * (1 + 1e-9)
    far = np.array([2e-4 / curve.total])
    for begin, end in ((-far, 0.0 * far), (1.0 + 0.0 * far, 1.0 + far)):
        assert np.isinf(curve.bounds(np.zeros(1, dtype=int), begin, end).position).all()
