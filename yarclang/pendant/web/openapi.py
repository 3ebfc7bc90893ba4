"""OpenAPI 3.1 document of the API, generated from the routes and from the types of their messages."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pydantic.json_schema import models_json_schema

import yarclang
from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Denied
from yarclang.pendant.messages.display import Beat, Display, Notice
from yarclang.pendant.messages.jog import Jogging, LetGo, Press
from yarclang.pendant.web.routes import Route

_PLACE = "#/components/schemas/{model}"

_SAID = (Display, Notice, Beat, Jogging)
_HEARD = (Press, LetGo)
_EVENTS = (
    events.StateChanged,
    events.Found,
    events.Told,
    events.OwnerChanged,
    events.OverrideChanged,
    events.Began,
    events.PartBegan,
    events.Paused,
    events.Finished,
    events.Missed,
)

_SOCKETS = """
WebSockets carry a JSON object a message; all need the cookie of a session.

**/api/robot** tells: `Display` at once and then at most 20 times a second, if something has changed; the coordinator's events (`StateChanged`, `Began`, `Finished`, ...) as they happen; `Notice`.
It takes the orders of /api/orders as `{"order": "stop", "id": 1}`, and answers each with its reply or `Denied` and the same `id`.

**/api/jog** moves the robot as long as something is pressed. It tells `Beat` 20 times a second, and `Jogging`. It takes `Press`, said 20 times a second as long as something is pressed, and `LetGo`.
A press without a fresh message for 0.2 s ends, and the robot rests on its path.

**/api/analyst** is a language server for one page that edits (role programmer): JSON-RPC 2.0 with the messages of LSP 3.17, a JSON object each without a head.
Pages may ask initialize, completion, hover, signatureHelp, codeAction, formatting and semanticTokens, and tell initialized, didOpen, didChange, didClose and cancelRequest, with these parameters and no others; files are called `yarc:///folder/name.yarc`.
It tells publishDiagnostics, `yarc/begun` (each time before initialize), `yarc/refused` (why a message wasn't handed on), and `yarc/ended`. At most 4 serve at once: then the socket is closed with the code 4409; with 4403 for other roles.

A socket is closed with the code 4401 if nobody is logged in, or the session has ended.
"""  # noqa: E501


def document(routes: Iterable[Route]) -> dict[str, Any]:
    """Return the OpenAPI document."""
    kept_routes = tuple(routes)
    models: dict[type[Message], None] = dict.fromkeys((Denied, *_SAID, *_HEARD, *_EVENTS))
    for route in kept_routes:
        models.update(dict.fromkeys(one for one in (route.body, route.answer) if one is not None))
    _, schemas = models_json_schema([(model, "serialization") for model in models], ref_template=_PLACE)
    paths: dict[str, dict[str, Any]] = {}
    for route in kept_routes:
        paths.setdefault(_plain(route.path), {})[route.method.lower()] = _operation(route)
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "YARC pendant",
            "version": yarclang.__version__,
            "description": "Everything that the pendant's pages do, they do by way of this." + _SOCKETS,
        },
        "paths": paths,
        "components": {
            "schemas": schemas.get("$defs", {}),
            "securitySchemes": {
                "session": {
                    "type": "apiKey",
                    "in": "cookie",
                    "name": "yarc_session",
                    "description": "Set by /api/login; over TLS its name is __Host-yarc_session.",
                }
            },
        },
        "x-websockets": {
            "/api/robot": {"tells": _names((*_SAID[:2], *_EVENTS)), "takes": ["the orders of /api/orders"]},
            "/api/jog": {"tells": _names(_SAID[2:]), "takes": _names(_HEARD)},
        },
    }


def _operation(route: Route) -> dict[str, Any]:
    operation: dict[str, Any] = {
        "summary": route.summary,
        "description": f"Role: {route.role}." if route.role else "Nobody has to be logged in.",
        "operationId": f"{route.method.lower()}{re.sub(r'[^a-z]+', '_', _plain(route.path))}".strip("_"),
        "responses": {
            "200": _content(route.answer, "Done.") if route.answer else {"description": "Done."},
            "default": _content(Denied, "Not done, and why."),
        },
    }
    if parameters := re.findall(r"\{(\w+)\}", _plain(route.path)):
        operation["parameters"] = [
            {"name": one, "in": "path", "required": True, "schema": {"type": "string"}} for one in parameters
        ]
    if route.body is not None:
        operation["requestBody"] = {"required": True, **_content(route.body, "")}
    if route.role:
        operation["security"] = [{"session": []}]
    return operation


def _plain(path: str) -> str:
    """Return a route's path in the syntax of OpenAPI."""
    return path.replace(":path}", "}")


def _content(model: type[Message], description: str) -> dict[str, Any]:
    made = {"content": {"application/json": {"schema": {"$ref": _PLACE.format(model=model.__name__)}}}}
    return {"description": description, **made} if description else made


def _names(models: Iterable[type[Message]]) -> list[str]:
    return [one.__name__ for one in models]
