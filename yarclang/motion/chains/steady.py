"""Plan chains that keep their speed through corners: the ramps of both motions are exactly as long as their
overlap.

The speed that the first motion loses in its last ramp is gained by the second one in its first ramp. Two
lines in one direction are therefore traversed at one speed, and at a corner one velocity changes into the
other over the whole overlap. This is possible only for motion profiles with a constant cruise speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.chains.between import STEEPNESS, Between, Turn, law_of
from yarclang.motion.chains.blend import Part
from yarclang.motion.chains.links import Link, Piece
from yarclang.motion.chains.overlaps import SPEED_KEPT, Inside, Overlaps, changes_speed
from yarclang.motion.framespeed import finer_for_speed
from yarclang.motion.path import Path
from yarclang.motion.trapezoid import FEWEST_IN_BLEND
from yarclang.motion.trials import Trials
from yarclang.robot.model import Chain

_SLOWER = 1.08
"""Factor by which a motion that demands too much is slowed down."""

_CAUTIOUS = 0.9
"""Share of its excess by which a motion is slowed down at once: its ramps and corners change with its
speed.
"""

_MOST_ROUNDS = 40
"""Number of times that a chain is slowed down before it is given up."""

_TOO_SLOW = 3.0
"""Ratio of a motion's duration to its duration by itself, above which stops are better."""

_OUTER = (1 / 3, 0.45, 0.6)
"""Shares of a given time that speeding up from rest, or slowing down to rest, may take."""

_BESIDE_ZONES = 1.005
"""Factor by which a cruise is at first slower than a slow zone allows: ramps and corners are rounded
differently from the path.
"""

_ROUNDING = 1e-9
"""Share by which a speed may miss the requested one and still counts as exact."""


@frozen
class Beaten:
    """A chain that takes at least `least` [s], which is too long."""

    least: float


def steady(
    chain: Chain,
    links: Sequence[Link],
    inside: Sequence[Inside],
    at_most: float,
    segment: float,
    middles: Sequence[int | None],
) -> list[Piece] | float | Beaten | None:
    """Plan a chain that keeps its speed through its corners.

    Args:
        chain: the arm.
        links: the motions of the chain, with profiles that have a cruise.
        inside: for each corner, as returned by `find_inside`.
        at_most: duration [s] above which a chain that misses a requested speed is of no use.
        segment: the segment time [s].
        middles: for each motion with a given duration, its number of segments from the middle of one overlap
            to the middle of the next.

    Returns:
        The planned motions; or a shorter segment time to try; or a lower bound of the duration, if the chain
        is of no use; or None if the limits don't allow it.
    """
    if not all(link.profile.has_cruise for link in links):
        return None
    if any(changes_speed(one, other) for one, other in pairwise(links)):
        return None
    maker = _Maker(links, Overlaps(chain, links, segment), segment, middles, inside, at_most)
    # Only motions with given times depend on this share.
    given = any(link.full is None and middle is not None for link, middle in zip(links, middles, strict=True))
    shares = _OUTER if given else _OUTER[:1]
    beaten_ones = list[Beaten]()
    for outer in shares:
        made = maker.made(outer)
        if isinstance(made, Beaten):
            beaten_ones.append(made)
        elif made is not None:
            return made
    return min(beaten_ones, key=lambda one: one.least, default=None)


class _Maker:
    """Planner of one chain that keeps its speed through corners."""

    def __init__(
        self,
        links: Sequence[Link],
        corners: Overlaps,
        segment: float,
        middles: Sequence[int | None],
        inside: Sequence[Inside],
        at_most: float,
    ) -> None:
        self.links, self.corners, self.segment, self.middles = links, corners, segment, middles
        self.inside, self.at_most = inside, at_most
        self.on_knots = all(middle is not None for middle in middles)
        self.slopes = [(_slope(link.path, 0.0), _slope(link.path, 1.0)) for link in links]

    def made(self, outer: float) -> list[Piece] | float | Beaten | None:
        """Plan the chain.

        In motions with given durations, a ramp from rest or to rest takes the share `outer` of the duration.
        """
        count = len(self.links)
        cruises = self._foreseen([self._first_cruise(place, outer) for place in range(count)])
        for _ in range(_MOST_ROUNDS):
            if any(self._is_too_slow(place, cruise) for place, cruise in enumerate(cruises)):
                return None
            if (least := self._least(cruises)) is not None and least > self.at_most:
                return Beaten(least)
            turns = [self._turn(place, cruises) for place in range(count - 1)]
            slow = {
                # First, both motions at a corner without room are slowed down; then motions that break their
                # own limits; then motions at corners that break a limit or a speed.
                place + side: _SLOWER
                for place, turn in enumerate(turns)
                if turn is None
                for side in (0, 1)
            }
            taken = [turn for turn in turns if turn is not None]
            parts: list[Part] = []
            if not slow:
                tried = self._parts(cruises, taken)
                slow = {
                    place: max(_SLOWER, _CAUTIOUS * asked)
                    for place, asked in enumerate(tried)
                    if isinstance(asked, float)
                }
                parts = [part for part in tried if isinstance(part, Part)]
            if not slow:
                slow = self._slow_corners(parts, taken)
            if not slow:
                return self._finished(parts, taken, cruises)
            # A motion with a given time can't be slowed down, but the motion that it flows into may be.
            free = [place for place in slow if self._is_free(place)]
            if not free:
                return None
            for place in free:
                cruises[place] *= slow[place]
            self._keep_together(cruises)
        return None

    def _keep_together(self, cruises: list[float]) -> None:
        """Slow down motions so that both motions at a corner where the path must be kept have the same share
        of their requested speeds.
        """
        # One pass forwards and one backwards carry the slowest share through a run of tangent corners.
        for order in (range(len(cruises) - 1), range(len(cruises) - 2, -1, -1)):
            for place in order:
                corner, pair = self.links[place].corner, self.links[place : place + 2]
                if corner is None or not corner.is_tangent or any(link.full is None for link in pair):
                    continue
                fulls = [(link.full or 0.0) / self.segment for link in pair]
                share = max(cruises[place] / fulls[0], cruises[place + 1] / fulls[1])
                cruises[place], cruises[place + 1] = share * fulls[0], share * fulls[1]

    def _foreseen(self, cruises: list[float]) -> list[float]:
        """Return the cruises, slowed down to the estimated fastest speeds at which the corners can be passed.

        The estimate uses only the directions of the paths at the corners.
        """
        for _ in range(_MOST_ROUNDS):
            asked = [1.0] * len(cruises)
            for place in range(len(cruises) - 1):
                turn = self._turn(place, cruises)
                more = _SLOWER if turn is None else turn.asked
                for side in (place, place + 1):
                    asked[side] = max(asked[side], more)
            slow = [place for place, more in enumerate(asked) if more > 1.0 and self._is_free(place)]
            if not slow or any(self._is_too_slow(place, cruises[place]) for place in slow):
                break
            for place in slow:
                cruises[place] *= asked[place] + 1e-3
            self._keep_together(cruises)
        return cruises

    def _slow_corners(self, parts: list[Part], turns: list[Turn]) -> dict[int, float]:
        """Return the motions beside corners that break a limit or a speed, each with the factor by which it
        should be slower.
        """
        slow: dict[int, float] = {}
        for place, turn in enumerate(turns):
            first, second = parts[place], parts[place + 1]
            if not self.corners.serves(first, second, place, turn.overlap):
                more = _SLOWER
            else:
                excess = self.corners.excess(first, second, place, turn.overlap)
                more = excess if excess > 1.0 + SPEED_KEPT else 1.0
            if more > 1.0:
                for side in (place, place + 1):
                    slow[side] = max(slow.get(side, 1.0), more)
        return slow

    def _finished(self, parts: list[Part], turns: list[Turn], cruises: list[float]) -> list[Piece] | float:
        for link, part in zip(self.links, parts, strict=True):
            own = Trials(link.path, law_of(part.trial.control), link.own_bounds, link.tolerance)
            more = own.segments_for_tolerance(part.trial)
            if more is not None:
                return self.segment * part.segments / more
            if link.full is not None and isinstance(link.path, CartesianPath):
                finer = finer_for_speed(link.path, part.trial, self.segment)
                if finer is not None:
                    return finer
        kept = [
            1.0 if link.full is None else link.full / self.segment / cruise
            for link, cruise in zip(self.links, cruises, strict=True)
        ]
        return self.corners.cut(parts, [turn.overlap for turn in turns], kept)

    def _is_too_slow(self, place: int, cruise: float) -> bool:
        """Return True if a motion is so slow that stops at both its ends take less time."""
        return self._is_free(place) and cruise * self.segment > _TOO_SLOW * self.links[place].alone.duration

    def _least(self, cruises: list[float]) -> float | None:
        """Return a lower bound of the chain's duration [s]; None as long as all motions are as fast as
        requested.

        From the middle of one corner to the middle of the next, a motion covers its path at its cruise speed.
        """
        taken, is_as_asked = 0.0, True
        for link, middle, cruise in zip(self.links, self.middles, cruises, strict=True):
            if middle is not None:
                taken += middle * self.segment
                continue
            taken += cruise * self.segment
            is_as_asked &= link.full is not None and cruise * self.segment <= link.full * (1.0 + _ROUNDING)
        return None if is_as_asked else taken

    def _is_free(self, place: int) -> bool:
        return self.middles[place] is None

    def _is_outer(self, place: int) -> tuple[bool, bool]:
        """Return two values: whether a motion starts from rest, and whether it ends at rest."""
        return place == 0, place == len(self.links) - 1

    def _first_cruise(self, place: int, outer: float) -> float:
        """Return the number of segments in which the whole path of a motion is traversed at full speed.

        The number follows from a given duration or speed; otherwise it is approximately the smallest possible
        one.
        """
        link, middle = self.links[place], self.middles[place]
        if link.full is not None:
            return link.full / self.segment
        if middle is not None:
            blend = round(outer * middle)
            # A ramp of `blend` segments from rest covers as much path as half of them at full speed.
            return middle - blend / 2.0 * sum(self._is_outer(place))
        bounds, slope = link.own_bounds, link.path.slope
        motors = np.abs(bounds.counts) @ slope / bounds.motor_velocity
        if link.path.is_straight_in_joints:
            motors = np.abs(bounds.counts @ (link.path.end - link.path.start)) / bounds.motor_velocity
        limits = float(max((slope / bounds.velocity).max(), motors.max()))
        zones = bounds.zones.shortest(link.path.joints) if bounds.zones else 0.0
        return max(limits, _BESIDE_ZONES * zones) / self.segment

    def _turn(self, place: int, cruises: list[float]) -> Turn | None:
        """Return the widest overlap that fits into a corner's ball at these speeds, with the ramps that suit
        the limits best; None if there is no room.
        """
        one, other = cruises[place], cruises[place + 1]
        before, behind = self.inside[place]
        # In its ramp a motion covers as much path as in half of the overlap at full speed; this part must be
        # in the ball.
        overlap = 2 * int(min(one * before, other * behind) + 1e-9)
        # If ramps begin between two knots, the overlap must have room for both shifted copies.
        width = overlap - (0 if self.on_knots else 1)
        if width < FEWEST_IN_BLEND:
            return None
        bounds = self.links[place].own_bounds, self.links[place + 1].own_bounds
        # The joints' velocities change from one motion's to the other's, over h. A change over `width`
        # segments, with a share for the rise of the acceleration, has the peaks change / ((1 - share) width
        # h^2) and change / ((1 - share) share width^2 h^3).
        change = np.abs(self.slopes[place][1] / one - self.slopes[place + 1][0] / other)
        h = self.segment
        acceleration = np.maximum(bounds[0].acceleration, bounds[1].acceleration)
        bend = float((change / (width * h**2) / acceleration).max())
        snap = float((change / (width**2 * h**3) / np.maximum(bounds[0].jerk, bounds[1].jerk)).max())
        # Slower motions also have wider overlaps.
        asked = {
            share: max((bend / (1.0 - share)) ** (1 / 2), (snap / ((1.0 - share) * share)) ** (1 / 3))
            for share in STEEPNESS
        }
        steep = min(STEEPNESS, key=asked.__getitem__)
        return Turn(width, max(1, min(round(steep * width), width // 2)), overlap, asked[steep])

    def _parts(self, cruises: list[float], turns: list[Turn]) -> list[Part | float]:
        """Return the planned motions; each one is planned after the motion before it.

        For a motion that breaks its own limits, the item is the factor by which it must be slower.
        """
        parts: list[Part | float] = []
        phase = 0.0
        for place, cruise in enumerate(cruises):
            before = turns[place - 1] if place else None
            behind = turns[place] if place < len(turns) else None
            motion = Between(self.links[place], before, behind, self.middles[place], self.segment)
            part, phase = motion.part(cruise, phase)
            parts.append(part)
        return parts


def _slope(path: Path, s: float) -> Array:
    """Return the derivative of the joint position with respect to s, (n,) [rad or m], at one end of a
    path.
    """
    step = 1e-4
    pair = path.joints(np.array([0.0, step]) if s == 0.0 else np.array([1.0 - step, 1.0]))
    slope: Array = (pair[1] - pair[0]) / step
    return slope
