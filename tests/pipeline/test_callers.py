"""Tests of findings in modules, which are reported at the line of the program that calls."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import yarclang
from yarclang.cli.yarc import main
from yarclang.coordinator.messages.findings import finding_message, finding_of
from yarclang.diagnostics import Diagnostic, grouped, static_place
from yarclang.pipeline.modules import library_folder
from yarclang.report.finding import finding_json, finding_text
from yarclang.source import SourceFile, Span

HEAD = "ROBOT INDUSTRIAL6\nUSE SWING\nDEFAULT [50%] (deg,s)\n"
SWING = """\
DEFAULT [50%] (deg,s)
SUB TWICE
  P0010 MOVEJ 10 0 0 0 0 0
  P0020 MOVEJ 10 0 0 0 0 0
END
SUB FAST T (s)
  P0030 MOVEJ 20 0 0 0 0 0 [$T]
END
SUB FIXED
  P0040 MOVEJ 20 0 0 0 0 0 [0.001]
END
"""
"""TWICE moves to the same target twice, which is the warning Y0603. FAST has an error that depends on its
argument, FIXED has an error of its own.
"""
INSTALLED = """\
ROBOT INDUSTRIAL6
USE PICKPLACE
FRAME {GRIPPER} 0 150 0 90 0 0 (mm,deg) {FLANGE}
DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}
FRAME {FAR} 1900 800 700 0 0 0 {B}
OUTPUT GRIP M1
P0010 CALL PICKPLACE.PICK {GRIPPER} {FAR} 150 GRIP 1.2
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "swing.yarc").write_text(SWING)
    return tmp_path


def found(text, folder):
    return yarclang.check(text, name=str(folder / "p.yarc"), folder=folder)


def test_the_calling_line_comes_first_and_the_module_s_line_second(folder):
    (one,) = found(f"{HEAD}P0010 CALL SWING.TWICE\n", folder)
    assert (Path(one.source.name).name, one.span.line, one.code) == ("p.yarc", 4, "Y0603")
    assert one.source.line(4)[one.span.column - 1 : one.span.end_column - 1] == "P0010 CALL SWING.TWICE"
    told = finding_text(one).split("\n")
    assert told[1].endswith("P0010 CALL SWING.TWICE")
    assert told[3] == f"  in {folder / 'swing.yarc'}, line 4: P0020 MOVEJ 10 0 0 0 0 0"


def test_a_module_of_the_library_has_its_short_name_in_all_formats(tmp_path):
    (tmp_path / "p.yarc").write_text(INSTALLED)
    for format_ in ("text", "json", "sarif", "github", "junit"):
        done = CliRunner().invoke(main, ["check", str(tmp_path / "p.yarc"), "--format", format_])
        assert done.exit_code == 1
        assert str(library_folder()) not in done.output
        assert (
            "in APPROACH, line 14 (through APPROACH.IN, APPROACH.ABOVE): P0010 MOVEJ_RPY" in done.output
            or (format_ == "json")
        )
        if format_ == "json":
            (first, _) = json.loads(done.stdout)["diagnostics"]
            assert (first["file"], first["line"]) == (str(tmp_path / "p.yarc"), 7)
            assert first["within"]["module"] == "APPROACH"
            assert (first["within"]["file"], first["within"]["line"]) == (None, 14)
            assert first["within"]["through"] == ["APPROACH.IN", "APPROACH.ABOVE"]
        if format_ == "sarif":
            first = json.loads(done.stdout)["runs"][0]["results"][0]
            assert first["locations"][0]["physicalLocation"]["region"]["startLine"] == 7
            assert first["relatedLocations"][0]["logicalLocations"] == [
                {"name": "APPROACH", "kind": "module"}
            ]
        if format_ == "github":
            assert "line=7," in done.stdout


def test_a_module_in_the_users_folder_keeps_its_path(folder, monkeypatch):
    (folder / "p.yarc").write_text(f"{HEAD}P0010 CALL SWING.FIXED\n")
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(main, ["check", "p.yarc", "--format", "json"])
    (one,) = json.loads(done.stdout)["diagnostics"]
    assert (one["file"], one["line"], one["fix"]) == ("p.yarc", 4, None)
    assert (one["within"]["file"], one["within"]["line"]) == ("swing.yarc", 10)
    assert one["within"]["fix"]["edits"][0]["line"] == 10
    done = CliRunner().invoke(main, ["check", "p.yarc", "--format", "sarif"])
    (result,) = json.loads(done.stdout)["runs"][0]["results"]
    assert result["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "swing.yarc"
    assert result["fixes"][0]["artifactChanges"][0]["artifactLocation"]["uri"] == "swing.yarc"


def test_fixes_never_write_into_a_module(folder):
    (folder / "p.yarc").write_text(f"{HEAD}P0010 CALL SWING.FIXED\n")
    library = {path: path.read_bytes() for path in library_folder().iterdir() if path.is_file()}
    CliRunner().invoke(main, ["check", "--fix", str(folder / "p.yarc")])
    assert (folder / "swing.yarc").read_text() == SWING
    assert (folder / "p.yarc").read_text() == f"{HEAD}P0010 CALL SWING.FIXED\n"
    (folder / "p.yarc").write_text(INSTALLED)
    CliRunner().invoke(main, ["check", "--fix", str(folder / "p.yarc")])
    assert {path: path.read_bytes() for path in library} == library


def test_what_was_given_is_followed_to_the_program(folder):
    (folder / "outer.yarc").write_text("USE SWING\nSUB RUN HOW (s)\n  P0010 CALL SWING.FAST $HOW\nEND\n")
    text = HEAD.replace("USE SWING", "USE OUTER") + "P0010 CALL OUTER.RUN 0.01\n"
    (one,) = found(text, folder)
    assert one.span.line == 4
    assert one.within.through == ("SWING.FAST",)
    assert re.search(
        r"T is `\$HOW` in line 3 of .*outer\.yarc, and there HOW is `0\.01` in line 4 of .*p\.yarc$", one.help
    )
    assert one.fix is None


def test_the_innermost_line_of_the_program_is_the_one_that_calls(folder):
    told = found(
        f"{HEAD}SUB BOTH\n  P0010 CALL SWING.TWICE\nEND\nREPEAT I 3\n  P0020 CALL BOTH\nEND\n", folder
    )
    assert [(one.span.line, one.within.span.line) for one in told] == [(5, 3), (5, 4)]
    assert told[1].message.endswith("(at P0020(I=0)>P0010>P0020, and 2 more times)")


def test_an_error_of_a_module_that_nothing_calls_stays_there(folder):
    (folder / "swing.yarc").write_text(SWING + "SUB BAD\n  P0050 MOVEK 1\nEND\n")
    told = found(f"{HEAD}P0010 MOVEJ 5 0 0 0 0 0\n", folder)
    first = next(one for one in told if one.code == "Y0202")
    assert first.source.name.endswith("swing.yarc")
    assert first.within is None


@pytest.mark.parametrize("place", ["call", "above", "module"])
def test_a_comment_at_the_call_or_in_the_module_suppresses(folder, place):
    program = f"{HEAD}P0010 CALL SWING.TWICE\nP0020 CALL SWING.TWICE\n"
    assert [one.span.line for one in found(program, folder) if one.code == "Y0603"] == [4, 5, 5]
    comment = "! yarc: ignore[Y0603]"
    if place == "call":
        program = program.replace("P0010 CALL SWING.TWICE", f"P0010 CALL SWING.TWICE  {comment}")
    elif place == "above":
        program = program.replace("P0010", f"{comment}\nP0010")
    else:
        text = SWING.replace("P0020 MOVEJ 10 0 0 0 0 0", f"P0020 MOVEJ 10 0 0 0 0 0  {comment}")
        (folder / "swing.yarc").write_text(text)
    left = found(program, folder)
    assert {one.code for one in left} == {"Y0603"}
    second = 6 if place == "above" else 5
    assert [one.span.line for one in left] == ([second] if place == "module" else [second, second])


def test_a_comment_in_a_module_is_not_needless_while_only_other_files_can_tell():
    module = (
        "DEFAULT [50%] (deg,s)\nSUB TWICE\n  P0010 MOVEJ 10 0 0 0 0 0\n"
        "  P0020 MOVEJ 10 0 0 0 0 0  ! yarc: ignore[Y0603]\nEND\nSUB ALL\n  P0050 CALL TWICE\nEND\n"
    )
    assert [one.code for one in yarclang.check(module, robot="INDUSTRIAL6")] == []
    # if the file itself calls the subroutine, a needless comment is reported
    used = module + "P0060 CALL ALL\n"
    assert [one.code for one in yarclang.check(used, robot="INDUSTRIAL6")] == []
    needless = used.replace("P0010 MOVEJ 10 0 0 0 0 0\n", "P0010 MOVEJ 30 0 0 0 0 0\n")
    assert [one.code for one in yarclang.check(needless, robot="INDUSTRIAL6")] == ["Y1701"]


def test_a_comment_suppresses_no_error_of_a_module(folder):
    codes = [one.code for one in found(f"{HEAD}P0010 CALL SWING.FIXED  ! yarc: ignore[Y0601]\n", folder)]
    assert "Y0601" in codes


def test_messages_keep_both_places(folder):
    (one,) = found(f"{HEAD}P0010 CALL SWING.FIXED\n", folder)
    again = finding_of(finding_message(one))
    assert again.within.text == one.within.text
    assert finding_json(again) == finding_json(one)


calls = st.lists(st.sampled_from(["plain", "loop", "if", "sub"]), min_size=1, max_size=5)


def test_each_line_that_calls_gets_its_own_finding(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calls")
    (folder / "swing.yarc").write_text(SWING)
    seen = []

    @given(calls)
    @settings(max_examples=40, deadline=None)
    def check(kinds):
        lines, wanted = HEAD.splitlines(), []
        for at, kind in enumerate(kinds, 1):
            number = f"P{at * 20:04d}"
            before = {"loop": ["REPEAT 2"], "if": ["IF 1"], "sub": [f"SUB OWN{at}"]}.get(kind, [])
            lines += before
            lines.append(f"{number} CALL SWING.FIXED")
            wanted.append(len(lines))
            lines += ["END"] * bool(before)
            if kind == "sub":
                lines.append(f"P{at * 20 + 10:04d} CALL OWN{at}")
        told = found("\n".join(lines) + "\n", folder)
        assert sorted(one.span.line for one in told if one.code == "Y0601") == wanted
        assert all(one.within is not None and one.within.span.line == 10 for one in told)
        seen.append(len(wanted))

    check()
    assert max(seen) >= 3


def test_findings_of_a_module_without_a_place_stay_apart(folder):
    (folder / "swing.yarc").write_text("SUB A\n  P0010 MOVEK 1\n  P0020 MOVEM 1\nEND\n")
    told = found(f"{HEAD}P0010 MOVEJ 5 0 0 0 0 0\n", folder)
    assert [one.span.line for one in told if one.code == "Y0202"] == [2, 3]


@given(
    st.lists(
        st.tuples(st.sampled_from(["Y0603", "Y0505"]), st.integers(1, 3), st.integers(0, 2)), max_size=12
    )
)
def test_each_call_of_a_module_is_grouped_by_itself(drawn):
    """Findings in any order are grouped by code, line and call, whatever the pass of the loop."""
    module = SourceFile("m.yarc", "a\nb\nc\n", "M")
    told = [
        Diagnostic(code, "slow", module, Span.on_line(line, 1, 2), place=f"P0020(I={at})>P{call:04d}>P0010")
        for at, (code, line, call) in enumerate(drawn)
    ]
    left = grouped(told)
    assert len(left) == len(set(drawn))
    assert {(one.code, one.span.line, static_place(one.place)) for one in left} == {
        (code, line, f"P0020>P{call:04d}>P0010") for code, line, call in drawn
    }
