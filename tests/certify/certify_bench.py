"""Shared by the tests of certify/: robots as data, a small planner and emitter of the tests, dense sampling.

Nothing here uses motion/ or backend_pmac/, so the judge is tested with texts that the planner hasn't written.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from yarclang import hir
from yarclang.pmac.controller import TurboPmac
from yarclang.robot.actuation import to_counts
from yarclang.robot.kinematics.fk import poses_and_jacobians, tool_poses
from yarclang.robot.model import Actuation, Chain, Limits, Robot, Tolerance
from yarclang.source import SourceFile, Span

DEG = np.pi / 180.0
SOURCE = SourceFile("bench.yarc", "P0001 ...\nP0002 ...\n")
FLANGE_FROM_TCP = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0.1], [0, 0, 1, 0], [0, 0, 0, 1]])


@cache
def industrial6(**changes) -> Robot:
    """Return the six-axis arm of the conformance suite."""
    origins = [(0, 0, 0.23), (0, 0.2, 0.449), (0, 0, 0.89), (0, 0.4369, 0.195), (0, 0.1995, 0), (0, 0.238, 0)]
    axes = [(0, 0, 1), (1, 0, 0), (1, 0, 0), (0, -1, 0), (1, 0, 0), (0, -1, 0)]
    points = np.cumsum(np.array(origins), axis=0)
    flange = np.eye(4)
    flange[:3, 3] = points[-1]
    screws = [
        np.r_[-np.cross(axis, point), axis] for axis, point in zip(np.array(axes, float), points, strict=True)
    ]
    lower, upper = np.array([[-170, -80, -170, -180, -120, -360], [170, 90, 80, 180, 120, 360]]) * DEG
    coupling = np.eye(6)
    coupling[2, 1] = 1.0
    gear = np.array([25532.8278, 25667.875, 29308.7083, 7110.1274, 13285.5409, 11104.5417])
    return _robot(
        "INDUSTRIAL6",
        Chain(np.array(screws), flange),
        Limits(lower, upper, *(np.full(6, x * DEG) for x in (60.0, 240.0, 2000.0, 1000.0))),
        Actuation(gear, coupling, np.zeros(6), np.array([1.6e6, 1.6e6, 1.9e6, 4.5e5, 8.5e5, 7e5])),
        ("X", "Y", "Z", "A", "B", "C"),
        ("revolute",) * 6,
        **changes,
    )


@cache
def railed() -> Robot:
    """Return an arm with a rail, two turning joints, a sliding joint in the middle and a wrist joint."""
    z, x = np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
    screws = [
        np.r_[x, 0, 0, 0],
        np.r_[-np.cross(z, [0.1, 0, 0.3]), z],
        np.r_[-np.cross(x, [0.1, 0.2, 0.5]), x],
        np.r_[0, 1, 0, 0, 0, 0],
        np.r_[-np.cross(z, [0.1, 0.9, 0.5]), z],
    ]
    flange = np.eye(4)
    flange[:3, 3] = [0.1, 1.2, 0.55]
    si = np.array([1e-3, DEG, DEG, 1e-3, DEG])
    limits = np.array([[2000, 170, 100, 300, 180], [900, 90, 90, 300, 120], [4000, 400, 400, 2000, 500]])
    return _robot(
        "RAILED",
        Chain(np.array(screws), flange),
        Limits(
            -limits[0] * si,
            limits[0] * si,
            limits[1] * si,
            limits[2] * si,
            10 * limits[2] * si,
            5 * limits[2] * si,
        ),
        Actuation(np.array([800.0, 9000, 9000, 2000, 5000]), np.eye(5), np.zeros(5), np.full(5, 2e6)),
        ("U", "A", "B", "V", "C"),
        ("prismatic", "revolute", "revolute", "prismatic", "revolute"),
    )


def _robot(name, chain, limits, actuation, axes, kinds, **changes) -> Robot:
    n = len(axes)
    controller = TurboPmac(
        kind="turbo-pmac",
        coordinate_system=1,
        axes=axes,
        motors=tuple(range(1, n + 1)),
        feedback=tuple(f"P{i}" for i in range(1, n + 1)),
        largest_segment=0.05,
        ixx08=96,
        rotary_words=480,
        hold_time=0.25,
        rapid_share=0.2,
        i8=2,
        i10=3713707,
    )
    return Robot(
        name=name,
        title=name,
        folder=Path("robots"),
        urdf="",
        joint_names=tuple(f"J{i}" for i in range(1, n + 1)),
        joint_kinds=kinds,
        chain=chain,
        limits=limits,
        flange_from_frame={"FLANGE": np.eye(4), "TCP": FLANGE_FROM_TCP},
        positions={"HOME": np.zeros(n)},
        actuation=actuation,
        controller=controller,
        tolerance=Tolerance(),
        fingerprint="0" * 64,
        **changes,
    )


# a planner: laws, paths, control points


def grid_law(n: int, ramp: int = 2) -> np.ndarray:
    """Return the control values of s (n + 3,) for an LSPB law with ramps, on a grid of n segments: 0, 0, 0
    ... 1, 1, 1.
    """
    b = max(round(n / 3), 2 * ramp)
    k = np.arange(n + 1)
    up = np.clip(np.minimum(k, b - k) / ramp, 0, 1)
    down = np.clip(np.minimum(k - (n - b), n - k) / ramp, 0, 1)
    sigma = np.r_[0.0, 0.0, np.cumsum(np.cumsum(up - down))]
    return np.r_[0, 0, 0, sigma[3:-3] / sigma[-1], 1, 1, 1]


def knots(control: np.ndarray) -> np.ndarray:
    """Return the executed values at the knots."""
    return (control[:-2] + 4 * control[1:-1] + control[2:]) / 6


def inverted(values: np.ndarray) -> np.ndarray:
    """Return the move lines (n - 2, m) of a motion in n segments whose values at the knots are `values`
    (n + 1, m). Only the knots 2 to n - 2 can be chosen.
    """
    start, end, wanted = values[0], values[-1], values[2:-2]
    size = len(wanted)
    matrix = 4 * np.eye(size) + np.eye(size, k=1) + np.eye(size, k=-1)
    right = 6 * wanted
    right[0] -= start
    right[-1] -= end
    # The control point before the first unknown one is the start, and the last control point is the end.
    return np.vstack([start, np.linalg.solve(matrix, right), end])[1:]


def joint_points(start, goal, n, ramp=2):
    """Return the move lines (n - 2, axes) of a straight joint motion in n segments."""
    return start + grid_law(n, ramp)[3:-2, None] * (np.asarray(goal) - start)


def curve_points(curve, n, ramp=2):
    """Return the move lines of a motion along curve(s) -> (k, axes) in n segments."""
    s = knots(grid_law(n, ramp))
    return inverted(curve(s))


def rotation(axis, angle) -> np.ndarray:
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def line_pose(start, way, axis, angle, s) -> np.ndarray:
    """Return poses (k, 4, 4) on a line: at shares `s`, shifted from `start` by the vector `way` and rotated
    by `angle` about `axis`.
    """
    poses = np.tile(np.eye(4), (len(s), 1, 1))
    poses[:, :3, 3] = start[:3, 3] + np.outer(s, way)
    poses[:, :3, :3] = [rotation(axis, x * angle) @ start[:3, :3] for x in s]
    return poses


def inverse(robot, poses, q, tool=FLANGE_FROM_TCP) -> np.ndarray:
    """Return joint positions (k, n) of poses (k, 4, 4), by Newton's method from one pose to the next,
    beginning at `q`.
    """
    answer = []
    for pose in poses:
        for _ in range(30):
            here, jacobian = poses_and_jacobians(robot.chain, q[None], tool)
            turn = here[0, :3, :3] @ pose[:3, :3].T
            vee = np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]]) / 2
            error = np.r_[pose[:3, 3] - here[0, :3, 3], vee]
            q = q + np.linalg.lstsq(jacobian[0], error, rcond=None)[0]
            if np.abs(error).max() < 1e-13:
                break
        assert np.abs(error).max() < 1e-9
        answer.append(q)
    return np.array(answer)


def arm_line(robot, start_q, way, axis, angle, tool=FLANGE_FROM_TCP):
    """Return the curve q(s) of a Cartesian line from `start_q`, and its goal pose."""
    start = tool_poses(robot.chain, start_q[None], tool)[0]

    def curve(s):
        return inverse(robot, line_pose(start, np.asarray(way), axis, angle, s), start_q, tool)

    return curve, line_pose(start, np.asarray(way), axis, angle, np.array([1.0]))[0]


# an emitter


def origin(step: int, name: str = "MOVE") -> hir.Origin:
    return hir.Origin(f"P{step + 1:04d}", name, SOURCE, Span.on_line(step + 1, 1, 5))


@dataclass
class Job:
    """A command: its primitive, and its move lines up to the end [rad, m] (None for a STOP) at TM [ms].

    `blend` is the number in the map if the motion flows into the next one. `any_jerk` is True if the map says
    that the jerk has no limit. `puts` are lines before move line number `put_at`.
    """

    motion: object
    points: np.ndarray | None
    tm: str = "50"
    blend: int | None = None
    puts: tuple[str, ...] = ()
    put_at: int = 0
    any_jerk: bool = False


def program(start, jobs) -> hir.Program:
    signals = {
        job.motion.output.variable: job.motion.output for job in jobs if isinstance(job.motion, hir.SetOutput)
    }
    outputs = tuple(hir.Output(signal, None) for signal in signals.values())
    return hir.Program(SOURCE, np.asarray(start, float), tuple(job.motion for job in jobs), outputs)


def number(x: float, decimals: int) -> str:
    text = f"{x:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def emit(robot, start, jobs, target="rotary", decimals=9) -> str:
    """Return the text of a program, in the form that the reader accepts."""
    axes, units, controller = robot.controller.axes, robot.axis_units, robot.controller

    def move(q):
        return "".join(letter + number(x, decimals) for letter, x in zip(axes, q / units, strict=True))

    times = [float(job.tm) * 1e-3 for job in jobs if job.points is not None]
    needed = math.ceil((controller.hold_time / 2 + 0.1) / min(times, default=0.05))
    body = ["CLOSE ALL", "END GATHER", "DELETE GATHER", f"&{controller.coordinate_system}"]
    if target == "rotary":
        body += ["".join(f"#{m}J/" for m in controller.motors), "DELETE ROT", "I16=", "I17=", "DEFINE ROT "]
        body += [
            "B0",
            "OPEN ROT",
            "CLEAR",
            "RAPID",
            "ABS",
            move(np.asarray(start)),
            "DWELL0",
        ]
    else:
        body += ["OPEN PROG 1 CLEAR", "P8101=1", "WHILE(P8101=1)", "P8101=0"]
        for motor, counts in zip(controller.motors, to_counts(robot, np.asarray(start)), strict=True):
            value = round(counts * 32 * controller.ixx08)
            minus = f"-{value}" if value >= 0 else f"+{-value}"
            body += [f"IF(ABS(M{motor}61{minus})>3072)", "P8101=1", f'SEND"motor {motor} is off"', "ENDIF"]
        body += ["IF(P8101=1)", "STOP", "ENDIF", "ENDWHILE", "ABS"]
    body.append("SPLINE1")
    places, moves, tm, duration = {}, [], None, 0.0
    for step, job in enumerate(jobs):
        if job.points is None:
            continue
        if job.tm != tm:
            body.append(f"TM{job.tm}")
            tm = job.tm
        lines = [move(q) for q in job.points]
        following = next((other for other in jobs[step + 1 :] if other.points is not None), None)
        ends = following is None or following.tm != tm
        if not ends and job.blend is None:
            lines += [lines[-1]] * 2
        duration += (len(lines) + 2 * ends) * float(job.tm) * 1e-3
        if job.puts:
            lines[job.put_at : job.put_at] = job.puts
        begins = len(body) + (len(job.puts) if job.put_at == 0 else 0)
        places[step] = (begins, len(body) + len(lines) - 1)
        body += lines
        moves += [row for row in range(places[step][0], len(body)) if body[row].startswith(axes[0])]
    count = len(body) - body.index("CLEAR") - 1 if target == "rotary" else 0
    # From each line on, this number of lines contains the moves of a hold.
    spans = [
        moves[min(k + needed, len(moves)) - 1] - (moves[k - 1] if k else moves[0] - 1)
        for k in range(len(moves))
    ]
    low = needed if count <= needed + max(5, needed // 2) + 2 else max(spans)
    full = low + max(5, low // 2)
    if target == "rotary":
        marks = body.index("I16=")
        body[marks : marks + 3] = [
            f"I16={low}",
            f"I17={full}",
            f"DEFINE ROT {max(480, (full + 2) * (len(axes) + 2))}",
        ]
    if count > full + 2:
        behind = moves[-1] + 1
        body[behind:behind] = ["P8100=P8100&2"] * max(low + 2 - (len(body) - behind), 1)
        body.insert(moves[0], "P8100=1")
        places = {
            step: (first + (first >= moves[0]), last + (last >= moves[0]))
            for step, (first, last) in places.items()
        }
    stands = "".join(
        f"{letter}{value:.{decimals}f}" for letter, value in zip(axes, np.asarray(start) / units, strict=True)
    )
    header = [
        "; yarcc test: bench.yarc",
        f"; target {target}",
        f"; robot {robot.name} {robot.fingerprint}",
        f"; program {'0' * 64}",
        "; made with a free remark, R and all",
        f"; start {stands} (deg)",
        f"; duration {duration:.3f} s",
        {
            "rotary": "; loading moves nothing; R moves the robot slowly to the start, then runs the program",
            "prog": "; loading moves nothing; with all motors closed-loop, &1B1R runs it, from the start only",  # noqa: E501
        }[target],
        "; commands: step, index, name, line in the source, first and last line of the moves in this file",
        "; certificate -",
        "; sha256 -",
    ]
    count, entries = len(header) + len(jobs), []
    for step, job in enumerate(jobs):
        made, place = job.motion.origin, "- -"
        if step in places:
            first, last = places[step]
            place = f"{count + first + 1} {count + last + 1}"
            if job.blend is not None:
                place += f" blend {job.blend}"
            if job.any_jerk:
                place += " any-jerk"
        entries.append(f"; command {step} {made.index or '-'} {made.name} {made.span.line} {place}")
    return "\n".join([*header, *entries, *body, "CLOSE"]) + "\n"


# dense sampling


def sample(start, points, h, per_segment=40):
    """Sample a command densely. Return the times (k,); positions, velocities and accelerations at these times
    (k, n); and the jerk of each segment.
    """
    f = np.vstack([np.tile(start, (3, 1)), points, np.tile(points[-1], (2, 1))])
    u = np.linspace(0, 1, per_segment + 1)[None, :, None]
    a, b, c, d = (f[i : len(f) - 3 + i, None, :] for i in range(4))
    x = (
        (1 - u) ** 3 * a + (3 * u**3 - 6 * u**2 + 4) * b + (-3 * u**3 + 3 * u**2 + 3 * u + 1) * c + u**3 * d
    ) / 6
    v = (-((1 - u) ** 2) * a + (3 * u**2 - 4 * u) * b + (-3 * u**2 + 2 * u + 1) * c + u**2 * d) / (2 * h)
    acc = ((1 - u) * a + (3 * u - 2) * b + (1 - 3 * u) * c + u * d) / h**2
    j = (d - 3 * c + 3 * b - a) / h**3
    t = (np.arange(len(f) - 3)[:, None] + u[..., 0]) * h
    flat = [array.reshape(-1, f.shape[1]) for array in (x, v, acc)]
    return t.ravel(), *flat, j[:, 0]


# a whole program that must pass


@dataclass(frozen=True)
class Case:
    robot: Robot
    start: np.ndarray
    jobs: tuple[Job, ...]
    witnesses: dict[int, np.ndarray]

    @property
    def program(self) -> hir.Program:
        return program(self.start, self.jobs)

    def text(self, target="rotary") -> str:
        return emit(self.robot, self.start, self.jobs, target)


def natural(points) -> object:
    """Return curve(share of the length) of the natural spline over chord length, by another library."""
    from scipy.interpolate import CubicSpline

    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    spline = CubicSpline(s, points, bc_type="natural")
    return lambda share: spline(share * s[-1])


@cache
def everything() -> Case:
    """Return a program with all kinds of motions and goals, at three segment times. Motions 1 and 2 are in
    one sequence.
    """
    robot = industrial6()
    start = np.array([10, 20, -30, 40, 50, -60]) * DEG
    home = np.array([30, 0, -10, 20, 30, 0]) * DEG
    jobs: list[Job] = []

    def joint(goal_of, goal, n, tm):
        here = jobs[-1].points[-1] if jobs else start
        made = origin(len(jobs), "MOVEJ")
        motion = hir.JointMove(made, goal_of(here, goal), "LSPB", hir.Timing(n * float(tm) * 1e-3))
        jobs.append(Job(motion, joint_points(here, goal, n), tm))

    def line(way, axis, angle, n, tm, delta=False):
        here = jobs[-1].points[-1]
        curve, pose = arm_line(robot, here, way, axis, angle)
        flange = tool_poses(robot.chain, here[None], np.eye(4))[0, :3, :3]
        goal = hir.PoseGoal(pose, FLANGE_FROM_TCP)
        if delta:
            # The same motion, given in axes that are fixed to the flange and rotated.
            axes = rotation([1, 1, 0], 0.4)
            there = flange @ axes
            turn = there.T @ rotation(axis, angle) @ there
            goal = hir.PoseDelta(there.T @ np.asarray(way), turn, axes, True, FLANGE_FROM_TCP)
        motion = hir.LineMove(origin(len(jobs), "MOVEL"), goal, "LSPB", hir.Timing(n * float(tm) * 1e-3))
        jobs.append(Job(motion, curve_points(curve, n), tm))

    joint(lambda _, q: hir.JointGoal(q), home, 80, "50")
    joint(lambda here, q: hir.JointDelta(q - here), home + 0.2, 60, "50")
    line([0.1, 0.05, -0.08], [1, 2, 3], 0.3, 40, "50")
    line([0.0, 0.0, 0.03], [0, 0, 1], 0.0, 24, "47.5")
    pose = tool_poses(robot.chain, home[None], FLANGE_FROM_TCP)[0]
    joint(lambda *_: hir.PoseGoal(pose, FLANGE_FROM_TCP), home, 64, "50")
    line([-0.05, 0.02, 0.06], [0, 1, 0], -0.2, 40, "50", delta=True)
    here = jobs[-1].points[-1]
    way = (
        here
        + np.array(
            [[10, 5, 3, -10, 5, 0], [-2, 10, 8, 5, -5, 15], [-2, 10, 8, 5, -5, 15], [0, 0, 0, 0, 0, 5]]
        )
        * DEG
    )
    points = curve_points(natural(np.vstack([here, way[[0, 1, 3]]])), 120)
    goals = [hir.JointGoal(q) for q in way]
    goals[1] = goals[2] = hir.PoseGoal(tool_poses(robot.chain, way[1:2], FLANGE_FROM_TCP)[0], FLANGE_FROM_TCP)
    spline = hir.SplineMove(origin(len(jobs), "MOVEJ_SPLINE"), tuple(goals), "LSPB", hir.Timing(6.0))
    jobs.append(Job(spline, points, "50"))
    line([0.0, 0.0, 0.0], [0, 0, 1], 0.25, 40, "50")
    jobs.append(Job(hir.Stop(origin(len(jobs), "STOP")), None))
    return Case(robot, start, tuple(jobs), {6: way})
