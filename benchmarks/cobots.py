"""Programs on a UR5 and on INDUSTRIAL6: `python benchmarks/cobots.py`, in an environment with yarclang[dev].

`poses`: 100 MOVEJ_RPY in a cell of ten bodies, from the text to its certificate. `pallet`: 24 boxes, each
picked and placed by MOVEJ_RPY and MOVEL among the same bodies. CPU seconds of this process, the least of
several rounds.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from yarclang.cli.yarc import main as yarc
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.model import Robot
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM

sys.path.insert(0, str(Path(__file__).parent))
import arms

ROUNDS = 3
POSES, BOXES = 100, 24
BODIES = 10
"""Boxes on the floor around the arm, with edges of 100 mm."""


def main() -> None:
    """Measure both programs on both arms."""
    with tempfile.TemporaryDirectory() as folder:
        rows = {name: _measured(name, Path(folder)) for name in ("UR5", "INDUSTRIAL6")}
    print("| CPU time | UR5 | INDUSTRIAL6 | times |\n|---|---|---|---|")
    for number, what in enumerate((f"{POSES} MOVEJ_RPY, {BODIES} bodies", f"{BOXES} boxes on a pallet")):
        own, other = rows["UR5"][number], rows["INDUSTRIAL6"][number]
        print(f"| {what} | {own:.2f} s | {other:.2f} s | {own / other:.1f} |")


def _measured(name: str, folder: Path) -> tuple[float, float]:
    robot = robot_of(name, folder)
    cell = folder / f"{name}.toml"
    cell.write_text(_cell(robot), encoding="utf-8")
    head = [f'ROBOT "{_where(robot)}"', f'CELL "{cell}"', "DEFAULT {FLANGE} [4] (mm,deg,s) {B}", "START HOME"]
    return (
        _seconds(folder / f"{name}-poses.yarc", [*head, *_poses(robot)]),
        _seconds(folder / f"{name}-pallet.yarc", [*head, *_pallet(robot)]),
    )


def robot_of(name: str, folder: Path) -> Robot:
    """Return a robot of the library, or one of `arms.FILES`, by its name."""
    if name not in arms.FILES:
        robot = load_robot(name).value
        assert robot is not None
        return robot
    urdf = arms.DATA / arms.FILES[name]
    made = CliRunner().invoke(yarc, ["robot", "new", str(urdf), "--yes", "-o", str(folder / "arm")])
    assert made.exit_code == 0, made.output
    robot = load_robot(str(folder / "arm")).value
    assert robot is not None
    return robot


def _where(robot: Robot) -> str:
    return str(robot.folder)


def _cell(robot: Robot) -> str:
    size = np.linalg.norm(flange_poses(robot.chain, robot.home[None])[0, :3, 3])
    lines = ['units = "mm,deg,s"']
    for number in range(BODIES):
        angle = 2.0 * np.pi * number / BODIES
        x, y = 1.4 * size / MM * np.cos(angle), 1.4 * size / MM * np.sin(angle)
        lines += [
            "[[obstacles]]",
            f'name = "BODY{number}"',
            'shape = "box"',
            'frame = "B"',
            f"xyz = [{x:.1f}, {y:.1f}, 50]",
            "size = [100, 100, 100]",
        ]
    return "\n".join(lines) + "\n"


def _written(pose: np.ndarray) -> str:
    values = np.concatenate((pose[:3, 3] / MM, roll_pitch_yaw(pose[:3, :3]) / DEG))
    return " ".join(f"{value:.4f}" for value in values)


def _poses(robot: Robot) -> list[str]:
    """Return lines of MOVEJ_RPY to the poses of random joint positions around HOME."""
    random = np.random.default_rng(0)
    q = robot.home + random.uniform(-0.35, 0.35, (POSES, robot.size))
    q = np.clip(q, robot.limits.lower + 0.01, robot.limits.upper - 0.01)
    poses = flange_poses(robot.chain, q)
    return [f"P{10 * number:04d} MOVEJ_RPY {_written(pose)}" for number, pose in enumerate(poses, 1)]


def _pallet(robot: Robot) -> list[str]:
    """Return for each box a MOVEJ_RPY above its place, MOVELs down and up, and the motion back to the source
    of boxes.
    """
    base = flange_poses(robot.chain, robot.home[None])[0]
    inwards = -base[:3, 3] * [1.0, 1.0, 0.0] / np.linalg.norm(base[:2, 3])
    aside = np.array([-inwards[1], inwards[0], 0.0])
    base[:3, 3] += 0.05 * inwards
    lines, number = list[str](), 0

    def line(text: str) -> None:
        nonlocal number
        number += 10
        lines.append(f"P{number:04d} {text}")

    for box in range(BOXES):
        column, row, layer = box % 4, box // 4 % 3, box // 12
        place = base.copy()
        # towards the arm, sideways, and up
        place[:3, 3] += (
            inwards * 0.03 * (column + 2) + aside * 0.03 * row + np.array([0.0, 0.0, 0.03 * layer])
        )
        for at in (base, place):
            down = at.copy()
            down[2, 3] -= 0.06
            line(f"MOVEJ_RPY {_written(at)}")
            line(f"MOVEL {_written(down)}")
            line(f"MOVEL {_written(at)}")
    return lines


def _seconds(path: Path, lines: list[str]) -> float:
    """Return the CPU time from a text to its certificate [s], the least of several rounds."""
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    times = []
    for _ in range(ROUNDS):
        begun = time.process_time()
        opened = open_program(str(path), Options())
        assert opened.value is not None, opened.diagnostics
        result = compile_module(opened.value.module, opened.value.request)
        times.append(time.process_time() - begun)
        errors = [one for one in result.diagnostics if one.severity == "error"]
        assert not errors, [(one.span, one.message) for one in errors[:3]]
    return min(times)


if __name__ == "__main__":
    main()
