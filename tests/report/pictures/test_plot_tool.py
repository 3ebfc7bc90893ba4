"""`yarc plot`: the drawn frame, its speed, its distance from singularities, and corners that are passed in
motion.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.motion.curve import Curve
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import plan_module
from yarclang.report.pictures import plot, tool_panels
from yarclang.report.pictures.drawn_frame import drawn_frame
from yarclang.report.pictures.passed import passed_corners
from yarclang.report.pictures.tool_trace import tool_trace_of
from yarclang.report.pictures.trace import MOST_SAMPLES
from yarclang.robot.kinematics.fk import tool_poses

HEAD = """\
ROBOT INDUSTRIAL6
DEFAULT {TCP} [2] (mm,deg,s) {B}
FRAME {NOZZLE} 0 150 0 90 0 0 {FLANGE}
FRAME {ON} 0 900 600 0 0 0 {B}
START 0 -10 -20 0 -60 0
P0010 MOVEJ_RPY {NOZZLE} 0 0 0 0 0 0 {ON}
"""
ROUND = """\
P0020 MOVEL {NOZZLE} 100 0 0 0 0 0 {ON} BLEND 20
P0030 MOVEL {NOZZLE} 100 100 0 0 0 0 {ON} BLEND 0.4 (cm)
P0040 MOVEL {NOZZLE} 0 100 0 0 0 0 {ON}
"""


def planned(folder: Path, text: str) -> MotionPlan:
    file = folder / "program.yarc"
    file.write_text(text)
    opened = open_program(str(file), Options(robot="INDUSTRIAL6"))
    assert opened.value is not None, opened.diagnostics
    made = plan_module(opened.value.module, opened.value.request)
    assert made.value is not None, made.diagnostics
    return made.value


@pytest.fixture(scope="module")
def rounded(tmp_path_factory: pytest.TempPathFactory) -> MotionPlan:
    return planned(tmp_path_factory.mktemp("rounded"), HEAD + ROUND.replace("BLEND 0.4 (cm)", "BLEND 4"))


def test_the_frame_that_most_motions_lead_is_followed(rounded: MotionPlan, tmp_path: Path) -> None:
    frame = drawn_frame(rounded)
    assert frame.name == "NOZZLE"
    assert frame.flange_from_frame[:3, 3] == pytest.approx([0.0, 0.15, 0.0])
    other = planned(tmp_path, HEAD + "P0020 DMOVE 0 0 10 0 0 0\nP0030 DMOVE 0 0 -10 0 0 0\n")
    assert drawn_frame(other).name == "TCP"
    equal = planned(tmp_path, HEAD + "P0020 DMOVE 0 0 10 0 0 0\n")
    assert drawn_frame(equal).name == "NOZZLE"


def test_joint_values_lead_no_frame(tmp_path: Path) -> None:
    plan = planned(
        tmp_path, "DEFAULT {FLANGE} [2] (mm,deg,s) {B}\nP0010 MOVEJ 5 0 0 0 30 0\nP0020 MOVEJ 0 0 0 0 30 0\n"
    )
    assert drawn_frame(plan).name == "TCP"


def test_the_speed_is_that_of_the_frame(rounded: MotionPlan) -> None:
    frame = drawn_frame(rounded)
    trace = tool_trace_of(rounded, frame)
    assert trace.frame == "NOZZLE"
    assert trace.times[[0, -1]] == pytest.approx([0.0, rounded.duration])
    assert np.all(np.diff(trace.times) >= -1e-12)
    step = 1e-4
    for row in np.linspace(10, len(trace.times) - 10, 40).astype(int):
        time = trace.times[row]
        around = rounded.sample(np.array([time - step, time + step]))[0]
        places = tool_poses(rounded.robot.chain, around, frame.flange_from_frame)[:, :3, 3]
        assert trace.speed[row] == pytest.approx(
            np.linalg.norm(places[1] - places[0]) / (2 * step) * 1e3, abs=0.5
        )


def test_speeds_that_are_asked_for_are_drawn(tmp_path: Path) -> None:
    text = HEAD + "P0020 MOVEL {NOZZLE} 100 0 0 0 0 0 [V 80] {ON}\nP0030 DMOVE {TCP} 0 0 10 0 0 0 [V 7]\n"
    plan = planned(tmp_path, text)
    trace = tool_trace_of(plan, drawn_frame(plan))
    assert trace.wanted == pytest.approx(np.array([[plan.begins[1], plan.ends[1], 80.0]]))
    here = (trace.times > plan.begins[1] + 0.4) & (trace.times < plan.ends[1] - 0.4)
    assert trace.speed[here] == pytest.approx(80.0, abs=0.05)


def test_a_straight_wrist_is_a_singularity(tmp_path: Path) -> None:
    plan = planned(tmp_path, "P0010 MOVEJ 0 0 0 0 40 0 [2] (deg,s)\nP0020 MOVEJ 0 0 0 0 -40 0 [2] (deg,s)\n")
    trace = tool_trace_of(plan, drawn_frame(plan))
    assert trace.singular[0] == pytest.approx(0.0, abs=1e-9)
    middle = trace.singular[(trace.times > 2.5) & (trace.times < 3.5)]
    assert middle.min() < 3e-3
    assert trace.singular[np.argmin(np.abs(trace.times - 2.0))] > 0.1


def test_a_program_without_motion_stands_still(tmp_path: Path) -> None:
    plan = planned(tmp_path, "P0010 STOP\n")
    trace = tool_trace_of(plan, drawn_frame(plan))
    assert not trace.speed.any()
    assert len(passed_corners(plan, drawn_frame(plan))) == 0


def test_corners_lie_where_the_commands_end(rounded: MotionPlan) -> None:
    corners = passed_corners(rounded, drawn_frame(rounded))
    assert corners.motions.tolist() == [1, 2]
    assert corners.places == pytest.approx(
        np.array([[100.0, 900.0, 600.0], [100.0, 1000.0, 600.0]]), abs=1e-3
    )
    assert corners.radii == pytest.approx([20.0, 4.0])
    assert corners.middles == pytest.approx(rounded.ends[1:3])


def test_the_path_is_left_in_the_shaded_times_alone(rounded: MotionPlan) -> None:
    """The frame leaves its lines only during the shaded times, and then at most as far as the ball allows."""
    frame = drawn_frame(rounded)
    corners = passed_corners(rounded, frame)
    times = np.linspace(float(rounded.begins[1]), rounded.duration, 3000)
    places = (
        tool_poses(rounded.robot.chain, rounded.sample(times)[0], frame.flange_from_frame)[:, :3, 3] * 1e3
    )
    x, y = places[:, 0], places[:, 1] - 900.0
    off = np.minimum(np.minimum(np.abs(y), np.abs(x - 100.0)), np.abs(y - 100.0))
    inside = np.zeros(len(times), dtype=bool)
    for begin, end, place, radius in zip(
        corners.begins, corners.ends, corners.places, corners.radii, strict=True
    ):
        here = (times > begin) & (times < end)
        inside |= here
        assert np.linalg.norm(places[here] - place, axis=1).max() <= radius * (1 + 1e-6)
        assert off[here].max() > 0.05
    assert off[~inside].max() < 0.05


def test_a_blend_of_joints_has_no_ball(tmp_path: Path) -> None:
    text = "P0010 MOVEJ 20 0 0 0 30 0 [2] (deg,s) BLEND 5\nP0020 MOVEJ 0 0 20 0 30 0 [2] (deg,s)\n"
    plan = planned(tmp_path, text)
    corners = passed_corners(plan, drawn_frame(plan))
    assert len(corners) == 1
    assert np.isnan(corners.radii).all()


def test_the_blend_of_another_tool_has_no_ball(rounded: MotionPlan) -> None:
    other = dataclasses.replace(drawn_frame(rounded), flange_from_frame=np.eye(4))
    assert np.isnan(passed_corners(rounded, other).radii).all()


def test_balls_and_marks_are_in_the_picture(rounded: MotionPlan) -> None:
    figure = plot._figure(rounded)
    (axes,) = (one for one in figure.axes if one.get_label() == "path")
    labels = axes.get_legend_handles_labels()[1]
    assert "corners passed in motion" in labels
    assert labels.count("BLEND: as far as it may be left") == 1
    view = np.array(
        [
            np.cos(np.deg2rad(24)) * np.cos(np.deg2rad(-52)),
            np.cos(np.deg2rad(24)) * np.sin(np.deg2rad(-52)),
            np.sin(np.deg2rad(24)),
        ]
    )
    corners = passed_corners(rounded, drawn_frame(rounded))
    circles = [np.array(line.get_data_3d()).T for line in axes.lines if len(line.get_data_3d()[0]) == 49]
    assert len(circles) == 2
    for circle, place, radius in zip(circles, corners.places, corners.radii, strict=True):
        assert np.linalg.norm(circle - place, axis=1) == pytest.approx(radius)
        assert (circle - place) @ view == pytest.approx(0.0, abs=1e-9)
    titles = [one.get_title(loc="left") for one in figure.axes]
    assert titles[-5:-2] == [
        "speed of {NOZZLE} [mm/s]",
        "smallest singular value",
        "clearance of bodies [mm]",
    ]


def many(plan: MotionPlan, count: int) -> MotionPlan:
    """Return the two motions after the first, repeated; each flows into the next."""
    motions, steps = [], []
    for number in range(count):
        motion = plan.motions[1 + number % 2]
        assert isinstance(motion, PlannedMotion)
        steps.append(plan.program.steps[motion.step])
        motions.append(dataclasses.replace(motion, step=number, overlap=4))
    program = dataclasses.replace(plan.program, steps=tuple(steps))
    return MotionPlan(program, plan.robot, tuple(motions))


@pytest.mark.parametrize("count", [1, 59, 90, 3000])
def test_long_programs_stay_bounded_and_readable(rounded: MotionPlan, count: int) -> None:
    plan = many(rounded, count)
    trace = tool_trace_of(plan, drawn_frame(plan))
    assert len(trace.times) <= MOST_SAMPLES
    assert np.all(np.diff(trace.times) >= 0.0)
    one = tool_trace_of(many(rounded, 2), drawn_frame(plan))
    assert trace.speed.max() == pytest.approx(one.speed.max(), rel=0.05)
    figure = plot._figure(plan)
    (axes,) = (axes for axes in figure.axes if axes.get_label() == "path")
    assert len(axes.lines) < 400
    assert sum(len(one.patches) for one in figure.axes) < 2000


@settings(max_examples=25, deadline=None)
@given(
    segments=st.integers(4, 40),
    time=st.floats(0.002, 0.05),
    seed=st.integers(0, 1000),
)
def test_any_curve_has_a_speed_and_a_measure(
    rounded: MotionPlan, segments: int, time: float, seed: int
) -> None:
    """Speed and smallest singular value are finite and never negative, whatever the joints do."""
    points = np.random.default_rng(seed).uniform(-1.0, 1.0, (segments + 3, 6))
    motion = dataclasses.replace(rounded.motions[1], curve=Curve(points, time, points[:, 0]), overlap=0)
    plan = MotionPlan(rounded.program, rounded.robot, (motion,))
    trace = tool_trace_of(plan, drawn_frame(plan))
    assert np.isfinite(trace.speed).all()
    assert (trace.speed >= 0.0).all()
    assert (trace.singular >= 0.0).all()
    assert trace.singular.max() < 1.0


@pytest.mark.parametrize(("wanted", "top"), [(8.0, 560.0), (60.0, 61.0), (250.0, 700.0), (0.0, 300.0)])
def test_slow_work_between_fast_ways_is_seen(wanted: float, top: float) -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    note = tool_panels._scale(axes, wanted, top)
    assert ("squeezed" in note) == (0 < wanted * 1.25 < 0.4 * top)
    low, high = axes.transData.transform([(0.0, 0.0), (0.0, top)])[:, 1]
    shown = float(axes.transData.transform((0.0, wanted))[1])
    assert 0.0 == axes.get_ylim()[0] < top < axes.get_ylim()[1]
    if wanted:
        assert (shown - low) / (high - low) > 0.3
    axes.plot([0.0, 1.0], [0.0, top])
    axes.figure.canvas.draw()
