"""Tests of run logs: the list made from their beginnings and ends, their content, downloads; forged,
truncated, huge and renamed files, links, and too many requests at once.
"""

import asyncio
import json
import math
import os
import random
import time
from contextlib import contextmanager

import pytest
from coordinator.virtual import run
from mcap.writer import Writer
from pendant.at_robot import pendant
from report.runs.made_up_runs import made, progress, samples, whole, write

from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.messages.runs import RunShown
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.runs import reading
from yarclang.pendant.runs.folders import LogFolders
from yarclang.pendant.runs.listing import Listing
from yarclang.pendant.runs.reading import Readings
from yarclang.pendant.runs.shown import CannotShow, as_json, shown
from yarclang.report.runs.brief import brief_of
from yarclang.report.runs.log import read_run
from yarclang.report.runs.records import read_records
from yarclang.runtime.actions import Trouble
from yarclang.runtime.log import RunLog
from yarclang.runtime.log_record import METADATA
from yarclang.runtime.notices import Changed, Remark
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import State

NAMES = ("turning.mcap", 'a "quoted" <b>.mcap', "日志\u202etxt.mcap")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """Fixture: the bytes of a complete log."""
    job, plan = made()
    path, _ = whole(tmp_path_factory.mktemp("log") / "turning.mcap", job, plan)
    return path.read_bytes()


def brief(content):
    return brief_of(lambda at, count: content[at : at + count], len(content))


def folders(tmp_path, logs=None):
    project = tmp_path / "project"
    project.mkdir(exist_ok=True)
    database = tmp_path / "data" / "pendant.db"
    return LogFolders(ProjectFolder(project, database), logs, database), project


def test_a_log_in_short_is_what_all_of_it_says(log, tmp_path):
    found = brief(log)
    (tmp_path / "a.mcap").write_bytes(log)
    read = read_run(str(tmp_path / "a.mcap")).value
    assert (found.program, found.robot, found.started) == (read.program, read.robot.name, read.started)
    assert found.well is True
    assert found.duration == pytest.approx(read.end, abs=0.2)
    job, plan = made()
    seen = samples(job, plan, length=1.0)
    told = [Changed(0.1, State.MOVE, ""), job, *seen.notices, Remark(1.2, "look", warning=True)]
    ended = Ended(False, "a motor has failed", "look at it", command="P0010 MOVEJ", done=1.0, code="Y1602")
    path = write(tmp_path / "b.mcap", job, [*told, progress(job, 1.3, 1.0)], ended)
    found = brief(path.read_bytes())
    assert (found.well, found.what, found.code) == (False, "a motor has failed", "Y1602")


def test_a_log_names_who_ordered_the_first_motion(tmp_path):
    job, _ = made()
    with RunLog.open(tmp_path / "a.mcap", job, "1.2.3.4:1025", version="1", client="anna") as written:
        is_open = brief(written.path.read_bytes())
    found = brief(written.path.read_bytes())
    assert (is_open.client, is_open.is_whole, found.client, found.is_whole) == ("anna", False, "anna", True)
    assert found.well is None


def test_cut_and_forged_logs_in_short(log):
    dice, whole_ones = random.Random(1), 0
    began = time.perf_counter()
    for _ in range(1500):
        content = bytearray(log)
        for _ in range(dice.randint(1, 5)):
            kind, at = dice.randrange(3), dice.randrange(max(1, len(content)))
            if kind == 0:
                content = content[:at]
            elif kind == 1 and content:
                content[at] = dice.randrange(256)
            else:
                content[-dice.randrange(1, 700) :] = dice.randbytes(dice.randrange(60))
        found = brief(bytes(content))
        whole_ones += found is not None and found.is_whole
        if found is not None:
            assert len(found.what) <= 300
            assert found.duration is None or found.duration >= 0.0
    assert whole_ones < 1500
    assert brief(log[: len(log) // 2]).is_whole is False
    for nothing in (b"", b"a text", log[8:], log[:9], b"\x89MCAP0\r\n" + b"\xff" * 5000):
        assert brief(nothing) is None
    assert time.perf_counter() - began < 20.0


def test_a_thousand_logs_are_listed_at_once(log, tmp_path):
    place, project = folders(tmp_path)
    runs = project / "yarc-runs"
    runs.mkdir()
    for number in range(1100):
        (runs / f"p-{number:04}.mcap").write_bytes(log)
        os.utime(runs / f"p-{number:04}.mcap", (1e9 + number, 1e9 + number))
    listing, reads = Listing(place), []
    for _ in range(2):
        began = time.perf_counter()
        told = listing.listed("")
        reads.append(time.perf_counter() - began)
        assert len(told.runs) == 1000
        assert told.cut
        assert told.runs[0].file == "yarc-runs/p-1099.mcap"
        assert all(one.state == "whole" and one.well for one in told.runs)
    assert reads[0] < 5.0
    (runs / "p-1099.mcap").write_bytes(log[:-100])
    assert listing.listed("").runs[0].state == "under way"  # the log has no end, but was changed just now
    os.utime(runs / "p-1099.mcap", (2e9, 1.5e9))
    assert listing.listed("").runs[0].state == "cut off"
    assert listing.listed("p-1099.mcap").runs[0].state == "under way"


def test_only_logs_of_the_two_folders_are_opened(log, tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "secret.mcap").write_bytes(log)
    logs = tmp_path / "logs"
    (logs / "deeper").mkdir(parents=True)
    (logs / "deeper" / "x.mcap").write_bytes(log)
    (logs / "own.mcap").write_bytes(log)
    (logs / "key.pem").write_text("secret")
    place, project = folders(tmp_path, logs)
    for name in NAMES:
        (project / name).write_bytes(log)
    (project / "text.mcap").write_text("a text")
    (project / ".hidden.mcap").write_bytes(log)
    (project / "link.mcap").symlink_to(outside / "secret.mcap")
    os.mkfifo(project / "pipe.mcap")
    (project / "note.txt").write_text("a note")
    told = {one.file: one for one in Listing(place).listed("").runs}
    assert {name for name, one in told.items() if one.state == "whole"} == {*NAMES, "own.mcap"}
    assert told["text.mcap"].state == "unreadable"
    assert told["own.mcap"].place == "logs"
    wanted = [
        *(
            ("project", name)
            for name in ("link.mcap", "pipe.mcap", ".hidden.mcap", "note.txt", "missing.mcap")
        ),
        *(("project", name) for name in ("../outside/secret.mcap", "../logs/own.mcap", "/etc/passwd", "")),
        *(("project", str(outside / "secret.mcap")), ("logs", "deeper/x.mcap"), ("logs", "key.pem")),
        *(("logs", "../outside/secret.mcap"), ("logs", "a\0.mcap"), ("project", "x" * 5000 + ".mcap")),
    ]
    for kind, name in wanted:
        with pytest.raises(Trouble), place.opened(kind, name):
            pass
    with place.opened("logs", "own.mcap") as (handle, told, _):
        assert os.pread(handle, 8, 0) == log[:8]
        assert told.st_size == len(log)


def test_what_a_log_shows(log, tmp_path):
    (tmp_path / "a.mcap").write_bytes(log)
    found = shown(str(tmp_path / "a.mcap"))
    assert found.well
    assert [one.title for one in found.lines] == [
        *("Positions", "Actual − planned", "Commanded off the path", "Following error"),
    ]
    for one in (*found.lines, found.planned):
        assert len(one.values) == len(one.names) == 6
        assert 0 < len(one.times) <= 2000
        assert all(len(row) == len(one.times) for row in one.values)
        assert list(one.times) == sorted(one.times)
    assert len(found.way.times) == len(found.way.joints) <= 1500
    assert found.events[-1].text == "came to its end"
    part = shown(str(tmp_path / "a.mcap"), (2.0, 3.0))
    assert 2.0 <= part.lines[0].times[0] < part.lines[0].times[-1] <= 3.0
    assert shown(str(tmp_path / "a.mcap"), (500.0, 501.0)).lines[0].times == ()
    (tmp_path / "cut.mcap").write_bytes(log[: 3 * len(log) // 4])
    assert shown(str(tmp_path / "cut.mcap")).notes
    (tmp_path / "text.mcap").write_text("a text")
    with pytest.raises(CannotShow, match="no MCAP file"):
        shown(str(tmp_path / "text.mcap"))


def forged(log, path, messages):
    """Write a log with the program and robot of another log, and with the given messages."""
    records = read_records(log)
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata(METADATA, records.metadata[METADATA])
        for name, content in records.attachments.items():
            writer.add_attachment(0, 0, name, "text/plain", content)
        channels = {}
        for topic, content in messages:
            if topic not in channels:
                channels[topic] = writer.register_channel(f"/{topic}", "json", 0)
            data = json.dumps(content).encode()
            writer.add_message(channels[topic], 0, data, 0)
        writer.finish()
    return path


def rows(log):
    return [content for topic, content in read_records(log).messages if topic == "positions"]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_forged_logs_are_shown_or_refused_in_words(log, tmp_path):
    whole_row = rows(log)[5]
    numbers = (math.nan, math.inf, -1e308, 1e308, 0, -5, "x", None, [], 1e18)
    hostile = [[("positions", {**one, "time_s": time_s}) for one in rows(log)[:50]] for time_s in numbers]
    hostile += [
        [("positions", {**one, "program_time_s": number}) for one in rows(log)[:50]] for number in numbers
    ]
    hostile += [
        [("positions", {**whole_row, key: dict.fromkeys(whole_row[key], number)})] * 20
        for key in ("actual_joints", "commanded_joints")
        for number in numbers
    ]
    hostile += [
        [("state", {"time_s": number, "state": "fault", "why": "x" * 2000})] * 1500
        for number in (1.0, -1e300)
    ]
    hostile += [
        [("events", {"time_s": 0.001 * at, "kind": "warning", "text": "<b>\u202e\n"}) for at in range(5000)],
        [("signals", {"time_s": 1.0, "kind": "set", "name": "n" * 10_000, "variable": "M1", "value": 1e400})]
        * 50,
        [("outcome", {"time_s": 1, "well": "yes", "what": {}, "remedy": 1, "command": [], "done_s": "x"})],
        [
            ("jobs", {"time_s": 0.1 * at, "job": "j", "duration_s": 1, "of_program": True})
            for at in range(500)
        ],
        [],
    ]
    began = time.perf_counter()
    for number, messages in enumerate(hostile):
        path = forged(log, tmp_path / f"{number}.mcap", messages)
        brief(path.read_bytes())
        try:
            found = as_json(str(path))
        except CannotShow:
            continue
        assert len(found) < 4 << 20
        told = json.loads(found)
        if "refused" not in told:
            assert len(told["events"]) <= 1000
            assert all("\u202e" not in one["text"] for one in told["events"])
    assert time.perf_counter() - began < 60.0


@contextmanager
def handled(path):
    handle = os.open(path, os.O_RDONLY)
    try:
        yield handle, os.fstat(handle)
    finally:
        os.close(handle)


def test_logs_are_read_in_processes_of_their_own(log, tmp_path, monkeypatch):
    for name, content in (("a", log), ("text", b"a text"), ("b", log)):
        (tmp_path / name).write_bytes(content)
    with (tmp_path / "huge").open("wb") as file:
        file.write(log[:8])
        file.truncate(500 << 20)

    async def whole_test():
        readings = Readings()

        async def read(name, window=None):
            with handled(tmp_path / name) as (handle, told):
                return await readings.shown(handle, told, window)

        began = time.perf_counter()
        found = RunShown.model_validate_json(await read("a"), strict=False)
        process = time.perf_counter() - began
        assert found.program == "turning.yarc"
        began = time.perf_counter()
        assert await read("a") == found.model_dump_json().encode()
        assert time.perf_counter() - began < 0.5 * process, "it was read again"
        with pytest.raises(Trouble, match=r"^the log is no MCAP file"):
            await read("text")
        with pytest.raises(Trouble, match="bytes"):
            await read("huge")
        # Of six requests at once, two are refused as too many.
        monkeypatch.setattr(reading, "WAITING", 2)
        windows = [(0.1 * number, 9.0) for number in range(1, 7)]
        answers = await asyncio.gather(*(read("b", one) for one in windows), return_exceptions=True)
        refused = [one for one in answers if isinstance(one, Trouble)]
        assert len(refused) == 2
        assert all(one.code == "busy" for one in refused)
        assert all(json.loads(one)["lines"] for one in answers if isinstance(one, bytes))
        # A reading process that needs too much time or memory is ended.
        for name, value, said in (("_LONGEST", 0.05, "longer"), ("_MOST_MEMORY", 60 << 20, "memory")):
            with monkeypatch.context() as patched:
                patched.setattr(reading, name, value)
                with pytest.raises(Trouble, match=said):
                    await read("a", (0.5, 1.0 + len(name)))
        task = asyncio.ensure_future(read("a", (0.25, 1.25)))
        await asyncio.sleep(0.1)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    asyncio.run(asyncio.wait_for(whole_test(), 120.0))


def test_routes(log, monkeypatch, tmp_path):
    project = tmp_path / "project"
    (project / "yarc-runs").mkdir(parents=True)
    for name in NAMES:
        (project / "yarc-runs" / name).write_bytes(log)

    async def instead(self, handle, window):
        with handled(f"/dev/fd/{handle}"):
            return shown(f"/dev/fd/{handle}", window).model_dump_json().encode()

    monkeypatch.setattr(Readings, "_read", instead)

    async def work(place):
        vic = place.logged_in("vic", Role.VIEWER)
        told = (await vic.get("/api/runs")).told
        assert {one["file"] for one in told["runs"]} == {f"yarc-runs/{name}" for name in NAMES}
        found = await vic.get("/api/runs/show/project/yarc-runs/turning.mcap?from=1&to=2.5")
        assert found.told["lines"][0]["times"][0] >= 1.0
        file = await vic.get("/api/runs/download/project/yarc-runs/" + NAMES[1])
        assert file.content == log
        assert file.headers["content-disposition"].startswith('attachment; filename="a _quoted_ _b_.mcap"')
        for query in ("?from=1", "?from=2&to=1", "?from=nan&to=1", "?from=-inf&to=inf", "?from=x&to=1"):
            path = f"/api/runs/show/project/yarc-runs/turning.mcap{query}"
            assert (await vic.get(path)).status == 400
        for path in ("show/project/x.mcap", "show/else/x.mcap", "download/logs/x.mcap", "show/project/../x"):
            assert (await vic.get(f"/api/runs/{path}")).status in (404, 409)

        # A user who logs out while a log is being read doesn't get its content.
        async def logged_out(self, handle, window):
            place.service.accounts.sessions.end(vic.session)
            return await instead(self, handle, window)

        monkeypatch.setattr(Readings, "_read", logged_out)
        assert (await vic.get("/api/runs/show/project/yarc-runs/turning.mcap?from=3&to=4")).status == 401
        for path in ("", "/show/project/yarc-runs/turning.mcap", "/download/project/yarc-runs/turning.mcap"):
            assert (await vic.get(f"/api/runs{path}")).status == 401

    async def everything():
        async with pendant(monkeypatch, tmp_path, project=project) as place:
            await work(place)

    run(everything())
