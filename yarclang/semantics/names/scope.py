"""What names mean where: numbers, frames, joint positions, inputs, outputs, SUBs and modules, in nested blocks.

A name is known from its declaration to the end of its block or file, and can't be declared again meanwhile. Frames have
names of their own.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from typing import Any

import numpy as np

from yarclang.decisions import Register
from yarclang.frozen import frozen
from yarclang.hir import Array, FrameLink, Output, Signal
from yarclang.robot.model import Robot
from yarclang.semantics.values.amounts import Amount
from yarclang.source import SourceFile, Span
from yarclang.syntax.expressions import Expression
from yarclang.units import Unit

BASE = "B"
FLANGE = "FLANGE"


@frozen(eq=False)
class Frame:
    """A frame: `transform` (4, 4) is base_from_frame, or flange_from_frame of one that the robot carries.

    `link` says what it is called, and how and where it was declared.
    """

    transform: Array
    on_flange: bool
    link: FrameLink | None = None


@frozen(eq=False)
class JointPosition:
    """A named joint position `q` (n,) [rad or m]."""

    q: Array


@frozen(eq=False)
class Pose:
    """A named pose: `transform` (4, 4) is base_from_pose, `link` the frame in which it is given (None: not known)."""

    transform: Array
    link: FrameLink | None
    told: Array | None = None
    """The numbers of the pose as they were written in that frame, in SI."""


@frozen
class Input:
    """A declared input; `step` is what one step of an analogue one is (None: it is the number that it reads)."""

    signal: Signal
    step: float | None = None


@frozen(eq=False)
class Table:
    """A TABLE: rows of numbers, all equally long. A single row, or a single column, has one index."""

    rows: tuple[tuple[Amount, ...], ...]

    @property
    def sizes(self) -> tuple[int, ...]:
        """The number of values that each index goes through."""
        rows, columns = len(self.rows), len(self.rows[0])
        return (rows * columns,) if 1 in (rows, columns) else (rows, columns)

    def at(self, indices: tuple[int, ...]) -> Amount:
        """Return the number at indices, counted from 0, which are within `sizes`."""
        if len(indices) == 2:
            return self.rows[indices[0]][indices[1]]
        (index,) = indices
        return self.rows[0][index] if len(self.rows) == 1 else self.rows[index][0]


@frozen(eq=False)
class Places:
    """A TABLE of poses or of joint positions, which has one index."""

    rows: tuple[Pose, ...] | tuple[JointPosition, ...]

    @property
    def sizes(self) -> tuple[int]:
        """The number of values that the index goes through."""
        return (len(self.rows),)


@frozen(eq=False)
class Formula:
    """A FUNC.

    Attributes:
        parameters: their names in upper case, each with the unit to which what is given is converted.
        body: the expression behind the equals sign.
        scope: the names that it sees besides its parameters.
        weight: how many operations one use comes to, those of the functions in it among them.
        depth: how deep they stand inside each other.
        meaning: all that decides over its values, by value.
    """

    parameters: tuple[tuple[str, Unit | None], ...]
    body: Expression
    scope: Scope
    weight: int
    depth: int
    meaning: Hashable


@frozen(eq=False)
class Routine:
    """A SUB: `sub` is what semantics/declared/declaring.py makes of it."""

    sub: object


@frozen(eq=False)
class Library:
    """A module that was loaded by USE; its names are read with its own in front."""

    scope: Scope


@frozen
class Where:
    """Where something was declared."""

    source: SourceFile
    span: Span

    def seen_from(self, source: SourceFile) -> str:
        """How a message in `source` speaks of it."""
        line = f"line {self.span.line}"
        return line if source.name == self.source.name else f"{line} of {self.source.called}"


Named = (
    Amount | Table | Places | Formula | JointPosition | Pose | Register | Input | Output | Routine | Library
)

KINDS: dict[type, str] = {
    Amount: "a number",
    Table: "a table",
    Places: "a table of places",
    Formula: "a function",
    JointPosition: "a joint position",
    Register: "a register",
    Pose: "a pose",
    Input: "an input",
    Output: "an output",
    Routine: "a SUB",
    Library: "a module",
}


class Scope:
    """The names of a block, and those of the blocks around it."""

    __slots__ = ("_frames", "_names", "_outer", "_places", "seen")

    def __init__(self, outer: Scope | None = None) -> None:
        self._outer = outer
        self._names: dict[str, Named] = {}
        self._frames: dict[str, Frame] = {}
        self._places: dict[str, Where] = {}
        self.seen: dict[Hashable, Any] = {}
        """What was looked up since the last declaration, for whoever looks up the same for each command (recalling.py)."""

    @classmethod
    def of_robot(cls, robot: Robot) -> Scope:
        """The names that a robot brings: its joint positions, and its frames on the flange and {B}."""
        scope = cls()
        for name, q in robot.positions.items():
            scope._names[name] = JointPosition(q)
        scope._frames[BASE] = Frame(np.eye(4), on_flange=False, link=FrameLink(BASE, np.eye(4)))
        flange = FrameLink(FLANGE, np.eye(4))
        for name, transform in robot.flange_from_frame.items():
            link = flange if name == FLANGE else FrameLink(name, transform, flange)
            scope._frames[name] = Frame(transform, on_flange=True, link=link)
        return scope

    def name(self, name: str) -> Named | None:
        """What a name means; that of a module's has the module's in front."""
        module, dot, inner = name.partition(".")
        found = self._own(module)
        if not dot:
            return found
        return found.scope.declared(inner) if isinstance(found, Library) else None

    def declared(self, name: str) -> Named | None:
        """What a name means that was declared in this very file or block."""
        return self._names.get(name)

    def frame(self, name: str) -> Frame | None:
        """What the name of a frame means."""
        module, dot, inner = name.partition(".")
        if dot:
            found = self._own(module)
            return found.scope._frames.get(inner) if isinstance(found, Library) else None
        scope: Scope | None = self
        while scope is not None:
            if (frame := scope._frames.get(name)) is not None:
                return frame
            scope = scope._outer
        return None

    def declare(self, name: str, meaning: Named, where: Where | None = None) -> None:
        """Give a name a meaning from here on."""
        self.seen.clear()
        self._names[name] = meaning
        if where is not None:
            self._places[name] = where

    def where(self, name: str) -> Where | None:
        """Where a name was declared; None for those of the robot."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope._names:
                return scope._places.get(name)
            scope = scope._outer
        return None

    def where_frame(self, name: str) -> Where | None:
        """Where a frame was declared; None for those of the robot."""
        found = self.frame(name)
        link = found.link if found is not None else None
        return Where(link.source, link.span) if link and link.source and link.span else None

    def declare_frame(self, name: str, frame: Frame) -> None:
        """Give a frame's name a meaning from here on."""
        self.seen.clear()
        self._frames[name] = frame

    def take_over(self, inner: Scope, names: Iterable[tuple[str, bool]]) -> None:
        """Give names the meaning that they have in a block, as far as they are declared in it; each with whether it is a frame's."""
        self.seen.clear()
        for name, is_frame in names:
            if is_frame and name in inner._frames:
                self._frames[name] = inner._frames[name]
            elif not is_frame and name in inner._names:
                self._names[name] = inner._names[name]
                if name in inner._places:
                    self._places[name] = inner._places[name]

    def names(self, *kinds: type) -> list[str]:
        """All names of some kinds that are known here."""
        found: list[str] = []
        scope: Scope | None = self
        while scope is not None:
            found += [name for name, meaning in scope._names.items() if isinstance(meaning, kinds)]
            scope = scope._outer
        return found

    def frame_names(self) -> Iterator[str]:
        """All names of frames that are known here, those of the robot first."""
        scopes: list[Scope] = []
        scope: Scope | None = self
        while scope is not None:
            scopes.append(scope)
            scope = scope._outer
        for one in reversed(scopes):
            yield from one._frames

    def _own(self, name: str) -> Named | None:
        scope: Scope | None = self
        while scope is not None:
            if (found := scope._names.get(name)) is not None:
                return found
            scope = scope._outer
        return None

    def copy(self) -> Scope:
        """The same names, as they are now."""
        made = Scope(self._outer.copy() if self._outer is not None else None)
        made._names, made._frames = dict(self._names), dict(self._frames)
        made._places = dict(self._places)
        return made
