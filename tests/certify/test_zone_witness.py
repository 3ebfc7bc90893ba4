"""Tests of the second check of zones: at the ends of segments it finds what the proof overlooks, and reports
nothing else.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given
from hypothesis import strategies as st
from programs import codes
from scipy.spatial.transform import Rotation

from tests.certify.test_certify_zones import with_cell, zone
from yarclang.cell.model import HalfSpace, ShapeRegion
from yarclang.certify.bodies import zones
from yarclang.certify.bodies.witness import distances
from yarclang.collision.zones import regions
from yarclang.collision.zones.proof import Kept
from yarclang.shapes import Box, Capsule, Cylinder, Sphere

BROKEN = [
    ({"rule": "allowed", "shape": "half-space", "normal": [0, 0, 1], "xyz": [0, 0, 1050], "frame": "B"},
        "P0010 DMOVE 0 0 -100 0 0 0"),
    ({"rule": "allowed", "shape": "cylinder", "radius": 900, "length": 4000, "frame": "B", "watch": ["arm"]},
        "P0010 MOVEJ 20 10 -40 0 30 0"),
    ({"rule": "allowed", "shape": "box", "size": [9000, 9000, 1200], "frame": "B", "xyz": [0, 0, 600],
        "watch": ["arm"]}, "P0010 MOVEJ 20 -30 0 0 30 0"),
    ({"rule": "allowed", "shape": "sphere", "radius": 1400, "frame": "B", "xyz": [0, 0, 500],
        "watch": ["tool"]}, "P0010 MOVEJ 20 0 0 0 30 0"),
    ({"rule": "forbidden", "shape": "sphere", "radius": 100, "frame": "B", "xyz": [0, 900, 1100]},
        "P0010 MOVEJ -20 10 -40 0 -30 0"),
    ({"rule": "forbidden", "shape": "capsule", "radius": 100, "length": 400, "frame": "B",
        "xyz": [0, 900, 1100]}, "P0010 MOVEJ -20 10 -40 0 -30 0"),
    ({"rule": "forbidden", "shape": "half-space", "normal": [0, 1, 0], "xyz": [0, 400, 0], "frame": "B",
        "watch": ["elbow"]}, "P0010 MOVEJ 20 -30 -40 0 -30 0"),
    ({"rule": "forbidden", "shape": "half-space", "normal": [0, 0, -1], "xyz": [0, 0, 200], "margin": 900,
        "frame": "B"}, "P0010 DMOVE 0 0 -100 0 0 0"),
    ({"rule": "allowed", "shape": "joints", "joints": {"J1": [0, 30]}}, "P0010 MOVEJ -10 10 -40 0 -30 0"),
    ({"rule": "forbidden", "shape": "joints", "joints": {"J1": [0, 10], "J2": [-10, 90]}},
        "P0010 MOVEJ -10 10 -40 0 -30 0"),
    (
        {"rule": "posture", "shape": "sphere", "radius": 100, "frame": "B", "xyz": [0, 900, 1100],
            "joints": {"J5": [-10, 90]}},
        "P0010 MOVEJ -20 10 -40 0 -30 0",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "line"), BROKEN)
def test_a_proof_that_overlooks_a_breach_is_found(tmp_path, monkeypatch, keys, line):
    def nothing(scene, course, spans, watches):
        count = len(spans)
        return Kept(np.full(count, 1.0), np.full(count, -1), np.zeros(count), ())

    monkeypatch.setattr(zones, "kept", nothing)
    value, found = with_cell(tmp_path, zone(**keys), line)
    assert value is None
    assert set(codes([one for one in found if one.is_error])) == {"Y1181"}


def test_a_wrong_geometry_of_regions_is_found(tmp_path, monkeypatch):
    """An error in the geometry of zones that planner and judge share is found."""
    monkeypatch.setattr(regions, "_length", lambda vectors: np.linalg.norm(vectors, axis=-1) + 0.3)
    keys, line = BROKEN[4]
    value, found = with_cell(tmp_path, zone(**keys), line)
    assert value is None
    assert any(one.is_error for one in found)


sizes = st.floats(0.05, 2.0)
shapes = st.one_of(
    st.tuples(sizes, sizes, sizes).map(lambda three: Box(np.array(three))),
    sizes.map(Sphere),
    st.tuples(sizes, sizes).map(lambda two: Cylinder(*two)),
    st.tuples(sizes, sizes).map(lambda two: Capsule(*two)),
)


@exercises(inside=0.1, outside=0.1)
@given(shapes, st.integers(0, 10**6))
def test_distances_are_those_of_the_other_geometry(tally, shape, seed):
    random = np.random.default_rng(seed)
    placed = np.eye(4)
    placed[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    placed[:3, 3] = random.uniform(-1, 1, 3)
    points = placed[:3, 3] + random.normal(0.0, 0.8, (20, 3))
    for region in (ShapeRegion(placed, shape), HalfSpace(placed[:3, 2], float(random.normal()))):
        ours, others = distances(region, points.T), regions.outside(region, points)
        np.testing.assert_allclose(ours, others, atol=1e-12)
        for one in ours:
            tally.count("inside", one < 0.0)
            tally.count("outside", one > 0.0)
