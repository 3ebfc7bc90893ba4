"""A real browser without a screen, and a `yarc view` to which it connects."""

from __future__ import annotations

import contextlib
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import pytest

T = TypeVar("T")

REQUIRED = "YARCLANG_REQUIRE_TOOLS"
"""Environment variable that makes a missing browser a failure if it is 1; .ci/run sets it."""
PATIENCE = 90.0
"""Longest wait for anything [s]; a busy machine without a graphics card draws slowly."""

REBOUND = "rebound.example"
"""The host name of a site that resolves to this machine's address."""

_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",  # WebGL on the CPU
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    f"--host-resolver-rules=MAP {REBOUND} 127.0.0.1, MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
    "--window-size=1200,760",
)


def browser_or_skip() -> tuple[str, str]:
    """Return the paths of Chromium and its driver; without them, skip the test.

    If a browser is required, the test fails instead.
    """
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    driver = shutil.which("chromedriver")
    if browser and driver:
        return browser, driver
    reason = "there is no chromium with its chromedriver (Debian: apt-get install chromium chromium-driver)"
    if os.environ.get(REQUIRED) == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@contextmanager
def opened_browser(profile: Path, *more: str) -> Iterator[Any]:
    """Yield a browser with an empty profile that can reach only this machine."""
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service

    browser, driver = browser_or_skip()
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for flag in (*_FLAGS, f"--user-data-dir={profile}", *more):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"performance": "ALL"})
    opened = webdriver.Chrome(service=Service(driver), options=options)
    try:
        yield opened
    finally:
        opened.quit()


@contextmanager
def viewed(*arguments: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Yield the address and the process of a `yarc view`, which gets Ctrl-C at the end."""
    command = [
        sys.executable,
        "-c",
        "from yarclang.cli.yarc import main; main()",
        "view",
        "--no-browser",
        "--port",
        "0",
    ]
    process = subprocess.Popen(
        [*command, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=lambda: [lines.put(line) for line in process.stderr or ()], daemon=True).start()
    told = ""
    try:
        while not (found := re.search(r"http://\S+", told)):
            told += lines.get(timeout=PATIENCE)
        yield found[0], process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def waited(look: Callable[[], T]) -> T:
    """Wait for a true result of `look`, and return it. If the browser is too busy to answer, ask it again."""
    from selenium.common.exceptions import TimeoutException

    since = time.monotonic()
    while True:
        with contextlib.suppress(TimeoutException):
            if found := look():
                return found
        assert time.monotonic() - since < PATIENCE, "it never came"
        time.sleep(0.2)
