"""A motor: its commanded and its actual position, and its motions outside a program (jog, home, abort).

The actual position lags behind: the following error is the commanded velocity times `LAG`, plus a
`disturbance`. At rest and without a disturbance, the actual position is the commanded one.
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
"""Following error divided by velocity [s]. It is about one servo cycle, as with feedforward (assumed)."""

WATCHED = frozenset({11, 13, 14})
"""Numbers of the Ixx whose change may make a motor trip. Ixx24 isn't one of them, since it is read only when
a limit switch changes.
"""


class Driver(Protocol):
    """The drive of a coordinate system, which moves a motor together with the other motors of the system."""

    @property
    def motion(self) -> Motion:
        """The current motion of the motors."""
        ...

    def place(self, time: float) -> tuple[Array, Array]:
        """Return positions [counts] and velocities [counts/s] of all its motors at a time [s]."""
        ...


class Motor:
    """One motor. Jogs, home searches and aborts are its own motions; the drive of its coordinate system
    executes all others.

    Attributes:
        number: 1 to 32.
        variables: all I-variables.
        under_way: all motors with a motion of their own, by number.
        stand: commanded position at rest [counts].
        profile: the motor's own motion: jog, home or abort; None without one.
        driver: drive of the coordinate system that moves this motor, and the motor's index in the drive;
            None without one.
        closed: True in closed loop.
        enabled: True if the amplifier is enabled.
        homed: True after a home search.
        homing: True during a home search.
        aborting: True during an abort.
        amplifier_fault: True if the amplifier reports a fault.
        fatal_error: True after a fatal following error.
        limit_stop: True after a stop at a limit.
        data_error: status bit "data block error".
        disturbance: distance at which the motor is kept from its commanded position [counts].
        switches: states of the limit switches, by side (+1, -1).
        before_jog: position before the last jog [counts].
        trip: time at which the motor trips in its own motion [s], and the cause; None if it doesn't.
    """

    def __init__(self, number: int, variables: list[float], under_way: dict[int, Motor]) -> None:
        self.number = number
        self.variables = variables
        self.under_way = under_way
        self.clear()

    def clear(self) -> None:
        """Return to the state at power-up: open loop, at 0, not homed."""
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
        """Return Ixx`number` of this motor."""
        return self.variables[100 * self.number + number]

    @property
    def activated(self) -> bool:
        """True if the motor is activated (Ixx00)."""
        return self.tuning(0) != 0.0

    @property
    def jogging(self) -> bool:
        """True during a jog, a home search or an abort of the motor."""
        return self.profile is not None

    @property
    def unit(self) -> float:
        """One count in the units of the position registers: Ixx08 times 32."""
        return max(self.tuning(8), 1.0) * 32.0

    def place(self, time: float) -> tuple[float, float]:
        """Return the commanded position [counts] and velocity [counts/s] at a time [s]."""
        if self.profile is not None:
            position, velocity = self.profile.at(time)
            return float(position[0]), float(velocity[0])
        if self.driver is not None:
            system, index = self.driver
            position, velocity = system.place(time)
            return float(position[index]), float(velocity[index])
        return self.stand, 0.0

    def actual(self, time: float) -> float:
        """Return the actual position [counts] at a time [s]."""
        position, velocity = self.place(time)
        return position - LAG * velocity - self.disturbance

    def following_error(self, time: float) -> float:
        """Return the commanded position minus the actual position [counts] at a time [s]."""
        return LAG * self.place(time)[1] + self.disturbance

    def limits(self) -> tuple[float, float]:
        """Return the least and the largest allowed position [counts], from Ixx14 and Ixx13; 0 means no
        limit (TSRM 96-97).
        """
        most, least = self.tuning(13), self.tuning(14)
        return least or -math.inf, most or math.inf

    def fatal_limit(self) -> float:
        """Return the limit of the following error [counts]: Ixx11, infinite for 0."""
        return self.tuning(11) / 16.0 or math.inf

    def tripped(self, position: float, velocity: float) -> str | None:
        """Return the cause for which the motor trips at a commanded position [counts] and velocity
        [counts/s], or None.

        The cause is "fatal" for a fatal following error. It is "limit" if the motor moves outwards while it
        is beyond a limit or on a limit switch.
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
        """Return two flags, for the positive and the negative side: True if the motor is beyond its limit or
        on its limit switch.
        """
        least, most = self.limits()
        actual = self.actual(time)
        return actual > most or self.switches[1], actual < least or self.switches[-1]

    # motions of its own

    def hold(self, time: float) -> None:
        """Stop without a ramp, at the commanded position at `time` [s]."""
        position = self.place(time)[0]
        self.profile = self.driver = self.trip = None
        self.under_way.pop(self.number, None)
        self.stand = position
        self.homing = self.aborting = False

    def close(self, time: float) -> None:
        """Close the loop at the actual position."""
        if not self.closed:
            self.stand = self.actual(time)
            self.disturbance = 0.0
        self.closed = self.enabled = True
        self.fatal_error = False

    def kill(self, time: float) -> None:
        """Open the loop and disable the amplifier. A brake holds the motor (assumed)."""
        self.hold(time)
        self.stand -= self.disturbance
        self.disturbance = 0.0
        self.closed = self.enabled = False

    def jog_to(self, time: float, target: float, speed: float | None = None) -> None:
        """Jog to a position. If the motor is moving, it stops before the jog (assumed).

        Args:
            time: start [s].
            target: the position [counts].
            speed: speed of the jog [counts/s]; None for the jog speed in Ixx22.
        """
        position, velocity = self.place(time)
        pieces: list[Piece] = []
        if velocity:
            pieces = self._speed_up(position, velocity, 0.0)
            position = _end(pieces, position)
        speed = self._jog_speed() if speed is None else speed
        pieces += trapezoid(position, target, speed, *self.jog_ramp())
        self._start(time, pieces, target if speed > 0.0 else position)

    def jog(self, time: float, direction: int) -> None:
        """Jog without an end, in `direction` +1 or -1."""
        position, velocity = self.place(time)
        speed = direction * self._jog_speed()
        pieces = self._speed_up(position, velocity, speed)
        pieces.append(steady(np.array([_end(pieces, position)]), np.array([speed]), math.inf))
        self._start(time, pieces, position)

    def jog_stop(self, time: float) -> None:
        """Stop, with a ramp according to Ixx19, Ixx20 and Ixx21."""
        position, velocity = self.place(time)
        if not velocity:
            self.hold(time)
            return
        pieces = self._speed_up(position, velocity, 0.0)
        self._start(time, pieces, _end(pieces, position))

    def abort(self, time: float) -> None:
        """Stop at the deceleration Ixx15 (TSRM 73)."""
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
        # A motor that is stopping can't trip. If the stop takes no time, the abort has ended already.
        self.aborting, self.trip = self.profile is not None, None

    def home(self, time: float) -> None:
        """Search home at the speed Ixx23.

        The home flag is at position 0, so the zero of the positions doesn't change (assumed). Ixx26 is
        ignored.
        """
        self.jog_to(time, 0.0, abs(self.tuning(23)) * 1e3)
        self.homing, self.homed = True, False
        if self.profile is None:
            self.arrive()

    def zero(self, time: float) -> None:
        """Execute HMZ: make the current position 0 and the motor homed."""
        self.hold(time)
        self.stand, self.homed = 0.0, True

    def arrive(self) -> None:
        """End the motor's own motion."""
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
        """Time at which the motor's own motion ends, or at which the motor trips in it [s]."""
        end = self.profile.end if self.profile is not None else math.inf
        return min(end, self.trip[0]) if self.trip else end

    def jog_ramp(self) -> tuple[float, float, float]:
        """Return the parameters of jogs: acceleration [counts/s^2], acceleration time and S-curve time [s],
        from Ixx19, Ixx20 and Ixx21.
        """
        return self.tuning(19) * 1e6, self.tuning(20) * 1e-3, self.tuning(21) * 1e-3

    def rapid_speed(self) -> float:
        """Return the speed of RAPID [counts/s]: Ixx22, or Ixx16 if Ixx90 is set."""
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
        """After a change of limits or switches, compute again if and when the motor will trip. An abort
        continues unchanged.
        """
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
    """Return the first time in a piece of motion at which a motor trips [s], the motor, and the cause; None
    if no motor trips.

    Args:
        piece: the piece.
        motors: motors that the piece moves.
        samples: number of intervals that are sampled; the time is then refined by bisection.
    """

    def at(u: float) -> tuple[Motor, str] | None:
        for motor, position, velocity in zip(motors, piece.position(u), piece.velocity(u), strict=True):
            if cause := motor.tripped(float(position), float(velocity)):
                return motor, cause
        return None

    before = 0.0
    for number in range(samples + 1):
        u = piece.duration * number / samples
        if tripping := at(u):
            low, high = before, u
            for _ in range(40):
                middle = (low + high) / 2.0
                if other := at(middle):
                    high, tripping = middle, other
                else:
                    low = middle
            return high, *tripping
        before = u
    return None
