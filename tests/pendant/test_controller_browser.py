"""Browser tests of System > Controller: a home search that needs the PIN is held with a finger, and a page
finds its server again after a restart.
"""

import contextlib
import time

from pendant.process import PIN, serving
from pendant.test_browser import Place, click, goes_to, shown, size, touch, until
from view.browser import browser_or_skip, opened_browser

HOLD = "button.home"


def press(browser, label):
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll('#page button')].findLast((one) => "
            "one.textContent.startsWith(arguments[0]) && !one.disabled);it?.click(); return Boolean(it)",
            label,
        )
    )


def confirm(browser):
    until(
        lambda: (
            shown(browser, "dialog [type=password]") == "" and shown(browser, "dialog h2").endswith("please")
        )
    )
    browser.execute_script(
        "document.querySelector('dialog input').value = arguments[0]; document.querySelector('dialog "
        "form').requestSubmit()",
        PIN,
    )
    until(lambda: not shown(browser, "dialog h2"))


def hold_until_it_moves(place):
    """Hold the button until the robot moves, then release it. On a busy computer the page may be silent for
    too long, which ends the search; then hold it again.
    """
    for _ in range(8):
        touch(place.browser, "touchStart", HOLD)
        with contextlib.suppress(AssertionError):
            until(lambda: place.joints()["J1"] < 19.8, 4.0)
        touch(place.browser, "touchEnd")
        if place.joints()["J1"] < 19.8:
            return
    raise AssertionError(shown(place.browser, "section .why"))


def test_enable_home_and_restart(tmp_path):
    browser_or_skip()
    (tmp_path / "far.yarc").write_text("P0010 MOVEJ 20 0 0 0 0 0 [2] (deg,s)\n")
    with serving(tmp_path) as (url, token, process), opened_browser(tmp_path / "profile") as browser:
        place = Place(url, token, process, browser)
        size(browser, 800, 480)
        goes_to(browser, "system/controller")
        place.control()
        until(lambda: shown(browser, ".ready") == "Ready.")
        press(browser, "Disable")
        press(browser, "Disable")  # the button of the question
        until(lambda: shown(browser, ".ready") == "Not ready: the motors were disabled.")
        press(browser, "Enable")
        until(lambda: shown(browser, ".ready") == "Ready.")
        # Move J1 away from its home position, then search it.
        browser.execute_script(
            "const ask = (path, body) => fetch(path, {method: 'POST', headers: {'content-type': "
            "'application/json'}, body: JSON.stringify(body)}).then((one) => one.json());"
            "ask('/api/orders/load', {file: 'far.yarc'}).then((told) => ask('/api/orders/run', {program: "
            "told.program.number}))"
        )
        until(lambda: place.joints()["J1"] > 19.9 and place.rests())
        press(browser, "Ask the controller")
        press(browser, "#1 J1")
        assert "1.25 deg/s" in shown(browser, ".not-proved")
        browser.execute_script("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", HOLD)
        touch(browser, "touchStart", HOLD)
        until(lambda: shown(browser, "dialog h2"))
        touch(browser, "touchEnd")
        assert place.joints()["J1"] > 19.9
        confirm(browser)
        hold_until_it_moves(place)
        until(lambda: any(one in shown(browser, "section .why") for one in ("was stopped", "sent nothing")))
        before = place.joints()["J1"]
        time.sleep(0.5)
        assert abs(place.joints()["J1"] - before) < 0.01
        assert before > 10.0
        until(lambda: shown(browser, ".ready").startswith("Not ready"))
        # After the restart, the simulated robot is ready. The page finds it, and the user is still logged in.
        press(browser, "Restart")
        press(browser, "Restart")
        until(lambda: shown(browser, ".ready") == "Ready.", 40.0)
        assert process.poll() is None
        click(browser, ".control:not([hidden])")
        until(lambda: "you control it" in shown(browser, "#bar .owner"))
