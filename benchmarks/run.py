"""The figures of RESULTS.md: `python benchmarks/run.py`, in an environment with yarclang[dev].

Each comparison runs its sides by turns, round by round; the table has medians. roboticstoolbox-python may live in an
environment of its own: `--rtb-python` or RTB_PYTHON says where its interpreter is (default: this one).
"""

from __future__ import annotations

import argparse
import json
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
from measure import Process, benchmark, by_turns, process

HERE = Path(__file__).parent
LISTING4 = HERE.parent / "examples" / "01_listing4.yarc"
YARCC = str(Path(sys.executable).with_name("yarcc"))
LINES, TM = 1000, 5
COARSE_TM = 50
COUNTS = (10, 100, 1000, 10_000)
RTB_TOLERANCES = {"its own tolerance": "1e-6", "error under 1e-9": "5e-19"}


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the table: `seconds` are kept in the file for pyperf."""

    what: str
    figure: str
    goal: str = ""
    seconds: tuple[float, ...] = ()


def main() -> None:
    """Measure what is asked for, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"some of {', '.join(PARTS)}; default: all")
    parser.add_argument(
        "--rounds", type=int, default=5, help="rounds for long work, four times as many for short"
    )
    parser.add_argument("--rtb-python", default=os.environ.get("RTB_PYTHON", sys.executable))
    parser.add_argument(
        "--peer-lines", type=int, default=100, help="as many of the 1,000 lines go to the peers"
    )
    parser.add_argument("-o", "--output", type=Path, help="all times, for pyperf")
    options = parser.parse_args()
    if unknown := set(options.parts) - set(PARTS):
        parser.error(f"no part is called {', '.join(sorted(unknown))}")
    print("| what | figure | goal |\n|---|---|---|")
    kept: list[pyperf.Benchmark] = []
    for name in options.parts or PARTS:
        for row in PARTS[name](options):
            print(f"| {row.what} | {row.figure} | {row.goal} |", flush=True)
            if row.seconds:
                kept.append(benchmark(f"{name}: {row.what}", list(row.seconds)))
    if options.output and kept:
        pyperf.BenchmarkSuite(kept).dump(str(options.output), replace=True)


def startup(options: argparse.Namespace) -> Iterator[Row]:
    """Listing 4 and --help against the imports that they can't do without."""
    with tempfile.TemporaryDirectory() as folder:
        listing4 = (YARCC, "--robot", "INDUSTRIAL6", "-o", f"{folder}/out.pmc", str(LISTING4))
        imports = (sys.executable, "-c", "import pinocchio, scipy.linalg")
        yield from _against(
            "yarcc, Listing 4", listing4, "import pinocchio, scipy.linalg", imports, 2.0, options
        )
    click = (sys.executable, "-c", "import click")
    yield from _against("yarcc --help", (YARCC, "--help"), "import click", click, 1.5, options)


def _against(
    name: str,
    ours: tuple[str, ...],
    their_name: str,
    theirs: tuple[str, ...],
    goal: float,
    options: argparse.Namespace,
) -> Iterator[Row]:
    """Two processes side by side."""
    tasks: dict[str, Callable[[], Process]] = {
        name: partial(process, *ours),
        their_name: partial(process, *theirs),
    }
    seconds = {
        task: [one.seconds for one in runs] for task, runs in by_turns(tasks, 4 * options.rounds).items()
    }
    for task, times in seconds.items():
        yield Row(f"`{task}`", f"{1e3 * statistics.median(times):.0f} ms", seconds=tuple(times))
    yield Row("as a ratio", f"{_ratio(seconds[name], seconds[their_name]):.2f}", f"at most {goal}")


def thousand(options: argparse.Namespace) -> Iterator[Row]:
    """1,000 lines of 1 s at TM 5 as a whole process, then by stages."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder, "lines.yarc")
        program.write_text(programs.lines(LINES), encoding="utf-8")
        compile_ = partial(process, YARCC, "--tm", str(TM), "-o", f"{folder}/out.pmc", str(program))
        found = by_turns({"whole": compile_, "stages": partial(_inside, "stages", LINES, TM)}, options.rounds)
    whole, stages = found["whole"], found["stages"]
    times = [one.seconds for one in whole]
    text = f"{stages[0]['rows']:,} rows, {stages[0]['bytes'] / 1e6:.1f} MB of text"
    yield Row(
        f"{LINES:,} MOVELs of 1 s at TM {TM}, whole process ({text})",
        _seconds(times),
        "under 10 s",
        tuple(times),
    )
    yield Row("its largest memory", f"{max(one.peak for one in whole):.0f} MB", "under 1,000 MB")
    for stage in stages[0]["seconds"]:
        times = [one["seconds"][stage] for one in stages]
        yield Row(f"of it: {stage}", _seconds(times), seconds=tuple(times))


def planning(options: argparse.Namespace) -> Iterator[Row]:
    """The same lines, program to joint samples, against the peers."""
    with tempfile.TemporaryDirectory() as folder:
        task = Path(folder, "task.json")
        task.write_text(json.dumps(_inside("task", options.peer_lines, TM)), encoding="utf-8")
        tasks: dict[str, Callable[[], dict[str, Any]]] = {
            "yarclang": partial(_inside, "plan", LINES, TM),
            "loop over pin, error under 1e-9": partial(_peer, sys.executable, "peer_pin.py", str(task)),
        }
        for name, tolerance in RTB_TOLERANCES.items():
            tasks[f"roboticstoolbox-python, {name}"] = partial(
                _peer, options.rtb_python, "peer_rtb.py", str(task), tolerance
            )
        found = by_turns(tasks, options.rounds)
    ours = [one["seconds"] / one["samples"] for one in found["yarclang"]]
    for name, runs in found.items():
        times = [one["seconds"] / one["samples"] for one in runs]
        what = f"{name}, a sample ({runs[0]['samples']:,} samples)"
        if name == "yarclang":
            alone = statistics.median(one["planning"] / one["samples"] for one in runs)
            yield Row(
                f"{what}; planning without sampling",
                f"{_micro(times)}; {1e6 * alone:.1f} µs",
                seconds=tuple(times),
            )
            continue
        apart = max(one["apart"] for one in runs)
        ratio = f"{_ratio(times, ours):.2f} times ours; joints within {apart:.0e} rad of ours"
        yield Row(what, f"{_micro(times)}, {ratio}", "at least 3 times", tuple(times))


def cost(options: argparse.Namespace) -> Iterator[Row]:
    """The whole way a command, from 10 commands to 10,000."""
    for kind, name in (("lines", "MOVEL"), ("joint_moves", "MOVEJ")):
        tasks = {str(count): partial(_inside, "cost", count, COARSE_TM, kind) for count in COUNTS}
        found = by_turns(tasks, max(1, options.rounds // 2))
        medians = [
            1e3 * statistics.median(one["seconds"] for one in found[str(count)]) / count for count in COUNTS
        ]
        for count, median in zip(COUNTS, medians, strict=True):
            seconds = tuple(one["seconds"] for one in found[str(count)])
            yield Row(
                f"{count:,} {name} of 1 s at TM {COARSE_TM}, a command", f"{median:.2f} ms", "flat", seconds
            )


def _inside(what: str, *arguments: object) -> dict[str, Any]:
    return _peer(sys.executable, "inside.py", what, *map(str, arguments))


def _peer(python: str, script: str, *arguments: str) -> dict[str, Any]:
    """What a script of this folder prints."""
    answer: dict[str, Any] = json.loads(process(python, str(HERE / script), *arguments).output)
    return answer


def _ratio(some: list[float], others: list[float]) -> float:
    """The median of the ratios, round by round."""
    return statistics.median(one / other for one, other in zip(some, others, strict=True))


def _seconds(times: list[float]) -> str:
    return f"{statistics.median(times):.2f} s"


def _micro(times: list[float]) -> str:
    return f"{1e6 * statistics.median(times):.1f} µs"


PARTS: dict[str, Callable[[argparse.Namespace], Iterator[Row]]] = {
    "startup": startup,
    "thousand": thousand,
    "planning": planning,
    "cost": cost,
}

if __name__ == "__main__":
    main()
