"""Tests of speed ceilings (`[V<=250]`): all kinds of motions keep them, aren't slower than necessary, and are
proved.
"""

import math
import re

import numpy as np
import pytest
from programs import codes, compiled, robot_of

from yarclang.certify.bodies import ceilings
from yarclang.certify.certifying import certify
from yarclang.certify.claims import Claims
from yarclang.diagnostics import has_errors
from yarclang.independent.arm import Arm
from yarclang.independent.reading import read
from yarclang.motion import zones
from yarclang.robot.kinematics.fk import tool_poses

HEAD = "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nJOINTS A 20 10 -40 0 -30 0\nSTART A\n"
ARM = Arm.in_folder(robot_of("INDUSTRIAL6").folder)

ALONE = {
    "MOVEJ": "P0010 MOVEJ -30 0 10 20 20 0",
    "DMOVEJ": "P0010 DMOVEJ 60 10 10 20 20 0",
    "MOVEJ of a pose": "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0",
    "MOVEJ_AVOID": "P0010 MOVEJ_AVOID -30 0 10 20 20 0",
    "MOVEJ_POLY5": "P0010 MOVEJ_POLY5 -30 0 10 20 20 0",
    "MOVEJ_TOPP": "P0010 MOVEJ_TOPP -30 0 10 20 20 0",
    "MOVEJ_SPLINE": "P0010 MOVEJ_SPLINE 0 20 -20 0 -20 0; -30 0 10 20 20 0",
    "MOVEL": "P0010 DMOVE 0 0 -200 0 0 0",
    "MOVEL_POLY5": "P0010 DMOVE_POLY5 0 0 -200 0 0 0",
    "MOVEL_SCURVE": "P0010 DMOVE_SCURVE 0 0 -200 0 0 0",
}


def speeds(text):
    """Return the largest speed of {TCP} in each command [mm/s], by an independent reader."""
    found = {}
    for step, done in read(text)[1].items():
        points = ARM.poses(done.sample())[0]
        rates = np.linalg.norm(np.diff(points, axis=0), axis=1)
        found[step] = float(rates.max() / (done.duration / (len(points) - 1)))
    return found


@pytest.mark.parametrize("ceiling", [40, 250])
@pytest.mark.parametrize("line", ALONE.values(), ids=ALONE)
def test_it_is_kept_and_reached(line, ceiling):
    made, findings = compiled(f"{HEAD}{line} [V<={ceiling}]")
    assert not [one for one in findings if one.is_error], findings
    (command,) = made.certificate.commands
    fastest = speeds(made.text)[0]
    assert fastest <= ceiling * 1.001
    proved = command.zone_speed
    assert proved.of_motion
    assert fastest <= proved.largest * 1e3 * (1 + 1e-9) <= ceiling * 1.001
    free, _ = compiled(f"{HEAD}{line} [MIN]")
    if speeds(free.text)[0] > 1.1 * ceiling:
        assert fastest > 0.98 * ceiling
    else:
        assert command.duration < free.certificate.commands[0].duration * 1.02


def test_a_ceiling_that_is_never_reached_costs_no_time():
    line = ALONE["MOVEL"]
    made, _ = compiled(f"{HEAD}{line} [V<=5000]")
    free, _ = compiled(f"{HEAD}{line} [MIN]")
    assert made.certificate.commands[0].duration <= free.certificate.commands[0].duration * 1.001


CHAIN = """P0010 DMOVE 100 0 0 0 0 0 [V<={0}] BLEND 10
P0020 DMOVE 0 0 -100 0 0 0 [V<={1}] BLEND 10
P0030 DMOVE -100 0 0 0 0 0 [V<={2}] BLEND 10
P0040 DMOVE 0 0 100 0 0 0 [V<={3}]
"""


@pytest.mark.parametrize("said", [(200, 50, 300, 30), (20, 200, 20, 200), (50, 50, 50, 50)])
def test_chains_keep_to_each_and_to_the_larger_one_in_a_corner(said):
    made, findings = compiled(HEAD + CHAIN.format(*said))
    assert not [one for one in findings if one.is_error], findings
    for step, fastest in speeds(made.text).items():
        around = said[max(0, step - 1) : step + 2]
        assert fastest <= max(around) * 1.001
    for command, own in zip(made.certificate.commands, said, strict=True):
        proved = command.zone_speed
        assert proved.largest <= proved.limit * 1.001
        assert proved.limit >= own * 1e-3 * (1 - 1e-9)


def test_long_chains_keep_them():
    turns = "\n".join(
        (
            f"P{10 * n:04d} DMOVE {3 * math.cos(n / 40):.3f} {3 * math.sin(n / 40):.3f} 0 0 0 0 {{B}} "
            f"[V<={30 if 20 < n < 40 else 60}] BLEND 0.3"
        )
        for n in range(2, 62)
    )
    text = (
        HEAD.replace("{B}\n", "{B}\n", 1)
        + re.sub(r" \{B\} (\[V<=\d+\])", r" \1 {B}", turns)
        + "\nP0900 WAIT [1]"
    )
    made, findings = compiled(text)
    assert not [one for one in findings if one.is_error], findings
    fastest = list(speeds(made.text).values())
    assert max(fastest) <= 60 * 1.001
    assert max(fastest[21:36]) <= 30 * 1.002
    assert max(fastest) > 50


def test_several_frames_keep_their_own():
    text = HEAD + (
        "FRAME {TIP} 0 0 300 0 0 0 {TCP}\n"
        "P0010 MOVEJ {TIP} -30 0 10 90 20 0 [V<=100]\n"
        "P0020 MOVEJ -30 0 10 0 20 0 [V<=100]"
    )
    made, findings = compiled(text)
    assert not [one for one in findings if one.is_error], findings
    assert [command.zone_speed.part for command in made.certificate.commands] == ["{TIP}", "{TCP}"]
    tip = next(step for step in made.program.steps).origin.tool
    flange_from_tip = made.plan.robot.flange_from_frame["TCP"] @ tip.parent_from_frame
    done = read(made.text)[1][0]
    points = tool_poses(made.plan.robot.chain, np.radians(done.sample()), flange_from_tip)[:, :3, 3]
    fastest = np.linalg.norm(np.diff(points, axis=0), axis=1).max() / (done.duration / (len(points) - 1))
    assert 0.098 < fastest <= 0.1 * 1.001


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=0]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=-5]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=5 6]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [<=5]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=$(0)]", ["Y0407"]),
        ("P0010 MOVEJ 0 0 0 0 0 0 [V<=nan]", ["Y0407"]),
        ("P0010 WAIT [V<=5]", ["Y0405"]),
    ],
)
def test_ceilings_that_are_none(line, expected):
    found = codes(compiled(HEAD + line)[1])
    assert len(found) == 1
    assert found == expected or found[0].startswith("Y04")


@pytest.mark.parametrize("units", ["(deg,s)", "(mm,deg)"])
def test_it_needs_a_length_and_a_time(units):
    found = compiled(f"P0010 MOVEJ 0 0 0 0 30 0 [V<=100] {units}")[1]
    assert codes(found) == ["Y0304"]


# the judge's findings about texts that are faster than their ceiling


@pytest.mark.parametrize("line", [ALONE["MOVEJ"], ALONE["MOVEL"], ALONE["MOVEJ_SPLINE"]])
def test_a_text_that_is_faster_is_refused(line):
    asked, _ = compiled(f"{HEAD}{line} [V<=60]")
    faster, _ = compiled(f"{HEAD}{line} [V<=60.5]")
    robot, claims = asked.plan.robot, Claims({0: faster.plan.motions[0].waypoints})
    found = certify(faster.text, asked.program, robot, robot.tolerance, claims).diagnostics
    (said,) = [one for one in found if one.is_error]
    assert said.code == "Y1167"
    assert re.search(r"\{TCP\} moves at 60\.\d+ mm/s, and \[V<=\.\.\.\] allows 60 mm/s", said.message)
    claims = Claims({0: asked.plan.motions[0].waypoints})
    assert not has_errors(certify(asked.text, asked.program, robot, robot.tolerance, claims).diagnostics)


def test_a_planner_that_forgets_the_ceiling_is_found(monkeypatch):
    monkeypatch.setattr(zones, "ceiling_watch", _faster)
    _, findings = compiled(f"{HEAD}{ALONE['MOVEJ']} [V<=60]")
    assert "Y1167" in codes(findings)


def _faster(robot, moving, speed):
    from yarclang.collision.zones.ceiling import ceiling_watch

    return ceiling_watch(robot, moving, 1.5 * speed)


def test_a_bound_that_is_no_number_is_refused(monkeypatch):
    whole = ceilings.fastest_in

    def broken(*given):
        found = whole(*given)
        found.speed[:] = np.nan
        return found

    monkeypatch.setattr(ceilings, "fastest_in", broken)
    _, findings = compiled(f"{HEAD}{ALONE['MOVEJ']} [V<=60]")
    assert "Y1167" in codes(findings)


BESIDE = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 60 1174.4 1176 0 0 0 [FIRST] BLEND 0
P0030 MOVEL 140 1174.4 1176 0 0 0 [SECOND]
P0050 STOP
"""


@pytest.mark.parametrize(
    ("first", "second"),
    [("V<=30", "1"), ("2", "V<=30"), ("4", "V<=60"), ("V<=20", "V<=20"), ("V<=10", "3"), ("V<=30", "V<=20")],
)
def test_a_long_blend_without_a_ball_doesnt_free_a_ceiling(first, second):
    """Only beside the corner may a motion be as fast as its neighbour, however long the map's blend is."""
    program = BESIDE.replace("FIRST", first).replace("SECOND", second)
    made, findings = compiled(program)
    assert not [one for one in findings if one.is_error], findings
    steps = list(re.finditer(r"(?m)^; command (?:1|2) .* (\d+) (\d+)(?: blend \d+)?$", made.text))
    size = min(int(one[2]) - int(one[1]) for one in steps)
    text = re.sub(r"(?m)^(; command 1 .*) blend \d+$", rf"\1 blend {2 * size}", made.text)
    # ceilings below what the text does
    for slower in ({"FIRST": "V<=3"}, {"SECOND": "V<=3"}):
        said = BESIDE.replace("FIRST", slower.get("FIRST", first)).replace(
            "SECOND", slower.get("SECOND", second)
        )
        other, found = compiled(said)
        assert other is not None, found
        judged = certify(text, other.program, robot_of("INDUSTRIAL6"), other.certificate.tolerance)
        assert "Y1167" in codes(judged.diagnostics), slower
