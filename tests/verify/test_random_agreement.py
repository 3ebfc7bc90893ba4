"""The judge and the small checker agree about random programs, and about random changes of their texts.

Usually a few programs are drawn.
`YARCLANG_RANDOM_AGREEMENTS=1000 pytest -s tests/verify/test_random_agreement.py` draws 1,000 and prints the
figures. The checker refuses whatever the judge refuses, or lists it as unchecked.
"""

import os

import pytest

from tests.verify.agreement import Tried, try_program

COUNT = int(os.environ.get("YARCLANG_RANDOM_AGREEMENTS", "8"))
"""Number of programs for all arms together."""
ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")


@pytest.mark.parametrize("name", ROBOTS)
def test_both_agree_about_random_programs(name):
    tried, count = Tried(), max(4, COUNT // len(ROBOTS))
    for seed in range(count):
        try_program(name, seed, tried)
    print(name, dict(tried.counts), dict(tried.unchecked))
    assert tried.faults == []
    # about half of the drawn programs compile, and most changes make a text wrong
    assert tried.counts["accepted by both"] >= max(1, count // 4)
    assert tried.counts["changed and refused by both"] >= max(1, count // 4)


@pytest.mark.parametrize("seed", [581])
def test_programs_whose_proof_was_refused_by_mistake(seed):
    """A speed that just reaches its ceiling needs sharper bounds than the path does (seed 581)."""
    tried = Tried()
    try_program("INDUSTRIAL6", seed, tried, changes=0)
    assert tried.faults == []
    assert tried.counts["accepted by both"] == 1
