"""Recognise speeds and blend zones written after the values, as in other languages."""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line

_SPEED = re.compile(
    r"(?<=\s)(?P<all>(?:V|VEL|SPEED|F|FEED|OVERRIDE)\s*=?\s*(?P<value>[0-9]+(?:\.[0-9]*)?)(?P<share>\s*%)?"
    r"(?:\s*[A-Za-z]+/[A-Za-z]+)?)(?=\s|$)",
    re.I,
)
_ZONE = re.compile(r"(?:\s+[-+]?[0-9.]+){6,}\s+(?P<all>Z(?P<value>[0-9]+))(?=\s|$)", re.I)
_CORNER = re.compile(r"(?<=\s)(?P<all>(?:CNT|CR)[0-9]+|C_(?:DIS|PTP|VEL|ORI|SPL))(?=\s|$)", re.I)
_STOP = re.compile(r"(?<=\s)(?P<all>FINE|CNT0)(?=\s|$)", re.I)
_NEAR = re.compile(r"(?<=\s)NEAR\s+(?P<all>[\[({][^\])}]*[\])}]|[-+0-9.][-+0-9.\s]*)", re.I)


def behind(line: Line) -> Guess | None:
    """Recognise a speed without brackets, a blend zone, and joint values after NEAR."""
    if not line.is_motion:
        return None
    begin = line.behind
    if (found := _SPEED.search(line.bare, begin)) and "[" not in line.bare:
        share = bool(found["share"])
        put = f"[{found['value']}%]" if share else f"[V {found['value']}]"
        help_ = f"write {put}" + ("" if share else f" for the speed of the moving frame in {_rate(line)}")
        return _told(line, found, "a speed must be in square brackets", help_)
    if found := _STOP.search(line.bare, begin):
        return _told(
            line, found, f"`{found['all']}` is no option", "remove it: a motion without BLEND ends at rest"
        )
    if found := _CORNER.search(line.bare, begin):
        help_ = "write BLEND 10 and the corner's size, as a length or an angle in the line's units"
        return _told(line, found, f"`{found['all']}` is no option", help_)
    if found := _ZONE.search(line.bare, begin):
        help_ = (
            f"write BLEND {found['value']} for a corner of {found['value']} {line.units.get('length', 'mm')}"
        )
        return _told(line, found, f"`{found['all']}` is no option", help_)
    if found := _NEAR.search(line.bare, begin):
        help_ = "declare them, as JOINTS CLOSE 0 10 0 0 -30 0 (deg), and write NEAR CLOSE"
        return _told(line, found, "NEAR needs the name of a joint position", help_)
    return None


def _told(line: Line, found: re.Match[str], message: str, help_: str) -> Guess:
    return line.guess(found.start("all"), found.end("all"), message, None, help_)


def _rate(line: Line) -> str:
    return f"{line.units.get('length', 'mm')}/{line.units.get('time', 's')}"
