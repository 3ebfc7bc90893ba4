"""Tests of the security checks that precede each request: host name, origin, size and role."""

import asyncio
from importlib import resources
from pathlib import Path

import pytest
from coordinator.virtual import run
from pendant.at_robot import Browser, pendant, scope_of

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.web.app import ROUTES
from yarclang.pendant.web.guard import MOST_BODY

PAGES = Path(str(resources.files("yarclang.pendant") / "pages"))
ORIGIN = ("origin", "http://localhost:8080")
FOREIGN = [
    (("origin", "http://evil.example"),),
    (("origin", "http://localhost:9090"),),
    (("origin", "https://localhost:8080"),),
    (("origin", "null"),),
    (ORIGIN, ("origin", "http://evil.example")),
    (("sec-fetch-site", "cross-site"),),
    (("sec-fetch-site", "same-site"),),
    (ORIGIN, ("sec-fetch-site", "cross-site")),
]


def at(monkeypatch, tmp_path, work):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            await work(place)

    run(whole())


def test_pages_of_other_sites_are_refused(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        for headers in FOREIGN:
            answered = await anna.post("/api/orders/own", {}, headers=headers)
            assert (answered.status, "other sites" in answered.told["error"]) == (403, True), headers
            for path in ("/api/robot", "/api/jog"):
                socket = anna.socket(path, headers)
                assert await socket.hear() is None
                assert socket.code == 4403
        assert place.coordinator.owner == ""
        assert (await anna.post("/api/orders/own", {}, headers=[ORIGIN])).status == 200

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    "host",
    [
        "evil.example:8080",
        "localhost:9090",
        "localhost",
        "",
        "localhost:8080@evil.example",
        "127.0.0.1:8080\t",
    ],
)
def test_other_names_are_refused(monkeypatch, tmp_path, host):
    """Requests to another host name are refused: another site may let its name point to this computer."""

    async def work(place):
        anna = place.logged_in("anna")
        anna.host = host
        for path in ("/", "/api/me", "/app.js"):
            assert (await anna.get(path)).status == 403
        socket = anna.socket("/api/robot")
        assert await socket.hear() is None

    at(monkeypatch, tmp_path, work)


def test_a_link_elsewhere_may_lead_here(monkeypatch, tmp_path):
    async def work(place):
        browser = Browser(place.app)
        assert (await browser.get("/", headers=[("sec-fetch-site", "cross-site")])).status == 200
        assert (await browser.get("/api/me", headers=[("sec-fetch-site", "cross-site")])).status == 403

    at(monkeypatch, tmp_path, work)


def test_every_answer_forbids_what_comes_from_elsewhere(monkeypatch, tmp_path):
    async def work(place):
        browser = Browser(place.app)
        for path in ("/", "/app.js", "/api/me", "/api/docs", "/nothing"):
            answered = await browser.get(path)
            policy = answered.headers["content-security-policy"]
            assert "default-src 'none'" in policy
            assert "unsafe" not in policy
            assert answered.headers["x-content-type-options"] == "nosniff"
        secure = await browser.get("/", scheme="https", headers=[])
        assert "max-age" in secure.headers["strict-transport-security"]

    at(monkeypatch, tmp_path, work)


def test_no_page_loads_anything_from_elsewhere():
    # The two bundled libraries aren't searched. Their requests are checked in a real browser, by the content
    # security policy.
    own = [one for one in PAGES.rglob("*") if one.is_file() and one.parent.name != "bundles"]
    assert len(own) > 10
    for one in own:
        # The SVG namespace is only a name; nothing is loaded from it.
        text = one.read_text().replace('"http://www.w3.org/2000/svg"', "")
        for word in (
            "http://",
            "https://",
            "//cdn",
            "innerHTML",
            "outerHTML",
            "insertAdjacentHTML",
            "eval(",
            "document.write",
            "<script>",
        ):
            allowed = one.name == "docs.js" and word == "http://"  # the address in the example of a client
            assert word not in text or allowed, (one.name, word)
        assert ' style="' not in text


def test_nothing_is_told_to_whoever_isnt_logged_in(monkeypatch, tmp_path):
    async def work(place):
        browser = Browser(place.app)
        tried = 0
        for route in ROUTES:
            if not route.role:
                continue
            answered = await browser.ask(
                route.method, route.path.replace("{user}", "anna").replace("{session}", "x"), {}
            )
            assert answered.status == 401, route.path
            tried += 1
        assert tried > 30
        for path in ("/api/robot", "/api/jog"):
            socket = browser.socket(path)
            assert await socket.hear() is None
            assert socket.code == 4401

    at(monkeypatch, tmp_path, work)


def test_cookies_are_for_this_server_alone(monkeypatch, tmp_path):
    monkeypatch.setattr("yarclang.pendant.accounts.accounts.hashed", lambda secret: f"hash of {secret}")
    monkeypatch.setattr(
        "yarclang.pendant.accounts.accounts.is_secret", lambda kept, secret: kept == f"hash of {secret}"
    )

    async def work(place):
        async def beside(function, *arguments):
            return function(*arguments)

        monkeypatch.setattr(place.service.accounts, "_beside", beside)
        browser = Browser(place.app)
        first = {
            "token": place.service.accounts.first,
            "user": "anna",
            "password": "correct horse",
            "pin": "4711",
        }
        answered = await browser.post("/api/first", first, scheme="https")
        assert answered.status == 200, answered.told
        assert set(browser.cookies) == {"__Host-yarc_session", "__Host-yarc_device"}
        cookie = answered.headers["set-cookie"].lower()
        assert all(word in cookie for word in ("httponly", "secure", "samesite=strict", "path=/"))
        assert "domain" not in cookie

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    "raw",
    [
        b"{",
        b"[]",
        b"null",
        b"\xff",
        b"[" * 100_000,
        b'{"user": 1}',
        b'{"user": "a", "password": "b", "more": 1}',
        b"x" * (MOST_BODY + 1),
    ],
)
def test_bodies_that_arent_understood(monkeypatch, tmp_path, raw):
    async def work(place):
        place.logged_in("anna")
        answered = await Browser(place.app).post("/api/login", raw=raw)
        assert answered.status in (400, 409)
        assert answered.told["error"]

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("path", ["/api/robot", "/api/jog", "/api/analyst"])
def test_binary_messages_close_a_socket(monkeypatch, tmp_path, path):
    async def work(place):
        socket = place.logged_in("anna").socket(path)
        socket.say_bytes(b'{"order": "status"}')
        while await socket.hear() is not None:
            pass
        assert socket.code == 1003
        await socket.ended()

    at(monkeypatch, tmp_path, work)


def test_a_browser_that_dies_within_its_request(monkeypatch, tmp_path):
    """Nothing is done, and no exception reaches the server, which would print it."""

    async def work(place):
        anna = place.logged_in("anna")
        arrives = [
            {"type": "http.request", "body": b'{"order"', "more_body": True},
            {"type": "http.disconnect"},
        ]
        sent = []

        async def receive():
            return arrives.pop(0)

        async def send(message):
            sent.append(message)

        for path in ("/api/orders/own", "/api/login"):
            left, sent[:] = list(arrives), []
            await place.app(scope_of("http", path, anna.headers(), "http", "POST"), receive, send)
            assert sent[0]["status"] == 400
            arrives[:] = left
        assert place.coordinator.owner == ""

    at(monkeypatch, tmp_path, work)


def test_a_body_that_doesnt_arrive(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        clock = asyncio.get_running_loop().time
        for gap, within in ((40.0, 31.0), (5.0, 66.0)):
            begun, sent = clock(), []

            async def receive(gap=gap):
                await asyncio.sleep(gap)
                return {"type": "http.request", "body": b" ", "more_body": True}

            async def send(message, sent=sent):
                sent.append(message)

            await place.app(scope_of("http", "/api/login", anna.headers(), "http", "POST"), receive, send)
            assert sent[0]["status"] == 409
            assert b"too slowly" in sent[1]["body"]
            assert clock() - begun <= within

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("role", [Role.VIEWER, Role.OPERATOR, Role.PROGRAMMER])
def test_every_route_checks_the_role(monkeypatch, tmp_path, role):
    """A user sends requests to all routes. Those that need a higher role are refused, and change nothing."""

    async def work(place):
        place.logged_in("anna")
        eve = place.logged_in("eve", role)
        refused = 0
        for route in ROUTES:
            wanted = route.role.split(",")[0]
            path = route.path.replace("{user}", "anna").replace("{session}", "nobody")
            if not wanted or role.covers(Role(wanted)) or path == "/api/logout":
                continue
            body = (
                {"user": "mallory", "role": "service", "password": "correct horse", "pin": "4711"}
                if path == "/api/users"
                else {}
            )
            answered = await eve.ask(route.method, path, body)
            # The body may be refused as malformed before the role is checked.
            assert answered.status in (400, 403), (route.path, answered.status)
            refused += answered.status == 403
        assert refused >= {Role.VIEWER: 20, Role.OPERATOR: 15, Role.PROGRAMMER: 5}[role]
        assert place.coordinator.owner == ""
        assert {one.name for one in await place.service.accounts.all_users()} == {"anna", "eve"}

    at(monkeypatch, tmp_path, work)


def test_a_viewer_who_forges_every_message_moves_nothing(monkeypatch, tmp_path):
    async def work(place):
        from yarclang.coordinator.messages import orders, wants

        eve = place.logged_in("eve", Role.VIEWER)
        socket = eve.socket("/api/robot")
        before = place.world.stands()
        words = [kind.model_fields["order"].default for kind in orders.KINDS]
        for number, word in enumerate(words):
            for extra in (
                {},
                {"percent": 50},
                {"text": "SET A ON"},
                {"offer": 1},
                {"program": 1},
                {"file": "a.yarc"},
                {"name": "M1", "value": 1},
            ):
                socket.say({"order": word, "id": number, **extra})
                answer = await socket.until(lambda message: "ok" in message)
                if answer["ok"]:
                    assert word in (
                        "status",
                        "where",
                        "frames",
                        "health",
                        "surroundings",
                        "read",
                        "declarations",
                        "parts",
                        "model",
                        "scene",
                        "stop",
                    ), word
        for kind in wants.KINDS:
            socket.say({kind.key: [0] * 6})
            assert not (await socket.until(lambda message: "ok" in message))["ok"]
        assert place.coordinator.owner == ""
        assert (place.world.stands() == before).all()
        await socket.close()
        await asyncio.sleep(0.1)

    at(monkeypatch, tmp_path, work)
