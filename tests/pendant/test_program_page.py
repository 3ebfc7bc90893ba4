"""Browser tests of the page Program: list and text, edits by buttons, saving, drafts, findings, long
programs.
"""

import json
import time
from pathlib import Path

import pytest
from pendant.process import PROGRAM, serving
from pendant.test_browser import SIZES, Place, shown, size, until
from view.browser import browser_or_skip, opened_browser

WRONG = (
    "! two faults\nP0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\nP0020 MOVEJ HOEM [6] (deg,s)\n"
    "REPEAT 2\n  P0030 MOVEJ 0 0 0 0 30 0 [6] (deg,s)\nEND\nP0040 MOVEJ HOME [6] (deg,s)\n"
)
HOSTILE = "a/<img src=x onerror=alert(1)> 日本語 עברית %25 #.yarc"
LONG = "".join(f"P{10 * at:05d} MOVEJ {at % 40} 0 0 0 30 0 [6] (deg,s)\n" for at in range(1, 5001))


UNDO = "[...document.querySelectorAll('.tools button')].find((one) => one.textContent === 'Undo').click()"


class Page(Place):
    """A browser in which anna, a service user, has the page Program open."""

    def run(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def open(self, file, rows=1):
        self.run(
            "location.hash = '#/program/' + arguments[0].split('/').map(encodeURIComponent).join('/')", file
        )
        name = file.rpartition("/")[2]
        until(lambda: shown(self.browser, ".program .file").removeprefix("● ") == name, 30.0)
        until(lambda: self.run("return document.querySelectorAll('.row').length") >= rows, 60.0)

    def text(self):
        return self.run(
            "return [...document.querySelector('.program "
            ".text').shadowRoot.querySelectorAll('.cm-line')].map((one) => one.textContent).join('\\n')"
        )

    def type(self, text):
        """Type text at the beginning of the program."""
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.keys import Keys

        self.run("document.querySelector('.program .text').shadowRoot.querySelector('.cm-content').focus()")
        keys = ActionChains(self.browser).key_down(Keys.CONTROL).send_keys(Keys.HOME).key_up(Keys.CONTROL)
        keys.send_keys(text).perform()

    def press(self, label, within=".program"):
        """Press the enabled button with a given label."""
        script = (
            "const it = [...document.querySelectorAll(`${arguments[1]} button`)].find((one) => "
            "(one.getAttribute('aria-label') ?? one.textContent) === arguments[0] && !one.disabled && "
            "one.checkVisibility());it?.click(); return Boolean(it)"
        )
        until(lambda: self.run(script, label, within))

    def row(self, title):
        """Choose the row whose title begins with a text."""
        script = (
            "const it = [...document.querySelectorAll('.row')].find((one) => "
            "one.querySelector('.title').textContent.startsWith(arguments[0]));it?.click(); return "
            "Boolean(it)"
        )
        until(lambda: self.run(script, title))

    def titles(self):
        return self.run("return [...document.querySelectorAll('.row .title')].map((one) => one.textContent)")

    def discard(self):
        """Discard unsaved changes, so that leaving the page asks no question."""
        self.run("localStorage.setItem('yarc.anna.program', '{}')")
        goes = "location.hash = '#/run'"
        self.run(goes)
        time.sleep(0.3)
        if "isn't saved" in shown(self.browser, ".sheet"):
            self.press("Discard my changes", ".sheet")
        until(lambda: self.run("return !document.querySelector('.program')"))


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    browser_or_skip()
    folder = tmp_path_factory.mktemp("program")
    (folder / "a").mkdir()
    for name, text in (
        ("wrong.yarc", WRONG),
        ("bend.yarc", PROGRAM),
        (HOSTILE, PROGRAM),
        ("long.yarc", LONG),
    ):
        (folder / name).write_text(text)
    with serving(folder) as (url, token, process), opened_browser(folder / "profile") as browser:
        made = Page(url, token, process, browser)
        made.folder = folder
        yield made


def test_list_text_and_findings_are_one(page):
    """Choosing a row selects its lines, and selecting lines chooses their row. A finding is shown in the
    text, in the list of findings and in the row, and its fix can be undone in one step.
    """
    page.open("wrong.yarc", 7)
    page.row("MOVEJ HOEM")
    active = (
        "return document.querySelector('.program "
        ".text').shadowRoot.querySelector('.cm-activeLine').textContent"
    )
    until(lambda: "HOEM" in page.run(active))
    until(lambda: "Y0205" in shown(page.browser, ".found"), 60.0)
    until(
        lambda: page.run("return document.querySelector('.row[aria-selected=true]').dataset.found") == "error"
    )
    assert page.run(
        "return Boolean(document.querySelector('.program "
        ".text').shadowRoot.querySelector('.cm-lintRange-error'))"
    )
    page.press("write HOME", ".found")
    until(lambda: "MOVEJ HOEM" not in page.titles() and "P0020 MOVEJ HOME" in page.text())
    until(lambda: "Y0205" not in shown(page.browser, ".found"), 60.0)
    page.press("Undo")
    until(lambda: "HOEM" in page.text())
    page.press("Redo")
    until(lambda: "HOEM" not in page.text())
    page.discard()


def test_buttons_and_typing_have_one_history(page):
    page.open("bend.yarc", 2)
    before = page.text()
    page.type("! typed\n")
    until(lambda: page.titles()[0] == "typed")
    page.row("MOVEJ HOME")
    page.press("Teach here")
    page.press("Teach", ".sheet")
    until(lambda: len(page.titles()) == 4)
    taught = page.text()
    assert taught.splitlines()[:3] == ["! typed", *before.splitlines()[:2]]
    page.press("Touch up")  # the new motion is the selected one
    page.press("Move up")
    until(lambda: page.titles()[-1] == "MOVEJ HOME")
    page.press("Delete")
    until(lambda: len(page.titles()) == 3)
    for _ in range(30):
        page.run(UNDO)
    until(lambda: page.text() == before)
    page.row("MOVEJ 20")
    page.press("Edit")
    until(
        lambda: page.run(
            "const it = document.querySelector('.sheet [name=time]'); if (it) it.value = '7'; return "
            "Boolean(it)"
        )
    )
    page.press("Change", ".sheet")
    until(lambda: "[7]" in page.text())
    page.discard()


def test_saving_and_others(page):
    """Saving shows the changes. A file that another user has changed isn't overwritten without a question. A
    draft survives a reload.
    """
    place = page.folder / "bend.yarc"
    place.write_bytes(PROGRAM.replace("\n", "\r\n").encode())
    page.open("bend.yarc", 2)
    page.type("! mine\n")
    page.press("Save")
    until(
        lambda: (
            page.run(
                "return document.querySelector('.compared').shadowRoot.querySelectorAll('.cm-changedLine, "
                ".cm-insertedLine').length"
            )
            > 0
        )
    )
    assert place.read_bytes() == PROGRAM.replace("\n", "\r\n").encode()
    page.press("Save", ".sheet")
    until(lambda: place.read_bytes() == ("! mine\n" + PROGRAM).replace("\n", "\r\n").encode())
    until(lambda: not shown(page.browser, ".program .file").startswith("●"))
    # Without unsaved changes, the page shows the new text on the disk.
    place.write_text("! theirs\n" + PROGRAM)
    until(lambda: page.titles()[:1] == ["theirs"], 20.0)
    # A draft survives a reload. The page says that the file was changed in the meantime.
    page.type("! draft\n")
    until(lambda: page.titles()[0] == "draft")
    page.run("window.dispatchEvent(new Event('pagehide'))")
    place.write_text("! newer\n" + PROGRAM)
    page.browser.execute_cdp_cmd("Page.enable", {})
    page.browser.execute_cdp_cmd("Page.reload", {})
    time.sleep(0.5)
    accept(page.browser)
    until(lambda: "was changed on the disk" in shown(page.browser, ".warnings"), 30.0)
    assert page.text().startswith("! draft")
    page.press("Show the difference", ".warnings")
    until(lambda: page.run("return Boolean(document.querySelector('.compared'))"))
    assert place.read_text().startswith("! newer")
    page.press("Write mine", ".sheet")
    until(lambda: place.read_text().startswith("! draft"))
    # Now the draft is dropped for the text on the disk.
    page.type("! again\n")
    place.write_text(PROGRAM)
    until(lambda: "was changed on the disk" in shown(page.browser, ".warnings"), 20.0)
    page.press("Take theirs", ".warnings")
    until(lambda: page.text() == PROGRAM)
    # A visit to the page Jog asks no question. Afterwards the draft, the chosen line and the undo history are
    # back.
    page.type("! x\n")
    until(lambda: shown(page.browser, ".program .file").startswith("●"))
    until(lambda: page.titles()[0] == "x")
    page.row("MOVEJ")
    chosen = page.run("return document.querySelector('.row[aria-selected=true]').textContent")
    page.run("location.hash = '#/jog'")
    until(lambda: page.run("return Boolean(document.querySelector('.axes, .place.unsaved'))"))
    page.run("location.hash = '#/program'")
    until(lambda: shown(page.browser, ".row[aria-selected=true]") == chosen)
    assert page.text().startswith("! x")
    # The undo history is complete.
    for _ in range(10):
        page.run(UNDO)
    assert not page.text().startswith("! x")
    for _ in range(10):
        page.run(UNDO.replace("Undo", "Redo"))
    assert page.text().startswith("! x\n")
    # The page Run would run the text on the disk, so leaving for it asks a question.
    page.run("location.hash = '#/run'")
    page.press("Stay", ".sheet")
    assert page.run("return location.hash").startswith("#/program")
    page.run("location.hash = '#/run'")
    page.press("Save", ".sheet")
    until(
        lambda: place.read_text().startswith("! x") and page.run("return !document.querySelector('.program')")
    )


def accept(browser):
    """Confirm that a page with changes is left."""
    from selenium.common.exceptions import NoAlertPresentException

    try:
        browser.switch_to.alert.accept()
    except NoAlertPresentException:
        return


def test_names_are_texts_and_sizes_fit(page):
    page.open(HOSTILE, 2)
    for width, height in SIZES:
        size(page.browser, width, height)
        for tab in ("text", "found", "list"):
            page.run("document.querySelector(`[data-tab=${arguments[0]}]`).click()", tab)
            time.sleep(0.1)
            found = page.run(
                """
                const all = [...document.querySelectorAll('#page button, #page input')].filter((one) => one.checkVisibility());
                return {
                  wide: document.documentElement.scrollWidth,
                  small: all.filter((one) => one.getBoundingClientRect().height < 43.5 || one.getBoundingClientRect().width < 43.5).map((one) => one.textContent),
                  out: all.filter((one) => one.getBoundingClientRect().right > document.getElementById('page').getBoundingClientRect().right + 1).map((one) => one.textContent),
                  images: document.querySelectorAll('#page img').length,
                };
                """  # noqa: E501
            )
            assert found == {"wide": width, "small": [], "out": [], "images": 0}, (width, tab)
    size(page.browser, *SIZES[0])


def test_a_long_program(page):
    """Of a program with five thousand lines, only few rows are in the page, but the last one can
    be reached.
    """
    page.open("long.yarc", 5)
    rows = "return document.querySelectorAll('.row').length"
    assert page.run(rows) < 60
    page.run("const it = document.querySelector('.rows'); it.scrollTop = it.scrollHeight")
    until(lambda: "P50000" in shown(page.browser, ".rows"))
    assert page.run(rows) < 60
    page.run("[...document.querySelectorAll('.row')].at(-1).click()")
    until(lambda: "P50000" in page.text())


def test_the_line_that_runs_is_lit(page):
    (page.folder / "bend.yarc").write_text(PROGRAM)
    page.open("bend.yarc", 2)
    page.control()
    page.run(
        """
        const post = (word, body) => fetch(`/api/orders/${word}`, {method: "POST", headers: {"content-type": "application/json"}, body: JSON.stringify(body)}).then((one) => one.json());
        post("load", {file: "bend.yarc", approach: true}).then((told) => post("run", {program: told.program.number, approach: true}));
        """  # noqa: E501
    )
    until(
        lambda: (
            page.run("return document.querySelector('.row[aria-current=step] .index')?.textContent")
            == "P0010"
        ),
        30.0,
    )
    assert page.run(
        "return document.querySelector('.program .text').shadowRoot.querySelector('.cm-running')?.textContent"
    ).startswith("P0010")
    page.api.order("stop")
    until(page.rests, 10.0)


def test_the_policy_holds(page):
    """The browser has refused no style, script or connection of the page."""
    said = [one["message"] for one in page.browser.get_log("browser")]
    assert [
        one for one in said if "Content Security Policy" in one or "Refused" in one or "Uncaught" in one
    ] == []
    asked = [json.loads(one["message"])["message"] for one in page.browser.get_log("performance")]
    assert not [one for one in asked if one["method"] == "Audits.issueAdded"]
    assert Path(page.folder, "bend.yarc").exists()
