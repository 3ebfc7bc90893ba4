"""A mistake gets one finding, at the right place, that says what to do, with its fix where one repair is likely."""

from pathlib import Path

import pytest
from mistakes.looking import faults_of
from mistakes.table import MISTAKES

OPEN = frozenset(Path(__file__).with_name("open.txt").read_text(encoding="utf-8").split())
"""Those whose answers aren't as they should be: this list gets shorter, never longer."""


def test_the_table_is_as_large_as_it_says():
    assert len({one.name for one in MISTAKES}) == len(MISTAKES) >= 150
    assert {one.name for one in MISTAKES} >= OPEN


@pytest.mark.parametrize("mistake", MISTAKES, ids=lambda one: one.name)
def test_a_mistake_is_answered(mistake):
    faults = faults_of(mistake)
    if mistake.name in OPEN:
        assert faults, "it is answered as it should be: take its name out of open.txt"
    else:
        assert not faults, "\n".join(faults)
