"""Measure the figures of RESULTS.md: `python benchmarks/run.py`, in an environment with yarclang[dev].

The two sides of each comparison run alternately, round by round. The table has medians of times, and medians
of the ratios of all rounds. roboticstoolbox-python may be in a separate environment: `--rtb-python` or
RTB_PYTHON names its interpreter (default: this one).
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import programs
import pyperf
from measure import benchmark, by_turns, process

HERE = Path(__file__).parent
LISTING4 = HERE.parent / "examples" / "01_listing4.yarc"
YARCC = str(Path(sys.executable).with_name("yarcc"))
LINES, TM = 1000, 5
COARSE_TM = 50
COUNTS = (10, 100, 1000, 10_000)
RTB_TOLERANCES = {"its own tolerance": "1e-6", "error under 1e-9": "5e-19"}

Run = dict[str, Any]
"""Result of a task: `seconds` of wall time, `cpu` seconds on a core, and more."""


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the table. `seconds` are kept in the file for pyperf, and multiplied by `scale` for
    display.
    """

    what: str
    runs: list[Run]
    unit: str = "s"
    scale: float = 1.0
    note: str = ""
    goal: str = ""

    def __str__(self) -> str:
        wall, core = (_median(self.runs, key, self.scale) for key in ("seconds", "cpu"))
        return f"| {self.what} | {wall} {self.unit} | {core} {self.unit} | {self.note} | {self.goal} |"


def main() -> None:
    """Measure the requested parts, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"some of {', '.join(PARTS)}; default: all")
    parser.add_argument("--rounds", type=int, default=5, help="for long work; four times as many for short")
    parser.add_argument("--rtb-python", default=os.environ.get("RTB_PYTHON", sys.executable))
    parser.add_argument(
        "--peer-lines", type=int, default=100, help="as many of the 1,000 lines go to the peers"
    )
    parser.add_argument("-o", "--output", type=Path, help="all wall times, for pyperf")
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no part is called {', '.join(sorted(unknown))}")
    print("| what | median | on a core | | goal |\n|---|---|---|---|---|")
    kept: list[pyperf.Benchmark] = []
    for name in options.parts or PARTS:
        for row in PARTS[name](options):
            print(row, flush=True)
            kept.append(benchmark(f"{name}: {row.what}", [run["seconds"] for run in row.runs]))
    if options.output:
        pyperf.BenchmarkSuite(kept).dump(str(options.output), replace=True)


def startup(options: argparse.Namespace) -> Iterator[Row]:
    """Measure whole short processes against the imports that they need."""
    with tempfile.TemporaryDirectory() as folder:
        listing4 = (YARCC, "--robot", "INDUSTRIAL6", "-o", f"{folder}/out.pmc", str(LISTING4))
        pairs = {
            "yarcc, Listing 4": (listing4, "import pinocchio, scipy.linalg", 1.8),
            "yarcc --help": ((YARCC, "--help"), "import click", 1.5),
        }
        for name, (command, imports, goal) in pairs.items():
            theirs = (sys.executable, "-c", imports)
            found = by_turns(
                {"ours": partial(_whole, *command), "theirs": partial(_whole, *theirs)}, 4 * options.rounds
            )
            yield Row(f'`python -c "{imports}"`', found["theirs"], "ms", 1e3)
            yield Row(
                f"`{name}`",
                found["ours"],
                "ms",
                1e3,
                _times(found["ours"], found["theirs"]),
                f"at most {goal}",
            )


def thousand(options: argparse.Namespace) -> Iterator[Row]:
    """Measure 1,000 lines of 1 s at TM 5 as a whole process, and, in a second process, by stages."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, "lines.yarc")
        program.write_text(programs.lines(LINES), encoding="utf-8")
        compile_ = partial(_whole, YARCC, "--tm", str(TM), "-o", f"{folder}/out.pmc", str(program))
        found = by_turns({"whole": compile_, "stages": partial(_inside, "stages", LINES, TM)}, options.rounds)
    stages = found["stages"]
    peak = max(run["peak"] for run in found["whole"])
    note = (
        f"{stages[0]['rows']:,} rows, {stages[0]['bytes'] / 1e6:.1f} MB of text; memory at most {peak:.0f} MB"
    )
    yield Row(
        f"{LINES:,} MOVELs of 1 s at TM {TM}, whole process",
        found["whole"],
        note=note,
        goal="under 10 s and 1,000 MB",
    )
    for stage in stages[0]["stages"]:
        yield Row(f"of it: {stage}", [run["stages"][stage] for run in stages])


def planning(options: argparse.Namespace) -> Iterator[Row]:
    """Measure the same lines from program to joint samples, and other libraries that solve their poses. All
    times are per sample.
    """
    with tempfile.TemporaryDirectory() as folder:
        task = Path(folder, "task.json")
        task.write_text(json.dumps(_inside("task", options.peer_lines, TM)), encoding="utf-8")
        ours = f"yarclang, {LINES:,} lines"
        tasks: dict[str, Callable[[], Run]] = {ours: partial(_inside, "plan", LINES, TM)}
        peer = f"{options.peer_lines} of the lines"
        tasks[f"loop over pin, error under 1e-9, {peer}"] = partial(
            _script, sys.executable, "peer_pin.py", str(task)
        )
        for name, tolerance in RTB_TOLERANCES.items():
            toolbox = partial(_script, options.rtb_python, "peer_rtb.py", str(task), tolerance)
            tasks[f"roboticstoolbox-python, {name}, {peer}"] = toolbox
        found = {name: [_each(run) for run in runs] for name, runs in by_turns(tasks, options.rounds).items()}
    for name, runs in found.items():
        if name == ours:
            yield Row(
                f"{name}, a sample", runs, "µs", 1e6, f"of it planning {_median(runs, 'planning', 1e6)} µs"
            )
            continue
        apart = max(run["apart"] for run in runs)
        note = f"{_times(runs, found[ours])} ours; joints within {apart:.0e} rad of ours"
        yield Row(f"{name}, a sample", runs, "µs", 1e6, note, "at least 3 times")


def cost(options: argparse.Namespace) -> Iterator[Row]:
    """Measure the time of a command from text to certified text in one process, from 10 commands to
    10,000.
    """
    for kind, name in (("lines", "MOVEL"), ("joint_moves", "MOVEJ")):
        tasks = {str(count): partial(_inside, "cost", count, COARSE_TM, kind) for count in COUNTS}
        found = by_turns(tasks, (options.rounds + 1) // 2, warm=False)
        for count in COUNTS:
            what = f"{count:,} {name}s of 1 s at TM {COARSE_TM}, a command"
            note = (
                _times(found[str(count)], found[str(COUNTS[0])], COUNTS[0] / count) + f" that of {COUNTS[0]}"
            )
            yield Row(what, found[str(count)], "ms", 1e3 / count, note, "flat")


def stopping(options: argparse.Namespace) -> Iterator[Row]:
    """Measure stops from the order to the wire, with eight busy processes."""
    command = (sys.executable, str(HERE / "stopping.py"), "--rounds", str(10 * options.rounds), "--busy", "8")
    found = json.loads(process(*command, "--priority", "--json").output.splitlines()[-1])
    for phase, times in found["8"].items():
        ranked = sorted(whole for whole, _ in times)
        runs: list[Run] = [{"seconds": whole, "cpu": inside} for whole, inside in times]
        note = f"p99 {1e3 * ranked[math.ceil(0.99 * len(ranked)) - 1]:.1f} ms; in place of a core: once read"
        yield Row(f"a stop to the wire, {phase}", runs, "ms", 1e3, note, "p99 20 ms")


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "startup": startup,
    "thousand": thousand,
    "planning": planning,
    "cost": cost,
    "stopping": stopping,
}


def _whole(*command: str) -> Run:
    """Run a whole process."""
    ended = process(*command)
    return {"seconds": ended.seconds, "cpu": ended.cpu, "peak": ended.peak}


def _inside(what: str, *arguments: object) -> Run:
    """Run a measurement of inside.py."""
    return _script(sys.executable, "inside.py", what, *map(str, arguments))


def _script(python: str, script: str, *arguments: str) -> Run:
    """Run a script of this folder and return its output."""
    answer: Run = json.loads(process(python, str(HERE / script), *arguments).output)
    return answer


def _each(run: Run) -> Run:
    """Return the times divided by the number of samples."""
    times = {key: run[key] / run["samples"] for key in ("seconds", "cpu", "planning") if key in run}
    return {**run, **times}


def _times(runs: list[Run], others: list[Run], scale: float = 1.0) -> str:
    """Return the ratio of times, by the clock and on a core."""
    wall, core = (
        statistics.median(scale * run[key] / other[key] for run, other in zip(runs, others, strict=True))
        for key in ("seconds", "cpu")
    )
    return f"**{wall:.2f}** times ({core:.2f} on a core)"


def _median(runs: list[Run], key: str, scale: float) -> str:
    """Format a median with three digits."""
    value = scale * statistics.median(run[key] for run in runs)
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


if __name__ == "__main__":
    main()
