"""Find the time of a motion during which a zone is broken, and the depth of the breach, for messages."""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Scene
from yarclang.collision.course import Course
from yarclang.collision.zones.workspace import Watch, slack_at, slack_of
from yarclang.frozen import frozen

SAMPLES = 200
"""Number of places of the motion that are sampled."""


@frozen
class Beyond:
    """The time of a motion during which a zone is broken. The values are sampled.

    Attributes:
        begin: start of this time, after the motion's start [s].
        end: end of this time, after the motion's start [s].
        worst: time of the sample at which the zone is broken most, after the motion's start [s].
        slack: distance from a violation at this sample, which is negative [m; rad or m for a joint window].
            Between the samples it may be slightly less.
    """

    begin: float
    end: float
    worst: float
    slack: float


def beyond(scene: Scene, course: Course, span: tuple[int, int], watch: Watch, seen: float) -> Beyond:
    """Return the time of a motion during which a zone is broken.

    Args:
        scene: the bodies of robot and cell.
        course: the segments of all motions.
        span: the first segment of the motion, and the one after its last.
        watch: the broken zone, with the item that breaks it.
        seen: a time of the course at which the zone is broken [s].
    """
    start, stop = (float(course.begins[edge]) for edge in span)
    times = np.sort(np.append(np.linspace(start, stop, SAMPLES), seen))
    slack = slack_at(scene, watch, course.at(times))
    # Distances at one place may differ by rounding from call to call: allow for this.
    limit = max(slack_of(watch), float(slack.min()) * (1.0 - 1e-6))
    (bad,) = np.nonzero(slack <= limit)
    ends = []
    # The breach begins and ends between two samples: find both times by bisection.
    for here, beside in ((int(bad[0]), int(bad[0]) - 1), (int(bad[-1]), int(bad[-1]) + 1)):
        inner, outer = float(times[here]), float(times[min(max(beside, 0), len(times) - 1)])
        for _ in range(20 if 0 <= beside < len(times) else 0):
            middle = (inner + outer) / 2.0
            is_broken = slack_at(scene, watch, course.at(np.array([middle])))[0] < limit
            inner, outer = (middle, outer) if is_broken else (inner, middle)
        ends.append(inner - start)
    worst = int(np.argmin(slack))
    return Beyond(ends[0], ends[1], float(times[worst]) - start, float(slack[worst]))
