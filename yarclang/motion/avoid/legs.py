"""Follow straight lines of the moving frame among obstacles, and find how far along each line the arm stays
free of collisions.

While the frame moves on such lines, it rotates only about one fixed axis: the one about which it rotates from
start to goal. A place of the frame is therefore given by four numbers: the three coordinates of its position,
and the completed share of this rotation.
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
"""Lever arm by which a rotation is converted into a length [m/rad]."""

_AT_ONCE = 24
"""Number of places on a leg that are checked together. It is small, because most blocked legs are blocked
near their beginning.
"""

_FINEST = 1e-3
"""Approximate motion of bodies [m] from one place to the next below which a proof adds no place between
them.
"""

_PROVED = 1e-3
"""Distance that a proved leg keeps in addition to the margins [m]. The executed motion may deviate by this
distance.
"""

_COARSE = 0.02
"""Approximate motion of bodies from one place to the next at the beginning of a proof [m]. More places are
added where they are needed.
"""

_FINE_MM, _FINE_DEG = 1, 2
"""Number of decimals to which poses are rounded: of the position in mm, and of the angles in deg."""

SHORTEST = 0.005
"""Least length of a shortened leg [m]; shorter ones are dropped."""

_BACK = 0.01
"""Distance from the obstruction at which a shortened leg ends [m]."""


@frozen(eq=False)
class Stand:
    """A place of the moving frame, and the arm's joint position at this place.

    `x` (4,) is the position [m] and the completed share of the rotation. `q` (n,) is the joint position [rad
    or m].
    """

    x: Array
    q: Array


@frozen(eq=False)
class Leg:
    """A straight line of the moving frame, cut where it stops being free of collisions.

    `path` ends at the place `x` (4,). `reached` is the share of the requested line that `path` covers.
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
        more: (K,) for each pair of bodies, the largest distance that it may be asked to keep in addition
            to its margin [m].
        floor: smallest singular value of the Jacobian that is allowed along a leg.
        left: number of legs that may be followed until the search ends.
    """

    room: Room
    line: Line
    more: Array
    floor: float
    left: int
    followed: int = 0
    _padded: dict[float, Room] = field(default_factory=dict)

    def pose(self, x: Array) -> Array:
        """Return the pose (4, 4) of the moving frame at a place (4,)."""
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
        """The weights (4,) by which `length` multiplies the difference of two places.

        The three coordinates have the weight 1. The fourth number is the completed share of the rotation. Its
        weight converts this share into a length [m], with the lever arm `LEVER`.
        """
        return np.array([1.0, 1.0, 1.0, max(LEVER * self.line.angle, 1e-6)])

    def length(self, x: Array, other: Array) -> float:
        """Return the distance between two places of the moving frame [m]. A rotation is converted into a
        length by `LEVER`.
        """
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

        The arm is at `q` (n,) at the first pose. If the arm can't follow the whole line, return the share of
        the line that it can follow.
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
            x: (4,) the place at which the requested leg ends.
            padding: distance that bodies keep in addition to their margins [m]; less for pairs that are
                close to each other at the start or at the goal.
            step: approximate motion of bodies from one checked place to the next [m].
            whole: True to return None unless the whole leg is free.
        """
        share = 1.0
        path = self.path(stand, x)
        if not isinstance(path, CartesianPath):
            if whole or path * self.length(stand.x, x) < SHORTEST:
                return None
            # The arm can't follow the whole line: end the leg shortly before the place where it fails.
            share = 0.95 * path
            path = self.path(stand, stand.x + share * (x - stand.x))
            if not isinstance(path, CartesianPath):
                return None
        free = self._free_until(path, self.padded(padding), step)
        if free < 1.0:
            # End the leg at some distance from the obstruction.
            free = max(free - _BACK / max(self.length(stand.x, x), 1e-9), 0.0)
            if whole or free * share * self.length(stand.x, x) < SHORTEST:
                return None
            share *= free
            path = self.path(stand, stand.x + share * (x - stand.x))
            if not isinstance(path, CartesianPath):
                return None
        return Leg(path, x if share == 1.0 else stand.x + share * (x - stand.x), share)

    def padded(self, padding: float) -> Room:
        """Return the room with enlarged margins: each pair's margin is larger by `padding` [m], but at most
        by the pair's value in `more`.
        """
        if padding not in self._padded:
            scene = self.room.scene
            margin = scene.pairs.margin + np.minimum(self.more, padding)
            self._padded[padding] = replace(
                self.room, scene=replace(scene, pairs=replace(scene.pairs, margin=margin))
            )
        return self._padded[padding]

    def _free_until(self, path: CartesianPath, room: Room, step: float) -> float:
        """Return the progress s of the last checked place before the first collision or singularity; 1 if
        there is neither.
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
        """Return the progress s of places on a path that are about `step` [m] of body motion apart. The start
        isn't included.
        """
        track = path.followed
        moves = np.abs(np.diff(track.q, axis=0)) @ reaches(self.room.scene, self.room.robot)
        gone = np.concatenate(([0.0], np.cumsum(moves)))
        count = max(int(np.ceil(gone[-1] / step)), 1)
        places: Array = np.interp(np.linspace(0.0, gone[-1], count + 1)[1:], gone, track.s)
        places[-1] = 1.0
        return places

    def is_proved(self, path: CartesianPath) -> bool:
        """Return True if a path is proved to be free of collisions.

        The proof examines places along the path. It succeeds if the clearance at each place is larger than
        the distance that bodies can move on the way to the next place. As long as a clearance is too small,
        places are added.
        """
        room, reach = self.padded(_PROVED), reaches(self.room.scene, self.room.robot)
        s = np.concatenate(([0.0], self._places(path, _COARSE)))
        q = path.joints(s)
        left = room.clearances(q, _COARSE)
        if (left[1:] <= 0.0).any() or (self._singular(q) < self.floor).any():
            return False
        while True:
            moves = np.abs(np.diff(q, axis=0)) @ reach
            # The clearance changes by at most the bodies' motion: a step is proved if the clearances at both
            # of its ends exceed this motion.
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
