"""Describe the surroundings in which a path is searched for: joint limits, bodies, zones, and the lever arms
by which joints move the bodies.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.keeping import Pointed, Tilt
from yarclang.cell.model import Cell, JointWindow
from yarclang.collision.course import Course
from yarclang.collision.free import free_space, gaps, plain_free_space
from yarclang.collision.placing import box_gaps, distances, place, relative, sphere_gaps
from yarclang.collision.proof import clearances
from yarclang.collision.scene import Scene, scene_of
from yarclang.collision.travel import arm_lengths
from yarclang.collision.zones.proof import kept
from yarclang.collision.zones.sights import aimed_at
from yarclang.collision.zones.watched import Moving
from yarclang.collision.zones.workspace import Watch, slack_at, slack_of, watches_of
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Robot

_POSITIONS = 64
"""Number of joint positions, spread over the joint limits, from which the joints' lever arms are
estimated.
"""

_LEAST_REACH = 0.1
"""Least lever arm of a joint [m/rad]; a smaller estimate is raised to it."""


_AT_ONCE = 16
"""Number of joint positions that are checked together."""

TOUCH = 1e-6
"""Clearance above which pairs of bodies needn't be measured exactly, if only violations matter [m]."""


@frozen(eq=False)
class Obstruction:
    """The worst violation at a joint position: two bodies too close, or a watched item that breaks a zone.

    For two bodies, `distance` is the distance between them [m]. For a zone, it is the amount by which the
    zone is violated: in m for a body, rad for a tilt, and rad or m for joints and for a cone. For a cone,
    `aim` has the point's angle from the cone's axis [rad] and its distance from the apex [m].
    """

    names: tuple[str, str]
    distance: float
    is_zone: bool = False
    is_tilt: bool = False
    aim: tuple[float, float] | None = None


@frozen(eq=False)
class Room:
    """The surroundings of a robot while a frame is moved: the bodies that may collide, and all zones except
    those that only limit speed.

    `flange_from_moving` (4, 4) is the pose of the moved frame on the flange [m].
    """

    robot: Robot
    scene: Scene
    watches: tuple[Watch, ...]
    flange_from_moving: Array

    @property
    def rules(self) -> tuple[Pointed, ...]:
        """The constraints on the path: angles that axes keep, and cones in which points stay."""
        regions = (watch.zone.region for watch in self.watches)
        return tuple(one for one in regions if isinstance(one, Pointed))

    def obstruction(self, q: Array) -> Obstruction | None:
        """Return the worst violation at a joint position (n,) [rad or m]; None if the position is free."""
        left = gaps(self.scene, q)
        if len(left) and (worst := int(np.argmin(left))) >= 0 and left[worst] <= 0.0:
            return Obstruction(
                self.scene.names(worst), float(left[worst]) + float(self.scene.pairs.margin[worst])
            )
        slack = [(float(slack_at(self.scene, one, q[None])[0]), one) for one in self.watches]
        broken = [(by, one) for by, one in slack if by < slack_of(one)]
        if not broken:
            return None
        by, watch = min(broken, key=lambda one: one[0])
        return self._broken(watch, -by, q)

    def nearest(self, q: Array) -> Obstruction:
        """Return the worst violation at a joint position (n,) [rad or m]. If there is none, return the pair
        of bodies with the least clearance; without bodies, the zone that is nearest to being violated.
        """
        found = self.obstruction(q)
        if found is not None:
            return found
        left = gaps(self.scene, q)
        if len(left):
            worst = int(np.argmin(left))
            return Obstruction(
                self.scene.names(worst), float(left[worst]) + float(self.scene.pairs.margin[worst])
            )
        watch = min(self.watches, key=lambda one: float(slack_at(self.scene, one, q[None])[0]))
        return self._broken(watch, -float(slack_at(self.scene, watch, q[None])[0]), q)

    def _broken(self, watch: Watch, by: float, q: Array) -> Obstruction:
        zone = watch.zone
        if isinstance(zone.region, Pointed) and zone.keep is not None:
            names = f"{{{zone.keep.frame}}}", zone.name
            if isinstance(zone.region, Tilt):
                return Obstruction(names, by, is_zone=True, is_tilt=True)
            aim = aimed_at(zone.region, self.scene, q[None])
            seen = float(aim.angle[0]), float(aim.distance[0])
            return Obstruction(names, by, is_zone=True, aim=seen)
        watched = watch.item.name if watch.item is not None else JOINTS
        return Obstruction((watched, zone.name), by, is_zone=True)

    def obstructions(self, q: Iterable[Array]) -> Iterator[Obstruction | None]:
        """Yield the result of `obstruction` for each of several joint positions (n,) [rad or m].

        Each result is computed only when it is requested. A collision of bodies found at one position is
        reused for all positions that differ from it only by full turns of joints.
        """
        known = dict[bytes, Obstruction]()
        for one in q:
            key = self._apart_from_turns(one)
            found = known.get(key) or self.obstruction(one)
            if found is not None and not found.is_zone:
                known[key] = found
            yield found

    def free_among(self, q: Sequence[Array]) -> Iterator[Array]:
        """Yield those of several joint positions (n,) that are free of obstructions, in the given order.

        `_AT_ONCE` positions are checked together; further ones are checked only when the caller asks for
        more. Of positions that differ only by full turns, only one is checked, unless a zone limits joint
        positions.
        """
        is_once = not any(_of_joints(watch) for watch in self.watches)
        known = dict[bytes, bool]()
        for start in range(0, len(q), _AT_ONCE):
            part = q[start : start + _AT_ONCE]
            keys = [self._apart_from_turns(one) if is_once else one.tobytes() for one in part]
            new = {key: one for key, one in zip(keys, part, strict=True) if key not in known}
            if new:
                is_free = self.clearances(np.array(list(new.values())), TOUCH) > 0.0
                known.update(zip(new, is_free.tolist(), strict=True))
            # The check of several positions together only excludes positions: `obstruction` decides about
            # those that passed.
            yield from (
                one
                for key, one in zip(keys, part, strict=True)
                if known[key] and self.obstruction(one) is None
            )

    def _apart_from_turns(self, q: Array) -> bytes:
        """Return a key that is equal for joint positions (n,) that differ by full turns."""
        turning = ~self.robot.chain.is_prismatic & (links_of(self.robot.chain).slide == 0.0)
        # Reduce revolute joints to the range from -180 to 180 deg. Adding 0.0 turns -0.0 into 0.0, since the
        # two differ as bytes.
        turned = np.where(turning, q - 2.0 * np.pi * np.round(q / (2.0 * np.pi)), q)
        return bytes((np.round(turned, 9) + 0.0).tobytes())

    def clearances(self, q: Array, near: float) -> Array:
        """Return the least reserve at each of N joint positions `q` (N, n), as (N,) [m; rad or m for a joint
        window].

        The reserve of a pair of bodies is its distance minus its margin. The reserve of a zone is the
        distance from violating it. A negative reserve is a violation. Values above `near` are given as
        `near`.
        """
        left = self.spare(q, near)
        for watch in self.watches:
            left = np.minimum(left, slack_at(self.scene, watch, q) - slack_of(watch))
        return left

    def spare(self, q: Array, near: float) -> Array:
        """Return the least clearance of bodies at each of N joint positions `q` (N, n), as (N,) [m].

        The clearance of a pair of bodies is its distance minus its margin. Values above `near` are given as
        `near`.
        """
        scene, left = self.scene, np.full(len(q), near)
        count = len(scene.pairs.first)
        if count:
            placed = place(scene, q)
            at, pair = np.repeat(np.arange(len(q)), count), np.tile(np.arange(count), len(q))
            # Compare bounding spheres, then bounding boxes, then the bodies themselves: each more exact
            # comparison gets only the pairs that may be close.
            close = np.flatnonzero(sphere_gaps(placed, at, pair) - scene.pairs.margin[pair] < near)
            at, pair = at[close], pair[close]
            seen = relative(placed, at, pair)
            close = np.flatnonzero(box_gaps(scene, pair, seen) - scene.pairs.margin[pair] < near)
            at, pair = at[close], pair[close]
            apart = distances(scene, pair, seen.take(close)) - scene.pairs.margin[pair]
            np.minimum.at(left, at, apart)
        return left

    def is_free(self, q: Array) -> bool:
        """Return True if a joint position (n,) has no collision and violates no zone. Bodies inside a hollow
        mesh aren't detected.
        """
        return plain_free_space(self.scene).has(q) and self._keeps(q)

    def doubts(self, course: Course, more: Array | float = 0.0) -> Array:
        """Return times (T,) [s] at which a motion isn't proved to be free of collisions; empty if the proof
        succeeds.

        Args:
            course: the motion over time.
            more: (K,) the distance that pairs of bodies keep in addition to their margins [m].
        """
        scene = replace(self.scene, pairs=replace(self.scene.pairs, margin=self.scene.pairs.margin + more))
        span = np.array([[0, len(course.x)]])
        times = []
        if len(scene.pairs.first):
            times += [one.time for one in clearances(scene, course, span).meetings]
        if self.watches:
            times += [one.time for one in kept(scene, course, span, self.watches).breaches]
        return np.array(times)

    def padding(self, start: Array, goal: Array, most: float) -> Array:
        """Return the distance that each pair of bodies should keep in addition to its margin, (K,) [m].

        This distance is `most`, but at most half of the pair's clearance at the start and at the goal.
        """
        least = np.minimum(gaps(self.scene, start), gaps(self.scene, goal))
        return np.clip(least / 2.0, 0.0, most)

    def check(self, more: Array) -> Callable[[Array], bool]:
        """Return a function that returns True for joint positions (n,) without collision.

        Pairs of bodies keep `more` (K,) in addition to their margins [m].
        """
        space = free_space(self.scene, more)
        return lambda q: space.has(q) and self._keeps(q)

    def _keeps(self, q: Array) -> bool:
        return all(
            float(slack_at(self.scene, one, q[None])[0]) >= slack_of(one) + _INSIDE * (not _of_joints(one))
            for one in self.watches
        )


JOINTS = "the joints"
"""Name that findings give to the watched item of a joint window."""

_INSIDE = 1e-5
"""Distance that a path keeps from the borders of zones [m], since a path on the border couldn't be proved."""


def _of_joints(watch: Watch) -> bool:
    return isinstance(watch.zone.region, JointWindow)


def room_of(robot: Robot, cell: Cell | None, moving: Moving) -> Room | None:
    """Return the surroundings of a robot while a frame is moved.

    The result is None if there are no obstacles, or if a mesh can't be read, which the certificate reports.
    """
    zones = cell is not None and any(zone.rule != "slow" for zone in cell.zones)
    if not (robot.shapes or zones or (cell is not None and cell.obstacles)):
        return None
    made = scene_of(robot, cell)
    if made.value is None:
        return None
    watches = watches_of(robot, cell, moving) if cell is not None else ()
    kept_to = tuple(one for one in watches if one.zone.rule != "slow")
    return Room(robot, made.value, kept_to, moving.flange_from_moving)


@lru_cache(maxsize=32)
def reaches(scene: Scene, robot: Robot) -> Array:
    """Return for each joint the approximate greatest lever arm by which it moves a body, (n,) [m/rad, or 1
    for a prismatic joint].

    Multiplied by their lever arms, motions of different joints can be compared.
    """
    q = within(robot.chain, robot.limits, _POSITIONS)
    arms: Array = arm_lengths(place(scene, q)).max(axis=(1, 2), initial=_LEAST_REACH)
    return arms
