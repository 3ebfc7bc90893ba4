"""Where motions go over from one path to the next in corners that they may not leave: when they pass them.

Any instant would be lawful: up to it the one path is proved, from it on the other. A good one proves more.
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
"""So often a segment is looked at."""
_ROUNDS = 48
_FALSE_POSITIONS = 12
"""Rounds by false positions: a rate that is nearly a straight line takes four or five. All others halve."""
_CLOSE = 1e-9
"""Shares of a segment that are one instant."""
_LEAST = 1e-7


@frozen(eq=False)
class Corners:
    """K corners, as joints `q` (K, n) that count by `weights` (K, n), or, with one frame at `flange_from_moving` (4, 4), as its `poses` (K, 4, 4),
    in which 1 / `weights` (K, 2) are a distance [m] and an angle [rad].
    """

    q: Array
    weights: Array
    flange_from_moving: Array | None = None
    poses: Array | None = None

    def away(self, chain: Chain, own: Rows, x: Array) -> Array:
        """Return the square of how far joints `x` (N, n) are from the corners `own` (N,)."""
        if self.flange_from_moving is None or self.poses is None:
            square: Array = (((x - self.q[own]) * self.weights[own]) ** 2).sum(axis=1)
            return square
        off = tool_poses(chain, x, self.flange_from_moving)[:, :3] - self.poses[own, :3]
        far_weight, turn_weight = self.weights[own].T ** 2
        far, turn = _sum(off[:, :, 3] ** 2), _sum(_sum(off[:, :, :3] ** 2))
        found: Array = far * far_weight + turn * turn_weight / 2.0
        return found

    def closing(self, chain: Chain, own: Rows, x: Array, v: Array) -> Array:
        """Return half of how fast that square grows (N,) with velocities `v` (N, n)."""
        if self.flange_from_moving is None or self.poses is None:
            rate: Array = ((x - self.q[own]) * self.weights[own] ** 2 * v).sum(axis=1)
            return rate
        poses, jacobians = poses_and_jacobians(chain, x, self.flange_from_moving)
        far_weight, turn_weight = self.weights[own].T ** 2
        twist = (jacobians @ v[:, :, None])[:, :, 0]
        off = poses[:, :3] - self.poses[own, :3]
        spin = np.cross(twist[:, 3:, None], poses[:, :3, :3], axis=1)
        along, around = _sum(off[:, :, 3] * twist[:, :3]), _sum(_sum(off[:, :, :3] * spin))
        found: Array = along * far_weight + around * turn_weight / 2.0
        return found


def _sum(values: Array) -> Array:
    """Return sums (N, ...) over three rows (N, 3, ...), to the same last bit however many there are."""
    found: Array = values[:, 0] + values[:, 1] + values[:, 2]
    return found


def passing(cubics: Cubics, owner: Rows, corners: Corners, chain: Chain) -> tuple[Rows, Array]:
    """When corners are passed.

    Args:
        cubics: the segments that are looked at.
        owner: (N,) whose each is, in order; each corner has some, one after the other.
        corners: K of them.
        chain: the arm.

    Returns:
        The segments (K,), of all, and how long after the start of each [s] (K,).
    """
    begins = np.flatnonzero(np.diff(owner, prepend=-1))
    sizes = np.diff(np.append(begins, len(owner)))
    segment = np.repeat(np.arange(len(owner)), _LOOKS)
    share = np.tile(np.arange(_LOOKS) / _LOOKS, len(owner))
    far = corners.away(chain, owner[segment], _at(cubics, segment, share)[0])
    first = begins * _LOOKS
    nearest = _first_least(far, first)
    # the square of the distance falls before the corner and grows behind it
    low, high = np.maximum(nearest - 1, first), np.minimum(nearest + 1, first + sizes * _LOOKS - 1)
    last, own = sizes - 1, np.arange(len(begins))

    def rate(rows: Rows, place: Array) -> Array:
        """Return how fast the distance from corners `rows` (K,) grows at places (K,): segments behind the corner's first, and shares of them."""
        behind = np.minimum(place.astype(np.int64), last[rows])
        return corners.closing(chain, rows, *_at(cubics, begins[rows] + behind, place - behind))

    # counted from each corner's own first segment: what is found doesn't depend on where that stands
    edges = (segment[edge] - begins + share[edge] for edge in (low, high))
    place = _crossing(rate, own, *edges)
    found = np.minimum(place.astype(np.int64), last)
    # a part of a segment has a duration
    part = np.clip(place - found, _LEAST, 1.0 - _LEAST)
    return begins + found, part * cubics.h[begins + found]


def _crossing(rate: Callable[[Rows, Array], Array], rows: Rows, low: Array, high: Array) -> Array:
    """Return where a rate becomes positive in each row (K,), by the rule of false position (the Illinois way), and by halving where that takes long.

    Args:
        rate: gives the rates of rows (M,) at places (M,).
        rows: (K,).
        low: (K,) where the search begins.
        high: (K,) where it ends.
    """
    found = low.copy()
    before, behind = rate(rows, low), rate(rows, high)
    falls = before <= 0.0
    # it falls up to the end
    found[falls & (behind <= 0.0)] = high[falls & (behind <= 0.0)]
    (inner,) = np.nonzero(falls & (behind > 0.0) & (high - low > _CLOSE))
    rows, fell, at = rows[inner], np.zeros(len(inner), dtype=np.int64), inner
    low, high, before, behind = low[inner], high[inner], before[inner], behind[inner]
    for turn in range(_ROUNDS):
        if not len(rows):
            break
        part = before / (before - behind) if turn < _FALSE_POSITIONS else np.full(len(rows), 0.5)
        # where it is next to an end, the other one gets there at once
        aside = 0.4 * _CLOSE
        middle = np.clip(low + part * (high - low), low + aside, high - aside)
        now = rate(rows, middle)
        falls = now <= 0.0
        # an end that stays twice counts by half
        before = np.where(falls, now, np.where(fell < 0, 0.5 * before, before))
        behind = np.where(falls, np.where(fell > 0, 0.5 * behind, behind), now)
        low, high, fell = np.where(falls, middle, low), np.where(falls, high, middle), np.where(falls, 1, -1)
        found[at] = low
        left = high - low > _CLOSE
        rows, fell, at = rows[left], fell[left], at[left]
        low, high, before, behind = low[left], high[left], before[left], behind[left]
    return found


def _first_least(values: Array, begins: Rows) -> Rows:
    """The first of the least of each group, which begin at `begins` (K,)."""
    least = np.minimum.reduceat(values, begins)
    size = np.diff(np.append(begins, len(values)))
    hits = np.flatnonzero(values == np.repeat(least, size))
    found: Rows = hits[np.searchsorted(hits, begins)]
    return found


def _at(cubics: Cubics, rows: Rows, share: Array) -> tuple[Array, Array]:
    return cubics.take(rows).at(share * cubics.h[rows])
