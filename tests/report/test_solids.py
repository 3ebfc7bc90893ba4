"""Shapes as triangle meshes: closed, facing outwards, and of the same size as the shape."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.report.solids import solid_of
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Sphere

SIZES = st.floats(0.01, 2.0)


def volume(solid):
    """Return the volume by the divergence theorem. It is right only if no triangle is missing and all face
    outwards.
    """
    a, b, c = solid.vertices[solid.faces].transpose(1, 0, 2)
    return float(np.einsum("ti,ti->", a, np.cross(b, c))) / 6.0


@given(SIZES, SIZES, SIZES)
def test_a_box_has_its_volume(x, y, z):
    solid = solid_of(Box(np.array([x, y, z])))
    assert volume(solid) == pytest.approx(x * y * z)
    assert np.ptp(solid.vertices, axis=0) == pytest.approx([x, y, z])


@given(SIZES, SIZES)
def test_round_shapes_lie_just_within_theirs(radius, length):
    """The corners of the mesh are on the surface, so its volume is slightly smaller than the shape's."""
    ball, tube = 4.0 / 3.0 * np.pi * radius**3, np.pi * radius**2 * length
    for shape, whole, height in (
        (Sphere(radius), ball, 2.0 * radius),
        (Cylinder(radius, length), tube, length),
        (Capsule(radius, length), ball + tube, length + 2.0 * radius),
    ):
        solid = solid_of(shape)
        assert 0.97 * whole < volume(solid) <= whole
        assert np.ptp(solid.vertices, axis=0) == pytest.approx([2.0 * radius, 2.0 * radius, height])


STL = (
    b"solid a\n"
    + b"".join(
        b"facet normal 0 0 0\nouter loop\n"
        + b"".join(b"vertex %d %d %d\n" % corner for corner in face)
        + b"endloop\nendfacet\n"
        for face in (
            ((0, 0, 0), (0, 1, 0), (1, 0, 0)),
            ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
            ((0, 0, 0), (0, 0, 1), (0, 1, 0)),
            ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        )
    )
    + b"endsolid a\n"
)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (2.0, 1.0, -1.0)])
def test_a_mesh_is_read_and_scaled(tmp_path, scale):
    path = tmp_path / "corner.stl"
    path.write_bytes(STL)
    solid = solid_of(Mesh(path, 0.5, "", scale))
    assert volume(solid) == pytest.approx(abs(np.prod(scale)) * 0.5**3 / 6.0)


def test_what_is_no_mesh_is_none(tmp_path):
    path = tmp_path / "corner.stl"
    path.write_bytes(b"no mesh at all")
    assert solid_of(Mesh(path, 1.0, "", (1.0, 1.0, 1.0))) is None
