"""Tests of findings in programs with one fault each, made from the examples: a finding stands at the fault or
names it, and most faults have one or two findings.
"""

import random
import re

from conftest import EXAMPLES

from yarclang.highlight.words import words as words_of_the_language
from yarclang.memory import Recent
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.incremental import MOST_KEPT
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

COUNT = 400
AT_MOST = 2
"""Most findings that a fault may have, in at least SHARE of the programs."""
SHARE = 0.95

_TOKEN = re.compile(r"\{[^}]*\}|\[[^\]]*\]|\([^)]*\)|\"[^\"]*\"|[^\s{}\[\]()\"]+|[\[\](){}]")
_WORD = re.compile(r"[A-Z_][A-Z0-9_]{2,}")
_OF_BLOCKS = {"Y0113", "Y0114", "Y0115", "Y0116", "Y1002"}
"""Codes of a missing END or ELSE, which are reported where the block begins."""
_LEFT_OUT = {"Y0302", "Y0304", "Y0406"}
"""Codes of a value that is missing because DEFAULT doesn't give it; they are reported at the line that needs
it.
"""
_DIGIT = re.compile(r"\d")


def code_lines(lines):
    return [number for number, line in enumerate(lines) if line.partition("!")[0].strip()]


def token_deleted(lines, draw):
    number = draw.choice(code_lines(lines))
    tokens = list(_TOKEN.finditer(lines[number].partition("!")[0]))
    token = draw.choice(tokens)
    lines[number] = lines[number][: token.start()] + lines[number][token.end() :]
    return {number + 1}


def character_deleted(lines, draw):
    number = draw.choice(code_lines(lines))
    at = draw.randrange(len(lines[number].partition("!")[0].rstrip()))
    lines[number] = lines[number][:at] + lines[number][at + 1 :]
    return {number + 1}


def lines_swapped(lines, draw):
    numbers = code_lines(lines)
    place = draw.randrange(len(numbers) - 1)
    one, other = numbers[place], numbers[place + 1]
    lines[one], lines[other] = lines[other], lines[one]
    return {one + 1, other + 1}


def word_doubled(lines, draw):
    number = draw.choice(code_lines(lines))
    token = draw.choice(list(_TOKEN.finditer(lines[number].partition("!")[0])))
    lines[number] = lines[number][: token.end()] + " " + token[0] + lines[number][token.end() :]
    return {number + 1}


def digit_changed(lines, draw):
    number = draw.choice([one for one in code_lines(lines) if _DIGIT.search(lines[one].partition("!")[0])])
    place = draw.choice(list(_DIGIT.finditer(lines[number].partition("!")[0]))).start()
    lines[number] = lines[number][:place] + draw.choice("0123456789x") + lines[number][place + 1 :]
    return {number + 1}


def line_deleted(lines, draw):
    number = draw.choice(code_lines(lines))
    del lines[number]
    return {number + 1}


def end_deleted(lines, draw):
    ends = [number for number, line in enumerate(lines) if line.strip() == "END"]
    if not ends:
        return line_deleted(lines, draw)
    number = draw.choice(ends)
    del lines[number]
    return {number + 1}


def word_misspelt(lines, draw):
    number = draw.choice(code_lines(lines))
    words = [one for one in _TOKEN.finditer(lines[number].partition("!")[0]) if len(one[0]) > 3]
    if not words:
        return digit_changed(lines, draw) if _DIGIT.search(lines[number]) else {number + 1}
    word = draw.choice(words)
    at = draw.randrange(word.start() + 1, word.end() - 2)
    line = lines[number]
    lines[number] = line[:at] + line[at + 1] + line[at] + line[at + 2 :]
    return {number + 1}


MUTATIONS = (
    token_deleted,
    character_deleted,
    lines_swapped,
    word_doubled,
    digit_changed,
    line_deleted,
    end_deleted,
    word_misspelt,
)
COMMON = {"DEG", "TCP", *words_of_the_language().declarations, *words_of_the_language().commands}
SOURCES = sorted(EXAMPLES.glob("*.yarc"))


def broken(number):
    """Return the kind of fault, the example's path, the text of the broken program, and the lines of the
    fault.
    """
    draw = random.Random(f"yarc {number}")
    path = SOURCES[number % len(SOURCES)]
    lines = path.read_text().splitlines()
    mutation = MUTATIONS[number // len(SOURCES) % len(MUTATIONS)]
    at = mutation(lines, draw)
    return mutation.__name__, path, "\n".join(lines) + "\n", at


def found(path, text, memory):
    robot = None if re.search(r"^ROBOT", text, re.MULTILINE) else "INDUSTRIAL6"
    return check_text(
        SourceFile(path.name, text), path.parent, Options(robot=robot, memory=memory)
    ).diagnostics


def speaks_of(one, at, original):
    """Return True if a finding stands at the fault or next to it, or speaks of what the fault left out."""
    if one.span is None:
        return False
    words = {word for line in at for word in _WORD.findall(original[line - 1].upper())} - COMMON
    of_default = any(original[line - 1].startswith("DEFAULT") for line in at)
    said = set(_WORD.findall(f"{one.message} {one.source.line(one.span.line)}".upper()))
    near = any(abs(one.span.line - line) <= 1 for line in at)
    of_default = of_default and (one.code in _LEFT_OUT or one.code.startswith("Y05"))
    return near or of_default or one.code in _OF_BLOCKS or bool(said & words)


def test_one_fault_is_said_once_or_twice_where_it_is():
    # this speeds up the test: motions that a fault leaves unchanged aren't planned again, and the findings
    # are the same
    memory = Recent(MOST_KEPT)
    before = {path: {one.code for one in found(path, path.read_text(), memory)} for path in SOURCES}
    many, away, errors = [], [], 0
    for number in range(COUNT):
        name, path, text, at = broken(number)
        said = [one for one in found(path, text, memory) if one.code not in before[path]]
        told = (name, path.stem, sorted(at), [(one.span and one.span.line, one.code) for one in said])
        if len(said) > AT_MOST:
            many.append(told)
        original = path.read_text().splitlines()
        errors += any(one.is_error for one in said)
        if any(one.is_error for one in said) and not any(speaks_of(one, at, original) for one in said):
            away.append(told)
    assert len(many) <= (1.0 - SHARE) * COUNT, many
    assert errors > COUNT / 3
    # a wrong but legal value is reported where it is used, which may be elsewhere
    assert len(away) <= (1.0 - SHARE) * errors, away
