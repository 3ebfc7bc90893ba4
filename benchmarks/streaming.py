"""Measure the runtime's speed: `python benchmarks/streaming.py [--rounds N]`.

- Program lines a second, by WRITEBUFFER and by dls-pmaclib, which sends one command at a time. Both write to
  the same program buffer of a `yarc sim` in a separate process, without a delay, and with 1 ms on each reply
  as on a controller. Goal: 20 times.
- The time until a stop is sent, if no reply is awaited, and if one is. Goal: 5 ms (p99).
- Ten minutes of motion at TM 5 with a random delay of up to 20 ms on each reply, in virtual time, without low
  water and underrun. Also the smallest TM that works.
- An hour of motion, run repeatedly: memory after ten minutes and after sixty.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import re
import socket
import statistics
import subprocess
import sys
import time
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

sys.path.pop(0)  # this folder's simulator.py would hide the folder of the same name there
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from runtime.virtual import World

from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.stages import compile_module
from yarclang.robot.description import load_robot
from yarclang.runtime.job import Job
from yarclang.runtime.notices import Hold, Remark, Resume, Stop
from yarclang.runtime.pmac.messages import Ask, Write, Written
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.runtime.pmac.protocol import Connection, fitting
from yarclang.runtime.session import Session
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import commissioned
from yarclang.source import SourceFile

LISTING = Path(__file__).resolve().parents[1] / "examples" / "01_listing4.yarc"
SIMULATOR = "from yarclang.cli.yarc import main; main(['sim', '--port', '0', *{options!r}])"
ROBOT = "INDUSTRIAL6"
TO_AND_FRO = "P{a} MOVEJ 20 10 -20 30 20 15 [10] (deg,s)\nP{b} MOVEJ 0 0 0 0 0 0 [10] (deg,s)\n"


def main() -> None:
    """Measure, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    rounds = parser.parse_args().rounds
    print("| lines a second | dls-pmaclib | WRITEBUFFER | times | goal |\n|---|---|---|---|---|")
    for what, options in (("no delay", []), ("1 ms on each reply", ["--fault", "slow:0.001"])):
        theirs, ours = zip(*(streaming(options) for _ in range(rounds)), strict=True)
        one, other = statistics.median(theirs), statistics.median(ours)
        print(f"| Listing 4, {what} | {one:,.0f} | {other:,.0f} | {other / one:.1f} | 20 |")
    print("\n| a stop gets to the wire | median | p99 | goal |\n|---|---|---|---|")
    for what, options in (
        ("nothing awaited", []),
        ("behind a reply of 1 to 20 ms", ["--fault", "slow:0.001-0.02"]),
    ):
        found = sorted(asyncio.run(latencies(options, 40 * rounds)))
        p99 = found[int(len(found) * 0.99)]
        print(f"| {what} | {statistics.median(found) * 1e3:.2f} ms | {p99 * 1e3:.2f} ms | 5 ms |")
    print("\n| up to 20 ms on each reply | motion | low water | underruns |\n|---|---|---|---|")
    for tm in (5.0, 4.5):
        duration, low, underruns = delayed(tm, 600.0)
        print(f"| TM {tm:g} | {duration:.0f} s | {low} | {underruns} |")
    print(f"\nsmallest TM without low water in a minute: {smallest():.3g} ms")
    ten, sixty = hour()
    print(f"memory after 10 minutes {ten / 1e6:.2f} MB, after 60 {sixty / 1e6:.2f} MB")


def job_at(tm: float, text: str) -> Job:
    """Return a program at a segment time [ms]."""
    opened = open_source(SourceFile("bench.yarc", text), Path.cwd(), Options(robot=ROBOT, tm=tm)).value
    assert opened is not None
    compiled = compile_module(opened.module, opened.request).value
    assert compiled is not None
    job = job_of_compiled(compiled, "bench")
    assert job is not None
    return job


@contextmanager
def simulator(options: list[str]) -> Iterator[int]:
    """Yield the port of a `yarc sim`."""
    code = SIMULATOR.format(options=options)
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            said = re.search(r":(\d+),", process.stdout.readline())
            assert said is not None
            yield int(said[1])
        finally:
            process.terminate()


def streaming(options: list[str]) -> tuple[float, float]:
    """Return the lines a second of dls-pmaclib, and of ours."""
    from dls_pmaclib.dls_pmacremote import PmacEthernetInterface

    lines = [line for line in job_at(50.0, LISTING.read_text()).lines if line[0] == "X"]
    with simulator(options) as port:
        peer = PmacEthernetInterface(timeout=3)
        peer.setConnectionParams("127.0.0.1", port)
        assert peer.connect() is None
        peer.sendCommand("CLOSE ALL")
        peer.sendCommand("OPEN PROG 1 CLEAR")
        begun = time.perf_counter()
        for line in lines:
            peer.sendCommand(line)
        theirs = len(lines) / (time.perf_counter() - begun)
        peer.sendCommand("CLOSE")
        peer.disconnect()
        with socket.create_connection(("127.0.0.1", port)) as wire:
            wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            connection = Connection()

            def ask(request: Ask | Write) -> object:
                wire.sendall(connection.send(request, 0.0, 9.0))
                while not (events := connection.receive(wire.recv(65536), 0.0)):
                    pass
                return events[0]

            ask(Ask("I6=1 I3=2"))
            ask(Ask("OPEN PROG 1 CLEAR"))
            begun, at = time.perf_counter(), 0
            while at < len(lines):
                count = fitting(lines, at)
                written = ask(Write(tuple(lines[at : at + count])))
                assert isinstance(written, Written)
                assert written.error is None
                at += count
            ours = len(lines) / (time.perf_counter() - begun)
    return theirs, ours


async def latencies(options: list[str], count: int) -> list[float]:
    """Return the seconds from an order to its bytes on the wire, while a program is streamed."""
    job = job_at(50.0, "".join(TO_AND_FRO.format(a=2 * k + 1, b=2 * k + 2) for k in range(200)))
    found: list[float] = []
    with simulator(["--robot", ROBOT, *options]) as port:
        session = Session("127.0.0.1", port)
        await session.perform(connect(session.operation))
        run = asyncio.create_task(session.perform(perform(session.operation, job)))
        while session.operation.state is not State.MOVE:
            await asyncio.sleep(0.01)
        wire = session._wire
        assert wire is not None
        plain, arrive = wire.send, wire.data_received
        ordered = arrived = 0.0

        def spy(data: bytes) -> None:
            nonlocal ordered
            if ordered:
                assert data.endswith(b"H"), "another request went before the order"
                found.append(time.perf_counter() - max(ordered, arrived))
                ordered = 0.0
            plain(data)

        def note(data: bytes) -> None:
            nonlocal arrived
            arrived = time.perf_counter()
            arrive(data)

        wire.send = spy  # type: ignore[method-assign]
        wire.data_received = note  # type: ignore[method-assign]
        for _ in range(count):
            await asyncio.sleep(random.uniform(0.03, 0.08))
            ordered = time.perf_counter()
            session.order(Hold())
            while session.operation.state is not State.HOLD:
                await asyncio.sleep(0.01)
            await asyncio.sleep(2.0 * job.robot.controller.hold_time)
            session.order(Resume())
            while session.operation.state is not State.MOVE:
                await asyncio.sleep(0.01)
        await asyncio.sleep(0.1)
        wire.send = plain  # type: ignore[method-assign]
        session.order(Stop())
        await run
        session.close()
    return found


def world(delay: float = 0.0) -> World:
    """Return a commissioned machine and the runtime, in virtual time."""
    robot = load_robot(ROBOT).value
    assert robot is not None
    chance = random.Random(1)
    made = World(commissioned(robot, settings_text(robot)), delay=lambda: chance.uniform(0.0, delay) or 1e-4)
    made.perform(connect(made.operation))
    return made


def delayed(tm: float, seconds: float) -> tuple[float, int, int]:
    """Return the time of motion [s], and the numbers of low waters and underruns."""
    job = job_at(tm, "".join(TO_AND_FRO.format(a=2 * k + 1, b=2 * k + 2) for k in range(3)))
    made = world(0.02)
    done, low, dry = 0.0, 0, 0
    while done < seconds:
        ended = made.perform(perform(made.operation, job))
        low += sum(isinstance(one, Remark) and "ran low" in one.text for one in made.told)
        dry += "underrun" in ended.what
        made.told.clear()
        if not ended.well:
            break
        done += job.duration
    return done, low, dry


def smallest() -> float:
    """Return the smallest TM [ms] at which a minute passes without low water."""
    held = 5.0
    for tm in (4.5, 4.0):  # 4 ms: the controller's own limit, three real-time interrupts at I8=2
        done, low, dry = delayed(tm, 60.0)
        if low or dry or done < 60.0:
            break
        held = tm
    return held


def hour() -> tuple[int, int]:
    """Return the bytes that Python keeps after ten minutes of motion, and after sixty."""
    job = job_at(50.0, "".join(TO_AND_FRO.format(a=2 * k + 1, b=2 * k + 2) for k in range(15)))
    made = world()
    tracemalloc.start()
    kept: list[int] = []
    done = 0.0
    for until in (600.0, 3600.0):
        while done < until:
            assert made.perform(perform(made.operation, job)).well
            made.told.clear()
            done += job.duration
        kept.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    return kept[0], kept[1]


if __name__ == "__main__":
    main()
