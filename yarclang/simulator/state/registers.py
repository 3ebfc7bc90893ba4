"""I-, P-, Q- and M-variables, and the memory that M-variables point to."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass

from yarclang.pmac.defaults import HEXADECIMAL, SYSTEMS, VARIABLES, default_variables
from yarclang.pmac.errors import DATA
from yarclang.simulator.language.arithmetic import bounded
from yarclang.simulator.network.reply import Refusal

_WORD = 1 << 24
_ALL = _WORD - 1
_BIT_FIELD = re.compile(r"([XY]):\$?([0-9A-F]{1,6})(?:,(\d{1,2})(?:,(\d{1,2}))?(?:,([SU]))?)?$")
_WHOLE = re.compile(r"(DP|D|F|L):\$?([0-9A-F]{1,6})$")

Read = Callable[[], float]
ReadBits = Callable[[int], float]
"""Function that returns the value of a register. Its argument has the bits that the caller needs; all other
bits of the returned value may be 0.
"""
Write = Callable[[float], None]


@dataclass(frozen=True, slots=True)
class Definition:
    """The register to which an M-variable points.

    Attributes:
        kind: kind of memory: X, Y, D, DP, F, L, or * for a variable with its own value.
        address: address of the register.
        offset: number of the first bit, for X and Y.
        width: number of bits, for X and Y.
        signed: True for a signed value, for X and Y.
    """

    kind: str = "*"
    address: int = 0
    offset: int = 0
    width: int = 24
    signed: bool = False

    @property
    def text(self) -> str:
        """The definition as the controller reports it."""
        if self.kind == "*":
            return "*"
        place = f"{self.kind}:${self.address:06X}"
        if self.kind not in "XY":
            return place
        if (self.offset, self.width) == (0, 24):
            return place + (",24,S" if self.signed else ",24")
        return f"{place},{self.offset}" + (f",{self.width}" if self.width != 1 else "") + ",S" * self.signed


def definition(text: str) -> Definition:
    """Parse the definition of an M-variable, which is the text after `M1->`. An offset without a width means
    one bit.

    Raises:
        Refusal: ERR003 if the text isn't a definition.
    """
    if text == "*":
        return Definition()
    if match := _WHOLE.match(text):
        return Definition(match[1], int(match[2], 16))
    match = _BIT_FIELD.match(text)
    if not match:
        raise Refusal(DATA)
    kind, address, offset, width, sign = match.groups()
    if width is None and offset in (None, "24"):
        return Definition(kind, int(address, 16), 0, 24, sign == "S")
    field = Definition(kind, int(address, 16), int(offset), int(width or 1), sign == "S")
    if field.width < 1 or field.offset + field.width > 24:
        raise Refusal(DATA)
    return field


class Memory:
    """The controller's memory: 24-bit words. Some words show the controller's state ("wired").

    A word that isn't wired is plain memory. In plain memory, tests can read outputs and set inputs.

    Attributes:
        words: values of plain words, by kind (X, Y) and address.
        wired: functions that return the values of wired registers, by kind and address.
        wired_writes: functions that write wired registers, by kind and address.
        floats: values of plain F and L registers, by address.
    """

    def __init__(self) -> None:
        self.words: dict[tuple[str, int], int] = {}
        self.wired: dict[tuple[str, int], ReadBits] = {}
        self.wired_writes: dict[tuple[str, int], Write] = {}
        self.floats: dict[int, float] = {}

    def read(self, at: Definition) -> float:
        """Return the value of the register to which an M-variable points."""
        key = (at.kind, at.address)
        read = self.wired.get(key)
        if at.kind in "XY":
            wanted = (1 << at.width) - 1
            word = self.words.get(key, 0) if read is None else int(read(wanted << at.offset))
            value = word >> at.offset & wanted
            return float(value - (1 << at.width) if at.signed and value >> (at.width - 1) else value)
        if read is not None:
            return float(read(_ALL))
        if at.kind in ("F", "L"):
            return self.floats.get(at.address, 0.0)
        value = self.words.get(("X", at.address), 0) * _WORD + self.words.get(("Y", at.address), 0)
        return float(value - _WORD * _WORD if value >= _WORD * _WORD // 2 else value)

    def write(self, at: Definition, value: float) -> None:
        """Write a value to the register to which an M-variable points. A register that only the controller
        sets keeps its value.
        """
        key = (at.kind, at.address)
        if key in self.wired_writes:
            self.wired_writes[key](value)
        elif key in self.wired:
            return
        elif at.kind in "XY":
            mask = (1 << at.width) - 1 << at.offset
            self._store(key, self.words.get(key, 0) & ~mask | math.floor(value) << at.offset & mask)
        elif at.kind in ("F", "L"):
            if len(self.floats) < 4 * VARIABLES or at.address in self.floats:
                self.floats[at.address] = value
        else:
            whole = math.floor(value)
            self._store(("X", at.address), whole >> 24 & (_WORD - 1))
            self._store(("Y", at.address), whole & (_WORD - 1))

    def _store(self, key: tuple[str, int], word: int) -> None:
        if word:
            self.words[key] = word
        else:
            self.words.pop(key, None)


class Variables:
    """All variables of the controller. Each coordinate system has its own Q-variables (assumed: their ranges
    don't overlap).

    Attributes:
        i: values of the I-variables. Motors and coordinate systems share this list.
        p: values of the P-variables.
        q: values of the Q-variables, by coordinate system.
        m: definitions of the M-variables.
        own: values of M-variables that don't point to memory.
        memory: the memory.
        timers: functions that read and write the I-variables that count down by themselves.
        lazy: variables that PLC 0 computes only when they are read.
        refresh: function that is called before a variable of `lazy` is read.
        on_i: function that is called with the number of each I-variable that is written.
    """

    def __init__(self) -> None:
        self.i: list[float] = []
        self.p: list[float] = []
        self.q: list[dict[int, float]] = []
        self.m: dict[int, Definition] = {}
        self.own: dict[int, float] = {}
        self.memory = Memory()
        self.timers: dict[int, tuple[Read, Write]] = {}
        self.lazy: frozenset[tuple[str, int]] = frozenset()
        self.refresh: Callable[[], None] = lambda: None
        self.on_i: Callable[[int], None] = lambda _number: None
        self._watching: dict[tuple[str, int], Callable[[float], None]] = {}
        self.initialise()

    def initialise(self) -> None:
        """Return to the state after `$$$***`."""
        # Keep the list object, which motors and coordinate systems share.
        self.i[:] = [0.0] * VARIABLES
        for number, value in default_variables().items():
            self.i[number] = value
        self.p = [0.0] * VARIABLES
        self.q = [{} for _ in range(SYSTEMS + 1)]
        self.m = {}
        self.own = {}
        self.memory.words.clear()
        self.memory.floats.clear()

    def scope(self, system: int) -> Seen:
        """Return the variables as a coordinate system sees them."""
        return Seen(self, system)

    def read(self, letter: str, index: int, system: int) -> float:
        """Return the value of a variable.

        Args:
            letter: I, P, Q or M.
            index: number of the variable.
            system: number of the coordinate system whose Q-variables are read.

        Raises:
            Refusal: ERR003 if there is no such variable.
        """
        if not 0 <= index < VARIABLES:
            raise Refusal(DATA)
        if self.lazy and (letter, index) in self.lazy:
            self.refresh()
        match letter:
            case "P":
                return self.p[index]
            case "I":
                return self.timers[index][0]() if index in self.timers else self.i[index]
            case "M":
                at = self.m.get(index)
                return self.own.get(index, 0.0) if at is None or at.kind == "*" else self.memory.read(at)
            case _:
                return self.q[system].get(index, 0.0)

    def watch(self, letter: str, index: int, callback: Callable[[float], None]) -> None:
        """Call `callback` with each value that is written to a variable, before it is stored."""
        self._watching[letter, index] = callback

    def write(self, letter: str, index: int, value: float, system: int) -> None:
        """Assign a value to a variable.

        Args:
            letter: I, P, Q or M.
            index: number of the variable.
            value: the value.
            system: number of the coordinate system whose Q-variables are written.

        Raises:
            Refusal: ERR003 if there is no such variable.
        """
        if not 0 <= index < VARIABLES:
            raise Refusal(DATA)
        value = bounded(value)
        if self._watching and (heard := self._watching.get((letter, index))) is not None:
            heard(value)
        match letter:
            case "P":
                self.p[index] = value
            case "I":
                self.i[index] = value
                if index in self.timers:
                    self.timers[index][1](value)
                self.on_i(index)
            case "M":
                at = self.m.get(index)
                if at is None or at.kind == "*":
                    self.own[index] = value
                else:
                    self.memory.write(at, value)
            case _:
                self.q[system][index] = value

    def shown(self, letter: str, index: int, value: float) -> str:
        """Return a value as it is reported. I9 bit 1 selects hexadecimal for addresses."""
        if letter == "I" and index in HEXADECIMAL and int(self.i[9]) & 2 and value >= 0:
            return f"${int(value):X}"
        return printed(value)


@dataclass(frozen=True, slots=True)
class Seen:
    """The variables as one coordinate system sees them."""

    variables: Variables
    system: int

    def read(self, letter: str, index: int) -> float:
        """Return the value of a variable."""
        return self.variables.read(letter, index, self.system)

    def write(self, letter: str, index: int, value: float) -> None:
        """Assign a value to a variable."""
        self.variables.write(letter, index, value, self.system)


def printed(value: float, decimals: int | None = None) -> str:
    """Return a value in decimal form, without an exponent. It has about 12 digits, the precision of the
    controller's real numbers.
    """
    if value % 1.0 == 0.0:
        return str(int(value))
    if decimals is not None:
        text = f"{value:.{decimals}f}"
    else:
        digits = max(0, min(15, 12 - math.ceil(math.log10(abs(value)))))
        text = f"{value:.{digits}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
