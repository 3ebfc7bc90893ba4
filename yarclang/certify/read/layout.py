"""Conversion of the lines of a controller text to spline segments, each with its command.

The control points of one sequence in the controller's spline mode (SPLINE1, TUM 289-290) are S, S, S, c1 ...
cM, cM, cM, with S the current position and ci the programmed points. Segment k, of duration TM, is the
uniform cubic B-spline of the points k to k + 3. The sequence starts and ends at rest. Three equal points
inside a sequence are a full stop, where one command ends and the next begins. Commands that flow into each
other share a sequence; the map in the text's header says where they meet, and how many segments belong to
both.
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

BARRIERS: dict[type, str] = {
    hir.When: "when",
    hir.Else: "else",
    hir.EndWhen: "end",
    hir.Finish: "stop",
    hir.Loop: "loop",
    hir.NextPass: "next",
    hir.Exit: "exit",
    hir.EndLoop: "endloop",
}
"""Barriers at which branches and loops begin, merge, end or repeat."""

CHUNK = 8192
"""Number of segments judged in one step: enough for efficient work on whole arrays, and few enough for the
processor's cache.
"""


@frozen(eq=False)
class Place:
    """The segments of one motion in a controller text.

    Attributes:
        step: index of the motion in the program's steps.
        motion: the motion.
        first: index of the first segment.
        last: index of the segment after the last one.
        lines: the first and the last move line in the text; None without moves.
        before: number of segments of the blend at the motion's start, half of which belong to the motion;
            None if it starts at rest.
        behind: number of segments of the blend at the motion's end, half of which belong to the motion; None
            if it ends at rest.
        any_jerk: True if the map says that the motion has no jerk limit.
        beside_any_jerk: for the motion that flows into this one, and for the motion that this one flows into,
            True if the map says that it has no jerk limit.
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
        """Number of segments."""
        return self.last - self.first

    @property
    def last_line(self) -> str:
        """The number of the last move line as a text; "none" without moves."""
        return str(self.lines[1]) if self.lines else "none"


@frozen(eq=False)
class Layout:
    """All N segments of the text in order, and the commands that they belong to.

    Attributes:
        control: (G, n) control points of all sequences [rad or m].
        at: (N,) index of the first of the four control points of each segment.
        time: (N,) duration of each segment [s].
        places: the motions of the program in order, with their segments.
        begins: (len(places), n) robot's position before each motion [rad or m].
        ends: (len(places), n) robot's position after each motion [rad or m].
    """

    control: Array
    at: NDArray[np.int64]
    time: Array
    places: tuple[Place, ...]
    begins: Array
    ends: Array

    def points(self, place: Place) -> Array:
        """Return the control points of one command (segments + 3, n) [rad or m]."""
        if place.size == 0:
            return self.control[:0]
        return self.points_of(place.first, place.last)

    def points_of(self, begin: int, stop: int) -> Array:
        """Return the control points of the segments `begin` up to `stop` (excluded) of one sequence [rad
        or m].
        """
        return self.control[self.at[begin] : self.at[stop - 1] + 4]

    def cubics(self, begin: int, stop: int) -> Cubics:
        """Return the segments `begin` up to `stop` (not included)."""
        return Cubics.of_spline(self.control, self.at[begin:stop], self.time[begin:stop])

    def cubics_of(self, rows: NDArray[np.int64]) -> Cubics:
        """Return the segments with the indices `rows` (K,), in any order."""
        return Cubics.of_spline(self.control, self.at[rows], self.time[rows])


def lay_out(
    text: ControllerText, program: hir.Program, start: Array, axis_units: Array, *, any_line: bool = False
) -> Layout | tuple[int | None, str]:
    """Assign every segment to its command.

    Args:
        text: the controller text, as the judge has read it.
        program: the program; the map in the text's header must list exactly its steps.
        start: (n,) joint positions at the start of the text [rad or m].
        axis_units: (n,) axis unit of each joint in SI units.
        any_line: True to accept other source lines in the map than those of the program.

    Returns:
        The segments, or the step and the reason why map, moves and program do not match.
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
    # Each sequence has three control points more than segments.
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
    """Return the control points of all sequences (G, n) [rad or m], and each sequence's number of
    segments.
    """
    if not runs:
        return np.empty((0, len(start))), np.empty(0, dtype=np.int64)
    counts = np.array([len(run.points) for run in runs], dtype=np.int64)
    points = np.concatenate([run.points for run in runs]) * axis_units
    stops = np.cumsum(counts)
    ends = points[stops - 1]
    stands: list[Array] = []
    stand, ways = start, list[Array]()
    for item in text.course:
        if isinstance(item, Run):
            stands.append(stand)
            stand = ends[len(stands) - 1]
        else:
            stand = _flow(item, stand, ways, axis_units)
    # The position before a sequence, and the last point of the sequence, appear three times.
    each = np.insert(points, stops - counts, np.array(stands), axis=0)
    times = np.ones(len(each), dtype=np.int64)
    first = stops - counts + np.arange(len(runs))
    times[first] = times[first + counts] = 3
    return np.repeat(each, times, axis=0), counts + 2


def _flow(item: Dwelt | Put | Barred | Stood, stand: Array, ways: list[Array], axis_units: Array) -> Array:
    """Return the robot's position after an item of the text that is not a sequence of moves.

    Only the start of a second branch changes the position: it begins where the first branch began. A slow
    RAPID states the position.

    Args:
        item: the item of the course.
        stand: (n,) position before the item [rad or m].
        ways: positions at the start of the open WHENs; updated.
        axis_units: (n,) axis unit of each joint in SI units.
    """
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
    """Return the first step in the map that isn't the program's, with the difference; None if all agree."""
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
            return step, f"the map blends a command that must end at rest (line {entry.at})"
    if len(entries) != len(program.steps):
        return None, f"the map has {len(entries)} commands, the program {len(program.steps)}"
    return None


def _spans(
    moving: list[Entry], lines: list[NDArray[np.int64]]
) -> dict[int, tuple[int, int]] | tuple[int, str]:
    """Return the range of segments of each step with moves, or a step with wrong lines and the reason.

    There is one segment for each move line, and two more at the end of a sequence.
    """
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
            # The command's move lines reach up to `last` in this sequence.
            stop = int(np.searchsorted(run, entry.last or 0, side="right"))
            if entry.first != run[place] or stop <= place or run[stop - 1] != entry.last:
                return step, (
                    f"the map gives this command the lines {entry.first} to {entry.last}, but its moves "
                    f"begin in line {run[place]} and the sequence has moves up to line {run[-1]}"
                )
            # The two segments with no move line of their own lead to the three equal points at the sequence's
            # end.
            size = stop - place + (2 if stop == len(run) else 0)
            spans[entry.step] = segment, segment + size
            segment, place = segment + size, stop
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
    """Return the step of the first blend that has no middle, doesn't fit into its sequence, or covers an
    action at rest, with the reason.

    None if all blends fit.
    """
    last_lines = {int(run[-1]) for run in lines}
    before = 0
    for place, entry in enumerate(moving):
        blend = entry.blend or 0
        size = spans[entry.step][1] - spans[entry.step][0]
        if blend % 2:
            return entry.step, f"the blend has {blend} segments, which have no middle (line {entry.at})"
        # Half of the segments of either blend lie in this command.
        if (before + blend) // 2 > size:
            return entry.step, (
                f"the command has {size} segments, and {before // 2} and {blend // 2} of them would lie in "
                f"blends (line {entry.at})"
            )
        before = blend
        if entry.blend is None:
            continue
        if entry.last in last_lines:
            return entry.step, f"the sequence ends where it must flow into the next one (line {entry.at})"
        between = program.steps[entry.step + 1 : moving[place + 1].step]
        if not all(isinstance(step, hir.SetOutput) for step in between):
            return entry.step, f"the map blends across an action that is done at rest (line {entry.at})"
    return None


def _with_places(
    segments: Layout,
    entries: tuple[Entry, ...],
    program: hir.Program,
    spans: dict[int, tuple[int, int]],
    start: Array,
) -> Layout:
    places, begins, ends = [], [], []
    stand, reached = start, 0
    closing = _closing(segments, [last for first, last in spans.values() if last > first])
    before: int | None = None
    standing = Standing(start)
    for entry, step in zip(entries, program.steps, strict=True):
        if not isinstance(step, hir.Motion):
            kind = BARRIERS.get(type(step))
            if kind is not None:
                standing.at = stand
                with suppress(ValueError):  # the check of the text's flow reports it
                    standing.pass_(kind)
                stand = standing.at
            continue
        first, last = spans.get(entry.step, (reached, reached))
        begins.append(stand)
        if last == first:
            places.append(Place(entry.step, step, first, last, None))
        else:
            assert entry.first is not None and entry.last is not None  # noqa: PT018 - since it has a span
            lines = (entry.first, entry.last)
            places.append(Place(entry.step, step, first, last, lines, before, entry.blend, entry.any_jerk))
            stand = closing[last]
            before, reached = entry.blend, last
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
    """Return the places with `beside_any_jerk` set from their neighbours in the chain."""
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
    """Return, for each index in `stops`, the position (n,) at the end of the segment before it."""
    at = segments.at[np.array(stops, dtype=np.int64) - 1]
    first, middle, last = (segments.control[at + i] for i in (1, 2, 3))
    # If the command ends at rest, its end is the control point itself, which is exact. Otherwise it is the
    # knot.
    rests = (first == last).all(axis=1)[:, None]
    return dict(zip(stops, np.where(rests, last, (first + 4.0 * middle + last) / 6.0), strict=True))


def moving_at_ends(layout: Layout) -> list[Place]:
    """Return the commands that should end at rest but don't: their last three control points differ."""
    if not (moving := [place for place in layout.places if place.size and place.behind is None]):
        return []
    # Three equal control points are a full stop.
    last = layout.at[np.array([place.last for place in moving]) - 1] + 3
    control = layout.control
    rest = (control[last] == control[last - 1]) & (control[last] == control[last - 2])
    return [place for place, still in zip(moving, rest.all(axis=1), strict=True) if not still]


def chunks(places: list[Place]) -> Iterator[list[Place]]:
    """Yield groups of neighbouring commands with up to about `CHUNK` segments."""
    for rows in row_chunks(list(enumerate(places))):
        yield [place for _, place in rows]


def row_chunks(rows: list[tuple[int, Place]]) -> Iterator[list[tuple[int, Place]]]:
    """Yield groups of neighbouring commands, each with its row, with up to about `CHUNK` segments."""
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
