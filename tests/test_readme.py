"""Tests of README.md and the pages of its tour: their programs are written to files, their commands are run,
and the output is compared.

`pytest tests/test_readme.py --rewrite-golden` writes the present output into them.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    "README.md",
    "docs/arms.md",
    "docs/controller.md",
    "docs/export.md",
    "docs/import.md",
    "docs/inspect.md",
    "docs/runtime.md",
    "docs/tour.md",
]
"""Pages whose ```console blocks are run here. Other tests run those of certificate, coordinator and repl."""
LINKED = [*PAGES, "docs/certificate.md", "docs/simulator.md", "docs/status.md"]
LONGEST = 150
"""Most lines of README.md."""
_PROGRAM = re.compile(r"^```yarc\n(! (\S+)\n.*?)^```$", re.DOTALL | re.MULTILINE)
_SESSION = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
_SERVED = re.compile(r"^```sh\n(yarc .*)\n```$", re.MULTILINE)
_ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+")
_LINK = re.compile(r"\]\(([^)#:]*)(?:#([^)]+))?\)")


def run(command: str, folder: Path) -> str:
    """Run a command, and return its standard output and standard error as a person sees them."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    shown = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        env={**os.environ, "PATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return shown.stdout


def programs() -> dict[str, str]:
    """Return the programs that the pages show, by file name."""
    shown: dict[str, str] = {}
    for page in PAGES:
        for program, name in _PROGRAM.findall((ROOT / page).read_text(encoding="utf-8")):
            assert shown.setdefault(name, program) == program, f"{page} has another {name}"
    return shown


@pytest.mark.parametrize("page", PAGES)
def test_sessions(tmp_path, rewrite_golden, page):
    path = ROOT / page
    text = path.read_text(encoding="utf-8")
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    for name, program in programs().items():
        (tmp_path / name).write_text(program, encoding="utf-8")
    ran = []

    def today(session: re.Match[str]) -> str:
        commands = [line[2:] for line in session[1].splitlines() if line.startswith("$ ")]
        ran.extend(commands)
        return (
            "```console\n" + "".join(f"$ {command}\n{run(command, tmp_path)}" for command in commands) + "```"
        )

    now = _SESSION.sub(today, text)
    assert ran, f"{page} shows no command"
    if rewrite_golden:
        path.write_text(now, encoding="utf-8")
    assert path.read_text(encoding="utf-8").splitlines() == now.splitlines()


@pytest.mark.parametrize(
    ("word", "more"), [("view", "--no-browser --port 0"), ("pendant", "--data users --port 0")]
)
def test_what_readme_serves(tmp_path, word, more):
    """The pages that README starts in a browser are served until Ctrl-C."""
    (command,) = (
        each
        for each in _SERVED.findall((ROOT / "README.md").read_text(encoding="utf-8"))
        if each.split()[1] == word
    )
    (tmp_path / "first.yarc").write_text(programs()["first.yarc"], encoding="utf-8")
    (tmp_path / "run").mkdir(mode=0o700)
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    with subprocess.Popen(
        ["bash", "-c", f"yarc check --fix first.yarc && exec {command} {more}"],
        cwd=tmp_path,
        env={**os.environ, "PATH": path, "XDG_RUNTIME_DIR": str(tmp_path / "run")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as served:
        said = ""
        while not _ADDRESS.search(said) and (line := served.stdout.readline()):
            said += line
        os.killpg(served.pid, signal.SIGINT)
        said += served.communicate(timeout=60.0)[0]
    assert _ADDRESS.search(said), said
    assert "error" not in said
    assert served.returncode == 0, said


def slug(heading: str) -> str:
    """Return the anchor that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


@pytest.mark.parametrize("page", LINKED)
def test_links_lead_somewhere(page):
    path = ROOT / page
    missing = []
    for link, anchor in _LINK.findall(_code_removed(path)):
        target = path.parent / link if link else path
        if not target.exists() or (anchor and anchor not in anchors(target)):
            missing.append(f"{link}#{anchor}" if anchor else link)
    assert missing == []


def _code_removed(path: Path) -> str:
    return re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)


def anchors(path: Path) -> set[str]:
    """Return the anchors of a page's headings."""
    return {slug(heading) for heading in re.findall(r"^#+ (.+)$", _code_removed(path), re.MULTILINE)}


def test_readme_is_short():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= LONGEST


def test_readme_leads_to_every_page():
    """Each page can be reached by links from README."""
    reached, ahead = set(), [ROOT / "README.md"]
    while ahead:
        page = ahead.pop()
        for link, _ in _LINK.findall(_code_removed(page)):
            target = (page.parent / link).resolve()
            if target.suffix == ".md" and target.exists() and target not in reached:
                reached.add(target)
                ahead.append(target)
    unreached = {each.name for each in (ROOT / "docs").glob("*.md")} - {each.name for each in reached}
    assert unreached == set()
