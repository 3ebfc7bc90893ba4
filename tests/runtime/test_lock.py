"""Tests of the lock of a controller. There is one lock on the computer, for all users, environments and host
names.
"""

import contextlib
import errno
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from yarclang.runtime.transports import lock
from yarclang.runtime.transports.lock import SPACE, controller_lock, holder_of
from yarclang.runtime.transports.private import ControlError
from yarclang.runtime.transports.runs import find_runs

NOBODY = 65534
"""Id of a user that exists on each Linux."""

HOLD = """
import encodings.idna, os, sys, tempfile, time
from yarclang.runtime.transports.lock import controller_lock
if len(sys.argv) > 2:
    tempfile.tempdir = "/proc"  # no folder of that user is made
    os.setgroups([])
    os.setgid(int(sys.argv[2]))
    os.setuid(int(sys.argv[2]))
with controller_lock(sys.argv[1], 1025):
    print("locked", flush=True)
    time.sleep(60)
"""

as_root = pytest.mark.skipif(os.getuid() != 0, reason="only root can start a process of another user")


@contextlib.contextmanager
def held(*user, **options):
    """Run a process that holds the lock, as another user if one is given."""
    command = [sys.executable, "-c", HOLD, "127.0.0.1", *map(str, user)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, **options) as process:
        try:
            assert process.stdout.readline() == b"locked\n"
            yield process
        finally:
            process.kill()


def refused(host="127.0.0.1", port=1025):
    """Try to take the lock, which must fail. Return the error."""
    with pytest.raises(ControlError) as found, controller_lock(host, port):
        pass
    return found.value


@contextlib.contextmanager
def bound(listens, host="127.0.0.1"):
    """Bind the lock's name as a process other than yarclang: only bound, or listening without a reply."""
    with contextlib.ExitStack() as stack:
        for name in lock._names(host, 1025):
            wire = stack.enter_context(socket.socket(socket.AF_UNIX))
            wire.bind(name)
            if listens:
                wire.listen(0)
        yield


def test_two_runs_cannot_drive_a_controller():
    with controller_lock("127.0.0.1", 1025):
        for name in ("127.0.0.1", "localhost", "LOCALHOST", "127.1", "::ffff:127.0.0.1", "0.0.0.0"):
            with pytest.raises(ControlError, match=f"process {os.getpid()} .* already drives {name}:1025"):
                controller_lock(name, 1025).__enter__()
        with controller_lock("127.0.0.1", 1026), controller_lock("127.0.0.2", 1025):
            pass
    with controller_lock("localhost", 1025):
        refused("127.0.0.1")


def resolves(monkeypatch, **names):
    """Make host names resolve to given addresses."""
    resolve = socket.getaddrinfo

    def found(host, port, **options):
        return [one for address in names.get(host, (host,)) for one in resolve(address, port, **options)]

    monkeypatch.setattr(socket, "getaddrinfo", found)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("pmac", "192.0.2.200"),
        ("192.0.2.200", "pmac"),
        ("pmac", "PMAC"),
        ("pmac", "2001:db8::200"),
        ("2001:0db8:0::0200", "pmac"),
        ("me", "127.0.0.1"),
        ("127.0.1.1", "me"),
        ("localhost", "me"),
        ("::1", "localhost"),
        ("[::1]", "::1"),
    ],
)
def test_one_controller_by_two_names_is_one_lock(one, other, monkeypatch):
    both = ("192.0.2.200", "2001:db8::200")
    six = {"[::1]": ("::1",)}
    resolves(monkeypatch, pmac=both, PMAC=both, me=("127.0.1.1",), localhost=("127.0.0.1", "::1"), **six)
    with controller_lock(one, 1025):
        assert "already" in refused(other).what
    with controller_lock(other, 1025):
        pass


def test_an_address_of_this_machine_is_this_machine():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.201", 9))
        except OSError:
            pytest.skip("this machine has no network")
        here = probe.getsockname()[0]
    with controller_lock(here, 1025):
        refused("127.0.0.1")


@pytest.mark.parametrize(
    "host", ["no.such.host.invalid", "::1", "fe80::1%lo", "a/../b", "x" * 70, "é", "a b\n@", "\udcff"]
)
def test_a_lock_for_any_name(host):
    with controller_lock(host, 1025):
        assert "already" in refused(host).what
        with controller_lock(host, 1026):
            pass


def test_an_error_gives_the_lock_back():
    with pytest.raises(KeyError), controller_lock("127.0.0.1", 1025):
        raise KeyError
    with controller_lock("127.0.0.1", 1025):
        pass


def test_of_two_addresses_neither_stays_locked_where_the_other_is_taken(monkeypatch):
    resolves(monkeypatch, pmac=("192.0.2.1", "192.0.2.2"))
    with controller_lock("192.0.2.2", 1025):
        refused("pmac")
        with controller_lock("192.0.2.1", 1025):
            pass


def test_the_kernel_gives_the_lock_of_a_killed_run_back():
    with held() as other:
        error = refused()
        assert error.what.startswith(f"process {other.pid} on this computer already drives 127.0.0.1:1025")
        assert "with `yarc stop`" in error.remedy
        other.send_signal(signal.SIGKILL)
        other.wait(10)
        with controller_lock("127.0.0.1", 1025):
            pass


def test_another_runtime_folder_is_the_same_lock(tmp_path):
    """Another runtime folder gives the same lock. (Formerly, two shells with different XDG_RUNTIME_DIR could
    drive one robot.)
    """
    for name in ("one", "two"):
        (tmp_path / name).mkdir(0o700)
    for variables in (
        {"XDG_RUNTIME_DIR": str(tmp_path / "one"), "TMPDIR": str(tmp_path / "two")},
        {"HOME": "/"},
    ):
        with held(env={**os.environ, **variables}) as other:
            assert f"process {other.pid} " in refused().what


def test_the_environment_does_not_matter(tmp_path):
    bare = {"PYTHONPATH": os.pathsep.join(sys.path), "TMPDIR": str(tmp_path)}
    with held(env={SPACE: os.environ[SPACE], **bare}) as other:
        assert f"process {other.pid} " in refused().what


@as_root
def test_another_user_has_the_same_lock():
    with held(NOBODY) as other:
        error = refused()
        assert (
            f"process {other.pid} on this computer already drives 127.0.0.1:1025 (user nobody, " in error.what
        )
        assert error.remedy == "wait for its end, or ask its user to end it"
        assert find_runs() == ()
    with controller_lock("127.0.0.1", 1025):
        command = [sys.executable, "-c", HOLD, "localhost", str(NOBODY)]
        tried = subprocess.run(command, capture_output=True, text=True, check=False)
        assert (
            f"process {os.getpid()} on this computer already drives localhost:1025 (user root, "
            in tried.stderr
        )


def test_who_holds_it_is_told():
    before = time.time()
    assert holder_of("127.0.0.1", 1025) is None
    with held() as other:
        found = holder_of("localhost", 1025)
        assert (found.peer.pid, found.peer.uid) == (other.pid, os.getuid())
        assert found.is_ours
        assert before - 2 < found.since.timestamp() < time.time() + 1
        assert f"since {found.since:%Y-%m-%d %H:%M}" in refused().what
        for _ in range(100):  # more requests than the queue of connections allows
            assert holder_of("127.0.0.1", 1025).peer == found.peer


def test_a_process_that_sleeps_holds_it():
    with held() as other:
        other.send_signal(signal.SIGSTOP)
        begun = time.monotonic()
        assert f"process {other.pid} " in refused().what
        for _ in range(40):  # until the queue of connections is full
            with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX) as wire:
                wire.settimeout(0.01)
                wire.connect(lock._names("127.0.0.1", 1025)[0])
        assert "a process on this computer already drives" in refused().what
        assert time.monotonic() - begun < 5.0
        other.send_signal(signal.SIGCONT)


@pytest.mark.parametrize("listens", [False, True])
def test_a_name_that_is_taken_by_something_else(listens):
    """Another program that has taken the lock's name prevents us from using the controller. The error names
    this program as far as possible, and comes without a wait.
    """
    with bound(listens):
        begun = time.monotonic()
        error = refused()
        assert f"process {os.getpid()} " in error.what if listens else "a process on this" in error.what
        assert time.monotonic() - begun < 3.0
    with controller_lock("127.0.0.1", 1025):
        pass


def test_a_holder_that_goes_while_it_is_asked_gives_way():
    with contextlib.ExitStack() as stack:
        stack.enter_context(bound(listens=False))
        giving = threading.Timer(0.1, stack.close)
        giving.start()
        with controller_lock("127.0.0.1", 1025):
            giving.join()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"\xff\xfe\x00",
        b"[" * 5000,
        b"3\n",
        b'{"since": 3, "folder": "/"}\n',
        b'{"since": "0001-01-01", "folder": "/"}\n',
        b'{"since": "2026-01-01T00:00:00", "folder": 3}\n',
        b'{"since": "2026-01-01T00:00:00", "folder": "/\\u0000"}\n',
        json.dumps({"since": "2026-01-01T00:00:00", "folder": "/" + "x/" * 1500}).encode(),
        json.dumps({"since": "\x1b[31m", "folder": "relative"}).encode(),
    ],
)
def test_whatever_a_holder_says_of_itself_harms_nobody(answer):
    (name,) = lock._names("127.0.0.1", 1025)
    with socket.socket(socket.AF_UNIX) as wire:
        wire.bind(name)
        wire.listen()

        def speak():
            with contextlib.suppress(OSError):
                while True:
                    caller, _ = wire.accept()
                    with caller:
                        caller.sendall(answer)

        speaking = threading.Thread(target=speak, daemon=True)
        speaking.start()
        error = refused()
        assert f"process {os.getpid()} on this computer already drives 127.0.0.1:1025" in error.what
        assert "\x1b" not in error.what
        assert find_runs() == ()
        wire.shutdown(socket.SHUT_RDWR)
        speaking.join(10)


def test_locks_of_another_name_space_are_others(monkeypatch):
    with controller_lock("127.0.0.1", 1025):
        assert len(lock.own_holders()) == 1
        for space in ("", os.environ[SPACE][:-1], "another"):
            monkeypatch.setenv(SPACE, space)
            assert os.getpid() not in {one.peer.pid for one in lock.own_holders()}


def test_names_that_another_user_holds_keep_no_order_waiting(monkeypatch):
    """An order to stop finds its run at once, even if many silent processes of other users have bound similar
    names.
    """
    with contextlib.ExitStack() as stack:
        for number in range(100):
            wire = stack.enter_context(socket.socket(socket.AF_UNIX))
            wire.bind(f"\0{lock._prefix()}/x{number}:1025".encode())
            wire.listen(0)
        monkeypatch.setattr(os, "getuid", lambda: os.geteuid() + 1)
        begun = time.monotonic()
        assert lock.own_holders() == ()
        assert time.monotonic() - begun < 2.0


def test_callers_without_end_cost_the_holder_little():
    stop = threading.Event()
    code = (
        "import socket, sys\n"
        "name = bytes.fromhex(sys.argv[1])\n"
        "while True:\n"
        "  with socket.socket(socket.AF_UNIX) as wire:\n"
        "    try:\n"
        "      wire.settimeout(1.0)\n"
        "      wire.connect(name)\n"
        "    except OSError: pass\n"
    )
    name = lock._names("127.0.0.1", 1025)[0].hex()
    with controller_lock("127.0.0.1", 1025), subprocess.Popen([sys.executable, "-c", code, name]) as caller:
        time.sleep(0.5)
        before = time.thread_time(), time.process_time()
        stop.wait(1.0)
        after = time.thread_time(), time.process_time()
        caller.kill()
        others = (after[1] - before[1]) - (after[0] - before[0])
    assert others < 0.2  # [s]
    with controller_lock("127.0.0.1", 1025):
        pass


def test_a_kernel_that_refuses_is_one_error(monkeypatch):
    def refuse(*_):
        raise OSError(errno.EACCES, "Permission denied")

    class Refusing(socket.socket):
        bind = refuse

    monkeypatch.setattr(lock.socket, "socket", Refusing)
    assert refused("no.such.host.invalid").what == "the controller's lock can't be taken: permission denied"


def test_it_leaves_no_file(place_of_locks):
    before = set(place_of_locks.rglob("*"))
    with controller_lock("127.0.0.1", 1025):
        assert {path for path in place_of_locks.rglob("*") if path.name != "yarc"} <= before
