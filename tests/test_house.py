"""Tests of the house rules that import-linter can't check: names of folders and modules, clocks, threads,
sockets, start-up, circular imports, and files that are named in texts.
"""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "yarclang"
DOORS = ("cli", "lsp", "repl")
"""Folders whose modules may use clocks, threads, sockets and the terminal."""
SOCKETS = {
    "campaign/judging.py": {"time"},
    "campaign/state.py": {"fcntl"},
    "client.py": {"socket", "tempfile", "threading", "time"},
    "coordinator/attached.py": {"asyncio"},
    "coordinator/coordinator.py": {"asyncio"},
    "coordinator/engine.py": {"asyncio"},
    "coordinator/held.py": {"asyncio"},
    "coordinator/live/serving.py": {"asyncio", "secrets"},
    "coordinator/opened.py": {"secrets"},
    "coordinator/serving.py": {"asyncio"},
    "coordinator/shared.py": {"asyncio", "datetime"},
    "coordinator/subscription.py": {"asyncio"},
    "coordinator/values_door.py": {"asyncio"},
    "files.py": {"tempfile"},
    "pendant/accounts/accounts.py": {"asyncio", "secrets", "time"},
    "pendant/accounts/database.py": {"asyncio", "concurrent"},
    "pendant/accounts/people.py": {"datetime"},
    "pendant/accounts/sessions.py": {"secrets"},
    "pendant/alarms/alarms.py": {"asyncio", "time"},
    "pendant/alarms/export.py": {"datetime"},
    "pendant/analyst.py": {"asyncio"},
    "pendant/calibrating/writing.py": {"asyncio"},
    "pendant/apart.py": {"asyncio"},
    "pendant/backup/backups.py": {"asyncio", "datetime", "secrets", "tempfile"},
    "pendant/backup/manifest.py": {"time"},
    "pendant/backup/reading.py": {"time"},
    "pendant/backup/writing.py": {"datetime"},
    "pendant/certificates.py": {"datetime", "socket"},
    "pendant/filing.py": {"asyncio"},
    "pendant/gate.py": {"asyncio"},
    "pendant/going.py": {"asyncio"},
    "pendant/health/measuring.py": {"time"},
    "pendant/health/sampling.py": {"asyncio", "datetime"},
    "pendant/jogging.py": {"asyncio"},
    "pendant/life.py": {"asyncio"},
    "pendant/project/asking_git.py": {"signal", "subprocess", "threading"},
    "pendant/project/draft.py": {"secrets"},
    "pendant/project/folder.py": {"threading"},
    "pendant/project/git.py": {"datetime"},
    "pendant/project/trash.py": {"secrets", "time"},
    "pendant/project/tree.py": {"datetime", "time"},
    "pendant/runs/listing.py": {"time"},
    "pendant/runs/reading.py": {"asyncio"},
    "pendant/scene/programs.py": {"asyncio"},
    "pendant/scene/scenery.py": {"asyncio"},
    "pendant/seats.py": {"asyncio"},
    "pendant/serving.py": {"asyncio", "socket", "ssl"},
    "pendant/signals.py": {"asyncio"},
    "pendant/watched.py": {"asyncio"},
    "pendant/workspace/checks.py": {"asyncio"},
    "pendant/workspace/workspace.py": {"asyncio"},
    "pendant/web/alarms.py": {"asyncio"},
    "pendant/web/connection.py": {"asyncio"},
    "pendant/web/controller.py": {"asyncio"},
    "pendant/web/backup.py": {"asyncio"},
    "pendant/web/files.py": {"asyncio"},
    "pendant/web/guard.py": {"asyncio"},
    "pendant/web/health.py": {"asyncio"},
    "pendant/web/people.py": {"time"},
    "pendant/web/program.py": {"asyncio"},
    "pendant/web/robot.py": {"asyncio"},
    "pendant/web/runs.py": {"asyncio"},
    "pendant/web/scene.py": {"asyncio"},
    "pendant/web/service.py": {"time"},
    "pendant/web/sockets.py": {"asyncio"},
    "pendant/web/tools.py": {"asyncio"},
    "parallel.py": {"multiprocessing", "signal"},
    "ros/carrying.py": {"asyncio"},
    "ros/node/description.py": {"time"},
    "ros/node/driver.py": {"threading", "time"},
    "ros/node/master.py": {"http"},
    "ros/node/ros1.py": {"signal", "threading"},
    "ros/node/ros1_shell.py": {"queue", "threading", "time"},
    "ros/node/ros2.py": {"signal", "threading"},
    "ros/node/ros2_shell.py": {"concurrent", "threading", "time"},
    "ros/serving.py": {"asyncio", "socket"},
    "runtime/log.py": {"datetime", "queue", "threading", "time"},
    "runtime/session.py": {"asyncio", "time"},
    "runtime/transports/lock.py": {"datetime", "selectors", "socket", "threading", "time"},
    "runtime/transports/private.py": {"socket", "tempfile"},
    "runtime/transports/promptness.py": {"threading"},
    "runtime/transports/tcp.py": {"asyncio"},
    "consulted.py": {"tempfile"},
    "fleet/scheduler.py": {"threading"},
    "fleet/pool.py": {"multiprocessing", "signal"},
    "fleet/store.py": {"time"},
    "signing.py": {"secrets"},
    "simulator/network/embedded.py": {"asyncio", "concurrent", "threading"},
    "simulator/network/server.py": {"asyncio", "socket", "time"},
    "view/door.py": {"socket"},
    "view/live.py": {"asyncio"},
    "view/server.py": {"http"},
    "view/show.py": {"queue", "time"},
}
"""Modules in other folders that may import something of WORLD, and what each may import. The protocols
themselves use neither sockets nor clocks.
"""
DRAWERS = {"common", "helper", "helpers", "manager", "managers", "misc", "util", "utils"}
WORLD = {
    "asyncio",
    "concurrent",
    "datetime",
    "fcntl",
    "http",
    "multiprocessing",
    "queue",
    "random",
    "sched",
    "secrets",
    "select",
    "selectors",
    "signal",
    "socket",
    "socketserver",
    "ssl",
    "subprocess",
    "tempfile",
    "threading",
    "time",
    "uuid",
    "webbrowser",
}
"""Modules by which a result could depend on more than its arguments, or that communicate past the doors."""


def modules(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def worldly(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield line and name of each import of WORLD, and of each call of print or input."""
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                yield from ((node.lineno, name.name) for name in names if name.name.split(".")[0] in WORLD)
            case ast.ImportFrom(module=str(module), level=0) if module.split(".")[0] in WORLD:
                yield node.lineno, module
            case ast.Call(func=ast.Name(id="print" | "input" as name)):
                yield node.lineno, name


def test_there_is_something_to_look_at():
    assert len(modules("yarclang")) > 50


def test_no_drawers():
    """A module is named after what it knows, so that names such as `utils` are refused."""
    paths = [*modules("yarclang", "tests", "benchmarks")]
    drawers = [
        str(path.relative_to(ROOT))
        for path in paths
        if DRAWERS & {*path.relative_to(ROOT).parts[:-1], path.stem}
    ]
    assert drawers == []


def test_only_doors_talk_to_the_world():
    """The same input gives the same bytes: outside the doors, only modules in SOCKETS may use clocks,
    threads, sockets or print.
    """
    found = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in modules("yarclang")
        if path.relative_to(PACKAGE).parts[0] not in DOORS
        for line, name in worldly(ast.parse(path.read_bytes()))
        if name.split(".")[0] not in SOCKETS.get(path.relative_to(PACKAGE).as_posix(), ())
    ]
    assert found == []


@pytest.mark.parametrize(("module", "allowed"), SOCKETS.items())
def test_no_module_is_allowed_more_than_it_needs(module: str, allowed: set[str]):
    needed = {name.split(".")[0] for _, name in worldly(ast.parse((PACKAGE / module).read_bytes()))}
    assert allowed - needed == set()


@pytest.mark.parametrize("door", DOORS)
def test_every_door_talks_to_the_world(door: str):
    assert any(list(worldly(ast.parse(path.read_bytes()))) for path in (PACKAGE / door).rglob("*.py"))


@pytest.mark.parametrize(
    "source",
    [
        "import time",
        "from time import monotonic",
        "import socket as s",
        "def f():\n  import threading",
        "print(1)",
    ],
)
def test_the_rule_sees(source: str):
    assert list(worldly(ast.parse(source)))


@pytest.mark.parametrize(
    "source", ["from yarclang.units import MS", "time = 1", "from . import time", "console.print(1)"]
)
def test_the_rule_spares(source: str):
    assert not list(worldly(ast.parse(source)))


@pytest.mark.parametrize(
    ("door", "libraries"),
    [("yarclang", set()), ("yarclang.cli.yarcc", {"click"}), ("yarclang.cli.yarc", {"click"})],
)
def test_a_door_opens_without_the_libraries_that_take_long(door: str, libraries: set[str]):
    """Slow libraries are imported where they are first used, so that `--help` is quick."""
    code = f"import sys; before = set(sys.modules); import {door}; print(*set(sys.modules) - before)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in run.stdout.split()}
    assert "yarclang" in loaded
    assert loaded - sys.stdlib_module_names - {"yarclang"} == libraries


NAMED = re.compile(r"`([a-z._][\w.-]*(?:/[\w.-]+)*/?)`")
"""A file or folder in backticks. (PMAC commands such as `J/` begin with a capital letter.)"""


def lost(text: str, *rooms: Path) -> list[str]:
    """Return the files and folders that a text names and that don't exist.

    A name is looked for in the repository's top folder, in the package, in `rooms`, and in folders that the
    text has named before.
    """
    places, missing = [ROOT, PACKAGE, *rooms], []
    for name in NAMED.findall(text):
        if name.endswith(("/", ".py", ".lark")):
            found = [place / name for place in places if (place / name).exists()]
            folders = [one if one.is_dir() else one.parent for one in found]
            places += [folder for folder in folders if folder not in places]
            missing += [] if found else [name]
    return missing


def pieces(page: str) -> list[str]:
    """Return the parts of a page in which a name may refer to a folder named before: rows of tables and
    paragraphs, or sections in CONTRIBUTING.md.
    """
    text = (ROOT / page).read_text()
    if page == "CONTRIBUTING.md":
        return text.split("\n## ")
    return [
        piece
        for paragraph in text.split("\n\n")
        for piece in (paragraph.splitlines() if paragraph.startswith("|") else [paragraph])
    ]


@pytest.mark.parametrize("page", ["ARCHITECTURE.md", "CONTRIBUTING.md"])
def test_files_that_are_named_are_there(page: str):
    assert [(name, piece[:60]) for piece in pieces(page) for name in lost(piece)] == []
    assert sum(len(NAMED.findall(piece)) for piece in pieces(page)) > 30


def test_rooms_of_the_package_that_pages_name_are_there():
    rooms = {"yarclang", *(path.name for path in PACKAGE.iterdir() if path.is_dir())}
    named = [
        (page.name, name)
        for page in sorted((ROOT / "docs").glob("*.md"))
        for name in NAMED.findall(page.read_text())
        if name.partition("/")[0] in rooms and name.endswith(("/", ".py"))
    ]
    assert len(named) > 30
    assert [(page, name) for page, name in named if lost(f"`{name}`")] == []


@pytest.mark.parametrize(
    "path", sorted(PACKAGE.rglob("__init__.py")), ids=lambda path: str(path.relative_to(ROOT))
)
def test_what_a_room_says_of_itself_is_there(path: Path):
    assert lost(ast.get_docstring(ast.parse(path.read_text())) or "", path.parent) == []


def test_names_of_files_that_are_gone_are_seen():
    assert lost("| `certify/` | proves (`judge.py`); `certify/read/layout.py`, `numbers.py`, `rooms/` |") == [
        "judge.py",
        "rooms/",
    ]
    assert lost("`J/` closes a loop, `yarclang/units.py` has units, `--to` and `robot.toml` are none") == []


def imports() -> dict[str, set[str]]:
    """Return the modules of the package that each module imports, including imports in functions and for
    types.

    The package's own `__init__` is left out: it imports the pipeline, which imports its version.
    """
    files = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in PACKAGE.rglob("*.py")
    }
    found: dict[str, set[str]] = {}
    for name, path in files.items():
        known = found.setdefault(name, set())
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                named = [f"{node.module}.{one.name}" for one in node.names]
                known.update(one if one in files else node.module for one in named)
            elif isinstance(node, ast.Import):
                known.update(one.name for one in node.names)
        known.intersection_update(files)
    del found[PACKAGE.name]
    return found


def circles(graph: dict[str, set[str]]) -> set[tuple[str, ...]]:
    """Return the largest sets of modules in which each reaches every other one."""
    while ends := {name for name in graph if not graph[name] & graph.keys()}:
        graph = {name: known for name, known in graph.items() if name not in ends}

    def reached(begin: str) -> set[str]:
        seen, waiting = set(), [begin]
        while waiting:
            for one in (graph[waiting.pop()] & graph.keys()) - seen:
                seen.add(one)
                waiting.append(one)
        return seen

    reach = {name: reached(name) for name in graph}
    return {
        tuple(sorted({one for one in reach[name] if name in reach[one]}))
        for name in graph
        if name in reach[name]
    }


def test_modules_do_not_import_in_circles():
    graph = imports()
    assert sum(map(len, graph.values())) > 3000
    assert circles(graph) == set()


def test_circles_are_seen():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}, "e": {"e"}}) == {("a", "b", "c"), ("e",)}
    assert circles({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == set()
