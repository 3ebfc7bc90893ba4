"""What moves the motors of a coordinate system: one piece after another, at the pace of its time base."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from yarclang.simulator.motion.motors import LAG, Motor, first_trip
from yarclang.simulator.motion.pieces import Array, Motion, Piece, Standing, Travel
from yarclang.simulator.motion.timebase import TimeMap, slew

_PIECES = 4
"""How many pieces the control points of a spline reach: so many are looked at closely behind one that may trip."""


class Surroundings(Protocol):
    """What a drive needs of the machine."""

    @property
    def now(self) -> float:
        """[s]."""
        ...

    def tripped(self, motor: Motor, cause: str) -> None:
        """A motor has met a limit, or a fatal following error."""
        ...

    def changed(self, motors: Sequence[Motor]) -> None:
        """Motors move otherwise from now on: for the recorder."""
        ...


class Watch:
    """Looks whether the motors of a coordinate system trip on its pieces. Most pieces are far from anything."""

    def __init__(self, motors: list[Motor]) -> None:
        self.motors = motors
        self._bounds: tuple[Array, Array, Array] | None = None
        self._suspect = 0

    def look_again(self) -> None:
        """What may trip a motor has changed."""
        self._bounds = None
        self._suspect = _PIECES

    def first_trip(self, piece: Piece) -> tuple[float, Motor, str] | None:
        """The first time [s] within a piece at which a motor trips, which, and why."""
        least, most, fastest = self._bounds or self._bound()
        low, high, speed = piece.reach()
        if ((low < least) | (high > most) | (speed > fastest)).any():
            self._suspect = _PIECES
        if not self._suspect:
            return None
        self._suspect -= 1
        return first_trip(piece, self.motors)

    def _bound(self) -> tuple[Array, Array, Array]:
        """Positions [counts] and speeds [counts/s] (n,) at which nothing trips: least, most, fastest."""
        limits = [motor.limits() for motor in self.motors]
        slack = [
            motor.fatal_limit() - abs(motor.disturbance) if not any(motor.switches.values()) else 0.0
            for motor in self.motors
        ]
        margin = np.minimum(np.abs(slack), 1e9)
        self._bounds = (
            np.array([least for least, _ in limits]) + margin,
            np.array([most for _, most in limits]) - margin,
            np.array(slack) / LAG,
        )
        return self._bounds


class Drive:
    """Executes pieces with the motors of coordinate system `number`; the %, H and R commands set its pace.

    Attributes:
        motors: in the order of their numbers.
        map: program time against real time.
        piece: what is executed; None while nothing is.
        begin: its beginning in program time [s].
        end: where the motors stand behind the last piece (n,) [counts].
        held: whether H holds.
        held_at: where the motors came to rest in a hold (n,) [counts]; None until then.
    """

    def __init__(self, number: int, variables: list[float], outside: Surroundings) -> None:
        self._slew_of_override = 5000 + 100 * number + 94
        self._slew_of_hold = 5000 + 100 * number + 95
        self._variables = variables
        self._outside = outside
        self.clear()

    def clear(self) -> None:
        """As at power-up: no motors."""
        self.percent = 100.0
        self.map = TimeMap(since=self._outside.now, program=0.0)
        self.piece: Piece | None = None
        self.begin = 0.0
        self.held = False
        self.connect([])

    def connect(self, motors: list[Motor]) -> None:
        """These are its motors from now on; nothing moves."""
        self.motors = motors
        self.held_at: Array | None = None
        self.end: Array = np.zeros(len(motors))
        self._ends_at = self._trips_at = math.inf
        self._trip: tuple[float, Motor, str] | None = None
        self._watch = Watch(motors)
        self._last: tuple[float, tuple[Array, Array]] | None = None

    # what the motors do

    @property
    def motion(self) -> Motion:
        """What the motors do now."""
        if self.piece is None:
            return Standing(self.end)
        return Travel(self.piece, self.begin, self.map)

    def place(self, time: float) -> tuple[Array, Array]:
        """Positions [counts] and velocities [counts/s] of all motors at an instant [s]."""
        if self._last is not None and self._last[0] == time:
            return self._last[1]
        found = self.motion.at(time)
        self._last = time, found
        return found

    def places(self) -> Array:
        """Where all motors are commanded to be now (n,) [counts], whoever moves them."""
        now = self._outside.now
        return np.array([motor.place(now)[0] for motor in self.motors])

    # pieces

    def start_here(self) -> None:
        """The next piece begins where the motors are, unless they come from another piece."""
        if any(motor.driver is None or motor.driver[0] is not self for motor in self.motors):
            self.end = self.places()
            self.begin = self.map.program_time(self._outside.now)

    def execute(self, piece: Piece) -> None:
        """Begin a piece at this instant."""
        self.piece = piece
        self._last = None
        if any(motor.driver is None for motor in self.motors):
            self._take()
        self._trip = self._watch.first_trip(piece)
        self._time()
        self._outside.changed(self.motors)

    def _take(self) -> None:
        """The motors follow the pieces."""
        if self.piece is not None:
            for index, motor in enumerate(self.motors):
                motor.profile = motor.trip = None
                motor.driver = self, index

    def _time(self) -> None:
        """Find out when the piece ends, and when a motor trips on it."""
        if self.piece is not None:
            self._ends_at = self.map.instant(self.begin + self.piece.duration)
            self._trips_at = math.inf if self._trip is None else self.map.instant(self.begin + self._trip[0])

    def stand(self) -> None:
        """No piece comes: the motors stand at `end`."""
        self._forget()
        for motor, place in zip(self.motors, self.end, strict=True):
            if motor.driver is not None and motor.driver[0] is self:
                motor.driver = None
                motor.stand = float(place)
        self._outside.changed(self.motors)

    def leave(self) -> None:
        """The motors are moved, or stopped, by something else: no hold any more, and time goes on at its pace."""
        self._forget()
        self.held, self.held_at = False, None
        rate = self.percent / 100.0
        if self.map.last != rate or self.map.first != rate:
            now = self._outside.now
            self.map = TimeMap(now, self.map.program_time(now), rate, rate)

    def _forget(self) -> None:
        self.piece = self._trip = self._last = None
        self._ends_at = self._trips_at = math.inf

    def look_again(self) -> None:
        """What may trip a motor has changed."""
        self._watch.look_again()
        if self.piece is not None:
            self._trip = self._watch.first_trip(self.piece)
            self._time()

    # pace

    def override(self, percent: float) -> None:
        """The % command: the time base goes there at Isx94."""
        self.percent = percent
        if not self.held:
            self._pace(percent / 100.0, self._slew_of_override)

    def hold(self) -> None:
        """H: the time base goes to 0 at Isx95, on the path."""
        if not self.held:
            self.held = True
            self._pace(0.0, self._slew_of_hold)

    def go_on(self) -> None:
        """R behind a hold: the time base goes back at Isx95."""
        self.held, self.held_at = False, None
        self._take()
        self._pace(self.percent / 100.0, self._slew_of_hold)

    def _pace(self, rate: float, number: int) -> None:
        slope = slew(self._variables[10], self._variables[number])
        self.map = self.map.towards(self._outside.now, rate, slope)
        self._last = None
        if self.piece is not None:
            self._time()
            self._outside.changed(self.motors)

    def _stand_held(self) -> None:
        """The hold is reached: motors may be jogged away."""
        self.held_at = self.places()
        if self.piece is not None:
            for motor in self.motors:
                motor.hold(self._outside.now)

    # time

    @property
    def next_event(self) -> float:
        """When something is to be done here [s]."""
        when = min(self._ends_at, self._trips_at)
        if self.held and self.held_at is None:
            when = min(when, self.map.settled)
        return when

    def handle(self) -> bool:
        """Do what is due now; True where the piece has ended, and another may begin."""
        now = self._outside.now
        if self.held and self.held_at is None and now >= self.map.settled:
            self._stand_held()
        if self._trip is not None and now >= self._trips_at:
            self._outside.tripped(*self._trip[1:])
        elif self.piece is not None and now >= self._ends_at:
            self.begin += self.piece.duration
            self.piece = None
            return True
        return False
