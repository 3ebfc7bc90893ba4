"""Propose small changes of a pose that the arm can't reach, or can't reach without a collision: the tool
reversed, turned about its z axis, or moved a little.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from yarclang.diagnostics import Edit, Fix
from yarclang.frozen import frozen
from yarclang.hir import Array, Origin, PoseGoal
from yarclang.motion.avoid.room import Room
from yarclang.robot.kinematics.inverse import branches, has_all, reached_within
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.kinematics.search import within
from yarclang.robot.kinematics.within import EDGE, beyond, nearest_turn
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.transforms import roll_pitch_yaw, rpy_rotation
from yarclang.units import DEG, MM, UNITS, number_text

TURN, TURNS = 30.0, 11
"""Step [deg] and number of the rotations about the tool's z axis that are tried: +30, -30, +60, -60 and so
on, up to 180 deg.
"""

MOVES = (5.0, 10.0, 20.0, 50.0)
"""Distances [mm] by which the pose is moved along axes of the tool and of the line's frame."""

FARTHEST = MOVES[-1]

_SAME = 1e-6
"""Difference up to which poses count as equal [m, or entries of a rotation]."""

_ALONG = 0.999
"""Cosine of the angle between two directions above which they count as equal."""


@frozen(eq=False)
class Change:
    """A small change of a target pose that the arm can't reach, or can't reach without a collision.

    `words` describe the change within a sentence, and `title` is the title of the fix that makes it.
    `base_from_moving` (4, 4) is the changed pose. `is_reversed` is True if the change reverses the direction
    of the tool's z axis.
    """

    words: str
    title: str
    base_from_moving: Array
    is_reversed: bool = False


def helpful_changes(
    robot: Robot, room: Room | None, goal: PoseGoal, near: Array, origin: Origin
) -> tuple[Change, ...]:
    """Return the first change of each kind with which the arm can reach a target pose without a collision.

    The kinds are: z axis reversed, rotation about z, translation. Some 45 poses are tried. This takes about
    10 ms for an arm with closed-form inverse kinematics, and 50 ms for other arms.

    Args:
        robot: the arm.
        room: the surroundings of the arm; None if there are no obstacles.
        goal: the target pose.
        near: (n,) joint position near which solutions are wanted [rad or m].
        origin: the command that gives the pose; translations are along the axes of its frame.
    """
    kinds = (
        tuple(_reversed(goal.base_from_moving)),
        tuple(_turned(goal.base_from_moving)),
        tuple(_moved(goal.base_from_moving, origin)),
    )
    flange_from_moving = np.linalg.inv(goal.flange_from_moving)
    changes = []
    for kind in kinds:
        poses = np.stack([one.base_from_moving for one in kind]) @ flange_from_moving
        solutions = _solutions(robot, poses, near)
        free = (
            one for one, taken in zip(kind, solutions, strict=True) if any(_is_free(room, q) for q in taken)
        )
        if (first := next(free, None)) is not None:
            changes.append(first)
    return tuple(changes)


def _is_free(room: Room | None, q: Array) -> bool:
    return room is None or (room.is_free(q) and room.obstruction(q) is None)


def _solutions(robot: Robot, base_from_flange: Array, near: Array) -> list[Array]:
    """Return the inverse-kinematics solutions (m, n) [rad or m] within joint limits for each of N flange
    poses (N, 4, 4).

    For an arm without closed-form inverse kinematics, only the solutions that a short search finds are
    included.
    """
    chain, limits = robot.chain, robot.limits
    if has_all(chain):
        q, reached = branches(chain, base_from_flange)
    else:
        starts = within(chain, limits, _STARTS)
        poses = np.repeat(base_from_flange, _STARTS, axis=0)
        seeds = np.tile(starts, (len(base_from_flange), 1))
        fitted = fit(chain, poses, seeds, lower=limits.lower, upper=limits.upper, rounds=_ROUNDS)
        q = fitted.q.reshape(len(base_from_flange), _STARTS, -1)
        reached = (fitted.total < reached_within(chain)).reshape(-1, _STARTS)
    # Add full turns to the joints of each solution so that it is as near to `near` as the limits allow.
    q = nearest_turn(chain, limits, q, near)
    inside = reached & (np.abs(beyond(limits, q)).max(axis=-1) <= EDGE)
    q = np.clip(q, limits.lower, limits.upper)
    return [found[good] for found, good in zip(q, inside, strict=True)]


_STARTS, _ROUNDS = 16, 15
"""Number of joint positions from which the search for solutions starts, and the largest number of steps from
each.
"""


def changes_text(changes: tuple[Change, ...], origin: Origin, how: str) -> str:
    """Return a clause that lists the helpful changes of a pose. The first one is given with its six values.

    `how` says what the changed pose would be: "free", or "in reach".
    """
    first, *others = changes
    numbers = _written(first.base_from_moving, origin)
    cause = "the tool's z may point in the wrong direction: " if first.is_reversed else ""
    said = ", or ".join(
        (
            f"{first.words} ({numbers} in {origin.length_unit} and {origin.angle_unit})",
            *(one.words for one in others),
        )
    )
    return f"{cause}the pose would be {how} {said}"


def change_fix(goal: PoseGoal, change: Change, origin: Origin) -> Fix | None:
    """Return a fix that replaces the six values of a command's pose by those of the changed pose.

    The result is None if the command's six values aren't plain numbers. The fix is applied only by choice,
    since only a person knows if the robot should go to the changed pose.
    """
    where = origin.values_span
    if where is None:
        return None
    line = origin.source.line(where.line)
    found = _SIX.match(line, where.column - 1)
    if found is None:
        return None
    values = np.array([float(value) for value in found[0].split()])
    pose = np.eye(4)
    length, angle = _units(origin)
    pose[:3, :3], pose[:3, 3] = rpy_rotation(values[3:] * angle), values[:3] * length
    if np.abs(_base(origin) @ pose - goal.base_from_moving).max() > _SAME:
        return None
    text = _written(change.base_from_moving, origin)
    span = Span.on_line(where.line, found.start() + 1, found.end() + 1)
    return Fix(change.title, (Edit(span, text),), by_choice=True)


_VALUE = r"[-+]?(?:\d+\.?\d*|\.\d+)"
_SIX = re.compile(rf"{_VALUE}(?:[ \t]+{_VALUE}){{5}}(?![^\s\[({{!])(?!\s+[-+$.\d])")


def _reversed(pose: Array) -> Iterator[Change]:
    for axis, name in ((0, "x"), (1, "y")):
        yield Change(
            f"with the tool turned by 180 deg about its {name}",
            f"turn the tool by 180 deg about its {name}",
            pose @ _rotation(axis, 180.0),
            is_reversed=True,
        )


def _turned(pose: Array) -> Iterator[Change]:
    for number in range(1, TURNS + 1):
        angle = TURN * ((number + 1) // 2) * (1 if number % 2 else -1)
        what = f"by {angle:g} deg about its z"
        yield Change(f"with the tool turned {what}", f"turn the tool {what}", pose @ _rotation(2, angle))


def _moved(pose: Array, origin: Origin) -> Iterator[Change]:
    """Yield translated poses: first along -z and z of the tool, then along those axes of the command's frame
    that differ from them.
    """
    ways: list[tuple[str, Array]] = [("-z of the tool", -pose[:3, 2]), ("z of the tool", pose[:3, 2])]
    axes = _base(origin)[:3, :3]
    for axis, name in reversed(tuple(enumerate("xyz"))):
        for sign in (1.0, -1.0):
            way = sign * axes[:, axis]
            if all(float(way @ other) < _ALONG for _, other in ways):
                ways.append((f"{'-' * (sign < 0.0)}{name} of the line's frame", way))
    for length in MOVES:
        for name, way in ways:
            moved = pose.copy()
            moved[:3, 3] += way * length * MM
            yield Change(
                f"{length:g} mm along {name}", f"move the target by {length:g} mm along {name}", moved
            )


def _rotation(axis: int, angle: float) -> Array:
    """Return the pose (4, 4) that rotates about the axis with the given index by an angle [deg]."""
    turn, rpy = np.eye(4), np.zeros(3)
    rpy[axis] = angle * DEG
    turn[:3, :3] = rpy_rotation(rpy)
    return turn


def _base(origin: Origin) -> Array:
    """Return base_from_frame (4, 4) of the frame in which a command's values are given."""
    link, placed = origin.base, np.eye(4)
    while link is not None and link.parent is not None:
        placed = link.parent_from_frame @ placed
        link = link.parent
    return placed


def _written(base_from_moving: Array, origin: Origin) -> str:
    """Return a pose as text in the units and the frame of a command: x y z and roll pitch yaw, rounded to
    0.0001 mm and 0.0001 deg.
    """
    pose = np.linalg.inv(_base(origin)) @ base_from_moving
    units = np.repeat(_units(origin), 3)
    values = np.concatenate((pose[:3, 3], roll_pitch_yaw(pose[:3, :3]))) / units
    fines = np.ceil(4 - np.log10(np.repeat([MM, DEG], 3) / units)).astype(int)
    return " ".join(
        number_text(value, fine) for value, fine in zip(values.tolist(), fines.tolist(), strict=True)
    )


def _units(origin: Origin) -> tuple[float, float]:
    """Return the units of length and angle in which a command is written, in m and rad."""
    return UNITS[origin.length_unit].factor, UNITS[origin.angle_unit].factor
