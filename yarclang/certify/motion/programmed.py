"""Programmed paths of the moving frame over a parameter s from 0 to 1.

One object contains the paths of many commands of one kind.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.kinematics.rotations import cross_matrix
from yarclang.certify.motion.pose import axis_and_angle
from yarclang.frozen import frozen
from yarclang.robot.model import Array

Rows = NDArray[np.int64]

SMALLEST_CIRCLE = 1e-6
"""Three points define a circle only if their distances from each other [m] exceed this, and if the sine of
the angle at the first point exceeds it too.
"""


@frozen(eq=False)
class Motion:
    """Poses and velocities of moving frames at N instants ("points").

    Attributes:
        p: (N, 3) positions [m].
        velocity: (N, 3) velocities [m/s].
        rotation: (N, 3, 3) rotations.
        angular: (N, 3) angular velocities [rad/s].
        d: (P,) durations of the pieces between points of one command [s].
    """

    p: Array
    velocity: Array
    rotation: Array
    angular: Array
    d: Array


@frozen(eq=False)
class Poses:
    """N points of programmed paths.

    Attributes:
        p: (N, 3) positions [m].
        along: (N, 3) derivatives of the positions over s [m].
        rotation: (N, 3, 3) rotations.
        spin: (N, 3, 3) derivatives of the rotations over s.
    """

    p: Array
    along: Array
    rotation: Array
    spin: Array


@frozen(eq=False)
class Bounds:
    """Bounds of the derivatives over s of P parts of programmed paths.

    Attributes:
        position: (P, 4) first to fourth derivative of the position [m].
        rotation: (P, 4) first to fourth derivative of the rotation matrix in the Frobenius norm.
        position_jump: (P,) sum of the jumps of the position's third derivative; None: no jumps.
        rotation_jump: (P,) sum of the jumps of the rotation's third derivative; None: no jumps.
        straight: True if all derivatives of the position but the first are zero.
        everywhere: True if the bounds are valid for any s.
    """

    position: Array
    rotation: Array
    position_jump: Array | None = None
    rotation_jump: Array | None = None
    straight: bool = False
    everywhere: bool = False


class FramePaths(Protocol):
    """C programmed paths of moving frames in {B}.

    Beyond s = 0 and s = 1, the formulas of the paths continue.
    """

    @property
    def flange_from_moving(self) -> Array:
        """The moving frames on the flange (C, 4, 4)."""
        ...

    @property
    def goal(self) -> Array:
        """The ends of the paths (C, 4, 4)."""
        ...

    @property
    def lawful(self) -> NDArray[np.bool_]:
        """True for each path that is defined (C,). Nothing is proved about an undefined path."""
        ...

    def at(self, owner: Rows, s: Array) -> Poses:
        """Return one point for each parameter in `s` (N,), on the path with the index in `owner` (N,)."""
        ...

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:
        """Return bounds of the derivatives between the parameters `low` and `high` (P,), each for the path
        with the index in `owner` (P,).
        """
        ...

    def project(
        self, motion: Motion, owner: Rows, position: Array, angle: Array, share: Array | None = None
    ) -> tuple[Array, Array]:
        """Choose the path parameter s and its rate s' (N,) for each point of an executed motion.

        Any choice gives a valid proof; a good one gives a sharp bound.

        Args:
            motion: the points; those of one path are consecutive, in order of time.
            owner: (N,) path of each point.
            position: (C,) tolerance of the position [m], which weights the errors.
            angle: (C,) tolerance of the angle [rad], which weights the errors.
            share: (N,) approximate fraction of the path length of the frame's origin that is covered at each
                point, if known.
        """
        ...


@frozen(eq=False)
class Turns:
    """C rotations about fixed axes, each from an orientation R0 by an angle of at most pi.

    R(s) = R0 + sin(s theta) K R0 + (1 - cos(s theta)) K^2 R0 with K = [axis]x (Rodrigues).

    Attributes:
        start: (C, 3, 3) orientations R0.
        axis: (C, 3) unit axes.
        theta: (C,) angles [rad].
        once: (C, 3, 3) K R0.
        twice: (C, 3, 3) K^2 R0.
    """

    start: Array
    axis: Array
    theta: Array
    once: Array
    twice: Array

    @staticmethod
    def between(start: Array, goal: Array) -> Turns:
        """Return the rotations from orientations `start` to orientations `goal`, (C, 3, 3) each."""
        axis, theta = axis_and_angle(goal @ start.transpose(0, 2, 1))
        spin = cross_matrix(axis)
        once = spin @ start
        return Turns(start, axis, theta, once, spin @ once)

    def at(self, owner: Rows, s: Array) -> tuple[Array, Array]:
        """Return the orientations at `s` and their derivatives over s, (N, 3, 3) each."""
        # Compute R(s) by Rodrigues' formula, and its derivative over s.
        theta = self.theta[owner]
        phi = s * theta
        sin, cos = np.sin(phi)[:, None, None], np.cos(phi)[:, None, None]
        once, twice = self.once[owner], self.twice[owner]
        rotation = self.start[owner] + sin * once + (1.0 - cos) * twice
        return rotation, theta[:, None, None] * (cos * once + sin * twice)

    def bounds(self, owner: Rows) -> Array:
        """Return bounds (P, 4) of the Frobenius norms of the rotation's first four derivatives over s: sqrt 2
        theta^k for the k-th one, as the axis is fixed.
        """
        bounds: Array = np.sqrt(2.0) * self.theta[owner, None] ** np.arange(1.0, 5.0)
        return bounds

    def turned(self, rotation: Array, owner: Rows) -> Array:
        """Return the angles (N,) [rad] by which to turn from the start about the fixed axis to come nearest
        to `rotation` (N, 3, 3).
        """
        return _angle_about(rotation @ self.start.transpose(0, 2, 1)[owner], self.axis[owner])


@frozen(eq=False)
class Lines:
    """C straight lines of moving frames, each with a rotation about a fixed axis.

    Attributes:
        flange_from_moving: (C, 4, 4) moving frames, relative to the flange.
        goal: (C, 4, 4) goals.
        origin: (C, 3) start points [m].
        way: (C, 3) vectors from start to goal [m].
        turns: the rotations.
    """

    flange_from_moving: Array
    goal: Array
    origin: Array
    way: Array
    turns: Turns

    @staticmethod
    def between(start: Array, goal: Array, flange_from_moving: Array) -> Lines:
        """Return the lines between poses (C, 4, 4)."""
        turns = Turns.between(start[:, :3, :3], goal[:, :3, :3])
        return Lines(flange_from_moving, goal, start[:, :3, 3], goal[:, :3, 3] - start[:, :3, 3], turns)

    @property
    def lawful(self) -> NDArray[np.bool_]:
        """True (C,) for all lines: every line is defined."""
        return np.ones(len(self.way), dtype=np.bool_)

    def at(self, owner: Rows, s: Array) -> Poses:
        """Return one point for each parameter in `s` (N,), on the line with the index in `owner` (N,)."""
        way = self.way[owner]
        return Poses(self.origin[owner] + s[:, None] * way, way, *self.turns.at(owner, s))

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:  # noqa: ARG002 - for any s
        """Return bounds of the derivatives for any s; the position has only a first derivative."""
        position = np.zeros((len(owner), 4))
        position[:, 0] = np.linalg.norm(self.way, axis=1)[owner]
        return Bounds(position, self.turns.bounds(owner), straight=True, everywhere=True)

    def project(
        self,
        motion: Motion,
        owner: Rows,
        position: Array,
        angle: Array,
        share: Array | None = None,  # noqa: ARG002 - a closed form needs no guess
    ) -> tuple[Array, Array]:
        """Choose s by least squares of the errors of position and rotation, each divided by its tolerance."""
        turns = self.turns
        pull = self.way / position[:, None] ** 2
        twist_pull = turns.axis * (turns.theta / angle**2)[:, None]
        norm = (np.linalg.norm(self.way, axis=1) / position) ** 2 + (turns.theta / angle) ** 2
        norm[norm == 0.0] = np.inf  # the frame does not move: s = 0
        offset = motion.p - self.origin[owner]
        # Project the pose onto the line in a space with one more coordinate, the angle of rotation. Both are
        # in units of their tolerance.
        strength = turns.theta[owner] / angle[owner] ** 2
        s = np.einsum("ni,ni->n", offset, pull[owner]) + turns.turned(motion.rotation, owner) * strength
        rate = np.einsum("ni,ni->n", motion.velocity, pull[owner])
        rate = rate + np.einsum("ni,ni->n", motion.angular, twist_pull[owner])
        return s / norm[owner], rate / norm[owner]


@frozen(eq=False)
class Arcs:
    """C circular arcs of moving frames, each with a rotation about a fixed axis in proportion to the arc
    length.

    Attributes:
        flange_from_moving: (C, 4, 4) moving frames, relative to the flange.
        goal: (C, 4, 4) goals.
        centre: (C, 3) centres of the circles [m].
        normal: (C, 3) unit axes of the circles.
        spoke: (C, 3) vectors from the centre to the start [m].
        side: (C, 3) normal x spoke [m].
        sweep: (C,) angles of the arcs [rad].
        turns: the rotations.
        lawful: (C,) True for each arc whose points define a circle.
    """

    flange_from_moving: Array
    goal: Array
    centre: Array
    normal: Array
    spoke: Array
    side: Array
    sweep: Array
    turns: Turns
    lawful: NDArray[np.bool_]

    @staticmethod
    def through(start: Array, via: Array, goal: Array, flange_from_moving: Array) -> Arcs:
        """Return the arcs from poses `start` (C, 4, 4) through `via` (C, 3) [m] to poses `goal` (C, 4, 4)."""
        a, b = via - start[:, :3, 3], goal[:, :3, 3] - start[:, :3, 3]
        across = np.cross(a, b)
        sides = np.stack([np.linalg.norm(x, axis=1) for x in (a, b, b - a)])
        area = np.linalg.norm(across, axis=1)
        lawful = (sides.min(axis=0) > SMALLEST_CIRCLE) & (area > SMALLEST_CIRCLE * sides[0] * sides[1])
        safe = np.where(lawful, area, 1.0)[:, None]
        normal = across / safe
        # Let a and b be the vectors from the start to the via point and to the goal. The centre has equal
        # distances from all three points; Cramer's rule gives it in the plane of a and b.
        square_a, square_b = (a * a).sum(axis=1)[:, None], (b * b).sum(axis=1)[:, None]
        middle = (square_a * np.cross(b, normal) + square_b * np.cross(normal, a)) / (2.0 * safe)
        spoke = -middle
        side = np.cross(normal, spoke)
        to_goal = b - middle
        # Seen along the normal, the circle passes start, via and goal in this order, with a sweep below 2 pi.
        sweep = np.arctan2((to_goal * side).sum(axis=1), (to_goal * spoke).sum(axis=1)) % (2.0 * np.pi)
        turns = Turns.between(start[:, :3, :3], goal[:, :3, :3])
        centre = start[:, :3, 3] + middle
        return Arcs(flange_from_moving, goal, centre, normal, spoke, side, sweep, turns, lawful)

    def at(self, owner: Rows, s: Array) -> Poses:
        """Return one point for each parameter in `s` (N,), on the arc with the index in `owner` (N,)."""
        sweep = self.sweep[owner]
        phi = (s * sweep)[:, None]
        spoke, side = self.spoke[owner], self.side[owner]
        sin, cos = np.sin(phi), np.cos(phi)
        along = sweep[:, None] * (cos * side - sin * spoke)
        return Poses(self.centre[owner] + cos * spoke + sin * side, along, *self.turns.at(owner, s))

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:  # noqa: ARG002 - for any s
        """Return bounds of the derivatives, which are valid for any s: radius times sweep^k for the k-th
        derivative of the position.
        """
        radius = np.linalg.norm(self.spoke, axis=1)[owner, None]
        position = radius * self.sweep[owner, None] ** np.arange(1.0, 5.0)
        return Bounds(position, self.turns.bounds(owner), everywhere=True)

    def project(
        self,
        motion: Motion,
        owner: Rows,
        position: Array,
        angle: Array,
        share: Array | None = None,
    ) -> tuple[Array, Array]:
        """Choose s for each point of an executed motion, as the weighted mean of the s that fits the position
        and the s that fits the rotation.

        The weights are the squared lengths of the arc and of the rotation, each in units of its tolerance.
        """
        turns = self.turns
        # Compute the squared lengths of the arc and of the rotation, each in units of its tolerance.
        square = np.einsum("ci,ci->c", self.spoke, self.spoke)
        weight = square * (self.sweep / position) ** 2
        turn_weight = (turns.theta / angle) ** 2
        norm = np.maximum(weight + turn_weight, 1e-300)
        offset = motion.p - self.centre[owner]
        x = np.einsum("ni,ni->n", offset, self.spoke[owner])
        y = np.einsum("ni,ni->n", offset, self.side[owner])
        phi = _unwrapped(np.arctan2(y, x), owner)
        # The angle about the axis n changes at the rate (n x offset) . v / |offset|^2.
        tangent = np.cross(self.normal[owner], offset)
        # Both `x` and `y` are coordinates times the radius. Divide by its square to get the squared distance
        # from the axis.
        reach = np.maximum((x * x + y * y) / np.maximum(square[owner], 1e-300), 1e-300)
        phi_rate = np.einsum("ni,ni->n", motion.velocity, tangent) / reach
        share = np.where(self.lawful, weight / norm / np.where(self.lawful, self.sweep, 1.0), 0.0)
        turn_share = np.where(turns.theta > 0.0, turn_weight / norm / np.maximum(turns.theta, 1e-300), 0.0)
        turned = turns.turned(motion.rotation, owner)
        turn_rate = np.einsum("ni,ni->n", motion.angular, turns.axis[owner])
        s = phi * share[owner] + turned * turn_share[owner]
        return s, phi_rate * share[owner] + turn_rate * turn_share[owner]


def _unwrapped(angle: Array, owner: Rows) -> Array:
    """Return angles (N,) without jumps by full turns; the first of each path is in [-pi / 2, 3 pi / 2)."""
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    smooth = np.unwrap(angle)
    # Count the full turns by which the first angle of each path is outside of [-pi / 2, 3 pi / 2).
    whole = np.floor((smooth[first] + np.pi / 2.0) / (2.0 * np.pi)) * 2.0 * np.pi
    count = np.diff(np.append(first, len(angle)))
    flat: Array = smooth - np.repeat(whole, count)
    return flat


def _angle_about(rotation: Array, axis: Array) -> Array:
    """Return the angle (N,) [rad] of the rotation about `axis` (N, 3) that is nearest to `rotation` (N, 3,
    3).

    "Nearest" is in the Frobenius norm. With vee the vector of R - R' (R' is the transpose), the trace of
    R' turn(angle) is largest for tan(angle) = (axis . vee) / (trace R - axis' R axis).
    """
    along = np.einsum("ni,nij,nj->n", axis, rotation, axis)
    across = np.trace(rotation, axis1=1, axis2=2) - along
    vee = np.stack(
        [
            rotation[:, 2, 1] - rotation[:, 1, 2],
            rotation[:, 0, 2] - rotation[:, 2, 0],
            rotation[:, 1, 0] - rotation[:, 0, 1],
        ],
        axis=1,
    )
    angle: Array = np.arctan2(np.einsum("ni,ni->n", axis, vee), across)
    return angle


def goal_pose(goal: hir.PoseGoal | hir.PoseDelta, base_from_flange: Array) -> tuple[Array, Array]:
    """Return the poses of the moving frame at the start and at the end of a line.

    Args:
        goal: the programmed goal.
        base_from_flange: (4, 4) flange at the start of the line.

    Returns:
        base_from_moving (4, 4) at the start and at the goal.
    """
    start = base_from_flange @ goal.flange_from_moving
    if isinstance(goal, hir.PoseGoal):
        return start, goal.base_from_moving
    axes = base_from_flange[:3, :3] @ goal.axes if goal.axes_on_flange else goal.axes
    pose = start.copy()
    pose[:3, :3] = axes @ goal.turn @ axes.T @ start[:3, :3]
    pose[:3, 3] = start[:3, 3] + axes @ goal.shift
    return start, pose
