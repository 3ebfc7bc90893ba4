"""Measure the simulator's speed: `python benchmarks/simulator.py [--seconds S] [--rounds N]`.

First, the time of a program: Listing 4 for INDUSTRIAL6 at TM 5, 8,000 segments, in a commissioned machine
whose guard PLC runs. The time is from `R` to the end, for a program buffer and for a rotary buffer that is
refilled line by line. Goal: 100 times real time.

Then round trips through its socket, from a client with a blocking socket in this process to a `yarc sim` in a
separate process, over loopback. They alternate with a plain asyncio server that answers any bytes at once,
which is the best that this computer can do. Goal: 20,000 questions a second. Medians of the rounds.
"""

from __future__ import annotations

import argparse
import re
import socket
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline import stages
from yarclang.robot.description import load_robot
from yarclang.runtime.pmac.protocol import Answer, Ask, Connection, Request, Write, Written, encode
from yarclang.simulator.commissioning import commissioned
from yarclang.simulator.machine import Machine
from yarclang.simulator.network.ethernet import PacketReader, Station
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

GOAL = 20_000
TIMES_GOAL = 100
LISTING = Path(__file__).resolve().parents[1] / "examples" / "01_listing4.yarc"
SIMULATOR = "from yarclang.cli.yarc import main; main(['sim', '--port', '0'])"
ECHO = """
import asyncio
class Echo(asyncio.Protocol):
    def connection_made(self, transport): self.transport = transport
    def data_received(self, data): self.transport.write(b"0\\r\\x06")
async def main():
    server = await asyncio.get_running_loop().create_server(Echo, "127.0.0.1", 0)
    print(f"127.0.0.1:{server.sockets[0].getsockname()[1]},", flush=True)
    await server.serve_forever()
asyncio.run(main())
"""
LINES = tuple(f"P{number}={number * 0.5}" for number in range(60))


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    print("| what | wall | times real time | goal |\n|---|---|---|---|")
    for what, target, wait in (("PROG", "prog", play), ("rotary, refilled", "rotary", refill)):
        duration, lines = listing(target)
        wall = statistics.median(wait(duration, lines) for _ in range(options.rounds))
        print(f"| Listing 4 at TM 5, {what} | {wall:.3f} s | {duration / wall:.0f} | {TIMES_GOAL} |")
    print()
    print("| what | a second | lines a second | goal |\n|---|---|---|---|")
    with child(SIMULATOR) as port, child(ECHO) as echo_port:
        ask, echo = client(port), bare_client(echo_port)
        tasks: list[tuple[str, Callable[[], None], int]] = [
            ("a bare echo on loopback", echo, 1),
            ("question `P1` on loopback", lambda: ask(Ask("P1")), 1),
            ("question `#1P#2P#3P#4P#5P#6P`", lambda: ask(Ask("#1P#2P#3P#4P#5P#6P")), 1),
            (f"WRITEBUFFER of {len(LINES)} assignments", lambda: ask(Write(LINES)), len(LINES)),
            ("both codecs without a socket", both_codecs(), 1),
            ("the machine alone, `P1`", machine(), 1),
        ]
        rates: list[list[float]] = [[] for _ in tasks]
        for _ in range(options.rounds):
            for (_, work, _), found in zip(tasks, rates, strict=True):
                found.append(per_second(work, options.seconds))
    for (what, _, lines), found in zip(tasks, rates, strict=True):
        rate = statistics.median(found)
        goal = f"{GOAL:,}" if what.startswith("question") else ""
        print(f"| {what} | {rate:,.0f} | {rate * lines:,.0f} | {goal} |")


def listing(target: Literal["prog", "rotary"]) -> tuple[float, list[str]]:
    """Return the duration [s] and the lines of Listing 4 at TM 5."""
    module = parse(SourceFile(LISTING.name, LISTING.read_text())).value
    robot = load_robot("INDUSTRIAL6").value
    assert module is not None
    assert robot is not None
    compiled = stages.compile_module(module, stages.Request(robot, target=target, tm=5.0)).value
    assert compiled is not None
    return compiled.certificate.duration, [x for x in compiled.text.splitlines() if not x.startswith(";")]


def tell(machine: Machine, line: str) -> tuple[str, ...]:
    """Return the machine's answer."""
    reply = machine.command(line)
    assert reply.error is None, (line, reply)
    return reply.items


def ready() -> Machine:
    """Return a machine at Listing 4's start."""
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    return commissioned(robot, settings_text(robot))


def play(duration: float, lines: list[str]) -> float:
    """Return the seconds of a program that was loaded beforehand."""
    machine = ready()
    for line in lines:
        tell(machine, line)
    tell(machine, "B1")
    begun = time.perf_counter()
    tell(machine, "R")
    machine.advance(duration - 1.0)
    assert machine.systems[1].running
    machine.advance(1.5)
    passed = time.perf_counter() - begun
    assert not machine.systems[1].running
    return passed * duration / (duration + 0.5)


def refill(duration: float, lines: list[str]) -> float:
    """Return the seconds for a rotary, including the reading of lines."""
    machine = ready()
    rest = iter(lines)
    line = next(rest)
    begun = time.perf_counter()
    running = False
    while True:
        if machine.command(line).error is None:
            if (line := next(rest, "")) == "":
                break
            continue
        if not running:
            tell(machine, "R")
            running = True
        machine.advance(0.05)
    while tell(machine, "PR") != ("0",):
        machine.advance(0.05)
    passed = time.perf_counter() - begun
    assert abs(machine.now - duration) < 3.0, machine.now
    assert tell(machine, "P8100") == ("0",), "the guard held it"
    return passed * duration / machine.now


@contextmanager
def child(code: str) -> Iterator[int]:
    """Yield the port that a server in a process of its own prints."""
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            said = re.search(r":(\d+),", process.stdout.readline())
            assert said is not None, "the server doesn't say where it listens"
            yield int(said[1])
        finally:
            process.terminate()


def bare_client(port: int) -> Callable[[], None]:
    """Return a function that sends the bytes of a question and waits for those of a reply."""
    wire = connect(port)
    question = encode(Ask("P1"))

    def ask() -> None:
        wire.sendall(question)
        wire.recv(65536)

    return ask


def connect(port: int) -> socket.socket:
    """Return a socket that sends without delay."""
    wire = socket.create_connection(("127.0.0.1", port), timeout=10)
    wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return wire


def client(port: int) -> Callable[[Request], None]:
    """Return a function that sends a question and waits for the reply."""
    wire, connection = connect(port), Connection()

    def ask(request: Request) -> None:
        wire.sendall(connection.send(request, 0.0, 1.0))
        while not (events := connection.receive(wire.recv(65536), 0.0)):
            if more := connection.outgoing():
                wire.sendall(more)
        (event,) = events
        if not isinstance(event, Answer | Written) or event.error is not None:
            raise SystemExit(f"{request}: {event}")

    ask(Ask("I6=1 I3=2"))
    return ask


def both_codecs() -> Callable[[], None]:
    """Return a function that passes a question from end to end in this process."""
    station, reader, connection = Station(Machine(), 0), PacketReader(), Connection()
    station.answer(reader.receive(encode(Ask("I6=1 I3=2")))[0])
    ask = Ask("P1")

    def work() -> None:
        (packet,) = reader.receive(connection.send(ask, 0.0, 1.0))
        (event,) = connection.receive(station.answer(packet), 0.0)
        assert isinstance(event, Answer)

    return work


def machine() -> Callable[[], None]:
    """Return a function that asks the machine a question, without the protocol."""
    one = Machine()
    return lambda: one.command("P1") and None


def per_second(work: Callable[[], None], seconds: float) -> float:
    """Return the calls in a second."""
    done, begun = 0, time.perf_counter()
    while (passed := time.perf_counter() - begun) < seconds:
        for _ in range(50):
            work()
        done += 50
    return done / passed


if __name__ == "__main__":
    main()
