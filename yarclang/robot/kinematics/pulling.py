"""The solutions of one pose nearest to a reference, for any arm with more joints than a pose needs.

Many joint positions go at once towards the pose and, through their null spaces, towards the reference: each step leads to the point of the linearised self-motion that is nearest
to the reference. A step along the self-motion is as long as the last two say that it bends (Barzilai and Borwein, IMA Journal of Numerical Analysis 8, 1988). A joint at its limit that
would go beyond stays there, and the others make up for it.
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
"""The most steps."""

TOWARDS, ALONG = 0.6, 0.4
"""The largest change of a joint in one step towards the pose, and along the self-motion [rad or m]."""

EXACT = 2e-10
"""The miss [m and rad together] at which a joint position has arrived ..."""

SETTLED = 1e-3
"""... if the motion along the self-motion that is still wanted is smaller than this [rad or m]."""

DAMPING = 1e-12
"""Of a step: far from the pose more, by `FAR` times the squared miss."""

FAR = 1e-2

HOLDS = 3
"""How many times joints are held at limits in one step."""

SHORTEST, LONGEST = 0.05, 2.0
"""A step along the self-motion, as a share of the way that would be right if it were straight."""

HOPE = 2.0
"""How much nearer a joint position may come yet, times what a parabola says."""

LESS = 1e-4
"""What isn't nearer by this isn't waited for [squared joint differences]."""

ALONE, FIRST = 0.7, 6
"""What the reference may miss the pose by to go alone first [m and rad together], and for how many steps."""

ROUGH = 1.0
"""How much nearer to the reference a solution may be than the seed from which it is found [joint difference]."""

CLOSE, TOGETHER, MANY = 2e-4, 0.02, 64
"""What misses by less [m and rad together] will arrive; what is nearer to each other than this in every joint [rad or m] will arrive together, looked for among so many."""

EARLY, KEPT = 4, 16
"""After so many steps, as many are kept of which the most is hoped, if only the nearest is wanted."""

LAST_SEEDS, LAST_STEPS, ENOUGH = 193, 30, 24
"""Seeds of the table, and as many others, that go to the pose only, in so many steps, if none of fewer arrives, until so many have come there."""

AFTER, AWAY = 12, 0.1
"""Of these, what misses by more after so many steps is given up [m and rad together]."""

TINY = 1e-12

NEAR, LAST = 1e-2, 3
"""What then misses by less [m and rad together] is led to the pose by so many steps at most."""

LOST: Array = np.array([math.inf] * 8 + [0.1] * 6 + [1e-3] * 40)
"""What misses by more after so many steps is given up [m and rad together]."""


def nearest_pulled(
    chain: Chain, limits: Limits, base_from_flange: Array, reference: Array, *, is_only: bool = False
) -> Array:
    """Return joint positions (m, n) [rad or m] at a pose within limits, the nearest to a reference that is found among them; clear of limits if any is found that is.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        reference: (n,) [rad or m], within limits.
        is_only: True if no others are wanted.
    """
    for lower, upper in (clear_of_limits(limits, reference), (limits.lower, limits.upper)):
        pull = Pull(chain, lower, upper, base_from_flange, reference)
        seeds = seeds_near(chain, limits, lower, upper, base_from_flange, reference)
        found = np.empty((0, chain.size))
        if is_only:
            # near the pose the reference itself arrives soon
            is_near = pull.misses(seeds[:1])[0] < ALONE
            first = pull.arriving(seeds[:1], is_only=True, steps=FIRST) if is_near else found
            bound = np.square(first - reference).sum(axis=1).min(initial=np.inf)
            hopeful = np.linalg.norm(seeds[1:] - reference, axis=1) - ROUGH < np.sqrt(bound)
            others = seeds[1:][hopeful] if len(first) else seeds
            found = np.vstack((first, pull.arriving(others, is_only=True, bound=bound)))
        if not len(found):
            found = pull.arriving(seeds)
        if len(found):
            return found
    # to the pose first, wherever that is
    pull = Pull(chain, limits.lower, limits.upper, base_from_flange, reference)
    seeds = seeds_near(chain, limits, limits.lower, limits.upper, base_from_flange, reference, LAST_SEEDS)
    even = spread(chain, limits.lower, limits.upper, reference, LAST_SEEDS)
    reached = pull.reaching(np.vstack((seeds, even)))
    found = pull.arriving(reached)
    return found if len(found) else reached


def pulled_to(chain: Chain, limits: Limits, base_from_flange: Array, seeds: Array, reference: Array) -> Array:
    """Return the joint positions (m, n) [rad or m] at a pose within limits at which seeds arrive, each nearer to the reference than those next to it.

    Args:
        chain: an arm with more than six joints.
        limits: its limits.
        base_from_flange: (4, 4).
        seeds: (k, n) [rad or m].
        reference: (n,) [rad or m].
    """
    return Pull(chain, limits.lower, limits.upper, base_from_flange, reference).arriving(seeds)


class Pull:
    """The target of joint positions (k, n) that are pulled.

    It is a pose (4, 4), or one for each of them (k, 4, 4), and a reference (n,) or (k, n), within the limits `lower` and `upper` (n,). Ways of joints count in units of `scale` (n,) [rad or m],
    all alike if None.
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
        """Return what joint positions (k, n) miss the pose by (k,) [m and rad together]."""
        error = self._seen(q)[1]
        result: Array = np.sqrt(np.einsum("kr,kr->k", error, error))
        return result

    def reaching(self, seeds: Array) -> Array:
        """Return joint positions (m, n) at the pose to which seeds (k, n) lead, wherever the reference is; no more than `ENOUGH` are waited for."""
        q, reached = np.clip(seeds, self.lower, self.upper), []
        for number in range(LAST_STEPS):
            go_on()
            jacobian, error = self._seen(q)
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
        """Return joint positions (k, n) after so many steps towards their poses and the reference, and what they miss the poses by (k,)."""
        q = np.clip(q, self.lower, self.upper)
        for number in range(steps + LAST + 1):
            go_on()
            jacobian, error = self._seen(q)
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
        """Return where seeds (k, n) arrive, (m, n).

        Args:
            seeds: [rad or m].
            is_only: True if only the nearest is wanted, and only if it is nearer than `bound`.
            bound: a squared joint difference.
            steps: how many there are at most.
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
            jacobian, error = self._seen(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            wanted = self.reference - q
            towards, along = self._steps(q, jacobian, error, miss, wanted)
            bent = np.einsum("kn,kn->k", moved_before, wanted_before - along)
            length = np.einsum("kn,kn->k", moved_before, moved_before)
            usable = (bent > TINY) & (length > TINY)
            share = np.where(usable, np.clip(length / np.where(usable, bent, 1.0), SHORTEST, LONGEST), share)
            size = np.abs(along).max(axis=1)
            settled = size < SETTLED
            there = (miss < EXACT) & settled
            away = np.einsum("kn,kn->k", wanted, wanted)
            if there.any():
                arrived.append(q[there])
                nearest = min(nearest, float(away[there].min()))
            # how near each may come yet
            hoped = away - HOPE * (share * np.einsum("kn,kn->k", along, along) + miss)
            going = ~there & (miss < LOST[number])
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
        """Return which joint positions (k, n) may still come to be the nearest, one of those that have come together."""
        close = miss < CLOSE
        if close.any():
            nearest = min(nearest, float((away + HOPE * miss)[close].min()))
        hopeful = hoped < nearest
        if len(q) <= MANY:
            apart = np.abs(q[:, None] - q[None]).max(axis=2)
            hopeful &= ~((apart < TOGETHER) & np.tri(len(q), k=-1, dtype=bool)).any(axis=1)
        return hopeful

    def _exact(self, q: Array) -> Array:
        """Return those of joint positions (k, n) near the pose that a few steps lead to it within limits."""
        for number in range(LAST + 1):
            jacobian, error = self._seen(q)
            miss = np.sqrt(np.einsum("kr,kr->k", error, error))
            if number == LAST or (miss < EXACT).all():
                break
            towards = self._steps(q, jacobian, error, miss, np.zeros_like(q))[0]
            q = np.clip(q + towards, self.lower, self.upper)
        kept: Array = q[miss < EXACT]
        return kept

    def _seen(self, q: Array) -> tuple[Array, Array]:
        """Return the Jacobians (k, 6, n) of joint positions (k, n), and the twists from them to the pose (k, 6)."""
        if len(q) == 1:
            pose, one = pose_with_jacobian(self.chain, q[0])
            return one[None], twist_between(pose, self.pose.reshape(4, 4))[None]
        columns, jacobian = walk_with_jacobian(self.chain, np.ascontiguousarray(q.T), np.eye(4))
        error = pose_error(columns, np.broadcast_to(self.target, columns.shape)).T
        return np.ascontiguousarray(jacobian.transpose(2, 0, 1)), error

    def _steps(
        self, q: Array, jacobian: Array, error: Array, miss: Array, wanted: Array
    ) -> tuple[Array, Array]:
        """Return `_least` of joint positions (k, n) with those joints held that are at a limit and would leave it, or that then would."""
        if self.scale is not None:
            towards, along = self._held(q, jacobian * self.scale, error, miss, wanted / self.scale)
            return towards * self.scale, along * self.scale
        return self._held(q, jacobian, error, miss, wanted)

    def _held(
        self, q: Array, jacobian: Array, error: Array, miss: Array, wanted: Array
    ) -> tuple[Array, Array]:
        """Return `_steps`, ways of joints in one unit."""
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
            towards[rows], along[rows] = _least(
                jacobian[rows] * held[:, None], error[rows], miss[rows], wanted[rows] * held
            )
        return towards, along


def _least(jacobian: Array, error: Array, miss: Array, wanted: Array) -> tuple[Array, Array]:
    """Return the least steps (k, n) that make up for errors (k, 6), and what wanted moves (k, n) leave in the null space."""
    across = jacobian.transpose(0, 2, 1)
    square = jacobian @ across
    square.reshape(len(square), -1)[:, ::7] += (DAMPING + FAR * np.minimum(miss * miss, 1.0))[:, None]
    right = np.empty((len(square), 6, 2))
    right[:, :, 0], right[:, :, 1] = error, (jacobian @ wanted[:, :, None])[:, :, 0]
    solved = across @ np.linalg.solve(square, right)
    return np.ascontiguousarray(solved[:, :, 0]), wanted - solved[:, :, 1]
