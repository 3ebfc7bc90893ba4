"""Browser test of the workspace page: an obstacle is dragged, its numbers follow, and the change is saved
with the PIN.
"""

import tomllib

import pytest
from pendant.process import PIN, PROGRAM, serving
from pendant.test_browser import Place, click, goes_to, shown, size, until
from pendant.test_scene_browser import CELL
from view.browser import browser_or_skip, opened_browser

BLOCK = ".bodies button[data-name=BLOCK]"
# Find the tip of the handle along z on the screen, and check that a finger's width around it belongs to the
# handle.
HANDLE = """
const { ghosts } = document.querySelector(".workspace").shown;
const { handles, scene } = ghosts;
const { camera } = scene.eye;
const body = handles.object;
const box = scene.painter.canvas.getBoundingClientRect();
const at = (point) => {
  const seen = point.clone().project(camera);
  return [box.left + (seen.x * 0.5 + 0.5) * box.width, box.top + (0.5 - seen.y * 0.5) * box.height];
};
scene.painter.scene.updateMatrixWorld(true);
const origin = body.getWorldPosition(body.position.clone());
const high = camera.position.distanceTo(origin) * 1.9 * Math.tan((camera.fov * Math.PI) / 360) * handles.size / 4;
const tip = origin.clone();
tip.z += 0.5 * high;
return [at(origin), at(tip)];
"""  # noqa: E501


@pytest.fixture
def place(tmp_path):
    browser_or_skip()
    (tmp_path / "bend.yarc").write_text(PROGRAM)
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    with serving(tmp_path) as (url, token, process), opened_browser(tmp_path / "profile") as browser:
        browser.set_script_timeout(60)
        yield Place(url, token, process, browser), tmp_path


def finger(browser, kind, *at):
    points = [{"x": at[0], "y": at[1]}] if at else []
    browser.execute_cdp_cmd("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def block(browser):
    return browser.execute_script(f"return document.querySelector('{BLOCK} small')?.textContent ?? ''")


def test_an_obstacle_is_dragged_and_saved(place):
    place, folder = place
    browser = place.browser
    size(browser, 1280, 800)
    goes_to(browser, "setup/workspace")
    until(lambda: "600 -500 100" in block(browser))
    click(browser, BLOCK)
    until(
        lambda: browser.execute_script(
            "return Boolean(document.querySelector('.workspace')?.shown.ghosts?.handles.object)"
        ),
        60.0,
    )
    (_x, y), (tip_x, tip_y) = browser.execute_script(HANDLE)
    assert 80 < abs(y - tip_y) < 130  # the handle is large enough for a finger
    # Touch beside the middle of the handle, but within 22 px.
    finger(browser, "touchStart", tip_x + 12, tip_y + 4)
    for step in range(1, 6):
        finger(browser, "touchMove", tip_x + 12, tip_y + 4 - 10 * step)
    finger(browser, "touchEnd")
    until(lambda: "changed" in shown(browser, BLOCK))
    z = browser.execute_script("return document.querySelector('[name=xyz2]').value")
    assert block(browser) == f"obstacle, box, B 600 -500 {z}"
    assert float(z) > 110
    assert float(z) == round(float(z))
    # A drag is undone in one step.
    click(browser, ".draft-bar button:nth-of-type(1)")
    until(lambda: "600 -500 100" in block(browser))
    browser.execute_script(
        "const it = document.querySelector('[name=xyz2]'); it.value = '321,5'; it.dispatchEvent(new "
        "Event('change'))"
    )
    until(lambda: "600 -500 321.5" in block(browser))
    click(browser, ".draft-bar .main")
    until(lambda: "can still be proved" in shown(browser, ".checked"), 90.0)
    click(browser, ".sheet .main")
    until(lambda: browser.execute_script("return Boolean(document.querySelector('dialog.asks input'))"))
    browser.execute_script("document.querySelector('dialog.asks input').value = arguments[0]", PIN)
    click(browser, "dialog.asks button.main")
    until(lambda: shown(browser, ".draft-bar .said") == "No changes")
    found = tomllib.loads((folder / "cell.toml").read_text())
    assert found["obstacles"][0]["xyz"] == [600, -500, 321.5]
    assert (folder / "cell.toml").read_text() == CELL.replace("[600, -500, 100]", "[600, -500, 321.5]")
    # The 3D view of all pages shows the change.
    until(
        lambda: any(
            one["name"] == "BLOCK" and abs(one["pose"][11] - 0.3215) < 1e-6
            for one in place.api.call("GET", "/api/scene")["items"]
        )
    )
