"""The usage of `yarc view`, and its refusals with their texts; tests/view checks what it shows."""

import importlib.util
import socket
from pathlib import Path

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main

EXAMPLE = str(Path(__file__).resolve().parents[2] / "examples" / "01_listing4.yarc")
INDUSTRIAL6 = ["--robot", "INDUSTRIAL6"]


def view(*arguments):
    result = CliRunner().invoke(main, ["view", "--no-browser", *arguments])
    assert "Traceback" not in result.output
    return result


def test_without_viser_it_says_what_to_install(monkeypatch):
    known = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name == "viser" else known(name))
    result = view(EXAMPLE)
    assert result.exit_code == 1
    assert "pip install '.[view]' in yarclang's folder" in result.output


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("missing.yarc", None, "Y0107"),
        ("missing.mcap", None, "Y0107"),
        ("empty.yarc", b"", "Y0104"),
        ("empty.mcap", b"", "Y1401"),
        ("other.mcap", b"something else", "Y1401"),
        ("half.mcap", b"\x89MCAP0\r\n", "Y1401"),
        ("bytes.yarc", b"\xff\xfe\x00", "Y0103"),
        ("short.pmc", b"; yarcc 0.1.0: a.yarc\n; robot INDUSTRIAL6 0\n", "Y11"),
    ],
)
def test_what_cannot_be_shown(tmp_path, name, content, code):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    result = view(str(path), *INDUSTRIAL6)
    assert result.exit_code == 1
    assert f"error {code}" in result.output
    assert "nothing to show" in result.output


@pytest.mark.parametrize(
    "arguments",
    [
        ["a.mcap", "--tm", "5"],
        ["a.pmc", "--start", "0"],
        ["a.yarc", "--port", "65536"],
        ["a.yarc", "--host", " "],
        [],
    ],
)
def test_wrong_usage(arguments):
    assert view(*arguments).exit_code == 2


def test_a_port_in_use_is_said():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        result = view(EXAMPLE, *INDUSTRIAL6, "--port", str(port))
    assert result.exit_code == 1
    assert f"can't listen on 127.0.0.1 port {port}: address already in use" in result.output
    assert "--port 0" in result.output


@pytest.mark.parametrize(
    ("host", "warned"),
    [("127.0.0.1", False), ("localhost", False), ("::1", False), ("0.0.0.0", True), ("robot.lan", True)],
)
def test_the_network_is_told_of(host, warned, monkeypatch):
    from yarclang.view import show

    def at_once(stage, door, ready):
        ready(door)
        raise KeyboardInterrupt

    monkeypatch.setattr(show, "show", at_once)
    result = view(EXAMPLE, *INDUSTRIAL6, "--host", host)
    assert result.exit_code == 0
    assert ("warning" in result.output) is warned
    assert "is shown at http://" in result.output


def test_a_browser_is_opened_unless_nobody_wants_it(monkeypatch):
    import webbrowser

    from yarclang.view import show

    opened = []
    monkeypatch.setattr(webbrowser, "open", opened.append)
    monkeypatch.setattr(show, "show", lambda stage, door, ready: ready(show.Door(door.host, 4711)))
    assert view(EXAMPLE, *INDUSTRIAL6).exit_code == 0
    assert opened == []
    assert CliRunner().invoke(main, ["view", EXAMPLE, *INDUSTRIAL6]).exit_code == 0
    assert opened == ["http://127.0.0.1:4711"]
