"""Generate problems of tight places with known solutions. Each problem is made backwards: a tool is drawn out
of its place, and then the surroundings are built around its path.

Forty problems on three arms: a tool in a box, on a shelf, in a cage, under a table, between two boxes, and a
head under the rails of a T-slot, with openings that are 40 to 5 mm wider than the tool. The known path of
each problem is free, checked every few millimetres; the straight path isn't free. Nine more problems have no
solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from yarclang.cell.model import Cell, Mount, Obstacle
from yarclang.collision.free import plain_free_space
from yarclang.collision.scene import scene_of
from yarclang.robot.kinematics import flange_poses
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.model import Array, Robot
from yarclang.shapes import Box, Capsule, Shape
from yarclang.source import SourceFile

SEED = 3
LENGTH, WIDTH, FOOT = 0.2, 0.05, 0.03
"""Length and width of the tool, a stick, and its distance from the flange [m]."""
HEAD, HEAD_LENGTH, SHAFT = 0.08, 0.03, 0.03
"""The other tool: width and length of a head, and width of its shaft [m]."""
DRAWS = 5_000
"""Largest number of draws for a problem."""
DEEP, WALL, STEP = 0.16, 0.02, 0.004
"""Depth of the tool in its place, thickness of walls, and step at which the known path is checked [m]."""
OUT = {"INDUSTRIAL6": 1, "TRACKED_MANIPULATOR": 1}
"""Axis of the flange along which the tool points; z for other arms."""
KINDS: tuple[tuple[str, tuple[int, ...]], ...] = (
    ("box", (40, 20, 10, 5)),
    ("shelf", (30, 10)),
    ("cage", (20, 10)),
    ("table", (20,)),
    ("two boxes", (40, 20, 10)),
    ("t-slot", (20,)),
)
"""Kinds of problems, with the differences between the widths of opening and tool [mm]. Each is drawn on each
arm; one more T-slot of 10 mm makes forty.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Tight:
    """A problem in a cell.

    Attributes:
        robot: the arm.
        kind: of the problem.
        wider: excess width of the opening over the tool [mm].
        cell: the surroundings.
        start: (n,) [rad or m].
        goal: (n,) [rad or m].
        known: (k, n) known path; only the start if there is none.
    """

    robot: Robot
    kind: str
    wider: int
    cell: Cell
    start: Array
    goal: Array
    known: Array


def problems(robots: tuple[Robot, ...]) -> Iterator[Tight]:
    """Yield the problems of all kinds for each arm."""
    for at, robot in enumerate(robots):
        kinds = [(kind, wider) for kind, widths in KINDS for wider in widths]
        if not at:
            kinds.append(("t-slot", 10))
        for number, (kind, wider) in enumerate(kinds):
            yield _problem(robot, kind, wider, np.random.default_rng([SEED, at, number]))


def shut(robots: tuple[Robot, ...]) -> Iterator[Tight]:
    """Yield three problems without a solution for each arm: the head is in a T-slot that is closed at both
    ends and narrower than the head.
    """
    for at, robot in enumerate(robots):
        for number in range(3):
            random = np.random.default_rng([SEED, at, 100 + number])
            yield next(one for _ in range(DRAWS) if (one := _shut(robot, 20, random)) is not None)


def _shut(robot: Robot, wider: int, random: np.random.Generator) -> Tight | None:
    tool, goal, start = tuple(_tool(robot, "t-slot")), _place(robot, random), _place(robot, random)
    slot = SHAFT + wider * 1e-3
    lid = Box(np.array([WALL, 0.2 + 2 * slot, 2 * (HEAD_LENGTH + WALL + wider * 1e-3)]))
    frame, end = _frame(robot, goal), FOOT + LENGTH
    lids = (
        _body(f"END{number}", lid, frame @ _at(np.array([-0.03 + x, 0.0, end - HEAD_LENGTH / 2.0])))
        for number, x in enumerate((-0.1 - WALL / 2.0, 0.1 + WALL / 2.0))
    )
    bodies = (*tool, *_around(robot, "t-slot", goal, wider * 1e-3, "A"), *lids)
    if not _is_free(robot, bodies, np.stack([goal, start])):
        return None
    return Tight(robot, "shut t-slot", wider, _cell(bodies), start, goal, start[None])


def _problem(robot: Robot, kind: str, wider: int, random: np.random.Generator) -> Tight:
    for _ in range(DRAWS):
        made = _drawn(robot, kind, wider, random)
        if made is not None:
            return made
    raise RuntimeError(f"no problem {kind}, {wider} mm, for {robot.name} in {DRAWS} draws")


def _drawn(robot: Robot, kind: str, wider: int, random: np.random.Generator) -> Tight | None:
    """Return a problem; None if the drawn surroundings make none."""
    tool = tuple(_tool(robot, kind))
    goal = _place(robot, random)
    if not _is_free(robot, tool, goal[None]):
        return None
    out = _drawn_out(robot, goal, kind)
    if out is None:
        return None
    built = tuple(_around(robot, kind, goal, wider * 1e-3, "A"))
    known = out[::-1]  # from outside into the place
    if kind == "two boxes":
        other = _place(robot, random)
        back = _drawn_out(robot, other, kind)
        if back is None:
            return None
        built += tuple(_around(robot, kind, other, wider * 1e-3, "B"))
        known = np.concatenate((back, _straight(back[-1], known[0])[1:-1], known))
    else:
        limits = robot.limits
        corners = [known[0]]
        for _ in range(int(random.integers(1, 3))):
            step = random.uniform(-1.0, 1.0, robot.size) * np.array(
                [1.4, 0.6, 0.7] + [0.8] * (robot.size - 3)
            )
            corners.insert(0, np.clip(corners[0] + step, limits.lower + 0.05, limits.upper - 0.05))
        walk = [_straight(one, next_) for one, next_ in pairwise(corners)]
        known = np.concatenate((*walk, known[1:]))
    if not _is_free(robot, (*tool, *built), known):
        return None
    bodies = [*tool, *built]
    for number in range(3):
        size, at = random.uniform(0.1, 0.4, 3), random.uniform([-1.0, -1.0, 0.2], [1.0, 1.0, 1.6])
        one = _body(f"CLUTTER{number}", Box(size + 0.04), _at(at))
        if _is_free(robot, (*tool, one), known):
            bodies.append(_body(one.name, Box(size), _at(at)))
    straight = _straight(known[0], known[-1])
    if _is_free(robot, tuple(bodies), straight):
        return None
    return Tight(robot, kind, wider, _cell(bodies), known[0], known[-1], known)


def _place(robot: Robot, random: np.random.Generator) -> Array:
    """Return a joint position in the middle of the limits with the tool in front of the arm."""
    limits = robot.limits
    low, high = np.maximum(limits.lower, -np.pi), np.minimum(limits.upper, np.pi)
    while True:
        q: Array = low + (0.15 + 0.7 * random.random(robot.size)) * (high - low)
        flange = flange_poses(robot.chain, q[None])[0]
        tip = flange[:3, 3] + 0.2 * flange[:3, OUT.get(robot.name, 2)]
        foot = float(np.hypot(*tip[:2]))
        if foot > 0.35 and tip[2] > 0.15 and tip @ flange[:3, OUT.get(robot.name, 2)] > 0.0:
            return q


def _frame(robot: Robot, q: Array) -> Array:
    """Return base_from_tool (4, 4): z points out of the flange, and x along the flange's x."""
    flange = flange_poses(robot.chain, q[None])[0]
    placed = np.eye(4)
    out, across = flange[:3, OUT.get(robot.name, 2)], flange[:3, 0]
    placed[:3, :3] = np.column_stack([across, np.cross(out, across), out])
    placed[:3, 3] = flange[:3, 3]
    return placed


def _drawn_out(robot: Robot, q: Array, kind: str) -> Array | None:
    """Return joint positions (k, n) from a place outwards at constant orientation; None if the arm can't
    follow.
    """
    frame = _frame(robot, q)
    pieces = [(-frame[:3, 2], DEEP + 0.1)]
    if kind == "t-slot":
        pieces.insert(0, (frame[:3, 0], 0.16))
    path, pose = [q], flange_poses(robot.chain, q[None])[0].copy()
    limits = robot.limits
    for way, length in pieces:
        for _ in range(round(length / STEP)):
            pose = pose.copy()
            pose[:3, 3] += STEP * way
            got = fit(
                robot.chain, pose[None], path[-1][None], lower=limits.lower, upper=limits.upper, rounds=15
            )
            if got.total[0] > 1e-8 or np.abs(got.q[0] - path[-1]).max() > 0.08:
                return None
            path.append(got.q[0])
    return np.array(path)


def _straight(one: Array, other: Array) -> Array:
    """Return the straight path (k, n) between two joint positions (n,)."""
    count = int(np.ceil(np.abs(other - one).max() / 0.005)) + 2
    straight: Array = one + np.linspace(0.0, 1.0, count)[:, None] * (other - one)
    return straight


def _tool(robot: Robot, kind: str) -> Iterator[Obstacle]:
    flange_from_tool = np.linalg.inv(flange_poses(robot.chain, robot.home[None])[0]) @ _frame(
        robot, robot.home
    )
    parts = (
        (
            ((SHAFT, SHAFT, LENGTH - HEAD_LENGTH), FOOT),
            ((HEAD, HEAD, HEAD_LENGTH), FOOT + LENGTH - HEAD_LENGTH),
        )
        if kind == "t-slot"
        else (((WIDTH, WIDTH, LENGTH), FOOT),)
    )
    for number, (size, start) in enumerate(parts):
        placed = flange_from_tool @ _at(np.array([0.0, 0.0, start + size[2] / 2.0]))
        yield Obstacle(f"STICK{number}", Box(np.array(size)), Mount(placed, on_flange=True), 0.0)


def _around(robot: Robot, kind: str, q: Array, wider: float, name: str) -> Iterator[Obstacle]:
    """Yield the bodies around a tool at its place."""
    frame, end = _frame(robot, q), FOOT + LENGTH
    mouth, bottom = end - DEEP, end + 0.01
    middle, deep = (mouth + bottom) / 2.0, bottom - mouth
    parts: list[tuple[Shape, tuple[float, float, float]]] = []
    if kind in ("box", "two boxes", "shelf"):
        room = np.array([0.4 if kind == "shelf" else WIDTH + wider, WIDTH + wider])
        beside = (room + WALL) / 2.0
        for sign in (-1.0, 1.0):
            parts.append((Box(np.array([WALL, room[1] + 2 * WALL, deep])), (sign * beside[0], 0.0, middle)))
            parts.append((Box(np.array([room[0], WALL, deep])), (0.0, sign * beside[1], middle)))
        parts.append((Box(np.array([*(room + 2 * WALL), WALL])), (0.0, 0.0, bottom + WALL / 2.0)))
    elif kind == "table":
        up = (WIDTH + wider) / 2.0
        for sign, thick in ((1.0, 0.03), (-1.0, 0.03)):
            parts.append((Box(np.array([0.5, thick, deep])), (0.0, sign * (up + thick / 2.0), middle)))
        legs = Box(np.array([0.03, 2 * up, 0.03]))
        parts += [(legs, (sign * 0.2, 0.0, mouth + 0.015)) for sign in (-1.0, 1.0)]
    elif kind == "cage":
        bar, gap = 0.008, WIDTH + wider
        radius = 0.1
        turn = 2.0 * np.arcsin((gap / 2.0 + bar) / radius)
        angles = np.arange(turn / 2.0, 2.0 * np.pi - turn / 4.0, turn)
        for angle in angles.tolist():
            along, across = end - 0.05 - radius * np.cos(angle), radius * np.sin(angle)
            parts.append((Capsule(bar, 0.6), (0.0, across, along)))
    else:
        slot = (SHAFT + wider) / 2.0
        behind = end - HEAD_LENGTH - wider / 2.0
        for sign in (-1.0, 1.0):
            at = sign * (slot + 0.05)
            parts.append((Box(np.array([0.2, 0.1, WALL])), (-0.03, at, behind - WALL / 2.0)))
        parts.append(
            (Box(np.array([0.2, 0.2 + 2 * slot, WALL])), (-0.03, 0.0, end + wider / 2.0 + WALL / 2.0))
        )
    for number, (shape, place) in enumerate(parts):
        placed = frame @ _at(np.array(place))
        if isinstance(shape, Capsule):
            turned = np.eye(4)  # with its axis along x
            turned[:3, :3] = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
            placed = placed @ turned
        yield _body(f"{name}{number}", shape, placed)


def _is_free(robot: Robot, bodies: tuple[Obstacle, ...], path: Array) -> bool:
    scene = scene_of(robot, _cell(bodies)).value
    assert scene is not None
    space = plain_free_space(scene)
    return all(space.has(q) for q in path)


def _cell(bodies: object) -> Cell:
    return Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, tuple(bodies), (), {})  # type: ignore[arg-type]


def _body(name: str, shape: Shape, placed: Array) -> Obstacle:
    return Obstacle(name, shape, Mount(placed, on_flange=False), 0.0)


def _at(xyz: Array) -> Array:
    placed = np.eye(4)
    placed[:3, 3] = xyz
    return placed
