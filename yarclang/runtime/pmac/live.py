"""Streaming of a motion whose lines are computed while the robot moves: jogs, velocities, and following a
master. No I/O.

The rotary buffer always has as many lines as the guard PLC needs for a hold on the path, plus an allowance
for a late host. It therefore never runs empty in motion, but a new order takes effect only after these lines.
A stop doesn't wait for them: it is a hold, and the remaining lines are discarded.

The motion begins at the commanded position of the motors, and was proved from there; no RAPID leads to a
start. The last question before R therefore asks for that position again. R is sent right after the reply, and
is refused while a motor jogs (ERR011), so that other clients have hardly any time to move the robot away.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import DISARMS
from yarclang.runtime.actions import Script, Stopped, Trouble, Wait
from yarclang.runtime.job import JobCommand
from yarclang.runtime.live import Live
from yarclang.runtime.notices import Abort, Fail, Override
from yarclang.runtime.operation import URGENT, Interrupted
from yarclang.runtime.pmac.course import Course
from yarclang.runtime.pmac.feed import AHEAD, AROUND, FASTEST
from yarclang.runtime.pmac.loading import loading_of
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.packets import fitting
from yarclang.runtime.pmac.rest import away_from_start, come_to_rest, leave
from yarclang.runtime.pmac.streaming import STATUS_EACH
from yarclang.runtime.pmac.supervision import HELD, SETTINGS_EACH, Flow, Supervision
from yarclang.runtime.pmac.watching import look_at_motors, look_whether_astray, sample
from yarclang.runtime.state import Event

_LATE = 1
"""Margin by which this computer holds the motion before the guard does: it holds when the buffer has fewer
lines than the guard's minimum plus this number.
"""

_SHORTEST, _SEGMENTS, _LONGEST = 0.008, 1.5, 0.016
"""Time between two questions for the lines in the buffer: `_SEGMENTS` segments, within the bounds `_SHORTEST`
and `_LONGEST` [s].

Waking up costs this process more time than a reply does. A question that is due within half of the present
interval is therefore asked at once, without a wait before it.
"""


class LiveStream:
    """A live motion that is streamed through the rotary buffer.

    Attributes:
        job: the job as performed; after the end, it has the position and the time of the end.
        begun: True once something has moved.
    """

    def __init__(self, operation: Operation, live: Live) -> None:
        self.operation = operation
        self.job = live.job
        self.begun = False
        self._live = live
        self._source = live.source
        self._sent = 0
        self._moves = 0
        self._ahead = 0
        self._look = min(max(_SHORTEST, _SEGMENTS * self.job.segment), _LONGEST)
        self._lines_due = self._status_due = self._positions_due = self._settings_due = 0.0
        self.supervision = Supervision(operation, live.job)
        self._course = Course(live.job.robot, live.job.start, live.job.slack, live.job.segment)
        self._asked = 0.0

    @property
    def done(self) -> float:
        """Return how long the motion has been running [s]."""
        return max(0, self._moves - self._ahead - AHEAD) * self.job.segment

    @property
    def command(self) -> JobCommand | None:
        """Return None: a live motion has no commands."""
        return None

    @property
    def left(self) -> int:
        """Return 1 if the motion has unsent lines, and 0 if not. The number of these lines isn't known before
        the motion ends.
        """
        return 0 if self._source.ended else 1

    def run(self) -> Script[None]:
        """Send the first lines of the motion to the controller, start the motion, and carry out orders until
        it ends.

        Raises:
            Stopped: a person has ended the run; the robot may be moving.
            Trouble: the motion can't continue, and the robot may be moving; or the motion isn't started,
                because the robot has left the position from which the motion was proved.
            Lost: the connection is no longer usable.
        """
        operation, job = self.operation, self.job
        operation.go(Event.LOAD, f"loading {job.name}")
        yield from self.supervision.check()
        for line in loading_of(job).preparing:
            yield from operation.ask(line)
        yield from operation.ask(f"%{100.0 * operation.override:g}")
        for line in ("OPEN ROT", "CLEAR", "CLOSE"):
            yield from operation.ask(line)
        self._obey_at_rest()
        yield from self._write(self._live.opening)
        yield from self._fill(self._live.lead)
        operation.watch = URGENT
        ended = False
        while not ended:
            with contextlib.suppress(Interrupted):
                yield from self._obey()
                ended = yield from (self._step() if self.begun else self._begin())
        operation.watch = ()
        yield from come_to_rest(operation, job.robot)
        yield from leave(operation, job.robot)
        self.job = replace(job, end=self._source.end, duration=self._moves * job.segment)
        operation.go(Event.END, f"{job.name} has ended")

    def _begin(self) -> Script[bool]:
        operation = self.operation
        yield from self.supervision.begin()
        yield from away_from_start(operation, self.job, "begin again")
        yield from operation.ask("R")
        self.begun = True
        operation.slept = 0.0
        operation.go(Event.BEGIN)
        return False

    def _step(self) -> Script[bool]:
        """Do one step; return True if all lines have been executed."""
        operation, now = self.operation, self.operation.now
        if now >= self._lines_due:
            self._lines_due = now + self._look
            yield from self._look_at((yield from self._ask_lines()))
            if self._source.ended:
                return self._ahead == 0
            if self._source.expired(now):
                yield from self._hold("no target comes any more")
                raise Stopped(abort=False)
            if self._ahead < loading_of(self.job).low + _LATE:
                # Further lines would come too late: come to rest on the path, while enough lines for this are
                # ahead.
                yield from self._hold(f"buffer low: {self._ahead} lines ahead")
                operation.remark("this computer or the link is too slow: run `yarc doctor`", warning=True)
                raise Stopped(abort=False)
            yield from self._fill(self._live.lead)
        elif now >= self._status_due - self._look / 2.0:
            self._status_due = now + STATUS_EACH
            yield from look_at_motors(operation, self.job.robot)
        elif now >= self._positions_due - self._look / 2.0:
            self._positions_due = max(self._positions_due + operation.positions_each, now)
            yield from self._ask_positions()
        elif now >= self._settings_due:
            self._settings_due = now + SETTINGS_EACH
            yield from self._stop_for_others((yield from self.supervision.compare()))
        else:
            yield Wait(min(self._lines_due, self._status_due, self._positions_due, self._settings_due))
        return False

    def _ask_positions(self) -> Script[None]:
        operation, job = self.operation, self.job
        asked_at = operation.now
        sampled = yield from sample(operation, job.robot, self.done)
        operation.notices.append(sampled)
        executed = max(0, self._sent - self._ahead - AHEAD)
        self._course.forget(executed)
        since = operation.now - self._asked
        most = executed + 2 * AHEAD + 1 + int(FASTEST * since / job.segment)
        off = self._course.off(sampled, (executed, most), operation.now - asked_at)
        yield from look_whether_astray(operation, job.robot, off)

    def _fill(self, lead: int) -> Script[None]:
        """Keep `lead` lines in the buffer. At the end of the motion, add lines, so that the guard is disarmed
        before the number of lines falls to the guard's limit.
        """
        source = self._source
        wanted = lead - self._ahead
        if wanted <= 0 or source.ended:
            return
        lines = source.more(self.operation.now, wanted)
        self._moves += len(lines)
        if source.ended:
            stand = lines[-1] if lines else ""
            # when the line that disarms the guard is executed, the buffer must contain more lines than the
            # guard requires
            behind = (stand,) * (loading_of(self.job).low + AHEAD + _LATE if stand else 0)
            lines = (*lines, DISARMS, *behind)
        yield from self._write(lines)

    def _write(self, lines: tuple[str, ...]) -> Script[None]:
        first = 0
        while first < len(lines):
            count = fitting(lines, first, AROUND)
            packet = lines[first : first + count]
            written = yield from self.operation.write((AROUND[0], *packet, AROUND[1]))
            if written.error is not None:
                yield from look_at_motors(self.operation, self.job.robot)
                raise Trouble(
                    f"the controller refuses a line of a live motion: ERR{written.error:03d}",
                    "run `yarc doctor`",
                    "Y1603",
                )
            self.supervision.lines_sent(packet)
            self._course.append(packet)
            first += count
            self._sent += count
            self._ahead += count

    def _ask_lines(self) -> Script[Flow]:
        asked = self.operation.now
        flow = yield from self.supervision.ask()
        self._ahead, self._asked = flow.ahead, asked
        return flow

    def _look_at(self, flow: Flow) -> Script[None]:
        """Check that neither the controller nor another client has interfered with the motion. A live motion
        that the controller holds isn't continued.

        Raises:
            Stopped: the guard or the watchdog has held the motion.
            Trouble: another client has changed something that was proved.
        """
        if HELD in (flow.armed, flow.watched):
            silence = (
                f"the controller has received nothing from this computer for "
                f"{self.operation.silence:.2g} s, and holds"
            )
            why = silence if flow.watched == HELD else "the guard PLC holds: the buffer ran low"
            yield from self._hold(why)
            self.operation.remark("this computer or the link is too slow: run `yarc doctor`", warning=True)
            raise Stopped(abort=False)
        yield from self._stop_for_others(self.supervision.changed(flow, moving=True))

    def _stop_for_others(self, changes: str) -> Script[None]:
        """Hold the motion if another client has changed something.

        Raises:
            Trouble: something was changed.
        """
        if changes:
            if slew := self.supervision.hold_again(changes):
                yield from self.operation.ask(slew)
            yield from self._hold(changes)
            raise Trouble(
                f"another client uses this controller: {changes}",
                "find the client, and restore the value",
                "Y1605",
            )

    # orders

    def _obey_at_rest(self) -> None:
        """Carry out orders before anything moves: a stop ends the run at once."""
        if any(isinstance(order, URGENT) for order in self.operation.orders):
            raise Stopped(abort=False)

    def _obey(self) -> Script[None]:
        """Carry out orders. A hold ends a live motion, as a stop does, so that an old jog or velocity can't
        be resumed later.
        """
        operation, orders = self.operation, self.operation.orders
        while orders:
            order = orders.popleft()
            if isinstance(order, URGENT):
                if Abort() in (order, *orders):
                    orders.clear()
                    if self.begun:
                        yield from operation.abort()
                    raise Stopped(abort=True)
                if self.begun:
                    yield from self._hold("stop requested")
                if isinstance(order, Fail):
                    raise Trouble(order.what, order.remedy, code="")
                raise Stopped(abort=False)
            if isinstance(order, Override):
                before, operation.override = 100.0 * operation.override, order.percent / 100.0
                yield from operation.ask(f"%{order.percent:g}")
                self.supervision.slews(before)

    def _hold(self, reason: str) -> Script[None]:
        controller = turbo_pmac(self.job.robot)
        yield from self.operation.hold(controller.coordinate_system, controller.hold_time)
        self.operation.go(Event.HOLD, reason)
