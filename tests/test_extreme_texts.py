"""Texts that are as deep, as long or as large as nobody writes them: a finding soon, at every door, and no failure."""

import time

import pytest
from mutated_texts import Laws

DEEP = 10_000
LONG = 99_000
"""Characters of a line that is still read."""

TEXTS = {
    "brackets": "LET A = " + "(" * LONG,
    "brackets that are closed": "LET A = " + "(" * 40_000 + "1" + ")" * 40_000,
    "closing brackets": "LET A = 1 " + ")" * LONG,
    "brackets in values": "P0010 MOVEJ $" + "(" * LONG,
    "100,000 brackets": "LET A = " + "(" * 100_000,
    "loops": "REPEAT 1\n" * DEEP,
    "loops that are closed": "REPEAT 1\n" * DEEP + "P0010 STOP\n" + "END\n" * DEEP,
    "blocks of all kinds": "IF 1 > 0\nELSE\nREPEAT 2\nWHEN D ON\nSUB X\n" * (DEEP // 5),
    "ends": "END\nELSE\n" * DEEP,
    "a line of 1 MB": "P0010 MOVEJ " + "1 " * 500_000,
    "a word of 1 MB": "A" * 1_000_000,
    "terms": "LET A = " + "+".join(["1"] * (LONG // 2)),
    "100,000 terms": "LET A = " + "+".join(["1"] * 100_000),
    "powers": "LET A = " + "**".join(["1"] * (LONG // 3)),
    "signs": "LET A = " + "-" * LONG + "1",
    "words of operators": "LET A = " + "NOT " * (LONG // 4) + "1",
    "functions": "LET A = " + "SIN(" * DEEP + "1" + ")" * DEEP,
    "arguments": "LET A = MAX(" + ",".join(["1"] * (LONG // 2)) + ")",
    "a number of 10,000 digits": "P0010 MOVEJ " + "1" * DEEP + " 0 0 0 0 0 [5] (deg,s)\nLET A = " + "1" * DEEP,
    "a loop of 10,000 digits": "REPEAT " + "1" * DEEP + "\nP0010 STOP\nEND",
    "an index of 10,000 digits": "P" + "1" * DEEP + " STOP\nP" + "0" * DEEP + "1 STOP\n",
    "no numbers": "P0010 MOVEJ 1e999 nan inf -inf 0 -1e999 [1e999] (deg,s)\nLET A = 1e999\nREPEAT 1e999\nEND\nP0020 MOVEJ $A 0 0 0 0 0 [$A] (deg,s)",
    "numbers that nobody can compute": "LET A = 10**10**10**10\nLET B = 9**9**9\nLET C = 1/0\nLET D = 0**-1\nLET E = SQRT(-1)\nREPEAT $B\nEND",
    "way-points": "P0010 MOVEJ_SPLINE " + "; ".join(["0 0 0 0 0 0"] * 7_000) + " [5] (deg,s)",
    "way-points in lines": "P0010 MOVEJ_SPLINE 0 0 0 0 0 0;\n" + "0 0 0 0 0 1;\n" * 20_000 + "0 0 0 0 0 0 [5] (deg,s)",
    "values": "P0010 MOVEJ " + "1 " * 45_000,
    "words": "P0010 MOVEJ " + "a " * 45_000,
    "options": "P0010 MOVEJ HOME [5] (s) " + "BLEND 5 " * 11_000,
    "units": "P0010 MOVEJ HOME [5] (" + "mm," * 30_000 + "mm)",
    "frames": "P0010 CALL X " + "{A} " * 24_000,
    "a text": 'P0010 HOLD "' + "a" * 90_000,
    "semicolons": ";" * LONG,
    "lines of semicolons": ";\n" * 50_000,
    "comments": "!" * LONG,
    "braces": "{" * LONG,
    "quotes": '"' * LONG,
    "texts with marks": '"ä"' * 30_000,
    "dollars": "$" * LONG,
    "equals": "LET A " + "=" * 90_000,
    "empty lines": "\n" * 200_000,
    "indices": "P0010 " * 16_000,
    "one mistake": "P0010 MOVEK\n" * 10_000,
    "names": "".join(f"LET A{i} = A{i - 1} + 1\n" for i in range(1, 4_000)),
    "unknown names": "".join(f"LET N{i} = M{i}\n" for i in range(1_000)),
    "SUBs": "".join(f"SUB A{i}\nP0010 CALL A{i + 1}\nEND\n" for i in range(1_500)) + "P0020 CALL A0",
    "no-break spaces": "P0010 MOVEJ " + "\u00a0" * 90_000,
    "no-break spaces between": "P0010 MOVEJ " + "1\u00a0" * 45_000,
    "marks of direction in comments": "! " + "\u202e" * 90_000,
    "marks in way-points": "P0010 MOVEJ_SPLINE 0;\n" + "0\u00a0;\n" * 20_000,
}  # fmt: skip
SECONDS = 12.0
"""Of the processor, for a check: a quarter of it is what a quiet machine takes."""


@pytest.mark.parametrize("name", TEXTS)
def test_it_is_told_soon_and_nothing_fails(name, tmp_path):
    laws, begin = Laws(), time.process_time()
    assert laws.broken(1, tmp_path, TEXTS[name]) == []
    assert laws.seconds < SECONDS
    assert time.process_time() - begin < 6 * SECONDS
