"""Tests of the project's files through the API: roles, the audit trail, uploads, downloads."""

import asyncio
import gc
import hashlib
import os
import resource

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant, scope_of

from yarclang.pendant import filing
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.web.files import disposition

TEXT = "P0010 MOVEJ HOME [2] (deg,s)\n"


def at(monkeypatch, tmp_path, work):
    project = tmp_path / "project"
    project.mkdir()

    async def whole():
        async with pendant(monkeypatch, tmp_path / "state", project=project) as place:
            await work(place, project)

    (tmp_path / "state").mkdir()
    run(whole())


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def test_a_text_from_the_first_save_to_its_return(monkeypatch, tmp_path):
    async def work(place, project):
        pia, vic = place.logged_in("pia", Role.PROGRAMMER), place.logged_in("vic", Role.VIEWER)
        made = await pia.ask("PUT", "/api/files/a.yarc", {"text": TEXT, "known": None})
        assert made.told["sha256"] == sha256(TEXT.encode())
        opened = (await vic.get("/api/files/a.yarc")).told
        assert (opened["text"], opened["sha256"]) == (TEXT, made.told["sha256"])
        assert opened["changed"].endswith("+00:00")
        assert [(one["file"], one["kind"]) for one in (await vic.get("/api/files")).told["files"]] == [
            ("a.yarc", "program")
        ]
        (project / "a.yarc").write_text("somebody else")
        refused = await pia.ask("PUT", "/api/files/a.yarc", {"text": "", "known": opened["sha256"]})
        assert (refused.status, refused.told["code"], refused.told["sha256"]) == (
            409,
            "changed",
            sha256(b"somebody else"),
        )
        copied = await pia.post("/api/files/copy", {"file": "a.yarc", "to": "b.yarc"})
        assert copied.told["sha256"] == sha256(b"somebody else")
        assert (await pia.post("/api/files/folder", {"file": "sub"})).status == 200
        assert (await pia.post("/api/files/rename", {"file": "b.yarc", "to": "sub/c.yarc"})).status == 200
        deleted = (await pia.post("/api/files/delete", {"file": "sub/c.yarc"})).told
        assert [one["file"] for one in (await vic.get("/api/trash")).told["deleted"]] == ["sub/c.yarc"]
        assert (await pia.post("/api/files/restore", {"number": deleted["number"]})).told == {
            "file": "sub/c.yarc"
        }
        actions = [(action, outcome.partition(":")[0]) for _, action, _, outcome in place.deeds()]
        assert sorted(actions) == sorted([
            ("file save", "done"), ("file save", "done"), ("file save", "refused"), ("file copy", "done"),
            ("file folder", "done"), ("file rename", "done"), ("file delete", "done"),
                ("file restore", "done"),
        ])  # fmt: skip
        assert f'"sha256": "{made.told["sha256"]}", "size": {len(TEXT)}' in place.deeds()[0][2]

    at(monkeypatch, tmp_path, work)


def test_viewers_and_operators_change_nothing(monkeypatch, tmp_path):
    async def work(place, project):
        (project / "a.yarc").write_text(TEXT)
        for role in (Role.VIEWER, Role.OPERATOR):
            eve = place.logged_in(role.value, role)
            answers = [
                await eve.ask("PUT", "/api/files/a.yarc", {"text": "", "known": sha256(TEXT.encode())}),
                await eve.ask("PUT", "/api/files/new", {"text": "", "known": None}),
                await eve.post("/api/upload/new", raw=b"x"),
                await eve.post("/api/files/copy", {"file": "a.yarc", "to": "b.yarc"}),
                await eve.post("/api/files/rename", {"file": "a.yarc", "to": "b.yarc"}),
                await eve.post("/api/files/delete", {"file": "a.yarc"}),
                await eve.post("/api/files/folder", {"file": "sub"}),
                await eve.post("/api/files/restore", {"number": "1"}),
            ]
            assert {one.status for one in answers} == {403}
            assert (await eve.get("/api/download/a.yarc")).content == TEXT.encode()
        assert [one.name for one in project.iterdir()] == ["a.yarc"]

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    "path",
    [
        "/etc/passwd",
        "../state/pendant.db",
        "..%2fstate",
        ".git/config",
        "",
        "sub//a",
        "a\0",
        "x" * 5000,
    ],
)
def test_hostile_paths(monkeypatch, tmp_path, path):
    async def work(place, project):
        pia = place.logged_in("pia", Role.PROGRAMMER)
        for method, route in (("GET", "files"), ("PUT", "files"), ("POST", "upload"), ("GET", "download"),
            ("GET", "git/difference")):  # fmt: skip
            answered = await pia.ask(method, f"/api/{route}/{path}", {"text": "x", "known": None})
            assert answered.status in (400, 404, 405, 409), (method, route)
        for word in ("copy", "rename"):
            for pair in ({"file": path, "to": "x"}, {"file": "a", "to": path}):
                assert (await pia.post(f"/api/files/{word}", pair)).status in (400, 409)
        assert (await pia.post("/api/files/delete", {"file": path})).status in (400, 409)
        assert list(project.iterdir()) == []

    at(monkeypatch, tmp_path, work)


def test_what_is_no_text(monkeypatch, tmp_path):
    async def work(place, project):
        vic = place.logged_in("vic", Role.VIEWER)
        (project / "latin").write_bytes("é".encode("latin-1"))
        (project / "zero").write_bytes(b"a\0b")
        (project / "large").write_bytes(b"x" * ((1 << 20) + 1))
        (project / "bom").write_bytes(b"\xef\xbb\xbfa\r\nb")
        for name, code in (("latin", "binary"), ("zero", "binary"), ("large", "large"), ("gone", "missing")):
            refused = await vic.get(f"/api/files/{name}")
            assert (refused.status, refused.told["code"]) == (409, code)
            assert refused.told["help"]
        assert (await vic.get("/api/files/bom")).told["text"] == "\ufeffa\r\nb"
        pia = place.logged_in("pia", Role.PROGRAMMER)
        # 1 MiB of text, which needs up to six times as many bytes as JSON
        for text in ("\x01" * (1 << 20), "é" * (1 << 19)):
            assert (
                await pia.ask("PUT", f"/api/files/{len(text)}", {"text": text, "known": None})
            ).status == 200
        assert (await pia.ask("PUT", "/api/files/more", {"text": "x" * ((1 << 20) + 1), "known": None})).told[
            "code"
        ] == "large"
        assert (
            await pia.ask("PUT", "/api/files/half", raw=b'{"text": "\\ud800", "known": null}')
        ).status == 400
        assert (await pia.ask("PUT", "/api/files/much", raw=b" " * 7_000_000)).status in (400, 409)
        assert (await pia.ask("PUT", "/api/files/none", {"text": ""})).status == 400

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("name",
    ["a.yarc", "程序 1.pmc", 'quo"te;x=y.txt', "سلام.html", "n" * 200])  # fmt: skip
def test_a_download_is_never_shown(monkeypatch, tmp_path, name):
    async def work(place, project):
        vic = place.logged_in("vic", Role.VIEWER)
        (project / name).write_bytes(b"<script>alert(1)</script>" * 40_000)
        told = await vic.get(f"/api/download/{name}")
        assert told.content == (project / name).read_bytes()
        assert told.headers["content-type"] == "application/octet-stream"
        assert told.headers["x-content-type-options"] == "nosniff"
        assert told.headers["content-length"] == str(len(told.content))
        assert told.headers["content-disposition"] == disposition(name)
        assert told.headers["content-disposition"].isascii()
        assert not set("\r\n") & set(told.headers["content-disposition"])
        assert not set("\r\n") & set(disposition("new\nline\r\nSet-Cookie: a=b"))

    at(monkeypatch, tmp_path, work)


async def upload(browser, path, pieces, *, length=None, breaks=False, wait=0.0):
    """Upload a file piece by piece. With `breaks`, the connection breaks after the last piece."""
    sent, given = [], iter(pieces)

    async def receive():
        await asyncio.sleep(wait)
        data = next(given, None)
        if data is None:
            return (
                {"type": "http.disconnect"}
                if breaks
                else {"type": "http.request", "body": b"", "more_body": False}
            )
        return {"type": "http.request", "body": data, "more_body": True}

    async def send(message):
        sent.append(message)

    headers = browser.headers([] if length is None else [("content-length", str(length))])
    await browser.app(scope_of("http", path, headers, "http", "POST"), receive, send)
    return sent[0]["status"], b"".join(one.get("body", b"") for one in sent[1:])


def is_clean(project):
    return not [one for one in os.listdir(project) if one.startswith(".yarc")]  # noqa: PTH208 - hidden ones, too


def test_a_large_upload_takes_little_memory(monkeypatch, tmp_path):
    async def work(place, project):
        pia = place.logged_in("pia", Role.PROGRAMMER)
        piece, count = b"x" * 65_536, 1525
        gc.collect()
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        status, _ = await upload(
            pia, "/api/upload/big.bin", (piece for _ in range(count)), length=len(piece) * count
        )
        grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
        assert status == 200
        assert (project / "big.bin").stat().st_size == len(piece) * count > 99_000_000
        assert grown < 8_000, "kB"
        status, told = await upload(pia, "/api/upload/more", (piece for _ in range(count + 10)))
        assert (status, b"100,000,000" in told) == (409, True)
        status, told = await upload(pia, "/api/upload/more", iter(()), length=100_000_001)
        assert (status, b"100,000,000" in told) == (409, True)
        assert [one.name for one in project.iterdir()] == ["big.bin"]
        assert is_clean(project)

    at(monkeypatch, tmp_path, work)


def test_uploads_that_come_to_nothing(monkeypatch, tmp_path):
    """Uploads that are interrupted, silent, too slow, too short, to an existing file, or to a missing folder
    are refused, and leave nothing on the disk.
    """

    async def work(place, project):
        pia = place.logged_in("pia", Role.PROGRAMMER)
        (project / "there").write_bytes(b"old")
        piece = b"x" * 65_536
        monkeypatch.setattr(filing, "_SILENCE", 0.5)
        monkeypatch.setattr(filing, "_START", 2.0)
        for path, pieces, options, words in (
            ("new", [piece] * 20, {"breaks": True}, b"the upload was interrupted"),
            ("new", [piece] * 3, {"wait": 0.6}, b"too slowly"),
            ("new", [b"x"] * 9, {"wait": 0.3}, b"too slowly"),
            ("new", [piece], {"length": 65_537}, b"65,536 were received"),
            ("there", [piece], {}, b"another content"),
            (f"there?known={'0' * 64}", [piece], {}, b"another content"),
            ("there?known=x", [piece], {}, b"SHA-256"),
            ("nowhere/new", [piece], {}, b"there is no folder"),
            (".hidden", [piece], {}, b"hidden"),
        ):
            status, told = await upload(pia, f"/api/upload/{path}", pieces, **options)
            assert status in (400, 409), path
            assert words in told
            assert is_clean(project)
        assert {one.name: one.read_bytes() for one in project.iterdir()} == {"there": b"old"}
        assert place.service.files._uploads == []
        status, _ = await upload(pia, f"/api/upload/there?known={sha256(b'old')}", [b"new"])
        assert (status, (project / "there").read_bytes()) == (200, b"new")

    at(monkeypatch, tmp_path, work)


def test_only_a_few_uploads_at_once(monkeypatch, tmp_path):
    async def work(place, project):
        users = [place.logged_in(f"pia{number}", Role.PROGRAMMER) for number in range(4)]
        begun = [
            asyncio.ensure_future(
                upload(user, f"/api/upload/{user.session.user}-{number}", [b"x"] * 4, wait=0.2)
            )
            for user in users
            for number in range(3)
        ]
        done = [status for status, _ in await asyncio.gather(*begun)]
        assert done.count(200) == filing._AT_ONCE
        assert len(list(project.iterdir())) == filing._AT_ONCE
        assert (await upload(users[3], "/api/upload/later", [b"x"]))[0] == 200

    at(monkeypatch, tmp_path, work)


def test_what_cant_be_written_down_isnt_done(monkeypatch, tmp_path):
    async def work(place, project):
        pia = place.logged_in("pia", Role.PROGRAMMER)
        (project / "a").write_bytes(b"old")
        database = place.service.accounts.database
        real = database.now

        def full(do, *arguments, **named):
            if do.__name__ == "write_deed":
                raise database._trouble("database or disk is full")
            return real(do, *arguments, **named)

        monkeypatch.setattr(database, "now", full)
        assert (await pia.ask("PUT", "/api/files/new", {"text": "", "known": None})).status == 409
        assert (await pia.post("/api/files/delete", {"file": "a"})).status == 409
        assert (await upload(pia, "/api/upload/new", [b"x"]))[0] == 409
        assert {one.name: one.read_bytes() for one in project.iterdir()} == {"a": b"old"}

    at(monkeypatch, tmp_path, work)
