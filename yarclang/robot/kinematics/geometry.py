"""Recognize arms with a closed form: six turning joints, and a spherical wrist or three parallel axes.

Spherical wrist: the last three axes meet in one point (the wrist centre), and axis 5 is parallel to neither 4
nor 6. In addition, axes 2 and 3 are parallel, and axis 1 isn't parallel to them. Offsets and other angles are
arbitrary. The decomposition is that of Elias and Wen, IK-Geo (Mechanism and Machine Theory 209, 2025),
"spherical wrist, two parallel". Subproblem 4 gives q1, subproblem 3 gives q3, subproblem 1 gives q2; then
subproblems 4, 1 and 1 give the wrist.

Three parallel axes (2, 3, 4: most cobots): axes 5 and 6 meet. When the parallel axes turn, this meeting point
keeps its distance along axis 2, which gives q1 (subproblem 4). The rotation that the joints after joint 1
must make is a turn about the parallel axes, by the sum of q2, q3 and q4, followed by the turns about axes 5
and 6. These three turns are solved like a wrist. Then subproblem 3 gives q3 and subproblem 1 gives q2.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain
from yarclang.transforms import sealed

TOLERANCE = 1e-9
"""Distance [m] or angle [rad] up to which axes count as meeting or as parallel."""

SMALL_ANGLE = 1e-3
"""Smallest angle [rad] between two axes of a wrist or shoulder that must not be parallel."""


@frozen(eq=False)
class WristedArm:
    """The constants of the closed form of an arm with a spherical wrist.

    All frames have z along their joint's axis. Their poses are those with all joints at zero. Frames 4 and 6
    have their origins in the wrist centre. Frames 2 and 3 have the same axes, with x from axis 2 to axis 3.

    Attributes:
        first_from_base: (4, 4) converts, together with `flange_from_wrist`, a flange pose to the pose of
            frame 6 in frame 1.
        flange_from_wrist: (4, 4).
        shoulder: (4, 4) frame 2 in frame 1.
        upper: length of the first link in the plane perpendicular to axis 2 [m].
        fore: length of the second link in this plane [m].
        fore_angle: angle in this plane from x to the direction from axis 3 to the wrist centre [rad].
        depth: position of the wrist centre along axis 2 [m].
        elbow_sign: -1 if axis 3 points against axis 2, otherwise 1.
        wrist: (3, 3) frame 4 in frame 3.
        alpha: angle between axes 4 and 5 [rad].
        beta: angle between axes 5 and 6 [rad].
        bend: angle of the wrist's formulas (`wrist_angles`) at which joint 5 is at zero [rad].
    """

    first_from_base: Array
    flange_from_wrist: Array
    shoulder: Array
    upper: float
    fore: float
    fore_angle: float
    depth: float
    elbow_sign: float
    wrist: Array
    alpha: float
    beta: float
    bend: float


@frozen(eq=False)
class ParallelArm:
    """The constants of the closed form of an arm with three parallel axes.

    All frames have z along their joint's axis. Their poses are those with all joints at zero. Frame 6 has its
    origin where axes 5 and 6 meet (the wrist centre). Frame 2 has x from axis 2 to axis 3.

    Attributes:
        first_from_base: (4, 4), as for a `WristedArm`.
        flange_from_wrist: (4, 4), as for a `WristedArm`.
        shoulder: (4, 4) frame 2 in frame 1.
        upper: distance from axis 2 to axis 3 [m].
        fore: distance from axis 3 to axis 4 [m].
        fore_angle: direction from axis 3 to axis 4 in frame 2 [rad].
        hand: (2,) vector from axis 4 to the wrist centre, in the plane perpendicular to axis 2 [m].
        depth: position of the wrist centre along axis 2 [m].
        elbow_sign: -1 if axis 3 points against axis 2, otherwise 1.
        hand_sign: -1 if axis 4 points against axis 2, otherwise 1.
        wrist: (3, 3) frame of the parallel axes in frame 2, with x perpendicular to axis 5.
        alpha: angle between axes 2 and 5 [rad].
        beta: angle between axes 5 and 6 [rad].
        bend: angle of the wrist's formulas (`wrist_angles`) at which joint 5 is at zero [rad].
    """

    first_from_base: Array
    flange_from_wrist: Array
    shoulder: Array
    upper: float
    fore: float
    fore_angle: float
    hand: Array
    depth: float
    elbow_sign: float
    hand_sign: float
    wrist: Array
    alpha: float
    beta: float
    bend: float


@frozen(eq=False)
class WristAngles:
    """The angles between the last three axes of an arm [rad]: `alpha`, `beta` and `bend` as in a
    `WristedArm`.
    """

    alpha: float
    beta: float
    bend: float


def wrist_angles_of(axes: Array) -> WristAngles | None:
    """Return the angles between three consecutive unit axes (3, 3), or None if two neighbours are
    parallel.
    """
    alpha, beta = _angle(axes[0], axes[1]), _angle(axes[1], axes[2])
    if min(np.sin([alpha, beta])) < SMALL_ANGLE:
        return None
    x4, x6 = np.cross(axes[0], axes[1]) / np.sin(alpha), np.cross(axes[1], axes[2]) / np.sin(beta)
    return WristAngles(alpha, beta, float(np.arctan2(axes[1] @ np.cross(x4, x6), x4 @ x6)))


Form = WristedArm | ParallelArm
"""The constants of a closed form."""


@lru_cache(maxsize=256)
def form_of(chain: Chain) -> Form | None:
    """Return the closed form of `chain`, or None if it has none; cached by the chain's identity."""
    return wristed_arm(chain) or parallel_arm(chain)


NEARLY_PARALLEL, NEARLY_MEETING = 0.01, 0.004
"""Tolerances by which a calibrated arm may differ from its nominal arm. `NEARLY_PARALLEL` is the largest
angle [rad] between two axes that are parallel in the nominal arm. `NEARLY_MEETING` is the largest distance
[m] of an axis from the point in which the nominal axes meet.
"""


@lru_cache(maxsize=256)
def nominal_form(chain: Chain) -> Form | None:
    """Return the closed form of the nominal arm of a calibrated chain. Axes that are nearly parallel or
    nearly meet in the chain are exactly parallel or exactly meet in the nominal arm.

    The solutions of the nominal arm are near those of the chain, and serve as starting points for iteration.
    Return None if the chain has a closed form of its own, or resembles no arm that has one.
    """
    links = links_of(chain)
    if chain.size != 6 or not links.uniform or form_of(chain) is not None:
        return None
    axes, points = links.frames[:, :3, 2], links.frames[:, :3, 3]
    for parallel, meeting in (((2,), slice(3, 6)), ((2, 3), slice(4, 6))):
        off = max(float(np.linalg.norm(np.cross(axes[1], axes[other]))) for other in parallel)
        centre = meeting_point(axes[meeting], points[meeting], NEARLY_MEETING)
        if centre is None or off > NEARLY_PARALLEL:
            continue
        aligned, through = axes.copy(), points.copy()
        # make the parallel axes exactly parallel, and let the meeting axes meet exactly in one point
        for other in parallel:
            aligned[other] = np.copysign(1.0, float(axes[1] @ axes[other])) * axes[1]
        through[meeting] = centre
        screws = np.hstack((-np.cross(aligned, through), aligned))
        found = form_of(Chain(sealed(screws), chain.base_from_flange))
        if found is not None:
            return found
    return None


@lru_cache(maxsize=256)
def parallel_arm(chain: Chain) -> ParallelArm | None:
    """Return the closed form of a chain with three parallel axes, or None for any other chain; cached by the
    chain's identity.
    """
    links = links_of(chain)
    if chain.size != 6 or not links.uniform:
        return None
    axes, points = links.frames[:, :3, 2], links.frames[:, :3, 3]
    # axes 2, 3 and 4 are parallel if their cross products vanish
    along = axes[1]
    if max(float(np.linalg.norm(np.cross(along, other))) for other in (axes[2], axes[3])) > TOLERANCE:
        return None
    centre = meeting_point(axes[4:], points[4:])
    alpha, beta, lean = _angle(along, axes[4]), _angle(axes[4], axes[5]), _angle(axes[0], along)
    if centre is None or min(np.sin([alpha, beta, lean])) < SMALL_ANGLE:
        return None
    # the vectors from axis 2 to axis 3 and from axis 3 to axis 4, perpendicular to these axes
    across = _across(points[2] - points[1], along)
    fore = _across(points[3] - points[2], along)
    upper, fore_length = float(np.linalg.norm(across)), float(np.linalg.norm(fore))
    if min(upper, fore_length) < SMALL_ANGLE:
        return None
    # the common normals of axes 2 and 5, and of axes 5 and 6, are the x axes from which the angles count
    second = frame_of(along, across / upper, points[1])
    x4, x6 = np.cross(along, axes[4]) / np.sin(alpha), np.cross(axes[4], axes[5]) / np.sin(beta)
    first = np.linalg.inv(links.frames[0])
    third_point, hand = second[:3, :3].T @ fore, second[:3, :3].T @ (centre - points[3])
    return ParallelArm(
        first_from_base=first,
        flange_from_wrist=np.linalg.inv(chain.base_from_flange) @ frame_of(axes[5], x6, centre),
        shoulder=first @ second,
        upper=upper,
        fore=fore_length,
        fore_angle=float(np.arctan2(third_point[1], third_point[0])),
        hand=hand[:2],
        depth=float(along @ (centre - points[1])),
        elbow_sign=1.0 if along @ axes[2] > 0.0 else -1.0,
        hand_sign=1.0 if along @ axes[3] > 0.0 else -1.0,
        wrist=second[:3, :3].T @ frame_of(along, x4, centre)[:3, :3],
        alpha=alpha,
        beta=beta,
        bend=float(np.arctan2(axes[4] @ np.cross(x4, x6), x4 @ x6)),
    )


def _across(way: Array, axis: Array) -> Array:
    """Return the component of a vector (3,) perpendicular to a unit axis (3,)."""
    across: Array = way - axis * float(axis @ way)
    return across


@lru_cache(maxsize=256)
def wristed_arm(chain: Chain) -> WristedArm | None:
    """Return the closed form of a chain with a spherical wrist, or None for any other chain; cached by the
    chain's identity.
    """
    links = links_of(chain)
    if chain.size != 6 or not links.uniform:
        return None
    axes, points = links.frames[:, :3, 2], links.frames[:, :3, 3]
    centre = meeting_point(axes[3:], points[3:])
    alpha, beta = _angle(axes[3], axes[4]), _angle(axes[4], axes[5])
    lean = _angle(axes[0], axes[1])
    if centre is None or min(np.sin([alpha, beta, lean])) < SMALL_ANGLE:
        return None
    if np.linalg.norm(np.cross(axes[1], axes[2])) > TOLERANCE:
        return None
    # the vector from axis 2 to axis 3, perpendicular to both
    across = points[2] - points[1]
    across = across - axes[1] * (axes[1] @ across)
    upper = float(np.linalg.norm(across))
    if upper < SMALL_ANGLE:
        return None
    second = frame_of(axes[1], across / upper, points[1])
    third = second.copy()
    third[:3, 3] += across
    # the wrist centre in frame 3: x and y are in the plane perpendicular to axis 2, z is along axis 2
    centre_on_third = np.linalg.inv(third) @ np.r_[centre, 1.0]
    fore = float(np.hypot(centre_on_third[0], centre_on_third[1]))
    if fore < SMALL_ANGLE:
        return None
    first = links.frames[0]
    # the common normals of axes 4 and 5, and of axes 5 and 6, are the x axes from which the angles count
    x4, x6 = np.cross(axes[3], axes[4]) / np.sin(alpha), np.cross(axes[4], axes[5]) / np.sin(beta)
    fourth = frame_of(axes[3], x4, centre)
    sixth = frame_of(axes[5], x6, centre)
    return WristedArm(
        first_from_base=np.linalg.inv(first),
        flange_from_wrist=np.linalg.inv(chain.base_from_flange) @ sixth,
        shoulder=np.linalg.inv(first) @ second,
        upper=upper,
        fore=fore,
        fore_angle=float(np.arctan2(centre_on_third[1], centre_on_third[0])),
        depth=float(centre_on_third[2]),
        elbow_sign=1.0 if axes[1] @ axes[2] > 0.0 else -1.0,
        wrist=third[:3, :3].T @ fourth[:3, :3],
        alpha=alpha,
        beta=beta,
        bend=float(np.arctan2(axes[4] @ np.cross(x4, x6), x4 @ x6)),
    )


def meeting_point(axes: Array, points: Array, tolerance: float = TOLERANCE) -> Array | None:
    """Return the point in which the axes with directions (m, 3) through `points` (m, 3) meet, or None if an
    axis misses that point by more than `tolerance` [m].
    """
    # normal equations of least squares: their matrix is the sum of the projections perpendicular to the axes
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    total = across.sum(axis=0)
    if np.linalg.cond(total) > 1e9:
        return None
    point: Array = np.linalg.solve(total, np.einsum("mij,mj->i", across, points))
    misses = np.einsum("mij,mj->mi", across, point - points)
    return point if np.abs(misses).max() < tolerance else None


def _angle(first: Array, second: Array) -> float:
    """Return the angle between two unit vectors, 0 to pi [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(first, second)), first @ second))


def frame_of(z: Array, x: Array, origin: Array) -> Array:
    """Return the frame (4, 4) with these axes and this origin."""
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(z, x), z, origin
    return frame
