"""Tests with URDFs that contain a trap. The robot is right, or the refusal gives the reason. Pinocchio, which
reads the original text, checks joints, solutions and paths.
"""

from __future__ import annotations

import re
import struct
import time

import numpy as np
import pinocchio as pin
import pytest
from programs import compiled

from tests.robot.made_arms import made, yarc
from tests.robot.trap_arms import (
    CYLINDER,
    HAND,
    ROD,
    WEIGHT,
    Y,
    arm,
    follows,
    joint,
    link,
    poses,
    robot,
    written,
)
from yarclang.robot.actuation import from_counts
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import flange_poses, reaching
from yarclang.robot.kinematics.search import within
from yarclang.robot.new.folder import open_arm

SIX = tuple(f"joint_{number}" for number in range(1, 7))


def judged(text, robot_, base="base_link", flange="tool0", names=SIX):
    """Compare joints, forward kinematics and solutions of a robot with Pinocchio's for the URDF. Then plan
    and prove a line.
    """
    assert robot_.size == len(names)
    q = within(robot_.chain, robot_.limits, 200)
    true = poses(text, base, flange, names, q)
    np.testing.assert_allclose(flange_poses(robot_.chain, q), true, atol=1e-9)
    found, solved = reaching(robot_.chain, robot_.limits, true)
    assert solved.mean() >= 0.99
    np.testing.assert_allclose(poses(text, base, flange, names, found[solved]), true[solved], atol=3e-6)


def moves(folder):
    result, diagnostics = compiled(
        "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0010 DMOVEJ 5 5 5 5 5 5\nP0020 DMOVE 20 10 -15 0 0 5\n",
        str(folder),
    )
    assert result is not None, diagnostics


WHOLE = {
    "rod": (arm() + ROD, 1),
    "counterweight": (arm() + WEIGHT, 1),
    "rods, cylinder and counterweight": (arm() + ROD + WEIGHT + CYLINDER, 3),
    "mimic fingers": (arm() + HAND, 2),
    "rods and fingers": (arm() + ROD + HAND, 3),
    "planar base": (link("world") + arm(base=("world", "planar")), 1),
    "floating base": (link("world") + arm(base=("world", "floating")), 1),
    "wheels": (arm() + link("wheel") + joint("wheel_joint", "base_link", "wheel", kind="continuous"), 1),
}


@pytest.mark.parametrize("trap", WHOLE)
def test_an_arm_keeps_its_six_joints(trap, tmp_path):
    body, ignored = WHOLE[trap]
    text = robot(body)
    made_of_it = made(written(tmp_path, text), tmp_path / "r", "--tcp", "0,0,100")
    judged(text, made_of_it)
    toml = (tmp_path / "r" / "robot.toml").read_text()
    line = next(one for one in toml.splitlines() if one.startswith("ignored_joints"))
    assert line.count('"') == 2 * ignored
    moves(tmp_path / "r")


def test_followers_and_vehicles_are_said(tmp_path):
    text = robot(link("world"), arm(base=("world", "planar")), ROD, WEIGHT)
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert "follow another by <mimic>" in result.output
    assert "rod_joint, weight_joint" in result.output
    assert "planar and floating joints of a vehicle are treated as fixed: foot" in result.output


def test_a_chain_that_is_coupled_is_refused(tmp_path):
    """A palletizer whose wrist stays level, because it follows joint 3."""
    text = robot(
        link("base_link"),
        *(link(f"link_{number}") for number in range(1, 6)),
        joint("joint_1", "base_link", "link_1", (0, 0, 0.7425)),
        joint("joint_2", "link_1", "link_2", (0.26, 0, 0), Y),
        joint("joint_3", "link_2", "link_3", (0, 0, 0.945), Y),
        joint("level", "link_3", "link_4", (1.025, 0, 0), Y, more=follows("joint_3", -1)),
        joint("joint_6", "link_4", "link_5", (0.22, 0, -0.2)),
    )
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1353" in result.output
    assert "level" in result.output
    assert "coupled" in result.output
    assert not (tmp_path / "r").exists()


def test_two_arms_ask_which(tmp_path):
    text = robot(link("torso"), arm("left_", base=("torso", "")), arm("right_", base=("torso", "")))
    file = written(tmp_path, text)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1365" in result.output
    assert "right_joint_1" in result.output
    assert not (tmp_path / "r").exists()
    right = made(file, tmp_path / "r", "--tip", "right_tool0", "--base", "right_base_link")
    judged(text, right, "right_base_link", "right_tool0", tuple(f"right_{name}" for name in SIX))


def test_a_torso_is_a_joint_of_the_arm(tmp_path):
    text = robot(
        link("foot"), link("torso"), joint("lift", "foot", "torso", kind="prismatic"), arm(base=("torso", ""))
    )
    judged(
        text, made(written(tmp_path, text), tmp_path / "r", "--base", "foot"), "foot", "tool0", ("lift", *SIX)
    )


def test_link8_comes_before_link7_and_no_hand_is_a_flange(tmp_path):
    body = (
        "".join(link(f"link{number}") for number in range(4))
        + link("link4", shape=False)
        + link("robotiq_base")
    )
    body += "".join(joint(f"j{n}", f"link{n}", f"link{n + 1}", (0, 0, 0.3), Y) for n in range(3))
    last = joint("j4", "link3", "link4", (0, 0, 0.1), kind="fixed")
    hand = joint("hand", "link3", "robotiq_base", (0, 0, 0.2), kind="fixed")
    opened = open_arm(written(tmp_path, robot(body, hand, last)), None, None)
    assert opened.value is not None
    assert opened.value.chain.flange == "link4"


def test_names_with_other_letters_are_mapped_and_said(tmp_path):
    text = robot(arm("r1/")).replace("link_3", "链 3").replace("joint_5", "Ellbogen ü\u202e")
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "r1/base_link is r1_base_link" in result.output
    assert "\u202e" not in result.output
    from yarclang.robot.description import load_robot

    loaded = load_robot(str(tmp_path / "r"))
    assert loaded.value is not None
    names = [f"r1/{name}".replace("joint_5", "Ellbogen ü\u202e") for name in SIX]
    judged(text, loaded.value, "r1/base_link", "r1/tool0", names)


def test_two_names_that_become_one_stay_two(tmp_path):
    text = (
        robot(arm())
        .replace('"link_2"', '"link 2"')
        .replace('"link_3"', '"link/2"')
        .replace('"link_4"', '"link_2"')
    )
    judged(text, made(written(tmp_path, text), tmp_path / "r"))


FLAT = (
    '<visual><geometry><box size="0 0 0"/></geometry><material name="a"/><material name="b"><color rgba="1 '
    '0 0 1"/></material></visual>'
)
PLATE = (
    '<visual><geometry><box size="1 1 1"/></geometry><material name="a"/><material '
    'name="b"></material></visual><collision><geometry><box size="0.1 0.1 0"/></geometry></collision>'
)


def test_boxes_without_a_size_and_second_materials(tmp_path):
    text = robot(
        arm(), link("plate", FLAT + PLATE, shape=False), joint("to_plate", "base_link", "plate", kind="fixed")
    )
    file = written(tmp_path, text)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "1 shapes without a size" in result.output
    assert "1 mm thick" in result.output
    assert 'size="0.1 0.1 0.001"' in (tmp_path / "r" / "arm.urdf").read_text()
    judged(text, made(file, tmp_path / "s"))


def test_placeholders_of_limits_are_guesses(tmp_path):
    mass = (
        '<inertial><mass value="100"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    )
    text = robot(arm(effort=1)).replace(
        'lower="-2.5" upper="2.5" velocity="2"', 'lower="-999999" upper="999999" velocity="0"'
    )
    text = text.replace("<collision>", f"{mass}<collision>")
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "the effort 1, a placeholder" in result.output
    toml = (tmp_path / "r" / "robot.toml").read_text()
    assert toml.count("position = [-180, 180]  # guess:") == 6
    assert toml.count("velocity = 60  # guess:") == 6
    moves(tmp_path / "r")


XMLNS = ' xmlns:xacro="http://www.ros.org/wiki/xacro"'


@pytest.mark.parametrize("end", ["/>", "></xacro:property>", ">\n</xacro:property >"])
def test_a_stray_property_is_left_out(end, tmp_path):
    text = robot(arm())
    with_it = text.replace(">", f'{XMLNS}><xacro:property name="pi" value="3.14"{end}', 1)
    judged(text, made(written(tmp_path, with_it), tmp_path / "r"))


MACRO = """<robot name="trap"{xmlns} version="1.1"><xacro:property name="reach" value="${{2 * 0.5375}}"/>
<xacro:include filename="$(find maker_support)/urdf/arm.xacro"/></robot>"""


def test_xacro_and_packages_by_their_package_xml(tmp_path):
    text = robot(arm())
    inner = text.replace(">", f"{XMLNS}>", 1).replace("0 0 1.075", "0 0 ${reach}")
    package = tmp_path / "src" / "any-folder"
    written(package / "urdf", inner, "arm.xacro")
    (package / "package.xml").write_text("<package><name>maker_support</name></package>")
    file = written(tmp_path / "mine", MACRO.format(xmlns=XMLNS), "cell.xacro")
    refused = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert refused.exit_code == 1
    assert "maker_support" in refused.output
    assert "--package-path" in refused.output
    judged(text, made(file, tmp_path / "r", "--package-path", str(tmp_path / "src")))


def test_arguments_of_xacro(tmp_path):
    """Files of manufacturers need arguments, such as the type and a prefix."""
    text = robot(arm("left_"))
    asked = text.replace(">", f'{XMLNS}><xacro:arg name="prefix" default="wrong_"/>', 1).replace(
        "left_", "$(arg prefix)"
    )
    asked = asked.replace("0 0 1.075", "0 0 $(arg reach)")
    file = written(tmp_path, asked, "arm.urdf.xacro")
    refused = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r", "--arg", "prefix=left_")
    assert refused.exit_code == 1
    assert "--arg NAME=VALUE" in refused.output
    arm_ = made(file, tmp_path / "r", "--arg", "prefix=left_", "--arg", "reach:=1.075")
    q = within(arm_.chain, arm_.limits, 50)
    true = poses(text, "left_base_link", "left_tool0", arm_.joint_names, q)
    np.testing.assert_allclose(flange_poses(arm_.chain, q), true, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [("a.xacro", "prefix", "isn't NAME=VALUE"), ("a.urdf", "a=b", "for xacro files")],
)
def test_wrong_arguments_of_xacro(name, given, words, tmp_path):
    result = yarc(
        "robot", "new", written(tmp_path, robot(arm()), name), "--yes", "-o", tmp_path / "r", "--arg", given
    )
    assert result.exit_code == 2
    assert words in " ".join(result.output.split())


def test_nothing_is_run_of_the_folder_of_a_xacro_file(tmp_path, monkeypatch):
    """No Python file in the folder of the xacro file is executed, since the folder may come from an unpacked
    archive.
    """
    file = written(tmp_path, robot(arm()).replace(">", f"{XMLNS}>", 1), "arm.xacro")
    for name in ("xacro.py", "resource.py"):
        (tmp_path / name).write_text("open('run', 'w')\n")
    monkeypatch.chdir(tmp_path)
    made(file, tmp_path / "r")
    assert not (tmp_path / "run").exists()


def test_a_macro_that_calls_itself_ends(tmp_path):
    text = f'<robot name="t"{XMLNS}><xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/></robot>'
    result = yarc("robot", "new", written(tmp_path, text, "t.xacro"), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1341" in result.output


def cube() -> bytes:
    """Return a tetrahedron as a binary STL."""
    corners = [(0, 0, 0), (0.02, 0, 0), (0, 0.02, 0), (0, 0, 0.02)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    rows = (struct.pack("<12fH", 0, 0, 0, *(x for at in face for x in corners[at]), 0) for face in faces)
    return bytes(80) + struct.pack("<I", 4) + b"".join(rows)


@pytest.mark.parametrize("how", ["option", "environment", "own"])
def test_a_mesh_of_a_package_whose_folder_has_another_name(how, tmp_path, monkeypatch):
    mesh = (
        "<collision><geometry><mesh "
        'filename="package://maker_support/meshes/a%20b.stl"/></geometry></collision>'
    )
    text = robot(
        arm(), link("stand", mesh, shape=False), joint("to_stand", "base_link", "stand", kind="fixed")
    )
    package = tmp_path / "src" / "deep" / "maker-support-2.1"
    (package / "meshes").mkdir(parents=True)
    (package / "meshes" / "a b.stl").write_bytes(cube())
    (package / "package.xml").write_text("<package><name>maker_support</name></package>")
    file = written(package / "urdf" if how == "own" else tmp_path, text)
    if how == "environment":
        monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "src"))
    said = ("--package-path", str(tmp_path / "src")) if how == "option" else ()
    judged(text, made(file, tmp_path / "r", *said))
    assert [one.read_bytes() for one in (tmp_path / "r" / "meshes").iterdir()] == [cube()]


@pytest.mark.parametrize(
    ("text", "words"), [("<mujoco model='a'/>", "MJCF"), ("<?xml version='1.0'?><sdf version='1.9'/>", "SDF")]
)
def test_other_formats_are_named(text, words, tmp_path):
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert words in result.output
    assert "manufacturer's URDF" in result.output


@pytest.mark.parametrize(
    ("tcp", "words"),
    [
        ("0,0,100", "z of TCP points out along the tool, into the work; PICKPLACE and PALLET need it to point back; for these"),  # noqa: E501
        ("0,0,100,180,0,0", "z of TCP points back along the tool, away from the work, as PICKPLACE and PALLET need it"),  # noqa: E501
        ("0,0,100,90,0,0", "z of TCP points neither out nor back along the tool"),
    ],
)  # fmt: skip
def test_the_way_of_the_tools_z_is_said(tcp, words, tmp_path):
    """By Pinocchio, the tip is 100 mm along z of tool0. Unless TCP is turned, this z points out along the
    tool.
    """
    file = written(tmp_path, robot(arm()))
    result = yarc("robot", "new", file, "--yes", "--tcp", tcp, "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert words in result.output


def deep(count: int, more: str = "") -> str:
    links = "".join(link(f"l{number}", shape=False) for number in range(count + 1))
    return robot(links, *(joint(f"j{n}", f"l{n}", f"l{n + 1}", more=more) for n in range(count)))


HOSTILE = {
    "laughs": '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;">]><robot name="&b;"/>',
    "nested": "<robot name='a'>" + "<a>" * 100_000,
    "nan": robot(arm()).replace('lower="-2.5"', 'lower="nan"'),
    "cycle": robot(link("a"), link("b"), joint("x", "a", "b"), joint("y", "b", "a")),
    "999 joints in a row": deep(999),
    "999 that follow": deep(999, follows("j0")),
    "100,000 links side by side": robot(
        arm(), *(link(f"x{n}", shape=False) + joint(f"j{n}", "base_link", f"x{n}") for n in range(100_000))
    ),
    "9,000 links side by side": robot(
        arm(), *(link(f"x{n}", shape=False) + joint(f"j{n}", "base_link", f"x{n}") for n in range(9_000))
    ),
    "20,000 shapes": robot(
        arm(),
        link("s", '<collision><geometry><box size="1 1 1"/></geometry></collision>' * 20_000),
        joint("j", "base_link", "s", kind="fixed"),
    ),
    "follows itself": robot(link("a"), link("b"), joint("x", "a", "b", more=follows("x"))),
    "a direction and a line": robot(link("a"), link("b"), joint("x\u202e&#10;y", "a", "c\u2066&#10;Y9999")),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_what_is_hostile_is_refused_quickly(name, tmp_path):
    file = written(tmp_path, HOSTILE[name])
    begun = time.process_time()
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert time.process_time() - begun < 5
    assert result.exit_code == 1
    assert result.exception is None or isinstance(result.exception, SystemExit)
    assert "Y13" in result.output
    assert not any(sign in result.output for sign in "\u202e\u2066")
    assert "\nY9999" not in result.output


MISSING = '<collision><geometry><mesh filename="x.stl"/></geometry></collision>'


def test_the_name_of_a_mesh_that_is_missing_stays_on_its_line(tmp_path):
    mesh = '<collision><geometry><mesh filename="a&#10;Y9999&#x202e;.stl"/></geometry></collision>'
    text = robot(arm(), link("s", mesh, shape=False), joint("j", "base_link", "s", kind="fixed"))
    file = written(tmp_path, text)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "collision mesh a?Y9999?.stl of s isn't there" in result.output
    result = yarc("robot", "new", file, "--yes", "--allow-missing-meshes", "-o", tmp_path / "r")
    assert result.exit_code == 0
    assert "left out: a?Y9999?.stl of s" in result.output
    assert "\nY9999" not in result.output


@pytest.mark.parametrize(
    "text",
    ["<robot", robot(arm(), link("s", MISSING, shape=False), joint("j", "base_link", "s", kind="fixed"))],
)
def test_the_name_of_a_file_stays_on_its_line(text, tmp_path):
    folder = tmp_path / "a\nY9999 \u202eb"
    result = yarc("robot", "new", written(folder, text, "a\nY9999\u202e.urdf"), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "\nY9999" not in result.output
    assert "\u202e" not in result.output


def test_a_hundred_megabytes_are_refused_quickly(tmp_path):
    with (tmp_path / "arm.urdf").open("wb") as file:
        file.truncate(100_000_000)
    result = yarc("robot", "new", tmp_path / "arm.urdf", "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "Y1302" in result.output


K, B = -0.75, 0.1
"""Coupling of the joint `level`: q = K q' + B [rad]."""


def palletizer(more: str) -> str:
    """Return an arm of five joints, in which `level` follows joint_3 if `more` says so."""
    return robot(
        link("base_link"),
        *(link(f"link_{number}") for number in range(1, 6)),
        joint("joint_1", "base_link", "link_1", (0, 0, 0.7425)),
        joint("joint_2", "link_1", "link_2", (0.26, 0, 0), Y),
        joint("joint_3", "link_2", "link_3", (0, 0, 0.945), Y),
        joint("level", "link_3", "link_4", (1.025, 0, 0), Y, more=more),
        joint("joint_6", "link_4", "link_5", (0.22, 0, -0.2)),
    )


def test_a_coupled_chain_is_written_in_J_as_the_message_says(tmp_path):
    """With the numbers of the message in robot.toml, the arm equals the one that Pinocchio makes of the URDF
    with <mimic>.
    """
    coupled = palletizer(f'<mimic joint="joint_3" multiplier="{K}" offset="{B}"/>')
    result = yarc("robot", "new", written(tmp_path, coupled), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    said = " ".join(result.output.split())
    assert "level [deg] = -0.75 * joint_3 [deg] + 5.72957795131 (multiplier -0.75, offset 0.1)" in said
    row = re.search(
        r"its row of J is (\S+) for joint_3, 1 for level and 0 else, and its a0 is (\S+) \* K", said
    )
    factor, offset = (float(value) for value in row.groups())

    # Only the motor axes X, Y and Z can be coupled.
    made(written(tmp_path, palletizer("")), tmp_path / "r", "--counts", "1000")
    toml = tmp_path / "r" / "robot.toml"
    text = toml.read_text()
    rows = np.eye(5)
    rows[3, 2] = factor
    for pattern, new in (
        (r"^J = .*$", f"J = {rows.tolist()}"),
        (r"^a0 = .*$", f"a0 = [0, 0, 0, {offset * 1000.0!r}, 0]"),
        (r"^axes = .*$", 'axes = ["A", "B", "X", "Y", "C"]'),
    ):
        text, count = re.subn(pattern, new, text, flags=re.MULTILINE)
        assert count == 1, pattern
    toml.write_text(text)
    loaded = load_robot(str(tmp_path / "r"))
    assert loaded.value is not None, loaded.diagnostics

    # The motor of `level` is at 0 counts, the other motors are anywhere.
    counts = np.random.default_rng(0).uniform(-5e4, 5e4, (200, 5))
    counts[:, 3] = 0.0
    q = from_counts(loaded.value, counts)
    np.testing.assert_allclose(q[:, 3], K * q[:, 2] + B, atol=1e-12)
    model = pin.buildModelFromXML(coupled, mimic=True)
    state = model.createData()
    assert model.nq == 4
    base, tip = (model.getFrameId(name, pin.FrameType.BODY) for name in ("base_link", "link_5"))
    for values, pose in zip(q, flange_poses(loaded.value.chain, q), strict=True):
        pin.framesForwardKinematics(model, state, np.delete(values, 3))
        true = (state.oMf[base].inverse() * state.oMf[tip]).homogeneous
        np.testing.assert_allclose(pose, true, atol=1e-9)
    result, diagnostics = compiled("P0010 DMOVEJ 5 5 5 5 5 [MIN] (deg,s)", str(tmp_path / "r"))
    assert result is not None, diagnostics


def test_a_chain_that_follows_a_joint_elsewhere_has_no_row(tmp_path):
    text = palletizer('<mimic joint="wheel_joint" multiplier="2"/>').replace(
        "</robot>", link("wheel") + joint("wheel_joint", "base_link", "wheel", kind="prismatic") + "</robot>"
    )
    result = yarc("robot", "new", written(tmp_path, text), "--yes", "-o", tmp_path / "r")
    said = " ".join(result.output.split())
    assert "level [deg] = 0.114591559026 * wheel_joint [mm] + 0 (multiplier 2, offset 0)" in said
    assert "wheel_joint isn't another joint of the chain" in said
    assert "row of J" not in said


@pytest.mark.parametrize(
    "mimic",
    ["<mimic/>", '<mimic joint="joint_3" multiplier="abc"/>', '<mimic joint="joint_3" offset="nan"/>',
        '<mimic joint="joint_3" offset=""/>'],
)  # fmt: skip
def test_a_mimic_that_is_none_is_named(mimic, tmp_path, capfd):
    result = yarc("robot", "new", written(tmp_path, palletizer(mimic)), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert re.search(r"Y134[25]", result.output)
    assert "mimic" in result.output
    assert capfd.readouterr() == ("", "")  # Pinocchio would print something
