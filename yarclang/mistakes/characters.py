"""Recognise signs that are usual in tables and texts, but not allowed in programs."""

from __future__ import annotations

import re
import unicodedata

from yarclang.mistakes.line import Guess, Line

_DEGREES = re.compile(r"(?<=[0-9.])\s?[°º˚]")
_MINUTES = re.compile(r"(?<=[0-9])(?P<sign>[′″’”])")
_FRACTIONS = re.compile(r"(?<![^\s])(?P<whole>[0-9]*)(?P<part>[¼½¾⅛⅜⅝⅞])(?=\s|$)")
_COMMAS = re.compile(r"[،，、؛；](?=\s|$)")


def alike(line: Line) -> Guess | None:
    """Recognise degree and minute signs after a number, fractions, and commas of other scripts."""
    if found := _DEGREES.search(line.bare):
        every = _DEGREES.sub("", line.text)
        unit = line.units.get("angle")
        help_ = (
            f"remove it: the line already has the unit {unit}"
            if unit
            else "write (deg) after the motion time"
        )
        repaired = (every,) if unit == "deg" else ()
        return Guess(
            found.start(),
            found.end(),
            "`°` isn't allowed in code: units are written in brackets, once for all angles",
            help_,
            *repaired,
        )
    if found := _MINUTES.search(line.bare):
        help_ = "write the angle as one decimal number: 10.5 for 10 degrees and 30 minutes"
        return line.guess(
            found.start("sign"), found.end("sign"), f"`{found['sign']}` isn't allowed in code", None, help_
        )
    if found := _FRACTIONS.search(line.bare):
        number = f"{float(found['whole'] or 0) + unicodedata.numeric(found['part']):g}"
        what = f"`{found['part']}` isn't allowed in code: write decimal numbers"
        return line.guess(found.start(), found.end(), what, number)
    if found := _COMMAS.search(line.bare):
        without = _COMMAS.sub("", line.text)
        return Guess(
            found.start(),
            found.end(),
            f"`{found[0]}` isn't allowed in code",
            "write blanks between values",
            without,
        )
    return None
