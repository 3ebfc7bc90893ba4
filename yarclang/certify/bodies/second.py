"""A second proof of the clearances of convex bodies that `yarclang.collision.proof` reports.

The proof uses the judge's own placements, support functions and bounds. It compares each pair of bodies on
pieces of a motion's time, in the frame of the first body. Three bounds settle a piece of duration d: the gap
between spheres around both bodies, less the distance that the joints between them move the second body; the
gap at a separating plane in the middle of the piece, less that distance; and the smallest gap at the plane at
both ends and in the middle, less A d^2 / 32, where A bounds the acceleration of all points. Unsettled pieces
are halved. If bodies are closer than reported anywhere, the first proof is wrong.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bodies.fastest import Joints
from yarclang.certify.kinematics.arm import KINEMATICS, axes_of
from yarclang.collision.course import Course
from yarclang.collision.proof import KNOWN, Clearances
from yarclang.collision.scene import Rows, Scene
from yarclang.collision.zones.watched import Item, room_of
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Chain

STEP = 0.08
"""Largest motion of a joint on a piece of a motion's time, before any piece is halved [rad or m]."""
EQUAL = 5e-6
"""Allowed disagreement between both proofs [m], more than ten times the error of distances by coal."""
SHORT = 2e-4
"""If nothing moves farther than this [m] on a piece, the piece isn't halved: the distance in its middle
decides.
"""


@frozen
class Nearer:
    """An instant of a motion at which a pair of bodies is nearer than the first proof reports.

    Attributes:
        motion: index of the motion.
        pair: index of the pair of bodies.
        time: time after the start of the first segment [s].
        distance: distance of the bodies [m].
        reported: the distance that was reported [m].
    """

    motion: int
    pair: int
    time: float
    distance: float
    reported: float


def refuted(
    scene: Scene, course: Course, spans: NDArray[np.int64], found: Clearances, own: list[Rows] | None
) -> list[Nearer]:
    """Prove clearances again, and return the instants that refute them, at most one for each motion and pair.

    Not examined are pairs that may touch, meshes that are not their own convex hulls, and motions that are
    rejected anyway because the first proof found bodies too close.

    Args:
        scene: bodies and pairs of bodies.
        course: segments of all motions.
        spans: (G, 2) range of the segments of each motion.
        found: the clearances that the first proof reports.
        own: for each motion the pairs to examine; None for all pairs.
    """
    pairs, count = scene.pairs, len(spans)
    if own is None:
        reported = np.repeat(pairs.margin[None], count, axis=0)
    else:
        reported = np.full((count, len(pairs.first)), -np.inf)
        for motion, rows in enumerate(own):
            reported[motion, rows] = pairs.margin[rows]
    # A pair is reported to keep its margin; the nearest pair of each kind is reported to keep its least
    # distance.
    decided, kind = np.nonzero((found.nearest[:, :2] >= 0) & (found.least[:, :2] < KNOWN))
    deciding = decided, found.nearest[decided, kind]
    reported[deciding] = np.maximum(reported[deciding], found.least[decided, kind])
    reported[[one.motion for one in found.meetings]] = -np.inf
    hollow = scene.boxes.hollow[pairs.first] | scene.boxes.hollow[pairs.second]
    reported[:, pairs.touching | hollow] = -np.inf
    return _Second(scene, course, reported).found(spans)


class _Second:
    def __init__(self, scene: Scene, course: Course, reported: Array) -> None:
        self.scene, self.course, self.reported = scene, course, reported
        asked = np.flatnonzero((reported > -np.inf).any(axis=0))
        one, other = scene.pairs.first, scene.pairs.second
        # The first body of a pair is the one that fewer joints move, whatever the order in the scene.
        joint = np.array([body.joint for body in scene.bodies])
        turned = joint[one] > joint[other]
        self.first, self.second = np.where(turned, other, one), np.where(turned, one, other)
        bodies = np.unique(np.concatenate([one[asked], other[asked]])).tolist()
        self.items = {body: room_of(scene.bodies[body]) for body in bodies}
        # Largest |q| of each joint: at the start of a segment, plus its travel within the segment.
        far = np.abs(course.x).max(axis=0) + np.diff(course.way, axis=0).max(axis=0)
        self.lengths, self.reach = np.zeros((2, len(one), scene.chain.size))
        for pair in asked.tolist():
            base, item = int(joint[self.first[pair]]), self.items[int(self.second[pair])]
            self.lengths[pair], self.reach[pair] = _steps(scene.chain, base, item, far)
        self.refuting: dict[tuple[int, int], Nearer] = {}

    def found(self, spans: NDArray[np.int64]) -> list[Nearer]:
        """Halve pieces of time until all pairs are settled; return the instants that refute clearances."""
        course = self.course
        begin, end = course.begins[spans[:, 0]], course.begins[spans[:, 1]]
        way = (course.way[spans[:, 1]] - course.way[spans[:, 0]]).max(axis=1)
        # Begin with equal pieces on which no joint moves by more than about `STEP`.
        count = np.maximum(1, np.ceil(way / STEP)).astype(np.int64)
        motion = np.repeat(np.arange(len(spans)), count)
        number = np.arange(len(motion)) - np.repeat(np.cumsum(count) - count, count)
        long = ((end - begin) / count)[motion]
        begin = begin[motion] + number * long
        end = begin + long
        at, pair = np.nonzero(self.reported[motion] > -np.inf)
        while len(at):
            go_on()
            left = self._left(motion, begin, end, at, pair)
            at, pair = at[left], pair[left]
            kept, at = np.unique(at, return_inverse=True)
            half = (begin[kept] + end[kept]) / 2.0
            begin, end = np.concatenate([begin[kept], half]), np.concatenate([half, end[kept]])
            motion = np.concatenate([motion[kept], motion[kept]])
            at, pair = np.concatenate([at, at + len(kept)]), np.concatenate([pair, pair])
        return list(self.refuting.values())

    def _left(self, motion: Rows, begin: Array, end: Array, at: Rows, pair: Rows) -> Rows:
        """Return which combinations of a piece (`at`) and a pair of bodies (`pair`) are not settled yet."""
        chain, course = self.scene.chain, self.course
        half = (begin + end) / 2.0
        # Bound the motion of a pair on either half of a piece by that of the joints between its bodies.
        gone = [course.gone(time) for time in (begin, half, end)]
        moves = np.maximum(gone[1] - gone[0], gone[2] - gone[1])
        way = np.einsum("rn,rn->r", self.reach[pair], moves[at])
        middle = KINEMATICS.placements(chain, course.at(half))
        count = len(self.scene.bodies)
        centers, bound = np.zeros((count, 3, len(half))), np.zeros(count)
        for body, item in self.items.items():
            turn, shift = middle[item.joint, :, :3], middle[item.joint, :, 3]
            centers[body], bound[body] = np.tensordot(turn, item.middle, axes=(1, 0)) + shift, item.bound
        first, second = self.first[pair], self.second[pair]
        # First bound: spheres around both bodies.
        apart = np.sqrt(((centers[second, :, at] - centers[first, :, at]) ** 2).sum(axis=1))
        least = self.reported[motion[at], pair]
        # A comparison with NaN is False, so a piece with NaN is never settled.
        near = np.flatnonzero(~(apart - bound[first] - bound[second] - way >= least))
        if not len(near):
            return near
        close, place_of = np.unique(at[near], return_inverse=True)
        place_at = np.zeros(len(begin), dtype=np.int64)
        place_at[at[near]] = place_of
        # Second and third bound, for the remaining pairs: planes.
        begin, half, end = begin[close], half[close], end[close]
        ends = [KINEMATICS.placements(chain, course.at(time)) for time in (begin, end)]
        middle, peaks = middle[:, :, :, close], course.peaks(begin, end)
        left: list[Rows] = []
        for one in np.unique(pair[near]).tolist():
            rows = near[pair[near] == one]
            pieces = place_at[at[rows]]
            joints = self.items[int(self.first[one])].joint, self.items[int(self.second[one])].joint
            arms = [seen(placed, *joints, pieces) for placed in (ends[0], middle, ends[1])]
            sag = self._bend(one, *(peak[pieces] for peak in peaks)) * (end - begin)[pieces] ** 2 / 32.0
            settled, distance = self._settled(one, arms, way[rows], sag, least[rows])
            # coal's distance in the middle is really there: if it is below the reported one, the first proof
            # is refuted.
            wrong = distance < least[rows] - EQUAL
            for row in np.flatnonzero(wrong).tolist():
                key = int(motion[at[rows[row]]]), one
                place = Nearer(*key, float(half[pieces[row]]), float(distance[row]), float(least[rows[row]]))
                self.refuting.setdefault(key, place)
            left.append(rows[~settled & ~wrong & ~(way[rows] <= SHORT)])
        return np.sort(np.concatenate(left))

    def _bend(self, pair: int, speed: Array, strength: Array) -> Array:
        """Bound |p''| (P,) [m/s^2] of the second body's points, seen from the first body."""
        lines = axes_of(self.scene.chain)
        w, a, bend = (np.zeros(len(speed)) for _ in range(3))
        for joint in range(self.items[int(self.first[pair])].joint, self.items[int(self.second[pair])].joint):
            turn, slide = float(lines.turn[joint]), abs(float(lines.slide[joint]))
            # A sliding joint adds its Coriolis acceleration and its own acceleration; its distance is part of
            # `lengths`.
            if slide:
                bend = bend + slide * (2.0 * w * speed[:, joint] + strength[:, joint])
            w, a = w + turn * speed[:, joint], a + turn * strength[:, joint]
            # Step from this axis to the next, turned by all joints up to this one: |u''| <= W^2 + A.
            bend = bend + self.lengths[pair, joint] * (w**2 + a)
        return bend

    def _settled(
        self, pair: int, arms: list[Joints], way: Array, sag: Array, least: Array
    ) -> tuple[NDArray[np.bool_], Array]:
        """Return on which pieces planes prove a pair apart, and bounds of its distances in the middles [m].

        A bound is infinite if the first plane already proves the pair apart.
        """
        one, other = self.items[int(self.first[pair])], self.items[int(self.second[pair])]
        # Try the direction between the middles first, then coal's direction.
        toward = arms[1].point(other.middle) - one.middle[:, None]
        toward /= np.maximum(np.sqrt((toward**2).sum(axis=0)), 1e-12)
        settled = self._is_apart(one, other, arms, toward, way, sag, least)
        distance = np.full(len(way), np.inf)
        rows = np.flatnonzero(~settled)
        if len(rows):
            few = [arm.take(rows) for arm in arms]
            toward, distance[rows] = nearest(one, other, few[1])
            settled[rows] = self._is_apart(one, other, few, toward, way[rows], sag[rows], least[rows])
        return settled, distance

    def _is_apart(
        self, one: Item, other: Item, arms: list[Joints], toward: Array, way: Array, sag: Array, least: Array
    ) -> NDArray[np.bool_]:
        still = Joints(np.eye(3)[:, :, None], np.zeros((3, 1)), np.zeros((3, 1)), np.zeros((3, 1)))
        # The farthest point of the first body along the normal; the first body rests in its own frame.
        reach = -still.lowest(one, -toward)
        begin, middle, end = (arm.lowest(other, toward) - reach for arm in arms)
        # The second and the third bound of the module's text; the sharper one counts.
        proved = np.maximum(np.minimum(np.minimum(begin, end), middle) - sag, middle - way)
        return np.asarray(proved >= least - EQUAL)


def seen(placed: Array, one: int, other: int, pieces: Rows) -> Joints:
    """Return the placements of some bodies relative to others, by the numbers of joints that move them.

    Args:
        placed: placements in {B} of the bodies that 0, 1, ... joints move, at all instants.
        one: number of joints that move the reference bodies.
        other: number of joints that move the bodies to place.
        pieces: indices of the instants.
    """
    base, arm = placed[one][:, :, pieces], placed[other][:, :, pieces]
    # Relative placement: B' A for the rotations, B' (a - b) for the translations.
    turn = np.einsum("kip,kjp->ijp", base[:, :3], arm[:, :3])
    shift = np.einsum("kip,kp->ip", base[:, :3], arm[:, 3] - base[:, 3])
    nothing = np.zeros_like(shift)
    return Joints(turn, shift, nothing, nothing)


def nearest(one: Item, other: Item, arm: Joints) -> tuple[Array, Array]:
    """Compute by coal the unit directions (3, P) from one body to another, and their distances (P,) [m].

    A distance is not positive if the bodies overlap.
    """
    import coal

    assert one.base_from_body is not None  # points are not in any pair
    assert other.base_from_body is not None
    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    here = coal.Transform3s(one.base_from_body[:3, :3], one.base_from_body[:3, 3])
    there = coal.Transform3s()
    turns = arm.turn.transpose(2, 0, 1) @ other.base_from_body[:3, :3]
    shifts = arm.point(other.base_from_body[:3, 3]).T
    toward, distance = np.empty((3, len(turns))), np.empty(len(turns))
    for row, (turn, shift) in enumerate(zip(turns, shifts, strict=True)):
        answer.clear()
        there.setTransform(turn, shift)
        distance[row] = coal.distance(one.of_coal, here, other.of_coal, there, request, answer)
        toward[:, row] = answer.normal
    size = np.sqrt((toward**2).sum(axis=0))
    toward[:, ~(np.abs(size - 1.0) < 1e-9)] = np.array([[0.0], [0.0], [1.0]])
    return toward, distance


def _steps(chain: Chain, base: int, item: Item, far: Array) -> tuple[Array, Array]:
    """Bound how far the joints move a body, in the frame of the bodies that the first `base` joints move.

    Args:
        chain: the arm, with n joints.
        base: number of joints that move both bodies alike, and so don't count.
        item: the body.
        far: (n,) largest |q| [rad or m].

    Returns:
        Two arrays (n,). The lengths of the vectors from one joint axis to the next, slides included [m]; and
        the largest distance by which a point of the body moves per unit of each joint [m/rad or m/m].
    """
    lines, ways = axes_of(chain), _ways(chain, item)
    lengths, reach = np.zeros(chain.size), np.zeros(chain.size)
    rest, total = 0.0, 0.0
    for joint in range(item.joint - 1, base - 1, -1):
        slide = abs(float(lines.slide[joint]))
        rest += slide * float(far[joint])
        if lines.turn[joint]:
            lengths[joint] = rest + ways[joint]
            total += lengths[joint]
            rest = 0.0
        reach[joint] = total * float(lines.turn[joint]) + slide
    return lengths, reach


@lru_cache(maxsize=512)
def _ways(chain: Chain, item: Item) -> tuple[float, ...]:
    """Return the distances (n,) [m] from each turning axis to the next, with all joints at zero.

    The last one leads to the body's farthest point. Results are cached by the identity of chain and item.
    """
    lines = axes_of(chain)
    found = [0.0] * chain.size
    here, rest = item.middle, item.bound
    for joint in range(item.joint - 1, -1, -1):
        if lines.turn[joint]:
            axis, on_axis = lines.axes[joint], lines.points[joint]
            # Foot of the perpendicular from the last point to this axis.
            foot = on_axis + axis * float(axis @ (here - on_axis))
            found[joint] = rest + float(np.sqrt(((here - foot) ** 2).sum()))
            here, rest = foot, 0.0
    return tuple(found)
