"""Orders about running motions. They are carried out before all other typed texts."""

from __future__ import annotations

from yarclang.coordinator.messages import orders
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session


def _hold(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    session.order(orders.Hold())


def _resume(session: Session, rest: str) -> None:
    try:
        value = int(rest) if rest else None
    except ValueError:
        raise Misused(f"{rest!r} isn't an integer: .resume 3 answers a HOLD's question") from None
    session.order(orders.Resume(value=value))


def _stop(session: Session, rest: str) -> None:  # noqa: ARG001
    session.drop()
    session.order(orders.Stop())


def _abort(session: Session, rest: str) -> None:  # noqa: ARG001
    session.drop()
    session.order(orders.Abort())


def _override(session: Session, rest: str) -> None:
    if not rest:
        session.say(f"override {session.picture.override:g} %")
        return
    try:
        percent = float(rest.removesuffix("%"))
    except ValueError:
        raise Misused(f"{rest!r} isn't a percentage") from None
    if not 1.0 <= percent <= 100.0:
        raise Misused(f"{percent:g} % isn't allowed: the override is from 1 to 100 %")
    session.order(orders.Override(percent=percent))


COMMANDS = (
    DotCommand(".hold", "", "stop on the path, ready to go on", "orders", _hold, overtakes=True),
    DotCommand(
        ".resume",
        "[N]",
        "go on after a hold, or to the next step (Enter); N answers a HOLD's question",
        "orders",
        _resume,
        overtakes=True,
    ),
    DotCommand(
        ".stop", "", "stop on the path, and end the present command (Ctrl-C)", "orders", _stop, overtakes=True
    ),
    DotCommand(
        ".abort",
        "",
        "stop each motor at once, off the path (Ctrl-C again)",
        "orders",
        _abort,
        overtakes=True,
    ),
    DotCommand(
        ".override",
        "[PERCENT]",
        "the override, in percent of the programmed speed",
        "orders",
        _override,
        overtakes=True,
    ),
)
