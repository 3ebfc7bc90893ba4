"""Who may move the robot, and going on behind a fault."""

from __future__ import annotations

from yarclang.repl.dot import DotCommand
from yarclang.repl.interpreter import Interpreter


def _own(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001 - it takes nothing
    interpreter.client.own()
    interpreter.say("the robot is yours")


def _release(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    interpreter.client.release()
    interpreter.say("nobody owns the robot; the next motion takes it again")


async def _clear(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    await interpreter.client.clear()
    interpreter.say("the controller is well")


COMMANDS = (
    DotCommand(".own", "", "move the robot from now on; others watch", "session", _own),
    DotCommand(".release", "", "let others move the robot", "session", _release),
    DotCommand(
        ".clear", "", "look at the controller behind a fault, and go on if all is well", "session", _clear
    ),
)
