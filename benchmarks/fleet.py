"""Measure the gain of shared and reused work: `python benchmarks/fleet.py [--programs N] [PART ...]`, on an
otherwise idle machine. The load is printed beside the figures.

Parts:

- `processes`: yarcc of N programs of 50 motions in one process, in two processes, and with two dask workers
  of one thread;
- `overhead`: the cost of a task that does nothing;
- `cache`: 1,000 unchanged programs, checked again;
- `campaign`: the rate of random programs in a campaign that is killed in the middle and continued, and the
  time that 10^6 programs would take;
- `length`: the processor time of a command in programs of 10^3 to 10^5 lines, and the time that 10^6 lines
  would take.

Matrix products use one thread. With `--programs 8`, everything takes a minute, and only shows that the
benchmark works.

Goals: two processes 1.8 times as fast as one, two workers 1.6 times; 2 ms a task; 1,000 unchanged programs in
3 s; constant cost of a command.
"""

from __future__ import annotations

import argparse
import json
import operator
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

from yarclang.fleet.spreading import Place, workers  # noqa: E402 - after the threads are set

MOTIONS = 50
COMMAND = [sys.executable, "-c", "import sys; from yarclang.cli.{0} import main; main(sys.argv[1:])"]


def programs(folder: Path, count: int, motions: int = MOTIONS) -> Path:
    """Write random programs of joint motions and lines, and return their folder."""
    folder.mkdir(parents=True)
    random = np.random.default_rng(0)
    for number in range(count):
        lines = [
            "ROBOT INDUSTRIAL6",
            "DEFAULT {TCP} (mm,deg,s) {B}",
            "P0000 MOVEJ_RPY 0 1174.4 1000 0 0 0 [MIN]",
        ]
        for step in range(1, motions):
            x, y, z = random.uniform(-150, 150, 3)
            word = "MOVEL" if step % 2 else "MOVEJ_RPY"
            lines.append(f"P{step * 10:04d} {word} {x:.2f} {1174.4 + y:.2f} {1000 + z:.2f} 0 0 0 [MIN]")
        (folder / f"p{number:04d}.yarc").write_text("\n".join(lines) + "\n")
    return folder


def seconds(command: str, *arguments: str) -> float:
    """Return the duration of a command [s]."""
    begin = time.perf_counter()
    made = subprocess.run(
        [COMMAND[0], COMMAND[1], COMMAND[2].format(command), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    taken = time.perf_counter() - begin
    if made.returncode:
        raise RuntimeError(made.stderr[-2000:])
    return taken


@contextmanager
def cluster(folder: Path, count: int) -> Iterator[str]:
    """Start a scheduler and workers of one thread on this machine, and yield the scheduler's address."""
    folder.mkdir()
    log = (folder / "log").open("wb")
    started = [
        subprocess.Popen(
            [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0",
                "--no-dashboard"],
            cwd=folder, stdout=log, stderr=log,
        )
    ]  # fmt: skip
    try:
        while not (found := re.search(r"Scheduler at:\s+(tcp://\S+)", (folder / "log").read_text())):
            time.sleep(0.1)
        options = ["--nthreads", "1", "--no-dashboard", "--no-nanny"]
        started += [
            subprocess.Popen(
                [sys.executable, "-m", "distributed.cli.dask_worker", found[1], *options],
                cwd=folder,
                stdout=log,
                stderr=log,
            )
            for _ in range(count)
        ]
        while (folder / "log").read_text().count("Register worker") < count:
            time.sleep(0.1)
        yield found[1]
    finally:
        for process in started:
            process.kill()
            process.wait()


def measure_processes(folder: Path, count: int) -> Iterator[str]:
    """Yield the rows of processes and workers."""
    made = str(programs(folder / "programs", count))
    out = str(folder / "out")
    one = seconds("yarcc", made, "--out-dir", out, "--no-cache", "--jobs", "1")
    two = seconds("yarcc", made, "--out-dir", out, "--no-cache", "--jobs", "2")
    yield f"| {count} programs of {MOTIONS} motions, one process | {one:.1f} s | |"
    yield f"| two processes | {two:.1f} s, {one / two:.2f} times | at least 1.8 times |"
    with cluster(folder / "dask", 2) as address:
        seconds(
            "yarcc", made, "--out-dir", out, "--no-cache", "--scheduler", address
        )  # imports everything once
        dask = seconds("yarcc", made, "--out-dir", out, "--no-cache", "--scheduler", address)
    yield f"| two dask workers | {dask:.1f} s, {one / dask:.2f} times | at least 1.6 times |"


nothing = operator.index
"""A task that does nothing, and that workers can import."""


def timed(do: Callable[[range], Iterator[int]], items: range) -> float:
    """Return the duration of tasks that do nothing [s]."""
    list(do(range(8)))
    begin = time.perf_counter()
    if list(do(items)) != list(items):
        raise RuntimeError("the tasks weren't done")
    return time.perf_counter() - begin


def measure_overhead(folder: Path, count: int) -> Iterator[str]:
    """Yield the rows of tasks that do nothing."""
    items = range(20 * count)
    with workers(nothing, Place(2), lambda _: ()) as do:
        taken = timed(do, items)
    yield f"| a task that does nothing, two processes | {taken / len(items) * 1e3:.3f} ms | at most 2 ms |"
    with (
        cluster(folder / "dask-overhead", 2) as address,
        workers(nothing, Place(None, address), lambda _: ()) as do,
    ):
        taken = timed(do, items)
    yield f"| a task that does nothing, two dask workers | {taken / len(items) * 1e3:.3f} ms | at most 2 ms |"


def measure_cache(folder: Path, count: int) -> Iterator[str]:
    """Yield the rows of unchanged programs."""
    os.environ["YARCLANG_CACHE"] = str(folder / "cache")
    made = str(programs(folder / "unchanged", 5 * count, 10))
    first = seconds("yarc", "check", made)
    again = seconds("yarc", "check", made)
    yield f"| {5 * count:,} programs of 10 motions, checked | {first:.1f} s | |"
    yield f"| the same, unchanged | {again:.2f} s | at most 3 s for 1,000 |"


def measure_campaign(folder: Path, count: int) -> Iterator[str]:
    """Yield the rate of a campaign of 50 times as many programs, and its worst figures. The campaign is
    killed once and continued.
    """
    programs_, state = 50 * count, folder / "campaign"
    arguments = ["campaign", "--programs", str(programs_), "--state", str(state), "--format", "json"]
    begin = time.perf_counter()
    killed = subprocess.Popen(
        [COMMAND[0], COMMAND[1], COMMAND[2].format("yarc"), *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    # a third is done: a line for each ten programs, and one for the campaign
    while killed.poll() is None and (not state.exists() or state.read_bytes().count(b"\n") < programs_ / 30):
        time.sleep(0.1)
    killed.kill()
    killed.wait()
    made = subprocess.run(
        [COMMAND[0], COMMAND[1], COMMAND[2].format("yarc"), *arguments],
        capture_output=True,
        text=True,
        check=False,
    )
    taken = time.perf_counter() - begin
    if made.returncode not in (0, 1):
        raise RuntimeError(made.stderr[-2000:])
    report = json.loads(made.stdout)
    rate, hours = report["programs"] / taken, report["motion_seconds"] / 3600.0
    of_processor = report["processor_seconds"] / report["programs"]
    yield (
        f"| a campaign of {programs_:,} programs, killed and resumed | {taken:.0f} s, {rate:.1f} "
        f"programs/s, {of_processor:.2f} s of one core each | |"
    )
    yield f"| {report['compiled']:,} of them compile | {hours:.2f} h of motion | |"
    worst = ", ".join(
        f"{name} {one['share']:.6f} (seed {one['seed']})" for name, one in report["worst"].items()
    )
    yield f"| largest shares of what is allowed | {worst} | at most 1 |"
    seeds = ", ".join(str(one["seed"]) for one in report["finds"][:20])
    yield f"| something wrong | {report['found']:,}{': seeds ' + seeds if seeds else ''} | 0 |"
    yield f"| 10^6 programs at this rate | {1e6 / rate / 3600.0:.1f} h | |"


def measure_length(folder: Path, count: int) -> Iterator[str]:
    """Yield the cost of a command in programs of different lengths, up to 500 times as many lines as
    programs.
    """
    short, longest = 5 * count, 500 * count
    costs = []
    base = cost_of(programs(folder / "length-base", 1, 2), folder)
    for motions in (short, 10 * short, longest):
        taken = cost_of(programs(folder / f"length-{motions}", 1, motions), folder) - base
        costs.append(taken / motions)
        yield (
            f"| a command of {motions:,} | {taken / motions * 1e3:.2f} ms | {costs[-1] / costs[0]:.2f} "
            f"times that of {short:,} |"
        )
    growth = max(1.0, costs[-1] / costs[-2])
    hours = costs[-1] * growth * 1e6 / 3600.0
    yield (
        f"| a command of 10^6, by the growth of the last tenfold | {costs[-1] * growth * 1e3:.2f} ms, "
        f"{hours:.1f} h altogether | flat |"
    )


def cost_of(made: Path, folder: Path) -> float:
    """Return the processor time that compiling a folder of one program takes [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds("yarcc", str(made), "--out-dir", str(folder / "out"), "--no-cache", "-j", "1")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


PARTS = {
    "processes": measure_processes,
    "overhead": measure_overhead,
    "cache": measure_cache,
    "campaign": measure_campaign,
    "length": measure_length,
}


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"some of {', '.join(PARTS)}; default: all")
    parser.add_argument("--programs", type=int, default=200)
    given = parser.parse_args()
    print("| what | measured | goal |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in given.parts or PARTS:
            for row in PARTS[name](Path(folder), given.programs):
                print(row, flush=True)
    print(f"\nload {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
