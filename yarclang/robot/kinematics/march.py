"""Follow a path with an arm that has no closed form. The path is followed in leaps: several consecutive
samples are solved at once.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence

import numpy as np

from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.kinematics.inverse import reached_within
from yarclang.robot.kinematics.numeric import Fit, damped_step, fit, pose_columns, pose_error
from yarclang.robot.kinematics.redundant import weights
from yarclang.robot.kinematics.strands import FINEST, NEAR, End, Strand
from yarclang.robot.model import Array, Chain, Limits

LEAP = 8
"""Number of samples of one leap. All samples are predicted from the start of the leap and solved together."""

ROUNDS = 25
"""The largest number of steps of damped least squares for a leap."""

LEAPS = 4000
"""The largest number of leaps along a path. A path with more bends than this may take one leap for each bend.
"""

_OVER = 4
"""The largest number of bends of the path between two samples of a leap."""

DRIFT = 0.12
"""Largest distance of a solution from its prediction [rad or m]. A solution farther away may be on another
branch.
"""

BEND = 0.04
"""Largest change of the joint motion from one sample to the next [rad or m]. A larger change suggests that
the samples belong to two branches that come near each other.
"""

AWAY = 1.5
"""Speed at which a joint at its limit is moved towards the middle of its range, relative to the speed of the
fastest joint along the path.
"""

STEEP = 5
"""Exponent with which a joint's speed towards the middle of its range grows with its distance from the
middle.
"""

DAMPING = 1e-7
"""Damping of the prediction. At a singularity, damping keeps those joints at rest that can't contribute to
the motion.
"""


def march(
    chain: Chain,
    pose_at: Callable[[Array], Array],
    q_start: Array,
    bends: int = 0,
    limits: Limits | None = None,
) -> Strand:
    """Follow one path from `q_start` (n,), which reaches pose_at(0).

    Each leap predicts the joint positions of its samples along the least joint velocities, and improves them
    by damped least squares. Of its samples, the leap keeps those before the first one that is too far from
    its prediction or from the previous sample. A leap that keeps no sample is repeated with a shorter length.

    Args:
        chain: the arm, n joints.
        pose_at: function that returns the poses base_from_flange (N, 4, 4) at path parameters (N,), from 0 to
            1.
        q_start: (n,) [rad or m].
        bends: approximate number of bends of the path; a leap passes only a few of them.
        limits: limits that a redundant arm keeps clear of, by motions that leave the flange at rest; None for
            the least motion of the joints.

    Returns:
        The strand (the sequence of joint positions), up to the path's end or to the sample after which it
        can't be continued.
    """
    steps = _steps(chain, pose_at, q_start, bends, limits)
    try:
        asked = next(steps)
        while True:
            asked = steps.send(fit(chain, *asked, rounds=ROUNDS))
    except StopIteration as ended:
        strand: Strand = ended.value
        return strand


def marches(
    chain: Chain, paths: Sequence[Callable[[Array], Array]], starts: Array, limits: Limits | None = None
) -> list[Strand]:
    """Follow several paths as `march` does, in a fraction of the time: their leaps are solved together.

    Args:
        chain: the arm, n joints.
        paths: for each path, a function that returns the poses base_from_flange (N, 4, 4) at path parameters
            (N,), from 0 to 1.
        starts: (K, n) [rad or m], where the paths begin.
        limits: as for `march`.

    Returns:
        One strand (sequence of joint positions) for each path.
    """
    strands: dict[int, Strand] = {}
    under_way = {at: _steps(chain, path, starts[at], 0, limits) for at, path in enumerate(paths)}
    active = {at: next(steps) for at, steps in under_way.items()}
    while active:
        poses, guesses = (np.concatenate([ask[part] for ask in active.values()]) for part in (0, 1))
        found = fit(chain, poses, guesses, rounds=ROUNDS)
        again: dict[int, tuple[Array, Array]] = {}
        for row, at in enumerate(active):
            part = slice(row * LEAP, (row + 1) * LEAP)
            own = Fit(found.q[part], found.miss_position[part], found.miss_angle[part])
            try:
                again[at] = under_way[at].send(own)
            except StopIteration as ended:
                strands[at] = ended.value
        active = again
    return [strands[at] for at in range(len(paths))]


def _steps(
    chain: Chain, pose_at: Callable[[Array], Array], q_start: Array, bends: int, limits: Limits | None
) -> Generator[tuple[Array, Array], Fit, Strand]:
    """Run `march` as a generator. For each leap, it yields the poses (LEAP, 4, 4) and the predicted joint
    positions (LEAP, n), and is sent the solutions. At the end it returns the strand (the sequence of joint
    positions).
    """
    places, joints = [np.zeros(1)], [q_start[None]]
    done_to, q, longest = 0.0, q_start, min(1.0, LEAP * _OVER / max(bends, 1))
    length = min(0.5, longest)
    end: End = "whole"
    beyond = q_start
    for _ in range(max(LEAPS, bends)):
        if done_to >= 1.0:
            break
        length = min(length, longest, 1.0 - done_to)
        s = done_to + length * np.arange(1, LEAP + 1) / LEAP
        if length == 1.0 - done_to:
            s[-1] = 1.0
        poses, guess = _leap(chain, pose_at, done_to, q, s, limits)
        found = yield poses, guess
        solution, drift = found.q, np.abs(found.q - guess).max(axis=1)
        reached = found.total < reached_within(chain)
        moves = np.diff(solution, axis=0, prepend=q[None])
        # Second differences of the joint positions along the leap.
        bend = np.append(drift[:1], np.abs(np.diff(moves, axis=0)).max(axis=1))
        good = reached & (drift < DRIFT) & (np.abs(moves).max(axis=1) < NEAR) & (bend < BEND)
        followed = LEAP if good.all() else int(np.argmin(good))
        if followed:
            places.append(s[:followed])
            joints.append(solution[:followed])
            done_to, q = float(s[followed - 1]), solution[followed - 1]
            # Double the leap if all its samples succeeded. Otherwise try half as much again as the part that
            # succeeded.
            length *= 2.0 if followed == LEAP else 1.5 * followed / LEAP
            continue
        if length <= FINEST * LEAP:
            end, beyond = ("jump", solution[0]) if reached[0] else ("nothing", q)
            break
        length = max(length / LEAP, 0.5 * FINEST * LEAP)
    else:
        end = "nothing"  # the leaps become ever shorter, without reaching the end
    return Strand(np.concatenate(places), np.concatenate(joints), end, beyond)


def _leap(
    chain: Chain, pose_at: Callable[[Array], Array], place: float, q: Array, s: Array, limits: Limits | None
) -> tuple[Array, Array]:
    """Return the poses (K, 4, 4) of a path at the path parameters `s` (K,), and the joint positions (K, n)
    that are predicted for them from the joint position `q`.
    """
    poses = pose_at(np.concatenate([[place], s]))
    columns = pose_columns(poses)
    start, target = np.repeat(columns[:, :, :1], len(s), axis=2), columns[:, :, 1:]
    twist = pose_error(start, target)
    jacobian = walk_with_jacobian(chain, q[:, None], np.eye(4))[1]
    if limits is None:
        step = damped_step(
            np.ascontiguousarray(np.broadcast_to(jacobian, (6, chain.size, len(s)))),
            twist,
            np.full(len(s), DAMPING),
        )
    else:
        step = _clear_step(chain, limits, jacobian[:, :, 0], twist, q)
    return poses[1:], q + step.T


def _clear_step(chain: Chain, limits: Limits, jacobian: Array, twist: Array, q: Array) -> Array:
    """Return the least joint steps (n, K) that make the flange twists (6, K), plus null-space motion away
    from the limits.

    The motion of each joint is measured relative to the joint's range.

    Args:
        chain: the arm, n joints.
        limits: the limits to keep clear of.
        jacobian: (6, n) at `q`.
        twist: (6, K) [m above rad].
        q: (n,) [rad or m].
    """
    # J⁺ = Jᵀ (JJᵀ + d)⁻¹, with each joint in units of its range
    scale = weights(chain, limits)
    scaled = jacobian * scale
    inverse = scaled.T @ np.linalg.inv(scaled @ scaled.T + DAMPING * np.eye(len(scaled)))
    step: Array = inverse @ twist
    bounded = np.isfinite(limits.lower) & np.isfinite(limits.upper)
    lower, upper = (np.where(bounded, one, q) for one in (limits.lower, limits.upper))
    middle = 0.5 * (lower + upper)
    # clip: beyond a limit, the motion back is as fast as at the limit
    place = np.clip((q - middle) / scale, -1.0, 1.0)
    back = -(np.sign(place) * np.abs(place) ** STEEP)
    # project onto the null space: (I - J⁺ J) back
    back -= inverse @ (scaled @ back)
    # scale the motion back by the largest joint motion along the path
    step += AWAY * np.abs(step).max(axis=0) * back[:, None]
    return step * scale[:, None]
