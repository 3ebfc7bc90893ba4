"""`yarc run` of a program that changes tools names the tool at its start, and asks if it isn't known."""

from tests.conftest import EXAMPLES

PROGRAM = str(EXAMPLES / "29_tool_changer.yarc")


def test_a_run_says_with_which_tool_it_begins(workshop):
    text = workshop.yarc("run", PROGRAM, "--rate", "50", "--no-log")
    assert "it begins with no tool on the flange\n" in text
    assert "done; CHANGER6 is at the program's end, within one count" in text


def test_from_a_place_where_a_tool_is_on_the_flange(workshop):
    """If a run begins with a tool on the flange, the simulated changer has it, and the WAIT succeeds."""
    text = workshop.yarc("run", PROGRAM, "--from", "P0230", "--rate", "50", "--no-log", "--yes")
    assert "it begins with SUCTION on the flange\n" in text
    assert "input LOCKED is ON (sensor)\n" in text
    assert "done; CHANGER6 is at the program's end, within one count" in text
