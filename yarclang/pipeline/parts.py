"""Plan the programs that a run needs besides the complete program: a part of the program, and the slow motion
to its start.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from yarclang.cell.model import Cell, Leaving, Parts
from yarclang.collision.zones.watched import tool_frame
from yarclang.decisions import Watch, only_holding
from yarclang.diagnostics import Diagnostic, Result
from yarclang.handling.allowing import allowances_of
from yarclang.handling.parts import first_parts
from yarclang.handling.present import around_start, is_same
from yarclang.handling.surroundings import without_parts
from yarclang.handling.walk import Followed, followed, handling_of
from yarclang.hir import (
    Array,
    Assign,
    Dwell,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Gap,
    Hold,
    JointGoal,
    JointMove,
    Loop,
    NextPass,
    Origin,
    Program,
    Say,
    SetOutput,
    SplineMove,
    Step,
    Timing,
    WaitInput,
    WaitUntil,
    When,
    searches_of,
)
from yarclang.motion.avoid.messages import inside, parted, tried
from yarclang.motion.avoid.room import room_of
from yarclang.motion.avoid.way import NoWay, Way, find_way
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.places import matching
from yarclang.pipeline.stages import Compiled, Request, certified, plan_program
from yarclang.robot.model import Robot
from yarclang.semantics.names.commands import DEFAULT_PROFILE
from yarclang.source import SourceFile, Span
from yarclang.ways import Turn

_PEAK = 1.5
"""Ratio of the largest speed to the mean speed of a motion with the default profile."""

_SHORTEST = 0.5
"""Shortest duration of an approach [s]."""


def approach(
    robot: Robot, position: Array, goal: Array, cell: Cell | None = None, watches: tuple[Watch, ...] = ()
) -> Result[Compiled]:
    """Plan and certify a motion of all joints from the robot's position to a goal. Its joint speeds are at
    most `rapid_share` of their limits.

    The motion is straight in joint space if this path is free; otherwise it goes around obstacles.

    Args:
        robot: the robot.
        position: (n,) position of the robot [rad or m].
        goal: (n,) goal [rad or m].
        cell: surroundings of the robot, with the parts where they are when a program starts.
        watches: inputs that hold the motion, such as those of the program that follows.

    Returns:
        The motion as a compiled program; None, with a finding, if there is no such motion.
    """
    cell = around_start(cell)
    way = find_way(room_of(robot, cell, tool_frame(robot)), position, goal)
    if isinstance(way, NoWay):
        source = SourceFile("<approach>", "")
        return Result(None, (Diagnostic("Y0926", _reason(robot, way), source, None, _BY_HAND),))
    if not way.is_straight:
        return _round(robot, position, way, cell, watches)
    far = np.abs(goal - position)
    limits, share = robot.limits, robot.controller.rapid_share
    by_speed = _PEAK * far / (limits.velocity * share)
    by_acceleration = np.sqrt(4.5 * far / (limits.acceleration * share))
    duration = float(np.ceil(max(_SHORTEST, by_speed.max(), by_acceleration.max()) * 20.0) / 20.0)
    while True:
        source, origin = _line(robot, f"MOVEJ_{DEFAULT_PROFILE}", [goal], f"{duration:g}")
        move = JointMove(origin, JointGoal(goal), DEFAULT_PROFILE, Timing(duration))
        program = Program(source, position, (move,), cell=cell, watches=only_holding(watches))
        made = compiled_part(program, Request(robot))
        if made.value is None or _fastest(made.value, limits.velocity) <= share * (1.0 + 1e-9):
            return made
        # The ramps of the executed motion consist of whole segments. Its largest speed can therefore be a
        # little higher than the computed one: try again with a longer duration.
        duration += 0.05


def _fastest(compiled: Compiled, allowed: Array) -> float:
    """Return an upper bound on the joint speeds of a program, as a share of the allowed speeds `allowed` (n,)
    [rad/s or m/s]: the largest share of any joint.
    """
    shares = [
        np.abs(np.diff(one.curve.points, axis=0)) / one.curve.segment / allowed
        for one in compiled.plan.motions
        if len(one.curve.points) > 1
    ]
    return max((float(one.max()) for one in shares), default=0.0)


def _round(
    robot: Robot, position: Array, way: Way, cell: Cell | None, watches: tuple[Watch, ...]
) -> Result[Compiled]:
    share = robot.controller.rapid_share
    points = list(way.waypoints)
    source, origin = _line(robot, f"MOVEJ_SPLINE_{DEFAULT_PROFILE}", points, f"{100.0 * share:g}%")
    goals = tuple(JointGoal(q) for q in points)
    move = SplineMove(origin, goals, DEFAULT_PROFILE, Timing(None, share=share))
    made = compiled_part(
        Program(source, position, (move,), cell=cell, watches=only_holding(watches)), Request(robot)
    )
    # Drop notes: nobody has written this command, so nobody can change it.
    return Result(made.value, tuple(one for one in made.diagnostics if one.is_error))


def _line(robot: Robot, name: str, points: list[Array], time: str) -> tuple[SourceFile, Origin]:
    """Return the source of a program that only approaches a start, and the origin of its single command."""
    values = "; ".join(" ".join(f"{value:.6g}" for value in q / robot.axis_units) for q in points)
    text = f"P0001 {name} {values} [{time}] (deg,s)"
    source = SourceFile("<approach>", text)
    return source, Origin("P0001", name, source, Span.on_line(1, 1, len(text) + 1))


def _reason(robot: Robot, way: NoWay) -> str:
    if way.start is not None:
        return f"no path can begin at the robot's position: {inside(way.start)}"
    if way.goal is not None:
        return f"no path can end at the program's start: there, {inside(way.goal)}"
    if way.parting is not None:
        return (
            f"no path exists from the robot's position to the program's start: {parted(robot, way.parting)}"
        )
    return f"no free path from the robot's position to the program's start was found {tried(robot, way)}"


_BY_HAND = (
    "jog the robot slowly away from the obstacles (yarc repl), or correct the cell.toml or the program's "
    "start"
)


def part(
    plan: MotionPlan,
    request: Request,
    first: int,
    last: int | None = None,
    *,
    with_lead: bool = True,
    since: tuple[int, int, Cell] | None = None,
    step: int | None = None,
) -> Result[Compiled]:
    """Compile a part of a plan as a separate program.

    Steps between two motions belong to the first of these motions. Steps before the plan's first motion, such
    as a WAIT, belong to this motion or to none (`with_lead`).

    Args:
        plan: the plan.
        request: settings for compiling the part.
        first: number of the first motion.
        last: number after the last motion; None: to the end of the plan.
        with_lead: True if the steps before the first motion belong to the part.
        since: known state from which the places of the cell's parts are computed, as a tuple: the number of a
            motion, at whose start the robot is; the number of a step before this motion; and the cell, with
            its parts where they are before this step. None: the places are computed from the beginning of the
            plan.
        step: number of the step with which the part of the plan begins, while the robot is at the start of
            motion `first`; None: as `with_lead` says.

    Returns:
        The compiled program. None, with a finding, if the part of the plan would begin or end between blended
        motions, or inside a WHEN or loop.
    """
    motion = plan.motions[first]
    steps = plan.program.steps
    for number in (first, last):
        if (
            number is not None
            and number < len(plan.motions)
            and (begin := chain_begin(plan, number)) != number
        ):
            return Result(None, (_in_a_chain(plan, number, begin),))
    begin, end = steps_of(plan, first, last, with_lead=with_lead, step=step)
    chosen = steps[begin:end]
    if _cut_way(chosen) is not None:
        inside = _outermost_open(steps, begin) or _outermost_open(steps, end)
        assert inside is not None  # the WHEN or loop is cut at the beginning or at the end
        word = "CASE" if inside.origin.name == "OF" else inside.origin.name
        if isinstance(inside, Loop):
            message = f"a program can't begin or pause inside a {word}: its passes aren't counted from there"
        else:
            message = f"a program can't begin or pause inside a {word}: the branch to take isn't known"
        help_ = f"begin before the {word}, or after its END"
        return Result(None, (Diagnostic("Y1164", message, plan.program.source, inside.origin.span, help_),))
    program = replace(plan.program, start=motion.curve.points[0], steps=chosen)
    around = _cells(plan) if since is None else _cells_since(plan, *since)
    if around is not None and plan.program.cell is not None:
        # Take the places of parts from the whole plan, since they depend on all earlier steps.
        cells = {step - begin: cell for step, cell in around.items() if begin <= step < end}
        program = replace(program, cell=without_parts(plan.program.cell), cells=cells)
    return compiled_part(program, request)


def steps_of(
    plan: MotionPlan, first: int, last: int | None = None, *, with_lead: bool = True, step: int | None = None
) -> tuple[int, int]:
    """Return the range of steps that belong to the motions from `first` up to, but not including, `last`: the
    number of the first step, and the number after the last. Steps between motions are assigned as by `part`.
    """
    steps = plan.program.steps
    end = len(steps) if last is None or last >= len(plan.motions) else plan.motions[last].step
    begin = 0 if first == 0 and with_lead else plan.motions[first].step
    return begin if step is None else step, end


def parts_before(plan: MotionPlan, step: int) -> Parts | None:
    """Return the places of the parts before a step of a plan; None if its cell has no parts."""
    whole = followed_plan(plan)
    if whole is None or plan.program.cell is None or not plan.program.cell.parts:
        return None
    if step in whole.before:
        return whole.before[step]
    earlier = [parts for at, parts in whole.changes if at < step]
    return earlier[-1] if earlier else first_parts(plan.program.cell)


def leaving_before(plan: MotionPlan, step: int, now: Parts) -> tuple[Leaving, ...]:
    """Return the gripper that moves away, during a motion, from parts that it has just taken or put down.

    Args:
        plan: the plan.
        step: number of the motion's step.
        now: current places of the parts.

    Returns:
        An empty tuple if there is no such gripper, or if these parts aren't where the plan has them.
    """
    whole, parts_of_steps = followed_plan(plan), parts_before(plan, step)
    handling = handling_of(plan.robot, plan.program.cell, plan.program.steps)
    leads = handling.runs.away.get(step, ())
    grasps = () if whole is None else tuple(whole.grasps.get(one.to) for one in leads)
    grasp = grasps[0] if grasps and None not in grasps else None
    if grasp is None or parts_of_steps is None:
        return ()
    meant, known = ({one.name: one for one in parts.items} for parts in (parts_of_steps, now))
    same = all(name in known and is_same(known[name], meant[name]) for name in grasp.moved)
    return (handling.leaving(grasp),) if same else ()


@lru_cache(maxsize=4)
def followed_plan(plan: MotionPlan) -> Followed | None:
    """Compute from a plan where each part is at each step; None if the cell has no parts and no motion allows
    bodies to touch.
    """
    handling = handling_of(plan.robot, plan.program.cell, plan.program.steps)
    if not handling.is_needed:
        return None
    return followed(handling, plan.program.start, ends_of(plan))


def _cells(plan: MotionPlan) -> Mapping[int, Cell | None] | None:
    whole = followed_plan(plan)
    return None if whole is None else whole.cells


def _cells_since(plan: MotionPlan, number: int, step: int, cell: Cell) -> Mapping[int, Cell | None] | None:
    """Return the cell during each motion from motion `number` on, by the number of the motion's step. `cell`
    has the parts where they are before step `step`, which comes before that motion.
    """
    allowed = {at - step: one for at, one in allowances_of(plan.program).items() if at >= step}
    handling = handling_of(plan.robot, cell, plan.program.steps[step:], allowed)
    if not handling.is_needed:
        return None
    ends = {at - step: q for at, q in ends_of(plan).items() if at >= step}
    found = followed(handling, plan.motions[number].curve.points[0], ends)
    return {at + step: one for at, one in found.cells.items()}


def ends_of(plan: MotionPlan) -> dict[int, Array]:
    """Return the joint position (n,) [rad or m] at the end of each motion, by the number of its step."""
    return {
        motion.step: motion.curve.sample(np.array([motion.curve.duration]))[0][0] for motion in plan.motions
    }


def _cut_way(steps: tuple[Step, ...]) -> Turn | None:
    """Return the first step of a WHEN or loop that isn't completely contained in these steps; None if there
    is none.
    """
    opened: list[Turn] = []
    for step in steps:
        match step:
            case When() | Loop():
                opened.append(step)
            case Else() | EndWhen() | EndLoop() if not opened:
                return step
            case NextPass() | Exit() if not any(isinstance(one, Loop) for one in opened):
                return step
            case EndWhen() | EndLoop():
                opened.pop()
    return opened[0] if opened else None


def _outermost_open(steps: tuple[Step, ...], at: int) -> Turn | None:
    """Return the first step of the outermost WHEN, CASE or loop around the step `at`; None if there is
    none.
    """
    opened: list[Turn] = []
    for step in steps[:at]:
        if isinstance(step, When | Loop):
            opened.append(step)
        elif isinstance(step, EndWhen | EndLoop) and opened:
            opened.pop()
    return opened[0] if opened else None


def chain_begin(plan: MotionPlan, number: int) -> int:
    """Return the number of the motion from which a program must begin to execute motion `number`: the last
    motion, up to and including motion `number`, that the robot begins from rest. Usually this is `number`
    itself.

    A motion after a search doesn't count, because the position at which the search ends is known only at run
    time.
    """
    searches = {one.step for one in searches_of(plan.program)}
    while number and (plan.motions[number - 1].flows or plan.motions[number - 1].step in searches):
        number -= 1
    return number


def chains(plan: MotionPlan, first: int = 0) -> list[tuple[int, int]]:
    """Group the motions from `first` on, so that the robot is at rest before each group, and a program can
    begin there.

    The motions of a WHEN, a CASE or a loop belong to one group with the motion before it.

    Returns:
        For each group, the numbers of its first motion and of the first motion after the group.
    """
    flows = [motion.flows for motion in plan.motions]
    inside = _in_ways(plan.program.steps)
    searches = {one.step for one in searches_of(plan.program)}
    # No program begins with the motion after a search, which starts wherever the search has ended.
    searched = [motion.step in searches for motion in plan.motions]
    begins = [
        number
        for number in range(first, len(plan.motions))
        if number == first
        or not (flows[number - 1] or searched[number - 1] or inside[plan.motions[number].step])
    ]
    return list(zip(begins, [*begins[1:], len(plan.motions)], strict=True))


def _in_ways(steps: tuple[Step, ...]) -> list[bool]:
    """Return for each step True if it is inside a WHEN or a loop."""
    depth, found = 0, []
    for step in steps:
        found.append(depth > 0)
        depth += isinstance(step, When | Loop) - isinstance(step, EndWhen | EndLoop)
    return found


def chain_place(plan: MotionPlan, place: str) -> str:
    """Return the place of the motion from which a program must begin to execute the motion at `place`: the
    last motion, up to and including this one, that the robot begins from rest. Usually this is `place`
    itself.
    """
    number = motion_number(plan, place)
    return place if isinstance(number, Diagnostic) else _origin(plan, chain_begin(plan, number)).label


def _in_a_chain(plan: MotionPlan, number: int, begin: int) -> Diagnostic:
    """Return the finding that a program can't begin with motion `number`; its help suggests motion `begin`
    instead.
    """
    origin, first = _origin(plan, number), _origin(plan, begin)
    before = _origin(plan, number - 1)
    if plan.motions[number - 1].flows:
        message = (
            f"{_called(before)} flows into {_called(origin)}: the robot doesn't stop between them, so a "
            "run can't begin there"
        )
    else:
        message = (
            f"{_called(origin)} begins where {_called(before)} ended, a place that is known only in the "
            "run that found it"
        )
    flows = plan.motions[number - 1].flows
    help_ = f"begin with {_called(first)}{', where the chain begins' * flows}"
    if first.label:
        help_ += (
            f": --from '{first.label}'"
            if ">" in first.label or "(" in first.label
            else f": --from {first.label}"
        )
    return Diagnostic("Y1608", message, origin.source, origin.span, help_)


def _called(origin: Origin) -> str:
    return f"{origin.label} {origin.name}".strip()


def _origin(plan: MotionPlan, number: int) -> Origin:
    return _step_origin(plan, plan.motions[number].step)


def _step_origin(plan: MotionPlan, at: int) -> Origin:
    step = plan.program.steps[at]
    assert not isinstance(step, Gap)  # a gap is never planned
    return step.origin


def beginning(plan: MotionPlan, place: str) -> tuple[int, int] | Diagnostic:
    """Find the motion and the step with which a program begins if it is started at a given command.

    Args:
        plan: the plan.
        place: place of a motion, or of a WAIT, SET, HOLD or DWELL, during which the robot is at rest.

    Returns:
        The number of the first motion, and the number of the first step; a finding if no motion follows the
        command.
    """
    steps = plan.program.steps
    moves = {motion.step for motion in plan.motions}
    labels = {
        at: step.origin.label
        for at, step in enumerate(steps)
        if not isinstance(step, Gap)
        and (at in moves or isinstance(step, WaitInput | WaitUntil | Say | SetOutput | Assign | Hold | Dwell))
    }
    found = matching(labels, place)
    if not found:
        number = motion_number(plan, place)
        return number if isinstance(number, Diagnostic) else (number, plan.motions[number].step)
    at = found[0]
    behind = next((one for one, motion in enumerate(plan.motions) if motion.step >= at), None)
    if behind is not None:
        return behind, at
    message = f"{place} isn't a motion, and no motion follows it"
    last = f"the last motion is {_called(_origin(plan, len(plan.motions) - 1))}" if plan.motions else ""
    return Diagnostic("Y1164", message, plan.program.source, _step_origin(plan, at).span, help=last)


def can_begin_at(plan: MotionPlan, place: str) -> bool:
    """Return True if a program can begin at a place: the robot is at rest there, and no WHEN or loop is
    cut.
    """
    found = beginning(plan, place)
    if isinstance(found, Diagnostic):
        return False
    number, step = found
    return chain_begin(plan, number) == number and _cut_way(plan.program.steps[step:]) is None


def stands_for(plan: MotionPlan, first: int, step: int) -> float:
    """Return the total time of the DWELLs from a step up to a motion [s].

    Args:
        plan: the plan.
        first: number of the motion.
        step: number of the first step whose DWELL counts.
    """
    between = plan.program.steps[step : plan.motions[first].step]
    return sum(one.duration for one in between if isinstance(one, Dwell))


def motion_number(plan: MotionPlan, place: str) -> int | Diagnostic:
    """Return the number of the first motion at a place. The place is an index such as P0010, or an index with
    the calls and loops around it, as a run reports it.

    Returns:
        A finding that lists the existing places, if there is no such motion.
    """
    labels = {number: _origin(plan, number).label for number in range(len(plan.motions))}
    if found := matching(labels, place):
        return found[0]
    named = [name for name in labels.values() if name]
    shown = ", ".join(named[:8]) + (", ..." if len(named) > 8 else "")
    message = f"no motion has the index {place}" if ">" not in place else f"no motion is at {place}"
    return Diagnostic(
        "Y1164",
        message,
        plan.program.source,
        help=f"the indexes are {shown}" if shown else "no motion has an index",
    )


def compiled_part(program: Program, request: Request) -> Result[Compiled]:
    """Plan and certify a program that is a part of another program, or a motion to the start of another
    program.
    """
    planned = plan_program(program, request)
    if planned.value is None:
        return Result(None, planned.diagnostics)
    made = certified(planned.value, request)
    return Result(made.value, (*planned.diagnostics, *made.diagnostics))
