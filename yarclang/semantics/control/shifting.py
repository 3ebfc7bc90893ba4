"""Read OFFSET, whose lines are carried out in a frame that registers shift at run time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.cell.model import Cell
from yarclang.decisions import SHIFTS, Register
from yarclang.diagnostics import Collector, Diagnostic
from yarclang.hir import (
    ArcMove,
    Assign,
    AvoidMove,
    Dwell,
    FrameLink,
    Gap,
    Goal,
    Hold,
    JointDelta,
    JointMove,
    LineMove,
    Motion,
    Offset,
    PoseDelta,
    PoseGoal,
    PoseSplineMove,
    Say,
    SetOutput,
    SplineMove,
    Step,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.semantics.files import values_of
from yarclang.semantics.names.frames import known_frame
from yarclang.semantics.names.scope import BASE, KINDS, Frame, Scope
from yarclang.semantics.parts import refuse_parts
from yarclang.subjects import Name, unknown
from yarclang.syntax.ast import Statement, Word
from yarclang.words.registry import word_specs

_Standing = SetOutput | Dwell | WaitInput | WaitUntil | Hold | Say | Assign
"""Steps that are allowed in an OFFSET and don't move the robot."""

_REFUSED = ("a motion time", "units", "a base frame", "options")


def offset_of(
    head: Statement, scope: Scope, cell: Cell | None, flag: str, findings: Collector
) -> Offset | None:
    """Read a line such as OFFSET {PART} X DX Y DY RZ TURN.

    Args:
        head: the line.
        scope: the names in scope at this line.
        cell: the cell around the robot.
        flag: register that becomes 1 if the lines of the OFFSET can be carried out.
        findings: receives the findings.

    Returns:
        None with a finding if the line is wrong.
    """
    before = len(findings.found)
    refuse_parts(head, _REFUSED, findings)
    spec = word_specs()["OFFSET"]
    if head.moving is None:
        message, help_ = "OFFSET has no frame to shift", f"for example {spec.example}"
        findings.add("Y0302", message, head.head_span, help_)
        return None
    frame = known_frame(head, head.moving, scope, findings)
    if frame is not None and (fault := _cannot_shift(frame)):
        message = f"{head.moving.text} {fault}"
        help_ = "declare a frame at the place of the part: FRAME {PART} 500 800 200 0 0 0 (mm,deg) {B}"
        findings.add("Y0476", message, head.span(head.moving.place), help_, subject=Name(head.moving.name))
        frame = None
    registers = _registers(head, scope, findings)
    if frame is None or frame.link is None or registers is None:
        return None
    if any(one.is_error for one in findings.found[before:]):
        return None
    lying = _parts_in(frame, cell)
    return Offset(frame.link.name, frame.transform, registers, flag, lying, frame.link)


def _cannot_shift(frame: Frame) -> str:
    """Return the reason why a frame can't be shifted; empty if it can."""
    if frame.on_flange:
        return "moves with the robot: only a frame fixed in the cell can be shifted"
    if frame.link is None or frame.link.name == BASE or frame.link.parent is None:
        return "is the base of the robot: it can't be shifted"
    return ""


def _registers(head: Statement, scope: Scope, findings: Collector) -> tuple[str, ...] | None:
    """Return for each axis in `SHIFTS` the name of the register by which an OFFSET shifts along or about this
    axis; empty for an axis that the OFFSET doesn't name. None with a finding if the line is wrong.
    """
    values = values_of(head)
    spec = word_specs()["OFFSET"]
    if not values or len(values) % 2 or not all(isinstance(one, Word) for one in values):
        message, help_ = f"OFFSET needs {spec.wants}", f"for example {spec.example}"
        findings.add("Y0401", message, head.whole_span, help_)
        return None
    found: dict[str, str] = {}
    words = [one for one in values if isinstance(one, Word)]
    for axis, word in zip(words[::2], words[1::2], strict=True):
        if axis.name not in SHIFTS or axis.name in found:
            message = (
                f"{axis.text} is given twice" if axis.name in found else f"OFFSET can't shift by {axis.text}"
            )
            findings.add("Y0476", message, head.span(axis.place), f"OFFSET takes {', '.join(SHIFTS)}")
            return None
        register = scope.name(word.name)
        span = head.span(word.place)
        if not isinstance(register, Register):
            if register is not None:
                findings.add("Y0209", f"{word.text} is {KINDS[type(register)]}, not a register", span)
                return None
            subject = unknown(word.text, scope.names(Register))
            unit = "0.01 deg" if axis.name == "RZ" else "0.01 mm"
            help_ = subject.question or f"declare it: REGISTER {word.name} -2000..2000 0 OUTSIDE, in {unit}"
            findings.add("Y0210", f"no register is named {word.text}", span, help_, subject=subject)
            return None
        if not register.low <= 0 <= register.high:
            message = (
                f"{word.text} is from {register.low} to {register.high}, and doesn't include 0, the "
                "unshifted place"
            )
            findings.add("Y0476", message, span, "declare a range that includes 0")
            return None
        if register.name in found.values():
            findings.add("Y0476", f"{word.text} is given twice", span, "use one register for each direction")
            return None
        found[axis.name] = register.name
    return tuple(found.get(one, "") for one in SHIFTS)


def _parts_in(frame: Frame, cell: Cell | None) -> tuple[str, ...]:
    """Return the names of the parts that the cell places in a frame, directly or in frames whose poses
    are given relative to it.
    """
    if cell is None or frame.link is None or frame.link.name not in cell.frames:
        return ()
    if not np.array_equal(cell.frames[frame.link.name].mount.transform, frame.transform):
        return ()  # the program declares another frame of this name
    found = []
    for part in cell.parts:
        name = part.frame
        while name in cell.frames and name != frame.link.name:
            name = cell.frames[name].parent
        if name == frame.link.name:
            found.append(part.body.name)
    return tuple(found)


def shift_steps(steps: list[Step], begin: int, findings: Collector) -> None:
    """Mark the goals that an OFFSET shifts, and check that its steps can be planned at run time.

    Args:
        steps: steps of the program, ending with the OFFSET's steps. The motions of the OFFSET are replaced.
        begin: number of the OFFSET's When.
        findings: receives the findings.
    """
    when = steps[begin]
    assert isinstance(when, When)
    assert when.offset is not None
    offset, head = when.offset, when.origin
    motions = []
    for number in range(begin + 1, len(steps)):
        step = steps[number]
        if isinstance(step, Gap):
            return
        if fault := _fault_of(step):
            origin = step.origin
            message = f"{origin.name} isn't allowed in an OFFSET: {fault}"
            help_ = "end the OFFSET before this line, or move the line before the OFFSET"
            findings.found.append(
                Diagnostic("Y0477", message, origin.source, origin.span, help_, place=origin.place)
            )
            return
        if isinstance(step, Motion):
            if rule := next((one for one in step.keeps if offset.name in one.among), None):
                origin = step.origin
                message = (
                    f"{origin.label or origin.name} is under KEEP {rule.words}, and this OFFSET shifts its "
                    f"reference frame {{{offset.name}}}"
                )
                help_ = (
                    "use a KEEP relative to a frame that isn't shifted, such as {B}, or end the KEEP "
                    "before the OFFSET"
                )
                findings.found.append(
                    Diagnostic("Y0477", message, origin.source, origin.span, help_, place=origin.place)
                )
                return
            steps[number] = step = _shifted(step, offset)
            motions.append(step)
    if not any(_is_shifted(one) for one in motions):
        message = f"no motion of this OFFSET has a pose in {{{offset.name}}}: nothing is shifted"
        help_ = f"give a pose in {{{offset.name}}}, or remove OFFSET and its END"
        findings.found.append(Diagnostic("Y0477", message, head.source, head.span, help_, place=head.place))
        return
    last = motions[-1]
    if (
        not isinstance(last, JointMove | AvoidMove | LineMove)
        or last.blend is not None
        or isinstance(last.goal, JointDelta | PoseDelta)
        or _is_shifted(last)
    ):
        message = f"the OFFSET ends with {last.origin.name} at a shifted or relative place"
        help_ = "end the OFFSET with a MOVEL or MOVEJ to an absolute place that isn't shifted, without BLEND"
        origin = last.origin
        findings.found.append(
            Diagnostic("Y0477", message, origin.source, origin.span, help_, place=origin.place)
        )


def _fault_of(step: Step) -> str:
    """Return the reason why a step isn't allowed in an OFFSET; empty if it is."""
    if isinstance(step, ArcMove):
        return "the via pose of its arc isn't shifted"
    if isinstance(step, JointMove | LineMove) and step.search is not None:
        return "its end is known only after the motion"
    if isinstance(step, LineMove) and step.avoids:
        return (
            "its path is found only for the unshifted frame; write MOVELs through the poses that Y0920 "
            "reports"
        )
    if isinstance(step, Motion | Gap | _Standing):
        return ""
    return "its lines are planned as a whole, and can't branch"


def _shifted(step: Motion, offset: Offset) -> Motion:
    """Return a motion whose goals are marked as shifted if they are given relative to an OFFSET's frame."""
    if isinstance(step, SplineMove | PoseSplineMove):
        goals = tuple(_marked(one, step.origin.base, offset) for one in step.waypoints)
        return replace(step, waypoints=goals)  # type: ignore[arg-type]  # each goal keeps its kind
    if isinstance(step, JointMove | AvoidMove | LineMove):
        return replace(step, goal=_marked(step.goal, step.origin.base, offset))  # type: ignore[arg-type]
    return step


def _marked(goal: Goal, base: FrameLink | None, offset: Offset) -> Goal:
    if not isinstance(goal, PoseGoal | PoseDelta):
        return goal
    if isinstance(goal, PoseDelta) and goal.axes_on_flange:
        return goal
    link = goal.told.base if goal.told is not None else base
    return replace(goal, shifted=True) if _lies_in(link, offset.link) else goal


def _lies_in(link: FrameLink | None, frame: FrameLink | None) -> bool:
    """Return True if `frame`, the frame of an OFFSET, is `link` or one of its parents."""
    while link is not None:
        if frame is not None and link.is_same(frame):
            return True
        link = link.parent
    return False


def _is_shifted(step: Motion) -> bool:
    return any(isinstance(one, PoseGoal | PoseDelta) and one.shifted for one in step.goals)
