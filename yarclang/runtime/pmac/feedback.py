"""Parser of the reports that the controller sends while it moves: positions, following errors and status
words. No I/O.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.pmac.status import MOTOR_WORD_1, MOTOR_WORD_2, SYSTEM_WORD_1, SYSTEM_WORD_2
from yarclang.robot.model import Array

GROUP = 8
"""Number of motors that one ^P, ^F or ^B reports; `##n` selects them (TSRM 259)."""

_DECIMAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)")
_HEXADECIMAL = re.compile(r"[0-9A-Fa-f]+")


class ReportError(ValueError):
    """A report that does not have the controller's format."""


@dataclass(frozen=True, slots=True)
class MotorStatus:
    """Status of a motor: both words of the reply to `#n?`."""

    first: int
    second: int

    def has(self, name: str) -> bool:
        """Return True if a bit is set, by its name in `yarclang.pmac.status`."""
        if name in MOTOR_WORD_1:
            return bool(self.first >> MOTOR_WORD_1[name] & 1)
        return bool(self.second >> MOTOR_WORD_2[name] & 1)

    @property
    def at_rest(self) -> bool:
        """Return True if the motor is at rest: its desired velocity is zero or its loop is open, and no abort
        or home search is in progress.
        """
        still = self.has("desired velocity zero") or self.has("open loop")
        return still and not self.has("abort deceleration") and not self.has("home search in progress")

    @property
    def closed_loop(self) -> bool:
        """Return True if the motor's loop is closed."""
        return not self.has("open loop")

    @property
    def homed(self) -> bool:
        """Return True if the home was found since the controller was reset."""
        return self.has("home complete")

    @property
    def flags(self) -> tuple[str, ...]:
        """Return the names of all bits that are set."""
        return tuple(name for name in (*MOTOR_WORD_1, *MOTOR_WORD_2) if self.has(name))

    @property
    def faulted(self) -> bool:
        """Return True if the motor has a fault of its own, or has reached a limit."""
        return any(
            self.has(name) for name in ("amplifier fault", "fatal following error", "stopped on limit")
        )

    @property
    def trouble(self) -> str:
        """Return the reason why the motor can't move, in words; empty if it can."""
        if self.has("amplifier fault"):
            return "its amplifier reports a fault"
        if self.has("fatal following error"):
            return "its following error is beyond Ixx11"
        if self.has("stopped on limit"):
            side = (
                "positive"
                if self.has("positive limit set")
                else "negative"
                if self.has("negative limit set")
                else "a"
            )
            return f"it was stopped by {side if side == 'a' else 'the ' + side} limit"
        if not self.has("activated"):
            return "it isn't activated (Ixx00)"
        if self.has("open loop"):
            return "it is open-loop"
        return ""


@dataclass(frozen=True, slots=True)
class SystemStatus:
    """Status of a coordinate system: the first two words of the reply to `&n??`."""

    first: int
    second: int

    @property
    def running(self) -> bool:
        """Return True if a program runs. A starved rotary also counts as running, although nothing moves."""
        return bool(self.first >> SYSTEM_WORD_1["running"] & 1)

    @property
    def run_time_error(self) -> bool:
        """Return True if a line couldn't be calculated, or wasn't calculated in time."""
        return bool(self.second >> SYSTEM_WORD_2["run-time error"] & 1)


def groups_of(motors: Sequence[int]) -> tuple[int, ...]:
    """Return the first motor of each group of eight that contains one of these motors."""
    return tuple(sorted({(motor - 1) // GROUP * GROUP + 1 for motor in motors}))


def counts_in(text: str, group: int, motors: Sequence[int]) -> dict[int, float]:
    """Return the positions or following errors in a report [counts], by the motors' numbers.

    Args:
        text: the report of ^P or ^F.
        group: number of the first motor of the reported group.
        motors: numbers of the wanted motors; those outside of the group are left out.

    Raises:
        ReportError: the text isn't eight numbers (on a controller with fewer motors: as many as there are).
    """
    values = _items(text, group, motors)
    if not all(_DECIMAL.fullmatch(value) for value in values):
        raise ReportError(f"{text!r} isn't a list of positions")
    return {motor: float(values[motor - group]) for motor in motors if group <= motor < group + GROUP}


def statuses_in(text: str, group: int, motors: Sequence[int]) -> dict[int, MotorStatus]:
    """Return the status words in a report, by the motors' numbers.

    Args:
        text: the report of ^B.
        group: number of the first motor of the reported group.
        motors: numbers of the wanted motors; those outside of the group are left out.

    Raises:
        ReportError: the status words aren't 12 hexadecimal digits each.
    """
    words = _items(text, group, motors)
    return {motor: motor_status(words[motor - group]) for motor in motors if group <= motor < group + GROUP}


def motor_status(text: str) -> MotorStatus:
    """Parse the reply to `#n?`.

    Raises:
        ReportError: it isn't 12 hexadecimal digits.
    """
    value = _hexadecimal(text, 12)
    return MotorStatus(value >> 24, value & 0xFFFFFF)


def system_status(text: str) -> SystemStatus:
    """Parse the reply to `&n??`.

    Raises:
        ReportError: it isn't 18 hexadecimal digits.
    """
    value = _hexadecimal(text, 18)
    return SystemStatus(value >> 48, value >> 24 & 0xFFFFFF)


def _items(text: str, group: int, motors: Sequence[int]) -> list[str]:
    items = text.split()
    wanted = max((motor - group + 1 for motor in motors if group <= motor < group + GROUP), default=0)
    if len(items) < wanted:
        raise ReportError(f"{text!r} tells of {len(items)} motors, but not of motor {group + wanted - 1}")
    return items


def _hexadecimal(text: str, digits: int) -> int:
    if len(text) != digits or not _HEXADECIMAL.fullmatch(text):
        raise ReportError(f"{text!r} isn't a status of {digits} digits")
    return int(text, 16)


def in_order(values: dict[int, float], motors: Sequence[int]) -> Array:
    """Return the values of the motors as an array (n,)."""
    return np.array([values[motor] for motor in motors], dtype=np.float64)
