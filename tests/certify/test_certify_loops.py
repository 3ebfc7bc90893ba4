"""Tests of loops in a text: each must begin, repeat, be left and end as in the program, and each pass must
end where it began.
"""

import re

import pytest
from programs import compiled

from yarclang.certify.certifying import certify, certify_text

SOURCE = """INPUT DOOR M11
REGISTER N 0..9
P10 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
LOOP
  P20 MOVEJ 9 0 0 0 0 0 [1] (deg,s)
  WHEN DOOR ON
    P30 EXIT
  END
  P40 MOVEJ 5 0 0 0 0 0 [1] (deg,s)
END
P50 MOVEJ 0 0 0 0 0 0 [1] (deg,s)
WHILE N < 3
  P60 MOVEJ 2 0 0 0 0 0 [1] (deg,s)
  P70 SET N = N + 1
  P80 MOVEJ 0 0 0 0 0 0 [1] (deg,s)
END
"""


@pytest.fixture(scope="module")
def made():
    found, _ = compiled(SOURCE, "INDUSTRIAL6")
    return found


def barriers(text):
    return re.findall(r"^; barrier .*$", text, re.M)


def errors(made, text):
    found = certify(text, made.program, made.plan.robot, made.plan.robot.tolerance)
    return [one for one in found.diagnostics if one.is_error]


def errors_alone(made, text):
    found = certify_text(text, made.plan.robot, made.program.source)
    return [one for one in found.diagnostics if one.is_error]


def test_the_text_is_the_programs(made):
    kinds = [line.split()[3] for line in barriers(made.text)]
    assert kinds == ["loop", "when", "exit", "end", "next", "endloop", "loop", "when", "set", "next", "end",
        "endloop"]  # fmt: skip
    assert not errors(made, made.text)
    assert not errors_alone(made, made.text)
    assert "each loop once" in made.text


KINDS = ("loop", "next", "exit", "endloop", "when", "else", "end", "hold", "stop", "say")


@pytest.mark.parametrize("new", KINDS)
@pytest.mark.parametrize("number", range(12))
def test_another_kind_of_barrier_is_refused(made, number, new):
    line = barriers(made.text)[number]
    words = line.split(" ")
    if words[3] == new:
        return
    forged = made.text.replace(line, " ".join([*words[:3], new, *words[4:]]))
    assert errors(made, forged), line


@pytest.mark.parametrize("number", [0, 2, 3, 4, 5, 6, 9, 10, 11])
def test_a_barrier_of_a_loop_has_no_name(made, number):
    line = barriers(made.text)[number]
    assert line.endswith(" -")
    assert errors(made, made.text.replace(line, f"{line[:-1]}DOOR"))


@pytest.mark.parametrize("number", range(12))
def test_a_barrier_that_the_map_leaves_out_is_refused(made, number):
    forged = made.text.replace(barriers(made.text)[number] + "\n", "")
    assert errors(made, forged)
    assert errors_alone(made, forged)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (", each loop once", ""),
        ("each loop once", "each loop twice"),
        (" s, each loop once", " s and 1 wait"),
    ],
)
def test_the_header_says_that_loops_count_once(made, old, new):
    assert made.text.count(old) == 1
    assert errors(made, made.text.replace(old, new))


@pytest.mark.parametrize(
    ("number", "new", "what"),
    [
        (2, "next", "a pass ends elsewhere than where the loop begins"),
        (0, "hold", "a loop is left that didn't begin"),
        (4, "hold", "the exits of a loop end at different positions"),
        (5, "hold", "a loop has no end"),
        (6, "hold", "a loop begins anew that didn't begin"),
        (3, "endloop", "a loop ends that didn't begin"),
    ],
)
def test_a_loop_that_does_not_close_is_refused_without_the_program(made, number, new, what):
    line = barriers(made.text)[number]
    words = line.split(" ")
    forged = made.text.replace(line, " ".join([*words[:3], new, *words[4:]]))
    found = errors_alone(made, forged)
    assert any(what in one.message for one in found), [one.message for one in found]


def test_a_pass_that_ends_elsewhere_is_refused(made):
    """The last motion of the body is replaced by one to 5.5 deg, so each pass would end there."""
    lines = made.text.splitlines()
    places = {int(line.split()[2]): line.split()[3] for line in barriers(made.text)}
    (end,) = [number for number, kind in places.items() if kind == "next"][:1]
    begin = max(number for number in places if number < end)
    moved = [
        re.sub(r"^X([0-9.]+)", lambda found: f"X{float(found[1]) + 0.5:g}", line)
        if begin < at < end
        else line
        for at, line in enumerate(lines, 1)
    ]
    assert moved != lines
    forged = "\n".join([*moved, ""])
    assert errors(made, forged)
    assert any(
        "ends elsewhere than where the loop begins" in one.message for one in errors_alone(made, forged)
    )


def test_a_program_buffer_has_no_loops():
    found, diagnostics = compiled(SOURCE, "INDUSTRIAL6", target="prog")
    assert found is None
    assert [one.code for one in diagnostics if one.is_error] == ["Y1106"]
    assert "LOOP is repeated and left by the runtime" in next(
        one.message for one in diagnostics if one.is_error
    )
