"""Messages about a calibration: its beginning, its touches, its result, and the file to which the result is
written.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from yarclang.coordinator.messages.findings import Finding
from yarclang.coordinator.messages.message import Message, Number
from yarclang.pendant.messages.files import FilePath, Sha256
from yarclang.pendant.messages.people import Name

Version = Annotated[int, Field(ge=0, le=1 << 53)]
Place = Annotated[int, Field(ge=0, le=1000)]


class TipCalibration(Message):
    """Calibration of a tool's tip, by touching one point with it from several directions; `name` is the frame
    that is defined.
    """

    kind: Literal["tip"]
    name: Name


class FrameCalibration(Message):
    """Calibration of a frame, by touching its origin, a point on its x axis and points of its xy plane.
    `tool` is the frame on the flange whose origin touches.
    """

    kind: Literal["frame"]
    name: Name
    tool: Name = "{TCP}"


class OffsetCalibration(Message):
    """Calibration of the motors' offsets, by moving joints to their marks: joint positions at the marks, by
    the names of the joints [deg or mm].
    """

    kind: Literal["home"]
    marks: Annotated[dict[Name, Number], Field(min_length=1, max_length=64)]


CalibrationKind = Annotated[
    TipCalibration | FrameCalibration | OffsetCalibration, Field(discriminator="kind")
]


class BeginCalibration(Message):
    """Request to begin a calibration. `anew`: discard the present calibration of this session."""

    calibration: CalibrationKind
    anew: bool = False


class TakeTouch(Message):
    """Request to record the robot's position as a touch: as a new one, or as a replacement for touch `at`
    (from 0). `version` is the version of the calibration that the page shows.
    """

    version: Version
    at: Place | None = None


class RemoveTouch(Message):
    """Request to remove touch `at` (from 0)."""

    version: Version
    at: Place


class TouchShown(Message):
    """A touch: its name, the joint positions [deg or mm], and its residual, that is its distance from the
    result of all touches [mm; for a joint deg or mm]. `can_go` is true if it can be removed; the first points
    of a frame can only be removed after all others.
    """

    label: str
    joints: tuple[float, ...]
    residual: float | None
    worst: bool
    can_go: bool


class SpreadRow(Message):
    """One number of the result's uncertainty, estimated from the spread of the touches."""

    label: str
    value: str
    enough: bool


class CalibrationShown(Message):
    """The calibration of this session, otherwise the newest of another session; `kind` is empty if there is
    none.

    Attributes:
        mine: True if this session may continue the calibration.
        by: user to whom the calibration belongs.
        next: what to do before the next touch, in words.
        ready: True if there is a result that can be written.
        result: the result, in words.
        unit: unit of the residuals.
        spread: effect on the result if each touch has an error of `error_mm`. In 5 of 100 cases error and
            effect are larger.
        told: True if `error_mm` is estimated from the touches, False if it is assumed.
        advice: what is missing, in words; empty: nothing.
    """

    version: int
    kind: Literal["", "tip", "frame", "home"]
    name: str
    tool: str
    by: str
    mine: bool
    touches: tuple[TouchShown, ...]
    needed: int
    next: str
    ready: bool
    result: tuple[str, ...]
    unit: str
    findings: tuple[Finding, ...]
    spread: tuple[SpreadRow, ...]
    advice: str
    error_mm: float
    told: bool


class ProposeCalibration(Message):
    """Request for the text of a file with the result: the robot's file, the cell's, or a FRAME line of a
    program (`file`). `replace`: an existing entry of this name may be replaced. `parent` is the parent of a
    new frame in a cell.
    """

    version: Version
    to: Literal["robot", "cell", "program"]
    file: FilePath = ""
    parent: Name = "B"
    replace: bool = False


class CalibrationProposal(Message):
    """A change of a file that isn't written yet: the text before and after, the hash of the text before, and
    the findings of the text after.

    Attributes:
        what: the change, in words.
        then: what has to be done for the change to take effect.
        obstacle: reason why the pendant can't write it; empty: it can.
    """

    file: str
    before: str
    after: str
    known: str
    findings: tuple[Finding, ...]
    what: str
    then: str
    obstacle: str


class WriteCalibration(ProposeCalibration):
    """Request to write the proposed text. `known` is the hash of the old text that the page has shown."""

    known: Sha256


class CalibrationWritten(Message):
    """Reply after a result was written: the file, its new hash, and what has to be done for it to take
    effect.
    """

    file: str
    sha256: str
    then: str


class LookCalibration(Message):
    """Request for a place from which to check the result: at `distance` [mm] from a touched point, that of
    touch `at` (null: the origin of the frame; for a tip, the pose of the last touch). A tool is tilted there
    about its tip, by `tilt` about an axis of the flange [deg].
    """

    version: Version
    at: Place | None = None
    distance: Annotated[float, Field(ge=5.0, le=500.0)] = 50.0
    axis: Literal["x", "y", "z"] = "x"
    tilt: Annotated[float, Field(ge=-60.0, le=60.0)] = 0.0


class LookText(Message):
    """Program text of a motion to that place, and a description of what to look for."""

    text: str
    what: str
