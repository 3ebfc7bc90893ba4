"""`yarc view --live`: it watches a served robot, sets its inputs, and finds the robot again."""

import asyncio
import contextlib
import os
import signal
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main
from yarclang.view import live
from yarclang.view.door import Door
from yarclang.view.reaching import Whose

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
START = "40,-15,-25,0,-50,0"
"""Joint positions where the example starts [deg]."""


@pytest.fixture
def home(workshop, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])


def serve(workshop):
    process = workshop.start("serve", "--robot", "INDUSTRIAL6", "--no-log", "--start", START)
    process.wait_for("is served: ")
    return process


async def until(condition, within=60.0):
    loop = asyncio.get_running_loop()
    since = loop.time()
    while not condition():
        assert loop.time() - since < within, "it never came"
        await asyncio.sleep(0.05)


@contextlib.asynccontextmanager
async def watching(monkeypatch):
    """Yield the page of a live view as soon as it is drawn."""
    pages = []

    class Seen(live.LivePage):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            pages.append(self)

    monkeypatch.setattr(live, "LivePage", Seen)
    task = asyncio.create_task(live._show(Whose(), Door("127.0.0.1", 0), lambda *_: None))
    try:
        await until(lambda: task.done() or (pages and pages[0]._drawn is not None))
        if task.done():
            task.result()
        yield pages[0]
    finally:
        task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await task


def test_a_program_goes_on_by_an_input_that_is_set_in_the_panel(workshop, home, monkeypatch):
    """The page shows the program's cell and inputs, which the server didn't know before."""
    for name in ("12_machine_cell.yarc", "12_machine_cell.toml"):
        workshop.write(name, (EXAMPLES / name).read_text())
    serve(workshop)

    async def watched():
        async with watching(monkeypatch) as page:
            assert page._place.cell is None
            running = workshop.start("exec", "12_machine_cell.yarc")
            await until(lambda: "waits for DOOR_OPEN to be ON" in page._panel._now._shown)
            assert "MACHINE_BED" in page._picture._bodies
            assert "ON (M1)" in page._panel._outputs._shown
            stood = page._drawn
            ticked = SimpleNamespace(client_id=1, target=SimpleNamespace(value=True))
            page._panel._ticked("DOOR_OPEN", ticked)
            await until(lambda: page._panel._boxes["DOOR_OPEN"].value)
            await until(lambda: np.abs(page._drawn - stood).max() > 0.2)
            await until(lambda: "at the end of 12_machine_cell.yarc" in page._panel._now._shown)
            await asyncio.to_thread(running.end, 0)

    asyncio.run(watched())


def test_a_server_that_is_killed_and_started_again(workshop, home, monkeypatch):
    process = serve(workshop)

    async def watched():
        async with watching(monkeypatch) as page:
            os.kill(process.pid, signal.SIGKILL)
            await until(lambda: "industrial6 isn't served again yet" in page._lost)
            again = await asyncio.to_thread(serve, workshop)
            await until(lambda: not page._lost)
            assert str(again.pid) in page._stage.subtitle
            again.signal(signal.SIGSTOP)
            await until(lambda: "no message was received for" in page._lost)
            again.signal(signal.SIGCONT)
            await until(lambda: not page._lost)

    asyncio.run(watched())


def test_nobody_is_there(home):
    result = CliRunner().invoke(main, ["view", "--live", "--no-browser", "--to", "tcp://127.0.0.1:3"])
    assert result.exit_code == 1
    assert "no process of this user on this computer drives 127.0.0.1:3" in result.output
    assert "yarc serve --robot NAME --to tcp://127.0.0.1:3" in result.output
    result = CliRunner().invoke(main, ["view", "--live", "--no-browser"])
    assert (result.exit_code, "no robot runs on this computer" in result.output) == (1, True)
    result = CliRunner().invoke(main, ["view", "--live", "--no-browser", "--run", "x"])
    assert result.exit_code == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ["--live", "a.yarc"],
        ["--live", "--tm", "5"],
        ["--live", "--cell", "c.toml"],
        ["--live", "--robot", "INDUSTRIAL6"],
        ["--live", "--run", "a", "--to", "tcp://h"],
        ["--live", "--to", "sim"],
        ["a.yarc", "--run", "a"],
        ["a.yarc", "--to", "tcp://h"],
        ["--live", "--port", "65536"],
        ["--live", "--host", " "],
    ],
)
def test_wrong_usage(arguments):
    result = CliRunner().invoke(main, ["view", "--no-browser", *arguments])
    assert result.exit_code == 2
    assert "Traceback" not in result.output
