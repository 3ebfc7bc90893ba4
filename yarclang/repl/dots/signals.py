"""Set outputs, and inputs of a simulated robot."""

from __future__ import annotations

import math
import re
from typing import Literal

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.coordinator.messages.message import LARGEST
from yarclang.hir import Output
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.semantics.names.scope import Input

_VARIABLE = re.compile(r"[MPQ][0-9]{1,4}")


async def _set(session: Session, rest: str) -> None:
    words = rest.split()
    if len(words) != 2:
        raise Misused("an output, or an input of a simulated robot, and a value are needed")
    name, value = words[0].upper(), words[1].upper()
    scope = session.scope()
    is_output = name in scope.names(Output)
    is_input = not is_output and (name in scope.names(Input) or _VARIABLE.fullmatch(name) is not None)
    if session.asks and not await session.agrees(f"set {name} to {value}?"):
        session.say("nothing was set")
        return
    order = orders.SetInput if is_input else orders.SetOutput
    told = await session.attached.ask(order(name=name, value=_value(value)))
    session.show(findings_of(told.findings))
    if told.value is not None:
        session.say(f"{name} is {told.value:g}")


def _value(word: str) -> float | Literal["ON", "OFF"]:
    if word == "ON":
        return "ON"
    if word == "OFF":
        return "OFF"
    try:
        number = float(word)
    except ValueError:
        number = math.nan
    if not abs(number) <= LARGEST:
        raise Misused(f"{word} isn't ON, OFF or a number")
    return number


COMMANDS = (
    DotCommand(
        ".set",
        "NAME ON|OFF|VALUE",
        "set an output that is declared, or an input of a simulated robot",
        "teaching",
        _set,
        complete=lambda session, begun: (
            one for one in sorted(set(session.scope().names(Output, Input))) if one.startswith(begun.upper())
        ),
    ),
)
