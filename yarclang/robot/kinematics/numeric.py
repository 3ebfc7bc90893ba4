"""Inverse kinematics by damped least squares, for any serial arm and whole batches of poses.

Levenberg-Marquardt with the damping in proportion to the squared error (Sugihara, Solvability-Unconcerned
Inverse Kinematics by the Levenberg-Marquardt Method, IEEE T-RO 27(5), 2011), so that it converges
quadratically where the pose can be reached and to the nearest miss where not. Every sample has its own
damping factor; a step that makes things worse is taken back. The samples are the last index.
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
"""The error at which a solution is done [m and rad]."""

FLOOR = 1e-13
"""The least damping; joints that don't matter at a singularity stay."""

FEW = 128
"""Up to as many samples are solved one by one; more, each operation for all of them."""

BLOCK = 2048
"""Samples that are iterated together."""


@frozen(eq=False)
class Fit:
    """How near the arm comes to poses: `q` (N, n), and the misses (N,) [m] and [rad] that are left."""

    q: Array
    miss_position: Array
    miss_angle: Array

    @property
    def total(self) -> Array:
        """Both misses together (N,), m and rad alike."""
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
    """The joint positions nearest to `seeds` in the sense of Levenberg-Marquardt that reach the poses.

    Args:
        chain: the arm, n joints.
        base_from_flange: (N, 4, 4).
        seeds: (N, n) [rad or m].
        lower: (n,) limits that a step is clipped to [rad or m]; None for no clipping.
        upper: (n,) the same.
        rounds: the most steps.
        angle_weight: what 1 rad counts against 1 m. Large: the orientation is held and the position misses.

    Returns:
        The best joint positions found; not wrapped.
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
    """The twist (6, N) from where the frame stands to where it shall: way [m] above turn [rad], axes of {B}.

    Both poses are columns (4, 3, N). The turn is the rotation vector; half a turn has none and gives 0 in
    its direction, so it is bent a little.
    """
    error = np.empty((6, columns.shape[2]))
    np.subtract(target[3], columns[3], out=error[:3])
    turn = error[3:]
    for row in range(3):
        after, before = (row + 1) % 3, (row + 2) % 3
        turn[row] = 0.5 * (
            (columns[:3, after] * target[:3, before]).sum(axis=0)
            - (columns[:3, before] * target[:3, after]).sum(axis=0)
        )
    cosine = 0.5 * ((columns[:3] * target[:3]).sum(axis=(0, 1)) - 1.0)
    sine = np.sqrt((turn * turn).sum(axis=0))
    large = cosine < 0.999
    if large.any():
        stretch = np.arctan2(sine, cosine) / np.where(sine > 1e-9, sine, 1.0)
        turn *= np.where(large & (sine > 1e-9), stretch, 1.0)
        turn[0] += np.where((cosine < 0.0) & (sine <= 1e-9), math.pi, 0.0)
    return error


def pose_columns(poses: Array) -> Array:
    """Poses (N, 4, 4) as columns (4, 3, N)."""
    return np.ascontiguousarray(poses[:, :3].transpose(2, 1, 0))


def misses(columns: Array, target: Array) -> tuple[Array, Array]:
    """How far frames miss their targets [m] and [rad], (N,) each; columns (4, 3, N)."""
    apart = target - columns
    squares = (apart * apart).sum(axis=1)
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
    """`fit` for one block."""
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
        # done: exact; or many steps without a gain that counts
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
    """(JᵀJ + damping)⁻¹ Jᵀ e (n, N), by whichever of JᵀJ and JJᵀ is smaller; J (6, n, N), e (6, N)."""
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
    normal = np.empty((rows, rows, count))
    for i in range(rows):
        for j in range(i + 1):
            normal[i, j] = normal[j, i] = np.einsum("jn,jn->n", jacobian[i], jacobian[j])
        normal[i, i] += damping
    result: Array = np.einsum("kjn,kn->jn", jacobian, _solve(normal, error.copy()))
    return result


def _step_of_few(jacobian: Array, error: Array, damping: Array) -> Array | None:
    """Return `damped_step` sample by sample, in a tenth of the time for a few; None if a matrix is singular."""
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
    """matrix⁻¹ right for positive definite (m, m, N) and (m, N), by elimination; both are overwritten."""
    size = len(matrix)
    for k in range(size - 1):
        factor = matrix[k + 1 :, k] / np.maximum(matrix[k, k], 1e-300)
        matrix[k + 1 :, k + 1 :] -= factor[:, None] * matrix[k, None, k + 1 :]
        right[k + 1 :] -= factor * right[k]
    for k in range(size - 1, -1, -1):
        right[k] /= np.maximum(matrix[k, k], 1e-300)
        right[:k] -= matrix[:k, k] * right[k]
    return right
