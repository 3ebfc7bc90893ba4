"""Choose whether to ask before motions, and leave the interpreter."""

from __future__ import annotations

from yarclang.repl.dot import DotCommand
from yarclang.repl.session import Session


def _ask(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    session.asks = True
    session.say("you are asked before every motion")


def _go(session: Session, rest: str) -> None:  # noqa: ARG001
    session.asks = False
    session.say("motions begin at once, for this session; .ask asks again")


def _quit(session: Session, rest: str) -> None:  # noqa: ARG001
    session.leave()


COMMANDS = (
    DotCommand(".ask", "", "show each motion, and ask before the robot moves", "session", _ask),
    DotCommand(".go", "", "move without asking, until the session ends", "session", _go),
    DotCommand(".quit", "", "bring the robot to rest and end (Ctrl-D)", "session", _quit, overtakes=True),
)
