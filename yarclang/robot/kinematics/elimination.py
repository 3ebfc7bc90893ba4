"""All solutions of any arm of six turning joints, by elimination.

The way is that of Raghavan and Roth (Inverse Kinematics of the General 6R Manipulator and Related Linkages, Journal of Mechanical
Design 115(3), 1993), and the last step that of Manocha and Canny (Efficient Inverse Kinematics for General 6R Manipulators, IEEE T-RO
10(5), 1994): fourteen equations in which two angles appear only on one side leave six in the other three angles; in the half tangents of two of these they are
a matrix of twelve rows whose entries are of second degree in the half tangent of the third, and its eigenvalues are the solutions, sixteen at most.

The loop of an arm and its pose may be opened at several joints, and read from either end: that gives six eliminations (`_ORDERS`). Where axes are parallel or meet,
some of them have no regular matrix. So an arm is tried with each of them once, and where none finds all, it is bent a little: isolated solutions move little by it, and iteration brings them back.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import links_of, walk, walk_with_jacobian
from yarclang.robot.kinematics.numeric import pose_columns, pose_error
from yarclang.robot.kinematics.single import pose_with_jacobian, twist_between
from yarclang.robot.model import Array, Chain

MOST = 16
"""The most isolated solutions of a pose."""

BLOCK = 256
"""Poses whose matrices are solved together."""

NEARLY_REAL = 0.05
"""A half tangent whose imaginary part is smaller than this share of it may belong to a real solution."""

BENT = 1e-5
"""How far an arm is bent [rad, and arm lengths] that has no regular matrix."""

TRIED = 12
"""Poses with which the eliminations of an arm are compared."""

STEPS = 14
"""The most steps of the iteration that makes a solution exact."""

LESS = 0.35
"""By this share a miss [m and rad together] becomes less with each step, or the candidate is given up."""

TWIN, NEXT = 0.01, 0.01
"""A solution whose Jacobian has a smallest singular value under this [m and rad] may have another one next to it: it is looked for at multiples of `NEXT` [rad]."""

EXACT = 1e-9
"""The miss [m or rad] up to which a joint position counts as a solution."""

APART = 5e-5
"""Solutions nearer to each other than this in every joint [rad] are one: where two meet, joint positions that far from both reach the pose to `EXACT`."""

_ORDERS = (1, 4, 0, 2, 3, 5)
"""The places at which the loop is opened (0 to 2), and the same read from its other end (3 to 5), those first that suit most arms."""

_OFFSETS = (0.3, 0.7, 1.1)
"""What the three angles are counted from [rad]: a half tangent is infinite half a turn from there, away from angles that people use."""

_THIRDS: Array = 2.0 * math.pi / 3.0 * np.arange(3.0)
_TRIGONOMETRIC = np.linalg.inv(np.stack((np.ones(3), np.cos(_THIRDS), np.sin(_THIRDS)), axis=1))
"""The coefficients of 1, cos, sin from values at three angles."""
_HALVES = np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 2.0], [1.0, -1.0, 0.0]])
"""The coefficients of 1, x, x² from those of 1, cos, sin, x the half tangent, all times 1 + x²."""


@frozen(eq=False)
class Elimination:
    """The constants of one elimination for an arm.

    `first` and `last` (4, 4) lie before the first joint's frame and after the last one's, `steps` (5, 4, 4) between the joints' frames; lengths are in units of
    `scale` [m]. `order` says where the loop is opened.
    """

    first: Array
    last: Array
    steps: Array
    scale: float
    order: int


def every_solution(chain: Chain, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return all isolated solutions of poses, without regard to limits.

    Args:
        chain: an arm of six turning joints.
        base_from_flange: (N, 4, 4).

    Returns:
        q (N, MOST, 6) in (-pi, pi] [rad], those of a pose in the order of their joint values, and which of them there are (N, MOST). Each reaches its pose by forward kinematics. A pose
        that leaves a joint free has some of its continuum.
    """
    q = np.zeros((len(base_from_flange), MOST, 6))
    valid = np.zeros((len(base_from_flange), MOST), dtype=bool)
    form = best_elimination(chain)
    for start in range(0, len(base_from_flange), BLOCK):
        piece = slice(start, start + BLOCK)
        rows, found = candidates(form, base_from_flange[piece])
        q[piece], valid[piece] = _with_twins(
            chain, base_from_flange[piece], *distinct(chain, base_from_flange[piece], rows, found)
        )
    return q, valid


def _with_twins(
    chain: Chain, base_from_flange: Array, q: Array, valid: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.bool_]]:
    """Return solutions (N, MOST, 6), and which of them there are (N, MOST), with those that are all but the same as one of them.

    Where two solutions are about to meet, their half tangents are as good as a double one, and iteration may lead from both to the same. They are apart along the motion of the joints
    that doesn't move the flange.
    """
    rows, which = np.nonzero(valid)
    here = q[rows, which]
    jacobian = walk_with_jacobian(chain, np.ascontiguousarray(here.T), np.eye(4))[1].transpose(2, 0, 1)
    _, values, right = np.linalg.svd(jacobian)
    close = np.flatnonzero(values[:, -1] < TWIN)
    if not len(close):
        return q, valid
    ways = np.array([-4.0, -1.0, 1.0, 4.0]) * NEXT
    twins = (here[close, None] + ways[:, None] * right[close, -1][:, None]).reshape(-1, 6)
    owners = np.concatenate((rows, np.repeat(rows[close], len(ways))))
    again, order = np.unique(rows[close]), np.concatenate((here, twins))
    chosen = np.isin(owners, again)
    q[again], valid[again] = distinct(
        chain, base_from_flange[again], np.searchsorted(again, owners[chosen]), order[chosen]
    )
    return q, valid


def distinct(
    chain: Chain, base_from_flange: Array, rows: NDArray[np.int_], candidate: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Make candidates exact, and return those that reach their poses, each once.

    Args:
        chain: an arm of six turning joints.
        base_from_flange: (N, 4, 4).
        rows: (K,) to which pose each candidate belongs.
        candidate: (K, 6) [rad].

    Returns:
        q (N, MOST, 6) in (-pi, pi] [rad], and which of them there are (N, MOST).
    """
    count = len(base_from_flange)
    q, valid = np.zeros((count, MOST, 6)), np.zeros((count, MOST), dtype=bool)
    found, miss = polished(chain, base_from_flange[rows], candidate)
    good = miss < EXACT
    rows, found = rows[good], found[good]
    found -= 2.0 * math.pi * np.round(found / (2.0 * math.pi))
    # in the order of joint values, rounded, so that the last bit doesn't decide
    order = np.lexsort((*np.round(found.T[::-1], 5), rows))
    rows, found = rows[order], found[order]
    # each candidate among those of its pose
    place = np.arange(len(rows)) - np.searchsorted(rows, rows)
    width = int(place.max(initial=0)) + 1
    table, there = np.full((count, width, 6), np.nan), np.zeros((count, width), dtype=bool)
    table[rows, place], there[rows, place] = found, True
    away = table[:, :, None] - table[:, None]
    away -= 2.0 * math.pi * np.round(away / (2.0 * math.pi))
    same = (np.abs(away).max(axis=3) < APART) & np.tri(width, k=-1, dtype=bool)
    first = there & ~same.any(axis=2)
    number = np.cumsum(first, axis=1) - 1
    first &= number < MOST
    pose, kept = np.nonzero(first)
    q[pose, number[pose, kept]], valid[pose, number[pose, kept]] = table[pose, kept], True
    return q, valid


def polished(chain: Chain, base_from_flange: Array, q: Array) -> tuple[Array, Array]:
    """Return candidates (K, 6) made exact by Newton's method, damped a little, and what each misses its pose (K, 4, 4) by [m and rad together]."""
    if len(q) == 1:
        one, left = _polished_one(chain, base_from_flange[0], q[0])
        return one[None], np.array([left])
    target = pose_columns(base_from_flange)
    best = np.ascontiguousarray(q.T)
    trial, miss = best.copy(), np.full(len(q), np.inf)
    active = np.arange(len(q))
    for step_number in range(STEPS):
        columns, jacobian = walk_with_jacobian(chain, trial[:, active], np.eye(4))
        error = pose_error(columns, target[:, :, active])
        size = np.sqrt((error * error).sum(axis=0))
        better = size < miss[active]
        kept = active[better]
        best[:, kept], miss[kept] = trial[:, kept], size[better]
        # what is exact as far as numbers go is done, and so is what goes nowhere: even towards a double solution the miss is quartered
        going = (size > EXACT) | (better & (size > 1e-12))
        going &= size < LESS**step_number
        if not going.any():
            break
        active, jacobian, error = active[going], jacobian[:, :, going].transpose(2, 0, 1), error[:, going].T
        squares = jacobian.transpose(0, 2, 1) @ jacobian
        # enough that axes which fall together leave it regular
        least = 1e-14 * np.trace(squares, axis1=1, axis2=2) + 1e-15
        squares += (least + 1e-3 * np.square(size[going]))[:, None, None] * np.eye(6)
        step = np.linalg.solve(squares, jacobian.transpose(0, 2, 1) @ error[:, :, None])[:, :, 0]
        step *= np.minimum(1.0, 0.5 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        trial[:, active] += step.T
    return np.ascontiguousarray(best.T), miss


def _polished_one(chain: Chain, base_from_flange: Array, q: Array) -> tuple[Array, float]:
    """Return `polished` of one candidate (6,) for one pose (4, 4), in a third of its time."""
    best, miss = q, math.inf
    for step_number in range(STEPS):
        pose, jacobian = pose_with_jacobian(chain, q)
        error = twist_between(pose, base_from_flange)
        size = math.sqrt(float(error @ error))
        better = size < miss
        if better:
            best, miss = q, size
        going = size > EXACT or (better and size > 1e-12)
        if not (going and size < LESS**step_number):
            break
        squares = jacobian.T @ jacobian
        least = 1e-14 * float(np.trace(squares)) + 1e-15
        squares += (least + 1e-3 * size * size) * np.eye(6)
        step = np.linalg.solve(squares, jacobian.T @ error)
        q = q + step * min(1.0, 0.5 / max(float(np.abs(step).max()), 1e-300))
    return best, miss


def misses_of(chain: Chain, base_from_flange: Array, q: Array) -> Array:
    """Return what joint positions (K, n) miss their poses (K, 4, 4) by, (K,) [m and rad together]."""
    columns = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[0]
    error = pose_error(columns, pose_columns(base_from_flange))
    result: Array = np.sqrt((error * error).sum(axis=0))
    return result


@lru_cache(maxsize=64)
def best_elimination(chain: Chain) -> Elimination:
    """Return the elimination that finds most for an arm, remembered by the chain's identity.

    Any that finds the joint positions that poses were made of, all of them, and no fewer others than another, will do: the first of these is taken.
    """
    from yarclang.robot.kinematics.fk import flange_poses

    random = np.random.default_rng(0)
    q = random.uniform(-3.0, 3.0, (TRIED, 6))
    poses = flange_poses(chain, q)
    # an arm that reaches no pose in an isolated way has none that is good
    best, most, sure = _bent(chain, _ORDERS[0]), -1, 0
    for form in (
        *(_elimination(chain, order) for order in _ORDERS),
        *(_bent(chain, order) for order in _ORDERS),
    ):
        rows, found = candidates(form, poses, is_trial=True)
        if not len(rows):
            continue
        solved, valid = distinct(chain, poses, rows, found)
        total = int(valid.sum())
        if total > most:
            best, most, sure = form, total, 0
        elif total == most:
            # another way finds as many: there are no more
            away = solved - q[:, None]
            away -= 2.0 * math.pi * np.round(away / (2.0 * math.pi))
            near = np.where(valid, np.abs(away).max(axis=2), np.inf).min(axis=1)
            sure += bool((near < 1e-4).all())
            if sure == 2:
                break
    return best


def candidates(
    form: Elimination, base_from_flange: Array, *, is_trial: bool = False
) -> tuple[NDArray[np.int_], Array]:
    """Return what an elimination finds of poses (N, 4, 4): to which pose each candidate belongs (K,), and its joint positions (K, 6) [rad].

    A pose whose matrix isn't regular is solved with the arm bent a little. Of a trial, nothing is found then.
    """
    try:
        return _solved(form, base_from_flange)
    except np.linalg.LinAlgError:
        if is_trial:
            return np.empty(0, dtype=int), np.empty((0, 6))
    if len(base_from_flange) > 1:
        parts = [candidates(form, pose[None]) for pose in base_from_flange]
        rows = np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts])
        return rows, np.concatenate([part[1] for part in parts])
    for size in (10.0 * BENT, 100.0 * BENT):
        try:
            return _solved(_bent_form(form, size), base_from_flange)
        except np.linalg.LinAlgError:
            continue
    return np.empty(0, dtype=int), np.empty((0, 6))


def _elimination(chain: Chain, order: int) -> Elimination:
    links = links_of(chain)
    first, steps = np.eye(4), links.steps[1:].transpose(0, 2, 1).copy()
    first[:3] = links.first.T
    scale = float(np.linalg.norm(steps[:, :3, 3], axis=1).sum()) / 3.0 + 1e-9
    steps[:, :3, 3] /= scale
    return Elimination(first=first, last=links.last, steps=steps, scale=scale, order=order)


def _bent(chain: Chain, order: int) -> Elimination:
    return _bent_form(_elimination(chain, order), BENT)


def _bent_form(form: Elimination, size: float) -> Elimination:
    """Return the elimination of an arm that is bent between its joints by about `size` [rad, and lengths in units of its scale]."""
    random = np.random.default_rng(5)
    steps = form.steps.copy()
    for step in steps:
        turn = size * random.normal(size=3)
        angle = float(np.linalg.norm(turn))
        x, y, z = turn / angle
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        step[:3, :3] @= np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
        step[:3, 3] += size * random.normal(size=3)
    return Elimination(first=form.first, last=form.last, steps=steps, scale=form.scale, order=form.order)


def _loop(form: Elimination, base_from_flange: Array) -> tuple[list[int], list[Array], float]:
    """Return the loop of arm and pose from where it is opened: joints, the transform after each of them ((4, 4), or (N, 4, 4) of the pose), the sense of the angles."""
    between = _inverse(form.first) @ base_from_flange @ _inverse(form.last)
    between[:, :3, 3] /= form.scale
    joints, steps = list(range(6)), [*form.steps, _inverse(between)]
    if form.order >= 3:
        joints = joints[::-1]
        steps = [_inverse(steps[place]) for place in (4, 3, 2, 1, 0, 5)]
    moved = form.order % 3
    if moved:
        joints, steps = joints[-moved:] + joints[:-moved], steps[-moved:] + steps[:-moved]
    return joints, steps, -1.0 if form.order >= 3 else 1.0


@lru_cache(maxsize=256)
def _left_side(form: Elimination) -> Array:
    """Return the side of the fourteen equations that no pose is in: coefficients (14, 3, 3, 3) of 1, cos, sin of the third, fourth and fifth angle of the loop."""
    _, (_, _, cd, de, ef, _), _ = _loop(form, np.eye(4)[None])
    turned_c = _turns(_THIRDS + _OFFSETS[0])[:, None, None]
    turned_d = _turns(_THIRDS + _OFFSETS[1])[None, :, None]
    turned_e = _turns(_THIRDS + _OFFSETS[2])[None, None]
    left = turned_c @ cd @ turned_d @ de @ turned_e @ ef
    values = _fourteen(left[..., :3, 2], left[..., :3, 3])
    side: Array = np.einsum("xi,yj,zk,ijkm->mxyz", _TRIGONOMETRIC, _TRIGONOMETRIC, _TRIGONOMETRIC, values)
    side.setflags(write=False)
    return side


def _solved(form: Elimination, base_from_flange: Array) -> tuple[NDArray[np.int_], Array]:
    """Return candidates of poses, as `candidates`.

    Raises:
        numpy.linalg.LinAlgError: a matrix is not regular.
    """
    count = len(base_from_flange)
    joints, (ab, bc, cd, de, ef, fa), sense = _loop(form, base_from_flange)
    # R_c cd R_d de R_e ef = bc⁻¹ R_b⁻¹ ab⁻¹ R_a⁻¹ fa⁻¹ R_f⁻¹: its third and fourth columns are free of the last angle
    three = _left_side(form)
    back = _turns(-_THIRDS)
    right = _inverse(fa)[..., 2:4]
    right = _inverse(ab) @ (back[:, None] @ (right if right.ndim == 3 else right[None]))
    right = _inverse(bc) @ (back[:, None, None] @ right[None])
    two = _fourteen(right[..., :3, 0], right[..., :3, 1])
    two = np.einsum("xi,yj,ijnm->nmyx", _TRIGONOMETRIC, _TRIGONOMETRIC, two).reshape(count, 14, 9)
    constant, factors = two[:, :, 0], two[:, :, 1:]
    # six combinations of the equations are free of the first two angles
    free = np.linalg.qr(factors, mode="complete")[0][:, :, 8:].transpose(0, 2, 1)
    six = (free @ three.reshape(14, 27)).reshape(count, 6, 3, 3, 3)
    six[:, :, 0, 0, 0] -= (free @ constant[:, :, None])[:, :, 0]
    six = (six.reshape(-1, 27) @ _TO_HALVES).reshape(count, 6, 3, 3, 3)
    twelve = np.zeros((count, 3, 12, 4, 3))
    twelve[:, :, :6, :3] = six.transpose(0, 2, 1, 3, 4)
    twelve[:, :, 6:, 1:] = twelve[:, :, :6, :3]
    matrices = twelve.reshape(count, 3, 12, 12)
    companion = np.zeros((count, 24, 24))
    companion[:, :12, 12:] = np.eye(12)
    companion[:, 12:] = -np.linalg.solve(
        matrices[:, 2], np.concatenate((matrices[:, 0], matrices[:, 1]), axis=2)
    )
    values, vectors = np.linalg.eig(companion)
    # of two that are all but one real value, one
    real = (np.abs(values.imag) < NEARLY_REAL * np.maximum(np.abs(values), 1e-3)) & (values.imag >= 0.0)
    rows, which = np.nonzero(real)
    value, vector = values[rows, which].real, vectors[rows, :, which]
    vector = np.where((np.abs(value) > 1.0)[:, None], vector[:, 12:], vector[:, :12])
    largest = np.take_along_axis(vector, np.argmax(np.abs(vector), axis=1)[:, None], axis=1)
    powers = (vector / largest).real.reshape(-1, 4, 3)
    c: Array = 2.0 * np.arctan(value)
    d = _angle(powers[:, :3].reshape(-1, 9), powers[:, 1:].reshape(-1, 9))
    e = _angle(powers[:, :, :2].reshape(-1, 8), powers[:, :, 1:].reshape(-1, 8))
    bases = [np.stack((np.ones_like(angle), np.cos(angle), np.sin(angle)), axis=1) for angle in (c, d, e)]
    products = (bases[0][:, :, None, None] * bases[1][:, None, :, None] * bases[2][:, None, None]).reshape(
        -1, 27
    )
    wanted = products @ three.reshape(14, 27).T - constant[rows]
    solved = (np.linalg.pinv(factors)[rows] @ wanted[:, :, None])[:, :, 0]
    a, b = np.arctan2(solved[:, 5], solved[:, 2]), np.arctan2(solved[:, 1], solved[:, 0])
    angles = [a, b, *(angle + offset for angle, offset in zip((c, d, e), _OFFSETS, strict=True))]
    rest = np.broadcast_to(np.eye(4), (len(rows), 4, 4))
    for angle, step in zip(angles, (ab, bc, cd, de, ef), strict=True):
        rest = rest @ _turns(angle) @ (step if step.ndim == 2 else step[rows])
    last = _inverse(rest) @ _inverse(fa if fa.ndim == 2 else fa[rows])
    angles.append(np.arctan2(last[:, 1, 0] - last[:, 0, 1], last[:, 0, 0] + last[:, 1, 1]))
    q = np.empty((len(rows), 6))
    q[:, joints] = sense * np.stack(angles, axis=1)
    usable = np.isfinite(q).all(axis=1)
    return rows[usable], q[usable]


_TO_HALVES = np.einsum("xi,yj,zk->ijkxyz", _HALVES, _HALVES, _HALVES).reshape(27, 27)
"""From products of 1, cos, sin of three angles to products of powers of their half tangents."""


def _fourteen(axis: Array, point: Array) -> Array:
    """Return the fourteen expressions (..., 14) in a frame's z axis and origin (..., 3) that are linear in cos and sin of each angle."""
    square = (point * point).sum(axis=-1, keepdims=True)
    along = (point * axis).sum(axis=-1, keepdims=True)
    across = np.stack(
        [
            point[..., 1] * axis[..., 2] - point[..., 2] * axis[..., 1],
            point[..., 2] * axis[..., 0] - point[..., 0] * axis[..., 2],
            point[..., 0] * axis[..., 1] - point[..., 1] * axis[..., 0],
        ],
        axis=-1,
    )
    return np.concatenate((point, axis, square, along, across, square * axis - 2.0 * along * point), axis=-1)


def _angle(lower: Array, higher: Array) -> Array:
    """Return the angle (K,) whose half tangent takes each entry of `lower` (K, m) to that of `higher`, as nearly as can be; pi for an infinite one."""
    result: Array = np.arctan2(
        2.0 * (lower * higher).sum(axis=1), (lower * lower).sum(axis=1) - (higher * higher).sum(axis=1)
    )
    return result


def _turns(angle: Array) -> Array:
    """Return the turns about z (..., 4, 4) by angles (...) [rad]."""
    turn, sin, cos = np.zeros((*angle.shape, 4, 4)), np.sin(angle), np.cos(angle)
    turn[..., 0, 0] = turn[..., 1, 1] = cos
    turn[..., 1, 0], turn[..., 0, 1] = sin, -sin
    turn[..., 2, 2] = turn[..., 3, 3] = 1.0
    return turn


def _inverse(transform: Array) -> Array:
    """Return the inverse of rigid transforms (..., 4, 4)."""
    result = np.zeros_like(transform)
    result[..., :3, :3] = transform[..., :3, :3].swapaxes(-1, -2)
    result[..., :3, 3] = -(result[..., :3, :3] @ transform[..., :3, 3:])[..., 0]
    result[..., 3, 3] = 1.0
    return result
