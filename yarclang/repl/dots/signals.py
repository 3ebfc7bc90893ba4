"""Outputs."""

from __future__ import annotations

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
    told = await interpreter.client.set(name, value)
    interpreter.show(told.diagnostics)
    if told.value is not None:
        interpreter.say(f"{name} is {told.value:g}")


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
