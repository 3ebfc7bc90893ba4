"""What a chain is made of, and what is made of it."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import Corner
from yarclang.motion.curve import Curve
from yarclang.motion.framespeed import top_speeds
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import Profile
from yarclang.robot.model import Tolerance


@frozen(eq=False)
class Link:
    """One motion of a chain.

    `duration` [s] is None where the limits or a speed decide; `full` [s] is how long the way takes at a speed that is asked
    for. `corner` is where the next motion begins, None behind the last. `by_itself` is how the motion would go by itself, None as long as nobody asks.
    """

    path: Path
    profile: Profile
    duration: float | None
    full: float | None
    bounds: Bounds
    tolerance: Tolerance
    corner: Corner | None
    by_itself: Curve | None

    @property
    def alone(self) -> Curve:
        """How the motion would go by itself, which has to be known."""
        assert self.by_itself is not None
        return self.by_itself

    @property
    def as_alone(self) -> Piece:
        """The motion by itself."""
        kept = least = 1.0
        if self.full is not None:
            kept = self.full * float(np.diff(self.alone.law).max()) / self.alone.segment
            if kept < 1.0 and isinstance(self.path, CartesianPath):
                # at a sharp place of its path the frame goes a little faster or slower than the law says
                shares = np.array(top_speeds(self.path, self.alone)) * self.full / self.path.extent[0]
                kept, least = max(kept, float(shares[0])), min(1.0, float(shares[1]))
        return Piece(self.alone, None, self.alone.law, min(1.0, kept), least)

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
    overlap at its end (0: both paths are kept to; None: a stop), and the control values of its own law, from its rest to its rest. `kept` is the share of a speed asked for that is reached, and
    kept; `least`, where the speed changes on the way, that below which it doesn't fall once it is reached.
    """

    curve: Curve
    overlap: int | None
    law: Array
    kept: float = 1.0
    least: float = 1.0
