"""Build the motion of a certified controller text: intervals of motion without a stop (stretches), and the
events between and during them.

The source is the content of the text as read by the judge, the independent checker.
"""

from __future__ import annotations

import bisect
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.read.reader import reader_of
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Put, Run, Stood
from yarclang.frozen import frozen
from yarclang.pipeline.executed import Kind
from yarclang.pipeline.line_map import LineMap
from yarclang.progress import go_on
from yarclang.robot.model import Array, Robot
from yarclang.units import MS


@frozen
class Between:
    """An event of the program that can't be part of a trajectory, such as a wait or an output.

    Attributes:
        kind: its kind.
        place: title of the command to which the event belongs.
        what: the event, in words.
        before: number of stretches (intervals of motion without a stop) that end before the event.
        time: for an event during a motion, the time since the start of this motion's stretch [s]; None if the
            event happens while the robot is at rest.
    """

    kind: Kind
    place: str
    what: str
    before: int
    time: float | None = None

    @property
    def text(self) -> str:
        """The event as one line for the user: command, time, event."""
        when = (
            "" if self.time is None else f" {self.time:.6f} s after the start of trajectory {self.before + 1}"
        )
        return f"{self.place}{when}: {self.what}" if self.place else f"{self.what}{when}"


@frozen(eq=False)
class Path:
    """The executed path: S cubic polynomials in time (pieces), for all stretches one after the other. A
    stretch is an interval of motion without a stop.

    The last piece of each stretch represents the rest after its end, and has no duration.

    Attributes:
        stretch: (S,) index of the stretch of each piece.
        begin: (S,) time from the start of the stretch to the start of the piece [s].
        x: (S, n) position at the start of the piece [rad or m].
        v: (S, n) velocity at the start of the piece [rad/s or m/s].
        a: (S, n) acceleration at the start of the piece [rad/s^2 or m/s^2].
        jerk: (S, n) constant jerk of the piece [rad/s^3 or m/s^3].
    """

    stretch: NDArray[np.intp]
    begin: Array
    x: Array
    v: Array
    a: Array
    jerk: Array

    @property
    def last(self) -> NDArray[np.intp]:
        """Index of the last piece of each stretch, which is at rest."""
        return np.flatnonzero(np.append(np.diff(self.stretch) > 0, True))

    def at(self, piece: NDArray[np.intp], offset: Array) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration (N, n) at given times in pieces of the path.

        Args:
            piece: (N,) indices of the pieces.
            offset: (N,) times since the starts of these pieces [s].
        """
        t = offset[:, None]
        x, v, a, jerk = (one[piece] for one in (self.x, self.v, self.a, self.jerk))
        return x + t * (v + t * (a / 2 + t * jerk / 6)), v + t * (a + t * jerk / 2), a + t * jerk


@frozen(eq=False)
class Course:
    """A program's motion, prepared for robot drivers other than yarclang's own.

    Attributes:
        path: path of all stretches (intervals of motion without a stop).
        starts: time at which each stretch begins if waits take no time [s].
        between: events between and during the stretches.
    """

    path: Path
    starts: tuple[float, ...]
    between: tuple[Between, ...]

    @property
    def size(self) -> int:
        """Number of stretches (intervals of motion without a stop)."""
        return len(self.starts)


def course_of(content: ControllerText, mapped: LineMap, robot: Robot, names: Mapping[str, str]) -> Course:
    """Return the motion and the events of a certified controller text.

    Args:
        content: the content of the text, as read by the judge.
        mapped: the lines of the text, with the commands to which they belong.
        robot: the robot of the program.
        names: the names that the program has for the controller's variables.
    """
    making = _Making(
        mapped,
        robot,
        names,
        reader_of(robot.controller).start(content, robot).q,
        {entry.step: entry for entry in content.entries},
    )
    for item, place in zip(content.course, content.schedule.places, strict=False):
        go_on()
        making.take(item, float(place))
    return making.done()


class _Making:
    """Builder of a course."""

    def __init__(
        self,
        mapped: LineMap,
        robot: Robot,
        names: Mapping[str, str],
        start: Array,
        entries: Mapping[int, object],
    ) -> None:
        self._stretches, self._firsts = mapped.stretches, [one.first for one in mapped.stretches]
        self._robot, self._names, self._stand, self._entries = robot, names, start, entries
        self._between: list[Between] = []
        self._starts: list[float] = []
        self._open = False
        self._clock = 0.0
        # These lists have an item for each sequence of move lines: its control points, its segment time, the
        # index of its stretch, and the time from the start of the stretch to the start of the sequence.
        self._control: list[Array] = []
        self._segment: list[float] = []
        self._stretch: list[int] = []
        self._begin: list[float] = []

    def take(self, item: Run | Dwelt | Put | Barred | Stood, place: float) -> None:
        """Add the next motion or event of the controller text, which begins at time `place` [s] of the
        program.
        """
        match item:
            case Run():
                self._run(item, place)
            case Stood(point=point):
                self._stand = point * self._robot.axis_units
            case Barred():
                self._bar(item)
            case Dwelt(line=line, milliseconds=milliseconds) if milliseconds > 0.0:
                self._say("dwell", line, f"stand still for {milliseconds * MS:g} s")
            case Put(line=line, variable=variable, value=value):
                self._say("set", line, self._put(variable, value))

    def _run(self, run: Run, place: float) -> None:
        if not self._open:
            self._open, self._clock = True, 0.0
            self._starts.append(place)
        stretch = len(self._starts) - 1
        points = run.points * self._robot.axis_units
        self._control.append(
            np.concatenate((np.tile(self._stand, (3, 1)), points, np.tile(points[-1], (2, 1))))
        )
        self._segment.append(run.segment)
        self._stretch.append(stretch)
        self._begin.append(self._clock)
        for put in run.puts:  # the k-th move line of a sequence begins its k-th segment
            time = self._clock + int(np.searchsorted(run.lines, put.line)) * run.segment
            self._between.append(
                Between("set", self._place(put.line), self._put(put.variable, put.value), stretch, time)
            )
        self._stand, self._clock = points[-1], self._clock + run.duration

    def _put(self, variable: str, value: float) -> str:
        name = self._names.get(variable)
        return f"set {variable}{f' ({name})' if name else ''} to {value:g}"

    def _say(self, kind: Kind, line: int, what: str) -> None:
        self._between.append(Between(kind, self._place(line), what, len(self._starts)))
        self._open = False

    def _place(self, line: int) -> str:
        """Return the title of the command to which a line of the controller text belongs."""
        at = bisect.bisect_right(self._firsts, line) - 1
        command = self._stretches[at].command if at >= 0 else None
        return command.title if command is not None else ""

    def _bar(self, item: Barred) -> None:
        limit = "without a limit" if item.timeout is None else f"at most {item.timeout:g} s"
        said = f"{item.name} ({item.condition})"
        late = "" if item.timeout is None else f" within {item.timeout:g} s"
        what = {
            "wait": f"wait for {said}, {limit}",
            "hold": f"wait for the operator: {item.name}" if item.name else "wait for the operator",
            "when": f"what follows is only for {said}{late}",
            "else": "what follows is for the other case",
            "end": "both cases go on from here",
            "loop": "what follows is done again and again, up to the end of the loop",
            "next": "begin the loop anew",
            "exit": "leave the loop",
            "endloop": "the loop ends here",
            "set": f"set the register {item.name}",
            "stop": "end the program",
            "say": f"tell the operator: {item.name}",
            "abort": f"end the program as a fault: {item.name}",
        }[item.kind]
        entry = self._entries[item.step]
        place = " ".join(
            one for one in (getattr(entry, "index", ""), getattr(entry, "name", "")) if one and one != "-"
        )
        kind: Kind = item.kind  # type: ignore[assignment]
        self._between.append(Between(kind, place, what, len(self._starts)))
        self._open = False

    def done(self) -> Course:
        """Return the motion and the events of everything that was added."""
        return Course(self._path(), tuple(self._starts), tuple(self._between))

    def _path(self) -> Path:
        size = self._robot.size
        if not self._control:
            none, empty = np.zeros((0, size)), np.zeros(0)
            return Path(np.zeros(0, dtype=np.intp), empty, none, none, none, none)
        f = np.concatenate(self._control)
        rows = np.array([len(one) for one in self._control])
        segments = rows - 3
        run = np.repeat(np.arange(len(rows)), segments)
        own = np.arange(len(run)) - np.repeat(np.cumsum(segments) - segments, segments)
        at = np.repeat(np.cumsum(rows) - rows, segments) + own
        h = np.array(self._segment)[run]
        begin = np.array(self._begin)[run] + own * h
        stretch = np.array(self._stretch, dtype=np.intp)[run]
        f0, f1, f2, f3 = (f[at + k] for k in range(4))
        step = h[:, None]
        x, v = (f0 + 4.0 * f1 + f2) / 6.0, (f2 - f0) / (2.0 * step)
        a, jerk = (f2 - 2.0 * f1 + f0) / step**2, (f3 - 3.0 * f2 + 3.0 * f1 - f0) / step**3
        # add a piece at rest after each stretch
        behind = np.flatnonzero(np.append(np.diff(stretch) > 0, True))
        end = begin[behind] + h[behind]
        final, none = f3[behind], np.zeros((len(behind), size))
        place = behind + 1
        return Path(
            np.insert(stretch, place, stretch[behind]),
            np.insert(begin, place, end),
            np.insert(x, place, final, axis=0),
            np.insert(v, place, none, axis=0),
            np.insert(a, place, none, axis=0),
            np.insert(jerk, place, none, axis=0),
        )
