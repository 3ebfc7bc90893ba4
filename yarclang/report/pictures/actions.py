"""Find the actions of a program besides its motions, with their times in the plan: waits, outputs that it
sets, and inputs for which it waits.
"""

from __future__ import annotations

from typing import Literal

from yarclang.decisions import simple
from yarclang.frozen import frozen
from yarclang.hir import (
    Assign,
    Dwell,
    Else,
    EndWhen,
    Gap,
    Hold,
    SetOutput,
    Signal,
    Step,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.motion.plan import MotionPlan
from yarclang.report.pictures.signal_rows import SignalRow
from yarclang.runtime.signals import state_text

Sort = Literal["set", "wait", "dwell"]


@frozen
class Action:
    """A wait, a dwell, or the setting of an output, as shown in a picture.

    Attributes:
        sort: kind of the action.
        text: text to be shown.
        start: time of its beginning [s].
        end: time of its end in the plan [s]. Waiting for an input takes no time in the plan.
    """

    sort: Sort
    text: str
    start: float
    end: float


def actions_of(plan: MotionPlan) -> tuple[Action, ...]:
    """Return the outputs that a plan sets, and its waits, in order."""
    places = plan.schedule.places
    found = []
    for number, step in enumerate(plan.program.steps):
        if (said := _said(step)) is not None:
            found.append(Action(*said, places[number], places[number + 1]))
    return tuple(found)


def _said(step: Step) -> tuple[Sort, str] | None:
    match step:
        case Dwell(duration=duration):
            return "dwell", f"WAIT {duration:g} s"
        case SetOutput(output=output, value=value):
            return "set", f"{output.name} {state_text(value)}"
        case Assign(target=Signal(name=name)):
            return "set", name
        case WaitInput(input=signal, value=value):
            return "wait", f"WAIT {signal.name} {state_text(value)}"
        case WaitUntil(condition=condition):
            compared = simple(condition)
            return "wait", "WAIT" if compared is None else f"WAIT {compared[0].name}"
        case When(condition=condition, within=float()):
            compared = simple(condition)
            return "wait", "WAIT" if compared is None else f"WAIT {compared[0].name}"
        case Hold(register=register):
            return "wait", register or "HOLD"
    return None


def planned_signals(plan: MotionPlan) -> tuple[SignalRow, ...]:
    """Return the outputs that a plan sets, and the inputs for which it waits, with their values over time, in
    the order of their first commands.

    The value of an output is known from its first SET on. After a WHEN whose branches leave different values,
    it is unknown until the next SET.
    """
    places = plan.schedule.places
    follows = _Followed()
    for number, step in enumerate(plan.program.steps):
        if not isinstance(step, Gap):
            follows.step(step, places[number])
    return follows.rows(plan.duration)


class _Followed:
    """Collects the values of outputs and the waits for inputs, step by step through a program."""

    def __init__(self) -> None:
        self._stretches: dict[tuple[str, bool], list[tuple[float, float, float]]] = {}
        self._waits: dict[tuple[str, bool], list[tuple[float, float, bool]]] = {}
        self._now: dict[str, tuple[float, float]] = {}  # value, and the time from which it is drawn
        self._before: list[tuple[dict[str, float], dict[str, float] | None]] = []

    def step(self, step: Step, time: float) -> None:
        """Take into account the next step, which begins at `time` [s]."""
        match step:
            case SetOutput(output=Signal(name=name), value=value):
                self._set(name, value, time)
            case Assign(target=Signal(name=name)):
                self._set(name, None, time)
            case WaitInput(input=Signal(name=name)):
                self._wait(name, time)
            case WaitUntil(condition=condition) if (compared := simple(condition)) is not None:
                self._wait(compared[0].name, time)
            case When():
                self._before.append((self._values(), None))
            case Else() if self._before:
                before, _ = self._before.pop()
                self._before.append((before, self._values()))
                self._become(before, time)
            case EndWhen() if self._before:
                before, first = self._before.pop()
                other, last = before if first is None else first, self._values()
                self._become({name: value for name, value in last.items() if other.get(name) == value}, time)

    def rows(self, end: float) -> tuple[SignalRow, ...]:
        """Return the rows of all outputs, up to the end of the plan [s]."""
        self._become({}, end)
        return tuple(
            SignalRow(name, is_input, tuple(stretches), tuple(self._waits.get((name, is_input), ())))
            for (name, is_input), stretches in self._stretches.items()
        )

    def _values(self) -> dict[str, float]:
        return {name: value for name, (value, _) in self._now.items()}

    def _become(self, values: dict[str, float], time: float) -> None:
        for name in dict.fromkeys((*self._now, *values)):
            self._set(name, values.get(name), time)

    def _set(self, name: str, value: float | None, time: float) -> None:
        """Give an output a value; None if the value isn't known."""
        stretches = self._stretches.setdefault((name, False), [])
        before = self._now.get(name)
        if before is not None and before[0] == value:
            return
        if before is not None and time > before[1]:
            stretches.append((before[1], time, before[0]))
        if value is None:
            self._now.pop(name, None)
        else:
            self._now[name] = (value, time)

    def _wait(self, name: str, time: float) -> None:
        self._stretches.setdefault((name, True), [])
        self._waits.setdefault((name, True), []).append((time, time, True))
