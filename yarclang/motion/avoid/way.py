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

The first ones are fast and keep a distance from obstacles; then the tool is drawn out of tight places at
start and goal; the last ones are long and come close to obstacles.
"""

OTHERS = EFFORTS[:2]
"""Searches for paths to further inverse-kinematics solutions of a pose, made after all searches for the first
solution.

These two find nearly all paths that any search finds.
"""

QUICK = EFFORTS[:1]
"""Searches for the path of a motion for which an earlier search found nothing."""

_PROVED = 1e-3
"""Largest distance beyond the margins that the curve is proved to keep [m]: the executed motion may deviate
by this distance.
"""


_LOOK = 0.05
"""Approximate motion of bodies between two places of the straight way that are checked [m]."""


@frozen(eq=False)
class Way:
    """A path in joint space from a start to a goal.

    `waypoints` (k, n) [rad or m] don't include the start; the last one is the goal. A single way-point means
    the straight line. Otherwise `between` is the obstruction in the straight line.
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

    `start` and `goal` are the obstructions at start and goal; `parting` is a zone that certainly separates
    the two. If all three are None, a search of `tries` samples found nothing: `between` is the obstruction in
    the straight line, and `furthest` is the place nearest to the goal that the search reached. `has_corners`
    is True if a polyline was found, but no curve along it was proved to be free. `is_cut` is True if the
    search ended early because there are many bodies.
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
    From there on, `blocked` is the obstruction.
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
            time, and the fastest is taken. With 1, the first path found is taken.
    """
    straight = Way(constant(goal[None].copy()))
    if room is None or np.array_equal(start, goal):
        return straight
    between = _straight(room, start, goal)
    if between is None:
        return straight
    # Cheap answers before any search: an obstruction at an end, or a zone that separates the ends.
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
        found = _found(room, start, goal, effort, looks)
        if isinstance(found, Apart):
            apart.append(found)
            tries += found.tries
        elif found is not None:
            tries += effort.samples
            ways = [] if (first := smooth(found.bend, found.corners)) is None else [first]
            if searches > 1:
                ways += _shorter(room, start, goal, found, effort, searches, looks)
            if ways:
                return Way(constant(min(ways, key=lambda one: _duration(room, start, one))), between)
            has_corners = True
    furthest = _furthest(room, min(apart, key=lambda one: one.left), goal) if apart else None
    return NoWay(
        between=between, furthest=furthest, has_corners=has_corners, tries=tries, is_cut=looks.are_over()
    )


class _Looks:
    """A budget of checks of joint positions.

    A check costs more among many bodies, so that every search ends after about the same time.
    """

    def __init__(self, room: Room, searches: int) -> None:
        self.left = float(MOST_LOOKS * searches)
        self.cost = 1.0 + (len(room.scene.bodies) / _MANY) ** 2

    def counted(self, free: Callable[[Array], bool]) -> Callable[[Array], bool]:
        """Return a function with the same results as `free`, which also counts how often it is called."""

        def look(q: Array) -> bool:
            self.left -= self.cost
            return free(q)

        return look

    def are_over(self) -> bool:
        """Return True if no checks are left."""
        return self.left <= 0.0


MOST_LOOKS = 300_000
"""Number of checks of joint positions for each search among few bodies: more than all efforts need, and about
5 s.
"""

_MANY = 100.0
"""Number of bodies at which a check takes twice as long."""


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
    """Yield way-points (k, n) of polylines shortened in time: of the first one, then of those that further
    searches find.
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
        The polyline; or the place at which the two search trees came nearest to each other; or None if the
        effort doesn't apply to this question.
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
    """Return the place at which a failed search came nearest to its goal, and the first obstruction between
    this place and the goal.
    """
    way = np.linspace(0.0, 1.0, _PLACES)[1:, None] * (apart.beyond - apart.q)
    places = apart.q + way
    # Only near bodies matter. Those that only the padding of the search excluded also count as in the way.
    spare = room.clearances(places, _NEAR)
    blocked = np.flatnonzero(spare <= 0.0)
    at = int(blocked[0]) if len(blocked) else int(np.argmin(spare))
    poses = flange_poses(room.robot.chain, np.stack([apart.q, goal])) @ room.flange_from_moving
    left = float(np.linalg.norm(poses[1, :3, 3] - poses[0, :3, 3]))
    return Furthest(constant(apart.q.copy()), left, room.nearest(places[at]))


_PLACES = 129
"""Number of places examined between the nearest place of a search and the place that it didn't reach."""

_NEAR = 0.1
"""Distance beyond their margins above which bodies are ignored [m]."""


def _straight(room: Room, start: Array, goal: Array) -> Obstruction | None:
    """Return the obstruction in the straight line in joint space; None if this line is proved to be free."""
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
