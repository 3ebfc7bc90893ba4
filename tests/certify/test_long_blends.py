"""Tests of blends at corners without a ball: the map's blend must not be longer than the planner's."""

import re
from dataclasses import replace

import pytest
from programs import codes, compiled

from tests.certify.certify_bench import industrial6
from tests.certify.forging import Forger
from tests.certify.test_certify_blends import Q0
from tests.certify.test_certify_blends import judge as judge_jobs
from tests.certify.test_certify_tangents import straight
from yarclang.certify import certify
from yarclang.certify.certifying import certify_text
from yarclang.certify.claims import Claims
from yarclang.pipeline.stages import claims_of

LINES = """ROBOT INDUSTRIAL6
OUTPUT GLUE M20 OFF
DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 60 1174.4 1176 0 0 0 [FIRST] BLEND 0
P0025 SET GLUE ON
P0030 MOVEL 140 1174.4 1176 0 0 0 [SECOND]
P0050 STOP
"""
JOINTS = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ -40 0 0 0 0 0 [5]
P0020 MOVEJ_TOPP 20 0 0 0 0 0 BLEND 0
P0030 MOVEJ_LAW 40 0 0 0 0 0
P0050 STOP
"""


def lines(first, second):
    return LINES.replace("FIRST", first).replace("SECOND", second)


def made_of(text):
    made, findings = compiled(text)
    assert made is not None, findings
    return made


def judged(text, made, **changed):
    robot = made.plan.robot
    claims = replace(claims_of(made.plan), **changed)
    return codes(certify(text, made.program, robot, robot.tolerance, claims).diagnostics)


def seam(text):
    """Return the map's lines of the two motions beside the corner, split into their parts."""
    form = r"(?m)^; command (\d+) (\S+ MOVE\S+ \d+) (\d+) (\d+)(?: blend (\d+))?( any-jerk)?$"
    return [one for one in re.finditer(form, text) if one[1] != "0"]


def with_seam(text, size):
    """Return the text with the corner after `size` move lines of the first motion, and the longest blend."""
    one, other = seam(text)
    first, last = int(one[3]), int(other[4])
    blend = 2 * min(size, last - first + 3 - size)
    forger = Forger.of(text)
    # an output in the middle of the blend moves with it
    (row,) = [row for row, line in enumerate(forger.lines) if line == "M20==1"] or [None]
    if row is not None:
        forger = forger.drop(row)
        first, last = first - (first > row), last - 1
    one, other = seam(forger.text)
    text = forger.text.replace(
        one[0],
        f"; command {one[1]} {one[2]} {first} {first + size - 1} blend {blend}{one[6] or ''}",
    ).replace(other[0], f"; command {other[1]} {other[2]} {first + size} {last}{other[6] or ''}")
    forger = Forger.of(text)
    return forger.text if row is None else forger.put(first + size - 1, "M20==1").text


@pytest.mark.parametrize(("first", "second"), [("2", "2"), ("2.5", "1.5"), ("3", "1")])
def test_times_and_outputs_dont_follow_the_map(first, second):
    """The text of a motion of 3 s and one of 1 s isn't that of other times."""
    text, other = made_of(lines("3", "1")), made_of(lines(first, second))
    (segment,) = set(re.findall(r"(?m)^TM(.*)$", text.text)[1:])
    size = round(float(first) * 1000 / float(segment))
    found = judged(with_seam(text.text, size), other)
    assert found.count("Y1153") == 1
    assert not set(found) - {"Y1153"}
    assert judged(text.text, text) == []


@pytest.mark.parametrize("law", ["SCURVE", "LSPB", "POLY5"])
def test_a_motion_keeps_its_limit_of_the_jerk(law):
    """A blend over the whole motion would lift it."""
    quick, asked = made_of(JOINTS.replace("LAW", "TOPP")), made_of(JOINTS.replace("LAW", law))
    one, _ = seam(quick.text)
    size = int(one[4]) - int(one[3]) + 1
    text = with_seam(quick.text, size)
    for row in seam(text)[1:]:
        text = text.replace(row[0], row[0].replace("_TOPP", f"_{law}").removesuffix(" any-jerk"))
    assert "Y1153" in judged(Forger.of(text).text, asked)
    assert judged(asked.text, asked) == []


def test_a_claim_only_restricts():
    """Without a claim there is no blend. A longer claim frees nothing that the map doesn't say."""
    made = made_of(lines("3", "1"))
    claims = claims_of(made.plan)
    (step,) = claims.overlaps
    duration = claims.overlaps[step]
    one, _ = seam(made.text)
    (segment,) = set(re.findall(r"(?m)^TM(.*)$", made.text)[1:])
    assert duration == pytest.approx(int(one[5]) * float(segment) / 1000)
    for claim, found in (
        ({}, ["Y1153"]),
        ({step: 0.9 * duration}, ["Y1153"]),
        ({step: float("nan")}, ["Y1153"]),
        ({step: 2 * duration}, []),
    ):
        assert judged(made.text, made, overlaps=claim) == found
    # without the program there is nothing to compare
    source = made.program.source
    assert "Y1153" not in codes(certify_text(made.text, made.plan.robot, source).diagnostics)


def test_the_duration_counts_not_the_number_of_segments():
    """The test's chain has segments of 50 ms."""
    jobs, _ = straight(overlap=12)
    for claimed, found in ((0.6, []), (12 * 0.049, ["Y1153"]), (12 * 0.02, ["Y1153"])):
        result = judge_jobs(industrial6(), Q0, jobs, overlaps={0: claimed})
        assert [one.code for one in result.diagnostics] == found


def test_a_blend_with_a_ball_needs_no_claim():
    made = made_of(lines("3", "1").replace("BLEND 0", "BLEND 5"))
    assert seam(made.text)[0][5]
    assert judged(made.text, made, overlaps={}) == []
    assert Claims().overlaps == {}
