"""The robot's description for launch files, from the server, or an error with a remedy in bounded time."""

import contextlib
import json
import os
import socket
import subprocess
import threading
import time
from pathlib import Path

import pytest

import yarclang
from yarclang.ros.node.description import described

ROOT = Path(yarclang.__file__).parents[1]
PYTHON = "/usr/bin/python3"
WELCOME = {"ok": True, "version": 1}


@contextlib.contextmanager
def serving(folder, *answers):
    """Start a fake server of a robot that gives these answers, which are objects or bytes."""
    folder.mkdir(exist_ok=True)
    path = folder / "arm-1.sock"
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(str(path))
    listening.listen()

    def serve():
        with contextlib.suppress(OSError):
            while True:
                wire, _ = listening.accept()
                with wire, wire.makefile("rwb") as file:
                    for answer in answers:
                        asked = json.loads(file.readline() or b"{}")
                        line = (
                            answer
                            if isinstance(answer, bytes)
                            else json.dumps({**answer, "id": asked.get("id")}).encode()
                        )
                        file.write(line + b"\n")
                        file.flush()
                    file.readline()

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield str(path)
    finally:
        listening.shutdown(socket.SHUT_RDWR)
        listening.close()
        thread.join(5.0)


def test_the_model_is_what_the_server_tells(tmp_path):
    model = {"ok": True, "urdf": "<robot/>", "base": "b"}
    with serving(tmp_path, WELCOME, model) as path:
        told = described(path)
        assert (told["urdf"], told["base"]) == ("<robot/>", "b")


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        ({"ok": False, "error": "there is no order model", "help": "update it"}, "no order model. update it"),
        (b"not json", "isn't understood: is it another version of yarc"),
        (b"[]", "isn't understood: is it another version of yarc"),
    ],
)
def test_a_server_that_refuses_or_is_another_one_is_told(tmp_path, answer, said):
    with serving(tmp_path, WELCOME, answer) as path, pytest.raises(ValueError, match=said):
        described(path, 0.0)


def test_it_waits_until_the_robot_is_served(tmp_path):
    later = contextlib.ExitStack()
    threading.Timer(
        0.7, lambda: later.enter_context(serving(tmp_path, WELCOME, {"ok": True, "urdf": "u"}))
    ).start()
    with later:
        assert described(str(tmp_path / "arm-1.sock"), 10.0)["urdf"] == "u"


def test_nobody_serves_it(tmp_path):
    began = time.monotonic()
    with pytest.raises(ValueError, match=r"Start it as the same user: yarc serve"):
        described(str(tmp_path / "arm-1.sock"), 0.5)
    assert time.monotonic() - began < 5.0


@pytest.mark.skipif(not os.access(PYTHON, os.X_OK), reason="no Python of the system")
def test_as_a_launch_file_calls_it(tmp_path):
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}

    def call(*arguments):
        return subprocess.run(
            [PYTHON, "-m", "yarclang.ros.node.description", *arguments],
            check=False,
            env=environment,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=60,
        )

    with serving(tmp_path, WELCOME, {"ok": True, "urdf": "<robot name='\u00e4'/>"}) as path:
        done = call(path)
        assert (done.returncode, done.stdout, done.stderr) == (0, "<robot name='\u00e4'/>", "")
    with serving(tmp_path / "fresh", WELCOME, {"ok": False, "error": "no"}) as path:
        done = call(path)
        assert (done.returncode, done.stdout, done.stderr) == (1, "", "no\n")
    assert call("--help").returncode == 0
    assert call("a", "b").returncode == 2
