"""Each feature, as an editor requests it over standard input and output."""

import asyncio
from pathlib import Path

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException

from tests.lsp.driven import Editor, capabilities, run

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "07_inspection_tour.yarc"
TEXT = EXAMPLE.read_text()
LINES = TEXT.split("\n")


def position(piece: str, number: int = 1, shift: int = 0) -> types.Position:
    """Return the place at which the `number`-th occurrence of a piece of the example begins, plus `shift`
    columns.
    """
    place = -1
    for _ in range(number):
        place = TEXT.index(piece, place + 1)
    before = TEXT[: place + shift]
    return types.Position(before.count("\n"), len(before.rpartition("\n")[2]))


WHOLE = types.Range(types.Position(0, 0), types.Position(len(LINES), 0))


def applied(text: str, edits: list[types.TextEdit]) -> str:
    """Return an ASCII text after edits of the protocol."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)

    def offset(one: types.Position) -> int:
        return min(starts[one.line] + one.character, len(text))

    for one in sorted(edits, key=lambda edit: offset(edit.range.start), reverse=True):
        text = text[: offset(one.range.start)] + one.new_text + text[offset(one.range.end) :]
    return text


def test_all_features_answer():
    async def work(one: Editor) -> None:
        document = one.open(EXAMPLE, TEXT)
        client = one.client
        await one.pulled(document)
        at = types.TextDocumentPositionParams(document, position("EDGE"))

        hover = await client.text_document_hover_async(types.HoverParams(document, position("P0020")))
        assert "takes 1.500 s" in hover.contents.value
        hints = await client.text_document_inlay_hint_async(types.InlayHintParams(document, WHOLE))
        assert [one.position.line for one in hints] == [
            number for number, line in enumerate(LINES) if " MOVE" in line and line.strip().startswith("P")
        ]
        assert any("min 0." in str(one.label) and "%" in str(one.label) for one in hints)

        found = await client.text_document_completion_async(
            types.CompletionParams(document, position("MOVEJ READY", shift=3))
        )
        item = next(one for one in found.items if one.label == "MOVEL")
        assert item.documentation.value.startswith("**MOVEL**")
        assert "${1:" in item.text_edit.new_text
        line = next(number for number, text in enumerate(LINES) if "P0020" in text)
        help_ = await client.text_document_signature_help_async(
            types.SignatureHelpParams(document, types.Position(line, LINES[line].index("0 0 ", 12)))
        )
        assert help_.signatures[0].label == "MOVEL x (mm) y (mm) z (mm) roll (deg) pitch (deg) yaw (deg)"

        definition = await client.text_document_definition_async(
            types.DefinitionParams(document, position("EDGE", 2))
        )
        assert definition.uri == document.uri
        assert definition.range.start == at.position
        references = types.ReferenceParams(types.ReferenceContext(True), document, at.position)
        assert len(await client.text_document_references_async(references)) == TEXT.count("{EDGE}")
        highlights = types.DocumentHighlightParams(document, at.position)
        assert len(await client.text_document_document_highlight_async(highlights)) == TEXT.count("{EDGE}")
        ready = await client.text_document_prepare_rename_async(
            types.PrepareRenameParams(document, at.position)
        )
        assert ready.end.character - ready.start.character == len("EDGE")
        renamed = await client.text_document_rename_async(types.RenameParams(document, at.position, "RIM"))
        assert applied(TEXT, renamed.changes[document.uri]) == TEXT.replace("{EDGE}", "{RIM}")
        with pytest.raises(JsonRpcException, match="comes from the robot"):
            await client.text_document_rename_async(types.RenameParams(document, at.position, "TCP"))
        with pytest.raises(JsonRpcException, match="there is no name here"):
            await client.text_document_prepare_rename_async(
                types.PrepareRenameParams(document, position("P0020"))
            )

        symbols = await client.text_document_document_symbol_async(types.DocumentSymbolParams(document))
        assert "LOOK" in [one.name for one in symbols]
        anywhere = await client.workspace_symbol_async(types.WorkspaceSymbolParams("lk"))
        assert "LOOK" in [one.name for one in anywhere]
        folding = await client.text_document_folding_range_async(types.FoldingRangeParams(document))
        assert any(LINES[one.start_line].startswith("SUB") for one in folding)
        tokens = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document))
        assert len(tokens.data) % 5 == 0
        assert len(tokens.data) > 500
        part = await client.text_document_semantic_tokens_range_async(
            types.SemanticTokensRangeParams(document, types.Range(types.Position(3, 0), types.Position(5, 0)))
        )
        assert 0 < len(part.data) < len(tokens.data)
        lenses = await client.text_document_code_lens_async(types.CodeLensParams(document))
        assert lenses[0].command.title.startswith("plot ")
        for lens in lenses:
            told = await client.workspace_execute_command_async(
                types.ExecuteCommandParams(lens.command.command, lens.command.arguments)
            )
            written = (
                Path(told["path"]).read_text() if isinstance(told, dict) else Path(told.path).read_text()
            )
            assert written.startswith(("<?xml", "command\n"))

        options = types.FormattingOptions(2, True)
        edits = await client.text_document_formatting_async(types.DocumentFormattingParams(document, options))
        import yarclang

        assert applied(TEXT, edits) == yarclang.format(TEXT)
        part = await client.text_document_range_formatting_async(
            types.DocumentRangeFormattingParams(document, edits[0].range, options)
        )
        assert list(part) == [edits[0]]

    run(work, capabilities(pull=True, refresh=False))


def test_a_closing_bracket_ends_the_choice(tmp_path: Path):
    """A frame that is typed including its closing bracket matches no proposal any more. Otherwise the next
    Enter would insert a proposal and overwrite the bracket.
    """
    text = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [2] (mm,deg,s) {B}\nP0010 MOVEL 0 900 600 0 0 0 {}\n"

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", text)
        for shift in (1, 0):
            place = types.Position(2, len("P0010 MOVEL 0 900 600 0 0 0 ") + shift)
            found = await one.client.text_document_completion_async(types.CompletionParams(document, place))
            named = {one.label: one.filter_text for one in found.items}
            assert named["{B}"] == "{B"
            assert not any(one.endswith(("]", "}")) for one in named.values())

    run(work, capabilities(pull=True, refresh=False))


def test_lenses_are_asked_for_again_when_motions_are_planned(tmp_path: Path):
    async def work(one: Editor) -> None:
        planned = asyncio.Event()
        one.client.protocol.fm.features[types.WORKSPACE_CODE_LENS_REFRESH] = lambda _: planned.set()
        program = (
            "ROBOT INDUSTRIAL6\n"
            "P0010 WAIT [1] (s)\n"
            "P0020 MOVEJ HOME [2] (s)\n"
            "P0030 MOVEJ HOME [2] (s)\n"
            "\n"
            "P0040 STOP\n"
        )
        document = one.open(tmp_path / "a.yarc", program)
        await planned.wait()
        lenses = await one.client.text_document_code_lens_async(types.CodeLensParams(document))
        assert [one.command.title for one in lenses] == ["plot 2 motions, 5.000 s", "inspect P0020"]

    chosen = capabilities(pull=True, refresh=False)
    chosen.workspace.code_lens = types.CodeLensWorkspaceClientCapabilities(refresh_support=True)
    run(work, chosen)


def test_fixes_of_a_whole_text(tmp_path: Path):
    """The source actions include all safe fixes at once, and new indices."""
    text = "ROBOT INDUSTRIAL6\nUSE PALLET\nP0020 MOVJ HOME [2] (s)\nP0010 MOVEJ 9 0 0 0 0 0 [2] (deg,s)\n"

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", text)
        await one.pulled(document)

        async def action(kind: types.CodeActionKind | str) -> str:
            context = types.CodeActionContext([], only=[kind])
            (found,) = await one.client.text_document_code_action_async(
                types.CodeActionParams(document, WHOLE, context)
            )
            return applied(text, found.edit.changes[document.uri])

        assert await action(types.CodeActionKind.SourceFixAll) == (
            "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME [2] (s)\nP0020 MOVEJ 9 0 0 0 0 0 [2] (deg,s)\n"
        )
        assert await action("source.renumber.yarc") == text.replace("P0020", "X").replace(
            "P0010", "P0020"
        ).replace("X", "P0010")

    run(work, capabilities(pull=True, refresh=False))


def test_typed_letter_by_letter_with_wide_characters(tmp_path: Path):
    """After incremental changes behind umlauts and emoji, client and server have the same text, and no
    request fails.
    """
    text = (
        "! Grüße 🤖 an alle\nROBOT INDUSTRIAL6\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        'FRAME {A} 0 900 600 0 0 0 {B} ! 🤖ä\nP0010 HOLD "Tür 🚪 zu" ! ü\nP0020 MOVJE HOME ! 🤖 MOVJE\n'
    )

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", "")
        client = one.client
        line = units = 0
        requests = []
        for number, letter in enumerate(text):
            here = types.Position(line, units)
            change = types.TextDocumentContentChangePartial(range=types.Range(here, here), text=letter)
            one.change(document, [change])
            if letter == "\n":
                line, units = line + 1, 0
            else:
                units += len(letter.encode("utf-16-le")) // 2
            now = types.Position(line, units)
            if number % 4 == 0:
                requests += [
                    client.text_document_completion_async(types.CompletionParams(document, now)),
                    client.text_document_hover_async(types.HoverParams(document, now)),
                    client.text_document_signature_help_async(types.SignatureHelpParams(document, now)),
                ]
            if number % 16 == 0:
                requests += [
                    client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document)),
                    client.text_document_document_symbol_async(types.DocumentSymbolParams(document)),
                    client.text_document_inlay_hint_async(types.InlayHintParams(document, WHOLE)),
                    client.text_document_code_lens_async(types.CodeLensParams(document)),
                    client.text_document_folding_range_async(types.FoldingRangeParams(document)),
                    client.text_document_code_action_async(
                        types.CodeActionParams(document, WHOLE, types.CodeActionContext([]))
                    ),
                ]
        await asyncio.gather(*requests)
        (found,) = await one.pulled(document)
        shown = found.range.start, found.range.end
        assert shown == (types.Position(5, 6), types.Position(5, 11))
        assert "MOVEJ" in found.message
        definition = types.DefinitionParams(document, types.Position(3, 7))
        assert (await client.text_document_definition_async(definition)).range.start.line == 3
        tokens = await client.text_document_semantic_tokens_full_async(types.SemanticTokensParams(document))
        assert list(tokens.data[:3]) == [0, 0, len("! Grüße 🤖 an alle") + 1]

    run(work, capabilities(pull=True, refresh=False))


def test_editors_that_count_otherwise(tmp_path: Path):
    """A client that prefers UTF-8 gets positions in UTF-8."""
    text = 'ROBOT INDUSTRIAL6\nP0020 MOVJE HOME [1] (s) ! 🤖ä\nP0030 HOLD "ä🤖" [1]\n'

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "a.yarc", text)
        found = await one.pulled(document)
        end = next(one.range for one in found if one.range.start.line == 2)
        assert end.start.character == len('P0030 HOLD "ä🤖" '.encode())

    chosen = capabilities(pull=True, refresh=False)
    chosen.general = types.GeneralClientCapabilities(
        position_encodings=[types.PositionEncodingKind.Utf8, types.PositionEncodingKind.Utf16]
    )
    run(work, chosen)


@pytest.mark.parametrize("installed", [False, True])
def test_a_finding_in_a_module_stands_at_the_call_with_the_module_beside_it(tmp_path, installed):
    (tmp_path / "swing.yarc").write_text(
        "DEFAULT [50%] (deg,s)\nSUB FIXED\n  P0010 MOVEJ 20 0 0 0 0 0 [0.001]\nEND\n"
    )
    text = "ROBOT INDUSTRIAL6\nUSE SWING\nP0010 CALL SWING.FIXED\n"
    if installed:
        text = (
            "ROBOT INDUSTRIAL6\nUSE PICKPLACE\nFRAME {FAR} 1900 800 700 0 0 0 (mm,deg) {B}\n"
            "OUTPUT GRIP M1\nP0010 CALL PICKPLACE.PICK {TCP} {FAR} 150 (mm) GRIP 1.2 (s)\n"
        )
    call = text.count("\n") - 1

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "p.yarc", text)
        found = [finding for finding in await one.pulled(document) if finding.severity == 1]
        assert found
        for finding in found:
            assert finding.range.start.line == call
            (there,) = finding.related_information
            path = there.location.uri.removeprefix("file://")
            assert path.endswith("/approach.yarc" if installed else "/swing.yarc")
            assert there.message.startswith(
                "in APPROACH, line " if installed else f"in {tmp_path}/swing.yarc, line 3: "
            )
            assert there.message in finding.message
        whole = types.Range(types.Position(0, 0), types.Position(call + 1, 0))
        actions = await one.client.text_document_code_action_async(
            types.CodeActionParams(document, whole, types.CodeActionContext(found))
        )
        assert all(
            action.edit is None or set(action.edit.changes) == {document.uri} for action in actions or ()
        )
        assert not any("0.2" in action.title for action in actions or ())

    run(work, capabilities(pull=True, refresh=False))


CALLS = """ROBOT INDUSTRIAL6
DEFAULT {TCP} [50%] (mm,deg,s) {B}
USE SIDE
SUB DOWN
  MOVEJ 0 10 0 0 -30 0
END
SUB PICK
  CALL DOWN
  CALL SIDE.SWING
  CALL DOWN
END
P0010 CALL PICK
"""
SIDE = "SUB SWING\n  MOVEJ 20 0 0 0 -30 0 [50%] (deg)\nEND\n"


def test_the_hierarchy_of_calls(tmp_path: Path):
    (tmp_path / "side.yarc").write_text(SIDE)
    (tmp_path / "other.yarc").write_text("USE SIDE\nP0010 CALL SIDE.SWING\n")

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "job.yarc", CALLS)
        client = one.client
        await one.pulled(document)
        at = types.CallHierarchyPrepareParams(document, types.Position(11, 12))
        (pick,) = await client.text_document_prepare_call_hierarchy_async(at)
        assert (pick.name, pick.range.start.line, pick.range.end.line) == ("PICK", 6, 10)
        callers = await client.call_hierarchy_incoming_calls_async(
            types.CallHierarchyIncomingCallsParams(pick)
        )
        assert [(call.from_.name, len(call.from_ranges)) for call in callers] == [("job.yarc", 1)]
        called = await client.call_hierarchy_outgoing_calls_async(
            types.CallHierarchyOutgoingCallsParams(pick)
        )
        assert [(call.to.name, [one.start.line for one in call.from_ranges]) for call in called] == [
            ("DOWN", [7, 9]),
            ("SWING", [8]),
        ]
        swing = called[1].to
        assert swing.uri == (tmp_path / "side.yarc").as_uri()
        callers = await client.call_hierarchy_incoming_calls_async(
            types.CallHierarchyIncomingCallsParams(swing)
        )
        assert sorted(call.from_.name for call in callers) == ["PICK", "other.yarc"]
        main = await client.call_hierarchy_outgoing_calls_async(
            types.CallHierarchyOutgoingCallsParams(
                next(call.from_ for call in callers if call.from_.name == "other.yarc")
            )
        )
        assert [call.to.name for call in main] == ["SWING"]
        nothing = types.CallHierarchyPrepareParams(document, types.Position(1, 2))
        assert not await client.text_document_prepare_call_hierarchy_async(nothing)

    run(work, capabilities(pull=True))


CELL = """units = "mm,deg,s"
[frames.BENCH]
parent = "B"
xyz = [0, 1000, 500]
[frames.PART]
parent = "BENCH"
xyz = [0, 100, 0]
[joints]
READY = [0, 10, 0, 0, -30, 0]
[[obstacles]]
name = "BLOCK"
shape = "box"
frame = "BENCH"
size = [10, 10, 10]
"""
IN_CELL = """ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ READY
P0020 MOVEJ_RPY 0 100 700 0 0 0 {BENCH}
"""


def test_a_name_of_the_cell_is_another_one_in_all_files(tmp_path: Path):
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "other.yarc").write_text(IN_CELL)
    (tmp_path / "own.yarc").write_text(
        "FRAME {BENCH} 0 0 0 0 0 0 (mm,deg) {B}\n" + IN_CELL.partition("\n")[2][17:]
    )

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "job.yarc", IN_CELL)
        client = one.client
        await one.pulled(document)
        bench, ready = types.Position(4, 33), types.Position(3, 13)
        assert await client.text_document_prepare_rename_async(types.PrepareRenameParams(document, bench))
        made = await client.text_document_rename_async(types.RenameParams(document, bench, "DESK"))
        assert {uri.rpartition("/")[2] for uri in made.changes} == {"cell.toml", "job.yarc", "other.yarc"}
        cell = applied(CELL, made.changes[(tmp_path / "cell.toml").as_uri()])
        assert cell == CELL.replace("BENCH", "DESK")
        assert applied(IN_CELL, made.changes[document.uri]) == IN_CELL.replace("BENCH", "DESK")
        made = await client.text_document_rename_async(types.RenameParams(document, ready, "UP"))
        cell = applied(CELL, made.changes[(tmp_path / "cell.toml").as_uri()])
        assert cell == CELL.replace("READY", "UP")
        with pytest.raises(JsonRpcException, match="declared already"):
            await client.text_document_rename_async(types.RenameParams(document, bench, "PART"))
        with pytest.raises(JsonRpcException, match="word of the language"):
            await client.text_document_rename_async(types.RenameParams(document, ready, "HOLD"))

    run(work, capabilities(pull=True))


def test_links_selections_pages_and_lines_that_are_ended(tmp_path: Path):
    (tmp_path / "side.yarc").write_text(SIDE)
    (tmp_path / "cell.toml").write_text(CELL)
    text = (
        "ROBOT INDUSTRIAL6\n"
        "USE SIDE\n"
        'CELL "cell.toml"\n'
        "REPEAT I 2\n"
        "  P0010   MOVJE {TCP} 1 2   3 [50%] ! on\n"
        "END\n"
        "p0020 movej   0 0 0 0 -30 0 [5](deg,s)\n"
        "\n"
    )

    async def work(one: Editor) -> None:
        document = one.open(tmp_path / "job.yarc", text)
        client = one.client
        found = await one.pulled(document)
        typo = next(each for each in found if each.code == "Y0202")
        assert Path(typo.code_description.href.removeprefix("file://")).read_text().startswith("# Y0202 ")
        links = await client.text_document_document_link_async(types.DocumentLinkParams(document))
        assert [(each.range.start.line, each.target.rpartition("/")[2]) for each in links] == [
            (1, "side.yarc"),
            (2, "cell.toml"),
        ]
        (selected,) = await client.text_document_selection_range_async(
            types.SelectionRangeParams(document, [types.Position(4, 18)])
        )
        texts = []
        while selected is not None:
            texts.append((selected.range.start.line, selected.range.start.character, selected.range.end.line))
            selected = selected.parent
        assert texts[0] == (4, 17, 4)
        assert (3, 0, 5) in texts
        assert texts[-1][0] == 0
        options = types.FormattingOptions(2, True)
        edits = await client.text_document_on_type_formatting_async(
            types.DocumentOnTypeFormattingParams(document, types.Position(7, 0), "\n", options)
        )
        assert [edit.new_text for edit in edits] == ["P0020 MOVEJ 0 0 0 0 -30 0 [5] (deg,s)"]
        wrong = types.DocumentOnTypeFormattingParams(document, types.Position(0, 0), "\n", options)
        assert not await client.text_document_on_type_formatting_async(wrong)

    run(work, capabilities(pull=True, pages=True))
