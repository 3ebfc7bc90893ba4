"""Compile a program text to certified controller text."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from pathlib import PurePath

import numpy as np

from yarclang import __version__
from yarclang.backend import Backend, Written, backend_of
from yarclang.cell.model import Cell
from yarclang.certify.certificate import Certificate
from yarclang.certify.certifying import certify
from yarclang.certify.claims import Claims
from yarclang.certify.legs import strayed
from yarclang.diagnostics import Diagnostic, Result, grouped, has_errors, in_order
from yarclang.emitted.header import Header
from yarclang.emitted.seal import sealed
from yarclang.frozen import frozen
from yarclang.hir import (
    ArcMove,
    Array,
    AvoidMove,
    Gap,
    JointMove,
    LineMove,
    Motion,
    PoseGoal,
    Program,
    Step,
)
from yarclang.identity import fingerprint
from yarclang.memory import NO_MEMORY, Memory
from yarclang.motion.plan import MotionPlan
from yarclang.motion.planner import Settings, plan, plan_in_part
from yarclang.motion.profile import profile_names
from yarclang.pipeline.stands import unreachable_ways_out
from yarclang.progress import tell
from yarclang.robot.model import Robot, Tolerance
from yarclang.semantics.check import check
from yarclang.semantics.context import Context, GivenCell
from yarclang.semantics.control.arguments import name_arguments_of_times
from yarclang.semantics.motions.trajectory_file import TrajectoryFile
from yarclang.source import SourceFile
from yarclang.syntax.ast import Module

CellNow = Callable[[Cell, Array], Cell | None]
"""Function that takes a cell and the joint positions (n,) at which a program starts, and returns the cell
with its parts where they are now. It returns None if only the places in the cell's file are known.
"""


@frozen(eq=False)
class Request:
    """Settings for compiling a program.

    Attributes:
        start: (n,) [rad or m] position of the robot, which overrides the program's START; None: the START
            counts.
        fallback_start: (n,) [rad or m] position of the robot if the program has no START.
        tm: longest segment time to use [ms].
        tolerance: tolerance of the path; None: the robot's.
        target: kind of controller text; empty: the first kind that the robot's controller has.
        load: function that reads the program's modules.
        load_cell: function that reads the program's cell.
        load_table: function that reads the program's trajectory files.
        cell: cell that is used even if the program has no CELL line.
        index_needed: True if every command must have an index.
        memory: cache for results of the stages.
        enough: number of lines in loops and SUBs after which a quick check stops.
        present: function that returns the program's cell with its parts where they are when it starts; None:
            the parts are where the cell's file has them.
        avoid_effort: number of paths around obstacles to search for; the fastest of them is used.
    """

    robot: Robot
    start: Array | None = None
    fallback_start: Array | None = None
    tm: float | None = None
    tolerance: Tolerance | None = None
    target: str = ""
    load: Callable[[str], Result[Module]] | None = None
    load_cell: Callable[[str, SourceFile | None], Result[Cell]] | None = None
    load_table: Callable[[str, SourceFile | None], Result[TrajectoryFile]] | None = None
    cell: GivenCell | None = None
    index_needed: bool = True
    memory: Memory = NO_MEMORY
    enough: int | None = None
    present: CellNow | None = None
    avoid_effort: int = 1


@frozen(eq=False)
class Compiled:
    """A compiled program: the text and all intermediate results."""

    text: str
    program: Program
    plan: MotionPlan
    certificate: Certificate


def check_program(module: Module, request: Request) -> Result[Program]:
    """Check a syntax tree, and return the program."""
    checked = check(module, context_of(request))
    program = checked.value
    if program is None or request.present is None or program.cell is None or not program.cell.parts:
        return checked
    cell = request.present(program.cell, program.start)
    return checked if cell is None else Result(replace(program, cell=cell), checked.diagnostics)


def context_of(request: Request) -> Context:
    """Return the settings of a request that the checks need."""
    return Context(
        request.robot,
        profile_names(),
        request.start,
        request.fallback_start,
        request.load,
        request.load_cell,
        request.load_table,
        request.cell,
        request.index_needed,
        request.memory,
        request.enough,
    )


def plan_program(program: Program, request: Request) -> Result[MotionPlan]:
    """Plan a checked program. Only segment times that the controller accepts are used."""
    settings = _settings(request)
    if settings.value is None:
        return Result(None, settings.diagnostics)
    planned = plan(program, request.robot, settings.value)
    if planned.value is None or (fault := strayed(program, planned.value.program)) is None:
        return planned
    return Result(None, (*planned.diagnostics, fault))


def shown_plan(program: Program, request: Request) -> MotionPlan | None:
    """Plan as much as possible of a program with errors, for display. Return None if the settings in the
    request are invalid.
    """
    settings = _settings(request)
    return None if settings.value is None else plan_in_part(program, request.robot, settings.value)[0]


def _settings(request: Request) -> Result[Settings]:
    grid = backend_of(request.robot).grid(request.robot, request.tm)
    if grid.value is None:
        return Result(None, grid.diagnostics)
    tolerance = request.tolerance or request.robot.tolerance
    return Result(Settings(grid.value, tolerance, request.memory, request.avoid_effort))


def plan_module(module: Module, request: Request) -> Result[MotionPlan]:
    """Plan a syntax tree. A program with errors is planned as well, to find further errors."""
    return plan_checked(check_program(module, request), request)


def plan_checked(checked: Result[Program], request: Request) -> Result[MotionPlan]:
    """Plan a program that was checked, and return the findings of the check and of the planning together."""
    assert checked.value is not None  # a check always gives a program
    program = checked.value
    if has_errors(checked.diagnostics):
        program = _shortened(program)
    planned = plan_program(program, request)
    told = name_arguments_of_times(planned.diagnostics, program.steps)
    diagnostics = in_order(grouped((*checked.diagnostics, *told), at_least=program.is_cut))
    return Result(None if has_errors(diagnostics) else planned.value, diagnostics)


ENOUGH_MOTIONS = 300
"""Number of motions in loops and SUBs that are planned for a program with errors."""


def _shortened(program: Program) -> Program:
    """Shorten a program with errors, so that planning it doesn't take long: of the motions in loops and SUBs,
    those after the first `ENOUGH_MOTIONS` are replaced by gaps.
    """
    remaining, steps = ENOUGH_MOTIONS, list[Step]()
    for step in program.steps:
        if isinstance(step, Motion) and step.origin.place:
            remaining -= 1
            steps.append(step if remaining >= 0 else Gap())
        else:
            steps.append(step)
    return program if remaining >= 0 else replace(program, steps=tuple(steps), is_cut=True)


def compile_module(module: Module, request: Request) -> Result[Compiled]:
    """Compile a syntax tree to certified controller text.

    Returns:
        None if a stage finds an error. A text that isn't completely proved is never returned.
    """
    planned = plan_module(module, request)
    if planned.value is None:
        return Result(None, planned.diagnostics)
    made = certified_whole(planned.value, request)
    return Result(made.value, in_order((*planned.diagnostics, *made.diagnostics)))


def certified_whole(planned: MotionPlan, request: Request) -> Result[Compiled]:
    """Certify a complete program: its controller text, and the ways out of its ONs (the SUBs by which the
    robot withdraws) from all places at which they may begin.
    """
    compiled = certified(planned, request)
    if compiled.value is None:
        return compiled

    part_request = Request(
        request.robot, tm=request.tm, tolerance=request.tolerance, avoid_effort=request.avoid_effort
    )

    def refused(program: Program) -> str:
        plan = plan_program(program, part_request)
        findings = plan.diagnostics
        if plan.value is not None:
            findings = (*findings, *certified(plan.value, part_request).diagnostics)
        return next((one.message for one in findings if one.is_error), "")

    findings = tuple(unreachable_ways_out(planned, refused))
    return Result(None, (*compiled.diagnostics, *findings)) if findings else compiled


def certified(planned: MotionPlan, request: Request) -> Result[Compiled]:
    """Print a motion plan as controller text, read the text back, and prove it."""
    tolerance = request.tolerance or request.robot.tolerance
    tell("writing the controller text", 0)
    backend = backend_of(planned.robot)
    if request.target and request.target not in backend.targets:
        return Result(None, (_no_target(backend, request.target),))
    written = backend.write(planned, request.target or backend.targets[0], tolerance, request.memory)
    if written.value is None:
        return Result(None, written.diagnostics)
    header = _header(written.value, planned, request)
    tell("certifying: reading the text", 0)
    text = written.value.text(header.lines())
    # Free this memory: for a long text, it is as much as all data of the proof.
    del written
    judged = proved(text, planned, request)
    if judged.value is None or has_errors(judged.diagnostics):
        return Result(None, judged.diagnostics)
    # The final text differs from the verified text in only two comments.
    final = sealed(text, judged.value.summary())
    return Result(Compiled(final, planned.program, planned, judged.value), judged.diagnostics)


def proved(text: str, planned: MotionPlan, request: Request) -> Result[Certificate]:
    """Verify a controller text against its source program. The judge reads both independently.

    Args:
        text: the controller text.
        planned: plan of the program. It only gives claims, which are checked.
        request: tolerance and other settings of the compilation.
    """
    tolerance = request.tolerance or request.robot.tolerance
    return certify(text, planned.program, request.robot, tolerance, claims_of(planned), request.memory)


@cache
def _made_with(searches: bool) -> str:
    """Return the names and versions of the packages that affect a compiled program, as a text for its
    header.
    """
    import pinocchio
    import scipy

    packages = (
        f"numpy {np.__version__}, pin {pinocchio.__version__}, scipy {scipy.__version__}, toppra "
        f"{version('toppra')}"
    )
    return f"{packages}, ompl {version('ompl')}" if searches else packages


def _no_target(backend: Backend, target: str) -> Diagnostic:
    message = f"{backend.kind.title} has no target {target}"
    return Diagnostic("Y1104", message, help=f"its targets are {', '.join(backend.targets)}")


def _header(written: Written, planned: MotionPlan, request: Request) -> Header:
    """Return the header of a controller text, which describes the text to a reader. Certificate and seal are
    added later.
    """
    robot = planned.robot
    searches = any(
        isinstance(step, AvoidMove) or (isinstance(step, LineMove) and step.avoids)
        for step in planned.source_program.steps
    )
    return Header(
        version=__version__,
        source=_printable(PurePath(planned.program.source.name).name),
        target=written.target,
        loading=written.loading,
        robot=robot.name,
        robot_fingerprint=robot.fingerprint,
        program_fingerprint=fingerprint(planned.source_program, request.memory),
        made_with=_made_with(searches),
        start=written.start,
        units=", ".join(dict.fromkeys(robot.axis_unit_names)),
        lasting=planned.lasting,
        segments=written.segments,
        longest="" if request.tm is None else written.time(request.tm),
        searches=request.avoid_effort if searches else 1,
    )


def _printable(name: str) -> str:
    """Return a file's name in ASCII on one line."""
    return (
        "".join(one if one.isprintable() else "?" for one in name)
        .encode("ascii", "backslashreplace")
        .decode()
    )


def _chooses_posture(step: Step) -> bool:
    """Return True for a joint motion to a pose, which the planner may reach in several postures."""
    return isinstance(step, JointMove) and isinstance(step.goal, PoseGoal)


def claims_of(planned: MotionPlan) -> Claims:
    """Return all claims of a plan (values that the judge checks instead of computing). docs/certificate.md
    lists how each value is checked.
    """
    steps = planned.program.steps
    return Claims(
        witnesses={motion.step: np.asarray(motion.waypoints) for motion in planned.motions},
        laws={
            # The judge needs no law for motions along lines and arcs.
            motion.step: motion.law
            for motion in planned.motions
            if not isinstance(steps[motion.step], LineMove | ArcMove)
        },
        kept={motion.step: motion.kept for motion in planned.motions if motion.kept < 1.0},
        least={motion.step: motion.least for motion in planned.motions if motion.least < 1.0},
        overlaps={motion.step: 2.0 * motion.half for motion in planned.motions if motion.overlap},
        postures={
            motion.step: motion.curve.points[-1]
            for motion in planned.motions
            if not motion.flows and _chooses_posture(steps[motion.step])
        },
        any_jerk=planned.any_jerk,
    )
