"""What a text does between its motions: dwells, outputs, waits and ways must be the program's, each in its place and at rest.

Only an output behind a motion that flows into the next one is set while the robot moves: in the middle of the blend.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang import hir
from yarclang.certify.text import Barred, ControllerText, Dwelt, Entry, Put, Run, Stood
from yarclang.robot.model import Array
from yarclang.units import MS

Deed = tuple[object, ...]
Fault = tuple[int | None, str]
"""The step of the program that it is about, if one is known, and what is wrong."""

SEGMENTS_OFF = 1
"""An output in the middle of a blend is set at most this many segments before or behind it."""
_SAME_TIME = 1e-6


def check_flow(
    text: ControllerText, program: hir.Program, start: Array, axis_units: Array
) -> Iterator[Fault]:
    """Compare what the text does with what the program says, in order; the first difference is told.

    Args:
        text: what was read.
        program: what the robot shall do.
        start: (n,) where the text starts [rad or m].
        axis_units: (n,), the axis unit of each joint in SI.
    """
    meant = {output.signal.variable: output.safe for output in program.outputs if output.safe is not None}
    if dict(text.outputs) != meant:
        yield None, "the safe values of the outputs aren't the program's"
    yield from check_places(text)
    yield from _stands_elsewhere(text, start / axis_units)
    told = list(_told(text))
    for place, (step, deed) in enumerate(
        _meant(program, {entry.step for entry in text.entries if entry.first})
    ):
        found = told[place] if place < len(told) else None
        if found is None or not _same(found, deed):
            yield step, f"the text does {_words(found)} where the program says {_words(deed)}"
            return
    extra = len(list(_meant(program, {entry.step for entry in text.entries if entry.first})))
    if len(told) > extra:
        yield None, f"the text does {_words(told[extra])} behind the program's end"


def check_places(text: ControllerText) -> Iterator[Fault]:
    """What can be told without the program: outputs and barriers where the robot rests, or in the middle of a blend."""
    yield from _not_at_rest(text)
    yield from _not_in_the_middle(text)


def _meant(program: hir.Program, moving: set[int]) -> Iterator[tuple[int, Deed]]:
    """What the program does, step by step; motions that don't move have no lines."""
    for number, step in enumerate(program.steps):
        if number in moving:
            yield number, ("move", number)
            continue
        match step:
            case hir.Stop():
                return
            case hir.Dwell(duration=duration):
                yield number, ("dwell", duration / MS)
            case hir.SetOutput(output=output, value=value):
                yield number, ("set", output.variable, value)
            case hir.WaitInput(input=signal, value=value, timeout=timeout):
                yield number, ("wait", number, signal.variable, value, timeout)
            case hir.When(input=signal, value=value):
                yield number, ("when", number, signal.variable, value, None)
            case hir.Hold():
                yield number, ("hold", number)
            case hir.Else():
                yield number, ("else", number)
            case hir.EndWhen():
                yield number, ("end", number)


def _told(text: ControllerText) -> Iterator[Deed]:
    """What the text does, in order."""
    moving = iter([entry for entry in text.entries if entry.first is not None])
    entry = next(moving, None)
    for item in text.course:
        match item:
            case Run():
                puts = list(item.puts)
                while entry is not None and (entry.first or 0) <= int(item.lines[-1]):
                    yield ("move", entry.step)
                    # those nearer to this command's end than to that of the next one
                    while puts and _behind(item, puts[0], entry) <= SEGMENTS_OFF:
                        put = puts.pop(0)
                        yield ("set", put.variable, put.value)
                    entry = next(moving, None)
                for put in puts:
                    yield ("set", put.variable, put.value)
            case Dwelt(milliseconds=milliseconds) if milliseconds > 0.0:
                yield ("dwell", milliseconds)
            case Put(variable=variable, value=value):
                yield ("set", variable, value)
            case Barred(kind="wait" | "when", condition=condition):
                name, _, wanted = condition.partition("=")
                yield (item.kind, item.step, name, float(wanted), item.timeout)
            case Barred():
                yield (item.kind, item.step)


def _behind(run: Run, put: Put, entry: Entry) -> int:
    """How many segments behind the command's end an output is set: a move line begins the segment of its number in the sequence."""
    return int(
        np.searchsorted(run.lines, put.line) - np.searchsorted(run.lines, entry.last or 0, side="right")
    )


def _not_in_the_middle(text: ControllerText) -> Iterator[Fault]:
    """An output that is set in step with a move, elsewhere than in the middle of a blend."""
    for run in text.runs:
        if not run.puts:
            continue
        blended = [
            entry
            for entry in text.entries
            if entry.blend is not None and run.lines[0] <= (entry.last or 0) <= run.lines[-1]
        ]
        for put in run.puts:
            if not blended:
                yield (
                    None,
                    f"line {put.line} sets {put.variable} while the robot moves, and no blend is there",
                )
                continue
            off = min((_behind(run, put, entry) for entry in blended), key=abs)
            if abs(off) > SEGMENTS_OFF:
                there = f"{abs(off)} segments {'behind' if off > 0 else 'before'} the middle of the blend"
                yield None, f"line {put.line} sets {put.variable} {there}"


def _same(found: Deed, deed: Deed) -> bool:
    if found == deed:
        return True
    if len(found) != len(deed):
        return False
    return all(
        abs(a - b) <= _SAME_TIME * max(1.0, abs(b))
        if isinstance(a, float) and isinstance(b, float)
        else a == b
        for a, b in zip(found, deed, strict=True)
    )


def _words(deed: Deed | None) -> str:
    return "nothing" if deed is None else " ".join(str(part) for part in deed if part is not None)


def _not_at_rest(text: ControllerText) -> Iterator[Fault]:
    """An output or a barrier right behind moves would come before they have ended."""
    before: object = None
    for item in text.course:
        if isinstance(item, Put | Barred) and isinstance(before, Run):
            yield None, f"line {item.line} comes while the robot moves: no DWELL stands before it"
        before = item


def _stands_elsewhere(text: ControllerText, start: Array) -> Iterator[Fault]:
    """A slow RAPID must lead to where the robot stands already, and the ways of a WHEN must meet."""
    slack = 10.0**-text.decimals * (1.0 + 1e-6)
    stand = start
    before: list[Array] = []
    ends: list[Array | None] = []
    for item in text.course:
        match item:
            case Run(points=points):
                stand = points[-1]
            case Stood(line=line, point=point):
                if np.abs(point - stand).max() > slack:
                    yield None, f"line {line + 2} leads away from where the robot stands"
                stand = point
            case Barred(kind="when"):
                before.append(stand)
                ends.append(None)
            case Barred(kind="else", line=line):
                if not before:
                    yield None, f"line {line}: a second way without a first"
                    return
                ends[-1], stand = stand, before[-1]
            case Barred(kind="end", line=line):
                if not before:
                    yield None, f"line {line}: ways end that didn't begin"
                    return
                first, other = before.pop(), ends.pop()
                if np.abs(stand - (first if other is None else other)).max() > slack:
                    yield None, f"the ways that meet in line {line} end apart"
    if before:
        yield None, "a way of a WHEN has no end"
