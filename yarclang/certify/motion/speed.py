"""Bounds of the speed of the moving frame at every instant, for the programmed speed (`[V 250]`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import HERMITE_RATE, segment_max
from yarclang.certify.motion.programmed import Motion, Rows
from yarclang.frozen import frozen
from yarclang.robot.model import Array

KEPT = 1e-3
"""Largest relative deviation of the cruise speed from the programmed one."""
SHARP = 1e-4
"""Largest error of the bounds of a speed, as a fraction of the programmed speed. It determines the number of
pieces.
"""
MOST_PIECES = 32

_LEFT = np.array([[1, 0, 0, 0, 0], [8, 8, 0, 0, 0], [4, 8, 4, 0, 0], [2, 6, 6, 2, 0], [1, 4, 6, 4, 1]]) / [
    [1.0],
    [16.0],
    [16.0],
    [16.0],
    [16.0],
]
_RIGHT = _LEFT[::-1, ::-1]
_QUARTERS = np.concatenate([one @ other for other in (_LEFT, _RIGHT) for one in (_LEFT, _RIGHT)])
"""Matrix (20, 5) from five Bernstein coefficients to those on the four quarters (de Casteljau)."""


@frozen(eq=False)
class Programmed:
    """The programmed speeds of C commands.

    Speeds are those of the frame's origin [m/s], or, with `turns`, angular speeds [rad/s].

    Attributes:
        cruise: (C,) least allowed speed from the instant at which it is first reached to the instant at which
            it is last left; NaN if no speed is programmed.
        top: (C,) largest allowed speed; NaN if none is programmed.
        turns: (C,) True if the path only turns the frame.
        around: (C, 2) largest allowed speed in the blend before the command and in the blend after it.
        held: (C, 2) True in the first column if the motion must have its speed from its start on, and in the
            second column if it must keep its speed up to its end.
    """

    cruise: Array
    top: Array
    turns: NDArray[np.bool_]
    around: Array
    held: NDArray[np.bool_]


@frozen(eq=False)
class Speeds:
    """Proved bounds of the speeds of C commands.

    Speeds are those of the frame's origin [m/s], or, with `turns`, angular speeds [rad/s]. `least` and `most`
    cover the time from when the cruise speed is first reached to when it is last left. They are NaN if the
    cruise speed is never reached.

    Attributes:
        turns: (C,) True if the path only turns the frame.
        programmed: (C,) programmed cruise speeds.
        largest: (C,) largest speeds.
        least: (C,) least speeds during the time described above.
        most: (C,) largest speeds during the time described above.
        beyond: (C,) largest ratios of the speed to the allowed speed; at most 1 + `KEPT` if no speed is
            exceeded.
    """

    turns: NDArray[np.bool_]
    programmed: Array
    largest: Array
    least: Array
    most: Array
    beyond: Array


def finer_for_speed(
    pieces: Rows, h: Array, origin: Array, rotation: Array, wanted: Programmed, command: Rows
) -> Rows:
    """Return the numbers of pieces of each segment that make the bounds of programmed speeds sharp.

    Args:
        pieces: (N,) number of pieces of each segment that the proof of the path needs.
        h: (N,) durations of the segments [s].
        origin: (N,) bounds of the fourth derivative of the frame's origin [m/s^4].
        rotation: (N,) bounds of the fourth derivative of the frame's rotation matrix [1/s^4].
        wanted: the programmed speeds.
        command: (N,) command of each segment.
    """
    cruise = wanted.cruise[command]
    bound = np.where(wanted.turns[command], rotation / np.sqrt(2.0), origin)
    with np.errstate(divide="ignore", invalid="ignore"):
        # The remainder of a velocity falls with the third power of the number of pieces.
        need = h * np.cbrt(HERMITE_RATE * bound / (SHARP * cruise))
    need = np.where(np.isfinite(need), np.ceil(need), 1.0)
    finer: Rows = np.maximum(pieces, np.minimum(need, MOST_PIECES).astype(np.int64))
    return finer


def speed_bounds(motion: Motion, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """Bound the least and the largest speed (P,) of the frame's origin on each piece [m/s].

    Args:
        motion: the frame at the points between pieces.
        left: (P,) index of the point at which each piece begins.
        d: (P,) duration of each piece [s].
        fourth: (P,) bounds of the fourth derivative of the origin [m/s^4].
    """
    return _rate_bounds(motion.p, motion.velocity, left, d, fourth)


def turn_bounds(motion: Motion, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """Bound the least and the largest angular speed (P,) of the frame on each piece [rad/s].

    The rate of the rotation matrix has a Frobenius norm of sqrt 2 times the angular speed. The arguments are
    those of `speed_bounds`, with `fourth` for the rotation matrix [1/s^4].
    """
    rate = np.cross(motion.angular[:, :, None], motion.rotation, axis=1).reshape(-1, 9)
    low, high = _rate_bounds(motion.rotation.reshape(-1, 9), rate, left, d, fourth)
    return low / np.sqrt(2.0), high / np.sqrt(2.0)


def _rate_bounds(x: Array, rate: Array, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """Bound |x'| (P,) from below and above on pieces of time, for a position or rotation matrix x.

    x' is the derivative of the Hermite cubic, a parabola, plus a remainder. The squared length of the
    parabola has degree 4, and its five Bernstein coefficients bound it.
    """
    v0, v1 = rate[left], rate[left + 1]
    # The velocity of the Hermite cubic is a parabola with the Bezier points v0, middle and v1. Their mean is
    # the difference quotient of x.
    middle = 3.0 * (x[left + 1] - x[left]) / d[:, None] - v0 - v1
    # Compute the five Bernstein coefficients of the parabola's squared length, from the products of its
    # Bezier points.
    squares = np.stack(
        [
            _dot(v0, v0),
            _dot(v0, middle),
            (_dot(v0, v1) + 2.0 * _dot(middle, middle)) / 3.0,
            _dot(middle, v1),
            _dot(v1, v1),
        ]
    )
    # If the speed changes much, the coefficients of the four quarters give sharper bounds.
    squares = _QUARTERS @ squares
    rest = HERMITE_RATE * d**3 * fourth
    low = np.maximum(np.sqrt(np.maximum(squares.min(axis=0), 0.0)) - rest, 0.0)
    return low, np.sqrt(squares.max(axis=0)) + rest


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.einsum("ni,ni->n", a, b)
    return product


def judged(low: Array, high: Array, command: Rows, segment: Rows, follow: Rows, wanted: Programmed) -> Speeds:
    """Bound the speeds of commands from the speeds on their pieces.

    Args:
        low: (P,) least speed on each piece.
        high: (P,) largest speed on each piece.
        command: (P,) command of each piece, in order.
        segment: (P,) segment of each piece.
        follow: (C, 2) range of each command's segments outside of blends.
        wanted: the programmed speeds.
    """
    count = len(wanted.cruise)
    largest, beyond = np.zeros(count), np.zeros(count)
    least, most = np.full(count, np.nan), np.full(count, np.nan)
    begins = np.flatnonzero(np.diff(command, prepend=-1))
    largest[command[begins]] = segment_max(high, begins)
    ends = np.append(begins[1:], len(command))
    cruise, top = wanted.cruise[command], wanted.top[command]
    # Outside of blends, the limit is that of the motion itself; in a blend, it is that of the faster motion.
    before, after = segment < follow[command, 0], segment >= follow[command, 1]
    allowed = np.where(before, wanted.around[command, 0], np.where(after, wanted.around[command, 1], top))
    inside = ~before & ~after
    with np.errstate(invalid="ignore"):
        beyond_it = segment_max(high / allowed, begins)
        kept = inside & (low >= cruise * (1.0 - KEPT)) & (high <= top * (1.0 + KEPT))
    # The speed must be held from the first piece with the programmed speed to the last such piece.
    place = np.arange(len(command))
    first = np.minimum.reduceat(np.where(kept, place, len(command)), begins)
    last = segment_max(np.where(kept, place, -1), begins)
    sizes = ends - begins
    since = np.where(wanted.held[command, 0], 0, np.repeat(first, sizes))
    until = np.where(wanted.held[command, 1], len(command), np.repeat(last, sizes))
    # Select the pieces on which the motion must hold its programmed speed.
    between = inside & (place >= since) & (place <= until)
    slowest = np.minimum.reduceat(np.where(between, low, np.inf), begins)
    fastest = segment_max(np.where(between, high, -np.inf), begins)
    is_inside, is_kept = np.logical_or.reduceat(inside, begins), last >= 0
    for row, index in enumerate(command[begins].tolist()):
        if not np.isfinite(wanted.cruise[index]):
            continue
        beyond[index] = beyond_it[row]
        if not is_inside[row]:
            least[index] = most[index] = wanted.cruise[index]  # the whole command consists of blends
        elif is_kept[row]:
            least[index], most[index] = slowest[row], fastest[row]
        else:
            outside = begins[row] + np.flatnonzero(inside[begins[row] : ends[row]])
            least[index], most[index] = _for_an_instant(
                low[outside], high[outside], wanted.cruise[index], wanted.held[index]
            )
    return Speeds(wanted.turns, wanted.cruise, largest, least, most, beyond)


def _for_an_instant(low: Array, high: Array, cruise: float, held: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the least and the largest speed of a command without a whole piece at its programmed speed.

    Both are NaN if the command never reaches the programmed speed.

    Args:
        low: (P,) least speed on each piece outside of blends.
        high: (P,) largest speed on each piece outside of blends.
        cruise: the programmed speed.
        held: (2,) True if the speed must be held from the command's start to the fastest piece, and from that
            piece to the command's end.
    """
    peak = float(high.max())
    if peak < cruise * (1.0 - KEPT):
        return np.nan, np.nan
    at = int(np.argmax(high))
    before_it = low[:at] if held[0] else low[:0]
    after_it = low[at + 1 :] if held[1] else low[:0]
    return float(np.concatenate([[peak], before_it, after_it]).min()), peak
