"""Follow the branches of the closed form along a path.

All branches of all samples are computed at once, and the strand (the sequence of joint positions) stays on
its branch from sample to sample. If staying on the branch would need a large move between two samples, more
samples are added, down to a billionth of the path. If another branch then continues smoothly, the path passes
exactly through a singularity, and the strand changes to that branch. If no branch does, a joint would have to
jump.

Inside a singularity the pose leaves one angle free. This angle keeps its value (it is held). Within a few
1e-10 rad of the singularity, the closed form changes gradually from the held angle to the angle that the pose
determines. If a short path has samples this near to the singularity, the angle seems to turn gradually. The
path doesn't require this turn: if the angle turns by much, the joint would have to jump.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.closed_form import closed_form, free_joints, next_to, one_branch
from yarclang.robot.kinematics.geometry import Form
from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Array

NEAR = 0.2
"""The largest move of a joint from sample to sample [rad or m]."""

FINEST = 1e-9
"""Length of the shortest interval of a path that is examined, relative to the path."""

BEND = 0.02
"""Largest distance of a sample from the chord of its neighbours [rad]."""

SHORT = 1e-5
"""Length of an interval, relative to the path, below which a bend is no reason to divide the interval."""

SECTIONS = 16
"""Largest number of intervals into which an interval with a possible jump is divided."""

ROUNDS = 40
"""The largest number of times that samples are added to a path."""

End = Literal["whole", "jump", "nothing"]


@frozen(eq=False)
class Strand:
    """Joint positions along a path, up to the last one that is reached without a jump of a joint.

    Attributes:
        s: (M,) path parameters from 0 to 1.
        q: (M, n) joint positions at these path parameters [rad or m].
        end: reason why the strand ends: "whole" at the end of the path, "jump" if a joint would have to jump
            to `beyond`, and "nothing" if no solution follows.
        beyond: (n,) for "jump", the nearest of the solutions that follow [rad or m].
    """

    s: Array
    q: Array
    end: End
    beyond: Array


@dataclass(slots=True, eq=False)
class _Samples:
    """All branches (solutions) at all path parameters for which they were computed so far.

    The first index of each array counts the path parameters: `q` (M, 8, 6), `valid` and `singular` (M, 8),
    `free` (M, 8, 2).
    """

    s: Array
    poses: Array
    q: Array
    valid: NDArray[np.bool_]
    singular: NDArray[np.bool_]
    free: NDArray[np.bool_]


@frozen(eq=False)
class _Held:
    """A singularity that the joint motion along a path has entered. Inside it, the angle that the pose leaves
    free keeps its value (it is held).

    Attributes:
        before: index of the last sample before the singularity.
        q: (6,) joint positions at this sample [rad].
        joints: numbers of the joints that the singularity frees.
    """

    before: int
    q: Array
    joints: list[int]

    def turned(self, q: Array) -> Array:
        """Return how far the joints that the singularity frees are from their values in `self.q`, as the
        largest difference (K,) [rad] at each of the joint positions `q` (K, 6).
        """
        away: Array = np.abs(q[:, self.joints] - self.q[self.joints]).max(axis=1)
        return away


def follow_branches(arm: Form, pose_at: Callable[[Array], Array], s: Array, q_start: Array) -> Strand:
    """Follow a path with an arm that has a closed form, from `q_start` (6,) [rad], which reaches
    pose_at(s[0]).

    Args:
        arm: the closed form.
        pose_at: function that returns the poses base_from_flange (N, 4, 4) at path parameters (N,).
        s: (M,) the path parameters that are sampled first, from 0 to 1.
        q_start: (6,) [rad].

    Returns:
        The strand (the sequence of joint positions), up to the path's end or to the sample after which it
        can't be continued.
    """
    samples = _sampled(arm, pose_at(s), s, q_start)
    for _ in range(ROUNDS):
        strand, cuts = _walk(arm, samples, q_start)
        if not len(cuts) and strand.end == "whole":
            cuts = _bends(strand)
        if not len(cuts):
            break
        extra = _sampled(arm, pose_at(cuts), cuts, q_start)
        samples = _merged(samples, extra)
    return strand


def plain_strands(
    arm: Form, poses: Array, s: Array, starts: Array, branch: int
) -> tuple[Array, NDArray[np.bool_]]:
    """Follow many paths at once, each along the same branch (configuration) of the closed form. Paths that
    need more samples or a change of branch are marked.

    Args:
        arm: the closed form.
        poses: base_from_flange (m * M, 4, 4) of m paths, at the same path parameters of each.
        s: (M,) the path parameters, from 0 to 1; M at least 3.
        starts: (m, 6) [rad], where each path begins.
        branch: the branch on which all paths begin.

    Returns:
        Joint positions (m, M, 6), and a mask (m,) of the paths that stay on the branch without more samples.
        For these paths, `follow_branches` returns the same joint positions, up to the path's end.
    """
    q = np.empty((len(starts), len(s), 6))
    beyond = poses.reshape(*q.shape[:2], 4, 4)[:, 1:]
    branches = closed_form(arm, beyond[:, 0], starts[0][:, None])
    own, valid, singular = one_branch(arm, beyond.reshape(-1, 4, 4), branch)
    # At a singularity one angle is free. It would have to keep the value that it has at the start of each
    # path, which this function can't do.
    if branches.singular.any() or singular.any():
        return q, np.zeros(len(starts), dtype=bool)
    own_moves = own.T.reshape(len(starts), -1, 6)
    moves = own_moves[:, 1:] - own_moves[:, :-1]
    moves -= TURN * np.round(moves / TURN)
    q[:, 0] = starts
    q[:, 1], away = next_to(own_moves[:, 0], starts)
    q[:, 2:] = next_to(own_moves[:, 1:], q[:, 1:2] + np.cumsum(moves, axis=1))[0]
    is_plain = valid.reshape(own_moves.shape[:2]).all(axis=1)
    is_plain &= (np.abs(away) <= NEAR).all(axis=1) & (np.abs(moves) <= NEAR).all(axis=(1, 2))
    # `follow_branches` takes the branch that is nearest at the first sample after the start: this must be
    # `branch`
    size = np.abs(next_to(branches.q.transpose(2, 1, 0), starts[:, None])[1]).max(axis=2)
    size[~branches.valid.T] = np.inf
    is_plain &= np.argmin(size, axis=1) == branch
    share = ((s[1:-1] - s[:-2]) / (s[2:] - s[:-2]))[:, None]
    bent = np.abs(q[:, 1:-1] - q[:, :-2] - share * (q[:, 2:] - q[:, :-2])) > BEND
    return q, is_plain & ~bent.any(axis=(1, 2))


def _walk(arm: Form, samples: _Samples, q_start: Array) -> tuple[Strand, Array]:
    """Follow the samples of a path from `q_start` (6,) until a joint would have to jump, or to the end.

    Args:
        arm: the closed form.
        samples: all branches at the path parameters so far.
        q_start: (6,) [rad].

    Returns:
        The strand (the sequence of joint positions), and the path parameters (K,) at which more samples are
        needed.
    """
    s, count = samples.s, len(samples.s)
    q = np.empty((count, 6))
    q[0] = q_start
    cuts: list[Array] = []
    # the move of each branch from each sample to the next; infinite if it misses the pose or touches a
    # singularity
    moves = samples.q[1:] - samples.q[:-1]
    moves -= TURN * np.round(moves / TURN)
    farthest = np.abs(moves).max(axis=2)
    farthest[~samples.valid[1:] | samples.singular[1:] | samples.singular[:-1]] = np.inf
    at, branch = 0, -1
    held: _Held | None = None
    end: End = "whole"
    beyond = q_start
    while at < count - 1:
        if branch >= 0:
            # continue along the branch as far as it is smooth
            rough = farthest[at:, branch] > NEAR
            run = int(np.argmax(rough)) if rough.any() else len(rough)
            if run:
                target = q[at] + np.cumsum(moves[at : at + run, branch], axis=0)
                q[at + 1 : at + run + 1] = next_to(samples.q[at + 1 : at + run + 1, branch], target)[0]
                at += run
                continue
        # choose among all branches at the next sample
        width = s[at + 1] - s[at]
        choice, target, straight = _choose(arm, samples, at + 1, q[at])
        if choice < 0:
            if width > FINEST:
                cuts.append(_sections(s[at], s[at + 1], min(SECTIONS, int(np.ceil(width / FINEST)))))
            end = "nothing"
            break
        move = float(np.abs(target - q[at]).max())
        # refine while the move is large or the branch changes, until the interval is too short
        changes = branch >= 0 and choice != branch and not straight
        if (move > NEAR or changes) and width > FINEST:
            pieces = min(SECTIONS, int(np.ceil(width / FINEST)))
            if branch >= 0 and choice == branch and move < 1.0:
                pieces = min(max(int(np.ceil(move / (0.6 * NEAR))), 2), SECTIONS)
            cuts.append(_sections(s[at], s[at + 1], pieces))
        elif move > NEAR:
            end, beyond = "jump", target
            break
        if straight and held is None:
            freed = np.flatnonzero(samples.free[at + 1, choice]).tolist()
            held = _Held(at, q[at].copy(), [free_joints(arm)[one] for one in freed])
        at += 1
        q[at] = target
        branch = -1 if straight else choice
        first = at
        if straight:
            run = int(np.argmin(np.append(samples.singular[at:, choice] & samples.valid[at:, choice], False)))
            along = _held_run(arm, samples, at, at + run, choice, target)
            q[at : at + len(along)] = along
            at += len(along) - 1
        # a freed joint that turns by much, inside a singularity or on leaving it, would have to jump
        if held is not None:
            turned = held.turned(q[first : at + 1]) > NEAR
            if turned.any():
                end, beyond = "jump", q[first + int(np.argmax(turned))]
                at = held.before
                break
            held = held if straight else None
    reached = at + 1
    return Strand(s[:reached], q[:reached], end, beyond), (np.concatenate(cuts) if cuts else np.empty(0))


def _held_run(arm: Form, samples: _Samples, first: int, last: int, branch: int, q: Array) -> Array:
    """Return joint positions (K, 6) of consecutive samples inside a singularity. The angle that the poses
    leave free keeps its value (it is held).

    Args:
        arm: the closed form.
        samples: all branches at the path parameters so far.
        first: the first singular sample.
        last: the sample after the last singular one.
        branch: the branch to follow.
        q: (6,) [rad] at sample `first`; its free angle is held.

    Returns:
        The joint positions from sample `first` on. They end before the first move of a joint that is too
        large.
    """
    held = closed_form(arm, samples.poses[first:last], q[:, None]).q[:, branch].T
    moves = np.diff(held, axis=0)
    moves -= TURN * np.round(moves / TURN)
    rough = np.abs(moves).max(axis=1, initial=0.0) > NEAR
    run = int(np.argmax(rough)) if rough.any() else len(moves)
    return np.vstack([q, q + np.cumsum(moves[:run], axis=0)])


def _bends(strand: Strand) -> Array:
    """Return path parameters (K,) at which more samples are needed: halfway to both neighbours of each sample
    that lies off the chord of these neighbours.

    Without these samples, a short interval between two samples, such as one in which the path is out of
    reach, would be missed.
    """
    s, q = strand.s, strand.q
    if len(s) < 3:
        return np.empty(0)
    share = ((s[1:-1] - s[:-2]) / (s[2:] - s[:-2]))[:, None]
    away = np.abs(q[1:-1] - q[:-2] - share * (q[2:] - q[:-2])).max(axis=1) > BEND
    near = np.zeros(len(s) - 1, dtype=bool)
    near[:-1] |= away
    near[1:] |= away
    near &= np.diff(s) > SHORT
    middles: Array = 0.5 * (s[:-1] + s[1:])[near]
    return middles


def _choose(arm: Form, samples: _Samples, index: int, q: Array) -> tuple[int, Array, bool]:
    """Return the branch at sample `index` that is nearest to the joint position `q` (6,).

    Args:
        arm: the closed form.
        samples: all branches at the path parameters so far.
        index: the sample.
        q: (6,) [rad].

    Returns:
        The branch, or -1 if no branch reaches the pose; its joint values (6,) on the full turns nearest to
            `q`; and True if it is singular at the sample. Its free angle then has the value in `q`.
    """
    solutions, valid, singular = samples.q[index], samples.valid[index], samples.singular[index]
    if not valid.any():
        return -1, q, False
    if singular.any():
        held = closed_form(arm, samples.poses[index : index + 1], q[:, None])
        solutions = held.q[:, :, 0].T
    near, away = next_to(solutions, q)
    size = np.where(valid, np.abs(away).max(axis=1), np.inf)
    choice = int(np.argmin(size))
    return choice, near[choice], bool(singular[choice])


def _sections(start: float, end: float, pieces: int) -> Array:
    """Return the path parameters (pieces - 1,) that divide an interval of the path into equal pieces."""
    result: Array = np.linspace(start, end, pieces + 1)[1:-1]
    return result


def _sampled(arm: Form, poses: Array, s: Array, hold: Array) -> _Samples:
    """Compute all branches (solutions) at new path parameters."""
    solutions = closed_form(arm, poses, hold[:, None])
    return _Samples(
        s,
        poses,
        np.ascontiguousarray(solutions.q.transpose(2, 1, 0)),
        solutions.valid.T.copy(),
        solutions.singular.T.copy(),
        solutions.free.T.copy(),
    )


def _merged(samples: _Samples, extra: _Samples) -> _Samples:
    """Merge two sets of samples in the order of their path parameters."""
    s = np.concatenate([samples.s, extra.s])
    order = np.argsort(s, kind="stable")
    return _Samples(
        s[order],
        np.concatenate([samples.poses, extra.poses])[order],
        np.concatenate([samples.q, extra.q])[order],
        np.concatenate([samples.valid, extra.valid])[order],
        np.concatenate([samples.singular, extra.singular])[order],
        np.concatenate([samples.free, extra.free])[order],
    )
