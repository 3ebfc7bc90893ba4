"""A fast client of the server that sends and reads raw messages, and can leave many requests open."""

import asyncio
import json
import sys
import tempfile
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

ROBOT = "INDUSTRIAL6"
"""The robot for texts whose ROBOT line was removed."""

COMMAND = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "lsp", "--robot", ROBOT)

Answer = dict[str, Any]
"""A response: `result`, or `error`."""


class Wire:
    """A running server."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self._number = 0
        self._open: dict[int, asyncio.Future[Answer]] = {}
        self.findings: dict[str, tuple[int, list[Any]]] = {}
        """The last findings that were sent for each text, with the version of the text."""
        self.changed = asyncio.Event()
        self._reader = asyncio.ensure_future(self._read())

    @property
    def memory(self) -> float:
        """The server's memory [MB]."""
        status = Path(f"/proc/{self._process.pid}/status").read_text()
        return int(next(row for row in status.splitlines() if row.startswith("VmRSS")).split()[1]) / 1024.0

    def tell(self, method: str, params: Any) -> None:
        """Send a notification."""
        self._send({"method": method, "params": params})

    def ask(self, method: str, params: Any) -> "asyncio.Future[Answer]":
        """Send a request."""
        self._number += 1
        future = self._open[self._number] = asyncio.get_running_loop().create_future()
        self._send({"id": self._number, "method": method, "params": params})
        return future

    def cancel(self) -> None:
        """Cancel the last request."""
        self.tell("$/cancelRequest", {"id": self._number})

    async def end(self) -> None:
        """Shut the server down."""
        await self.ask("shutdown", None)
        self.tell("exit", None)
        await self._process.wait()
        self._reader.cancel()

    def kill(self) -> None:
        """End the server at once."""
        if self._process.returncode is None:
            self._process.kill()
        self._reader.cancel()

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._process.stdin is not None
        self._process.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)

    async def _read(self) -> None:
        stream = self._process.stdout
        assert stream is not None
        while True:
            size = 0
            while line := (await stream.readline()).strip():
                if line.lower().startswith(b"content-length:"):
                    size = int(line.split(b":")[1])
            if not size:
                break
            self._take(json.loads(await stream.readexactly(size)))
        for future in self._open.values():
            if not future.done():
                future.set_exception(EOFError("the server has ended"))

    def _take(self, message: dict[str, Any]) -> None:
        method, number = message.get("method"), message.get("id")
        if method == "textDocument/publishDiagnostics":
            params = message["params"]
            self.findings[params["uri"]] = params.get("version"), params["diagnostics"]
            self.changed.set()
        elif method is not None and number is not None:
            self._send({"id": number, "result": None})
        elif method is None and number in self._open:
            future = self._open.pop(number)
            if not future.done():
                future.set_result(message)


@asynccontextmanager
async def server(capabilities: dict[str, Any]) -> AsyncIterator[Wire]:
    """Start a server, and end it. Output of the server on standard error fails the test."""
    with tempfile.TemporaryFile() as told:
        process = await asyncio.create_subprocess_exec(
            *COMMAND,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=told,
            limit=1 << 26,
        )
        wire = Wire(process)
        try:
            await wire.ask("initialize", {"processId": None, "rootUri": None, "capabilities": capabilities})
            wire.tell("initialized", {})
            yield wire
            await wire.end()
        finally:
            wire.kill()
            told.seek(0)
            said = told.read().decode(errors="replace")
        assert not said, said
