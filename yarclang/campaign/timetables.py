"""Random timetables (joint positions at given times), such as motion planners of other makers produce."""

from __future__ import annotations

import numpy as np

from yarclang.independent.arm import Arm, Array
from yarclang.independent.timetable import Timetable

KINDS = ("positions", "velocities", "accelerations")
"""Contents of a timetable's rows besides the times: positions only, positions and velocities, or also
accelerations.
"""


def drawn(arm: Arm, random: np.random.Generator, kind: str, start: Array | None = None) -> Timetable:
    """Draw a random timetable that begins at `start`, or near the arm's HOME. The joints move back and forth,
    or along a line with ramps, sampled about every 0.1 s.

    The peaks of velocity and acceleration are between 0.3 and 1.5 times the limits.
    """
    home = np.array(arm.data["positions"]["HOME"], float)
    room = np.minimum(np.minimum(arm.upper - home, home - arm.lower), 60.0)
    if start is None:
        start = np.round(home + random.uniform(-0.4, 0.4, len(home)) * room, 4)
    else:
        # Stay near the start, so that a timetable doesn't make the compiler refuse the whole program.
        room = np.minimum(np.minimum(arm.upper - start, start - arm.lower), 25.0)
    way = random.uniform(-0.5, 0.5, len(home)) * room
    if random.random() < 0.5:
        shares, rates, bends = _swinging(random)
    else:
        shares, rates, bends = _ramped(random)
    peaks = np.abs(way) * np.abs(rates).max(), np.abs(way) * np.abs(bends).max()
    # Scale the duration so that the most loaded joint reaches 0.3 to 1.5 times one of its limits.
    duration = max((peaks[0] / arm.velocity).max(), np.sqrt((peaks[1] / arm.acceleration).max()))
    duration /= random.uniform(0.3, 1.5)
    count = max(3, round(duration / random.uniform(0.05, 0.2)))
    at = np.linspace(0.0, 1.0, count + 1)[1:]
    if random.random() < 0.3:
        at[:-1] += random.uniform(-0.3, 0.3, count - 1) / count
    place = np.round(at * (len(shares) - 1)).astype(int)
    times = np.round(at * duration, 4)
    rows = np.round(start + shares[place, None] * way, 4)
    velocities: Array | None = None
    accelerations: Array | None = None
    if kind != "positions":
        velocities = np.round(rates[place, None] * way / duration, 4)
        velocities[-1] = 0.0
    if kind == "accelerations":
        accelerations = np.round(bends[place, None] * way / duration**2, 4)
    return Timetable(start, times, rows, velocities, accelerations)


def _swinging(random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return the progress s(t) of a motion that goes back and forth along a line, and its first two
    derivatives, sampled over a duration of 1. All three are 0 at both ends.
    """
    u = np.linspace(0.0, 1.0, 20_001)
    turns = random.integers(1, 4)
    # The window makes the progress and its first two derivatives vanish at both ends.
    window = u**3 * (1 - u) ** 3 * 64.0
    share = window * np.cos(np.pi * turns * u)
    first = np.gradient(share, u, edge_order=2)
    return share, first, np.gradient(first, u, edge_order=2)


def _ramped(random: np.random.Generator) -> tuple[Array, Array, Array]:
    """Return the progress s(t) from 0 to 1 of a motion with constant acceleration, cruise and constant
    deceleration, and its first two derivatives, sampled over a duration of 1.
    """
    u = np.linspace(0.0, 1.0, 20_001)
    ramp = random.uniform(0.15, 0.45)
    bend = np.where(u < ramp, 1.0, np.where(u > 1 - ramp, -1.0, 0.0)) / (ramp * (1 - ramp))
    rate = np.minimum(np.minimum(u, 1 - u), ramp) / (ramp * (1 - ramp))
    share = np.concatenate(([0.0], np.cumsum((rate[1:] + rate[:-1]) / 2.0) * u[1]))
    return share, rate, bend
