"""Programmed paths of the moving frame over s from 0 to 1: many commands of a kind in one."""

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
"""Three points nearer to each other [m], or to a line [rad], than this say no circle."""


@frozen(eq=False)
class Motion:
    """Moving frames at points of time: position p (N, 3), rotation (N, 3, 3), and the velocities of both (N, 3). `d` (P,) are the times
    between them [s], of those that belong together.
    """

    p: Array
    velocity: Array
    rotation: Array
    angular: Array
    d: Array


@frozen(eq=False)
class Poses:
    """Points of programmed paths: position p (N, 3), rotation (N, 3, 3), and their derivatives over s."""

    p: Array
    along: Array
    rotation: Array
    spin: Array


@frozen(eq=False)
class Bounds:
    """Bounds of derivatives over s: the first to the fourth of the position (P, 4) [m] and of the rotation matrix in the Frobenius
    norm (P, 4); how much the third of each jumps (P,), added up. `straight` says that all but the first of the position are zero,
    `everywhere` that the bounds hold for any s.
    """

    position: Array
    rotation: Array
    position_jump: Array | None = None
    rotation_jump: Array | None = None
    straight: bool = False
    everywhere: bool = False


class FramePaths(Protocol):
    """C programmed paths of moving frames, which sit at `flange_from_moving` (C, 4, 4) and go to `goal` (C, 4, 4)
    in {B}. Beyond 0 and 1 they go on as they are. A path that isn't defined is not `lawful` (C,): nothing is proved of it.
    """

    @property
    def flange_from_moving(self) -> Array:
        """Where the frames sit (C, 4, 4)."""
        ...

    @property
    def goal(self) -> Array:
        """Where the paths end (C, 4, 4)."""
        ...

    @property
    def lawful(self) -> NDArray[np.bool_]:
        """Which paths are defined (C,)."""
        ...

    def at(self, owner: Rows, s: Array) -> Poses:
        """The paths `owner` (N,) at `s` (N,)."""
        ...

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:
        """Bounds between `low` and `high` (P,) of the paths `owner` (P,)."""
        ...

    def project(
        self, motion: Motion, owner: Rows, position: Array, angle: Array, share: Array | None = None
    ) -> tuple[Array, Array]:
        """A good s and s' for each point of an executed motion (N,); any would be lawful.

        Args:
            motion: the points, those of one path behind each other in order of time.
            owner: (N,) whose they are.
            position: (C,) [m] and
            angle: (C,) [rad] what counts as much as what.
            share: (N,) about how much of the way of the frame's origin lies behind it, if that is known.
        """
        ...


@frozen(eq=False)
class Turns:
    """C turns from the rotations `start` (C, 3, 3) by `theta` (C,) [rad] about `axis` (C, 3), the short way.

    R(s) = R0 + sin(s theta) K R0 + (1 - cos(s theta)) K^2 R0 with K = [axis]x; `once` is K R0, `twice` K^2 R0.
    """

    start: Array
    axis: Array
    theta: Array
    once: Array
    twice: Array

    @staticmethod
    def between(start: Array, goal: Array) -> Turns:
        """The turns between rotations (C, 3, 3)."""
        axis, theta = axis_and_angle(goal @ start.transpose(0, 2, 1))
        spin = cross_matrix(axis)
        once = spin @ start
        return Turns(start, axis, theta, once, spin @ once)

    def at(self, owner: Rows, s: Array) -> tuple[Array, Array]:
        """Rotations and their derivatives over s, (N, 3, 3) each."""
        theta = self.theta[owner]
        phi = s * theta
        sin, cos = np.sin(phi)[:, None, None], np.cos(phi)[:, None, None]
        once, twice = self.once[owner], self.twice[owner]
        rotation = self.start[owner] + sin * once + (1.0 - cos) * twice
        return rotation, theta[:, None, None] * (cos * once + sin * twice)

    def bounds(self, owner: Rows) -> Array:
        """A turn about a fixed axis: sqrt 2 theta^k."""
        bounds: Array = np.sqrt(2.0) * self.theta[owner, None] ** np.arange(1.0, 5.0)
        return bounds

    def turned(self, rotation: Array, owner: Rows) -> Array:
        """The angle (N,) about the axis that comes nearest to `rotation` (N, 3, 3) [rad]."""
        return _angle_about(rotation @ self.start.transpose(0, 2, 1)[owner], self.axis[owner])


@frozen(eq=False)
class Lines:
    """Straight lines from `origin` (C, 3) by `way` (C, 3) [m], turning about one fixed axis."""

    flange_from_moving: Array
    goal: Array
    origin: Array
    way: Array
    turns: Turns

    @staticmethod
    def between(start: Array, goal: Array, flange_from_moving: Array) -> Lines:
        """The lines between poses (C, 4, 4)."""
        turns = Turns.between(start[:, :3, :3], goal[:, :3, :3])
        return Lines(flange_from_moving, goal, start[:, :3, 3], goal[:, :3, 3] - start[:, :3, 3], turns)

    @property
    def lawful(self) -> NDArray[np.bool_]:
        """Every line is one."""
        return np.ones(len(self.way), dtype=np.bool_)

    def at(self, owner: Rows, s: Array) -> Poses:
        """The lines `owner` at `s`."""
        way = self.way[owner]
        return Poses(self.origin[owner] + s[:, None] * way, way, *self.turns.at(owner, s))

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:  # noqa: ARG002 - for any s
        """The same everywhere: of the position only the first derivative isn't zero."""
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
        """Least squares of both errors, each against its tolerance."""
        turns = self.turns
        pull = self.way / position[:, None] ** 2
        twist_pull = turns.axis * (turns.theta / angle**2)[:, None]
        norm = (np.linalg.norm(self.way, axis=1) / position) ** 2 + (turns.theta / angle) ** 2
        norm[norm == 0.0] = np.inf  # it shall stand still: s = 0
        offset = motion.p - self.origin[owner]
        strength = turns.theta[owner] / angle[owner] ** 2
        s = np.einsum("ni,ni->n", offset, pull[owner]) + turns.turned(motion.rotation, owner) * strength
        rate = np.einsum("ni,ni->n", motion.velocity, pull[owner])
        rate = rate + np.einsum("ni,ni->n", motion.angular, twist_pull[owner])
        return s / norm[owner], rate / norm[owner]


@frozen(eq=False)
class Arcs:
    """Arcs by `sweep` (C,) [rad] about `normal` (C, 3) through `centre` (C, 3) [m], turning about one fixed axis in step.

    `spoke` (C, 3) leads from the centre to the start, `side` (C, 3) is normal x spoke.
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
        """The arcs from the poses `start` (C, 4, 4) through the points `via` (C, 3) to the poses `goal` (C, 4, 4)."""
        a, b = via - start[:, :3, 3], goal[:, :3, 3] - start[:, :3, 3]
        across = np.cross(a, b)
        sides = np.stack([np.linalg.norm(x, axis=1) for x in (a, b, b - a)])
        area = np.linalg.norm(across, axis=1)
        lawful = (sides.min(axis=0) > SMALLEST_CIRCLE) & (area > SMALLEST_CIRCLE * sides[0] * sides[1])
        safe = np.where(lawful, area, 1.0)[:, None]
        normal = across / safe
        # the centre is at equal distances from all three: Cramer's rule in the plane of a and b
        square_a, square_b = (a * a).sum(axis=1)[:, None], (b * b).sum(axis=1)[:, None]
        middle = (square_a * np.cross(b, normal) + square_b * np.cross(normal, a)) / (2.0 * safe)
        spoke = -middle
        side = np.cross(normal, spoke)
        to_goal = b - middle
        # by a circle's chord through three points in this order, the normal turns start past via to the goal
        sweep = np.arctan2((to_goal * side).sum(axis=1), (to_goal * spoke).sum(axis=1)) % (2.0 * np.pi)
        turns = Turns.between(start[:, :3, :3], goal[:, :3, :3])
        centre = start[:, :3, 3] + middle
        return Arcs(flange_from_moving, goal, centre, normal, spoke, side, sweep, turns, lawful)

    def at(self, owner: Rows, s: Array) -> Poses:
        """The arcs `owner` at `s`."""
        sweep = self.sweep[owner]
        phi = (s * sweep)[:, None]
        spoke, side = self.spoke[owner], self.side[owner]
        sin, cos = np.sin(phi), np.cos(phi)
        along = sweep[:, None] * (cos * side - sin * spoke)
        return Poses(self.centre[owner] + cos * spoke + sin * side, along, *self.turns.at(owner, s))

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:  # noqa: ARG002 - for any s
        """Radius times angle^k."""
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
        """The mean of where position and turn say that the frame is, each by its length against its tolerance."""
        turns = self.turns
        square = np.einsum("ci,ci->c", self.spoke, self.spoke)
        weight = square * (self.sweep / position) ** 2
        turn_weight = (turns.theta / angle) ** 2
        norm = np.maximum(weight + turn_weight, 1e-300)
        offset = motion.p - self.centre[owner]
        x = np.einsum("ni,ni->n", offset, self.spoke[owner])
        y = np.einsum("ni,ni->n", offset, self.side[owner])
        phi = _unwrapped(np.arctan2(y, x), owner)
        tangent = np.cross(self.normal[owner], offset)
        # squared distance from the axis
        reach = np.maximum((x * x + y * y) / np.maximum(square[owner], 1e-300), 1e-300)
        phi_rate = np.einsum("ni,ni->n", motion.velocity, tangent) / reach
        share = np.where(self.lawful, weight / norm / np.where(self.lawful, self.sweep, 1.0), 0.0)
        turn_share = np.where(turns.theta > 0.0, turn_weight / norm / np.maximum(turns.theta, 1e-300), 0.0)
        turned = turns.turned(motion.rotation, owner)
        turn_rate = np.einsum("ni,ni->n", motion.angular, turns.axis[owner])
        s = phi * share[owner] + turned * turn_share[owner]
        return s, phi_rate * share[owner] + turn_rate * turn_share[owner]


def _unwrapped(angle: Array, owner: Rows) -> Array:
    """Angles (N,) without jumps by a whole turn; each path's first is in (-pi / 2, 3 pi / 2]."""
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    smooth = np.unwrap(angle)
    whole = np.floor((smooth[first] + np.pi / 2.0) / (2.0 * np.pi)) * 2.0 * np.pi
    count = np.diff(np.append(first, len(angle)))
    flat: Array = smooth - np.repeat(whole, count)
    return flat


def _angle_about(rotation: Array, axis: Array) -> Array:
    """The turn about `axis` (N, 3) that comes nearest to `rotation` (N, 3, 3) in the Frobenius norm [rad]."""
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
    """Where a line starts and ends.

    Args:
        goal: the programmed goal.
        base_from_flange: (4, 4) where the flange is when the line starts.

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
