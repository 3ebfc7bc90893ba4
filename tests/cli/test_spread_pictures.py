"""`yarc plot` of many programs and `yarc reach` of many robots, in several processes.

The pictures are the same as from one process, and an error costs only one picture.
"""

import shutil

import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main


def yarc(*arguments):
    return CliRunner().invoke(main, [*map(str, arguments)])


def pictures(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*.*"))}


@pytest.fixture
def project(tmp_path, monkeypatch):
    folder = tmp_path / "project"
    (folder / "line").mkdir(parents=True)
    for name in ("02_lines_and_deltas", "03_differential_wrist", "04_old_program"):
        shutil.copy(f"examples/{name}.yarc", folder / "line")
    (folder / "wrong.yarc").write_text("ROBOT INDUSTRIAL6\nP0010 MOVEJ 1 2 3\n")
    monkeypatch.chdir(tmp_path)
    return folder


def test_pictures_are_the_same_in_one_process_and_in_two(project, tmp_path):
    made = [yarc("plot", "project", "--out-dir", f"out{number}", "-j", number) for number in (1, 2)]
    assert [one.exit_code for one in made] == [1, 1]
    one, two = pictures(tmp_path / "out1"), pictures(tmp_path / "out2")
    assert one == two
    assert [path.as_posix() for path in one] == [
        f"line/{name}.png" for name in ("02_lines_and_deltas", "03_differential_wrist", "04_old_program")
    ]
    assert made[0].output.replace("out1", "out2") == made[1].output
    assert "nothing drawn" in made[0].output
    alone = yarc("plot", "project/line/02_lines_and_deltas.yarc", "-o", "alone.png")
    assert alone.exit_code == 0
    assert (tmp_path / "alone.png").read_bytes() == one[next(iter(one))]


def test_reach_of_several_robots(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = yarc("reach", "INDUSTRIAL6", "NOBODY", "TRACKED_MANIPULATOR", "--out-dir", "out")
    assert made.exit_code == 1
    assert "There is no robot 'NOBODY'" in made.output
    names = ["industrial6.reach.png", "tracked_manipulator.reach.png"]
    assert [path.name for path in pictures(tmp_path / "out")] == names
    assert yarc("reach", "INDUSTRIAL6").exit_code == 0
    assert (tmp_path / names[0]).read_bytes() == (tmp_path / "out" / names[0]).read_bytes()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["plot"], "Missing argument"),
        (["plot", "project"], "--out-dir"),
        (["plot", "project", "-o", "a.png", "--out-dir", "b"], "exclude each other"),
        (["plot", "project/wrong.yarc", "project/line/04_old_program.yarc", "-o", "a.png"], "--out-dir"),
        (["plot", "project/wrong.yarc", "project/line/../wrong.yarc", "--out-dir", "out"], "written twice"),
        (["reach", "INDUSTRIAL6", "TRACKED_MANIPULATOR", "-o", "a.png"], "--out-dir"),
        (["reach", "INDUSTRIAL6", "industrial6"], "two robots are named"),
    ],
)
def test_what_makes_no_sense(project, arguments, words):
    made = yarc(*arguments)
    assert made.exit_code == 2, made.output
    assert words in made.output
