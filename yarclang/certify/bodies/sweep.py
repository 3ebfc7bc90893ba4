"""Motions of a controller text in groups, prepared for the checks of bodies and zones."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from yarclang.cell.model import Cell
from yarclang.certify.bodies.handled import Handled
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.read.layout import Layout, Place, chunks
from yarclang.collision.course import Course
from yarclang.frozen import frozen


@frozen(eq=False)
class Sweep:
    """Consecutive commands with their segments, prepared for the checks of bodies and zones.

    Attributes:
        places: the M commands.
        cubics: segments of all commands.
        course: the same segments in the form that the checks of distances need.
        spans: (M, 2) range of the segments of each command.
    """

    places: list[Place]
    cubics: Cubics
    course: Course
    spans: NDArray[np.int64]

    def span(self, row: int) -> tuple[int, int]:
        """Return the range of the segments of one command."""
        begin, end = self.spans[row].tolist()
        return begin, end

    def starts(self, row: int) -> float:
        """Return the time from the start of the first command to the start of this one [s]."""
        return float(self.course.begins[self.spans[row, 0]])

    def lasts(self, row: int) -> float:
        """Return the duration of a command [s]."""
        return float(self.course.begins[self.spans[row, 1]]) - self.starts(row)


def moving_chunks(layout: Layout, handled: Handled) -> Iterator[tuple[Cell | None, list[Place]]]:
    """Yield the commands with moves in groups, each with the cell's state, which is constant in a group."""
    moving = [place for place in layout.places if place.size]
    for _, group in groupby(moving, lambda place: id(handled.at(place.step))):
        for places in chunks(list(group)):
            yield handled.at(places[0].step), places


def sweep_of(layout: Layout, places: list[Place]) -> Sweep:
    """Prepare consecutive commands for the checks of bodies and zones."""
    base = places[0].first
    cubics = layout.cubics(base, places[-1].last)
    return Sweep(
        places,
        cubics,
        course_of(cubics),
        np.array([(place.first - base, place.last - base) for place in places]),
    )


def course_of(cubics: Cubics) -> Course:
    """Return segments in the form that the collision check needs."""
    return Course.of(cubics.x, cubics.v, cubics.a, cubics.j, cubics.h, cubics.velocity_peaks())
