"""Browser tests of calibration: a tool's tip and a frame are calibrated, checked by a motion, and written to
a file.
"""

import time

import numpy as np
import pytest
from pendant.process import PIN, serving
from pendant.test_browser import Place, click, goes_to, shown, until
from selenium.webdriver import ActionChains
from view.browser import browser_or_skip, opened_browser

TIP = (20, 130, 210)
TILTS = ("0 0 0", "30 0 0", "-30 0 0", "0 30 0")
AT = "MOVEJ_RPY {{TRUE}} 0 1100 1300 {} [3] (mm,deg,s) {{B}}"


@pytest.fixture
def place(tmp_path):
    browser_or_skip()
    (tmp_path / "weld.yarc").write_text("P0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\n")
    with serving(tmp_path) as (url, token, process), opened_browser(tmp_path / "profile") as browser:
        yield Place(url, token, process, browser)


def pressed(browser, label):
    """Press the button with a given label."""
    found = (
        'return [...document.querySelectorAll("#page button, .sheet button")].find((one) => '
        "one.offsetParent && one.textContent === arguments[0] && !one.disabled)"
    )
    button = until(lambda: browser.execute_script(found, label))
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'}); arguments[0].click()", button)


def goes(place, text):
    """Execute a line of text through the API."""
    told = place.api.order("offer", text=text)
    assert told["offer"], told
    assert place.api.order("go", offer=told["offer"]["number"])["well"]


def touches(place, number, tilt):
    goes(place, AT.format(tilt))
    pressed(place.browser, "Take this touch")
    until(lambda: len(place.browser.find_elements("css selector", ".touches li")) == number)


def tip_calibrated(place, looked_at=lambda _: None):
    """Carry out the calibration of a tip. `looked_at` is called with the name of each step."""
    browser = place.browser
    place.api.call("POST", "/api/control")
    adopted = place.api.order(
        "adopt", declarations=["FRAME {{TRUE}} {} {} {} 0 0 0 (mm,deg) {{FLANGE}}".format(*TIP)]
    )
    assert adopted["holds"], adopted
    goes_to(browser, "setup/calibrate")
    until(lambda: browser.find_elements("css selector", ".kind svg"))
    looked_at("kinds")
    click(browser, ".kind[data-kind=tip]")
    looked_at("naming")
    browser.find_element("css selector", "input[name=name]").send_keys("torch")
    pressed(browser, "Begin")
    until(lambda: "pointed object" in shown(browser, ".todo"))
    for number, tilt in enumerate(TILTS, 1):
        looked_at(f"before touch {number}")
        touches(place, number, tilt)
        if number == 2:
            assert "isn't known at all" in shown(browser, ".spread .why")
    until(lambda: "{TORCH}" in shown(browser, ".result"))
    looked_at("result")


def test_a_tip_is_calibrated(place):
    browser = place.browser
    tip_calibrated(place)
    # Neither a visit to the page Jog nor a reload of the page loses the touches.
    pressed(browser, "Jog")
    until(lambda: "#/jog" in browser.current_url)
    click(browser, ".why-row a")
    until(lambda: len(browser.find_elements("css selector", ".touches li")) == len(TILTS))
    browser.refresh()
    until(lambda: len(browser.find_elements("css selector", ".touches li")) == len(TILTS))
    pressed(browser, "Into a program")
    pressed(browser, "Show the change")
    until(lambda: browser.find_elements("css selector", ".sheet .compared"))
    assert "declared {TORCH}" in shown(browser, ".sheet").lower().replace("torch", "TORCH")
    pressed(browser, "Write")
    until(lambda: "was written" in shown(browser, ".writing"))
    told = place.api.call("GET", "/api/files/weld.yarc")["text"]
    line = next(one for one in told.splitlines() if one.startswith("FRAME"))
    assert [float(word) for word in line.split()[2:5]] == pytest.approx(TIP, abs=0.05)
    # The motion to the touched point runs only while its button is held.
    place.api.order("release")
    place.control()
    pressed(browser, "Back from the point")
    hold = until(lambda: browser.find_elements("css selector", ".hold-to-go"))[0]
    before = np.array(list(place.joints().values()))
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", hold)
    ActionChains(browser).click_and_hold(hold).perform()
    time.sleep(2.0)
    ActionChains(browser).release().perform()
    until(place.rests)
    assert np.abs(np.array(list(place.joints().values())) - before).max() > 0.02


CELL = 'units = "mm,deg"\n\n[frames.TABLE]\nparent = "B"\nxyz = [0, 900, 800]\nrpy = [0, 0, 0]\n'
POINTS = ("0 1100 900", "200 1100 900", "0 1300 900")


def test_a_frame_is_calibrated(tmp_path):
    browser_or_skip()
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "yarc.toml").write_text('cell = "cell.toml"\n')
    with serving(tmp_path) as (url, token, process), opened_browser(tmp_path / "profile") as browser:
        place = Place(url, token, process, browser)
        place.api.call("POST", "/api/control")
        goes_to(browser, "setup/calibrate")
        click(browser, ".kind[data-kind=frame]")
        browser.find_element("css selector", "input[name=name]").send_keys("nest")
        pressed(browser, "Begin")
        for number, point in enumerate(POINTS, 1):
            goes(place, f"MOVEJ_RPY {{TCP}} {point} 0 0 0 [3] (mm,deg,s) {{B}}")
            pressed(browser, "Take this touch")
            until(lambda: len(browser.find_elements("css selector", ".touches li")) == number)  # noqa: B023
        until(lambda: "{NEST}" in shown(browser, ".result"))
        # The origin can't be removed while there are points after it.
        labels = [one.text for one in browser.find_elements("css selector", ".touches button")]
        assert labels.count("Remove") == 1
        pressed(browser, "Into cell.toml")
        until(lambda: browser.find_elements("css selector", ".sheet select"))
        browser.execute_script(
            "const parent = document.querySelector('.sheet select'); parent.value = '{TABLE}'"
        )
        pressed(browser, "Show the change")
        until(lambda: browser.find_elements("css selector", ".sheet .compared"))
        assert "The frame {NEST} is written" in shown(browser, ".sheet")
        pressed(browser, "Write")
        until(lambda: shown(browser, "dialog h2") == "Your PIN, please")
        browser.execute_script("document.querySelector('dialog input').value = arguments[0]", PIN)
        click(browser, "dialog button.main")
        until(lambda: "was written" in shown(browser, ".writing"))
        assert '[frames.NEST]\nparent = "TABLE"' in (tmp_path / "cell.toml").read_text()
        # After a visit to Jog and then to another page, there is no link back to the calibration.
        place.api.order("release")
        goes_to(browser, "setup/calibrate")
        pressed(browser, "Jog")
        until(lambda: browser.find_elements("css selector", ".why-row a"))
        goes_to(browser, "files")
        goes_to(browser, "jog")
        until(lambda: browser.find_elements("css selector", ".why-row"))
        assert not browser.find_elements("css selector", ".why-row a")
