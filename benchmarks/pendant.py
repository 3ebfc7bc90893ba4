"""Measure the pendant in a real browser (headless Chromium, software GL, loopback): the time from a press to
the robot's motion, the time from the release to the hold, and the cost of watchers.

    python benchmarks/pendant.py            # about 4 minutes
    python benchmarks/pendant.py --minutes 10   # also the memory with twenty watchers, after this time

Times are measured in the page, from the pointer's event to the message about its effect, so they include the
way of this message to the page.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import tempfile
import threading
import time
from pathlib import Path

# replace this folder in the path: one of its modules has the name of a folder of the tests
sys.path[0] = str(Path(__file__).resolve().parent.parent / "tests")

from pendant.process import PROGRAM, serving  # noqa: E402
from pendant.test_browser import Place, Proxy, click, goes_to, size, touch, until  # noqa: E402
from view.browser import opened_browser  # noqa: E402

SPY = """
window.told = [];
const Real = WebSocket;
window.WebSocket = class extends Real {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", (event) => window.told.push([performance.now(), event.data]));
  }
};
for (const kind of ["pointerdown", "pointerup"]) window.addEventListener(kind, () => { window[kind] = performance.now(); }, true);
"""  # noqa: E501
TURNS = 40
PLUS = "[data-axis=J1][data-sign='1']"
MINUS = "[data-axis=J1][data-sign='-1']"


def first_after(browser, kind: str, wanted: str) -> float | None:
    """Return the time from a pointer's event to the first message that meets a condition in JavaScript
    [ms].
    """
    script = f"""
        const since = window.{kind};
        for (const [at, text] of window.told) {{
          if (at < since) continue;
          const it = JSON.parse(text);
          if ({wanted}) return at - since;
        }}
        return null;
    """
    return browser.execute_script(script)


def shares(values: list[float]) -> str:
    ordered = sorted(values)
    last = ordered[min(len(ordered) - 1, int(0.99 * len(ordered)))]
    return (
        f"median {statistics.median(ordered):.0f} ms, 99 % {last:.0f} ms, worst {ordered[-1]:.0f} ms "
        f"({len(ordered)})"
    )


def presses(place: Place, turns: int) -> tuple[list[float], list[float]]:
    """Press and release repeatedly; return the times to the first motion, and to the hold [ms]."""
    browser = place.browser
    begins, ends = [], []
    for turn in range(turns):
        browser.execute_script("window.told = []; window.before = null")
        touch(browser, "touchStart", PLUS if turn % 2 else MINUS)
        time.sleep(0.45)
        moved = (
            "it.event === 'display' && (window.before ??= it.joints[0], Math.abs(it.joints[0] - "
            "window.before) > 1e-3)"
        )
        begins.append(first_after(browser, "pointerdown", moved))
        touch(browser, "touchEnd")
        time.sleep(0.45)
        ends.append(
            first_after(
                browser, "pointerup", "it.event === 'state' && it.state === 'hold' || it.event === 'finished'"
            )
        )
        until(place.rests, 5.0)
    return [one for one in begins if one is not None], [one for one in ends if one is not None]


def cpu(pid: int) -> float:
    """Return the processor time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / 100.0


def memory(pid: int) -> float:
    """Return the memory of a process [MB]."""
    line = next(
        one for one in Path(f"/proc/{pid}/status").read_text().splitlines() if one.startswith("VmRSS")
    )
    return int(line.split()[1]) / 1024.0


class Watchers:
    """Clients that only watch, each in a thread."""

    def __init__(self, api, count: int) -> None:
        self._sockets = [api.socket("/api/robot") for _ in range(count)]
        self.messages = 0
        for one in self._sockets:
            threading.Thread(target=self._read, args=(one,), daemon=True).start()

    def _read(self, socket) -> None:
        try:
            for _ in socket:
                self.messages += 1
        except Exception:
            return

    def close(self) -> None:
        for one in self._sockets:
            one.close()


def load_over(place: Place, seconds: float) -> float:
    """Return the share of a core that the pendant uses while a program runs [%]."""
    loaded = place.api.order("load", file="long.yarc")["program"]
    if place.joints()["J1"] != 0.0:
        loaded = place.api.order("load", file="long.yarc", approach=True)["program"]
    running = threading.Thread(
        target=lambda: place.api.order("run", program=loaded["number"], approach=True), daemon=True
    )
    running.start()
    until(lambda: place.api.order("status")["state"] == "move")
    time.sleep(2.0)
    before, since = cpu(place.process.pid), time.monotonic()
    time.sleep(seconds)
    share = 100.0 * (cpu(place.process.pid) - before) / (time.monotonic() - since)
    place.api.order("stop")
    running.join()
    return share


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=0.0)
    minutes = parser.parse_args().minutes
    print(f"load before: {Path('/proc/loadavg').read_text().split()[0]}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "bend.yarc").write_text(PROGRAM)
        (folder / "long.yarc").write_text(
            "".join(f"P{n:04d} MOVEJ {20 * (n % 2)} 0 0 0 30 0 [6] (deg,s)\n" for n in range(1, 30))
        )
        with serving(folder) as (url, token, process), opened_browser(folder / "profile") as browser:
            browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": SPY})
            place = Place(url, token, process, browser)
            since = time.monotonic()
            browser.refresh()
            until(
                lambda: (
                    browser.execute_script("return document.querySelector('#bar .state')?.textContent")
                    == "Idle"
                )
            )
            print(f"page ready: {time.monotonic() - since:.2f} s")
            size(browser, 1280, 800)
            place.control()
            goes_to(browser, "jog")
            begins, ends = presses(place, TURNS)
            print(f"pointer down to first motion: {shares(begins)}")
            print(f"letting go to the hold: {shares(ends)}")
            watchers = Watchers(place.api, 20)
            begins, ends = presses(place, TURNS)
            print(f"with 20 watchers, pointer down to first motion: {shares(begins)}")
            print(f"with 20 watchers, letting go to the hold: {shares(ends)}")
            watchers.close()
            click(browser, "#bar button:not([hidden])")
            time.sleep(0.5)
            place.api.call("POST", "/api/control", {})
            browser.get("about:blank")
            time.sleep(1.0)
            alone = load_over(place, 10.0)
            browser.get(url)
            until(
                lambda: (
                    browser.execute_script("return document.querySelector('#bar .state')?.textContent")
                    == "Idle"
                )
            )
            one = load_over(place, 10.0)
            watchers = Watchers(place.api, 20)
            many = load_over(place, 10.0)
            print(
                f"while a program runs: {alone:.1f} % of a core without pages, {one:.1f} % with one, "
                f"{many:.1f} % with 20 watchers more"
            )
            if minutes:
                sizes = []
                end = time.monotonic() + 60.0 * minutes
                while time.monotonic() < end:
                    sizes.append(memory(process.pid))
                    time.sleep(min(60.0, 6.0 * minutes))
                print("memory with 20 watchers [MB]: " + " ".join(f"{one:.0f}" for one in sizes))
            watchers.close()
    dead_network()
    print(f"load after: {Path('/proc/loadavg').read_text().split()[0]}")


def dead_network(turns: int = 10) -> None:
    """Print the time from the death of the network to the hold."""
    from urllib.parse import urlsplit

    found = []
    with tempfile.TemporaryDirectory() as name, serving(Path(name)) as (url, token, _):
        port = urlsplit(url).port
        proxy = Proxy(port)
        rules = f"--host-resolver-rules=MAP localhost:{port} 127.0.0.1:{proxy.port}, EXCLUDE 127.0.0.1"
        with opened_browser(Path(name) / "profile", rules) as browser:
            place = Place(f"http://localhost:{port}/", token, None, browser)
            from pendant.process import PASSWORD, Api

            place.api = Api(url)
            place.api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
            place.control()
            goes_to(browser, "jog")
            with place.api.socket("/api/robot") as events:
                for turn in range(turns):
                    touch(browser, "touchStart", PLUS if turn % 2 else MINUS)
                    time.sleep(0.8)
                    proxy.dead, since = True, time.monotonic()
                    while True:
                        told = json.loads(events.recv(timeout=5.0))
                        if (
                            told.get("event") == "state"
                            and told["state"] == "hold"
                            and time.monotonic() > since
                        ):
                            break
                    found.append(1e3 * (time.monotonic() - since))
                    proxy.dead = False
                    touch(browser, "touchEnd")
                    until(
                        lambda: (
                            not browser.execute_script("return document.body.classList.contains('greyed')")
                        )
                    )
                    until(place.rests, 5.0)
                    time.sleep(1.0)
        proxy.close()
    print(f"a dead network to the hold: {shares(found)}")


if __name__ == "__main__":
    main()
