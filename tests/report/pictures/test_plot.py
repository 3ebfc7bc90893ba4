"""`yarc plot`: the drawn shares of the limits, and the written files."""

from __future__ import annotations

import dataclasses
import struct
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from yarclang.cli.yarc import main
from yarclang.motion.curve import Curve
from yarclang.motion.plan import MotionPlan, PlannedMotion
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import plan_module
from yarclang.report.pictures import panels, plot, trace
from yarclang.report.pictures.drawn_frame import drawn_frame
from yarclang.report.pictures.palette import MOST_BARS, bars_of
from yarclang.report.pictures.plot import SIZE, draw, duration_text
from yarclang.report.pictures.tool_trace import tool_trace_of
from yarclang.report.pictures.toolpath import MOST_DOTS, MOST_POINTS, ToolPath
from yarclang.report.pictures.toolpath import tool_path_of as path_of
from yarclang.report.pictures.trace import MOST_SAMPLES, Trace, peak_of, trace_of

TWO = """\
P0001 MOVEJ_LSPB 40 10 20 0 30 0 [3] (deg,s)
P0002 MOVEJ_LSPB 0 0 0 0 30 90 [4] (deg,s)
P0003 STOP
"""


def tool_path_of(plan: MotionPlan) -> ToolPath:
    return path_of(plan, drawn_frame(plan))


# the limits of INDUSTRIAL6, as its robot.toml has them [deg]
LOWER = np.array([-170.0, -80, -170, -180, -120, -360])
UPPER = np.array([170.0, 90, 80, 180, 120, 360])
VELOCITY, ACCELERATION, JERK = 60.0, 240.0, 2000.0


def planned(folder: Path, text: str, robot: str = "INDUSTRIAL6") -> MotionPlan:
    file = folder / "program.yarc"
    file.write_text(text)
    opened = open_program(str(file), Options(robot=robot))
    assert opened.value is not None, opened.diagnostics
    value = plan_module(opened.value.module, opened.value.request).value
    assert value is not None
    return value


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> MotionPlan:
    return planned(tmp_path_factory.mktemp("two"), TWO)


@pytest.fixture(scope="module")
def long(two: MotionPlan) -> MotionPlan:
    """10,000 motions there and back. One of them is a quick jump."""
    there, back = two.motions[0].curve.points, two.motions[0].curve.points[::-1].copy()
    motions = [
        PlannedMotion(
            k,
            two.motions[0].path,
            "LSPB",
            Curve(back if k % 2 else there, 0.02, there[:, 0]),
            np.array([there[-1]]),
            there[:, 0],
        )
        for k in range(10_000)
    ]
    jump = dataclasses.replace(motions[5_000], curve=Curve(there, 0.005, there[:, 0]))
    motions[5_000] = jump
    step = two.program.steps[two.motions[0].step]
    program = dataclasses.replace(two.program, steps=(step,) * len(motions))
    return MotionPlan(program, two.robot, tuple(motions))


def de_boor(points: np.ndarray, segment: float, time: float) -> np.ndarray:
    """Return a point of a uniform cubic B-spline by repeated interpolation, without any code of Curve."""
    along = time / segment
    k = min(int(along), len(points) - 4)
    level = [points[k + i] for i in range(4)]
    for degree in (3, 2, 1):
        # the i-th of `degree` interpolations lies between the knots i - degree + k + 1 and k + 1 + i
        level = [
            a + (b - a) * (along - (k + 1 + i - degree)) / degree for i, (a, b) in enumerate(pairwise(level))
        ]
    return np.rad2deg(level[0])


def at(drawn: Trace, time: float) -> int:
    row = int(np.argmin(np.abs(drawn.times - time)))
    assert abs(drawn.times[row] - time) < 0.01
    return row


@pytest.mark.parametrize("time", [0.4, 1.11, 2.3, 3.7, 5.02, 6.5])
def test_the_shares_are_those_of_the_executed_curve(two: MotionPlan, time: float) -> None:
    drawn = trace_of(two)
    row = at(drawn, time)
    time = float(drawn.times[row])
    start, motion = (0.0, two.motions[0]) if time < 3.0 else (3.0, two.motions[1])

    def q(when: float) -> np.ndarray:
        return de_boor(motion.curve.points, motion.curve.segment, when - start)

    step = 1e-4
    velocity = (q(time + step) - q(time - step)) / (2 * step)
    acceleration = (q(time + step) - 2 * q(time) + q(time - step)) / step**2
    position = (2 * q(time) - LOWER - UPPER) / (UPPER - LOWER)
    assert drawn.position[row] == pytest.approx(position, abs=1e-9)
    assert drawn.velocity[row] == pytest.approx(velocity / VELOCITY, abs=1e-5)
    # the jerk jumps between two segments, so the difference quotient differs by jerk times step
    assert drawn.acceleration[row] == pytest.approx(acceleration / ACCELERATION, abs=1e-3)


def test_the_jerk_integrates_to_the_acceleration(two: MotionPlan) -> None:
    drawn = trace_of(two)
    gained = np.cumsum(drawn.jerk[1:] * np.diff(drawn.times)[:, None], axis=0) * JERK / ACCELERATION
    assert gained == pytest.approx(drawn.acceleration[1:] - drawn.acceleration[0], abs=1e-9)


def test_the_trace_begins_and_ends_with_the_program(two: MotionPlan) -> None:
    drawn = trace_of(two)
    assert drawn.times[[0, -1]] == pytest.approx([0.0, 7.0])
    assert np.all(np.diff(drawn.times) >= -1e-12)
    assert not drawn.is_thinned
    end = np.array([0, 0, 0, 0, 30, 90])
    assert drawn.position[-1] == pytest.approx((2 * end - LOWER - UPPER) / (UPPER - LOWER))
    assert drawn.velocity[-1] == pytest.approx(np.zeros(6), abs=1e-12)


def test_motor_three_turns_with_two_joints(tmp_path: Path) -> None:
    drawn = trace_of(planned(tmp_path, "P0001 MOVEJ_LSPB 0 20 20 0 30 0 [2] (deg,s)\nP0002 STOP\n"))
    degrees = (drawn.velocity[:, 1] + drawn.velocity[:, 2]) * VELOCITY
    assert drawn.motors[:, 2] == pytest.approx(degrees * 29308.7083 / 3_520_000, abs=1e-9)
    slow = dataclasses.replace(drawn, motors=drawn.velocity * 0.9)
    assert not slow.motors_bind
    fast = dataclasses.replace(drawn, motors=drawn.velocity * 1.1)
    assert fast.motors_bind


def test_a_joint_without_limits_is_drawn_over_half_a_turn(two: MotionPlan) -> None:
    limits = two.robot.limits
    endless = np.where(np.arange(6) == 5, np.inf, UPPER)
    free = dataclasses.replace(limits, lower=-endless, upper=endless)
    robot = dataclasses.replace(two.robot, limits=free)
    assert trace_of(MotionPlan(two.program, robot, two.motions)).position[-1, 5] == pytest.approx(0.5)
    assert trace.has_limits(robot).tolist() == [True] * 5 + [False]
    assert b"%PDF" in draw(MotionPlan(two.program, robot, two.motions), "pdf")[:8]


def test_a_peak_has_a_name_and_a_time(two: MotionPlan) -> None:
    drawn = trace_of(two)
    peak = peak_of(drawn, drawn.velocity)
    # the cruise speed of 90 deg in 4 s is 90 / (4 - 4 / 3) deg/s, because an acceleration takes a third of
    # the time; rounding to whole segments changes it a little
    assert peak.share == pytest.approx(33.75 / VELOCITY, rel=1e-2)
    assert peak.column == 5
    assert 4.0 < peak.time < 6.0


def test_a_long_program_is_bounded_and_keeps_its_peaks(long: MotionPlan) -> None:
    drawn = trace_of(long)
    assert drawn.is_thinned
    assert len(drawn.times) <= MOST_SAMPLES
    assert np.all(np.diff(drawn.times) >= 0.0)
    quick = trace_of(MotionPlan(long.program, long.robot, (long.motions[5_000],)))
    for name in ("velocity", "acceleration", "jerk", "motors"):
        wanted, found = getattr(quick, name), getattr(drawn, name)
        assert np.abs(found).max(axis=0) == pytest.approx(np.abs(wanted).max(axis=0), rel=5e-3)
    jump = peak_of(drawn, drawn.velocity)
    assert jump.time == pytest.approx(float(long.begins[5_000]), abs=2 * long.duration / 4_000)
    path = tool_path_of(long)
    assert len(path.points) <= MOST_POINTS + len(long.motions)
    assert len(path.waypoints) <= MOST_DOTS
    assert len(bars_of(long)) <= MOST_BARS
    assert draw(long, "png").startswith(b"\x89PNG")


def test_of_more_motions_than_points_some_are_drawn(long: MotionPlan) -> None:
    many = 3 * (MOST_POINTS // len(long.motions) + 1)
    motions = long.motions * many
    path = tool_path_of(MotionPlan(long.program, long.robot, motions))
    assert len(path.points) <= 3 * MOST_POINTS
    assert len(path.bounds) == len(motions) + 1
    once = tool_path_of(long)
    assert path.points[-1] == pytest.approx(once.points[-1])


def test_the_tool_path_starts_and_ends_where_the_commands_do(two: MotionPlan) -> None:
    path = tool_path_of(two)
    assert path.frame == "TCP"
    assert path.bounds[0] == 0
    assert path.bounds[-1] == len(path.points)
    for motion, end in zip(path.waypoints, path.bounds[1:], strict=True):
        assert path.points[end - 1] == pytest.approx(motion, abs=1e-6)
    assert path.points[path.bounds[1]] == pytest.approx(path.waypoints[0], abs=1e-6)


def test_the_scale_of_space_is_equal(two: MotionPlan) -> None:
    spaces = [one for one in plot._figure(two).axes if one.name == "3d"]
    assert [one.get_label() for one in spaces] == ["cell", "path"]
    for axes in spaces:
        limits = (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())
        sides = np.array([np.diff(one) for one in limits]).ravel()
        shown = axes._box_aspect
        assert sides / sides[0] == pytest.approx(shown / shown[0])


@pytest.mark.parametrize("peak", [0.004, 0.7, 12.0, 39.9, 60.0, 130.0])
def test_limits_and_peaks_are_within_the_panel(two: MotionPlan, peak: float) -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    wave = np.sin(np.linspace(0.0, 7.0, 50))[:, None] * peak
    panels._draw_quantity(axes, np.linspace(0.0, 1.0, 50), wave, 1.0)
    zoomed = panels._scale(axes, peak, can_zoom=True)
    assert bool(zoomed) == (peak < 40.0)
    low, high = axes.get_ylim()
    assert low < -100.0 < 100.0 < high
    assert low < -peak < peak < high


def test_labels_of_commands_do_not_overlap(long: MotionPlan) -> None:
    for count in (1, 7, 30, 90, 10_000):
        figure = plot._figure(MotionPlan(long.program, long.robot, long.motions[:count]))
        renderer = figure.canvas.get_renderer()
        boxes = sorted(
            (text.get_window_extent(renderer) for text in figure.axes[0].texts), key=lambda box: box.x0
        )
        assert boxes
        assert all(a.x1 < b.x0 for a, b in pairwise(boxes))


def run(*arguments: str | Path, text: str | None = None) -> Result:
    return CliRunner().invoke(main, ["plot", *map(str, arguments)], input=text)


@pytest.fixture
def program(tmp_path: Path) -> Path:
    file = tmp_path / "two $moves$.yarc"
    file.write_text("ROBOT INDUSTRIAL6\n" + TWO)
    return file


def test_a_png_of_the_right_size(program: Path, tmp_path: Path) -> None:
    result = run(program, "-o", tmp_path / "deep" / "x.PNG")
    assert result.exit_code == 0, result.output
    data = (tmp_path / "deep" / "x.PNG").read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", data[16:24]) == SIZE
    assert len(data) < 400_000


def test_other_formats_and_the_default(program: Path, tmp_path: Path) -> None:
    for name, head in (("x.svg", b"<?xml"), ("x.pdf", b"%PDF")):
        assert run(program, "-o", tmp_path / name).exit_code == 0
        assert (tmp_path / name).read_bytes().startswith(head)
    assert run(program).exit_code == 0
    assert program.with_suffix(".png").read_bytes().startswith(b"\x89PNG")


def test_standard_input_and_output() -> None:
    result = run("-", "-o", "-", "--robot", "INDUSTRIAL6", text=TWO)
    assert result.exit_code == 0
    assert result.stdout_bytes.startswith(b"\x89PNG")
    assert "7.000 s drawn to standard output" in result.stderr


@pytest.mark.parametrize("name", ["x.bmp", "x", "png"])
def test_an_unknown_extension_is_wrong_usage(program: Path, tmp_path: Path, name: str) -> None:
    result = run(program, "-o", tmp_path / name)
    assert result.exit_code == 2
    assert ".png, .svg, .pdf" in result.stderr
    assert not (tmp_path / name).exists()


@pytest.mark.parametrize(
    "text",
    ["P0001 MOVEK 1 2 3\nP0002 STOP\n", "P0001 MOVEJ 1 2 [\n", "P0001 MOVEJ 999 0 0 0 0 0 [9] (deg,s)\n"],
)
def test_errors_leave_no_file(tmp_path: Path, text: str) -> None:
    bad = tmp_path / "bad.yarc"
    bad.write_text(text)
    result = run(bad, "-o", tmp_path / "x.png", "--robot", "INDUSTRIAL6")
    assert result.exit_code == 1
    assert "bad.yarc:1:" in result.stderr
    assert "nothing drawn" in result.stderr
    assert not (tmp_path / "x.png").exists()


def test_files_that_cannot_be_read_or_written(program: Path, tmp_path: Path) -> None:
    assert run(tmp_path / "none.yarc", "-o", tmp_path / "x.png").exit_code == 1
    result = run(program, "-o", program / "x.png")
    assert result.exit_code == 1
    assert "Y0107" in result.stderr


def test_a_program_without_motion(tmp_path: Path) -> None:
    still = planned(tmp_path, "P0001 STOP\n")
    drawn = trace_of(still)
    assert not drawn.velocity.any()
    assert bars_of(still) == ()
    assert draw(still, "png").startswith(b"\x89PNG")


def test_the_same_bytes_in_another_process(two: MotionPlan, program: Path) -> None:
    code = (
        "import sys; from yarclang.cli.yarc import main\n"
        "for file in sys.argv[2:]: main(['plot', sys.argv[1], '-o', file], standalone_mode=False)"
    )
    formats = ("png", "svg", "pdf")
    # neither a user's own settings nor earlier drawings may change the bytes
    for number, order in enumerate((formats, formats[::-1])):
        (program.parent / "matplotlibrc").write_text(f"font.size: {10 + 2 * number}\nbackend: TkAgg\n")
        files = [str(program.with_name(f"{number}.{format_}")) for format_ in order]
        subprocess.run(
            [sys.executable, "-c", code, str(program), *files],
            check=True,
            capture_output=True,
            cwd=program.parent,
        )
    for format_ in formats:
        first, second = (program.with_name(f"{number}.{format_}").read_bytes() for number in range(2))
        assert first == second, format_
        assert str(program.parent).encode() not in first


def test_the_commands_list_needs_no_matplotlib() -> None:
    code = (
        "import sys, yarclang.cli.yarc, yarclang.cli.commands.plot, yarclang.report.pictures.plot; "
        "print('matplotlib' in sys.modules)"
    )
    assert (
        subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
        == "False\n"
    )


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0.000 s"),
        (59.9994, "59.999 s"),
        (59.9996, "1 min 00.0 s"),
        (3599.96, "1 h 00 min 00 s"),
        (7385.2, "2 h 03 min 05 s"),
    ],
)
def test_durations(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text


def test_dwells_have_their_place(tmp_path: Path) -> None:
    text = (
        "P0010 WAIT [1] (s)\nP0020 MOVEJ 20 0 0 0 0 0 [2] (deg,s)\nP0030 WAIT [3] (s)\n"
        "P0040 MOVEJ 0 0 0 0 0 0 [2] (deg,s)\nP0050 WAIT [1.5] (s)\n"
    )
    plan = planned(tmp_path, text)
    drawn = trace_of(plan)
    assert (drawn.times[0], drawn.times[-1]) == pytest.approx((0.0, 9.5))
    assert np.all(np.diff(drawn.times) >= 0.0)
    stands = (drawn.times < 1.0) | ((drawn.times > 3.0) & (drawn.times < 6.0)) | (drawn.times > 8.0)
    for values in (drawn.velocity, drawn.acceleration, drawn.jerk):
        assert not values[stands].any()
    # at both ends of each rest there is a sample without jerk, so that no line is drawn through the rest
    for time in (0.0, 1.0, 3.0, 6.0, 8.0, 9.5):
        rows = np.abs(drawn.times - time) < 1e-9
        assert (drawn.jerk[rows] == 0.0).all(axis=1).any()
    frame = tool_trace_of(plan, drawn_frame(plan))
    assert (frame.times[0], frame.times[-1]) == pytest.approx((0.0, 9.5))
    assert frame.speed[frame.times > 8.0].max() == pytest.approx(0.0, abs=1e-9)
    assert [(bar.start, bar.end) for bar in bars_of(plan)] == [
        pytest.approx((1.0, 3.0)),
        pytest.approx((6.0, 8.0)),
    ]
