"""Messages about a loaded program before its start: its motion, its duration, and the distances of bodies."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Course, PathBound, Peaks, Reply, Takes


class CourseCommand(Message):
    """A motion of the course: its begin and end [s], and the joint positions at its end [deg or mm], in the
    order of the robot's joints.
    """

    title: str
    index: str
    line: int
    begins_s: float
    ends_s: float
    end: tuple[float, ...]


class NearestProved(Message):
    """The smallest proved distance between bodies, with the two bodies, the command, and the time [s] (null:
    not known). If the distance is a bound for all bodies, the names of the two bodies are empty.
    """

    distance_mm: float
    first: str
    second: str
    title: str
    line: int
    at_s: float | None


class ProgramCourse(Reply):
    """Motion of a program along its longest branches, and the proved distances. Times count from the
    program's beginning, like those of `progress`.
    """

    course: Course
    """Motion of the robot; empty if `unknown` gives a reason."""
    commands: tuple[CourseCommand, ...]
    """The motions of the course."""
    takes: Takes
    nearest: NearestProved | None
    """Smallest proved distance; null: no bodies are known, or no body moves relative to another one."""
    path: PathBound
    peaks: Peaks | None
    """The largest shares of the limits that the motion uses; null if nothing moves."""
    left_out: int
    """Number of motions in the shorter branches of WHENs. `course` doesn't contain these motions."""
    unknown: str
    """Reason why the motion isn't known; empty if it is known."""
    sha256: str
    """SHA-256 of the text of the proved program (UTF-8); empty if only a controller text is known."""
    changed: bool | None
    """True if the file has changed since the program was loaded. The run still uses the text that was proved.
    Null: there is no file, or it can't be read.
    """
