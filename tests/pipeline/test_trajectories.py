"""Tests of files of timed trajectories: found beside a program, refused elsewhere, and read again after a
change.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from programs import codes

from yarclang.hir import TimedMove
from yarclang.memory import Recent
from yarclang.pipeline.checking import check_program_file, check_text
from yarclang.pipeline.incremental import Analyst
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.sources import LARGEST_PROGRAM
from yarclang.pipeline.trajectories import TrajectoryLoader
from yarclang.source import SourceFile

HEAD = "ROBOT INDUSTRIAL6\nDEFAULT [20%] (mm,deg,s) {B}\n"
PROGRAM = HEAD + 'P0010 MOVEJ_TIMED "path.csv"\n'
HEADER = "time,J1,J2,J3,J4,J5,J6\n"
ROWS = HEADER + "1,5,0,0,0,0,0\n2,9,0,0,0,0,0\n"


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "path.csv").write_text(ROWS)
    return tmp_path


def look(text=PROGRAM, **options):
    Path("a.yarc").write_text(text)
    return check_program_file("a.yarc", Options(**options), plans=False)


def tables(checked):
    return [step.table for step in checked.program.steps if isinstance(step, TimedMove)]


def refused(checked):
    (found,) = [one for one in checked.diagnostics if one.is_error]
    assert found.help
    return found


def test_the_rows_of_a_file():
    checked = look()
    assert codes(checked.diagnostics) == []
    (table,) = tables(checked)
    assert table.times.tolist() == [1.0, 2.0]
    assert np.degrees(table.positions[:, 0]) == pytest.approx([5, 9])
    (step,) = [one for one in checked.program.steps if isinstance(one, TimedMove)]
    assert step.file == "path.csv"


def test_a_file_and_lines_say_the_same():
    lines = HEAD + "P0010 MOVEJ_TIMED 5 0 0 0 0 0 [1]; 9 0 0 0 0 0 [2]\n"
    (one,), (other,) = tables(look()), tables(look(lines))
    assert one.positions.tolist() == other.positions.tolist()
    assert one.times.tolist() == other.times.tolist()


def test_units_of_the_line_and_of_default():
    line = HEAD + 'P0010 MOVEJ_TIMED "path.csv" (rad)\n'
    assert refused(look(line)).code == "Y0502"  # 5 rad is beyond the joint's limit
    named = ",".join(["time", *(f"J{n} [deg]" for n in range(1, 7))]) + "\n"
    Path("path.csv").write_text(ROWS.replace(HEADER, named))
    assert np.degrees(tables(look())[0].positions[0, 0]) == pytest.approx(5)
    found = refused(look(line))
    assert (found.code, found.source.name, "but the program's line has rad" in found.message) == (
        "Y1381",
        "path.csv",
        True,
    )


def test_what_is_wrong_stands_in_the_file():
    Path("path.csv").write_text(ROWS.replace("9", "nine"))
    found = refused(look())
    assert (found.code, Path(found.source.name).name, found.span.line, found.span.column) == (
        "Y1382",
        "path.csv",
        3,
        3,
    )


def test_a_fault_in_a_loop_is_said_once():
    Path("path.csv").write_text(ROWS.replace("9", "nine"))
    text = HEAD + 'REPEAT 40\n  P0010 MOVEJ_TIMED "path.csv"\nEND\n'
    assert refused(look(text)).code == "Y1382"


@pytest.mark.parametrize(
    ("path", "code", "words"),
    [
        ("missing.csv", "Y0107", "missing.csv can't be read"),
        ("folder.csv", "Y0107", "it is a folder, not a file"),
        ("x" * 300 + ".csv", "Y0107", "can't be read"),
        ("path.txt", "Y1385", "doesn't end in .csv"),
        ("", "Y1385", "doesn't end in .csv"),
        (".csv/..", "Y1385", "doesn't end in .csv"),
        ("../path.csv", "Y1385", "isn't in the folder"),
        ("/etc/passwd.csv", "Y1385", "isn't in the folder"),
        ("inside/../../other.csv", "Y1385", "isn't in the folder"),
        ("link.csv", "Y1385", "isn't in the folder"),
        ("round.csv", "Y0107", "can't be read"),
        ("fifo.csv", "Y0107", "it is a pipe, not a file"),
        ("big.csv", "Y0107", f"at most {LARGEST_PROGRAM:,} are read"),
        ("wide.csv", "Y0103", "UTF-16"),
        ("zeros.csv", "Y0103", "not text"),
    ],
)
def test_files_that_are_none(here, path, code, words):
    (here / "folder.csv").mkdir()
    (here / "inside").mkdir()
    (here.parent / "other.csv").write_text(ROWS)
    (here / "link.csv").symlink_to(here.parent / "other.csv")
    (here / "round.csv").symlink_to(here / "round.csv")
    os.mkfifo(here / "fifo.csv")
    with (here / "big.csv").open("wb") as file:
        file.truncate(100_000_000)
    (here / "wide.csv").write_text(ROWS, encoding="utf-16")
    (here / "zeros.csv").write_bytes(bytes(1_000_000))
    found = refused(look(HEAD + f'P0010 MOVEJ_TIMED "{path}"\n'))
    assert (found.code, words in found.message) == (code, True), found.message
    if code != "Y0103":
        assert (found.source.name, found.span.line) == ("a.yarc", 3)


@pytest.mark.parametrize("content", [b"\xef\xbb\xbf" + ROWS.encode(), ROWS.replace("\n", "\r\n").encode()])
def test_marks_and_line_ends_of_other_systems(content):
    Path("path.csv").write_bytes(content)
    assert tables(look())[0].times.tolist() == [1.0, 2.0]


def test_a_module_has_files_beside_itself(here):
    (here / "sub").mkdir()
    (here / "TOOL.yarc").write_text('DEFAULT (deg,s)\nSUB OUT\n  P0010 MOVEJ_TIMED "sub/way.csv"\nEND\n')
    (here / "sub" / "way.csv").write_text(ROWS)
    (table,) = tables(look(HEAD + "USE TOOL\nP0010 CALL TOOL.OUT\n"))
    assert table.times.tolist() == [1.0, 2.0]


def test_an_open_text_goes_before_what_is_saved(here):
    texts = {here / "path.csv": SourceFile("path.csv", HEADER + "4,5,0,0,0,0,0\n")}
    assert tables(look(texts=texts))[0].times.tolist() == [4.0]


def test_a_program_without_a_file_has_them_in_its_folder(here):
    checked = check_text(SourceFile("<stdin>", PROGRAM), here, Options(), plans=False)
    assert tables(checked)[0].times.tolist() == [1.0, 2.0]


def test_a_changed_file_is_read_again(here):
    load = TrajectoryLoader(here, memory=Recent(10))
    first = load("path.csv", None).value
    assert load("path.csv", None).value is first
    assert TrajectoryLoader(here)("path.csv", None).value is not first
    (here / "path.csv").write_text(ROWS + "3,1,0,0,0,0,0\n")
    assert load("path.csv", None).value.source.text.endswith("3,1,0,0,0,0,0\n")


def test_an_edited_program_keeps_what_was_read(here):
    analyst = Analyst()
    source = SourceFile(str(here / "a.yarc"), PROGRAM)
    first, again = (analyst.analyse(source, here, quick=True) for _ in range(2))
    assert tables(first.checked)[0] is tables(again.checked)[0]
    (here / "path.csv").write_text(HEADER + "5,5,0,0,0,0,0\n")
    changed = analyst.analyse(source, here, quick=True)
    assert tables(changed.checked)[0].times.tolist() == [5.0]
    (here / "path.csv").unlink()
    assert codes(analyst.analyse(source, here, quick=True).diagnostics) == ["Y0107"]
