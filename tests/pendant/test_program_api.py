"""Tests of editing a program through the API: its list, positions taught at the robot, changes by forms,
rights, and refusals.
"""

import asyncio
import json
import time

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.diagnostics import Edit
from yarclang.pendant.accounts.roles import Role
from yarclang.source import Span
from yarclang.teaching.edits import applied

TEXT = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEJ 10 0 0 0 -20 0\n"


def at(monkeypatch, tmp_path, work, **options):
    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            await work(place)

    run(whole())


async def edit(browser, change, text=TEXT, file="a.yarc"):
    return await browser.post("/api/program/edit", {"file": file, "text": text, "change": change})


def made(answered, text=TEXT):
    assert answered.status == 200, answered.content
    edits = [
        Edit(Span(one["line"], one["column"], one["end_line"], one["end_column"]), one["text"])
        for one in answered.told["edits"]
    ]
    return applied(text, edits)


def test_it_is_taught_where_the_robot_stands(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        listed = (
            await anna.post("/api/program/list", {"file": "a.yarc", "text": TEXT + "P0020 MOVEJ (\n"})
        ).told
        assert [(one["kind"], one["name"], one["taught"]) for one in listed["commands"]] == [
            ("declaration", "DEFAULT", False),
            ("motion", "MOVEJ", True),
            ("other", "?", False),
        ]
        teach = {"kind": "teach", "after": 2, "motion": "MOVEJ", "target": "joints"}
        assert made(await edit(anna, teach)) == TEXT + "P0020 MOVEJ 0 0 0 0 0 0\n"
        line = made(await edit(anna, {**teach, "motion": "MOVEL", "target": "pose"})).splitlines()[-1]
        assert line == "P0020 MOVEL 0 1174.4 1764 0 0 0"
        given = await edit(anna, {**teach, "joints": [1, 2, 3, 4, 5, 6.0005]})
        assert made(given).endswith("P0020 MOVEJ 1 2 3 4 5 6\n")
        touched = await edit(anna, {"kind": "touch-up", "line": 2})
        assert made(touched) == TEXT.replace("10 0 0 0 -20 0", "0 0 0 0 0 0")
        declared = await edit(anna, {"kind": "declare", "what": "frame", "name": "HERE"})
        assert "FRAME {HERE} 0 1174.4 1764 0 0 0\n" in made(declared)
        over = [
            ({**teach, "joints": [1, 2]}, "2 joint values"),
            ({**teach, "joints": [500, 0, 0, 0, 0, 0]}, "J1 500 deg is beyond its limits"),
            ({**teach, "after": 99}, "there is no line 99"),
            ({"kind": "delete", "lines": [5, 9]}, "there is no line 5"),
        ]
        for change, what in over:
            answered = await edit(anna, change)
            assert (answered.status, what in answered.told["error"]) == (409, True), answered.content

    at(monkeypatch, tmp_path, work)


def test_nobody_teaches_while_the_robot_moves_or_is_lost(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        (tmp_path / "a.yarc").write_text("P0001 MOVEJ 20 0 0 0 0 0 [4] (deg,s)\n")
        await anna.post("/api/control")
        loaded = (await anna.order("load", file="a.yarc")).told
        running = asyncio.ensure_future(anna.order("run", program=loaded["program"]["number"]))
        await asyncio.sleep(1.5)
        refused = await edit(anna, {"kind": "touch-up", "line": 2})
        assert refused.status == 409
        assert "the robot is moving: " in refused.told["error"]
        assert (await edit(anna, {"kind": "delete", "lines": [2, 2]})).status == 200
        await running
        assert (await edit(anna, {"kind": "touch-up", "line": 2})).status == 200
        showing = place.service.watched.attached
        ask = type(showing).ask

        async def lost(attached, order):
            told = await ask(attached, order)
            if hasattr(told, "motors"):
                motors = tuple(one.model_copy(update={"homed": one.number != 2}) for one in told.motors)
                return told.model_copy(update={"motors": motors})
            return told

        monkeypatch.setattr(type(showing), "ask", lost)
        refused = await edit(anna, {"kind": "touch-up", "line": 2})
        assert refused.told["error"].startswith("motor 2 is not homed")

    at(monkeypatch, tmp_path, work)


def test_roles_files_and_forged_bodies(monkeypatch, tmp_path):
    async def work(place):
        anna, olaf, vera = (
            place.logged_in("anna", Role.PROGRAMMER),
            place.logged_in("olaf", Role.OPERATOR),
            place.logged_in("vera", Role.VIEWER),
        )
        renumber = {"kind": "renumber"}
        assert (await edit(olaf, renumber)).status == 403
        assert (await vera.post("/api/program/new", {"template": "weld", "file": "w.yarc"})).status == 403
        assert (await place.browser().post("/api/program/list", {"file": "a", "text": ""})).status == 401
        assert (await vera.post("/api/program/list", {"file": "a", "text": ""})).told == {"commands": []}
        for file in ("../a.yarc", "/etc/passwd", "a\0b", "x" * 5000, ""):
            assert (await edit(anna, renumber, file=file)).status in (400, 409)
            if file:
                found = await anna.get(f"/api/program/forms?file={file.replace(chr(0), '%00')}")
                assert found.status in (400, 404, 409)
        wrong = [
            {"kind": "teach"},
            {"kind": "nothing"},
            {"kind": "delete", "lines": [1, 2, 3]},
            {"kind": "delete", "lines": ["1", "2"]},
            {"kind": "move", "line": -1, "before": 1},
            {"kind": "move", "line": 1, "before": 10**30},
            {"kind": "change", "line": 1, "fields": {"x": 1}},
            {"kind": "touch-up", "line": 1, "joints": [1e300] * 6},
            {"kind": "renumber", "more": 1},
            None,
        ]
        for change in wrong:
            answered = await edit(anna, change)
            assert answered.status == 400, change
            assert "\n" not in answered.told["error"]
        for raw in (
            b"",
            b"[]",
            b'{"file":"a","text":"\\ud800","change":{"kind":"renumber"}}',
            b"\xff" * 100,
            b"[" * 100_000,
        ):
            assert (await anna.post("/api/program/edit", raw=raw)).status == 400
        assert (await anna.post("/api/program/list", raw=b" " * (1 << 20) + b"x")).status in (400, 409, 413)
        hostile = {"x": "0 ! \n P1 STOP", "time": "1] (s) {B} BLEND 5 ! "}
        for name, text in hostile.items():
            answered = await edit(anna, {"kind": "change", "line": 2, "fields": {name: text}})
            assert answered.status == 409

    at(monkeypatch, tmp_path, work)


def test_forms_and_templates(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        (tmp_path / "a.yarc").write_text("OUTPUT GRIP M1\nSUB HI N\n  P0010 STOP\nEND\n")
        for found in (
            await anna.get("/api/program/forms?file=a.yarc"),
            await anna.post(
                "/api/program/forms", {"file": "b.yarc", "text": (tmp_path / "a.yarc").read_text()}
            ),
        ):
            forms = {one["command"]: one for one in found.told["forms"]}
            assert forms["SET"]["fields"][0]["choices"] == ["GRIP"]
            assert "CALL HI" in forms
            assert "CALL PALLET.PUT" in forms
        assert (await anna.get("/api/program/forms")).status == 200
        insert = {"kind": "insert", "after": 2, "command": "SET", "fields": {"signal": "GRIP", "value": "ON"}}
        assert made(await edit(anna, insert)) == TEXT + "P0020 SET GRIP ON\n"
        names = [one["name"] for one in (await anna.get("/api/program/templates")).told["templates"]]
        assert names == ["pick-place", "pallet", "weld", "glue", "tend", "empty"]
        new = await anna.post(
            "/api/program/new", {"template": "tend", "file": "sub/t.yarc", "fields": {"grip": "CLAW"}}
        )
        assert "OUTPUT CLAW M1" in new.told["text"]
        assert not (tmp_path / "sub").exists()
        assert (await anna.post("/api/program/new", {"template": "../../x", "file": "t.yarc"})).status == 409
        document = json.loads((await anna.get("/api/openapi.json")).content)
        assert "/api/program/edit" in document["paths"]
        assert "TeachMotion" in document["components"]["schemas"]

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("kind", ["list", "edit"])
def test_a_program_of_ten_thousand_lines_is_answered_soon(monkeypatch, tmp_path, kind):
    async def work(place):
        anna = place.logged_in("anna", Role.PROGRAMMER)
        lines = "".join(f"P{n * 10:05d} MOVEL 1.5 {n % 999} 3 0 0 0\n" for n in range(10_000))
        begin = time.process_time()
        if kind == "list":
            found = await anna.post("/api/program/list", {"file": "a.yarc", "text": lines})
            assert len(found.told["commands"]) == 10_000
            assert not any(one["fields"] for one in found.told["commands"])
            found = await anna.post("/api/program/list", {"file": "a", "text": lines, "lines": [7, 8]})
            with_fields = [one["line"] for one in found.told["commands"] if one["fields"]]
            assert with_fields == [7, 8]
        else:
            found = await edit(
                anna, {"kind": "teach", "after": 5_000, "motion": "MOVEJ", "target": "joints"}, lines
            )
            assert len(found.told["edits"]) == 1
        assert time.process_time() - begin < 12.0

    at(monkeypatch, tmp_path, work)
