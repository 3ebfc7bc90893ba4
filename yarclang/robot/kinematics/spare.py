"""Solve arms with one spare joint in closed form: all solutions of a pose for given positions of that joint.

With one joint held at a given position, two kinds of arms with seven joints have a closed form:

- The held joint is the first or the last (a rail under an arm, or a turn after its flange), and the other six
  joints are an arm of `closed_form`.
- All joints turn, the last three axes meet (the wrist centre), and two of the first four axes meet. Either
  axes 1 and 2 meet, and joint 3 is held (a spherical shoulder, as in LBR iiwa); or axes 2 and 3 meet, and
  joint 1 is held.

The second kind is solved in three steps. The two axes that meet before the wrist have a meeting point; the
distance of the wrist centre from this point gives the fourth angle (subproblem 3). The direction of the wrist
centre gives the angles about the two meeting axes (subproblem 2). The remaining rotation gives the wrist's
angles. An arm whose first three axes meet (Panda, xArm 7) is of this kind if it is read from its flange. The
decomposition is that of Elias and Wen, IK-Geo (Mechanism and Machine Theory 209, 2025), "spherical wrist, two
intersecting".
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.closed_form import closed_form
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.kinematics.geometry import (
    TOLERANCE,
    Form,
    WristAngles,
    form_of,
    frame_of,
    meeting_point,
    wrist_angles_of,
)
from yarclang.robot.kinematics.wrist import HOLD, REACH_TOLERANCE, TURN, held, wrist_angles
from yarclang.robot.model import Array, Chain
from yarclang.transforms import sealed

APART = 1e-3
"""Axes and points that are nearer to each other than this distance [m], or axes at a smaller angle than this
[rad], don't determine a solution.
"""

BRANCHES = 8


@frozen(eq=False)
class HeldAtEnd:
    """An arm of seven joints whose first or last joint, `joint` (0 or 6), is held at a given position; the
    other six joints have the closed form `arm`.

    `screw` (6,) is the screw of the held joint: in {B} if it is the first, in the flange if it is the last.
    """

    joint: int
    screw: Array
    arm: Form


@frozen(eq=False)
class HeldWithin:
    """An arm of seven turning joints with a wrist; a joint before the wrist is held at a given position.

    The arm is read from the base, or from the flange if `is_reversed` is True. All other fields describe the
    chain as it is read, with all joints at zero.

    Attributes:
        is_reversed: True if the arm is read from the flange to the base.
        held: number of the held joint, counted from 0: 0 or 2.
        pair: the two joints whose axes meet in `meeting`.
        axes: (7, 3) directions of the joints' axes.
        points: (7, 3) a point on each axis [m].
        meeting: (3,) point in which the axes of `pair` meet [m].
        centre: (3,) wrist centre: the meeting point of the axes of joints 4 to 6 [m]. Joint 3 bends the arm.
        home: (4, 4) pose of the chain's tip.
        fourth: (3, 3) frame of the wrist's first axis.
        sixth: (3, 3) frame of the wrist's last axis.
        angles: angles between the wrist's axes.
        crosses: (7, 3, 3) cross product matrices of the axes.
    """

    is_reversed: bool
    held: int
    pair: tuple[int, int]
    axes: Array
    points: Array
    meeting: Array
    centre: Array
    home: Array
    fourth: Array
    sixth: Array
    angles: WristAngles
    crosses: Array

    @property
    def joint(self) -> int:
        """The number of the held joint, counted from the base."""
        return 6 - self.held if self.is_reversed else self.held


SpareForm = HeldAtEnd | HeldWithin


@lru_cache(maxsize=256)
def spare_form(chain: Chain) -> SpareForm | None:
    """Return the closed form of an arm of seven joints with one of them held at a given position, or None if
    the arm has none; cached by the chain's identity.
    """
    if chain.size != 7:
        return None
    return _at_end(chain) or _within(chain, is_reversed=False) or _within(chain, is_reversed=True)


def solutions_with(
    form: SpareForm, base_from_flange: Array, values: Array, hold: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Find all solutions of a pose for given positions of the held joint, without regard to limits.

    Args:
        form: the arm.
        base_from_flange: (4, 4).
        values: (N,) positions of the held joint [rad or m].
        hold: (7,) [rad or m], the values for joints that a singularity leaves free.

    Returns:
        q (BRANCHES, N, 7) [rad or m], turns in (-pi, pi] except for the held joint, and a mask (BRANCHES, N)
        of the entries that reach the pose.
    """
    if isinstance(form, HeldAtEnd):
        return _solved_at_end(form, base_from_flange, values, hold)
    if form.is_reversed:
        base_from_flange, hold = _back(base_from_flange), hold[::-1]
    q, valid = _solved_within(form, base_from_flange, values, hold)
    if form.is_reversed:
        q = q[::-1]
    q = q.transpose(1, 2, 0)
    return np.ascontiguousarray(q), valid


def _at_end(chain: Chain) -> HeldAtEnd | None:
    """Return the closed form with the first or the last joint held, or None if the other six joints have no
    closed form.
    """
    without_first = Chain(sealed(chain.screws[1:]), chain.base_from_flange)
    arm = form_of(without_first)
    if arm is not None:
        return HeldAtEnd(0, chain.screws[0], arm)
    arm = form_of(Chain(sealed(chain.screws[:-1]), chain.base_from_flange))
    if arm is None:
        return None
    return HeldAtEnd(6, _seen_from(chain.base_from_flange, chain.screws[6:])[0], arm)


def _solved_at_end(
    form: HeldAtEnd, pose: Array, values: Array, hold: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Compute `solutions_with` for an arm whose first or last joint is held."""
    away = _moves(form.screw, -values)
    others = slice(1, 7) if form.joint == 0 else slice(0, 6)
    poses = away @ pose if form.joint == 0 else pose @ away
    found = closed_form(form.arm, poses, hold[others, None])
    q = np.empty((BRANCHES, len(values), 7))
    q[:, :, others] = found.q.transpose(1, 2, 0)
    q[:, :, form.joint] = values
    return q, found.valid


def _within(chain: Chain, *, is_reversed: bool) -> HeldWithin | None:
    """Return the closed form for an arm with a wrist if one joint before the wrist is held at a given
    position; None if the arm has no such closed form.

    With `is_reversed`, the arm is read from the flange to the base, so that the wrist may be at its base.
    """
    if not links_of(chain).uniform:
        return None
    if is_reversed:
        # the chain read from the flange is T⁻¹ = exp(-s7' q7) … exp(-s1' q1) M⁻¹, where the screws s' are
        # relative to the flange pose M
        home = _back(chain.base_from_flange)
        chain = Chain(sealed(-_seen_from(chain.base_from_flange, chain.screws)[::-1]), sealed(home))
    links = links_of(chain)
    axes, points = links.frames[:, :3, 2], links.frames[:, :3, 3]
    centre, angles = meeting_point(axes[4:], points[4:]), wrist_angles_of(axes[4:])
    if centre is None or angles is None or _distance(axes[3], points[3], centre) < APART:
        return None
    for held_joint, pair in ((2, (0, 1)), (0, (1, 2))):
        meeting = meeting_point(axes[list(pair)], points[list(pair)])
        if meeting is None or np.linalg.norm(np.cross(axes[pair[0]], axes[pair[1]])) < APART:
            continue
        if held_joint == 0 and _distance(axes[3], points[3], meeting) < APART:
            continue
        if held_joint == 2:
            # the held joint moves the meeting point around its own axis. If the meeting point is on the held
            # joint's axis, it stays at rest; it must then not be on the fourth axis
            stays = _distance(axes[2], points[2], meeting) < TOLERANCE
            if stays and _distance(axes[3], points[3], meeting) < APART:
                continue
        x4, x6 = np.cross(axes[4], axes[5]), np.cross(axes[5], axes[6])
        return HeldWithin(
            is_reversed=is_reversed,
            held=held_joint,
            pair=pair,
            axes=axes,
            points=points,
            meeting=meeting,
            centre=centre,
            home=chain.base_from_flange,
            fourth=frame_of(axes[4], x4 / np.linalg.norm(x4), centre)[:3, :3],
            sixth=frame_of(axes[6], x6 / np.linalg.norm(x6), centre)[:3, :3],
            angles=angles,
            crosses=np.array([_cross(axis) for axis in axes]),
        )
    return None


def _solved_within(
    form: HeldWithin, pose: Array, values: Array, hold: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return solutions (7, BRANCHES, N) for the chain as it is read (from the base or from the flange), and a
    mask (BRANCHES, N) of those that reach the pose. The last index counts the positions of the held joint.
    """
    count, (first_joint, other) = len(values), form.pair
    turned = pose[:3, :3] @ form.home[:3, :3].T
    # the wanted wrist centre and the wanted frame of the last axis
    target = pose[:3, 3] + turned @ (form.centre - form.home[:3, 3])
    tip = (turned @ form.sixth)[:, :, None]
    sin, cos = np.sin(values), np.cos(values)
    middle = np.broadcast_to(form.meeting[:, None], (3, count))
    if form.held == 0:
        start = form.points[0][:, None]
        # undo the turn of the first joint: the target relative to the link that the first joint moves
        way = _turned(form.crosses[0], target[:, None] - start, -sin, cos) + start - middle
        tip = _turned(form.crosses[0], tip, -sin, cos)
    else:
        start = form.points[2][:, None]
        way = (target - form.meeting)[:, None] + np.zeros(count)
        middle = _turned(form.crosses[2], middle - start, -sin, cos) + start
    bend, bends = _bend(form, middle, way)
    # the vector from the point where the two axes meet to the wrist centre, before the two joints turn: (3,
    # bend 2, N)
    bend_sin, bend_cos = np.sin(bend), np.cos(bend)
    across = (form.centre - form.points[3])[:, None, None]
    reach = _turned(form.crosses[3], across, bend_sin, bend_cos) + form.points[3][:, None, None]
    if form.held == 2:
        start = form.points[2][:, None, None]
        reach = _turned(form.crosses[2], reach - start, sin, cos) + start
    reach = reach - form.meeting[:, None, None]
    first, second, leans = _two_turns(form, way, reach, hold[[first_joint, other]])
    # undo the first four joints: the rotation that is left for the wrist, (3, 3, shoulder 2, bend 2, N)
    rest = tip[:, :, None, None]
    rest = _turned(form.crosses[first_joint], rest, -np.sin(first), np.cos(first))
    rest = _turned(form.crosses[other], rest, -np.sin(second), np.cos(second))
    if form.held == 2:
        rest = _turned(form.crosses[2], rest, -sin, cos)
    rest = _turned(form.crosses[3], rest, -bend_sin, bend_cos)
    rest = (form.fourth.T @ rest.reshape(3, -1)).reshape(3, 3, 4, count)
    wrist, bendable, _straight = wrist_angles(form.angles, rest, hold[4:5])
    q: Array = np.empty((7, 2, 2, 2, count))
    q[form.held] = 0.0
    q[first_joint], q[other], q[3] = first, second, bend
    q[4:] = wrist.reshape(3, 2, 2, 2, count)
    q -= TURN * np.round(q * (1.0 / TURN))
    q[form.held] = values
    valid = np.empty((2, 2, 2, count), dtype=bool)
    valid[:] = bends & leans & bendable.reshape(2, 2, count)
    return q.reshape(7, BRANCHES, count), valid.reshape(BRANCHES, count)


def _bend(form: HeldWithin, middle: Array, way: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve subproblem 3: find the fourth angle at which the distance of the wrist centre from `middle` is
    the length of `way`.

    Args:
        form: the arm.
        middle: (3, N) [m].
        way: (3, N) [m].

    Returns:
        The two values of the angle (2, N) [rad], and a mask (N,) of the samples for which they exist.
    """
    axis = form.axes[3]
    arm, target = form.centre - form.points[3], middle - form.points[3][:, None]
    # split both vectors into their components parallel and perpendicular to the axis
    along, height = float(axis @ arm), axis @ target
    arm = arm - along * axis
    target = target - axis[:, None] * height
    length, distance = float(np.linalg.norm(arm)), np.sqrt((target * target).sum(axis=0))
    # Square of the wanted distance between `arm` and `target`, both of which are now perpendicular to the
    # axis.
    square = (way * way).sum(axis=0) - np.square(along - height)
    # sine and cosine of half the angle between `arm` and `target`, times a common factor, by the law of
    # cosines
    sine, cosine = square - np.square(length - distance), np.square(length + distance) - square
    reached = (np.minimum(sine, cosine) >= -REACH_TOLERANCE) & (distance > APART)
    half = np.arctan2(np.sqrt(np.maximum(sine, 0.0)), np.sqrt(np.maximum(cosine, 0.0)))
    towards = np.arctan2((form.crosses[3] @ arm) @ target, arm @ target)
    return np.stack((towards - 2.0 * half, towards + 2.0 * half)), reached


def _two_turns(
    form: HeldWithin, way: Array, reach: Array, hold: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Solve subproblem 2: find the angles of the two joints `form.pair` at which the vector `reach` turns to
    the vector `way`.

    If `way` lies along the first axis, the angle about the first axis is `hold[0]`. If `reach` lies along the
    other axis, the angle about the other axis is `hold[1]`.

    Args:
        form: the arm.
        way: (3, N) [m].
        reach: (3, 2, N) [m].
        hold: (2,) [rad].

    Returns:
        The angles about the first and about the other axis, (2, 2, N) each [rad], and a mask (2, N) of the
        samples for which they exist.
    """
    first_joint, other = (form.axes[joint] for joint in form.pair)
    cosine, normal = float(first_joint @ other), form.crosses[form.pair[0]] @ other
    sine = float(normal @ normal)
    # the vector between the two turns lies on the cones about both axes. Its components are `first` and
    # `second` along these axes, and plus or minus `aside` along their common normal
    level, height = first_joint @ way, (other @ reach.reshape(3, -1)).reshape(reach.shape[1:])
    # solve for the components along the two axes: the turns change neither `level` nor `height`
    first, second = (level - cosine * height) / sine, (height - cosine * level) / sine
    # the remaining component is along the common normal
    square = (reach * reach).sum(axis=0) - first * (first + 2.0 * cosine * second) - second * second
    aside = np.sqrt(np.maximum(square, 0.0) / sine)
    between = first_joint[:, None, None] * first + other[:, None, None] * second
    side = normal[:, None, None] * aside
    between = np.stack((between - side, between + side), axis=1)
    cross_one, cross_other = (form.crosses[joint] for joint in form.pair)
    end = cross_one @ way
    turn_one = _turn_between(_crossed(cross_one, between), end[:, None, None], way[:, None, None])
    start = _crossed(cross_other, reach)[:, None]
    turn_other = _turn_between(start, _crossed(cross_other, between), between)
    # if a vector lies along its axis of rotation, its angle is free: use the held value
    radius = np.sqrt((end * end).sum(axis=0))
    if radius.min(initial=1.0) < 10.0 * HOLD:
        turn_one = held(turn_one, hold[0], radius)
    radius = np.sqrt((start * start).sum(axis=0))
    if radius.min(initial=1.0) < 10.0 * HOLD:
        turn_other = held(turn_other, hold[1], radius)
    return turn_one, turn_other, square >= -REACH_TOLERANCE


def _turn_between(start: Array, across: Array, end: Array) -> Array:
    """Return the angle [rad] by which a turn about an axis brings one vector to another.

    Args:
        start: the axis crossed with the first vector (3, ...).
        across: the axis crossed with the second vector (3, ...).
        end: the second vector (3, ...).
    """
    result: Array = np.arctan2((start * end).sum(axis=0), (start * across).sum(axis=0))
    return result


def _crossed(cross: Array, vectors: Array) -> Array:
    """Return the cross products of an axis, given by its matrix (3, 3), with vectors (3, ...)."""
    result: Array = (cross @ vectors.reshape(3, -1)).reshape(vectors.shape)
    return result


def _turned(cross: Array, vectors: Array, sin: Array, cos: Array) -> Array:
    """Return vectors (3, ...) turned about an axis, given by its matrix (3, 3), by angles (...) with these
    sines and cosines.
    """
    across = _crossed(cross, vectors)
    result: Array = vectors + sin * across + (1.0 - cos) * _crossed(cross, across)
    return result


def _cross(axis: Array) -> Array:
    """Return the cross product matrix (3, 3) of an axis (3,)."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _distance(axis: Array, point: Array, other: Array) -> float:
    """Return the distance of the point `other` (3,) from an axis (3,) through `point` (3,) [m]."""
    return float(np.linalg.norm(np.cross(axis, other - point)))


def _back(transform: Array) -> Array:
    """Return the inverse of a rigid transform (4, 4)."""
    result = np.eye(4)
    result[:3, :3] = transform[:3, :3].T
    result[:3, 3] = -(result[:3, :3] @ transform[:3, 3])
    return result


def _seen_from(frame: Array, screws: Array) -> Array:
    """Transform screws (m, 6), linear part first, from {B} into a frame (4, 4)."""
    turn, origin = frame[:3, :3], frame[:3, 3]
    angular = screws[:, 3:]
    linear = screws[:, :3] + np.cross(angular, origin)
    return np.hstack((linear @ turn, angular @ turn))


def _moves(screw: Array, values: Array) -> Array:
    """Return the motions (N, 4, 4) that a joint with screw (6,) makes for joint positions (N,) [rad or m]."""
    linear, angular = screw[:3], screw[3:]
    result = np.tile(np.eye(4), (len(values), 1, 1))
    size = float(np.linalg.norm(angular))
    if size == 0.0:
        result[:, :3, 3] = values[:, None] * linear
        return result
    axis, turn = angular / size, values * size
    cross = _cross(axis)
    sin, cos = np.sin(turn)[:, None, None], (1.0 - np.cos(turn))[:, None, None]
    result[:, :3, :3] += sin * cross + cos * (cross @ cross)
    # Chasles: a turn about the axis through `point`, and a translation along it
    point = np.cross(axis, linear) / size
    pitch = axis * float(axis @ linear)
    result[:, :3, 3] = point - result[:, :3, :3] @ point + values[:, None] * pitch
    return result
