"""Loading a program into the rotary, keeping it filled, and coming to its end. No I/O.

The rotary is open on our port all the time, so that only what is never stored may be asked: PR, status, control characters, H, R,
%. Variables are asked while it is closed (facts 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from yarclang.pmac.errors import ERRORS, NO_ROOM
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Lost, Script, Stopped, Trouble, Wait
from yarclang.runtime.feed import Feed
from yarclang.runtime.feedback import MotorStatus, ReportError, Sample, counts_in, groups_of, in_order
from yarclang.runtime.job import Job, JobCommand
from yarclang.runtime.messages import Written
from yarclang.runtime.notices import Abort, Fail, Hold, Override, Progress, Resume, Stop
from yarclang.runtime.operation import ABORT_ALL, Operation
from yarclang.runtime.rest import come_to_rest, described, leave, motor_statuses, stands_at, system_words
from yarclang.runtime.state import Event, State

POSITIONS_EACH = 0.04
"""Time between two looks at the positions [s]: 25 Hz, if the link allows."""

STATUS_EACH = 0.1
"""Time between two looks at the status words [s]."""

_LINES_EACH = 0.05
_PROGRESS_EACH = 0.25
_SHARE = 0.7
"""Of the link's capacity that a program may need."""

_SLOWEST_REST = 1.0
"""At a starved rotary's rest, how long it may take until its end is seen [s]."""

_END = 1.0
"""How far from its end a program may end [counts]."""


@dataclass
class _Due:
    """When what is to be looked at next [s of the host's clock]."""

    positions: float = 0.0
    lines: float = 0.0
    status: float = 0.0
    progress: float = 0.0


class Stream:
    """One job on its way through the rotary.

    Attributes:
        feed: how far the lines are.
        rate: the override, 1 at 100 %.
        begun: whether anything has moved.
    """

    def __init__(self, operation: Operation, job: Job) -> None:
        self.operation = operation
        self.job = job
        self.feed = Feed(job)
        self.rate = 1.0
        self.begun = False
        self._due = _Due()

    @property
    def done(self) -> float:
        """How far the program is [s]."""
        return self.job.time_of(self.feed.executed)

    @property
    def command(self) -> JobCommand | None:
        """What is executed."""
        return self.job.command_at(self.done)

    def run(self) -> Script[None]:
        """Load the job, run it, and come to its end.

        Raises:
            Stopped: a person has ended it; the motion may still be going on.
            Trouble: it can't go on; likewise.
            Lost: the connection is of no use any more.
        """
        operation = self.operation
        operation.go(Event.LOAD, f"loading {self.job.name}")
        yield from self._initialise()
        yield from self._prefill()
        self.begun = True
        yield from operation.ask("R")
        operation.go(Event.BEGIN)
        yield from self._stream()
        yield from self._end()

    # before

    def _initialise(self) -> Script[None]:
        """The paper's Listing 3, line by line."""
        for line in self.job.setup:
            yield from self.operation.ask(line)
        for line in ("OPEN ROT", "CLEAR"):
            yield from self.operation.ask(line)

    def _prefill(self) -> Script[None]:
        """Fill the buffer; whoever can't fill it fast enough can't keep it filled either."""
        operation, feed = self.operation, self.feed
        begun = operation.now
        while feed.packet():
            yield from self._obey()
            yield from self._write()
        spent = operation.now - begun
        yield from self._ask_lines()
        if self.job.fits or spent <= 0.0:
            return
        rate = feed.sent / spent
        if rate * _SHARE < self.job.lines_per_second:
            raise Trouble(
                f"the link carries {rate:.0f} lines/s; the program needs {self.job.lines_per_second:.0f} and a reserve",
                "compile with longer segments (--tm), or find out what slows the link (`yarc doctor`)",
            )

    # while it moves

    def _stream(self) -> Script[None]:
        """Until nothing is left to send or to execute."""
        operation, feed, due = self.operation, self.feed, self._due
        while True:
            yield from self._obey()
            now = operation.now
            moving = operation.state is State.MOVE
            if moving and feed.runs_low(now, self.rate):
                yield from self._low_water()
            elif moving and now >= due.lines and (feed.left == 0 or not feed.worthwhile(now, self.rate)):
                yield from self._promptly(self._ask_lines())
                if feed.at_most == 0 and feed.left == 0:
                    return
            elif feed.worthwhile(now, self.rate):
                yield from self._promptly(self._write())
            elif now >= due.positions:
                yield from self._promptly(self._ask_positions())
            elif now >= due.status:
                yield from self._promptly(self._ask_status())
            elif now >= due.lines:
                yield from self._promptly(self._ask_lines())
            else:
                yield Wait(min(due.positions, due.lines, due.status))

    def _promptly(self, script: Script[None]) -> Script[None]:
        """Carry a script out; an order is obeyed before its next request, not behind its last."""
        outcome = None
        while True:
            try:
                action = script.send(outcome)
            except StopIteration:
                return
            yield from self._obey()
            outcome = yield action

    def _write(self) -> Script[None]:
        packet = self.feed.packet()
        written = yield from self.operation.write(packet)
        if written.error is None:
            self.feed.written(len(packet))
            return
        raise Trouble(
            _refusal(written, self.feed.sent),
            "the robot ends at rest; run `yarc doctor`, then the program again",
        )

    def _ask_lines(self) -> Script[None]:
        operation, feed = self.operation, self.feed
        asked = operation.now
        text = yield from operation.one("PR")
        if not text.isdigit():
            raise Lost(f"{text!r} in reply to PR")
        feed.heard(int(text), asked, operation.now)
        self._due.lines = operation.now + min(_LINES_EACH, self.job.capacity * self.job.segment / 8.0)
        if operation.now >= self._due.progress:
            self._due.progress = operation.now + _PROGRESS_EACH
            self._tell_progress()

    def _tell_progress(self) -> None:
        command, done = self.command, self.done
        left = (self.job.duration - done) / max(self.rate, 0.01)
        title, line = (command.title, command.source_line) if command else ("", 0)
        self.operation.notices.append(Progress(self.operation.now, self.job.offset + done, left, title, line))

    def _ask_positions(self) -> Script[None]:
        operation, motors = self.operation, self.job.robot.controller.motors
        actual: dict[int, float] = {}
        following: dict[int, float] = {}
        groups = groups_of(motors)
        self._due.positions = operation.now + POSITIONS_EACH
        for group in groups:
            if len(groups) > 1:
                yield from operation.ask(f"##{group}")
            places = yield from operation.report("\x10")
            errors = yield from operation.report("\x06")
            try:
                actual |= counts_in(places, group, motors)
                following |= counts_in(errors, group, motors)
            except ReportError as error:
                raise Lost(str(error)) from None
        sample = Sample(
            operation.now, self.job.offset + self.done, in_order(actual, motors), in_order(following, motors)
        )
        operation.notices.append(sample)

    def _ask_status(self) -> Script[None]:
        """Faults, and a program that doesn't go on though it should."""
        operation, job = self.operation, self.job
        self._due.status = operation.now + STATUS_EACH
        motors = yield from motor_statuses(operation, job.robot)
        raise_trouble(job, motors)
        if operation.state is not State.MOVE or not all(motor.at_rest for motor in motors):
            return
        system = yield from system_words(operation, job.robot)
        if system.run_time_error:
            raise Trouble(
                "the controller couldn't calculate a move in time", "compile with longer segments (--tm)"
            )
        if not system.running:
            raise Trouble("the controller doesn't run the program any more: somebody else has stopped it")
        yield from self._ask_lines()
        if self.feed.at_most == 0 and self.feed.left > 0:
            raise Trouble(
                f"underrun: the rotary ran dry with {self.feed.left} lines to come, and the robot stands off its path",
                "find out what delayed this computer or the link; the guard PLC should have held before (`yarc doctor`)",
            )

    # orders

    def _obey(self) -> Script[None]:
        operation = self.operation
        begun = operation.state in (State.MOVE, State.HOLD)
        while operation.orders:
            match operation.orders.popleft():
                case Abort():
                    yield from operation.control(ABORT_ALL)
                    raise Stopped(abort=True)
                case Stop():
                    if begun:
                        yield from self._hold("a stop was asked for")
                    raise Stopped(abort=False)
                case Fail(what=what, remedy=remedy):
                    if begun:
                        yield from self._hold(what)
                    raise Trouble(what, remedy)
                case Hold():
                    if not begun:
                        raise Stopped(abort=False)
                    if operation.state is State.MOVE:
                        yield from self._hold("a hold was asked for")
                case Resume():
                    if operation.state is State.HOLD:
                        yield from self._go_on()
                case Override(percent=percent):
                    yield from operation.ask(f"%{percent:g}")
                    self.rate = percent / 100.0
                    operation.remark(f"override {percent:g} %")

    def _hold(self, why: str) -> Script[None]:
        yield from self.operation.ask(f"&{self.job.robot.controller.coordinate_system}H")
        self.operation.go(Event.HOLD, why)

    def _low_water(self) -> Script[None]:
        """Hold, refill, go on. If the guard PLC was faster, the same."""
        operation, feed = self.operation, self.feed
        ahead = feed.at_least(operation.now, self.rate)
        yield from self._hold(f"low water: {ahead} lines ahead or fewer, at least {feed.low} are wanted")
        operation.remark("the buffer ran low: holding to refill it", warning=True)
        motors = yield from come_to_rest(operation, self.job.robot)
        raise_trouble(self.job, motors)
        yield from self._ask_lines()
        while feed.packet():
            if operation.urgent():
                return
            yield from self._write()
        yield from self._go_on()

    def _go_on(self) -> Script[None]:
        """R, at rest. A guard that has held is armed again first."""
        operation = self.operation
        yield from come_to_rest(operation, self.job.robot)
        yield from operation.ask("CLOSE")
        (armed,) = yield from operation.numbers(ARMED, 1)
        if armed == 2.0:
            operation.remark("the guard PLC had held the motion: the buffer had run low", warning=True)
            yield from operation.ask(f"{ARMED}=1")
        yield from operation.ask("OPEN ROT")
        if operation.urgent():
            return
        yield from operation.ask("R")
        operation.go(Event.RESUME)

    # after

    def _end(self) -> Script[None]:
        """The motion has really ended when no motor has a desired velocity, and all stand where the program ends."""
        operation, job = self.operation, self.job
        while True:
            yield from self._obey()
            motors = yield from motor_statuses(operation, job.robot)
            raise_trouble(job, motors)
            if operation.now >= self._due.positions:
                yield from self._ask_positions()
            if operation.state is State.MOVE and all(motor.at_rest for motor in motors):
                break
            yield Wait(operation.now + 0.01)
        yield from come_to_rest(operation, job.robot)
        yield from operation.ask("CLOSE")
        joints = yield from stands_at(operation, job.robot)
        off = np.abs(to_counts(job.robot, joints) - to_counts(job.robot, job.end))
        yield from leave(operation, job.robot)
        if off.max() > _END:
            raise Trouble(
                f"the program has ended {off.max():.0f} counts (motor "
                f"{job.robot.controller.motors[int(np.argmax(off))]}) from where it should: at {described(job.robot, joints)}",
                "run `yarc doctor`: somebody else may use this controller",
            )
        self.operation.notices.append(Progress(operation.now, job.offset + job.duration, 0.0, "", 0))
        operation.go(Event.END, f"at the end of {job.name}, to a count")


def raise_trouble(job: Job, motors: tuple[MotorStatus, ...]) -> None:
    """Raise what keeps a motor from moving.

    Raises:
        Trouble: the first motor's.
    """
    for number, motor in zip(job.robot.controller.motors, motors, strict=True):
        if what := motor.trouble:
            raise Trouble(f"motor {number}: {what}", f"find out why, then close its loop: `#{number}J/`")


def _refusal(written: Written, sent: int) -> str:
    error = written.error or 0
    lines = written.request.lines
    at = written.line or 0
    text = lines[at - 1] if 0 < at <= len(lines) else lines[0]
    meaning = ERRORS.get(error, "an error that isn't documented")
    if error == NO_ROOM:
        meaning += ", though there should be"
    return f"the controller refuses line {sent + at} of the motion, {text!r}: ERR{error:03d}, {meaning}"
