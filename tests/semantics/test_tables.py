"""Tests of TABLE: an element means its number, wherever a number is allowed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import checked, codes, compiled

HEAD = """DEFAULT {TCP} [5] (mm,deg,s) {B}
JOINTS READY 0 -10 -40 0 50 0 (deg)
P0001 MOVEJ READY
"""


@pytest.mark.parametrize(
    ("with_table", "without"),
    [
        ("TABLE H 1176 1200 (mm)\nP0010 MOVEL 0 1174.4 $(H[1]) 0 0 0", "P0010 MOVEL 0 1174.4 1200 0 0 0"),
        ("TABLE H 117.6 120 (cm)\nP0010 MOVEL 0 1174.4 $(h[0]) 0 0 0", "P0010 MOVEL 0 1174.4 1176 0 0 0"),
        ("TABLE H 1; 20; 4\nP0010 DMOVE $(H[1]) 0 0 0 0 0", "P0010 DMOVE 20 0 0 0 0 0"),
        ("TABLE S 0 1;\n  20 4\nP0010 DMOVE $(S[1, 0]) $(S[0, 1]) 0 0 0 0", "P0010 DMOVE 20 1 0 0 0 0"),
        (("LET A = 5 (mm)\n"
            "TABLE H $A $(2*A) 3 (cm)\n"
            "P0010 DMOVE $(H[1]) $(H[2]) 0 0 0 0"), "P0010 DMOVE 10 30 0 0 0 0"),
        ("TABLE T 6 7 (s)\nP0010 DMOVE 20 0 0 0 0 0 [$(T[1])]", "P0010 DMOVE 20 0 0 0 0 0 [7]"),
        (("TABLE C 1 2\n"
            "REPEAT $(C[1])\n"
            "  P0010 DMOVE 20 0 0 0 0 0\n"
            "END"), ("REPEAT 2\n"
            "  P0010 DMOVE 20 0 0 0 0 0\n"
            "END")),
        ("TABLE N 1 0\nTABLE H 5 9\nP0010 DMOVE $(H[N[1]] + H[N[0]]) 0 0 0 0 0", "P0010 DMOVE 14 0 0 0 0 0"),
        (("TABLE H 5 9\n"
            "SUB GO I\n"
            "  P0011 DMOVE $(H[I]) 0 0 0 0 0\n"
            "END\n"
            "P0010 CALL GO 1"), ("SUB GO\n"
            "  P0011 DMOVE 9 0 0 0 0 0\n"
            "END\n"
            "P0010 CALL GO")),
        ("TABLE H 5 9\nIF H[1] > 8\n  P0010 DMOVE 9 0 0 0 0 0\nEND", "P0010 DMOVE 9 0 0 0 0 0"),
        ("TABLE H 5 9\nP0010 DMOVE $(H[(0.1 + 0.2)/0.3]) 0 0 0 0 0", "P0010 DMOVE 9 0 0 0 0 0"),
    ],
)  # fmt: skip
def test_a_number_of_a_table_is_what_stands_there(with_table, without):
    made = [compiled(f"{HEAD}{text}\n") for text in (with_table, without)]
    assert [[one for one in found if one.is_error] for _, found in made] == [[], []]
    lines = [[line for line in one.text.splitlines() if not line.startswith(";")] for one, _ in made if one]
    assert lines[0] == lines[1]


@given(
    st.integers(1, 6).flatmap(
        lambda width: st.lists(
            st.lists(st.integers(-999, 999), min_size=width, max_size=width), min_size=1, max_size=6
        )
    ),
    st.data(),
)
def test_every_index_has_its_number_and_no_other_has_any(rows, data):
    text = "; ".join(" ".join(map(str, row)) for row in rows)
    flat = [value for row in rows for value in row]
    has_two = len(rows) > 1 and len(rows[0]) > 1
    row = data.draw(st.integers(-2, len(rows) + 1 if has_two else len(flat) + 1))
    column = data.draw(st.integers(-2, len(rows[0]) + 1)) if has_two else 0
    index = f"{row}, {column}" if has_two else f"{row}"
    inside = 0 <= row < (len(rows) if has_two else len(flat)) and (not has_two or 0 <= column < len(rows[0]))
    head = "DEFAULT {TCP} [5] (mm,deg,s) {B}\n"
    program, found = checked(f"{head}TABLE T {text}\nP0010 DMOVEJ $(T[{index}]/1000) 0 0 0 0 0\n")
    errors = [one for one in found if one.is_error]
    assert [one.code for one in errors] == ([] if inside else ["Y0456"])
    if inside:
        wanted = rows[row][column] if has_two else flat[row]
        assert program.steps[-1].goal.dq[0] == pytest.approx(wanted / 1000 * 0.017453292519943295)


def test_a_table_is_no_word_for_other_names():
    assert "Y0211" in codes(checked(f"{HEAD}LET TABLE = 1\n")[1])


def test_a_large_table_is_read_in_bounded_time():
    numbers = ";\n".join(" ".join(map(str, range(20 * row, 20 * row + 20))) for row in range(1_000))
    program, found = checked(
        f"{HEAD}TABLE T {numbers}\nREPEAT I 500\n  P0010 DMOVEJ $(T[I + 500, I % 20]/1E6) 0 0 0 0 0\nEND\n"
    )
    assert codes(found) == []
    assert len(program.steps) == 501
