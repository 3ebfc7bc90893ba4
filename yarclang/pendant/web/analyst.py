"""WebSocket of the analyst, and the words of the language for syntax coloring."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response
from starlette.websockets import WebSocket

from yarclang.highlight.words import words
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.analyst import Analysts
from yarclang.pendant.messages.language import Language
from yarclang.pendant.web.answers import answer
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.pendant.web.sockets import let_in, text_from, until_it_ends
from yarclang.runtime.actions import Trouble

_NO_ROOM = 4409
"""Code with which a WebSocket is closed because the largest number of analysts (language servers) is
running already.
"""


async def analyse(service: Service, analysts: Analysts, socket: WebSocket) -> None:
    """Serve an editor page with a language server of its own, at /api/analyst."""
    session = await let_in(service, socket, Role.PROGRAMMER)
    if session is None:
        return
    try:
        async with analysts.one(socket.send_text) as analyst:

            async def receive() -> None:
                while True:
                    await analyst.take(await text_from(socket))

            await until_it_ends(service, socket, session, analyst.run(), receive())
    except Trouble as trouble:
        await socket.close(_NO_ROOM, trouble.what[:100])


async def _language(service: Service, request: Request) -> Response:
    service.session(request)
    language_words = words()
    return answer(
        Language(
            blocks=language_words.blocks,
            declarations=language_words.declarations,
            commands=language_words.commands,
            suffixes=language_words.suffixes,
            options=language_words.options,
            operators=language_words.operators,
            functions=language_words.functions,
            constants=language_words.constants,
            units=language_words.units,
        )
    )


ROUTES = (
    Route("GET", "/api/language", _language, "Return the words of the language by their kinds.", None,
        Language, "viewer"),
)  # fmt: skip
"""All routes of this file."""
