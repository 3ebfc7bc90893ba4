"""Own and release the robot, and continue after a fault."""

from __future__ import annotations

from yarclang.coordinator.messages import orders
from yarclang.repl.dot import DotCommand
from yarclang.repl.session import Session


async def _own(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    await session.own()
    session.say("the robot is yours")


async def _release(session: Session, rest: str) -> None:  # noqa: ARG001
    released = await session.attached.ask(orders.Release())
    session.picture.owner = ""
    if released.log is not None and released.log.problem:
        session.refuse(f"{released.log.problem}\n  help: {released.log.help}")
    session.say("the robot is released; the next motion takes it again")


async def _clear(session: Session, rest: str) -> None:  # noqa: ARG001
    await session.attached.ask(orders.Clear())
    session.say("the controller reports no fault")


COMMANDS = (
    DotCommand(".own", "", "move the robot from now on; others watch", "session", _own),
    DotCommand(".release", "", "let others move the robot", "session", _release),
    DotCommand(
        ".clear", "", "inspect the controller after a fault, and go on if no fault is left", "session", _clear
    ),
)
