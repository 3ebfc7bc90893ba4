"""Browser tests of the page of files: upload, open, rename, delete and undo, and the changes since the last
commit.
"""

import os
import subprocess
import time

import pytest
from pendant.process import PASSWORD, PIN, PROGRAM, serving
from pendant.test_browser import SIZES, click, fill, goes_to, shown, size, until
from view.browser import browser_or_skip, opened_browser

LONG = "程序" * 8 + "long-name" * 20 + ".yarc"
MARKUP = "<img src=x onerror=alert(1)>.txt"


@pytest.fixture
def place(tmp_path):
    """Fixture: a pendant whose project has a commit, and a browser in which anna is logged in."""
    browser_or_skip()
    project = tmp_path / "project"
    project.mkdir()
    for name, text in (("bend.yarc", PROGRAM), ("note.txt", "one\ntwo\n"), (LONG, PROGRAM), (MARKUP, "x")):
        (project / name).write_text(text)
    (project / "parts").mkdir()
    (project / "parts" / "box.toml").write_text("")
    author = {f"GIT_{who}_{what}": "anna" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    for words in (("init", "-q"), ("add", "."), ("commit", "-qm", "First")):
        subprocess.run(["git", *words], cwd=project, env=os.environ | author, check=True, timeout=30)
    with serving(project) as (url, token, _), opened_browser(tmp_path / "profile") as browser:
        size(browser, *SIZES[0])
        browser.get(f"{url}#first={token}")
        fill(browser, user="anna", password=PASSWORD, pin=PIN)
        click(browser, "#entrance button.main")
        until(lambda: shown(browser, "#bar .name").startswith("INDUSTRIAL6"))
        goes_to(browser, "files")
        until(lambda: "bend.yarc" in shown(browser, ".files"))
        yield browser, project


def press(browser, label, where="#page"):
    """Press the button or link with a given label."""
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll(`${arguments[1]} :is(button, a)`)].find((one) => "
            "one.textContent === arguments[0] && one.checkVisibility()); it?.click(); return Boolean(it)",
            label,
            where,
        )
    )


def choose(browser, name):
    until(
        lambda: browser.execute_script(
            "const it = [...document.querySelectorAll('.files li')].find((one) => one.dataset.file === "
            "arguments[0]); if (it && it.firstChild.ariaExpanded !== 'true') it.firstChild.click(); return "
            "Boolean(it)",
            name,
        )
    )


def fits(browser, what):
    """Check in both sizes and both themes that nothing is cut off at the sides and STOP is in reach. If
    YARCLANG_PICTURES names a folder, save screenshots there.
    """
    for width, height in SIZES:
        size(browser, width, height)
        for theme in ("light", "dark"):
            browser.execute_script("document.documentElement.dataset.theme = arguments[0]", theme)
            time.sleep(0.3)
            if folder := os.environ.get("YARCLANG_PICTURES"):
                browser.save_screenshot(f"{folder}/files-{what}-{width}-{theme}.png")
        found = browser.execute_script(
            """
            const box = (one) => one.getBoundingClientRect();
            const pressed = [...document.querySelectorAll("#page :is(button, select, a.press)")].filter((one) => one.checkVisibility());
            const stop = box(document.getElementById("stop"));
            const hit = document.elementFromPoint(stop.x + stop.width / 2, stop.y + stop.height / 2);
            return {
              wide: Math.max(document.documentElement.scrollWidth, document.getElementById("page").scrollWidth + box(document.getElementById("page")).left),
              right: box(document.getElementById("page")).right,
              small: pressed.filter((one) => box(one).height < 43.5 || box(one).width < 43.5).map((one) => one.textContent),
              stop: Boolean(hit.closest("#stop")),
            };
            """  # noqa: E501
        )
        assert found["wide"] <= max(width, found["right"]), (what, width)
        assert found["small"] == [], (what, width)
        assert found["stop"], (what, width)
    size(browser, *SIZES[0])


def test_files_from_upload_to_undo(place, tmp_path):
    browser, project = place
    assert browser.execute_script("return document.querySelectorAll('#page img').length") == 0
    fits(browser, "list")
    # Upload several files at once.
    for name in ("new one.txt", "سلام.txt"):
        (tmp_path / name).write_text("uploaded")
    files = "\n".join(str(tmp_path / name) for name in ("new one.txt", "سلام.txt"))
    browser.find_element("css selector", "#page input[type=file]").send_keys(files)
    until(lambda: (project / "سلام.txt").exists() and "new one.txt" in shown(browser, ".files"))
    assert (project / "new one.txt").read_text() == "uploaded"
    until(lambda: shown(browser, "[data-file='new one.txt'] .mark") == "new")
    # An existing file is replaced only after a confirmation.
    (tmp_path / "note.txt").write_text("uploaded over it")
    browser.find_element("css selector", "#page input[type=file]").send_keys(str(tmp_path / "note.txt"))
    until(lambda: "another content" in shown(browser, "#notices"))
    assert (project / "note.txt").read_text() == "one\ntwo\n"
    press(browser, "Replace it", "#notices")
    until(lambda: (project / "note.txt").read_text() == "uploaded over it")
    # Show the changes, in a view whose styles the security policy allows.
    until(lambda: shown(browser, "[data-file='note.txt'] .mark") == "changed")
    choose(browser, "note.txt")
    until(lambda: "Changed by anna" in shown(browser, ".tools"))
    fits(browser, "chosen")
    press(browser, "Difference")
    sides = (
        "return [...(document.querySelector('.editor')?.shadowRoot.querySelectorAll('.cm-content') ?? "
        "[])].map((one) => one.innerText)"
    )
    until(lambda: len(browser.execute_script(sides)) == 2)
    assert [one.split("\n")[0] for one in browser.execute_script(sides)] == ["one", "uploaded over it"]
    assert (
        browser.execute_script(
            "return "
            "getComputedStyle(document.querySelector('.editor').shadowRoot.querySelector('.cm-mergeViewEditors')).display"
        )
        == "flex"
    )
    fits(browser, "difference")
    press(browser, "Close")
    # Rename, delete and restore a file.
    choose(browser, LONG)
    press(browser, "Rename")
    fits(browser, "rename")
    browser.execute_script("document.querySelector('[name=path]').value = 'bend.yarc'")
    click(browser, "dialog button.main")
    until(lambda: "is there already" in shown(browser, "dialog .told"))
    browser.execute_script("document.querySelector('[name=path]').value = 'parts/лист.yarc'")
    click(browser, "dialog button.main")
    until((project / "parts" / "лист.yarc").exists)
    choose(browser, "bend.yarc")
    press(browser, "Delete")
    until(lambda: not (project / "bend.yarc").exists())
    press(browser, "Undo", "#notices")
    until(lambda: (project / "bend.yarc").exists() and "bend.yarc was restored" in shown(browser, "#notices"))
    choose(browser, MARKUP)
    press(browser, "Open")
    until(lambda: browser.execute_script(sides) == ["x"])
    fits(browser, "text")
    refused = [entry for entry in browser.get_log("browser") if "Content Security Policy" in entry["message"]]
    assert refused == []
    choose(browser, "bend.yarc")
    press(browser, "Open", ".tools")
    until(lambda: browser.execute_script("return location.hash") != "#/files")
