"""Names of bodies in the header of a controller text: one word of ASCII each, whatever they contain."""

from __future__ import annotations

from urllib.parse import quote, unquote

from yarclang.decisions import Permitted


def allow_line(one: Permitted) -> str:
    """Return the line of the map for two bodies that may touch."""
    return f"; allow {one.step} {quoted(one.first)} {quoted(one.second)}"


def quoted(name: str) -> str:
    """Return a name as one word; blanks and letters outside of ASCII are escaped as in a URL."""
    return quote(name, safe="")


def unquoted(word: str) -> str | None:
    """Return the name that a word stands for; None if `quoted` makes no such word."""
    name = unquote(word, errors="replace")
    return name if quoted(name) == word else None
