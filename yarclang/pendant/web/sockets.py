"""The two WebSockets of a page: one for the robot's state and for orders that mustn't wait for a new HTTP
connection, and one for jogs.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable, Coroutine
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from yarclang.coordinator.messages.lines import denied
from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.replies import Denied
from yarclang.pendant.accounts.accounts import NotAllowed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.jogging import JogLine
from yarclang.pendant.messages.jog import LetGo, Press
from yarclang.pendant.messages.reading import read
from yarclang.pendant.watched import Page
from yarclang.pendant.web.robot import order_in
from yarclang.pendant.web.service import Service, address_of
from yarclang.runtime.actions import Trouble

_ENDED = 4401
"""Code with which a WebSocket is closed because its session has ended. Browsers then show the login page."""

_REFUSED = 4403
"""Code with which a WebSocket is closed because its user lacks the required role."""

_BINARY = 1003
"""Code with which a WebSocket is closed because its page has sent a binary message."""

_MOST_WAITING = 8
"""Largest number of orders of one page that are carried out at the same time."""

_LOOKED_EACH = 5.0
"""Time between two checks if the session has ended [s]."""


async def watch(service: Service, socket: WebSocket) -> None:
    """Serve the WebSocket /api/robot of a page: send the robot's state to the page, and carry out the
    page's orders.
    """
    async with contextlib.AsyncExitStack() as leaving:
        session = await let_in(service, socket)
        if session is None:
            return
        page = Page(session.id)
        service.watched.join(page)
        service.gate.page_there(session.id)

        def gone() -> None:
            service.watched.leave(page)
            if not service.watched.pages_of(session.id):
                service.gate.page_gone(session.id)

        leaving.callback(gone)
        carried_out: set[asyncio.Task[None]] = set()

        async def send() -> None:
            while True:
                await socket.send_text(await page.next())

        async def receive() -> None:
            while True:
                text = await text_from(socket)
                if len(carried_out) >= _MOST_WAITING:
                    page.tell(_written(Denied(error="too many orders are pending"), _id(text)))
                    continue
                task = asyncio.create_task(_carried_out(service, socket, session, page, text))
                carried_out.add(task)
                task.add_done_callback(carried_out.discard)

        await until_it_ends(service, socket, session, send(), receive())


async def _carried_out(service: Service, socket: WebSocket, session: Session, page: Page, text: str) -> None:
    id_: int | str | None = None
    try:
        order, id_ = order_in(text.encode())
        if service.accounts.is_over(session):
            raise NotAllowed("this session has ended", "log in again", "login")
        service.accounts.used(session)
        made: Message = await service.gate.order(session, order, address_of(socket))
    except Trouble as trouble:
        made = denied(trouble)
    page.tell(_written(made, id_))


async def jog(service: Service, socket: WebSocket) -> None:
    """Serve the WebSocket /api/jog of a page: move the robot while a button is pressed on the page."""
    session = await let_in(service, socket)
    if session is None:
        return

    async def say(message: Message) -> None:
        await socket.send_text(message.model_dump_json())

    line = JogLine(
        session,
        address_of(socket),
        service.robot,
        service.accounts,
        service.gate,
        service.seats,
        lambda: service.watched.showing.under_way,
        say,
    )

    async def receive() -> None:
        while True:
            text = await text_from(socket)
            try:
                line.take(read(text, LetGo) if '"release"' in text else read(text, Press))
            except Trouble as trouble:
                await say(denied(trouble))

    await until_it_ends(service, socket, session, line.run(), receive())


async def let_in(service: Service, socket: WebSocket, role: Role = Role.VIEWER) -> Session | None:
    """Accept the WebSocket of a page, and check the user's role.

    Args:
        service: state of the pendant.
        socket: WebSocket of the page.
        role: role that the user needs.

    Returns:
        The session of the page. None if nobody is logged in or the role isn't sufficient; the WebSocket is
        then closed already.
    """
    await socket.accept()
    try:
        return service.session(socket, role)
    except NotAllowed as refused:
        await socket.close(_ENDED if refused.code == "login" else _REFUSED, refused.what[:100])
        return None


async def text_from(socket: WebSocket) -> str:
    """Wait for the next message of a page, and return its text. Close the WebSocket if the message is binary.

    Raises:
        WebSocketDisconnect: the page has gone, or its WebSocket was closed.
    """
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message["code"], message.get("reason"))
    text: str | None = message.get("text")
    if text is None:
        await socket.close(_BINARY, "only texts are accepted")
        raise WebSocketDisconnect(_BINARY)
    return text


async def until_it_ends(
    service: Service, socket: WebSocket, session: Session, *work: Coroutine[Any, Any, None]
) -> None:
    """Run coroutines until one of them ends, the page disconnects, or the session ends.

    Args:
        service: state of the pendant.
        socket: WebSocket of the page.
        session: session of the page.
        *work: coroutines to run.
    """
    over = asyncio.Event()
    closing: set[Callable[[], object]] = service.closing.setdefault(session.id, set())
    closing.add(over.set)

    async def looking() -> None:
        while not over.is_set() and not service.accounts.is_over(session):
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(over.wait(), _LOOKED_EACH)

    tasks = [asyncio.create_task(one) for one in (*work, looking())]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        closing.discard(over.set)
        for task in tasks:
            task.cancel()
        for end in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(end, Exception) and not isinstance(end, WebSocketDisconnect | RuntimeError):
                raise end
        if service.accounts.is_over(session) and socket.client_state is WebSocketState.CONNECTED:
            with contextlib.suppress(RuntimeError):
                await socket.close(_ENDED, "this session has ended")


def _written(message: Message, id_: int | str | None) -> str:
    content = message.to_json()
    return json.dumps(content if id_ is None else {"id": id_, **content})


def _id(text: str) -> int | str | None:
    try:
        found = json.loads(text).get("id")
    except (ValueError, AttributeError, RecursionError):
        return None
    return found if isinstance(found, int | str) else None
