"""Tests of registers, conditions and CASE branches in a text: the judge's own reader reads them, and forged
ones are refused.
"""

import random

import pytest
from programs import compiled

from tests.floors import exercises
from yarclang.backend_pmac.deciding import canonical
from yarclang.certify.certifying import certify, certify_text
from yarclang.certify.read.deciding import read_assignment, read_condition, read_value
from yarclang.decisions import (
    ARITHMETIC,
    COMPARISONS,
    CONNECTIVES,
    Before,
    Between,
    Constant,
    InputValue,
    RegisterValue,
    evaluated,
    in_words,
)
from yarclang.runtime.signals import state_text

SOURCE = """REGISTER N 0..5 2
REGISTER FLAG 0..1
INPUT JOB M70
INPUT EMPTY M71
P10 SET N = N + 1
WHEN N > 3 AND NOT EMPTY = ON
  P20 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
  P30 MOVEJ HOME [1] (s)
END
CASE JOB
OF 1
  P40 SET FLAG = 1
OF 2..4
  P50 MOVEJ -5 0 0 0 0 0 [1] (deg,s)
  P60 MOVEJ HOME [1] (s)
ELSE
  P70 WAIT [0.5] (s)
END
"""


@pytest.fixture(scope="module")
def made():
    found, _ = compiled(SOURCE, "INDUSTRIAL6")
    return found


def judged(made, text):
    return certify(text, made.program, made.plan.robot, made.plan.robot.tolerance)


def test_the_text_is_the_programs(made):
    assert made is not None
    assert "; register N 0 5 2\n; register FLAG 0 1 0\n" in made.text
    assert " when " in made.text
    assert "again:(M70>=2)&(M70<=4)" in made.text
    content = made.certificate.text
    assert [one.name for one in content.registers] == ["N", "FLAG"]


FORGED = [
    ("; register N 0 5 2", "; register N 0 6 2"),
    ("; register N 0 5 2", "; register N 0 5 3"),
    ("; register N 0 5 2", "; register N 0 5 6"),
    ("; register N 0 5 2", "; register N -1 5 2"),
    ("; register N 0 5 2", "; register N 0 5 2 kept"),
    ("; register N 0 5 2", "; register N 0 5 2  kept"),
    ("; register N 0 5 2", "; register N 0 5 2 outside"),
    ("; register N 0 5 2", "; register N 0 5 2 kept outside"),
    ("; register N 0 5 2\n", ""),
    ("; register FLAG 0 1 0\n", ""),
    ("; register FLAG 0 1 0\n", "; register FLAG 0 1 0\n; register FLAG 0 1 0\n"),
    ("; register FLAG 0 1 0\n", "; register FLAG 0 1 0\n; register MORE 0 1 0\n"),
    ("$N:=$N+1", "$N:=$N+2"),
    ("$N:=$N+1", "$N:=$N-1"),
    ("$N:=$N+1", "$FLAG:=$N+1"),
    ("$N:=$N+1", "$N:=$FLAG+1"),
    ("$N:=$N+1", "$N:=($N+1)"),
    ("$N:=$N+1", "$N:=$N>1"),
    ("$N:=$N+1", "$M:=$N+1"),
    ("$N:=$N+1", "-"),
    ("($N>3)&(!(M71=1))", "($N>=3)&(!(M71=1))"),
    ("($N>3)&(!(M71=1))", "($N>3)|(!(M71=1))"),
    ("($N>3)&(!(M71=1))", "($N>3)&(M71=1)"),
    ("($N>3)&(!(M71=1))", "($N>3)&(!(M72=1))"),
    ("($N>3)&(!(M71=1))", "(!(M71=1))&($N>3)"),
    ("($N>3)&(!(M71=1))", "($N>3)&!(M71=1)"),
    ("($N>3)&(!(M71=1))", "(($N>3)&(!(M71=1)))"),
    ("($N>3)&(!(M71=1))", "$N+3"),
    ("M70=1 - JOB", "M70=2 - JOB"),
    ("M70=1 - JOB", "M71=1 - JOB"),
    ("M70=1 - JOB", "M70=1 - EMPTY"),
    ("again:(M70>=2)&(M70<=4)", "(M70>=2)&(M70<=4)"),
    ("again:(M70>=2)&(M70<=4)", "again:(M70>=2)&(M70<=5)"),
    ("again:(M70>=2)&(M70<=4)", "again:(M71>=2)&(M71<=4)"),
    ("M70=1 - JOB", "again:M70=1"),
]


@pytest.mark.parametrize(("old", "new"), FORGED)
def test_a_forged_map_is_refused(made, old, new):
    assert made.text.count(old) >= 1
    forged = made.text.replace(old, new, 1)
    found = judged(made, forged)
    assert any(one.is_error for one in found.diagnostics), (old, new)


UNTIL = """INPUT DOOR M11
INPUT JOB M70
REGISTER N 0..5
P10 WAIT DOOR = ON AND JOB > N [5] (s)
P20 WAIT DOOR ON [3] (s)
"""


@pytest.fixture(scope="module")
def until():
    found, _ = compiled(UNTIL, "INDUSTRIAL6")
    return found


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("(M11=1)&(M70>$N) 5 ", "(M11=1)&(M70>=$N) 5 "),
        ("(M11=1)&(M70>$N) 5 ", "(M11=1)|(M70>$N) 5 "),
        ("(M11=1)&(M70>$N) 5 ", "(M11=1)&(M71>$N) 5 "),
        ("(M11=1)&(M70>$N) 5 ", "(M11=1)&(M70>$N) 6 "),
        ("(M11=1)&(M70>$N) 5 ", "(M11=1)&(M70>$N) - "),
        ("(M11=1)&(M70>$N) 5 ", "again:(M11=1)&(M70>$N) 5 "),
        ("(M11=1)&(M70>$N) 5 ", "M70>$M 5 "),
        ("(M11=1)&(M70>$N) 5 ", "$N>1 5 "),
        ("(M11=1)&(M70>$N) 5 ", "M70+$N 5 "),
        ("(M11=1)&(M70>$N) 5 ", "M11=1 5 "),
        ("(M11=1)&(M70>$N) 5 ", "- 5 "),
        ("M11=1 3 DOOR", "(M11=1) 3 DOOR"),
        ("M11=1 3 DOOR", "M11>=1 3 DOOR"),
        ("M11=1 3 DOOR", "M11=$N 3 DOOR"),
        ("DOOR = 1 AND JOB > N", "DOOR = 1 OR JOB > N"),
    ],
)
def test_a_forged_condition_of_a_wait_is_refused(until, old, new):
    assert not [one for one in judged(until, until.text).diagnostics if one.is_error]
    assert until.text.count(old) == 1
    found = judged(until, until.text.replace(old, new))
    assert any(one.is_error for one in found.diagnostics), (old, new)


def test_a_wait_for_a_limit_or_a_motor_is_refused_without_the_program(until):
    """In a condition, too, a variable that isn't an input is reported."""
    forged = until.text.replace("(M70>$N)", "(M161>$N)")
    found = certify_text(forged, until.plan.robot, until.program.source)
    assert any("waits for M161" in one.message for one in found.diagnostics if one.is_error)


GROUPS = """INPUT JOB M70..M72
OUTPUT GO M80..M81 1
REGISTER N 0..7
P10 SET N = JOB
CASE JOB
OF 2..4
  P50 MOVEJ -5 0 0 0 0 0 [1] (deg,s)
  P60 MOVEJ HOME [1] (s)
OF 0 1 5..7
  P70 SET GO 2
END
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("$N:=M70,M71,M72", "$N:=M72,M71,M70"),
        ("$N:=M70,M71,M72", "$N:=M70,M71"),
        ("$N:=M70,M71,M72", "$N:=M70,M71,M73"),
        ("$N:=M70,M71,M72", "$N:=M70,M71,M72,M73"),
        ("$N:=M70,M71,M72", "$N:=M70,,M72"),
        ("$N:=M70,M71,M72", "$N:=M70,M71,M72,"),
        ("$N:=M70,M71,M72", "$N:=M70,M71,$N"),
        ("$N:=M70,M71,M72", "$N:=M70"),
        ("(M70,M71,M72>=2)&(M70,M71,M72<=4)", "(M70,M71,M72>=2)&(M70,M72,M71<=4)"),
        ("(M70,M71,M72>=2)&(M70,M71,M72<=4)", "(M70,M71,M72>=1)&(M70,M71,M72<=4)"),
        ("M80=0\n", "M80=1\n"),
        ("M81=1\n", "M81=0\n"),
        ("M81=1\n", "M82=1\n"),
        ("M81=1\n", ""),
        ("M80=0\n", "M80=0\nM80=0\n"),
    ],
)
def test_a_forged_group_is_refused(old, new):
    found, _ = compiled(GROUPS, "INDUSTRIAL6")
    assert found.text.count(old) >= 1, found.text
    result = judged(found, found.text.replace(old, new, 1))
    assert any(one.is_error for one in result.diagnostics), (old, new)


@pytest.mark.parametrize("variable", ["M162", "P8100", "M070"])
def test_no_bit_of_a_group_is_a_variable_of_ours(variable):
    found, _ = compiled(GROUPS, "INDUSTRIAL6")
    forged = found.text.replace("M70,M71,M72", f"M70,M71,{variable}")
    result = certify_text(forged, found.plan.robot, found.program.source)
    assert any(one.is_error for one in result.diagnostics)


ENDS = """INPUT DOOR M11
OUTPUT LAMP M2
WHEN DOOR ON
  P10 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
  P20 STOP
ELSE
  P30 SET LAMP 3
END
WHEN DOOR OFF
  P40 MOVEJ 7 0 0 0 0 0 [1] (deg,s)
  P50 ABORT "no part"
END
P60 MOVEJ 9 0 0 0 0 0 [1] (deg,s)
"""


@pytest.fixture(scope="module")
def ending():
    found, _ = compiled(ENDS, "INDUSTRIAL6")
    return found


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" stop 2 - - -", " abort 2 - - -"),
        (" stop 2 - - -", " hold 2 - - -"),
        (" stop 2 - - -", " stop 2 - 5 -"),
        (" stop 2 - - -", " stop 2 M11=1 - -"),
        (" stop 2 - - -", " finish 2 - - -"),
        (" abort 8 - - no part", " abort 8 - - a part"),
        (" abort 8 - - no part", " abort 8 - - -"),
        (" abort 8 - - no part", " stop 8 - - -"),
        (" abort 8 - - no part", " hold 8 - - no part"),
        (" abort 8 - - no part", " abort 8 - 1 no part"),
        (" abort 8 - - no part", " abort 8 $N:=1 - no part"),
    ],
)
def test_a_forged_end_is_refused(ending, old, new):
    assert not [one for one in judged(ending, ending.text).diagnostics if one.is_error]
    assert ending.text.count(old) == 1
    found = judged(ending, ending.text.replace(old, new))
    assert any(one.is_error for one in found.diagnostics), (old, new)


@pytest.mark.parametrize("kind", ["stop", "abort"])
def test_a_way_that_goes_on_after_its_end_is_refused_without_the_program(ending, kind):
    """A move line after the end of the program would count as part of the branch, so the branches would seem
    to end at different positions.
    """
    lines = ending.text.splitlines()
    numbers = {
        number
        for number, line in enumerate(lines)
        if line.startswith("; barrier ") and line.split()[3] == kind
    }
    assert len(numbers) == 1
    (number,) = numbers
    step = int(lines[number].split()[4])
    # The barrier before the WHEN's end becomes the end, and the WHEN's own end a hold.
    for forged_kind in ("hold", "wait"):
        forged = ending.text.replace(
            f" else {step + 1} - - -" if kind == "stop" else f" end {step + 1} - - -",
            f" {forged_kind} {step + 1} {'M11=1' if forged_kind == 'wait' else '-'} - -",
        )
        assert forged != ending.text
        found = certify_text(forged, ending.plan.robot, ending.program.source)
        assert any("its branch continues after it" in one.message for one in found.diagnostics)


def test_ways_meet_where_the_way_that_goes_on_ends(ending):
    """If the end of the program in a branch is forged to a hold, the branch would have to end where the other
    one ends.
    """
    for old, new in ((" stop 2 - - -", " hold 2 - - -"), (" abort 8 - - no part", " hold 8 - - no part")):
        forged = ending.text.replace(old, new)
        found = certify_text(forged, ending.plan.robot, ending.program.source)
        assert any("end at different positions" in one.message for one in found.diagnostics)


def test_what_was_not_read_before_is_refused_without_the_program(made):
    forged = made.text.replace("again:(M70>=2)&(M70<=4)", "again:(M71>=2)&(M71<=4)")
    found = certify_text(forged, made.plan.robot, made.program.source)
    assert any("decides by inputs that weren't read" in one.message for one in found.diagnostics)
    forged = made.text.replace("M70=1 - JOB", "again:M70=1 - JOB")
    found = certify_text(forged, made.plan.robot, made.program.source)
    assert any("decides by inputs that weren't read" in one.message for one in found.diagnostics)


def drawn(chance, depth, *, condition):
    """Return a random expression of all operators, sometimes deeply nested."""
    if condition:
        kind = chance.choice(("compare", "compare", "connect", "not") if depth else ("compare",))
        if kind == "not":
            return Before("NOT", drawn(chance, depth - 1, condition=True))
        if kind == "connect":
            parts = (drawn(chance, depth - 1, condition=True) for _ in range(2))
            return Between(chance.choice(CONNECTIVES), *parts)
        parts = (drawn(chance, max(depth - 1, 0), condition=False) for _ in range(2))
        return Between(chance.choice(COMPARISONS), *parts)
    if not depth or chance.random() < 0.4:
        return chance.choice(
            [
                Constant(float(chance.randint(-9, 99))),
                Constant(chance.randint(-999, 999) / 8),
                InputValue(f"M{chance.randint(0, 8191)}"),
                InputValue(",".join(f"M{chance.randint(0, 8191)}" for _ in range(chance.randint(2, 16)))),
                RegisterValue(chance.choice(("N", "COUNT_2", "M11X", "_"))),
            ]
        )
    if chance.random() < 0.2:
        inner = drawn(chance, depth - 1, condition=False)
        if not isinstance(inner, Constant):
            return Before("-", inner)
    parts = (drawn(chance, depth - 1, condition=False) for _ in range(2))
    return Between(chance.choice(ARITHMETIC), *parts)


@exercises(deep=0.1, condition=0.3)
def test_what_is_written_is_read_as_it_was_meant(tally):
    chance = random.Random(28)
    for _ in range(400):
        condition = chance.random() < 0.5
        value = drawn(chance, 4, condition=condition)
        text = canonical(value)
        assert read_value(text) == value, text
        assert (read_condition(text) == value) == condition
        assert (read_assignment(f"$N:={text}") == (RegisterValue("N"), value)) == (not condition)
        tally.count("deep", text.count("(") >= 3)
        tally.count("condition", condition)
        assert in_words(value)
        # A text with a character less or more can't be read, or has another meaning.
        place = chance.randrange(len(text))
        assert read_value(text[:place] + text[place + 1 :]) != value
        assert read_value(text + chance.choice("()&1$ ")) != value


@pytest.mark.parametrize(
    "text",
    ["", "(", "$", "$n", "M", "M11=", "=1", "(M11)", "((M11=1))", "M11 = 1", "M11=1=1", "!", "--1", "+1",
        "M11=1e5", "$N:=1",
     "(" * 10_000, "!" * 10_000, "(" * 100 + "M11=1" + ")" * 100, "M12345=1", "X11=1", "$N&($N=1)",
         "-($N=1)"],
)  # fmt: skip
def test_a_text_in_another_form_says_nothing(text):
    assert read_condition(text) is None
    assert read_value(text) is None


def test_what_is_computed():
    held, read = {"N": 7}, {"M1": 1.0}
    assert evaluated(read_value("($N/2)+($N%4)"), held, read) == 6.0
    assert evaluated(read_value("-($N*3)"), held, read) == -21.0
    assert evaluated(read_condition("(M1=1)&(!($N<7))"), held, read) == 1.0
    assert evaluated(read_condition("(M1<>1)|($N>=8)"), held, read) == 0.0


VALUES = """INPUT JOB M70
INPUT DOOR M11
OUTPUT LEVEL M1
P10 WAIT JOB 1000000 [3] (s)
P20 SET LEVEL 3000000
P30 WAIT DOOR ON
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("M70=1000000", "M70=1000001"),
        ("M1=3000000", "M1=3000002"),
        ("M11=1 ", "M11=1.000000001 "),
    ],
)
def test_another_value_of_an_input_or_output_is_refused(old, new):
    """A WAIT compares exactly at run time, so a value that differs by a millionth is another condition."""
    found, _ = compiled(VALUES, "INDUSTRIAL6")
    assert not [one for one in judged(found, found.text).diagnostics if one.is_error]
    assert found.text.count(old) == 1
    assert [one for one in judged(found, found.text.replace(old, new)).diagnostics if one.is_error]


@pytest.mark.parametrize("line", ["WHEN N > -ON", "WHEN N <= -OFF"])
def test_a_minus_before_a_state_is_its_number(line):
    found, diagnostics = compiled(
        f"REGISTER N 0..5\n{line}\nP10 SET N = 1\nELSE\nP20 SET N = 2\nEND\n", "INDUSTRIAL6"
    )
    assert found is not None, [one.message for one in diagnostics]


@pytest.mark.parametrize(
    ("lines", "code"),
    [
        ("WHEN JOB < 0.0000000004\nP10 SET N = 1\nEND", "Y0434"),
        ("WHEN JOB 0.1234567894\nP10 SET N = 1\nEND", "Y0434"),
        ("P10 SET N = N * 1.0000000001", "Y0434"),
        ("P10 WAIT JOB 0.1234567894 [1] (s)", "Y0434"),
        ("WHEN ON = ON\nP10 SET N = 1\nEND", "Y0430"),
        ("WHEN NOT ON\nP10 SET N = 1\nEND", "Y0430"),
        ("CASE JOB\nOF 0..99999999999\nP10 SET N = 1\nELSE\nP20 SET N = 2\nEND", "Y0432"),
    ],
)
def test_what_a_text_cannot_say_is_refused_at_its_line(lines, code):
    """A value that has more decimals than the text allows is refused at its line. Rounded, the decision could
    be another one, which the judge couldn't notice.
    """
    found, diagnostics = compiled(f"INPUT JOB M70\nREGISTER N 0..5\n{lines}\n", "INDUSTRIAL6")
    assert found is None
    assert [one.code for one in diagnostics if one.is_error] == [code]


@pytest.mark.parametrize(
    "lines", ["P10 WAIT JOB 1000000000 [3] (s)", "LET X = 0.1 + 0.2\nWHEN JOB > X\nP10 SET N = 1\nEND"]
)
def test_what_a_text_can_say_is_compiled(lines):
    found, diagnostics = compiled(f"INPUT JOB M70\nREGISTER N 0..5\n{lines}\n", "INDUSTRIAL6")
    assert found is not None, [one.message for one in diagnostics]


def test_numbers_are_told_with_all_their_digits():
    _, diagnostics = compiled("REGISTER N 0..1000000\nP10 SET N = 1000001\n", "INDUSTRIAL6")
    assert any("can't be 1000001" in one.message for one in diagnostics)
    assert state_text(1000002.0) == "1000002"


SAID = """REGISTER N 0..5
P10 SET N = 2
P20 SAY "box {N}"
P30 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" say 1 - - box {N}", " say 1 - - box 2"),
        (" say 1 - - box {N}", " say 1 - - -"),
        (" say 1 - - box {N}", " hold 1 - - box {N}"),
        (" say 1 - - box {N}", " say 1 - 5 box {N}"),
        (" say 1 - - box {N}", " say 1 $N - box {N}"),
    ],
)
def test_a_forged_saying_is_refused(old, new):
    made, _ = compiled(SAID, "INDUSTRIAL6")
    assert not [one for one in judged(made, made.text).diagnostics if one.is_error]
    assert made.text.count(old) == 1
    assert any(one.is_error for one in judged(made, made.text.replace(old, new)).diagnostics)


LATE = """INPUT DOOR M11
REGISTER N 0..5
P10 WAIT DOOR ON [3] (s) ELSE
  P20 SET N = 1
END
P30 WAIT DOOR = ON OR N > 2 [2.5] (s) ELSE
  P40 ABORT "late"
END
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("M11=1 3 DOOR", "M11=1 4 DOOR"),
        ("M11=1 3 DOOR", "M11=1 - DOOR"),
        ("M11=1 3 DOOR", "M11=0 3 DOOR"),
        ("M11=1 3 DOOR", "again:M11=1 3 DOOR"),
        ("(M11=1)|($N>2) 2.5", "(M11=1)|($N>2) 25"),
        ("(M11=1)|($N>2) 2.5", "(M11=1)&($N>2) 2.5"),
        ("when 0 M11=1 3 DOOR", "wait 0 M11=1 3 DOOR"),
        ("else 1 - - -", "end 1 - - -"),
        ("else 1 - - -", "else 1 - 3 -"),
    ],
)
def test_a_forged_wait_with_an_else_is_refused(old, new):
    found, _ = compiled(LATE, "INDUSTRIAL6")
    assert not [one for one in judged(found, found.text).diagnostics if one.is_error]
    assert found.text.count(old) == 1, found.text
    result = judged(found, found.text.replace(old, new))
    assert any(one.is_error for one in result.diagnostics), (old, new)
    found, diagnostics = compiled(LATE, "INDUSTRIAL6", target="prog")
    assert [one.code for one in diagnostics if one.is_error] == ["Y1106"]


COMPUTED = """OUTPUT GO M80..M82
OUTPUT HEAT M1
INPUT JOB M70
REGISTER N 0..7
P10 SET GO N
P20 SET HEAT = JOB * 2 + N
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("M80,M81,M82:=$N", "M81,M80,M82:=$N"),
        ("M80,M81,M82:=$N", "M80,M81:=$N"),
        ("M80,M81,M82:=$N", "M80,M81,M83:=$N"),
        ("M80,M81,M82:=$N", "M80,M81,M82:=$N+1"),
        ("M80,M81,M82:=$N", "$N:=$N"),
        ("M80,M81,M82:=$N", "M80,M81,M82:=$N>1"),
        ("M1:=(M70*2)+$N", "M2:=(M70*2)+$N"),
        ("M1:=(M70*2)+$N", "M161:=(M70*2)+$N"),
        ("M1:=(M70*2)+$N", "P8100:=(M70*2)+$N"),
        ("M1:=(M70*2)+$N", "M1:=(M71*2)+$N"),
        ("M1:=(M70*2)+$N", "M1=(M70*2)+$N"),
        ("GO = N", "HEAT = N"),
    ],
)
def test_a_forged_output_of_a_computed_value_is_refused(old, new):
    found, _ = compiled(COMPUTED, "INDUSTRIAL6")
    assert not [one for one in judged(found, found.text).diagnostics if one.is_error]
    assert found.text.count(old) == 1, found.text
    result = judged(found, found.text.replace(old, new))
    assert any(one.is_error for one in result.diagnostics), (old, new)


@pytest.mark.parametrize("variable", ["M161", "P8100", "M0080"])
def test_no_computed_value_goes_into_a_variable_of_ours(variable):
    found, _ = compiled(COMPUTED, "INDUSTRIAL6")
    forged = found.text.replace("M1:=(M70", f"{variable}:=(M70")
    result = certify_text(forged, found.plan.robot, found.program.source)
    assert any(one.is_error and one.code in ("Y1191", "Y1151") for one in result.diagnostics), (
        result.diagnostics
    )


ASKED = """REGISTER N 0..5
REGISTER M 0..5
P10 HOLD "how many?" N
P20 HOLD "go?"
P30 SET M = N
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("$N - how many?", "$M - how many?"),
        ("$N - how many?", "$K - how many?"),
        ("$N - how many?", "- - how many?"),
        ("$N - how many?", "N - how many?"),
        ("$N - how many?", "$N+1 - how many?"),
        ("$N - how many?", "M11 - how many?"),
        ("$N - how many?", "$N 5 how many?"),
        ("$N - how many?", "$N - how few?"),
        ("- - go?", "$M - go?"),
    ],
)
def test_a_forged_question_is_refused(old, new):
    found, _ = compiled(ASKED, "INDUSTRIAL6")
    assert not [one for one in judged(found, found.text).diagnostics if one.is_error]
    assert found.text.count(old) == 1, found.text
    result = judged(found, found.text.replace(old, new))
    assert any(one.is_error for one in result.diagnostics), (old, new)
    found, diagnostics = compiled(ASKED, "INDUSTRIAL6", target="prog")
    assert [one.code for one in diagnostics if one.is_error] == ["Y1106"]


OUTSIDE = """REGISTER N 0..5 OUTSIDE
REGISTER K 0..5
P10 WAIT N > K [5] (s)
P20 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
"""


def test_a_wait_for_what_nothing_changes_is_refused():
    made, _ = compiled(OUTSIDE, "INDUSTRIAL6")
    assert made is not None
    assert "; register N 0 5 0 outside\n; register K 0 5 0\n" in made.text
    assert [one.outside for one in made.certificate.text.registers] == [True, False]
    for old, new in (
        ("; register N 0 5 0 outside", "; register N 0 5 0"),
        ("; register K 0 5 0", "; register K 0 5 0 outside"),
        ("($N>$K)", "($K>$K)"),
        ("$N>$K", "$K>$K"),
    ):
        if old in made.text:
            forged = made.text.replace(old, new)
            found = judged(made, forged)
            assert any(one.is_error for one in found.diagnostics), new
    assert "comes too late: line" in " ".join(
        one.message for one in judged(made, made.text.replace("0 outside", "0")).diagnostics
    )
