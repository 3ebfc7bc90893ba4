"""Replies of the API as JSON, and bodies of requests as typed messages."""

from __future__ import annotations

from typing import TypeVar

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages.lines import denied
from yarclang.coordinator.messages.message import Message
from yarclang.pendant.accounts.accounts import NotAllowed, TooMany
from yarclang.pendant.messages.reading import Malformed, read
from yarclang.runtime.actions import Trouble

M = TypeVar("M", bound=Message)


def answer(message: Message, status: int = 200) -> Response:
    """Return a message as a response that browsers don't cache."""
    headers = {"cache-control": "no-store"}
    return Response(message.model_dump_json(), status, headers, media_type="application/json")


def refusal(trouble: Trouble) -> Response:
    """Return the HTTP response for an error. Its status is 400 for a malformed request, 401 if nobody is
    logged in, 403 for missing rights, 429 for too many login attempts, otherwise 409.
    """
    status = 409
    if isinstance(trouble, Malformed):
        status = 400
    elif isinstance(trouble, NotAllowed):
        status = 401 if trouble.code == "login" else 403
    elif isinstance(trouble, TooMany):
        status = 429
    made = answer(denied(trouble), status)
    if isinstance(trouble, TooMany):
        made.headers["retry-after"] = f"{max(1.0, trouble.wait):.0f}"
    return made


async def body(request: Request, kind: type[M]) -> M:
    """Parse the body of a request as a message of the given type.

    Raises:
        Malformed: the body isn't a message of this type.
    """
    return read(await request.body(), kind)


def number_in(request: Request, name: str) -> int | None:
    """Return a non-negative integer from the query part of a request's URL; None if the query has no such
    parameter.

    Raises:
        Malformed: the value isn't a non-negative integer.
    """
    text = request.query_params.get(name)
    if text is None:
        return None
    if not text.isascii() or not text.isdigit() or len(text) > 15:
        raise Malformed(f"{name} is {text[:40]!r}; it may be an integer from 0", "see the API's page", "")
    return int(text)
