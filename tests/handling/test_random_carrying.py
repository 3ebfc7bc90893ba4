"""Tests of random programs that carry boxes: in every certified text, the box doesn't collide.

The check shares nothing with the proof. Regular expressions read the text, scipy's splines execute it, and
Pinocchio moves the flange. At many instants, coal compares the corners, edges and faces of a box with the
boxes of the cell.
"""

import coal
import numpy as np
from floors import exercises
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.handling.carrying import PICK, PUT, made
from yarclang.independent.arm import Arm
from yarclang.independent.reading import read
from yarclang.robot.library import stdlib_folder

WALL = '\n[[obstacles]]\nname = "WALL"\nshape = "box"\nframe = "B"\nxyz = [{}, {}, {}]\nsize = [{}, {}, {}]\n'
PRESSED = 0.6
"""Largest depth to which a box may be pressed into its support when taken or released [mm]."""
DRAWN = 1.0
"""Largest depth at which a box may lie in its support, because drawings aren't exact [mm]."""

ABSURD = 1e6
"""A distance larger than any between boxes of a cell [mm]."""
TOUCHING = 0.5
"""Largest distance at which a body counts as the support of a box that is taken or released [mm]."""


def box(size, point, turn=None):
    turn = np.eye(3) if turn is None else turn
    return coal.Box(*map(float, size)), coal.Transform3s(turn, np.array(point, float))


def gap(one, other):
    """Return the signed distance of two boxes [mm].

    For boxes that touch exactly, coal may return -1.8e308; then one box is moved by a nanometre.
    """
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    for nudge in (0.0, 1e-6, -1e-6):
        moved = coal.Transform3s(one[1].getRotation(), one[1].getTranslation() + nudge)
        found = coal.distance(one[0], moved, other[0], other[1], request, coal.DistanceResult())
        if abs(found) < ABSURD:
            return found
    raise AssertionError("coal knows no distance")


@exercises(certified=0.25, refused=0.05)
@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    x=st.integers(-400, -150),
    y=st.integers(700, 950),
    z=st.integers(550, 800),
    turn=st.integers(-90, 90),
    size=st.integers(40, 300),
    wall=st.tuples(st.integers(-150, 250), st.integers(750, 1100), st.integers(500, 1100)),
    edges=st.tuples(st.integers(5, 80), st.integers(5, 200), st.integers(5, 200)),
)
@example(x=-150, y=700, z=550, turn=0, size=40, wall=(250, 804, 520), edges=(60, 32, 200))
@example(x=-175, y=856, z=550, turn=77, size=173, wall=(230, 890, 667), edges=(38, 200, 46))
@example(x=-150, y=700, z=550, turn=0, size=40, wall=(249, 791, 521), edges=(62, 58, 200))
def test_what_is_certified_is_clear(tmp_path_factory, tally, x, y, z, turn, size, wall, edges):
    folder = tmp_path_factory.mktemp("carried")
    found = made(folder, PICK + PUT, WALL.format(*wall, *edges), x=x, y=y, z=z, turn=turn, size=size)
    tally.count("certified", found.value is not None)
    tally.count("refused", found.value is None)
    if found.value is None:
        return
    arm = Arm.in_folder(stdlib_folder() / "robots" / "industrial6")
    _, commands = read(found.value.text)
    steps = sorted(commands)
    qs = [commands[step].sample(0) for step in steps]
    # while it is gripped, the box keeps its pose in the tool's frame
    points, turns = arm.poses(qs[1][-1:])
    feeder = np.array([300.0, 850.0, 650.0])
    held_at, held_turn = turns[0].inv().apply(feeder - points[0]), turns[0].inv()
    still = {
        "TRACK": box((300, 200, 200), feeder - np.array([0.0, 0.0, 130.0])),
        "TABLE": box(
            (300, 300, 200), [x, y, z - 130], Rotation.from_euler("z", turn, degrees=True).as_matrix()
        ),
        "WALL": box(edges, wall),
    }
    for number, q in enumerate(qs[2:5]):
        points, turns = arm.poses(q)
        shapes = [
            box((size, 60, 60), point + at.apply(held_at), (at * held_turn).as_matrix())
            for point, at in zip(points, turns, strict=True)
        ]
        # the supports of a box are all bodies that it touches where it is taken or released, even a wall
        lies_at = {0: shapes[:1], 2: shapes[-1:]}.get(number, [])
        for name, other in still.items():
            touches = any(gap(shape, other) < TOUCHING for shape in lies_at)
            assert min(gap(shape, other) for shape in shapes) > (-PRESSED - DRAWN if touches else 0.0), (
                name,
                number,
            )
    point, at = points[-1], turns[-1]
    assert np.allclose(point + at.apply(held_at), [x, y, z], atol=0.05)
