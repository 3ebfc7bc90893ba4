"""Programs with one fault each, made of the examples: what is found stands at the fault, and says it once or twice."""

import random
import re

import pytest
from conftest import EXAMPLES

from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

COUNT = 200
AT_MOST = 2
"""Findings for one fault, in 95 % of the programs."""
SHARE = 0.95

_TOKEN = re.compile(r"\{[^}]*\}|\[[^\]]*\]|\([^)]*\)|\"[^\"]*\"|[^\s{}\[\]()\"]+|[\[\](){}]")
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
SOURCES = sorted(EXAMPLES.glob("*.yarc"))


def broken(number):
    """The text of a broken program, its file, and the lines at which the fault is."""
    draw = random.Random(f"yarc {number}")
    path = SOURCES[number % len(SOURCES)]
    lines = path.read_text().splitlines()
    mutation = MUTATIONS[number // len(SOURCES) % len(MUTATIONS)]
    at = mutation(lines, draw)
    return mutation.__name__, path, "\n".join(lines) + "\n", at


def found(path, text):
    options = Options(robot=None if re.search(r"^ROBOT", text, re.MULTILINE) else "INDUSTRIAL6")
    return check_text(SourceFile(path.name, text), path.parent, options, plans=False).diagnostics


@pytest.fixture(scope="module")
def results():
    before = {path: {one.code for one in found(path, path.read_text())} for path in SOURCES}
    made = []
    for number in range(COUNT):
        name, path, text, at = broken(number)
        said = [one for one in found(path, text) if one.code not in before[path]]
        made.append((name, path.stem, at, said))
    return made


def test_no_cascades(results):
    many = [
        (name, stem, sorted(at), [(one.span and one.span.line, one.code, one.message) for one in said])
        for name, stem, at, said in results
        if len(said) > AT_MOST
    ]
    assert len(many) <= (1.0 - SHARE) * COUNT, many


def test_an_error_is_found_at_the_fault_or_names_it(results):
    """An error stands at the fault, or what stands elsewhere speaks of what is missing there."""
    errors = [(name, stem, at, [one for one in said if one.is_error]) for name, stem, at, said in results]
    errors = [entry for entry in errors if entry[3]]
    assert len(errors) > COUNT / 3
    away = [
        (name, stem, sorted(at), [(one.span and one.span.line, one.code, one.message) for one in said])
        for name, stem, at, said in errors
        if name not in {"line_deleted", "end_deleted", "lines_swapped"}
        and not any(one.span and one.span.line in at for one in said)
    ]
    assert len(away) <= (1.0 - SHARE) * len(errors), away
