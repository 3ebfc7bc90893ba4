"""A coordinate system, which executes a program: it moves, holds and stops its motors."""

from __future__ import annotations

import math
from collections import deque
from typing import Protocol

import numpy as np

from yarclang.pmac.errors import (
    BOTH_LIMITS,
    BUSY_PROGRAM,
    MOVE_IN_PROGRESS,
    MOVED_AWAY,
    NO_MOTORS,
    NOT_ACTIVATED,
    OPEN_LOOP,
)
from yarclang.simulator.motion import drive
from yarclang.simulator.motion.axes import AxisDefinition, axes_of
from yarclang.simulator.motion.drive import Drive
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.pieces import Piece, standing
from yarclang.simulator.motion.sequences import SEQUENCES, Sequence, rapid
from yarclang.simulator.motion.steps import Step
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.programs import surroundings
from yarclang.simulator.programs.ahead import Ahead
from yarclang.simulator.programs.calculation import Calculation
from yarclang.simulator.state.registers import Seen

_AWAY = 1.0
"""Largest distance by which motors may have been moved during a hold if R is to resume the program [counts]
(assumed).
"""


class Outside(drive.Surroundings, surroundings.Surroundings, Protocol):
    """The controller as seen by a coordinate system."""

    def defined(self) -> None:
        """Report to the machine that axis definitions have changed."""
        ...


class CoordinateSystem:
    """One coordinate system of the controller.

    Attributes:
        number: 1 to 16.
        outside: the machine.
        definitions: axis definitions by motor.
        calculation: calculation of the system's program, which yields steps.
        ahead: steps that are calculated but not begun.
        drive: executes the motions of the steps.
        running: True while a program runs (R or S).
        single_step: True if the program was started by S.
        resume_error: True if R was refused because motors were moved away in a hold.
        limit_stop: True after a stop at a limit.
        dwell_until: end of a DWELL [s]; infinite without one.
        homing: motors whose home search the program waits for.
    """

    def __init__(self, number: int, variables: list[float], scope: Seen, outside: Outside) -> None:
        self.number = number
        self.outside = outside
        self.calculation = Calculation(number, scope, outside)
        self.ahead = Ahead(self.calculation, outside)
        self.drive = Drive(number, variables, outside)
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up: no axes, no rotary, no running program."""
        self.definitions: dict[int, AxisDefinition] = {}
        self.calculation.clear()
        self.ahead.clear()
        self.drive.clear()
        self.running = False
        self.single_step = False
        self.resume_error = False
        self.limit_stop = False
        self.dwell_until = math.inf
        self.homing: list[Motor] = []
        self._stopping = False
        self._sequence: Sequence | None = None
        self._rest: deque[Piece] = deque()

    @property
    def motors(self) -> list[Motor]:
        """Its motors, in the order of their numbers."""
        return self.drive.motors

    @property
    def dwelling(self) -> bool:
        """True during a DWELL."""
        return self.dwell_until < math.inf

    @property
    def moving(self) -> bool:
        """True during a move, a pause or a home search."""
        return self.drive.piece is not None or self.dwelling or bool(self.homing)

    @property
    def busy(self) -> bool:
        """True while a program runs, or while its last moves are executed."""
        return self.running or self.moving

    # axes

    def define(self, motor: Motor, definition: AxisDefinition | None) -> None:
        """Set the axis definition of a motor, or remove it (None).

        Raises:
            Refusal: ERR001 while a program runs.
        """
        if self.running or self.drive.piece is not None:
            raise Refusal(BUSY_PROGRAM)
        self.definitions.pop(motor.number, None)
        motors = [m for m in self.motors if m is not motor]
        if definition is not None:
            self.definitions[motor.number] = definition
            motors = sorted([*motors, motor], key=lambda m: m.number)
        self.drive.connect(motors)
        self.calculation.moves.connect(axes_of([(m.number, self.definitions[m.number]) for m in motors]))
        self.pmatch()
        self.outside.defined()

    def pmatch(self) -> None:
        """Compute the axis positions from the commanded positions of the motors."""
        if self.motors:
            self.calculation.moves.match(self.drive.places())

    # commands

    def run(self, single_step: bool = False) -> None:
        """Execute R, or S for a single step.

        Raises:
            Refusal: ERR010 to ERR017 (facts 5.2).
        """
        if not self.motors:
            raise Refusal(NO_MOTORS)
        if self.drive.held:
            self._resume()
            if self.busy:
                return
        if self.running and not self.single_step and not single_step:
            return
        self._check_motors()
        self.calculation.check()
        if not self.moving:
            if not self.ahead.steps:
                self.pmatch()
            self.drive.end = self.drive.places()
        self.ahead.begin(single_step)
        self.running, self.single_step = True, single_step
        self.resume_error = self.limit_stop = self._stopping = False
        if not self.moving:
            self._go_on()

    def _check_motors(self) -> None:
        """Check that all motors can move.

        Raises:
            Refusal: if a motor can't.
        """
        now = self.outside.now
        if not all(motor.activated for motor in self.motors):
            raise Refusal(NOT_ACTIVATED)
        if not all(motor.closed for motor in self.motors):
            raise Refusal(OPEN_LOOP)
        if any(all(motor.set_limits(now)) for motor in self.motors):
            raise Refusal(BOTH_LIMITS)
        if any(motor.jogging for motor in self.motors):
            raise Refusal(MOVE_IN_PROGRESS)

    def _resume(self) -> None:
        """Resume the program after a hold.

        Raises:
            Refusal: if a motor moves, isn't where it was held, or is open-loop.
        """
        if any(motor.jogging for motor in self.motors):
            raise Refusal(MOVE_IN_PROGRESS)
        held_at = self.drive.held_at
        if held_at is not None:
            if np.any(np.abs(self.drive.places() - held_at) > _AWAY):
                self.resume_error = True
                raise Refusal(MOVED_AWAY)
            if any(not motor.closed for motor in self.motors):
                raise Refusal(OPEN_LOOP)
        self.drive.go_on()
        if self.running and not self.moving:
            self._go_on()

    def quit(self) -> None:
        """Execute Q: stop calculating. Moves that are already calculated are still executed."""
        self.ahead.stop()
        self.running = self.running and self.moving

    def end_of_move(self) -> None:
        r"""Execute /: stop after the current move. R continues with the next one."""
        self.ahead.stop()
        self._stopping = True
        if self._sequence is not None:
            self._sequence.stop = True
        self.running = self.running and self.moving

    def abort(self) -> None:
        """Execute A: stop each motor at Ixx15, and close open loops."""
        now = self.outside.now
        for motor in self.motors:
            if motor.closed:
                motor.abort(now)
            elif motor.activated and not motor.amplifier_fault:
                motor.close(now)
        self._leave()
        self.outside.changed(self.motors)

    def stop_program(self) -> None:
        """End the program. The motors stop at their commanded positions."""
        for motor in self.motors:
            motor.hold(self.outside.now)
        self._leave()

    def _leave(self) -> None:
        """Discard the calculated steps. The rate of the time base becomes the override."""
        self.running = self.single_step = False
        self.ahead.leave()
        self.drive.leave()
        self._rest.clear()
        self._sequence = None
        self.dwell_until = math.inf
        self.homing = []

    # time

    @property
    def next_event(self) -> float:
        """Time of its next event [s]."""
        return min(self.drive.next_event, self.ahead.retry_at, self.dwell_until)

    def handle(self) -> None:
        """Handle the events that are due."""
        now = self.outside.now
        if self.drive.handle():
            self._go_on()
        elif now >= self.dwell_until:
            self.dwell_until = math.inf
            self._go_on()
        elif now >= self.ahead.retry_at:
            self.ahead.retry_at = math.inf
            if not self.moving:
                self._go_on()

    def wake(self) -> None:
        """Continue after a new line in the rotary, or after the end of a home search."""
        if self.homing and not any(motor.jogging for motor in self.homing):
            self.homing = []
            self._go_on()
        elif self.running and self.ahead.calculating and not self.moving:
            self._go_on()

    # the program

    def _go_on(self) -> None:
        """Begin whatever comes next: a piece of motion, a pause, or the end of the program."""
        if self.drive.held_at is not None:
            # In a hold the motors may be jogged away, so the next piece must wait for R.
            return
        steps = self.ahead.steps
        while True:
            if self._rest:
                self.drive.execute(self._rest.popleft())
                return
            self.ahead.fill()
            if self._sequence is not None:
                if found := self._sequence.next(steps):
                    piece, events = found
                    for event in events:
                        event()
                    self.drive.execute(piece)
                    return
                self.drive.end = self._sequence.end
                self._sequence = None
            if not steps or self._stopping or not self.running:
                self._idle()
                return
            if not self._start(steps[0]):
                return

    def _start(self, step: Step) -> bool:
        """Begin a step that doesn't blend with the step before it.

        Return True if the caller has to continue now: with the first piece of blended moves, or with the next
        step.
        """
        if step.kind == "move" and step.mode in SEQUENCES:
            self.drive.start_here()
            self._sequence = SEQUENCES[step.mode](self.drive.end, step)
            return True
        self.ahead.steps.popleft()
        for event in step.events:
            event()
        match step.kind:
            case "move":
                self.drive.start_here()
                begin = self.drive.end
                if step.mode == "RAPID":
                    self._rest.extend(rapid(self.motors, begin, step.target))
                if not self._rest:
                    self._rest.append(standing(max(step.time, self.outside.interrupt), begin))
                self.drive.end = step.target
                self.drive.execute(self._rest.popleft())
                return False
            case "dwell":
                self.drive.stand()
                self.dwell_until = self.outside.now + max(step.time, self.outside.interrupt)
                return False
            case "home":
                return self._home(step)
            case _:
                self.ahead.stop()
                self._idle()
                return False

    def _home(self, step: Step) -> bool:
        self.drive.stand()
        now = self.outside.now
        homing = [motor for motor in self.motors if motor.number in step.motors]
        for motor in homing:
            motor.zero(now) if step.time < 0 else motor.home(now)
        self.outside.changed(homing)
        self.homing = [motor for motor in homing if motor.jogging]
        return not self.homing

    def _idle(self) -> None:
        """Stop the motors at their present positions. The program ends if no more steps are to be
        calculated.
        """
        self.drive.stand()
        if not self.ahead.calculating:
            self.running = self.single_step = False
