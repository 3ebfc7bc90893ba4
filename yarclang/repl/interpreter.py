"""Carry out typed texts in their order: dot commands (in `dots/`), and lines of the language.

The coordinator plans the motions of typed lines, and starts them when the session sends `go`.
"""

from __future__ import annotations

import asyncio
import traceback
from collections.abc import Awaitable

from yarclang.coordinator.messages import orders
from yarclang.repl.dot import DotCommand, Misused, dot_commands
from yarclang.repl.session import Session, trouble_text
from yarclang.runtime.actions import Trouble
from yarclang.subjects import suggest


class Interpreter(Session):
    """A user's session, with the functions that carry out typed texts.

    Texts are carried out one after the other, in the order in which they were typed. Only orders (`.stop`,
    `.hold`, ...) are carried out before texts that were typed earlier.
    """

    def typed(self, text: str) -> None:
        """Process one typed text: a line, or a block with its END.

        Orders are carried out at once. Other texts wait until all previous texts are done.
        """
        name = text.split(maxsplit=1)[0] if text.split() else ""
        command = dot_commands().get(name.lower())
        if command is not None and command.overtakes:
            self._overtake(command, text)
        elif self._question is not None:
            question, self._question = self._question, None
            if not question.done():
                question.set_result(text)
        elif not text.strip():
            self._go_on()
        else:
            self._waiting.append(text)
            self._arrived.set()

    def _go_on(self) -> None:
        """Handle an empty line: continue after a hold, or with the next single step. Do nothing if the robot
        waits for neither.
        """
        if (self.picture.under_way or self.picture.paused) and self.owns:
            self.order(orders.Resume())

    async def serve(self) -> None:
        """Carry out typed texts until the user leaves."""
        await self.renew()
        while not self.ended:
            while self._waiting and not self.ended:
                self._busy = True
                try:
                    await self.take(self._waiting.popleft())
                finally:
                    self._busy = False
            self._arrived.clear()
            if not self.ended:
                await self._arrived.wait()

    async def take(self, text: str) -> None:
        """Carry out one text. Errors are shown, and nothing is raised."""
        try:
            if text.lstrip().startswith("."):
                await self._dot(text.strip())
            else:
                await self.carry_out(text)
        except Trouble as trouble:
            self.refuse(trouble_text(trouble))
        except Exception as error:
            # Catch bugs too: a user at a robot still needs the prompt with its stop key.
            self.refuse(bug_text(error))

    async def _dot(self, text: str) -> None:
        name, _, rest = text.partition(" ")
        commands = dot_commands()
        command = commands.get(name.lower())
        if command is None:
            near = suggest(name.lower(), commands)
            self.refuse(f"there is no command {name}; {near.lower() or '.help lists them'}")
            return
        try:
            done = command.run(self, rest.strip())
            if done is not None:
                await done
        except Misused as misused:
            self.refuse(f"{misused}\n  it is written: {command.line}")

    def _overtake(self, command: DotCommand, text: str) -> None:
        """Carry out an order at once, without waiting."""
        try:
            done = command.run(self, text.partition(" ")[2].strip())
            if done is not None:
                task = asyncio.ensure_future(self._awaited(command, done))
                self._overtaking.add(task)
                task.add_done_callback(self._overtaking.discard)
        except Trouble as trouble:
            self.refuse(trouble_text(trouble))
        except Misused as misused:
            self.refuse(f"{misused}\n  it is written: {command.line}")

    async def _awaited(self, command: DotCommand, done: Awaitable[None]) -> None:
        try:
            await done
        except Trouble as trouble:
            self.refuse(trouble_text(trouble))
        except Misused as misused:
            self.refuse(f"{misused}\n  it is written: {command.line}")


def bug_text(error: Exception) -> str:
    """Return the text about a bug in this software, with the address for reports."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    return (
        f"a bug of yarclang has ended this command: {error!r}\n  help: report it, with this place: "
        f"{place.filename}:{place.lineno} in {place.name}"
    )
