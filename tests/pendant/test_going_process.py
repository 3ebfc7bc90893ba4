"""Tests of hold-to-run of an offer with `yarc serve` and a pendant in another process, which hangs or is
killed while the button is pressed.
"""

import os
import signal
import time

import pytest
from pendant.process import first, serving
from pendant.test_process import press

from tests.cli.run_processes import Workshop
from yarclang.client import Robot


def comes_to_rest(watcher, still=1.5, within=10.0):
    """Wait until the joints haven't moved for some time. A shorter look isn't enough: on a busy computer, two
    requests may get the same report of the robot.
    """
    began = since = time.monotonic()
    before = None
    while time.monotonic() - since < still:
        assert time.monotonic() - began < within, "nobody has brought it to rest"
        now = watcher.status()
        if now["joints"] != before or now["state"] == "move":
            since, before = time.monotonic(), now["joints"]
        time.sleep(0.1)
    return before


@pytest.mark.parametrize("end", [signal.SIGSTOP, signal.SIGKILL])
def test_a_pendant_that_hangs_or_dies(tmp_path, monkeypatch, end):
    """Nobody releases the button, and no message arrives. The coordinator's own watchdog brings the robot to
    rest.
    """
    (tmp_path / "work").mkdir()
    workshop = Workshop(tmp_path / "work")
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])
    try:
        workshop.start("serve", "--robot", "INDUSTRIAL6", "--no-log").wait_for("is served: ")
        with serving(tmp_path, own=False) as (url, token, process):
            anna = first(url, token)
            anna.call("POST", "/api/control", {})
            offer = anna.order("offer", text="MOVEJ 30 0 0 0 0 0 [20] (deg,s)")["offer"]
            with anna.socket("/api/jog") as line, Robot() as watcher:
                press(line, 1, {"go": offer["number"]}, 1.5)
                assert watcher.status()["state"] == "move"
                os.kill(process.pid, end)
                try:
                    assert comes_to_rest(watcher)[0]["position"] < 20.0
                finally:
                    if end is signal.SIGSTOP:
                        os.kill(process.pid, signal.SIGCONT)
    finally:
        workshop.close()
