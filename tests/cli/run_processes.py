"""Processes as people start them.

These are `yarc sim` on a free port, `yarc run` in a terminal, and other commands in other terminals.
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
"""A program from HOME to HOME that is at no place twice."""
DURATION = 2.1
FINE = ("--tm", "10")
"""Options for segments of 10 ms, so that the program is longer than the buffer.

It then also has enough lines for faults at a certain line.
"""

LONGEST = 40.0
"""Longest time that a process may take before it counts as hanging [s]."""

YARC = (sys.executable, "-c", "from yarclang.cli.yarc import main; main()")


class Process:
    """A command whose outputs are read as they come."""

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
        """The command's output so far."""
        return "".join((*self.out, *self.err))

    def wait_for(self, words):
        """Wait until the command has written these words."""
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
        """Wait for the command's end, and return its output."""
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
        """Close the terminal's window."""
        os.close(self._master)
        self._master = -1

    def wait(self):
        """Return the exit status after the terminal was closed."""
        return self._process.wait(LONGEST)

    def kill(self):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait(LONGEST)
        if self._master >= 0:
            os.close(self._master)

    def _read(self):
        """Read the available output; return False at its end."""
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
        """Return the motors' commanded positions [counts].

        Only requests that no open buffer stores are sent. They are repeated until the answer isn't garbled.
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
        """Return the joints' commanded positions [deg or mm]."""
        return from_counts(self.robot, self.counts()) / self.robot.axis_units

    def until(self, there):
        """Wait until `there` returns True for the joint positions [deg or mm].

        As a garbled answer may look like a match, this alone proves little.
        """
        until = time.monotonic() + LONGEST
        while not there(joints := self.joints()):
            assert time.monotonic() < until, f"it is at {joints}"
            time.sleep(0.02)

    def comes_to_rest(self):
        """Wait until the joints are at rest, and return their positions [deg or mm]."""
        until = time.monotonic() + LONGEST
        while True:
            with contextlib.suppress(AssertionError):
                return self.stands()
            assert time.monotonic() < until, "it doesn't come to rest"

    def stands(self):
        """Return the joint positions [deg or mm], which must not change.

        A garbled answer may look like a motion, so this is tried three times.
        """
        for _ in range(3):
            one = self.counts()
            time.sleep(0.15)
            two = self.counts()
            if np.abs(two - one).max() < 0.5:
                return from_counts(self.robot, two) / self.robot.axis_units
        raise AssertionError(f"it moves by {two - one} counts in 0.15 s")

    def complaints(self):
        """Return the errors that would keep a run from this controller."""
        return [one.found for one in asyncio.run(self._look()).errors]

    async def _look(self):
        session = Session("127.0.0.1", self.port)
        try:
            await session.perform(connect(session.operation))
            return await session.perform(look(session.operation, self.robot, items_of(self.robot)))
        finally:
            session.close()


class Spare:
    """A simulator at HOME, reused by the next test as long as it is idle and at HOME."""

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
                self._simulator.process.kill()  # an unused simulator would still take processor time
            self._simulator = self._workshop.simulator()
        return self._simulator

    def close(self):
        self._workshop.close()


class Workshop:
    """A folder with programs, and all processes that are started in it."""

    def __init__(self, folder):
        self.folder = folder
        self._home = Path(tempfile.mkdtemp(prefix="yarc-"))  # sockets need a short path
        self.environment = {
            # a process with a limited file size would leave a truncated module behind
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
        """Start a simulator without waiting for it; reading its port waits until it listens."""
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
        """Run a command to its end, and return its output."""
        return self.start(*arguments).end(status)

    def here(self, *arguments, status=0):
        """Run a command in this process, which is quicker, and return its output; it mustn't move a robot."""
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
    """Return the arguments of a run without a log."""
    return ("run", program, "--to", simulator.address, *FINE, "--no-log", *options)


def off_the_path(joints, program=ROUND):
    """Return the distance of joint positions [deg or mm] from a program's planned path.

    Also return the time in the program [s] at which the path is nearest.
    """
    plan = yarclang.plan(program).value
    times = np.linspace(0.0, plan.duration, 4001)
    for _ in range(3):
        off = np.abs(plan.sample(times)[0] / plan.robot.axis_units - joints).max(axis=1)
        nearest = int(np.argmin(off))
        time_, step = times[nearest], times[1] - times[0]
        times = np.clip(np.linspace(time_ - step, time_ + step, 401), 0.0, plan.duration)
    return off.min(), time_


def assert_on_path(stands, text=""):
    """Check that joint positions [deg or mm] are on the program's path, between its ends.

    They must also be in the command that a text names.
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
    """Return the index of the command that is executed at a time of the program [s]."""
    return ("P0010", "P0020", "P0030")[int(3 * time_ / DURATION)]


def places(text):
    """Return the joint positions that a text has after `is at`."""
    behind = text[text.index(" is at ") :].replace("\n", " ")
    return [float(value) for value in re.findall(r"J\d (-?[\d.]+) (?:deg|mm)", behind)]
