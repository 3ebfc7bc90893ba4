"""The characters of a program: which are allowed in code, comments and texts, and substitutes for the others.

Code consists of blanks, tabs and the printable characters of ASCII. Other characters may look like one of
these (a no-break space, a minus sign) or be invisible: people would read something else than the compiler. In
comments and texts, all characters are allowed except those that editors show in different ways: line ends
that only some editors know, characters that change the direction of writing, and control characters.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator

from yarclang.frozen import frozen
from yarclang.syntax.faults import Fault
from yarclang.syntax.leaves import Place
from yarclang.syntax.lines import code_of, opens_statement, texts_of

_PLAIN = re.compile(r"[\t\n -~]*+")
_FOREIGN = re.compile(r"[^\t\n -~]")

_BREAKS = frozenset("\v\f\u0085\u2028\u2029")
"""Characters at which some programs end a line, although the compiler doesn't."""

_UNSEEN = frozenset("\u00ad\u034f\u061c\u180e\u200b\u200c\u200d\u200e\u200f\u2060\ufeff")
"""Characters that are invisible, and don't change the text around them."""

_TURNS = frozenset("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
"""Characters that make an editor show a line in an order that differs from the order of its characters."""

_ALIKE = {
    **dict.fromkeys("\u2010\u2011\u2012\u2013\u2014\u2015\u2212\ufe63", "-"),
    **dict.fromkeys("\u201c\u201d\u201e\u201f", '"'),
    **{chr(code): chr(code - 0xFEE0) for code in range(0xFF01, 0xFF5F)},
}
"""Characters that look nearly like a character of ASCII and have the same meaning."""

_CONTROLS = {
    0x00: "null",
    0x07: "bell",
    0x08: "backspace",
    0x0B: "vertical tab",
    0x0C: "form feed",
    0x1A: "substitute",
    0x1B: "escape",
    0x1C: "file separator",
    0x1D: "group separator",
    0x1E: "record separator",
    0x1F: "unit separator",
    0x7F: "delete",
    0x85: "next line",
    0xFEFF: "byte order mark",
}
"""Names of characters for which the Unicode standard has no name, or only a name that few people know."""

NOT_TEXT = "save the program as UTF-8 text, or give another file"


def is_plain(text: str) -> bool:
    """Return True if all characters of a text are allowed in code."""
    return _PLAIN.fullmatch(text) is not None


def character_name(character: str) -> str:
    """Return a character's number and name: `U+00A0 no-break space`."""
    code = ord(character)
    if 0xD800 <= code <= 0xDFFF:
        name = "half of a character"
    else:
        name = _CONTROLS.get(code) or unicodedata.name(character, "").lower()
    if not name:
        name = "control character" if unicodedata.category(character) == "Cc" else "unknown character"
    return f"U+{code:04X} {name}"


def is_not_text(character: str) -> bool:
    """Return True for control characters and surrogates, which never occur in text."""
    return (character < " " and character not in "\t\n\r\v\f") or character == "\x7f" or _is_half(character)


def instead_of(character: str) -> str | None:
    """Return the text to write instead of a character that isn't allowed in code; it may be empty. None if
    the character has no safe substitute.
    """
    if character in _BREAKS or unicodedata.category(character) == "Zs":
        return " "
    if character in _UNSEEN or character in _TURNS:
        return ""
    if character in _ALIKE:
        return _ALIKE[character]
    digit = unicodedata.decimal(character, None)
    return None if digit is None else str(digit)


@frozen
class _Found:
    """A character that isn't allowed where it stands. `where` names a comment or a text; it is empty for
    code.
    """

    character: str
    row: int
    column: int
    where: str = ""


def fault_in(text: str) -> Fault | None:
    """Return a fault if a statement has characters that aren't allowed where they stand. The fault's place is
    the first of them; its fix replaces all of them.
    """
    if is_plain(text):
        return None
    rows = text.split("\n")
    faults = [one for number, row in enumerate(rows) for one in _in_row(number, row)]
    if not faults:
        return None
    first = next((one for one in faults if is_not_text(one.character)), faults[0])
    message = f"{_called(first.character)} isn't allowed in {first.where or 'code'}"
    if others := len(faults) - 1:
        verb = "is" if others == 1 else "are"
        message += f", and neither {verb} {others:,} more of this statement"
    place = Place(first.row, first.column, first.column + 1)
    code = "Y0103" if is_not_text(first.character) else "Y0118"
    return Fault(code, message, _help(first), place, *_fix(rows, faults))


def _in_row(number: int, row: str) -> Iterator[_Found]:
    """Yield the characters of a line that aren't allowed in their places."""
    if is_plain(row):
        return
    code = code_of(row)
    inside = [(text.start(), text.end(), "a text") for text in texts_of(code)]
    inside.append((len(code), len(row), "a comment"))
    stretches = iter(inside)
    begin, end, what = next(stretches)
    for match in _FOREIGN.finditer(row):
        at, character = match.start(), match[0]
        while at >= end:
            begin, end, what = next(stretches)
        where = what if at >= begin else ""
        if not where or not _shows_what_is_read(character):
            yield _Found(character, number, at + 1, where)


def _shows_what_is_read(character: str) -> bool:
    """Return True if a character is allowed in comments and texts."""
    return (
        unicodedata.category(character) != "Cc"
        and not _is_half(character)
        and character not in _BREAKS
        and character not in _TURNS
    )


def _is_half(character: str) -> bool:
    return "\ud800" <= character <= "\udfff"


def _called(character: str) -> str:
    """Return a character's description for a message: its glyph, if it is visible, and its name."""
    name = character_name(character)
    if character.isprintable() and not character.isspace() and character not in _UNSEEN:
        return f"`{character}` ({name})"
    return name


def _help(found: _Found) -> str:
    character = found.character
    if is_not_text(character):
        return NOT_TEXT
    if character in _TURNS:
        return "remove it: it changes the order in which editors show the line"
    if character in _BREAKS:
        if found.where:
            return "remove it: some editors end the line there, and what follows would look like code"
        return "write a plain blank, or begin a new line there"
    put = instead_of(character)
    if put == " ":
        return "write a plain blank"
    if put == "":
        return "remove it: it can't be seen"
    if put is not None:
        return f"write `{put}`"
    return "use only ASCII characters in code; others are allowed in comments and texts"


def _ends(row: str) -> frozenset[int]:
    """Return the positions in a line at which only some editors end the line, and after which a statement
    begins. The fix writes a real line end there.
    """
    ends: list[int] = []
    opens: bool | None = None
    word = len(row)
    for at in range(len(row) - 1, -1, -1):
        if not row[at].isspace():
            opens, word = None, at
        elif row[at] in _BREAKS:
            if opens is None:
                opens = opens_statement(row[word:])
            if opens:
                ends.append(at)
    return frozenset(ends)


def _fix(rows: list[str], found: list[_Found]) -> tuple[str, tuple[tuple[Place, str], ...]]:
    """Return the title of a fix for characters that aren't allowed, and its edits, one per line of the
    statement. There are no edits if one of the characters has no safe substitute.
    """
    pieces: dict[int, list[_Found]] = {}
    for one in found:
        # An editor may have shown the text after such a line end as a line of its own, so it may have been
        # meant as code.
        if is_not_text(one.character) or (one.where and one.character in _BREAKS):
            return "", ()
        if instead_of(one.character) is None:
            return "", ()
        pieces.setdefault(one.row, []).append(one)
    edits = []
    for number, here in pieces.items():
        foreign = {one.column - 1 for one in here}
        begin, end = min(foreign), max(foreign) + 1
        ends = _ends(rows[number])
        put = "".join(
            "\n" if at in ends else (instead_of(character) or "") if at in foreign else character
            for at, character in enumerate(rows[number][begin:end], begin)
        )
        edits.append((Place(number, begin + 1, end + 1), put))
    return "write plain characters", tuple(edits)
