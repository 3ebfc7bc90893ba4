"""Any text is checked, formatted, coloured and asked about without a failure, and soon.

Usually 400 texts are drawn, half a minute of one core; YARCLANG_RANDOM_TEXTS=25000 in the environment draws so many, for a night. What breaks a law is
told with its seed and its text. With YARCLANG_RANDOM_TEXTS_TIMES=FILE, the time of each text's check is written there [s], after its seed.
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
