"""Tests of `yarc view` in a real browser: the picture and its controls, without any request to other
machines.
"""

import io
import json
import re

import matplotlib.image
import numpy as np
import pytest
import viser
from view.browser import REBOUND, browser_or_skip, opened_browser, viewed, waited
from view.stages import CRASH, EXAMPLES


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    folder = tmp_path_factory.mktemp("program")
    (folder / "cell.toml").write_text((EXAMPLES / "cell.toml").read_text())
    path = folder / "crash.yarc"
    path.write_text(CRASH)
    return path


@pytest.fixture(scope="module")
def page(program, tmp_path_factory):
    """Yield the loaded page of a program, its process and its address."""
    browser_or_skip()
    with (
        viewed(str(program)) as (url, process),
        opened_browser(tmp_path_factory.mktemp("profile")) as browser,
    ):
        browser.get(url)
        waited(lambda: "P0010 MOVEJ_RPY" in text_of(browser))
        yield browser, process, url
        # the addresses of all requests of the page
        asked = {
            message["params"]["request"]["url"]
            if "request" in message["params"]
            else message["params"]["url"]
            for entry in browser.get_log("performance")
            for message in (json.loads(entry["message"])["message"],)
            if message["method"] in {"Network.requestWillBeSent", "Network.webSocketCreated"}
        }
        own = re.compile(
            rf"(http|ws)://{re.escape(url.removeprefix('http://'))}(/|$)|data:|blob:|chrome(-untrusted)?:"
            r"|about:"
        )
        assert [one for one in asked if not own.match(one)] == []
        assert any(own.match(one) for one in asked)


def text_of(browser):
    return browser.execute_script("return document.body.innerText")


def press(browser, text):
    def found():
        elements = browser.find_elements("css selector", "button, [role=tab]")
        return next((one for one in elements if text in one.text), None)

    waited(found).click()


def picture(browser):
    """Return the part of the screenshot with the scene (rows, columns, 3), from 0 to 1."""
    pixels = matplotlib.image.imread(io.BytesIO(browser.get_screenshot_as_png()))[:, :, :3]
    return pixels[:, 320:790]


def red(pixels):
    """Return the number of pixels with the colour of colliding bodies, in any light."""
    r, g, b = pixels[:, :, 0], pixels[:, :, 1], pixels[:, :, 2]
    return int(((r > 0.6) & (g < 0.3 * r) & (b < 0.3 * r)).sum())


def orange(pixels):
    """Return the number of pixels with the colour of the robot's links, in any light."""
    r, g, b = pixels[:, :, 0], pixels[:, :, 1], pixels[:, :, 2]
    return int(((r > 0.6) & (g > 0.35 * r) & (g < 0.75 * r) & (b < 0.6 * g)).sum())


def test_the_robot_is_drawn_and_the_bench_is_not_red(page):
    browser, _, _ = page
    waited(lambda: orange(picture(browser)) > 4_000)
    assert red(picture(browser)) < 200


def test_a_finding_leads_to_its_place_and_colours_the_bodies(page):
    browser, _, _ = page
    press(browser, "Findings")
    press(browser, "Y0901 P0030")
    waited(lambda: "FINGERS penetrates BENCH by 30 mm" in text_of(browser))
    waited(lambda: "-30.0 mm (FINGERS, BENCH)" in text_of(browser))
    waited(lambda: red(picture(browser)) > 1_500)


def test_no_text_of_a_button_or_label_is_cut_off(page):
    browser, _, _ = page
    script = """
        return [...document.querySelectorAll("button, button *, label, label *, [role=tab]")]
            .filter(one => one.clientWidth > 0 && one.scrollWidth > one.clientWidth).map(one => one.textContent);
    """  # noqa: E501
    for tab, word in (("Findings", "Y0901 P0030"), ("Show", "other frames"), ("Commands", "P0020 MOVEL")):
        press(browser, tab)
        waited(lambda word=word: word in text_of(browser))
        assert browser.execute_script(script) == []
        if tab == "Findings":
            assert "FINGERS penetrates BENCH by 30 mm" in text_of(browser)


def test_a_command_leads_to_its_beginning_and_time_passes(page):
    browser, _, _ = page
    press(browser, "Commands")
    press(browser, "P0020 MOVEL")
    waited(lambda: re.search(r"duration\s+2\.000 s", text_of(browser)))
    before = picture(browser)
    press(browser, "Play")
    waited(lambda: np.abs(picture(browser) - before).max() > 0.2)
    waited(lambda: "P0050 MOVEL · line 10" in text_of(browser))


def test_the_path_by_clearance(page):
    browser, _, _ = page
    assert "mm/s" in text_of(browser)
    field = next(
        one for one in browser.find_elements("css selector", "input") if one.get_attribute("value") == "speed"
    )
    field.click()
    option = waited(
        lambda: next(
            (
                one
                for one in browser.find_elements("css selector", "[role=option]")
                if "smallest distance" in one.text
            ),
            None,
        )
    )
    option.click()
    waited(lambda: "≥ 200 mm" in text_of(browser))


def test_a_page_of_another_site_is_refused(page):
    """A connection from another site's page is refused."""
    import asyncio

    from websockets.asyncio.client import connect
    from websockets.exceptions import InvalidStatus

    _, _, url = page

    async def listened(origin):
        address = url.replace("http", "ws")
        protocol = f"viser-v{viser.__version__}"
        async with connect(address, subprotocols=[protocol], origin=origin, max_size=None) as stream:
            return [message async for message in _first(stream)]

    with pytest.raises(InvalidStatus, match="403"):
        asyncio.run(listened("https://elsewhere.example"))
    assert len(asyncio.run(listened(url))) == 1


def test_a_site_that_gives_itself_this_address_sees_nothing(program, tmp_path):
    """Under another host name for this address, the page shows nothing; under its own it shows all."""
    browser_or_skip()
    with viewed(str(program)) as (url, _), opened_browser(tmp_path / "profile") as browser:
        browser.get(url.replace("127.0.0.1", REBOUND))
        assert "yarc view is not known by this name" in waited(lambda: text_of(browser))
        script = """
            const done = arguments[arguments.length - 1], seen = [];
            const stream = new WebSocket("ws://" + location.host, arguments[0]);
            stream.onmessage = message => { seen.push(message.data.size); done(["open", seen]); };
            stream.onerror = () => done(["refused", seen]);
            stream.onopen = () => setTimeout(() => done(["open", seen]), 20000);
        """
        browser.set_script_timeout(30)
        assert browser.execute_async_script(script, f"viser-v{viser.__version__}") == ["refused", []]
        browser.get(url)
        waited(lambda: "P0010 MOVEJ_RPY" in text_of(browser))
        answer = browser.execute_async_script(script, f"viser-v{viser.__version__}")
        assert answer[0] == "open"
        assert answer[1]


async def _first(stream):
    from websockets.exceptions import ConnectionClosed

    try:
        yield await stream.recv()
    except ConnectionClosed:
        return


def test_ctrl_c_ends_it(program):
    with viewed(str(program)) as (_, process):
        pass
    assert process.returncode == 0


def test_curves_stand_beside_the_time_and_a_frame_gives_its_line(page):
    browser, _, _ = page
    press(browser, "Commands")
    press(browser, "P0050 MOVEL")
    press(browser, "Curves")
    lines = "return document.querySelectorAll('svg polyline').length"
    waited(lambda: browser.execute_script(lines) == 13)
    places = """
        const box = one => one.getBoundingClientRect();
        const marker = box(document.querySelector("[data-marker]"));
        const all = [...document.querySelectorAll("svg")].filter(one => one.querySelector("polyline"));
        const first = box(all[0]), last = box(all[all.length - 1]);
        return [(marker.left - first.left) / first.width, first.top - marker.top, marker.bottom - last.bottom];
    """  # noqa: E501
    # the marker is where the command begins, and crosses all curves
    waited(lambda: abs(browser.execute_script(places)[0] - 6.891 / 11.891) < 0.02)
    _, above, below = browser.execute_script(places)
    assert above > 0.0
    assert below > -2.0
    press(browser, "Frames")
    waited(lambda: "Choose a frame, drag it" in text_of(browser))

    def field(value):
        found = browser.find_elements("css selector", "input")
        return next((one for one in found if one.get_attribute("value") == value), None)

    waited(lambda: field("none")).click()
    options = "css selector", "[role=option]"
    waited(
        lambda: next((one for one in browser.find_elements(*options) if "{PART}" in one.text), None)
    ).click()
    wanted = "FRAME {PART} 0 0 100 0 0 0 (mm,deg) {FIXTURE}"
    areas = "return [...document.querySelectorAll('textarea')].map(one => one.value)"
    waited(lambda: wanted in browser.execute_script(areas))
    press(browser, "Commands")
