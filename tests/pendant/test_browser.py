"""Browser tests of the pendant's pages: buttons, layout in both window sizes, and failures of network and
computer.
"""

import contextlib
import json
import os
import re
import signal
import socket
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from pendant.process import PASSWORD, PIN, PROGRAM, Api, serving
from selenium.common.exceptions import InvalidArgumentException
from view.browser import browser_or_skip, opened_browser

SIZES = ((1280, 800), (800, 480))
PAGES = (
    *("run", "program", "jog", "scene", "io", "setup/tools", "setup/calibrate", "setup/workspace", "files"),
    *("history/alarms", "history/runs", "status"),
    *("system/controller", "system/health", "system/backup", "system/users", "system/keys", "system/account"),
)


ASKING = """ROBOT INDUSTRIAL6
START 0 0 0 0 -30 0 (deg)
REGISTER N 1..9
P0010 HOLD "how many boxes?" N
P0020 SAY "{N} boxes"
P0030 MOVEJ 1 0 0 0 -30 0 [1] (deg,s)
P0040 MOVEJ 0 0 0 0 -30 0 [1] (deg,s)
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Fixture: a pendant, and a browser in which anna is logged in and controls the robot."""
    browser_or_skip()
    folder = tmp_path_factory.mktemp("pendant")
    (folder / "bend.yarc").write_text(PROGRAM)
    (folder / "ask.yarc").write_text(ASKING)
    (folder / "<img src=x onerror=alert(1)>.yarc").write_text(PROGRAM)
    with serving(folder) as (url, token, process), opened_browser(folder / "profile") as browser:
        found = Place(url, token, process, browser)
        size(
            browser, 1024, 700
        )  # narrow enough to hide the 3D view beside Jog, which is rendered slowly here and tested elsewhere
        yield found


class Place:
    def __init__(self, url, token, process, browser):
        self.url, self.process, self.browser = url, process, browser
        size(browser, *SIZES[0])
        browser.get(f"{url}#first={token}")
        fill(browser, user="anna", password=PASSWORD, pin=PIN)
        click(browser, "#entrance button.main")
        until(lambda: shown(browser, "#bar .name").startswith("INDUSTRIAL6"))
        self.api = Api(url)
        self.api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})

    def control(self):
        if "you control it" not in shown(self.browser, "#bar .owner"):
            click(self.browser, ".control:not([hidden])")
            until(lambda: "you control it" in shown(self.browser, "#bar .owner"))

    def joints(self):
        return {one["name"]: one["position"] for one in self.api.order("status")["joints"]}

    def rests(self):
        """Return True if nothing is running and no joint moves. The joints are compared, because on a busy
        computer the simulator may pause within a motion.
        """
        if self.api.order("status")["state"] != "stop":
            return False
        before = self.joints()
        time.sleep(0.25)
        return self.joints() == before


def size(browser, width, height):
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
    )


def until(look, within=20.0):
    end = time.monotonic() + within
    while not (found := look()):
        assert time.monotonic() < end, "it never came"
        time.sleep(0.03)
    return found


def shown(browser, where):
    return browser.execute_script("return document.querySelector(arguments[0])?.textContent ?? ''", where)


def click(browser, where):
    until(
        lambda: browser.execute_script(
            "const it = document.querySelector(arguments[0]); it?.click(); return Boolean(it)", where
        )
    )


def fill(browser, **fields):
    for name, value in fields.items():
        until(
            lambda name=name: browser.execute_script(
                "return Boolean(document.querySelector(`[name=${arguments[0]}]`))", name
            )
        )
        browser.execute_script(
            "document.querySelector(`[name=${arguments[0]}]`).value = arguments[1]", name, value
        )


def goes_to(browser, page):
    browser.execute_script("location.hash = `#/${arguments[0]}`", page)
    until(
        lambda: (
            browser.execute_script(
                "return [...document.querySelectorAll('#rail [aria-current=page], .tabs "
                "[aria-current=page]')].at(-1)?.hash"
            )
            == f"#/{page}"
        )
    )


def middle(browser, where):
    return browser.execute_script(
        "const box = document.querySelector(arguments[0]).getBoundingClientRect(); return [box.x + "
        "box.width / 2, box.y + box.height / 2]",
        where,
    )


def touch(browser, kind, where=None):
    points = [] if where is None else [dict(zip("xy", middle(browser, where), strict=True))]
    browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def press_until_it_moves(place, where):
    """Press a button until the robot moves. On a busy computer a press may end before the robot moves; then
    press again.
    """
    for _ in range(5):
        before = place.joints()
        touch(place.browser, "touchStart", where)
        with contextlib.suppress(AssertionError):
            until(lambda before=before: place.joints() != before, 5.0)
            return
        with contextlib.suppress(InvalidArgumentException):
            touch(place.browser, "touchEnd")
        time.sleep(0.5)
    raise AssertionError("it never moved")


@contextmanager
def held(place, where):
    """Hold a button with a finger while the context runs, which begins when the robot moves."""
    press_until_it_moves(place, where)
    try:
        yield
    finally:
        # a touch that the browser has cancelled can't be ended
        with contextlib.suppress(InvalidArgumentException):
            touch(place.browser, "touchEnd")
        until(place.rests, 5.0)


def test_every_page_in_both_sizes(place):
    """On each page and in both sizes, nothing is cut off at the sides, STOP is visible, and buttons are large
    enough for gloves.
    """
    browser = place.browser
    for page in PAGES:
        goes_to(browser, page)
        for width, height in SIZES:
            size(browser, width, height)
            time.sleep(0.3)
            found = browser.execute_script(
                """
                const box = (one) => one.getBoundingClientRect();
                const pressed = [...document.querySelectorAll("button, select, a.place, input[type=range]")].filter((one) => one.offsetParent);
                return {
                  wide: document.documentElement.scrollWidth,
                  stop: box(document.getElementById("stop")).toJSON(),
                  small: pressed.filter((one) => box(one).height < 43.5 || box(one).width < 43.5).map((one) => one.textContent || one.type),
                  nameless: pressed.filter((one) => !(one.textContent || one.ariaLabel || one.labels?.length || one.closest("label"))).length,
                };
                """  # noqa: E501
            )
            assert found["wide"] <= width, (page, width)
            assert found["stop"]["right"] <= width
            assert found["stop"]["bottom"] <= height
            assert min(found["stop"]["width"], found["stop"]["height"]) >= 76
            assert found["small"] == [], (page, width)
            assert found["nameless"] == 0, page
    size(browser, *SIZES[0])


CUT = """
(() => {
  const { fetch, WebSocket } = window;
  const open = new Set();
  window.wrong = [];
  window.fetch = (...given) => (window.isCut ? Promise.reject(new TypeError("Failed to fetch")) : fetch(...given));
  window.WebSocket = class extends WebSocket {
    constructor(url) {
      super(window.isCut ? url.replace(/api.*/, "nothing") : url);
      open.add(this);
      this.addEventListener("close", () => open.delete(this));
    }
  };
  window.cut = () => {
    window.isCut = true;
    for (const one of open) one.close();
  };
  window.addEventListener("error", (event) => window.wrong.push(event.message));
  window.addEventListener("unhandledrejection", (event) => window.wrong.push(String(event.reason?.stack ?? event.reason)));
})();
"""  # noqa: E501
"""Script that can cut a page off from its server, and that records uncaught errors."""


@contextmanager
def cuttable(browser):
    """Load the pages with the script CUT; afterwards load them without it."""
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": CUT})
    try:
        browser.refresh()
        until(lambda: shown(browser, "#bar .name"))
        yield
    finally:
        browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)
        browser.refresh()
        until(lambda: shown(browser, "#bar .name"))


def parts(browser):
    """Return the texts of a page's headings and buttons, without numbers."""
    found = browser.execute_script(
        "return [...document.querySelectorAll('#page button, #page h2, #page th, #page "
        ".filename')].filter((one) => one.checkVisibility()).map((one) => one.textContent)"
    )
    return {re.sub(r"[-\d.:,]+", "", one) for one in found}


def is_grey(browser):
    return browser.execute_script("return document.body.classList.contains('greyed')")


def test_every_page_that_is_opened_without_a_connection_is_whole_when_there_is_one(place):
    """A page that is opened without a connection says so in one sentence, allows STOP, and throws no error.
    When the connection is back, the page is complete and shows nothing outdated.
    """
    browser = place.browser
    whole, lost = {}, {}
    with cuttable(browser):
        for page in PAGES:
            goes_to(browser, page)
            until(lambda: parts(browser))
            time.sleep(0.8)
            whole[page] = parts(browser)
        for page in PAGES:
            goes_to(browser, "system/account")
            browser.execute_script("cut()")
            until(lambda: is_grey(browser), 3.0)
            goes_to(browser, page)
            time.sleep(0.2)
            assert shown(browser, "#lost").startswith("No connection to the pendant's server."), page
            assert "There is no program" not in shown(browser, "#page"), page
            touch(browser, "touchStart", "#stop")
            touch(browser, "touchEnd")
            browser.execute_script("isCut = false")
            until(lambda: not is_grey(browser), 5.0)
            with contextlib.suppress(AssertionError):
                until(lambda page=page: whole[page] <= parts(browser), 6.0)
            lost[page] = whole[page] - parts(browser)
            assert browser.execute_script("return wrong") == [], page
    assert {page: one for page, one in lost.items() if one} == {}


def test_a_question_goes_with_the_page_that_has_asked(place):
    """A question is closed when its page is left or the user logs out. So nobody can answer it later by
    accident.
    """
    browser = place.browser
    goes_to(browser, "system/users")
    click(browser, "#page tbody button:last-child")
    until(lambda: "Remove" in shown(browser, "dialog[open]"))
    goes_to(browser, "jog")
    until(lambda: not shown(browser, "dialog"))


def test_the_page_that_is_shown_is_marked_where_it_can_be_seen(place):
    """The entry of the shown page is visible in the navigation, even on a small panel where not all entries
    fit.
    """
    browser = place.browser
    size(browser, *SIZES[1])
    for page in ("system/users", "run", "status"):
        goes_to(browser, page)
        assert browser.execute_script(
            """
            const rail = document.getElementById("rail").getBoundingClientRect();
            const mine = document.querySelector("#rail [aria-current=page]").getBoundingClientRect();
            return mine.top >= rail.top && mine.bottom <= rail.bottom + 0.5;
            """
        ), page
    size(browser, 1024, 700)


def test_names_are_texts(place):
    """Names of users, programs and robots that contain HTML are shown as text."""
    place.api.call("POST", "/api/pin", {"pin": PIN})
    goes_to(place.browser, "run")
    until(lambda: "<img src=x" in shown(place.browser, ".programs"))
    assert place.browser.execute_script("return document.querySelectorAll('#page img').length") == 0


def test_touch_moves_as_long_as_it_lasts(place):
    goes_to(place.browser, "jog")
    place.control()
    before = place.joints()["J1"]
    with held(place, "[data-axis=J1][data-sign='1']"):
        assert shown(place.browser, "#bar .state") in ("Jogging", "Idle")
        time.sleep(0.5)
    assert place.joints()["J1"] > before + 0.5


@pytest.mark.parametrize("ends", ["touchCancel", "blur", "hidden", "page", "escape"])
def test_whatever_ends_the_press_ends_the_motion(place, ends):
    goes_to(place.browser, "jog")
    place.control()
    browser = place.browser
    with held(place, "[data-axis=J1][data-sign='-1']"):
        match ends:
            case "touchCancel":
                touch(browser, "touchCancel")
            case "blur":
                browser.execute_script("window.dispatchEvent(new Event('blur'))")
            case "hidden":
                browser.execute_script(
                    "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
                    "document.dispatchEvent(new Event('visibilitychange')); delete document.hidden;"
                )
            case "page":
                goes_to(browser, "status")
            case "escape":
                browser.execute_script("window.dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}))")
        until(place.rests, 6.0)


def test_a_busy_page_doesnt_keep_the_robot_moving(place):
    """If the scripts of the page hang, the watchdog brings the robot to rest."""
    goes_to(place.browser, "jog")
    place.control()
    with held(place, "[data-axis=J1][data-sign='1']"):
        place.browser.execute_script(
            "setTimeout(() => { const end = Date.now() + 1500; while (Date.now() < end); }, 0)"
        )
        until(place.rests, 2.0)


def test_a_key_is_held(place):
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By

    goes_to(place.browser, "jog")
    place.control()
    key = place.browser.find_element(By.CSS_SELECTOR, "[data-axis=J2][data-sign='-1']")
    place.browser.execute_script("arguments[0].focus()", key)
    before = place.joints()["J2"]
    ActionChains(place.browser).key_down(" ").perform()
    until(lambda: place.joints()["J2"] < before - 0.2, 5.0)
    ActionChains(place.browser).key_up(" ").perform()
    until(place.rests, 6.0)


def test_a_joystick_needs_its_button(place):
    browser = place.browser
    goes_to(browser, "jog")
    place.control()
    browser.execute_script(
        """
        window.pad = {id: "a test", connected: true, index: 0, axes: [0, 0, 0, 0], buttons: [{pressed: false, value: 0}]};
        navigator.getGamepads = () => [window.pad];
        """  # noqa: E501
    )
    start = place.joints()
    browser.execute_script("window.pad.axes = [1, 0, 0, 0]")
    time.sleep(0.4)
    assert place.joints() == start
    # If the gamepad is enabled while its stick is deflected, nothing moves. After neutral, a deflection moves
    # the robot.
    browser.execute_script("window.pad.buttons[0].pressed = true")
    time.sleep(0.4)
    assert place.joints() == start
    browser.execute_script("window.pad.axes = [0, 0, 0, 0]")
    time.sleep(0.2)
    browser.execute_script("window.pad.axes = [1, 0, 0, 0]")
    until(lambda: place.joints() != start, 5.0)
    browser.execute_script("window.pad.buttons[0].pressed = false")
    until(place.rests, 6.0)
    goes_to(browser, "system/keys")
    until(lambda: "a test" in shown(browser, "#page"))
    browser.execute_script("navigator.getGamepads = () => []")


def test_a_program_is_run_and_stopped(place):
    browser = place.browser
    goes_to(browser, "run")
    place.control()
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll('.programs button')].find((one) => one.textContent "
            "=== 'bend.yarc'); it?.click(); return Boolean(it)"
        )
    )
    until(lambda: "Proved: takes 12.0 s" in shown(browser, ".chosen"))
    click(browser, ".actions button.main")
    click_if(browser, ".ask button.main")
    until(lambda: shown(browser, "#bar .state") == "Running" and "left" in shown(browser, "#bar .times"))
    time.sleep(0.5)
    touch(browser, "touchStart", "#stop")
    touch(browser, "touchEnd")
    until(lambda: shown(browser, "#bar .state") == "Idle")
    until(lambda: "stopped on its path" in shown(browser, ".chosen"))
    assert place.rests()


def test_a_question_is_answered_beside_resume(place):
    """The field for the answer is shown only while the question is open, and Resume can be pressed only with
    a number that the question allows.
    """
    browser = place.browser
    goes_to(browser, "run")
    place.control()
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll('.programs button')].find((one) => one.textContent "
            "=== 'ask.yarc'); it?.click(); return Boolean(it)"
        )
    )
    until(lambda: "Proved" in shown(browser, ".chosen"))
    field = "document.querySelector('.actions input[type=number]')"
    resume = "[...document.querySelectorAll('.actions button')].find((one) => one.textContent === 'Resume')"
    assert browser.execute_script(f"return {field}.hidden")
    click(browser, ".actions button.main")
    click_if(browser, ".ask button.main")
    until(lambda: browser.execute_script(f"return !{field}.hidden"))
    assert "how many boxes?" in shown(browser, ".controls .doing")
    assert browser.execute_script(f"return [{field}.min, {field}.max, {field}.placeholder]") == [
        "1",
        "9",
        "1 to 9",
    ]

    def typed(text):
        browser.execute_script(
            f"const it = {field}; it.value = arguments[0]; it.dispatchEvent(new Event('input', {{ bubbles: "
            f"true }}))",
            text,
        )
        return browser.execute_script(f"return {resume}.disabled")

    for wrong in ("", "0", "12", "2.5", "-3"):
        assert typed(wrong), wrong
    assert not typed("4")
    browser.execute_script(f"{resume}.click()")
    until(lambda: shown(browser, "#bar .state") == "Idle")
    assert browser.execute_script(f"return {field}.hidden")


def click_if(browser, where):
    end = time.monotonic() + 3.0
    while time.monotonic() < end:
        if browser.execute_script(
            "const it = document.querySelector(arguments[0]); it?.click(); return Boolean(it)", where
        ):
            return
        time.sleep(0.05)


class Proxy:
    """TCP proxy that can drop all data without closing a connection, like a dead network."""

    def __init__(self, port):
        self.dead = False
        self._port = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            far = socket.create_connection(("127.0.0.1", self._port))
            for one, other in ((near, far), (far, near)):
                threading.Thread(target=self._carry, args=(one, other), daemon=True).start()

    def _carry(self, one, other):
        try:
            while data := one.recv(65536):
                while self.dead:
                    time.sleep(0.01)
                other.sendall(data)
        except OSError:
            pass
        for end in (one, other):
            end.close()

    def close(self):
        self._listener.close()


@pytest.mark.parametrize("day", ["dead network", "stopped browser", "killed tab"])
def test_bad_days(tmp_path, day):
    """After a failure the robot rests, and a page that still runs says that it knows nothing. When the
    network is back, everything works again.
    """
    browser_or_skip()
    with serving(tmp_path) as (url, token, _):
        port = urlsplit(url).port
        proxy = Proxy(port)
        # The browser resolves the pendant's own host name to the proxy.
        with opened_browser(
            tmp_path / "profile",
            f"--host-resolver-rules=MAP localhost:{port} 127.0.0.1:{proxy.port}, EXCLUDE 127.0.0.1",
        ) as browser:
            here = Place(f"http://localhost:{port}/", token, None, browser)
            here.api = Api(url)
            here.api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
            here.control()
            goes_to(browser, "jog")
            press_until_it_moves(here, "[data-axis=J1][data-sign='1']")
            pids = browser_processes(browser)
            match day:
                case "dead network":
                    proxy.dead = True
                case "stopped browser":
                    for pid in pids:
                        os.kill(pid, signal.SIGSTOP)
                case "killed tab":
                    browser.execute_cdp_cmd("Page.stopLoading", {})
                    renderer = [pid for pid, command in pids.items() if b"--type=renderer" in command]
                    assert renderer
                    for pid in renderer:
                        os.kill(pid, signal.SIGKILL)
            until(here.rests, 6.0)
            there = here.joints()
            if day == "dead network":
                until(lambda: "No connection" in shown(browser, "#lost"))
                assert browser.execute_script("return document.body.classList.contains('greyed')")
                proxy.dead = False
                until(lambda: not browser.execute_script("return document.body.classList.contains('greyed')"))
            elif day == "stopped browser":
                time.sleep(1.0)
                for pid in pids:
                    os.kill(pid, signal.SIGCONT)
            # Delayed messages don't move the robot any more.
            time.sleep(1.0)
            assert here.joints() == there
        proxy.close()


def browser_processes(browser):
    """Return the processes of a browser by id, with their command lines."""
    profile = browser.capabilities["chrome"]["userDataDir"].encode()
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            command = (place / "cmdline").read_bytes()
        except OSError:
            continue
        if profile in command and b"chromedriver" not in command.split(b"\0")[0]:
            found[int(place.name)] = command
    return found


def test_nothing_was_loaded_from_elsewhere(place):
    """None of the browser's requests has gone to another computer."""
    asked = [json.loads(entry["message"])["message"] for entry in place.browser.get_log("performance")]
    urls = [one["params"]["request"]["url"] for one in asked if one["method"] == "Network.requestWillBeSent"]
    fetched = [one for one in urls if urlsplit(one).scheme in ("http", "https", "ws", "wss")]
    assert len(fetched) > 10
    assert [one for one in fetched if urlsplit(one).hostname not in ("127.0.0.1", "localhost")] == []
