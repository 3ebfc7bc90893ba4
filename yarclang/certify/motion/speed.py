"""How fast the moving frame goes, bounded at every instant, against the speed that is programmed (`[V 250]`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.motion.bounds import HERMITE_RATE, segment_max
from yarclang.certify.motion.programmed import Motion, Rows
from yarclang.frozen import frozen
from yarclang.robot.model import Array

KEPT = 1e-3
"""The cruise speed is the programmed one but for this share of it."""
SHARP = 1e-4
"""Pieces are made so short that the bounds of a programmed speed are at most this share of it apart from the truth."""
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
"""From five Bernstein coefficients those of the four quarters (20, 5) (de Casteljau)."""


@frozen(eq=False)
class Programmed:
    """The speeds that C commands shall have: at most `top` (C,), NaN where none is programmed, of the frame's origin [m/s], or,
    where its path only turns (`turns` (C,)), of the turn [rad/s]; at least `cruise` (C,) from when that is first reached up to when it is last left.

    `around` (C, 2) is the most that is allowed in the blend before and in that behind. `held` (C, 2) says that it is reached from the begin, and up to the end.
    """

    cruise: Array
    top: Array
    turns: NDArray[np.bool_]
    around: Array
    held: NDArray[np.bool_]


@frozen(eq=False)
class Speeds:
    """Proved bounds (C,) of the speeds of C commands, as `Programmed` [m/s or rad/s]: the most anywhere, and, where a cruise speed is
    programmed, the `least` and the `most` from when it is first reached up to when it is last left; NaN where it
    never is. `beyond` is the most that is allowed nowhere, as a share of what is allowed; it isn't above 1 + `KEPT` where all is well.
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
    """More pieces for segments (N,) of commands with a programmed speed, so that it can be told sharply.

    Args:
        pieces: (N,) as many as the path needs.
        h: (N,) [s].
        origin: (N,) bounds of fourth derivatives, of the frame's origin and its rotation matrix, likewise
        rotation: (N,).
        wanted: what is programmed.
        command: (N,) whose segments they are.
    """
    cruise = wanted.cruise[command]
    bound = np.where(wanted.turns[command], rotation / np.sqrt(2.0), origin)
    with np.errstate(divide="ignore", invalid="ignore"):
        need = h * np.cbrt(HERMITE_RATE * bound / (SHARP * cruise))
    need = np.where(np.isfinite(need), np.ceil(need), 1.0)
    finer: Rows = np.maximum(pieces, np.minimum(need, MOST_PIECES).astype(np.int64))
    return finer


def speed_bounds(motion: Motion, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """Least and largest speed (P,) of the frame's origin on each piece [m/s].

    Args:
        motion: the frame at the points between pieces.
        left: (P,) the point at which each piece begins.
        d: (P,) how long it is [s].
        fourth: (P,) bounds of the fourth derivative of the origin there.
    """
    return _rate_bounds(motion.p, motion.velocity, left, d, fourth)


def turn_bounds(motion: Motion, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """The same of the frame's angular speed [rad/s]: a rotation matrix changes by sqrt 2 times that in the Frobenius norm."""
    rate = np.cross(motion.angular[:, :, None], motion.rotation, axis=1).reshape(-1, 9)
    low, high = _rate_bounds(motion.rotation.reshape(-1, 9), rate, left, d, fourth)
    return low / np.sqrt(2.0), high / np.sqrt(2.0)


def _rate_bounds(x: Array, rate: Array, left: Rows, d: Array, fourth: Array) -> tuple[Array, Array]:
    """Bounds (P,) of |x'| on pieces: x' is that of the Hermite cubic, a parabola, but for a remainder; the square of its length has
    five Bernstein coefficients.
    """
    v0, v1 = rate[left], rate[left + 1]
    middle = 3.0 * (x[left + 1] - x[left]) / d[:, None] - v0 - v1
    squares = np.stack(
        [
            _dot(v0, v0),
            _dot(v0, middle),
            (_dot(v0, v1) + 2.0 * _dot(middle, middle)) / 3.0,
            _dot(middle, v1),
            _dot(v1, v1),
        ]
    )
    # where the speed changes much, those of its quarters are nearer to it
    squares = _QUARTERS @ squares
    rest = HERMITE_RATE * d**3 * fourth
    low = np.maximum(np.sqrt(np.maximum(squares.min(axis=0), 0.0)) - rest, 0.0)
    return low, np.sqrt(squares.max(axis=0)) + rest


def _dot(a: Array, b: Array) -> Array:
    product: Array = np.einsum("ni,ni->n", a, b)
    return product


def judged(low: Array, high: Array, command: Rows, segment: Rows, follow: Rows, wanted: Programmed) -> Speeds:
    """The speeds of commands from those of their pieces.

    Args:
        low: (P,) least and
        high: (P,) largest speed on each piece.
        command: (P,) whose it is, in order.
        segment: (P,) and of which segment.
        follow: (C, 2) the segments, from and up to, that aren't in a blend.
        wanted: what is programmed.
    """
    count = len(wanted.cruise)
    largest, beyond = np.zeros(count), np.zeros(count)
    least, most = np.full(count, np.nan), np.full(count, np.nan)
    begins = np.flatnonzero(np.diff(command, prepend=-1))
    largest[command[begins]] = segment_max(high, begins)
    ends = np.append(begins[1:], len(command))
    cruise, top = wanted.cruise[command], wanted.top[command]
    before, behind = segment < follow[command, 0], segment >= follow[command, 1]
    allowed = np.where(before, wanted.around[command, 0], np.where(behind, wanted.around[command, 1], top))
    inside = ~before & ~behind
    with np.errstate(invalid="ignore"):
        beyond_it = segment_max(high / allowed, begins)
        kept = inside & (low >= cruise * (1.0 - KEPT)) & (high <= top * (1.0 + KEPT))
    # from the first piece on, up to the last, on which the speed is kept
    place = np.arange(len(command))
    first = np.minimum.reduceat(np.where(kept, place, len(command)), begins)
    last = segment_max(np.where(kept, place, -1), begins)
    sizes = ends - begins
    since = np.where(wanted.held[command, 0], 0, np.repeat(first, sizes))
    until = np.where(wanted.held[command, 1], len(command), np.repeat(last, sizes))
    between = inside & (place >= since) & (place <= until)
    slowest = np.minimum.reduceat(np.where(between, low, np.inf), begins)
    fastest = segment_max(np.where(between, high, -np.inf), begins)
    is_inside, is_kept = np.logical_or.reduceat(inside, begins), last >= 0
    for row, own in enumerate(command[begins].tolist()):
        if not np.isfinite(wanted.cruise[own]):
            continue
        beyond[own] = beyond_it[row]
        if not is_inside[row]:
            least[own] = most[own] = wanted.cruise[own]  # all of it is blends
        elif is_kept[row]:
            least[own], most[own] = slowest[row], fastest[row]
        else:
            own_pieces = begins[row] + np.flatnonzero(inside[begins[row] : ends[row]])
            least[own], most[own] = _for_an_instant(
                low[own_pieces], high[own_pieces], wanted.cruise[own], wanted.held[own]
            )
    return Speeds(wanted.turns, wanted.cruise, largest, least, most, beyond)


def _for_an_instant(low: Array, high: Array, cruise: float, held: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the least and the largest speed of a command that keeps its speed on no whole piece; NaN if it never reaches it.

    Args:
        low: (P,) the least speed on each piece outside of blends.
        high: (P,) the largest.
        cruise: the speed.
        held: (2,) whether it is held from the begin up to where it is reached, and from there up to the end.
    """
    peak = float(high.max())
    if peak < cruise * (1.0 - KEPT):
        return np.nan, np.nan
    at = int(np.argmax(high))
    before_it = low[:at] if held[0] else low[:0]
    after_it = low[at + 1 :] if held[1] else low[:0]
    return float(np.concatenate([[peak], before_it, after_it]).min()), peak
