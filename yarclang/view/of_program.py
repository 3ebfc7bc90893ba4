"""Build the scene of a program. A program with errors is planned as far as possible."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from yarclang.cell.model import Cell
from yarclang.certify.certificate import Certificate, CommandCertificate
from yarclang.certify.outward import percent
from yarclang.decisions import in_words, simple
from yarclang.diagnostics import Diagnostic
from yarclang.hir import (
    Assign,
    Dwell,
    Exit,
    Finish,
    Gap,
    Hold,
    Loop,
    Motion,
    NextPass,
    Offset,
    Origin,
    Say,
    SetOutput,
    Step,
    TimedMove,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.lint.registry import everything
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.progress import each
from yarclang.report.carried import Carried, carried_in_plan
from yarclang.report.clearance import near
from yarclang.report.distances import distances_of
from yarclang.report.kept import held_rules
from yarclang.report.nearest import nearest_places
from yarclang.report.pictures.drawn_frame import drawn_frame
from yarclang.report.pictures.plot import time_facts
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.units import MM
from yarclang.view.bodies import rule_note
from yarclang.view.dragging import draggables_of
from yarclang.view.parts import facts_of_motion, facts_of_set, parts_of_plan, with_parts
from yarclang.view.rules import rules_of
from yarclang.view.stage import Later, Mark, Piece, Scenes, Stage, Worst
from yarclang.view.surroundings import surroundings_of
from yarclang.view.track import Curves, way_of_curves

_RANKS = {"error": 0, "warning": 1, "note": 2}
"""Severities in the order in which findings are listed."""
_SHORT = 40
"""Number of commands up to which a program has no list of its worst places. All commands of such a program
are visible at once.
"""
_LOOKS = 200
"""Number of samples of a motion at which distances are computed to find the time of a reported collision."""


def stage_of_program(
    name: str,
    plan: MotionPlan,
    certificate: Certificate | None,
    findings: Sequence[Diagnostic],
) -> Stage:
    """Return the scene of a planned program.

    Args:
        name: name of the program's file, for people.
        plan: the plan, which may be incomplete.
        certificate: what was proved; None for a program with errors.
        findings: all findings.
    """
    robot, program = plan.robot, plan.program
    frame = drawn_frame(plan)
    curves = Curves(program.start, tuple(one.curve for one in plan.motions), plan.begins)
    proved = {one.step: one for one in certificate.commands} if certificate is not None else {}
    carried = carried_in_plan(plan)
    pieces, number_of = _pieces(plan, proved, carried)
    owners = [number_of[motion.step] for motion in plan.motions]
    way = way_of_curves(curves, robot.chain, frame.flange_from_frame, owners)
    around = surroundings_of(robot, program, frame.name)
    unplanned = sum(isinstance(step, Motion) for step in program.steps) - len(plan.motions)
    # Path constraints (KEEP rules) are drawn while they are in force, and not as zones.
    of_rules = [zone for zone in (around.cell.zones if around.cell is not None else ()) if zone.keep]
    names, unshown = {zone.name for zone in of_rules}, {rule_note(zone) for zone in of_rules}
    items = tuple(one for one in around.items if one.kind != "zone" or one.name not in names)
    notes = tuple(one for one in around.notes if one not in unshown)
    if unplanned and any(one.is_error for one in findings):
        notes = (
            f"{unplanned} motion{'s' * (unplanned != 1)} can't be planned; the path shows the others",
            *notes,
        )
    shown = parts_of_plan(plan, carried)
    scenes = Scenes(robot, np.zeros(1), (program.cell,)) if shown is None else shown.scenes
    stands = _Stands(plan, frame.flange_from_frame, pieces, number_of, scenes)
    marks = sorted((stands.mark(one) for one in each(findings)), key=lambda one: _RANKS[one.severity])
    count = len(plan.motions)
    motions = f"{count:,} motion{'s' * (count != 1)}" if count else "no motion"
    stage = Stage(
        title=name,
        subtitle=" · ".join((robot.name, *time_facts(plan.lasting, plan.duration), motions)),
        notes=notes,
        robot=robot,
        items=items,
        axes=around.axes,
        frame=frame.name,
        flange_from_frame=frame.flange_from_frame,
        track=curves,
        ghost=None,
        way=way,
        ghost_way=None,
        pieces=pieces,
        marks=tuple(marks),
        scene=around.scene,
        duration=plan.duration,
        cell=around.cell,
        rules=rules_of(held_rules(plan), robot, around.cell),
        worst=_worst(certificate, robot, around.cell, number_of),
        draggable=draggables_of(
            robot, program, tool_poses(robot.chain, program.start[None], frame.flange_from_frame)[0]
        ),
    )
    return with_parts(stage, shown)


def _worst(
    certificate: Certificate | None, robot: Robot, cell: Cell | None, number_of: Mapping[int, int]
) -> tuple[Worst, ...]:
    """Return the places of a long program that come nearest to their limits; empty for a short program."""
    if certificate is None or len(certificate.commands) <= _SHORT:
        return ()
    return tuple(
        Worst(
            number_of[one.command.step],
            f"{'' if one.share is None else f'{percent(one.share)} % '}{one.what}: {one.figure}, "
            f"{one.command.index or one.command.name}",
        )
        for one in nearest_places(certificate, robot, cell)
    )


def _pieces(
    plan: MotionPlan, proved: Mapping[int, CommandCertificate], carried: Carried | None
) -> tuple[tuple[Piece, ...], dict[int, int]]:
    """Return all commands of a program in order, and the index of the command for each step."""
    at = {motion.step: number for number, motion in enumerate(plan.motions)}
    pieces: list[Piece] = []
    number_of: dict[int, int] = {}
    places = plan.schedule.places
    for number, step in enumerate(each(plan.program.steps)):
        if isinstance(step, Gap):
            continue
        origin, here = step.origin, at.get(number)
        begins, ends, moves = places[number], places[number + 1], isinstance(step, Motion)
        facts: Iterable[tuple[str, str]]
        if here is not None:
            facts = Later(
                partial(_facts, plan.robot, plan.motions[here], step, number, proved.get(number), carried)
            )
        elif moves:
            facts = (("motion", "can't be planned: see the findings"),)
        else:
            facts = (*_action_facts(step), *facts_of_set(carried, number))
        number_of[number] = len(pieces)
        pieces.append(
            Piece(
                origin.label,
                origin.name,
                origin.span.line,
                begins,
                ends,
                moves and here is not None,
                here is not None or not moves,
                facts,
            )
        )
    return tuple(pieces), number_of


def _facts(
    robot: Robot,
    motion: PlannedMotion,
    step: Step,
    number: int,
    proved: CommandCertificate | None,
    carried: Carried | None,
) -> tuple[tuple[str, str], ...]:
    return (*motion_facts(robot, motion, step, proved), *facts_of_motion(carried, number))


def motion_facts(
    robot: Robot, motion: PlannedMotion, step: Step, proved: CommandCertificate | None
) -> tuple[tuple[str, str], ...]:
    """Return the facts about a motion to show: time, use of the joint limits, speed of the moving frame,
    distances of bodies.
    """
    curve = motion.curve
    facts = [("duration", f"{curve.duration:.3f} s"), ("profile", motion.profile)]
    if isinstance(step, TimedMove):
        rows = f"{len(step.table.times)} rows"
        facts[1] = ("timetable", f"{rows} in {step.file}" if step.file else rows)
        if step.stretch != 1.0:
            facts.append(("stretched", f"{step.stretch:.6g} times as long"))
    if isinstance(step, Motion) and step.timing.duration is None:
        share = f"{100.0 * step.timing.share:.0f} % of the limits" if step.timing.share < 1.0 else "shortest"
        if step.timing.ceiling is not None:
            share = f"no more than {step.timing.ceiling / MM:.6g} mm/s"
        facts.append(("asked for", "a speed" if step.timing.speed is not None else share))
    limits, points, h = robot.limits, curve.points, curve.segment
    for name, order, limit in (("speed", 1, limits.velocity), ("acceleration", 2, limits.acceleration)):
        # Differences of control points bound the derivatives at all times. The checks of the limits use the
        # same figures.
        shares = np.abs(np.diff(points, n=order, axis=0)).max(axis=0) / h**order / limit
        joint = int(np.argmax(shares))
        facts.append((f"largest joint {name}", f"{100.0 * shares[joint]:.0f} % ({robot.joint_names[joint]})"))
    if proved is None:
        return tuple(facts)
    if proved.tool_speed is not None and not proved.tool_speed.turns:
        facts.append(("largest speed of the frame", f"{proved.tool_speed.largest / MM:.0f} mm/s"))
    return (*facts, *distances_of(proved))


def _action_facts(step: Step) -> tuple[tuple[str, str], ...]:
    match step:
        case Dwell(duration=duration):
            return (("stands for", f"{duration:g} s"),)
        case SetOutput(output=output, value=value):
            return (("sets", f"{output.name} to {value:g}"),)
        case WaitInput(input=signal, value=value, timeout=timeout):
            longest = "for ever" if timeout is None else f"at most {timeout:g} s"
            return (("waits for", f"{signal.name} = {value:g}, {longest}"),)
        case WaitUntil(condition=condition, timeout=timeout):
            longest = "for ever" if timeout is None else f"at most {timeout:g} s"
            return (("waits for", f"{in_words(condition)}, {longest}"),)
        case Hold(text=text, register=register) if register:
            return (("asks", f"the operator for {register}: {text}"),)
        case Hold(text=text):
            return (("waits for", f"the operator{': ' * bool(text)}{text}"),)
        case When(condition=condition, within=float(within)):
            return (
                (
                    "waits for",
                    f"{in_words(condition)}, at most {within:g} s; then the other branch is carried out",
                ),
            )
        case When(offset=Offset(name=name)):
            return (("shifts", f"{{{name}}} when it runs; the place without a shift is shown"),)
        case When(condition=condition):
            compared = simple(condition)
            said = in_words(condition) if compared is None else f"{compared[0].name} = {compared[1]:g}"
            return (("if", f"{said}; both branches are shown one after the other"),)
        case Loop():
            return (("begins", "a loop; one pass of it is shown"),)
        case NextPass():
            return (("goes on", "with the next pass of the loop"),)
        case Exit():
            return (("leaves", "the loop" if step.origin.name != "RETURN" else "the SUB"),)
        case Say(text=name, teaches=teaches) if teaches:
            return (("keeps", f"{'its joints' if teaches == 'joints' else 'the pose of {TCP}'} as {name}"),)
        case Say(text=text):
            return (("tells", text),)
        case Finish(fails=fails, text=text):
            return (("ends", f"the program, as a fault: {text}" if fails else "the program"),)
        case Assign(target=target, value=number):
            register = target if isinstance(target, str) else target.name
            return (("sets", f"{register} to {in_words(number)}"),)
    return ()


@dataclass(frozen=True, eq=False)
class _Stands:
    """Determines the command, the time and the point on the path at which each finding is marked."""

    plan: MotionPlan
    flange_from_frame: Array
    pieces: tuple[Piece, ...]
    number_of: Mapping[int, int]
    scenes: Scenes

    def mark(self, finding: Diagnostic) -> Mark:
        """Return a finding with its command, time and place, if these are known."""
        step = self._step(finding)
        piece = self.number_of.get(step, -1) if step is not None else -1
        time = self._time(finding, step, self.pieces[piece]) if step is not None and piece >= 0 else None
        place = None if time is None else self._place(time, step)
        return Mark(finding.code, finding.severity, finding.message, finding.help, time, place, piece)

    def _step(self, finding: Diagnostic) -> int | None:
        source, span = finding.made_at
        if source is None or span is None:
            return None
        there = self._at_line.get((source.name, span.line), ())
        places = (number for number in there if finding.place and self._origin(number).place == finding.place)
        return next(places, there[0] if there else None)

    @cached_property
    def _at_line(self) -> Mapping[tuple[str, int], Sequence[int]]:
        """Return the steps that come from each line of each file."""
        found: dict[tuple[str, int], list[int]] = {}
        for number, step in enumerate(self.plan.program.steps):
            if not isinstance(step, Gap):
                span = step.origin.span
                for line in range(span.line, span.end_line + 1):
                    found.setdefault((step.origin.source.name, line), []).append(number)
        return found

    def _origin(self, number: int) -> Origin:
        step = self.plan.program.steps[number]
        assert not isinstance(step, Gap)  # no finding belongs to a gap
        return step.origin

    def _time(self, finding: Diagnostic, step: int | None, piece: Piece) -> float:
        """Return the time [s] at which the picture marks a finding.

        For bodies that collide, it is the time at which their distance is smallest relative to their margin.
        For other findings about a motion, it is the middle of the motion's time. For a motion that couldn't
        be planned, it is the time at which the motion would begin.
        """
        if not piece.moves:
            return piece.begins
        middle = (piece.begins + piece.ends) / 2.0
        scene = self.scenes.scene(int(self.scenes.numbers(np.array([middle]))[0]))
        if everything()[finding.code].sort == "meeting" and scene is not None:
            times = np.linspace(piece.begins, piece.ends, _LOOKS)
            closest = near(scene, self._positions(times, step)).closest
            return float(times[int(np.argmin(closest))])
        return middle

    def _place(self, time: float, step: int | None) -> Array:
        place: Array = tool_poses(
            self.plan.robot.chain, self._positions(np.array([time]), step), self.flange_from_frame
        )[0, :3, 3]
        return place

    def _positions(self, times: Array, step: int | None) -> Array:
        motions = self.plan.motions
        count = len(motions) if step is None else bisect_left(motions, step, key=lambda one: one.step)
        if step is not None and count < len(motions) and motions[count].step == step:
            return motions[count].curve.sample(times - self.plan.begins[count])[0]
        # Before a motion without a plan, the robot is at the end of the previous motion.
        q = motions[count - 1].curve.points[-1] if count else self.plan.program.start
        return np.tile(q, (len(times), 1))
