"""Tests of point clouds: they become closed meshes that contain every point.

The files are PCD and PLY in all forms, and damaged ones.
"""

import struct
from contextlib import suppress

import numpy as np
import pytest
from click.testing import CliRunner
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.cli.yarc import main
from yarclang.collision.geometry import geometry_of
from yarclang.convert import cloud
from yarclang.meshes.pcd import _FaultError, _unpacked, pcd_points
from yarclang.meshes.ply import ply_points
from yarclang.meshes.voxels import TooMany, voxels_of
from yarclang.shapes import Mesh


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def drawn(seed, count=200):
    return np.random.default_rng(seed).normal(size=(count, 3)).astype(np.float32).astype(float)


HEAD = (
    "# .PCD v0.7 - Point Cloud Data file format\n"
    "VERSION 0.7\n"
    "FIELDS intensity x y z normal\n"
    "SIZE 1 4 4 4 4\n"
    "TYPE U F F F F\n"
    "COUNT 1 1 1 1 3\n"
    "WIDTH {n}\n"
    "HEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\n"
    "POINTS {n}\n"
    "DATA {form}\n"
)
ROW = np.dtype([("i", "<u1"), ("p", "<f4", 3), ("n", "<f4", 3)])


def rows(points):
    found = np.zeros(len(points), ROW)
    found["i"], found["p"], found["n"] = 7, points, 0.5
    return found


def packed(plain):
    """Return bytes in LZF, with back references only for repeated bytes."""
    found, at = bytearray(), 0
    while at < len(plain):
        run = 1
        while (
            at and at + run <= len(plain) and run < 262 and plain[at : at + run] == (plain[at - 1 : at] * run)
        ):
            run += 1
        run -= 1
        if at and run >= 3:
            length = run - 2
            found += bytes([length << 5, 0]) if length < 7 else bytes([7 << 5, length - 7, 0])
            at += run
        else:
            piece = plain[at : at + 5]
            found += bytes([len(piece) - 1]) + piece
            at += len(piece)
    return bytes(found)


def pcd(points, form):
    head = HEAD.format(n=len(points), form=form).encode()
    found = rows(points)
    if form == "ascii":
        lines = (" ".join(map(repr, [7, *one.tolist(), 0.5, 0.5, 0.5])) for one in points)
        return head + "\n".join(lines).encode() + b"\n"
    if form == "binary":
        return head + found.tobytes()
    plain = b"".join(
        np.ascontiguousarray(part).tobytes() for part in (found["i"], *found["p"].T, *found["n"].T)
    )
    small = packed(plain)
    return head + struct.pack("<II", len(small), len(plain)) + small


def ply(points, form):
    head = (
        "ply\n"
        f"format {form} 1.0\n"
        f"element vertex {len(points)}\n"
        "property uchar red\n"
        "property float x\n"
        "property float y\n"
        "property float z\n"
        "end_header\n"
    ).encode()
    if form == "ascii":
        return head + "\n".join(" ".join(map(repr, [9, *one.tolist()])) for one in points).encode()
    order = "<" if "little" in form else ">"
    kind = np.dtype([("r", "u1"), ("p", f"{order}f4", 3)])
    found = np.zeros(len(points), kind)
    found["p"] = points
    return head + found.tobytes()


@pytest.mark.parametrize("form", ["ascii", "binary", "binary_compressed"])
@pytest.mark.parametrize("count", [1, 200])
def test_pcd_files_of_all_forms_have_their_points(form, count):
    points = drawn(1, count)
    points[0] = points[0, 0]
    np.testing.assert_array_equal(pcd_points(pcd(points, form)), points)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_files_of_all_forms_have_their_points(form):
    points = drawn(2)
    np.testing.assert_array_equal(ply_points(ply(points, form)), points)


@given(st.binary(max_size=600), st.integers(1, 9))
def test_what_is_packed_is_unpacked(plain, times):
    plain = plain * times
    assert _unpacked(packed(plain), len(plain)) == plain


@given(st.binary(max_size=200), st.integers(0, 5000))
def test_any_bytes_are_unpacked_or_refused(content, size):
    with suppress(_FaultError):
        assert len(_unpacked(content, size)) == size


@exercises(read=0.05, refused=0.3)
@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_damaged_file_is_read_or_refused_in_words(tally, seed):
    rng = np.random.default_rng(seed)
    form = ["ascii", "binary", "binary_compressed"][seed % 3]
    content = bytearray(pcd(drawn(seed, 20), form))
    for _ in range(int(rng.integers(1, 4))):
        match int(rng.integers(0, 4)):
            case 0:
                content = content[: int(rng.integers(0, len(content) + 1))]
            case 1 if content:
                content[int(rng.integers(0, len(content)))] = int(rng.integers(0, 256))
            case 2:
                at = int(rng.integers(0, len(content) + 1))
                content[at:at] = rng.bytes(3)
            case _:
                at = int(rng.integers(0, len(content) + 1))
                del content[at : at + 3]
    found = pcd_points(bytes(content))
    if isinstance(found, str):
        assert found
        assert len(found) < 300
    else:
        assert found.shape[1] == 3
    tally.count("read", not isinstance(found, str))
    tally.count("refused", isinstance(found, str))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            ("FIELDS intensity x y z normal", "FIELDS intensity x y w normal"),
            "without exactly one x, y and z",
        ),
        (("FIELDS intensity x y z normal", "FIELDS x x y z normal"), "without exactly one x, y and z"),
        (("COUNT 1 1 1 1 3", "COUNT 1 2 1 1 2"), "without exactly one x, y and z"),
        (("SIZE 1 4 4 4 4", "SIZE 1 4 4 4"), "don't match"),
        (("SIZE 1 4 4 4 4", "SIZE 1 4 4 3 4"), "a type that PCD doesn't have"),
        (("POINTS 3", "POINTS 4"), "has 21 numbers instead of the 28 of 4 points"),
        (("POINTS 3", "POINTS -3"), "how many POINTS"),
        (("VIEWPOINT 0 0 0 1", "VIEWPOINT 0 0 1 1"), "has a VIEWPOINT other than"),
        (("VIEWPOINT 0 0 0 1", "VIEWPOINT 0 0 x 1"), "has a VIEWPOINT other than"),
        (("DATA ascii", "DATA lzma"), "no header"),
    ],
)
def test_a_wrong_header_is_refused(change, words):
    content = pcd(drawn(3, 3), "ascii").decode().replace(*change)
    if "COUNT 1 2" in content:
        content = content.replace("0.5\n", "0.5 0.5\n")
    assert words in pcd_points(content.encode())


def closed(triangles):
    """Return True if each edge belongs to an even number of triangles. Return None for large meshes, which
    aren't checked.
    """
    edges = np.sort(
        np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]).round(9), axis=1
    )
    keys = [tuple(sorted((tuple(a), tuple(b)))) for a, b in edges.tolist()]
    return all(keys.count(one) % 2 == 0 for one in set(keys)) if len(keys) < 3000 else None


@pytest.mark.parametrize(
    ("points", "triangles"),
    [
        ([[0.1, 0.1, 0.1]], 12),
        ([[0.1, 0.1, 0.1], [0.9, 0.2, 0.3]], 12),
        ([[0.1, 0.1, 0.1], [1.5, 0.2, 0.3]], 20),
        ([[0.1, 0.1, 0.1], [1.5, 1.2, 0.3]], 24),
        ([[0.1, 0.1, 0.1], [-0.5, -1.2, -0.3]], 24),
        ([[x + 0.5, y + 0.5, z + 0.5] for x in range(4) for y in range(4) for z in range(4)], 192),
    ],
)
def test_cubes_have_outer_faces_alone(points, triangles):
    made = voxels_of(np.array(points), 1.0, 1000)
    assert len(made.triangles) == triangles


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_all_points_are_in_a_closed_body_of_the_volume_of_its_cubes(seed):
    rng = np.random.default_rng(seed)
    edge = float(rng.uniform(0.01, 3.0))
    points = (
        rng.normal(size=(int(rng.integers(1, 12)), 3)) * rng.choice([0.1, 1.0, 5.0]) + rng.normal(size=3) * 50
    )
    made = voxels_of(points, edge, 1000)
    cubes = {tuple(np.floor(one / edge).astype(int).tolist()) for one in points}
    assert made.cubes == len(cubes)
    a, b, c = (made.triangles[:, at] - points[0] for at in range(3))
    # the volume is positive because all triangles face outwards
    volume = np.einsum("ti,ti->", a, np.cross(b, c)) / 6.0
    assert volume == pytest.approx(len(cubes) * edge**3, rel=1e-9)
    assert closed(made.triangles) is not False
    low, high = made.triangles.min(axis=(0, 1)), made.triangles.max(axis=(0, 1))
    assert (points >= low - 1e-9).all()
    assert (points <= high + 1e-9).all()


def test_cubes_without_numbers_are_refused():
    assert voxels_of(np.array([[0.0, 0.0, 0.0], [1e5, 1e5, 1e5]]), 1e-6, 1000) == TooMany(0)
    assert voxels_of(np.array([[1e5, 0.0, 0.0]]), 1e-300, 1000) == TooMany(0)


def test_no_more_triangles_are_made_than_asked_for():
    points = np.arange(30.0).reshape(10, 3)
    assert voxels_of(points, 1.0, 119) == TooMany(120)
    assert len(voxels_of(points, 1.0, 120).triangles) == 120


def invoked(*arguments):
    return CliRunner().invoke(main, ["import", *arguments])


@pytest.mark.parametrize(("name", "make"), [("hall.pcd", pcd), ("hall.ply", ply)])
def test_a_cloud_becomes_an_obstacle_that_is_solid(tmp_path, name, make):
    points = np.array([0.0, 0.8, 1.4]) + 0.3 * drawn(5, 400) / np.linalg.norm(drawn(5, 400), axis=1)[:, None]
    points[7] = np.nan
    (tmp_path / name).write_bytes(make(points, "ascii"))
    done = invoked(name, "--units", "m", "--voxel", "20")
    assert done.exit_code == 0, done.stderr
    assert "399 points (1 left out, which aren't numbers) in " in done.stdout
    made = geometry_of(Mesh(tmp_path / "hall.stl", 1e-3, ""))
    assert made.skin is not None
    import coal

    request, answer, here = coal.CollisionRequest(), coal.CollisionResult(), coal.Transform3s()
    for point in points[np.isfinite(points).all(axis=1)]:
        answer.clear()
        # a sphere that reaches beyond the cube around its point
        coal.collide(
            made.of_coal, here, coal.Sphere(0.0201), coal.Transform3s(np.eye(3), point), request, answer
        )
        assert answer.isCollision()
    (tmp_path / "c.toml").write_text(
        'units = "mm,deg,s"\n'
        "[[obstacles]]\n"
        'name = "SCAN"\n'
        'shape = "mesh"\n'
        'file = "hall.stl"\n'
        'units = "mm"\n'
        'frame = "B"\n'
    )
    (tmp_path / "p.yarc").write_text(
        "ROBOT INDUSTRIAL6\n"
        'CELL "c.toml"\n'
        "START -60 20 -20 0 -30 0 (deg)\n"
        "P0010 MOVEJ 60 20 -20 0 -30 0 [MIN] (deg,s)\n"
    )
    checked = CliRunner().invoke(main, ["check", "p.yarc"])
    assert "Y0901" in checked.output + checked.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["c.pcd", "--units", "m"], "--voxel MM"),
        (["c.pcd", "--voxel", "5"], "doesn't name its unit"),
        (["c.pcd", "--voxel", "5", "--units", "m,deg"], "doesn't name its unit"),
        (["c.pcd", "--voxel", "0", "--units", "m"], "positive"),
        (["c.pcd", "--voxel", "5", "--units", "m", "-o", "c.obj"], ".stl"),
        (
            ["c.pcd", "--voxel", "5", "--units", "m", "--robot", "INDUSTRIAL6"],
            "--robot: not for a point cloud",
        ),
        (["c.pcd", "--voxel", "5", "--units", "m", "--every", "2"], "--every: not for a point cloud"),
        (["t.csv", "--voxel", "5"], "--voxel is for point clouds"),
    ],
)
def test_wrong_usage(tmp_path, arguments, words):
    (tmp_path / "c.pcd").write_bytes(pcd(drawn(1), "ascii"))
    (tmp_path / "t.csv").write_text("j1\n1\n")
    done = invoked(*arguments)
    assert done.exit_code == 2
    assert words in done.stderr
    assert not (tmp_path / "c.stl").exists()


@pytest.mark.parametrize(
    ("content", "voxel", "code", "words"),
    [
        (None, "5", "Y0107", "can't be read"),
        (b"", "5", "Y1516", "no header"),
        (pcd(np.full((3, 3), np.nan), "ascii"), "5", "Y1516", "has no point"),
        (pcd(np.zeros((0, 3)), "binary"), "5", "Y1516", "has no point"),
        (pcd(np.array([[1e6, 0, 0]]), "ascii"), "5", "Y1516", "1e+06 m from its origin"),
        (pcd(drawn(1), "ascii"), "1e-9", "Y1517", "too small"),
    ],
)
def test_what_becomes_nothing_is_said(tmp_path, content, voxel, code, words):
    if content is not None:
        (tmp_path / "c.pcd").write_bytes(content)
    done = invoked("c.pcd", "--units", "m", "--voxel", voxel)
    assert done.exit_code == 1
    assert code in done.stderr
    assert words in done.stderr
    assert not (tmp_path / "c.stl").exists()


def test_too_many_triangles_are_refused_with_their_number(tmp_path, monkeypatch):
    monkeypatch.setattr(cloud, "MOST_TRIANGLES", 100)
    (tmp_path / "c.pcd").write_bytes(pcd(drawn(1), "ascii"))
    done = invoked("c.pcd", "--units", "m", "--voxel", "20")
    assert done.exit_code == 1
    assert "triangles, but at most 100 are allowed" in done.stderr


def test_nothing_is_overwritten_unasked(tmp_path):
    (tmp_path / "c.pcd").write_bytes(pcd(drawn(1), "binary"))
    (tmp_path / "c.stl").write_bytes(b"mine")
    assert invoked("c.pcd", "--units", "m", "--voxel", "20").exit_code == 2
    assert (tmp_path / "c.stl").read_bytes() == b"mine"
    assert invoked("c.pcd", "--units", "m", "--voxel", "20", "-o", "c.stl").exit_code == 0
    assert (tmp_path / "c.stl").read_bytes() != b"mine"
