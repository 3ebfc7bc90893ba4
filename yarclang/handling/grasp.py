"""What a gripper does at a SET, and where the parts are between two steps."""

from __future__ import annotations

from dataclasses import replace

from yarclang.cell.model import Grip, Parts
from yarclang.frozen import frozen
from yarclang.handling.parts import NO_PARTS, Nearest
from yarclang.robot.model import Array
from yarclang.ways import Ways


@frozen
class Whereabouts:
    """Where the parts are between two steps; `unlike` names one that isn't where it was at the last loop's first pass, right in front of its next one (empty: all are)."""

    ways: Ways[Parts] = Ways(NO_PARTS)
    unlike: str = ""

    @property
    def parts(self) -> Parts:
        """Where the parts are."""
        return self.ways.state

    def moved(self, parts: Parts) -> Whereabouts:
        """Return what is known if the parts are elsewhere now."""
        return Whereabouts(replace(self.ways, state=parts))


@frozen(eq=False)
class Grasp:
    """What the SET that is step `step` does while the flange stands at `base_from_flange` (4, 4) [m]: it `closes` a gripper, or opens it.

    `before` and `after` say where the parts are, `near` is the part nearest to a gripper that closes.
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
        """The names of the parts that it takes or puts down."""
        holding = self.after if self.closes else self.before
        had = {one.name for one in self.before.held(self.variable)} if self.closes else set()
        return tuple(one.name for one in holding.held(self.variable) if one.name not in had)
