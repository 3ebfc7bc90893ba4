"""`yarc replay`: a recorded run is replayed on a terminal and without one."""

import os
import pty
import re
import signal
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner
from report.runs.made_up_runs import ANCHOR, made, progress, samples, whole, write

from yarclang.cli.yarc import main
from yarclang.runtime.notices import Changed
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import State

CODE = "from yarclang.cli.yarc import main; main()"


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return whole(tmp_path_factory.mktemp("log") / "a.mcap", *made())[0]


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """Write the log of a run that was stopped after half a second."""
    job, plan = made()
    seen = samples(job, plan, length=0.5)
    told = [Changed(ANCHOR.clock, State.MOVE, "")]
    for one, at in zip(seen.notices, seen.times, strict=True):
        told += [one, progress(job, one.time, at)]
    ended = Ended(False, "stopped on its path", "", None, "P0010 MOVEJ_LSPB", "P0010", 0.5)
    return write(tmp_path_factory.mktemp("short") / "short.mcap", job, told, ended)


def replay(*arguments):
    return CliRunner().invoke(main, ["replay", *map(str, arguments)])


def test_without_a_terminal_there_are_plain_lines(log):
    done = replay(log, "--speed", "max")
    assert done.exit_code == 0
    assert done.stderr == ""
    assert "\r" not in done.stdout
    assert "\x1b" not in done.stdout
    head, *lines = done.stdout.splitlines()
    assert head == "turning.yarc on INDUSTRIAL6 at 127.0.0.1:1025, 2026-09-21 14:13:20 UTC"
    assert all(re.match(r" *\d+\.\d{3} s  \S", line) for line in lines)
    texts = [line[13:] for line in lines]
    assert texts[:3] == ["stop", "init: loading turning.yarc", "move"]
    assert texts[-2:] == ["stop: at the end of turning.yarc, to a count", "came to its end"]
    commands = [text.split("  ")[0] for text in texts[3:-2]]
    # each command has one line, at its beginning; only a command of more than 5 s would have further lines
    assert commands == ["P0010 MOVEJ_LSPB", "P0020 MOVEJ_LSPB", "P0030 MOVEJ_LSPB"]
    assert "of 9.0 s" in texts[3]
    assert re.search(r"J1 \d+\.\d\d J2 ", texts[4])


def test_a_long_command_has_a_line_now_and_then(tmp_path):
    job, plan = made("P0010 MOVEJ_LSPB 40 10 20 0 30 0 [17] (deg,s)\n", name="slow.yarc")
    done = replay(whole(tmp_path / "a.mcap", job, plan)[0], "--speed", "max")
    assert len([line for line in done.stdout.splitlines() if "P0010" in line]) == 4


def timed(*arguments):
    since = time.monotonic()
    done = replay(*arguments)
    assert done.exit_code == 0
    return time.monotonic() - since, done.stdout


def test_it_takes_as_long_as_the_run_did(short):
    timed(short, "--speed", "max")  # imports everything, so that the next times are without imports
    at_once, text = timed(short, "--speed", "max")
    real, same = timed(short)
    twice, _ = timed(short, "--speed", "2")
    assert at_once < real
    assert real > 0.5
    assert twice > 0.25
    assert text == same
    assert text.endswith("stopped on its path (P0010 MOVEJ_LSPB, 0.5 s into the program)\n")


@pytest.mark.parametrize("speed", ["0", "-1", "nan", "inf", "fast", ""])
def test_speeds_that_are_none(short, speed):
    done = replay(short, "--speed", speed)
    assert done.exit_code == 2
    assert "neither a positive number nor max" in done.stderr


def test_an_unfinished_log_is_shown_with_a_warning(log, tmp_path):
    path = tmp_path / "cut.mcap"
    path.write_bytes(log.read_bytes()[:-3000])
    done = replay(path, "--speed", "max")
    assert done.exit_code == 0
    assert "warning Y1402" in done.stderr
    assert "is read up to" in done.stderr


def test_what_is_no_log(tmp_path):
    path = tmp_path / "a.yarc"
    path.write_text("P0010 STOP\n")
    for file, code in ((path, "Y1401"), (tmp_path / "none.mcap", "Y0107"), (tmp_path, "Y0107")):
        done = replay(file)
        assert done.exit_code == 1
        assert f"error {code}" in done.stderr
        assert done.stdout == ""


def test_an_empty_run(tmp_path):
    done = replay(write(tmp_path / "a.mcap", made()[0], []))
    assert done.exit_code == 0
    assert len(done.stdout.splitlines()) == 1


def test_on_a_terminal_one_line_changes(short):
    terminal, side = pty.openpty()
    os.set_blocking(terminal, False)
    environment = os.environ | {"COLUMNS": "60", "LINES": "20"}
    process = subprocess.Popen([sys.executable, "-c", CODE, "replay", short], stdout=side, env=environment)
    text, ended = b"", False
    while True:
        try:
            text += os.read(terminal, 65536)
        except BlockingIOError:  # no output is available yet
            if ended:
                break
            ended = process.poll() is not None
            time.sleep(0.01)
    os.close(terminal)
    os.close(side)
    changes = text.decode().split("\r\x1b[K")
    assert len(changes) > 12
    live = [change for change in changes if change.startswith("P0010 MOVEJ_LSPB  0.")]
    assert len(live) > 10
    assert max(map(len, live)) == 59
    assert "stopped on its path" in changes[-1]


def test_it_can_be_interrupted(log):
    process = subprocess.Popen(
        [sys.executable, "-c", CODE, "replay", log], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    while "move" not in process.stdout.readline():
        pass
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=10)
    assert errors.strip() == "stopped"
    assert process.returncode == 0
