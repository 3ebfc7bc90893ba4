"""`yarc check`: folders, processes, fixes, the choice of findings, and the formats for other programs."""

import json
import re
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.formats import FORMATS, document, sarif
from yarclang.cli.show import show_without_notes
from yarclang.cli.watching import changes
from yarclang.cli.yarc import main
from yarclang.diagnostics import Diagnostic
from yarclang.lint.registry import everything
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.fixing import fixed
from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile, Span

GOOD = "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\n"
OLD = "P0020 MOVJ 10 0 0 0 0 0 [5] (deg,s)\nP0010 MOVEJ HOME [5] (s)\n"
BAD = "P0010 MOVEK 10 0 0 0 0 0 [5] (deg,s)\n"
STILL = "P0010 MOVEJ HOME [5] (s)\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    return tmp_path


def check(*arguments, text=None):
    return CliRunner().invoke(main, ["check", *arguments], input=text)


def test_folders_and_settings(here):
    (here / "sub" / "deep").mkdir(parents=True)
    (here / ".hidden").mkdir()
    for name in ("a.yarc", "sub/b.yarc", "sub/deep/c.YARC"):
        Path(name).write_text(GOOD)
    Path(".hidden/d.yarc").write_text(BAD)
    Path("sub/cell.txt").write_text(BAD)
    done = check(".", "a.yarc")
    assert (done.exit_code, done.stderr) == (0, "3 files checked, no problems found\n")
    assert check("-", text=GOOD).exit_code == 0
    assert check(".hidden").exit_code == 1
    (here / "empty").mkdir()
    assert check("empty").exit_code == 2


def test_many_files_are_checked_by_several_processes_in_order(here):
    for number in range(12):
        Path(f"p{number:02}.yarc").write_text(BAD if number % 3 == 0 else GOOD)
    found = json.loads(check(".", "--no-plan", "--format", "json").stdout)["diagnostics"]
    assert [one["file"] for one in found] == [f"p{number:02}.yarc" for number in (0, 3, 6, 9)]


def test_select_ignore_and_most(here):
    Path("a.yarc").write_text(OLD + BAD.replace("P0010", "P0030"))
    codes = lambda *options: re.findall(r"(?:error|warning|note) (Y\d+)", check("a.yarc", *options).stderr)  # noqa: E731
    assert codes() == ["Y0204", "Y1201", "Y0202"]
    assert codes("--select", "old-name") == ["Y0204", "Y0202"]
    assert codes("--select", "Y12,Y02", "--ignore", "Y0204") == ["Y1201", "Y0202"]
    done = check("a.yarc", "--max-findings", "1")
    assert done.exit_code == 1
    assert "and 2 more: --max-findings 1" in done.stderr
    assert check("a.yarc", "--select", "Y9").exit_code == 2
    Path("b.yarc").write_text(STILL)
    assert check("b.yarc", "--strict").exit_code == 1
    assert check("b.yarc", "--strict", "--ignore", "Y0603").exit_code == 0


def test_without_planning(here):
    Path("a.yarc").write_text("P0010 MOVEJ 90 0 0 0 0 0 [0.1] (deg,s)\n")
    assert check("a.yarc").exit_code == 1
    assert check("a.yarc", "--no-plan").exit_code == 0


def test_fixes_are_written(here):
    Path("a.yarc").write_bytes(b"\xef\xbb\xbf" + OLD.replace("\n", "\r\n").encode())
    done = check("a.yarc", "--diff")
    assert done.exit_code == 1
    assert "+P0010 MOVEJ 10" in done.stdout
    assert Path("a.yarc").read_bytes().startswith(b"\xef\xbb\xbfP0020 MOVJ")
    done = check("a.yarc", "--fix")
    assert (done.exit_code, done.stderr) == (
        0,
        "2 fixes applied in 1 file\n1 file checked, no problems found\n",
    )
    expected = "P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\r\nP0020 MOVEJ HOME [5] (s)\r\n"
    assert Path("a.yarc").read_bytes() == b"\xef\xbb\xbf" + expected.encode()
    assert check("a.yarc", "--diff").exit_code == 0


def test_fixes_of_some_and_of_standard_input(here):
    done = check("-", "--fix", "--select", "Y0204", text=OLD)
    assert done.stdout == OLD.replace("MOVJ", "MOVEJ")
    done = check("-", "--fix", text="P0010 MOVEJ 90 0 0 0 0 0 [0.1] (deg,s)\n")
    assert done.exit_code == 0
    assert re.fullmatch(r"P0010 MOVEJ 90 0 0 0 0 0 \[2\.\d+\] \(deg,s\)\n", done.stdout)


def test_why_no_fix_was_applied_is_said(here):
    Path("a.yarc").write_text(GOOD)
    assert "no fix applied: there are no findings\n" in check("a.yarc", "--fix").stderr
    Path("a.yarc").write_text(STILL)
    for option in ("--fix", "--diff"):
        assert "no fix applied: Y0603 has no automatic fix\n" in check("a.yarc", option).stderr
    assert "no fix applied" not in check("a.yarc").stderr


@pytest.mark.parametrize(
    "words",
    [
        ("--fix", "--diff", "a.yarc"),
        ("--watch", "-"),
        ("--watch", "--fix", "a.yarc"),
        ("--diff", "--format", "json", "a.yarc"),
        ("--fix", "--format", "sarif", "-"),
        (),
    ],
)
def test_what_cannot_be_meant_together(here, words):
    Path("a.yarc").write_text(GOOD)
    assert check(*words).exit_code == 2


def refusing(text, fix_text, *, folder):
    """Return what `yarc check --fix` makes of a program whose first finding has a fix with a wrong text."""
    from dataclasses import replace

    from yarclang.diagnostics import Edit, Fix

    def look(source):
        return check_text(source, folder, Options(robot="INDUSTRIAL6"))

    checked = look(SourceFile("a.yarc", text))
    (one,) = [one for one in checked.diagnostics if one.code == "Y0603"]
    bad = Fix("a bad fix", (Edit(Span(1, 1, 2, 1), fix_text),))
    return fixed(replace(checked, diagnostics=(replace(one, fix=bad),)), look, lambda one: True)


@pytest.mark.parametrize(
    "fix_text", ["P0010 MOVEK\n", "P0010 MOVEJ [\n", "P0010 MOVEJ 5 0 0 0 0 0 [5] (deg,s)\n", STILL + GOOD]
)
def test_a_fix_that_breaks_the_program_or_changes_its_motion_is_refused(here, fix_text):
    made = refusing(STILL, fix_text, folder=here)
    assert (made.text, made.applied) == (STILL, ())


FOUND = (
    Diagnostic(
        "Y0601", "100 %, a: b,\nc <&> \x07", SourceFile("a, b:%.yarc", "x"), Span.on_line(3, 5, 9), "do it"
    ),
    Diagnostic("Y0603", "nowhere", SourceFile("ü/c.yarc", "x"), Span(1, 2, 2, 4)),
    Diagnostic("Y0505", "a note", SourceFile("ü/c.yarc", "x"), Span.on_line(1, 2, 4)),
    Diagnostic("Y1391", "no robot"),
)
FILES = ("a, b:%.yarc", "ü/c.yarc", "-")


def test_github_commands():
    """The output follows GitHub's documentation of workflow commands, with escapes as in actions/toolkit."""
    lines = document("github", FILES, FOUND).splitlines()
    assert len(lines) == len(FOUND)
    for line in lines:
        head, message = re.fullmatch(r"::(?:error|warning|notice) ([^:]*)::(.*)", line).groups()
        properties = dict(pair.split("=") for pair in head.split(","))
        assert properties.keys() <= {"file", "line", "endLine", "col", "endColumn", "title"}
        assert not re.search(r"%(?!25|0D|0A|3A|2C)", head + message)
    assert lines[0] == (
        "::error file=a%2C b%3A%25.yarc,line=3,endLine=3,col=5,endColumn=9,title=Y0601 time-too-short"
        "::100 %25, a: b,%0Ac <&> \x07%0Ado it"
    )
    assert lines[1].startswith("::warning file=ü/c.yarc,line=1,endLine=2,title=")
    assert lines[3] == "::error title=Y1391 no-robot::no robot"


def test_junit():
    """The output has the elements and attributes of the Jenkins schema, junit-10.xsd."""
    for strict, failures in ((False, 2), (True, 3)):
        root = ET.fromstring(document("junit", FILES, FOUND, strict=strict))
        assert root.tag == "testsuites"
        assert (root.get("failures"), root.get("tests")) == (str(failures), "5")
        assert [suite.get("name") for suite in root] == ["a, b:%.yarc", "ü/c.yarc", "<stdin>", "yarc check"]
        for suite in root:
            assert suite.tag == "testsuite"
            assert int(suite.get("tests")) == len(suite)
            assert int(suite.get("failures")) == len(suite.findall("testcase/failure"))
            for case in suite:
                assert case.tag == "testcase"
                assert case.get("name")
                assert case.get("classname") == suite.get("name")
                assert {part.tag for part in case} <= {"failure", "system-out"}


def must(value, kind, required, optional):
    assert isinstance(value, kind)
    if isinstance(value, dict):
        assert set(required) <= value.keys() <= {*required, *optional}, value.keys()


def must_be_region(region):
    must(region, dict, ["startLine"], ["startColumn", "endLine", "endColumn"])
    assert all(isinstance(value, int) and value >= 1 for value in region.values())


def must_be_message(message):
    must(message, dict, ["text"], ["markdown"])
    assert all(isinstance(one, str) and one for one in message.values())


def must_be_artifact(artifact):
    must(artifact, dict, ["uri"], [])
    assert re.fullmatch(r"(?:[A-Za-z0-9._~!$&'()*+,;=:@/-]|%[0-9A-F]{2})+", artifact["uri"])


def test_sarif():
    """The output follows the parts of sarif-schema-2.1.0.json that are used here."""
    log = json.loads(document("sarif", FILES, FOUND))
    must(log, dict, ["version", "runs"], ["$schema"])
    assert log["version"] == "2.1.0"
    (run,) = log["runs"]
    must(run, dict, ["tool", "results"], ["columnKind", "artifacts"])
    assert run["columnKind"] in {"utf16CodeUnits", "unicodeCodePoints"}
    driver = run["tool"]["driver"]
    must(driver, dict, ["name"], ["version", "rules"])
    for artifact in run["artifacts"]:
        must_be_artifact(artifact["location"])
    ids = [rule["id"] for rule in driver["rules"]]
    assert len(set(ids)) == len(ids)
    for rule in driver["rules"]:
        must(
            rule,
            dict,
            ["id"],
            ["name", "shortDescription", "fullDescription", "help", "defaultConfiguration"],
        )
        for key in ("shortDescription", "fullDescription", "help"):
            must_be_message(rule[key])
        assert rule["defaultConfiguration"]["level"] in {"none", "note", "warning", "error"}
    assert len(run["results"]) == len(FOUND)
    for result, one in zip(run["results"], FOUND, strict=True):
        optional = ["ruleId", "ruleIndex", "level", "locations", "fixes", "partialFingerprints"]
        must(result, dict, ["message"], optional)
        assert ids[result["ruleIndex"]] == result["ruleId"] == one.code
        assert result["level"] == one.severity
        must_be_message(result["message"])
        for location in result.get("locations", []):
            physical = location["physicalLocation"]
            must_be_artifact(physical["artifactLocation"])
            must_be_region(physical["region"])


def test_a_fingerprint_stays_with_its_line(here):
    def marks(text):
        Path("a.yarc").write_text(text)
        (run,) = json.loads(check("a.yarc", "--format", "sarif").stdout)["runs"]
        return [one["partialFingerprints"]["codeAndLine/v1"] for one in run["results"]]

    before, moved = marks(BAD + BAD), marks("! a remark\n" + BAD + BAD)
    assert before == moved
    assert len(set(before)) == len(before) > 1
    assert marks(BAD.replace("10 0", "11 0"))[0] != before[0]


def test_sarif_names_the_projects_pages(monkeypatch):
    """A rule links to its page if the package names an address; otherwise the rule contains its page."""
    pages = {"homepage": "https://yarc.example", "documentation": "https://yarc.example/docs/"}
    monkeypatch.setattr(sarif, "addresses", lambda: pages)
    driver = json.loads(document("sarif", FILES, FOUND))["runs"][0]["tool"]["driver"]
    assert driver["informationUri"] == "https://yarc.example"
    for rule in driver["rules"]:
        code = rule["id"]
        assert (
            rule["helpUri"] == f"https://yarc.example/docs/findings#{code.lower()}-{everything()[code].name}"
        )
    monkeypatch.setattr(sarif, "addresses", dict)
    driver = json.loads(document("sarif", FILES, FOUND))["runs"][0]["tool"]["driver"]
    assert "informationUri" not in driver
    assert all("helpUri" not in rule and rule["help"]["markdown"] for rule in driver["rules"])


def test_sarif_of_fixes(here):
    Path("a.yarc").write_text(OLD)
    (run,) = json.loads(check("a.yarc", "--format", "sarif").stdout)["runs"]
    fixes = [fix for result in run["results"] for fix in result["fixes"]]
    assert fixes
    for fix in fixes:
        must(fix, dict, ["artifactChanges"], ["description"])
        must_be_message(fix["description"])
        for change in fix["artifactChanges"]:
            must_be_artifact(change["artifactLocation"])
            assert change["replacements"]
            for replacement in change["replacements"]:
                must(replacement, dict, ["deletedRegion"], ["insertedContent"])
                must_be_region(replacement["deletedRegion"])


@pytest.mark.parametrize("format_", FORMATS)
def test_every_format_says_that_all_is_well(here, format_):
    Path("a.yarc").write_text(GOOD)
    done = check("a.yarc", "--format", format_)
    assert (done.exit_code, done.stderr) == (0, "")


def test_changes(here):
    Path("a.yarc").write_text(GOOD)
    Path("b.yarc").write_text(GOOD)
    steps = iter(
        [lambda: None, lambda: Path("b.yarc").write_text(BAD + GOOD), lambda: Path("yarc.toml").unlink()]
    )
    watch = changes(["."], lambda: next(steps)())  # noqa: PLW0108 (each step is another)
    assert [Path(one).name for one in next(watch)] == ["a.yarc", "b.yarc"]
    # a program may use other files of its folder, so both programs are checked again
    assert [Path(one).name for one in next(watch)] == ["a.yarc", "b.yarc"]
    assert len(next(watch)) == 2


def test_a_changed_table(here):
    Path("a.yarc").write_text(GOOD)
    Path("path.csv").write_text("time")
    steps = iter([lambda: None, lambda: Path("path.csv").write_text("times")])
    watch = changes(["a.yarc"], lambda: next(steps)())  # noqa: PLW0108 (each step is another)
    assert len(next(watch)) == len(next(watch)) == 1
    with pytest.raises(RuntimeError):
        next(watch)  # nothing else has changed


def test_watching(here):
    Path("a.yarc").write_text(GOOD)
    code = "import sys; from yarclang.cli.yarc import main; main(sys.argv[1:])"
    process = subprocess.Popen(
        [sys.executable, "-c", code, "check", "--watch", "--no-plan", "a.yarc"],
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        seen = [process.stderr.readline() for _ in range(2)]
        assert seen[1] == "1 file checked, no problems found\n"
        Path("a.yarc").write_text(BAD)
        while "error Y0202" not in (line := process.stderr.readline()):
            assert line
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 0
    finally:
        process.kill()


def test_foreign_characters_are_fixed(tmp_path):
    path = tmp_path / "a.yarc"
    path.write_text(
        "P0010\u00a0MOVEJ \u221230 0 0 0 0 0 [5] (deg,s)  ! gr\u00f6\u00dfer\u00a0als \u221210\r\n"
        "P0020 STOP\r\n",
        newline="",
    )
    done = CliRunner().invoke(main, ["check", "--robot", "INDUSTRIAL6", str(path)])
    assert done.exit_code == 1
    assert (
        "a.yarc:1:6: error Y0118: U+00A0 no-break space isn't allowed in code, and neither is 1 "
        "more of this statement"
    ) in done.stderr
    assert CliRunner().invoke(main, ["check", "--fix", "--robot", "INDUSTRIAL6", str(path)]).exit_code == 0
    text = "P0010 MOVEJ -30 0 0 0 0 0 [5] (deg,s)  ! gr\u00f6\u00dfer\u00a0als \u221210\r\nP0020 STOP\r\n"
    assert path.read_bytes() == text.encode()


def test_notes_are_counted_and_whole_here_and_one_line_where_a_program_is_used(tmp_path, capsys):
    path = tmp_path / "p.yarc"
    path.write_text((EXAMPLES / "01_listing4.yarc").read_text())
    done = CliRunner().invoke(main, ["check", str(path), "--robot", "INDUSTRIAL6"])
    assert "note Y0505: the curve swings" in done.stderr
    assert done.stderr.endswith("1 file checked: 1 note\n")
    note = Diagnostic("Y0505", "the curve swings", None, None)
    show_without_notes([note, Diagnostic("Y0603", "nothing moves", None, None)], "p.yarc")
    shown = capsys.readouterr().err
    assert "warning Y0603: nothing moves" in shown
    assert "the curve swings" not in shown
    assert shown.endswith("1 note (Y0505): yarc check p.yarc shows it\n")


@pytest.mark.parametrize("line", ["P0010 MOVEJ 0 10 0 0 0 0 [5] (", "LET A =", "P0010 SET GLUE", "REPEAT"])
def test_what_is_missing_at_the_end_of_a_line_is_shown_within_it(here, line):
    Path("a.yarc").write_text(line + "\n")
    found = json.loads(check("a.yarc", "--format", "json").stdout)["diagnostics"]
    assert found
    for one in found:
        if one["line"] == 1:
            assert 1 <= one["column"] < one["end_column"] <= len(line) + 1
