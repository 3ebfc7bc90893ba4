"""The picture of a run: the contents of its panels, and the files that `yarc plot` writes."""

import struct
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner
from report.runs.made_up_runs import ANCHOR, made, progress, samples, whole, write

from yarclang.cli.yarc import main
from yarclang.report.runs import panels as run_panels
from yarclang.report.runs import plot as run_plot
from yarclang.report.runs.course import marks_of, outcome_text, spans_of
from yarclang.report.runs.log import read_run
from yarclang.report.runs.panels import Shown, off_path_text
from yarclang.report.runs.planned import planned_motion
from yarclang.report.runs.plot import SIZE, draw_run
from yarclang.report.runs.signal_rows import signal_rows
from yarclang.report.runs.tracking import tracking_of
from yarclang.runtime.notices import Changed, Remark
from yarclang.runtime.outcome import Ended
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded
from yarclang.runtime.state import State

T = ANCHOR.clock


def shown(path):
    run = read_run(str(path)).value
    planned = planned_motion(run).value
    tracking = tracking_of(run, planned)
    return Shown(run, planned, tracking, spans_of(run, tracking), marks_of(run, tracking))


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return whole(tmp_path_factory.mktemp("good") / "good.mcap", *made())[0]


def rate(clock):
    """Return the override: a hold of 2 s at 2 s, half speed from 6 s on."""
    return np.interp(clock, [0, 2.0, 2.1, 4.0, 4.1, 6.0, 6.1], [1, 1, 0, 0, 1, 1, 0.5])


@pytest.fixture(scope="module")
def held(tmp_path_factory):
    """A run that is held, slowed down, and fails 10.1 s after its start, in P0030."""
    job, plan = made()
    seen = samples(job, plan, rate, length=10.0)
    told = [
        Changed(T, State.STOP, ""),
        job,
        Changed(T + 0.05, State.INIT, "loading"),
        Changed(T + 0.1, State.MOVE, ""),
        *seen.notices,
        Changed(T + 2.1, State.HOLD, "hold requested"),
        Changed(T + 4.1, State.MOVE, ""),
        Remark(T + 6.1, "override 50 %"),
        *(progress(job, one.time, time) for one, time in zip(seen.notices, seen.times, strict=True)),
        Changed(T + 10.1, State.FAULT, "motor 3: its amplifier reports a fault"),
    ]
    told.sort(key=lambda one: getattr(one, "time", T))
    ended = Ended(
        False,
        "motor 3: its amplifier reports a fault",
        "find out why",
        None,
        "P0020 MOVEJ_LSPB",
        "P0020",
        5.9,
    )
    return write(tmp_path_factory.mktemp("held") / "held.mcap", job, told, ended), seen


def test_states_and_marks_have_times_of_the_run_and_of_the_program(held):
    path, seen = held
    this = shown(path)
    spans = {span.state: span for span in this.spans}
    assert [span.state for span in this.spans] == [
        State.STOP,
        State.INIT,
        State.MOVE,
        State.HOLD,
        State.MOVE,
        State.FAULT,
    ]
    hold = spans[State.HOLD]
    assert (hold.start, hold.end) == (2.1, 4.1)
    # braking takes 0.1 s, at half the speed on average; then the program time stands still
    assert hold.begins == pytest.approx(2.0, abs=2e-3)
    assert hold.ends == pytest.approx(2.05, abs=5e-3)
    assert spans[State.FAULT].begins == pytest.approx(seen.times[-1], abs=2e-3)
    texts = ["hold: hold requested", "override 50 %", "fault: motor 3: its amplifier reports a fault"]
    assert [mark.text for mark in this.marks] == texts
    assert [mark.time for mark in this.marks] == [2.1, 6.1, 10.1]


@pytest.mark.parametrize(
    ("ended", "text", "well"),
    [
        (Ended(True), "came to its end", True),
        (Ended(False, "stopped on its path", done=1.0), "stopped on its path", False),
        (
            Ended(False, "aborted", "", None, "P0010 MOVEJ_LSPB", "P0010", 2.26),
            "aborted (P0010 MOVEJ_LSPB, 2.3 s into the program)",
            False,
        ),
        (None, "the log doesn't say how it ended: 1.5 s of it are here, move at last", None),
    ],
)
def test_the_title_says_how_it_ended(tmp_path, ended, text, well):
    job, _ = made()
    path = write(tmp_path / "a.mcap", job, [Changed(T + 1.5, State.MOVE, "")], ended)
    this = shown(path)
    assert outcome_text(this.run) == (text, well)
    assert text in texts_of(run_plot._figure(this))


def texts_of(figure):
    return [text.get_text() for text in figure.texts]


def test_the_title_says_how_far_what_was_commanded_is_from_the_plan(tmp_path):
    job, plan = made("P0010 MOVEJ_LSPB 40 0 0 0 0 0 [4] (deg,s)\n", name="aside.yarc")
    aside = np.deg2rad([0.0, 0.0, 0.0, 0.0, 0.25, 0.0])
    this = shown(whole(tmp_path / "a.mcap", job, plan, off=aside)[0])
    assert off_path_text(this) == "commanded at most 0.25 deg (J5) off the planned path"
    assert any("0.25 deg (J5) off" in text for text in texts_of(run_plot._figure(this)))


@pytest.mark.parametrize(
    ("size", "text"),
    [
        (0.0, "0"),
        (3e-6, "0.00001"),
        (4.41e-5, "0.00004"),
        (0.0123, "0.012"),
        (0.5, "0.50"),
        (12.34, "12"),
        (879, "879"),
    ],
)
def test_sizes(size, text):
    assert run_panels._size(size) == text


def test_limits_are_drawn_where_they_are_near(tmp_path):
    from matplotlib.figure import Figure

    job, plan = made("P0010 MOVEJ_LSPB 165 0 0 0 0 0 [6] (deg,s)\n", name="near.yarc")
    this = shown(whole(tmp_path / "a.mcap", job, plan)[0])
    for joint, near in ((0, True), (1, False)):
        axes = Figure().add_subplot()
        run_panels.draw_joint(axes, this, joint)
        low, high = axes.get_ylim()
        assert bool(low < 170.0 < high) is near
        drawn = [line for line in axes.lines if line.get_color() == run_panels.LIMIT]
        assert len(drawn) == near


def test_what_was_not_run_is_shaded(good, held):
    assert not run_panels.not_run(shown(good))
    this = shown(held[0])
    assert run_panels.not_run(this)
    assert this.reached == pytest.approx(held[1].times[-1], abs=2e-3)


def test_many_samples_are_thinned_and_keep_their_extremes():
    times = np.sort(np.random.default_rng(0).uniform(0.0, 10.0, 50_000))
    values = np.sin(40.0 * times)[:, None] * [1.0, 3.0]
    values[31_234, 1] = 17.0
    when, what = run_panels.thinned(times, values, 1000)
    assert len(when) <= 2002
    assert np.all(np.diff(when) >= 0.0)
    assert what.max(axis=0) == pytest.approx(values.max(axis=0))
    assert what.min(axis=0) == pytest.approx(values.min(axis=0))


def test_passes_are_lines_of_their_own(tmp_path):
    job, plan = made()
    told = []
    for number in range(3):
        told += [job, *samples(job, plan, begins=10.0 * number, seed=number).notices]
    this = shown(write(tmp_path / "a.mcap", job, told))
    lines = run_panels.passes_of(this, this.tracking.error)
    assert len(lines) == 3
    assert all(np.all(np.diff(when) >= 0.0) for when, _ in lines)
    assert draw_run(this.run, this.planned, "png").startswith(b"\x89PNG")


def test_texts_do_not_overlap(held):
    """The titles, the list below, and the numbers of events don't overlap."""
    figure = run_plot._figure(shown(held[0]))
    renderer = figure.canvas.get_renderer()
    boxes = [text.get_window_extent(renderer) for text in figure.texts]
    assert all(box.x0 >= 0 and box.x1 <= SIZE[0] and box.y0 >= 0 and box.y1 <= SIZE[1] for box in boxes)
    for one, other in pairwise(boxes):
        assert not one.overlaps(other)


def test_inputs_and_outputs_are_rows_under_the_curves(tmp_path):
    """The rows show when each signal was on, and when the robot waited, at the times of the log."""
    job, plan = made()
    told = [
        *samples(job, plan).notices,
        OutputSet(T + 1.0, "GRIP", "M1", 1.0),
        InputChanged(T + 1.5, "READY", "M11", 0.0, "sensor"),
        WaitBegan(T + 2.0, "P0010", "READY", "M11", 1.0, 0.0),
        InputChanged(T + 3.0, "READY", "M11", 1.0, "sensor"),
        WaitEnded(T + 3.01, "P0010", "READY", "M11", 1.0, 1.01, True),
        OutputSet(T + 5.0, "GRIP", "M1", 0.0),
        WaitBegan(T + 8.0, "P0030", "DOOR", "M12", 1.0, 0.0),
        *(
            OutputSet(T + 8.5, f"A_VERY_LONG_NAME_{number} $x$", f"M{number}", 2.5)
            for number in range(20, 29)
        ),
    ]
    told.sort(key=lambda one: one.time)
    this = shown(write(tmp_path / "a.mcap", job, told))
    rows = signal_rows(this.run)
    grip, ready, door = rows[:3]
    end = pytest.approx(this.run.end)
    assert (grip.name, grip.is_input, grip.waits) == ("GRIP", False, ())
    assert grip.stretches == ((1.0, 5.0, 1.0), (5.0, end, 0.0))
    assert ready.stretches == ((1.5, 3.0, 0.0), (3.0, end, 1.0))
    assert ready.waits == ((2.0, pytest.approx(3.01), True),)
    assert door.waits == ((8.0, end, False),)
    figure = run_plot._figure(this)
    figure.canvas.draw()
    axes = next(one for one in figure.axes if one.get_title(loc="left") == "signals")
    labels = [one.get_text() for one in axes.get_yticklabels()]
    assert len(labels) == 8
    assert labels[-2:] == ["READY", "GRIP"]
    assert "4 more: yarc replay" in axes.get_title(loc="right")
    # names are beside the panels on the left, and the time axis is above the list
    left = max(one.get_window_extent().x1 for one in figure.axes if one.get_title(loc="left").startswith("J"))
    assert min(one.get_window_extent().x0 for one in axes.get_yticklabels()) > left
    assert axes.get_tightbbox().y0 > max(
        text.get_window_extent().y1 for text in figure.texts if text.get_position()[1] < 0.13
    )
    assert draw_run(this.run, this.planned, "png").startswith(b"\x89PNG")


def test_a_long_list_is_cut(tmp_path):
    job, plan = made()
    told = [*samples(job, plan).notices]
    told += [Remark(T + 0.2 * number, f"remark {number} " + "x" * 200) for number in range(40)]
    told.sort(key=lambda one: one.time)
    texts = texts_of(run_plot._figure(shown(write(tmp_path / "a.mcap", job, told))))
    assert "…  and 35 more: yarc replay shows them" in texts
    assert max(len(text) for text in texts[-6:]) <= 95


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_an_empty_run_is_drawn(tmp_path, robot):
    job, _ = made(
        "P0010 MOVEJ HOME [MIN] (deg,s)\nP0020 DMOVEJ 0 0 5 0 0 0 [2] (deg,s)\n", robot, "empty.yarc"
    )
    this = shown(write(tmp_path / "a.mcap", job, []))
    assert off_path_text(this) == "no positions were recorded"
    assert draw_run(this.run, this.planned, "png").startswith(b"\x89PNG")


def test_a_program_without_motion_is_drawn(tmp_path):
    job, _ = made("P0010 STOP\n", name="still.yarc")
    this = shown(write(tmp_path / "a.mcap", job, [Changed(T, State.STOP, "")]))
    assert draw_run(this.run, this.planned, "svg").startswith(b"<?xml")


def test_odd_names_are_drawn(tmp_path):
    job = replace(made()[0], name="$a_b$ \x07" + "x" * 100)
    this = shown(write(tmp_path / "a.mcap", job, []))
    figure = run_plot._figure(this)
    assert figure.texts[0].get_text() == "$a_b$ ·" + "x" * 52 + "…"
    assert draw_run(this.run, this.planned, "pdf").startswith(b"%PDF")


# yarc plot


def call(*arguments):
    return CliRunner().invoke(main, ["plot", *map(str, arguments)])


def test_yarc_plot_draws_a_log(good, tmp_path):
    done = call(good, "-o", tmp_path / "x.png")
    assert done.exit_code == 0, done.output
    data = (tmp_path / "x.png").read_bytes()
    assert struct.unpack(">II", data[16:24]) == SIZE
    assert len(data) < 400_000
    assert done.stderr.startswith(f"{good}: a run of 9.")
    assert call(good, "-o", "-").stdout_bytes == data
    assert call(good).exit_code == 0
    assert good.with_suffix(".png").read_bytes() == data
    # a log with another file name
    other = tmp_path / "log"
    other.write_bytes(good.read_bytes())
    assert call(other, "-o", tmp_path / "y.png").exit_code == 0


def test_an_unfinished_log_is_drawn_with_a_warning(good, tmp_path):
    path = tmp_path / "cut.mcap"
    path.write_bytes(good.read_bytes()[:-3000])
    done = call(path)
    assert done.exit_code == 0
    assert "warning Y1402" in done.stderr
    assert path.with_suffix(".png").exists()


def test_what_is_no_log_leaves_no_picture(tmp_path):
    path = tmp_path / "a.mcap"
    path.write_text("P0010 MOVEJ 0 0 0 0 0 0 [2] (deg,s)\n")
    done = call(path)
    assert done.exit_code == 1
    assert "error Y1401" in done.stderr
    assert "nothing drawn" in done.stderr
    assert not path.with_suffix(".png").exists()
    job, _ = made()
    bad = write(tmp_path / "b.mcap", replace(job, text=job.text.replace("SPLINE1", "LINEAR")), [])
    done = call(bad)
    assert done.exit_code == 1
    assert "error Y1404" in done.stderr


@pytest.mark.parametrize(
    "option", [("--robot", "INDUSTRIAL6"), ("--tm", "5"), ("--start", "0,0"), ("--tolerance", "1")]
)
def test_options_of_programs_are_wrong_for_a_log(good, option):
    done = call(good, *option)
    assert done.exit_code == 2
    assert option[0] in done.stderr


def test_equal_logs_give_equal_bytes(held, tmp_path):
    """The bytes don't depend on a user's own settings or on earlier drawings."""
    code = (
        "import sys; from yarclang.cli.yarc import main\n"
        "for file in sys.argv[2:]: main(['plot', sys.argv[1], '-o', file], standalone_mode=False)"
    )
    formats = ("png", "svg", "pdf")
    for number, order in enumerate((formats, formats[::-1])):
        (tmp_path / "matplotlibrc").write_text(f"font.size: {10 + 2 * number}\nbackend: TkAgg\n")
        files = [str(tmp_path / f"{number}.{format_}") for format_ in order]
        subprocess.run(
            [sys.executable, "-c", code, str(held[0]), *files], check=True, capture_output=True, cwd=tmp_path
        )
    for format_ in formats:
        first, second = (tmp_path / f"{number}.{format_}" for number in range(2))
        assert first.read_bytes() == second.read_bytes(), format_
