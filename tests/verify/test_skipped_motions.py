"""A motion that the text leaves out in one branch is refused.

This is so even if the line above it, which belongs to the other branch, leads to the motion's goal.
"""

import hashlib
import re

import pytest

from tests.certify.forging import Forger
from tests.verify.proof_forging import made, refused, table

PROGRAM = """DEFAULT (deg,s)
INPUT DOOR M11
OUTPUT LAMP M20
P0010 MOVEJ 10 0 0 0 0 0 [2]
WHEN DOOR ON
  P0020 MOVEJ 20 0 0 0 0 0 [2]
{rest}P0050 SET LAMP ON
P0060 STOP
"""
REST = {
    "after a way that stops": ("  P0030 STOP\nEND\nP0040 MOVEJ 20 0 0 0 0 0 [{time}]\n", "P0040"),
    "on the other way, before it stops": (
        "ELSE\n  P0040 MOVEJ 20 0 0 0 0 0 [{time}]\n  P0045 STOP\nEND\n",
        "a RAPID to where the robot doesn't stand",
    ),
}
"""What follows the first branch, and why the checker refuses it without P0040."""


def without(text, step, index):
    """Return a text without the moves of a command, and with a map that says that it has none."""
    forger = Forger.of(text)
    entry = re.fullmatch(
        r"(; command \d+ \S+ \S+ \S+) (\d+) (\d+)", next(one for one in forger.lines if f" {index} " in one)
    )
    first, last = int(entry[2]), int(entry[3])
    begin = first - 1
    while re.match("TM|P8100", forger.lines[begin - 1]):
        begin -= 1
    while forger.lines[last] == "P8100=P8100&2":
        last += 1
    last += forger.lines[last] == "DWELL0"
    return forger.drop(begin, last - begin).change(rf"; command {step} .*", f"{entry[1]} - -")


@pytest.mark.parametrize("time", ["2", "MIN"])
@pytest.mark.parametrize("name", REST)
def test_a_motion_that_one_way_leaves_out_is_refused(name, time):
    rest, why = REST[name]
    program = PROGRAM.format(rest=rest.format(time=time))
    text, _ = made(program)
    assert refused(text, table(program)) == ""
    step = next(k for k, one in enumerate(table(program)["program"]["steps"]) if "P0040" in one["title"])
    forged = without(text, step, "P0040")
    reasons = set()
    # without P0040, the way through the first branch takes 4 s (P0010 and P0020), and the other way 2 s
    # (P0010); the forged header states both durations, or one of them
    for known in ("2.000 to 4.000 s", "4.000 s", "2.000 s"):
        said = re.sub(r"(?m)^; duration .*? s\b", f"; duration {known}", forged.text, count=1)
        proof = table(program)
        proof["text"] = hashlib.sha256(said.encode()).hexdigest()
        proof["program"]["course"].remove(f"move {step}")
        proof["motions"].pop(str(step), None)
        reasons.add(refused(said, proof))
    # with one of the headers, the left-out motion is the only error
    assert "" not in reasons
    assert any(why in one or "P0040" in one for one in reasons), reasons


def test_a_motion_that_rests_for_its_time_is_not_left_out():
    program = (
        "DEFAULT (deg,s)\n"
        "INPUT DOOR M11\n"
        "P0010 MOVEJ 10 0 0 0 0 0 [2]\n"
        "P0020 WAIT DOOR ON\n"
        "P0040 MOVEJ 10 0 0 0 0 0 [2]\n"
    )
    text, _ = made(program)
    proof = table(program)
    assert refused(text, proof) == ""
    step = next(k for k, one in enumerate(proof["program"]["steps"]) if "P0040" in one["title"])
    said = re.sub(
        r"(?m)^; duration .*? s\b", "; duration 2.000 s", without(text, step, "P0040").text, count=1
    )
    proof["text"] = hashlib.sha256(said.encode()).hexdigest()
    proof["program"]["course"].remove(f"move {step}")
    proof["motions"].pop(str(step), None)
    assert "it takes another time" in refused(said, proof)
