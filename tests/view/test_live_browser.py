"""Tests of `yarc view --live` in a real browser: a running robot is drawn, an input is switched, and a
disconnected robot is grey.
"""

import os
import signal

import pytest
from view.browser import browser_or_skip, opened_browser, viewed, waited
from view.stages import EXAMPLES
from view.test_browser import orange, picture, text_of

from tests.cli.run_processes import Workshop


@pytest.fixture
def workshop(tmp_path, monkeypatch):
    workshop = Workshop(tmp_path)
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])
    for name in ("12_machine_cell.yarc", "12_machine_cell.toml"):
        workshop.write(name, (EXAMPLES / name).read_text())
    yield workshop
    workshop.close()


def serve(workshop):
    options = ("--cell", "12_machine_cell.toml", "--start", "40,-15,-25,0,-50,0", "--no-log")
    process = workshop.start("serve", "--robot", "INDUSTRIAL6", *options)
    process.wait_for("is served: ")
    return process


def box(browser, name):
    """Return the checkbox of a label."""
    script = """
        const label = [...document.querySelectorAll("label")].find(one => one.textContent.trim() === arguments[0]);
        return label && (label.control || label.parentElement.parentElement.querySelector("input[type=checkbox]"));
    """  # noqa: E501
    return browser.execute_script(script, name)


def test_a_running_robot(workshop, tmp_path):
    browser_or_skip()
    served = serve(workshop)
    with viewed("--live") as (url, process), opened_browser(tmp_path / "profile") as browser:
        browser.get(url)
        waited(lambda: "DOOR_OPEN" in text_of(browser))
        waited(lambda: orange(picture(browser)) > 4_000)
        running = workshop.start("exec", "12_machine_cell.yarc")
        waited(lambda: "waits for DOOR_OPEN to be ON" in text_of(browser))
        browser.execute_script("arguments[0].click()", waited(lambda: box(browser, "DOOR_OPEN")))
        waited(lambda: "at the end of 12_machine_cell.yarc" in text_of(browser))
        running.end(0)
        os.kill(served.pid, signal.SIGKILL)
        waited(lambda: "industrial6 isn't served again yet" in text_of(browser))
        waited(lambda: orange(picture(browser)) < 200)
        again = serve(workshop)
        waited(lambda: f"reported by industrial6-{again.pid}" in text_of(browser))
        waited(lambda: orange(picture(browser)) > 4_000)
        browser.refresh()
        waited(lambda: orange(picture(browser)) > 4_000)
        assert "not connected" not in text_of(browser)
    assert process.returncode == 0
