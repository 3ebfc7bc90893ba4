"""Reading of run logs for pages. Each log is read in a process of its own, with limited memory and time,
so that it can't disturb the process that streams to the controller.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
from collections import OrderedDict

from yarclang.pendant.apart import begun, command_of
from yarclang.pendant.runs.shown import Window
from yarclang.runtime.actions import Trouble

LARGEST = 256 << 20
"""Largest log that is read [bytes]. A run of one hour takes about 10 MB."""

AT_ONCE, WAITING = 2, 8
"""Largest number of logs that are read at the same time, and largest number of further requests that may wait
for their turn.
"""

_MOST_MEMORY = 3 << 30
"""Largest address space of a process [bytes]; its libraries take 1 GiB."""

_LONGEST = 60.0
"""Longest time of a process [s]."""

_LARGEST_ANSWER = 16 << 20
_REMEMBERED = 6

_Key = tuple[int, int, int, int, Window | None]


class Readings:
    """Reader of run logs. The results for the last few logs are cached."""

    def __init__(self) -> None:
        self._reading = asyncio.Semaphore(AT_ONCE)
        self._waiting = 0
        self._known: OrderedDict[_Key, bytes] = OrderedDict()

    async def shown(self, handle: int, status: os.stat_result, window: Window | None) -> bytes:
        """Return the content of a run log as the JSON of the message `RunShown`.

        Args:
            handle: descriptor of the open log.
            status: status of the log from the operating system, by which a cached result is recognized.
            window: time range of the plotted curves [s since the log was opened]; None for the whole run.

        Raises:
            Trouble: the log can't be shown, or too many logs are being read.
        """
        if status.st_size > LARGEST:
            what = f"the log has {status.st_size:,} bytes; up to {LARGEST:,} are shown here"
            raise Trouble(what, "download it: `yarc plot` and `yarc replay` show it", "large")
        key = (status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, window)
        if (known := self._known.get(key)) is not None:
            return known
        if self._waiting >= AT_ONCE + WAITING:
            raise Trouble("too many logs are being read", "try again in a moment", "busy")
        self._waiting += 1
        try:
            async with self._reading:
                content = await self._read(handle, window)
        finally:
            self._waiting -= 1
        self._known[key] = content
        while len(self._known) > _REMEMBERED:
            self._known.popitem(last=False)
        return content

    async def _read(self, handle: int, window: Window | None) -> bytes:
        more = () if window is None else tuple(map(repr, window))
        command = command_of("yarclang.pendant.runs.shown", (f"/dev/fd/{handle}", *more), _MOST_MEMORY)
        process = await begun(command, talks=False, handles=(handle,))
        assert process.stdout is not None
        content = bytearray()
        try:
            async with asyncio.timeout(_LONGEST):
                while data := await process.stdout.read(1 << 18):
                    content += data
                    if len(content) > _LARGEST_ANSWER:
                        raise Trouble(_WHAT, _REMEDY, "large")
                status = await process.wait()
        except TimeoutError:
            raise Trouble(f"{_WHAT}: it takes longer than {_LONGEST:g} s", _REMEDY, "large") from None
        finally:
            with contextlib.suppress(ProcessLookupError):
                if process.returncode is None:
                    process.kill()
                    await process.wait()
        if status != 0 or not content:
            raise Trouble(f"{_WHAT}: it needs more memory than allowed", _REMEDY, "large")
        if content.startswith(b'{"refused"'):
            raise Trouble(json.loads(content)["refused"], "choose another log", "unreadable")
        return bytes(content)


_WHAT = "the log can't be shown here"
_REMEDY = "download it: `yarc plot` and `yarc replay` show it"
