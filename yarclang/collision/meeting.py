"""Find the time of a motion during which two bodies are too near, for messages."""

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
    """The time of a motion during which two bodies are too near. The values are sampled.

    Attributes:
        begin: start of this time, after the motion's start [s].
        end: end of this time, after the motion's start [s].
        worst: time of the sample at which the bodies are nearest, after the motion's start [s].
        distance: distance of the bodies at this sample [m]; a negative one is a depth of penetration. Between
            the samples it may be slightly less.
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
    # coal's distance at one place may differ by rounding from call to call: allow for this.
    (near,) = np.nonzero(apart < max(limit, float(apart.min()) + SLACK))
    ends = []
    # The bodies become too near, and leave each other, between two samples: find both times by bisection.
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
