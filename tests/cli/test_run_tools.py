"""`yarc run` of a program that changes tools: which tool it begins with is said, and asked where nobody
can know.
"""

from tests.conftest import EXAMPLES

PROGRAM = str(EXAMPLES / "29_tool_changer.yarc")


def test_a_run_says_with_which_tool_it_begins(workshop):
    text = workshop.yarc("run", PROGRAM, "--rate", "50", "--no-log")
    assert "it begins with no tool on the flange\n" in text
    assert "done; CHANGER6 stands where it ends, to a count" in text


def test_from_a_place_where_a_tool_is_on_the_flange(workshop):
    """The simulated changer has it then, and says so to the WAIT."""
    text = workshop.yarc("run", PROGRAM, "--from", "P0230", "--rate", "50", "--no-log", "--yes")
    assert "it begins with SUCTION on the flange\n" in text
    assert "input LOCKED is ON (sensor)\n" in text
    assert "done; CHANGER6 stands where it ends, to a count" in text
