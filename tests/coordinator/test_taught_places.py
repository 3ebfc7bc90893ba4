"""Tests of JPOS and LPOS: the robot's position is stored under a name and shown as a line of a program. The
program uses it only after the line was put into its text.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, compiled, robot_of

import yarclang
from tests.certify.forging import Forger
from yarclang.certify.certifying import certify
from yarclang.coordinator.kept_registers import registers_file
from yarclang.coordinator.taught_places import Place, forget, line_of, places, teach
from yarclang.pipeline.stages import Request, check_program
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.actions import Teach, Trouble
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} (mm,deg,s) {B}\n"


@pytest.fixture(autouse=True)
def state(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


def test_what_is_taught_is_there_until_it_is_forgotten():
    robot, wanted = (
        robot_of("INDUSTRIAL6"),
        Teach("joints", "SPOT", np.deg2rad([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])),
    )
    assert places() == []
    assert not registers_file().exists()
    line = teach(robot, "ARM simulated", "/cell/box", wanted)
    assert line == "JOINTS SPOT 1 2 3 4 5 6 (deg)"
    teach(robot, "ARM 10.0.0.1:1025", "/cell/box", Teach("joints", "SPOT", np.zeros(6)))
    again = teach(robot, "ARM simulated", "/cell/box", Teach("joints", "SPOT", np.ones(6) * np.pi))
    found = places("/cell/box")
    assert [one.controller for one in found] == ["ARM 10.0.0.1:1025", "ARM simulated"]
    assert found[1] == Place("ARM simulated", "/cell/box", "SPOT", again)
    assert places("/cell/other") == []
    assert (forget("/cell/box"), places()) == (2, [])


def test_a_broken_database_is_told(tmp_path):
    registers_file().parent.mkdir(parents=True)
    registers_file().write_bytes(b"junk" * 999)
    with pytest.raises(OSError, match=r"registers\.sqlite"):
        teach(robot_of("INDUSTRIAL6"), "ARM", "/cell/box", Teach("joints", "SPOT", np.zeros(6)))
    for use in (places, lambda: forget("/cell/box")):
        with pytest.raises(Trouble, match=r"registers\.sqlite"):
            use()


@given(st.lists(st.floats(-60.0, 60.0), min_size=6, max_size=6))
def test_a_line_that_is_shown_declares_the_place(values):
    robot, q = robot_of("INDUSTRIAL6"), np.deg2rad(values)
    text = (
        f"{line_of(robot, 'joints', 'A', q)}\n"
        f"{line_of(robot, 'pose', 'P', q)}\n"
        f"DEFAULT {{TCP}} [5] (mm,deg,s) {{B}}\n"
    )
    program, found = checked(f"{text}P0010 MOVEJ A\nP0020 MOVEJ_RPY P\n")
    assert not [one for one in found if one.is_error]
    joints, pose = (step.goal for step in program.steps)
    assert np.abs(joints.q - q).max() < np.deg2rad(6e-5)
    (there,) = tool_poses(robot.chain, q[None], robot.flange_from_frame["TCP"])
    assert np.abs(pose.base_from_moving - there).max() < 3e-6


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("P0010 JPOS SPOT\nP0020 MOVEJ SPOT [3]", "Y0209"),
        ("P0010 LPOS SPOT\nP0020 MOVEJ_RPY SPOT [3]", "Y0209"),
        ("P0010 JPOS 5", "Y0211"),
        ("P0010 JPOS ON", "Y0211"),
        (f"P0010 JPOS {'A' * 99}", "Y0211"),
        ("P0010 JPOS", "Y0401"),
        ("P0010 JPOS A B", "Y0401"),
        ("REGISTER N 0..5\nP0010 JPOS N", "Y0209"),
        ("P0010 JPOS SPOT [2]", "Y0412"),
    ],
)
def test_what_can_not_be_taught_or_used_is_told(lines, code):
    found = [one for one in checked(HEAD + lines)[1] if one.is_error]
    assert found
    if code != "Y0412":
        assert code in codes(found)
    if code == "Y0209" and "MOVEJ" in lines:
        assert "yarc registers" in found[0].help


def test_joints_that_are_declared_may_be_taught_for_the_next_time():
    program, found = checked(HEAD + "JOINTS SPOT 5 0 0 0 0 0\nP0010 MOVEJ SPOT [3]\nP0020 JPOS SPOT\n")
    assert not found
    assert program.steps[-1].teaches == "joints"


def test_older_programs_may_have_the_names():
    assert not checked(HEAD + "JOINTS LPOS 5 0 0 0 0 0\nP0010 MOVEJ LPOS [3]\n")[1]


def test_a_typed_line_teaches_nothing():
    module = parse(SourceFile("<line>", "JPOS SPOT")).value
    found = check_program(module, Request(robot_of("INDUSTRIAL6"), index_needed=False)).diagnostics
    assert "Y0208" in codes(found)


@pytest.mark.parametrize(
    "forge",
    [
        lambda text: text.change("(; command 1 P0020) JPOS (.*)", r"\1 SAY \2"),
        lambda text: text.change("(; command 1 P0020) JPOS (.*)", r"\1 LPOS \2"),
        lambda text: text.change("(; barrier [0-9]+ say .*) SPOT", r"\1 SPAT"),
    ],
)
def test_a_text_that_teaches_otherwise_is_refused(forge):
    text = HEAD + "P0010 MOVEJ 20 0 0 0 -30 0 [2]\nP0020 JPOS SPOT\nP0030 MOVEJ HOME [2]\n"
    made = compiled(text)[0]
    robot = robot_of("INDUSTRIAL6")
    assert certify(made.text, made.plan.program, robot, robot.tolerance).value is not None
    forged = forge(Forger.of(made.text))
    found = certify(forged.text, made.plan.program, robot, robot.tolerance)
    assert [one for one in found.diagnostics if one.is_error]


def test_no_program_buffer_teaches():
    found = yarclang.check(HEAD + "P0010 MOVEJ 5 0 0 0 0 0 [2]\nP0020 JPOS SPOT\n", robot="INDUSTRIAL6")
    assert not found
    result = compiled(HEAD + "P0010 MOVEJ 5 0 0 0 0 0 [2]\nP0020 JPOS SPOT\n", target="prog")
    assert "Y1106" in codes(result[1])
