"""Collect the names that a file declares and the names that it uses. Frames have a namespace of their own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from yarclang.frozen import frozen
from yarclang.progress import each
from yarclang.source import Span
from yarclang.syntax.ast import (
    Computed,
    ComputedPercent,
    FrameName,
    Module,
    NamedValue,
    Number,
    Parameter,
    Statement,
    Word,
)
from yarclang.syntax.expressions import Expression, Name, parts_of
from yarclang.syntax.words import BLOCK_ENDS, DECLARATIONS, opens_block
from yarclang.words.registry import word_specs


@frozen
class Declared:
    """A declaration in a file.

    Attributes:
        word: first word of the declaration, such as LET; FRAME for FRAME_QUAT as well.
        name: the declared name in upper case.
        statement: the line.
        span: place of the name.
    """

    word: str
    name: str
    statement: Statement
    span: Span


@dataclass(slots=True)
class Names:
    """The declared and the used names of a file.

    Attributes:
        declared: declarations, in order.
        words: used names of everything but frames, in upper case.
        frames: used names of frames, in upper case.
        is_program: True if there is a command outside of SUBs. Otherwise the file is a module, and other
            files may use its names.
    """

    declared: list[Declared] = field(default_factory=list)
    words: set[str] = field(default_factory=set)
    frames: set[str] = field(default_factory=set)
    is_program: bool = False

    def unused(self, *words: str) -> Iterator[Declared]:
        """Yield the declarations that begin with one of some words (such as LET), and whose names the file
        doesn't use. Yield none for a module, since other files may use its names.
        """
        if not self.is_program:
            return
        for one in each(self.declared):
            spoken_of = self.frames if one.word == "FRAME" else self.words
            if one.word in words and one.name not in spoken_of:
                yield one


def names_of(module: Module) -> Names:
    """Collect the names of a file. If a line is unreadable, it may use any name, so that no name counts as
    unused.
    """
    names = Names()
    depth, sub_depth = 0, 0
    for statement in each(module.statements):
        word = statement.name.name
        if opens_block(statement):
            depth += 1
            sub_depth = sub_depth or (depth if word == "SUB" else 0)
        elif word in BLOCK_ENDS:
            sub_depth = 0 if sub_depth == depth else sub_depth
            depth -= 1
        if word not in DECLARATIONS and not sub_depth:
            names.is_program = True
        _read(statement, word, names)
    if module.unreadable_lines:
        names.is_program = False
    return names


def _read(statement: Statement, word: str, found: Names) -> None:
    own: object = None
    declares = word_specs()[word].declares if word in word_specs() else ""
    if declares == "frame" and statement.moving is not None:
        own = statement.moving
        found.declared.append(Declared("FRAME", statement.moving.name, statement, statement.span(own.place)))
    elif (
        declares == "name"
        and statement.waypoints
        and isinstance(first := statement.waypoints[0].values[0], Word)
    ):
        own = first
        found.declared.append(Declared(word, first.name, statement, statement.span(first.place)))
    for frame in (statement.moving, statement.base):
        if frame is not None and frame is not own:
            _speak_of(frame, found)
    if statement.expression is not None:
        _expression(statement.expression, found)
    for waypoint in statement.waypoints:
        for value in waypoint.items:
            if type(value) is not Number and value is not own:  # most values are numbers: skip these quickly
                _speak_of(value, found)
    if statement.time is not None:
        for item in statement.time.items:
            if type(item) is not Number:
                _speak_of(item, found)
    for option in statement.options:
        _speak_of(option.argument, found)


def _speak_of(value: object, found: Names) -> None:
    match value:
        case NamedValue(value=given):
            _speak_of(given, found)
        case Parameter(default=given) if given is not None:
            _speak_of(given, found)
        case Word(name=name):
            found.words |= {name, name.partition(".")[0]}
        case FrameName(name=name):
            module, dot, _ = name.partition(".")
            found.frames.add(name)
            if dot:
                found.words.add(module)
        case Computed(expression=expression) | ComputedPercent(expression=expression):
            _expression(expression, found)


def _expression(expression: Expression, found: Names) -> None:
    if isinstance(expression, Name):
        found.words |= {expression.name, expression.name.partition(".")[0]}
    for part in parts_of(expression):
        _expression(part, found)
