"""Plan chains that keep their speed through corners: at each corner, both motions have ramps exactly as long
as their overlap.

The speed that the first motion loses in its last ramp is gained by the second one in its first ramp. Two
lines in one direction are therefore traversed at constant speed. At a corner, the first velocity changes into
the second one over the whole overlap. This is possible only for motion profiles with a constant cruise speed.
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
from yarclang.motion.framespeed import KEPT, finer_for_speed, largest_speed
from yarclang.motion.path import Path
from yarclang.motion.trapezoid import FEWEST_IN_BLEND
from yarclang.motion.trials import Trials
from yarclang.robot.model import Chain

_SLOWER = 1.08
"""Factor by which a motion that breaks a limit is usually slowed down in one round."""

_CAUTIOUS = 0.9
"""Share of the required slow-down that is applied in one round. Ramps and corners change with the speed, so a
smaller slow-down than computed may suffice.
"""

_MOST_ROUNDS = 40
"""Largest number of rounds in which a chain is slowed down."""

_TOO_SLOW = 3.0
"""Factor by which a motion in the chain may take longer than the motion alone. Above it, stops at its ends
are better.
"""

_OUTER = (1 / 3, 0.45, 0.6)
"""Shares of a given duration that a ramp from rest or to rest may take."""

_BESIDE_ZONES = 1.005
"""Factor by which a cruise is at first planned slower than a slow zone allows, since ramps and corners are
rounded differently from the path.
"""

_ROUNDING = 1e-9
"""Relative amount by which a speed may miss the requested one and still counts as exact."""


@frozen
class Beaten:
    """The result of planning a chain that can't be faster than a known plan: it takes at least `least`
    [s].
    """

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
        middles: for each motion with a given duration, its number of segments from the middle of one
            overlap to the middle of the next.

    Returns:
        The planned motions, or a shorter segment time to try. If the chain is of no use, `Beaten` with a
        lower bound of its duration. None if the limits don't allow such a chain.
    """
    if not all(link.profile.has_cruise for link in links):
        return None
    if any(changes_speed(one, other) for one, other in pairwise(links)):
        return None
    maker = _Maker(links, Overlaps(chain, links, segment), segment, middles, inside, at_most)
    # Only motions with given durations depend on the share `outer`.
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

        Ramps from rest or to rest take the share `outer` of the duration if a motion's duration is given.
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
                # Slow down both motions at a corner without room. If there is no such corner, slow down
                # motions that break their own limits, and then motions beside a corner that breaks a limit or
                # a speed.
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
            # A motion with a given duration can't be slowed down, but its neighbour may be.
            free = [place for place in slow if self._is_free(place)]
            if not free:
                return None
            for place in free:
                cruises[place] *= slow[place]
            self._keep_together(cruises)
        return None

    def _keep_together(self, cruises: list[float]) -> None:
        """Slow down motions so that neighbours have equal shares of their requested speeds, at corners where
        the path must be kept.
        """
        # One pass forwards and one pass backwards carry the slowest share along successive tangent corners.
        for order in (range(len(cruises) - 1), range(len(cruises) - 2, -1, -1)):
            for place in order:
                corner, pair = self.links[place].corner, self.links[place : place + 2]
                if corner is None or not corner.is_tangent or any(link.full is None for link in pair):
                    continue
                fulls = [(link.full or 0.0) / self.segment for link in pair]
                # A larger number of segments is slower: the slower of the two motions decides.
                share = max(cruises[place] / fulls[0], cruises[place + 1] / fulls[1])
                cruises[place], cruises[place + 1] = share * fulls[0], share * fulls[1]

    def _foreseen(self, cruises: list[float]) -> list[float]:
        """Return the cruises, slowed down to the estimated highest speeds at which the corners can be passed.

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
                # Slow down slightly more than required, so that the loop ends.
                cruises[place] *= asked[place] + 1e-3
            self._keep_together(cruises)
        return cruises

    def _slow_corners(self, parts: list[Part], turns: list[Turn]) -> dict[int, float]:
        """Find the corners that break a limit or a speed. Return the motions beside them, each with the
        factor by which it should be slower.
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
        overlaps = [turn.overlap for turn in turns]
        ends = [0, *overlaps, 0]
        kept = [
            self._kept(place, part, cruise, slice(ends[place], part.segments - ends[place + 1]))
            for place, (part, cruise) in enumerate(zip(parts, cruises, strict=True))
        ]
        return self.corners.cut(parts, overlaps, kept)

    def _kept(self, place: int, part: Part, cruise: float, own: slice) -> float:
        """Return the share of the requested speed that a motion reaches outside of its overlaps."""
        link = self.links[place]
        if link.full is None:
            return 1.0
        kept = link.full / self.segment / cruise
        if link.speed is None or own.start >= own.stop:
            return kept
        assert isinstance(link.path, CartesianPath)
        law = part.trial.control[own.start : own.stop + 3]
        if link.full / self.segment * float((law[2:] - law[:-2]).max()) / 2.0 >= kept * (1.0 - KEPT):
            return kept
        # Without a cruise, the profile reaches its speed only for an instant, and the curve stays below this
        # speed: measure the speed.
        reached = largest_speed(link.path, part.trial, self.segment, own) / link.speed
        return kept if reached >= kept * (1.0 - KEPT) else reached

    def _is_too_slow(self, place: int, cruise: float) -> bool:
        """Return True if a motion is so slow that stopping at both of its ends takes less time."""
        return self._is_free(place) and cruise * self.segment > _TOO_SLOW * self.links[place].alone.duration

    def _least(self, cruises: list[float]) -> float | None:
        """Return a lower bound of the chain's duration [s]; None as long as all motions are as fast as
        requested.

        The time from the middle of one corner to the middle of the next is that of the whole path at cruise
        speed.
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
        """Return two flags: True if a motion starts from rest, and True if it ends at rest."""
        return place == 0, place == len(self.links) - 1

    def _first_cruise(self, place: int, outer: float) -> float:
        """Return the number of segments in which the whole path of a motion is traversed at cruise speed.

        It follows from a given duration or speed. Otherwise it is approximately the smallest possible number.
        """
        link, middle = self.links[place], self.middles[place]
        if link.full is not None:
            return link.full / self.segment
        if middle is not None:
            blend = round(outer * middle)
            # A ramp of `blend` segments from rest covers as much path as half of these segments at cruise
            # speed.
            return middle - blend / 2.0 * sum(self._is_outer(place))
        bounds, slope = link.own_bounds, link.path.slope
        # |K J q'| is at most |K J| |q'|. On a straight path in joint space, q' is constant, and the exact
        # value is used.
        motors = np.abs(bounds.counts) @ slope / bounds.motor_velocity
        if link.path.is_straight_in_joints:
            motors = np.abs(bounds.counts @ (link.path.end - link.path.start)) / bounds.motor_velocity
        limits = float(max((slope / bounds.velocity).max(), motors.max()))
        zones = bounds.zones.shortest(link.path.joints) if bounds.zones else 0.0
        return max(limits, _BESIDE_ZONES * zones) / self.segment

    def _turn(self, place: int, cruises: list[float]) -> Turn | None:
        """Return the widest overlap that fits into a corner's ball at these speeds, with the ramps that need
        the least slow-down; None if there is no room.
        """
        first, second = cruises[place], cruises[place + 1]
        before, after = self.inside[place]
        # In its ramp, a motion covers as much path as in half of the overlap at cruise speed. This part of
        # the path must be in the ball.
        overlap = 2 * int(min(first * before, second * after) + 1e-9)
        # A ramp that begins between two knots is a mixture of two ramps that begin at these knots. The
        # overlap must have room for both.
        width = overlap - (0 if self.on_knots else 1)
        if width < FEWEST_IN_BLEND:
            return None
        bounds = self.links[place].own_bounds, self.links[place + 1].own_bounds
        # The joints' velocities change by change / h from one motion to the other. If this takes `width`
        # segments, and the acceleration rises in a share of them, the peaks are change / ((1 - share) width
        # h^2) for the acceleration and change / ((1 - share) share width^2 h^3) for the jerk.
        change = np.abs(self.slopes[place][1] / first - self.slopes[place + 1][0] / second)
        h = self.segment
        acceleration = np.maximum(bounds[0].acceleration, bounds[1].acceleration)
        bend = float((change / (width * h**2) / acceleration).max())
        snap = float((change / (width**2 * h**3) / np.maximum(bounds[0].jerk, bounds[1].jerk)).max())
        # A slow-down also makes the overlaps wider, which reduces the peaks further.
        asked = {
            share: max((bend / (1.0 - share)) ** (1 / 2), (snap / ((1.0 - share) * share)) ** (1 / 3))
            for share in STEEPNESS
        }
        steep = min(STEEPNESS, key=asked.__getitem__)
        return Turn(width, max(1, min(round(steep * width), width // 2)), overlap, asked[steep])

    def _parts(self, cruises: list[float], turns: list[Turn]) -> list[Part | float]:
        """Plan the motions, from the first to the last.

        If a motion breaks its own limits, its item is the factor by which it must be slower.
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
