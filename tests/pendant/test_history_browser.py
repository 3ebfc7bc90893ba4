"""Browser tests of the history pages: a fault is explained and acknowledged on another page, and a run is
plotted and replayed.
"""

import pytest
from pendant.process import PASSWORD, PIN, Api, serving
from pendant.test_browser import SIZES, click, fill, goes_to, shown, size, until
from view.browser import browser_or_skip, opened_browser

TEXT = """ROBOT INDUSTRIAL6
DEFAULT [1] (deg,s)
INPUT PART M11
OUTPUT LAMP M12
P0010 MOVEJ 20 0 0 0 30 0
P0020 SET LAMP ON
P0030 WAIT PART ON [0.5]
P0040 MOVEJ HOME
"""
LINE = 7


@pytest.fixture
def place(tmp_path):
    """Fixture: a pendant whose program fails at a WAIT, and a browser in which anna is logged in."""
    browser_or_skip()
    (tmp_path / "job.yarc").write_text(TEXT)
    (tmp_path / "yarc-runs").mkdir()
    log = ("--log", str(tmp_path / "yarc-runs"))
    with (
        serving(tmp_path, *log, own=False) as (url, token, _),
        opened_browser(tmp_path / "profile") as browser,
    ):
        size(browser, *SIZES[0])
        browser.get(f"{url}#first={token}")
        fill(browser, user="anna", password=PASSWORD, pin=PIN)
        click(browser, "#entrance button.main")
        until(lambda: shown(browser, "#bar .name").startswith("INDUSTRIAL6"))
        api = Api(url)
        api.call("POST", "/api/login", {"user": "anna", "password": PASSWORD})
        yield browser, api


def fails(api):
    """Run the program until it fails. Its log is then closed."""
    assert api.call("POST", "/api/control", {})["given"]
    number = api.order("load", file="job.yarc", approach=True)["program"]["number"]
    assert api.order("run", program=number)["code"] == "Y1604"
    api.call("POST", "/api/control/give", {"to": ""})


def press(browser, where, label):
    """Press the button or link with a given label."""
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll(`${arguments[0]} :is(button, a)`)].find((one) => "
            "one.textContent === arguments[1] && !one.disabled); it?.click(); return Boolean(it)",
            where,
            label,
        )
    )


def hidden(browser, where):
    return browser.execute_script("return document.querySelector(arguments[0]).hidden", where)


def test_a_fault_is_explained_and_a_run_replayed(place):
    browser, api = place
    assert hidden(browser, ".alarm")
    fails(api)
    until(lambda: shown(browser, ".alarm").startswith("Y1604P0030 WAIT"))
    # Another page of anna's, on which the alarm is read and acknowledged.
    first = browser.current_window_handle
    browser.switch_to.new_window("tab")
    size(browser, *SIZES[0])
    browser.get(f"{api.url}/#/run")
    until(lambda: shown(browser, ".alarm").startswith("Y1604"))
    click(browser, ".alarm")
    until(lambda: "an input didn't come in time" in shown(browser, ".explained"))
    assert "check the input" in shown(browser, ".alarm-details .remedy")
    assert f"job.yarc, line {LINE}" in shown(browser, ".alarm-details .facts")
    press(browser, ".alarm-details", "Acknowledge")
    until(lambda: "acknowledged" in shown(browser, ".alarm-list .badge"))
    assert "by anna" in shown(browser, ".alarm-details .facts")
    # The alarm stays in the bar until the fault is cleared.
    assert not hidden(browser, ".alarm")
    api.call("POST", "/api/control", {})
    api.order("clear")
    until(lambda: hidden(browser, ".alarm"))
    press(browser, ".alarm-details", "Go to the line")
    until(lambda: "WAIT PART ON" in shown(browser, ".rows [aria-selected=true]"))
    assert browser.execute_script("return location.hash") == "#/program/job.yarc"
    browser.close()
    browser.switch_to.window(first)
    until(lambda: hidden(browser, ".alarm"))
    goes_to(browser, "history/alarms")
    until(
        lambda: (
            "No alarm is open" in shown(browser, ".alarm-list") or "acknowledged" in shown(browser, ".badge")
        )
    )
    # Open the log of the run.
    goes_to(browser, "history/runs")
    until(lambda: "job.yarc" in shown(browser, ".run-list") and "by anna" in shown(browser, ".run-list"))
    click(browser, ".run-list .open")
    until(lambda: "J1" in shown(browser, ".values"), 60.0)
    painted = (
        "const it = document.querySelector('.chart'); const all = it.getContext('2d').getImageData(0, 0, "
        "it.width, it.height).data; return all.some((one) => one > 0)"
    )
    until(lambda: browser.execute_script(painted))
    browser.execute_script(
        "const it = document.querySelector('.chart'), box = it.getBoundingClientRect();"
        "it.dispatchEvent(new PointerEvent('pointermove', { pointerType: 'mouse', clientX: box.x + "
        "box.width / 3, clientY: box.y + 20 }))"
    )
    until(lambda: not shown(browser, ".values").startswith("0.00 s"))
    press(browser, ".run-body", "+")
    press(browser, "#page", "Events")
    until(lambda: "SET LAMP ON" in shown(browser, ".run-list"))
    press(browser, "#page", "Replay")
    until(lambda: "J1" in shown(browser, ".replay-part .joints"))
    before = shown(browser, ".replay-bar .at")
    press(browser, ".replay-bar", "Play")
    until(lambda: shown(browser, ".replay-bar .at") != before, 40.0)
    for width, height in SIZES:
        size(browser, width, height)
        wide = "const it = document.querySelector('#page'); return it.scrollWidth - it.clientWidth"
        assert browser.execute_script(wide) <= 1
    severe = [
        one for one in browser.get_log("browser") if one["level"] == "SEVERE" and "401" not in one["message"]
    ]
    assert severe == []
