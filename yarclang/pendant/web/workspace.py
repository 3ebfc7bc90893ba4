"""HTTP routes for the workspace: its zones, obstacles and joint limits, drafts of changes of them, checks
of programs with a draft, and distances between bodies.
"""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.messages.workspace import (
    AskDistances,
    CheckShown,
    Distances,
    MakeCell,
    Proposed,
    SavedWorkspace,
    WorkspaceDraft,
    WorkspaceShown,
)
from yarclang.pendant.project.folder import Changed
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.files import other
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of


async def _workspace_shown(service: Service, request: Request) -> Response:
    service.session(request)
    return answer(await service.workspace.shown())


async def _propose(service: Service, request: Request) -> Response:
    service.session(request, Role.PROGRAMMER)
    asked = await body(request, WorkspaceDraft)
    try:
        return answer(await service.workspace.proposed(asked))
    except Changed as changed:
        return other(changed)


async def _save(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    asked = await body(request, WorkspaceDraft)
    try:
        return answer(await service.workspace.save(session, address_of(request), asked))
    except Changed as changed:
        return other(changed)


async def _make(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    asked = await body(request, MakeCell)
    try:
        return answer(await service.workspace.make(session, address_of(request), asked.file))
    except Changed as changed:
        return other(changed)


async def _check(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, WorkspaceDraft)
    try:
        begun = await service.workspace.check(session, asked)
    except Changed as changed:
        return other(changed)
    id_ = session.id
    service.closing.setdefault(id_, set()).add(lambda: service.checks.cancel(id_))
    return answer(begun)


async def _checked(service: Service, request: Request) -> Response:
    return answer(service.checks.shown(service.session(request)))


async def _cancel(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    service.checks.cancel(session.id)
    return answer(service.checks.shown(session))


async def _distances(service: Service, request: Request) -> Response:
    service.session(request)
    asked = await body(request, AskDistances)
    try:
        return answer(await service.workspace.distances(asked.draft))
    except Changed as changed:
        return other(changed)


ROUTES = (
    Route("GET", "/api/workspace", _workspace_shown,
        "Return zones, obstacles and limits as cell.toml and robot.toml have them.", None, WorkspaceShown,
            "viewer"),
    Route("POST", "/api/workspace/draft", _propose,
        "Return what changes make of the files; nothing is written.", WorkspaceDraft, Proposed, "programmer"),
    Route("POST", "/api/workspace/save", _save,
        "Write what changes make of the files: at rest, with the PIN; 409 with the code `changed` if a "
        "file is another one.", WorkspaceDraft, SavedWorkspace, "service"),
    Route("POST", "/api/workspace/cell", _make,
        "Make a cell for a project that has none, and name it in yarc.toml.", MakeCell, SavedWorkspace,
            "service"),
    Route("POST", "/api/workspace/check", _check,
        "Begin to check which programs of the project no longer hold with changes; one check at a time.",
            WorkspaceDraft, CheckShown, "programmer"),
    Route("GET", "/api/workspace/check", _checked, "Return how far the last check is, and what it has found.",
        None, CheckShown, "viewer"),
    Route("DELETE", "/api/workspace/check", _cancel, "End one's own check.", None, CheckShown, "programmer"),
    Route("POST", "/api/workspace/distances", _distances,
        "Return what is nearest to what now, with the bodies of changes if some are given.", AskDistances,
            Distances, "viewer"),
)  # fmt: skip
"""All routes of this file."""
