"""The small checker also refuses each text that is forged for the judge, or lists more as unchecked.

The proof has the forged text's hash.
"""

import hashlib
import json
from functools import cache

import pytest

import yarclang
from tests.certify.forging import Forger
from tests.certify.test_forged import CHANGES, PROGRAMS, WITH_PROGRAM, cases
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import verify


@cache
def original(name):
    compiled = yarclang.compile(PROGRAMS[name], name="p.yarc")
    assert compiled.value is not None, compiled.diagnostics
    proof = proof_of(compiled.value).value
    verdict = verify(compiled.value.text.encode(), proof.encode())
    assert verdict.refused == ""
    return Forger.of(compiled.value.text), proof, verdict.unchecked


@pytest.mark.parametrize(
    ("name", "change"), [case for case in cases(CHANGES | WITH_PROGRAM) if case.values[0] != "prog"]
)
def test_a_text_that_is_forged_for_the_judge_is_refused(name, change):
    forger, proof, unchecked = original(name)
    forged = change(forger).text.encode("utf-8", "surrogatepass")
    told = json.loads(proof) | {"text": hashlib.sha256(forged).hexdigest()}
    verdict = verify(forged, json.dumps(told).encode())
    assert verdict.refused or set(verdict.unchecked) > set(unchecked)
