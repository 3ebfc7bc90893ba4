"""Recognise names of places in braces or quotes or after TO, and waypoints on lines of their own."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_NAMED = re.compile(
    r"\s+(?P<all>\{\s*(?P<braces>[A-Za-z_]\w*)\s*\}|[\"'](?P<quotes>[A-Za-z_]\w*)[\"']|\(\s*"
    r"(?P<round>[A-Za-z_]\w*)\s*\)|(?P<to>TO)\s+(?P<name>[A-Za-z_]\w*))(?P<rest>\s*[;\[(].*|\s*)",
    re.I,
)
_VALUE = r"[-+]?[0-9.]+"
_ALONE = re.compile(rf"\s*(?P<all>{_VALUE}(?:\s+{_VALUE}){{2,}})\s*;?\s*(?:[\[(].*)?")
_COMMA = re.compile(rf"(?<=[0-9.])\s*(?P<comma>,)\s+(?={_VALUE})")


def named(line: Line) -> Guess | None:
    """Recognise the name of a joint position or pose in braces, quotes or brackets, or after TO."""
    found = _NAMED.fullmatch(line.values) if line.is_motion else None
    if found is None:
        return None
    name = next(one for one in (found["braces"], found["quotes"], found["round"], found["name"]) if one)
    if name.upper() not in _known(line):
        return None
    at, end = line.behind + found.start("all"), line.behind + found.end("all")
    if found["to"]:
        end = line.behind + found.start("name")
        repaired = f"{line.text[:at]}{line.text[end:]}"
        message = f"`{found['to']}` isn't allowed before {name}"
        return Guess(at, at + len(found["to"]), message, f"write {line.word} {name}", repaired)
    marks = "braces" if found["braces"] else "quotes" if found["quotes"] else "brackets"
    return line.guess(
        at, end, f"{name} is a joint position or pose: its name is written without {marks}", name
    )


def several(line: Line) -> Guess | None:
    """Recognise several names after a motion to a single place."""
    found = re.fullmatch(
        r"\s+(?P<all>(?P<one>[A-Za-z_]\w*)(?P<others>(?:\s*,\s*|\s+)[A-Za-z_]\w*)+)\s*(?:[\[(].*)?",
        line.values,
    )
    if found is None or not line.is_motion:
        return None
    names = re.findall(r"[A-Za-z_]\w*", found["all"])
    if not all(name.upper() in _known(line) for name in names):
        return None
    help_ = (
        f"write {line.word} {names[0]}, then {line.word} {names[1]} in the next line; a MOVEJ_SPLINE has "
        "`;` between them"
    )
    at = line.behind + found.start("all")
    return line.guess(at, at + len(found["all"]), f"{line.word} takes only one target", None, help_)


_AXIS = re.compile(
    r"\s+(?P<all>\{?\s*(?P<axis>[XYZ])\s*[=:]?\s*(?P<value>[-+]?[0-9.]+)\s*\}?)(?=\s*(?:[\[({]|$))", re.I
)


def along(line: Line) -> Guess | None:
    """Recognise a DMOVE with a single value and the name of its axis."""
    found = _AXIS.match(line.values) if line.word.upper() == "DMOVE" else None
    if found is None:
        return None
    way = ["0"] * 6
    way["XYZ".index(found["axis"].upper())] = found["value"]
    at, end = line.behind + found.start("all"), line.behind + found.end("all")
    help_ = f"write DMOVE {' '.join(way)}: X Y Z roll pitch yaw"
    return line.guess(
        at, end, "a relative motion needs all six values, without the names of axes", None, help_
    )


def _known(line: Line) -> set[str]:
    declared = line.around.declared
    return {"HOME", *(one.upper() for kind in ("JOINTS", "POSE") for one in declared.get(kind, ()))}


def apart(line: Line) -> Guess | None:
    """Recognise a waypoint on a line of its own, and a comma between waypoints."""
    if line.is_motion and ("MOVEC" in line.word.upper() or "SPLINE" in line.word.upper()):
        commas = list(_COMMA.finditer(line.bare, line.behind))
        if len(commas) == 1:
            found = commas[0]
            repaired = f"{line.text[: found.start()]}; {line.text[found.end() :]}"
            message = "waypoints are separated by semicolons"
            return Guess(
                found.start("comma"), found.end("comma"), message, "write `;` instead of the comma", repaired
            )
    alone = _ALONE.fullmatch(line.bare)
    if alone is None or line.number == 1:
        return None
    before = line.around.before(line.number)
    if not re.match(r"\s*(?:P[0-9]+\s+)?MOVE(?:C|[A-Z]_SPLINE)", before, re.I):
        return None
    message = "waypoints that go on in the next line need a `;` at the end of the line before"
    return line.guess(
        alone.start("all"),
        alone.end("all"),
        message,
        None,
        "write `;` at the end of the line above, or these values there",
    )
