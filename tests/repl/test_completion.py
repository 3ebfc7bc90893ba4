"""Tests of the completions that the tab key offers."""

import pytest
from coordinator.virtual import run
from prompt_toolkit.completion import CompleteEvent
from prompt_toolkit.document import Document
from repl.talking import talking

from yarclang.repl.completion import Completion
from yarclang.repl.dot import dot_commands


def choices(person, text):
    found = Completion(person.interpreter).get_completions(Document(text, len(text)), CompleteEvent())
    return {text[: len(text) + one.start_position] + one.text: one.display_meta_text for one in found}


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (".wh", ".where"),
        (".calibrate t", ".calibrate tcp"),
        (".help .te", ".help .teach"),
        ("MOVEJ {TC", "MOVEJ {TCP}"),
        ("MOVEJ REA", "MOVEJ READY"),
        ("MOVEJ 0 0 0 0 0 0 [1] (deg,s) {TA", "MOVEJ 0 0 0 0 0 0 [1] (deg,s) {TABLE}"),
        ("FRA", None),
        ("MOVEJ_R", None),
        (".load pr", ".load program.yarc"),
        (".load sub/", ".load sub/deep.yarc"),
        (".set GR", ".set GRIP"),
        (".run P", None),
    ],
)
def test_choices(tmp_path, text, wanted):
    (tmp_path / "program.yarc").write_text("")
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "deep.yarc").write_text("")

    async def session():
        async with talking(tmp_path) as person:
            await person.type(
                "FRAME {TABLE} 800 200 300 0 0 90 (mm,deg) {B}",
                "JOINTS READY 0 0 0 0 30 0 (deg)",
                "OUTPUT GRIP M1 OFF",
            )
            found = choices(person, text)
            if wanted is not None:
                assert wanted in found
            assert all(one.upper().startswith(text.upper()[:4]) for one in found)

    run(session())


def test_commands_are_offered_with_their_documentation_and_without_an_index(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            found = choices(person, "MOV")
            heads = {one.split()[0] for one in found}
            assert {"MOVEJ", "MOVEL"} <= heads
            assert all(found.values())

    run(session())


def test_every_dot_command_is_offered(tmp_path):
    async def session():
        async with talking(tmp_path) as person:
            assert set(choices(person, ".")) == set(dot_commands())

    run(session())


def test_nothing_is_offered_as_an_answer(tmp_path):
    async def session():
        async with talking(tmp_path, asks=True) as person:
            await person.type("MOVEJ 10 0 0 0 20 0 [1] (deg,s)")
            assert choices(person, "") == {}

    run(session())
