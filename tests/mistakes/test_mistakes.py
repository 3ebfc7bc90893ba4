"""Tests of the findings about common mistakes: there is one finding, at the right place, that says what to
do, with a fix if one repair is likely.
"""

import random
import time
from pathlib import Path

import pytest
from mistakes.looking import checked, faults_of
from mistakes.table import HEAD, MISTAKES

from yarclang.mistakes.answers import GUESSERS
from yarclang.mistakes.line import Around, Line
from yarclang.source import SourceFile

OPEN = frozenset(Path(__file__).with_name("open.txt").read_text(encoding="utf-8").split())
"""Names of mistakes that don't get a good answer yet; no name may be added to this list."""


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


PIECES = (
    *("P0010 ", "MOVEJ ", "MOVEJ_RPY ", "SET ", "WAIT ", "LET ", "IF ", "HOLD ", "CALL ", "FRAME ", "READY",
        "Offs(p,1)", "sleep(2)"),
    *("A", " ", "1", ",", ";", "=", "(", ")", "[", "]", "{", "}", "X0 ", "$", "-", "_", ".", "V ", "NEAR A ",
        "0,", "//", '"', "!"),
    *("2.5", "10°", "10deg", "1,174", "--", "#", "END", "BLEND", "TCP"),
)  # fmt: skip


def test_any_line_is_answered_within_itself():
    """For random lines, no guesser raises or takes long, and each guess is about a place in the line."""
    chance, guessed = random.Random(5), 0
    around = Around(SourceFile("a.yarc", HEAD + "\n"))
    for number in range(4_000):
        text = "".join(chance.choice(PIECES) for _ in range(chance.randint(1, 14)))
        if number % 40 == 0:
            text = (text * 400)[:400]
        for guesser in GUESSERS:
            guess = guesser(Line(text, 2, around))
            if guess is not None:
                guessed += 1
                assert 0 <= guess.begin <= guess.end <= len(text), (guesser.__name__, text)
                assert guess.message
                assert guess.help
    assert guessed > 1_000


def test_a_line_of_nothing_but_a_sign_takes_no_time():
    begun = time.process_time()
    for text in (
        'A = "' + " " * 390,
        "LET A" + "+A" * 190,
        "P0010 MOVEJ " + "0," * 190,
        "P0010 SET A" + " " * 380 + "?",
    ):
        for guesser in GUESSERS:
            guesser(Line(text, 2, Around(SourceFile("a.yarc", ""))))
    assert time.process_time() - begun < 2.0


HEADS = (
    *("P0010 MOVEJ ", "P0010 MOVEC ", "P0010 SET ", "P0010 WAIT ", "P0010 HOLD ", "WHEN ", "REPEAT ",
        "LET N ", "FRAME {A} "),
    *("DEFAULT ", "USE ", "", "JOINTS A ", "OUTPUT A ", "CALL A", "REGISTER N "),
)  # fmt: skip
REPEATED = (
    *("A,", "0 ", "0, ", "X0 ", "{A} ", "(", "A ", "$A + ", "1/", "-", "mm,", "[A] ", "BLEND 5 ", "NEAR 0 ",
        "V=1 ", "5 s", "NOT "),
    *("A = ", "P-", "1.", "''", "A B", "( ", "0 Z1 ", "= 1 TO ", "TO 1 ", " TIMES", "  ", "\t", "; 0", "{ A",
        "}{"),
)  # fmt: skip


@pytest.mark.parametrize("head", HEADS)
def test_what_is_repeated_takes_no_time(head):
    """The guessers' regular expressions take about linear time, up to the longest line that they get."""
    around = Around(SourceFile("a.yarc", HEAD + "\nINPUT DOOR M11\nOUTPUT GLUE M1 OFF\n"))
    for repeated in REPEATED:
        for tail in ("", "?"):
            line = Line((head + repeated * 400)[:399] + tail, 4, around)
            for guesser in GUESSERS:
                begun = time.process_time()
                guesser(line)
                assert time.process_time() - begun < 0.2, (guesser, head, repeated, tail)


def test_an_answer_has_the_code_of_the_finding_at_its_place():
    text = "DEFAULT {TCP} [5] (cm,deg,s)\nP0010 MOVEL 0 80 60 -90 0 0 [2s]\n"
    assert [one.code for one in checked(text).diagnostics] == ["Y0407"]
