"""Tests of meshes of links, tools and obstacles in convex pieces: their entries in files, and their use."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from collision.test_pieces import clamp
from robot.test_tools import changed, codes

from yarclang.certify.kinematics.described import ContradictionError, own_robot
from yarclang.cli.yarcc import main as yarcc
from yarclang.collision.checklist import flat_meshes
from yarclang.collision.scene import scene_of
from yarclang.meshes.stl import stl_of
from yarclang.robot.description import load_robot

TOOL = """
[tools.CLAMP]
[[bodies]]
tool = "CLAMP"
shape = "mesh"
file = "clamp.stl"
"""


def with_clamp(tmp_path, text):
    folder = changed(tmp_path, ("[tolerance]", f"{text}\n[tolerance]"))
    (tmp_path / "arm" / "clamp.stl").write_bytes(stl_of(clamp() * 1e3))
    return folder


def with_mesh_of_a_link(tmp_path, pieces):
    """Return the folder of a robot whose link_3 has the shape of a clamp."""
    folder = with_clamp(tmp_path, f"[collision]\npieces = {pieces}" if pieces else "")
    (urdf,) = Path(folder).glob("*.urdf")
    text = urdf.read_text()
    begin = text.index("<collision", text.index('<link name="link_3"'))
    end = text.index("</geometry>", begin)
    head = text[begin : text.index("<geometry>", begin)]
    mesh = '<geometry><mesh filename="clamp.stl" scale="0.001 0.001 0.001"/>'
    urdf.write_text(text[:begin] + head + mesh + text[end:])
    return folder


def bodies(robot, name):
    return [one for one in scene_of(robot, None).value.bodies if one.name == name]


def test_a_tool_in_pieces(tmp_path):
    robot = load_robot(with_clamp(tmp_path, TOOL + "pieces = 8\n")).value
    assert len(bodies(robot, "CLAMP")) == 4
    assert all(not one.geometry.is_hollow and one.of_robot for one in bodies(robot, "CLAMP"))
    assert flat_meshes(robot) == ()


def test_a_tool_without_pieces_is_its_hull_and_has_the_fingerprint_that_it_had(tmp_path):
    one = load_robot(with_clamp(tmp_path, TOOL)).value
    assert len(bodies(one, "CLAMP")) == 1
    other = load_robot(with_clamp(tmp_path / "other", TOOL + "pieces = 8\n")).value
    assert one.fingerprint != other.fingerprint


def test_a_link_in_pieces(tmp_path):
    one = load_robot(with_mesh_of_a_link(tmp_path / "a", "")).value
    other = load_robot(with_mesh_of_a_link(tmp_path / "b", "{ link_3 = 8 }")).value
    assert len(bodies(other, "link_3")) == len(bodies(one, "link_3")) + 3
    assert one.fingerprint != other.fingerprint
    assert own_robot(other).shapes[0].joint == other.shapes[0].joint
    forged = [
        replace(shape, shape=replace(shape.shape, pieces=2)) if getattr(shape.shape, "pieces", 0) else shape
        for shape in other.shapes
    ]
    with pytest.raises(ContradictionError, match="another number of pieces"):
        own_robot(replace(other, shapes=tuple(forged)))


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (TOOL + "pieces = 0\n", "Y1308", "pieces"),
        (TOOL + "pieces = 65\n", "Y1308", "pieces"),
        (TOOL + "pieces = 2.5\n", "Y1306", "pieces"),
        (TOOL.replace('"mesh"\nfile = "clamp.stl"', '"sphere"\nradius = 3\npieces = 3'), "Y1305", "pieces"),
        ("[collision]\npieces = { link_9 = 3 }", "Y1347", "link_9"),
        ("[collision]\npieces = { link_1 = 3 }", "Y1308", "has no collision mesh"),
        ("[collision]\npieces = { link_1 = 0 }", "Y1308", "link_1"),
        ("[collision]\npieces = 3", "Y1306", "pieces"),
    ],
)
def test_mistakes(tmp_path, text, code, words):
    found = load_robot(with_clamp(tmp_path, text))
    assert found.value is None
    assert code in codes(found.diagnostics)
    assert words in " ".join(one.message for one in found.diagnostics if one.code == code)


CELL = """
units = "mm,deg"
[frames.CLAMP]
parent = "FLANGE"
xyz = [0, 150, 0]
rpy = [90, 0, 90]
[[obstacles]]
name = "CLAMP"
shape = "mesh"
file = "clamp.stl"
units = "m"
frame = "CLAMP"
PIECES
[[obstacles]]
name = "PIN"
shape = "box"
frame = "B"
xyz = [0, 0, 0]
size = [1, 1, 1]
"""


@pytest.mark.parametrize(
    ("pieces", "triangles", "code"),
    [
        ("pieces = 4", slice(1, None), "Y0960"),
        ("pieces = 1", slice(1, None), None),
        ("pieces = 4", slice(None), None),
    ],
)
def test_an_open_mesh_is_refused_with_its_name(tmp_path, monkeypatch, pieces, triangles, code):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "clamp.stl").write_bytes(stl_of(clamp()[triangles]))
    (tmp_path / "c.toml").write_text(CELL.replace("PIECES", pieces))
    (tmp_path / "p.yarc").write_text(
        'ROBOT INDUSTRIAL6\nCELL "c.toml"\nP0010 MOVEJ 10 0 0 0 -30 0 [3] (deg,s)\n'
    )
    done = CliRunner().invoke(yarcc, ["p.yarc"])
    if code is None:
        assert done.exit_code == 0, done.stderr
    else:
        assert done.exit_code == 1
        assert code in done.stderr
        assert "clamp.stl of CLAMP isn't closed" in " ".join(done.stderr.split())


def test_pieces_that_lack_something_are_refused_by_the_judge(tmp_path, monkeypatch):
    """The judge cuts meshes itself. If the planner's pieces are wrong, nothing is written."""
    from yarclang.collision import pieces as of_meshes
    from yarclang.collision.scene import geometries

    def wrong(triangles, most):
        from yarclang.meshes.pieces import pieces_of

        first, *others = pieces_of(triangles, most)
        smaller = first.corners + 0.01 * (first.corners.mean(axis=0) - first.corners)
        return (replace(first, corners=smaller), *others)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("YARCLANG_CACHE", "")
    (tmp_path / "clamp.stl").write_bytes(stl_of(clamp() * np.array([1.0, 1.0, 1.03])))
    (tmp_path / "c.toml").write_text(CELL.replace("PIECES", "pieces = 5"))
    (tmp_path / "p.yarc").write_text(
        'ROBOT INDUSTRIAL6\nCELL "c.toml"\nP0010 MOVEJ 10 0 0 0 -30 0 [3] (deg,s)\n'
    )
    monkeypatch.setattr(of_meshes, "pieces_of", wrong)
    geometries.cache_clear()
    done = CliRunner().invoke(yarcc, ["p.yarc"])
    geometries.cache_clear()
    assert done.exit_code == 1
    assert "Y0961" in done.stderr
    assert not (tmp_path / "p.pmc").exists()
