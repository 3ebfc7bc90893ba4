"""Streaming of one job through the rotary buffer: load the first lines, keep the buffer filled, carry out
orders, and wait for the end of the motion. No I/O.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass

import numpy as np

from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Found, Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Job, JobCommand
from yarclang.runtime.notices import Abort, Fail, Hold, Override, Progress, Resume, Stop
from yarclang.runtime.operation import UNATTENDED, URGENT, Interrupted
from yarclang.runtime.pmac.holding import Holding
from yarclang.runtime.pmac.operation import Operation, Refused
from yarclang.runtime.pmac.rest import away_from_start, come_to_rest, leave, stands_at
from yarclang.runtime.pmac.rotary import Rotary
from yarclang.runtime.pmac.supervision import HELD, SETTINGS_EACH, Flow
from yarclang.runtime.pmac.watching import (
    look_at_motors,
    look_at_program,
    look_whether_astray,
    sample,
)
from yarclang.runtime.signals import OutputSet, state_text
from yarclang.runtime.standing import described
from yarclang.runtime.state import Event, State

STATUS_EACH = 0.1
"""Time between two questions for the status words [s]."""

_OVERDUE = 0.4
"""Time by which the question for the status words may be late because the number of lines in the buffer is
asked for first [s].
"""

_EXCHANGES = 3
"""The number of lines in the buffer is asked for early if the buffer may need lines within this number of
exchanges with the controller.
"""

_LINES_EACH = 0.05
_WATCH_EACH = 0.005
"""Time between two questions for the number of lines in the buffer while inputs are watched [s]. The same
question reads the inputs.
"""
_PROGRESS_EACH = 0.25
_STILL = 0.5
"""Constant part of `_patience` [s]. Its other part is proportional to the duration of the longest segment."""

_LOOK = 0.01

_DOUBT = 0.02
"""Time to the next question if the guard's heartbeat hasn't changed since the last one [s]."""

_END = 1.0
"""Largest distance of a motor from the program's end position at which the program counts as ended
[counts].
"""


@dataclass
class _Due:
    """Times of the next questions, by subject [s of the host's clock]."""

    positions: float = 0.0
    lines: float = 0.0
    status: float = 0.0
    progress: float = 0.0
    settings: float = 0.0


class Stream:
    """One job that is streamed through the rotary buffer.

    Urgent orders of people interrupt the current question (`Operation.watch`); each step can therefore be
    repeated.

    Attributes:
        rotary: the buffer.
        feed: progress of the job's lines.
        supervision: supervision of the controller.
        holding: holds of the motion.
        begun: True once something has moved.
    """

    def __init__(self, operation: Operation, job: Job) -> None:
        self.operation = operation
        self.job = job
        self.rotary = Rotary(operation, job)
        self.feed = self.rotary.feed
        self.supervision = self.rotary.supervision
        self.begun = False
        self.holding = Holding(operation, job, self.rotary)
        self._stands: tuple[float, int] | None = None
        self._due = _Due()
        each = min(_LINES_EACH, job.capacity * job.segment / 8.0)
        self._looks = bool(job.watches) or job.search is not None
        self._lines_each = min(each, _WATCH_EACH) if self._looks else each
        self._longest = max(float(np.diff(job.times).max(initial=job.segment)), job.longest_dwell)
        self._dwells = np.array([row for row, _ in job.dwells], dtype=np.intp)
        self._rested: float | None = None
        self._taken = self._outputs_told = 0
        self._since = self._looked = operation.now

    @property
    def done(self) -> float:
        """Return the program time that has passed [s], computed from the executed lines.

        During a dwell no line is executed, so the clock is used instead.
        """
        job, operation = self.job, self.operation
        executed = self._taken
        begins = job.time_of(executed)
        # a line after a dwell isn't executed before the dwell is over
        place = int(np.searchsorted(self._dwells, self.feed.taken)) - 1
        if not self.begun or place < 0 or self._dwells[place] < executed:
            return begins
        row, seconds = job.dwells[place]
        if place and self._dwells[place - 1] >= executed:
            begins = float(job.times[row])
        passed = (operation.now if operation.state is State.MOVE else self._looked) - self._since
        # an override slows motions, but not dwells
        motion = float(job.times[row]) - begins
        slowed = motion / max(operation.override, 0.01)
        if passed <= slowed:
            return begins + passed * operation.override
        return begins + motion + min(passed - slowed, seconds)

    def _dwells_on(self) -> bool:
        """Return True if the job ends with a dwell that may still be in progress.

        The motors are at rest both during the dwell and after it. The dwell is therefore timed from the first
        call, so call this only when the motors are at rest.
        """
        job = self.job
        if not job.dwells or job.dwells[-1][0] < len(job.lines) - 1:
            return False
        if self._rested is None:
            self._rested = self.operation.now
        return self.operation.now < self._rested + job.dwells[-1][1]

    @property
    def command(self) -> JobCommand | None:
        """The command that is being executed."""
        return self.job.command_at(self.done)

    @property
    def left(self) -> int:
        """Number of lines that haven't been sent yet."""
        return self.feed.left

    def run(self) -> Script[None]:
        """Load the job, run it, and wait for its end.

        Raises:
            Stopped: a person has ended the run; the motion may still be in progress.
            Trouble: the run can't continue; the motion may still be in progress.
            Lost: the connection can't be used any more.
        """
        operation = self.operation
        yield from away_from_start(operation, self.job)
        part = self.job.part
        operation.go(Event.LOAD, "" if part is not None and part.begun else f"loading {self.job.name}")
        yield from self.supervision.check()
        yield from self._load()
        operation.watch = URGENT
        for step in (self._begin, self._stream, self._end):
            ended = False
            while not ended:
                with contextlib.suppress(Interrupted):
                    yield from self._obey()
                    ended = yield from step()
        operation.watch = ()
        yield from leave(operation, self.job.robot)
        operation.notices.append(
            Progress(operation.now, self.job.clock + self.job.duration, self.job.behind, "", 0)
        )
        self._tell_outputs(len(self.job.lines))
        leads_to = part.leads_to if part is not None else ""
        operation.go(
            Event.END, f"at {leads_to}" if leads_to else f"at the end of {self.job.name}, to a count"
        )

    # before the motion

    def _load(self) -> Script[None]:
        """Define the rotary buffer and fill it. Nothing moves."""
        operation, rotary = self.operation, self.rotary
        yield from rotary.define()
        yield from self.holding.remember_outputs()
        percent = 100.0 * operation.override
        yield from operation.ask(f"%{percent:g}")
        if percent != 100.0:
            operation.remark(f"override {percent:g} %")
        for line in ("OPEN ROT", "CLEAR", "CLOSE"):
            yield from operation.ask(line)
        begun, packets = operation.now, 0
        while self.feed.packet():
            yield from self._obey()
            yield from rotary.write()
            packets += 1
        spent = operation.now - begun
        yield from self._ask_lines()
        rotary.check_prefilled(spent, packets)

    def _begin(self) -> Script[bool]:
        if self._looks:
            flow = yield from self.rotary.ask()
            if told := self.supervision.held_by(flow):
                # this is a hold like one in motion: when a person resumes, R is sent
                self.begun = True
                yield from self.holding.for_input(told, moves=False)
                return True
            if self.supervision.found(flow):
                self.operation.go(Event.HOLD, self._found_message)
                raise Found
        if not self.operation.slept:
            yield from self.supervision.begin()
        self.begun = True
        if self.operation.slept:
            yield from self.holding.after_sleep()
            return True
        try:
            yield from self.operation.ask("R")
        except Interrupted:
            self.begun = False
            raise
        except Refused:
            # nothing moves; the status of the motors shows the cause better than the refusal does
            self.begun = False
            yield from look_at_motors(self.operation, self.job.robot)
            raise
        self.operation.settled = -math.inf
        self.operation.go(Event.BEGIN)
        return True

    # during the motion

    def _stream(self) -> Script[bool]:
        """Carry out one step; return True if no line is left to send or to calculate."""
        operation, feed, due = self.operation, self.feed, self._due
        now = operation.now
        moving = operation.state is State.MOVE
        if operation.slept:
            yield from self._wake_up()
        elif self.holding.refilling:
            yield from self._go_on()
        elif self.supervision.overdue:
            yield from self._ask_lines()
        elif moving and feed.runs_low(now):
            if feed.heard_at < now:
                # the last answer is out of date: ask again before a hold
                yield from self._ask_lines()
            else:
                yield from self.holding.for_low_water()
        elif moving and self._looks and now >= due.lines:
            yield from self._ask_lines()
        elif feed.worthwhile(now):
            yield from self.rotary.write()
        elif moving and feed.heard_at < now and feed.hungry(now + _EXCHANGES * feed.round_trip):
            # first ask how many lines fit, but don't delay the check for faults too long
            yield from (self._ask_lines() if now < due.status + _OVERDUE else self._ask_status())
        else:
            due_at, ask = min(
                (due.lines, self._ask_lines),
                (due.status, self._ask_status),
                (due.positions, self._ask_positions),
                (due.settings, self._ask_settings),
                key=lambda each: each[0],
            )
            if now < due_at:
                yield Wait(due_at)
                return False
            yield from ask()
        return moving and feed.at_most == 0 and feed.left == 0

    def _ask_lines(self) -> Script[None]:
        operation, due = self.operation, self._due
        flow = yield from self.rotary.ask()
        if self.feed.executed != self._taken:
            self._taken, self._since = self.feed.executed, operation.now
            self._tell_outputs(self._taken)
        elif operation.state is not State.MOVE:
            self._since += operation.now - self._looked
        self._looked = operation.now
        each = self._lines_each
        due.lines = operation.now + (min(each, _DOUBT) if self.supervision.doubtful else each)
        if operation.now >= due.progress:
            due.progress = operation.now + _PROGRESS_EACH
            self._tell_progress()
        if self.begun:
            yield from self.rotary.check_full()
        if self.begun and not self.holding.refilling:
            yield from self._look_at(flow)

    def _look_at(self, flow: Flow) -> Script[None]:
        """Compare the controller's state with the state in which this run has left it, and react to a
        difference.

        An input that ends or holds the motion is handled first. After a hold by the guard or the watchdog,
        this computer refills the buffer and the motion continues. After any other difference a person has to
        resume the motion.
        """
        moving = self.operation.state is State.MOVE
        if moving and self.supervision.found(flow):
            yield from self.holding.hold(self._found_message, secure=False)
            raise Found
        if moving and (watched := self.supervision.held_by(flow)):
            yield from self.holding.for_input(watched, self.supervision.way_out(flow))
        elif moving and HELD in (flow.armed, flow.watched):
            yield from self.holding.by_guard(flow)
        elif told := self.supervision.changed(flow, moving=moving):
            yield from self.holding.for_others(told)

    @property
    def _found_message(self) -> str:
        """Message that reports that a search has found its input."""
        one = self.job.search
        return "" if one is None else f"{one.name} ({one.variable}) is {state_text(one.value)}: found"

    def _ask_settings(self) -> Script[None]:
        """Compare the controller's settings with those found before the run, and hold the motion if a
        setting has changed.
        """
        self._due.settings = self.operation.now + SETTINGS_EACH
        if told := (yield from self.supervision.compare()):
            yield from self.holding.for_others(told)

    def _tell_outputs(self, executed: int) -> None:
        """Report the outputs that the first `executed` lines have set, each assignment once."""
        operation, sets = self.operation, self.job.sets
        while self._outputs_told < len(sets) and sets[self._outputs_told][0] < executed:
            _, variable, value = sets[self._outputs_told]
            name = operation.outputs.get(variable, variable)
            operation.notices.append(OutputSet(operation.now, name, variable, value))
            self._outputs_told += 1

    def _tell_progress(self) -> None:
        command, done = self.command, self.done
        title, line = (command.title, command.source_line) if command else ("", 0)
        self.operation.notices.append(
            Progress(self.operation.now, self.job.clock + done, self._time_left(done), title, line)
        )

    def _time_left(self, done: float) -> float:
        """Return the remaining time of the program at the present override [s]. The override slows motions,
        but not dwells.
        """
        job = self.job
        stands = sum(
            min(seconds, max(float(job.times[row]) + seconds - done, 0.0)) for row, seconds in job.dwells
        )
        return (job.duration - done - stands + job.behind) / max(self.operation.override, 0.01) + stands

    def _ask_positions(self) -> Script[None]:
        operation, job = self.operation, self.job
        self._due.positions = operation.now + operation.positions_each
        asked_at = operation.now
        done = self.done
        sampled = yield from sample(operation, job.robot, job.offset + done, job.clock + done)
        operation.notices.append(sampled)
        executed = self.feed.executed_within(operation.now)
        self.rotary.course.forget(executed[0])
        if operation.state is State.MOVE:
            off = self.rotary.course.off(sampled, executed, operation.now - asked_at)
            yield from look_whether_astray(operation, job.robot, off)

    def _ask_status(self) -> Script[None]:
        """Check for faults, and for a program that stands still although it should move."""
        operation, feed = self.operation, self.feed
        self._due.status = operation.now + STATUS_EACH
        motors = yield from look_at_motors(operation, self.job.robot)
        rests = all(motor.at_rest for motor in motors)
        if operation.state is State.HOLD:
            yield from self.holding.look_at(rests)
        if operation.state is not State.MOVE or not rests:
            self._stands = None
            return
        yield from look_at_program(operation, self.job.robot)
        yield from self._ask_lines()
        if feed.left == 0 and feed.at_most == 0:
            return
        if self._stands is None or self._stands[1] != feed.executed:
            self._stands = operation.now, feed.executed
        elif operation.now - self._stands[0] > self._patience:
            self._stands = None
            yield from self.holding.by_nobody()

    @property
    def _patience(self) -> float:
        """Time without motion after which a program with lines in the buffer counts as held by another client
        [s]. It is longer than any segment.
        """
        return 3.0 * self._longest / max(self.operation.override, 0.01) + _STILL

    def _go_on(self) -> Script[None]:
        yield from self.holding.go_on()
        self._stands = None

    # orders

    def _obey(self) -> Script[None]:
        """Carry out the orders that were given, the most urgent first."""
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
                why = ending.what if isinstance(ending, Fail) else "stop requested"
                if moved:
                    yield from self.holding.hold(why)
                if isinstance(ending, Fail):
                    # no code: no command of the program is at fault
                    raise Trouble(why, ending.remedy, code="")
                raise Stopped(abort=False)
            if Hold() in orders:
                if not moved:
                    orders.clear()
                    raise Stopped(abort=False)
                yield from self.holding.for_person()
                continue
            match orders[0]:
                case Resume() if operation.state is State.HOLD:
                    if not operation.ignores_resume():
                        yield from self._go_on()
                case Override(percent=percent):
                    before, operation.override = 100.0 * operation.override, percent / 100.0
                    yield from operation.ask(f"%{percent:g}")
                    self.supervision.slews(before)
                    operation.remark(f"override {percent:g} %")
                case _:
                    pass
            orders.popleft()

    def _wake_up(self) -> Script[None]:
        """Hold the motion after this process was suspended. The guard PLC has held it too, and a person has
        to look at the robot before resuming.
        """
        operation, feed = self.operation, self.feed
        if feed.heard_at < operation.now:
            yield from self._ask_lines()
        slept, operation.slept = operation.slept, 0.0
        if feed.left == 0 and feed.at_most == 0 and not self.holding.refilling:
            return
        self.holding.refilling = False
        if operation.state is State.MOVE:
            yield from self.holding.hold(f"this process was suspended for {slept:.0f} s")
        operation.remark(UNATTENDED, warning=True)

    # after the motion

    def _end(self) -> Script[bool]:
        """Do one step of waiting for the end of the motion; return True if the motion has ended.

        The motion has ended when no motor has a desired velocity and all motors are at the program's end.
        """
        operation, job = self.operation, self.job
        if operation.slept:
            yield from self._wake_up()
            return False
        if self.holding.refilling:
            yield from self._go_on()
            return False
        motors = yield from look_at_motors(operation, self.job.robot)
        if operation.now >= self._due.positions and not self.supervision.overdue:
            yield from self._ask_positions()
        if operation.now >= self._due.lines:
            yield from self._ask_lines()
        rests = all(motor.at_rest for motor in motors)
        if operation.state is not State.MOVE or not rests or self._dwells_on():
            self._stands = None
            wait = operation.now + _LOOK
            yield Wait(min(wait, max(self._due.lines, operation.now)) if self._looks else wait)
            return False
        if self._stands is None:
            self._stands = operation.now, 0
        yield from come_to_rest(operation, job.robot)
        joints = yield from stands_at(operation, job.robot)
        off = np.abs(to_counts(job.robot, joints) - to_counts(job.robot, job.end))
        if off.max() <= _END:
            return True
        yield from look_at_program(operation, self.job.robot)
        if operation.now - self._stands[0] > self._patience:
            raise Trouble(
                f"the program has ended {off.max():.0f} counts from its last point (motor "
                f"{job.robot.controller.motors[int(np.argmax(off))]}): the robot is at "
                f"{described(job.robot, joints)}",
                "run `yarc doctor`: another client may use this controller",
                code="Y1605",
            )
        yield Wait(operation.now + _LOOK)
        return False
