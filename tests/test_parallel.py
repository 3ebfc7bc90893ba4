"""Tests of distributing work over cores: the results and their order are the same, whatever happens to a
process.
"""

import subprocess
import sys
import textwrap

import pytest

from yarclang.parallel import cores, mapped, on_cores


def result(script, *, timeout=60):
    """Run a script in a new process, in which no other thread runs, and return its exit status and output."""
    code = "import os, sys, time\nfrom yarclang.parallel import mapped, on_cores\n" + textwrap.dedent(script)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=timeout, check=False
    )
    return done.returncode, done.stdout, done.stderr


def test_nobody_forks_unless_a_door_says_so():
    import os

    assert set(mapped(lambda _: os.getpid(), range(10))) == {os.getpid()}
    assert cores() >= 1


@pytest.mark.parametrize("processes", [1, 2, 5])
def test_what_comes_back_is_in_order(processes):
    code, out, err = result(
        f"""
        offset = 7
        def work(item):
            time.sleep(0.02 * (item % 3))
            return item * item + offset, os.getpid()
        with on_cores({processes}):
            found = list(mapped(work, list(range(20))))
        assert [value for value, _ in found] == [item * item + 7 for item in range(20)]
        print(len({{pid for _, pid in found}}), os.getpid() in {{pid for _, pid in found}})
        """
    )
    assert code == 0, err
    assert out.split() == (["1", "True"] if processes == 1 else [str(processes), "False"])


def test_a_fault_is_told_where_it_can_be_told():
    code, out, err = result(
        """
        def work(item):
            if item == 3:
                raise ValueError("three")
            return (lambda: 0) if item == 9 else item
        for items in (range(6), [9, 9]):
            try:
                with on_cores(2):
                    list(mapped(work, list(items)))
            except (ValueError, RuntimeError) as error:
                print(type(error).__name__, str(error)[:5])
        """
    )
    assert code == 0, err
    assert out.splitlines() == ["ValueError three", "RuntimeError <func"]


def test_a_process_that_is_killed_loses_nothing():
    code, out, err = result(
        """
        import signal
        ours = os.getpid()
        def work(item):
            if item in (2, 5) and os.getpid() != ours:
                os.kill(os.getpid(), signal.SIGKILL)
            return item
        with on_cores(2):
            print(list(mapped(work, list(range(9)))))
        """
    )
    assert code == 0, err
    assert out.strip() == str(list(range(9)))


def test_where_no_process_can_be_started_it_is_done_here():
    code, out, err = result(
        """
        def full(): raise BlockingIOError(11, "no more processes")
        os.fork = full
        with on_cores(4):
            print(list(mapped(lambda item: item + 1, [1, 2, 3])))
        """
    )
    assert code == 0, err
    assert out.strip() == "[2, 3, 4]"


def test_processes_end_with_the_one_that_started_them():
    """After Ctrl-C, or if the caller stops early, no process is left."""
    code, out, err = result(
        """
        import signal
        def work(item):
            print(os.getpid(), flush=True)
            time.sleep(30.0 if item else 0.0)
            return item
        signal.signal(signal.SIGALRM, lambda *_: os.kill(os.getpid(), signal.SIGINT))
        signal.setitimer(signal.ITIMER_REAL, 1.0)
        try:
            with on_cores(3):
                for _ in mapped(work, list(range(6))):
                    pass
        except KeyboardInterrupt:
            print("given up")
        """,
        timeout=20,
    )
    assert code == 0, err
    assert out.splitlines()[-1] == "given up"
    for pid in out.split()[:-2]:
        alive = subprocess.run(["kill", "-0", pid], capture_output=True, check=False).returncode == 0
        assert not alive


def test_processes_end_when_the_one_that_started_them_is_killed():
    code, out, _ = result(
        """
        import signal
        ours = os.getpid()
        def work(item):
            print(os.getpid(), flush=True)
            if item == 3:
                os.kill(ours, signal.SIGKILL)
            time.sleep(0.3)
            return item
        with on_cores(2):
            list(mapped(work, list(range(200))))
        """,
        timeout=20,
    )
    assert code == -9
    import time

    until = time.monotonic() + 10.0
    pids = set(out.split())
    while any(
        subprocess.run(["kill", "-0", pid], capture_output=True, check=False).returncode == 0 for pid in pids
    ):
        assert time.monotonic() < until, "somebody works on for nobody"
        time.sleep(0.1)


def test_within_a_block_of_cores_the_number_counts():
    with on_cores(1):
        assert list(mapped(str, [1, 2])) == ["1", "2"]
