"""Timetables: a text is refused if any joint isn't where its table says at the same time."""

import json
import re

import pytest

from tests.verify.proof_forging import changed, made, numbers, refused, refused_text, table
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

TIMED = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ 20 -10 -30 0 -40 0
P0020 MOVEJ_TIMED 15 -5 -32 4 -38 6 [0.8]; 2 4 -38 9 -30 18 [1.6];
-9 6 -42 8 -24 26 [2.4]; -16 2 -40 3 -22 30 [3.4]
P0030 MOVEJ_TIMED -12 0 -39 2 -24 24 [0.6] VEL 12 -6 3 -4 -6 -18;
0 -5 -35 0 -32 8 [1.4] VEL 14 -5 5 -1 -9 -14;
10 -8 -32 0 -38 0 [2.4] VEL 0 0 0 0 0 0 STRETCH 1.25 TOL 0.02
P0040 MOVEJ_TIMED 8 -6 -33 2 -36 -4 [0.8] VEL -5 2 -3 4 2 -3 ACC 0 1 0 -2 0 0;
0 -6 -34 0 -36 0 [1.8] VEL 0 0 0 0 0 0 ACC 0 0 0 0 0 0
P0050 STOP
"""
"""A table of positions, one with velocities too, and one with accelerations too."""


def test_a_timetable_is_decided():
    text, proof = made(TIMED)
    verdict = verify(text.encode(), proof.encode())
    assert verdict.refused == ""
    assert [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED] == []
    assert len(verdict.exempt) == 3
    assert all("the jerk, also in its blends" in one for one in verdict.exempt)
    steps = table(TIMED)["program"]["steps"]
    assert [set(one["rows"][0]) - {"at", "q"} for one in steps[1:4]] == [set(), {"v"}, {"v", "a"}]


def test_every_number_of_a_timetable_counts():
    text, _ = made(TIMED)
    proof = table(TIMED)
    told = [path for path in numbers(proof["program"]) if "rows" in path]
    assert len(told) > 100
    for path in told[::5]:
        by = {"q": 0.15, "v": 2.0, "a": 30.0, "at": 0.1}[path[4]]
        for sign in (-1, 1):
            forged = changed(proof, ("program", *path), lambda one, off=sign * by: one + off)
            assert refused(text, forged), (path, sign)


FORGED = {
    "a row less": lambda steps: steps[2]["rows"].pop(1),
    "the last row is missing": lambda steps: steps[2]["rows"].pop(),
    "no rows": lambda steps: steps[2].__setitem__("rows", []),
    "rows in another order": lambda steps: steps[2]["rows"].reverse(),
    "a start elsewhere": lambda steps: steps[2]["rows"][0].__setitem__("q", [-16, 2, -40, 3, -22, 30.1]),
    "narrower": lambda steps: steps[2].__setitem__("within", [1e-7] * 6),
    "a joint less within": lambda steps: steps[2].__setitem__("within", [1] * 5),
    "another duration": lambda steps: steps[2].__setitem__("duration", 3.1),
    "positions alone": lambda steps: [row.pop("v") for row in steps[2]["rows"]],
    "velocities of one spline": lambda steps: [row.__setitem__("v", [0] * 6) for row in steps[1]["rows"]],
    "accelerations of a last row": lambda steps: steps[2]["rows"][-1].__setitem__("a", [0] * 6),
    "accelerations of one row": lambda steps: steps[2]["rows"][0].__setitem__("a", [0] * 6),
}


@pytest.mark.parametrize("change", FORGED)
def test_a_timetable_of_which_something_else_is_told_is_refused(change):
    text, _ = made(TIMED)
    forged = table(TIMED)
    FORGED[change](forged["program"]["steps"])
    assert refused(text, forged)


def test_a_timetable_that_is_told_as_another_motion_is_not_checked():
    text, _ = made(TIMED)
    forged = table(TIMED)
    forged["program"]["steps"][2]["move"] = "joint"
    verdict = verify(text.encode(), json.dumps(forged).encode())
    assert any("doesn't know its rows, within" in one for one in verdict.unchecked)


def test_a_timetable_with_a_ceiling_is_not_checked():
    text, _ = made(TIMED)
    for name, value in (("ceiling", 1), ("speed", [1, None]), ("blend", [1, 0])):
        forged = table(TIMED)
        forged["program"]["steps"][2][name] = value
        verdict = verify(text.encode(), json.dumps(forged).encode())
        assert any("a timetable with a speed" in one for one in verdict.unchecked), name


def test_a_table_may_begin_where_the_robot_stands():
    text, _ = made(TIMED)
    forged = table(TIMED)
    forged["program"]["steps"][2]["rows"][0]["q"] = [-16, 2, -40, 3, -22, 30]
    assert refused(text, forged) == ""


def test_every_move_off_the_table_is_refused():
    text, _ = made(TIMED)
    lines = text.split("\n")
    entries = [re.fullmatch(r"; command [123] .* ([0-9]+) ([0-9]+) any-jerk", line) for line in lines]
    spans = [(int(one[1]), int(one[2])) for one in entries if one]
    assert len(spans) == 3
    for first, last in spans:
        for k in range(first + 2, last - 2, 17):
            if lines[k].startswith("X"):
                moved = re.sub(r"Y(-?[0-9.]+)", lambda one: f"Y{float(one[1]) + 0.4:.6f}", lines[k])
                forged = "\n".join([*lines[:k], moved, *lines[k + 1 :]])
                assert refused_text(TIMED, forged), k
