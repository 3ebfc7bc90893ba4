"""Tests of each route of the API with requests that no browser sends: without a login, from other sites, with
random bodies. No response is a 5xx, and none hangs.
"""

import asyncio
import json
from itertools import product

import pytest
from coordinator.virtual import run
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.web.app import ROUTES

OPEN = {"/api/me", "/api/first", "/api/login", "/api/logout"}
ENDS = {"/api/system/restart", "/api/system/shut-down", "/api/logout"}
"""Routes that would end the process or the session of the test."""
PATHS = ("a.yarc", "..%2f..%2fetc%2fpasswd", "%00", "x" * 3000, "\u202e", "sub/../a.yarc", "-1", "NaN")
BODIES = (
    b"",
    b"{",
    b"null",
    b"[]",
    b"0",
    b'"x"',
    b"\xff\xfe\x00",
    b"[" * 100_000,
    b'{"a":' * 20_000 + b"1" + b"}" * 20_000,
    b'{"number": 1e999, "file": NaN}',
    b'{"number": ' + b"9" * 10_000 + b"}",
    b'{"file": "\\ud800", "to": "\\u0000"}',
    b"--boundary\r\ncontent-disposition: form-data; name=a\r\n\r\nx\r\n--boundary--",
)


def path_of(route, value="a.yarc"):
    path = route.path
    while "{" in path:
        begin, end = path.index("{"), path.index("}")
        path = path[:begin] + value + path[end + 1 :]
    return path


def at(monkeypatch, tmp_path, work):
    project = tmp_path / "project"
    project.mkdir(exist_ok=True)
    (project / "a.yarc").write_text("P0010 MOVEJ HOME [2] (deg,s)\n")

    async def whole():
        async with pendant(monkeypatch, tmp_path, project=project) as place:
            await work(place)

    run(whole())


async def asked(browser, route, raw=b"{}", value="a.yarc", **options):
    """Send a request, and check that the response comes in time and isn't a 5xx."""
    answer = await asyncio.wait_for(
        browser.ask(route.method, path_of(route, value), raw=raw, **options), 120.0
    )
    assert answer.status < 500, (route.method, route.path, raw[:80], answer.content[:200])
    return answer


def test_nobody_and_other_sites_reach_no_route(monkeypatch, tmp_path):
    async def work(place):
        nobody, forged = place.browser(), place.browser()
        forged.cookies = {"yarc_session": "x" * 10_000}
        anna = place.logged_in("anna")
        anna.session.pin_until = 1e9
        for route in ROUTES:
            if route.path not in OPEN:
                for one in (nobody, forged):
                    assert (await asked(one, route)).status == 401, route.path
            for headers in ((("origin", "http://evil.example"),), (("sec-fetch-site", "cross-site"),)):
                assert (await asked(anna, route, headers=headers)).status == 403, route.path
        assert len({f"{one.method} {one.path}" for one in ROUTES}) == len(ROUTES)

    at(monkeypatch, tmp_path, work)


def test_viewers_reach_only_what_is_theirs(monkeypatch, tmp_path):
    async def work(place):
        ranks = [one.value for one in Role]
        for role in (Role.VIEWER, Role.OPERATOR, Role.PROGRAMMER):
            eve = place.logged_in(role.value, role)
            before = len(place.deeds())
            for route in ROUTES:
                needed = route.role.partition(",")[0]
                if route.path in OPEN or not needed or ranks.index(needed) <= ranks.index(role.value):
                    continue
                example = {} if route.body is None else least(route.body.model_json_schema())
                answer = await asked(eve, route, json.dumps(example).encode())
                assert answer.status in (400, 403), (role, route.path, answer.status)
                # The refusal of a malformed request has less than 1,000 bytes, so it can't contain other
                # data.
                if answer.status == 400:
                    assert len(answer.content) < 1000
            changed = [action for _, action, _, outcome in place.deeds()[before:] if outcome == "done"]
            assert changed == []

    at(monkeypatch, tmp_path, work)


def least(schema, whole=None):
    """Return a small value that a JSON schema allows."""
    whole = whole or schema
    if "$ref" in schema:
        return least(whole["$defs"][schema["$ref"].rpartition("/")[2]], whole)
    for key in ("const", "default"):
        if key in schema:
            return schema[key]
    if "enum" in schema:
        return schema["enum"][0]
    for key in ("anyOf", "oneOf"):
        if key in schema:
            return least(schema[key][0], whole)
    kind = schema.get("type")
    if kind == "object":
        wanted = schema.get("required", ())
        return {
            name: least(one, whole) for name, one in schema.get("properties", {}).items() if name in wanted
        }
    if kind == "array":
        items = schema.get("prefixItems") or [schema.get("items", {})] * schema.get("minItems", 0)
        return [least(one, whole) for one in items]
    return {
        "string": "0" * 64 if "pattern" in schema else "a",
        "integer": 1,
        "number": 1.0,
        "boolean": False,
    }.get(kind)


def test_bodies_that_are_no_message(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        anna.session.pin_until = 1e9
        for route, raw in product(ROUTES, BODIES):
            if route.path in ENDS:
                continue
            kind = (
                (("content-type", "text/plain"),)
                if len(raw) % 2
                else (("content-type", "multipart/form-data"),)
            )
            answer = await asked(anna, route, raw, headers=kind)
            if route.body is not None and raw[:1] not in (b"",) and raw != b"{}":
                assert 400 <= answer.status < 500, (route.path, answer.status)
            anna.session.pin_until = 1e9

    at(monkeypatch, tmp_path, work)


def test_paths_and_queries_by_others(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        for value in PATHS:
            for route in ROUTES:
                if "{" in route.path and route.path not in ENDS:
                    answer = await asked(anna, route, value=value)
                    assert b"root:" not in answer.content
        for query in (
            "?count=-1",
            "?count=x",
            "?before=9" + "9" * 40,
            "?from=nan&to=inf",
            "?logs=%00",
            "?known=..",
            "?a=" + "b" * 5000,
        ):
            for route in ROUTES:
                if route.method == "GET":
                    await asyncio.wait_for(anna.get(path_of(route) + query), 120.0)

    at(monkeypatch, tmp_path, work)


ANY = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)
WITH_BODY = [one for one in ROUTES if one.body is not None and one.path not in ENDS and one.path not in OPEN]


@settings(max_examples=8, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(data=st.data())
def test_messages_by_chance(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("routes")

    async def work(place):
        anna = place.logged_in("anna")
        for route in WITH_BODY:
            anna.session.pin_until = 1e9
            known = route.body.model_json_schema()
            body = least(known)
            for name in known.get("properties", {}):
                if data.draw(st.integers(0, 2)) == 0:
                    body[name] = data.draw(ANY)
            await asked(anna, route, json.dumps(body).encode(), value=data.draw(st.sampled_from(PATHS)))

    with pytest.MonkeyPatch.context() as patch:
        at(patch, folder, work)
