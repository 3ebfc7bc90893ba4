"""Programs that a run needs besides the one that was written: a part of it, and the slow way to a start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.collision.zones.watched import tool_frame
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import (
    Array,
    Else,
    EndWhen,
    Gap,
    JointGoal,
    JointMove,
    Origin,
    Program,
    SplineMove,
    Step,
    Timing,
    When,
)
from yarclang.motion.avoid.messages import inside
from yarclang.motion.avoid.room import room_of
from yarclang.motion.avoid.way import SAMPLES, NoWay, Way, find_way
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.places import matching
from yarclang.pipeline.stages import Compiled, Request, certified, plan_program
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span

_PEAK = 1.5
"""Largest speed of an LSPB motion over its mean."""

_SHORTEST = 0.5
"""No approach is quicker [s]."""


def approach(robot: Robot, here: Array, there: Array, cell: Cell | None = None) -> Result[Compiled]:
    """A certified motion of all joints at the robot's rapid share of its limits: straight where that is free, else a way round.

    Args:
        robot: whose.
        here: (n,) where it stands [rad or m].
        there: (n,) where it shall go [rad or m].
        cell: what is around.

    Returns:
        A finding instead, where there is no way.
    """
    way = find_way(room_of(robot, cell, tool_frame(robot)), here, there)
    if isinstance(way, NoWay):
        source = SourceFile("<approach>", "")
        return Result(None, (Diagnostic("Y0926", f"{_why(way)}", source, None, _BY_HAND),))
    if not way.is_straight:
        return _round(robot, here, way, cell)
    far = np.abs(there - here)
    limits, share = robot.limits, robot.controller.rapid_share
    by_speed = _PEAK * far / (limits.velocity * share)
    by_acceleration = np.sqrt(4.5 * far / (limits.acceleration * share))
    duration = float(np.ceil(max(_SHORTEST, by_speed.max(), by_acceleration.max()) * 20.0) / 20.0)
    source, origin = _line(robot, "MOVEJ_LSPB", [there], f"{duration:g}")
    move = JointMove(origin, JointGoal(there), "LSPB", Timing(duration))
    return _compiled(Program(source, here, (move,), cell=cell), Request(robot))


def _round(robot: Robot, here: Array, way: Way, cell: Cell | None) -> Result[Compiled]:
    share = robot.controller.rapid_share
    points = list(way.waypoints)
    source, origin = _line(robot, "MOVEJ_SPLINE_LSPB", points, f"{100.0 * share:g}%")
    goals = tuple(JointGoal(q) for q in points)
    move = SplineMove(origin, goals, "LSPB", Timing(None, share=share))
    made = _compiled(Program(source, here, (move,), cell=cell), Request(robot))
    # how it swings is worth a note only of what somebody has written
    return Result(made.value, tuple(one for one in made.diagnostics if one.is_error))


def _line(robot: Robot, name: str, points: list[Array], time: str) -> tuple[SourceFile, Origin]:
    """The one command of an approach, as it would be written."""
    values = "; ".join(" ".join(f"{value:.6g}" for value in q / robot.axis_units) for q in points)
    text = f"P0001 {name} {values} [{time}] (deg,s)"
    source = SourceFile("<approach>", text)
    return source, Origin("P0001", name, source, Span.on_line(1, 1, len(text) + 1))


def _why(way: NoWay) -> str:
    if way.start is not None:
        return f"the robot can't leave from where it stands: {inside(way.start)}"
    if way.goal is not None:
        return f"the robot can't go to the start: there, {inside(way.goal)}"
    between = f"; on the straight way {inside(way.between)}" if way.between is not None else ""
    return f"no way from where the robot stands to the start was found, after {SAMPLES:,} samples{between}"


_BY_HAND = "move the robot into the open by hand, slowly (yarc repl jogs it); or correct the cell.toml, or where the program starts"


def part(
    plan: MotionPlan, request: Request, first: int, last: int | None = None, *, with_lead: bool = True
) -> Result[Compiled]:
    """The motions number `first` to `last` (not included; None: to the end) of a plan, as a program of their own.

    What stands between two motions belongs to the first of them. What stands in front of them all, such as a WAIT, belongs to the
    first motion, or to none (`with_lead`).

    Returns:
        A finding instead, where a part would cut motions that flow into each other, or a WHEN.
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
    end = len(steps) if last is None or last >= len(plan.motions) else plan.motions[last].step
    begin = 0 if first == 0 and with_lead else motion.step
    chosen = steps[begin:end]
    if (inside := _cut_way(chosen)) is not None:
        message = "a program can't be begun or paused inside a WHEN: which way is taken isn't known"
        help_ = "begin in front of the WHEN, or behind its END"
        return Result(None, (Diagnostic("Y1164", message, plan.program.source, inside.origin.span, help_),))
    program = replace(plan.program, start=motion.curve.points[0], steps=chosen)
    return _compiled(program, request)


def _cut_way(steps: tuple[Step, ...]) -> When | Else | EndWhen | None:
    """The first part of a WHEN whose other parts aren't there."""
    opened: list[When] = []
    for step in steps:
        match step:
            case When():
                opened.append(step)
            case Else() if not opened:
                return step
            case EndWhen() if not opened:
                return step
            case EndWhen():
                opened.pop()
    return opened[0] if opened else None


def chain_begin(plan: MotionPlan, number: int) -> int:
    """The number of the motion with which the robot starts from rest to get to motion `number` without a stop: mostly itself."""
    while number and plan.motions[number - 1].overlap:
        number -= 1
    return number


def chains(plan: MotionPlan, first: int = 0) -> list[tuple[int, int]]:
    """The motions from number `first` on in groups: in front of each the robot stands, and within it doesn't.

    Returns:
        The first number of each group, and that behind its last.
    """
    flows = [motion.overlap > 0 for motion in plan.motions]
    begins = [
        number for number in range(first, len(plan.motions)) if number == first or not flows[number - 1]
    ]
    return list(zip(begins, [*begins[1:], len(plan.motions)], strict=True))


def chain_place(plan: MotionPlan, place: str) -> str:
    """The place of the motion from which the robot gets to that at a place without a stop: mostly the same."""
    number = motion_number(plan, place)
    return place if isinstance(number, Diagnostic) else _origin(plan, chain_begin(plan, number)).label


def _in_a_chain(plan: MotionPlan, number: int, begin: int) -> Diagnostic:
    """Why motion `number` is no beginning, and that the one numbered `begin` is."""
    origin, first = _origin(plan, number), _origin(plan, begin)
    before = _origin(plan, number - 1)
    message = f"{_called(before)} flows into {_called(origin)}: the robot doesn't stand between them, so a run can't begin there"
    help_ = f"begin with {_called(first)}, where the chain begins"
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
    step = plan.program.steps[plan.motions[number].step]
    assert not isinstance(step, Gap)  # a gap is never planned
    return step.origin


def motion_number(plan: MotionPlan, place: str) -> int | Diagnostic:
    """The number of the motion at a place: an index such as P0010, or what leads to it among loops and calls, as a run tells it.
    Of several, the first.

    Returns:
        A finding that says which there are, where there is none.
    """
    labels = {number: _origin(plan, number).label for number in range(len(plan.motions))}
    if found := matching(labels, place):
        return found[0]
    named = [name for name in labels.values() if name]
    shown = ", ".join(named[:8]) + (", ..." if len(named) > 8 else "")
    message = f"no motion has the index {place}" if ">" not in place else f"no motion stands at {place}"
    return Diagnostic(
        "Y1164", message, plan.program.source, help=f"there are {shown}" if shown else "no motion has one"
    )


def _compiled(program: Program, request: Request) -> Result[Compiled]:
    planned = plan_program(program, request)
    if planned.value is None:
        return Result(None, planned.diagnostics)
    made = certified(planned.value, request)
    return Result(made.value, (*planned.diagnostics, *made.diagnostics))
