"""Conditions that separating planes can't show: path constraints (KEEP), ranges of joints, speeds in zones,
and round regions to stay in.

Each is checked on a curve (see `apart.py`) of d seconds. A point p with |p''| <= K stays within K d^2 / 8 of
the chord between its ends, and a convex function, such as a distance, is largest at an end of a chord.

A path constraint may limit the angle between an axis a and the vector v from the apex of a cone to a point.
The point is in the cone if a.v - cos(limit) |v| >= 0. On a curve, this is at most d^2 / 8 (|(a.v)''| +
cos(limit) |v''|) below the lesser of its values at both ends, with |(a.v)''| <= |v''| + 2 |a'| |v'| + |a''|
|v|.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol
from urllib.parse import unquote

from yarclang.verify.arm import Arm, Vector, beyond, derivative, dot, in_si
from yarclang.verify.exact import BITS, ONE, SLACK, above, fixed, length, need, sine_and_cosine, times

BORDER = above(Fraction(1, 100_000))
"""Distance [m] or angle [rad] beyond a border that still counts as on the border."""
_JOINT_BORDER = above(Fraction(1, 1_000_000))
"""Distance beyond an end of a joint's range that still counts as on the end [rad or m]."""
_RULE = r"(\{\S+\} (UPRIGHT|ABOVE|FACING|SEEN) ([-0-9.e ]+) \((deg|mm|deg,mm)\) \{\S+\}) ([-+0-9.einf ]+)"
_NUMBER = r"-?[0-9]{1,20}(\.[0-9]{1,20})?(e[-+][0-9]{1,2})?"
_LEAST = Fraction(1, 1000)
"""Least distance between the apex of a cone and the point in the cone, unless a rule states another one
[m].
"""


EVERYWHERE = [0, 0, ONE], -(ONE << 20)
"""Normal and offset of a half-space that contains all bodies. No plane keeps them out of it."""


class Condition(Protocol):
    """A requirement on a body, for stretches on which no plane keeps the body out of a region."""

    def holds(self, stretch: Any, body: Any) -> bool:
        """Return True if the condition holds for a body on a curve (`apart.Stretch`)."""


@dataclass
class Border:
    """The half-space beyond a fixed plane, as a body: the points p with `normal`.p >= `offset`."""

    name: str
    margin: int
    normal: Vector
    offset: int
    joint = 0

    def is_there(self, _: int) -> bool:
        """Return True: a zone applies to all commands."""
        return True


def rules_of(lines: Sequence[str], arm: Arm, travel: Sequence[int]) -> list["Rule"]:
    """Return the path constraints (KEEP) that the map of a text states."""
    steps, before = dict[str, set[int]](), -1
    for line in lines:
        if line.startswith("; keep "):
            words = line.split(" ")[2:]
            need(len(words) == 2 and words[0].isdecimal(), f"{line!r} doesn't name a command and a rule")
            those, step = steps.setdefault(unquote(words[1]), set()), int(words[0])
            need(step >= before and step not in those, f"{line!r} is out of order, or stands twice")
            those.add(step)
            before = step
    return [Rule(text, those, arm, travel) for text, those in steps.items()]


class Rule(Border):
    """A path constraint (KEEP), as the map of a text states it in words and by its numbers.

    UPRIGHT: the angle between an axis on the flange and a fixed one. ABOVE: the height of a point of the
        flange over a plane. FACING: a fixed point is in a cone on the flange. SEEN: a point of the flange is
        in a fixed cone.

    Attributes:
        name: the constraint in words.
        steps: the commands to which the constraint applies.
    """

    def __init__(self, text: str, steps: set[int], arm: Arm, travel: Sequence[int]) -> None:
        form = re.fullmatch(_RULE, text)
        need(form is not None, f"a rule of another form than this checker knows: {text[:80]}")
        name, self.kind, amounts, unit, told = form.groups() if form else ("",) * 5
        super().__init__(name, 0, *EVERYWHERE)
        self.steps, self.arm = steps, arm
        numbers, size = _numbers(told), len(amounts.split())
        units = {"UPRIGHT": ("deg",), "ABOVE": ("mm",)}.get(self.kind, ("deg", "deg,mm"))
        need(unit in units and (size == 1 or unit == "deg,mm"), f"{name}: a rule with another unit")
        in_sight = self.kind in ("FACING", "SEEN")
        need(len(numbers) == (12 if in_sight else 8), f"{self.name}: a rule with other numbers")
        self.own, self.other, self.axis = (
            list(map(fixed, numbers[k : k + 3])) for k in (0, 3, 6 if in_sight else 3)
        )
        self.level = fixed(numbers[6])
        self.limit, self.near, self.far = numbers[-3:] if in_sight else (numbers[-1], _LEAST, Fraction(64))
        # The words give the limits in deg or mm, with ten digits.
        said = [in_si(one, 1, k == 0 and self.kind != "ABOVE") for k, one in enumerate(_numbers(amounts))]
        exact = [fixed(one) for one in (self.limit, self.near, self.far)]
        said += [above(_LEAST), 64 * ONE][len(said) - 1 :]
        same = all(abs(a - b) <= (abs(b) >> 30) + (ONE >> 32) for a, b in zip(said, exact, strict=True))
        need(same, f"{self.name}: the words and the numbers of the rule differ")
        need(self.kind == "ABOVE" or self.limit >= 0, f"{self.name}: an angle below 0")
        axes = [self.own, self.other] if self.kind == "UPRIGHT" else [self.axis]
        need(
            all(abs(length(*one) - ONE) < ONE >> 30 for one in axes),
            f"{self.name}: an axis of another length than 1",
        )
        slides = [0 if turns else far + 1 for far, turns in zip(travel, arm.turns, strict=True)]
        self.reach = arm.reaches(len(slides), arm.to_flange(self.own), slides)

    def is_there(self, step: int) -> bool:
        """Return True if the constraint applies to a command."""
        return step in self.steps

    def holds(self, stretch: Any, _: Any) -> bool:
        """Return True if the arm complies with the constraint on a curve."""
        flange = [beyond(links[-1], self.arm.steps[-1]) for links in stretch.links]
        (first, turn_1), (second, turn_2) = (
            derivative(order, self.arm.turns, self.reach, *stretch.rates) for order in (1, 2)
        )
        sag, cosine = times(second, stretch.part) + SLACK, sine_and_cosine(fixed(self.limit) + BORDER)[1]
        on_flange = [[dot(row, self.own) for row in zip(*frame.axes, strict=True)] for frame in flange]
        if self.kind == "UPRIGHT":
            return (
                min(dot(axis, self.other) for axis in on_flange) - times(turn_2, stretch.part) - SLACK
                >= cosine
            )
        points = [
            [a + b for a, b in zip(frame.origin, own, strict=True)]
            for frame, own in zip(flange, on_flange, strict=True)
        ]
        if self.kind == "ABOVE":
            lowest = min(dot(point, self.other) for point in points) - sag
            return lowest >= self.level + fixed(self.limit) - BORDER
        sign, axes = 1, [self.axis] * 2
        if self.kind == "FACING":
            sign, axes = (
                -1,
                [[dot(row, self.axis) for row in zip(*frame.axes, strict=True)] for frame in flange],
            )
        ways = [[sign * (a - b) for a, b in zip(point, self.other, strict=True)] for point in points]
        sizes = [length(*way) for way in ways]
        most = max(sizes) + sag
        # No vector on the chord is shorter than the smaller component of its two ends along their mean.
        mean = [a + b for a, b in zip(*ways, strict=True)]
        least = min(dot(way, mean) for way in ways) * ONE // max(length(*mean), 1) - sag
        bend = sag
        if self.kind == "FACING":
            bend += times(stretch.part, 2 * times(turn_1, first) + times(turn_2, most))
        along = [dot(axis, way) for axis, way in zip(axes, ways, strict=True)]
        if cosine >= 0:
            spare = min(a - times(cosine, size) for a, size in zip(along, sizes, strict=True)) - times(
                cosine, sag
            )
        else:  # |v| is at least the least distance of the chord from the apex
            spare = min(along) + (-cosine * least >> BITS)
        return spare >= bend and least >= fixed(self.near) - BORDER and most <= fixed(self.far) + BORDER


def _numbers(words: str) -> list[Fraction]:
    """Return printed numbers; `inf` as 64, which is farther than an arm reaches [m]."""
    found = [
        Fraction(64) if word == "inf" else Fraction(word)
        for word in words.split()
        if word == "inf" or re.fullmatch(_NUMBER, word)
    ]
    need(len(found) == len(words.split()), f"no numbers of a rule: {words[:80]}")
    return found


class Window:
    """A lower and an upper end for each joint [rad or m]; None for an end that doesn't exist."""

    def __init__(
        self, told: Sequence[Sequence[Fraction | None]], turns: Sequence[bool], outside: bool = False
    ) -> None:
        need(len(told) == len(turns), "ranges of another number of joints")
        self.outside = outside
        self.ends = [
            [None if one is None else in_si(one, 1, turn) for one in pair]
            for pair, turn in zip(told, turns, strict=True)
        ]

    def holds(self, stretch: Any, _: Any) -> bool:
        """Return True if all joints stay in their ranges; with `outside`, if at least one joint stays out of
        its range.
        """
        inside, outside = True, False
        for joint, (low, high) in enumerate(self.ends):
            sag = times(stretch.rates[1][joint], stretch.part)
            least = min(q[joint] for q in stretch.joints) - sag + _JOINT_BORDER
            most = max(q[joint] for q in stretch.joints) + sag - _JOINT_BORDER
            inside &= (low is None or least >= low) and (high is None or most <= high)
            below, beyond_ = low is not None and most <= low, high is not None and least >= high
            outside |= below or beyond_
        return outside if self.outside else inside


@dataclass
class Slow:
    """A speed that no point of a body exceeds [m/s]."""

    speed: int

    def holds(self, stretch: Any, body: Any) -> bool:
        """Return True if a body is slow enough on a curve."""
        return bool(stretch.speed(body) <= self.speed)


class Inside:
    """A ball, a capsule or a cylinder to stay in, around the z axis of its frame."""

    def __init__(
        self, axes: list[Vector], origin: Vector, half: int, disc: int, radius: int, margin: int
    ) -> None:
        self.axes, self.origin, self.half, self.disc, self.radius = axes, origin, half, disc, radius
        self.margin = margin

    def holds(self, stretch: Any, body: Any) -> bool:
        """Return True if a body stays inside the ball, capsule or cylinder on a curve."""
        inner = self.margin + body.disc + body.radius + stretch.rest(2, 0, body) + SLACK
        for links in stretch.links:
            link = links[body.joint]
            for away in body.corners_from(link):
                local = [a + b - c for a, b, c in zip(link.origin, away, self.origin, strict=True)]
                x, y, z = (dot(axis, local) for axis in self.axes)
                if self.radius and length(x, y, max(abs(z) - self.half, 0)) > self.radius - inner:
                    return False
                if self.disc and (length(x, y) > self.disc - inner or abs(z) > self.half - inner):
                    return False
        return True
