"""Texts of a session, checked and planned behind its lines."""

from yarclang.coordinator.lines import Lines
from yarclang.coordinator.offers import Planner
from yarclang.robot.description import load_robot


def test_a_finding_in_a_module_stands_at_the_text_that_was_typed(tmp_path):
    """A command of a session has no index of its own."""
    robot = load_robot("INDUSTRIAL6").value
    lines = Lines()
    lines.declare(("USE PICKPLACE", "OUTPUT GRIP M1", "FRAME {FAR} 1900 800 700 0 0 0 (mm,deg) {B}"))
    text = "CALL PICKPLACE.PICK {TCP} {FAR} 150 (mm) GRIP 1.2 (s)"
    made = Planner(robot, tmp_path).offer(text, lines, robot.home, 1)
    assert made.value is None
    errors = [one for one in made.diagnostics if one.is_error]
    assert errors
    for one in errors:
        assert (one.span.line, one.source.line(1)) == (1, text)
        assert one.within.source.module == "APPROACH"
        assert one.within.through[0] == "APPROACH.IN"
