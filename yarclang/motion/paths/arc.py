"""Define a circular arc of the moving frame. Along the arc, the frame turns about a fixed axis, in proportion
to the distance travelled.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.rotation import turn_between, turned

NO_CIRCLE = 1e-6
"""Distance between two of three points [m], or angle between the lines from the first point to the others
[rad], below which the points determine no circle.
"""


@frozen(eq=False)
class Arc:
    """A circular arc of the moving frame, as poses over s in {B}.

    The frame's origin moves by the angle `sweep` [rad] about the axis `normal` (3,) through `centre` (3,)
    [m], and the frame turns by `angle` [rad] about `axis` (3,). The arc begins at `base_from_start` (4, 4)
    and ends exactly at `base_from_end` (4, 4), to the last bit, so that later motions don't depend on the
    digits of the start.
    """

    base_from_start: Array
    base_from_end: Array
    centre: Array
    normal: Array
    sweep: float
    axis: Array
    angle: float

    @property
    def radius(self) -> float:
        """The circle's radius [m]."""
        return float(np.linalg.norm(self.base_from_start[:3, 3] - self.centre))

    @property
    def length(self) -> float:
        """The length of the arc [m]."""
        return self.radius * self.sweep

    def poses(self, s: Array) -> Array:
        """Return base_from_moving (N, 4, 4) at `s` (N,)."""
        poses = np.zeros((len(s), 4, 4))
        poses[:, :3, :3] = turned(self.base_from_start[:3, :3], self.axis, s * self.angle)
        poses[:, :3, 3] = self.centre + self._spokes(s)
        poses[:, 3, 3] = 1.0
        poses[s == 1.0] = self.base_from_end
        return poses

    def tangents(self, s: Array) -> Array:
        """Return the derivatives of the frame's pose with respect to s (N, 6); see `FramePath.tangents`."""
        along = self.sweep * np.cross(self.normal, self._spokes(s))
        return np.concatenate((along, np.tile(self.axis * self.angle, (len(s), 1))), axis=1)

    def _spokes(self, s: Array) -> Array:
        """Return the vectors from the centre of the arc to the frame's origin at N places (N, 3)."""
        first = self.base_from_start[:3, 3] - self.centre
        side = np.cross(self.normal, first)
        angle = (s * self.sweep)[:, None]
        spokes: Array = np.cos(angle) * first + np.sin(angle) * side
        return spokes


@frozen
class NoArc:
    """The reason why three given points determine no arc.

    Two of the points coincide (their distance is `apart` [m]), all three are on a line (up to the angle
    `bend` [rad]), or the orientation turns by 180 deg.
    """

    kind: Literal["coincident", "straight", "half turn"]
    points: str = ""
    apart: float = 0.0
    bend: float = 0.0


def arc_through(base_from_start: Array, via: Array, base_from_end: Array) -> Arc | NoArc:
    """Return the arc from one pose (4, 4) through a position `via` (3,) [m] to another pose, all in {B}."""
    start, end = base_from_start[:3, 3], base_from_end[:3, 3]
    a, b = via - start, end - start
    pairs = (("start and via", a), ("via and end", end - via), ("start and end", b))
    for points, between in pairs:
        apart = float(np.linalg.norm(between))
        if apart < NO_CIRCLE:
            return NoArc("coincident", points, apart)
    across = np.cross(a, b)
    # Angle between the lines from start to via and from start to end, from 0 to pi / 2.
    bend = float(np.arctan2(np.linalg.norm(across), abs(a @ b)))
    if bend < NO_CIRCLE:
        return NoArc("straight", bend=bend)
    turn = turn_between(base_from_start[:3, :3], base_from_end[:3, :3])
    if turn is None:
        return NoArc("half turn")
    # The circumcentre of the triangle, relative to its first corner.
    middle = np.cross((a @ a) * b - (b @ b) * a, across) / (2.0 * (across @ across))
    normal = across / np.linalg.norm(across)
    spoke = -middle
    to_end = b - middle
    # The normal is that of the triangle start, via, end. The sweep therefore passes the via point, and is
    # between 0 and 2 pi.
    sweep = float(np.arctan2(normal @ np.cross(spoke, to_end), spoke @ to_end)) % (2.0 * np.pi)
    return Arc(base_from_start, base_from_end, start + middle, normal, sweep, *turn)
