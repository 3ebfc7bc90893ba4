"""What is to be seen, as plain data: bodies, frames, paths, commands, findings, and where the joints are over time.

Nothing here knows a browser. Lengths are in m, times in s, everything in {B}.
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
from yarclang.robot.kinematics.fk import joint_transform
from yarclang.robot.model import Array, Chain, Robot
from yarclang.view.solids import Solid

Colour = tuple[int, int, int]
Kind = Literal["robot", "tool", "obstacle", "zone", "part", "shape"]
"""A `shape` is a collision shape of a link that is shown by what it looks like; it stands in no stage."""
Rows = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Item:
    """A body, or the border of a zone: `base_from_item` (4, 4) with all joints at zero, `joint` how many of them move it.

    Bodies of one `name` are one body of the collision check. It is shown from `begins` up to, but not at, `ends` [s]; `is_named` says that its name is written at it.
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
    """A frame: `base_from_frame` (4, 4) with all joints at zero, `joint` how many of them move it; `of_program` says that the program has declared it.

    `matters` is True for {B}, the followed frame and, at its first place, each frame that the program uses; without a program for each frame of the cell.
    """

    name: str
    joint: int
    base_from_frame: Array
    of_program: bool
    matters: bool = True


class Track(Protocol):
    """Where the joints are over time."""

    def at(self, times: Array) -> tuple[Array, Array]:
        """Positions [rad or m] and velocities, (N, n) each, at times (N,) [s]; before and behind its ends it stands still."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A path of the followed frame: at `times` (N,) [s] its origin is at `points` (N, 3), and goes with `speed` (N,) [m/s].

    Points `breaks[k]` up to `breaks[k + 1]` (M + 1,) hang together; between two of these stretches nothing is drawn. `piece` (M,) is which command each
    stretch belongs to, -1 for none.
    """

    times: Array
    points: Array
    speed: Array
    breaks: Rows
    piece: Rows


class Later:
    """Names and values that are worked out each time when somebody looks: of very many commands only a few are ever shown.

    Args:
        make: gives them.
    """

    __slots__ = ("_make",)

    def __init__(self, make: Callable[[], Iterable[tuple[str, str]]]) -> None:
        self._make = make

    def __iter__(self) -> Iterator[tuple[str, str]]:
        return iter(self._make())


@dataclass(frozen=True, slots=True)
class Worst:
    """A place that comes near to a limit: which command it is, and what in words."""

    piece: int
    text: str


@dataclass(frozen=True, slots=True)
class Piece:
    """A command: how it is called, where it stands in the source (0: not known), from when to when it is carried out [s], and what is to be said of it,
    name and value.

    `moves` is False for one that only waits or sets, and for a motion that couldn't be planned (`planned` says which). A long program has `facts` that are
    worked out when somebody asks for them (`Later`).
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
        """`P0010 MOVEL`."""
        return f"{self.label} {self.name}".strip()


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """A finding, or something that has happened: at `place` (3,) and `time`, where these are known; `piece` is the command it is about, -1 for none."""

    code: str
    severity: Severity
    text: str
    remedy: str
    time: float | None
    place: Array | None
    piece: int


@dataclass(frozen=True, slots=True, eq=False)
class Scenes:
    """The bodies of the collision check over time: from `begins[k]` on [s] (K,), never falling, those of `cells[k]`. The first one holds before as well."""

    robot: Robot
    begins: Array
    cells: tuple[Cell | None, ...]

    def numbers(self, times: Array) -> Rows:
        """Return which of the cells hold at times (N,)."""
        return np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)

    def scene(self, number: int) -> Scene | None:
        """Return the bodies of a cell; None if there is nothing to be near to."""
        found = scene_of(self.robot, self.cells[number]).value
        return found if found is not None and len(found.pairs.first) else None


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """All that is shown.

    Attributes:
        title: the file.
        subtitle: what it is, in a line.
        notes: what can't be shown, and why.
        robot: whose joints `track` has; `ghost` is where they were planned to be, beside where they were.
        frame: the followed frame's name, and `flange_from_frame` (4, 4), where it sits.
        way: of the robot that is shown, and `ghost_way`, as it was planned.
        scene: the bodies of the collision check at the beginning; None where there is nothing to be near to.
        duration: the last time that is shown [s].
        cell: what is around the robot; None if no cell is known.
        scenes: the bodies of the collision check over time; None if they stay those of `scene`.
        worst: the places that come nearest to what they are held to, the nearest first; none of a short program.
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

    def scene_at(self, time: float) -> Scene | None:
        """Return the bodies of the collision check at a time [s]."""
        if self.scene is None or self.scenes is None:
            return self.scene
        return self.scenes.scene(int(self.scenes.numbers(np.array([time]))[0]))

    def scenes_over(self, times: Array) -> Iterator[tuple[Scene, Rows]]:
        """Yield the bodies of the collision check at times (N,) [s]: each with the rows of the times at which they hold."""
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
        """The command that is carried out at a time: of several at once the moving one, else the first; -1 before the first one."""
        count = bisect_right(self.pieces, time + 1e-9, key=lambda piece: piece.begins)
        first = count
        while first > 0 and not self.pieces[first - 1].moves:
            first -= 1
        found = -1
        for number, piece in enumerate(self.pieces[max(first - 1, 0) : count], max(first - 1, 0)):
            if time <= piece.ends + 1e-9 or piece.moves:
                # where one ends and the next one begins, it is the next
                found = number if piece.moves or found < 0 or self.pieces[found].ends < time else found
        return found


def moved_by(chain: Chain, q: Array) -> Array:
    """What the first joints do to what they move: (n + 1, 4, 4) from where it is with all joints at zero to where it is at `q` (n,)."""
    moved = np.tile(np.eye(4), (chain.size + 1, 1, 1))
    for joint in range(chain.size):
        turn, shift = joint_transform(chain.screws[joint], q[joint : joint + 1])
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = turn[0], shift[0]
        moved[joint + 1] = moved[joint] @ step
    return moved
