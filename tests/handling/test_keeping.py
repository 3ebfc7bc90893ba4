"""Tests of KEEP: a carried frame stays upright, or above a plane, during the whole motion."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled, robot_of

from tests.certify.forging import Forger
from tests.floors import exercises
from yarclang.certify.certifying import certify
from yarclang.robot.kinematics.fk import tool_poses

HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
TILTS = HEAD + "KEEP {TCP} UPRIGHT $LIMIT (deg)\n  P0010 MOVEJ 0 0 0 0 30 0\n  P0020 MOVEJ HOME\nEND\n"


def kept(program, **more):
    result, found = compiled(program, **more)
    return result, [one for one in codes(found) if one not in ("Y0920", "Y0215")]


@pytest.mark.parametrize(("limit", "wrong"), [(20, ["Y0955", "Y0955"]), (30.01, []), (40, [])])
def test_the_angle_holds_between_the_ends_too(limit, wrong):
    result, found = kept(f"LET LIMIT = {limit}\n" + TILTS)
    assert found == wrong
    if not wrong:
        for command in result.certificate.commands:
            (rule,) = command.kept
            assert np.radians(29.99) <= rule.largest <= np.radians(limit) + 1e-5


def test_a_way_between_two_upright_places_that_tilts_is_refused():
    """A motion that tilts between two upright positions is refused. The motion before the KEEP has no rule,
    and isn't checked.
    """
    arc = HEAD + (
        "P0010 MOVEJ 0 0 0 0 20 0\n"
        "KEEP {TCP} UPRIGHT 21 (deg)\n"
        "  P0020 MOVEJ_SPLINE 0 0 0 0 40 0; 0 0 0 0 20 0 [4]\n"
        "END\n"
    )
    _, found = compiled(arc)
    assert codes(found) == ["Y0955"]
    assert "tilts 40" in found[0].message


def test_a_keep_ends_at_its_end():
    program = HEAD + "KEEP {TCP} UPRIGHT 5 (deg)\n  P0010 MOVEJ 20 0 0 0 0 0\nEND\nP0020 MOVEJ 0 0 0 0 30 0\n"
    result, found = kept(program)
    assert found == []
    assert [len(one.kept) for one in result.certificate.commands] == [1, 0]


def test_the_motions_of_a_call_keep_to_it():
    program = (
        "SUB OVER\n  P0010 MOVEJ 0 0 0 0 30 0\nEND\n"
        + HEAD
        + "KEEP {TCP} UPRIGHT 5 (deg)\n  P0020 CALL OVER\nEND\n"
    )
    assert kept(program.replace("SUB", HEAD + "SUB", 1).replace("END\n" + HEAD, "END\n", 1))[1] == ["Y0955"]


def test_above_a_plane():
    program = HEAD + "KEEP {TCP} ABOVE %s (mm)\n  P0010 MOVEJ 0 0 20 0 0 0\nEND\n"
    assert kept(program.replace("%s", "500"))[1] == []
    assert kept(program.replace("%s", "1930"))[1] == ["Y0956"]


@pytest.mark.parametrize(
    "head",
    [
        "KEEP {TCP} UPRIGHT 0 (deg)",
        "KEEP {TCP} UPRIGHT 5 (mm)",
        "KEEP {B} UPRIGHT 5 (deg)",
        "KEEP UPRIGHT 5 (deg)",
        "KEEP {TCP} UPRIGHT 5 (deg) {TCP}",
        "KEEP {TCP} UPRIGHT",
        "KEEP {TCP} LEVEL 5 (deg)",
        "KEEP {TCP} UPRIGHT 5 5 (deg)",
        "KEEP {TCP} UPRIGHT 5 [3] (deg,s)",
        "KEEP {TCP} UPRIGHT ON (deg)",
    ],
)
def test_a_wrong_head_is_one_finding(head):
    result, found = compiled(f"{HEAD}{head}\n  P0010 MOVEJ 0 0 0 0 3 0\nEND\n")
    assert result is None or not result.text
    assert len([one for one in found if one.is_error]) == 1


def test_forged_maps_are_refused():
    made, found = kept("LET LIMIT = 40\n" + TILTS)
    assert found == []
    program, robot = made.plan.program, robot_of("INDUSTRIAL6")
    forger = Forger.of(made.text)
    at = forger.find("; keep .*")
    line = forger.lines[at]
    wider = line.replace("0.698131700798", "0.8")
    assert wider != line
    forged = [
        forger.drop(at),
        forger.put(at, line),
        Forger((*forger.lines[:at], wider, *forger.lines[at + 1 :])),
        Forger((*forger.lines[:at], "; keep 1 UP", *forger.lines[at + 1 :])),
    ]
    for one in forged:
        judged = certify(one.text, program, robot, robot.tolerance)
        assert judged.value is None or any(each.is_error for each in judged.diagnostics)
    # the commands are the same, but the text without the rule doesn't prove the program with it
    free = f"{HEAD}\n\nP0010 MOVEJ 0 0 0 0 30 0\nP0020 MOVEJ HOME\n"
    other, _ = compiled(free)
    judged = certify(other.text, program, robot, robot.tolerance)
    assert any(each.is_error for each in judged.diagnostics)
    told = "P0010 MOVEJ: the program has KEEP {TCP} UPRIGHT 40 (deg) {B} here, and the text doesn't"
    assert told in [each.message for each in judged.diagnostics]
    judged = certify(forged[2].text, program, robot, robot.tolerance)
    told = "P0010 MOVEJ: KEEP {TCP} UPRIGHT 40 (deg) {B} has other numbers in the text than in the program"
    assert told in [each.message for each in judged.diagnostics]


@exercises(kept=0.15, broken=0.15)
@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.lists(st.integers(-40, 40), min_size=6, max_size=6), min_size=1, max_size=2),
    st.integers(20, 110),
)
def test_random_ways_are_judged_as_dense_samples_do(tally, ways, limit):
    lines = "".join(f"  P{10 * (at + 1):04d} MOVEJ {' '.join(map(str, q))}\n" for at, q in enumerate(ways))
    result, found = compiled(f"{HEAD}KEEP {{TCP}} UPRIGHT {limit} (deg)\n{lines}END\n")
    robot = robot_of("INDUSTRIAL6")
    places = [np.zeros(6), *(np.radians(one) for one in ways)]
    dense = np.concatenate([a + np.linspace(0, 1, 400)[:, None] * (b - a) for a, b in pairwise(places)])
    axes = tool_poses(robot.chain, dense, robot.flange_from_frame["TCP"])[:, 2, 2]
    angle = float(np.arccos(np.clip(axes, -1.0, 1.0)).max())
    if abs(angle - np.radians(limit)) < 1e-3:
        return
    broken = "Y0955" in codes(found)
    if not broken and (result is None or not result.text):
        return  # the program has another error: a collision or a limit
    assert broken == (angle > np.radians(limit))
    tally.count("kept", not broken)
    tally.count("broken", broken)
    if not broken:
        assert max(one.kept[0].largest for one in result.certificate.commands) >= angle - 1e-3
