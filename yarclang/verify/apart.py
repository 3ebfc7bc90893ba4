"""Check that bodies stay apart, by separating planes.

For each stretch (an interval of the controller text's segments), the proof names one plane for each pair of
bodies.

A body is the convex hull of a box around its middle (half edges `core`) or of `corners`, widened by a disc
perpendicular to its z axis and by a ball. The first `joint` joints move it. Of a pair, the body that fewer
joints move is regarded as fixed, together with the plane; only the joints between both count. With the unit
normal n of the plane, from the first body a to the second body b, the gap is min n.b - max n.a over their
points. The distance of the bodies is at least the gap, whatever n is. Over a stretch, the gap is bounded from
below in one of two ways:

- A stretch as a room (a box of joint positions): joints stay in the hull of their control points. From the
  middle of the room, no point moves by more than the sum of reach times half the room's width, over the
  joints between both bodies.
- A stretch as a curve over time, without a rest inside: for each point b, n.b has a second derivative of at
  most K. So the gap is below the lesser of the gaps at both ends by at most K d^2 / 8, for d seconds. With
  the sums W and A of |q'| and |q''| up to a joint, K is the sum of reach (W^2 + A, less its value before),
  since each derivative over a joint is a cross product with its axis; a sliding joint adds 2 W |q'| + |q''|.

In a slow zone, the speed of a point exceeds the larger speed at both ends by at most d^2 / 8 times its
largest third derivative, which is at most the sum of reach (W^3 + 3 W A + J, less its value before).
"""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Any

from yarclang.verify.arm import Arm, Frame, derivative, dot, in_si
from yarclang.verify.course import Moved
from yarclang.verify.exact import BITS, ONE, SLACK, above, need, times, whole
from yarclang.verify.paths import Motion
from yarclang.verify.reader import PRINTED
from yarclang.verify.room import Body, Border, Room

PARTS = 64
"""Stretches begin and end at multiples of this part of a segment."""


@dataclass
class Stretch:
    """An interval of a controller text's segments, regarded as a box of joint positions (a room) or as a
    curve over time.

    On the interval, a gap is smaller than the least gap at `links` by at most `part` times a bound of the
    gap's derivative of this `order`: the first derivative over the joints in a room, the second over time on
    a curve.

    Attributes:
        links: the frames of the joints in the middle of the room, or at both ends of the curve.
        rates: for each joint, half the widths of the room, or bounds of its first three derivatives.
        order: 1 for a room, 2 for a curve.
        part: 1 for a room, d^2 / 8 for a curve.
    """

    links: list[list[Frame]]
    rates: list[list[int]]
    order: int
    part: int

    def gap(self, one: Body | Border, other: Body, normal: Sequence[Fraction], turns: Sequence[bool]) -> int:
        """Return a lower bound of the gap between two bodies on the whole stretch, along a normal that is
        given in the frame of the first body's joint.
        """
        gap = min(_gap(one, other, links, normal) for links in self.links)
        return gap - self._rest(self.order, one.joint, other, turns)

    def speed(self, other: Body, turns: Sequence[bool]) -> int:
        """Return an upper bound of the speeds of a body's points on a curve."""
        fastest = max(other.fastest(links[other.joint]) for links in self.links)
        return fastest + self._rest(3, 0, other, turns)

    def _rest(self, order: int, first: int, other: Body, turns: Sequence[bool]) -> int:
        """Bound what a derivative of a body's points adds, which the joints from `first` on move."""
        own = slice(first, other.joint)
        bound, _ = derivative(order, turns[own], other.reach[own], *(rate[own] for rate in self.rates))
        return times(bound, self.part)


class Timeline:
    """All segments of a controller text in order, with the arm on them."""

    def __init__(self, rows: Sequence[Moved], arm: Arm) -> None:
        self.arm = arm
        self.rows = [row for row in rows if row.last > row.first]
        self.begins = [0]
        for row in self.rows:
            self.begins.append(self.begins[-1] + row.last - row.first)
        self.count = self.begins[-1]
        self.runs, self.offsets = dict[int, Motion](), dict[int, int]()
        for row, begin in zip(self.rows, self.begins, strict=False):
            self.runs.setdefault(row.run, Motion(row, arm))
            self.offsets.setdefault(row.run, (begin - row.first) * PARTS)
        self.links_at = lru_cache(64)(self._links_at)
        self.bounds = lru_cache(4096)(self._bounds)

    @property
    def steps(self) -> list[tuple[int, int, int]]:
        """The step of each command, with the begin and the end of its interval of segments."""
        ends = zip(self.rows, self.begins, self.begins[1:], strict=False)
        return [(row.entry.step, begin * PARTS, end * PARTS) for row, begin, end in ends]

    def _row(self, segment: int) -> tuple[Moved, int]:
        """Return the command that contains a segment, and the segment's number in it."""
        number = bisect_right(self.begins, segment) - 1
        return self.rows[number], segment - self.begins[number]

    def _links_at(self, run: int, place: Fraction) -> list[Frame]:
        return self.arm.links(*self.runs[run].at(place))

    def _bounds(self, segment: int) -> tuple[list[int], list[int], list[int]]:
        row, own = self._row(segment)
        return Motion(row, self.arm).bounds(row.first + own)

    def stretch(self, begin: int, end: int, is_curve: bool) -> Stretch:
        """Return an interval of segments as a curve, or as a room, which then covers all segments that it
        touches.
        """
        need(0 <= begin < end, "a stretch of nothing")
        return self._curve(begin, end) if is_curve else self._room(begin // PARTS, (end - 1) // PARTS)

    def _room(self, first: int, last: int) -> Stretch:
        """Return the segments from `first` to `last` as a room (a box of joint positions)."""
        low, high = list[int](), list[int]()
        for own in self._control(first, last):
            low = [min(pair) for pair in zip(low or own[0], *own, strict=True)]
            high = [max(pair) for pair in zip(high or own[0], *own, strict=True)]
        middle = [in_si(a + b, 2 * PRINTED, t) for a, b, t in zip(low, high, self.arm.turns, strict=True)]
        half = [in_si(b - a, 2 * PRINTED, t) + 4 for a, b, t in zip(low, high, self.arm.turns, strict=True)]
        still = [0] * len(middle)
        return Stretch([self.arm.links(middle, still)], [half, still, still], 1, ONE)

    def _control(self, first: int, last: int) -> Iterator[list[tuple[int, ...]]]:
        for row, begin in zip(self.rows, self.begins, strict=False):
            one, end = max(first - begin, 0), min(last + 1 - begin, row.last - row.first)
            if one < end:
                yield row.control[row.first + one : row.first + end + 3]

    def _curve(self, begin: int, end: int) -> Stretch:
        """Return an interval of segments as a curve over time. The interval must not contain a rest."""
        first, last = begin // PARTS, (end - 1) // PARTS
        row = self._row(first)[0]
        need(row.run == self._row(last)[0].run, "a curve that isn't within one sequence")
        links = [self.links_at(row.run, Fraction(one - self.offsets[row.run], PARTS)) for one in (begin, end)]
        bounds = [self.bounds(segment) for segment in range(first, last + 1)]
        rates = [[max(column) for column in zip(*found, strict=True)] for found in zip(*bounds, strict=True)]
        return Stretch(links, rates, 2, above(((end - begin) * row.seconds / PARTS) ** 2 / 8))


def check_apart(
    rows: Sequence[Moved], told: dict[str, Any], planes: list[Any], arm: Arm
) -> tuple[str, list[str]]:
    """Check that bodies keep their margins and respect zones; return what was checked, and what was not.

    Args:
        rows: all commands.
        told: the proof's `bodies`, `exceptions` from their margins, and `zones`.
        planes: stretches [begin, end, kind, [pair, three integers: n in the frame of the first body's joint],
            ...]. The kind is 0 for a room, 1 for a curve, and 2 for a curve that is slow enough for a slow
            zone.
        arm: the arm.
    """
    timeline = Timeline(rows, arm)
    travel = [0] * len(arm.turns)
    for row in timeline.rows:
        for point in row.control[row.first : row.last + 3]:
            travel = [max(most, abs(at)) for most, at in zip(travel, point, strict=True)]
    travel = [in_si(most, PRINTED, turns) + 4 for most, turns in zip(travel, arm.turns, strict=True)]
    room = Room(told, arm, travel)
    pairs, bodies = room.pairs(timeline.steps), room.bodies
    end, count = timeline.count * PARTS, sum(bool(pair.needs) for pair in pairs)
    for first, last, kind, *named in sorted(planes):
        stretch = timeline.stretch(whole(first, end), whole(last, end), whole(kind, 2) != 0)
        for number, *normal in named:
            need(0 <= number < len(pairs), "a plane of no pair")
            pair = pairs[whole(number)]
            one, other = room.all[pair.one], bodies[pair.other]
            if kind == 2:
                speed = stretch.speed(other, arm.turns)
                need(speed <= one.speed, f"{other.name} isn't shown to be slow enough in {one.name}")
                pair.goes_on(whole(first), whole(last))
                continue
            gap = stretch.gap(one, other, normal, arm.turns)
            margin = pair.goes_on(whole(first), whole(last))
            shown = f"{gap / ONE * 1000:.6g} mm instead of {margin / ONE * 1000:.6g} mm"
            need(gap >= margin + SLACK, f"{other.name} isn't shown to keep away from {one.name}: {shown}")
    left = [pair for pair in pairs if pair.needs]
    checked = (
        f"{count - len(left)} of {count} pairs of bodies, and of zones and bodies, keep margins and speeds"
    )
    names = dict.fromkeys(f"{bodies[pair.other].name} and {room.all[pair.one].name}" for pair in left)
    return checked, [*(f"that {name} keep apart" for name in names), *room.left]


def _gap(one: Body | Border, other: Body, links: list[Frame], normal: Sequence[Fraction]) -> int:
    """Return the gap between two bodies along a normal that is given in the frame of the first body's
    joint.
    """
    if isinstance(one, Border):  # only the border itself is a plane for it
        return one.offset - other.extent(links[other.joint], one.normal)
    x, y, z = (whole(number) for number in normal)
    size = isqrt((x * x + y * y + z * z) << 2 * BITS)
    need(size > 0, "a normal without a direction")
    unit = [(number << 2 * BITS) // size for number in (x, y, z)]
    n = [dot(row, unit) for row in zip(*links[one.joint].axes, strict=True)]
    return -other.extent(links[other.joint], [-x for x in n]) - one.extent(links[one.joint], n)
