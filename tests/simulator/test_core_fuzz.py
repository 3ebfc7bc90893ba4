"""The machine answers anything that is sent, without an exception or a hang, and with bounded memory."""

from floors import exercises
from hypothesis import example, given, settings
from hypothesis import strategies as st

from yarclang.simulator.machine import Machine
from yarclang.simulator.network.reply import Reply

NUMBERS = st.sampled_from(
    ["0", "1", "2", "5", "50", "100", "-3", "8191", "1.5", "$1F", ".5", "99999", "16", "32"]
)
WORDS = st.sampled_from(
    """# & #1 #2 &1 &2 -> #1->X #2->100Y+100Z #3->50Z-5 #1->0 #1->I UNDEFINE I P Q M I100= I200=1 P1= M1-> M1->Y:$78400,8
    X:$B0,18 D:$88 * = == ( ) + - / % | ^ & SIN( SQRT( ABS( 1 10 0.5 $7 OPEN PROG OPEN PROG1 OPEN PLC2 OPEN ROT CLOSE CLOSE ALL CLEAR
    CLEAR ALL DEFINE ROT DEFINE ROT 50 DELETE ROT DELETE GATHER LIST PROG1 LIST PLC2 LIST PC LIST ROT PR PC PE PQ PMATCH R S H Q A
    K \\ / % %50 %0 %200 J/ J+ J- J=100 J^5 J: J=* HM HMZ O10 ? ?? ??? P V F VER TYPE CID SAVE $$$ $$$*** B0 B1 B1R
    X10 Y20 Z-3 A5 B5 C1 U1 X(P1) X1:5 X1^-2 SPLINE1 SPLINE2 LINEAR RAPID CIRCLE1 PVT50 TM50 TM1 TM0 TM-5 TA10 TS5 F10 F0 ABS INC INC(X)
    DWELL10 DWELL0 DELAY5 STOP RETURN N10 GOTO10 GOSUB10 CALL1 IF(P1=0) IF(M1=0)P1=1 ELSE ENDIF WHILE(P1<5) WHILE(1=1)WAIT
    ENDWHILE P1=P1+1 P(P1)=5 M1==1 M1|=2 CMD"R" CMD"#1J+" CMD"^A" SEND"x" DISPLAY"x" ENABLE PLC2 DISABLE PLC2 ENABLE PLC 0..31 OPEN PLC0
    I5=3 I8=0 I10=1 I10=0 I16=0 I17=0 I15=1 I42=1 I5113=10 I5194=0 I5195=0 I113=5 I114=-5 I115=0 I111=16 I119=0 I120=0 I121=0 I122=0
    I122=1000 I124=$200000 HOME1 HOMEZ1 PSET X5 G1 M3 T2 S100 NORMAL K-1 CC1 READ(A) ADDRESS&1#2 ; // "
    I108=0 I5190=0 RX$B0 WY$78400,5""".replace("\n", " ").split(" ")  # noqa: E501
)
FRAGMENTS = st.lists(st.one_of(WORDS, WORDS, NUMBERS), min_size=1, max_size=6).flatmap(
    lambda parts: st.sampled_from(["", " "]).map(lambda glue: glue.join(parts))
)
LEGAL = st.sampled_from(
    [
        "I100=1I200=1", "#1->1000X", "#2->1000X+1000Y", "#1J/#2J/", "OPEN PROG 1 CLEAR", "OPEN PLC 2 CLEAR",
            "OPEN ROT",
        "CLOSE", "CLOSE ALL", "SPLINE1 TM50", "LINEAR TA20 TS5 TM30", "RAPID", "PVT20", "X1Y1", "X2Y-1",
            "X1:5Y2:1", "INC", "ABS",
        "DWELL5", "DELAY5", "WHILE(P1<5)", "ENDWHILE", "IF(P1!=3)", "ELSE", "ENDIF", "P1=P1+1", "M1==1",
            "&1B1R", "&1B0R", "R", "S",
        "H", "Q", "A", "/", "%50", "%100", "%0", "DEFINE ROT 100", "DELETE ROT", "CLEAR", "I5=3",
            "ENABLE PLC 0..31", "#1J+", "#1J-",
        "#1J=5000", "#2J^100", "#1HM", "#1K", "$$$", "SAVE", "I113=3000 I114=-3000", "STOP", 'CMD"&1R"',
            'CMD"#2J+"', "OPEN PLC 0 CLEAR",
    ]
)  # fmt: skip


def survives(machine, line):
    reply = machine.command(line)
    assert isinstance(reply, Reply)
    assert reply.error is None or 1 <= reply.error <= 22
    assert all(isinstance(item, str) and item.isascii() for item in reply.items)
    assert isinstance(machine.respond("?"), bytes)
    return reply


@settings(max_examples=300)
@given(st.lists(st.text(max_size=40), max_size=5))
@example(["P1=" + "(" * 250])
@example(["P(" * 100])
@example(["P1=1" + "+1" * 120])
@example(["IF(" * 80])
def test_any_text(lines):
    machine = Machine()
    for line in lines:
        survives(machine, line)
    machine.advance(0.05)


@exercises(accepted=0.02)
@settings(max_examples=400)
@given(st.lists(FRAGMENTS, max_size=20), st.lists(st.integers(0, 40), max_size=20))
def test_any_words(tally, lines, characters):
    machine = Machine()
    for number, line in enumerate(lines):
        tally.count("accepted", survives(machine, line).error is None)
        if number < len(characters):
            machine.control(characters[number])
        machine.advance(0.02)
    machine.advance(0.2)
    survives(machine, "??")


@exercises(accepted=0.2, moved=0.05)
@settings(max_examples=300)
@given(st.lists(st.tuples(LEGAL, st.floats(0.0, 0.3)), max_size=60))
def test_any_order_of_legal_lines(tally, lines):
    machine = Machine()
    for line in ("I100=1I200=1", "#1->1000X", "#2->1000X+1000Y", "#1J/#2J/", "DEFINE ROT 100"):
        machine.command(line)
    moved = False
    for line, seconds in lines:
        tally.count("accepted", survives(machine, line).error is None)
        machine.advance(seconds)
        for motor in (1, 2):
            position, velocity = machine.motors[motor].place(machine.now)
            assert abs(position) < 1e12
            assert abs(velocity) < 1e12
            moved |= velocity != 0.0
    tally.count("moved", moved)
    survives(machine, "#1?&1??")


def test_memory_is_bounded():
    machine = Machine()
    machine.command("OPEN PROG 1")
    for number in range(20000):
        machine.command(f"P{number % 8192}={number}")
    machine.command("CLOSE")
    for number in range(3000):
        machine.command(f'&1DEFINE ROT 100 P{number % 8192}=1 SEND"x"')
        machine.say("x" * 10)
    assert len(machine.messages()) <= 1000
