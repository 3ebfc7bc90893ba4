"""Choose whether to ask before motions, and leave the interpreter."""

from __future__ import annotations

from yarclang.repl.dot import DotCommand
from yarclang.repl.session import Session


def _ask(session: Session, rest: str) -> None:  # noqa: ARG001 - it takes nothing
    session.asks = True
    session.say("every motion is asked for")


def _go(session: Session, rest: str) -> None:  # noqa: ARG001
    session.asks = False
    session.say("motions begin at once, for this session; .ask asks again")


def _quit(session: Session, rest: str) -> None:  # noqa: ARG001
    session.leave()


COMMANDS = (
    DotCommand(".ask", "", "show what would happen, and ask before anything moves", "session", _ask),
    DotCommand(".go", "", "move without asking, until the session ends", "session", _go),
    DotCommand(".quit", "", "bring the robot to rest and end (Ctrl-D)", "session", _quit, overtakes=True),
)
