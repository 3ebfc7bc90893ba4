"""Tests of a cell's parts at the prompt: the output of `.parts`, and statements that move parts."""

import pytest
from coordinator.virtual import run
from handling.carrying import CELL, GIVEN
from repl.talking import talking

from yarclang.coordinator.messages import orders


@pytest.fixture
def project(tmp_path):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "cell.toml").write_text(CELL.format(**GIVEN))
    return tmp_path


def test_parts_are_shown_and_said(project):
    async def session():
        async with talking(project) as person:
            first = await person.type(".parts")
            assert "BOX: lies at 300 850 650 0 0 0 {B}" in first
            assert "at their places in the cell's file" in first
            assert "lies at -250 900 700 0 0 75 {B}" in await person.type(".parts put BOX {PUT} 0 0 0 0 0 45")
            assert "GRIP holds it, at 0 150 0 90 0 0 {FLANGE}" in await person.type(
                ".parts put box {gripper}"
            )
            assert "no part is left in the cell" in await person.type(".parts gone BOX")
            assert "BOX: lies at 300 850 650" in await person.type(".parts reset BOX")
            assert "at their places in the cell's file" in await person.type(".parts reset")

    run(session())


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (".parts put BIX {PUT}", "no part is called BIX"),
        (".parts put BOX PUT", "a part and a frame are needed"),
        (".parts put BOX {PUT} 1 2", "six values are needed"),
        (".parts put BOX {PUT} 1 2 3 4 5 six", "aren't numbers"),
        (".parts put BOX {NOWHERE}", "Y0301"),
        (".parts put BOX 2 {PUT}", "there is no BOX 2"),
        (".parts away BOX", "says nothing about parts"),
        (".parts gone", "says nothing about parts"),
    ],
)
def test_what_is_no_place_is_refused(project, text, told):
    async def session():
        async with talking(project) as person:
            assert told in await person.type(text)
            assert "BOX: lies at 300 850 650" in await person.type(".parts")

    run(session())


def test_it_is_asked_and_can_be_refused(project):
    async def session():
        async with talking(project, asks=True) as person:
            await person.type(".parts gone BOX")
            assert person.asked
            assert "nothing has changed" in await person.type("n")
            assert "BOX: lies" in await person.type(".parts")

    run(session())


def test_a_cell_without_parts_says_so(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert "the session's cell has no parts" in await person.type(".parts")

    run(session())


def test_signals_are_told_and_whoever_names_the_cell_learns_where_parts_are(project):
    """Each signal is one line, as in `yarc run`.

    For a cell whose parts nothing has moved, no places are reported.
    """

    async def session():
        async with talking(project) as person:
            ask, file = person.interpreter.attached.ask, str(project / "cell.toml")
            told = await ask(orders.AskParts(cell=file))
            assert (told.parts, told.moved) == ((), False)
            said = await person.type("SET GRIP ON")
            assert said.splitlines().count("SET GRIP ON") == 1
            await person.type(".parts put BOX {GRIPPER}")
            told = await ask(orders.AskParts(cell=file))
            assert [(one.name, one.held) for one in told.parts] == [("BOX", "GRIP")]
            assert told == await ask(orders.AskParts())
            for hostile in ("", "\0", "x" * 10_000, str(project / "other.toml")):
                assert (await ask(orders.AskParts(cell=hostile))).parts == ()

    run(session())
