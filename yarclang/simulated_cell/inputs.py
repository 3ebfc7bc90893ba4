"""State machine of the controller inputs that a script changes. This module has no clock and does no I/O: its
callers pass the time.

Each change takes effect at its own time, and changes are made in the order of their times. Changes at equal
times are made in the order in which they were requested. Therefore the values at a given time don't depend on
the steps in which time advances.
"""

from __future__ import annotations

import heapq
import math
from collections import defaultdict
from collections.abc import Iterable

from yarclang.frozen import frozen
from yarclang.simulated_cell.script import Change, is_reached

SCRIPT, SENSOR, HAND = "script", "sensor", "hand"
"""Causes for the change of an input."""


@frozen
class Set:
    """A change of an input that has been made.

    Attributes:
        time: time of the change [s].
        variable: variable of the input.
        value: new value of the input.
        cause: cause of the change: SCRIPT, SENSOR or HAND.
    """

    time: float
    variable: str
    value: float
    cause: str = SCRIPT


@frozen
class _Due:
    """A pending change of an input, or the next value of an input that toggles.

    Attributes:
        change: the change.
        turn: for the next value of a toggling input: number of changes of this input when the toggling began.
            If the input has been changed again since then, the toggling has ended, and the value isn't set.
            None for a change.
        phase: 0 for the value of the change, 1 for its opposite.
        cause: cause of the change: SCRIPT, SENSOR or HAND.
    """

    change: Change
    turn: int | None = None
    phase: int = 0
    cause: str = SCRIPT


class Inputs:
    """The controller inputs that a script, sensors or a user change.

    Args:
        script: changes of the script. Their times count from `start`.

    Attributes:
        values: the values set so far, by variable.
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
        """Variables of the outputs whose changes must be reported by `output_changed`."""
        return frozenset(one.output[0] for one in self._script if one.output is not None)

    @property
    def driven(self) -> frozenset[str]:
        """Variables of the inputs that the script may change."""
        return frozenset(one.variable for one in self._script)

    @property
    def next_due(self) -> float:
        """Time of the next change [s]; -inf if changes are ready to be fetched, inf if there is none."""
        if self._made:
            return -math.inf
        return self._due[0][0] if self._due else math.inf

    def start(self, now: float) -> None:
        """Begin the run at `now` [s]. The times of the script count from this time."""
        self._settle(now)
        for change in self._script:
            if change.at is not None:
                self._put(now + change.at + change.delay, _Due(change))

    def advance(self, now: float) -> tuple[Set, ...]:
        """Return the values that were set since the last call, up to `now` [s], in order."""
        self._settle(now)
        made, self._made = self._made, []
        return tuple(made)

    def output_changed(self, variable: str, value: float, now: float) -> None:
        """Report the value of an output at `now` [s]. An unchanged value has no effect."""
        self._settle(now)
        if self._outputs.get(variable, 0.0) == value:
            return
        self._outputs[variable] = value
        for change in self._script:
            if change.output == (variable, value):
                self._put(now + change.delay, _Due(change))

    def reached(self, place: str, now: float) -> None:
        """Report that the program has reached a command. This may be the event for changes of the script.

        Args:
            place: index or full place of the command that begins, or at which the program waits. Empty if the
                program is at no command; after that, the same command can be reached again.
            now: the time [s].
        """
        self._settle(now)
        before, self._place = self._place, place
        for change in self._script:
            if change.place is not None and is_reached(change.place, place, before):
                self._put(now + change.delay, _Due(change))

    def set(self, variable: str, value: float, now: float, cause: str = HAND) -> None:
        """Set an input at `now` [s]."""
        self._settle(now)
        self._put(now, _Due(Change(variable, value), cause=cause))

    def sense(self, variable: str, value: float, now: float) -> None:
        """Report the value that sensors give to an input at `now` [s]. The input is set only if this value
        differs from the last reported one.
        """
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
