"""Lines of a controller text's map about bodies that may touch, and rules that motions keep to. Names are one
word of ASCII each, whatever they contain.
"""

from __future__ import annotations

from urllib.parse import quote, unquote

from yarclang.decisions import KeptTo, Permitted


def allow_line(one: Permitted) -> str:
    """Return the line of the map for two bodies that may touch."""
    return f"; allow {one.step} {quoted(one.first)} {quoted(one.second)}"


def keep_line(one: KeptTo) -> str:
    """Return the line of the map for a rule that a motion keeps to."""
    return f"; keep {one.step} {quoted(one.rule)}"


def quoted(name: str) -> str:
    """Return a name as one word; blanks and letters outside of ASCII are escaped as in a URL."""
    return quote(name, safe="")


def unquoted(word: str) -> str | None:
    """Return the name that a word stands for; None if `quoted` makes no such word."""
    name = unquote(word, errors="replace")
    return name if quoted(name) == word else None
