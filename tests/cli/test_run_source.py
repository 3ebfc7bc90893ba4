"""A fault of a run is shown at its line of the source: live, in the log, and for a compiled program."""

import contextlib
import re

from click.testing import CliRunner

from tests.cli.run_processes import FINE
from yarclang.cli.yarcc import main as yarcc

TURNS = """\
ROBOT INDUSTRIAL6
! two turns
SUB TURN ANGLE (deg)
  P0010 MOVEJ $ANGLE 0 0 0 0 0 [2] (deg,s)
END
REPEAT I 2
  P0020 CALL TURN $(30 - 20*I)
END
P0030 MOVEJ 0 0 0 0 0 0 [2] (deg,s)
"""
FAULT = "following@line110:1"
LINE = r"%s:4:3: error Y1602: motor 1: its following error is beyond Ixx11\n *4 \|   P0010 MOVEJ \$ANGLE 0 0 0 0 0 \[2\] \(deg,s\)\n"  # noqa: E501


def test_a_fault_in_a_loop_is_shown_at_its_line_and_place(workshop):
    workshop.write("q.yarc", TURNS)
    simulator = workshop.simulator(FAULT)
    words = ("run", "q.yarc", "--to", simulator.address, *FINE, "--log", "run.mcap")
    text = workshop.yarc(*words, status=1)
    assert re.search(LINE % "q.yarc", text), text
    assert re.search(r"(executing|in) P0020\(I=[01]\)>P0010 MOVEJ", text)
    # the log has the line, even if the source is deleted
    (workshop.folder / "q.yarc").unlink()
    shown = workshop.yarc("replay", "run.mcap", "--speed", "max")
    assert re.search(LINE % "q.yarc", shown), shown


def test_a_compiled_program_leads_back_to_its_source(workshop):
    workshop.write("q.yarc", TURNS)
    with contextlib.chdir(workshop.folder):
        assert CliRunner().invoke(yarcc, ["q.yarc", *FINE]).exit_code == 0
    simulators = [workshop.simulator(FAULT) for _ in range(3)]

    def fails(simulator):
        return workshop.yarc("run", "q.pmc", "--to", simulator.address, "--no-log", status=1)

    assert re.search(LINE % "q.yarc", fails(simulators[0]))
    workshop.write("q.yarc", TURNS.replace("30 - 20", "31 - 20"))
    # a text that differs from its program isn't run
    changed = fails(simulators[1])
    assert re.search(
        r"q\.pmc:\d+:1: error Y1160: P0020\(I=0\)>P0010 MOVEJ: the motion ends .* 1 deg from its goal",
        changed,
    )
    assert "q.yarc has changed since: compile the program again" in changed
    (workshop.folder / "q.yarc").unlink()
    assert re.search(
        r"error Y1602: .*\n  in line 4 of its source, .*: q.yarc, the program, isn't there\n",
        fails(simulators[2]),
    )
