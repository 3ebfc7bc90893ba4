"""Values of inputs and outputs. They come with their comments from the cell's file, and are updated by the
events of runs. The coordinator is asked once for all pages.
"""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from yarclang.cell.model import Cell
from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import events, orders
from yarclang.coordinator.messages.replies import NamedSignal, Surroundings
from yarclang.pendant.messages.signals import HeldParts, SignalShown, SignalsShown, SignalValues, Waiting
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.toml.places import Places, find_places

_AGE, _SIMULATED_AGE = 0.4, 0.1
"""Longest age of values that are shown without a new request [s]: of a real robot, and of a robot that is
simulated in this process.
"""
_SHARE = 4.0
"""Limit on requests to a real controller. They occupy its connection for at most 1 / `_SHARE` of the time,
because jogs use the same connection.
"""
_LONGEST = 160
"""Longest comment [characters]."""


@dataclass(frozen=True, slots=True, eq=False)
class _CellFile:
    """Content of a cell's file, as it was read last.

    Attributes:
        path: path of the file; None without a cell.
        stamp: modification time [ns] and size [bytes] of the file, by which a change is recognized.
        cell: the cell; None if there is none, or the file can't be read.
        trouble: reason why the file can't be read; empty if it can.
        comments: comments on inputs and outputs in the file, by table and name.
    """

    path: str | None
    stamp: tuple[int, int]
    cell: Cell | None
    trouble: str
    comments: dict[tuple[str, str], str]


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """The last reply about inputs and outputs.

    Attributes:
        told: the coordinator's reply.
        held: grippers with the workpieces (parts) that they hold.
        shown: message for pages, made from the reply.
        until: time until which the reply may be used [s].
    """

    told: Surroundings
    held: tuple[HeldParts, ...]
    shown: SignalsShown
    until: float


class Signals:
    """Present values of the inputs and outputs, and the WAIT command at which the running program waits.

    Args:
        robot: the robot.
        now: returns the time of a monotonic clock [s].
    """

    def __init__(self, robot: Robot, now: Callable[[], float]) -> None:
        self._robot = robot
        self._now = now
        self._asking = asyncio.Lock()
        self._seen: _Seen | None = None
        self._file = _CellFile(None, (0, 0), None, "", {})
        self._heard: dict[str, float] = {}
        self._wait: tuple[events.WaitBegan, float] | None = None

    async def watch(self, _: Attached) -> None:
        """Forget the state of the previous coordinator."""
        self._seen, self._wait = None, None
        self._heard.clear()

    def hear(self, event: events.BaseEvent) -> None:
        """Store values that an event of a run reports."""
        match event:
            case events.Began() | events.Finished():
                self._wait = None
                self._heard.clear()
            case events.WaitBegan(variable=variable, value=value):
                self._wait = (event, self._now())
                self._heard[variable] = value
            case events.WaitEnded(variable=variable, value=value):
                self._wait = None
                self._heard[variable] = value
            case events.OutputSet(variable=variable, value=value):
                self._heard[variable] = value
            case events.InputChanged(variable=variable, value=value):
                self._heard[variable] = value
            case _:
                return
        if self._seen is not None and isinstance(event, events.Finished):
            self._seen = None

    async def cell(self, attached: Attached) -> Cell | None:
        """Return the cell around the robot, as read from the cell's file; None if there is no cell, or the
        file can't be read.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        await self._look(attached)
        return self._file.cell

    async def shown(self, attached: Attached) -> SignalsShown:
        """Return all inputs and outputs with their values and descriptions.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        return (await self._look(attached)).shown

    async def values(self, attached: Attached) -> SignalValues:
        """Return only the values of all inputs and outputs.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        surroundings = await self._look(attached)
        values: list[float | None] = []
        levels: list[int] = []
        for number, one in enumerate((*surroundings.told.inputs, *surroundings.told.outputs)):
            value = one.value
            if value is None and one.variable in self._heard:
                value = self._heard[one.variable]
                levels.append(number)
            values.append(value)
        return SignalValues(
            version=surroundings.shown.version,
            values=tuple(values),
            heard=tuple(levels),
            waiting=self._waiting(surroundings.told),
            held=surroundings.held,
        )

    def _waiting(self, surroundings: Surroundings) -> Waiting | None:
        if self._wait is None:
            return None
        event, since = self._wait
        value = next((one.value for one in surroundings.inputs if one.variable == event.variable), None)
        return Waiting(
            place=event.place,
            name=event.name,
            variable=event.variable,
            wanted=event.wanted,
            value=self._heard.get(event.variable) if value is None else value,
            since_s=round(self._now() - since, 1),
        )

    async def _look(self, attached: Attached) -> _Seen:
        """Return the present state. It is requested once for all pages."""
        async with self._asking:
            if self._seen is not None and self._now() < self._seen.until:
                return self._seen
            begun = self._now()
            surroundings = await attached.ask(orders.AskSurroundings())
            self._file = await asyncio.to_thread(self._read, surroundings.cell)
            held = await _holding_grippers(attached, self._file.cell)
            shown = _described(surroundings, self._file)
            done = self._now()
            age = _AGE if surroundings.fixed else _SIMULATED_AGE
            self._seen = _Seen(surroundings, held, shown, done + max(age, (_SHARE - 1.0) * (done - begun)))
            return self._seen

    def _read(self, path: str | None) -> _CellFile:
        """Return the content of the cell's file.

        The coordinator names no file (`path` is None) if there is no cell, or if its file can't be read. In
        the second case, the last known file is returned with its error.
        """
        if path is not None or self._file.path is None:
            return read_cell_file(path, self._robot, self._file)
        last = read_cell_file(self._file.path, self._robot, self._file)
        return last if last.trouble else read_cell_file(None, self._robot, last)


async def _holding_grippers(attached: Attached, cell: Cell | None) -> tuple[HeldParts, ...]:
    """Return the grippers that hold a part."""
    if cell is None or not cell.parts or not cell.grips:
        return ()
    try:
        told = await attached.ask(orders.AskParts())
    except Trouble:  # the cell that the session uses has no parts
        return ()
    held: dict[str, list[str]] = {}
    for one in told.parts:
        if one.held:
            held.setdefault(one.held, []).append(one.name)
    return tuple(HeldParts(output=name, parts=tuple(parts)) for name, parts in held.items())


def read_cell_file(path: str | None, robot: Robot, before: _CellFile) -> _CellFile:
    """Read a cell's file, unless it hasn't changed since `before`. Call this in a thread.

    Args:
        path: path of the file; None without a cell.
        robot: robot of the cell, for joint positions in the file.
        before: content of the cell's file that was read last.
    """
    if path is None:
        return _CellFile(None, (0, 0), None, "", {})
    place = Path(path)
    try:
        status = place.stat()
    except OSError as error:
        return _CellFile(path, (0, 0), None, f"{place.name} can't be read: {error.strerror}", {})
    stamp = (status.st_mtime_ns, status.st_size)
    if (before.path, before.stamp) == (path, stamp):
        return before
    read = cell_loader(place.parent, robot).at(place)
    errors = [one.message for one in read.diagnostics if one.is_error]
    trouble = f"{place.name}: {errors[0]}" if errors else ""
    if read.value is None:
        return _CellFile(path, stamp, None, trouble or f"{place.name} can't be read", {})
    return _CellFile(path, stamp, read.value, trouble, comments_of(read.value.source))


def comments_of(source: SourceFile) -> dict[tuple[str, str], str]:
    """Return the comments on inputs and outputs in a cell's file, by table and name in upper case. The
    comment of an entry is at the end of its line or, if there is none, in the line above.
    """
    places, lines = find_places(source), source.lines
    comments = {}
    for path in places.keys:
        if len(path) == 2 and path[0] in ("inputs", "outputs"):
            said = _comment(places, lines, path)
            if said:
                comments[str(path[0]), str(path[1]).upper()] = said
    return comments


def _comment(places: Places, lines: tuple[str, ...], path: tuple[str | int, ...]) -> str:
    key = places.keys[path]
    end = places.values.get(path)
    row, column = (key.line, key.end_column) if end is None else (end.end_line, end.end_column)
    rest = lines[row - 1][column - 1 :].lstrip(" \t]") if row <= len(lines) else ""
    if not rest.startswith("#"):
        above = lines[key.line - 2].strip() if 1 < key.line <= len(lines) else ""
        rest = above if above.startswith("#") else ""
    words = " ".join("".join(one if one.isprintable() else " " for one in rest.lstrip("#")).split())
    return words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"


def _described(surroundings: Surroundings, file: _CellFile) -> SignalsShown:
    cell = file.cell
    inputs, outputs = (cell.inputs, cell.outputs) if cell is not None else ({}, {})
    sensed = {output.input for output in cell.sensors} if cell is not None else set()
    signals = []
    for output in surroundings.inputs:
        declared = inputs.get(output.name) == output.variable
        signals.append(_input(output, declared, file, output.variable in sensed or output.name in sensed))
    for output in surroundings.outputs:
        own = outputs.get(output.name)
        matching = own if own is not None and own.variable == output.variable else None
        signals.append(
            SignalShown(
                name=output.name,
                variable=output.variable,
                kind="output",
                declared=matching is not None,
                comment=file.comments.get(("outputs", output.name), "") if matching is not None else "",
                safe=None if matching is None else matching.safe,
                grips_at=None if matching is None or matching.grip is None else matching.grip.value,
                removes_at=None if matching is None or matching.removal is None else matching.removal.value,
                sensor=False,
            )
        )
    shown = SignalsShown(
        version="",
        cell=surroundings.cell,
        fixed=surroundings.fixed,
        trouble=file.trouble,
        signals=tuple(signals),
    )
    version = hashlib.sha256(shown.model_dump_json().encode()).hexdigest()[:16]
    return shown.model_copy(update={"version": version})


def _input(signal: NamedSignal, declared: bool, file: _CellFile, sensed: bool) -> SignalShown:
    return SignalShown(
        name=signal.name,
        variable=signal.variable,
        kind="input",
        declared=declared,
        comment=file.comments.get(("inputs", signal.name), "") if declared else "",
        safe=None,
        grips_at=None,
        removes_at=None,
        sensor=declared and sensed,
    )
