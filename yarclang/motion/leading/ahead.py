"""Compute the paths of many straight lines and arcs together, before the robot's position at the start of
each is known.

If a line or an arc goes to a given pose, the joint position at its end depends only on the arm configuration,
not on the path to the pose. Therefore the robot's present configuration is assumed for all these motions, and
all samples of all paths are solved together. Only paths that stay in this configuration without any decision
are kept: for these, `track` would return the same result to the last bit. All other paths are computed one by
one by `track`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from yarclang.hir import ArcMove, Array, Dwell, LineMove, PoseGoal, SetOutput, Step
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.paths.arc import Arc, NoArc, arc_through
from yarclang.motion.paths.line import Line, lines_between, poses_along
from yarclang.motion.runs import Growing
from yarclang.robot.kinematics.closed_form import closed_form, next_to
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.geometry import Form, form_of
from yarclang.robot.kinematics.inverse import REACHED
from yarclang.robot.kinematics.strands import plain_strands
from yarclang.robot.kinematics.track import EDGE, SAMPLES, Track
from yarclang.robot.kinematics.within import beyond
from yarclang.robot.kinematics.wrist import TURN
from yarclang.robot.model import Robot

_STANDS = 1e-6
"""Difference of joint positions up to which an inverse-kinematics solution counts as the robot's position
[rad].
"""

_SHORT, _LITTLE = 0.01, 0.1
"""Length [m] and rotation [rad] below which a path in a long chain is sampled at only `_FEW` places."""
_FEW = 5
"""Number of places at which a short path is sampled; see `_SHORT`."""

MOST_IN_CHAINS = 512
"""Largest number of motions of a long chain that are computed together."""


@dataclass(slots=True)
class WaysAhead:
    """Maker of the paths of consecutive straight lines and arcs to given poses. It computes many at once if
    possible.

    `chained` are the indices of steps in long chains, whose short paths are sampled at few places.
    """

    robot: Robot
    steps: Sequence[Step]
    chained: frozenset[int] = frozenset()
    _ready: dict[int, CartesianPath] = field(default_factory=dict)
    _growing: Growing = field(default_factory=Growing)

    def path(self, number: int, stands: Array) -> CartesianPath | None:
        """Return the path of step `number` from the joint position `stands` (n,) [rad]; None if this path
        can't be computed together with others.
        """
        found = self._ready.pop(number, None)
        if found is not None and np.array_equal(found.start, stands):
            return found
        self._ready.clear()
        self._growing.most = MOST_IN_CHAINS if number in self.chained else None
        size = self._growing.size(number)
        arm = form_of(self.robot.chain)
        if arm is None or size == 1:
            return None
        numbers, steps = self._run(number, size)
        if len(steps) < 2:
            return None
        followed = self._followed(arm, steps, stands, is_chain=number in self.chained)
        self._ready.update(zip(numbers, followed, strict=False))
        if followed:
            self._growing.done(numbers[len(followed) - 1])
        else:
            self._growing = Growing(self._growing.most)
        return self._ready.pop(number, None)

    def _run(self, number: int, size: int) -> tuple[list[int], list[LineMove | ArcMove]]:
        """Return up to `size` consecutive lines and arcs of one frame to given poses, from step `number` on.

        The result has the indices of the steps, and the steps.
        """
        numbers, steps = list[int](), list[LineMove | ArcMove]()
        for here in range(number, len(self.steps)):
            step = self.steps[here]
            if isinstance(step, SetOutput | Dwell):
                continue
            if not isinstance(step, LineMove | ArcMove) or not isinstance(step.goal, PoseGoal):
                break
            if len(steps) == size or (here in self.chained) != (number in self.chained):
                break
            if steps and not _same(step.goal.flange_from_moving, steps[0].goal.flange_from_moving):
                break
            numbers.append(here)
            steps.append(step)
        return numbers, steps

    def _followed(
        self, arm: Form, steps: list[LineMove | ArcMove], stands: Array, *, is_chain: bool
    ) -> list[CartesianPath]:
        """Return the arm's paths for consecutive motions to given poses. The first motion starts at the joint
        position `stands` (n,).

        The result ends before the first motion that jumps between configurations, meets a singularity or
        leaves joint limits.
        """
        goals = [step.goal for step in steps if isinstance(step.goal, PoseGoal)]
        chain, tool = self.robot.chain, goals[0].flange_from_moving
        flange_from_moving = np.linalg.inv(tool)
        begin = tool_poses(chain, stands[None], tool)
        wanted = [goal.base_from_moving for goal in goals]
        ends = np.concatenate((begin, wanted)) @ flange_from_moving
        # Compute all inverse-kinematics branches of all goals at once. For all motions, take the branch to
        # which the robot's position at the start belongs.
        corners = closed_form(arm, ends, stands[:, None])
        branch = _standing(corners.q[:, :, 0].T, stands)
        if branch is None or corners.singular.any():
            return []
        starts = _unwound(corners.q[:, branch, 1:-1].T, stands)
        poses = np.concatenate((begin, tool_poses(chain, starts[1:], tool)))
        ways = _ways(steps, poses, wanted)
        if not ways:
            return []
        is_short = is_chain and all(way.length < _SHORT and way.angle < _LITTLE for way in ways)
        s = np.linspace(0.0, 1.0, _FEW if is_short else SAMPLES)
        skeleton = _poses_along(ways, s) @ flange_from_moving
        # A path is plain if it stays in this branch without a jump or a singularity. Keep the paths before
        # the first one that isn't plain.
        q, is_plain = plain_strands(arm, skeleton, s, starts[: len(ways)], branch)
        is_plain &= (np.abs(beyond(self.robot.limits, q)) <= EDGE).all(axis=(1, 2))
        s.setflags(write=False)
        q.setflags(write=False)
        plain = len(ways) if is_plain.all() else int(np.argmin(is_plain))
        return [
            CartesianPath(chain, tool, way, start, Track(s, joints))
            for way, start, joints in zip(ways[:plain], starts[:plain], q[:plain], strict=True)
        ]


def _same(one: Array, other: Array) -> bool:
    return one is other or np.array_equal(one, other)


def _ways(steps: list[LineMove | ArcMove], poses: Array, goals: list[Array]) -> list[Line | Arc]:
    """Return the paths of the moving frame for consecutive motions, from the start poses `poses` (m, 4, 4) to
    the goals (4, 4).

    The result ends before the first motion that has no path, or doesn't move.
    """
    straight = [row for row, step in enumerate(steps) if isinstance(step, LineMove)]
    lines = iter(lines_between(poses[straight], [goals[row] for row in straight])) if straight else iter(())
    ways = list[Line | Arc]()
    for step, pose, goal in zip(steps, poses, goals, strict=True):
        way = next(lines) if isinstance(step, LineMove) else arc_through(pose, step.via, goal)
        if way is None or isinstance(way, NoArc) or max(way.length, way.angle) < REACHED:
            break
        ways.append(way)
    return ways


def _poses_along(ways: list[Line | Arc], s: Array) -> Array:
    """Return the poses base_from_moving (m * M, 4, 4) along each of m paths, at the places `s` (M,)."""
    lines = [way for way in ways if isinstance(way, Line)]
    if len(lines) == len(ways):
        return poses_along(lines, s).reshape(-1, 4, 4)
    return np.concatenate([way.poses(s) for way in ways])


def _standing(branches: Array, stands: Array) -> int | None:
    """Return the index of the inverse-kinematics branch in `branches` (8, n) that equals the robot's position
    `stands` (n,).

    The result is None unless exactly one branch equals this position.
    """
    away = np.abs(next_to(branches, stands)[1]).max(axis=1)
    found = np.flatnonzero(away < _STANDS)
    return int(found[0]) if len(found) == 1 else None


def _unwound(ends: Array, stands: Array) -> Array:
    """Return the joint positions (m + 1, n) at the start `stands` (n,) and at the `ends` (m, n) of
    consecutive lines.

    Full turns are added to each joint position so that it is as near as possible to the one before.
    """
    starts = np.concatenate((stands[None], ends))
    # Remove full turns between all consecutive ends at once, then check each end.
    starts[1:] -= TURN * np.cumsum(np.round((ends - np.concatenate((starts[:1], ends[:-1]))) / TURN), axis=0)
    near = next_to(ends, starts[:-1])[0]
    off = np.flatnonzero((near != starts[1:]).any(axis=1))
    starts[1:] = near
    # If a joint moves by half a turn, the result depends on rounding: from there on, add turns one by one.
    for number in range(off[0] if len(off) else len(ends), len(ends)):
        starts[number + 1] = next_to(ends[number], starts[number])[0]
    return starts
