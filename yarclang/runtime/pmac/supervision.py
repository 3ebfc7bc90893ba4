"""Supervision of a run: the watchdog, and the comparison of settings with those of the inspection, on which
the proof depends. Some settings are read with each question about the buffer; all other settings are read
once a second or less often. No I/O.

Other clients may use the same controller. If one of them changes something (the override, the guard, a limit,
a PLC, an axis definition), the proof is no longer valid. The motion is then held, and the old and the new
value are reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle

from yarclang.decisions import Watch
from yarclang.pmac.controller import TurboPmac, turbo_pmac
from yarclang.pmac.variables import (
    ARMED,
    DISARMS,
    ECHO,
    FEEDBACK_PLC,
    GUARD_PLC,
    HEARTBEAT,
    WATCHED,
    motor_variable,
    system_variable,
    watchdog,
)
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Lost, Script, Trouble, Wait
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.loading import loading_of
from yarclang.runtime.pmac.memory import Memory, Question, Remembered
from yarclang.runtime.pmac.operation import Operation, Refused, number_in
from yarclang.runtime.signals import state_text
from yarclang.units import MS

SETTINGS_EACH = 1.0
"""Time between two checks of the settings [s]."""

HELD = 2.0
"""Value of the guard PLC's flags after it has held the motion."""

_LONGEST_QUESTION = 200
_MOTOR_VARIABLES = {
    0: "activated",
    11: "fatal following error",
    24: "flags and limit switches",
}
"""Variables of each motor that no robot description sets, and that no other client may change during motion:
Ixx00, Ixx11, Ixx24. The values of this mapping are the names of the variables in messages.
"""
_MARKS = (
    "I16, lines below which the guard holds",
    "I17, number of lines at which the rotary buffer counts as full",
)
_HOLD_SLEW = 95
"""Isx95: rate at which a hold changes the time base."""
_TIME_BASE = 93
"""Isx93: source of the coordinate system's time base."""
_STANDS_STILL = 0.045
"""Time for which the guard's heartbeat may stay unchanged before the guard counts as stopped [s]. If `_BEATS`
heartbeats take longer than this, their duration counts instead.
"""
_BEATS = 8.0
_BEHIND = 3.0
"""Number of the guard's heartbeats that PLC 0 may miss before it counts as stopped. PLC 0 is scanned
more often than the guard.
"""
_RACE = 3
"""Number of lines that the controller may calculate between printing the first and the last value of a reply.
"""
_SLEWING, _LONGEST_SLEW = 0.02, 1.0
"""Time between two checks while the override changes [s], and longest duration of the change [s]. Two hold
times are added to the longest duration.
"""
_SAME_PACE = 0.01
"""Tolerance of the override as printed [%]."""
_SHORTEST_TIMER = 1
_LONGEST_TIMER = 8_388_607
"""Largest value of a 24-bit timer [servo cycles]."""

LEAST_PATIENCE = 0.4
"""Usual shortest silence of this computer after which the controller holds the motion [s]."""

AT_REST_WITHIN = 0.95
"""Time within which the robot should be at rest after the streaming computer has failed [s], if the
connection is fast enough.
"""

_SHORTEST_PATIENCE = 0.25
"""Shortest silence of this computer after which the controller holds the motion, even with a long hold time
[s]. With a smaller value, a busy computer would cause holds too often.
"""

_REPLIES, _LEAST_REPLIES = 4.0, 3.0
_ONE_MORE = 0.1


def patience_for(slowest: float, hold_time: float) -> float:
    """Return the longest silence of this computer before its controller holds [s].

    The result is four times the slowest reply, at least `LEAST_PATIENCE`, but so short that the robot is at
    rest within `AT_REST_WITHIN`. Two minimums take precedence over `AT_REST_WITHIN`. The first is the
    duration of three slow replies, since so many replies may lie between two messages of a run. The second is
    `_SHORTEST_PATIENCE`, which matters if the robot's hold time takes nearly all of `AT_REST_WITHIN`: no
    computer can be relied on to send its next message sooner.

    Args:
        slowest: duration of the slowest reply during the inspection [s].
        hold_time: hold time of the robot [s].
    """
    wanted = max(LEAST_PATIENCE, _REPLIES * slowest)
    return max(min(wanted, AT_REST_WITHIN - hold_time), needed(slowest), _SHORTEST_PATIENCE)


def needed(slowest: float) -> float:
    """Return the silence of this computer that a slow connection alone may cause [s].

    Args:
        slowest: duration of the slowest reply on the connection [s].
    """
    return _LEAST_REPLIES * slowest + _ONE_MORE


def wound_up(controller: TurboPmac, seconds: float) -> str:
    """Return the assignment that sets the watchdog to `seconds` [s of the controller]."""
    cycles = round(seconds / (controller.i10 / 2**23 * MS))
    return f"{watchdog(controller.coordinate_system)}={min(max(cycles, _SHORTEST_TIMER), _LONGEST_TIMER)}"


def remember(operation: Operation, robot: Robot, settings: Sequence[tuple[str, str, str]]) -> Script[Memory]:
    """Ask for the present settings, with which later answers are compared. No buffer may be open on this
    port.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot with its motors and coordinate system.
        settings: for each inspected setting: its subject in words, the question for it, and its kind
            (`number`, `definition` or `listing`).
    """
    controller = turbo_pmac(robot)
    numbers = [(subject, question) for subject, question, kind in settings if kind == "number"]
    for motor in controller.motors:
        numbers += [
            (f"{motor_variable(motor, number)}, {what}", motor_variable(motor, number))
            for number, what in _MOTOR_VARIABLES.items()
        ]
    time_base = system_variable(controller.coordinate_system, _TIME_BASE)
    numbers.append((f"{time_base}, source of the time base", time_base))
    definitions = [(subject, question) for subject, question, kind in settings if kind == "definition"]
    listings = [(subject, question) for subject, question, kind in settings if kind == "listing"]
    often = yield from _remembered(operation, _lines(numbers))
    seldom = yield from _remembered(operation, _lines(definitions))
    seldom += yield from _remembered(operation, [Question((one[0],), (one[1],)) for one in listings])
    return Memory(tuple(often), tuple(seldom))


def _lines(parts: Sequence[tuple[str, str]]) -> list[Question]:
    """Group questions into as few lines as the length of a line allows."""
    lines: list[list[tuple[str, str]]] = []
    for part in parts:
        if not lines or sum(len(one[1]) for one in lines[-1]) + len(part[1]) > _LONGEST_QUESTION:
            lines.append([])
        lines[-1].append(part)
    return [Question(tuple(one[0] for one in line), tuple(one[1] for one in line)) for line in lines]


def _remembered(operation: Operation, questions: Sequence[Question]) -> Script[list[Remembered]]:
    """Ask questions, and return them with the current answers. If the controller refuses a line with several
    questions, they are asked separately.
    """
    answers: list[Remembered] = []
    for question in questions:
        reply: tuple[str, ...] = ()
        try:
            reply = yield from operation.ask(question.line)
        except Refused:
            if len(question.parts) == 1:
                raise
        if len(question.parts) == 1 or len(reply) == len(question.parts):
            answers.append(Remembered(question, reply))
            continue
        single = [Question((s,), (p,)) for s, p in zip(question.subjects, question.parts, strict=True)]
        answers += yield from _remembered(operation, single)
    return answers


@dataclass(frozen=True, slots=True)
class Flow:
    """One answer of the controller about the flow of lines through the rotary buffer.

    Attributes:
        ahead: number of lines in the buffer.
        percent: override [%].
        armed: flag of the guard PLC.
        beat: heartbeat of the guard PLC.
        watched: flag of the watchdog.
        echo: heartbeat of the guard PLC as seen by PLC 0.
        inputs: values of the inputs that hold or end the motion.
    """

    ahead: int
    percent: float
    armed: float
    beat: float
    watched: float
    echo: float
    inputs: tuple[float, ...] = ()


class Supervision:
    """Supervision of one controller while one job is streamed to it: this computer watches the controller's
    settings, and the controller watches if this computer still sends messages.
    """

    def __init__(self, operation: Operation, job: Job) -> None:
        self.operation = operation
        self._robot = job.robot
        self._marks = Remembered(
            Question(_MARKS, ("I16", "I17")), (str(loading_of(job).low), str(loading_of(job).full))
        )
        self._winds = wound_up(turbo_pmac(job.robot), operation.silence)
        # Assignments go first and % last: text after % might be read as a new value of the override.
        self._watches = job.watches
        self._search = job.search
        searched = (job.search.variable,) if job.search is not None else ()
        self._inputs = tuple(dict.fromkeys((*(one.variable for one in job.watches), *searched)))
        self._question = " ".join((self._winds, "PR", ARMED, HEARTBEAT, WATCHED, ECHO, *self._inputs, "%"))
        self._seldom = cycle(operation.memory.seldom) if operation.memory.seldom else None
        self._arms: list[tuple[int, float]] = []
        self._sent = 0
        self._disarmed = False
        self._beat = -1.0
        self._beats_since = self._still = 0.0
        self._expected = 100.0 * operation.override
        self._slews, self._slews_until = (self._expected, self._expected), 0.0
        self._watching = False
        self._asked = self._asked_at = 0.0

    # the watchdog

    def begin(self) -> Script[None]:
        """Wait until the override has its wanted value, and let the controller watch this computer from now
        on.

        No buffer may be open on our port of the controller. The next command is R.

        Raises:
            Trouble: the override doesn't reach the wanted value.
        """
        operation = self.operation
        wanted_percent, since = 100.0 * operation.override, operation.now
        while True:
            (percent,) = yield from operation.numbers("%", 1)
            if percent == 0.0 or abs(percent - wanted_percent) <= _SAME_PACE:
                break  # in a hold, the override is 0
            if operation.now - since > _LONGEST_SLEW + 2.0 * self._robot.controller.hold_time:
                what = f"the override stays at {percent:.4g} %, but {wanted_percent:g} % was ordered"
                raise Trouble(what, "find other clients of this controller", "Y1605")
            yield Wait(operation.now + _SLEWING)
        yield from operation.ask(f"{self._winds} {WATCHED}=1")
        self._watching = True
        self._asked = operation.now
        self.slews(0.0)

    def unwatch(self) -> Script[None]:
        """Let the controller not watch this computer until `begin`. Else PLC 28 would set outputs to their
        safe values again while they are being restored.
        """
        yield from self.operation.ask(f"{WATCHED}=0")
        self._watching = False

    @property
    def overdue(self) -> bool:
        """Return True if the watchdog should be restarted before anything else is sent."""
        return self._watching and self.operation.now - self._asked > self.operation.silence / 3.0

    # expected values

    def slews(self, percent: float) -> None:
        """Record that the time base changes from `percent` to the override from now on."""
        operation, wanted = self.operation, 100.0 * self.operation.override
        # If an earlier change is still in progress, the time base may also be anywhere in the range of that
        # change.
        ends = (percent, wanted, *(self._slews if operation.now < self._slews_until else ()))
        self._expected, self._slews = wanted, (min(ends), max(ends))
        way = (max(ends) - min(ends)) / 100.0
        self._slews_until = operation.now + way * self._robot.controller.hold_time + _ONE_MORE

    def lines_sent(self, lines: Sequence[str]) -> None:
        """Record that lines were sent to the rotary buffer."""
        for row, line in enumerate(lines):
            if line.startswith(f"{ARMED}="):
                self._arms.append((self._sent + row, float(line != DISARMS)))
        self._sent += len(lines)

    def rearmed(self, flow: Flow, all_in: bool) -> str:
        """Return the assignment that gives the guard's flag the value that it must have when the motion
        continues; empty if the flag has this value.

        Args:
            flow: the last answer about the buffer, at rest.
            all_in: True if all lines were sent. The guard is then disarmed: the buffer may have fewer lines
                than the guard requires, and no more lines come.
        """
        if all_in and (flow.armed or self._disarmed):  # the guard was armed, or was disarmed here
            self._disarmed = True
            return f"{ARMED}=0" if flow.armed else ""
        wanted = self._flag(self._sent - flow.ahead)
        return f"{ARMED}={wanted:g}" if flow.armed != wanted else ""

    # questions

    def ask(self) -> Script[Flow]:
        """Ask about the flow of lines, and restart the watchdog. No buffer may be open on our port of the
        controller.

        Raises:
            Lost: the answer can't be parsed.
        """
        operation = self.operation
        asked_at = operation.now
        items = yield from operation.ask(self._question)
        try:
            ahead, armed, beat, watched, echo, *inputs, percent = (number_in(item) for item in items)
            if len(inputs) != len(self._inputs):
                raise ValueError
        except ValueError:
            raise Lost(f"{', '.join(items)!r} in reply to {self._question!r}") from None
        if not items[0].isdigit():
            raise Lost(f"{items[0]!r} in reply to PR")
        self._asked, self._asked_at = operation.now, asked_at
        flow = Flow(int(ahead), percent, armed, beat, watched, echo, tuple(inputs))
        operation.ahead = flow.ahead
        self._take_beat(flow, asked_at)
        return flow

    def _take_beat(self, flow: Flow, asked_at: float) -> None:
        if flow.beat != self._beat:
            self._beat, self._beats_since = flow.beat, self.operation.now
            self._still = 0.0
        else:
            self._still = asked_at - self._beats_since

    @property
    def doubtful(self) -> bool:
        """Return True if the next question should come soon, because the heartbeat hasn't changed."""
        return self._still > 0.0

    def stands_still(self, flow: Flow) -> str:
        """Return a sentence about a PLC that has stopped, the guard or the feedback; empty if both run."""
        if self._still > max(_STANDS_STILL, _BEATS * self.operation.beat):
            return f"PLC {GUARD_PLC}, the guard, has stopped: its heartbeat stays at {flow.beat:g}"
        if flow.beat - flow.echo > _BEHIND:
            return f"PLC {FEEDBACK_PLC}, the feedback, has stopped"
        return ""

    def changed(self, flow: Flow, *, moving: bool) -> str:
        """Return the difference between an answer and the state in which this run has left the controller, in
        words; empty if there is none.

        Args:
            flow: the answer about the flow of lines.
            moving: True if the program runs at the wanted override.
        """
        if moving and (told := self._other_pace(flow.percent)):
            return told
        wanted = self._armed(flow.ahead)
        if flow.armed not in (HELD, *wanted):
            return f"the flag of the guard, {ARMED}, was {wanted[0]:g}, and is {flow.armed:g}"
        if self._watching and flow.watched not in (1.0, HELD):
            return f"the flag of the watchdog, {WATCHED}, was 1, and is {flow.watched:g}"
        return self.stands_still(flow)

    def _other_pace(self, percent: float) -> str:
        least, most = self._slews if self._asked_at < self._slews_until else (self._expected,) * 2
        if least - _SAME_PACE <= percent <= most + _SAME_PACE:
            return ""
        if percent < least:
            return (
                f"the override was {self._expected:g} %, and is {percent:.4g} %: the motion is held or "
                "slowed down, but not by this run"
            )
        return f"the override was {self._expected:g} %, and is {percent:.4g} %"

    def _armed(self, ahead: int) -> tuple[float, ...]:
        """Return two values, one of which the guard's flag must have while `ahead` lines are in the buffer:
        the value after the lines that have left the buffer, and the value after `_RACE` more lines. The
        controller may have calculated these lines after it counted the lines in the buffer.
        """
        if self._disarmed:
            return (0.0,)
        taken = self._sent - ahead
        return self._flag(taken), self._flag(taken + _RACE)

    def _flag(self, executed: int) -> float:
        """Return the guard's flag after the first `executed` lines."""
        flag = 0.0
        for row, value in self._arms:
            if row >= executed:
                break
            flag = value
        return flag

    # inputs that hold the motion

    def held_by(self, flow: Flow) -> str:
        """Return the watched inputs whose states forbid motion, in words; empty if there are none.

        Args:
            flow: the answer with the states of the inputs.
        """
        read = dict(zip(self._inputs, flow.inputs, strict=True))
        return ", ".join(
            f"{one.name} ({one.variable}) is {state_text(read[one.variable])}" for one in self._open(flow)
        )

    def way_out(self, flow: Flow) -> str:
        """Return the name of the SUB by which the robot is to retreat: that of the first input that forbids
        motion and has a SUB; empty if no such input has one.
        """
        return next((one.then for one in self._open(flow) if one.then), "")

    def _open(self, flow: Flow) -> list[Watch]:
        """Return the watched inputs whose state forbids motion."""
        read = dict(zip(self._inputs, flow.inputs, strict=True))
        # If a bit forbids motion with one value, only its other value allows motion. Any third value of the
        # variable forbids it, too.
        return [
            one
            for one in self._watches
            if read[one.variable] == one.value
            or (one.value in (0.0, 1.0) and read[one.variable] != 1.0 - one.value)
        ]

    def found(self, flow: Flow) -> bool:
        """Return True if the input that ends this motion early has its wanted value."""
        read = dict(zip(self._inputs, flow.inputs, strict=True))
        return self._search is not None and read[self._search.variable] == self._search.value

    # settings

    def check(self) -> Script[None]:
        """Check, before anything moves, that no setting was changed since the inspection.

        Raises:
            Trouble: something was changed.
        """
        if told := (yield from self.compare(all_=True)):
            raise Trouble(
                f"another client uses this controller: since it was checked, {told}",
                "find the client, and restore the value; `yarc doctor` looks again",
                "Y1605",
            )

    def hold_again(self, changes: str) -> str:
        """Return the assignment that restores the slew rate of a hold (Isx95), if another client has changed
        it; empty otherwise. With another rate, a hold would not come to rest as proved.

        Args:
            changes: the changes by other clients, in words.
        """
        slew = system_variable(turbo_pmac(self._robot).coordinate_system, _HOLD_SLEW)
        was = self.operation.memory.value(slew)
        return f"{slew}={was}" if was and slew in changes else ""

    def compare(self, *, all_: bool = False) -> Script[str]:
        """Ask for the settings again, and return the first difference from the inspection, in words; empty if
        there is none.

        Args:
            all_: True to ask for all settings. False to ask for the settings that are compared every second,
                and for the next one of those that are compared in turn.
        """
        memory = self.operation.memory
        seldom = list(memory.seldom) if all_ else [next(self._seldom)] if self._seldom else []
        marks = (self._marks,) if self._watching else ()  # each program has its own I16 and I17
        asked: list[Remembered] = [*memory.often, *marks, *seldom]
        for answer in asked:
            try:
                reply = yield from self.operation.ask(answer.question.line)
            except Refused as refused:
                return str(refused)
            if told := answer.compared(reply):
                return told
        return ""
