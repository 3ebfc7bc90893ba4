"""A run as lines: the formats, and the agreement of a recorded run with the live one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from report.runs.made_up_runs import ANCHOR, made, progress, samples, write

from yarclang.lasting import known
from yarclang.report.runs.log import read_run
from yarclang.report.runs.text import (
    View,
    head_text,
    joints_text,
    moments_of,
    notice_text,
    over,
    progress_text,
    time_text,
)
from yarclang.runtime.notices import Changed, Progress, Remark
from yarclang.runtime.outcome import Ended
from yarclang.runtime.sample import Sample
from yarclang.runtime.state import State

T = ANCHOR.clock
TWELVE = Progress(T, 12.3, 27.7, "P0010 MOVEL_RPY_LSPB", 3)


def test_the_line_that_changes(industrial6):
    view = View(industrial6, known(40.0)).behind(Changed(T, State.INIT, "loading"))
    assert view.line == "init"
    view = view.behind(Changed(T, State.MOVE, "")).behind(TWELVE)
    assert view.line == "P0010 MOVEL_RPY_LSPB  12.3 s of 40.0 s, 27.7 s left"
    view = view.at(np.deg2rad([10.0, -3.456, 0.0, -0.0001, 180.0, 1e-9]))
    joints = "J1 10.00 J2 -3.46 J3 0.00 J4 0.00 J5 180.00 J6 0.00"
    assert view.line == f"P0010 MOVEL_RPY_LSPB  12.3 s of 40.0 s, 27.7 s left  {joints}"
    held = view.behind(Changed(T, State.HOLD, "why")).behind(Remark(T, "x"))
    assert held.line == f"hold  {view.line}"
    assert view.performing(known(5.0)).line == joints


def test_joints_that_slide_are_in_mm(industrial6):
    class Sliding:
        joint_names = ("X", "R")
        axis_units = np.array([0.001, np.pi / 180.0])

    assert joints_text(Sliding(), np.array([0.0125, np.pi])) == "X 12.50 R 180.00"


@pytest.mark.parametrize(
    ("notice", "text"),
    [
        (Changed(T, State.MOVE, ""), "move"),
        (Changed(T, State.HOLD, "hold requested"), "hold: hold requested"),
        (Remark(T, "override 50 %"), "override 50 %"),
        (Remark(T, "the buffer ran low", warning=True), "warning: the buffer ran low"),
        (TWELVE, "P0010 MOVEL_RPY_LSPB  12.3 s, 27.7 s left"),
        (Progress(T, 40.0, 0.0, "", 0), "40.0 s, 0.0 s left"),
        (Sample(T, 0.0, np.zeros(6), np.zeros(6)), ""),
        (Remark(T, "\x1b[2Jgone\r\n"), "·[2Jgone··"),
    ],
)
def test_notices(notice, text):
    assert notice_text(notice) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.0 s"),
        (99.94, "99.9 s"),
        (99.96, "1 min 40 s"),
        (3599.4, "59 min 59 s"),
        (3599.6, "1 h 00 min"),
        (7385.0, "2 h 03 min"),
    ],
)
def test_times(seconds, text):
    assert time_text(seconds) == text


def test_the_time_left_is_that_at_the_override():
    slow = Progress(T, 10.0, 60.0, "P0010 MOVEJ", 1)
    assert progress_text(slow, known(40.0)) == "P0010 MOVEJ  10.0 s of 40.0 s, 60.0 s left"


@given(st.text(), st.integers(0, 200))
def test_a_line_never_wraps(text, width):
    shown = over(text, width)
    assert shown.startswith("\r\x1b[K")
    assert len(shown) - 4 <= max(width - 1, 0)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run with an approach, followed by the program."""
    job, plan = made()
    way, way_plan = made("P0001 MOVEJ_LSPB 10 0 0 0 0 0 [3] (deg,s)\n", name="approach")
    first, then = samples(way, way_plan), samples(job, plan, begins=4.0)
    told = [Changed(T, State.STOP, ""), way, Changed(T + 0.05, State.MOVE, "")]
    for one, time in zip(first.notices, first.times, strict=True):
        told += [one, progress(way, one.time, time)]
    told += [job, Changed(T + 4.0, State.MOVE, "the program")]
    for one, time in zip(then.notices, then.times, strict=True):
        told += [one, progress(job, one.time, time)]
    path = write(tmp_path_factory.mktemp("run") / "a.mcap", job, told, Ended(True, done=job.duration))
    return read_run(str(path)).value


def test_a_recorded_run_comes_in_the_order_of_time(run):
    moments = list(moments_of(run))
    times = [moment.time for moment in moments]
    assert times == sorted(times)
    assert [moment.line for moment in moments if moment.line] == [
        "stop",
        "move",
        "move: the program",
        "came to its end",
    ]
    assert len(moments) == len(run.told) + len(run.times)


def test_each_job_has_its_own_duration(run):
    lines = [moment.view.line for moment in moments_of(run)]
    assert any("P0001 MOVEJ_LSPB  1.5 s of 3.0 s, 1.5 s left" in line for line in lines)
    assert any("P0010 MOVEJ_LSPB  1.5 s of 9.0 s, 7.5 s left" in line for line in lines)


def test_a_recorded_run_looks_as_the_live_one_did(run):
    """The notices of the log and of the live run give the same lines."""
    job, plan = made()
    seen = samples(job, plan, begins=4.0)
    view = View(job.robot, job.lasting, State.MOVE)
    for one, time in zip(seen.notices, seen.times, strict=True):
        view = view.at(one.joints(job.robot)).behind(progress(job, one.time, time))
    assert list(moments_of(run))[-1].view.line == view.line


def test_which_run_it_is(run):
    assert head_text(run) == "turning.yarc on INDUSTRIAL6 at 127.0.0.1:1025, 2026-09-21 14:13:20 UTC"
    fast = head_text(replace(run, pace=20.0, program="\x1b[1mx"))
    assert (
        fast
        == "·[1mx on INDUSTRIAL6 at 127.0.0.1:1025, 2026-09-21 14:13:20 UTC, 20 times as fast as real time"
    )
