"""Measure tool paths of thousands of short motions: the compiler's time and memory, and the speed of the
tool.

python benchmarks/toolpaths.py [COUNT] [--robot NAME] [--path weld|bead|pocket|spiral] [--turning] [--rounds
N] [--run]

The ideal law is TOPP-RA's on the path that our text executes, at ten points a motion, with the same limits of
velocity, acceleration and motors and the same speed of the tool, but without a jerk limit. Both laws are
measured on the first `IDEAL` motions.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import measure

IDEAL = 400
SPEED = 50.0
TOLERANCE, BALL = 0.05, 0.3
CENTRES = {"INDUSTRIAL6": (0.0, 1050.0, 1000.0), "TRACKED_MANIPULATOR": (700.0, 0.0, 500.0)}
Points = list[tuple[float, float, float]]


def main() -> None:
    """Measure the task of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--robot", default="INDUSTRIAL6", choices=sorted(CENTRES))
    parser.add_argument("--path", default="spiral", choices=sorted(PATHS))
    parser.add_argument("--turning", action="store_true", help="turn to and fro, by up to 1 deg/mm")
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--run", action="store_true", help="run it on the simulator, a hundred times as fast")
    parser.add_argument("--ideal", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.ideal:
        print(
            json.dumps(
                share_of_ideal(text(asked.robot, asked.path, IDEAL, turning=asked.turning), asked.robot)
            )
        )
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "path.yarc"
        file.write_text(text(asked.robot, asked.path, asked.count, turning=asked.turning))
        for _ in range(asked.rounds):
            done = measure.process("yarcc", str(file), "--robot", asked.robot, "--out-dir", folder)
            told = next(line for line in reversed(done.output.splitlines()) if "certified" in line)
            print(
                f"{asked.count} pieces: {done.seconds:.1f} s, {done.cpu:.1f} s on a core, "
                f"{done.peak:.0f} MB; {told[told.index(':') + 2 :]}"
            )
        if asked.run:
            pmc = str(file.with_suffix(".pmc"))
            ran = measure.process(
                "yarc", "run", pmc, "--robot", asked.robot, "--to", "sim", "--rate", "100", "--no-log"
            )
            print(f"run: {ran.seconds:.1f} s, {ran.peak:.0f} MB; {ran.output.strip().splitlines()[-1]}")
    again = [sys.executable, __file__, "--ideal", "--robot", asked.robot, "--path", asked.path]
    print(measure.process(*again, *(["--turning"] if asked.turning else [])).output.strip())


def text(robot: str, path: str, count: int, *, turning: bool) -> str:
    """Return a program of `count` motions along a path."""
    x, y, z = CENTRES[robot]
    points = [next(pieces) for pieces in [PATHS[path]()] for _ in range(count + 1)]
    lines, gone = [f"DEFAULT {{TCP}} [V {SPEED:g}] (mm,deg,s) {{B}}"], 0.0
    for number, (a, b, c) in enumerate(points):
        gone += math.dist(points[max(number - 1, 0)], (a, b, c))
        turn = abs((gone + 60.0) % 120.0 - 60.0) if turning else 0.0
        place = f"{x + a:.4f} {y + b:.4f} {z + c:.4f} 0 0 {turn:.4f}"
        if number:
            flows = f" BLEND {BALL:g}" if number < count else ""
            lines.append(f"P{number + 1:06d} MOVEL {place} TOL {TOLERANCE:g}{flows}")
        else:
            lines.append(f"P000001 MOVEJ_RPY {place} [5]")
    return "\n".join(lines) + "\n"


def _pieces() -> Iterator[float]:
    chance = random.Random(1)
    while True:
        yield chance.uniform(0.65, 3.0)


def weld() -> Iterator[tuple[float, float, float]]:
    """Yield three weaving seams, one after the other."""
    s = 0.0
    for piece in _pieces():
        seam, along = divmod(s, 400.0)
        yield (
            -200.0 + (along if seam % 2 == 0 else 400.0 - along),
            30.0 * (seam % 3) + 4.0 * math.sin(along / 8.0),
            0.0,
        )
        s += piece


def bead() -> Iterator[tuple[float, float, float]]:
    """Yield a path around a part with rounded corners; each pass is slightly higher than the one before."""
    sides, radius = (160.0, 90.0), 25.0
    legs = [sides[0], math.pi / 2 * radius, sides[1], math.pi / 2 * radius] * 2
    whole, s = sum(legs), 0.0
    for piece in _pieces():
        turns, rest = divmod(s, whole)
        px, py, heading = -sides[0] / 2, -sides[1] / 2 - radius, 0.0
        for number, leg in enumerate(legs):
            part = min(rest, leg)
            if number % 2 == 0:
                px, py = px + part * math.cos(heading), py + part * math.sin(heading)
            else:
                angle = part / radius
                px += radius * (math.sin(heading + angle) - math.sin(heading))
                py -= radius * (math.cos(heading + angle) - math.cos(heading))
                heading += angle
            rest -= part
            if rest <= 0.0:
                break
        yield px, py, 0.5 * (turns + (s % whole) / whole) % 60.0
        s += piece


def pocket() -> Iterator[tuple[float, float, float]]:
    """Yield a path to and fro with half circles of 4 mm, as for clearing a pocket."""
    s, row, turn = 0.0, 120.0, math.pi * 4.0
    for piece in _pieces():
        number, along = divmod(s, row + turn)
        way = 1.0 if number % 2 == 0 else -1.0
        base = 8.0 * (number % 20)
        if along <= row:
            yield way * (along - row / 2), base - 80.0, 0.0
        else:
            angle = (along - row) / 4.0
            yield way * (row / 2 + 4.0 * math.sin(angle)), base - 80.0 + 4.0 - 4.0 * math.cos(angle), 0.0
        s += piece


def spiral() -> Iterator[tuple[float, float, float]]:
    """Yield a path outwards and inwards again, with 2 mm between turns."""
    angle, radius, way = 0.0, 15.0, 1.0
    for piece in _pieces():
        yield radius * math.cos(angle), radius * math.sin(angle), 0.0
        angle += piece / radius
        radius += way * 2.0 * (piece / radius) / (2.0 * math.pi)
        way = -1.0 if radius > 110.0 else 1.0 if radius < 15.0 else way


PATHS = {"weld": weld, "bead": bead, "pocket": pocket, "spiral": spiral}


def share_of_ideal(program: str, robot: str) -> dict[str, float]:
    """Return the mean speed of our text, and its ratio to the mean speed of the ideal law."""
    import numpy as np
    import toppra
    import toppra.algorithm
    import toppra.constraint

    from yarclang.motion.limits import bounds_of
    from yarclang.pipeline.stages import Request, compile_module
    from yarclang.robot.description import load_robot
    from yarclang.robot.kinematics.fk import tool_poses
    from yarclang.source import SourceFile
    from yarclang.syntax.parse import parse

    toppra.setup_logging("ERROR")
    arm = load_robot(robot).value
    made = compile_module(parse(SourceFile("path.yarc", program)).value, Request(arm)).value  # type: ignore[arg-type]
    assert arm is not None
    assert made is not None
    motions = made.plan.motions[1:]
    q = np.concatenate(
        [motion.curve.sample(np.arange(10) / 10 * motion.curve.duration)[0] for motion in motions]
    )
    q = np.concatenate((q, motions[-1].curve.sample(np.array([motions[-1].curve.duration]))[0]))
    p = tool_poses(arm.chain, q, arm.flange_from_frame["TCP"])[:, :3, 3]
    steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
    moves = np.concatenate(([True], steps > 1e-7))
    q, p = q[moves], p[moves]
    s = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))))
    path = toppra.SplineInterpolator(s, q)
    bounds, speed = bounds_of(arm), 1e-3 * SPEED

    class Tool(toppra.constraint.LinearConstraint):  # type: ignore[misc]
        """Constraint on the tool's speed, which is the rate of the path parameter."""

        def compute_constraint_params(self, *_: object) -> tuple[object, ...]:
            """Return bounds of the squared rate alone."""
            return None, None, None, None, None, None, np.tile([0.0, speed**2], (len(s), 1))

    limits = [
        Tool(),
        toppra.constraint.JointVelocityConstraint(np.stack((-bounds.velocity, bounds.velocity), axis=1)),
        toppra.constraint.JointAccelerationConstraint(
            np.stack((-bounds.acceleration, bounds.acceleration), axis=1)
        ),
    ]
    found = toppra.algorithm.TOPPRA(limits, path, gridpoints=s, parametrizer="ParametrizeConstAccel")
    rate = found.compute_parameterization(0.0, 0.0)[1]
    ideal = float((2.0 * np.diff(s) / (rate[1:] + rate[:-1])).sum())
    ours = sum(motion.curve.duration for motion in motions)
    return {
        "seconds": round(ours, 3),
        "mm_s": round(1e3 * float(s[-1]) / ours, 2),
        "ideal_s": round(ideal, 3),
        "share": round(ideal / ours, 4),
    }


if __name__ == "__main__":
    main()
