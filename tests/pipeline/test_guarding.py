"""Tests of bugs in yarclang itself: whatever the stage and the door, a bug gives one finding with a report
and exit status 1, and all other work goes on.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

import yarclang
import yarclang.lint.engine as lint_engine
import yarclang.syntax.parse as parse_module
from yarclang.backend_pmac import writing
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc
from yarclang.internal_errors import internal_error
from yarclang.motion import routes
from yarclang.pipeline import checking, stages
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.incremental import Analyst
from yarclang.pipeline.inputs import Options
from yarclang.semantics.declared import declaring
from yarclang.source import SourceFile
from yarclang.syntax import form

TEXT = (
    "ROBOT INDUSTRIAL6\n"
    "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n"
    "P0020 BROKEN\n"
    "P0030 MOVEJ 0 0 0 0 0 0 [2] (deg,s)\n"
)
GOOD = TEXT.replace("P0020 BROKEN\n", "")


class Bug(Exception):
    """An exception that no code expects."""


def failing(original, when=lambda *_: True, error=None):
    """Return a function that raises `error` for the arguments that `when` selects, else calls `original`."""

    def failed(*arguments, **named):
        if when(*arguments):
            raise Bug("something\nis wrong \udc80") if error is None else error
        return original(*arguments, **named)

    return failed


PLACES = {
    "parser": (parse_module, "parse_statement"),
    "semantics": (stages, "check"),
    "planning": (stages, "plan"),
    "emission": (writing, "emit"),
    "certificate": (stages, "certify"),
    "rules": (checking, "remarks"),
    "rules in the end": (lint_engine, "rules"),
    "suppression": (checking, "suppress"),
    "opening": (checking, "open_source"),
}


@pytest.fixture(params=PLACES)
def broken(request, monkeypatch):
    """Make one stage fail, and yield its name."""
    module, name = PLACES[request.param]
    monkeypatch.setattr(module, name, failing(getattr(module, name)))
    parse_module._placed.cache_clear()
    yield request.param
    parse_module._placed.cache_clear()


def is_reported(one):
    """Check that an internal error says what to report, and that its text can be encoded."""
    assert one.is_error
    assert one.message == "internal error: Bug: something"
    first, platform, exception, *calls = one.help.split("\n")
    assert "please report" in first
    assert re.fullmatch(r" +yarclang \d+\.\d+\.\d+, Python 3\.\d+\.\d+, \S+ \S+", platform)
    assert exception.endswith(r"Bug: something\u000ais wrong \udc80")
    assert re.search(r"^ +pipeline/test_guarding.py:\d+ in failed$", "\n".join(calls), re.MULTILINE)
    assert str(Path.cwd()) not in one.help
    (one.message + one.help).encode("utf-8")
    return True


def ours(found):
    return [one for one in found if one.code == "Y2001" and is_reported(one)]


def test_the_api(broken):
    assert ours(yarclang.check(GOOD))
    made = yarclang.compile(GOOD)
    assert made.value is None
    assert ours(made.diagnostics)
    if broken in {"parser", "semantics", "planning"}:
        for result in (yarclang.plan(GOOD), yarclang.prove("", GOOD)):
            assert result.value is None
            assert ours(result.diagnostics)
    if broken == "parser":
        assert len(ours(yarclang.parse(GOOD).diagnostics)) == 3
        with pytest.raises(ValueError, match="internal error"):
            yarclang.format(GOOD)


@pytest.mark.parametrize(("main", "words"), [(yarc, ["check"]), (yarcc, [])], ids=["check", "yarcc"])
def test_checks(broken, main, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.yarc").write_text(GOOD)
    Path("b.yarc").write_text("P0010 STOP\n")
    done = CliRunner().invoke(main, [*words, "a.yarc", "b.yarc", "--robot", "INDUSTRIAL6"])
    assert done.exit_code == 1
    assert re.search(r"^a\.yarc:.*error Y2001: internal error: Bug: something$", done.stderr, re.MULTILINE)
    assert "b.yarc" in done.stderr + done.stdout
    assert not Path("a.pmc").exists()
    done = CliRunner().invoke(main, [*words, "a.yarc", "--format", "json", "--robot", "INDUSTRIAL6"])
    assert "Y2001" in json.dumps(json.loads(done.stdout))


@pytest.mark.parametrize(
    "words", [["inspect", "a.yarc", "P0010"], ["plot", "a.yarc"]], ids=["inspect", "plot"]
)
def test_other_doors(broken, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.yarc").write_text(GOOD)
    done = CliRunner().invoke(yarc, words)
    if words[0] == "plot" and broken in {"emission", "certificate", "rules", "rules in the end", "opening"}:
        return  # `yarc plot` uses none of these stages
    assert (done.exit_code, "Y2001" in done.stderr) == (1, True)


def test_what_was_found_before_is_told_all_the_same(monkeypatch):
    monkeypatch.setattr(stages, "plan", failing(None))
    found = yarclang.check(TEXT)
    assert [one.code for one in found if one.code != "Y2001"] == ["Y0202"]
    assert len(ours(found)) == 1


def test_a_statement_that_fails_is_known_and_the_others_are_read(monkeypatch):
    parse_module._placed.cache_clear()
    monkeypatch.setattr(
        parse_module, "parse_statement", failing(parse_module.parse_statement, lambda text: "P0020" in text)
    )
    found = yarclang.check(TEXT + "P0040 NOTHING\n")
    parse_module._placed.cache_clear()
    assert [(one.code, one.span.line) for one in found] == [("Y2001", 3), ("Y0202", 5)]
    assert ours(found)[0].help.endswith("statement: P0020 BROKEN")


@pytest.mark.parametrize(
    "place", [(routes.Router, "_led"), (declaring, "declare_number")], ids=["planning", "declaring"]
)
def test_the_statement_is_found_in_the_calls_that_failed(monkeypatch, place):
    monkeypatch.setattr(*place, failing(None))
    (found,) = ours(yarclang.check(GOOD.replace("P0030", "LET A = 3\nP0030")))
    line = 2 if place[1] == "_led" else 3
    assert (found.code, found.span.line) == ("Y2001", line)
    assert found.help.endswith(
        "\n    statement: " + ("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)" if line == 2 else "LET A = 3")
    )


def test_a_file_that_fails_leaves_the_others(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in "abc":
        Path(f"{name}.yarc").write_text(f"p0010 stop ! {name}\n")
    monkeypatch.setattr(
        form, "print_module", failing(form.print_module, lambda module: "! b" in module.source.text)
    )
    done = CliRunner().invoke(yarc, ["fmt", "."])
    assert done.exit_code == 1
    assert "b.yarc: error Y2001: internal error: Bug: something" in done.stderr
    assert "2 files changed, 1 file left unchanged because of errors" in done.stderr
    assert Path("b.yarc").read_text() == "p0010 stop ! b\n"


def test_any_command(monkeypatch):
    from yarclang.cli.commands import explain

    monkeypatch.setattr(explain.command, "callback", failing(None))
    done = CliRunner().invoke(yarc, ["explain", "Y0101"])
    assert (done.exit_code, "error Y2001: internal error: Bug: something" in done.stderr) == (1, True)
    assert "Traceback" not in done.output
    for error, status in (
        (KeyboardInterrupt(), 1),
        (BrokenPipeError(32, "Broken pipe"), 1),
        (SystemExit(2), 2),
    ):
        monkeypatch.setattr(explain.command, "callback", failing(None, error=error))
        done = CliRunner().invoke(yarc, ["explain", "Y0101"])
        assert (done.exit_code, "Y2001" in done.output) == (status, False)


def test_memory_and_recursion():
    assert internal_error(MemoryError()).code == "Y2003"

    def deeper(level):
        return deeper(level + 1)

    try:
        deeper(0)
    except RecursionError as error:
        found = internal_error(error, SourceFile("a.yarc", "P0010 STOP"))
    assert found.message.startswith("internal error: RecursionError: maximum recursion depth exceeded")
    assert len(found.help.split("\n")) < 12
    assert "more calls" in found.help


def test_memory_that_is_not_enough_is_told(monkeypatch):
    monkeypatch.setattr(stages, "plan", failing(None, error=MemoryError()))
    (found,) = yarclang.check(GOOD)
    assert found.code == "Y2003"


def test_work_that_nobody_waits_for_is_no_failure():
    assert Analyst().analyse(SourceFile("a.yarc", GOOD), Path(), cancelled=lambda: True) is None


def test_an_interruption_is_no_failure(monkeypatch):
    monkeypatch.setattr(stages, "plan", failing(None, error=KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        check_text(SourceFile("a.yarc", GOOD), Path(), Options())


def test_a_description_that_fails(tmp_path, monkeypatch):
    monkeypatch.setattr(checking, "check_description", failing(None))
    (tmp_path / "cell.toml").write_text("")
    done = CliRunner().invoke(yarc, ["check", str(tmp_path / "cell.toml")])
    assert (done.exit_code, "cell.toml: error Y2001" in done.stderr) == (1, True)


def test_ctrl_c_ends_a_check_of_many_files_in_silence(tmp_path):
    for number in range(8):
        lines = (f"P{i:04d} MOVEJ {i % 90} 0 0 0 0 0 [MIN] (deg,s)" for i in range(4000))
        (tmp_path / f"{number}.yarc").write_text("ROBOT INDUSTRIAL6\n" + "\n".join(lines))
    command = [sys.executable, "-c", "from yarclang.cli.yarc import main; main()", "check", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        time.sleep(3)
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=60)
    assert process.returncode == 1
    assert "Traceback" not in told, told[-2000:]


def test_an_interrupt_that_python_has_wrapped_is_one():
    """Old versions of Python turn an interrupt in `__set_name__` into a RuntimeError."""

    class Pressed:
        def __set_name__(self, owner, name):
            raise KeyboardInterrupt

    with pytest.raises((KeyboardInterrupt, RuntimeError)) as raised:
        type("Rule", (), {"text": Pressed()})
    if isinstance(raised.value, RuntimeError):
        with pytest.raises(KeyboardInterrupt):
            internal_error(raised.value)
