"""Tests of workers of a dask scheduler that can't read the project's disk: their results are the same to the
byte, even if workers end.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

pytest.importorskip("distributed", reason="it needs yarclang[fleet]")

from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc
from yarclang.fleet.installation import this_installation
from yarclang.fleet.outcome import UnreachableError
from yarclang.fleet.scheduler import Scheduler


def started(folder, *arguments):
    folder.mkdir(exist_ok=True)
    with (folder / "log").open("wb") as log:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path.cwd()), *sys.path[1:]])}
        return subprocess.Popen(
            [sys.executable, "-m",
                "distributed.cli.dask_scheduler" if arguments[0] == "scheduler" else "distributed.cli.dask_worker", *arguments[1:]],  # noqa: E501
            cwd=folder, stdout=log, stderr=log, env=environment, start_new_session=True,
        )  # fmt: skip


def waited(condition, seconds=60.0):
    until = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < until, "it never came"
        time.sleep(0.05)
    return found


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dask")
    scheduler = started(folder / "s", "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    match = waited(lambda: re.search(r"Scheduler at:\s+(tcp://\S+)", (folder / "s" / "log").read_text()))
    options = ("worker", match[1], "--nthreads", "1", "--no-dashboard", "--no-nanny")
    processes = [scheduler, *(started(folder / name, *options) for name in ("w1", "w2"))]
    waited(lambda: (folder / "s" / "log").read_text().count("Register worker") >= 2)
    yield match[1]
    for process in processes:
        process.kill()
        process.wait()


@pytest.fixture
def project(tmp_path, monkeypatch):
    """Return a folder of programs with modules, cells, tables and a robot of the project's own."""
    folder = tmp_path / "project"
    shutil.copytree("examples", folder)
    shutil.copytree("stdlib/robots/industrial6", folder / "ours")
    (folder / "yarc.toml").write_text('robot = "ours"\n')
    for name in ("05_pick_and_place", "13_vacuum_cell", "26_rows_by_camera"):
        (folder / "line").mkdir(exist_ok=True)
        for path in folder.glob(f"{name}.*"):
            path.rename(folder / "line" / path.name)
    monkeypatch.chdir(folder)
    return folder


def text_files(folder):
    return {
        path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
    }


def test_texts_tables_and_findings_are_the_same_bytes(address, project):
    here = CliRunner().invoke(yarcc, [".", "--out-dir", "here", "--jobs", "1"])
    there = CliRunner().invoke(yarcc, [".", "--out-dir", "there", "--scheduler", address])
    assert len(text_files(project / "here")) > 10, here.output[-2000:]
    assert text_files(project / "here") == text_files(project / "there")
    assert there.stdout == here.stdout.replace("here/", "there/")
    assert there.stderr == here.stderr.replace("here/", "there/")
    assert there.exit_code == here.exit_code


def test_checks_and_forms_are_the_same(address, project):
    (project / "line" / "wrong.yarc").write_text("P0010 MOVEJ 999 0 0 0 0 0 [1] (deg,s)\nP0010 MOVES\n")
    for arguments in (["check", "line", "--format", "json"], ["fmt", "--check", "."]):
        here, there = (
            CliRunner().invoke(yarc, [*arguments, *more])
            for more in (["--jobs", "1"], ["--scheduler", address])
        )
        assert here.exit_code == 1, here.output
        assert (there.exit_code, there.stdout, there.stderr) == (here.exit_code, here.stdout, here.stderr)


def slow(item, marks=None):
    if marks is not None:
        Path(marks, f"{os.getpid()}-{item}").touch()
    time.sleep(0.2)
    return item * item


def deadly(item):
    if item == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def no_files(_):
    return ()


def test_a_worker_that_is_killed_costs_its_chunk_only(address, tmp_path):
    worker = started(tmp_path / "w3", "worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
    waited(lambda: "Starting established connection" in (tmp_path / "w3" / "log").read_text())
    from functools import partial

    marks = tmp_path / "marks"
    marks.mkdir()
    scheduler = Scheduler(partial(slow, marks=str(marks)), address, no_files)
    found = []
    try:
        for one in scheduler.results(range(60)):
            found.append(one)
            if worker.poll() is None and any(
                mark.name.startswith(f"{worker.pid}-") for mark in marks.iterdir()
            ):
                worker.kill()
                worker.wait()
    finally:
        scheduler.end()
    assert worker.poll() is not None
    assert found == [one * one for one in range(60)]
    assert len(list(marks.iterdir())) < 100


def test_no_scheduler_is_said(project):
    result = CliRunner().invoke(yarc, ["check", ".", "--scheduler", "tcp://127.0.0.1:9"])
    assert result.exit_code == 1
    assert "no scheduler answers at tcp://127.0.0.1:9" in result.output


def test_workers_with_another_installation_are_refused(address, monkeypatch):
    from yarclang.fleet import scheduler

    ours = this_installation()
    monkeypatch.setattr(scheduler, "this_installation", lambda: ours._replace(content="other"))
    with pytest.raises(UnreachableError, match="would give other results"):
        Scheduler(slow, address, no_files)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"version": "9"}, "yarclang 9"),
        ({"python": "Python 2 on z80"}, "Python 2 on z80"),
        ({"others": ("numpy-0.1",)}, "but this computer has"),
        ({"content": "x"}, "files"),
        ({}, ""),
    ],
)
def test_differences_in_words(change, words):
    ours = this_installation()
    difference = ours.difference(ours._replace(**change))
    assert words in difference
    assert bool(difference) == bool(change)


def test_pictures_are_the_same(address, tmp_path, monkeypatch):
    folder = tmp_path / "project"
    folder.mkdir()
    shutil.copytree("stdlib/robots/industrial6", tmp_path / "ours")
    for name in ("02_lines_and_deltas", "08_machine_tending"):
        for path in Path("examples").glob(f"{name}.*"):
            shutil.copy(path, folder)
    monkeypatch.chdir(tmp_path)
    for where, arguments in (("here", ["-j", "1"]), ("there", ["--scheduler", address])):
        made = CliRunner().invoke(
            yarc, ["plot", "project", "--out-dir", where, *arguments, "--robot", "ours"]
        )
        assert made.exit_code == 0, made.output
        made = CliRunner().invoke(
            yarc, ["reach", "TRACKED_MANIPULATOR", "ours", "--out-dir", where, *arguments]
        )
        assert made.exit_code == 0, made.output
    assert len(text_files(tmp_path / "here")) == 4
    assert text_files(tmp_path / "here") == text_files(tmp_path / "there")


def test_a_campaign_is_the_same_although_a_worker_is_killed(address, tmp_path, monkeypatch):
    monkeypatch.setattr("yarclang.cli.commands.campaign._CHUNK", 2)
    shutil.copytree("stdlib/robots/industrial6", tmp_path / "ours")
    monkeypatch.chdir(tmp_path)
    arguments = [
        "campaign",
        "--format",
        "json",
        "--robot",
        "ours",
        "--robot",
        "TRACKED_MANIPULATOR",
        "--programs",
        "20",
    ]
    options = ("worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
    third = started(tmp_path / "w3", *options)
    try:
        waited(lambda: "Registered to" in (tmp_path / "w3" / "log").read_text())
        state = tmp_path / "state"

        def kill():
            waited(lambda: state.exists() and state.read_bytes().count(b"\n") >= 2)
            third.kill()

        killer = threading.Thread(target=kill)
        killer.start()
        there = CliRunner().invoke(yarc, [*arguments, "--scheduler", address, "--state", str(state)])
        killer.join()
    finally:
        third.kill()
        third.wait()
    here = CliRunner().invoke(yarc, [*arguments, "-j", "1"])
    found = []
    for made in (here, there):
        assert made.exit_code in (0, 1), made.output
        found.append(json.loads(made.stdout))
        del found[-1]["processor_seconds"]
    assert found[0] == found[1]
    assert found[0]["programs"] == 20
