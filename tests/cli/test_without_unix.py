"""Without Unix modules, programs can still be checked, compiled and drawn.

Commands that need a robot say that they can't work.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from yarclang.cli.yarc import main as yarc

ROOT = Path(__file__).resolve().parents[2]
HIDING = Path(__file__).with_name("without_unix.py")
PROGRAM = (
    "ROBOT INDUSTRIAL6\n"
    "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
    "P0010 MOVEJ 0 -10 -20 0 -60 0\n"
    "P0020 DMOVE 100 0 0 0 0 0\n"
)


@pytest.fixture
def folder(tmp_path):
    for at in range(9):  # from eight on, files are checked by several processes
        (tmp_path / f"p{at}.yarc").write_text(PROGRAM, encoding="utf-8")
    return tmp_path


def hidden(folder, *words):
    return subprocess.run(
        [sys.executable, str(HIDING), *words],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=300.0,
    )


@pytest.mark.parametrize(
    ("command", "made"),
    [
        ("yarc check p0.yarc", None),
        ("yarc check .", None),
        ("yarc fmt p0.yarc", None),
        ("yarcc p0.yarc", "p0.pmc"),
        ("yarc plot p0.yarc -o p0.png", "p0.png"),
        ("yarc inspect p0.yarc P0010", None),
        ("yarc explain Y0601", None),
        ("yarc doc PALLET", None),
        ("yarc settings INDUSTRIAL6", None),
        ("yarc new cell --robot INDUSTRIAL6", "cell/yarc.toml"),
        ("yarc robot new arm.urdf --yes -o arm", "arm/robot.toml"),
        ("yarc lsp --help", None),
        ("yarc view --help", None),
    ],
)
def test_work_on_programs(folder, command, made):
    (folder / "arm.urdf").write_text(
        (ROOT / "examples" / "scara.urdf").read_text(encoding="utf-8"), encoding="utf-8"
    )
    done = hidden(folder, *command.split())
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert made is None or (folder / made).stat().st_size > 100


def test_a_mistake_is_found(folder):
    (folder / "p0.yarc").write_text(PROGRAM.replace("DMOVE", "DMOVEL"), encoding="utf-8")
    done = hidden(folder, "yarc", "check", "p0.yarc")
    assert done.returncode == 1
    assert "Y0202" in done.stdout + done.stderr


def test_imports(folder):
    modules = [
        "yarclang",
        "yarclang.lsp.server",
        "yarclang.view.server",
        "yarclang.view.of_program",
        "yarclang.report",
    ]
    done = hidden(folder, "imports", *modules)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == modules


def test_what_is_hidden_is_hidden(folder):
    done = hidden(folder, "imports", "pwd")
    assert done.returncode == 1
    assert "it is hidden" in done.stderr


@pytest.mark.parametrize("command", yarc.on_unix)
def test_work_with_a_robot_says_that_it_cannot(folder, command):
    done = hidden(folder, "yarc", command)
    assert done.returncode == 1
    assert "needs Unix sockets and locks" in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.splitlines()) <= 3
