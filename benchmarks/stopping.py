"""Measure the time of a stop from the order to the wire, under load: `python benchmarks/stopping.py [--rounds
N] [--busy N ...]`.

`yarc serve`, with a log, and `yarc sim` run as separate processes. Orders come over the control socket,
alternately from a connected client, and on a new connection like those of `yarc hold`. The clock begins
before the order is written, and ends when the bytes of the hold are on the controller's wire; both are read
from the system's monotonic clock. The client and the simulator stand for a person and a controller, so they
have a higher priority than other processes, if the user may set it. Without `--priority`, the serving process
is an ordinary one. There are four phases, each beside `--busy` processes that only compute:

- a program is streamed;
- a program is streamed while another client has long programs planned, in the same process;
- a program is streamed while eight clients receive all events, with positions;
- a client steers a live motion at 50 Hz.

Goal: 20 ms (p99 of all phases) with eight busy processes.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import json
import math
import os
import random
import re
import resource
import select
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from yarclang.client import Refused, Robot

ROBOT = "INDUSTRIAL6"
SIMULATOR = """
import contextlib, os
from yarclang.cli.yarc import main

with contextlib.suppress(PermissionError):  # a controller has a processor of its own
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
main(["sim", "--port", "0", "--robot", "INDUSTRIAL6"])
"""
SERVER = """
import os, sys, time
from yarclang.runtime.transports import tcp
from yarclang.coordinator.ordered import OrderedSession
from yarclang.cli.yarc import main

sends, orders, heard = tcp.Wire.send, OrderedSession.order, 0

def send(self, data):
    sends(self, data)
    if data[8:] == b"&1H":
        os.write({pipe}, b"%d %d\\n" % (time.monotonic_ns(), heard))

def order(self, order):
    global heard
    heard = time.monotonic_ns()
    orders(self, order)

tcp.Wire.send, OrderedSession.order = send, order
main(["serve", "--robot", "INDUSTRIAL6", "--to", "tcp://127.0.0.1:{port}", "--log", {log!r}])
"""
BUSY = "import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    for _ in range(10**6): pass"
PROGRAM = "".join(
    f"P{2 * k + 1} MOVEJ 20 10 -20 30 20 15 [10] (deg,s)\nP{2 * k + 2} MOVEJ 0 0 0 0 0 0 [10] (deg,s)\n"
    for k in range(20)
)
Stop = tuple[float, float]
"""Times [s] until the hold is sent to the controller: from the order, and from the moment when the serving
process read it.
"""

GOAL = "20 ms"
PHASES = ("a program", "a program, others planned", "a program, 8 watchers", "live at 50 Hz")
WATCHERS = 8
_DROP, _SYS_NICE = 24, 23
"""PR_CAPBSET_DROP of prctl, and the capability CAP_SYS_NICE."""

PATIENCE = 20.0
"""Longest time to wait for a hold on the wire [s]."""


class Pipe:
    """Lines of a pipe, with a time limit."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._rest = b""

    def line(self, patience: float) -> str | None:
        """Return the next line; None if none comes in time [s]."""
        while b"\n" not in self._rest:
            if not select.select([self._descriptor], [], [], patience)[0]:
                return None
            self._rest += os.read(self._descriptor, 4096)
        line, _, self._rest = self._rest.partition(b"\n")
        return line.decode()

    def drain(self) -> None:
        """Drop the pending lines."""
        while self.line(0.0) is not None:
            pass


@contextlib.contextmanager
def process(
    code: str, *arguments: str, pipe: int | None = None, ordinary: bool = False
) -> Iterator[subprocess.Popen[str]]:
    """Yield a process of Python, as long as the context lasts. An ordinary one may not raise its priority."""
    kept = () if pipe is None else (pipe,)
    with subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.PIPE,
        text=True,
        pass_fds=kept,
        preexec_fn=_give_up_rights if ordinary else None,  # noqa: PLW1509 (no thread is there yet)
    ) as started:
        try:
            yield started
        finally:
            started.terminate()


def _give_up_rights() -> None:
    """Drop the right to raise the priority."""
    resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
    ctypes.CDLL(None).prctl(_DROP, _SYS_NICE, 0, 0, 0)


@contextlib.contextmanager
def served(folder: Path, *, ordinary: bool) -> Iterator[tuple[str, Pipe]]:
    """Yield the socket of a served robot, and the pipe that reports the holds on its wire."""
    reading, writing = os.pipe()
    with process(SIMULATOR) as simulator:
        assert simulator.stdout is not None
        said = re.search(r":(\d+),", simulator.stdout.readline())
        assert said is not None
        code = SERVER.format(pipe=writing, port=said[1], log=str(folder))
        with process(code, pipe=writing, ordinary=ordinary) as server:
            assert server.stdout is not None
            line = server.stdout.readline()
            assert "is served: " in line, line
            yield line.strip().rpartition("is served: ")[2], Pipe(reading)


@contextlib.contextmanager
def company(role: str, path: str) -> Iterator[None]:
    """Run another process that is a client in a role."""
    with process(
        f"import sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import stopping; "
        f"stopping.{role}({path!r})"
    ):
        time.sleep(1.0)
        yield


@contextlib.contextmanager
def busy(count: int) -> Iterator[None]:
    """Run processes that only compute, as long as the context lasts."""
    with contextlib.ExitStack() as stack:
        for _ in range(count):
            stack.enter_context(process(BUSY))
        time.sleep(min(count, 3))
        yield


# roles, each in a process of its own


def plan(path: str) -> None:
    """Plan long, different programs without end."""
    with Robot(path, name="planner", timeout=60.0) as robot:
        while True:
            lines = [
                f"P{number} MOVEJ {' '.join(f'{random.uniform(-30, 30):.3f}' for _ in range(6))} [2] (deg,s)"
                for number in range(1, 200)
            ]
            robot.load("other.yarc", text="\n".join(lines) + "\n")


def watch(path: str) -> None:
    """Receive all events, with several clients."""

    def one() -> None:
        with Robot(path, name="watcher") as robot:
            for _ in robot.events(positions=True):
                pass

    threads = [threading.Thread(target=one) for _ in range(WATCHERS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def steer(path: str) -> None:
    """Move a joint to and fro, at 50 Hz; begin again after each stop."""
    with Robot(path, name="master", timeout=60.0) as robot:
        robot.own()
        begun = time.monotonic()
        while True:
            passed = time.monotonic() - begun
            try:
                robot.want(velocity={"J1": 3.0 * math.cos(passed)})
            except Refused:
                time.sleep(0.05)
                with contextlib.suppress(Refused):
                    robot.want(finish=True)
                continue
            time.sleep(max(0.0, 0.02 - (time.monotonic() - begun - passed)))


# the phases


def wait_for(robot: Robot, state: str, patience: float = PATIENCE) -> bool:
    """Wait for a state of the robot. Return False if it isn't reached in time [s]."""
    until = time.monotonic() + patience
    while robot.status()["state"] != state:
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def ordered(order: str, path: str, robot: Robot, number: int, pipe: Pipe) -> Stop | None:
    """Give an order, and return its times; None if the robot was already at rest."""
    pipe.drain()
    if number % 2:
        begun = time.monotonic_ns()
        robot.ask(order)
    else:
        with Robot(path, name=None) as other:
            begun = time.monotonic_ns()
            other.ask(order)
    said = pipe.line(1.0)
    if said is None:
        return None
    sent, heard = map(int, said.split())
    return (sent - begun) / 1e9, (sent - heard) / 1e9


def program(path: str, count: int, pipe: Pipe) -> list[Stop]:
    """Hold a program repeatedly."""
    found: list[Stop] = []
    with (
        Robot(path, name="owner", timeout=PATIENCE) as owner,
        Robot(path, name="bench", timeout=PATIENCE) as robot,
    ):
        owner.own(shared=True)
        loaded = owner.load("bench.yarc", text=PROGRAM, here=True)
        assert loaded["program"] is not None, loaded
        going = threading.Thread(target=lambda: owner.run(loaded["program"]["number"]), daemon=True)
        going.start()
        assert wait_for(robot, "move")
        while len(found) < count:
            time.sleep(random.uniform(0.05, 0.25))
            took = ordered("hold", path, robot, len(found), pipe)
            if took is not None:
                found.append(took)
            if wait_for(robot, "hold", 2.0):
                time.sleep(0.02)
                with contextlib.suppress(Refused):
                    robot.ask("resume")
            assert wait_for(robot, "move"), robot.status()
        robot.ask("stop")
        going.join()
        owner.release()
    return found


def live(path: str, count: int, pipe: Pipe) -> list[Stop]:
    """Stop a live motion repeatedly."""
    found: list[Stop] = []
    with Robot(path, name="bench", timeout=PATIENCE) as robot:
        while len(found) < count:
            assert wait_for(robot, "move")
            time.sleep(random.uniform(0.05, 0.25))
            took = ordered("stop", path, robot, len(found), pipe)
            if took is not None:
                found.append(took)
            wait_for(robot, "stop", 2.0)
    return found


def measure(count: int, load: int, *, ordinary: bool) -> Iterator[tuple[str, list[Stop]]]:
    """Yield the phases, and the times of each [s]."""
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder), ordinary=ordinary) as (path, pipe),
        busy(load),
    ):
        works: Sequence[tuple[str, str | None, Callable[[str, int, Pipe], list[Stop]]]] = (
            (PHASES[0], None, program),
            (PHASES[1], "plan", program),
            (PHASES[2], "watch", program),
            (PHASES[3], "steer", live),
        )
        for name, role, work in works:
            with company(role, path) if role else contextlib.nullcontext():
                yield name, work(path, count, pipe)


def row(what: str, load: int, found: list[Stop], goal: str = "") -> str:
    """Return a row of the table."""
    whole, inside = (sorted(times) for times in zip(*found, strict=True))
    shown = (statistics.median(whole), _p99(whole), whole[-1], statistics.median(inside), _p99(inside))
    times = " | ".join(f"{value * 1e3:.1f} ms" for value in shown)
    return f"| {what} | {load} | {len(found)} | {times} | {goal} |"


def _p99(ranked: Sequence[float]) -> float:
    return ranked[math.ceil(0.99 * len(ranked)) - 1]


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=60, help="stops in each phase")
    parser.add_argument("--busy", type=int, nargs="*", default=[0, 2, 8], help="busy processes beside")
    parser.add_argument(
        "--priority", action="store_true", help="the serving process may go before ordinary ones"
    )
    parser.add_argument("--json", action="store_true", help="print all times instead")
    options = parser.parse_args()
    with contextlib.suppress(PermissionError):  # this process stands for a person, or another computer
        os.sched_setscheduler(0, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(1))
    kept: dict[str, Any] = {}
    if not options.json:
        print(
            "| a stop while there is | busy processes | stops | median | p99 | most | of it once read, "
            "median | p99 | goal |\n|---|---|---|---|---|---|---|---|---|"
        )
    for load in options.busy:
        found: dict[str, list[Stop]] = {}
        for name, times in measure(options.rounds, load, ordinary=not options.priority):
            found[name] = times
            if not options.json:
                print(row(name, load, times), flush=True)
        kept[str(load)] = found
        if options.json:
            continue
        everything = [one for times in found.values() for one in times]
        print(row("**all of these**", load, everything, GOAL), flush=True)
    if options.json:
        print(json.dumps(kept))


if __name__ == "__main__":
    main()
