"""Tests of large meshes as obstacles: they are divided into tiles, which are examined only where necessary,
and cached.
"""

import hashlib
import multiprocessing
import os

import coal
import numpy as np
import pytest
from collision.test_large_stl import closed_scan, scan
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.floors import exercises
from yarclang import files
from yarclang.cell.model import Cell, Mount, Obstacle
from yarclang.collision import geometry
from yarclang.collision.bodies import Scene
from yarclang.collision.free import free_space, gaps
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.scene import scene_of
from yarclang.collision.tiles import TILE, TiledMesh, in_order
from yarclang.meshes import kept as keeping
from yarclang.robot.description import load_robot
from yarclang.shapes import Box, Mesh
from yarclang.signing import own_secret, signature
from yarclang.source import SourceFile


def mesh(folder, content, name="part.stl"):
    path = folder / name
    path.write_bytes(content)
    return Mesh(path, 1e-3, hashlib.sha256(content).hexdigest())


def as_ply(content):
    records = np.frombuffer(content, np.dtype([("n", "<f4", 3), ("c", "<f4", 9), ("m", "<u2")]), offset=84)
    corners = records["c"].reshape(-1, 3)
    head = (
        "ply\n"
        "format binary_little_endian 1.0\n"
        f"element vertex {len(corners)}\n"
        "property float x\n"
        "property float y\n"
        "property float z\n"
    )
    head += f"element face {len(records)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = np.zeros(len(records), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, np.arange(len(corners)).reshape(-1, 3)
    return head.encode() + corners.astype("<f4").tobytes() + rows.tobytes()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Fixture: the folder in which cache entries are stored."""
    monkeypatch.setenv(files.CACHE, str(tmp_path / "cache"))
    return tmp_path / "cache" / "meshes"


@exercises(apart=0.3, inside=0.05)
@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_distance_is_that_of_all_triangles(tally, seed):
    """Property: whatever tiles are examined, distance and normal equal those of a single tree of all
    triangles in coal.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 4 * TILE))
    middles = rng.normal(size=(count, 1, 3)) * rng.choice([0.05, 0.3], 3)
    triangles = middles + rng.normal(size=(count, 3, 3)) * 0.01
    corners = triangles.reshape(-1, 3)
    faces = in_order(corners, np.arange(3 * count).reshape(-1, 3))
    assert np.array_equal(np.sort(faces, axis=0), np.arange(3 * count).reshape(-1, 3))
    tiled = TiledMesh(corners, faces)
    edges = rng.uniform(0.01, 0.1, 3)
    box, turn = coal.Box(*edges), Rotation.random(random_state=seed % 2**31).as_matrix()
    shift = rng.normal(size=3) * 0.4
    pose, request, answer = coal.Transform3s(turn, shift), coal.DistanceRequest(), coal.DistanceResult()
    exact = coal.distance(tiled.whole(), coal.Transform3s(), box, pose, request, answer)
    found, normal = tiled.distance(box, pose, (shift, float(np.linalg.norm(edges)) / 2.0), request)
    tally.count("apart", exact > 1e-6)
    tally.count("inside", exact <= 1e-6)
    if exact > 1e-6:
        assert found == pytest.approx(exact, abs=1e-12)
        assert normal @ answer.normal == pytest.approx(1.0, abs=1e-6)
    else:
        assert found <= 1e-6


def test_a_mesh_that_is_far_away_costs_no_tree(tmp_path, folder):
    solid = geometry_of(mesh(tmp_path, scan(30_000))).solid
    assert isinstance(solid, TiledMesh)
    box = coal.Box(0.01, 0.01, 0.01)
    at = np.array([5.0, 0.0, 0.0])
    solid.distance(box, coal.Transform3s(np.eye(3), at), (at, 0.01), coal.DistanceRequest())
    assert solid.built < 4


@pytest.mark.parametrize("made", [scan, closed_scan])
@pytest.mark.parametrize("form", ["stl", "ply"])
def test_a_scene_has_the_same_distances_as_with_one_tree(made, form, tmp_path, folder, monkeypatch):
    content = made(30_000)
    shape = mesh(tmp_path, content) if form == "stl" else mesh(tmp_path, as_ply(content), "part.ply")
    robot = load_robot("INDUSTRIAL6").value
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (20, robot.size)) + robot.home

    def look():
        scenes = []
        for on_flange, at in ((False, [0.6, 0.6, 0.9]), (True, [0.0, 0.0, 0.2])):
            pose = np.eye(4)
            pose[:3, 3] = at
            body = Obstacle("PART", shape, Mount(pose, on_flange), 0.0)
            box = Obstacle("BOX", Box(np.array([0.3, 0.3, 0.3])), Mount(_at(0.9, 0.3, 0.9), False), 0.0)
            scenes.append(
                scene_of(robot, Cell(SourceFile("", ""), {}, {}, {}, {}, (body, box), (), {})).value
            )
        geometry_module_cache_clear()
        return [all_distances(scene, q) for scene in scenes]

    quick = look()
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    for one, other in zip(quick, look(), strict=True):
        np.testing.assert_allclose(np.maximum(one[0], 0.0), np.maximum(other[0], 0.0), atol=1e-8)
        assert (one[0] < 0.0).any() or (one[0] > 0.0).all()
        np.testing.assert_array_equal(one[0] > 1e-6, other[0] > 1e-6)
        apart = one[0] > 1e-3
        np.testing.assert_allclose(one[1][apart], other[1][apart], atol=1e-4)


def geometry_module_cache_clear():
    from yarclang.collision import scene

    scene.geometries.cache_clear()


def _at(*xyz):
    pose = np.eye(4)
    pose[:3, 3] = xyz
    return pose


def all_distances(scene: Scene, q):
    count, pairs = len(q), len(scene.pairs.first)
    at, pair = np.repeat(np.arange(count), pairs), np.tile(np.arange(pairs), count)
    normal = np.zeros((len(pair), 3))
    return distances(scene, pair, relative(place(scene, q), at, pair), normal=normal), normal


def test_it_is_kept_once_and_is_the_same(tmp_path, folder, monkeypatch):
    shape = mesh(tmp_path, closed_scan(30_000))
    first = geometry_of(shape)
    (entry,) = folder.iterdir()
    monkeypatch.setattr(geometry, "_prepared", lambda _: pytest.fail("prepared again"))
    again = geometry_of(shape)
    np.testing.assert_array_equal(again.solid.corners, first.solid.corners)
    np.testing.assert_array_equal(again.solid.faces, first.solid.faces)
    np.testing.assert_array_equal(again.skin, first.skin)
    assert entry.stat().st_mode & 0o077 == 0 or folder.stat().st_mode & 0o077 == 0


def test_another_content_is_another_mesh(tmp_path, folder):
    first = geometry_of(mesh(tmp_path, scan(30_000)))
    other = geometry_of(mesh(tmp_path, scan(30_000, seed=1)))
    assert len([*folder.iterdir()]) == 2
    assert not np.array_equal(first.solid.corners, other.solid.corners)
    large = geometry_of(Mesh(tmp_path / "part.stl", 1.0, mesh(tmp_path, scan(30_000, seed=1)).digest))
    np.testing.assert_allclose(large.half, other.half * 1000.0)


DAMAGES = {
    "a byte": lambda content: content[:5000] + bytes([content[5000] ^ 1]) + content[5001:],
    "its closedness": lambda content: content[:64] + bytes([content[64] ^ 1]) + content[65:],
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "longer": lambda content: content + b"x",
    "another": lambda content: b"something else" * 1000,
}


@pytest.mark.parametrize("how", DAMAGES)
def test_a_damaged_entry_is_prepared_anew(how, tmp_path, folder):
    shape = mesh(tmp_path, closed_scan(30_000))
    first = geometry_of(shape)
    (entry,) = folder.iterdir()
    sound = entry.read_bytes()
    entry.write_bytes(DAMAGES[how](sound))
    again = geometry_of(shape)
    np.testing.assert_array_equal(again.skin, first.skin)
    assert entry.read_bytes() == sound


def test_an_entry_of_another_mesh_is_not_taken(tmp_path, folder):
    """Renamed entries aren't used: each entry contains the identity of its mesh."""
    one = mesh(tmp_path, closed_scan(30_000), "one.stl")
    other = mesh(tmp_path, closed_scan(30_000, seed=5), "other.stl")
    geometry_of(one)
    (entry,) = folder.iterdir()
    geometry_of(other)
    (second,) = [path for path in folder.iterdir() if path != entry]
    wanted = geometry_of(other).solid.corners
    second.write_bytes(entry.read_bytes())
    np.testing.assert_array_equal(geometry_of(other).solid.corners, wanted)


def test_without_a_folder_it_works_all_the_same(tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("no folder")
    shape = mesh(tmp_path, scan(30_000))
    for given_ in (str(blocked), ""):
        monkeypatch.setenv(files.CACHE, given_)
        assert isinstance(geometry_of(shape).solid, TiledMesh)
    assert blocked.read_text() == "no folder"


def test_the_folder_stays_bounded(tmp_path, folder, monkeypatch):
    shapes = [mesh(tmp_path, scan(30_000, seed), f"{seed}.stl") for seed in range(4)]
    geometry_of(shapes[0])
    (entry,) = folder.iterdir()
    monkeypatch.setattr(keeping, "MOST_BYTES", 2 * entry.stat().st_size + 100)
    geometry_of(shapes[1])
    os.utime(entry, (1, 1))  # the least recently used entry
    geometry_of(shapes[2])
    assert not entry.exists()
    assert len([*folder.iterdir()]) == 2


def _look(path, digest):
    return float(geometry_of(Mesh(path, 1e-3, digest)).half.sum())


def test_several_processes_may_keep_the_same(tmp_path, folder):
    shape = mesh(tmp_path, scan(30_000))
    with multiprocessing.get_context("spawn").Pool(3) as pool:
        found = pool.starmap(_look, [(shape.path, shape.digest)] * 6)
    assert len(set(found)) == 1
    assert len([*folder.iterdir()]) == 1


def test_a_damaged_file_is_told_as_before(tmp_path, folder):
    content = as_ply(scan(30_000))
    with pytest.raises(UnreadableError):
        geometry_of(mesh(tmp_path, content[: len(content) // 2], "part.ply"))
    assert not folder.exists() or not [*folder.iterdir()]


def test_single_positions_are_free_as_with_one_tree(tmp_path, folder, monkeypatch):
    """Joint positions that a search finds free are free of all triangles."""
    shape = mesh(tmp_path, scan(30_000))
    robot = load_robot("INDUSTRIAL6").value
    body = Obstacle("PART", shape, Mount(_at(0.0, 0.9, 1.1), False), 0.02)
    q = np.random.default_rng(3).uniform(-0.8, 0.8, (60, robot.size)) + robot.home

    def look():
        geometry_module_cache_clear()
        scene = scene_of(robot, Cell(SourceFile("", ""), {}, {}, {}, {}, (body,), (), {})).value
        space = free_space(scene)
        return [space.has(one) for one in q], [bool((gaps(scene, one) > 1e-5).all()) for one in q]

    quick, exact = look()
    assert quick == exact
    assert 5 < sum(quick) < 55
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    assert look()[1] == exact


def sealed(key, payload, secret=None):
    return keeping._MAGIC + signature(secret or own_secret(), (key.encode(), payload)) + payload


def read_entry(entry, key, secret):
    payload = keeping._payload(entry, key, secret)
    return None if payload is None else keeping._mesh(payload)


@pytest.mark.parametrize(
    "payload",
    [
        np.array([10**15, 4, 1]).tobytes(),
        np.array([-1, -1, 0]).tobytes() + bytes(100),
        np.array([1, 1, 0]).tobytes() + bytes(24) + np.array([0, 0, 7], "<i4").tobytes(),
        np.array([1, 1, 0]).tobytes() + bytes(24) + np.array([0, 0, -1], "<i4").tobytes(),
        b"",
    ],
)
def test_a_forged_entry_ends_nothing(payload, tmp_path, folder):
    """An entry with a valid seal but wrong content is made again."""
    shape = mesh(tmp_path, scan(30_000))
    first = geometry_of(shape)
    (entry,) = folder.iterdir()
    key = f".stl {shape.digest} {shape.unit!r} 1.0 1.0 1.0"
    assert read_entry(entry, key, own_secret()) is not None
    entry.write_bytes(sealed(key, payload))
    assert read_entry(entry, key, own_secret()) is None
    np.testing.assert_array_equal(geometry_of(shape).solid.corners, first.solid.corners)


def test_an_entry_of_somebody_else_is_prepared_anew(tmp_path, folder):
    """An entry that another user has written is made again: with a triangle missing, it would hide a part of
    an obstacle.
    """
    shape = mesh(tmp_path, scan(30_000))
    first = geometry_of(shape)
    (entry,) = folder.iterdir()
    key = f".stl {shape.digest} {shape.unit!r} 1.0 1.0 1.0"
    known = read_entry(entry, key, own_secret())
    fewer = keeping._entry(
        key, keeping._written(keeping.Prepared(known.corners, known.faces[:-1], known.closed)), b"x" * 32
    )
    entry.write_bytes(fewer)
    assert read_entry(entry, key, b"x" * 32) is not None
    assert read_entry(entry, key, own_secret()) is None
    geometry_module_cache_clear()
    assert len(geometry_of(shape).solid.faces) == len(first.solid.faces)


def test_a_killed_writer_leaves_nothing_for_ever(tmp_path, folder, monkeypatch):
    geometry_of(mesh(tmp_path, scan(30_000), "one.stl"))
    (entry,) = folder.iterdir()
    left = folder / f".{entry.name}.abc"
    left.write_bytes(bytes(3 * entry.stat().st_size))
    os.utime(left, (1, 1))
    monkeypatch.setattr(keeping, "MOST_BYTES", 3 * entry.stat().st_size)
    geometry_of(mesh(tmp_path, scan(30_000, seed=1), "two.stl"))
    assert not left.exists()
    assert entry.exists()
