"""Internal errors in the server: the server reports the error in the text, continues, and checks the next
edit.
"""

import sys
from pathlib import Path

import pytest
from lsprotocol import types

from tests.lsp import driven
from tests.lsp.driven import Editor, capabilities, run

BROKEN = """
import sys
import yarclang.pipeline.stages as stages
import yarclang.syntax.form as form
import yarclang.syntax.parse as parse
from yarclang.cli.yarc import main

def failing(original, mark):
    def failed(what, *arguments):
        text = what if isinstance(what, str) else what.source.text
        if mark in text:
            raise RuntimeError("nobody knows")
        return original(what, *arguments)
    return failed

stages.check = failing(stages.check, "! fail when checked")
stages.plan = failing(stages.plan, "! fail when planned")
parse.plain_statement = failing(parse.plain_statement, "! fail when parsed")
form.print_module = failing(form.print_module, "! fail when printed")
main()
"""
GOOD = "ROBOT INDUSTRIAL6\nP0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"


@pytest.fixture
def broken_server(monkeypatch):
    monkeypatch.setattr(driven, "COMMAND", (sys.executable, "-c", BROKEN, "lsp"))


@pytest.mark.parametrize("where", ["checked", "planned", "parsed"])
@pytest.mark.parametrize("pull", [True, False], ids=["asked", "sent"])
def test_a_failure_is_shown_and_the_next_edit_is_looked_at(broken_server, tmp_path: Path, where, pull):
    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", GOOD + f"P0020 STOP ! fail when {where}\n")
        for text, codes in (
            (None, {"Y2001"}),
            (GOOD + "P0020 MOVEK\n", {"Y0202"}),
            (GOOD + f"P0020 STOP ! fail when {where}\n", {"Y2001"}),
            (GOOD, set()),
        ):
            if text is not None:
                one.write(document, text)
            if pull:
                found = await one.pulled(document)
                assert {each.code for each in found} == codes
            else:
                found = await one.until(
                    document, lambda found, codes=codes: {each.code for each in found} == codes
                )
            for each in found:
                if each.code == "Y2001":
                    assert (
                        "internal error: RuntimeError: nobody knows\nthis is a bug of yarclang"
                        in each.message
                    )
        at = types.TextDocumentPositionParams(document, types.Position(1, 8))
        hover = await one.client.text_document_hover_async(types.HoverParams(at.text_document, at.position))
        assert hover is not None

    run(work, capabilities(pull=pull, refresh=False))


def test_what_cannot_be_formatted_stays(broken_server, tmp_path: Path):
    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", "")
        wishes = types.FormattingOptions(tab_size=2, insert_spaces=True)
        for text, edits in (
            ("p0010 stop\n", 1),
            ("p0010 stop ! fail when printed\n", None),
            ("DEFAULT {!TCP}\n", None),
            ("p0020 stop\n", 1),
        ):
            one.write(document, text)
            made = await one.client.text_document_formatting_async(
                types.DocumentFormattingParams(document, wishes)
            )
            assert (made and len(made)) == edits

    run(work, capabilities(pull=True))


def test_foreign_characters_have_a_quick_fix(tmp_path: Path):
    async def work(one: Editor) -> None:
        text = "ROBOT INDUSTRIAL6\nP0010 MOVEJ\u2003\u221210 0 0 0 0 0 [2] (deg,s)\n"
        document = one.open(tmp_path / "a.yarc", text)
        (found,) = await one.pulled(document)
        assert (found.code, found.range.start.line, found.range.start.character) == ("Y0118", 1, 11)
        actions = await one.client.text_document_code_action_async(
            types.CodeActionParams(document, found.range, types.CodeActionContext([found]))
        )
        fix = next(each for each in actions if each.kind == types.CodeActionKind.QuickFix)
        assert (fix.title, fix.is_preferred) == ("write plain characters (Y0118)", True)
        (edit,) = fix.edit.changes[document.uri]
        assert (edit.range.start.character, edit.range.end.character, edit.new_text) == (11, 13, " -")

    run(work, capabilities(pull=True))
