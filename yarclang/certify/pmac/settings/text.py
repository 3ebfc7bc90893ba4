"""The content of a settings text, as the judge reads it, in exact numbers."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from yarclang.frozen import frozen


@frozen
class Number:
    """A printed number: its value, and the value of 1 in its last digit."""

    value: Fraction
    step: Fraction


@frozen
class Definition:
    """The axis definition of a motor.

    Attributes:
        line: number of the line in the text, from 1.
        motor: number of the motor.
        terms: the right side of the definition as printed.
        counts: counts per axis unit, by axis.
        offset: the offset [counts].
    """

    line: int
    motor: int
    terms: str
    counts: Mapping[str, Number]
    offset: Number


@frozen
class Pointer:
    """An M-variable and the register that it refers to."""

    line: int
    variable: str
    address: str


@frozen
class Setting:
    """An I-variable with its printed value, the exact value, and the remark after it."""

    line: int
    name: str
    printed: str
    value: Fraction
    remark: str


@frozen
class Listing:
    """A PLC (a program that the controller repeats) in the settings text.

    Attributes:
        number: number of the PLC.
        statements: the PLC's statements.
        places: the line of each statement in the text.
    """

    number: int
    statements: tuple[str, ...]
    places: tuple[int, ...]


@frozen
class SettingsText:
    """The content that a settings text sends to the controller, in order. `settings` are keyed by name; I5 is
    the last one.
    """

    definitions: tuple[Definition, ...]
    pointers: tuple[Pointer, ...]
    settings: Mapping[str, Setting]
    feedback: Listing
    guard: Listing
