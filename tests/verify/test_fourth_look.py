"""Forgeries that a fourth look at the checker has found: all are refused, or told apart."""

import hashlib
import json

import pytest
from conftest import EXAMPLES

from tests.verify.proof_forging import made, table
from tests.verify.test_third_look import straight, verdict
from yarclang.verify.verdict import verify

SEARCH = (EXAMPLES / "25_stack_height.yarc").read_text()


@pytest.mark.parametrize(
    ("line", "forged"),
    [("; watch M11=0 ", "; watch P8100=0 "), ("; search 2 M12=1 ", "; search 2 M161=1 ")],
)
def test_watches_and_searches_read_inputs_only(line, forged):
    """A variable of the guard or of a motor is no input, even if text and proof agree on it."""
    text, proof = made(SEARCH)
    assert line in text
    text, proof = text.replace(line, forged), json.loads(proof.replace(line, forged))
    proof["text"] = hashlib.sha256(text.encode()).hexdigest()
    found = verify(text.encode(), json.dumps(proof).encode())
    assert "is a variable of the guard or of motors" in found.refused


def test_a_motion_of_the_proof_has_known_fields_only():
    text, _ = made(straight("2", "2"))
    proof = table(straight("2", "2"))
    next(iter(proof["motions"].values()))["more"] = [1, 2, 3]
    assert "more" in verdict(text, proof).refused


@pytest.mark.parametrize(("said", "side"), [(("2", "5"), "after"), (("2", "1.2"), "before")])
def test_when_a_corner_without_a_ball_is_passed_is_told(said, side):
    """The blend's middle is the end of a motion's time. The corner is passed before or after it."""
    text, _ = made(straight(*said))
    told = verdict(text, table(straight(*said))).told
    assert any("P0020 MOVEL 3 passes its corner" in one and f"s {side} its" in one for one in told)
