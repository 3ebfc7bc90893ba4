"""Bounds of the second time derivatives of torques while every joint has constant jerk, without sampling.

The torque of joint k is the sum over the bodies i after it of z.(r x F) + z.N. Here z is the joint's axis, r
leads from a point on the axis to the body's centre of mass, F is mass times (acceleration minus gravity), and
N is the rate of the angular momentum. Each derivative with respect to a turning joint adds one cross product
with a unit vector, so the derivatives of each factor are at most the factor's length times Bell polynomials
of the joints' rates. The derivatives of the products follow by Leibniz' rule. docs/certificate.md has the
full derivation.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain, Dynamics

LEAST_LENGTH = 0.1
"""Least length of a vector between axes or to a body's centre of mass, in chains with prismatic joints [m].

The bounds treat the travel of a prismatic joint as a rotation, by the travel divided by the length of the
vector. A shorter vector is treated as if it had this length: the bounds hold for the shorter vector too.
"""

Derivatives = tuple[Array, ...]
"""Bounds (N,) of the norm of a vector, of its first derivative, and so on."""


def torque_bends(chain: Chain, dynamics: Dynamics, travel: Array, peaks: tuple[Array, Array, Array]) -> Array:
    """Bound |second time derivative of the torque| of each joint (N, n) on N pieces [N m/s^2 or N/s^2].

    Args:
        chain: the arm.
        dynamics: the arm's masses and inertias.
        travel: (N, n) largest distance of each prismatic joint from zero on the pieces [m]; not used for
            other joints.
        peaks: largest |velocity|, |acceleration| and |jerk| of each joint on the pieces, (N, n) each.
    """
    prismatic = chain.is_prismatic
    turning, sliding = (
        tuple(np.cumsum(np.where(prismatic == kind, one, 0.0), axis=1).T for one in peaks)
        for kind in (False, True)
    )
    pull = float(np.linalg.norm(dynamics.gravity))
    bends = np.zeros_like(peaks[0])
    size = len(peaks[0])
    nothing = np.zeros(size)
    for body in range(chain.size):
        mass = float(dynamics.mass[body])
        if mass == 0.0:
            continue
        lengths = _lengths(chain, dynamics.center[body], body, travel)
        rates = _Rates(*(one[body] for one in (*turning, *sliding)))
        reach = lengths[0]
        # The force and its first two derivatives are the mass times the second, third and fourth derivatives
        # of the centre of mass, which Bell polynomials bound. Gravity is constant, so it adds only to the
        # force itself.
        _, _, second, third, fourth = rates.grown(reach)
        force: Derivatives = (mass * (reach * second + pull), mass * reach * third, mass * reach * fourth)
        # The largest principal moment of inertia is the spectral norm of the inertia tensor.
        stiff = float(np.linalg.eigvalsh(dynamics.inertia[body])[-1])
        twist = _momentum_rates(stiff, rates)
        for joint in range(body + 1):
            # The axis of a joint is turned only by the joints before it.
            before = _Rates(*(one[joint - 1] if joint else nothing for one in turning), *([nothing] * 3))
            # Apply Leibniz' rule to z . F for a prismatic joint, and to z . (r x F) + z . N for a revolute
            # one (notation as at the head of this module).
            axis = before.grown(1.0)[:3]
            if prismatic[joint]:
                bend = _product(axis, force)
            else:
                length = lengths[joint]
                # The lever arm r moves with all joints up to the body.
                arm: Derivatives = tuple(length * one for one in rates.grown(length)[:3])
                bend = _triple(axis, arm, force) + _product(axis, twist)
            bends[:, joint] += bend
    return bends


@frozen(eq=False)
class _Rates:
    """Sums of the largest rates over some joints on N pieces of time, (N,) each.

    Attributes:
        w: sum of |velocity| of the revolute joints [rad/s].
        a: sum of |acceleration| of the revolute joints [rad/s^2].
        j: sum of |jerk| of the revolute joints [rad/s^3].
        v_slide: sum of |velocity| of the prismatic joints [m/s].
        a_slide: sum of |acceleration| of the prismatic joints [m/s^2].
        j_slide: sum of |jerk| of the prismatic joints [m/s^3].
    """

    w: Array
    a: Array
    j: Array
    v_slide: Array
    a_slide: Array
    j_slide: Array

    def grown(self, length: Array | float) -> Derivatives:
        """Bound the derivatives of order 0 to 4 of a vector of `length` [m], as multiples of its length (N,).

        They are the Bell polynomials of the rates.
        """
        # The travel of a prismatic joint counts as a rotation by the travel divided by the vector's length.
        scale = 1.0 / np.maximum(length, 1e-9)  # with prismatic joints, lengths are at least LEAST_LENGTH
        w, a, j = (
            turn + scale * slide
            for turn, slide in ((self.w, self.v_slide), (self.a, self.a_slide), (self.j, self.j_slide))
        )
        return _bell(w, a, j)


def _bell(w: Array, a: Array, j: Array) -> Derivatives:
    """Return the complete Bell polynomials of order 0 to 4 of w, a, j and a fourth rate of zero."""
    return (
        np.ones_like(w),
        w,
        w * w + a,
        w**3 + 3.0 * w * a + j,
        w**4 + 6.0 * w * w * a + 3.0 * a * a + 4.0 * w * j,
    )


def _momentum_rates(stiff: float, rates: _Rates) -> Derivatives:
    """Bound a body's rate of angular momentum about its centre of mass, and two derivatives of this rate.

    Args:
        stiff: largest moment of inertia of the body [kg m^2].
        rates: sums of the rates of the joints before the body.
    """
    w, a, j = rates.w, rates.a, rates.j
    # With the body's rotation R, the inertia tensor is R I R'. It is turned from both sides, so its rates
    # count twice.
    tensor = [stiff * one for one in _bell(2.0 * w, 2.0 * a, 2.0 * j)[:4]]
    _, first, second, third, _ = _bell(w, a, j)
    # The angular velocity is the sum of the axes times the joint velocities.
    spin = [
        w,
        a + first * w,
        j + 2.0 * first * a + second * w,
        3.0 * first * j + 3.0 * second * a + third * w,
    ]
    return (
        # Apply Leibniz' rule to the product of inertia tensor and angular velocity.
        tensor[1] * spin[0] + tensor[0] * spin[1],
        tensor[2] * spin[0] + 2.0 * tensor[1] * spin[1] + tensor[0] * spin[2],
        tensor[3] * spin[0] + 3.0 * tensor[2] * spin[1] + 3.0 * tensor[1] * spin[2] + tensor[0] * spin[3],
    )


def _product(one: Derivatives, other: Derivatives) -> Array:
    """Bound the second derivative of a product from bounds of both factors (Leibniz' rule)."""
    total: Array = one[2] * other[0] + 2.0 * one[1] * other[1] + one[0] * other[2]
    return total


def _triple(one: Derivatives, two: Derivatives, three: Derivatives) -> Array:
    """Bound the second derivative of a product from bounds of its three factors (Leibniz' rule)."""
    both: Derivatives = (
        one[0] * two[0],
        one[1] * two[0] + one[0] * two[1],
        _product(one, two),
    )
    return _product(both, three)


def _lengths(chain: Chain, center: Array, body: int, travel: Array) -> list[Array]:
    """Bound the distance of a body's centre of mass from each revolute axis before it, on N pieces of time.

    The method is that of `reaches` in bounds.py. A prismatic joint has the bound of the joint after it, plus
    its own travel.

    Returns:
        One bound (N,) [m] for each of the `body` + 1 joints.
    """
    point, length = center, np.zeros(len(travel))
    least = LEAST_LENGTH if chain.is_prismatic[: body + 1].any() else 0.0
    bounds: list[Array] = []
    for joint in reversed(range(body + 1)):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        if angular.any():
            # Find the foot of the perpendicular from the last point to this axis. The distances between
            # successive feet add up (triangle inequality), however the joints in between turn.
            on_axis = np.cross(angular, linear)
            nearest = on_axis + angular * float(angular @ (point - on_axis))
            length = length + float(np.linalg.norm(point - nearest))
            point = nearest
        else:
            length = length + travel[:, joint]
        bounds.insert(0, np.maximum(length, least))
    return bounds
