"""Complete the documentation site: pages of the top folder, pages made from the code, files that pages link
to.

MkDocs calls the functions `on_...`. A link that leads out of `docs/` is wrong in a site: README.md becomes
the first page, other Markdown files become pages of their path, and sources become pages that show them in
colour.
"""

import posixpath
import re
import sys
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).parent))

from cli_reference import cli_page
from toml_reference import cell_page, robot_page

ROOT = Path(__file__).resolve().parents[2]
MADE = {
    "reference/cli.md": cli_page,
    "reference/robot-toml.md": robot_page,
    "reference/cell-toml.md": cell_page,
}
"""Pages that are made from the code."""
LANGUAGES = {"": "text", ".yarc": "yarc", ".toml": "toml", ".py": "python", ".yaml": "yaml", ".cff": "yaml"}
"""Languages of the sources that pages may link to."""
_LINK = re.compile(r"(?<!!)(\]\()([^)\s#:]+)((?:#[^)\s]*)?\))")
_PICTURE = re.compile(r"(!\[[^\]]*\]\()([^)\s#:]+)(\))")
_ITEM = re.compile(r" *(?:[-*]|\d+\.) +")
_INFO = re.compile(r"^```(\w+) .*$", re.MULTILINE)
"""A fence with words after the language, which are for the tests."""
_CELL_CODE = re.compile(r"(?<=[ |(])`[^`\n]*\\\|[^`\n]*`")
"""Code with a bar that GitHub wants escaped in a table, and Python-Markdown shows as it stands."""
_FENCED = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that aren't in `docs/`."""
    for uri, make in MADE.items():
        files.append(File.generated(config, uri, content=make()))
    ahead = [
        ROOT / "README.md",
        ROOT / "ARCHITECTURE.md",
        ROOT / "CONTRIBUTING.md",
        ROOT / "CHANGELOG.md",
        ROOT / "SECURITY.md",
    ]
    ahead += [path for path in (ROOT / "docs").rglob("*.md") if path.parent != Path(__file__).parent]
    seen = set()
    while ahead:
        path = ahead.pop()
        if path in seen:
            continue
        seen.add(path)
        text = path.read_text(encoding="utf-8")
        if not path.is_relative_to(ROOT / "docs"):
            files.append(File.generated(config, uri_of(path), content=shown(path, text)))
        if path.suffix == ".md":
            ahead += [target for target in linked(path, text) if not target.is_relative_to(ROOT / "docs")]
    return files


def linked(path: Path, text: str) -> list[Path]:
    """Return the files that a page links to and that can be shown."""
    targets = ((path.parent / link).resolve() for _, link, _ in _LINK.findall(_FENCED.sub("", text)))
    return [each for each in targets if each.is_file() and (each.suffix == ".md" or each.suffix in LANGUAGES)]


def uri_of(path: Path) -> str:
    """Return the place of a file in the site."""
    if path.is_relative_to(ROOT / "docs"):
        return path.relative_to(ROOT / "docs").as_posix()
    uri = path.relative_to(ROOT).as_posix()
    if uri == "README.md":
        return "index.md"
    return uri if path.suffix == ".md" else f"sources/{uri}.md"


def shown(path: Path, text: str) -> str:
    """Return the page that shows a file of the top folder."""
    if path.suffix == ".md":
        return text
    return (
        "---\n"
        "search:\n"
        "  exclude: true\n"
        "---\n"
        f"# {path.name}\n"
        "\n"
        f"```{LANGUAGES.get(path.suffix, 'text')}\n"
        f"{text.rstrip()}\n"
        "```\n"
    )


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001  (MkDocs' signature)
    """Convert links between files to links between pages."""
    here = page.file.src_uri
    source = ROOT / "README.md" if here == "index.md" else ROOT / "docs" / here
    if not source.exists():
        source = ROOT / here

    def there(link: re.Match[str]) -> str:
        target = (source.parent / link[2]).resolve()
        if not target.is_file() or not target.is_relative_to(ROOT):
            return link[0]
        return link[1] + posixpath.relpath(uri_of(target), posixpath.dirname(here) or ".") + link[3]

    return "".join(
        _INFO.sub(r"```\1", part)
        if part.startswith("```")
        else _CELL_CODE.sub(
            lambda row: row[0].replace("\\|", "|"), indented(_PICTURE.sub(there, _LINK.sub(there, part)))
        )
        for part in _FENCED.split(markdown)
    )


def indented(text: str) -> str:
    """Return Markdown whose lists are indented by four spaces a level, which Python-Markdown needs.
    (GitHub requires only the width of the marker.)
    """
    lines = []
    columns: list[int] = []
    for line in text.split("\n"):
        width = len(line) - len(line.lstrip(" "))
        if not line.strip():
            lines.append(line)
            continue
        while columns and width < columns[-1]:
            columns.pop()
        item = _ITEM.match(line)
        body = line[columns[-1] :] if columns else line
        lines.append("    " * len(columns) + _INFO.sub(r"```\1", body))
        if item:
            columns.append(len(item[0]))
    return "\n".join(lines)
