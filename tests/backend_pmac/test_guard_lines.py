"""The guard counts lines, but only moves take time: wherever a hold begins, the lines ahead contain enough
moves, and a text in which they don't is refused.
"""

import hashlib
import json
import math
import random
import re
from functools import cache

import pytest
from programs import compiled

from tests.certify.forging import Forger
from yarclang.certify.pmac.guard import check_guard
from yarclang.certify.pmac.read import read
from yarclang.pipeline.proofs import proof_of
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.description import load_robot
from yarclang.verify.verdict import verify

BEGIN = "OUTPUT A M20\nDEFAULT (deg,s)\nP0010 MOVEJ 20 0 0 0 0 0 [{0}]\n"
END = "P0900 STOP\n"
MOVE = "P{0:04d} MOVEJ {1} 0 0 0 0 0 [{2}]\n"
SET = "P{0:04d} SET A {1}\n"


def sets(count, first=100):
    return "".join(SET.format(first + k, "ON" if k % 2 else "OFF") for k in range(count))


def between(count, before=6, after=6, angle=40):
    """Return a program with `count` SETs between two motions."""
    return BEGIN.format(before) + sets(count) + MOVE.format(800, angle, after) + END


IN_A_BLEND = (
    "OUTPUT A M20\nDEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]\n"
    "P0020 MOVEL 200 1174.4 1176 0 0 0 [4] BLEND 20\n"
    + sets(7)
    + "P0300 MOVEL 200 1174.4 1000 0 0 0 [4]\n"
    + END
)
PROGRAMS = {
    "none": between(0),
    "one": between(1),
    "seventy": between(70),
    "few moves after them": between(70, after=0.6, angle=22),
    "more than the rest of the program": between(100, before=2, after=0.6, angle=22),
    "at the end": BEGIN.format(6) + sets(70) + END,
    "at the start": "OUTPUT A M20\nDEFAULT (deg,s)\n" + sets(90) + MOVE.format(800, 2, 0.6) + END,
    "before a long motion": "OUTPUT A M20\nDEFAULT (deg,s)\n" + sets(90) + MOVE.format(800, 20, 6) + END,
    "after a barrier": BEGIN.format(1) + "P0020 WAIT [0.5]\n" + sets(90) + MOVE.format(800, 40, 6) + END,
    "in a blend": IN_A_BLEND,
}


@cache
def made(program):
    found, diagnostics = compiled(program)
    assert found is not None, [one.message for one in diagnostics]
    proof = proof_of(found)
    assert proof.value is not None
    return found.text, proof.value


def faults(text):
    robot = robot_of()
    return list(check_guard(read(text, turbo_pmac(robot)), robot))


def refused(program, text):
    """Return why the small checker refuses a text with the program's proof."""
    proof = json.loads(made(program)[1])
    proof |= {"cell": {"bodies": [], "exceptions": [], "zones": []}, "planes": []}
    proof["text"] = hashlib.sha256(text.encode()).hexdigest()
    return verify(text.encode(), json.dumps(proof).encode()).refused


def robot_of():
    return load_robot("INDUSTRIAL6").value


def mark(text, name):
    return int(re.search(rf"(?m)^{name}=(\d+)$", text)[1])


def counted(text):
    """Check each line of a text as the controller counts them; return the largest number of lines that a hold
    needs.
    """
    low, full = mark(text, "I16"), mark(text, "I17")
    segment = min(float(one) for one in re.findall(r"(?m)^TM([0-9.]+)$", text)) / 1000.0
    needed = math.ceil((turbo_pmac(robot_of()).hold_time / 2 + 0.1) / segment - 1e-9)
    lines = text[text.index("\nCLEAR\n") + 7 : text.rindex("CLOSE\n")].split("\n")[:-1]
    assert "STOP" not in lines
    most = 0
    if "P8100=1" not in lines:
        assert len(lines) <= full + 2
        return needed
    on, off = lines.index("P8100=1"), lines.index("P8100=P8100&2")
    assert not any(re.match(r"X.*[A-Z]", one) for one in lines[5:on])
    assert lines[off - 1].startswith("X")
    assert not any(one.startswith("X") for one in lines[off:])
    assert len(lines) - off >= low + 2
    for first in range(on + 1, off):
        ahead = lines[first:]
        moves = [place + 1 for place, one in enumerate(ahead) if one.startswith("X")]
        span = moves[min(needed, len(moves)) - 1]
        assert span <= low
        most = max(most, span)
    return max(most, needed)


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_hold_finds_its_moves(name):
    text, _ = made(PROGRAMS[name])
    counted(text)
    assert faults(text) == []
    assert not refused(PROGRAMS[name], text)


@pytest.mark.parametrize("name", ["seventy", "few moves after them", "in a blend", "one"])
def test_a_low_mark_that_counts_moves_alone_is_refused(name):
    """The low mark of plain moves is too low where other lines are between them."""
    text, _ = made(PROGRAMS[name])
    assert "P8100=1" in text
    needed, low = mark(made(PROGRAMS["none"])[0], "I16"), mark(text, "I16")
    assert low == counted(text)
    for lower in {low - 1, needed} - {low}:
        forged = text.replace(f"I16={low}\n", f"I16={lower}\n")
        assert any("spread over" in one or "lines of" in one for one in faults(forged)), lower
        assert refused(PROGRAMS[name], forged), lower


def test_a_stretch_that_fits_in_moves_alone_is_guarded():
    """The moves fit into the buffer, the lines don't: a text without the guard is refused."""
    text, _ = made(between(70, before=2, after=2))
    assert "P8100=1" in text
    assert text.count("\nX") <= mark(text, "I17") + 2
    forger = Forger.of(text)
    for line in ["P8100=1"] + ["P8100=P8100&2"] * text.count("P8100=P8100&2\n"):
        forger = forger.drop(forger.find(line))
    assert any("isn't armed" in one for one in faults(forger.text))
    assert "isn't armed" in refused(between(70, before=2, after=2), forger.text)


def forged_at_the_end(text, change):
    """Return a text whose lines after the last move are changed."""
    lines = text.split("\n")
    last = max(place for place, line in enumerate(lines) if line.startswith("X"))
    return "\n".join(change(lines, last))


CHANGES = {
    "before the last move": lambda lines, last: [
        *lines[:last],
        lines[last + 1],
        lines[last],
        *lines[last + 2 :],
    ],
    "again": lambda lines, last: [*lines[: last + 1], "P8100=1", *lines[last + 1 :]],
    "never": lambda lines, _: [line for line in lines if line != "P8100=P8100&2"],
    "too few lines": lambda lines, last: lines[: last + 1] + lines[last + 2 :],
    "later": lambda lines, _: [*lines[:-2], "P8100=P8100&2", *lines[-2:]],
    "again later": lambda lines, _: [*lines[:-2], "P8100=1", *lines[-2:]],
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("name", ["one", "seventy", "at the end"])
def test_the_guard_is_disarmed_after_the_last_move(name, change):
    """If it were disarmed before, the host could fail when only the last moves are missing: they need not be
    in the buffer.
    """
    if change == "later" and name != "at the end":
        return  # it is one line more of those that follow the last move
    text, _ = made(PROGRAMS[name])
    lines = text.split("\n")
    last = max(place for place, line in enumerate(lines) if line.startswith("X"))
    forged = "\n".join(CHANGES[change](lines, last))
    assert faults(forged)
    assert refused(PROGRAMS[name], forged)


@pytest.mark.parametrize("count", [0, 1, 12, 90, 200])
def test_the_buffer_has_room_for_the_lines_before_the_first_move(count):
    """The controller executes them at once when the motion begins, and the moves must be in the buffer then.
    Without such lines, the mark is that of the moves.
    """
    text, _ = made("OUTPUT A M20\nDEFAULT (deg,s)\n" + sets(count) + MOVE.format(800, 60, 12) + END)
    needed = mark(made(PROGRAMS["none"])[0], "I16")
    assert mark(text, "I16") == needed + count
    assert "P8100=1" in text
    capacity = int(re.search(r"(?m)^DEFINE ROT (\d+)$", text)[1]) // 8
    assert capacity >= count + 2 * mark(text, "I16")
    assert faults(text) == []


@pytest.mark.parametrize("count", [0, 12, 70, 200])
def test_enough_lines_follow_the_last_move(count):
    """Else the guard would hold the last moves. The program's own lines count, too."""
    text, _ = made(BEGIN.format(12) + sets(count) + END)
    lines = text.split("\n")[:-2]
    last = max(place for place, line in enumerate(lines) if line.startswith("X"))
    behind, repeated = len(lines) - last - 1, text.count("P8100=P8100&2\n")
    assert (behind == mark(text, "I16") + 2) if repeated > 1 else (behind > mark(text, "I16") + 2)
    assert (repeated > 1) == (count == 0)
    assert faults(text) == []


def test_programs_by_chance():
    draw = random.Random(25)
    guarded = widened = 0
    for _ in range(40):
        program, at = BEGIN.format(draw.choice([1, 2, 4])), 100
        if draw.random() < 0.3:
            program = program.replace("P0010", sets(draw.choice([1, 7, 40]), 10) + "P0099")
        angle = 20
        for _ in range(draw.randint(1, 6)):
            count = draw.choice([0, 1, 2, 5, 12, 30])
            program, at = program + sets(count, at), at + count
            if draw.random() < 0.2:
                program, at = program + f"P{at:04d} WAIT [0.5]\n", at + 1
            angle += draw.choice([-2, 1, 2])
            program, at = program + MOVE.format(at, angle, draw.choice([0.6, 1, 3])), at + 1
        program += END
        text, _ = made(program)
        most = counted(text)
        assert faults(text) == []
        assert not refused(program, text)
        guarded += "P8100=1" in text
        widened += most > 22
    assert guarded >= 20
    assert widened >= 10
