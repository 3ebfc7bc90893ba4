"""Proof that motions respect their own speed limits, their ceilings (`[V<=250]`)."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import HalfSpace
from yarclang.certify.bodies.fastest import Motions, fastest_in
from yarclang.certify.bodies.sweep import sweep_of
from yarclang.certify.certificate import ZoneSpeed
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


@frozen(eq=False)
class _Stretches:
    """The segments of P commands, three ranges for each: corner before it, its own segments, corner after.

    Attributes:
        spans: (3P, 2) ranges of segments.
        allowed: (3P,) allowed speed of the frame in each range [m/s].
    """

    spans: NDArray[np.int64]
    allowed: Array


def find_ceilings(
    layout: Layout, robot: Robot, moved: dict[int, Moving]
) -> tuple[dict[int, ZoneSpeed], list[Diagnostic]]:
    """Bound the frame's speed in every command with a speed limit of its own (`[V<=250]`, its ceiling).

    In a corner between two motions, the larger of both ceilings applies. If one motion has no ceiling, the
    corner has none.

    Args:
        layout: the segments of the controller text.
        robot: the robot, with its bodies and kinematics.
        moved: for each step, the frame that the motion moves, or its tool.

    Returns:
        The bounds of the speeds by step, and findings about excessive speeds.
    """
    told: dict[int, ZoneSpeed] = {}
    findings: list[Diagnostic] = []
    neighbours = {place.step: pair for place, pair in _with_neighbours(layout)}
    for run in _runs(layout, moved):
        for places in chunks(run):
            sweep = sweep_of(layout, places)
            stretches = _stretches(places, neighbours)
            motions = Motions(robot.chain, sweep.cubics, stretches.spans - places[0].first)
            item = point_of(robot, moved[places[0].step])
            found = fastest_in(motions, _EVERYWHERE, 0.0, item)
            for row, place in enumerate(places):
                rows = np.arange(3 * row, 3 * row + 3)
                own = rows[np.diff(stretches.spans[rows], axis=1)[:, 0] > 0]
                if not len(own):
                    continue
                share = found.speed[own] / stretches.allowed[own]
                worst = int(own[np.argmax(share)])
                limit = float(stretches.allowed[worst])
                if not np.isfinite(limit):
                    continue
                speed = ZoneSpeed(float(found.speed[worst]), limit, item.name, "", of_motion=True)
                told[place.step] = speed
                if not (share <= 1.0 + KEPT).all():
                    time = float(found.time[worst])
                    q = sweep.course.at(np.array([time]))[0]
                    after = time - sweep.starts(row)
                    findings.append(_too_fast(place, robot, speed, after, q))
    return told, findings


def _runs(layout: Layout, moved: dict[int, Moving]) -> Iterator[list[Place]]:
    """Yield runs of consecutive commands with ceilings that all move the same frame."""
    run: list[Place] = []
    for place in layout.places:
        if not place.size:
            continue
        if run and (
            place.motion.timing.ceiling is None or not _is_same(moved[run[0].step], moved[place.step])
        ):
            yield run
            run = []
        if place.motion.timing.ceiling is not None:
            run.append(place)
    if run:
        yield run


def _is_same(one: Moving, other: Moving) -> bool:
    return one.name == other.name and np.array_equal(one.flange_from_moving, other.flange_from_moving)


def _with_neighbours(layout: Layout) -> Iterator[tuple[Place, tuple[float, float]]]:
    """Yield each command with two ceilings [m/s]: those of the motions before and after it in a chain.

    A ceiling is infinite if that motion has none, and 0 if there is no such motion.
    """
    moving = [place for place in layout.places if place.size]
    for row, place in enumerate(moving):
        before = _allowed(moving[row - 1]) if row and place.before is not None else 0.0
        behind = _allowed(moving[row + 1]) if row + 1 < len(moving) and place.behind is not None else 0.0
        yield place, (before, behind)


def _allowed(place: Place) -> float:
    ceiling = place.motion.timing.ceiling
    return np.inf if ceiling is None else ceiling


def _stretches(places: list[Place], neighbours: dict[int, tuple[float, float]]) -> _Stretches:
    spans = np.empty((3 * len(places), 2), dtype=np.int64)
    allowed = np.empty(3 * len(places))
    for row, place in enumerate(places):
        own = _allowed(place)
        # The map gives the place of a corner without a ball only approximately: count one more segment to the
        # corner.
        head = min(place.size, 0 if place.before is None else place.before // 2 + 1)
        tail = min(place.size - head, 0 if place.behind is None else place.behind // 2 + 1)
        edges = place.first, place.first + head, place.last - tail, place.last
        spans[3 * row : 3 * row + 3] = list(pairwise(edges))
        before, behind = neighbours[place.step]
        allowed[3 * row : 3 * row + 3] = max(own, before), own, max(own, behind)
    return _Stretches(spans, allowed)


def _too_fast(place: Place, robot: Robot, speed: ZoneSpeed, after: float, q: Array) -> Diagnostic:
    origin = place.motion.origin
    message = (
        f"{speed.part} goes at {up_to(most(speed.largest, MM), 6)} mm/s, and [V<=...] allows "
        f"{speed.limit / MM:.6g} mm/s, {after:.3f} s after its start, {pose_text(robot, origin, q)}"
    )
    return Diagnostic("Y1167", message, origin.source, origin.span, "", None, place=origin.place)
