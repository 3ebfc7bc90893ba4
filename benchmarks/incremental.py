"""Measure edits for RESULTS.md: `python benchmarks/incremental.py`, in an environment with yarclang[dev].

One analyst checks a program of straight lines again and again; each time, one number of one line has changed.
As in the language server, garbage collection is rare.
"""

from __future__ import annotations

import argparse
import gc
import resource
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import programs
from lint import long_program

from yarclang.lsp.serving import SELDOM
from yarclang.pipeline.incremental import Analyst
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

COMMANDS = 1000
LINES = 10_000
HERE = Path(__file__).parent


def edited(lines: list[str], at: int, by: float) -> SourceFile:
    """Return the program after a change of the first number of a line. Later edits include this change."""
    words = lines[at].split()
    words[2] = f"{float(words[2]) + by:.3f}"
    lines[at] = " ".join(words)
    return SourceFile("lines.yarc", "\n".join(lines))


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Return the duration of a function [ms]: by the clock, and on a core."""
    wall, core = time.perf_counter(), time.process_time()
    work()
    return (time.perf_counter() - wall) * 1e3, (time.process_time() - core) * 1e3


def row(what: str, found: list[tuple[float, float]], goal: str) -> str:
    """Return a row of the table: medians, and the longest."""
    wall, core = (statistics.median(times) for times in zip(*found, strict=True))
    return f"| {what} | {wall:.1f} ms | {core:.1f} ms | {max(one for one, _ in found):.1f} ms | {goal} |"


def main() -> None:
    """Measure everything, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--edits", type=int, default=15, help="of each kind")
    parser.add_argument("--commands", type=int, default=COMMANDS)
    options = parser.parse_args()
    gc.set_threshold(*SELDOM)
    lines = programs.lines(options.commands).split("\n")
    analyst, count = Analyst(), options.commands
    print("| what | time | on a core | longest | goal |\n|---|---|---|---|---|", flush=True)
    whole = SourceFile("lines.yarc", "\n".join(lines))
    cold = timed(lambda: analyst.analyse(whole, HERE))
    print(row(f"{count:,} lines looked at first, planned and proved", [cold], ""), flush=True)
    last, anywhere = [], []
    for number in range(options.edits):
        at = 3 + int(count * (0.9 + 0.1 * number / options.edits))
        source = edited(lines, at, 0.1)
        last.append(timed(lambda source=source: analyst.analyse(source, HERE)))
    goal = "under 100 ms"
    print(row("a change in the last tenth, planned and proved", last, goal), flush=True)
    for number in range(options.edits):
        source = edited(lines, 3 + count * number // options.edits, 0.1)
        anywhere.append(timed(lambda source=source: analyst.analyse(source, HERE, quick=True)))
    print(row("a change anywhere, syntax and names", anywhere, "under 20 ms"), flush=True)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(1000 - 2 * options.edits):
        analyst.analyse(edited(lines, 3 + count // 2, 0.001), HERE, quick=True)
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    print(f"| 1,000 edits | {len(analyst.memory):,} results kept, {grown:.0f} MB more | | | nothing grows |")
    long = long_program(LINES).split("\n")
    parse(SourceFile("long.yarc", "\n".join(long)))
    parsed = []
    for number in range(options.edits):
        long[4 + 4 * number] += " ! changed"
        source = SourceFile("long.yarc", "\n".join(long))
        parsed.append(timed(lambda source=source: parse(source)))
    print(row(f"a change in {LINES:,} lines, syntax", parsed, "under 50 ms"))


if __name__ == "__main__":
    main()
