"""Tests of control over the robot: requesting, giving and keeping it, and taking it from an absent owner.
Also the list of programs and the entries of the audit trail about them.
"""

import asyncio
import os

import pytest
from coordinator.virtual import run
from pendant.at_robot import pendant

from yarclang.pendant.accounts.roles import Role

PROGRAM = "P0001 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"


def at(monkeypatch, tmp_path, work, **options):
    async def whole():
        async with pendant(monkeypatch, tmp_path, **options) as place:
            await work(place)

    run(whole())


def test_control_is_asked_for_and_given(monkeypatch, tmp_path):
    async def work(place):
        anna, bea = place.logged_in("anna", Role.OPERATOR), place.logged_in("bea", Role.OPERATOR)
        page = anna.socket("/api/robot")
        other = bea.socket("/api/robot")
        assert (await anna.post("/api/control")).told == {
            "given": True,
            "owner": "anna",
            "what": "you control the robot",
        }
        await asyncio.sleep(0.1)
        asked = (await bea.post("/api/control")).told
        assert (asked["given"], asked["owner"]) == (False, "anna")
        notice = await page.until(lambda message: message.get("event") == "notice")
        assert notice["text"] == "bea asks for control of the robot"
        await anna.post("/api/control/give", {"to": notice["ask"], "refuse": True})
        kept = await other.until(lambda message: message.get("event") == "notice")
        assert "keeps" in kept["text"]
        assert place.coordinator.owner == "anna"
        assert (await bea.post("/api/control/give", {"to": notice["ask"]})).status == 409
        assert (await anna.post("/api/control/give", {"to": notice["ask"]})).told["owner"] == "bea"
        assert place.coordinator.owner == "bea"
        display = await page.until(
            lambda message: message.get("event") == "display" and message["owner"] == "bea"
        )
        assert display["state"] == "stop"
        assert (await bea.post("/api/control/give", {})).told["owner"] == ""
        assert place.coordinator.owner == ""
        await page.close()
        await other.close()

    at(monkeypatch, tmp_path, work)


def test_who_has_gone_gives_way(monkeypatch, tmp_path):
    async def work(place):
        anna, bea = place.logged_in("anna", Role.OPERATOR), place.logged_in("bea", Role.OPERATOR)
        page = anna.socket("/api/robot")
        await anna.post("/api/control")
        await asyncio.sleep(0.2)
        await page.close()
        assert (await bea.post("/api/control")).told["given"] is False
        await asyncio.sleep(11.0)
        assert (await bea.post("/api/control")).told["given"] is True
        assert place.coordinator.owner == "bea"

    at(monkeypatch, tmp_path, work)


def test_a_program_without_pages_keeps_control_while_it_gives_orders(monkeypatch, tmp_path):
    """A client of the API needs no page. It doesn't lose control between two of its orders."""

    async def work(place):
        anna, bea = place.logged_in("anna", Role.OPERATOR), place.logged_in("bea", Role.OPERATOR)
        await anna.post("/api/control")
        for _ in range(3):
            await asyncio.sleep(6.0)
            assert (await bea.post("/api/control")).told["given"] is False
            assert (await anna.order("status")).status == 200
        await asyncio.sleep(11.0)
        assert (await bea.post("/api/control")).told["given"] is True

    at(monkeypatch, tmp_path, work)


def test_only_the_owner_keeps_control(monkeypatch, tmp_path):
    async def work(place):
        anna, bea = place.logged_in("anna", Role.OPERATOR), place.logged_in("bea", Role.OPERATOR)
        page = anna.socket("/api/robot")
        await anna.post("/api/control")
        await asyncio.sleep(0.2)
        for to in ("", anna.session.id):
            assert (await bea.post("/api/control/give", {"to": to, "refuse": True})).status == 409
        await asyncio.sleep(0.2)
        assert not [one for one in page.waiting() if one.get("event") == "notice"]
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_the_owner_at_a_prompt_is_named(monkeypatch, tmp_path):
    async def work(place):
        prompt = place.coordinator.attach("repl")
        prompt.session.own()
        await asyncio.sleep(0.1)
        anna = place.logged_in("anna")
        refused = await anna.post("/api/control")
        assert refused.status == 409
        assert "repl owns the robot" in refused.told["error"]

    at(monkeypatch, tmp_path, work)


def test_a_viewer_gets_no_control(monkeypatch, tmp_path):
    async def work(place):
        anna, vic = place.logged_in("anna", Role.OPERATOR), place.logged_in("vic", Role.VIEWER)
        await anna.post("/api/control")
        await asyncio.sleep(0.1)
        assert (await vic.post("/api/control")).status == 403
        refused = await anna.post("/api/control/give", {"to": vic.session.id})
        assert refused.status == 403
        assert place.coordinator.owner == "anna"

    at(monkeypatch, tmp_path, work)


def test_a_program_is_run_and_everybody_may_stop_it(monkeypatch, tmp_path):
    (tmp_path / "bend.yarc").write_text(PROGRAM)

    async def work(place):
        anna, vic = place.logged_in("anna", Role.OPERATOR), place.logged_in("vic", Role.VIEWER)
        page = vic.socket("/api/robot")
        assert [one["file"] for one in (await vic.get("/api/programs")).told["programs"]] == ["bend.yarc"]
        await anna.post("/api/control")
        await asyncio.sleep(0.1)
        loaded = (await anna.order("load", file="bend.yarc")).told
        assert loaded["program"] is not None, loaded["findings"]
        number = loaded["program"]["number"]
        running = asyncio.ensure_future(anna.order("run", program=number))
        shown = await page.until(
            lambda message: message.get("event") == "display" and message["mode"] == "program"
        )
        assert (shown["under_way"], shown["owner"]) == ("bend.yarc", "anna")
        await asyncio.sleep(0.8)
        page.say({"order": "stop", "id": "s"})
        assert (await page.until(lambda message: message.get("id") == "s"))["ok"]
        ended = (await running).told
        assert (ended["well"], ended["what"]) == (False, "stopped on its path")
        assert 0.1 < place.world.stands()[0] < 9.9
        assert not place.world.moving
        await asyncio.sleep(0.1)
        deeds = [one for one in place.deeds() if one[1] in ("run", "stop")]
        assert deeds == [
            ("anna", "run", f'bend.yarc {{"program": {number}}}', "done"),
            ("vic", "stop", "", "done"),
            ("anna", "run", f'bend.yarc {{"program": {number}}}', "ended: stopped on its path"),
        ]
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_the_audit_trail_comes_first(monkeypatch, tmp_path):
    """If the audit trail can't be written, no motion is possible. A stop is executed anyway."""
    (tmp_path / "bend.yarc").write_text(PROGRAM)

    async def work(place):
        anna = place.logged_in("anna")
        await anna.post("/api/control")
        await asyncio.sleep(0.1)
        number = (await anna.order("load", file="bend.yarc")).told["program"]["number"]

        def fill(connection):
            pages = connection.execute("PRAGMA page_count").fetchone()[0]
            connection.execute(f"PRAGMA max_page_count = {pages}")
            connection.execute("CREATE TABLE filler (x)")

        with pytest.raises(Exception, match="full"):
            place.service.accounts.database.now(fill)
        for _ in range(500):
            answered = await anna.order("override", percent=50.0)
            await asyncio.sleep(0.001)
            if place.service.accounts.trouble is not None:
                break
        refused = await anna.order("run", program=number)
        assert refused.status == 409
        assert "full" in refused.told["error"]
        assert (await anna.order("stop")).status == 200
        await asyncio.sleep(0.3)
        page = anna.socket("/api/robot")
        shown = await page.until(lambda message: message.get("event") == "display")
        assert "full" in shown["audit"]
        await page.close()
        assert answered.status in (200, 409)
        assert abs(place.world.stands()[0]) < 1e-9

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize(
    "name",
    [
        "../outside.yarc",
        "/etc/passwd",
        "link.yarc",
        "linked/outside.yarc",
        "sub/../../outside.yarc",
        "a\x00b",
        "x" * 5000,
        "~/.bashrc",
        "/proc/self/environ",
    ],
)
def test_nothing_outside_of_the_project(monkeypatch, tmp_path, name):
    project = tmp_path / "project"
    project.mkdir()
    (tmp_path / "outside.yarc").write_text(PROGRAM)
    (project / "link.yarc").symlink_to(tmp_path / "outside.yarc")
    (project / "linked").symlink_to(tmp_path)
    (project / "bend.yarc").write_text(PROGRAM)

    async def work(place):
        anna = place.logged_in("anna")
        await anna.post("/api/control")
        await asyncio.sleep(0.1)
        answered = await anna.order("load", file=name)
        assert answered.status == 409 or answered.told["program"] is None
        if ".." in name or name.startswith(("/", "link")) or "\0" in name:
            for fields in ({"cell": name}, {"source": name}):
                assert (await anna.order("load", file="bend.yarc", **fields)).status == 409
            assert (await anna.order("save", folder=name)).status == 409
        assert [one["file"] for one in (await anna.get("/api/programs")).told["programs"]] == ["bend.yarc"]

    at(monkeypatch, tmp_path, work, project=project)


def test_only_programs_are_listed(monkeypatch, tmp_path):
    """A pipe, a link that leads out, a hidden folder, and a folder with a program's name aren't listed as
    programs. The names are sorted.
    """
    project = tmp_path / "project"
    (project / ".venv").mkdir(parents=True)
    (project / "sub" / "c.yarc").mkdir(parents=True)
    for name in ("b.yarc", "a.pmc", "sub/d.YARC", ".venv/e.yarc", "note.txt"):
        (project / name).write_text(PROGRAM)
    (project / "out.yarc").symlink_to("/etc/passwd")
    (project / "none.yarc").symlink_to(project / "nothing")
    (project / "round").symlink_to(project)
    os.mkfifo(project / "pipe.yarc")

    async def work(place):
        told = place.service.gate.programs()
        assert [one.file for one in told.programs] == ["a.pmc", "b.yarc", "sub/d.YARC"]

    at(monkeypatch, tmp_path, work, project=project)


def test_text_is_for_programmers(monkeypatch, tmp_path):
    async def work(place):
        anna, pia = place.logged_in("anna", Role.OPERATOR), place.logged_in("pia", Role.PROGRAMMER)
        assert (await anna.order("load", file="a.yarc", text=PROGRAM)).status == 403
        assert (await pia.order("load", file="a.yarc", text=PROGRAM)).told["program"] is not None

    at(monkeypatch, tmp_path, work)


def test_the_coordinator_is_lost_and_found(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        page = anna.socket("/api/robot")
        await page.until(lambda message: message.get("event") == "display" and message["connected"])
        place.world.unplug()
        shown = await page.until(
            lambda message: message.get("event") == "display" and message["mode"] == "disconnected"
        )
        assert shown["alarm"]["holds"]
        assert shown["alarm"]["code"] == "Y1606"
        place.world.plug()
        await page.until(lambda message: message.get("event") == "display" and message["mode"] == "idle")
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_twenty_watchers_are_told_the_same(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna", Role.VIEWER)
        pages = [anna.socket("/api/robot") for _ in range(20)]
        first = [await page.until(lambda message: message.get("event") == "display") for page in pages]
        assert all(one == first[0] for one in first)
        # For a page that never reads, only the newest display and a few texts are stored.
        for number in range(300):
            place.coordinator.tell(f"text {number}")
        await asyncio.sleep(1.0)
        assert all(len(page._texts) <= 64 for page in place.service.watched._pages)
        for page in pages:
            await page.close()
        assert place.service.watched._pages == set()

    at(monkeypatch, tmp_path, work)


@pytest.mark.parametrize("word", ["stop", "hold", "abort"])
def test_a_stop_cancels_orders_that_wait_for_the_disk(monkeypatch, tmp_path, word):
    """An order is written to the audit trail first. If the disk is slow, a stop that is ordered meanwhile
    comes first, and the robot doesn't move after it.
    """
    (tmp_path / "there.yarc").write_text(PROGRAM)

    async def work(place):
        anna, bea = place.logged_in("anna", Role.OPERATOR), place.logged_in("bea", Role.OPERATOR)
        assert (await anna.post("/api/control")).told["given"]
        number = (await anna.order("load", file="there.yarc", approach=True)).told["program"]["number"]
        before = place.world.stands()
        place.slow_disk(monkeypatch, 3.0)
        runs = asyncio.ensure_future(anna.order("run", program=number))
        await asyncio.sleep(1.0)
        assert (await bea.order(word)).status == 200
        answer = await runs
        assert (answer.status, answer.told["error"]) == (409, "stopped before it began; nothing moved")
        await asyncio.sleep(4.0)
        assert (place.world.stands() == before).all()
        assert [deed[3] for deed in place.deeds() if deed[1] == "run"][-1].startswith("refused: stopped")
        # A new order is carried out, and so is an order that moves nothing.
        gives = asyncio.ensure_future(anna.post("/api/control/give", {}))
        await asyncio.sleep(1.0)
        await bea.order(word)
        assert (await gives).status == 200
        assert (await anna.post("/api/control")).told["given"]
        runs = asyncio.ensure_future(anna.order("run", program=number))
        await asyncio.sleep(4.0)
        assert place.world.moving
        await runs

    at(monkeypatch, tmp_path, work)


def test_an_order_that_was_delayed_isnt_carried_out(monkeypatch, tmp_path):
    """A page names the last heartbeat that it has received. If the network or the pendant's process stands
    still meanwhile, the order is refused; a stop never is.
    """
    (tmp_path / "there.yarc").write_text(PROGRAM)

    async def work(place):
        loop = asyncio.get_running_loop()
        anna = place.logged_in("anna", Role.OPERATOR)
        page = anna.socket("/api/robot")
        assert (await anna.post("/api/control")).told["given"]
        number = (await anna.order("load", file="there.yarc", approach=True)).told["program"]["number"]

        async def runs(beat):
            made = anna.post("/api/orders/run", {"program": number}, headers=[("x-yarc-beat", str(beat))])
            return await made

        async def newest():
            page.waiting()
            return (await page.until(lambda message: "beat" in message))["beat"]

        beat = await newest()
        await asyncio.sleep(4.0)  # the network stands still
        assert (await runs(beat)).status == 409
        beat = await newest()
        loop.virtual += 4.0  # the process stands still
        late = await runs(beat)
        assert (late.status, "too late" in late.told["error"]) == (409, True)
        for forged in ("-1", "x", "9" * 30, 10**9):
            assert (await runs(forged)).status == 409
        assert not place.world.moving
        for word in ("stop", "hold", "status"):
            told = await anna.post(f"/api/orders/{word}", {}, headers=[("x-yarc-beat", str(beat))])
            assert told.status == 200
        beat = await newest()
        await asyncio.sleep(1.0)
        running = asyncio.ensure_future(runs(beat))
        await asyncio.sleep(0.8)
        assert place.world.moving
        assert (await running).told["well"]
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_an_order_doesnt_outlast_its_session(monkeypatch, tmp_path):
    """If the disk is slow, a user may log out, or be removed, before an order is carried out."""

    async def work(place):
        anna = place.logged_in("anna", Role.OPERATOR)
        place.slow_disk(monkeypatch, 2.0)
        owns = asyncio.ensure_future(anna.post("/api/control"))
        await asyncio.sleep(1.0)
        place.service.accounts.sessions.end(anna.session)
        assert (await owns).status == 401
        assert place.coordinator.owner == ""
        assert place.service.seats.taken(anna.session) is None
        await asyncio.sleep(5.0)

    at(monkeypatch, tmp_path, work)
