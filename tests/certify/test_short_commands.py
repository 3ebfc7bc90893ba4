"""Tests of outputs at the end of a command that has only one segment."""

import pytest
from programs import compiled, robot_of

from yarclang.certify.certifying import certify
from yarclang.pipeline.proofs import proof_of
from yarclang.verify.verdict import verify

CHAIN = """OUTPUT LAMP M1 OFF
DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ_RPY -60 1174.4 1100 0 0 0 [2]
P0020 MOVEL -20 1174.4 1100 0 0 0 [V 50] TOL 0.05 BLEND 0
P0030 MOVEL -19.45 1174.4 1100 0 0 0 [V 50] TOL 0.05 BLEND 0
P0040 SET LAMP ON
P0050 MOVEL 30 1174.4 1100 0 0 0 [V 50] TOL 0.05
"""
"""P0030 has only one segment, so the SET after it is also within one segment of the end of P0020."""


@pytest.fixture(scope="module")
def program():
    value, found = compiled(CHAIN)
    assert value is not None, found
    short = next(one for one in value.plan.motions if value.program.steps[one.step].origin.index == "P0030")
    assert len(short.curve.points) == 4
    return value


def test_the_output_belongs_to_the_short_command(program):
    verdict = verify(program.text.encode(), proof_of(program).value.encode())
    assert not verdict.refused


@pytest.mark.parametrize(
    ("segments", "in_map", "changed", "is_refused"),
    [
        (-1, "P0030 MOVEL 5 173 173", "P0030 MOVEL 5 174 174", True),
        (1, "P0050 MOVEL 7 175 ", "P0050 MOVEL 7 174 ", False),
    ],
)
def test_an_output_that_is_moved(program, segments, in_map, changed, is_refused):
    """One segment earlier, the output would be set at the end of P0020, which is refused. One segment later
    is allowed, because no other command ends there.
    """
    assert in_map in program.text
    lines = program.text.replace(in_map, changed).splitlines(keepends=True)
    at = lines.index("M1==1\n")
    lines.insert(at + segments, lines.pop(at))
    robot = robot_of("INDUSTRIAL6")
    judged = certify("".join(lines), program.program, robot, robot.tolerance)
    assert [one.code for one in judged.diagnostics if one.is_error] == (["Y1165"] if is_refused else [])
