"""Messages about a program that is edited: its list, its forms, changes and the edits that make them,
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
    """The text of a program, as it is now: saved or not; `file` is its path in the project. `lines` are the
    first and the last line whose fields are wanted; null: all of them in a text of up to 1,000 lines, none in
    a longer one.
    """

    file: FileName
    text: ProgramText
    lines: tuple[Line, Line] | None = None


class CommandField(Message):
    """A part of a command: its value as it stands in the text (empty: it is left out), its unit, and what it
    may be.
    """

    name: str
    label: str
    kind: Literal["number", "percent", "choice", "frame", "joints", "pose", "signal", "text"]
    value: str
    unit: str
    choices: tuple[str, ...]


class ListedCommand(Message):
    """A command, a declaration, or a line of another kind: the name of a comment line is `!`, of one that
    can't be read `?`.
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
    """True if it can be touched up."""
    fields: tuple[CommandField, ...]


class ProgramListing(Message):
    """A program as a list."""

    commands: tuple[ListedCommand, ...]


class TeachMotion(Message):
    """A motion to where the robot is now, or to `joints` (in the order of the robot's joints, deg or mm),
    after a line (0: at the beginning).
    """

    kind: Literal["teach"]
    after: Line
    motion: Literal["MOVEJ", "MOVEL", "MOVEC", "DMOVE"]
    target: Literal["joints", "pose"] = "pose"
    joints: Values | None = None
    via: Values | None = None
    """The joints at the point that MOVEC goes through."""
    name: Name = ""
    """Name under which the place is declared; empty: the place stands in the line."""
    axes: Literal["base", "tool"] = "base"
    """For DMOVE: along the base frame's axes, or the tool's."""
    time: Annotated[str, Limited(max_length=40)] = ""
    """Content of the square brackets; empty: that of DEFAULT, else 50%."""


class TouchUp(Message):
    """Write the robot's present position, or `joints`, into a motion or declaration; `point` is the number of
    the way-point, 0: the last.
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
    """New values of fields; an empty one leaves the part out."""

    kind: Literal["change"]
    line: Line
    fields: FieldTexts


class DeleteLines(Message):
    """Lines to delete, first and last: with all rows of their statements, and whole blocks."""

    kind: Literal["delete"]
    lines: tuple[Line, Line]


class MoveLines(Message):
    """A statement or block that is put before another line (one more than there are lines: the end)."""

    kind: Literal["move"]
    line: Line
    before: Line


class DeclareName(Message):
    """A name for where the robot is now, or for `joints`."""

    kind: Literal["declare"]
    what: Literal["frame", "pose", "joints"]
    name: Name
    joints: Values | None = None


class RenumberAll(Message):
    """New indices for all commands."""

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
    """A requested change of a text."""

    file: FileName
    text: ProgramText
    change: ProgramChange


class TextEdit(Message):
    """Text in the place of other text. Lines and columns count from 1 and are those of the text that was
    sent; columns count UTF-16 code units, as browsers do; the end isn't included.
    """

    line: int
    column: int
    end_line: int
    end_column: int
    text: str


class EditedProgram(Message):
    """Edits that never overlap, in order; the place of the cursor afterwards, and a description."""

    edits: tuple[TextEdit, ...]
    line: int
    what: str


class CommandForm(Message):
    """Form for a new command: the name of a comment is `!`."""

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
    """A template to be filled in for this robot; `file` is the path of the new program."""

    template: Name
    file: FileName
    fields: FieldTexts = Limited(default_factory=dict)


class NewText(Message):
    """The text of a new program, proved for this robot; it isn't saved yet."""

    file: str
    text: str
