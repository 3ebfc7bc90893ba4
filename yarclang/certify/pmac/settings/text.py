"""What a settings text says, as the judge reads it. Numbers are exact."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from yarclang.frozen import frozen


@frozen
class Number:
    """A printed number: its value, and what 1 in its last digit is worth."""

    value: Fraction
    step: Fraction


@frozen
class Definition:
    """The axis definition of a motor: counts by axis, and the offset, in `line` (from 1); `terms` as they are printed."""

    line: int
    motor: int
    terms: str
    counts: Mapping[str, Number]
    offset: Number


@frozen
class Pointer:
    """An M-variable and the register that it stands for."""

    line: int
    variable: str
    address: str


@frozen
class Setting:
    """An I-variable: its value, as it is printed too, and the remark after it."""

    line: int
    name: str
    printed: str
    value: Fraction
    remark: str


@frozen
class Listing:
    """A PLC: its number, and its statements from `line` on. `places` are the lines in the text of the statements."""

    number: int
    statements: tuple[str, ...]
    places: tuple[int, ...]


@frozen
class SettingsText:
    """Everything that the text tells the controller, in order. `settings` are by their names, I5 the last."""

    definitions: tuple[Definition, ...]
    pointers: tuple[Pointer, ...]
    settings: Mapping[str, Setting]
    feedback: Listing
    guard: Listing
