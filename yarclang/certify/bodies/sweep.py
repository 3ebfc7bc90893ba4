"""The motions of a text as they are held against bodies and zones: as many at once as a chunk has."""

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
    """Commands that follow each other: what the joints do in their segments (`cubics`, and `course` for distances), and which of these (M, 2), first and last (not included), are those of each."""

    places: list[Place]
    cubics: Cubics
    course: Course
    spans: NDArray[np.int64]

    def span(self, row: int) -> tuple[int, int]:
        """The segments of one command."""
        begin, end = self.spans[row].tolist()
        return begin, end

    def starts(self, row: int) -> float:
        """When a command begins [s]."""
        return float(self.course.begins[self.spans[row, 0]])

    def lasts(self, row: int) -> float:
        """How long it takes [s]."""
        return float(self.course.begins[self.spans[row, 1]]) - self.starts(row)


def moving_chunks(layout: Layout, handled: Handled) -> Iterator[tuple[Cell | None, list[Place]]]:
    """Yield the commands that move something, in chunks, each with the cell as it is during these commands."""
    moving = [place for place in layout.places if place.size]
    for _, group in groupby(moving, lambda place: id(handled.at(place.step))):
        for places in chunks(list(group)):
            yield handled.at(places[0].step), places


def sweep_of(layout: Layout, places: list[Place]) -> Sweep:
    """What the joints do in commands that follow each other."""
    base = places[0].first
    cubics = layout.cubics(base, places[-1].last)
    return Sweep(
        places,
        cubics,
        course_of(cubics),
        np.array([(place.first - base, place.last - base) for place in places]),
    )


def course_of(cubics: Cubics) -> Course:
    """Segments as the collision check sees them."""
    return Course.of(cubics.x, cubics.v, cubics.a, cubics.j, cubics.h, cubics.velocity_peaks())
