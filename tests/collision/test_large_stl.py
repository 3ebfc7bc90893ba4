"""Tests of large STL files and their hulls: the body is the same as with coal's reader, and reading is much
faster.
"""

import time
from collections import Counter

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.collision import geometry
from yarclang.collision.geometry import UnreadableError, geometry_of
from yarclang.shapes import Mesh

TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", 9), ("more", "<u2")])


def scan(triangles, seed=0):
    """Return an uneven, bent body of many triangles [mm], as a binary STL."""
    rng = np.random.default_rng(seed)
    side = int((triangles / 2) ** 0.5)
    up, around = np.meshgrid(
        np.linspace(0, np.pi, side + 1), np.linspace(0, 2 * np.pi, side + 1), indexing="ij"
    )
    radius = 100 * (1 + 0.05 * np.sin(7 * up) * np.cos(5 * around) + 0.01 * rng.random(up.shape))
    across = radius * np.sin(up)
    at = np.stack([across * np.cos(around), 0.3 * across * np.sin(around), 3 * radius * np.cos(up)], axis=-1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    rows = np.concatenate([np.stack(three, axis=2).reshape(-1, 9) for three in ((a, b, c), (a, c, d))])
    records = np.zeros(len(rows), TRIANGLE)
    records["corners"] = rows
    return bytes(80) + len(rows).to_bytes(4, "little") + records.tobytes()


def mesh(folder, content, scale=(1.0, 1.0, 1.0)):
    path = folder / "part.stl"
    path.write_bytes(content)
    return Mesh(path, 1e-3, "", scale)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (-1.0, 2.0, 0.5)])
def test_the_hull_is_that_of_coals_reader(scale, tmp_path, monkeypatch):
    shape = mesh(tmp_path, scan(30_000), scale)
    assert shape.path.stat().st_size >= geometry._LARGE
    quick = geometry_of(shape, hull=True)
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    slow = geometry_of(shape, hull=True)
    np.testing.assert_array_equal(quick.middle, slow.middle)
    np.testing.assert_array_equal(quick.half, slow.half)
    ways = np.random.default_rng(1).normal(size=(1000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    farthest = [(ways @ one.corners.T).max(axis=1) for one in (quick, slow)]
    np.testing.assert_allclose(*farthest, atol=1e-12)
    assert len(quick.corners) > 100


def test_all_corners_of_the_file_are_within_the_hull(tmp_path):
    content = scan(30_000, 3)
    found = geometry_of(mesh(tmp_path, content), hull=True)
    corners = (
        np.frombuffer(content, TRIANGLE, offset=84)["corners"].reshape(-1, 3).astype(float) * 1e-3
        - found.middle
    )
    ways = np.random.default_rng(2).normal(size=(500, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    assert ((ways @ found.corners.T).max(axis=1) >= (ways @ corners.T).max(axis=1) - 1e-12).all()


def closed_scan(triangles, seed=0):
    """Return the body of `scan` without a seam: corners that nearly coincide at poles and seam are made
    equal.
    """
    content = scan(triangles, seed)
    records = np.frombuffer(content, TRIANGLE, offset=84).copy()
    side = int((triangles / 2) ** 0.5)
    at = records["corners"].reshape(2, side, side, 3, 3)
    ring, pole = at[0, :, 0, 0].copy(), at[0, 0, 0, 0].copy()
    # The corners of a grid cell are a, b (next in `up`), c (next in both directions) and d (next in
    # `around`); its triangles are a b c and a c d. At the seam, c and d of the last cells become b and a of
    # the first ones.
    at[0, :, -1, 2], at[1, :, -1, 1] = at[0, :, 0, 1], at[0, :, 0, 1]
    at[1, :, -1, 2] = ring
    for half, corner in ((0, 0), (1, 0), (1, 2)):
        at[half, 0, :, corner] = pole
    bottom = at[0, -1, 0, 1].copy()
    for half, corner in ((0, 1), (0, 2), (1, 1)):
        at[half, -1, :, corner] = bottom
    return content[:84] + records.tobytes()


@pytest.mark.parametrize("made", [scan, closed_scan])
def test_the_triangles_are_those_of_coals_reader(made, tmp_path, monkeypatch):
    import coal

    shape = mesh(tmp_path, made(30_000), (-1.0, 2.0, 0.5))
    assert shape.path.stat().st_size >= geometry._LARGE
    quick = geometry_of(shape)
    monkeypatch.setattr(geometry, "_LARGE", 10**9)
    slow = geometry_of(shape)
    assert (quick.skin is None) is (slow.skin is None) is (made is scan)
    assert quick.is_hollow
    assert quick.of_coal.num_tris == slow.of_coal.num_tris
    assert quick.of_coal.num_vertices == slow.of_coal.num_vertices
    np.testing.assert_array_equal(quick.middle, slow.middle)
    np.testing.assert_array_equal(quick.half, slow.half)
    corners = [np.unique(np.asarray(one.of_coal.vertices()), axis=0) for one in (quick, slow)]
    np.testing.assert_allclose(*corners, atol=1e-12)
    if quick.skin is not None:
        whole = [one.skin.sum(axis=1)[np.lexsort(one.skin.sum(axis=1).round(9).T)] for one in (quick, slow)]
        np.testing.assert_allclose(*whole, atol=1e-8)
    ball, here, there = coal.Sphere(0.01), coal.Transform3s(), coal.Transform3s()
    request, answer = coal.DistanceRequest(), coal.DistanceResult()
    for place in np.random.default_rng(4).normal(size=(100, 3)) * 0.3:
        there.setTransform(np.eye(3), place)
        found = []
        for one in (quick, slow):
            answer.clear()
            found.append(coal.distance(one.of_coal, here, ball, there, request, answer))
        assert found[0] == pytest.approx(found[1], abs=1e-9)


@exercises(closed=0.2, open=0.2)
@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_a_mesh_is_closed_where_every_edge_has_an_even_number_of_triangles(tally, seed):
    rng = np.random.default_rng(seed)
    bodies = []
    for _ in range(int(rng.integers(1, 4))):  # tetrahedra, some of whose corners may coincide
        corners = rng.integers(0, 3, (4, 3)).astype(float) * rng.choice([1.0, -1.0, 0.0], 3)
        bodies.append(corners[[[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]])
    triangles = np.concatenate(bodies)
    if rng.random() < 0.5:
        triangles = triangles[rng.random(len(triangles)) < 0.9]
    if not len(triangles):
        return
    # Triangles may have their own corners, or share them.
    corners, faces = triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    if rng.random() < 0.5:
        corners, of = np.unique(corners, axis=0, return_inverse=True)
        faces = of.reshape(-1, 3)
    edges = Counter()
    for face in triangles:
        named = [tuple((one + 0.0).tolist()) for one in face]
        edges.update(frozenset(pair) for pair in (named[:2], named[1:], named[::2]))
    expected = all(count % 2 == 0 for count in edges.values())
    assert geometry._is_closed(corners, faces) is expected
    tally.count("closed", expected)
    tally.count("open", not expected)


def test_a_million_triangles_that_are_no_hull_take_seconds(tmp_path):
    shape = mesh(tmp_path, scan(1_000_000))
    begun = time.process_time()
    geometry_of(shape)
    assert time.process_time() - begun < 12


def test_sixty_megabytes_take_seconds(tmp_path):
    shape = mesh(tmp_path, scan(1_200_000))
    begun = time.process_time()
    geometry_of(shape, hull=True)
    assert time.process_time() - begun < 8


def damaged(content, row, value):
    records = np.frombuffer(content, TRIANGLE, offset=84).copy()
    records["corners"][row, 4] = value
    return content[:84] + records.tobytes()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda content: damaged(content, 500, np.nan), "isn't a finite number"),
        (lambda content: damaged(content, 500, 3e9), "from its origin"),
        (lambda content: content[:-1000], "bytes"),
    ],
)
def test_a_large_one_that_is_damaged_is_refused_all_the_same(change, words, tmp_path):
    with pytest.raises(UnreadableError, match=words):
        geometry_of(mesh(tmp_path, change(scan(30_000))), hull=True)


def test_a_large_plate_without_thickness_stays_flat(tmp_path):
    records = np.frombuffer(scan(30_000), TRIANGLE, offset=84).copy()
    records["corners"][:, [2, 5, 8]] = 0.0
    content = bytes(80) + len(records).to_bytes(4, "little") + records.tobytes()
    assert geometry_of(mesh(tmp_path, content), hull=True).is_hollow


@pytest.mark.parametrize("around", [300, 1000])
def test_the_tip_of_a_fine_cone_is_covered(tmp_path, around):
    """A corner with hundreds of neighbours, as on turned parts, for which coal makes no hull. The body that
    is used instead contains all corners, and is hardly larger.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    rim = np.stack((30.0 * np.cos(turn), 30.0 * np.sin(turn), np.zeros(around)), axis=1)
    tip = np.tile([0.0, 0.0, 80.0], (around, 1))
    faces = np.stack((rim, np.roll(rim, -1, axis=0), tip), axis=1)
    rows = np.zeros(around, dtype=[("normal", "<3f4"), ("corners", "<(3,3)f4"), ("more", "<u2")])
    rows["corners"] = faces
    shape = mesh(tmp_path, bytes(80) + around.to_bytes(4, "little") + rows.tobytes())
    made = geometry_of(shape, hull=True)
    ways = np.random.default_rng(around).normal(size=(2000, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    own = (rows["corners"].reshape(-1, 3).astype(float) / 1000.0 @ ways.T).max(axis=0)
    larger = ((made.corners + made.middle) @ ways.T).max(axis=0) - own
    assert larger.min() >= 0.0
    assert larger.max() <= 0.002
