"""Find a polyline in joint space along which an axis keeps its angle, or a point stays in a cone. Two trees
grow towards each other, and each step of a branch is projected onto these constraints.

The joint positions at which an axis is upright, for example, are a thin layer among all joint positions:
samples hardly ever hit it, and straight lines leave it. Therefore samples, and each step of a branch, are
projected onto it (Berenson, Srinivasa and Kuffner, "Manipulation planning on constraint manifolds", 2009).
Random numbers come from a seed, and a search ends after a given number of samples, as in
`yarclang.motion.avoid.search`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from yarclang.cell.keeping import Pointed, Sight
from yarclang.collision.scene import Scene
from yarclang.collision.zones.sights import aimed_at
from yarclang.collision.zones.tilts import angles_at
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.search import Apart, Effort, Question, bounds_of
from yarclang.progress import go_on

_STEP = 0.1
"""Length of a step of a branch before the projection onto the constraints [m, approximate motion of
bodies].
"""
_INSIDE = 0.7
"""Share of a constraint's largest angle that projected joint positions may use. The rest is a reserve for the
straight segments between them.
"""
_SPARE = 0.02
"""Distance that projected joint positions keep from both ends of a cone's allowed range of distances [m]. In
a narrow range it is less.
"""
_ROUNDS = 12
"""Largest number of Newton steps that project one joint position onto the constraints."""
_MOST_STEPS = 60
"""Largest number of steps of a branch towards a sample or towards the other tree."""
_DELTA = 1e-6
"""Step in joint position for finite differences [rad or m]."""
_CUTS = 120
"""Number of shortcuts that are tried on a polyline that was found."""


def _excesses(rule: Pointed, scene: Scene, q: Array) -> list[tuple[float, Array]]:
    """Measure an angle or cone constraint at P joint positions, and compare the first one with the slightly
    tightened limits.

    Return one item for each limit: the excess over the limit at the first row of `q` (P, n), and the measured
    angles or distances (P,) at all rows [rad or m].
    """
    if not isinstance(rule, Sight):
        seen = angles_at(rule, scene, q)
        return [(float(seen[0]) - rule.limit * _INSIDE, seen)]
    aim = aimed_at(rule, scene, q)
    # Aim at the inside of the range, so that straight pieces between projected positions stay within it.
    spare = min(_SPARE, (rule.far - rule.near) * (1.0 - _INSIDE) / 2.0)
    return [
        (float(aim.angle[0]) - rule.limit * _INSIDE, aim.angle),
        (rule.near + spare - float(aim.distance[0]), -aim.distance),
        (float(aim.distance[0]) - rule.far + spare, aim.distance),
    ]


def pulled(scene: Scene, rules: tuple[Pointed, ...], reach: Array, q: Array) -> Array | None:
    """Return a nearby joint position at which all angle and cone constraints hold with a reserve: project `q`
    onto the constraints.

    Args:
        scene: the scene with the arm.
        rules: the axes that keep an angle, and the cones.
        reach: (n,) lever of each joint [m/rad or 1]; the smaller the lever, the more the joint may turn.
        q: (n,) joint position to start from [rad or m].

    Returns:
        The projected joint position; None if none is found.
    """
    # For forward differences: the position itself, then for each joint the position in which only this joint
    # differs, by `_DELTA`.
    around = np.concatenate((np.zeros((1, len(q))), np.eye(len(q)) * _DELTA))
    for _ in range(_ROUNDS):
        worst, slopes = 0.0, None
        for rule in rules:
            for over, seen in _excesses(rule, scene, q + around):
                if over > worst:
                    worst, slopes = over, (seen[1:] - seen[0]) / _DELTA / reach
        if slopes is None:
            return q
        size = float(slopes @ slopes)
        if size < 1e-9:
            return None
        # Newton step along the gradient of the worst violation, in joint coordinates scaled by `reach`.
        q = q - slopes * ((worst + 1e-4) / size) / reach
    return None


@frozen(eq=False)
class _Space:
    """The functions and numbers that a search under constraints works with.

    `free` returns True for joint positions without collision, and `pull` projects a joint position onto the
    constraints. `reach` (n,) is the lever of each joint [m/rad or 1]. `step` (n,) is the distance between
    joint positions that are checked [rad or m]. `low` and `high` (n,) are the lower and upper bounds of joint
    positions [rad or m].
    """

    free: Callable[[Array], bool]
    pull: Callable[[Array], Array | None]
    reach: Array
    step: Array
    low: Array
    high: Array

    def joined(self, one: Array, other: Array) -> bool:
        """Return True if the straight segment between two joint positions is free of collisions; `one` itself
        isn't checked.
        """
        # Check from `other` backwards: near `one`, which is known to be free, a collision is least likely.
        count = int(np.ceil(float(np.linalg.norm((other - one) / self.step)))) or 1
        return all(self.free(one + (other - one) * (at / count)) for at in range(count, 0, -1))

    def walk(self, one: Array, other: Array) -> list[Array]:
        """Walk from one joint position towards another, and project each step onto the constraints. Return
        the joint positions after each step.

        The walk ends at `other`, or before the first step that would collide, leave the joint range, or
        hardly reduce the distance to `other`.
        """
        steps: list[Array] = []
        here, left = one, float(np.linalg.norm((other - one) * self.reach))
        for _ in range(_MOST_STEPS):
            if left <= _STEP:
                if left and self.joined(here, other):
                    steps.append(other)
                break
            there = self.pull(here + (other - here) * (_STEP / left))
            if there is None or (there < self.low).any() or (there > self.high).any():
                break
            # If the projection undoes most of the step, the walk makes no progress.
            now = float(np.linalg.norm((other - there) * self.reach))
            if now > left - 0.2 * _STEP or not self.joined(here, there):
                break
            steps.append(there)
            here, left = there, now
        return steps


class _Tree:
    def __init__(self, roots: Array) -> None:
        self.points = list(roots)
        self.scaled = roots.copy()
        self.parents = [-1] * len(roots)

    def nearest(self, q: Array, reach: Array) -> int:
        return int(np.argmin(np.square((self.scaled - q) * reach).sum(axis=1)))

    def grow(self, parent: int, points: list[Array]) -> int:
        """Add a branch of joint positions to the tree, and return the index of its last one."""
        for one in points:
            self.points.append(one)
            self.parents.append(parent)
            parent = len(self.points) - 1
        if points:
            self.scaled = np.concatenate((self.scaled, np.array(points)))
        return parent

    def way(self, at: int) -> list[Array]:
        """Return the joint positions on the branch from the root of the tree to the point with index `at`."""
        found = []
        while at >= 0:
            found.append(self.points[at])
            at = self.parents[at]
        return found[::-1]


def along_rules(
    scene: Scene, rules: tuple[Pointed, ...], question: Question, effort: Effort
) -> Array | Apart:
    """Search for a joint-space polyline from a start to a goal along which the angle and cone constraints are
    kept.

    Args:
        scene: the scene with the arm.
        rules: the axes that keep an angle, and the cones.
        question: starts and goals; its function `free` checks the constraints too.
        effort: parameters of the search.

    Returns:
        The corners (k, n) [rad or m], start and goal included. If no polyline is found, an `Apart` with the
        two joint positions at which the trees come nearest to each other.
    """
    random = np.random.default_rng(effort.seed)
    low, high = bounds_of(question)
    pull = partial(pulled, scene, rules, question.reach)
    space = _Space(question.free, pull, question.reach, effort.step / question.reach, low, high)
    out, in_ = _Tree(question.starts), _Tree(question.goals)
    tries = 0
    for tries in range(1, effort.samples + 1):
        go_on()
        if question.is_over():
            break
        # The first sample is the goal, so that the trees first try to meet directly.
        sample = in_.points[0] if tries == 1 else pull(low + random.random(len(low)) * (high - low))
        if sample is None:
            continue
        # RRT-Connect: grow one tree towards the sample, and the other one towards its new tip; then swap
        # roles.
        one, other = (out, in_) if tries % 2 else (in_, out)
        near = one.nearest(sample, space.reach)
        at = one.grow(near, space.walk(one.points[near], sample))
        tip = one.points[at]
        near = other.nearest(tip, space.reach)
        meeting = other.grow(near, space.walk(other.points[near], tip))
        if np.array_equal(other.points[meeting], tip):
            first, last = (at, meeting) if one is out else (meeting, at)
            return _shortened(space, [*out.way(first), *in_.way(last)[::-1][1:]], random)
    left = [
        float(np.linalg.norm((one - in_.points[in_.nearest(one, space.reach)]) * space.reach))
        for one in out.points
    ]
    best = int(np.argmin(left))
    beyond = in_.points[in_.nearest(out.points[best], space.reach)]
    return Apart(out.points[best], beyond, left[best], tries)


def _shortened(space: _Space, points: list[Array], random: np.random.Generator) -> Array:
    """Return a polyline with the same ends, but fewer and shorter segments."""
    for _ in range(_CUTS):
        if len(points) < 3:
            break
        go_on()
        first, last = sorted(random.integers(0, len(points), 2).tolist())
        if last - first < 2:
            continue
        cut = space.walk(points[first], points[last])
        if not cut or cut[-1] is not points[last]:
            continue
        old, new = (_length(way, space.reach) for way in (points[first : last + 1], [points[first], *cut]))
        if new < old * 0.999:
            points = [*points[: first + 1], *cut, *points[last + 1 :]]
    kept, at = [points[0]], 0
    while at < len(points) - 1:
        # From each corner, go straight to the farthest following corner that can be reached without a
        # collision.
        end = at + 1
        while end + 1 < len(points) and space.joined(points[at], points[end + 1]):
            end += 1
        kept.append(points[end])
        at = end
    return np.array(kept)


def _length(points: list[Array], reach: Array) -> float:
    return float(np.linalg.norm(np.diff(np.array(points), axis=0) * reach, axis=1).sum())
