"""Find from when to when two bodies are too near during a motion, for messages."""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Scene
from yarclang.collision.course import Course
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.proof import SLACK, Meeting
from yarclang.frozen import frozen
from yarclang.shapes import Array

SAMPLES = 200
"""Number of places of the motion that are sampled."""


@frozen
class Contact:
    """The time of a motion during which two bodies are too near.

    It lasts from `begin` to `end` [s] after the motion's start. The bodies are nearest at `worst` [s], where
    their distance is `distance` [m]; a negative distance is a depth of penetration. The values are sampled:
    between the samples the distance may be slightly less.
    """

    begin: float
    end: float
    worst: float
    distance: float


def contact(scene: Scene, course: Course, span: tuple[int, int], meeting: Meeting) -> Contact:
    """Return the time of a motion during which two bodies are too near.

    Args:
        scene: the bodies and pairs.
        course: the segments of all motions.
        span: the first segment of the motion, and the one after its last.
        meeting: the pair of bodies, and a time at which the two are too near.
    """
    start, stop = (float(course.begins[edge]) for edge in span)
    times = np.sort(np.append(np.linspace(start, stop, SAMPLES), meeting.time))
    apart = _apart(scene, course, times, meeting.pair)
    limit = float(scene.pairs.margin[meeting.pair]) + SLACK
    # coal's distance at one place may differ by rounding from call to call.
    (near,) = np.nonzero(apart < max(limit, float(apart.min()) + SLACK))
    ends = []
    # Bisect between the first and the last sample that is too near and their neighbours.
    for here, beside in ((int(near[0]), int(near[0]) - 1), (int(near[-1]), int(near[-1]) + 1)):
        inside, outside = float(times[here]), float(times[min(max(beside, 0), len(times) - 1)])
        for _ in range(20 if 0 <= beside < len(times) else 0):
            middle = (inside + outside) / 2.0
            if _apart(scene, course, np.array([middle]), meeting.pair)[0] < limit:
                inside = middle
            else:
                outside = middle
        ends.append(inside - start)
    worst = int(np.argmin(apart))
    return Contact(ends[0], ends[1], float(times[worst]) - start, float(apart[worst]))


def _apart(scene: Scene, course: Course, times: Array, pair: int) -> Array:
    placed = place(scene, course.at(times))
    pairs = np.full(len(times), pair)
    return distances(scene, pairs, relative(placed, np.arange(len(times)), pairs))
