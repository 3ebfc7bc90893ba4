"""Tests of the catalogue: each code is well formed and documented, and its example shows this finding."""

import re
from pathlib import Path

import pytest
from programs import codes, compiled, planned

from yarclang.findings import CATALOGUE, FAMILIES
from yarclang.pipeline.modules import loader

LANGUAGE_FAMILIES = {"02", "03", "04", "10"}
YARC_FAMILIES = {"01", "02", "03", "04", "05", "06", "10", "12"}
CERTIFIED = {"Y0479", "Y0610"}
"""Codes that only the certificate of an otherwise sound program reports."""
WITH_EXAMPLE = [
    one for one in CATALOGUE.values() if one.family in YARC_FAMILIES and one.example and one.code != "Y1391"
]


def test_codes_are_well_formed_and_names_unique():
    assert all(re.fullmatch(r"Y\d{4}", code) for code in CATALOGUE)
    assert all(one.family in FAMILIES for one in CATALOGUE.values())
    names = [one.name for one in CATALOGUE.values()]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("finding", CATALOGUE.values(), ids=lambda one: one.code)
def test_every_finding_says_why(finding):
    assert len(finding.why) > 30
    assert finding.why.endswith(".")
    assert not finding.title.endswith(".")


@pytest.mark.parametrize("finding", WITH_EXAMPLE, ids=lambda one: one.code)
def test_the_example_shows_the_finding_and_the_better_one_does_not(finding):
    load = loader(Path(__file__).parent)
    stages = compiled if finding.code in CERTIFIED else planned
    assert finding.code in codes(stages(finding.example, load=load)[1])
    if finding.better:
        found = stages(finding.better, load=load)[1]
        assert finding.code not in codes(found)
        assert not [one for one in found if one.is_error]


@pytest.mark.parametrize(
    "finding",
    [one for one in CATALOGUE.values() if one.family in LANGUAGE_FAMILIES],
    ids=lambda one: one.code,
)
def test_findings_of_the_language_show_what_to_write(finding):
    assert finding.example
    assert finding.better
