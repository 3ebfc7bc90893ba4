"""`yarcc` is killed, interrupted, or has no room or rights to write.

The target file is then absent or unchanged, or it is a whole certified text. All runs are forks of one
process that has imported everything, so that twenty of them take only seconds.
"""

import json
import math
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress

import numpy as np
import pytest

LINES = 60

DRIVER = """
import errno, json, os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from pathlib import Path
from yarclang.cli.yarcc import main

def run(arguments, end):
    try:
        main(arguments)
    except SystemExit as ended:
        return ended.code or 0
    return 0

def ending(place, how):
    def end(function):
        def ended(*arguments, **named):
            if place == "before":
                how()
            try:
                result = function(*arguments, **named)
            finally:
                os.seteuid(os.getuid())  # modules may lie where only their owner may read
            if place == "after":
                how()
            return result
        return ended
    return end

def nobody():
    if os.getuid() == 0:
        os.seteuid(65534)

def full():
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

HOW = {"kill": lambda: os.kill(os.getpid(), signal.SIGKILL), "interrupt": lambda: os.kill(os.getpid(), signal.SIGINT), "full": full, "nobody": nobody}
import tempfile
WHERE = {"mkstemp": tempfile, "fsync": os, "replace": Path, "chmod": Path}

def change(where, place, how):
    setattr(WHERE[where], where, ending(place, HOW[how])(getattr(WHERE[where], where)))

sys.stdout.flush()
for line in sys.stdin:
    order = json.loads(line)
    child = os.fork()
    if not child:
        out = os.open(order["out"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(out, 1), os.dup2(out, 2)
        if order["change"]:
            change(*order["change"])
        status = 70
        try:
            status = run(order["arguments"], order)
        except BaseException:
            import traceback
            traceback.print_exc()
        finally:
            sys.stdout.flush(), sys.stderr.flush()
            os._exit(status)
    print(child, flush=True)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""  # noqa: E501


def chain(count):
    """Return a program of a winding line in many short pieces."""
    lines, x, y = (
        ["DEFAULT {TCP} [V 50] (mm,deg,s) {B}", "P0001 MOVEJ_RPY 40 1000 1000 0 0 0 [5]"],
        40.0,
        1000.0,
    )
    for k in range(count):
        heading = math.radians(60.0) * math.sin(k / 20.0)
        x, y = x + 2.0 * math.cos(heading), y + 2.0 * math.sin(heading)
        lines.append(
            f"P{10 * k + 10:04d} MOVEL {x:.3f} {y:.3f} 1000 0 0 0{' BLEND 0.3' if k < count - 1 else ''}"
        )
    return "\n".join(lines) + "\n"


class Runs:
    """Runs of `yarcc` on one program in one folder."""

    def __init__(self, folder):
        self.folder, self.out = folder, folder.parent / "out.txt"
        self.driver = subprocess.Popen(
            [sys.executable, "-c", DRIVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        (folder / "chain.yarc").write_text(chain(LINES))
        (folder / "short.yarc").write_text("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n")
        # the first run imports everything and reads the robot
        assert self.run("short.yarc", "-o", "/dev/null") == 0, self.out.read_text()
        began = time.monotonic()
        assert self.run("chain.yarc") == 0, self.out.read_text()
        self.lasting = time.monotonic() - began
        self.certified = (folder / "chain.pmc").read_bytes()

    def run(self, file, *arguments, after=None, by=signal.SIGKILL, change=None):
        """Run `yarcc`, and return its status.

        Args:
            after: a time [s] after which the run gets the signal `by`.
            change: a function to replace, as (function, place, what happens there).
        """
        destination = () if "-o" in arguments else ("-o", self.folder / file.replace(".yarc", ".pmc"))
        words = [self.folder / file, "--robot", "INDUSTRIAL6", *destination, *arguments]
        order = {
            "arguments": [str(word) for word in words],
            "change": change,
            "out": str(self.out),
        }
        self.driver.stdin.write(json.dumps(order) + "\n")
        self.driver.stdin.flush()
        child = int(self.driver.stdout.readline())
        if after is not None:
            time.sleep(after)
            # the process wasn't waited for, so its number isn't used by another process
            with suppress(ProcessLookupError):
                os.kill(child, by)
        self.signalled = time.monotonic()
        return int(self.driver.stdout.readline())

    @property
    def files(self):
        return sorted(one.name for one in self.folder.iterdir())

    @property
    def said(self):
        return [line for line in self.out.read_text().splitlines() if line]


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "programs"
    folder.mkdir()
    made = Runs(folder)
    yield made
    made.driver.stdin.close()
    made.driver.stdout.close()
    made.driver.kill()
    made.driver.wait()


BEFORE = ["chain.pmc", "chain.yarc", "short.yarc"]
IN_WRITING = [
    (where, place) for where in ("mkstemp", "fsync", "chmod", "replace") for place in ("before", "after")
]


def test_a_kill_at_twenty_instants_leaves_nothing_or_the_whole_text(runs):
    """Twelve kills are spread over the run, with and without an old text, and eight are at the writing."""
    text, old = runs.folder / "chain.pmc", b"what was there before\n"
    killed = 0
    for number, share in enumerate(np.linspace(0.02, 1.0, 12)):
        text.write_bytes(old) if number % 2 else text.unlink(missing_ok=True)
        killed += runs.run("chain.yarc", after=share * runs.lasting) == -signal.SIGKILL
        assert not text.exists() or text.read_bytes() in ((old,) if number % 2 else ()) + (runs.certified,)
    assert killed >= 6
    for where, place in IN_WRITING:
        text.unlink(missing_ok=True)
        assert runs.run("short.yarc", change=(where, place, "kill"), after=None) == -signal.SIGKILL
    # partly written texts have names that no pattern for programs matches, and they disturb no later run
    left = set(runs.files) - {*BEFORE, "short.pmc"}
    assert all(one.startswith((".short.pmc.", ".chain.pmc.")) for one in left)
    assert len(left) <= 8
    assert runs.run("chain.yarc") == 0
    assert text.read_bytes() == runs.certified
    for one in left:
        (runs.folder / one).unlink()
    (runs.folder / "short.pmc").unlink()
    assert runs.files == BEFORE


def test_ctrl_c_ends_it_at_once_on_one_line(runs):
    text = runs.folder / "chain.pmc"
    text.unlink(missing_ok=True)
    interrupted = 0
    for share in np.linspace(0.02, 0.9, 6):
        status = runs.run("chain.yarc", after=share * runs.lasting, by=signal.SIGINT)
        # it must not hang; on a computer with other work, the end of a process takes some seconds
        assert time.monotonic() - runs.signalled < 10.0
        if text.exists():  # the run had already ended
            assert text.read_bytes() == runs.certified
            text.unlink()
            continue
        interrupted += 1
        assert (status, runs.said) == (1, ["Aborted!"])
        assert runs.files == BEFORE[1:]
    assert interrupted >= 3
    for where, place in (("fsync", "before"), ("fsync", "after"), ("chmod", "after"), ("replace", "before")):
        assert runs.run("short.yarc", change=(where, place, "interrupt")) == 1
        assert (runs.said, runs.files) == (["Aborted!"], BEFORE[1:])


def test_a_full_disk_is_one_error(runs):
    before = runs.files
    assert runs.run("short.yarc", change=("fsync", "before", "full")) == 1
    errors = [line for line in runs.said if "error" in line]
    assert len(errors) == 2, runs.said
    assert "can't be written: no space left on device" in errors[0]
    assert errors[1].endswith("1 error; nothing written")
    assert runs.files == before


def test_a_device_without_room_is_one_error(runs):
    assert runs.run("short.yarc", "-o", "/dev/full") == 1
    assert "/dev/full can't be written: no space left on device" in "\n".join(runs.said)


def test_a_folder_that_may_not_be_written_is_one_error(runs):
    before = runs.files
    runs.folder.chmod(0o555)
    try:
        assert runs.run("short.yarc", change=("mkstemp", "before", "nobody")) == 1
    finally:
        runs.folder.chmod(0o755)
    errors = [line for line in runs.said if "error" in line]
    assert "short.pmc can't be written: permission denied" in errors[0]
    assert len(errors) == 2
    assert not any("Traceback" in line for line in runs.said)
    assert runs.files == before
