"""Find a polyline of the moving frame around obstacles, along which the arm keeps its configuration. If the
straight line is free, it is the result.

First, polylines of three legs are tried: out of the start, across, and into the goal. Then two trees of legs
grow towards each other, from start and goal. The polyline found is shortened, and its corners are rounded to
few decimals. Finally, all its legs are followed and checked once more, densely.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.legs import Leg, Legs, Stand
from yarclang.motion.avoid.room import Obstruction, Room
from yarclang.motion.avoid.way import Furthest, NoWay
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.paths.line import Line
from yarclang.motion.singular import NEAR
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.kinematics.singularity import smallest_singular_values
from yarclang.robot.model import Limits
from yarclang.transforms import constant


@frozen
class Effort:
    """The parameters of one search for a polyline.

    `padding` [m] is the distance that pairs of bodies keep in addition to their margins if possible. `step`
    [m] is the approximate motion of bodies from one checked place to the next. At most `legs` legs are
    followed.
    """

    padding: float
    step: float
    legs: int


EFFORTS = (Effort(0.02, 0.03, 350), Effort(0.005, 0.015, 250), Effort(0.0005, 0.01, 150))
"""Searches that are made one after the other: the first ones keep a distance from obstacles, the last one
comes close to them.
"""

QUICK = (Effort(0.01, 0.03, 100),)
"""Searches that are made if an earlier search for the same line found nothing."""

_DISTANCES = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.55, 0.7)
"""Lengths that are tried for the first and the last of three legs [m]."""

_ACROSS = 40
"""Largest number of polylines of three legs whose middle leg is tried, the shortest first."""

_BRANCH = 0.5
"""Greatest length of a leg of a tree [m]."""

_TO_GOAL = 0.15
"""Share of the samples that are taken from the stands of the opposite tree."""

_STOP = 0.25
"""Time that is added to a polyline's duration for each stop at a corner [s]."""

_ROUNDS = 3
"""Largest number of passes that shorten a polyline."""

_SAME = 1e-5
"""Largest difference of joint positions up to which two trees count as joined [rad or m]."""

_WAYS = 4
"""Largest number of inverse-kinematics solutions at the goal that become roots of the tree that grows from
the goal.
"""


@frozen(eq=False)
class Course:
    """A polyline of the moving frame from start to goal, which is free of collisions.

    `poses` (k, 4, 4) are the frame's poses at the ends of the k legs, the goal last. `paths` are the arm's
    paths along the legs. `between` is the obstruction on the straight line from start to goal; None if the
    straight line is free, or if the arm can't follow it.
    """

    poses: Array
    paths: tuple[CartesianPath, ...]
    between: Obstruction | None = None

    def shares(self, limits: Limits) -> Array:
        """Return the share of the whole duration that each leg takes, (k,), estimated from the joints'
        largest speeds.
        """
        times = np.array([_time(path, limits) for path in self.paths])
        shares: Array = times / times.sum()
        return shares


def find_course(
    room: Room | None,
    line: Line,
    straight: CartesianPath | None,
    start: Array,
    goals: Sequence[Array],
    efforts: Sequence[Effort] = EFFORTS,
    searches: int = 1,
) -> Course | NoWay:
    """Find a polyline of the moving frame around obstacles. The same arguments always give the same result.

    Args:
        room: the surroundings of the arm; None if there are no obstacles.
        line: the straight line of the moving frame.
        straight: the arm's path along the straight line; None if the arm can't follow it.
        start: (n,) joint position at the start [rad or m], within limits.
        goals: joint positions (n,) at the goal, the nearest first.
        efforts: searches to make one after the other until one finds a polyline.
        searches: number of polylines to find; the fastest is returned.
    """
    one = line.base_from_end[None]
    if room is None:
        return NoWay() if straight is None else Course(one, (straight,))
    between: Obstruction | None = None
    if straight is not None:
        # If the straight line is proved to be free, no search is needed.
        legs = _legs(room, line, start, straight.end, 0)
        if legs.is_proved(straight):
            return Course(one, (straight,))
        between = _between(room, straight)
        if between is None:
            # The line is free, though closer to bodies or to a singularity than the search would allow.
            return Course(one, (straight,))
    at_start = room.obstruction(start)
    free = [q for q in goals[:_WAYS] if room.obstruction(q) is None]
    if straight is not None and not free:
        free = [q for q in (straight.end,) if room.obstruction(q) is None]
    at_goal = room.obstruction(goals[0]) if not free and len(goals) else None
    if at_start is not None or at_goal is not None:
        return NoWay(at_start, at_goal)
    tries, nearest = 0, None
    for effort in efforts:
        courses: list[Course] = []
        for number in range(searches):
            legs = _legs(room, line, start, free[0], effort.legs)
            search = _Search(legs, effort, Stand(legs.start, start), free, number)
            for corners in search.ways():
                course = _proved(legs, start, _shortened(legs, start, corners, effort, room.robot.limits))
                if course is not None:
                    courses.append(course)
                    break
            tries += legs.followed
            if search.nearest is not None and (
                nearest is None or _left(legs, search.nearest) < _left(legs, nearest)
            ):
                nearest = search.nearest
        if courses:
            best = min(courses, key=lambda one: sum(_time(path, room.robot.limits) for path in one.paths))
            return Course(best.poses, best.paths, between)
    furthest = None
    if nearest is not None:
        furthest = Furthest(
            constant(nearest.q.copy()),
            float(np.linalg.norm(nearest.x[:3] - legs.goal[:3])),
            _ahead(legs, nearest),
        )
    return NoWay(between=between, furthest=furthest, tries=tries)


def _legs(room: Room, line: Line, start: Array, goal: Array, left: int) -> Legs:
    ends = smallest_singular_values(room.robot.chain, np.stack([start, goal]), room.flange_from_moving)
    more = room.padding(start, goal, EFFORTS[0].padding)
    return Legs(room, line, more, float(min(NEAR, 0.5 * ends.min())), left)


def _left(legs: Legs, stand: Stand) -> float:
    return legs.length(stand.x, legs.goal)


def _between(room: Room, path: CartesianPath) -> Obstruction | None:
    """Return the obstruction at the middle one of the blocked places on a path; None if the path is free."""
    q = path.joints(np.linspace(0.0, 1.0, max(_PLACES, 3 * len(path.followed.s))))
    blocked = np.flatnonzero(room.clearances(q, 0.1) <= 0.0)
    return room.obstruction(q[blocked[len(blocked) // 2]]) if len(blocked) else None


_PLACES = 257
"""Least number of places on a path that are examined for obstructions."""


def _ahead(legs: Legs, stand: Stand) -> Obstruction:
    """Return the first obstruction on the straight line from a stand to the goal; if there is none, the pair
    of bodies or the zone that is nearest to a violation.
    """
    path = legs.path(stand, legs.goal)
    if not isinstance(path, CartesianPath):
        if path <= 0.0 or not isinstance(
            part := legs.path(stand, stand.x + 0.95 * path * (legs.goal - stand.x)), CartesianPath
        ):
            return legs.room.nearest(stand.q)
        path = part
    q = path.joints(np.linspace(0.0, 1.0, _PLACES)[1:])
    spare = legs.room.clearances(q, 0.1)
    blocked = np.flatnonzero(spare <= 0.0)
    return legs.room.nearest(q[int(blocked[0]) if len(blocked) else int(np.argmin(spare))])


@dataclass(slots=True)
class _Tree:
    """A tree of legs.

    `stands` are the ends of its legs, the roots included. `parents` has, for each stand, the index of the
    stand from which its leg begins; -1 for a root.
    """

    stands: list[Stand]
    parents: list[int]

    def nearest(self, legs: Legs, x: Array) -> int:
        places = np.array([one.x for one in self.stands])
        return int(np.argmin(np.square((places - x) * legs.scale).sum(axis=1)))

    def add(self, parent: int, stand: Stand) -> int:
        self.stands.append(stand)
        self.parents.append(parent)
        return len(self.stands) - 1

    def way(self, number: int) -> list[Array]:
        """Return the places (4,) of the frame from the root of the tree to the stand with index `number`."""
        way = []
        while number >= 0:
            way.append(self.stands[number].x)
            number = self.parents[number]
        return way[::-1]


@dataclass(slots=True)
class _Search:
    legs: Legs
    effort: Effort
    start: Stand
    goals: list[Array]
    seed: int
    nearest: Stand | None = None
    """The stand that came nearest to the goal."""

    def ways(self) -> Iterator[list[Array]]:
        """Yield polylines as lists of the frame's places (4,), start and goal included."""
        if self.seed == 0:
            yield from self._in_three()
        yield from self._by_trees()

    def _leg(self, stand: Stand, x: Array, *, whole: bool = False) -> Leg | None:
        return self.legs.leg(stand, x, self.effort.padding, self.effort.step, whole=whole)

    def _came(self, stand: Stand) -> None:
        if self.nearest is None or _left(self.legs, stand) < _left(self.legs, self.nearest):
            self.nearest = stand

    def _in_three(self) -> Iterator[list[Array]]:
        """Yield polylines of three legs: out of the start, across, and into the goal; the shortest first."""
        legs = self.legs
        back = Stand(legs.goal, self.goals[0])
        farthest = _DISTANCES[-1]
        tried: list[tuple[float, Stand, Array]] = []
        for out, into in _directions(legs):
            lead, tail = (np.append(one * farthest, 0.0) for one in (out, into))
            first = self._leg(self.start, self.start.x + lead)
            last = None if first is None else self._leg(back, back.x + tail)
            if first is None or last is None:
                continue
            # Make the first and the last leg equally long: no longer than the free part of either.
            reach = farthest * min(first.reached, last.reached)
            for length in _DISTANCES:
                if length <= reach:
                    share = np.array([length / (farthest * first.reached)])
                    # A first leg of this length is a part of the leg `first`: take the joint position at its
                    # end from `first`.
                    stand = Stand(self.start.x + lead * length / farthest, first.path.joints(share)[0])
                    place = back.x + tail * length / farthest
                    tried.append((2.0 * length + legs.length(stand.x, place), stand, place))
        tried.sort(key=lambda one: one[0])
        for _, stand, place in tried[:_ACROSS]:
            across = self._leg(stand, place)
            if across is None:
                continue
            self._came(across.end)
            if across.reached == 1.0 and self._leg(across.end, legs.goal, whole=True) is not None:
                yield [self.start.x, stand.x, place, legs.goal]

    def _by_trees(self) -> Iterator[list[Array]]:
        """Yield polylines found by two trees of legs, which grow towards each other from start and goal."""
        legs = self.legs
        random = np.random.default_rng((self.seed, len(self.goals)))
        trees = (
            _Tree([self.start], [-1]),
            _Tree([Stand(legs.goal, q) for q in self.goals], [-1] * len(self.goals)),
        )
        low, high = _box(legs)
        # A redundant arm comes to one place of the frame with as many joint positions as there are ways to
        # it. So its polylines are tried where the trees meet: they are followed from the start afterwards.
        redundant = len(self.start.q) > 6
        turn = 0
        while legs.left > 0:
            # RRT-Connect (Kuffner and LaValle 2000): grow one tree towards a sample, then the other one
            # towards its new stand, as far as it comes nearer; swap roles.
            here, there = trees[turn], trees[1 - turn]
            turn = 1 - turn
            if random.random() < _TO_GOAL:
                x = there.stands[int(random.integers(len(there.stands)))].x
            else:
                # Samples scatter around the straight line from start to goal, more or less widely.
                wide = random.random()
                middle = legs.start + random.random() * (legs.goal - legs.start)
                x = middle + wide * (low + random.random(4) * (high - low) - middle)
            grown = self._grown(here, here.nearest(legs, x), x)
            if grown is None:
                continue
            new = here.stands[grown]
            nearest = there.nearest(legs, new.x)
            while True:
                met = self._grown(there, nearest, new.x)
                if met is None:
                    break
                gone = there.stands[met]
                if (gone.x == new.x).all():
                    if redundant or np.abs(gone.q - new.q).max() < _SAME:
                        one, two = here.way(grown), there.way(met)[:-1][::-1]
                        yield [*one, *two] if here is trees[0] else [*one, *two][::-1]
                    break
                if legs.length(gone.x, new.x) >= legs.length(there.stands[nearest].x, new.x):
                    break
                nearest = met

    def _grown(self, tree: _Tree, parent: int, x: Array) -> int | None:
        """Grow a tree from one of its stands towards a place, by at most the length `_BRANCH`.

        Return the index of the new stand; None if no leg is possible.
        """
        stand = tree.stands[parent]
        length = self.legs.length(stand.x, x)
        if length > _BRANCH:
            x = stand.x + (x - stand.x) * (_BRANCH / length)
        leg = self._leg(stand, x) if self.legs.left > 0 and length > 0.0 else None
        if leg is None:
            return None
        if tree.parents[0] == -1 and tree.stands[0] is self.start:
            self._came(leg.end)
        return tree.add(parent, leg.end)


def _box(legs: Legs) -> tuple[Array, Array]:
    """Return the lowest and the highest corner (4,) of the box from which places of the frame are sampled."""
    size = arm_length(legs.room.robot.chain, legs.room.flange_from_moving)
    low = np.minimum(legs.start, legs.goal) - 0.5 * size
    high = np.maximum(legs.start, legs.goal) + 0.5 * size
    low[3], high[3] = 0.0, 1.0
    return low, high


def _directions(legs: Legs) -> Iterator[tuple[Array, Array]]:
    """Yield pairs of unit vectors (3,): the direction out of the start, and the direction from the goal
    outwards.

    First come the axes of the frame at start and goal, beginning with z; then the axes of {B} and the
    diagonals between them. No pair comes twice: an upright frame has the same axes as {B}.
    """
    ends = legs.line.base_from_start, legs.line.base_from_end
    own = [(sign * ends[0][:3, axis], sign * ends[1][:3, axis]) for axis in (2, 0, 1) for sign in (-1.0, 1.0)]
    yield from own
    for way in _AXES:
        if not any(np.allclose(way, pair, rtol=0.0, atol=1e-6) for pair in own):
            yield way, way


_AXES = [
    np.array(one) / np.linalg.norm(one)
    for one in (
        (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1),
        (1, 0, 1), (-1, 0, 1), (0, 1, 1), (0, -1, 1),
        (1, 1, 0), (1, -1, 0), (-1, 1, 0), (-1, -1, 0),
    )
]  # fmt: skip


def _shortened(legs: Legs, start: Array, corners: list[Array], effort: Effort, limits: Limits) -> list[Array]:
    """Return a polyline that takes less time: with fewer corners, and with the other corners moved
    inwards.
    """

    def follow(way: list[Array]) -> float | None:
        """Return the estimated duration of a polyline [s]; None if it isn't free of collisions."""
        stand, time = Stand(way[0], start), 0.0
        for x in way[1:]:
            leg = legs.leg(stand, x, effort.padding, effort.step, whole=True)
            if leg is None:
                return None
            time += _time(leg.path, limits)
            stand = leg.end
        return time

    best = follow(corners)
    if best is None:
        return corners
    for _ in range(_ROUNDS):
        before = best
        number = 1
        while number < len(corners) - 1:
            # Leave out a corner if the polyline is faster without it.
            fewer = [*corners[:number], *corners[number + 1 :]]
            time = follow(fewer)
            if time is not None and time < best:
                best, corners = time, fewer
            else:
                number += 1
        for number in range(1, len(corners) - 1):
            # Move a corner towards the midpoint of its neighbours: by the largest of these shares of the
            # distance that makes the polyline faster.
            for share in (0.5, 0.25, 0.1):
                middle = (corners[number - 1] + corners[number + 1]) / 2.0
                moved = list(corners)
                moved[number] = corners[number] + share * (middle - corners[number])
                time = follow(moved)
                if time is not None and time < best:
                    best, corners = time, moved
                    break
        if best > 0.98 * before:
            break
    return corners


def _proved(legs: Legs, start: Array, corners: list[Array]) -> Course | None:
    """Return the polyline with rounded corners as a `Course`; None if it isn't proved to be free of
    collisions.
    """
    poses, paths = list[Array](), list[CartesianPath]()
    pose, q = legs.line.base_from_start, start
    for x in corners[1:]:
        end = legs.rounded(x)
        path = legs.between(pose, end, q)
        if not isinstance(path, CartesianPath) or not legs.is_proved(path):
            return None
        poses.append(end)
        paths.append(path)
        pose, q = end, path.end
    return Course(constant(np.array(poses)), tuple(paths))


def _time(path: CartesianPath, limits: Limits) -> float:
    """Estimate the duration of a leg, with the stop at its end [s]."""
    # Estimate: each joint moves at its largest speed along its whole travel, back and forth. The joint that
    # takes longest decides.
    moves = np.abs(np.diff(path.followed.q, axis=0)).sum(axis=0)
    return float((moves / limits.velocity).max()) + _STOP
