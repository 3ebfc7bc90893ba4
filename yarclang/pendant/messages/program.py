"""Messages about a program that is edited: its commands as a list, forms, changes and their edits,
templates.
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
    """Request for the list of a program's commands. `text` is the present text, saved or not; `file` is its
    path in the project. `lines` are the first and the last line for which fields are requested; null: all
    lines of a text of up to 1,000 lines, none of a longer text.
    """

    file: FileName
    text: ProgramText
    lines: tuple[Line, Line] | None = None


class CommandField(Message):
    """A field of a command: its value as written (empty if it is left out), its unit, and its possible
    values.
    """

    name: str
    label: str
    kind: Literal["number", "percent", "choice", "frame", "joints", "pose", "signal", "text"]
    value: str
    unit: str
    choices: tuple[str, ...]


class ListedCommand(Message):
    """A command, a declaration, or another line. `name` is `!` for a comment and `?` for a line that can't be
    parsed.
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
    """True if its position can be replaced by the robot's present one."""
    fields: tuple[CommandField, ...]


class ProgramListing(Message):
    """The commands of a program as a list."""

    commands: tuple[ListedCommand, ...]


class TeachMotion(Message):
    """A motion to insert: to the robot's present position or to `joints` (in the order of the robot's joints,
    deg or mm), after a line (0: at the beginning).
    """

    kind: Literal["teach"]
    after: Line
    motion: Literal["MOVEJ", "MOVEL", "MOVEC", "DMOVE"]
    target: Literal["joints", "pose"] = "pose"
    joints: Values | None = None
    via: Values | None = None
    """Joint positions at the intermediate point of a MOVEC [deg or mm]."""
    name: Name = ""
    """Name under which the goal is declared; empty: the goal is written in the command itself."""
    axes: Literal["base", "tool"] = "base"
    """For DMOVE: axes of the base frame, or of the tool."""
    time: Annotated[str, Limited(max_length=40)] = ""
    """Content of the square brackets; empty: that of DEFAULT, otherwise 50%."""


class TouchUp(Message):
    """Request to write the robot's present position, or `joints`, into a motion or declaration. `point` is
    the number of the way-point; 0: the last.
    """

    kind: Literal["touch-up"]
    line: Line
    point: Annotated[int, Limited(ge=0, le=100_000)] = 0
    joints: Values | None = None


class InsertCommand(Message):
    """A new command after a line (0: at the beginning), from a form."""

    kind: Literal["insert"]
    after: Line
    command: Annotated[str, Limited(max_length=200)]
    fields: FieldTexts = Limited(default_factory=dict)


class ChangeFields(Message):
    """New values of fields. An empty value removes the field from the command."""

    kind: Literal["change"]
    line: Line
    fields: FieldTexts


class DeleteLines(Message):
    """First and last line to delete. Statements of several lines and blocks are deleted as a whole."""

    kind: Literal["delete"]
    lines: tuple[Line, Line]


class MoveLines(Message):
    """A statement or block to move to before another line. To move it to the end, give the number of lines
    plus one.
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
    """An edit: a range of the old text, and the text that replaces it. Lines and columns count from 1, in the
    text that was sent; columns count UTF-16 code units, as browsers do; the end is exclusive.
    """

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class EditedProgram(Message):
    """Edits in order, which never overlap; the new place of the cursor; and a description."""

    edits: tuple[TextEdit, ...]
    line: int
    what: str


class CommandForm(Message):
    """Form for a new command; for a comment its name is `!`."""

    command: str
    label: str
    summary: str
    fields: tuple[CommandField, ...]


class CommandForms(Message):
    """The forms for new commands."""

    forms: tuple[CommandForm, ...]


class ProgramTemplate(Message):
    """A program to begin with."""

    name: str
    title: str
    summary: str
    fields: tuple[CommandField, ...]


class ProgramTemplates(Message):
    """Programs to begin with."""

    templates: tuple[ProgramTemplate, ...]


class NewProgram(Message):
    """Request to fill in a template for this robot. `file` is the path of the new program."""

    template: Name
    file: FileName
    fields: FieldTexts = Limited(default_factory=dict)


class NewText(Message):
    """Text of a new program, proved for this robot but not saved yet."""

    file: str
    text: str
