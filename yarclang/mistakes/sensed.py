"""Recognise mistakes in UNTIL and ON, which watch an input while the robot moves."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_OFF = {"OFF", "FALSE", "LOW", "0"}
_STATE = "ON|OFF|TRUE|FALSE|HIGH|LOW|0|1"
_SAID = rf"""(?P<open>\(\s*)?(?P<not>(?:NOT\s+|!\s*))?(?P<name>[A-Z_][A-Z0-9_]*)
    (?:\s*(?P<sign>==?|<>|!=|~=)\s*(?P<state>{_STATE})|\s+(?P<plain>{_STATE})|\s+IS\s+(?P<is>{_STATE}))?(?(open)\s*\))"""
_UNTIL = re.compile(rf"\bUNTIL\s+(?P<all>{_SAID})(?=\s|$)", re.IGNORECASE | re.VERBOSE)
_NOTHING = re.compile(r"\b(UNTIL)\s*$", re.IGNORECASE)
_WATCH = re.compile(
    rf"\s+(?P<all>{_SAID})(?:\s+(?P<reaction>HOLD|STOP|PAUSE|ABORT))?\s*", re.IGNORECASE | re.VERBOSE
)


def until(line: Line) -> Guess | None:
    """Recognise a condition after UNTIL. Only the name of an input, with its state, is allowed there."""
    if not line.is_motion:
        return None
    if nothing := _NOTHING.search(line.bare, line.behind):
        inputs = line.around.declared.get("INPUT", ["TOUCH"])
        help_ = f"write UNTIL {inputs[0]}" if len(inputs) == 1 else f"the inputs are {', '.join(inputs)}"
        return line.guess(nothing.start(1), nothing.end(1), "UNTIL needs an input", None, help_)
    found = _UNTIL.search(line.bare, line.behind)
    if found is None or not _is_other(found):
        return None
    off = _is_off(found)
    put = f"{found['name']}{' OFF' * off}"
    message = "UNTIL needs the name of an input, and OFF after it to wait for OFF"
    return line.guess(found.start("all"), found.end("all"), message, put, f"write UNTIL {put}")


def watch(line: Line) -> Guess | None:
    """Recognise an ON with a condition, or without a reaction."""
    found = _WATCH.fullmatch(line.values) if line.word.upper() == "ON" else None
    if found is None:
        return None
    reaction, told = (found["reaction"] or "").upper(), _is_told(found)
    if reaction == "HOLD" and told and not _is_other(found):
        return None
    state = "OFF" if _is_off(found) else "ON"
    put = f"{found['name']} {state} HOLD"
    at = line.behind + found.start("all")
    end = line.behind + len(line.values.rstrip())
    message = "ON needs an input, the state in which nothing may move, and HOLD"
    sure = told and reaction in ("", "HOLD")  # other words may mean a stop that can't be resumed
    return line.guess(at, end, message, put if sure else None, f"write ON {put}")


def _is_other(found: re.Match[str]) -> bool:
    """Return True if an input and its state are written in a form that the language doesn't have."""
    plain = (found["plain"] or "ON").upper()
    return bool(found["open"] or found["not"] or found["sign"] or found["is"]) or plain not in ("ON", "OFF")


def _is_told(found: re.Match[str]) -> bool:
    return bool(found["not"] or found["state"] or found["plain"] or found["is"])


def _is_off(found: re.Match[str]) -> bool:
    """Return True if the condition is true while the input is OFF."""
    said = (found["state"] or found["plain"] or found["is"] or "ON").upper()
    is_off = said in _OFF
    turns = bool(found["not"]) + (found["sign"] in ("<>", "!=", "~="))
    return is_off != bool(turns % 2)
