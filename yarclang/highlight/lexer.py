"""The Pygments lexer of the language, which mkdocs and rich find as `yarc`.

It reads each line by itself: a name's kind doesn't depend on its declaration. The grammar in editors/vscode
distinguishes the same kinds; tests compare the two.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

from pygments.lexer import Lexer
from pygments.token import (
    Comment,
    Error,
    Keyword,
    Name,
    Number,
    Operator,
    Punctuation,
    String,
    Text,
    Whitespace,
)

from yarclang.highlight.words import words
from yarclang.source import lines_with_ends

_PIECE = re.compile(
    r"""
      (?P<blank>[ \t]+)
    | (?P<comment>!.*)
    | (?P<string>"[^"]*"?)
    | (?P<frame>\{[^{}!"]*\})
    | (?P<variable>\$[A-Za-z_][A-Za-z0-9_.]*)
    | (?P<number>(?:[0-9]+(?:\.(?!\.)[0-9]*)?|(?<!\.)\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_]))
    | (?P<word>[A-Za-z_](?:[A-Za-z0-9_]|\.(?!\.))*)
    | (?P<operator>\.\.|<>|<=|>=|\*\*|[-+*/%=<>])
    | (?P<mark>\$?\(|[)\[\];,])
    | (?P<wrong>.)
    """,
    re.VERBOSE,
)
_KINDS: dict[str, Any] = {
    "blank": Whitespace,
    "comment": Comment.Single,
    "string": String.Double,
    "frame": Name.Namespace,
    "variable": Name.Variable,
    "number": Number,
    "operator": Operator,
    "mark": Punctuation,
    "wrong": Error,
}


class YarcLexer(Lexer):  # type: ignore[misc]  # Pygments has no types
    """YARC programs: indices, commands with their suffixes, frames, units, options, expressions."""

    name = "YARC"
    aliases = ("yarc",)
    filenames = ("*.yarc",)
    mimetypes = ("text/x-yarc",)
    url = "https://pypi.org/project/yarclang"

    def get_tokens_unprocessed(self, text: str) -> Iterator[tuple[int, Any, str]]:
        """Yield the pieces of a text as (place, kind, piece). Together they are the whole text."""
        at = 0
        for line in lines_with_ends(text):
            code = line.rstrip("\r\n")
            yield from ((at + start, kind, piece) for start, kind, piece in _of_line(code))
            if len(code) < len(line):
                yield at + len(code), Whitespace, line[len(code) :]
            at += len(line)


def _of_line(line: str) -> Iterator[tuple[int, Any, str]]:
    units = [match.span() for match in _units().finditer(line)]
    behind_index = False
    is_first = True
    for match in _PIECE.finditer(line):
        group, piece, start = str(match.lastgroup), match[0], match.start()
        if group != "word":
            yield start, _KINDS[group], piece
            is_first = is_first and group in {"blank", "comment"}
            continue
        upper = piece.upper()
        if is_first and re.fullmatch(r"P[0-9]+", upper):
            yield start, Name.Label, piece
            behind_index = True
        elif any(begin < start < end for begin, end in units):
            yield start, Keyword.Type, piece
        elif is_first and not behind_index and (kind := _heads().get(upper)):
            yield start, kind, piece
        elif command := _commands().fullmatch(upper):
            head = len(command[1])
            yield start, Name.Function, piece[:head]
            if command[2]:
                yield start + head, Name.Decorator, piece[head:]
        else:
            yield start, _kind(upper, line[match.end() :]), piece
        is_first = is_first and behind_index and upper.startswith("P")


@cache
def _heads() -> dict[str, Any]:
    """Return the words that begin a line without an index."""
    known = words()
    return dict.fromkeys(known.blocks, Keyword) | dict.fromkeys(known.declarations, Keyword.Declaration)


@cache
def _commands() -> re.Pattern[str]:
    """Return a pattern of commands with their suffixes."""
    known = words()
    return re.compile(rf"({'|'.join(known.commands)})((?:_(?:{'|'.join(known.suffixes)}))*)")


@cache
def _units() -> re.Pattern[str]:
    """Return a pattern of round brackets that contain only units."""
    one = rf"\s*(?:{'|'.join(words().units)})\s*"
    return re.compile(rf"(?<!\$)\({one}(?:,{one})*\)", re.IGNORECASE)


def _kind(upper: str, rest: str) -> Any:
    """Return the kind of a word that doesn't begin a line."""
    known = words()
    if upper in known.functions and rest.lstrip().startswith("("):
        return Name.Builtin
    if upper in known.options:
        return Keyword.Pseudo
    if upper in known.operators:
        return Operator.Word
    if upper in known.constants or upper in {"MIN", "V"}:
        return Keyword.Constant
    return Name if upper else Text
