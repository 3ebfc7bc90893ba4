"""Lowering of a motion plan to a controller program: sequences of SPLINE1 moves. The controller adds its own
segments at both ends of a sequence.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from yarclang.backend_pmac.deciding import canonical
from yarclang.backend_pmac.decimals import decimals_for
from yarclang.backend_pmac.guard import guarded, watermarks
from yarclang.decisions import AGAIN, called, in_words
from yarclang.handling.allowing import permitted
from yarclang.handling.keeping import kept_to
from yarclang.hir import (
    Array,
    Assign,
    Dwell,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    Hold,
    Loop,
    Motion,
    NextPass,
    Say,
    SetOutput,
    Stop,
    WaitInput,
    WaitUntil,
    When,
    offsets_of,
    searches_of,
)
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.program import (
    Assignment,
    Barrier,
    Command,
    Item,
    Moves,
    PmacProgram,
    Rest,
    SegmentTime,
    Stand,
    Target,
)
from yarclang.robot.actuation import counts_per_joint, to_counts
from yarclang.robot.model import START_SHARE, Robot, Tolerance
from yarclang.units import MS
from yarclang.ways import Turn, Ways


def lower(plan: MotionPlan, target: Target, tolerance: Tolerance) -> PmacProgram:
    """Build the controller program of a motion plan.

    Args:
        plan: the plan.
        target: kind of the text, for a rotary buffer or for a program buffer.
        tolerance: tolerance of the path, which determines the number of decimals.
    """
    robot = plan.robot
    segments = [motion.curve.segment for motion in plan.motions]
    shortest = min(segments, default=robot.controller.largest_segment)
    # Shorter segments need more decimals, and so does a low speed that must be kept.
    steps = [(_kept_speed(plan, motion), motion.curve.segment) for motion in plan.motions]
    slowest = min(steps, key=lambda one: one[0] * one[1], default=None)
    needed = [] if slowest is None else [(np.inf, shortest), slowest]
    decimals = max((decimals_for(robot, segment, tolerance, speed) for speed, segment in needed), default=4)
    body = tuple(_body(plan, decimals))
    if target == "rotary":
        body, marks = guarded(body, robot, shortest)
    else:
        marks = watermarks(robot, shortest)
    first = segments[0] if segments else shortest
    # The motion begins at the start as printed, which is rounded.
    start = _printed(plan.program.start / robot.axis_units, decimals)
    unit = 32 * turbo_pmac(robot).ixx08
    return PmacProgram(
        target=target,
        coordinate_system=turbo_pmac(robot).coordinate_system,
        motors=robot.controller.motors,
        axes=robot.controller.axes,
        joint_names=robot.joint_names,
        decimals=decimals,
        start=start,
        start_counts=to_counts(robot, start * robot.axis_units) * unit,
        start_slack=_start_slack(robot, first) * unit,
        rotary_words=marks.words,
        full_lines=marks.full,
        low_lines=marks.low,
        body=body,
        commands=tuple(_commands(plan)),
        safe_outputs=tuple(
            (output.signal.variable, output.safe)
            for output in plan.program.outputs
            if output.safe is not None
        ),
        registers=plan.program.registers,
        watches=plan.program.watches,
        searches=searches_of(plan.program),
        offsets=offsets_of(plan.program),
        allows=permitted(plan.program),
        keeps=kept_to(plan.program),
    )


def _kept_speed(plan: MotionPlan, motion: PlannedMotion) -> float:
    """Return the flange speed that a motion must keep [m/s]; infinite if there is none.

    This is the least of three speeds: the motion's programmed speed, as far as it is reached; the motion's
    ceiling; and the speed of the cell's slowest zone.
    """
    step, cell = plan.program.steps[motion.step], plan.program.cell
    speed = step.timing.speed if isinstance(step, Motion) else None
    slow = min((zone.speed for zone in cell.zones if zone.speed), default=np.inf) if cell else np.inf
    if isinstance(step, Motion) and step.timing.ceiling is not None:
        slow = min(slow, step.timing.ceiling)
    return (
        slow
        if speed is None or speed.length is None
        else min(slow, speed.length * min(motion.kept, motion.least))
    )


def _commands(plan: MotionPlan) -> Iterator[Command]:
    overlaps = {motion.step: motion.overlap for motion in plan.motions}
    for number, step in enumerate(plan.program.steps):
        if isinstance(step, Gap):
            raise ValueError("a program with errors can't be lowered")
        origin = step.origin
        yield Command(
            number,
            origin.label or "-",
            origin.name,
            origin.span.line,
            overlaps.get(number),
            number in plan.any_jerk,
        )
        if isinstance(step, Stop):
            return


def _body(plan: MotionPlan, decimals: int) -> Iterator[Item]:
    """Yield the items of the program that follow its opening. After the opening, the robot is at the start,
    and the mode is SPLINE1.

    A sequence of moves ends with the program, at a dwell, and where the segment time changes. The controller
    adds an end segment there, and a start segment before the next sequence. A stop consists of three equal
    points. The last two of them are written only if the stop is inside a sequence, since the controller adds
    them at a sequence's end. After a motion that flows into the next one, outputs are set in step with the
    line whose segment begins in the middle of the overlap. This is the first line of the next motion.
    """
    steps, units = plan.program.steps, plan.robot.axis_units
    motions = {motion.step: motion for motion in plan.motions}
    lines = _lines(plan, decimals)
    written: float | None = None
    rests = True  # True if nothing has moved since the last dwell
    flows = False  # True if the last motion flows into the next one
    stands = plan.program.start
    ways = Ways(stands)
    for number, step in enumerate(steps):
        match step:
            case Stop():
                break
            case Dwell(duration=duration):
                yield Rest(duration / MS)
                rests, written = True, None
            case SetOutput(output=output, value=value) if flows:
                yield Assignment(output.variable, value, in_step=True)
            case SetOutput(output=output, value=value):
                if not rests:
                    yield Rest(0.0)
                rests, written = True, None
                yield Assignment(output.variable, value)
            case (
                WaitInput()
                | WaitUntil()
                | Hold()
                | Say()
                | When()
                | Else()
                | EndWhen()
                | Assign()
                | Finish()
                | Loop()
                | NextPass()
                | Exit()
                | EndLoop()
            ):
                if not rests:
                    yield Rest(0.0)
                yield _barrier(number, step)
                if isinstance(step, Turn):
                    ways = replace(ways, state=stands).turned(step, lambda _, last, __: last)
                    stands = ways.state
                yield Stand(_printed(stands / units, decimals))
                rests, written = True, None
            case _:
                motion = motions[number]
                curve = motion.curve
                if curve.segment != written:
                    written = curve.segment
                    yield SegmentTime(curve.segment / MS)
                flows = motion.flows
                following = motions.get(number + 1)
                ends = not flows and (following is None or following.curve.segment != curve.segment)
                yield Moves(number, lines[number][:-2] if ends else lines[number])
                rests, stands = False, curve.points[-1]


def _lines(plan: MotionPlan, decimals: int) -> dict[int, Array]:
    """Return the move lines that each motion has if it stops inside a sequence, by the motion's step. They
    are rounded in one call.
    """
    points = [motion.curve.points[3:] for motion in plan.motions]
    if not points:
        return {}
    printed = _printed(np.concatenate(points) / plan.robot.axis_units, decimals)
    stops = np.cumsum([len(one) for one in points]).tolist()
    return {
        motion.step: printed[stop - len(one) : stop]
        for motion, one, stop in zip(plan.motions, points, stops, strict=True)
    }


def _barrier(number: int, step: WaitInput | WaitUntil | Hold | Say | Assign | Turn) -> Barrier:
    label = step.origin.label or f"line {step.origin.span.line}"
    match step:
        case WaitInput(input=signal, value=value, timeout=timeout):
            return Barrier(number, "wait", signal.variable, value, timeout, signal.name, label)
        case WaitUntil(condition=condition, timeout=timeout):
            return Barrier(
                number,
                "wait",
                timeout=timeout,
                name=in_words(condition),
                label=label,
                condition=canonical(condition),
            )
        case When(condition=condition, again=again, within=within):
            told = f"{AGAIN if again else ''}{canonical(condition)}"
            return Barrier(
                number, "when", timeout=within, name=called(condition), label=label, condition=told
            )
        case Assign(target=target, value=value):
            name, into = (target, f"${target}") if isinstance(target, str) else (target.name, target.variable)
            name, told = f"{name} = {in_words(value)}", f"{into}:={canonical(value)}"
            return Barrier(number, "set", name=name, label=label, condition=told)
        case Say(text=text):
            return Barrier(number, "say", name=text, label=label)
        case Hold(text=text, register=register):
            return Barrier(
                number, "hold", name=text, label=label, condition=f"${register}" if register else ""
            )
        case Finish(fails=fails, text=text):
            return Barrier(number, "abort" if fails else "stop", name=text if fails else "", label=label)
        case Else():
            return Barrier(number, "else", label=label)
        case EndWhen():
            return Barrier(number, "end", label=label)
        case Loop():
            return Barrier(number, "loop", label=label)
        case NextPass():
            return Barrier(number, "next", label=label)
        case Exit():
            return Barrier(number, "exit", label=label)
        case EndLoop():
            return Barrier(number, "endloop", label=label)


def _printed(values: Array, decimals: int) -> Array:
    """Round control points to the printed decimals, and turn a negative zero into a positive one."""
    printed: Array = np.round(values, decimals) + 0.0
    return printed


def _start_slack(robot: Robot, segment: float) -> Array:
    """Compute how far each motor may be from the start when the motion begins [counts].

    Within this distance, the first segment needs additional acceleration of at most a small fraction of each
    joint's limit, `START_SHARE`.
    """
    # A joint that begins with a deviation d needs up to d / h^2 more acceleration in the first segment of
    # duration h.
    joints = START_SHARE * robot.limits.acceleration * segment**2
    matrix = counts_per_joint(robot)
    slack = np.abs(matrix) @ joints
    # With coupled motors, deviations add up: joint i is off by at most sum_k |(C^-1)_ik| slack_k, where C is
    # `matrix`. All slacks are scaled by one factor such that no joint exceeds its value in `joints`.
    share = (joints / (np.abs(np.linalg.inv(matrix)) @ slack)).min()
    allowed: Array = slack * share
    return allowed
