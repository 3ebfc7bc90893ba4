"""The certificate as a table."""

import yarclang
from yarclang.cli.table import certificate_table


def test_a_jerk_that_isnt_judged_stands_in_parentheses():
    made = yarclang.compile(
        "P0010 MOVEJ_TOPP 0 0 0 0 -30 0 [MIN] (deg,s)\nP0020 MOVEJ_SCURVE 0 0 0 0 -40 0 [MIN] (deg,s)\n",
        robot="INDUSTRIAL6",
    ).value
    assert made is not None
    _, _, first, second = certificate_table(made.certificate).split("\n")
    jerk = made.certificate.commands[0].jerk
    assert f"  ({jerk.name} {jerk.share * 100:.0f}%)  " in first
    assert "(" not in second
