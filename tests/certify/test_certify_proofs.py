"""Tests of the bounds of whole commands by dense sampling: they are never below the truth, and not far above
it.
"""

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
    arm_line,
    curve_points,
    emit,
    everything,
    industrial6,
    joint_points,
    line_pose,
    natural,
    origin,
    program,
    railed,
    rotation,
    sample,
)
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.claims import Claims
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Tolerance

TOLERANCE = Tolerance()
SLACK = TOLERANCE.position / 20, TOLERANCE.angle / 20
seeds = st.integers(0, 2**32 - 1)
Q0 = np.array([10, 20, -30, 40, 50, -60]) * DEG


def judged(robot, start, motion, points, tm, witnesses=None):
    """Return the certificate of a program with one command, printed with nine decimals."""
    job = Job(motion, points, tm)
    result = certify(
        emit(robot, start, [job]), program(start, [job]), robot, TOLERANCE, Claims(witnesses or {})
    )
    assert result.value is not None, result.diagnostics
    return result.value.commands[0]


def as_printed(robot, q):
    return np.round(q / robot.axis_units, 9) * robot.axis_units


# lines


@cache
def lines():
    """Return some Cartesian lines: n, TM, way, axis, angle, move lines, goal."""
    robot, made = industrial6(), []
    for n, tm, way, axis, angle in (
        (24, "50", (0.1, 0.05, -0.08), (1, 2, 3), 0.3),
        (20, "50", (0.0, 0.0, 0.12), (0, 0, 1), 0.0),
        (24, "50", (0.0, 0.0, 0.0), (1, 0, 1), 0.5),
        (24, "5", (0.01, 0.0, 0.004), (0, 1, 0), -0.05),
        (20, "50", (0.0002, 0.0, 0.0), (0, 1, 0), 0.3),
    ):
        curve, goal = arm_line(robot, Q0, way, axis, angle)
        made.append((n, tm, np.array(way), np.array(axis, float), angle, curve_points(curve, n), goal))
    return made


def line_truth(robot, points, h, way, axis, angle):
    """Return the true deviations from the path, by dense sampling. The first two are the deviations of
    position and angle, each at its own best path parameter; the other two are those at the best common
    parameter.
    """
    _, q, *_ = sample(as_printed(robot, Q0), as_printed(robot, points), h)
    poses = tool_poses(robot.chain, q, FLANGE_FROM_TCP)
    start = poses[0]
    length = np.linalg.norm(way)
    offset = poses[:, :3, 3] - start[:3, 3]
    axis = axis / np.linalg.norm(axis)
    off = poses[:, :3, :3] @ start[:3, :3].T
    vee = np.stack(
        [off[:, 2, 1] - off[:, 1, 2], off[:, 0, 2] - off[:, 2, 0], off[:, 1, 0] - off[:, 0, 1]], axis=1
    )
    along = np.einsum("i,nij,j->n", axis, off, axis)
    turned = np.arctan2(vee @ axis, np.trace(off, axis1=1, axis2=2) - along)

    def errors(s):
        path = line_pose(start, way, axis, angle, s)
        chord = np.linalg.norm(poses[:, :3, :3] - path[:, :3, :3], axis=(1, 2))
        return np.linalg.norm(poses[:, :3, 3] - path[:, :3, 3], axis=1), 2 * np.arcsin(chord / np.sqrt(8))

    own = np.clip(offset @ way / length**2, 0, 1) if length else np.zeros(len(q))
    least_position = errors(own)[0].max()
    least_angle = errors(np.clip(turned / angle, 0, 1) if angle else own)[1].max()
    weight = (length / TOLERANCE.position) ** 2, (angle / TOLERANCE.angle) ** 2
    common = offset @ way / TOLERANCE.position**2 + turned * angle / TOLERANCE.angle**2
    position, turn = errors(np.clip(common / sum(weight), 0, 1))
    return (least_position, least_angle), (position.max(), turn.max())


def line_motion(n, tm, goal):
    return hir.LineMove(
        origin(0), hir.PoseGoal(goal, FLANGE_FROM_TCP), "LSPB", hir.Timing(n * float(tm) * 1e-3)
    )


def test_planned_lines():
    robot = industrial6()
    for n, tm, way, axis, angle, points, goal in lines():
        bound = judged(robot, Q0, line_motion(n, tm, goal), points, tm).deviation
        least, truth = line_truth(robot, points, float(tm) * 1e-3, way, axis, angle)
        assert least[0] - 1e-12 <= bound.position <= 1.5 * truth[0] + SLACK[0]
        assert least[1] - 1e-12 <= bound.angle <= 1.5 * truth[1] + SLACK[1]
        assert bound.remainder_position <= 0.021 * TOLERANCE.position
        assert bound.remainder_angle <= 0.041 * TOLERANCE.angle
        assert truth[0] < TOLERANCE.position  # the tests' planner is good enough


@settings(max_examples=40, deadline=None)
@given(seeds, st.integers(0, 4), st.floats(-7, -2.5), st.booleans())
def test_lines_with_points_moved(seed, which, size, single):
    """One control point, or all of them, are moved by up to 10**size rad."""
    robot = industrial6()
    rng = np.random.default_rng(seed)
    n, tm, way, axis, angle, points, goal = lines()[which]
    points = points.copy()
    if single:
        points[len(points) // 2 + rng.integers(-3, 4)] += 10**size * rng.normal(size=6)
    else:
        points[:-1] += 10**size * rng.normal(size=(len(points) - 1, 6))
    bound = judged(robot, Q0, line_motion(n, tm, goal), points, tm).deviation
    least, truth = line_truth(robot, points, float(tm) * 1e-3, way, axis, angle)
    assert bound.position >= least[0] - 1e-12
    assert bound.angle >= least[1] - 1e-12
    if single and size < -4:
        # If the error is about as large as a tolerance, the bound stays near the true deviation, at the best
        # path parameter for position and angle separately.
        assert bound.position <= 2.0 * truth[0] + SLACK[0]
        assert bound.angle <= 2.0 * truth[1] + SLACK[1]


@pytest.mark.parametrize("back", [0.0, 0.4])
def test_line_that_runs_back_is_as_far_off_as_it_runs_back(back):
    """All points are on the line, but the frame moves backwards in between. The deviation is the distance of
    this backward motion.
    """
    robot = railed()
    start = np.zeros(5)
    goal = np.array([0.6, 0, 0, 0, 0])
    n, tm = 60, "50"
    points = joint_points(start, goal, n)
    s = points[:, :1] / 0.6
    points = points - back * goal * np.exp(-(((s - 0.5) / 0.1) ** 2)) * (s < 1)
    pose = tool_poses(robot.chain, goal[None], np.eye(4))[0]
    motion = hir.LineMove(origin(0), hir.PoseGoal(pose, np.eye(4)), "LSPB", hir.Timing(3.0))
    deviation = judged(robot, start, motion, points, tm).deviation
    _, x, *_ = sample(start, points, 0.05)
    went_back = (np.maximum.accumulate(x[:, 0]) - x[:, 0]).max()
    assert went_back - 1e-9 <= deviation.position <= 1.1 * went_back + 1e-7
    assert (went_back > 0.05) == (back > 0)


@pytest.mark.parametrize("back", [0.0, 0.3])
def test_joint_motion_that_runs_back(back):
    robot = industrial6()
    goal = np.array([0.5, 0.2, 0, 0, 0, 0.1])
    points = joint_points(np.zeros(6), goal, 60)
    s = points[:, :1] / 0.5
    points = points - back * goal * np.exp(-(((s - 0.5) / 0.1) ** 2)) * (s < 1)
    motion = hir.JointMove(origin(0), hir.JointGoal(goal), "LSPB", hir.Timing(3.0))
    deviation = judged(robot, np.zeros(6), motion, points, "50").deviation
    _, x, *_ = sample(np.zeros(6), points, 0.05)
    went_back = (np.maximum.accumulate(x[:, 0]) - x[:, 0]).max()
    assert went_back - 1e-9 <= deviation.angle <= 1.3 * went_back + 1e-9
    assert (went_back > 0.02) == (back > 0)


def test_the_programmed_turn_takes_part_in_the_remainder():
    """If only joint 6 turns, arm and path have the same fourth derivative, and both must be counted."""
    robot = industrial6()
    start, goal = np.zeros(6), np.array([0, 0, 0, 0, 0, 0.5])
    points = joint_points(start, goal, 60)
    pose = tool_poses(robot.chain, goal[None], np.eye(4))[0]
    motion = hir.LineMove(origin(0), hir.PoseGoal(pose, np.eye(4)), "LSPB", hir.Timing(3.0))
    deviation = judged(robot, start, motion, points, "50").deviation
    _, _, *rates = sample(start, points, 0.05)
    w, a, j = (np.abs(x[:, -1]).reshape(len(points) + 2, -1).max(axis=1) for x in rates)
    arm = 0.05**4 / 384 * (w**4 + 6 * w * w * a + 3 * a * a + 4 * w * j).max()
    assert 1.5 * arm < deviation.remainder_angle < 2.1 * arm


def test_shifts_along_axes_that_are_fixed_to_the_base():
    case = everything()
    steps = [*case.program.steps]
    axes = rotation([1, 0, 2], 0.7)
    turn = axes.T @ rotation([1, 2, 3], 0.3) @ axes
    # The next path begins at the programmed goal, so the motion after is wrong too.
    for fixed, found in ((True, []), (False, ["Y1160", "Y1159"])):
        goal = hir.PoseDelta(axes.T @ [0.1, 0.05, -0.08], turn, axes, not fixed, FLANGE_FROM_TCP)
        steps[2] = hir.LineMove(steps[2].origin, goal, "LSPB", steps[2].timing)
        changed = hir.Program(case.program.source, case.start, tuple(steps))
        result = certify(case.text(), changed, case.robot, TOLERANCE, Claims(case.witnesses))
        assert [finding.code for finding in result.diagnostics] == found


def test_prismatic_joints_take_part_in_the_remainder():
    robot = railed()
    start = np.array([0.1, 0.2, -0.3, 0.05, 0.4])
    rng = np.random.default_rng(5)
    for _ in range(5):
        goal = start + rng.normal(size=5) * [0.3, 0.4, 0.4, 0.1, 0.4]
        poses = tool_poses(robot.chain, np.array([start, goal]), np.eye(4))
        motion = hir.LineMove(origin(0), hir.PoseGoal(poses[1], np.eye(4)), "LSPB", hir.Timing(3.0))
        points = joint_points(start, goal, 60)
        deviation = judged(robot, start, motion, points, "50").deviation
        _, q, *_ = sample(as_printed(robot, start), as_printed(robot, points), 0.05)
        p = tool_poses(robot.chain, q, np.eye(4))[:, :3, 3]
        way = poses[1, :3, 3] - poses[0, :3, 3]
        s = np.clip((p - p[0]) @ way / (way @ way), 0, 1)
        truth = np.linalg.norm(p - p[0] - s[:, None] * way, axis=1).max()
        assert truth - 1e-12 <= deviation.position
        assert 0 < deviation.remainder_position < 1e-3


# joints and splines


def nearest(curve, q, weights, rounds=10):
    """Return the weighted distance of each row of q (the maximum over the joints) from the nearest point of
    curve(s), with s in [0, 1]. The nearest point is found by zooming in.
    """
    grid = np.linspace(0, 1, 2001)
    table = curve(grid)
    far = np.array([np.abs((table - row) * weights).max(axis=1).argmin() for row in q])
    best, width = grid[far], 1 / 2000
    for _ in range(rounds):
        s = np.clip(best[:, None] + np.linspace(-width, width, 21), 0, 1)
        off = np.abs((curve(s.ravel()).reshape(*s.shape, -1) - q[:, None]) * weights).max(axis=2)
        best, width = s[np.arange(len(q)), off.argmin(axis=1)], width / 8
    return off.min(axis=1)


@settings(max_examples=50, deadline=None)
@given(seeds, st.integers(8, 40), st.floats(-9, -1), st.booleans())
def test_joint_lines(seed, n, size, smooth):
    robot = railed()
    rng = np.random.default_rng(seed)
    goal = rng.normal(size=5) * 0.3
    points = joint_points(np.zeros(5), goal, n)
    if smooth:  # a bulge to one side in the middle
        bulge = np.exp(-(((np.arange(len(points)) - len(points) / 2) / (len(points) / 8)) ** 2))
        points[:-1] += 10**size * bulge[:-1, None] * rng.normal(size=5)
    else:
        points[:-1] += 10**size * rng.normal(size=(len(points) - 1, 5))
    points, goal = as_printed(robot, points), as_printed(robot, goal)
    motion = hir.JointMove(origin(0), hir.JointGoal(goal), "LSPB", hir.Timing(None))
    command = judged(robot, np.zeros(5), motion, points, "20")
    weights = 1 / np.where(robot.chain.is_prismatic, TOLERANCE.position, TOLERANCE.angle)
    _, q, v, a, j = sample(np.zeros(5), points, 0.02, per_segment=10)
    truth = nearest(lambda s: s[:, None] * goal, q, weights).max()
    share = max(command.deviation.position / TOLERANCE.position, command.deviation.angle / TOLERANCE.angle)
    assert share >= truth - 1e-7
    if smooth and n >= 30 and size < -3:
        assert share <= 1.5 * truth + 0.05
    limits = robot.limits
    hold = (np.abs(a) + np.abs(v) / robot.controller.hold_time) / limits.stop_acceleration
    for load, values, limit in (
        (command.velocity, v, limits.velocity),
        (command.acceleration, a, limits.acceleration),
        (command.jerk, j, limits.jerk),
    ):
        most = (np.abs(values) / limit).max()
        assert most - 1e-9 <= load.share <= 1.05 * most + 1e-6
        assert (
            load.name == f"J{(np.abs(values) / limit).max(axis=0).argmax() + 1}" or load.share < 1.05 * most
        )
    assert hold.max() - 1e-9 <= command.hold.share <= 1.5 * hold.max() + 1e-6


SPLINES = {
    "bend": [[20, 10, 5, -20, 10, 0], [-5, 20, 15, 10, -10, 30]],
    "there and back": [[15, 15, 15, 15, 15, 15], [0, 0, 0, 0, 0, 0]],
    "one waypoint": [[10, -5, 5, 0, 20, 9]],
    "uneven": [[1, 0, 0, 0, 0, 0], [20, 10, 0, 5, 0, 0], [20, 10, 0.5, 5, 0, 0], [20, -5, 3, 0, 8, 40]],
    "doubled": [[20, 10, 5, -20, 10, 0], [20, 10, 5, -20, 10, 0], [-5, 20, 15, 10, -10, 30]],
}


@pytest.mark.parametrize("name", SPLINES)
@pytest.mark.parametrize(("n", "tm"), [(120, "50"), (300, "20"), (40, "50")])
@pytest.mark.parametrize("off", [0.0, 1e-4])
def test_splines(name, n, tm, off):
    robot = industrial6()
    start = as_printed(robot, Q0)
    way = start + np.array(SPLINES[name]) * DEG
    distinct = np.vstack([start, way])
    distinct = distinct[np.r_[True, np.abs(np.diff(distinct, axis=0)).max(axis=1) > 0]]
    curve = natural(distinct)
    points = as_printed(robot, curve_points(curve, n))
    points[n // 3] += off
    motion = hir.SplineMove(
        origin(0), tuple(hir.JointGoal(q) for q in way), "LSPB", hir.Timing(n * float(tm) * 1e-3)
    )
    deviation = judged(robot, start, motion, points, tm, {0: way}).deviation
    _, q, *_ = sample(start, points, float(tm) * 1e-3, per_segment=6)
    truth = nearest(curve, q, 1.0).max()
    assert truth - 1e-11 <= deviation.angle <= 2.0 * truth + SLACK[1]
    assert deviation.position == 0.0
    assert deviation.remainder_angle <= TOLERANCE.angle * 0.02 or n == 40


def test_spline_that_leaves_out_a_waypoint():
    robot = industrial6()
    way = Q0 + np.array(SPLINES["bend"]) * DEG
    motion = hir.SplineMove(origin(0), tuple(hir.JointGoal(q) for q in way), "LSPB", hir.Timing(6.0))
    points = joint_points(Q0, way[1], 120)
    deviation = judged(robot, Q0, motion, points, "50", {0: way}).deviation
    assert deviation.angle > 5 * DEG
    assert deviation.end_angle < 1e-8


# whole programs


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_everything_passes(target):
    case = everything()
    result = certify(case.text(target), case.program, case.robot, TOLERANCE, Claims(case.witnesses))
    assert result.ok
    assert result.diagnostics == ()
    certificate = result.value
    assert certificate.target == target
    assert [command.step for command in certificate.commands] == list(range(8))
    assert [command.kind for command in certificate.commands] == [
        *("joint", "joint", "line", "line", "joint", "line", "spline", "line")
    ]
    assert np.isclose(certificate.duration, 4 + 3 + 2 + 24 * 0.0475 + 3.2 + 2 + 6 + 2)
    assert 0 < certificate.position < TOLERANCE.position
    assert 0 < certificate.angle < TOLERANCE.angle
    text = case.text(target).split("\n")
    for command, job in zip(certificate.commands, case.jobs, strict=False):
        assert text[command.lines[0] - 1].startswith("X")
        moves = [line for line in text[command.lines[0] - 1 : command.lines[1]] if line.startswith("X")]
        assert len(moves) in (len(job.points), len(job.points) + 2)
        assert command.segments == len(job.points) + 2
    summary = certificate.summary()
    assert summary.startswith("path within 0.00")
    assert summary.endswith(" % of the limits")
    assert summary.isascii()


def test_json_is_plain_and_in_units():
    import json

    case = everything()
    certificate = certify(case.text(), case.program, case.robot, TOLERANCE, Claims(case.witnesses)).value
    data = json.loads(json.dumps(certificate.to_json(), allow_nan=False))
    assert np.isclose(data["duration_s"], certificate.duration)
    assert np.isclose(data["deviation"]["position_mm"], certificate.position * 1e3)
    assert np.isclose(data["tolerance"]["angle_deg"], 0.002)
    assert data["commands"][2]["segment_time_ms"] == 50.0
    assert np.isclose(data["commands"][3]["segment_time_ms"], 47.5)
    assert data["loads"]["velocity"]["name"] == certificate.worst("velocity").name
    # A value that can't be proved is null.
    unproved = certify(case.text(), case.program, case.robot, TOLERANCE).value.to_json()
    assert unproved["deviation"]["angle_deg"] is None
    assert json.dumps(unproved, allow_nan=False)


def test_a_motion_that_goes_nowhere_needs_no_lines():
    robot = industrial6()
    pose = tool_poses(robot.chain, Q0[None], np.eye(4))[0]
    free = hir.Timing(None)
    jobs = [
        Job(hir.JointMove(origin(0), hir.JointGoal(Q0), "LSPB", free), None),
        Job(hir.LineMove(origin(1), hir.PoseGoal(pose, np.eye(4)), "LSPB", free), None),
        Job(hir.SplineMove(origin(2), (hir.JointGoal(Q0),), "LSPB", free), None),
        Job(hir.Stop(origin(3)), None),
    ]
    result = certify(emit(robot, Q0, jobs), program(Q0, jobs), robot, TOLERANCE, Claims({2: Q0[None]}))
    assert result.ok
    assert result.value.duration == 0.0
    other = [*jobs]
    other[1] = Job(
        hir.LineMove(
            origin(1),
            hir.PoseGoal(line_pose(pose, [0, 0, 1e-3], [0, 0, 1], 0, np.ones(1))[0], np.eye(4)),
            "LSPB",
            free,
        ),
        None,
    )
    result = certify(emit(robot, Q0, other), program(Q0, other), robot, TOLERANCE, Claims({2: Q0[None]}))
    # the path of the spline begins at the programmed goal, too
    assert [finding.code for finding in result.diagnostics] == ["Y1160", "Y1159"]
    assert np.isclose(result.value.commands[1].deviation.position, 1e-3)


def test_half_a_turn_the_wrong_way_round_is_found():
    """A turn of 190 deg is executed as 170 deg in the other direction, which is the shorter path. This is
    found.
    """
    robot = industrial6()
    tool = np.eye(4)
    start = np.zeros(6)
    pose = tool_poses(robot.chain, start[None], tool)[0]
    for angle, good in ((170 * DEG, True), (190 * DEG, False)):
        goal = start + np.array([0, 0, 0, 0, 0, angle])
        end = pose.copy()
        end[:3, :3] = rotation([0, -1, 0], angle) @ pose[:3, :3]
        motion = hir.LineMove(origin(0), hir.PoseGoal(end, tool), "LSPB", hir.Timing(8.0))
        found = judged(robot, start, motion, joint_points(start, goal, 160), "50").deviation
        assert found.end_angle < 1e-8
        assert (found.angle < TOLERANCE.angle) == good


def test_a_tolerance_of_its_own_is_that_of_the_moving_frame():
    """A tolerance in the program is one of the moving frame, also for a joint motion: each joint's deviation
    is multiplied by its reach.
    """
    robot = industrial6()
    goal = Q0 + np.array([20, 10, 5, -20, 10, 0]) * DEG
    points = joint_points(Q0, goal, 60)
    points[30] += 1e-3 * DEG * np.array([0, 1, 0, 0, 0, 0])
    _, q, *_ = sample(Q0, points, 0.05)
    tool = tool_poses(robot.chain, q, FLANGE_FROM_TCP)[:, :3, 3]
    way = (goal - Q0) / np.linalg.norm(goal - Q0) ** 2
    line = Q0 + np.outer((q - Q0) @ way, goal - Q0)
    truth = np.linalg.norm(tool - tool_poses(robot.chain, line, FLANGE_FROM_TCP)[:, :3, 3], axis=1).max()
    link = hir.FrameLink("TCP", FLANGE_FROM_TCP, hir.FrameLink("FLANGE", np.eye(4)))
    for kind in (hir.JointMove, hir.SplineMove):
        target = hir.JointGoal(goal) if kind is hir.JointMove else (hir.JointGoal(goal),)
        plain = kind(replace(origin(0), moving=link), target, "LSPB", hir.Timing(3.0))
        witnesses = {} if kind is hir.JointMove else {0: goal[None]}
        assert judged(robot, Q0, plain, points, "50", witnesses).deviation.position == 0.0
        bound = judged(robot, Q0, replace(plain, tolerance=1.0), points, "50", witnesses).deviation.position
        assert truth <= bound <= 5.0 * truth
        for share, found in ((1.01, []), (0.99, ["Y1159"])):
            job = Job(replace(plain, tolerance=bound * share), points)
            result = certify(emit(robot, Q0, [job]), program(Q0, [job]), robot, TOLERANCE, Claims(witnesses))
            assert [finding.code for finding in result.diagnostics] == found
