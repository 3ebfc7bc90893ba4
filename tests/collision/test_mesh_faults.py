"""Tests of faulty meshes in robot.toml, cell.toml and URDFs: each fault is named, and no file crashes the
process.
"""

from __future__ import annotations

import re
import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.collision.scene import scene_of
from yarclang.meshes.faults import mesh_fault
from yarclang.report.solids import solid_of
from yarclang.robot.description import load_robot, stdlib_folder
from yarclang.shapes import Mesh

CORNERS = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))
FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))


def rows(values) -> str:
    return "\n".join(" ".join(str(value) for value in row) for row in values) + "\n"


def stl(corners=CORNERS, faces=FACES) -> bytes:
    each = b"".join(
        struct.pack("<12fH", 0, 0, 0, *(value for corner in face for value in corners[corner]), 0)
        for face in faces
    )
    return b"\0" * 80 + struct.pack("<I", len(faces)) + each


def stl_text(corners=CORNERS, faces=FACES) -> bytes:
    each = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(map(str, corners[corner]))}\n" for corner in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    return f"solid a\n{each}endsolid a\n".encode()


def obj(corners=CORNERS, faces=FACES) -> bytes:
    each = "".join(f"f {' '.join(str(corner + 1) for corner in face)}\n" for face in faces)
    return ("".join(f"v {' '.join(map(str, corner))}\n" for corner in corners) + each).encode()


def ply_head(form: str, faces: int, corners: int = 4) -> bytes:
    return (
        "ply\n"
        f"format {form} 1.0\n"
        f"element vertex {corners}\n"
        "property float x\n"
        "property float y\n"
        "property float z\n"
        f"element face {faces}\n"
        "property list uchar int vertex_indices\n"
        "end_header\n"
    ).encode()


def ply(corners=CORNERS, faces=FACES) -> bytes:
    return ply_head("ascii", len(faces)) + (rows(corners) + rows((len(one), *one) for one in faces)).encode()


def ply_binary(corners=CORNERS, faces=FACES, form="binary_little_endian", order="<") -> bytes:
    places = np.array(corners, dtype=f"{order}f4").tobytes()
    each = b"".join(struct.pack(f"{order}B{len(one)}i", len(one), *one) for one in faces)
    return ply_head(form, len(faces)) + places + each


def ply_big(corners=CORNERS, faces=FACES) -> bytes:
    return ply_binary(corners, faces, "binary_big_endian", ">")


def dae(corners=CORNERS, faces=FACES) -> bytes:
    numbers = rows(corners).replace("\n", " ")
    return (
        '<?xml version="1.0"?>\n'
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><unit '
        'name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>'
        '<source id="p"><float_array id="pa" '
        f'count="{3 * len(corners)}">{numbers}</float_array><technique_common><accessor source="#pa" '
        f'count="{len(corners)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>'
        '<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input '
        f'semantic="POSITION" source="#p"/></vertices><triangles count="{len(faces)}"><input '
        'semantic="VERTEX" source="#v" offset="0"/>'
        f"<p>{rows(faces)}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene "  # noqa: E501
        'id="s"><node id="n"><instance_geometry '
        'url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene '
        'url="#s"/></scene></COLLADA>'
    ).encode()


WRITERS = {
    "binary.stl": stl,
    "text.stl": stl_text,
    "a.obj": obj,
    "text.ply": ply,
    "binary.ply": ply_binary,
    "big.ply": ply_big,
    "a.dae": dae,
}
INDEXED = [name for name in WRITERS if not name.endswith(".stl")]
NAN = ((0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1))


def unreadable(folder: Path, name: str, content: bytes, scale: float = 1.0) -> str:
    """Return the fault of a mesh; empty if it can be read."""
    (folder / name).write_bytes(content)
    shape = Mesh(folder / name, 1.0, "", (scale, scale, scale))
    for hull in (False, True):
        try:
            geometry_of(shape, hull=hull)
        except UnreadableError as error:
            return str(error)
    return ""


@pytest.mark.parametrize("name", WRITERS)
def test_a_sound_mesh_keeps_all_its_faces(name, tmp_path):
    (tmp_path / name).write_bytes(WRITERS[name]())
    made = geometry_of(Mesh(tmp_path / name, 1.0, ""))
    assert (made.of_coal.num_tris, len(made.corners)) == (4, 4)
    assert mesh_fault(Path(name).suffix.upper(), WRITERS[name]()) == ""
    assert len(solid_of(Mesh(tmp_path / name, 1.0, "")).faces) == 4


@pytest.mark.parametrize("name", INDEXED)
@pytest.mark.parametrize("corner", [4, 9, 900, 2**31 - 1, -1])
def test_a_face_of_a_corner_that_is_not_there(name, corner, tmp_path):
    fault = unreadable(tmp_path, name, WRITERS[name](faces=((0, 1, 2), (0, 1, corner))))
    if name == "a.obj":  # this format counts corners from 1, and 0 is no corner
        corner += 1
    assert fault == f"has a face with the corner {corner}, but 4 corners"
    assert solid_of(Mesh(tmp_path / name, 1.0, "")) is None


@pytest.mark.parametrize("name", [one for one in INDEXED if one.endswith(".ply")])
def test_faces_of_several_lengths_are_looked_at(name, tmp_path):
    square = ((0, 1, 2), (0, 1, 2, 3), (1, 2, 3))
    assert unreadable(tmp_path, name, WRITERS[name](faces=square)) == ""
    fault = unreadable(tmp_path, name, WRITERS[name](faces=(*square, (0, 1, 2, 7))))
    assert fault == "has a face with the corner 7, but 4 corners"


@pytest.mark.parametrize("name", WRITERS)
def test_a_corner_that_is_no_number(name, tmp_path, capfd):
    assert unreadable(tmp_path, name, WRITERS[name](corners=NAN)) == "has a corner that isn't a finite number"
    assert capfd.readouterr() == ("", "")  # coal would print a message about eigenvalues


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.75, 0.9, 0.97])
def test_a_mesh_that_was_cut_off(name, share, tmp_path):
    if name == "a.obj" and share > 0.5:
        return  # a file of this format doesn't say how many faces it has
    content = WRITERS[name]()
    fault = unreadable(tmp_path, name, content[: int(share * len(content))])
    assert re.search(
        r"cut off|is empty|no triangle|damaged|no header|no line|not there|isn't one|readers skip", fault
    ), fault


@pytest.mark.parametrize("name", WRITERS)
def test_a_mesh_without_a_face(name, tmp_path):
    assert unreadable(tmp_path, name, WRITERS[name](faces=())) != ""


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("corners", [((0, 0, 0),) * 4, tuple((0.1 * at, 0.2 * at, 0) for at in range(4))])
def test_a_mesh_without_an_area(name, corners, tmp_path):
    fault = unreadable(tmp_path, name, WRITERS[name](corners=corners))
    assert "has no area: all its corners lie within 0.001 mm of one line" in fault or "can't be read" in fault


@pytest.mark.parametrize("name", WRITERS)
@pytest.mark.parametrize("far", [2e5, 1e12, 1e15, 1e30])
def test_a_corner_that_is_far_away(name, far, tmp_path):
    """A corner that is too far away is refused. (A hull of corners that are 1e15 m apart crashed the
    process.)
    """
    corners = (*CORNERS[:3], (0.0, 0.0, far))
    assert re.search(r"has a corner \S+ m from its origin, but at most 100,000 m are allowed",
        unreadable(tmp_path, name, WRITERS[name](corners=corners)))  # fmt: skip
    assert unreadable(tmp_path, name, WRITERS[name](), scale=1e15).startswith("has a corner")


def test_a_text_stl_may_have_any_lines_and_names(tmp_path):
    content = stl_text().replace(b"solid a", b"solid facet vertex endfacet")
    assert unreadable(tmp_path, "a.stl", content) == ""
    head, _, rest = content.partition(b"\n")
    body, end, name = rest.partition(b"endsolid")
    one_line = head + b"\n" + body.replace(b"\n", b" ") + b"\n" + end + name
    assert unreadable(tmp_path, "a.stl", one_line) == ""
    assert "cut off" in unreadable(tmp_path, "a.stl", one_line[: len(one_line) // 2])


def test_faces_of_corners_by_another_name_are_left_to_the_reader_of_meshes():
    """Faces in a form that this check doesn't know aren't faults. The reader of meshes decides."""
    content = dae().replace(b'semantic="VERTEX" source="#v"', b'semantic="VERTEX" source="#w"')
    assert mesh_fault(".dae", content) == ""


def test_strips_of_a_ply_are_not_left_out_in_silence(tmp_path):
    content = ply().replace(b"element face", b"element tristrips")
    assert unreadable(tmp_path, "a.ply", content) == "has strips of triangles, which aren't read here"


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(list(WRITERS)), st.data())
def test_a_changed_file_is_read_or_refused(tmp_path, name, data):
    content = bytearray(WRITERS[name]())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        if data.draw(st.booleans()):
            content[at] = data.draw(st.one_of(st.integers(0, 255), st.sampled_from(b"0123456789-. eE\n")))
        else:
            del content[at : at + data.draw(st.integers(1, 9))]
        content = content or bytearray(b" ")
    unreadable(tmp_path, name, bytes(content))  # a crash would end the tests


def arm(tmp_path: Path, name: str, content: bytes) -> Path:
    """Return the folder of INDUSTRIAL6 with a mesh as the shape of its first link."""
    folder = tmp_path / "arm"
    shutil.copytree(stdlib_folder() / "robots" / "industrial6", folder)
    urdf = folder / "industrial6.urdf"
    box = '<geometry><box size="0.3 0.4 0.5"/></geometry>\n    </collision>'
    mesh = f'<geometry><mesh filename="{name}"/></geometry>\n    </collision>'
    text = urdf.read_text()
    assert text.count(box) == 1
    urdf.write_text(text.replace(box, mesh))
    (folder / name).write_bytes(content)
    return folder


def test_a_hand_written_robot_names_file_link_and_fault(tmp_path):
    folder = arm(tmp_path, "b.ply", ply_binary(faces=((0, 1, 2), (0, 1, 900))))
    (finding,) = scene_of(load_robot(str(folder)).value, None).diagnostics
    assert finding.code == "Y0904"
    assert finding.message == "the mesh b.ply of link_1 has a face with the corner 900, but 4 corners"
    checked = CliRunner().invoke(main, ["robot", "check", str(folder)])
    assert checked.exit_code == 1
    assert "Y0904: the mesh b.ply of link_1 has a face with the corner 900, but 4 corners" in checked.output
    program = tmp_path / "a.yarc"
    program.write_text(f'ROBOT "{folder}"\nP0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\n')
    ran = CliRunner().invoke(yarcc, [str(program)])
    assert ran.exit_code == 1
    assert ran.output.count("Y0904") == 1


def test_a_flat_mesh_is_named_and_still_collides(tmp_path):
    flat = (*CORNERS[:3], (0.1, 0.1, 0.0))
    folder = arm(tmp_path, "flat.stl", stl(flat, ((0, 1, 2), (1, 3, 2))))
    robot = load_robot(str(folder)).value
    assert "link_1" in [body.name for body in scene_of(robot, None).value.bodies]
    checked = CliRunner().invoke(main, ["robot", "check", str(folder)]).output
    assert (
        "flat meshes: the mesh flat.stl of link_1 is flat, so the collision check ignores its thickness"
        in checked
    )


def new(tmp_path: Path, name: str, content: bytes):
    """Run `yarc robot new` with an arm that has a mesh."""
    (tmp_path / name).write_bytes(content)
    (tmp_path / "a.urdf").write_text(
        '<robot name="a"><link name="base"/><link name="l"><collision><geometry><mesh '
        f'filename="{name}"/></geometry></collision></link><joint name="j" type="revolute"><parent '
        'link="base"/><child link="l"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" '
        'effort="1"/></joint></robot>'
    )
    arguments = ["robot", "new", str(tmp_path / "a.urdf"), "-o", str(tmp_path / "made"), "--yes"]
    return CliRunner().invoke(main, arguments)


def test_a_new_robot_names_a_flat_mesh(tmp_path):
    made = new(tmp_path, "flat.stl", stl(faces=((0, 1, 2),)))
    assert made.exit_code == 0, made.output
    assert (
        "note: the mesh flat.stl of l is flat: the collision check treats it as having no thickness"
        in made.output
    )


def test_a_new_robot_with_a_mesh_that_can_not_be_read_is_not_written(tmp_path):
    made = new(tmp_path, "line.stl", stl(tuple((0.1 * at, 0.0, 0.0) for at in range(4))))
    assert made.exit_code == 1
    assert "Y0904" in made.output
    assert "line.stl of l has no area" in made.output
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    "corner", ["v .5 0 0", "v 0 .5 0", "v 0 0 .5", "V 0.5 0 0", "v 0.5 0", "v 0.5", " v 0.5 0 0", "v 0.5 a 0",
        ("v 0.5 0 \\\n"
        ".5")]
)  # fmt: skip
def test_a_corner_that_coals_reader_loses_is_refused(corner, tmp_path):
    """Coal's reader skips such a corner without counting it, so faces would use the wrong corners."""
    text = f"{corner}\nv 0 1 0\nv 0 0 1\nv 9 9 9\nf 1 2 3\nf 2 3 1\n"
    assert "which readers skip" in mesh_fault(".obj", text.encode())
    path = tmp_path / "a.obj"
    path.write_text(text)
    with pytest.raises(UnreadableError, match="which readers skip"):
        geometry_of(Mesh(path, 1.0, ""), hull=True)


@pytest.mark.parametrize(
    "corner", ["v -.5 0 0", "v 5. 0 0", "v +0.5 0 -.5e-3", "v\t0.5\t0 0 ", "v 0.5 0 0 # a", "v 0.5 0 0 1 1 1",
        ("v 0.5 \\\n"
        " 0 0"), "v 0.5 0 0\r"]
)  # fmt: skip
def test_other_ways_to_write_a_corner_are_read(corner, tmp_path):
    text = f"{corner}\nv 0 1 0\nv 0 0 1\nv 9 9 9\nf 1 2 3\nf 2 3 1\n"
    assert mesh_fault(".obj", text.encode()) == ""
    path = tmp_path / "a.obj"
    path.write_text(text)
    assert geometry_of(Mesh(path, 1.0, ""), hull=True).half.max() <= 2.5


@pytest.mark.parametrize("face", [" f 1 2 4", "\tf 1 2 4", "F 1 2 4", " fo 1 2 4"])
def test_a_face_that_coals_reader_skips_is_refused(face):
    text = f"v 0.5 0 0\nv 0 1 0\nv 0 0 1\nv 9 9 9\nf 1 2 3\n{face}\n"
    assert "which readers skip" in mesh_fault(".obj", text.encode())
