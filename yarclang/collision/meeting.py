"""Where on a motion two bodies come too near, for those who have to change it."""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Scene
from yarclang.collision.course import Course
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.proof import SLACK, Meeting
from yarclang.frozen import frozen
from yarclang.shapes import Array

SAMPLES = 200
"""Places of the motion that are looked at."""


@frozen
class Contact:
    """Between `begin` and `end` [s] after the motion's start a pair is too near; nearest at `worst`, where it is `distance` [m] apart
    (negative: so deep one is in the other). They are found by samples: between them it may be a little worse.
    """

    begin: float
    end: float
    worst: float
    distance: float


def contact(scene: Scene, course: Course, span: tuple[int, int], meeting: Meeting) -> Contact:
    """Where the pair of a meeting is too near, on the segments `span`, from and up to, of its motion."""
    start, stop = (float(course.begins[edge]) for edge in span)
    times = np.sort(np.append(np.linspace(start, stop, SAMPLES), meeting.time))
    apart = _apart(scene, course, times, meeting.pair)
    limit = float(scene.pairs.margin[meeting.pair]) + SLACK
    # coal's distance at one place may differ by rounding from one call to the next
    (near,) = np.nonzero(apart < max(limit, float(apart.min()) + SLACK))
    ends = []
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
