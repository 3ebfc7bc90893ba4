"""Compare the lengths of paths around obstacles with the best of 20 runs of OMPL's RRT-Connect, with all of
its shortening and the same collision checker: `python benchmarks/short.py`.

The length of a path is the time that the slowest joint needs at its largest speed; no law of motion can be
faster. RRT-Connect's paths have corners, at which an arm would have to stop; ours are smooth and proved to be
free.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from yarclang.motion.avoid.shorten import duration
from yarclang.motion.avoid.way import NoWay, find_way
from yarclang.motion.paths.spline import through
from yarclang.robot.description import load_robot
from yarclang.robot.model import Array

sys.path.insert(0, str(Path(__file__).parent))
import avoid
import tight
from peer_ways import by_peer

OPEN, RUNS, SECONDS = 20, 20, 1.0
"""Number of problems among boxes in the open, and number and longest time [s] of the other solver's runs for
each.
"""
SEARCHES = (1, 2, 4, 8)
"""Values of --avoid-effort."""


def compare() -> None:
    """Print a row for each number of searches."""
    rows = list(_rows())
    print(
        "| --avoid-effort | of the best of 20: mean | worst | time of the motion, of that with 1 | "
        "computing, mean |\n|---|---|---|---|---|"
    )
    ratio = np.array([[length / best for length, _, _ in ours] for best, ours in rows])
    takes = np.array([[lasts for _, lasts, _ in ours] for _, ours in rows])
    cpu = np.array([[spent for *_, spent in ours] for _, ours in rows])
    for at, number in enumerate(SEARCHES):
        print(
            f"| {number} | {ratio[:, at].mean():.2f} | {ratio[:, at].max():.2f} | "
            f"{(takes[:, at] / takes[:, 0]).mean():.2f} | {cpu[:, at].mean():.2f} s |"
        )
    print(f"\n{len(rows)} problems")


def _rows() -> Iterator[tuple[float, list[tuple[float, float, float]]]]:
    """Yield for each problem the length of the other solver's best path [s], and for each number of searches
    the length of ours, the time of the motion and that of computing [s].
    """
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    places = [one for one in tight.problems((robot,)) if one.kind in ("cage", "shelf", "table")]
    for problem in (*avoid.solvable(robot, OPEN), *places):
        room = avoid.room_around(robot, problem.cell)
        ways = (by_peer(room, problem.start, problem.goal, seed, SECONDS) for seed in range(1, RUNS + 1))
        lengths = [_length(way, robot.limits.velocity) for way in ways if way is not None]
        if not lengths:
            continue  # nothing to compare with
        ours = []
        for number in SEARCHES:
            begun = time.process_time()
            way = find_way(room, problem.start, problem.goal, searches=number)
            spent = time.process_time() - begun
            assert not isinstance(way, NoWay)
            path = through(np.concatenate((problem.start[None], way.waypoints)), robot.chain.is_prismatic)
            length = _length(path.joints(np.linspace(0.0, 1.0, 2001)), robot.limits.velocity)
            ours.append((length, duration(path.spline, robot.limits), spent))
        yield min(lengths), ours


def _length(points: Array, velocity: Array) -> float:
    return float((np.abs(np.diff(points, axis=0)) / velocity).max(axis=1).sum())


if __name__ == "__main__":
    compare()
