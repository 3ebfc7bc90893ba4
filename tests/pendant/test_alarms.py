"""Tests of alarms: their causes, what is stored of them, acknowledgement, floods of alarms, hostile texts,
and a file that can't be written.
"""

import asyncio
import csv
import io
import sqlite3
import time

import pytest
from coordinator.virtual import run
from hypothesis import given, settings
from hypothesis import strategies as st
from pendant.at_robot import pendant

from yarclang.coordinator.messages.replies import MotorHealth
from yarclang.findings import CATALOGUE
from yarclang.pendant.accounts.database import VERSION, Database
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.alarms import kept
from yarclang.pendant.alarms.alarm import MOST_WHAT, Alarm, Raised, Stood
from yarclang.pendant.alarms.book import AGAIN, Book
from yarclang.pendant.alarms.export import as_csv
from yarclang.pendant.alarms.told import of_motors
from yarclang.runtime.actions import Trouble

PROGRAM = "P0010 MOVEJ 20 0 0 0 30 0 [6] (deg,s)\nP0020 MOVEJ HOME [6] (deg,s)\n"
NOWHERE = Stood()
HOSTILE = "<img src=x onerror=alert(1)>\u202etxt.exe\x1b[31m\n=cmd|' /C calc'!A0" + "x" * 1_000_000


def at(monkeypatch, tmp_path, work):
    async def whole():
        async with pendant(monkeypatch, tmp_path) as place:
            await work(place)

    run(whole())


async def moving(place, person, name="bend.yarc", text=PROGRAM):
    """Run a program. Return when the robot moves on the program's second line."""
    (place.service.files.folder.root / name).write_text(text)
    assert (await person.post("/api/control")).told["given"]
    number = (await person.order("load", file=name, approach=True)).told["program"]["number"]
    page = person.socket("/api/robot")
    page.say({"order": "run", "program": number, "id": "run"})
    await page.until(lambda one: one.get("event") == "display" and one["line"] == 2 and one["done_s"] > 6.5)
    return page


async def listed(person, which="open"):
    return (await person.get(f"/api/alarms?which={which}")).told


def test_a_lost_connection_is_one_alarm_with_all_that_was_known(monkeypatch, tmp_path):
    async def work(place):
        olaf, vic = place.logged_in("olaf", Role.OPERATOR), place.logged_in("vic", Role.VIEWER)
        page = await moving(place, olaf)
        place.world.unplug()
        shown = await page.until(lambda one: one.get("event") == "display" and one["alarm"]["number"])
        assert shown["alarm"]["holds"]
        assert shown["alarm"]["code"] == "Y1606"
        assert shown["alarm"]["open"] == 1
        await asyncio.sleep(5.0)
        place.world.plug()
        ended = await page.until(lambda one: one.get("id") == "run")
        assert not ended["well"]
        told = await listed(vic)
        (alarm,) = told["alarms"]
        assert alarm["code"] == "Y1606"
        assert alarm["title"] == CATALOGUE["Y1606"].title
        assert alarm["what"].startswith("the connection was lost")
        assert "doctor" in alarm["remedy"]
        assert (alarm["file"], alarm["line"], alarm["command"]) == ("bend.yarc", 2, "P0020 MOVEJ")
        assert alarm["owner"] == "olaf"
        assert alarm["holds"]
        assert alarm["ended"] is None
        assert [one["name"] for one in alarm["joints"]] == ["J1", "J2", "J3", "J4", "J5", "J6"]
        assert 0.0 < alarm["joints"][0]["value"] < 20.0
        assert len(alarm["flange"]) == 16
        # An acknowledged alarm stays in the bar while its fault is present, and disappears when the fault is
        # cleared.
        number = alarm["number"]
        done = await olaf.post("/api/alarms/acknowledge", {"numbers": [number]})
        assert done.told == {"count": 1}
        shown = await page.until(
            lambda one: one.get("event") == "display" and one["alarm"]["version"] != shown["alarm"]["version"]
        )
        assert shown["alarm"]["number"] == number
        assert shown["alarm"]["holds"]
        assert (await olaf.order("clear")).status == 200
        await page.until(lambda one: one.get("event") == "display" and one["alarm"]["number"] == 0)
        (past,) = (await listed(vic, "past"))["alarms"]
        assert past["by"] == "olaf"
        assert past["ended"] >= past["acknowledged"] >= past["time"]
        assert [one for one in place.deeds() if "acknowledge" in one[1]] == [
            ("olaf", "acknowledge alarms", str(number), "done")
        ]
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_what_people_do_is_no_alarm(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        page = await moving(place, anna)
        for word in ("hold", "resume", "stop"):
            await anna.order(word)
            await asyncio.sleep(1.0)
        ended = await page.until(lambda one: one.get("id") == "run")
        assert not ended["well"]
        assert ended["what"].startswith("stopped")
        line = anna.socket("/api/jog")
        beat = await line.hear()
        line.say({"press": 1, "beat": beat["beat"], "joint": "J1", "speed": 5.0})
        await asyncio.sleep(1.0)
        await line.close()
        await asyncio.sleep(1.0)
        told = await listed(anna)
        assert told["alarms"] == []
        assert told["all"] == 0

    at(monkeypatch, tmp_path, work)


def test_who_may_acknowledge_and_two_at_once(monkeypatch, tmp_path):
    async def work(place):
        people = [place.logged_in(name, Role.OPERATOR) for name in ("olaf", "otto")]
        vic = place.logged_in("vic", Role.VIEWER)
        for number in range(3):
            place.coordinator.tell(f"this computer or the link is too slow{number}", warning=True)
        await asyncio.sleep(0.2)
        told = await listed(vic)
        assert [one["what"][-1] for one in told["alarms"]] == ["2", "1", "0"]
        assert not any(one["holds"] for one in told["alarms"])
        first, second, third = (one["number"] for one in reversed(told["alarms"]))
        for path, body in (("acknowledge", {"numbers": [first]}), ("acknowledge", {"up_to": third})):
            assert (await vic.post(f"/api/alarms/{path}", body)).status == 403
            assert (await place.browser().post(f"/api/alarms/{path}", body)).status == 401
        for bad in ({}, {"numbers": []}, {"numbers": ["1"]}, {"numbers": [0] * 1001}, {"by": "me"}):
            assert (await people[0].post("/api/alarms/acknowledge", bad)).status == 400
        answers = await asyncio.gather(
            *(one.post("/api/alarms/acknowledge", {"numbers": [second, 10**12, -1]}) for one in people)
        )
        assert sum(one.told["count"] for one in answers) == 1
        # An alarm that was raised after the user's last look at the list isn't acknowledged with the listed
        # ones.
        place.coordinator.tell("something new", warning=True)
        await asyncio.sleep(0.2)
        assert (await people[0].post("/api/alarms/acknowledge", {"up_to": third})).told["count"] == 2
        (left,) = (await listed(vic))["alarms"]
        assert left["what"] == "something new"
        await people[0].post("/api/logout")
        assert (await people[0].post("/api/alarms/acknowledge", {"numbers": [left["number"]]})).status == 401
        for path in ("?which=all", "?before=x", "?count=-1", "/999", "/x", "/1e3"):
            assert (await vic.get(f"/api/alarms{path}")).status in (400, 404)

    at(monkeypatch, tmp_path, work)


def test_hostile_texts_stay_texts(monkeypatch, tmp_path):
    async def work(place):
        vic = place.logged_in("vic", Role.VIEWER)
        place.coordinator.tell(HOSTILE, warning=True)
        place.coordinator.tell('=HYPERLINK("http://x","y")', warning=True)
        await asyncio.sleep(0.2)
        told = await listed(vic)
        formula, long = told["alarms"]
        assert len(long["what"]) == MOST_WHAT
        assert all(one.isprintable() for one in long["what"])
        assert "\u202e" not in long["what"]
        assert "<img" in long["what"]
        found = await vic.get("/api/alarms/export")
        assert found.headers["content-disposition"].startswith("attachment")
        rows = list(csv.reader(io.StringIO(found.content.decode())))
        assert len(rows) == 3
        assert rows[1][8] == "'" + formula["what"]
        assert not any(cell.startswith(("=", "+", "-", "@")) for row in rows for cell in row)

    at(monkeypatch, tmp_path, work)


def test_findings_are_explained(monkeypatch, tmp_path):
    async def work(place):
        vic = place.logged_in("vic", Role.VIEWER)
        told = (await vic.get("/api/findings/y0501")).told
        assert told["title"] == CATALOGUE["Y0501"].title
        assert told["example"]
        assert told["family"] == "reach"
        for code in ("Y9999", "..", "%2e%2e", "Y" * 5000):
            assert (await vic.get(f"/api/findings/{code}")).status == 404
        assert (await place.browser().get("/api/findings/Y0501")).status == 401

    at(monkeypatch, tmp_path, work)


def test_a_file_that_cannot_be_written_delays_nothing(monkeypatch, tmp_path):
    async def work(place):
        anna = place.logged_in("anna")
        database, before = place.service.accounts.database, Database.now

        def full(self, do, *arguments, **named):
            if do is kept.write_alarms:
                raise Trouble("there is no room on the disk", "make room on the disk", "")
            return before(self, do, *arguments, **named)

        monkeypatch.setattr(Database, "now", full)
        place.coordinator.tell("something is wrong", warning=True)
        await asyncio.sleep(1.0)
        told = await listed(anna)
        assert "no room" in told["trouble"]
        assert {one["source"] for one in told["alarms"]} == {"message", "alarms"}
        monkeypatch.setattr(Database, "now", before)
        await asyncio.sleep(25.0)
        told = await listed(anna)
        assert told["trouble"] == ""
        assert not any(one["holds"] for one in told["alarms"])
        assert len(database.now(kept.kept_alarms, 10)) == 2

    at(monkeypatch, tmp_path, work)


def test_a_locked_or_full_file_stays_whole(tmp_path):
    async def work():
        database = Database(tmp_path / "pendant.db")
        other = sqlite3.connect(database.path, isolation_level=None)
        other.execute("BEGIN IMMEDIATE")
        with pytest.raises(Trouble, match="locked") as told:
            await asyncio.wait_for(database.call(kept.write_alarms, [alarm(1)], []), 30.0)
        assert told.value.remedy == "another program has opened the file: end that program"
        other.execute("ROLLBACK")
        await database.call(kept.write_alarms, [alarm(1), alarm(2)], [])
        other.execute("UPDATE alarms SET stood = 'no JSON' WHERE number = 1")
        other.close()
        assert await database.call(kept.kept_alarms, 10) == (alarm(2),)
        await database.call(
            lambda one: one.execute("PRAGMA max_page_count = 1")
        )  # don't let the file grow beyond its present size
        many = [alarm(number) for number in range(3, 2000)]
        with pytest.raises(Trouble, match="full") as told:
            await database.call(kept.write_alarms, many, [])
        assert told.value.remedy == "make room on the disk"
        assert await database.call(kept.kept_alarms, 10) == (alarm(2),)
        database.close()

    asyncio.run(work())


def test_a_file_of_before_gets_the_table(tmp_path):
    Database(tmp_path / "pendant.db").close()
    with sqlite3.connect(tmp_path / "pendant.db") as connection:
        connection.execute("DROP TABLE alarms")
        connection.execute("PRAGMA user_version = 1")
    database = Database(tmp_path / "pendant.db")
    database.now(kept.write_alarms, [alarm(1)], [])
    assert database.now(lambda one: one.execute("PRAGMA user_version").fetchone()[0]) == VERSION
    database.close()


def test_alarms_outlast_a_restart(monkeypatch, tmp_path):
    async def first(place):
        place.world.unplug()
        await asyncio.sleep(5.0)
        (one,) = (await listed(place.logged_in("anna")))["alarms"]
        assert one["holds"]

    async def second(place):
        await asyncio.sleep(1.0)
        (one,) = (await listed(place.logged_in("anna")))["alarms"]
        # The alarm isn't acknowledged, but its fault is no longer present.
        assert one["code"] == "Y1606"
        assert not one["holds"]
        assert one["count"] == 1

    at(monkeypatch, tmp_path, first)
    at(monkeypatch, tmp_path, second)


@pytest.mark.parametrize("moves", [False, True])
def test_a_motor_that_fails_is_one_alarm(monkeypatch, tmp_path, moves):
    async def work(place):
        anna = place.logged_in("anna")
        page = await moving(place, anna) if moves else anna.socket("/api/robot")
        place.world.machine.fault_amplifier(2)
        await page.until(lambda one: one.get("event") == "display" and one["mode"] == "fault")
        await asyncio.sleep(3.0)
        (alarm,) = (await listed(anna))["alarms"]
        assert alarm["code"] == "Y1602"
        assert alarm["what"].startswith("motor 2: its amplifier reports a fault")
        assert alarm["remedy"]
        assert alarm["holds"]
        assert (alarm["file"], alarm["line"]) == (("bend.yarc", 2) if moves else ("", 0))
        await page.close()

    at(monkeypatch, tmp_path, work)


def test_what_holds_is_told_by_its_source(monkeypatch, tmp_path):
    async def work(place):
        alarms, anna = place.service.alarms, place.logged_in("anna")

        async def sources():
            return {one["source"] for one in (await listed(anna))["alarms"] if one["holds"]}

        alarms.lost()
        assert await sources() == {"coordinator"}
        alarms.low = lambda: "12 MB are left"
        place.service.accounts.trouble = Trouble("the audit trail can't be written", "", "")
        again = asyncio.ensure_future(alarms.watch(place.service.watched.attached))
        await asyncio.sleep(0.6)
        assert await sources() == {"disk", "audit"}
        # If the audit trail can't be written, acknowledging is refused.
        place.service.accounts.trouble, alarms.low = None, str
        await asyncio.sleep(0.6)
        assert await sources() == set()
        again.cancel()
        motor = (await anna.order("health")).told["motors"][0]
        failed = MotorHealth(
            **{**motor, "flags": ("amplifier fault",), "trouble": "its amplifier reports a fault"}
        )
        (raised,) = of_motors([failed], "")
        assert (raised.code, raised.what) == ("Y1602", "motor 1: its amplifier reports a fault")
        assert of_motors([failed], f"{raised.what}; and more") == ()

    at(monkeypatch, tmp_path, work)


def test_a_flood_reaches_pages_and_the_file(monkeypatch, tmp_path):
    async def work(place):
        vic = place.logged_in("vic", Role.VIEWER)
        page = vic.socket("/api/robot")
        began = time.perf_counter()
        for number in range(10_000):
            place.coordinator.tell(f"text {number}", warning=True)
            if number % 50 == 0:
                await asyncio.sleep(0.3)  # altogether the events take a minute
        await asyncio.sleep(2.0)
        shown = await page.until(lambda one: one.get("event") == "display" and one["alarm"]["open"] == 10_000)
        assert shown["alarm"]["text"] == "text 9999"
        assert time.perf_counter() - began < 60.0
        database = place.service.accounts.database
        assert [one.number for one in database.now(kept.kept_alarms, 3)] == [10_000, 9_999, 9_998]
        assert len((await listed(vic))["alarms"]) == 100
        olaf = place.logged_in("olaf", Role.OPERATOR)
        assert (await olaf.post("/api/alarms/acknowledge", {"up_to": 10_000})).told["count"] == 10_000
        await page.close()

    at(monkeypatch, tmp_path, work)


def alarm(number):
    joints = (("J1", 1.5, "deg"), ("J2", 0.0, "mm"))
    stood = Stood("p.yarc", "a/p.yarc", 3, "P0010 MOVEJ", joints, (1.0,) * 16, "anna")
    return Alarm(number, Raised("run", "it failed", "Y1601", "look"), stood, 10.0, 11.0, 2, None, 12.0, "b")


def test_ten_thousand_a_minute():
    book, began = Book(), time.perf_counter()
    for number in range(20_000):
        book.happened(Raised("message", f"text {number}"), NOWHERE, number * 0.006)
        assert book.foremost().number == number + 1
    book.holding("motors", [Raised("motors", "motor 1")], lambda: NOWHERE, 120.0)
    for number in range(12_000):
        book.happened(Raised("message", f"more {number}"), NOWHERE, 121.0)
        book.happened(Raised("message", "again"), NOWHERE, 121.0 + number * 0.005)
    assert len(book) == 10_000
    assert book.open_count == 10_000
    assert [one.raised.what for one in book.open() if one.holds] == ["motor 1"]
    assert sum(one.count for one in book.open() if one.raised.what == "again") > 1000
    assert len(as_csv(book.all()).splitlines()) == 10_001
    assert book.acknowledge(range(50_000), "anna", 200.0) == 10_000
    assert book.foremost().raised.what == "motor 1"
    assert book.open_count == 1
    assert time.perf_counter() - began < 10.0


words = st.sampled_from(["a", "b", "c"])
deeds = st.one_of(
    st.tuples(st.just("happened"), words),
    st.tuples(st.just("holding"), st.lists(words, max_size=3)),
    st.tuples(st.just("acknowledge"), st.lists(st.integers(0, 12), max_size=4)),
    st.tuples(st.just("wait"), st.floats(0.0, 2.0 * AGAIN)),
)


@settings(max_examples=200, deadline=None)
@given(st.lists(deeds, max_size=30))
def test_the_book_agrees_with_itself(given_deeds):
    book, now, written, version = Book(most=8), 1000.0, {}, 0
    for kind, value in given_deeds:
        now += value if kind == "wait" else 0.01
        if kind == "happened":
            book.happened(Raised("message", value), NOWHERE, now)
        elif kind == "holding":
            book.holding("motors", [Raised("motors", one) for one in value], lambda: NOWHERE, now)
            held = {one.raised.what for one in book.open() if one.holds}
            assert held == set(value)
        elif kind == "acknowledge":
            book.acknowledge(value, "anna", now)
        assert len(book) <= 8
        shown = {one.number for one in book.open()}
        assert shown == {one.number for one in book.all() if one.is_open}
        assert book.open_count == len(shown)
        assert not shown & {one.number for one in book.past()}
        foremost = book.foremost()
        assert (foremost is None) == (not shown)
        assert foremost is None or foremost.acknowledged is None or all(one.holds for one in book.open())
        if book.changed:
            assert book.version >= version
        version = book.version
        # write the changed alarms, and check that the written ones equal the book's
        for number in book.changed:
            if (one := book.get(number)) is None:
                written.pop(number, None)
            else:
                written[number] = one
        book.changed.clear()
        assert written == {one.number: one for one in book.all()}
    again = Book(written.values(), most=8)
    assert again.all() == book.all()
    assert again.foremost() == book.foremost()
