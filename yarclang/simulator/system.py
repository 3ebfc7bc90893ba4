"""A coordinate system: runs a program, moves its motors, holds and stops them."""

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
from yarclang.simulator.axes import AxisDefinition, axes_of
from yarclang.simulator.calculation import Calculation, Surroundings
from yarclang.simulator.motors import LAG, Motor, first_trip
from yarclang.simulator.pieces import Array, Piece, Standing, Travel, standing, together, trapezoid
from yarclang.simulator.registers import Seen
from yarclang.simulator.reply import Refusal
from yarclang.simulator.sequences import SEQUENCES, Sequence
from yarclang.simulator.steps import Step
from yarclang.simulator.timebase import TimeMap, slew

_AHEAD = 2
"""Moves that are calculated before they are needed (TUM 339: two in SPLINE, and in LINEAR without segmentation)."""

_AWAY = 1.0
"""Counts that a motor may have been moved during a hold (assumed)."""


class Outside(Surroundings, Protocol):
    """What a coordinate system needs of the machine."""

    @property
    def now(self) -> float:
        """[s]."""
        ...

    def tripped(self, motor: Motor, cause: str) -> None:
        """A motor has met a limit, or a fatal following error."""
        ...

    def changed(self, motors: list[Motor]) -> None:
        """Motors move otherwise from now on: for the recorder."""
        ...

    def defined(self) -> None:
        """Axis definitions have changed."""
        ...


class CoordinateSystem:
    """Coordinate system `number`."""

    def __init__(self, number: int, variables: list[float], scope: Seen, outside: Outside) -> None:
        self.number = number
        self.variables = variables
        self.outside = outside
        self.calculation = Calculation(number, scope, outside)
        self.definitions: dict[int, AxisDefinition] = {}
        self.motors: list[Motor] = []
        self.clear()

    def clear(self) -> None:
        """As at power-up; definitions and rotary stay."""
        self.calculation.reset()
        self.running = False
        self.calculating = False
        self.single_step = False
        self.stepped = False
        self.stopping = False
        self.held = False
        self.run_time_error = False
        self.resume_error = False
        self.limit_stop = False
        self.percent = 100.0
        self.map = TimeMap(since=self.outside.now, program=0.0)
        self.steps: deque[Step] = deque()
        self.sequence: Sequence | None = None
        self.piece: Piece | None = None
        self.begin = 0.0
        self.move_ends_by_itself = True
        self.dwell_until: float | None = None
        self.homing: list[Motor] = []
        self.retry_at: float | None = None
        self.trip: tuple[float, Motor, str] | None = None
        self.trips_at = math.inf
        self.held_at: Array | None = None
        self._rest: deque[Piece] = deque()
        self._suspect = 0
        self._end: Array = np.zeros(len(self.motors))
        self._last: tuple[float, tuple[Array, Array]] | None = None
        self._bounds: tuple[Array, Array, Array] | None = None
        self._next_end = math.inf

    def variable(self, number: int) -> float:
        """Isx`number`."""
        return self.variables[5000 + 100 * self.number + number]

    # axes

    def define(self, motor: Motor, definition: AxisDefinition | None) -> None:
        """Define a motor's axes, or take its definition away.

        Raises:
            Refusal: ERR001 while a program runs here.
        """
        if self.running or self.piece is not None:
            raise Refusal(BUSY_PROGRAM)
        self.definitions.pop(motor.number, None)
        self.motors = [m for m in self.motors if m is not motor]
        if definition is not None:
            self.definitions[motor.number] = definition
            self.motors = sorted([*self.motors, motor], key=lambda m: m.number)
        self.calculation.axes = axes_of([(m.number, self.definitions[m.number]) for m in self.motors])
        self.calculation.counted = np.zeros(len(self.motors))
        self.pmatch()
        self.outside.defined()

    def pmatch(self) -> None:
        """Axis positions from the motors' commanded positions."""
        now = self.outside.now
        counts = np.array([motor.place(now)[0] for motor in self.motors])
        if len(counts):
            self.calculation.match(counts)
            self.calculation.counted = counts

    # commands

    @property
    def moving(self) -> bool:
        """Whether a move, a pause or what was calculated isn't done."""
        return self.piece is not None or self.dwell_until is not None or bool(self.homing)

    @property
    def busy(self) -> bool:
        """Whether a program runs, or its last moves."""
        return self.running or self.moving

    def run(self, single_step: bool = False) -> None:
        """R or S.

        Raises:
            Refusal: ERR010 to ERR017, as facts 5.2 say.
        """
        if not self.motors:
            raise Refusal(NO_MOTORS)
        now = self.outside.now
        if self.held:
            self._resume()
            if self.busy:
                return
        if self.running and not self.single_step and not single_step:
            return
        for motor in self.motors:
            if not motor.activated:
                raise Refusal(NOT_ACTIVATED)
        for motor in self.motors:
            if not motor.closed:
                raise Refusal(OPEN_LOOP)
        for motor in self.motors:
            if all(motor.set_limits(now)):
                raise Refusal(BOTH_LIMITS)
        if any(motor.jogging for motor in self.motors):
            raise Refusal(MOVE_IN_PROGRESS)
        self.calculation.check()
        if not self.moving:
            if not self.steps:
                self.pmatch()
            self._end = np.array([motor.place(now)[0] for motor in self.motors])
        self.running = self.calculating = True
        self.single_step = single_step
        self.run_time_error = self.resume_error = self.limit_stop = False
        self.stopping = self.stepped = False
        if not self.moving:
            self._go_on()

    def _resume(self) -> None:
        """Behind a hold: the motors must stand where they were held."""
        now = self.outside.now
        if any(motor.jogging for motor in self.motors):
            raise Refusal(MOVE_IN_PROGRESS)
        if self.held_at is not None:
            places = np.array([motor.place(now)[0] for motor in self.motors])
            if np.any(np.abs(places - self.held_at) > _AWAY):
                self.resume_error = True
                raise Refusal(MOVED_AWAY)
            if any(not motor.closed for motor in self.motors):
                raise Refusal(OPEN_LOOP)
        self.held, self.held_at = False, None
        self._drive()
        self._pace(self.percent / 100.0, 95)

    def hold(self) -> None:
        """H: the time base goes to 0 at Isx95, on the path."""
        if self.held:
            return
        self.held = True
        self._pace(0.0, 95)

    def override(self, percent: float) -> None:
        """The % command: the time base goes there at Isx94."""
        self.percent = percent
        if not self.held:
            self._pace(percent / 100.0, 94)

    def quit(self) -> None:
        """Q: no more is calculated; what was calculated is moved."""
        self.calculating = False
        self.running = self.running and self.moving
        if not self.moving:
            self.running = False
        self.retry_at = None

    def end_of_move(self) -> None:
        r"""/: the executing move is the last one; R goes on with the next."""
        self.calculating = False
        self.stopping = True
        self.retry_at = None
        if self.sequence is not None:
            self.sequence.stop = True
        if not self.moving:
            self.running = False

    def abort(self) -> None:
        """A: each motor stops at Ixx15, and open loops are closed."""
        now = self.outside.now
        for motor in self.motors:
            if motor.closed:
                motor.abort(now)
            elif motor.activated and not motor.amplifier_fault:
                motor.close(now)
        self._leave()
        self.outside.changed(self.motors)

    def stop_program(self) -> None:
        """The program ends, the motors stand where they are commanded to be."""
        now = self.outside.now
        for motor in self.motors:
            motor.hold(now)
        self._leave()

    def _leave(self) -> None:
        """Forget what was calculated; time goes on at its pace."""
        self.running = self.calculating = self.single_step = False
        self.steps.clear()
        self._rest.clear()
        self.sequence = self.piece = self.dwell_until = self.retry_at = self.trip = None
        self.homing = []
        self._next_end = self.trips_at = math.inf
        self.held, self.held_at = False, None
        self._last = None
        rate = self.percent / 100.0
        if self.map.last != rate or self.map.first != rate:
            self.map = TimeMap(self.outside.now, self.map.program_time(self.outside.now), rate, rate)

    def _pace(self, rate: float, number: int) -> None:
        now = self.outside.now
        slope = slew(self.variables[10], self.variable(number))
        self.map = self.map.towards(now, rate, slope)
        self._last = None
        if self.piece is not None:
            self._timed()
            self.outside.changed(self.motors)

    # motion

    def place(self, time: float) -> tuple[Array, Array]:
        """Positions [counts] and velocities [counts/s] of all motors at an instant [s]."""
        if self._last is not None and self._last[0] == time:
            return self._last[1]
        found = self.motion.at(time)
        self._last = time, found
        return found

    @property
    def motion(self) -> Travel | Standing:
        """What the motors do now."""
        if self.piece is None:
            return Standing(self._end)
        return Travel(self.piece, self.begin, self.map)

    @property
    def next_event(self) -> float:
        """When something is to be done here [s]."""
        when = min(self._next_end, self.trips_at)
        if self.dwell_until is not None:
            when = min(when, self.dwell_until)
        if self.retry_at is not None:
            when = min(when, self.retry_at)
        if self.held and self.held_at is None:
            when = min(when, self.map.settled)
        return when

    def handle(self) -> None:
        """Do what is due now."""
        now = self.outside.now
        if self.held and self.held_at is None and now >= self.map.settled:
            self._stand_held()
        if self.trip is not None and now >= self.trips_at:
            _, motor, cause = self.trip
            self.outside.tripped(motor, cause)
            return
        if self.piece is not None and now >= self._next_end:
            self.begin += self.piece.duration
            self.piece = None
            self._go_on()
        elif self.dwell_until is not None and now >= self.dwell_until:
            self.dwell_until = None
            self._go_on()
        elif self.retry_at is not None and now >= self.retry_at:
            self.retry_at = None
            if not self.moving:
                self._go_on()

    def wake(self) -> None:
        """A line has come into the rotary, or a motor has come home."""
        if self.homing and not any(motor.jogging for motor in self.homing):
            self.homing = []
            self._go_on()
        elif self.running and self.calculating and not self.moving:
            self._go_on()

    def _stand_held(self) -> None:
        """The hold is reached: motors may be jogged away."""
        places, _ = self.place(self.outside.now)
        if self.piece is not None:
            self.held_at = places.copy()
            for motor in self.motors:
                motor.hold(self.outside.now)
        else:
            self.held_at = np.array([motor.place(self.outside.now)[0] for motor in self.motors])

    def _drive(self) -> None:
        """The motors follow this coordinate system."""
        if self.piece is not None:
            for index, motor in enumerate(self.motors):
                motor.profile = motor.trip = None
                motor.driver = self, index

    def _go_on(self) -> None:
        """Begin what comes next, at this instant: the next piece, a pause, the end, or nothing."""
        while True:
            if self._rest:
                self._begin(self._rest.popleft())
                return
            self._fill()
            if self.sequence is not None:
                if found := self.sequence.next(self.steps):
                    piece, events = found
                    for event in events:
                        event()
                    self._begin(piece)
                    return
                self._end = self.sequence.end
                self.sequence = None
            if not self.steps or self.stopping or not self.running:
                self._idle()
                return
            if not self._start(self.steps[0]):
                return

    def _fill(self) -> None:
        """Calculate ahead."""
        steps = self.steps
        while self.calculating and len(steps) < _AHEAD and not (steps and steps[-1].breaks):
            if self.single_step and self.stepped:
                self.calculating = False
                return
            step = self.calculation.step()
            if self.calculation.failed:
                self.calculation.failed = False
                self.run_time_error = True
                self.calculating = False
                return
            if step is None:
                if self.calculation.waiting:
                    grid = self.outside.interrupt
                    self.retry_at = (math.floor(self.outside.now / grid + 1e-9) + 1) * grid
                return
            steps.append(step)
            self.stepped = True

    def _start(self, step: Step) -> bool:
        """Begin a step that nothing blends into; True if it is done already."""
        now = self.outside.now
        if step.kind == "move" and step.mode in SEQUENCES:
            self._stands()
            self.sequence = SEQUENCES[step.mode](self._end, step)
            return True
        self.steps.popleft()
        for event in step.events:
            event()
        match step.kind:
            case "move":
                self._stands()
                pieces = self._rapid(step) if step.mode == "RAPID" else [standing(step.time, self._end)]
                self._rest.extend(pieces)
                self._end = step.target
                self._begin(self._rest.popleft())
                return False
            case "dwell":
                self._idle_motors()
                self.dwell_until = now + max(step.time, self.outside.interrupt)
                return False
            case "home":
                self._idle_motors()
                self.homing = [motor for motor in self.motors if motor.number in step.motors]
                for motor in self.homing:
                    motor.zero(now) if step.time < 0 else motor.home(now)
                self.outside.changed(self.homing)
                self.homing = [motor for motor in self.homing if motor.jogging]
                return not self.homing
            case _:
                self.running = self.calculating = self.single_step = False
                self._idle()
                return False

    def _stands(self) -> None:
        now = self.outside.now
        if any(motor.driver is None or motor.driver[0] is not self for motor in self.motors):
            self._end = np.array([motor.place(now)[0] for motor in self.motors])
            self.begin = self.map.program_time(now)

    def _rapid(self, step: Step) -> list[Piece]:
        """RAPID: each motor by itself, at its own speed (Ixx22, or Ixx16 with Ixx90 = 1; TSRM 98)."""
        parts = [
            trapezoid(float(start), float(end), motor.rapid_speed(), *motor.jog_ramp())
            for motor, start, end in zip(self.motors, self._end, step.target, strict=True)
        ]
        pieces = together(parts, self._end)
        return pieces or [standing(self.outside.interrupt, self._end)]

    def _begin(self, piece: Piece) -> None:
        self.piece = piece
        self._last = None
        if any(motor.driver is None for motor in self.motors):
            self._drive()
        self._watch(piece)
        self._timed()
        self.outside.changed(self.motors)

    def _timed(self) -> None:
        if self.piece is None:
            return
        self._next_end = self.map.instant(self.begin + self.piece.duration)
        self.trips_at = math.inf if self.trip is None else self.map.instant(self.begin + self.trip[0])

    def _idle_motors(self) -> None:
        self.piece = None
        self._next_end = self.trips_at = math.inf
        self.trip = None
        self._last = None
        for motor, place in zip(self.motors, self._end, strict=True):
            if motor.driver is not None and motor.driver[0] is self:
                motor.driver = None
                motor.stand = float(place)
        self.outside.changed(self.motors)

    def _idle(self) -> None:
        """Nothing to do: the motors stand. The program runs on if more may come."""
        self._idle_motors()
        if not self.calculating:
            self.running = self.single_step = False

    # limits

    def look_again(self) -> None:
        """What may trip a motor has changed."""
        self._bounds = None
        self._suspect = 4
        if self.piece is not None:
            self._watch(self.piece)
            self._timed()

    def _watch(self, piece: Piece) -> None:
        """Find out whether a motor will trip on this piece. Most pieces are far from anything."""
        self.trip = None
        if self._bounds is None:
            limits = [motor.limits() for motor in self.motors]
            slack = [
                motor.fatal_limit() - abs(motor.disturbance) if not any(motor.switches.values()) else 0.0
                for motor in self.motors
            ]
            fastest = np.array(slack) / LAG
            margin = np.minimum(np.abs(slack), 1e9)
            self._bounds = (
                np.array([least for least, _ in limits]) + margin,
                np.array([most for _, most in limits]) - margin,
                fastest,
            )
        least, most, fastest = self._bounds
        low, high, speed = piece.reach()
        if ((low < least) | (high > most) | (speed > fastest)).any():
            self._suspect = 4
        if self._suspect:
            self._suspect -= 1
            self.trip = first_trip(piece, self.motors)
