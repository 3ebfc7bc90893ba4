"""HTTP routes for logs of runs: their list, their content, and downloads."""

from __future__ import annotations

import asyncio
import math
import os
from contextlib import AbstractContextManager, ExitStack
from typing import cast

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from yarclang.coordinator.messages import orders
from yarclang.pendant.messages.reading import Malformed
from yarclang.pendant.messages.runs import Place, RunList, RunShown
from yarclang.pendant.runs.shown import Window
from yarclang.pendant.web.answers import answer, refusal
from yarclang.pendant.web.files import disposition, pieces
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.runtime.actions import Trouble

_MISSING = "missing"


async def _list(service: Service, request: Request) -> Response:
    service.session(request)
    written = ""
    try:
        status = await service.watched.attached.ask(orders.AskStatus())
        written = (status.log or "").rpartition("/")[2]
    except Trouble:
        pass  # logs are listed without the robot, too
    return answer(await asyncio.to_thread(service.runs.listed, written))


async def _show(service: Service, request: Request) -> Response:
    service.session(request)
    window = _window(request)
    with ExitStack() as opening:
        try:
            handle, told, _ = await asyncio.to_thread(opening.enter_context, _opened(service, request))
        except Trouble as trouble:
            return _missing(trouble)
        content = await service.readings.shown(handle, told, window)
    service.session(request)
    return Response(content, headers={"cache-control": "no-store"}, media_type="application/json")


async def _download(service: Service, request: Request) -> Response:
    service.session(request)
    opening = ExitStack()
    try:
        handle, status, name = await asyncio.to_thread(opening.enter_context, _opened(service, request))
    except Trouble as trouble:
        return _missing(trouble)
    headers = {
        "content-disposition": disposition(name),
        "content-length": str(status.st_size),
        "cache-control": "no-store",
    }
    content = pieces(opening, handle, status.st_size)
    return StreamingResponse(content, headers=headers, media_type="application/octet-stream")


def _opened(service: Service, request: Request) -> AbstractContextManager[tuple[int, os.stat_result, str]]:
    place, file = request.path_params["place"], request.path_params["path"]
    if place not in ("project", "logs"):
        raise Trouble("there is no such log", "look at the list of runs", _MISSING)
    return service.log_folders.opened(cast("Place", place), file)


def _missing(trouble: Trouble) -> Response:
    made = refusal(trouble)
    if trouble.code == _MISSING:
        made.status_code = 404
    return made


def _window(request: Request) -> Window | None:
    given = [request.query_params.get(name) for name in ("from", "to")]
    if given == [None, None]:
        return None
    try:
        begin, end = (round(float(one or "nan"), 3) for one in given)
    except ValueError:
        begin = end = math.nan
    if not -1e9 < begin < end < 1e9:
        raise Malformed("from and to aren't two times in s, the first one earlier", "see the API's page", "")
    return begin, end


ROUTES = (
    Route("GET", "/api/runs", _list,
        "Return the logs of runs, up to 1,000, those that were changed last first.", None, RunList, "viewer"),
    Route("GET", "/api/runs/show/{place}/{path:path}", _show,
        "Return what a log shows: lines, signals, states, events and the way of the robot (?from=&to=: "
        "lines of this time only [s]).", None, RunShown, "viewer"),
    Route("GET", "/api/runs/download/{place}/{path:path}", _download, "Return a log to be saved.", None, None,
        "viewer"),
)  # fmt: skip
"""All routes of this file."""
