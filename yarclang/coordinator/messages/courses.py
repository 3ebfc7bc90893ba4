"""Messages about a loaded program before its start: its motion, its duration, and the distances of bodies."""

from __future__ import annotations

from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Course, PathBound, Peaks, Reply, Takes


class CourseCommand(Message):
    """A motion of the course: when it is executed [s], and where it ends [deg or mm], in the order of the robot's joints."""

    title: str
    index: str
    line: int
    begins_s: float
    ends_s: float
    end: tuple[float, ...]


class NearestProved(Message):
    """The smallest proved distance between bodies: which ones (empty: all stay farther apart), in which command, and when it was seen [s]; null: that isn't told."""

    distance_mm: float
    first: str
    second: str
    title: str
    line: int
    at_s: float | None


class ProgramCourse(Reply):
    """What is run of a program, along its longest ways: the motion, and what was proved of it. The times count from the program's beginning, as those of `progress` do."""

    course: Course
    """Empty where `unknown` says why."""
    commands: tuple[CourseCommand, ...]
    """The motions of the course."""
    takes: Takes
    nearest: NearestProved | None
    """Null: no bodies are known, or none of them move against each other."""
    path: PathBound
    peaks: Peaks | None
    """Null where nothing moves."""
    left_out: int
    """How many motions of shorter ways of a WHEN the course leaves out."""
    unknown: str
    """Why the motion isn't known; empty: it is."""
    sha256: str
    """Of the program's text that was proved (UTF-8); empty: only a controller text is known."""
    changed: bool | None
    """Whether the file has another text by now: what was proved is what runs. Null: the file can't be read, or there is none."""
