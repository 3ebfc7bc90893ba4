"""Find the number of segments by which two consecutive motions may overlap at a corner."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field, replace
from itertools import pairwise

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.blend import (
    Corner,
    Part,
    begins,
    both,
    leads_frame,
    places_of_both,
    shares,
    superpose,
    way_length,
)
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.curve import Curve, knot_values, middle_values
from yarclang.motion.framespeed import frame_speeds
from yarclang.motion.limits import Bounds
from yarclang.motion.trials import Trial
from yarclang.robot.model import Chain, Tolerance

_WITHIN = 0.98
"""Share of a ball's radius that samples of the curve may use. Between samples, the curve may be slightly
farther from the corner.
"""

_ROUNDING = 1e-6
"""Share of a ball's radius that is added for rounding, when poses are checked before joint positions are
computed.
"""

SPEED_KEPT = 2e-4
"""Relative amount by which a speed may exceed the requested one."""

_WIDTHS = 14
"""Number of widths of an overlap that are tried, the widest first."""

_SHARE_OF_TOLERANCE = 0.7


_INSIDE = 0.97
"""Share of a ball's radius up to which a place on a path counts as inside the ball."""

Inside = tuple[float, float]
"""The shares of the paths before and after a corner that are inside its ball; each is at most a half."""


def find_inside(chain: Chain, links: Sequence[Link]) -> list[Inside]:
    """Return for each corner of a chain the shares of the paths before and after it that are inside the
    corner's ball; each is at most a half.
    """
    inside: list[Inside] = []
    back = np.linspace(0.0, 0.5, 65)
    for first, second in pairwise(links):
        assert first.corner is not None
        if first.corner.is_tangent:
            inside.append((0.5, 0.5))
            continue
        before = first.corner.farthest(chain, first.path.joints(1.0 - back[::-1]))[::-1]
        after = first.corner.farthest(chain, second.path.joints(back))
        inside.append((_first_out(back, before), _first_out(back, after)))
    return inside


def _first_out(back: Array, far: Array) -> float:
    """Return the share of a path, counted from the corner, that is inside the corner's ball; at most a half.

    Args:
        back: (N,) places along the path, as shares of the path counted from the corner.
        far: (N,) distances of these places from the corner, as shares of the allowed distance.
    """
    out = np.flatnonzero(far > _INSIDE)
    if not len(out):
        return 0.5
    k = int(out[0])
    # Interpolate linearly between the last place inside and the first one outside.
    share = (_INSIDE - far[k - 1]) / (far[k] - far[k - 1])
    return float(back[k - 1] + (back[k] - back[k - 1]) * share)


def changes_speed(one: Link, other: Link) -> bool:
    """Return True if the requested speed changes at a corner at which the path must be kept.

    Motion profiles that overlap at such a corner would be too fast on one side of it, or too slow on the
    other.
    """
    if one.corner is None or not one.corner.is_tangent or one.speed is None or other.speed is None:
        return False
    return abs(one.speed - other.speed) > SPEED_KEPT * min(one.speed, other.speed)


@frozen(eq=False)
class Overlaps:
    """Checker of the overlaps at the corners of a chain, with segments of `segment` [s]."""

    chain: Chain
    links: Sequence[Link]
    segment: float
    _last: dict[tuple[Trial, Trial, int], Array] = field(default_factory=dict)
    """The last superposition with its arguments, since most superpositions are needed twice."""

    def serves(self, first: Part, second: Part, place: int, overlap: int) -> bool:
        """Return True if motion number `place` and the next one may overlap by `overlap` segments.

        The curve must stay in the corner's ball, or on both paths if they are tangent, and within limits.
        """
        corner = self.links[place].corner
        if corner is None or overlap > min(first.segments, second.segments):
            return False
        if changes_speed(self.links[place], self.links[place + 1]):
            return False
        # On Cartesian paths, the frame's position can be computed without inverse kinematics: check it first.
        is_framed = corner.radius > 0.0 and leads_frame(first.path, second.path, corner.flange_from_moving)
        if is_framed and not self._is_near(first, second, corner, overlap):
            return False
        if not (corner.is_tangent or is_framed) and not self._in_ball(first, second, corner, overlap):
            return False
        points = self._superposed(first, second, corner, overlap)
        begin = first.segments - overlap
        around = points[max(begin - 2, 0) : begin + overlap + 5]
        if not self._loosest(place).are_kept(around, self.segment):
            return False
        if corner.is_tangent:
            own = self.links[place].tolerance, self.links[place + 1].tolerance
            return self._on_both(first, second, points, overlap, own)
        return not is_framed or self._in_ball(first, second, corner, overlap)

    def excess(self, first: Part, second: Part, place: int, overlap: int) -> float:
        """Return the ratio of the moving frame's largest speed in an overlap to the requested speed; 0 if no
        speed was requested.

        The speed is sampled at the knots and in the middle between them. If both motions request a speed, the
        larger one counts.
        """
        links = self.links[place : place + 2]
        asked = [link.speed for link in links if link.speed is not None]
        corner = self.links[place].corner
        if not asked or corner is None:
            return 0.0
        points = self._superposed(first, second, corner, overlap)
        # Take the control points on which the curve in the overlap depends, and one segment on either side.
        begin = max(first.segments - overlap - 1, 0)
        curve = Curve(points[begin : begin + overlap + 5], self.segment, np.empty(0))
        q, rate, _ = curve.sample(np.arange(2 * curve.segments + 1, dtype=float) * (self.segment / 2.0))
        most = 0.0
        for link in links:
            if link.speed is None or not isinstance(link.path, CartesianPath):
                continue
            most = max(most, float(frame_speeds(link.path, q, rate).max()))
        return most / max(asked)

    def _superposed(self, first: Part, second: Part, corner: Corner, overlap: int) -> Array:
        """Return the control points of two motions, superposed with an overlap."""
        key = first.trial, second.trial, overlap
        if key not in self._last:
            self._last.clear()
            self._last[key] = superpose(self.chain, (first, second), (corner,), (overlap,))
        return self._last[key]

    def _is_near(self, first: Part, second: Part, corner: Corner, overlap: int) -> bool:
        """Return False if the frame leaves the ball around its corner in an overlap.

        This quick check adds poses, and needs no inverse kinematics.
        """
        done = knot_values(first.trial.control)[-1 - overlap :]
        begun = knot_values(second.trial.control)[: overlap + 1]
        places = places_of_both(first.path, second.path, done, begun)
        return bool(np.linalg.norm(places, axis=1).max() <= (_WITHIN + _ROUNDING) * corner.radius)

    def _in_ball(self, first: Part, second: Part, corner: Corner, overlap: int) -> bool:
        """Return True if the curve stays in the ball around the corner during an overlap."""
        done, begun = shares(first, second, overlap)
        ends = knot_values(first.trial.control)[[-1 - overlap]], knot_values(second.trial.control)[[overlap]]
        outer = np.concatenate((first.path.joints(ends[0]), second.path.joints(ends[1])))
        if corner.farthest(self.chain, outer).max() > _WITHIN:
            return False
        inner = both(self.chain, first.path, second.path, corner, done, begun)
        return bool(corner.farthest(self.chain, inner).max(initial=0.0) <= _WITHIN)

    def _on_both(
        self, first: Part, second: Part, points: Array, overlap: int, tolerances: tuple[Tolerance, Tolerance]
    ) -> bool:
        """Return True if the curve follows one of two tangent paths during their overlap, each within its own
        tolerance. It is checked in the middle of each segment.
        """
        begin = first.segments - overlap
        q = middle_values(points[begin : begin + overlap + 3])
        done = middle_values(first.trial.control)[-overlap:]
        begun = middle_values(second.trial.control)[:overlap]
        lengths = way_length(first.path), way_length(second.path)
        # Add the distances along both paths; the second path begins at lengths[0].
        gone = done * lengths[0] + begun * lengths[1]
        for path, here, s, tolerance in (
            (first.path, gone <= lengths[0], gone / lengths[0], tolerances[0]),
            (second.path, gone > lengths[0], (gone - lengths[0]) / lengths[1], tolerances[1]),
        ):
            if here.any():
                position, angle = path.deviation(q[here], np.clip(s[here], 0.0, 1.0))
                if (
                    position > _SHARE_OF_TOLERANCE * tolerance.position
                    or angle > _SHARE_OF_TOLERANCE * tolerance.angle
                ):
                    return False
        return True

    def _loosest(self, place: int) -> Bounds:
        """Return the limits that apply in the overlap of two motions: for each quantity, the larger limit of
        the two.
        """
        first, second = (link.own_bounds for link in self.links[place : place + 2])
        return replace(
            first,
            velocity=np.maximum(first.velocity, second.velocity),
            acceleration=np.maximum(first.acceleration, second.acceleration),
            jerk=np.maximum(first.jerk, second.jerk),
            motor_velocity=np.maximum(first.motor_velocity, second.motor_velocity),
            zones=first.zones.together(second.zones) if first.zones else second.zones,
        )

    def cut(
        self, parts: Sequence[Part], overlaps: Sequence[int], kept: Sequence[float] | None = None
    ) -> list[Piece]:
        """Return the planned motions of a chain: cut its curve in the middle of each overlap.

        `kept` are the shares of the requested speeds that are reached.
        """
        corners = [link.corner for link in self.links if link.corner is not None]
        points = superpose(self.chain, parts, corners, overlaps)
        points.setflags(write=False)
        starts = begins(parts, overlaps)
        pieces = []
        for place, (part, begin) in enumerate(zip(parts, starts, strict=True)):
            before = overlaps[place - 1] // 2 if place else 0
            after = overlaps[place] // 2 if place < len(overlaps) else 0
            first, last = begin + before, begin + part.segments - after
            # The first half of an overlap belongs to the motion before it, the second half to the next
            # motion.
            law = part.trial.control[before : part.segments - after + 3]
            curve = Curve(points[first : last + 3], self.segment, law)
            pieces.append(
                Piece(curve, 2 * after or None, part.trial.control, 1.0 if kept is None else kept[place])
            )
        return pieces


def widest(serves: Callable[[int], bool], most: int) -> int:
    """Return approximately the largest even overlap up to `most` for which `serves` is True; 0 if none is
    found.

    A smaller overlap isn't always better. Therefore sizes in geometric progression are tried first, the
    largest first. Then the interval above the first size that serves is searched.
    """
    if most < 2:
        return 0
    # Count in pairs of segments, since an overlap must be even.
    widths = np.unique(np.round(np.geomspace(1, most // 2, _WIDTHS)).astype(int))[::-1].tolist()
    place = next((place for place, pairs in enumerate(widths) if serves(2 * pairs)), None)
    if place is None:
        return 0
    low, high = widths[place], widths[place - 1] if place else widths[0]
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if serves(2 * middle) else (low, middle)
    return 2 * int(low)
