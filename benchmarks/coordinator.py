"""Measure the coordinator's speed: `python benchmarks/coordinator.py [--rounds N]`, on a `yarc sim` in a
separate process.

- From the input of a line (Enter) to the first motion of a motor, which includes planning, proof, loading and
  start. Goal: 150 ms, median, for MOVEJ and MOVEL.
- From a key press to the first motion of a jog at TM 10. Goal: 120 ms.
- From a jog in the opposite direction to the reversal of the motion: the delay of the rotary buffer, and
  braking from 3 deg/s. Also from a stop to rest.
- From connecting to a served robot to its first event, by `yarclang/client.py`. Goal: 100 ms.
- The share of a core that an event stream at 50 Hz uses, at rest and in motion. Goal: 10 %.
"""

from __future__ import annotations

import argparse
import asyncio
import re
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from yarclang.client import Robot
from yarclang.coordinator.client import Client
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.steering import JointVelocity
from yarclang.coordinator.messages.events import Position
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.serving import ControlSocket
from yarclang.robot.description import load_robot
from yarclang.runtime.pmac.messages import AskControl
from yarclang.runtime.pmac.protocol import Connection

ROBOT = "INDUSTRIAL6"
SIMULATOR = "from yarclang.cli.yarc import main; main(['sim', '--port', '0', '--robot', 'INDUSTRIAL6'])"
LINES = {
    "MOVEJ": ("MOVEJ 5 10 10 0 40 0 [1] (deg,s)", "MOVEJ 0 10 10 0 40 0 [1] (deg,s)"),
    "MOVEL": (
        "DMOVE {TCP} 40 0 -40 0 0 0 [1] (mm,deg,s) {B}",
        "DMOVE {TCP} -40 0 40 0 0 0 [1] (mm,deg,s) {B}",
    ),
}
COUNTS = 2.0
"""Distance from its position at rest at which a motor counts as moved [counts]."""


class Watch:
    """Reader of the motors' positions at the highest possible rate, on a connection of its own."""

    def __init__(self, port: int) -> None:
        self.moved_at = 0.0
        self.rested_at = 0.0
        self.places: list[tuple[float, float]] = []
        self._port = port
        self._ends = False
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def _look(self) -> None:
        with socket.create_connection(("127.0.0.1", self._port)) as wire:
            wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection = Connection()
            first = last = None
            while not self._ends:
                now = time.perf_counter()
                wire.sendall(connection.send(AskControl("\x10"), now, 5.0))
                while not (events := connection.receive(wire.recv(4096), now)):
                    pass
                place = np.array([float(word) for word in events[0].items[0].split()[:6]])
                first = place if first is None else first
                if not self.moved_at and np.abs(place - first).max() > COUNTS:
                    self.moved_at = now
                if last is None or np.abs(place - last).max() > 0.5:
                    self.rested_at = now
                self.places.append((now, float(place[0])))
                last = place
                time.sleep(0.001)

    def end(self) -> None:
        self._ends = True
        self._thread.join()


@contextmanager
def simulator() -> Iterator[int]:
    """Yield the port of a `yarc sim`."""
    with subprocess.Popen([sys.executable, "-c", SIMULATOR], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            said = re.search(r":(\d+),", process.stdout.readline())
            assert said is not None
            yield int(said[1])
        finally:
            process.terminate()


async def do(client: Client, text: str) -> None:
    """Send an offer and run it."""
    made = await client.motion.offer(text)
    assert made.value is not None, made.diagnostics
    ended = await client.motion.go(made.value)
    assert ended.well, ended


async def enter(client: Client, port: int, lines: tuple[str, str], rounds: int) -> list[float]:
    """Return the times from a line to the first motion [s]."""
    found = []
    for number in range(rounds):
        watch = Watch(port)
        await asyncio.sleep(0.1)
        begun = time.perf_counter()
        await do(client, lines[number % 2])
        watch.end()
        found.append(watch.moved_at - begun)
    return found


def turning(speed: float) -> JointVelocity:
    """Return the velocity of J1 [deg/s] as a request."""
    velocity = np.zeros(6)
    velocity[0] = np.deg2rad(speed)
    return JointVelocity(velocity)


async def jog(client: Client, port: int, rounds: int) -> tuple[list[float], list[float], list[float]]:
    """Return the times [s] from a key to the first motion, from a request for the opposite direction to the
    reversal, and from a stop to rest.
    """
    first, changed, rested = [], [], []
    for number in range(rounds):
        side = 1.0 if number % 2 else -1.0
        watch = Watch(port)
        await asyncio.sleep(0.1)
        begun = time.perf_counter()
        drive = (await client.live.drive(turning(3.0 * side))).value
        assert drive is not None
        for _ in range(40):
            if drive.alive:
                drive.want(turning(3.0 * side))
            await asyncio.sleep(0.02)
        turned = time.perf_counter()
        for _ in range(40):
            if drive.alive:
                drive.want(turning(-3.0 * side))
            await asyncio.sleep(0.02)
        stopped, held = time.perf_counter(), not drive.alive
        drive.stop()
        await drive.ended()
        await asyncio.sleep(0.2)
        watch.end()
        first.append(watch.moved_at - begun)
        times, places = np.array(watch.places).T
        farthest = float(times[int(np.argmax(side * places))])
        if held or watch.rested_at < stopped or farthest < turned:
            continue  # this process was too late, and the robot was held
        rested.append(watch.rested_at - stopped)
        changed.append(farthest - turned)
    return first, changed, rested


async def attach(path: Path) -> list[float]:
    """Return the times from connecting to the first event [s], of clients in a thread."""

    def attached() -> float:
        begun = time.perf_counter()
        with Robot(str(path), name="bench") as robot:
            next(robot.events(positions=True))
        return time.perf_counter() - begun

    return [await asyncio.to_thread(attached) for _ in range(21)]


async def stream(client: Client, seconds: float) -> tuple[int, float]:
    """Return the number of positions that one subscriber receives, and the share of a core that this process
    uses.
    """
    events, count = client.session.events(), 0
    cpu, begun = time.process_time(), time.perf_counter()
    while time.perf_counter() - begun < seconds:
        count += isinstance(await events.next(), Position)
    used = (time.process_time() - cpu) / (time.perf_counter() - begun)
    events.close()
    return round(count / seconds), used


async def measure(port: int, rounds: int) -> None:
    """Print all tables."""
    robot = load_robot(ROBOT).value
    assert robot is not None
    session = OrderedSession("127.0.0.1", port, reply_time=20.0)
    async with Coordinator(robot, session, folder=Path.cwd(), log=NO_LOG) as coordinator:
        client = coordinator.attach("bench")
        client.session.own()
        await do(client, "MOVEJ 0 10 10 0 40 0 [3] (deg,s)")
        print("| from | to | median | most | goal |\n|---|---|---|---|---|")
        for name, lines in LINES.items():
            told("Enter, " + name, "first motion", await enter(client, port, lines, rounds), "150 ms")
        first, changed, rested = await jog(client, port, rounds)
        told("a key", "first motion of a jog, TM 10", first, "120 ms")
        told("the other way is wanted", "it turns back", changed, "stated: 0.35 s and braking")
        told("a stop", "rest", rested, "hold time 250 ms")
        async with ControlSocket(coordinator) as control:
            told("connecting to the socket", "first event", await attach(control.path), "100 ms")
        print("\n| event stream | positions a second | of a core | goal |\n|---|---|---|---|")
        rate, used = await stream(client, 4.0)
        print(f"| at rest | {rate} | {used:.1%} | 10 % |")
        going = asyncio.create_task(do(client, "MOVEJ 30 10 10 0 40 0 [6] (deg,s)"))
        await asyncio.sleep(0.5)
        rate, used = await stream(client, 4.0)
        print(f"| in motion, TM 50 | {rate} | {used:.1%} | 10 % |")
        await going


def told(begin: str, end: str, found: list[float], goal: str) -> None:
    """Print one row."""
    if not found:
        print(f"| {begin} | {end} | - | - | {goal} |")
        return
    median, most = (f"{value * 1e3:.0f} ms" for value in (statistics.median(found), max(found)))
    print(f"| {begin} | {end} | {median} | {most} | {goal} |")


def main() -> None:
    """Measure, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=11)
    rounds = parser.parse_args().rounds
    with simulator() as port:
        asyncio.run(measure(port, rounds))


if __name__ == "__main__":
    main()
