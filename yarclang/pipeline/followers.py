"""Findings that only follow from another one: one fault is said once, where it is."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from difflib import get_close_matches
from functools import lru_cache

from yarclang.diagnostics import Diagnostic
from yarclang.progress import each
from yarclang.source import SourceFile
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import BLOCK_HEADS, DECLARATIONS

_UNKNOWN = frozenset(["Y0205", "Y0210", "Y0301", "Y0303", "Y0411"])
"""Something isn't known, or isn't what it should be."""

_LEFT_OUT = frozenset(["Y0302", "Y0304", "Y0406"])
"""Something is left out that DEFAULT may give."""

_UNUSED = frozenset(["Y0215", "Y0216", "Y1011", "Y1012"])
"""Something isn't used; where names are wrong, it may be meant by one of them."""

_ALIKE = frozenset(["Y0302", "Y0304", "Y0309", "Y0406", "Y0417"])
"""One DEFAULT line may be the cause of many."""

_INDICES = frozenset(["Y0201", "Y1201"])
"""Indices that stand twice, or in another order: each SUB has its own."""

_PLANNED = ("Y05", "Y06", "Y07", "Y08", "Y09", "Y1010")
"""What depends on where a motion leads; of a place that isn't what was meant, nothing is to be said."""

_GIVES_NAMES = ("FRAME", "FRAME_QUAT", "LET", "JOINTS")
_MOST_IN_A_LINE = 20
"""Findings with one code; whoever has more mistakes in one line looks at the line, not at the findings."""

_WITHOUT_HEAD = "{[("
"""What begins with one of these and can't be read was meant to be a DEFAULT."""

_MANY = 3
_LIKE = 0.7
"""How like a word is at least to the one that it was meant to be: difflib's ratio."""

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")


def without_followers(diagnostics: Iterable[Diagnostic], source: SourceFile) -> tuple[Diagnostic, ...]:
    """The findings without those that follow from an error in another line of the program.

    A line with an error explains why names that stand in it aren't known elsewhere; a DEFAULT that can't be read, why units and frames are missing; a
    block's first line that can't be read, why its END ends nothing; a frame or number that isn't what was meant, why the robot can't go there. An error is never left out but for another one that stays.
    """
    found = tuple(diagnostics)
    causes = {
        one.span.line for one in each(found) if one.is_error and one.span is not None and _is_own(one, source)
    }
    causes -= {
        one.span.line
        for one in each(found)
        if one.span is not None and one.code in _UNKNOWN and _is_use(one, source)
    }
    if not causes and not any(one.code in _UNKNOWN | _ALIKE for one in found):
        return found
    words = {line: _words(source.line(line)) for line in each(causes)}
    firsts = {line: _first(source.line(line)) for line in each(causes)}
    lost_default = any(
        _is_like(first, "DEFAULT") or code_of(source.line(line)).lstrip()[:1] in _WITHOUT_HEAD
        for line, first in each(firsts.items())
        if code_of(source.line(line)).strip()
    )
    lost_cell = any(
        _is_like(first, "CELL") or ".TOML" in code_of(source.line(line)).upper()
        for line, first in each(firsts.items())
    )
    lost_heads = [
        line for line, first in each(firsts.items()) if any(_is_like(first, head) for head in BLOCK_HEADS)
    ]
    open_blocks = [one.span.line for one in found if one.code == "Y0113" and one.span is not None]
    misplaced = {one.span.line for one in found if one.code == "Y0116" and one.span is not None}
    doubtful = _doubtful(source, words)
    lost_end = any(first != "END" and _is_like(first, "END") for first in each(firsts.values()))
    no_command = {one.span.line for one in found if one.code == "Y0202" and one.span is not None}
    no_module = any(one.code == "Y0213" for one in found)
    first_open = min(open_blocks, default=math.inf)
    first_no_command = min(
        (line for line in no_command & causes if firsts[line] not in DECLARATIONS), default=math.inf
    )
    no_frame = any(one.code == "Y0301" for one in found)
    first_said: dict[str, int] = {}
    for line, said in each(sorted(words.items())):
        for word in said:
            first_said.setdefault(word, line)
    lost_name = any(one.code in _UNKNOWN | {"Y0202", "Y0213"} for one in found)

    def follows(one: Diagnostic) -> bool:
        line = one.span.line if one.span is not None and _is_own(one, source) else 0
        match one.code:
            case "Y0206" if line in misplaced:
                return True
            case code if code in _INDICES:
                return first_open < line
            case code if code.startswith(_PLANNED):
                return _rests_on(one, line, source, doubtful)
            case "Y0105":
                return line in no_command
            case "Y0208":
                return first_no_command < line
            case "Y0113":
                return lost_end
            case "Y0114":
                return any(head < line for head in lost_heads if head in no_command or head != line)
            case code if code in _LEFT_OUT:
                return lost_default and not _is_like(firsts.get(line, ""), "DEFAULT")
            case code if code in _UNUSED:
                return lost_name
            case code if code in _UNKNOWN and lost_cell and line not in misplaced:
                return firsts.get(line, "") != "CELL"
            case code if code in _UNKNOWN:
                name = _name(one)
                if one.code == "Y0303" and line not in causes and no_frame:
                    return True
                told = (first_said.get(word, math.inf) for word in (name, name.partition(".")[0]))
                return bool(name) and (min(told) < (line or math.inf) or ("." in name and no_module))
        return False

    return _said_once([one for one in each(found) if not follows(one)])


def _doubtful(source: SourceFile, words: dict[int, set[str]]) -> frozenset[str]:
    """The names of declarations with errors, and of those that rest on them; `DEFAULT` if it does."""
    lost: set[str] = set()
    heads = {*_GIVES_NAMES, "DEFAULT"}
    if not any(_first(source.line(line)) in heads for line in words):
        return frozenset()
    for number, line in each(enumerate(source.lines, 1)):
        said = _WORD.findall(code_of(line).upper())
        if not said or said[0] not in heads:
            continue
        if number in words or lost & set(said[1:]):
            lost |= {said[0]} & {"DEFAULT"} | set(said[1:2] if said[0] in _GIVES_NAMES else ())
    return frozenset(lost)


def _rests_on(one: Diagnostic, line: int, source: SourceFile, doubtful: frozenset[str]) -> bool:
    """Whether what a finding says of a motion may come from names that are doubtful; of unrolled code any may."""
    if not doubtful:
        return False
    said = set(_WORD.findall(code_of(source.line(line)).upper())) if line else set()
    return bool(one.place) or "DEFAULT" in doubtful or bool(said & doubtful)


def _is_own(one: Diagnostic, source: SourceFile) -> bool:
    return one.source is not None and one.source.name == source.name


def _is_use(one: Diagnostic, source: SourceFile) -> bool:
    """Whether an unknown name stands in a command: the line declares nothing that others could miss."""
    if one.span is None or not _is_own(one, source):
        return False
    return _first(source.line(one.span.line)) not in DECLARATIONS


def _first(line: str) -> str:
    """A line's first word in upper case."""
    found = _WORD.search(code_of(line))
    return found[0].upper() if found else ""


def _words(line: str) -> set[str]:
    return {word.upper() for word in _WORD.findall(code_of(line))} - DECLARATIONS


@lru_cache(maxsize=1 << 12)
def _is_like(word: str, meant: str) -> bool:
    if word == meant:
        return True
    # an upper bound of difflib's ratio, in a hundredth of its time
    common = sum(letter in meant for letter in word)
    if 2.0 * common < _LIKE * (len(word) + len(meant)):
        return False
    return bool(get_close_matches(word, [meant], n=1, cutoff=_LIKE))


def _name(one: Diagnostic) -> str:
    """What a finding points at, in upper case, without braces."""
    if one.source is None or one.span is None or one.span.line != one.span.end_line:
        return ""
    shown = one.source.line(one.span.line)[one.span.column - 1 : one.span.end_column - 1]
    return shown.strip("{}$() ").upper()


def _said_once(found: list[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Of findings about the same unknown name the first, and of many alike the first; it tells how many more there are."""
    groups: dict[tuple[str, str], list[Diagnostic]] = {}
    for one in each(found):
        if one.code in _UNKNOWN - {"Y0303"} and (name := _name(one)):
            key = ("unknown", name)
        elif one.code in _ALIKE:
            key = ("alike", one.code)
        else:
            key = ("", str(len(groups)))
        groups.setdefault(key, []).append(one)
    said: list[Diagnostic] = []
    for (kind, _), group in each(groups.items()):
        in_lines = {one.span.line for one in each(group) if one.span is not None}
        if kind == "" or len(in_lines if kind == "alike" else group) < (2 if kind == "unknown" else _MANY):
            said += group
            continue
        more = len(group) - 1
        lines = f"{more} more line{'s' * (more != 1)}"
        # another command's name, or another unit, is another message: then it isn't just the same
        what = _what(group[0])
        again = (
            f"the same in {lines}"
            if all(_what(one) == what for one in each(group))
            else f"{more} more like it"
        )
        said.append(replace(group[0], message=f"{group[0].message}; {again}"))
    return tuple(said)


def few_in_a_line(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return the findings without all but the first ones of a code in a line; the last of these tells how many more there are."""
    found = tuple(diagnostics)
    counts = Counter(_line_and_code(one) for one in each(found))
    if all(count <= _MOST_IN_A_LINE for count in counts.values()):
        return found
    said: list[Diagnostic] = []
    so_far: Counter[tuple[str, int, str]] = Counter()
    for one in each(found):
        key = _line_and_code(one)
        so_far[key] += 1
        if not key[1] or so_far[key] < _MOST_IN_A_LINE or counts[key] == _MOST_IN_A_LINE:
            said.append(one)
        elif so_far[key] == _MOST_IN_A_LINE:
            more = counts[key] - _MOST_IN_A_LINE
            said.append(replace(one, message=f"{one.message}; {more:,} more like it in this line"))
    return tuple(said)


def _line_and_code(one: Diagnostic) -> tuple[str, int, str]:
    """Return file, line and code of a finding; line 0 if it has no place."""
    return one.source.name if one.source else "", one.span.line if one.span else 0, one.code


def _what(one: Diagnostic) -> str:
    """What a finding says of what is missing, whichever command it is that misses it; of others nothing counts."""
    return one.message.partition(" ")[2] if one.code in _LEFT_OUT else ""
