"""A program as a tree of its branches and loops, with the places and times of their contents."""

import json

from click.testing import CliRunner
from programs import planned

from yarclang.cli.yarc import main
from yarclang.report.inspection.outline import outline_lines, outline_of

HEAD = "INPUT DOOR M11\nINPUT JOB M70\nREGISTER N 0..9\nDEFAULT [1] (deg,s)\n"
OUT, HOME = "MOVEJ 10 0 0 0 0 0", "MOVEJ 0 0 0 0 0 0"


def tree(*lines):
    plan, found = planned(HEAD + "\n".join(lines) + "\n")
    assert not [one for one in found if one.is_error], found
    return outline_of(plan)


def shown(rows):
    return [(row.depth, row.text, None if row.takes is None else row.takes.text()) for row in rows]


def test_ways_and_loops_stand_inside_each_other():
    rows = tree(
        f"P10 {OUT}",
        "LOOP",
        f"P20 {HOME}",
        "WHEN DOOR ON",
        f"P30 {OUT}",
        "P40 EXIT",
        "END",
        f"P50 {OUT} [3]",
        "END",
        "P60 SET N = N + 1",
    )
    assert shown(rows) == [
        (0, "MOVEJ", "1.000 s"),
        (0, "LOOP: repeated; one pass", "2.000 to 4.000 s"),
        (1, "MOVEJ", "1.000 s"),
        (1, "WHEN DOOR = 1", "1.000 s"),
        (2, "MOVEJ", "1.000 s"),
        (2, "EXIT", None),
        (1, "MOVEJ", "3.000 s"),
        (1, "begin the next pass of the loop", None),
        (0, "SET N = N + 1", None),
    ]


def test_both_ways_have_their_times():
    rows = tree(
        "CASE JOB", "OF 1", f"P10 {OUT}", f"P20 {HOME} [2]", "OF 2..3", 'P30 SAY "{N}"', "ELSE", "P40 STOP",
            "END",
    )  # fmt: skip
    ways = [one for one in shown(rows) if one[1].startswith(("OF", "ELSE"))]
    assert ways == [
        (0, "OF JOB = 1", "3.000 s"),
        (0, "ELSE", "0.000 s"),
        (1, "OF JOB >= 2 AND JOB <= 3", "0.000 s"),
        (1, "ELSE", "0.000 s"),
    ]


def test_a_wait_with_an_else_and_a_sub_that_is_left():
    rows = tree(
        "SUB S",
        "P10 WAIT DOOR ON [2] (s) ELSE",
        "P20 RETURN",
        "END",
        f"P30 {OUT}",
        f"P40 {HOME}",
        "END",
        "P50 CALL S",
    )
    assert [text for _, text, _ in shown(rows)] == [
        "CALL: a SUB that some branches leave",
        "WAIT DOOR = 1, within 2 s",
        "ELSE",
        "RETURN",
        "MOVEJ",
        "MOVEJ",
    ]


def test_every_step_that_does_something_has_one_line():
    rows = tree("REPEAT N", f"P10 {OUT}", f"P20 {HOME}", "END", 'P30 HOLD "go?"', "P40 WAIT DOOR ON [1]")
    steps = [row.step for row in rows]
    assert steps == sorted(set(steps))
    lines = list(outline_lines(rows))
    assert len(lines) == len(rows)
    assert lines[0] == "line 5 SET REPEAT_1 = N"


def test_the_command(tmp_path):
    path = tmp_path / "a.yarc"
    path.write_text(f"ROBOT INDUSTRIAL6\nSTART HOME\n{HEAD}LOOP\nP10 {OUT}\nP20 {HOME}\nUNTIL DOOR ON\n")
    result = CliRunner().invoke(main, ["inspect", str(path), "--ways"])
    assert result.exit_code == 0
    assert "in all 2.000 s, each loop once" in result.output
    told = json.loads(CliRunner().invoke(main, ["inspect", str(path), "--ways", "--format", "json"]).output)
    assert told["takes"]["loops"] is True
    assert [one["kind"] for one in told["ways"]] == ["loop", "step", "step", "way", "step", "step"]
    for wrong in (["P10"], ["--line", "5"]):
        assert CliRunner().invoke(main, ["inspect", str(path), "--ways", *wrong]).exit_code == 2
    path.write_text("ROBOT INDUSTRIAL6\nSTART HOME\nP10 MOVEJ 10000 0 0 0 0 0 [1] (deg,s)\n")
    assert CliRunner().invoke(main, ["inspect", str(path), "--ways"]).exit_code == 1
