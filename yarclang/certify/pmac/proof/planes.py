"""Separating planes that keep bodies apart, for the small checker.

For each pair of bodies, the search looks for long stretches of a text's time during which one plane separates
the pair. It begins with the whole text. If it finds no plane for a stretch, it divides the stretch and
examines both parts. It divides between commands if it can, else between segments, else within a segment. The
bounds are those of the checker (`yarclang.verify.apart`), in floating point and with a small reserve.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bodies.fastest import Joints
from yarclang.certify.bodies.second import nearest, seen
from yarclang.certify.kinematics.arm import KINEMATICS, axes_of, motions, steps_of
from yarclang.certify.pmac.proof.room import Needed, exactly, told_arm
from yarclang.collision.scene import Rows
from yarclang.collision.zones.watched import Item
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot
from yarclang.verify.apart import PARTS, Stretch, Timeline
from yarclang.verify.arm import Arm
from yarclang.verify.conditions import Slow
from yarclang.verify.course import Moved
from yarclang.verify.exact import ONE
from yarclang.verify.reader import PRINTED
from yarclang.verify.room import Pair, Room

_LEFT = 2e-6
"""Amount by which the gap between two bodies must exceed their margin [m].

It covers rounding errors, and the rounding of mesh corners to the grid of the proof's numbers.
"""
_SCALES = (100, 10_000, 10_000_000)
"""Scales by which unit normals of planes are multiplied before they are rounded to integers. The search uses
the first scale that is fine enough.
"""

Planes = list[list[object]]


@frozen(eq=False)
class Segments:
    """All N segments of a text.

    Attributes:
        control: (N, 4, n) control points [rad or m].
        h: (N,) durations [s].
        run: (N,) index of the sequence of moves of each segment.
        row: (N,) row of the command of each segment.
        steps: (N,) step of the command of each segment.
    """

    control: Array
    h: Array
    run: Rows
    row: Rows
    steps: Rows

    @classmethod
    def of(cls, rows: Sequence[Moved], robot: Robot) -> Segments:
        """Return the control points of a text as the checker reads them."""
        rows = [row for row in rows if row.last > row.first]
        control = [np.empty((0, 4, robot.size))]
        for row in rows:
            points = np.array(row.control[row.first : row.last + 3], dtype=np.float64)
            points *= robot.axis_units / PRINTED
            control.append(np.lib.stride_tricks.sliding_window_view(points, 4, axis=0).transpose(0, 2, 1))
        counts = [row.last - row.first for row in rows]
        return cls(
            np.concatenate(control),
            np.repeat([float(row.seconds) for row in rows], counts),
            np.repeat(np.array([row.run for row in rows], dtype=np.int64), counts),
            np.repeat(np.arange(len(rows)), counts),
            np.repeat(np.array([row.entry.step for row in rows], dtype=np.int64), counts),
        )

    def at(self, segment: Rows, share: Array) -> Array:
        """Return the joint positions (P, n) in segments (P,) at fractions (P,) of their durations."""
        t = share[:, None]
        c = self.control[segment].transpose(1, 0, 2)
        found: Array = (
            (1 - t) ** 3 * c[0]
            + (3 * t**3 - 6 * t**2 + 4) * c[1]
            + (-3 * t**3 + 3 * t**2 + 3 * t + 1) * c[2]
            + t**3 * c[3]
        ) / 6.0
        return found

    def rate(self, segment: Rows, share: Array) -> Array:
        """Return the joint velocities (P, n) in segments (P,) at fractions (P,) of their durations."""
        t = share[:, None]
        one, two, three = np.diff(self.control[segment], axis=1).transpose(1, 0, 2)
        found: Array = ((1 - t) ** 2 * one + (1 + 2 * t - 2 * t**2) * two + t**2 * three) / 2.0
        return found / self.h[segment][:, None]


class _Conditions:
    """Conditions that aren't speeds, such as path constraints and ranges of joints.

    The checker's own exact functions decide them, since only a few pairs have such a condition.
    """

    def __init__(self, timeline: Timeline, room: Room, pairs: Sequence[Pair]) -> None:
        self.timeline = timeline
        self.bodies = [room.bodies[pair.other] for pair in pairs]
        self.of = [[one for one in pair.conditions if not isinstance(one, Slow)] for pair in pairs]
        self.has = np.array([bool(conditions) for conditions in self.of])
        self.alone = np.array([pair.other == room.count for pair in pairs])
        """(pairs,) True for conditions of the joints alone, for which there is no plane."""

    def hold(self, begin: Rows, end: Rows, pair: Rows) -> NDArray[np.bool_]:
        """Return a mask of the stretches of time on which a condition of their pair holds."""
        found = np.zeros(len(pair), dtype=np.bool_)
        stretches: dict[tuple[int, int], Stretch] = {}
        for row, (first, last, one) in enumerate(
            zip(begin.tolist(), end.tolist(), pair.tolist(), strict=True)
        ):
            if (first, last) not in stretches:
                stretches[first, last] = self.timeline.stretch(first, last, True)
            found[row] = any(
                condition.holds(stretches[first, last], self.bodies[one]) for condition in self.of[one]
            )
        return found


class _Search:
    def __init__(self, segments: Segments, needed: Needed, robot: Robot, conditions: _Conditions) -> None:
        self.segments, self.needed, self.chain = segments, needed, robot.chain
        self.conditions = conditions
        steps = np.diff(segments.control, axis=1)
        bends = np.diff(steps, axis=1)
        # The velocity on a segment is a parabola. Its Bezier points, times h, are the middle one of the three
        # `steps` between control points, and the two means of neighbouring `steps`. The largest Bezier point
        # bounds the velocity.
        inner = np.abs(steps[:, :-1] + steps[:, 1:]).max(axis=1) / 2.0
        h = segments.h[:, None]
        self.w = _ended(np.maximum(inner, np.abs(steps[:, 1])) / h)
        self.a = _ended(np.abs(bends).max(axis=1) / h**2)
        self.j = _ended(np.abs(np.diff(bends, axis=1)[:, 0]) / h**3)
        self.low, self.high = _ended(segments.control.min(axis=1)), _ended(segments.control.max(axis=1))
        # Compute base_from_link with all joints at zero, for the link that the first k joints move. Its
        # rotation brings a normal into the frame of the body that carries the plane.
        turn = np.eye(4)
        self.turns = [np.eye(3)]
        for step in steps_of(self.chain)[:-1]:
            turn = turn @ step
            self.turns.append(turn[:3, :3])
        self.is_turn = axes_of(self.chain).turn == 1.0
        far = np.abs(segments.control).max(axis=(0, 1)) if len(segments.h) else np.zeros(robot.size)
        self.reach = [_reach(robot, item, far) for item in needed.items]
        self.planes: dict[tuple[int, int, int], list[list[int]]] = defaultdict(list)
        self.failed: set[int] = set()

    def found(self) -> Planes:
        """Return separating planes for all pairs, found by halving stretches of time.

        A stretch is halved until a plane keeps the pair apart during it, or until it is too short.
        """
        begin, end, pair, margin = self.needed.stretches()
        while len(pair):
            go_on()
            done = np.zeros(len(pair), dtype=np.bool_)
            # With `bent` False, the joints' ranges in whole segments bound the motion. With `bent` True, the
            # bound is sharper, but valid only for segments of equal duration, as within one sequence of
            # moves.
            one = self.segments.run[begin // PARTS] == self.segments.run[(end - 1) // PARTS]
            whole = (begin % PARTS == 0) & (end % PARTS == 0)
            for bent, fits in ((False, whole), (True, one)):
                rows = np.flatnonzero(fits & ~done & ~self.conditions.alone[pair])
                if len(rows):
                    done[rows] = self._settled(begin[rows], end[rows], pair[rows], margin[rows], bent=bent)
            rows = np.flatnonzero(one & ~done & (self.needed.speeds[pair] > 0.0))
            if len(rows):
                done[rows] = self._slow(begin[rows], end[rows], pair[rows])
            rows = np.flatnonzero(one & ~done & self.conditions.has[pair])
            done[rows] = self.conditions.hold(begin[rows], end[rows], pair[rows])
            for row in rows[done[rows]]:
                self.planes[int(begin[row]), int(end[row]), 2].append([int(pair[row])])
            short = ~done & (end - begin == 1)
            self.failed |= set(pair[short].tolist())
            left = np.flatnonzero(~done & ~np.isin(pair, list(self.failed)))
            middle = self._middle(begin[left], end[left])
            # Continue with both halves of each stretch that is not settled.
            begin = np.concatenate([begin[left], middle])
            end = np.concatenate([middle, end[left]])
            pair, margin = np.tile(pair[left], 2), np.tile(margin[left], 2)
        found: Planes = []
        for (begins, ends, kind), named in sorted(self.planes.items()):
            kept = [one for one in named if one[0] not in self.failed]
            if kept:
                found.append([begins, ends, kind, *kept])
        return found

    def _middle(self, begin: Rows, end: Rows) -> Rows:
        """Return the times that divide stretches: between commands if possible, else between segments, else
        within a segment.
        """
        middle = (begin + end) // 2
        cut = np.where(end - begin > PARTS, (middle + PARTS // 2) // PARTS * PARTS, middle)
        row = self.segments.row
        # Find the times at which a command begins or ends, in parts of a segment.
        edges = np.flatnonzero(np.append(True, np.append(row[1:] != row[:-1], True))) * PARTS
        for nearest_ in (np.searchsorted(edges, middle), np.searchsorted(edges, middle) - 1):
            edge = edges[np.clip(nearest_, 0, len(edges) - 1)]
            inside = (edge > begin) & (edge < end)
            better = np.abs(edge - middle) < np.abs(cut - middle)
            cut = np.where(inside & (better | ~np.isin(cut, edges)), edge, cut)
        return cut

    def _settled(self, begin: Rows, end: Rows, pair: Rows, margin: Array, *, bent: bool) -> NDArray[np.bool_]:
        """Return a mask of the pairs that a plane keeps apart during their stretches of time, and store these
        planes.

        Args:
            begin: (K,) starts of the stretches, in parts of a segment.
            end: (K,) ends of the stretches, in parts of a segment.
            pair: (K,) pair of bodies to examine during each stretch.
            margin: (K,) distance that the pair must keep [m].
            bent: True for the bound from both ends and the middle of a stretch within one sequence of moves;
                False for the bound from the ranges of the joints.
        """
        nodes, at = np.unique(np.stack([begin, end]), axis=1, return_inverse=True)
        first, last = nodes[0] // PARTS, (nodes[1] - 1) // PARTS
        bounds = np.stack([first, last + 1], axis=1).ravel()
        if bent:
            # Compute poses at both ends and in the middle of each stretch, and bounds of the joints'
            # velocities and accelerations, which give the bounds of the bodies' second derivatives.
            w, a = (np.maximum.reduceat(one, bounds)[::2] for one in (self.w, self.a))
            share = (nodes[0] - first * PARTS) / PARTS, (nodes[1] - last * PARTS) / PARTS
            mean = (nodes[0] + nodes[1]) / 2.0 / PARTS
            half = np.minimum(mean.astype(np.int64), last)
            q = [self.segments.at(half, mean - half)]
            q += [self.segments.at(first, share[0]), self.segments.at(last, share[1])]
            d = (nodes[1] - nodes[0]) / PARTS * self.segments.h[first]
        else:
            low, high = (
                np.minimum.reduceat(self.low, bounds)[::2],
                np.maximum.reduceat(self.high, bounds)[::2],
            )
            q = [(low + high) / 2.0]
            # Compute the pose in the middle of the joints' ranges, from which each joint travels by at most
            # half of its range.
            w, a, d = (high - low) / 2.0, low, np.zeros(len(first))
        placed = [KINEMATICS.placements(self.chain, one) for one in q]
        settled = np.zeros(len(pair), dtype=np.bool_)
        for one in np.unique(pair).tolist():
            rows = np.flatnonzero(pair == one)
            here = at[rows]
            body, other = self.needed.pairs[one]
            item, moving = self.needed.items[body], self.needed.items[other]
            reach = self.reach[other]
            if bent:
                rest = (
                    _bend(reach, self.is_turn, item.joint, moving.joint, w[here], a[here])
                    * d[here] ** 2
                    / 8.0
                )
            else:
                # A revolute joint moves a point by at most its travel times the point's distance from the
                # axis; a prismatic joint moves it by the travel.
                size = np.where(self.is_turn[: moving.joint], reach, 1.0)[item.joint :]
                rest = w[here, item.joint : moving.joint] @ size
            arms = [seen(single, item.joint, moving.joint, here) for single in placed]
            center = arms[0].point(moving.middle) - item.middle[:, None]
            # No plane gives a larger gap than the distance between the bodies' middles, so pairs with nearer
            # middles are skipped.
            apart = np.sqrt((center**2).sum(axis=0))
            least = margin[rows] + rest + _LEFT
            if np.isinf(item.bound):
                settled[rows] = _before(item, moving, arms[bent:]) >= least
                for row in rows[settled[rows]]:
                    self.planes[int(begin[row]), int(end[row]), int(bent)].append([one, 0, 0, 1])
                continue
            hope = np.flatnonzero(apart >= least)
            if not len(hope):
                continue
            turn = self.turns[item.joint]
            toward = center[:, hope] / np.maximum(apart[hope], 1e-12)
            # Normals must be integers: round to a coarse grid first, and to finer ones if that is not enough.
            for number, scale in enumerate((_SCALES[0], *_SCALES)):
                if number == 1:  # the direction from middle to middle is not sufficient
                    toward, _ = nearest(item, moving, arms[0].take(hope))
                normal = np.round(turn.T @ toward * scale)
                gap = _gap(item, moving, [arm.take(hope) for arm in arms[bent:]], turn @ normal)
                done = gap >= least[hope]
                settled[rows[hope[done]]] = True
                for row, values in zip(rows[hope[done]], normal[:, done].T.astype(np.int64), strict=True):
                    self.planes[int(begin[row]), int(end[row]), int(bent)].append([one, *values.tolist()])
                hope, toward = hope[~done], toward[:, ~done]
                if not len(hope):
                    break
        return settled

    def _slow(self, begin: Rows, end: Rows, pair: Rows) -> NDArray[np.bool_]:
        """Return a mask of the pairs of a body and a slow zone in which the body is slow enough for the zone,
        and store these pairs in `planes`.
        """
        nodes, at = np.unique(np.stack([begin, end]), axis=1, return_inverse=True)
        first, last = nodes[0] // PARTS, (nodes[1] - 1) // PARTS
        bounds = np.stack([first, last + 1], axis=1).ravel()
        w, a, j = (np.maximum.reduceat(one, bounds)[::2] for one in (self.w, self.a, self.j))
        d = (nodes[1] - nodes[0]) / PARTS * self.segments.h[first]
        ends = []
        for segment, place in ((first, nodes[0]), (last, nodes[1])):
            share = (place - segment * PARTS) / PARTS
            ends.append(
                motions(self.chain, self.segments.at(segment, share), self.segments.rate(segment, share))
            )
        slow = np.zeros(len(pair), dtype=np.bool_)
        for one in np.unique(pair).tolist():
            rows = np.flatnonzero(pair == one)
            # Compute placement and velocity of the body's link at both ends of the stretches.
            here, moving = at[rows], self.needed.items[self.needed.pairs[one][1]]
            k = moving.joint
            arms = [Joints(p[k, :, :3], p[k, :, 3], spin[k], drift[k]).take(here) for p, spin, drift in ends]
            bend = _third(self.reach[self.needed.pairs[one][1]], self.is_turn, w[here], a[here], j[here])
            # Between the ends, the speed exceeds the larger of both end speeds by at most d^2 / 8 times the
            # bound of the third derivative.
            most = np.maximum(arms[0].speed(moving), arms[1].speed(moving)) + bend * d[here] ** 2 / 8.0
            slow[rows] = most <= self.needed.speeds[one] * (1.0 - 1e-6)
            for row in rows[slow[rows]]:
                self.planes[int(begin[row]), int(end[row]), 2].append([one])
        return slow


def _third(reach: Array, is_turn: NDArray[np.bool_], w: Array, a: Array, j: Array) -> Array:
    """Return the checker's bound of the third derivatives of all points of a body (P,).

    It follows from the largest |velocity|, |acceleration| and |jerk| of the joints, `w`, `a` and `j` (P, n).
    """
    sum_w, sum_a, sum_j, before, bend = (np.zeros(len(w)) for _ in range(5))
    for joint in range(len(reach)):
        if not is_turn[joint]:
            # Let W, A and J be the sums of the rates of the joints before. They turn the displacement by a
            # prismatic joint with the rates w, a and j, which therefore adds 3 (W^2 + A) w + 3 W a + j
            # (Leibniz' rule).
            bend += 3.0 * (sum_w**2 + sum_a) * w[:, joint] + 3.0 * sum_w * a[:, joint] + j[:, joint]
            continue
        sum_w, sum_a, sum_j = sum_w + w[:, joint], sum_a + a[:, joint], sum_j + j[:, joint]
        upto = sum_w**3 + 3.0 * sum_w * sum_a + sum_j
        bend += reach[joint] * (upto - before)
        before = upto
    return bend


def _gap(item: Item, moving: Item, arms: list[Joints], normal: Array) -> Array:
    """Return the least gap (P,) [m] between two bodies along normals (3, P), over the instants in `arms`.

    The gap is minus infinity for a zero normal.
    """
    size = np.sqrt((normal**2).sum(axis=0))
    unit = normal / np.maximum(size, 1e-300)
    still = Joints(np.eye(3)[:, :, None], np.zeros((3, 1)), np.zeros((3, 1)), np.zeros((3, 1)))
    gaps = [arm.lowest(moving, unit) + still.lowest(item, -unit) for arm in arms]
    return np.where(size > 0.5, np.min(gaps, axis=0), -np.inf)


def _before(item: Item, moving: Item, arms: list[Joints]) -> Array:
    """Return the least distance (P,) [m] of a body from a border that it must not cross, over the instants in
    `arms`.
    """
    offset = float(item.axis @ item.middle)
    gaps = [
        offset + arm.lowest(moving, np.broadcast_to(-item.axis[:, None], arm.shift.shape)) for arm in arms
    ]
    found: Array = np.min(gaps, axis=0)
    return found


def _bend(reach: Array, is_turn: NDArray[np.bool_], first: int, last: int, w: Array, a: Array) -> Array:
    """Return the checker's bound of the second derivatives of all points of a body (P,).

    It follows from the largest |velocity| and |acceleration| of the joints, `w` and `a` (P, n).
    """
    sum_w, sum_a, before, bend = (np.zeros(len(w)) for _ in range(4))
    for joint in range(first, last):
        if not is_turn[joint]:
            # Let W be the sum of the velocities of the joints before. A prismatic joint with the velocity w
            # and the acceleration a adds its Coriolis acceleration 2 W w and a.
            bend += 2.0 * sum_w * w[:, joint] + a[:, joint]
            continue
        sum_w, sum_a = sum_w + w[:, joint], sum_a + a[:, joint]
        upto = sum_w**2 + sum_a
        bend += reach[joint] * (upto - before)
        before = upto
    return bend


def _reach(robot: Robot, item: Item, far: Array) -> Array:
    """Bound the distances [m] of a body's points from the axes of the joints that move it, as the checker
    does: one bound for each of these joints.
    """
    steps = steps_of(robot.chain)
    is_turn = axes_of(robot.chain).turn == 1.0
    frame = np.eye(4)
    for step in steps[: item.joint]:
        frame = frame @ step
    point, way = (np.linalg.inv(frame) @ np.append(item.middle, 1.0))[:3], item.bound * (1.0 + 1e-9)
    reach = np.zeros(item.joint)
    for joint in reversed(range(item.joint)):
        if is_turn[joint]:
            # Add the distance of the point from the joint's z axis. Go on from the foot of the perpendicular
            # on this axis.
            way += float(np.hypot(point[0], point[1]))
            reach[joint] = way
            point = np.array([0.0, 0.0, point[2]])
        else:
            way += float(far[joint])
        point = (steps[joint] @ np.append(point, 1.0))[:3]
    return reach


def _ended(numbers: Array) -> Array:
    """Return the rows followed by a copy of the last one, so that a stretch may end with the last row."""
    return np.concatenate([numbers, numbers[-1:]])


def planes_of(
    rows: Sequence[Moved], cell: dict[str, Any], items: list[Item], robot: Robot, map_lines: Sequence[str]
) -> Planes:
    """Return separating planes, in the checker's form, for all pairs of bodies that such planes keep apart,
    and the stretches of time during which conditions hold.

    Args:
        rows: the commands of the text, as the checker has read them.
        cell: the description of the bodies in the proof.
        items: these bodies, and the regions that zones keep bodies out of.
        robot: the arm.
        map_lines: lines of the text's map, among them those of path constraints (KEEP).
    """
    arm, told = Arm(exactly(told_arm(robot))), exactly(cell)
    timeline = Timeline(rows, arm)
    room = Room(told, arm, timeline.travel, map_lines)
    pairs = room.pairs(timeline.steps)
    segments, needed = Segments.of(rows, robot), Needed.of(items, pairs, ONE)
    if not len(segments.h) or not pairs:
        return []
    return _Search(segments, needed, robot, _Conditions(timeline, room, pairs)).found()
