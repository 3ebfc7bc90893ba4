"""Cause faults during runs, and measure the reactions: `python benchmarks/faults.py [WORDS ..] [--instants N]
[--json FILE]`.

For each fault there are a new `yarc run` and a new `yarc sim`, in separate processes, with a proxy between
them that can delay, pause, cut and change packets. A second connection reads the motors' commanded positions
each 5 ms; it is also the other client that sends harmful lines. The results for each fault are:

- the time at which the fault was noticed: by the run's hold on the wire, by the run's message, or by the hold
  of the guard PLC, whichever is first;
- the time at which the robot was at rest, and its largest distance from the programmed path until then, in
  counts of the worst motor;
- the run's messages and its exit status (with * if a SIGTERM ended the run after the fault was watched).

With WORDS, only the faults are tried whose names contain one of the words. With `--instants N`, only the
death of the host is tried: kill -9 and SIGSTOP at N instants each, at TM 5 and TM 50. Both processes are
forked from one that has imported yarclang, which saves the second that Python takes to start.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import multiprocessing
import os
import pkgutil
import re
import shutil
import signal
import socket
import struct
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import pairwise
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

import yarclang
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.stages import compile_module
from yarclang.pmac import requests as pmac
from yarclang.pmac.requests import Code
from yarclang.robot.actuation import to_counts
from yarclang.source import SourceFile

ROBOT = "INDUSTRIAL6"
PROGRAM = """P0010 MOVEJ_LSPB 20 -10 15 5 20 -15 [2] (deg,s)
P0020 MOVEJ_LSPB 10 5 -12 10 -5 -20 [2] (deg,s)
P0030 MOVEJ_LSPB 20 -10 15 5 20 -15 [2] (deg,s)
P0040 MOVEJ_LSPB 10 5 -12 10 -5 -20 [2] (deg,s)
P0050 MOVEJ_POLY5 0 0 0 0 0 0 [2] (deg,s)
"""
MOTORS = 6
COUNTS = 96 * 32
"""Units of the position registers in a count."""

EACH = 0.005
"""Time between two readings of the motors [s]."""

STILL, STANDS = 0.02, 0.05
"""Distance [counts] below which a motor counts as at rest, for this time [s]."""

SAYS_HOLD = re.compile(r'hold: |\{"event": "state", .*"state": "hold"')
HOLD_TIME = 0.45
"""The robot's hold time, plus an allowance for a busy computer [s]."""

LOST_AFTER = 3.0
"""Time after which a robot that still moves without an order counts as lost [s]."""

OFF = 1.0
"""Allowed distance from the path of a robot that has to stay on it [counts]."""

REPLIED = b"\x06"
HOLDS = re.compile(rb"(&\d+)?H")
PROGRESS = re.compile(
    r"^(P\d+ \w+ +[\d.]+ s to|.* s left  J1|(init|move|stop): |(init|move|stop)$|\s*$)"
    r'|^\{"event": ?"(progress|position|listening|command|pass|busy)"'
    r'|^\{"event": ?"state", ?"state": ?"(init|move|stop)"'
)


# processes


def _work(arguments: Sequence[str], output: str, folder: str) -> None:
    """Run a `yarc` whose output goes to a file."""
    out = os.open(output, os.O_WRONLY)
    for number in (1, 2):
        os.dup2(out, number)
    sys.stdout = open(1, "w", buffering=1, closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", buffering=1, closefd=False)  # noqa: SIM115
    os.chdir(folder)
    from yarclang.cli.yarc import main

    main(list(arguments))


def imported() -> list[str]:
    """Return the modules that both processes need."""
    parts = (
        "cli.commands.run",
        "cli.commands.sim",
        "cli.",
        "runtime.",
        "simulator.",
        "pipeline.",
        "motion.",
        "certify.",
        "semantics.",
    )
    found = [module.name for module in pkgutil.walk_packages(yarclang.__path__, "yarclang.")]
    ours = [name for name in found if name.removeprefix("yarclang.").startswith(parts)]
    return ["pinocchio", "coal", "scipy.linalg", "scipy.spatial", "asyncio", *ours, "__main__"]


class Yarc:
    """A `yarc` in a process of its own. `said` has each printed line with its time."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.said: list[tuple[float, str]] = []
        place = Path(tempfile.mkdtemp(dir=folder)) / "output"
        os.mkfifo(place)
        context = multiprocessing.get_context("forkserver")
        self.process: BaseProcess = context.Process(target=_work, args=(arguments, str(place), str(folder)))
        self._reader = threading.Thread(target=self._read, args=(place,), daemon=True)
        self._reader.start()
        self.process.start()

    def _read(self, place: Path) -> None:
        with place.open(errors="replace") as lines:
            for line in lines:
                self.said += [(time.monotonic(), part) for part in re.split(r"[\r\n]+", line) if part.strip()]

    def send(self, number: int) -> None:
        """Send a signal."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.process.pid or 0, number)

    @property
    def ended(self) -> bool:
        """True if the process has ended."""
        return self.process.exitcode is not None

    def wait(self, seconds: float) -> int | None:
        """Wait for the end, and return the exit status; None if the process continues."""
        self.process.join(seconds)
        if self.ended:
            self._reader.join(0.5)
        return self.process.exitcode

    def kill(self) -> None:
        """Kill the process."""
        self.send(signal.SIGKILL)
        self.process.join(5.0)


def wait_for(true: Callable[[], object], seconds: float, what: str) -> None:
    """Wait until a condition is true.

    Raises:
        TimeoutError: the condition isn't true in time.
    """
    until = time.monotonic() + seconds
    while not true():
        if time.monotonic() > until:
            raise TimeoutError(what)
        time.sleep(0.002)


# the link


@dataclass
class Pair:
    """A connection of the run, and the corresponding one to the simulator."""

    client: socket.socket
    server: socket.socket
    deaf: bool = False

    def close(self) -> None:
        """Close both."""
        for wire in (self.client, self.server):
            with contextlib.suppress(OSError):
                wire.shutdown(socket.SHUT_RDWR)
            wire.close()


class Proxy:
    """A link whose behaviour can be changed.

    Attributes:
        seen: each packet of the run, with its time.
        open: while cleared, nothing is passed in either direction.
        delay: of each reply [s].
        rate: in both directions [bytes/s]; 0 for no limit.
        spoil: changes a reply; empty bytes are not sent.
        change: changes a packet of the run.
    """

    def __init__(self, target: int) -> None:
        self.seen: list[tuple[float, bytes]] = []
        self.open = threading.Event()
        self.open.set()
        self.delay = self.rate = 0.0
        self.spoil: Callable[[bytes], bytes] | None = None
        self.change: Callable[[bytes], bytes] | None = None
        self._target = target
        self._pairs: list[Pair] = []
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._listen()

    def _listen(self) -> None:
        threading.Thread(target=self._accept, args=(self._listener,), daemon=True).start()

    def _accept(self, listener: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while True:
                client, _ = listener.accept()
                self.open.wait()
                time.sleep(0.02)  # the controller accepts two connections: first close the previous one
                server = socket.create_connection(("127.0.0.1", self._target))
                for wire in (client, server):
                    wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    wire.settimeout(0.05)
                pair = Pair(client, server)
                self._pairs.append(pair)
                for work in (self._up, self._down):
                    threading.Thread(target=work, args=(pair,), daemon=True).start()

    def _received(self, wire: socket.socket) -> Iterator[bytes]:
        """Yield the received bytes, until the end of the connection."""
        while True:
            try:
                data = wire.recv(65536)
            except TimeoutError:
                continue
            except OSError:
                return
            if not data:
                return
            yield data

    def _up(self, pair: Pair) -> None:
        kept = b""
        for data in self._received(pair.client):
            kept += data
            while packet := _first_packet(kept):
                kept = kept[len(packet) :]
                self.seen.append((time.monotonic(), packet))
                self.open.wait()
                if self.change is not None:
                    packet = self.change(packet)
                self._pass(pair, pair.server, packet)
        self.open.wait()
        if not pair.deaf:
            pair.close()

    def _down(self, pair: Pair) -> None:
        for data in self._received(pair.server):
            self.open.wait()
            if self.delay:
                time.sleep(self.delay)
            reply = self.spoil(data) if self.spoil is not None else data
            self._pass(pair, pair.client, reply)
        self.open.wait()
        if not pair.deaf:
            pair.close()

    def _pass(self, pair: Pair, wire: socket.socket, data: bytes) -> None:
        if self.rate:
            time.sleep(len(data) / self.rate)
        if data and not pair.deaf:
            with contextlib.suppress(OSError):
                wire.sendall(data)

    # faults of the link

    def pause(self, seconds: float) -> None:
        """Pass nothing for a time."""
        self.open.clear()
        threading.Timer(seconds, self.open.set).start()

    def cut(self, back_after: float | None = None) -> None:
        """Close all connections and accept no more, or accept them again after a time."""
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self.drop()
        if back_after is not None:
            threading.Timer(back_after, self._back).start()

    def _back(self) -> None:
        self._listener = socket.create_server(("127.0.0.1", self.port))
        self._listen()

    def drop(self) -> None:
        """Close all connections."""
        for pair in self._pairs:
            pair.close()

    def reset(self) -> None:
        """End all connections with RST."""
        for pair in self._pairs:
            for wire in (pair.client, pair.server):
                with contextlib.suppress(OSError):
                    wire.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                wire.close()

    def half_open(self) -> None:
        """Forget all connections without closing them towards the run. New ones work normally."""
        for pair in self._pairs:
            pair.deaf = True
            with contextlib.suppress(OSError):
                pair.server.shutdown(socket.SHUT_RDWR)
            pair.server.close()

    def lose_replies(self, count: int) -> None:
        """Drop the next replies."""
        left = iter(range(count))
        self.spoil = lambda data: b"" if next(left, None) is not None else data

    def garble(self, count: int, place: int = 0) -> None:
        """Change one byte of each of the next replies."""
        left = iter(range(count))

        def wrong(data: bytes) -> bytes:
            if next(left, None) is None:
                return data
            at = place % len(data)
            return data[:at] + bytes((data[at] ^ 0x15,)) + data[at + 1 :]

        self.spoil = wrong

    def change_digit(self) -> None:
        """Change one digit of a line, in the middle of the next packet of lines."""

        def changed(packet: bytes) -> bytes:
            if packet[1] != Code.WRITEBUFFER or packet.count(b"\0X") < 3:
                return packet
            self.change = None
            lines = packet[pmac.HEADER_SIZE :].split(b"\0")
            row = len(lines) // 2
            digits = [found.start() for found in re.finditer(rb"\d", lines[row])]
            at = digits[1]
            digit = b"7" if lines[row][at : at + 1] != b"7" else b"2"
            lines[row] = lines[row][:at] + digit + lines[row][at + 1 :]
            return packet[: pmac.HEADER_SIZE] + b"\0".join(lines)

        self.change = changed

    def holds_after(self, since: float) -> float | None:
        """Return the time at which the run has sent H, ^O or ^A after a given time; None if it hasn't."""
        for when, packet in list(self.seen):
            if when >= since and _holds(packet):
                return when
        return None

    def close(self) -> None:
        """Close everything."""
        self.open.set()
        self.cut()


def _first_packet(data: bytes) -> bytes:
    if len(data) < pmac.HEADER_SIZE:
        return b""
    direction, _, _, _, length = struct.unpack_from(pmac.HEADER, data)
    size = pmac.HEADER_SIZE + (length if direction == pmac.DOWN else 0)
    return data[:size] if len(data) >= size else b""


def _holds(packet: bytes) -> bool:
    if packet[1] == Code.SENDCTRLCHAR:
        return packet[3] in (0x01, 0x0F)
    return packet[1] == Code.GETRESPONSE and HOLDS.fullmatch(packet[pmac.HEADER_SIZE :]) is not None


# another client


class Other:
    """Another client, which reads the motors every 5 ms and sends given lines.

    Attributes:
        looks: time, override [%], the guard's flag, the watchdog's flag, and the commanded positions [counts]
            of each reading.
        refused: lines that the controller has refused, with its errors.
    """

    _LOOK = "%P8100P8104" + "".join(f"M{7101 + row}" for row in range(MOTORS))

    def __init__(self, port: int) -> None:
        self.looks: list[tuple[float, ...]] = []
        self.refused: list[str] = []
        self._lock = threading.Lock()
        self._port = port
        self._connect()
        self._ends = False
        self.say("I6=1I3=2")
        for row in range(MOTORS):
            self.say(f"M{7101 + row}->D:${0x88 + 0x80 * row:06X}")
        self.say("SAVE", 5.0)  # so that a reset doesn't stop our readings
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _connect(self) -> None:
        self._wire = socket.create_connection(("127.0.0.1", self._port))
        self._wire.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def say(self, line: str, seconds: float = 0.5) -> bytes:
        """Send a line, or a control character as ^D; return the reply."""
        with self._lock:
            if line.startswith("^"):
                packet = struct.pack(pmac.HEADER, pmac.DOWN, Code.SENDCTRLCHAR, ord(line[1]) - 64, 0, 0)
            else:
                data = line.encode()
                packet = struct.pack(pmac.HEADER, pmac.DOWN, Code.GETRESPONSE, 0, 0, len(data)) + data
            reply = self._exchange(packet, 99, seconds)
        if error := re.search(rb"ERR\d+", reply):
            self.refused.append(f"{line}: {error[0].decode()}")
        return reply

    def write(self, *lines: str) -> None:
        """Send lines in one packet."""
        data = b"".join(line.encode() + b"\0" for line in lines)
        with self._lock:
            self._exchange(
                struct.pack(pmac.HEADER, pmac.DOWN, Code.WRITEBUFFER, 0, 0, len(data)) + data, 99, 0.1
            )

    def _exchange(self, packet: bytes, items: int, seconds: float) -> bytes:
        wire = self._wire
        wire.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while wire.recv(65536):
                pass
        wire.settimeout(seconds)
        wire.sendall(packet)
        reply = b""
        with contextlib.suppress(TimeoutError):
            while True:
                reply += (more := wire.recv(65536))
                if not more:
                    raise ConnectionError("the simulator has closed the connection")
                ended = reply.endswith(REPLIED) or len(reply) == 1 or b"\x07" in reply
                if ended or reply.count(b"\r") >= items or packet[1] == Code.WRITEBUFFER:
                    break
        return reply

    def _watch(self) -> None:
        data = self._LOOK.encode()
        packet = struct.pack(pmac.HEADER, pmac.DOWN, Code.GETRESPONSE, 0, 0, len(data)) + data
        due = time.monotonic()
        while not self._ends:
            begun = time.monotonic()
            try:
                with self._lock:
                    reply = self._exchange(packet, 3 + MOTORS, 0.5)
                words = reply.strip(REPLIED + b"\r\n").split()
                values = [float(word) for word in words]
            except ValueError:
                values = []
            except OSError:
                values = []
                with contextlib.suppress(OSError):
                    self._wire.close()
                    self._connect()
            if len(values) == 3 + MOTORS:
                middle = (begun + time.monotonic()) / 2.0
                self.looks.append((middle, *values[:3], *(value / COUNTS for value in values[3:])))
            due = max(due + EACH, begun + 0.002)
            time.sleep(max(0.0, due - time.monotonic()))

    def stands_since(self, since: float) -> float | None:
        """Return the time at which the motors have come to rest after a given time, for at least 50 ms; None
        if they haven't.
        """
        looks = self.looks[-2000:]
        first: float | None = None
        for before, after in pairwise(looks):
            if after[0] < since:
                continue
            if max(abs(a - b) for a, b in zip(before[4:], after[4:], strict=True)) > STILL:
                first = None
            elif first is None:
                first = max(before[0], since)
            elif after[0] - first >= STANDS:
                return first
        return None

    @property
    def moves(self) -> bool:
        """True if a motor is moving."""
        one, other = self.looks[-6:-5], self.looks[-1:]
        return bool(one) and max(abs(a - b) for a, b in zip(one[0][4:], other[0][4:], strict=True)) > STILL

    def close(self) -> None:
        """End the connection."""
        self._ends = True
        self._thread.join(2.0)
        self._wire.close()


# faults


@dataclass(frozen=True)
class Fault:
    """A fault.

    Attributes:
        name: description of the fault.
        do: causes it; None if the simulator does, by `options`.
        kind: others, link, host or motor.
        within: time within which it has to be noticed [s]; None if the run needn't notice it.
        goes_on: True if the run may continue by itself.
        off: True if the robot may leave its path.
        held: True to cause it during a hold.
        tm: segment time [ms].
        after: time of the fault after R [s].
        watch: longest time for which its effects are watched [s].
        options: of the simulator.
        undo: lines that repair it; then the run is resumed, and must come to its end.
        work: the `yarc` that streams: run, exec, or follow with a master that moves joint 1.
        brief: True to measure only the time to rest; a suspended process isn't resumed.
    """

    name: str
    do: Callable[[Scene], None] | None
    kind: str
    within: float | None = None
    goes_on: bool = False
    off: bool = False
    held: bool = False
    tm: float = 5.0
    after: float = 0.8
    watch: float = 3.5
    options: tuple[str, ...] = ()
    undo: tuple[str, ...] = ()
    work: str = "run"
    brief: bool = False


@dataclass
class Found:
    """Result of a fault. Times are from the fault on [s]; `off` and `off_later` are in counts, until rest and
    until the end of the watch.
    """

    name: str
    tm: float
    noticed: float | None = None
    by: str = ""
    rest: float | None = None
    to_its_end: bool = False
    off: float = 0.0
    off_later: float = 0.0
    said: str = ""
    status: str = ""
    wrong: list[str] = field(default_factory=list)
    output: list[str] = field(default_factory=list)


class Scene:
    """A simulator, a link, a run and another client; the end of the context ends all of them."""

    def __init__(self, folder: Path, tm: float, options: Sequence[str] = (), work: str = "run") -> None:
        self._folder = folder
        faults = [word for option in options for word in ("--fault", option)]
        self.simulator = Yarc(folder, "sim", "--robot", ROBOT, "--port", "0", *faults)
        wait_for(lambda: self.simulator.said, 20.0, "the simulator doesn't begin")
        port = re.search(r":(\d+),", self.simulator.said[0][1])
        assert port is not None, self.simulator.said
        self.other = Other(int(port[1]))
        self.proxy = Proxy(int(port[1]))
        to = ("--to", f"tcp://127.0.0.1:{self.proxy.port}", "--robot", ROBOT, "--no-log")
        if work == "follow":
            self.run = Yarc(folder, "follow", *to, "--unix", str(folder / "follow"))
            threading.Thread(target=self._steer, args=(folder / "follow",), daemon=True).start()
        else:
            asked = ("-y",) if work == "run" else ()
            self.run = Yarc(folder, work, "program.yarc", *to, "--tm", f"{tm:g}", *asked)

    def _steer(self, place: Path) -> None:
        """Run a master that moves motor 1."""
        with contextlib.suppress(OSError, TimeoutError), socket.socket(socket.AF_UNIX) as wire:
            wait_for(lambda: any("listening" in line for _, line in self.run.said), 20.0, "it doesn't listen")
            wire.connect(str(place))
            while True:
                wire.sendall(b'{"velocity": {"J1": 8}}\n')
                wire.recv(65536)
                time.sleep(0.02)

    def begun(self) -> float:
        """Wait for R, and return its time."""

        def sent() -> list[float]:
            found = [when for when, packet in list(self.proxy.seen) if packet[pmac.HEADER_SIZE :] == b"R"]
            if not found and self.run.ended:
                raise TimeoutError(f"the run ends before it moves: {self.run.said[-4:]}")
            return found

        wait_for(sent, 30.0, f"the run doesn't begin: {self.run.said[-3:]}")
        return sent()[0]

    def yarc(self, *arguments: str) -> Yarc:
        """Start another `yarc`."""
        return Yarc(self._folder, *arguments)

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, *_: object) -> None:
        self.run.kill()
        self.proxy.close()
        self.other.close()
        self.simulator.kill()


def says(*lines: str, **values: Any) -> Fault:
    """Return the fault that another client sends lines."""

    def do(scene: Scene) -> None:
        for line in lines:
            scene.other.say(line)

    values = {"kind": "others", **values}
    return Fault(" ".join(lines) + (" in a hold" if values.get("held") else ""), do, **values)


def link(name: str, do: Callable[[Proxy], None], **values: Any) -> Fault:
    """Return a fault of the link."""
    return Fault(name, lambda scene: do(scene.proxy), "link", **values)


def of_work(work: str, fault: Fault) -> Fault:
    """Return a fault for another `yarc`."""
    return replace(fault, name=f"{fault.name}, yarc {work}", work=work)


def signals(name: str, *steps: int | float, **values: Any) -> Fault:
    """Return the fault that the run receives signals; a float is a pause [s]."""

    def do(scene: Scene) -> None:
        def later() -> None:
            for step in steps:
                if isinstance(step, float):
                    time.sleep(step)
                else:
                    scene.run.send(step)

        threading.Thread(target=later, daemon=True).start()

    tm = f", TM {values['tm']:g}" if "tm" in values else ""
    return Fault(f"{name}{tm}", do, "host", **values)


def simulated(option: str, **values: Any) -> Fault:
    """Return a fault of the simulator."""
    return Fault(f"yarc sim --fault {option}", None, options=(option,), **values)


FLOW, SETTINGS = 0.1, 1.1
"""Time within which a change of the override or the guard has to be noticed, and that of a setting [s]."""

KILL, STOP, CONT = signal.SIGKILL, signal.SIGSTOP, signal.SIGCONT


def faults() -> list[Fault]:
    """Return all faults."""
    flow, settings = partial(says, within=FLOW), partial(says, within=SETTINGS)
    host = partial(signals, watch=3.5)
    return [
        # another client: override, guard
        flow("&1%200", undo=("&1%100",), watch=16.0),
        flow("&1%50"),
        flow("&1%0"),
        flow("&1%100.5"),
        flow("&1%200", tm=50.0),
        flow("&1H"),
        says("&1A", off=True),
        says("&1Q", off=True),
        says("&1/", off=True),
        says("&1K", off=True),
        says("&1S", off=True),
        says("^A", off=True),
        says("^O", within=FLOW),
        says("^D", within=FLOW),
        flow("P8100=0"),
        flow("P8104=0"),
        flow("DISABLE PLC 29", undo=("ENABLE PLC 29",), watch=16.0),
        flow("DISABLE PLC 0"),
        flow("I5=0"),
        flow("OPEN PLC 29 CLEAR", "P8190=1", "CLOSE"),
        flow("OPEN PLC 29 CLEAR", "P8103=P8103+1", "CLOSE", "ENABLE PLC 29", within=SETTINGS, watch=9.0),
        flow("OPEN PLC 0 CLEAR", "P1=0", "P8105=P8103", "CLOSE", "ENABLE PLC 0", within=SETTINGS, watch=9.0),
        says("I5112=8388607", goes_on=True),
        says("I5112=0", goes_on=True),
        flow("P8100=2", goes_on=True),
        flow("P8104=2", goes_on=True),
        flow("P8100=2 P8104=2", goes_on=True),
        flow("P8103=0", goes_on=True, within=None),
        says("&1R", held=True, within=0.6),
        says("#1J+", held=True, off=True, within=0.6),
        says("&1%50", held=True),
        says("P8104=0", held=True),
        says("DELETE ROT", held=True),
        # settings
        settings("I5195=1"),
        settings("I115=0.01", undo=("I115=6.1279",), watch=16.0),
        settings("I111=0"),
        settings("I124=$20000"),
        settings("I113=1", off=True),
        settings("I10=1000000"),
        settings("I3=0"),
        says("I6=0", goes_on=True),
        settings("I5193=$2000"),
        settings("I100=0", off=True),
        settings("I16=0"),
        settings("#1->1000X", watch=9.0),
        settings("M161->D:$0", watch=9.0),
        settings("M8116->Y:$0,0,1", watch=9.0),
        # not a setting
        says("$$$", off=True, within=SETTINGS),
        says("DELETE ROT", off=True),
        says("#1K", off=True, within=SETTINGS),
        says("#1HM", off=True),
        says("#1J+", off=True),
        says("CLOSE ALL", goes_on=True),
        says("OPEN PROG 1 CLEAR"),
        says("SAVE", goes_on=True),
        says("$$$***", off=True, within=SETTINGS),
        says("OPEN ROT", "X99", "CLOSE", within=SETTINGS, watch=9.0),
        says("OPEN ROT", "P8190=1", "CLOSE", within=SETTINGS),
        says("OPEN ROT", "CLEAR", "CLOSE", off=True),
        # motors
        simulated("following@line500:3", kind="motor", off=True, within=SETTINGS),
        simulated("amplifier@line500:1", kind="motor", off=True, within=SETTINGS),
        simulated("limit@line500:2+", kind="motor", off=True, within=SETTINGS),
        simulated("limit@line500:5-", kind="motor", off=True, within=SETTINGS),
        simulated("reset@line500", kind="motor", off=True, within=SETTINGS),
        simulated("busy@line500:1", kind="link", goes_on=True, watch=12.0),
        simulated("busy@line500:2.6", kind="link", watch=6.0),
        simulated("freeze@line500:2", kind="link", watch=6.0),
        simulated("drop@line500", kind="link"),
        # the link
        *(
            link(f"a pause of {pause:g} s", partial(Proxy.pause, seconds=pause), goes_on=True, watch=watch)
            for pause, watch in ((0.3, 3.0), (0.6, 5.0), (0.9, 5.0), (1.5, 5.0), (5.0, 9.0), (15.0, 18.0))
        ),
        link("a pause of 0.6 s, TM 50", partial(Proxy.pause, seconds=0.6), tm=50.0, goes_on=True),
        link("cut, back after 0.2 s", partial(Proxy.cut, back_after=0.2)),
        link("cut, back after 3 s", partial(Proxy.cut, back_after=3.0), watch=6.0),
        link("cut for ever", Proxy.cut, watch=13.0),
        link("cut for ever, TM 50", Proxy.cut, watch=3.0, tm=50.0),
        link("RST", Proxy.reset),
        link("half open", Proxy.half_open, watch=5.0),
        link("replies 50 ms late", lambda proxy: setattr(proxy, "delay", 0.05), goes_on=True),
        link("replies 200 ms late", lambda proxy: setattr(proxy, "delay", 0.2), goes_on=True, watch=5.0),
        link("replies 200 ms late, TM 50", lambda proxy: setattr(proxy, "delay", 0.2), goes_on=True, tm=50.0),
        link("20 kB/s", lambda proxy: setattr(proxy, "rate", 20e3), goes_on=True, watch=5.0),
        link("one reply lost", partial(Proxy.lose_replies, count=1), watch=5.0),
        link("one reply garbled, its first byte", partial(Proxy.garble, count=1)),
        link("one reply garbled, its last byte", partial(Proxy.garble, count=1, place=-1), watch=5.0),
        link("50 replies garbled", partial(Proxy.garble, count=50, place=2), watch=6.0),
        link("one digit of a line changed", Proxy.change_digit, off=False, within=SETTINGS, watch=6.0),
        link("one digit of a line changed, TM 50", Proxy.change_digit, tm=50.0, within=SETTINGS, watch=5.0),
        # the host
        *(
            host(f"kill -9 at {at:g} s", KILL, tm=tm, after=at)
            for tm, at in ((5.0, 0.4), (5.0, 1.0), (50.0, 0.4), (50.0, 1.0))
        ),
        *(
            host(f"SIGSTOP at {at:g} s", STOP, tm=tm, after=at)
            for tm, at in ((5.0, 0.4), (5.0, 1.0), (50.0, 0.4), (50.0, 1.0))
        ),
        host("kill -9 in a hold", KILL, held=True, watch=2.0),
        host("SIGSTOP in a hold", STOP, held=True, watch=2.0),
        host("SIGSTOP, SIGCONT after 0.2 s", STOP, 0.2, CONT, goes_on=True),
        host("SIGSTOP, SIGCONT after 2 s", STOP, 2.0, CONT, goes_on=True, watch=6.0),
        host("SIGSTOP, SIGCONT after 2 s", STOP, 2.0, CONT, goes_on=True, watch=6.0, tm=50.0),
        host("SIGSTOP, SIGCONT after 12 s", STOP, 12.0, CONT, watch=15.0),
        host("SIGTERM", signal.SIGTERM),
        host("SIGHUP", signal.SIGHUP),
        host("SIGINT", signal.SIGINT),
        host("SIGINT, SIGINT after 0.1 s", signal.SIGINT, 0.1, signal.SIGINT, off=True),
        host("SIGTSTP", signal.SIGTSTP),
        host("SIGQUIT", signal.SIGQUIT),
        # other ways to stream
        *(
            of_work(work, fault)
            for work in ("exec", "follow")
            for fault in (
                flow("&1%200"),
                flow("&1H"),
                flow("DISABLE PLC 29"),
                settings("I115=0.01"),
                link("a pause of 0.6 s", partial(Proxy.pause, seconds=0.6), goes_on=True),
                link("cut for ever", Proxy.cut, watch=13.0),
                host("kill -9", KILL),
                host("SIGSTOP", STOP),
            )
        ),
    ]


# results


class PlannedPath:
    """The path of a plan, as a fine polyline in counts."""

    def __init__(self, plan: MotionPlan, step: float) -> None:
        times = np.arange(0.0, plan.duration + step, step)
        joints, _, _ = plan.sample(np.minimum(times, plan.duration))
        self._points = to_counts(plan.robot, joints)
        self._tree = cKDTree(self._points)

    def distance(self, counts: np.ndarray) -> float:
        """Return the largest distance of points (N, n) from the path, in counts of any motor."""
        _, nearest = self._tree.query(counts)
        best = np.full(len(counts), np.inf)
        for shift in (-1, 0):
            first = np.clip(nearest + shift, 0, len(self._points) - 2)
            begin = self._points[first]
            way = self._points[first + 1] - begin
            length = np.maximum((way**2).sum(axis=1), 1e-12)
            share = np.clip(((counts - begin) * way).sum(axis=1) / length, 0.0, 1.0)
            best = np.minimum(best, np.abs(counts - begin - share[:, None] * way).max(axis=1))
        return float(best.max())


@cache
def path_at(tm: float) -> PlannedPath:
    """Return the programmed path at a segment time [ms]."""
    opened = open_source(SourceFile("program.yarc", PROGRAM), Path.cwd(), Options(robot=ROBOT, tm=tm)).value
    assert opened is not None
    compiled = compile_module(opened.module, opened.request).value
    assert compiled is not None
    return PlannedPath(compiled.plan, 2.5e-4)


def tried(folder: Path, fault: Fault) -> Found:
    """Try one fault."""
    found = Found(fault.name, fault.tm)
    try:
        with Scene(folder, fault.tm, fault.options, fault.work) as scene:
            _try(scene, fault, found)
    except OSError as late:
        found.wrong.append(f"not tried: {late}")
    return found


def _try(scene: Scene, fault: Fault, found: Found) -> None:
    other, run = scene.other, scene.run
    begun = scene.begun()
    if fault.do is None:
        wait_for(lambda: len(scene.simulator.said) > 1, 12.0, "the simulator's fault doesn't come")
        since = scene.simulator.said[1][0]
    else:
        time.sleep(max(0.0, begun + fault.after - time.monotonic()))
        if fault.held:
            run.send(signal.SIGINT)
            held = time.monotonic()
            wait_for(lambda: other.stands_since(held) is not None, 3.0, "it isn't held")
            time.sleep(0.7)
        since = time.monotonic()
        fault.do(scene)
    resumed = _watch(scene, fault, since)
    ended = time.monotonic()
    stuck = not run.ended and resumed is not None
    if not fault.brief:
        _end(run, found)
    _judge(scene, fault, found, since, resumed or ended)
    if resumed is not None and (stuck or found.status.strip("*") not in ("0", "0 hangs")):
        found.wrong.append("put right and resumed, the run doesn't come to its end")


def _watch(scene: Scene, fault: Fault, since: float) -> float | None:
    """Watch until nothing more happens. Return the time at which the run was resumed, if it was."""
    other, run = scene.other, scene.run
    resumed = gone = None
    while (passed := time.monotonic() - since) < fault.watch:
        time.sleep(0.02)
        rest = other.stands_since(since)
        stands = time.monotonic() - rest if rest is not None and not other.moves else 0.0
        if fault.undo and resumed is None and stands > 0.6:
            for line in fault.undo:
                other.say(line)
            resumed = time.monotonic()
            scene.yarc("resume")
        if run.ended and gone is None:
            gone = time.monotonic()
        if other.refused and passed > 0.5:
            break
        if fault.brief and stands > 0.5 and passed > 1.2:
            break
        if gone is not None and stands > 0.5 and passed > (1.5 if fault.kind == "host" else 0.8):
            break
        if not fault.goes_on and not fault.undo and stands > 0.9 and passed > 1.5 and fault.watch < 6.0:
            break
    return resumed


def _end(run: Yarc, found: Found) -> None:
    """End the run, if it continues."""
    if (status := run.wait(0.0)) is not None:
        found.status = str(status)
        return
    run.send(CONT)
    run.send(signal.SIGTERM)
    status = run.wait(14.0)
    found.status = f"{status}*" if status is not None else "hangs"
    if status is None:
        found.wrong.append("the run hangs: SIGTERM doesn't end it")


def _judge(scene: Scene, fault: Fault, found: Found, since: float, until: float) -> None:
    other, run = scene.other, scene.run
    found.output = [f"{when - since:8.3f} {line}" for when, line in run.said]
    found.output += [f"{when - since:8.3f} sim: {line}" for when, line in scene.simulator.said[1:]]
    said = [(when, line) for when, line in list(run.said) if since <= when <= until]
    told = [(when, line) for when, line in said if not PROGRESS.search(line)]
    found.said = told[0][1].strip() if told else ""
    signs = [(when, "message") for when, _ in told[:1]]
    if (when := scene.proxy.holds_after(since)) is not None:
        signs.append((when, "hold"))
    looks = np.array([look for look in other.looks if look[0] >= since - 0.01])
    if len(looks):
        flags = looks[(looks[:, 1 + 1] == 2) | (looks[:, 1 + 2] == 2)]
        if len(flags):
            signs.append((flags[0, 0], "guard"))
    if first := min(((when, by) for when, by in signs if when <= until), default=None):
        found.noticed, found.by = first[0] - since, first[1]
    if not len(looks):
        found.wrong.append("nobody could look at the motors")
        return
    found.rest = _rest(looks, since, until)
    found.to_its_end = found.status == "0" and bool(
        np.ptp(looks[looks[:, 0] > since + (found.rest or 0.0)][:, 4:], axis=0).max() < STILL
    )
    distance = path_at(fault.tm).distance if fault.work != "follow" else _beside_motor_1
    rested = looks[:, 0] <= (since + found.rest if found.rest is not None else until) + EACH
    found.off = distance(looks[rested][:, 4:])
    found.off_later = distance(looks[looks[:, 0] <= until][:, 4:])
    if other.refused:
        found.said = f"(the controller refuses {', '.join(other.refused)}) {found.said}"
        if not told:
            return  # nothing has happened
    _find_wrong(scene, fault, found, looks, since, until)


def _beside_motor_1(counts: np.ndarray) -> float:
    """Return the motion of the other motors (N, n), in counts; the master wants none of them to move."""
    return float(np.ptp(counts[:, 1:], axis=0).max())


def _rest(looks: np.ndarray, since: float, until: float) -> float | None:
    """Return the time at which the motors have first come to rest, for at least 50 ms [s from the fault on];
    None if they haven't.
    """
    moving = np.abs(np.diff(looks[:, 4:], axis=0)).max(axis=1) > STILL
    first = since
    for when, moves in zip(looks[1:, 0], moving, strict=True):
        if moves:
            first = when
        elif when - first >= STANDS and when <= until + STANDS:
            return max(0.0, first - since)
    return None


def _find_wrong(
    scene: Scene, fault: Fault, found: Found, looks: np.ndarray, since: float, until: float
) -> None:
    moving = np.abs(np.diff(looks[:, 4:], axis=0)).max(axis=1) > STILL
    late = moving & (looks[1:, 0] > since + LOST_AFTER) & (looks[1:, 0] <= until)
    holds = [when for when, line in list(scene.run.said) if since <= when <= until and SAYS_HOLD.match(line)]
    if not fault.goes_on and not fault.undo and late.any():
        if fault.kind == "host" or fault.held or found.noticed is not None:
            what = "LOST"
        else:
            what = "it goes on as if nothing had happened"
        found.wrong.append(f"{what}: it moves {looks[1:, 0][late].max() - since:.1f} s after the fault")
    rests = since + found.rest if found.rest is not None else 0.0 if fault.goes_on else until
    if holds and rests > holds[0] + HOLD_TIME:
        found.wrong.append("it says hold, and the robot moves on")
    if found.off > OFF and not fault.off:
        found.wrong.append(f"OFF ITS PATH by {found.off:.0f} counts until rest")
    if found.off_later > OFF and not fault.off and found.off <= OFF:
        found.wrong.append(f"off its path by {found.off_later:.0f} counts later")
    if fault.within is not None and (found.noticed is None or found.noticed > fault.within):
        found.wrong.append(f"not noticed within {fault.within:g} s")
    if fault.kind == "host" and not fault.goes_on and (found.rest is None or found.rest > 1.0):
        found.wrong.append("not at rest within 1 s")
    text = "\n".join(line for _, line in (*scene.run.said, *scene.simulator.said))
    if "Traceback" in text or "internal error" in text or "this is a bug" in text:
        found.wrong.append("a traceback")
    if fault.kind != "host" and not fault.held and not found.said and not fault.goes_on:
        found.wrong.append("the run says nothing")


# tables


def row_of(found: Found) -> str:
    """Return a row of the table."""
    noticed = f"{found.noticed:.3f} {found.by}" if found.noticed is not None else "-"
    rest = f"{found.rest:.2f}" if found.rest is not None else "-"
    rest += " (its end)" if found.to_its_end else ""
    wrong = f" **{'; '.join(found.wrong)}**" if found.wrong else ""
    said = found.said.replace("|", "/")[:150]
    return (
        f"| {found.name} | {found.tm:g} | {noticed} | {rest} | {found.off:.2f} | {said}{wrong} | "
        f"{found.status} |"
    )


HEAD = (
    "| what is done | TM | noticed after s, by | at rest after s | off its path, counts | what the run "
    "says | status |\n|---|---|---|---|---|---|---|"
)


def _spread(row: int, fault: Fault) -> Fault:
    """Return a fault of another client at another time than its neighbours, because the run reads the
    settings once a second.
    """
    if fault.kind != "others" or fault.held:
        return fault
    return replace(fault, after=fault.after + row * 0.6180339887 % 1.0)


def all_faults(folder: Path, words: Sequence[str], file: str) -> None:
    """Try all faults one after the other, and print the table and a summary."""
    chosen = [_spread(row, fault) for row, fault in enumerate(faults())]
    chosen = [fault for fault in chosen if not words or any(word in fault.name for word in words)]
    begun, load = time.monotonic(), os.getloadavg()[0]
    results: list[Found] = []
    print(HEAD, flush=True)
    for fault in chosen:
        results.append(tried(folder, fault))
        print(row_of(results[-1]), flush=True)
        if file:
            Path(file).write_text(json.dumps([vars(one) for one in results], indent=1))
    spent = time.monotonic() - begun
    print(
        f"\n{len(results)} faults in {spent:.0f} s; load {load:.1f} at the beginning, "
        f"{os.getloadavg()[0]:.1f} at the end"
    )
    for tm in (5.0, 50.0):
        rests = [
            one.rest if one.rest is not None else np.inf
            for fault, one in zip(chosen, results, strict=True)
            if fault.kind == "host" and not fault.goes_on and not fault.held and one.tm == tm
        ]
        if rests:
            print(
                f"worst time to rest of a host's death, sleep or end at TM {tm:g}: {max(rests):.2f} s "
                f"of {len(rests)}"
            )
    lost = [one.name for one in results if any(word.startswith(("LOST", "OFF")) for word in one.wrong)]
    print(f"robots lost, or off their path where they shouldn't be: {', '.join(lost) or 'none'}")
    print(f"faults with something wrong: {sum(bool(one.wrong) for one in results)}")


def instants(folder: Path, count: int) -> None:
    """Try the death of the host at many times, and print the times to rest."""
    print(
        "| death of the host | TM | instants | median s | worst s | off its path, counts | load "
        "|\n|---|---|---|---|---|---|---|"
    )
    for tm in (5.0, 50.0):
        for name, number in (("kill -9", KILL), ("SIGSTOP", STOP)):
            found = []
            for row in range(count):
                at = 0.05 + 1.9 * ((row + 0.5) * 0.6180339887 % 1.0)
                found.append(tried(folder, signals(name, number, tm=tm, after=at, brief=True)))
                if found[-1].wrong:
                    print(f"at {at:.3f} s: {row_of(found[-1])}", file=sys.stderr, flush=True)
            rests = [one.rest if one.rest is not None else np.inf for one in found]
            off = max(one.off for one in found)
            print(
                f"| {name} | {tm:g} | {count} | {np.median(rests):.2f} | {max(rests):.2f} | {off:.2f} | "
                f"{os.getloadavg()[0]:.1f} |",
                flush=True,
            )


def main() -> None:
    """Try faults, and print tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("words", nargs="*")
    parser.add_argument("--instants", type=int, default=0)
    parser.add_argument("--json", default="", help="where all that was found and said is written")
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="yarc-faults-"))
    os.environ.update(
        XDG_RUNTIME_DIR=str(folder), YARCLANG_LOCKS=folder.name, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1"
    )
    (folder / "program.yarc").write_text(PROGRAM)
    multiprocessing.get_context("forkserver").set_forkserver_preload(imported())
    try:
        if options.instants:
            instants(folder, options.instants)
        else:
            all_faults(folder, options.words, options.json)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
