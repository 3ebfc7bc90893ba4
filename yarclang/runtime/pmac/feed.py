"""Which lines go next into the rotary, so that it neither overflows nor runs dry. No I/O: time is an argument."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from yarclang.runtime.job import Job
from yarclang.runtime.pmac.loading import loading_of
from yarclang.runtime.pmac.packets import fitting

IntArray: TypeAlias = npt.NDArray[np.intp]

AHEAD = 2
"""Moves that are calculated before they are executed (TUM 339)."""

AROUND = ("OPEN ROT", "CLOSE")
"""What stands around the lines of a packet: a rotary is open only for them, so that variables can be asked at any other time (facts 3)."""

FASTEST = 2.5
"""Of its own pace, at which a controller can execute a program: its largest override is below (TSRM 276)."""

_LATE = 0.1
"""What the host may be late before the guard PLC holds [s]."""


class Feed:
    """The way of a job's lines into the rotary.

    What lies in the buffer is known from `PR` alone, and only for the moment of its reply. Between two of them there are two
    bounds: at most what was there and what was sent since; at least that, less what can have been executed, at 100 %.

    Attributes:
        sent: lines that the controller has taken.
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
        """Fewer lines ahead than these are too few: sooner than the guard PLC finds."""
        self.plenty = (loading_of(job).full + job.capacity) // 2
        """With fewer lines ahead than these, nothing else is as important as more."""

    @property
    def left(self) -> int:
        """Lines that the controller hasn't got yet."""
        return len(self.job.lines) - self.sent

    @property
    def room(self) -> int:
        """Lines that surely fit."""
        return self.job.capacity - self.at_most

    @property
    def at_most(self) -> int:
        """Lines ahead, if nothing was executed since `PR`."""
        return self._ahead + self.sent - self._sent_then

    def at_least(self, now: float) -> int:
        """Lines ahead, if the controller executed all it can since `PR`.

        Each segment takes one more move; two may have been taken ahead at once. What stands between moves takes no time.
        """
        if now <= self._asked_then and self.sent == self._sent_then:
            return self._ahead
        taken = int((now - self._asked_then) / self.job.segment) + 1 + AHEAD
        behind = int(np.searchsorted(self._moves, self._sent_then - self._ahead)) + taken
        if behind > len(self._moves):
            return 0
        return max(0, self.sent - int(self._moves[behind - 1]) - 1)

    @property
    def heard_at(self) -> float:
        """When `PR` was answered last [s]."""
        return self._then

    @property
    def round_trip(self) -> float:
        """How long that took [s]."""
        return self._then - self._asked_then

    @property
    def executed(self) -> int:
        """Lines that were executed when `PR` was answered last; the two that are calculated ahead aren't."""
        return max(0, self._sent_then - self._ahead - AHEAD)

    def executed_within(self, now: float) -> tuple[int, int]:
        """Lines that have been executed by now, at least and at most, however fast somebody lets the time pass.

        Args:
            now: the host's clock [s].
        """
        taken = int(FASTEST * (now - self._asked_then) / self.job.segment) + 1 + AHEAD
        return self.executed, self.executed + AHEAD + taken

    def heard(self, ahead: int, asked: float, now: float) -> None:
        """The controller says how many lines lie ahead, to a question asked at `asked` [s] and answered `now`."""
        self._ahead, self._sent_then = ahead, self.sent
        self._asked_then, self._then = asked, now

    def packet(self) -> tuple[str, ...]:
        """The lines that fit into the buffer and into a packet, from the first that the controller hasn't got."""
        most = min(self.room, self.left)
        if most <= 0:
            return ()
        count = min(most, fitting(self.job.lines, self.sent, AROUND))
        return self.job.lines[self.sent : self.sent + count]

    def written(self, count: int) -> None:
        """The controller has taken so many more."""
        self.sent += count

    def worthwhile(self, now: float) -> bool:
        """Whether to send a packet now: a full one fits, or the rest of the program does, or few lines are ahead."""
        packet = self.packet()
        if not packet:
            return False
        whole = len(packet) == self.left or len(packet) < self.room
        return whole or self.at_least(now) < loading_of(self.job).full

    def hungry(self, now: float) -> bool:
        """Whether to find out what fits, before anything else."""
        return self.left > 0 and self.at_least(now) < self.plenty

    def runs_low(self, now: float) -> bool:
        """Whether too few lines are ahead, with more to come, for a program that has begun."""
        return self.left > 0 and self.at_least(now) < self.low


def _moves(job: Job) -> IntArray:
    """Which lines move: the last of those that wait for the same instant, but for those before the first motion, and for dwells."""
    lasts = np.diff(np.append(job.times, job.duration)) > 0.0
    lasts[[row for row, _ in job.dwells]] = False
    return np.flatnonzero(lasts & (job.times > 0.0))
