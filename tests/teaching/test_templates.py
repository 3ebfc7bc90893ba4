"""Tests of forms and templates: filled forms compile, and unchanged templates are proved on both robots of
the library.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from programs import checked, codes, robot_of

from tests.robot.made_arms import yarc
from tests.robot.trap_arms import arm, written
from tests.robot.trap_arms import robot as made_of
from yarclang.commands.registry import commands
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.teaching.edits import Program, applied
from yarclang.teaching.forms import forms, known, put_in
from yarclang.teaching.holding import around
from yarclang.teaching.templates import filled, new, templates

NAMES = [one.name for one in templates()]
HEAD = (
    "INPUT DOOR M11\n"
    "OUTPUT GRIP M1\n"
    "FRAME {TOOL} 0 150 0 90 0 0 (mm,deg) {FLANGE}\n"
    "DEFAULT {TOOL} [50%] (mm,deg,s) {B}\n"
    "FRAME {BOX} 0 900 500 0 0 0\n"
    "JOINTS READY 0 -10 -20 0 -60 0\n"
    "P0010 MOVEJ READY\n"
)


@pytest.mark.parametrize("robot", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
@pytest.mark.parametrize("name", NAMES)
def test_a_template_is_proved_as_it_comes(name, robot, tmp_path):
    text = filled(name, robot_of(robot), {})
    assert "@" not in text
    told = check_text(SourceFile(str(tmp_path / "x.yarc"), text), tmp_path, Options())
    assert told.compiled is not None
    assert [(one.code, one.message) for one in told.diagnostics] == []


def test_templates_take_only_what_they_ask_for(tmp_path):
    robot = robot_of("INDUSTRIAL6")
    text = new("pick-place", robot, {"grip": "Vacuum", "times": "1"}, tmp_path)
    assert "SET" not in text
    assert "OUTPUT VACUUM M1" in text
    for fields in (
        {"grip": "A B"},
        {"grip": "MOVEJ"},
        {"times": "99"},
        {"times": "1\nSTOP"},
        {"speed": "0"},
        {"other": "1"},
    ):
        with pytest.raises(Trouble):
            filled("pick-place", robot, fields)
    with pytest.raises(Trouble, match="there is no template"):
        filled("../project/program", robot, {})


@pytest.mark.parametrize("tcp", ["0,0,0", "0,0,0,180,0,0", "0,0,150,180,0,0", "0,0,150"])
def test_the_tool_points_down_however_tcp_is_turned(tcp, tmp_path):
    yarc("robot", "new", written(tmp_path, made_of(arm())), "--yes", "--tcp", tcp, "-o", tmp_path / "r")
    made = load_robot(str(tmp_path / "r")).value
    text = filled("pick-place", made, {})
    numbers = re.search(r"^JOINTS READY (.*) \(deg\)", text, re.MULTILINE)[1].split()
    flange = flange_poses(made.chain, np.deg2rad([[float(one) for one in numbers]]))[0]
    assert flange[2, 2] < -0.7, "z of tool0 leads out along the tool"


def test_a_robot_that_cannot_stand_is_told_what_to_correct(tmp_path):
    weight = (
        '<inertial><origin xyz="0 0 0"/><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" '
        'iyz="0" izz="0.1"/></inertial>'
    )
    text = made_of(arm(effort=20)).replace("</collision></link>", f"</collision>{weight}</link>")
    yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    with pytest.raises(Trouble, match="of its effort of 20 N m") as caught:
        new("pick-place", load_robot(str(tmp_path / "r")).value, {}, tmp_path)
    assert "(an effort also in robot.toml); or begin with the template empty" in caught.value.remedy


def named(text):
    here = Path(__file__).parent
    return around(Program(SourceFile(str(here / "test.yarc"), text)), here, robot_of("INDUSTRIAL6"))


def after(text, command, /, **fields):
    line = text.count("\n")
    return applied(text, put_in(named(text), line, command, fields).edits)


def test_every_command_has_a_form():
    found = {one.command: one for one in forms(known(named(HEAD)))}
    assert {"SET", "WAIT", "HOLD", "!", *commands(), "CALL PICKPLACE.PICK"} <= set(found)
    pick = {one.name: one for one in found["CALL PICKPLACE.PICK"].fields}
    assert (pick["TOOL"].kind, pick["TOOL"].choices) == ("frame", ("FLANGE", "TCP", "TOOL"))
    assert (pick["AT"].kind, pick["AT"].value) == ("frame", "BOX")
    assert (pick["ABOVE"].kind, pick["ABOVE"].unit, pick["ABOVE"].value) == ("number", "mm", "100")
    assert (pick["GRIP"].kind, pick["GRIP"].choices) == ("signal", ("GRIP",))
    assert "length of the straight lines" in pick["ABOVE"].label


def test_forms_make_lines_that_compile():
    text = HEAD
    text = after(text, "SET", signal="GRIP", value="ON")
    text = after(text, "WAIT", signal="DOOR", value="ON", time="5")
    text = after(text, "WAIT", time="0.5")
    text = after(text, "HOLD", text="look! then go on")
    text = after(text, "!", comment="a note")
    text = after(text, "MOVEJ", target="READY", percent="20")
    text = after(text, "MOVEL", x="0", y="0", z="50", roll="0", pitch="0", yaw="0", base="BOX", speed="100")
    text = after(text, "CALL PICKPLACE.PICK", TOOL="TOOL", AT="BOX", ABOVE="50", GRIP="GRIP", T="1")
    text = after(text, "STOP")
    assert text.splitlines()[-9:] == [
        "P0020 SET GRIP ON",
        "P0030 WAIT DOOR ON [5]",
        "P0040 WAIT [0.5]",
        'P0050 HOLD "look! then go on"',
        "! a note",
        "P0060 MOVEJ READY [20%]",
        "P0070 MOVEL 0 0 50 0 0 0 [V 100] {BOX}",
        "P0080 CALL PICKPLACE.PICK {TOOL} {BOX} 50 GRIP 1",
        "P0090 STOP",
    ]
    assert "\nUSE PICKPLACE\n" in text
    _, found = checked(text, load=named(text).request.load)
    assert [one.message for one in found if one.is_error] == []
    assert codes(found) == []
    for command, fields in (
        ("SET", {"signal": "GRIP"}),
        ("SET", {"signal": "A\nB", "value": "ON"}),
        ("MOVEL", {"x": "1"}),
        ("NOTHING", {}),
        ("CALL PICKPLACE.PICK", {}),
        ("OUTPUT", {"name": "LAMP"}),
        ("OUTPUT", {"name": "GRIP", "variable": "M7"}),
        ("OUTPUT", {"name": "SET", "variable": "M7"}),
        ("OUTPUT", {"name": "LAMP", "variable": "M7 ON\nSTOP"}),
        ("INPUT", {"name": "LAMP", "variable": "M7", "safe": "ON"}),
    ):
        with pytest.raises(Trouble):
            after(HEAD, command, **fields)


def test_new_signals_stand_with_the_declarations():
    text = after(HEAD, "OUTPUT", name="Lamp", variable="m7", safe="OFF")
    text = after(text, "INPUT", name="BEAM", variable="M17")
    text = after(after(text, "SET", signal="LAMP", value="ON"), "WAIT", signal="BEAM", value="ON", time="2")
    lines = text.splitlines()
    assert lines.index("OUTPUT LAMP M7 OFF") + 1 == lines.index("INPUT BEAM M17")
    assert lines[-2:] == ["P0020 SET LAMP ON", "P0030 WAIT BEAM ON [2]"]
    _, found = checked(text, load=named(text).request.load)
    assert [one.message for one in found if one.is_error] == []


def test_the_form_of_hold_has_a_register_for_an_answer():
    text = HEAD.replace("OUTPUT", "REGISTER BOXES 0..9\nOUTPUT", 1)
    assert "REGISTER BOXES" in text
    form = next(one for one in forms(known(named(text))) if one.command == "HOLD")
    assert [(one.name, one.choices) for one in form.fields] == [("text", ()), ("register", ("", "BOXES"))]
    asked = after(text, "HOLD", text="how many?", register="BOXES")
    told = after(asked, "HOLD", text="go?", register="").splitlines()
    assert told[-2].endswith('HOLD "how many?" BOXES')
    assert told[-1].endswith('HOLD "go?"')
