"""Reading of logs: complete ones, and damaged or other files."""

import io
import json

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import Writer
from report.runs.made_up_runs import ANCHOR, made, samples, whole, write

from yarclang.report.runs.log import read_run
from yarclang.report.runs.messages import Outcome, Pass, read_messages
from yarclang.report.runs.planned import planned_motion
from yarclang.report.runs.plot import draw_run
from yarclang.report.runs.text import moments_of
from yarclang.runtime.log import RunLog
from yarclang.runtime.log_record import METADATA, Anchor
from yarclang.runtime.notices import Changed, Hold, Progress, Remark
from yarclang.runtime.outcome import Ended
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded
from yarclang.runtime.state import State


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The path of a log, and the samples in it."""
    return whole(tmp_path_factory.mktemp("log") / "a.mcap", *made())


def codes(result):
    return [one.code for one in result.diagnostics]


def test_what_was_logged_is_read(log):
    path, truth = log
    job, plan = made()
    result = read_run(str(path))
    assert result.diagnostics == ()
    run = result.value
    assert (run.file, run.program, run.controller, run.version) == (
        str(path),
        "turning.yarc",
        "127.0.0.1:1025",
        "0.1.0",
    )
    assert (run.text, run.source, run.certificate) == (job.text, job.source, job.certificate)
    assert run.commands == job.commands
    assert (run.duration, run.pace, run.started) == (job.duration, 1.0, "2026-09-21T14:13:20.000+00:00")
    robot = run.robot
    assert (robot.name, robot.fingerprint) == (job.robot.name, job.robot.fingerprint)
    assert (robot.joint_names, robot.axis_unit_names) == (job.robot.joint_names, job.robot.axis_unit_names)
    assert robot.controller == job.robot.controller
    assert robot.lower == pytest.approx(job.robot.limits.lower)
    assert robot.upper == pytest.approx(job.robot.limits.upper)
    assert run.times == pytest.approx(np.array([one.time for one in truth.notices]) - ANCHOR.clock, abs=1e-6)
    assert run.program_times == pytest.approx([one.program_time for one in truth.notices])
    assert run.commanded == pytest.approx(truth.commanded, abs=1e-8)
    assert run.actual == pytest.approx(np.array([one.joints(job.robot) for one in truth.notices]), abs=1e-8)
    assert run.following.tolist() == [one.following.tolist() for one in truth.notices]
    assert np.unique(run.passes).tolist() == [0]
    assert run.outcome.well
    assert run.outcome.done == job.duration
    assert run.end == run.told[-1].time
    assert not run.actual.flags.writeable
    assert plan.duration == pytest.approx(job.duration)


def test_everything_that_is_told_comes_back(tmp_path):
    job, _ = made()
    t = ANCHOR.clock
    told = [
        job,
        *(Changed(t + 1.0, state, f"into {state.value}") for state in State),
        Progress(t + 2.0, 1.0, 2.0, "P0010 MOVEJ", 3),
        Remark(t + 3.0, "äöü", warning=True),
    ]
    path = write(tmp_path / "a.mcap", job, told, Ended(False, "why", "do", None, "P0010 MOVEJ", "P0010", 1.5))
    run = read_run(str(path)).value
    assert run.told[0] == Pass(0.0, job.name, job.duration, of_program=True)
    assert run.told[1:7] == tuple(Changed(1.0, state, f"into {state.value}") for state in State)
    assert run.told[7:9] == (Progress(2.0, 1.0, 2.0, "P0010 MOVEJ", 3), Remark(3.0, "äöü", warning=True))
    outcome = run.told[9]
    assert isinstance(outcome, Outcome)
    assert (outcome.well, outcome.what, outcome.remedy, outcome.command, outcome.done) == (
        False,
        "why",
        "do",
        "P0010 MOVEJ",
        1.5,
    )


SIGNALS = (
    OutputSet(1.0, "GRIP", "M1", 1.0),
    InputChanged(1.5, "PART_READY", "M11", 0.0, "sensor"),
    WaitBegan(2.0, "P0010(#1)", "PART_READY", "M11", 1.0, 0.0),
    WaitEnded(3.0, "P0010(#1)", "PART_READY", "M11", 1.0, 1.0, True),
)


def test_inputs_and_outputs_come_back(tmp_path):
    job, _ = made()
    log = RunLog.open(tmp_path, job, "somewhere", version="1", anchor=Anchor(0.0, ANCHOR.wall))
    for one in SIGNALS:
        log.take(one)
    log.close()
    run = read_run(str(log.path)).value
    assert run.told == SIGNALS
    lines = [one.line for one in moments_of(run)]
    assert lines == [
        "SET GRIP ON",
        "input PART_READY is OFF (sensor)",
        "",
        "P0010(#1) WAIT: PART_READY is ON after 1.0 s",
    ]


@pytest.mark.parametrize(
    "content",
    [
        {"kind": "set"},
        {"kind": "set", "name": "A", "variable": "M1", "value": "much"},
        {"kind": "wait ended", "name": "A", "variable": "M1", "value": 1.0},
    ],
)
def test_signals_that_say_nothing_are_counted(content):
    found = read_messages(None, [("signals", {"time_s": 1.0, **content})])
    assert (found.told, found.unread) == ([], 1)


def test_signals_of_a_later_kind_are_left_out():
    content = {"time_s": 1.0, "kind": "later", "name": "A", "variable": "M1", "value": 1.0}
    found = read_messages(None, [("signals", content)])
    assert (found.told, found.unread) == ([], 0)


def test_orders_are_told(tmp_path):
    job, _ = made()
    with RunLog.open(tmp_path / "a.mcap", job, "", version="0", anchor=ANCHOR) as log:
        log.ordered(ANCHOR.clock + 1.0, Hold())
    assert read_run(str(log.path)).value.told == (Remark(1.0, "ordered: hold"),)


def test_an_empty_run(tmp_path):
    job, _ = made()
    result = read_run(str(write(tmp_path / "a.mcap", job, [])))
    run = result.value
    assert result.diagnostics == ()
    assert (run.told, run.times.shape, run.actual.shape, run.end) == ((), (0,), (0, 6), 0.0)
    assert run.outcome is None


def test_joints_without_limits(tmp_path):
    from dataclasses import replace

    job, _ = made()
    endless = np.where(np.arange(6) == 3, np.inf, job.robot.limits.upper)
    limits = replace(job.robot.limits, upper=endless, lower=-endless)
    path = write(tmp_path / "a.mcap", replace(job, robot=replace(job.robot, limits=limits)), [])
    robot = read_run(str(path)).value.robot
    assert np.isinf(robot.upper).tolist() == [False, False, False, True, False, False]
    assert robot.lower[3] == -np.inf


# truncated and damaged logs, other files


def hold_moments(run):
    """Check that every recorded notice and sample is returned as a moment, with its time."""
    moments = list(moments_of(run))
    times = [*(float(time) for time in run.times), *(one.time for one in run.told)]
    np.testing.assert_array_equal(np.sort([one.time for one in moments]), np.sort(times))
    assert all(one.line.isprintable() for one in moments)


def shown(result):
    """Use a run in all possible ways. This must work for any file that could be read."""
    run = result.value
    hold_moments(run)
    planned = planned_motion(run)
    if planned.value is not None:
        assert draw_run(run, planned.value, "png").startswith(b"\x89PNG")
    return planned


@exercises(read=0.2)
@settings(max_examples=60)
@given(st.data())
def test_a_log_that_is_cut_off_anywhere_is_read_up_to_there(tally, log, tmp_path_factory, data):
    content = log[0].read_bytes()
    needed = content.index(b"program.yarc")
    size = data.draw(st.integers(0, len(content) - 1) | st.integers(needed, len(content) - 1))
    path = tmp_path_factory.mktemp("cut") / "a.mcap"
    path.write_bytes(content[:size])
    result = read_run(str(path))
    tally.count("read", result.value is not None)
    if result.value is None:
        assert codes(result) == ["Y1401"]
        assert size < needed  # everything that is needed is in the first `needed` bytes
        return
    assert codes(result) == ["Y1402"]
    assert "is unfinished" in result.diagnostics[0].message
    run, full = result.value, read_run(str(log[0])).value
    assert run.told == full.told[: len(run.told)] or isinstance(run.told[-1], Outcome)
    assert run.actual.tolist() == full.actual[: len(run.actual)].tolist()
    assert planned_motion(run).diagnostics == ()


def test_the_more_is_there_the_more_is_read(tmp_path):
    """A longer beginning of a log gives more samples, because a chunk ends at each change of state."""
    job, plan = made()
    seen = samples(job, plan).notices
    told = []
    for number, sample in enumerate(seen):
        told.append(sample)
        if number % 20 == 0:
            told.append(Changed(sample.time, State.MOVE, str(number)))
    path = write(tmp_path / "a.mcap", job, told)
    content = path.read_bytes()
    counts = []
    for size in range(0, len(content), 997):
        path.write_bytes(content[:size])
        run = read_run(str(path)).value
        counts.append(len(run.times) if run else 0)
    assert counts == sorted(counts)
    assert len(set(counts)) >= len(seen) // 20
    assert counts[-1] == len(seen)


@exercises(read=0.01, refused=0.01)
@settings(max_examples=150)
@given(st.data())
def test_turned_bits_are_findings(tally, log, tmp_path_factory, data):
    content = bytearray(log[0].read_bytes())
    places = st.integers(0, len(content) - 1)
    for place, bit in data.draw(st.lists(st.tuples(places, st.integers(0, 7)), min_size=1, max_size=3)):
        content[place] ^= 1 << bit
    if bytes(content) == log[0].read_bytes():
        return
    path = tmp_path_factory.mktemp("turned") / "a.mcap"
    path.write_bytes(content)
    result = read_run(str(path))
    tally.count("read", result.value is not None)
    tally.count("refused", result.value is None)
    if result.value is None:
        assert set(codes(result)) <= {"Y1401", "Y1403"}
    else:
        planned_motion(result.value)
        hold_moments(result.value)


def test_damage_in_the_middle_is_seen_by_the_sum_over_all(log, tmp_path):
    content = log[0].read_bytes()
    place = content.index(b"MOVEJ_LSPB", content.index(b"program.yarc"))
    path = tmp_path / "a.mcap"
    path.write_bytes(content[:place] + b"X" + content[place + 1 :])
    result = read_run(str(path))
    assert codes(result) == ["Y1402"]
    assert "is damaged" in result.diagnostics[0].message
    shown(result)


@settings(max_examples=100)
@given(st.binary(max_size=300))
def test_arbitrary_bytes(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("any") / "a.mcap"
    for beginning in (b"", b"\x89MCAP0\r\n"):
        path.write_bytes(beginning + content)
        assert codes(read_run(str(path))) == ["Y1401"]


def mcap_of(path, metadata, *messages):
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    for name, values in metadata.items():
        writer.add_metadata(name, values)
    channel = writer.register_channel("/positions", "json", 0)
    for message in messages:
        writer.add_message(channel, 0, message, 0)
    writer.finish()
    path.write_bytes(stream.getvalue())
    return path


def test_the_log_of_something_else(tmp_path):
    path = mcap_of(tmp_path / "a.mcap", {"camera": {"a": "b"}}, b"{}")
    (finding,) = read_run(str(path)).diagnostics
    assert finding.code == "Y1401"
    assert "is an MCAP file, but not a run log" in finding.message


def test_another_format_is_another_version(tmp_path):
    path = mcap_of(tmp_path / "a.mcap", {METADATA: {"format": "99", "yarclang": "7.0"}})
    (finding,) = read_run(str(path)).diagnostics
    assert finding.code == "Y1403"
    assert "yarclang 7.0 in format 99" in finding.message
    assert finding.help == "read it with yarclang 7.0"


@pytest.mark.parametrize("content", [b"", b"MOVEJ 1 2 3\n", b"\x89PNG\r\n\x1a\n"])
def test_files_that_are_something_else(tmp_path, content):
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    assert codes(read_run(str(path))) == ["Y1401"]


def test_files_that_are_not_there(tmp_path):
    for path in (tmp_path / "none.mcap", tmp_path):
        assert codes(read_run(str(path))) == ["Y0107"]


def test_messages_of_another_kind_are_counted(log, tmp_path, monkeypatch):
    """The chunks are complete and their checksums right, but they contain messages without a meaning."""
    from yarclang.runtime.log_record import Record

    right = Record._positions
    wrong = iter(
        [
            {"other": 1.0},
            {"program_time_s": 1.0},
            {"program_time_s": [], "actual_joints": {}, "commanded_joints": {}, "following_error_counts": []},
        ]
    )
    monkeypatch.setattr(Record, "_positions", lambda self, sample: next(wrong, None) or right(self, sample))
    job, plan = made()
    result = read_run(str(write(tmp_path / "a.mcap", job, samples(job, plan).notices)))
    assert codes(result) == ["Y1402"]
    assert "3 of its messages" in result.diagnostics[0].message
    assert len(result.value.times) == len(samples(job, plan).notices) - 3
    shown(result)


@pytest.mark.parametrize(
    ("old", "new"),
    [("SPLINE1", "LINEAR"), ("; target rotary", "; target prog"), ("CLOSE\n", "CLOSE\nB1R\n")],
)
def test_a_text_that_cannot_be_planned(tmp_path, old, new):
    from dataclasses import replace

    job, _ = made()
    run = read_run(str(write(tmp_path / "a.mcap", replace(job, text=job.text.replace(old, new)), []))).value
    (finding,) = planned_motion(run).diagnostics
    assert finding.code == "Y1404"
    assert finding.help == "read the log with yarclang 0.1.0, which wrote it"


def test_what_describes_the_robot_is_damaged(tmp_path, monkeypatch):
    monkeypatch.setattr("yarclang.runtime.log_record._described", lambda job: {"joints": json.dumps({})})
    job, _ = made()
    assert codes(read_run(str(write(tmp_path / "a.mcap", job, [])))) == ["Y1401"]


@pytest.mark.parametrize(("chunks", "size"), [(1, 1 << 27), (40, 1 << 23)])
def test_a_log_that_would_fill_the_memory(chunks, size, tmp_path):
    """A few bytes would be unpacked to a large chunk, whatever size the chunk states."""
    path = tmp_path / "bomb.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=size - 1000)
        writer.start("yarc", "test")
        schema = writer.register_schema("any", "jsonschema", b"{}")
        channel = writer.register_channel("states", "json", schema)
        for number in range(chunks):
            writer.add_message(channel, number, b"0" * size, number)
        writer.finish()
    assert path.stat().st_size < 100_000
    result = read_run(str(path))
    assert result.value is None
    (finding,) = result.diagnostics
    assert finding.code == "Y1401"
    assert "is larger when it is unpacked than any log" in finding.message
