"""The rotary buffer: sending lines, asking how full it is, and checking that it is large enough. No I/O.

The buffer is open on our port only within the packet that carries lines to it. An open buffer stores every
line that it can, including questions for variables (facts 3).
"""

from __future__ import annotations

from yarclang.pmac.errors import BUFFER_IN_USE, ERRORS, NO_ROOM
from yarclang.runtime.actions import Lost, Script, Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.course import Course
from yarclang.runtime.pmac.feed import AROUND, Feed
from yarclang.runtime.pmac.loading import loading_of
from yarclang.runtime.pmac.messages import Written
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.supervision import Flow, Supervision
from yarclang.runtime.pmac.watching import look_at_motors
from yarclang.units import MS

_SHARE = 0.7
"""Largest share of the connection's speed that a program may need."""

_WITHIN_RESERVE = 12
"""Minimum number of exchanges with the controller while a full buffer runs down to its low mark. If there is
time for fewer exchanges, some refills come too late (found by experiment).
"""

_SHORTEST = 1.0
"""Shortest part of a program for which a rotary buffer must have room [s], unless the whole program fits."""


class Rotary:
    """The rotary buffer of one job.

    Attributes:
        feed: progress of the job's lines: how many were sent and executed.
        supervision: supervision of the controller with the buffer.
        course: path of the lines that were sent, with which the motors' positions are compared.
    """

    def __init__(self, operation: Operation, job: Job) -> None:
        self.operation = operation
        self.job = job
        self.feed = Feed(job)
        self.supervision = Supervision(operation, job)
        self.course = Course(job.robot, job.start, job.slack, job.segment)

    def define(self) -> Script[None]:
        """Define the buffer, line by line (Listing 3 of the paper), without opening it.

        Raises:
            Trouble: the buffer would be too small.
        """
        job = self.job
        held = loading_of(job).words // len(job.robot.controller.axes) * job.segment
        if not job.fits and held < _SHORTEST:
            raise Trouble(
                f"the rotary buffer of {loading_of(job).words} words holds {held:.2f} s of the program: "
                f"at least {_SHORTEST:g} s are needed",
                "compile the program again: yarcc selects the size",
            )
        for line in loading_of(job).preparing:
            yield from self.operation.ask(line)

    def write(self) -> Script[None]:
        """Send the next lines: as many as fit into the buffer and into a packet.

        Raises:
            Trouble: the controller refuses a line.
        """
        packet = self.feed.packet()
        written = yield from self.operation.write((AROUND[0], *packet, AROUND[1]))
        if written.error is None:
            self.feed.written(len(packet))
            self.supervision.lines_sent(packet)
            self.course.append(packet)
            return
        yield from look_at_motors(self.operation, self.job.robot)
        opens = written.error == BUFFER_IN_USE and (written.line or 0) <= 1
        raise Trouble(
            _refusal(written, self.feed.sent),
            "another client has opened a buffer of this controller: find the client, and CLOSE the "
            "buffer there"
            if opens
            else "the robot comes to rest; run `yarc doctor`, then the program again",
            "Y1603",
            self.feed.sent + max((written.line or 2) - 2, 0),
        )

    def ask(self) -> Script[Flow]:
        """Ask how many lines are in the buffer, together with the other values of a `Flow`.

        Raises:
            Lost: the answer reports more lines in the buffer than were sent.
        """
        operation, feed = self.operation, self.feed
        asked = operation.now
        flow = yield from self.supervision.ask()
        if flow.ahead > feed.at_most:
            raise Lost(f"{flow.ahead} in reply to PR, with at most {feed.at_most} lines in the buffer")
        feed.heard(flow.ahead, asked, operation.now)
        return flow

    def check_full(self) -> Script[None]:
        """Check that the buffer hasn't run empty in motion. Before the first move and after the last one the
        robot is at rest on its path, so there an empty buffer is no fault.

        Raises:
            Trouble: it has run empty, or a motor can't move.
        """
        if self.feed.ran_dry:
            yield from look_at_motors(self.operation, self.job.robot)
            raise Trouble(
                f"underrun: the rotary buffer ran dry with {self.feed.left} lines to come; the robot "
                "comes to "
                f"rest off its path",
                "run `yarc doctor`: this computer or the link was too slow, or another client uses this "
                "controller, and the guard PLC didn't hold in time",
                "Y1607",
            )

    def check_prefilled(self, spent: float, packets: int) -> None:
        """Check that the buffer was filled fast enough before the start. If not, it couldn't be kept filled
        during the motion either.

        Args:
            spent: duration of the filling [s].
            packets: number of packets.

        Raises:
            Trouble: the filling was too slow. Nothing has moved yet.
        """
        job, feed = self.job, self.feed
        if feed.at_most != feed.sent:
            raise Trouble(
                f"the controller counts {feed.at_most} lines in its buffer, but only {feed.sent} were sent",
                "another client may use this controller; run `yarc doctor`",
            )
        if feed.has_all_moves or spent <= 0.0:
            return
        remedy = "compile with longer segments (--tm), or find out what slows the link (`yarc doctor`)"
        rate = feed.sent / spent
        if rate * _SHARE < job.lines_per_second:
            raise Trouble(
                f"the link carries {rate:.0f} lines/s; the program needs {job.lines_per_second:.0f} and "
                f"a reserve",
                remedy,
            )
        most = (job.capacity - feed.low) * job.segment / _WITHIN_RESERVE
        if spent / packets > most:
            raise Trouble(
                f"the controller takes {spent / packets / MS:.0f} ms for a packet; "
                f"for a buffer of {job.capacity * job.segment:.2f} s at most {most / MS:.0f} ms are allowed",
                remedy,
            )


def _refusal(written: Written, sent: int) -> str:
    error = written.error or 0
    lines = written.request.lines
    at = max(written.line or 0, 1)
    meaning = ERRORS.get(error, "an error that isn't documented")
    if error == NO_ROOM:
        meaning += ", although there should be"
    text = lines[at - 1]
    if text in AROUND:
        return f"the controller refuses {text!r}: ERR{error:03d}, {meaning}"
    return f"the controller refuses line {sent + at - 1} of the motion, {text!r}: ERR{error:03d}, {meaning}"
