"""Instants at which the robot passes corners without a blend radius, from one path to the next.

Any instant is valid for the proof: the first path is proved up to it, and the second path from it on. A good
choice makes the proved bound sharp.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from yarclang.certify.kinematics.arm import poses_and_jacobians, tool_poses
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.programmed import Rows
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Chain

_LOOKS = 8
"""Number of instants at which each segment is examined in the first search for a passing time."""
_ROUNDS = 48
"""Largest number of rounds of the search for a zero."""
_FALSE_POSITIONS = 12
"""Number of rounds of false position before bisection is used. An almost straight function needs four or
five.
"""
_CLOSE = 1e-9
"""Times that differ by at most this fraction of a segment's duration count as equal."""
_LEAST = 1e-7
"""Least time between a passing time and either end of its segment, as a fraction of the segment's
duration.
"""


@frozen(eq=False)
class Corners:
    """K corners, all given by joint positions or all by poses of a moving frame.

    Attributes:
        q: (K, n) joint positions [rad or m].
        weights: (K, n) weights of the joints [1/rad or 1/m]; for poses (K, 2), weights of a distance [1/m]
            and an angle [1/rad].
        flange_from_moving: (4, 4) moving frame, relative to the flange; None for corners given by joint
            positions.
        poses: (K, 4, 4) poses of the moving frame; None for corners given by joint positions.
    """

    q: Array
    weights: Array
    flange_from_moving: Array | None = None
    poses: Array | None = None

    def away(self, chain: Chain, own: Rows, x: Array) -> Array:
        """Return the squared weighted distances (N,) of joint positions `x` (N, n) from corners.

        `own` (N,) are the indices of the corners.
        """
        if self.flange_from_moving is None or self.poses is None:
            square: Array = (((x - self.q[own]) * self.weights[own]) ** 2).sum(axis=1)
            return square
        off = tool_poses(chain, x, self.flange_from_moving)[:, :3] - self.poses[own, :3]
        far_weight, turn_weight = self.weights[own].T ** 2
        # The squared Frobenius norm of a rotation difference is 8 sin^2(angle / 2), about twice the squared
        # angle. Therefore `turn` is halved below.
        far, turn = _sum(off[:, :, 3] ** 2), _sum(_sum(off[:, :, :3] ** 2))
        found: Array = far * far_weight + turn * turn_weight / 2.0
        return found

    def closing(self, chain: Chain, own: Rows, x: Array, v: Array) -> Array:
        """Return half the rate of change of the squared weighted distances (N,) from the corners, at joint
        positions `x` with joint velocities `v`.
        """
        if self.flange_from_moving is None or self.poses is None:
            rate: Array = ((x - self.q[own]) * self.weights[own] ** 2 * v).sum(axis=1)
            return rate
        poses, jacobians = poses_and_jacobians(chain, x, self.flange_from_moving)
        far_weight, turn_weight = self.weights[own].T ** 2
        twist = (jacobians @ v[:, :, None])[:, :, 0]
        off = poses[:, :3] - self.poses[own, :3]
        spin = np.cross(twist[:, 3:, None], poses[:, :3, :3], axis=1)
        # Half the derivative of a squared norm |off|^2 is off . off', here for position and rotation matrix.
        along, around = _sum(off[:, :, 3] * twist[:, :3]), _sum(_sum(off[:, :, :3] * spin))
        found: Array = along * far_weight + around * turn_weight / 2.0
        return found


def _sum(values: Array) -> Array:
    """Return the sums (N, ...) over the three entries of axis 1 of an array (N, 3, ...).

    The order of the additions is fixed, so that the last bit of a result does not depend on N.
    """
    found: Array = values[:, 0] + values[:, 1] + values[:, 2]
    return found


def passing(cubics: Cubics, owner: Rows, corners: Corners, chain: Chain) -> tuple[Rows, Array]:
    """Find the instants at which corners are passed.

    Args:
        cubics: the N segments to search.
        owner: (N,) index of the corner of each segment, in ascending order; each corner has at least one
            segment.
        corners: the K corners.
        chain: the arm.

    Returns:
        The segment (K,) in which each corner is passed, and the time after the segment's start [s] (K,).
    """
    begins = np.flatnonzero(np.diff(owner, prepend=-1))
    sizes = np.diff(np.append(begins, len(owner)))
    segment = np.repeat(np.arange(len(owner)), _LOOKS)
    share = np.tile(np.arange(_LOOKS) / _LOOKS, len(owner))
    # For each corner, find the nearest of the points that are sampled on its segments, `_LOOKS` on each.
    far = corners.away(chain, owner[segment], _at(cubics, segment, share)[0])
    first = begins * _LOOKS
    nearest = _first_least(far, first)
    # The squared distance falls before the corner and grows after it: search for the zero of its rate between
    # the neighbours of the nearest examined point.
    low, high = np.maximum(nearest - 1, first), np.minimum(nearest + 1, first + sizes * _LOOKS - 1)
    last, corner = sizes - 1, np.arange(len(begins))

    def rate(rows: Rows, place: Array) -> Array:
        """Return half the rate of change of the squared distance from corners.

        Args:
            rows: (K,) indices of the corners.
            place: (K,) instants as a number of segments after the corner's first one; the fractional part is
                the position within a segment.
        """
        whole = np.minimum(place.astype(np.int64), last[rows])
        return corners.closing(chain, rows, *_at(cubics, begins[rows] + whole, place - whole))

    # Count `place` from the first segment of each corner, so that a result does not depend on where the
    # corner is in the text.
    edges = (segment[edge] - begins + share[edge] for edge in (low, high))
    place = _crossing(rate, corner, *edges)
    found = np.minimum(place.astype(np.int64), last)
    # The corner divides the found segment: neither part may have the duration 0.
    part = np.clip(place - found, _LEAST, 1.0 - _LEAST)
    return begins + found, part * cubics.h[begins + found]


def _crossing(rate: Callable[[Rows, Array], Array], rows: Rows, low: Array, high: Array) -> Array:
    """Find where the rate of each row (K,) becomes positive.

    The method is false position with the Illinois rule, followed by bisection if that is slow.

    Args:
        rate: function that takes rows (M,) and positions (M,) and returns the rates at these positions.
        rows: (K,) the rows.
        low: (K,) start of the search.
        high: (K,) end of the search.
    """
    crossing = low.copy()
    low_rate, high_rate = rate(rows, low), rate(rows, high)
    falls = low_rate <= 0.0
    # If the distance falls up to the end of the search, the corner is passed there.
    crossing[falls & (high_rate <= 0.0)] = high[falls & (high_rate <= 0.0)]
    (inner,) = np.nonzero(falls & (high_rate > 0.0) & (high - low > _CLOSE))
    rows, fell, at = rows[inner], np.zeros(len(inner), dtype=np.int64), inner
    low, high, low_rate, high_rate = low[inner], high[inner], low_rate[inner], high_rate[inner]
    for turn in range(_ROUNDS):
        if not len(rows):
            break
        # False position takes the zero of the chord between both ends. Bisection takes the middle.
        part = low_rate / (low_rate - high_rate) if turn < _FALSE_POSITIONS else np.full(len(rows), 0.5)
        # If the zero is close to one end, step just past the zero. In the next round, the other end then
        # moves close to the zero as well.
        aside = 0.4 * _CLOSE
        middle = np.clip(low + part * (high - low), low + aside, high - aside)
        now = rate(rows, middle)
        falls = now <= 0.0
        # Illinois rule: halve the value at an end that is kept twice in a row.
        low_rate = np.where(falls, now, np.where(fell < 0, 0.5 * low_rate, low_rate))
        high_rate = np.where(falls, np.where(fell > 0, 0.5 * high_rate, high_rate), now)
        low, high, fell = np.where(falls, middle, low), np.where(falls, high, middle), np.where(falls, 1, -1)
        crossing[at] = low
        left = high - low > _CLOSE
        rows, fell, at = rows[left], fell[left], at[left]
        low, high, low_rate, high_rate = low[left], high[left], low_rate[left], high_rate[left]
    return crossing


def _first_least(values: Array, begins: Rows) -> Rows:
    """Return the index of the first minimum of each group; groups begin at `begins` (K,)."""
    least = np.minimum.reduceat(values, begins)
    size = np.diff(np.append(begins, len(values)))
    hits = np.flatnonzero(values == np.repeat(least, size))
    found: Rows = hits[np.searchsorted(hits, begins)]
    return found


def _at(cubics: Cubics, rows: Rows, share: Array) -> tuple[Array, Array]:
    return cubics.take(rows).at(share * cubics.h[rows])
