"""`cell` in yarc.toml, `--cell`, and CELL lines: every command uses the one cell, and names it."""

import json
import signal
import time

import numpy as np
import pytest
from click.testing import CliRunner

from tests.cli.test_follow import asked, connected, lines_of, listening
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.robot.kinematics.fk import tool_poses

TABLE = """\
units = "mm,deg"
[frames.TABLE]
parent = "B"
xyz = [0, 1174.4, 1300]
rpy = [0, 0, 0]

[[obstacles]]
name = "TABLE"
frame = "TABLE"
shape = "box"
size = [1200, 1200, 100]
"""
BELOW = "DEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 DMOVE 0 0 -600 0 0 0\n"
ABOVE = "DEFAULT {TCP} [1] (mm,deg,s) {B}\nP0010 DMOVE 0 0 -20 0 0 0\n"
NAMES = "DEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 0 300 0 0 0 {TABLE}\n"


@pytest.fixture
def project(tmp_path, monkeypatch):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (tmp_path / "cell.toml").write_text(TABLE)
    (tmp_path / "other.toml").write_text(TABLE)
    (tmp_path / "sub").mkdir()
    texts = {"below": BELOW, "above": ABOVE, "names": NAMES, "same": f'CELL "cell.toml"\n{NAMES}'}
    texts |= {"other": f'CELL "other.toml"\n{ABOVE}', "sub/same": f'CELL "../cell.toml"\n{NAMES}'}
    texts["sub/below"] = BELOW
    for name, text in texts.items():
        (tmp_path / f"{name}.yarc").write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def yarc(*arguments):
    done = CliRunner().invoke(main, arguments)
    assert "Traceback" not in done.output
    return done


@pytest.mark.parametrize("file", ["below.yarc", "sub/below.yarc", "-"])
def test_a_program_keeps_to_the_cell_of_its_project(project, file):
    for command, *options in (("check",), ("run", "--no-log"), ("exec", "--no-log"), ("inspect", "P0010")):
        done = CliRunner().invoke(main, [command, file, *options], input=BELOW)
        assert done.exit_code == 1
        assert "Y0901" in done.output
    done = CliRunner().invoke(yarcc, [file, "-o", "-"], input=BELOW)
    assert (done.exit_code, done.stdout) == (1, "")


@pytest.mark.parametrize("file", ["names.yarc", "same.yarc", "sub/same.yarc"])
def test_the_names_of_the_cell_are_known_with_and_without_its_line(project, file):
    done = yarc("check", file)
    assert done.exit_code == 0, done.output
    assert yarc("check", file, "--cell", "sub/../cell.toml").exit_code == 0
    assert yarc("plot", file, "-o", "a.png").exit_code == 0


def test_without_a_project_the_command_line_names_the_cell(project):
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    assert yarc("check", "below.yarc").exit_code == 0
    assert "Y0901" in yarc("check", "below.yarc", "--cell", "cell.toml").output
    assert "Y0901" in yarc("diff", "above.yarc", "below.yarc", "--cell", "cell.toml").output
    assert yarc("check", "same.yarc", "--cell", "cell.toml").exit_code == 0
    done = yarc("check", "other.yarc", "--cell", "cell.toml")
    assert done.exit_code == 1
    assert (
        "Y1373: two cells are named: other.toml by the CELL line, cell.toml by the command line"
        in done.output
    )
    assert "remove the CELL line, or remove --cell" in done.output


def test_two_files_are_a_conflict_that_names_both(project):
    done = yarc("check", "other.yarc")
    assert done.exit_code == 1
    assert (
        "other.yarc:1:6: error Y1373: two cells are named: other.toml by the CELL line, cell.toml by "
        "yarc.toml"
    ) in done.output
    assert "remove the CELL line, or change cell in yarc.toml" in done.output
    for command in ("check", "run", "exec", "view"):
        done = yarc(command, "above.yarc", "--cell", "other.toml")
        assert done.exit_code == 1
        assert "yarc.toml names the cell cell.toml, but the command line names other.toml" in done.output
    assert yarc("repl", "--cell", "other.toml").exit_code == 1
    assert yarc("follow", "--cell", "other.toml").exit_code == 1


def test_a_module_names_the_same_cell_or_none(project):
    module = 'CELL "{}"\nSUB GO\n  P0010 MOVEJ_RPY {{TCP}} 0 0 300 0 0 0 [5] (mm,deg,s) {{TABLE}}\nEND\n'
    (project / "part.yarc").write_text(module.format("cell.toml"))
    (project / "user.yarc").write_text("USE PART\nP0010 CALL PART.GO\n")
    assert yarc("check", "user.yarc").exit_code == 0
    (project / "part.yarc").write_text(module.format("other.toml"))
    assert "part.yarc:1:6: error Y1373" in yarc("check", "user.yarc").output


@pytest.mark.parametrize(
    ("entry", "code", "place"),
    [("cell = 5", "Y1393", "1:1"), ('cell = ""', "Y1393", "1:1"), ('cell = "no.toml"', "Y1302", "1:8")],
)
def test_an_entry_that_is_wrong_is_told_where_it_stands(project, entry, code, place):
    (project / "yarc.toml").write_text(f'{entry}\nrobot = "INDUSTRIAL6"\n')
    for file in ("above.yarc", "yarc.toml"):
        done = yarc("check", file)
        assert done.exit_code == 1
        assert f"yarc.toml:{place}: error {code}" in done.output
    assert yarc("repl").exit_code == 1
    assert yarc("follow").exit_code == 1


def test_a_mistake_in_the_cell_is_told_in_its_file(project):
    (project / "cell.toml").write_text(TABLE.replace('"box"', '"bax"'))
    done = yarc("check", "above.yarc")
    assert done.exit_code == 1
    assert "cell.toml:10:9: error Y1308" in done.output


def test_a_compiled_program_keeps_to_the_cell_of_its_folder(project):
    """A controller text is checked with the cell of its folder.

    This also holds if it was compiled before there was a cell, and if its program is unknown.
    """
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    assert CliRunner().invoke(yarcc, ["below.yarc"]).exit_code == 0
    (project / "alone").mkdir()
    (project / "alone" / "a.pmc").write_text((project / "below.pmc").read_text())
    for file in ("below.pmc", "alone/a.pmc"):
        assert yarc("check", file).exit_code == 0
        assert yarc("check", file, "--cell", "cell.toml").exit_code == 1
    (project / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    for file in ("below.pmc", "alone/a.pmc"):
        assert yarc("check", file).exit_code == 1
        assert yarc("run", file, "--no-log").exit_code == 1


def test_a_program_elsewhere_with_another_cell_does_not_prove_a_text(project):
    (project / "left").mkdir()
    (project / "left" / "yarc.toml").write_text('cell = "../other.toml"\n')
    (project / "left" / "above.yarc").write_text(ABOVE)
    assert CliRunner().invoke(yarcc, ["above.yarc"]).exit_code == 0
    done = yarc("run", "above.pmc", "--source", "left/above.yarc", "--no-log")
    assert done.exit_code == 1
    assert "Y1373" in done.output


def test_each_says_at_the_start_which_cell_it_keeps_to(project, monkeypatch):
    done = yarc("run", "above.yarc", "--no-log", "--rate", "50")
    assert (done.exit_code, done.stderr.splitlines()[0]) == (0, "cell: cell.toml")
    first = json.loads(yarc("exec", "above.yarc", "--no-log", "--rate", "50").stdout.splitlines()[0])
    assert (first["event"], first["text"]) == ("message", "cell: cell.toml")
    done = CliRunner().invoke(main, ["repl", "--no-log"], input=".where\n")
    assert (done.exit_code, done.stderr.splitlines()[1]) == (0, "cell: cell.toml")
    monkeypatch.setattr("yarclang.view.show.show", lambda stage, door, ready: None)
    CliRunner().invoke(yarcc, ["above.yarc"])
    (project / "above.yarc").rename(project / "gone.yarc")
    for file in ("gone.yarc", "above.pmc"):
        assert yarc("view", file, "--no-browser").stderr.splitlines()[0] == "cell: cell.toml"


def test_a_master_cannot_steer_through_the_table(workshop, industrial6):
    """The robot follows the master down to the table, but not into it."""
    (workshop.folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    (workshop.folder / "cell.toml").write_text(TABLE.replace("1300", "1600"))
    process = workshop.start("follow", "--no-log")
    event = listening(process)
    assert event["cell"] == str(workshop.folder / "cell.toml")
    with connected(event) as lines:
        for _ in range(250):
            assert asked(lines, '{"twist": [0, 0, -80, 0, 0, 0]}')["ok"]
            time.sleep(0.02)
    process.signal(signal.SIGTERM)
    joints = np.array([[*lines_of(process.end(0))[-1]["joints"].values()]])
    tip = industrial6.flange_from_frame["TCP"]
    (pose,) = tool_poses(industrial6.chain, joints * industrial6.axis_units, tip)
    # the lowest link is a little above the table, whose top is at 1650 mm
    assert 1.66 < pose[2, 3] < 1.764 - 0.01
    assert any("too close to TABLE" in text for text in process.out)


def test_a_served_robot_keeps_to_its_cell_whoever_comes(workshop):
    """The server's cell also holds for the prompt and for programs without a cell.

    Programs with another cell are refused.
    """
    (workshop.folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\ncell = "cell.toml"\n')
    for name in ("cell.toml", "other.toml"):
        (workshop.folder / name).write_text(TABLE)
    process = workshop.start("serve", "--no-log")
    process.wait_for("is served")
    process.wait_for("cell: cell.toml")
    (workshop.folder / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    (workshop.folder / "below.yarc").write_text(BELOW)
    told = workshop.yarc("exec", "below.yarc", status=1)
    assert "Y0901" in told
    assert "cell: cell.toml" in told
    assert "cell: cell.toml" in workshop.yarc("run", "below.yarc", status=1)
    assert "Y1373" in workshop.yarc("exec", "below.yarc", "--cell", "other.toml", status=1)
    assert "Y1373" in workshop.yarc("follow", "--cell", "other.toml", status=1)
    process.signal(signal.SIGTERM)
    process.end(0)
