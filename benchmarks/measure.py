"""Measurement of processes, with several tasks run alternately."""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    import pyperf

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Process:
    """A finished process: wall time and time on a core [s], its peak memory [MB], its standard output."""

    seconds: float
    cpu: float
    peak: float
    output: str


def process(*command: str) -> Process:
    """Run a command to its end.

    The peak is at least that of this process, because a child begins with the peak of its parent. So callers
    must not import large modules.
    """
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        begun = time.perf_counter()
        child = subprocess.Popen(command, stdout=output, stderr=errors, env=environment())
        _, status, usage = os.wait4(child.pid, 0)
        seconds = time.perf_counter() - begun
        child.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        errors.seek(0)
        if child.returncode != 0:
            raise SystemExit(f"{' '.join(command)}\n{errors.read()[-4000:]}\nended with {child.returncode}")
        cpu = usage.ru_utime + usage.ru_stime
        return Process(seconds, cpu, usage.ru_maxrss / 1024.0, output.read())


@cache
def environment() -> dict[str, str]:
    """Return our environment with a folder for bytecode, as for an installed package. With
    PYTHONDONTWRITEBYTECODE, Python's compiler would be timed instead. The folder is filled in the first
    round, which isn't counted.
    """
    folder = tempfile.mkdtemp(prefix="yarclang-benchmarks-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    return {**kept, "PYTHONPYCACHEPREFIX": folder}


def by_turns(tasks: Mapping[str, Callable[[], T]], rounds: int, *, warm: bool = True) -> dict[str, list[T]]:
    """Return the results of each task from `rounds` rounds. In each round the tasks run one after the other,
    so that other load on the machine affects all of them equally. If `warm` is true, a first round isn't
    counted.
    """
    found: dict[str, list[T]] = {name: [] for name in tasks}
    for number in range(rounds + warm):
        for name, task in tasks.items():
            value = task()
            if number >= warm:
                found[name].append(value)
    return found


def benchmark(name: str, seconds: list[float]) -> pyperf.Benchmark:
    """Return times in the format of pyperf: `pyperf show`, `stats`, `compare_to` read the file."""
    import pyperf

    return pyperf.Benchmark(
        [pyperf.Run(seconds, metadata={"name": name, "unit": "second"}, collect_metadata=True)]
    )
