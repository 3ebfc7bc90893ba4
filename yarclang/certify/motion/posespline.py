"""Curves of the moving frame through poses.

Position and quaternion are natural cubic splines; the quaternion is then normalised.

The rotation matrix is R = M(Q) / n with n = |Q|^2, where M and n are polynomials of degree 6 on the span
between two poses. Let M_k and N_k bound their derivatives, and n >= n_min. Leibniz' rule for R n = M then
bounds the derivatives of R one after the other: G_k <= (M_k + sum over j < k of C(k, j) G_j N_(k-j)) / n_min.
Each span is divided into cells. On each cell, M_k, N_k and n_min are bounds of Bernstein coefficients.
"""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.motion.programmed import Bounds, Motion, Poses, Rows
from yarclang.certify.motion.project import guess_by_length, places_of, project
from yarclang.certify.motion.spline import NaturalSpline
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array

FEWEST_CELLS, CELLS = 4, 16
"""Least and largest number of cells into which a span is cut."""

CELLS_IN_ALL = 16_384
"""Largest number of cells of a whole curve. Each span between two waypoints has at least `FEWEST_CELLS`,
even if the curve then has more cells. Few cells are enough if there are many waypoints, since the spans are
then short and nearly straight.
"""

_CELLS_AT_ONCE = 1_024
"""Number of cells that are bounded in one step, so that their polynomials stay in the processor's cache."""
SAME = 1e-6
"""Neighbouring poses count as one if the curve's parameter u grows by no more than this [m] between them."""
STILL = 1e-9
"""Distance [m] below which the origin of a frame counts as standing still."""
HALF_TURN = np.pi - 1e-9
"""Angle between neighbouring poses [rad] from which on the shorter direction of rotation is not unique."""


@frozen(eq=False)
class PoseSpline:
    """A curve of poses over s = u / u_total, with K cells on its m - 1 spans.

    Attributes:
        flange_from_moving: (1, 4, 4) moving frame, relative to the flange.
        goal: (1, 4, 4) last pose.
        spline: position and quaternion (x, y, z, w) as (m, 7) over u.
        cells: (K + 1, 4, 2) bounds of the first to fourth derivative over u of position and rotation on each
            cell. All spans have the same number of cells; the last row is a copy of the one before.
        jumps: (m + 1, 2) for each waypoint, the jumps of the third derivatives of position and rotation,
            summed over all waypoints before it.
        lawful: (1,) True if the curve is uniquely defined, without a half turn between neighbouring poses.
        free: first value True if a blend joins the curve after its start, second value True if a blend leaves
            it before its end.
    """

    flange_from_moving: Array
    goal: Array
    spline: NaturalSpline
    cells: Array
    jumps: Array
    lawful: NDArray[np.bool_]
    free: tuple[bool, bool]

    @staticmethod
    def through(
        poses: Array, flange_from_moving: Array, free: tuple[bool, bool] = (False, False)
    ) -> PoseSpline | None:
        """Return the curve of a moving frame through poses; None if all poses are equal.

        Args:
            poses: (m, 4, 4) poses.
            flange_from_moving: (4, 4) moving frame, relative to the flange.
            free: first value True if a blend joins the curve after its start, second value True if a blend
                leaves it before its end.
        """
        q = _aligned(_quaternions(poses[:, :3, :3]))
        # A rotation by theta between neighbouring poses is an angle of theta / 2 between their quaternions a
        # and b, so tan(theta / 4) = |a - b| / |a + b|. The parameter u grows by sqrt(distance^2 + (TURN_CHORD
        # theta)^2).
        apart = np.linalg.norm(np.diff(q, axis=0), axis=1), np.linalg.norm(q[1:] + q[:-1], axis=1)
        turn = 4.0 * np.arctan2(*apart)
        steps = np.hypot(np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1), hir.TURN_CHORD * turn)
        if (steps <= SAME).any():
            # Leave out poses that equal the one before, and build the curve through the remaining poses.
            kept = np.concatenate([[True], steps > SAME])
            return PoseSpline.through(poses[kept], flange_from_moving, free) if kept.sum() > 1 else None
        spline = NaturalSpline.over(steps, np.concatenate([poses[:, :3, 3], q], axis=1))
        lawful = np.array([bool((turn < HALF_TURN).all())])
        cells = _cells(spline)
        jumps = np.concatenate([np.zeros((1, 2)), np.cumsum(_jumps(spline), axis=0)])
        return PoseSpline(
            flange_from_moving[None],
            poses[-1:],
            spline,
            np.concatenate([cells, cells[-1:]]),
            jumps,
            lawful,
            free,
        )

    @property
    def total(self) -> float:
        """The value of the curve's parameter u at its end [m]."""
        return float(self.spline.s[-1])

    def at(self, owner: Rows, s: Array) -> Poses:  # noqa: ARG002 - there is only one
        """Return the points of the curve at `s` (N,)."""
        parts = [self._at(s[begin : begin + _AT_ONCE]) for begin in range(0, len(s), _AT_ONCE)]
        if len(parts) == 1:
            return parts[0]
        return Poses(
            np.concatenate([part.p for part in parts] or [np.zeros((0, 3))]),
            np.concatenate([part.along for part in parts] or [np.zeros((0, 3))]),
            np.concatenate([part.rotation for part in parts] or [np.zeros((0, 3, 3))]),
            np.concatenate([part.spin for part in parts] or [np.zeros((0, 3, 3))]),
        )

    def _at(self, s: Array) -> Poses:
        go_on()
        y, slope = self.spline.at(s * self.total)
        q, rate = y[:, 3:], slope[:, 3:]
        n = np.einsum("ni,ni->n", q, q)[:, None, None]
        rotation = _matrix(q, q) / n
        # Differentiate R = M(Q) / n (see the head of this module) by the quotient rule, with M' = 2 M(Q, Q')
        # and n' = 2 Q . Q'.
        n_rate = 2.0 * np.einsum("ni,ni->n", q, rate)[:, None, None]
        spin = (2.0 * _matrix(q, rate) - rotation * n_rate) / n
        return Poses(y[:, :3], slope[:, :3] * self.total, rotation, spin * self.total)

    def _lengths(self) -> tuple[Array, Array]:
        """Return parameters s (N,), and the approximate path length of the origin up to each [m]
        (Simpson).
        """
        s = places_of(self.spline.s / self.total)
        way = np.zeros(len(s))
        for begin in range(0, len(s) - 1, _AT_ONCE):
            go_on()
            u = s[begin : begin + _AT_ONCE + 1] * self.total
            middle = (u[1:] + u[:-1]) / 2.0
            at, between = (np.linalg.norm(self.spline.at(one)[1][:, :3], axis=1) for one in (u, middle))
            # Integrate |p'| over each interval by Simpson's rule.
            way[begin + 1 : begin + len(u)] = np.diff(u) * (at[:-1] + 4.0 * between + at[1:]) / 6.0
        return s, np.cumsum(way)

    def bounds(self, owner: Rows, low: Array, high: Array) -> Bounds:  # noqa: ARG002 - there is only one
        """Bound the derivatives of the curve between the parameters `low` and `high` (P,), from its cells.

        The curve continues beyond its ends. The bounds are finite within a small margin there, and infinite
        farther out.
        """
        count = len(self.cells) - 1
        # Each span has the same number of cells. The rows of `cells` are numbered along the whole curve.
        each = count // (len(self.spline.s) - 1)
        u = np.stack([low, high]) * self.total
        span = self.spline.span(u)
        # Find the cells that contain `low` and `high`.
        share = (u - self.spline.s[span]) / (self.spline.s[span + 1] - self.spline.s[span])
        cell = np.clip(span * each + np.floor(share * each).astype(np.int64), 0, count - 1)
        # Include the neighbouring cells as well: the floor of a rounded quotient may be off by one.
        first, last = np.maximum(cell[0] - 1, 0), np.minimum(cell[1] + 2, count)
        most = _range_max(self.cells, first, last)
        before, after = _margins(self.spline)
        # Scale from u to s: the k-th derivative gets the factor u_total^k.
        beyond = (u[0] < -before) | (u[1] > self.total + after)
        most = np.where(beyond[:, None, None], np.inf, most) * self.total ** np.arange(1.0, 5.0)[:, None]
        # Sum up the jumps at the waypoints between `low` and `high`, as a difference of two rows of `jumps`.
        knot = (
            np.searchsorted(self.spline.s, u[0], side="left"),
            np.searchsorted(self.spline.s, u[1], side="right"),
        )
        jump = np.maximum(self.jumps[knot[1]] - self.jumps[knot[0]], 0.0) * self.total**3
        return Bounds(most[:, :, 0], most[:, :, 1], jump[:, 0], jump[:, 1])

    def project(
        self,
        motion: Motion,
        owner: Rows,  # noqa: ARG002 - there is only one
        position: Array,
        angle: Array,
        share: Array | None = None,
    ) -> tuple[Array, Array]:
        """Choose s by least squares of position and rotation errors, each divided by its tolerance."""
        # A rotation difference has a norm of about sqrt 2 times its angle.
        weights = np.concatenate([np.full(3, 1.0 / position[0]), np.full(9, 1.0 / (np.sqrt(2.0) * angle[0]))])
        y, rate = (np.empty((len(motion.p), 12)) for _ in range(2))
        y[:, :3], y[:, 3:] = motion.p, motion.rotation.reshape(-1, 9)
        rate[:, :3] = motion.velocity
        for begin in range(0, len(y), _AT_ONCE):
            part = slice(begin, begin + _AT_ONCE)
            turning = np.cross(motion.angular[part, :, None], motion.rotation[part], axis=1)
            rate[part, 3:] = turning.reshape(-1, 9)
        y *= weights
        rate *= weights
        curve = _Weighed(self, weights)
        s, lengths = (None, np.zeros(1)) if share is None else self._lengths()
        if s is None or share is None or lengths[-1] < STILL:
            guess, pace = guess_by_length(curve, y, self.spline.s / self.total, self.free)
        else:
            guess = np.interp(share * lengths[-1], lengths, s)
            pace = float(np.linalg.norm(np.diff(y, axis=0), axis=1).sum())
        return project(curve, y, rate, guess, pace, motion.d)


_AT_ONCE = 8_192
"""Number of points of a curve that are computed between two checks for cancellation. Computing them takes
about 10 ms.
"""

BEYOND = 1e-3
"""Margin beyond both ends of a curve within which its derivatives are bounded, as a fraction of the curve's
length.
"""

BEYOND_SHORT = 1e-4
"""The margin at an end of a curve is at most the length of the span at this end, or `BEYOND_SHORT` [m] if the
span is shorter. It is limited because cubics grow without bound beyond an end.
"""

BEYOND_LEAST, BEYOND_SPAN = 1e-5, 0.01
"""The margin at an end of a curve is at least `BEYOND_LEAST` [m], or the fraction `BEYOND_SPAN` of the span
at this end if that is less.

A frame that speeds up from rest begins some micrometres before the path, however short the path is. A cubic
hardly grows in a hundredth of its span.
"""


@frozen(eq=False)
class _Weighed:
    """A curve of poses in coordinates that are divided by their tolerances."""

    path: PoseSpline
    weights: Array

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return position and rotation matrix, and their derivatives, (N, 12) each."""
        poses = self.path.at(np.zeros(len(s), dtype=np.int64), s)
        y = np.concatenate([poses.p, poses.rotation.reshape(-1, 9)], axis=1)
        slope = np.concatenate([poses.along, poses.spin.reshape(-1, 9)], axis=1)
        return y * self.weights, slope * self.weights


def _quaternions(rotations: Array) -> Array:
    """Return unit quaternions (m, 4), as (x, y, z, w), of rotation matrices (m, 3, 3).

    Each is the eigenvector of a symmetric matrix for its largest eigenvalue, 3 (Bar-Itzhack 2000, without the
    factor 1/3).
    """
    r = rotations
    k = np.empty((len(r), 4, 4))
    # Build the matrix [S - trace I, z; z', trace], with S = R + R' (R' is the transpose), the trace of R, and
    # the vector z of R - R'.
    k[:, :3, :3] = r + r.transpose(0, 2, 1)
    k[:, :3, :3] -= np.trace(r, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    vee = np.stack(
        [r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]],
        axis=1,
    )
    k[:, :3, 3] = k[:, 3, :3] = vee
    k[:, 3, 3] = np.trace(r, axis1=1, axis2=2)
    vectors: Array = np.linalg.eigh(k)[1][:, :, 3]
    return vectors


def _aligned(q: Array) -> Array:
    """Return the quaternions with signs such that each is as near as possible to the previous one."""
    # q and -q are the same rotation: flip the sign of every quaternion that points away from the one before.
    # The product of all flips so far is the sign of each.
    signs = np.where(np.einsum("ni,ni->n", q[1:], q[:-1]) < 0.0, -1.0, 1.0)
    aligned: Array = q * np.concatenate([[1.0], np.cumprod(signs)])[:, None]
    return aligned


def _matrix(a: Array, b: Array) -> Array:
    """Return the symmetric bilinear form (..., 3, 3) of quaternions `a` and `b` (..., 4).

    For a = b = q it is |q|^2 times the rotation matrix of q.
    """
    v, w = a[..., :3], a[..., 3]
    x, y = b[..., :3], b[..., 3]
    # The form of a quaternion q = (v, w) with itself is 2 v v' + (w^2 - |v|^2) I + 2 w [v]x. Compute the
    # symmetric bilinear form, which equals this for two equal quaternions.
    outer = v[..., :, None] * x[..., None, :]
    inner = w * y - np.einsum("...i,...i->...", v, x)
    cross = w[..., None] * x + y[..., None] * v
    matrix: Array = outer + outer.swapaxes(-1, -2)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        matrix[..., i, i] += inner
        matrix[..., k, j] += cross[..., i]
        matrix[..., j, k] -= cross[..., i]
    return matrix


def _cells(spline: NaturalSpline) -> Array:
    """Bound the first four derivatives over u of position and rotation on the cells of all spans (K, 4, 2).

    All spans have the same number of cells. The first and the last cell also cover a margin beyond the ends
    of the curve.
    """
    spans = len(spline.s) - 1
    each = min(CELLS, max(FEWEST_CELLS, CELLS_IN_ALL // spans))
    size = max(1, _CELLS_AT_ONCE // each)
    parts = [_cells_of(spline, begin, min(begin + size, spans), each) for begin in range(0, spans, size)]
    return np.concatenate(parts)


def _cells_of(spline: NaturalSpline, first: int, last: int, each: int) -> Array:
    """Bound the derivatives as `_cells` does, for the spans `first` up to `last` (excluded), with `each`
    cells per span.
    """
    go_on()
    widths = np.diff(spline.s[first : last + 1])
    edge = np.arange(each + 1) / each
    start = np.tile(edge[:-1], (len(widths), 1))
    width = np.full((len(widths), each), 1.0 / each)
    before, after = _margins(spline)
    # The cells at both ends of the curve also cover twice the margins beyond it, because of rounding.
    if first == 0:
        start[0, 0] -= 2.0 * before / widths[0]
        width[0, 0] += 2.0 * before / widths[0]
    if last == len(spline.s) - 1:
        width[-1, -1] += 2.0 * after / widths[-1]
    u0 = start * widths[:, None]
    size = (width * widths[:, None])[:, :, None]
    chord = widths[:, None]
    y, b0, b1 = spline.y[first : last + 1], spline.bend[first:last], spline.bend[first + 1 : last + 1]
    slope = np.diff(y, axis=0) / chord - chord * (2.0 * b0 + b1) / 6.0
    # The values and second derivatives at both ends of a span determine the coefficients of its cubic.
    power = np.stack([y[:-1], slope, b0 / 2.0, (b1 - b0) / chord / 6.0])[:, :, None]
    t = u0[:, :, None]
    # Expand the cubics at the start of each cell, over a parameter that grows from 0 to 1 in the cell.
    local = np.stack(
        [
            power[0] + t * (power[1] + t * (power[2] + t * power[3])),
            (power[1] + t * (2.0 * power[2] + t * 3.0 * power[3])) * size,
            (power[2] + t * 3.0 * power[3]) * size**2,
            np.broadcast_to(power[3], (*u0.shape, y.shape[1])) * size**3,
        ]
    ).reshape(4, -1, y.shape[1])
    size = size.reshape(-1)
    q = local[..., 3:]
    # On each cell, n = |Q|^2 and M(Q) (see the head of this module) are polynomials of degree 6: products of
    # the cubic Q with itself.
    n, matrices = np.zeros((7, len(size))), np.zeros((7, len(size), 3, 3))
    for i in range(4):
        for k in range(4):
            n[i + k] += np.einsum("ni,ni->n", q[i], q[k])
            matrices[i + k] += _matrix(q[i], q[k])
    # A polynomial is between its least and its largest Bernstein coefficient.
    n_min = _bernstein(n[..., None])[..., 0].min(axis=0)
    n_top = [np.abs(_bernstein(_derivative(n[..., None], k))).max(axis=(0, 2)) for k in range(5)]
    m = matrices.reshape(7, -1, 9)
    m_top = [np.linalg.norm(_bernstein(_derivative(m, k)), axis=2).max(axis=0) for k in range(5)]
    # Leibniz' rule for R n = M (see the head of this module) bounds the derivatives of R one after the other.
    # The Frobenius norm of R itself is sqrt 3.
    bound = [np.full(len(size), np.sqrt(3.0))]
    with np.errstate(divide="ignore", invalid="ignore"):
        for k in range(1, 5):
            total = m_top[k] + sum(comb(k, j) * bound[j] * n_top[k - j] for j in range(k))
            bound.append(np.where(n_min > 1e-6, total / n_min, np.inf))
    p = local[..., :3]
    cells = np.zeros((len(size), 4, 2))
    for k in range(1, 5):
        # The fourth derivative of the position is zero. Scale the derivatives from the cell's [0, 1] back to
        # u.
        if k < 4:
            top = np.linalg.norm(_bernstein(_derivative(p, k)), axis=2).max(axis=0)
            cells[:, k - 1, 0] = top / size**k
        cells[:, k - 1, 1] = bound[k] / size**k
    return cells


def _margins(spline: NaturalSpline) -> tuple[float, float]:
    """Return the margins in u beyond both ends of a curve within which the bounds are valid."""
    first, last = float(spline.s[1] - spline.s[0]), float(spline.s[-1] - spline.s[-2])
    most = BEYOND * float(spline.s[-1])
    before, after = (
        max(min(most, max(span, BEYOND_SHORT)), min(BEYOND_LEAST, BEYOND_SPAN * span))
        for span in (first, last)
    )
    return before, after


def _derivative(power: Array, times: int) -> Array:
    """Return the coefficients of the derivative of order `times` of polynomials (degree + 1, ...)."""
    for _ in range(times):
        power = power[1:] * np.arange(1.0, len(power)).reshape(-1, *(1,) * (power.ndim - 1))
    return power


def _bernstein(power: Array) -> Array:
    """Return Bernstein coefficients on [0, 1] of polynomials with coefficients `power` (degree + 1, ...)."""
    # The coefficients a_k of the powers give the coefficients of the Bernstein polynomials of degree n: b_i
    # is the sum over k <= i of C(i, k) / C(n, k) a_k.
    degree = len(power) - 1
    matrix = np.array([[comb(i, k) / comb(degree, k) for k in range(degree + 1)] for i in range(degree + 1)])
    coefficients: Array = np.tensordot(matrix, power, 1)
    return coefficients


def _jumps(spline: NaturalSpline) -> Array:
    """Return the jumps of the third derivatives of position and rotation at the waypoints (m, 2).

    They are zero at the first and last waypoint, beyond which the cubics continue.
    """
    third = np.diff(spline.bend, axis=0) / np.diff(spline.s)[:, None]
    jumps = np.zeros((len(spline.s), 2))
    step, q = np.diff(third, axis=0), spline.y[1:-1, 3:]
    jumps[1:-1, 0] = np.linalg.norm(step[:, :3], axis=1)
    n = np.einsum("ni,ni->n", q, q)[:, None, None]
    # Differentiate R n = M (see the head of this module) three times. Only terms with the third derivative of
    # the quaternion Q jump.
    across = 2.0 * np.einsum("ni,ni->n", q, step[:, 3:])[:, None, None]
    turn = (2.0 * _matrix(q, step[:, 3:]) - _matrix(q, q) / n * across) / n
    jumps[1:-1, 1] = np.linalg.norm(turn, axis=(1, 2))
    return jumps


def _range_max(padded: Array, first: Rows, last: Rows) -> Array:
    """Return the largest entries in a table's rows from `first` up to `last` (not included), for each pair of
    `first` and `last`.

    The table has one extra row at its end, so that `last` is always a valid row.
    """
    pairs = np.stack([first, last], axis=1).ravel()
    most: Array = np.maximum.reduceat(padded, pairs, axis=0)[::2]
    return most
