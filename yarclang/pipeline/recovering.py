"""Find a motion from any position of the robot to a program: to its start, or else to the nearest place at
which the program may begin and to which a motion is proved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from yarclang.cell.model import Cell, Parts, Present
from yarclang.collision.zones.watched import tool_frame
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.handling.present import around_start, presently
from yarclang.hir import Array, Gap, Origin
from yarclang.motion.avoid.room import room_of
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.parts import approach, beginning, can_begin_at, chains, parts_before
from yarclang.pipeline.returning import along_the_path
from yarclang.pipeline.stages import Compiled
from yarclang.robot.model import Robot

MOST_PLACES = 4
"""Number of places that are tried besides the start. It is small because a failed search for a path takes
seconds.
"""

_SAME = 1e-6
"""Largest difference of a joint between two positions that count as equal [rad or m]."""

NOT_RECOVERED = "Y1660"
"""Code of the finding that no proved motion leads from the robot's position to the program."""


@frozen(eq=False)
class Place:
    """A place at which a program may begin.

    Attributes:
        index: place of the command that begins there; empty for the start.
        title: title for people.
        line: source line of the command; 0 if there is none.
        there: (n,) position of the robot at this place [rad or m].
        number: number of the planned motion that begins there.
    """

    index: str
    title: str
    line: int
    there: Array
    number: int = 0


@frozen(eq=False)
class Recovery:
    """A place at which a program may begin, and the proved motion to it.

    Attributes:
        made: the motion; None if the robot is already there.
        cell: the cell of the proof, with its parts.
        assumed: names of the parts whose positions are unknown. They are assumed to be where the program has
            them when it begins at this place.
        refused: findings that state why the robot can't move to the program's start; empty if the place is
            the start.
    """

    place: Place
    made: Compiled | None
    cell: Cell | None = None
    assumed: tuple[str, ...] = ()
    refused: tuple[Diagnostic, ...] = ()


def recovery(
    robot: Robot,
    start: Place,
    position: Array,
    plan: MotionPlan | None,
    around: Callable[[Place], tuple[Cell | None, bool]],
    *,
    is_there: Callable[[Array], bool],
    nearest: bool = True,
) -> Result[Recovery]:
    """Find a place to which the robot can move: the start if a motion to it is proved, else the nearest place
    at which the program may begin.

    Args:
        robot: the robot.
        start: start of the program, or the place that the user named.
        position: position of the robot (n,) [rad or m].
        plan: plan of the program; None: only its start is known.
        around: function that takes a place, and returns the cell with its parts for the motion to this place,
            and True if the positions of these parts are known.
        is_there: function that returns True if the robot is at joint positions (n,) [rad or m].
        nearest: False if only `start` is wanted.

    Returns:
        The place and the motion to it; None, with a finding, if no motion is proved.
    """
    if (beyond := _beyond(robot, position)) is not None:
        return Result(None, (beyond,))
    position = np.clip(position, robot.limits.lower, robot.limits.upper)
    refused: tuple[Diagnostic, ...] = ()
    tried: list[Place] = []
    others = _others(plan, start, position, robot) if plan is not None and nearest else iter(())
    for place in (start, *others):
        cell, is_known = around(place)
        assumed = () if is_known or cell is None else tuple(one.body.name for one in cell.parts)
        if is_there(place.there):
            return Result(Recovery(place, None, cell, assumed, refused), ())
        made = _way(robot, place, position, plan, cell)
        if made.value is not None:
            return Result(Recovery(place, made.value, cell, assumed, refused), made.diagnostics)
        if not tried:
            refused = tuple(one for one in made.diagnostics if one.is_error)
        tried.append(place)
        if is_known and _is_blocked(robot, position, cell):
            break  # the robot is already in contact: no other place helps
    return Result(None, (_no_way(tried, refused), *refused))


def _beyond(robot: Robot, position: Array) -> Diagnostic | None:
    """Return a finding if a joint is outside its limits by more than `_SAME`."""
    excess = np.maximum(robot.limits.lower - position, position - robot.limits.upper)
    joint = int(np.argmax(excess))
    if excess[joint] <= _SAME:
        return None
    unit, scale = robot.axis_unit_names[joint], robot.axis_units[joint]
    lower, upper = robot.limits.lower[joint] / scale, robot.limits.upper[joint] / scale
    message = (
        f"{robot.joint_names[joint]} is at {position[joint] / scale:.4f} {unit}, "
        f"{excess[joint] / scale:.4f} {unit} beyond its limits {lower:g} to {upper:g}: no motion from "
        "there is proved"
    )
    return Diagnostic(NOT_RECOVERED, message, help="move this joint back by the controller's own jog, slowly")


def start_of(plan: MotionPlan | None, at_place: Array, step: int | None = None, number: int = 0) -> Place:
    """Return the place at which a program begins.

    Args:
        plan: plan of the program; None: unknown.
        at_place: position of the robot at that place (n,) [rad or m].
        step: number of the first step, if the user named one; else None.
        number: number of the first motion.
    """
    if plan is None or step is None:
        return Place("", "the start", 0, at_place)
    return _place(plan, step, at_place, number)


def parts_at(plan: MotionPlan | None, place: Place, first: Parts | None) -> Parts | None:
    """Return the places of the parts when a program begins at `place`: at the program's start as in `first`,
    elsewhere as the plan has them. None if the program's cell has no parts.
    """
    if plan is None or not place.number or not plan.motions:
        return first
    return parts_before(plan, plan.motions[place.number].step)


def _others(plan: MotionPlan, start: Place, position: Array, robot: Robot) -> Iterator[Place]:
    """Yield the places other than the start at which the program may begin, nearest first. The distance is
    the time that the slowest joint needs.

    Args:
        plan: plan of the program.
        start: start of the program.
        position: (n,) position of the robot [rad or m].
        robot: the robot.
    """
    if not plan.motions:
        return
    begins = [first for first, _ in chains(plan)]
    starts = np.array([plan.motions[first].curve.points[0] for first in begins])
    far = (np.abs(starts - position) / robot.limits.velocity).max(axis=1)
    positions = [start.there]
    for at in np.argsort(far, kind="stable").tolist():
        if len(positions) > MOST_PLACES:
            return
        number, q = begins[at], starts[at]
        if any(bool((np.abs(q - one) <= _SAME).all()) for one in positions):
            continue
        step = plan.motions[number].step
        index = _origin(plan, step).label
        found = beginning(plan, index) if index else None
        if found != (number, step) or not can_begin_at(plan, index):
            continue
        positions.append(q)
        yield _place(plan, step, q, number)


def _place(plan: MotionPlan, step: int, at_place: Array, number: int) -> Place:
    origin = _origin(plan, step)
    line = origin.span.line if origin.source is plan.program.source else 0
    return Place(origin.label, f"{origin.label} {origin.name}".strip(), line, at_place, number)


def _origin(plan: MotionPlan, number: int) -> Origin:
    step = plan.program.steps[number]
    assert not isinstance(step, Gap)  # a gap is never planned
    return step.origin


def _way(
    robot: Robot, place: Place, position: Array, plan: MotionPlan | None, cell: Cell | None
) -> Result[Compiled]:
    """Plan and prove a motion to a place at which the program may begin.

    If the robot was stopped beside a part, the motion follows the path on which it was stopped. Otherwise it
    is straight if this is possible, else around obstacles.

    Args:
        robot: the robot.
        place: the place.
        position: (n,) position of the robot [rad or m].
        plan: plan of the program; None: unknown.
        cell: the cell with its parts; None: there is none.
    """
    if plan is not None and plan.motions and place.index:
        now = cell.present.parts if cell is not None and cell.present is not None else None
        along = along_the_path(plan, place.number, position, now)
        if along is not None:
            return Result(along, ())
    watches = () if plan is None else plan.program.watches
    return approach(robot, position, place.there, cell, watches)


def _is_blocked(robot: Robot, position: Array, cell: Cell | None) -> bool:
    room = room_of(robot, around_start(cell), tool_frame(robot))
    return room is not None and room.obstruction(position) is not None


def around_place(cell: Cell | None, assumed: Parts | None) -> Cell | None:
    """Return a cell with its parts where they are when a program is at a place."""
    return cell if cell is None or assumed is None else presently(cell, Present(assumed))


def _no_way(tried: list[Place], refused: tuple[Diagnostic, ...]) -> Diagnostic:
    first = tried[0].title
    others = f" or to the {len(tried) - 1} nearest places of the program" if len(tried) > 2 else ""
    others = f" or to {tried[1].title}" if len(tried) == 2 else others
    why = f": {refused[0].message}" if refused else ""
    message = f"no motion from the robot's position to {first}{others} could be proved{why}"
    help_ = (
        "jog the robot away from the obstacles (yarc repl, or the pendant), and recover from there; or "
        "correct the cell.toml"
    )
    return Diagnostic(NOT_RECOVERED, message, help=help_)
