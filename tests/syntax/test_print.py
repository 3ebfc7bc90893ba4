"""Tests of printing: a printed tree is parsed to the same tree, for every form of statement and for whole
files. Blocks are indented.
"""

from pathlib import Path

from hypothesis import given
from syntax.writing import bare, module, parsed, said, statement

from yarclang.syntax.ast import Block, FrameName, Number, Parameter, Quantity, Word
from yarclang.syntax.blocks import arrange
from yarclang.syntax.print import print_module

CONTRACT = (Path(__file__).parent / "contract.yarc").read_text(encoding="utf-8")


def printed(text):
    result = parsed(text)
    assert result.diagnostics == ()
    return print_module(result.value)


@given(statement)
def test_a_statement_says_the_same_when_it_is_printed(text):
    again = printed(text)
    assert said(again) == said(text)
    assert printed(again) == again


@given(module())
def test_a_file_says_the_same_when_it_is_printed(text):
    again = printed(text)
    assert said(again) == said(text)
    assert bare(arrange(parsed(again).value).value) == bare(arrange(parsed(text).value).value)
    assert printed(again) == again


@given(module())
def test_blocks_are_indented_by_two(text):
    lines = printed(text).split("\n")

    def check(nodes, depth):
        for node in nodes:
            if not isinstance(node, Block):
                assert lines[node.line - 1].startswith("  " * depth + (node.index or node.name).name)
                continue
            check([one for one in (node.head, node.otherwise_head, node.end) if one], depth)
            check(node.body, depth + 1)
            check(node.otherwise or (), depth + 1)

    check(arrange(parsed("\n".join(lines)).value).value, 0)


def test_all_of_the_language_is_read():
    result = parsed(CONTRACT)
    assert result.diagnostics == ()
    assert arrange(result.value).diagnostics == ()


def squeezed(text):
    return "".join(
        line[: len(line) - len(line.lstrip())] + " ".join(line.split()) + "\n" for line in text.splitlines()
    )


def test_the_contract_is_printed_as_it_is_written():
    """Printing this file changes at most the columns of its comments."""
    assert squeezed(printed(CONTRACT)) == squeezed(CONTRACT)


def test_comments_of_a_paragraph_are_below_each_other():
    text = (
        "let a = 1 ! one\n"
        "let bcd = 2   ! two\n"
        "let e = 3\n"
        "\n"
        "\n"
        "\n"
        "let f = 4 ! three\n"
        "! alone\n"
        "let g = 500!four\n"
    )
    assert printed(text) == (
        "LET A = 1    ! one\n"
        "LET BCD = 2  ! two\n"
        "LET E = 3\n"
        "\n"
        "LET F = 4    ! three\n"
        "! alone\n"
        "LET G = 500  !four\n"
    )
    far = "let a = 1 ! one\np1 movej 100 0 0 0 0 0 [10] (mm,deg,s) {b} ! a long line\n"
    assert printed(far) == "LET A = 1  ! one\nP1 MOVEJ 100 0 0 0 0 0 [10] (mm,deg,s) {B}  ! a long line\n"


def test_comments_between_way_points_stay_there():
    text = "p1 movej_spline 1 2; ! first\n! second\n\n3 4; ! third\n! fourth\n5 6 [$t] ! last\n"
    again = (
        "P1 MOVEJ_SPLINE 1 2;  ! first\n"
        "! second\n"
        "3 4;                  ! third\n"
        "! fourth\n"
        "5 6 [$T]              ! last\n"
    )
    assert printed(text) == again
    assert printed(again) == again


def test_empty_lines_at_the_ends_go():
    assert printed("\n\n! head\n\n\np1 stop\n\n\n") == "! head\n\nP1 STOP\n"


def test_arguments_and_parameters():
    result = parsed("SUB drill {at} depth (MM) t\nEND\nP1 call Drill {hole} 20 30 (mm) Home\n").value
    sub, _, call = result.statements
    name, frame, depth, time = sub.waypoints[0].values
    assert (type(name), type(frame), type(depth), type(time)) == (Word, FrameName, Parameter, Parameter)
    assert (name.name, frame.name, depth.word.name, depth.unit.text, time.unit) == (
        "DRILL",
        "AT",
        "DEPTH",
        "MM",
        None,
    )
    name, frame, plain, quantity, home = call.waypoints[0].values
    assert (name.name, frame.name, plain.value, home.name) == ("DRILL", "HOLE", 20.0, "HOME")
    assert (type(plain), type(quantity)) == (Number, Quantity)
    assert (quantity.number.value, quantity.unit.name, quantity.text) == (30.0, "MM", "30 (mm)")
    assert sub.moving is None
    assert call.moving is None
    assert print_module(result) == "SUB DRILL {AT} DEPTH (mm) T\nEND\nP1 CALL DRILL {HOLE} 20 30 (mm) HOME\n"


def test_let_and_if_hold_their_expression():
    let, condition, _ = parsed("LET a = 1\nif a = 1\nend").value.statements
    assert [value.name for value in let.waypoints[0].values] == ["A"]
    assert let.expression.value == 1.0
    assert (condition.waypoints, condition.expression.operator) == ((), "=")
    assert let.whole_span.end_column == 10
    assert condition.whole_span.end_column == 9


def test_comments_stay_where_they_are():
    text = "if a ! why\n! first\np1 stop! done\n! last\nelse\n! none\nend ! of it\n! after\n"
    assert printed(text) == (
        "IF A       ! why\n"
        "  ! first\n"
        "  P1 STOP  ! done\n"
        "  ! last\n"
        "ELSE\n"
        "  ! none\n"
        "END        ! of it\n"
        "! after\n"
    )


def test_a_list_of_way_points_in_a_block():
    text = "repeat 4\np1 movej_spline 1 $( 2*a );  ! first\n\n 3 4 [ $t ]\nend"
    assert printed(text) == "REPEAT 4\n  P1 MOVEJ_SPLINE 1 $(2*A);  ! first\n  3 4 [$T]\nEND\n"


def test_lines_that_open_nothing_are_not_indented_to_the_left():
    assert printed("END\nELSE\nP1 STOP\nEND") == "END\nELSE\nP1 STOP\nEND\n"
