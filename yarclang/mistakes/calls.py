"""Recognise commands that are written as function calls."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_CALL = re.compile(r"\s*\(\s*(?P<inside>.*?)\s*\)\s*;?")
_RESET = re.compile(r"\s*(?P<all>(?P<word>Set|Reset|SetDO|ResetDO)\s+(?P<name>[A-Za-z_]\w*)\s*;?)\s*", re.I)


def request(line: Line) -> Guess | None:
    """Recognise RAPID's Set and Reset with the name of an output."""
    found = _RESET.fullmatch(line.bare, len(line.index))
    if found is None or found["name"].upper() not in _of(line, "OUTPUT"):
        return None
    if found["word"].upper() == "SET" and not found["all"].endswith(";"):
        return None  # a YARC line without its state, which may be ON or OFF
    state = "OFF" if found["word"].upper().startswith("RESET") else "ON"
    end = found.end("all") if state == "ON" else found.end("word")
    index = "" if line.index.strip() else f"{line.around.free_index(line.number)} "
    message = f"{found['word']} is no command: SET has ON or OFF after the output"
    return line.guess(found.start("all"), end, message, None, f"write {index}SET {found['name']} {state}")


def call(line: Line) -> Guess | None:
    """Recognise commands written as in other languages: SET(GLUE, ON), HOLD("text"), CALL "PICK", CALL
    PICK(1, 2), PICK.
    """
    word = line.word.upper()
    found = _CALL.fullmatch(line.values)
    if found is not None and word in ("SET", "PULSE") and "," in found["inside"]:
        name, _, state = (one.strip() for one in found["inside"].partition(","))
        state = {"TRUE": "ON", "1": "ON", "FALSE": "OFF", "0": "OFF"}.get(state.upper(), state)
        put = f"{line.word} {name} {state}"
        repaired = f"{line.text[: line.begin]}{put}{line.comment and ' ' + line.comment}"
        message = f"{word} takes no brackets and no commas"
        return Guess(line.behind, len(line.bare), message, f"write {put}", repaired)
    if found is not None and word in ("HOLD", "SAY") and re.fullmatch(r'"[^"]*"', found["inside"]):
        put = f"{line.word} {found['inside']}"
        repaired = f"{line.text[: line.begin]}{put}{line.comment and ' ' + line.comment}"
        return Guess(line.behind, len(line.bare), f"{word} takes no brackets", f"write {put}", repaired)
    subs = _of(line, "SUB")
    if word == "CALL" and (found := re.fullmatch(r'\s+(?P<all>"\s*(?P<name>[A-Za-z_]\w*)\s*")', line.values)):
        at = line.behind + found.start("all")
        message = "the name of a SUB is written without quotes"
        return line.guess(at, len(line.bare), message, found["name"], f"write CALL {found['name']}")
    if word == "CALL" and (
        found := re.fullmatch(
            r"\s+(?P<name>[A-Za-z_][\w.]*)\s*(?P<all>\((?P<inside>[^()]+)\))\s*;?", line.values
        )
    ):
        name = found["name"]
        if name.upper() in subs:
            put = " ".join(one.strip() for one in found["inside"].split(","))
            at = line.behind + found.start("all")
            repaired = (
                f"{line.text[: line.behind + found.end('name')]} {put}{line.comment and ' ' + line.comment}"
            )
            return Guess(
                at,
                line.behind + found.end("all"),
                "arguments are separated by blanks, without brackets",
                f"write CALL {name} {put}",
                repaired,
            )
    if word in subs and re.fullmatch(r"\s*(?:\(\s*\))?\s*;?", line.values) and line.values.strip():
        put = f"CALL {line.word}"
        return line.guess(line.begin, len(line.bare), f"{line.word} is a SUB, which CALL carries out", put)
    return None


def _of(line: Line, kind: str) -> frozenset[str]:
    return frozenset(one.upper() for one in line.around.declared.get(kind, ()))
