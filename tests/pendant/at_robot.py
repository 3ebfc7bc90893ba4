"""Fixtures: a pendant at a simulated robot in virtual time, and browsers that call the pendant's application
without a network.
"""

import asyncio
import contextlib
import json
from dataclasses import dataclass, field

from coordinator.virtual import coordinating

from yarclang.coordinator.attached import Here
from yarclang.pendant.accounts import people
from yarclang.pendant.accounts.database import Database
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.web.app import application
from yarclang.pendant.web.service import Service

HOST = "localhost:8080"


class Inline(Database):
    """Database that writes in the calling thread, because another thread wouldn't run in virtual time."""

    async def call(self, do, *arguments, **named):
        await asyncio.sleep(0)
        return self.now(do, *arguments, **named)


@dataclass
class Answered:
    status: int
    headers: dict
    content: bytes

    @property
    def told(self):
        return json.loads(self.content)


class Socket:
    """A WebSocket of a browser. `code` is the code with which it was closed."""

    def __init__(self, app, path, headers, scheme="ws"):
        self._incoming = asyncio.Queue()
        self._outgoing = asyncio.Queue()
        self.code = None
        scope = scope_of("websocket", path, headers, scheme)
        self._incoming.put_nowait({"type": "websocket.connect"})
        self._task = asyncio.ensure_future(app(scope, self._incoming.get, self._take))

    async def _take(self, message):
        if message["type"] == "websocket.close":
            self.code = message.get("code", 1000)
        self._outgoing.put_nowait(message)

    def say(self, content):
        text = content if isinstance(content, str) else json.dumps(content)
        self._incoming.put_nowait({"type": "websocket.receive", "text": text})

    def say_bytes(self, content):
        self._incoming.put_nowait({"type": "websocket.receive", "bytes": content})

    async def ended(self):
        """Wait until the application has ended with this WebSocket."""
        await asyncio.wait_for(self._task, 30.0)

    async def hear(self):
        """Return the next message; None when the socket is closed."""
        while True:
            message = await asyncio.wait_for(self._outgoing.get(), 30.0)
            if message["type"] == "websocket.close":
                return None
            if message["type"] == "websocket.send":
                return json.loads(message["text"])

    def waiting(self):
        """Return all messages that have arrived and weren't read yet."""
        found = []
        while not self._outgoing.empty():
            message = self._outgoing.get_nowait()
            if message["type"] == "websocket.send":
                found.append(json.loads(message["text"]))
        return found

    async def until(self, wanted):
        """Wait for the next message that fulfils a condition, and return it."""
        while (message := await self.hear()) is not None:
            if wanted(message):
                return message
        raise AssertionError(f"closed with {self.code}")

    async def close(self):
        self._incoming.put_nowait({"type": "websocket.disconnect", "code": 1001})
        with contextlib.suppress(asyncio.CancelledError):
            await self._task


def scope_of(kind, path, headers, scheme, method="GET"):
    path, _, query = path.partition("?")
    return {
        "type": kind,
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "scheme": scheme,
        "path": path,
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "root_path": "",
        "headers": [(name.encode(), value.encode()) for name, value in headers],
        "client": ("127.0.0.1", 40000),
        "server": ("127.0.0.1", 8080),
        "subprotocols": [],
        "state": {},
    }


@dataclass
class Browser:
    """A browser that sends requests. `session` is its user's session; None if nobody is logged in."""

    app: object
    cookies: dict = field(default_factory=dict)
    host: str = HOST
    session: object = None

    def headers(self, extra=()):
        found = [("host", self.host), *extra]
        if self.cookies:
            found.append(("cookie", "; ".join(f"{name}={value}" for name, value in self.cookies.items())))
        return found

    async def ask(self, method, path, body=None, *, headers=(), raw=None, scheme="http"):
        content = raw if raw is not None else b"" if body is None else json.dumps(body).encode()
        sent, given = [], [{"type": "http.request", "body": content, "more_body": False}]

        async def receive():
            return given.pop(0) if given else await asyncio.Future()

        async def send(message):
            sent.append(message)

        await self.app(scope_of("http", path, self.headers(headers), scheme, method), receive, send)
        pairs = [(name.decode(), value.decode()) for name, value in sent[0]["headers"]]
        for name, value in pairs:
            if name == "set-cookie":
                key, _, rest = value.partition("=")
                self.cookies[key] = rest.partition(";")[0]
        return Answered(sent[0]["status"], dict(pairs), b"".join(one.get("body", b"") for one in sent[1:]))

    async def post(self, path, body=None, **options):
        return await self.ask("POST", path, body or {}, **options)

    async def get(self, path, **options):
        return await self.ask("GET", path, **options)

    async def order(self, word, **fields):
        return await self.post(f"/api/orders/{word}", fields)

    def socket(self, path, headers=()):
        return Socket(self.app, path, self.headers(headers))


@dataclass
class Pendant:
    """A pendant: its application, its service, the coordinator, and the simulated world of its robot."""

    app: object
    service: Service
    coordinator: object
    world: object

    def browser(self):
        return Browser(self.app)

    def logged_in(self, user, role=Role.SERVICE):
        """Return a browser in which a user is logged in, without checking a password, since this takes real
        time.
        """
        accounts = self.service.accounts
        if accounts.database.now(people.user_called, user) is None:
            accounts.database.now(people.add_user, people.User(user, role, "none", None))
            accounts.first = ""
        now = asyncio.get_running_loop().time()
        session, token = accounts.sessions.open(user, role, "127.0.0.1", "a test", now)
        return Browser(self.app, {"yarc_session": token}, session=session)

    def deeds(self):
        """Return all entries of the audit trail as (user, action, detail, outcome), oldest first."""
        found = self.service.accounts.database.now(people.deeds, None, 1000)
        return [(deed.user, deed.action, deed.detail, deed.outcome) for _, _, deed in reversed(found)]

    def slow_disk(self, monkeypatch, seconds):
        """Let each change of the database take a time."""
        database = self.service.accounts.database
        call = database.call

        async def slow(do, *arguments, **named):
            await asyncio.sleep(seconds)
            return await call(do, *arguments, **named)

        monkeypatch.setattr(database, "call", slow)


@contextlib.asynccontextmanager
async def pendant(monkeypatch, folder, *, project=None, **options):
    """Serve a pendant. The coordinator's initial owner gives up the robot, so that a user can
    take control.
    """
    monkeypatch.setattr("yarclang.pendant.accounts.accounts.Database", Inline)

    async def inline(function, *arguments):
        return function(*arguments)

    monkeypatch.setattr(asyncio, "to_thread", inline)
    project = project or folder
    async with coordinating(folder=project, **options) as (world, coordinator, client):
        client.session.leave()

        async def attach(name):
            return Here(coordinator, name)

        clock = asyncio.get_running_loop().time
        monkeypatch.setattr("yarclang.pendant.web.service.time.monotonic", clock)
        service = Service.opened(world.robot, attach, project, folder / "pendant.db")
        service.accounts._now = clock
        await service.watched.start()
        watching = asyncio.ensure_future(service.watched.run())
        try:
            await asyncio.sleep(0.1)
            yield Pendant(application(service), service, coordinator, world)
        finally:
            watching.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await watching
            service.backups.forget()
            await service.checks.close()
            await service.watched.stop()
            await service.alarms.close()
            await service.accounts.close()
