"""Tests of CELL in programs and modules: the names that are known after its line, and conflicts."""

from dataclasses import replace

import numpy as np
import pytest
from programs import codes, source

from yarclang.pipeline.cells import cell_loader, check_cell, check_description
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.modules import loader
from yarclang.pipeline.stages import Request, check_program, compile_module, plan_module
from yarclang.robot.description import load_robot
from yarclang.syntax.parse import parse

CELL = """units = "mm,deg"
[frames]
FIXTURE = { parent = "B", xyz = [0, 620, 560] }
GRIPPER = { parent = "FLANGE", xyz = [0, 150, 0], rpy = [90, 0, 0] }
[joints]
READY = [0, -15, -25, 0, -50, 0]
[inputs]
DOOR = "M11"
[outputs]
GRIP = { variable = "M1", safe = "OFF" }
"""
DEFAULT = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"


def program(folder, text, robot="INDUSTRIAL6", *, cell=CELL, plan=False, **modules):
    (folder / "cell.toml").write_text(cell)
    for name, module in modules.items():
        (folder / f"{name}.yarc").write_text(module)
    parsed = parse(source(text))
    found = load_robot(robot).value
    request = Request(found, load=loader(folder), load_cell=cell_loader(folder, found))
    result = (plan_module if plan else check_program)(parsed.value, request)
    return result.value, (*parsed.diagnostics, *result.diagnostics)


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_the_example_compiles_for_both_robots(robot):
    from conftest import EXAMPLES

    opened = open_program(str(EXAMPLES / "09_fixture_cell.yarc"), Options(robot=robot))
    made = compile_module(opened.value.module, opened.value.request)
    assert codes(made.diagnostics) == []
    assert [one.name for one in made.value.program.cell.zones] == ["FLOOR", "AT_FIXTURE"]
    assert [(one.signal.name, one.safe) for one in made.value.program.outputs] == [
        ("GRIP", None),
        ("CLAMP", 0.0),
    ]


def test_a_program_with_a_cell_is_the_one_with_its_declarations(tmp_path):
    rest = (
        "START READY\nP0010 WAIT DOOR ON [5]\nP0020 MOVEL {GRIPPER} 0 0 50 0 0 0 {FIXTURE}\nP0030 SET GRIP ON"
    )
    lines = (
        "FRAME {FIXTURE} 0 620 560 0 0 0\n"
        "FRAME {GRIPPER} 0 150 0 90 0 0 {FLANGE}\n"
        "JOINTS READY 0 -15 -25 0 -50 0\n"
        "INPUT DOOR M11\n"
        "OUTPUT GRIP M1 OFF\n"
    )
    from yarclang.identity import fingerprint

    one, found = program(tmp_path, f'{DEFAULT}CELL "cell.toml"\n{rest}')
    other, _ = program(tmp_path, f"{DEFAULT}{lines}{rest}")
    assert codes(found) == []
    assert fingerprint(one) == fingerprint(other)
    link = one.steps[1].origin.base
    assert (link.name, link.parent.name, link.span.line) == ("FIXTURE", "B", 3)


BODIES = """
[[obstacles]]
name = "POST"
shape = "cylinder"
frame = "B"
xyz = [3000, 0, 0]
radius = 60
length = 100
margin = 10
[[obstacles]]
name = "PRESS"
shape = "mesh"
file = "press.stl"
frame = "FIXTURE"
[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
watch = ["tool", "elbow"]
"""


def test_another_cell_is_another_program(tmp_path):
    """A program's fingerprint depends on obstacles, margins and zones, but not on comments or folders."""
    from yarclang.identity import fingerprint

    def print_of(name, cell=CELL + BODIES, press=b"solid a\nendsolid a\n"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "press.stl").write_bytes(press)
        made, found = program(folder, f'{DEFAULT}CELL "cell.toml"\nP0010 MOVEJ READY', cell=cell)
        assert codes(found) == []
        return fingerprint(made)

    first = print_of("first")
    assert print_of("second") == first
    assert print_of("third", CELL + BODIES + "# a comment\n") == first
    others = [
        print_of(f"other{at}", CELL + BODIES.replace(*change))
        for at, change in enumerate(
            [
                ("margin = 10", "margin = 11"),
                ("radius = 60", "radius = 61"),
                ("xyz = [3000, 0, 0]", "xyz = [3000, 0, 1]"),
                ('rule = "allowed"', 'rule = "forbidden"'),
                ('watch = ["tool", "elbow"]', 'watch = ["tool"]'),
                ("normal = [0, 0, 1]", "normal = [0, 0, 1]\nxyz = [0, 0, 1]"),
            ]
        )
    ]
    others += [print_of("mesh", press=b"solid b\nendsolid b\n"), print_of("bare", CELL)]
    assert len({first, *others}) == 1 + len(others)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            'CELL "cell.toml"\nJOINTS READY 0 0 0 0 0 0',
            [("Y0206", "READY is declared already, in line 6 of")],
        ),
        (
            'CELL "cell.toml"\nFRAME {FIXTURE} 0 0 0 0 0 0',
            [("Y0206", "{FIXTURE} is declared already, in line 3 of")],
        ),
        ('LET READY = 5\nCELL "cell.toml"', [("Y0206", "READY is declared already, in line 2 of test.yarc")]),
        ('FRAME {FIXTURE} 0 0 0 0 0 0\nCELL "cell.toml"', [("Y0206", "already, in line 2 of test.yarc")]),
        ('CELL "cell.toml"\nREPEAT DOOR 2\nEND', [("Y0206", "DOOR is declared already, in line 8 of")]),
        ('CELL "cell.toml"\nOUTPUT LAMP M1', [("Y0415", "M1 has two names: GRIP in line 10 of")]),
        ('CELL "cell.toml"\nOUTPUT LAMP M11', [("Y0416", "M11 is the input DOOR in line 8 of")]),
        ('INPUT EYE M1\nCELL "cell.toml"', [("Y0416", "M1 is the input EYE in line 2 of test.yarc")]),
        ('P0005 MOVEJ 5 0 0 0 0 0\nCELL "cell.toml"', [("Y0208", "before the first command")]),
        ('CELL "cell.toml"\nLET HOME = 4', [("Y0214", "HOME is a joint position of INDUSTRIAL6")]),
        ('CELL "cell.toml"\nFRAME {PICK} 0 0 50 0 0 0 {FIXTURE}', []),
    ],
)
def test_names_of_a_cell_hide_nothing(tmp_path, text, expected):
    _, found = program(tmp_path, f"{DEFAULT}{text}\nP0010 MOVEJ 10 0 0 0 0 0")
    assert [one.code for one in found] == [code for code, _ in expected]
    for one, (_, message) in zip(found, expected, strict=True):
        assert message in one.message


def test_a_frame_of_the_robot_cannot_be_a_cells(tmp_path):
    found = program(tmp_path, 'CELL "cell.toml"\nP0010 STOP', cell='[frames]\nTCP = { parent = "FLANGE" }')[1]
    assert [(one.code, one.source.name.rpartition("/")[2]) for one in found] == [("Y1310", "cell.toml")]


def test_a_tool_frame_that_the_robot_names_cannot_be_a_cells(tmp_path):
    robot = load_robot("INDUSTRIAL6").value
    robot = replace(robot, flange_from_frame={**robot.flange_from_frame, "GRIPPER": np.eye(4)}, written=None)
    (tmp_path / "cell.toml").write_text(CELL)
    request = Request(robot, load_cell=cell_loader(tmp_path, robot))
    (found,) = check_program(parse(source('CELL "cell.toml"\nP0010 STOP')).value, request).diagnostics
    assert (found.code, found.message) == ("Y0206", "{GRIPPER} is a frame of the robot already")
    assert found.span.line == 4


def test_a_text_that_is_being_edited(tmp_path):
    text = CELL.replace("-50, 0]", "-50]").replace('"B"', '"BB"')
    assert codes(check_cell(source(text), tmp_path)) == ["Y1329"]
    assert codes(check_cell(source(text), tmp_path, load_robot("INDUSTRIAL6").value)) == ["Y1329", "Y1309"]
    crlf = check_cell(source(text.replace("\n", "\r\n")), tmp_path)
    assert [(one.code, one.span.line) for one in crlf] == [("Y1329", 3)]


def test_home_of_a_cell_is_home(tmp_path):
    made, found = program(
        tmp_path, f'{DEFAULT}CELL "cell.toml"\nP0010 MOVEJ HOME', cell=CELL.replace("READY", "HOME")
    )
    assert codes(found) == []
    assert made.steps[0].goal.q[1] == pytest.approx(-0.2617993878)


def test_a_mistake_in_the_file_is_the_only_finding(tmp_path):
    text = f'{DEFAULT}CELL "cell.toml"\nP0010 MOVEL 0 0 50 0 0 0 {{FIXTURE}}\nP0020 MOVEJ READY'
    for old, new in (
        ('"B"', '"BB"'),
        ("-50, 0]", "-50]"),
        ('"M11"', '"X1"'),
        ("[joints]", "[joint]"),
        ("620", '"620"'),
    ):
        _, found = program(tmp_path, text, cell=CELL.replace(old, new), plan=True)
        assert len(found) == 1 or new == "[joint]", codes(found)
        assert found[0].source.name.endswith("cell.toml")
    for broken in ("[frames", "\x00"):
        assert len(program(tmp_path, text, cell=broken, plan=True)[1]) == 1


MODULE = (
    'CELL "cell.toml"\n'
    "DEFAULT {GRIPPER} [5] (mm,deg,s) {FIXTURE}\n"
    "SUB GO\n"
    "P0010 MOVEJ READY\n"
    "P0020 SET GRIP ON\n"
    "END\n"
)


def test_a_module_reads_its_programs_cell(tmp_path):
    text = (
        f'{DEFAULT}CELL "cell.toml"\n'
        "USE CLAMP\n"
        "P0010 CALL CLAMP.GO\n"
        "P0020 MOVEJ CLAMP.READY\n"
        "P0030 MOVEJ READY"
    )
    made, found = program(tmp_path, text, clamp=MODULE)
    assert codes(found) == []
    assert made.steps[0].goal.q is made.steps[3].goal.q
    assert made.steps[2].goal.q is made.steps[3].goal.q
    assert len(made.outputs) == 1
    alone, found = program(tmp_path, "USE CLAMP\nP0010 CALL CLAMP.GO", clamp=MODULE)
    assert codes(found) == []
    assert alone.cell.source.name.endswith("cell.toml")
    assert len(alone.outputs) == 1


def test_two_cells_are_refused(tmp_path):
    (tmp_path / "other.toml").write_text("")
    text = 'CELL "other.toml"\nUSE CLAMP\nP0010 CALL CLAMP.GO'
    _, found = program(tmp_path, text, clamp=MODULE)
    assert codes(found) == ["Y1373"]
    (tmp_path / "link.toml").symlink_to(tmp_path / "cell.toml")
    assert codes(program(tmp_path, text.replace("other", "link"), clamp=MODULE)[1]) == []


def test_a_module_has_no_robot_and_no_start(tmp_path):
    assert codes(program(tmp_path, "USE M\nP0010 STOP", m="START HOME\nROBOT INDUSTRIAL6\n")[1]) == [
        "Y0208",
        "Y0208",
    ]


def test_the_path_counts_from_the_file(tmp_path):
    (tmp_path / "cells").mkdir()
    (tmp_path / "cells" / "left.toml").write_text(CELL)
    assert codes(program(tmp_path, 'CELL "cells/left.toml"\nP0010 MOVEJ READY [5] (s)')[1]) == []


def test_a_description_by_itself(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL.replace("-50, 0]", "-50]"))
    path = str(tmp_path / "cell.toml")
    assert codes(check_description(path, None)) == []
    assert codes(check_description(path, "INDUSTRIAL6")) == ["Y1309"]
    (tmp_path / "robot.toml").write_text("name = 5")
    assert "Y1304" in codes(check_description(str(tmp_path / "robot.toml"), None))


def test_indices_of_a_module_are_checked(tmp_path):
    module = (
        "SUB GO\n"
        "P0010 MOVEJ HOME [5] (s)\n"
        "P0010 MOVEJ HOME [4] (s)\n"
        "MOVEJ HOME [4] (s)\n"
        "P0005 WAIT [1] (s)\n"
        "END"
    )
    found = program(tmp_path, "USE M\nP0010 STOP", m=module)[1]
    assert [(one.code, one.span.line) for one in found] == [("Y0201", 3), ("Y0105", 4), ("Y1201", 5)]
    assert all(one.source.name.endswith("m.yarc") for one in found)


def test_findings_about_a_time_say_what_the_call_gave(tmp_path):
    sub = "SUB GO T (s)\n  P0010 MOVEJ 90 0 0 0 0 0 [$(T*1)] (deg)\nEND\n"
    _, found = program(tmp_path, f"{sub}P0020 CALL GO 0.5", plan=True)
    assert codes(found) == ["Y0601"]
    assert found[0].help.endswith("T is `0.5` in line 4")
    assert found[0].fix is None
    _, found = program(tmp_path, "USE M\nP0020 CALL M.GO 0.5\nP0030 CALL M.GO -1", m=sub, plan=True)
    assert [one.help.rpartition("; ")[2] for one in found] == [
        "T is `0.5` in line 2 of test.yarc",
        "T is `-1` in line 3 of test.yarc",
    ]
