"""Messages about a loaded program before its start: its motion, its duration, and the distances of bodies."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Course, PathBound, Peaks, Reply, Takes


class CourseCommand(Message):
    """A motion of the course: when it is executed [s], and where it ends [deg or mm], in the order of the
    robot's joints.
    """

    title: str
    index: str
    line: int
    begins_s: float
    ends_s: float
    end: tuple[float, ...]


class NearestProved(Message):
    """The smallest proved distance between bodies: the two bodies (empty: all stay farther apart), the
    command, and the time [s]; null: not known.
    """

    distance_mm: float
    first: str
    second: str
    title: str
    line: int
    at_s: float | None


class ProgramCourse(Reply):
    """Course of a program along its longest branches: its motion, and the proved distances. The times count
    from the program's beginning, as those of `progress` do.
    """

    course: Course
    """Empty if `unknown` gives a reason."""
    commands: tuple[CourseCommand, ...]
    """The motions of the course."""
    takes: Takes
    nearest: NearestProved | None
    """Null: no bodies are known, or no two of them move against each other."""
    path: PathBound
    peaks: Peaks | None
    """Null if nothing moves."""
    left_out: int
    """Number of motions in shorter branches of a WHEN that the course leaves out."""
    unknown: str
    """Reason for which the motion isn't known; empty if it is known."""
    sha256: str
    """SHA-256 of the proved program text (UTF-8); empty if only a controller text is known."""
    changed: bool | None
    """True if the file has changed since; the proved text is the one that runs. Null: the file can't be read,
    or there is none.
    """
