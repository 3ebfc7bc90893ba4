"""Loading a program into the rotary, keeping it filled, and coming to its end. No I/O.

The rotary is open on our port all the time, so that only what is never stored may be asked: PR, status, control characters, H, R,
%. Variables are asked while it is closed (facts 3).
"""

from __future__ import annotations

import contextlib
import math
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
from yarclang.runtime.operation import URGENT, Interrupted, Operation
from yarclang.runtime.rest import come_to_rest, described, leave, motor_statuses, stands_at, system_words
from yarclang.runtime.state import Event, State

POSITIONS_EACH = 0.04
"""Time between two looks at the positions [s]: 25 Hz, if the link allows."""

STATUS_EACH = 0.1
"""Time between two looks at the status words [s]."""

_STATUS_LATE = 0.4
"""How late that may be for the sake of the feed [s]."""

_LINES_EACH = 0.05
_PROGRESS_EACH = 0.25
_SHARE = 0.7
"""Of the link's capacity that a program may need."""

_SHORTEST_BUFFER = 1.0
"""Of a program, that a rotary holds at least [s]."""

_STILL = 0.5
"""How long nothing may move with lines ahead, besides what segments take [s]."""

_LOOK = 0.01

_HELD = 2.0
"""What the guard PLC puts into its flag when it has held."""

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

    Orders that can't wait interrupt whatever is being asked (`Operation.watch`): each step can be begun again.

    Attributes:
        feed: how far the lines are.
        begun: whether anything has moved.
    """

    def __init__(self, operation: Operation, job: Job) -> None:
        self.operation = operation
        self.job = job
        self.feed = Feed(job)
        self.begun = False
        self._open = False
        self._refilling = False
        self._stands: tuple[float, int] | None = None
        self._due = _Due()
        self._longest = float(np.diff(job.times).max(initial=job.segment))

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
        operation.watch = URGENT
        for step in (self._begin, self._stream, self._end):
            ended = False
            while not ended:
                with contextlib.suppress(Interrupted):
                    yield from self._obey()
                    ended = yield from step()
        operation.watch = ()
        yield from leave(operation, self.job.robot)
        operation.notices.append(Progress(operation.now, self.job.offset + self.job.duration, 0.0, "", 0))
        operation.go(Event.END, f"at the end of {self.job.name}, to a count")

    # before

    def _initialise(self) -> Script[None]:
        """The paper's Listing 3, line by line."""
        job = self.job
        held = job.words // len(job.robot.controller.axes) * job.segment
        if not job.fits and held < _SHORTEST_BUFFER:
            raise Trouble(
                f"the rotary buffer of {job.words} words holds {held:.2f} s of the program: "
                f"at least {_SHORTEST_BUFFER:g} s are wanted",
                "compile the program again: yarcc chooses the size",
            )
        for line in job.setup:
            yield from self.operation.ask(line)
        yield from self._pace()
        yield from self._open_rotary()
        yield from self.operation.ask("CLEAR")

    def _pace(self) -> Script[None]:
        """The override that people want: that of the job before, too."""
        percent = 100.0 * self.operation.override
        yield from self.operation.ask(f"%{percent:g}")
        if percent != 100.0:
            self.operation.remark(f"override {percent:g} %")

    def _prefill(self) -> Script[None]:
        """Fill the buffer; whoever can't fill it fast enough can't keep it filled either."""
        operation, feed = self.operation, self.feed
        begun = operation.now
        while feed.packet():
            yield from self._obey()
            yield from self._write()
        spent = operation.now - begun
        yield from self._ask_lines()
        if feed.at_most != feed.sent:
            raise Trouble(
                f"the controller counts {feed.at_most} lines in its buffer, of {feed.sent} that were sent",
                "somebody else may use this controller; run `yarc doctor`",
            )
        if self.job.fits or spent <= 0.0:
            return
        rate = feed.sent / spent
        if rate * _SHARE < self.job.lines_per_second:
            raise Trouble(
                f"the link carries {rate:.0f} lines/s; the program needs {self.job.lines_per_second:.0f} and a reserve",
                "compile with longer segments (--tm), or find out what slows the link (`yarc doctor`)",
            )

    def _begin(self) -> Script[bool]:
        self.begun = True
        try:
            yield from self.operation.ask("R")
        except Interrupted:
            self.begun = False
            raise
        self.operation.settled = -math.inf
        self.operation.go(Event.BEGIN)
        return True

    # while it moves

    def _stream(self) -> Script[bool]:
        """One step; whether nothing is left to send or to calculate."""
        operation, feed, due = self.operation, self.feed, self._due
        now = operation.now
        moving = operation.state is State.MOVE
        if self._refilling:
            yield from self._go_on()
        elif moving and feed.runs_low(now):
            if feed.heard_at < now:
                # what was heard last is old
                yield from self._ask_lines()
            else:
                yield from self._low_water()
        elif feed.worthwhile(now):
            yield from self._write()
        elif now < due.status + _STATUS_LATE and moving and feed.heard_at < now and feed.hungry(now):
            yield from self._ask_lines()
        else:
            first = min(
                (due.lines, self._ask_lines),
                (due.status, self._ask_status),
                (due.positions, self._ask_positions),
                key=lambda each: each[0],
            )
            if now < first[0]:
                yield Wait(first[0])
                return False
            yield from first[1]()
        return moving and feed.at_most == 0 and feed.left == 0

    def _write(self) -> Script[None]:
        yield from self._open_rotary()
        packet = self.feed.packet()
        written = yield from self.operation.write(packet)
        if written.error is None:
            self.feed.written(len(packet))
            return
        yield from self._look_for_trouble()
        raise Trouble(
            _refusal(written, self.feed.sent),
            "the robot ends at rest; run `yarc doctor`, then the program again",
        )

    def _open_rotary(self) -> Script[None]:
        if not self._open:
            yield from self.operation.ask("OPEN ROT")
            self._open = True

    def _close_rotary(self) -> Script[None]:
        if self._open:
            yield from self.operation.ask("CLOSE")
            self._open = False

    def _ask_lines(self) -> Script[None]:
        operation, feed = self.operation, self.feed
        asked = operation.now
        text = yield from operation.one("PR")
        if not text.isdigit() or int(text) > feed.at_most:
            raise Lost(f"{text!r} in reply to PR, with at most {feed.at_most} lines in the buffer")
        feed.heard(int(text), asked, operation.now)
        self._due.lines = operation.now + min(_LINES_EACH, self.job.capacity * self.job.segment / 8.0)
        if operation.now >= self._due.progress:
            self._due.progress = operation.now + _PROGRESS_EACH
            self._tell_progress()
        if self.begun and feed.at_most == 0 and feed.left:
            yield from self._look_for_trouble()
            raise Trouble(
                f"underrun: the rotary ran dry with {feed.left} lines to come; the robot comes to rest off its path",
                "find out what delayed this computer or the link; the guard PLC should have held before (`yarc doctor`)",
            )

    def _tell_progress(self) -> None:
        command, done = self.command, self.done
        left = (self.job.duration - done) / max(self.operation.override, 0.01)
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
        operation, feed = self.operation, self.feed
        self._due.status = operation.now + STATUS_EACH
        motors = yield from self._look_for_trouble()
        if operation.state is not State.MOVE or not all(motor.at_rest for motor in motors):
            self._stands = None
            return
        yield from self._look_at_program()
        yield from self._ask_lines()
        if feed.left == 0 and feed.at_most == 0:
            return
        if self._stands is None or self._stands[1] != feed.executed:
            self._stands = operation.now, feed.executed
        elif operation.now - self._stands[0] > self._patience:
            yield from self._held_by_others()

    def _look_for_trouble(self) -> Script[tuple[MotorStatus, ...]]:
        motors = yield from motor_statuses(self.operation, self.job.robot)
        raise_trouble(self.job, motors)
        return motors

    def _look_at_program(self) -> Script[None]:
        """At rest: it must run, without an error."""
        system = yield from system_words(self.operation, self.job.robot)
        if system.run_time_error:
            raise Trouble(
                "the controller couldn't calculate a move in time", "compile with longer segments (--tm)"
            )
        if not system.running:
            raise Trouble("the controller doesn't run the program any more: somebody else has stopped it")

    @property
    def _patience(self) -> float:
        """How long nothing may move with lines ahead [s]: no segment takes longer."""
        return 3.0 * self._longest / max(self.operation.override, 0.01) + _STILL

    # orders

    def _obey(self) -> Script[None]:
        """Do what people want, the most urgent first."""
        operation = self.operation
        orders = operation.orders
        moved = operation.state in (State.MOVE, State.HOLD)
        while orders:
            if Abort() in orders:
                orders.clear()
                yield from operation.abort()
                raise Stopped(abort=True)
            if ending := next((order for order in orders if isinstance(order, Stop | Fail)), None):
                orders.clear()
                why = ending.what if isinstance(ending, Fail) else "a stop was asked for"
                if moved:
                    yield from self._hold(why)
                if isinstance(ending, Fail):
                    raise Trouble(why, ending.remedy)
                raise Stopped(abort=False)
            if Hold() in orders:
                if not moved:
                    orders.clear()
                    raise Stopped(abort=False)
                yield from self._hold_for_person()
                continue
            match orders[0]:
                case Resume() if operation.state is State.HOLD:
                    yield from self._go_on()
                case Override(percent=percent):
                    yield from operation.ask(f"%{percent:g}")
                    operation.override = percent / 100.0
                    operation.remark(f"override {percent:g} %")
                case _:
                    pass
            orders.popleft()

    def _hold(self, why: str) -> Script[None]:
        robot = self.job.robot
        yield from self.operation.hold(robot.controller.coordinate_system, robot.controller.hold_time)
        self.operation.go(Event.HOLD, why)

    def _hold_for_person(self) -> Script[None]:
        """Hold until a person wants it otherwise; what was ordered before the hold is overtaken by it."""
        orders = self.operation.orders
        last = max(place for place, order in enumerate(orders) if order == Hold())
        kept = [
            order
            for place, order in enumerate(orders)
            if not (isinstance(order, Hold) or (isinstance(order, Resume) and place < last))
        ]
        orders.clear()
        orders.extend(kept)
        if self.operation.state is State.MOVE or self._refilling:
            self._refilling = False
            yield from self._hold("a hold was asked for")

    def _low_water(self) -> Script[None]:
        """Hold; refill and go on as the next step. If the guard PLC was faster, the same."""
        operation, feed = self.operation, self.feed
        ahead = feed.at_least(operation.now)
        yield from self._hold(f"low water: {ahead} lines ahead or few more, at least {feed.low} are wanted")
        operation.remark("the buffer ran low: holding to refill it", warning=True)
        self._refilling = True

    def _held_by_others(self) -> Script[None]:
        """Nothing moves though lines are ahead. If it was the guard PLC, refill and go on; else somebody else must say."""
        operation = self.operation
        self._stands = None
        operation.go(Event.HOLD, "the motion is held, and not by this run")
        yield from come_to_rest(operation, self.job.robot)
        yield from self._close_rotary()
        (armed,) = yield from operation.numbers(ARMED, 1)
        if armed == _HELD:
            self._refilling = True
        else:
            operation.remark("somebody else holds the motion; resume it when that is right", warning=True)

    def _go_on(self) -> Script[None]:
        """At rest: refill, look after the guard, R."""
        operation, feed = self.operation, self.feed
        motors = yield from come_to_rest(operation, self.job.robot)
        raise_trouble(self.job, motors)
        yield from self._ask_lines()
        while feed.packet():
            yield from self._write()
        yield from self._close_rotary()
        (armed,) = yield from operation.numbers(ARMED, 1)
        if armed == _HELD:
            operation.remark("the guard PLC had held the motion: the buffer had run low", warning=True)
        if feed.left == 0 and armed:
            # all lines are in: fewer than the guard wants, and no more to come
            yield from operation.ask(f"{ARMED}=0")
        elif armed == _HELD:
            yield from operation.ask(f"{ARMED}=1")
        if feed.left:
            yield from self._open_rotary()
        yield from operation.ask("R")
        operation.settled = -math.inf
        self._refilling = False
        self._stands = None
        operation.go(Event.RESUME)

    # after

    def _end(self) -> Script[bool]:
        """One step; whether the motion has really ended: no motor has a desired velocity, and all stand where the program ends."""
        operation, job = self.operation, self.job
        motors = yield from self._look_for_trouble()
        if operation.now >= self._due.positions:
            yield from self._ask_positions()
        if operation.state is not State.MOVE or not all(motor.at_rest for motor in motors):
            self._stands = None
            yield Wait(operation.now + _LOOK)
            return False
        if self._stands is None:
            self._stands = operation.now, 0
        yield from come_to_rest(operation, job.robot)
        yield from self._close_rotary()
        joints = yield from stands_at(operation, job.robot)
        off = np.abs(to_counts(job.robot, joints) - to_counts(job.robot, job.end))
        if off.max() <= _END:
            return True
        yield from self._look_at_program()
        if operation.now - self._stands[0] > self._patience:
            raise Trouble(
                f"the program has ended {off.max():.0f} counts (motor "
                f"{job.robot.controller.motors[int(np.argmax(off))]}) from where it should: at {described(job.robot, joints)}",
                "run `yarc doctor`: somebody else may use this controller",
            )
        yield Wait(operation.now + _LOOK)
        return False


def raise_trouble(job: Job, motors: tuple[MotorStatus, ...]) -> None:
    """Raise what keeps a motor from moving.

    A fault of one motor makes the controller kill others: what is told is the fault, not a loop that it has opened.

    Raises:
        Trouble: the first motor's with a fault, else the first's that is open-loop.
    """
    pairs = list(zip(job.robot.controller.motors, motors, strict=True))
    for number, motor in sorted(pairs, key=lambda pair: not pair[1].faulted):
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
