"""`yarc run` with motions that flow into each other: starts, pauses, and the report of a stop in a corner."""

import re

import pytest

from tests.cli.run_processes import run_on

CHAIN = """ROBOT INDUSTRIAL6
OUTPUT GLUE M1
P0010 MOVEJ 2 0 0 0 0 0 [0.5] (deg,s)
P0020 MOVEJ 6 0 0 0 0 0 [1] (deg,s) BLEND 1
P0030 SET GLUE ON
P0040 MOVEJ 6 6 0 0 0 0 [6] (deg,s) BLEND 1
P0050 MOVEJ 6 6 3 0 0 0 [1] (deg,s)
P0060 SET GLUE OFF
P0070 MOVEJ 0 0 0 0 0 0 [1] (deg,s)
"""


@pytest.mark.parametrize("place", ["P0040", "P0050"])
def test_a_run_never_begins_in_a_corner(workshop, simulator, place):
    workshop.write("q.yarc", CHAIN)
    text = workshop.here(*run_on(simulator, "--from", place, program="q.yarc"), status=1)
    assert text.count("error") == 1
    assert re.search(rf"error Y1608: P00\d0 MOVEJ flows into {place} MOVEJ: ", text)
    assert "help: begin with P0020 MOVEJ, where the chain begins: --from P0020\n" in text
    assert (simulator.stands() == 0.0).all()


def test_a_run_begins_with_the_chain(workshop, simulator):
    workshop.write("q.yarc", CHAIN)
    text = workshop.yarc(*run_on(simulator, "--from", "P0020", "--yes", program="q.yarc"))
    assert "q.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text
    assert simulator.complaints() == []


def test_a_step_is_a_whole_chain(workshop, simulator):
    workshop.write("q.yarc", CHAIN)
    process = workshop.start(*run_on(simulator, "--step", program="q.yarc"))
    process.wait_for("for P0020 MOVEJ (2 of 3)")
    workshop.here("resume")
    process.wait_for("for P0070 MOVEJ (3 of 3)")
    workshop.here("resume")
    assert "q.yarc: done" in process.end(0)


def test_a_stop_in_a_chain_says_how_to_go_on(workshop, simulator):
    workshop.write("q.yarc", CHAIN)
    process = workshop.start(*run_on(simulator, program="q.yarc"))
    process.wait_for("P0040 MOVEJ")
    workshop.here("stop")
    text = process.end(1)
    assert "on its path, in P0040 MOVEJ, " in text
    assert text.endswith(f"  to continue: yarc run q.yarc --to {simulator.address} --tm 10 --from P0020\n")
