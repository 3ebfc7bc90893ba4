"""Write two kinds of comment lines of a controller text: pairs of bodies that may touch, and rules that a
motion obeys. Each name is written as one word of ASCII, whatever it contains.
"""

from __future__ import annotations

from urllib.parse import quote, unquote

from yarclang.decisions import KeptTo, Permitted


def allow_line(one: Permitted) -> str:
    """Return the comment line that allows two bodies to touch in a step of the program."""
    return f"; allow {one.step} {quoted(one.first)} {quoted(one.second)}"


def keep_line(one: KeptTo) -> str:
    """Return the comment line for a rule that the motion of a step obeys."""
    return f"; keep {one.step} {quoted(one.rule)}"


def quoted(name: str) -> str:
    """Return a name as one word; blanks and letters outside of ASCII are escaped as in a URL."""
    return quote(name, safe="")


def unquoted(word: str) -> str | None:
    """Return the name of a quoted word; None if `quoted` never returns this word."""
    name = unquote(word, errors="replace")
    return name if quoted(name) == word else None
