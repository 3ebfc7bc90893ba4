"""Tests of the examples in the descriptions of commands and public functions: all compile unchanged."""

import doctest

import pytest
from programs import compiled

import yarclang
from yarclang.commands.registry import commands
from yarclang.motion.profile import load_profile, profile_names
from yarclang.semantics.names.commands import TARGETS

BEFORE = "DEFAULT {TCP} (mm,deg,s) {B}\nSTART 0 -6.158742074 -46.519197172 0 52.677939245 0 (deg)\n"
EXAMPLES = [(spec.name, example) for spec in commands().values() for example in spec.examples]


@pytest.mark.parametrize(("name", "example"), EXAMPLES)
def test_example(name, example):
    made, diagnostics = compiled(BEFORE + example)
    assert not [one for one in diagnostics if one.severity != "note"], diagnostics
    assert made is not None


@pytest.mark.parametrize("spec", commands().values(), ids=lambda spec: spec.name)
def test_a_command_is_described(spec):
    assert len(spec.summary) > 10
    assert spec.doc.endswith("\n")
    assert spec.examples
    assert all(spec.name in example for example in spec.examples)
    assert set(spec.targets) <= {"", *TARGETS}


def test_table_ii_of_the_paper_is_complete():
    assert set(commands()) >= {"STOP", "DMOVEJ", "DMOVE", "MOVEJ", "MOVEL", "MOVEJ_SPLINE"}


def test_profiles_are_found_by_their_files():
    assert set(profile_names()) >= {"LSPB", "POLY5", "SCURVE", "TOPP"}
    assert [load_profile(name).name for name in profile_names()] == list(profile_names())


def test_public_functions():
    failures, tried = doctest.testmod(yarclang)
    assert tried > 0
    assert failures == 0
    made = yarclang.compile("P0010 MOVEJ HOME [1] (s)", robot="INDUSTRIAL6")
    assert made.value is not None
    assert [one.code for one in yarclang.check("P0010 MOVEK", robot="INDUSTRIAL6")] == ["Y0202"]
    assert yarclang.format("p1   movej  home [1](s)") == "P1 MOVEJ HOME [1] (s)\n"
    with pytest.raises(ValueError, match="line 1"):
        yarclang.format("P1 MOVEJ [5")
