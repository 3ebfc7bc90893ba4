"""Tests of the place that the report of a fault names."""

import click
import pytest
from conftest import EXAMPLES

from yarclang.cli.faults import fault_text
from yarclang.coordinator.ending import where_of
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.origins import Origins
from yarclang.pipeline.stages import check_program
from yarclang.runtime.outcome import Concerned


@pytest.fixture(scope="module")
def origins():
    opened = open_program(str(EXAMPLES / "06_palletising.yarc"), Options()).value
    return Origins(check_program(opened.module, opened.request).value)


def test_a_command_in_a_module_is_where_the_program_calls_it(origins):
    step = next(one for one in origins.program.steps if one.origin.source.module == "APPROACH")
    origin = step.origin
    where = where_of(origins, Concerned(origin.label, origin.name, origin.span.line))
    assert where.file == str(EXAMPLES / "06_palletising.yarc")
    assert where.text.strip() == "P0020 CALL PICKPLACE.PICK {GRIPPER} {CONVEYOR} 150 GRIP 1.2"
    assert where.text[where.column - 1 : where.end_column - 1] == "P0020 CALL PICKPLACE.PICK"
    assert (
        where.note
        == f"in APPROACH, line 14 (through APPROACH.IN, APPROACH.ABOVE): {origin.source.line(14).strip()}"
    )
    told = click.unstyle(fault_text("Y1406", "the robot doesn't follow", "look at it", where)).split("\n")
    assert told[0].startswith(f"{where.file}:{where.line}:")
    assert told[-2:] == [f"  {where.note}", "  help: look at it"]


def test_a_command_of_the_program_is_where_it_stands(origins):
    last = origins.program.steps[-1].origin
    where = where_of(origins, Concerned(last.label, last.name, last.span.line))
    assert (where.line, where.text, where.note) == (last.span.line, "P0040 MOVEJ READY", "")
    told = click.unstyle(fault_text("Y1406", "the robot doesn't follow", "", where)).split("\n")
    assert len(told) == 3
