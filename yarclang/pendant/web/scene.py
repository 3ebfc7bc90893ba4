"""HTTP routes for the robot in three dimensions: the scene, its meshes, and the displacements of the links
for given joint positions.
"""

from __future__ import annotations

import asyncio

from starlette.requests import Request
from starlette.responses import Response

from yarclang.pendant.messages.reading import Malformed
from yarclang.pendant.messages.scene import Placements, SceneShown
from yarclang.pendant.scene.scenery import placed
from yarclang.pendant.web.answers import answer, body, refusal
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.runtime.actions import Trouble

_FOR_EVER = "private, max-age=31536000, immutable"
_BYTES = "application/octet-stream"
_DIGITS = 9
"""Largest number of digits of a program number in a request."""


async def _scene(service: Service, request: Request) -> Response:
    session = service.session(request)
    program = request.query_params.get("program")
    if program is None:
        found = await service.scenery.shown(service.watched.attached)
    else:
        found = await service.program_scenes.shown(session, _number(program))
    return answer(found.shown)


def _number(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) <= _DIGITS):
        raise Malformed(
            "program isn't the number of a program", "give the number that `load` has returned", ""
        )
    return int(text)


async def _mesh(service: Service, request: Request) -> Response:
    service.session(request)
    id_ = request.path_params["id"]
    blob = service.scenery.mesh(id_) or service.program_scenes.mesh(id_)
    if blob is None:
        return _missing()
    headers = {"etag": f'"{blob.id}"', "cache-control": _FOR_EVER, "vary": "accept-encoding"}
    if request.headers.get("if-none-match") == headers["etag"]:
        return Response(status_code=304, headers=headers)
    if blob.packed and "gzip" in request.headers.get("accept-encoding", ""):
        return Response(blob.packed, headers={**headers, "content-encoding": "gzip"}, media_type=_BYTES)
    return Response(blob.content, headers=headers, media_type=_BYTES)


def _missing() -> Response:
    made = refusal(Trouble("there is no mesh of this id", "read /api/scene again", ""))
    made.status_code = 404
    return made


async def _placements(service: Service, request: Request) -> Response:
    service.session(request)
    asked = await body(request, Placements)
    try:
        content = await asyncio.to_thread(placed, service.robot, asked)
    except Trouble as trouble:
        raise Malformed(trouble.what, trouble.remedy, "") from None
    return Response(content, headers={"cache-control": "no-store"}, media_type=_BYTES)


ROUTES = (
    Route("GET", "/api/scene", _scene,
        "Return what is to be seen: bodies, zones, parts, frames. With ?program=N those of a program that "
        "this session has loaded, its parts from when to when they are there.", None, SceneShown, "viewer"),
    Route("GET", "/api/scene/mesh/{id}", _mesh,
        "Return a mesh, little endian: V and F (uint32), corners (V x 3 float32) [m], triangles (F x 3 "
        "uint32), normals (V x 3 int8).", None, None, "viewer"),
    Route("POST", "/api/scene/placements", _placements,
        "Return where the links are at N joint positions: float32, (N, n, 7), x y z [m] and the quaternion "
        "x y z w.", Placements, None, "viewer"),
)  # fmt: skip
"""All routes of this file."""
