"""`yarc run` of a program that teaches places.

The places are shown, kept, and printed by `yarc registers`, and can be compiled in a program's text.
"""

import re

import pytest

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} (mm,deg,s) {B}\n"
SEARCH = (
    HEAD
    + """INPUT TOUCH M12
P0010 MOVEL 0 1174.4 1100 0 0 0 [2]
P0020 JPOS ABOVE
P0030 MOVEL 0 1174.4 800 0 0 0 [V 100] UNTIL TOUCH
P0040 JPOS FOUND_AT
P0050 LPOS FOUND_POSE
P0060 MOVEL 0 1174.4 1100 0 0 0 [2]
"""
)
SCRIPT = '[[inputs]]\ninput = "TOUCH"\nto = "ON"\nplace = "P0030"\ndelay = 1.5\n'


def test_a_run_keeps_and_shows_where_it_stood(workshop):
    workshop.write("p.yarc", SEARCH)
    workshop.write("p.inputs.toml", SCRIPT)
    text = workshop.yarc("run", "p.yarc", "--inputs", "p.inputs.toml", "--rate", "20", "--no-log")
    lines = dict(re.findall(r"^P00\d+ [JL]POS: ((?:JOINTS|POSE) [A-Z_]+) (.*)$", text, re.MULTILINE))
    assert set(lines) == {"JOINTS ABOVE", "JOINTS FOUND_AT", "POSE FOUND_POSE"}
    shown = workshop.yarc("registers", "p.yarc")
    assert "INDUSTRIAL6 simulated\n" in shown
    assert all(f"  {name} {values}\n" in shown for name, values in lines.items())
    x, y, z, *turn = map(float, lines["POSE FOUND_POSE"].split(" (")[0].split())
    assert (x, y, *turn) == pytest.approx((0.0, 1174.4, 0.0, 0.0, 0.0), abs=1e-3)
    assert 850.0 < z < 1000.0  # the place is on the line of the search
    declared = "".join(f"{one.strip()}\n" for one in shown.splitlines() if one.startswith("  "))
    begins = SEARCH.replace("INPUT", declared + "INPUT", 1)
    workshop.write("q.yarc", begins + "P0070 MOVEJ FOUND_AT [3]\nP0080 MOVEJ_RPY FOUND_POSE [3]\n")
    workshop.yarc("check", "q.yarc")
    assert "3 values forgotten" in workshop.yarc("registers", "p.yarc", "--forget")
    assert "no register values are stored" in workshop.yarc("registers", "p.yarc")
