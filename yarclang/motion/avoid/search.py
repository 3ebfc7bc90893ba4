"""A way of straight pieces through joint space: RRT-Connect and shortcuts, by OMPL.

OMPL's chance comes from one seed, which is set before anything of OMPL is made, and a search ends by the number of its samples, never
by a clock: so the same question has the same answer in every process, whatever was asked before. OMPL has one chance for all threads, so that no two of them may
search at once.
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
    """How a way is looked for: pairs stay farther apart than their margins by `padding` [m] where they can; `step` [m] is about how far bodies move between
    two joint positions that are looked at; `samples` are drawn at most, from `seed` on. With so many `lines` the tool is drawn out of start and goal before (`backing`);
    an effort that `is_for_lines` alone is left out where nothing leads out of either.
    """

    padding: float
    step: float
    samples: int
    seed: int
    lines: int = 0
    is_for_lines: bool = False


@frozen(eq=False)
class Question:
    """From one of the joint positions `starts` (k, n) [rad or m] to one of `goals` (m, n) within limits, through what is `free`. `reach` (n,) are the joints' scales
    [m/rad or 1]. `is_over` ends the search before its samples are drawn.
    """

    starts: Array
    goals: Array
    limits: Limits
    reach: Array
    free: Callable[[Array], bool]
    is_over: Callable[[], bool] = lambda: False


@frozen(eq=False)
class Apart:
    """A search that ended without a way: of all joint positions that were reached from the starts, `q` (n,) is nearest to one, `beyond` (n,), from which a goal is reached; `left`
    between them [m, of bodies]. So many `tries` were made.
    """

    q: Array
    beyond: Array
    left: float
    tries: int


_RANGE = 1.0
"""A tree grows by branches of this length at most [m, of bodies]."""

_INNER = 0.01
"""Ways keep this far from the joint limits [rad or m], so that a curve has room to swing."""

_FARTHEST = 6.4
"""A joint without limits goes this far from where it stands at most [rad or m]."""


def polyline(question: Question, effort: Effort) -> Array | Apart:
    """Return the corners (k, n) [rad or m] of a way from a start to a goal, both among them; or how near the search came."""
    from ompl import base, geometric, util

    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(effort.seed)
    scale, size = question.reach, len(question.reach)
    low, high = _bounds(question)
    bounds = base.RealVectorBounds(size)
    for joint in range(size):
        bounds.setLow(joint, float(low[joint] * scale[joint]))
        bounds.setHigh(joint, float(high[joint] * scale[joint]))
    space = base.RealVectorStateSpace(size)
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(effort.step / space.getMaximumExtent())
    around = base.SpaceInformation(space)
    joints, free = range(size), question.free

    # it must not hold what holds it: nobody would ever let go of both
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
        except Exception as reason:  # it must not pass through C++
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
    # each is bounded by the number of its tries
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
    """Return where the two trees of a search come nearest to each other."""
    from scipy.spatial import cKDTree

    trees: dict[int, list[list[float]]] = {_FROM_START: [], _FROM_GOAL: []}
    joints = range(len(question.reach))
    for number in range(data.numVertices()):
        vertex = data.getVertex(number)
        state = vertex.getState()
        trees[vertex.getTag()].append([state[joint] for joint in joints])
    # the ends of a side that nothing was drawn for belong to no tree
    out, in_ = (
        np.concatenate((np.array(grown).reshape(-1, len(joints)), ends * question.reach))
        for grown, ends in ((trees[_FROM_START], question.starts), (trees[_FROM_GOAL], question.goals))
    )
    left, to = cKDTree(in_).query(out)
    best = int(np.argmin(left))
    return Apart(out[best] / question.reach, in_[to[best]] / question.reach, float(left[best]), tries)


_FROM_START, _FROM_GOAL = 1, 2
"""How RRT-Connect marks what it reached from the starts, and from the goals."""


def _nearest(ends: Array, q: Array) -> Array:
    """Return the one of some joint positions (k, n) that a way begins or ends at, to its last digit."""
    found: Array = ends[int(np.argmin(np.abs(ends - q).max(axis=1)))]
    return found


def _bounds(question: Question) -> tuple[Array, Array]:
    """Between which joint positions (n,) a way is looked for: a little inside the limits, and where it begins and ends."""
    ends = np.concatenate([question.starts, question.goals])
    least, most = ends.min(axis=0), ends.max(axis=0)
    low = np.maximum(question.limits.lower + _INNER, least - _FARTHEST)
    high = np.minimum(question.limits.upper - _INNER, most + _FARTHEST)
    return np.minimum(low, least), np.maximum(high, most)
