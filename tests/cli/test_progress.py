"""Anything that takes more than a second shows its progress, and Ctrl-C leaves a clean line."""

import os
import pty
import re
import signal
import subprocess
import sys
import time
from collections import Counter

import pytest
from click.testing import CliRunner

from yarclang.cli import work
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc
from yarclang.progress import part, tell, told_to

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 300 1074.4 1100 0 0 0\n"
GOOD = HEAD + "P0020 MOVEL 250 1074.4 1100 0 0 0\nP0030 STOP\n"
LONG = HEAD + "".join(
    (
        f"P{number + 20:04} MOVEL {300 - number % 2 * 50} 1074.4 {1100 - number // 2 % 2 * 40 - number} 0 0 "
        "0 [V 200] BLEND 5\n"
    )
    for number in range(1, 150)
)
"""A program that takes half a minute to plan."""

LAST = 60.0
"""Time [s] after which a command counts as hanging."""


@pytest.fixture
def told(monkeypatch):
    """Count the reports of progress by their texts without numbers."""
    counts = Counter()

    def listen(progress, what, done, total):
        counts[re.sub(r"\d+", "N", what)] += 1

    monkeypatch.setattr(work.Progress, "__call__", listen)
    return counts


def invoke(command, *arguments):
    return CliRunner().invoke(command, [str(one) for one in arguments])


def test_fixes_are_tried_one_after_the_other(tmp_path, told):
    path = tmp_path / "a.yarc"
    path.write_text(GOOD.replace("P0020 MOVEL", "P0020\u00a0MOVEL"))
    invoke(yarc, "check", "--fix", path)
    assert [one for one in told if one.startswith("trying")], told
    assert any(one.endswith(": planning") and one.startswith("trying") for one in told), told


def test_a_comparison_tells_which_file_it_reads_and_how_far_it_is(tmp_path, told):
    first, second, compiled = tmp_path / "a.yarc", tmp_path / "b.yarc", tmp_path / "b.pmc"
    first.write_text(GOOD)
    second.write_text(GOOD.replace("250", "255"))
    assert invoke(yarcc, second, "-o", compiled).exit_code == 0
    told.clear()
    assert invoke(yarc, "diff", first, compiled).exit_code == 1
    wanted = ("a.yarc: planning", "b.pmc: reading the controller's text", "comparing")
    for one in wanted:
        assert any(what.endswith(one) for what in told), told


def test_parts_are_named_from_outside_in():
    heard = []
    with told_to(lambda *what: heard.append(what)):
        with part("a"), part("b"):
            tell("c", 1, 2)
        tell("d", 3)
    assert heard == [("a: b: c", 1, 2), ("d", 3, 0)]
    with part("nobody listens"):
        tell("e", 1)


CODE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell starts what runs in the background without an ear for Ctrl-C
from yarclang.cli.yarc import main
main()
"""  # noqa: E501


def on_a_terminal(*command):
    """Start a command whose standard error is a terminal."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", CODE, *map(str, command)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=theirs,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "100"},
    )
    os.close(theirs)
    return process, ours


def read(terminal, until=None):
    """Read a terminal's output until `until` was written, or to its end."""
    found, end = b"", time.monotonic() + LAST
    while until is None or until not in found:
        assert time.monotonic() < end, found
        try:
            more = os.read(terminal, 4096)
        except OSError:  # nobody has the other side open
            more = b""
        if not more:
            break
        found += more
    return found


@pytest.mark.parametrize("fix", [False, True])
def test_ctrl_c_during_progress_leaves_a_clean_line(tmp_path, fix):
    path = tmp_path / "long.yarc"
    path.write_text(LONG)
    process, terminal = on_a_terminal("check", *["--fix"] * fix, path)
    try:
        shown = read(terminal, until=b"planning")
        assert b"planning" in shown
        process.send_signal(signal.SIGINT)
        rest = read(terminal)
        assert process.wait(LAST) == 1
    finally:
        process.kill()
        process.wait()
        os.close(terminal)
    assert process.stdout.read() == b""
    process.stdout.close()
    written = (shown + rest).decode()
    assert "Traceback" not in written
    assert written.rindex("\x1b[?25h") > written.rindex("\x1b[?25l"), "the cursor stays hidden"
    assert written.endswith("\x1b[2K\r\nAborted!\r\n"), "the bar is still there"
    assert path.read_text() == LONG
