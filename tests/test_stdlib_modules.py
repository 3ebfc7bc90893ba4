"""Tests of the standard library's modules: each SUB is documented, and its example compiles."""

import re

import numpy as np
import pytest

from yarclang.hir import WaitInput
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.modules import library_folder, loader
from yarclang.pipeline.stages import check_program, compile_module
from yarclang.report.module_text import describe_module
from yarclang.robot.kinematics.fk import tool_poses

PATHS = sorted(library_folder().glob("*.yarc"))
MODULES = {path.stem.upper(): path for path in PATHS}
ROBOTS = ["INDUSTRIAL6", "TRACKED_MANIPULATOR"]


def reference(name):
    read = loader(library_folder())(name)
    assert not read.diagnostics
    return describe_module(read.value)


SUBS = [(name, sub) for name in MODULES for sub in reference(name).subs]
NAMES = [f"{name}.{sub.name}" for name, sub in SUBS]

SWING = "Y0505"
"""A curve may swing beyond a joint position that it passes, as that of GOHOME.PAST does."""

PROGRAM = """\
ROBOT {robot}
USE {module}
DEFAULT {{TCP}} [50%] (mm,deg,s) {{B}}
FRAME {{GRIPPER}} 0 150 0 90 0 0 {{FLANGE}}
FRAME {{BOX}} 100 900 600 0 0 0 {{B}}
FRAME {{PALLET}} -200 800 600 0 0 0 {{B}}
JOINTS BENT 0 -10 -20 0 -40 0
JOINTS READY 5 -15 -25 5 -45 5
OUTPUT GRIP M1
INPUT HELD M11
P0010 MOVEJ READY
"""

BEGINNINGS = {
    "PATTERN.LINE": "0 0",
    "PATTERN.ARC": "40 0",
    "PATTERN.CIRCLE": "40 0",
    "PATTERN.RECTANGLE": "60 0",
    "PATTERN.POLYGON": "$(50*COS(30)) 0",
    "PATTERN.ZIGZAG": "0 0",
    "PATTERN.SPIRAL": "20 0",
    "WEAVE.ZIGZAG": "0 0",
    "WEAVE.TRAPEZOID": "0 0",
    "WEAVE.SOME": "0 0",
    "WEAVE.SINE": "0 0",
}
"""Positions in {BOX} [mm] in which the tool must be before the CALL of a SUB that begins at a certain point.
"""


def compiled(tmp_path, robot, module, call, start=None):
    path = tmp_path / "program.yarc"
    text = PROGRAM.format(robot=robot, module=module)
    begin = start or BEGINNINGS.get(call.split()[1])
    if begin is not None:
        text += f"P0020 MOVEJ_RPY {{GRIPPER}} {begin} 0 0 0 0 {{BOX}}\n"
    path.write_text(f"{text}P0030 {call}\n")
    opened = open_program(str(path), Options())
    result = compile_module(opened.value.module, opened.value.request)
    found = (*opened.diagnostics, *result.diagnostics)
    assert [one.message for one in found if one.code != SWING] == []
    return result.value


def ends(done):
    return done.plan.motions[-1].curve.points[-1] / done.plan.robot.axis_units


def motions_of_the_call(done):
    steps = done.program.steps
    return [one for one in done.plan.motions if ">" in steps[one.step].origin.place]


def test_the_modules_are_there():
    assert set(MODULES) == {"APPROACH", "GOHOME", "PALLET", "PATTERN", "PICKPLACE", "WARMUP", "WEAVE"}


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(("module", "sub"), SUBS, ids=NAMES)
def test_the_example_of_each_sub_compiles_and_is_certified(module, sub, robot, tmp_path):
    done = compiled(tmp_path, robot, module, sub.example)
    assert len(done.certificate.commands) == len(done.plan.motions) > 1


@pytest.mark.parametrize(("module", "sub"), SUBS, ids=NAMES)
def test_comment_and_head_have_the_same_parameters(module, sub):
    assert sub.strangers == ()
    assert [one.name for one in sub.parameters if not one.meaning] == []
    assert sub.purpose.endswith(".")
    assert sub.example.startswith(f"CALL {module}.{sub.name}")


@pytest.mark.parametrize("name", MODULES)
def test_a_module_says_what_it_is_for_in_a_line(name):
    assert 20 < len(reference(name).title) < 100


@pytest.mark.parametrize("name", MODULES)
def test_indices_are_unique_and_ascending(name):
    indices = re.findall(r"^\s*(P\d+)", MODULES[name].read_text(), re.MULTILINE)
    assert indices == sorted(set(indices))


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize(
    ("call", "end"),
    [
        ("SWING 6 12 3", [5, -15, -25, 5, -45, 5]),
        ("EACH BENT 5 1 3", [0, -10, -20, 0, -40, 0]),
        ("TOGETHER BENT 5 2 3", [0, -10, -20, 0, -40, 0]),
    ],
)
def test_warming_up_ends_where_it_begins(robot, call, end, tmp_path):
    assert ends(compiled(tmp_path, robot, "WARMUP", f"CALL WARMUP.{call}")) == pytest.approx(end, abs=1e-3)


def test_a_swing_moves_its_joint_and_no_other(tmp_path):
    for joint in range(6):
        done = compiled(tmp_path, "INDUSTRIAL6", "WARMUP", f"CALL WARMUP.SWING {joint + 1} 10 4")
        first, second, third = motions_of_the_call(done)
        for motion, by in ((first, 10), (second, -20), (third, 10)):
            moved = (motion.curve.points[-1] - motion.curve.points[0]) / done.plan.robot.axis_units
            assert moved == pytest.approx([by * (number == joint) for number in range(6)], abs=1e-3)


@pytest.mark.parametrize("robot", ROBOTS)
def test_going_home_ends_at_home(robot, tmp_path):
    for call in ("GOHOME.DIRECT", "GOHOME.SLOWLY", "GOHOME.PAST BENT 6"):
        done = compiled(tmp_path, robot, "GOHOME", f"CALL {call}")
        home = done.plan.robot.positions["HOME"] / done.plan.robot.axis_units
        assert ends(done) == pytest.approx(home, abs=1e-3)


@pytest.mark.parametrize(("sub", "state"), [("PICK", 1.0), ("PLACE", 0.0)])
def test_the_gripper_moves_when_the_tool_is_at_the_place(sub, state, tmp_path):
    call = f"CALL PICKPLACE.{sub} {{GRIPPER}} {{BOX}} 100 GRIP 1"
    steps = compiled(tmp_path, "INDUSTRIAL6", "PICKPLACE", call).program.steps
    assert [step.origin.name for step in steps] == ["MOVEJ", "MOVEJ_RPY", "MOVEL", "SET", "WAIT", "DMOVE"]
    assert steps[3].value == state


@pytest.mark.parametrize(
    ("sub", "waits"),
    [("PICK_CHECKED", ["SET 1", "WAIT 1 1.5"]), ("PLACE_CHECKED", ["WAIT 1 1.5", "SET 0", "WAIT 0 1.5"])],
)
def test_a_checked_gripper_leaves_when_its_input_says_so(sub, waits, tmp_path):
    call = f"CALL PICKPLACE.{sub} {{GRIPPER}} {{BOX}} 100 GRIP 1 HELD 1.5"
    steps = compiled(tmp_path, "INDUSTRIAL6", "PICKPLACE", call).program.steps
    told = [
        f"WAIT {one.value:g} {one.timeout:g}" if isinstance(one, WaitInput) else one.origin.name
        for one in steps
    ]
    told = [f"SET {one.value:g}" if name == "SET" else name for one, name in zip(steps, told, strict=True)]
    assert told == ["MOVEJ", "MOVEJ_RPY", "MOVEL", *waits, "DMOVE"]


def test_a_grid_visits_all_its_cells(tmp_path):
    call = "CALL PALLET.GRID {GRIPPER} {PALLET} 3 2 60 50 80 1"
    done = compiled(tmp_path, "INDUSTRIAL6", "PALLET", call)
    assert len(motions_of_the_call(done)) == 3 * 2 * 3


def where_it_grips(done):
    """Return the value of each SET, and the rounded position of {GRIPPER} in {B} at this SET [mm]."""
    told = []
    steps = done.program.steps
    ended = {motion.step: motion for motion in done.plan.motions}
    for at, step in enumerate(steps):
        if step.origin.name == "SET":
            before = max(place for place in ended if place < at)
            q = ended[before].curve.points[-1][None]
            pose = tool_poses(done.plan.robot.chain, q, steps[before].goal.flange_from_moving)[0]
            told.append((step.value, *(float(value) for value in np.round(pose[:3, 3] * 1e3, 2))))
    return told


CELLS = [(x, y, z) for z in (0, 40) for y in (0, 60) for x in (0, 50, 100)]
"""Order of the cells: first along x, then y, then z [mm]."""


def test_filling_takes_each_part_from_its_place_to_the_next_cell(tmp_path):
    call = "CALL PALLET.FILL {GRIPPER} {BOX} {PALLET} 3 2 2 50 60 40 100 GRIP 1.5 HELD 30"
    done = compiled(tmp_path, "INDUSTRIAL6", "PALLET", call)
    expected = [
        each
        for x, y, z in CELLS
        for each in [(1.0, 100.0, 900.0, 600.0), (0.0, x - 200.0, y + 800.0, z + 600.0)]
    ]
    assert where_it_grips(done) == expected
    waits = [step for step in done.program.steps if isinstance(step, WaitInput)]
    assert [(step.value, step.timeout) for step in waits] == [(1.0, 30.0)] * len(CELLS)


def test_emptying_begins_with_the_upper_layer(tmp_path):
    call = "CALL PALLET.EMPTY {GRIPPER} {PALLET} {BOX} 3 2 2 50 60 40 100 GRIP 1.5 HELD 30"
    done = compiled(tmp_path, "INDUSTRIAL6", "PALLET", call)
    order = [*CELLS[6:], *CELLS[:6]]
    expected = [
        each
        for x, y, z in order
        for each in [(1.0, x - 200.0, y + 800.0, z + 600.0), (0.0, 100.0, 900.0, 600.0)]
    ]
    assert where_it_grips(done) == expected
    waits = [at for at, step in enumerate(done.program.steps) if isinstance(step, WaitInput)]
    assert len(waits) == len(order)


def drawn(done, count=400):
    """Return the positions of {GRIPPER} in {BOX} [mm] along each motion of the call, (count, 3) each, at
    equal intervals of time.
    """
    step = done.program.steps[done.plan.motions[-1].step]
    goal = step.waypoints[-1] if hasattr(step, "waypoints") else step.goal
    places = []
    for motion in motions_of_the_call(done):
        q = motion.curve.sample(np.linspace(0.0, motion.curve.duration, count))[0]
        poses = tool_poses(done.plan.robot.chain, q, goal.flange_from_moving)
        places.append(poses[:, :3, 3] * 1e3 - [100.0, 900.0, 600.0])
    return places


def flows(done):
    return [motion.flows for motion in motions_of_the_call(done)]


@pytest.mark.parametrize(
    ("call", "start", "end"),
    [
        ("PATTERN.CIRCLE {GRIPPER} {BOX} 40 50", (40, 0), (40, 0)),
        ("PATTERN.ARC {GRIPPER} {BOX} 40 -90 50", (40, 0), (0, -40)),
        ("PATTERN.RECTANGLE {GRIPPER} {BOX} 120 80 10 5 (cm)", (60, 0), (60, 0)),
        ("PATTERN.POLYGON {GRIPPER} {BOX} 3 60 8 50", (30, 0), (30, 0)),
        ("PATTERN.ZIGZAG {GRIPPER} {BOX} 100 3 20 8 50", (0, 0), (100, 40)),
        ("PATTERN.ZIGZAG {GRIPPER} {BOX} 100 4 20 8 50", (0, 0), (0, 60)),
        ("PATTERN.SPIRAL {GRIPPER} {BOX} 50 20 2 30", (50, 0), (20, 0)),
        ("WEAVE.ZIGZAG {GRIPPER} {BOX} 96 24 10 3 10", (0, 0), (96, 0)),
        ("WEAVE.TRAPEZOID {GRIPPER} {BOX} 120 60 10 4 10", (0, 0), (120, 0)),
        ("WEAVE.SINE {GRIPPER} {BOX} 96 12 3 12", (0, 0), (96, 0)),
    ],
)
def test_a_pattern_begins_and_ends_where_its_comment_says_and_does_not_stop(call, start, end, tmp_path):
    module = call.split(".")[0]
    done = compiled(tmp_path, "INDUSTRIAL6", module, f"CALL {call}", "{} {}".format(*start))
    places = drawn(done)
    assert places[0][0] == pytest.approx([*start, 0], abs=1e-3)
    assert places[-1][-1] == pytest.approx([*end, 0], abs=1e-3)
    assert flows(done) == [True] * (len(places) - 1) + [False]
    assert np.abs(np.concatenate(places)[:, 2]).max() < 0.02


def test_a_pattern_without_rounding_stops_in_its_corners(tmp_path):
    done = compiled(
        tmp_path, "INDUSTRIAL6", "PATTERN", "CALL PATTERN.RECTANGLE {GRIPPER} {BOX} 120 80 0 50", "60 0"
    )
    assert flows(done) == [False] * 5
    corners = [place[-1][:2] for place in drawn(done)[:4]]
    assert np.round(corners, 3).tolist() == [[60, 40], [-60, 40], [-60, -40], [60, -40]]


@pytest.mark.parametrize("angle", [360, 390, -200])
def test_an_arc_keeps_its_radius(angle, tmp_path):
    done = compiled(
        tmp_path, "INDUSTRIAL6", "PATTERN", f"CALL PATTERN.ARC {{GRIPPER}} {{BOX}} 40 {angle} 50", "40 0"
    )
    places = np.concatenate(drawn(done))
    assert np.hypot(places[:, 0], places[:, 1]) == pytest.approx(40.0, abs=0.02)
    turned = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))[-1]
    assert np.rad2deg(turned) == pytest.approx(angle, abs=0.01)


def test_a_polygon_passes_near_its_corners(tmp_path):
    call = "CALL PATTERN.POLYGON {GRIPPER} {BOX} 5 60 8 50"
    done = compiled(tmp_path, "INDUSTRIAL6", "PATTERN", call, "$(60*COS(36)) 0")
    places = np.concatenate(drawn(done))
    for angle in np.deg2rad([36, 108, 180, 252, 324]):
        corner = 60 * np.array([np.cos(angle), np.sin(angle), 0])
        assert np.linalg.norm(places - corner, axis=1).min() < 8.0
    assert np.hypot(places[:, 0], places[:, 1]).min() == pytest.approx(60 * np.cos(np.pi / 5), abs=0.02)


def test_a_spiral_is_nearly_even(tmp_path):
    call = "CALL PATTERN.SPIRAL {GRIPPER} {BOX} 20 50 3 40"
    places = np.concatenate(drawn(compiled(tmp_path, "INDUSTRIAL6", "PATTERN", call)))
    turned = np.unwrap(np.arctan2(places[:, 1], places[:, 0]))
    assert turned[-1] == pytest.approx(6 * np.pi, abs=1e-3)
    even = 20 + 10 * turned / (2 * np.pi)
    assert np.hypot(places[:, 0], places[:, 1]) == pytest.approx(even, abs=0.1 * 10)


@pytest.mark.parametrize(
    "call",
    [
        "ZIGZAG {GRIPPER} {BOX} 96 23 10 3 10",
        "TRAPEZOID {GRIPPER} {BOX} 120 60 10 4 10",
        "SINE {GRIPPER} {BOX} 96 12 3 12",
    ],
)
def test_a_weave_goes_along_its_seam_at_its_speed(call, tmp_path):
    done = compiled(tmp_path, "INDUSTRIAL6", "WEAVE", f"CALL WEAVE.{call}")
    length, _, amplitude, *_, speed = (float(value) for value in call.split()[3:])
    taken = sum(motion.curve.duration for motion in motions_of_the_call(done))
    assert taken == pytest.approx(length / speed, rel=0.05)
    places = np.concatenate(drawn(done))
    assert np.diff(places[:, 0]).min() > -1e-6
    assert 0.8 * amplitude < np.abs(places[:, 1]).max() < 1.02 * amplitude


def test_a_sine_is_one(tmp_path):
    done = compiled(tmp_path, "INDUSTRIAL6", "WEAVE", "CALL WEAVE.SINE {GRIPPER} {BOX} 96 12 3 12")
    places = np.concatenate(drawn(done))
    assert places[:, 1] == pytest.approx(3 * np.sin(2 * np.pi * places[:, 0] / 12), abs=0.03 * 3)


@pytest.mark.parametrize(("length", "waves"), [(13.9, 1), (72, 6), (84, 7), (97, 8), (160, 13)])
def test_the_seam_is_divided_into_whole_waves(length, waves, tmp_path):
    path = tmp_path / "program.yarc"
    call = f"P0020 CALL WEAVE.SINE {{GRIPPER}} {{BOX}} {length} 12 3 12\n"
    path.write_text(PROGRAM.format(robot="INDUSTRIAL6", module="WEAVE") + call)
    opened = open_program(str(path), Options())
    steps = check_program(opened.value.module, opened.value.request).value.steps[1:]
    assert len(steps) == -(-waves // 6)
    places = [goal.base_from_moving[:2, 3] * 1e3 - [100, 900] for step in steps for goal in step.waypoints]
    sides = {(round(x, 6), round(y, 6)) for x, y in places if abs(y) > 1}
    assert len(sides) == 2 * waves
    assert sorted(y for _, y in sides) == [-3] * waves + [3] * waves
    assert places[-1] == pytest.approx([length, 0])


def test_a_pattern_that_begins_elsewhere_is_refused_where_it_would_bend(tmp_path):
    text = PROGRAM.format(robot="INDUSTRIAL6", module="PATTERN")
    path = tmp_path / "program.yarc"
    path.write_text(
        f"{text}P0020 MOVEJ_RPY {{GRIPPER}} 50 0 0 0 0 0 {{BOX}}\n"
        f"P0030 CALL PATTERN.CIRCLE {{GRIPPER}} {{BOX}} 40 50\n"
    )
    opened = open_program(str(path), Options())
    result = compile_module(opened.value.module, opened.value.request)
    assert [one.code for one in result.diagnostics] == ["Y0607"]
