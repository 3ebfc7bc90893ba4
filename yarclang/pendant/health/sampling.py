"""Regular measurements of the computer, of the pendant's process and of its data. All pages show the same
measurements. The values of the last hour are stored.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

from yarclang.pendant.accounts import people
from yarclang.pendant.accounts.accounts import Accounts
from yarclang.pendant.health.judging import low_of
from yarclang.pendant.health.measuring import Machine, machine, size_of, sizes_of
from yarclang.pendant.runs.folders import LogFolders
from yarclang.pendant.watched import Watched
from yarclang.runtime.actions import Trouble

EACH, EACH_UNWATCHED = 1.0, 5.0
"""Time between two measurements of the computer [s]: while a page is connected, and while no page is."""
_TURN = 0.1
"""Time between two measurements of the event loop's delay [s]."""
_SLOW_EACH = 60.0
"""Time between two measurements of folder sizes, and between two points of the history [s]."""
_KEPT = 60
"""Number of points of the history, one for each minute of an hour."""
_MINUTE = 60


@dataclass(frozen=True, slots=True)
class Stored:
    """Measured sizes of the pendant's data on the disk.

    Attributes:
        logs: number of run logs.
        logs_size: size of the run logs [bytes].
        growth: growth of the run logs [bytes/day]: of the last day, or the average of the last seven days if
            that is larger.
        project: size of the project [bytes]; None if it has too many files.
        data: size of the pendant's own folder, which contains the database [bytes]; None if it has too many
            files.
        database: size of the database with users, audit trail and alarms [bytes].
        deeds: number of entries of the audit trail.
    """

    logs: int
    logs_size: int
    growth: float
    project: int | None
    data: int | None
    database: int
    deeds: int


@dataclass(slots=True)
class Worst:
    """The largest delay of the event loop [s] in each of the last 60 seconds."""

    rows: deque[float] = field(default_factory=lambda: deque([0.0], _MINUTE))

    def note(self, delay: float) -> None:
        """Record a delay in the present second."""
        self.rows[-1] = max(self.rows[-1], delay)

    def next(self) -> None:
        """Begin the next second."""
        self.rows.append(0.0)

    @property
    def all(self) -> float:
        """Largest delay of the last minute [s]."""
        return max(self.rows)


class Sampler:
    """Regular measurements of the computer, of the pendant's process and of its data.

    Args:
        accounts: accounts of the pendant.
        watched: shared client of the coordinator, which knows the state of the robot and the connected pages.
        project: folder of the project.
        database: database file with users, sessions and audit trail.
        logs: folders of run logs.
        now: returns the time of a monotonic clock [s].

    Attributes:
        machine: newest measurement of the computer and the process; None before the first one.
        stored: newest measurement of the data on the disk.
        first: memory of this process at the first measurement [bytes].
        share: processor time of this process between the last two measurements, as a share of one processor.
        lag: largest delay of the event loop in each second of the last minute.
        history: measured values of the last hour by name, one per minute, oldest first.
    """

    def __init__(
        self,
        accounts: Accounts,
        watched: Watched,
        project: Path,
        database: Path,
        logs: LogFolders,
        now: Callable[[], float],
    ) -> None:
        self.machine: Machine | None = None
        self.stored: Stored | None = None
        self.first: int | None = None
        self.share = 0.0
        self.lag = Worst()
        self.history: dict[str, deque[float]] = {}
        self._accounts = accounts
        self._watched = watched
        self._project = project
        self._database = database.resolve()
        self._logs = logs
        self._now = now
        self._began = now()
        self._looked = self._looked_slowly = self._noted = -1e9
        self._looking = asyncio.Lock()
        self._low = ""

    @property
    def uptime(self) -> float:
        """Time since the pendant was started [s]."""
        return self._now() - self._began

    @property
    def pages(self) -> int:
        """Number of connected pages."""
        return self._watched.pages

    def low(self) -> str:
        """Return a warning about the disk with the least free space at the last measurement; empty if
        every disk had enough.
        """
        return self._low

    async def run(self) -> None:
        """Measure regularly until cancelled."""
        looking = asyncio.ensure_future(self._look_often())
        clock = asyncio.get_running_loop().time
        second = clock()
        try:
            while True:
                begun = clock()
                await asyncio.sleep(_TURN)
                self.lag.note(clock() - begun - _TURN)
                if clock() - second >= 1.0:
                    second = max(second + 1.0, clock() - 1.0)
                    self.lag.next()
        finally:
            looking.cancel()

    async def _look_often(self) -> None:
        while True:
            with suppress(Trouble, OSError):  # the next measurement may succeed
                await self.look()
            await asyncio.sleep(EACH if self._watched.is_watched else EACH_UNWATCHED)

    async def look(self) -> None:
        """Measure now, unless the last measurement is less than `EACH` / 2 old.

        Raises:
            Trouble: the audit trail can't be read.
        """
        async with self._looking:
            now = self._now()
            if now - self._looked < EACH / 2:
                return
            before, since = self.machine, now - self._looked
            self.machine = measured = await asyncio.to_thread(machine, self._places())
            self._looked = now
            if before is None:
                self.first = measured.own
            else:
                self.share = max(0.0, (measured.cpu - before.cpu) / since)
            if now - self._looked_slowly >= _SLOW_EACH:
                self._looked_slowly = now
                deeds = await self._accounts.database.call(people.last_deed)
                self.stored = await asyncio.to_thread(self._on_disk, deeds)
            self._low = low_of(measured.disks)
            if now - self._noted >= _SLOW_EACH:
                self._noted = now
                self._note(measured)

    def _places(self) -> tuple[tuple[str, Path], ...]:
        places = [("the project", self._project), ("the pendant's data", self._database.parent)]
        if self._logs.folder:
            places.append(("the run logs", Path(self._logs.folder)))
        return tuple(places)

    def _on_disk(self, deeds: int) -> Stored:
        files, _ = self._logs.files()
        now = datetime.now(UTC)
        day = (now - timedelta(days=1)).isoformat(timespec="seconds")
        week = (now - timedelta(days=7)).isoformat(timespec="seconds")
        in_day = sum(one.size for one in files if one.changed >= day)
        in_week = sum(one.size for one in files if one.changed >= week)
        path = self._database
        return Stored(
            logs=len(files),
            logs_size=sum(one.size for one in files),
            growth=max(float(in_day), in_week / 7.0),
            project=size_of(self._project),
            data=size_of(path.parent),
            database=sizes_of(path, Path(f"{path}-wal"), Path(f"{path}-shm")),
            deeds=deeds,
        )

    def _note(self, measured: Machine) -> None:
        health = self._watched.showing.heard_health
        values = {
            "disk": min((one.free for one in measured.disks), default=None),
            "own": measured.own,
            "memory": measured.available,
            "load": measured.load,
            "lag": self.lag.all,
            "reply": None if health is None else health.reply_s,
            "logs": None if self.stored is None else self.stored.logs_size,
        }
        for name, value in values.items():
            if value is not None:
                self.history.setdefault(name, deque(maxlen=_KEPT)).append(float(value))
