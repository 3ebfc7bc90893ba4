"""Tests of the pendant as a process, through the API alone: everything that its pages do, restarts, kills,
other processes, and wrong usage.
"""

import contextlib
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import time

import pytest
from pendant.process import PASSWORD, PIN, PROGRAM, Api, first, serving


def until(line, wanted, within=10.0):
    """Wait for the next message of a socket that fulfils a condition, and return it."""
    end = time.monotonic() + within
    while True:
        message = json.loads(line.recv(timeout=max(0.0, end - time.monotonic())))
        if wanted(message):
            return message


def press(line, number, want, seconds):
    """Hold a button for a time. Return the messages of the jog."""
    heard, end = [], time.monotonic() + seconds
    with contextlib.suppress(TimeoutError):  # drop the heartbeats that have waited, since they are old
        while True:
            line.recv(timeout=0.001)
    while time.monotonic() < end:
        message = json.loads(line.recv(timeout=5))
        heard.append(message)
        if "beat" in message:
            line.send(json.dumps({"press": number, "beat": message["beat"], **want}))
    return heard


def rests(api, within=10.0):
    """Wait until nothing is running."""
    end = time.monotonic() + within
    while api.order("status")["state"] != "stop":
        assert time.monotonic() < end
        time.sleep(0.05)


def test_everything_by_way_of_the_api(tmp_path):
    (tmp_path / "bend.yarc").write_text(PROGRAM)
    with serving(tmp_path) as (url, token, process):
        anna = first(url, token)
        assert Api(url).call("GET", "/api/me", status=401)["first"] is False
        robot = anna.call("GET", "/api/robot")
        assert [joint["name"] for joint in robot["joints"]] == ["J1", "J2", "J3", "J4", "J5", "J6"]
        assert [robot["moving"][0]["name"], robot["fixed"][0]["name"]] == ["{TCP}", "{B}"]
        # Users and sessions.
        anna.call(
            "POST", "/api/users", {"user": "olaf", "role": "operator", "password": PASSWORD}, status=403
        )
        anna.call("POST", "/api/pin", {"pin": PIN})
        for name, role in (("olaf", "operator"), ("vic", "viewer")):
            anna.call("POST", "/api/users", {"user": name, "role": role, "password": PASSWORD})
        olaf, vic = Api(url), Api(url)
        olaf.call("POST", "/api/login", {"user": "olaf", "password": PASSWORD})
        vic.call("POST", "/api/login", {"user": "vic", "password": PASSWORD})
        assert len(anna.call("GET", "/api/sessions")["sessions"]) == 3
        # Run, hold, resume, override, stop.
        with olaf.socket("/api/robot") as page:
            assert olaf.call("POST", "/api/control", {})["given"]
            loaded = olaf.order("load", file="bend.yarc", approach=True)["program"]
            page.send(json.dumps({"order": "run", "program": loaded["number"], "id": "run"}))
            until(
                page,
                lambda one: (
                    one.get("event") == "display" and one["mode"] == "program" and one["done_s"] > 0.5
                ),
            )
            olaf.order("override", percent=50.0)
            olaf.order("hold")
            until(page, lambda one: one.get("event") == "display" and one["mode"] == "held")
            olaf.order("resume")
            until(page, lambda one: one.get("event") == "display" and one["mode"] == "program")
            vic.call("POST", "/api/orders/hold", {}, status=403)
            vic.order("stop")
            assert until(page, lambda one: one.get("id") == "run")["what"] == "stopped on its path"
            olaf.order("override", percent=100.0)
            # anna gets control, and jogs.
            assert anna.call("POST", "/api/control", {})["given"] is False
            ask = until(page, lambda one: one.get("ask"))
            olaf.call("POST", "/api/control/give", {"to": ask["ask"]})
        with anna.socket("/api/jog") as line:
            before = anna.order("where")["joints"]["J1"]
            press(line, 1, {"velocity": {"J1": 10.0}, "share": 0.5}, 0.8)
            line.send('{"release": 1}')
            until(line, lambda one: one.get("state") == "ended")
            rests(anna)
            end = time.monotonic() + 15.0
            while not any(
                one.get("state") == "reached"
                for one in press(line, 2, {"step": {"axis": "J2", "by": -1.0}}, 0.5)
            ):
                assert time.monotonic() < end
            rests(anna)
        now = anna.order("where")["joints"]
        assert now["J1"] > before + 1.0
        health = anna.order("health")
        assert all(motor["closed_loop"] and motor["homed"] for motor in health["motors"])
        assert anna.order("look")["wrong"] == []
        # The audit trail has the actions of all users.
        deeds = [(one["user"], one["action"]) for one in anna.call("GET", "/api/audit?count=500")["entries"]]
        for deed in (
            ("olaf", "run"),
            ("vic", "stop"),
            ("olaf", "hold"),
            ("olaf", "give"),
            ("anna", "jog"),
            ("anna", "add user"),
        ):
            assert deed in deeds
        vic.call("GET", "/api/audit", status=403)
        anna.call("DELETE", "/api/users/vic")
        vic.call("GET", "/api/me", status=401)
        anna.call("POST", "/api/logout")
        anna.call("GET", "/api/robot", status=401)
        # The pendant also serves other files, such as its description as OpenAPI.
        document = Api(url).call("GET", "/api/openapi.json")
        assert document["openapi"].startswith("3.1")
        assert set(document["paths"]["/api/orders/run"]) == {"post"}
    assert process.returncode == 0


def test_it_is_killed_while_it_jogs(tmp_path):
    """If the pendant dies, the guard PLC brings the robot to rest, and the database of users stays intact."""
    simulator = subprocess.Popen(
        [sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "sim", "--robot", "INDUSTRIAL6",
            "--port", "0"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        found = re.search(r"listens on (\S+),", simulator.stdout.readline())
        assert found
        address = f"tcp://{found[1]}"
        with serving(tmp_path, "--to", address) as (url, token, process):
            anna = first(url, token)
            anna.call("POST", "/api/control", {})
            with anna.socket("/api/jog") as line:
                press(line, 1, {"velocity": {"J1": 20.0}}, 1.0)
                os.kill(process.pid, signal.SIGKILL)
                process.wait()
        time.sleep(1.5)
        # The guard PLC holds the robot: nothing moves until a user ends the held motion at the robot's
        # present position.
        with serving(tmp_path, "--to", address) as (url, _, _):
            api = Api(url)
            api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
            assert api.order("status")["state"] == "fault"
            assert any("an unfinished program is held" in one for one in api.order("look")["wrong"])
            api.call("POST", "/api/control", {})
            api.order("clear")
            assert api.order("status")["state"] == "stop"
            there = api.order("where")["joints"]["J1"]
            time.sleep(0.3)
            assert api.order("where")["joints"]["J1"] == there
            assert there > 2.0
            assert ("anna", "jog") in [
                (one["user"], one["action"]) for one in api.call("GET", "/api/audit")["entries"]
            ]
    finally:
        simulator.terminate()
        simulator.wait(20)
        simulator.stdout.close()


def said(address, line):
    """Send a line directly to a simulator, and return its reply."""
    host, _, port = address.removeprefix("tcp://").rpartition(":")
    with socket.create_connection((host, int(port)), timeout=10) as wire:
        wire.sendall(struct.pack(">BBHHH", 0x40, 0xBF, 0, 0, len(line)) + line.encode())
        heard = b""
        while not heard.endswith((b"\x06", b"\r")) or b"\x06" not in heard:
            heard += wire.recv(2000)
    return heard.decode().strip("\x06\r")


def moves(address):
    before = said(address, "#1P")
    time.sleep(0.02)
    return said(address, "#1P") != before


def test_it_is_killed_while_it_homes(tmp_path):
    """The controller carries out a home search by itself. If the pendant dies, a PLC of the controller stops
    the search. After a restart, everything works as before.
    """
    simulator = subprocess.Popen(
        [sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "sim", "--robot", "INDUSTRIAL6",
            "--port", "0"],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        found = re.search(r"listens on (\S+),", simulator.stdout.readline())
        assert found
        address = f"tcp://{found[1]}"
        said(address, "$$$ I6=1 I3=2")
        with serving(tmp_path, "--to", address) as (url, token, process):
            anna = first(url, token)
            anna.call("POST", "/api/control", {})
            anna.call("POST", "/api/pin", {"pin": PIN})
            assert anna.order("status")["state"] == "fault"
            told = anna.order("enable")
            assert told["what"] == ""
            assert all("isn't homed" in one for one in told["wrong"])
            said(address, "#1J=-150000")
            while moves(address):
                pass
            with anna.socket("/api/jog") as line:
                press(line, 1, {"home": [1]}, 1.0)
                assert moves(address)
                os.kill(process.pid, signal.SIGKILL)
                killed = time.monotonic()
                process.wait()
                while moves(address):
                    assert time.monotonic() - killed < 3.0
        # 0.4 s of silence, the time to brake, and a reserve for a busy computer
        assert time.monotonic() - killed < 2.0
        assert float(said(address, "#1P")) < -40000.0
        with serving(tmp_path, "--to", address) as (url, _, process):
            api = Api(url)
            api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
            api.call("POST", "/api/control", {})
            api.call("POST", "/api/pin", {"pin": PIN})
            assert any("motor 1 is" in one for one in api.order("look")["wrong"])
            with api.socket("/api/jog") as line:
                heard = press(line, 1, {"home": [1]}, 8.0)
            assert "reached" in [one.get("state") for one in heard]
            assert not any("motor 1 is" in one for one in api.order("look")["wrong"])
            # The process restarts at the same address, and nobody has to log in again.
            since = api.call("GET", "/api/system/controller")["since"]
            time.sleep(1.0)
            api.call("POST", "/api/system/restart", {})
            until_again(api, since)
            assert process.poll() is None
            assert api.call("POST", "/api/system/shut-down", {}, status=403)["code"] == "pin"
            api.call("POST", "/api/pin", {"pin": PIN})
            api.call("POST", "/api/system/shut-down", {})
            assert process.wait(20) == 0
    finally:
        simulator.terminate()
        simulator.wait(20)
        simulator.stdout.close()


def until_again(api, since):
    end = time.monotonic() + 40.0
    while True:
        assert time.monotonic() < end
        time.sleep(0.3)
        with contextlib.suppress(OSError):
            if api.call("GET", "/api/system/controller")["since"] != since:
                return


def usage(*arguments):
    script = "from yarclang.cli.yarc import main; main()"
    return subprocess.run(
        [sys.executable, "-c", script, "pendant", "--robot", "INDUSTRIAL6", "--no-log", *arguments],
        capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "status", "told"),
    [
        (("--host", "0.0.0.0"), 2, "unencrypted"),
        (("--tls-cert", "a.pem"), 2, "belong together"),
        (("--tls", "self-signed", "--tls-cert", "a", "--tls-key", "b"), 2, "exclude each other"),
        (("--tls-cert", "none.pem", "--tls-key", "none.pem"), 1, "can't be used for TLS"),
        (("--folder", "/nowhere"), 2, "does not exist"),
        (("--port", "99999"), 2, "99999"),
        (("--host", "no.such.host.invalid", "--tls", "self-signed"), 1, "can't be listened on"),
        (("--data", "/proc/nowhere"), 1, "pendant.db"),
    ],
)
def test_wrong_usage_is_one_clear_error(tmp_path, arguments, status, told):
    data = () if "--data" in arguments else ("--data", str(tmp_path))
    ended = usage(*data, *arguments)
    assert (ended.returncode, told in ended.stderr) == (status, True), ended.stderr
    assert "Traceback" not in ended.stderr


def test_a_port_that_is_taken(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        ended = usage("--data", str(tmp_path), "--port", str(taken.getsockname()[1]))
    assert (ended.returncode, "in use" in ended.stderr) == (1, True), ended.stderr


def test_tls(tmp_path):
    import ssl
    import urllib.request

    with serving(tmp_path, "--tls", "self-signed") as (url, _, _):
        assert url.startswith("https://")
        trusted = ssl.create_default_context(cafile=str(tmp_path / "data" / "certificate.pem"))
        with urllib.request.urlopen(url, context=trusted, timeout=20) as answer:
            assert b"TCPad" in answer.read()
            assert "max-age" in answer.headers["strict-transport-security"]
        assert (tmp_path / "data" / "key.pem").stat().st_mode & 0o077 == 0


def test_the_served_robot_dies_and_is_served_again(tmp_path, monkeypatch):
    """If `yarc serve` dies, the pendant says that the robot can't be reached. It finds the robot when it is
    served again.
    """
    from tests.cli.run_processes import Workshop

    (tmp_path / "work").mkdir()
    workshop = Workshop(tmp_path / "work")
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])
    (tmp_path / "bend.yarc").write_text(PROGRAM)
    try:
        served = workshop.start("serve", "--robot", "INDUSTRIAL6", "--no-log")
        served.wait_for("is served: ")
        with serving(tmp_path, own=False) as (url, token, _):
            anna = first(url, token)
            anna.call("POST", "/api/control", {})
            with anna.socket("/api/robot") as page:
                number = anna.order("load", file="bend.yarc")["program"]["number"]
                page.send(json.dumps({"order": "run", "program": number, "id": 1}))
                until(page, lambda one: one.get("event") == "display" and one["mode"] == "program")
                os.kill(served.pid, signal.SIGKILL)
                assert "has ended" in until(page, lambda one: one.get("id") == 1)["error"]
                until(page, lambda one: one.get("event") == "display" and not one["connected"])
                anna.call("POST", "/api/orders/stop", {}, status=409)
                workshop.start("serve", "--robot", "INDUSTRIAL6", "--no-log").wait_for("is served: ")
                shown = until(page, lambda one: one.get("event") == "display" and one["connected"], 30.0)
                assert shown["owner"] is None
            assert anna.call("POST", "/api/control", {})["given"]
            anna.order("stop")
    finally:
        workshop.close()
