"""Messages about a program that is being edited: its commands as a list, forms, changes with the resulting
edits, and templates.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field as Limited

from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.people import Name

FileName = Annotated[str, Limited(min_length=1, max_length=1000)]
ProgramText = Annotated[str, Limited(max_length=1_000_000)]
Line = Annotated[int, Limited(ge=0, le=10_000_000)]
Values = Annotated[tuple[Number, ...], Limited(max_length=32)]
FieldText = Annotated[str, Limited(max_length=2000)]
FieldTexts = Annotated[dict[Name, FieldText], Limited(max_length=500)]


class ListProgram(Message):
    """Request for the list of a program's commands.

    `text` is the present text, saved or not. `file` is its path in the project. `lines` are the first and the
    last line for which fields are wanted. If `lines` is null, the reply has the fields of all lines, or no
    fields if the text has more than 1,000 lines.
    """

    file: FileName
    text: ProgramText
    lines: tuple[Line, Line] | None = None


class CommandField(Message):
    """A field of a command: its value as written (empty if the command doesn't have it), its unit, and its
    possible values.
    """

    name: str
    label: str
    kind: Literal["number", "percent", "choice", "frame", "joints", "pose", "signal", "text"]
    value: str
    unit: str
    choices: tuple[str, ...]


class ListedCommand(Message):
    """An entry of the list of commands: a command, a declaration, or any other line. `name` is `!` for a
    comment and `?` for a line that can't be parsed.
    """

    line: int
    rows: int
    depth: int
    kind: Literal["motion", "set", "wait", "hold", "call", "declaration", "block", "end", "other"]
    index: str
    name: str
    title: str
    detail: str
    target: Literal["joints", "pose"] | None
    taught: bool
    """True if the entry's position can be replaced by the robot's present one."""
    fields: tuple[CommandField, ...]


class ProgramListing(Message):
    """The commands of a program as a list."""

    commands: tuple[ListedCommand, ...]


class TeachMotion(Message):
    """Request to insert a motion after a line (0: at the beginning). Its goal is the robot's present
    position, or `joints` (in the order of the robot's joints, deg or mm).
    """

    kind: Literal["teach"]
    after: Line
    motion: Literal["MOVEJ", "MOVEL", "MOVEC", "DMOVE"]
    target: Literal["joints", "pose"] = "pose"
    joints: Values | None = None
    via: Values | None = None
    """For MOVEC: joint positions at the intermediate point [deg or mm]."""
    name: Name = ""
    """Name under which the goal is declared; empty: the goal is written in the command itself."""
    axes: Literal["base", "tool"] = "base"
    """For DMOVE: the frame whose axes are used, the base frame or the tool."""
    time: Annotated[str, Limited(max_length=40)] = ""
    """Text in the command's square brackets. Empty: the time of DEFAULT applies, or 50% if DEFAULT gives
    none.
    """


class TouchUp(Message):
    """Request to write the robot's present position, or `joints`, into a motion or declaration. `point` is
    the number of the waypoint; 0: the last.
    """

    kind: Literal["touch-up"]
    line: Line
    point: Annotated[int, Limited(ge=0, le=100_000)] = 0
    joints: Values | None = None


class InsertCommand(Message):
    """Request to insert a new command from a form after a line (0: at the beginning)."""

    kind: Literal["insert"]
    after: Line
    command: Annotated[str, Limited(max_length=200)]
    fields: FieldTexts = Limited(default_factory=dict)


class ChangeFields(Message):
    """Request to change fields of a command. An empty value removes the field from the command."""

    kind: Literal["change"]
    line: Line
    fields: FieldTexts


class DeleteLines(Message):
    """Request to delete lines, from a first to a last one. Blocks, and statements of several lines, are
    deleted as a whole.
    """

    kind: Literal["delete"]
    lines: tuple[Line, Line]


class MoveLines(Message):
    """Request to move the statement or block in `line` in front of the line `before`. The number of lines
    plus one as `before` moves it to the end.
    """

    kind: Literal["move"]
    line: Line
    before: Line


class DeclareName(Message):
    """Request to declare a name for the robot's present position, or for `joints`."""

    kind: Literal["declare"]
    what: Literal["frame", "pose", "joints"]
    name: Name
    joints: Values | None = None


class RenumberAll(Message):
    """Request for new indices of all commands."""

    kind: Literal["renumber"]


ProgramChange = Annotated[
    TeachMotion
    | TouchUp
    | InsertCommand
    | ChangeFields
    | DeleteLines
    | MoveLines
    | DeclareName
    | RenumberAll,
    Limited(discriminator="kind"),
]


class EditProgram(Message):
    """A requested change of a program."""

    file: FileName
    text: ProgramText
    change: ProgramChange


class TextEdit(Message):
    """An edit: a range of the old text, and the text that replaces it.

    Lines and columns count from 1, in the text that was sent. Columns count UTF-16 code units, as browsers
    do. The end of the range isn't part of it.
    """

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class EditedProgram(Message):
    """Result of a change: the edits in the order of the text, the line of the cursor after the change, and a
    description of the change. The edits never overlap.
    """

    edits: tuple[TextEdit, ...]
    line: int
    what: str


class CommandForm(Message):
    """Form for a new command. For a comment, its name is `!`."""

    command: str
    label: str
    summary: str
    fields: tuple[CommandField, ...]


class CommandForms(Message):
    """The forms for new commands."""

    forms: tuple[CommandForm, ...]


class ProgramTemplate(Message):
    """A template: a complete program with which a user can begin."""

    name: str
    title: str
    summary: str
    fields: tuple[CommandField, ...]


class ProgramTemplates(Message):
    """The templates for new programs."""

    templates: tuple[ProgramTemplate, ...]


class NewProgram(Message):
    """Request to fill in a template for this robot. `file` is the path of the new program."""

    template: Name
    file: FileName
    fields: FieldTexts = Limited(default_factory=dict)


class NewText(Message):
    """Text of a new program, which was proved for this robot but isn't saved yet."""

    file: str
    text: str
