"""Tests that large collision meshes are replaced by their convex hulls in the copy: the collision body is the
same, and its file is small.
"""

import numpy as np
import pytest

from tests.collision.test_large_stl import scan
from tests.collision.test_large_text import WRITERS, reach, triangles
from tests.robot.made_arms import yarc
from tests.robot.trap_arms import arm, joint, link, robot, written
from yarclang.collision.geometry import geometry_of
from yarclang.meshes.faults import mesh_fault
from yarclang.meshes.hull import hull_file
from yarclang.meshes.ply import read_ply
from yarclang.meshes.stl import stl_corners
from yarclang.robot.description import load_robot
from yarclang.robot.new import copying
from yarclang.shapes import Mesh

MESH = '<{0}><geometry><mesh filename="{1}" scale="0.001 0.001 0.001"/></geometry></{0}>'


def with_mesh(folder, suffix, content):
    text = MESH.format("collision", f"part{suffix}") + MESH.format("visual", f"part{suffix}")
    file = written(
        folder / "given",
        robot(arm(), link("s", text, shape=False), joint("j", "base_link", "s", kind="fixed")),
    )
    (folder / "given" / f"part{suffix}").write_bytes(content)
    return file


@pytest.mark.parametrize("suffix", [".stl", ".STL", ".obj", "binary"])
def test_the_robot_has_the_hull_and_pictures_the_mesh(suffix, tmp_path, monkeypatch):
    monkeypatch.setattr(copying, "LARGE", 100_000)
    content = scan(4000) if suffix == "binary" else WRITERS[suffix.lower()](triangles(4000))
    suffix = ".stl" if suffix == "binary" else suffix
    file = with_mesh(tmp_path, suffix, content)
    result = yarc("robot", "new", file, "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert "replaced by their convex hulls" in result.output
    copy = tmp_path / "r/meshes/part.hull.ply"
    assert copy.stat().st_size < len(content) / 2
    assert (tmp_path / f"r/meshes/visual/part{suffix}").read_bytes() == content
    scale = (0.001, 0.001, 0.001)
    own = geometry_of(Mesh(tmp_path / "given" / f"part{suffix}", 1.0, "", scale), hull=True)
    found = geometry_of(Mesh(copy, 1.0, "", scale), hull=True)
    np.testing.assert_allclose(reach(found), reach(own), rtol=2e-7, atol=1e-9)
    (shape,) = [one.shape for one in load_robot(str(tmp_path / "r")).value.shapes if one.link == "s"]
    assert shape.path.name == "part.hull.ply"
    assert yarc("robot", "check", tmp_path / "r").exit_code in (0, 1)


def test_a_hull_has_the_corners_to_the_last_bit_and_its_faces_outwards():
    content = scan(4000)
    made = hull_file(".stl", content)
    assert mesh_fault(".ply", made) == ""
    corners, faces = read_ply(made)
    given = {tuple(row) for row in stl_corners(content).tolist()}
    assert {tuple(row) for row in corners.tolist()} <= given
    a, b, c = (corners[faces[:, side]] for side in range(3))
    out = np.cross(b - a, c - a)
    assert (np.einsum("ti,ti->t", out, a - corners.mean(axis=0)) > 0.0).all()
    ways = np.random.default_rng(0).normal(size=(200, 3))
    np.testing.assert_array_equal((corners @ ways.T).max(axis=0), (stl_corners(content) @ ways.T).max(axis=0))


def test_a_hull_of_very_many_corners_is_covered(monkeypatch):
    monkeypatch.setattr("yarclang.meshes.hull.MOST_CORNERS", 50)
    content = scan(4000)
    corners, _ = read_ply(hull_file(".stl", content))
    ways = np.random.default_rng(0).normal(size=(500, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    own, found = ((one @ ways.T).max(axis=0) for one in (stl_corners(content), corners))
    assert (found >= own).all()
    assert (found - own).max() <= 0.01 * own.max()


def test_what_has_no_hull_stays_as_it_is(tmp_path, monkeypatch):
    monkeypatch.setattr(copying, "LARGE", 1000)
    flat = triangles(200)
    flat[:, :, 2] = 0.0
    content = WRITERS[".stl"](flat)
    assert hull_file(".stl", content) is None
    assert hull_file(".dae", WRITERS[".dae"](triangles(200))) is None
    assert hull_file(".stl", b"solid a\nendsolid a\n") is None
    result = yarc("robot", "new", with_mesh(tmp_path, ".stl", content), "--yes", "-o", tmp_path / "r")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "r/meshes/part.stl").read_bytes() == content
