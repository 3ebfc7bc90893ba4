"""Tests of `yarc robot new`: the chosen chain, the values, the marks for values to check, and the written
files.
"""

from __future__ import annotations

import contextlib
import os
import pty
import re
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import EXAMPLES

from tests.robot.made_arms import DATA, made, urdf_of, yarc
from yarclang.diagnostics import Diagnostic
from yarclang.report.solids import solid_of
from yarclang.robot.description import load_robot
from yarclang.robot.new.chains import ArmChain, find_chain
from yarclang.robot.new.writing import guesses
from yarclang.robot.urdf import read_urdf
from yarclang.robot.visuals import visual_shapes
from yarclang.source import SourceFile

SCARA = EXAMPLES / "scara.urdf"
BOX = "<link name='{0}'/>"


TRIANGLE = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"


def solid(name: str) -> str:
    """Return an STL with one triangle."""
    return f"solid {name}\n{TRIANGLE}endsolid {name}\n"


def tree(*joints: str, extra: str = "") -> str:
    """Return a URDF of joints `parent>child:type[:more]`. Links are created where they are named."""
    links: list[str] = []
    lines: list[str] = []
    for number, joint in enumerate(joints, 1):
        ends, kind, *more = joint.split(":")
        parent, child = ends.split(">")
        links += [link for link in (parent, child) if link not in links]
        name = f"{child}_joint" if not more or more[0].startswith("<") else more[0]
        inside = more[0] if more and more[0].startswith("<") else ""
        lines.append(
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}'
            f'<origin xyz="0 0.0{number} 0.1"/><limit lower="-1" upper="1" velocity="1" effort="1"/></joint>'
        )
    return (
        "<robot "
        f'name="t">{"".join(f"<link name={link!r}/>" for link in links)}{"".join(lines)}{extra}</robot>'
    )


def chain_of(text: str, base: str | None = None, tip: str | None = None) -> ArmChain | Diagnostic:
    urdf = read_urdf(SourceFile("t.urdf", text))
    assert urdf.sound, urdf.findings
    return find_chain(urdf, base, tip)


ARM = ("world>base_link:fixed", "base_link>a:revolute", "a>b:revolute", "b>c:revolute")


def found(text: str, **ends: str) -> ArmChain:
    chain = chain_of(text, **ends)
    assert isinstance(chain, ArmChain), chain
    return chain


def test_base_and_flange_by_their_names():
    chain = found(tree(*ARM, "c>tool0:fixed", "c>camera:fixed", "tool0>my_tcp:fixed"))
    assert (chain.base, chain.flange, chain.tcp) == ("base_link", "tool0", "my_tcp")
    assert chain.base_choices == ("world",)
    assert set(chain.flange_choices) == {"c", "camera", "my_tcp"}
    assert [joint.child for joint in chain.joints] == ["a", "b", "c"]


@pytest.mark.parametrize(
    "hand",
    [
        ("c>l:prismatic:left_finger", "c>r:prismatic:right_finger"),
        ("c>l:prismatic", "c>r:prismatic"),
        ("c>l:prismatic", 'c>r:prismatic:<mimic joint="l_joint"/>'),
        ("c>g:revolute:gripper",),
        ("c>t:revolute", "t>t2:revolute", "c>i:revolute", "i>i2:revolute", "c>m:revolute", "m>m2:revolute"),
    ],
)
def test_fingers_are_not_joints_of_the_arm(hand):
    chain = found(tree(*ARM, *hand))
    assert [joint.child for joint in chain.joints] == ["a", "b", "c"]
    assert len(chain.ignored) == len(hand)
    assert set(chain.fingers) == set(chain.ignored)


def test_two_arms_of_one_length_are_told():
    chain = found(tree(*ARM, "base_link>d:revolute", "d>e:revolute", "e>f:revolute"))
    assert chain.flange == "c"
    assert chain.other_tips == ("f",)
    other = found(tree(*ARM, "base_link>d:revolute", "d>e:revolute", "e>f:revolute"), tip="f")
    assert [joint.child for joint in other.joints] == ["d", "e", "f"]


def test_a_vehicle_below_is_left_out():
    chain = found(tree("odom>base_link:floating", *ARM[1:], "base_link>wheel:continuous"))
    assert chain.base == "base_link"
    assert set(chain.ignored) == {"base_link_joint", "wheel_joint"}


def test_base_and_tip_may_be_said():
    chain = found(tree(*ARM), base="a", tip="b")
    assert [joint.child for joint in chain.joints] == ["b"]
    assert set(chain.ignored) == {"a_joint", "c_joint"}


@pytest.mark.parametrize(
    ("ends", "code", "words"),
    [
        ({"base": "nope"}, "Y1347", "nope"),
        ({"tip": "bb"}, "Y1347", "bb"),
        ({"base": "c", "tip": "a"}, "Y1353", "Swap"),
        ({"base": "a", "tip": "a"}, "Y1353", "no chain"),
    ],
)
def test_ends_that_are_wrong(ends, code, words):
    finding = chain_of(tree(*ARM), **ends)
    assert isinstance(finding, Diagnostic)
    assert finding.code == code
    assert words in finding.message + finding.help


def test_nothing_that_moves():
    finding = chain_of(tree("a>b:fixed"))
    assert isinstance(finding, Diagnostic)
    assert finding.code == "Y1353"


def test_each_guess_has_a_mark_and_what_is_said_has_none(tmp_path):
    made(SCARA, tmp_path / "r")
    text = (tmp_path / "r" / "robot.toml").read_text()
    keys = {value.split(" = ")[0] for _, value, _ in guesses(text)}
    assert {"rise", "ease", "K", "J", "a0", "numbers", "velocity", "HOME", "xyz", "rpy"} <= keys
    assert "position" not in keys
    said = ("--acceleration", "500", "--jerk", "5000,6000,7000,8000", "--counts", "100,200,300,400")
    said += ("--tcp", "0,0,80", "--home", "10,20,30,40", "--motors", "4,3,2,1", "--title", 'a "b" \\ #c')
    said += ("--velocity", "90", "--position", "J3=10,150", "--name", "MINE")
    robot = made(SCARA, tmp_path / "s", *said)
    text = (tmp_path / "s" / "robot.toml").read_text()
    assert {value.split(" = ")[0] for _, value, _ in guesses(text)} == {"J", "a0", "velocity"}
    assert robot.name == "MINE"
    assert robot.title == 'a "b" \\ #c'
    assert robot.controller.motors == (4, 3, 2, 1)
    assert list(robot.home / robot.axis_units) == pytest.approx([10, 20, 30, 40])
    assert list(robot.limits.jerk / robot.axis_units) == pytest.approx([5000, 6000, 7000, 8000])
    assert list(robot.limits.lower / robot.axis_units)[2] == pytest.approx(10)
    assert list(robot.actuation.gear) == [100, 200, 300, 400]


def test_limits_that_a_urdf_does_not_have_are_guesses(tmp_path):
    text = urdf_of(
        [
            ("revolute", (0, 0, 0.3), (0, 0, 0), (0, 0, 1), (0, 0)),
            ("prismatic", (0, 0, 0.1), (0, 0, 0), (1, 0, 0), (0, 0)),
        ]
    )
    (tmp_path / "a.urdf").write_text(text.replace('velocity="1.5"', 'velocity="0"'))
    robot = made(tmp_path / "a.urdf", tmp_path / "r")
    assert list(robot.limits.upper / robot.axis_units) == pytest.approx([180, 100])
    assert list(robot.limits.velocity / robot.axis_units) == pytest.approx([60, 100])
    marked = [value.split(" = ")[0] for _, value, _ in guesses((tmp_path / "r" / "robot.toml").read_text())]
    assert marked.count("position") == 2
    assert marked.count("velocity") == 3


MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'


def test_collision_meshes_come_along_and_those_that_miss_are_told(tmp_path):
    for name in ("one", "two"):
        (tmp_path / "pack" / name).mkdir(parents=True)
        (tmp_path / "pack" / name / "part.stl").write_text(solid(name))
    text = SCARA.read_text()
    shapes = iter(
        [MESH.format("package://pack/one/part.stl"), MESH.format("two/part.stl"), MESH.format("gone.stl")]
    )
    text = re.sub(r"<collision>.*?</collision>", lambda old: next(shapes, old[0]), text)
    text = text.replace(
        '<link name="base_link"/>',
        '<link name="base_link"><visual><geometry><mesh filename="no.dae"/></geometry></visual></link>',
    )
    (tmp_path / "pack" / "arm.urdf").write_text(text)
    refused = yarc("robot", "new", tmp_path / "pack" / "arm.urdf", "--yes", "-o", tmp_path / "r")
    assert refused.exit_code == 1
    assert "Y1357" in refused.output
    assert "gone.stl of quill isn't there" in refused.output
    assert not (tmp_path / "r").exists()
    result = yarc(
        "robot",
        "new",
        tmp_path / "pack" / "arm.urdf",
        "--yes",
        "--allow-missing-meshes",
        "-o",
        tmp_path / "r",
    )
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in (tmp_path / "r" / "meshes").iterdir()) == ["part.stl", "part_2.stl"]
    assert (tmp_path / "r" / "meshes" / "part_2.stl").read_text() == solid("two")
    copy = (tmp_path / "r" / "arm.urdf").read_text()
    assert 'filename="meshes/part.stl"' in copy
    assert "gone.stl" not in copy
    assert "2 collision meshes copied" in result.output
    assert "the visual mesh no.dae isn't there" in result.output
    assert "Y1366" in result.output
    assert "1 collision mesh left out: gone.stl of quill" in result.output
    assert "Y1359" in result.output  # the quill has no collision shape left
    assert "Y1359" in yarc("robot", "check", tmp_path / "r").output
    program = tmp_path / "a.yarc"
    program.write_text(f'ROBOT "{tmp_path / "r"}"\nP0010 DMOVEJ 1 1 1 1 [5] (deg,mm,s)\n')
    assert "Y1359" not in yarc("check", program).output
    for command in ("settings", "plot"):
        assert (
            "Y1359"
            not in yarc(command, "--robot", tmp_path / "r", *([program] if command == "plot" else [])).output
        )


def with_visuals(folder: Path, *names: str) -> Path:
    """Write a URDF to a folder. Its first link has the given meshes as its visual shapes."""
    folder.mkdir(parents=True, exist_ok=True)
    bodies = "".join(f'<visual><geometry><mesh filename="{one}"/></geometry></visual>' for one in names)
    text = SCARA.read_text().replace('<link name="base_link"/>', f'<link name="base_link">{bodies}</link>')
    (folder / "arm.urdf").write_text(text)
    return folder / "arm.urdf"


def test_what_the_links_look_like_comes_along(tmp_path):
    """Visual meshes are copied to a folder of their own, so the robot can be drawn without the original
    files.
    """
    urdf = with_visuals(tmp_path / "pack", "a/cover.stl", "b/cover.stl", "a/cover.stl")
    for name in "ab":
        (tmp_path / "pack" / name).mkdir()
        (tmp_path / "pack" / name / "cover.stl").write_text(solid(name))
    result = yarc("robot", "new", urdf, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "2 visual meshes copied" in result.output
    shutil.rmtree(tmp_path / "pack")
    robot = load_robot(str(tmp_path / "r")).value
    found = [one.shape.path for one in visual_shapes(robot) if one.link == "base_link"]
    folder = tmp_path / "r" / "meshes" / "visual"
    assert found == [folder / "cover.stl", folder / "cover_2.stl", folder / "cover.stl"]
    assert all(solid_of(one.shape) is not None for one in visual_shapes(robot))


def test_a_visual_mesh_that_cant_be_copied_stops_nothing(tmp_path):
    """Visual meshes that are files of other users, no meshes, pipes or huge are left out, each with
    a reason.
    """
    names = ("/etc/passwd", "../../../../../../etc/passwd", "text.stl", "pipe.stl", "huge.stl", "gone.dae")
    urdf = with_visuals(tmp_path / "pack", *names)
    (tmp_path / "pack" / "text.stl").write_text("root:x:0:0:root:/root:/bin/bash")
    os.mkfifo(tmp_path / "pack" / "pipe.stl")
    with (tmp_path / "pack" / "huge.stl").open("wb") as file:
        file.truncate(10**11)
    result = yarc("robot", "new", urdf, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert not (tmp_path / "r" / "meshes").exists()
    for what in (
        "/etc/passwd is outside the URDF's package",
        "text.stl ends in .stl, but its content has another format",
        "pipe.stl i",
        "huge.stl has more than 20,000,000 bytes",
        "gone.dae isn't there",
    ):
        assert what in result.output


def with_mesh(folder: Path, *names: str) -> Path:
    """Write a URDF with collision meshes of these names to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    shapes = iter(MESH.format(name) for name in names)
    text = re.sub(r"<collision>.*?</collision>", lambda old: next(shapes, old[0]), SCARA.read_text())
    (folder / "arm.urdf").write_text(text)
    return folder / "arm.urdf"


def refused(urdf: Path, code: str, *words: str, options: tuple[str, ...] = ()) -> str:
    """Check that `yarc robot new` writes nothing and reports an error at the mesh. Return its output."""
    out = urdf.parent / "made"
    result = yarc("robot", "new", urdf, "--yes", "-o", out, *options)
    assert result.exit_code == 1, result.output
    assert f"arm.urdf:{line_of(urdf)}:" in result.output
    assert f"error {code}" in result.output
    for word in words:
        assert word in result.output
    assert not out.exists()
    return result.output


def line_of(urdf: Path) -> int:
    return next(number for number, line in enumerate(urdf.read_text().splitlines(), 1) if "<mesh" in line)


@pytest.mark.parametrize(
    "name",
    ["/etc/passwd", "file:///etc/passwd", "../../../../../../../../etc/passwd", "package://etc/passwd"],
)
@pytest.mark.parametrize("options", [(), ("--meshes", "/etc"), ("--meshes", "/")])
def test_a_file_that_is_no_mesh_is_not_copied(name, options, tmp_path):
    """A file that isn't a mesh, such as /etc/passwd, isn't copied into the robot's folder."""
    urdf = with_mesh(tmp_path / "a", name)
    refused(urdf, "Y1363" if options else "Y1364", "The mesh ", "etc/passwd ", options=options)


@pytest.mark.parametrize("kind", [".stl", ".obj", ".dae", ".ply", ".STL"])
def test_another_files_content_by_a_meshs_name_is_not_copied(kind, tmp_path):
    urdf = with_mesh(tmp_path, f"part{kind}")
    (tmp_path / f"part{kind}").write_text("root:x:0:0:root:/root:/bin/bash\n")
    refused(urdf, "Y1363", f"The mesh part{kind} ends in {kind}, but its content has another format.")
    (tmp_path / f"part{kind}").unlink()
    (tmp_path / f"part{kind}").symlink_to("/etc/passwd")
    refused(urdf, "Y1364", "is outside the URDF's package and isn't copied", "--meshes /etc")
    refused(urdf, "Y1363", "its content has another format", options=("--meshes", "/etc"))


def test_a_mesh_elsewhere_is_copied_only_if_its_folder_is_named(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "part.stl").write_text(solid("mine"))
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "link.stl").symlink_to(tmp_path / "mine" / "part.stl")
    for name in ("../mine/part.stl", str(tmp_path / "mine/part.stl"), "link.stl", "package://mine/part.stl"):
        urdf = with_mesh(tmp_path / "a", name)
        refused(urdf, "Y1364", f"--meshes {tmp_path / 'mine'}")
        out = tmp_path / name.replace("/", "_")
        result = yarc("robot", "new", urdf, "--yes", "-o", out, "--meshes", tmp_path / "mine")
        assert result.exit_code == 0, result.output
        assert [path.read_text() for path in (out / "meshes").iterdir()] == [solid("mine")]


@pytest.mark.parametrize(
    ("urdf", "package", "mesh", "name"),
    [
        ("arm", "", "arm/meshes", "meshes/part.stl"),
        ("arm/urdf", "", "arm/meshes", "../meshes/part.stl"),
        ("arm/urdf", "", "arm/meshes", "package://arm/meshes/part.stl"),
        ("arm/deep/down/here", "arm", "arm/meshes", "package://arm/meshes/part.stl"),
        ("arm/deep/down/here", "arm", "arm/meshes", "../../../meshes/part.stl"),
        ("share/arm/urdf", "share/other", "share/other/meshes", "package://other/meshes/part.stl"),
    ],
)
def test_the_meshes_of_a_package_come_along(urdf, package, mesh, name, tmp_path):
    path = with_mesh(tmp_path / urdf, name)
    (tmp_path / mesh).mkdir(parents=True)
    (tmp_path / mesh / "part.stl").write_text(solid("one"))
    if package:
        (tmp_path / package).mkdir(parents=True, exist_ok=True)
        (tmp_path / package / "package.xml").write_text("<package/>")
    result = yarc("robot", "new", path, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "r" / "meshes" / "part.stl").read_text() == solid("one")


def test_a_package_whose_files_are_all_links_is_its_own(tmp_path):
    """The package may consist of links only, as after `colcon build --symlink-install`."""
    source, installed = tmp_path / "src" / "arm", tmp_path / "install" / "share" / "arm"
    with_mesh(source / "urdf", "package://arm/meshes/part.stl")
    (source / "meshes").mkdir()
    (source / "meshes" / "part.stl").write_text(solid("one"))
    (source / "package.xml").write_text("<package/>")
    for name in ("urdf/arm.urdf", "meshes/part.stl", "package.xml"):
        (installed / name).parent.mkdir(parents=True, exist_ok=True)
        (installed / name).symlink_to(source / name)
    result = yarc("robot", "new", installed / "urdf" / "arm.urdf", "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "r" / "meshes" / "part.stl").read_text() == solid("one")


def test_a_package_named_by_a_way_out_is_none(tmp_path):
    (tmp_path / "share" / "other").mkdir(parents=True)
    (tmp_path / "share" / "other" / "package.xml").write_text("<package/>")
    (tmp_path / "share" / "mine.stl").write_text(solid("mine"))
    refused(with_mesh(tmp_path / "share/arm/urdf", "package://other/../mine.stl"), "Y1364")
    refused(with_mesh(tmp_path / "share/arm/urdf", "package://../share/mine.stl"), "Y1364")


@pytest.mark.parametrize("kind", ["pipe", "device", "socket", "folder"])
def test_what_is_no_ordinary_file_keeps_nobody_waiting(kind, tmp_path):
    path = tmp_path / "part.stl"
    urdf = with_mesh(tmp_path, "part.stl")
    match kind:
        case "pipe":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "socket":
            with socket.socket(socket.AF_UNIX) as wire, contextlib.chdir(tmp_path):
                wire.bind(path.name)
        case "folder":
            path.mkdir()
    options = ("--meshes", "/dev") if kind == "device" else ()
    refused(urdf, "Y1363", "The mesh part.stl isn't a regular file.", options=options)


def test_a_mesh_that_is_too_large_is_not_read(tmp_path):
    urdf = with_mesh(tmp_path, "part.stl")
    with (tmp_path / "part.stl").open("wb") as file:
        file.truncate(10**11)
    refused(urdf, "Y1363", "The mesh part.stl has 100,000,000,000 bytes, more than 100,000,000.")


def test_meshes_that_are_too_large_together_are_not_copied(tmp_path, monkeypatch):
    monkeypatch.setattr("yarclang.robot.new.copying.LARGEST_TOGETHER", 15)
    for name in ("a", "b"):
        (tmp_path / f"{name}.stl").write_text(solid("one"))
    urdf = with_mesh(tmp_path, "a.stl", "a.stl", "b.stl")
    result = yarc("robot", "new", urdf, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert "With the mesh b.stl, the meshes have more than 15 bytes together." in result.output
    assert not (tmp_path / "r").exists()


def test_no_name_leads_out_of_the_new_folder(tmp_path):
    (tmp_path / "a" / "..." / "b").mkdir(parents=True)
    for name in ("..stl", ".../b/..obj.stl", "%2e%2e%2fout.stl", "-rf.stl", "~.stl"):
        (tmp_path / "a" / name).write_text(solid("one"))
        urdf = with_mesh(tmp_path / "a", name)
        out = tmp_path / "made" / name.replace("/", "_")
        result = yarc("robot", "new", urdf, "--yes", "-o", out)
        assert result.exit_code == 0, result.output
        assert {path.name for path in out.iterdir()} == {"arm.urdf", "meshes", "robot.toml"}
        assert len(list((out / "meshes").iterdir())) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"a", "made"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--jerk", "1,2"), "give 1, or 4"),
        (("--home", "1"), "give 4"),
        (("--tcp", "1,2"), "x,y,z"),
        (("--counts", "0"), "--counts has a 0"),
        (("--motors", "1,2,3,4.5"), "integers"),
        (("--position", "J9=1,2"), "the joints are J1"),
        (("--position", "J1=2,1"), "isn't below"),
        (("--position", "J1=a"), "isn't JOINT=LOW,HIGH"),
        (("--velocity", "-1"), "positive"),
    ],
)
def test_wrong_usage(arguments, words, tmp_path):
    result = yarc("robot", "new", SCARA, "--yes", "-o", tmp_path / "r", *arguments)
    assert result.exit_code == 2
    assert words in result.output
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("--name", "my robot"), "Y1310"),
        (("--home", "0,0,999,0"), "Y1317"),
        (("--motors", "1,1,2,3"), "Y132"),
    ],
)
def test_what_makes_no_robot_leaves_no_folder(arguments, code, tmp_path):
    result = yarc("robot", "new", SCARA, "--yes", "-o", tmp_path / "r", *arguments)
    assert result.exit_code == 1
    assert code in result.output
    assert not (tmp_path / "r").exists()


def test_without_a_terminal_nothing_is_guessed_in_silence(tmp_path):
    result = yarc("robot", "new", SCARA, "-o", tmp_path / "r")
    assert result.exit_code == 2
    assert "--acceleration" in result.output
    assert "--yes" in result.output
    assert not (tmp_path / "r").exists()


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "r").mkdir()
    (tmp_path / "r" / "mine").write_text("")
    result = yarc("robot", "new", SCARA, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 2
    assert "isn't empty" in result.output
    assert [path.name for path in (tmp_path / "r").iterdir()] == ["mine"]


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (None, "Y1302"),
        (b"\xff\xfe", "Y1302"),
        (b"", "Y1340"),
        (b"<robot", "Y1340"),
        (b"<a/>", "Y1341"),
        (b"\0" * 9, "Y1340"),
    ],
)
def test_a_file_that_is_no_urdf(content, code, tmp_path):
    if content is not None:
        (tmp_path / "a.urdf").write_bytes(content)
    result = yarc("robot", "new", tmp_path / "a.urdf", "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 1
    assert code in result.output
    assert "Traceback" not in result.output
    assert not (tmp_path / "r").exists()


def test_it_asks_on_a_terminal(tmp_path):
    ours, theirs = pty.openpty()
    command = [str(Path(sys.executable).with_name("yarc")), "robot", "new", str(SCARA), "-o", "r"]
    running = subprocess.Popen(command, cwd=tmp_path, stdin=theirs, stdout=theirs, stderr=theirs)
    os.close(theirs)
    # The answers: name, accelerations (first with a wrong number of values), jerks, counts, tool, HOME.
    os.write(ours, b"PICKER\n1,2\n900\n\n5000\n0,0,60\n\n")
    shown = b""
    until = time.monotonic() + 20
    while time.monotonic() < until:
        try:
            part = os.read(ours, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    assert running.wait(10) == 0, shown
    assert b"give 1, or 4" in shown
    text = (tmp_path / "r" / "robot.toml").read_text()
    assert 'name = "PICKER"' in text
    assert "acceleration = 900\n" in text
    assert "xyz = [0, 0, 60]" in text
    marked = {value.split(" = ")[0] for _, value, _ in guesses(text)}
    assert {"ease", "HOME"} <= marked
    assert not {"acceleration", "K", "xyz"} & marked


def test_the_gripper_of_a_real_arm_is_told():
    chain = found((DATA / "panda_description/urdf/panda.urdf").read_text())
    assert chain.fingers == ("panda_finger_joint1", "panda_finger_joint2")
    assert (chain.base, chain.flange, chain.tcp) == ("panda_link0", "panda_link8", "panda_hand_tcp")
