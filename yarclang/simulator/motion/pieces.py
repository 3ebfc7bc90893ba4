"""Motions as sequences of pieces, which can be evaluated at any time. In each piece, the positions of all
motors are cubics in time.

Nothing is integrated step by step: a position is the value of a polynomial.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from yarclang.simulator.motion.timebase import TimeMap

Array = NDArray[np.float64]


class Piece:
    """A piece of a motion: the positions of n motors as cubics in the time since its start.

    Args:
        duration: duration of the piece [s].
        coefficients: (4, n) coefficients of the powers 0 to 3, in counts and s.
    """

    __slots__ = ("_coefficients", "_control", "duration")

    def __init__(self, duration: float, coefficients: Array) -> None:
        self.duration = duration
        self._coefficients: Array | None = coefficients
        self._control: tuple[Array, ...] = ()

    @classmethod
    def spline(cls, duration: float, control: tuple[Array, Array, Array, Array]) -> Piece:
        """Return one segment of a uniform cubic B-spline as a piece, from its four control points, each (n,)
        [counts] (TUM 290).

        The polynomial is computed when it is needed.
        """
        piece = cls.__new__(cls)
        piece.duration = duration
        piece._coefficients = None
        piece._control = control
        return piece

    @property
    def coefficients(self) -> Array:
        """Coefficients (4, n) of the powers 0 to 3, in counts and s."""
        if self._coefficients is None:
            c0, c1, c2, c3 = self._control
            h = self.duration
            self._coefficients = np.array(
                [
                    (c0 + 4.0 * c1 + c2) / 6.0,
                    (c2 - c0) / (2.0 * h),
                    (c0 - 2.0 * c1 + c2) / (2.0 * h**2),
                    (c3 - 3.0 * c2 + 3.0 * c1 - c0) / (6.0 * h**3),
                ]
            )
            self._control = ()
        return self._coefficients

    def position(self, u: float) -> Array:
        """Return positions (n,) [counts] at time `u` [s] of the piece."""
        c = self.coefficients
        position: Array = c[0] + u * (c[1] + u * (c[2] + u * c[3]))
        return position

    def velocity(self, u: float) -> Array:
        """Return velocities (n,) [counts per s of the piece's time] at time `u` [s] of the piece."""
        c = self.coefficients
        velocity: Array = c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])
        return velocity

    def shifted(self, u: float, duration: float) -> Piece:
        """Return the part of the piece from time `u` [s] on, with a duration [s]."""
        c = self.coefficients
        return Piece(
            duration,
            np.array(
                [
                    self.position(u),
                    self.velocity(u),
                    c[2] + 3.0 * u * c[3],
                    c[3],
                ]
            ),
        )

    def reach(self) -> tuple[Array, Array, Array]:
        """Return bounds for each motor in this piece, as (n,) each: smallest and largest position [counts],
        largest speed [counts/s].

        For a spline segment, the bounds are those of its newest control point only. The other three control
        points were in the bounds of the segments before. If the newest control point exceeds a limit, this
        segment and the next three may do so, and the caller has to examine all of them.
        """
        if self._coefficients is None:
            last, newest = self._control[2], self._control[3]
            return newest, newest, np.abs(newest - last) / self.duration
        h = self.duration
        c0, c1, c2, c3 = self._coefficients * np.array([[1.0], [h], [h**2], [h**3]])
        # control points of the Bernstein form
        points = np.array([c0, c0 + c1 / 3.0, c0 + (2.0 * c1 + c2) / 3.0, c0 + c1 + c2 + c3])
        speed = np.abs(np.diff(points, axis=0)).max(axis=0) * 3.0 / h if h else np.zeros(len(c0))
        return points.min(axis=0), points.max(axis=0), speed


def standing(duration: float, position: Array) -> Piece:
    """Return a piece without motion that lasts `duration` [s]."""
    return Piece(duration, np.array([position, *np.zeros((3, len(position)))]))


def ramp(position: Array, before: Array, after: Array, time: float, s_time: float) -> list[Piece]:
    """Return the pieces of a change of velocity, with S-curves at both ends.

    For any S-curve, the distance is the mean of both velocities times `time` (TSRM 189: TA is the whole time,
    TS the time of each S-curve).

    Args:
        position: (n,) position at the start [counts].
        before: (n,) velocity at the start [counts/s].
        after: (n,) velocity at the end [counts/s].
        time: duration [s].
        s_time: time of each S-curve [s].
    """
    if time <= 0.0:
        return []
    s_time = min(s_time, time / 2.0)
    peak = (after - before) / (time - s_time)
    pieces = []
    velocity = before
    for duration, start, end in (
        (s_time, 0.0, 1.0),
        (time - 2.0 * s_time, 1.0, 1.0),
        (s_time, 1.0, 0.0),
    ):
        if duration <= 1e-12:
            continue
        jerk = peak * (end - start) / duration
        piece = Piece(duration, np.array([position, velocity, peak * start / 2.0, jerk / 6.0]))
        pieces.append(piece)
        position, velocity = piece.position(duration), piece.velocity(duration)
    return pieces


def steady(position: Array, velocity: Array, duration: float) -> Piece:
    """Return a piece of constant velocity."""
    zero = np.zeros(len(position))
    return Piece(duration, np.array([position, velocity, zero, zero]))


def trapezoid(
    start: float, end: float, speed: float, acceleration: float, time: float, s_time: float
) -> list[Piece]:
    """Return the pieces of a jog of one motor from rest to rest.

    Args:
        start: position at the start [counts].
        end: position at the end [counts].
        speed: wanted speed [counts/s]; the jog is slower if the distance is too short for it.
        acceleration: limit of the acceleration [counts/s^2]; the time of the acceleration grows if it
            would be exceeded (TSRM 73: Ixx19 limits Ixx20 and Ixx21).
        time: time of the acceleration, or twice `s_time` if that is longer [s].
        s_time: time of each S-curve [s].
    """
    way = end - start
    if way == 0.0:
        return []
    speed = reached(abs(way), speed, acceleration, time, s_time)
    if speed <= 0.0:
        return []
    accelerating = ramp_time(speed, acceleration, time, s_time)
    velocity = np.array([math.copysign(speed, way)])
    rest = np.zeros(1)
    pieces = ramp(np.array([start]), rest, velocity, accelerating, s_time)
    middle = start + float(velocity[0]) * accelerating / 2.0
    cruise = max(0.0, abs(way) / speed - accelerating)
    if cruise > 1e-12:
        pieces.append(steady(np.array([middle]), velocity, cruise))
    stop = end - float(velocity[0]) * accelerating / 2.0
    return pieces + ramp(np.array([stop]), velocity, rest, accelerating, s_time)


def ramp_time(change: float, acceleration: float, time: float, s_time: float) -> float:
    """Return the duration [s] of a change of velocity by `change` [counts/s]. The other arguments are as in
    `trapezoid`.
    """
    return max(time, 2.0 * s_time, change / acceleration + s_time if acceleration > 0.0 else 0.0, 1e-6)


def reached(way: float, speed: float, acceleration: float, time: float, s_time: float) -> float:
    """Return the largest speed [counts/s] that a motor can reach from rest to rest over a distance `way`
    [counts]. The other arguments are as in `trapezoid`.
    """
    if speed * ramp_time(speed, acceleration, time, s_time) <= way:
        return speed
    fixed = max(time, 2.0 * s_time, 1e-6)
    if acceleration <= 0.0 or (way / fixed) / acceleration + s_time <= fixed:
        return way / fixed
    # positive root of speed^2 / acceleration + speed * s_time = way
    return acceleration * (math.sqrt(s_time**2 + 4.0 * way / acceleration) - s_time) / 2.0


def together(parts: Sequence[list[Piece]], stands: Array) -> list[Piece]:
    """Join the motions of single motors to pieces in which all motors move. A motor whose motion has ended
    stays at rest.

    Args:
        parts: for each motor, the pieces of its motion.
        stands: (n,) positions of motors without pieces [counts].
    """
    ends = sorted({0.0, *(t for part in parts for t in _ends(part))})
    pieces = []
    for begin, end in itertools.pairwise(ends):
        if end - begin < 1e-12:
            continue
        columns = []
        for part, stand in zip(parts, stands, strict=True):
            columns.append(_from(part, begin, stand, end - begin))
        pieces.append(Piece(end - begin, np.concatenate(columns, axis=1)))
    return pieces


def _ends(part: list[Piece]) -> list[float]:
    return list(np.cumsum([piece.duration for piece in part]))


def _from(part: list[Piece], begin: float, stand: float, duration: float) -> Array:
    since = 0.0
    for piece in part:
        if begin < since + piece.duration - 1e-12:
            return piece.shifted(begin - since, duration).coefficients
        since += piece.duration
    end = float(part[-1].position(part[-1].duration)[0]) if part else stand
    return np.array([[end], [0.0], [0.0], [0.0]])


class Motion(Protocol):
    """A motion, or a standstill, as a function of time. It is immutable."""

    def at(self, time: float) -> tuple[Array, Array]:
        """Return positions (n,) [counts] and velocities (n,) [counts/s] at a time [s]."""
        ...


class Standing:
    """A motion of zero velocity: the motors are at rest."""

    __slots__ = ("_position", "_velocity")

    def __init__(self, position: Array) -> None:
        self._position = position
        self._velocity = np.zeros(len(position))

    def at(self, time: float) -> tuple[Array, Array]:  # noqa: ARG002 - the result is constant
        """Return the positions (n,) [counts], and velocities of 0."""
        return self._position, self._velocity


class Travel:
    """A piece of a program's motion, executed at the rate of the time base.

    Attributes:
        piece: the piece.
        begin: start of the piece in program time [s].
        map: program time as a function of real time.
    """

    __slots__ = ("begin", "map", "piece")

    def __init__(self, piece: Piece, begin: float, time_map: TimeMap) -> None:
        self.piece = piece
        self.begin = begin
        self.map = time_map

    def at(self, time: float) -> tuple[Array, Array]:
        """Return positions (n,) [counts] and velocities (n,) [counts/s] at a real time [s]."""
        u = min(max(self.map.program_time(time) - self.begin, 0.0), self.piece.duration)
        return self.piece.position(u), self.piece.velocity(u) * self.map.rate(time)


class Profile:
    """A motion of one motor in real time: jog, home or abort.

    Attributes:
        begin: start [s].
        pieces: pieces of the motion; the last one may have no end.
        end: end [s].
        target: position after the last piece [counts].
    """

    __slots__ = ("begin", "end", "pieces", "target")

    def __init__(self, begin: float, pieces: list[Piece], target: float) -> None:
        self.begin = begin
        self.pieces = pieces
        self.end = begin + sum(piece.duration for piece in pieces)
        self.target = target

    def at(self, time: float) -> tuple[Array, Array]:
        """Return the position (1,) [counts] and the velocity (1,) [counts/s] at a time [s]."""
        since = self.begin
        for piece in self.pieces:
            if time < since + piece.duration:
                u = max(time - since, 0.0)
                return piece.position(u), piece.velocity(u)
            since += piece.duration
        return np.array([self.target]), np.zeros(1)
