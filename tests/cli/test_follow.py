"""`yarc follow`, with another process that steers the robot."""

import contextlib
import json
import os
import signal
import socket
import stat
import time

import pytest

from yarclang.cli.secret_file import secret_file


def lines_of(text):
    return [json.loads(line) for line in text.splitlines()]


FOLLOW = ("follow", "--robot", "INDUSTRIAL6", "--no-log")


def listening(process):
    """Return the event that says where masters connect to."""
    process.wait_for('"listening"')
    return next(one for one in lines_of("".join(process.out)) if one["event"] == "listening")


def connected(event, token=None):
    """Return a connection as a master makes it; with a token, the token is sent first."""
    if "unix" in event:
        wire = socket.socket(socket.AF_UNIX)
        wire.connect(event["unix"])
    else:
        wire = socket.create_connection((event["host"], event["port"]))
    wire.settimeout(20)
    lines = wire.makefile("rw")
    wire.close()  # the file keeps the connection open
    if token is not None:
        assert asked(lines, json.dumps({"token": token})) == {"ok": True}
    return lines


def asked(lines, text):
    lines.write(text + "\n")
    lines.flush()
    return json.loads(lines.readline())


@pytest.mark.parametrize("where", [(), ("--unix", "here.sock"), ("--port", "0")])
def test_another_process_steers_until_a_termination(where, workshop, simulator):
    process = workshop.start(*FOLLOW, "--to", simulator.address, *where)
    event = listening(process)
    with connected(event, event.get("token")) as lines:
        until = time.monotonic() + 20.0
        # on a busy computer the motion may end too early; the next line then begins another motion
        while simulator.joints()[0] < 0.5:
            assert time.monotonic() < until, process.text
            for _ in range(50):
                asked(lines, '{"velocity": {"J1": 5}}')
                time.sleep(0.02)
        assert asked(lines, "nonsense")["ok"] is False
        assert lines.readline() == ""
        process.signal(signal.SIGTERM)
        found = lines_of(process.end(0))
    assert found[-1]["event"] == "ended"
    assert found[-1]["status"] == 0
    assert simulator.stands()[0] == pytest.approx(found[-1]["joints"]["J1"], abs=1e-3)
    assert not simulator.complaints()
    assert not [one for one in workshop.folder.iterdir() if one.suffix == ".sock"]


def test_a_log_that_is_removed_meanwhile_is_lost(workshop, simulator):
    words = [word for word in FOLLOW if word != "--no-log"]
    process = workshop.start(*words, "--to", simulator.address, "--log", "run.mcap")
    with connected(listening(process)) as lines:
        asked(lines, '{"velocity": {"J1": 1}}')
        until = time.monotonic() + 20.0
        while not (workshop.folder / "run.mcap").exists():
            assert time.monotonic() < until
            time.sleep(0.02)
        (workshop.folder / "run.mcap").unlink()
        process.signal(signal.SIGTERM)
        *_, message, last = lines_of(process.end(1))
    assert (last["event"], last["status"], last["log"]) == ("ended", 1, None)
    assert message["text"].startswith("the run log can't be used any more: run.mcap doesn't exist any more")


def test_a_web_page_that_posts_an_order_moves_nothing(workshop, simulator):
    """A web page posts ten lines that aren't JSON and then an order, which must not move the robot."""
    process = workshop.start(*FOLLOW, "--to", simulator.address, "--port", "0", "--token-file", "token")
    event = listening(process)
    assert event["token_file"] == "token"
    assert "token" not in event
    file = workshop.folder / "token"
    assert stat.S_IMODE(file.lstat().st_mode) == 0o600
    token = file.read_text().strip()
    assert token not in process.text
    order = '{"velocity": {"J1": 10}}'
    page = f"POST / HTTP/1.1\r\nHost: 127.0.0.1:{event['port']}\r\nContent-Type: text/plain\r\n\r\n"
    for text in (page, page + f'{{"token": "{token}"}}\n', "a\n" * 10, "", f'{{"token": "{token[::-1]}"}}\n'):
        with connected(event) as lines, contextlib.suppress(ConnectionError):
            answer = asked(lines, text + f"{order}\n" * 20)
            assert answer["ok"] is False
            assert lines.read() == ""
    assert (simulator.stands() == 0.0).all()
    with connected(event, token) as lines:
        assert asked(lines, order)["ok"] is True
    process.signal(signal.SIGTERM)
    process.end(0)
    assert not file.exists()


@pytest.mark.parametrize("kind", ["folder", "link", "pipe", "missing"])
def test_a_token_file_that_cannot_be_written(kind, workshop, simulator):
    path = workshop.folder / "token"
    match kind:
        case "folder":
            path.mkdir()
        case "link":
            (workshop.folder / "mine").write_text("mine")
            path.symlink_to("mine")
        case "pipe":
            os.mkfifo(path)
        case "missing":
            path = path / "below"
    process = workshop.start(*FOLLOW, "--to", simulator.address, "--port", "0", "--token-file", str(path))
    found = lines_of("".join(line for line in process.end(1).splitlines(keepends=True)))
    assert found[-1]["what"].startswith(f"the token can't be written to {path}: ")
    assert "listening" not in process.text
    if kind == "link":
        assert (workshop.folder / "mine").read_text() == "mine"


def test_a_file_that_was_written_anew_is_not_removed(tmp_path):
    """A file that somebody has rewritten isn't removed, even if it has the removed file's inode number."""
    path = tmp_path / "token"
    with secret_file(path, "secret"):
        number = path.lstat().st_ino
        path.write_text("mine")
        assert path.lstat().st_ino == number
    assert path.read_text() == "mine"
    path.unlink()
    with secret_file(path, "secret"):
        assert path.read_text() == "secret"
    assert not path.exists()


def test_a_token_file_is_replaced_and_nobody_elses_is_removed(workshop, simulator):
    path = workshop.folder / "token"
    path.write_text("old, and for everybody")
    path.chmod(0o666)
    process = workshop.start(*FOLLOW, "--to", simulator.address, "--port", "0", "--token-file", "token")
    listening(process)
    assert stat.S_IMODE(path.lstat().st_mode) == 0o600
    assert len(path.read_text().strip()) >= 43
    path.unlink()
    path.write_text("mine")
    process.signal(signal.SIGTERM)
    process.end(0)
    assert path.read_text() == "mine"


@pytest.mark.parametrize(
    ("arguments", "status", "code"),
    [
        (("--robot", "NOPE"), 1, "Y1301"),
        ((), 1, "Y1391"),
        (("--robot", "INDUSTRIAL6", "--to", "tcp://127.0.0.1:9"), 1, "Y1601"),
        (("--robot", "INDUSTRIAL6", "--speed", "-1"), 2, ""),
        (("--robot", "INDUSTRIAL6", "--port", "70000"), 2, ""),
        (("--log", "x", "--no-log"), 2, ""),
        (("--unix", "a.sock", "--port", "0"), 2, ""),
        (("--token-file", "token"), 2, ""),
    ],
)
def test_what_cannot_be_followed(workshop, arguments, status, code):
    text = workshop.here("follow", *arguments, status=status)
    if status == 1:
        found = lines_of(text)
        told = [one["code"] for one in found[0].get("findings", [])] + [found[-1]["code"]]
        assert code in told
