"""Tests of ON CURTAIN OFF CALL AWAY: its arguments, the places from which the way out is proved, and its
text.
"""

import pytest
from programs import compiled
from semantics.test_searches import errors

from yarclang.certify.certifying import certify
from yarclang.identity import fingerprint, way_fingerprint
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse
from yarclang.syntax.print import print_module

INPUTS = "INPUT CURTAIN M11\nINPUT DOOR M12\nOUTPUT LAMP M1 OFF\n"
MOVES = "P0100 MOVEJ 0 0 0 0 30 0 [2] (deg,s)\nP0110 MOVEJ 30 0 0 0 30 0 [2] (deg,s)\n"
AWAY = "SUB AWAY\n  P0010 SET LAMP ON\n  P0020 MOVEJ HOME [3] (s)\nEND\n"
CALLS = "ON CURTAIN OFF CALL AWAY\n"


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("ON CURTAIN OFF CALL\n", "Y0401"),
        ("ON CURTAIN OFF CALL AWAY 3\n", "Y0401"),
        ("ON CURTAIN OFF CALL 3\n", "Y0401"),
        ("ON CURTAIN OFF HOLD AWAY\n", "Y0401"),
        ("ON CURTAIN CALL AWAY\n", "Y0401"),
        ("ON CURTAIN OFF CALL AWY\n", "Y0210"),
        ("ON CURTAIN OFF CALL LAMP\n", "Y0209"),
        ("ON LAMP OFF CALL AWAY\n", "Y0209"),
        (CALLS + CALLS, "Y0206"),
        ("SUB TO X (deg)\n  P0030 MOVEJ X 0 0 0 0 0 [2] (deg,s)\nEND\nON CURTAIN OFF CALL TO\n", "Y0411"),
        ("SUB STAY\n  P0030 SET LAMP ON\nEND\nON CURTAIN OFF CALL STAY\n", "Y0478"),
        ("SUB ENDS\n  P0030 MOVEJ HOME [3] (s)\n  P0040 STOP\nEND\nON CURTAIN OFF CALL ENDS\n", "Y0478"),
        (
            (
                "SUB WAITS\n"
                "  P0030 WAIT DOOR ON [3] (s)\n"
                "  P0040 MOVEJ HOME [3] (s)\n"
                "END\n"
                "ON CURTAIN OFF CALL WAITS\n"
            ),
            "Y0478",
        ),
        (
            "SUB FINDS\n  P0030 MOVEJ HOME [3] (s) UNTIL DOOR\nEND\nON CURTAIN OFF CALL FINDS\n",
            "Y0478",
        ),
        (
            (
                "SUB LOOKS\n"
                "  WHEN DOOR ON\n"
                "    P0030 MOVEJ HOME [3] (s)\n"
                "  END\n"
                "END\n"
                "ON CURTAIN OFF CALL LOOKS\n"
            ),
            "Y0478",
        ),
        ("SUB ROUND\n  P0030 CALL ROUND\nEND\nON CURTAIN OFF CALL ROUND\n", "Y0212"),
        ("SUB FAR\n  P0030 DMOVEJ 200 0 0 0 0 0 [9] (deg,s)\nEND\nON CURTAIN OFF CALL FAR\n", "Y0479"),
    ],
)
def test_what_is_refused(lines, code):
    assert code in errors(lines + MOVES, INPUTS + AWAY)


def test_what_is_taken():
    assert errors(CALLS + MOVES, INPUTS + AWAY) == []
    assert errors(CALLS + "ON DOOR ON CALL AWAY\nON DOOR OFF HOLD\n" + MOVES, INPUTS + AWAY) == []
    text = INPUTS + AWAY + CALLS + MOVES
    module = parse(SourceFile("away.yarc", text)).value
    assert CALLS in print_module(module)
    program, _ = compiled(text)
    assert [one.origin.label for one in program.program.ways_out[0].steps] == ["AWAY>P0010", "AWAY>P0020"]
    assert [one.origin.label for one in program.program.steps] == ["P0100", "P0110"]
    (watch,) = program.program.watches
    assert watch.way == way_fingerprint(program.program.ways_out[0])
    assert f"; watch M11=0 CURTAIN then AWAY {watch.way}\n" in program.text


def found(moves, way, calls=CALLS):
    text = f"{INPUTS}SUB AWAY\n{way}END\n{calls}{moves}"
    module = parse(SourceFile("away.yarc", text)).value
    made = compile_module(module, Request(load_robot("INDUSTRIAL6").value))
    return [one for one in made.diagnostics if one.is_error]


def test_the_way_is_proved_from_each_place_and_it_is_said_from_where_it_fails():
    way = "  P0010 DMOVEJ 100 0 0 0 0 0 [5] (deg,s)\n"
    moves = "".join(
        f"P0{100 + number} MOVEJ {30 * number} 0 0 0 30 0 [3] (deg,s)\n" for number in range(1, 6)
    )
    assert found(moves, way.replace("100", "10")) == []
    (only,) = found(moves, way)
    assert only.code == "Y0479"
    assert only.span.line == 7
    assert (
        "AWAY can't be executed from the start of P0104 MOVEJ, and from 1 more of 5 places: " in only.message
    )
    blended = moves.replace("(deg,s)\nP0105", "(deg,s) BLEND 5\nP0105")
    (only,) = found(blended, way)  # within a blend the robot never stands, so only one place remains
    assert "AWAY can't be executed from the start of P0104 MOVEJ: " in only.message


def test_from_where_a_search_has_ended_the_inputs_only_hold():
    way = "  P0010 DMOVEJ 100 0 0 0 0 0 [5] (deg,s)\n"
    moves = (
        "P0100 MOVEJ 30 0 0 0 30 0 [3] (deg,s)\nP0110 MOVEJ 120 0 0 0 30 0 [5] (deg,s) UNTIL DOOR\n"
        "P0120 MOVEJ 40 0 0 0 30 0 [5] (deg,s)\n"
    )
    assert found(moves, way) == []


def test_the_hash_of_a_program_knows_its_ways_out():
    texts = [
        INPUTS + AWAY + MOVES,
        INPUTS + AWAY + "ON CURTAIN OFF HOLD\n" + MOVES,
        INPUTS + AWAY + CALLS + MOVES,
        INPUTS + AWAY.replace("[3]", "[4]") + CALLS + MOVES,
        INPUTS + AWAY.replace("LAMP ON", "LAMP OFF") + CALLS + MOVES,
    ]
    assert len({fingerprint(compiled(text)[0].program) for text in texts}) == len(texts)


@pytest.mark.parametrize(
    "told",
    [
        "",
        " then AWAY",
        " then",
        " then AWAY 0123456789abcdef",
        " then HOME @",
        " then away @",
        " leaves AWAY @",
        "  then AWAY @",
        " then AWAY @ ",
        " then AWAY @0",
        " then @",
    ],
)
def test_the_certificate_refuses_a_text_that_leads_elsewhere(told, industrial6):
    program, _ = compiled(INPUTS + AWAY + CALLS + MOVES)
    line, way = "; watch M11=0 CURTAIN", program.program.watches[0].way
    assert program.text.count(f"{line} then AWAY {way}\n") == 1
    changed = program.text.replace(f"{line} then AWAY {way}\n", f"{line}{told.replace('@', way)}\n")
    judged = certify(changed, program.program, industrial6, industrial6.tolerance)
    assert any(one.is_error for one in judged.diagnostics)


def test_a_text_that_leads_away_without_being_asked_to_is_refused(industrial6):
    program, _ = compiled(INPUTS + AWAY + "ON CURTAIN OFF HOLD\n" + MOVES)
    changed = program.text.replace(
        "; watch M11=0 CURTAIN\n", "; watch M11=0 CURTAIN then AWAY 0123456789abcdef\n"
    )
    assert changed != program.text
    judged = certify(changed, program.program, industrial6, industrial6.tolerance)
    assert any("and leaves by AWAY" in one.message for one in judged.diagnostics)
