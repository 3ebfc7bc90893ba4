"""Tests of the files in tests/rejected, whose comments name the finding of each line: a missing or an
additional finding is an error.
"""

import re
from pathlib import Path

import pytest
from programs import planned

from yarclang.pipeline.cells import cell_loader, check_description
from yarclang.robot.description import load_robot

FILES = sorted((Path(__file__).parent / "rejected").glob("*.yarc"))
_EXPECTED = re.compile(r"! (error|warning|note): (Y[0-9]{4}) ?([^!]*)")
_ROBOT = re.compile(r"! robot: (\S+)")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_findings_stand_where_they_are_expected(path):
    text = path.read_text()
    expected = [
        (number, *match)
        for number, line in enumerate(text.splitlines(), 1)
        for match in _EXPECTED.findall(line)
    ]
    name = _ROBOT.search(text)[1]
    load_cell = cell_loader(path.parent, load_robot(name).value)
    _, diagnostics = planned(text, name, load_cell=load_cell)
    found = {(one.span.line, one.severity, one.code): one.message for one in diagnostics}
    assert len(found) == len(diagnostics), "a finding is said twice"
    assert sorted(found) == sorted(entry[:3] for entry in expected)
    for line, severity, code, message in expected:
        assert message.strip() in found[line, severity, code]


CELLS = sorted((Path(__file__).parent / "rejected").glob("*.toml"))
_IN_TOML = re.compile(r"# (error|warning|note): (Y[0-9]{4}) ?([^#]*)")


@pytest.mark.parametrize("path", CELLS, ids=lambda path: path.stem)
def test_findings_of_cells_stand_where_they_are_expected(path):
    text = path.read_text()
    robot = re.search(r"# robot: (\S+)", text)
    expected = [
        (number, *match)
        for number, line in enumerate(text.splitlines(), 1)
        for match in _IN_TOML.findall(line)
    ]
    diagnostics = check_description(str(path), robot and robot[1])
    found = [(one.span.line, one.severity, one.code) for one in diagnostics]
    assert sorted(found) == sorted(entry[:3] for entry in expected)
    for line, severity, code, message in expected:
        said = [
            one.message
            for one in diagnostics
            if (one.span.line, one.severity, one.code) == (line, severity, code)
        ]
        assert any(message.strip() in one for one in said), said
    for one in diagnostics:
        assert one.message.endswith(".")
        assert one.help
