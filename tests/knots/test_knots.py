"""Tests of a second kind of controller, which this folder defines: all code outside the backends works with
it.
"""

import asyncio
import re
import shutil

import numpy as np
import pytest
from click.testing import CliRunner
from knots.simulator import Simulated

from yarclang.cli.yarcc import main
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.loading import Source, load
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.servicing import Servicing
from yarclang.emitted.header import UNSEALED
from yarclang.emitted.seal import sealed
from yarclang.pipeline.controller_text import judge_text
from yarclang.pipeline.inputs import Options
from yarclang.robot.description import load_robot
from yarclang.robot.kinds import plugged
from yarclang.robot.library import stdlib_folder
from yarclang.runtime.actions import Trouble
from yarclang.runtime.scripts import scripts_of
from yarclang.runtime.state import State
from yarclang.source import SourceFile

PROGRAM = """! on another controller
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ 20 0 0 0 -30 0 [1]
P0020 WAIT [0.1]
P0030 DMOVE 0 0 -50 0 0 0 [1.5]
"""
RATE = 5.0


@pytest.fixture(autouse=True)
def kind():
    with plugged("knots", "knots.controller"):
        yield


@pytest.fixture
def folder(tmp_path):
    """Return a folder with INDUSTRIAL6 on the other kind of controller, and a program for it."""
    own = tmp_path / "arm"
    shutil.copytree(stdlib_folder() / "robots" / "industrial6", own)
    text = (own / "robot.toml").read_text()
    begin = text.index("[controller]")
    end = text.index("\n[", begin)
    table = '[controller]\nkind = "knots"\naxes = ["Q1", "Q2", "Q3", "Q4", "Q5", "Q6"]\nlargest_tm = 20\n'
    (own / "robot.toml").write_text(text[:begin].replace("INDUSTRIAL6", "KNOTTED") + table + text[end:])
    (tmp_path / "job.yarc").write_text(PROGRAM)
    return tmp_path


def compiled(folder):
    """Compile the program as yarcc does, and return the text."""
    done = CliRunner().invoke(main, [str(folder / "job.yarc"), "--robot", str(folder / "arm")])
    assert done.exit_code == 0, done.output
    return (folder / "job.knots").read_text()


def judged(folder, text):
    """Judge a text as is done before a run."""
    source = SourceFile(str(folder / "job.knots"), text)
    return judge_text(source, folder, Options(robot=str(folder / "arm")))


def resealed(text):
    """Seal a changed text again, so that the judge has to find the change itself."""
    summary = re.search(r"\n; certificate ([^\n]*)\n", text)[1]
    bare = re.sub(r"\n; certificate [^\n]*\n", f"\n; certificate {UNSEALED}\n", text, count=1)
    return sealed(re.sub(r"\n; sha256 [^\n]*\n", f"\n; sha256 {UNSEALED}\n", bare, count=1), summary)


def test_a_text_that_is_sealed_anew_is_the_same(folder):
    text = compiled(folder)
    assert resealed(text) == text


def test_yarcc_writes_it_and_the_judge_reads_it_back(folder):
    text = compiled(folder)
    assert "; target table" in text
    assert text.endswith("END\n")
    made = judged(folder, text)
    assert made.value is not None, made.diagnostics
    assert made.value.certificate.position < 2e-5
    assert made.value.certificate.duration == pytest.approx(2.6, abs=0.02)


@pytest.mark.parametrize("row", [40, 100, -3])
def test_one_changed_knot_is_refused(folder, row):
    lines = compiled(folder).splitlines()
    numbers = [number for number, line in enumerate(lines) if line[0] in "-0123456789"]
    values = lines[numbers[row]].split(",")
    values[0] = f"{float(values[0]) + 0.5:.6f}"
    lines[numbers[row]] = ",".join(values)
    made = judged(folder, resealed("\n".join(lines) + "\n"))
    assert made.value is None
    assert any(one.is_error for one in made.diagnostics)


@pytest.mark.parametrize(
    ("was", "becomes"),
    [
        ("END\n", ""),
        ("\nT,", "\nU,"),
        ("END\n", "END\nT,5.000000\n"),
        ("\nT,", "\nT,0.5\nT,"),
        ("\nT,", "\nT,0.500000\nT,"),
        ("\n0.0", "\n00.0"),
        (",0.000000,", ",-0.000000,"),
        ("\nD,", "\nD,0"),
    ],
)
def test_what_is_no_table_is_refused(folder, was, becomes):
    text = compiled(folder)
    assert was in text
    made = judged(folder, resealed(text.replace(was, becomes, 1)))
    assert made.value is None


def test_what_it_cannot_do_is_one_error(folder):
    (folder / "job.yarc").write_text("P0010 HOLD\n")
    done = CliRunner().invoke(main, [str(folder / "job.yarc"), "--robot", str(folder / "arm")])
    assert done.exit_code == 1
    assert "Y1104" in done.output
    assert not (folder / "job.knots").exists()


def test_an_output_of_another_kind_is_refused(folder):
    (folder / "job.yarc").write_text("OUTPUT GLUE M1\nP0010 SET GLUE ON\n")
    done = CliRunner().invoke(main, [str(folder / "job.yarc"), "--robot", str(folder / "arm")])
    assert "Y0413" in done.output


def carried_out(folder, during):
    """Run the text on a simulator, with `during(coordinator, client, simulator)` at the same time.

    Return the outcome, the state, and the largest distance of a joint from its end position.
    """
    compiled(folder)
    robot = load_robot(str(folder / "arm")).value
    loaded = load(Source(str(folder / "job.knots"), options=Options(robot=str(folder / "arm"))), robot).value

    async def work():
        with Simulated(robot.home / robot.axis_units, RATE) as simulator:
            session = OrderedSession("127.0.0.1", simulator.port, pace=RATE, scripts=scripts_of("knots"))
            async with Coordinator(robot, session, folder=folder, log=NO_LOG) as coordinator:
                client = coordinator.attach("test")
                client.session.own()
                running = asyncio.create_task(client.motion.run(loaded))
                await until(lambda: coordinator.state is State.MOVE)
                await during(coordinator, client, simulator)
                ended = await running
                end = np.abs(simulator.place * robot.axis_units - loaded.program.end).max()
                return ended, coordinator.state, end

    return asyncio.run(asyncio.wait_for(work(), 60.0))


async def until(held):
    while not held():
        await asyncio.sleep(0.01)


def test_it_moves_to_the_end(folder):
    async def nothing(coordinator, client, simulator):
        pass

    ended, state, off = carried_out(folder, nothing)
    assert (ended.well, state) == (True, State.STOP), ended
    assert off < 1e-6


def test_it_holds_and_goes_on(folder):
    async def during(coordinator, client, simulator):
        client.motion.hold()
        await until(lambda: coordinator.state is State.HOLD)
        stood = simulator.place
        await asyncio.sleep(0.2)
        assert (simulator.place == stood).all()
        client.motion.resume()

    ended, state, off = carried_out(folder, during)
    assert (ended.well, state) == (True, State.STOP), ended
    assert off < 1e-6


def test_it_stops(folder):
    async def during(coordinator, client, simulator):
        client.motion.stop()

    ended, state, off = carried_out(folder, during)
    assert (ended.well, ended.what, state) == (False, "stopped on its path", State.STOP)
    assert off > 1e-3


def test_a_fault_is_told_and_cleared(folder):
    async def during(coordinator, client, simulator):
        simulator.fail()
        await until(lambda: coordinator.state is State.FAULT)
        await until(lambda: not coordinator.engine.under_way)
        await coordinator.engine.clear()
        assert coordinator.state is State.STOP

    ended, _, _ = carried_out(folder, during)
    assert (ended.well, ended.code) == (False, "Y1602")


def test_what_it_has_not_is_denied(folder):
    async def during(coordinator, client, simulator):
        with pytest.raises(Trouble, match="set up with the manufacturer's tools"):
            await Servicing(coordinator, client.name).enable()

    carried_out(folder, during)
