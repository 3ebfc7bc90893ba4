"""A simulated cell on a simulated controller: its inputs change at exact times of the machine, its outputs are heard as they are set."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

from yarclang.hir import Program
from yarclang.runtime.notices import Wanted
from yarclang.simulated_cell.camera import Camera, CameraForm, Given
from yarclang.simulated_cell.inputs import Inputs, Set
from yarclang.simulated_cell.script import Change, Known, known_in

if TYPE_CHECKING:
    from yarclang.cell.model import Cell, Parts
    from yarclang.robot.model import Array, Robot
    from yarclang.simulated_cell.sensing import Sensing

LOOKS_EACH = 0.02
"""Time between two looks of the sensors [s]."""


class Companion(Protocol):
    """What goes on beside a simulated controller."""

    @property
    def next_event(self) -> float:
        """When it has something to do next [s of the controller]; -inf for now."""

    def handle(self) -> None:
        """Do what is due by the controller's time."""


class SimulatedController(Protocol):
    """A simulated controller, as the machines around it see it. `read` may be called in any thread."""

    @property
    def now(self) -> float:
        """Its time [s]."""

    def join(self, companion: Companion) -> None:
        """Let something go on beside it."""

    def define(self, variable: str) -> None:
        """Let the variable of an input or output that points nowhere be one of its own."""

    def read(self, variable: str) -> float:
        """Return the value of a variable."""

    def write(self, variable: str, value: float) -> None:
        """Give a variable a value."""

    def watch(self, variable: str, heard: Callable[[float], None]) -> None:
        """Let a function hear each value that a variable gets."""

    def positions(self, motors: Sequence[int]) -> Array:
        """Return where motors are (n,) [counts]."""


class SimulatedCell:
    """The machines around a simulated robot.

    `begin`, `reached`, `set` and `value` may be called in any thread: they take effect at the machine's next instant. All else belongs to the machine's.

    Args:
        script: what the machines do.
        known: the names of inputs and outputs, for those who set them by hand.
        settings: inputs that have a value from the beginning of the simulation on.
        cell: with sensors and the parts that they see, for `robot`; None: there are none.
        robot: that is simulated.
        waits: True if times of the script count from `begin` on; else they do from when the machine gets its cell.
        cameras: that answer programs which take values from outside.
    """

    def __init__(
        self,
        script: Iterable[Change] = (),
        known: Known | None = None,
        *,
        settings: Iterable[Change] = (),
        cell: Cell | None = None,
        robot: Robot | None = None,
        waits: bool = False,
        cameras: Iterable[CameraForm] = (),
    ) -> None:
        self.known = known or Known({}, {})
        self._inputs = Inputs(script)
        self._settings = tuple(settings)
        self._waits = waits
        self._begun = False
        self._listener: Callable[[Set], object] | None = None
        self._known_values: dict[str, float] = {}
        self._said: deque[Callable[[float], None]] = deque()
        self._machine: SimulatedController | None = None
        self._robot = robot
        self._sensing: Sensing | None = None
        self._since = 0.0
        self._looks = 0
        self._cameras = tuple(Camera(one) for one in cameras)
        self._receiver: Callable[[Given], object] | None = None
        if cell is not None and robot is not None and (cell.sensors or self._cameras):
            from yarclang.simulated_cell.sensing import Sensing

            self._sensing = Sensing(robot, cell)

    def attach(self, machine: SimulatedController) -> None:
        """Become the cell of a machine, whose time isn't passing yet."""
        self._machine = machine
        for driven in self._inputs.driven:
            machine.define(driven)
        self._since = machine.now
        moving = self._sensing.watched if self._sensing is not None else frozenset()
        for variable in sorted(self._inputs.watched | moving):
            machine.define(variable)
            machine.watch(variable, self._heard(variable))
        machine.join(self)
        self._look()
        for one in self._settings:
            self._inputs.set(one.variable, one.value, machine.now)
        if not self._waits:
            self._start(machine.now)
        self.handle()

    # in any thread

    def begin(self) -> None:
        """Say that a run begins: times count from here, if it is the first one."""
        self._said.append(self._start if self._waits else lambda now: self._inputs.reached("", now))

    def know(self, program: Program | None) -> None:
        """Learn the names of a program that is run, for those who set inputs by hand."""
        if program is not None:
            more, known = known_in(program, program.cell), self.known
            self.known = Known(
                {**known.inputs, **more.inputs}, {**known.outputs, **more.outputs}, signal=known.signal
            )

    def reached(self, place: str) -> None:
        """Say which command the program has reached; empty: none."""
        self._said.append(lambda now: self._inputs.reached(place, now))

    def listen(self, listener: Callable[[Set], object] | None) -> None:
        """Let a function hear each change of an input, in the machine's thread; None: nobody hears it."""
        self._listener = listener

    def wanted(self, wanted: Wanted | None) -> None:
        """Say which values the program takes from outside; None: none any more."""
        if self._cameras:
            self._said.append(lambda now: self._asked(wanted, now))

    def receive(self, receiver: Callable[[Given], object] | None) -> None:
        """Let a function get what cameras send, in the machine's thread; None: nobody gets it."""
        self._receiver = receiver

    def set(self, variable: str, value: float) -> None:
        """Set an input by hand."""
        self._said.append(lambda now: self._inputs.set(variable, value, now))

    def value(self, variable: str) -> float | None:
        """Return the value of an input or output; None before a machine has this cell. Both are plain memory, which may be read in any thread."""
        machine = self._machine
        return None if machine is None else machine.read(variable)

    def place(self, parts: Parts, cell: Cell) -> None:
        """Let parts be where somebody says, for the sensors: `cell` is the reading of its file that they belong to."""
        sensing = self._sensing
        if sensing is not None:
            self._said.append(lambda _: sensing.place(parts, cell))

    # in the machine's

    @property
    def next_event(self) -> float:
        """When something happens next [s]."""
        if self._said:
            return -math.inf
        due = min((self._inputs.next_due, *(one.next_due for one in self._cameras)))
        return due if self._sensing is None else min(due, self._next_look)

    @property
    def _next_look(self) -> float:
        return self._since + self._looks * LOOKS_EACH

    def handle(self) -> None:
        """Do what is due now."""
        machine = self._machine
        assert machine is not None, "attach it first"
        while self._said:
            self._said.popleft()(machine.now)
        if self._sensing is not None and machine.now >= self._next_look:
            self._look()
        self._answer(machine.now)
        for one in self._inputs.advance(machine.now):
            machine.define(one.variable)
            machine.write(one.variable, one.value)
            if self._known_values.get(one.variable, 0.0) != one.value and self._listener is not None:
                self._listener(one)
            self._known_values[one.variable] = one.value

    def _asked(self, wanted: Wanted | None, now: float) -> None:
        for one in self._cameras:
            one.wanted(wanted, now)

    def _answer(self, now: float) -> None:
        """Let the cameras send what is due."""
        sensing = self._sensing
        if sensing is None:
            return
        for camera in self._cameras:
            if camera.next_due > now:
                continue
            for given in camera.answers(now, sensing.parts, lambda: sensing.flange(self._joints())):
                if self._receiver is not None:
                    self._receiver(given)

    def _look(self) -> None:
        """Let the sensors look, at multiples of `LOOKS_EACH`."""
        machine, sensing = self._machine, self._sensing
        if machine is None or sensing is None:
            return
        for variable, value in sensing.look(self._joints(), machine.now).items():
            self._inputs.sense(variable, value, machine.now)
        self._looks += 1

    def _joints(self) -> Array:
        from yarclang.robot.actuation import from_counts

        machine, robot = self._machine, self._robot
        assert machine is not None
        assert robot is not None
        return from_counts(robot, machine.positions(robot.controller.motors))

    def _start(self, now: float) -> None:
        if not self._begun:
            self._begun = True
            self._inputs.start(now)

    def _heard(self, variable: str) -> Callable[[float], None]:
        machine = self._machine
        assert machine is not None
        sensing = self._sensing
        moves = sensing is not None and variable in sensing.watched

        def heard(value: float) -> None:
            if sensing is not None and moves:
                sensing.output_changed(variable, value, self._joints())
            self._inputs.output_changed(variable, value, machine.now)

        return heard
