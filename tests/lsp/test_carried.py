"""Findings of planning stay with their lines, as long as these lines are unchanged."""

from hypothesis import given
from hypothesis import strategies as st

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.lsp.carried import carried, planned_alone
from yarclang.source import SourceFile, Span

LINES = st.lists(st.sampled_from("abcd"), max_size=8)


def text(lines: list[str]) -> SourceFile:
    return SourceFile("x.yarc", "".join(f"{line}\n" for line in lines))


def finding(source: SourceFile, line: int, code: str = "Y0601") -> Diagnostic:
    span = Span.on_line(line, 1, 2)
    return Diagnostic(code, "slow", source, span, fix=Fix("write", (Edit(span, "x"),)))


@given(LINES, LINES, LINES, LINES)
def test_findings_move_with_their_lines(head: list[str], old: list[str], new: list[str], tail: list[str]):
    """Each carried finding is in a line with the same text. All findings before and after the edit are
    carried.
    """
    before, after = text([*head, *old, *tail]), text([*head, *new, *tail])
    findings = [finding(before, line + 1) for line in range(len(before.lines))]
    found = list(carried(planned_alone(before, findings, ()), after))
    assert len(found) >= len(head) + len(tail)
    for one in found:
        assert one.source is after
        assert one.fix is None
    lines = [after.line(one.span.line) for one in found]
    assert lines[: len(head)] == head
    assert lines[len(lines) - len(tail) :] == tail


def test_only_what_planning_alone_has_said_is_carried():
    source = text(["a", "b"])
    name, slow = finding(source, 1, "Y0202"), finding(source, 2)
    other = Diagnostic("Y0601", "slow", SourceFile("y.yarc", "a\n"), Span.on_line(1, 1, 2))
    planned = planned_alone(source, [name, slow, other], [name])
    assert planned.findings == (slow,)
    assert [one.span.line for one in carried(planned, text(["a", "new", "b"]))] == [3]
    assert list(carried(planned, text(["a", "c"]))) == []
