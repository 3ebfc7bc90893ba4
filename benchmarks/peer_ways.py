"""Find paths around obstacles with OMPL's RRT-Connect and our collision checker, for comparison."""

from __future__ import annotations

import numpy as np

from yarclang.motion.avoid.room import Room, reaches
from yarclang.robot.model import Array


def by_peer(
    room: Room, start: Array, goal: Array, seed: int, seconds: float, *, is_shortened: bool = True
) -> Array | None:
    """Return the corners (k, n) of a path that OMPL's RRT-Connect finds with the same collision checker; None
    if RRT-Connect finds none.
    """
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(seed)
    size, limits = room.robot.size, room.robot.limits
    scale = reaches(room.scene, room.robot)
    bounds = base.RealVectorBounds(size)
    for joint in range(size):
        bounds.setLow(joint, float(limits.lower[joint] * scale[joint]))
        bounds.setHigh(joint, float(limits.upper[joint] * scale[joint]))
    space = base.RealVectorStateSpace(size)
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(0.01 / space.getMaximumExtent())
    around = base.SpaceInformation(space)
    around.setStateValidityChecker(
        lambda state: room.is_free(np.array([state[at] for at in range(size)]) / scale)
    )
    around.setup()
    task = base.ProblemDefinition(around)
    ends = []
    for q in (start, goal):
        state = space.allocState()
        for joint in range(size):
            state[joint] = float(q[joint] * scale[joint])
        ends.append(state)
    task.setStartAndGoalStates(*ends)
    planner = geometric.RRTConnect(around)
    planner.setProblemDefinition(task)
    planner.setup()
    planner.solve(base.timedPlannerTerminationCondition(seconds))
    if not task.hasExactSolution():
        return None
    path = task.getSolutionPath()
    if is_shortened:
        geometric.PathSimplifier(around).simplifyMax(path)
    states = [path.getState(at) for at in range(path.getStateCount())]
    return np.array([[state[at] for at in range(size)] for state in states]) / scale
