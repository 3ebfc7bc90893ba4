"""The pendant as an ASGI application: API, sockets and pages."""

from __future__ import annotations

import hashlib
import json
import mimetypes
from collections.abc import Awaitable, Callable, Iterator
from importlib import resources
from importlib.resources.abc import Traversable

from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import BaseRoute, WebSocketRoute
from starlette.routing import Route as Served
from starlette.websockets import WebSocket

from yarclang.pendant.analyst import Analysts
from yarclang.pendant.web import (
    alarms,
    analyst,
    backup,
    calibration,
    controller,
    files,
    health,
    people,
    program,
    robot,
    runs,
    scene,
    signals,
    tools,
    workspace,
)
from yarclang.pendant.web.answers import refusal
from yarclang.pendant.web.guard import BOUND, App, Guard, TooLarge, TooSlow
from yarclang.pendant.web.openapi import document
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.pendant.web.sockets import jog, watch
from yarclang.runtime.actions import Trouble

ROUTES: tuple[Route, ...] = (
    *people.ROUTES,
    *robot.ROUTES,
    *scene.ROUTES,
    *program.ROUTES,
    *analyst.ROUTES,
    *files.ROUTES,
    *calibration.ROUTES,
    *tools.ROUTES,
    *signals.ROUTES,
    *workspace.ROUTES,
    *alarms.ROUTES,
    *runs.ROUTES,
    *controller.ROUTES,
    *backup.ROUTES,
    *health.ROUTES,
)
"""All routes of the API."""

_PAGES = {"/": "index.html", "/api/docs": "docs.html"}
mimetypes.add_type("text/javascript", ".js")
mimetypes.add_type("application/manifest+json", ".webmanifest")


def application(service: Service, names: frozenset[str] = frozenset()) -> App:
    """Return the ASGI application that serves a pendant.

    Args:
        service: state of the pendant.
        names: host names of the server, in addition to this machine's names for itself.
    """
    text = json.dumps(document(ROUTES)).encode()
    analysts = Analysts(service.robot, service.files.folder.root, service.files.folder.path)

    async def openapi(_: Request) -> Response:
        return Response(text, media_type="application/json")

    async def on_robot(socket: WebSocket) -> None:
        await watch(service, socket)

    async def on_jog(socket: WebSocket) -> None:
        await jog(service, socket)

    async def on_analyst(socket: WebSocket) -> None:
        await analyst.analyse(service, analysts, socket)

    routes: list[BaseRoute] = [
        *(Served(one.path, _served(service, one), methods=[one.method]) for one in ROUTES),
        Served("/api/openapi.json", openapi, methods=["GET"]),
        WebSocketRoute("/api/robot", on_robot),
        WebSocketRoute("/api/jog", on_jog),
        WebSocketRoute("/api/analyst", on_analyst),
        *_pages(),
    ]
    return Guard(Starlette(routes=routes), names)


def _served(service: Service, route: Route) -> Callable[[Request], Awaitable[Response]]:
    async def serve(request: Request) -> Response:
        request.scope[BOUND].most = route.most
        try:
            return await route.serve(service, request)
        except Trouble as trouble:
            return refusal(trouble)
        except TooSlow:
            return refusal(Trouble("the request arrives too slowly", "try again", ""))
        except ClientDisconnect:
            return Response(status_code=400)  # nobody receives it
        except TooLarge:
            return refusal(Trouble(f"the request is longer than {route.most:,} bytes", "send less", ""))

    return serve


def _pages() -> list[BaseRoute]:
    """Return a route for each file in `pages/`. No other file is served."""
    files = dict(_files(resources.files("yarclang.pendant") / "pages"))
    places = {f"/{name}": name for name in files if not name.endswith(".html")} | _PAGES
    return [Served(place, _page(name, files[name]), methods=["GET"]) for place, name in places.items()]


def _files(folder: Traversable, path: str = "") -> Iterator[tuple[str, bytes]]:
    """Yield the path and content of each file in a folder and its subfolders."""
    for one in folder.iterdir():
        if one.is_file():
            yield f"{path}{one.name}", one.read_bytes()
        else:
            yield from _files(one, f"{path}{one.name}/")


def _page(name: str, content: bytes) -> Callable[[Request], Awaitable[Response]]:
    tag = f'"{hashlib.sha256(content).hexdigest()[:24]}"'
    kind = mimetypes.guess_type(name)[0] or "application/octet-stream"
    headers = {"etag": tag, "cache-control": "no-cache"}

    async def serve(request: Request) -> Response:
        if request.headers.get("if-none-match") == tag:
            return Response(status_code=304, headers=headers)
        return Response(content, headers=headers, media_type=kind)

    return serve
