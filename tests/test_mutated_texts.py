"""Any text is checked, formatted, coloured and asked about without a failure, and soon.

Usually 400 texts are drawn, half a minute of one core; YARCLANG_RANDOM_TEXTS=25000 in the environment draws
so many, for a night. What breaks a law is told with its seed and its text. With
YARCLANG_RANDOM_TEXTS_TIMES=FILE, the time of each text's check is written there [s], after its seed.
"""

import os
from pathlib import Path

import pytest
from mutated_texts import Laws, drawn, programs

COUNT = int(os.environ.get("YARCLANG_RANDOM_TEXTS", "400"))
BLOCK = 50
"""So many texts are one test: tests run side by side."""

TIMES = os.environ.get("YARCLANG_RANDOM_TEXTS_TIMES")
LONGEST_CHECK = 2.0
"""What the check of a text takes at most without planning [s of the processor]."""


def test_there_are_programs():
    assert len(programs()) > 100


FAILED_ONCE = (
    "DEFAULT {!TCP} [5] (mm,deg,s) {B}",  # fmt wrote its tail once more at each run
    "LET A =\u20033 *",  # an IndexError
    "LET A = 1 \u2028 2",
    "minP0010 MOVEJ HOME [5] (s)",  # an index was found within a word
    "P" + "1" * 10_000 + " STOP",  # a ValueError
    'P0010 HOLD "abc ! def',
    "\ufeffP0010 STOP\n\ufeffP0020 STOP",
    "P0010 MOVEJ " + "a " * 4_000,  # a finding for each word
    "REPEAT 8881\n" + "REPEAT 1\n" * 99 + "END\n" * 100,  # 888,100 rounds around nothing, 7 s
)
"""What broke a law before."""


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
