"""Check that a motion stays near its programmed path, follows it in the right order, and covers all of it.

For any s(t) that grows from 0 to 1, let e(t) be the difference between the robot's place and the path's place
at s(t). The length of e bounds the distance of both paths. The proof gives s and s' at the ends of equal
pieces of each segment. Between them s is the cubic with these values, which grows if its Bezier points do.
With e and e' at both ends of a piece of d seconds, e stays within the hull of the four Bezier points of its
Hermite cubic, plus d^4 / 384 times its largest fourth derivative. This derivative is at most that of the arm
plus that of the path, |P(s)''''| <= F4 s'^4 + 6 F3 s'^2 |s''| + F2 (3 s''^2 + 4 |s' s'''|), with F2 to F4
bounds of the path's derivatives over s.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, pairwise
from math import ceil, floor, isqrt
from typing import Any

from yarclang.verify.arm import Arm, Step, Vector, cross, dot, in_si, placed
from yarclang.verify.course import Moved
from yarclang.verify.exact import (
    BITS,
    ONE,
    PI,
    SLACK,
    above,
    fixed,
    length,
    need,
    root,
    sine_and_cosine,
    times,
    whole,
)
from yarclang.verify.reader import PRINTED

SHARE = 10**10
"""Scale of s and s' in the proof: integers in units of 1e-10, and of 1e-10 per second."""
GRID = 1 << 20
"""Number of steps of a segment: the proof states where blends leave and join paths in these steps."""
_SAME = ONE >> 30
"""Largest error of a rotation at the end of its path: 1e-9 rad."""
_ROUND = ONE >> 42
"""Largest error of an arc's points and roundness: 2e-13 m. The arc is then off by less than 1e-9 m."""
OPPOSITE = ONE >> 21
"""Least angle by which a turn is less than half a turn: 5e-7 rad. Closer to half a turn, rounding could
change its direction.
"""
STILL = ONE // 10**6
"""Lengths and angles below this are regarded as rounding errors [m or rad]."""
_OPEN = ONE >> 8
"""Least angle by which an arc is shorter than a full turn [rad].

Closer to a full turn, start, via point and goal define no plane.
"""


State = list[tuple[Vector, Vector]]
"""Groups of numbers with their rates: a frame's origin and the columns of its rotation, or each joint.

Each group has its own bound of the distance from the path.
"""


@dataclass
class Piece:
    """A time interval within a segment, with the path parameter s(t) in it.

    Attributes:
        d: duration [s].
        s: s at both ends.
        rates: s' at both ends.
        bends: bounds of |s'|, |s''|, |s'''|.
        segment: number of the segment.
        end: place at which the interval ends.
    """

    d: Fraction
    s: tuple[int, int]
    rates: tuple[int, int]
    bends: tuple[int, int, int]
    segment: int
    end: Fraction


@dataclass
class Distance:
    """The state of the frame or joints at both ends of a time interval, bounds of their fourth derivatives,
    and the largest distance of each group (such as the frame's origin) from the path.
    """

    piece: Piece
    here: State
    then: State
    bends: Sequence[int]
    off: list[int]


class Motion:
    """A motion of a controller text in SI units: joint positions and velocities at places, and bounds on
    segments.

    A place is a number of segments since the start of the motion's sequence.
    """

    def __init__(self, row: Moved, arm: Arm) -> None:
        self.row, self.arm = row, arm
        self.begin, self.end = Fraction(row.first), Fraction(row.last)

    def at(self, place: Fraction) -> tuple[list[int], list[int]]:
        """Return joint positions and velocities at a place."""
        segment = min(int(place), len(self.row.control) - 4)
        i, k = (place - segment).as_integer_ratio()
        # At the share u = i / k of a segment: basis functions of the uniform cubic B-spline times 6 k^3, then
        # those of its derivative times 2 k^2, all exact integers.
        a, b, c, e = self.row.control[segment : segment + 4]
        w = k - i
        shares = (
            w**3,
            3 * i**3 - 6 * i * i * k + 4 * k**3,
            -3 * i**3 + 3 * i * i * k + 3 * i * k * k + k**3,
            i**3,
        )
        steps = (w * w, k * k + 2 * i * k - 2 * i * i, i * i)
        rate = 1 / self.row.seconds
        q, rates = [], []
        for f0, f1, f2, f3, turns in zip(a, b, c, e, self.arm.turns, strict=True):
            here = shares[0] * f0 + shares[1] * f1 + shares[2] * f2 + shares[3] * f3
            q.append(in_si(here, 6 * k**3 * PRINTED, turns))
            move = steps[0] * (f1 - f0) + steps[1] * (f2 - f1) + steps[2] * (f3 - f2)
            rates.append(in_si(move * rate.numerator, 2 * k * k * PRINTED * rate.denominator, turns))
        return q, rates

    @property
    def travel(self) -> list[int]:
        """Largest distance of each joint from its zero position in the sequence."""
        most = (max(map(abs, column)) for column in zip(*self.row.control, strict=True))
        return [in_si(far, PRINTED, turns) for far, turns in zip(most, self.arm.turns, strict=True)]

    def bounds(self, segment: int) -> tuple[list[int], list[int], list[int]]:
        """Return bounds of |q'|, |q''| and |q'''| of each joint on a segment."""
        a, b, c, e = self.row.control[segment : segment + 4]
        time = self.row.seconds
        w, bend, jerk = [], [], []
        for f0, f1, f2, f3, turns in zip(a, b, c, e, self.arm.turns, strict=True):
            # Bezier points of the velocity, both ends of the acceleration, and the jerk (see limits.py).
            one, two, three = f1 - f0, f2 - f1, f3 - f2
            w.append(_si_above(max(abs(one + two), 2 * abs(two), abs(two + three)), time, 2, turns))
            bend.append(_si_above(max(abs(two - one), abs(three - two)), time**2, 1, turns))
            jerk.append(_si_above(abs(three - 2 * two + one), time**3, 1, turns))
        return w, bend, jerk


def _si_above(number: int, time: Fraction, divisor: int, turns: bool) -> int:
    return in_si(number * time.denominator, PRINTED * time.numerator * divisor, turns) + (ONE >> 100)


def cut(begin: Fraction, end: Fraction, pieces: int) -> list[Fraction]:
    """Cut each segment between two places into `pieces` equal pieces; return the places of the cuts."""
    need(1 <= pieces <= 64, "a segment has 1 to 64 pieces")
    if begin == end:
        return [end]
    edges = [max(begin, min(Fraction(k), end)) for k in range(floor(begin), ceil(end) + 1)]
    parts = [one + (other - one) * k / pieces for one, other in pairwise(edges) for k in range(pieces)]
    return [*parts, end]


def pieces_of(motion: Motion, proof: dict[str, Any]) -> Iterator[Piece]:
    """Yield the pieces of a motion's time from the place `from` to the place `until` in the proof; refuse an
    s that decreases or leaves [0, 1].
    """
    shares, rates = proof["s"], proof["rates"]
    (begin, end), pieces = span_of(motion, proof), whole(proof["pieces"])
    count = (ceil(end) - floor(begin)) * pieces + 1 if begin < end else 1
    need(len(shares) == len(rates) == count, "the proof has another number of places than pieces and one")
    places = cut(begin, end, pieces)
    need(shares[0] >= 0 and shares[-1] <= SHARE, "s leads beyond an end of the path")
    for k, (begin, end) in enumerate(pairwise(places)):
        d = motion.row.seconds * (end - begin)
        # Bezier points of s on the piece: s never decreases if the points don't.
        points = [
            Fraction(shares[k]),
            shares[k] + rates[k] * d / 3,
            shares[k + 1] - rates[k + 1] * d / 3,
            Fraction(shares[k + 1]),
        ]
        steps = [b - a for a, b in pairwise(points)]
        need(min(steps) >= 0, f"s goes back on piece {k}")
        # Bezier points of s' and s'' are scaled differences of those of s; s''' is constant.
        s1 = max(steps) * 3 / d
        bends = [(b - a) * 6 / d**2 for a, b in pairwise(steps)]
        s3 = abs(bends[1] - bends[0]) / d
        most = (above(s1 / SHARE), above(max(map(abs, bends)) / SHARE), above(s3 / SHARE))
        ends = (fixed(Fraction(shares[k], SHARE)), fixed(Fraction(shares[k + 1], SHARE)))
        slopes = (fixed(Fraction(rates[k], SHARE)), fixed(Fraction(rates[k + 1], SHARE)))
        yield Piece(d, ends, slopes, most, int(begin), end)


def span_of(motion: Motion, proof: dict[str, Any]) -> tuple[Fraction, Fraction]:
    """Return the places between which a motion follows its path: by default, the motion's ends."""
    begin, end = motion.begin, motion.end
    if "from" in proof:
        begin, end = (Fraction(whole(proof[name]), GRID) for name in ("from", "until"))
    need(0 <= begin <= end <= len(motion.row.control) - 3, "a path is followed from nowhere")
    return begin, end


def path_bend(derivatives: Sequence[int], bends: tuple[int, int, int]) -> int:
    """Return a bound of |P(s(t))''''|, from bounds of P's derivatives over s, and of |s'| to |s'''|."""
    second, third, last = derivatives
    w, a, j = bends
    square = times(w, w)
    return (
        times(last, times(square, square))
        + 6 * times(third, times(square, a))
        + times(second, 3 * times(a, a) + 4 * times(w, j))
    )


def farthest(e: Sequence[int], e_rate: Sequence[int], f: Sequence[int], f_rate: Sequence[int], d: int) -> int:
    """Return a bound of the length of a vector that is a cubic over d seconds, from its values e, f and its
    rates at both ends: the largest distance of the cubic's Bezier points from 0.
    """
    inner = [x + (d * v >> BITS) // 3 for x, v in zip(e, e_rate, strict=True)]
    outer = [x - (d * v >> BITS) // 3 for x, v in zip(f, f_rate, strict=True)]
    return max(length(*e), length(*inner), length(*outer), length(*f)) + SLACK


class Curve:
    """The curve middle + s way + cos(s angle) spoke + sin(s angle) side, for s from 0 to 1.

    A point moves along it on a line or an arc, or a column of a matrix that rotates. `bends` are bounds of
    its derivatives over s of order 2 to 4, and of the jumps of the third derivative.
    """

    def __init__(self, middle: Vector, way: Vector, spoke: Vector, side: Vector, angle: int) -> None:
        self.angle, self._parts = angle, list(zip(middle, way, spoke, side, strict=True))
        size = length(*spoke, *side)
        self.bends = [*(times(size, *[angle + 1] * k) for k in (2, 3, 4)), 0]

    def at(self, s: int) -> tuple[Vector, Vector]:
        """Return the curve's point at s, and the derivative over s."""
        sine, cosine = sine_and_cosine(s * self.angle >> BITS)
        place = [m + ((s * w + cosine * a + sine * b) >> BITS) for m, w, a, b in self._parts]
        return place, [
            w + ((cosine * b - sine * a >> BITS) * self.angle >> BITS) for _, w, a, b in self._parts
        ]

    def leads(self, s: int, meant: Sequence[int], most: int, what: str) -> None:
        """Refuse a curve whose point at s is farther than `most` from where it is meant to be."""
        off = length(*(a - b for a, b in zip(self.at(s)[0], meant, strict=True)))
        need(off < most, f"{what}: it is {off / ONE:.3g} away from where it is to be")


def line(start: Vector, goal: Vector) -> Curve:
    """Return a straight line."""
    return Curve(start, [b - a for a, b in zip(start, goal, strict=True)], [0] * 3, [0] * 3, 0)


def arc(start: Vector, goal: Vector, told: dict[str, Any], via: Vector) -> Curve:
    """Return an arc of less than a full turn by centre, spoke, side and sweep; check that it passes `via`."""
    centre, spoke, side = ([fixed(x) for x in told[name]] for name in ("centre", "spoke", "side"))
    share, sweep = told["via"], fixed(told["sweep"])
    defined = Fraction(1, 100) < share < Fraction(99, 100) and 0 < sweep < 2 * PI - _OPEN
    need(defined and length(*spoke) < 64 * ONE, "an arc has other numbers than it should")
    need(abs(dot(spoke, side)) < _ROUND, "an arc isn't a circle's")
    need(abs(dot(spoke, spoke) - dot(side, side)) < _ROUND, "an arc isn't a circle's")
    found = Curve(centre, [0] * 3, spoke, side, sweep)
    for s, meant in ((0, start), (fixed(share), via), (ONE, goal)):
        found.leads(s, meant, _ROUND, "an arc")
    return found


def turn(start: list[Vector], goal: list[Vector], axis: Vector, angle: int) -> Curve:
    """Return a frame's rotation by less than half a turn about a fixed axis, as the curve of the columns of
    R + sin K R + (1 - cos) K^2 R, with K the cross-product matrix of the axis, and R the rotation at the
    start.
    """
    need(abs(dot(axis, axis) - ONE) < _SAME and angle >= 0, "a turn without an axis")
    need(angle <= PI - OPPOSITE, "a turn so near to half a turn that its direction isn't certain")
    once = [cross(axis, column) for column in start]
    twice = [one for column in once for one in cross(axis, column)]
    middle = [a + b for a, b in zip(chain(*start), twice, strict=True)]
    found = Curve(middle, [0] * 9, [-one for one in twice], list(chain(*once)), angle)
    found.leads(ONE, list(chain(*goal)), _SAME, "a turn")
    return found


class FramePath:
    """A programmed path of a frame: a line or an arc of the frame's origin, with the frame's rotation.

    `group` is 0 if the programmed speed is that of the origin, and 1 if it is the angular speed of a frame
    whose origin doesn't move. It is None for a path that leads nowhere, which has no speed.

    The chord between two rotations is the Frobenius norm of their difference, 2 sqrt 2 sin(angle / 2).
    """

    def __init__(self, start: Step, told: dict[str, Any], proof: dict[str, Any]) -> None:
        self.goal = placed(told["pose"])
        off = length(*(b - a for a, b in zip(start[1], self.goal[1], strict=True)))
        turns = fixed(proof["angle"]) >= STILL
        self.group = (1 if turns else None) if told["move"] == "line" and off < STILL else 0
        self.turn = turn(start[0], self.goal[0], [fixed(one) for one in proof["axis"]], fixed(proof["angle"]))
        if told["move"] == "arc":
            self.origin = arc(start[1], self.goal[1], proof, [fixed(x) for x in told["via"]])
        else:
            self.origin = line(start[1], self.goal[1])

    def at(self, s: int) -> State:
        """Return origin and rotation at s, and their derivatives over s."""
        return [self.origin.at(s), self.turn.at(s)]

    def bends(self, _: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return bounds of the derivatives over s of order 2 to 4, and of the third derivative's jumps."""
        return [self.origin.bends, self.turn.bends]


class Frames:
    """A frame on the flange while the joints move; `motion` is a `Motion` or has the same methods."""

    def __init__(self, arm: Arm, tool: Step, motion: Any) -> None:
        self.arm, self.tool, self._motion = arm, tool, motion
        slides = [0 if turn else far + 1 for far, turn in zip(motion.travel, arm.turns, strict=True)]
        self.reach = arm.reaches(len(slides), arm.to_flange(tool[1]), slides)

    def at(self, place: Fraction) -> State:
        """Return origin and rotation at a place, with their velocities."""
        q, rates = self._motion.at(place)
        frame = self.arm.frame(q, rates, self.tool)
        turning = [cross(frame.spin, column) for column in frame.axes]
        return [(frame.origin, frame.rate), (list(chain(*frame.axes)), list(chain(*turning)))]

    def bends(self, segment: int) -> Sequence[int]:
        """Return bounds of the fourth derivatives on a segment."""
        return self.arm.bends(self.reach, *self._motion.bounds(segment))


def distances(what: Any, path: Any, pieces: Iterable[Piece], here: State) -> Iterator[Distance]:
    """Yield bounds of the distances of all groups (such as the frame's origin) from their paths, for each
    time interval.

    Args:
        what: what moves: `Frames` or `Joints`.
        path: the path.
        pieces: consecutive time intervals.
        here: state of `what` at the start of the first interval.
    """
    segment, bends = -1, list[int]()
    for piece in pieces:
        if piece.segment != segment:
            segment, bends = piece.segment, what.bends(piece.segment)
        then, d = what.at(piece.end), above(piece.d)
        ends = [
            error(state, path.at(s), rate)
            for state, s, rate in zip((here, then), piece.s, piece.rates, strict=True)
        ]
        found = []
        for (e, v), (f, w), own, (*over, jump) in zip(*ends, bends, path.bends(piece.s), strict=True):
            off = times(d, d, d, d, own + path_bend(over, piece.bends)) // 384 + 1
            off += times(d, d, d, jump, *piece.bends[:1] * 3) // 192 if jump else 0
            found.append(farthest(e, v, f, w, d) + off)
        yield Distance(piece, here, then, bends, found)
        here = then


def error(state: State, path: State, rate: int) -> State:
    """Return the deviation of the frame or joints from their path, for each group of numbers as value and
    rate. `rate` is the rate of the path parameter s.
    """
    return [
        (
            [a - b for a, b in zip(at, meant, strict=True)],
            [v - (rate * b >> BITS) for v, b in zip(moving, slope, strict=True)],
        )
        for (at, moving), (meant, slope) in zip(state, path, strict=True)
    ]


def speeds_on(found: Distance, group: int) -> tuple[int, int, int]:
    """Return bounds of a frame's speed in a time interval of d seconds: of the least speed, of the largest
    one, and of the larger one of the speeds at both ends.

    Let v and w be the velocities at the interval's ends. The cubic polynomial that has the positions and
    velocities at both ends (the Hermite cubic) has a parabola as its velocity, with the Bezier points v, m,
    w. The squared length of the parabola lies between the least and the largest of its own Bezier
    coefficients. The true velocity differs from the parabola by at most sqrt(3) / 216 d^3 times the largest
    fourth derivative; both bounds allow for this.

    Args:
        found: the states at both ends.
        group: 0 for the origin [m/s], 1 for the rotation [rad/s], whose angular speed is 1 / sqrt 2 of the
            rotation matrix's rate.
    """
    (begin, v), (end, w), d = found.here[group], found.then[group], above(found.piece.d)
    m = [(3 * (b - a) << BITS) // d - x - y for a, b, x, y in zip(begin, end, v, w, strict=True)]
    vv, vm, vw, mm, mw, ww = (
        sum(a * b for a, b in zip(x, y, strict=True)) >> BITS + group
        for x, y in ((v, v), (v, m), (v, w), (m, m), (m, w), (w, w))
    )
    squares = (vv, vm, (vw + 2 * mm) // 3, mw, ww)
    rest = times(d, d, d, found.bends[group]) * 9 // 1000 + SLACK  # Hermite cubics: sqrt(3)/216 < 9/1000
    least = max(isqrt(max(min(squares), 0) << BITS) - rest, 0)
    return least, root(max(squares)) + rest, isqrt(max(vv, ww) << BITS) - SLACK


def chord_of(angle: int) -> int:
    """Return a lower bound of the chord of a rotation (see `FramePath`): 2 sqrt 2 sin(angle / 2)."""
    sine, _ = sine_and_cosine(min(angle, PI) // 2)
    return 2 * (sine * 14142 // 10000) - SLACK
