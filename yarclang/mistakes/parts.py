"""Recognise times, units, frames and options of a command in wrong brackets, in the wrong order, or twice."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line, is_number, is_thousand, only
from yarclang.syntax.words import OPTIONS, STATES
from yarclang.units import UNITS

_TIME = re.compile(
    r"(?<!BLEND)(?<!TOL)(?<!ACC)\s(?P<time>\(\s*(?P<round>[0-9.]+%?|MIN)\s*\)|<\s*(?P<angle>[0-9.]+)\s*>"
    r"|[Tt]\s*=\s*(?P<equals>[0-9.]+))(?=\s|$)"
)
_BARE = re.compile(r"\s(?P<bare>[0-9.]+%|MIN)(?=\s|$)")
_INSIDE = re.compile(r"\[\s*(?P<inside>[^\]\[]*?)\s*\]")
_SECONDS = re.compile(r"(?P<number>[0-9.]+)\s*(?P<unit>[A-Za-z]+)")
_SPEED = re.compile(
    r"(?:[Vv]\s*=?\s*(?P<value>[0-9.]+)\s*(?P<unit>[A-Za-z]+\s*/\s*[A-Za-z]+)?|(?P<alone>[0-9.]+)\s*"
    r"(?P<per>[A-Za-z]+\s*/\s*[A-Za-z]+))"
)
_BARE_SECONDS = re.compile(
    r"(?<=\s)(?P<all>(?:(?:in|for|time)\s+)?(?P<number>[0-9.]+)\s*(?P<unit>s|ms|sec|secs|seconds?))(?=\s|$)",
    re.I,
)
_EARLY = r"(?:\{\s*\w+\s*\}|\([A-Za-z, ]+\)|(?:BLEND|TOL|ACC)\s+[0-9.]+|NEAR\s+[A-Za-z_]\w*)"
_ORDER = re.compile(rf"(?P<early>{_EARLY}(?:\s*{_EARLY})*)\s*(?P<time>\[[^\]]*\])", re.I)
_BRACKETED_OPTION = re.compile(
    r"(?<=\s)(?P<word>BLEND|TOL|ACC)\s*(?:\[\s*(?P<square>[0-9.]+)\s*\]|\(\s*(?P<round>[0-9.]+)\s*\))", re.I
)
_BOTH_FRAMES = re.compile(
    r"\s+(?P<moving>\{\s*\w+\s*\})\s*(?P<base>\{\s*\w+\s*\})(?P<values>(?:\s+[-+$0-9.][^\s\[({;]*)+)(?=\s|$)"
)
_UNITS_ELSEWHERE = re.compile(
    r"(?<=\s)(?P<open>[\[{(]?)\s*(?P<units>[A-Za-z]+(?:\s*[,;]\s*[A-Za-z]+)+)\s*(?P<close>[\]})]?)(?=\s|$)"
)
_UNITS_APART = re.compile(r"\((?P<units>[A-Za-z]+(?:[\s;/]+[A-Za-z]+)+)\)")
_UNIT_LIST = re.compile(r"\((?P<units>[A-Za-z]+(?:\s*,\s*[A-Za-z]+)*)\)")
_ELSEWHERE = re.compile(r"\{\s*(?P<name>WORLD0?|BASE0?|ROBROOT|ROBOT|WOBJ0|TOOL0?)\s*\}", re.I)
_SQUARE_FRAME = re.compile(r"\[\s*(?P<name>[A-Za-z_][A-Za-z0-9_]*)\s*\]")
_ROUND_FRAME = re.compile(r"\(\s*(?P<name>[A-Za-z_][A-Za-z0-9_]*)\s*\)")
_OPTION = re.compile(r"(?<=\s)(?P<word>[A-Za-z]{3,})(?P<rest>\s*=\s*|\s+)(?P<value>[0-9][0-9.]*)(?=\s|$)")
_FRAMES = ("TCP", "FLANGE", "B")
_NAMES_OF_UNITS = {
    "degree": "deg", "degrees": "deg", "degs": "deg", "grad": "deg", "radian": "rad", "radians": "rad",
        "rads": "rad",
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "millisecond": "ms",
        "milliseconds": "ms",
    "millimeter": "mm", "millimeters": "mm", "millimetre": "mm", "millimetres": "mm", "mms": "mm",
        "meter": "m", "meters": "m",
    "metre": "m", "metres": "m", "centimeter": "cm", "centimeters": "cm", "centimetre": "cm",
        "centimetres": "cm",
    "inch": "in", "inches": "in", "minute": "min", "minutes": "min", "mins": "min",
}  # fmt: skip


def time(line: Line) -> Guess | None:
    """Recognise a motion time in other brackets or without any, or with a unit in it."""
    if not line.is_command:
        return None
    if line.is_motion and (found := _TIME.search(line.bare, line.behind)):
        value = found["round"] or found["angle"] or found["equals"]
        return line.guess(
            found.start("time"), found.end("time"), "a motion time must be in square brackets", f"[{value}]"
        )
    if line.is_motion and (found := _BARE.search(line.bare, line.behind)) and "[" not in line.bare:
        return line.guess(
            found.start("bare"),
            found.end("bare"),
            "a motion time must be in square brackets",
            f"[{found['bare']}]",
        )
    if line.is_motion and "[" not in line.bare and (found := _BARE_SECONDS.search(line.bare, line.behind)):
        return _with_unit(line, found.start("all"), found.end("all"), found)
    found = _INSIDE.search(line.bare, line.behind)
    if found is None:
        return None
    inside, begin, end = found["inside"], found.start(), found.end()
    if re.fullmatch(r"[0-9]+,[0-9]+", inside):
        value = inside.replace(",", ".")
        at = found.start("inside")
        if is_thousand(inside):
            help_ = f"write {inside.replace(',', '')}, or {value}"
            return line.guess(
                at,
                at + len(inside),
                f"`{inside}` is not a number: digits are written without commas",
                None,
                help_,
            )
        return line.guess(at, at + len(inside), f"`{inside}` is not a number: write a decimal point", value)
    if (speed := _SPEED.fullmatch(inside)) and inside.split() != ["V", speed["value"]]:
        per, value = speed["unit"] or speed["per"], speed["value"] or speed["alone"]
        if (
            per
            and line.units
            and "/".join((line.units.get("length", ""), line.units.get("time", "")))
            != re.sub(r"\s", "", per).lower()
        ):
            return line.guess(
                begin,
                end,
                "a speed is written without its unit: the units are in brackets after it, and here they "
                f"are ({_units(line)})",
                None,
                f"write [V {value}] in these units",
            )
        return line.guess(
            begin,
            end,
            "a speed is written [V 250]: V, a blank and the number; its units are those of the line"
            if per
            else "a speed is written as V, a blank and a number",
            f"[V {value}]",
        )
    if (seconds := _SECONDS.fullmatch(inside)) and UNITS.get(seconds["unit"].lower()) is not None:
        return _with_unit(line, begin, end, seconds)
    return None


def _with_unit(line: Line, begin: int, end: int, found: re.Match[str]) -> Guess | None:
    written = found["unit"].lower()
    unit, here = UNITS[_NAMES_OF_UNITS.get(written, written)], line.units.get("time")
    if unit.kind != "time" or not is_number(found["number"]):
        return None
    message = "a motion time is a number without its unit: the units are in brackets after it"
    if here is None:
        return line.guess(begin, end, message, f"[{found['number']}] ({unit.name})")
    value = f"{float(found['number']) * unit.factor / UNITS[here].factor:.9g}"
    return line.guess(begin, end, f"{message}, and here they are ({_units(line)})", f"[{value}]")


def order(line: Line) -> Guess | None:
    """Recognise a time after units or the base frame, a second time, and an option before the values."""
    if not line.is_command:
        return None
    if line.is_motion and (found := _BRACKETED_OPTION.search(line.bare, line.behind)):
        word = found["word"].upper()
        put = f"{word} {found['square'] or found['round']}"
        message = f"the value of {word} takes no brackets"
        if found["square"] and line.bare.count("[") == 1:
            # The brackets may be meant as the motion time, while the value of the option is missing.
            help_ = (
                f"write {put}; or, if {found['square']} is the time, [{found['square']}] before {word} and "
                "a value after it"
            )
            return line.guess(found.start(), found.end(), message, None, help_)
        return line.guess(found.start(), found.end(), message, put)
    if line.is_motion and (found := _BOTH_FRAMES.match(line.values)):
        at, base = line.behind + found.start("base"), found["base"]
        put = f"{found['values'].strip()} {base}"
        if "[" in line.values[found.end() :] or "(" in line.values[found.end() :]:
            return line.guess(
                at,
                at + len(base),
                f"{base} must be after values, time and units",
                None,
                f"move {base} there: only the moving frame is written before the values",
            )
        return line.guess(
            at, line.behind + found.end(), f"{base} is the base frame: it must be after the values", put
        )
    times = [one for one in _INSIDE.finditer(line.bare, line.behind) if not _is_name(one["inside"])]
    if len(times) > 1:
        one = times[1]
        return line.guess(
            one.start(),
            one.end(),
            f"{one[0]} is a second motion time: a command has only one",
            None,
            f"remove {times[0][0]} or {one[0]}",
        )
    if found := _ORDER.search(line.bare, line.behind):
        before = line.bare[line.behind : found.start()]
        if not before.strip():
            return None
        early, motion_time = found["early"], found["time"]
        return line.guess(
            found.start(),
            found.end(),
            f"{motion_time} must be before units, base frame and options, not after {early}",
            f"{motion_time} {early}",
        )
    if found := re.match(
        r"\s+(?P<option>NEAR\s+[A-Za-z_]\w*|BLEND\s+[0-9.]+|TOL\s+[0-9.]+)(?=\s)", line.values, re.I
    ):
        name = found["option"].split()[0].upper()
        return line.guess(
            line.behind + found.start("option"), line.behind + found.end("option"),
                f"{name} isn't allowed before the values", None,
            f"write {found['option']} after values, time and units: options come last",
        )  # fmt: skip
    return None


def _is_name(text: str) -> bool:
    return text.upper() != "MIN" and re.fullmatch(r"[A-Za-z_]\w*", text) is not None


def units(line: Line) -> Guess | None:
    """Recognise units without commas or in other brackets, and full names of units."""
    if found := _UNITS_APART.search(line.bare, line.begin):
        names = re.split(r"[\s;/]+", found["units"])
        if all(name.lower() in UNITS for name in names):
            if "/" in found["units"] and line.word.upper() == "LET":
                begin = len(line.bare[: found.start()].rstrip())
                message = "a speed is a plain number, whose units are those of its motion"
                help_ = "remove them, and write [V $NAME] and the units in the motion"
                return line.guess(begin, found.end(), message, "", help_)
            return line.guess(
                found.start(), found.end(), "units are separated by commas", f"({','.join(names)})"
            )
    for found in _UNITS_ELSEWHERE.finditer(line.bare, line.behind):
        names = re.split(r"\s*[,;]\s*", found["units"])
        if (found["open"] != "(" or ";" in found["units"]) and all(name.lower() in UNITS for name in names):
            put = f"({','.join(names)})"
            return line.guess(
                found.start(), found.end(), "units must be in round brackets, separated by commas", put
            )
    for found in _UNIT_LIST.finditer(line.bare, line.begin):
        for part in re.finditer(r"[A-Za-z]+", found["units"]):
            meant = _NAMES_OF_UNITS.get(part[0].lower())
            if meant is not None:
                at = found.start("units")
                return line.guess(
                    at + part.start(), at + part.end(), f"`{part[0]}` is no unit", meant, f"write `{meant}`"
                )
    return None


def frame(line: Line) -> Guess | None:
    """Recognise a frame in wrong brackets or without any, and frame names of other languages."""
    names = {name.upper(): name for name in (*_FRAMES, *line.around.declared.get("FRAME", ()))}
    if line.word.upper() in ("FRAME", "FRAME_QUAT"):
        found = re.match(r"\s+(?P<name>[A-Za-z_][A-Za-z0-9_]*)(?=\s)", line.values)
        if found is None:
            return None
        at = line.behind + found.start("name")
        return line.guess(
            at, at + len(found["name"]), "the name of a frame must be in braces", f"{{{found['name']}}}"
        )
    if not line.is_motion:
        return None
    if (found := _ELSEWHERE.search(line.bare, line.behind)) and found["name"].upper() not in names:
        meant = (
            "{TCP}, or {FLANGE} without a tool"
            if "TOOL" in found["name"].upper()
            else "{B}, the robot's base"
        )
        return line.guess(found.start(), found.end(), f"no frame is named {found[0]}", None, f"write {meant}")
    if (found := _SQUARE_FRAME.search(line.bare, line.behind)) and found["name"].upper() in names:
        put = f"{{{names[found['name'].upper()]}}}"
        return line.guess(found.start(), found.end(), "the name of a frame must be in braces", put)
    found = _ROUND_FRAME.search(line.bare, line.behind)
    if found is not None and found["name"].upper() in names and found["name"].lower() not in UNITS:
        return line.guess(
            found.start(),
            found.end(),
            "the name of a frame must be in braces",
            f"{{{names[found['name'].upper()]}}}",
        )
    for found in re.finditer(r"(?<=\s)[A-Za-z_][A-Za-z0-9_]*(?=\s|$)", line.bare[line.behind :]):
        name = found[0].upper()
        if name in names and not (line.bare[: line.behind + found.start()].rstrip().upper().endswith("NEAR")):
            at = line.behind + found.start()
            alone = not re.search(r"[0-9]", line.values)
            return line.guess(
                at, at + len(name), f"the name of a frame must be in braces, as {{{names[name]}}}",
                None if alone else f"{{{names[name]}}}",
                f"write 0 0 0 0 0 0 {{{names[name]}}} to go where the frame is" if alone else "",
            )  # fmt: skip
    return None


def option(line: Line) -> Guess | None:
    """Recognise a mistyped option, one with an equals sign, and BLEND without a value."""
    if not line.is_motion:
        return None
    if found := re.search(r"(?<=\s)(?P<word>BLEND)\s*$", line.bare, re.I):
        return line.guess(
            found.start(),
            found.end("word"),
            "BLEND needs a length or an angle",
            None,
            "write BLEND 5, with a length or an angle in the line's units",
        )
    for found in _OPTION.finditer(line.bare, line.behind):
        word = found["word"].upper()
        meant = word if word in OPTIONS else only(word, OPTIONS)
        if not meant or (word == meant and "=" not in found["rest"]) or word in STATES:
            continue
        if "=" in found["rest"]:
            return line.guess(
                found.start(), found.end(), f"{meant} takes no equals sign", f"{meant} {found['value']}"
            )
        return line.guess(found.start(), found.end("word"), f"`{found['word']}` is no option", meant)
    return None


def bracket(line: Line) -> Guess | None:
    """Recognise a bracket without its counterpart, if only one place is likely for it."""
    pairs = {"[": "]", "(": ")", "{": "}"}
    open_: list[int] = []
    in_text = False
    for at, sign in enumerate(line.bare):
        if sign == '"':
            in_text = not in_text
        elif in_text:
            continue
        elif sign in pairs:
            open_.append(at)
        elif sign in "])}":
            if not open_:
                return None
            meant = pairs[line.bare[open_[-1]]]
            if sign != meant:
                return line.guess(at, at + 1, f"`{line.bare[open_[-1]]}` is closed by `{sign}`", meant)
            open_.pop()
    if len(open_) != 1:
        return None
    at, sign = open_[0], line.bare[open_[0]]
    rest = line.bare[at + 1 :]
    simple = {
        "[": r"\s*(?:[0-9.]+%?|MIN|V\s+[0-9.]+)",
        "{": r"\s*[A-Za-z_]\w*",
        "(": r"\s*[A-Za-z]+(?:\s*,\s*[A-Za-z]+)*",
    }
    if not (found := re.match(simple[sign], rest, re.I)):
        return None
    end = at + 1 + found.end()
    repaired = line.text[:end] + pairs[sign] + line.text[end:]
    return Guess(at, at + 1, f"this `{sign}` is not closed", f"close it with `{pairs[sign]}`", repaired)


def _units(line: Line) -> str:
    return ",".join(line.units.values())
