"""The rules that motions keep on their whole path (KEEP), and the region of orientations near a direction."""

from __future__ import annotations

from dataclasses import field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.units import DEG, MM

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
KeepKind = Literal["UPRIGHT", "ABOVE"]

LEAST_TILT, MOST_TILT = np.radians(0.1), np.radians(175.0)
"""Smallest and largest angle of UPRIGHT [rad]. With a smaller angle, no executed motion could be proved."""


@frozen
class Keep:
    """A rule for a frame that the robot carries. Motions keep it on their whole path.

    UPRIGHT: the z axis of the frame stays within an angle of the z axis of a fixed frame. ABOVE: the origin
    of the frame stays at least a distance above the plane through the x and y axes of a fixed frame.

    Attributes:
        kind: the rule.
        frame: name of the carried frame, without braces.
        of: name of the fixed frame.
        own: UPRIGHT: the carried z axis in {FLANGE}; ABOVE: the carried origin in {FLANGE} [m].
        up: the z axis of the fixed frame in {B}.
        level: ABOVE: distance of the plane from the origin of {B}, along `up` [m]; otherwise 0.
        limit: UPRIGHT: largest angle [rad]; ABOVE: smallest distance [m].
        among: names of the fixed frame and of the frames in which it is given in turn.
    """

    kind: KeepKind
    frame: str
    of: str
    own: Vector
    up: Vector
    level: float
    limit: float
    among: tuple[str, ...] = field(default=(), compare=False)

    @property
    def amount(self) -> str:
        """The limit with its unit, as a program writes it."""
        if self.kind == "UPRIGHT":
            return f"{self.limit / DEG:.10g} (deg)"
        return f"{self.limit / MM:.10g} (mm)"

    @property
    def words(self) -> str:
        """The rule as a program writes it: {CUP} UPRIGHT 10 (deg) {B}."""
        return f"{{{self.frame}}} {self.kind} {self.amount} {{{self.of}}}"

    @property
    def told(self) -> str:
        """The rule with all its numbers, as the map of a controller text states it."""
        numbers = (*self.own, *self.up, self.level, self.limit)
        return f"{self.words} " + " ".join(f"{one + 0.0:.12g}" for one in numbers)


def keep(kind: KeepKind, names: tuple[str, str], carried: Array, standing: Array, limit: float) -> Keep:
    """Return a rule.

    Args:
        kind: kind of the rule.
        names: names of the carried frame and of the fixed frame.
        carried: flange_from_frame (4, 4) [m].
        standing: base_from_frame (4, 4) [m].
        limit: see `Keep`.
    """
    is_tilt = kind == "UPRIGHT"
    own = carried[:3, 2] if is_tilt else carried[:3, 3]
    level = 0.0 if is_tilt else float(standing[:3, 2] @ standing[:3, 3])
    return Keep(kind, *names, _vector(own), _vector(standing[:3, 2]), level, limit)


def _vector(values: Array) -> Vector:
    x, y, z = (float(one) for one in values)
    return x, y, z


@frozen
class Tilt:
    """The orientations of the flange at which an axis is near a direction.

    Attributes:
        own: the axis in {FLANGE}, of length 1.
        up: the direction in {B}, of length 1.
        limit: largest angle between them [rad].
    """

    own: Vector
    up: Vector
    limit: float
