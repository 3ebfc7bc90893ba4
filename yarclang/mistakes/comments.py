"""Recognise comments that begin as in other languages."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_WHOLE = re.compile(r"\s*(?P<sign>//+|#+|;+|--+|/\*|\*+|%|'|\()\s*(?P<said>.*)")
_REM = re.compile(r"\s*(?P<sign>REM)(?:\s+(?P<said>.*))?$", re.I)
_BEHIND = re.compile(r"(?<=\s)(?P<sign>//+|#+|;|--+(?=\s)|/\*)\s*(?P<said>[^\s].*)$")
_CLOSING = re.compile(r"\s*(?:\*/|\*+|\))$")
_WORDS = re.compile(r"[A-Za-z][A-Za-z'.,-]*(?:\s|$)")


def whole(line: Line) -> Guess | None:
    """Recognise a comment on a line of its own that begins with a sign other than `!`."""
    found = _REM.match(line.text) or _WHOLE.match(line.text)
    if found is not None:
        sign, said = found["sign"], found["said"] or ""
        if module := re.match(r"(?:include|import)\s*[\"<]?\s*(?P<name>[A-Za-z_]\w*)", said, re.I):
            at = found.start("sign")
            end = found.start("said") + len(said.split()[0])
            help_ = f"write USE {module['name'].upper()}, with the module's name"
            return line.guess(at, end, f"`{line.text[at:end]}` is of another language", None, help_)
        if sign == "(":
            if not said.endswith(")") or not _WORDS.match(said):
                return None
        elif sign == ";" and said[:1].isdigit():
            return None
        return _written(line, found.start("sign"), sign, said)
    return None


def behind(line: Line) -> Guess | None:
    """Recognise a comment after a command that begins with a sign other than `!`."""
    found = _BEHIND.search(line.text)
    if found is None or not line.word or "!" in line.text or '"' in line.bare:
        return None
    sign, said = found["sign"], found["said"]
    if sign == ";" and (line.is_declaration or not _are_words(line, said)):
        return None
    if sign.startswith("--") and not _WORDS.match(said):
        return None
    return _written(line, found.start("sign"), sign, said)


def _are_words(line: Line, said: str) -> bool:
    """Return True if the text after a semicolon is a remark and not a waypoint.

    A remark has several words, and none of them is a name of the program.
    """
    words = said.split()
    known = {name.upper() for names in line.around.declared.values() for name in names} | {"HOME"}
    return (
        len(words) > 1
        and all(map(_WORDS.match, words))
        and not known & {word.upper().strip(".,") for word in words}
    )


def _written(line: Line, at: int, sign: str, said: str) -> Guess:
    said = _CLOSING.sub("", said) if sign in ("/*", "(") else said
    put = f"! {said}".rstrip()
    shown = put if len(put) < 40 else put[:37] + "..."
    repaired = line.text[:at] + put
    return Guess(at, at + len(sign), f"`{sign}` doesn't begin a comment", f"write {shown}", repaired)
