"""Recognise declarations with equals signs, commas, quotes or brackets that the language doesn't have."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line, is_number
from yarclang.units import UNITS

_EQUALS = re.compile(r"(?P<before>\s++(?:\{\s*+\w++\s*+\}|\w++)?)\s*+(?P<sign>:?=)\s*+")
_LISTED = re.compile(
    r"\s++\{?\s*+\w++\s*+\}?\s*+=?\s*+(?P<all>[(\[{]?\s*+(?P<list>[-+]?[0-9.]++"
    r"(?:\s*+,\s*+[-+]?[0-9.]++){2,})\s*+[)\]}]?)"
)
_WITH_UNIT = re.compile(r"\s++\w++\s*+(?P<all>=\s*+(?P<value>[-+]?[0-9.]++)\s*+(?P<unit>[A-Za-z]++))")
_MISNAMED = {
    "JOINT": "JOINTS",
    "JPOS": "JOINTS",
    "JPOINT": "JOINTS",
    "POSES": "POSE",
    "FRAMES": "FRAME",
    "INPUTS": "INPUT",
    "OUTPUTS": "OUTPUT",
    "SUBROUTINE": "SUB",
    "REGISTERS": "REGISTER",
}
_VARIABLE = re.compile(
    r"\s++(?P<name>[A-Za-z_]\w*+)\s++(?P<variable>(?:DO|DI|DOUT|DIN|OUT|IN)?\s*+\[?[0-9]++\]?)(?P<rest>.*)",
    re.I,
)


def declared(line: Line) -> Guess | None:
    """Recognise a declaration that is written as in other languages."""
    word = line.word.upper()
    if (meant := _MISNAMED.get(word)) and line.values.strip() and word not in line.around.lines_of:
        return line.guess(line.begin, line.behind, f"{line.word} is no declaration", meant)
    if word in (
        "FRAME",
        "FRAME_QUAT",
        "JOINTS",
        "POSE",
        "OUTPUT",
        "INPUT",
        "ROBOT",
        "START",
        "DEFAULT",
        "USE",
        "CELL",
    ):
        if found := _LISTED.match(line.values):
            put = " ".join(re.split(r"\s*,\s*", found["list"]))
            return _replaced(
                line,
                found,
                "all",
                "the values are separated by commas",
                put,
                f"write blanks between the values: {put}",
            )
        if found := _EQUALS.match(line.values):
            before = line.text[: line.behind] + found["before"].rstrip()
            repaired = f"{before} {line.text[line.behind + found.end() :]}"
            at = line.behind + found.start("sign")
            shown = repaired.partition(" !")[0].strip()
            return Guess(
                at, at + len(found["sign"]), f"{word} takes no equals sign", f"write {shown}", repaired
            )
    if word == "JOINTS" and (found := re.match(r"\s+(?P<all>\{\s*(?P<name>\w+)\s*\})", line.values)):
        return _replaced(
            line, found, "all", "the name of a joint position is written without braces", found["name"]
        )
    if word in ("OUTPUT", "INPUT") and (found := _VARIABLE.fullmatch(line.values)):
        example = "M1" if word == "OUTPUT" else "M11"
        help_ = (
            f"write the controller's variable after the name, as {word} {found['name']} "
            f"{example}{found['rest'].rstrip()}"
        )
        return _replaced(
            line, found, "variable", f"`{found['variable']}` is no variable of the controller", None, help_
        )
    if word == "LET":
        return _number(line)
    if word == "SUB":
        return _sub(line)
    if (
        word == "USE"
        and (
            found := re.fullmatch(
                r"\s+(?P<all>\"?\s*(?P<name>[A-Za-z_]\w*)(?:\.yarc)?\s*\"?)\s*;?", line.values, re.I
            )
        )
        and found["all"] != found["name"]
    ):
        help_ = f"write USE {found['name'].upper()}: the name alone, without quotes and ending"
        return _replaced(
            line, found, "all", "a module has the name of its file, without the ending", None, help_
        )
    if word == "DEFAULT" and (found := re.match(r"\s+(?P<all>[A-Za-z_]\w*)(?=\s|$)", line.values)):
        put = f"{{{found['all']}}}"
        return _replaced(line, found, "all", "the name of a frame must be in braces", put)
    return None


def _number(line: Line) -> Guess | None:
    found = _WITH_UNIT.fullmatch(line.values)
    if found and found["unit"].lower() in UNITS and is_number(found["value"]):
        help_ = f"write = {found['value']} ({found['unit'].lower()})"
        return _replaced(line, found, "all", "the unit of a number must be in brackets after it", None, help_)
    if found := re.match(r"\s+(?P<name>[0-9]+(?P<rest>[A-Za-z_]\w*))", line.values):
        help_ = f"names begin with a letter: write {found['rest']}{found['name'][: -len(found['rest'])]}"
        return _replaced(line, found, "name", f"`{found['name']}` is no name", None, help_)
    return None


def _sub(line: Line) -> Guess | None:
    if not line.values.strip():
        return line.guess(
            line.begin, line.behind, "the SUB has no name", None, "write a name after it, as SUB PICK"
        )
    if found := re.fullmatch(r"\s+(?P<name>[A-Za-z_]\w*)\s*(?P<all>\(\s*\)\s*:?|:)", line.values):
        at = line.behind + found.start("all")
        return line.guess(
            at, len(line.bare), "the head of a SUB takes no round brackets", "", f"write SUB {found['name']}"
        )
    return None


def _replaced(
    line: Line, found: re.Match[str], group: str, message: str, put: str | None, help_: str = ""
) -> Guess:
    at = line.behind + found.start(group)
    return line.guess(at, at + len(found[group]), message, put, help_)
