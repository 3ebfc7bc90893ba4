"""Compute the torques of a moving arm, at many instants at once (recursive Newton-Euler; Featherstone, Rigid
Body Dynamics Algorithms, ch. 5).

The model consists of rigid bodies only: no friction, rotors or springs. Each link has a frame whose z is its
joint's axis. A joint's rotation therefore mixes only two rows of a matrix, and the transform between two
joints is a constant matrix. The last index of an array counts the instants, so that each step of the
algorithm is a few operations on whole rows.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain, Dynamics

BLOCK = 2048
"""Number of instants in one block. It is small enough for the arrays of a step to stay in the processor's
cache.
"""


def torques(chain: Chain, dynamics: Dynamics, q: Array, v: Array, a: Array) -> Array:
    """Compute the torques that the motors must supply for given joint positions, velocities and
    accelerations.

    Args:
        chain: the arm, n joints.
        dynamics: its masses.
        q: (P, n) joint positions [rad or m].
        v: (P, n) joint velocities [rad/s or m/s].
        a: (P, n) joint accelerations [rad/s^2 or m/s^2].

    Returns:
        (P, n) torques of turning joints [N m], and forces of sliding joints [N].
    """
    found = np.empty(q.shape)
    for start in range(0, len(q), BLOCK):
        rows = slice(start, start + BLOCK)
        found[rows] = _torques(chain, dynamics, *(np.ascontiguousarray(one[rows].T) for one in (q, v, a))).T
    return found


def holding_torques(chain: Chain, dynamics: Dynamics, q: Array) -> Array:
    """Return the torques (P, n) that hold the arm at rest against gravity, at joint positions `q` (P, n)."""
    still = np.zeros_like(q)
    return torques(chain, dynamics, q, still, still)


def _torques(chain: Chain, dynamics: Dynamics, q: Array, v: Array, a: Array) -> Array:
    """Compute `torques` with arrays of shape (n, P), the instants last."""
    links = _links(chain, dynamics)
    size, count = q.shape
    angle = q * links.turn[:, None]
    sin, cos = np.sin(angle), np.cos(angle)
    # for each link, in its own axes: angular velocity, angular acceleration, and acceleration of its origin;
    # gravity enters as an upward acceleration of the base
    spin, spin_rate = np.zeros((3, count)), np.zeros((3, count))
    rise = np.repeat(-dynamics.gravity[:, None], count, axis=1)
    forces, moments, arms = [], [], []
    # outward from the base: motion of each link, and the force and moment about its origin that this motion
    # needs
    for joint in range(size):
        arm = links.shift[joint][:, None]
        turn, slide = links.turn[joint], links.slide[joint]
        if slide:
            axis = links.step[joint][:, 2:]
            arm = arm + slide * q[joint] * axis
            # the Coriolis term of a sliding joint: 2 ω × v
            rise = rise + slide * (a[joint] * axis + 2.0 * v[joint] * _cross(spin, axis))
        rise = rise + _swung(spin, spin_rate, arm)
        spin, spin_rate, rise = (
            _into(links.step[joint], sin[joint], cos[joint], one) for one in (spin, spin_rate, rise)
        )
        if turn:
            # the joint's velocity vector turns with the links before the joint: ω × (axis · rate)
            spin_rate[0] += spin[1] * (turn * v[joint])
            spin_rate[1] -= spin[0] * (turn * v[joint])
            spin_rate[2] += turn * a[joint]
            spin[2] += turn * v[joint]
        center = links.center[joint][:, None]
        force = links.mass[joint] * (rise + _swung(spin, spin_rate, center))
        inertia = links.inertia[joint]
        forces.append(force)
        moments.append(inertia @ spin_rate + _cross(spin, inertia @ spin) + _cross(center, force))
        arms.append(arm)
    # inward from the flange: each joint carries its link and all links after it
    torques = np.empty((size, count))
    force, moment = forces[-1], moments[-1]
    for joint in reversed(range(size)):
        torques[joint] = links.turn[joint] * moment[2] + links.slide[joint] * force[2]
        if joint:
            force, moment = (
                _out_of(links.step[joint], sin[joint], cos[joint], one) for one in (force, moment)
            )
            moment = moments[joint - 1] + moment + _cross(arms[joint], force)
            force = forces[joint - 1] + force
    return torques


@frozen(eq=False)
class _Links:
    """The constants of an arm that the recursion needs, for each joint and the body that the joint moves.

    Attributes:
        step: (n, 3, 3) rotation of the joint's frame relative to the previous joint's frame.
        shift: (n, 3) origin of the joint's frame in the previous joint's frame [m].
        mass: (n,) mass of the body [kg].
        center: (n, 3) centre of mass of the body, in the joint's frame [m].
        inertia: (n, 3, 3) inertia of the body about its centre of mass, in the joint's frame [kg m^2].
        turn: (n,) rotation about z per unit of joint position.
        slide: (n,) translation along z per unit of joint position.
    """

    step: Array
    shift: Array
    mass: Array
    center: Array
    inertia: Array
    turn: Array
    slide: Array


def _links(chain: Chain, dynamics: Dynamics) -> _Links:
    links = links_of(chain)
    turns, origins = links.frames[:, :3, :3], links.frames[:, :3, 3]
    back = turns.transpose(0, 2, 1)
    before = np.concatenate([np.eye(3)[None], back[:-1]])
    ways = np.diff(origins, axis=0, prepend=np.zeros((1, 3)))
    return _Links(
        before @ turns,
        (before @ ways[:, :, None])[:, :, 0],
        dynamics.mass,
        (back @ (dynamics.center - origins)[:, :, None])[:, :, 0],
        back @ dynamics.inertia @ turns,
        links.turn,
        links.slide,
    )


def _swung(spin: Array, spin_rate: Array, arm: Array) -> Array:
    """Return the acceleration that the rotation of a body alone causes at the point `arm` (3, 1) or (3, P) of
    the body: α × r + ω × (ω × r).
    """
    # ω × (ω × r) = ω (ω · r) - r (ω · ω)
    along = (spin * arm).sum(axis=0)
    swung: Array = _cross(spin_rate, arm) + spin * along - arm * (spin * spin).sum(axis=0)
    return swung


def _into(step: Array, sin: Array, cos: Array, vectors: Array) -> Array:
    """Transform vectors (3, P) from the axes of the previous link to the axes of a link."""
    x, y, z = step.T @ vectors
    return np.stack([cos * x + sin * y, cos * y - sin * x, z])


def _out_of(step: Array, sin: Array, cos: Array, vectors: Array) -> Array:
    """Transform vectors (3, P) from the axes of a link to the axes of the previous link."""
    x, y, z = vectors
    back: Array = step @ np.stack([cos * x - sin * y, sin * x + cos * y, z])
    return back


def _cross(vectors: Array, other: Array) -> Array:
    """Return the cross products of (3, P) with (3, P) or (3, 1)."""
    return np.stack(
        [
            vectors[1] * other[2] - vectors[2] * other[1],
            vectors[2] * other[0] - vectors[0] * other[2],
            vectors[0] * other[1] - vectors[1] * other[0],
        ]
    )
