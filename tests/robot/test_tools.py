"""Tests of tools in robot.toml: shapes and masses on the flange, mistakes, and that the collision check gets
all of their shapes.
"""

import re

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import EXAMPLES
from programs import codes, compiled

from tests.collision.test_bodies import POST, changed, cube, with_cell
from yarclang.cli.yarc import main
from yarclang.collision.scene import scene_of
from yarclang.robot.description import load_robot
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from yarclang.units import MM

GRIPPER = """
[tools.Gripper]
frame = "TCP"
mass = 2.5
center_of_mass = [0, 10, 0]
inertia = [0.02, 0.01, 0.015, 0, 0.001, 0]

[[bodies]]
tool = "GRIPPER"
shape = "capsule"
xyz = [0, 20, 0]
rpy = [90, 0, 0]
radius = 10
length = 60
"""
SHAPES = """
[tools.T]
[[bodies]]
tool = "T"
shape = "box"
size = [10, 20, 30]
[[bodies]]
tool = "T"
shape = "sphere"
radius = 5
[[bodies]]
tool = "T"
shape = "cylinder"
radius = 5
length = 7
[[bodies]]
tool = "T"
shape = "mesh"
file = "t.stl"
"""


def with_tools(tmp_path, text):
    folder = changed(tmp_path, ("[tolerance]", f"{text}\n[tolerance]"))
    (tmp_path / "arm" / "t.stl").write_bytes(cube(100.0))
    return folder


def test_a_tool_is_where_it_is_said_to_be(tmp_path):
    (tool,) = load_robot(with_tools(tmp_path, GRIPPER)).value.tools
    assert (tool.name, tool.mounted, tool.mass) == ("GRIPPER", True, 2.5)
    assert tool.center == pytest.approx([0, 0.11, 0])  # TCP is 100 mm along y
    assert tool.inertia == pytest.approx(np.array([[0.02, 0, 0.001], [0, 0.01, 0], [0.001, 0, 0.015]]))
    (body,) = tool.shapes
    assert body.shape == Capsule(0.01, 0.06)
    assert body.flange_from_shape[:3, 3] == pytest.approx([0, 0.12, 0])
    assert body.flange_from_shape[:3, 2] == pytest.approx([0, -1, 0], abs=1e-12)


def test_all_shapes(tmp_path):
    folder = with_tools(tmp_path, SHAPES)
    (tool,) = load_robot(folder).value.tools
    box, sphere, cylinder, mesh = (one.shape for one in tool.shapes)
    assert isinstance(box, Box)
    assert box.size == pytest.approx([0.01, 0.02, 0.03])
    assert (sphere, cylinder) == (Sphere(0.005), Cylinder(0.005, 0.007))
    assert isinstance(mesh, Mesh)
    assert mesh.unit == MM
    scene = scene_of(load_robot(folder).value, None).value
    assert [one.name for one in scene.bodies if not one.is_link] == ["T"] * 4
    assert scene.bodies[-1].geometry.half == pytest.approx([0.1] * 3, abs=1e-6)


def test_a_tool_is_a_part_of_what_the_robot_is(tmp_path):
    plain = load_robot("INDUSTRIAL6").value.fingerprint
    prints = {load_robot(with_tools(tmp_path, SHAPES)).value.fingerprint}
    (tmp_path / "arm" / "t.stl").write_bytes(cube(90.0))
    prints.add(load_robot(str(tmp_path / "arm")).value.fingerprint)
    changed(tmp_path, ("length = 7", "length = 8"))
    prints.add(load_robot(str(tmp_path / "arm")).value.fingerprint)
    assert len(prints | {plain}) == 4


def test_a_tool_hits_if_it_is_mounted(tmp_path):
    program = "P0010 MOVEJ 100 0 0 0 0 0"
    post = POST.replace("[-600, 800, 1200]", "[-1200, 0, 1200]")
    assert codes(with_cell(tmp_path, post, program)[1]) == []
    folder = with_tools(tmp_path, GRIPPER)
    (finding,) = with_cell(tmp_path, post, program, folder)[1]
    assert finding.code == "Y0901"
    assert finding.message.startswith("GRIPPER penetrates")
    changed(tmp_path, ("[tools.Gripper]", "[tools.Gripper]\nmounted = false"))
    assert codes(with_cell(tmp_path, post, program, folder)[1]) == []


def test_a_tool_hits_the_arm_unless_that_is_allowed(tmp_path):
    """A long bar across the flange touches the links behind it, which is an error unless robot.toml allows
    it.
    """
    bar = (
        "[tools.BAR]\n"
        "[[bodies]]\n"
        'tool = "BAR"\n'
        'shape = "capsule"\n'
        "xyz = [0, -150, 0]\n"
        "rpy = [90, 0, 0]\n"
        "radius = 5\n"
        "length = 300\n"
    )
    folder = with_tools(tmp_path, bar)
    program = "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)"
    (finding,) = compiled(program, folder)[1]
    assert finding.code == "Y0902"
    assert "BAR penetrates" in finding.message
    told = CliRunner().invoke(main, ["robot", "check", folder])
    assert told.exit_code == 1
    assert '["BAR", "link_5"]' in told.output
    pairs = '[collision]\nallowed = [["link_5", "bar"], ["BAR", "link_4"], ["BAR", "link_3"]]\n\n[tolerance]'
    changed(tmp_path, ("[tolerance]", pairs))
    assert codes(compiled(program, folder)[1]) == []


def test_an_obstacle_with_the_name_of_a_tool_is_no_tool(tmp_path):
    """Pairs that robot.toml allows concern only the robot's own bodies, not a body of the cell with the same
    name.
    """
    pairs = '[collision]\nallowed = [["link_5", "Gripper"], ["link_6", "Gripper"]]\n' + GRIPPER
    folder = with_tools(tmp_path, pairs)
    post = POST.replace("POST", "GRIPPER").replace("[-600, 800, 1200]", "[-530, 920, 1200]")
    (finding,) = with_cell(tmp_path, post, "P0010 MOVEJ 80 0 0 0 0 0", folder)[1]
    assert finding.code == "Y0901"


@pytest.mark.parametrize(
    ("before", "after", "code", "word"),
    [
        ("mass = 2.5", "mass = -1", "Y1308", "mass"),
        ("mass = 2.5", "mas = 2.5", "Y1305", "Did you mean mass"),
        ("mass = 2.5\n", "", "Y1304", "no mass"),
        ("[0, 10, 0]", "[0, 10]", "Y1309", "center_of_mass"),
        ("[0.02, 0.01, 0.015, 0, 0.001, 0]", "[0.02, 0.01]", "Y1309", "inertia"),
        (
            "[0.02, 0.01, 0.015, 0, 0.001, 0]",
            "[0.02, 0.001, 0.01, 0, 0, 0]",
            "Y0932",
            "impossible for a body",
        ),
        ('"TCP"', '"TCPP"', "Y1329", "TCPP"),
        ("[tools.Gripper]", "[tools.9GRIPPER]", "Y1310", "9GRIPPER"),
        ('tool = "GRIPPER"', 'tool = "GRIPER"', "Y0931", "Did you mean GRIPPER"),
        ('tool = "GRIPPER"\n', "", "Y1304", "lacks tool"),
        ('"capsule"', '"tube"', "Y1308", "tube"),
        ("length = 60\n", "", "Y1304", "length, which a capsule needs"),
        ("length = 60", "length = 60\nsize = [1, 2, 3]", "Y1305", "which a capsule doesn't take"),
        ("radius = 10", "radius = 0", "Y1308", "radius"),
        ("[0, 20, 0]", "[0, 20]", "Y1309", "xyz"),
        ('"capsule"', '"mesh"\nfile = "none.stl"', "Y1305", "doesn't take"),
    ],
)
def test_mistakes(tmp_path, before, after, code, word):
    assert before in GRIPPER
    found = load_robot(with_tools(tmp_path, GRIPPER.replace(before, after)))
    assert found.value is None
    assert code in codes(found.diagnostics)
    one = next(one for one in found.diagnostics if one.code == code)
    assert word in one.message + one.help
    assert one.span is not None


@pytest.mark.parametrize(
    ("name", "content", "code"), [("t.txt", b"", "Y1308"), ("u.stl", None, "Y1357"), ("t.stl", b"", "Y1357")]
)
def test_a_mesh_that_is_lost(tmp_path, name, content, code):
    folder = with_tools(tmp_path, SHAPES.replace("t.stl", name))
    if content is not None:
        (tmp_path / "arm" / name).write_bytes(content)
    assert codes(load_robot(folder).diagnostics) == [code]


def test_a_broken_mesh_stops_the_compiler(tmp_path):
    folder = with_tools(tmp_path, SHAPES)
    (tmp_path / "arm" / "t.stl").write_bytes(b"hello")
    made, (finding,) = compiled("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)", folder)
    assert (made, finding.code) == (None, "Y0904")
    assert "t.stl of T" in finding.message


def test_the_checklist_tells_tools(tmp_path):
    text = GRIPPER + "\n[tools.SPARE]\nmounted = false\n[tools.HEAVY]\nmass = 4\n"
    told = CliRunner().invoke(main, ["robot", "check", with_tools(tmp_path, text)]).output
    assert "GRIPPER: 1 shape, 2.5 kg" in told
    assert "SPARE isn't mounted" in told
    assert "HEAVY has no shape, 4 kg" in told
    shown = CliRunner().invoke(main, ["robot", "list", str(tmp_path / "arm")]).output
    assert "tool GRIPPER: 1 shape, 2.5 kg\ntool SPARE: 0 shapes, not mounted\n" in shown


def test_a_new_robot_shows_how_a_tool_is_written(tmp_path):
    """The example at the end of a new robot.toml becomes a valid tool when its comment marks are removed."""
    folder = tmp_path / "scara"
    made = CliRunner().invoke(
        main, ["robot", "new", str(EXAMPLES / "scara.urdf"), "--yes", "-o", str(folder)]
    )
    assert made.exit_code == 0, made.output
    text = (folder / "robot.toml").read_text()
    assert load_robot(str(folder)).value.tools == ()
    at = text.index("# [tools.GRIPPER]")
    (folder / "robot.toml").write_text(text[:at] + re.sub("^# ", "", text[at:], flags=re.MULTILINE))
    (tool,) = load_robot(str(folder)).value.tools
    assert (tool.mass, len(tool.shapes)) == (1.8, 1)
