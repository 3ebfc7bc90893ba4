"""Tests that no collision is missed: random motions in random cells, and bodies that are thinner than any
step, are compared with fine samples of Pinocchio and coal.
"""

import numpy as np
import pytest
from floors import Tally

from tests.collision.dense import Dense
from yarclang.cell.model import Cell, Mount, Obstacle
from yarclang.collision.course import Course
from yarclang.collision.free import free_space, gaps
from yarclang.collision.meeting import contact
from yarclang.collision.placing import distances, place, relative
from yarclang.collision.proof import COARSE, KNOWN, SHARE, clearances
from yarclang.collision.scene import scene_of
from yarclang.collision.travel import travel
from yarclang.robot.description import load_robot
from yarclang.shapes import Box, Capsule, Cylinder, Sphere
from yarclang.source import SourceFile
from yarclang.transforms import rpy_rotation

COUNT = 24
"""Number of cells that are drawn. test_dense.py draws many more."""
ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


def mount(xyz, rpy=(0, 0, 0), *, on_flange=False):
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = rpy_rotation(np.array(rpy, float)), xyz
    return Mount(placed, on_flange)


def cell_of(*obstacles):
    return Cell(SourceFile("cell.toml", ""), {}, {}, {}, {}, obstacles, (), {})


def some_shape(random, largest):
    """Return a random shape, except meshes, up to a size."""
    a, b, c = random.uniform(0.002, largest, 3)
    return [Box(np.array([a, b, c])), Sphere(a / 2), Cylinder(a / 2, b), Capsule(a / 2, b)][
        random.integers(4)
    ]


def drawn(random, count=6):
    """Return a cell of obstacles of all shapes around the robot, and a tool."""
    standing = [
        Obstacle(
            f"O{at}",
            some_shape(random, 0.5),
            mount(random.uniform([-1.6, -1.6, 0], [1.6, 1.6, 2.2]), random.uniform(-3, 3, 3)),
            float(random.choice([0.0, 0.01, 0.05])),
        )
        for at in range(count)
    ]
    tool = Obstacle("TOOL", Capsule(0.03, 0.1), mount([0, 0.1, 0], [np.pi / 2, 0, 0], on_flange=True), 0.0)
    return cell_of(*standing, tool)


def motion(points, duration):
    """Return the uniform cubic B-spline through control points (G, n), the first and last of which are
    repeated three times.
    """
    points = np.concatenate([points[:1], points[:1], points, points[-1:], points[-1:]])
    f0, f1, f2, f3 = (points[at : len(points) - 3 + at] for at in range(4))
    h = duration / len(f0)
    v, a, j = (f2 - f0) / (2 * h), (f2 - 2 * f1 + f0) / h**2, (f3 - 3 * f2 + 3 * f1 - f0) / h**3
    # The Bezier points of the velocity bound it.
    peaks = np.abs(np.stack([(f1 - f0) / h, (f2 - f1) / h, (f3 - f2) / h])).max(axis=0)
    return Course.of((f0 + 4 * f1 + f2) / 6, v, a, j, np.full(len(f0), h), peaks)


def random_motion(robot, random):
    size = int(random.integers(4, 40))
    ends = random.uniform(robot.limits.lower, robot.limits.upper, (2, robot.size)) * 0.6
    way = ends[0] + np.linspace(0, 1, size)[:, None] * (ends[1] - ends[0])
    return motion(way + random.normal(0, 0.01, way.shape), float(random.uniform(0.5, 5)))


@pytest.mark.parametrize("seed", range(COUNT))
def test_nothing_is_missed(seed):
    random = np.random.default_rng(seed)
    robot = load_robot(ROBOTS[seed % 2]).value
    cell = drawn(random)
    scene, course, dense = scene_of(robot, cell).value, random_motion(robot, random), Dense(robot, cell)
    count = len(course.x)
    half = count // 2
    spans = np.array([[0, half], [half, count]])
    found = clearances(scene, course, spans)
    for motion_, (first, last) in enumerate(spans):
        times = np.linspace(course.begins[first], course.begins[last], 300)
        apart = dense.distances(course.at(times))
        near = {frozenset(scene.names(one.pair)) for one in found.meetings if one.motion == motion_}
        for pair in range(len(dense.pairs)):
            nearest = apart[:, pair].min()
            if nearest < dense.wanted(pair):
                assert dense.names(pair) in near
            elif dense.names(pair) not in near:
                of_cell = int(any(one.startswith("O") for one in dense.names(pair)))
                assert nearest >= found.least[motion_, of_cell] - 1e-6
        for one in found.meetings:
            if one.motion == motion_:
                told = contact(scene, course, (int(first), int(last)), one)
                assert told.distance < scene.pairs.margin[one.pair] + 2e-5
                assert 0.0 <= told.begin <= told.worst <= told.end
                assert told.end <= course.begins[last] - course.begins[first] + 1e-12


def test_what_is_told_is_sharp():
    """The reported smallest distance differs from the true one by at most a small share."""
    tally = Tally()
    robot = load_robot("INDUSTRIAL6").value
    for seed in range(500, 530):
        random = np.random.default_rng(seed)
        cell = drawn(random)
        scene, course = scene_of(robot, cell).value, random_motion(robot, random)
        found = clearances(scene, course, np.array([[0, len(course.x)]]))
        near = found.nearest[0, 1] >= 0 and found.least[0, 1] < KNOWN
        tally.count("near", near and not found.meetings)
        tally.count("far", not near and not found.meetings)
        if found.meetings:
            continue
        dense = Dense(robot, cell)
        apart = dense.distances(course.at(np.linspace(0, course.begins[-1], 500)))
        of_cell = np.array(
            [any(one.startswith("O") for one in dense.names(pair)) for pair in range(len(dense.pairs))]
        )
        own, other = apart[:, ~of_cell].min(), apart[:, of_cell].min()
        assert found.least[0, 0] >= (1 - SHARE) * own - COARSE - 1e-3
        if near:
            assert found.least[0, 1] >= (1 - SHARE) * other - COARSE - 1e-3
        else:
            assert other >= KNOWN
    assert tally.below({"near": 0.05, "far": 0.2}) == []


@pytest.mark.parametrize("thickness", [1e-3, 1e-5])
def test_a_sheet_thinner_than_any_step(industrial6, thickness):
    """A fast motion passes a sheet in much less than the time between samples."""
    sheet = Obstacle("SHEET", Box(np.array([thickness, 0.5, 0.5])), mount([0, 1.0, 1.7]), 0.0)
    scene = scene_of(industrial6, cell_of(sheet)).value
    ends = np.zeros((2, 6))
    ends[:, 0] = -1.0, 1.3
    course = motion(ends[0] + np.linspace(0, 1, 4)[:, None] * (ends[1] - ends[0]), 0.2)
    found = clearances(scene, course, np.array([[0, len(course.x)]]))
    assert ("link_5", "SHEET") in {scene.names(one.pair) for one in found.meetings}


def test_a_hair_beside_the_way_is_free(industrial6):
    """A sphere over the flange's circle is free just outside of the margin, and isn't just inside."""
    top = 1.764 + 0.04  # link_6 is a cylinder with a radius of 40 mm around the arm's axis
    for gap, meets in ((0.0101, False), (0.0099, True)):
        bead = Obstacle("BEAD", Sphere(0.001), mount([0, 1.06, top + gap + 0.001]), 0.01)
        scene = scene_of(industrial6, cell_of(bead)).value
        ends = np.zeros((5, 6))
        ends[:, 0] = np.linspace(-0.5, 0.5, 5)
        course = motion(ends, 2.0)
        found = clearances(scene, course, np.array([[0, len(course.x)]]))
        assert [scene.names(one.pair) for one in found.meetings] == [("link_6", "BEAD")] * meets


@pytest.mark.parametrize("robot", ROBOTS)
def test_shapes_are_pinocchios(robot):
    """There are as many shapes as Pinocchio loads, with the same distances."""
    robot = load_robot(robot).value
    scene, dense = scene_of(robot, None).value, Dense(robot)
    assert len(scene.bodies) == dense.links
    q = np.random.default_rng(1).uniform(robot.limits.lower, robot.limits.upper, (50, robot.size))
    pairs = np.arange(len(scene.pairs.first))
    placed = place(scene, q)
    ours = [distances(scene, pairs, relative(placed, np.full(len(pairs), row), pairs)) for row in range(50)]
    assert len(pairs) == len(dense.pairs)
    theirs = dense.distances(q)
    apart = np.sort(theirs) > 1e-6
    assert np.abs(np.sort(ours) - np.sort(theirs))[apart].max() < 1e-5


def test_travel_bounds_any_change(industrial6):
    random = np.random.default_rng(3)
    scene = scene_of(industrial6, drawn(random)).value
    q = random.uniform(industrial6.limits.lower, industrial6.limits.upper, (200, 6))
    change = random.uniform(0, 0.3, (200, 6))
    moves = travel(place(scene, q), change)
    pairs = np.arange(len(scene.pairs.first))
    for share in random.uniform(-1, 1, (5, 200, 6)):
        for row in range(0, 200, 10):
            here, there = (
                distances(
                    scene, pairs, relative(place(scene, values[row : row + 1]), np.zeros_like(pairs), pairs)
                )
                for values in (q, q + share * change)
            )
            bound = moves[scene.boxes.joint[scene.pairs.first], scene.pairs.second, row]
            free = (here > 0) & (there > 0)
            assert (np.abs(here - there) <= bound + 1e-5)[free].all()


def test_free_positions_are_those_of_dense_distances(industrial6):
    random = np.random.default_rng(4)
    cell = drawn(random, count=10)
    scene, dense = scene_of(industrial6, cell).value, Dense(industrial6, cell)
    q = random.uniform(industrial6.limits.lower, industrial6.limits.upper, (500, 6))
    wanted = np.array([dense.wanted(pair) for pair in range(len(dense.pairs))])
    slack = dense.distances(q) - wanted
    clear = np.abs(slack).min(axis=1) > 1e-6
    near = np.array([gaps(scene, one).min() <= 0.0 for one in q])
    assert (near == (slack <= 0).any(axis=1))[clear].all()


def test_a_robot_without_shapes_has_nothing_to_prove(industrial6):
    from dataclasses import replace

    scene = scene_of(replace(industrial6, shapes=()), None).value
    assert len(scene.pairs.first) == 0
    assert free_space(scene).has(np.zeros(6))
