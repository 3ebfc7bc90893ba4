"""Inputs and outputs by name, and the WAIT at which the robot stands."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message


class SignalShown(Message):
    """An input or output, and what the cell says of it."""

    name: str
    variable: str
    """Of the controller."""
    kind: Literal["input", "output"]
    declared: bool
    """True if the cell's file declares it; else the session or the program does."""
    comment: str
    """Beside it, or above it, in the cell's file."""
    safe: float | None
    """Its value at any stop, hold or fault; null: it stays as it is."""
    grips_at: float | None
    """The value at which the output closes a gripper; null: it moves none."""
    removes_at: float | None
    """The value at which a machine takes parts away; null: none does."""
    sensor: bool
    """True if a sensor of the cell drives the input."""


class SignalsShown(Message):
    """All inputs and outputs; `version` is another one as soon as one of them is."""

    version: str
    cell: str | None
    """The file of the cell."""
    fixed: str
    """Why inputs can't be set by hand; empty: they can."""
    trouble: str
    """Why the cell's file can't be read: what it says is missing here; empty: it can."""
    signals: tuple[SignalShown, ...]


class Waiting(Message):
    """The WAIT at which the robot stands: where in the program, for which input, which value it is to have and has, and since when [s]."""

    place: str
    name: str
    variable: str
    wanted: float
    value: float | None
    since_s: float


class HeldParts(Message):
    """What the gripper of an output holds."""

    output: str
    parts: tuple[str, ...]


class SignalValues(Message):
    """The values of all signals, in the order of the signals of the same version; null: not known now."""

    version: str
    values: tuple[float | None, ...]
    heard: tuple[int, ...]
    """Indices of values that were told while a program runs, and may be others by now."""
    waiting: Waiting | None
    held: tuple[HeldParts, ...]
