"""Tests of choosing a configuration for a pose: configurations that aren't free are skipped, and a finding
says so.
"""

from dataclasses import replace

import numpy as np
from programs import codes, compiled, planned

from tests.motion.avoid.cells import box, cell_of, loading
from tests.motion.test_routes import applied
from yarclang.cell.model import JointWindow, Zone
from yarclang.diagnostics import Result
from yarclang.transforms import constant

HEAD = 'CELL "cell.toml"\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\n'
GO = "P0010 MOVEJ_RPY 900 0 900 0 0 -90\n"


def ends(text, *obstacles):
    plan, found = planned(HEAD + text, load_cell=loading(*obstacles))
    assert plan is not None, found
    return np.degrees([motion.curve.points[-1] for motion in plan.motions]), found


FAR = box("FAR", [0, 5, 0], [0.1, 0.1, 0.1])


def in_the_way():
    """Return a box at the elbow of the nearest configuration, which other configurations don't touch."""
    from yarclang.collision.placing import place
    from yarclang.collision.scene import scene_of
    from yarclang.robot.description import load_robot

    robot = load_robot("INDUSTRIAL6").value
    nearest = np.radians(ends(GO, FAR)[0][0])
    scene = scene_of(robot, cell_of(FAR)).value
    placed = place(scene, nearest[None])
    link = [body.name for body in scene.bodies].index("link_3")
    return box("SHELF", placed.middle[link, 0], [0.1, 0.1, 0.1])


SHELF = in_the_way()


def test_the_next_free_one_is_taken_and_said():
    (nearest,), found = ends(GO, FAR)
    assert codes(found) == []
    (taken,), (one,) = ends(GO, SHELF)
    assert (one.severity, one.code) == ("warning", "Y0924")
    assert "SHELF" in one.message
    assert "mm deep" in one.message
    assert np.abs(taken - nearest).max() > 1.0


def test_its_fix_says_that_it_is_meant():
    text = HEAD + GO
    plan, (one,) = planned(text, load_cell=loading(SHELF))
    again, found = planned(applied(text, one.fix), load_cell=loading(SHELF))
    assert codes(found) == []
    assert np.abs(plan.motions[0].curve.points - again.motions[0].curve.points).max() < 1e-9


def test_near_is_obeyed_and_what_it_hits_is_the_proof_s_affair():
    (nearest,), _ = ends(GO, FAR)
    words = " ".join(f"{value:.4f}" for value in nearest)
    text = HEAD + f"JOINTS THERE {words} (deg)\n" + GO.replace("\n", " NEAR THERE\n")
    value, found = compiled(text, load_cell=loading(SHELF))
    assert value is None
    assert "Y0901" in codes(found)
    assert "Y0924" not in codes(found)


def test_where_none_is_free_each_reason_is_told():
    around = box("BLOCK", [0.9, 0, 0.9], [0.3, 0.3, 0.3])
    plan, found = planned(HEAD + GO, load_cell=loading(around))
    assert plan is None
    (one,) = found
    assert one.code == "Y0925"
    assert "configurations" in one.message
    assert "BLOCK" in one.message


def test_a_way_point_of_a_spline_is_skipped_as_well():
    text = "P0010 MOVEJ_SPLINE_RPY 900 0 900 0 0 -90; 900 100 900 0 0 -90\n"
    _, found = planned(HEAD + text, load_cell=loading(SHELF))
    assert "Y0924" in codes(found)
    assert any(one.message.startswith("waypoint 1: ") for one in found)


def test_the_zones_count_too():
    """A zone excludes the nearest configuration, by a window of J1."""
    (nearest,), _ = ends(GO, FAR)
    lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
    if nearest[0] < 0.0:
        lower[0] = 0.0
    else:
        upper[0] = 0.0
    side = Zone("SIDE", "allowed", JointWindow(constant(lower), constant(upper)))
    cell = replace(cell_of(FAR), zones=(side,))
    plan, found = planned(HEAD + GO, load_cell=lambda name, source: Result(cell))
    assert codes(found) == ["Y0924"]
    assert "the joints break the zone SIDE" in found[0].message
    assert plan.motions[0].curve.points[-1][0] * nearest[0] < 0.0


def test_where_no_way_leads_to_the_nearest_the_next_is_taken(monkeypatch):
    from yarclang.motion.avoid.way import NoWay, Way
    from yarclang.motion.leading import joint_motions

    (nearest,), _ = ends(GO, FAR)

    def found(room, start, goal, **_):
        return NoWay() if np.allclose(np.degrees(goal), nearest) else Way(goal[None])

    monkeypatch.setattr(joint_motions, "find_way", found)
    (taken,), told = ends(GO.replace("RPY", "RPY_AVOID"), FAR)
    assert np.abs(taken - nearest).max() > 1.0
    assert codes(told) == ["Y0924"]
    assert "no free path to the nearest one was found" in told[0].message


def test_zones_are_gone_round():
    from yarclang.cell.model import ShapeRegion
    from yarclang.shapes import Box

    placed = np.eye(4)
    placed[:3, 3] = [0.0, 0.8, 1.5]
    zone = Zone(
        "KEEP_OUT",
        "forbidden",
        ShapeRegion(constant(placed), Box(np.array([0.3, 0.6, 0.6]))),
        None,
        ("tcp", "arm"),
    )
    cell = replace(cell_of(), zones=(zone,))
    text = (
        HEAD.replace("DEFAULT {TCP} [MIN] (mm,deg,s) {B}", "DEFAULT {{TCP}} [MIN] (mm,deg,s) {{B}}")
        + "JOINTS LEFT -60 20 -20 0 -30 0 (deg)\nSTART LEFT\nP0010 MOVEJ{} 60 20 -20 0 -30 0\n"
    )
    refused, why = compiled(text.format(""), load_cell=lambda name, source: Result(cell))
    assert refused is None
    assert codes(why) == ["Y0908"]
    made, told = compiled(text.format("_AVOID"), load_cell=lambda name, source: Result(cell))
    assert made is not None, told
    assert "Y0920" in codes(told)
    assert any("breaks the zone KEEP_OUT" in one.message for one in told)
