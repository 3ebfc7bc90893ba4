"""Proof that motions respect their own speed limits, their ceilings (`[V<=250]`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import HalfSpace
from yarclang.certify.bodies.fastest import Motions, fastest_in
from yarclang.certify.bodies.sweep import sweep_of
from yarclang.certify.certificate import Blended, ZoneSpeed
from yarclang.certify.moments import pose_text
from yarclang.certify.motion.speed import KEPT
from yarclang.certify.outward import most, up_to
from yarclang.certify.read.layout import Layout, Place, chunks
from yarclang.collision.zones.watched import Moving, point_of
from yarclang.diagnostics import Diagnostic
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot
from yarclang.units import MM

_EVERYWHERE = HalfSpace(np.array([0.0, 0.0, 1.0]), -1e6)
"""A half-space that contains everything an arm could reach."""


_PARTS = 5
"""Number of ranges of a command."""


@frozen(eq=False)
class _Stretches:
    """The segments of P commands in five ranges for each command, in their order.

    The second range is the corner before the command, the third one its own segments, and the fourth one the
    corner after it. The first and the last range are empty, except beside a corner without a ball: the map's
    blend may have segments beyond the corner, which belong to the other motion's path.

    Attributes:
        spans: (5P, 2) ranges of segments.
        allowed: (5P,) allowed speed of the frame in each range [m/s].
    """

    spans: NDArray[np.int64]
    allowed: Array


@frozen
class _Beside:
    """A motion before or after a command in a chain.

    Attributes:
        ceiling: its ceiling [m/s]; infinite without one, 0 if there is no such motion.
        passed: segment in which the corner between both is passed, counted from the map's middle of the
            blend; None for a corner with a ball.
    """

    ceiling: float
    passed: int | None


_NOBODY = _Beside(0.0, None)


def find_ceilings(
    layout: Layout, robot: Robot, moved: dict[int, Moving], blends: Mapping[int, Blended]
) -> tuple[dict[int, ZoneSpeed], list[Diagnostic]]:
    """Bound the frame's speed in every command with a speed limit of its own (`[V<=250]`, its ceiling).

    In a corner between two motions, the larger of the two ceilings applies. If one motion has no ceiling, the
    corner has none. A corner with a ball is as long as the map's blend. A corner without a ball begins a
    segment before the segment in which it is passed, and ends a segment after it.

    Args:
        layout: the segments of the controller text.
        robot: the robot, with its bodies and kinematics.
        moved: by step, the frame from `moving_of`: the moving frame of a Cartesian goal, or the tool frame of
            a joint motion.
        blends: the proved blends, by the step of the motion before the blend.

    Returns:
        The bounds of the speeds by step, and findings about excessive speeds.
    """
    bounds: dict[int, ZoneSpeed] = {}
    findings: list[Diagnostic] = []
    neighbours = {place.step: pair for place, pair in _with_neighbours(layout, blends)}
    for run in _runs(layout, moved, neighbours):
        for places in chunks(run):
            sweep = sweep_of(layout, places)
            stretches = _stretches(places, neighbours)
            motions = Motions(robot.chain, sweep.cubics, stretches.spans - places[0].first)
            item = point_of(robot, moved[places[0].step])
            speeds = fastest_in(motions, _EVERYWHERE, 0.0, item)
            for row, place in enumerate(places):
                rows = np.arange(_PARTS * row, _PARTS * (row + 1))
                ranges = rows[np.diff(stretches.spans[rows], axis=1)[:, 0] > 0]
                if not len(ranges):
                    continue
                # Of the ranges, report the one whose speed is the largest fraction of its allowed speed.
                share = speeds.speed[ranges] / stretches.allowed[ranges]
                worst = int(ranges[np.argmax(share)])
                limit = float(stretches.allowed[worst])
                if not np.isfinite(limit) and not np.isnan(share).any():
                    continue
                speed = ZoneSpeed(float(speeds.speed[worst]), limit, item.name, "", of_motion=True)
                if place.motion.timing.ceiling is not None:
                    bounds[place.step] = speed
                if not (share <= 1.0 + KEPT).all():
                    time = float(speeds.time[worst])
                    q = sweep.course.at(np.array([time]))[0]
                    after = time - sweep.starts(row)
                    findings.append(_too_fast(place, robot, speed, after, q))
    return bounds, findings


def _runs(
    layout: Layout, moved: dict[int, Moving], neighbours: dict[int, tuple[_Beside, _Beside]]
) -> Iterator[list[Place]]:
    """Yield runs of consecutive commands that all move the same frame, and of which each has a ceiling or
    contains a part of the path of a motion with a ceiling.
    """
    run: list[Place] = []
    for place in layout.places:
        if not place.size:
            continue
        limited = place.motion.timing.ceiling is not None or any(
            beside.passed is not None and np.isfinite(beside.ceiling) for beside in neighbours[place.step]
        )
        if run and (not limited or not _is_same(moved[run[0].step], moved[place.step])):
            yield run
            run = []
        if limited:
            run.append(place)
    if run:
        yield run


def _is_same(one: Moving, other: Moving) -> bool:
    return one.name == other.name and np.array_equal(one.flange_from_moving, other.flange_from_moving)


def _with_neighbours(
    layout: Layout, blends: Mapping[int, Blended]
) -> Iterator[tuple[Place, tuple[_Beside, _Beside]]]:
    """Yield each command with the motions before and after it in a chain."""
    moving = [place for place in layout.places if place.size]
    passed = [blends[place.step].passed if place.step in blends else None for place in moving]
    for row, place in enumerate(moving):
        before = after = _NOBODY
        if row and place.before is not None:
            before = _Beside(_allowed(moving[row - 1]), passed[row - 1])
        if row + 1 < len(moving) and place.behind is not None:
            after = _Beside(_allowed(moving[row + 1]), passed[row])
        yield place, (before, after)


def _allowed(place: Place) -> float:
    ceiling = place.motion.timing.ceiling
    return np.inf if ceiling is None else ceiling


def _stretches(places: list[Place], neighbours: dict[int, tuple[_Beside, _Beside]]) -> _Stretches:
    spans = np.empty((_PARTS * len(places), 2), dtype=np.int64)
    allowed = np.empty(_PARTS * len(places))
    for row, place in enumerate(places):
        own = _allowed(place)
        before, after = neighbours[place.step]
        # A corner with a ball takes half of the map's blend, and one more segment.
        begins = ends = place.first
        if place.before is not None:
            begins, ends = place.first, place.first + place.before // 2 + 1
            if before.passed is not None:
                begins, ends = place.first + before.passed - 1, place.first + before.passed + 2
        leaves = stops = place.last
        if place.behind is not None:
            leaves, stops = place.last - place.behind // 2 - 1, place.last
            if after.passed is not None:
                leaves, stops = place.last + after.passed - 1, place.last + after.passed + 2
        edges = np.clip([place.first, begins, ends, max(leaves, ends), stops, place.last], place.first, None)
        edges = np.maximum.accumulate(np.minimum(edges, place.last))
        rows = slice(_PARTS * row, _PARTS * (row + 1))
        spans[rows] = np.stack([edges[:-1], edges[1:]], axis=1)
        larger = max(own, before.ceiling), own, max(own, after.ceiling)
        allowed[rows] = before.ceiling, *larger, after.ceiling
    return _Stretches(spans, allowed)


def _too_fast(place: Place, robot: Robot, speed: ZoneSpeed, after: float, q: Array) -> Diagnostic:
    origin = place.motion.origin
    message = (
        f"{speed.part} moves at {up_to(most(speed.largest, MM), 6)} mm/s, and [V<=...] allows "
        f"{speed.limit / MM:.6g} mm/s, {after:.3f} s after its start, {pose_text(robot, origin, q)}"
    )
    return Diagnostic("Y1167", message, origin.source, origin.span, "", None, place=origin.place)
