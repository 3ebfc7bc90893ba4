"""Format a command's inspection as text: sections of a title and lines."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from yarclang.certify.certificate import IDLE, CommandCertificate, Load, bound_text
from yarclang.certify.outward import down_to, least, most, percent, up_to
from yarclang.decisions import in_words, shown_variable, simple
from yarclang.emitted.purposes import MOVE, Stretch
from yarclang.frozen import frozen
from yarclang.hir import (
    Assign,
    Dwell,
    Exit,
    Finish,
    FrameLink,
    Hold,
    JointGoal,
    JointMove,
    LineMove,
    Loop,
    Motion,
    NextPass,
    Offset,
    PoseDelta,
    Say,
    Search,
    SetOutput,
    Signal,
    Step,
    TimedMove,
    Timing,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.report.distances import distances_of
from yarclang.report.inspection.branches import Solution
from yarclang.report.inspection.flow import flow_lines, when_set
from yarclang.report.inspection.inspected import Inspected, WayPoint, chain_of, chain_pose
from yarclang.report.inspection.limits import Limit, Pace
from yarclang.report.inspection.outline import offset_words
from yarclang.report.pictures.style import printable
from yarclang.report.pose_text import pose_text
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.units import DEG, MM, MS

FEW = 3
"""Number of lines of controller text that are shown at the beginning and at the end of each group of lines.
"""

_NO_SHORTER = 2e-3
"""A duration that exceeds the shortest possible duration by less than this [s] counts as the shortest, since
the shortest possible duration is rounded up.
"""

_MOST_SOLUTIONS = 12
"""Largest number of solutions that are listed. Further solutions are only counted."""


@frozen
class Section:
    """A title and the lines below it."""

    title: str
    lines: tuple[str, ...]


def sections_of(inspected: Inspected, *, all_lines: bool = False) -> tuple[Section, ...]:
    """Return all information about a command as sections of text, in the order in which it is computed.

    Args:
        inspected: the command.
        all_lines: True to show all lines of its controller text.
    """
    motion = isinstance(inspected.step, Motion)
    all_sections = [
        ("command", _command(inspected)),
        ("frames", _frames(inspected) if motion else iter(())),
        ("target", _target(inspected) if motion else iter(())),
        ("joints", _joints(inspected)),
        *(_solutions(inspected, number) for number in range(len(inspected.waypoints))),
        ("time", _time(inspected)),
        ("certificate", _certificate(inspected.certificate)),
        ("controller text", stretch_lines(inspected.stretches, inspected.text, all_lines=all_lines)),
    ]
    sections = (Section(title, tuple(lines)) for title, lines in all_sections)
    return tuple(one for one in sections if one.lines)


def _command(inspected: Inspected) -> Iterator[str]:
    origin = inspected.origin
    yield f"{origin.source.name}:{origin.span.line}: {origin.label} {origin.name}".rstrip()
    if line := origin.source.line(origin.span.line).strip():
        yield printable(line)
    if origin.place and origin.place != origin.index:
        yield f"place {origin.place}, step {inspected.number} of the program"
    if (told := _effect(inspected, inspected.step)) is not None:
        yield told
    for verb, names in inspected.deeds:
        yield f"it {verb} {', '.join(names)}"
    if inspected.carries:
        yield f"the robot carries {', '.join(inspected.carries)}"
    for body in inspected.divided:
        yield printable(body.words)
    for rule in () if inspected.certificate is None else inspected.certificate.kept:
        reached = (
            "" if rule.largest is None else f": it tilts at most {up_to(most(rule.largest, DEG), 4)} deg"
        )
        if rule.largest is not None and rule.nearest is not None and rule.farthest is not None:
            reached = (
                f": at most {up_to(most(rule.largest, DEG), 4)} deg off the axis, "
                f"{down_to(least(rule.nearest, MM), 6)} to {up_to(most(rule.farthest, MM), 6)} mm away"
            )
        yield f"observes KEEP {printable(rule.rule)}{reached}"
    for one in () if inspected.certificate is None else inspected.certificate.may_touch:
        needed = "they touch, or come nearer than a margin" if one.needed else "they stay apart anyway"
        yield f"not checked: {printable(one.pair)} may touch, allowed by {one.giver}; {needed}"


def _effect(inspected: Inspected, step: Step) -> str | None:
    """Return in words what a step without motion does; None if there is nothing to report."""
    match step:
        case JointMove(search=Search() as one) | LineMove(search=Search() as one):
            return (
                f"it ends when {one.name} ({one.variable}) becomes {_state(one.value)}; the next motions "
                "are planned and proved from that place at run time"
            )
        case Dwell(duration=duration):
            return f"the robot waits for {duration:g} s"
        case SetOutput(output=output, value=value):
            return f"{when_set(inspected.flows)} {output.name} ({output.variable}) becomes {_state(value)}"
        case WaitInput(input=signal, value=value, timeout=timeout):
            until = f", at most {timeout:g} s" if timeout is not None else ", without a time limit"
            return f"the robot waits until {signal.name} ({signal.variable}) is {_state(value)}{until}"
        case WaitUntil(condition=condition, timeout=timeout):
            until = f", at most {timeout:g} s" if timeout is not None else ", without a time limit"
            return f"the robot waits until {in_words(condition)}{until}"
        case Hold(text=text, register=register) if register:
            return (
                f"the robot waits until the operator answers: {printable(text)}; {register} gets the answer"
            )
        case Hold(text=text):
            return f"the robot waits until the operator continues{f': {printable(text)}' if text else ''}"
        case When(condition=condition, within=float(within)):
            return (
                f"the robot waits until {in_words(condition)}, or until {within:g} s are over: then the "
                "lines of ELSE are carried out"
            )
        case When(offset=Offset() as offset):
            return (
                f"{{{offset.name}}} is shifted by {offset_words(offset)}: the lines up to END are planned "
                "and proved there at run time, or the lines of ELSE run; shown here is the unshifted place"
            )
        case When(condition=condition):
            compared = simple(condition)
            if compared is None:
                return f"the program branches: is {in_words(condition)}?"
            read, wanted = compared
            return f"the program branches: is {read.name} ({read.variable}) {_state(wanted)}?"
        case Loop():
            return "a loop begins: its lines are repeated"
        case NextPass():
            return "the loop begins anew"
        case Exit():
            return "the SUB is left" if step.origin.name == "RETURN" else "the loop is left"
        case Say(text=name, teaches=teaches) if teaches:
            what = "its joints are" if teaches == "joints" else "the pose of {TCP} in {B} is"
            return f"the position of the robot is taught: {what} stored as {name}"
        case Say(text=text):
            return f"the operator sees: {printable(text)}"
        case Finish(fails=fails, text=text):
            return f"the program ends with a fault: {printable(text)}" if fails else "the program ends"
        case Assign(target=Signal(name=name, variable=variable), value=number):
            return f"the output {name} ({shown_variable(variable)}) becomes {in_words(number)}"
        case Assign(target=register, value=number):
            return f"the register {register} becomes {in_words(number)}"
        case _:
            return None


def _state(value: float) -> str:
    return {0.0: "OFF", 1.0: "ON"}.get(value, f"{value:g}")


def _frames(inspected: Inspected) -> Iterator[str]:
    origin = inspected.origin
    if origin.moving is None and origin.base is None:
        yield "joint values need no frame"
        return
    for label, link in (("moves", origin.moving), ("values in", origin.base)):
        if link is None:
            continue
        chain = chain_of(link)
        for number, one in enumerate(chain):
            yield _link(label if number == 0 else "", one)
        if len(chain) > 2:
            yield f"{'':9}  {{{link.name}}} in {{{chain[-1].name}}}: {pose_text(chain_pose(link))}"


def _link(label: str, link: FrameLink) -> str:
    name = f"{{{link.name}}}"
    if link.parent is None:
        return (
            f"{label:9}  {name:12}  "
            f"{'the robot ends there' if link.name == 'FLANGE' else 'the robot is there'}"
        )
    where = (
        "the robot's" if link.source is None or link.span is None else f"{link.source.name}:{link.span.line}"
    )
    return f"{label:9}  {name:12}  {pose_text(link.parent_from_frame)} in {{{link.parent.name}}}  ({where})"


def _target(inspected: Inspected) -> Iterator[str]:
    origin, robot = inspected.origin, inspected.robot
    assert isinstance(inspected.step, Motion)
    if isinstance(delta := inspected.step.end, PoseDelta):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = delta.turn, delta.shift
        yield f"increment  {pose_text(pose)}"
    name = f"{{{origin.moving.name}}}" if origin.moving is not None else "the frame"
    for number, waypoint in enumerate(inspected.waypoints, 1):
        which = f"waypoint {number}: " if len(inspected.waypoints) > 1 else ""
        if origin.base is not None and origin.base.name != "B" and chain_of(origin.base)[-1].name == "B":
            in_base = np.linalg.inv(chain_pose(origin.base)) @ waypoint.pose
            yield f"{which}{name} at {pose_text(in_base)} in {{{origin.base.name}}}"
        yield f"{which}{name} at {pose_text(waypoint.pose)} in {{B}}"
    if not inspected.waypoints and inspected.end is not None:
        frame = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
        pose = tool_poses(robot.chain, inspected.end[None], robot.flange_from_frame[frame])[0]
        if isinstance(inspected.step.end, JointGoal):
            yield "joint values; they move"
        yield f"{{{frame}}} to {pose_text(pose)} in {{B}}"


def _joints(inspected: Inspected) -> Iterator[str]:
    robot = inspected.robot
    start, end = inspected.start, inspected.end
    if start is None:
        yield "the position of the robot isn't known, because of errors before this command"
        if end is None:
            return
    moves = isinstance(inspected.step, Motion)
    rows = [("", *robot.joint_names)]
    if start is not None:
        stands = "stands at" if inspected.flows.inside is None else "corner"
        rows.append(("start" if moves else stands, *joint_cells(robot, start)))
    if end is not None and moves:
        rows.append(("end", *joint_cells(robot, end)))
        if start is not None:
            rows.append(("way", *joint_cells(robot, end - start, sign="+")))
    lower = (_limit_cell(value) for value in robot.limits.lower / robot.axis_units)
    upper = (_limit_cell(value) for value in robot.limits.upper / robot.axis_units)
    rows += [("lower limit", *lower), ("upper limit", *upper), ("", *robot.axis_unit_names)]
    yield from table(rows)


def _limit_cell(value: float) -> str:
    return f"{value:g}" if np.isfinite(value) else "none"


def joint_cells(robot: Robot, q: Array, sign: str = "") -> tuple[str, ...]:
    """Return joint values (n,) [rad or m] in axis units, as cells of a table."""
    return tuple(f"{value:{sign}.3f}" for value in (q / robot.axis_units).round(3) + 0.0)


def table(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """Yield the rows of a table as lines of text with aligned columns: the first column left-aligned, the
    others right-aligned.
    """
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        cells = (
            cell.ljust(width) if column == 0 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        yield "  ".join(cells).rstrip()


def _solutions(inspected: Inspected, number: int) -> tuple[str, Iterator[str]]:
    waypoint, robot = inspected.waypoints[number], inspected.robot
    many = len(inspected.waypoints) > 1
    title = f"solutions of waypoint {number + 1}" if many else "solutions"
    return title, _solution_lines(waypoint, robot, inspected.start is not None)


def _solution_lines(waypoint: WayPoint, robot: Robot, is_known: bool) -> Iterator[str]:
    if waypoint.near:
        yield "the distance is measured from the position of NEAR"
    elif not is_known:
        yield "the distance is measured from HOME, because the start isn't known"
    if (missed := waypoint.unreachable) is not None and missed.kind == "reach":
        turn = f" and {missed.miss_angle / DEG:.3g} deg" if missed.miss_angle > 1e-3 else ""
        yield f"none: the pose is out of reach by {missed.miss / MM:.4g} mm{turn}"
    if not waypoint.solutions:
        return
    solutions = waypoint.solutions[:_MOST_SOLUTIONS]
    within = [one for one in solutions if one.verdict != "out of limits"]
    rows = [
        ("", *robot.joint_names, "distance"),
        *(_row(robot, one, n) for n, one in enumerate(solutions, 1)),
    ]
    reasons = ["", *(_reason(one) for one in solutions)]
    for line, reason in zip(table(rows), reasons, strict=True):
        yield f"{line}  {reason}".rstrip()
    if (more := len(waypoint.solutions) - len(solutions)) > 0:
        yield f"and {more} more (--format json has all)"
    if within:
        yield "distance: sum of squared joint differences (rad, m)"


def _row(robot: Robot, solution: Solution, number: int) -> tuple[str, ...]:
    return f"{number}", *joint_cells(robot, solution.q), f"{solution.distance:.3f}"


def _reason(solution: Solution) -> str:
    return f"CHOSEN: {solution.reason}" if solution.verdict == "chosen" else solution.reason


def _time(inspected: Inspected) -> Iterator[str]:
    if inspected.begins is not None and inspected.total is not None:
        duration = inspected.certificate.duration if inspected.certificate is not None else 0.0
        if isinstance(inspected.step, Dwell):
            duration = inspected.step.duration
        ends = f" to {inspected.begins + duration:.3f} s" if duration else " s"
        yield f"{inspected.begins:.3f}{ends} of {inspected.total.text()}"
    if inspected.motion is not None and isinstance(inspected.step, Motion):
        curve, timing = inspected.motion.curve, inspected.step.timing
        asked_time = _asked_time(timing)
        law = f"{inspected.motion.profile}, " if inspected.motion.profile else ""
        if any(one.is_error for one in inspected.findings):
            yield (
                f"the requested time, {asked_time}, isn't possible; the values below are for the shortest "
                "time"
            )
            asked_time = "the shortest"
        if isinstance(inspected.step, TimedMove):
            yield from _table(inspected.step)
        yield (
            f"{law}asked for {asked_time}; {curve.segments} segments of {curve.segment / MS:.6g} ms: "
            f"{curve.duration:.3f} s"
        )
    yield from flow_lines(inspected.flows)
    speed = inspected.certificate.zone_speed if inspected.certificate is not None else None
    if speed is not None and speed.share > _AT_ITS_SPEED:
        where = "its ceiling" if speed.of_motion else f"the zone {speed.zone}"
        yield f"limited by {where}: {speed.part} at {100.0 * speed.share:.1f} % of {speed.limit / MM:g} mm/s"
    if inspected.pace is not None and inspected.motion is not None:
        yield from _pace(inspected.pace, inspected.motion.curve.duration)


def _table(step: TimedMove) -> Iterator[str]:
    """Yield the rows of a timetable, and the interpolation between them."""
    table = step.table
    rows = len(table.times)
    given_values = "velocities" if table.accelerations is None else "velocities and accelerations"
    whence = f"timetable in {step.file}" if step.file else "timetable"
    said = f" with {given_values}" if table.velocities is not None else ""
    stretched = f", all times multiplied by {step.stretch:.10g}" if step.stretch != 1.0 else ""
    yield (
        f"{whence}: {rows:,} row{'s' * (rows != 1)}{said}, from {table.times[0]:.10g} to "
        f"{table.times[-1]:.10g} s{stretched}"
    )
    if table.velocities is None:
        between = (
            "the cubic spline in time through all rows, with continuous acceleration, at rest at both ends"
        )
    else:
        between = (
            f"the {'cubic' if table.accelerations is None else 'quintic'} polynomial in time with the "
            f"{given_values} of both rows"
        )
    yield f"between the rows: {between}"


_AT_ITS_SPEED = 0.99
"""Share of a speed limit (of a zone, or of the command's V<=) above which this limit is reported as the
reason for the motion's duration.
"""


def _asked_time(timing: Timing) -> str:
    """Return the motion time as it is written in the command."""
    if timing.duration is not None:
        return f"[{timing.duration:g} s]"
    if timing.speed is not None:
        length, angle = timing.speed.length, timing.speed.angle
        return f"[V {length / MM:g} mm/s]" if length is not None else f"[V {(angle or 0.0) / DEG:g} deg/s]"
    if timing.ceiling is not None:
        return f"[V<={timing.ceiling / MM:g} mm/s]"
    return "[MIN]" if timing.share == 1.0 else f"[{timing.share * 100:g}%]"


def _pace(pace: Pace, duration: float) -> Iterator[str]:
    first, *others = pace.limits
    if first.share <= 0.0:
        yield "nothing moves"
        return
    word = "limited by" if pace.is_shortest else "nearest to a limit:"
    yield f"{word} the {_limit_text(first)}"
    rest = ", ".join(f"{one.kind} {one.whose} {one.share * 100:.0f} %" for one in others)
    yield f"others at most: {rest}"
    if pace.shortest is not None and duration - pace.shortest < _NO_SHORTER:
        yield "no shorter time is possible"
    elif pace.shortest is not None:
        yield f"the shortest possible time is {pace.shortest:.3f} s"


def _limit_text(limit: Limit) -> str:
    return (
        f"{limit.kind} of {limit.whose}: {limit.share * 100:.1f} % of the usable limit, {limit.time:.3f} s "
        f"after its start ({limit.s * 100:.0f} % of the way)"
    )


def _certificate(certificate: CommandCertificate | None) -> Iterator[str]:
    if certificate is None:
        return
    deviation = certificate.deviation
    path = f"{bound_text(deviation.position, MM)} mm, {bound_text(deviation.angle, DEG)} deg"
    left = (
        f"{bound_text(deviation.remainder_position, MM)} mm, {bound_text(deviation.remainder_angle, DEG)} deg"
    )
    end = f"{bound_text(deviation.end_position, MM)} mm, {bound_text(deviation.end_angle, DEG)} deg"
    yield (
        f"path within {path} of the programmed one (of which {left} is the bound between the checked places)"
    )
    yield f"end within {end} of the target"
    loads = (
        ("position", certificate.position),
        ("velocity", certificate.velocity),
        ("acceleration", certificate.acceleration),
        ("jerk", certificate.jerk),
        ("motor speed", certificate.motor_velocity),
        ("a hold", certificate.hold),
        ("torque", certificate.torque or IDLE),
    )
    yield "of the limits: " + ", ".join(_load(name, load) for name, load in loads if load.name)
    for name, told in distances_of(certificate):
        yield f"{name}: {told}"


def _load(name: str, load: Load) -> str:
    return f"{name} {load.name} {percent(load.share)} %"


def stretch_lines(
    stretches: Sequence[Stretch], text: Sequence[str], *, all_lines: bool = False
) -> Iterator[str]:
    """Yield numbered lines of controller text with their purpose: all lines, or the first and last lines of
    each group of lines with one purpose.
    """
    for stretch in stretches:
        size = stretch.last - stretch.first + 1
        lines = f"line {stretch.first}" if size == 1 else f"lines {stretch.first} to {stretch.last}"
        what = "moves" if stretch.what == MOVE and size > 1 else stretch.what
        yield f"{lines}: {what}"
        numbers = list(range(stretch.first, stretch.last + 1))
        shown = numbers if all_lines or size <= 2 * FEW + 1 else [*numbers[:FEW], 0, *numbers[-FEW:]]
        for number in shown:
            yield f"{number:>8}  {text[number - 1]}" if number else f"{'...':>8}"
