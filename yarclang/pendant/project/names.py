"""Rules for names of files: which names may be read, which may be created, and which look alike."""

from __future__ import annotations

import unicodedata

from yarclang.runtime.actions import Trouble

MOST_NAME = 255
"""Longest name of one file or folder [bytes in UTF-8]."""

MOST_PATH = 1000
"""Longest path from the project's folder [bytes in UTF-8]."""

_DIRECTIONS = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Characters that change the writing direction of a text, so that one name could look like another."""


def quoted(name: str) -> str:
    """Return a name as it is shown in messages: shortened, and without control characters for terminals."""
    return repr(name if len(name) <= 80 else f"{name[:77]}...")


def parts_of(name: str) -> tuple[str, ...]:
    """Split a path into the names of its folders and the name of the file.

    Raises:
        Trouble: the path isn't allowed: it is empty, absolute, hidden or too long, or contains `..`.
    """
    if not name or "\0" in name or not _is_text(name):
        raise Trouble(f"{quoted(name)} isn't the name of a file", "name a file of the project", "")
    if len(name.encode()) > MOST_PATH:
        problem = (
            f"the path {quoted(name)} has {len(name.encode())} bytes, but at most {MOST_PATH} are allowed"
        )
        raise Trouble(problem, "choose a shorter one", "")
    parts = tuple(name.split("/"))
    if any(part in ("", ".", "..") for part in parts):
        raise Trouble(
            f"{quoted(name)} isn't in the project's folder",
            "name a file of the project, as the list of files does", "",
        )  # fmt: skip
    for part in parts:
        if part.startswith("."):
            raise Trouble(f"{quoted(part)} is hidden, and the pendant doesn't use hidden files",
                "choose another name", "")  # fmt: skip
        if len(part.encode()) > MOST_NAME:
            problem = (
                f"the name {quoted(part)} has {len(part.encode())} bytes, but at most {MOST_NAME} are allowed"
            )
            raise Trouble(problem, "choose a shorter one", "")
    return parts


def check_new(parts: tuple[str, ...]) -> None:
    """Check that the names in a path are allowed for a new file or folder.

    Raises:
        Trouble: a name can't be typed or read safely, or isn't allowed on other systems.
    """
    for one in parts:
        reason = _objection(one)
        if reason:
            raise Trouble(f"the name {quoted(one)} {reason}", "choose another name", "")


def folded(name: str) -> str:
    """Return a normal form of a name. Two names have the same normal form if some operating systems or most
    people can't distinguish them.
    """
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", name).casefold())


def _objection(name: str) -> str:
    kinds = [unicodedata.category(character) for character in name]
    if any(kind in ("Cc", "Zl", "Zp") for kind in kinds):
        return "has a control character or a line break"
    if _DIRECTIONS & set(name):
        return "has a character that changes the direction of the text"
    if name != name.strip() or name.endswith("."):
        return "begins or ends with a blank, or ends with a dot"
    if kinds[0] == "Cf":
        return "begins with an invisible character"
    if "\\" in name:
        return "has a backslash"
    return ""


def _is_text(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:  # bytes that aren't UTF-8, or half a surrogate pair
        return False
    return True
