"""Code lenses, and the commands of the server: inspection of a command, and picture of a program.

`yarc.inspect` has a text's URI and a line (from 1) as arguments, and returns `{"text": ..., "path": ...}`:
the output of `yarc inspect` and a file with it. `yarc.plot` has the URI as argument, and returns
`{"path": ...}`, the picture of `yarc plot` as SVG. Clients that can show a file are asked to show it.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from lsprotocol import types

from yarclang.assist.motions import first_motion
from yarclang.assist.view import View
from yarclang.lsp.feature import Feature
from yarclang.lsp.positions import range_of
from yarclang.motion.plan import MotionPlan
from yarclang.source import Span

if TYPE_CHECKING:
    from yarclang.lsp.analyses import Analysis
    from yarclang.lsp.server import Server

INSPECT = "yarc.inspect"
PLOT = "yarc.plot"


# Lenses.


def _lenses(server: Server, params: types.CodeLensParams) -> list[types.CodeLens]:
    uri = params.text_document.uri
    view = server.program_view(uri)
    if view is None:
        return []
    plan = view.checked.plan if view.checked else None
    lenses = []
    if plan is not None and plan.motions:
        title = f"plot {len(plan.motions):,} motion{'s' * (len(plan.motions) != 1)}, {plan.lasting.text()}"
        lenses.append(_lens(server, view, 1, title, PLOT, [uri]))
    for line in _heads(view):
        statement = view.sketch.statement_at(line)
        index = statement.index.name if statement and statement.index else "this command"
        lenses.append(_lens(server, view, line, f"inspect {index}", INSPECT, [uri, line]))
    return lenses


def _heads(view: View) -> list[int]:
    """Return the line of the first motion of each paragraph, for code lenses (clickable lines between the
    program's lines). Lenses above all motions would hide the program.
    """
    found, has_lens = [], False
    for one in view.sketch.module.statements:
        above = view.sketch.source.line(one.line - 1).strip()
        if one.index is None or not above:
            has_lens = False
        if not has_lens and first_motion(view, view.steps_in(one.line)) is not None:
            found.append(one.line)
            has_lens = True
    return found


def _lens(
    server: Server, view: View, line: int, title: str, command: str, arguments: list[Any]
) -> types.CodeLens:
    range_ = range_of(view.sketch.source, Span.on_line(line, 1, 1), server.encoding)
    return types.CodeLens(range_, types.Command(title=title, command=command, arguments=arguments))


# Commands.


async def _inspect(server: Server, *arguments: Any) -> dict[str, str] | None:
    uri, line = _arguments(arguments)
    analysis = await server.analyses.whole(uri, None)
    view = server.program_view(uri)
    if view is None or analysis is None:
        _told(server, "the program isn't open")
        return None
    text = await server.answer(uri, _inspection, view, line)
    if not text:
        _told(server, f"line {line} has no valid command")
        return None
    path = server.files / f"{Path(view.sketch.source.name).stem}_{line}.txt"
    path.write_text(text, encoding="utf-8")
    _show(server, path)
    return {"text": text, "path": str(path)}


def _inspection(view: View, line: int) -> str:
    """Return the output of `yarc inspect`."""
    from yarclang.report.inspection.inspected import Studied, inspect_step
    from yarclang.report.inspection.text import sections_of

    steps, checked = view.steps_in(line), view.checked
    if not steps or checked is None or checked.opened is None or checked.program is None:
        return ""
    studied = Studied(checked.program, checked.opened.request, checked.compiled, checked.diagnostics)
    sections = sections_of(inspect_step(studied, steps[0]))
    return (
        "\n\n".join("\n".join((one.title, *(f"  {line}" for line in one.lines))) for one in sections) + "\n"
    )


async def _plot(server: Server, *arguments: Any) -> dict[str, str] | None:
    uri, _ = _arguments(arguments)
    analysis = await server.analyses.whole(uri, None)
    plan = analysis.checked.plan if analysis else None
    if analysis is None or plan is None or not plan.motions:
        _told(server, "there is nothing to draw: the program has errors, or no motion")
        return None
    path = server.files / f"{Path(analysis.document.source.name).stem}.svg"
    await server.answer(uri, _draw, plan, path)
    _show(server, path)
    return {"path": str(path)}


def _draw(plan: MotionPlan, path: Path) -> None:
    from yarclang.report.pictures.plot import draw

    path.write_bytes(draw(plan, "svg"))


def _arguments(arguments: tuple[Any, ...]) -> tuple[str, int]:
    """Return URI and line from the client's arguments, which may have any type."""
    uri = arguments[0] if arguments and isinstance(arguments[0], str) else ""
    line = arguments[1] if len(arguments) > 1 and isinstance(arguments[1], int | float) else 1
    return uri, int(line)


def _told(server: Server, message: str) -> None:
    """Show the user the reason why there is no result."""
    server.window_show_message(types.ShowMessageParams(types.MessageType.Warning, message))


def _show(server: Server, path: Path) -> None:
    """Ask the client to show a file, if it can."""
    window = server.client_capabilities.window
    if window and window.show_document and window.show_document.support and server.shows_documents:
        server.window_show_document(types.ShowDocumentParams(path.as_uri(), take_focus=False))


def _arrived(server: Server, analysis: Analysis) -> None:
    """Ask a client to request its lenses again, since motions are planned now."""
    workspace = server.client_capabilities.workspace
    refresh = workspace.code_lens if workspace else None
    if analysis.is_whole and refresh and refresh.refresh_support:
        server.workspace_code_lens_refresh(None)


FEATURE = Feature(
    {types.TEXT_DOCUMENT_CODE_LENS: (_lenses, types.CodeLensOptions())},
    commands={INSPECT: _inspect, PLOT: _plot},
    listens=_arrived,
)
