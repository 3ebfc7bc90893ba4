"""Convert a certified controller text to a job, which the runtime streams."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from yarclang.backend import backend_of
from yarclang.certify.certificate import Certificate
from yarclang.certify.read.text import Barred, ControllerText, Dwelt, Entry, Put, Run, Stood, assignments_of
from yarclang.decisions import Searched, Shifted
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.lasting import Schedule
from yarclang.pipeline.stages import Compiled
from yarclang.robot.model import START_SHARE, Robot
from yarclang.runtime.job import NO_PAPERS, Barrier, Job, JobCommand, Leg, Papers
from yarclang.source import SourceFile
from yarclang.units import MS


def job_of(
    certificate: Certificate,
    text: str,
    robot: Robot,
    name: str,
    papers: Papers = NO_PAPERS,
    offset: float = 0.0,
    clock: float = 0.0,
) -> Result[Job]:
    """Create a job (a program to be streamed to the controller) from a verified controller text. Its lines
    are exactly those that the judge has read.

    Args:
        certificate: certificate without an error.
        text: complete text, for the log.
        robot: robot that the text is for.
        name: name of the program for people.
        papers: documents that are stored with the job.
        offset: program time at which the job begins, if it is a part of a program [s].
        clock: latest program time at which the job begins, without waits of unknown length [s].

    Returns:
        None, with a finding, if the text isn't for streaming.
    """
    content = certificate.text
    problem = backend_of(robot).sendable(content, robot)
    if isinstance(problem, Diagnostic):
        return Result(None, (replace(problem, source=SourceFile(name, text)),))
    schedule, loaded = content.schedule, problem.lines
    assert content.start.printed is not None
    start = content.start.printed
    common = Job(
        name=name,
        robot=robot,
        lines=(),
        times=np.empty(0),
        commands=(),
        start=start,
        end=start,
        slack=start,
        segment=robot.controller.largest_segment,
        duration=0.0,
        capacity=problem.capacity,
        guarded=False,
        text=text,
        source=papers.source,
        certificate=papers.certificate,
        outputs=content.outputs,
        own=problem.own,
        registers=content.registers,
        watches=content.watches,
        searches=content.searches,
    )
    dwells = {
        item.line: item.milliseconds * MS
        for item in content.course
        if isinstance(item, Dwelt) and item.milliseconds > 0.0
    }
    sets = {line: (variable, value) for line, variable, value in assignments_of(content) if line is not None}
    entries = {entry.step: entry for entry in content.entries}
    searches = {entries[one.step].first or 0: one for one in content.searches}
    making = _Making(
        common,
        _begins(content, schedule),
        _commands(content, schedule),
        problem.guarded,
        sets,
        dwells,
        searches,
    )
    whole = making.part(loaded, content.runs, start, 0.0, schedule.places[-1])
    whole = replace(whole, search=None, end=_read_only(_end_of(content, start) * robot.axis_units))
    legs = tuple(_legs(making, content, schedule, loaded, start)) if _has_barriers(content) else ()
    return Result(replace(whole, legs=legs, offset=offset, clock=clock, lasting=schedule.lasting))


def _end_of(content: ControllerText, start: Array) -> Array:
    """Return the joint position (n,) [axis units] after the last line of a controller text. If the text ends
    with branches that meet, this is the target of the RAPID line after the branches.
    """
    for item in reversed(content.course):
        match item:
            case Run(points=points):
                return np.asarray(points[-1])
            case Stood(point=point):
                return point
    return start


def in_pieces(content: dict[str, Any]) -> str:
    """Return content as JSON. Each item of a list is encoded by a separate call of the encoder.

    A single call for all items of a program with 400 commands would block the interpreter's other threads for
    0.1 s.
    """
    written = []
    for key, value in content.items():
        text = f"[{', '.join(map(json.dumps, value))}]" if isinstance(value, list) else json.dumps(value)
        written.append(f"{json.dumps(key)}: {text}")
    return f"{{{', '.join(written)}}}"


def job_of_compiled(
    compiled: Compiled, name: str, source: str | None = None, offset: float = 0.0, clock: float = 0.0
) -> Job:
    """Create a job from a compiled program. A program for a controller's program buffer can't become a job.

    Args:
        compiled: the program.
        name: name of the program for people.
        source: program text for the job's log; None: the program's own text.
        offset: program time at which the job begins, if it is a part of a program [s].
        clock: latest program time at which the job begins, without waits of unknown length [s].
    """
    text = compiled.program.source.text if source is None else source
    papers = Papers(text, in_pieces(compiled.certificate.to_json()))
    made = job_of(compiled.certificate, compiled.text, compiled.plan.robot, name, papers, offset, clock)
    assert made.value is not None, made.diagnostics
    return made.value


def _has_barriers(content: ControllerText) -> bool:
    return any(isinstance(item, Barred) for item in content.course)


@frozen
class _Making:
    """Facts about the lines of a controller text, from which jobs are made for groups of lines.

    Attributes:
        begins: time at which the motion of a move line, or a dwell, begins [s], by line.
        commands: the program's commands with their times.
        arms: lines that arm the guard.
        sets: variables that lines set, by line.
        dwells: durations of dwells [s], by line.
    """

    common: Job
    begins: dict[int, float]
    commands: tuple[JobCommand, ...]
    arms: tuple[int, ...]
    sets: dict[int, tuple[str, float]]
    dwells: dict[int, float]
    searches: dict[int, Searched]
    """Search motions, by the number of their first line."""

    def part(
        self,
        loaded: Sequence[tuple[int, str]],
        runs: tuple[Run, ...],
        start: Array,
        begin: float,
        end: float,
    ) -> Job:
        """Return the job that streams a group of lines.

        Args:
            loaded: lines with their numbers.
            runs: uninterrupted sequences of moves in these lines.
            start: (n,) position before these lines [axis units].
            begin: program time at which the lines begin [s].
            end: program time at which they end [s].
        """
        robot = self.common.robot
        # From the last line to the first: a line without a duration gets the time of the next line that has
        # one.
        times, following = np.empty(len(loaded)), end
        for row in range(len(loaded) - 1, -1, -1):
            following = self.begins.get(loaded[row][0], following)
            times[row] = following - begin
        moving = [row for row, (number, _) in enumerate(loaded) if number in self.begins]
        times[: moving[0] if moving else len(loaded)] = 0.0
        segments = [run.segment_ms * MS for run in runs]
        first = segments[0] if segments else robot.controller.largest_segment
        slack = START_SHARE * robot.limits.acceleration * first**2
        lines = tuple(line for _, line in loaded)
        stands = runs[-1].points[-1] if runs else start
        commands = tuple(
            replace(one, begins=one.begins - begin, ends=one.ends - begin, clock=one.clock - begin)
            for one in self.commands
            if begin - 1e-9 <= one.begins and one.ends <= end + 1e-9
        )
        return replace(
            self.common,
            lines=lines,
            times=_read_only(times),
            commands=commands,
            start=_read_only(start * robot.axis_units),
            end=_read_only(stands * robot.axis_units),
            slack=_read_only(slack),
            segment=min(segments, default=robot.controller.largest_segment),
            duration=end - begin,
            sets=tuple(
                (row, *self.sets[number]) for row, (number, _) in enumerate(loaded) if number in self.sets
            ),
            dwells=tuple(
                (row, self.dwells[number]) for row, (number, _) in enumerate(loaded) if number in self.dwells
            ),
            guarded=any(loaded[0][0] <= line <= loaded[-1][0] for line in self.arms) if loaded else False,
            offset=begin,
            search=next((self.searches[number] for number, _ in loaded if number in self.searches), None),
        )


def _legs(
    making: _Making,
    content: ControllerText,
    schedule: Schedule,
    loaded: Sequence[tuple[int, str]],
    start: Array,
) -> Iterator[Leg]:
    """Yield the legs of a controller text: the lines between two barriers (waits and branches). A STOP isn't
    sent; the streaming code stops by sending nothing more.
    """
    entries = {entry.step: entry for entry in content.entries}
    offsets = {one.step: one for one in content.offsets}
    first, runs, place, acts = 0, list[Run](), 0, False
    for number, item in enumerate((*content.course, None)):
        match item:
            case Run():
                runs.append(item)
            case Stood(point=point):
                start = point
            case Put() | Dwelt():
                acts = acts or isinstance(item, Put) or item.milliseconds > 0.0
            case Barred() | None:
                end = next(
                    (row for row, (line, _) in enumerate(loaded) if item and line == item.line),
                    len(loaded),
                )
                begins, ends = schedule.places[first], schedule.places[number]
                job = None
                if runs or acts:
                    job = making.part(loaded[place:end], tuple(runs), start, begins, ends)
                    clock = schedule.clocks[first]
                    behind = schedule.lasting.most - clock - (ends - begins)
                    job = replace(job, clock=clock, behind=behind)
                barrier = None if item is None else _barrier(item, entries[item.step], offsets.get(item.step))
                yield Leg(job, barrier, ends, schedule.clocks[number])
                place, first, runs, acts = end + 1, number + 1, [], False


def _barrier(item: Barred, entry: Entry, offset: Shifted | None) -> Barrier:
    variable, value = "", 0.0
    if item.kind == "wait" and item.decided is None:
        variable, _, wanted = item.condition.partition("=")
        value = float(wanted)
    return Barrier(
        item.kind,
        variable,
        value,
        item.timeout,
        item.name,
        entry.index,
        entry.source_line,
        item.decided,
        item.again,
        item.register,
        entry.name,
        item.output,
        offset,
    )


def _begins(content: ControllerText, schedule: Schedule) -> dict[int, float]:
    """Return the time at which the motion of each move line begins, and the time at which each dwell begins
    [s], by the number of the line.
    """
    begins: dict[int, float] = {}
    for item, now in zip(content.course, schedule.places, strict=False):
        match item:
            case Run():
                # A sequence begins with an additional segment (TUM 289), so the first move line begins one
                # segment later.
                begins |= {int(line): now + row * item.segment for row, line in enumerate(item.lines, 1)}
            case Dwelt(line=line, milliseconds=milliseconds) if milliseconds > 0.0:
                begins[line] = now
    return begins


def _commands(content: ControllerText, schedule: Schedule) -> tuple[JobCommand, ...]:
    """Return the motions in a controller text with their times."""
    commands: list[JobCommand] = []
    moving = iter([entry for entry in content.entries if entry.first is not None])
    for run, begin, clock in zip(content.course, schedule.places, schedule.clocks, strict=False):
        if not isinstance(run, Run):
            continue
        now, place = begin, 0
        while place < len(run.lines):
            entry: Entry = next(moving)
            behind = int(np.searchsorted(run.lines, entry.last or 0, side="right"))
            ends = now + (behind - place + (2 if behind == len(run.lines) else 0)) * run.segment
            commands.append(
                JobCommand(entry.index, entry.name, entry.source_line, now, ends, clock + now - begin)
            )
            now, place = ends, behind
    return tuple(commands)


def _read_only(values: Array) -> Array:
    values = np.array(values, dtype=np.float64)
    values.setflags(write=False)
    return values
