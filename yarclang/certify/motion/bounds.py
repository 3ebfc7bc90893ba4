"""Closed forms and theorems on which the proofs are based, for whole arrays, without sampling.

Hermite remainder: let e be a function on an interval of length d, and c the cubic with the same values and
derivatives at both ends. Then |e - c| <= d^4/384 max|e''''|. A jump G of e''' inside the interval adds at
most d^3/192 |G|. These are the deflections of a beam clamped at both ends, under an even load and under a
load in its middle. The derivatives of e and c differ by at most sqrt(3)/216 d^3 max|e''''| (Birkhoff and
Priver 1967). The cubic itself stays in the convex hull of its four Bezier points. All of this is true for
vectors and matrices in any norm that comes from an inner product.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain

HERMITE = 1.0 / 384.0
"""Factor of d^4 max|e''''| in the Hermite remainder (see the head of this module)."""
JUMP = 1.0 / 192.0
"""Factor of d^3 |G| in the Hermite remainder, for a jump G of e'''."""
HERMITE_RATE = np.sqrt(3.0) / 216.0
"""Factor of d^3 max|e''''| in the difference of the derivatives of a function and of its Hermite cubic."""


UNIT = 2.0**-53
"""Largest relative error of one rounding."""


@frozen(eq=False)
class Fuzz:
    """Upper bounds of the rounding errors in the peaks (largest values) of segments, in units of `UNIT`.

    A segment has four control points of size M at most, whose neighbours differ by S at most. A number of a
    controller text is off by at most 3 M: by its decimal digits, its unit and the product of both. The third
    difference has 8 such errors. The roundings of the steps add (4 + 4 + 4) S, and a relative error of 12.
    The duration h has a relative error of 2. The jerk is therefore off by less than (32 M + 256 S) / h^3,
    also after a product with a matrix of 12 columns. In the same way, the acceleration at the start is off by
    (16 M + 128 S) / h^2, the velocity by (4 M + 32 S) / h and the position by 8 M. A peak is a value of the
    polynomial with these coefficients somewhere in [0, h]. The peak's error is at most the sum of the errors
    of the coefficients, plus the rounding of its own evaluation.

    Attributes:
        size: (N, n) the sizes M.
        step: (N, n) the differences S.
        h: (N,) durations of the whole segments [s].
    """

    size: Array
    step: Array
    h: Array

    @staticmethod
    def of(size: Array, step: Array, h: Array) -> Fuzz:
        """Return the bounds for control points of sizes M that differ by S (N, n), and durations (N,) [s]."""
        return Fuzz(UNIT * size, UNIT * step, h)

    def take(self, rows: NDArray[np.int64]) -> Fuzz:
        """Return the bounds of some of the segments."""
        return Fuzz(self.size[rows], self.step[rows], self.h[rows])

    def mapped(self, matrix: Array) -> Fuzz:
        """Return the bounds of the rounding errors of y = matrix x."""
        m = np.abs(matrix).T
        return Fuzz(self.size @ m, self.step @ m, self.h)

    @property
    def jerk(self) -> Array:
        """Bound of the rounding error of the jerk (N, n)."""
        found: Array = (32.0 * self.size + 256.0 * self.step) / self.h[:, None] ** 3
        return found

    @property
    def acceleration(self) -> Array:
        """Bound of the rounding error of the peak acceleration (N, n).

        It is the sum of the bound for the acceleration at the start, h times the bound for the jerk, and 32 S
        for the evaluation.
        """
        found: Array = (48.0 * self.size + 416.0 * self.step) / self.h[:, None] ** 2
        return found

    @property
    def velocity(self) -> Array:
        """Bound of the rounding error of the peak velocity (N, n).

        It is the sum of the bound for the velocity at the start, h times the bound for the acceleration, half
        of h^2 times the bound for the jerk, and 64 S for the evaluation.
        """
        found: Array = (36.0 * self.size + 352.0 * self.step) / self.h[:, None]
        return found

    @property
    def position(self) -> Array:
        """Bound of the rounding error of the least and the greatest position (N, n).

        It includes 8 M for the evaluation and for the time of the extremes.
        """
        found: Array = 40.0 * self.size + 256.0 * self.step
        return found


@frozen(eq=False)
class Cubics:
    """N segments of motion, each with constant jerk, so that every joint follows a cubic.

    Attributes:
        x: (N, n) positions at the start.
        v: (N, n) velocities at the start [per s].
        a: (N, n) accelerations at the start [per s^2].
        j: (N, n) jerks [per s^3].
        h: (N,) durations [s].
        fuzz: bounds of the rounding errors, which the peaks include; None if the values are exact.
    """

    x: Array
    v: Array
    a: Array
    j: Array
    h: Array
    fuzz: Fuzz | None = None

    @staticmethod
    def of_spline(control: Array, at: NDArray[np.int64], time: Array) -> Cubics:
        """Return the segments of a uniform cubic B-spline.

        Args:
            control: (G, n) control points.
            at: (N,) index of the first of the four control points of each segment.
            time: (N,) durations [s].
        """
        f0, f1, f2, f3 = (control[at + i] for i in range(4))
        h = time[:, None]
        step0, step1, step2 = f1 - f0, f2 - f1, f3 - f2
        fuzz = Fuzz.of(np.abs([f0, f1, f2, f3]).max(axis=0), np.abs([step0, step1, step2]).max(axis=0), time)
        first, second = step1 - step0, step2 - step1
        # Write x as f1 plus a difference, so that it is exactly f1 at rest.
        # Derivatives of the uniform cubic B-spline at the start of a segment: x = (f0 + 4 f1 + f2) / 6,
        # v = (f2 - f0) / 2h, a = (f0 - 2 f1 + f2) / h^2, and the jerk is the third difference over h^3.
        return Cubics(
            f1 + first / 6.0, (f2 - f0) / (2.0 * h), first / h**2, (second - first) / h**3, time, fuzz
        )

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return positions and velocities (N, n) at the times `t` (N,) after the starts [s]."""
        t = t[:, None]
        x = self.x + t * (self.v + t * (self.a / 2.0 + t * self.j / 6.0))
        return x, self.v + t * (self.a + t * self.j / 2.0)

    def take(self, rows: NDArray[np.int64]) -> Cubics:
        """Return some of the segments."""
        fuzz = None if self.fuzz is None else self.fuzz.take(rows)
        return Cubics(self.x[rows], self.v[rows], self.a[rows], self.j[rows], self.h[rows], fuzz)

    def trimmed(self, rows: NDArray[np.int64], begin: Array, end: Array) -> Cubics:
        """Return all segments, with some of them shortened.

        Args:
            rows: (K,) distinct segments to shorten.
            begin: (K,) new starts, after the old starts [s].
            end: (K,) new ends, after the old starts [s].
        """
        x, v, a, h = self.x.copy(), self.v.copy(), self.a.copy(), self.h.copy()
        x[rows], v[rows] = self.take(rows).at(begin)
        a[rows] += begin[:, None] * self.j[rows]
        h[rows] = end - begin
        return Cubics(x, v, a, self.j, h, self.fuzz)

    def mapped(self, matrix: Array) -> Cubics:
        """Return the motions in other coordinates: y = matrix x."""
        m = matrix.T
        fuzz = None if self.fuzz is None else self.fuzz.mapped(matrix)
        return Cubics(self.x @ m, self.v @ m, self.a @ m, self.j @ m, self.h, fuzz)

    def jerk_peaks(self) -> Array:
        """Return upper bounds (N, n) of |jerk|, which is constant."""
        peak: Array = np.abs(self.j)
        return peak if self.fuzz is None else peak + self.fuzz.jerk

    def acceleration_peaks(self) -> Array:
        """Return upper bounds (N, n) of |acceleration|, which is linear: its peak is at an end."""
        peak = np.maximum(np.abs(self.a), np.abs(self.a + self.h[:, None] * self.j))
        return peak if self.fuzz is None else peak + self.fuzz.acceleration

    def velocity_peaks(self) -> Array:
        """Return upper bounds (N, n) of |velocity|, a parabola: its peak is at an end or at its vertex."""
        h = self.h[:, None]
        end = self.v + h * (self.a + h * self.j / 2.0)
        peak = np.maximum(np.abs(self.v), np.abs(end))
        # If the acceleration changes its sign, the velocity has its vertex, v - a^2 / 2j, inside the segment.
        inside = self.a * (self.a + h * self.j) < 0.0  # the vertex is inside, and the jerk is not zero
        peak[inside] = np.maximum(
            peak[inside], np.abs(self.v[inside] - self.a[inside] ** 2 / (2.0 * self.j[inside]))
        )
        return peak if self.fuzz is None else peak + self.fuzz.velocity

    def position_range(self) -> tuple[Array, Array]:
        """Return bounds (N, n) of the least and the greatest position.

        The extremes are at an end, or at a zero of the velocity.
        """
        h = self.h[:, None]
        end = self.x + h * (self.v + h * (self.a / 2.0 + h * self.j / 6.0))
        lower, upper = np.minimum(self.x, end), np.maximum(self.x, end)
        v_end = self.v + h * (self.a + h * self.j / 2.0)
        middle = self.v + h * self.a / 2.0  # the middle one of the velocity's three Bezier points
        turns = np.minimum(np.minimum(self.v, v_end), middle) <= 0.0
        turns &= np.maximum(np.maximum(self.v, v_end), middle) >= 0.0
        turns &= (self.a != 0.0) | (self.j != 0.0)
        row, joint = np.nonzero(turns)
        # Extremes inside the segment are at the zeros of the velocity v + a t + j t^2 / 2.
        x, v, a, j = (values[row, joint] for values in (self.x, self.v, self.a, self.j))
        for t in _roots(j / 2.0, a, v, self.h[row]):
            there = x + t * (v + t * (a / 2.0 + t * j / 6.0))
            lower[row, joint] = np.minimum(lower[row, joint], there)
            upper[row, joint] = np.maximum(upper[row, joint], there)
        if self.fuzz is None:
            return lower, upper
        return lower - self.fuzz.position, upper + self.fuzz.position


def _roots(a: Array, b: Array, c: Array, h: Array) -> tuple[Array, Array]:
    """Return both roots of a t^2 + b t + c, each moved to the nearest value in [0, h].

    With q = -(b + sign(b) sqrt(b^2 - 4 a c)) / 2, which avoids cancellation, the roots are q / a and c / q.
    Moving a root is harmless: the caller evaluates the position there, which is within the range at any time
    in [0, h].
    """
    q = -(b + np.copysign(np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0)), b)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        roots = np.nan_to_num(q / a, nan=0.0), np.nan_to_num(c / q, nan=0.0)
    return np.clip(roots[0], 0.0, h), np.clip(roots[1], 0.0, h)


def fourth(w: Array, a: Array, j: Array) -> Array:
    """Compute Faa di Bruno's sum w^4 + 6 w^2 a + 3 a^2 + 4 w j.

    It bounds the fourth time derivative of f(x(t)) if every partial derivative of f is at most 1, x'''' = 0,
    and |x'|, |x''|, |x'''| are at most w, a, j.
    """
    return w**4 + 6.0 * w * w * a + 3.0 * a * a + 4.0 * w * j


def path_fourth(bounds: Array, w: Array, a: Array, j: Array) -> Array:
    """Bound the fourth time derivative of a path P(s(t)) with a cubic s(t), by Faa di Bruno's formula.

    Args:
        bounds: (N, 4) bounds of the first to fourth derivative of P over s. The first has no effect, as s''''
            = 0.
        w: (N,) bounds of |s'|.
        a: (N,) bounds of |s''|.
        j: (N,) bounds of |s'''|.
    """
    bend, third, last = bounds[:, 1], bounds[:, 2], bounds[:, 3]
    total: Array = last * w**4 + 6.0 * third * w * w * a + bend * (3.0 * a * a + 4.0 * w * j)
    return total


@frozen(eq=False)
class FourthDerivatives:
    """Bounds of the fourth time derivatives of the tool's position and rotation on N segments.

    Attributes:
        origin: (N,) bounds for the tool's origin [m/s^4].
        rotation: (N,) bounds for the tool's rotation matrix in the Frobenius norm [1/s^4].
    """

    origin: Array
    rotation: Array


def arm_fourth(reach: Array, prismatic: NDArray[np.bool_], w: Array, a: Array, j: Array) -> FourthDerivatives:
    """Bound the tool's fourth time derivatives while every joint has constant jerk.

    A partial derivative of the tool's origin over some joints is a chain of cross products with their axes.
    The innermost axis is that of the joint m nearest to the tool. The product's length is at most R_m, the
    tool's distance from this axis. The bound is therefore the sum of R_m (B_m - B_{m-1}) over the joints m.
    Here B_m is `fourth` of the sums of w, a and j over the joints up to m.

    The partial derivative over a prismatic joint is the joint's axis, a vector of length 1, which other
    joints can only turn. In a chain, a prismatic joint therefore occurs at most once, as the innermost
    vector. It adds the derivative of `fourth` in the direction of its own w, a and j. The partial derivatives
    of the rotation matrix are products with the cross-product matrices of the axes. Their Frobenius norm is
    at most sqrt 2.

    Args:
        reach: (n,) distances from `reaches`; not used for a prismatic joint.
        prismatic: (n,) True for prismatic joints.
        w: (N, n) largest |velocity| of each joint on a segment [rad/s or m/s].
        a: (N, n) largest |acceleration| [rad/s^2 or m/s^2].
        j: (N, n) largest |jerk| [rad/s^3 or m/s^3].
    """
    zero = np.zeros(len(w))
    sum_w, sum_a, sum_j, before, origin = zero, zero, zero, zero, zero
    for m in range(w.shape[1]):
        if prismatic[m]:
            # Add the derivative of `fourth` in the direction of this joint's largest velocity, acceleration
            # and jerk.
            origin = origin + (
                (4.0 * sum_w**3 + 12.0 * sum_w * sum_a + 4.0 * sum_j) * w[:, m]
                + 6.0 * (sum_w**2 + sum_a) * a[:, m]
                + 4.0 * sum_w * j[:, m]
            )
            continue
        sum_w, sum_a, sum_j = sum_w + w[:, m], sum_a + a[:, m], sum_j + j[:, m]
        # Add R_m (B_m - B_(m-1)), where B_m is `fourth` of the sums over all joints up to this one.
        upto = fourth(sum_w, sum_a, sum_j)
        origin = origin + reach[m] * (upto - before)
        before = upto
    return FourthDerivatives(origin, np.sqrt(2.0) * before)


def reaches(chain: Chain, flange_from_tool: Array, travel: Array) -> Array:
    """Bound the distance of the tool's origin from each revolute axis, over all joint positions.

    Going from the tool towards the base, choose on each axis the point nearest to the point chosen before.
    The distances between these points add up (triangle inequality: the vector between two axes only turns); a
    prismatic joint adds its travel.

    Args:
        chain: the arm.
        flange_from_tool: (4, 4) tool frame, relative to the flange.
        travel: (n,) largest distance of each prismatic joint from zero in the motion [m].

    Returns:
        (n,) distances [m]; zero for a prismatic joint.
    """
    point = (chain.base_from_flange @ flange_from_tool)[:3, 3]
    length = 0.0
    reach = np.zeros(chain.size)
    for joint in reversed(range(chain.size)):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        if not angular.any():
            length += float(travel[joint])
            continue
        # The screw's linear part is the cross product of a point of the axis with the axis.
        on_axis = np.cross(angular, linear)  # this point of the axis is the one nearest to the base's origin
        nearest = on_axis + angular * float(angular @ (point - on_axis))
        length += float(np.linalg.norm(point - nearest))
        reach[joint] = length
        point = nearest
    return reach


def hermite_bezier(e0: Array, rate0: Array, e1: Array, rate1: Array, d: Array) -> tuple[Array, ...]:
    """Return the four Bezier points of cubics with values `e` and derivatives `rate` at both ends of an
    interval of duration `d`.
    """
    third = d / 3.0
    return e0, e0 + third * rate0, e1 - third * rate1, e1


def catch_up(
    bezier: Array, group: NDArray[np.int64], end: float = 1.0, covered: Array | None = None
) -> Array:
    """Bound the distance of a path parameter s(t) from one that covers the whole path and never decreases.

    The second parameter is defined by its Bezier points. To get them, clip those of s(t) to the path, move
    the first to the path's start and the last to its end, and replace each by the largest one so far. The
    distance between the parameters is at most that of the Bezier points. A deviation at the second parameter
    is therefore a deviation from the whole path in order of time (Frechet distance), not from the nearest
    point.

    Args:
        bezier: (P, 4) Bezier points of s on each piece of time, in order.
        group: (P,) command of each piece, in order, from 0 on.
        end: value of s at the end of the path.
        covered: (C, 2) fractions of the path at which each command joins and leaves it; None for 0 and 1.

    Returns:
        (P,) largest distance on each piece, in s.
    """
    opens, closes = np.flatnonzero(np.diff(group, prepend=-1)), np.flatnonzero(np.diff(group, append=-1))
    share = np.clip(bezier / end, 0.0, 1.0)
    if covered is None:
        share[opens, 0], share[closes, 3] = 0.0, 1.0
    else:
        share = np.clip(share, covered[group, :1], covered[group, 1:])
        share[opens, 0], share[closes, 3] = covered[:, 0], covered[:, 1]
    share = np.ascontiguousarray(share)
    # Treat each command by itself: its proof must not depend on other commands, not even by rounding.
    for begin, stop in zip(opens.tolist(), (closes + 1).tolist(), strict=True):
        forward = share[begin:stop].reshape(-1)
        np.maximum.accumulate(forward, out=forward)
    lag: Array = np.abs(share * end - bezier).max(axis=1)
    return lag


def segment_max(values: Array, first: NDArray[np.int64]) -> Array:
    """Return the maximum of each group of rows. Groups begin at the rows `first`; none is empty."""
    result: Array = np.maximum.reduceat(values, first, axis=0)
    return result
