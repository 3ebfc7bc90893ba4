"""HTTP routes for a program that is being edited: its list of commands, changes of commands, the forms in
which commands are edited, and templates. No route writes a file.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.messages import program as said
from yarclang.pendant.project.git import text_of
from yarclang.pendant.standing import stands
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.teaching import changing, declaring, forms, lines, listing, motions, points, templates
from yarclang.teaching.edits import Edited, Program
from yarclang.teaching.fields import Field
from yarclang.teaching.holding import Around, around
from yarclang.teaching.wording import checked


async def _list(service: Service, request: Request) -> Response:
    service.session(request)
    asked = await body(request, said.ListProgram)
    place = await asyncio.to_thread(service.files.folder.path, asked.file)
    return await asyncio.to_thread(_listing, service.robot, place, asked)


def _listing(robot: Robot, place: Path, request_body: said.ListProgram) -> Response:
    listed = listing.listing(SourceFile(str(place), request_body.text), robot.joint_names, request_body.lines)
    return answer(
        said.ProgramListing(
            commands=tuple(
                said.ListedCommand.model_construct(
                    line=one.line,
                    rows=one.rows,
                    depth=one.depth,
                    kind=one.kind,
                    index=one.index,
                    name=one.name,
                    title=one.title,
                    detail=one.detail,
                    target=one.target,
                    taught=one.taught,
                    fields=_fields(one.fields),
                )
                for one in listed
            )
        )
    )


def _fields(fields: Iterable[Field]) -> tuple[said.CommandField, ...]:
    return tuple(
        said.CommandField.model_construct(
            name=one.name,
            label=one.label,
            kind=one.kind,
            value=one.value,
            unit=one.unit,
            choices=one.choices,
        )
        for one in fields
    )


async def _edit(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    service.accounts.used(session)
    request_body = await body(request, said.EditProgram)
    place = await asyncio.to_thread(service.files.folder.path, request_body.file)
    change, joints = request_body.change, None
    if isinstance(change, said.TeachMotion | said.TouchUp | said.DeclareName):
        joints = (
            _joint_positions(service.robot, change.joints)
            if change.joints is not None
            else await stands(service.watched)
        )
    return await asyncio.to_thread(_edited, service.robot, place, request_body.text, change, joints)


def _joint_positions(robot: Robot, values: tuple[float, ...]) -> Array:
    """Convert the joint positions in a message to an array (n,) [rad or m], and check them against the joint
    limits.

    Raises:
        Trouble: the number of joints is wrong, or a position is beyond its limits.
    """
    if len(values) != robot.size:
        problem = f"{len(values)} joint values are given; {robot.name} has {robot.size} joints"
        raise Trouble(problem, "give one value per joint", "joints")
    q = np.array(values) * robot.axis_units
    for at, name in enumerate(robot.joint_names):
        lower, upper = robot.limits.lower[at], robot.limits.upper[at]
        if not lower - 1e-9 <= q[at] <= upper + 1e-9:
            unit, factor = robot.axis_unit_names[at], robot.axis_units[at]
            problem = (
                f"{name} {values[at]:g} {unit} is beyond its limits, {lower / factor:g} to "
                f"{upper / factor:g} {unit}"
            )
            raise Trouble(problem, "move it inside", "joints")
    return q


def _edited(
    robot: Robot, place: Path, text: str, change: said.ProgramChange, joints: Array | None
) -> Response:
    program = Program(SourceFile(str(place), text))
    made = _changed(program, robot, place, change, joints)
    return answer(said.EditedProgram(edits=tuple(_text_edits(program, made)), line=made.line, what=made.what))


def _changed(
    program: Program, robot: Robot, place: Path, change: said.ProgramChange, joints: Array | None
) -> Edited:
    match change:
        case said.ChangeFields():
            return changing.change(program, change.line, change.fields, robot.joint_names)
        case said.DeleteLines(lines=(first, last)):
            return lines.delete(program, first, last)
        case said.MoveLines():
            return lines.move(program, change.line, change.before)
        case said.RenumberAll():
            return lines.renumbered(program)
        case _:
            return _with_names(around(program, place.parent, robot), change, joints)


def _with_names(named: Around, change: said.ProgramChange, joints: Array | None) -> Edited:
    """Carry out a change that needs the meanings of the names in the program, such as a taught motion."""
    if isinstance(change, said.InsertCommand):
        return forms.put_in(named, change.after, change.command, change.fields)
    assert joints is not None  # such a change has joint positions, from the request or the robot
    match change:
        case said.TeachMotion():
            taught = motions.Taught(
                change.motion,
                change.target,
                None if change.via is None else _joint_positions(named.robot, change.via),
                change.name,
                change.axes,
                _time(change.time),
            )
            return motions.teach(named, change.after, taught, joints)
        case said.TouchUp():
            return points.touch_up(named, change.line, joints, change.point)
        case said.DeclareName():
            return declaring.declare(named, change.what, change.name, joints)
        case _:
            raise AssertionError(change)


def _time(text: str) -> str:
    """Return a motion time as written in the square brackets of a command."""
    text = text.strip()
    if text.endswith("%"):
        return f"{checked('percent', 'percent', text)}%"
    if text[:1].upper() == "V" and "<=" in text:
        return f"V<={checked('ceiling', 'number', text.partition('<=')[2])}"
    if text[:1].upper() == "V":
        return f"V {checked('speed', 'number', text[1:])}"
    return checked("time", "number", text)


def _text_edits(program: Program, edited: Edited) -> Iterable[said.TextEdit]:
    for edit in edited.edits:
        span = edit.span
        yield said.TextEdit(
            line=span.line,
            column=_as_browsers(program, span.line, span.column),
            end_line=span.end_line,
            end_column=_as_browsers(program, span.end_line, span.end_column),
            text=edit.text,
        )


def _as_browsers(program: Program, line: int, column: int) -> int:
    """Convert a column to UTF-16 code units, in which browsers count."""
    return column + sum(ord(one) > 0xFFFF for one in program.content(line)[: column - 1])


async def _forms(service: Service, request: Request) -> Response:
    service.session(request)
    file = request.query_params.get("file", "")
    return await asyncio.to_thread(_forms_of, service, file or "new.yarc", None if file else "")


async def _forms_for(service: Service, request: Request) -> Response:
    service.session(request)
    asked = await body(request, said.ListProgram)
    return await asyncio.to_thread(_forms_of, service, asked.file, asked.text)


def _forms_of(service: Service, file: str, text: str | None) -> Response:
    robot, folder = service.robot, service.files.folder
    place = folder.path(file)
    if text is None:
        text = text_of(file, folder.read(file)[0])
    names = forms.known(around(Program(SourceFile(str(place), text)), place.parent, robot))
    found_forms = tuple(
        said.CommandForm(
            command=one.command, label=one.label, summary=one.summary, fields=_fields(one.fields)
        )
        for one in forms.forms(names, robot)
    )
    return answer(said.CommandForms(forms=found_forms))


async def _templates(service: Service, request: Request) -> Response:
    service.session(request)
    found = tuple(
        said.ProgramTemplate(name=one.name, title=one.title, summary=one.summary, fields=_fields(one.fields))
        for one in templates.templates()
    )
    return answer(said.ProgramTemplates(templates=found))


async def _new(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    service.accounts.used(session)
    asked = await body(request, said.NewProgram)
    place = await asyncio.to_thread(service.files.folder.path, asked.file)
    text = await asyncio.to_thread(templates.new, asked.template, service.robot, asked.fields, place.parent)
    made: Message = said.NewText(file=asked.file, text=text)
    return answer(made)


ROUTES = (
    Route("POST", "/api/program/list", _list, "Return a program as a list of commands, however broken it is.",
        said.ListProgram, said.ProgramListing, "viewer"),
    Route("POST", "/api/program/edit", _edit,
        "Return the edits that make a change of a program; nothing is saved.", said.EditProgram,
            said.EditedProgram, "programmer"),
    Route("GET", "/api/program/forms", _forms,
        "Return the forms for new commands, with the names that the saved program `file` knows (?file=; "
        "without: those of the project).", None, said.CommandForms, "viewer"),
    Route("POST", "/api/program/forms", _forms_for,
        "Return the forms for new commands, with the names that a text knows.", said.ListProgram,
            said.CommandForms, "viewer"),
    Route("GET", "/api/program/templates", _templates, "Return the programs to begin with.", None,
        said.ProgramTemplates, "viewer"),
    Route("POST", "/api/program/new", _new,
        "Return a program to begin with that is proved for this robot; nothing is saved.", said.NewProgram,
            said.NewText, "programmer"),
)  # fmt: skip
"""All routes of this file."""
