"""Find a polyline through joint space by OMPL's RRT-Connect and shortcuts.

OMPL's random numbers come from one seed, which is set before any object of OMPL is created. A search ends
after a number of samples, never after a time. Therefore equal questions have equal answers in every process,
whatever was asked before. All threads share OMPL's one random generator, so no two threads may search at
once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.progress import go_on
from yarclang.robot.model import Limits


@frozen
class Effort:
    """The parameters of one search in joint space.

    `padding` [m] is the distance that pairs of bodies keep in addition to their margins if possible. `step`
    [m] is the approximate motion of bodies between two joint positions that are checked. At most `samples`
    samples are drawn, with the random numbers of `seed`. `lines` is the number of straight lines, one after
    the other, by which the tool is first drawn out of start and goal (`backing`). With `is_for_lines`, the
    search is skipped if such lines exist neither at the start nor at the goal.
    """

    padding: float
    step: float
    samples: int
    seed: int
    lines: int = 0
    is_for_lines: bool = False


@frozen(eq=False)
class Question:
    """The input of a search: a path from any of several starts to any of several goals.

    `starts` (k, n) and `goals` (m, n) are joint positions [rad or m] within limits. `reach` (n,) is the lever
    arm of each joint [m/rad or 1]. `free` is a function that returns True for joint positions without
    collision. `is_over` is a function that returns True to end the search before its samples are used up.
    """

    starts: Array
    goals: Array
    limits: Limits
    reach: Array
    free: Callable[[Array], bool]
    is_over: Callable[[], bool] = lambda: False


@frozen(eq=False)
class Apart:
    """The result of a search that found no path: the joint positions at which its two trees come nearest to
    each other.

    `q` (n,) is in the tree that grows from the starts, and `beyond` (n,) in the one from the goals. `left` is
    the distance between them, as an approximate motion of bodies [m]. `tries` is the number of samples drawn.
    """

    q: Array
    beyond: Array
    left: float
    tries: int


_RANGE = 1.0
"""Greatest length of a branch of a search tree, as an approximate motion of bodies [m]."""

_INNER = 0.01
"""Distance that polylines keep from the joint limits [rad or m], since the curve through their corners may
overshoot.
"""

_FARTHEST = 6.4
"""Largest distance from the start or the goal that is searched for a joint without limits [rad or m]."""


def polyline(question: Question, effort: Effort) -> Array | Apart:
    """Return the corners (k, n) [rad or m] of a joint-space polyline from a start to a goal, both included.

    If no polyline is found, return the joint positions at which the two search trees come nearest to each
    other.
    """
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(effort.seed)
    scale, size = question.reach, len(question.reach)
    low, high = bounds_of(question)
    bounds = base.RealVectorBounds(size)
    for joint in range(size):
        # OMPL measures distances between states without weights: scale each joint by its lever, so that these
        # distances are approximately the motion of bodies.
        bounds.setLow(joint, float(low[joint] * scale[joint]))
        bounds.setHigh(joint, float(high[joint] * scale[joint]))
    space = base.RealVectorStateSpace(size)
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(effort.step / space.getMaximumExtent())
    around = base.SpaceInformation(space)
    joints, free = range(size), question.free

    # The checker must not hold a reference to the object that owns it; otherwise neither of the two would
    # ever be freed.
    around.setStateValidityChecker(lambda state: free(np.array([state[joint] for joint in joints]) / scale))
    around.setup()
    problem = base.ProblemDefinition(around)

    def state_of(q: Array) -> Any:
        state = space.allocState()
        for joint in joints:
            state[joint] = float(q[joint] * scale[joint])
        return state

    if len(question.starts) == len(question.goals) == 1:
        problem.setStartAndGoalStates(state_of(question.starts[0]), state_of(question.goals[0]))
    else:
        for q in question.starts:
            problem.addStartState(state_of(q))
        goals = base.GoalStates(around)
        for q in question.goals:
            goals.addState(state_of(q))
        problem.setGoal(goals)
    planner = geometric.RRTConnect(around)
    planner.setRange(_RANGE)
    planner.setProblemDefinition(problem)
    planner.setup()
    tries = 0
    given_up: list[Exception] = []

    def is_over() -> bool:
        nonlocal tries
        try:
            go_on()
        except Exception as reason:  # an exception must not pass through C++
            given_up.append(reason)
        if given_up or tries == effort.samples or question.is_over():
            return True
        tries += 1
        return False

    planner.solve(base.PlannerTerminationCondition(is_over))
    if given_up:
        raise given_up[0]
    if not problem.hasExactSolution():
        data = base.PlannerData(around)
        planner.getPlannerData(data)
        return _apart(question, data, tries)
    path = problem.getSolutionPath()
    simplifier = geometric.PathSimplifier(around)
    # Each simplification ends after its own number of tries.
    simplifier.reduceVertices(path)
    for _ in range(2):
        simplifier.partialShortcutPath(path)
        simplifier.reduceVertices(path)
    simplifier.collapseCloseVertices(path)
    corners = np.array([[path.getState(at)[joint] for joint in joints] for at in range(path.getStateCount())])
    corners /= scale
    corners[0], corners[-1] = _nearest(question.starts, corners[0]), _nearest(question.goals, corners[-1])
    return corners


def _apart(question: Question, data: Any, tries: int) -> Apart:
    """Return the joint positions at which the two trees of a failed search come nearest to each other."""
    from scipy.spatial import cKDTree

    trees: dict[int, list[list[float]]] = {_FROM_START: [], _FROM_GOAL: []}
    joints = range(len(question.reach))
    for number in range(data.numVertices()):
        vertex = data.getVertex(number)
        state = vertex.getState()
        trees[vertex.getTag()].append([state[joint] for joint in joints])
    # Add starts and goals: a tree without samples lacks even its roots.
    out, in_ = (
        np.concatenate((np.array(grown).reshape(-1, len(joints)), ends * question.reach))
        for grown, ends in ((trees[_FROM_START], question.starts), (trees[_FROM_GOAL], question.goals))
    )
    left, to = cKDTree(in_).query(out)
    best = int(np.argmin(left))
    return Apart(out[best] / question.reach, in_[to[best]] / question.reach, float(left[best]), tries)


_FROM_START, _FROM_GOAL = 1, 2
"""Tags that RRT-Connect gives to the vertices of the tree from the starts, and of the tree from the goals."""


def _nearest(ends: Array, q: Array) -> Array:
    """Return the joint position among `ends` (k, n) that is nearest to `q` (n,).

    The search rounds the ends of its path; this function gives the exact joint positions back.
    """
    found: Array = ends[int(np.argmin(np.abs(ends - q).max(axis=1)))]
    return found


def bounds_of(question: Question) -> tuple[Array, Array]:
    """Return the lower and the upper bounds (n,) of the joint positions that the search samples.

    They are slightly inside the joint limits, but include start and goal.
    """
    ends = np.concatenate([question.starts, question.goals])
    least, most = ends.min(axis=0), ends.max(axis=0)
    low = np.maximum(question.limits.lower + _INNER, least - _FARTHEST)
    high = np.minimum(question.limits.upper - _INNER, most + _FARTHEST)
    return np.minimum(low, least), np.maximum(high, most)
