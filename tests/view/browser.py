"""A real browser without a screen, and a `yarc view` for it to look at."""

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
"""With 1 in this variable of the environment a missing browser is a failure: .ci/run sets it."""
PATIENCE = 90.0
"""How long anything may take [s]: on a loaded machine a picture without a graphics card takes a while."""

REBOUND = "rebound.example"
"""A site that has given itself this machine's address."""

_FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",  # WebGL by the processor
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
    """The paths of Chromium and its driver; without them the test is skipped, or, where a browser is
    required, fails.
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
    """A browser with an empty profile, which reaches nothing but this machine."""
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
    """A `yarc view` of its own process: its address, and the process, which gets Ctrl-C in the end."""
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
    """What a look gives as soon as that is something; a browser that is too busy to answer is asked again."""
    from selenium.common.exceptions import TimeoutException

    since = time.monotonic()
    while True:
        with contextlib.suppress(TimeoutException):
            if found := look():
                return found
        assert time.monotonic() - since < PATIENCE, "it never came"
        time.sleep(0.2)
