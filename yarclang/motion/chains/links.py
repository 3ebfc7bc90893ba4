"""Define the motions of a chain before they are planned together (`Link`), and after (`Piece`)."""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import Corner
from yarclang.motion.curve import Curve
from yarclang.motion.framespeed import KEPT, top_speeds
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import Profile
from yarclang.robot.model import Tolerance


@frozen(eq=False)
class Link:
    """One motion of a chain, before the chain is planned.

    `duration` [s] is the given duration, or None. `full` [s] is the duration of the whole path at a requested
    speed, or None. `corner` is the corner to the next motion, None for the last motion. `by_itself` is the
    curve of the motion planned alone, None until it is needed.
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
        """The curve of the motion planned alone. It must have been planned before."""
        assert self.by_itself is not None
        return self.by_itself

    @property
    def as_alone(self) -> Piece:
        """The motion with its own curve, from rest to rest, as a planned part of a chain."""
        kept = least = 1.0
        if self.full is not None:
            kept = self.full * float(np.diff(self.alone.law).max()) / self.alone.segment
            if kept < 1.0 and isinstance(self.path, CartesianPath):
                # At a sharp bend of its path, the frame is slightly faster or slower than the motion profile.
                shares = np.array(top_speeds(self.path, self.alone)) * self.full / self.path.extent[0]
                top, least = float(shares[0]), min(1.0, float(shares[1]))
                # If the certificate doesn't allow this difference, the largest speed of the frame counts as
                # reached.
                kept = top if top < kept * (1.0 - KEPT) else max(kept, top)
        return Piece(self.alone, None, self.alone.law, min(1.0, kept), least)

    @property
    def speed(self) -> float | None:
        """The speed that the program requests for the moving frame [m/s, or rad/s for a pure rotation], or
        None.
        """
        if self.full is None or not isinstance(self.path, CartesianPath):
            return None
        return self.path.extent[0] / self.full

    @property
    def own_bounds(self) -> Bounds:
        """The limits of the motion; without a limit on jerk if its motion profile has none."""
        return self.bounds if self.profile.has_jerk_limit else self.bounds.without_jerk()


@frozen(eq=False)
class Piece:
    """One motion as a planned part of a chain.

    `curve` goes from the middle of one overlap to the middle of the next. `overlap` is the number of segments
    of the overlap at the end of the motion (0: both paths are kept; None: a stop). `law` are the control
    values of the motion's own profile, from rest to rest. `kept` is the share of the requested speed that is
    reached. `least` is the share that is kept after it has been reached; it is smaller if the speed varies
    along the path.
    """

    curve: Curve
    overlap: int | None
    law: Array
    kept: float = 1.0
    least: float = 1.0
