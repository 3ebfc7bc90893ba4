"""Find the solutions of one pose nearest to a reference, for an arm with one spare joint: one joint more than
the pose needs.

The spare joint is sampled over its range; the closed form gives every branch at each sample. The distance of
each branch from the reference has local minima. Near each of them, more samples are taken: first between the
neighbouring samples, then around the vertex of the parabola through the three nearest samples.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.kinematics.single import pose_with_jacobian, twist_between
from yarclang.robot.kinematics.spare import BRANCHES, SpareForm, solutions_with
from yarclang.robot.kinematics.within import EDGE, clear_of_limits, nearest_turn
from yarclang.robot.model import Array, Chain, Limits

SAMPLES = 72
"""Number of samples of the spare joint over its range."""

KEPT = 6
"""Number of local minima that are refined, the nearest first."""

CLOSER = 21
"""Number of refined samples around each of these minima."""

VERTEX: Array = np.array([-0.02, 0.0, 0.02])
"""Further samples around the parabola's vertex: their distances from it, relative to the distance between a
minimum and its neighbouring samples.
"""

SLID = 1
"""Number of results, the best ones first, that are finally moved along the self-motion towards the reference.
"""

SLIDES, LARGEST, SETTLED = 6, 0.2, 1e-4
"""Limits of the motion of a result towards the reference: the largest number of steps, the largest step, and
the step below which the motion ends [rad or m].
"""

EXACT, LESS = 1e-9, 1e-9
"""`EXACT` [m or rad] is the largest miss of a joint position that counts as reaching the pose. `LESS`
[squared joint differences] is the least gain with which a joint position counts as nearer to the reference.
"""

STEPS = 3
"""Number of Newton steps from the reference towards the pose."""

NEARLY = 0.1
"""A sample that exceeds limits by less than this [rad or m] is refined like one within limits: a position
beside it may be within limits.
"""

DAMPED = 1e-6
"""Damping of the Newton steps."""

UNCLEAR, OUTSIDE = 1e6, 1e9
"""Extra cost of a joint position that isn't clear of limits, and of a joint position that exceeds them
[squared joint differences]. Each is larger than any distance that a position can have.
"""


def nearest_along(
    chain: Chain, limits: Limits, form: SpareForm, base_from_flange: Array, reference: Array
) -> Array:
    """Return joint positions (m, 7) within limits that reach a pose. Each one is locally nearest to the
    reference along its self-motion, the joint motion that leaves the flange at rest.

    If any of these joint positions are clear of the limits, only the clear ones are returned. A clear joint
    position keeps a distance from the limits; this distance is reduced as far as needed to make the reference
    clear, too. The result is empty if the samples show no solution within limits.

    Args:
        chain: the arm.
        limits: its limits.
        form: its closed form.
        base_from_flange: (4, 4).
        reference: (7,) [rad or m], within limits.
    """
    view = _Seen(chain, limits, form, base_from_flange, reference)
    low, high = _range(chain, limits, form.joint, reference[form.joint])
    first = (reference[form.joint], view.next_to_reference()[form.joint])
    values = np.sort(np.append(np.linspace(low, high, SAMPLES), np.clip(first, low, high)))
    q, costs, over = view.costs(*view.at(values))
    branch, place = _lowest(costs)
    # minima within limits or nearly within them come first
    away = np.square(q[branch, place] - reference).sum(axis=1)
    far = costs[branch, place] * (over[branch, place] > NEARLY)
    order = np.argsort(away + far, kind="stable")[:KEPT]
    if not len(order):
        return np.empty((0, chain.size))
    branch, place = branch[order], place[order]
    best, cost = q[branch, place], costs[branch, place]
    # take finer samples around each minimum, as far as its neighbouring samples
    gaps = np.diff(values, prepend=values[0], append=values[-1])
    centre, half = values[place], np.maximum(gaps[place], gaps[place + 1])
    rows = np.arange(len(centre))
    lowest = _vertex(np.broadcast_to(values, (len(rows), len(values))), costs[branch], place)
    steps = np.concatenate(
        (
            centre[:, None] + half[:, None] * np.linspace(-1.0, 1.0, CLOSER),
            lowest[:, None] + half[:, None] * VERTEX,
        ),
        axis=1,
    )
    steps = np.clip(np.sort(steps, axis=1), low, high)
    every, valid = view.at(steps.ravel())
    own = every.reshape(BRANCHES, *steps.shape, chain.size)[branch, rows]
    q, costs, _ = view.costs(own, valid.reshape(BRANCHES, *steps.shape)[branch, rows])
    nearest = np.argmin(costs, axis=1)
    better = costs[rows, nearest] < cost
    best[better], cost[better] = q[rows, nearest][better], costs[rows, nearest][better]
    inside = np.argsort(cost, kind="stable")[: int(np.count_nonzero(cost < OUTSIDE))]
    best, cost = best[inside], cost[inside]
    for one in range(min(SLID, len(best))):
        best[one], cost[one] = view.slid(best[one], cost[one])
    clear = cost < UNCLEAR
    return best[clear] if clear.any() else best


class _Seen:
    """Solver for the joint positions that reach one pose, and for their costs."""

    __slots__ = ("chain", "form", "high", "limits", "low", "pose", "reference")

    def __init__(
        self, chain: Chain, limits: Limits, form: SpareForm, base_from_flange: Array, reference: Array
    ) -> None:
        self.chain, self.limits, self.form = chain, limits, form
        self.pose, self.reference = base_from_flange, reference
        self.low, self.high = clear_of_limits(limits, reference)

    def at(self, values: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return all branches (B, N, 7) for positions of the spare joint (N,), and a mask (B, N) of the
        branches that reach the pose.
        """
        return solutions_with(self.form, self.pose, values, self.reference)

    def costs(self, q: Array, valid: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
        """Return joint positions (..., 7) shifted to the full turns nearest to the reference, their costs
        (...), and by how much they exceed limits (...).

        The cost is the squared difference from the reference. Positions that aren't clear of limits cost
        `UNCLEAR` more. Positions that exceed limits cost at least `OUTSIDE`, and positions that miss the pose
        cost infinity.
        """
        q = nearest_turn(self.chain, self.limits, q, self.reference)
        away = q - self.reference
        cost = np.einsum("...j,...j->...", away, away)
        over = np.maximum(self.limits.lower - q, q - self.limits.upper).max(axis=-1)
        unclear = np.maximum(self.low - q, q - self.high).max(axis=-1) > EDGE
        cost[unclear] += UNCLEAR
        cost = np.where(over > EDGE, OUTSIDE * (1.0 + over), cost)
        cost[~valid] = math.inf
        return q, cost, over

    def slid(self, q: Array, cost: float) -> tuple[Array, float]:
        """Move a joint position (7,) along its self-motion to the position nearest to the reference, within
        limits.

        The steps are those of the secant method, each followed by one Newton step back to the pose.

        Args:
            q: the joint position.
            cost: its cost, as returned by `costs`.

        Returns:
            The joint position reached and its cost, or `q` and `cost` if no nearer position is found.
        """
        place = q
        low, high = (self.low, self.high) if cost < UNCLEAR else (self.limits.lower, self.limits.upper)
        step, before, bend = 0.0, 0.0, 1.0
        way = np.zeros(len(q))
        for number in range(SLIDES):
            pose, jacobian = pose_with_jacobian(self.chain, place)
            error = twist_between(pose, self.pose)
            left_vectors, size, right = np.linalg.svd(jacobian)
            away = place - self.reference
            if number and np.abs(error).max() < EXACT and away @ away < cost % UNCLEAR - LESS:
                outside = np.maximum(low - place, place - high).max()
                if outside <= EDGE:
                    q, cost = place, float(away @ away) + (UNCLEAR if cost >= UNCLEAR else 0.0)
            # the last right singular vector spans the null space: keep its sense from step to step
            way = right[6] if right[6] @ way >= 0.0 else -right[6]
            # half of the derivative of the cost along the self-motion, and its change per step (the secant)
            slope = float(way @ away)
            if step != 0.0:
                bend = min(max((slope - before) / step, 0.2), 20.0)
            before = slope
            sign = way if slope < 0.0 else -way
            # stop where the first joint comes to its limit
            room = np.where(sign > 0.0, high - place, place - low) / np.maximum(np.abs(sign), 1e-9)
            step = -math.copysign(max(min(abs(slope) / bend, LARGEST, float(room.min())), 0.0), slope)
            if abs(step) < SETTLED and (number == 0 or np.abs(error).max() < EXACT):
                break
            # Newton step to the pose by the pseudoinverse: V S⁻¹ Uᵀ e
            back = right[:6].T @ ((left_vectors.T @ error) / np.maximum(size, DAMPED))
            place = place + back + way * step
        return q, cost

    def next_to_reference(self) -> Array:
        """Return the joint position (7,) after a few Newton steps from the reference towards the pose."""
        q = self.reference
        for _ in range(STEPS):
            pose, one = pose_with_jacobian(self.chain, q)
            q = q + one.T @ np.linalg.solve(one @ one.T + DAMPED * np.eye(6), twist_between(pose, self.pose))
        return q


def _vertex(places: Array, costs: Array, lowest: NDArray[np.int_]) -> Array:
    """Return the vertices (K,) of parabolas through the lowest cost of each row and its two neighbours.

    Args:
        places: (K, P) positions of the spare joint, sorted.
        costs: (K, P) the costs at these positions.
        lowest: (K,) index of each row's lowest cost.

    Returns:
        The position of each vertex that is between the two neighbours; otherwise the position of the lowest
        cost.
    """
    rows = np.arange(len(places))
    inner = np.clip(lowest, 1, places.shape[1] - 2)
    (low, middle, right), (before, centre, after) = (
        [one[rows, inner + step] for step in (-1, 0, 1)] for one in (places, costs)
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        # successive parabolic interpolation (Brent, Algorithms for Minimization without Derivatives, ch. 5)
        down, up = (middle - low) * (centre - after), (middle - right) * (centre - before)
        at = middle - 0.5 * ((middle - low) * down - (middle - right) * up) / (down - up)
    result: Array = np.where((at > low) & (at < right), at, places[rows, lowest])
    return result


def _range(chain: Chain, limits: Limits, joint: int, near: float) -> tuple[float, float]:
    """Return the interval in which the spare joint is sampled [rad or m].

    The interval is the joint's range; for a turning joint, at most one full turn about `near`.
    """
    low, high = float(limits.lower[joint]), float(limits.upper[joint])
    half = math.pi
    if chain.is_prismatic[joint]:
        from yarclang.robot.kinematics.inverse import extent

        half = extent(chain)
        if math.isfinite(low) and math.isfinite(high):
            return low, high
    elif high - low <= 2.0 * math.pi:
        return low, high
    low = min(max(near - half, low), high - 2.0 * half)
    return low, low + 2.0 * half


def _lowest(costs: Array) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the local minima of costs (B, N): the branch of each minimum, and the index of its sample of the
    spare joint.
    """
    padded = np.pad(costs, ((0, 0), (1, 1)), constant_values=math.inf)
    low = np.isfinite(costs) & (costs <= padded[:, :-2]) & (costs < padded[:, 2:])
    # if several consecutive costs are equal, the last one counts as the minimum
    branch, place = np.nonzero(low)
    return branch, place
