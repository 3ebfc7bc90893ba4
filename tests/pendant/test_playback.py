"""Browser tests of the page Run: information before a start, single steps, backwards, start at a given
command, and the motion to a point while a button is held.
"""

import contextlib
import time

import pytest
from pendant.process import serving
from pendant.test_browser import Place, goes_to, shown, size, touch, until
from selenium.common.exceptions import InvalidArgumentException
from view.browser import browser_or_skip, opened_browser

TEXT = """ROBOT INDUSTRIAL6
DEFAULT [2] (deg,s)
INPUT PART M11
P0010 MOVEJ 8 0 0 0 20 0
P0020 WAIT PART OFF [60]
P0030 MOVEJ 8 8 0 0 20 0
P0040 MOVEJ HOME
P0050 STOP
"""


FAR = """ROBOT INDUSTRIAL6
CELL "parted.toml"
START 60 0 0 0 20 0 (deg)
P0010 MOVEJ 65 0 0 0 20 0 [2] (deg,s)
"""
PARTED = """units = "mm,deg"
[[zones]]
name = "NEVER"
rule = "forbidden"
shape = "joints"
joints = { J1 = [20, 30] }
"""


SIZE = 1024, 700
"""Window size at which the 3D view is hidden. It is rendered slowly here, and has tests of its own."""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    browser_or_skip()
    folder = tmp_path_factory.mktemp("playback")
    (folder / "job.yarc").write_text(TEXT)
    (folder / "far.yarc").write_text(FAR)
    (folder / "parted.toml").write_text(PARTED)
    with serving(folder) as (url, token, process), opened_browser(folder / "profile") as browser:
        found = Place(url, token, process, browser)
        found.folder = folder
        size(browser, *SIZE)
        goes_to(browser, "run")
        found.control()
        yield found


def press(browser, where, label):
    """Press the button whose label begins with a text."""
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll(`${arguments[0]} button`)].find((one) => "
            "one.textContent.startsWith(arguments[1]) && !one.disabled);it?.click(); return Boolean(it)",
            where,
            label,
        )
    )


def chosen(place, name="job.yarc"):
    """Choose a program again, and return when it is proved."""
    browser = place.browser
    until(lambda: place.api.order("status")["state"] == "stop")
    goes_to(browser, "status")
    goes_to(browser, "run")
    if not browser.execute_script("return document.querySelector('.playback .head').hidden"):
        press(browser, ".head", "Programs")
    press(browser, ".programs", name)
    until(lambda: "Version" in shown(browser, ".chosen"), 60.0)
    return browser


def state(place):
    return place.api.order("status")["state"]


def test_what_is_told_before_the_start(place):
    browser = chosen(place)
    told = shown(browser, ".chosen")
    for words in (
        "Proved: takes 6.0 s, and 1 wait",
        "Smallest clearance",
        "Of the limits",
        "velocity",
        "Version",
    ):
        assert words in told
    # On the smallest screen, all buttons are visible without scrolling.
    size(browser, 800, 480)
    time.sleep(0.3)
    hidden = browser.execute_script(
        """
        const all = [...document.querySelectorAll(".controls button, .controls select, .controls input, .timeline input, .head button")];
        return all.filter((one) => one.offsetParent).filter((one) => {
          const box = one.getBoundingClientRect();
          return box.bottom > innerHeight || box.right > innerWidth || box.top < 0 || box.height < 43.5;
        }).map((one) => one.textContent || one.ariaLabel);
        """  # noqa: E501
    )
    assert hidden == []
    size(browser, *SIZE)
    # The timeline shows the command, line and joints at the chosen time.
    browser.execute_script(
        "const bar = document.querySelector('.timeline input'); bar.value = 3; bar.dispatchEvent(new "
        "Event('input'))"
    )
    assert "MOVEJ, line 6" in shown(browser, ".timeline .at")
    assert "J1 8.0" in shown(browser, ".timeline .joints")
    (place.folder / "job.yarc").write_text(TEXT.replace("8 8 0", "8 9 0"))
    press(browser, ".actions", "Run")
    until(lambda: "the proved version will run" in shown(browser, ".ask"))
    # A program that was changed on another page is proved again, instead of running the old text.
    browser.execute_script("location.hash = '#/program'")
    until(lambda: not shown(browser, ".playback"))
    browser.execute_script("location.hash = '#/run'")
    at_4 = (
        "const bar = document.querySelector('.timeline input'); bar.value = 4; bar.dispatchEvent(new "
        "Event('input'))"
    )
    until(lambda: browser.execute_script(at_4) or "J2 9.0" in shown(browser, ".timeline .joints"), 60.0)
    (place.folder / "job.yarc").write_text(TEXT)


def test_step_by_step_and_backwards(place):
    browser = chosen(place)
    press(browser, ".actions", "Step")
    with contextlib.suppress(AssertionError):
        until(lambda: shown(browser, ".ask") or state(place) == "move", 20.0)
    if shown(browser, ".ask"):
        press(browser, ".ask", "Move there")
        until(lambda: "P0010 (1 of 3)" in shown(browser, ".doing"))
        press(browser, ".actions", "Step")
    until(lambda: "Before P0030 MOVEJ (2 of 3)" in shown(browser, ".doing"))
    assert place.joints()["J1"] == pytest.approx(8.0, abs=0.01)
    # The page is reloaded while the robot waits between two commands; the run can be continued.
    browser.refresh()
    until(lambda: "press Step to execute it" in shown(browser, ".doing"))
    press(browser, ".actions", "Step")
    until(lambda: "Before P0040 MOVEJ (3 of 3)" in shown(browser, ".doing"))
    assert place.joints()["J2"] == pytest.approx(8.0, abs=0.01)
    touch(browser, "touchStart", "#stop")
    touch(browser, "touchEnd")
    until(lambda: state(place) == "stop")
    for joints in ({"J1": 8.0, "J2": 0.0}, {"J1": 0.0, "J2": 0.0}):
        press(browser, ".actions", "Backwards")
        press(browser, ".ask", "Go back")
        until(lambda joints=joints: all(abs(place.joints()[name] - at) < 0.01 for name, at in joints.items()))
        until(lambda: state(place) == "stop")


def test_from_a_command_on(place):
    browser = chosen(place)
    press(browser, ".commands", "6P0030 MOVEJ")
    press(browser, ".detail", "From here")
    until(lambda: "from P0030 on" in shown(browser, ".chosen"), 60.0)
    assert "A proved motion leads there in" in shown(browser, ".chosen")
    press(browser, ".actions", "Run")
    press(browser, ".ask", "Move there")
    until(lambda: "job.yarc is done" in shown(browser, ".chosen"), 30.0)
    assert place.joints()["J2"] == pytest.approx(0.0, abs=0.01)


def test_the_way_to_a_point_while_the_button_is_held(place):
    browser = chosen(place)
    press(browser, ".commands", "6P0030 MOVEJ")
    press(browser, ".detail", "Way to its end")
    until(lambda: browser.execute_script("return Boolean(document.querySelector('.hold-to-go'))"), 30.0)
    places = []
    for _ in range(2):
        before = place.joints()
        touch(browser, "touchStart", ".hold-to-go")
        until(lambda before=before: place.joints() != before, 5.0)
        time.sleep(0.3)
        touch(browser, "touchEnd")
        until(lambda: state(place) == "hold", 5.0)
        # On a busy computer, the press may have ended before the finger was lifted.
        until(lambda: any(words in shown(browser, ".go") for words in ("at rest on its path", "press again")))
        places.append(place.joints()["J2"])
    assert 0.0 < places[0] < places[1] < 8.0
    # The page is left while the button is held: the robot comes to rest, and the motion ends.
    touch(browser, "touchStart", ".hold-to-go")
    time.sleep(0.3)
    goes_to(browser, "status")
    until(lambda: state(place) == "stop", 5.0)
    with contextlib.suppress(InvalidArgumentException):
        touch(browser, "touchEnd")
    before = place.joints()
    time.sleep(0.5)
    assert place.joints() == before


def test_a_loop_is_held_and_resumed(place):
    browser = chosen(place)
    browser.execute_script("document.querySelector('.actions select').value = '2'")
    press(browser, ".actions", "Run")
    until(lambda: shown(browser, ".ask") or state(place) != "stop")
    if shown(browser, ".ask"):  # the robot isn't at the program's start yet
        press(browser, ".ask", "Move there")
    until(lambda: "Pass 1 of 2" in shown(browser, ".doing"))
    until(lambda: state(place) == "move")  # before this state, a hold would end the program
    press(browser, ".actions", "Hold")
    until(lambda: "Held" in shown(browser, ".doing"))
    press(browser, ".actions", "Resume")
    until(lambda: "Pass 2 of 2" in shown(browser, ".doing"), 30.0)
    until(lambda: shown(browser, ".commands [aria-current]"))
    until(lambda: "job.yarc is done, 2 times" in shown(browser, ".chosen"), 30.0)


def test_a_start_that_cannot_be_reached_and_no_place_either(place):
    """The robot is at HOME, and the whole program lies behind a forbidden window of joint positions."""
    browser = chosen(place, "far.yarc")
    before = place.joints()
    press(browser, ".actions", "Run")
    until(lambda: "can't reach the start" in shown(browser, ".ask"), 30.0)
    press(browser, ".ask", "Nearest place")
    until(lambda: "No proved motion leads from the robot's position" in shown(browser, ".ask"), 60.0)
    assert "NEVER" in shown(browser, ".ask")
    press(browser, ".ask", "Close")
    assert place.joints() == pytest.approx(before, abs=0.01)
