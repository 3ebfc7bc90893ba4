"""Who may move the robot, and going on behind a fault."""

from __future__ import annotations

from yarclang.coordinator.messages import orders
from yarclang.repl.dot import DotCommand
from yarclang.repl.interpreter import Interpreter


async def _own(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001 - it takes nothing
    await interpreter.own()
    interpreter.say("the robot is yours")


async def _release(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    released = await interpreter.attached.ask(orders.Release())
    interpreter.picture.owner = ""
    if released.log is not None and released.log.problem:
        interpreter.refuse(f"{released.log.problem}\n  help: {released.log.help}")
    interpreter.say("nobody owns the robot; the next motion takes it again")


async def _clear(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    await interpreter.attached.ask(orders.Clear())
    interpreter.say("the controller is well")


COMMANDS = (
    DotCommand(".own", "", "move the robot from now on; others watch", "session", _own),
    DotCommand(".release", "", "let others move the robot", "session", _release),
    DotCommand(
        ".clear", "", "look at the controller behind a fault, and go on if all is well", "session", _clear
    ),
)
