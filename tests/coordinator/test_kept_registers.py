"""Tests of KEPT registers: their values are there in the next run, however a run ends."""

import os
import signal
import sqlite3
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner

from tests.runtime.test_decisions import numbered
from tests.runtime.test_legs import job, value, world
from yarclang.cli.yarc import main
from yarclang.coordinator.kept_registers import KeptRegisters, forget, listed, program_of, registers_file
from yarclang.decisions import Register
from yarclang.runtime.actions import Trouble
from yarclang.runtime.pmac.performance import perform

COUNT, TOTAL = Register("COUNT", 0, 5, 0, kept=True), Register("TOTAL", 0, 99, 9, kept=True)
PLAIN = Register("PLAIN", 0, 5, 3)


@pytest.fixture(autouse=True)
def state(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def kept():
    return KeptRegisters("ARM simulated", "/cell/box")


def test_what_was_kept_is_there_again(kept):
    assert kept.first((COUNT, TOTAL, PLAIN)) == ({}, [])
    assert not registers_file().exists()
    kept.keep("COUNT", 4)
    kept.keep("COUNT", 5)
    assert kept.first((COUNT, TOTAL, PLAIN)) == ({"COUNT": 5}, [])
    kept.keep("PLAIN", 1)  # PLAIN is declared without KEPT now
    assert kept.first((PLAIN,)) == ({}, [])


def test_each_program_and_each_controller_counts_by_itself(kept):
    kept.keep("COUNT", 4)
    assert KeptRegisters("ARM 10.0.0.1:1025", "/cell/box").first((COUNT,)) == ({}, [])
    assert KeptRegisters("ARM simulated", "/cell/other").first((COUNT,)) == ({}, [])


def test_a_value_out_of_its_range_is_told_and_begins_anew(kept):
    kept.keep("COUNT", 7)
    assert kept.first((COUNT,)) == (
        {},
        ["COUNT was stored as 7, but its range is now 0 to 5: it begins with 0"],
    )


def test_a_program_and_its_controller_text_have_the_same_registers(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert program_of("box.pmc") == program_of(str(tmp_path / "box.yarc")) == str(tmp_path / "box")


def test_values_are_forgotten(kept):
    kept.keep("COUNT", 4)
    KeptRegisters("OTHER", "/cell/box").keep("COUNT", 1)
    KeptRegisters("OTHER", "/cell/pallet").keep("COUNT", 2)
    assert forget("/cell/box") == 2
    assert [one.program for one in listed()] == ["/cell/pallet"]


def test_a_file_that_is_no_database_is_told(kept):
    kept.keep("COUNT", 4)
    registers_file().write_bytes(b"junk" * 999)
    for use in (lambda: kept.first((COUNT,)), listed, lambda: forget("/cell/box")):
        with pytest.raises(Trouble, match="can't be used: file is not a database"):
            use()
    with pytest.raises(OSError, match="file is not a database"):
        kept.keep("COUNT", 3)
    assert kept.first((PLAIN,)) == ({}, [])  # without KEPT registers, the file isn't read


def test_a_value_of_another_kind_is_told(kept):
    kept.keep("COUNT", 4)
    with sqlite3.connect(registers_file()) as base:
        base.execute("UPDATE kept SET value = 'four'")
    with pytest.raises(Trouble, match="can't be used"):
        kept.first((COUNT,))


def test_a_kill_leaves_the_last_value_or_the_one_before(kept):
    """After a kill -9 at any instant, the file has the last value that was reported as stored, or the next
    one, and no partial value.
    """
    script = (
        "import sys\n"
        "from yarclang.coordinator.kept_registers import KeptRegisters\n"
        "kept = KeptRegisters('ARM simulated', '/cell/box')\n"
        "for number in range(10**6):\n"
        "    kept.keep('TOTAL', number)\n"
        "    print(number, flush=True)\n"
    )
    for told in (1, 7, 40):
        with subprocess.Popen(
            [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, env=dict(os.environ)
        ) as process:
            for _ in range(told):
                last = int(process.stdout.readline())
            process.send_signal(signal.SIGKILL)
            rest = process.stdout.read().split()
        last = int(rest[-1]) if rest and rest[-1].isdigit() else last
        ((held),) = [one.value for one in listed("ARM simulated", "/cell/box")]
        assert held in (last, last + 1)


LINES = ("REGISTER COUNT 0..5 KEPT", "REGISTER N 0..5")


def test_a_run_goes_on_when_the_value_is_kept(industrial6):
    made = world(industrial6)
    lines = numbered(("SET COUNT = 2", "SET N = 1", "SET COUNT = COUNT + N", "SET LAMP 4"))
    ended = made.perform(perform(made.operation, job(industrial6, *LINES, *lines)))
    assert ended.well
    assert made.kept == {"COUNT": 3}
    assert value(made, "M2") == 4


def test_a_run_ends_where_a_value_cannot_be_kept(industrial6):
    made = world(industrial6)
    made.unkept = "no space left on the disk"
    lines = numbered(("SET N = 1", "SET COUNT = 2", "SET LAMP 4"))
    ended = made.perform(perform(made.operation, job(industrial6, *LINES, *lines)))
    assert not ended.well
    assert ended.code == "Y1636"
    assert "can't store COUNT = 2: no space left on the disk" in ended.what
    assert dict(ended.registers) == {"COUNT": 0, "N": 1}
    assert value(made, "M2") == 0


def said(*arguments):
    result = CliRunner().invoke(main, arguments)
    return result.exit_code, result.output


def test_a_question_is_answered_from_another_terminal(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = 'ROBOT INDUSTRIAL6\nREGISTER N 1..9\nSTART HOME\nP10 HOLD "how many?" N\nP20 SAY "{N} boxes"\n'
    (tmp_path / "box.yarc").write_text(lines)
    command = [
        sys.executable,
        "-c",
        "from yarclang.cli.yarc import main; main()",
        "run",
        "box.yarc",
        "-y",
        "--no-log",
    ]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True) as process:
        until = time.monotonic() + 60.0
        while "asks: how many?" not in said("status")[1] and time.monotonic() < until:
            time.sleep(0.2)
        assert said("resume")[0] == 2
        code, told = said("resume", "--answer", "12")
        assert code == 2
        assert "asks: how many?: --answer with a number from 1 to 9, not 12" in " ".join(told.split())
        assert said("resume", "--answer", "4")[0] == 0
        output, _ = process.communicate(timeout=60)
    assert process.returncode == 0, output
    assert "box.yarc: done" in output


def test_what_comes_from_standard_input_keeps_nothing(tmp_path, monkeypatch):
    """A program from standard input stores no registers. It has no name, so two such programs would use the
    same registers.
    """
    monkeypatch.chdir(tmp_path)
    lines = (
        "ROBOT INDUSTRIAL6\n"
        "REGISTER COUNT 0..9 KEPT\n"
        "START HOME\n"
        "P10 SET COUNT = COUNT + 1\n"
        'P20 SAY "{COUNT}"\n'
    )
    for _ in range(2):
        result = CliRunner().invoke(main, ["run", "-", "-y", "--rate", "20", "--no-log"], input=lines)
        assert result.exit_code == 0, result.output
        assert "registers of a program from standard input aren't stored: COUNT begins anew" in result.output
        assert "SAY: 1" in result.output
    assert not registers_file().exists()


def test_runs_one_after_the_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lines = (
        "ROBOT INDUSTRIAL6\n"
        "REGISTER COUNT 0..9 KEPT\n"
        "START HOME\n"
        "P10 SET COUNT = COUNT + 1\n"
        'P20 SAY "{COUNT}"\n'
        "P30 WAIT [0.1] (s)\n"
    )
    (tmp_path / "box.yarc").write_text(lines)
    for number in (1, 2):
        code, output = said("run", "box.yarc", "-y", "--rate", "20", "--no-log")
        assert code == 0, output
        assert f"SAY: {number}" in output
    code, output = said("run", "box.yarc", "-y", "--rate", "20", "--no-log", "--times", "2")
    assert "SAY: 4" in output
    code, output = said("registers", "box.yarc")
    assert (code, output) == (0, f"{tmp_path / 'box'} on INDUSTRIAL6 simulated\n  COUNT is 4\n")
    assert said("registers", "--forget", "box.yarc") == (0, "box.yarc: 1 value forgotten\n")
    assert said("registers", "box.yarc") == (0, "no register values are stored for box.yarc\n")
    assert said("registers", "--forget")[0] == 2
    registers_file().write_bytes(b"junk" * 999)
    code, output = said("run", "box.yarc", "-y", "--rate", "20", "--no-log")
    assert code == 1
    assert "file is not a database" in output
    assert said("registers")[0] == 1
