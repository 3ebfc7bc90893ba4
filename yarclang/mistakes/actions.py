"""Recognise mistakes in commands without motion, and in conditions and registers."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_STATES = {
    "TRUE": "ON",
    "FALSE": "OFF",
    "HIGH": "ON",
    "LOW": "OFF",
    "YES": "ON",
    "NO": "OFF",
    "OPEN": "",
    "CLOSED": "",
}


def signal(line: Line) -> Guess | None:
    """Recognise a SET or WAIT with a wrong signal, state or operator."""
    word = line.word.upper()
    if word not in ("SET", "WAIT"):
        return None
    counted = re.fullmatch(
        r"\s+(?P<all>(?P<name>[A-Za-z_]\w*)\s*(?P<sign>\+\+|--|[-+*]=\s*(?P<value>\w+)))\s*;?", line.values
    )
    if counted:
        at, name = line.behind + counted.start("all"), counted["name"]
        put = f"{name} = {name} {counted['sign'][0]} {counted['value'] or 1}"
        return line.guess(
            at,
            at + len(counted["all"]),
            f"`{counted['sign']}` is no operator of the language",
            put,
            f"write SET {put}",
        )
    declared = line.around.declared
    inputs, outputs = ({one.upper() for one in declared.get(kind, ())} for kind in ("INPUT", "OUTPUT"))
    found = re.fullmatch(
        r"\s+(?P<name>[A-Za-z_]\w*)(?P<sign>\s*=\s*|\s+)?(?P<state>\w+)?(?P<rest>.*)", line.values
    )
    if found is None:
        return None
    name, at = found["name"], line.behind + found.start("name")
    state = (found["state"] or "").upper()
    if word == "SET" and name.upper() in inputs:
        return line.guess(
            at,
            at + len(name),
            f"{name} is an input, and SET sets outputs",
            None,
            f"write WAIT {name} ON to wait for it, or declare it by OUTPUT",
        )
    if word == "WAIT" and name.upper() in outputs:
        return line.guess(
            at,
            at + len(name),
            f"{name} is an output, and WAIT waits for inputs",
            None,
            f"write SET {name} ON to set it, or declare it by INPUT",
        )
    if name.upper() not in (outputs if word == "SET" else inputs):
        return None
    if not state and not found["rest"].strip():
        states = "ON or OFF"
        return line.guess(
            at,
            at + len(name),
            f"the value for {name} is missing",
            None,
            f"write {word} {name} ON, or OFF: {states}",
        )
    if _STATES.get(state):
        begin = line.behind + found.start("state")
        return line.guess(
            begin, begin + len(state), f"`{found['state']}` is neither ON nor OFF", _STATES[state]
        )
    if state in ("ON", "OFF") and found["sign"] and "=" in found["sign"] and not found["rest"].strip():
        begin = line.behind + found.start("sign") + found["sign"].index("=")
        put = f"{word} {name} {state}"
        repaired = f"{line.text[: at + len(name)]} {line.text[line.behind + found.start('state') :]}"
        return Guess(begin, begin + 1, f"{word} takes no equals sign here", f"write {put}", repaired)
    return None


def wait(line: Line) -> Guess | None:
    """Recognise a WAIT whose time has wrong brackets or is missing, or whose input is written as in
    another language.
    """
    if line.word.upper() != "WAIT":
        return None
    found = re.fullmatch(
        r"\s+(?P<all>(?:(?:SEC|FOR)\s+)?\(?\s*(?P<time>[0-9]+(?:\.[0-9]*)?)\s*(?:\(sec\)|seconds?|secs?"
        r"|s)?\s*\)?)\s*;?",
        line.values,
        re.I,
    )
    if found is not None:
        at = line.behind + found.start("all")
        put = f"[{found['time']}]"
        return line.guess(
            at,
            at + len(found["all"]),
            "the time of a WAIT must be in square brackets",
            put,
            f"write WAIT {put}",
        )
    found = re.fullmatch(
        r"\s+(?P<all>(?:(?:FOR|UNTIL|IF|WHEN)\s+)?(?P<no>NOT\s+)?(?P<name>[A-Za-z_]\w*)(?:\s*=?=?\s*"
        r"(?P<state>ON|OFF))?)(?P<time>\s*\[.*)?",
        line.values,
        re.I,
    )
    if found is not None:
        at = line.behind + found.start("all")
        state = (found["state"] or "ON").upper()
        if found["no"]:
            state = "OFF" if state == "ON" else "ON"
        put = f"{found['name']} {state}"
        if found["all"] != put and found["name"].upper() in (*_named(line, "INPUT"), *_named(line, "OUTPUT")):
            what = "WAIT needs an input and the value to wait for"
            return line.guess(at, at + len(found["all"]), what, put, f"write WAIT {put}")
    if found := re.fullmatch(r"\s+(?P<all>(?:FOR\s+)?\$?[A-Z]*IN?\s*\[.*)", line.values, re.I):
        at = line.behind + found.start("all")
        help_ = "declare the input, as INPUT DOOR M11, and write WAIT DOOR ON"
        return line.guess(
            at,
            at + len(found["all"]),
            "WAIT needs the name of an input, and the value to wait for",
            None,
            help_,
        )
    return None


def turned(line: Line) -> Guess | None:
    """Recognise outputs, inputs and their states in a wrong form.

    These are an output without SET, a state before its output or after a comma, a WHEN without a state, a
    STOP with a text, and a REGISTER without a range.
    """
    outputs, inputs = _named(line, "OUTPUT"), _named(line, "INPUT")
    word = line.word.upper()
    if word in outputs and (found := re.fullmatch(r"\s*=?\s*(?P<state>ON|OFF)\s*;?", line.values, re.I)):
        put = f"SET {line.word} {found['state']}"
        return line.guess(
            line.begin, len(line.bare), f"{line.word} is an output, which SET sets", put, f"write {put}"
        )
    if word == "SET":
        found = re.fullmatch(
            r"\s+(?P<all>(?P<state>ON|OFF)\s*,?\s*(?P<name>[A-Za-z_]\w*))", line.values, re.I
        )
        if found and found["name"].upper() in outputs:
            put, at = f"{found['name']} {found['state']}", line.behind + found.start("all")
            return line.guess(
                at, len(line.bare), "SET needs the output first, then its state", put, f"write SET {put}"
            )
    if word in ("SET", "WAIT", "PULSE", "WHEN") and (
        found := re.match(
            r"\s+(?P<name>[A-Za-z_]\w*)(?P<sign>\s*,)\s*(?P<state>ON|OFF|TRUE|FALSE|[01])\b",
            line.values,
            re.I,
        )
    ):
        state = _STATES.get(found["state"].upper()) or {"0": "OFF", "1": "ON"}.get(
            found["state"], found["state"]
        )
        at, end = line.behind + found.start("sign"), line.behind + found.end()
        repaired = f"{line.text[: line.behind + found.end('name')]} {state}{line.text[end:]}"
        help_ = f"write {word} {found['name']} {state}"
        return Guess(at, at + len(found["sign"]), f"no comma is allowed in a {word}", help_, repaired)
    if (
        word in ("WHEN", "WHILE", "UNTIL")
        and (
            found := re.fullmatch(
                r"\s+(?P<name>[A-Za-z_]\w*)(?P<sign>\s*=\s*|\s+)(?P<state>TRUE|FALSE|HIGH|LOW)",
                line.values,
                re.I,
            )
        )
        and found["name"].upper() in inputs
    ):
        at = line.behind + found.start("state")
        message = f"`{found['state']}` is neither ON nor OFF"
        return line.guess(at, len(line.bare), message, _STATES[found["state"].upper()])
    if word == "STOP" and (found := re.fullmatch(r'\s+(?P<all>"[^"]*")', line.values)):
        help_ = (
            f"write SAY {found['all']} in the line before it, or ABORT {found['all']} if something is wrong"
        )
        return line.guess(line.behind + found.start("all"), len(line.bare), "STOP takes no text", None, help_)
    if word == "REGISTER" and (
        found := re.fullmatch(r"\s+(?P<name>[A-Za-z_]\w*)(?:\s*=\s*(?P<value>[0-9]+))?", line.values)
    ):
        begins = f", as REGISTER {found['name']} 0..9" + (f" {found['value']}" if found["value"] else "")
        at = line.behind + found.start("name")
        return line.guess(
            at,
            len(line.bare),
            f"the range of {found['name']} is missing",
            None,
            f"write it after the name{begins}",
        )
    if word == "WHEN" and (found := re.fullmatch(r"\s+(?P<name>[A-Za-z_]\w*)", line.values)):
        name, at = found["name"], line.behind + found.start("name")
        if name.upper() in inputs:
            return line.guess(
                at,
                len(line.bare),
                f"the state of {name} is missing",
                None,
                f"write WHEN {name} ON, or WHEN {name} OFF",
            )
    return None


def rounds(line: Line) -> Guess | None:
    """Recognise a REPEAT that counts like a loop of another language."""
    if line.word.upper() != "REPEAT":
        return None
    found = re.fullmatch(
        r"\s++(?P<all>(?P<name>[A-Za-z_]\w*+)?(?:\s*+(?:=|FROM))?(?:\s*+(?P<first>[0-9]++))?(?:\s*+TO\s++"
        r"(?P<last>[0-9]++))?(?:\s*+(?:TIMES|X))?(?:\s*+DO)?)",
        line.values,
        re.I,
    )
    if found is None or not found["first"] or re.fullmatch(r"(?:\w+\s+)?[0-9]+", found["all"].strip()):
        return None
    count = int(found["last"]) - int(found["first"]) + 1 if found["last"] else int(found["first"])
    name, at = found["name"], line.behind + found.start("all")
    put = f"REPEAT {name or 'I'} {count}"
    help_ = f"write {put}: ${name or 'I'} counts from 0" + (
        "" if name else f", or REPEAT {count} without a name"
    )
    return line.guess(at, len(line.bare), "REPEAT takes only the number of rounds", None, help_)


def _named(line: Line, kind: str) -> frozenset[str]:
    return frozenset(one.upper() for one in line.around.declared.get(kind, ()))
