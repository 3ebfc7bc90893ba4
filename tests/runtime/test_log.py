"""Tests of the log of a run: its content, and that no failure of the log affects the robot."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from report.runs.made_up_runs import ANCHOR, made, samples, whole, write
from runtime.virtual import World

from yarclang.backend_pmac.settings import settings_text
from yarclang.runtime.log import FLUSH_EACH, RunLog
from yarclang.runtime.log_record import Anchor
from yarclang.runtime.notices import (
    Abort,
    Changed,
    Fail,
    Hold,
    Override,
    Progress,
    Remark,
    Resume,
)
from yarclang.runtime.outcome import Ended
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.runtime.sample import Sample
from yarclang.runtime.state import State
from yarclang.simulator.commissioning import commissioned

FULL = Path("/dev/full")


@pytest.fixture(scope="module")
def job():
    return made()[0]


SCENE = {"/transforms", "/robot"}


def messages(path):
    """Return topic, log time and content of all messages, as read by another library. Messages of the scene
    are left out.
    """
    with path.open("rb") as stream:
        found = make_reader(stream, validate_crcs=True).iter_messages(log_time_order=False)
        return [
            (channel.topic, message.log_time, json.loads(message.data))
            for _, channel, message in found
            if channel.topic not in SCENE
        ]


def opened(place, job, **options):
    return RunLog.open(place, job, "10.0.0.1:1025", version="1.2.3", **({"anchor": ANCHOR} | options))


def test_other_readers_find_what_was_told(tmp_path, job):
    t = ANCHOR.clock
    log = opened(tmp_path / "a.mcap", job)
    log.begin(job)
    log.take(Changed(t + 0.5, State.HOLD, "hold requested"))
    log.take(Progress(t + 1.0, 2.0, 7.0, "P0010 MOVEJ_LSPB", 1))
    log.take(Remark(t + 1.5, "careful", warning=True))
    log.take(Remark(t + 1.6, "all well"))
    for order in (Hold(), Resume(), Abort(), Override(12.5), Fail("the door is open")):
        log.ordered(t + 1.7, order)
    counts = np.arange(6.0) * 1000.0
    log.take(Sample(t + 2.0, 1.9, counts, np.full(6, -1.5)))
    log.close(Ended(False, "stopped", "go on", np.zeros(6), "P0010 MOVEJ_LSPB", "P0010", 2.0))
    wall = ANCHOR.wall
    orders = ["hold", "resume", "abort", "override 12.5 %", "fail: the door is open"]
    found = messages(log.path)
    assert found[:-2] == [
        (
            "/jobs",
            wall,
            {"time_s": 0.0, "job": job.name, "offset_s": 0.0, "duration_s": job.duration, "of_program": True},
        ),
        ("/state", wall + 500_000_000, {"time_s": 0.5, "state": "hold", "why": "hold requested"}),
        (
            "/progress",
            wall + 1_000_000_000,
            {"time_s": 1.0, "done_s": 2.0, "left_s": 7.0, "command": "P0010 MOVEJ_LSPB", "source_line": 1},
        ),
        ("/events", wall + 1_500_000_000, {"time_s": 1.5, "kind": "warning", "text": "careful"}),
        ("/events", wall + 1_600_000_000, {"time_s": 1.6, "kind": "remark", "text": "all well"}),
        *(
            ("/events", wall + 1_700_000_000, {"time_s": 1.7, "kind": "order", "text": text})
            for text in orders
        ),
    ]
    topic, when, content = found[-2]
    assert (topic, when) == ("/positions", wall + 2_000_000_000)
    assert content["actual_counts"] == counts.tolist()
    assert content["following_error_counts"] == [-1.5] * 6
    assert content["commanded_counts"] == (counts - 1.5).tolist()
    gear = job.robot.actuation.gear
    assert content["actual_joints"]["J1_deg"] == 0.0
    assert content["actual_joints"]["J2_deg"] == pytest.approx(1000.0 / gear[1], abs=1e-7)
    assert content["commanded_joints"]["J2_deg"] == pytest.approx(998.5 / gear[1], abs=1e-7)
    topic, when, content = found[-1]
    assert (topic, content["well"], content["done_s"]) == ("/outcome", False, 2.0)
    assert content["joints"] == {f"J{n}_deg": 0.0 for n in range(1, 7)}


def test_what_does_not_change_stands_at_the_beginning(tmp_path, job):
    log = opened(tmp_path / "a.mcap", job)
    log.close()
    with log.path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        attachments = {one.name: one.data.decode() for one in reader.iter_attachments()}
        (metadata,) = reader.iter_metadata()
        topics = {channel.topic: channel for channel in reader.get_summary().channels.values()}
        schemas = reader.get_summary().schemas.values()
    assert attachments["program.yarc"] == job.source
    assert attachments["program.pmc"] == job.text
    assert attachments["certificate.json"] == job.certificate
    assert metadata.metadata["robot"] == "INDUSTRIAL6"
    assert metadata.metadata["fingerprint"] == job.robot.fingerprint
    assert metadata.metadata["yarclang"] == "1.2.3"
    assert metadata.metadata["controller"] == "10.0.0.1:1025"
    assert metadata.metadata["started"] == "2026-09-21T14:13:20.000+00:00"
    own = {"/positions", "/state", "/progress", "/events", "/signals", "/jobs", "/outcome"}
    assert set(topics) == own | SCENE
    assert {one.encoding for one in schemas} == {"jsonschema"}
    for one in schemas:
        is_own = not one.name.startswith("foxglove.")
        assert (json.loads(one.data)["properties"].get("time_s") == {"type": "number"}) == is_own


def test_every_message_is_as_its_schema_says(tmp_path):
    path, _ = whole(tmp_path / "a.mcap", *made())
    with path.open("rb") as stream:
        for schema, _, message in make_reader(stream).iter_messages():
            properties = json.loads(schema.data)["properties"]
            assert set(json.loads(message.data)) == set(properties)


def test_the_wall_clock_of_a_simulator_that_hurries(tmp_path, job):
    log = opened(tmp_path / "a.mcap", job, anchor=Anchor(100.0, 10**18, pace=20.0))
    log.take(Remark(140.0, "40 s later there, 2 s later here"))
    log.close()
    ((_, when, content),) = messages(log.path)
    assert when == 10**18 + 2 * 10**9
    assert content["time_s"] == 40.0


# file names


def test_names(tmp_path, monkeypatch, job):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    for _ in range(3):
        opened(None, job).close()
    opened(Path("given.mcap"), job).close()
    opened(Path("given.mcap"), job).close()
    Path("there").mkdir()
    opened(Path("there"), job).close()
    opened(Path("new/folder/x.mcap"), job).close()
    found = sorted(path.as_posix() for path in Path().rglob("*.mcap"))
    stem = "turning-20260921-141320"
    assert found == [
        "given-2.mcap",
        "given.mcap",
        "new/folder/x.mcap",
        f"there/{stem}.mcap",
        f"yarc-runs/{stem}-2.mcap",
        f"yarc-runs/{stem}-3.mcap",
        f"yarc-runs/{stem}.mcap",
    ]


@pytest.mark.parametrize(
    ("name", "begins"),
    [
        ("a/b/größe 1.yarc", "größe_1-"),
        ("<stdin>", "stdin-"),
        ("..", "program-"),
        ("x" * 300 + ".yarc", "x" * 50 + "-"),
        ("\udcff.yarc", "program-"),
        ("日本" * 100, "日本" * 25 + "-"),
    ],
)
def test_names_of_odd_programs(tmp_path, job, name, begins):
    from dataclasses import replace

    log = opened(tmp_path, replace(job, name=name))
    log.close()
    assert log.failure is None
    assert log.path.name.startswith(begins)
    assert log.path.parent == tmp_path


def test_a_log_never_overwrites(tmp_path, job):
    path = tmp_path / "a.mcap"
    path.write_text("mine")
    log = opened(path, job)
    log.close()
    assert path.read_text() == "mine"
    assert log.path == tmp_path / "a-2.mcap"


# errors of the disk


def test_a_full_disk_at_the_beginning(tmp_path, job):
    with pytest.raises(OSError, match="No space left"):
        opened(FULL, job)
    with pytest.raises(FileExistsError):
        opened(Path("/dev/null/x.mcap"), job)


def test_nothing_is_left_of_a_log_that_could_not_begin(tmp_path, job, monkeypatch):
    def fail(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("mcap.writer.Writer.add_attachment", fail)
    with pytest.raises(OSError, match="No space left"):
        opened(tmp_path / "a.mcap", job)
    assert list(tmp_path.iterdir()) == []


class Disk:
    """A file on a disk with limited space. It can also make writers wait."""

    def __init__(self, path, room):
        self.file, self.room = path.open("wb"), room
        self.may_write = threading.Event()
        self.may_write.set()

    def write(self, data):
        self.may_write.wait()
        some = data[: self.room]
        self.file.write(some)
        self.file.flush()
        self.room -= len(some)
        if len(some) < len(data):
            raise OSError(28, "No space left on device")
        return len(data)

    def tell(self):
        return self.file.tell()

    def flush(self):
        self.file.flush()

    def close(self):
        self.file.close()


def on(disk, path, job, **options):
    return RunLog(disk, path, job, "", version="0", anchor=ANCHOR, **options)


def test_a_disk_that_fills_up_is_told_of_once_and_from_another_thread(tmp_path, job):
    told = []
    disk = Disk(tmp_path / "a.mcap", 10**9)
    log = on(
        disk, tmp_path / "a.mcap", job, on_failure=lambda why: told.append((why, threading.current_thread()))
    )
    for number in range(3):
        log.take(Changed(ANCHOR.clock + number, State.STOP, "before"))
    wait_for(lambda: log._written == 3)
    disk.room = 10
    for number in range(3, 100):
        log.take(Changed(ANCHOR.clock + number, State.STOP, "behind"))
    log.take(Remark(200.0, "x"))
    wait_for(lambda: log.failure is not None)
    log.take(Remark(201.0, "nobody reads it"))
    log.begin(job)
    log.ordered(0.0, Hold())
    log.close(Ended(True))
    log.close()
    ((why, thread),) = told
    assert why == log.failure == "no space left on device"
    assert thread is not threading.main_thread()
    from yarclang.report.runs.log import read_run

    run = read_run(str(log.path))
    assert [one.code for one in run.diagnostics] == ["Y1402"]
    assert [one.why for one in run.value.told] == ["before"] * 3


def test_the_disk_is_full_at_the_last_moment(tmp_path, job):
    disk = Disk(tmp_path / "a.mcap", 10**9)
    told = []
    log = on(disk, tmp_path / "a.mcap", job, on_failure=told.append)
    disk.room = 0
    log.close(Ended(True))
    assert told == [log.failure] == ["no space left on device"]


def removed(path):
    path.unlink()


def moved(path):
    path.rename(path.with_name("b.mcap"))


def folder_removed(path):
    shutil.rmtree(path.parent)


def folder_moved(path):
    path.parent.rename(path.parent.with_name("away"))


def folder_replaced(path):
    folder_removed(path)
    path.parent.write_text("")


def replaced(path):
    path.unlink()
    path.write_text("x" * 100_000)


def copied_over(path):
    shutil.copy(path, path.with_name("b.mcap"))
    path.with_name("b.mcap").replace(path)


def linked(path):
    path.unlink()
    path.symlink_to("nowhere")


def cut(path):
    os.truncate(path, 0)


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        (removed, "doesn't exist any more"),
        (moved, "doesn't exist any more"),
        (folder_removed, "doesn't exist any more"),
        (folder_moved, "doesn't exist any more"),
        (folder_replaced, "doesn't exist any more"),
        (replaced, "is a different file now"),
        (copied_over, "is a different file now"),
        (linked, "doesn't exist any more"),
    ],
)
@pytest.mark.parametrize("full", [False, True])
def test_a_log_that_is_gone_is_lost(tmp_path, job, harm, said, full):
    path = tmp_path / "runs" / "a.mcap"
    path.parent.mkdir()
    disk = Disk(path, 10**9)
    log = on(disk, path, job)
    log.take(Changed(ANCHOR.clock, State.STOP, "before"))
    wait_for(lambda: log._written == 1)
    assert log.lost() == log.loss == log.problem == ""
    harm(path)
    assert said in log.lost()
    if full:
        disk.room = 0
    log.close(Ended(True))
    assert said in log.loss
    assert log.problem.startswith(f"the run log can't be used any more: {path} {said}")


def test_a_log_that_was_cut_is_lost(tmp_path, job):
    log = opened(tmp_path / "a.mcap", job)
    log.take(Changed(ANCHOR.clock, State.STOP, "before"))
    wait_for(lambda: log._written == 1)
    log.close(Ended(True))
    assert log.problem == ""
    size = log.path.stat().st_size
    cut(log.path)
    assert log.lost(size) == f"was truncated during the run: 0 of {size:,} bytes are left"


def test_a_log_that_was_moved_and_linked_to_is_found(tmp_path, job):
    log = opened(tmp_path / "a.mcap", job)
    log.path.rename(tmp_path / "b.mcap")
    log.path.symlink_to("b.mcap")
    log.close(Ended(True))
    assert log.problem == ""


def test_a_device_is_no_loss(job):
    log = opened(Path("/dev/null"), job)
    log.close(Ended(True))
    assert log.problem == ""


def test_who_wanted_to_know_may_be_gone(tmp_path, job):
    def gone(_):
        raise RuntimeError("Event loop is closed")

    disk = Disk(tmp_path / "a.mcap", 10**9)
    log = on(disk, tmp_path / "a.mcap", job, on_failure=gone)
    disk.room = 0
    log.take(Changed(0.0, State.STOP, ""))
    log.close()
    assert log.failure == "no space left on device"


def test_a_slow_disk_makes_nobody_wait(tmp_path, job):
    disk = Disk(tmp_path / "a.mcap", 10**9)
    log = on(disk, tmp_path / "a.mcap", job)
    disk.may_write.clear()
    sample = Sample(ANCHOR.clock, 0.0, np.zeros(6), np.zeros(6))
    log.take(Changed(ANCHOR.clock, State.MOVE, ""))
    since = time.perf_counter()
    for _ in range(1000):
        log.take(sample)
    assert time.perf_counter() - since < 5.0, "the disk never goes on"
    disk.may_write.set()
    log.close()
    assert log.failure is None
    assert len(messages(log.path)) == 1001


def test_a_disk_that_never_answers_is_given_up(tmp_path, job, monkeypatch):
    monkeypatch.setattr("yarclang.runtime.log._LONGEST_CLOSE", 0.05)
    disk = Disk(tmp_path / "a.mcap", 10**9)
    log = on(disk, tmp_path / "a.mcap", job)
    disk.may_write.clear()
    log.take(Changed(ANCHOR.clock, State.MOVE, ""))
    log.close()
    assert log.failure == "the disk hasn't responded for 0.05 s"
    disk.may_write.set()


def test_a_bug_ends_the_log_and_is_told(tmp_path, job):
    told = []
    log = opened(tmp_path / "a.mcap", job, on_failure=told.append)
    log.take(Sample(0.0, 0.0, np.zeros(2), np.zeros(6)))
    log.close()
    assert told == [log.failure]
    assert log.failure.startswith("ValueError: ")


def wait_for(condition):
    until = time.monotonic() + 40.0  # long enough for a busy computer
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.005)


KILLED = """
import os, signal, sys, time
from pathlib import Path
from report.runs.made_up_runs import made
from yarclang.runtime.log import RunLog
from yarclang.runtime.notices import Remark
log = RunLog.open(Path(sys.argv[1]), made()[0], "", version="0")
for number in range(1000):
    log.take(Remark(time.monotonic(), str(number)))
    print(number, flush=True)
    time.sleep(0.02)
"""


def test_a_process_that_is_killed_loses_a_second_at_most(tmp_path):
    """If the process is killed with kill -9, the log lacks at most the last second of what the process has
    reported.
    """
    path = tmp_path / "a.mcap"
    tests = str(Path(__file__).parents[1])
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, path], stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": tests}
    )
    assert process.stdout is not None
    for _ in range(90):
        last = int(process.stdout.readline())
    process.send_signal(signal.SIGKILL)
    process.wait()
    last = max([last, *map(int, process.stdout.read().split())])
    from yarclang.report.runs.log import read_run

    run = read_run(str(path))
    assert [one.code for one in run.diagnostics] == ["Y1402"]
    assert "is unfinished" in run.diagnostics[0].message
    numbers = [int(one.text) for one in run.value.told]
    assert numbers == list(range(len(numbers)))
    assert last - numbers[-1] <= (FLUSH_EACH + 0.5) / 0.02


def test_a_run_on_the_simulated_controller(tmp_path, job):
    """The log of a run on the simulator, in virtual time, has the states, and positions that end at the
    program's end.
    """
    machine = commissioned(job.robot, settings_text(job.robot))
    world = World(machine)
    log = RunLog.open(tmp_path, job, "sim", version="0", anchor=Anchor(world.now, 0))
    world.perform(connect(world.operation))
    log.begin(job)
    world.at.append((world.now + 2.0, lambda: world.operation.orders.append(Hold())))
    world.at.append((world.now + 4.0, lambda: world.operation.orders.append(Resume())))
    ended = world.perform(perform(world.operation, job))
    for notice in world.told:
        log.take(notice)
    log.close(ended)
    assert log.failure is None
    from yarclang.report.runs.log import read_run
    from yarclang.report.runs.planned import planned_motion
    from yarclang.report.runs.tracking import tracking_of

    run = read_run(str(log.path)).value
    states = [one.state for one in run.told if isinstance(one, Changed)]
    assert states == [State.STOP, State.INIT, State.MOVE, State.HOLD, State.MOVE, State.STOP]
    assert run.outcome.well
    assert run.actual[-1] == pytest.approx(job.end, abs=1e-3)
    tracking = tracking_of(run, planned_motion(run).value)
    # One count is about 4e-5 deg.
    assert np.rad2deg(np.abs(tracking.off_path).max()) < 1e-4
    assert tracking.times[-1] == pytest.approx(job.duration, abs=0.1)


def test_a_part_belongs_to_the_program_and_an_approach_does_not(tmp_path, job):
    way = made("P0001 MOVEJ_LSPB 10 0 0 0 0 0 [3] (deg,s)\n", name="approach")[0]
    path = write(tmp_path / "a.mcap", job, [way, *samples(*made()).notices[:1], job])
    assert [content["of_program"] for topic, _, content in messages(path) if topic == "/jobs"] == [
        False,
        True,
    ]
