"""Tests of the bodies of a robot and a cell, of findings about missing ones, and of the compiler's findings
about collisions.
"""

import json
import re
import shutil
import struct
from itertools import product

import numpy as np
import pytest
from click.testing import CliRunner
from programs import codes, compiled

from yarclang.cli.table import certificate_table
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.collision.geometry import encloses, geometry_of
from yarclang.collision.placing import Relative, distances
from yarclang.collision.scene import scene_of
from yarclang.findings import CATALOGUE
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot, stdlib_folder
from yarclang.shapes import Mesh

HEAD = 'CELL "cell.toml"\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\n'
UNITS = 'units = "mm,deg,s"\n'
POST = UNITS + (
    '[[obstacles]]\nname = "POST"\nshape = "box"\nframe = "B"\nxyz = [-600, 800, 1200]\nsize = [5, 5, 2400]\n'
)


def cube(half, center=(0.0, 0.0, 0.0)):
    """Return a binary STL of a cube."""
    corners = np.array(list(product([-half, half], repeat=3))) + center
    faces = ["013", "032", "467", "475", "045", "051", "237", "276", "026", "064", "157", "173"]
    body = b"".join(
        struct.pack("<3f", 0, 0, 0) + corners[[int(at) for at in face]].astype("<f4").tobytes() + b"\0\0"
        for face in faces
    )
    return b"\0" * 80 + struct.pack("<I", len(faces)) + body


def with_cell(tmp_path, cell, program, robot="INDUSTRIAL6"):
    (tmp_path / "cell.toml").write_text(cell)
    return compiled(HEAD + program, robot, load_cell=cell_loader(tmp_path, load_robot(robot).value))


def changed(tmp_path, *changes, file="robot.toml"):
    folder = tmp_path / "arm"
    if not folder.exists():
        shutil.copytree(stdlib_folder() / "robots" / "industrial6", folder)
    text = (folder / file).read_text()
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    (folder / file).write_text(text)
    return str(folder)


def test_an_obstacle_is_hit(tmp_path):
    value, (finding,) = with_cell(tmp_path, POST, "P0010 MOVEJ 80 0 0 0 0 0")
    assert value is None
    assert finding.code == "Y0901"
    assert re.match(
        r"link_\d penetrates POST by [\d.]+ mm, from [\d.]+ s to [\d.]+ s .* \(\d+ % to \d+ %\)",
        finding.message,
    )
    assert "{TCP} at " in finding.message
    assert "with the joints at 3" in finding.message
    assert finding.help


def test_the_margin_counts(tmp_path):
    # The edge of link_6 is 1.0751 m from the first axis, and the post begins beyond it.
    post = POST.replace("[-600, 800, 1200]", "[-1100, 0, 1200]")
    program = "P0010 MOVEJ 100 0 0 0 0 0"
    value, found = with_cell(tmp_path, post, program)
    assert codes(found) == []
    (command,) = value.certificate.commands
    assert command.clearance.second == "POST"
    assert 0.019 < command.clearance.distance < 0.0224
    assert command.own_clearance.distance == pytest.approx(0.1)
    (finding,) = with_cell(tmp_path, post + "margin = 30\n", program)[1]
    assert finding.code == "Y0903"
    assert "comes within 22.4 mm of POST, whose margin is 30 mm" in finding.message


def angle_iron():
    """Return a binary STL of a floor with a wall beside it, 800 mm wide."""
    corners = np.array(
        [[-400, -400, 0], [400, -400, 0], [400, 400, 0], [-400, 400, 0], [400, -400, 900], [400, 400, 900]]
    )
    faces = ["012", "023", "154", "125"]
    body = b"".join(
        struct.pack("<3f", 0, 0, 0) + corners[[int(at) for at in face]].astype("<f4").tobytes() + b"\0\0"
        for face in faces
    )
    return b"\0" * 80 + struct.pack("<I", len(faces)) + body


@pytest.mark.parametrize(
    ("gap", "found"), [(0.05, ["Y0930"]), (0.5, []), (-1.0, ["Y0903"]), (-11.0, ["Y0901"])]
)
def test_what_grazes_a_hollow_mesh_is_not_proved(tmp_path, gap, found):
    """The lowest link over the floor is link_5, whose surface is 50 mm below the arm's axis."""
    (tmp_path / "iron.stl").write_bytes(angle_iron())
    cell = UNITS + (
        '[[obstacles]]\nname = "IRON"\nshape = "mesh"\nframe = "B"\nfile = "iron.stl"\nmargin = 10\n'
        f"xyz = [0, 1250, {1764 - 50 - 10 - gap}]\n"
    )
    seen = with_cell(tmp_path, cell, "P0010 MOVEJ 2 0 0 0 0 0")[1]
    assert codes(seen) == found
    if found == ["Y0930"]:
        assert "comes within 10.05 mm of IRON, whose margin is 10 mm" in seen[0].message


def test_the_catalogue_shows_it(tmp_path):
    post = POST.replace("[-600, 800, 1200]", "[-500, 866, 1200]")
    hits, itself = CATALOGUE["Y0901"], CATALOGUE["Y0902"]
    assert codes(with_cell(tmp_path, post, hits.example)[1]) == ["Y0901"]
    assert codes(with_cell(tmp_path, post, hits.better)[1]) == []
    assert codes(compiled(itself.example)[1]) == ["Y0902"]
    assert codes(compiled(itself.better)[1]) == []


def test_repeated_collisions_are_one_finding(tmp_path):
    program = "REPEAT 3\nP0010 MOVEJ 80 0 0 0 0 0\nP0020 MOVEJ 0 0 0 0 0 0\nEND"
    found = with_cell(tmp_path, POST, program)[1]
    assert codes(found) == ["Y0901", "Y0901"]
    assert all("and 2 more times" in one.message for one in found)


def test_a_tool_hits_where_the_arm_alone_does_not(tmp_path):
    program = "P0010 MOVEJ 100 0 0 0 0 0"
    post = POST.replace("[-600, 800, 1200]", "[-1150, 0, 1200]")
    assert codes(with_cell(tmp_path, post, program)[1]) == []
    tool = (
        "[[obstacles]]\n"
        'name = "NOZZLE"\n'
        'shape = "cylinder"\n'
        'frame = "FLANGE"\n'
        "xyz = [0, 60, 0]\n"
        "rpy = [90, 0, 0]\n"
        "radius = 5\n"
        "length = 100\n"
    )
    (finding,) = with_cell(tmp_path, post + tool, program)[1]
    assert "NOZZLE penetrates" in finding.message


def test_the_robot_hits_itself():
    value, (finding,) = compiled("P0010 MOVEJ 0 0 -160 0 0 0 [20] (deg,s)")
    assert (value, finding.code) == (None, "Y0902")
    assert "link_" in finding.message


@pytest.mark.parametrize("content", [b"hello", b"\0" * 84, cube(100.0)[:300]])
def test_a_broken_mesh_stops_the_compiler(tmp_path, content):
    (tmp_path / "press.stl").write_bytes(content)
    cell = UNITS + '[[obstacles]]\nname = "PRESS"\nshape = "mesh"\nframe = "B"\nfile = "press.stl"\n'
    value, found = with_cell(tmp_path, cell, "P0010 MOVEJ 10 0 0 0 0 0")
    assert (value, codes(found)) == (None, ["Y0904"])
    assert "press.stl of PRESS" in found[0].message


def test_a_mesh_is_solid_inside(tmp_path):
    """A link that is completely inside of a closed mesh touches none of its triangles, but collides."""
    (tmp_path / "hall.stl").write_bytes(cube(3000.0))
    cell = UNITS + '[[obstacles]]\nname = "HALL"\nshape = "mesh"\nframe = "B"\nfile = "hall.stl"\n'
    assert codes(with_cell(tmp_path, cell, "P0010 MOVEJ 10 0 0 0 0 0")[1]) == ["Y0901"]
    # Without its lid, the mesh is a room in which the robot can work.
    whole = cube(3000.0)
    (tmp_path / "hall.stl").write_bytes(whole[:80] + struct.pack("<I", 10) + whole[84 : 84 + 500])
    assert codes(with_cell(tmp_path, cell, "P0010 MOVEJ 10 0 0 0 0 0")[1]) == []


def test_inside_and_outside(tmp_path):
    (tmp_path / "cube.stl").write_bytes(cube(100.0))
    skin = geometry_of(Mesh(tmp_path / "cube.stl", 0.001, "")).skin
    points = np.random.default_rng(0).uniform(-0.2, 0.2, (300, 3))
    assert [encloses(skin, one) for one in points] == (np.abs(points).max(axis=1) < 0.1).tolist()


def test_a_mesh_of_a_link_counts_as_its_hull(tmp_path):
    box = '<geometry><box size="0.3 0.4 0.5"/></geometry>\n    </collision>'
    folder = changed(
        tmp_path,
        (box, '<geometry><mesh filename="l.stl" scale="0.001 0.001 -0.002"/></geometry>\n    </collision>'),
        file="industrial6.urdf",
    )
    (tmp_path / "arm" / "l.stl").write_bytes(cube(100.0, (0.0, 0.0, 50.0)))
    (body,) = [one for one in scene_of(load_robot(folder).value, None).value.bodies if one.name == "link_1"]
    assert body.geometry.half == pytest.approx([0.1, 0.1, 0.2], abs=1e-6)
    assert body.geometry.middle == pytest.approx([0, 0, -0.1], abs=1e-6)
    (tmp_path / "arm" / "l.stl").write_bytes(b"hello")
    made, (finding,) = compiled("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)", folder)
    assert (made, finding.code) == (None, "Y0904")


def test_allowed_pairs(tmp_path):
    program = "P0010 MOVEJ 0 0 -160 0 0 0 [20] (deg,s)"
    message = compiled(program)[1][0].message
    pairs = {tuple(sorted(pair)) for pair in re.findall(r"(link_\d) (?:and|penetrates) (link_\d)", message)}
    assert len(pairs) > 1
    listed = ", ".join(f'["{one}", "{other}"]' for one, other in sorted(pairs)[1:])
    folder = changed(
        tmp_path, ("[tolerance]", f'[collision]\nallowed = [{listed}]\nsrdf = "arm.srdf"\n\n[tolerance]')
    )
    first = sorted(pairs)[0]
    (tmp_path / "arm" / "arm.srdf").write_text(
        f'<robot name="a"><disable_collisions link1="{first[1]}" link2="{first[0]}" reason="Never"/></robot>'
    )
    assert load_robot(folder).value.allowed == pairs
    assert load_robot(folder).value.fingerprint != load_robot("INDUSTRIAL6").value.fingerprint
    assert codes(compiled(program, folder)[1]) == []


@pytest.mark.parametrize(
    ("table", "srdf", "code", "word"),
    [
        ('allowed = [["link_2", "link_9"]]', "", "Y1347", "link_9"),
        ('allowed = [["link_2"]]', "", "Y1309", "link_2"),
        ('allowed = [["link_2", "link_2"]]', "", "Y1309", "link_2"),
        ("allowed = [2]", "", "Y1306", "allowed"),
        ('srdf = "none.srdf"', "", "Y1302", "none.srdf"),
        ('srdf = "a.srdf"', "<robot", "Y1340", "XML"),
        ('srdf = "a.srdf"', '<r><disable_collisions link1="link_2" link2="hand"/></r>', "Y1347", "hand"),
        ('srdf = "a.srdf"', '<r><disable_collisions link1="link_2"/></r>', "Y1342", "link2"),
    ],
)
def test_pairs_that_name_no_links(tmp_path, table, srdf, code, word):
    folder = changed(tmp_path, ("[tolerance]", f"[collision]\n{table}\n\n[tolerance]"))
    (tmp_path / "arm" / "a.srdf").write_text(srdf)
    found = load_robot(folder)
    assert found.value is None
    assert codes(found.diagnostics) == [code]
    assert word in found.diagnostics[0].message


def test_links_that_always_touch(tmp_path):
    """Links with too large shapes touch in HOME. They aren't checked; the checklist says so, and what to
    write.
    """
    folder = changed(
        tmp_path,
        ('<capsule radius="0.05" length="0.16"/>', '<capsule radius="0.05" length="0.6"/>'),
        file="industrial6.urdf",
    )
    scene = scene_of(load_robot(folder).value, None).value
    assert scene.at_home == {("link_5", "link_3")}
    assert codes(compiled("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)", folder)[1]) == []
    told = CliRunner().invoke(main, ["robot", "check", folder])
    assert told.exit_code == 1
    assert 'allowed = [["link_5", "link_3"]' in told.output
    changed(tmp_path, ("[tolerance]", '[collision]\nallowed = [["link_3", "link_5"]]\n\n[tolerance]'))
    again = CliRunner().invoke(main, ["robot", "check", folder])
    assert again.exit_code == 0, again.output


def test_a_new_robot_lets_touch_what_always_does(tmp_path):
    """For a new robot, pairs that touch in all joint positions are allowed to touch, with a mark. Pairs that
    can really collide aren't.
    """
    urdf = tmp_path / "a.urdf"
    text = (stdlib_folder() / "robots" / "industrial6" / "industrial6.urdf").read_text()
    urdf.write_text(text)
    made = CliRunner().invoke(main, ["robot", "new", str(urdf), "--yes", "-o", str(tmp_path / "fine")])
    assert made.exit_code == 0, made.output
    assert "[collision]" not in (tmp_path / "fine" / "robot.toml").read_text()
    urdf.write_text(text.replace('<capsule radius="0.05" length="0.16"/>', '<sphere radius="0.3"/>'))
    made = CliRunner().invoke(main, ["robot", "new", str(urdf), "--yes", "-o", str(tmp_path / "wide")])
    assert made.exit_code == 0, made.output
    written = (tmp_path / "wide" / "robot.toml").read_text()
    (line,) = [one for one in written.splitlines() if "link_5" in one]
    assert re.match(
        r'    \["link_5", "link_3"\],  # guess: they touch in (HOME and in )?\d+% of 200 positions', line
    )
    assert load_robot(str(tmp_path / "wide")).value.allowed == {("link_3", "link_5")}
    told = CliRunner().invoke(main, ["robot", "check", str(tmp_path / "wide")]).output
    assert "they touch in" in told
    assert "touching links: no links touch all the time" in told


def test_a_robot_without_shapes_is_told_and_compiles(tmp_path):
    folder = changed(tmp_path, file="industrial6.urdf")
    urdf = tmp_path / "arm" / "industrial6.urdf"
    urdf.write_text(re.sub(r"<collision>.*?</collision>", "", urdf.read_text(), flags=re.DOTALL))
    value, found = compiled("P0010 MOVEJ 0 0 -160 0 0 0 [20] (deg,s)", folder)
    assert not [one for one in found if one.is_error]
    assert value.certificate.commands[0].own_clearance is None
    assert (
        "no collision of the robot is checked" in CliRunner().invoke(main, ["robot", "check", folder]).output
    )


def test_table_and_json(tmp_path):
    (tmp_path / "cell.toml").write_text(POST.replace("[-600, 800, 1200]", "[-1100, 0, 1200]"))
    program = tmp_path / "a.yarc"
    program.write_text(
        "ROBOT INDUSTRIAL6\n" + HEAD + "P0010 MOVEJ 100 0 0 0 0 0\nP0020 MOVEJ 110 0 0 0 0 0\n"
    )
    told = CliRunner().invoke(yarcc, [str(program), "--certificate", str(tmp_path / "c.json")])
    assert told.exit_code == 0, told.output
    assert "clear mm" in told.output
    first = json.loads((tmp_path / "c.json").read_text())["commands"][0]
    assert first["clearance"]["bodies"][1] == "POST"
    assert first["own_clearance"] == {"at_least_mm": pytest.approx(100), "bodies": None}
    shown = (
        f"{np.floor(first['clearance']['at_least_mm'] * 10) / 10:.1f} {first['clearance']['bodies'][0]}, POST"
    )
    assert shown in told.output
    value, _ = compiled("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)")
    assert "clear" not in certificate_table(value.certificate)


def test_bodies_that_overlap_have_no_distance_however_they_are_asked(tmp_path):
    """Bodies that overlap have no distance. Without asking for a penetration depth, coal gives some of them a
    tiny distance instead of zero, so the robot would count as free.
    """
    (tmp_path / "cell.toml").write_text(
        UNITS
        + '[[obstacles]]\nname = "BLOCK"\nshape = "box"\nframe = "B"\nsize = [60, 60, 60]\n'
        + '[[obstacles]]\nname = "BEAM"\nshape = "capsule"\nframe = "FLANGE"\nradius = 0.5\nlength = 200\n'
    )
    robot = load_robot("INDUSTRIAL6").value
    cell = cell_loader(tmp_path, robot)("cell.toml", None).value
    scene = scene_of(robot, cell).value
    names = [
        {scene.bodies[one].name for one in pair}
        for pair in zip(scene.pairs.first, scene.pairs.second, strict=True)
    ]
    pair = np.full(500, names.index({"BLOCK", "BEAM"}))
    middle = np.random.default_rng(0).uniform(-0.029, 0.029, (500, 3))
    seen = Relative(np.broadcast_to(np.eye(3), (500, 3, 3)), middle)
    assert (distances(scene, pair, seen) < 0.0).all()
    assert (distances(scene, pair, seen, deep=False) == 0.0).all()
