"""Proofs with a wrong number or form, or for another text, robot or version, are refused."""

import functools
import json
import operator
import random

import pytest

from tests.verify.proof_forging import BLENDED, MOTIONS, changed, made, numbers, refused, table
from yarclang.verify.__main__ import report
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

SHARE = 10**10


def of_motions(path):
    """Return True if a number belongs to the arm, to the start, to a motion's goal, or to the proof of a
    motion.
    """
    return path[0] == "motions" or path[:2] in (("robot", "arm"), ("program", "start")) or is_goal(path)


def is_goal(path):
    return path[:2] == ("program", "steps") and path[3] in ("pose", "tool", "via", "through", "duration")


def changes(path):
    """Yield changes of a number that must be refused."""
    if path[-2] in ("s", "rates"):
        yield lambda one: one + SHARE // 5
        yield lambda one: one - SHARE // 5
    elif path[-1] == "pieces":
        yield lambda one: one + 1
        yield lambda _: 0
    else:
        yield lambda one: one + 0.01 + abs(one) / 100
        yield lambda one: one - 0.01 - abs(one) / 100
        yield lambda _: 1e15


def test_every_number_of_goals_arm_and_proofs_counts():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    assert refused(text, proof) == ""
    places = [path for path in numbers(proof) if of_motions(path)]
    shares = [path for path in places if path[-2] in ("s", "rates")]
    others = [path for path in places if path[-2] not in ("s", "rates")]
    assert len(others) > 150
    # every third number of the arm, the goals and the curves, and some values of s(t)
    chosen = [*others[::3], *shares[:: max(1, len(shares) // 30)]]
    tried = [(path, list(changes(path))[number % 2]) for number, path in enumerate(chosen)]
    assert len(tried) > 80
    assert [path for path, change in tried if not refused(text, changed(proof, path, change))] == []


@pytest.mark.parametrize(
    ("name", "factor"), [("velocity", 0.1), ("acceleration", 0.1), ("jerk", 0.1), ("motor_velocity", 0.1)]
)
def test_limits_that_are_smaller_are_broken(name, factor):
    text, _ = made(MOTIONS)
    for joint in range(6):
        forged = changed(table(MOTIONS), ("robot", name, joint), lambda one: one * factor)
        assert "of its limit" in refused(text, forged), joint


def test_a_range_that_is_smaller_is_left():
    text, _ = made(MOTIONS)
    assert "range" in refused(text, changed(table(MOTIONS), ("robot", "upper", 0), lambda _: 19.0))
    assert "range" in refused(text, changed(table(MOTIONS), ("robot", "lower", 2), lambda _: -39.0))


def test_counts_of_motors_count():
    text, _ = made(MOTIONS)
    for motor in range(6):
        forged = changed(table(MOTIONS), ("robot", "counts", motor, motor), lambda one: one * 10)
        assert "motor" in refused(text, forged)


def test_tolerances_that_are_smaller_are_not_kept():
    text, _ = made(MOTIONS)
    for step, told in enumerate(table(MOTIONS)["program"]["steps"]):
        if "tolerance" in told and told["move"] != "joint":
            forged = table(MOTIONS)
            forged["program"]["steps"][step]["tolerance"] = [1e-9, 1e-9]
            assert refused(text, forged), step
            forged["program"]["steps"][step]["tolerance"] = [-1, 1]
            assert refused(text, forged), step


@pytest.mark.parametrize("number", [-1e300, 1e300, "1e999999999", None, "x", [], {}, True, 0])
def test_numbers_that_are_none_are_refused(number):
    text, _ = made(BLENDED)
    proof = table(BLENDED)
    for path in list(numbers(proof))[::61]:
        forged = changed(proof, path, lambda _: number)
        # no change causes a traceback, even if it is accepted
        assert isinstance(refused(text, forged), str)


@pytest.mark.parametrize(
    "said",
    [
        b"",
        b"[]",
        b"{}",
        b"null",
        b"\xff",
        b"[" * 100_000,
        b'{"form": 1, "form": 1}',
        b'{"form": NaN}',
        b'{"form": 1e999999999}',
        b'{"form": ' + b"9" * 5000 + b"}",
    ],
)
def test_what_is_no_proof_is_refused(said):
    text, _ = made(BLENDED)
    assert verify(text.encode(), said).refused


def test_a_proof_of_another_text_robot_version_or_form_is_refused():
    text, proof = made(MOTIONS)
    other, _ = made(BLENDED)
    assert "another text" in verify(other.encode(), proof.encode()).refused
    for path, value, why in (
        (("robot", "name"), "OTHER", "another robot"),
        (("robot", "fingerprint"), "0" * 64, "another robot"),
        (("version",), "0.0.9", "another version"),
        (("form",), 1, "form 1"),
    ):
        assert why in refused(text, changed(table(MOTIONS), path, lambda _, value=value: value))


def test_each_part_of_a_proof_is_needed():
    text, _ = made(MOTIONS)
    for outer in (None, "robot", "program"):
        names = table(MOTIONS) if outer is None else table(MOTIONS)[outer]
        for name in names:
            forged = table(MOTIONS)
            del (forged if outer is None else forged[outer])[name]
            assert refused(text, forged), name


def test_a_motion_without_its_proof_is_named_as_unchecked():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    step = next(iter(proof["motions"]))
    del proof["motions"][step]
    verdict = verify(text.encode(), json.dumps(proof).encode())
    assert not verdict.refused
    title = proof["program"]["steps"][int(step)]["title"]
    assert any(one.startswith(f"{title}: path, goal, time and speed (") for one in verdict.unchecked)
    text, _ = made(SPEEDS)
    verdict = verify(text.encode(), json.dumps(table(SPEEDS) | {"motions": {}}).encode())
    assert [one for one in verdict.unchecked if "P0020" in one or "P0030" in one] == [
        "P0020 MOVEL 3: path, goal, time and speed (its path, of which the proof says nothing)",
        "P0030 MOVEL 4: path, goal, time and speed (its path, of which the proof says nothing)",
    ]


def test_what_happens_between_motions_is_what_is_told():
    text, _ = made(MOTIONS)
    course = table(MOTIONS)["program"]["course"]
    for place in range(len(course)):
        forged = table(MOTIONS)
        del forged["program"]["course"][place]
        assert refused(text, forged)
    for name, value in (("safe", []), ("outputs", []), ("registers", ["; register A 0 1 0"])):
        forged = table(MOTIONS)
        forged["program"][name] = value
        assert refused(text, forged), name


SPEEDS = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]
P0020 MOVEL 150 1174.4 1176 0 0 0 [V 50]
P0030 MOVEL 0 1174.4 1176 0 0 0 [V<=80]
"""


def test_speeds_are_neither_exceeded_nor_missed():
    text, _ = made(SPEEDS)
    assert refused(text, table(SPEEDS)) == ""
    speed, ceiling = ("program", "steps", 1, "speed", 0), ("program", "steps", 2, "ceiling")
    assert "faster than its speed" in refused(text, changed(table(SPEEDS), speed, lambda _: 49.9))
    assert "faster than its ceiling" in refused(text, changed(table(SPEEDS), ceiling, lambda _: 60))
    forged = changed(table(SPEEDS), speed, lambda _: 50.2)
    assert "slower than its speed" in refused(text, forged)
    kept = table(SPEEDS)
    kept["program"]["steps"][1]["kept"] = 0.5
    assert refused(text, kept) == ""
    kept["program"]["steps"][1]["kept"] = 1.5
    assert "beyond 1" in refused(text, kept)


VALUES = [
    None,
    True,
    "",
    "x",
    "9" * 50,
    [],
    {},
    [1],
    [[]],
    {"q": 1},
    -1,
    0,
    1e30,
    -1e30,
    1e99,
    0.5,
    [None] * 6,
]


def parts(value, path=()):
    """Yield the paths of all parts of a proof."""
    yield from [path] if path else []
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for name, one in inner:
        yield from parts(one, (*path, name))


def test_whatever_stands_in_a_proof_is_judged_without_a_traceback():
    text, _ = made(BLENDED)
    draw, refusals = random.Random(34), 0
    for _ in range(150):
        proof = table(BLENDED)
        places = list(parts(proof))
        for _ in range(draw.choice((1, 1, 2, 4))):
            *outer, name = draw.choice(places)
            try:
                inner = functools.reduce(operator.getitem, outer, proof)
                inner[name] = draw.choice(VALUES)
            except (KeyError, IndexError, TypeError):
                continue  # an earlier change has removed this place
        refusals += bool(refused(text, proof))
    assert refusals > 100


def test_a_goal_that_is_told_nowhere_is_refused():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    goal = next(
        one
        for step in proof["program"]["steps"]
        for one in step.get("through", ())
        if one["q"] is None and "pose" in one
    )
    del goal["pose"]
    assert "a goal that is nowhere" in refused(text, proof)


def test_a_motion_of_no_known_kind_is_refused():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    next(step for step in proof["program"]["steps"] if step.get("move") == "joint")["move"] = "jump"
    assert "a kind that isn't known" in refused(text, proof)


def test_nothing_is_told_of_the_robot_besides():
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    proof["robot"]["torques"] = "checked"
    assert "other fields" in refused(text, proof)


@pytest.mark.parametrize("hostile", ["\x1b[2J", "\u202e", "\n", "\ud800"])
def test_no_character_of_a_proof_reaches_the_terminal_unless_it_is_printed(hostile):
    text, _ = made(MOTIONS)
    proof = table(MOTIONS)
    next(step for step in proof["program"]["steps"] if "move" in step)["unchecked"] = f"a{hostile}checked:"
    said = report("one.pmc", verify(text.encode(), json.dumps(proof).encode()))
    assert all(line.isprintable() for line in said.split("\n"))
    assert f"a\\u{ord(hostile[0]):04x}" in said or "a\\nchecked" in said


OF_FRAMES = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ 10 -10 -50 5 60 0 [2] TOL 0.5
P0020 MOVEJ_SPLINE 20 0 -30 0 30 0; 0 -5 -20 10 40 5; -10 5 -20 0 30 0 [8] TOL 0.5
P0030 MOVEJ 0 -5 -45 0 50 0 [V<=400]
P0040 STOP
"""


def test_what_is_told_of_a_frame_while_joints_move_is_checked():
    """While joints move, the checker also checks the tolerance and the speed ceiling of the frame."""
    text, proof = made(OF_FRAMES)
    verdict = verify(text.encode(), proof.encode())
    assert (verdict.refused, [*verdict.unchecked]) == ("", [*ALWAYS_UNCHECKED])
    for step, name, told, reason in (
        (0, "tolerance", [1e-6, 0.002], "P0010 MOVEJ 2, from its way: "),
        (1, "tolerance", [1e-5, 0.002], "P0020 MOVEJ_SPLINE 3, from its way: "),
        (2, "ceiling", 300, "P0030 MOVEJ 4: faster than its ceiling"),
        (2, "ceiling", 399, "P0030 MOVEJ 4: faster than its ceiling"),
    ):
        forged = table(OF_FRAMES)
        forged["program"]["steps"][step][name] = told
        assert refused(text, forged).startswith(reason), refused(text, forged)
    far = table(OF_FRAMES)
    far["program"]["steps"][2]["tool"][11] += 1
    assert "faster than its ceiling" in refused(text, far)
    for step, name, left in ((0, "tolerance_of", []), (2, "tool", ["P0030 MOVEJ 4: its ceiling"])):
        forged = table(OF_FRAMES)
        del forged["program"]["steps"][step][name]
        verdict = verify(text.encode(), json.dumps(forged).encode())
        found = [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED]
        assert [one[: len(said)] for one, said in zip(found, left, strict=True)] == left
