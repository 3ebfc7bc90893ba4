"""Tests of limits that a program lowers ([50%], ACC): a text that is faster is refused."""

import random
import re

import pytest
from programs import codes, compiled

from yarclang.certify import certify
from yarclang.pipeline.stages import claims_of

JOINTS = """ROBOT INDUSTRIAL6
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ 60 0 -20 0 30 0 [FIRST]
P0020 MOVEJ_LSPB 0 0 -20 0 30 0 [SECOND]
"""
LINES = """ROBOT INDUSTRIAL6
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL_LAW 60 1174.4 1176 0 0 0 [FIRST] BLEND
P0030 MOVEL_LAW 60 1174.4 1236 0 0 0 [SECOND]
"""


def made_of(text):
    made, findings = compiled(text)
    assert made is not None, findings
    return made


def judged(made, asked):
    """Judge the text of one program against another one."""
    robot = asked.plan.robot
    found = certify(made.text, asked.program, robot, robot.tolerance, claims_of(asked.plan)).diagnostics
    return [one for one in found if one.is_error]


def with_times(text, first, second):
    """Return the program with two times, each with its options."""
    for place, time in (("[FIRST]", first), ("[SECOND]", second)):
        text = text.replace(place, time)
    return text


@pytest.mark.parametrize(
    ("quick", "slow", "found"),
    [
        (("[MIN]", "[MIN]"), ("[10%]", "[MIN]"), {"Y1157", "Y1158"}),
        (("[MIN]", "[MIN]"), ("[MIN]", "[MIN] ACC 5%"), {"Y1157"}),
        (("[51%]", "[MIN]"), ("[50%]", "[MIN]"), {"Y1157", "Y1158"}),
        (("[MIN]", "[60%] ACC 30%"), ("[MIN]", "[60%] ACC 25%"), {"Y1157"}),
        (("[MIN]", "[3]"), ("[MIN]", "[3] ACC 20%"), {"Y1157"}),
        (("[20%]", "[20%]"), ("[21%]", "[20%]"), set()),
        (("[20%] ACC 30%", "[20%]"), ("[20%]", "[20%]"), set()),
    ],
)
def test_a_text_is_not_faster_than_its_program(quick, slow, found):
    made, asked = made_of(with_times(JOINTS, *quick)), made_of(with_times(JOINTS, *slow))
    assert set(codes(judged(made, asked))) == found


def test_the_finding_says_what_is_allowed():
    made = made_of(with_times(JOINTS, "[MIN]", "[MIN]"))
    (first, *_) = judged(made, made_of(with_times(JOINTS, "[10%]", "[MIN]")))
    assert re.match(
        r"P0010 MOVEJ: J\d has a peak velocity of \d+\.\d+ deg/s, 99\.98% of its limit of \d+ deg/s; "
        r"the program allows 10% of it, \d",
        first.message,
    ), first.message


@pytest.mark.parametrize("law", ["LSPB", "SCURVE", "POLY5", "TOPP"])
@pytest.mark.parametrize("blend", ["", "BLEND 8"])
def test_motions_that_flow(law, blend):
    """In a blend the larger percentage applies; outside of it each motion has its own."""
    text = LINES.replace("LAW", law).replace("BLEND", blend)
    slow, steep, both = (
        made_of(with_times(text, *pair))
        for pair in (("[20%]", "[20%]"), ("[20%]", "[60%]"), ("[60%]", "[60%]"))
    )
    for made in (slow, steep, both):
        assert judged(made, made) == []
    assert judged(slow, steep) == judged(slow, both) == judged(steep, both) == []
    for made, asked, commands in ((steep, slow, {"P0030"}), (both, steep, {"P0020"})):
        found = judged(made, asked)
        assert set(codes(found)) <= {"Y1157", "Y1158"}
        # a blend belongs to both motions
        named = {one.message.split()[0] for one in found}
        assert named >= commands if blend else named == commands


@pytest.mark.parametrize("seed", range(4))
def test_honest_texts_keep_small_percentages(seed):
    """Rounded numbers matter most with small percentages."""
    chance = random.Random(seed)
    lines = ["ROBOT INDUSTRIAL6", "DEFAULT {TCP} (mm,deg,s) {B}", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]"]
    x, z = 0.0, 1176.0
    for number in range(4):
        x, z = x + chance.uniform(5, 20), z + chance.uniform(-15, 15)
        law = chance.choice(["", "_LSPB", "_SCURVE", "_POLY5", "_TOPP"])
        time = chance.choice(["[8%]", "[MIN]", "[30%]", "[70%] TOL 0.2", "[6]"])
        ramp = chance.choice(["", " ACC 10%", " ACC 40%"])
        blend = chance.choice(["", " BLEND 1", " BLEND <=8"]) if number < 3 else ""
        lines.append(f"P{20 + number:04d} MOVEL{law} {x:.3f} 1174.4 {z:.3f} 0 0 0 {time}{ramp}{blend}")
    made = made_of("\n".join(lines) + "\n")
    assert judged(made, made) == []
