"""What a chain is made of, and what is made of it."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import Corner
from yarclang.motion.curve import Curve
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import Profile
from yarclang.robot.model import Tolerance


@frozen(eq=False)
class Link:
    """One motion of a chain.

    `duration` [s] is None where the limits or a speed decide; `full` [s] is how long the way takes at a speed that is asked
    for. `corner` is where the next motion begins, None behind the last. `alone` is how the motion would go by itself.
    """

    path: Path
    profile: Profile
    duration: float | None
    full: float | None
    bounds: Bounds
    tolerance: Tolerance
    corner: Corner | None
    alone: Curve

    @property
    def as_alone(self) -> Piece:
        """The motion by itself."""
        kept = 1.0
        if self.full is not None:
            kept = min(1.0, self.full * float(np.diff(self.alone.law).max()) / self.alone.segment)
        return Piece(self.alone, 0, self.alone.law, kept)

    @property
    def speed(self) -> float | None:
        """The speed of the moving frame that is asked for [m/s, or rad/s of a pure turn]."""
        if self.full is None or not isinstance(self.path, CartesianPath):
            return None
        return self.path.extent[0] / self.full

    @property
    def own_bounds(self) -> Bounds:
        """The limits that count: without that of jerk for a law that has none."""
        return self.bounds if self.profile.has_jerk_limit else self.bounds.without_jerk()


@frozen(eq=False)
class Piece:
    """What a chain makes of one motion: its curve from the middle of one overlap to that of the next, the segments of the
    overlap at its end (0: a stop), and the control values of its own law, from its rest to its rest. `kept` is the share of a speed asked for that is reached.
    """

    curve: Curve
    overlap: int
    law: Array
    kept: float = 1.0
