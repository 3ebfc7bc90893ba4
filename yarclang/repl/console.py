"""The terminal of `yarc repl`: a prompt with completion and history, a status line at the bottom, and keys.

Without a terminal, lines are read from standard input.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from yarclang.coordinator.messages import orders
from yarclang.coordinator.subscription import Subscription
from yarclang.repl.interpreter import Interpreter
from yarclang.repl.toolbar import Toolbar
from yarclang.repl.whole import is_whole

if TYPE_CHECKING:
    from prompt_toolkit import PromptSession
    from prompt_toolkit.input import Input
    from prompt_toolkit.key_binding import KeyBindings
    from prompt_toolkit.output import Output

_REDRAWN_EACH = 0.1
"""Time between two updates of the prompt and the bottom line [s]."""

_LOOKED_EACH = 0.01
"""Time between two checks of whether the next line of standard input may run [s]."""

_NAMES = {
    "c-m": "enter",
    "c-j": "enter",
    "escape": "escape",
    "c-d": "c-d",
    "up": "up",
    "down": "down",
    "left": "left",
    "right": "right",
}
"""Keys that a jog uses besides characters: the jog's name of each, by prompt_toolkit's name."""

_ENDING = (signal.SIGTERM, signal.SIGHUP)


def history_file() -> Path:
    """Return the file of previously typed lines (XDG base directories)."""
    home = os.environ.get("XDG_STATE_HOME") or str(Path.home() / ".local" / "state")
    return Path(home) / "yarc" / "history"


async def converse(interpreter: Interpreter, *, terminal: bool) -> None:
    """Read texts and carry them out: from the terminal until the user leaves, or from standard input up to
    its end.

    Args:
        interpreter: the session, which carries out the typed texts.
        terminal: True if there is a terminal.
    """
    toolbar = Toolbar(interpreter.robot, interpreter.picture)
    loop = asyncio.get_running_loop()
    for number in _ENDING:
        loop.add_signal_handler(number, interpreter.leave)
    served = asyncio.create_task(interpreter.serve(), name="interpreter")
    try:
        with await interpreter.attached.listen() as events:
            heard = asyncio.create_task(_hear(events, interpreter), name="events")
            try:
                await (_prompted(interpreter, toolbar, served) if terminal else _read(interpreter, served))
            finally:
                heard.cancel()
    finally:
        for number in _ENDING:
            loop.remove_signal_handler(number)
        interpreter.leave()
        await served


async def _hear(events: Subscription, interpreter: Interpreter) -> None:
    async for event in events:
        interpreter.hear(event)
    if not interpreter.ended:
        interpreter.refuse("the session that owned the robot has ended: check the robot")
        interpreter.leave()


async def _prompted(interpreter: Interpreter, toolbar: Toolbar, served: asyncio.Task[None]) -> None:
    from prompt_toolkit.patch_stdout import patch_stdout

    session = prompt_session(interpreter, toolbar)
    interpreter.has_keys = True
    with patch_stdout(raw=True):
        while not interpreter.ended:
            typed = asyncio.create_task(session.prompt_async())
            await asyncio.wait((typed, served), return_when=asyncio.FIRST_COMPLETED)
            if not typed.done():
                session.app.exit(exception=EOFError)
            try:
                interpreter.typed(await typed)
            except EOFError:
                interpreter.leave()


def prompt_session(
    interpreter: Interpreter, toolbar: Toolbar, source: Input | None = None, output: Output | None = None
) -> PromptSession[str]:
    """Return the prompt for the given input and output, which are by default those of the terminal."""
    from prompt_toolkit import PromptSession
    from prompt_toolkit.history import FileHistory, InMemoryHistory

    from yarclang.repl.completion import Completion

    path = history_file()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        history: FileHistory | InMemoryHistory = FileHistory(str(path))
    except OSError:  # without a writable home folder, the history is only kept in memory
        history = InMemoryHistory()
    session: PromptSession[str] = PromptSession(
        message=lambda: interpreter.prompt,
        history=history,
        completer=Completion(interpreter),
        complete_while_typing=False,
        multiline=True,
        prompt_continuation=lambda width, *_: "... ".rjust(width),
        bottom_toolbar=lambda: toolbar.text(_columns(session)),
        refresh_interval=_REDRAWN_EACH,
        key_bindings=_keys(interpreter),
        input=source,
        output=output,
    )
    return session


def _columns(session: PromptSession[str]) -> int:
    return session.app.output.get_size().columns


def _keys(interpreter: Interpreter) -> KeyBindings:
    from prompt_toolkit.filters import Condition
    from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent
    from prompt_toolkit.keys import Keys

    keys = KeyBindings()
    jogs = Condition(lambda: interpreter.jogging is not None)

    def jogged(event: KeyPressEvent) -> None:
        key = event.key_sequence[0].key
        name = key.value if isinstance(key, Keys) else key
        if interpreter.jogging is not None:
            interpreter.jogging.press(_NAMES.get(name, name), asyncio.get_running_loop().time())

    for key in (Keys.Any, *_NAMES):
        keys.add(key, filter=jogs, eager=True)(jogged)

    @keys.add("enter", filter=~jogs)
    def _(event: KeyPressEvent) -> None:
        buffer = event.current_buffer
        menu = buffer.complete_state
        if menu is not None and menu.current_completion is not None and len(menu.completions) > 1:
            buffer.complete_state = None  # Enter accepts the chosen completion
        elif is_whole(buffer.text):
            buffer.validate_and_handle()
        else:
            buffer.insert_text("\n")

    @keys.add("c-c")
    def _(event: KeyPressEvent) -> None:
        event.current_buffer.reset()
        interpreter.interrupt()

    @keys.add("c-z")
    def _(event: KeyPressEvent) -> None:  # noqa: ARG001
        interpreter.order(orders.Hold())
        interpreter.say("this process can't sleep while it looks after a robot; Ctrl-D ends it")

    return keys


async def _read(interpreter: Interpreter, served: asyncio.Task[None]) -> None:
    """Read lines from standard input. Each line waits until the previous line has finished."""
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGINT, _interrupted(interpreter))
    try:
        text = ""
        while not interpreter.ended and (line := await asyncio.to_thread(sys.stdin.readline)):
            text += line
            if not is_whole(text):
                continue
            await _until_wanted(interpreter, served)
            interpreter.typed(text.rstrip("\n"))
            text = ""
        if text:
            interpreter.typed(text.rstrip("\n"))
        while not (interpreter.idle or interpreter.ended):
            interpreter.answer_nothing()
            await asyncio.sleep(_LOOKED_EACH)
    finally:
        loop.remove_signal_handler(signal.SIGINT)


async def _until_wanted(interpreter: Interpreter, served: asyncio.Task[None]) -> None:
    while not (interpreter.idle or interpreter.asked or interpreter.ended or served.done()):
        await asyncio.sleep(_LOOKED_EACH)


def _interrupted(interpreter: Interpreter) -> Callable[[], None]:
    def interrupted() -> None:
        if interpreter.picture.under_way:
            interpreter.interrupt()
        else:
            interpreter.leave()

    return interrupted
