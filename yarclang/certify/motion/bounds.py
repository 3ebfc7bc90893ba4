"""The closed forms and the theorems that the proofs stand on. All arrays, no sampling.

Hermite remainder: a function e on an interval of length d, minus the cubic with the same values
and derivatives at both ends, is at most d^4/384 max|e''''|; a jump G of e''' inside adds at most
d^3/192 |G| (the deflection of a beam clamped at both ends, under an even load and under a load in its
middle). The derivatives differ by at most sqrt(3)/216 d^3 max|e''''| (Birkhoff and Priver 1967). The cubic
itself stays in the convex hull of its four Bezier points. All of it holds for vectors and matrices in
any norm that comes from an inner product.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain

HERMITE = 1.0 / 384.0
JUMP = 1.0 / 192.0
HERMITE_RATE = np.sqrt(3.0) / 216.0


UNIT = 2.0**-53
"""The largest relative error of one rounding."""


@frozen(eq=False)
class Fuzz:
    """By how much rounding may have made the peaks of segments too small: upper bounds of the errors, in `UNIT`.

    A segment has four control points of the size M at most, whose neighbours are S apart at most; numbers of a text are known to 3 M (decimal number, unit, product). The third difference
    has 8 such errors and, of the steps, roundings of 4 + 4 + 4 S and a relative one of 12; with h known to 2 it is off by less than 32 M + 256 S over h^3, also after a product with a
    matrix of 12 columns. In the same way the acceleration at the start is off by 16 M + 128 S over h^2, the velocity by 4 M + 32 S over h and the position by 8 M. A peak is a value
    of the polynomial with these coefficients somewhere in [0, h]: its error is at most the sum of theirs, and of what its own evaluation rounds.

    Attributes:
        size: (N, n) M; `step` (N, n) S.
        step: see `size`.
        h: (N,) durations of the whole segments [s].
    """

    size: Array
    step: Array
    h: Array

    @staticmethod
    def of(size: Array, step: Array, h: Array) -> Fuzz:
        """Scale the sizes by the unit of rounding."""
        return Fuzz(UNIT * size, UNIT * step, h)

    def take(self, rows: NDArray[np.int64]) -> Fuzz:
        """Return some of the segments'."""
        return Fuzz(self.size[rows], self.step[rows], self.h[rows])

    def mapped(self, matrix: Array) -> Fuzz:
        """Return those of y = matrix x."""
        m = np.abs(matrix).T
        return Fuzz(self.size @ m, self.step @ m, self.h)

    @property
    def jerk(self) -> Array:
        """Of the jerk."""
        found: Array = (32.0 * self.size + 256.0 * self.step) / self.h[:, None] ** 3
        return found

    @property
    def acceleration(self) -> Array:
        """Of the acceleration's peak: at the start, plus h times the jerk's, plus 32 S of its evaluation."""
        found: Array = (48.0 * self.size + 416.0 * self.step) / self.h[:, None] ** 2
        return found

    @property
    def velocity(self) -> Array:
        """Of the velocity's peak: the velocity's, h times the acceleration's and h^2 / 2 times the jerk's, plus 64 S."""
        found: Array = (36.0 * self.size + 352.0 * self.step) / self.h[:, None]
        return found

    @property
    def position(self) -> Array:
        """Of the least and the greatest position, with 8 M for its evaluation and the place of its zeros."""
        found: Array = 40.0 * self.size + 256.0 * self.step
        return found


@frozen(eq=False)
class Cubics:
    """Motions with constant jerk, one a segment: position x, velocity v and acceleration a at
    its start and jerk j, (N, n) each, over h (N,) [s].

    `fuzz` says how exactly they are known; None: to the last bit. The peaks have it in them.
    """

    x: Array
    v: Array
    a: Array
    j: Array
    h: Array
    fuzz: Fuzz | None = None

    @staticmethod
    def of_spline(control: Array, at: NDArray[np.int64], time: Array) -> Cubics:
        """The uniform cubic B-spline's segments.

        Args:
            control: (G, n) control points.
            at: (N,) the first of the four control points of each segment.
            time: (N,) durations h [s].
        """
        f0, f1, f2, f3 = (control[at + i] for i in range(4))
        h = time[:, None]
        step0, step1, step2 = f1 - f0, f2 - f1, f3 - f2
        fuzz = Fuzz.of(np.abs([f0, f1, f2, f3]).max(axis=0), np.abs([step0, step1, step2]).max(axis=0), time)
        first, second = step1 - step0, step2 - step1
        # x as f1 and a difference: at rest it is f1 to the last bit
        return Cubics(
            f1 + first / 6.0, (f2 - f0) / (2.0 * h), first / h**2, (second - first) / h**3, time, fuzz
        )

    def at(self, t: Array) -> tuple[Array, Array]:
        """Position and velocity, (N, n) each, at the times `t` (N,) after the starts [s]."""
        t = t[:, None]
        x = self.x + t * (self.v + t * (self.a / 2.0 + t * self.j / 6.0))
        return x, self.v + t * (self.a + t * self.j / 2.0)

    def take(self, rows: NDArray[np.int64]) -> Cubics:
        """Some of the segments."""
        fuzz = None if self.fuzz is None else self.fuzz.take(rows)
        return Cubics(self.x[rows], self.v[rows], self.a[rows], self.j[rows], self.h[rows], fuzz)

    def trimmed(self, rows: NDArray[np.int64], begin: Array, end: Array) -> Cubics:
        """The same, of which the segments `rows` (K,), each once, begin and end later and earlier, `begin` and `end` (K,) after their starts [s]."""
        x, v, a, h = self.x.copy(), self.v.copy(), self.a.copy(), self.h.copy()
        x[rows], v[rows] = self.take(rows).at(begin)
        a[rows] += begin[:, None] * self.j[rows]
        h[rows] = end - begin
        return Cubics(x, v, a, self.j, h, self.fuzz)

    def mapped(self, matrix: Array) -> Cubics:
        """The same motions in other coordinates: y = matrix x."""
        m = matrix.T
        fuzz = None if self.fuzz is None else self.fuzz.mapped(matrix)
        return Cubics(self.x @ m, self.v @ m, self.a @ m, self.j @ m, self.h, fuzz)

    def jerk_peaks(self) -> Array:
        """An upper bound (N, n) of |jerk|: it is constant."""
        peak: Array = np.abs(self.j)
        return peak if self.fuzz is None else peak + self.fuzz.jerk

    def acceleration_peaks(self) -> Array:
        """An upper bound (N, n) of |acceleration|: it is linear, so largest at an end."""
        peak = np.maximum(np.abs(self.a), np.abs(self.a + self.h[:, None] * self.j))
        return peak if self.fuzz is None else peak + self.fuzz.acceleration

    def velocity_peaks(self) -> Array:
        """An upper bound (N, n) of |velocity|: a parabola, so largest at an end or at its vertex."""
        h = self.h[:, None]
        end = self.v + h * (self.a + h * self.j / 2.0)
        peak = np.maximum(np.abs(self.v), np.abs(end))
        inside = self.a * (self.a + h * self.j) < 0.0  # then the jerk isn't zero either
        peak[inside] = np.maximum(
            peak[inside], np.abs(self.v[inside] - self.a[inside] ** 2 / (2.0 * self.j[inside]))
        )
        return peak if self.fuzz is None else peak + self.fuzz.velocity

    def position_range(self) -> tuple[Array, Array]:
        """Bounds (N, n) of the least and the greatest position: at an end or where the velocity is zero."""
        h = self.h[:, None]
        end = self.x + h * (self.v + h * (self.a / 2.0 + h * self.j / 6.0))
        lower, upper = np.minimum(self.x, end), np.maximum(self.x, end)
        v_end = self.v + h * (self.a + h * self.j / 2.0)
        middle = self.v + h * self.a / 2.0  # the three Bezier points of the velocity
        turns = np.minimum(np.minimum(self.v, v_end), middle) <= 0.0
        turns &= np.maximum(np.maximum(self.v, v_end), middle) >= 0.0
        turns &= (self.a != 0.0) | (self.j != 0.0)
        row, joint = np.nonzero(turns)
        x, v, a, j = (values[row, joint] for values in (self.x, self.v, self.a, self.j))
        for t in _roots(j / 2.0, a, v, self.h[row]):
            there = x + t * (v + t * (a / 2.0 + t * j / 6.0))
            lower[row, joint] = np.minimum(lower[row, joint], there)
            upper[row, joint] = np.maximum(upper[row, joint], there)
        if self.fuzz is None:
            return lower, upper
        return lower - self.fuzz.position, upper + self.fuzz.position


def _roots(a: Array, b: Array, c: Array, h: Array) -> tuple[Array, Array]:
    """Both roots of a t^2 + b t + c, moved into [0, h] (any time in there is a lawful place to look)."""
    q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0)), b)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = np.nan_to_num(q / a, nan=0.0), np.nan_to_num(c / q, nan=0.0)
    return np.clip(roots[0], 0.0, h), np.clip(roots[1], 0.0, h)


def fourth(w: Array, a: Array, j: Array) -> Array:
    """Faa di Bruno's sum w^4 + 6 w^2 a + 3 a^2 + 4 w j.

    It bounds the fourth time derivative of f(x(t)) where every partial derivative of f is at most 1,
    x'''' = 0, and |x'|, |x''|, |x'''| are at most w, a, j.
    """
    return w**4 + 6.0 * w * w * a + 3.0 * a * a + 4.0 * w * j


def path_fourth(bounds: Array, w: Array, a: Array, j: Array) -> Array:
    """The same bound for a path P(s(t)) with a cubic s(t).

    Args:
        bounds: (N, 4) of the first to the fourth derivative of P over s; the first doesn't enter, as s'''' = 0.
        w: (N,) of |s'|; a and j likewise of |s''| and |s'''|.
        a: (N,).
        j: (N,).
    """
    bend, third, last = bounds[:, 1], bounds[:, 2], bounds[:, 3]
    total: Array = last * w**4 + 6.0 * third * w * w * a + bend * (3.0 * a * a + 4.0 * w * j)
    return total


@frozen(eq=False)
class FourthDerivatives:
    """Bounds (N,) of the fourth time derivatives of the arm: of the tool's origin [m/s^4], and
    of its rotation matrix in the Frobenius norm [1/s^4].
    """

    origin: Array
    rotation: Array


def arm_fourth(reach: Array, prismatic: NDArray[np.bool_], w: Array, a: Array, j: Array) -> FourthDerivatives:
    """Bounds of the tool's fourth time derivatives while every joint has constant jerk.

    A partial derivative of the tool's origin by some joints is a chain of cross products with their
    axes, innermost the one nearest to the tool: its length is at most the distance of that
    joint's axis from the tool. Hence, summed over the joint m nearest to the tool,
    R_m (B_m - B_{m-1}) with B the sum of `fourth` over joints up to m. A prismatic joint enters at most
    once, and innermost (what is farther out only turns a free vector), with length 1: the derivative of B
    in its direction. The rotation matrix: products of [axis]x, of Frobenius norm sqrt 2 at most.

    Args:
        reach: (n,) from `reaches`; not read for a prismatic joint.
        prismatic: (n,) which joints slide.
        w: (N, n) largest |velocity| of each joint on the piece [rad/s or m/s]; a and j likewise for
            acceleration and jerk.
        a: (N, n).
        j: (N, n).
    """
    zero = np.zeros(len(w))
    sum_w, sum_a, sum_j, before, origin = zero, zero, zero, zero, zero
    for m in range(w.shape[1]):
        if prismatic[m]:
            origin = origin + (
                (4.0 * sum_w**3 + 12.0 * sum_w * sum_a + 4.0 * sum_j) * w[:, m]
                + 6.0 * (sum_w**2 + sum_a) * a[:, m]
                + 4.0 * sum_w * j[:, m]
            )
            continue
        sum_w, sum_a, sum_j = sum_w + w[:, m], sum_a + a[:, m], sum_j + j[:, m]
        upto = fourth(sum_w, sum_a, sum_j)
        origin = origin + reach[m] * (upto - before)
        before = upto
    return FourthDerivatives(origin, np.sqrt(2.0) * before)


def reaches(chain: Chain, flange_from_tool: Array, travel: Array) -> Array:
    """How far the tool's origin can ever be from each revolute axis.

    From the tool backwards: the point of an axis nearest to the last point chosen; the lengths
    add up (triangle inequality: what lies between two axes only turns), a prismatic joint adds its travel.

    Args:
        chain: the arm.
        flange_from_tool: (4, 4).
        travel: (n,) largest |q| of each prismatic joint in the motion [m].

    Returns:
        (n,) [m]; zero for a prismatic joint.
    """
    point = (chain.base_from_flange @ flange_from_tool)[:3, 3]
    length = 0.0
    reach = np.zeros(chain.size)
    for joint in reversed(range(chain.size)):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        if not angular.any():
            length += float(travel[joint])
            continue
        on_axis = np.cross(angular, linear)  # the point of the axis nearest to the base's origin
        nearest = on_axis + angular * float(angular @ (point - on_axis))
        length += float(np.linalg.norm(point - nearest))
        reach[joint] = length
        point = nearest
    return reach


def hermite_bezier(e0: Array, rate0: Array, e1: Array, rate1: Array, d: Array) -> tuple[Array, ...]:
    """The four Bezier points of the cubic with values e and derivatives `rate` at both ends of d."""
    third = d / 3.0
    return e0, e0 + third * rate0, e1 - third * rate1, e1


def catch_up(
    bezier: Array, group: NDArray[np.int64], end: float = 1.0, covered: Array | None = None
) -> Array:
    """How far a path parameter is from one that goes over the whole path and never back.

    The Bezier points of s(t), clipped to the path and replaced by the most so far, the first by the
    path's start and the last by its end, are those of a parameter that only grows: the distance between
    both is at most that of their points. The path distance at that parameter is then one in
    order of time and of the whole path (Frechet), not to the nearest point.

    Args:
        bezier: (P, 4) Bezier points of s on each piece, in order of time.
        group: (P,) the command of each piece, in order, from 0 on.
        end: the value of s at the path's end.
        covered: (C, 2) the shares of the path at which each command joins and leaves it; None: 0 and 1.

    Returns:
        (P,) the largest distance on each piece, in s.
    """
    opens, closes = np.flatnonzero(np.diff(group, prepend=-1)), np.flatnonzero(np.diff(group, append=-1))
    share = np.clip(bezier / end, 0.0, 1.0)
    if covered is None:
        share[opens, 0], share[closes, 3] = 0.0, 1.0
    else:
        share = np.clip(share, covered[group, :1], covered[group, 1:])
        share[opens, 0], share[closes, 3] = covered[:, 0], covered[:, 1]
    share = np.ascontiguousarray(share)
    # each command by itself: what is proved of it must not depend on the others, not even by rounding
    for begin, stop in zip(opens.tolist(), (closes + 1).tolist(), strict=True):
        forward = share[begin:stop].reshape(-1)
        np.maximum.accumulate(forward, out=forward)
    behind: Array = np.abs(share * end - bezier).max(axis=1)
    return behind


def segment_max(values: Array, first: NDArray[np.int64]) -> Array:
    """The maximum over the rows of each group; groups begin at the rows `first`, none is empty."""
    result: Array = np.maximum.reduceat(values, first, axis=0)
    return result
