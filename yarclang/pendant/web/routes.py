"""A route of the API: what serves it, and what the API's page says of it."""

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
    """One route.

    Attributes:
        method: GET, POST, PUT or DELETE.
        path: with parameters in braces; `{path:path}` takes the rest, with its slashes.
        serve: answers a request, or raises `Trouble`.
        summary: what it does, as a verb phrase.
        body: the message that it takes; None: none.
        answer: the message that it answers with; None: no JSON.
        role: that is needed; empty: nobody has to be logged in.
        most: longest body that it takes [bytes].
    """

    method: str
    path: str
    serve: Serve
    summary: str
    body: type[Message] | None
    answer: type[Message] | None
    role: str
    most: int = MOST_BODY
