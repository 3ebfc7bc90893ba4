"""Inputs as a state machine: which variable changes when. Time is an argument; no I/O.

What is due happens at its own time, in the order of time, and at one time in the order in which it was asked for. So the values at any time don't
depend on how the time up to it is divided.
"""

from __future__ import annotations

import heapq
import math
from collections import defaultdict
from collections.abc import Iterable

from yarclang.frozen import frozen
from yarclang.simulated_cell.script import Change, is_reached

SCRIPT, SENSOR, HAND = "script", "sensor", "hand"
"""What changes an input."""


@frozen
class Set:
    """A variable gets a value at a time [s], by its script, by a sensor or by hand (`cause`)."""

    time: float
    variable: str
    value: float
    cause: str = SCRIPT


@frozen
class _Due:
    """What is due: a change, or the next value of an input that toggles.

    `turn` counts the changes of the input when the toggling began: after another one it is over. `phase` is 1 for the opposite. `cause` as of `Set`.
    """

    change: Change
    turn: int | None = None
    phase: int = 0
    cause: str = SCRIPT


class Inputs:
    """The inputs that a script changes.

    Args:
        script: its changes. Those at a time are due from `start` on.
    """

    def __init__(self, script: Iterable[Change] = ()) -> None:
        self._script = tuple(script)
        self._due: list[tuple[float, int, _Due]] = []
        self._count = 0
        self._turns: defaultdict[str, int] = defaultdict(int)
        self._stuck: set[str] = set()
        self._sensed: dict[str, float] = {}
        self._outputs: dict[str, float] = {}
        self._place = ""
        self._made: list[Set] = []
        self.values: dict[str, float] = {}

    @property
    def watched(self) -> frozenset[str]:
        """The variables of outputs whose changes must be told."""
        return frozenset(one.output[0] for one in self._script if one.output is not None)

    @property
    def driven(self) -> frozenset[str]:
        """The variables of inputs that the script may change."""
        return frozenset(one.variable for one in self._script)

    @property
    def next_due(self) -> float:
        """When something is due next [s]; -inf if something is already, inf if nothing is."""
        if self._made:
            return -math.inf
        return self._due[0][0] if self._due else math.inf

    def start(self, now: float) -> None:
        """Begin the run at `now` [s]: what the script says of times counts from here."""
        self._settle(now)
        for change in self._script:
            if change.at is not None:
                self._put(now + change.at + change.delay, _Due(change))

    def advance(self, now: float) -> tuple[Set, ...]:
        """Return what was set since the last time, up to `now` [s], in order."""
        self._settle(now)
        made, self._made = self._made, []
        return tuple(made)

    def output_changed(self, variable: str, value: float, now: float) -> None:
        """Hear the value that an output has got at `now` [s]; only another value than before counts."""
        self._settle(now)
        if self._outputs.get(variable, 0.0) == value:
            return
        self._outputs[variable] = value
        for change in self._script:
            if change.output == (variable, value):
                self._put(now + change.delay, _Due(change))

    def reached(self, place: str, now: float) -> None:
        """Hear the place of the command that begins, or is waited at, at `now` [s]; empty: none is, so that the same one is reached anew."""
        self._settle(now)
        before, self._place = self._place, place
        for change in self._script:
            if change.place is not None and is_reached(change.place, place, before):
                self._put(now + change.delay, _Due(change))

    def set(self, variable: str, value: float, now: float, cause: str = HAND) -> None:
        """Set an input at `now` [s], by hand if nothing else is said."""
        self._settle(now)
        self._put(now, _Due(Change(variable, value), cause=cause))

    def sense(self, variable: str, value: float, now: float) -> None:
        """Hear what the sensors of an input tell at `now` [s]; only another value than before sets it."""
        if self._sensed.get(variable) != value:
            self._sensed[variable] = value
            self.set(variable, value, now, SENSOR)

    def _put(self, when: float, due: _Due) -> None:
        heapq.heappush(self._due, (when, self._count, due))
        self._count += 1

    def _settle(self, now: float) -> None:
        while self._due and self._due[0][0] <= now:
            when, _, due = heapq.heappop(self._due)
            self._act(when, due)

    def _act(self, when: float, due: _Due) -> None:
        change = due.change
        variable, value = change.variable, change.value
        if due.turn is None:
            if variable in self._stuck:
                return
            self._turns[variable] += 1
            if change.stuck:
                self._stuck.add(variable)
        elif due.turn != self._turns[variable]:
            return
        if due.phase:
            value = float(value == 0.0)
        self.values[variable] = value
        self._made.append(Set(when, variable, value, due.cause))
        if change.toggle is not None:
            self._put(when + change.toggle[due.phase], _Due(change, self._turns[variable], 1 - due.phase))
