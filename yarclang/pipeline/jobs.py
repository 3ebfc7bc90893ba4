"""Certified controller text to a job that the runtime streams; a robot's settings to what the runtime looks at."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from yarclang.backend_pmac.settings import settings_text
from yarclang.certify.read import ControllerText, Entry, Run, Unreadable, read
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import Array
from yarclang.pmac.variables import ARMED
from yarclang.robot.model import Robot
from yarclang.runtime.inspection import Item
from yarclang.runtime.job import Job, JobCommand
from yarclang.source import SourceFile
from yarclang.units import MS

START_SHARE = 0.05
"""A start that is off adds at most this share of the acceleration limit in the first segment."""

_SHORTEST_BUFFER = 1.0
"""What a rotary holds at least [s]."""

_OPENED = ("OPEN ROT", "CLEAR")


@dataclass(frozen=True, slots=True)
class Papers:
    """What goes with a job into its log: the program's text and the certificate as JSON."""

    source: str = ""
    certificate: str = ""


NO_PAPERS = Papers()


def job_of_text(
    text: str, robot: Robot, name: str, papers: Papers = NO_PAPERS, offset: float = 0.0
) -> Result[Job]:
    """Read a rotary program that yarcc has written.

    Args:
        text: the whole text.
        robot: whom it is for; its fingerprint must be that in the header.
        name: what people call the program.
        papers: what goes with it.
        offset: where it begins in the program that it is a part of [s].

    Returns:
        None, with a finding, where the text isn't what yarcc writes for this robot and for a rotary buffer.
    """
    source = SourceFile(name, text)
    content = read(text, robot.controller)
    if isinstance(content, Unreadable):
        return _refused(content.code, f"line {content.line} {content.reason}", source)
    if content.target != "rotary":
        help_ = "compile it without --target prog; a program buffer is downloaded and run by hand"
        return _refused("Y1162", "this text is for a program buffer, which isn't streamed", source, help_)
    if found := re.search(r"^; robot (\S+) ([0-9a-f]{64})$", text, re.MULTILINE):
        if found[2] != robot.fingerprint:
            message = f"the text was made for {found[1]} as it was then: another geometry, limits or settings than {robot.name} has now"
            return _refused("Y1163", message, source, "compile the program again")
    else:
        return _refused("Y1163", "the header doesn't say for which robot the text was made", source)
    return Result(_job(content, text, robot, name, papers, offset))


def _refused(code: str, message: str, source: SourceFile, help_: str = "") -> Result[Job]:
    return Result(None, (Diagnostic(code, message, source, help=help_),))


def _job(content: ControllerText, text: str, robot: Robot, name: str, papers: Papers, offset: float) -> Job:
    numbered = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line and not line.startswith(";")
    ]
    at = next(place for place, (_, line) in enumerate(numbered) if line == _OPENED[0])
    setup = tuple(line for _, line in numbered[:at])
    loaded = numbered[at + len(_OPENED) : -1]
    begins, duration = _times(content.runs)
    first = min(begins.values(), default=0.0)
    times, following = np.empty(len(loaded)), duration
    for row in range(len(loaded) - 1, -1, -1):
        following = begins.get(loaded[row][0], following)
        times[row] = following
    times[: next((row for row, (number, _) in enumerate(loaded) if number in begins), len(loaded))] = min(
        first, 0.0
    )
    segments = [run.segment_ms * MS for run in content.runs]
    start = content.start.rapid
    assert start is not None  # a rotary has one
    end = content.runs[-1].points[-1] if content.runs else start
    slack = (
        START_SHARE
        * robot.limits.acceleration
        * (segments[0] if segments else robot.controller.largest_segment) ** 2
    )
    lines = tuple(line for _, line in loaded)
    return Job(
        name=name,
        robot=robot,
        setup=setup,
        lines=lines,
        times=_read_only(times),
        commands=_commands(content),
        start=_read_only(start * robot.axis_units),
        end=_read_only(end * robot.axis_units),
        slack=_read_only(slack),
        segment=min(segments, default=robot.controller.largest_segment),
        duration=duration,
        words=_number_behind("DEFINE ROT ", setup, robot.controller.rotary_words),
        low=_number_behind("I16=", setup, 5),
        full=_number_behind("I17=", setup, 10),
        guarded=f"{ARMED}=1" in lines,
        text=text,
        source=papers.source,
        certificate=papers.certificate,
        offset=offset,
    )


def _times(runs: tuple[Run, ...]) -> tuple[dict[int, float], float]:
    """When the motion towards each move line's point begins [s], by the line's number; the duration of all.

    A sequence begins and ends with a segment of its own (TUM 289).
    """
    begins: dict[int, float] = {}
    now = 0.0
    for run in runs:
        segment = run.segment_ms * MS
        begins |= {int(line): now + row * segment for row, line in enumerate(run.lines, 1)}
        now += (len(run.lines) + 2) * segment
    return begins, now


def _commands(content: ControllerText) -> tuple[JobCommand, ...]:
    """The motions with their times."""
    commands: list[JobCommand] = []
    moving = iter([entry for entry in content.entries if entry.first is not None])
    now = 0.0
    for run in content.runs:
        segment, place = run.segment_ms * MS, 0
        while place < len(run.lines):
            entry: Entry = next(moving)
            behind = int(np.searchsorted(run.lines, entry.last or 0, side="right"))
            size = behind - place + (2 if behind == len(run.lines) else 0)
            commands.append(JobCommand(entry.index, entry.name, entry.source_line, now, now + size * segment))
            now, place = now + size * segment, behind
    return tuple(commands)


def _number_behind(word: str, lines: tuple[str, ...], otherwise: int) -> int:
    return next((int(line[len(word) :]) for line in lines if line.startswith(word)), otherwise)


def _read_only(values: Array) -> Array:
    values = np.array(values, dtype=np.float64)
    values.setflags(write=False)
    return values


def items_of(robot: Robot) -> tuple[Item, ...]:
    """What a controller must have been told about a robot: each line of `yarc settings` that stays, as a question."""
    remedy = f"download `yarc settings {robot.name}` and SAVE"
    items: list[Item] = []
    listing: list[str] = []
    plc = ""
    for full in settings_text(robot).splitlines():
        line, _, remark = full.partition(";")
        line, remark = line.strip(), remark.strip()
        if found := re.fullmatch(r"OPEN (PLC \d+) CLEAR", line):
            plc, listing = found[1], []
        elif plc and line == "CLOSE":
            items.append(Item(f"{plc}", f"LIST {plc}", "\n".join(listing), "listing", remedy))
            plc = ""
        elif plc:
            listing.append(line)
        elif found := re.fullmatch(r"(I\d+)=(\S+)", line):
            if found[1] not in _SET_BY_PROGRAMS:
                kind = "bits" if found[1] == "I5" else "number"
                items.append(Item(f"{found[1]}, {remark}", found[1], found[2], kind, remedy))  # type: ignore[arg-type]
        elif found := re.fullmatch(r"(#(\d+)->)(\S+)", line):
            items.append(
                Item(f"axis definition of motor {found[2]}", found[1], found[3], "definition", remedy)
            )
        elif found := re.fullmatch(r"(M\d+->)(\S+)", line):
            items.append(Item(f"address of {found[1][:-2]}", found[1], found[2], "address", remedy))
    return tuple(items)


_SET_BY_PROGRAMS = ("I16", "I17")
