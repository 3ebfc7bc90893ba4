"""The program time of each sample, and the robot's deviation, compared with runs of known true values."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from report.runs.made_up_runs import made, samples, whole, write

from yarclang.report.runs.log import read_run
from yarclang.report.runs.planned import planned_motion
from yarclang.report.runs.tracking import tracking_of
from yarclang.units import DEG, MM

STOPS = """\
P0010 MOVEJ_POLY5 20 -10 -10 30 -60 -60 [3] (deg,s)
P0020 MOVEJ_SPLINE 10 -25 10 15 -65 -30; 0 -20 0 0 -70 0; -20 -10 -10 -15 -60 40 [6] (deg,s)
P0030 MOVEJ HOME [MIN] (deg,s)
"""


def opened(path):
    run = read_run(str(path))
    assert run.diagnostics == ()
    planned = planned_motion(run.value)
    assert planned.diagnostics == ()
    return run.value, planned.value


@pytest.mark.parametrize(("text", "robot"), [(None, "INDUSTRIAL6"), (STOPS, "TRACKED_MANIPULATOR")])
def test_the_planned_motion_is_the_plan(tmp_path, text, robot):
    job, plan = made(text, robot) if text else made()
    run, planned = opened(whole(tmp_path / "a.mcap", job, plan)[0])
    assert planned.duration == pytest.approx(plan.duration, abs=1e-9)
    times = np.linspace(-0.5, plan.duration + 0.5, 3001)
    q, v, *_ = plan.sample(np.clip(times, 0.0, plan.duration))
    # the numbers in the text have a limited number of decimals
    assert planned.at(times)[0] == pytest.approx(q, abs=2e-7)
    inside = (times >= 0.0) & (times <= plan.duration)
    assert planned.at(times)[1][inside] == pytest.approx(v[inside], abs=1e-4)
    assert (planned.segment_times(times) <= run.robot.controller.largest_segment + 1e-9).all()


DWELLS = """\
P0005 WAIT [1] (s)
P0010 MOVEJ_LSPB 40 10 20 0 30 0 [3] (deg,s)
P0020 WAIT [2] (s)
P0021 WAIT [1] (s)
P0030 MOVEJ_LSPB 0 0 0 0 0 0 [4] (deg,s)
P0040 WAIT [1.5] (s)
"""

WAYS = """\
INPUT DOOR M11
P0010 MOVEJ_LSPB 20 0 0 0 0 0 [2] (deg,s)
WHEN DOOR ON
  P0020 MOVEJ_LSPB 20 20 0 0 0 0 [2] (deg,s)
  P0030 WAIT [1] (s)
  P0040 MOVEJ_LSPB 20 -10 0 0 0 0 [3] (deg,s)
ELSE
  P0050 MOVEJ_LSPB 20 0 30 0 0 0 [2] (deg,s)
  P0060 MOVEJ_LSPB 20 -10 0 0 0 0 [2] (deg,s)
END
P0070 WAIT [1] (s)
P0080 MOVEJ_LSPB 0 0 0 0 0 0 [3] (deg,s)
"""


@settings(max_examples=10)
@given(st.integers(0, 1000))
def test_dwells_take_their_time(tmp_path_factory, seed):
    job, plan = made(DWELLS)
    assert (job.duration, job.lasting.most) == pytest.approx((12.5, 12.5))
    run, planned = opened(whole(tmp_path_factory.mktemp("t") / "a.mcap", job, plan, seed=seed)[0])
    assert planned.lasting == run.lasting == job.lasting
    assert planned.dwells == pytest.approx(np.array([[0.0, 1.0], [4.0, 6.0], [6.0, 7.0], [11.0, 12.5]]))
    tracking = tracking_of(run, planned)
    assert (np.diff(tracking.times) >= 0.0).all()
    assert (np.abs(tracking.off_path) < 3e-4 * DEG).all()
    truth = samples(job, plan, seed=seed).times
    # while the robot is at rest, only the lines in the buffer give the time
    assert np.abs(tracking.times - truth).max() < 0.3
    assert (np.abs(tracking.error) < 0.1 * DEG).all()


@settings(max_examples=10)
@given(st.booleans(), st.integers(0, 1000))
def test_a_way_that_is_not_taken_is_left_out(tmp_path_factory, first, seed):
    job, plan = made(WAYS)
    begins, parts, ends = 2.0, 8.0, 12.0
    left_out = (begins, parts) if first else (parts, ends)
    length = plan.duration - (left_out[1] - left_out[0])
    path, truth = whole(
        tmp_path_factory.mktemp("t") / "a.mcap", job, plan, seed=seed, left_out=left_out, length=length
    )
    run, planned = opened(path)
    assert planned.ways == pytest.approx(np.array([[begins, parts, ends]]))
    tracking = tracking_of(run, planned)
    assert (np.abs(tracking.off_path) < 3e-4 * DEG).all()
    assert np.abs(tracking.times - truth.times).max() < 0.3
    inside = (tracking.times > left_out[0] + 0.1) & (tracking.times < left_out[1] - 0.1)
    assert not inside.any()
    (broken,) = tracking.breaks.tolist()
    assert tracking.times[broken - 1] <= left_out[0] + 0.1
    assert tracking.times[broken] >= left_out[1] - 0.1


def test_logs_of_before_have_times_without_dwells(tmp_path, monkeypatch):
    from yarclang.runtime import log_record

    described = log_record._described

    def before(job):
        told = described(job)
        del told["takes"]
        for one in told["commands"]:
            del one["clock_s"]
        return told

    monkeypatch.setattr(log_record, "_described", before)
    job, _ = made(DWELLS)
    moves, plan = made("".join(f"{line}\n" for line in DWELLS.splitlines() if "MOVEJ" in line))
    seen = samples(moves, plan)
    run, planned = opened(write(tmp_path / "a.mcap", job, [job, *seen.notices]))
    assert planned.duration == pytest.approx(plan.duration)
    tracking = tracking_of(run, planned)
    assert (np.abs(tracking.off_path) < 3e-4 * DEG).all()
    assert np.abs(tracking.times - seen.times).max() < 0.2


@st.composite
def rates(draw):
    """Draw an override over the clock: ramps between 0 (a hold) and 1."""
    return ramps(draw(st.lists(st.sampled_from([0.0, 0.1, 0.3, 0.5, 1.0, 1.0, 1.0]), min_size=2, max_size=6)))


def ramps(levels):
    places = np.linspace(0.0, 9.0, len(levels))
    return lambda clock: np.interp(clock, places, levels)


@settings(max_examples=25)
@given(rates(), st.integers(0, 1000))
@example(ramps([0.1, 0.3, 1.0, 0.3, 0.0, 0.0]), 0)  # ends in a hold
def test_times_are_found_whatever_the_pace(tmp_path_factory, rate, seed):
    job, plan = made()
    path, truth = whole(tmp_path_factory.mktemp("t") / "a.mcap", job, plan, rate=rate, seed=seed)
    run, planned = opened(path)
    tracking = tracking_of(run, planned)
    assert (np.diff(tracking.times) >= 0.0).all()
    assert (np.abs(tracking.off_path) < 3e-4 * DEG).all()
    speed = np.linalg.norm(plan.sample(truth.times)[1], axis=1) / DEG
    late = np.abs(tracking.times - truth.times)
    assert (late < 0.2).all()
    # Only fast samples inside the record are precise to 1 ms. Where the robot reverses slowly, a rounding by
    # one count changes the found time much. Where a record ends in a reversal, or in a hold during a
    # reversal, only the reported times are known.
    moves = np.append(np.diff(truth.times) > 0.0, False)
    ends = run.times[moves][-1] if moves.any() else run.times[-1]
    inside = run.times < ends - 1.0
    assert (late[inside & (speed > 5.0)] < 1e-3).all()
    # the tracking error is therefore nearly equal to the robot's lag
    behind = run.actual - plan.sample(truth.times)[0]
    assert np.abs(tracking.error - behind)[inside].max(initial=0.0) < 1e-2 * DEG


def test_the_times_that_were_told_are_much_worse(tmp_path):
    job, plan = made()
    path, truth = whole(tmp_path / "a.mcap", job, plan)
    run, planned = opened(path)
    assert np.abs(run.program_times - truth.times).max() > 0.05
    assert np.abs(planned.at(run.program_times)[0] - truth.commanded).max() > 1.0 * DEG


@pytest.mark.parametrize("distance", [0.01, 0.3, 5.0])
def test_what_is_off_the_path_is_seen(tmp_path, distance):
    """On a path where one joint moves, a deviation of another joint is detected."""
    job, plan = made("P0010 MOVEJ_LSPB 40 0 0 0 0 0 [4] (deg,s)\n", name="aside.yarc")
    aside = np.array([0.0, 0.0, 0.0, 0.0, distance, 0.0]) * DEG
    run, planned = opened(whole(tmp_path / "a.mcap", job, plan, off=aside)[0])
    off = tracking_of(run, planned).off_path
    assert off[:, 4] == pytest.approx(np.full(len(off), distance * DEG), abs=1e-4 * DEG)
    assert np.abs(np.delete(off, 4, axis=1)).max() < 1e-4 * DEG


def test_each_pass_begins_again_and_the_way_to_the_start_is_left_out(tmp_path):
    job, plan = made()
    way, way_plan = made("P0001 MOVEJ_LSPB 10 0 0 0 0 0 [3] (deg,s)\n", name="approach")
    first = samples(way, way_plan)
    then = samples(job, plan, begins=4.0)
    again = samples(job, plan, begins=14.0, seed=1)
    told = [way, *first.notices, job, *then.notices, job, *again.notices]
    run, planned = opened(write(tmp_path / "a.mcap", job, told))
    tracking = tracking_of(run, planned)
    assert tracking.rows.tolist() == list(range(len(first.times), len(run.times)))
    assert np.unique(run.passes).tolist() == [-1, 0, 1]
    truth = np.concatenate((then.times, again.times))
    assert np.abs(tracking.times - truth).max() < 0.12
    assert np.abs(tracking.off_path).max() < 3e-4 * DEG


def test_a_controller_whose_clock_is_fast(tmp_path):
    """The controller's clock is 300 ppm fast, three times the error of a quartz, so the program gains on the
    host's clock.
    """
    job, plan = made(
        "\n".join(f"P{n:04} MOVEJ_LSPB {10 * (n % 2)} 0 0 0 0 0 [1] (deg,s)" for n in range(1, 90))
    )
    path, truth = whole(tmp_path / "a.mcap", job, plan, rate=lambda clock: np.full_like(clock, 1.0003))
    run, planned = opened(path)
    tracking = tracking_of(run, planned)
    speed = np.linalg.norm(plan.sample(truth.times)[1], axis=1) / DEG
    assert (np.abs(tracking.times - truth.times)[speed > 1.0] < 1e-3).all()


def test_a_robot_that_slides(tmp_path, industrial6):
    """For a robot with a prismatic joint, the distances of this joint are in mm."""
    from dataclasses import replace

    from yarclang.report.runs import messages as run_messages

    job, plan = made()
    run, planned = opened(whole(tmp_path / "a.mcap", job, plan)[0])
    names = ("mm", *run.robot.axis_unit_names[1:])
    robot = replace(run.robot, axis_unit_names=names)
    assert robot.axis_units[0] == MM
    assert run_messages._UNITS["mm"] == MM
    tracking_of(replace(run, robot=robot), planned)


def test_no_samples(tmp_path):
    job, _ = made()
    run, planned = opened(write(tmp_path / "a.mcap", job, [job]))
    tracking = tracking_of(run, planned)
    assert tracking.times.shape == (0,)
    assert tracking.error.shape == (0, 6)


def test_a_program_that_stands_still(tmp_path):
    job, _ = made("P0010 MOVEJ 0 0 0 0 0 0 [MIN] (deg,s)\nP0020 STOP\n", name="still.yarc")
    _, planned = opened(write(tmp_path / "a.mcap", job, [job]))
    assert planned.at(np.array([0.0, 1.0]))[0] == pytest.approx(np.zeros((2, 6)))
