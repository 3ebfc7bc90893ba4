"""Tests of separating planes between bodies: their bounds hold for all motions, and bodies that pass each
other closely need few pieces of time.
"""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.collision.test_bodies import cube
from tests.collision.test_proof import ROBOTS, cell_of, drawn, motion, mount, random_motion
from yarclang.cell.model import Obstacle
from yarclang.collision import proof
from yarclang.collision.geometry import geometry_of
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.planes import plane_gap, proved_gaps, support
from yarclang.collision.proof import RESOLUTION, clearances
from yarclang.collision.scene import scene_of
from yarclang.collision.travel import accelerations
from yarclang.robot.description import load_robot
from yarclang.shapes import Box, Mesh

SEEDS = st.integers(0, 2**32 - 1)


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_a_plane_never_says_more_than_the_distance(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    scene = scene_of(robot, drawn(random)).value
    pairs = np.arange(len(scene.pairs.first))
    q = random.uniform(robot.limits.lower, robot.limits.upper, (1, robot.size))
    seen, normal = relative(place(scene, q), np.zeros_like(pairs), pairs), np.empty((len(pairs), 3))
    apart = distances(scene, pairs, seen, normal=normal)
    free = apart > 1e-6
    gap = plane_gap(scene, pairs, seen, normal)[free]
    assert (gap <= apart[free] + 2e-6).all()
    # All bodies here are convex, and coal's direction is almost always the best one.
    assert (gap >= apart[free] - 2e-5).mean() > 0.95
    assert (gap >= apart[free] * 0.99).all()
    other = random.normal(size=(len(pairs), 3))
    other /= np.linalg.norm(other, axis=1)[:, None]
    assert (plane_gap(scene, pairs, seen, other)[free] <= apart[free] + 1e-6).all()


@settings(max_examples=40, deadline=None)
@given(SEEDS, st.sampled_from(["right", "too far", "any direction", "none"]))
def test_whoever_proposes_a_distance_makes_none_too_large(seed, proposal):
    """A plane's distance depends only on the extents of the bodies, so a wrong proposal can't make it too
    large. Wrong planes are turned until their distance is nearly the true one.
    """
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    scene = scene_of(robot, drawn(random)).value
    pairs = np.arange(len(scene.pairs.first))
    q = random.uniform(robot.limits.lower, robot.limits.upper, (1, robot.size))
    seen, normal = relative(place(scene, q), np.zeros_like(pairs), pairs), np.empty((len(pairs), 3))
    apart = distances(scene, pairs, seen, normal=normal)
    proposed = apart.copy()
    if proposal == "too far":
        proposed[apart > 0.0] += 0.5
    elif proposal == "any direction":
        normal = random.normal(size=normal.shape)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
    elif proposal == "none":
        normal[:] = np.nan
    found = proved_gaps(scene, pairs, seen, normal, proposed)
    free = apart > 1e-6
    assert (found[free] <= apart[free] + 2e-6).all()
    assert (found[free] <= plane_gap(scene, pairs, seen, normal)[free]).all()
    assert (found[~free] == proposed[~free]).all()
    if proposal in ("right", "too far"):
        assert (found[free] >= apart[free] - 2e-5).mean() > 0.95
    assert (found[free] >= 0.9 * apart[free] - 2e-3).mean() > 0.95


def test_a_lying_coal_hides_no_collision(industrial6, monkeypatch):
    """Coal reports half a metre too much for all distances. The collision of the arm with a wall is still
    found.
    """
    wall = Obstacle("WALL", Box(np.array([0.2, 0.2, 0.2])), mount([-0.8, 0.68, 1.764]), 0.3)
    scene = scene_of(industrial6, cell_of(wall)).value
    points = np.zeros((8, 6))
    points[:, 0] = np.radians(np.linspace(40.0, 60.0, 8))
    course = motion(points, 3.0)
    spans = np.array([[0, len(course.x)]])
    right = clearances(scene, course, spans)
    assert {scene.names(one.pair) for one in right.meetings}

    def lying(*given, **named):
        found = distances(*given, **named)
        return np.where(found > 0.0, found + 0.5, found)

    monkeypatch.setattr(proof, "distances", lying)
    wrong = clearances(scene, course, spans)
    assert {one.pair for one in wrong.meetings} == {one.pair for one in right.meetings}


def test_a_mesh_reaches_as_far_as_its_corners(industrial6, tmp_path):
    (tmp_path / "cube.stl").write_bytes(cube(100.0, (50.0, 0.0, 0.0)))
    body = Obstacle("CUBE", Mesh(tmp_path / "cube.stl", 0.001, ""), mount([0, 0, 3]), 0.0)
    box = Obstacle("BOX", Box(np.array([0.2, 0.2, 0.2])), mount([0, 0, 3]), 0.0)
    scene = scene_of(industrial6, cell_of(body, box)).value
    at = [one.name for one in scene.bodies].index("CUBE")
    way = np.random.default_rng(0).normal(size=(50, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    corners = support(scene, np.full(50, at), way)
    assert corners == pytest.approx(support(scene, np.full(50, at + 1), way), abs=1e-6)


def test_a_slanting_flat_mesh_of_a_link_has_no_hull(tmp_path):
    corners = np.array([[0, 0, 0], [100, 0, 100], [0, 100, 0], [100, 100, 100]], dtype=float)
    faces = b"".join(
        struct.pack("<3f", 0, 0, 0) + corners[list(face)].astype("<f4").tobytes() + b"\0\0"
        for face in ((0, 1, 2), (1, 3, 2))
    )
    (tmp_path / "flat.stl").write_bytes(b"\0" * 80 + struct.pack("<I", 2) + faces)
    made = geometry_of(Mesh(tmp_path / "flat.stl", 0.001, ""), hull=True)
    assert made.half == pytest.approx([0.05] * 3)


@settings(max_examples=40, deadline=None)
@given(SEEDS)
def test_no_point_accelerates_more(seed):
    """Second differences of points of all bodies, relative to the first joints, don't exceed the bounds."""
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    scene = scene_of(robot, drawn(random, count=2)).value
    course = random_motion(robot, random)
    begin, end = np.sort(random.uniform(0, course.begins[-1], 2))
    middle = np.array([(begin + end) / 2])
    speed, strength = course.peaks(np.array([begin]), np.array([end]))
    bound = accelerations(place(scene, course.at(middle)), speed, strength, speed * (end - begin) / 2)[..., 0]
    count = 201
    step = (end - begin) / (count - 1)
    placed = place(scene, course.at(np.linspace(begin, end, count)))
    for joint in range(robot.size + 1):
        for body in range(len(scene.bodies)):
            if scene.boxes.joint[body] < joint:
                continue
            geometry = scene.bodies[body].geometry
            inside = random.uniform(-1, 1, 3) * geometry.half
            at = scene.boxes.middle[body] + scene.boxes.rotation[body] @ inside
            world = placed.turn[scene.boxes.joint[body]] @ at + placed.shift[scene.boxes.joint[body]]
            seen = np.einsum("pji,pj->pi", placed.turn[joint], world - placed.shift[joint])
            moved = np.linalg.norm(np.diff(seen, 2, axis=0), axis=1) / step**2
            assert moved.max() <= bound[joint, body] * (1 + 1e-9) + 1e-12 / step**2


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_peaks_bound_speeds(seed):
    random = np.random.default_rng(seed)
    course = random_motion(load_robot("INDUSTRIAL6").value, random)
    begin, end = np.sort(random.uniform(0, course.begins[-1], (2, 20)), axis=0)
    speed, strength = course.peaks(begin, end)
    for row in range(20):
        q = course.at(np.linspace(begin[row], end[row], 100))
        step = max((end[row] - begin[row]) / 99, 1e-6)
        assert (np.abs(np.diff(q, axis=0)).max(axis=0) / step <= speed[row] + 1e-6).all()
        assert (np.abs(np.diff(q, 2, axis=0)).max(axis=0) / step**2 <= strength[row] + 1e-6 / step).all()


def turning(span=1.0, count=80, duration=2.0):
    ends = np.zeros((count, 6))
    ends[:, 0] = np.linspace(-span, span, count)
    return motion(ends, duration)


def placed_at(robot, shape, gap, margin=0.01):
    """Return a scene with a body above the turning arm. Its smallest distance is its margin plus `gap`."""
    course = turning()
    far = cell_of(Obstacle("PLATE", shape, mount([0, 1.06, 5.0]), margin))
    scene = scene_of(robot, far).value
    pairs = [k for k in range(len(scene.pairs.first)) if "PLATE" in scene.names(k)]
    placed, at = place(scene, course.at(np.linspace(0, 2, 400))), np.arange(400)
    least = min(distances(scene, np.full(400, k), relative(placed, at, np.full(400, k))).min() for k in pairs)
    at = Obstacle("PLATE", shape, mount([0, 1.06, 5.0 - least + margin + gap]), margin)
    return scene_of(robot, cell_of(at)).value, course


def asked(monkeypatch, scene, course):
    """Return the proof of a motion, and the number of distances that coal computed for it."""
    calls = []

    def counted(scene, pair, seen, **options):
        calls.append(len(pair))
        return distances(scene, pair, seen, **options)

    monkeypatch.setattr(proof, "distances", counted)
    return clearances(scene, course, np.array([[0, len(course.x)]])), sum(calls)


@pytest.mark.parametrize("gap", [1.2e-5, 3e-5, 1e-4, 1e-3])
def test_bodies_that_graze_need_few_pieces(monkeypatch, industrial6, gap):
    """A path of 2 m beside a plate, a hundredth of a millimetre outside of its margin."""
    scene, course = placed_at(industrial6, Box(np.array([4.0, 4.0, 0.02])), gap)
    found, calls = asked(monkeypatch, scene, course)
    assert not found.meetings
    assert 0.01 <= found.least[0, 1] <= 0.01 + gap + 1e-5
    assert calls < 2_000


def test_beside_a_hollow_mesh_the_proof_ends(monkeypatch, industrial6, tmp_path):
    """No plane separates the arm from a room without a lid. A distance that is hardly above the margin counts
    as too small.
    """
    whole = cube(1500.0)
    (tmp_path / "room.stl").write_bytes(whole[:80] + struct.pack("<I", 10) + whole[84 : 84 + 500])
    room = Mesh(tmp_path / "room.stl", 0.001, "")
    for gap, meets in ((5e-5, True), (1e-3, False)):
        scene, course = in_a_room(industrial6, room, gap)
        found, calls = asked(monkeypatch, scene, course)
        near = [one for one in found.meetings if scene.names(one.pair)[0] == "link_2"]
        assert bool(near) == meets
        assert all(one.distance < 0.01 + RESOLUTION for one in near)
        assert calls < 40_000


def in_a_room(robot, shape, gap):
    """Return a scene in which link_2 moves over the floor of a room, at a distance of the margin
    plus `gap`.
    """
    course = turning()
    low, high = 1.5, 2.5
    for _ in range(60):
        middle = (low + high) / 2
        scene = scene_of(robot, cell_of(Obstacle("ROOM", shape, mount([0, 0, middle]), 0.01))).value
        (pair,) = [k for k in range(len(scene.pairs.first)) if scene.names(k) == ("link_2", "ROOM")]
        rows = np.full(200, pair)
        placed = place(scene, course.at(np.linspace(0, 2, 200)))
        apart = distances(scene, rows, relative(placed, np.arange(200), rows)).min()
        low, high = (low, middle) if apart < 0.01 + gap else (middle, high)
    return scene, course
