"""The calculation of a motion program, from statements to steps. It runs ahead of the motion (TUM
339-341).
"""

from __future__ import annotations

from collections.abc import Callable

from yarclang.pmac.errors import BAD_PROGRAM, NO_PROGRAM
from yarclang.simulator.language.arithmetic import value_of
from yarclang.simulator.language.statements import (
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
from yarclang.simulator.motion.steps import Step
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.programs.moves import Moves
from yarclang.simulator.programs.program import Branch, Code, Go, Line, Program, Rotary
from yarclang.simulator.programs.surroundings import Surroundings
from yarclang.simulator.state.registers import Seen

_AT_ONCE = 500
"""Largest number of statements that are calculated in one real-time interrupt."""

_DEEPEST = 15
"""Largest number of nested subroutines (assumed)."""

_MOST_EVENTS = 256
"""Largest number of synchronous assignments before one move."""

_LONGEST_DELAY = 8388.0
_CODE_PROGRAMS = {"G": 1000, "M": 1001, "T": 1002, "D": 1003}


class Calculation:
    """Calculates the program of a coordinate system: executes its statements and yields the steps of the
    motion.

    `step` is called repeatedly until it returns None.

    Attributes:
        system: number of the coordinate system.
        scope: the variables as the coordinate system sees them.
        outside: the machine.
        moves: modal state and positions of the axes.
        rotary: rotary buffer of the coordinate system, if there is one.
        waiting: True if `step` is to be called again at the next real-time interrupt.
        failed: True after a run-time error.
        number: number of the program; 0 is the rotary, None is no program.
    """

    def __init__(self, system: int, scope: Seen, outside: Surroundings) -> None:
        self.system = system
        self.scope = scope
        self.outside = outside
        self.moves = Moves(system, scope, outside, self._fail)
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up: no program, no rotary."""
        self.rotary: Rotary | None = None
        self.moves.clear()
        self.waiting = False
        self.failed = False
        self.number: int | None = None
        self._program: Program | None = None
        self._at = 0
        self._line: tuple[Line, int] | None = None
        self._stack: list[tuple[Program, int]] = []
        self._events: list[Callable[[], None]] = []

    # the program counter

    def point_to(self, number: int, label: int = 0) -> None:
        """Execute B: select the program to run, and a label in it. Only R checks that the program exists."""
        self.number = number
        self._line = None
        self._stack = []
        self._events = []
        self._program = self.outside.programs.get(number) if number else None
        self._at = 0
        if label and self._program:
            self._at = self._program.code()[2].get(label, 0)

    def check(self) -> None:
        """Check that the program can run.

        Raises:
            Refusal: ERR015 if no program is selected, ERR016 for a program with a wrong structure.
        """
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
        """Lines of the rotary that aren't calculated yet (PR)."""
        return len(self.rotary.lines) if self.rotary else 0

    def rotary_gone(self) -> None:
        """Forget the rotary's current line, after DELETE ROT or CLEAR."""
        self._line = None

    @property
    def place(self) -> tuple[Program | None, int]:
        """The program, and the index of its next line."""
        if self._program is None:
            return None, 0
        _, places, _ = self._program.code()
        return self._program, places[self._at] if self._at < len(places) else len(self._program.lines)

    # steps

    def step(self) -> Step | None:
        """Execute statements up to the next move, pause or end of the program.

        Returns:
            The step. None if the next line hasn't come yet, if a condition isn't true yet, or after a
            run-time error.
        """
        self.waiting = False
        try:
            return self._calculated()
        except Refusal:
            # The program uses a variable that doesn't exist.
            self._fail()
            return None

    def _calculated(self) -> Step | None:
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
                    # Two backward jumps without a move end the calculation until the next real-time interrupt
                    # (TUM 341).
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
        """Return the step at the end of a program. The next R starts the program from its beginning."""
        if self.number:
            self.point_to(self.number)
        return self._pause("end")

    def _pause(self, kind: str, time: float = 0.0, motors: tuple[int, ...] = ()) -> Step:
        step = Step(kind, "", self.moves.counted, time, motors=motors)  # type: ignore[arg-type]
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
                step = self.moves.step(words)
                if self._events:
                    step.events = self._due()
                return step
            case Assign(synchronous="") as assign:
                self._assign(assign)
            case Assign() as assign:
                self._synchronous(assign)
            case Mode(name=name, time=time):
                if name.startswith("CIRCLE") or name == "SPLINE2":
                    self.outside.unknown(name)
                self.moves.mode = name
                if time is not None:
                    self.moves.pvt_time = value_of(time, scope)
            case Attribute(name=name, value=value):
                self.moves.attribute(name, value_of(value, scope))
            case Frame(name=name, axes=axes):
                self.moves.frame(name, axes or AXES)
            case Pset(words=words):
                for axis, value in words:
                    self.moves.relabel(axis, value_of(value, scope))
            case Pause(name="DWELL", time=time):
                return self._pause("dwell", max(value_of(time, scope), 0.0) * 1e-3)
            case Pause(time=time):
                duration = max(value_of(time, scope) * 1e-3, self.outside.interrupt)
                return Step(
                    "move", "DELAY", self.moves.counted, min(duration, _LONGEST_DELAY), events=self._due()
                )
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
        """Evaluate the value of a synchronous assignment (M1==1) now. It is assigned when the next move
        begins to blend in (facts 4).
        """
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

        if len(self._events) < _MOST_EVENTS:
            self._events.append(fire)

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
        """Set a run-time error."""
        self.failed = True
