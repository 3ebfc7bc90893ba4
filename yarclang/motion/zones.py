"""Compute the segment times with which a motion keeps the slow zones of the cell.

Slow zones are treated like all other limits, since the control points of a motion don't depend on the segment
time.
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
"""Share of a zone's speed limit that is held in reserve, since control points are printed with finitely many
decimals.
"""

BELOW_CEILING = 1.0 - 2.0 * HEADROOM
"""Share of the speed limit set by a motion's command at which the motion cruises."""

_SHARP = 1e-3
"""Relative accuracy of computed speeds: a motion may be slower than necessary by this share."""

_PLACES = 100
"""Number of places of a path that are sampled to estimate the speed along it."""

_FEW = 12
"""Number of parts of a path that are examined to find out if it may enter a zone."""

_STEEPER = 1.5
"""Factor by which a path may be steeper at some places than its estimated slope."""

_LARGER = 2.0 * SLACK
"""Distance by which zones are enlarged [m]: the printed curve may enter them although the planned curve
doesn't.
"""


_TOGETHER = 8
"""Number of consecutive segments in a group. Only the fastest segment of a group is reported."""


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
        """Yield the segment times [s] that slow zones require of control points (N, n). Each one is longer
        than `segment`, and than all yielded before.

        Args:
            points: the control points.
            segment: the segment time that other limits already require [s].
            stops: True to yield at most one item.

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
            fastest = fastest_inside(
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
            if fastest.segment[0] >= 0:
                # From now on, only longer segment times matter.
                segment = float(fastest.speed[0]) / limit
                yield segment, int(fastest.segment[0]) + 1, watch
                if stops:
                    return

    def too_fast(self, points: Array, segment: float) -> tuple[Array, Array]:
        """Return the segments in which an item is too fast in its slow zone, with the factor by which it is
        too fast.

        For each watched item, at most one segment of each group of `_TOGETHER` segments is returned: the
        fastest.

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
            slope: (n,) the approximate largest derivatives of the joint positions with respect to s.
        """
        q = way(np.linspace(0.0, 1.0, _FEW + 1))
        step = np.broadcast_to(_STEEPER * slope / _FEW, q[1:].shape)
        enters = may_enter(self.scene, (q[:-1], q[1:]), step, self.watches)
        near = tuple(one for one, is_near in zip(self.watches, enters, strict=True) if is_near.any())
        return SlowZones(self.scene, near) if near else None

    def shortest(self, way: Callable[[Array], Array]) -> float:
        """Estimate the shortest duration [s] of a traversal of the whole path at one constant speed that
        breaks no limit of the slow zones.

        `way` is a function that returns joint positions (N, n) at places (N,) of the path.
        """
        points = way(np.linspace(0.0, 1.0, _PLACES + 1))
        return max((segment for segment, _, _ in self.asked(points, 0.0)), default=0.0) * _PLACES

    @property
    def ceiling(self) -> float:
        """The speed limit that a motion's command sets for its frame everywhere [m/s]; infinite if it sets
        none.
        """
        return min((one.zone.speed or 0.0 for one in self.watches if is_ceiling(one)), default=np.inf)

    def without_ceiling(self) -> SlowZones | None:
        """Return the slow zones of the cell, without the speed limit that the motion's command sets. None if
        there are none.
        """
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
    """Return the slow zones of the cell that apply to a motion, together with the speed limit that its
    command sets. None if there is neither.
    """
    has_zones = cell is not None and any(zone.rule == "slow" for zone in cell.zones)
    ceiling = motion.timing.ceiling
    if not has_zones and ceiling is None:
        return None
    result = scene_of(robot, cell)
    if result.value is None:
        return None  # a mesh can't be read, so no controller text is written
    moving = moving_of(robot, motion)
    watches = watches_of(robot, cell, moving) if cell is not None else ()
    own = () if ceiling is None else (ceiling_watch(robot, moving, ceiling),)
    return SlowZones(result.value, (*(one for one in watches if one.zone.rule == "slow"), *own))


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
    """Return the curve with control points (N, n), for segments of 1 s."""
    f0, f1, f2, f3 = (points[at : len(points) - 3 + at] for at in range(4))
    steps = f1 - f0, f2 - f1, f3 - f2
    first, second = steps[1] - steps[0], steps[2] - steps[1]
    # The velocity is in the convex hull of its Bezier points.
    peaks = np.maximum.reduce(
        [np.abs(steps[0] + steps[1]) / 2.0, np.abs(steps[1]), np.abs(steps[1] + steps[2]) / 2.0]
    )
    velocity, ones = (steps[0] + steps[1]) / 2.0, np.ones(len(f0))
    return Course.of(f1 + first / 6.0, velocity, first, second - first, ones, peaks)
