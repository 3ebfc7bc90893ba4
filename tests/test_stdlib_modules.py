"""Each SUB of the standard library's modules is documented, and its example compiles for the robots."""

import re

import pytest

from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.modules import library_folder, loader
from yarclang.pipeline.stages import compile_module
from yarclang.report.module_text import describe_module

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
"""A curve past a joint position swings beyond it: GOHOME.PAST may."""

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
P0010 MOVEJ READY
P0020 {call}
"""


def compiled(tmp_path, robot, module, call):
    path = tmp_path / "program.yarc"
    path.write_text(PROGRAM.format(robot=robot, module=module, call=call))
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
    assert set(MODULES) == {"APPROACH", "GOHOME", "PALLET", "PICKPLACE", "WARMUP"}


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


def test_a_grid_visits_all_its_cells(tmp_path):
    call = "CALL PALLET.GRID {GRIPPER} {PALLET} 3 2 60 50 80 1"
    done = compiled(tmp_path, "INDUSTRIAL6", "PALLET", call)
    assert len(motions_of_the_call(done)) == 3 * 2 * 3
