"""How fast the moving frame goes, bounded at every instant, against the speed that is programmed (`[V 250]`)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.certify.bounds import HERMITE_RATE, segment_max
from yarclang.certify.programmed import Motion, Rows
from yarclang.frozen import frozen
from yarclang.robot.model import Array

KEPT = 1e-3
"""The cruise speed is the programmed one but for this share of it."""
SHARP = 1e-4
"""Pieces are made so short that the bounds of a programmed speed are at most this share of it apart from the truth."""
MOST_PIECES = 32


@frozen(eq=False)
class Programmed:
    """The speeds that C commands shall have: `cruise` (C,), NaN where none is programmed, of the frame's origin [m/s], or,
    where its path only turns (`turns` (C,)), of the turn [rad/s].

    `around` (C, 2) is the most that is allowed in the blend before and in that behind.
    """

    cruise: Array
    turns: NDArray[np.bool_]
    around: Array


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
    for begin, end in zip(begins, ends, strict=True):
        own = int(command[begin])
        cruise = wanted.cruise[own]
        if not np.isfinite(cruise):
            continue
        slow, fast, where = low[begin:end], high[begin:end], segment[begin:end]
        before, behind = where < follow[own, 0], where >= follow[own, 1]
        allowed = np.where(before, wanted.around[own, 0], np.where(behind, wanted.around[own, 1], cruise))
        beyond[own] = (fast / allowed).max()
        inside = ~before & ~behind
        (kept,) = np.nonzero(inside & (slow >= cruise * (1.0 - KEPT)) & (fast <= cruise * (1.0 + KEPT)))
        if len(kept):
            least[own] = slow[kept[0] : kept[-1] + 1].min()
            most[own] = fast[kept[0] : kept[-1] + 1].max()
        elif not inside.any():
            least[own] = most[own] = cruise  # all of it is blends
        elif (peak := fast[inside].max()) >= cruise * (1.0 - KEPT):
            least[own] = most[own] = peak  # for an instant only
    return Speeds(wanted.turns, wanted.cruise, largest, least, most, beyond)
