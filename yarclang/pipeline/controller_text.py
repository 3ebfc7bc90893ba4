"""Verify a controller text of unknown origin.

If its source program is found, the text is verified against this program. Otherwise it is verified for all
properties that need no program.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from yarclang.backend import suffixes
from yarclang.cell.model import Cell
from yarclang.certify.certificate import Certificate
from yarclang.certify.certifying import certify, certify_text
from yarclang.certify.read.header import header_of
from yarclang.certify.read.text import Unreadable
from yarclang.consulted import is_file
from yarclang.diagnostics import Diagnostic, Result, has_errors
from yarclang.emitted.header import Header
from yarclang.emitted.seal import is_sealed
from yarclang.findings import CATALOGUE
from yarclang.frozen import frozen
from yarclang.hir import Program
from yarclang.identity import fingerprint
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.cells import cell_for, is_same_file
from yarclang.pipeline.inputs import (
    Opened,
    Options,
    named_robot,
    open_program,
    robot_made_for,
    tolerance_of,
)
from yarclang.pipeline.origins import start_values
from yarclang.pipeline.project import Project, find_project
from yarclang.pipeline.sources import LARGEST_DATA, name_of, read_content
from yarclang.pipeline.stages import check_program, claims_of, plan_checked, plan_module
from yarclang.robot.model import Robot
from yarclang.semantics.context import GivenCell
from yarclang.source import SourceFile, Span

FIRST_WORDS = "; yarcc "
"""First words of a controller text."""

AGAIN = "the text was changed after yarcc wrote it: compile the program again"


@frozen(eq=False)
class JudgedText:
    """A controller text that was verified.

    Attributes:
        text: the text, as it was read.
        robot: the robot that the text is for.
        certificate: what was proved, with the lines to send.
        program: the source program against which the text was proved; None if it wasn't found.
        missing: reason why the source program wasn't found; empty if it was.
        cell: surroundings used in the proof.
        plan: plan of the source program if the text's header says that the text was compiled from exactly
            this program; else None.
    """

    text: SourceFile
    robot: Robot
    certificate: Certificate
    program: Program | None
    missing: str
    cell: Cell | None
    plan: MotionPlan | None = None


def is_compiled(file: str) -> bool:
    """Return True if a file's suffix is one that yarcc uses for some kind of controller."""
    return file.lower().endswith(suffixes())


def read_controller_text(path: str) -> Result[SourceFile]:
    """Read a file with one character per byte. Nothing is decoded, so that the judge (the independent
    verifier) sees the original bytes.
    """
    content = read_content(path, LARGEST_DATA)
    if content.value is None:
        return Result(None, content.diagnostics)
    return Result(SourceFile(name_of(path), content.value.decode("latin-1")))


def judge_text(
    text: SourceFile,
    folder: Path,
    options: Options,
    program: str | None = None,
) -> Result[JudgedText]:
    """Verify a controller text against its source program. If there is no program, verify all properties that
    need none.

    Args:
        text: a text of yarcc.
        folder: folder of the text, where its program is looked for.
        options: robot, tolerance and cell as requested; without a cell, that of the folder's yarc.toml is
            used.
        program: the program's file, if it is given.

    Returns:
        None, with the errors, if the text must not be carried out. A verified text may come with notes and
        warnings.
    """
    project = find_project(folder)
    if project.value is None:
        return Result(None, project.diagnostics)
    opened = _opened(text, options.robot, options.cell, folder, project.value, program)
    if opened.value is None:
        return Result(None, opened.diagnostics)
    header, robot, surroundings = opened.value
    plan_or_reason = _program_of(text, header, folder, robot, options, program)
    diagnostics = (*opened.diagnostics, *plan_or_reason.diagnostics)
    if plan_or_reason.value is None:
        return Result(None, diagnostics)
    if isinstance(plan_or_reason.value, str):
        around = None if surroundings is None else surroundings.loaded.value
        return _alone(text, robot, around, plan_or_reason.value, diagnostics)
    plan = plan_or_reason.value
    verified = plan.program
    # the program may be in another folder, whose yarc.toml names another cell or none
    if surroundings is not None:
        if verified.cell is not None and not is_same_file(
            Path(verified.cell.source.name), Path(surroundings.path)
        ):
            named = verified.cell.source.name
            message = (
                f"the program is compiled for the cell {named}, but {surroundings.giver} names "
                f"{surroundings.path}"
            )
            return Result(
                None,
                (
                    *diagnostics,
                    Diagnostic("Y1373", message, surroundings.source, surroundings.span, surroundings.remedy),
                ),
            )
        verified = replace(verified, cell=surroundings.loaded.value)
    tolerance = tolerance_of(robot, options.tolerance) or robot.tolerance
    does_the_same = fingerprint(plan.source_program) == header.program_fingerprint
    judged = certify(text.text, verified, robot, tolerance, claims_of(plan), any_line=does_the_same)
    # Other findings about the program are reported by yarcc and yarc check.
    errors = tuple(one for one in judged.diagnostics if one.is_error)
    made = _settled(text, robot, Result(judged.value, errors), verified, "", verified.cell, diagnostics)
    if made.value is None or not does_the_same:
        return made
    return Result(replace(made.value, plan=replace(plan, program=verified)), made.diagnostics)


def _remedy(text: SourceFile, program: Program | None) -> str:
    if program is None:
        return AGAIN
    made, source = Path(text.name).name, Path(program.source.name).name
    return (
        f"{made} was changed after yarcc wrote it, or {source} has changed since: compile the program again"
    )


def _in_text(finding: Diagnostic, text: SourceFile, certificate: Certificate | None) -> Diagnostic:
    """Move a finding about a command of the program to the first line of this command in the controller
    text.
    """
    if finding.source is text or certificate is None or finding.span is None:
        return finding if finding.source is text else replace(finding, source=text, span=None)
    line = finding.span.line
    entry = next((one for one in certificate.text.entries if one.source_line == line), None)
    span = None if entry is None else Span.on_line(entry.first or entry.at, 1, 2)
    return replace(finding, source=text, span=span)


def judge_alone(text: SourceFile, robot: str | None, cell: str | None) -> Result[JudgedText]:
    """Verify all properties of a controller text that need no source program, without looking for one.

    Args:
        text: a text of yarcc.
        robot: a robot's name or path; None: the robot that the header names.
        cell: description of the surroundings, if there is one.
    """
    opened = _opened(text, robot, cell, Path(), Project(Path()))
    if opened.value is None:
        return Result(None, opened.diagnostics)
    _, found, given = opened.value
    around = None if given is None else given.loaded.value
    return _alone(text, found, around, "no program was given", opened.diagnostics)


def _alone(
    text: SourceFile, robot: Robot, cell: Cell | None, missing: str, diagnostics: tuple[Diagnostic, ...]
) -> Result[JudgedText]:
    judged = certify_text(text.text, robot, text, cell)
    return _settled(text, robot, judged, None, missing, cell, diagnostics)


def _opened(
    text: SourceFile,
    name: str | None,
    cell: str | None,
    folder: Path,
    project: Project,
    program: str | None = None,
) -> Result[tuple[Header, Robot, GivenCell | None]]:
    """Read a controller text's header, and load the robot and the surroundings of the text. Nothing is
    verified yet. `program` is the file of the text's program, if it is given.
    """
    if not text.text.startswith(FIRST_WORDS):
        message = "this text wasn't written by yarcc"
        help_ = "give the program itself, or the text that yarcc made of it"
        return Result(None, (Diagnostic("Y1151", message, text, help=help_),))
    preamble = header_of(text.text)
    if isinstance(preamble, Unreadable):
        return Result(None, (_unreadable(preamble, text),))
    robot = robot_of(preamble.header, text, name, program)
    if robot.value is None:
        return Result(None, robot.diagnostics)
    given = cell_for(folder, project, robot.value, cell)
    told = (*robot.diagnostics, *given.diagnostics)
    return Result(None if has_errors(told) else (preamble.header, robot.value, given.value), told)


def _unreadable(place: Unreadable, text: SourceFile) -> Diagnostic:
    return Diagnostic(place.code, f"line {place.line} {place.reason}", text, help=AGAIN)


def _settled(
    text: SourceFile,
    robot: Robot,
    judged: Result[Certificate],
    program: Program | None,
    missing: str,
    cell: Cell | None,
    diagnostics: tuple[Diagnostic, ...],
) -> Result[JudgedText]:
    errors = [one for one in judged.diagnostics if one.is_error]
    findings = [one for one in judged.diagnostics if not one.is_error]
    if errors:
        # One change breaks many checks: report the cause, and drop its consequences.
        worst = next((one for one in errors if CATALOGUE[one.code].sort == "limits"), errors[0])
        rest = len(errors) - 1
        more = f" (and {rest:,} more error{'s' * (rest > 1)})" if rest else ""
        help_ = worst.help if worst.code == "Y1163" else _remedy(text, program)
        if CATALOGUE[worst.code].sort == "tolerance":
            help_ += "; or give the --tolerance with which it was compiled"
        placed = _in_text(worst, text, judged.value)
        findings.append(replace(placed, message=worst.message + more, help=help_, fix=None))
    elif judged.value is not None and not is_sealed(text.text):
        message = "the text was changed after yarcc wrote it: its SHA-256 differs from that in its header"
        findings = [Diagnostic("Y1169", message, text, help=AGAIN)]
    if judged.value is None or has_errors(findings):
        return Result(None, (*diagnostics, *findings))
    return Result(JudgedText(text, robot, judged.value, program, missing, cell), (*diagnostics, *findings))


def check_controller_text(path: str, options: Options) -> tuple[Diagnostic, ...]:
    """Verify a controller text in a file, as it is verified before a run, and return the findings."""
    read = read_controller_text(path)
    if read.value is None:
        return read.diagnostics
    return judge_text(read.value, Path(path).parent, options).diagnostics


def prove_against(text: SourceFile, opened: Opened) -> Result[Certificate]:
    """Verify a controller text against a given program.

    Args:
        text: the controller text.
        opened: the parsed program, with its robot.

    Returns:
        None, with the errors, if the program has errors, or if the text doesn't do what the program
        specifies.
    """
    planned = plan_module(opened.module, opened.request)
    if planned.value is None or has_errors(planned.diagnostics):
        return Result(None, planned.diagnostics)
    request = opened.request
    tolerance = request.tolerance or request.robot.tolerance
    judged = certify(text.text, planned.value.program, request.robot, tolerance, claims_of(planned.value))
    made = _settled(text, request.robot, judged, planned.value.program, "", None, planned.diagnostics)
    return Result(None if made.value is None else made.value.certificate, made.diagnostics)


def robot_of_text(text: SourceFile, name: str | None) -> Result[Robot]:
    """Load the robot for a controller text that is only displayed: the robot `name`, which must agree with
    the header, or without a name the robot of the header.
    """
    preamble = header_of(text.text)
    if isinstance(preamble, Unreadable):
        return Result(None, (_unreadable(preamble, text),))
    return robot_of(preamble.header, text, name)


def robot_of(header: Header, text: SourceFile, name: str | None, program: str | None = None) -> Result[Robot]:
    """Load the robot of a controller text.

    Args:
        header: header of the text.
        text: the text.
        name: name or path of the robot, with which the header must agree; None: the header's robot, which is
            that of the library, of the folder's yarc.toml or of the text's program.
        program: file of the text's program, if it is given.
    """
    folder = Path(text.name).parent
    loaded = robot_made_for(folder, header.robot) if name is None else named_robot(folder, name)
    if name is not None:
        if loaded.value is None or loaded.value.name == header.robot:
            return loaded
        message = f"the text was made for {header.robot}, but the command line names {loaded.value.name}"
        return Result(None, (Diagnostic("Y1163", message, text, help="remove --robot"),))
    if loaded.value is not None:
        return loaded
    for place, _ in _candidates(text, header, folder, program):
        opened = open_program(str(place), Options()).value if is_file(place) else None
        if opened is not None and opened.request.robot.name == header.robot:
            return Result(opened.request.robot)
    help_ = "if it is your own robot, give its path: --robot PATH"
    placed = tuple(one if one.source else replace(one, source=text) for one in loaded.diagnostics)
    return Result(None, tuple(replace(one, help=help_) for one in placed))


def _program_of(
    text: SourceFile, header: Header, folder: Path, robot: Robot, options: Options, named: str | None
) -> Result[MotionPlan] | Result[str]:
    """Return the plan of the program from which a controller text was compiled, or the reason why there is no
    program to verify against.
    """
    for place, required in _candidates(text, header, folder, named):
        if not is_file(place):
            if named is not None:
                message = f"{named}, the program, isn't there"
                return Result(None, (Diagnostic("Y0107", message, help="check the path"),))
            continue
        planned = _planned(place, header, robot, options, must=required)
        if planned.value is None and required:
            count = sum(one.is_error for one in planned.diagnostics)
            errors = f"{count} error{'s' * (count != 1)}"
            message = (
                f"{place.name}, the program beside this text, has {errors}: the text can't be proved "
                "against it"
            )
            told = Diagnostic("Y1192", message, text, help=f"yarc check {place.name} shows them")
            conflicts = (one for one in planned.diagnostics if one.code == "Y1373")
            return Result(None, (told, *conflicts))
        if planned.value is not None:
            return Result(planned.value)
    return Result(f"{folder / header.source}, the program, isn't there")


def _candidates(
    text: SourceFile, header: Header, folder: Path, named: str | None
) -> Iterator[tuple[Path, bool]]:
    """Yield the files that may be the source program of a controller text, each with True if it must be used
    when it exists.

    A file that the user names, or that is in the text's folder, must be used whatever it contains. A file in
    the working folder is used only if its content matches the header.
    """
    if named is not None:
        yield Path(named), True
        return
    plain = "/" not in header.source and header.source not in ("", "<stdin>", Path(text.name).name)
    if plain:
        yield folder / header.source, True
    yield (folder / Path(text.name).name).with_suffix(".yarc"), True
    if plain:
        yield Path(header.source), False


def _planned(
    place: Path, header: Header, robot: Robot, options: Options, *, must: bool
) -> Result[MotionPlan]:
    """Plan a program with the options in the header of a controller text. The plan gives claims, which the
    judge checks.

    If `must` is False and the controller text wasn't compiled from this program, the program isn't planned,
    and there are no findings.
    """
    with_options = replace(
        options,
        robot=str(robot.file),
        tm=float(header.longest) if header.longest else None,
        avoid_effort=header.searches,
        target=header.target,
    )
    start = start_values(header, robot)
    for position in (None, start):
        opened = open_program(str(place), replace(with_options, start=position))
        if opened.value is None or has_errors(opened.diagnostics):
            return Result(None, opened.diagnostics)
        checked = check_program(opened.value.module, opened.value.request)
        program = checked.value
        assert program is not None  # a check always gives a program
        stands = program.start / robot.axis_units
        if position is None and start is not None and np.abs(stands - np.array(start)).max() > _SAME_START:
            continue
        if not must and fingerprint(program) != header.program_fingerprint:
            break
        return plan_checked(checked, opened.value.request)
    return Result(None)


_SAME_START = 1e-3
"""Largest difference of two start positions [deg or mm] that the rounding of printed numbers can explain."""
