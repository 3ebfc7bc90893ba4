"""Compute all eight solutions of an arm with a spherical wrist or with three parallel axes, for many poses at
once.

The last index of each array counts the samples (poses). The indices before it count the branches: (shoulder
2, elbow 2) in arrays about the arm, and (wrist 2, shoulder 2, elbow 2) in arrays about the wrist. Angles are
computed by half-angle formulas, and by atan2 of both legs of a right triangle. These formulas are accurate
also near the poses at which a solution vanishes or two solutions meet.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.geometry import Form, ParallelArm, WristedArm
from yarclang.robot.kinematics.wrist import HOLD, REACH_TOLERANCE, TURN, held, wrist_angles
from yarclang.robot.model import Array

BLOCK = 512
"""Number of poses in one block. It is small enough for their eight branches to stay in the second-level
cache.
"""


def free_joints(arm: Form) -> tuple[int, int]:
    """Return the numbers (from 0) of the two joints whose angles a pose may leave free at a singularity.

    The first joint is q1, free if the wrist centre is on axis 1. The second is q4, free if the wrist is
    straight. With three parallel axes, the second is q6, free if the last axis is parallel to them.
    """
    return (0, 3) if isinstance(arm, WristedArm) else (0, 5)


@frozen(eq=False)
class Branches:
    """All eight solutions (branches) of N poses; the last index of each array counts the poses.

    Attributes:
        q: (6, 8, N) joint positions in (-pi, pi] [rad]. If a branch doesn't reach its pose, this is the joint
            position at which the arm stretches towards the pose.
        valid: (8, N) True if the branch reaches its pose.
        free: (2, 8, N) True if the pose doesn't determine an angle, so that `q` has the caller's value for
            it. The first entry stands for q1 (the wrist centre is on axis 1), the second for a wrist angle
            (the wrist is straight).
    """

    q: Array
    valid: NDArray[np.bool_]
    free: NDArray[np.bool_]

    @property
    def singular(self) -> NDArray[np.bool_]:
        """Mask (8, N), True where the pose leaves an angle free, so that the caller's value was used."""
        over, straight = self.free
        either: NDArray[np.bool_] = over | straight
        return either


def closed_form(arm: Form, base_from_flange: Array, hold: Array) -> Branches:
    """Compute all eight solutions (branches) of each pose.

    Args:
        arm: the arm's constants.
        base_from_flange: (N, 4, 4).
        hold: (6, N) or (6, 1) [rad], the values for angles that a pose leaves free: q1 if the wrist centre is
            on axis 1, and q4 if the wrist is straight. For an arm with three parallel axes, the sum of the
            angles of these axes is taken from `hold` instead of q4.

    Returns:
        The branches; the index of a branch is 4 wrist + 2 shoulder + elbow, each 0 or 1.
    """
    count = len(base_from_flange)
    if count <= BLOCK:
        return _block(arm, base_from_flange, hold)
    q = np.empty((6, 8, count))
    valid, free = np.empty((8, count), bool), np.empty((2, 8, count), bool)
    for start in range(0, count, BLOCK):
        piece = slice(start, start + BLOCK)
        part = _block(arm, base_from_flange[piece], hold if hold.shape[1] == 1 else hold[:, piece])
        q[:, :, piece], valid[:, piece], free[:, :, piece] = part.q, part.valid, part.free
    return Branches(q, valid, free)


def _block(arm: Form, poses: Array, hold: Array) -> Branches:
    """Compute the eight solutions (branches) of one block of poses."""
    if isinstance(arm, ParallelArm):
        return _parallel_block(arm, poses, hold)
    count, columns = len(poses), _columns(arm, poses)
    q1, over = _shoulder(arm, columns[3], hold[0])
    sin1, cos1 = np.sin(q1), np.cos(q1)
    q2, q3, reached = _elbow(arm, columns[3], sin1, cos1)
    reached = reached & over.reached
    # the wrist must make the rotation that remains after joints 1 to 3: undo the turn of joint 1
    rows = columns[:3].transpose(1, 0, 2)[:, :, None]
    turned: Array = np.empty((3, 3, 2, count))
    turned[0] = cos1 * rows[0] + sin1 * rows[1]
    turned[1] = cos1 * rows[1] - sin1 * rows[0]
    turned[2] = rows[2]
    turned = (arm.shoulder[:3, :3].T @ turned.reshape(3, -1)).reshape(3, 3, 2, 1, count)
    bent = q2 + q3
    sin, cos = np.sin(bent), np.cos(bent)
    # axes 2 and 3 are parallel: their turns add up to one turn about z of frame 2, which is undone here
    rest: Array = np.empty((3, 3, 2, 2, count))
    rest[0] = cos * turned[0] + sin * turned[1]
    rest[1] = cos * turned[1] - sin * turned[0]
    rest[2] = turned[2]
    rest = (arm.wrist.T @ rest.reshape(3, -1)).reshape(3, 3, 4, count)

    wrist, bendable, straight = wrist_angles(arm, rest, hold[3])
    q: Array = np.empty((6, 2, 2, 2, count))
    q[0] = q1[:, None]
    q[1] = q2
    q[2] = q3 * arm.elbow_sign
    q = q.reshape(6, 8, count)
    q[3:] = wrist.reshape(3, 8, count)
    # wrap to (-pi, pi]
    q -= TURN * np.round(q * (1.0 / TURN))
    valid = np.empty((2, 4, count), bool)
    valid[:] = np.repeat(reached, 2, axis=0) & bendable
    free = np.empty((2, 2, 4, count), bool)
    free[0], free[1] = over.singular, straight
    return Branches(q, valid.reshape(8, count), free.reshape(2, 8, count))


def _parallel_block(arm: ParallelArm, poses: Array, hold: Array) -> Branches:
    """Compute the eight solutions of one block of poses for an arm with three parallel axes."""
    count, columns = len(poses), _columns(arm, poses)
    q1, over = _shoulder(arm, columns[3], hold[0])
    sin1, cos1 = np.sin(q1), np.cos(q1)
    # the parallel axes (together), axis 5 and axis 6 must make the rotation that remains after joint 1: undo
    # the turn of joint 1
    rows = columns[:3].transpose(1, 0, 2)[:, :, None]
    turned: Array = np.empty((3, 3, 2, count))
    turned[0] = cos1 * rows[0] + sin1 * rows[1]
    turned[1] = cos1 * rows[1] - sin1 * rows[0]
    turned[2] = rows[2]
    turned = ((arm.shoulder[:3, :3] @ arm.wrist).T @ turned.reshape(3, -1)).reshape(3, 3, 2, count)
    # `together` is the sum of the angles of the three parallel axes in `hold`, counted about axis 2
    together = hold[1] + arm.elbow_sign * hold[2] + arm.hand_sign * hold[3]
    # axis 2 takes the role of axis 4 of a spherical wrist. The rotation `arm.wrist` already contains the zero
    # position of its angle, so that `together` needs no offset
    wrist, bendable, straight = wrist_angles(arm, turned, together)
    # `arm.hand`, the vector from axis 4 to the wrist centre, turns by the sum of the three angles, `wrist[0]`
    sin, cos = np.sin(wrist[0]), np.cos(wrist[0])
    # subtract the turned `arm.hand` from the wrist centre: x and y of axis 4 in frame 2, each (wrist 2,
    # shoulder 2, N)
    x, y = _in_plane(arm, columns[3], sin1, cos1)
    x = x - (cos * arm.hand[0] - sin * arm.hand[1])
    y = y - (sin * arm.hand[0] + cos * arm.hand[1])
    q2, q3, reached = _two_links(arm, x, y)
    q: Array = np.empty((6, 2, 2, 2, count))
    q[0] = q1[:, None]
    q[1] = q2
    q[2] = q3 * arm.elbow_sign
    # joint 4's angle is the sum minus the angles of joints 2 and 3
    q[3] = (wrist[0][:, :, None] - q2 - q3) * arm.hand_sign
    q[4:] = wrist[1:, :, :, None]
    q = q.reshape(6, 8, count)
    q -= TURN * np.round(q * (1.0 / TURN))
    valid = np.empty((2, 2, 2, count), bool)
    valid[:] = (reached & (over.reached & bendable))[:, :, None]
    free = np.empty((2, 2, 2, 2, count), bool)
    free[0], free[1] = over.singular, straight[:, None]
    return Branches(q, valid.reshape(8, count), free.reshape(2, 8, count))


def _columns(arm: Form, poses: Array) -> Array:
    """Return the wrist's last frame for each of the poses base_from_flange (N, 4, 4), in the first joint's
    frame.

    The result is (4, 3, N): the frame's three axes, then its origin, which is the wrist centre.
    """
    columns: Array = np.ascontiguousarray(poses[:, :3].transpose(2, 1, 0))
    columns = (arm.flange_from_wrist.T @ columns.reshape(4, -1)).reshape(4, 3, len(poses))
    columns = np.matmul(arm.first_from_base[:3, :3], columns)
    columns[3] += arm.first_from_base[:3, 3, None]
    return columns


def _left_over(arm: WristedArm, columns: Array, turned_by: tuple[Array, Array], bent: Array) -> Array:
    """Return the rotation that the wrist must make after joints 1 to 3 have turned, as (3, 3, 1, N).

    Args:
        arm: the arm's constants.
        columns: as returned by `_columns`.
        turned_by: sine and cosine of q1, (N,) each.
        bent: the sum of q2 and q3 (N,) [rad], about axis 2.
    """
    count, rows = len(bent), columns[:3].transpose(1, 0, 2)
    turned: Array = np.empty((3, 3, count))
    sin, cos = turned_by
    turned[0] = cos * rows[0] + sin * rows[1]
    turned[1] = cos * rows[1] - sin * rows[0]
    turned[2] = rows[2]
    turned = (arm.shoulder[:3, :3].T @ turned.reshape(3, -1)).reshape(3, 3, count)
    sin, cos = np.sin(bent), np.cos(bent)
    rest: Array = np.empty((3, 3, 1, count))
    rest[0, :, 0] = cos * turned[0] + sin * turned[1]
    rest[1, :, 0] = cos * turned[1] - sin * turned[0]
    rest[2, :, 0] = turned[2]
    left: Array = (arm.wrist.T @ rest.reshape(3, -1)).reshape(3, 3, 1, count)
    return left


def one_branch(
    arm: Form, base_from_flange: Array, branch: int
) -> tuple[Array, NDArray[np.bool_], NDArray[np.bool_]]:
    """Compute one of the eight solutions (branches) of each pose. The results equal those of `closed_form`
    bit by bit, but take less time.

    Args:
        arm: the arm's constants.
        base_from_flange: (N, 4, 4).
        branch: number of the branch: 4 wrist + 2 shoulder + elbow, each 0 or 1.

    Returns:
        Joint positions (6, N) [rad]; a mask (N,) of the poses that they reach; and a mask (N,) of the poses
        that leave an angle of any branch free. The joint positions for poses with free angles are
        meaningless: for such poses, use `closed_form`, which takes values for free angles.
    """
    if isinstance(arm, ParallelArm):
        found = closed_form(arm, base_from_flange, np.zeros((6, 1)))
        is_held: NDArray[np.bool_] = np.logical_or.reduce(found.singular, axis=0)
        return found.q[:, branch].copy(), found.valid[branch].copy(), is_held
    count, nothing = len(base_from_flange), np.zeros(1)
    wrist, shoulder, elbow = branch // 4, branch // 2 % 2, branch % 2
    q: Array = np.empty((6, count))
    valid, singular = np.empty(count, bool), np.empty(count, bool)
    for start in range(0, count, BLOCK):
        piece = slice(start, start + BLOCK)
        columns = _columns(arm, base_from_flange[piece])
        q1, over = _shoulder(arm, columns[3], nothing)
        sin1, cos1 = np.sin(q1), np.cos(q1)
        q2, q3, reached = _elbow(arm, columns[3], sin1, cos1)
        bent = q2 + q3
        q[0, piece] = q1[shoulder]
        q[1, piece], q[2, piece] = q2[shoulder, elbow], q3[shoulder, elbow] * arm.elbow_sign
        rest = _left_over(arm, columns, (sin1[shoulder], cos1[shoulder]), bent[shoulder, elbow])
        angles, bendable, _ = wrist_angles(arm, rest, nothing)
        q[3:, piece] = angles[:, wrist, 0]
        valid[piece] = reached[shoulder] & over.reached & bendable[0]
        singular[piece] = over.singular | _is_straight(arm, columns[2], (sin1, cos1), bent)
    q -= TURN * np.round(q * (1.0 / TURN))
    return q, valid, singular


def _is_straight(
    arm: WristedArm, axis: Array, turned_by: tuple[Array, Array], bent: Array
) -> NDArray[np.bool_]:
    """Return a mask (N,) of the poses at which the wrist of any branch is straight or nearly straight.

    Args:
        arm: the arm's constants.
        axis: (3, N) direction of the last joint's axis, in the frame of the first joint.
        turned_by: sine and cosine of q1, each (2, N): a row for each shoulder branch.
        bent: the sum of q2 and q3 (2, 2, N), by shoulder branch and elbow branch [rad].
    """
    sin, cos = turned_by
    turned = np.stack((cos * axis[0] + sin * axis[1], cos * axis[1] - sin * axis[0], axis[2] + 0.0 * sin))
    turned = (arm.shoulder[:3, :3].T @ turned.reshape(3, -1)).reshape(3, 2, 1, -1)
    sin, cos = np.sin(bent), np.cos(bent)
    along, aside = cos * turned[0] + sin * turned[1], cos * turned[1] - sin * turned[0]
    # the component of the last axis perpendicular to axis 4; its length is the sine of the angle between
    # these two axes
    x, y = (one * along + other * aside + third * turned[2] for one, other, third in arm.wrist.T[:2])
    found: NDArray[np.bool_] = (x * x + y * y < (11.0 * HOLD) ** 2).any(axis=(0, 1))
    return found


@frozen
class _Over:
    """Two masks (N,) about the wrist centre of each pose. `reached` is True if joint 1 can turn the arm's
    plane through the wrist centre. `singular` is True if the wrist centre is on axis 1.
    """

    reached: NDArray[np.bool_]
    singular: NDArray[np.bool_]


def _shoulder(arm: Form, centre: Array, hold: Array) -> tuple[Array, _Over]:
    """Return the two values of q1 (2, N) that bring the wrist centre (3, N) into the arm's plane, and masks
    of the wrist centres.

    This is subproblem 4 of IK-Geo: the centre's component along axis 2 must be `arm.depth`.
    """
    axis, origin = arm.shoulder[:3, 2], arm.shoulder[:3, 3]
    lean = math.hypot(axis[0], axis[1])
    radius = np.hypot(centre[0], centre[1])
    side = ((arm.depth + axis @ origin) - axis[2] * centre[2]) / lean
    # radius² - side², the square of the right triangle's other leg, is computed as a product to avoid
    # cancellation
    slack = radius - np.abs(side)
    spread = np.arctan2(np.sqrt(np.maximum(slack * (radius + np.abs(side)), 0.0)), side)
    # The component of the wrist centre along axis 2 is lean · radius · cos(q1 - middle) plus a constant. One
    # cosine equation therefore gives q1.
    middle = np.arctan2(centre[1], centre[0]) - math.atan2(axis[1], axis[0])
    q1 = np.stack((middle - spread, middle + spread))
    singular = radius < 10.0 * HOLD
    if singular.any():
        q1 = held(q1, hold, radius)
    return q1, _Over(slack >= -REACH_TOLERANCE, singular)


def _elbow(
    arm: WristedArm, centre: Array, sin1: Array, cos1: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return q2 and q3, each (shoulder 2, elbow 2, N), and a mask (2, N) of the wrist centres within reach.

    These are subproblems 3 and 1 of IK-Geo.
    """
    x, y = _in_plane(arm, centre, sin1, cos1)
    return _two_links(arm, x, y)


def _in_plane(arm: Form, centre: Array, sin1: Array, cos1: Array) -> tuple[Array, Array]:
    """Return the coordinates x and y of the wrist centre (3, N) in frame 2 before joint 2 turns, each as
    (shoulder 2, N) [m].
    """
    turn = arm.shoulder[:3, :3]
    start = -turn.T @ arm.shoulder[:3, 3]
    along = cos1 * centre[0] + sin1 * centre[1]
    aside = cos1 * centre[1] - sin1 * centre[0]
    x = turn[0, 0] * along + turn[1, 0] * aside + (turn[2, 0] * centre[2] + start[0])
    y = turn[0, 1] * along + turn[1, 1] * aside + (turn[2, 1] * centre[2] + start[1])
    return x, y


def _two_links(arm: Form, x: Array, y: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return q2 and q3, each (..., elbow 2, N), that bring the end of two links in a plane to x and y (...,
    N) [m], and a mask (..., N) of the points within reach.
    """
    distance = np.hypot(x, y)
    far, near = arm.upper + arm.fore, abs(arm.upper - arm.fore)
    beyond, inside = far - distance, distance - near
    # half-angle formulas of the law of cosines: tan(fold / 2) = sine / cosine
    sine = np.sqrt(np.maximum(beyond * (far + distance), 0.0))
    cosine = np.sqrt(np.maximum(inside * (distance + near), 0.0))
    fold = 2.0 * np.arctan2(sine, cosine)
    # Angle at the shoulder between the upper link and the line to the tip.
    tip = np.arctan2(arm.fore * np.sin(fold), arm.upper + arm.fore * np.cos(fold))
    towards = np.arctan2(y, x)
    q2 = np.stack((towards - tip, towards + tip), axis=-2)
    q3 = np.stack((fold, -fold), axis=-2) - arm.fore_angle
    return q2, q3, np.minimum(beyond, inside) >= -REACH_TOLERANCE


def next_to(angle: Array, seed: Array) -> tuple[Array, Array]:
    """Return angles shifted by full turns to the value nearest to their seeds, and their differences from the
    seeds [rad].

    Only whole turns are added to an angle. The joint target therefore depends on the pose alone, and not on
    the last digits of the arm's previous position.
    """
    near = angle - TURN * np.round((angle - seed) * (1.0 / TURN))
    return near, near - seed


def nearest_form(arm: Form, poses: Array, seed: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Find one solution (6, N) near seeds (6, N), and prove, where possible, that it is the nearest of all
    eight solutions (branches).

    The shoulder, elbow and wrist are chosen one after the other, each from two possibilities. The cost of a
    possibility is its squared joint difference from the seed. Any other solution contains at least one
    rejected possibility, and costs at least as much as this possibility. If the whole solution costs less
    than each rejected possibility, no other solution is nearer.

    Args:
        arm: the arm's constants.
        poses: base_from_flange (N, 4, 4).
        seed: (6, N) [rad].

    Returns:
        q (6, N) [rad], and a mask (N,): True where q is proved to be the nearest. With three parallel axes
        nothing is computed: q is 0 and the mask is False.
    """
    if isinstance(arm, ParallelArm):
        return np.zeros((6, len(poses))), np.zeros(len(poses), dtype=bool)
    columns = _columns(arm, poses)
    q: Array = np.empty((6, len(poses)))
    q1, over = _shoulder(arm, columns[3], seed[0])
    # choose the shoulder; `rival` is the least cost of all rejected possibilities so far
    q1, away1 = next_to(q1, seed[0])
    cost1 = away1 * away1
    second = cost1[1] < cost1[0]
    q[0] = np.where(second, q1[1], q1[0])
    rival = np.maximum(cost1[0], cost1[1])
    cost = np.minimum(cost1[0], cost1[1])
    sin1, cos1 = np.sin(q[:1]), np.cos(q[:1])
    q2, q3, reached = _elbow(arm, columns[3], sin1, cos1)
    q3 *= arm.elbow_sign
    # choose the elbow
    bends, away = next_to(np.stack((q2[0], q3[0])), seed[1:3, None])
    costs = away[0] * away[0] + away[1] * away[1]
    second = costs[1] < costs[0]
    rival = np.minimum(rival, np.maximum(costs[0], costs[1]))
    cost += np.minimum(costs[0], costs[1])
    q[1:3] = np.where(second, bends[:, 1], bends[:, 0])
    rest = _left_over(arm, columns, (sin1[0], cos1[0]), q[1] + arm.elbow_sign * q[2])
    wrist, bendable, _straight = wrist_angles(arm, rest, seed[3])
    # choose the wrist
    turns, away = next_to(wrist[:, :, 0], seed[3:, None])
    costs = (away * away).sum(axis=0)
    second = costs[1] < costs[0]
    rival = np.minimum(rival, np.maximum(costs[0], costs[1]))
    cost += np.minimum(costs[0], costs[1])
    q[3:] = np.where(second, turns[:, 1], turns[:, 0])
    # costs are sums of squares: any other branch costs at least as much as the rejected possibility that it
    # contains
    sure = (cost < rival) & over.reached & reached[0] & bendable[0]
    # near a singularity, rounding decides which solution is nearest: leave these poses to `closed_form`
    sure &= np.hypot(rest[0, 2, 0], rest[1, 2, 0]) > 1e-5
    sure &= ~over.singular
    return q, sure
