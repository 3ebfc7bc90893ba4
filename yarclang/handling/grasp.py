"""Describe what a gripper does at a SET, and where the workpieces are between two steps."""

from __future__ import annotations

from dataclasses import replace

from yarclang.cell.model import Grip, Parts
from yarclang.frozen import frozen
from yarclang.handling.parts import NO_PARTS
from yarclang.handling.racks import Nearest
from yarclang.robot.model import Array
from yarclang.ways import Turn, Ways


@frozen(eq=False)
class Parted:
    """The end of a WHEN whose two branches leave different tools on the flange.

    `began` is the step at which the branches began. `tools` are the names of the tools after the one branch
    and after the other, empty for no tool.
    """

    began: Turn
    tools: tuple[str, str]


@frozen
class Whereabouts:
    """The places of the workpieces between two steps of a program.

    `unlike` names a workpiece that isn't at the same place at the end as at the start of the last loop's
    first pass; empty if there is none. `parted` is set if branches that end here leave different tools on the
    flange.
    """

    ways: Ways[Parts] = Ways(NO_PARTS)
    unlike: str = ""
    parted: Parted | None = None

    @property
    def parts(self) -> Parts:
        """The places of the parts."""
        return self.ways.state

    def moved(self, parts: Parts) -> Whereabouts:
        """Return the state after the workpieces have moved."""
        return Whereabouts(replace(self.ways, state=parts))


@frozen(eq=False)
class Grasp:
    """The effect of a SET on a gripper, with the flange at `base_from_flange` (4, 4) [m].

    `step` is the step of the SET. `closes` is True if the SET closes the gripper, and False if it opens it.
    `before` and `after` are the places of the workpieces, `near` is the workpiece nearest to a gripper that
    closes.
    """

    step: int
    variable: str
    grip: Grip
    closes: bool
    base_from_flange: Array
    before: Parts
    after: Parts
    near: Nearest | None = None

    @property
    def moved(self) -> tuple[str, ...]:
        """The names of the parts that are taken or put down."""
        holding = self.after if self.closes else self.before
        had = {one.name for one in self.before.held(self.variable)} if self.closes else set()
        return tuple(one.name for one in holding.held(self.variable) if one.name not in had)
