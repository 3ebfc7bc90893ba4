"""Forgeries that the checker once accepted.

They have ends that no piece covers, commands that aren't listed, or names that the checker doesn't know.
"""

import hashlib
import json
import re
from fractions import Fraction

import pytest

from tests.verify.proof_forging import MOTIONS, WAYS, made, table
from tests.verify.test_conditions import KEPT
from yarclang.verify.arm import Arm
from yarclang.verify.course import Moved
from yarclang.verify.exact import ONE, PI, RefusedError, fixed, sine_and_cosine
from yarclang.verify.paths import arc
from yarclang.verify.reader import Entry
from yarclang.verify.room import _zone
from yarclang.verify.verdict import Verdict, _list_allowed, verify

EYE = [Fraction(k % 5 == 0) for k in range(12)]
"""An identity pose (3 rows of 4 numbers)."""
SHORT = """DEFAULT {TCP} [3] (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]
P0020 MOVEL 150 1174.4 1176 0 0 0 [4] BLEND 4
P0030 MOVEL 150 1164.4 1176 0 0 5 [2]
P0040 STOP
"""
"""A program whose last line is shorter than a blend zone may be."""


def ends_elsewhere(off):
    """Return the verdict about SHORT with a blend zone of 100 mm, and an end that is off in J1 by `off` deg.

    The last line is completely in the blend, and the proof follows it only at its end.
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
    proof["program"]["steps"][1]["blend"] = [100, 0]
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
        assert verdict.refused == ""
        said = [one for one in verdict.unchecked if one.startswith(f"{step['title']}: ")]
        assert len(said) == 1
        assert "all of it, since this checker doesn't know its offset" in said[0].replace("\\'", "'")
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
    """The RAPID after a barrier may not be left out: the ends of branches may differ in a text's last
    decimal, which may be the third one.
    """
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


def kept_with(change):
    """Return the verdict about a text and a proof in which the lines of path constraints are changed."""
    text, _ = made(KEPT)
    lines = [line for line in text.split("\n") if line.startswith("; keep ")]
    count = len(text.split("\n"))
    forged = text.replace("\n".join(lines), "\n".join(change(list(lines))))
    assert forged != text
    assert len(forged.split("\n")) == count  # numbers of lines in the map stay right
    proof = table(KEPT, bodies=True)
    registers = proof["program"]["registers"]
    first = registers.index(lines[0])
    registers[first : first + len(lines)] = change(list(lines))
    proof["text"] = hashlib.sha256(forged.encode()).hexdigest()
    return verify(forged.encode(), json.dumps(proof).encode())


def renumbered(lines, step):
    """Return the lines, with another command in the last line."""
    return [*lines[:-1], re.sub("^; keep [0-9]+", f"; keep {step}", lines[-1])]


@pytest.mark.parametrize("step", [5, 999])
def test_a_path_constraint_of_no_motion_is_refused(step):
    """Otherwise the map could state a rule that no motion has to keep."""
    assert "is for a command without moves" in kept_with(lambda lines: renumbered(lines, step)).refused


def test_path_constraints_out_of_order_or_twice_are_refused():
    assert "out of order" in kept_with(lambda lines: lines[::-1]).refused
    assert "stands twice" in kept_with(lambda lines: [lines[0], lines[0], *lines[2:]]).refused


@pytest.mark.parametrize(
    ("old", "new"),
    [("60%20%28deg%29", "60%20%28mm%29"), ("500%20%28mm%29", "500%20%28deg%29"), ("deg%2Cmm", "deg")],
)
def test_a_path_constraint_in_another_unit_is_refused(old, new):
    assert "another unit" in kept_with(lambda lines: [line.replace(old, new) for line in lines]).refused


def test_a_half_space_with_a_size_is_refused():
    """If a proof omits the core of a forbidden sphere, the zone isn't taken for a half-space."""
    arm = Arm(table(KEPT)["robot"] | {"arm": [EYE] * 7})
    zone = {"name": "BALL", "rule": "forbidden", "margin": Fraction(0), "watched": []}
    half = {"pose": EYE}
    assert _zone(zone | {"region": half}, arm)[0]
    with pytest.raises(RefusedError, match="a half-space that has a size"):
        _zone(zone | {"region": half | {"radius": Fraction(1, 2)}}, arm)


def test_bodies_that_may_touch_during_a_command_without_moves_are_refused():
    bodies, still = (
        [{"name": "link_1"}, {"name": "TABLE"}],
        Moved(Entry(0, "P0010", 0, 0, None, False), (), ()),
    )
    for step in (0, 999):
        with pytest.raises(RefusedError, match="is for a command without moves"):
            _list_allowed([f"; allow {step} LINK_1 TABLE"], bodies, [still], Verdict())
