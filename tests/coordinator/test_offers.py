"""Tests of texts in a session, which are checked and planned after the session's lines."""

from yarclang.coordinator.lines import Lines
from yarclang.coordinator.offers import Planner
from yarclang.robot.description import load_robot


def test_a_finding_in_a_module_stands_at_the_text_that_was_typed(tmp_path):
    """A finding in a module refers to the typed text, although a typed command has no index of its own."""
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


def test_a_table_in_the_folder_of_the_session_is_read_for_each_offer(tmp_path):
    robot = load_robot("INDUSTRIAL6").value
    planner, text = Planner(robot, tmp_path), 'MOVEJ_TIMED "path.csv" (deg,s)'
    (missing,) = planner.offer(text, Lines(), robot.home, 1).diagnostics
    assert (missing.code, missing.span.line) == ("Y0107", 1)
    for seconds in (2, 3):
        rows = f"time,J1,J2,J3,J4,J5,J6\n1,2,0,0,0,0,0\n{seconds},4,0,0,0,0,0\n"
        (tmp_path / "path.csv").write_text(rows)
        made = planner.offer(text, Lines(), robot.home, 1)
        assert [one for one in made.diagnostics if one.is_error] == []
        assert abs(made.value.compiled.plan.duration - seconds) < 2e-3
