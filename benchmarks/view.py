"""Measure `yarc view` for RESULTS.md: `python benchmarks/view.py`, in an environment with yarclang[dev].

A small client stands for the browser. The first picture is complete when the client has received everything
to draw; the drawing time of a browser isn't included.
"""

from __future__ import annotations

import argparse
import asyncio
import os
import re
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

from measure import environment

YARC = (
    sys.executable,
    "-c",
    "from yarclang.cli.yarc import main; main()",
    "view",
    "--no-browser",
    "--port",
    "0",
)
EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "12_machine_cell.yarc"
SILENCE = 1.0
"""Time without further data after which everything was sent [s]."""


def main() -> None:
    """Measure, and print rows for the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    _view(EXAMPLE)  # fills the bytecode cache
    found = [_view(EXAMPLE) for _ in range(rounds)]
    door, picture, cpu, peak, sent = (statistics.median(column) for column in zip(*found, strict=True))
    print(f"| example 12: to its address | {door:.2f} s |  |")
    print(f"| example 12: to a first picture | {picture:.2f} s | on a core {cpu:.2f} s |")
    print(f"| example 12: memory | {peak:.0f} MB | {sent / 1e6:.2f} MB are sent |")


def _view(file: Path) -> tuple[float, float, float, float, float]:
    """Return the figures of one view: the times from the start of its process to its address and to the first
    picture [s], both on a core [s], its peak memory [MB], and the bytes that it sends.
    """
    begun = time.perf_counter()
    process = subprocess.Popen(
        [*YARC, str(file)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment()
    )
    try:
        assert process.stderr is not None
        told = ""
        while not (found := re.search(r"http://\S+", told)):
            line = process.stderr.readline()
            if not line:
                raise SystemExit(f"yarc view has ended:\n{told}")
            told += line
        door = time.perf_counter() - begun
        sent, last = asyncio.run(_picture(found[0].replace("http", "ws")))
        cpu, peak = _used(process.pid)
        return door, last - begun, cpu, peak, sent
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(20)


async def _picture(address: str) -> tuple[int, float]:
    """Return the size of everything that is sent to a new page [bytes], and the time at which the last byte
    arrived.
    """
    import viser
    from websockets.asyncio.client import connect

    size, last = 0, 0.0
    protocol = f"viser-v{viser.__version__}"
    async with connect(address, subprotocols=[protocol], origin=None, max_size=None) as stream:  # type: ignore[list-item]
        while True:
            try:
                size += len(await asyncio.wait_for(stream.recv(), SILENCE if size else 60.0))
            except TimeoutError:
                return size, last
            last = time.perf_counter()


def _used(pid: int) -> tuple[float, float]:
    """Return the time of a process on a core [s], and its peak memory [MB]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    cpu = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    high = re.search(r"VmHWM:\s+(\d+) kB", Path(f"/proc/{pid}/status").read_text())
    return cpu, int(high[1]) / 1024.0 if high else 0.0


if __name__ == "__main__":
    main()
