"""Lines and their answers: variables, addresses, errors, status words and buffers."""

import pytest
from simulator.machines import bare, error, program, robot_machine, rotary, say

from yarclang.simulator.machine import Machine
from yarclang.simulator.network.reply import Reply, framed


@pytest.mark.parametrize(
    ("i3", "i6", "data", "none", "refused"),
    [
        (0, 1, b"5\r", b"", b"\x07ERR003\r"),
        (1, 1, b"\n5\r\n", b"\n", b"\x07\nERR003\r"),
        (2, 1, b"5\r\x06", b"\x06", b"\x07ERR003\r"),
        (3, 1, b"\n5\r\x06", b"\x06", b"\x07\nERR003\r"),
        (2, 0, b"5\r\x06", b"\x06", b"\x07"),
        (2, 2, b"5\r\x06", b"\x06", b"\x07"),
        (2, 3, b"5\r\x06", b"\x06", b"\x07\rERR003\r"),
    ],
)
def test_framing(i3, i6, data, none, refused):
    machine = Machine()
    say(machine, f"I3={i3} I6={i6} P1=5")
    assert machine.respond("p1") == data
    assert machine.respond("P2=1") == none
    assert machine.respond("FOO") == refused
    assert framed(Reply(("5",), 3), i3, i6).endswith(refused)


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("P1=5 P1", ["5"]),
        ("p1=2.5p1p1", ["2.5", "2.5"]),
        ("P1..3=7 P1..4", ["7", "7", "7", "0"]),
        ("P1=2+3*4 P1", ["14"]),
        ("P1=(2+3)*4 P1", ["20"]),
        ("P1=7%4 P2=-7%4 P1P2", ["3", "1"]),
        ("P1=7&3|8 P1", ["11"]),
        ("P1=5^1 P1", ["4"]),
        ("P1=$1F P1", ["31"]),
        ("P1=SIN(90) P1", ["1"]),
        ("I15=1 P1=COS(0) P1", ["1"]),
        ("P1=ATAN2(1) P1", ["90"]),
        ("P1=SQRT(16)+ABS(-2)+INT(-1.5)+EXP(0)+LN(1) P1", ["5"]),
        ("P1=-3--2 P1", ["-1"]),
        ("P5=9 P1=5 P(P1)", ["9"]),
        ("P1=1/0 Q1=SQRT(-1) Q1", ["0"]),
        ("Q1=3 Q1 &2 Q1 &1 Q1", ["3", "0", "3"]),
        ("M1->", ["*"]),
        ("M1=3 M1", ["3"]),
        ("M1->Y:$078402,8,1 M1-> M1=1 M1", ["Y:$078402,8", "1"]),
        ("M1->X:$10,0,8,S M2->X:$10,0,8 M1=255 M1M2", ["-1", "255"]),
        ("M1->D:$10 M1=-5 M1", ["-5"]),
        ("M161->D:$88 M161->", ["D:$000088"]),
        ("I10", ["3713707"]),
        ("I20", ["$78400"]),
        ("I9=0 I20", ["492544"]),
        ("I9=3 I10", ["I10=3713707"]),
        ("I116=99 I116=* I116", ["32"]),
        ("#", ["1"]),
        ("#3#&4&", ["3", "4"]),
        ("#1->", ["0"]),
        ("#1->100X #1->", ["100X"]),
        ("#3->29308.7083Y+29308.7083Z-5 #3->", ["29308.7083Y+29308.7083Z-5"]),
        ("#1->X #1->0 #1->", ["0"]),
        ("ver", ["1.945"]),
        ("CID", ["602413"]),
        ("VID", ["1"]),
        ("TIME", ["00:00:00"]),
        ("%", ["100"]),
        ("%50 %", ["100"]),
        ("PR", ["0"]),
        ("???", ["000000000000"]),
        ("#1P#2P#1V#1F", ["0", "0", "0", "0"]),
        ("i65???&1??%", ["0", "000000000000", "A80008000000000000", "100"]),
        ("; only a comment", []),
        ("P1=1 // and another", []),
        ("", []),
        ("I6=1 I3=2 VER", ["1.945"]),
    ],
)
def test_answers(line, answer):
    assert list(say(Machine(), line)) == answer


@pytest.mark.parametrize(
    ("line", "number"),
    [
        ("FOO", 3),
        ("P9000", 3),
        ("P1=", 3),
        ("P1=(2", 3),
        ("#40", 3),
        ("&0", 3),
        ("#1->X+A", 3),
        ("#1->X+U", 3),
        ("M1->Z:$10", 3),
        ("OPEN PROG 0", 3),
        ("OPEN PLC 32", 3),
        ("OPEN ROT", 3),
        ("LIST PROG 7", 3),
        ("P1=\u00e4", 4),
        ("P1=\x01", 4),
        ("X10", 5),
        ("X10Y20.5", 5),
        ("A10", 5),
        ("LINEAR", 5),
        ("SPLINE1", 5),
        ("TM50", 5),
        ("DWELL10", 5),
        ("CLEAR", 5),
        ("DEFINE ROT 999999999", 6),
        ("R", 14),
        ("P1=1" + " " * 300, 3),
    ],
)
def test_errors(line, number):
    assert error(Machine(), line) == number


def test_an_error_ends_the_line():
    machine = Machine()
    reply = machine.command("P1=1 P1 FOO P1=2")
    assert reply == Reply(("1",), 3)
    assert say(machine, "P1") == ("1",)


def test_001_while_a_program_runs():
    machine = bare()
    program(machine, "DWELL1000")
    say(machine, "B1R")
    for line in (
        "OPEN PROG 2",
        "#1J+",
        "#1K",
        "DELETE ROT",
        "DEFINE ROT 10",
        "B1",
        "#1->5X",
        "UNDEFINE",
        "PMATCH",
    ):
        assert error(machine, line) == 1, line
    machine.advance(2)
    assert error(machine, "#1J/") is None


def test_006_rotary_without_room():
    machine = bare()
    say(machine, "DELETE ROT", "DEFINE ROT 10", "B0", "OPEN ROT")
    for _ in range(5):
        say(machine, "X1Y1")
    assert error(machine, "X1Y1") == 6
    assert say(machine, "PR") == ("5",)
    say(machine, "CLEAR", "X1Y1")


def test_007_one_buffer_at_a_time():
    machine = bare()
    say(machine, "OPEN PROG 1")
    assert error(machine, "OPEN PROG 2") == 7
    assert machine.command("OPEN ROT", port=1).error == 7
    assert machine.command("CLOSE", port=1).error is None
    assert machine.command("OPEN ROT", port=1).error == 7
    assert machine.command("CLOSE ALL", port=1).error is None
    assert machine.command("OPEN ROT", port=1).error is None


def test_only_the_port_that_opened_writes():
    machine = bare()
    say(machine, "OPEN ROT")
    assert machine.command("X1", port=1).error == 5
    assert machine.command("PR", port=1).items == ("0",)


def test_009_structure():
    machine = bare()
    say(machine, "OPEN PROG 1 CLEAR")
    for line in ("ENDIF", "ENDWHILE", "ELSE"):
        assert error(machine, line) == 9, line
    say(machine, "IF(P1=1)")
    assert error(machine, "ENDWHILE") == 9
    assert error(machine, "CLOSE") == 9


def test_010_to_016_of_run():
    machine = Machine()
    assert error(machine, "R") == 14
    say(machine, "#1->X #2->Y")
    assert error(machine, "R") == 13
    say(machine, "I200=1")
    assert error(machine, "R") == 12
    say(machine, "#1J/#2J/")
    machine.set_limit_switch(1, 1, True)
    machine.set_limit_switch(1, -1, True)
    assert error(machine, "R") == 10
    machine.set_limit_switch(1, 1, False)
    machine.set_limit_switch(1, -1, False)
    say(machine, "#2J+")
    assert error(machine, "R") == 11
    say(machine, "J/")
    machine.advance(1)
    assert error(machine, "R") == 15
    assert error(machine, "B7R") == 15
    say(machine, "OPEN PROG 7", "X1")
    assert error(machine, "R") == 15
    say(machine, "CLOSE", "B7R")
    machine.advance(5)
    say(machine, "OPEN PROG 7 CLEAR", "WHILE(P1=0)")
    assert error(machine, "CLOSE") == 9
    assert error(machine, "B7R") == 16


def test_b0_in_an_open_buffer_is_a_move():
    machine = bare("1000X", "1000B")
    say(machine, "#1J=500", "#2J=500")
    machine.advance(2)
    say(machine, "B0", "OPEN ROT", "RAPID", "B0", "CLOSE", "R")
    machine.advance(5)
    assert machine.positions() == pytest.approx([500, 0])


def test_what_is_stored_while_a_buffer_is_open():
    machine = bare()
    say(machine, "OPEN PROG 1 CLEAR", "P1=5", "I100", "SPLINE1TM50X10")
    assert say(machine, "PR") == ("0",)
    assert say(machine, "P1") == ("0",)
    assert say(machine, "?")[0][:2] == "88"
    say(machine, "CLOSE")
    assert say(machine, "LIST PROG 1") == ("P1=5", "I100", "SPLINE1TM50X10", "RETURN")
    assert say(machine, "P1") == ("0",)


@pytest.mark.parametrize(
    "line",
    ["IF(P1=1)", "WHILE(P1=1)", "GOTO5", "GOSUB5", "N10", "CALL5", "ENDIF", "ENDWHILE", "ELSE", "RETURN"],
)
def test_no_branches_in_a_rotary(line):
    machine = bare()
    say(machine, "OPEN ROT")
    assert error(machine, line) in (3, 9)
    say(machine, "STOP", "CLOSE")


def test_rotaries_are_defined_from_the_highest_system_down():
    machine = Machine()
    say(machine, "&3DEFINE ROT 100", "&2DEFINE ROT 100")
    assert error(machine, "&4DEFINE ROT 100") == 3
    say(machine, "GATHER", "DEFINE GATHER")
    assert error(machine, "&1DEFINE ROT 100") == 3
    say(machine, "END GATHER", "DELETE GATHER", "&1DEFINE ROT 100")


def test_an_address_inside_the_rotary_switches_the_target():
    machine = Machine()
    say(
        machine,
        "&2#1->X",
        "DEFINE ROT 100",
        "&1#2->X",
        "DEFINE ROT 100",
        "OPEN ROT",
        "&2X10",
        "X20",
        "&1X5",
        "CLOSE",
    )
    assert say(machine, "&1PR&2PR") == ("1", "2")


def test_full_bit_and_its_marks():
    machine = bare("1000X")
    say(machine, "I16=3 I17=6", "M1->Y:$203F,16,1", "B0", "OPEN ROT", "SPLINE1 TM100")
    for number in range(4):
        say(machine, f"X{number}")
    assert machine.command("M1", port=1).items == ("0",)
    say(machine, "X5", "X6")
    assert machine.command("M1", port=1).items == ("1",)
    assert int(say(machine, "??")[0][6:12], 16) >> 16 & 1
    say(machine, "CLOSE", "R")
    machine.advance(0.25)
    assert say(machine, "PRM1") == ("2", "0")


def test_status_of_an_idle_motor():
    machine = bare()
    say(machine, "#1HMZ")
    assert say(machine, "#1?") == ("882000078401",)
    say(machine, "#1K")
    assert say(machine, "#1?") == ("840000078400",)


def test_status_in_motion():
    machine = bare()
    program(machine, "SPLINE1 TM100", *["X9Y9"] * 9)
    say(machine, "B1R")
    machine.advance(0.2)
    first = int(say(machine, "#1?")[0][:6], 16)
    assert first >> 17 & 1
    assert not first >> 13 & 1
    words = say(machine, "??")[0]
    assert int(words[:6], 16) & 0b10101 == 0b10101
    second = int(words[6:12], 16)
    assert not second >> 17 & 1
    assert second & 0b10011 == 0b10001
    say(machine, "H")
    machine.advance(2)
    assert int(say(machine, "??")[0][:6], 16) & 1


def test_control_characters():
    machine = bare()
    say(machine, "#1J=100#2J=50")
    machine.advance(2)

    def control(letter):
        return machine.control(ord(letter) - 64).items

    assert control("P")[0].split() == ["100", "50", "0", "0", "0", "0", "0", "0"]
    assert control("V")[0].split() == ["0"] * 8
    assert control("F")[0].split() == ["0"] * 8
    assert control("B")[0].split()[0] == say(machine, "#1?")[0]
    assert control("C")[0].split()[0] == say(machine, "&1??")[0]
    say(machine, "#1J+")
    machine.advance(1)
    assert control("A") == ()
    machine.advance(5)
    assert not machine.motors[1].jogging
    assert control("K") == ()
    assert not machine.motors[1].closed
    assert control("A") == ()
    assert machine.motors[1].closed
    for letter in map(chr, range(65, 91)):
        machine.control(ord(letter) - 64)


def test_limits_stop_the_motors():
    machine = bare("X", "Y")
    say(machine, "I113=1000 I114=-1000 I115=0.1 I122=10", "#1J+")
    machine.advance(5)
    assert 1000 < machine.positions()[0] < 1600
    words = say(machine, "#1?")[0]
    assert int(words[:6], 16) >> 21 & 1
    assert int(words[6:], 16) >> 11 & 1
    say(machine, "J+")
    place = machine.positions()[0]
    machine.advance(1)
    assert machine.positions()[0] == pytest.approx(place, abs=5)
    say(machine, "J=0")
    machine.advance(2)
    assert machine.positions()[0] == 0
    program(machine, "SPLINE1 TM50", *[f"X{100 * i}Y{100 * i}" for i in range(30)])
    say(machine, "B1R")
    machine.advance(5)
    assert 1000 < machine.positions()[0] < 1600
    assert not machine.systems[1].busy
    assert machine.positions()[1] < 2500


def test_faults():
    machine = bare("X", "Y")
    program(machine, "SPLINE1 TM50", *[f"X{100 * i}" for i in range(300)])
    say(machine, "B1R")
    machine.advance(1)
    machine.fault_amplifier(1)
    words = say(machine, "#1?")[0]
    assert int(words[6:], 16) >> 3 & 1
    assert int(words[:6], 16) >> 18 & 1
    assert int(say(machine, "??")[0][6:12], 16) >> 20 & 1
    assert not machine.systems[1].busy
    assert error(machine, "R") == 12
    assert error(machine, "#1J/") == 12
    machine.clear_fault(1)
    say(machine, "#1J/#2J/", "R")
    machine.advance(1)
    machine.disturb(1, 1500)
    assert int(say(machine, "#1?")[0][6:], 16) >> 1 & 1
    assert machine.systems[1].busy
    machine.disturb(1, 2500)
    assert int(say(machine, "#1?")[0][6:], 16) >> 2 & 1
    assert not machine.systems[1].busy


def test_following_error():
    machine = bare("X")
    say(machine, "I122=10 #1J+")
    machine.advance(1)
    assert say(machine, "F") == ("5",)
    assert float(say(machine, "V")[0]) == pytest.approx(10 * 0.44271, rel=1e-3)
    say(machine, "I119=1000 I122=5000 J+")
    machine.advance(1)
    assert int(say(machine, "#1?")[0][6:], 16) >> 2 & 1


def test_save_and_resets():
    _, machine = robot_machine("INDUSTRIAL6")
    say(machine, "P5=3")
    machine.advance(1)
    say(machine, "$$$")
    assert say(machine, "I115", "#3->") == ("29308.7083Y+29308.7083Z",)
    assert say(machine, "LIST PLC 0")[0].startswith("P1=M162")
    assert say(machine, "P1P5") == ("0", "0")
    assert error(machine, "&1R") == 12
    say(machine, "$$$***")
    assert say(machine, "#3->") == ("0",)
    assert say(machine, "I115") == ("0.25",)
    say(machine, "$$$")
    assert say(machine, "I115") == ("6.1279",)


def test_commissioned():
    _, machine = robot_machine("INDUSTRIAL6")
    assert say(machine, "#1?") == ("882000078401",)
    assert say(machine, "I5") == ("3",)
    assert say(machine, "P1..6") == ("0",) * 6


def test_a_port_has_its_own_addresses():
    machine = bare()
    say(machine, "#2&3")
    assert machine.command("#&", port=1).items == ("1", "1")
    assert say(machine, "#&") == ("2", "3")
    machine.command("OPEN PROG 1", port=1)
    assert error(machine, "OPEN PROG 1") is not None


def test_rotary_of_listing_3():
    """The lines are in the order of the paper's driver."""
    machine = bare()
    rotary(machine, "CLEAR")
    for line in (
        "CLOSE ALL",
        "END GATHER",
        "DELETE GATHER",
        "DELETE ROT",
        "#1J/#2J/",
        "&1DEFINE ROT 480",
        "B0",
    ):
        say(machine, line)
    say(machine, "OPEN ROT", "CLEAR", "SPLINE1 TM 50", "CLOSE", "R")
    say(machine, "OPEN ROT", "PR", "X1.000000Y2.000000", "CLOSE")
    machine.advance(1)
    assert machine.positions() == pytest.approx([1000, 2000])
