"""Tests of remedies that need the names of the program."""

import pytest

from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

HEAD = "DEFAULT {TCP} (mm,deg,s) {B}\nINPUT PART M12\n"
MOTION = "P0010 MOVEL 0 1174.4 1100 0 0 0 [2]\n"
SEARCH = MOTION + "P0020 MOVEL 0 1174.4 800 0 0 0 [V 150] UNTIL PART\n"
SUB = f"SUB DRILL {{AT}} DEPTH (mm)\n{MOTION}END\n"


def findings(lines):
    module = parse(SourceFile("mistake.yarc", HEAD + lines))
    found = list(module.diagnostics)
    if module.value is not None:
        found += compile_module(module.value, Request(load_robot("INDUSTRIAL6").value)).diagnostics
    return [(one.code, f"{one.message} / {one.help}") for one in found]


@pytest.mark.parametrize(
    ("lines", "code", "said"),
    [
        ("FRAME {Box} 1 2 3 0 0 0\nFRAME {BOX} 1 2 4 0 0 0\n" + MOTION, "Y0206", "upper and lower case"),
        ("LET Gap = 3\nLET gap = 4\n" + MOTION, "Y0206", "upper and lower case"),
        (SUB + "P0020 CALL DRILL {B}\n", "Y0411", "1 given; DEPTH is missing"),
        ("LET FAST = 100\nP0010 MOVEL 0 1174.4 1100 0 0 0 [V FAST]\n", "Y0407", "write [V $FAST]"),
        ("LET FAST = 100\nP0010 MOVEL 0 1174.4 1100 0 0 0 [V<=FAST]\n", "Y0407", "write [V <= $FAST]"),
        (SUB + "P0020 CALL DRIL {B} 3\n", "Y0210", "did you mean DRILL"),
        ("P0020 CALL PALET.GRID 3\n" + MOTION, "Y0210", "write USE PALET"),
        ("TABLE T\n" + MOTION, "Y0401", "all numbers in this line"),
        # a search has already declared a register with this name
        (
            f"{SEARCH}REGISTER SEARCH_1 0..5\nP0030 MOVEL 0 1174.4 1000 0 0 0 [2]\n",
            "Y0206",
            "move this line to the top",
        ),
        (
            f"REGISTER N 0..3\n{MOTION}REPEAT N\nP0020 WAIT [1]\nEND\nREGISTER REPEAT_1 0..5\n",
            "Y0206",
            "for a register of its own",
        ),
    ],
)
def test_the_remedy(lines, code, said):
    found = findings(lines)
    assert [one for one in found if one[0] == code and said in one[1]], found


def test_names_differ_otherwise_than_by_case():
    (found,) = findings("LET GAP = 3\nLET GAP = 4\n" + MOTION)
    assert found == ("Y0206", "GAP is declared already, in line 3 / choose another name")


def test_without_its_end_a_block_has_no_unreachable_lines():
    found = findings(MOTION + "WHEN PART ON\nP0020 STOP\nP0030 MOVEL 0 1174.4 1000 0 0 0 [2]\n")
    assert [code for code, _ in found] == ["Y0113"]
