"""What the checker once accepted and mustn't: ends that no piece shows, commands that aren't told, names
that it doesn't know.
"""

import hashlib
import json
import re
from fractions import Fraction

import pytest

from tests.verify.proof_forging import MOTIONS, WAYS, made, table
from yarclang.verify.exact import ONE, PI, RefusedError, fixed, sine_and_cosine
from yarclang.verify.paths import arc
from yarclang.verify.verdict import verify

SHORT = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 150 1174.4 1176 0 0 0 [4] BLEND 4
P0030 MOVEL 150 1164.4 1176 0 0 5 [2]
P0040 STOP
"""
"""A last line that is shorter than a ball may be."""


def ends_elsewhere(off):
    """Return the verdict about SHORT with a ball of 40 mm, whose last line is all blend, and leads `off` deg
    of J1 away from its goal.

    The proof follows the last line at its end only.
    """
    text, _ = made(SHORT)
    proof, lines = table(SHORT), text.split("\n")
    maps = [k for k, line in enumerate(lines) if line.startswith("; command ")]
    whole = re.fullmatch(r"(; command 1 .* ([0-9]+) ([0-9]+)) blend [0-9]+", lines[maps[1]])
    short = re.fullmatch(r"; command 2 .* ([0-9]+) ([0-9]+)", lines[maps[2]])
    a, b = (
        [k - 1 for k in range(int(first), int(last) + 1) if lines[k - 1].startswith("X")]
        for first, last in (whole.groups()[1:], short.groups())
    )
    count = len(b) + 2
    lines[maps[1]] = f"{whole[1]} blend {2 * count}"
    for number, k in enumerate(b):
        u = number / (len(b) - 1)
        by = off * u**3 * (10 - 15 * u + 6 * u * u)
        lines[k] = re.sub(r"X(-?[0-9.]+)", lambda one, by=by: f"X{float(one[1]) + by:.6f}", lines[k])
    forged = "\n".join(lines)
    end = (len(a) + count) << 20
    proof["text"] = hashlib.sha256(forged.encode()).hexdigest()
    proof["program"]["steps"][1]["blend"] = [40, 0]
    proof["motions"]["2"] |= {"pieces": 1, "s": [10**10], "rates": [0], "from": end, "until": end}
    return verify(forged.encode(), json.dumps(proof).encode())


def test_the_end_of_a_chain_that_blends_take_whole_is_at_its_goal():
    assert ends_elsewhere(0.0).refused == ""
    for off in (-0.2, -0.01):
        assert "P0030 MOVEL 4, from its path: " in ends_elsewhere(off).refused


def judged(change):
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    change(proof)
    return verify(text.encode(), json.dumps(proof).encode())


def test_every_command_is_told_so_that_a_motion_cannot_be_left_out_unseen():
    verdict = judged(lambda _: None)
    for step in table(MOTIONS)["program"]["steps"]:
        how = step.get("move", "no motion")
        assert any(one.startswith(f"{step['title']}: {how}") for one in verdict.told)


def test_what_the_checker_does_not_know_of_a_command_leaves_the_command_unchecked():
    steps = table(MOTIONS)["program"]["steps"]
    for at, step in enumerate(steps):
        verdict = judged(lambda proof, at=at: proof["program"]["steps"][at].update(offset=1))
        said = f"{step['title']}: all of it, since this checker doesn't know its offset"
        assert verdict.refused == ""
        assert said in verdict.unchecked
    at = next(at for at, step in enumerate(steps) if "through" in step)
    verdict = judged(lambda proof: proof["program"]["steps"][at]["through"][0].update(offset=1))
    assert any("doesn't know its offset" in one for one in verdict.unchecked)


def test_what_the_checker_does_not_know_of_program_or_bodies_is_refused():
    body = {"name": "b", "joint": 0, "margin": 0, "core": [1, 1, 1], "disc": 0, "radius": 0}
    body["pose"] = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]
    assert judged(lambda proof: proof["cell"]["bodies"].append(body)).refused == ""
    changes = (
        lambda proof: proof.update(offset=1),
        lambda proof: proof["program"].update(offset=1),
        lambda proof: proof["cell"].update(offset=1),
        lambda proof: proof["robot"].update(offset=1),
        lambda proof: proof["cell"]["bodies"].append(body | {"offset": 1}),
    )
    for change in changes:
        assert judged(change).refused


def test_a_zone_of_which_the_checker_does_not_know_all_is_named():
    zone = {"name": "z", "rule": "forbidden", "margin": 0, "watched": []}
    zone["region"] = {"core": [1, 1, 1], "disc": 0, "radius": 0, "pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 9]}
    assert "the zone z" not in judged(lambda proof: proof["cell"]["zones"].append(zone)).unchecked
    for strange in (zone | {"during": [0, 1]}, zone | {"region": zone["region"] | {"offset": 1}}):
        assert "the zone z" in judged(lambda proof, one=strange: proof["cell"]["zones"].append(one)).unchecked


def test_a_straight_way_is_told_with_one_goal():
    def by_the_way(proof):
        through = proof["program"]["steps"][0]["through"]
        through.insert(0, {"q": [60, 0, 0, 0, 0, 0]})

    assert judged(by_the_way).refused == "P0010 MOVEJ 4: a straight way has one goal"


def test_what_is_told_of_another_kind_of_motion_leaves_the_command_unchecked():
    def with_goals(proof):
        proof["program"]["steps"][1]["through"] = [{"q": [60, 0, 0, 0, 0, 0]}]

    def with_time(proof):
        proof["program"]["steps"][2]["duration"] = 4

    for change, name in ((with_goals, "through"), (with_time, "duration")):
        verdict = judged(change)
        assert not verdict.refused
        assert any(f"doesn't know its {name}" in one for one in verdict.unchecked)


def test_after_each_barrier_the_robot_is_led_to_where_it_is_proved_to_stand():
    """Ways may end apart by the last digit of a text, which may be its third."""
    text, _ = made(WAYS)
    stand = re.compile(r"(?<=STOP\n)RAPID\nABS\n.*\nDWELL0\nSPLINE1\n")
    assert len(stand.findall(text)) == 3
    for number in range(3):
        ends = [found.span() for found in stand.finditer(text)]
        begin, end = ends[number]
        lines = text[begin:end].count("\n")
        here = text[:begin].count("\n") + 1

        def later(found, here=here, lines=lines):
            return found[1] + " ".join(
                str(int(one) - lines * (int(one) > here)) for one in found[2].split(" ")
            )

        forged = text[:begin] + text[end:]
        forged = re.sub(r"(?m)^(; command \d+ \S+ \S+ \d+ )(\d+ \d+)$", later, forged)
        forged = re.sub(r"(?m)^(; barrier )(\d+)(?= )", later, forged)
        proof = table(WAYS)
        proof["text"] = hashlib.sha256(forged.encode()).hexdigest()
        reason = verify(forged.encode(), json.dumps(proof).encode()).refused
        assert "after a barrier, a RAPID to where the robot stands belongs here" in reason


def test_an_arc_that_is_nearly_a_circle_is_not_defined_by_its_points():
    for lacking in (Fraction(1, 200), Fraction(1, 300)):
        sweep = Fraction(PI, ONE) * 2 - lacking
        sine, cosine = sine_and_cosine(fixed(sweep))
        told = {
            "centre": [0, 0, 0],
            "spoke": [1, 0, 0],
            "side": [0, 1, 0],
            "sweep": sweep,
            "via": Fraction(1, 2),
        }
        half = sine_and_cosine(fixed(sweep) // 2)
        ends = ([ONE, 0, 0], [cosine, sine, 0], told, [half[1], half[0], 0])
        if lacking > Fraction(1, 256):
            assert arc(*ends)
        else:
            with pytest.raises(RefusedError, match="an arc has other numbers"):
                arc(*ends)
