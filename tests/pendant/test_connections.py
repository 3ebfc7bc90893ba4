"""Tests of connections whose clients send nothing, only parts of requests, or are too many."""

import asyncio
import contextlib
import json
import socket
import sys

import pytest
import uvicorn
from pendant.process import first, serving

from yarclang.pendant.web import connection
from yarclang.pendant.web.connection import MOST, MOST_OF_ONE, Connection

HEAD = b"GET / HTTP/1.1\r\nHost: localhost\r\n"
POST = b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10\r\n\r\n"


async def app(scope, receive, send):
    """Answer after the whole body has arrived; a WebSocket after its first message."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept"})
        await receive()
        await send({"type": "websocket.send", "text": "heard"})
        return
    if scope["path"] == "/refused":
        pass
    elif scope["path"] == "/slow":
        await asyncio.sleep(1.0)
    else:
        while (await receive()).get("more_body"):
            pass
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"2")]})
    await send({"type": "http.response.body", "body": b"ok"})


@contextlib.asynccontextmanager
async def served(monkeypatch, patience):
    """Serve `app` with the pendant's connections. Yield the port."""
    monkeypatch.setattr(connection, "PATIENCE", patience)
    config = uvicorn.Config(app, http=Connection, ws="websockets-sansio", lifespan="off", log_config=None)
    server = uvicorn.Server(config)
    server.capture_signals = contextlib.nullcontext
    with socket.create_server(("127.0.0.1", 0)) as listener:
        serving = asyncio.create_task(server.serve([listener]))
        try:
            yield listener.getsockname()[1]
        finally:
            server.should_exit = True
            await serving


@pytest.mark.parametrize(
    "pieces",
    [
        [],
        [HEAD],
        [HEAD, *[b"x: y\r\n"] * 10],
        [HEAD + b"\r\n", HEAD, *[b"x: y\r\n"] * 10],
        [POST.replace(b"/ ", b"/refused ", 1), *[b"x"] * 9],
    ],
)
def test_a_request_that_doesnt_arrive_ends_its_connection(monkeypatch, pieces):
    async def work():
        async with served(monkeypatch, 0.4) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            for piece in pieces:
                writer.write(piece)
                await asyncio.sleep(0.1)
            with contextlib.suppress(ConnectionError):
                await asyncio.wait_for(reader.read(), 3.0)
            writer.close()

    asyncio.run(work())


def test_what_is_under_way_doesnt_end(monkeypatch):
    async def work():
        from websockets.asyncio.client import connect

        async with served(monkeypatch, 0.4) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            for request in (HEAD.replace(b"/ ", b"/slow ", 1) + b"\r\n", POST):
                writer.write(request)
                await asyncio.sleep(0.6)
                if request is POST:
                    writer.write(b"0123456789")
                assert b"200 OK" in await reader.readuntil(b"ok")
            writer.close()
            async with connect(f"ws://127.0.0.1:{port}/") as page:
                await asyncio.sleep(0.6)
                await page.send("hello")
                assert await page.recv() == "heard"

    asyncio.run(work())


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has all addresses of 127.0.0.0/8")
def test_one_address_doesnt_keep_others_from_the_pendant(tmp_path):
    with serving(tmp_path) as (url, token, _), contextlib.ExitStack() as leaving:
        port = int(url.rstrip("/").rpartition(":")[2])
        anna = first(url, token)
        for _ in range(MOST + 20):
            idle = socket.create_connection(("127.0.0.1", port), 5.0, ("127.0.0.2", 0))
            leaving.enter_context(idle)
        assert anna.order("stop")["ok"]
        with anna.socket("/api/robot") as page:
            page.send('{"order": "status", "id": 1}')
            while json.loads(page.recv(timeout=5)).get("id") != 1:
                pass
        assert MOST_OF_ONE < MOST
