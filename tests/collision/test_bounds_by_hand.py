"""Tests of bounds that are slightly above the truth, by a second computation of the same sums."""

from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from tests.certify.test_bounds_by_hand import grown, series, times
from tests.collision.test_proof import ROBOTS, cell_of, drawn, motion, mount
from yarclang.cell.model import HalfSpace, JointWindow, Obstacle, ShapeRegion, Zone
from yarclang.collision.placing import place, relative
from yarclang.collision.planes import plane_gap
from yarclang.collision.scene import scene_of
from yarclang.collision.travel import accelerations, arm_lengths
from yarclang.collision.zones.breach import beyond
from yarclang.collision.zones.gaps import roughly_outside
from yarclang.collision.zones.moved import rates
from yarclang.collision.zones.regions import faces_of
from yarclang.collision.zones.watched import tool_frame
from yarclang.collision.zones.windows import room
from yarclang.collision.zones.workspace import watches_of
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Chain
from yarclang.shapes import Box, Mesh
from yarclang.transforms import rpy_rotation

X, Z, NOTHING = np.eye(3)[0], np.eye(3)[2], np.zeros(3)


@pytest.mark.parametrize("seed", range(6))
def test_accelerations_are_the_sum_over_pairs_of_joints(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    scene = scene_of(robot, drawn(random)).value
    size, pieces = robot.size, 3
    q = random.uniform(robot.limits.lower, robot.limits.upper, (pieces, size))
    speed, strength, change = random.uniform(0.1, 2.0, (3, pieces, size))
    placed = place(scene, q)
    found, arms = accelerations(placed, speed, strength, change), arm_lengths(placed)
    turns = np.linalg.norm(robot.chain.screws[:, 3:], axis=1)
    for still in range(size + 1):
        wanted = np.zeros(found.shape[1:])
        for joint in range(still, size):
            moved = sum(arms[after] * change[:, after] for after in range(joint + 1, size))
            reach = arms[joint] + turns[joint] * moved
            others = sum(speed[:, one] * turns[one] for one in range(still, joint))
            w = speed[:, joint]
            wanted += reach * (strength[:, joint] + w * w * turns[joint] + 2.0 * w * others)
        np.testing.assert_allclose(found[still], wanted, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kinds", ["R", "RP", "RRP"])
def test_rates_of_points_are_those_of_series(kinds, seed):
    """Axes at x = 0, 1 and 2 m turn about z or slide along x. The item is a point at x = 4 m."""
    random = np.random.default_rng(seed)
    size = len(kinds)
    screws = [
        np.concatenate([-np.cross(Z, place * X), Z]) if kind == "R" else np.concatenate([X, NOTHING])
        for place, kind in enumerate(kinds)
    ]
    w, a, j = random.uniform(0.2, 3.0, (3, size))
    course = SimpleNamespace(
        x=np.zeros((1, size)), way=np.zeros((2, size)), speed=w[None], strength=a[None], j=j[None]
    )
    found = rates(
        Chain(np.array(screws), np.eye(4)), course, SimpleNamespace(joint=size, middle=4.0 * X, bound=0.0)
    )
    before, wanted = np.zeros(3), series(0.0)
    for joint, kind in enumerate(kinds):
        if kind == "P":
            wanted = wanted + times(grown(*before), series(0.0, w[joint], a[joint], j[joint]))
            continue
        after = before + np.array([w[joint], a[joint], j[joint]])
        wanted = wanted + (4.0 - joint) * (grown(*after) - grown(*before))
        before = after
    np.testing.assert_allclose(
        [found.first[0], found.second[0], found.third[0]], wanted[1:4] * [1, 2, 6], rtol=1e-12
    )


def test_balls_are_as_far_away_as_their_way_allows():
    region = HalfSpace(-Z, 0.0)
    item = SimpleNamespace(middle=NOTHING, bound=0.1)
    ends = tuple(SimpleNamespace(point=lambda _, z=z: np.array([[0.0, 0.0, z]])) for z in (1.0, 1.4))
    # A path of 0.6 m from a height of 1.0 m to 1.4 m can lead down to 0.9 m. The ball's radius is subtracted.
    assert roughly_outside(region, item, ends, np.array([0.6])) == pytest.approx(0.8, abs=1e-12)


def test_the_room_in_a_window_is_told_from_both_ends():
    window = JointWindow(np.array([-1.0, 0.5, -np.inf]), np.array([2.0, 0.75, np.inf]))
    inner = room(window, np.array([[1.5, 0.5, 7.0], [-1.25, 0.6, -7.0]]))
    np.testing.assert_allclose(inner, [[0.5, 0.0, np.inf], [-0.25, 0.1, np.inf]], atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_faces_of_a_box_touch_its_corners(seed):
    random = np.random.default_rng(seed)
    size, placed = random.uniform(0.1, 1.0, 3), np.eye(4)
    placed[:3, :3], placed[:3, 3] = rpy_rotation(random.uniform(-3, 3, 3)), random.uniform(-1, 1, 3)
    faces = faces_of(ShapeRegion(placed, Box(size)))
    corners = np.array(list(product([-0.5, 0.5], repeat=3))) * size @ placed[:3, :3].T + placed[:3, 3]
    np.testing.assert_allclose((corners @ faces.normals.T).max(axis=0), faces.offsets, atol=1e-12)


CORNERS = np.array([[0.0, 0.0, 0.0], [200.0, 0.0, 0.0], [0.0, 300.0, 0.0], [0.0, 0.0, 400.0]])
"""Corners of a tetrahedron [mm] that no rotation by 180 deg maps to itself."""


def tetrahedron():
    """Return the tetrahedron as a binary STL."""
    rows = (CORNERS[[int(at) for at in face]] for face in ("021", "013", "032", "123"))
    body = b"".join(bytes(12) + one.astype("<f4").tobytes() + bytes(2) for one in rows)
    return bytes(80) + (4).to_bytes(4, "little") + body


@pytest.mark.parametrize("seed", range(6))
def test_planes_hold_corners_apart(industrial6, tmp_path, seed):
    """The gap that a plane leaves between two tetrahedra is the gap between their corners."""
    random = np.random.default_rng(seed)
    (tmp_path / "body.stl").write_bytes(tetrahedron())
    shape = Mesh(tmp_path / "body.stl", 0.001, "")
    on_flange = mount(random.uniform(-0.2, 0.2, 3), random.uniform(-3, 3, 3), on_flange=True)
    stands = mount([2.0, 0.0, 5.0], random.uniform(-3, 3, 3))
    tool, other = Obstacle("NEAR", shape, on_flange, 0.0), Obstacle("FAR", shape, stands, 0.0)
    scene = scene_of(industrial6, cell_of(tool, other)).value
    pairs = zip(scene.pairs.first.tolist(), scene.pairs.second.tolist(), strict=True)
    names = [(scene.bodies[one].name, scene.bodies[two].name) for one, two in pairs]
    at = next(at for at, one in enumerate(names) if set(one) == {"NEAR", "FAR"})
    q = random.uniform(-1, 1, (1, 6))
    placed = {
        "NEAR": flange_poses(industrial6.chain, q)[0] @ on_flange.transform,
        "FAR": stands.transform,
    }
    first, second = (CORNERS / 1000 @ placed[name][:3, :3].T + placed[name][:3, 3] for name in names[at])
    seen = relative(place(scene, q), np.array([0]), np.array([at]))
    body = scene.pairs.first[at]
    turn = place(scene, q).turn[scene.boxes.joint[body], 0] @ scene.boxes.rotation[body]
    for _ in range(5):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        own = normal @ turn
        found = plane_gap(scene, np.array([at]), seen, own[None])
        assert found[0] == pytest.approx((second @ normal).min() - (first @ normal).max(), abs=1e-6)


def test_a_breach_is_told_from_its_begin_to_its_end(industrial6):
    zone = Zone("W", "forbidden", JointWindow(*np.array([[0.5] + [-9.0] * 5, [9.0] * 6])))
    cell, moving = replace(cell_of(), zones=(zone,)), tool_frame(industrial6)
    (watch,) = watches_of(industrial6, cell, moving)
    points = np.zeros((12, 6))
    points[:, 0] = [0.0, 0.0, 0.0, 0.2, 0.5, 0.9, 1.0, 0.7, 0.3, 0.1, 0.1, 0.1]
    course = motion(points, 4.0)
    times = np.linspace(0.0, course.begins[-1], 200_001)
    broken = times[course.at(times)[:, 0] > 0.5]
    told = beyond(scene_of(industrial6, cell).value, course, (0, len(course.x)), watch, float(broken.mean()))
    assert told.begin == pytest.approx(broken[0], abs=1e-3)
    assert told.end == pytest.approx(broken[-1], abs=1e-3)
