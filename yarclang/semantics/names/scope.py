"""The meanings of names in nested blocks: numbers, frames, joint positions, inputs, outputs, SUBs and
modules.

A name is known from its declaration to the end of its block or file, and can't be declared again there.
Frames have separate names: a frame and another object may have the same name.
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
    """A declared frame.

    Attributes:
        transform: (4, 4) base_from_frame, or flange_from_frame for a frame on the flange.
        on_flange: True if the frame moves with the flange.
        link: name and declaration of the frame; None if unknown.
    """

    transform: Array
    on_flange: bool
    link: FrameLink | None = None


@frozen(eq=False)
class JointPosition:
    """A named joint position.

    Attributes:
        q: (n,) [rad or m].
    """

    q: Array


@frozen(eq=False)
class Pose:
    """A named pose.

    Attributes:
        transform: (4, 4) base_from_pose.
        link: name and declaration of the frame in which the pose is given; None if unknown.
        told: (6,) the pose in that frame as written in the program, x y z roll pitch yaw [m, rad]; None if
            unknown.
    """

    transform: Array
    link: FrameLink | None
    told: Array | None = None


@frozen
class Input:
    """A declared input.

    Attributes:
        signal: name of the input, and its variable.
        step: size of one step of an analogue input; None for other inputs, which have no physical unit.
    """

    signal: Signal
    step: float | None = None


@frozen(eq=False)
class Table:
    """A TABLE of numbers. A table with a single row or column takes one index, other tables take two.

    Attributes:
        rows: the numbers; all rows have one length.
    """

    rows: tuple[tuple[Amount, ...], ...]

    @property
    def sizes(self) -> tuple[int, ...]:
        """Number of values that each index can have."""
        rows, columns = len(self.rows), len(self.rows[0])
        return (rows * columns,) if 1 in (rows, columns) else (rows, columns)

    def at(self, indices: tuple[int, ...]) -> Amount:
        """Return the number at the given indices, which count from 0. Each must be less than the table's size
        in this direction (`sizes`).
        """
        if len(indices) == 2:
            return self.rows[indices[0]][indices[1]]
        (index,) = indices
        return self.rows[0][index] if len(self.rows) == 1 else self.rows[index][0]


@frozen(eq=False)
class Places:
    """A TABLE of poses or of joint positions, with one index."""

    rows: tuple[Pose, ...] | tuple[JointPosition, ...]

    @property
    def sizes(self) -> tuple[int]:
        """Number of values that the index can have."""
        return (len(self.rows),)


@frozen(eq=False)
class Formula:
    """A declared FUNC.

    Attributes:
        parameters: names of the parameters in upper case, each with the unit to which its argument is
            converted.
        body: the expression after the equals sign.
        scope: the names that the expression can use besides the parameters.
        weight: number of operations in one use, including those of the functions in it.
        depth: depth to which these operations are nested.
        meaning: key that is equal for functions with equal values: it contains everything on which the values
            depend.
    """

    parameters: tuple[tuple[str, Unit | None], ...]
    body: Expression
    scope: Scope
    weight: int
    depth: int
    meaning: Hashable


@frozen(eq=False)
class Routine:
    """A declared SUB.

    Attributes:
        sub: the Sub of semantics/files.py, which this module can't import.
    """

    sub: object


@frozen(eq=False)
class Library:
    """A module, loaded by USE. Its names are written as MODULE.NAME."""

    scope: Scope


@frozen
class Where:
    """The place of a declaration."""

    source: SourceFile
    span: Span

    def seen_from(self, source: SourceFile) -> str:
        """Return the place of the declaration in words, for a message about the file `source`."""
        line = f"line {self.span.line}"
        return line if source.name == self.source.name else f"{line} of {self.source.called}"


@frozen
class RackTool:
    """A tool of the cell that a tool changer can take.

    Attributes:
        name: the tool.
        lock: the output of the changer.
        locks_at: the output's value while the changer holds a tool.
    """

    name: str
    lock: Signal
    locks_at: float


@frozen
class Taught:
    """A place that JPOS or LPOS stores during a run. Its coordinates are known only after the program has
    run.
    """


Named = (
    Amount
    | Table
    | Places
    | Formula
    | JointPosition
    | Pose
    | Register
    | Input
    | Output
    | RackTool
    | Taught
    | Routine
    | Library
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
    RackTool: "a tool",
    Taught: "a place that is taught when the program runs",
    Routine: "a SUB",
    Library: "a module",
}


class Scope:
    """The names of a block and of the blocks around it."""

    __slots__ = ("_frames", "_names", "_outer", "_places", "seen")

    def __init__(self, outer: Scope | None = None) -> None:
        self._outer = outer
        self._names: dict[str, Named] = {}
        self._frames: dict[str, Frame] = {}
        self._places: dict[str, Where] = {}
        self.seen: dict[Hashable, Any] = {}
        """Cache of lookups since the last declaration, for recalling.py."""

    @classmethod
    def of_robot(cls, robot: Robot) -> Scope:
        """Return the names of a robot: its joint positions, its frames on the flange, and {B}."""
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
        """Return the meaning of NAME or MODULE.NAME; None if it has none."""
        module, dot, inner = name.partition(".")
        found = self._own(module)
        if not dot:
            return found
        return found.scope.declared(inner) if isinstance(found, Library) else None

    def declared(self, name: str) -> Named | None:
        """Return the meaning of a name if it is declared in this file or block itself; None for other
        names.
        """
        return self._names.get(name)

    def frame(self, name: str) -> Frame | None:
        """Return the frame with the name NAME or MODULE.NAME; None without one."""
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
        """Declare a name in this file or block.

        Args:
            name: the name in upper case.
            meaning: what the name stands for.
            where: place of the declaration.
        """
        self.seen.clear()
        self._names[name] = meaning
        if where is not None:
            self._places[name] = where

    def where(self, name: str) -> Where | None:
        """Return the place of a name's declaration; None for names of the robot."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope._names:
                return scope._places.get(name)
            scope = scope._outer
        return None

    def where_frame(self, name: str) -> Where | None:
        """Return the place of a frame's declaration; None for frames of the robot."""
        found = self.frame(name)
        link = found.link if found is not None else None
        return Where(link.source, link.span) if link and link.source and link.span else None

    def declare_frame(self, name: str, frame: Frame) -> None:
        """Declare a frame."""
        self.seen.clear()
        self._frames[name] = frame

    def take_over(self, inner: Scope, names: Iterable[tuple[str, bool]]) -> None:
        """Declare names in this file or block with the meanings that they have in an inner block.

        Args:
            inner: the inner block.
            names: the names, each with True if it is the name of a frame; names that the inner block doesn't
                declare are ignored.
        """
        self.seen.clear()
        for name, is_frame in names:
            if is_frame and name in inner._frames:
                self._frames[name] = inner._frames[name]
            elif not is_frame and name in inner._names:
                self._names[name] = inner._names[name]
                if name in inner._places:
                    self._places[name] = inner._places[name]

    def names(self, *kinds: type) -> list[str]:
        """Return all names in scope that stand for objects of the given kinds, without names of modules."""
        found: list[str] = []
        scope: Scope | None = self
        while scope is not None:
            found += [name for name, meaning in scope._names.items() if isinstance(meaning, kinds)]
            scope = scope._outer
        return found

    def names_with_modules(self, kind: type) -> list[str]:
        """Return all names in scope that stand for objects of a kind, those of modules as MODULE.NAME."""
        found = self.names(kind)
        for module in self.names(Library):
            library = self._own(module)
            assert isinstance(library, Library)
            inner = library.scope._names.items()
            found += [f"{module}.{name}" for name, meaning in inner if isinstance(meaning, kind)]
        return found

    def frame_names(self) -> Iterator[str]:
        """Yield the names of all frames in scope, beginning with those of the robot."""
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
        """Return a copy with the names that are declared so far."""
        made = Scope(self._outer.copy() if self._outer is not None else None)
        made._names, made._frames = dict(self._names), dict(self._frames)
        made._places = dict(self._places)
        return made
