"""Find joint paths of lower cost that follow the same poses, for a redundant arm.

All samples of the joint path move at once, like an elastic band, each within the null space of its Jacobian.
Each step reduces the cost and is smoothed along the path. Iteration then brings the samples back onto the
poses (as in CHOMP: Zucker et al., IJRR 32(9-10), 2013). A joint therefore begins to move long before the
place on the path where its motion is needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from yarclang.progress import go_on
from yarclang.robot.kinematics.inverse import reached_within
from yarclang.robot.kinematics.numeric import fit
from yarclang.robot.kinematics.redundant import null_spaces, weights
from yarclang.robot.kinematics.track import Track, spline_bends
from yarclang.robot.kinematics.within import EDGE, beyond, clear_of_limits
from yarclang.robot.model import Array, Chain, Limits
from yarclang.transforms import sealed

FEWEST, MOST = 33, 257
"""The smallest and the largest number of samples of a path."""

MOVE = 0.05
"""Typical motion of a joint between two samples of the known joint path [rad or m]. It determines the number
of samples.
"""

FARTHEST = 0.15
"""Largest motion of a joint between two samples of a resulting path [rad or m]; `Track` allows 0.2."""

PROBE = 0.01
"""Step of the central differences for the gradient of the cost [units of `_Band.scale`]."""

LARGEST, SMALLEST = 0.15, 0.004
"""The largest and the smallest step of the descent [units of `_Band.scale`]."""

ROUNDS = 30
"""The largest number of steps of the descent from one start."""

NUDGE, NUDGES = 0.2, 4
"""The start of a later search is the known joint path after up to `NUDGES` displacements of the size `NUDGE`
[units of `_Band.scale`].
"""

MOST_ASKED = 8500
"""Approximate number of joint positions after which the search ends. Counted are joint positions that are put
onto the path's poses, and those whose cost is evaluated. With a cost that measures distances between bodies,
the search then takes about 0.2 s.
"""

STIFF = 0.01
"""Resistance of the band to bending, relative to its resistance to stretching [squares of the path's
length].
"""

Cost = Callable[[Array], Array]


def bent(
    chain: Chain, limits: Limits, pose_at: Callable[[Array], Array], followed: Track, cost: Cost
) -> Iterator[Track]:
    """Yield joint paths within limits that have the same flange poses and the same start as the known joint
    path, but cost less.

    The first search starts from the known joint path itself. Each later search starts from the known joint
    path displaced to one side. Each path is computed only when it is requested. For an arm with six joints or
    fewer, nothing is yielded.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        pose_at: function that returns the poses base_from_flange (N, 4, 4) at path parameters (N,), from 0 to
            1.
        followed: the known joint path.
        cost: function that returns the costs (N,) of joint positions (N, n). Costs are never negative; a cost
            of 0 can't be improved.
    """
    if chain.size <= 6:
        return
    way = np.abs(np.diff(followed.q, axis=0)).max(axis=1).sum()
    s = np.linspace(0.0, 1.0, int(np.clip(np.ceil(way / MOVE), FEWEST, MOST)))
    band = _Band(chain, limits, pose_at(s), followed, s, cost)
    if (reference := band.onto(followed.at(s))) is None:
        return
    least = float(band.cost(reference).sum())
    for number in range(1 + 2 * (chain.size - 6)):
        if band.asked > MOST_ASKED:
            return
        start = band.beside(reference, number) if number else reference
        found = None if start is None else band.relaxed(start)
        if found is not None and float(band.cost(found).sum()) < least:
            yield Track(sealed(s), sealed(found), sealed(spline_bends(s, found)))


class _Band:
    """A solver that moves the joint positions at all samples of a path together, like an elastic band.
    `scale` (n,) [rad or m] is the unit of each joint's motion: 1 rad for a turning joint without limits, less
    for a smaller range.
    """

    __slots__ = ("_cost", "asked", "chain", "high", "limits", "low", "poses", "scale", "smooth", "start")

    def __init__(
        self, chain: Chain, limits: Limits, poses: Array, followed: Track, s: Array, cost: Cost
    ) -> None:
        self.chain, self.limits, self.poses, self._cost = chain, limits, poses, cost
        self.asked = 0
        self.start = followed.q[0]
        self.scale = weights(chain, limits) / np.pi
        self.smooth = _smoothing(len(s))
        # keep clear of the limits, except where the known joint path comes nearer to them
        low, high = clear_of_limits(limits, self.start)
        self.low = np.maximum(np.minimum(low, followed.q.min(axis=0)), limits.lower)
        self.high = np.minimum(np.maximum(high, followed.q.max(axis=0)), limits.upper)

    def cost(self, q: Array) -> Array:
        """Return the costs (N,) of joint positions (N, n)."""
        self.asked += len(q)
        return self._cost(q)

    def onto(self, q: Array) -> Array | None:
        """Return the joint positions (M, n) near `q` (M, n) that reach the path's poses. The first one is the
        start of the known joint path.

        Return None if the joint positions miss a pose, jump between two samples, or exceed the limits.
        """
        self.asked += len(q)
        found = fit(self.chain, self.poses, q, lower=self.low, upper=self.high, rounds=15)
        placed = found.q
        placed[0] = self.start
        if found.total[1:].max() >= reached_within(self.chain):
            return None
        if (
            np.abs(np.diff(placed, axis=0)).max() > FARTHEST
            or np.abs(beyond(self.limits, placed)).max() > EDGE
        ):
            return None
        return placed

    def relaxed(self, q: Array) -> Array:
        """Return a joint path (M, n) of lower cost, found by gradient descent from the joint path `q` (M,
        n).
        """
        costs, step = self.cost(q), LARGEST
        for _ in range(ROUNDS):
            go_on()
            if costs[1:].max() <= 0.0 or self.asked > MOST_ASKED:
                break
            way = self._downhill(q, costs)
            size = float(np.abs(way).max())
            if size < 1e-12:
                break
            trial = self.onto(q + way * (step / size) * self.scale)
            tried = None if trial is None else self.cost(trial)
            if trial is None or tried is None or tried.sum() >= costs.sum():
                step *= 0.5
                if step < SMALLEST:
                    break
                continue
            q, costs, step = trial, tried, min(1.5 * step, LARGEST)
        return q

    def beside(self, q: Array, number: int) -> Array | None:
        """Return the joint path `q` (M, n), displaced by self-motion: joint motion that leaves the flange at
        rest. The displacement grows from zero over the first third of the path, and is constant after it.

        Args:
            q: the joint positions at the samples.
            number: number of the direction, from 1. An arm with n joints can be displaced in 2 (n - 6)
                directions.

        Returns:
            (M, n): the joint path after the last of up to `NUDGES` displacements that could be brought back
            onto the poses; None if the first one couldn't.
        """
        direction, sign = (number - 1) // 2, 1.0 if number % 2 else -1.0
        share = np.minimum(np.linspace(0.0, 3.0, len(q)), 1.0)[:, None]
        before: Array | None = None
        moved = None
        for _ in range(NUDGES):
            ways = null_spaces(self.chain, q, self.scale)
            way = ways[:, direction].copy()
            # null vectors have no sign: choose the sign that agrees with the previous sample and with the
            # previous displacement
            for place in range(1, len(way)):
                along = ways[place].T @ (ways[place] @ way[place - 1])
                way[place] = along / max(float(np.linalg.norm(along)), 1e-9)
            if before is not None and float((way * before).sum()) < 0.0:
                way = -way
            before = way
            nudged = self.onto(q + sign * NUDGE * share * way * self.scale)
            if nudged is None:
                break
            q = moved = nudged
        return moved

    def _downhill(self, q: Array, costs: Array) -> Array:
        """Return a displacement (M, n) of the joint path [units of `scale`] that reduces the costs (M,). The
        displacement is smoothed along the path, and leaves the flange at rest.
        """
        null = null_spaces(self.chain, q, self.scale)
        at = np.flatnonzero(costs > 0.0)
        # the gradient by central differences, along each null vector
        aside = PROBE * null[at] * self.scale
        sides = np.stack((q[at, None] + aside, q[at, None] - aside))
        over, under = self.cost(sides.reshape(-1, self.chain.size)).reshape(sides.shape[:3])
        way = np.zeros_like(q)
        way[at] = np.einsum("ak,akn->an", under - over, null[at])
        way[0] = 0.0
        way[1:] = self.smooth @ way[1:]
        # smoothed displacements are no longer in the null spaces: project them back
        smoothed: Array = np.einsum("akn,ak->an", null, np.einsum("akn,an->ak", null, way))
        return smoothed


def _smoothing(count: int) -> Array:
    """Return the matrix (count - 1, count - 1) that smooths displacements of all samples except the first.

    The matrix is the response of a stiff band whose start is fixed: the inverse of the stiffness against
    stretching (first differences) and bending (second differences).
    """
    width = 1.0 / (count - 1)
    slope = (np.eye(count - 1) - np.eye(count - 1, k=-1)) / width
    bend = np.diff(slope, axis=0) / width
    return np.asarray(np.linalg.inv((slope.T @ slope + STIFF * bend.T @ bend) * width), dtype=np.float64)
