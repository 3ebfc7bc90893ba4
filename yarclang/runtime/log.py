"""The log of a run: an MCAP file that is written by its own thread, so that neither a slow nor a full disk
delays the robot.

MCAP (mcap.dev) is read by Foxglove and other programs; `yarclang.report.runs.log` reads the file back. The
program's text, the controller's text, the certificate and the necessary facts about the robot are attached. A
log therefore stays readable after the program or the robot has changed.
"""

from __future__ import annotations

import contextlib
import os
import re
import stat
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime
from itertools import count
from pathlib import Path, PurePath
from queue import Empty, SimpleQueue
from typing import BinaryIO

from mcap.writer import Writer

from yarclang.runtime.job import Job
from yarclang.runtime.log_record import Anchor, Begun, Item, Ordered, Record
from yarclang.runtime.notices import Changed, Notice, Order
from yarclang.runtime.outcome import Ended
from yarclang.runtime.transports.promptness import shares_the_interpreter

FOLDER = Path("yarc-runs")
"""Folder of logs if the user names none."""

FLUSH_EACH = 0.5
"""Time between two flushes of the log to its file [s]. If the process is killed, at most the messages since
the last flush are lost.
"""

_LONGEST_CLOSE = 10.0
"""Longest time to wait for a slow disk when the log is closed [s]."""

_LONGEST_STEM = 50
"""Longest stem of the log's file name [characters]. A file name may have 255 bytes, and a character takes up
to four of them.
"""


class RunLog:
    """The log of a run. `open` creates the file; `take` accepts the notices to be written.

    Attributes:
        path: the log's file.
        failure: the reason why nothing can be written any more; None if there was no failure.
        loss: what has happened to the file (such as its removal), known once the log is closed; empty if the
            file is still there.
    """

    def __init__(
        self,
        stream: BinaryIO,
        path: Path,
        job: Job,
        address: str,
        *,
        version: str,
        on_failure: Callable[[str], object] | None = None,
        anchor: Anchor,
        client: str = "",
    ) -> None:
        self.path = path
        self.failure: str | None = None
        self.loss = ""
        self._made = path.stat()
        self._stream = stream
        self._on_failure = on_failure
        self._queue: SimpleQueue[Item | None] = SimpleQueue()
        self._written = 0
        # The checksum over all data detects any bit that changes later.
        self._writer = Writer(stream, enable_data_crcs=True)
        self._record = Record(self._writer, job, anchor)
        self._record.begin(
            {
                "controller": address,
                "yarclang": version,
                "started": datetime.fromtimestamp(anchor.wall / 1e9, UTC).isoformat(timespec="milliseconds"),
                "pace": f"{anchor.pace:g}",
                **({"client": client} if client else {}),
            }
        )
        self._flush()
        self._thread = threading.Thread(target=self._work, name="run log", daemon=True)
        self._thread.start()

    @classmethod
    def open(
        cls,
        place: Path | None,
        job: Job,
        address: str,
        *,
        version: str,
        on_failure: Callable[[str], object] | None = None,
        pace: float = 1.0,
        clock: float | None = None,
        anchor: Anchor | None = None,
        client: str = "",
    ) -> RunLog:
        """Create a log and write everything that does not change during the run.

        Args:
            place: the file; or a folder, for a new file named after the program and the time; None for
                `FOLDER`. An existing file is never overwritten: the new file gets the suffix -2, -3 and so
                on.
            job: the whole program.
            address: address of the controller, for people.
            version: version of yarclang.
            on_failure: function that is called once, from another thread, with the reason, when nothing can
                be written any more.
            pace: seconds on the session's clock per second on the wall clock.
            clock: time of the session [s]; None: the host's clock at the session's pace.
            anchor: start of the run on both clocks; None: now. If given, `pace` and `clock` are ignored.
            client: name of the client who ordered the first motion, for people; empty: not known.

        Raises:
            OSError: the file can't be created or written. No file is left.
        """
        now = time.monotonic() * pace if clock is None else clock
        anchor = anchor or Anchor(now, time.time_ns(), pace)
        path, stream = _create(place, job.name, anchor.wall)
        try:
            return cls(
                stream,
                path,
                job,
                address,
                version=version,
                on_failure=on_failure,
                anchor=anchor,
                client=client,
            )
        except BaseException:
            with contextlib.suppress(OSError):
                stream.close()
            if path.is_file():
                path.unlink()
            raise

    def take(self, notice: Notice) -> None:
        """Accept a notice to be written to the log. Returns at once."""
        self._put(notice)

    def begin(self, job: Job) -> None:
        """Record that `job` is performed from now on: the whole program again, a part of it, or the approach
        to its start.
        """
        self._put(Begun(job))

    def ordered(self, time: float, order: Order) -> None:
        """Log a person's order.

        Args:
            time: time of the order on the notices' clock [s].
            order: the order.
        """
        self._put(Ordered(time, order))

    @property
    def problem(self) -> str:
        """Return the fault of the log, as a sentence without a full stop; empty if there is none."""
        if self.loss:
            return f"the run log can't be used any more: {self.path} {self.loss}"
        return "" if self.failure is None else f"the log can't be written: {self.failure}"

    @property
    def remedy(self) -> str:
        """Return what a person should do about `problem`."""
        return (
            "don't change the folder of the log during a run, or choose another one with --log PATH"
            if self.loss
            else "make room on the disk"
        )

    def close(self, ended: Ended | None = None) -> None:
        """Write all notices that aren't written yet and the outcome of the run, and close the file. May be
        called again, and after a failure.
        """
        if ended is not None:
            self._put(ended)
        self._queue.put(None)
        written = -1
        while self._thread.is_alive() and self.failure is None:
            if written == self._written:
                self.failure = f"the disk hasn't responded for {_LONGEST_CLOSE:g} s"
                return
            written = self._written
            self._thread.join(_LONGEST_CLOSE)

    def lost(self, size: int = 0) -> str:
        """Check that the written file still exists.

        Args:
            size: minimum size of the file [bytes].

        Returns:
            What has happened to the file, as the end of a sentence; empty if all is well.
        """
        try:
            status = self.path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return "doesn't exist any more; it was removed or moved during the run"
        except OSError as error:
            return f"can't be read: {(error.strerror or str(error)).lower()}"
        if not os.path.samestat(status, self._made):
            return "is a different file now; the log was removed or moved during the run"
        if stat.S_ISREG(status.st_mode) and status.st_size < size:
            return f"was truncated during the run: {status.st_size:,} of {size:,} bytes are left"
        return ""

    def __enter__(self) -> RunLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _put(self, item: Item) -> None:
        if self.failure is None:
            self._queue.put(item)

    # methods that run in the log's thread

    def _work(self) -> None:
        """Write notices until the log is closed, or until the file can't be written."""
        try:
            with shares_the_interpreter():
                self._write_all()
            self._writer.finish()  # type: ignore[no-untyped-call]  # the library's
            self._stream.flush()
            # check before the file is closed: as long as it is open, no other file can have its inode number
            self.loss = self.lost(self._stream.tell())
            self._stream.close()
        except OSError as error:
            self._fail((error.strerror or str(error)).lower())
        except Exception as error:  # a bug of ours: report it, and let the robot move on
            self._fail(f"{type(error).__name__}: {error}")

    def _write_all(self) -> None:
        due: float | None = None
        while True:
            try:
                item = self._queue.get(timeout=None if due is None else max(0.0, due - time.monotonic()))
            except Empty:
                self._flush()
                due = None
                continue
            if item is None:
                return
            self._record.write(item)
            self._written += 1
            due = due or time.monotonic() + FLUSH_EACH
            if isinstance(item, Changed) or time.monotonic() >= due:
                self._flush()
                due = None

    def _flush(self) -> None:
        self._writer.flush()  # type: ignore[no-untyped-call]  # the library's

    def _fail(self, reason: str) -> None:
        self.loss = self.lost()
        self.failure = reason
        with contextlib.suppress(OSError):
            self._stream.close()
        if self._on_failure is not None:
            # if the listener's event loop has ended, it raises RuntimeError
            with contextlib.suppress(RuntimeError):
                self._on_failure(reason)


def _create(place: Path | None, program: str, wall: int) -> tuple[Path, BinaryIO]:
    """Create a new file for a log."""
    if place is None or place.is_dir():
        stem = re.sub(r"[^\w.+-]+", "_", PurePath(program).stem).strip("_.")[:_LONGEST_STEM] or "program"
        started = datetime.fromtimestamp(wall / 1e9).astimezone()
        place = (place or FOLDER) / f"{stem}-{started:%Y%m%d-%H%M%S}.mcap"
    if place.exists() and not place.is_file():  # a device, such as /dev/null
        return place, place.open("wb")
    place.parent.mkdir(parents=True, exist_ok=True)
    for number in count(1):
        path = place if number == 1 else place.with_name(f"{place.stem}-{number}{place.suffix}")
        with contextlib.suppress(FileExistsError):
            return path, path.open("xb")
    raise AssertionError
