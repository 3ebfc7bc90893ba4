"""How quickly torques can change: bounds of their second derivatives while every joint has constant jerk. All arrays, no sampling.

The torque of joint k is the sum over the bodies i behind it of z.(r x F) + z.N: z is the axis, r leads from a point on it to the body's centre of mass, F is mass times
acceleration without gravity, N the rate of the angular momentum. A joint that turns adds one cross product with a unit vector to a derivative, so that each factor's derivatives are at most its
length times Bell's polynomials of the joints' rates; the product's are Leibniz's sums of these. docs/certificate.md has it in full.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain, Dynamics

LEAST_LENGTH = 0.1
"""Where joints slide, lengths count as at least this [m]: a longer one bounds as well, and a way of a length is a turn by one over it."""

Derivatives = tuple[Array, ...]
"""Bounds (N,) of the size of something, of its first derivative, and so on."""


def torque_bends(chain: Chain, dynamics: Dynamics, travel: Array, peaks: tuple[Array, Array, Array]) -> Array:
    """Bounds (N, n) of |second derivative of the torque| of each joint on N pieces [N m/s^2 or N/s^2].

    Args:
        chain: the arm.
        dynamics: its masses.
        travel: (N, n) largest |q| of each joint on the pieces; of those that slide it is read [m].
        peaks: largest |velocity|, |acceleration| and |jerk| of each joint on the pieces, (N, n) each.
    """
    prismatic = chain.is_prismatic
    turning, sliding = (
        tuple(np.cumsum(np.where(prismatic == kind, one, 0.0), axis=1).T for one in peaks)
        for kind in (False, True)
    )
    pull = float(np.linalg.norm(dynamics.gravity))
    found = np.zeros_like(peaks[0])
    size = len(peaks[0])
    nothing = np.zeros(size)
    for body in range(chain.size):
        mass = float(dynamics.mass[body])
        if mass == 0.0:
            continue
        lengths = _lengths(chain, dynamics.center[body], body, travel)
        rates = _Rates(*(one[body] for one in (*turning, *sliding)))
        reach = lengths[0]
        _, _, second, third, fourth = rates.grown(reach)
        force: Derivatives = (mass * (reach * second + pull), mass * reach * third, mass * reach * fourth)
        stiff = float(np.linalg.eigvalsh(dynamics.inertia[body])[-1])
        twist = _momentum_rates(stiff, rates)
        for joint in range(body + 1):
            before = _Rates(*(one[joint - 1] if joint else nothing for one in turning), *([nothing] * 3))
            axis = before.grown(1.0)[:3]
            if prismatic[joint]:
                bend = _product(axis, force)
            else:
                length = lengths[joint]
                arm: Derivatives = tuple(length * one for one in rates.grown(length)[:3])
                bend = _triple(axis, arm, force) + _product(axis, twist)
            found[:, joint] += bend
    return found


@frozen(eq=False)
class _Rates:
    """Sums over joints of the largest |velocity|, |acceleration| and |jerk| (N,): of those that turn [rad, s], and of those that slide [m, s]."""

    w: Array
    a: Array
    j: Array
    v_slide: Array
    a_slide: Array
    j_slide: Array

    def grown(self, length: Array | float) -> Derivatives:
        """Bell's polynomials (N,) of the order 0 to 4: by how much its length the derivatives of a vector of `length` [m] are at most."""
        scale = 1.0 / np.maximum(length, 1e-9)  # where something slides, lengths are longer
        w, a, j = (
            turn + scale * slide
            for turn, slide in ((self.w, self.v_slide), (self.a, self.a_slide), (self.j, self.j_slide))
        )
        return _bell(w, a, j)


def _bell(w: Array, a: Array, j: Array) -> Derivatives:
    """Complete Bell polynomials with the fourth derivative zero."""
    return (
        np.ones_like(w),
        w,
        w * w + a,
        w**3 + 3.0 * w * a + j,
        w**4 + 6.0 * w * w * a + 3.0 * a * a + 4.0 * w * j,
    )


def _momentum_rates(stiff: float, rates: _Rates) -> Derivatives:
    """Bounds of the rate of a body's angular momentum about its centre, and of that rate's derivatives; `stiff` is its largest moment of inertia."""
    w, a, j = rates.w, rates.a, rates.j
    # its inertia is turned from both sides
    tensor = [stiff * one for one in _bell(2.0 * w, 2.0 * a, 2.0 * j)[:4]]
    _, first, second, third, _ = _bell(w, a, j)
    # the spin is the sum of the axes times their rates
    spin = [
        w,
        a + first * w,
        j + 2.0 * first * a + second * w,
        3.0 * first * j + 3.0 * second * a + third * w,
    ]
    return (
        tensor[1] * spin[0] + tensor[0] * spin[1],
        tensor[2] * spin[0] + 2.0 * tensor[1] * spin[1] + tensor[0] * spin[2],
        tensor[3] * spin[0] + 3.0 * tensor[2] * spin[1] + 3.0 * tensor[1] * spin[2] + tensor[0] * spin[3],
    )


def _product(one: Derivatives, other: Derivatives) -> Array:
    """The second derivative of a product of two."""
    total: Array = one[2] * other[0] + 2.0 * one[1] * other[1] + one[0] * other[2]
    return total


def _triple(one: Derivatives, two: Derivatives, three: Derivatives) -> Array:
    """The second derivative of a product of three."""
    both: Derivatives = (
        one[0] * two[0],
        one[1] * two[0] + one[0] * two[1],
        _product(one, two),
    )
    return _product(both, three)


def _lengths(chain: Chain, center: Array, body: int, travel: Array) -> list[Array]:
    """How far a body's centre can be from a point of each turning joint's axis before it on N pieces, body + 1 times (N,) [m]; see `reaches` of bounds.py.

    Of a sliding joint it is what the joint behind it has.
    """
    point, length = center, np.zeros(len(travel))
    least = LEAST_LENGTH if chain.is_prismatic[: body + 1].any() else 0.0
    found: list[Array] = []
    for joint in reversed(range(body + 1)):
        linear, angular = chain.screws[joint, :3], chain.screws[joint, 3:]
        if angular.any():
            on_axis = np.cross(angular, linear)
            nearest = on_axis + angular * float(angular @ (point - on_axis))
            length = length + float(np.linalg.norm(point - nearest))
            point = nearest
        else:
            length = length + travel[:, joint]
        found.insert(0, np.maximum(length, least))
    return found
