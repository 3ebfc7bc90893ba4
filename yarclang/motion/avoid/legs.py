"""Follow straight lines of the moving frame among obstacles, and find how far along each line the arm stays
free of collisions.

All lines turn the frame about the one axis about which it turns from start to goal. A place of the frame is
therefore four numbers: a position, and a share of this turn.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.room import TOUCH, Room, reaches
from yarclang.motion.cartesian import CartesianPath, along
from yarclang.motion.paths.line import Line, line_between
from yarclang.motion.rotation import turned
from yarclang.progress import go_on
from yarclang.robot.kinematics.singularity import smallest_singular_values
from yarclang.transforms import constant, pose_matrix, roll_pitch_yaw
from yarclang.units import DEG, MM

LEVER = 0.25
"""Distance that a turn of 1 rad counts for in the length of a leg [m]."""

_AT_ONCE = 24
"""Places of a leg that are checked together: most blocked legs are blocked soon."""

_FINEST = 1e-3
"""Approximate motion of bodies between two places of a proved leg below which no place is added [m]."""

_PROVED = 1e-3
"""Distance in addition to the margins that a proved leg keeps [m]: the executed motion may deviate by
this.
"""

_COARSE = 0.02
"""Approximate motion of bodies between two places of a leg that is to be proved [m], before places are
added.
"""

_FINE_MM, _FINE_DEG = 1, 2
"""Decimals of the poses found."""

SHORTEST = 0.005
"""Shortest part of a leg that is of use [m]."""

_BACK = 0.01
"""Distance from what is in the way at which a part of a leg ends [m]."""


@frozen(eq=False)
class Stand:
    """A place of the moving frame, and the arm's joint position there.

    `x` (4,) is the position [m] and the share of the turn; `q` (n,) is the joint position [rad or m].
    """

    x: Array
    q: Array


@frozen(eq=False)
class Leg:
    """A straight line of the moving frame, cut where it stops being free of collisions.

    `path` leads to the place `x` (4,), which is the share `reached` of the line that was asked for.
    """

    path: CartesianPath
    x: Array
    reached: float

    @property
    def end(self) -> Stand:
        """The place of the frame and the joint position at which the leg ends."""
        return Stand(self.x, self.path.end)


@dataclass(slots=True)
class Legs:
    """Maker of straight lines ("legs") between places of the moving frame, among the obstacles of a room.

    Attributes:
        room: the surroundings of the arm.
        line: the straight line from start to goal.
        more: (K,) largest distance that pairs of bodies may be asked to keep in addition to their margins
            [m].
        floor: smallest singular value of the Jacobian that is allowed along a leg.
        left: number of legs that may still be followed.
    """

    room: Room
    line: Line
    more: Array
    floor: float
    left: int
    followed: int = 0
    _padded: dict[float, Room] = field(default_factory=dict)

    def pose(self, x: Array) -> Array:
        """Return the pose (4, 4) of the moving frame for a place (4,): a position and a share of the turn."""
        line = self.line
        if (x == self.goal).all():
            return line.base_from_end
        pose = np.eye(4)
        pose[:3, 3] = x[:3]
        pose[:3, :3] = turned(line.base_from_start[:3, :3], line.axis, np.array([x[3] * line.angle]))[0]
        return pose

    @property
    def start(self) -> Array:
        """The place (4,) of the moving frame at the start of the line."""
        return np.append(self.line.base_from_start[:3, 3], 0.0)

    @property
    def goal(self) -> Array:
        """The place (4,) of the moving frame at the end of the line."""
        return np.append(self.line.base_from_end[:3, 3], 1.0)

    @property
    def scale(self) -> Array:
        """The weights (4,) [m] of the four numbers of a place in the distance between two places: 1 for the
        position, and a lever times the whole angle for the share of the turn.
        """
        return np.array([1.0, 1.0, 1.0, max(LEVER * self.line.angle, 1e-6)])

    def length(self, x: Array, other: Array) -> float:
        """Return the distance between two places of the moving frame [m]; a turn counts by a lever."""
        return float(np.linalg.norm((other - x) * self.scale))

    def path(self, stand: Stand, x: Array) -> CartesianPath | float:
        """Return the arm's path along the straight line from a stand to the place `x`, without regard to
        obstacles.

        If the arm can't follow the whole line, return the share of the line that it can follow.
        """
        self.left -= 1
        self.followed += 1
        return self.between(self.pose(stand.x), self.pose(x), stand.q)

    def between(self, pose: Array, end: Array, q: Array) -> CartesianPath | float:
        """Return the arm's path along the straight line between two poses (4, 4) of the moving frame.

        The arm is at `q` (n,) at the first pose. If it can't follow the whole line, return the share that it
        can.
        """
        go_on()
        frame = line_between(pose, end)
        if frame is None:
            return 0.0
        robot = self.room.robot
        path = along(robot.chain, robot.limits, self.room.flange_from_moving, frame, q, reason="any")
        return path if isinstance(path, CartesianPath) else path.s

    def leg(self, stand: Stand, x: Array, padding: float, step: float, *, whole: bool = False) -> Leg | None:
        """Return the leg from a stand towards a place, as far as it is free of collisions; None if the free
        part is too short.

        Args:
            stand: where the leg begins.
            x: (4,) the place to which it leads.
            padding: distance that bodies keep in addition to their margins, if they do so at start and goal
                [m].
            step: approximate motion of bodies between two places that are checked [m].
            whole: True if only the whole leg is of use, not a part of it.
        """
        share = 1.0
        path = self.path(stand, x)
        if not isinstance(path, CartesianPath):
            if whole or path * self.length(stand.x, x) < SHORTEST:
                return None
            share = 0.95 * path
            path = self.path(stand, stand.x + share * (x - stand.x))
            if not isinstance(path, CartesianPath):
                return None
        free = self._free_until(path, self.padded(padding), step)
        if free < 1.0:
            free = max(free - _BACK / max(self.length(stand.x, x), 1e-9), 0.0)
            if whole or free * share * self.length(stand.x, x) < SHORTEST:
                return None
            share *= free
            path = self.path(stand, stand.x + share * (x - stand.x))
            if not isinstance(path, CartesianPath):
                return None
        return Leg(path, x if share == 1.0 else stand.x + share * (x - stand.x), share)

    def padded(self, padding: float) -> Room:
        """Return the room in which each pair of bodies keeps `padding` in addition to its margin, at most
        its `more`.
        """
        if padding not in self._padded:
            scene = self.room.scene
            margin = scene.pairs.margin + np.minimum(self.more, padding)
            self._padded[padding] = replace(
                self.room, scene=replace(scene, pairs=replace(scene.pairs, margin=margin))
            )
        return self._padded[padding]

    def _free_until(self, path: CartesianPath, room: Room, step: float) -> float:
        """Return the last place s before the first check that finds a collision or a singularity; 1 if
        none does.
        """
        places = self._places(path, step)
        for begin in range(0, len(places), _AT_ONCE):
            s = places[begin : begin + _AT_ONCE]
            q = path.joints(s)
            bad = (room.clearances(q, TOUCH) <= 0.0) | (self._singular(q) < self.floor)
            if bad.any():
                first = begin + int(np.argmax(bad))
                return float(places[first - 1]) if first else 0.0
        return 1.0

    def _singular(self, q: Array) -> Array:
        return smallest_singular_values(self.room.robot.chain, q, self.room.flange_from_moving)

    def _places(self, path: CartesianPath, step: float) -> Array:
        """Return places s along a path, about `step` [m] of body motion apart; the start isn't included."""
        track = path.followed
        moves = np.abs(np.diff(track.q, axis=0)) @ reaches(self.room.scene, self.room.robot)
        gone = np.concatenate(([0.0], np.cumsum(moves)))
        count = max(int(np.ceil(gone[-1] / step)), 1)
        places: Array = np.interp(np.linspace(0.0, gone[-1], count + 1)[1:], gone, track.s)
        places[-1] = 1.0
        return places

    def is_proved(self, path: CartesianPath) -> bool:
        """Return True if a path is proved to be free of collisions: at places close enough together, the
        clearance is larger than the distance that bodies can move from one place to the next.
        """
        room, reach = self.padded(_PROVED), reaches(self.room.scene, self.room.robot)
        s = np.concatenate(([0.0], self._places(path, _COARSE)))
        q = path.joints(s)
        left = room.clearances(q, _COARSE)
        if (left[1:] <= 0.0).any() or (self._singular(q) < self.floor).any():
            return False
        while True:
            moves = np.abs(np.diff(q, axis=0)) @ reach
            open_ = (np.minimum(left[1:], left[:-1]) < moves) & (moves > _FINEST)
            if not open_.any():
                return True
            at = np.flatnonzero(open_)
            go_on()
            between = (s[at] + s[at + 1]) / 2.0
            added = path.joints(between)
            clear = room.clearances(added, _COARSE)
            if (clear <= 0.0).any():
                return False
            s, q, left = (
                np.insert(old, at + 1, new, axis=0) for old, new in ((s, between), (q, added), (left, clear))
            )

    def rounded(self, x: Array) -> Array:
        """Return the pose (4, 4) of the moving frame at a place (4,), rounded to few decimals in mm and
        deg.
        """
        pose = self.pose(x)
        if (x == self.goal).all():
            return pose
        position = np.round(pose[:3, 3] / MM, _FINE_MM) * MM
        angles = np.round(roll_pitch_yaw(pose[:3, :3]) / DEG, _FINE_DEG) * DEG
        return constant(pose_matrix([*position.tolist(), *angles.tolist()]))
