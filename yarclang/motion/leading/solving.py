"""Solve inverse kinematics for poses of a frame: find the nearest joint position without an obstruction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector
from yarclang.frozen import frozen
from yarclang.hir import Array, Motion, PoseGoal
from yarclang.motion.avoid.changes import helpful_changes
from yarclang.motion.avoid.messages import configuration_blocked, every_configuration_blocked, with_changes
from yarclang.motion.avoid.room import Room, room_of
from yarclang.motion.leading import messages
from yarclang.motion.wording import Message
from yarclang.motion.zones import moving_of
from yarclang.robot.kinematics.in_turn import nearest_in_turn
from yarclang.robot.kinematics.nearest import SAME, Unreachable, full_turns, nearest_solutions
from yarclang.robot.kinematics.redundant import reaches, self_motion
from yarclang.robot.kinematics.within import EDGE, beyond
from yarclang.robot.model import Robot


@frozen
class Solver:
    """Solver of inverse kinematics for a robot in its cell, which avoids obstructions.

    With `measures`, the solver computes how far poses are out of reach, and searches for similar poses if a
    pose can't be reached without a collision. `is_again` is True if a search for a path of this command found
    nothing in an earlier pass of a loop; the next search is then short. `searches` is the number of paths
    around obstacles to find; the fastest one is used.
    """

    robot: Robot
    cell: Cell | None = None
    measures: bool = True
    is_again: bool = False
    searches: int = 1

    def room(self, step: Motion) -> Room | None:
        """Return the surroundings during a motion; None if there are no obstacles."""
        return room_of(self.robot, self.cell, moving_of(self.robot, step))

    def nearest(
        self, goal: PoseGoal, near: Array, step: Motion, findings: Collector, which: str = ""
    ) -> Array | None:
        """Return the joint position nearest to `near` at which the moving frame is at its goal.

        Obstructions are ignored. If there is no such joint position, the result is None, and a finding is
        added.

        Args:
            goal: the goal pose; a joint position that the program gives for it by NEAR replaces `near`.
            near: (n,) joint position [rad or m].
            step: the motion.
            findings: receives the finding.
            which: words that name the waypoint in messages.
        """
        near = near if goal.near is None else goal.near
        chain, limits = self.robot.chain, self.robot.limits
        solved = nearest_solutions(chain, limits, flange_at(goal), near, measures=self.measures, is_only=True)
        if isinstance(solved, Unreachable):
            told = messages.unreachable(self.robot, solved, step.origin, which)
            findings.add(*self._with_changes(told, goal, near, step, which))
            return None
        return np.array(solved.q[0])

    def chosen(
        self, goal: PoseGoal, near: Array, step: Motion, findings: Collector, which: str = ""
    ) -> Array | None:
        """Return the joint position for a goal that is nearest to `near` and free of obstructions.

        A finding is added if a nearer solution is obstructed. If all solutions are obstructed, the nearest
        one is returned, and an error is added. If the program gives a joint position for the goal by NEAR,
        the solution nearest to that one is returned, even if it is obstructed. The result is None if the goal
        is out of reach.
        """
        q = self.nearest(goal, near, step, findings, which)
        if q is None or goal.near is not None:
            return q
        room = self.room(step)
        if room is None or room.is_free(q) or (obstruction := room.obstruction(q)) is None:
            return q
        others = self._after(goal, near, q)
        other = next(room.free_among(others), None)
        if other is None:
            other = self._along_self_motion(goal, near, [q, *others], room)
        if other is not None:
            findings.add(*configuration_blocked(self.robot, step, other, (q, obstruction), which))
            return other
        asked = zip(others, room.obstructions(others), strict=True)
        blocked = [(q, obstruction), *((one, inside) for one, inside in asked if inside is not None)]
        told = every_configuration_blocked(self.robot, step, blocked, which)
        findings.add(*self._with_changes(told, goal, near, step, which))
        return q

    def _along_self_motion(
        self, goal: PoseGoal, near: Array, blocked: list[Array], room: Room
    ) -> Array | None:
        """Return the joint position of a redundant arm that is nearest to `near` and free of obstructions,
        among those to which the arm can move while its flange is at rest.
        """
        chain, limits = self.robot.chain, self.robot.limits
        if chain.size <= 6:
            return None
        flange = flange_at(goal)
        # Start from the first blocked solutions, and move the redundant arm while its flange is at rest.
        seeds = blocked[:_SEEDS]
        if np.abs(beyond(limits, near)).max() <= EDGE and reaches(chain, flange, near):
            # Start from the robot's present position as well.
            seeds = [near, *seeds[:-1]]
        more = np.concatenate((np.array(seeds), self_motion(chain, limits, flange, np.array(seeds))))
        nearest = more[np.argsort(np.round(np.square(more - near).sum(axis=1), 9), kind="stable")]
        return next(room.free_among(list(nearest)), None)

    def chosen_in_turn(self, goals: Sequence[PoseGoal], near: Array, step: Motion) -> Array:
        """Return the joint positions (k, n) that `chosen` would return for the first k of several goals of
        one moving frame.

        Each joint position is the nearest to the one before. The result ends before the first goal that needs
        a decision or a finding.
        """
        chain, limits = self.robot.chain, self.robot.limits
        moving = np.array([goal.base_from_moving for goal in goals])
        flanges = moving @ np.linalg.inv(goals[0].flange_from_moving)
        q = nearest_in_turn(chain, limits, flanges, near)
        room = self.room(step)
        if room is None:
            return q
        blocked = (place for place, one in enumerate(q) if not room.is_free(one))
        return q[: next(blocked, len(q))]

    def _with_changes(self, told: Message, goal: PoseGoal, near: Array, step: Motion, which: str) -> Message:
        """Extend the finding that a goal pose can't be reached, or only with a collision: add changes of the
        pose that would help. Without `measures`, no changes are searched for.
        """
        if not self.measures:
            return told
        changes = helpful_changes(self.robot, self.room(step), goal, near, step.origin)
        return with_changes(told, goal, changes, step.origin, is_alone=not which)

    def solutions(self, goal: PoseGoal, near: Array) -> list[Array]:
        """Return all inverse-kinematics solutions within limits, the nearest to `near` first.

        Solutions that differ by full turns of joints are listed separately.
        """
        chain, limits = self.robot.chain, self.robot.limits
        solved = nearest_solutions(chain, limits, flange_at(goal), near, measures=False)
        if isinstance(solved, Unreachable):
            return []
        turns = np.concatenate([full_turns(chain, limits, q) for q in solved.q])
        distance = np.square(turns - near).sum(axis=1)
        return list(turns[np.argsort(np.round(distance, 9), kind="stable")])

    def others(self, goal: PoseGoal, near: Array, step: Motion) -> Iterator[Array]:
        """Yield the free inverse-kinematics solutions other than the nearest one, in order of their distance
        from `near`.

        Each solution is checked for obstructions only when it is requested.
        """
        room = self.room(step)
        solved = nearest_solutions(
            self.robot.chain, self.robot.limits, flange_at(goal), near, measures=False, is_only=True
        )
        if isinstance(solved, Unreachable):
            return
        others = self._after(goal, near, solved.q[0])
        yield from others if room is None else room.free_among(others)

    def _after(self, goal: PoseGoal, near: Array, q: Array) -> list[Array]:
        """Return all inverse-kinematics solutions except `q` (n,), the nearest to `near` first."""
        return [one for one in self.solutions(goal, near) if np.abs(one - q).max() > SAME]


_SEEDS = 6
"""Largest number of solutions from which the self-motion of a redundant arm is followed."""


def is_free(goal: object) -> bool:
    """Return True if a target leaves open which inverse-kinematics solution is taken."""
    return isinstance(goal, PoseGoal) and goal.near is None


def flange_at(goal: PoseGoal) -> Array:
    """Return the flange's pose at a goal, base_from_flange (4, 4)."""
    flange: Array = goal.base_from_moving @ np.linalg.inv(goal.flange_from_moving)
    return flange
