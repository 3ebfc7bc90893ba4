"""`yarc fmt`: it is idempotent and keeps comments and meaning.

Exit statuses, standard input and indices are tested as well.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import EXAMPLES
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled

import yarclang
import yarclang.syntax.form as form_module
from yarclang.assist.changes import formatted
from yarclang.campaign.drawing import drawn
from yarclang.cli.yarc import main
from yarclang.independent.arm import Arm
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.print import print_module

ARM = Arm.in_folder(load_robot("INDUSTRIAL6").value.folder)
UGLY = "let a=1!x\nif a=1\np1 movej home [5]   (S)\nend\n"
NEAT = "LET A = 1  !x\nIF A = 1\n  P1 MOVEJ HOME [5] (s)\nEND\n"
_MAP_LINE = re.compile(r"^(; command \S+ \S+ \S+ )\d+", re.MULTILINE)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def fmt(*arguments, text=None):
    return CliRunner().invoke(main, ["fmt", *arguments], input=text)


def test_standard_input():
    done = fmt("-", text=UGLY)
    assert (done.exit_code, done.stdout, done.stderr) == (0, NEAT, "1 file changed\n")
    done = fmt("-", text=NEAT)
    assert (done.exit_code, done.stdout, done.stderr) == (0, NEAT, "1 file already formatted\n")


def test_a_file_is_written(here):
    Path("a.yarc").write_text(UGLY)
    assert fmt("a.yarc").exit_code == 0
    assert Path("a.yarc").read_text() == NEAT


def test_the_files_that_are_changed_are_named(here):
    for name, text in (("a.yarc", UGLY), ("b.yarc", NEAT), ("c.yarc", UGLY)):
        Path(name).write_text(text)
    done = fmt(".")
    assert done.stderr == "changed: a.yarc\nchanged: c.yarc\n2 files changed, 1 file already formatted\n"
    assert fmt(".").stderr == "3 files already formatted\n"


def test_a_line_with_an_exclamation_mark_in_braces_stays(here):
    text = "DEFAULT {!TCP} [5] (mm,deg,s) {B}\np0010 stop\n"
    Path("a.yarc").write_text(text)
    done = fmt("a.yarc")
    assert (done.exit_code, Path("a.yarc").read_text()) == (2, text)
    assert "a.yarc:1:10: error Y0102" in done.stderr


def test_a_form_that_is_not_proved_is_not_written(here, monkeypatch):
    Path("a.yarc").write_text("p0010 stop ! end\np0020 stop\n")
    Path("b.yarc").write_text("p0010 movej home [5](s)\n")
    monkeypatch.setattr(
        form_module, "print_module", lambda tree: print_module(tree).replace("! end", "! the end")
    )
    done = fmt(".")
    assert done.exit_code == 1
    assert "a.yarc:1:1: error Y2002: the formatted line has a different comment" in done.stderr
    assert "please report" in done.stderr
    assert done.stderr.endswith("changed: b.yarc\n1 file changed, 1 file left unchanged because of errors\n")
    assert Path("a.yarc").read_text() == "p0010 stop ! end\np0020 stop\n"
    with pytest.raises(ValueError, match="line 1: the formatted line has a different comment"):
        yarclang.format("p0010 stop ! end\n")
    assert formatted(SourceFile("a.yarc", "p0010 stop ! end\n")) is None
    Path("c.yarc").write_text("P0010 MOVEJ [")
    assert fmt(".").exit_code == 2


def test_modes_and_links_stay(here):
    Path("a.yarc").write_text(UGLY)
    Path("a.yarc").chmod(0o640)
    Path("b.yarc").symlink_to("a.yarc")
    assert fmt("b.yarc").exit_code == 0
    assert Path("b.yarc").is_symlink()
    assert (Path("a.yarc").read_text(), Path("a.yarc").stat().st_mode & 0o777) == (NEAT, 0o640)


@pytest.mark.parametrize("option", ["--check", "--diff"])
def test_nothing_is_written(here, option):
    Path("a.yarc").write_text(UGLY)
    done = fmt(option, "a.yarc")
    assert done.exit_code == 1
    assert Path("a.yarc").read_text() == UGLY
    assert "1 file would be changed" in done.stderr
    assert ("+LET A = 1  !x\n" in done.stdout) == (option == "--diff")
    Path("a.yarc").write_text(NEAT)
    assert fmt(option, "a.yarc").exit_code == 0


@pytest.mark.parametrize("text", ["P0010 MOVEJ [\n", "P0010 MOVEJ \x00\n"])
def test_what_cannot_be_read_stays(here, text):
    Path("bad.yarc").write_text(text)
    Path("good.yarc").write_text(UGLY)
    done = fmt(".")
    assert done.exit_code == 2
    assert "error Y01" in done.stderr
    assert "1 file changed, 1 file left unchanged because of errors" in done.stderr
    assert Path("bad.yarc").read_text() == text
    assert Path("good.yarc").read_text() == NEAT


def test_a_file_that_is_not_there_and_an_empty_folder(here):
    assert fmt("nowhere.yarc").exit_code == 2
    done = fmt(".")
    assert done.exit_code == 2
    assert "no .yarc file" in done.stderr


@pytest.mark.parametrize(
    ("words", "indices"),
    [(["--renumber"], ["P0010", "P0020"]), (["--renumber", "100", "5"], ["P0100", "P0105"])],
)
def test_indices(here, words, indices):
    Path("a.yarc").write_text("P7 MOVEJ 10 0 0 0 0 0 [5] (deg,s)\nP3 STOP\n")
    assert fmt(*words, "a.yarc").exit_code == 0
    assert re.findall(r"^P\d+", Path("a.yarc").read_text(), re.MULTILINE) == indices
    assert fmt("--renumber", "0", "5", "a.yarc").exit_code == 2


def test_line_ends_and_byte_order_mark_stay(here):
    Path("a.yarc").write_bytes(b"\xef\xbb\xbf" + UGLY.replace("\n", "\r\n").encode())
    assert fmt("a.yarc").exit_code == 0
    assert Path("a.yarc").read_bytes() == b"\xef\xbb\xbf" + NEAT.replace("\n", "\r\n").encode()
    assert "already formatted" in fmt("a.yarc").stderr


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yarc")), ids=lambda path: path.stem)
def test_examples_keep_what_they_say(path):
    text = path.read_text()
    again = yarclang.format(text)
    assert yarclang.format(again) == again
    comments = re.compile(r"!.*")
    assert [one.rstrip() for one in comments.findall(again)] == [
        one.rstrip() for one in comments.findall(text)
    ]
    assert again.count("\n\n") == text.count("\n\n")


def roughened(text, random):
    """Return the same program with irregular spaces, cases, blank lines and comments."""
    lines = []
    for line in text.splitlines():
        words = line.split(" ")
        words = [word.lower() if random.random() < 0.5 else word for word in words]
        rough = "".join(word + " " * int(random.integers(1, 4)) for word in words)
        comment = f"! note {len(lines)}" if random.random() < 0.3 else ""
        lines += [""] * int(random.integers(0, 3)) + [rough + comment]
    return "\n".join(lines) + "\n"


def without_lines(text):
    """Return a controller text without its seal and without the source lines in its map."""
    return re.sub(r"(?m)^; sha256 .*$", "", _MAP_LINE.sub(r"\1-", text))


@exercises(compiled=0.1)
@given(seed=st.integers(0, 10_000))
@settings(max_examples=12)
def test_random_programs_compile_to_the_same_text(tally, seed):
    random = np.random.default_rng(seed)
    text = roughened(drawn(ARM, random, most=3).text, random)
    again = yarclang.format(text)
    assert yarclang.format(again) == again
    assert re.findall(r"! note \d+", again) == re.findall(r"! note \d+", text)
    before, after = (compiled(one)[0] for one in (text, again))
    assert (before is None) == (after is None)
    tally.count("compiled", before is not None)
    if before is not None:
        assert without_lines(after.text) == without_lines(before.text)
