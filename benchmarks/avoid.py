"""Measure the avoiding motions for RESULTS.md: `python benchmarks/avoid.py`, in an environment with yarclang.
`lines` measures only MOVEL_AVOID. `tight` measures only the tight places, which need yarclang[test] for the
third arm. `tight peer` also runs RRT-Connect with 5 s for each problem, with the same collision checker.

Each problem has a hidden solution: a walk between two joint positions, each step of which was found free of
collisions with the arm itself. Then random obstacles are added that leave this walk free and block the
straight path.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from click.testing import CliRunner

from yarclang.cell.model import Cell, Mount, Obstacle
from yarclang.cli.yarc import main as yarc
from yarclang.collision.free import plain_free_space
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.zones.watched import tool_frame
from yarclang.motion.avoid.lines import find_course
from yarclang.motion.avoid.room import Room, room_of
from yarclang.motion.avoid.way import NoWay, Way, find_way
from yarclang.motion.cartesian import CartesianPath, along
from yarclang.motion.paths.line import line_between
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.shapes import Box, Shape, Sphere
from yarclang.source import SourceFile
from yarclang.transforms import rpy_rotation

sys.path.insert(0, str(Path(__file__).parent))
import arms
import tight
from peer_ways import by_peer

PROBLEMS = 200
SEED = 7
MIDDLE = np.radians([0.0, 15.0, -30.0, 0.0, -40.0, 0.0])
STEPS = 400
"""Number of joint positions that are checked along a hidden walk."""


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """A problem in a cell with a known solution from `start` to `goal` (n,). The straight path isn't free."""

    cell: Cell
    start: Array
    goal: Array


def main() -> None:
    """Measure everything, and print the table."""
    if "lines" in sys.argv[1:]:
        on_lines()
        return
    if "tight" in sys.argv[1:]:
        in_tight_places(with_peer="peer" in sys.argv[1:])
        return
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    past = [_timed(robot, one) for one in past_a_box(robot)]
    print("| INDUSTRIAL6 | figure | goal |\n|---|---|---|")
    times = [took for took, _ in past]
    print(
        f"| a way past a box, {len(past)} starts and targets: median | {statistics.median(times):.0f} "
        f"ms | under 60 ms |"
    )
    print(f"| the slowest of them | {max(times):.0f} ms | |")
    solved = [_timed(robot, one, 1) for one in solvable(robot)]
    good = [took for took, found in solved if found]
    print(f"| {len(solved)} problems with a hidden way: solved | {len(good)} | all |")
    print(f"| their median, and the slowest | {statistics.median(good):.0f} ms, {max(good):.0f} ms | |")
    if len(good) < len(solved) or not all(found for _, found in past):
        sys.exit("a way that is there wasn't found")


def in_tight_places(*, with_peer: bool) -> None:
    """Measure the forty problems of tight.py, once each, and print a row for each kind."""
    with tempfile.TemporaryDirectory() as folder:
        panda = Path(folder) / "panda"
        asked = ["robot", "new", str(arms.DATA / arms.FILES["Panda"]), "--yes", "-o", str(panda)]
        made = CliRunner().invoke(yarc, asked)
        assert made.exit_code == 0, made.output
        robots = tuple(load_robot(name).value for name in ("INDUSTRIAL6", "TRACKED_MANIPULATOR", str(panda)))
        rows: dict[str, list[tuple[float, float, bool, bool]]] = {}
        arms_ = tuple(robot for robot in robots if robot is not None)
        for one in (*tight.problems(arms_), *tight.shut(arms_)):
            room = room_around(one.robot, one.cell)
            begun, cpu = time.perf_counter(), time.process_time()
            found = isinstance(find_way(room, one.start, one.goal), Way)
            took, cpu = time.perf_counter() - begun, time.process_time() - cpu
            is_peers = (
                with_peer and by_peer(room, one.start, one.goal, SEED, 5.0, is_shortened=False) is not None
            )
            rows.setdefault(f"{one.kind}, {one.wider} mm", []).append((took, cpu, found, is_peers))
    print(
        "| opening | solved | of | slowest | of that, computing | RRT-Connect, 5 s "
        "|\n|---|---|---|---|---|---|"
    )
    for what, tried in rows.items():
        peer = sum(by for *_, by in tried) if with_peer else ""
        took, cpu, *_ = max(tried)
        print(
            f"| {what} | {sum(good for *_, good, _ in tried)} | {len(tried)} | {took:.2f} s | {cpu:.2f} "
            f"s | {peer} |"
        )
    tried = [one for row in rows.values() for one in row]
    for said, is_found in (("solved", True), ("without a way", False)):
        times = [(took, cpu) for took, cpu, good, _ in tried if good is is_found]
        if times:
            took, cpu = (list(one) for one in zip(*times, strict=True))
            print(
                f"\n{len(times)} {said}: median {statistics.median(took):.2f} s (computing: "
                f"{statistics.median(cpu):.2f} s), "
                f"slowest {max(took):.2f} s ({max(cpu):.2f} s)"
            )


def on_lines() -> None:
    """Measure lines around obstacles: past a box, and in the first problems with hidden walks. Some of these
    problems can't be solved by lines in one configuration that turn about a single axis. Print a table.
    """
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    print(
        "| INDUSTRIAL6, MOVEL_AVOID | found | of | legs, mean | computing: median | slowest |\n"
        "|---|---|---|---|---|---|"
    )
    for what, problems in (("past a box", past_a_box(robot)), ("hidden walks", solvable(robot, LINES))):
        tried = [found for one in problems if (found := _on_lines(robot, one)) is not None]
        times = [took for took, _ in tried]
        legs = [count for _, count in tried if count]
        print(
            f"| {what} | {len(legs)} | {len(tried)} | {statistics.mean(legs):.1f} | "
            f"{statistics.median(times):.2f} s | {max(times):.2f} s |"
        )


LINES = 60
"""Number of problems with hidden walks that are tried with lines."""


def _on_lines(robot: Robot, problem: Problem) -> tuple[float, int] | None:
    """Return the processor time of a search [s], and the number of legs found, 0 for none; None if the
    straight line turns by half a revolution, or is free.
    """
    room, moving = room_around(robot, problem.cell), tool_frame(robot).flange_from_moving
    poses = tool_poses(robot.chain, np.stack([problem.start, problem.goal]), moving)
    line = line_between(*poses)
    if line is None:
        return None
    path = along(robot.chain, robot.limits, moving, line, problem.start, reason="any")
    begun = time.process_time()
    straight = path if isinstance(path, CartesianPath) else None
    found = find_course(room, line, straight, problem.start, [problem.goal])
    took = time.process_time() - begun
    if isinstance(found, NoWay):
        return took, 0
    return None if len(found.paths) == 1 else (took, len(found.paths))


def past_a_box(robot: Robot) -> list[Problem]:
    """Return the problem of moving from the left of a post to its right."""
    cell = _cell(_obstacle("POST", Box(np.array([0.12, 0.12, 1.8])), [0.0, 0.7, 0.9]))
    random = np.random.default_rng(SEED)
    room = room_around(robot, cell)
    found: list[Problem] = []
    while len(found) < 40:
        one, other = (
            np.radians(np.array([side, 20, -20, 0, -30, 0]) + random.uniform(-15, 15, 6))
            for side in (-60, 60)
        )
        if _is_problem(room, one, other):
            found.append(Problem(cell, one, other))
    return found


def solvable(robot: Robot, count: int = PROBLEMS) -> list[Problem]:
    """Return the first `count` problems with hidden walks; each run makes the same ones."""
    random = np.random.default_rng(SEED)
    found: list[Problem] = []
    while len(found) < count:
        walk = _walk(robot, random)
        if walk is None:
            continue
        cell = _around(robot, walk, random)
        room = room_around(robot, cell)
        if _is_problem(room, walk[0], walk[-1]):
            found.append(Problem(cell, walk[0], walk[-1]))
    return found


def _is_free(scene: Scene, walk: Array) -> bool:
    space = plain_free_space(scene)
    return all(space.has(one) for one in walk)


def _walk(robot: Robot, random: np.random.Generator) -> Array | None:
    """Return joint positions (STEPS, n) along two or three straight pieces on which the arm doesn't collide
    with itself; None if the drawn pieces collide.
    """
    limits = robot.limits
    room = np.array([1.6, 0.7, 0.8, 1.0, 1.0, 1.0])
    corners = np.clip(
        MIDDLE + random.uniform(-room, room, (int(random.integers(3, 5)), robot.size)),
        limits.lower + 0.05,
        limits.upper - 0.05,
    )
    at = np.linspace(0.0, len(corners) - 1.0, STEPS)
    walk = np.stack(
        [np.interp(at, np.arange(len(corners)), corners[:, joint]) for joint in range(robot.size)], 1
    )
    scene = scene_of(robot, None).value
    assert scene is not None
    return walk if _is_free(scene, walk) else None


def _around(robot: Robot, walk: Array, random: np.random.Generator) -> Cell:
    """Return obstacles that leave a walk free, by 20 mm."""
    kept: list[Obstacle] = []
    for number in range(int(random.integers(8, 30))):
        xyz = random.uniform([-1.3, -0.2, 0.2], [1.3, 1.4, 2.2])
        size = random.uniform(0.05, 0.5, 3)
        shape: Shape = Box(size) if random.random() < 0.7 else Sphere(float(size[0]) / 2.0)
        one = _obstacle(f"O{number}", shape, xyz, random.uniform(-3, 3, 3), margin=0.02)
        scene = scene_of(robot, _cell(one)).value
        assert scene is not None
        if _is_free(scene, walk):
            kept.append(_obstacle(one.name, shape, xyz, margin=0.0, placed=one.mount))
    return _cell(*kept)


def _is_problem(room: Room, start: Array, goal: Array) -> bool:
    """Return True if both ends are free, and the straight path between them isn't."""
    straight = start + np.linspace(0.0, 1.0, STEPS)[:, None] * (goal - start)
    return _is_free(room.scene, straight[[0, -1]]) and not _is_free(room.scene, straight)


def _timed(robot: Robot, problem: Problem, runs: int = 3) -> tuple[float, bool]:
    """Return the shortest time of several runs [ms], and True if a path was found."""
    room = room_around(robot, problem.cell)
    find_way(room, problem.start, problem.start + 1e-3)  # fills the caches of shapes and reaches
    times, found = [], True
    for _ in range(runs):
        begun = time.perf_counter()
        found = isinstance(find_way(room, problem.start, problem.goal), Way)
        times.append((time.perf_counter() - begun) * 1e3)
    return min(times), found


def room_around(robot: Robot, cell: Cell) -> Room:
    room = room_of(robot, cell, tool_frame(robot))
    assert room is not None
    return room


def _cell(*obstacles: Obstacle) -> Cell:
    return Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, obstacles, (), {})


def _obstacle(
    name: str,
    shape: Shape,
    xyz: object,
    rpy: object = (0, 0, 0),
    margin: float = 0.0,
    placed: Mount | None = None,
) -> Obstacle:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rpy_rotation(np.array(rpy, dtype=float)), np.array(xyz, dtype=float)
    return Obstacle(name, shape, placed or Mount(pose, on_flange=False), margin)


if __name__ == "__main__":
    main()
