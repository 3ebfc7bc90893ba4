"""Describe the effect of a SET on a gripper, and the places of the workpieces between two steps."""

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

    Attributes:
        began: the step at which the branches begin.
        tools: names of the tools after the first and after the second branch; empty for no tool.
    """

    began: Turn
    tools: tuple[str, str]


@frozen
class Whereabouts:
    """The places of the workpieces between two steps of a program.

    Attributes:
        ways: the places, with the WHENs and loops that are open between the two steps.
        unlike: at the end of a loop's pass, the name of a workpiece whose place differs from its place at the
            start of the loop; otherwise empty.
        parted: at the end of branches that leave different tools on the flange, these tools; otherwise None.
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
    """The effect of a SET on a gripper.

    Attributes:
        step: the step of the SET.
        variable: variable of the gripper's output.
        grip: the gripper.
        closes: True if the SET closes the gripper, False if it opens it.
        base_from_flange: (4, 4) pose of the flange [m].
        before: places of the workpieces before the SET.
        after: places of the workpieces after the SET.
        near: the workpiece nearest to a gripper that closes.
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
