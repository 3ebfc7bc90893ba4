"""`yarc follow`: another process steers the robot."""

import json
import re
import signal
import socket
import time

import pytest


def lines_of(text):
    return [json.loads(line) for line in text.splitlines()]


def test_another_process_steers_until_a_termination(workshop, simulator):
    process = workshop.start("follow", "--robot", "INDUSTRIAL6", "--to", simulator.address, "--no-log")
    process.wait_for('"listening"')
    port = int(re.search(r'"port": (\d+)', process.text)[1])
    with socket.create_connection(("127.0.0.1", port)) as wire, wire.makefile("rw") as lines:
        until = time.monotonic() + 20.0
        # a computer with much to do may hold it on the way: the next line begins another motion
        while simulator.joints()[0] < 0.5:
            assert time.monotonic() < until, process.text
            for _ in range(50):
                lines.write('{"velocity": {"J1": 5}}\n')
                lines.flush()
                json.loads(lines.readline())
                time.sleep(0.02)
        lines.write("nonsense\n")
        lines.flush()
        assert json.loads(lines.readline())["ok"] is False
        process.signal(signal.SIGTERM)
        found = lines_of(process.end(0))
    assert found[-1]["event"] == "ended"
    assert found[-1]["status"] == 0
    assert simulator.stands()[0] == pytest.approx(found[-1]["joints"]["J1"], abs=1e-3)
    assert not simulator.complaints()


@pytest.mark.parametrize(
    ("arguments", "status", "code"),
    [
        (("--robot", "NOPE"), 1, "Y1301"),
        ((), 1, "Y1391"),
        (("--robot", "INDUSTRIAL6", "--to", "tcp://127.0.0.1:9"), 1, "Y1601"),
        (("--robot", "INDUSTRIAL6", "--speed", "-1"), 2, ""),
        (("--robot", "INDUSTRIAL6", "--port", "70000"), 2, ""),
        (("--log", "x", "--no-log"), 2, ""),
    ],
)
def test_what_cannot_be_followed(workshop, arguments, status, code):
    text = workshop.here("follow", *arguments, status=status)
    if status == 1:
        found = lines_of(text)
        told = [one["code"] for one in found[0].get("findings", [])] + [found[-1]["code"]]
        assert code in told
