"""Recognise indices that aren't written as `P0010 `."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line
from yarclang.semantics.names.commands import is_command

_MISTYPED = re.compile(r"\s*(?P<index>[PpNn](?P<number>[0-9OoIl]+)|(?P<alone>[0-9]{2,9}))(?=\s+[A-Za-z])")
_APART = re.compile(r"\s*(?P<index>[PpNn]\s+(?P<number>[0-9]{1,9}))(?=\s+[A-Za-z])")
_SIGNED = re.compile(
    r"\s*(?P<index>[\[(<]?[Pp][-_.# \[(]*(?P<number>[0-9]{1,9})[\])>]?[:.,;]?)\s+(?P<word>[A-Za-z_]+)"
)
_CLOSE = re.compile(r"\s*(?P<index>[Pp][0-9]+)(?P<word>[A-Za-z][A-Za-z_0-9]*)")
_COLON = re.compile(r"\s*[Pp][0-9]+(?P<sign>\s?[:.,;)]|\s?-(?=\s))(?=\s|$)")
_ALONE = re.compile(r"\s*(?P<index>[Pp][0-9]+)\s*$")
_DIGITS = str.maketrans("OoIl", "0011")


def index(line: Line) -> Guess | None:
    """Recognise an index with a letter for a digit, without P, without a blank after it, or with a colon."""
    if found := _ALONE.match(line.bare):
        name = found["index"]
        return Guess(
            found.start("index"), found.end("index"), f"after the index {name} the command is missing",
            f"write it after the index, as {name} MOVEJ HOME, or remove the index",
        )  # fmt: skip
    if found := _COLON.match(line.bare):
        sign = found["sign"].strip()
        return line.guess(
            found.start("sign"), found.end("sign"), f"`{sign}` isn't allowed in an index", "",
            f"write {line.bare[: found.start('sign')].strip()} without it",
        )  # fmt: skip
    if (found := _CLOSE.match(line.bare)) and is_command(found["word"]):
        put = f"{found['index']} {found['word']}"
        return line.guess(found.start("index"), found.end("word"), "a blank is missing after the index", put)
    if (
        (found := _SIGNED.match(line.bare))
        and is_command(found["word"])
        and found["index"][1:] != found["number"]
    ):
        put = f"P{found['number']}"
        return line.guess(
            found.start("index"),
            found.end("index"),
            f"an index is P and a number, not `{found['index']}`",
            put,
        )
    found = _APART.match(line.bare) or _MISTYPED.match(line.bare)
    if found is None:
        return None
    written = found["index"]
    number = found["number"] or found.groupdict().get("alone") or ""
    put = "P" + number.translate(_DIGITS)
    if put == written.upper():
        return None
    return line.guess(
        found.start("index"), found.end("index"), f"an index is P and a number, not `{written}`", put
    )
