"""Find growing selections around a place, from a word to the whole file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from yarclang.assist.sketch import Sketch
from yarclang.source import Span
from yarclang.syntax.ast import Block, Node
from yarclang.syntax.lines import code_of

_TOKEN = re.compile(r'"[^"]*"?|\$?[A-Za-z_][A-Za-z0-9_.]*|[-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?%?')
_GROUP = re.compile(r"\[[^\]]*\]|\{[^}]*\}|\([^()]*\)|[^;\[\]{}()]+")


def around(sketch: Sketch, line: int, column: int) -> tuple[Span, ...]:
    """Return the ranges to which an editor expands the selection at a place (line and column from 1), the
    smallest first.

    They are word, group, waypoint, statement, blocks, and the whole text.
    """
    source = sketch.source
    last = max(len(source.lines), 1)
    found = [*_in_line(source.line(line), line, column)]
    statement = sketch.statement_at(line)
    if statement is not None:
        found.append(statement.whole_span)
    found += reversed(list(_blocks(sketch.nodes, sketch, line)))
    found.append(Span(1, 1, last, len(source.line(last)) + 1))
    spans: list[Span] = []
    for span in found:
        # Keep only ranges that contain the previous one.
        if not spans or (
            _begin(span) <= _begin(spans[-1]) and _end(span) >= _end(spans[-1]) and span != spans[-1]
        ):
            spans.append(span)
    return tuple(spans)


def _in_line(text: str, line: int, column: int) -> Iterator[Span]:
    bare = code_of(text).rstrip()
    at = column - 1
    if at > len(bare):  # in a comment
        yield Span.on_line(
            line, len(bare) + 1 + len(text[len(bare) :]) - len(text[len(bare) :].lstrip()), len(text) + 1
        )
        return
    for match in _TOKEN.finditer(bare):
        if match.start() <= at <= match.end():
            yield Span.on_line(line, match.start() + 1, match.end() + 1)
            break
    for match in _GROUP.finditer(bare):
        if match.start() <= at < match.end():
            words = match[0].strip()
            begin = match.start() + match[0].index(words) if words else match.start()
            yield Span.on_line(line, begin + 1, begin + len(words) + 1)
            break


def _blocks(nodes: Iterable[Node], sketch: Sketch, line: int) -> Iterator[Span]:
    """Yield the blocks that contain a line, the outermost first."""
    for node in nodes:
        if not isinstance(node, Block):
            continue
        last = sketch.ends.get(node.head.line, node.head.line)
        if node.head.line <= line <= last:
            yield Span(node.head.line, 1, last, len(sketch.source.line(last)) + 1)
            yield from _blocks((*node.body, *(node.otherwise or ())), sketch, line)


def _begin(span: Span) -> tuple[int, int]:
    return span.line, span.column


def _end(span: Span) -> tuple[int, int]:
    return span.end_line, span.end_column
