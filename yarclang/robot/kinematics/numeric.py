"""Solve inverse kinematics by damped least squares, for any serial arm and many poses at once.

The method is Levenberg-Marquardt with damping in proportion to the squared error (Sugihara,
Solvability-Unconcerned Inverse Kinematics by the Levenberg-Marquardt Method, IEEE T-RO 27(5), 2011). If the
pose can be reached, the method converges quadratically; otherwise it converges to the nearest miss. Every
pose has its own damping factor, and a step that increases the error is rejected. The last index of each array
counts the poses.
"""

from __future__ import annotations

import math

import numpy as np

from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.model import Array, Chain

STEP = 0.8
"""The largest change of a joint in one step [rad or m]."""

EXACT = 2e-12
"""The miss [m and rad] below which a solution counts as exact, so that its iteration ends."""

FLOOR = 1e-13
"""The least damping. At a singularity, damping keeps those joints at rest that have no effect."""

FEW = 128
"""Largest number of samples that LAPACK solves one by one; more samples are solved by whole-array operations.
"""

BLOCK = 2048
"""Number of samples that are iterated together."""


@frozen(eq=False)
class Fit:
    """The result of a fit: joint positions `q` (N, n), and by how much they miss the poses, (N,) [m] and (N,)
    [rad].
    """

    q: Array
    miss_position: Array
    miss_angle: Array

    @property
    def total(self) -> Array:
        """The position miss and the angle miss together (N,), 1 m counted like 1 rad."""
        return np.hypot(self.miss_position, self.miss_angle)


def fit(
    chain: Chain,
    base_from_flange: Array,
    seeds: Array,
    *,
    lower: Array | None = None,
    upper: Array | None = None,
    rounds: int = 60,
    angle_weight: float = 1.0,
) -> Fit:
    """Find joint positions that reach poses, by Levenberg-Marquardt from seeds.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        seeds: (N, n) [rad or m].
        lower: (n,) lower limits to which each step is clipped [rad or m]; None for no clipping.
        upper: (n,) upper limits to which each step is clipped [rad or m]; None for no clipping.
        rounds: the largest number of steps.
        angle_weight: weight of 1 rad against 1 m. With a large weight, the orientation of a pose that is out
            of reach is kept, and only the position misses.

    Returns:
        The best joint positions found; turning joints are not wrapped to (-pi, pi].
    """
    pieces = [slice(start, start + BLOCK) for start in range(0, len(seeds), BLOCK)]
    parts = [
        _fit_block(chain, base_from_flange[p], seeds[p], lower, upper, rounds, angle_weight) for p in pieces
    ]
    if len(parts) == 1:
        return parts[0]
    return Fit(
        np.concatenate([part.q for part in parts]) if parts else np.empty((0, chain.size)),
        np.concatenate([part.miss_position for part in parts]) if parts else np.empty(0),
        np.concatenate([part.miss_angle for part in parts]) if parts else np.empty(0),
    )


def pose_error(columns: Array, target: Array) -> Array:
    """Return the twists (6, N) from frames to their targets: translation [m] above rotation [rad], in the
    axes of {B}.

    The rotation is the rotation vector. For a turn of exactly half a turn, the rotation axis is uncertain; x
    is used.

    Args:
        columns: the frames' columns (4, 3, N).
        target: the targets' columns (4, 3, N).
    """
    error = np.empty((6, columns.shape[2]))
    np.subtract(target[3], columns[3], out=error[:3])
    turn = error[3:]
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        # half the sum of cross products of the axes: the rotation axis times sin(angle)
        turn[row] = 0.5 * (
            (columns[:3, after] * target[:3, before]).sum(axis=0)
            - (columns[:3, before] * target[:3, after]).sum(axis=0)
        )
    cosine = 0.5 * ((columns[:3] * target[:3]).sum(axis=(0, 1)) - 1.0)
    sine = np.sqrt((turn * turn).sum(axis=0))
    # close to the target use sin(angle) instead of the angle: the iteration still converges
    large = cosine < 0.999
    if large.any():
        stretch = np.arctan2(sine, cosine) / np.where(sine > 1e-9, sine, 1.0)
        turn *= np.where(large & (sine > 1e-9), stretch, 1.0)
        turn[0] += np.where((cosine < 0.0) & (sine <= 1e-9), math.pi, 0.0)
    return error


def pose_columns(poses: Array) -> Array:
    """Return poses (N, 4, 4) as columns (4, 3, N)."""
    return np.ascontiguousarray(poses[:, :3].transpose(2, 1, 0))


def misses(columns: Array, target: Array) -> tuple[Array, Array]:
    """Return the distances of frames from their targets, (N,) [m] and (N,) [rad], for columns (4, 3, N)."""
    apart = target - columns
    squares = (apart * apart).sum(axis=1)
    # the Frobenius norm of the difference of two rotations is 2 √2 sin(angle / 2); unlike acos this is
    # accurate for small angles
    chord = np.sqrt(squares[0] + squares[1] + squares[2]) * (0.5 / math.sqrt(2.0))
    return np.sqrt(squares[3]), 2.0 * np.arcsin(np.minimum(chord, 1.0))


def _fit_block(
    chain: Chain,
    poses: Array,
    seeds: Array,
    lower: Array | None,
    upper: Array | None,
    rounds: int,
    angle_weight: float,
) -> Fit:
    """Run `fit` for one block of poses."""
    target = pose_columns(poses)
    best = np.array(seeds.T, dtype=float, order="C")
    if lower is not None and upper is not None:
        best = np.clip(best, lower[:, None], upper[:, None])
    weight = np.ones((6, 1))
    weight[3:] = angle_weight
    columns, jacobian = walk_with_jacobian(chain, best, np.eye(4))
    error = pose_error(columns, target) * weight
    jacobian *= weight[:, None]
    cost = np.einsum("kn,kn->n", error, error)
    done_at = (EXACT * min(1.0, angle_weight)) ** 2
    active = np.flatnonzero(cost > done_at)
    if len(active) < len(cost):
        jacobian, error = jacobian[:, :, active], error[:, active]
    now = cost[active]
    factor = np.full(len(active), 0.1)
    idle = np.zeros(len(active), dtype=int)
    for _ in range(rounds):
        if not len(active):
            break
        go_on()
        # Sugihara's damping, in proportion to the squared error; the largest joint step is limited to STEP
        step = damped_step(jacobian, error, factor * now + FLOOR)
        largest = np.abs(step).max(axis=0)
        step *= np.minimum(1.0, STEP / np.maximum(largest, 1e-300))
        trial = best[:, active] + step
        if lower is not None and upper is not None:
            trial = np.clip(trial, lower[:, None], upper[:, None])
        columns, new_jacobian = walk_with_jacobian(chain, trial, np.eye(4))
        new_error = pose_error(columns, target[:, :, active]) * weight
        new = np.einsum("kn,kn->n", new_error, new_error)
        better = new < now
        # a sample is done if it is exact, or if many steps have brought no gain
        idle = np.where(better & (new < now * (1.0 - 1e-7)), 0, idle + 1)
        factor = np.clip(np.where(better, factor * 0.2, factor * 6.0), 1e-6, 1e12)
        best[:, active[better]] = trial[:, better]
        cost[active[better]] = new[better]
        new_jacobian *= weight[:, None]
        if not better.all():
            new_jacobian = np.where(better, new_jacobian, jacobian)
            new_error, new = np.where(better, new_error, error), np.where(better, new, now)
        keep = (new > done_at) & (idle < 12)
        if keep.all():
            jacobian, error, now = new_jacobian, new_error, new
            continue
        active, factor, idle = active[keep], factor[keep], idle[keep]
        jacobian, error, now = new_jacobian[:, :, keep], new_error[:, keep], new[keep]
    columns = walk_with_jacobian(chain, best, np.eye(4))[0]
    return Fit(np.ascontiguousarray(best.T), *misses(columns, target))


def damped_step(jacobian: Array, error: Array, damping: Array) -> Array:
    """Return the damped least squares step (JᵀJ + damping)⁻¹ Jᵀ e (n, N), for J (6, n, N), e (6, N) and
    damping (N,).

    The smaller of the matrices JᵀJ and JJᵀ is used.
    """
    rows, joints, count = jacobian.shape
    if count <= FEW:
        step = _step_of_few(jacobian, error, damping)
        if step is not None:
            return step
    if joints <= rows:
        normal = np.empty((joints, joints, count))
        for i in range(joints):
            for j in range(i + 1):
                normal[i, j] = normal[j, i] = np.einsum("kn,kn->n", jacobian[:, i], jacobian[:, j])
            normal[i, i] += damping
        return _solve(normal, np.einsum("kjn,kn->jn", jacobian, error))
    # the push-through identity: (JᵀJ + d)⁻¹ Jᵀ = Jᵀ (JJᵀ + d)⁻¹
    normal = np.empty((rows, rows, count))
    for i in range(rows):
        for j in range(i + 1):
            normal[i, j] = normal[j, i] = np.einsum("jn,jn->n", jacobian[i], jacobian[j])
        normal[i, i] += damping
    result: Array = np.einsum("kjn,kn->jn", jacobian, _solve(normal, error.copy()))
    return result


def _step_of_few(jacobian: Array, error: Array, damping: Array) -> Array | None:
    """Return `damped_step` sample by sample, in a tenth of the time for a few samples; None if a matrix is
    singular.
    """
    rows, joints, count = jacobian.shape
    each = jacobian.transpose(2, 0, 1)
    across = each.transpose(0, 2, 1)
    wide = joints > rows
    normal = each @ across if wide else across @ each
    normal.reshape(count, -1)[:, :: len(normal[0]) + 1] += damping[:, None]
    right = error.T[:, :, None]
    try:
        solved = np.linalg.solve(normal, right if wide else across @ right)
    except np.linalg.LinAlgError:
        return None
    if wide:
        solved = across @ solved
    return np.ascontiguousarray(solved[:, :, 0].T, dtype=np.float64)


def _solve(matrix: Array, right: Array) -> Array:
    """Solve the linear systems matrix x = right, for positive definite matrices (m, m, N) and right sides (m,
    N), by Gaussian elimination. Both arguments are overwritten.
    """
    size = len(matrix)
    for k in range(size - 1):
        # Gaussian elimination needs no pivoting: the matrices are positive definite
        factor = matrix[k + 1 :, k] / np.maximum(matrix[k, k], 1e-300)
        matrix[k + 1 :, k + 1 :] -= factor[:, None] * matrix[k, None, k + 1 :]
        right[k + 1 :] -= factor * right[k]
    for k in range(size - 1, -1, -1):
        # back substitution
        right[k] /= np.maximum(matrix[k, k], 1e-300)
        right[:k] -= matrix[:k, k] * right[k]
    return right
