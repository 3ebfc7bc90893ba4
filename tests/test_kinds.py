"""Tests that no neutral module mentions one kind of controller; import-linter only finds imports."""

import re
from functools import cache
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "yarclang"

OWN = ("backend_pmac", "certify/pmac", "pmac", "runtime/pmac", "simulator", "verify")
"""Folders that belong to one kind of controller; `verify` checks its texts."""

WORDS = re.compile(
    r"turbo|pmac|\.pmc\b|rotary|\bP81\d\d\b|(?-i:\bM[1-9]\d*\b)|\bixx?\d\d\b|\bi8\b|\bi10\b|SPLINE1|DWELL0"
    r"|\bBSTART\b",
    re.IGNORECASE,
)
"""Words for this kind of controller, its files, its buffer, its variables and its statements."""

EXAMPLES = "an example of a program or a cell for INDUSTRIAL6, which hangs on a Turbo PMAC"
HELP = "what people read of the kind that is delivered; what happens is asked of the backend"
FINDING = "the catalogue keeps the explanations of all codes, those of a kind's rooms as well"
ROOMS = "a guide to the rooms names those of a kind"

ALLOWED = {
    "__init__.py": HELP,
    "cell/schema.py": EXAMPLES,
    "campaign/drawing.py": EXAMPLES,
    "certify/__init__.py": ROOMS,
    "certify/read/layout.py": "names the manual of the law of the curve, which kinds share",
    "cli": HELP,
    "certify/blends/ball.py": "a bound of mathematics, M4",
    "certify/motion/cartesian.py": "a bound of mathematics, M4",
    "decisions.py": EXAMPLES,
    "coordinator/live/proof.py": "names the law of the curve, as the manual does",
    "findings": FINDING,
    "lint/rules": EXAMPLES,
    "mistakes/actions.py": EXAMPLES,
    "mistakes/declarations.py": EXAMPLES,
    "mistakes/languages.py": "words of other languages, and examples of programs",
    "pipeline/checking.py": HELP,
    "repl/dots/looking.py": EXAMPLES,
    "robot/kinds.py": "the kind of a robot.toml that says none: files were written before there were kinds",
    "runtime/__init__.py": ROOMS,
    "runtime/log_record.py": "the name of a log's attachment, which is the format of logs",
    "semantics/control/cases.py": EXAMPLES,
    "semantics/declared/signals.py": EXAMPLES,
    "semantics/names/signals.py": EXAMPLES,
    "simulated_cell/script.py": EXAMPLES,
    "teaching/forms.py": EXAMPLES,
    "words/builtin/input.py": EXAMPLES,
    "words/builtin/output.py": EXAMPLES,
}
"""Modules and folders that may use such words, each with the reason."""


def spoken(source: str) -> list[tuple[int, str]]:
    """Return line and text of each word for the kind of controller."""
    lines = enumerate(source.splitlines(), 1)
    return [(number, found.group()) for number, line in lines for found in WORDS.finditer(line)]


@cache
def neutral() -> dict[str, list[tuple[int, str]]]:
    """Return the words for the kind in each module outside its own folders."""
    names = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*.py")}
    return {
        name: spoken(path.read_text(encoding="utf-8"))
        for name, path in names.items()
        if not name.startswith(tuple(f"{room}/" for room in OWN))
    }


def is_of(name: str, place: str) -> bool:
    return name == place or name.startswith(f"{place}/")


def test_no_neutral_room_has_a_word_of_a_kind():
    found = [
        f"{name}:{line}: {word}"
        for name, words in neutral().items()
        for line, word in words
        if not any(is_of(name, place) for place in ALLOWED)
    ]
    assert found == []


@pytest.mark.parametrize("place", ALLOWED)
def test_no_exception_is_needless(place: str):
    assert any(words for name, words in neutral().items() if is_of(name, place))


@pytest.mark.parametrize(
    "source",
    ['Literal["turbo-pmac"]', '"job.pmc"', "if P8100:", '"M11"', "rotary_words", "table.i8", "ixx08"],
)
def test_the_rule_sees(source: str):
    assert spoken(source)


@pytest.mark.parametrize("source", ["MOVEJ", "P0010 WAIT [1]", "six_i", "class Motor", "np.pi * 8"])
def test_the_rule_spares(source: str):
    assert not spoken(source)
