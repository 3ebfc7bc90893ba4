"""Messages about the workspace: its zones, obstacles and joint limits; drafts of changes, and the programs
that have errors with a draft; and distances between bodies.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.files import FilePath, FileWritten, Sha256

MOST_CHANGES = 200
"""Largest number of zones, obstacles and joints that one draft changes."""

Word = Annotated[str, Field(max_length=100)]
Triple = Annotated[tuple[Number, ...], Field(max_length=3)]
Pair = Annotated[tuple[Number, ...], Field(max_length=2)]
Table = Literal["obstacles", "zones"]


class EntryValues(Message):
    """The keys of a zone or an obstacle as written in cell.toml, in the units of the file. Null: the key is
    missing.
    """

    name: Word | None = None
    rule: Word | None = None
    shape: Word | None = None
    frame: Word | None = None
    xyz: Triple | None = None
    rpy: Triple | None = None
    quat: Annotated[tuple[Number, ...], Field(max_length=4)] | None = None
    size: Triple | None = None
    radius: Number | None = None
    length: Number | None = None
    normal: Triple | None = None
    margin: Number | None = None
    speed: Number | None = None
    watch: Annotated[tuple[Word, ...], Field(max_length=50)] | None = None
    joints: Annotated[dict[Word, Pair], Field(max_length=32)] | None = None
    file: Annotated[str, Field(max_length=1000)] | None = None
    units: Word | None = None


class EntryChange(Message):
    """A change of a zone or an obstacle. `at` is the index of the entry in its table, from 0 (null: a new
    entry). Without `values` the entry is removed.
    """

    table: Table
    at: Annotated[int, Field(ge=0, le=100_000)] | None
    values: EntryValues | None


class LimitChange(Message):
    """New position limits of a joint [deg or mm]."""

    joint: Word
    lower: Number
    upper: Number


class WorkspaceDraft(Message):
    """Changes that are made together. `known` and `robot_known` are the hashes of the versions of cell.toml
    and robot.toml that were edited; null: this file isn't changed.
    """

    known: Sha256 | None = None
    entries: Annotated[tuple[EntryChange, ...], Field(max_length=MOST_CHANGES)] = ()
    robot_known: Sha256 | None = None
    limits: Annotated[tuple[LimitChange, ...], Field(max_length=32)] = ()


class WorkspaceFrame(Message):
    """A frame in which bodies can be placed, as a matrix (3, 4), row by row, with lengths in m. It is
    flange_from_frame for a frame on the flange, otherwise base_from_frame.
    """

    name: str
    on_flange: bool
    pose: tuple[float, ...]


class WorkspaceEntry(Message):
    """A zone or an obstacle as written in the file."""

    table: Table
    at: int
    line: int
    values: EntryValues
    metre: float | None
    """Length of the entry's unit of length [m]; null: the file names none."""
    radian: float | None
    """Size of the entry's unit of angle [rad]; null: the file names none."""
    length_unit: str
    angle_unit: str
    speed_unit: str


class JointLimits(Message):
    """The position limits of a joint in robot.toml [deg or mm], null if not given, and the limits in the
    URDF.
    """

    name: str
    unit: str
    lower: float | None
    upper: float | None
    least: float | None
    largest: float | None


class WorkspaceShown(Message):
    """The workspace as described by the files."""

    cell: str | None
    """Path of the cell's file in the project, or its absolute path if it is outside of the project; null:
    there is no cell.
    """
    why: str
    """Reason why the cell can't be changed here, and the remedy; empty: it can."""
    known: str
    entries: tuple[WorkspaceEntry, ...]
    frames: tuple[WorkspaceFrame, ...]
    watch: tuple[str, ...]
    """Names of the bodies that a zone can watch."""
    length_unit: str
    angle_unit: str
    metre: float | None
    radian: float | None
    findings: tuple[Finding, ...]
    robot: str
    """Path of the robot's file in the project, or its absolute path."""
    robot_why: str
    robot_known: str
    joints: tuple[JointLimits, ...]
    robot_waits: bool
    """True if robot.toml differs from the description that the pendant uses. The file takes effect after a
    restart.
    """


class ProposedFile(Message):
    """A file before and after a draft. `refused` is the reason why it can't be saved; empty: it can be."""

    file: str
    before: str
    after: str
    known: str
    what: str
    refused: str
    findings: tuple[Finding, ...]


class Proposed(Message):
    """The files with the changes of a draft."""

    files: tuple[ProposedFile, ...]


class SavedWorkspace(Message):
    """The files that were written, and the time at which their changes take effect."""

    files: tuple[FileWritten, ...]
    told: str


class MakeCell(Message):
    """Request for a new cell.toml at a path, in a project that has none."""

    file: FilePath = "cell.toml"


class JudgedProgram(Message):
    """Result for a program of the project. `held` is true if it compiles without the draft, `holds` if it
    compiles with the draft (null: not known). The other fields describe the first error with the draft.
    """

    file: str
    held: bool | None
    holds: bool | None
    line: int | None = None
    code: str = ""
    message: str = ""


class CheckShown(Message):
    """A check of all programs with a draft. Programs that have errors only with the draft come first.
    `standing` lists the errors that the draft causes at the robot's present position.
    """

    state: Literal["none", "running", "done", "cancelled", "failed"]
    by: str
    mine: bool
    done: int
    of: int
    file: str
    """Program that is being checked."""
    broken: int
    unjudged: int
    """Number of programs without a result: they have errors even without the draft, or couldn't be checked in
    time.
    """
    programs: tuple[JudgedProgram, ...]
    standing: tuple[str, ...]
    what: str
    digest: str
    """Hash of the files with the changes of the checked draft."""


class AskDistances(Message):
    """Request for the pairs of bodies that are nearest to each other now. With `draft`, the bodies of the
    draft are used instead of those in the file.
    """

    draft: WorkspaceDraft | None = None


class DistanceShown(Message):
    """A pair of bodies, or a watched body and its zone. `distance` [mm] is negative if they overlap, or if
    the body is beyond the border. `margin` is the required distance [mm], and `points` are the nearest points
    [m], if known.
    """

    first: str
    second: str
    distance: float
    margin: float
    points: tuple[float, ...] = ()


class Distances(Message):
    """The nearest pairs, nearest first. `what` is the reason if there are none."""

    pairs: tuple[DistanceShown, ...]
    what: str
