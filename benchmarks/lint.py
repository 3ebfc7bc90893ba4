"""Measure checks for RESULTS.md: `python benchmarks/lint.py`, in an environment with yarclang[dev].

The figures are those of `yarc check` of a long file, of `yarc check` of many files, and of `yarc fmt`, each
as a whole process.
"""

from __future__ import annotations

import argparse
import shutil
import statistics
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from measure import Process, by_turns, process

LINES = 10_000
FILES = 100
GOAL = 2.0
"""Longest time for LINES lines without planning [s]."""
YARC = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()")


def long_program(count: int) -> str:
    """Return a program of `count` different lines: joint motions, lines, waits and increments in turn."""
    rows = ["ROBOT INDUSTRIAL6", "DEFAULT {TCP} [2] (mm,deg,s) {B}"]
    for n in range(count - len(rows)):
        kinds = (
            f"MOVEJ {n % 60} {n / 1e3:.3f} 0 0 {-n % 70} 0",
            f"MOVEL {n % 90} {1000 + n / 100:.2f} 1100 0 {n % 7} 0 [1.5] ! to the part",
            f"WAIT [{1 + n % 5}]",
            f"DMOVE 0 0 {n % 50 + 1} 0 0 0 [1] {{TCP}}",
        )
        rows.append(f"P{n + 1:05} {kinds[n % 4]}")
    return "\n".join([*rows, ""])


def short_program(number: int) -> str:
    """Return a program of ten straight lines that differ from file to file."""
    rows = ["ROBOT INDUSTRIAL6", "DEFAULT {TCP} [50%] (mm,deg,s) {B}", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0"]
    rows += [
        f"P{20 + 10 * n:04} MOVEL {(number + 17 * n) % 200} 1100 {1100 + 13 * (n % 5)} 0 {n % 4 + 1} 0"
        for n in range(9)
    ]
    return "\n".join([*rows, ""])


def main() -> None:
    """Measure everything, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="yarclang-lint-"))
    try:
        long, many = folder / "long.yarc", folder / "many"
        many.mkdir()
        long.write_text(long_program(LINES))
        for number in range(FILES):
            (many / f"p{number:03}.yarc").write_text(short_program(number))
        tasks: dict[str, Callable[[], Process]] = {
            f"`yarc check --no-plan`, {LINES:,} lines": lambda: process(
                *YARC, "check", "--no-plan", str(long)
            ),
            f"`yarc fmt`, {LINES:,} lines": lambda: process(*YARC, "fmt", str(long)),
            f"`yarc check --no-plan`, {FILES} files": lambda: process(*YARC, "check", "--no-plan", str(many)),
            f"`yarc check`, {FILES} files of 10 motions, planned and proved": lambda: process(
                *YARC, "check", str(many)
            ),
        }
        print("| what | time | on a core | memory | goal |\n|---|---|---|---|---|")
        for number, (name, runs) in enumerate(by_turns(tasks, options.rounds).items()):
            wall, core, peak = (
                statistics.median(getattr(run, key) for run in runs) for key in ("seconds", "cpu", "peak")
            )
            goal = f"under {GOAL:g} s" if number == 0 else ""
            print(f"| {name} | {wall:.2f} s | {core:.2f} s | {peak:.0f} MB | {goal} |")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
