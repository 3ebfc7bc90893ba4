"""Check together if the arm reaches many given poses.

After a fault in a motion the robot's position isn't known, so the poses of later motions are checked without
it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from yarclang.hir import ArcMove, LineMove, PoseGoal, Step
from yarclang.motion.leading.solving import flange_at
from yarclang.motion.runs import Growing
from yarclang.robot.kinematics.nearest import surely_reached
from yarclang.robot.model import Robot

MOST_POSES = 512
"""The largest number of poses that are checked together."""


@dataclass(slots=True)
class ReachedAhead:
    """Checker of the goals of consecutive lines and arcs. It checks many at once, and finds those that are
    certainly in reach.
    """

    robot: Robot
    steps: Sequence[Step]
    _known: dict[int, bool] = field(default_factory=dict)
    _growing: Growing = field(default_factory=lambda: Growing(MOST_POSES))

    def is_sure(self, number: int) -> bool:
        """Return True if the goal of step `number` can certainly be reached; False if it must be checked
        separately.
        """
        if number not in self._known:
            self._known = self._looked_at(number)
        return self._known.pop(number, False)

    def _looked_at(self, number: int) -> dict[int, bool]:
        """Return the results of the reach check for lines and arcs from step `number` on.

        The result is empty if step `number` is neither a line nor an arc, or if fewer than two goals are
        found.
        """
        goals = dict[int, PoseGoal]()
        size = self._growing.size(number)
        for here in range(number, len(self.steps)):
            step = self.steps[here]
            if isinstance(step, LineMove | ArcMove) and isinstance(step.goal, PoseGoal):
                goals[here] = step.goal
            if number not in goals or len(goals) == size:
                break
        if len(goals) < 2:
            return {}
        flanges = np.array([flange_at(goal) for goal in goals.values()])
        sure = surely_reached(self.robot.chain, self.robot.limits, flanges)
        self._growing.done(max(goals))
        return dict(zip(goals, sure.tolist(), strict=True))
