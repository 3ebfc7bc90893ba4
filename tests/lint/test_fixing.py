"""Fixes of broken programs: none makes an error that wasn't there, and the result has none of its fixes left to apply."""

import pytest
from conftest import EXAMPLES

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
    applied = 0
    for number in range(first, first + 20):
        checked = look(SourceFile("a.yarc", broken(number)[2]))
        if checked.source is None:
            continue
        made = fixed(checked, look, lambda one: True)
        assert len(errors(made.checked)) <= len(errors(checked))
        again = fixed(look(SourceFile("a.yarc", made.text)), look, lambda one: True)
        assert again.text == made.text
        applied += len(made.applied)
    assert applied > 0


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_an_old_program_says_the_same_in_todays_names(end):
    text = (EXAMPLES / "04_old_program.yarc").read_text().replace("\n", end)
    made = fixed(look(SourceFile("a.yarc", text)), look, lambda one: True)
    assert made.checked.diagnostics == ()
    assert made.text.count(end) == text.count(end)
    assert "MOVJ" not in made.text
    assert len(made.applied) == 9
