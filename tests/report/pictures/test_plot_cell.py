"""The picture of a plan besides the joints: the robot in its cell, waits, outputs, clearance, and kinds of
motions.
"""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from tests.robot.made_arms import DATA, REAL, made
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import plan_module
from yarclang.report.clearance import SEEN
from yarclang.report.pictures import plot
from yarclang.report.pictures.actions import actions_of, planned_signals
from yarclang.report.pictures.bodies import _moved, _outline, surroundings_of, within
from yarclang.report.pictures.clearance import clearance_of
from yarclang.report.pictures.palette import bars_of
from yarclang.report.pictures.plot import draw
from yarclang.report.pictures.style import LONGEST_NAME, short_name
from yarclang.robot.kinematics.fk import flange_poses

EXAMPLES = Path(__file__).parents[3] / "examples"

CELL = """\
units = "mm,deg,s"

[[obstacles]]
name = "DESK"
frame = "B"
shape = "box"
size = [400, 600, 40]
xyz = [900, 200, 100]

[[obstacles]]
name = "FLOOR"
frame = "B"
shape = "box"
size = [90000, 90000, 20]
xyz = [0, 0, -500]

[[zones]]
name = "GUARD"
rule = "forbidden"
frame = "B"
shape = "box"
size = [200, 300, 400]
xyz = [-500, 0, 400]
"""

ACTS = """\
ROBOT INDUSTRIAL6
INPUT READY M1000
INPUT OTHER M1001
OUTPUT GLUE M2000
OUTPUT LAMP M2001
P0010 SET GLUE ON
P0020 MOVEJ 10 0 0 0 30 0 [2] (deg,s)
P0030 WAIT READY ON
P0040 WAIT [1.5] (s)
WHEN OTHER ON
P0050 SET LAMP ON
P0060 SET GLUE OFF
ELSE
P0070 SET LAMP ON
END
P0080 MOVEJ 0 0 0 0 30 0 [2] (deg,s)
P0090 SET LAMP OFF
"""


def planned(file: Path, robot: str | None = None, cell: Path | None = None) -> MotionPlan:
    opened = open_program(str(file), Options(robot=robot, cell=None if cell is None else str(cell)))
    assert opened.value is not None, opened.diagnostics
    value = plan_module(opened.value.module, opened.value.request)
    assert value.value is not None, value.diagnostics
    return value.value


def of_text(folder: Path, text: str, cell: str = "") -> MotionPlan:
    (folder / "program.yarc").write_text(text)
    if cell:
        (folder / "cell.toml").write_text(cell)
    return planned(folder / "program.yarc", cell=folder / "cell.toml" if cell else None)


def example(number: str, robot: str | None = None) -> MotionPlan:
    (file,) = EXAMPLES.glob(f"{number}_*.yarc")
    return planned(file, robot)


@pytest.fixture(scope="module")
def acts(tmp_path_factory: pytest.TempPathFactory) -> MotionPlan:
    return of_text(tmp_path_factory.mktemp("acts"), ACTS)


def test_links_move_as_the_flange_does() -> None:
    robot = example("28").robot
    q = robot.home + 0.3
    moved = _moved(robot, q)
    assert moved[0] == pytest.approx(np.eye(4))
    assert moved[-1] @ robot.chain.base_from_flange == pytest.approx(flange_poses(robot.chain, q[None])[0])


def test_the_cell_stands_where_its_file_says(tmp_path: Path) -> None:
    plan = of_text(tmp_path, "ROBOT INDUSTRIAL6\nP0010 MOVEJ 10 0 0 0 30 0 [2] (deg,s)\n", CELL)
    found = {body.name: body for body in surroundings_of(plan).bodies}
    assert found["DESK"].kind == "obstacle"
    assert found["DESK"].triangles.min(axis=(0, 1)) == pytest.approx([700, -100, 80])
    assert found["DESK"].triangles.max(axis=(0, 1)) == pytest.approx([1100, 500, 120])
    assert (found["GUARD"].kind, found["GUARD"].rule) == ("zone", "forbidden")
    assert {body.kind for body in found.values()} == {"robot", "obstacle", "zone"}


def test_a_floor_of_90_m_neither_shrinks_the_picture_nor_leaves_it(tmp_path: Path) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    plan = of_text(tmp_path, "ROBOT INDUSTRIAL6\nP0010 MOVEJ 10 0 0 0 30 0 [2] (deg,s)\n", CELL)
    figure = plot._figure(plan)
    (axes,) = (one for one in figure.axes if one.get_label() == "cell")
    low, high = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()]).T
    assert (high - low).max() < 5000.0
    figure.canvas.draw()
    for one in axes.collections:
        if isinstance(one, Poly3DCollection):
            pixels = np.concatenate([axes.transData.transform(path.vertices) for path in one.get_paths()])
            assert len(pixels) < 20_000
            assert (pixels >= np.array([0.62, 0.48]) * figure.bbox.size).all()
            assert (pixels <= figure.bbox.size).all()


def test_names_of_obstacles_and_zones_are_in_the_picture(tmp_path: Path) -> None:
    plan = of_text(tmp_path, "ROBOT INDUSTRIAL6\nP0010 MOVEJ 10 0 0 0 30 0 [2] (deg,s)\n", CELL)
    drawn = draw(plan, "svg").decode()
    for text in ("DESK", "GUARD", "forbidden zone", "obstacle", "robot and cell at the start, in {B}"):
        assert f"<!-- {text} -->" in drawn, text


def test_triangles_within_a_box_are_a_part_of_the_body() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        triangles = rng.uniform(-100.0, 100.0, (30, 3, 3))
        part = within(triangles, np.full(3, -60.0), np.full(3, 60.0), 25.0)
        assert len(part) > 20
        assert (np.abs(part) <= 60.0 + 1e-9).all()
        middle = part.mean(axis=1)
        normals = np.cross(part[:, 1] - part[:, 0], part[:, 2] - part[:, 0])
        area = np.linalg.norm(normals, axis=1)
        part, middle, normals = part[area > 1e-3], middle[area > 1e-3], normals[area > 1e-3]
        whole = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        whole /= np.linalg.norm(whole, axis=1, keepdims=True)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        # each piece lies in the plane of one of the triangles, and faces as this triangle does
        facing = normals @ whole.T > 1.0 - 1e-9
        level = np.abs(np.einsum("ki,ji->kj", middle, whole) - np.einsum("ji,ji->j", triangles[:, 0], whole))
        assert (facing & (level < 1e-6)).any(axis=1).all()
    # no area is lost: a square of 200 that is cut to 120 has the area of a square of 120
    square = np.array(
        [[[-100.0, -100, 0], [100, -100, 0], [100, 100, 0]], [[-100, -100, 0], [100, 100, 0], [-100, 100, 0]]]
    )
    part = within(square, np.full(3, -60.0), np.full(3, 60.0), 25.0)
    areas = np.cross(part[:, 1] - part[:, 0], part[:, 2] - part[:, 0])[:, 2] / 2.0
    assert (areas >= 0.0).all()
    assert areas.sum() == pytest.approx(120.0**2)
    inside = rng.uniform(-5.0, 5.0, (12, 3, 3))
    kept = within(inside, np.full(3, -60.0), np.full(3, 60.0), 100.0)
    assert np.array_equal(kept, inside)


def test_an_outline_is_within_the_body_and_faces_outwards() -> None:
    rng = np.random.default_rng(5)
    points = rng.normal(size=(4000, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    corners, faces = _outline(points)
    assert 100 < len(faces) <= 320
    a, b, c = corners[faces].transpose(1, 0, 2)
    assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0.0).all()
    flat = points * [1.0, 1.0, 0.0]
    corners, faces = _outline(flat)
    assert len(faces) == 12
    assert corners.max(axis=0) == pytest.approx(flat.max(axis=0))


def test_waits_and_outputs_have_their_times(acts: MotionPlan) -> None:
    found = [(one.sort, one.text, one.start, one.end) for one in actions_of(acts)]
    assert found[:3] == [
        ("set", "GLUE ON", 0.0, 0.0),
        ("wait", "WAIT READY ON", pytest.approx(2.0), pytest.approx(2.0)),
        ("dwell", "WAIT 1.5 s", pytest.approx(2.0), pytest.approx(3.5)),
    ]
    drawn = draw(acts, "svg").decode()
    for text in ("GLUE", "READY", "inputs and outputs", "  WAIT READY ON, WAIT 1.5 s"):
        assert f"<!-- {text} -->" in drawn, text


def test_after_ways_that_differ_an_output_is_unknown(acts: MotionPlan) -> None:
    rows = {row.name: row for row in planned_signals(acts)}
    assert list(rows) == ["GLUE", "READY", "LAMP"]
    assert rows["READY"].is_input
    assert [one[0] for one in rows["READY"].waits] == pytest.approx([2.0])
    # GLUE is off after one branch and on after the other, so GLUE's row ends where the branches begin
    assert [value for _, _, value in rows["GLUE"].stretches] == [1.0]
    assert rows["GLUE"].stretches[0][1] == pytest.approx(3.5)
    # both branches switch LAMP on
    (lamp,) = rows["LAMP"].stretches
    assert lamp == pytest.approx((3.5, 5.5, 1.0))


def test_passes_of_a_loop_have_the_colours_of_their_lines() -> None:
    plan = example("06")
    bars = bars_of(plan)
    lines = [plan.origin_of(bar.first).span.line for bar in bars]
    sources = [plan.origin_of(bar.first).source.name for bar in bars]
    colours: dict[tuple[str, int], set[object]] = {}
    for bar, source, line in zip(bars, sources, lines, strict=True):
        colours.setdefault((source, line), set()).add(bar.colour)
    assert len(colours) < len(bars) / 10
    assert all(len(one) == 1 for one in colours.values())
    assert len({next(iter(one)) for one in colours.values()}) == len(colours)


def test_process_approach_and_joint_motions_are_drawn_differently() -> None:
    plan = example("10")
    sorts = {bar.sort for bar in bars_of(plan)}
    assert sorts == {"process", "led", "joints"}
    (axes,) = (one for one in plot._figure(plan).axes if one.get_label() == "path")
    lines = {one.get_label(): one for one in axes.collections if "Line" in type(one).__name__}
    widths = {label: one.get_linewidth()[0] for label, one in lines.items()}
    assert (
        widths["tool at the speed of [V ..]"]
        > widths["other path of the tool"]
        > widths["motion of the joints"]
    )
    assert lines["motion of the joints"].get_linestyle()[0][1] is not None


def test_the_clearance_is_that_of_the_bodies(tmp_path: Path) -> None:
    plan = example("31")
    found = clearance_of(plan)
    assert found is not None
    assert set(found.pair) == {"RUBBER", "HOUSING"}
    assert found.apart.min() == pytest.approx(0.005, abs=2e-4)
    assert (found.apart <= SEEN).all()
    assert (found.apart >= 0.0).all()
    assert (found.times[0], found.times[-1]) == pytest.approx((0.0, plan.duration))


def test_a_robot_without_bodies_has_neither_cell_nor_clearance(acts: MotionPlan) -> None:
    import dataclasses

    bare = dataclasses.replace(acts.robot, shapes=(), tools=(), folder=Path("/nowhere"))
    plan = MotionPlan(acts.program, bare, acts.motions)
    assert clearance_of(plan) is None
    labels = [one.get_label() for one in plot._figure(plan).axes if one.name == "3d"]
    assert labels == ["path"]


def test_a_quantity_says_its_units() -> None:
    drawn = draw(example("28"), "svg").decode()
    velocity = re.findall(r"<!-- most: (\S+) % = (\S+) deg/s, ", drawn)
    assert len(velocity) == 1
    assert float(velocity[0][0]) / 100.0 * 60.0 == pytest.approx(float(velocity[0][1]), rel=5e-3)
    assert "deg/s²" in drawn
    assert "deg/s³" in drawn


@pytest.mark.parametrize("name", ["short", "x" * 90, "one_very_long_name_of_a_link", "a\nb\x00c" * 9])
def test_short_names(name: str) -> None:
    short = short_name(name)
    assert len(short) <= LONGEST_NAME
    assert short.isprintable()
    assert short[:5] == "".join(one if one.isprintable() else "·" for one in name)[:5]


@pytest.mark.parametrize("which", ["01", "06", "10", "28", "31", "acts", "panda", "ur5"])
def test_no_text_lies_on_another(which: str, acts: MotionPlan, tmp_path: Path) -> None:
    if which == "acts":
        plan = acts
    elif which in REAL:
        robot = made(DATA / REAL[which][0], tmp_path / which)
        q = np.rad2deg(robot.home)
        words = " ".join(f"{one:.2f}" for one in q + 5.0)
        (tmp_path / "program.yarc").write_text(f"P0010 MOVEJ {words} [2] (mm,deg,s)\n")
        plan = planned(tmp_path / "program.yarc", str(robot.folder))
    else:
        plan = example(which, "INDUSTRIAL6" if which == "01" else None)
    figure = plot._figure(plan)
    figure.canvas.draw()
    assert overlaps(figure) == []


def overlaps(figure: object) -> list[tuple[str, str]]:
    """Return pairs of texts that overlap, except for numbers and names in 3D axes, and texts beyond the
    figure.
    """
    from matplotlib.text import Text

    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    spaces = {id(axes) for axes in figure.axes if axes.name == "3d"}  # type: ignore[attr-defined]
    within_space = {
        id(text)
        for axes in figure.axes  # type: ignore[attr-defined]
        if id(axes) in spaces
        for text in axes.findobj(Text)
    }
    texts = [
        one
        for one in figure.findobj(Text)  # type: ignore[attr-defined]
        if one.get_visible() and one.get_text().strip() and id(one) not in within_space
    ]
    boxes = [(one.get_text(), one.get_window_extent(renderer)) for one in texts]
    boxes = [(text, box) for text, box in boxes if box.width > 0.0]
    assert len(boxes) > 30
    width, height = figure.bbox.width, figure.bbox.height  # type: ignore[attr-defined]
    # the boxes of numbers in 3D axes are wrong, but those of the axes' labels are right
    anywhere = [*texts, *(one for one in figure.findobj(Text) if one.get_text().endswith(" [mm]"))]  # type: ignore[attr-defined]
    all_boxes = [(one.get_text(), one.get_window_extent(renderer)) for one in anywhere]
    beyond = [
        (text, "") for text, box in all_boxes if box.x0 < 0 or box.y0 < 0 or box.x1 > width or box.y1 > height
    ]
    return beyond + [
        (one, other)
        for (one, a), (other, b) in combinations(boxes, 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > 1.0 and min(a.y1, b.y1) - max(a.y0, b.y0) > 2.0
    ]
