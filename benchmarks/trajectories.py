"""Measure the time to read, plan and prove timetables of many waypoints.

python benchmarks/trajectories.py [COUNT ...] [--rates] [--rounds N]

The process has already imported everything; the times are the best of several rounds. Goals are 150 ms for
100 waypoints and 3 s for 10,000.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import yarclang
from yarclang.syntax.parse import forget

GOALS = {100: 0.15, 10_000: 3.0}
"""Goals [s] by number of waypoints."""

STEP = 0.1
"""Time between two waypoints [s]."""


def main() -> None:
    """Measure the task of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", type=int, nargs="*", default=[100, 1_000, 10_000])
    parser.add_argument("--rates", action="store_true", help="with velocities")
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    yarclang.compile(text(20, rates=asked.rates))
    for count in asked.counts:
        source = text(count, rates=asked.rates)
        times = []
        for _ in range(asked.rounds):
            forget()  # empties the cache of lines that were read
            begun = time.perf_counter()
            made = yarclang.compile(source)
            times.append(time.perf_counter() - begun)
            assert made.value is not None, made.diagnostics[:3]
        goal = f", goal {GOALS[count]:g} s" if count in GOALS else ""
        command = made.value.certificate.commands[-1]
        print(
            f"{count:,} waypoints: {min(times):.3f} s{goal}; {command.segments:,} segments of "
            f"{command.segment_time * 1e3:.4g} ms, within "
            f"{command.deviation.angle:.2g} rad"
        )


def text(count: int, *, rates: bool) -> str:
    """Return a program that moves all joints to and fro, each with its own period, through `count`
    waypoints.
    """
    times = STEP * np.arange(1, count + 1)
    middle = np.array([0.0, 0.0, 20.0, 0.0, 30.0, 0.0])
    far, pace = np.array([30.0, 10.0, 10.0, 20.0, 20.0, 40.0]), np.array([0.5, 0.7, 0.4, 0.6, 0.9, 0.3])
    ease = np.clip(np.minimum(times, times[-1] - times) / 5.0, 0.0, 1.0)[:, None]
    ease = ease**2 * (3.0 - 2.0 * ease)
    q = middle + far * np.sin(pace * times[:, None]) * ease
    rows = [f"{_numbers(row)} [{at:.3f}]" for row, at in zip(q, times, strict=True)]
    if rates:
        velocities = np.gradient(q, times, axis=0)
        velocities[-1] = 0.0
        rows = [f"{row} VEL {_numbers(one)}" for row, one in zip(rows, velocities, strict=True)]
    way = ";\n  ".join(rows)
    return (
        f"ROBOT INDUSTRIAL6\nDEFAULT (deg,s)\nP0010 MOVEJ {_numbers(middle)} [MIN]\nP0020 MOVEJ_TIMED {way}\n"
    )


def _numbers(values: np.ndarray) -> str:
    return " ".join(f"{value:.6f}" for value in values)


if __name__ == "__main__":
    main()
