"""Execution of lines of on-line commands, one command after the other (TSRM 259-424).

A line may have several commands without separators. If a buffer is open on the line's port, statements that
the buffer can hold are stored in it. The first error ends the line; the commands before the error keep their
effect.
"""

from __future__ import annotations

import re

from yarclang.pmac.errors import DATA, NEEDS_BUFFER
from yarclang.simulator.language.statements import Statement
from yarclang.simulator.language.words import cleaned, read_statement, simple_move
from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Refusal, Reply
from yarclang.simulator.online.commands import command_at
from yarclang.simulator.online.line import LEGAL, LONGEST, Line
from yarclang.simulator.online.surroundings import Controller

_ILLEGAL = 4
_CLOSING = re.compile(r"CLOSE|CLEAR|CLR|CLS")


def execute(machine: Controller, port: Port, text: str) -> Reply:
    """Execute a line, or store it in the buffer that is open on the port."""
    if len(text) > LONGEST:
        return Reply((), DATA)
    if not LEGAL(text):
        return Reply((), _ILLEGAL)
    line = Line(machine, port, cleaned(text))
    try:
        _execute(line)
    except Refusal as refusal:
        return Reply(tuple(line.items), refusal.number)
    return Reply(tuple(line.items))


def _execute(line: Line) -> None:
    reader = line.reader
    if line.port.open in ("rotary", "prog") and (move := simple_move(reader.text)):
        line.machine.buffers.store(line.port, reader.text, (move,))
        return
    while not reader.ended:
        if not (line.port.open and _stored(line)):
            _command(line)


def _stored(line: Line) -> bool:
    """Store the next statements of a line in the open buffer. Return False if a command follows, or a word
    that no buffer can store.
    """
    reader, port = line.reader, line.port
    at = reader.at
    statements: list[Statement] = []
    while not reader.ended and not (reader.text[reader.at] == "C" and _CLOSING.match(reader.text, reader.at)):
        statement = read_statement(reader, port.open == "plc")
        if statement is None:
            break
        statements.append(statement)
    if not statements:
        return False
    if not reader.ended and not command_at(reader.text, reader.at):
        raise Refusal(DATA)
    line.machine.buffers.store(port, reader.text[at : reader.at], tuple(statements))
    return True


def _command(line: Line) -> None:
    reader = line.reader
    if command := command_at(reader.text, reader.at):
        action, found = command
        reader.at = found.end()
        action(line, found)
        return
    statement = read_statement(reader, False)
    raise Refusal(DATA if statement is None or line.port.open else NEEDS_BUFFER)
