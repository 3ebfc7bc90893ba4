"""The bodies and zones of a proof: the pairs that must stay apart, their margins, and the commands during
which they must.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from typing import Any

from yarclang.verify.arm import Arm, Frame, Vector, cross, dot, placed
from yarclang.verify.exact import ONE, SLACK, above, fixed, length, need, times, unknown, whole

BORDER = above(Fraction(1, 100_000))
"""Distance beyond a zone's border that still counts as on the border: 0.01 mm."""
_OF_BODY = "name joint pose core corners disc radius margin during point"
_OF_ZONE = "name rule margin region watched speed"
_OF_REGION = "pose core corners disc radius"
_FASTER = 1 + Fraction(1, 1000)
"""Allowed excess of the speed in a slow zone: 0.1 %."""


class Body:
    """A body as the proof describes it. A point has no size, and only zones watch it."""

    def __init__(self, told: dict[str, Any], arm: Arm, travel: Sequence[int]) -> None:
        self.name, self.joint = str(told["name"]), int(told["joint"])
        self.during, self.is_point = told.get("during"), told.get("point", False)
        self.speed, strange = 0, unknown(told, _OF_BODY)
        need(not strange, f"{self.name} has {strange}, which this checker doesn't know")
        need(self.joint == told["joint"] and 0 <= self.joint <= len(arm.turns), "a body on no joint")
        self.axes, self.origin = placed(told["pose"])
        self.core, self.corners = [fixed(one) for one in told["core"]], told.get("corners", [])
        self.disc, self.radius, self.margin = (fixed(told[name]) for name in ("disc", "radius", "margin"))
        need(min(*self.core, self.disc, self.radius, self.margin) >= 0, f"{self.name}: a size below 0")
        need(len(self.core) == 3, f"{self.name}: a core without three edges")
        self.corners = [[fixed(one) for one in corner] for corner in self.corners]
        need(all(len(corner) == 3 for corner in self.corners), f"{self.name}: a corner isn't 3 numbers")
        far = max([length(*corner) for corner in self.corners], default=0)
        far += length(length(*self.core[:2]) + self.disc, self.core[2]) + self.radius
        need(far < 64 * ONE, f"{self.name} is larger than 64 m")
        need(not self.is_point or far <= 8, f"{self.name} is a point that has a size")
        self.reach = arm.reaches(self.joint, self.origin, travel, far)

    def is_there(self, step: int) -> bool:
        """Return True if the body is present during a command."""
        return self.during is None or any(first <= step <= last for first, last in self.during)

    def fastest(self, link: Frame) -> int:
        """Return an upper bound of the speeds of the body's points, for the moving frame of the body's
        joint.
        """
        most = 0
        signs = product(*((-one, one) if one else (0,) for one in self.core))
        for point in product(signs, self.corners or [[0, 0, 0]]):
            own = [a + b for a, b in zip(*point, strict=True)]
            seen = [
                dot(row, own) + o for row, o in zip(zip(*self.axes, strict=True), self.origin, strict=True)
            ]
            away = [dot(row, seen) for row in zip(*link.axes, strict=True)]
            rate = [a + b for a, b in zip(link.rate, cross(link.spin, away), strict=True)]
            most = max(most, length(*rate))
        return most + times(self.disc + self.radius, length(*link.spin)) + SLACK

    def extent(self, link: Frame, normal: Vector) -> int:
        """Return an upper bound of n.p over the points p of the body, for a normal n in {B}."""
        seen = [dot(axis, normal) for axis in link.axes]
        own = [dot(axis, seen) for axis in self.axes]
        far = dot(link.origin, normal) + dot(self.origin, seen) + dot(self.core, list(map(abs, own)))
        far += max((dot(corner, own) for corner in self.corners), default=0)
        far += times(self.disc, length(own[0], own[1])) if self.disc else 0
        return far + self.radius


class Border:
    """The half-space beyond a fixed plane, as a body: the points p with n.p >= `offset`."""

    def __init__(self, name: str, margin: int, normal: Vector, offset: int) -> None:
        self.name, self.joint, self.margin, self.normal, self.offset = name, 0, margin, normal, offset
        self.is_point, self.speed = False, 0

    def is_there(self, _: int) -> bool:
        """Return True: a zone applies to all commands."""
        return True


@dataclass
class Pair:
    """Two bodies that must stay apart. Fewer joints move the first.

    `needs` are the intervals of segments (begin, end, margin) on which they must stay apart, in order,
    without those that planes have already covered.
    """

    one: int
    other: int
    needs: list[tuple[int, int, int]]

    def goes_on(self, begin: int, end: int) -> int:
        """Remove the interval that a plane covers from `needs`; return the largest margin on it."""
        over = [one for one in self.needs if begin < one[1] and one[0] < end]
        need(all(begin <= first for first, _, _ in over), "a plane leaves what comes before it uncovered")
        ends = [(end, last, margin) for _, last, margin in over if end < last]
        self.needs = ends + [one for one in self.needs if one not in over]
        return max((margin for _, _, margin in over), default=-64 * ONE)


class Room:
    """All bodies and zones of a proof.

    Attributes:
        bodies: all bodies, moved by joints or fixed.
        all: the bodies, followed by the regions that bodies must stay out of because of zones.
        watched: pairs of a region and a body that its zone watches.
        left: the zones that are not checked.
    """

    def __init__(self, told: dict[str, Any], arm: Arm, travel: Sequence[int]) -> None:
        self.bodies = [Body(one, arm, travel) for one in told["bodies"]]
        self.all: list[Body | Border] = [*self.bodies]
        self.count = len(self.bodies)
        self.watched, self.left = list[tuple[int, int]](), list[str]()
        self.excused: dict[tuple[int, int], list[Any]] = {}
        for one, other, *rest in told["exceptions"]:
            need(0 <= one < other < self.count, "an exception of no pair")
            self.excused.setdefault((whole(one), whole(other)), []).append(rest)
        for zone in told["zones"]:
            regions = _regions(zone, arm)
            if not regions:
                self.left.append(f"the zone {zone['name']}")
            for region in regions:
                region.speed = above(zone["speed"] * _FASTER) if zone["rule"] == "slow" else 0
                for body in zone["watched"]:
                    need(0 <= body < self.count, f"the zone {zone['name']} watches no body")
                    self.watched.append((len(self.all), whole(body)))
                self.all.append(region)

    def margin(self, one: int, other: int, step: int) -> int | None:
        """Return the margin of two bodies during a command; None if one is absent, or if they are allowed
        to touch.
        """
        first, second = self.all[one], self.bodies[other]
        if not (first.is_there(step) and second.is_there(step)):
            return None
        if one >= self.count:
            return first.margin
        kept = [least for least, begin, end in self.excused.get((one, other), []) if begin <= step <= end]
        need(len(kept) < 2, "two exceptions for one command")
        if kept:
            return None if kept[0] is None else fixed(kept[0])
        return max(first.margin, second.margin)

    def pairs(self, steps: Sequence[tuple[int, int, int]]) -> list[Pair]:
        """Return the pairs of bodies that move relative to each other, then the pairs of a zone's region and
        a body that the zone watches.

        Args:
            steps: commands, with the begin and the end of their segments.
        """
        found, joint = [], [body.joint for body in self.all]
        apart = [pair for pair in combinations(range(self.count), 2) if joint[pair[0]] != joint[pair[1]]]
        solid = [pair for pair in apart if not any(self.bodies[one].is_point for one in pair)]
        for one, other in (*solid, *self.watched):
            needs = list[tuple[int, int, int]]()
            for step, begin, end in steps:
                margin = self.margin(one, other, step)
                if margin is not None and needs and needs[-1][1:] == (begin, margin):
                    needs[-1] = (needs[-1][0], end, margin)
                elif margin is not None:
                    needs.append((begin, end, margin))
            swaps = joint[one] > joint[other]
            found.append(Pair(other, one, needs) if swaps else Pair(one, other, needs))
        return found


def _regions(zone: dict[str, Any], arm: Arm) -> list[Body | Border]:
    """Return the regions that bodies must stay out of because of a zone; empty for a zone that is not
    checked.

    Bodies stay out of a slow zone, or pass it slowly. A region to stay in is a box, or the half-space on the
    side of its frame's z axis; bodies must stay out of the regions beyond its faces.
    """
    name, rule, region = zone["name"], zone["rule"], zone["region"]
    if region is None or rule not in ("allowed", "forbidden", "slow"):
        return []
    if unknown(zone, _OF_ZONE) or unknown(region, _OF_REGION):
        return []
    need(zone["margin"] >= 0 and zone.get("speed", 1) > 0, f"{name}: a margin below 0, or no speed")
    margin = fixed(zone["margin"]) - (0 if rule == "slow" else BORDER)
    if "core" not in region:
        columns, origin = placed(region["pose"])
        normal = [-one for one in columns[2]] if rule == "allowed" else columns[2]
        return [Border(name, margin, normal, dot(normal, origin))]
    body = Body(region | {"name": name, "joint": 0, "margin": 0}, arm, [])
    if rule != "allowed":
        body.margin = margin
        return [body]
    if body.disc or body.radius or body.corners:
        return []
    faces = list[Body | Border]()
    for sign, (column, half) in product((1, -1), zip(body.axes, body.core, strict=True)):
        normal = [sign * one for one in column]
        faces.append(Border(name, margin, normal, dot(normal, body.origin) + half))
    return faces
