"""Tests of the repairs of findings, and of the edits that format a text."""

import pytest
from conftest import HERE
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.assist.texts import EXAMPLES, HEAD, checked
from yarclang.assist.changes import changes_to, formatted
from yarclang.assist.repairs import repairs_of
from yarclang.diagnostics import Fix
from yarclang.pipeline.fixing import edited
from yarclang.source import SourceFile

BODY = """\
FRAME {TABLE} 0 900 600 0 0 90 (mm,deg) {B}
LET PITCH = 60 (mm)
JOINTS READY 0 -10 -20 0 -60 0 (deg)
INPUT DOOR M11
SUB TURN
  P0001 MOVEJ READY [MIN]
END
"""


def repaired(line: str, code: str, head: str = HEAD, *, plans: bool = False):
    """Return the repairs of a finding in a line, each as its title and the repaired line."""
    view = checked(head + BODY + line + "\n", plans=plans)
    found = view.checked.diagnostics
    (finding,) = [one for one in found if one.code == code]
    source = view.sketch.source
    at = len((head + BODY).splitlines())
    return {
        one.fix.title: SourceFile("", edited(source, [one.fix])).lines[at]
        for one in repairs_of(source, view.sketch, finding, found)
    }


@pytest.mark.parametrize(
    ("line", "code", "after"),
    [
        ("P0010 MOVJE READY", "Y0202", "P0010 MOVEJ READY"),
        ("P0010 MOVEJ REDAY", "Y0205", "P0010 MOVEJ READY"),
        ("P0010 MOVEL 0 0 0 0 0 0 {TABEL}", "Y0301", "P0010 MOVEL 0 0 0 0 0 0 {TABLE}"),
        ("P0010 MOVEL $PICTH 0 0 0 0 0", "Y0210", "P0010 MOVEL $PITCH 0 0 0 0 0"),
        ("P0010 MOVEL $(2*PICTH) 0 0 0 0 0", "Y0210", "P0010 MOVEL $(2*PITCH) 0 0 0 0 0"),
        ("P0010 CALL TRUN", "Y0210", "P0010 CALL TURN"),
        ("P0010 MOVEL 0 0 0 0 0 0 (mmm)", "Y0305", "P0010 MOVEL 0 0 0 0 0 0 (mm)"),
        ("P0010 WAIT DOR ON [5]", "Y0210", "P0010 WAIT DOOR ON [5]"),
        ("P0010 MOVJ READY", "Y0204", "P0010 MOVEJ READY"),
    ],
)
def test_what_was_meant(line: str, code: str, after: str):
    assert next(iter(repaired(line, code).values())) == after


@pytest.mark.parametrize(
    ("line", "after"),
    [
        ("P0010 MOVEJ 1 2 3 4 5 6 [MIN]", ["(deg)", "(rad)"]),
        ("P0010 WAIT [5]", ["(s)", "(ms)"]),
        ("P0010 MOVEL {TCP} 0 0 0 0 0 0 [MIN] (deg) {B}", None),
    ],
)
def test_missing_units(line: str, after: list[str] | None):
    found = repaired(line, "Y0304", "ROBOT INDUSTRIAL6\n")
    if after is None:
        assert found["write (mm)"] == line.replace("(deg)", "(deg,mm)")
    else:
        assert list(found.values()) == [f"{line} {unit}" for unit in after]


@pytest.mark.parametrize(("label", "unit"), [("P0020", "deg"), ("P0050", "mm")])
def test_units_that_only_planning_misses(label: str, unit: str):
    """The message of planning has other words than that of other checks, but the same subject, and so the
    same repair.
    """
    rows = (HERE / "rejected" / "speed_units.yarc").read_text().splitlines()
    wanted = [row for row in rows if "! error" not in row or row.startswith(label)]
    view = checked("\n".join(("ROBOT INDUSTRIAL6", *wanted, "")), plans=True)
    source, found = view.sketch.source, view.checked.diagnostics
    (finding,) = [one for one in found if one.code == "Y0304"]
    fixes = {one.fix.title: one.fix for one in repairs_of(source, view.sketch, finding, found)}
    after = edited(source, [fixes[f"write ({unit})"]])
    assert not any(one.code == "Y0304" for one in checked(after, plans=True).checked.diagnostics)


def test_the_shortest_time_that_works():
    found = repaired("P0010 MOVEJ 10 0 0 0 0 0 [0.05]", "Y0601", plans=True)
    (after,) = found.values()
    assert repaired_is_fine(after)


def repaired_is_fine(line: str) -> bool:
    view = checked(HEAD + BODY + line + "\n", plans=True)
    return not any(one.is_error for one in view.checked.diagnostics)


@pytest.mark.parametrize(
    "line",
    [
        "P0010 MOVEJ READY [200]",
        "P0010 MOVEJ READY [200]  ! slowly",
        "P0010 MOVEJ READY [200] ! yarc: ignore[Y0101]",
    ],
)
def test_suppressed_with_a_comment(line: str):
    found = repaired(line, "Y0611", plans=True)
    after = found["suppress Y0611 in this line"]
    assert after.startswith("P0010 MOVEJ READY [200]")
    view = checked(HEAD + BODY + after + "\n", plans=True)
    assert not any(one.code == "Y0611" for one in view.checked.diagnostics)


def test_errors_are_not_suppressed():
    assert not any("suppress" in title for title in repaired("P0010 MOVJE READY", "Y0202"))


TEXTS = st.lists(
    st.sampled_from(["a\n", "b\n", "\n", "c\r\n", "d\x0c\n", "e\u2028\n", "f\r"]), max_size=12
).map("".join)


@given(before=TEXTS, after=TEXTS, tail=st.sampled_from(["", "x"]))
def test_edits_lead_from_one_text_to_the_other(before: str, after: str, tail: str):
    source = SourceFile("x", before + tail)
    edits = changes_to(source, after + tail)
    assert edited(source, [Fix("", edits)]) == after + tail
    assert changes_to(source, source.text) == ()


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yarc")), ids=lambda path: path.name)
def test_formatting_edits_few_lines(path):
    source = SourceFile(path.name, path.read_text())
    once = edited(source, [Fix("", formatted(source))])
    assert formatted(SourceFile(path.name, once)) == ()
    spoiled = SourceFile(path.name, once.replace("\nP00", "\n   P00", 1).replace("MOVEJ", "movej", 1))
    edits = formatted(spoiled)
    assert 1 <= len(edits) <= 2
    assert all(one.span.end_line - one.span.line <= 2 for one in edits)


def test_a_text_with_syntax_errors_is_left_as_it_is():
    assert formatted(SourceFile("x", "P0010 MOVEJ [\n")) is None


@given(st.sampled_from(["\n", "\r\n"]))
@settings(max_examples=2)
def test_renumbering_keeps_line_ends(end: str):
    source = SourceFile("x", f"P0003 MOVEJ HOME{end}P0001 STOP{end}")
    assert edited(source, [Fix("", formatted(source, (10, 10)))]) == f"P0010 MOVEJ HOME{end}P0020 STOP{end}"
