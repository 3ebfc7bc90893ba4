"""Send orders to a run from another terminal, and wait until they are fulfilled."""

from __future__ import annotations

import time
from typing import Any

from yarclang.client import REPLY_TIME, Gone, Refused, Robot
from yarclang.runtime.transports.private import ControlError
from yarclang.runtime.transports.runs import Run

_POLL = 0.05
_NEEDED = frozenset(
    [
        "program",
        "robot",
        "controller",
        "state",
        "why",
        "command",
        "done",
        "left",
        "override",
        "joints",
        "waiting",
        "pid",
        "since",
    ]
)
"""Keys that the status of a run must have."""

_ENDED = ("stop", "fault")
"""States without motion."""

Status = dict[str, Any]


class GoneError(ControlError):
    """Raised if a run has ended, although its socket still exists."""


def send(run: Run, order: str, timeout: float = REPLY_TIME, **fields: Any) -> Status:
    """Send an order to a run, and return the answer.

    Raises:
        GoneError: the run has ended.
        ControlError: the run doesn't answer within `timeout` [s], or refuses the order.
    """
    try:
        with Robot(str(run.path), name=None, timeout=timeout) as robot:
            return robot.ask(order, **fields)
    except TimeoutError:
        raise ControlError(
            f"{run.name} doesn't answer within {timeout:g} s",
            "its guard PLC holds when the buffer runs low; use `yarc stop --to ...` to stop the "
            "controller itself",
        ) from None
    except Gone:
        raise GoneError(f"{run.name} has ended") from None
    except Refused as refused:
        raise ControlError(f"{run.name}: {refused.error}", refused.help) from None


def status_of(run: Run) -> Status:
    """Return the status of a run.

    Raises:
        GoneError, ControlError: as `send`.
    """
    status = send(run, "status")
    if not status.keys() >= _NEEDED:
        raise ControlError(f"{run.name} doesn't report its state: is it another version of yarc?")
    return status


def order(run: Run, word: str, patience: float, **fields: Any) -> Status | None:
    """Send an order to a run, and wait until it is fulfilled.

    Returns:
        The final status of the run; None if it has ended after the order.

    Raises:
        GoneError: the run had ended before.
        ControlError: the run doesn't answer, refuses the order, or hasn't fulfilled it after `patience` [s].
    """
    why = status_of(run)["why"] if word == "resume" else ""
    send(run, word, **fields)
    until = time.monotonic() + patience
    while True:
        try:
            status = status_of(run)
        except GoneError:
            return None
        if fulfilled(word, status, **fields):
            return status
        if word == "resume" and status["why"] != why:  # the hold is over, and the program waits for an input
            return status
        if time.monotonic() > until:
            raise ControlError(
                f"{run.name} has accepted the order, but after {patience:g} s its state is still "
                f"{status['state']}",
                "see `yarc status`",
            )
        time.sleep(_POLL)


def fulfilled(word: str, status: Status, percent: float = 100.0, **_: Any) -> bool:
    """Return True if an order is fulfilled, or can no longer be fulfilled because nothing moves."""
    state = status["state"]
    if word == "hold" and state in _ENDED:
        return True  # don't wait: a run that hasn't begun handles the order only when it begins
    if status["waiting"]:
        return False
    match word:
        case "hold":
            return bool(state == "hold")
        case "resume" | "step":
            return bool(state != "hold")
        case "stop" | "abort":
            return state in _ENDED
        case "override":
            return abs(status["override"] - percent) < 1e-3 or state in _ENDED
        case _:
            return True
