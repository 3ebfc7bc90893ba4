"""The machines around a simulated robot, connected to the simulated controller.

Inputs from the machines change at exact times of the controller's clock. Changes of outputs take effect at
once.
"""

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
"""Period at which sensors are read [s]."""


class Companion(Protocol):
    """An object that runs in the time of a simulated controller."""

    @property
    def next_event(self) -> float:
        """Time of the companion's next event by the controller's clock [s]; -inf if an event is due now."""

    def handle(self) -> None:
        """Handle the events that are due at the controller's present time."""


class SimulatedController(Protocol):
    """A simulated controller as seen by the machines around it. `read` may be called in any thread."""

    @property
    def now(self) -> float:
        """Virtual time of the controller [s]."""

    def join(self, companion: Companion) -> None:
        """Add a companion that runs in the controller's time."""

    def define(self, variable: str) -> None:
        """Give a value of its own to a controller variable without an address, so that the variable can serve
        as an input or output.
        """

    def read(self, variable: str) -> float:
        """Return the value of a variable."""

    def write(self, variable: str, value: float) -> None:
        """Assign a value to a variable."""

    def watch(self, variable: str, heard: Callable[[float], None]) -> None:
        """Call a function with each value that is assigned to a variable."""

    def positions(self, motors: Sequence[int]) -> Array:
        """Return the commanded positions of motors (n,) [counts]."""


class SimulatedCell:
    """The machines around a simulated robot.

    The methods from `begin` to `place` may be called in any thread. They take effect at the controller's next
    event. All other methods must be called in the controller's thread.

    Args:
        script: the changes of inputs that the machines make.
        known: names of inputs and outputs that can be set by hand.
        settings: initial values of inputs.
        cell: the cell of the robot, with sensors and the parts that they see; None if there is none.
        robot: the simulated robot.
        waits: True if times of the script count from the first `begin`. Otherwise they count from `attach`.
        cameras: cameras that send values to programs that accept values from other processes.
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
        """Connect the machines to a controller whose clock hasn't started."""
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
        """Report the start of a program. If the cell was made with `waits`, the times of the script count
        from the first start.
        """
        self._said.append(self._start if self._waits else lambda now: self._inputs.reached("", now))

    def know(self, program: Program | None) -> None:
        """Add the names that a program declares, so that its inputs can be set by hand while it runs."""
        if program is not None:
            more, known = known_in(program, program.cell), self.known
            self.known = Known(
                {**known.inputs, **more.inputs}, {**known.outputs, **more.outputs}, signal=known.signal
            )

    def reached(self, place: str) -> None:
        """Report the place of the command that the program has reached; empty for none."""
        self._said.append(lambda now: self._inputs.reached(place, now))

    def listen(self, listener: Callable[[Set], object] | None) -> None:
        """Set the function that is called, in the controller's thread, for each change of an input; None:
        no function is called.
        """
        self._listener = listener

    def wanted(self, wanted: Wanted | None) -> None:
        """Report to the cameras which values the program waits for; None if it doesn't wait for any."""
        if self._cameras:
            self._said.append(lambda now: self._asked(wanted, now))

    def receive(self, receiver: Callable[[Given], object] | None) -> None:
        """Set the function that is called, in the controller's thread, for values that cameras send; None: no
        function is called.
        """
        self._receiver = receiver

    def set(self, variable: str, value: float) -> None:
        """Set an input by hand."""
        self._said.append(lambda now: self._inputs.set(variable, value, now))

    def value(self, variable: str) -> float | None:
        """Return the value of an input or output; None before `attach`.

        Inputs and outputs are plain memory, which any thread may read.
        """
        machine = self._machine
        return None if machine is None else machine.read(variable)

    def place(self, parts: Parts, cell: Cell) -> None:
        """Set the places of the cell's parts that sensors and cameras see. `cell` is the cell, as read from
        its file, to which these parts belong.
        """
        sensing = self._sensing
        if sensing is not None:
            self._said.append(lambda _: sensing.place(parts, cell))

    # in the controller's thread

    @property
    def next_event(self) -> float:
        """Time of the next event [s]."""
        if self._said:
            return -math.inf
        due = min((self._inputs.next_due, *(one.next_due for one in self._cameras)))
        return due if self._sensing is None else min(due, self._next_look)

    @property
    def _next_look(self) -> float:
        return self._since + self._looks * LOOKS_EACH

    def handle(self) -> None:
        """Handle the events that are due."""
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
        """Let the cameras send the values that are due."""
        sensing = self._sensing
        if sensing is None:
            return
        for camera in self._cameras:
            if camera.next_due > now:
                continue
            sensing.parts = camera.laid(sensing.parts)
            for given in camera.answers(now, sensing.parts, lambda: sensing.flange(self._joints())):
                if self._receiver is not None:
                    self._receiver(given)

    def _look(self) -> None:
        """Read the sensors. Called at multiples of `LOOKS_EACH`."""
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
