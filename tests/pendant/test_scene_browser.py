"""Browser tests of the 3D view: bodies and the ghost are in their places, and nothing remains in memory when
the view is closed.
"""

import time

import pytest
from pendant.process import PROGRAM, serving
from pendant.test_browser import Place, goes_to, held, shown, size, until
from view.browser import browser_or_skip, opened_browser

HOSTILE = "<img src=x onerror=alert(1)>"
CELL = """
units = "mm,deg,s"

[[obstacles]]
name = "BLOCK"
shape = "box"
frame = "B"
xyz = [600, -500, 100]
size = [200, 200, 200]

[[zones]]
name = "SLOWLY"
rule = "slow"
shape = "box"
frame = "B"
xyz = [900, 600, 300]
size = [200, 200, 200]
speed = 250

[outputs.GRIP]
variable = "M1"
grips = "FLANGE"

[[parts]]
name = "BOX"
shape = "box"
frame = "B"
xyz = [-600, 500, 50]
size = [100, 100, 100]
mass = 0.1
"""

# Open a separate 3D view, whose internal data the test can read.
OPEN = """
const [done] = [arguments[arguments.length - 1]];
import("/scene/scene.js").then(({ Scene3D }) => {
  const place = document.createElement("div");
  place.id = "trial";
  document.getElementById("page").append(place);
  place.style.cssText = "position: fixed; left: 110px; top: 70px; width: 700px; height: 500px";
  window.trialApp = { robot: Object.assign(new EventTarget(), { connected: true, display: null }), holding: { moving: false } };
  fetch("/api/robot").then(() => {
    const socket = new WebSocket(`ws://${location.host}/api/robot`);
    socket.onmessage = ({ data }) => {
      const told = JSON.parse(data);
      if (told.event !== "display") return;
      trialApp.robot.display = told;
      trialApp.robot.dispatchEvent(new Event("display"));
    };
    window.trial = new Scene3D(place, trialApp);
    place.addEventListener("drawn", () => done(true), { once: true });
  });
});
"""  # noqa: E501


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    browser_or_skip()
    folder = tmp_path_factory.mktemp("scene")
    (folder / "bend.yarc").write_text(PROGRAM)
    (folder / "cell.toml").write_text(CELL)
    (folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    with serving(folder) as (url, token, process), opened_browser(folder / "profile") as browser:
        browser.set_script_timeout(60)
        yield Place(url, token, process, browser)


def test_bodies_stand_where_they_should(place):
    browser = place.browser
    goes_to(browser, "system/account")
    browser.execute_async_script(OPEN)
    found = browser.execute_script(
        """
        trial.bodies.items.find(({ item }) => item.name === "BLOCK").item.name = arguments[0];
        trial.name();
        trial.painter.scene.updateMatrixWorld(true);
        const at = (one) => [...one.matrixWorld.elements];
        const robot = trial.bodies.items.filter(({ item }) => item.joint > 0);
        return {
          items: trial.bodies.items.map(({ item, mesh }) => [item.name, item.kind, item.joint, item.pose, at(mesh)]),
          links: trialApp.robot.display.links, flange: trialApp.robot.display.flange,
          tool: at(trial.bodies.triads.find(({ axes }) => axes.name === "FLANGE").group),
          labels: [...document.querySelectorAll("#trial .label3d")].map((one) => one.textContent),
          images: document.querySelectorAll("#trial img").length,
        };
        """,  # noqa: E501
        HOSTILE,
    )
    names = {one[0]: one for one in found["items"]}
    assert HOSTILE in found["labels"]
    assert found["images"] == 0
    assert {"BOX", "SLOWLY"} <= names.keys()
    columns = [found["flange"][row * 4 + column] for column in range(4) for row in range(4)]
    assert max(abs(one - other) for one, other in zip(found["tool"], columns, strict=True)) < 1e-5
    assert max(abs(a - b) for a, b in zip(names["BOX"][4][12:15], (-0.6, 0.5, 0.05), strict=True)) < 1e-6
    # A pixel in the middle of the obstacle has the obstacle's colour; a pixel of the background hasn't.
    pixel = browser.execute_script(
        """
        const mesh = trial.bodies.items.find(({ item }) => item.kind === "obstacle").mesh;
        trial.show({ labels: false, grid: false, zone: false });
        const { camera, controls } = trial.eye;
        camera.position.set(0.6, -2.5, 0.1); controls.target.set(0.6, -0.5, 0.1); controls.update();
        camera.updateMatrixWorld(true);
        trial.painter.renderer.render(trial.painter.scene, camera);
        const gl = trial.painter.renderer.getContext();
        const read = (x, y) => { const four = new Uint8Array(4); gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, four); return [...four]; };
        return [read(gl.drawingBufferWidth / 2, gl.drawingBufferHeight / 2), read(4, gl.drawingBufferHeight - 4)];
        """  # noqa: E501
    )
    assert max(abs(one - other) for one, other in zip(*pixel, strict=True)) > 40, pixel


def test_the_ghost_stands_elsewhere(place):
    browser = place.browser
    found = browser.execute_async_script(
        """
        const done = arguments[arguments.length - 1];
        const course = { times: [0, 1, 2], joints: [[0, 0, 0, 0, 0, 0], [20, 0, 0, 0, 0, 0], [40, 10, 0, 0, 30, 0]] };
        trial.showWay(course).then(() => {
          trial.ghost([20, 0, 0, 0, 0, 0]);
          const local = [...trial.bodies.ghosts[1].matrix.elements];
          trial.ghost([-30, 0, 0, 0, 0, 0]);
          const wait = () => {
            const now = trial.bodies.ghosts[1].matrix.elements;
            if (now[1] > 0) return setTimeout(wait, 20);
            const asked = [...now];
            trial.ghost(null);
            done([local, asked, trial.bodies.ghosts[1].visible, trial.way.points.length, trial.way.fastest]);
          };
          wait();
        });
        """  # noqa: E501
    )
    assert abs(found[0][0] - 0.9396926) < 1e-5
    assert abs(found[1][1] + 0.5) < 1e-5
    assert found[2] is False
    assert found[3] == 3
    assert 0.1 < found[4] < 2.0


def test_it_is_drawn_only_if_something_changes(place):
    """While nothing moves, no frame is drawn. If the graphics context is lost, the page says so, and draws
    again later.
    """
    browser = place.browser
    time.sleep(1.0)
    frames = browser.execute_script("return trial.painter.frames")
    time.sleep(1.0)
    assert browser.execute_script("return trial.painter.frames") - frames == 0
    browser.execute_script(
        "window.loss = trial.painter.renderer.getContext().getExtension('WEBGL_lose_context'); "
        "loss.loseContext()"
    )
    until(lambda: "lost" in shown(browser, "#trial .scene-words"))
    browser.execute_script("loss.restoreContext()")
    until(lambda: shown(browser, "#trial .scene-words") == "")
    until(lambda: browser.execute_script("return trial.painter.frames") > frames)


def test_nothing_is_left_when_it_is_closed(place):
    browser = place.browser
    browser.execute_script("window.before = trial.painter.renderer; trial.close()")
    left = browser.execute_script(
        "return [before.info.memory.geometries, before.info.memory.textures, "
        "document.querySelectorAll('#trial canvas').length]"
    )
    assert left == [0, 0, 0]
    sizes = []
    for number in range(20):
        goes_to(browser, "scene")
        until(lambda: browser.execute_script("return document.querySelector('.scene-words')?.hidden"), 30.0)
        goes_to(browser, "system/account")
        if number in (4, 19):
            browser.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
            sizes.append(browser.execute_cdp_cmd("Runtime.getHeapUsage", {})["usedSize"])
    assert sizes[1] < sizes[0] + 2e6, sizes


def test_without_webgl_it_says_so(place):
    browser = place.browser
    browser.execute_script(
        "window.plain = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = "
        "() => null"
    )
    try:
        goes_to(browser, "scene")
        until(lambda: "can't draw in three dimensions" in shown(browser, "#page"))
    finally:
        browser.execute_script("HTMLCanvasElement.prototype.getContext = plain")
        goes_to(browser, "system/account")


def test_a_picture_beside_jog_doesnt_slow_it(place):
    browser = place.browser
    size(browser, 1280, 800)
    goes_to(browser, "jog")
    place.control()
    until(lambda: browser.execute_script("return document.querySelector('.scene-words')?.hidden"), 30.0)
    browser.execute_script(
        """
        window.drawn = [];
        const plain = window.requestAnimationFrame;
        window.requestAnimationFrame = (draw) => plain((now) => {
          const begun = performance.now();
          draw(now);
          drawn.push(performance.now() - begun);
        });
        """
    )
    with held(place, "[data-axis=J1][data-sign='1']"):
        time.sleep(2.0)
    drawn = sorted(browser.execute_script("return drawn"))
    # On a busy computer some frames are interrupted, so check only the faster half.
    assert 2 <= len(drawn) <= 40
    assert drawn[len(drawn) // 2] < 50.0


def test_nothing_was_refused_by_the_policy(place):
    said = [entry["message"] for entry in place.browser.get_log("browser")]
    assert [one for one in said if "Content Security Policy" in one] == []
