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
    """Calibration of a tool's tip: the tip touches one point from several directions. `name` is the frame
    that is defined.
    """

    kind: Literal["tip"]
    name: Name


class FrameCalibration(Message):
    """Calibration of a frame: its origin, a point on its x axis and points of its xy plane are touched.
    `tool` is the frame on the flange whose origin touches them.
    """

    kind: Literal["frame"]
    name: Name
    tool: Name = "{TCP}"


class OffsetCalibration(Message):
    """Calibration of the motors' offsets: joints are moved to marks on the robot. `marks` has the position of
    each joint at its mark, by the joint's name [deg or mm].
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
    """A touch: its name, the joint positions [deg or mm], and its residual.

    The residual is the touch's distance from the result of all touches [mm; for motor offsets deg or mm].
    `can_go` is true if the touch can be removed. The first touches of a frame can be removed only after all
    later ones.
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
    """The calibration of this session, or the newest of another session if this one has none. `kind` is empty
    if there is no calibration.

    Attributes:
        mine: True if this session may continue the calibration.
        by: user to whom the calibration belongs.
        next: what to do before the next touch, in words.
        ready: True if there is a result that can be written.
        result: the result, in words.
        unit: unit of the residuals.
        spread: uncertainty of the result if each touch has an error of `error_mm`. The true error is larger
            in 5 of 100 cases.
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
    """Request for the text of a file into which the result is put. Nothing is written.

    `to` selects robot.toml, cell.toml, or the program `file`, which gets a FRAME line. `replace`: an existing
    entry of the same name may be replaced. `parent` is the parent of a new frame in cell.toml.
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
        obstacle: reason why the pendant can't write the file; empty: it can.
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
    """Request for a motion by which the user can check the result: the tip moves to `distance` [mm] from a
    touched point.

    For a frame, this is the point of touch `at` (null: of the first touch, the origin). For a tip, all
    touches have the same point, and `at` selects the orientation of the tool: that of touch `at` (null: of
    the last touch). From this orientation the tool is turned about its tip, by `tilt` [deg] about the `axis`
    of the flange.
    """

    version: Version
    at: Place | None = None
    distance: Annotated[float, Field(ge=5.0, le=500.0)] = 50.0
    axis: Literal["x", "y", "z"] = "x"
    tilt: Annotated[float, Field(ge=-60.0, le=60.0)] = 0.0


class LookText(Message):
    """Program text of the motion that `LookCalibration` requests, and a description of what to look for."""

    text: str
    what: str
