"""Routes of the API, with their descriptions."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages.message import Message
from yarclang.pendant.web.guard import MOST_BODY

if TYPE_CHECKING:
    from yarclang.pendant.web.service import Service

Serve = Callable[["Service", Request], Awaitable[Response]]


@dataclass(frozen=True, slots=True)
class Route:
    """A route of the API.

    Attributes:
        method: GET, POST, PUT or DELETE.
        path: path with parameters in braces; `{path:path}` matches the rest of the path, including slashes.
        serve: function that returns the response to a request, or raises `Trouble`.
        summary: description of the route, which begins with a verb.
        body: type of the message in the body of the request; None if it has no body.
        answer: type of the message in the body of the response; None if the response isn't JSON.
        role: role that the user needs; empty if no login is needed.
        most: longest body of a request [bytes].
    """

    method: str
    path: str
    serve: Serve
    summary: str
    body: type[Message] | None
    answer: type[Message] | None
    role: str
    most: int = MOST_BODY
