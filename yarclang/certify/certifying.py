"""Entry points of the judge: text, program and robot in; certificate and findings out."""

from __future__ import annotations

import math

import numpy as np

from yarclang import hir
from yarclang.cell.model import Cell
from yarclang.certify.blends.blend import judge_blends
from yarclang.certify.blends.starts import Starts, find_starts
from yarclang.certify.bodies.clearance import NOTHING_NEAR
from yarclang.certify.bodies.zones import NO_ZONES, InZones
from yarclang.certify.certificate import Certificate, CommandCertificate, Deviation
from yarclang.certify.claims import Claims
from yarclang.certify.judged import Judged
from yarclang.certify.kinematics.described import ContradictionError, own_robot
from yarclang.certify.kinematics.poses import wrong_poses
from yarclang.certify.motion.deviations import find_deviations
from yarclang.certify.motion.slowed import slowed
from yarclang.certify.read.layout import Layout, Place, lay_out
from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import ControllerText, Unreadable
from yarclang.certify.stretches import Proved, recalled
from yarclang.certify.unsourced import told_program, unjudged
from yarclang.certify.whole_text import Judge
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.progress import tell
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.source import SourceFile

NO_CLAIMS = Claims()


def certify(
    text: str,
    program: hir.Program,
    robot: Robot,
    tolerance: Tolerance,
    claims: Claims = NO_CLAIMS,
    memory: Memory = NO_MEMORY,
    *,
    any_line: bool = False,
) -> Result[Certificate]:
    """Prove that a controller text makes the robot do what its program says.

    Args:
        text: the emitted text.
        program: the program that the text was compiled from.
        robot: geometry, limits, actuation and controller.
        tolerance: largest allowed deviation of the executed path from the programmed one.
        claims: values from the planner that help the proofs.
        memory: cache of parsed move lines and of proofs, keyed by the numbers in the text and in the program.
        any_line: True to accept source lines in the text's map that differ from the program's. Edits of
            comments may have moved the commands to other lines.

    Returns:
        The certificate, even if violations are proved (they are errors among the findings). None if the text
        cannot be read, or if its commands are not the program's.
    """
    content = reader_of(robot.controller).read(text, robot.controller, memory)
    if isinstance(content, Unreadable):
        shown = Diagnostic(
            content.code, f"line {content.line} of the controller's text {content.reason}", program.source
        )
        return Result(None, (shown,))
    judge = Judge(program, robot, tolerance, [])
    try:
        robot = own_robot(robot)
    except ContradictionError as error:
        judge.contradicted(error)
        return Result(None, tuple(judge.findings))
    judge = Judge(program, robot, tolerance, [])
    judge.robot_named(content)
    for step, reason in wrong_poses(program, robot):
        judge.find("Y1161", reason, step)
    start = judge.start(content)
    layout = lay_out(content, program, start, robot.axis_units, any_line=any_line)
    if not isinstance(layout, Layout):
        step, reason = layout
        judge.find("Y1153", reason, step)
        return Result(None, tuple(judge.findings))
    tell("certifying", 0)
    judge.any_jerk(content, claims.any_jerk)
    judge.rests(content, start, {output.signal.variable for output in program.outputs})
    judge.overlaps(content, layout, claims.overlaps)
    judge.postures(layout, claims.postures)
    judge.flow(content)
    judge.follow(layout)
    _judge_motion(judge, content, layout, start)
    judged = Judged(robot, tolerance, claims, judge.find)
    starts = find_starts(judged, layout, program)
    proofs = recalled(memory, judge, (layout, starts), claims, lambda one, part: _prove(one, claims, *part))
    speeds = {step: proof.speed for step, proof in proofs.items()}
    loads = {step: proof.loads for step, proof in proofs.items()}
    judge.findings.extend(slowed(layout, speeds, judged.least_of, loads))
    tell("certifying: zones", 0)
    # The proved bound of a speed in a zone depends on which motions are examined together, so zones are not
    # cached.
    blends = {step: proof.blended for step, proof in proofs.items() if proof.blended is not None}
    zones = {} if judge.breaks_limits else judge.zones(layout, blends)
    commands = tuple(
        _row(judge, layout, place, proofs[place.step], zones.get(place.step, NO_ZONES), memory)
        for place in layout.places
    )
    return _certified(judge, content, start, commands)


def _judge_motion(judge: Judge, content: ControllerText, layout: Layout, start: Array) -> None:
    """Judge properties of the text as a whole: the start, segment times and rests."""
    judge.standing(start)
    judge.segment_times(content, layout)
    judge.rest(layout)


def _certified(
    judge: Judge,
    content: ControllerText,
    start: Array,
    commands: tuple[CommandCertificate, ...],
) -> Result[Certificate]:
    """Return the certificate and all findings.

    The values in the text's header are compared with the certificate only if there is no error so far.
    """
    if not has_errors(judge.findings):
        judge.claims(content, start)
    return Result(Certificate(content.target, commands, judge.tolerance, content), tuple(judge.findings))


def _prove(judge: Judge, claims: Claims, layout: Layout, starts: Starts) -> dict[int, Proved]:
    """Prove everything about each step of a layout except zones."""
    judged = Judged(judge.robot, judge.tolerance, claims, judge.find)
    judge.witnessed(layout)
    tell("certifying: limits", 0)
    loads = judge.limits(layout)
    tell("certifying: paths", 0)
    # Bounds of an absurd motion, which no planner would produce, may overflow to infinity.
    with np.errstate(over="ignore", invalid="ignore"):
        proofs = find_deviations(judged, layout, starts)
        tell("certifying: blends", 0)
        blends = judge_blends(judged, layout, proofs)
    judge.speeds(layout, proofs.speeds)
    tell("certifying: clearances", 0)
    apart = {} if judge.breaks_limits else judge.clearances(layout)
    tell("certifying: torques", 0)
    torques = {} if judge.breaks_limits else judge.torques(layout)
    return {
        step: Proved(
            loads[step],
            proofs.deviations[step],
            proofs.speeds.get(step),
            blends.get(step),
            apart.get(step, NOTHING_NEAR),
            torques.get(step),
        )
        for step in (place.step for place in layout.places)
    }


def _row(
    judge: Judge, layout: Layout, place: Place, proved: Proved, zones: InZones, memory: Memory
) -> CommandCertificate:
    """Build one command's row of the certificate, cached by the command's label, position and proofs."""

    def make() -> CommandCertificate:
        return judge.command(
            layout,
            place,
            proved.loads,
            proved.deviation,
            proved.speed,
            proved.blended,
            proved.apart,
            zones,
            proved.torque,
        )

    if zones is not NO_ZONES or isinstance(memory, Forgetful):
        return make()
    origin = place.motion.origin
    called = (origin.place, origin.index, origin.name, origin.span.line, origin.source.module)
    allowed = judge.handled.allowances.get(place.step, ())
    key = ("row", proved, place.step, place.lines, called, allowed)
    return recall(memory, key, make)


def certify_text(
    text: str, robot: Robot, source: SourceFile, cell: Cell | None = None
) -> Result[Certificate]:
    """Prove as much as possible about a controller text without its program.

    The proof covers limits at every instant, rests, segment times, the guard, and the goal of each RAPID. It
    covers assignments: only outputs are assigned, each at rest or in the middle of a blend. It also covers
    the distances between the robot, tools and the cell's obstacles, the zones, and the torques. A note lists
    what is not judged.

    Args:
        text: the emitted text.
        robot: geometry, limits, actuation and controller.
        source: the file that findings refer to.
        cell: the robot's surroundings, if known.

    Returns:
        The certificate, with infinite deviations, since the programmed path is unknown. None if the text
        cannot be read.
    """
    content = reader_of(robot.controller).read(text, robot.controller, NO_MEMORY)
    if isinstance(content, Unreadable):
        shown = Diagnostic(content.code, f"line {content.line} {content.reason}", source)
        return Result(None, (shown,))
    try:
        robot = own_robot(robot)
    except ContradictionError as error:
        return Result(
            None, (Diagnostic("Y1194", f"{robot.name} isn't what its files describe: {error}", source),)
        )
    program = told_program(content, robot, source, cell)
    # Without the source, findings about a command refer to its first move line, or to its entry in the map.
    lines = {entry.step: entry.first or entry.at for entry in content.entries}
    judge = Judge(program, robot, robot.tolerance, [], lines)
    judge.robot_named(content)
    for step, reason in wrong_poses(program, robot):
        judge.find("Y1161", reason, step)
    start = judge.start(content)
    layout = lay_out(content, program, start, robot.axis_units)
    if not isinstance(layout, Layout):
        step, reason = layout
        judge.find("Y1153", reason, step)
        return Result(None, tuple(judge.findings))
    judge.rests(content, start, None)
    _judge_motion(judge, content, layout, start)
    judge.witnessed(layout)
    loads = judge.limits(layout)
    apart = {} if judge.breaks_limits else judge.clearances(layout)
    torques = {} if judge.breaks_limits else judge.torques(layout)
    zones = {} if judge.breaks_limits else judge.zones(layout, {})
    unknown = Deviation(math.inf, math.inf, math.inf, math.inf)
    commands = tuple(
        judge.command(
            layout,
            place,
            loads[place.step],
            unknown,
            apart=apart.get(place.step, NOTHING_NEAR),
            zones=zones.get(place.step, NO_ZONES),
            torque=torques.get(place.step),
        )
        for place in layout.places
    )
    if not has_errors(judge.findings):
        judge.findings.append(unjudged(content, source, cell))
    return _certified(judge, content, start, commands)
