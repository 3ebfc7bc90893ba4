"""Tests of spreading work over several processes: results come in order, whatever the processes do and
however they end.
"""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from yarclang.fleet.outcome import Lost
from yarclang.fleet.spreading import Place, spread, workers


def squared(number):
    time.sleep(0.001 * (number % 7))
    return number * number


def fragile(number, folder, *, times=1):
    """End the process that does number 13, the first `times` times."""
    if number == 13:
        done = len(list(Path(folder).iterdir()))
        if done < times:
            (Path(folder) / str(done)).touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return number


def failing(number):
    if number == 7:
        raise ValueError("seven")
    return number


def no_files(_):
    return ()


@pytest.mark.parametrize("processes", [1, 2, 3])
@pytest.mark.parametrize("count", [0, 1, 3, 4, 50])
def test_results_come_in_order(processes, count):
    found = list(spread(squared, range(count), Place(processes), no_files))
    assert found == [number * number for number in range(count)]


def test_a_process_that_is_killed_costs_nothing(tmp_path):
    work = partial(fragile, folder=str(tmp_path), times=1)
    assert list(spread(work, range(30), Place(2), no_files)) == list(range(30))


def test_an_item_that_kills_two_processes_is_lost_alone(tmp_path):
    work = partial(fragile, folder=str(tmp_path), times=2)
    found = list(spread(work, range(30), Place(2), no_files))
    lost = found.pop(13)
    assert isinstance(lost, Lost)
    assert "SIGKILL" in lost.reason
    assert found == [number for number in range(30) if number != 13]


def test_an_exception_of_the_work_is_raised_here():
    with pytest.raises(RuntimeError, match="ValueError: seven"):
        list(spread(failing, range(30), Place(2), no_files))


def test_workers_stay_for_the_next_items():
    with workers(process_of, Place(2), no_files) as do:
        first = set(do(range(20)))
        second = set(do(range(20)))
    assert second <= first
    assert os.getpid() not in first


def process_of(_):
    return os.getpid()


def test_ctrl_c_ends_all_processes_without_a_traceback(tmp_path):
    for number in range(40):
        (tmp_path / f"p{number}.yarc").write_text(Path("examples/02_lines_and_deltas.yarc").read_text())
    command = [
        sys.executable,
        "-c",
        "from yarclang.cli.yarc import main; main()",
        "check",
        str(tmp_path),
        "--jobs",
        "2",
    ]
    process = subprocess.Popen(
        [*command, "--robot", "INDUSTRIAL6"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    time.sleep(2.0)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert "Traceback" not in errors
    assert process.returncode in (0, 1, 130)
    until = time.monotonic() + 10.0  # Python's own helper processes end a moment later
    while _is_there(process.pid) and time.monotonic() < until:
        time.sleep(0.05)
    assert not _is_there(process.pid)


def _is_there(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
