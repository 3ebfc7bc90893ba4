"""Whether to ask before something moves, and going away."""

from __future__ import annotations

from yarclang.repl.dot import DotCommand
from yarclang.repl.interpreter import Interpreter


def _ask(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001 - it takes nothing
    interpreter.asks = True
    interpreter.say("every motion is asked for")


def _go(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    interpreter.asks = False
    interpreter.say("motions begin at once, for this session; .ask asks again")


def _quit(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    interpreter.leave()


COMMANDS = (
    DotCommand(".ask", "", "show what would happen, and ask before anything moves", "session", _ask),
    DotCommand(".go", "", "move without asking, until the session ends", "session", _go),
    DotCommand(".quit", "", "bring the robot to rest and end (Ctrl-D)", "session", _quit, overtakes=True),
)
