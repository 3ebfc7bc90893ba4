"""Tests of docs/language.md: its examples compile as it says, and its tables are those of the program.

`pytest tests/test_language_reference.py --rewrite-golden` writes the table of codes and the answers of
section 8 again.
"""

import re
from pathlib import Path

import pytest
from programs import codes, compiled

import yarclang
from yarclang.commands.registry import actions, commands
from yarclang.findings import CATALOGUE, FAMILIES
from yarclang.motion.profile import profile_names
from yarclang.pipeline.cells import cell_loader
from yarclang.robot.description import load_robot
from yarclang.semantics.declared.whole_file import declared_robot
from yarclang.units import UNITS

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = ROOT / "docs" / "language.md"
TEXT = REFERENCE.read_text(encoding="utf-8")

_BLOCK = re.compile(r"^```yarc *(?P<info>[^\n]*)\n(?P<program>.*?)^```$", re.DOTALL | re.MULTILINE)
_TOML = re.compile(r"^```toml (?P<name>\S+)\n(?P<content>.*?)^```$", re.DOTALL | re.MULTILINE)
_LABEL = re.compile(r"(error|warning|note) (Y\d{4})")
_CODES = re.compile(r"(?<=<!-- codes -->\n).*?(?=<!-- /codes -->)", re.DOTALL)
_LINK = re.compile(r"\]\(#([^)]+)\)")
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)

BLOCKS = [
    pytest.param(block["info"], block["program"], id=f"line{TEXT.count(chr(10), 0, block.start()) + 1}")
    for block in _BLOCK.finditer(TEXT)
]


def robot_of(program: str) -> str:
    return (declared_robot(yarclang.parse(program).value) or ("INDUSTRIAL6", None))[0]


def table_of_codes() -> str:
    rows = (f"| `{code}` | {one.severity} | {one.title} |" for code, one in sorted(CATALOGUE.items()))
    return "\n".join(["", "| code | severity | what it means |", "|---|---|---|", *rows, "", ""])


def rewritten(part: re.Pattern[str], today: str) -> str:
    """Replace the text between two markers of the reference by the present one, and return it."""
    text = REFERENCE.read_text(encoding="utf-8")
    REFERENCE.write_text(part.sub(lambda _: today, text), encoding="utf-8")
    return today


TRIANGLE = """solid a
facet normal 0 0 1
outer loop
vertex 2 2 0
vertex 3 2 0
vertex 2 3 0
endloop
endfacet
endsolid a
"""
"""A mesh outside the robot's reach."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with the TOML files that the reference shows, and the meshes that they name."""
    made = tmp_path_factory.mktemp("reference")
    for block in _TOML.finditer(TEXT):
        (made / block["name"]).write_text(block["content"])
        for mesh in re.findall(r'^file = "(.*?)"', block["content"], re.MULTILINE):
            (made / mesh).write_text(TRIANGLE)
    return made


@pytest.mark.parametrize(("info", "program"), BLOCKS)
def test_example(info, program, folder):
    """An example compiles without a finding, or has exactly the findings that are named above it."""
    robot = robot_of(program)
    load_cell = cell_loader(folder, load_robot(robot).value)
    value, diagnostics = compiled(program, robot, load_cell=load_cell)
    if not info:
        assert codes(diagnostics) == []
        assert value is not None
        return
    said = {_LABEL.fullmatch(label).groups() for label in info.split(", ")}
    assert {(one.severity, one.code) for one in diagnostics} == said
    assert (value is None) == any(severity == "error" for severity, _ in said)


def test_table_of_codes_is_the_catalogue(rewrite_golden):
    (shown,) = _CODES.findall(TEXT)
    if rewrite_golden:
        shown = rewritten(_CODES, table_of_codes())
    assert shown == table_of_codes()


def test_every_code_that_is_named_exists():
    assert set(re.findall(r"Y\d{4}", TEXT)) <= set(CATALOGUE)


@pytest.mark.parametrize("name", commands())
def test_every_command_has_a_row_a_section_and_an_example(name):
    assert f"| [{name}](#{name.lower()}) |" in TEXT
    assert f"\n### {name}\n" in TEXT
    assert re.search(rf"^[Pp]\d+ {name}(_RPY|_QUAT)?(_LSPB|_POLY5)?\b", TEXT, re.MULTILINE)


@pytest.mark.parametrize(
    "spec", [one for one in commands().values() if one.old_name], ids=lambda one: one.name
)
def test_every_old_name_is_listed(spec):
    assert f"| `{spec.old_name}` | `{spec.name}` |" in TEXT


def test_every_profile_unit_and_family_is_listed():
    assert all(f"| `_{name}`" in TEXT for name in profile_names())
    assert all(f"`{name}`" in TEXT for name in UNITS)
    assert all(f"| {family} | " in TEXT for family in FAMILIES)


def test_version_is_todays():
    from importlib.metadata import version

    assert f"yarclang {version('yarclang')}" in TEXT


def test_links_lead_to_headings():
    def anchor(heading: str) -> str:
        return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")

    assert set(_LINK.findall(TEXT)) <= {anchor(heading) for heading in _HEADING.findall(TEXT)}


@pytest.mark.parametrize("name", actions())
def test_every_action_has_a_row_and_an_example(name):
    assert re.search(rf"^\| `{name}\b", TEXT, re.MULTILINE)
    assert re.search(rf"^ *P\d+ {name}\b", TEXT, re.MULTILINE)
