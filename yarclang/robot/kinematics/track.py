"""Follow a path of flange poses with continuous joint motion, or report where and why it can't be followed.

A path is sampled densely enough for each joint to move little from one sample to the next. If a joint moves
farther, samples are added until the move is small, or until the interval is so short that the joint would
have to jump.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import walk
from yarclang.robot.kinematics.geometry import form_of
from yarclang.robot.kinematics.inverse import branches, follow, reached_within, restarts
from yarclang.robot.kinematics.keeping import kept_within
from yarclang.robot.kinematics.march import march, marches
from yarclang.robot.kinematics.nearest import nearest_miss
from yarclang.robot.kinematics.numeric import fit, misses, pose_columns
from yarclang.robot.kinematics.strands import Strand, follow_branches
from yarclang.robot.kinematics.within import beyond, nearest_turn
from yarclang.robot.model import Array, Chain, Limits
from yarclang.transforms import sealed

BreakKind = Literal["reach", "limits", "singular", "configuration"]
Reason = Literal["any", "kind", "measured"]
"""Information wanted about the reason why a path can't be followed, if joint limits aren't the reason.

"any": nothing, so that the reported kind is arbitrary. "kind": the kind of the break. "measured": the kind,
and by how much the path is out of reach. "kind" and "measured" need searches of about 0.1 s.
"""

PathPoses = Callable[[Array], Array]

SAMPLES = 33
"""Number of places at which a path is sampled first."""

ON_PATH = 1e-6
"""Limits for the start after iteration has improved it: its largest distance from the path's start, and its
largest excess over joint limits [m or rad].
"""

START = 1e-3
"""Largest change of the start by the iteration that improves it [rad or m]."""

CLEAR = 1e-6
"""Distance after a singularity at which a joint's jump is measured, relative to the path."""

CLEAR_WAY = 1e-7
"""Least distance after a singularity at which a joint's jump is measured [m and rad together]. At smaller
distances, the closed form changes from the held angle to the determined one.
"""

EDGE = 1e-8
"""A joint that exceeds its limit by no more than this [rad or m] counts as at the limit."""


@frozen(eq=False)
class Track:
    """Joint positions along a path.

    Between two neighbouring samples no joint moves more than 0.2 rad (or m). From joint positions that `at`
    interpolates, `follow` therefore finds solutions on the same branch.

    Attributes:
        s: (M,) path parameters, from 0 to 1.
        q: (M, n) joint positions that reach the path's poses, without jumps by full turns [rad or m].
        bend: (M, n) second derivatives of the natural cubic spline through `q`. Only a redundant arm has
            them: it has a continuum of solutions, so the seeds determine which of them are found, and have to
            be smooth.
    """

    s: Array
    q: Array
    bend: Array | None = None

    def at(self, s: Array) -> Array:
        """Return joint positions (N, n) interpolated between the samples at path parameters `s` (N,). They
        are seeds for inverse kinematics, not solutions.
        """
        after = np.clip(np.searchsorted(self.s, s, side="right"), 1, len(self.s) - 1)
        before = after - 1
        width = (self.s[after] - self.s[before])[:, None]
        share = (s - self.s[before])[:, None] / width
        result: Array = self.q[before] + share * (self.q[after] - self.q[before])
        if self.bend is not None:
            left, right = self.bend[before], self.bend[after]
            result = result - width**2 / 6.0 * share * (1.0 - share) * (
                (2.0 - share) * left + (1.0 + share) * right
            )
        return result


@frozen(eq=False)
class Broken:
    """The place after which a path can't be followed, and the reason.

    `kind` is the reason:

    "reach": the rest of the path is out of reach. At its worst place the flange misses the pose by `amount`
    [m] in the right orientation; if the arm can't reach the orientation either, `angle` [rad] remains. Both
    are valid only if `is_measured`.

    "limits": joint number `joint` (from 0) leaves its limits here. On the rest of the path it would exceed
    them by up to `amount` [rad or m], positive above the upper limit, negative below the lower one. Some
    later pose can't be reached within limits by any configuration.

    "configuration": only another configuration (or another full turn of a joint) continues from here. If
    limits are the reason, `joint` and `amount` are as for "limits", and every sampled pose of the rest of the
    path can be reached within limits by some other configuration. If this configuration ends here, `joint` is
    the joint with the largest difference from the nearest other configuration, and `amount` is this
    difference; `joint` may also be None.

    "singular": `joint` would have to jump here by `amount` [rad or m] with the flange at rest.

    Attributes:
        s: last path parameter that is reached, from 0 to 1.
        kind: the reason.
        q: (n,) joint position at `s` [rad or m].
        joint: number of a joint, from 0; see `kind`.
        amount: see `kind`.
        angle: see "reach".
        is_measured: True if `amount` and `angle` are valid for "reach".
    """

    s: float
    kind: BreakKind
    q: Array
    joint: int | None = None
    amount: float = 0.0
    angle: float = 0.0
    is_measured: bool = True


def track(
    chain: Chain,
    limits: Limits,
    pose_at: PathPoses,
    q_start: Array,
    *,
    samples: int = SAMPLES,
    reason: Reason = "measured",
) -> Track | Broken:
    """Follow a path of flange poses from a given joint position, without jumps of a joint.

    Args:
        chain: the arm, n joints.
        limits: its limits; q_start is within them.
        pose_at: function that returns the poses base_from_flange (N, 4, 4) at path parameters s (N,) in [0,
            1]; continuous.
        q_start: (n,) [rad or m], reaches pose_at(0) up to small errors, which are corrected.
        samples: number of path parameters that are sampled first, at equal distances.
        reason: what to find out about the reason if the path can't be followed.

    Returns:
        The joint positions along the whole path, or the place after which it can't be followed, and why.

    Raises:
        ValueError: q_start is more than 1e-3 rad (or m) from the nearest joint position that reaches
            pose_at(0) within 1e-6.
    """
    s = np.linspace(0.0, 1.0, max(samples, 3))
    start = q_start[None]
    miss, turn = misses(walk(chain, q_start[:, None], np.eye(4))[0], pose_columns(pose_at(s[:1])))
    if max(float(miss[0]), float(turn[0])) > 1e-10:
        start, miss, turn = follow(chain, pose_at(s[:1]), start)
    if max(float(miss[0]), float(turn[0])) > ON_PATH or np.abs(start[0] - q_start).max() > START:
        raise ValueError("the start position doesn't stand at the path's start")
    if np.abs(beyond(limits, start[0])).max() <= ON_PATH:
        # a start at a limit may exceed it by a rounding error: widen the limits to include the start
        limits = replace(
            limits, lower=np.minimum(limits.lower, start[0]), upper=np.maximum(limits.upper, start[0])
        )
    arm = form_of(chain)
    bends = samples if samples > SAMPLES else 0
    strand = (
        march(chain, pose_at, start[0], bends) if arm is None else follow_branches(arm, pose_at, s, start[0])
    )
    outside = _leaving(chain, limits, pose_at, strand)
    if chain.size > 6 and (outside is not None or strand.end != "whole"):
        # the path of least joint motion leaves the limits or ends early: try motions that keep clear of
        # limits
        clear: Strand | None = march(chain, pose_at, start[0], bends, limits)
        if clear is not None and not _keeps(limits, clear):
            clear = None if bends else kept_within(chain, limits, [pose_at], start)[0]
        if clear is not None and _keeps(limits, clear):
            strand, outside = clear, None
    if outside is not None:
        return outside
    if strand.end == "whole":
        bend = sealed(spline_bends(strand.s, strand.q)) if chain.size > 6 else None
        return Track(sealed(strand.s), sealed(strand.q), bend)
    if reason == "any":
        return Broken(float(strand.s[-1]), "reach", sealed(strand.q[-1]), is_measured=False)
    return _break(chain, pose_at, strand, measures=reason == "measured")


def followed(chain: Chain, limits: Limits, paths: Sequence[PathPoses], starts: Array) -> NDArray[np.bool_]:
    """Return a mask (K,) of the paths that `track` follows to their ends.

    For an arm without a closed form this takes a fraction of the time of `track`.

    Args:
        chain: the arm, n joints.
        limits: its limits.
        paths: for each path, a function that returns the poses base_from_flange (N, 4, 4) at path parameters
            (N,), from 0 to 1.
        starts: (K, n) [rad or m], within limits, exactly at the paths' starts.
    """
    if form_of(chain) is not None:
        ends = (
            track(chain, limits, path, start, reason="any") for path, start in zip(paths, starts, strict=True)
        )
        return np.array([isinstance(end, Track) for end in ends])
    whole = np.array([_keeps(limits, strand) for strand in marches(chain, paths, starts)], dtype=bool)
    if chain.size > 6:
        remaining = np.flatnonzero(~whole).tolist()
        again = marches(chain, [paths[at] for at in remaining], starts[remaining], limits)
        whole[remaining] = [_keeps(limits, strand) for strand in again]
        remaining = np.flatnonzero(~whole).tolist()
        if remaining:
            kept = kept_within(chain, limits, [paths[at] for at in remaining], starts[remaining])
            whole[remaining] = [strand is not None and _keeps(limits, strand) for strand in kept]
    return whole


def _keeps(limits: Limits, strand: Strand) -> bool:
    return strand.end == "whole" and not (np.abs(beyond(limits, strand.q)) > EDGE).any()


def _leaving(chain: Chain, limits: Limits, pose_at: PathPoses, strand: Strand) -> Broken | None:
    """Return the place and reason at which the joints of a strand (a sequence of joint positions) first
    exceed their limits, or None if they stay within them.
    """
    excess = beyond(limits, strand.q)
    out = np.abs(excess) > EDGE
    if not out.any():
        return None
    first = int(np.argmax(out.any(axis=1)))
    if first == 0:
        joint = int(np.argmax(np.abs(excess[0])))
        return Broken(0.0, "limits", sealed(strand.q[0]), joint, float(excess[0, joint]))
    before, after = strand.s[first - 1], strand.s[first]
    ends = strand.q[first - 1 : first + 1]
    inside = ends[0]
    # narrow the place down by repeated division; points on the chord between two samples are good seeds
    for _ in range(6):
        s = np.linspace(before, after, 17)
        share = np.linspace(0.0, 1.0, 17)[:, None]
        q = follow(chain, pose_at(s), ends[0] + share * (ends[1] - ends[0]))[0]
        over = (np.abs(beyond(limits, q)) > EDGE).any(axis=1)
        last = max(int(np.argmax(over)), 1) if over.any() else 16
        before, after, ends, inside = s[last - 1], s[last], q[last - 1 : last + 1], q[last - 1]
    joint = int(np.argmax(np.abs(beyond(limits, ends[1]))))
    # the largest excess of this joint over its limits on the rest of the path
    worst = excess[first:, joint]
    amount = float(worst[np.argmax(np.abs(worst))])
    kind: BreakKind = "limits"
    rest = np.linspace(after, 1.0, 9)
    if _otherwise(chain, limits, pose_at(rest), inside):
        kind = "configuration"
    return Broken(float(before), kind, sealed(inside), joint, amount)


def _break(chain: Chain, pose_at: PathPoses, strand: Strand, *, measures: bool) -> Broken:
    """Return the reason why a strand (a sequence of joint positions) ends before the path does."""
    s, q = float(strand.s[-1]), sealed(strand.q[-1])
    if strand.end == "jump":
        return _jump(chain, pose_at, s, q, strand.beyond)
    # sample densely just after the break, where a gap in reach may be short, and less densely on the rest of
    # the path
    rest = np.unique(
        np.concatenate([s + (1.0 - s) * np.geomspace(1e-8, 1.0, 25), np.linspace(s, 1.0, 33)[1:]])
    )
    poses = pose_at(rest)
    seeds = np.repeat(q[None], len(rest), axis=0)
    _, position, angle = follow(chain, poses, seeds)
    worst = int(np.argmax(position + angle))
    spread = np.vstack([q, restarts(chain, 24)])
    free = fit(chain, np.repeat(poses[worst : worst + 1], len(spread), axis=0), spread)
    if free.total.min() < reached_within(chain):
        return Broken(s, "configuration", q)
    if not measures:
        return Broken(s, "reach", q, is_measured=False)
    _, miss, turn = nearest_miss(chain, poses[worst], spread)
    return Broken(s, "reach", q, amount=miss, angle=turn)


def _jump(chain: Chain, pose_at: PathPoses, s: float, q: Array, beyond: Array) -> Broken:
    """Return the reason why a strand ends at `q` (n,), if a joint would have to jump to the nearest solution
    after the end, `beyond` (n,).
    """
    # measure the jump a little further on, where the joints are clear of the singularity
    ends = pose_columns(pose_at(np.array([s, 1.0])))
    way = sum(float(one[-1]) for one in misses(ends[:, :, :1], ends[:, :, 1:]))
    ahead = max(CLEAR, (1.0 - s) * CLEAR_WAY / max(way, CLEAR_WAY))
    further = follow(chain, pose_at(np.array([min(s + ahead, 1.0)])), beyond[None])
    if max(further[1][0], further[2][0]) < reached_within(chain):
        beyond = further[0][0]
    jump = beyond - q
    # if two axes coincide, both joints jump by equal amounts, except for rounding, which depends on the
    # processor: report the first joint
    size = np.abs(jump)
    joint = int(np.flatnonzero(size >= (1.0 - 1e-6) * size.max())[0])
    # at a singularity the joints can move across the jump with the flange at rest; otherwise the two
    # configurations are separate
    middle = 0.5 * (q + beyond)
    between = fit(chain, pose_at(np.array([s])), middle[None])
    joined = between.total[0] < 1e-6 and np.abs(between.q[0] - middle).max() < 0.3 * abs(jump[joint])
    return Broken(s, "singular" if joined else "configuration", q, joint, float(jump[joint]))


def _otherwise(chain: Chain, limits: Limits, poses: Array, reference: Array) -> bool:
    """Return True if every pose (N, 4, 4) can be reached within limits, each by any configuration."""
    q, valid = branches(chain, poses, reference)
    lifted = nearest_turn(chain, limits, q, reference)
    inside = (np.abs(beyond(limits, lifted)) <= EDGE).all(axis=2) & valid
    return bool(inside.any(axis=1).all())


def spline_bends(s: Array, q: Array) -> Array:
    """Return the second derivatives (M, n) of the natural cubic spline through joint positions `q` (M, n) at
    path parameters `s` (M,).
    """
    from scipy.linalg import solveh_banded

    width = np.diff(s)
    slope = np.diff(q, axis=0) / width[:, None]
    bend = np.zeros_like(q)
    if len(s) > 3:  # LAPACK's wrapper doesn't accept a system of one equation
        band = np.zeros((2, len(s) - 2))
        band[0, 1:], band[1] = width[1:-1], 2.0 * (width[:-1] + width[1:])
        bend[1:-1] = solveh_banded(band, 6.0 * np.diff(slope, axis=0), check_finite=False)
    elif len(s) == 3:
        bend[1] = 3.0 * (slope[1] - slope[0]) / (width[0] + width[1])
    return bend
