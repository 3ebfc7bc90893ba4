"""The report of a campaign, as text and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from yarclang.campaign.judging import Program, Task
from yarclang.campaign.pieces import Piece

_WORST = {
    "path": "of the tolerance, distance from the path",
    "table": "of the tolerance, distance from a timetable",
    "position": "of the range of a joint",
    "velocity": "of what a joint's velocity may be",
    "acceleration": "of what a joint's acceleration may be",
    "jerk": "of what a joint's jerk may be",
    "motor": "of what a motor's velocity may be",
}
_SHOWN = 20
"""Number of faulty programs that the text shows."""


def summed(pieces: Sequence[Piece], first: int) -> Piece:
    """Return the sum of all pieces. Its first seed is that of the campaign."""
    whole = Piece(first, 0)
    for piece in pieces:
        whole.merge(piece)
    return whole


def as_data(whole: Piece, task: Task) -> dict[str, Any]:
    """Return the results of a campaign as data for JSON. Everything except `processor_seconds` is the same on
    each machine and in each repetition.
    """
    return {
        "robots": list(task.robots),
        "cell": task.cell,
        "seed": whole.first,
        "programs": whole.count,
        "compiled": whole.compiled,
        "refused": dict(_by_number(whole.refused)),
        "motions": {
            name: {"drawn": number, "compiled": whole.motions.get(name, 0)}
            for name, number in _by_number(whole.drawn)
        },
        "motion_seconds": whole.microseconds / 1e6,
        "worst": {
            name: {"share": whole.worst[name].share, "seed": whole.worst[name].seed}
            for name in _WORST
            if name in whole.worst
        },
        "found": whole.found,
        "finds": [{"seed": one.seed, "robot": one.robot, "faults": list(one.faults)} for one in whole.finds],
        "processor_seconds": round(whole.seconds, 3),
    }


def as_text(whole: Piece, task: Task) -> Iterator[str]:
    """Yield the lines of the report."""
    around = f", in {task.cell}" if task.cell is not None else ""
    last = whole.first + whole.count - 1
    yield (
        f"{whole.count:,} programs of seeds {whole.first:,} to {last:,}, for {', '.join(task.robots)}{around}"
    )
    motions = whole.motions.get("motions", 0)
    yield (
        f"  {whole.compiled:,} compile: {motions:,} motions, which take {_duration(whole.microseconds / 1e6)}"
    )
    if refused := sum(whole.refused.values()):
        codes = ", ".join(f"{code} {number:,}" for code, number in _by_number(whole.refused))
        yield f"  {refused:,} are refused: {codes}"
    if whole.drawn:
        yield "motions that are in programs that compile, of those drawn:"
        parts = [
            f"{name} {whole.motions.get(name, 0):,} of {number:,}"
            for name, number in _by_number(whole.drawn)
            if name != "motions"
        ]
        yield from (f"  {', '.join(parts[place : place + 4])}" for place in range(0, len(parts), 4))
    if whole.worst:
        yield "the largest shares:"
        for name, words in _WORST.items():
            if (worst := whole.worst.get(name)) is not None:
                yield f"  {worst.share:.6f} {words}: seed {worst.seed}"
    if not whole.found:
        yield "no faults were found"
        return
    yield f"{whole.found:,} program{'' if whole.found == 1 else 's'} with something wrong:"
    for one in whole.finds[:_SHOWN]:
        yield f"  seed {one.seed}, {one.robot}: {one.faults[0]}"
    if whole.found > _SHOWN:
        yield f"  and {whole.found - _SHOWN:,} more: --format json lists up to {len(whole.finds):,}"
    yield (
        f"`yarc campaign --again {whole.finds[0].seed}`, with the same --robot and --cell, shows the "
        "first one"
    )


def program_text(one: Program) -> Iterator[str]:
    """Yield the lines of the report on one program: comments, and its text."""
    yield f"! seed {one.seed}, {one.robot}"
    if one.refused:
        yield f"! refused: {one.refused}"
    elif one.worst:
        yield f"! compiles: {_duration(one.duration)}"
    for name, words in _WORST.items():
        if name in one.worst:
            yield f"! {one.worst[name]:.6f} {words}"
    for fault in one.faults:
        yield f"! WRONG: {' '.join(fault.split())}"
    yield one.text.rstrip("\n")


def program_data(one: Program) -> dict[str, Any]:
    """Return the result of one program as data for JSON."""
    return {
        "seed": one.seed,
        "robot": one.robot,
        "refused": one.refused or None,
        "faults": list(one.faults),
        "worst": one.worst,
        "motion_seconds": one.duration,
        "text": one.text,
    }


def _by_number(counts: dict[str, int]) -> list[tuple[str, int]]:
    """Return names and numbers, sorted by number, the largest first."""
    return sorted(counts.items(), key=lambda one: (-one[1], one[0]))


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.1f} min"
    return f"{seconds / 3600.0:.1f} h"
