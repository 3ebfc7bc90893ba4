"""From the lines of the text to spline segments, each with the command that it belongs to.

The controller's law (SPLINE1, TUM 289-290): the control points of one sequence are
S, S, S, c1 ... cM, cM, cM, with S where the robot stands and ci the programmed points; segment k, of
duration TM, is the uniform cubic B-spline of the points k to k + 3. It starts and ends at rest. Three equal
points inside a sequence are a full stop, and so a command ends there and the next one begins. Commands that flow into each other
stand in one sequence; the header's map says where, and how many segments belong to both.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from yarclang import hir
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Entry, Put, Run, Stood
from yarclang.certify.read.ways import Standing
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array
from yarclang.units import MS

_BARRIERS: dict[type, str] = {
    hir.When: "when",
    hir.Else: "else",
    hir.EndWhen: "end",
    hir.Finish: "stop",
    hir.Loop: "loop",
    hir.NextPass: "next",
    hir.Exit: "exit",
    hir.EndLoop: "endloop",
}
"""The barriers at which ways part, meet, end and begin anew."""

CHUNK = 8192
"""Segments that are judged at once: enough for whole-array work, few enough for the processor's cache."""


@frozen(eq=False)
class Place:
    """The segments `first` to `last` (not included) of `motion`, step `step` of the program.

    `lines` are the first and the last of its move lines in the text; None for a step without. `before` and `behind` are the
    segments of the blends at its start and its end, half of which belong to it; None where it starts or ends at rest. `any_jerk` says that the
    map gives its jerk no limit, `beside_any_jerk` so of the motions which it flows out of, and into.
    """

    step: int
    motion: hir.Motion
    first: int
    last: int
    lines: tuple[int, int] | None
    before: int | None = None
    behind: int | None = None
    any_jerk: bool = False
    beside_any_jerk: tuple[bool, bool] = (False, False)

    @property
    def size(self) -> int:
        """How many segments."""
        return self.last - self.first

    @property
    def last_line(self) -> str:
        """The last line as text."""
        return str(self.lines[1]) if self.lines else "none"


@frozen(eq=False)
class Layout:
    """All segments of the text, in order, and the commands that they belong to.

    `control` (G, n) has the control points of all sequences [rad or m], `at` (N,) where
    the four of a segment begin in it, `time` (N,) the duration of a segment [s]. `places` has one
    entry for each motion of the program, in order; `begins` and `ends` (len(places), n) are where the robot
    is before and behind each of them.
    """

    control: Array
    at: NDArray[np.int64]
    time: Array
    places: tuple[Place, ...]
    begins: Array
    ends: Array

    def points(self, place: Place) -> Array:
        """The control points of one command (segments + 3, n) [rad or m]."""
        if place.size == 0:
            return self.control[:0]
        return self.points_of(place.first, place.last)

    def points_of(self, begin: int, stop: int) -> Array:
        """The control points of the segments `begin` up to `stop` (not included) of one sequence [rad or m]."""
        return self.control[self.at[begin] : self.at[stop - 1] + 4]

    def cubics(self, begin: int, stop: int) -> Cubics:
        """The segments `begin` up to `stop` (not included)."""
        return Cubics.of_spline(self.control, self.at[begin:stop], self.time[begin:stop])

    def cubics_of(self, rows: NDArray[np.int64]) -> Cubics:
        """Return the segments of rows (K,) in any order."""
        return Cubics.of_spline(self.control, self.at[rows], self.time[rows])


def lay_out(
    text: ControllerText, program: hir.Program, start: Array, axis_units: Array, *, any_line: bool = False
) -> Layout | tuple[int | None, str]:
    """Give every segment to its command.

    Args:
        text: what was read.
        program: whose steps the map in the text's header must name, one by one.
        start: (n,) [rad or m], where the text starts.
        axis_units: (n,), the axis unit of each joint in SI.
        any_line: whether the map may place commands in other lines of the source.

    Returns:
        The segments, or the step and the reason why map, moves and program don't fit together.
    """
    if problem := _compare(text.entries, program, any_line=any_line):
        return problem
    moving = [entry for entry in text.entries if entry.first is not None]
    runs = [item for item in text.course if isinstance(item, Run)]
    lines = [run.lines for run in runs]
    spans = _spans(moving, lines)
    if isinstance(spans, tuple):
        return spans
    if problem := _blends(moving, spans, lines, program):
        return problem
    control, sizes = _sequences(text, runs, start, axis_units)
    # each sequence has three points more than segments
    at = np.arange(sizes.sum()) + np.repeat(3 * np.arange(len(sizes)), sizes)
    everything = Layout(
        control,
        at,
        np.repeat(np.array([run.segment_ms * MS for run in runs]), sizes),
        (),
        np.empty((0, len(start))),
        np.empty((0, len(start))),
    )
    return _with_places(everything, text.entries, program, spans, start)


def _sequences(
    text: ControllerText, runs: list[Run], start: Array, axis_units: Array
) -> tuple[Array, NDArray[np.int64]]:
    """The control points of all sequences (G, n) [rad or m], and how many segments each of them has."""
    if not runs:
        return np.empty((0, len(start))), np.empty(0, dtype=np.int64)
    counts = np.array([len(run.points) for run in runs], dtype=np.int64)
    points = np.concatenate([run.points for run in runs]) * axis_units
    behind = np.cumsum(counts)
    ends = points[behind - 1]
    stands: list[Array] = []
    stand, ways = start, list[Array]()
    for item in text.course:
        if isinstance(item, Run):
            stands.append(stand)
            stand = ends[len(stands) - 1]
        else:
            stand = _flow(item, stand, ways, axis_units)
    # where it stands, and each last point, three times
    each = np.insert(points, behind - counts, np.array(stands), axis=0)
    times = np.ones(len(each), dtype=np.int64)
    first = behind - counts + np.arange(len(runs))
    times[first] = times[first + counts] = 3
    return np.repeat(each, times, axis=0), counts + 2


def _flow(item: Dwelt | Put | Barred | Stood, stand: Array, ways: list[Array], axis_units: Array) -> Array:
    """Where the robot stands behind something that isn't a sequence: elsewhere only where a second way begins."""
    match item:
        case Barred(kind="when"):
            ways.append(stand)
        case Barred(kind="else") if ways:
            return ways[-1]
        case Barred(kind="end") if ways:
            ways.pop()
        case Stood(point=point):
            printed: Array = point * axis_units
            return printed
    return stand


def _compare(
    entries: tuple[Entry, ...], program: hir.Program, *, any_line: bool
) -> tuple[int | None, str] | None:
    """Where the map names other steps than the program has."""
    for step, entry in zip(range(len(program.steps)), entries, strict=False):
        meant_step = program.steps[step]
        if isinstance(meant_step, hir.Gap):
            return None, "the program has a command with errors"
        origin = meant_step.origin
        line = entry.source_line if any_line else origin.span.line
        said = (entry.step, entry.index, entry.name, entry.source_line)
        meant = (step, origin.label, origin.name, line)
        if said != meant:
            words = [
                " ".join(str(part or "-") if part != 0 else "0" for part in pair) for pair in (said, meant)
            ]
            return step, f"the map says command {words[0]} where the program has {words[1]} (line {entry.at})"
        if entry.first is not None and not isinstance(meant_step, hir.Motion):
            return step, f"the map gives a {origin.name} move lines (line {entry.at})"
        if entry.blend is not None and getattr(meant_step, "blend", None) is None:
            return step, f"the map blends a command that shall end at rest (line {entry.at})"
    if len(entries) != len(program.steps):
        return None, f"the map has {len(entries)} commands, the program {len(program.steps)}"
    return None


def _spans(
    moving: list[Entry], lines: list[NDArray[np.int64]]
) -> dict[int, tuple[int, int]] | tuple[int, str]:
    """The segments of each step that moves: its lines, and two more where the sequence ends behind it."""
    spans: dict[int, tuple[int, int]] = {}
    rest = iter(moving)
    segment = 0
    step = moving[-1].step if moving else 0
    for run in lines:
        place = 0
        while place < len(run):
            entry = next(rest, None)
            if entry is None:
                return step, f"the move lines from line {run[place]} on belong to no command"
            step = entry.step
            behind = int(np.searchsorted(run, entry.last or 0, side="right"))
            if entry.first != run[place] or behind <= place or run[behind - 1] != entry.last:
                return step, (
                    f"the map gives this command the lines {entry.first} to {entry.last}, but its moves "
                    f"begin in line {run[place]} and the sequence has moves up to line {run[-1]}"
                )
            size = behind - place + (2 if behind == len(run) else 0)
            spans[entry.step] = segment, segment + size
            segment, place = segment + size, behind
    if (entry := next(rest, None)) is not None:
        return (
            entry.step,
            f"the map gives this command the lines {entry.first} to {entry.last}: no moves are there",
        )
    return spans


def _blends(
    moving: list[Entry],
    spans: dict[int, tuple[int, int]],
    lines: list[NDArray[np.int64]],
    program: hir.Program,
) -> tuple[int, str] | None:
    """Blends that the sequences can't hold, or that run over what the robot does at rest."""
    last_lines = {int(run[-1]) for run in lines}
    before = 0
    for place, entry in enumerate(moving):
        blend = entry.blend or 0
        size = spans[entry.step][1] - spans[entry.step][0]
        if blend % 2:
            return entry.step, f"the blend has {blend} segments, which have no middle (line {entry.at})"
        if (before + blend) // 2 > size:
            return entry.step, (
                f"the command has {size} segments, and {before // 2} and {blend // 2} of them would lie in blends (line {entry.at})"
            )
        before = blend
        if entry.blend is None:
            continue
        if entry.last in last_lines:
            return entry.step, f"the sequence ends where it shall flow into the next one (line {entry.at})"
        between = program.steps[entry.step + 1 : moving[place + 1].step]
        if not all(isinstance(step, hir.SetOutput) for step in between):
            return entry.step, f"the map blends over what is done at rest (line {entry.at})"
    return None


def _with_places(
    segments: Layout,
    entries: tuple[Entry, ...],
    program: hir.Program,
    spans: dict[int, tuple[int, int]],
    start: Array,
) -> Layout:
    places, begins, ends = [], [], []
    stand, behind = start, 0
    closing = _closing(segments, [last for first, last in spans.values() if last > first])
    before: int | None = None
    standing = Standing(start)
    for entry, step in zip(entries, program.steps, strict=True):
        if not isinstance(step, hir.Motion):
            kind = _BARRIERS.get(type(step))
            if kind is not None:
                standing.at = stand
                with suppress(ValueError):  # which the text's flow is refused for
                    standing.pass_(kind)
                stand = standing.at
            continue
        first, last = spans.get(entry.step, (behind, behind))
        begins.append(stand)
        if last == first:
            places.append(Place(entry.step, step, first, last, None))
        else:
            assert entry.first is not None and entry.last is not None  # noqa: PT018 - as it has a span
            lines = (entry.first, entry.last)
            places.append(Place(entry.step, step, first, last, lines, before, entry.blend, entry.any_jerk))
            stand = closing[last]
            before, behind = entry.blend, last
        ends.append(stand)
    shape = (len(places), len(start))
    return Layout(
        segments.control,
        segments.at,
        segments.time,
        tuple(_with_neighbours(places)),
        np.array(begins).reshape(shape),
        np.array(ends).reshape(shape),
    )


def _with_neighbours(places: list[Place]) -> list[Place]:
    """The same places, with what they say of those beside them."""
    if not any(place.any_jerk for place in places):
        return places
    moving = [(row, place) for row, place in enumerate(places) if place.size]
    found = list(places)
    for number, (row, place) in enumerate(moving):
        before = place.before is not None and moving[number - 1][1].any_jerk
        behind = place.behind is not None and moving[number + 1][1].any_jerk
        found[row] = replace(place, beside_any_jerk=(before, behind))
    return found


def _closing(segments: Layout, stops: list[int]) -> dict[int, Array]:
    """Where the robot is (n,) behind some segments, by the number of the next one."""
    at = segments.at[np.array(stops, dtype=np.int64) - 1]
    first, middle, last = (segments.control[at + i] for i in (1, 2, 3))
    # exact where the command ends at rest; where it doesn't, the knot
    rests = (first == last).all(axis=1)[:, None]
    return dict(zip(stops, np.where(rests, last, (first + 4.0 * middle + last) / 6.0), strict=True))


def moving_at_ends(layout: Layout) -> list[Place]:
    """The commands that don't end at rest, and shall: their last three control points differ."""
    if not (moving := [place for place in layout.places if place.size and place.behind is None]):
        return []
    last = layout.at[np.array([place.last for place in moving]) - 1] + 3
    control = layout.control
    rest = (control[last] == control[last - 1]) & (control[last] == control[last - 2])
    return [place for place, still in zip(moving, rest.all(axis=1), strict=True) if not still]


def chunks(places: list[Place]) -> Iterator[list[Place]]:
    """Neighbouring commands together, up to about `CHUNK` segments."""
    for rows in row_chunks(list(enumerate(places))):
        yield [place for _, place in rows]


def row_chunks(rows: list[tuple[int, Place]]) -> Iterator[list[tuple[int, Place]]]:
    """The same for commands with a number each."""
    chunk: list[tuple[int, Place]] = []
    size = 0
    go_on(0, len(rows))
    for number, (row, place) in enumerate(rows):
        if chunk and size + place.size > CHUNK:
            yield chunk
            go_on(number, len(rows))
            chunk, size = [], 0
        chunk.append((row, place))
        size += place.size
    if chunk:
        yield chunk
