"""Tests of programs in files at the prompt: they are loaded, run, stepped through, saved and touched up."""

import asyncio
import shutil
from pathlib import Path

import pytest
from coordinator.virtual import run
from repl.talking import talking

from yarclang.coordinator.lines import seen_from

PROGRAM = """\
ROBOT INDUSTRIAL6
START HOME
JOINTS READY 0 10 10 0 30 0 (deg)   ! above the table
FRAME {PICK} 0 1174.4 1100 0 0 0 (mm,deg) {B}  ! the first part
P0010 MOVEJ READY [2] (s)
P0020 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)
P0030 DMOVEJ 5 0 0 0 0 0 [1] (deg,s)
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "cell.yarc").write_text(PROGRAM)
    return tmp_path


def test_load_and_run(folder):
    async def session():
        async with talking(folder) as person:
            told = await person.type(".load cell.yarc")
            assert "3 commands, P0010 to P0030; its 2 declarations" in told
            assert "done" in await person.type(".run")
            assert person.world.stands() == pytest.approx([10, 10, 10, 0, 30, 0], abs=1e-3)
            assert "done" in await person.type("MOVEJ READY [1] (s)")

    run(session())


def test_run_from_a_command_asks_for_the_approach(folder):
    async def session():
        async with talking(folder) as person:
            await person.type(".load cell.yarc")
            told = await person.type(".run p0030")
            assert "doesn't stand where" in told
            assert person.asked.startswith("move slowly to its start first")
            assert "nothing moved" in await person.type("n")
            assert person.world.stands() == pytest.approx([0] * 6, abs=1e-4)
            assert "done" in await person.type(".run P0030", "y")
            assert person.world.stands() == pytest.approx([10, 10, 10, 0, 30, 0], abs=1e-3)

    run(session())


def test_step_by_step(folder):
    async def session():
        async with talking(folder) as person:
            await person.type(".load cell.yarc")
            person.interpreter.typed(".step")
            stops = []
            for _ in range(3):
                await person.world.until(lambda: person.world.moving)
                await person.world.until(lambda: not person.world.moving)
                await asyncio.sleep(1.0)
                stops.append(person.world.stands()[0])
                person.interpreter.typed("")
            await person.settled()
            assert stops == pytest.approx([0, 5, 10], abs=1e-3)

    run(session())


def test_what_is_wrong_with_a_file(folder):
    async def session():
        async with talking(folder) as person:
            assert "no program is loaded" in await person.type(".run")
            assert "can't be read" in await person.type(".load nothing.yarc")
            assert "a file is missing" in await person.type(".load")
            (folder / "bad.yarc").write_text("P0010 MOVEJ 1 2 3 [1] (deg,s)\n")
            assert "bad.yarc:1" in await person.type(".load bad.yarc")
            assert "no program is loaded" in await person.type(".run")
            await person.type(".load cell.yarc")
            (folder / "cell.yarc").unlink()
            assert "can't be read" in await person.type(".run")

    run(session())


def test_a_file_that_changes_is_run_as_it_is(folder):
    async def session():
        async with talking(folder) as person:
            await person.type(".load cell.yarc")
            (folder / "cell.yarc").write_text(PROGRAM.replace("[2]", "[4]"))
            assert "6.00 s" in await person.type(".run")

    run(session())


def test_a_saved_session_does_the_same(folder):
    async def session():
        async with talking(folder) as person:
            await person.type(
                "JOINTS UP 0 10 10 0 30 0 (deg)", "MOVEJ UP [2] (s)", "DMOVEJ 1 0 0 0 0 0 [1] (deg,s)"
            )
            there = person.world.stands()
            assert "does what this session did" in await person.type(".save mine.yarc")
            assert "already exists" in await person.type(".save mine.yarc")
            assert "must end with .yarc" in await person.type(".save mine.txt")
        async with talking(folder) as person:
            await person.type(".load mine.yarc", ".run")
            assert person.world.stands() == pytest.approx(there, abs=1e-4)

    run(session())


def test_teaching_declares(folder):
    async def session():
        async with talking(folder, joints=[0, 0, 0, 0, 30, 0]) as person:
            assert "it is valid" in await person.type(".teach here")
            assert "it is valid" in await person.type(".teach {there}")
            await person.type(
                "MOVEJ 10 0 0 0 30 0 [1] (deg,s)", "MOVEL {TCP} 0 0 0 0 0 0 [2] (mm,deg,s) {THERE}"
            )
            assert person.world.stands() == pytest.approx([0, 0, 0, 0, 30, 0], abs=1e-2)
            await person.type("MOVEJ 10 0 0 0 30 0 [1] (deg,s)", "MOVEJ HERE [1] (s)")
            assert person.world.stands() == pytest.approx([0, 0, 0, 0, 30, 0], abs=1e-3)
            assert "a name is missing" in await person.type(".teach")
            assert "has no frame" in await person.type(".teach HERE {B}")

    run(session())


def test_touching_up_changes_the_line_of_the_file(folder):
    async def session():
        async with talking(folder, joints=[0, 5, 5, 0, 40, 0]) as person:
            await person.type(".load cell.yarc")
            told = await person.type(".teach READY")
            assert "- JOINTS READY 0 10 10 0 30 0 (deg)" in told
            assert "+ JOINTS READY 0 5 5 0 40 0 (deg) ! above the table" in told
            assert "nothing was changed" in await person.type("n")
            assert (folder / "cell.yarc").read_text() == PROGRAM
            assert "cell.yarc:3 is changed" in await person.type(".teach READY", "y")
            lines = (folder / "cell.yarc").read_text().splitlines()
            assert lines[2] == "JOINTS READY 0 5 5 0 40 0 (deg) ! above the table"
            assert [one for one in lines if one != lines[2]] == [
                one for one in PROGRAM.splitlines() if not one.startswith("JOINTS")
            ]
            assert "done" in await person.type("MOVEJ READY [1] (s)")
            assert person.world.stands() == pytest.approx([0, 5, 5, 0, 40, 0], abs=1e-3)
            assert "cell.yarc:4 is changed" in await person.type(".teach {PICK}", "y")

    run(session())


def test_touching_up_keeps_crlf(folder):
    async def session():
        (folder / "cell.yarc").write_bytes(PROGRAM.replace("\n", "\r\n").encode())
        async with talking(folder, joints=[0, 5, 5, 0, 40, 0]) as person:
            await person.type(".load cell.yarc", ".teach READY", "y")
            content = (folder / "cell.yarc").read_bytes()
            assert content.count(b"\r\n") == content.count(b"\n") == PROGRAM.count("\n")

    run(session())


STEPS = """ROBOT INDUSTRIAL6
START 3 0 0 0 20 0 (deg)
P0010 MOVEJ 8 0 0 0 20 0 [1] (deg,s)
P0020 MOVEL {TCP} 0 1150 1400 0 0 0 [50%] (mm,deg,s) {B}
"""


@pytest.mark.parametrize("early", [0.02, 0.5, 1.0])
def test_enter_during_an_approach_starts_no_step(folder, early):
    async def session():
        (folder / "steps.yarc").write_text(STEPS.replace("P0020 MOVEL", "P0020 MOVEJ_RPY"))
        async with talking(folder) as person:
            await person.type(".load steps.yarc", ".step")
            assert "move slowly to its start first" in person.asked
            person.interpreter.typed("y")
            await person.world.until(lambda: person.world.moving)
            await asyncio.sleep(early)
            for _ in range(3):
                person.interpreter.typed("")
            picture = person.interpreter.picture
            await person.world.until(lambda: picture.paused)
            await asyncio.sleep(2.0)
            assert person.world.stands()[0] == pytest.approx(3.0, abs=1e-3)
            person.interpreter.typed("")
            await person.world.until(lambda: person.world.moving)
            person.interpreter.typed("")  # a second step is requested too early
            await person.world.until(lambda: picture.paused)
            await asyncio.sleep(2.0)
            assert person.world.stands()[0] == pytest.approx(8.0, abs=1e-3)
            person.interpreter.typed("")
            await person.settled()

    run(session())


def test_back_works_behind_steps_and_runs(folder):
    async def session():
        async with talking(folder) as person:
            (folder / "steps.yarc").write_text(PROGRAM)
            await person.type(".load steps.yarc")
            before = person.world.stands()
            person.interpreter.typed(".step")
            places = [before]
            while not person.interpreter.idle:
                await person.world.until(lambda: person.interpreter.picture.paused or person.interpreter.idle)
                places.append(person.world.stands())
                person.interpreter.typed("")
                await asyncio.sleep(0.1)
            assert len(places) > 2
            for place in reversed(places[:-1]):
                assert "done" in await person.type(".back")
                assert person.world.stands() == pytest.approx(place, abs=1e-3)
            assert "nothing has moved" in await person.type(".back")

    run(session())


def test_back_works_behind_a_step_that_was_stopped(folder):
    async def session():
        async with talking(folder) as person:
            (folder / "steps.yarc").write_text("P0010 MOVEJ 20 0 0 0 20 0 [4] (deg,s)\n")
            await person.type(".load steps.yarc")
            before = person.world.stands()
            person.interpreter.typed(".step")
            await person.world.until(lambda: person.world.moving)
            await asyncio.sleep(1.5)
            person.interpreter.typed(".stop")
            await person.settled()
            assert 0.5 < person.world.stands()[0] < 19.0
            assert "done" in await person.type(".back")
            assert person.world.stands() == pytest.approx(before, abs=1e-3)

    run(session())


def test_files_of_trajectories_are_seen_from_the_folder(tmp_path):
    here, there = tmp_path, tmp_path / "saved"
    text = (
        'SUB RUN\n  P0010 movej_timed "runs/a.csv" ! MOVEJ_TIMED "b.csv"\n  P0020 MOVEJ_TIMED  "/c.csv"\nEND'
    )
    assert seen_from(text, here, there) == text.replace('"runs/a.csv"', '"../runs/a.csv"')
    assert seen_from('P0010 HOLD "MOVEJ_TIMED"', here, there) == 'P0010 HOLD "MOVEJ_TIMED"'
    assert seen_from('MOVEJ_TIMED "a.csv" [5] (s)', here, there) == 'MOVEJ_TIMED "../a.csv" [5] (s)'
    assert seen_from(seen_from(text, here, there), there, here) == text


def test_a_session_is_saved_with_names_as_they_are_seen_from_its_folder(folder):
    async def session():
        (folder / "cells").mkdir()
        (folder / "saved" / "deep").mkdir(parents=True)
        shutil.copy(Path(__file__).parents[2] / "examples" / "cell.toml", folder / "cells" / "table.toml")
        async with talking(folder) as person:
            told = await person.type('CELL "cells/table.toml"')
            assert "it is valid" in told, told
            await person.type(
                "MOVEJ 5 0 0 0 20 0 [1] (deg,s)", ".save saved/deep/mine.yarc", ".save mine.yarc"
            )
            assert 'CELL "../../cells/table.toml"' in (folder / "saved" / "deep" / "mine.yarc").read_text()
            assert 'CELL "cells/table.toml"' in (folder / "mine.yarc").read_text()
            assert str(folder) not in (folder / "mine.yarc").read_text()
            assert "its 1 declarations are valid here from now on" in await person.type(
                ".load saved/deep/mine.yarc"
            )
            assert person.coordinator.lines.declarations == ['CELL "cells/table.toml"']

    run(session())
