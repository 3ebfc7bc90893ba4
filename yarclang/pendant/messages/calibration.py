"""Messages about a calibration: its beginning, its touches, their result, and the file into which it is
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
    """The tip of a tool, by touching one point with it: the name of the frame that gets it."""

    kind: Literal["tip"]
    name: Name


class FrameCalibration(Message):
    """A frame, by touching its origin, a point on x and points of its plane with the origin of a frame on the
    flange, `tool`.
    """

    kind: Literal["frame"]
    name: Name
    tool: Name = "{TCP}"


class OffsetCalibration(Message):
    """The offsets of the motors, by bringing joints to their marks: joint positions there, by the joints'
    names [deg or mm].
    """

    kind: Literal["home"]
    marks: Annotated[dict[Name, Number], Field(min_length=1, max_length=64)]


CalibrationKind = Annotated[
    TipCalibration | FrameCalibration | OffsetCalibration, Field(discriminator="kind")
]


class BeginCalibration(Message):
    """Begin a calibration; `anew`: discard this session's present one."""

    calibration: CalibrationKind
    anew: bool = False


class TakeTouch(Message):
    """Take the robot's position as a touch: a further one, or in the place of touch `at` (from 0). `version`
    is that of the calibration as the page shows it.
    """

    version: Version
    at: Place | None = None


class RemoveTouch(Message):
    """Remove touch `at` (from 0)."""

    version: Version
    at: Place


class TouchShown(Message):
    """A touch: what was touched, where the joints were [deg or mm], and how far it is from what all touches
    say [mm, of a joint deg or mm], and whether it can be taken away: the first points of a frame only as the
    last ones.
    """

    label: str
    joints: tuple[float, ...]
    residual: float | None
    worst: bool
    can_go: bool


class SpreadRow(Message):
    """One number of the result's uncertainty, from the spread of the touches."""

    label: str
    value: str
    enough: bool


class CalibrationShown(Message):
    """A calibration: that of this session, else the newest of another one, else none (`kind` is empty).

    Attributes:
        mine: whether this session may go on with it.
        by: whose it is.
        next: what to do before the next touch, in words.
        ready: whether there is a result that can be written.
        result: what follows from the touches, in words.
        unit: of residuals.
        spread: what an error of each touch by `error_mm` does to the result; both are larger in 5 of 100
            cases.
        told: whether the touches tell that error themselves, or it is assumed.
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
    """Write the result into the robot's file, the cell's, or as a FRAME line of a program (`file`).
    `replace`: what is there under this name may go. A new frame of a cell hangs on `parent`.
    """

    version: Version
    to: Literal["robot", "cell", "program"]
    file: FilePath = ""
    parent: Name = "B"
    replace: bool = False


class CalibrationProposal(Message):
    """A change of a file that isn't written yet: its text before and after, the hash of the former, and what
    is found in the latter.

    Attributes:
        what: what changes, in words.
        then: what has to happen so that it holds.
        obstacle: why it can't be written by the pendant; empty: it can.
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
    """Write what was proposed: `known` is the hash of the text that the page has shown."""

    known: Sha256


class CalibrationWritten(Message):
    """A result was written: the file, its new hash, and what has to happen so that it holds."""

    file: str
    sha256: str
    then: str


class LookCalibration(Message):
    """Place from which to look at the result: at `distance` from a touched point [mm], that of touch `at`
    (null: the origin of a frame; of a tip, as at the last touch). A tool is tilted about its tip there, by
    `tilt` about an axis of the flange [deg].
    """

    version: Version
    at: Place | None = None
    distance: Annotated[float, Field(ge=5.0, le=500.0)] = 50.0
    axis: Literal["x", "y", "z"] = "x"
    tilt: Annotated[float, Field(ge=-60.0, le=60.0)] = 0.0


class LookText(Message):
    """Text of an offer that leads there, and a description of what to look for."""

    text: str
    what: str
