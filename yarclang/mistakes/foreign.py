"""Recognise lines of other robot languages, and name the equivalent in YARC."""

from __future__ import annotations

import re

from yarclang.mistakes.languages import BLOCKS, FORMS, MOVEC, MOVEJ, MOVEL, NUMBERED, WHOLE, WORDS
from yarclang.mistakes.line import Guess, Line

_HEAD = re.compile(r"\s*(?P<word>\$?[A-Za-z_][A-Za-z0-9_.]*)")
_ROBTARGETS = re.compile(r"\s+(?P<all>[A-Za-z_]\w*\s*,\s*(?P<speed>v[0-9]+|vmax)\s*,.*)", re.I)
_OFFSET = re.compile(r"\s+(?P<all>(?:Offs|RelTool)\s*\(.*\)).*", re.I)
_CALLED = re.compile(r"\s*(?P<all>(?P<word>[A-Za-z_]\w*)\s*\((?P<inside>.*)\)\s*;?)\s*$")
_WAITTIME = re.compile(
    r"\s*(?P<all>(?:WaitTime|sleep)\s*\(?\s*(?P<time>[0-9]+\.?[0-9]*)\s*\)?\s*;?)\s*$", re.I
)


def foreign(line: Line) -> Guess | None:
    """Recognise a line that is valid in another robot language."""
    said = line.bare.strip()
    if (found := _WAITTIME.fullmatch(line.bare)) and not line.index.strip():
        return line.guess(
            found.start("all"),
            found.end("all"),
            "the time of a WAIT must be in square brackets",
            f"{line.around.free_index(line.number)} WAIT [{found['time']}]",
        )
    for form, help_, begins in FORMS:
        if found := form.match(said):
            at = len(line.bare) - len(line.bare.lstrip())
            message = f"`{_short(found[0])}` belongs to another robot language"
            guess = line.guess(at, at + found.end(), message, None, help_)
            guess.begins_block = begins
            return guess
    if line.is_motion and (found := _ROBTARGETS.fullmatch(line.values)):
        at = line.behind + found.start("all")
        speed = found["speed"][1:]
        help_ = (
            (
                f"write {line.word.upper()} with the pose's numbers and [V {speed}]; {found['speed']}, "
                "zones and tools aren't written here"
            )
            if speed.isdigit()
            else "write the pose's numbers and [MIN]"
        )
        return line.guess(
            at,
            len(line.bare),
            f"{line.word} takes a pose, not names with commas between them: {found['speed']} belongs to "
            "RAPID",
            None,
            help_,
        )
    if line.is_motion and (found := _OFFSET.fullmatch(line.values)):
        at = line.behind + found.start("all")
        return line.guess(
            at,
            at + len(found["all"]),
            "no function shifts a pose",
            None,
            "write DMOVE 0 0 100 0 0 0 for a relative motion, or add numbers by $(Z+100)",
        )
    return _by_head(line)


def numbered(line: Line) -> Guess | None:
    """Recognise a line that begins with its number, as in G-code."""
    said = line.bare.strip()
    for form, help_ in NUMBERED:
        if found := form.match(said):
            at = len(line.bare) - len(line.bare.lstrip())
            message = f"`{_short(found[0])}` belongs to another robot language"
            return line.guess(at, at + found.end(), message, None, help_)
    return None


def _by_head(line: Line) -> Guess | None:
    head = _HEAD.match(line.bare, len(line.index))
    if head is None:
        return None
    word, begin, end = head["word"], head.start("word"), head.end("word")
    upper = word.upper()
    if upper.startswith(("$VEL", "$ACC")):
        return line.guess(
            begin,
            end,
            f"{word} belongs to KRL",
            None,
            "the speed is given with each motion: write [V 200] after the values, or DEFAULT [V 200] once",
        )
    if (
        upper.startswith("MOVE")
        and (called := _CALLED.fullmatch(line.bare))
        and ("p[" in called["inside"] or "=" in called["inside"])
    ):
        serves = {"MOVEJ": MOVEJ, "MOVEL": MOVEL, "MOVEC": MOVEC}.get(upper)
        if serves:
            whole = "=" in called["inside"]
            last = called.end("all") if whole else end
            return line.guess(
                begin,
                last,
                f"`{word}(...)` belongs to URScript, whose angles are in rad and lengths in m",
                None,
                serves,
            )
    if upper.startswith("MOVE") and (
        called := re.match(r"\s*(?P<word>\w+)\((?P<inside>\s*[A-Za-z]\w*\s*,.*)\)", line.bare)
    ):
        serves = {"MOVEJ": MOVEJ, "MOVEL": MOVEL, "MOVEC": MOVEC}.get(upper)
        if serves:
            return line.guess(begin, end + 1, f"`{word}(...)` with names belongs to VAL3", None, serves)
    return _by_word(line, word, begin, end)


def _by_word(line: Line, word: str, begin: int, end: int) -> Guess | None:
    upper = word.upper()
    help_ = WORDS.get(upper)
    if help_ is None or line.is_command or upper in line.around.lines_of:
        return None
    if upper in WHOLE:
        end = len(line.bare)
    guess = line.guess(begin, end, f"{word} is no command", None, help_)
    guess.begins_block = upper in BLOCKS
    return guess


def _short(text: str) -> str:
    return text if len(text) < 30 else text[:27] + "..."
