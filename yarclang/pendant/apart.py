"""Processes for work that mustn't disturb the process that streams to the controller. Each process has low
priority, limited memory, and libraries restricted to one thread.
"""

from __future__ import annotations

import asyncio
import os
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Sequence
from pathlib import Path

_BEGINS = """
import importlib, os, resource, sys
if hasattr(os, "SCHED_OTHER"):
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
os.nice(int(sys.argv.pop(1)))
most = int(sys.argv.pop(1))
resource.setrlimit(resource.RLIMIT_AS, (most, most))
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
importlib.import_module(sys.argv.pop(1)).main()
"""
"""First Python statements of each process. They switch off real-time scheduling, which the pendant may have,
and limit the memory of the process. Then they call `main` of the process's module.
"""


def command_of(module: str, arguments: Sequence[str], most_memory: int, nice: int = 10) -> tuple[str, ...]:
    """Return the command line that starts a process.

    Args:
        module: name of the module whose function `main` the process calls.
        arguments: command-line arguments for `main` (sys.argv).
        most_memory: largest address space of the process [bytes]. The compiler with its libraries alone takes
            1 GiB.
        nice: niceness, by which the priority of the process is lowered.
    """
    return sys.executable, "-c", _BEGINS, str(nice), str(most_memory), module, *arguments


async def begun(
    command: Sequence[str],
    *,
    talks: bool = True,
    limit: int = 1 << 16,
    folder: Path | None = None,
    handles: Sequence[int] = (),
) -> Process:
    """Start a process. Ctrl-C in the terminal reaches only the pendant, not this process.

    Args:
        command: command line that starts the process (`command_of`).
        talks: True to give the process a standard input that the caller can write to.
        limit: longest line of the process's output [bytes].
        folder: working folder of the process; None for that of the pendant.
        handles: descriptors of open files that the process inherits.

    Raises:
        OSError: the process can't be started.
    """
    environment = dict(os.environ) | dict.fromkeys(
        ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"
    )
    return await asyncio.create_subprocess_exec(
        *command,
        stdin=PIPE if talks else DEVNULL,
        stdout=PIPE,
        stderr=DEVNULL,
        limit=limit,
        cwd=folder,
        env=environment,
        pass_fds=tuple(handles),
        start_new_session=True,
    )
