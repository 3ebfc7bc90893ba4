"""Inputs and outputs by name, and the WAIT at which the robot stands."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message


class SignalShown(Message):
    """An input or output, and its entry in the cell."""

    name: str
    variable: str
    """The controller's variable."""
    kind: Literal["input", "output"]
    declared: bool
    """True if the cell's file declares it; else the session or the program does."""
    comment: str
    """Comment beside or above it in the cell's file."""
    safe: float | None
    """Safe value, set at any stop, hold or fault; null: unchanged."""
    grips_at: float | None
    """Value at which the output closes a gripper; null: no gripper."""
    removes_at: float | None
    """Value at which a machine takes parts away; null: no such machine."""
    sensor: bool
    """True if a sensor of the cell drives the input."""


class SignalsShown(Message):
    """All inputs and outputs; `version` changes with each of them."""

    version: str
    cell: str | None
    """The file of the cell."""
    fixed: str
    """Reason for which inputs can't be set by hand; empty: they can."""
    trouble: str
    """Reason for which the cell's file can't be read (its content is missing here); empty: it can."""
    signals: tuple[SignalShown, ...]


class Waiting(Message):
    """The WAIT at which the robot stands: its place in the program, its input, the wanted and the present
    value, and the waiting time [s].
    """

    place: str
    name: str
    variable: str
    wanted: float
    value: float | None
    since_s: float


class HeldParts(Message):
    """The part that the gripper of an output holds."""

    output: str
    parts: tuple[str, ...]


class SignalValues(Message):
    """The values of all signals, in the order of the signals of the same version; null: not known now."""

    version: str
    values: tuple[float | None, ...]
    heard: tuple[int, ...]
    """Indices of values that were reported during a run and may have changed since."""
    waiting: Waiting | None
    held: tuple[HeldParts, ...]
