"""Tests of large STL, OBJ and DAE files in text form: hulls are computed from whole arrays, equal those of
coal's reader, and take limited time.
"""

import time
import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from tests.collision.test_large_stl import TRIANGLE, scan
from yarclang.collision import geometry
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.collision.tiles import TiledMesh
from yarclang.meshes.faults import mesh_fault
from yarclang.meshes.obj import obj_corners, obj_triangles
from yarclang.meshes.stl import stl_corners
from yarclang.meshes.text import integers, numbers, pieces, table
from yarclang.shapes import Mesh

WAYS = np.random.default_rng(5).normal(size=(1000, 3))
WAYS /= np.linalg.norm(WAYS, axis=1, keepdims=True)


def triangles(count):
    return np.frombuffer(scan(count), TRIANGLE, offset=84)["corners"].reshape(-1, 3, 3).astype(float)


def text_stl(faces):
    lines = ["solid a scan"]
    for face in faces:
        corners = "".join(f"      vertex {x:.6e} {y:.6e} {z:.6e}\n" for x, y, z in face)
        lines.append(
            f"  facet normal nan 0 1\n    outer loop\n{corners}    endloop\n  endfacet"
        )  # normals may be anything
    return "\n".join([*lines, "endsolid a scan", ""]).encode()


def shared(faces):
    corners, named = np.unique(faces.reshape(-1, 3), axis=0, return_inverse=True)
    return corners, named.reshape(-1, 3)


def text_obj(faces, form="{0}//{0}"):
    corners, named = shared(faces)
    lines = ["# a scan", "mtllib a.mtl", "o scan", *(f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in corners)]
    lines += ["v 9000 9000 9000", *["vn 0 0 1"] * len(corners), "g all", "usemtl steel", "s off"]
    lines += ["f " + " ".join(form.format(at + 1) for at in face) for face in named]
    return "\n".join(lines).encode()  # the last corner belongs to no face


DAE = """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit name="meter" meter="1"/>
<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="{count}">{corners}</float_array>
<technique_common><accessor source="#pa" count="{third}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="{faces}">
<input semantic="VERTEX" source="#v" offset="0"/><p>{named}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="a"><matrix>0 -1 0 50 1 0 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""  # noqa: E501


def text_dae(faces):
    corners, named = shared(faces)
    listed = " ".join(f"{value:.5f}" for value in corners.reshape(-1))
    used = " ".join(map(str, named.reshape(-1)))
    return DAE.format(
        count=corners.size, third=len(corners), corners=listed, faces=len(named), named=used
    ).encode()


WRITERS = {".stl": text_stl, ".obj": text_obj, ".dae": text_dae}


def mesh(folder, suffix, content, scale=(1.0, 1.0, 1.0)):
    path = folder / f"part{suffix}"
    path.write_bytes(content)
    return Mesh(path, 1e-3, "", scale)


def reach(found):
    return (WAYS @ (found.corners + found.middle).T).max(axis=1)


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 0.5)])
def test_the_hull_is_that_of_coals_reader(suffix, scale, tmp_path, monkeypatch):
    shape = mesh(tmp_path, suffix, WRITERS[suffix](triangles(40_000)), scale)
    assert shape.path.stat().st_size >= geometry._LARGE
    quick = geometry_of(shape, hull=True)
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    slow = geometry_of(shape, hull=True)
    # Assimp reads numbers with 24 bits.
    np.testing.assert_allclose(reach(quick), reach(slow), rtol=2e-7, atol=1e-9)
    np.testing.assert_allclose(quick.half, slow.half, rtol=2e-7, atol=1e-9)
    assert len(quick.corners) > 100


def middles(corners, faces):
    """Return the centers and sizes of triangles (T, 4), by which they can be identified."""
    three = corners[faces]
    middle = three.mean(axis=1)
    size = np.linalg.norm(three - middle[:, None], axis=2).max(axis=1)
    return np.concatenate((middle, size[:, None]), axis=1)


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 0.5)])
def test_an_obstacles_triangles_are_those_of_coals_reader(suffix, scale, tmp_path, monkeypatch):
    shape = mesh(tmp_path, suffix, WRITERS[suffix](triangles(40_000)), scale)
    quick = geometry_of(shape)
    assert isinstance(quick.solid, TiledMesh)
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    slow = geometry_of(shape)
    model = slow.solid
    faces = np.array([[model.tri_indices(at)[side] for side in range(3)] for at in range(model.num_tris)])
    known = middles(np.array(model.vertices()), faces)
    found = middles(quick.solid.corners, quick.solid.faces)
    far, which = cKDTree(found).query(known)
    assert far.max() <= 3e-6 * np.abs(known).max()
    assert len(found) == len(known) == len(np.unique(which))
    assert (quick.skin is None) == (slow.skin is None)


def test_quads_and_faces_that_lack_a_corner_are_left_to_coals_reader(tmp_path):
    obj = text_obj(triangles(100))
    assert len(obj_triangles(obj)) == len(triangles(100))
    assert obj_triangles(obj + b"\nf 1 2 3 4\n") is None
    assert obj_triangles(obj + b"\nf 1 2\nf 1 2 3 4\n") is None
    assert obj_triangles(obj + b"\nf 1 2 9999999\n") is None
    assert obj_triangles(obj + b"\nf 1 2 1.5\n") is None
    assert obj_triangles(obj + b"\nf 1 2 -1\n") is None


@pytest.mark.parametrize("suffix", WRITERS)
def test_sixty_megabytes_take_seconds(suffix, tmp_path):
    faces = triangles(200_000)
    content = WRITERS[suffix](faces)
    begun = time.process_time()
    shape = mesh(tmp_path, suffix, content)
    assert mesh_fault(suffix, content) == ""
    geometry_of(shape, hull=True)
    # Three times the usual time for 60 MB, as a reserve for a busy computer.
    assert time.process_time() - begun < 8 * len(content) / 60e6 + 3


def test_a_dense_sphere_is_covered_and_hardly_larger(tmp_path):
    side = 400
    up, around = np.meshgrid(
        np.linspace(0, np.pi, side + 1), np.linspace(0, 2 * np.pi, side + 1), indexing="ij"
    )
    at = 100 * np.stack([np.sin(up) * np.cos(around), np.sin(up) * np.sin(around), np.cos(up)], axis=-1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    faces = np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    records = np.zeros(len(faces), TRIANGLE)
    records["corners"] = faces.reshape(-1, 9)
    shape = mesh(tmp_path, ".stl", bytes(80) + len(faces).to_bytes(4, "little") + records.tobytes())
    begun = time.process_time()
    found = geometry_of(shape, hull=True)
    assert time.process_time() - begun < 9
    assert reach(found).min() >= 0.1 - 1e-8
    assert reach(found).max() <= 0.1008
    assert len(found.corners) < 5000


# -------------------------------------------------------------------------- what is unusual

BOX = np.array([[x, y, z] for x in (0, 10) for y in (0, 20) for z in (0, 30)], dtype=float)
FACES = BOX[[[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6],
    [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]]  # fmt: skip
SPOILED = st.tuples(
    st.sampled_from((".stl", ".obj")),
    st.lists(
        st.tuples(
            st.integers(0, 2000),
            st.sampled_from(
                ["", " ", "\n", "\t", "1", "-", ".", "e", "x", "VERTEX 9 9 99\n", "vertex 9 9 99\n",
                    "v 9 9 99\n", "f 1 2 8\n",
                 ("\n"
                 "f 1/1/1 2/2/2 8\n"), ("\n"
                     "f -1 -2 -3\n"), ("\n"
                     "l 1 2\n"), "#", "\\\n", "\r", "1.5-2", "nan", ("endsolid\n"
                     "solid\n"), "0x1", "1e400", "\x00"]
            ),
            st.integers(0, 40),
        ),
        min_size=0,
        max_size=2,
    ),
)  # fmt: skip
SEEN = {True: 0, False: 0}


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(SPOILED)
@example((".obj", [(0, "\r", 29)]))
@example((".obj", [(54, "\r", 1)]))
@example((".stl", [(316, "1", 1)]))  # 0e100
@example((".stl", [(776, "1", 1)]))  # a number that is infinite in single precision
def test_what_is_read_as_arrays_is_what_coal_reads(tmp_path, spoiled):
    suffix, changes = spoiled
    content = WRITERS[suffix](FACES)
    for at, text, gone in changes:
        content = content[:at] + text.encode() + content[at + gone :]
    corners = {".stl": stl_corners, ".obj": obj_corners}[suffix](content)
    SEEN[corners is not None] += 1
    if corners is None:
        return
    assert mesh_fault(suffix, content) == ""
    try:
        model = geometry.load_mesh(mesh(tmp_path, suffix, content))
    except UnreadableError:
        return
    theirs = np.asarray(model.vertices())
    if not np.isfinite(theirs).all():  # coal reads 0e100 as NaN; such a mesh is refused where it is used
        return
    mine = (WAYS @ (corners * 1e-3).T).max(axis=1)
    # Our hull is never smaller, and equal if coal's reader uses all triangles.
    assert (mine >= (WAYS @ theirs.T).max(axis=1) - 1e-6 * (1.0 + np.abs(mine))).all()


def test_enough_of_both_was_seen():
    assert min(SEEN.values()) >= 30, SEEN


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (b"1 2 3", [1, 2, 3]),
        (b" -1.5e-3\t.5\n5. ", [-0.0015, 0.5, 5.0]),
        (b"", []),
        (b" \n", []),
        (b"1.5-2", None),
        (b"1 2,3", None),
        (b"1 0x10", None),
        (b"1.2.3", None),
        (b"1e5.5", None),
        (b"1 \x01", None),
        (b"1\x002", None),
        (b"\xff", None),
        (b"1_000", None),
    ],
)
def test_numbers_of_a_text(text, wanted):
    for rule in ("error", "ignore"):  # older versions of numpy warn, newer ones raise
        with warnings.catch_warnings():
            warnings.simplefilter(rule)
            found = numbers(text)
        assert (None if found is None else found.tolist()) == wanted


def test_integers_beyond_64_bits_stay_beyond_all_corners():
    assert integers(b"1 99999999999999999999999999").max() > 10**18
    assert integers(b"1 2.0") is None


@pytest.mark.parametrize(
    "lines", [[b"1 2"], [b"1 2 3 4"], [b"1 2", b"1 2 3 4"], [b"1 2 nan"], [b"1 2 inf"],
        [b"1 2 3 nan", b"1 2"], [b""]]
)  # fmt: skip
def test_a_table_has_rows_of_one_length(lines):
    assert table(lines, 3) is None


def test_pieces_are_whole_lines_and_the_whole_file(monkeypatch):
    monkeypatch.setattr("yarclang.meshes.text._PIECE", 10)
    for content in (
        b"",
        b"one\ntwo\n\nthree is a long line\nfour",
        b"no end of a line in it at all",
        b"\n" * 40,
    ):
        found = list(pieces(content))
        assert b"".join(found) == content
        assert all(one.endswith(b"\n") for one in found[:-1])
    faces = triangles(60)
    assert len(stl_corners(text_stl(faces))) == 3 * len(faces)
    np.testing.assert_allclose(obj_corners(text_obj(faces)), shared(faces)[0], atol=1e-5)
    for form in ("{0}", "{0}/{0}", "{0}/{0}/{0}"):
        assert len(obj_corners(text_obj(faces, form))) == len(shared(faces)[0])


def test_corners_of_polygons_that_coals_reader_leaves_out_are_in_the_hull(tmp_path):
    """Of a plane polygon with five corners, one of which lies inwards, coal's reader makes only two
    triangles. All corners are in our hull.
    """
    corners = (
        "-0.385456 -0.575404 0\n"
        "-0.312941 -0.892575 0\n"
        "-0.105246 -0.655819 0\n"
        "0.066108 -0.252693 0\n"
        "0.367907 -0.834241 0\n"
        "0 0 1\n"
        "0.1 0 1\n"
        "0 0.1 1\n"
    )
    text = "".join(f"v {line}\n" for line in corners.splitlines()) + "f 1 2 3 4 5\nf 6 7 8\n"
    path = tmp_path / "a.obj"
    path.write_text(text)
    lost = np.asarray(geometry.load_mesh(Mesh(path, 1.0, "")).vertices())
    found = geometry_of(Mesh(path, 1.0, "", (1.0, 1.0, 1.0)), hull=True)
    own = np.array([[float(word) for word in line.split()] for line in corners.splitlines()])
    assert ((WAYS @ own.T).max(axis=1) > (WAYS @ lost.T).max(axis=1) + 0.01).any()
    np.testing.assert_allclose(reach(found), (WAYS @ own.T).max(axis=1), atol=1e-12)


POLYGONS = st.integers(4, 11).flatmap(
    lambda size: st.lists(st.tuples(*[st.floats(-1, 1)] * 3), min_size=size, max_size=size)
)
LOST = {True: 0, False: 0}


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(POLYGONS, st.randoms(use_true_random=False))
def test_the_hull_has_all_corners_of_faces(tmp_path, corners, random):
    own = np.array(corners)
    if np.linalg.svd(own - own.mean(axis=0), compute_uv=False)[2] < 1e-3:
        return
    named = list(range(1, len(own) + 1))
    random.shuffle(named)
    text = (
        "".join(f"v {x:.9f} {y:.9f} {z:.9f}\n" for x, y, z in own) + "f " + " ".join(map(str, named)) + "\n"
    )
    path = tmp_path / "a.obj"
    path.write_text(text)
    shape = Mesh(path, 1.0, "", (1.0, 1.0, 1.0))
    wanted = (WAYS @ own.T).max(axis=1)
    try:
        theirs = np.asarray(geometry.load_mesh(shape).vertices())
    except UnreadableError:  # no triangle is left
        return
    np.testing.assert_allclose(reach(geometry_of(shape, hull=True)), wanted, atol=3e-5)
    LOST[bool(((WAYS @ theirs.T).max(axis=1) < wanted - 1e-4).any())] += 1


def test_some_corners_were_left_out():
    assert min(LOST.values()) >= 3, LOST
