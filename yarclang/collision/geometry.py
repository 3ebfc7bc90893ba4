"""Convert shapes for the distance library coal, and put a rounded box around each.

coal is imported where it is first used.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.tiles import TiledMesh, in_order, modelled
from yarclang.consulted import on_disk
from yarclang.files import LARGEST_MESH, read_whole, reason_of
from yarclang.frozen import frozen
from yarclang.meshes.faults import mesh_fault
from yarclang.meshes.hull import MOST_CORNERS, cover
from yarclang.meshes.kept import Prepared, kept
from yarclang.meshes.obj import obj_corners, obj_triangles
from yarclang.meshes.ply import read_ply
from yarclang.meshes.stl import stl_corners
from yarclang.shapes import Array, Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.units import MM


@frozen(eq=False)
class Geometry:
    """A shape for the computation of distances, and the rounded box around it.

    Support functions (the farthest point in a direction) need the shape's convex hull. The hull is the
    Minkowski sum of a smaller box, a disc perpendicular to z, and a ball of `radius`; or, for a mesh, the
    hull of `corners`.

    Attributes:
        solid: the shape in the library coal, or a large mesh in tiles.
        middle: (3,) center of the box in the shape's frame [m].
        half: (3,) half edges of the box [m].
        radius: upper bound of the distance of the shape's points from the box [m].
        point: (3,) some point of the shape [m].
        core: (3,) half edges of the smaller box in the hull [m].
        disc: radius of the disc in the hull [m].
        corners: (V, 3) corners of a mesh, relative to `middle` [m]; None for other shapes.
        skin: (T, 3, 3) triangles of a mesh that encloses a volume [m]: coal knows only the triangles, not
            the volume. None for other shapes.
    """

    solid: Any
    middle: Array
    half: Array
    radius: float
    point: Array
    core: Array
    disc: float = 0.0
    corners: Array | None = None
    skin: Array | None = None
    is_hollow: bool = False
    """True for a mesh that isn't convex: a point may be inside the mesh's convex hull, although it is far
    from all triangles.
    """
    cell: tuple[Array, Array] | None = None
    """For a piece of a mesh, two corners (3,) of a box [m]: the piece contains the part of the mesh in
    this box.
    """

    @property
    def of_coal(self) -> Any:
        """The shape in the library coal. For a large mesh, it is built at the first call, which takes
        seconds.
        """
        return self.solid.whole() if isinstance(self.solid, TiledMesh) else self.solid

    @property
    def bound(self) -> float:
        """The radius of a sphere around `middle` that encloses the shape [m]."""
        return float(np.linalg.norm(self.half)) + self.radius


_FLAT = 1e-6
"""Thickness below which coal can't make a hull of a mesh [m]."""


_FAR = 1e5
"""Largest distance of a corner from its mesh's origin [m]: coal can't make a hull of very large meshes."""


_LARGE = 1_000_000
"""File size [bytes] from which a mesh counts as large. The hull of a large mesh is computed from its corners.

Where possible, coal's reader isn't used for such files.
"""


class UnreadableError(Exception):
    """A mesh can't be read. The message is the end of a sentence that begins with the mesh's name."""


def geometry_of(shape: Shape, *, hull: bool = False) -> Geometry:
    """Convert a shape for the computation of distances.

    Args:
        shape: any shape; an opening in a mesh stays open.
        hull: True to replace a mesh by its convex hull, as for links: the hull is never smaller, and
            distances to it are a hundred times as fast.

    Raises:
        UnreadableError: the file of a mesh has another format, or no triangles.
    """
    import coal

    origin = np.zeros(3)
    match shape:
        case Box(size=size):
            edges = (float(edge) for edge in size)
            return Geometry(coal.Box(*edges), origin, size / 2.0, 0.0, origin, size / 2.0)
        case Sphere(radius=radius):
            return Geometry(coal.Sphere(radius), origin, origin, radius, origin, origin)
        case Cylinder(radius=radius, length=length):
            half = np.array([radius, radius, length / 2.0])
            # A cylinder is the Minkowski sum of a line along z and a disc across it.
            core = np.array([0.0, 0.0, length / 2.0])
            return Geometry(coal.Cylinder(radius, length), origin, half, 0.0, origin, core, disc=radius)
        case Capsule(radius=radius, length=length):
            half = np.array([0.0, 0.0, length / 2.0])
            return Geometry(coal.Capsule(radius, length), origin, half, radius, origin, half)
        case Mesh():
            return _mesh(shape, hull=hull)


def _mesh(shape: Mesh, *, hull: bool) -> Geometry:
    """Convert a mesh: the triangles of its file, or with `hull` their convex hull if they aren't all in
    one plane.
    """
    outer_model = _outer_model(shape) if hull else None
    known = None if hull else _plain_model(shape)
    if known is not None:
        return _tiled(known)
    model = outer_model or load_mesh(shape)
    if hull and outer_model is None and shape.path.suffix.lower() == ".obj":
        model = _with_all_corners(model, shape)
    corners: Array = np.asarray(model.vertices())
    spread = _checked(corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    if hull and len(spread) == 3 and spread[2] > _FLAT:
        return hull_of(model, corners)
    faces = np.array(
        [[face[side] for side in range(3)] for face in map(model.tri_indices, range(model.num_tris))]
    )
    skin = corners[faces] if _is_closed(corners, faces) else None
    # All corners span the hull; the triangles themselves are in `model`.
    outer = np.unique(corners, axis=0) - middle
    return Geometry(
        model, middle, half, 0.0, corners[0].copy(), half, corners=outer, skin=skin, is_hollow=True
    )


def hull_of(model: Any, corners: Array) -> Geometry:
    """Return the convex hull of corners (V, 3), which are the corners of coal's `model`."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    convex = _with_hull(model, corners).convex
    outer: Array = np.asarray(convex.points()) - middle
    return Geometry(convex, middle, half, 0.0, corners.mean(axis=0), half, corners=outer)


def _checked(corners: Array) -> Array:
    """Return the spread of corners (V, 3) along their main axes (3,) [m].

    Raises:
        UnreadableError: a corner is not a number or is too far away, or all corners are on a line.
    """
    if not np.isfinite(corners).all():
        raise UnreadableError("has corners that aren't finite numbers")
    if (far := float(np.abs(corners).max())) > _FAR:
        raise UnreadableError(
            f"has a corner {far:.3g} m from its origin, but at most {_FAR:,.0f} m are allowed: check its "
            "unit and scale"
        )
    # The singular values of the centred corners are their spread along the main axes, the largest first.
    spread: Array = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    if len(spread) < 2 or spread[1] <= _FLAT:
        raise UnreadableError(
            f"has no area: all its corners lie within {_FLAT / MM:g} mm of one line; check its scale"
        )
    return spread


def _tiled(mesh: Prepared) -> Geometry:
    """Return the geometry of a large mesh, divided into tiles."""
    corners, faces = mesh.corners, mesh.faces
    _checked(corners)
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, half = (low + high) / 2.0, (high - low) / 2.0
    skin = corners[faces] if mesh.closed else None
    solid, outer = TiledMesh(corners, faces), corners - middle
    return Geometry(
        solid, middle, half, 0.0, corners[0].copy(), half, corners=outer, skin=skin, is_hollow=True
    )


def _outer_model(shape: Mesh) -> Any | None:
    """Return coal's model of a large mesh with only the corners of its convex hull.

    The result is None for a small file, a flat mesh, or a file with a fault. Given the whole mesh, coal would
    first build a tree of all triangles, which takes 5 s for a million and which a hull doesn't need. Points
    inside the hull don't change it, so the hull is the same.
    """
    content = _content(shape)
    if len(content) < _LARGE:
        return None
    look = _CORNERS.get(shape.path.suffix.lower())
    corners = look(content) if look is not None else None
    if corners is not None:
        corners = corners * (np.array(shape.scale) * shape.unit)
    else:
        del content
        corners = np.array(load_mesh(shape, plain=True).vertices())
    if not np.isfinite(corners).all() or float(np.abs(corners).max()) > _FAR:
        return None
    from scipy.spatial import ConvexHull, QhullError

    try:
        outer = corners[ConvexHull(corners).vertices]
    except QhullError:
        return None
    return modelled(outer, np.arange(len(outer) // 3 * 3).reshape(-1, 3))


def _plain_model(shape: Mesh) -> Prepared | None:
    """Return a large mesh with equal corners merged, taken from the cache if possible.

    The result is None if the file is small or faulty. coal's reader is used only for a file that can't be
    read as arrays, since it takes three times as long.
    """
    try:
        is_large = shape.path.stat().st_size >= _LARGE
    except OSError:
        is_large = False  # the error is reported when the file is read
    if not is_large:
        return None
    if not shape.digest:
        return _prepared(shape)
    return kept(content_key(shape), lambda: _prepared(shape))


def content_key(shape: Mesh) -> str:
    """Return a cache key for a mesh, which contains everything that determines its triangles."""
    return f"{shape.path.suffix.lower()} {shape.digest} {shape.unit!r} {' '.join(map(repr, shape.scale))}"


def _prepared(shape: Mesh) -> Prepared | None:
    suffix = shape.path.suffix.lower()
    content = _content(shape)
    look = _TRIANGLES.get(suffix)
    three = look(content) if look is not None else None
    del content
    if three is None and suffix == ".ply":
        return None
    three = _read_by_coal(shape) if three is None else three * (np.array(shape.scale) * shape.unit)
    if not np.isfinite(three).all() or float(np.abs(three).max(initial=0.0)) > _FAR:
        return None
    # A triangle with two equal corners has no area.
    is_one = [(three[:, a] == three[:, b]).all(axis=1) for a, b in ((0, 1), (1, 2), (2, 0))]
    corners = three[~np.logical_or.reduce(is_one)].reshape(-1, 3)  # leave out triangles without an area
    if not len(corners):
        return None
    order, of, begins = _joined(corners)
    corners, faces = corners[order[begins]], of.reshape(-1, 3)
    return Prepared(corners, in_order(corners, faces), _has_even_edges(len(corners), faces))


def _stl_triangles(content: bytes) -> Array | None:
    corners = stl_corners(content)
    return None if corners is None else corners.reshape(-1, 3, 3)


def _ply_triangles(content: bytes) -> Array | None:
    read = read_ply(content)
    if isinstance(read, str) or not len(read[1]):
        return None
    corners, faces = read
    found: Array = corners[faces]
    return found


_TRIANGLES: dict[str, Callable[[bytes], Array | None]] = {
    ".stl": _stl_triangles,
    ".obj": obj_triangles,
    ".ply": _ply_triangles,
}
"""Functions that read the triangles (T, 3, 3) of a faultless file as arrays; coal reads all other files."""


def _read_by_coal(shape: Mesh) -> Array:
    """Return the triangles (T, 3, 3) of a mesh [m]."""
    model = load_mesh(shape, plain=True)
    faces = np.array(
        [[face[0], face[1], face[2]] for face in map(model.tri_indices, range(model.num_tris))],
        dtype=np.int64,
    )
    found: Array = np.array(model.vertices())[faces]
    return found


def _joined(corners: Array) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """Find equal corners among corners (V, 3).

    Returns:
        The order that sorts the corners (V,); the number of each corner's group of equal corners (V,); and a
        mask (V,) of the sorted corners at which a new group begins.
    """
    order = np.lexsort(corners.T)
    in_order = corners[order]
    begins = np.concatenate(([True], (in_order[1:] != in_order[:-1]).any(axis=1)))
    of = np.empty(len(corners), dtype=np.int64)
    of[order] = np.cumsum(begins) - 1
    return order, of, begins


def _with_all_corners(model: Any, shape: Mesh) -> Any:
    """Return coal's model of an OBJ file; if corners of the file are missing in it, return a model of all
    corners.

    coal's reader omits parts of some polygons that it divides into triangles.
    """
    from scipy.spatial import cKDTree

    own = obj_corners(_content(shape))
    if own is None:
        return model
    own = own * (np.array(shape.scale) * shape.unit)
    far, _ = cKDTree(np.asarray(model.vertices())).query(own)
    if len(own) < 3 or far.max() <= _ROUGH * np.abs(own).max():
        return model
    return modelled(own, np.arange(len(own) // 3 * 3).reshape(-1, 3))


_ROUGH = 1e-5
"""Largest difference that rounding may cause between a corner as coal reads it and the same corner in the
file, as a share of the largest coordinate.
"""


_CORNERS: dict[str, Callable[[bytes], Array | None]] = {".stl": stl_corners, ".obj": obj_corners}
"""Functions that read the corners of a faultless file as arrays; coal reads all other formats."""


_DIRECTIONS = (1000, 300, 100)
"""Numbers of planes that bound a larger body around a convex hull; the first number that coal accepts is
used.

With 1000 planes the body exceeds the hull by less than 1 % of its size, with 100 planes by some percent.
"""


def _with_hull(model: Any, corners: Array) -> Any:
    """Return coal's model of corners with their convex hull, or of a slightly larger body with its hull.

    The larger body is used if a corner of the hull, such as the tip of a fine cone, has more neighbours than
    coal can count.
    """
    for directions in (0, *_DIRECTIONS)[len(corners) > MOST_CORNERS :]:
        if directions:
            around = cover(corners, directions)
            model = modelled(around, np.arange(len(around) // 3 * 3).reshape(-1, 3))
        try:
            model.buildConvexHull(True, "Qt")
        except RuntimeError:
            continue
        return model
    raise UnreadableError("has a convex hull that can't be computed: simplify the mesh")


def _content(shape: Mesh) -> bytes:
    """Return the bytes of a mesh's file.

    Raises:
        UnreadableError: the file can't be read.
    """
    try:
        return read_whole(shape.path, LARGEST_MESH)
    except OSError as error:
        raise UnreadableError(f"can't be read: {reason_of(error)}") from error


def load_mesh(shape: Mesh, *, plain: bool = False) -> Any:
    """Return coal's model of a mesh [m].

    Args:
        shape: the mesh.
        plain: True if only corners are needed: a simple tree is built, which is slow for distances.

    Raises:
        UnreadableError: the file isn't a mesh, or has a fault at which coal would omit a face or end the
            process.
    """
    import coal

    content = _content(shape)
    scale = np.array(shape.scale) * shape.unit
    if shape.path.suffix.lower() == ".ply":  # coal's reader ends the process at some damaged files
        read = read_ply(content)
        if isinstance(read, str):
            raise UnreadableError(read)
        return modelled(read[0] * scale, read[1])
    if fault := mesh_fault(shape.path.suffix, content):
        raise UnreadableError(fault)
    try:
        tree = coal.NODE_TYPE.BV_AABB if plain else coal.NODE_TYPE.BV_OBBRSS
        with on_disk(shape.path, content) as place:
            model = coal.MeshLoader(tree).load(str(place), scale)
    except Exception as error:  # assimp and boost raise errors of several kinds
        raise UnreadableError("can't be read: the file isn't a mesh, or is damaged") from error
    if model.num_tris == 0:
        raise UnreadableError("has no triangles")
    return model


def _is_closed(corners: Array, faces: NDArray[np.int64]) -> bool:
    """Return True if triangles (T, 3) of corners (V, 3) enclose a volume: each edge belongs to an even number
    of triangles.
    """
    return _has_even_edges(len(corners), _joined(corners)[1][faces])


def _has_even_edges(count: int, faces: NDArray[np.int64]) -> bool:
    """Return True if triangles (T, 3), given as indices of `count` different corners, enclose a volume."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    # Number the edges by their two corners; in a closed mesh each number occurs an even number of times.
    in_order = np.sort(edges[:, 0] * count + edges[:, 1])
    ends = np.flatnonzero(np.concatenate(([True], in_order[1:] != in_order[:-1], [True])))
    return bool((np.diff(ends) % 2 == 0).all())


def encloses(triangles: Array, point: Array) -> bool:
    """Return True if a point (3,) is inside the closed surface of triangles (T, 3, 3).

    The solid angles of the triangles then add up to a full sphere (Van Oosterom and Strackee, IEEE Trans.
    Biomed. Eng. 30(2), 1983).
    """
    arms = triangles - point
    length = np.linalg.norm(arms, axis=2)
    a, b, c = arms[:, 0], arms[:, 1], arms[:, 2]
    # Let a, b, c be the vectors from the point to a triangle's corners. The triangle's solid angle follows
    # from tan(angle / 2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|).
    volume = np.einsum("ti,ti->t", a, np.cross(b, c))
    rest = length.prod(axis=1)
    for (one, other), far in (((a, b), 2), ((b, c), 0), ((c, a), 1)):
        rest += np.einsum("ti,ti->t", one, other) * length[:, far]
    angle = 2.0 * np.arctan2(volume, rest).sum()
    return bool(abs(angle) > 2.0 * np.pi)
