"""The checker's durations are those of `lasting`, for random branches, loops and waits.

Another duration in the header is refused.
"""

import random
from fractions import Fraction

import pytest

from tests.verify.proof_forging import WAYS, made, refused_text
from yarclang.lasting import schedule_of
from yarclang.verify.course import Ways, check_duration, span_of
from yarclang.verify.exact import RefusedError
from yarclang.verify.reader import Item, Text

ENDS = {"stop": "finish", "abort": "finish"}


class Course:
    """A random course: the checker's items, and the parts from which `lasting` computes a duration."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.items, self.parts, self.barriers = [], [], {}
        self.exits = []  # for each open loop, the number of EXITs that leave it
        self.add_body(0, loop=False)
        self.text = Text(
            "", "", "", "", "", [], self.barriers, [], [], (0, 0, 0), (0,), (0, 0), self.items, [], 0
        )
        self.lasting = schedule_of(self.parts).lasting

    def add(self, kind, timeout="-"):
        line = len(self.items) + 1
        self.items.append(Item("barrier", line, f"{kind} 0 M1=1 {timeout} X", 0))
        self.barriers[line] = (self.items[-1].what, 0, kind)
        self.parts.append("ask" if timeout != "-" else ENDS.get(kind, kind))

    def add_body(self, depth, *, loop):
        """Add items; return True if the program can continue after them, since a text has no unreachable
        items.
        """
        for _ in range(self.random.randint(0, 3)):
            what = self.random.choice(["dwell", "wait", "hold", *["when", "loop"] * (depth < 3)])
            if what == "dwell":
                time = self.random.randint(1, 5000)
                self.items.append(Item("dwell", len(self.items) + 1, f"{time}"))
                self.parts.append(time / 1000)
            elif what == "when":
                self.add("when", self.random.choice(["-", "5"]))
                first = self.add_body(depth + 1, loop=loop) and self.leave(loop)
                second = True
                if self.random.random() < 0.5:
                    self.add("else")
                    second = self.add_body(depth + 1, loop=loop) and self.leave(loop)
                self.add("end")
                if not (first or second):
                    return False
            elif what == "loop":
                self.exits.append(0)
                self.add("loop")
                if self.add_body(depth + 1, loop=True):
                    self.add("next")
                self.add("endloop")
                if not self.exits.pop():
                    return False
            else:
                self.add(what)
        return True

    def leave(self, loop):
        """Sometimes end the branch by a stop or a jump; return True if the branch continues."""
        if self.random.random() < 0.5:
            return True
        self.add(self.random.choice(["stop", "abort", *["exit"] * 4 * loop, *["next"] * loop]))
        if loop:
            self.exits[-1] += self.barriers[len(self.items)][2] == "exit"
        return False


def test_durations_by_chance_are_the_judges():
    loops = ways = 0
    for seed in range(3000):
        course = Course(seed)
        meant = course.lasting
        (least, most, fewest, waits), looped = span_of(course.text)
        assert (float(least), float(most)) == pytest.approx((meant.least, meant.most)), seed
        assert (fewest, waits, looped) == (meant.fewest, meant.waits, meant.loops), seed
        course.text.duration = f"{meant.text()}, segments of 50 ms"
        check_duration(course.text)
        course.text.duration = course.text.duration.replace(" s", " s and 77 waits", 1)
        with pytest.raises(RefusedError):
            check_duration(course.text)
        loops, ways = loops + looped, ways + meant.varies
    assert loops > 300
    assert ways > 300


def test_another_duration_of_ways_is_refused():
    text, _ = made(WAYS)
    said = next(line for line in text.split("\n") if line.startswith("; duration "))
    least, most = said.split()[2], said.split()[4]
    for one, by in ((least, "-0.002"), (least, "0.002"), (most, "-0.002"), (most, "0.002")):
        other = f"{float(Fraction(one) + Fraction(by)):.3f}"
        assert "another duration" in refused_text(WAYS, text.replace(said, said.replace(one, other, 1)))
    assert "another duration" in refused_text(WAYS, text.replace(said, said.replace(f"{least} to ", "", 1)))


@pytest.mark.parametrize(("said", "is_refused"), [("1.000", False), ("1.001", True), ("0.999", True)])
def test_a_single_duration_is_held_to_its_last_digit(said, is_refused):
    course = Course(0)
    course.items[:] = [Item("dwell", 1, "1000")]
    course.text.duration = f"{said} s, segments of 50 ms"
    if is_refused:
        with pytest.raises(RefusedError, match="another duration"):
            check_duration(course.text)
    else:
        check_duration(course.text)


def test_ways_that_end_need_not_end_at_one_place():
    def differ(one, other, line):
        raise RefusedError(f"line {line}: {one} and {other}")

    ways = Ways(0, differ)
    for place in (1, 2):
        ways.passes("when", place)
        ways.at = place
        ways.passes("abort", place)
        assert ways.at is None
        ways.passes("end", place)
    assert (ways.at, ways.ended) == (0, [1, 2])
    ways.passes("when", 3)
    ways.at = 3
    with pytest.raises(RefusedError, match="line 3: 3 and 0"):
        ways.passes("end", 3)
