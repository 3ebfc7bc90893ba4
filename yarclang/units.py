"""The units of the language and their factors to SI."""

from __future__ import annotations

import math
from typing import Literal

from yarclang.frozen import frozen

Kind = Literal["length", "angle", "time"]


@frozen
class Unit:
    """A unit of measurement.

    Attributes:
        name: name of the unit, such as `mm`.
        kind: length, angle or time.
        factor: factor from the unit to m, rad or s.
    """

    name: str
    kind: Kind
    factor: float


UNITS: dict[str, Unit] = {
    unit.name: unit
    for unit in (
        Unit("mm", "length", 1e-3),
        Unit("cm", "length", 1e-2),
        Unit("m", "length", 1.0),
        Unit("um", "length", 1e-6),
        Unit("in", "length", 0.0254),
        Unit("deg", "angle", math.pi / 180.0),
        Unit("rad", "angle", 1.0),
        Unit("s", "time", 1.0),
        Unit("ms", "time", 1e-3),
        Unit("min", "time", 60.0),
    )
}

MM = UNITS["mm"].factor
DEG = UNITS["deg"].factor
MS = UNITS["ms"].factor


def units_of(kind: Kind) -> tuple[str, ...]:
    """Return the names of the units of a kind, in the order of the table."""
    return tuple(unit.name for unit in UNITS.values() if unit.kind == kind)


def number_text(value: float, digits: int) -> str:
    """Return a number without needless zeros, and without a minus sign before zero.

    Args:
        value: the number.
        digits: number of decimal places; a negative number rounds to tens, hundreds and so on.
    """
    text = f"{round(value, digits) + 0.0:.{max(digits, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
