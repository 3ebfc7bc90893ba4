"""Messages about inputs and outputs by name, and the WAIT at which the robot stands."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message


class SignalShown(Message):
    """An input or output, with its entry in the cell's file."""

    name: str
    variable: str
    """The controller's variable."""
    kind: Literal["input", "output"]
    declared: bool
    """True if the cell's file declares the signal; false if the session or the program does."""
    comment: str
    """Comment of the signal in the cell's file, beside it or above it."""
    safe: float | None
    """Value that the output gets at every stop, hold and fault; null: it stays unchanged."""
    grips_at: float | None
    """Value at which the output closes a gripper; null: the output switches no gripper."""
    removes_at: float | None
    """Value of the output at which a machine takes parts away; null: the output switches no such machine."""
    sensor: bool
    """True if a sensor of the cell drives the input."""


class SignalsShown(Message):
    """All inputs and outputs. `version` changes when any of them changes."""

    version: str
    cell: str | None
    """Path of the cell's file."""
    fixed: str
    """Reason why a user can't set inputs; empty: a user can."""
    trouble: str
    """Reason why the cell's file can't be read. In this case its signals are missing here. Empty: the file
    can be read.
    """
    signals: tuple[SignalShown, ...]


class Waiting(Message):
    """The WAIT at which the robot stands: its place in the program, its input, the awaited and the present
    value, and the time for which the robot has waited [s].
    """

    place: str
    name: str
    variable: str
    wanted: float
    value: float | None
    since_s: float


class HeldParts(Message):
    """The parts that the gripper of an output holds."""

    output: str
    parts: tuple[str, ...]


class SignalValues(Message):
    """The values of all signals; null: not known at present. Their order is that of the `SignalsShown` with
    the same `version`.
    """

    version: str
    values: tuple[float | None, ...]
    heard: tuple[int, ...]
    """Indices of values that were reported by a run and may have changed since."""
    waiting: Waiting | None
    held: tuple[HeldParts, ...]
