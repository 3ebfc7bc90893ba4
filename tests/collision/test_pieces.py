"""Tests of meshes in convex pieces: the pieces contain each mesh, and the judge notices if they don't."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from tests.floors import exercises
from yarclang import files
from yarclang.certify.bodies.pieces import ALLOWED, lacking
from yarclang.collision import pieces as of_meshes
from yarclang.collision.geometry import encloses, geometry_of
from yarclang.collision.pieces import OpenMeshError, pieces_of_mesh
from yarclang.meshes import kept as keeping
from yarclang.meshes.pieces import Piece, pieces_of
from yarclang.meshes.stl import stl_of
from yarclang.meshes.voxels import voxels_of
from yarclang.shapes import Mesh

EDGE = 0.02


def cubes(places):
    """Return the closed triangles of cubes in a grid."""
    return voxels_of((np.array(places) + 0.5) * EDGE, EDGE, 10**7).triangles


def clamp():
    """Return a body in the shape of a C: a back of five cubes with two arms of four."""
    back = [(0, y, z) for y in range(2) for z in range(5)]
    return cubes(back + [(x, y, z) for x in range(1, 4) for y in range(2) for z in (0, 4)])


def as_mesh(folder, triangles, pieces, name="part.stl"):
    content = stl_of(triangles * 1e3)
    (folder / name).write_bytes(content)
    return Mesh(folder / name, 1e-3, hashlib.sha256(content).hexdigest(), pieces=pieces)


def volume(corners):
    return ConvexHull(corners).volume


def shown(pieces):
    """Return pieces in the form in which the proof of clearances uses them."""
    return tuple(map(of_meshes._piece, pieces))


def random_body(rng):
    """Return the triangles of a random body: it consists of cubes, and is stretched and rotated."""
    places = {(0, 0, 0)}
    for _ in range(int(rng.integers(1, 25))):
        grown = np.array(sorted(places)[rng.integers(len(places))])
        grown[rng.integers(3)] += rng.choice([-1, 1])
        places.add(tuple(int(one) for one in grown))
    triangles = cubes(sorted(places))
    if rng.random() < 0.3:
        return triangles  # all faces are parallel to the axes
    if rng.random() < 0.3:
        triangles = triangles[:, ::-1]  # inside out
    turn = Rotation.random(random_state=rng).as_matrix()
    return triangles * rng.uniform(0.2, 3.0, 3) @ turn.T + rng.uniform(-1.0, 1.0, 3)


def holds(piece, points, slack=1e-7):
    faces = ConvexHull(piece.corners).equations
    return (points @ faces[:, :3].T + faces[:, 3] <= slack).all(axis=1)


@exercises(several=0.6, inside=0.5)
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_the_pieces_contain_the_mesh(tally, seed):
    """Property: points on the surface and inside are in a piece, and the judge finds no missing part."""
    rng = np.random.default_rng(seed)
    triangles = random_body(rng)
    pieces = pieces_of(triangles, int(rng.integers(2, 12)))
    weights = rng.dirichlet(np.ones(3), 400)
    points = np.einsum("pi,pix->px", weights, triangles[rng.integers(len(triangles), size=400)])
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    within = [one for one in rng.uniform(low, high, (100, 3)) if encloses(triangles, one)]
    for one in (points, np.array(within).reshape(-1, 3)):
        assert np.any([holds(piece, one) for piece in pieces], axis=0).all()
    assert lacking(triangles, shown(pieces)) <= ALLOWED
    assert sum(volume(one.corners) for one in pieces) <= volume(triangles.reshape(-1, 3)) * (1 + 1e-6)
    tally.count("several", len(pieces) > 1)
    tally.count("inside", len(within) > 5)


@exercises(refused=0.8)
@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_pieces_that_lack_something_are_refused(tally, seed):
    """Property: if a corner of a piece is moved inwards, the judge notices that the piece doesn't contain its
    part of the mesh.
    """
    rng = np.random.default_rng(seed)
    triangles = random_body(rng)
    pieces = list(pieces_of(triangles, 6))
    which = int(rng.integers(len(pieces)))
    one = pieces[which]
    corners = one.corners.copy()
    number = rng.integers(len(corners))
    corners[number] += 1e-3 * (corners.mean(axis=0) - corners[number])
    moved = np.linalg.norm(corners[number] - one.corners[number])
    pieces[which] = replace(one, corners=corners)
    if moved < 1e-5:  # less than the thickness that is added to flat pieces
        return
    tally.count("refused", lacking(triangles, shown(pieces)) > ALLOWED)


def test_a_clamp_is_exactly_its_pieces():
    pieces = pieces_of(clamp(), 8)
    assert len(pieces) == 4
    assert sum(volume(one.corners) for one in pieces) == pytest.approx(22 * EDGE**3, rel=1e-6)


def test_a_convex_body_is_one_piece():
    assert len(pieces_of(cubes([(0, 0, 0), (1, 0, 0)]), 16)) == 1


def test_a_ring_is_cut_though_no_single_cut_gains():
    ring = cubes([(x, y, 0) for x in range(7) for y in range(7) if not (1 < x < 5 and 1 < y < 5)])
    pieces = pieces_of(ring, 8)
    assert sum(volume(one.corners) for one in pieces) < 1.01 * 40 * EDGE**3


def test_cells_that_overlap_or_leave_a_gap_are_refused():
    triangles, pieces = clamp(), list(pieces_of(clamp(), 4))
    assert lacking(triangles, shown(pieces[1:])) == np.inf
    assert lacking(triangles, shown([*pieces, pieces[0]])) == np.inf
    one = pieces[0]
    smaller = [replace(one, high=one.high - np.array([1e-5, 0.0, 0.0])), *pieces[1:]]
    assert lacking(triangles, shown(smaller)) == np.inf
    without = [replace(one, cell=None) for one in shown(pieces)]
    assert lacking(triangles, tuple(without)) == np.inf


def test_a_cell_within_the_solid_needs_its_corners():
    """The cell in the middle of a solid contains no triangles, but must be full."""
    triangles = cubes([(x, y, z) for x in range(3) for y in range(3) for z in range(3)])
    unit = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    places = [(x, y, z) for x in range(3) for y in range(3) for z in range(3)]
    cells = [(np.array(one) * EDGE, (np.array(one) + 1.0) * EDGE) for one in places]
    pieces = [Piece(low, high, low + unit * (high - low)) for low, high in cells]
    assert lacking(triangles, shown(pieces)) <= ALLOWED
    low = pieces[13].low
    pieces[13] = replace(pieces[13], corners=low + unit * (EDGE - 1e-4))
    assert lacking(triangles, shown(pieces)) == pytest.approx(1e-4, rel=0.02)


def test_an_open_mesh_has_no_pieces(tmp_path):
    with pytest.raises(OpenMeshError):
        pieces_of_mesh(as_mesh(tmp_path, clamp()[1:], 4))
    (one,) = pieces_of_mesh(as_mesh(tmp_path, clamp()[1:], 1))  # a single hull needs no closed mesh
    assert not one.is_hollow


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Fixture: the folder in which cache entries are stored."""
    monkeypatch.setenv(files.CACHE, str(tmp_path / "cache"))
    return tmp_path / "cache" / "meshes"


def test_pieces_are_kept_and_a_damaged_entry_is_made_again(tmp_path, folder, monkeypatch):
    mesh = as_mesh(tmp_path, clamp(), 8)
    first = pieces_of_mesh(mesh)
    made = []
    monkeypatch.setattr(
        of_meshes, "pieces_of", lambda skin, most: (made.append(most), pieces_of(skin, most))[1]
    )
    again = pieces_of_mesh(mesh)
    assert not made
    for one, other in zip(first, again, strict=True):
        assert np.array_equal(one.corners, other.corners)
        assert np.array_equal(one.cell, other.cell)
    (entry,) = folder.iterdir()
    content = bytearray(entry.read_bytes())
    content[-3] ^= 1
    entry.write_bytes(content)
    pieces_of_mesh(mesh)
    assert made == [8]
    pieces_of_mesh(replace(mesh, pieces=3))
    assert made == [8, 3]  # another number of pieces is another entry
    assert geometry_of(replace(mesh, pieces=0)).is_hollow


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        (0).to_bytes(8, "little"),
        (10**15).to_bytes(8, "little") + bytes(100),
        (65).to_bytes(8, "little") + bytes(65 * 56),
        (1).to_bytes(8, "little") + bytes(48) + (10**15).to_bytes(8, "little"),
        (1).to_bytes(8, "little") + bytes(48) + (2**64 - 1).to_bytes(8, "little") + bytes(24),
        (1).to_bytes(8, "little") + bytes(48) + (2).to_bytes(8, "little") + bytes(24),
    ],
)
def test_a_forged_entry_of_pieces_ends_nothing(payload):
    assert keeping._pieces(memoryview(payload)) is None
