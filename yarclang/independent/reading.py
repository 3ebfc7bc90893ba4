"""Emitted texts as the controller executes them: densely sampled cubic B-splines."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from yarclang.independent.arm import Arm, Array


@dataclass
class Executed:
    """The motion of one command as the controller executes it.

    Attributes:
        control: control points (N, n) [deg, mm].
        segment: time of a segment [s].
        duration: time of the command [s].
        spline: joint positions as a function of time, with derivatives.
    """

    control: Array
    segment: float
    duration: float = field(init=False)
    spline: Any = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.control) - 3
        self.duration = n * self.segment
        self.spline = BSpline(np.arange(-3, n + 4) * self.segment, self.control, 3)

    def sample(self, order: int = 0, per_segment: int = 8) -> Array:
        """Return joint positions (N, n), or a derivative, at evenly spaced times."""
        n = len(self.control) - 3
        times = np.linspace(0.0, self.duration, n * per_segment + 1)
        values: Array = self.spline(times, nu=order)
        return values


def read(text: str) -> tuple[Array, dict[int, Executed]]:
    """Return the start [deg, mm] and the executed commands of a text, by step."""
    lines = text.split("\n")
    table: dict[int, tuple[int, int]] = {}
    for line in lines:
        if found := re.match(
            r"; command (\d+) (\S+) (\S+) \d+ (\d+) (\d+)(?: blend \d+)?(?: any-jerk)?$", line
        ):
            table[int(found[1])] = (int(found[4]), int(found[5]))
    start = _axes(lines[lines.index("RAPID") + 2])
    tm: float | None = None
    sequences: list[tuple[float, list[int], list[Array]]] = []
    for number, line in enumerate(lines, 1):
        if line.startswith("TM"):
            tm = float(line[2:])
            sequences.append((tm, [], []))
        elif line and line[0] in "XYZUVWABC" and tm is not None and line != "CLOSE":
            sequences[-1][1].append(number)
            sequences[-1][2].append(_axes(line))
    commands: dict[int, Executed] = {}
    stands = start
    for tm, numbers, points in sequences:
        f = np.array([stands] * 3 + points + [points[-1]] * 2)
        position = {number: k + 3 for k, number in enumerate(numbers)}
        at = 0  # the knot at which the command begins
        for step, (first, last) in table.items():
            if first not in position:
                continue
            end = len(f) - 3 if position[last] == len(f) - 3 else position[last] - 2
            commands[step] = Executed(f[at : end + 3], tm * 1e-3)
            at = end
        assert at == len(f) - 3
        stands = points[-1]
    return start, commands


def _axes(line: str) -> Array:
    return np.array([float(value) for value in re.findall(r"[A-Z](-?[0-9.]+)", line)])


def shares(arm: Arm, executed: Executed) -> dict[str, float]:
    """Return the largest fraction of each limit that an executed command uses."""
    q, v, a, j = (executed.sample(order) for order in range(4))
    span = (arm.upper - arm.lower) / 2
    return {
        "position": np.abs((q - (arm.upper + arm.lower) / 2) / span).max(),
        "velocity": np.abs(v / arm.velocity).max(),
        "acceleration": np.abs(a / arm.acceleration).max(),
        "jerk": np.abs(j / arm.jerk).max(),
        "motor": np.abs(v @ arm.counts.T / arm.motor_velocity).max(),
    }


def off_line(arm: Arm, executed: Executed, goal_point: Array, goal_rotation: Any) -> tuple[float, float]:
    """Return the largest deviation of an executed command from the straight line to a goal, as distance [mm]
    and angle [deg].
    """
    points, rotations = arm.poses(executed.sample(per_segment=4))
    start_point, start_rotation = points[0], rotations[0]
    shift = goal_point - start_point
    turn = start_rotation.inv() * goal_rotation
    # Parameter of the nearest point on the line for each sample. Position and angle are weighted by their
    # tolerances and combined.
    weight_p, weight_a = 1 / 0.02**2, 1 / np.radians(0.002) ** 2
    turned = (start_rotation.inv() * rotations).as_rotvec() @ turn.as_rotvec()
    whole = weight_p * shift @ shift + weight_a * turn.magnitude() ** 2
    s = np.clip((weight_p * (points - start_point) @ shift + weight_a * turned) / max(whole, 1e-30), 0.0, 1.0)
    wanted = Slerp([0, 1], Rotation.concatenate([start_rotation, goal_rotation]))(s)
    distance = np.linalg.norm(points - (start_point + s[:, None] * shift), axis=1).max()
    return float(distance), float(np.degrees((wanted.inv() * rotations).magnitude().max()))


def off_joint_line(executed: Executed, goal: Array) -> float:
    """Return the largest distance of any joint from the straight line in joint space to a goal [deg]."""
    q = executed.sample()
    start = q[0]
    way = goal - start
    # Project each sample onto the line, within its ends.
    s = np.clip((q - start) @ way / max(way @ way, 1e-30), 0.0, 1.0)
    return float(np.abs(q - (start + s[:, None] * way)).max())


def off_spline(executed: Executed, waypoints: list[Array]) -> float:
    """Return the largest distance of any joint from the natural spline through the start and waypoints
    [deg].
    """
    q = executed.sample()
    through = [q[0]]
    for waypoint in waypoints:
        if np.linalg.norm(waypoint - through[-1]) > 1e-9:
            through.append(np.asarray(waypoint))
    if len(through) == 1:
        return float(np.abs(q - q[0]).max())
    points = np.array(through)
    knots = np.concatenate(([0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    curve = CubicSpline(knots, points, bc_type="natural")
    s = np.linspace(0, knots[-1], 20 * len(q))
    path = curve(s)
    # The path is a polyline of fine samples, whose own error is far below the tolerance.
    worst, at = 0.0, 0
    for point in q:
        window = path[at : at + 2000]
        k = at + int(np.argmin(np.linalg.norm(window - point, axis=1)))
        at = max(0, k - 200)
        near = path[max(0, k - 1) : k + 2]
        worst = max(worst, min(_to_segment(point, near[i], near[i + 1]) for i in range(len(near) - 1)))
    return worst


def _to_segment(point: Array, a: Array, b: Array) -> float:
    way = b - a
    square = max(float(way @ way), 1e-30)
    t = np.clip((point - a) @ way / square, 0.0, 1.0)
    return float(np.abs(point - a - t * way).max())


def overlaps(text: str) -> dict[int, int]:
    """Return, for each command that overlaps with the next one, the number of overlapping segments, by
    step.
    """
    found = re.finditer(r"^; command (\d+) .* blend (\d+)(?: any-jerk)?$", text, re.MULTILINE)
    return {int(one[1]): int(one[2]) for one in found}
