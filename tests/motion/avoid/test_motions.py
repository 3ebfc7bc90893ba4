"""Tests of MOVEJ_AVOID in programs: with each profile and time, in chains, to poses, with its fixes, and the
findings if it is impossible.
"""

import numpy as np
import pytest
from programs import codes, compiled, planned

from tests.motion.avoid.cells import POST, WALL, loading
from tests.motion.test_routes import applied
from yarclang.motion.avoid import way as ways
from yarclang.motion.avoid.search import Effort

HEAD = (
    'CELL "cell.toml"\nJOINTS LEFT -60 20 -20 0 -30 0 (deg)\nSTART LEFT\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\n'
)
GO = "60 20 -20 0 -30 0"


def made(line, *obstacles):
    return compiled(HEAD + line, load_cell=loading(*(obstacles or (POST,))))


@pytest.mark.parametrize(
    "line",
    [
        f"P0010 MOVEJ_AVOID {GO}",
        f"P0010 MOVEJ_AVOID_POLY5 {GO} [20]",
        f"P0010 MOVEJ_AVOID_SCURVE {GO} [50%]",
        f"P0010 MOVEJ_AVOID_TOPP {GO} [MIN]",
        f"P0010 MOVEJ_AVOID_LSPB {GO} [7.3] ACC 40% TOL 0.05",
    ],
)
def test_every_profile_and_time_is_certified(line):
    value, found = made(line)
    assert codes(found) in (["Y0920"], ["Y0505", "Y0920"])
    (proved,) = value.certificate.commands
    assert proved.kind == "avoid"
    assert proved.clearance.distance > 0.0
    if "[20]" in line or "[7.3]" in line:
        assert proved.duration == pytest.approx(20 if "[20]" in line else 7.3, abs=2e-4)


def test_without_avoid_it_is_refused_and_the_fix_leads_round():
    text = HEAD + f"P0010 MOVEJ {GO}"
    value, (one,) = made(f"P0010 MOVEJ {GO}")
    assert value is None
    assert one.code == "Y0901"
    assert "MOVEJ_AVOID" in one.help
    fixed = applied(text, one.fix)
    assert "P0010 MOVEJ_AVOID 60" in fixed
    assert compiled(fixed, load_cell=loading(POST))[0] is not None


@pytest.mark.parametrize("name", ["MOVEJ_RPY", "MOVEJ_QUAT_TOPP"])
def test_the_suffix_stands_between_target_and_profile(name):
    pose = "-714.2 412.4 1541.3 " + ("-30 0 60" if "RPY" in name else "-0.2241 -0.1294 0.4830 0.8365")
    found = made(f"P0010 {name} {pose}")[1]
    (hit,) = [one for one in found if one.code == "Y0901"]
    assert (
        hit.fix.edits[0].text
        == {
            "MOVEJ_RPY": "MOVEJ_RPY_AVOID",
            "MOVEJ_QUAT_TOPP": "MOVEJ_QUAT_AVOID_TOPP",
        }[name]
    )


@pytest.mark.parametrize(
    ("line", "name"),
    [
        (f"P0010 MOVEJ_AVOID {GO}", "MOVEJ_SPLINE"),
        ("P0010 MOVEJ_RPY_AVOID_POLY5 -714.2 412.4 1541.3 -30 0 60 [9]", "MOVEJ_SPLINE_RPY_POLY5"),
    ],
)
def test_its_fix_writes_the_very_same_way(line, name):
    text = HEAD + line
    plan, found = planned(text, load_cell=loading(POST))
    (note,) = [one for one in found if one.code == "Y0920"]
    fixed = applied(text, note.fix)
    assert f"P0010 {name} P0010_VIA1; " in fixed
    assert "_AVOID" not in fixed
    again, told = planned(fixed, load_cell=loading(POST))
    assert "Y0920" not in codes(told)
    assert len(plan.motions) == len(again.motions) == 1
    assert np.abs(plan.motions[0].curve.points - again.motions[0].curve.points).max() < 1e-9


def test_it_flows_into_its_neighbours():
    text = (
        "P0010 MOVEJ -50 25 -20 0 -30 0 BLEND 3\n"
        f"P0020 MOVEJ_AVOID {GO} BLEND 3\n"
        "P0030 MOVEJ 70 20 -20 0 -30 0"
    )
    value, found = made(text)
    assert not [one for one in found if one.is_error], found
    assert [motion.flows for motion in value.plan.motions] == [True, True, False]


def test_the_plan_s_way_points_are_claims_that_are_checked():
    from yarclang.certify.certifying import certify
    from yarclang.certify.claims import Claims
    from yarclang.pipeline.stages import claims_of

    value, _ = made(f"P0010 MOVEJ_AVOID {GO}")
    plan, robot = value.plan, value.plan.robot
    honest = {0: np.array(plan.motions[0].waypoints)}

    def judged(witness):
        claims = {} if witness is None else {0: witness}
        found = certify(
            value.text, plan.program, robot, robot.tolerance, Claims(claims, claims_of(plan).laws)
        )
        return codes([one for one in found.diagnostics if one.is_error])

    assert judged(honest[0]) == []
    moved = honest[0].copy()
    moved[0, 0] += 0.01
    assert judged(moved)
    elsewhere = honest[0].copy()
    elsewhere[-1, 0] += 0.01
    assert "Y1161" in judged(elsewhere)
    assert "Y1161" in judged(None)


def test_a_blocked_end_names_both_bodies_and_the_depth():
    value, found = made("P0010 MOVEJ_AVOID 0 20 -20 0 -30 0\nP0020 MOVEJ_AVOID 60 20 -20 0 -30 0")
    assert value is None
    assert codes(found) == ["Y0922", "Y0921"]
    assert all("mm deep in POST" in one.message for one in found)


def test_nothing_found_is_said_with_the_samples(monkeypatch):
    monkeypatch.setattr(ways, "EFFORTS", (Effort(0.01, 0.05, 60, 1),))
    value, found = made(f"P0010 MOVEJ_AVOID {GO}", *WALL)
    assert value is None
    (one,) = found
    assert one.code == "Y0923"
    assert "no free path was found in 60 tries (one may still exist)" in one.message
    assert "WALL" in one.message


@pytest.mark.parametrize(
    "name",
    [
        "MOVEC_AVOID",
        "MOVEL_AVOID_RPY",
        "MOVEJ_LSPB_AVOID",
        "MOVEJ_AVOID_RPY",
        "DMOVEJ_AVOID",
        "MOVEJ_AVOID_AVOID",
    ],
)
def test_it_stands_only_where_it_belongs(name):
    assert codes(planned(f"DEFAULT {{TCP}} [9] (mm,deg,s) {{B}}\nP0010 {name} 1 2 3 4 5 6")[1]) == ["Y0203"]


def test_a_program_without_a_cell_goes_straight():
    text = f"START HOME\nP0010 MOVEJ_AVOID {GO} [9] (deg,s)"
    value, found = compiled(text)
    assert codes(found) == []
    straight, _ = compiled(text.replace("_AVOID", ""))
    assert np.array_equal(value.plan.motions[0].curve.points, straight.plan.motions[0].curve.points)
