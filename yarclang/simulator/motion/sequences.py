"""Conversion of the moves of a program to pieces (cubics in time).

SPLINE1 (TUM 289-290), LINEAR (TSRM 189, PUM 166) and PVT (TSRM 463) moves blend into each other; RAPID moves
(TSRM 98) don't.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Protocol

import numpy as np

from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.motion.pieces import Array, Piece, ramp, standing, steady, together, trapezoid
from yarclang.simulator.motion.steps import Step

Events = tuple[Callable[[], None], ...]


class Sequence(Protocol):
    """Blended moves of one mode, from rest to rest.

    Attributes:
        stop: True to accept no more moves, and to come to rest after the moves accepted so far.
        end: (n,) positions at the end of the moves accepted so far [counts].
    """

    stop: bool
    end: Array

    def next(self, steps: deque[Step]) -> tuple[Piece, Events] | None:
        """Return the next piece of the motion and the events at its start; None after the last piece.

        Args:
            steps: the calculated steps of the program. Those that the piece needs are removed from this
                queue.
        """
        ...


class SplineSequence:
    """SPLINE1 moves: N moves of equal time t take (N + 2) t.

    The control points are S, S, S, P1 ... PN, PN, PN, where S is the position at rest. When segment k begins,
    move k + 1 must be calculated. If move k + 1 isn't calculated, or has another time, the controller adds
    two end segments, and the motors come to rest.
    """

    def __init__(self, stand: Array, first: Step) -> None:
        self.stop = False
        self.end = stand
        self._time = first.time
        self._window = (stand, stand, stand)
        self._trailing = 0
        self._events: Events = ()

    def next(self, steps: deque[Step]) -> tuple[Piece, Events] | None:
        """Return the next spline segment and the events at its start; None after the last segment."""
        due = self._events
        if not self._trailing and not self.stop and _is(steps, "SPLINE1") and steps[0].time == self._time:
            step = steps.popleft()
            point, self._events = step.target, step.events
        else:
            self._trailing += 1
            if self._trailing > 2:
                return None
            point, self._events = self._window[2], ()
        before, middle, last = self._window
        self._window = (middle, last, point)
        self.end = point
        return Piece.spline(self._time, (before, middle, last, point)), due


class LinearSequence:
    """LINEAR moves: constant velocities, with a ramp of the duration TA at each corner. A single move takes
    TM + TA.

    The next move must be calculated when the ramp into the current move ends.
    """

    def __init__(self, stand: Array, first: Step) -> None:
        del first
        self.stop = False
        self.end = stand
        self._position = stand
        self._velocity = np.zeros(len(stand))
        self._move: Step | None = None
        self._corner = stand
        self._pieces: deque[tuple[Piece, Events]] = deque()
        self._done = False

    def next(self, steps: deque[Step]) -> tuple[Piece, Events] | None:
        """Return the next ramp or piece of constant velocity, and the events at its start; None after the
        last one.
        """
        if not self._pieces and not self._done:
            self._go_on(steps)
        if not self._pieces:
            return None
        return self._pieces.popleft()

    def _go_on(self, steps: deque[Step]) -> None:
        follower = steps[0] if not self.stop and _is(steps, "LINEAR") else None
        if self._move is None:
            if follower is None:
                self._done = True
                return
            corner_time, coast = follower.ramp, 0.0
        else:
            move = self._move
            # If a ramp is too long for the moves before and after it, it is shortened (assumed).
            corner_time = min(follower.ramp, 2.0 * move.time - move.ramp) if follower else move.ramp
            coast = max(move.time - (move.ramp + corner_time) / 2.0, 0.0)
        if coast > 0.0:
            self._add(steady(self._position, self._velocity, coast), ())
        velocity = (
            (follower.target - self._corner) / follower.time if follower else np.zeros(len(self._velocity))
        )
        s_time = follower.s_ramp if follower else self._move.s_ramp if self._move else 0.0
        events: Events = follower.events if follower else ()
        pieces = ramp(self._position, self._velocity, velocity, corner_time, s_time)
        if not pieces and events:
            pieces = [standing(0.0, self._position)]
        for piece in pieces:
            self._add(piece, events)
            events = ()
        self._velocity = velocity
        if follower:
            self._move, self._corner, self.end = steps.popleft(), follower.target, follower.target
            self._move.ramp = corner_time
            if not self._pieces:
                self._go_on(steps)
        else:
            self._done = True

    def _add(self, piece: Piece, events: Events) -> None:
        self._pieces.append((piece, events))
        self._position = piece.position(piece.duration)


class PvtSequence:
    """PVT moves: cubics between positions with velocities."""

    def __init__(self, stand: Array, first: Step) -> None:
        del first
        self.stop = False
        self.end = stand
        self._velocity = np.zeros(len(stand))

    def next(self, steps: deque[Step]) -> tuple[Piece, Events] | None:
        """Return the cubic of the next move and the events at its start; None after the last move."""
        if self.stop or not _is(steps, "PVT"):
            return None
        step = steps.popleft()
        h, p0, p1, v0 = step.time, self.end, step.target, self._velocity
        v1 = step.velocity if step.velocity is not None else np.zeros(len(p1))
        slope = (p1 - p0) / h
        coefficients = np.array([p0, v0, (3.0 * slope - 2.0 * v0 - v1) / h, (v0 + v1 - 2.0 * slope) / h**2])
        self.end, self._velocity = p1, v1
        return Piece(h, coefficients), step.events


SEQUENCES: dict[str, Callable[[Array, Step], Sequence]] = {
    "SPLINE1": SplineSequence,
    "LINEAR": LinearSequence,
    "PVT": PvtSequence,
}


def rapid(motors: list[Motor], begin: Array, target: Array) -> list[Piece]:
    """Return the pieces of a RAPID move, which doesn't blend with other moves.

    Each motor moves independently, at its own speed (Ixx22, or Ixx16 with Ixx90 = 1; TSRM 98).

    Args:
        motors: the motors.
        begin: (n,) positions at the start [counts].
        target: (n,) positions at the end [counts]. If they equal those at the start, there are no
            pieces.
    """
    parts = [
        trapezoid(float(start), float(end), motor.rapid_speed(), *motor.jog_ramp())
        for motor, start, end in zip(motors, begin, target, strict=True)
    ]
    return together(parts, begin)


def _is(steps: deque[Step], mode: str) -> bool:
    return bool(steps) and steps[0].kind == "move" and steps[0].mode == mode
