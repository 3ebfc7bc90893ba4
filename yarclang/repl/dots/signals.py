"""Outputs."""

from __future__ import annotations

import math
from typing import Literal

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.coordinator.messages.message import LARGEST
from yarclang.hir import Output
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.interpreter import Interpreter


async def _set(interpreter: Interpreter, rest: str) -> None:
    words = rest.split()
    if len(words) != 2:
        raise Misused("an output and a value are needed")
    name, value = words[0].upper(), words[1].upper()
    if interpreter.asks and not await interpreter.agrees(f"set {name} to {value}?"):
        interpreter.say("nothing was set")
        return
    told = await interpreter.attached.ask(orders.SetOutput(name=name, value=_value(value)))
    interpreter.show(findings_of(told.findings))
    if told.value is not None:
        interpreter.say(f"{name} is {told.value:g}")


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
        "OUTPUT ON|OFF|VALUE",
        "set an output that is declared",
        "teaching",
        _set,
        complete=lambda interpreter, begun: (
            one for one in sorted(set(interpreter.scope().names(Output))) if one.startswith(begun.upper())
        ),
    ),
)
