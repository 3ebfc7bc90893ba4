"""Browser tests of the pages Tools and frames, and I/O."""

import shutil

import pytest
from pendant.process import PIN, serving
from pendant.test_browser import Place, click, goes_to, shown, size, until
from view.browser import browser_or_skip, opened_browser

from tests.collision.test_bodies import changed
from tests.conftest import EXAMPLES
from tests.robot.test_dynamics import heavy_industrial6

WAITS = (
    'CELL "cell.toml"\n'
    "P0010 MOVEJ 5 0 0 0 -10 0 [1] (deg,s)\n"
    "P0020 WAIT PART_READY OFF\n"
    "P0030 MOVEJ HOME [1] (deg,s)\n"
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Fixture: a pendant at a robot with masses, in a project with a cell; anna is logged in and controls the
    robot.
    """
    browser_or_skip()
    folder = tmp_path_factory.mktemp("pendant")
    heavy_industrial6(folder)
    changed(
        folder,
        ("gravity = [0, 9.81, 0]", ""),
        ("[positions]", '[tools.GRIPPER]\nframe = "TCP"\nmass = 1.80  # weighed\n\n[positions]'),
    )
    shutil.copy(EXAMPLES / "05_pick_and_place.toml", folder / "cell.toml")
    (folder / "wait.yarc").write_text(WAITS)
    options = ("--cell", str(folder / "cell.toml"))
    with (
        serving(folder, *options, robot=str(folder / "arm")) as (url, token, process),
        opened_browser(folder / "profile") as browser,
    ):
        found = Place(url, token, process, browser)
        found.folder = folder
        size(browser, 1024, 700)
        found.control()
        yield found


def press(browser, where, label):
    """Press the button whose label contains a text."""
    until(
        lambda: browser.execute_script(
            "const one = [...document.querySelectorAll(arguments[0])].find((one) => "
            "one.textContent.includes(arguments[1]) && !one.disabled); one?.click(); return Boolean(one)",
            where,
            label,
        )
    )


def chosen(browser):
    return browser.execute_script(
        "return Object.fromEntries([...document.querySelectorAll('select[data-frames]')].map((one) => "
        "[one.dataset.frames, one.value]))"
    )


def test_signals_are_shown_and_switched(place):
    browser = place.browser
    goes_to(browser, "run")
    goes_to(browser, "io")
    until(lambda: shown(browser, "[data-name=GRIP] .lamp") == "OFF")
    until(lambda: "the part doesn't fall" in shown(browser, "[data-name=GRIP]"))
    # An output that takes or drops a part is switched only after a question.
    click(browser, "[data-name=GRIP] [data-value='1']")
    until(lambda: "The gripper closes" in shown(browser, "dialog.asks"))
    until(lambda: browser.execute_script("return document.activeElement.textContent") == "Cancel")
    press(browser, "dialog.asks button", "Cancel")
    assert shown(browser, "[data-name=GRIP] .lamp") == "OFF"
    click(browser, "[data-name=GRIP] [data-value='1']")
    press(browser, "dialog.asks button", "Switch")
    until(lambda: shown(browser, "[data-name=GRIP] .lamp") == "ON")
    # The page shows the WAIT at which the robot stands. Setting its input by hand ends the WAIT.
    browser.execute_script(
        "const said = (path, body) => fetch(path, {method: 'POST', body: "
        "JSON.stringify(body)}).then((answer) => answer.json());said('/api/orders/load', {file: "
        "'wait.yarc'}).then((told) => said('/api/orders/run', {program: told.program.number}))"
    )
    until(lambda: shown(browser, ".io-wait").startswith("P0020 waits for PART_READY = OFF since"))
    until(lambda: "Outputs can't be switched" in shown(browser, ".io-lists"))
    until(
        lambda: browser.execute_script(
            "return document.querySelector('[data-name=GRIP] [data-value]').disabled"
        )
    )
    click(browser, "[data-name=PART_READY] [data-value='0']")
    until(lambda: browser.execute_script("return document.querySelector('.io-wait').hidden"))
    until(lambda: shown(browser, "#bar .state") == "Idle")
    # Set a number, search for a signal, and try it without the rights.
    click(browser, "[data-name=PRESS_LOADED] button:last-child")
    browser.execute_script("document.querySelector('dialog.asks input').value = '7'")
    press(browser, "dialog.asks button", "Set")
    press(browser, "dialog.asks button", "Switch")
    until(lambda: shown(browser, "[data-name=PRESS_LOADED] .lamp") == "7")
    browser.execute_script(
        "const one = document.querySelector('.io-bar input[type=search]'); one.value = 'm2'; "
        "one.dispatchEvent(new Event('input'))"
    )
    names = "return [...document.querySelectorAll('.signal')].map((one) => one.dataset.name)"
    until(lambda: browser.execute_script(names) == ["PRESS_LOADED"])
    press(browser, "#bar button", "Release control")
    until(lambda: "Take control of the robot first" in shown(browser, ".io-lists"))


def test_one_choice_of_frames_and_a_payload(place):
    browser = place.browser
    goes_to(browser, "setup/tools")
    press(browser, ".frame-row", "{GRIPPER}")
    press(browser, ".frame-row", "{PRESS}")
    wanted = {"moving": "{GRIPPER}", "axes": "{PRESS}"}
    assert chosen(browser) == wanted
    until(lambda: shown(browser, ".frame-pose").startswith("{GRIPPER} is at X"))
    goes_to(browser, "status")
    assert chosen(browser) == wanted
    goes_to(browser, "jog")
    click(browser, "input[value=base]")
    until(lambda: chosen(browser) == wanted)
    # If the chosen frame no longer exists, the default is used, and the page says so.
    browser.execute_script(
        "localStorage.setItem('yarc.anna.jog', JSON.stringify({moving: '{GONE}', axes: '{B}'})); "
        "location.reload()"
    )
    until(lambda: "The frame {GONE} no longer exists" in shown(browser, "#notices"))
    goes_to(browser, "setup/tools")
    until(lambda: chosen(browser) == {"moving": "{TCP}", "axes": "{B}"})
    # Show the effect of a payload, and write it to robot.toml.
    press(browser, ".tool-names .pick", "GRIPPER")
    browser.execute_script(
        "document.querySelector('[name=mass]').value = '400'; "
        "document.querySelector('[name=center_y]').value = '500'"
    )
    press(browser, ".payload-form button", "Effect on the torques")
    press(browser, ".torque-kinds button", "Worst pose")
    assert browser.execute_script("return document.querySelectorAll('.torque[data-over=true]').length") > 0
    assert "This exceeds the limit of its motor" in shown(browser, ".torque-bars")
    press(browser, ".torques button", "Show the change")
    press(browser, "dialog.shows button", "Write it")
    until(lambda: "Your PIN" in shown(browser, "dialog.asks"))
    browser.execute_script("document.querySelector('dialog.asks input').value = arguments[0]", PIN)
    press(browser, "dialog.asks button", "Go on")
    until(lambda: "takes effect after a restart" in shown(browser, ".payload .ask"))
    text = (place.folder / "arm" / "robot.toml").read_text()
    assert "mass = 400  # weighed\ncenter_of_mass = [0, 500, 0]\n" in text
    # If the file is changed by somebody else while the proposed change is shown, nothing is written, and the
    # page says so.
    browser.execute_script("document.querySelector('[name=mass]').value = '3'")
    press(browser, ".payload-form button", "Effect on the torques")
    press(browser, ".torques button", "Show the change")
    (place.folder / "arm" / "robot.toml").write_text(text + "# later\n")
    press(browser, "dialog.shows button", "Write it")
    until(lambda: "another content" in shown(browser, "#notices"))
    assert (place.folder / "arm" / "robot.toml").read_text() == text + "# later\n"
