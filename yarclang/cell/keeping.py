"""The path constraints (KEEP rules) that motions must satisfy along their whole path, and the regions of
allowed flange poses.
"""

from __future__ import annotations

from dataclasses import field
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.units import DEG, MM

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
KeepKind = Literal["UPRIGHT", "ABOVE", "FACING", "SEEN"]

LEAST_TILT, MOST_TILT = np.radians(0.1), np.radians(175.0)
"""Smallest and largest angle that a path constraint may set [rad]. With a smaller angle, no executed motion
could be proved.
"""
LEAST_SIGHT = 0.001
"""Least distance between the apex of a cone and the point in it [m]. At a smaller distance, the direction
from the apex to the point isn't well defined.
"""


@frozen
class Tilt:
    """The orientations of the flange at which the angle between an axis fixed to the flange and a fixed
    direction is at most `limit`.

    Attributes:
        own: the axis in {FLANGE}, of length 1.
        up: the direction in {B}, of length 1.
        limit: largest angle between axis and direction [rad].
    """

    own: Vector
    up: Vector
    limit: float

    @property
    def numbers(self) -> tuple[float, ...]:
        """The region as numbers, in the order in which the map of a controller text (its list of commands)
        states them.
        """
        return *self.own, *self.up, 0.0, self.limit


@frozen
class Height:
    """The poses of the flange at which a point fixed to the flange is above a plane.

    Attributes:
        own: the point in {FLANGE} [m].
        up: the normal of the plane in {B}, of length 1.
        level: distance of the plane from the origin of {B}, along `up` [m].
        limit: least distance of the point from the plane [m].
    """

    own: Vector
    up: Vector
    level: float
    limit: float

    @property
    def numbers(self) -> tuple[float, ...]:
        """The region as numbers, in the order in which the map of a controller text (its list of commands)
        states them.
        """
        return *self.own, *self.up, self.level, self.limit


@frozen
class Sight:
    """The poses of the flange at which a point is in a cone (such as a camera's field of view), at a distance
    within a range from the apex of the cone.

    Either the cone moves with the flange and the point is fixed in {B}, or the other way round.

    Attributes:
        own: the position in {FLANGE} of what moves with the flange: the apex or the point [m].
        spot: the position in {B} of what is fixed: the point or the apex [m].
        axis: the direction of the cone's axis, of length 1: in {FLANGE} if the cone moves with the flange,
            otherwise in {B}.
        is_carried: True if the cone moves with the flange.
        limit: largest angle between the axis and the direction from the apex to the point [rad].
        near: least distance of the point from the apex [m], at least `LEAST_SIGHT`.
        far: largest distance [m]; may be infinite.
    """

    own: Vector
    spot: Vector
    axis: Vector
    is_carried: bool
    limit: float
    near: float
    far: float

    @property
    def numbers(self) -> tuple[float, ...]:
        """The region as numbers, in the order in which the map of a controller text (its list of commands)
        states them.
        """
        return *self.own, *self.spot, *self.axis, self.limit, self.near, self.far


Pointed = Tilt | Sight
"""Regions of flange poses that aren't volumes in the cell."""


class Link(Protocol):
    """A frame's declaration: a name, and the parent's declaration. It is the interface of
    `yarclang.hir.FrameLink` that this module needs.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def parent(self) -> Link | None: ...  # noqa: D102


@frozen
class Keep:
    """A path constraint (KEEP rule) for a frame that the robot carries.

    Each kind of rule relates the carried frame to a fixed frame. UPRIGHT: the z axis of the carried frame
    stays within an angle of the z axis of the fixed frame. ABOVE: the origin of the carried frame stays at
    least a distance above the x-y plane of the fixed frame. FACING: the origin of the fixed frame stays in
    the cone around the z axis of the carried frame. SEEN: the origin of the carried frame stays in the cone
    around the z axis of the fixed frame.

    Attributes:
        kind: the kind of the rule.
        frame: name of the carried frame, without braces.
        of: name of the fixed frame.
        region: the poses of the flange at which the rule is satisfied.
        carried: the declaration of the carried frame. From `carried` and `standing`, the judge (the
            independent checker of a controller text) computes `region` again.
        standing: the declaration of the fixed frame.
        of_cell: True if the rule is in a cell.toml. It then applies to all motions, and its frames are frames
            of the cell or the robot.
    """

    kind: KeepKind
    frame: str
    of: str
    region: Tilt | Height | Sight
    carried: Link | None = field(default=None, compare=False)
    standing: Link | None = field(default=None, compare=False)
    of_cell: bool = field(default=False, compare=False)

    @property
    def limit(self) -> float:
        """The largest angle [rad]; for ABOVE, the least distance [m]."""
        return self.region.limit

    @property
    def among(self) -> tuple[str, ...]:
        """The names of the fixed frame and of its parents."""
        found, link = [self.of], None if self.standing is None else self.standing.parent
        while link is not None:
            found.append(link.name)
            link = link.parent
        return tuple(found)

    def is_within(self, other: Keep) -> bool:
        """Return True if this rule is implied by another: every flange pose that satisfies the other rule
        satisfies this one.

        Only the limits of two rules for the same frames are compared, so False may also mean "not known".
        """
        mine, its = self.region, other.region
        if self.kind != other.kind or not np.allclose(
            mine.numbers[:6], its.numbers[:6], rtol=0.0, atol=1e-12
        ):
            return False
        if isinstance(mine, Height) and isinstance(its, Height):
            return mine.level + mine.limit <= its.level + its.limit
        if isinstance(mine, Sight) and isinstance(its, Sight):
            is_same = np.allclose(mine.axis, its.axis, rtol=0.0, atol=1e-12)
            return is_same and its.limit <= mine.limit and mine.near <= its.near and its.far <= mine.far
        return its.limit <= mine.limit

    @property
    def amount(self) -> str:
        """The rule's limits with their units, as in a program: 20 200 600 (deg,mm)."""
        region = self.region
        if isinstance(region, Height):
            return f"{region.limit / MM:.10g} (mm)"
        angle = f"{region.limit / DEG:.10g}"
        if isinstance(region, Tilt) or (region.near == LEAST_SIGHT and np.isinf(region.far)):
            return f"{angle} (deg)"
        far = "" if np.isinf(region.far) else f" {region.far / MM:.10g}"
        return f"{angle} {region.near / MM:.10g}{far} (deg,mm)"

    @property
    def words(self) -> str:
        """The rule as in a program: {CUP} UPRIGHT 10 (deg) {B}."""
        return f"{{{self.frame}}} {self.kind} {self.amount} {{{self.of}}}"

    @property
    def told(self) -> str:
        """The rule with all its numbers, as the map of a controller text (its list of commands) states it."""
        return f"{self.words} " + " ".join(f"{one + 0.0:.12g}" for one in self.region.numbers)


def region_of(
    kind: KeepKind,
    carried: Array,
    standing: Array,
    limit: float,
    near: float = LEAST_SIGHT,
    far: float = np.inf,
) -> Tilt | Height | Sight:
    """Return the region of flange poses that satisfy a path constraint (KEEP rule).

    Args:
        kind: kind of the rule.
        carried: flange_from_frame (4, 4) [m] of the carried frame.
        standing: base_from_frame (4, 4) [m] of the fixed frame.
        limit: largest angle [rad]; for ABOVE, least distance [m].
        near: for FACING and SEEN, least distance [m].
        far: for FACING and SEEN, largest distance [m].
    """
    own, spot = _vector(carried[:3, 3]), _vector(standing[:3, 3])
    axis, up = _vector(carried[:3, 2]), _vector(standing[:3, 2])
    match kind:
        case "UPRIGHT":
            return Tilt(axis, up, limit)
        case "ABOVE":
            return Height(own, up, float(standing[:3, 2] @ standing[:3, 3]), limit)
        case "FACING":
            return Sight(own, spot, axis, True, limit, near, far)
        case "SEEN":
            return Sight(own, spot, up, False, limit, near, far)


def _vector(values: Array) -> Vector:
    x, y, z = (float(one) for one in values)
    return x, y, z
