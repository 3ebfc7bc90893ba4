"""Tests of the documentation site: it is built strictly and as a whole, and needs no other site."""

import itertools
import json
import os
import re
import subprocess
import sys
import threading
from contextlib import contextmanager
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from view.browser import browser_or_skip, opened_browser, waited

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "site"
_FENCED = re.compile(r"^( *)```.*?^\1```$", re.DOTALL | re.MULTILINE)
_SEPARATOR = re.compile(r"^ *\|(?: *:?-+:? *\|)+$", re.MULTILINE)
"""The line between a table's head and its rows."""
_ELSEWHERE = re.compile(r"(?:https?:)?//", re.IGNORECASE)
_LOADED = {
    "script": "src",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "audio": "src",
    "video": "src",
    "embed": "src",
    "object": "data",
}


class Seen(HTMLParser):
    """The files that a page loads, its tables, its blocks of code by language, and its other text."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.tables, self.languages, self.text = [], 0, [], []
        self.colours = 0
        self.inline = []
        self.code = 0
        self.blocks, self.within = [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        classes = (given.get("class") or "").split()
        if tag in _LOADED and given.get(_LOADED[tag]):
            self.loads.append(given[_LOADED[tag]])
        if tag == "link" and given.get("rel") not in ("prev", "next", "canonical"):
            self.loads.append(given.get("href", ""))
        if tag == "table":
            self.tables += 1
        if tag == "div" and "highlight" in classes:
            self.languages.append(classes[0].removeprefix("language-"))
        if tag == "span" and self.code and self.languages[-1:] == ["yarc"] and classes not in ([], ["w"]):
            self.colours += 1
        if tag in ("pre", "code"):
            self.code += 1
        if tag == "pre":
            self.blocks.append("")
            self.within = True

    def handle_endtag(self, tag):
        if tag in ("pre", "code"):
            self.code -= 1
        if tag == "pre":
            self.within = False

    def handle_data(self, data):
        if not self.code:
            self.text.append(data)
        elif self.within:
            self.blocks[-1] += data
        else:
            self.inline.append(data)


def build(folder, config=ROOT / "mkdocs.yml"):
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", str(config), "-d", str(folder)],
        cwd=ROOT,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=300.0,
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    built = build(folder)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site):
    found = {
        path.relative_to(site).as_posix(): Seen(path.read_text(encoding="utf-8"))
        for path in site.rglob("*.html")
    }
    assert len(found) > 50
    return found


@contextmanager
def served(folder):
    """Serve the site on a free port, and yield its address."""
    asked = []

    class Handler(SimpleHTTPRequestHandler):
        def __init__(self, *args, **more):
            super().__init__(*args, directory=str(folder), **more)

        def log_message(self, form, *args):
            asked.append(args)

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


def test_a_browser_finds_words_and_asks_nobody_else(site, tmp_path):
    browser_or_skip()
    with served(site) as address, opened_browser(tmp_path / "profile") as browser:
        for page in ("index.html", "runtime.html", "tutorial/pick-and-place.html"):
            browser.get(f"{address}/{page}")
            waited(lambda: browser.execute_script("return document.readyState") == "complete")
            loaded = browser.execute_script(
                "return performance.getEntriesByType('resource').map(each => each.name)"
            )
            assert loaded
            assert [each for each in loaded if not each.startswith((address, "data:", "blob:"))] == []
        browser.execute_script("document.querySelector('[data-md-toggle=search]').checked = true")
        field = browser.find_element("css selector", "input.md-search__input")
        browser.execute_script("arguments[0].focus()", field)
        field.send_keys("PICKPLACE")
        found = "return [...document.querySelectorAll('.md-search-result__link')].map(each => each.href)"
        waited(lambda: browser.execute_script(found))
        assert any("pick-and-place" in each for each in browser.execute_script(found))


@pytest.fixture(scope="module")
def makers():
    sys.path.insert(0, str(FOLDER))
    try:
        import cli_reference
        import hooks
        import toml_reference
    finally:
        sys.path.remove(str(FOLDER))
    return {"cli": cli_reference, "toml": toml_reference, "hooks": hooks}


def test_nothing_loads_from_elsewhere(site, pages):
    assert sum(len(page.loads) for page in pages.values()) > 5 * len(pages)
    outside = {(name, each) for name, page in pages.items() for each in page.loads if _ELSEWHERE.match(each)}
    assert outside == set()
    styles = list(site.rglob("*.css"))
    assert styles
    for style in styles:
        text = style.read_text(encoding="utf-8")
        assert not re.search(r"@import", text), style
        assert not re.search(r"url\(['\"]?(?:https?:)?//", text), style
    # in a page with a diagram, the theme's scripts would load a library from another site
    assert not [name for name in pages if 'mermaid"' in (site / name).read_text(encoding="utf-8")]


def test_what_is_loaded_is_there(site, pages):
    missing = {
        (name, each)
        for name, page in pages.items()
        for each in page.loads
        if not each.startswith(("data:", "/"))
        and not ((site / name).parent / each.split("?")[0].split("#")[0]).exists()
    }
    assert missing == set()


def test_programs_are_coloured(pages):
    shown = {name: page for name, page in pages.items() if "yarc" in page.languages}
    assert len(shown) > 20
    assert [name for name, page in shown.items() if page.colours < 5] == []


def test_every_page_can_be_searched(site, pages):
    index = json.loads((site / "search" / "search_index.json").read_text(encoding="utf-8"))
    found = {entry["location"].split("#")[0] or "index.html" for entry in index["docs"]}
    assert {name for name in pages if not name.startswith("sources/") and name != "404.html"} - found == set()
    assert any("MOVEJ_RPY" in entry["text"] for entry in index["docs"])


@pytest.mark.parametrize(
    "page", sorted(path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md"))
)
def test_tables_and_blocks_arrive_whole(pages, page):
    """A table or block that GitHub understands, but Python-Markdown doesn't, would appear as plain text."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    seen = pages[page.replace(".md", ".html")]
    plain = _FENCED.sub("", text)
    assert seen.tables == len(_SEPARATOR.findall(plain))
    blocks = {squeezed(block) for block in seen.blocks}
    fenced = [
        squeezed("".join(block[0].strip().splitlines(keepends=True)[1:-1]))
        for block in _FENCED.finditer(text)
    ]
    assert [block for block in fenced if block not in blocks] == []
    said = "".join(seen.text)
    assert "```" not in said
    assert "\\|" not in said + "".join(seen.inline)
    assert not re.search(r"^ *\|.*\|$", said, re.MULTILINE)


def squeezed(text):
    return "".join(text.split())


def test_no_table_is_cut_by_an_empty_line():
    for path in (ROOT / "docs").rglob("*.md"):
        lines = path.read_text(encoding="utf-8").splitlines()
        for at, (above, line) in enumerate(itertools.pairwise(lines), start=1):
            if line.startswith("|") and not above.startswith("|"):
                assert _SEPARATOR.fullmatch(lines[at + 1]), f"{path.name}:{at + 1}"


@pytest.mark.parametrize("file", ["robot", "cell"])
def test_every_key_is_described(makers, file):
    toml = makers["toml"]
    document = toml.robot_table(toml.DEFAULT) if file == "robot" else toml.CellTable
    words = toml.WORDS[file]
    assert set(words) == {"page", "file", *document.tables}
    assert set(words["file"]) == set(document.model_fields)
    for key, table in document.tables.items():
        assert set(words[key]) == {"table", *table.model_fields}, key


def test_every_command_and_option_is_in_the_reference(pages, makers):
    import click

    cli = makers["cli"]

    def commands(command, context):
        yield context.command_path, command
        if isinstance(command, click.Group):
            for name in command.list_commands(context):
                inner = command.get_command(context, name)
                yield from commands(inner, click.Context(inner, info_name=name, parent=context))

    page = cli.cli_page()
    shown = pages["reference/cli.html"]
    assert not re.search(r"\\\S", "".join(shown.text + shown.inline))
    asked = 0
    for path, command in [
        *commands(cli.yarc, click.Context(cli.yarc, info_name="yarc")),
        *commands(cli.yarcc, click.Context(cli.yarcc, info_name="yarcc")),
    ]:
        if path == "yarc":
            continue
        part = re.search(rf"^##+ {re.escape(path)}$(.*?)(?=^##|\Z)", page, re.DOTALL | re.MULTILINE)
        assert part, path
        for option in command.params:
            if isinstance(option, click.Option) and not option.hidden:
                asked += 1
                assert option.opts[0] in part[1], (path, option.opts)
    assert asked > 100


def test_the_sheet_has_the_steps():
    steps = re.findall(
        r"^(\d+)\. \*\*(.+?)\.\*\*",
        (ROOT / "docs" / "controller.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    asked = re.findall(
        r"^\| (\d+) (.+?) \|",
        (ROOT / "docs" / "commissioning" / "sheet.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    assert len(steps) == 21
    assert asked == steps


def test_links_lead_to_pages_of_the_site(makers):
    hooks = makers["hooks"]
    assert hooks.uri_of(ROOT / "README.md") == "index.md"
    assert hooks.uri_of(ROOT / "docs" / "view.md") == "view.md"
    assert hooks.uri_of(ROOT / "examples" / "01_listing4.yarc") == "sources/examples/01_listing4.yarc.md"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("- one\n  two\n\n  three", "- one\n    two\n\n    three"),
        ("1. one\n   two\n   - a\n     b\nend", "1. one\n    two\n    - a\n        b\nend"),
        (
            "- one\n\n  ```yarc error Y0101\n  P1\n    P2\n  ```",
            "- one\n\n    ```yarc\n    P1\n      P2\n    ```",
        ),
        ("plain\n\n    code\n", "plain\n\n    code\n"),
        ("- one\n\nplain\n  lazy", "- one\n\nplain\n  lazy"),
    ],
)
def test_lists_are_indented_for_python_markdown(makers, text, expected):
    assert makers["hooks"].indented(text) == expected


def test_a_broken_link_fails_the_build(tmp_path):
    """The strict build fails for a link to a missing page and for a missing anchor."""
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "index.md").write_text("# One\n\n[two](two.md) and [here](#nowhere)\n", encoding="utf-8")
    settings = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    settings = re.sub(r"^nav:.*\Z", "nav: [index.md]\n", settings, flags=re.DOTALL | re.MULTILINE)
    settings = re.sub(r"^(?:hooks|extra_css|exclude_docs|not_in_nav):.*\n", "", settings, flags=re.MULTILINE)
    (tmp_path / "mkdocs.yml").write_text(settings, encoding="utf-8")
    built = build(tmp_path / "out", tmp_path / "mkdocs.yml")
    assert built.returncode == 1
    assert "two.md" in built.stderr
    assert "#nowhere" in built.stderr
