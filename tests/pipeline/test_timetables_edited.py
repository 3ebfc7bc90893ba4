"""Tests of timetables in an edited program: remembered results equal newly computed ones."""

from programs import compiled, source

from yarclang.memory import Recent
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.syntax.parse import parse

HEAD = "DEFAULT (deg,s)\n"
LINES = (
    "P0010 MOVEJ 5 0 0 0 10 0 [2]",
    "P0020 MOVEJ_TIMED 8 0 0 0 15 0 [1]; 10 0 0 0 20 0 [2]",
    "P0030 MOVEJ_TIMED 8 0 0 0 15 0 [1] VEL -3 0 0 0 -6 0; 5 0 0 0 10 0 [2] VEL 0 0 0 0 0 0",
)
EDITS = (
    (1, "P0020 MOVEJ_TIMED 8 0 0 0 15 0 [1.1]; 10 0 0 0 20 0 [2]"),
    (1, "P0020 MOVEJ_TIMED 8 0 0 0 15 0 [1]; 10 0 0 0 20 0 [2] STRETCH 1.5"),
    (1, "P0020 MOVEJ_TIMED 8 0 0 0 15 0 [1]; 10 0 0 0 20 0 [2] TOL 0.02"),
    (1, "P0020 MOVEJ_TIMED 8 0 0 0 15 0 [0.2]; 10 0 0 0 20 0 [0.3]"),
    (2, "P0030 MOVEJ_TIMED 8 0 0 0 15 0 [1] VEL -4 0 0 0 -6 0; 5 0 0 0 10 0 [2] VEL 0 0 0 0 0 0"),
    (
        2,
        (
            "P0030 MOVEJ_TIMED 8 0 0 0 15 0 [1] VEL -3 0 0 0 -6 0 ACC 1 0 0 0 0 0; 5 0 0 0 10 0 [2] VEL 0 "
            "0 0 0 0 0 ACC 0 0 0 0 0 0"
        ),
    ),
    (0, "! a line more\nP0010 MOVEJ 5 0 0 0 10 0 [2]"),
    (0, "P0010 MOVEJ 5.5 0 0 0 10 0 [2]"),
)


def made(text, memory):
    result = compile_module(
        parse(source(text)).value, Request(load_robot("INDUSTRIAL6").value, memory=memory)
    )
    return (result.value.text if result.value else None), [
        (one.code, one.message, one.span, one.help, one.fix and [edit.span for edit in one.fix.edits])
        for one in result.diagnostics
    ]


def test_each_edit_gives_what_a_first_look_gives():
    memory = Recent(100_000_000)
    seen = set()
    for number, line in EDITS:
        for text in (LINES, [*LINES[:number], line, *LINES[number + 1 :]]):
            program = HEAD + "\n".join(text) + "\n"
            kept = made(program, memory)
            value, found = compiled(program)
            assert kept[0] == (value.text if value else None)
            assert [one[:4] for one in kept[1]] == [
                (one.code, one.message, one.span, one.help) for one in found
            ]
            seen.add(kept[0])
    assert len(seen) == len(EDITS) + 1
