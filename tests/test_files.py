"""Tests of writing files: a file is written as a whole or not at all, for all modes and links, full disks and
kills.
"""

import os
import resource
import signal
import socket
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from yarclang.files import read_whole, replace_file


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_file_has_the_plain_mode(tmp_path):
    path = tmp_path / "new" / "a.yarc"
    replace_file(path, b"x")
    plain = tmp_path / "plain"
    plain.write_bytes(b"")
    assert (path.read_bytes(), mode(path)) == (b"x", mode(plain))


@pytest.mark.parametrize("bits", [0o600, 0o644, 0o755, 0o664])
def test_the_mode_stays(tmp_path, bits):
    path = tmp_path / "a.yarc"
    path.write_bytes(b"x")
    path.chmod(bits)
    replace_file(path, b"y")
    assert (path.read_bytes(), mode(path)) == (b"y", bits)


def test_a_link_stays_and_leads_to_what_is_written(tmp_path):
    (tmp_path / "folder").mkdir()
    target, link, farther = tmp_path / "folder" / "a.yarc", tmp_path / "b.yarc", tmp_path / "c.yarc"
    target.write_bytes(b"x")
    link.symlink_to("folder/a.yarc")
    farther.symlink_to(link)
    replace_file(farther, b"y")
    assert (link.is_symlink(), farther.is_symlink(), target.is_symlink()) == (True, True, False)
    assert target.read_bytes() == b"y"
    missing = tmp_path / "d.yarc"
    missing.symlink_to("folder/new.yarc")
    replace_file(missing, b"z")
    assert missing.is_symlink()
    assert (tmp_path / "folder" / "new.yarc").read_bytes() == b"z"


def test_a_name_that_is_as_long_as_it_may_be(tmp_path):
    path = tmp_path / ("ä" * 125 + ".yarc")
    replace_file(path, b"x")
    assert path.read_bytes() == b"x"


def test_what_is_write_protected_stays(tmp_path, monkeypatch):
    path = tmp_path / "a.yarc"
    path.write_bytes(b"x")
    path.chmod(0o444)
    # otherwise, this test would fail for root, who may write everything
    monkeypatch.setattr(os, "access", lambda path, how: False)
    with pytest.raises(PermissionError, match="write-protected"):
        replace_file(path, b"y")
    assert (path.read_bytes(), sorted(tmp_path.iterdir())) == (b"x", [path])


def test_a_device_is_written(tmp_path):
    replace_file(Path("/dev/null"), b"x")
    assert Path("/dev/null").is_char_device()


def test_nothing_is_lost_on_a_full_disk(tmp_path):
    """Writing beyond a limit on the size of files fails as a full disk does: in the middle of writing."""
    path = tmp_path / "a.yarc"
    path.write_bytes(b"x" * 1000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, before[1]))
    try:
        with pytest.raises(OSError, match="too large"):
            replace_file(path, b"y" * 50_000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert (path.read_bytes(), sorted(tmp_path.iterdir())) == (b"x" * 1000, [path])


def test_nothing_is_lost_when_the_rename_fails(tmp_path, monkeypatch):
    path = tmp_path / "a.yarc"
    path.write_bytes(b"x")

    def interrupted(self, target):
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        replace_file(path, b"y")
    assert (path.read_bytes(), sorted(tmp_path.iterdir())) == (b"x", [path])


WRITER = """
import sys
from pathlib import Path
from yarclang.files import replace_file
path, size = Path(sys.argv[1]), 300_000
for number in range(100_000):
    replace_file(path, (b"x" if number % 2 else b"y") * size)
    if number == 3:
        print("going", flush=True)
"""


@pytest.mark.parametrize("delay", [0.0, 0.013, 0.031])
def test_a_kill_at_any_time_leaves_one_whole_version(tmp_path, delay):
    path = tmp_path / "a.yarc"
    path.write_bytes(b"x" * 300_000)
    with subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdout=subprocess.PIPE) as writer:
        writer.stdout.readline()
        time.sleep(delay)
        writer.kill()
        writer.wait()
    content = path.read_bytes()
    assert content in (b"x" * 300_000, b"y" * 300_000)


# reading


def refused(path, most=1000):
    try:
        read_whole(path, most)
    except OSError as error:
        return error.strerror
    return None


def test_a_file_is_read(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"x" * 1000)
    assert read_whole(path, 1000) == b"x" * 1000
    assert refused(path, 999) == "it has 1,000 bytes; at most 999 are read"


def test_what_is_no_file_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(str(tmp_path / "s"))
        assert refused(tmp_path / "s") == "it is a socket, not a file"
    assert refused(tmp_path) == "it is a folder, not a file"
    assert refused(tmp_path / "pipe") == "it is a pipe, not a file"
    for device in ("/dev/zero", "/dev/null", "/dev/full"):
        assert refused(Path(device)) == "it is a device, not a file"
    assert refused(Path("a\0b")) == "embedded null byte"
    assert refused(tmp_path / "nothing") == "No such file or directory"


def test_a_file_that_grows_without_end_is_given_up(tmp_path):
    """Files in /proc don't state their size, so that only reading shows that a file is too large."""
    assert "more than 10 bytes" in refused(Path("/proc/self/environ"), 10)


def test_a_huge_file_is_refused_by_its_size(tmp_path):
    path = tmp_path / "huge"
    with path.open("wb") as file:
        file.truncate(50_000_000_000)
    assert refused(path) == "it has 50,000,000,000 bytes; at most 1,000 are read"


SHELL = (
    f"exec {sys.executable} -c 'import sys; from pathlib import Path; from yarclang.files import "
    "read_whole; print(read_whole(Path(sys.argv[1]), 1000))'"
)


@pytest.mark.parametrize(
    "argument", ["<(echo hello)", "/dev/stdin < <(echo hello)", "/dev/fd/7 7< <(echo hello)"]
)
def test_what_a_shell_gives_open_is_read(argument):
    done = subprocess.run(["bash", "-c", f"{SHELL} {argument}"], capture_output=True, text=True, check=True)
    assert done.stdout == "b'hello\\n'\n"


def test_a_stream_without_end_is_given_up():
    done = subprocess.run(
        ["bash", "-c", f"{SHELL} /dev/stdin < /dev/zero"], capture_output=True, text=True, check=False
    )
    assert "more than 1,000 bytes" in done.stderr
