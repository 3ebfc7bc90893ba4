"""Tests of recognizing meshes: real ones of all kinds, and files that only look like one."""

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

from tests.robot.made_arms import DATA
from yarclang.robot.new.meshes import NoMeshError, read_mesh

TRIANGLE = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
BINARY = b"\0" * 80 + struct.pack("<I", 1) + TRIANGLE
TEXT = (
    b"solid a b\n facet normal nan 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.5e-3 0 0\n   vertex -0 +1 2\n  endloop\n"  # noqa: E501
    b" endfacet\nendsolid a b\n"
)
OBJ = b"# made\nmtllib a.mtl\no part\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\ns off\nusemtl x\nf 1//1 2//1 \\\n3//1\n"  # noqa: E501
PLY_HEAD = (
    b"ply\nformat %b 1.0\ncomment made\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"  # noqa: E501
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
)
PLY = PLY_HEAD % b"ascii" + b"0 0 0\n1 0 0\n0 1.5e-3 -0\n3 0 1 2\n"
PLY_BINARY = (
    PLY_HEAD % b"binary_little_endian" + np.eye(3, dtype="<f4").tobytes() + struct.pack("<B3i", 3, 0, 1, 2)
)
DAE = (
    b'<?xml version="1.0" encoding="utf-8"?>\n<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">'  # noqa: E501
    b'<library_geometries><geometry><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array></source>'  # noqa: E501
    b'<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">'
    b'<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries></COLLADA>'  # noqa: E501
)


def read(folder, name, content):
    path = folder / name
    path.write_bytes(content)
    return read_mesh(path)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.stl", BINARY),
        ("a.STL", BINARY),
        ("a.stl", b"solid binary" + BINARY[12:]),
        ("a.stl", TEXT),
        ("a.stl", TEXT.replace(b"\n", b"\r\n")),
        ("a.stl", TEXT + TEXT),
        ("a.stl", TEXT.upper().replace(b"SOLID", b"solid")),
        ("a.obj", OBJ),
        ("a.obj", OBJ.replace(b"\n", b"\r\n")),
        ("a.ply", PLY),
        ("a.ply", PLY.replace(b"\n", b"\r\n")),
        ("a.ply", PLY_BINARY),
        ("a.dae", DAE),
        ("a.dae", DAE.decode().replace("utf-8", "utf-16").encode("utf-16")),
    ],
)
def test_a_mesh_is_read(name, content, tmp_path):
    assert read(tmp_path, name, content) == content


def test_all_meshes_of_real_robots_are_meshes():
    kinds = {".stl", ".obj", ".dae", ".ply"}
    found = [path for path in sorted(DATA.rglob("*")) if path.suffix.lower() in kinds]
    assert len(found) > 500
    small = [path for path in found if path.stat().st_size < 300_000]
    assert {path.suffix.lower() for path in small} >= {".stl", ".obj", ".dae"}
    for path in small:
        assert read_mesh(path)


SECRETS = [
    b"",
    b"\0",
    b"root:x:0:0:root:/root:/bin/bash\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    b"-----BEGIN OPENSSH PRIVATE KEY-----\nb3BlbnNzaC1rZXktdjEAAAAA\n-----END OPENSSH PRIVATE KEY-----\n",
    b"solid\nroot:x:0:0\n",
    b"solid state\nvertex 0 0\n",
    b"# only comments\n# and more\n",
    b"v 0 0 0\nv 1 0 0\n",
    b"ply\n",
    b"ply\nformat ascii 1.0\nend_header\n",
    PLY + b"root:x:0:0\n",
    PLY.replace(b"format ascii 1.0\n", b""),
    BINARY + b"\n",
    BINARY[:-1],
    BINARY[:83],
    b"<COLLADA/>",
    b"<html><geometry><mesh/></geometry></html>",
    DAE[:-1],
    DAE + b"root:x:0:0",
    DAE.replace(b"<COLLADA", b'<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]><COLLADA'),
    b"PK\x03\x04" + b"\0" * 100,
    b"\x7fELF" + b"\0" * 200,
    b"SQLite format 3\0" + b"\0" * 200,
]


@pytest.mark.parametrize("kind", [".stl", ".obj", ".dae", ".ply"])
@pytest.mark.parametrize("content", SECRETS, ids=range(len(SECRETS)))
def test_what_is_no_mesh_is_refused(kind, content, tmp_path):
    with pytest.raises(NoMeshError, match="its content has another format"):
        read(tmp_path, f"a{kind}", content)


@pytest.mark.parametrize("name", ["a", "a.txt", "a.stl.txt", "stl", ".stl", "a.gltf", "a.stl "])
def test_a_name_that_is_no_meshs_is_refused(name, tmp_path):
    with pytest.raises(NoMeshError, match=r"doesn't end in \.stl, \.obj, \.dae or \.ply"):
        read(tmp_path, name, BINARY)


def test_one_kind_by_the_name_of_another_is_refused(tmp_path):
    contents = {".stl": BINARY, ".obj": OBJ, ".dae": DAE, ".ply": PLY}
    for kind in contents:
        for other, content in contents.items():
            if kind != other:
                with pytest.raises(NoMeshError):
                    read(tmp_path, f"a{kind}", content)


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(max_size=400), st.sampled_from([".stl", ".obj", ".dae", ".ply"]))
@example(b"solid", ".stl")
def test_nothing_else_is_raised(tmp_path, content, kind):
    # A text that begins with "solid" is an STL without triangles.
    assume(not content.startswith((b"solid ", b"solid\n", b"solid\r")))
    with pytest.raises(NoMeshError):
        read(tmp_path, f"a{kind}", content)


def test_large_files_take_bounded_time(tmp_path):
    """Contents that are made to keep a search busy are read in limited time."""
    for name, content in (
        ("a.stl", b"solid x\n" + b"facet normal 0 0 1\n" * 200_000 + b"!"),
        ("a.stl", b"solid " + b" " * 4_000_000 + b"\nvertex" + b" " * 4_000_000),
        ("a.obj", b"v " + b"\\\n" * 2_000_000),
        ("a.ply", b"ply\nformat ascii 1.0\n" + b"comment x\n" * 400_000),
        ("a.ply", PLY + b"1 " * 2_000_000 + b"!"),
        ("a.dae", b"<a>" * 1_000_000),
    ):
        import time

        begun = time.process_time()
        with pytest.raises(NoMeshError):
            read(tmp_path, name, content)
        assert time.process_time() - begun < 5.0, name


def test_a_file_that_grows_while_it_is_read_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr("yarclang.robot.new.meshes.LARGEST", 100)
    path = Path(tmp_path / "a.stl")
    path.write_bytes(BINARY)
    with pytest.raises(NoMeshError, match="has 134 bytes, more than 100"):
        read_mesh(path)


NAN = struct.pack("<f", float("nan"))


@pytest.mark.parametrize(
    ("name", "content", "fault"),
    [
        ("a.stl", b"\0" * 84, "no triangle"),
        ("a.stl", BINARY[:96] + NAN + BINARY[100:], "isn't a finite number"),
        ("a.stl", BINARY[:96] + struct.pack("<f", float("inf")) + BINARY[100:], "isn't a finite number"),
        ("a.stl", TEXT.replace(b"1.5e-3", b"-NaN"), "isn't a finite number"),
        ("a.obj", OBJ.replace(b"v 1 0 0", b"v 1 inf 0"), "isn't a finite number"),
    ],
)
def test_a_mesh_that_could_never_collide_is_refused(name, content, fault, tmp_path):
    with pytest.raises(NoMeshError, match=fault):
        read(tmp_path, name, content)


def test_a_normal_that_is_no_number_harms_nothing(tmp_path):
    assert read(tmp_path, "a.stl", BINARY[:84] + NAN + BINARY[88:])


DAE_CORNERS = (
    b'<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries><geometry><mesh>'  # noqa: E501
    b'<source id="p"><float_array id="pa" count="9">%b 0 0 1 0 0 0 1 0</float_array></source>'
    b'<source id="n"><float_array id="na" count="3">%b 0 1</float_array></source>'
    b'<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">'
    b'<input semantic="NORMAL" source="#n" offset="1"/><input semantic="VERTEX" source="#v" offset="0"/><p>0 0 1 0 2 0</p></triangles>'  # noqa: E501
    b"</mesh></geometry></library_geometries></COLLADA>"
)


@pytest.mark.parametrize("word", [b"NaN", b"nan", b"INF", b"-inf"])
def test_a_dae_with_a_corner_that_is_no_number_is_refused(word, tmp_path):
    with pytest.raises(NoMeshError, match="has a corner that isn't a finite number"):
        read(tmp_path, "a.dae", DAE_CORNERS % (word, b"0"))
    assert read(tmp_path, "a.dae", DAE_CORNERS % (b"0", word))  # here the odd number is in a normal


@pytest.mark.parametrize(
    "face", [b"1 2 4", b"0 1 2", b"-4 1 2", b"1/1 2/1 99999/1", b"1 2 " + b"9" * 5000, b"1 2 \\\n4"]
)
def test_an_obj_with_a_face_of_corners_that_are_not_there_is_refused(face, tmp_path):
    with pytest.raises(NoMeshError, match=r"has a face with the corner -?\d+, but 3 corners$"):
        read(tmp_path, "a.obj", OBJ + b"f " + face + b"\n")


@pytest.mark.parametrize("face", [b"-3 -2 -1", b"1// 2// 3//", b"1 2 \\\r\n3", b"1 2 3 # 7"])
def test_an_obj_with_faces_of_its_corners_is_read(face, tmp_path):
    assert read(tmp_path, "a.obj", OBJ + b"f " + face + b"\n")


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("a.stl", b"", "another format: it is empty$"),
        ("a.stl", BINARY[:-1], r"a binary STL of 1 triangles has 134 bytes, this one has 133\)$"),
        ("a.dae", DAE[:-12], r"\(XML, line 2: "),
    ],
)
def test_a_file_that_was_cut_off_is_named_as_such(name, content, why, tmp_path):
    with pytest.raises(NoMeshError, match=why):
        read(tmp_path, name, content)


def test_a_face_of_something_else_is_not_shown(tmp_path):
    with pytest.raises(
        NoMeshError, match=r"has a face with the corner that isn't an integer, but 3 corners$"
    ):
        read(tmp_path, "a.obj", OBJ + b"f 1 2 \x1b[31m\n")


def test_a_doctype_is_refused_before_its_entities_are_read(tmp_path):
    bomb = b'<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb"><!ENTITY c "&b;&b;&b;&b;">]><COLLADA>&c;</COLLADA>'
    with pytest.raises(NoMeshError, match=r"another format \(XML with a DOCTYPE\)$"):
        read(tmp_path, "a.dae", bomb)


OBJ_LINES = st.one_of(
    st.sampled_from([b"v 0 0 0", b"v 1 0 0", b"\tv 0 1 0", b"vn 0 0 1", b"vt 0 0", b"# f 9 9 9", b"",
        b"o one", b"v"]),
    st.tuples(
        st.sampled_from([b"f", b" f", b"fo", b"f\t", b"face"]),
        st.lists(
            st.sampled_from([b"1", b"2", b"3", b"4", b"+1", b"-1", b"-4", b"0", b"1/1", b"2//5", b"x", b"1.5",
                b"#", b"1_0", b"9" * 30]),
            max_size=4,
        ),
    ).map(lambda one: b" ".join([one[0], *one[1]])),
)  # fmt: skip


@given(st.lists(OBJ_LINES, max_size=8), st.sampled_from([b"\n", b"\r\n"]))
def test_the_quick_look_at_faces_never_hides_a_fault(lines, end):
    from yarclang.meshes import obj

    content = end.join(lines)
    quick = obj.obj_fault(content)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(obj, "_is_plain", lambda _: False)
        patch.setattr(obj, "obj_corners", lambda _: None)
        assert obj.obj_fault(content) == quick
