"""Slow zones of the cell: how slow a curve has to be in them. They are limits like any other; the control points don't depend on the segment time."""

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
"""A cruise goes at this share of a motion's ceiling."""

_SHARP = 1e-3
"""Speeds are told to within this share of them: so much slower than allowed a motion may be."""

_PLACES = 100
"""Places of a way that are looked at to foresee how fast it can be gone."""

_FEW = 12
"""Parts of a way that are looked at to foresee whether it gets into a zone."""

_STEEPER = 1.5
"""A way may be steeper somewhere than it is about, by this factor."""

_LARGER = 2.0 * SLACK
"""Zones count as larger by this [m]: the printed curve may enter them where this one doesn't."""


_TOGETHER = 8
"""Segments of which the fastest is looked for."""


@frozen(eq=False)
class SlowZones:
    """What slow zones watch while a motion is under way."""

    scene: Scene
    watches: tuple[Watch, ...]

    @property
    def key(self) -> Hashable:
        """The scene, and what is watched in which zone."""
        return self.scene, tuple((one.zone, one.item.name if one.item else "") for one in self.watches)

    def asked(
        self, points: Array, segment: float, *, stops: bool = False
    ) -> Iterator[tuple[float, int, Watch]]:
        """What zones ask of control points (N, n) beyond a segment time [s]: the segment time, and the first control point of the difference that asks for it.

        With `stops`, it only matters whether they ask for more.
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
                # what asks for less doesn't matter any more
                segment = float(found.speed[0]) / limit
                yield segment, int(found.segment[0]) + 1, watch
                if stops:
                    return

    def too_fast(self, points: Array, segment: float) -> tuple[Array, Array]:
        """Return the segments (K,) of control points (N, n) in which something is too fast in its zone, one of each few, and by which factor (K,).

        Args:
            points: the control points.
            segment: the segment time [s].
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
        """Those that a way (its joints over the share of it) may get into, with about the steepest `slope` (n,) of the joints over it."""
        q = way(np.linspace(0.0, 1.0, _FEW + 1))
        step = np.broadcast_to(_STEEPER * slope / _FEW, q[1:].shape)
        enters = may_enter(self.scene, (q[:-1], q[1:]), step, self.watches)
        near = tuple(one for one, is_near in zip(self.watches, enters, strict=True) if is_near.any())
        return SlowZones(self.scene, near) if near else None

    def shortest(self, way: Callable[[Array], Array]) -> float:
        """About the least time [s] that the whole of a way (its joints over the share of it) takes at a steady speed."""
        points = way(np.linspace(0.0, 1.0, _PLACES + 1))
        return max((segment for segment, _, _ in self.asked(points, 0.0)), default=0.0) * _PLACES

    @property
    def ceiling(self) -> float:
        """The speed [m/s] that the frame of a motion may have anywhere, infinite where it may have any."""
        return min((one.zone.speed or 0.0 for one in self.watches if is_ceiling(one)), default=np.inf)

    def without_ceiling(self) -> SlowZones | None:
        """Return the zones of the cell alone."""
        rest = tuple(one for one in self.watches if not is_ceiling(one))
        if len(rest) == len(self.watches):
            return self
        return SlowZones(self.scene, rest) if rest else None

    def together(self, other: SlowZones | None) -> SlowZones:
        """What is watched where two motions overlap."""
        if other is None or other is self:
            return self
        known = {(one.zone.name, one.item.name if one.item else "") for one in self.watches}
        more = [
            one for one in other.watches if (one.zone.name, one.item.name if one.item else "") not in known
        ]
        return SlowZones(self.scene, (*self.watches, *more)) if more else self


def slow_zones(robot: Robot, cell: Cell | None, motion: Motion) -> SlowZones | None:
    """The slow zones that a motion has to keep, its own ceiling among them; None where there are none."""
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
    """The frame that a motion moves."""
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
    """The curve of control points (N, n) with segments of 1 s."""
    f0, f1, f2, f3 = (points[at : len(points) - 3 + at] for at in range(4))
    steps = f1 - f0, f2 - f1, f3 - f2
    first, second = steps[1] - steps[0], steps[2] - steps[1]
    # the velocity's Bezier points bound it
    peaks = np.maximum.reduce(
        [np.abs(steps[0] + steps[1]) / 2.0, np.abs(steps[1]), np.abs(steps[1] + steps[2]) / 2.0]
    )
    velocity, ones = (steps[0] + steps[1]) / 2.0, np.ones(len(f0))
    return Course.of(f1 + first / 6.0, velocity, first, second - first, ones, peaks)
