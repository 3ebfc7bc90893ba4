"""What an arm has to hold: its largest torques at rest, over all joint positions within its limits.

Links and zones don't count here: a position that the arm can't reach without touching something may be the worst one, so the result is a bound from above.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.dynamics import holding_torques
from yarclang.robot.model import Array, Chain, Dynamics

_STARTS, _EACH = 48, 96
"""Positions from which is searched, and so many of the first look for each of them, spread evenly."""
_SWEEPS = 6
_WIDE = np.pi
"""What a joint without limits is moved by, to both sides [rad or m]."""
_THIRDS = np.array([0.0, 1.0, 2.0]) * 2.0 * np.pi / 3.0


@frozen(eq=False)
class Worst:
    """Torques (n,) of the joints where each is largest [N m, or N], with their signs; `q` (n, n) are the joint positions there, a row a joint [rad or m]."""

    torque: Array
    q: Array


def worst_of(torque: Array, q: Array) -> Worst:
    """Return the largest of P torques of each joint.

    Args:
        torque: (P, n) [N m, or N].
        q: (P, n) the joint positions at which they were computed [rad or m].
    """
    rows = np.abs(torque).argmax(axis=0)
    return Worst(torque[rows, np.arange(torque.shape[1])], q[rows])


def worst_holding(chain: Chain, dynamics: Dynamics, lower: Array, upper: Array) -> Worst:
    """Find where gravity pulls most at each joint.

    Positions are spread first; the worst ones of parts of them are then moved along one joint after the other. As a function of one joint a holding
    torque is a sine or a line, whose extremes are known from three of its values.

    Args:
        chain: the arm.
        dynamics: its masses.
        lower: (n,) limits of position; infinite ones are taken as -pi [rad or m].
        upper: (n,) limits of position; infinite ones are taken as pi [rad or m].
    """
    low = np.where(np.isfinite(lower), lower, -_WIDE)
    high = np.where(np.isfinite(upper), upper, _WIDE)
    size = chain.size
    spread = low + _spread(_STARTS * _EACH, size) * (high - low)
    torque = np.abs(holding_torques(chain, dynamics, spread)).reshape(_STARTS, _EACH, size)
    at = torque.argmax(axis=1)  # (_STARTS, n): of each part, where each joint's torque is largest
    q = spread.reshape(_STARTS, _EACH, size)[np.arange(_STARTS)[:, None], at].reshape(-1, size)
    own = np.tile(np.arange(size), _STARTS)  # the joint whose torque a row is for
    for _ in range(_SWEEPS):
        for moved in range(size):
            q[:, moved] = _worst_along(chain, dynamics, q, own, moved, (low[moved], high[moved]))
    found = holding_torques(chain, dynamics, q)[np.arange(len(q)), own].reshape(_STARTS, size)
    rows = np.abs(found).argmax(axis=0)
    each = np.arange(size)
    return Worst(found[rows, each], q.reshape(_STARTS, size, size)[rows, each])


def _worst_along(
    chain: Chain, dynamics: Dynamics, q: Array, own: NDArray[np.intp], moved: int, limits: tuple[float, float]
) -> Array:
    """Return (R,) the position of one joint at which each row's torque is largest.

    Args:
        chain: the arm.
        dynamics: its masses.
        q: (R, n) joint positions.
        own: (R,) the joint whose torque counts.
        moved: the joint that moves.
        limits: of it.
    """
    low, high = limits
    rows = np.arange(len(q))
    tried = np.repeat(q[None], 3, axis=0)
    tried[:, :, moved] = _THIRDS[:, None]
    values = holding_torques(chain, dynamics, tried.reshape(-1, q.shape[1])).reshape(3, *q.shape)
    value = values[:, rows, own]  # (3, R)
    mean = value.mean(axis=0)
    cosine, sine = (2.0 / 3.0 * (wave @ value) for wave in (np.cos(_THIRDS), np.sin(_THIRDS)))
    # the extremes of the sine, with their repetitions within the limits; of a line they are wrong, but its ends are tried as well
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
    """Return (count, size) points of the unit cube that are spread evenly (Roberts' sequence, the golden ratio in `size` dimensions)."""
    ratio = 2.0
    for _ in range(40):
        ratio = (1.0 + ratio) ** (1.0 / (size + 1))
    points: Array = (0.5 + np.arange(1, count + 1)[:, None] * ratio ** -np.arange(1, size + 1)) % 1.0
    return points
