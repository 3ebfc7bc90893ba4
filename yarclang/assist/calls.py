"""Calls of SUBs across the files of a folder: the callers of a SUB, and the SUBs that a caller calls."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from yarclang.assist.navigation import Place, Target, target_at, target_of
from yarclang.assist.sketch import Sketch
from yarclang.assist.symbols import Symbol
from yarclang.assist.view import View
from yarclang.source import SourceFile, Span


@dataclass(frozen=True, slots=True)
class Caller:
    """A SUB, or the lines of a file outside of all SUBs.

    Attributes:
        source: the file.
        name: name of the SUB, or name of the file for the lines outside.
        span: the whole SUB, or the whole file.
        name_span: the place of the name; the beginning of the file for the lines outside.
        symbol: the SUB's declaration; None outside.
    """

    source: SourceFile
    name: str
    span: Span
    name_span: Span
    symbol: Symbol | None = None


@dataclass(frozen=True, slots=True)
class Calls:
    """A caller or a called SUB, with the places of its calls.

    Attributes:
        caller: the caller, if `incoming` yields this; the called SUB, if `outgoing` yields it.
        places: the calls.
    """

    caller: Caller
    places: tuple[Place, ...]


def callable_at(view: View, line: int, column: int) -> Caller | None:
    """Return the SUB whose name is at a place (from 1), in its declaration or in a CALL."""
    target = target_at(view, line, column)
    return _of(target) if target is not None and target.symbol.kind == "sub" else None


def outside(view: View) -> Caller:
    """Return the lines of a file that are outside of all SUBs."""
    return _caller(view.sketch, 0)


def incoming(called: Caller, views: Iterable[View]) -> Iterator[Calls]:
    """Yield the SUBs and files that call a SUB, each with its calls.

    Args:
        called: the SUB.
        views: the files that may call the SUB, including the SUB's own.
    """
    for view in views:
        found: dict[str, list[Place]] = {}
        for use in view.sketch.names.uses:
            target = target_of(view, use)
            if target is not None and _is(target, called):
                inside = _inside(view.sketch, use.span.line)
                found.setdefault(inside.name if inside else "", []).append(
                    Place(view.sketch.source, use.span)
                )
        for places in found.values():
            yield Calls(_caller(view.sketch, places[0].span.line), tuple(places))


def outgoing(caller: Caller, view: View) -> Iterator[Calls]:
    """Yield the SUBs that are called by a caller, each with its calls.

    Args:
        caller: a SUB, or the lines of a file outside of all SUBs.
        view: the file.
    """
    callers: dict[tuple[str, Span], tuple[Caller, list[Place]]] = {}
    own = caller.symbol.name if caller.symbol else ""
    for use in view.sketch.names.uses:
        inside = _inside(view.sketch, use.span.line)
        if (inside.name if inside else "") != own:
            continue
        target = target_of(view, use)
        if target is None or target.symbol.kind != "sub":
            continue
        called = _of(target)
        places = callers.setdefault((called.source.name, called.name_span), (called, []))[1]
        places.append(Place(view.sketch.source, use.span))
    for called, places in callers.values():
        yield Calls(called, tuple(places))


def _is(target: Target, called: Caller) -> bool:
    same_file = target.sketch.source.name == called.source.name
    return target.symbol.kind == "sub" and same_file and target.symbol.span == called.name_span


def _of(target: Target) -> Caller:
    symbol, source = target.symbol, target.sketch.source
    return Caller(source, symbol.name, _whole(target.sketch, symbol), symbol.span, symbol)


def _caller(sketch: Sketch, line: int) -> Caller:
    symbol = _inside(sketch, line)
    if symbol is not None:
        return Caller(sketch.source, symbol.name, _whole(sketch, symbol), symbol.span, symbol)
    source, last = sketch.source, max(len(sketch.source.lines), 1)
    whole = Span(1, 1, last, len(source.line(last)) + 1)
    return Caller(source, source.name.replace("\\", "/").rpartition("/")[2], whole, Span.on_line(1, 1, 1))


def _inside(sketch: Sketch, line: int) -> Symbol | None:
    """Return the SUB that contains a line."""
    subs = (one for one in sketch.names.symbols if one.kind == "sub")
    return next((one for one in subs if one.statement.line < line <= _last(sketch, one)), None)


def _whole(sketch: Sketch, symbol: Symbol) -> Span:
    last = _last(sketch, symbol)
    return Span(symbol.statement.line, 1, last, len(sketch.source.line(last)) + 1)


def _last(sketch: Sketch, symbol: Symbol) -> int:
    """Return the line of a SUB's END."""
    return sketch.ends.get(symbol.statement.line, symbol.statement.line)
