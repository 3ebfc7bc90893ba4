"""Tests of the search for how far poses are out of reach. It is made only for a few commands of a program,
and in the first pass of a loop.
"""

import re
import time
from pathlib import Path

import pytest

from yarclang.motion.routes import MOST_MEASURED
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1074.4 1176 0 0 0\n"
MOST = 3.0
"""Longest processor time of a check [s]. An idle computer takes a quarter of it."""


def found_in(program):
    begin = time.process_time()
    diagnostics = check_text(SourceFile("a.yarc", HEAD + program), Path(), Options()).diagnostics
    assert time.process_time() - begin < MOST
    return diagnostics


@pytest.mark.parametrize("count", [200, 300])
@pytest.mark.parametrize("word", ["MOVEL", "MOVEJ_RPY"])
def test_the_rounds_of_a_loop_share_one_search(word, count):
    (one,) = found_in(f"REPEAT I {count}\nP0020 {word} $(3000 + I) 1074.4 1176 0 0 0\nEND")
    assert one.code == "Y0501"
    assert re.fullmatch(
        rf"the pose is out of reach by [\d,]+ mm \(at P0020\(I=0\), and {count - 1} more times\)", one.message
    )


def test_so_many_commands_are_measured_and_the_others_found_all_the_same():
    count = MOST_MEASURED + 15
    found = found_in("".join(f"P{20 + k:04} MOVEJ_RPY {1800 + k} 1074.4 1176 0 0 0\n" for k in range(count)))
    assert [one.code for one in found] == ["Y0501"] * count
    measured = [" by " in one.message for one in found]
    assert measured == [True] * MOST_MEASURED + [False] * 15


def test_commands_that_are_reached_cost_nothing_of_the_budget():
    good = "".join(f"P{20 + k:04} MOVEJ_RPY {k} 1074.4 1176 0 0 0\n" for k in range(MOST_MEASURED + 5))
    found = found_in(f"{good}P0100 MOVEJ_RPY 1900 1074.4 1176 0 0 0")
    assert [one.code for one in found if one.is_error] == ["Y0501"]
    assert " by " in next(one.message for one in found if one.is_error)
