"""Tests of statements in blocks: each misplaced statement has one finding, and all others are still put into
blocks.
"""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st
from syntax.writing import module, parsed, statement

from yarclang.syntax.ast import Block, Statement
from yarclang.syntax.blocks import DEEPEST_BLOCK, arrange

_EXPECTED = re.compile(r"! error: (Y[0-9]{4}) ?(.*)")


def outline(nodes):
    """Return nodes as nested lists: a line as its number, and a block as its lines from head to END."""
    found = []
    for node in nodes:
        if isinstance(node, Statement):
            found.append(node.line)
            continue
        block = [node.head.line, outline(node.body)]
        if node.otherwise is not None:
            block += [node.otherwise_head and node.otherwise_head.line, outline(node.otherwise)]
        found.append([*block, node.end and node.end.line])
    return found


def arranged(text):
    return outline(arrange(parsed(text).value).value)


def test_blocks_hold_what_stands_between_them_and_their_end():
    text = """\
LET A = 1
SUB S {F} X
  P1 STOP
END
IF A = 1
  REPEAT I 4
    P2 STOP
  END
  P3 STOP
ELSE
  WHEN D ON
  ELSE
  END
END
P4 STOP
"""
    whole = [1, [2, [3], 4], [5, [[6, [7], 8], 9], 10, [[11, [], 12, [], 13]], 14], 15]
    assert arranged(text) == whole
    assert arrange(parsed(text).value).diagnostics == ()


def test_a_block_knows_its_statements():
    result = arrange(parsed("if A > 1\nP1 STOP\nelse\nend\n").value)
    (block,) = result.value
    assert isinstance(block, Block)
    assert (block.head.name.name, block.end.name.name, block.otherwise_head.name.name) == (
        "IF",
        "END",
        "ELSE",
    )
    assert (len(block.body), block.otherwise) == (1, ())


WRONG = {
    "no END": ("REPEAT 4   ! error: Y0113 has no END before the end of the file\nP1 STOP", [[1, [2], None]]),
    "no END of the inner one": (
        "REPEAT 4   ! error: Y0113 this REPEAT has no END\nIF A   \nP1 STOP\nEND",
        [[1, [[2, [3], 4]], None]],
    ),
    "no END before SUB": (
        "REPEAT 4   ! error: Y0113 before the SUB in line 3\nP1 STOP\nSUB S\nP2 STOP\nEND\nP3 STOP",
        [[1, [2], None], [3, [4], 5], 6],
    ),
    "no END before a declaration": (
        "SUB S   ! error: Y0113 before the INPUT in line 3\nP1 STOP\nINPUT D M1\nOUTPUT E M2\nSUB T\nEND",
        [[1, [2], None], 3, 4, [5, [], 6]],
    ),
    "no END before ELSE": (
        "IF A\nREPEAT 4   ! error: Y0113 before this ELSE in line 4\nP1 STOP\nELSE\nP2 STOP\nEND",
        [[1, [[2, [3], None]], 4, [5], 6]],
    ),
    "two without END": (
        "IF A   ! error: Y0113\nREPEAT 4   ! error: Y0113\nP1 STOP",
        [[1, [[2, [3], None]], None]],
    ),
    "END without a block": ("P1 STOP\nEND   ! error: Y0114 this END has no block to end\nP2 STOP", [1, 3]),
    "one END too many": ("REPEAT 4\nEND\nEND   ! error: Y0114\nP2 STOP", [[1, [], 2], 4]),
    "END too early, and then too few": (
        "END   ! error: Y0114\nREPEAT 4   ! error: Y0113 before the SUB in line 3\nSUB S\nEND",
        [[2, [], None], [3, [], 4]],
    ),
    "ELSE without a block": ("ELSE   ! error: Y0114 this ELSE is not in a block\nP2 STOP", [2]),
    "a second ELSE": (
        (
            "WHEN D ON\n"
            "P1 STOP\n"
            "ELSE\n"
            "P2 STOP\n"
            "ELSE   ! error: Y0115 the WHEN of line 1 already has an ELSE in line 3\n"
            "P3 STOP\n"
            "END"
        ),
        [[1, [2], 3, [4, 6], 7]],
    ),
    "ELSE in REPEAT": (
        "REPEAT 4\nP1 STOP\nELSE   ! error: Y0115 the REPEAT of line 1 is open here\nP2 STOP\nEND",
        [[1, [2, 4], 5]],
    ),
    "ELSE in SUB": ("SUB S\nELSE   ! error: Y0115 the SUB of line 1\nEND", [[1, [], 3]]),
    "ELSE in REPEAT in IF": (
        "IF A\nREPEAT 4\nELSE   ! error: Y0115 the REPEAT of line 2\nEND\nEND",
        [[1, [[2, [], 4]], 5]],
    ),
    "SUB in a block": (
        (
            "REPEAT 4\n"
            "SUB S   ! error: Y0116 SUB isn't allowed in a block: the REPEAT of line 1 is open here\n"
            "P1 STOP\n"
            "END\n"
            "END"
        ),
        [[1, [[2, [3], 4]], 5]],
    ),
    "declarations in a block": (
        "SUB S\n"
        + "".join(
            f"{line}   ! error: Y0116 {line.split()[0]} isn't allowed in a block\n"
            for line in (
                "DEFAULT {B}",
                "INPUT D M1",
                "OUTPUT D M1",
                "USE P",
                'CELL "c"',
                "ROBOT R",
                "START HOME",
            )
        )
        + "END",
        [[1, [2, 3, 4, 5, 6, 7, 8], 9]],
    ),
    "declarations that a block holds": (
        (
            "SUB S\n"
            "FRAME {F} 1 2 3 4 5 6 {B}\n"
            "FRAME_QUAT {F} 1 2 3 4 5 6 7 {B}\n"
            "JOINTS J 1 2 3 4 5 6\n"
            "LET A = 1\n"
            "END"
        ),
        [[1, [2, 3, 4, 5], 6]],
    ),
    "indices": (
        "\n".join(
            [
                "P1 REPEAT 4   ! error: Y0117 REPEAT is no command and has no index",
                "P2 LET A = 1   ! error: Y0117 LET",
                "P3 END   ! error: Y0117 END",
                "P4 FRAME {F} 1 2 3 4 5 6   ! error: Y0117 FRAME",
                "P5 STOP",
            ]
        ),
        [[1, [2], 3], 4, 5],
    ),
    "an index on ELSE": ("IF A\nP1 ELSE   ! error: Y0117 ELSE\nEND", [[1, [], 2, [], 3]]),
    "a head that can't be read": (
        "IF A ==   ! error: Y0111\nP1 STOP\nELSE\nP2 STOP\nEND\nP3 STOP",
        [6],
    ),
    "an END that can't be read": (
        "REPEAT 4\nP1 STOP\nEND 5   ! error: Y0101 END must be alone in its line\nP2 STOP",
        [[1, [2], None], 4],
    ),
    "an ELSE that can't be read": (
        "IF A\nP1 STOP\nELSE IF B   ! error: Y0101 ELSE must be alone in its line\nP2 STOP\nEND",
        [[1, [2], None, [4], 5]],
    ),
}


@pytest.mark.parametrize(("text", "expected"), WRONG.values(), ids=WRONG.keys())
def test_what_stands_wrong_is_one_finding_at_its_place(text, expected):
    read = parsed(text)
    result = arrange(read.value)
    found = [
        (one.span.line, one.code, one.message)
        for one in sorted([*read.diagnostics, *result.diagnostics], key=lambda one: one.span)
    ]
    wanted = [
        (number, *match.groups())
        for number, line in enumerate(text.split("\n"), 1)
        if (match := _EXPECTED.search(line))
    ]
    assert [entry[:2] for entry in found] == [entry[:2] for entry in wanted]
    assert all(part in message for (_, _, message), (_, _, part) in zip(found, wanted, strict=True))
    assert outline(result.value) == expected
    assert all(one.help for one in result.diagnostics)


def test_the_place_of_a_finding_is_the_word():
    (one,) = arrange(parsed("  END").value).diagnostics
    assert (one.span.line, one.span.column, one.span.end_column) == (1, 3, 6)
    (one,) = arrange(parsed("P1 LET A = 1").value).diagnostics
    assert (one.span.column, one.span.end_column) == (1, 3)


def depth(nodes):
    return max(
        (1 + max(depth(one.body), depth(one.otherwise or ())) for one in nodes if isinstance(one, Block)),
        default=0,
    )


@pytest.mark.parametrize("ends", [0, 1])
def test_blocks_go_so_deep(ends):
    def nested(levels):
        return "\n".join(["REPEAT 4"] * levels + ["P1 STOP"] + ["END"] * (levels * ends) + ["P2 STOP"])

    fine = arrange(parsed(nested(DEEPEST_BLOCK)).value)
    assert depth(fine.value) == DEEPEST_BLOCK
    assert len(fine.diagnostics) == (0 if ends else DEEPEST_BLOCK)
    deep = arrange(parsed(nested(20_000)).value)
    assert [one.span.line for one in deep.diagnostics if one.code == "Y0112"] == [DEEPEST_BLOCK + 1]
    assert depth(deep.value) == DEEPEST_BLOCK
    if ends:
        assert len(deep.diagnostics) == 1
        assert deep.value[-1].line == 40_002


@given(module())
def test_a_sound_file_is_arranged_without_a_finding(text):
    read = parsed(text)
    assert read.diagnostics == ()
    result = arrange(read.value)
    assert result.diagnostics == ()
    flat = re.findall(r"\d+", str(outline(result.value)))
    assert [int(line) for line in flat] == [one.line for one in read.value.statements]


words = st.sampled_from(
    ["SUB S", "REPEAT 4", "IF A", "WHEN D ON", "ELSE", "END", "END", "P1 STOP", "USE P", "LET A = 1"]
)
unread = st.sampled_from(["IF", "END 5", "ELSE 5", "SUB", "LET", "P1 MOVEJ [", "$"])


@given(st.lists(st.one_of(words, words, unread, statement), max_size=25))
def test_whatever_stands_in_a_file_is_arranged(lines):
    text = "\n".join(lines)
    result = arrange(parsed(text).value)
    found = [(one.span, one.code) for one in result.diagnostics]
    assert found == sorted(found)
    assert len(set(found)) == len(found)
    flat = [int(line) for line in re.findall(r"\d+", str(outline(result.value)))]
    assert flat == sorted(set(flat))


@given(st.lists(words, max_size=12), st.integers(0, 11))
def test_one_end_too_few_is_one_finding(lines, where):
    """A valid file in which one END is left out has exactly one finding."""
    sound = []
    open_blocks = 0
    for line in lines:
        if (
            line in {"ELSE", "USE P"}
            or (line == "END" and not open_blocks)
            or (line == "SUB S" and open_blocks)
        ):
            continue
        open_blocks += (line.split()[0] in {"SUB", "REPEAT", "IF", "WHEN"}) - (line == "END")
        sound.append(line)
    sound += ["END"] * open_blocks
    assert arrange(parsed("\n".join(sound)).value).diagnostics == ()
    ends = [number for number, line in enumerate(sound) if line == "END"]
    if ends:
        del sound[ends[where % len(ends)]]
        assert [one.code for one in arrange(parsed("\n".join(sound)).value).diagnostics] == ["Y0113"]
