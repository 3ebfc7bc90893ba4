"""Find the bodies that may touch during each motion because the program or the cell allows it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType

from yarclang.cell.model import Cell, CellAllowance
from yarclang.decisions import Permitted
from yarclang.frozen import frozen
from yarclang.hir import Allowed, Gap, Loop, Motion, PoseGoal, Program, Step
from yarclang.source import SourceFile
from yarclang.ways import Turn, Ways


@frozen
class Allowance:
    """A pair of bodies that may touch during a motion.

    Attributes:
        first: name of one body, in upper case.
        second: name of the other body, after `first` in alphabetical order.
        line: the line that allows the contact, in the program, a module or the cell's file.
        in_cell: True if this line is in the cell's file.
    """

    first: str
    second: str
    line: int
    in_cell: bool = False

    @property
    def pair(self) -> tuple[str, str]:
        """The names of both bodies."""
        return self.first, self.second

    @property
    def giver(self) -> str:
        """The line that allows the contact, for messages, such as "line 12" or "line 40 of the cell.toml"."""
        return f"line {self.line}{' of the cell.toml' if self.in_cell else ''}"


Allowances = Mapping[int, tuple[Allowance, ...]]
"""The bodies that may touch during each motion, by the motion's step. Motions that allow no contact are
missing.
"""

NO_ALLOWANCES: Allowances = MappingProxyType({})


def allowances_of(program: Program) -> Allowances:
    """Return the bodies that may touch during the motions of a program."""
    return allowances(program.cell, program.steps)


def permitted(program: Program) -> tuple[Permitted, ...]:
    """Return the pairs of bodies that may touch during the motions of a program, sorted by step and name. If
    the program is a section of a longer one, its contacts are those that the longer program allows.
    """
    if program.cells is None:
        found = {step: [one.pair for one in own] for step, own in allowances_of(program).items()}
    else:
        found = {step: sorted(cell.allowed) for step, cell in program.cells.items() if cell is not None}
    return tuple(Permitted(step, *pair) for step in sorted(found) for pair in found[step])


def allowances(cell: Cell | None, steps: Sequence[Step]) -> Allowances:
    """Return the pairs of bodies that may touch during each motion of a program.

    Args:
        cell: its `[[allow]]` entries allow contact during motions whose goal is given in a frame, or that
            leave such a goal.
        steps: steps of the program, whose lines allow contact with ALLOW.
    """
    of_cell = () if cell is None else cell.allowances
    if not of_cell and not any(getattr(step, "allowed", ()) for step in steps):
        return NO_ALLOWANCES
    return _allowances(of_cell, None if cell is None else cell.source, tuple(steps))


@lru_cache(maxsize=16)
def _allowances(
    of_cell: tuple[CellAllowance, ...], source: SourceFile | None, steps: tuple[Step, ...]
) -> Allowances:
    found: dict[int, tuple[Allowance, ...]] = {}
    for number, step, there, left in _with_frames(steps, source):
        own = [_by_line(one, step) for one in step.allowed]
        own += [
            Allowance(one.first, one.second, one.line, in_cell=True)
            for one in of_cell
            if one.leads_to in there or one.leaves in left
        ]
        by_pair = {one.pair: one for one in reversed(own)}
        if by_pair:
            found[number] = tuple(by_pair[pair] for pair in sorted(by_pair))
    return MappingProxyType(found)


def _by_line(one: Allowed, step: Motion) -> Allowance:
    if one.cell_line is not None:
        return Allowance(one.first, one.second, one.cell_line, in_cell=True)
    return Allowance(one.first, one.second, one.span(step.origin).line)


def kept(step: Motion, own: Sequence[Allowance]) -> tuple[Allowed, ...]:
    """Return the contacts that stay allowed if a motion is used outside of its program: the contacts that its
    line allows, and those that the cell allows because of the motion's position in the program.

    Args:
        step: the motion.
        own: all contacts that are allowed during the motion in its program.
    """
    of_cell = [Allowed(one.first, one.second, cell_line=one.line) for one in own if one.in_cell]
    return (*step.allowed, *of_cell)


def frames_led_to(step: Motion, source: SourceFile | None) -> frozenset[str]:
    """Return the names of the frame in which a motion's goal is given, and of that frame's parents.

    The result is empty for a motion to joint values or by an increment. Only frames that the file `source`
    declares are included, since a program's frame may have the same name as a frame of the cell.
    """
    goal = step.end if step.goals else None
    if not isinstance(goal, PoseGoal):
        return frozenset()
    link = step.origin.base
    if goal.told is not None and (link is None or link.name != goal.told.base.name):
        link = goal.told.base  # the last of several poses may be given in another frame than the first
    names = set()
    while link is not None and source is not None:
        if link.source is not None and link.source.name == source.name:
            names.add(link.name.upper())
        link = link.parent
    return frozenset(names)


def _with_frames(
    steps: Sequence[Step], source: SourceFile | None
) -> Iterator[tuple[int, Motion, frozenset[str], frozenset[str]]]:
    """Yield each motion with its step number, the frames in which its goal is given, and the frames in which
    the previous motion's goal is given on every branch. At the start of a loop there is no such previous
    frame, because the passes begin after different motions.
    """
    nowhere: frozenset[str] = frozenset()
    at = Ways(nowhere)
    for number, step in enumerate(steps):
        if isinstance(step, Motion):
            there = frames_led_to(step, source)
            yield number, step, there, at.state
            at = replace(at, state=there)
        elif isinstance(step, Gap):
            at = replace(at, state=nowhere)
        elif isinstance(step, Turn):
            at = at.turned(step, lambda one, other, _: one & other)
            if isinstance(step, Loop):
                at = replace(at, state=nowhere)
