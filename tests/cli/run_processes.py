"""Processes as people start them: `yarc sim` on a free port, `yarc run` in a terminal, other commands in
other terminals.
"""

import asyncio
import contextlib
import fcntl
import functools
import os
import pty
import re
import select
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import yarclang
from tests.simulator.serving import Client
from yarclang.cli.yarc import main as yarc
from yarclang.pipeline.settings import items_of
from yarclang.robot.actuation import from_counts
from yarclang.robot.description import load_robot
from yarclang.runtime.pmac.performance import connect, look
from yarclang.runtime.pmac.protocol import AskControl
from yarclang.runtime.session import Session

ROUND = """\
ROBOT INDUSTRIAL6
P0010 MOVEJ 9 4 -6 3 6 3 [0.7] (deg,s)
P0020 MOVEJ 6 -4 -3 5 2 8 [0.7] (deg,s)
P0030 MOVEJ 0 0 0 0 0 0 [0.7] (deg,s)
"""
"""From HOME to HOME, nowhere twice."""
DURATION = 2.1
FINE = ("--tm", "10")
"""Segments of 10 ms: the program is longer than the buffer, and has lines enough for faults at a line."""

LONGEST = 40.0
"""A process that takes longer hangs [s]."""

YARC = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()")


class Process:
    """A command; its outputs are read as they come."""

    def __init__(self, arguments, folder, environment, **options):
        self.out, self.err = [], []
        self._process = subprocess.Popen(
            arguments,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )
        self.pid = self._process.pid
        self._heard = threading.Condition()
        self._readers = [
            threading.Thread(target=self._read, args=(stream, lines), daemon=True)
            for stream, lines in ((self._process.stdout, self.out), (self._process.stderr, self.err))
        ]
        for reader in self._readers:
            reader.start()

    def _read(self, stream, lines):
        for line in stream:
            with self._heard:
                lines.append(line)
                self._heard.notify_all()
        with self._heard:
            self._heard.notify_all()

    @property
    def text(self):
        """What it has said so far."""
        return "".join((*self.out, *self.err))

    def wait_for(self, words):
        """Until it has said this."""
        until = time.monotonic() + LONGEST
        with self._heard:
            while words not in self.text:
                assert self._process.poll() is None, f"{words!r} wasn't said:\n{self.text}"
                left = until - time.monotonic()
                assert left > 0.0, f"{words!r} wasn't said in time:\n{self.text}"
                self._heard.wait(min(left, 0.2))

    def signal(self, number):
        self._process.send_signal(number)

    def end(self, status=None):
        """Wait for its end; what it has said."""
        try:
            found = self._process.wait(LONGEST)
        except subprocess.TimeoutExpired:
            self.kill()
            raise AssertionError(f"it doesn't end:\n{self.text}") from None
        for reader in self._readers:
            reader.join(LONGEST)
        assert "Traceback" not in self.text, self.text
        assert status is None or found == status, f"status {found}:\n{self.text}"
        return self.text

    def kill(self):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait(LONGEST)
        for reader in self._readers:
            reader.join(LONGEST)
        self._process.stdout.close()
        self._process.stderr.close()


class Terminal:
    """A command in a terminal of 80 columns."""

    def __init__(self, arguments, folder, environment):
        self.text = ""
        self._master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
        self._process = subprocess.Popen(
            arguments,
            cwd=folder,
            env={**environment, "TERM": "xterm"},
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),  # noqa: PLW1509  (there is no other way)
        )
        os.close(slave)
        self.pid = self._process.pid

    def wait_for(self, words):
        until = time.monotonic() + LONGEST
        while words not in self.text:
            assert time.monotonic() < until, f"{words!r} isn't on the screen:\n{self.text}"
            assert self._read(), f"it has ended without {words!r}:\n{self.text}"

    def type(self, keys):
        os.write(self._master, keys.encode())

    def end(self, status=None):
        until = time.monotonic() + LONGEST
        while self._read():
            assert time.monotonic() < until, f"it doesn't end:\n{self.text}"
        found = self._process.wait(LONGEST)
        assert status is None or found == status, self.text
        return self.text

    def hang_up(self):
        """Close the window."""
        os.close(self._master)
        self._master = -1

    def wait(self):
        """Its exit status, where nobody looks at it any more."""
        return self._process.wait(LONGEST)

    def kill(self):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait(LONGEST)
        if self._master >= 0:
            os.close(self._master)

    def _read(self):
        """What is there; whether there can be more."""
        ready, _, _ = select.select([self._master], [], [], 1.0)
        if not ready:
            return True
        try:
            data = os.read(self._master, 65536)
        except OSError:
            return False
        self.text += data.decode(errors="replace").replace("\r\n", "\n")
        return bool(data)


class Simulator:
    """`yarc sim` in a process of its own."""

    def __init__(self, process, robot):
        self.process, self.robot = process, load_robot(robot).value

    @functools.cached_property
    def port(self):
        self.process.wait_for(" listens on ")
        return int(re.search(r" listens on [\d.]+:(\d+),", self.process.text)[1])

    @property
    def address(self):
        return f"tcp://127.0.0.1:{self.port}"

    def counts(self):
        """Where the motors are commanded to be [counts]; asked by what no open buffer stores, until it
        isn't garbled.
        """
        for _ in range(20):
            with contextlib.suppress(AttributeError, IndexError, ValueError), Client(self.port) as client:
                actual, following = (self._report(client, report) for report in ("\x10", "\x06"))
                return actual + following
        raise AssertionError("it doesn't say where it is")

    def _report(self, client, character):
        words = client.ask(AskControl(character)).items[0].split()
        return np.array([float(words[motor - 1]) for motor in self.robot.controller.motors])

    def joints(self):
        """Likewise the joints [deg or mm]."""
        return from_counts(self.robot, self.counts()) / self.robot.axis_units

    def until(self, there):
        """Wait until the joints [deg or mm] are where `there` wants them; a wrong byte may look like that."""
        until = time.monotonic() + LONGEST
        while not there(joints := self.joints()):
            assert time.monotonic() < until, f"it is at {joints}"
            time.sleep(0.02)

    def comes_to_rest(self):
        """Likewise until it rests. Where the joints are then [deg or mm]."""
        until = time.monotonic() + LONGEST
        while True:
            with contextlib.suppress(AssertionError):
                return self.stands()
            assert time.monotonic() < until, "it doesn't come to rest"

    def stands(self):
        """Where the joints are [deg or mm]; they must not move. A wrong byte may look like a motion once."""
        for _ in range(3):
            one = self.counts()
            time.sleep(0.15)
            two = self.counts()
            if np.abs(two - one).max() < 0.5:
                return from_counts(self.robot, two) / self.robot.axis_units
        raise AssertionError(f"it moves by {two - one} counts in 0.15 s")

    def complaints(self):
        """What would keep a run from this controller."""
        return [one.found for one in asyncio.run(self._look()).errors]

    async def _look(self):
        session = Session("127.0.0.1", self.port)
        try:
            await session.perform(connect(session.operation))
            return await session.perform(look(session.operation, self.robot, items_of(self.robot)))
        finally:
            session.close()


class Spare:
    """A simulator that stands at HOME with nothing to do, used again as long as it is so."""

    def __init__(self, folder):
        self._workshop = Workshop(folder)
        self._simulator = None

    def simulator(self):
        if (
            self._simulator is None
            or self._simulator.complaints()
            or np.abs(self._simulator.joints()).max() > 1e-6
        ):
            if self._simulator is not None:
                self._simulator.process.kill()  # its clock costs the computer's time
            self._simulator = self._workshop.simulator()
        return self._simulator

    def close(self):
        self._workshop.close()


class Workshop:
    """A folder with programs, and all processes that are started in it."""

    def __init__(self, folder):
        self.folder = folder
        self._home = Path(tempfile.mkdtemp(prefix="yarc-"))  # its sockets need a short path
        self.environment = {
            # a process whose files are limited would leave half a module behind
            "PYTHONDONTWRITEBYTECODE": "1",
            **os.environ,
            "XDG_RUNTIME_DIR": str(self._home),
        }
        self._processes = []
        self.write("p.yarc", ROUND)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return name

    def simulator(self, *faults, robot="INDUSTRIAL6"):
        """It may take a moment to listen: whoever asks for its port waits for that."""
        arguments = [word for fault in faults for word in ("--fault", fault)]
        return Simulator(self.start("sim", "--robot", robot, "--port", "0", *arguments), robot)

    def start(self, *arguments, variables=None, **options):
        environment = {**self.environment, **(variables or {})}
        process = Process([*YARC, *arguments], self.folder, environment, **options)
        self._processes.append(process)
        return process

    def terminal(self, *arguments):
        process = Terminal([*YARC, *arguments], self.folder, self.environment)
        self._processes.append(process)
        return process

    def yarc(self, *arguments, status=0):
        """A command to its end; what it has said."""
        return self.start(*arguments).end(status)

    def here(self, *arguments, status=0):
        """Likewise, in this process: quicker, for what doesn't move a robot."""
        with contextlib.chdir(self.folder):
            done = CliRunner().invoke(yarc, arguments, env=self.environment)
        assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
        assert done.exit_code == status, done.output
        return done.output

    def close(self):
        for process in reversed(self._processes):
            process.kill()
        shutil.rmtree(self._home)


def run_on(simulator, *options, program="p.yarc"):
    """The words of a run without a log."""
    return ("run", program, "--to", simulator.address, *FINE, "--no-log", *options)


def off_the_path(joints, program=ROUND):
    """How far joints [deg or mm] are from the planned path of a program, and when it is nearest [s]."""
    plan = yarclang.plan(program).value
    times = np.linspace(0.0, plan.duration, 4001)
    for _ in range(3):
        off = np.abs(plan.sample(times)[0] / plan.robot.axis_units - joints).max(axis=1)
        nearest = int(np.argmin(off))
        time_, step = times[nearest], times[1] - times[0]
        times = np.clip(np.linspace(time_ - step, time_ + step, 401), 0.0, plan.duration)
    return off.min(), time_


def assert_on_path(stands, text=""):
    """Joints [deg or mm] are on the path of the program, between its ends, and in the command that a text
    tells.
    """
    off, time_ = off_the_path(stands)
    assert off < 2e-3
    assert 0.1 < time_ < DURATION - 0.1
    if text:
        index, told = re.search(
            r"\n  on its path, in (P00\d0) MOVEJ, (\d\.\d\d) s into the program\n", text
        ).groups()
        assert index in (command_at(time_ - 0.03), command_at(time_ + 0.03))
        assert float(told) == pytest.approx(time_, abs=0.02)  # the plan has other segments
        assert f"--tm 10 --from {index}\n" in text


def command_at(time_):
    """The command that is executed at a time of the program [s]."""
    return ("P0010", "P0020", "P0030")[int(3 * time_ / DURATION)]


def places(text):
    """The joint positions in a text, behind `stands at`."""
    behind = text[text.index(" stands at ") :].replace("\n", " ")
    return [float(value) for value in re.findall(r"J\d (-?[\d.]+) (?:deg|mm)", behind)]
