"""Rules of the house that import-linter doesn't hold: names of folders and modules, clocks, threads, sockets, start-up."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "yarclang"
DOORS = ("cli", "lsp", "repl")
"""Folders of the package that talk to the world."""
SOCKETS = {
    "coordinator/client.py",
    "coordinator/coordinator.py",
    "coordinator/engine.py",
    "coordinator/live/drive.py",
    "coordinator/live/serving.py",
    "coordinator/subscription.py",
    "runtime/log.py",
    "runtime/session.py",
    "runtime/transports/local.py",
    "runtime/transports/lock.py",
    "runtime/transports/private.py",
    "runtime/transports/tcp.py",
    "simulator/embedded.py",
    "simulator/server.py",
    "view/show.py",
}
"""Modules that do so in the other folders: the protocols themselves know neither socket nor clock."""
DRAWERS = {"common", "helper", "helpers", "manager", "managers", "misc", "util", "utils"}
WORLD = {
    "asyncio",
    "datetime",
    "multiprocessing",
    "random",
    "select",
    "selectors",
    "socket",
    "threading",
    "time",
}
"""Modules that make a result depend on more than its arguments, or talk past the doors."""
HEAVY = {"lark", "matplotlib", "numpy", "pinocchio", "pydantic", "rich", "scipy", "viser"}
"""Libraries that are imported where they are first used, so that `--help` is quick."""


def modules(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


def worldly(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and name of each import of WORLD and each call of print and input."""
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
    """A module is named after what it knows."""
    paths = [*modules("yarclang", "tests", "benchmarks")]
    drawers = [
        str(path.relative_to(ROOT))
        for path in paths
        if DRAWERS & {*path.relative_to(ROOT).parts[:-1], path.stem}
    ]
    assert drawers == []


def test_only_doors_talk_to_the_world():
    """The same input gives the same bytes: no clock, thread, socket or print below the doors and SOCKETS."""
    found = [
        f"{path.relative_to(ROOT)}:{line}: {name}"
        for path in modules("yarclang")
        if path.relative_to(PACKAGE).parts[0] not in DOORS
        and path.relative_to(PACKAGE).as_posix() not in SOCKETS
        for line, name in worldly(ast.parse(path.read_bytes()))
    ]
    assert found == []


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


@pytest.mark.parametrize("door", ["yarclang", "yarclang.cli.yarcc", "yarclang.cli.yarc"])
def test_a_door_opens_without_heavy_libraries(door: str):
    code = f"import sys, {door}; print(*sorted({HEAVY!r} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == []
