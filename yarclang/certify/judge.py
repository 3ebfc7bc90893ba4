"""The judgement: text, program and robot in; certificate and findings out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from yarclang import hir
from yarclang.certify.blend import judge_blends
from yarclang.certify.certificate import Certificate, CommandCertificate, Deviation
from yarclang.certify.clearance import NOTHING_NEAR
from yarclang.certify.corner import Judged
from yarclang.certify.deviations import find_deviations
from yarclang.certify.flow import check_places
from yarclang.certify.judgement import Judge
from yarclang.certify.layout import Layout, Place, lay_out
from yarclang.certify.read import read
from yarclang.certify.stretches import Claims, Proved, recalled
from yarclang.certify.text import ControllerText, Unreadable
from yarclang.certify.zones import NO_ZONES, InZones
from yarclang.diagnostics import Diagnostic, Result
from yarclang.memory import NO_MEMORY, Forgetful, Memory, recall
from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.source import SourceFile, Span

NO_LAWS: Mapping[int, Array] = MappingProxyType({})


def certify(
    text: str,
    program: hir.Program,
    robot: Robot,
    tolerance: Tolerance,
    witnesses: Mapping[int, Array],
    laws: Mapping[int, Array] = NO_LAWS,
    memory: Memory = NO_MEMORY,
) -> Result[Certificate]:
    """Prove what a controller text makes the robot do, against the program that it was compiled from.

    Args:
        text: the emitted text.
        program: what the robot shall do.
        robot: geometry, limits, actuation and controller.
        tolerance: how far the executed path may be from the programmed one.
        witnesses: by the number of a motion in the program's steps, the joint positions that the planner chose: for each
            SplineMove (k, n) for its k way-points, for each AvoidMove as many as were found, the goal last; for a JointMove to a pose that flows into the next motion, and, where that one
            is in joint space, for a Cartesian motion, (1, n) for its end. Claims: each is checked against its way-point.
        laws: for SplineMoves and PoseSplineMoves, by the same number: control values (segments + 3,) of the share of the way over
            time. The segments of a motion in a chain reach half a blend beyond its own on either side. Claims: a
            wrong one proves less, never more.
        memory: keeps what move lines say, and what was proved, by the numbers in the text and what they shall be.

    Returns:
        The certificate, also where it proves violations (these are errors among the findings); None where
        the text can't be read or its commands aren't the program's.
    """
    content = read(text, robot.controller, memory)
    if isinstance(content, Unreadable):
        shown = Diagnostic(
            content.code, f"line {content.line} of the controller's text {content.reason}", program.source
        )
        return Result(None, (shown,))
    judge = Judge(program, robot, tolerance, [])
    start = judge.start(content)
    layout = lay_out(content, program, start, robot.axis_units)
    if not isinstance(layout, Layout):
        step, reason = layout
        judge.find("Y1153", reason, step)
        return Result(None, tuple(judge.findings))
    judge.flow(content, start)
    judge.segment_times(content, layout)
    judge.rest(layout)
    claims = Claims(witnesses, laws)
    proofs = recalled(memory, judge, layout, claims, lambda part: _prove(judge, part, claims))
    # how close a speed in a zone is told depends on what it is looked at with
    zones = judge.zones(layout)
    commands = tuple(
        _row(judge, layout, place, proofs[place.step], zones.get(place.step, NO_ZONES), memory)
        for place in layout.places
    )
    return Result(Certificate(content.target, commands, tolerance), tuple(judge.findings))


def _prove(judge: Judge, layout: Layout, claims: Claims) -> dict[int, Proved]:
    """What is proved of each step of a layout, but for zones."""
    loads = judge.limits(layout)
    judged = Judged(judge.robot, judge.tolerance, claims.witnesses, claims.laws, judge.find)
    # the bounds of a motion that nobody would plan may be without end
    with np.errstate(over="ignore", invalid="ignore"):
        proofs = find_deviations(judged, layout)
        blends = judge_blends(judged, layout, proofs)
    judge.speeds(layout, proofs.speeds)
    apart = judge.clearances(layout)
    torques = judge.torques(layout)
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
    """What the table says of a command; it says the same again of one that is called so, stands there, and was proved with its neighbours before."""

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
    key = ("row", proved, place.step, place.lines, origin.place, origin.index, origin.name, origin.span.line)
    return recall(memory, key, make)


def certify_text(text: str, robot: Robot, source: SourceFile) -> Result[Certificate]:
    """Prove what can be proved of a controller text whose program isn't known: limits, rest, segment times.

    Args:
        text: the emitted text.
        robot: geometry, limits, actuation and controller.
        source: under whose name findings speak of the text.

    Returns:
        The certificate, whose deviations are infinite: how far the path is from the programmed one isn't known. None
        where the text can't be read.
    """
    content = read(text, robot.controller)
    if isinstance(content, Unreadable):
        shown = Diagnostic(content.code, f"line {content.line} {content.reason}", source)
        return Result(None, (shown,))
    program = _told(content, robot, source)
    # the source isn't there: its commands are shown by their first moves, or where the map lists them
    lines = {entry.step: entry.first or entry.at for entry in content.entries}
    judge = Judge(program, robot, robot.tolerance, [], lines)
    layout = lay_out(content, program, program.start, robot.axis_units)
    if not isinstance(layout, Layout):
        step, reason = layout
        judge.find("Y1153", reason, step)
        return Result(None, tuple(judge.findings))
    for step, reason in check_places(content):
        judge.find("Y1165", reason, step)
    judge.segment_times(content, layout)
    judge.rest(layout)
    loads = judge.limits(layout)
    torques = judge.torques(layout)
    unknown = Deviation(math.inf, math.inf, math.inf, math.inf)
    commands = tuple(
        judge.command(layout, place, loads[place.step], unknown, torque=torques.get(place.step))
        for place in layout.places
    )
    return Result(Certificate(content.target, commands, robot.tolerance), tuple(judge.findings))


def _told(content: ControllerText, robot: Robot, source: SourceFile) -> hir.Program:
    """The program as far as the text's map tells it: which commands there are, and where they move."""
    start = content.start
    if start.rapid is not None:
        q = start.rapid * robot.axis_units
    else:
        assert start.guard is not None
        q = from_counts(robot, start.guard / (32.0 * robot.controller.ixx08))
    steps: list[hir.Step] = []
    for entry in content.entries:
        origin = hir.Origin(entry.index, entry.name, source, Span.on_line(entry.source_line, 1, 2))
        goal = hir.JointGoal(q)  # where it goes isn't judged
        still = entry.first is None
        blend = None if entry.blend is None else hir.Reading(math.inf, math.inf)
        move = hir.JointMove(origin, goal, "", hir.Timing(None), blend=blend)
        # of what has no lines only the name is known; what ends a sequence is seen in the text itself
        steps.append(hir.SetOutput(origin, hir.Signal("", ""), 0.0) if still else move)
    return hir.Program(source, q, tuple(steps))
