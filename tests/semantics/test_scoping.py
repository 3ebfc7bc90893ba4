"""Tests of the meaning of names in blocks, SUBs, parameters and modules."""

import pytest
from programs import checked, codes, source

from yarclang.pipeline.modules import loader
from yarclang.pipeline.stages import Request, check_program
from yarclang.robot.description import load_robot
from yarclang.syntax.parse import parse

DEFAULT = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"
GO = "P0010 MOVEJ $A 0 0 0 0 0"


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        (f"LET A = 1\n{GO}", []),
        (f"{GO}\nLET A = 1", ["Y0210"]),
        (f"IF 1\nLET A = 1\n{GO}\nEND", []),
        (f"IF 1\nLET A = 1\nEND\n{GO}", ["Y0210"]),
        (f"IF 1\nLET A = 1\nELSE\n{GO}\nEND\nLET A = 2\nP0020 STOP", []),
        (f"IF 1\nLET A = 1\nELSE\nLET A = 2\nEND\n{GO}", []),
        (f"IF 0\nLET A = 1\nELSE\nLET A = 2\nEND\n{GO}", []),
        (f"IF 1\nLET A = 1\nELSE\nLET C = 2\nEND\n{GO}", ["Y0210"]),
        ("IF 1\nLET A = 1\nELSE\nLET A = 2\nEND\nLET A = 3\nP0020 STOP", ["Y0206"]),
        (f"IF 0\nIF 1\nLET A = 1\nELSE\nLET A = 2\nEND\nELSE\nLET A = 3\nEND\n{GO}", []),
        (f"IF 1\nIF 0\nLET A = 1\nELSE\nLET A = 2\nEND\nELSE\nLET A = 3\nEND\n{GO}", []),
        (f"IF 1\nIF 1\nLET A = 1\nEND\nELSE\nLET A = 3\nEND\n{GO}", ["Y0210"]),
        (f"IF 1\nREPEAT 1\nLET A = 1\nEND\nELSE\nLET A = 3\nEND\n{GO}", ["Y0210"]),
        ("IF 1\nJOINTS A 0 0 0 0 0 1\nELSE\nJOINTS A 0 0 0 0 0 2\nEND\nP0010 MOVEJ A", []),
        (
            (
                "IF 0\n"
                "FRAME {A} 1 2 3 0 0 0\n"
                "ELSE\n"
                "FRAME {A} 0 1174.4 1176 0 0 0\n"
                "END\n"
                "P0010 MOVEJ_RPY 0 0 0 0 0 0 {A}"
            ),
            [],
        ),
        ("IF 0\nLET A = 2\nELSE\nLET A = 3\nEND\nREPEAT $A\nP0010 MOVEJ HOME\nEND", []),
        (f"REPEAT I 2\nIF I\nLET A = 1\nELSE\nLET A = 2\nEND\n{GO}\nEND", []),
        (
            "SUB S\nIF 1\nLET A = 1\nELSE\nLET A = 2\nEND\nEND\nP0010 CALL S\nP0020 MOVEJ $A 0 0 0 0 0",
            ["Y0210"],
        ),
        (f"LET A = 1\nIF 1\n{GO}\nEND", []),
        ("LET A = 1\nIF 1\nLET A = 2\nEND\nP0010 STOP", ["Y0206"]),
        (f"REPEAT A 2\n{GO}\nEND\nLET A = 1\nP0020 STOP", []),
        (f"REPEAT A 2\n{GO}\nEND\nP0020 MOVEJ $A 0 0 0 0 0", ["Y0210"]),
        ("REPEAT 2\nLET A = 1\nEND\nP0010 STOP", []),
        (f"SUB S\n{GO}\nEND\nLET A = 1\nP0020 CALL S", ["Y0210"]),
        (f"LET A = 1\nSUB S\n{GO}\nEND\nP0020 CALL S", []),
        (f"SUB S\n{GO}\nEND\nREPEAT A 2\nP0020 CALL S\nEND", ["Y0210", "Y0210"]),
        (f"SUB S A\n{GO}\nEND\nP0020 CALL S 5", []),
        (f"SUB S A\n{GO}\nEND\nLET A = 3\nP0020 CALL S $A", []),
        (f"LET A = 1\nSUB S A\n{GO}\nEND\nP0020 CALL S 5", ["Y0206"]),
        ("SUB S X X\nEND\nP0020 CALL S 5 6", ["Y0206"]),
        ("SUB S PI\nEND\nP0020 STOP", ["Y0211"]),
        ("SUB S {TCP}\nEND\nP0020 STOP", ["Y0211"]),
        ("SUB S T\nP0005 MOVEJ 1 0 0 0 0 0\nEND\nSUB U\nP0006 CALL S 1\nEND\nP0020 CALL U", []),
        ("SUB U\nP0006 CALL S\nEND\nSUB S\nP0007 MOVEJ 1 0 0 0 0 0\nEND\nP0020 CALL U", ["Y0210"]),
        ("LET GRID = 1\nFRAME {GRID} 1 2 3 0 0 0\nP0010 MOVEJ $GRID 0 0 0 0 0", []),
        ("FRAME {A} 1 2 3 0 0 0\nFRAME {A} 1 2 3 0 0 0\nP0010 STOP", ["Y0206"]),
        ("FRAME {B} 1 2 3 0 0 0\nP0010 STOP", ["Y0211"]),
        ("FRAME {FLANGE} 1 2 3 0 0 0\nP0010 STOP", ["Y0211"]),
        ("JOINTS HOME 0 0 0 0 0 1\nJOINTS HOME 0 0 0 0 0 2\nP0010 STOP", ["Y0206"]),
    ],
)
def test_where_a_name_is_known(program, expected):
    assert codes(checked(DEFAULT + program)[1]) == expected


def test_a_way_that_is_not_taken_is_still_looked_at_for_names_of_commands():
    program = "SUB S\nP0010 MOVEK HOME\nEND\nIF 0\nP0020 MOVEK HOME\nEND\nREPEAT 0\nP0030 MOVEK HOME\nEND"
    assert codes(checked(DEFAULT + program)[1]) == ["Y0202"] * 3


def with_modules(folder, program, **modules):
    for name, text in modules.items():
        (folder / f"{name}.yarc").write_text(text)
    parsed = parse(source(DEFAULT.join(["", program])))
    result = check_program(parsed.value, Request(load_robot("INDUSTRIAL6").value, load=loader(folder)))
    return result.value, (*parsed.diagnostics, *result.diagnostics)


def test_a_modules_names_have_its_own_in_front(tmp_path):
    module = (
        "DEFAULT [3] (m,rad,s) {B}\nLET WIDE = 0.1\nFRAME {CORNER} 1 0 0 0 0 0\nJOINTS LOW 0 0 0 0 0.5 0\n"
        "SUB GO N\nP0010 MOVEJ $(N*WIDE) 0 0 0 0 0\nEND"
    )
    text = "USE pallet\nP0010 CALL PALLET.GO 2\nP0020 MOVEJ Pallet.Low\nP0030 DMOVEJ $(PALLET.WIDE) 0 0 0 0 0"
    program, found = with_modules(tmp_path, text, pallet=module)
    assert codes(found) == []
    first, second, third = program.steps
    assert first.goal.q[0] == pytest.approx(0.2)
    assert first.timing.duration == 3.0
    assert first.origin.place == "P0010>P0010"
    assert second.goal.q[4] == 0.5
    assert third.goal.dq[0] == pytest.approx(0.1 * 3.14159265 / 180)


@pytest.mark.parametrize(
    ("module", "program", "expected"),
    [
        ("LET A = 1", "USE M\nP0010 MOVEJ $A 0 0 0 0 0", ["Y0210"]),
        ("LET A = 1", "USE M\nP0010 MOVEJ $(M.X) 0 0 0 0 0", ["Y0210"]),
        ("P0010 STOP", "USE M\nP0010 STOP", ["Y0208"]),
        ("START HOME", "USE M\nP0010 STOP", ["Y0208"]),
        ("LET A = B", "LET B = 1\nUSE M\nP0010 STOP", ["Y0210"]),
        ("USE N", "USE M\nP0010 STOP", ["Y0213"]),
        ("USE M", "USE M\nP0010 STOP", ["Y0213"]),
        ("LET A = 1", "USE M\nUSE M\nP0010 STOP", ["Y0206"]),
    ],
)
def test_what_a_module_can_not(tmp_path, module, program, expected):
    assert codes(with_modules(tmp_path, program, m=module)[1]) == expected


def test_modules_in_a_circle_are_told_in_the_file_that_closes_it(tmp_path):
    _, found = with_modules(tmp_path, "USE A\nP0010 STOP", a="USE C", c="USE A")
    (one,) = found
    assert one.code == "Y0213"
    assert "A > C > A" in one.message
    assert one.source.name.endswith("c.yarc")


def test_a_modules_table_has_its_name_in_front(tmp_path):
    text = "USE PALLET\nP0010 MOVEJ $(PALLET.WIDTHS[1]) 0 0 0 0 0"
    program, found = with_modules(tmp_path, text, pallet="TABLE WIDTHS 1 20\nSUB GO\nP0010 STOP\nEND")
    assert codes(found) == []
    assert program.steps[0].goal.q[0] == pytest.approx(20 * 3.141592653589793 / 180)
    text = "USE PALLET\nP0010 MOVEJ $(PALLET.WIDTHS[2]) 0 0 0 0 0"
    assert codes(with_modules(tmp_path, text)[1]) == ["Y0456"]
