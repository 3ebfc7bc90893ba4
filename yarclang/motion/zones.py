"""Compute how slow a motion must be to keep the slow zones of the cell.

Slow zones are limits like any other, since the control points of a motion don't depend on the segment time.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.course import Course
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.zones.ceiling import ceiling_watch, is_ceiling
from yarclang.collision.zones.moved import Whole
from yarclang.collision.zones.speed import fastest_inside, may_enter
from yarclang.collision.zones.watched import Moving, tool_frame
from yarclang.collision.zones.workspace import SLACK, Watch, watches_of
from yarclang.frozen import frozen
from yarclang.hir import Array, Motion
from yarclang.robot.model import Robot
from yarclang.transforms import constant

HEADROOM = 4e-4
"""The share of a zone's speed that is left for printing with finitely many decimals."""

BELOW_CEILING = 1.0 - 2.0 * HEADROOM
"""Share of the speed limit that a motion sets itself, at which it cruises."""

_SHARP = 1e-3
"""Relative accuracy of speeds: a motion may be slower than allowed by this share."""

_PLACES = 100
"""Places of a path that are sampled to estimate its speed."""

_FEW = 12
"""Parts of a path that are examined to find out if it may enter a zone."""

_STEEPER = 1.5
"""Factor by which a path may be steeper at some places than its estimated slope."""

_LARGER = 2.0 * SLACK
"""Distance by which zones are enlarged [m]: the printed curve may enter them although this one doesn't."""


_TOGETHER = 8
"""Number of segments in a group, of which the fastest is found."""


@frozen(eq=False)
class SlowZones:
    """The slow zones during a motion, each with the item whose speed it limits."""

    scene: Scene
    watches: tuple[Watch, ...]

    @property
    def key(self) -> Hashable:
        """A hashable key of the scene and of the watched items with their zones."""
        return self.scene, tuple((one.zone, one.item.name if one.item else "") for one in self.watches)

    def asked(
        self, points: Array, segment: float, *, stops: bool = False
    ) -> Iterator[tuple[float, int, Watch]]:
        """Yield the segment times that slow zones require of control points (N, n), if they exceed a given
        one [s].

        Args:
            points: the control points.
            segment: the segment time that other limits already require [s].
            stops: True to end after the first item, if it only matters that a zone requires more.

        Yields:
            The segment time [s], the first control point of the most demanding difference, and the watched
            item with its zone.
        """
        if not self.watches or len(points) < 4:
            return
        course = _in_knots(points)
        span = np.array([[0, len(course.x)]])
        whole = Whole(self.scene, course, span)
        for watch in self.watches:
            limit = (watch.zone.speed or 0.0) * (1.0 - HEADROOM)
            found = fastest_inside(
                self.scene,
                course,
                span,
                watch,
                least=limit * segment,
                whole=whole,
                beyond=_LARGER,
                stops=stops,
                sharp=_SHARP,
            )
            if found.segment[0] >= 0:
                # Smaller demands no longer matter.
                segment = float(found.speed[0]) / limit
                yield segment, int(found.segment[0]) + 1, watch
                if stops:
                    return

    def too_fast(self, points: Array, segment: float) -> tuple[Array, Array]:
        """Return the segments in which an item is too fast in its slow zone, one of each group of segments,
        and by which factor.

        Args:
            points: the control points (N, n).
            segment: the segment time [s].

        Returns:
            The segments (K,), and the ratio of the speed to the allowed speed in each (K,).
        """
        if not self.watches or len(points) < 4:
            return np.zeros(0), np.zeros(0)
        course = _in_knots(points)
        begins = np.arange(0, len(course.x), _TOGETHER)
        spans = np.stack((begins, np.append(begins[1:], len(course.x))), axis=1)
        whole = Whole(self.scene, course, spans)
        where, factors = [], []
        for watch in self.watches:
            limit = (watch.zone.speed or 0.0) * (1.0 - HEADROOM) * segment
            found = fastest_inside(
                self.scene, course, spans, watch, least=limit, whole=whole, beyond=_LARGER, sharp=_SHARP
            )
            fast = found.segment >= 0
            where.append(found.segment[fast].astype(np.float64))
            factors.append(found.speed[fast] / limit)
        return np.concatenate(where), np.concatenate(factors)

    def beside(self, way: Callable[[Array], Array], slope: Array) -> SlowZones | None:
        """Return the slow zones that a path may enter; None if there are none.

        Args:
            way: function that returns joint positions (N, n) at places (N,) of the path.
            slope: (n,) the largest derivatives of the joints with respect to s, approximately.
        """
        q = way(np.linspace(0.0, 1.0, _FEW + 1))
        step = np.broadcast_to(_STEEPER * slope / _FEW, q[1:].shape)
        enters = may_enter(self.scene, (q[:-1], q[1:]), step, self.watches)
        near = tuple(one for one, is_near in zip(self.watches, enters, strict=True) if is_near.any())
        return SlowZones(self.scene, near) if near else None

    def shortest(self, way: Callable[[Array], Array]) -> float:
        """Estimate the least time [s] in which the zones allow the whole path at constant speed.

        `way` is a function that returns joint positions (N, n) at places (N,) of the path.
        """
        points = way(np.linspace(0.0, 1.0, _PLACES + 1))
        return max((segment for segment, _, _ in self.asked(points, 0.0)), default=0.0) * _PLACES

    @property
    def ceiling(self) -> float:
        """The speed limit that a motion sets for its own frame everywhere [m/s]; infinite if it sets none."""
        return min((one.zone.speed or 0.0 for one in self.watches if is_ceiling(one)), default=np.inf)

    def without_ceiling(self) -> SlowZones | None:
        """Return the slow zones of the cell, without the speed limit that the motion sets itself."""
        rest = tuple(one for one in self.watches if not is_ceiling(one))
        if len(rest) == len(self.watches):
            return self
        return SlowZones(self.scene, rest) if rest else None

    def together(self, other: SlowZones | None) -> SlowZones:
        """Return the slow zones of two motions together, for the time in which the motions overlap."""
        if other is None or other is self:
            return self
        known = {(one.zone.name, one.item.name if one.item else "") for one in self.watches}
        more = [
            one for one in other.watches if (one.zone.name, one.item.name if one.item else "") not in known
        ]
        return SlowZones(self.scene, (*self.watches, *more)) if more else self


def slow_zones(robot: Robot, cell: Cell | None, motion: Motion) -> SlowZones | None:
    """Return the slow zones that apply to a motion, with the speed limit that the motion sets itself; None if
    there are none.
    """
    has_zones = cell is not None and any(zone.rule == "slow" for zone in cell.zones)
    ceiling = motion.timing.ceiling
    if not has_zones and ceiling is None:
        return None
    made = scene_of(robot, cell)
    if made.value is None:
        return None  # a mesh can't be read: nothing is emitted
    moving = moving_of(robot, motion)
    watches = watches_of(robot, cell, moving) if cell is not None else ()
    own = () if ceiling is None else (ceiling_watch(robot, moving, ceiling),)
    return SlowZones(made.value, (*(one for one in watches if one.zone.rule == "slow"), *own))


def moving_of(robot: Robot, motion: Motion) -> Moving:
    """Return the frame that a motion moves."""
    link = motion.origin.tool
    if link is None:
        return tool_frame(robot)
    name = link.name
    if (placed := motion.flange_from_moving) is not None:
        return Moving(name, placed)
    placed = np.eye(4)
    while link is not None and link.parent is not None:
        placed = link.parent_from_frame @ placed
        link = link.parent
    return Moving(name, constant(placed))


def _in_knots(points: Array) -> Course:
    """Return the curve of control points (N, n), timed with segments of 1 s."""
    f0, f1, f2, f3 = (points[at : len(points) - 3 + at] for at in range(4))
    steps = f1 - f0, f2 - f1, f3 - f2
    first, second = steps[1] - steps[0], steps[2] - steps[1]
    # The velocity is in the hull of its Bezier points.
    peaks = np.maximum.reduce(
        [np.abs(steps[0] + steps[1]) / 2.0, np.abs(steps[1]), np.abs(steps[1] + steps[2]) / 2.0]
    )
    velocity, ones = (steps[0] + steps[1]) / 2.0, np.ones(len(f0))
    return Course.of(f1 + first / 6.0, velocity, first, second - first, ones, peaks)
