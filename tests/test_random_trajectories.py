"""Tests of random trajectories like those of planners in ROS: they are executed at their times and within all
limits, and too fast ones are refused with a STRETCH that works.

A path through random joint positions is passed with a trapezoidal speed and sampled at a fixed rate, as by
MoveIt's time-optimal parameterization: the accelerations jump, at both ends, too. Waypoints are in the
program or in a file; they have velocities, velocities and accelerations, or neither. Only
tests/independent.py and scipy read and judge the text.

YARCLANG_RANDOM_TRAJECTORIES=5000 in the environment draws that many, for a night.
"""

import os
import re

import numpy as np
import pytest
from floors import exercises
from programs import compiled, robot_of
from scipy.interpolate import BPoly, CubicHermiteSpline, CubicSpline

from yarclang.diagnostics import Result
from yarclang.independent.arm import Arm
from yarclang.independent.reading import read, shares
from yarclang.semantics.motions.trajectory_file import TrajectoryFile
from yarclang.source import SourceFile

COUNT = int(os.environ.get("YARCLANG_RANDOM_TRAJECTORIES", "200"))
"""Number of trajectories for all robots and kinds together."""

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")
ARMS = {name: Arm.in_folder(robot_of(name).folder) for name in ROBOTS}
KINDS = ("positions", "velocities", "accelerations")

WITHIN, LATE = 1e-4, 1e-3
"""Largest distance of a joint from the path [rad or m], and largest error of time [s]."""

ROUNDED = 2e-8
"""Rounding error of the text's decimals [rad or m]."""

SURE, ROUND_OFF = 0.8, 1.3
"""A path that uses up to SURE of all limits must be accepted. One that uses ROUND_OFF of a limit can't be
accepted, although the executed motion may round its peaks off within the tolerance.
"""


class Trajectory:
    """Rows of a trajectory as written [deg or mm], and the path that they define, computed by scipy."""

    def __init__(self, random, arm, kind, use):
        """Draw a trajectory that uses about a share `use` of the limits."""
        self.kind = kind
        middle = np.array(arm.data["positions"]["HOME"], float)
        reach = np.minimum(middle - arm.lower, arm.upper - middle)
        far = random.choice([0.01, 0.05, 0.2])
        goals = middle + random.uniform(-far, far, (random.integers(2, 6), len(middle))) * reach
        way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(goals, axis=0) / reach, axis=1))))
        path = CubicSpline(way, np.round(goals, 4), bc_type="natural")
        # the speed along the path rises, stays and falls, each for a third of the time
        s = np.linspace(0.0, way[-1], 400)
        speed, curve = np.abs(path(s, 1)) / arm.velocity, np.abs(path(s, 2)) / arm.acceleration
        ramp = np.abs(path(s, 1)) / arm.acceleration
        peak = 1.5 * way[-1]
        asked = ramp * peak * 3.0 + curve * peak**2
        duration = max((speed * peak).max() / use, np.sqrt(asked.max() / use))
        step = min(random.choice([0.05, 0.1, 0.2]), duration / 4)
        times = np.append(np.arange(0.0, duration - 0.3 * step, step), duration)
        share = times / duration
        up, down = np.minimum(share, 1 / 3), np.maximum(share - 2 / 3, 0.0)
        at = way[-1] * (2.25 * up**2 + 1.5 * np.clip(share - 1 / 3, 0.0, 1 / 3) + 1.5 * down - 2.25 * down**2)
        rate = peak / duration * np.clip(np.minimum(share, 1.0 - share) * 3.0, 0.0, 1.0)[:, None]
        change = (3.0 * peak / duration**2 * np.where(share <= 1 / 3, 1, np.where(share >= 2 / 3, -1, 0)))[
            :, None
        ]
        self.times = np.round(times, 6)
        self.positions = np.round(path(at), 9)
        self.positions[0] = np.round(goals[0], 4)
        self.velocities = np.round(path(at, 1) * rate, 9) + 0.0
        self.velocities[[0, -1]] = 0.0
        self.accelerations = np.round(path(at, 2) * rate**2 + path(at, 1) * change, 9)
        self.is_file = bool(random.integers(2)) or len(times) > 20
        if not self.is_file:
            self.accelerations[0] = 0.0  # a line gives no acceleration for time 0

    def path(self, stretch=1.0):
        times = self.times * stretch
        if self.kind == "positions":
            return CubicSpline(times, self.positions, bc_type="clamped")
        velocities = self.velocities / stretch
        if self.kind == "velocities":
            return CubicHermiteSpline(times, self.positions, velocities)
        rows = np.stack((self.positions, velocities, self.accelerations / stretch**2), axis=1)
        return BPoly.from_derivatives(times, rows)

    def use(self, arm):
        """Return the largest share that the path uses of a limit of joint velocity, joint acceleration or
        motor velocity.
        """
        shares = np.linspace(0.0, 1.0, 50, endpoint=False)
        times = np.append(
            (self.times[:-1, None] + np.diff(self.times)[:, None] * shares).ravel(), self.times[-1]
        )
        path = self.path()
        velocity, acceleration = path(times, 1), path(times, 2)
        return max(
            (np.abs(velocity) / arm.velocity).max(),
            (np.abs(acceleration) / arm.acceleration).max(),
            (np.abs(velocity @ arm.counts.T) / arm.motor_velocity).max(),
        )

    def compiled(self, robot, stretch=""):
        rows = {"positions": 1, "velocities": 2, "accelerations": 3}[self.kind]
        parts = (self.positions, self.velocities, self.accelerations)[:rows]
        head = f"DEFAULT (mm,deg,s)\nSTART {_numbers(self.positions[0])}\n"
        if not self.is_file:
            words = ("", "VEL ", "ACC ")
            lines = []
            for number in range(1, len(self.times)):
                first, *rates = [
                    word + _numbers(part[number]) for word, part in zip(words, parts, strict=False)
                ]
                lines.append(f"{first} [{self.times[number]:.6f}] {' '.join(rates)}")
            body = ";\n  ".join(lines)
            return compiled(f"{head}P0010 MOVEJ_TIMED {body}{stretch}\n", robot=robot)
        names = robot_of(robot).joint_names
        endings = ("", "_velocity", "_acceleration")[:rows]
        header = ",".join(["time", *(name + ending for ending in endings for name in names)])
        table = np.hstack((self.times[:, None], *parts)).tolist()
        text = "\n".join([header, *(",".join(map(repr, row)) for row in table)])
        file = TrajectoryFile(SourceFile("path.csv", text))
        line = f'{head}P0010 MOVEJ_TIMED "path.csv"{stretch}\n'
        return compiled(line, robot=robot, load_table=lambda path, module: Result(file))


def _numbers(values):
    return " ".join(f"{value:.9f}" for value in values)


def judge(arm, trajectory, text, stretch=1.0):
    """Check the end, the times, the path and the limits of an emitted text against the trajectory."""
    _, commands = read(text)
    (done,) = commands.values()
    duration = trajectory.times[-1] * stretch
    assert -1e-9 <= done.duration - duration <= LATE + 1e-9
    used = shares(arm, done)
    assert all(share <= 1 + 1e-6 for name, share in used.items() if name != "jerk"), used
    for end, row in ((0.0, 0), (done.duration, -1)):
        assert np.abs(done.spline(end) - trajectory.positions[row]).max() < 2e-6
        assert np.abs(done.spline(end, nu=1)).max() < 1e-3
    times = np.linspace(0.0, done.duration, 8 * (len(done.control) - 3) + 1)
    path = trajectory.path(stretch)
    near = np.stack([path(np.clip(times + shift, 0.0, duration)) for shift in np.linspace(-LATE, LATE, 5)])
    q = done.spline(times)
    off = np.maximum(q - near.max(axis=0), near.min(axis=0) - q) * arm.si
    assert off.max() <= WITHIN + ROUNDED, off.max()


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
@exercises(certified=0.4, lines=0.1, files=0.1, stretched=0.3)
def test_trajectories_of_planners(tally, robot, kind):
    arm = ARMS[robot]
    random = np.random.default_rng([ROBOTS.index(robot), KINDS.index(kind), tally.drawn["certified"]])
    for _ in range(-(-COUNT // (len(ROBOTS) * len(KINDS)))):
        trajectory = Trajectory(random, arm, kind, random.uniform(0.2, 0.7) * random.choice([1.0, 1.0, 4.0]))
        use = trajectory.use(arm)
        made, found = trajectory.compiled(robot)
        errors = [one for one in found if one.is_error]
        tally.count("certified", not errors)
        tally.count("files" if trajectory.is_file else "lines", not errors)
        if not errors:
            assert use <= ROUND_OFF
            judge(arm, trajectory, made.text)
            continue
        assert use > SURE, (use, errors)
        (error,) = errors
        assert error.code == "Y0616", error
        stretch = re.search(r"the shortest STRETCH that works is ([0-9.]+)", error.help)
        assert stretch, error
        made, found = trajectory.compiled(robot, f" STRETCH {stretch[1]}")
        assert [one for one in found if one.is_error] == []
        factor = float(stretch[1])
        judge(arm, trajectory, made.text, factor)
        tally.count("stretched")
        # a stretch divides velocities by itself, and accelerations by its square
        assert max(1.0, np.sqrt(use / ROUND_OFF)) <= factor <= use / SURE, (use, factor)
