"""Where on a motion a zone is broken, and how badly, for those who have to change it."""

from __future__ import annotations

import numpy as np

from yarclang.collision.bodies import Scene
from yarclang.collision.course import Course
from yarclang.collision.zones.workspace import Watch, slack_at, slack_of
from yarclang.frozen import frozen

SAMPLES = 200
"""Places of the motion that are looked at."""


@frozen
class Beyond:
    """Between `begin` and `end` [s] after the motion's start a watch is broken, worst at `worst`, where its slack is `slack` [m, of a joint window rad or m]:
    below zero. They are found by samples: between them it may be a little worse.
    """

    begin: float
    end: float
    worst: float
    slack: float


def beyond(scene: Scene, course: Course, span: tuple[int, int], watch: Watch, seen: float) -> Beyond:
    """Where a watch is broken on the segments `span`, from and up to, of a motion; `seen` is a time [s] of the course at which it is."""
    start, stop = (float(course.begins[edge]) for edge in span)
    times = np.sort(np.append(np.linspace(start, stop, SAMPLES), seen))
    slack = slack_at(scene, watch, course.at(times))
    # distances at one place may differ by rounding from one call to the next
    limit = max(slack_of(watch), float(slack.min()) * (1.0 - 1e-6))
    (bad,) = np.nonzero(slack <= limit)
    ends = []
    for here, beside in ((int(bad[0]), int(bad[0]) - 1), (int(bad[-1]), int(bad[-1]) + 1)):
        inner, outer = float(times[here]), float(times[min(max(beside, 0), len(times) - 1)])
        for _ in range(20 if 0 <= beside < len(times) else 0):
            middle = (inner + outer) / 2.0
            is_broken = slack_at(scene, watch, course.at(np.array([middle])))[0] < limit
            inner, outer = (middle, outer) if is_broken else (inner, middle)
        ends.append(inner - start)
    worst = int(np.argmin(slack))
    return Beyond(ends[0], ends[1], float(times[worst]) - start, float(slack[worst]))
