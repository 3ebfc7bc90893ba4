"""A motor: where it is told to be, where it is, and the motions of its own (jog, home, abort).

The motor follows with a lag: its following error is the commanded velocity times `LAG`, plus what
somebody holds it away (`disturbance`). At rest it stands where it is told to.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from yarclang.simulator.motion.pieces import (
    Array,
    Motion,
    Piece,
    Profile,
    ramp,
    ramp_time,
    standing,
    steady,
    trapezoid,
)

LAG = 0.5e-3
"""Following error by velocity [s]: about one servo cycle, as of a motor with feedforward (assumed)."""

WATCHED = frozenset({11, 13, 14})
"""The Ixx that say when a motor trips; Ixx24 counts as a switch opens or closes."""


class Driver(Protocol):
    """What moves the motor, and all others of its coordinate system."""

    @property
    def motion(self) -> Motion:
        """What they do now."""
        ...

    def place(self, time: float) -> tuple[Array, Array]:
        """Positions and velocities of all its motors."""
        ...


class Motor:
    """Motor `number`. `variables` are all I-variables; `under_way` has the motors that move by themselves, by number."""

    def __init__(self, number: int, variables: list[float], under_way: dict[int, Motor]) -> None:
        self.number = number
        self.variables = variables
        self.under_way = under_way
        self.clear()

    def clear(self) -> None:
        """As at power-up: open loop, at 0, not homed."""
        self.stand = 0.0
        self.profile: Profile | None = None
        self.driver: tuple[Driver, int] | None = None
        self.closed = False
        self.enabled = False
        self.homed = False
        self.homing = False
        self.aborting = False
        self.amplifier_fault = False
        self.fatal_error = False
        self.limit_stop = False
        self.data_error = False
        self.disturbance = 0.0
        self.switches = {1: False, -1: False}
        self.before_jog = 0.0
        self.trip: tuple[float, str] | None = None

    def tuning(self, number: int) -> float:
        """Ixx`number` of this motor."""
        return self.variables[100 * self.number + number]

    @property
    def activated(self) -> bool:
        """Ixx00."""
        return self.tuning(0) != 0.0

    @property
    def jogging(self) -> bool:
        """Whether a motion of its own isn't finished."""
        return self.profile is not None

    @property
    def unit(self) -> float:
        """One count in the units of the position registers: Ixx08 32."""
        return max(self.tuning(8), 1.0) * 32.0

    def place(self, time: float) -> tuple[float, float]:
        """Commanded position [counts] and velocity [counts/s] at an instant [s]."""
        if self.profile is not None:
            position, velocity = self.profile.at(time)
            return float(position[0]), float(velocity[0])
        if self.driver is not None:
            system, index = self.driver
            position, velocity = system.place(time)
            return float(position[index]), float(velocity[index])
        return self.stand, 0.0

    def actual(self, time: float) -> float:
        """Where the motor is [counts]."""
        position, velocity = self.place(time)
        return position - LAG * velocity - self.disturbance

    def following_error(self, time: float) -> float:
        """Commanded less actual position [counts]."""
        return LAG * self.place(time)[1] + self.disturbance

    def limits(self) -> tuple[float, float]:
        """Least and largest position [counts]: Ixx14 and Ixx13, 0 for none (TSRM 96-97)."""
        most, least = self.tuning(13), self.tuning(14)
        return least or -math.inf, most or math.inf

    def fatal_limit(self) -> float:
        """Ixx11 [counts], infinite for 0."""
        return self.tuning(11) / 16.0 or math.inf

    def tripped(self, position: float, velocity: float) -> str | None:
        """What stops the motor at a commanded position [counts] and velocity [counts/s]: a limit that
        it moves away from, or its following error.
        """
        error = LAG * velocity + self.disturbance
        if abs(error) > self.fatal_limit():
            return "fatal"
        least, most = self.limits()
        actual = position - error
        if (velocity > 0.0 and (actual > most or self.switches[1])) or (
            velocity < 0.0 and (actual < least or self.switches[-1])
        ):
            return "limit"
        return None

    def set_limits(self, time: float) -> tuple[bool, bool]:
        """Whether the positive and the negative limit are set, by position or by switch."""
        least, most = self.limits()
        actual = self.actual(time)
        return actual > most or self.switches[1], actual < least or self.switches[-1]

    # motions of its own

    def hold(self, time: float) -> None:
        """Stand where it is commanded now."""
        position = self.place(time)[0]
        self.profile = self.driver = self.trip = None
        self.under_way.pop(self.number, None)
        self.stand = position
        self.homing = self.aborting = False

    def close(self, time: float) -> None:
        """Close the loop, where the motor is."""
        if not self.closed:
            self.stand = self.actual(time)
            self.disturbance = 0.0
        self.closed = self.enabled = True
        self.fatal_error = False

    def kill(self, time: float) -> None:
        """Open the loop and switch the amplifier off; a brake holds the motor (assumed)."""
        self.hold(time)
        self.stand -= self.disturbance
        self.disturbance = 0.0
        self.closed = self.enabled = False

    def jog_to(self, time: float, target: float, speed: float | None = None) -> None:
        """Go to a position [counts]; a motor that moves stops first (assumed)."""
        position, velocity = self.place(time)
        pieces: list[Piece] = []
        if velocity:
            pieces = self._speed_up(position, velocity, 0.0)
            position = _end(pieces, position)
        speed = self._jog_speed() if speed is None else speed
        pieces += trapezoid(position, target, speed, *self.jog_ramp())
        self._start(time, pieces, target if speed > 0.0 else position)

    def jog(self, time: float, direction: int) -> None:
        """Go on at jog speed, without an end."""
        position, velocity = self.place(time)
        speed = direction * self._jog_speed()
        pieces = self._speed_up(position, velocity, speed)
        pieces.append(steady(np.array([_end(pieces, position)]), np.array([speed]), math.inf))
        self._start(time, pieces, position)

    def jog_stop(self, time: float) -> None:
        """Stop as Ixx19, 20 and 21 say."""
        position, velocity = self.place(time)
        if not velocity:
            self.hold(time)
            return
        pieces = self._speed_up(position, velocity, 0.0)
        self._start(time, pieces, _end(pieces, position))

    def abort(self, time: float) -> None:
        """Stop at Ixx15 (TSRM 73)."""
        position, velocity = self.place(time)
        if not velocity or not self.closed:
            self.hold(time)
            return
        rate = max(self.tuning(15), 1e-6) * 1e6
        duration = abs(velocity) / rate
        piece = Piece(
            duration, np.array([[position], [velocity], [-math.copysign(rate, velocity) / 2.0], [0.0]])
        )
        self._start(time, [piece], float(piece.position(duration)[0]))
        # it stops already; a stop that takes no time is over
        self.aborting, self.trip = self.profile is not None, None

    def home(self, time: float) -> None:
        """Search home: the flag is found at position 0, at Ixx23, and stays the zero of the positions (assumed; Ixx26 isn't
        looked at).
        """
        self.jog_to(time, 0.0, abs(self.tuning(23)) * 1e3)
        self.homing, self.homed = True, False
        if self.profile is None:
            self.arrive()

    def zero(self, time: float) -> None:
        """HMZ: the position here is 0, and the motor is homed."""
        self.hold(time)
        self.stand, self.homed = 0.0, True

    def arrive(self) -> None:
        """A motion of its own has ended."""
        if self.profile is not None:
            self.stand = self.profile.target
        homed = self.homing
        self.profile = self.trip = None
        self.under_way.pop(self.number, None)
        self.homing = self.aborting = False
        if homed:
            self.homed = True
            self.stand = 0.0

    @property
    def next_event(self) -> float:
        """When a motion of its own ends or trips [s]."""
        end = self.profile.end if self.profile is not None else math.inf
        return min(end, self.trip[0]) if self.trip else end

    def jog_ramp(self) -> tuple[float, float, float]:
        """Acceleration [counts/s^2], time and S-curve time [s]: Ixx19, Ixx20, Ixx21."""
        return self.tuning(19) * 1e6, self.tuning(20) * 1e-3, self.tuning(21) * 1e-3

    def rapid_speed(self) -> float:
        """The speed of RAPID [counts/s]: Ixx22, or Ixx16 where Ixx90 is 1."""
        return abs(self.tuning(16 if self.tuning(90) else 22)) * 1e3

    def _jog_speed(self) -> float:
        return abs(self.tuning(22)) * 1e3

    def _speed_up(self, position: float, before: float, after: float) -> list[Piece]:
        acceleration, time, s_time = self.jog_ramp()
        duration = ramp_time(abs(after - before), acceleration, time, s_time)
        return ramp(np.array([position]), np.array([before]), np.array([after]), duration, s_time)

    def _start(self, time: float, pieces: list[Piece], target: float) -> None:
        self.driver = self.trip = None
        self.homing = self.aborting = False
        self.limit_stop = False
        if not pieces:
            pieces = [standing(0.0, np.array([target]))]
        self.profile = Profile(time, pieces, target)
        self.under_way[self.number] = self
        self.trip = self._first_trip(self.profile)
        if not self.profile.end > time:
            self.arrive()

    def look_again(self) -> None:
        """What may trip the motor has changed; what stops it already goes on."""
        if self.profile is not None and not self.aborting:
            self.trip = self._first_trip(self.profile)

    def _first_trip(self, profile: Profile) -> tuple[float, str] | None:
        since = profile.begin
        for piece in profile.pieces:
            if piece.duration == math.inf:
                velocity = float(piece.velocity(0.0)[0])
                least, most = self.limits()
                bound = most if velocity > 0.0 else least
                way = bound - float(piece.position(0.0)[0]) + LAG * velocity + self.disturbance
                if not velocity:
                    return None
                cause = self.tripped(float(piece.position(0.0)[0]), velocity)
                when = since if cause else since + max(way / velocity, 0.0)
                return (when, cause or "limit") if when < math.inf else None
            if found := first_trip(piece, [self]):
                return since + found[0], found[2]
            since += piece.duration
        return None


def _end(pieces: list[Piece], position: float) -> float:
    return float(pieces[-1].position(pieces[-1].duration)[0]) if pieces else position


def first_trip(piece: Piece, motors: list[Motor], samples: int = 64) -> tuple[float, Motor, str] | None:
    """The first time [s] within a piece at which a motor trips, which, and why."""

    def at(u: float) -> tuple[Motor, str] | None:
        for motor, position, velocity in zip(motors, piece.position(u), piece.velocity(u), strict=True):
            if cause := motor.tripped(float(position), float(velocity)):
                return motor, cause
        return None

    before = 0.0
    for number in range(samples + 1):
        u = piece.duration * number / samples
        if found := at(u):
            low, high = before, u
            for _ in range(40):
                middle = (low + high) / 2.0
                if other := at(middle):
                    high, found = middle, other
                else:
                    low = middle
            return high, *found
        before = u
    return None
