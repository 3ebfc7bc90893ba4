"""Tests of UNTIL, INTO and ON: their arguments, and the commands that may follow a search."""

import pytest
from programs import compiled

from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module

HEAD = (
    "INPUT TOUCH M12\nINPUT FORCE M20..M27 STEP 0.5\nOUTPUT LAMP M1 OFF\nREGISTER DEPTH 0..50000\n"
    "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEL 0 1174.4 1000 0 0 0 [2]\n"
)
DOWN = "P0020 MOVEL 0 1174.4 800 0 0 0 [V 100]"
UP = "P0030 MOVEL 0 1174.4 1000 0 0 0 [2]\n"


def errors(lines, head=HEAD):
    module = parse(SourceFile("search.yarc", head + lines))
    found = list(module.diagnostics)
    if module.value is not None:
        found += compile_module(module.value, Request(load_robot("INDUSTRIAL6").value)).diagnostics
    return [one.code for one in found if one.is_error]


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        (f"{DOWN} UNTIL\n", "Y0412"),
        (f"{DOWN} UNTIL LAMP\n", "Y0209"),
        (f"{DOWN} UNTIL TUCH\n", "Y0210"),
        (f"{DOWN} UNTIL FORCE\n", "Y0471"),
        (f"{DOWN} UNTIL TOUCH BLEND 5\n{UP}", "Y0412"),
        (f"{DOWN} UNTIL TOUCH UNTIL TOUCH\n", "Y0412"),
        (f"{DOWN} UNTIL TOUCH INTO\n", "Y0210"),
        (f"{DOWN} UNTIL TOUCH INTO LAMP\n", "Y0209"),
        (f"{DOWN} INTO DEPTH\n", "Y0412"),
        ("P0020 MOVEJ 0 0 0 0 30 0 [2] UNTIL TOUCH INTO DEPTH\n", "Y0412"),
        ("P0020 MOVEC 0 1174.4 950; 0 1174.4 900 0 0 0 [2] UNTIL TOUCH\n", "Y0412"),
        (f"{DOWN} UNTIL TOUCH ELSE\nP0025 WAIT [1]\n", "Y0113"),
        (f"{DOWN} ELSE\n", "Y0412"),
        # these commands need to know where the motion before them ends
        (f"{DOWN} UNTIL TOUCH\nP0030 DMOVE 0 0 50 0 0 0 [1]\n", "Y0475"),
        (f"{DOWN} UNTIL TOUCH\nP0030 DMOVEJ 5 0 0 0 0 0 [1]\n", "Y0475"),
        (f"{DOWN} UNTIL TOUCH\n{UP[:-1]} BLEND 5\nP0040 MOVEL 0 1174.4 900 0 0 0 [2]\n", "Y0475"),
        (f"{DOWN} UNTIL TOUCH\n{UP[:-1]} UNTIL TOUCH\n", "Y0475"),
        (f"{DOWN} UNTIL TOUCH\nP0030 MOVEJ_AVOID 0 0 0 0 30 0 [2]\n", "Y0475"),
        (f"{DOWN} UNTIL TOUCH\nWHEN TOUCH ON\nP0030 WAIT [1]\nEND\n", "Y0475"),
        # the branch of ELSE would have to lead to the end of the search's line
        (f"{DOWN} UNTIL TOUCH ELSE\nP0025 MOVEL 0 1174.4 900 0 0 0 [1]\nEND\n{UP}", "Y1002"),
    ],
)
def test_what_is_refused(lines, code):
    assert errors(lines) == [code]


@pytest.mark.parametrize(
    "lines",
    [
        f"{DOWN} UNTIL TOUCH\n",
        f"{DOWN} UNTIL TOUCH OFF INTO DEPTH\n{UP}",
        (
            f"{DOWN} UNTIL TOUCH\n"
            "P0025 SET LAMP ON\n"
            "P0026 WAIT TOUCH OFF [5]\n"
            "P0027 HOLD\n"
            "P0028 SET DEPTH = 3\n"
            f"{UP}"
        ),
        f'{DOWN} UNTIL TOUCH ELSE\nP0025 ABORT "nothing"\nEND\n{UP}',
        f"{DOWN} UNTIL TOUCH ELSE\nEND\n{UP}",
        f"LOOP\n{DOWN} UNTIL TOUCH INTO DEPTH\n{UP}UNTIL DEPTH > 1000\n",
        f"{DOWN} UNTIL TOUCH\n{UP}P0040 DMOVE 0 0 50 0 0 0 [1]\n",
        (
            "SUB DOWN\n"
            f"{DOWN.replace('P0020 ', 'P0020 ')} UNTIL TOUCH\n"
            f"{UP}END\n"
            "P0050 CALL DOWN\n"
            "P0060 CALL DOWN\n"
        ),
    ],
)
def test_what_is_taken(lines):
    assert errors(lines) == []


def test_words_are_printed_as_they_were():
    text = HEAD + f"ON TOUCH OFF HOLD\n{DOWN} UNTIL TOUCH OFF INTO DEPTH ELSE\n  P0025 WAIT [1]\nEND\n{UP}"
    module = parse(SourceFile("search.yarc", text)).value
    printed = print_module(module)
    assert "UNTIL TOUCH OFF INTO DEPTH ELSE\n" in printed
    again = parse(SourceFile("search.yarc", printed)).value
    assert print_module(again) == printed


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("ON TOUCH\n", "Y0401"),
        ("ON TOUCH OFF STOP\n", "Y0401"),
        ("ON TOUCH MAYBE HOLD\n", "Y0402"),
        ("ON LAMP ON HOLD\n", "Y0209"),
        ("ON FORCE ON HOLD\n", "Y0471"),
        ("ON TOUCH ON HOLD\nON TOUCH ON HOLD\n", "Y0206"),
        ("ON TOUCH ON [5] HOLD\n", "Y0101"),
    ],
)
def test_what_on_refuses(lines, code):
    head, mark, rest = HEAD.partition("DEFAULT")
    assert errors(mark + rest, head + lines) == [code]


def test_on_stands_above_the_commands_of_a_program():
    assert errors("ON TOUCH ON HOLD\n") == ["Y0208"]
    watches = "".join(f"INPUT I{n} M{30 + n}\nON I{n} ON HOLD\n" for n in range(9))
    assert errors("", watches + HEAD) == ["Y0401"]


def test_a_program_that_watches_and_searches_is_streamed_only():
    for lines in ("ON TOUCH OFF HOLD\n", ""):
        head, mark, rest = HEAD.partition("DEFAULT")
        text = head + lines + mark + rest + f"{DOWN} UNTIL TOUCH\n{UP}" * (not lines)
        value, found = compiled(text, target="prog")
        assert value is None
        assert [one.code for one in found if one.is_error] == ["Y1106"]


def test_no_gripper_acts_where_a_search_has_ended(tmp_path):
    """A gripper may not act where a search has ended, because the pose of the part in the gripper would be
    unknown.
    """
    from conftest import EXAMPLES

    from yarclang.pipeline.inputs import Options, open_program

    cell = (EXAMPLES / "05_pick_and_place.toml").read_text()
    (tmp_path / "cell.toml").write_text(cell)
    text = (
        'CELL "cell.toml"\nINPUT TOUCH M40\nDEFAULT {GRIPPER} [2] (mm,deg,s) {B}\nSTART READY\n'
        "P0010 MOVEJ READY UNTIL TOUCH\nP0020 SET GRIP ON\nP0030 MOVEJ READY\n"
    )
    (tmp_path / "p.yarc").write_text(text)
    opened = open_program(str(tmp_path / "p.yarc"), Options(robot="INDUSTRIAL6")).value
    found = compile_module(opened.module, opened.request).diagnostics
    assert "Y0950" in [one.code for one in found], found


@pytest.mark.parametrize("line", ["ON TOUCH OFF HOLD", "MOVEL 0 1174.4 800 0 0 0 [V 100] UNTIL TOUCH"])
def test_lines_that_are_typed_neither_watch_nor_search(line):
    text = "INPUT TOUCH M12\nDEFAULT {TCP} (mm,deg,s) {B}\n" + line + "\n"
    module = parse(SourceFile("<input>", text)).value
    request = Request(load_robot("INDUSTRIAL6").value, index_needed=False)
    found = compile_module(module, request).diagnostics
    assert "Y0208" in [one.code for one in found], found
