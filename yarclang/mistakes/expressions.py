"""Recognise sums and functions without `$()`, and dollar signs with a blank before the name."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line
from yarclang.syntax.words import FUNCTIONS

_TERM = r"(?:\$?[A-Za-z_][A-Za-z0-9_]*|[0-9]+(?:\.[0-9]*)?)"
_BEHIND_DOLLAR = re.compile(rf"(?<=\s)\$(?P<sum>[A-Za-z_]\w*(?:\s+[-+*/]\s+{_TERM}|[-+*/]{_TERM})+)(?=\s|$)")
_APART = re.compile(r"(?<=\s)\$\s+(?P<name>[A-Za-z_]\w*)(?=\s|$)")
_QUOTIENT = re.compile(r"(?<=\s)(?P<sum>[-+]?[0-9]+(?:\.[0-9]*)?(?:[*/+][0-9]+(?:\.[0-9]*)?)+)(?=\s|$)")
_FUNCTION = re.compile(r"(?<=\s)(?P<name>[A-Za-z_]\w*)\((?P<inside>[^()]*)\)(?=\s|$)")
_TURNED = {"D2R": "deg", "RADIANS": "deg", "DEG2RAD": "deg", "R2D": "rad", "DEGREES": "rad", "RAD2DEG": "rad"}
_HEXADECIMAL = re.compile(r"(?<=\s)(?P<number>0[xX][0-9A-Fa-f]{1,8})(?=\s|$)")
_APART_UNIT = re.compile(
    r"(?<=\s)(?P<number>[-+]?[0-9]+(?:\.[0-9]*)?)\s(?P<unit>deg|rad|mm|cm|m)(?=\s|$)", re.I
)


def sum_(line: Line) -> Guess | None:
    """Recognise arithmetic that isn't written as `$(...)`."""
    if not line.is_motion:
        return None
    begin = line.behind
    if found := _BEHIND_DOLLAR.search(line.bare, begin):
        put = f"$({found['sum'].replace('$', '')})"
        if re.search(r"\s-\s", found[0]):
            apart = re.sub(r"\s-\s+", " -", found[0])
            help_ = f"write {put} for one value, or {apart} for several"
            return line.guess(
                found.start(),
                found.end(),
                f"`{found[0]}` can be read as one value or as several",
                None,
                help_,
            )
        return line.guess(found.start(), found.end(), f"`{found[0]}` needs brackets around the sum", put)
    if found := _APART.search(line.bare, begin):
        return line.guess(
            found.start(), found.end(), "`$` must directly precede its name", f"${found['name']}"
        )
    if found := _QUOTIENT.search(line.bare, begin):
        put = f"$({found['sum']})"
        return line.guess(
            found.start(), found.end(), f"`{found['sum']}` is not a number: a sum must be in $()", put
        )
    if found := _HEXADECIMAL.search(line.bare, begin):
        help_ = f"numbers are decimal: {found['number']} is {int(found['number'], 16)}"
        return line.guess(found.start(), found.end(), f"`{found['number']}` is not a number", None, help_)
    if found := _APART_UNIT.search(line.bare, begin):
        return _with_unit(line, found)
    found = _FUNCTION.search(line.bare, begin)
    if found is None:
        return None
    name, shown = found["name"].upper(), f"{found['name']}({found['inside']})"
    if name in FUNCTIONS:
        help_ = f"write ${{}}({name}({found['inside']}))".replace("{}", "")
        put = f"$({name}({found['inside']}))"
        return line.guess(
            found.start(), found.end(), f"`{shown}` is not a number: a function must be in $()", put, help_
        )
    if unit := _TURNED.get(name):
        help_ = f"write {found['inside']}, and ({unit}) after the motion time"
        if line.units.get("angle") == unit:
            help_ = f"write {found['inside']}: the line's angles are in {unit}"
        return line.guess(
            found.start(),
            found.end(),
            f"`{shown}` is not a number: units are written in brackets",
            None,
            help_,
        )
    return None


def _with_unit(line: Line, found: re.Match[str]) -> Guess | None:
    from yarclang.units import UNITS

    number, unit = found["number"], found["unit"].lower()
    here = line.units.get(UNITS[unit].kind)
    message = f"`{found[0]}` is not a number: units are written in brackets, one for all values of their kind"
    if here == unit:
        return line.guess(
            found.start(),
            found.end(),
            message,
            number,
            f"write {number}; the line already has the unit {unit}",
        )
    help_ = f"write {number}, and ({unit}) after the motion time" + (f" instead of {here}" if here else "")
    return line.guess(found.start(), found.end(), message, None, help_)
