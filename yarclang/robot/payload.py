"""Compute the largest torques that an arm needs to hold itself at rest, over all joint positions within its
limits.

Collisions and zones are ignored, so the worst position may be one that the arm can't take. The result is
therefore an upper bound.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.dynamics import holding_torques
from yarclang.robot.model import Array, Chain, Dynamics

_STARTS, _EACH = 48, 96
"""Number of groups of evenly spread joint positions, and number of joint positions in each group. The search
for the largest torque of a joint starts from the worst position of each group.
"""
_SWEEPS = 6
_WIDE = np.pi
"""Limit that replaces an infinite position limit of a joint, to either side of 0 [rad or m]."""
_THIRDS = np.array([0.0, 1.0, 2.0]) * 2.0 * np.pi / 3.0


@frozen(eq=False)
class Worst:
    """The largest torque of each joint.

    `torque` (n,) has these torques [N m, or N] with their signs. Row k of `q` (n, n) is the joint position
    [rad or m] at which the torque of joint k is largest.
    """

    torque: Array
    q: Array


def worst_of(torque: Array, q: Array) -> Worst:
    """Return the largest torque of each joint, by magnitude, among P joint positions.

    Args:
        torque: (P, n) [N m, or N].
        q: (P, n) the joint positions at which these torques were computed [rad or m].
    """
    rows = np.abs(torque).argmax(axis=0)
    return Worst(torque[rows, np.arange(torque.shape[1])], q[rows])


def worst_holding(chain: Chain, dynamics: Dynamics, lower: Array, upper: Array) -> Worst:
    """Find the joint positions at which gravity loads each joint most.

    Joint positions are spread evenly over the limits and divided into groups. The worst position of each
    group is then improved along one joint after the other. As a function of one joint, a holding torque is a
    sine or a line; its values at three positions of that joint determine its extremes.

    Args:
        chain: the arm, n joints.
        dynamics: its masses.
        lower: (n,) lower limits of position [rad or m]; -pi replaces infinite limits.
        upper: (n,) upper limits of position [rad or m]; pi replaces infinite limits.
    """
    low = np.where(np.isfinite(lower), lower, -_WIDE)
    high = np.where(np.isfinite(upper), upper, _WIDE)
    size = chain.size
    spread = low + _spread(_STARTS * _EACH, size) * (high - low)
    torque = np.abs(holding_torques(chain, dynamics, spread)).reshape(_STARTS, _EACH, size)
    # (_STARTS, n): for each group and each joint, the position of the group at which the joint's torque is
    # largest
    at = torque.argmax(axis=1)
    q = spread.reshape(_STARTS, _EACH, size)[np.arange(_STARTS)[:, None], at].reshape(-1, size)
    own = np.tile(np.arange(size), _STARTS)  # the joint whose torque a row maximizes
    for _ in range(_SWEEPS):
        for moved in range(size):
            q[:, moved] = _worst_along(chain, dynamics, q, own, moved, (low[moved], high[moved]))
    found = holding_torques(chain, dynamics, q)[np.arange(len(q)), own].reshape(_STARTS, size)
    rows = np.abs(found).argmax(axis=0)
    each = np.arange(size)
    return Worst(found[rows, each], q.reshape(_STARTS, size, size)[rows, each])


def _worst_along(
    chain: Chain,
    dynamics: Dynamics,
    q: Array,
    joints: NDArray[np.intp],
    moved: int,
    limits: tuple[float, float],
) -> Array:
    """Move one joint, and return the position of this joint at which a holding torque is largest. The result
    (R,) has one position for each row of `q`.

    Args:
        chain: the arm, n joints.
        dynamics: its masses.
        q: (R, n) joint positions [rad or m].
        joints: (R,) for each row, the joint whose torque is maximized.
        moved: the joint that moves.
        limits: the lower and the upper limit of that joint.
    """
    low, high = limits
    rows = np.arange(len(q))
    # the torque is mean + cosine · cos + sine · sin of the angle; three equidistant angles determine these
    # three coefficients
    tried = np.repeat(q[None], 3, axis=0)
    tried[:, :, moved] = _THIRDS[:, None]
    values = holding_torques(chain, dynamics, tried.reshape(-1, q.shape[1])).reshape(3, *q.shape)
    value = values[:, rows, joints]  # (3, R)
    mean = value.mean(axis=0)
    cosine, sine = (2.0 / 3.0 * (wave @ value) for wave in (np.cos(_THIRDS), np.sin(_THIRDS)))
    # the extremes of the sine: its peak plus all multiples of half a turn, within the limits. The limits
    # themselves are tried, too. For a sliding joint, the torque is a line, which has its extremes at the
    # limits.
    turns = np.arange(np.floor((low - np.pi) / np.pi), np.ceil((high + np.pi) / np.pi) + 1.0) * np.pi
    peaks = np.arctan2(sine, cosine) + turns[:, None]
    places = np.vstack([np.clip(peaks, low, high), np.full(len(q), low), np.full(len(q), high)])
    if chain.is_prismatic[moved]:
        slope = (value[2] - value[0]) / (_THIRDS[2] - _THIRDS[0])
        size = np.abs(value[0] + slope * (places - _THIRDS[0]))
    else:
        size = np.abs(mean + cosine * np.cos(places) + sine * np.sin(places))
    best: Array = places[size.argmax(axis=0), rows]
    return best


def _spread(count: int, size: int) -> Array:
    """Return (count, size) points spread evenly over the unit cube (Roberts' sequence: the golden ratio in
    `size` dimensions).
    """
    ratio = 2.0
    for _ in range(40):
        ratio = (1.0 + ratio) ** (1.0 / (size + 1))
    points: Array = (0.5 + np.arange(1, count + 1)[:, None] * ratio ** -np.arange(1, size + 1)) % 1.0
    return points
