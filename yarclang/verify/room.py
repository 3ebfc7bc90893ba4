"""The bodies and zones of a proof: the pairs that must stay apart, their margins, and the commands to which
the margins apply.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product
from typing import Any

from yarclang.verify.arm import Arm, Frame, Vector, cross, dot, placed
from yarclang.verify.conditions import BORDER, EVERYWHERE, Border, Condition, Inside, Slow, Window, rules_of
from yarclang.verify.exact import ONE, SLACK, above, fixed, length, need, times, unknown, whole

_OF_BODY = "name joint pose core corners disc radius margin during point"
_OF_ZONE = "name rule margin region watched"
_OF_REGION = "pose core corners disc radius"
_FASTER = 1 + Fraction(1, 1000)
"""Allowed excess of the speed in a slow zone: 0.1 %."""
_MOST_PAIRS = 300_000
"""Largest number of pairs of bodies, which are those of 775 bodies."""
_ROBOT = {"name": "the robot", "joint": Fraction(0), "core": [Fraction(0)] * 3, "point": True}
_ROBOT |= {"pose": [Fraction(k % 5 == 0) for k in range(12)]} | dict.fromkeys(
    ("disc", "radius", "margin"), Fraction(0)
)
"""Stand-in for a body in conditions on the joints alone."""


class Body:
    """A solid body as the proof describes it, or a point without a size, which only zones watch."""

    def __init__(self, told: dict[str, Any], arm: Arm, travel: Sequence[int]) -> None:
        self.name, self.joint = str(told["name"]), int(told["joint"])
        self.during, self.is_point = told.get("during"), told.get("point", False)
        strange = unknown(told, _OF_BODY)
        need(not strange, f"{self.name} has {strange}, which this checker doesn't know")
        need(self.joint == told["joint"] and 0 <= self.joint <= len(arm.turns), "a body on no joint")
        farthest = 1024 if self.joint == 0 else 64  # no joint turns what is fixed, so its place is exact
        self.axes, self.origin = placed(told["pose"], farthest)
        self.core, self.corners = [fixed(one) for one in told["core"]], told.get("corners", [])
        self.disc, self.radius, self.margin = (fixed(told[name]) for name in ("disc", "radius", "margin"))
        need(self.is_point in (True, False), f"{self.name}: point is neither true nor false")
        need(min(*self.core, self.disc, self.radius, self.margin) >= 0, f"{self.name}: a size below 0")
        need(len(self.core) == 3, f"{self.name}: a core without three edges")
        self.corners = [[fixed(one) for one in corner] for corner in self.corners]
        need(all(len(corner) == 3 for corner in self.corners), f"{self.name}: a corner isn't 3 numbers")
        far = max([length(*corner) for corner in self.corners], default=0)
        far += length(length(*self.core[:2]) + self.disc, self.core[2]) + self.radius
        need(far < farthest * ONE, f"{self.name} is larger than {farthest} m")
        need(not self.is_point or far <= 8, f"{self.name} is a point that has a size")
        self.reach = arm.reaches(self.joint, self.origin, travel, far)

    def is_there(self, step: int) -> bool:
        """Return True if the body is present during a command."""
        return self.during is None or any(first <= step <= last for first, last in self.during)

    def fastest(self, link: Frame) -> int:
        """Return an upper bound of the speeds of the body's points; `link` is the frame of its joint."""
        most = 0
        for away in self.corners_from(link):
            rate = [a + b for a, b in zip(link.rate, cross(link.spin, away), strict=True)]
            most = max(most, length(*rate))
        return most + times(self.disc + self.radius, length(*link.spin)) + SLACK

    def corners_from(self, link: Frame) -> Iterator[Vector]:
        """Yield the body's corners without its disc and ball, as vectors from a link's origin, in {B}."""
        signs = product(*((-one, one) if one else (0,) for one in self.core))
        for corner in product(signs, self.corners or [[0, 0, 0]]):
            own = [a + b for a, b in zip(*corner, strict=True)]
            seen = [
                dot(row, own) + o for row, o in zip(zip(*self.axes, strict=True), self.origin, strict=True)
            ]
            yield [dot(row, seen) for row in zip(*link.axes, strict=True)]

    def extent(self, link: Frame, normal: Vector) -> int:
        """Return an upper bound of n.p over the points p of the body, for a normal n in {B}."""
        seen = [dot(axis, normal) for axis in link.axes]
        own = [dot(axis, seen) for axis in self.axes]
        far = dot(link.origin, normal) + dot(self.origin, seen) + dot(self.core, list(map(abs, own)))
        far += max((dot(corner, own) for corner in self.corners), default=0)
        far += times(self.disc, length(own[0], own[1])) if self.disc else 0
        return far + self.radius


@dataclass
class Pair:
    """Two bodies that must stay apart; or a region, and a body that must stay out of it unless one of the
    `conditions` holds; or conditions on the joints alone. Of two bodies, fewer joints move the first.

    `needs` are the intervals of segments (begin, end, margin) that are still to be checked, in order.
    """

    one: int
    other: int
    needs: list[tuple[int, int, int]]
    conditions: Sequence[Condition] = ()

    def goes_on(self, begin: int, end: int) -> int:
        """Remove the interval that a plane covers from `needs`; return the largest margin needed on it."""
        over = [one for one in self.needs if begin < one[1] and one[0] < end]
        need(bool(over), "a plane for bodies that need none")
        need(all(begin <= first for first, _, _ in over), "a plane leaves what comes before it uncovered")
        ends = [(end, last, margin) for _, last, margin in over if end < last]
        self.needs = ends + [one for one in self.needs if one not in over]
        return max(margin for _, _, margin in over)


class Room:
    """All bodies, zones and path constraints of a proof.

    Attributes:
        bodies: all bodies, moved by joints or fixed.
        all: the bodies, followed by the regions of zones and by the path constraints.
        watched: the indices of a region in `all` and of a body that its zone watches, with the conditions
            under which the body may be in the region.
        left: the zones that are not checked.
    """

    def __init__(
        self, told: dict[str, Any], arm: Arm, travel: Sequence[int], map_lines: Sequence[str]
    ) -> None:
        self.bodies = [Body(one, arm, travel) for one in told["bodies"]]
        self.all: list[Body | Border] = [*self.bodies]
        self.count = len(self.bodies)
        self.bodies.append(Body(_ROBOT, arm, []))
        self.watched, self.left = list[tuple[int, int, Sequence[Condition]]](), list[str]()
        self.excused: dict[tuple[int, int], list[Any]] = {}
        for one, other, *rest in told["exceptions"]:
            need(0 <= one < other < self.count, "an exception of no pair")
            self.excused.setdefault((whole(one), whole(other)), []).append(rest)
        for zone in told["zones"]:
            regions, conditions = _zone(zone, arm)
            if not regions:
                self.left.append(f"the zone {zone['name']}")
            watched = [whole(body) for body in zone["watched"]]
            need(len({*watched}) == len(watched), f"the zone {zone['name']} watches a body twice")
            need(all(0 <= body < self.count for body in watched), f"the zone {zone['name']} watches no body")
            if zone["rule"] in ("allowed", "forbidden") and "window" in zone:
                watched = [self.count]
            for region in regions:
                self.watched += [(len(self.all), body, conditions) for body in watched]
                self.all.append(region)
        for rule in rules_of(map_lines, arm, travel):
            self.watched.append((len(self.all), self.count, [rule]))
            self.all.append(rule)

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
        """Return the pairs of bodies that move relative to each other, then the regions of zones with each
        body that is watched, then the path constraints.

        Args:
            steps: commands, with the start and the end of their segments.
        """
        found, joint = [], [body.joint for body in self.all]
        every = self.count * (self.count - 1) // 2
        need(
            every <= _MOST_PAIRS, f"the proof has {self.count} bodies: this checker takes {_MOST_PAIRS} pairs"
        )
        apart = [pair for pair in combinations(range(self.count), 2) if joint[pair[0]] != joint[pair[1]]]
        solid = [(*pair, ()) for pair in apart if not any(self.bodies[one].is_point for one in pair)]
        for one, other, conditions in (*solid, *self.watched):
            needs = list[tuple[int, int, int]]()
            for step, begin, end in steps:
                margin = self.margin(one, other, step)
                if margin is not None and needs and needs[-1][1:] == (begin, margin):
                    needs[-1] = (needs[-1][0], end, margin)
                elif margin is not None:
                    needs.append((begin, end, margin))
            swaps = one < self.count and joint[one] > joint[other]
            found.append(Pair(*((other, one) if swaps else (one, other)), needs, conditions))
        return found


def _zone(zone: dict[str, Any], arm: Arm) -> tuple[list[Body | Border], Sequence[Condition]]:
    """Return the regions of a zone that bodies must stay out of unless one of the returned conditions holds;
    no region for a zone that is not checked.

    To stay in a box, or in the half-space on the side of its frame's z axis, bodies must stay out of the
    regions beyond its faces. To stay in a round region, or in ranges of joints, a condition must hold
    everywhere.
    """
    name, rule, region = zone["name"], zone["rule"], zone["region"]
    own = {"allowed": set[str](), "forbidden": set[str](), "slow": {"speed"}, "posture": {"posture"}}
    names = {*_OF_ZONE.split(), *own.get(rule, set()), *(["window"] if region is None else [])}
    if rule not in own or set(zone) != names or unknown(region or {}, _OF_REGION):
        return [], []
    need(zone["margin"] >= 0 and zone.get("speed", 1) > 0, f"{name}: a margin below 0, or no speed")
    margin = fixed(zone["margin"]) - (0 if rule == "slow" else BORDER)
    conditions = list[Condition]()
    if rule == "slow":
        conditions.append(Slow(above(zone["speed"] * _FASTER)))
    if rule == "posture":
        conditions.append(Window(zone["posture"], arm.turns))
    if region is None:
        conditions.append(Window(zone["window"], arm.turns, rule != "allowed"))
        return [Border(name, 0, *EVERYWHERE)], conditions
    if "core" not in region:
        need(set(region) == {"pose"}, f"{name}: a half-space that has a size")
        columns, origin = placed(region["pose"], 1024)
        normal = [-one for one in columns[2]] if rule == "allowed" else columns[2]
        return [Border(name, margin, normal, dot(normal, origin))], conditions
    body = Body(region | {"name": name, "joint": 0, "margin": 0}, arm, [])
    if rule != "allowed":
        body.margin = margin
        return [body], conditions
    if body.disc or body.radius:
        is_round = not body.corners and not any(body.core[:2]) and not (body.disc and body.radius)
        inside = Inside(body.axes, body.origin, body.core[2], body.disc, body.radius, margin)
        return [Border(name, margin, *EVERYWHERE)] * is_round, [inside]
    faces = list[Body | Border]()
    for sign, (column, half) in product((1, -1), zip(body.axes, body.core, strict=True)):
        normal = [sign * one for one in column]
        faces.append(Border(name, margin, normal, dot(normal, body.origin) + half))
    return faces * (not body.corners), conditions
