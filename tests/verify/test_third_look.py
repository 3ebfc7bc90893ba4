"""Forgeries of texts and proofs by people who had the checker and one day: all are refused, or told apart."""

import hashlib
import json
import re

import pytest
from programs import compiled

from tests.verify.proof_forging import BLENDED, MOTIONS, WAYS, made, refused, refused_text, table
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.__main__ import printable
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

STRAIGHT = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 60 1174.4 1176 0 0 0 [FIRST] BLEND 0
P0030 MOVEL 140 1174.4 1176 0 0 0 [SECOND]
P0050 STOP
"""
APEX = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY -60 1174.4 1176 0 0 0 [5]
P0020 MOVEL 40 1174.4 1176 0 0 0 [4] BLEND 20
P0030 MOVEL 60 Y 1176 0 0 0 [3] BLEND 20
P0040 MOVEL 80 1174.4 1176 0 0 0 [3] BLEND 20
P0050 MOVEL 180 1174.4 1176 0 0 0 [4]
P0070 STOP
"""
SAYS = 'DEFAULT (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 [2]\nREPEAT 12\n  P0020 SAY "X"\nEND\nP0030 STOP\n'
_MAP = re.compile(r"(?m)^; command (\d+) .* (\d+) (\d+)(?: blend (\d+))?$")
_POINT = re.compile(r"X-?[0-9.]+(Y.*)")


def straight(first, second):
    return STRAIGHT.replace("FIRST", first).replace("SECOND", second)


def verdict(text, proof):
    return verify(text.encode(), json.dumps(proof | {"text": hash_of(text)}).encode())


def hash_of(text):
    return hashlib.sha256(text.encode()).hexdigest()


def with_blend(text, step, segments):
    return re.sub(rf"(?m)^(; command {step} .*) blend \d+$", rf"\1 blend {segments}", text)


@pytest.mark.parametrize(
    ("said", "runs"),
    [
        (("V 10", "V 50"), ("V 50", "V 50")),
        (("V<=10", "V 50"), ("V 50", "V 50")),
        (("V 50", "V 10"), ("V 50", "V 50")),
        (("V<=10", "3"), ("V 50", "3")),
    ],
)
def test_a_blend_without_a_ball_doesnt_free_speeds(said, runs):
    """The larger speed of two motions applies only beside their corner, however long the map's blend is."""
    text, _ = made(straight(*runs))
    forged = table(straight(*runs))
    forged["program"]["steps"] = table(straight(*said))["program"]["steps"]
    size = {int(step): int(last) - int(first) + 1 for step, first, last, _ in _MAP.findall(text)}
    for segments in (0, 2, 2 * min(size[1], size[2])):
        longer = with_blend(text, 1, segments)
        found = refused(longer, forged | {"text": hash_of(longer)})
        assert found, segments


@pytest.mark.parametrize(
    ("first", "second"),
    [("V 20", "V 20"), ("V 20", "V 25"), ("V<=10", "3"), ("2", "V<=30"), ("V 60", "5"), ("4", "3")],
)
def test_honest_corners_without_a_ball_are_decided(first, second):
    found, _ = compiled(straight(first, second))
    proof = proof_of(found)
    assert proof.value is not None, proof.diagnostics
    checked = verify(found.text.encode(), proof.value.encode())
    assert (checked.refused, set(checked.unchecked) - set(ALWAYS_UNCHECKED)) == ("", set())


def test_a_corner_that_is_passed_at_an_instant_has_its_ball():
    """Neighbours that are both followed at one instant only don't skip the corner between them."""
    ways = APEX.replace("60 Y", "60 1139.7589838486225"), APEX.replace("60 Y", "60 1174.4")
    (text, _), told = made(ways[1].replace("BLEND 20", "BLEND 0")), table(ways[0])
    forged = table(ways[1].replace("BLEND 20", "BLEND 0"))
    sizes = [int(last) - int(first) + 1 for _, first, last, _ in _MAP.findall(text)]
    longer = with_blend(with_blend(with_blend(text, 1, 2 * sizes[2]), 2, 0), 3, 2 * sizes[3])
    motions = forged["motions"]
    at = (motions["2"]["until"] + motions["3"]["from"]) // 2
    for step in "23":
        own = {name: told["motions"][step][name] for name in ("axis", "angle")}
        motions[step] = own | {"pieces": 1, "s": [5 * 10**9], "rates": [0], "from": at, "until": at}
    for step in "123":
        motions[step]["corner"] = 8
    forged["program"]["steps"] = told["program"]["steps"]
    assert "from its corner" in refused(longer, forged | {"text": hash_of(longer)})


def test_rapids_dont_creep():
    """The RAPIDs after barriers lead to where the robot stands, to the last digit."""
    text, _ = made(SAYS)
    lines, off = text.split("\n"), 0
    for number, line in enumerate(lines):
        if lines[number - 3 : number] == ["STOP", "RAPID", "ABS"] and (point := _POINT.fullmatch(line)):
            off += 1
            lines[number] = f"X10.000{off:03d}{point[1]}"
    assert off > 10
    assert "a RAPID to where the robot doesn't stand" in refused_text(SAYS, "\n".join(lines))


def test_a_rapid_on_a_way_that_has_ended_leads_nowhere_else():
    program = WAYS.replace("  P0040 MOVEJ 20 0 0 0 0 0 [2]\n", "  P0040 STOP\n")
    text, _ = made(program)
    lines = text.split("\n")
    for number in range(3, len(lines)):
        if lines[number - 3 : number] == ["STOP", "RAPID", "ABS"]:
            forged = [*lines[:number], lines[number].replace("X", "X9", 1), *lines[number + 1 :]]
            assert refused_text(program, "\n".join(forged))


def test_motions_that_the_map_gives_no_moves_are_none():
    text, _ = made(BLENDED)
    forged = re.sub(r"(?m)^(; command 1 .*) \d+ \d+ blend \d+$", r"\1 0 0 blend 2", text)
    assert forged != text
    assert refused_text(BLENDED, forged)


def test_the_guard_is_told_and_its_buffer_is_a_controller_s():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    assert any(one.startswith("guard: I16 ") for one in verdict(text, proof).told)
    forged = re.sub("DEFINE ROT .*", "DEFINE ROT 999999999", text)
    assert "memory" in refused_text(MOTIONS, forged)


def test_outputs_are_told_with_the_motion_before_them():
    text, _ = made(MOTIONS)
    told = verdict(text, table(MOTIONS)).told
    assert next(one for one in told if one.endswith(": put M20=1")).startswith("after P0020 MOVEL")


def test_dwells_are_the_controller_s_and_none_is_untold():
    text, _ = made(MOTIONS)
    assert refused_text(MOTIONS, text.replace("DWELL500", "DWELL9999999"))
    assert "DWELL0" in refused_text(MOTIONS, text.replace("DWELL500", "DWELL500\nDWELL0"))


def test_strings_dont_look_like_numbers():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    steps = proof["program"]["steps"]
    last = next(step for step in reversed(steps) if "through" in step)
    last["through"][0]["q"] = ["10; speed [9, 9]", 0]
    last["unchecked"] = "torques"
    found = verdict(text, proof)
    assert not found.refused
    assert any('q ["10; speed [9, 9]", ' in one for one in found.told)
    assert any("path, goal, time and speed (the proof says 'torques')" in one for one in found.unchecked)
    last["any_jerk"] = "false"
    assert "any_jerk" in verdict(text, proof).refused


def test_a_report_is_ascii():
    assert printable("\u0441up \u202e x\n") == "\\u0441up \\u202e x\\u000a"


BODY = {"name": "DOOR", "joint": 0, "margin": 0.1, "core": [0.1, 0.1, 0.1], "disc": 0, "radius": 0}
BODY |= {"pose": [1, 0, 0, 9, 0, 1, 0, 9, 0, 0, 1, 9]}


def with_bodies(*bodies, zones=(), program=MOTIONS):
    return table(program) | {"cell": {"bodies": list(bodies), "exceptions": [], "zones": list(zones)}}


def test_a_body_that_is_there_only_while_the_robot_stands_is_refused():
    text, _ = made(MOTIONS)
    assert verdict(text, with_bodies(BODY | {"during": [[0, 1]]})).refused == ""
    assert "commands without moves" in verdict(text, with_bodies(BODY | {"during": [[2, 2]]})).refused


@pytest.mark.parametrize("point", ["False", "", 1.5, None])
def test_a_point_is_true_or_false(point):
    text, _ = made(MOTIONS)
    assert "neither true nor false" in verdict(text, with_bodies(BODY | {"point": point})).refused


def test_a_zone_watches_each_body_once_and_bodies_of_one_name_are_told_apart():
    text, _ = made(MOTIONS)
    region = {"pose": [1, 0, 0, 20, 0, 1, 0, 0, 0, 0, 1, 0]}
    zone = {"name": "WALL", "rule": "forbidden", "margin": 0, "region": region, "watched": [0, 0]}
    assert "watches a body twice" in verdict(text, with_bodies(BODY, BODY, zones=[zone])).refused
    named = verdict(text, with_bodies(BODY | {"name": "DOOR joint 6"})).told
    assert any(one.startswith('body 0 "DOOR joint 6" [m]: joint 0 ') for one in named)
    told = [
        next(
            one
            for one in verdict(text, with_bodies(BODY, BODY, zones=[zone | {"watched": [k]}])).told
            if one.startswith("zone ")
        )
        for k in (0, 1)
    ]
    assert [one.rpartition(" bodies ")[2] for one in told] == ["0 DOOR", "1 DOOR"]


def test_corners_are_told_by_their_hash():
    text, _ = made(MOTIONS)
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    told = [
        next(
            one
            for one in verdict(text, with_bodies(BODY | {"corners": corners[:k]})).told
            if one.startswith("body ")
        )
        for k in (7, 8)
    ]
    assert told[0] != told[1]
    assert "8 of SHA-256 " in told[1]


def test_without_moves_nothing_is_said_of_where_the_robot_stands():
    program = "OUTPUT LAMP M20 OFF\nP0010 SET LAMP ON\nP0020 STOP\n"
    text, _ = made(program)
    left = verdict(text, with_bodies(BODY, program=program)).unchecked
    assert any("where the robot stands" in one for one in left)
