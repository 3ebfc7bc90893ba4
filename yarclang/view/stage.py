"""The scene of a picture as plain data: bodies, frames, paths, commands, findings, and the joints over time.

Nothing here depends on a browser. Lengths are in m, times in s, all coordinates in {B}.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell
from yarclang.collision.scene import Scene, scene_of
from yarclang.findings import Severity
from yarclang.report.solids import Solid
from yarclang.robot.kinematics.fk import joint_transform
from yarclang.robot.model import Array, Chain, Robot
from yarclang.view.dragging import Draggable
from yarclang.view.rules import NO_RULES, Rules

Colour = tuple[int, int, int]
Kind = Literal["robot", "tool", "obstacle", "zone", "part", "shape"]
"""Kinds of items. A `shape` is the collision shape of a link that the picture shows by visual shapes. A
`Stage` has no items of this kind; `shapes_beside` returns them.
"""
Rows = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """A body, or the border of a zone, as drawn.

    Attributes:
        name: name of the body. Items with the same name are one body of the collision check.
        kind: kind of the item.
        joint: number of joints that move the item.
        base_from_item: (4, 4) pose with all joints at zero.
        solid: surface of the item.
        colour: colour of the item.
        opacity: from 0 to 1.
        begins: time from which on the item is shown [s].
        ends: time from which on the item isn't shown any more [s].
        is_named: True if the name is written beside the item.
    """

    name: str
    kind: Kind
    joint: int
    base_from_item: Array
    solid: Solid
    colour: Colour
    opacity: float
    begins: float = -np.inf
    ends: float = np.inf
    is_named: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Axes:
    """A coordinate frame, drawn by its axes.

    Attributes:
        name: name without braces.
        joint: number of joints that move the frame, counted from the base.
        base_from_frame: (4, 4) pose with all joints at zero.
        of_program: True if the program declares the frame.
        matters: True for {B}, for the frame whose path is drawn, and for the first pose of each frame
            that the program uses; without a program, for each frame of the cell.
    """

    name: str
    joint: int
    base_from_frame: Array
    of_program: bool
    matters: bool = True


class Track(Protocol):
    """The joint positions over time."""

    def at(self, times: Array) -> tuple[Array, Array]:
        """Return joint positions [rad or m] and velocities, (N, n) each, at times (N,) [s].

        Before the first and after the last recorded or planned time, the robot is at rest.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """The drawn path of a moving frame, as points over time.

    Attributes:
        times: (N,) time of each point [s].
        points: (N, 3) origin of the frame [m].
        speed: (N,) speed of the frame's origin [m/s].
        breaks: (M + 1,) indices of points: section k has the points from `breaks[k]` up to but not
            including `breaks[k + 1]`. Points within a section are connected, different sections aren't.
        piece: (M,) index of the command of each section, -1 for none.
    """

    times: Array
    points: Array
    speed: Array
    breaks: Rows
    piece: Rows


class Later:
    """Facts about a command, as names and values, that are computed each time they are shown. A long program
    has many commands, but only few are ever shown.

    Args:
        make: function that computes the facts.
    """

    __slots__ = ("_make",)

    def __init__(self, make: Callable[[], Iterable[tuple[str, str]]]) -> None:
        self._make = make

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter(self._make())


@dataclass(frozen=True, slots=True)
class Worst:
    """A place in the program at which a motion comes near to a limit.

    Attributes:
        piece: number of the command.
        text: description of the place and the limit.
    """

    piece: int
    text: str


@dataclass(frozen=True, slots=True)
class Piece:
    """A command of the program, as shown.

    Attributes:
        label: label of the command, such as `P0010`.
        name: name of the command.
        line: line in the source; 0 if it isn't known.
        begins: time at which the command begins [s].
        ends: time at which the command ends [s].
        moves: False for a command without motion, and for a motion that couldn't be planned.
        planned: False for a motion that couldn't be planned.
        facts: names and values to show. In a long program, they are computed when they are needed (`Later`).
    """

    label: str
    name: str
    line: int
    begins: float
    ends: float
    moves: bool
    planned: bool
    facts: Iterable[tuple[str, str]]

    @property
    def title(self) -> str:
        """Return a title such as `P0010 MOVEL`."""
        return f"{self.label} {self.name}".strip()


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """A finding or an event of a run, marked in the picture.

    Attributes:
        code: code of the finding.
        severity: severity of the finding.
        text: message.
        remedy: help of the finding.
        time: time at which the mark is shown [s]; None if it isn't known.
        place: (3,) point that is marked [m]; None if it isn't known.
        piece: number of the command, -1 for none.
    """

    code: str
    severity: Severity
    text: str
    remedy: str
    time: float | None
    place: Array | None
    piece: int


@dataclass(frozen=True, slots=True, eq=False)
class Scenes:
    """The bodies of the collision check over time. They change when the robot grips or releases a workpiece.

    Attributes:
        robot: the robot.
        begins: (K,) times from which on each state of the cell applies [s], never decreasing.
        cells: (K,) states of the cell. The first state also applies before its time.
    """

    robot: Robot
    begins: Array
    cells: tuple[Cell | None, ...]

    def numbers(self, times: Array) -> Rows:
        """Return the indices of the states of the cell that apply at times (N,) [s]."""
        return np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)

    def scene(self, number: int) -> Scene | None:
        """Return the bodies of the collision check for the state of the cell with this index; None if no body
        could collide.
        """
        found = scene_of(self.robot, self.cells[number]).value
        return found if found is not None and len(found.pairs.first) else None


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The contents of a picture.

    Attributes:
        title: the file.
        subtitle: description of the file, in a line.
        notes: contents that can't be shown, with reasons.
        robot: the robot whose joints `track` contains.
        items: bodies and borders of zones.
        axes: frames.
        frame: name of the frame whose path is drawn.
        flange_from_frame: (4, 4) pose of this frame on the flange.
        track: the joints over time.
        ghost: the planned joints beside the actual ones; None unless both are known.
        way: the drawn path of the frame.
        ghost_way: planned path of the frame; None without a ghost.
        pieces: commands in order of time.
        marks: findings and events.
        scene: bodies of the collision check at the beginning; None if there is no body that could collide.
        duration: the last time that is shown [s].
        cell: the robot's cell; None if none is known.
        scenes: bodies of the collision check over time; None if they are always those of `scene`.
        worst: places nearest to their limits, beginning with the nearest; empty for a short program.
        draggable: frames that can be dragged. The line that declares a dragged frame is shown.
        rules: rules of the program's motions over time.
    """

    title: str
    subtitle: str
    notes: tuple[str, ...]
    robot: Robot
    items: tuple[Item, ...]
    axes: tuple[Axes, ...]
    frame: str
    flange_from_frame: Array
    track: Track
    ghost: Track | None
    way: Way
    ghost_way: Way | None
    pieces: tuple[Piece, ...]
    marks: tuple[Mark, ...]
    scene: Scene | None
    duration: float
    cell: Cell | None = None
    scenes: Scenes | None = None
    worst: tuple[Worst, ...] = ()
    draggable: tuple[Draggable, ...] = ()
    rules: Rules = NO_RULES

    def scene_at(self, time: float) -> Scene | None:
        """Return the bodies of the collision check at a time [s]."""
        if self.scene is None or self.scenes is None:
            return self.scene
        return self.scenes.scene(int(self.scenes.numbers(np.array([time]))[0]))

    def scenes_over(self, times: Array) -> Iterator[tuple[Scene, Rows]]:
        """Yield the bodies of the collision check at times (N,) [s]: each set of bodies once, with the
        indices of the times at which it applies.
        """
        if self.scene is None:
            return
        if self.scenes is None:
            yield self.scene, np.arange(len(times))
            return
        numbers = self.scenes.numbers(times)
        for number in np.unique(numbers).tolist():
            scene = self.scenes.scene(number)
            if scene is not None:
                yield scene, np.flatnonzero(numbers == number)

    def piece_at(self, time: float) -> int:
        """Return the index of the command that is executed at a time [s]; -1 before the first command.

        If there are several such commands, return the one that moves the robot. If none of them does, return
        the first.
        """
        count = bisect_right(self.pieces, time + 1e-9, key=lambda piece: piece.begins)
        first = count
        while first > 0 and not self.pieces[first - 1].moves:
            first -= 1
        found = -1
        for number, piece in enumerate(self.pieces[max(first - 1, 0) : count], max(first - 1, 0)):
            if time <= piece.ends + 1e-9 or piece.moves:
                # Where a command ends, the next one begins: return the next one.
                found = number if piece.moves or found < 0 or self.pieces[found].ends < time else found
        return found


def moved_by(chain: Chain, q: Array) -> Array:
    """Return the displacements of bodies when the joints move from zero to the positions `q` (n,). Matrix k
    of the result (n + 1, 4, 4) is the transform of the bodies that the first k joints move.
    """
    moved = np.tile(np.eye(4), (chain.size + 1, 1, 1))
    for joint in range(chain.size):
        turn, shift = joint_transform(chain.screws[joint], q[joint : joint + 1])
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = turn[0], shift[0]
        moved[joint + 1] = moved[joint] @ step
    return moved
