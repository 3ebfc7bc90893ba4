"""Parts stay where they are between the times at which grippers take and release them.

A part that the proof has elsewhere is refused, or listed as unchecked.
"""

import copy
import hashlib
import json
import re
from functools import cache
from pathlib import Path

import pytest

from tests.verify.test_verdict import own
from yarclang import compile as compile_text
from yarclang.pipeline.proofs import proof_of
from yarclang.pipeline.stages import Compiled
from yarclang.verify.parts import follow
from yarclang.verify.verdict import verify

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
CHECKED = "parts stay where they are when the arm takes or leaves them"


@cache
def made(name):
    source = EXAMPLES / name
    found = compile_text(source.read_text(), name=source.name, folder=source.parent)
    assert isinstance(found.value, Compiled)
    proof = proof_of(found.value)
    assert proof.value is not None
    return found.value.text, proof.value


def judged(change):
    """Return the verdict about a program that carries parts, after a change of the first part's bodies.

    There are no planes, which have tests of their own.
    """
    text, proof = made("05_pick_and_place.yarc")
    forged = json.loads(proof) | {"planes": []}
    bodies = [body for body in forged["cell"]["bodies"] if body["name"] == "BLANK 1"]
    forged["cell"] = {"bodies": bodies, "exceptions": [], "zones": []}
    change(bodies, forged)
    return verify(text.encode(), json.dumps(forged).encode())


def left(verdict):
    return [one for one in own(verdict) if not one.startswith("that BLANK")]


def test_a_part_that_is_taken_and_left_is_checked():
    verdict = judged(lambda *_: None)
    assert verdict.refused == ""
    assert left(verdict) == []
    assert CHECKED in verdict.checked


def shifted(at, place, by):
    def change(bodies, _):
        bodies[at]["pose"][place] += by

    return change


def turned(bodies, _):
    pose = bodies[1]["pose"]
    for row in (0, 4, 8):
        pose[row : row + 2] = pose[row + 1], -pose[row]


WRONG = {
    "elsewhere on the arm": shifted(1, 3, 0.01),
    "elsewhere on the feeder": shifted(0, 7, -0.00001),
    "elsewhere on the press": shifted(2, 11, 0.01),
    "turned in the gripper": turned,
    "another size": lambda bodies, _: bodies[1].update(core=[0.01, 0.01, 0.01]),
    "a ball in the gripper": lambda bodies, _: bodies[1].update(radius=0.01),
    "on another link": lambda bodies, _: bodies[1].update(joint=5),
    "in two places": lambda bodies, _: bodies[0].update(during=[[1, 5]]),
    "another mesh": lambda bodies, _: bodies[1].update(corners=[[0, 0, 0], [0, 0, 0.01]]),
    "backwards": lambda bodies, _: bodies[1].update(during=[[7, 5]]),
}


@pytest.mark.parametrize("change", WRONG)
def test_a_part_that_is_told_elsewhere_is_refused(change):
    refused = judged(WRONG[change]).refused
    assert "BLANK 1" in refused, refused


NAMED = {
    "never taken": (lambda bodies, _: bodies.pop(0), "from where the arm has BLANK 1"),
    "never left": (lambda bodies, _: bodies.pop(2), "where the arm leaves BLANK 1"),
    "taken in flight": (
        lambda bodies, _: bodies[1].update(during=[[6, 7]]),
        "from where the arm has BLANK 1",
    ),
    "a point": (
        lambda bodies, _: bodies[0].update(point=True, core=[0, 0, 0], radius=0),
        "when BLANK 1 is watched",
    ),
}


@pytest.mark.parametrize("change", NAMED)
def test_a_part_of_which_something_is_not_shown_is_named(change):
    how, named = NAMED[change]
    verdict = judged(how)
    assert verdict.refused == ""
    assert any(one.startswith(named) for one in left(verdict)), left(verdict)


def test_a_part_is_taken_only_where_an_output_is_set():
    """If the SET is left out of text and proof, the arm can't take the part."""
    text, proof = made("05_pick_and_place.yarc")
    told = json.loads(proof)
    course = told["program"]["course"]
    put = next(deed for deed in course[course.index("move 2") :] if deed.startswith("put "))
    lines = text.split("\n")
    last = int(next(line for line in lines if line.startswith("; command 2 ")).split()[-1])
    at = next(k for k in range(last, len(lines)) if lines[k] == put.removeprefix("put "))
    lines[at] = "DWELL1"
    forged = "\n".join(lines)
    said = course.copy()
    said[said.index(put)] = "dwell 1"
    duration = re.search(r"; duration ([0-9.]+) s", forged)
    forged = forged.replace(duration[0], f"; duration {float(duration[1]) + 0.001:.3f} s")
    changed = copy.deepcopy(told) | {"text": hashlib.sha256(forged.encode()).hexdigest(), "planes": []}
    changed["program"]["course"] = said
    changed["cell"] = told["cell"] | {"exceptions": [], "zones": []}
    assert "no output is set there" in verify(forged.encode(), json.dumps(changed).encode()).refused


@pytest.mark.parametrize("name", ["27_bin_picking.yarc", "29_tool_changer.yarc"])
def test_parts_on_ways_that_part_and_tools_of_several_bodies_are_checked(name):
    text, proof = made(name)
    told = json.loads(proof) | {"planes": []}
    told["cell"] |= {"exceptions": [], "zones": []}
    bodies = told["cell"]["bodies"]
    held = [body for body in bodies if "during" in body and body["joint"] > 0 and not body.get("point")]
    told["cell"]["bodies"] = [body for body in bodies if body["name"] in {one["name"] for one in held}]
    verdict = verify(text.encode(), json.dumps(told).encode())
    assert verdict.refused == ""
    assert CHECKED in verdict.checked
    assert not any("where" in one and "offset" not in one and "shift" not in one for one in left(verdict))
    assert len(held) > 1
    for number, body in enumerate(held):
        forged = copy.deepcopy(told)
        other = next(one for one in forged["cell"]["bodies"] if one == body)
        if body.get("corners"):
            other["corners"] = [[x + 0.00002 for x in corner] for corner in body["corners"]]
        else:
            other["pose"][3 + 4 * (number % 3)] += 0.00002
        refused = verify(text.encode(), json.dumps(forged).encode()).refused
        assert body["name"] in refused, refused


WAYS = {
    "straight": ("move 0|put M1=1|move 2", {(-1, 0, False), (0, 2, True)}),
    "either": (
        "move 0|barrier when 1 -|put M1=1|move 2|barrier else 3 -|move 4|barrier end 5 -|move 6",
        {(-1, 0, False), (0, 2, True), (0, 4, False), (2, 6, False), (4, 6, False)},
    ),
    "perhaps": (
        "move 0|barrier when 1 -|move 2|barrier end 3 -|put M1=1|move 4",
        {(-1, 0, False), (0, 2, False), (2, 4, True), (0, 4, True)},
    ),
    "stopped": (
        "move 0|barrier when 1 -|put M1=1|barrier stop 2 -|barrier end 3 -|move 4",
        {(-1, 0, False), (0, 4, False)},
    ),
    "again": (
        (
            "barrier loop 0 -|move 1|barrier when 2 -|barrier exit 3 -|barrier end 4 -|put M1=1|move 5|put "
            "M2=1|barrier next 6 -|barrier endloop 7 -|move 8"
        ),
        {(-1, 1, False), (1, 5, True), (5, 1, True), (1, 8, False)},
    ),
    "twice": (
        (
            "move 0|barrier loop 1 -|barrier loop 2 -|move 3|barrier when 4 -|barrier exit 5 -|barrier end "
            "6 -|barrier next 7 -|barrier endloop 8 -|barrier when 9 -|barrier exit 10 -|barrier end 11 "
            "-|put M1=1|barrier next 12 -|barrier endloop 13 -|move 14"
        ),
        {(-1, 0, False), (0, 3, False), (3, 3, False), (3, 3, True), (3, 14, False)},
    ),
}


@pytest.mark.parametrize("way", WAYS)
def test_all_motions_that_may_follow_each_other_are_found(way):
    deeds, expected = WAYS[way]
    assert follow(deeds.split("|")) == expected
