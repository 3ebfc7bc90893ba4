"""Messages about the workspace: zones, obstacles, limits of joints; drafts of changes, what they break, and
distances.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.files import FilePath, FileWritten, Sha256

MOST_CHANGES = 200
"""Zones, obstacles and joints that one draft changes."""

Word = Annotated[str, Field(max_length=100)]
Triple = Annotated[tuple[Number, ...], Field(max_length=3)]
Pair = Annotated[tuple[Number, ...], Field(max_length=2)]
Table = Literal["obstacles", "zones"]


class EntryValues(Message):
    """The keys of a zone or an obstacle as cell.toml has them, in its units; null: the key isn't there."""

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
    """A zone or an obstacle that changes: `at` counts the entries of its table from 0 (null: a new one);
    without `values` it is removed.
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
    """Changes that belong together. `known` and `robot_known` are the hashes of the files that they were made
    from; null: that file isn't changed.
    """

    known: Sha256 | None = None
    entries: Annotated[tuple[EntryChange, ...], Field(max_length=MOST_CHANGES)] = ()
    robot_known: Sha256 | None = None
    limits: Annotated[tuple[LimitChange, ...], Field(max_length=32)] = ()


class WorkspaceFrame(Message):
    """A frame in which bodies may stand: (3, 4) base_from_frame [m], row by row; on the flange:
    flange_from_frame.
    """

    name: str
    on_flange: bool
    pose: tuple[float, ...]


class WorkspaceEntry(Message):
    """A zone or an obstacle as the file has it."""

    table: Table
    at: int
    line: int
    values: EntryValues
    metre: float | None
    """One of its units of length [m]; null: the file names none."""
    radian: float | None
    """One of its units of angle [rad]."""
    length_unit: str
    angle_unit: str
    speed_unit: str


class JointLimits(Message):
    """The position limits of a joint in robot.toml [deg or mm], null without one, and those that the URDF
    allows.
    """

    name: str
    unit: str
    lower: float | None
    upper: float | None
    least: float | None
    largest: float | None


class WorkspaceShown(Message):
    """The workspace as the files have it."""

    cell: str | None
    """The file of the cell: its path in the project; outside of it, the whole path; null: there is no cell.
    """
    why: str
    """Reason why the cell can't be changed here, and the remedy; empty: it can."""
    known: str
    entries: tuple[WorkspaceEntry, ...]
    frames: tuple[WorkspaceFrame, ...]
    watch: tuple[str, ...]
    """Names of items that a zone may watch."""
    length_unit: str
    angle_unit: str
    metre: float | None
    radian: float | None
    findings: tuple[Finding, ...]
    robot: str
    """The file of the robot: its path in the project, or the whole path."""
    robot_why: str
    robot_known: str
    joints: tuple[JointLimits, ...]
    robot_waits: bool
    """True if robot.toml differs from the served robot: it takes effect after a restart."""


class ProposedFile(Message):
    """A file before and after a draft. `refused` is the reason why it can't be saved; empty: it can."""

    file: str
    before: str
    after: str
    known: str
    what: str
    refused: str
    findings: tuple[Finding, ...]


class Proposed(Message):
    """The files with a draft's changes."""

    files: tuple[ProposedFile, ...]


class SavedWorkspace(Message):
    """The files that were written, and when their changes take effect."""

    files: tuple[FileWritten, ...]
    told: str


class MakeCell(Message):
    """The path of a new cell.toml for a project that has none."""

    file: FilePath = "cell.toml"


class JudgedProgram(Message):
    """A program of the project with a draft in the place of the files: `held` before, `holds` now (null: not
    known); the first error if it doesn't hold.
    """

    file: str
    held: bool | None
    holds: bool | None
    line: int | None = None
    code: str = ""
    message: str = ""


class CheckShown(Message):
    """A check of all programs: those that no longer hold come first. `standing` lists errors at the robot's
    present position.
    """

    state: Literal["none", "running", "done", "cancelled", "failed"]
    by: str
    mine: bool
    done: int
    of: int
    file: str
    """Program that is being checked now."""
    broken: int
    unjudged: int
    """Programs that didn't hold before either, or couldn't be checked in time."""
    programs: tuple[JudgedProgram, ...]
    standing: tuple[str, ...]
    what: str
    digest: str
    """Hash of the checked draft: of the files with its changes."""


class AskDistances(Message):
    """The nearest pairs of bodies now, with a draft's bodies in the place of the file's."""

    draft: WorkspaceDraft | None = None


class DistanceShown(Message):
    """A pair of bodies, or of a watched item and its zone: their distance [mm] (negative: within each other,
    or beyond the border), the margin [mm], and the nearest points [m], if there are some.
    """

    first: str
    second: str
    distance: float
    margin: float
    points: tuple[float, ...] = ()


class Distances(Message):
    """The nearest pairs, the nearest first; `what` is the reason why there are none."""

    pairs: tuple[DistanceShown, ...]
    what: str
