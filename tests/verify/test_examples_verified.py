"""The small checker leaves nothing of an example unchecked, and lists what its program exempts.

Only examples with rare motions or rules are tested. The others take longer, and are run by hand before a
release.
"""

from pathlib import Path

import pytest

import yarclang
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
EXEMPT = {
    "14_timetable": ["P0020 MOVEJ_TIMED 7: the jerk", "P0030 MOVEJ_TIMED 10: the jerk"],
    "25_stack_height": ["the path after a motion that an input ends"],
    "27_bin_picking": ["paths in frames that registers shift"],
    "28_curtain_with_return": ["the path on which the robot leaves (LEAVE)"],
    "31_press_in": ["HOUSING and RUBBER during commands 3, 5, 7, 8 of the map"],
    "33_camera_in_sight": [],
}


@pytest.mark.parametrize("name", EXEMPT)
def test_nothing_of_an_example_is_left_unchecked(name):
    source = (EXAMPLES / f"{name}.yarc").read_text()
    compiled = yarclang.compile(source, name=f"{name}.yarc", folder=EXAMPLES)
    assert compiled.value is not None, compiled.diagnostics
    verdict = verify(compiled.value.text.encode(), proof_of(compiled.value).value.encode())
    assert verdict.refused == ""
    assert [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED] == []
    assert len(verdict.exempt) == len(EXEMPT[name])
    assert all(one.startswith(told) for one, told in zip(verdict.exempt, EXEMPT[name], strict=True))
