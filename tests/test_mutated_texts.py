"""Tests with random texts: any text is checked, formatted, coloured and inspected quickly and without a
failure.

Usually, 400 texts are drawn, which takes half a minute of one core. YARCLANG_RANDOM_TEXTS=25000 in the
environment draws that many, for a night. A text that breaks a law is reported with its seed.
YARCLANG_RANDOM_TEXTS_TIMES=FILE writes the time of each text's check [s] to a file, after its seed.
"""

import os
from pathlib import Path

import pytest
from mutated_texts import Laws, drawn, programs

COUNT = int(os.environ.get("YARCLANG_RANDOM_TEXTS", "400"))
BLOCK = 50
"""Number of texts in one test; several tests run in parallel."""

TIMES = os.environ.get("YARCLANG_RANDOM_TEXTS_TIMES")
LONGEST_CHECK = 2.0
"""Longest processor time of a text's check without planning [s]."""


def test_there_are_programs():
    assert len(programs()) > 100


FAILED_ONCE = (
    "DEFAULT {!TCP} [5] (mm,deg,s) {B}",  # once, each run of fmt wrote the end of this line again
    "LET A =\u20033 *",  # once, an IndexError
    "LET A = 1 \u2028 2",
    "minP0010 MOVEJ HOME [5] (s)",  # once, an index was found within a word
    "P" + "1" * 10_000 + " STOP",  # once, a ValueError
    'P0010 HOLD "abc ! def',
    "\ufeffP0010 STOP\n\ufeffP0020 STOP",
    "P0010 MOVEJ " + "a " * 4_000,  # once, a finding for each word
    "REPEAT 8881\n" + "REPEAT 1\n" * 99 + "END\n" * 100,  # once, 888,100 empty passes, which took 7 s
)
"""Texts that have broken a law before."""


@pytest.mark.parametrize("text", FAILED_ONCE, ids=range(len(FAILED_ONCE)))
def test_what_failed_once(text, tmp_path):
    laws = Laws()
    assert laws.broken(1, tmp_path, text) == []
    assert laws.seconds < LONGEST_CHECK


@pytest.mark.parametrize("block", range(COUNT // BLOCK))
def test_any_text_keeps_the_laws(block):
    laws = Laws()
    for seed in range(block * BLOCK, (block + 1) * BLOCK):
        folder, text = drawn(seed)
        try:
            found = laws.broken(seed, folder, text)
        except Exception as error:
            error.add_note(f"seed {seed}:\n{text!r}")
            raise
        if TIMES:
            with Path(TIMES).open("a") as file:
                file.write(f"{seed} {len(text)} {laws.seconds:.4f}{' loops' * laws.unrolls_far}\n")
        assert found == [], f"seed {seed}:\n{text!r}"
        assert laws.seconds < LONGEST_CHECK or laws.unrolls_far, f"seed {seed}:\n{text!r}"
