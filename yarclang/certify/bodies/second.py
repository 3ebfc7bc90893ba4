"""A second proof of the clearances that `yarclang.collision.proof` reports for convex bodies.

The proof uses the judge's own placements, support functions and bounds. It compares each pair of bodies on
pieces of a motion's time, in the frame of the first body. A piece of duration d is settled by one of three
lower bounds of the distance:

- The gap between spheres around both bodies, less the distance by which the joints between both bodies move
  the second one.
- The gap at a separating plane in the middle of the piece, less the distance by which these joints move the
  second body.
- The smallest gap at the plane at both ends and in the middle, less A d^2 / 32, where A bounds the
  acceleration of all points.

Unsettled pieces are halved. If two bodies are closer at any instant than the first proof reports, that proof
is wrong.
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

    Three kinds are not examined: pairs that may touch, meshes that are not their own convex hulls, and
    motions that are rejected anyway because the first proof found bodies too close.

    Args:
        scene: bodies and pairs of bodies.
        course: segments of all motions.
        spans: (G, 2) range of the segments of each motion.
        found: the clearances that the first proof reports.
        own: for each motion, the indices of the pairs to examine; None to examine all pairs.
    """
    pairs, count = scene.pairs, len(spans)
    if own is None:
        reported = np.repeat(pairs.margin[None], count, axis=0)
    else:
        reported = np.full((count, len(pairs.first)), -np.inf)
        for motion, rows in enumerate(own):
            reported[motion, rows] = pairs.margin[rows]
    # The first proof reports for each pair that the pair keeps its margin, and for the nearest pair of each
    # kind also that this pair keeps the least distance.
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
        firsts, seconds = scene.pairs.first, scene.pairs.second
        # The first body of a pair is the one that fewer joints move, whatever the order in the scene.
        # Only the joints between both bodies move the second one in the frame of the first.
        joint = np.array([body.joint for body in scene.bodies])
        turned = joint[firsts] > joint[seconds]
        self.first, self.second = np.where(turned, seconds, firsts), np.where(turned, firsts, seconds)
        bodies = np.unique(np.concatenate([firsts[asked], seconds[asked]])).tolist()
        self.items = {body: room_of(scene.bodies[body]) for body in bodies}
        # The largest distance of each joint from zero is at most that at the start of a segment, plus the
        # travel within the segment.
        extent = np.abs(course.x).max(axis=0) + np.diff(course.way, axis=0).max(axis=0)
        self.lengths, self.reach = np.zeros((2, len(firsts), scene.chain.size))
        for pair in asked.tolist():
            base, item = int(joint[self.first[pair]]), self.items[int(self.second[pair])]
            self.lengths[pair], self.reach[pair] = _steps(scene.chain, base, item, extent)
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
            # Halve the pieces on which some pair isn't settled. Each half is compared for the unsettled pairs
            # of its piece.
            half = (begin[kept] + end[kept]) / 2.0
            begin, end = np.concatenate([begin[kept], half]), np.concatenate([half, end[kept]])
            motion = np.concatenate([motion[kept], motion[kept]])
            at, pair = np.concatenate([at, at + len(kept)]), np.concatenate([pair, pair])
        return list(self.refuting.values())

    def _left(self, motion: Rows, begin: Array, end: Array, at: Rows, pair: Rows) -> Rows:
        """Return the indices of the combinations of a piece and a pair that aren't settled yet, in ascending
        order.

        Args:
            motion: (T,) motion of each piece of time.
            begin: (T,) start of each piece, after the start of the first segment [s].
            end: (T,) end of each piece [s].
            at: (K,) piece of each combination.
            pair: (K,) pair of bodies of each combination.
        """
        chain, course = self.scene.chain, self.course
        half = (begin + end) / 2.0
        # Bound the motion of a pair on either half of a piece by that of the joints between its bodies.
        # `gone` is the summed |travel| of each joint since the start of the motions.
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
        # Try the first bound of the module's docstring: the gap between spheres around both bodies.
        apart = np.sqrt(((centers[second, :, at] - centers[first, :, at]) ** 2).sum(axis=1))
        least = self.reported[motion[at], pair]
        # A comparison with NaN is False, so a piece with NaN is never settled.
        near = np.flatnonzero(~(apart - bound[first] - bound[second] - way >= least))
        if not len(near):
            return near
        close, place_of = np.unique(at[near], return_inverse=True)
        # `place_at` maps a piece to its row in the arrays of the pieces with close pairs.
        place_at = np.zeros(len(begin), dtype=np.int64)
        place_at[at[near]] = place_of
        # Try the second and the third bound, which use planes, for the pairs that the first bound doesn't
        # settle.
        begin, half, end = begin[close], half[close], end[close]
        ends = [KINEMATICS.placements(chain, course.at(time)) for time in (begin, end)]
        middle, peaks = middle[:, :, :, close], course.peaks(begin, end)
        left: list[Rows] = []
        for number in np.unique(pair[near]).tolist():
            rows = near[pair[near] == number]
            pieces = place_at[at[rows]]
            joints = self.items[int(self.first[number])].joint, self.items[int(self.second[number])].joint
            arms = [seen(placed, *joints, pieces) for placed in (ends[0], middle, ends[1])]
            # On each half of a piece of duration d, the gap leaves its chord by at most A (d / 2)^2 / 8,
            # where A bounds the acceleration.
            sag = self._bend(number, *(peak[pieces] for peak in peaks)) * (end - begin)[pieces] ** 2 / 32.0
            settled, distance = self._settled(number, arms, way[rows], sag, least[rows])
            # The distance computed by coal is the real one in the middle of the piece: if it is below the
            # reported distance, the first proof is refuted.
            wrong = distance < least[rows] - EQUAL
            for row in np.flatnonzero(wrong).tolist():
                key = int(motion[at[rows[row]]]), number
                place = Nearer(*key, float(half[pieces[row]]), float(distance[row]), float(least[rows[row]]))
                self.refuting.setdefault(key, place)
            left.append(rows[~settled & ~wrong & ~(way[rows] <= SHORT)])
        return np.sort(np.concatenate(left))

    def _bend(self, pair: int, speed: Array, strength: Array) -> Array:
        """Bound |p''| (P,) [m/s^2] of the second body's points, relative to the first body."""
        lines = axes_of(self.scene.chain)
        w, a, bend = (np.zeros(len(speed)) for _ in range(3))
        for joint in range(self.items[int(self.first[pair])].joint, self.items[int(self.second[pair])].joint):
            turn, slide = float(lines.turn[joint]), abs(float(lines.slide[joint]))
            # A prismatic joint adds its Coriolis acceleration and its own acceleration; its travel is part of
            # `lengths`.
            if slide:
                bend = bend + slide * (2.0 * w * speed[:, joint] + strength[:, joint])
            w, a = w + turn * speed[:, joint], a + turn * strength[:, joint]
            # Add the vector from this axis to the next. All joints up to this one turn it, so a unit vector u
            # along it has |u''| <= W^2 + A with W and A, the sums of these joints' velocities and
            # accelerations.
            bend = bend + self.lengths[pair, joint] * (w**2 + a)
        return bend

    def _settled(
        self, pair: int, arms: list[Joints], way: Array, sag: Array, least: Array
    ) -> tuple[NDArray[np.bool_], Array]:
        """Return a mask of the pieces on which planes prove a pair apart, and the pair's distances [m] in the
        middles of the pieces, computed by coal.

        A distance is infinite if the first plane already proves the pair apart.
        """
        first, second = self.items[int(self.first[pair])], self.items[int(self.second[pair])]
        # Try the direction between the middles first, then coal's direction.
        toward = arms[1].point(second.middle) - first.middle[:, None]
        toward /= np.maximum(np.sqrt((toward**2).sum(axis=0)), 1e-12)
        settled = self._is_apart(first, second, arms, toward, way, sag, least)
        distance = np.full(len(way), np.inf)
        rows = np.flatnonzero(~settled)
        if len(rows):
            few = [arm.take(rows) for arm in arms]
            toward, distance[rows] = nearest(first, second, few[1])
            settled[rows] = self._is_apart(first, second, few, toward, way[rows], sag[rows], least[rows])
        return settled, distance

    def _is_apart(
        self, one: Item, other: Item, arms: list[Joints], toward: Array, way: Array, sag: Array, least: Array
    ) -> NDArray[np.bool_]:
        still = Joints(np.eye(3)[:, :, None], np.zeros((3, 1)), np.zeros((3, 1)), np.zeros((3, 1)))
        # Find how far the first body reaches along the normal. It rests, since all placements are in its own
        # frame.
        reach = -still.lowest(one, -toward)
        begin, middle, end = (arm.lowest(other, toward) - reach for arm in arms)
        # Take the sharper one of the second and the third bound in the docstring of the module.
        proved = np.maximum(np.minimum(np.minimum(begin, end), middle) - sag, middle - way)
        return np.asarray(proved >= least - EQUAL)


def seen(placed: Array, one: int, other: int, pieces: Rows) -> Joints:
    """Return the placements of one body relative to a reference body, at some instants.

    A body is identified by the number of joints that move it.

    Args:
        placed: placements in {B} of the bodies that 0, 1, ... joints move, at all instants.
        one: number of joints that move the reference bodies.
        other: number of joints that move the bodies to place.
        pieces: indices of the instants.
    """
    base, arm = placed[one][:, :, pieces], placed[other][:, :, pieces]
    # Let (B, b) be rotation and translation of the reference body, and (A, a) those of the other one.
    # Relative to the reference body, the other one is placed at (B' A, B' (a - b)).
    turn = np.einsum("kip,kjp->ijp", base[:, :3], arm[:, :3])
    shift = np.einsum("kip,kp->ip", base[:, :3], arm[:, 3] - base[:, 3])
    nothing = np.zeros_like(shift)
    return Joints(turn, shift, nothing, nothing)


def nearest(one: Item, other: Item, arm: Joints) -> tuple[Array, Array]:
    """Return the unit directions (3, P) from one body to another, and their distances (P,) [m], by coal.

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
    """Bound the distances by which joints move a body, in the frame of the bodies that the first `base`
    joints move.

    Args:
        chain: the arm, with n joints.
        base: number of joints that move both bodies alike, and so don't count.
        item: the body.
        far: (n,) largest distance of each joint from zero [rad or m].

    Returns:
        The lengths (n,) of the vectors from one revolute axis to the next, including the largest travel of
        prismatic joints between them [m]; and for each joint (n,) the largest distance by which a point of
        the body moves per unit of the joint [m/rad or m/m].
    """
    lines, ways = axes_of(chain), _ways(chain, item)
    lengths, reach = np.zeros(chain.size), np.zeros(chain.size)
    rest, total = 0.0, 0.0
    for joint in range(item.joint - 1, base - 1, -1):
        # Go from the body towards the base. A revolute joint moves every point by at most the lengths of all
        # vectors from its axis to the body, a prismatic joint by its own travel.
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
    """Return the distances (n,) [m] from each revolute axis to the next, with all joints at zero.

    For the last revolute axis before the body, it is the distance to the body's farthest point. Results are
    cached by the identity of chain and item.
    """
    lines = axes_of(chain)
    lengths = [0.0] * chain.size
    here, rest = item.middle, item.bound
    for joint in range(item.joint - 1, -1, -1):
        if lines.turn[joint]:
            axis, on_axis = lines.axes[joint], lines.points[joint]
            # Go on from the foot of the perpendicular from the last point to this axis.
            foot = on_axis + axis * float(axis @ (here - on_axis))
            lengths[joint] = rest + float(np.sqrt(((here - foot) ** 2).sum()))
            here, rest = foot, 0.0
    return tuple(lengths)
