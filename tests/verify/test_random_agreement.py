"""The judge and the small checker agree about random programs, and about their texts after a change by
chance.

Usually a few programs are drawn;
`YARCLANG_RANDOM_AGREEMENTS=1000 pytest -s tests/verify/test_random_agreement.py` draws 1,000 and prints the
figures. Whatever the judge refuses is refused by the checker, or what it has not checked is listed.
"""

import os

import pytest

from tests.verify.agreement import Tried, try_program

COUNT = int(os.environ.get("YARCLANG_RANDOM_AGREEMENTS", "8"))
"""How many programs are drawn for all arms together."""
ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


@pytest.mark.parametrize("name", ROBOTS)
def test_both_agree_about_random_programs(name):
    tried, count = Tried(), max(4, COUNT // len(ROBOTS))
    for seed in range(count):
        try_program(name, seed, tried)
    print(name, dict(tried.counts), dict(tried.unchecked))
    assert tried.faults == []
    # about half of what is drawn compiles; most changes make a text wrong
    assert tried.counts["accepted by both"] >= max(1, count // 4)
    assert tried.counts["changed and refused by both"] >= max(1, count // 4)
