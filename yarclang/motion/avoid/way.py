"""Find a path from one joint position to another around obstacles: the straight line in joint space if it is
free, otherwise a smooth curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.avoid.backing import Retreat, retreats
from yarclang.motion.avoid.keeping import along_rules
from yarclang.motion.avoid.parting import Barrier, Parting, parting
from yarclang.motion.avoid.room import Obstruction, Room, reaches
from yarclang.motion.avoid.search import Apart, Effort, Question, polyline
from yarclang.motion.avoid.shorten import duration, shortened
from yarclang.motion.avoid.smooth import Bend, smooth, straight_course
from yarclang.motion.paths.spline import through
from yarclang.robot.kinematics import flange_poses
from yarclang.transforms import constant

EFFORTS = (
    Effort(0.02, 0.05, 500, 1),
    Effort(0.01, 0.03, 1_500, 5, lines=1),
    Effort(0.005, 0.02, 1_500, 6, lines=2, is_for_lines=True),
    Effort(0.003, 0.03, 3_000, 3),
    Effort(0.0005, 0.02, 3_000, 4, lines=2),
)
"""Searches that are made one after the other until one finds a path.

The first ones are fast and keep a distance from obstacles. The last ones are long and come close to
obstacles. Those with `lines` first draw the tool out of tight places at start and goal.
"""

OTHERS = EFFORTS[:2]
"""Searches for paths to the further inverse-kinematics solutions of a pose, if all searches for its first
solution have failed.

These two find nearly all paths that any search finds.
"""

QUICK = EFFORTS[:1]
"""Searches that are made if an earlier search for the same motion found nothing."""

_PROVED = 1e-3
"""Distance that the curve is proved to keep in addition to the margins [m]; less where bodies are close at
start or goal. The executed motion may deviate by this distance.
"""


_LOOK = 0.05
"""Approximate motion of bodies between two checked places of the straight line [m]."""


@frozen(eq=False)
class Way:
    """A path in joint space from a start to a goal.

    `waypoints` (k, n) [rad or m] don't include the start; the last one is the goal. A single waypoint means
    the straight line. With more waypoints, `between` is the obstruction on the straight line.
    """

    waypoints: Array
    between: Obstruction | None = None

    @property
    def is_straight(self) -> bool:
        """True if the path is the straight line in joint space."""
        return len(self.waypoints) == 1


@frozen(eq=False)
class NoWay:
    """The reason why no path in joint space was found.

    `start` and `goal` are the obstructions at start and goal. `parting` is a zone that certainly separates
    the two. If all three are None, a search of `tries` samples found nothing. Then `between` is the
    obstruction on the straight line, and `furthest` is the place nearest to the goal that the search reached.
    `has_corners` is True if a polyline was found, but no smooth curve along it was proved to be free.
    `is_cut` is True if the search ended early because there are many bodies.
    """

    start: Obstruction | None = None
    goal: Obstruction | None = None
    between: Obstruction | None = None
    parting: Parting | Barrier | None = None
    furthest: Furthest | None = None
    has_corners: bool = False
    tries: int = 0
    is_cut: bool = False


@frozen(eq=False)
class Furthest:
    """The place nearest to the goal that a failed search reached.

    At the joint position `q` (n,) [rad or m], the moving frame is `left` [m] from its position at the goal.
    `blocked` is the obstruction between this place and the goal.
    """

    q: Array
    left: float
    blocked: Obstruction


def find_way(
    room: Room | None,
    start: Array,
    goal: Array,
    efforts: tuple[Effort, ...] | None = None,
    searches: int = 1,
) -> Way | NoWay:
    """Find a path in joint space around obstacles. The same arguments always give the same result.

    Args:
        room: the surroundings of the arm; None if there are no obstacles.
        start: (n,) joint position at the start [rad or m], within limits.
        goal: (n,) joint position at the goal [rad or m], within limits.
        efforts: searches to make one after the other until one finds a path; None for all `EFFORTS`.
        searches: number of paths to find with the parameters of the successful search. Each is shortened in
            time, and the fastest is returned. With 1, the first path found is returned.
    """
    straight = Way(constant(goal[None].copy()))
    if room is None or np.array_equal(start, goal):
        return straight
    between = _straight(room, start, goal)
    if between is None:
        return straight
    # Before any search, look for quick answers: an obstruction at an end, or a zone that separates the ends.
    at_start, at_goal = room.obstruction(start), room.obstruction(goal)
    if at_start is not None or at_goal is not None:
        return NoWay(at_start, at_goal)
    parted = parting(room, start, goal)
    if parted is not None:
        return NoWay(between=between, parting=parted)
    apart: list[Apart] = []
    has_corners, tries = False, 0
    looks = _Looks(room, searches)
    for effort in EFFORTS if efforts is None else efforts:
        if looks.are_over():
            break
        # A search returns a polyline; only the smooth curve along it counts as a way.
        line = _found(room, start, goal, effort, looks)
        if isinstance(line, Apart):
            apart.append(line)
            tries += line.tries
        elif line is not None:
            tries += effort.samples
            ways = [] if (first := smooth(line.bend, line.corners)) is None else [first]
            if searches > 1:
                ways += _shorter(room, start, goal, line, effort, searches, looks)
            if ways:
                return Way(constant(min(ways, key=lambda one: _duration(room, start, one))), between)
            has_corners = True
    furthest = _furthest(room, min(apart, key=lambda one: one.left), goal) if apart else None
    return NoWay(
        between=between, furthest=furthest, has_corners=has_corners, tries=tries, is_cut=looks.are_over()
    )


class _Looks:
    """A budget of collision checks for one search. With more bodies, each check uses up more of the budget,
    so that every search ends after about the same time.
    """

    def __init__(self, room: Room, searches: int) -> None:
        self.left = float(MOST_LOOKS * searches)
        self.cost = 1.0 + (len(room.scene.bodies) / _MANY) ** 2

    def counted(self, free: Callable[[Array], bool]) -> Callable[[Array], bool]:
        """Return a function with the same results as `free`; each call uses up a part of the budget."""

        def look(q: Array) -> bool:
            self.left -= self.cost
            return free(q)

        return look

    def are_over(self) -> bool:
        """Return True if the budget is used up."""
        return self.left <= 0.0


MOST_LOOKS = 300_000
"""Budget of each search, counted in collision checks with few bodies; with many bodies, a check costs more.
Using up a budget takes about 5 s. With few bodies, all `EFFORTS` together need fewer checks than one budget.
"""

_MANY = 100.0
"""Number of bodies at which a check counts as two."""


@frozen(eq=False)
class _Corners:
    """A joint-space polyline, with the clearance that the curve made from it must keep.

    `corners` are (k, n) [rad or m]. `free` is a function that returns True for joint positions without
    collision, which are checked `step` (n,) apart [rad or m].
    """

    corners: Array
    bend: Bend
    free: Callable[[Array], bool]
    step: Array


def _shorter(
    room: Room, start: Array, goal: Array, first: _Corners, effort: Effort, searches: int, looks: _Looks
) -> Iterator[Array]:
    """Yield waypoints (k, n) of polylines shortened in time: those of the polyline `first`, then those of
    the polylines that further searches find.
    """
    for number in range(searches):
        again = replace(effort, seed=effort.seed + number * _NEXT)
        found = _found(room, start, goal, again, looks) if number else first
        if not isinstance(found, _Corners):
            continue
        velocity = room.robot.limits.velocity
        corners = shortened(found.corners, found.free, found.step, velocity, again.seed)
        waypoints = smooth(found.bend, corners)
        if waypoints is not None:
            yield waypoints


_NEXT = 100
"""Difference between the seeds of two searches with the same parameters."""


def _duration(room: Room, start: Array, waypoints: Array) -> float:
    path = through(np.concatenate((start[None], waypoints)), room.robot.chain.is_prismatic)
    return duration(path.spline, room.robot.limits)


def _found(room: Room, start: Array, goal: Array, effort: Effort, looks: _Looks) -> _Corners | Apart | None:
    """Search for a joint-space polyline around obstacles.

    Returns:
        The polyline. If the search fails, the joint positions at which its two trees came nearest to each
        other. None if no such search is possible: start or goal isn't free, or no straight line leads out of
        either.
    """
    padding = room.padding(start, goal, effort.padding)
    reach = reaches(room.scene, room.robot)
    free = looks.counted(room.check(padding))
    if not (free(start) and free(goal)):
        return None
    out, in_ = ([Retreat(q[None])] for q in (start, goal))
    if effort.lines:
        out, in_ = (retreats(room, q, free, turns=effort.lines > 1) for q in (start, goal))
        if effort.is_for_lines and len(out) == len(in_) == 1:
            return None
    ends = [np.array([one.corners[-1] for one in side]) for side in (out, in_)]
    question = Question(ends[0], ends[1], room.robot.limits, reach, free, looks.are_over)
    rules = room.rules
    corners = along_rules(room.scene, rules, question, effort) if rules else polyline(question, effort)
    if isinstance(corners, Apart):
        return corners
    first, last = (
        next(one.corners for one in side if np.array_equal(one.corners[-1], end))
        for side, end in ((out, corners[0]), (in_, corners[-1]))
    )
    corners = np.concatenate((first[:-1], corners, last[-2::-1]))
    # The proof needs less distance than the search keeps.
    kept = np.minimum(padding / 2.0, _PROVED)
    step = effort.step / reach
    return _Corners(corners, Bend(room, room.check(kept), step, kept), free, step)


def _furthest(room: Room, apart: Apart, goal: Array) -> Furthest:
    """Return the joint position at which a failed search came nearest to its goal, and the first obstruction
    on the way to the goal.
    """
    way = np.linspace(0.0, 1.0, _PLACES)[1:, None] * (apart.beyond - apart.q)
    places = apart.q + way
    # Bodies farther away than `_NEAR` are ignored. The search keeps more distance than required, so possibly
    # none of `places` violates a margin. Then the place with the least clearance counts as blocked.
    spare = room.clearances(places, _NEAR)
    blocked = np.flatnonzero(spare <= 0.0)
    at = int(blocked[0]) if len(blocked) else int(np.argmin(spare))
    poses = flange_poses(room.robot.chain, np.stack([apart.q, goal])) @ room.flange_from_moving
    left = float(np.linalg.norm(poses[1, :3, 3] - poses[0, :3, 3]))
    return Furthest(constant(apart.q.copy()), left, room.nearest(places[at]))


_PLACES = 129
"""Number of places that are examined between the two joint positions at which the trees of a failed search
came nearest to each other.
"""

_NEAR = 0.1
"""Clearance above which bodies are ignored [m]."""


def _straight(room: Room, start: Array, goal: Array) -> Obstruction | None:
    """Return the obstruction on the straight line in joint space; None if this line is proved to be free."""
    # Multiplied by lever arms, joint motions become approximate motions of bodies.
    steps = np.abs(goal - start) * reaches(room.scene, room.robot)
    count = int(np.ceil(np.linalg.norm(steps) / _LOOK)) + 1
    places = start + np.linspace(0.0, 1.0, count + 1)[:, None] * (goal - start)
    blocked = [q for q in places if not room.is_free(q)]
    if blocked and (obstruction := room.obstruction(blocked[len(blocked) // 2])) is not None:
        return obstruction
    # No sample is blocked: prove the line, or take the first doubt as the obstruction.
    course = straight_course(start, goal)
    doubts = room.doubts(course)
    if not len(doubts):
        return None
    obstruction = room.obstruction(course.at(doubts)[0])
    return Obstruction(("the arm", "what is around it"), 0.0) if obstruction is None else obstruction
