"""Analysts: language servers for the editor pages. Each analyst checks the programs that one page has open.
It runs in a process of its own, so that it can't disturb the process that streams to the controller.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from asyncio.subprocess import Process
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

from yarclang.coordinator.messages.lines import denied
from yarclang.pendant.apart import begun, command_of
from yarclang.pendant.passing import Passing, written
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

MOST = 4
"""Largest number of analysts at once."""

MOST_MEMORY = 4 << 30
"""Largest address space of each analyst [bytes]. The compiler with its libraries alone takes 1 GiB."""

_LARGEST = 16 << 20
"""Longest message of an analyst [bytes]."""

_LARGEST_TOLD = 4 << 20
"""Longest message that is passed to a page [characters]."""

_LAST = 2.0
"""Longest wait until an analyst that was killed has ended [s]."""

Say = Callable[[str], Awaitable[None]]


class Analysts:
    """The analysts of a pendant.

    Args:
        robot: robot for programs that name no robot.
        folder: folder of the project.
        inside: returns the absolute path of a file of the project, or raises `Trouble` if the project has no
            such file.
    """

    def __init__(self, robot: Robot, folder: Path, inside: Callable[[str], Path]) -> None:
        described = robot.file
        self._robot = str(described) if described.is_file() else robot.name
        self._folder = folder
        self._inside = inside
        self._serving = 0

    @contextlib.asynccontextmanager
    async def one(self, say: Say) -> AsyncIterator[Analyst]:
        """Give a page an analyst of its own until the context ends.

        Args:
            say: function that sends a message to the page.

        Raises:
            Trouble: `MOST` analysts are already running.
        """
        if self._serving >= MOST:
            raise Trouble(
                f"{MOST} pages already have an analyst: findings aren't shown here", "close another one", ""
            )
        self._serving += 1
        analyst = Analyst(self._command(), self._folder, self._inside, say)
        try:
            yield analyst
        finally:
            try:
                await analyst.close()
            finally:
                self._serving -= 1

    def _command(self) -> tuple[str, ...]:
        return command_of("yarclang.cli.yarc", ("lsp", "--robot", self._robot), MOST_MEMORY)


class Analyst:
    """The analyst of one page. It is restarted once if it dies.

    Args:
        command: command that starts the analyst.
        folder: folder of the project.
        inside: returns the absolute path of a file of the project, or raises `Trouble` if the project has no
            such file.
        say: function that sends a message to the page.
    """

    def __init__(
        self, command: tuple[str, ...], folder: Path, inside: Callable[[str], Path], say: Say
    ) -> None:
        self._command = command
        self._folder = folder
        self._say = say
        self._passing = Passing(folder, inside)
        self._process: Process | None = None
        self._sending = asyncio.Lock()

    @property
    def pid(self) -> int | None:
        """Process id of the analyst."""
        return self._process.pid if self._process else None

    async def run(self) -> None:
        """Start the analyst and pass its messages to the page. Restart the analyst once if it ends; return
        when it has ended twice.
        """
        for last in (False, True):
            try:
                self._process = await begun(self._command, folder=self._folder)
                await self._tell("yarc/begun", "again" if last else "")
                await self._listen(self._process)
            except (OSError, ValueError, KeyError, asyncio.IncompleteReadError, asyncio.LimitOverrunError):
                pass
            await self._end()
            async with self._sending:
                self._passing.again()
        await self._tell(
            "yarc/ended",
            "the analyst has ended twice, and findings aren't shown: open the program again to restart it",
        )

    async def take(self, text: str) -> None:
        """Pass a message from the page to the analyst. A message that pages may not send is answered with an
        error.

        Args:
            text: the message as received.
        """
        async with self._sending:
            process = self._process
            if process is None or process.stdin is None or process.returncode is not None:
                return
            try:
                message = await asyncio.to_thread(self._passing.to_analyst, text)
            except Trouble as trouble:
                refused = {"jsonrpc": "2.0", "method": "yarc/refused", "params": denied(trouble).to_json()}
                await self._say(json.dumps(refused))
                return
            await _write(process, message)

    async def close(self) -> None:
        """End the analyst."""
        await self._end()

    async def _listen(self, process: Process) -> None:
        """Pass the analyst's messages to the page until its output ends."""
        assert process.stdout is not None
        while True:
            head = await process.stdout.readuntil(b"\r\n\r\n")
            size = _size(head)
            content = json.loads(await process.stdout.readexactly(size))
            if (answer := self._passing.reply(content)) is not None:
                await _write(process, answer)
            elif (told := self._passing.to_page(content)) is not None:
                text = json.dumps(told)
                if len(text) > _LARGEST_TOLD:
                    told = {key: told[key] for key in ("jsonrpc", "id") if key in told}
                    text = json.dumps(told | {"error": {"message": "the answer is too long for a page"}})
                await self._say(text)

    async def _end(self) -> None:
        process, self._process = self._process, None
        if process is None or process.returncode is not None:
            return
        if process.stdin is not None:
            process.stdin.close()
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(process.wait(), _LAST)

    async def _tell(self, method: str, text: str) -> None:
        await self._say(json.dumps({"jsonrpc": "2.0", "method": method, "params": {"text": text}}))


async def _write(process: Process, message: dict[str, Any]) -> None:
    """Send a message. If the analyst has died, the message is lost."""
    assert process.stdin is not None
    with contextlib.suppress(ConnectionError):
        process.stdin.write(written(message))
        await process.stdin.drain()


def _size(head: bytes) -> int:
    """Return the length of a message [bytes], as stated in the message's header.

    Raises:
        ValueError: the header has no length, or the message is too long.
    """
    for line in head.split(b"\r\n"):
        name, _, value = line.partition(b":")
        if name.lower() == b"content-length" and 0 <= (size := int(value)) <= _LARGEST:
            return size
    raise ValueError("no length")
