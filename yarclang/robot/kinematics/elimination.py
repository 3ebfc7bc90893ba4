"""Find all solutions of any arm with six turning joints, by elimination.

The method is that of Raghavan and Roth (Inverse Kinematics of the General 6R Manipulator and Related
Linkages, Journal of Mechanical Design 115(3), 1993), with the last step of Manocha and Canny (Efficient
Inverse Kinematics for General 6R Manipulators, IEEE T-RO 10(5), 1994). Fourteen equations contain five of the
six angles. Two of these angles appear only on the right sides, and are eliminated; six equations in the other
three angles remain. The half tangent of an angle is the tangent of half the angle. In the half tangents of
two of the three angles, the equations have a 12 by 12 matrix, whose entries are quadratic in the half tangent
of the third angle. The eigenvalues of this quadratic matrix are the third angle's half tangents in all
solutions, at most sixteen.

The arm and its pose form a closed loop of joints. This loop can be opened at several joints and read from
either end; six of these possibilities are used as eliminations (`_ORDERS`). If axes are parallel or meet,
some of these have no regular matrix. Each arm is therefore tried once with all six. If a pose has no regular
matrix, the geometry of the arm is changed a little (bent). Isolated solutions then also change only a little,
and iteration brings them back to solutions of the real arm.
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
"""The largest number of isolated solutions of a pose."""

BLOCK = 256
"""Number of poses whose matrices are solved together."""

NEARLY_REAL = 0.05
"""Largest ratio of imaginary part to magnitude of a half tangent that may belong to a real solution."""

BENT = 1e-5
"""Size of the change to the geometry of an arm that has no regular matrix [rad, and units of `scale`]. For a
single pose without a regular matrix, the change is 10 or 100 times as large.
"""

TRIED = 12
"""Number of poses for which each possible elimination of an arm is tried, to find the most accurate one."""

STEPS = 14
"""The largest number of iteration steps that improve a solution."""

LESS = 0.35
"""Bound on the miss of a candidate [m and rad together]: a candidate that misses its pose by `LESS`**k or
more after k iteration steps is given up.
"""

TWIN, NEXT = 0.01, 0.01
"""A solution whose Jacobian has a smallest singular value below `TWIN` [m and rad] may have another solution
nearby, which is searched for at multiples of `NEXT` [rad].
"""

EXACT = 1e-9
"""The miss [m or rad] up to which a joint position counts as a solution."""

APART = 5e-5
"""Solutions that differ by less than this in every joint [rad] count as one. Near the place where two
solutions meet, joint positions at this distance from both solutions miss the pose by no more than `EXACT`.
"""

_ORDERS = (1, 4, 0, 2, 3, 5)
"""Numbers of the eliminations, those that suit most arms first. Elimination k reads the loop of arm and pose
forwards if k is below 3, otherwise backwards. It opens the loop k mod 3 joints before its first joint.
"""

_OFFSETS = (0.3, 0.7, 1.1)
"""Zero points from which the three remaining angles are counted [rad]. At half a turn from its zero point, an
angle has an infinite half tangent. These zero points are chosen so that solutions seldom have such an angle.
"""

_THIRDS: Array = 2.0 * math.pi / 3.0 * np.arange(3.0)
_TRIGONOMETRIC = np.linalg.inv(np.stack((np.ones(3), np.cos(_THIRDS), np.sin(_THIRDS)), axis=1))
"""Matrix that maps the values of an expression at three angles to its coefficients of 1, cos, sin."""
_HALVES = np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 2.0], [1.0, -1.0, 0.0]])
"""Matrix that maps an expression in 1, cos and sin to the half tangent x. It takes the coefficients of 1,
cos, sin, and gives the coefficients of 1, x, x² of the expression times 1 + x².
"""


@frozen(eq=False)
class Elimination:
    """The constants of one elimination for an arm.

    Attributes:
        first: (4, 4) transform before the first joint's frame, lengths in m.
        last: (4, 4) transform after the last joint's frame, lengths in m.
        steps: (5, 4, 4) transforms between the joints' frames, lengths in units of `scale`.
        scale: length that is the unit of `steps` [m].
        order: number of the elimination, one of `_ORDERS`.
    """

    first: Array
    last: Array
    steps: Array
    scale: float
    order: int


def every_solution(chain: Chain, base_from_flange: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Find all isolated solutions of poses, without regard to limits.

    Args:
        chain: an arm of six turning joints.
        base_from_flange: (N, 4, 4).

    Returns:
        q (N, MOST, 6) in (-pi, pi] [rad], sorted by joint values within a pose, and a mask (N, MOST) of the
        entries that are solutions. Each solution reaches its pose by forward kinematics. If a pose leaves a
        joint free, it has infinitely many solutions, of which only some are returned.
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
    """Return solutions (N, MOST, 6) and their mask (N, MOST), with solutions added that are close neighbours
    of those found.

    If two solutions are about to meet, their half tangents nearly form a double root, and iteration may bring
    both candidates to the same solution. The two solutions differ along the joint motion that leaves the
    flange at rest. The second solution is therefore searched for in this direction.
    """
    rows, which = np.nonzero(valid)
    candidates = q[rows, which]
    jacobian = walk_with_jacobian(chain, np.ascontiguousarray(candidates.T), np.eye(4))[1].transpose(2, 0, 1)
    _, values, right = np.linalg.svd(jacobian)
    close = np.flatnonzero(values[:, -1] < TWIN)
    if not len(close):
        return q, valid
    ways = np.array([-4.0, -1.0, 1.0, 4.0]) * NEXT
    twins = (candidates[close, None] + ways[:, None] * right[close, -1][:, None]).reshape(-1, 6)
    owners = np.concatenate((rows, np.repeat(rows[close], len(ways))))
    again, order = np.unique(rows[close]), np.concatenate((candidates, twins))
    chosen = np.isin(owners, again)
    q[again], valid[again] = distinct(
        chain, base_from_flange[again], np.searchsorted(again, owners[chosen]), order[chosen]
    )
    return q, valid


def distinct(
    chain: Chain, base_from_flange: Array, rows: NDArray[np.int_], candidate: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Improve approximate solutions (candidates) by iteration, and return the distinct ones that reach their
    poses.

    Args:
        chain: an arm of six turning joints.
        base_from_flange: (N, 4, 4).
        rows: (K,) the index of each candidate's pose, sorted.
        candidate: (K, 6) [rad].

    Returns:
        q (N, MOST, 6) in (-pi, pi] [rad], and a mask (N, MOST) of the entries that are solutions.
    """
    count = len(base_from_flange)
    q, valid = np.zeros((count, MOST, 6)), np.zeros((count, MOST), dtype=bool)
    solutions, miss = polished(chain, base_from_flange[rows], candidate)
    good = miss < EXACT
    rows, solutions = rows[good], solutions[good]
    solutions -= 2.0 * math.pi * np.round(solutions / (2.0 * math.pi))
    # sort by rounded joint values, so that the order doesn't depend on the last bit
    order = np.lexsort((*np.round(solutions.T[::-1], 5), rows))
    rows, solutions = rows[order], solutions[order]
    # number each candidate within its pose
    place = np.arange(len(rows)) - np.searchsorted(rows, rows)
    width = int(place.max(initial=0)) + 1
    table, filled = np.full((count, width, 6), np.nan), np.zeros((count, width), dtype=bool)
    table[rows, place], filled[rows, place] = solutions, True
    away = table[:, :, None] - table[:, None]
    away -= 2.0 * math.pi * np.round(away / (2.0 * math.pi))
    same = (np.abs(away).max(axis=3) < APART) & np.tri(width, k=-1, dtype=bool)
    first = filled & ~same.any(axis=2)
    number = np.cumsum(first, axis=1) - 1
    first &= number < MOST
    pose, kept = np.nonzero(first)
    q[pose, number[pose, kept]], valid[pose, number[pose, kept]] = table[pose, kept], True
    return q, valid


def polished(chain: Chain, base_from_flange: Array, q: Array) -> tuple[Array, Array]:
    """Improve approximate solutions (candidates) (K, 6) by slightly damped Newton steps.

    Args:
        chain: an arm of six turning joints.
        base_from_flange: (K, 4, 4), one pose for each candidate.
        q: (K, 6) [rad].

    Returns:
        The improved joint positions (K, 6) [rad], and by how much they miss their poses (K,) [m and rad
        together].
    """
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
        # stop at the accuracy of floating point, and give up candidates that don't converge. Even at a double
        # root, where Newton's method converges only linearly, each step reduces the miss to a quarter, which
        # is less than `LESS`
        going = (size > EXACT) | (better & (size > 1e-12))
        going &= size < LESS**step_number
        if not going.any():
            break
        active, jacobian, error = active[going], jacobian[:, :, going].transpose(2, 0, 1), error[:, going].T
        squares = jacobian.transpose(0, 2, 1) @ jacobian
        # this much damping keeps the matrix regular even if axes coincide
        least = 1e-14 * np.trace(squares, axis1=1, axis2=2) + 1e-15
        squares += (least + 1e-3 * np.square(size[going]))[:, None, None] * np.eye(6)
        step = np.linalg.solve(squares, jacobian.transpose(0, 2, 1) @ error[:, :, None])[:, :, 0]
        step *= np.minimum(1.0, 0.5 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        trial[:, active] += step.T
    return np.ascontiguousarray(best.T), miss


def _polished_one(chain: Chain, base_from_flange: Array, q: Array) -> tuple[Array, float]:
    """Compute `polished` for one candidate (6,) and one pose (4, 4), in a third of the time."""
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
    """Return the distances (K,) [m and rad together] of joint positions (K, n) from their poses (K, 4, 4)."""
    columns = walk(chain, np.ascontiguousarray(q.T), np.eye(4))[0]
    error = pose_error(columns, pose_columns(base_from_flange))
    result: Array = np.sqrt((error * error).sum(axis=0))
    return result


@lru_cache(maxsize=64)
def best_elimination(chain: Chain) -> Elimination:
    """Return the elimination that finds the most solutions for an arm, cached by the chain's identity.

    Each elimination is tried on the poses of a few random joint positions. The search ends as soon as three
    eliminations have found the same largest number of solutions, and the last two of them also found all
    these joint positions again. Otherwise the elimination with the most solutions wins.
    """
    from yarclang.robot.kinematics.fk import flange_poses

    random = np.random.default_rng(0)
    q = random.uniform(-3.0, 3.0, (TRIED, 6))
    poses = flange_poses(chain, q)
    # this elimination is returned if none yields candidates, as for an arm without isolated solutions
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
            # count the further eliminations that find equally many solutions, the known joint positions among
            # them. After two of these, assume that there are no more solutions
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
    """Compute candidates (approximate solutions) for poses by an elimination.

    If the matrix of a pose isn't regular, the geometry of the arm is bent a little and the pose is solved
    again.

    Args:
        form: the elimination.
        base_from_flange: (N, 4, 4).
        is_trial: True to return nothing instead of bending the arm.

    Returns:
        The index of each candidate's pose (K,), and joint positions (K, 6) [rad].
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
    """Return the elimination of an arm whose geometry is bent at random between its joints, by about `size`
    [rad, and lengths in units of `form.scale`].
    """
    random = np.random.default_rng(5)
    steps = form.steps.copy()
    for step in steps:
        turn = size * random.normal(size=3)
        angle = float(np.linalg.norm(turn))
        x, y, z = turn / angle
        # Rodrigues' formula
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        step[:3, :3] @= np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
        step[:3, 3] += size * random.normal(size=3)
    return Elimination(first=form.first, last=form.last, steps=steps, scale=form.scale, order=form.order)


def _loop(form: Elimination, base_from_flange: Array) -> tuple[list[int], list[Array], float]:
    """Return the closed loop that the arm and a pose form, starting at the joint at which the elimination
    opens the loop.

    Returns:
        The joints in the loop's order; the transform after each joint; and the sign of the angles. The
            transforms are (4, 4), except for the one that contains the poses, which is (N, 4, 4).
    """
    # the pose closes the loop: the inverse of `between` is the transform from the last joint to the first
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
    """Return the side of the fourteen equations that doesn't depend on the pose.

    Returns:
        Coefficients (14, 3, 3, 3) of 1, cos, sin of the loop's third, fourth and fifth angle.
    """
    _, (_, _, cd, de, ef, _), _ = _loop(form, np.eye(4)[None])
    turned_c = _turns(_THIRDS + _OFFSETS[0])[:, None, None]
    turned_d = _turns(_THIRDS + _OFFSETS[1])[None, :, None]
    turned_e = _turns(_THIRDS + _OFFSETS[2])[None, None]
    # evaluate the left side at three values of each angle, which determine its coefficients of 1, cos, sin
    left = turned_c @ cd @ turned_d @ de @ turned_e @ ef
    values = _fourteen(left[..., :3, 2], left[..., :3, 3])
    side: Array = np.einsum("xi,yj,zk,ijkm->mxyz", _TRIGONOMETRIC, _TRIGONOMETRIC, _TRIGONOMETRIC, values)
    side.setflags(write=False)
    return side


def _solved(form: Elimination, base_from_flange: Array) -> tuple[NDArray[np.int_], Array]:
    """Return candidates (approximate solutions) for poses, as `candidates` does, without bending the arm.

    Raises:
        numpy.linalg.LinAlgError: a matrix is not regular.
    """
    count = len(base_from_flange)
    joints, (ab, bc, cd, de, ef, fa), sense = _loop(form, base_from_flange)
    # the closed loop, with R_x for the turn of joint x: R_c cd R_d de R_e ef = bc⁻¹ R_b⁻¹ ab⁻¹ R_a⁻¹ fa⁻¹
    # R_f⁻¹. The third and fourth columns don't contain the last angle f
    three = _left_side(form)
    back = _turns(-_THIRDS)
    right = _inverse(fa)[..., 2:4]
    right = _inverse(ab) @ (back[:, None] @ (right if right.ndim == 3 else right[None]))
    right = _inverse(bc) @ (back[:, None, None] @ right[None])
    two = _fourteen(right[..., :3, 0], right[..., :3, 1])
    two = np.einsum("xi,yj,ijnm->nmyx", _TRIGONOMETRIC, _TRIGONOMETRIC, two).reshape(count, 14, 9)
    constant, factors = two[:, :, 0], two[:, :, 1:]
    # keep the six combinations of the fourteen equations that contain no terms in the first two angles
    free = np.linalg.qr(factors, mode="complete")[0][:, :, 8:].transpose(0, 2, 1)
    six = (free @ three.reshape(14, 27)).reshape(count, 6, 3, 3, 3)
    six[:, :, 0, 0, 0] -= (free @ constant[:, :, None])[:, :, 0]
    six = (six.reshape(-1, 27) @ _TO_HALVES).reshape(count, 6, 3, 3, 3)
    # multiply each of the six by the half tangent of the fourth angle: twelve equations in twelve monomials
    twelve = np.zeros((count, 3, 12, 4, 3))
    twelve[:, :, :6, :3] = six.transpose(0, 2, 1, 3, 4)
    twelve[:, :, 6:, 1:] = twelve[:, :, :6, :3]
    matrices = twelve.reshape(count, 3, 12, 12)
    # linearize the quadratic eigenvalue problem: the companion matrix of A0 + A1 x + A2 x²
    companion = np.zeros((count, 24, 24))
    companion[:, :12, 12:] = np.eye(12)
    companion[:, 12:] = -np.linalg.solve(
        matrices[:, 2], np.concatenate((matrices[:, 0], matrices[:, 1]), axis=2)
    )
    values, vectors = np.linalg.eig(companion)
    # if a conjugate pair is nearly a real double value, keep one of the two
    real = (np.abs(values.imag) < NEARLY_REAL * np.maximum(np.abs(values), 1e-3)) & (values.imag >= 0.0)
    rows, which = np.nonzero(real)
    value, vector = values[rows, which].real, vectors[rows, :, which]
    # the eigenvector is (v, x v): the larger half is the more accurate one
    vector = np.where((np.abs(value) > 1.0)[:, None], vector[:, 12:], vector[:, :12])
    largest = np.take_along_axis(vector, np.argmax(np.abs(vector), axis=1)[:, None], axis=1)
    powers = (vector / largest).real.reshape(-1, 4, 3)
    # entries of v are monomials of the half tangents of d and e: their ratios give the angles
    c: Array = 2.0 * np.arctan(value)
    # v[i, k] is proportional to d^i e^k: neighbouring rows and columns have the ratios d and e.
    d = _angle(powers[:, :3].reshape(-1, 9), powers[:, 1:].reshape(-1, 9))
    e = _angle(powers[:, :, :2].reshape(-1, 8), powers[:, :, 1:].reshape(-1, 8))
    bases = [np.stack((np.ones_like(angle), np.cos(angle), np.sin(angle)), axis=1) for angle in (c, d, e)]
    products = (bases[0][:, :, None, None] * bases[1][:, None, :, None] * bases[2][:, None, None]).reshape(
        -1, 27
    )
    # with c, d, e known, a and b follow from the fourteen equations by least squares
    wanted = products @ three.reshape(14, 27).T - constant[rows]
    solved = (np.linalg.pinv(factors)[rows] @ wanted[:, :, None])[:, :, 0]
    a, b = np.arctan2(solved[:, 5], solved[:, 2]), np.arctan2(solved[:, 1], solved[:, 0])
    angles = [a, b, *(angle + offset for angle, offset in zip((c, d, e), _OFFSETS, strict=True))]
    # the last angle closes the loop
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
"""Matrix that maps products of 1, cos, sin of three angles to products of powers of their half tangents."""


def _fourteen(axis: Array, point: Array) -> Array:
    """Return the fourteen expressions (..., 14) of Raghavan and Roth, for the z axis l and the origin p of a
    frame, (..., 3) each.

    They are p, l, p·p, p·l, p x l, and (p·p) l - 2 (p·l) p. All of them are linear in cos and sin of each
    angle.
    """
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
    """Return the angle (K,) [rad] whose half tangent t solves t * `lower` = `higher`, (K, m) each, in the
    least squares sense; pi if t is infinite.
    """
    result: Array = np.arctan2(
        2.0 * (lower * higher).sum(axis=1), (lower * lower).sum(axis=1) - (higher * higher).sum(axis=1)
    )
    return result


def _turns(angle: Array) -> Array:
    """Return rotations about z (..., 4, 4) by angles (...) [rad]."""
    turn, sin, cos = np.zeros((*angle.shape, 4, 4)), np.sin(angle), np.cos(angle)
    turn[..., 0, 0] = turn[..., 1, 1] = cos
    turn[..., 1, 0], turn[..., 0, 1] = sin, -sin
    turn[..., 2, 2] = turn[..., 3, 3] = 1.0
    return turn


def _inverse(transform: Array) -> Array:
    """Return the inverses of rigid transforms (..., 4, 4)."""
    result = np.zeros_like(transform)
    result[..., :3, :3] = transform[..., :3, :3].swapaxes(-1, -2)
    result[..., :3, 3] = -(result[..., :3, :3] @ transform[..., :3, 3:])[..., 0]
    result[..., 3, 3] = 1.0
    return result
