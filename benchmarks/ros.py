"""Measure the ROS interface up to the controller's wire: `python benchmarks/ros.py [--goals N] [--stops N]
[--busy N ...]`.

`yarc ros`, with a log, and `yarc sim` run as separate processes. There are three figures:

- the time from the last of 100 points of a goal (sent one at a time, each answered) to the controller's R. It
  includes the pause of 50 ms, the plan, its proof, the check of the controller, and the first lines.
- the time from a stop to the hold on the controller's wire, while a program is streamed and the state link
  sends messages, beside `--busy` processes that only compute;
- the share of a core that the state link uses at 40 Hz, measured as the difference between the whole
  process with clients on this link and without them.

The clock begins before a message is written, and ends when the bytes are on the controller's wire; both are
read from the system's monotonic clock. Goals: 250 ms, 10 ms (p99 without busy processes), 8 %.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import re
import socket
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from stopping import SIMULATOR, Pipe, busy, process

from yarclang.ros.simple_message import (
    Comm,
    Decoder,
    JointPosition,
    Message,
    RobotStatus,
    TrajectoryPoint,
    encode,
)

DOOR = """
import os, time
from yarclang.runtime.transports import tcp
from yarclang.cli.yarc import main

sends = tcp.Wire.send

def send(self, data):
    sends(self, data)
    if data[8:] in (b"&1H", b"R", b"&1R"):
        os.write({pipe}, b"%s %d\\n" % (data[-1:], time.monotonic_ns()))

tcp.Wire.send = send
main(["ros", "--robot", "INDUSTRIAL6", "--to", "tcp://127.0.0.1:{port}", "--log", {log!r}, "--port", "0", "0"])
"""  # noqa: E501
POINTS = 100
PATIENCE = 30.0
"""Longest time to wait for something on the wire [s]."""


class Listener(threading.Thread):
    """A client on the state link."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self.joints: tuple[float, ...] = ()
        self.status: RobotStatus | None = None
        self._wire = socket.create_connection(("127.0.0.1", port))
        self.start()

    def run(self) -> None:
        """Listen until the connection ends."""
        decoder = Decoder()
        with contextlib.suppress(OSError):
            while data := self._wire.recv(4096):
                for message in decoder.feed(data):
                    if isinstance(message.body, JointPosition):
                        self.joints = message.body.joints
                    elif isinstance(message.body, RobotStatus):
                        self.status = message.body

    def until(self, *, moves: bool) -> None:
        """Wait until the robot moves, or is at rest."""
        since = time.monotonic()
        while self.status is None or not self.joints or self.status.in_motion != int(moves):
            if time.monotonic() - since > PATIENCE:
                raise SystemExit(f"the robot doesn't {'move' if moves else 'rest'}: {self.status}")
            time.sleep(0.01)

    def close(self) -> None:
        """End the connection."""
        self._wire.shutdown(socket.SHUT_RDWR)
        self._wire.close()


class Mover:
    """A client on the motion link."""

    def __init__(self, port: int) -> None:
        self._wire = socket.create_connection(("127.0.0.1", port))
        self._wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self, point: TrajectoryPoint) -> float:
        """Send a request and wait for its answer. Return the time at which the request was sent [s]."""
        frame = encode(Message(Comm.REQUEST, point))
        sent = time.monotonic()
        self._wire.sendall(frame)
        waiting = len(frame)
        while waiting:
            waiting -= len(self._wire.recv(waiting))
        return sent

    def goal(self, here: np.ndarray, there: np.ndarray, seconds: float, between: float) -> float:
        """Stream a goal. Return the time at which its last point was sent [s]."""
        share = (1.0 - np.cos(np.linspace(0.0, np.pi, POINTS))) / 2.0
        sent = 0.0
        for number, one in enumerate(here + share[:, None] * (there - here)):
            slots = (*one.tolist(), 0.0, 0.0, 0.0, 0.0)
            sent = self.ask(TrajectoryPoint(number, slots, 0.1, seconds / (POINTS - 1) if number else 10.0))
            time.sleep(between)
        return sent


@contextlib.contextmanager
def door(folder: Path) -> Iterator[tuple[int, tuple[int, int], Pipe]]:
    """Yield a running `yarc ros`: its process, its ports, and the pipe that reports the bytes on its wire."""
    reading, writing = os.pipe()
    with process(SIMULATOR) as simulator:
        assert simulator.stdout is not None
        said = re.search(r":(\d+),", simulator.stdout.readline())
        assert said is not None
        with process(DOOR.format(pipe=writing, port=said[1], log=str(folder)), pipe=writing) as server:
            assert server.stdout is not None
            found = None
            while found is None:
                line = server.stdout.readline()
                assert line
                found = re.search(r"motion link on port (\d+), state link on port (\d+)", line)
            threading.Thread(target=server.stdout.read, daemon=True).start()
            yield server.pid, (int(found[1]), int(found[2])), Pipe(reading)


def on_the_wire(pipe: Pipe, letter: str) -> float:
    """Return the next time at which a given letter was sent to the controller [s]."""
    while (line := pipe.line(PATIENCE)) is not None:
        what, _, when = line.partition(" ")
        if what == letter:
            return int(when) / 1e9
    raise SystemExit(f"{letter} never came on the wire")


def somewhere(random: np.random.Generator) -> np.ndarray:
    """Return joint positions near HOME [rad]."""
    return random.uniform(-0.3, 0.3, 6)


def first_motions(ports: tuple[int, int], pipe: Pipe, count: int, random: np.random.Generator) -> list[float]:
    """Return the times from the last point to R [s]."""
    listener, mover, found = Listener(ports[1]), Mover(ports[0]), []
    for number in range(count + 1):
        listener.until(moves=False)
        time.sleep(0.3)
        pipe.drain()
        sent = mover.goal(np.array(listener.joints[:6]), somewhere(random), 1.5, 0.002)
        found += [on_the_wire(pipe, "R") - sent] if number else []  # the first one includes imports
        listener.until(moves=True)
    listener.until(moves=False)
    return found


def stops(ports: tuple[int, int], pipe: Pipe, count: int, random: np.random.Generator) -> list[float]:
    """Return the times from a stop to the hold on the wire [s]."""
    listener, mover, found = Listener(ports[1]), Mover(ports[0]), []
    for _ in range(count):
        listener.until(moves=False)
        time.sleep(0.2)
        mover.goal(np.array(listener.joints[:6]), somewhere(random), 6.0, 0.0)
        listener.until(moves=True)
        time.sleep(random.uniform(0.1, 0.6))
        pipe.drain()
        sent = mover.ask(TrajectoryPoint(-4))
        found.append(on_the_wire(pipe, "H") - sent)
    listener.until(moves=False)
    return found


def share_of_a_core(pid: int, seconds: float) -> float:
    """Return the share of a core that a process uses."""
    ticks = os.sysconf("SC_CLK_TCK")

    def used() -> float:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2].split()
        return (int(fields[11]) + int(fields[12])) / ticks

    before, begun = used(), time.monotonic()
    time.sleep(seconds)
    return (used() - before) / (time.monotonic() - begun)


def shown(times: list[float]) -> str:
    """Format times in ms as a line."""
    ordered = sorted(times)
    last = ordered[min(len(ordered) - 1, int(0.99 * len(ordered)))]
    return (
        f"median {statistics.median(ordered) * 1e3:.1f} ms, p99 {last * 1e3:.1f} ms, worst "
        f"{ordered[-1] * 1e3:.1f} ms ({len(ordered)})"
    )


def main() -> None:
    """Measure all three figures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--goals", type=int, default=20)
    parser.add_argument("--stops", type=int, default=60)
    parser.add_argument("--busy", type=int, nargs="*", default=[0, 8])
    given = parser.parse_args()
    random = np.random.default_rng(1)
    print(f"load {os.getloadavg()[0]:.1f} before, {os.cpu_count()} cores")
    with tempfile.TemporaryDirectory() as folder, door(Path(folder)) as (pid, ports, pipe):
        time.sleep(1.0)
        shares = [share_of_a_core(pid, 8.0)]
        listeners = []
        for wanted in (1, 4):
            listeners += [Listener(ports[1]) for _ in range(wanted - len(listeners))]
            shares.append(share_of_a_core(pid, 8.0))
        for one in listeners:
            one.close()
        print(
            f"state link at 40 Hz: {shares[0]:.1%} of a core without clients, {shares[1]:.1%} with one "
            f"(+{shares[1] - shares[0]:.1%}, goal 8 %), {shares[2]:.1%} with four"
        )
        print(
            f"last of {POINTS} points to R (goal 250 ms): "
            f"{shown(first_motions(ports, pipe, given.goals, random))}"
        )
    for count in given.busy:
        with tempfile.TemporaryDirectory() as folder, door(Path(folder)) as (_, ports, pipe), busy(count):
            goal = " (goal 10 ms p99)" if not count else ""
            print(f"stop to hold, {count} busy{goal}: {shown(stops(ports, pipe, given.stops, random))}")


if __name__ == "__main__":
    main()
