"""Measure the language for RESULTS.md: `python benchmarks/language.py`, in an environment with yarclang[dev].

The parts are loops and calls that are expanded and checked, an edit of one line of a long file, and imports
of long files. Each is measured in a separate process; the memory is the peak of this process.
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

from measure import by_turns, process

COUNTS = (1_000, 10_000, 20_000, 50_000, 100_000)
GOAL = 20.0
"""Longest time for 100,000 commands [s]."""
LINES = 5_000
POINTS = 10_000

Figures = dict[str, float]


def main() -> None:
    """Measure everything, and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("child", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        name, *numbers = options.child
        print(json.dumps(CHILDREN[name](*map(int, numbers))))
        return
    unrolled(options.rounds)
    edited(options.rounds)
    imported(options.rounds)


def unrolled(rounds: int) -> None:
    """Measure time and memory of checks as the number of commands grows."""
    for name, what in (("loops", "joint motions in loops"), ("calls", "CALLs of a SUB of 5, with frames")):
        print(
            f"\n| {what} | parsed and checked | µs a command | memory | more than 1,000, bytes a "
            f"command | goal |"
        )
        print("|---|---|---|---|---|---|")
        found = by_turns({str(count): _child(name, count) for count in COUNTS}, rounds, warm=False)
        least = _median(found[str(COUNTS[0])], "peak")
        for count in COUNTS:
            runs = found[str(count)]
            seconds, peak = _median(runs, "seconds"), _median(runs, "peak")
            each = f"{(peak - least) * 2**20 / (count - COUNTS[0]):,.0f}" if count > COUNTS[0] else ""
            goal = f"under {GOAL:g} s" if count == COUNTS[-1] else ""
            print(
                f"| {count:,} | {seconds:.2f} s | {seconds / count * 1e6:.0f} | {peak:.0f} MB | {each} "
                f"| {goal} |"
            )


def edited(rounds: int) -> None:
    """Measure a second parse of a file after a change of one line."""
    found = by_turns({"edit": _child("edit", LINES)}, rounds, warm=False)["edit"]
    first = _median(found, "first")
    print(f"\n| a file of {LINES:,} different lines | time | of the first parse |\n|---|---|---|")
    for key, what in (("first", "first parse"), ("same", "again, unchanged"), ("edit", "one line changed")):
        seconds = _median(found, key)
        print(f"| {what} | {seconds * 1e3:.1f} ms | {seconds / first:.1%} |")


def imported(rounds: int) -> None:
    """Measure imports of files of other kinds."""
    print(f"\n| {POINTS:,} points of six joints | time |\n|---|---|")
    tasks = {kind: _child("convert", number) for number, kind in enumerate(CONVERTED)}
    for kind, runs in by_turns(tasks, rounds, warm=False).items():
        print(f"| {kind} | {_median(runs, 'seconds'):.2f} s |")


def _child(*arguments: object) -> Callable[[], Figures]:
    """Return a function that measures in a separate process. Its figures include the peak memory of this
    process [MB].
    """

    def run() -> Figures:
        ended = process(sys.executable, __file__, *map(str, arguments))
        return {**json.loads(ended.output), "peak": ended.peak}

    return run


def _median(runs: list[Figures], key: str) -> float:
    return statistics.median(run[key] for run in runs)


def loops(count: int) -> str:
    """Return `count` joint motions from two loops, with expressions."""
    rows = [
        "ROBOT INDUSTRIAL6",
        "DEFAULT [1] (mm,deg,s)",
        f"REPEAT I {count // 100}",
        "  REPEAT J 50",
        "    P0010 MOVEJ $(I % 20) $(J / 10) 0 0 30 0",
        "    P0020 MOVEJ $(I % 20) $(-J / 10) 0 0 -30 $(2*J)",
    ]
    return "\n".join([*rows, "  END", "END", ""])


def calls(count: int) -> str:
    """Return `count` commands in calls of a SUB, each with a frame of its own."""
    rows = [
        "ROBOT INDUSTRIAL6",
        "DEFAULT {TCP} [1] (mm,deg,s) {B}",
        "OUTPUT GRIP M1",
        "SUB PICK {AT} FAR (mm)",
        "  P0010 MOVEJ_RPY 0 0 $FAR 0 0 0 {AT}",
        "  P0020 MOVEL 0 0 0 0 0 0 {AT}",
        "  P0030 SET GRIP ON",
        "  P0040 WAIT [0.2]",
        "  P0050 MOVEL 0 0 $FAR 0 0 0 {AT}",
        "END",
        f"REPEAT I {count // 500}",
        "  REPEAT J 100",
        "    FRAME {HOLE} $(I % 10 * 20) $(1000 + J) 1000 0 0 0",
        "    P0060 CALL PICK {HOLE} 100",
    ]
    return "\n".join([*rows, "  END", "END", ""])


def _checked(text: str) -> int:
    """Parse and check a program; return the number of its executed commands."""
    from pathlib import Path

    from yarclang.pipeline import inputs, stages
    from yarclang.source import SourceFile

    opened = inputs.open_source(SourceFile("benchmark.yarc", text), Path.cwd(), inputs.Options()).value
    if opened is None:
        raise SystemExit("the program can't be opened")
    checked = stages.check_program(opened.module, opened.request)
    if checked.value is None or any(one.is_error for one in checked.diagnostics):
        raise SystemExit("\n".join(one.message for one in checked.diagnostics[:5]))
    return len(checked.value.steps)


def measure_check(make: Callable[[int], str], count: int) -> Figures:
    """Return the seconds to parse and check, without imports."""
    _checked(make(1_000))
    text = make(count)
    begun = time.perf_counter()
    steps = _checked(text)
    seconds = time.perf_counter() - begun
    if steps != count:
        raise SystemExit(f"{steps} commands instead of {count}")
    return {"seconds": seconds}


def measure_edit(count: int) -> Figures:
    """Return the seconds of the first parse, of a parse of the unchanged file, and of a parse after a change
    of one line (the median of several).
    """
    from yarclang.source import SourceFile
    from yarclang.syntax.parse import parse

    def timed(rows: list[str]) -> float:
        source = SourceFile("benchmark.yarc", "\n".join(rows))
        begun = time.perf_counter()
        if parse(source).diagnostics:
            raise SystemExit("the program has errors")
        return time.perf_counter() - begun

    timed(["P0001 MOVEJ 0 0 0 0 0 0 [1] (deg,s)"])  # the imports, and the parser's tables
    rows = [f"P{n:05} MOVEJ {n % 60} {n / 1e3:.3f} 0 0 {-n % 70} 0 [2] (deg,s)" for n in range(count)]
    first = timed(rows)
    same = statistics.median(timed(rows) for _ in range(9))
    edits: list[float] = []
    for number in range(9):
        rows[count // 2] = f"P{count // 2:05} MOVEJ 1 2 3 4 5 {number} [2] (deg,s)"
        edits.append(timed(rows))
    return {"first": first, "same": same, "edit": statistics.median(edits)}


def _wave(number: int) -> list[float]:
    return [30.0 * math.sin(7.0 * number / POINTS + joint) for joint in range(6)]


def _table() -> str:
    head = ",".join(f"j{joint} [deg]" for joint in range(1, 7))
    rows = (f"{n / 100:.2f}," + ",".join(f"{value:.6f}" for value in _wave(n)) for n in range(POINTS))
    return "\n".join([f"t [s],{head}", *rows, ""])


def _points() -> list[Any]:
    return [
        {
            "positions": [math.radians(value) for value in _wave(n)],
            "velocities": [0.0] * 6,
            "time_from_start": {"sec": n // 100, "nanosec": n % 100 * 10_000_000},
        }
        for n in range(POINTS)
    ]


def _json() -> str:
    return json.dumps({"joint_names": [f"J{joint}" for joint in range(1, 7)], "points": _points()})


def _yaml() -> str:
    import yaml

    return yaml.safe_dump(json.loads(_json()), default_flow_style=False)


CONVERTED: dict[str, tuple[str, Callable[[], str], float | None]] = {
    "CSV": ("points.csv", _table, None),
    "CSV, thinned to 0.01 deg": ("points.csv", _table, 0.01),
    "trajectory as JSON": ("points.json", _json, None),
    "trajectory as YAML, a line a number": ("points.yaml", _yaml, None),
    "the program of the CSV, parsed and checked": ("points.csv", _table, None),
}


def measure_convert(number: int) -> Figures:
    """Return the seconds of one kind of import, without imports of modules."""
    from yarclang.convert.convert import convert
    from yarclang.convert.course import Wishes
    from yarclang.robot.description import load_robot
    from yarclang.source import SourceFile

    kind = list(CONVERTED)[number]
    name, make, tolerance = CONVERTED[kind]
    robot = load_robot("INDUSTRIAL6").value
    if robot is None:
        raise SystemExit("the robot can't be read")
    source = SourceFile(name, make())
    begun = time.perf_counter()
    result = convert(source, robot, Wishes(tolerance=tolerance))
    seconds = time.perf_counter() - begun
    if result.value is None:
        raise SystemExit(result.diagnostics[0].message)
    if kind.startswith("the program"):
        _checked(loops(100))
        begun = time.perf_counter()
        _checked(result.value.text)
        seconds = time.perf_counter() - begun
    return {"seconds": seconds}


CHILDREN: dict[str, Callable[..., Figures]] = {
    "loops": lambda count: measure_check(loops, count),
    "calls": lambda count: measure_check(calls, count),
    "edit": measure_edit,
    "convert": measure_convert,
}


if __name__ == "__main__":
    main()
