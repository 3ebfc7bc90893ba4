"""Measure the planner for RESULTS.md: `python benchmarks/motion.py`, in an environment with yarclang[dev].

The parts compare time-optimal laws with toppra's own law on 1,000 points, compare S-curves with ruckig,
measure the time of planning, and count how many commands an edit of 0.1 mm affects. Without ruckig (`pip
install ruckig`, or --peers FOLDER that contains it), the comparison of S-curves is left out.
"""

from __future__ import annotations

import argparse
import logging
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from yarclang.motion.cartesian import CartesianPath, along
from yarclang.motion.curve import Curve
from yarclang.motion.fit import fit
from yarclang.motion.limits import Grid, bounds_of
from yarclang.motion.path import Path
from yarclang.motion.paths.joint import JointPath
from yarclang.motion.paths.line import line_between
from yarclang.motion.paths.spline import through
from yarclang.motion.profile import load_profile
from yarclang.pipeline.stages import Request, check_program, plan_program
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Robot, Tolerance
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

GRID = Grid(0.0039844, 0.05, 1 / 4096e3)
"""Smallest, largest and step of segment times [s], as for the robots of the library."""
LINES = 100
TRIALS = 1_000


def main() -> None:
    """Measure everything, or the named parts, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--peers", help="a folder with ruckig")
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="which tables; all if none is named")
    options = parser.parse_args()
    if options.peers:
        sys.path.append(options.peers)
    logging.disable(logging.CRITICAL)
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    for name in options.parts or PARTS:
        PARTS[name](robot)


def optimal(robot: Robot) -> None:
    """Compare _TOPP [MIN] with toppra's own law."""
    print(
        "\n| _TOPP [MIN], 100 paths by chance | longer than toppra's law, mean | most | beyond 2 TM, "
        "most | of them above 0.2 % | "
        "largest share of a limit | time, median |"
    )
    print("|---|---|---|---|---|---|---|")
    bounds, profile = bounds_of(robot), load_profile("TOPP")
    for kind, what in enumerate(("joint lines", "splines in joint space", "lines of the frame")):
        longer, beyond, used, seconds = [], [], [], []
        for path in _paths(robot, kind, np.random.default_rng(3 + kind)):
            begun = time.perf_counter()
            curve = fit(path, profile, None, bounds, GRID, Tolerance())
            if not isinstance(curve, Curve):
                continue
            seconds.append(time.perf_counter() - begun)
            least = _toppra(path, robot)
            longer.append(curve.duration / least - 1.0)
            beyond.append((curve.duration - 2.0 * curve.segment) / least - 1.0)
            used.append(_largest_share(robot, curve))
            if len(longer) == LINES:
                break
        print(
            f"| {what} | {np.mean(longer):.2%} | {max(longer):.2%} | {max(beyond):.2%} | "
            f"{np.sum(np.array(beyond) > 0.002)} | {max(used):.2%} | "
            f"{statistics.median(seconds) * 1e3:.1f} ms |"
        )


def jerk_limited(robot: Robot) -> None:
    """Compare _SCURVE [MIN] with ruckig."""
    try:
        import ruckig
    except ImportError:
        print("\nruckig isn't installed: _SCURVE isn't compared")
        return
    random, bounds, profile = np.random.default_rng(3), bounds_of(robot), load_profile("SCURVE")
    losses, seconds = [], []
    for _ in range(3 * LINES):
        start = random.uniform(robot.limits.lower, robot.limits.upper)
        share = random.choice([0.02, 0.1, 0.5, 1.0])
        end = start + (random.uniform(robot.limits.lower, robot.limits.upper) - start) * share
        begun = time.perf_counter()
        curve = fit(JointPath(start, end), profile, None, bounds, GRID, Tolerance())
        seconds.append(time.perf_counter() - begun)
        assert isinstance(curve, Curve)
        way, counts = np.abs(end - start), np.abs(bounds.counts @ (end - start))
        problem = ruckig.InputParameter(1)
        problem.current_position, problem.target_position = [0.0], [1.0]
        problem.max_velocity = [min((bounds.velocity / way).min(), (bounds.motor_velocity / counts).min())]
        problem.max_acceleration = [(bounds.acceleration / way).min()]
        problem.max_jerk = [(bounds.jerk / way).min()]
        best = ruckig.Trajectory(1)
        ruckig.Ruckig(1).calculate(problem, best)
        losses.append(curve.duration / best.duration - 1.0)
    print(
        "\n| _SCURVE [MIN], 300 joint lines by chance | longer than ruckig's, mean | most | least | "
        "time, median |"
    )
    print("|---|---|---|---|---|")
    print(
        f"| within the same limits | {np.mean(losses):.2%} | {max(losses):.2%} | {min(losses):.3%} | "
        f"{statistics.median(seconds) * 1e3:.2f} ms |"
    )


def costs(robot: Robot) -> None:
    """Measure the cost of planning."""
    head = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]\n"
    line = "MOVEL{} 200 1074.4 1326 10 -5 20 {}\n"
    zigzag = "".join(
        f"P{10 * k:05d} MOVEL {100 * (k % 2)} 1174.4 {1026 + 1.5 * k} 0 0 0 {{}} BLEND 0.6\n"
        for k in range(2, 202)
    )
    programs = {
        "MOVEL [20] of 400 samples": (head + "P0020 " + line.format("", "[20]"), 1, "3 ms"),
        "MOVEL [MIN]": (head + "P0020 " + line.format("", "[MIN]"), 1, ""),
        "MOVEL_SCURVE [MIN]": (head + "P0020 " + line.format("_SCURVE", "[MIN]"), 1, ""),
        "MOVEL_TOPP [MIN]": (head + "P0020 " + line.format("_TOPP", "[MIN]"), 1, "15 ms"),
        "MOVEL [V 100]": (head + "P0020 " + line.format("", "[V 100]"), 1, ""),
        "a chain of 200 lines [2], a motion": (head + zigzag.replace("{}", "[2]"), 200, ""),
        "a chain of 200 lines [V 100], a motion": (head + zigzag.replace("{}", "[V 100]"), 200, ""),
    }
    print("\n| planned, without reading and checking | time | on a core | goal |\n|---|---|---|---|")
    before = _planned(robot, head, 30)
    for what, (text, motions, goal) in programs.items():
        wall, cpu = (
            (one - two) / motions * 1e3
            for one, two in zip(_planned(robot, text, 1 if motions > 1 else 30), before, strict=True)
        )
        print(f"| {what} | {wall:.2f} ms | {cpu:.2f} ms | {f'under {goal}' if goal else ''} |")


def edits(robot: Robot) -> None:
    """Count the edits of a value by 0.1 mm that change the configuration of another command."""
    random = np.random.default_rng(11)
    other, refused = 0, 0
    for _ in range(TRIALS):
        poses = [
            [*(np.array([0.0, 1000.0, 1000.0]) + random.uniform(-350, 350, 3)), *random.uniform(-25, 25, 3)]
            for _ in range(4)
        ]
        first = _ends(robot, poses)
        edited = [list(pose) for pose in poses]
        at = int(random.integers(0, 4))
        edited[at][int(random.integers(0, 3))] += 0.1
        second = _ends(robot, edited)
        if first is None or second is None:
            refused += 1
            continue
        apart = np.degrees(np.abs(first - second).max(axis=1))
        other += bool((np.delete(apart, at) > 5.0).any())
    done = TRIALS - refused
    print(
        "\n| an edit of 0.1 mm in programs of 4 MOVEJ_RPY | programs | another command changes its "
        "configuration | goal |"
    )
    print("|---|---|---|---|")
    print(f"| both can be planned | {done:,} | {other} ({other / done:.2%}) | at most 1 % |")


PARTS: dict[str, Callable[[Robot], None]] = {
    "optimal": optimal,
    "jerk_limited": jerk_limited,
    "costs": costs,
    "edits": edits,
}


def _paths(robot: Robot, kind: int, random: np.random.Generator) -> Iterator[Path]:
    """Yield random paths of a kind, without end."""
    lower, upper = robot.limits.lower * 0.6, robot.limits.upper * 0.6
    while True:
        start = random.uniform(lower, upper)
        if kind == 0:
            yield JointPath(start, random.uniform(lower, upper))
        elif kind == 1:
            points = np.vstack([start, random.uniform(lower, upper, (4, robot.size))])
            yield through(points, robot.chain.is_prismatic)
        else:
            pose = flange_poses(robot.chain, start[None])[0]
            end = pose.copy()
            end[:3, 3] += random.normal(size=3) * 0.15
            line = line_between(pose, end)
            assert line is not None
            path = along(robot.chain, robot.limits, np.eye(4), line, start)
            if isinstance(path, CartesianPath):
                yield path


def _toppra(path: Path, robot: Robot) -> float:
    """Return the duration [s] of toppra's own law on 1,000 points, with the robot's full limits."""
    import toppra
    from toppra import constraint

    bounds = bounds_of(robot)
    places = np.linspace(0.0, 1.0, 1_001)
    joints = path.joints(places)
    # a motor is treated as a further joint, without an acceleration limit
    rows = np.concatenate((joints, joints @ bounds.counts.T / bounds.motor_velocity), axis=1)
    size = bounds.counts.shape[0]
    velocity = np.concatenate((robot.limits.velocity, robot.actuation.velocity / bounds.motor_velocity))
    acceleration = np.concatenate((robot.limits.acceleration, np.full(size, 1e4)))
    instance = toppra.algorithm.TOPPRA(
        [
            constraint.JointVelocityConstraint(np.stack((-velocity, velocity), axis=1)),
            constraint.JointAccelerationConstraint(
                np.stack((-acceleration, acceleration), axis=1),
                discretization_scheme=constraint.DiscretizationType.Interpolation,
            ),
        ],
        toppra.SplineInterpolator(places, rows),
        gridpoints=places,
        parametrizer="ParametrizeConstAccel",
    )
    _, speed, _ = instance.compute_parameterization(0.0, 0.0)
    return float((2.0 * np.diff(places) / (speed[1:] + speed[:-1])).sum())


def _largest_share(robot: Robot, curve: Curve) -> float:
    """Return the largest share of a limit of velocity, acceleration or motor speed at 20 times in each
    segment.
    """
    _, v, a = curve.sample(np.linspace(0.0, curve.duration, 20 * curve.segments + 1))
    motors = v @ bounds_of(robot).counts.T
    return float(
        max(
            np.abs(v / robot.limits.velocity).max(),
            np.abs(a / robot.limits.acceleration).max(),
            np.abs(motors / robot.actuation.velocity).max(),
        )
    )


def _plan(robot: Robot, text: str) -> Any:
    """Return a function that plans a program. The program is read and checked beforehand."""
    request = Request(robot)
    program = check_program(parse(SourceFile("benchmark.yarc", text)).value, request).value
    assert program is not None
    return lambda: plan_program(program, request).value


def _planned(robot: Robot, text: str, rounds: int) -> tuple[float, float]:
    """Return the median time of planning a program by the clock [s], and on a core [s]."""
    run = _plan(robot, text)
    assert run() is not None
    seconds, cores = [], []
    for _ in range(rounds):
        begun, cpu = time.perf_counter(), time.process_time()
        run()
        seconds.append(time.perf_counter() - begun)
        cores.append(time.process_time() - cpu)
    return statistics.median(seconds), statistics.median(cores)


def _ends(robot: Robot, poses: list[list[float]]) -> Any:
    """Return the joint positions (k, n) [rad] of MOVEJ_RPY to poses; None if the program is refused."""
    lines = ["DEFAULT {TCP} [MIN] (mm,deg,s) {B}", "START 0 -10 -40 0 50 0"]
    for number, pose in enumerate(poses, 1):
        lines.append(f"P{number:04d} MOVEJ_RPY {' '.join(f'{value:.3f}' for value in pose)}")
    plan = _plan(robot, "\n".join(lines) + "\n")()
    return None if plan is None else np.array([motion.path.end for motion in plan.motions])


if __name__ == "__main__":
    main()
