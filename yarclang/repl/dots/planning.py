"""Plan without moving, go back, and plot."""

from __future__ import annotations

from pathlib import Path

from yarclang.files import reason_of
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.report.pictures.plot import Format

_PICTURE = "yarc-plot.png"
_FORMATS: tuple[Format, ...] = ("png", "svg", "pdf")


async def _plan(session: Session, rest: str) -> None:
    if not rest:
        raise Misused("a command is missing")
    offer = await session.offered(rest)
    if offer is not None and not offer.moves:
        session.say("this is a declaration: nothing moves")


async def _back(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    await session.carry_out_back()


def _plot(session: Session, rest: str) -> None:
    from yarclang.report.pictures.plot import draw

    if not session.has_planned:
        session.refuse("nothing has been planned yet")
        return
    plan = session.plan
    if plan is None:
        session.refuse("the last plan is known only to the process that serves the robot")
        return
    path = session.folder / (rest or _PICTURE)
    kind = next((one for one in _FORMATS if path.suffix.lower() == f".{one}"), None)
    if kind is None:
        raise Misused(f"{path.name} must end with .png, .svg or .pdf")
    _write(session, path, draw(plan, kind))


def _write(session: Session, path: Path, content: bytes) -> None:
    try:
        path.write_bytes(content)
    except OSError as error:
        session.refuse(f"{path} can't be written: {reason_of(error)}")
        return
    session.say(f"{path} shows the last plan")


COMMANDS = (
    DotCommand(".plan", "COMMAND", "show what a command would do; nothing moves", "motions", _plan),
    DotCommand(".back", "", "the last motion backwards, on the same path", "motions", _back),
    DotCommand(".plot", "[FILE]", f"draw the last plan ({_PICTURE})", "looking", _plot),
)
