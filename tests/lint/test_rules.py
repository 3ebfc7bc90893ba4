"""Tests of the rules: each is documented, finds the fault of its invalid examples, and finds nothing in its
valid ones.
"""

import re

import pytest
from conftest import EXAMPLES

from yarclang.findings import CATALOGUE, FAMILIES
from yarclang.lint.registry import codes_of, everything, rules
from yarclang.pipeline.checking import check_file, check_text
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile

RULES = [pytest.param(rule, id=rule.finding.code) for rule in rules()]
CASES = [
    pytest.param(rule, text, expected, id=f"{rule.finding.code}-{kind}{number}")
    for rule in rules()
    for kind, texts, expected in (
        ("valid", (*rule.valid, rule.finding.better), False),
        ("invalid", (*rule.invalid, rule.finding.example), True),
    )
    for number, text in enumerate(texts)
]
TRUE_NOTES = {"Y0505", "Y0506", "Y0702", "Y0204", "Y0920"}
"""Findings that the rules' examples rightly have: a swing, a waypoint near a limit, a singularity, names of
the first release, a way round.
"""


def found(text, folder, teach=False):
    if teach:
        (folder / "yarc.toml").write_text("teach = true\n")
    return check_text(SourceFile("test.yarc", text), folder, Options(robot="INDUSTRIAL6")).diagnostics


def is_said(rule, diagnostics):
    """Return True if the rule has a finding of its own, or its message and help explain an error."""
    if rule.finding.code in {one.code for one in diagnostics}:
        return True
    said = r"if the values are in (m|mm), write \1 in the units: this pose is [\d.,]+ m?m from \{B\}"
    return rule.explains_errors and any(one.is_error and re.match(said, one.help) for one in diagnostics)


@pytest.mark.parametrize(("rule", "text", "expected"), CASES)
def test_example(rule, text, expected, tmp_path):
    diagnostics = found(text, tmp_path, rule.teach)
    assert is_said(rule, diagnostics) == expected
    if not (expected and rule.explains_errors):
        assert not [one.message for one in diagnostics if one.is_error]


@pytest.mark.parametrize("rule", RULES)
def test_documentation(rule):
    finding = rule.finding
    assert finding.family in FAMILIES
    assert finding.severity in {"warning", "note"}
    assert len(finding.why) > 80
    assert finding.why.endswith(".")
    assert not finding.title.endswith(".")
    assert finding.example
    assert finding.better
    assert rule.valid
    assert rule.invalid


def test_codes_and_names_are_there_once():
    assert not {rule.finding.code for rule in rules()} & CATALOGUE.keys()
    assert len(everything()) == len(CATALOGUE) + len(rules())
    assert len({one.name for one in everything().values()}) == len(everything())


def test_there_are_many():
    """Count only codes about programs, not those about robots, cells, imports and runs."""
    assert len([code for code in everything() if code < "Y13" or code >= "Y17"]) > 50
    assert len(rules()) >= 11
    assert {rule.reads.__name__ for rule in rules()} == {"Module", "Program", "MotionPlan", "Certificate"}


def test_words_for_codes():
    assert codes_of("y0611") == ("Y0611",)
    assert codes_of("slow-motion") == ("Y0611",)
    assert {"Y0601", "Y0611"} <= {*codes_of("Y06")}
    assert codes_of("Y9") == codes_of("nothing") == codes_of("") == ()


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yarc")), ids=lambda path: path.stem)
def test_no_rule_cries_wolf(path):
    diagnostics = check_file(str(path), Options()).diagnostics
    if "Y1391" in {one.code for one in diagnostics}:
        diagnostics = check_file(str(path), Options(robot="INDUSTRIAL6")).diagnostics
    assert {one.code for one in diagnostics} <= TRUE_NOTES


def test_a_rule_is_silent_at_a_command_with_an_error(tmp_path):
    text = "OUTPUT GRIP M1 OFF\nOUTPUT GRIP M1 OFF\nP0010 MOVEJ HOME [50%]"
    assert [one.code for one in found(text, tmp_path)] == ["Y0206", "Y0603"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("P0010 MOVEJ HOME [5] (s)", True),
        ("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0020 MOVEJ 10 0 0 0 0 0 [5] (deg,s)", True),
        (
            (
                "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"
                "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0\n"
                "P0020 MOVEL 0 1174.4 1176 0 0 0"
            ),
            True,
        ),
        ("P0010 DMOVE {TCP} 0 0 0 0 0 0 [5] (mm,deg,s) {B}", True),
        ("P0010 MOVEJ 0.001 0 0 0 0 0 [5] (deg,s)", False),
        ("P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP0020 MOVEJ HOME [5] (s)", False),
        ("P0010 WAIT [5] (s)", False),
    ],
)
def test_motions_that_go_nowhere(text, expected, tmp_path):
    """Y0603 comes from the planner and not from a rule, so that its examples are here."""
    assert ("Y0603" in {one.code for one in found(text, tmp_path)}) == expected


def test_modules_keep_what_they_declare(tmp_path):
    text = "LET DEPTH = 5 (mm)\nSUB LIFT\n  P0010 DMOVE {TCP} 0 0 5 0 0 0 [2] (mm,deg,s) {B}\nEND\n"
    assert not [one for one in found(text, tmp_path) if one.code in {"Y0215", "Y0216"}]


def test_the_standard_library_is_not_spoken_of_in_other_programs(tmp_path):
    text = (EXAMPLES / "05_pick_and_place.yarc").read_text()
    assert {one.source.name for one in found(text, tmp_path)} <= {"test.yarc"}
