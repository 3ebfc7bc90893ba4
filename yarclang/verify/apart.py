"""Check that bodies stay apart, by separating planes.

For each stretch (an interval of the controller text's segments), the proof names one plane for each pair of
bodies.

A body is the convex hull of a box around its middle (half edges `core`) or of `corners`, widened by a disc
perpendicular to its z axis and by a ball. The first `joint` joints move it. Of the two bodies of a pair, the
one that fewer joints move is regarded as fixed, and the plane is fixed to it. Only the joints between both
bodies count. Let n be the unit normal of the plane, from the first body a to the second body b. The gap is
min n.b - max n.a over the points of both bodies. Their distance is at least the gap, whatever n is. Over a
stretch, the gap is bounded from below in one of two ways:

- A stretch as a room (a box of joint positions): joints stay in the hull of their control points. From the
  middle of the room, no point moves by more than a sum over the joints between both bodies: the reach of the
  joint (the largest distance of the body's points from its axis) times half the room's width.
- A stretch as a curve over time, without a rest inside: for each point b, n.b has a second derivative of at
  most K. If the stretch takes d seconds, the gap is at most K d^2 / 8 below the lesser of the gaps at its
  ends. For joint positions q, let W, A, J be the sums of |q'|, |q''|, |q'''| from the first joint that counts
  up to a joint. K is the sum of each turning joint's reach times the increase of W^2 + A at this joint, since
  a derivative over a joint is a cross product with its axis. A sliding joint adds 2 W |q'| + |q''|.

In a slow zone, the speed of a point exceeds the larger speed at both ends by at most d^2 / 8 times its third
derivative, which is at most the sum of each turning joint's reach times the increase of W^3 + 3 W A + J.
"""

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Any

from yarclang.verify.arm import Arm, Frame, derivative, dot, in_si
from yarclang.verify.conditions import Border, Rule
from yarclang.verify.course import Moved
from yarclang.verify.exact import BITS, ONE, SLACK, above, need, times, whole
from yarclang.verify.paths import Motion
from yarclang.verify.reader import PRINTED
from yarclang.verify.room import Body, Room

PARTS = 64
"""Stretches begin and end at multiples of 1 / `PARTS` of a segment."""


@dataclass
class Stretch:
    """An interval of a controller text's segments, regarded as a box of joint positions (a room) or as a
    curve over time.

    On the interval, a gap is at least the smallest gap at `links`, minus `part` times a bound of one of its
    derivatives: the first one over the joints for a room, the second one over time for a curve.

    Attributes:
        joints: joint positions in the middle of the room, or at both ends of the curve.
        links: the frames of the joints at these positions.
        rates: lists of bounds of the joints' first, second and third derivatives over time; for a room, the
            list of half its widths, and two lists of zeros.
        order: order of the derivative: 1 for a room, 2 for a curve.
        part: 1 for a room, d^2 / 8 for a curve of d seconds.
        turns: True for each joint that turns.
    """

    joints: list[list[int]]
    links: list[list[Frame]]
    rates: list[list[int]]
    order: int
    part: int
    turns: list[bool]

    def gap(self, one: Body | Border, other: Body, normal: Sequence[Fraction]) -> int:
        """Return a lower bound of the gap between two bodies on the whole stretch. The normal is given in the
        frame of the first body's joint.
        """
        gap = min(_gap(one, other, links, normal) for links in self.links)
        return gap - self.rest(self.order, one.joint, other)

    def speed(self, other: Body) -> int:
        """Return an upper bound of the speeds of a body's points on a curve."""
        fastest = max(other.fastest(links[other.joint]) for links in self.links)
        return fastest + self.rest(3, 0, other)

    def rest(self, order: int, first: int, other: Body) -> int:
        """Return `part` times a bound of a derivative of the points, with the joints before `first` fixed."""
        own = slice(first, other.joint)
        bound, _ = derivative(order, self.turns[own], other.reach[own], *(rate[own] for rate in self.rates))
        return times(bound, self.part)


class Timeline:
    """All segments of a controller text in order, and the arm's kinematics at any place in them."""

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
    def travel(self) -> list[int]:
        """Bound of each joint's distance from its zero position [rad or m]."""
        points = [point for row in self.rows for point in row.control[row.first : row.last + 3]]
        most = [max(map(abs, column)) for column in zip(*points, strict=True)] or [0] * len(self.arm.turns)
        return [in_si(far, PRINTED, turns) + 4 for far, turns in zip(most, self.arm.turns, strict=True)]

    @property
    def steps(self) -> list[tuple[int, int, int]]:
        """The index of each command that has segments, and the start and end of its segments, in units of
        1 / `PARTS` of a segment.
        """
        ends = zip(self.rows, self.begins, self.begins[1:], strict=False)
        return [(row.entry.step, begin * PARTS, end * PARTS) for row, begin, end in ends]

    def _row(self, segment: int) -> tuple[Moved, int]:
        """Return the command that contains a segment, and the segment's number in it."""
        number = bisect_right(self.begins, segment) - 1
        return self.rows[number], segment - self.begins[number]

    def _links_at(self, run: int, place: Fraction) -> tuple[list[int], list[Frame]]:
        q, rates = self.runs[run].at(place)
        return q, self.arm.links(q, rates)

    def _bounds(self, segment: int) -> tuple[list[int], list[int], list[int]]:
        row, own = self._row(segment)
        return Motion(row, self.arm).bounds(row.first + own)

    def stretch(self, begin: int, end: int, is_curve: bool) -> Stretch:
        """Return an interval [1 / `PARTS` of a segment] as a curve or as a room. A room covers whole
        segments, also those that the interval only touches.
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
        return Stretch(
            [middle], [self.arm.links(middle, still)], [half, still, still], 1, ONE, self.arm.turns
        )

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
        offset = self.offsets[row.run]
        joints, links = zip(
            *(self.links_at(row.run, Fraction(one - offset, PARTS)) for one in (begin, end)), strict=True
        )
        bounds = [self.bounds(segment) for segment in range(first, last + 1)]
        rates = [[max(column) for column in zip(*found, strict=True)] for found in zip(*bounds, strict=True)]
        part = above(((end - begin) * row.seconds / PARTS) ** 2 / 8)
        return Stretch(list(joints), list(links), rates, 2, part, self.arm.turns)


def check_apart(
    rows: Sequence[Moved], told: dict[str, Any], planes: list[Any], arm: Arm, map_lines: Sequence[str]
) -> tuple[str, list[str]]:
    """Check that bodies keep their margins, and that zones and path constraints (KEEP) are complied with;
    return what was checked, and what was not.

    Args:
        rows: all commands.
        told: the proof's `bodies`, `exceptions` from their margins, and `zones`.
        planes: stretches [begin, end, kind, [pair, three integers], ...]. The integers are the plane's normal
            in the frame of the first body's joint. The kind is 0 for a room, 1 for a curve, and 2 for a curve
            on which a condition holds, so that no plane is needed.
        arm: the arm.
        map_lines: lines of the text's map, among them those of path constraints.
    """
    timeline = Timeline(rows, arm)
    room = Room(told, arm, timeline.travel, map_lines)
    pairs, bodies = room.pairs(timeline.steps), room.bodies
    moving = {step for step, _, _ in timeline.steps}
    for one in room.all[room.count :]:
        need(not isinstance(one, Rule) or one.steps <= moving, f"{one.name} is for a command without moves")
    # A body is never there, and never excused, only while the robot stands: no plane would be needed.
    periods = [period for body in told["bodies"] for period in body.get("during", [])]
    periods += [rest[-2:] for rest in told["exceptions"]]
    need(
        all(moving.issuperset(map(whole, period)) for period in periods),
        "a body or an exception is there for commands without moves",
    )
    if not moving and (room.count or told["zones"]):
        room.left.append("where the robot stands, since the text has no moves")
    end, count = timeline.count * PARTS, sum(bool(pair.needs) for pair in pairs)
    for first, last, kind, *named in sorted(planes):
        need(bool(named), "planes of no pair")
        stretch = timeline.stretch(whole(first, end), whole(last, end), whole(kind, 2) != 0)
        for number, *normal in named:
            need(0 <= number < len(pairs), "a plane of no pair")
            pair = pairs[whole(number)]
            one, other = room.all[pair.one], bodies[pair.other]
            margin = pair.goes_on(whole(first), whole(last))
            if kind == 2:
                holds = any(condition.holds(stretch, other) for condition in pair.conditions)
                need(holds, f"{other.name} isn't shown to comply with {one.name}")
                continue
            gap = stretch.gap(one, other, normal)
            shown = f"{gap / ONE * 1000:.6g} mm instead of {margin / ONE * 1000:.6g} mm"
            need(gap >= margin + SLACK, f"{other.name} isn't shown to keep away from {one.name}: {shown}")
    left = [pair for pair in pairs if pair.needs]
    checked = (
        f"{count - len(left)} of {count} pairs of bodies, and of bodies and zones or path constraints, keep "
        "their margins, speeds and limits"
    )
    how = ("keeps away from", "complies with")
    names = (f"{bodies[p.other].name} {how[p.other == room.count]} {room.all[p.one].name}" for p in left)
    return checked, [*dict.fromkeys(f"that {name}" for name in names), *room.left]


def _gap(one: Body | Border, other: Body, links: list[Frame], normal: Sequence[Fraction]) -> int:
    """Return the gap between two bodies. The normal is given in the frame of the first body's joint."""
    if isinstance(one, Border):  # a zone's border is its own separating plane
        return one.offset - other.extent(links[other.joint], one.normal)
    x, y, z = (whole(number) for number in normal)
    size = isqrt((x * x + y * y + z * z) << 2 * BITS)
    need(size > 0, "a normal without a direction")
    unit = [(number << 2 * BITS) // size for number in (x, y, z)]
    n = [dot(row, unit) for row in zip(*links[one.joint].axes, strict=True)]
    return -other.extent(links[other.joint], [-x for x in n]) - one.extent(links[one.joint], n)
