"""Compute the control points of a motion profile along a path: sample poses at equal times, and take their
moving averages.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.chains.flowing.demands import Smoothing, joints
from yarclang.motion.chains.flowing.law import Pace
from yarclang.motion.chains.flowing.turns import matrices, steadied
from yarclang.motion.chains.flowing.way import Way
from yarclang.motion.curve import knot_values

_STANDS = 1e-12
_REACHED = 1e-8


@frozen(eq=False)
class Sampled:
    """The control points (n + 3, d) of a chain, with their places along the path.

    `points` are computed from moving averages of poses, and `places` (n + 3,) [m] in the same way from the
    places of these poses along the path. `begin` is the time of the motion profile at knot 0 [s].
    """

    points: Array
    places: Array
    begin: float

    def passing(self, places: Array, segment: float) -> Array:
        """Return the times at which the smoothed motion passes places (K,) on the path, counted from knot 0
        [s].

        The smoothed motion is late where the motion profile speeds up, and early where it slows down.
        """
        passed = knot_values(self.places)
        found: Array = segment * np.interp(places, passed, np.arange(len(passed), dtype=np.float64))
        return found


def sampled(way: Way, pace: Pace, smoothing: Smoothing) -> Sampled | None:
    """Compute the control points for a motion profile along a path; None if the arm can't reach an averaged
    pose.

    Beyond a seam the control points continue for `smoothing.around` segments.
    """
    h, (long, short) = smoothing.segment, smoothing.widths
    # Two successive means over `long` and `short` samples involve long + short - 1 samples.
    support = long + short - 2
    cut = (support + 1) // 2
    beyond, pad = smoothing.around, support + 4
    first = -beyond - 1 if pace.seams[0] else cut - pad
    last = (
        round(pace.duration / h) + beyond + 2
        if pace.seams[1]
        else int(np.ceil(pace.duration / h - 1e-9)) + 1 + pad + cut - support
    )
    # The mean of an even number of samples belongs to a time between two samples. Sharpening needs one more
    # sample on either side.
    times = np.arange(first - cut - 1, last - cut + support + 1, dtype=np.float64) * h
    times += 0.5 * h if support % 2 else 0.0
    places = pace.places(times)
    own, share = way.located(places)
    p, turns = way.poses(own, share)
    p, turns, mean_places = (
        _mean(_mean(values, long), short) for values in (p, steadied(turns), places[:, None])
    )
    # If rotations are small, the normalised mean of neighbouring quaternions is their mean orientation.
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    q, miss = joints(way, p, matrices(turns), way.seeds(own, share)[cut : cut + len(p)], way.paths[0])
    if miss.max() > _REACHED:
        return None
    # A spline with control values f has the value f + f'' h^2 / 6 at its knots: subtract this difference from
    # f.
    q, s = _sharpened(q), _sharpened(mean_places)[:, 0]
    # At an end at which the curve rests, it has three equal control points.
    if not pace.seams[0]:
        lead = int(np.argmax(np.abs(q - way.ends[0]).max(axis=1) > _STANDS))
        q, s = (
            np.concatenate((np.tile(way.ends[0], (3, 1)), q[lead:])),
            np.concatenate((np.zeros(3), s[lead:])),
        )
        first += lead - 3
    if not pace.seams[1]:
        tail = len(q) - int(np.argmax((np.abs(q - way.ends[-1]).max(axis=1) > _STANDS)[::-1]))
        q = np.concatenate((q[:tail], np.tile(way.ends[-1], (3, 1))))
        s = np.concatenate((s[:tail], np.full(3, way.begins[-1])))
    # The curve passes knot 0 at the time of the second control point.
    return Sampled(q, s, (first + 1) * h)


def _sharpened(values: Array) -> Array:
    """Return control values (N - 2, d) of a spline that nearly passes through given values (N, d).

    They are the values minus a sixth of their second differences.
    """
    found: Array = values[1:-1] - (values[2:] - 2.0 * values[1:-1] + values[:-2]) / 6.0
    return found


def _mean(values: Array, width: int) -> Array:
    """Return moving averages (N - width + 1, d) over `width` neighbouring values."""
    if width <= 1:
        return values
    # Add shifted copies of the values. With a cumulated sum, values outside of the window would affect the
    # result by rounding.
    count = len(values) - width + 1
    found: Array = sum(values[at : at + count] for at in range(1, width)) + values[:count]
    found /= width
    return found
