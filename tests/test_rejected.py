"""Each file of tests/rejected says on its lines what is to be found there; one finding missing or too many fails."""

import re
from pathlib import Path

import pytest
from programs import planned

FILES = sorted((Path(__file__).parent / "rejected").glob("*.yarc"))
_EXPECTED = re.compile(r"! (error|warning|note): (Y[0-9]{4}) ?(.*)")
_ROBOT = re.compile(r"! robot: (\S+)")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_findings_stand_where_they_are_expected(path):
    text = path.read_text()
    expected = [
        (number, *match.groups())
        for number, line in enumerate(text.splitlines(), 1)
        if (match := _EXPECTED.search(line))
    ]
    _, diagnostics = planned(text, _ROBOT.search(text)[1])
    found = {(one.span.line, one.severity, one.code): one.message for one in diagnostics}
    assert len(found) == len(diagnostics), "a finding is said twice"
    assert sorted(found) == sorted(entry[:3] for entry in expected)
    for line, severity, code, message in expected:
        assert message.strip() in found[line, severity, code]
