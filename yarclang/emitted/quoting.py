"""Lines of a controller text's map about bodies that may touch, and about rules that motions keep. Each name
is written as one word of ASCII, whatever it contains.
"""

from __future__ import annotations

from urllib.parse import quote, unquote

from yarclang.decisions import KeptTo, Permitted


def allow_line(one: Permitted) -> str:
    """Return the line of the map for two bodies that may touch."""
    return f"; allow {one.step} {quoted(one.first)} {quoted(one.second)}"


def keep_line(one: KeptTo) -> str:
    """Return the line of the map for a rule that a motion keeps."""
    return f"; keep {one.step} {quoted(one.rule)}"


def quoted(name: str) -> str:
    """Return a name as one word; blanks and letters outside of ASCII are escaped as in a URL."""
    return quote(name, safe="")


def unquoted(word: str) -> str | None:
    """Return the name of a quoted word; None if `quoted` never returns this word."""
    name = unquote(word, errors="replace")
    return name if quoted(name) == word else None
