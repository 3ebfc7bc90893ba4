"""The transfer of program lines into the rotary buffer, which must neither overflow nor run empty. No I/O:
the time is an argument.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from yarclang.pmac.variables import DISARMS
from yarclang.runtime.job import Job
from yarclang.runtime.pmac.loading import loading_of
from yarclang.runtime.pmac.packets import fitting

IntArray: TypeAlias = npt.NDArray[np.intp]

AHEAD = 2
"""Number of moves that are calculated before they are executed (TUM 339)."""

AROUND = ("OPEN ROT", "CLOSE")
"""Lines that are sent before and after the program lines of a packet. The rotary is open only for these
program lines, so that variables can be asked for at any other time (facts 3).
"""

FASTEST = 2.5
"""Upper bound of the speed at which a controller executes a program, relative to the programmed speed. The
controller's largest override is less (TSRM 276).
"""

_LATE = 0.1
"""Time by which the host may be late before the guard PLC holds [s]."""


class Feed:
    """The transfer of a job's lines into the rotary buffer.

    The number of lines in the buffer is known only from the controller's answer to `PR`, and only for the
    moment of the answer. Between two answers, only an upper and a lower bound of this number are known. The
    upper bound is the last answer plus the lines sent since. The lower bound is the upper bound minus the
    lines that may have been executed since, at 100 %.

    Attributes:
        sent: number of lines that the controller has accepted.
    """

    def __init__(self, job: Job) -> None:
        self.job = job
        self.sent = 0
        self._ahead = 0
        self._sent_then = 0
        self._then = 0.0
        self._asked_then = 0.0
        self._moves = _moves(job)
        margin = max(2, round(_LATE / job.segment))
        self.low = min(
            loading_of(job).low + margin,
            max(loading_of(job).low + 1, (loading_of(job).low + loading_of(job).full) // 2),
        )
        """Least number of lines ahead: with fewer lines in the buffer, this computer holds the motion. It
        does so before the guard PLC would hold.
        """
        self.plenty = (loading_of(job).full + job.capacity) // 2
        """If fewer lines are ahead, sending more lines takes precedence over everything else."""
        self._guarded = len(job.lines) - job.lines[::-1].index(DISARMS) if DISARMS in job.lines else 0

    @property
    def left(self) -> int:
        """Return the number of lines that the controller hasn't received yet."""
        return len(self.job.lines) - self.sent

    @property
    def room(self) -> int:
        """Return the number of further lines for which the buffer certainly has room."""
        return self.job.capacity - self.at_most

    @property
    def at_most(self) -> int:
        """Return the largest possible number of lines in the buffer: the number if nothing was executed since
        the last `PR`.
        """
        return self._ahead + self.sent - self._sent_then

    def at_least(self, now: float) -> int:
        """Return the smallest possible number of lines in the buffer: the number if the controller has
        executed as many lines as possible since the last `PR`.

        Each segment uses one move, and the controller may have calculated two more moves ahead (`AHEAD`).
        Statements between moves take no time.
        """
        if now <= self._asked_then and self.sent == self._sent_then:
            return self._ahead
        taken = int((now - self._asked_then) / self.job.segment) + 1 + AHEAD
        # Number of moves before the first line that was ahead at the last `PR`, plus the number of moves that
        # may have left the buffer since.
        behind = self._moves_before(self._sent_then - self._ahead) + taken
        if behind > len(self._moves):
            return 0
        return max(0, self.sent - int(self._moves[behind - 1]) - 1)

    @property
    def heard_at(self) -> float:
        """Return the time at which `PR` was answered last [s]."""
        return self._then

    @property
    def round_trip(self) -> float:
        """Return the duration of the last question `PR` [s]."""
        return self._then - self._asked_then

    @property
    def taken(self) -> int:
        """Return the number of lines that had left the buffer when `PR` was answered last."""
        return self._sent_then - self._ahead

    @property
    def executed(self) -> int:
        """Return the number of lines that had been executed when `PR` was answered last. The two moves that
        the controller calculates ahead don't count. The lines that disarm the guard leave the buffer together
        with the last move, and so does the dwell after them at which the robot comes to rest.
        """
        taken = self.taken
        if self._guarded and int(self._moves[-1]) < taken <= self._guarded + 1:
            return int(self._moves[-AHEAD:][0])
        return max(0, taken - AHEAD)

    def executed_within(self, now: float) -> tuple[int, int]:
        """Return the minimum and the maximum number of lines that the controller may have executed by now, at
        any override.

        Only moves take time: the controller may have executed all lines before the first move for which the
        time wasn't long enough.

        Args:
            now: the host's clock [s].
        """
        taken = int(FASTEST * (now - self._asked_then) / self.job.segment) + 1 + AHEAD
        behind = self._moves_before(self._sent_then - self._ahead) + taken
        most = self.sent if behind >= len(self._moves) else min(self.sent, int(self._moves[behind]))
        return self.executed, most

    def heard(self, ahead: int, asked_at: float, now: float) -> None:
        """Record the controller's answer to `PR`.

        Args:
            ahead: number of lines in the buffer that aren't executed yet.
            asked_at: time of the question [s].
            now: time of the answer [s].
        """
        self._ahead, self._sent_then = ahead, self.sent
        self._asked_then, self._then = asked_at, now

    def packet(self) -> tuple[str, ...]:
        """Return the next lines for the controller, as many as fit into the buffer and into a packet."""
        most = min(self.room, self.left)
        if most <= 0:
            return ()
        count = min(most, fitting(self.job.lines, self.sent, AROUND))
        return self.job.lines[self.sent : self.sent + count]

    def written(self, count: int) -> None:
        """Record that the controller has accepted `count` more lines."""
        self.sent += count

    def worthwhile(self, now: float) -> bool:
        """Return True if a packet should be sent now: if a full packet fits into the buffer, if the rest of
        the program fits, or if the buffer may contain fewer than `plenty` lines.
        """
        packet = self.packet()
        if not packet:
            return False
        whole = len(packet) == self.left or len(packet) < self.room
        return whole or self.at_least(now) < self.plenty

    def hungry(self, now: float) -> bool:
        """Return True if the buffer may contain fewer than `plenty` lines, so that their number has to be
        asked for before anything else.
        """
        return self.left > 0 and self.at_least(now) < self.plenty

    def runs_low(self, now: float) -> bool:
        """Return True if the buffer may soon lack lines: the program has begun and has unsent lines that move
        the robot or disarm the guard, and too few lines are in the buffer.

        After these lines, the buffer may run empty: the robot comes to rest at the end of its last move. If
        the robot may be there already, a hold would have no effect.
        """
        ahead = self.at_least(now)
        if self.has_all_moves:
            return self.sent < self._guarded and 0 < ahead < self.low
        return ahead < self.low

    @property
    def has_all_moves(self) -> bool:
        """Return True if all lines that move the robot were sent."""
        return self._moves_before(self.sent) == len(self._moves)

    @property
    def ran_dry(self) -> bool:
        """Return True if the buffer has run empty in the middle of the motion: the robot has begun to move,
        and unsent lines move it further.

        A buffer that has run empty before the first move or after the last one is only filled again.
        """
        return self.at_most == 0 and 0 < self._moves_before(self.sent) < len(self._moves)

    def _moves_before(self, lines: int) -> int:
        """Return the number of moves among the first `lines` lines of the job."""
        return int(np.searchsorted(self._moves, lines))


def _moves(job: Job) -> IntArray:
    """Return the numbers of the job's lines that move the robot.

    Of consecutive lines with the same time, only the last one moves. Dwells, and lines before the first
    motion, don't move.
    """
    lasts = np.diff(np.append(job.times, job.duration)) > 0.0
    lasts[[row for row, _ in job.dwells]] = False
    return np.flatnonzero(lasts & (job.times > 0.0))
