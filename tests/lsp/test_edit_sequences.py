"""Texts that are edited at random, quickly, and while requests are pending: the server answers all requests,
and finds the same as `yarc check`.

Usually four pairs of sequences are run, in a quarter of a minute. YARCLANG_RANDOM_EDITS=500 in the
environment runs 500 pairs, in half an hour. The two texts of a pair are edited at the same time in one
server: one as people type, one as tools and pasting do. With YARCLANG_RANDOM_EDITS_MEMORY=FILE, a line with
the pair's seed and the server's memory [MB] is written to FILE after each pair.
"""

import asyncio
import os
from pathlib import Path

import pytest
from floors import Tally

from tests.lsp.edit_sequences import EVERY, EXAMPLES, PULLS, Sequence
from tests.lsp.wire import server

COUNT = int(os.environ.get("YARCLANG_RANDOM_EDITS", "4"))
BLOCK = 100
"""Number of pairs in one test. They share one server."""

MEMORY = os.environ.get("YARCLANG_RANDOM_EDITS_MEMORY")

EDITS = 2 * EVERY
"""Number of edits of a sequence."""

WARM = 25
"""Pairs after which the server's memory levels off."""

GROWTH = 1.15
"""Largest ratio of the server's memory in the second half of the pairs to that in the first half."""

FLOORS = {
    "edit": 0.8,
    "question": 0.5,
    "hover": 0.05,
    "completion": 0.5,
    "definition": 0.03,
    "codeAction": 0.2,
    "formatting": 0.05,  # of about twenty requests, about a tenth gets an answer
    "semanticTokens/full": 0.3,
    "documentSymbol": 0.3,
    "comparison": 1.0,
    "comparison of a program that can be carried out": 0.12,
    "comparison of a program with errors": 0.2,
}
"""Smallest shares of edits that change the text, of requests that get an answer, and of comparisons."""


@pytest.mark.parametrize("block", range(-(-COUNT // BLOCK)))
def test_a_text_that_is_edited_is_understood_as_it_is_at_last(block):
    tally, held = Tally(), []
    seeds = range(block * BLOCK, min((block + 1) * BLOCK, COUNT))
    asyncio.run(_pairs(seeds, tally, held))
    assert tally.reached["comparison"] == 2 * len(seeds) * (EDITS // EVERY)
    assert not (short := tally.below(FLOORS)), "; ".join(short)
    later = held[WARM:]
    half = len(later) // 2
    assert half == 0 or max(later[half:]) < GROWTH * max(later[:half]), held


async def _pairs(seeds, tally, held):
    async with server(PULLS) as wire:
        for seed in seeds:
            both = [Sequence(seed, is_heavy, EXAMPLES, done=tally) for is_heavy in (False, True)]
            await asyncio.gather(*(one.run(wire, EDITS) for one in both))
            held.append(wire.memory)
            if MEMORY:
                with Path(MEMORY).open("a") as file:
                    file.write(f"{seed} {held[-1]:.1f}\n")
