"""Following a path with an arm that has no closed form, in leaps of several samples at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.kinematics.fk import walk_with_jacobian
from yarclang.robot.kinematics.inverse import reached_within
from yarclang.robot.kinematics.numeric import damped_step, fit, pose_columns, pose_error
from yarclang.robot.kinematics.strands import FINEST, NEAR, End, Strand
from yarclang.robot.model import Array, Chain

LEAP = 8
"""Samples of one leap: all are predicted from its start and solved together."""

LEAPS = 4000
"""The most leaps of a path of few bends."""

_OVER = 4
"""Bends between two samples of a leap at most."""

DRIFT = 0.12
"""How far a solution may be from its prediction [rad or m]; more may be another branch."""

BEND = 0.04
"""How much two moves from sample to sample may differ [rad or m]; more, and what looks like one curve may
be two branches that come near each other."""

DAMPING = 1e-7
"""Of the prediction: at a singularity a joint that doesn't help stays where it is."""


def march(chain: Chain, pose_at: Callable[[Array], Array], q_start: Array, bends: int = 0) -> Strand:
    """The strand that starts at `q_start` (n,), which stands at pose_at(0).

    Each leap predicts its samples along the arm's least joint velocities, improves them by damped least
    squares, and keeps those up to the first that is too far from its prediction or from the one
    before. A leap that keeps none is tried again shorter.

    Args:
        chain: the arm, n joints.
        pose_at: base_from_flange (N, 4, 4) at places (N,).
        q_start: (n,) [rad or m].
        bends: about how many bends the path may have; a leap passes a few of them at most.
    """
    places, joints = [np.zeros(1)], [q_start[None]]
    here, q, longest = 0.0, q_start, min(1.0, LEAP * _OVER / max(bends, 1))
    length = min(0.5, longest)
    end: End = "whole"
    beyond = q_start
    for _ in range(max(LEAPS, bends)):
        if here >= 1.0:
            break
        length = min(length, longest, 1.0 - here)
        s = here + length * np.arange(1, LEAP + 1) / LEAP
        if length == 1.0 - here:
            s[-1] = 1.0
        solution, drift, reached = _leap(chain, pose_at, here, q, s)
        moves = np.diff(solution, axis=0, prepend=q[None])
        bend = np.append(drift[:1], np.abs(np.diff(moves, axis=0)).max(axis=1))
        good = reached & (drift < DRIFT) & (np.abs(moves).max(axis=1) < NEAR) & (bend < BEND)
        kept = LEAP if good.all() else int(np.argmin(good))
        if kept:
            places.append(s[:kept])
            joints.append(solution[:kept])
            here, q = float(s[kept - 1]), solution[kept - 1]
            length *= 2.0 if kept == LEAP else 1.5 * kept / LEAP
            continue
        if length <= FINEST * LEAP:
            end, beyond = ("jump", solution[0]) if reached[0] else ("nothing", q)
            break
        length = max(length / LEAP, 0.5 * FINEST * LEAP)
    else:
        end = "nothing"  # it only creeps on
    return Strand(np.concatenate(places), np.concatenate(joints), end, beyond)


def _leap(
    chain: Chain, pose_at: Callable[[Array], Array], here: float, q: Array, s: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Solutions (K, n) at places `s` (K,), how far each is from its prediction (K,), and which are
    solutions.
    """
    poses = pose_at(np.concatenate([[here], s]))
    columns = pose_columns(poses)
    start, target = np.repeat(columns[:, :, :1], len(s), axis=2), columns[:, :, 1:]
    twist = pose_error(start, target)
    jacobian = walk_with_jacobian(chain, q[:, None], np.eye(4))[1]
    step = damped_step(
        np.ascontiguousarray(np.broadcast_to(jacobian, (6, chain.size, len(s)))),
        twist,
        np.full(len(s), DAMPING),
    )
    guess = q + step.T
    found = fit(chain, poses[1:], guess, rounds=25)
    return found.q, np.abs(found.q - guess).max(axis=1), found.total < reached_within(chain)
