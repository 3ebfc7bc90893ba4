"""The way from one joint position to another round what is between: the straight one where that is free, else a smooth one."""

from __future__ import annotations

import numpy as np

from yarclang.cell.model import JointWindow
from yarclang.collision.zones.windows import SLACK as WINDOW_SLACK
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.backing import Retreat, retreats
from yarclang.motion.avoid.room import Obstruction, Room, reaches
from yarclang.motion.avoid.search import Effort, Question, polyline
from yarclang.motion.avoid.smooth import Bend, smooth, straight_course
from yarclang.transforms import constant

EFFORTS = (
    Effort(0.02, 0.05, 500, 1),
    Effort(0.01, 0.03, 1_500, 5, lines=1),
    Effort(0.005, 0.02, 1_500, 6, lines=2, is_for_lines=True),
    Effort(0.003, 0.03, 3_000, 3),
    Effort(0.0005, 0.02, 3_000, 4, lines=2),
)
"""One after the other until a way is found: first with room to spare, and quickly; then with the tool drawn out of its places; in the end close by, and long."""

SAMPLES = sum(effort.samples for effort in EFFORTS)
"""How many joint positions are drawn until it is given up."""

_PROVED = 1e-3
"""The curve is proved to stay farther apart than the margins by this [m] at most: what is executed may be that much beside it."""


_LOOK = 0.05
"""How far bodies move, about, between two places of the straight way that are looked at [m]."""


@frozen(eq=False)
class Way:
    """Way-points (k, n) [rad or m], without the start; the last is the goal. One by itself is the straight way; else `between` is
    in that.
    """

    waypoints: Array
    between: Obstruction | None = None

    @property
    def is_straight(self) -> bool:
        """Whether nothing had to be gone round."""
        return len(self.waypoints) == 1


@frozen
class Parting:
    """A forbidden window of one joint alone, number `joint` (from 0), between start and goal: `lower` to `upper` [rad or m] of the zone `name`."""

    name: str
    joint: int
    lower: float
    upper: float


@frozen(eq=False)
class NoWay:
    """Why there is no way: what is in the way at the `start`, or at the `goal`; or the zone that parts them for sure. None of these says that nothing was
    found between, of which `between` is in the straight way.
    """

    start: Obstruction | None = None
    goal: Obstruction | None = None
    between: Obstruction | None = None
    parting: Parting | None = None


def find_way(room: Room | None, start: Array, goal: Array, *, is_short: bool = False) -> Way | NoWay:
    """Find the way from `start` to `goal` (n,) [rad or m], both within limits; the same for the same question, always.

    `is_short` is True for no more than the first effort.
    """
    straight = Way(constant(goal[None].copy()))
    if room is None or np.array_equal(start, goal):
        return straight
    between = _straight(room, start, goal)
    if between is None:
        return straight
    at_start, at_goal = room.obstruction(start), room.obstruction(goal)
    if at_start is not None or at_goal is not None:
        return NoWay(at_start, at_goal)
    parting = _parting(room, start, goal)
    if parting is not None:
        return NoWay(between=between, parting=parting)
    for effort in EFFORTS[:1] if is_short else EFFORTS:
        waypoints = _found(room, start, goal, effort)
        if waypoints is not None:
            return Way(constant(waypoints), between)
    return NoWay(between=between)


def _parting(room: Room, start: Array, goal: Array) -> Parting | None:
    """Return the forbidden window of one joint that lies between `start` and `goal` (n,): whatever the other joints do, no motion gets past it."""
    limits = room.robot.limits
    for watch in room.watches:
        window = watch.zone.region
        if not isinstance(window, JointWindow) or watch.zone.rule != "forbidden":
            continue
        narrows = (window.lower > limits.lower) | (window.upper < limits.upper)
        if np.count_nonzero(narrows) != 1:
            continue
        joint = int(np.argmax(narrows))
        lower, upper = float(window.lower[joint]), float(window.upper[joint])
        low, high = sorted((float(start[joint]), float(goal[joint])))
        # a window without width, or with less than what is told apart, parts nothing
        if low <= lower and upper <= high and upper - lower > 4.0 * WINDOW_SLACK:
            return Parting(watch.zone.name, joint, lower, upper)
    return None


def _found(room: Room, start: Array, goal: Array, effort: Effort) -> Array | None:
    """The way-points (k, n) of a way; None where this effort isn't enough."""
    padding = room.padding(start, goal, effort.padding)
    reach = reaches(room.scene, room.robot)
    free = room.check(padding)
    if not (free(start) and free(goal)):
        return None
    out, in_ = ([Retreat(q[None])] for q in (start, goal))
    if effort.lines:
        out, in_ = (retreats(room, q, free, turns=effort.lines > 1) for q in (start, goal))
        if effort.is_for_lines and len(out) == len(in_) == 1:
            return None
    ends = [np.array([one.corners[-1] for one in side]) for side in (out, in_)]
    corners = polyline(Question(ends[0], ends[1], room.robot.limits, reach, free), effort)
    if corners is None:
        return None
    first, last = (
        next(one.corners for one in side if np.array_equal(one.corners[-1], end))
        for side, end in ((out, corners[0]), (in_, corners[-1]))
    )
    corners = np.concatenate((first[:-1], corners, last[-2::-1]))
    # what is proved needs less room than what is looked for
    kept = np.minimum(padding / 2.0, _PROVED)
    return smooth(Bend(room, room.check(kept), effort.step / reach, kept), corners)


def _straight(room: Room, start: Array, goal: Array) -> Obstruction | None:
    """What is in the straight way; None where it is proved to be free."""
    steps = np.abs(goal - start) * reaches(room.scene, room.robot)
    count = int(np.ceil(np.linalg.norm(steps) / _LOOK)) + 1
    places = start + np.linspace(0.0, 1.0, count + 1)[:, None] * (goal - start)
    blocked = [q for q in places if not room.is_free(q)]
    if blocked and (found := room.obstruction(blocked[len(blocked) // 2])) is not None:
        return found
    course = straight_course(start, goal)
    doubts = room.doubts(course)
    if not len(doubts):
        return None
    found = room.obstruction(course.at(doubts)[0])
    return Obstruction(("the arm", "what is around it"), 0.0) if found is None else found
