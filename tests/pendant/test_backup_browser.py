"""Browser tests of the pages Backup and Health: restore of a backup after the PIN, undo of the restore, and
upload of a file that isn't a backup.
"""

import pytest
from pendant.process import PIN, PROGRAM, serving
from pendant.test_browser import SIZES, Place, click, goes_to, shown, size, until
from view.browser import browser_or_skip, opened_browser


@pytest.fixture
def place(tmp_path):
    """Fixture: a pendant with a project, and a browser in which anna is logged in."""
    browser_or_skip()
    project = tmp_path / "project"
    project.mkdir()
    (project / "bend.yarc").write_text(PROGRAM)
    (project / "<b>.yarc").write_text(PROGRAM)
    (project / "yarc.toml").write_text("")
    with serving(project) as (url, token, process), opened_browser(tmp_path / "profile") as browser:
        yield Place(url, token, process, browser), project


def fits(browser):
    """Return True if the page isn't wider than the window."""
    return browser.execute_script("const p = document.getElementById('page'); return p.scrollWidth <= p.clientWidth")  # fmt: skip  # noqa: E501


def test_a_backup_is_restored_and_undone(place, tmp_path):
    pendant, project = place
    browser, api = pendant.browser, pendant.api
    goes_to(browser, "system/backup")
    until(lambda: "3 files of INDUSTRIAL6" in shown(browser, ".backup-page"))
    with api._opener.open(f"{api.url}/api/backup", timeout=60) as answer:
        (tmp_path / "saved.zip").write_bytes(answer.read())
    (project / "bend.yarc").write_text("other")
    (project / "new.yarc").write_text("new")
    (project / "<b>.yarc").unlink()
    chosen = browser.find_element("css selector", "input[type=file]")
    chosen.send_keys(str(tmp_path / "saved.zip"))
    until(lambda: "1 new, 1 changed, 1 unchanged, 1 not in the backup" in shown(browser, ".plan"))
    for one in SIZES:
        size(browser, *one)
        assert fits(browser)
    click(browser, ".plan .switch input")
    click(browser, ".plan button.main")
    enters_pin(browser)
    until(lambda: shown(browser, ".restored").startswith("Restored: 2 files; deleted: 1"))
    assert {one.name: one.read_text() for one in project.glob("*.yarc")} == {"bend.yarc": PROGRAM,
        "<b>.yarc": PROGRAM}  # fmt: skip
    click(browser, ".undo button")
    until(lambda: "Changes by undoing" in shown(browser, ".plan"))
    click(browser, ".plan button.main")
    until(lambda: shown(browser, ".restored").startswith("Restored: 2 files; deleted: 1"))
    assert {one.name: one.read_text() for one in project.glob("*.yarc")} == {"bend.yarc": "other",
        "new.yarc": "new"}  # fmt: skip
    (tmp_path / "none.zip").write_bytes(b"PK")
    browser.find_element("css selector", "input[type=file]").send_keys(str(tmp_path / "none.zip"))
    until(lambda: "This backup is refused: it isn't a zip" in shown(browser, ".refused"))
    goes_to(browser, "system/health")
    until(lambda: "free" in shown(browser, ".health-groups"))
    assert shown(browser, ".versions").startswith("yarclang")
    assert fits(browser)


def enters_pin(browser):
    until(lambda: shown(browser, "dialog h2") == "Your PIN, please")
    browser.execute_script("document.querySelector('dialog input').value = arguments[0]", PIN)
    click(browser, "dialog button.main")
