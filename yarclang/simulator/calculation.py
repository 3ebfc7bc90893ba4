"""The calculation of a motion program: from statements to steps, moves ahead of the motion (TUM 339-341)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from yarclang.pmac.errors import BAD_PROGRAM, NO_PROGRAM
from yarclang.simulator.axes import Axes, axes_of
from yarclang.simulator.expressions import value_of
from yarclang.simulator.pieces import Array
from yarclang.simulator.programs import Branch, Code, Go, Line, Program, Rotary
from yarclang.simulator.registers import Seen
from yarclang.simulator.reply import Refusal
from yarclang.simulator.steps import Step
from yarclang.simulator.words import (
    AXES,
    Address,
    Assign,
    Attribute,
    Frame,
    Home,
    If,
    Jump,
    Label,
    Mode,
    Move,
    Pause,
    Plain,
    Plcs,
    Pset,
    Say,
    Skipped,
)

_AT_ONCE = 500
"""Statements that one real-time interrupt may take."""

_DEEPEST = 15
"""Subroutines in each other (assumed)."""

_QUANTUM = 1e-3 / 4096.0
_LONGEST = 4096e-3
_CODE_PROGRAMS = {"G": 1000, "M": 1001, "T": 1002, "D": 1003}
_PLACES = {axis: place for place, axis in enumerate(AXES)}
_SPLINES = ("SPLINE1", "SPLINE2", "PVT")


class Surroundings(Protocol):
    """What a program can reach outside of its coordinate system."""

    programs: dict[int, Program]

    @property
    def interrupt(self) -> float:
        """The time between real-time interrupts [s]."""
        ...

    def say(self, text: str) -> None:
        """SEND."""
        ...

    def queue(self, text: str, system: int, motor: int = 1) -> None:
        """CMD: a line for the interpreter, when it gets to it, and what it addresses."""
        ...

    def switch_plcs(self, name: str, numbers: tuple[int, ...]) -> None:
        """ENABLE, DISABLE, PAUSE, RESUME."""
        ...

    def unknown(self, word: str) -> None:
        """A word that is skipped."""
        ...


class Calculation:
    """Where a coordinate system is in its program, and the modal state: mode, TM, TA, TS, F, ABS or INC.

    `step` is called until it has nothing; `waiting` says that it will have at the next real-time interrupt.
    """

    def __init__(self, system: int, scope: Seen, outside: Surroundings) -> None:
        self.system = system
        self.scope = scope
        self.outside = outside
        self.rotary: Rotary | None = None
        self.axes: Axes = axes_of([])
        self.reset()

    def reset(self) -> None:
        """As at power-up."""
        self.position: Array = np.zeros(len(AXES))
        self.mode = "LINEAR"
        self.pvt_time = 0.0
        self.feed = False
        self.incremental: set[str] = set()
        self.vector: frozenset[str] = frozenset("XYZ")
        self.waiting = False
        self.failed = False
        self.number: int | None = None
        self._program: Program | None = None
        self._at = 0
        self._line: tuple[Line, int] | None = None
        self._stack: list[tuple[Program, int]] = []
        self._events: list[Callable[[], None]] = []
        self.counted = np.zeros(0)

    # the program counter

    def point_to(self, number: int, label: int = 0) -> None:
        """B: the program to run. Whether it exists is looked at by R."""
        self.number = number
        self._line = None
        self._stack = []
        self._events = []
        self._program = self.outside.programs.get(number) if number else None
        self._at = 0
        if label and self._program:
            self._at = self._program.code()[2].get(label, 0)

    def check(self) -> None:
        """Refuse what can't run: ERR015 without a program, ERR016 with a bad one."""
        if self.number is None:
            raise Refusal(NO_PROGRAM)
        if self.number == 0:
            if self.rotary is None:
                raise Refusal(NO_PROGRAM)
            return
        if self._program is None:
            self._program = self.outside.programs.get(self.number)
        if self._program is None or not self._program.lines:
            raise Refusal(NO_PROGRAM)
        if self._at > len(self._program.code()[0]):
            raise Refusal(BAD_PROGRAM)

    @property
    def lines_ahead(self) -> int:
        """PR: lines of the rotary that aren't calculated."""
        return len(self.rotary.lines) if self.rotary else 0

    def rotary_gone(self) -> None:
        """DELETE ROT, or CLEAR."""
        self._line = None

    @property
    def place(self) -> tuple[Program | None, int]:
        """The program and the line that comes next."""
        if self._program is None:
            return None, 0
        _, places, _ = self._program.code()
        return self._program, places[self._at] if self._at < len(places) else len(self._program.lines)

    def match(self, counts: Array) -> None:
        """PMATCH: the axes stand where the motors are commanded to."""
        self.position = self.axes.matched(counts, self.position)

    # steps

    def step(self) -> Step | None:
        """Calculate up to the next move, pause or end. None: nothing there yet, or a condition to wait for."""
        self.waiting = False
        jumps = 0
        for _ in range(_AT_ONCE):
            code = self._next()
            if code is None:
                return None if self.number == 0 else self._ended()
            match code:
                case Branch(condition=condition, target=target, wait=wait):
                    if condition(self.scope):
                        if wait:
                            self._at -= 1
                            break
                    else:
                        self._at = target
                case Go(target=target, back=back):
                    self._at = target
                    jumps += back
                    # two jumps back without a move end the calculation for now (TUM 341)
                    if jumps >= 2:
                        break
                case _:
                    if found := self._execute(code):
                        return found
        self.waiting = True
        return None

    def _next(self) -> Code | None:
        if self.number == 0 and self._program is None:
            while True:
                if self._line is None:
                    line = self.rotary.take() if self.rotary else None
                    if line is None:
                        return None
                    self._line = line, 0
                line, at = self._line
                if at < len(line.statements):
                    self._line = line, at + 1
                    return line.statements[at]
                self._line = None
        while self._program is not None:
            code = self._program.code()[0]
            if self._at < len(code):
                self._at += 1
                return code[self._at - 1]
            if not self._stack:
                break
            self._return()
        return None

    def _return(self) -> None:
        self._program, self._at = self._stack.pop()

    def _ended(self) -> Step:
        """The end of a program: R begins it again."""
        if self.number:
            self.point_to(self.number)
        return self._pause("end")

    def _pause(self, kind: str, time: float = 0.0, motors: tuple[int, ...] = ()) -> Step:
        step = Step(kind, "", self.counted, time, motors=motors)  # type: ignore[arg-type]
        if kind in ("dwell", "home"):
            step.events = self._due()
        return step

    def _due(self) -> tuple[Callable[[], None], ...]:
        events = tuple(self._events)
        self._events = []
        return events

    def _execute(self, code: Code) -> Step | None:
        scope = self.scope
        match code:
            case Move(words=words):
                return self._move(words)
            case Assign(synchronous="") as assign:
                self._assign(assign)
            case Assign() as assign:
                self._synchronous(assign)
            case Mode(name=name, time=time):
                if name.startswith("CIRCLE") or name == "SPLINE2":
                    self.outside.unknown(name)
                self.mode = name
                if time is not None:
                    self.pvt_time = value_of(time, scope)
            case Attribute(name=name, value=value):
                self._attribute(name, value_of(value, scope))
            case Frame(name=name, axes=axes):
                self._frame(name, axes or AXES)
            case Pset(words=words):
                for axis, value in words:
                    self._relabel(axis, value_of(value, scope))
            case Pause(name="DWELL", time=time):
                return self._pause("dwell", max(value_of(time, scope), 0.0) * 1e-3)
            case Pause(time=time):
                duration = max(value_of(time, scope) * 1e-3, self.outside.interrupt)
                return Step("move", "DELAY", self.counted, min(duration, 8388.0), events=self._due())
            case Plain(name="STOP"):
                return self._pause("stop")
            case Plain(name="RETURN"):
                if not self._stack:
                    return self._ended()
                self._return()
            case Jump(name=name, to=to):
                self._jump(name, value_of(to, scope))
                if self.failed:
                    return self._pause("end")
            case Say(name=name, text=text):
                if name == "CMD":
                    self.outside.queue(text, self.system)
                elif name == "SEND":
                    self.outside.say(text)
            case Plcs(name=name, numbers=numbers):
                self.outside.switch_plcs(name, numbers)
            case Home(name=name, motors=motors):
                return self._pause("home", -1.0 if name == "HOMEZ" else 0.0, motors)
            case Skipped(name=name):
                self.outside.unknown(name)
            case Plain(name=name):
                if name in ("PMATCH", "TINIT", "BLOCKSTART", "BLOCKSTOP", "UNLOCK"):
                    self.outside.unknown(name)
            case If() | Label() | Address() | Branch() | Go():
                pass
        return None

    def _assign(self, assign: Assign) -> None:
        first = int(value_of(assign.index, self.scope))
        value = assign.value(self.scope) if callable(assign.value) else assign.value
        for index in range(first, (assign.last if assign.last is not None else first) + 1):
            self._write(assign.letter, index, value)

    def _write(self, letter: str, index: int, value: float) -> None:
        try:
            self.scope.write(letter, index, value)
        except Refusal:
            self.failed = True

    def _synchronous(self, assign: Assign) -> None:
        """M1==1: worked out now, done as the next move begins to blend in (facts 4)."""
        index = int(value_of(assign.index, self.scope))
        value = value_of(assign.value, self.scope)
        operator = assign.synchronous

        def fire() -> None:
            old = int(self.scope.read("M", index)) if 0 <= index < 8192 else 0
            new = {
                "==": value,
                "&=": float(old & int(value)),
                "|=": float(old | int(value)),
                "^=": float(old ^ int(value)),
            }[operator]
            self._write("M", index, new)

        if len(self._events) < 256:
            self._events.append(fire)

    def _attribute(self, name: str, value: float) -> None:
        """TM, TA, TS and F are kept in Isx89, Isx87 and Isx88 (TSRM 189)."""
        number = {"TM": 89, "F": 89, "TA": 87, "TS": 88}[name]
        self.scope.write("I", 5000 + 100 * self.system + number, max(value, 0.0))
        if name in ("TM", "F"):
            self.feed = name == "F"

    def _frame(self, name: str, axes: str) -> None:
        match name:
            case "ABS":
                self.incremental -= set(axes)
            case "INC":
                self.incremental |= set(axes)
            case "FRAX":
                self.vector = frozenset(axes) & frozenset(AXES)
            case _:
                self.vector = frozenset()

    def _relabel(self, axis: str, value: float) -> None:
        """PSET: the axis gets another position, the motors stay: the offsets take it up."""
        place = AXES.index(axis)
        change = value - self.position[place]
        offset = self.axes.offset - self.axes.matrix[:, place] * change
        self.axes = Axes(self.axes.motors, self.axes.matrix, offset)
        self.position = self.position.copy()
        self.position[place] = value

    def _jump(self, name: str, to: float) -> None:
        if name in ("GOTO", "GOSUB"):
            program, label = self._program, int(to)
        else:
            number = _CODE_PROGRAMS.get(name, int(to))
            label = int(to) * 1000 if name in _CODE_PROGRAMS else round((to - int(to)) * 100_000)
            program = self.outside.programs.get(number)
        if program is None:
            self._fail()
            return
        try:
            _, _, labels = program.code()
        except Refusal:
            self._fail()
            return
        if label not in labels and label:
            self._fail()
            return
        if name != "GOTO":
            if len(self._stack) >= _DEEPEST or self._program is None:
                self._fail()
                return
            self._stack.append((self._program, self._at))
        self._program, self._at = program, labels.get(label, 0)

    def _fail(self) -> None:
        """A run-time error."""
        self.failed = True

    # moves

    def _move(self, words: tuple[tuple[str, object, object], ...]) -> Step | None:
        position = self.position.copy()
        velocity: Array | None = None
        for axis, data, speed in words:
            place = _PLACES[axis]
            value = data(self.scope) if callable(data) else float(data)  # type: ignore[arg-type]
            position[place] = position[place] + value if axis in self.incremental else value
            if speed is not None:
                velocity = np.zeros(len(AXES)) if velocity is None else velocity
                velocity[place] = speed(self.scope) if callable(speed) else float(speed)  # type: ignore[arg-type]
        before, self.position = self.position, position
        target = self.axes.counts(position)
        step = Step("move", "LINEAR", target)
        if self.mode in _SPLINES:
            self._timed(step, velocity)
        elif self.mode == "RAPID":
            step.mode = "RAPID"
        else:
            self._linear(step, position - before)
        step.events = self._due() if self._events else ()
        self.counted = target
        return step

    def _variable(self, number: int) -> float:
        return self.scope.variables.i[5000 + 100 * self.system + number]

    def _timed(self, step: Step, velocity: Array | None) -> None:
        """SPLINE and PVT: the time is TM, kept in 1/4096 ms and no longer than 4096 ms; or TA in whole ms with I42=1
        (TSRM 463, 476).
        """
        i42 = self.scope.variables.i[42] == 1.0
        time = self.pvt_time if self.mode == "PVT" else self._variable(87 if i42 else 89)
        time = (
            round(time) * 1e-3 if i42 else min(round(time * 1e-3 / _QUANTUM) * _QUANTUM, _LONGEST - _QUANTUM)
        )
        if time < self.outside.interrupt:
            # the next move isn't ready in time (TSRM 476)
            self.failed = True
            time = self.outside.interrupt
        step.time = time
        step.mode = "PVT" if self.mode == "PVT" else "SPLINE1"
        if step.mode == "PVT" and velocity is not None:
            unit = max(self._variable(90), 1e-3) * 1e-3
            step.velocity = self.axes.matrix @ velocity / unit

    def _linear(self, step: Step, way: Array) -> None:
        """LINEAR: time from TM or F, TA and TS, and not faster than Ixx16 and Ixx17 (TSRM 98, 189)."""
        ramp = max(self._variable(87), 2.0 * self._variable(88)) * 1e-3
        time = self._variable(89) * 1e-3
        if self.feed:
            feed = max(self._variable(89), 1e-6) / (max(self._variable(90), 1e-3) * 1e-3)
            chosen = [AXES.index(axis) for axis in self.vector]
            distance = float(np.linalg.norm(way[chosen])) if chosen else 0.0
            time = (distance or float(np.abs(way).max())) / feed
        speed = np.abs(step.target - self.counted)
        fastest = np.array([self.scope.read("I", 100 * motor + 16) for motor in self.axes.motors]) * 1e3
        steepest = np.array([self.scope.read("I", 100 * motor + 17) for motor in self.axes.motors]) * 1e6
        if len(speed):
            time = max(time, float((speed / np.maximum(fastest, 1e-6)).max()))
        time = min(max(time, ramp, 0.5e-3), 8388.0)
        if len(speed):
            ramp = max(ramp, float((speed / time / np.maximum(steepest, 1e-6)).max()))
        ramp = min(ramp, 8388.0)
        step.ramp, step.s_ramp = ramp, min(self._variable(88) * 1e-3, ramp / 2.0)
        step.time = max(time, ramp)
