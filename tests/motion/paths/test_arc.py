"""Tests of arcs: parts of the circle through three points, from the first through the second to the third."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from programs import codes, planned
from scipy.spatial.transform import Rotation

from yarclang.motion.paths.arc import Arc, NoArc, arc_through

metre = st.floats(-2, 2, allow_nan=False)
points = st.tuples(metre, metre, metre).map(np.array)
vectors = st.tuples(*[st.floats(-1.5, 1.5, allow_nan=False)] * 3).map(np.array)


def pose(point, rotation_vector=(0, 0, 0)):
    made = np.eye(4)
    made[:3, :3] = Rotation.from_rotvec(rotation_vector).as_matrix()
    made[:3, 3] = point
    return made


def is_fat(*corners):
    """Return True if a triangle is neither tiny nor flat. Otherwise its circle isn't well defined."""
    sides = [np.linalg.norm(corners[i] - corners[i - 1]) for i in range(3)]
    area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
    return min(sides) > 1e-2 and area > 1e-2 * max(sides) ** 2


@given(points, points, points, vectors, vectors)
def test_the_arc_goes_through_three_points_in_their_order(first, via, last, turned, more):
    assume(is_fat(first, via, last))
    start, end = pose(first, turned), pose(last, more)
    assume((Rotation.from_rotvec(turned).inv() * Rotation.from_rotvec(more)).magnitude() < 3.1)
    arc = arc_through(start, via, end)
    assert isinstance(arc, Arc)
    s = np.linspace(0, 1, 20001)
    places = arc.poses(s)
    assert places[0] == pytest.approx(start, abs=1e-9)
    assert places[-1] == pytest.approx(end, abs=1e-8)
    away = np.linalg.norm(places[:, :3, 3] - via, axis=1)
    assert away.min() < arc.length / 20000 + 1e-9
    assert 0 < away.argmin() < 20000
    # The arc is on one circle, without turning back: constant distance from the center, and equal steps that
    # add up to the length.
    assert np.linalg.norm(places[:, :3, 3] - arc.centre, axis=1) == pytest.approx(arc.radius, rel=1e-9)
    steps = np.linalg.norm(np.diff(places[:, :3, 3], axis=0), axis=1)
    assert steps.max() - steps.min() < 1e-9 + 1e-6 * steps.max()
    assert steps.sum() == pytest.approx(arc.length, rel=1e-6)
    assert 0 < arc.sweep < 2 * np.pi


@given(points, points, points, vectors, vectors)
def test_it_turns_about_one_axis_the_short_way_in_step(first, via, last, turned, more):
    assume(is_fat(first, via, last))
    whole = Rotation.from_rotvec(more) * Rotation.from_rotvec(turned).inv()
    assume(whole.magnitude() < 3.1)
    arc = arc_through(pose(first, turned), via, pose(last, more))
    s = np.linspace(0, 1, 7)
    rotations = Rotation.from_matrix(arc.poses(s)[:, :3, :3])
    expected = Rotation.from_rotvec(s[:, None] * whole.as_rotvec()) * Rotation.from_rotvec(turned)
    assert (expected.inv() * rotations).magnitude() == pytest.approx(0, abs=1e-7)


@given(points, points, points, vectors)
def test_tangents_are_the_derivatives(first, via, last, more):
    assume(is_fat(first, via, last))
    arc = arc_through(pose(first), via, pose(last, more))
    s, step = np.linspace(0.1, 0.9, 9), 1e-5
    before, behind = arc.poses(s - step), arc.poses(s + step)
    slope = (behind[:, :3, 3] - before[:, :3, 3]) / (2 * step)
    spin = (
        Rotation.from_matrix(behind[:, :3, :3]) * Rotation.from_matrix(before[:, :3, :3]).inv()
    ).as_rotvec() / (2 * step)
    size = 1 + arc.length * arc.sweep**2
    assert arc.tangents(s)[:, :3] == pytest.approx(slope, abs=1e-6 * size)
    assert arc.tangents(s)[:, 3:] == pytest.approx(spin, abs=1e-6)


@pytest.mark.parametrize(("angle", "sweep"), [(30, 60), (90, 180), (100, 350), (200, 210), (5, 300)])
def test_via_says_which_way_round(angle, sweep):
    def on_circle(degrees):
        return 0.1 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])

    arc = arc_through(pose(on_circle(0)), on_circle(angle), pose(on_circle(sweep)))
    assert np.degrees(arc.sweep) == pytest.approx(sweep, abs=1e-6)
    assert arc.normal == pytest.approx([0, 0, 1])
    back = arc_through(pose(on_circle(0)), on_circle(-angle), pose(on_circle(-sweep)))
    assert np.degrees(back.sweep) == pytest.approx(sweep, abs=1e-6)
    assert back.normal == pytest.approx([0, 0, -1])


@pytest.mark.parametrize(
    ("first", "via", "last", "kind"),
    [
        ((0, 0, 0), (0.1, 0, 0), (0.2, 0, 0), "straight"),
        ((0, 0, 0), (0.2, 0, 0), (0.1, 0, 0), "straight"),
        ((0, 0, 0), (0.1, 1e-8, 0), (0.2, 0, 0), "straight"),
        ((0, 0, 0), (0, 0, 5e-7), (0.2, 0, 0), "coincident"),
        ((0, 0, 0), (0.2, 0, 0), (0.2, 0, 5e-7), "coincident"),
        ((0, 0, 0), (0.2, 0, 0), (0, 0, 0), "coincident"),
        ((0, 0, 0), (0, 0, 0), (0, 0, 0), "coincident"),
    ],
)
def test_points_that_give_no_circle(first, via, last, kind):
    none = arc_through(pose(first), np.array(via, float), pose(last))
    assert isinstance(none, NoArc)
    assert none.kind == kind


def test_a_bend_that_can_just_be_seen_is_an_arc():
    arc = arc_through(pose((0, 0, 0)), np.array([0.1, 1e-6, 0]), pose((0.2, 0, 0)))
    assert isinstance(arc, Arc)
    assert arc.length == pytest.approx(0.2, rel=1e-6)


def test_half_a_turn_has_no_short_way():
    none = arc_through(pose((0, 0, 0)), np.array([0.1, 0.1, 0]), pose((0.2, 0, 0), (np.pi, 0, 0)))
    assert isinstance(none, NoArc)
    assert none.kind == "half turn"


def test_two_arcs_make_a_full_circle():
    text = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0
P0020 MOVEC 60 1114.4 1176; 120 1174.4 1176 0 0 0
P0030 MOVEC 60 1234.4 1176; 0 1174.4 1176 0 0 0
"""
    plan, diagnostics = planned(text)
    assert codes(diagnostics) == []
    assert plan.motions[2].path.end == pytest.approx(plan.motions[1].path.start, abs=1e-7)
    for motion in plan.motions[1:]:
        assert motion.path.frame.radius == pytest.approx(0.06)
        assert motion.path.frame.sweep == pytest.approx(np.pi)
