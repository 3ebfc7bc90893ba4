"""The small checker refuses every text that the judge refuses.

In the texts, one number of a move line is changed, by little or by much.
"""

import hashlib
import json
import re

import numpy as np
import pytest
from programs import compiled

from tests.verify.proof_forging import MOTIONS
from yarclang.certify.certifying import certify
from yarclang.pipeline.proofs import proof_of
from yarclang.pipeline.stages import claims_of
from yarclang.robot.model import Tolerance
from yarclang.verify.verdict import verify

TRIES = 60


@pytest.fixture(scope="module")
def made_whole():
    found, _ = compiled(MOTIONS, "INDUSTRIAL6")
    assert found is not None
    proof = proof_of(found)
    assert proof.value is not None
    return found, json.loads(proof.value) | {
        "cell": {"bodies": [], "exceptions": [], "zones": []},
        "planes": [],
    }


def is_wrong(found, text, tolerance):
    """Return True if the judge refuses a text."""
    judged = certify(text, found.program, found.plan.robot, tolerance, claims_of(found.plan))
    return judged.value is None or any(one.is_error for one in judged.diagnostics)


def test_what_the_judge_refuses_is_refused(made_whole):
    found, proof = made_whole
    lines = found.text.split("\n")
    moves = [k for k, line in enumerate(lines) if re.match(r"X-?[0-9].*C-?[0-9]", line)]
    random = np.random.default_rng(34)
    refused, stricter = 0, 0
    for _ in range(TRIES):
        k, axis = int(random.choice(moves)), str(random.choice(list("XYZABC")))
        way = float(random.choice([-1, 1])) * 10.0 ** random.uniform(-5.0, -0.5)
        changed = re.sub(
            rf"{axis}(-?[0-9.]+)", lambda one, by=way, name=axis: f"{name}{float(one[1]) + by:.6f}", lines[k]
        )
        text = "\n".join([*lines[:k], changed, *lines[k + 1 :]])
        wrong = is_wrong(found, text, found.certificate.tolerance)
        wider = Tolerance(
            *(1.1 * one for one in (found.certificate.tolerance.position, found.certificate.tolerance.angle))
        )
        forged = proof | {"text": hashlib.sha256(text.encode()).hexdigest()}
        verdict = verify(text.encode(), json.dumps(forged).encode())
        # The bounds of judge and checker are both above the true deviation, and either may be the larger one.
        # So the checker must refuse a text if the judge refuses it even with a tolerance of 110 %.
        assert verdict.refused or not wrong or not is_wrong(found, text, wider), changed
        refused += wrong
        stricter += bool(verdict.refused) and not wrong
    # Right and wrong texts were drawn. The checker uses s(t) of the unchanged text, so it is slightly
    # stricter.
    assert refused > 20
    assert TRIES - refused > 10
    assert stricter < TRIES / 4
