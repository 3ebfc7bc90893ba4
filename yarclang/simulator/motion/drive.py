"""The drive of a coordinate system, which moves the system's motors piece by piece at the rate of the time
base. A piece is a part of the motion in which all positions are cubics in time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from yarclang.simulator.motion.motors import LAG, Motor, first_trip
from yarclang.simulator.motion.pieces import Array, Motion, Piece, Standing, Travel
from yarclang.simulator.motion.timebase import TimeMap, slew

_PIECES = 4
"""Number of pieces of a spline motion that depend on one control point. If a motor may trip on a piece, this
number of pieces is examined from that piece on.
"""


class Surroundings(Protocol):
    """The controller as seen by a drive."""

    @property
    def now(self) -> float:
        """Virtual time [s]."""
        ...

    def tripped(self, motor: Motor, cause: str) -> None:
        """Handle a limit or a fatal following error of a motor."""
        ...

    def changed(self, motors: Sequence[Motor]) -> None:
        """Record that motors move differently from now on."""
        ...


class Watch:
    """Finds the pieces of a motion on which motors of a coordinate system trip: a limit or a following error
    stops them. Simple bounds exclude most pieces quickly.
    """

    def __init__(self, motors: list[Motor]) -> None:
        self.motors = motors
        self._bounds: tuple[Array, Array, Array] | None = None
        self._suspect = 0

    def look_again(self) -> None:
        """Update the bounds after a change of limits or switches."""
        self._bounds = None
        self._suspect = _PIECES

    def first_trip(self, piece: Piece) -> tuple[float, Motor, str] | None:
        """Return the first time in a piece at which a motor trips [s], the motor, and the cause; None if
        no motor trips.
        """
        least, most, fastest = self._bounds or self._bound()
        low, high, speed = piece.reach()
        if ((low < least) | (high > most) | (speed > fastest)).any():
            self._suspect = _PIECES
        if not self._suspect:
            return None
        self._suspect -= 1
        return first_trip(piece, self.motors)

    def _bound(self) -> tuple[Array, Array, Array]:
        """Return bounds within which no motor trips, as (n,) each: smallest and largest position [counts],
        largest speed [counts/s].
        """
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
    """Executes pieces of motion with the motors of coordinate system `number`. The commands %, H and R set
    the rate of the time base.

    Attributes:
        motors: motors of the coordinate system, in the order of their numbers.
        percent: the override [%].
        map: program time as a function of real time.
        piece: the piece that is executed; None if there is none.
        begin: start of that piece in program time [s].
        end: positions of the motors after the last piece (n,) [counts].
        held: True in a hold (H), also while the motors slow down for it.
        held_at: positions at which the motors came to rest in a hold (n,) [counts]; None before they
            rest.
    """

    def __init__(self, number: int, variables: list[float], outside: Surroundings) -> None:
        self._slew_of_override = 5000 + 100 * number + 94
        self._slew_of_hold = 5000 + 100 * number + 95
        self._variables = variables
        self._outside = outside
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up: no motors."""
        self.percent = 100.0
        self.map = TimeMap(since=self._outside.now, program=0.0)
        self.piece: Piece | None = None
        self.begin = 0.0
        self.held = False
        self.connect([])

    def connect(self, motors: list[Motor]) -> None:
        """Use other motors from now on. This doesn't move them."""
        self.motors = motors
        self.held_at: Array | None = None
        self.end: Array = np.zeros(len(motors))
        self._ends_at = self._trips_at = math.inf
        self._trip: tuple[float, Motor, str] | None = None
        self._watch = Watch(motors)
        self._last: tuple[float, tuple[Array, Array]] | None = None

    # motion of the motors

    @property
    def motion(self) -> Motion:
        """The current motion of the motors."""
        if self.piece is None:
            return Standing(self.end)
        return Travel(self.piece, self.begin, self.map)

    def place(self, time: float) -> tuple[Array, Array]:
        """Return positions [counts] and velocities [counts/s] of all motors at a time [s]."""
        if self._last is not None and self._last[0] == time:
            return self._last[1]
        found = self.motion.at(time)
        self._last = time, found
        return found

    def places(self) -> Array:
        """Return the commanded positions of all motors now (n,) [counts], including those of jogs, home
        searches and aborts.
        """
        now = self._outside.now
        return np.array([motor.place(now)[0] for motor in self.motors])

    # pieces

    def start_here(self) -> None:
        """Let the next piece begin at the motors' present positions, unless this drive already moves all
        motors. A motor at rest, or with a motion of its own, may have left the end of the last piece.
        """
        if any(motor.driver is None or motor.driver[0] is not self for motor in self.motors):
            self.end = self.places()
            self.begin = self.map.program_time(self._outside.now)

    def execute(self, piece: Piece) -> None:
        """Begin a piece now."""
        self.piece = piece
        self._last = None
        if any(motor.driver is None for motor in self.motors):
            self._take()
        self._trip = self._watch.first_trip(piece)
        self._time()
        self._outside.changed(self.motors)

    def _take(self) -> None:
        """Connect the motors to this drive, so that they follow the current piece."""
        if self.piece is not None:
            for index, motor in enumerate(self.motors):
                motor.profile = motor.trip = None
                motor.driver = self, index

    def _time(self) -> None:
        """Compute the times at which the current piece ends, and at which a motor trips on it."""
        if self.piece is not None:
            self._ends_at = self.map.instant(self.begin + self.piece.duration)
            self._trips_at = math.inf if self._trip is None else self.map.instant(self.begin + self._trip[0])

    def stand(self) -> None:
        """Leave the motors at rest at `end`. There is no current piece any more."""
        self._forget()
        for motor, place in zip(self.motors, self.end, strict=True):
            if motor.driver is not None and motor.driver[0] is self:
                motor.driver = None
                motor.stand = float(place)
        self._outside.changed(self.motors)

    def leave(self) -> None:
        """Stop moving the motors, so that another motion may use them. A hold ends, and the rate of the time
        base becomes the override.
        """
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
        """Examine the current piece again after a change of limits or switches."""
        self._watch.look_again()
        if self.piece is not None:
            self._trip = self._watch.first_trip(self.piece)
            self._time()

    # rate

    def override(self, percent: float) -> None:
        """Execute %: change the rate of the time base, at the slew rate Isx94."""
        self.percent = percent
        if not self.held:
            self._pace(percent / 100.0, self._slew_of_override)

    def hold(self) -> None:
        """Execute H: reduce the rate of the time base to 0, at the slew rate Isx95."""
        if not self.held:
            self.held = True
            self._pace(0.0, self._slew_of_hold)

    def go_on(self) -> None:
        """Execute R after a hold: restore the rate of the time base, at the slew rate Isx95."""
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
        """Record that the motors have come to rest in a hold. From now on, they may be jogged."""
        self.held_at = self.places()
        if self.piece is not None:
            for motor in self.motors:
                motor.hold(self._outside.now)

    # time

    @property
    def next_event(self) -> float:
        """Time of its next event [s]."""
        when = min(self._ends_at, self._trips_at)
        if self.held and self.held_at is None:
            when = min(when, self.map.settled)
        return when

    def handle(self) -> bool:
        """Handle the events that are due. Return True if the current piece has ended, so that another may
        begin.
        """
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
