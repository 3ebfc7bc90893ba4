"""Find the solutions of one pose nearest to a reference, for any redundant arm.

Many joint positions move together towards the pose and, through their null spaces, towards the reference. The
null-space motion is called self-motion: it leaves the flange at rest. Each step moves to the point of the
linearised self-motion that is nearest to the reference. The length of a step along the self-motion follows
from the curvature that the last two steps show (Barzilai and Borwein, IMA Journal of Numerical Analysis 8,
1988). A joint that would exceed its limit stays there, and the other joints compensate.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from yarclang.progress import go_on
from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.kinematics.numeric import pose_columns, pose_error
from yarclang.robot.kinematics.postures import seeds_near, spread
from yarclang.robot.kinematics.single import pose_with_jacobian, twist_between
from yarclang.robot.kinematics.within import EDGE, clear_of_limits
from yarclang.robot.model import Array, Chain, Limits

STEPS = 30
"""The largest number of steps."""

TOWARDS, ALONG = 0.6, 0.4
"""The largest change of a joint in one step towards the pose, and along the self-motion [rad or m]."""

EXACT = 2e-10
"""The miss [m and rad together] below which a joint position has arrived, if it has also settled."""

SETTLED = 1e-3
"""A joint position has settled if it would move by less than this along the self-motion [rad or m]."""

DAMPING = 1e-12
"""Least damping of a step; `FAR` times the squared miss is added."""

FAR = 1e-2

HOLDS = 3
"""Largest number of times in one step that joints at limits are held and the step is computed again."""

SHORTEST, LONGEST = 0.05, 2.0
"""Bounds on the length of a step along the self-motion, relative to the step that would be right if the
self-motion were a straight line.
"""

HOPE = 2.0
"""Safety factor on the predicted decrease of the squared distance from the reference."""

LESS = 1e-4
"""The iteration ends if no joint position can gain more than this [squared joint differences]."""

ALONE, FIRST = 0.7, 6
"""Limits for a first trial that starts only from the reference: it is made if only the nearest solution is
needed, and if the reference misses the pose by less than `ALONE` [m and rad together]. It has `FIRST` steps.
"""

ROUGH = 1.0
"""Assumed upper bound on the distance that a seed gains towards the reference [joint difference]. Seeds that
would stay farther from the reference than the best solution even with this gain are left out.
"""

CLOSE, TOGETHER, MANY = 2e-4, 0.02, 64
"""A joint position that misses by less than `CLOSE` [m and rad together] is expected to arrive at the pose.
Two joint positions that differ by less than `TOGETHER` in every joint [rad or m] are expected to arrive at
the same place. Joint positions are compared only if there are at most `MANY` of them.
"""

EARLY, KEPT = 4, 16
"""If only the nearest solution is needed: after `EARLY` steps, only the `KEPT` most promising joint positions
are kept.
"""

LAST_SEEDS, LAST_STEPS, ENOUGH = 193, 30, 24
"""Limits of the last search. It follows if no joint position has arrived, and ignores the reference. It uses
`LAST_SEEDS` seeds from the table and equally many others, makes at most `LAST_STEPS` steps, and ends when
`ENOUGH` joint positions have reached the pose.
"""

AFTER, AWAY = 12, 0.1
"""In the last search, a joint position that misses by more than `AWAY` [m and rad together] after `AFTER`
steps is given up.
"""

TINY = 1e-12

NEAR, LAST = 1e-2, 3
"""At the end, joint positions that miss by less than `NEAR` [m and rad together] get at most `LAST` steps to
the pose.
"""

LOST: Array = np.array([math.inf] * 8 + [0.1] * 6 + [1e-3] * 40)
"""For each step, by its number: the miss above which a joint position is given up [m and rad together]."""


def nearest_pulled(
    chain: Chain, limits: Limits, base_from_flange: Array, reference: Array, *, is_only: bool = False
) -> Array:
    """Return joint positions (m, n) [rad or m] within limits that reach a pose, found from many seeds and
    moved towards a reference.

    Joint positions that keep a distance from the limits are preferred. Joint positions nearer to the limits
    are returned only if no others are found.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        reference: (n,) [rad or m], within limits.
        is_only: True if only the joint position nearest to the reference is needed.
    """
    for lower, upper in (clear_of_limits(limits, reference), (limits.lower, limits.upper)):
        pull = Pull(chain, lower, upper, base_from_flange, reference)
        seeds = seeds_near(chain, limits, lower, upper, base_from_flange, reference)
        solutions = np.empty((0, chain.size))
        if is_only:
            # if the reference is near the pose, a few steps from the reference alone are enough
            is_near = pull.misses(seeds[:1])[0] < ALONE
            first = pull.arriving(seeds[:1], is_only=True, steps=FIRST) if is_near else solutions
            bound = np.square(first - reference).sum(axis=1).min(initial=np.inf)
            hopeful = np.linalg.norm(seeds[1:] - reference, axis=1) - ROUGH < np.sqrt(bound)
            others = seeds[1:][hopeful] if len(first) else seeds
            solutions = np.vstack((first, pull.arriving(others, is_only=True, bound=bound)))
        if not len(solutions):
            solutions = pull.arriving(seeds)
        if len(solutions):
            return solutions
    # last attempt: reach the pose first, without regard to the reference
    pull = Pull(chain, limits.lower, limits.upper, base_from_flange, reference)
    seeds = seeds_near(chain, limits, limits.lower, limits.upper, base_from_flange, reference, LAST_SEEDS)
    even = spread(chain, limits.lower, limits.upper, reference, LAST_SEEDS)
    reached = pull.reaching(np.vstack((seeds, even)))
    solutions = pull.arriving(reached)
    return solutions if len(solutions) else reached


def pulled_to(chain: Chain, limits: Limits, base_from_flange: Array, seeds: Array, reference: Array) -> Array:
    """Return joint positions (m, n) [rad or m] within limits that reach a pose, each locally nearest to the
    reference.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        seeds: (k, n) [rad or m], where the search starts.
        reference: (n,) [rad or m].
    """
    return Pull(chain, limits.lower, limits.upper, base_from_flange, reference).arriving(seeds)


class Pull:
    """The target towards which joint positions (k, n) are moved: a pose and, as far as the pose allows, a
    reference.

    The pose is (4, 4) for all joint positions, or (k, 4, 4) with one for each. The reference is (n,) or (k,
    n), within the limits `lower` and `upper` (n,). Joint motions are counted in units of `scale` (n,) [rad or
    m]; None for equal units.
    """

    __slots__ = ("chain", "lower", "pose", "reference", "scale", "target", "upper")

    def __init__(
        self,
        chain: Chain,
        lower: Array,
        upper: Array,
        base_from_flange: Array,
        reference: Array,
        scale: Array | None = None,
    ) -> None:
        self.chain, self.lower, self.upper = chain, lower, upper
        self.pose, self.reference, self.scale = base_from_flange, reference, scale
        self.target = pose_columns(base_from_flange.reshape(-1, 4, 4))

    def misses(self, q: Array) -> Array:
        """Return the distances (k,) of joint positions (k, n) from the pose [m and rad together]."""
        error = self._jacobians(q)[1]
        result: Array = np.sqrt(np.einsum("kr,kr->k", error, error))
        return result

    def reaching(self, seeds: Array) -> Array:
        """Return joint positions (m, n) within limits that reach the pose, found from seeds (k, n) without
        regard to the reference. The search ends when `ENOUGH` are found.
        """
        q, reached = np.clip(seeds, self.lower, self.upper), []
        for number in range(LAST_STEPS):
            go_on()
            jacobian, error = self._jacobians(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            reached.append(q[miss < EXACT])
            going = (miss >= EXACT) & ((miss < AWAY) | (number < AFTER))
            if not going.any() or sum(map(len, reached)) >= ENOUGH:
                break
            q, jacobian, error, miss = q[going], jacobian[going], error[going], miss[going]
            towards = self._steps(q, jacobian, error, miss, np.zeros_like(q))[0]
            largest = np.abs(towards).max(axis=1)
            towards *= np.minimum(1.0, TOWARDS / np.maximum(largest, TINY))[:, None]
            q = np.clip(q + towards, self.lower, self.upper)
        return np.concatenate(reached)

    def put_back(self, q: Array, steps: int) -> tuple[Array, Array]:
        """Move joint positions (k, n) back to their poses and towards the reference in a number of steps.
        Return the new joint positions (k, n), and by how much they miss the poses (k,) [m and rad together].
        """
        q = np.clip(q, self.lower, self.upper)
        for number in range(steps + LAST + 1):
            go_on()
            jacobian, error = self._jacobians(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            is_there = bool((miss < EXACT).all())
            if number == steps + LAST or (is_there and number >= steps):
                break
            wanted = self.reference - q if number < steps else np.zeros_like(q)
            towards, along = self._steps(q, jacobian, error, miss, wanted)
            if is_there and np.abs(along).max() < SETTLED:
                break
            step = towards + along
            step *= np.minimum(1.0, ALONG / np.maximum(np.abs(step).max(axis=1), TINY))[:, None]
            q = np.clip(q + step, self.lower, self.upper)
        return q, miss

    def arriving(
        self, seeds: Array, *, is_only: bool = False, bound: float = np.inf, steps: int = STEPS
    ) -> Array:
        """Return the joint positions (m, n) that reach the pose when seeds are moved to the pose and towards
        the reference.

        Args:
            seeds: (k, n) [rad or m].
            is_only: True if only the joint position nearest to the reference is needed, and only if it is
                nearer than `bound`.
            bound: squared distance from the reference [squared joint differences].
            steps: the largest number of steps.
        """
        q = np.clip(seeds, self.lower, self.upper)
        share = np.ones(len(q))
        wanted_before, moved_before = np.zeros_like(q), np.zeros_like(q)
        arrived: list[Array] = []
        nearest = bound
        if not len(q):
            return q
        for number in range(steps + 1):
            go_on()
            jacobian, error = self._jacobians(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            to_reference = self.reference - q
            towards, along = self._steps(q, jacobian, error, miss, to_reference)
            # Barzilai and Borwein: the step length is |s|² / (s · y), where s is the last step and y is the
            # change of the remaining motion
            bent = np.einsum("kn,kn->k", moved_before, wanted_before - along)
            length = np.einsum("kn,kn->k", moved_before, moved_before)
            usable = (bent > TINY) & (length > TINY)
            share = np.where(usable, np.clip(length / np.where(usable, bent, 1.0), SHORTEST, LONGEST), share)
            size = np.abs(along).max(axis=1)
            settled = size < SETTLED
            arrived_now = (miss < EXACT) & settled
            away = np.einsum("kn,kn->k", to_reference, to_reference)
            if arrived_now.any():
                arrived.append(q[arrived_now])
                nearest = min(nearest, float(away[arrived_now].min()))
            # estimate how near to the reference each joint position can come: a lower bound on the squared
            # distance
            hoped = away - HOPE * (share * np.einsum("kn,kn->k", along, along) + miss)
            going = ~arrived_now & (miss < LOST[number])
            if number == steps or not (hoped[going] < nearest - LESS).any():
                break
            if is_only:
                going &= self._hopeful(q, away, hoped, miss, nearest)
                if number == EARLY and np.count_nonzero(going) > KEPT:
                    estimate = np.where(going, hoped + 2.0 * HOPE * miss, np.inf)
                    going &= estimate <= np.partition(estimate, KEPT - 1)[KEPT - 1]
            step = (
                along * (share * np.minimum(1.0, ALONG / np.maximum(size * share, TINY)) * ~settled)[:, None]
            )
            moved_before, wanted_before = step[going], along[going]
            largest = np.abs(towards).max(axis=1)
            towards *= np.minimum(1.0, TOWARDS / np.maximum(largest, TINY))[:, None]
            q = np.clip(q + towards + step, self.lower, self.upper)[going]
            share = share[going]
            if not len(q):
                break
        if not is_only and len(others := q[going & (miss < NEAR)]):
            arrived.append(self._exact(others))
        return np.concatenate(arrived) if arrived else np.empty((0, self.chain.size))

    def _hopeful(self, q: Array, away: Array, hoped: Array, miss: Array, nearest: float) -> NDArray[np.bool_]:
        """Return a mask (k,) of the joint positions (k, n) that can become the nearest to the reference. If
        several joint positions have come together, only the first one stays in the mask.
        """
        close = miss < CLOSE
        if close.any():
            nearest = min(nearest, float((away + HOPE * miss)[close].min()))
        hopeful = hoped < nearest
        if len(q) <= MANY:
            apart = np.abs(q[:, None] - q[None]).max(axis=2)
            hopeful &= ~((apart < TOGETHER) & np.tri(len(q), k=-1, dtype=bool)).any(axis=1)
        return hopeful

    def _exact(self, q: Array) -> Array:
        """Move joint positions (k, n) near the pose to the pose, within limits. Return the joint positions
        (m, n) that reach the pose in `LAST` steps.
        """
        for number in range(LAST + 1):
            jacobian, error = self._jacobians(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            if number == LAST or (miss < EXACT).all():
                break
            towards = self._steps(q, jacobian, error, miss, np.zeros_like(q))[0]
            q = np.clip(q + towards, self.lower, self.upper)
        kept: Array = q[miss < EXACT]
        return kept

    def _jacobians(self, q: Array) -> tuple[Array, Array]:
        """Return the Jacobians (k, 6, n) at joint positions (k, n), and the twists (k, 6) from the flange to
        the pose.
        """
        if len(q) == 1:
            pose, one = pose_with_jacobian(self.chain, q[0])
            return one[None], twist_between(pose, self.pose.reshape(4, 4))[None]
        columns, jacobian = walk_with_jacobian(self.chain, np.ascontiguousarray(q.T), np.eye(4))
        error = pose_error(columns, np.broadcast_to(self.target, columns.shape)).T
        return np.ascontiguousarray(jacobian.transpose(2, 0, 1)), error

    def _steps(
        self, q: Array, jacobian: Array, error: Array, miss: Array, to_reference: Array
    ) -> tuple[Array, Array]:
        """Compute joint steps towards the pose and along the self-motion. Joints that would exceed their
        limits are kept at rest.

        Args:
            q: (k, n) [rad or m].
            jacobian: (k, 6, n).
            error: twists to the pose (k, 6).
            miss: norms of the twists (k,).
            to_reference: moves towards the reference (k, n).

        Returns:
            Steps towards the pose (k, n), and along the self-motion (k, n).
        """
        if self.scale is not None:
            towards, along = self._scaled_steps(
                q, jacobian * self.scale, error, miss, to_reference / self.scale
            )
            return towards * self.scale, along * self.scale
        return self._scaled_steps(q, jacobian, error, miss, to_reference)

    def _scaled_steps(
        self, q: Array, jacobian: Array, error: Array, miss: Array, wanted: Array
    ) -> tuple[Array, Array]:
        """Compute `_steps` for `scale` None: the motions of all joints count equally."""
        towards, along = _least(jacobian, error, miss, wanted)
        low, high = q <= self.lower + EDGE, q >= self.upper - EDGE
        if not (low | high).any():
            return towards, along
        free = np.ones(q.shape, dtype=bool)
        for _ in range(HOLDS):
            step = towards + along
            leaving = free & ((low & (step < 0.0)) | (high & (step > 0.0)))
            rows = np.flatnonzero(leaving.any(axis=1))
            if not len(rows):
                break
            free[rows] &= ~leaving[rows]
            held = free[rows]
            # remove the columns of joints that are held at limits, so that the other joints make the whole
            # step
            towards[rows], along[rows] = _least(
                jacobian[rows] * held[:, None], error[rows], miss[rows], wanted[rows] * held
            )
        return towards, along


def _least(jacobian: Array, error: Array, miss: Array, towards: Array) -> tuple[Array, Array]:
    """Return the least joint steps that correct the pose errors, and the component of the wanted joint moves
    that lies in the null space.

    Args:
        jacobian: (k, 6, n).
        error: (k, 6).
        miss: norms of the errors (k,).
        towards: (k, n) the wanted moves.

    Returns:
        J⁺ `error` (k, n) and (I - J⁺ J) `towards` (k, n). J is the Jacobian, and J⁺ = Jᵀ (JJᵀ + d)⁻¹ its
            pseudoinverse with damping d.
    """
    across = jacobian.transpose(0, 2, 1)
    square = jacobian @ across
    # every seventh entry of a 6 by 6 matrix is on its diagonal
    square.reshape(len(square), -1)[:, ::7] += (DAMPING + FAR * np.minimum(miss * miss, 1.0))[:, None]
    right = np.empty((len(square), 6, 2))
    right[:, :, 0], right[:, :, 1] = error, (jacobian @ towards[:, :, None])[:, :, 0]
    solved = across @ np.linalg.solve(square, right)
    return np.ascontiguousarray(solved[:, :, 0]), towards - solved[:, :, 1]
