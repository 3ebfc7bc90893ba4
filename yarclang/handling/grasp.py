"""What a gripper does at a SET, and where the parts are between two steps."""

from __future__ import annotations

from typing import Literal

from yarclang.cell.model import Grip, Parts
from yarclang.frozen import frozen
from yarclang.handling.parts import NO_PARTS, Nearest
from yarclang.robot.model import Array


@frozen
class Whereabouts:
    """Where the parts are between two steps; of each WHEN that isn't ended where they were before it, and where its first way leaves them (None: there is no ELSE yet; "ends": the program ends in it).

    `ends` is True if the program ends before this place on every way that leads here.
    """

    parts: Parts = NO_PARTS
    ways: tuple[tuple[Parts, Parts | Literal["ends"] | None], ...] = ()
    ends: bool = False


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
