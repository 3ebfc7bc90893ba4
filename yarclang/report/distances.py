"""Describe the proved distances of a command in words."""

from __future__ import annotations

from yarclang.certify.certificate import Clearance, CommandCertificate, ZoneSpeed
from yarclang.certify.outward import down, least, most, up
from yarclang.units import MM


def distances_of(command: CommandCertificate) -> tuple[tuple[str, str], ...]:
    """Return the proved distances of a command, and its proved speeds in slow zones, as pairs of a name
    and a text.
    """
    distances = [
        (name, distance_text(clearance))
        for name, clearance in (
            ("clearance to the cell", command.clearance),
            ("clearance of itself", command.own_clearance),
            ("distance from zones' borders", command.zone_clearance),
        )
        if clearance is not None
    ]
    if command.zone_speed is not None:
        name = "speed below its ceiling" if command.zone_speed.of_motion else "speed in slow zones"
        distances.append((name, _speed_text(command.zone_speed)))
    return tuple(distances)


def distance_text(clearance: Clearance) -> str:
    """Return a proved distance in words: `at least 12.3 mm (FINGERS, BENCH), nearest at 1.250 s`."""
    between = f" ({clearance.first}, {clearance.second})" if clearance.first else ""
    return f"at least {whole_tenths(clearance.distance)} mm{between}{when_text(clearance, ', nearest')}"


def when_text(clearance: Clearance, word: str = "") -> str:
    """Return the time from a command's start at which bodies are nearest, in words and preceded by `word`;
    empty if the time is unknown.
    """
    return "" if clearance.at is None else f"{word} at {clearance.at:.3f} s"


def whole_tenths(distance: float) -> str:
    """Return a distance [m] in mm with one decimal. It is rounded down, so that the printed distance is
    also proved.
    """
    return down(least(distance, MM), 1)


def _speed_text(speed: ZoneSpeed) -> str:
    where = "" if speed.of_motion else f" in {speed.zone}"
    return (
        f"{speed.part} at most {up(most(speed.largest, MM), 1)} mm/s{where}, where {speed.limit / MM:g} "
        "mm/s are allowed"
    )
