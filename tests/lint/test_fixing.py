"""Tests of fixes of broken programs: a fix causes no new error, and after all fixes none is left to apply."""

import pytest
from conftest import EXAMPLES
from floors import Tally

from tests.lint.test_broken_programs import broken
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.fixing import fixed
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile


def look(source):
    options = Options(robot=None if "ROBOT" in source.text else "INDUSTRIAL6")
    return check_text(source, EXAMPLES, options, plans=False)


def errors(checked):
    return sorted(one.code for one in checked.diagnostics if one.is_error)


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_broken_programs(first):
    tally = Tally()
    for number in range(first, first + 20):
        checked = look(SourceFile("a.yarc", broken(number)[2]))
        tally.count("read", checked.source is not None)
        if checked.source is None:
            continue
        made = fixed(checked, look, lambda one: True)
        assert len(errors(made.checked)) <= len(errors(checked))
        again = fixed(look(SourceFile("a.yarc", made.text)), look, lambda one: True)
        assert again.text == made.text
        tally.count("fixed", made.applied)
    assert tally.below({"read": 0.8, "fixed": 0.04}) == []


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_an_old_program_says_the_same_in_todays_names(end):
    text = (EXAMPLES / "04_old_program.yarc").read_text().replace("\n", end)
    made = fixed(look(SourceFile("a.yarc", text)), look, lambda one: True)
    assert made.checked.diagnostics == ()
    assert made.text.count(end) == text.count(end)
    assert "MOVJ" not in made.text
    assert len(made.applied) == 9


def test_foreign_characters_are_written_plainly_whatever_else_is_wrong():
    text = (
        "P0010\u00a0MOVEJ 200 0 0 0 0 0 [5] (deg,s)\n"
        "P0020 MOVEJ \u22125 0 0 0 0 [\uff15] (deg,s)\n"
        "\u200bP0030 MOVEJ 1 2 3 ä\n"
        "P0040 STOP ! \u00a0\n"
    )
    made = fixed(look(SourceFile("a.yarc", text)), look, lambda one: True)
    assert made.text == (
        "P0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s)\n"
        "P0020 MOVEJ -5 0 0 0 0 [5] (deg,s)\n"
        "\u200bP0030 MOVEJ 1 2 3 ä\n"
        "P0040 STOP ! \u00a0\n"
    )
    assert errors(made.checked) == ["Y0118", "Y0401", "Y0502"]
    assert len(made.applied) == 2


def test_a_foreign_character_whose_substitute_cannot_be_read_stays():
    for text in (
        "P0010 STOP ! now\u2028P0020 MOVEJ HOME [5] (s)\n",
        "P0010 MOVEJ \u201cHOME [5]\n",
    ):
        made = fixed(look(SourceFile("a.yarc", text)), look, lambda one: True)
        assert (made.text, made.applied) == (text, ())
