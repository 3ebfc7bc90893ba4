"""The background interpreter, which executes lines of programs (CMD)."""

from __future__ import annotations

from collections import deque
from typing import Protocol

from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Reply
from yarclang.simulator.programs.buffers import Buffers

PORT = -1
_LONGEST_QUEUE = 64


class Interpreter(Protocol):
    """The controller as seen by the background interpreter: it executes lines, and has ports and buffers."""

    ports: dict[int, Port]
    buffers: Buffers

    def command(self, line: str, port: int = 0) -> Reply:
        """Execute a line, or store it in an open buffer."""
        ...

    def control(self, character: int, port: int = 0) -> Reply:
        """Execute a control character."""
        ...


class Background:
    """Executes the lines that programs send (CMD), on a port of its own. Replies and errors are discarded."""

    def __init__(self, interpreter: Interpreter) -> None:
        self._interpreter = interpreter
        self._queue: deque[tuple[str, int, int]] = deque()

    def put(self, text: str, system: int, motor: int) -> None:
        """Queue a line, with the coordinate system and motor that it addresses."""
        if len(self._queue) < _LONGEST_QUEUE:
            self._queue.append((text, system, motor))

    def clear(self) -> None:
        """Discard the queue."""
        self._queue.clear()

    def handle(self) -> None:
        """Execute the queued lines."""
        if not self._queue:
            return
        due, self._queue = self._queue, deque()
        for text, system, motor in due:
            port = self._interpreter.ports[PORT] = Port(motor, system)
            if text[:1] == "^" and len(text) == 2:
                self._interpreter.control(ord(text[1]) - 64, PORT)
            else:
                self._interpreter.command(text, PORT)
            if PORT not in self._interpreter.ports:
                # The line was a reset, which discards all queued lines.
                return
            self._interpreter.buffers.release(port)
