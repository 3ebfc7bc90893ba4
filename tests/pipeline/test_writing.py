"""A file is written whole or not at all: modes, links, full disks, kills."""

import os
import resource
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from yarclang.pipeline.writing import replace_file


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
    monkeypatch.setattr(os, "access", lambda path, how: False)  # root may write everything
    with pytest.raises(PermissionError, match="write-protected"):
        replace_file(path, b"y")
    assert (path.read_bytes(), sorted(tmp_path.iterdir())) == (b"x", [path])


def test_a_device_is_written(tmp_path):
    replace_file(Path("/dev/null"), b"x")
    assert Path("/dev/null").is_char_device()


def test_nothing_is_lost_on_a_full_disk(tmp_path):
    """A limit of the size of files fails as a full disk does: in the middle of the writing."""
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
from yarclang.pipeline.writing import replace_file
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
