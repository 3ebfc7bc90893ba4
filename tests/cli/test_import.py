"""`yarc import`: files, options and exit statuses; its output compiles."""

import numpy as np
import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main

TABLE = "j1,j2,j3,j4,j5,j6\n0,-10,-20,0,-60,0\n5,-10,-20,0,-60,0\n10,-15,-20,0,-60,0\n"
TIMED = "t [s],j1 [deg],j2 [deg],j3 [deg],j4 [deg],j5 [deg],j6 [deg]\n" + "".join(
    f"{n},{n * n},{-10 - n},-20,0,-60,0\n" for n in range(6)
)


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(*arguments, **settings):
    return CliRunner().invoke(main, list(arguments), **settings)


@pytest.mark.parametrize("text", [TABLE, TIMED])
def test_what_it_writes_compiles(tmp_path, text):
    (tmp_path / "points.csv").write_text("\ufeff" + text, encoding="utf-8")
    made = run("import", "points.csv", "--robot", "INDUSTRIAL6", "--units", "deg")
    assert (made.exit_code, made.stdout) == (0, "written to points.yarc; plan it with yarc check\n")
    checked = run("check", "points.yarc")
    assert (checked.exit_code, "error" in checked.stderr) == (0, False)


def test_the_robot_of_the_project_and_standard_streams(tmp_path):
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    made = run("import", "-", "--units", "deg", input=TABLE)
    assert made.exit_code == 0
    assert made.stdout.startswith("! <stdin>: a table of 3 joint positions.\nROBOT INDUSTRIAL6\n")
    assert list(tmp_path.glob("*.yarc")) == []


def test_a_robot_of_ones_own_is_told(tmp_path, industrial6):
    for file in industrial6.folder.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    made = run("import", "-", "--units", "deg", "--robot", "robot.toml", input=TABLE)
    assert made.exit_code == 0
    assert "ROBOT" not in made.stdout.replace("--robot", "")
    assert "! Made for INDUSTRIAL6, which --robot or yarc.toml has to name." in made.stdout


def test_nothing_is_overwritten_unasked(tmp_path):
    (tmp_path / "points.csv").write_text(TABLE)
    (tmp_path / "points.yarc").write_text("! mine\n")
    arguments = ["import", "points.csv", "--robot", "INDUSTRIAL6", "--units", "deg"]
    refused = run(*arguments)
    assert (refused.exit_code, "points.yarc exists already" in refused.stderr) == (2, True)
    assert (tmp_path / "points.yarc").read_text() == "! mine\n"
    assert run(*arguments, "-o", "points.csv").exit_code == 2
    assert run(*arguments, "-o", "points.yarc").exit_code == 0
    assert (tmp_path / "points.yarc").read_text() != "! mine\n"


LONG = TIMED.splitlines()[0] + "\n" + "".join(
    f"{n / 5},{n * n / 60},{-10 - n / 4},-20,0,-60,0\n" for n in range(40)
)  # fmt: skip


def test_long_lists_stand_in_a_file_beside_the_program(tmp_path):
    (tmp_path / "arm.csv").write_text(LONG)
    made = run("import", "arm.csv", "--robot", "INDUSTRIAL6")
    assert (made.exit_code, made.stdout) == (
        0,
        "written to arm.yarc and arm_path.csv; plan it with yarc check\n",
    )
    assert (tmp_path / "arm.yarc").read_text().endswith('MOVEJ_TIMED "arm_path.csv"\n')
    assert len((tmp_path / "arm_path.csv").read_text().splitlines()) == 41
    checked = run("check", "--no-plan", "arm.yarc")
    assert (checked.exit_code, checked.stderr) == (0, "1 file checked, no problems found\n")
    # the exported path can be imported again
    again = run("import", "arm_path.csv", "--robot", "INDUSTRIAL6", "-o", "again.yarc")
    assert again.exit_code == 0
    one, other = (np.loadtxt(f"{name}_path.csv", delimiter=",", skiprows=1) for name in ("arm", "again"))
    assert np.abs(one - other).max() < 1e-15


def test_no_table_is_overwritten_unasked(tmp_path):
    (tmp_path / "arm.csv").write_text(LONG)
    (tmp_path / "arm_path.csv").write_text("mine")
    arguments = ["import", "arm.csv", "--robot", "INDUSTRIAL6"]
    refused = run(*arguments)
    assert (refused.exit_code, "arm_path.csv exists already" in refused.stderr) == (2, True)
    assert not (tmp_path / "arm.yarc").exists()
    assert run(*arguments, "-o", "arm.yarc").exit_code == 0
    assert (tmp_path / "arm_path.csv").read_text() != "mine"
    (tmp_path / "new_path.csv").write_text(LONG)
    refused = run("import", "new_path.csv", "--robot", "INDUSTRIAL6", "-o", "new.yarc")
    assert (refused.exit_code, "would overwrite the source new_path.csv" in refused.stderr) == (2, True)


def test_on_standard_output_all_stands_in_the_program(tmp_path):
    made = run("import", "-", "--robot", "INDUSTRIAL6", input=LONG)
    assert made.exit_code == 0
    assert made.stdout.count("[") == 41
    assert list(tmp_path.iterdir()) == []


def test_names_that_a_program_cannot_quote(tmp_path):
    (tmp_path / 'a"b!.csv').write_text(LONG)
    assert run("import", 'a"b!.csv', "--robot", "INDUSTRIAL6").exit_code == 0
    assert run("check", "--no-plan", 'a"b!.yarc').exit_code == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--as", "timed", "--time", "30"], "leave --time out"),
        (["--topic", "/plan"], "--topic is for bags"),
    ],
)
def test_options_that_exclude_each_other(tmp_path, arguments, words):
    (tmp_path / "arm.csv").write_text(LONG)
    refused = run("import", "arm.csv", "--robot", "INDUSTRIAL6", *arguments)
    assert (refused.exit_code, words in refused.stderr) == (2, True)


def test_a_mistake_leaves_no_file(tmp_path):
    (tmp_path / "points.csv").write_text(TABLE + "1,2,x,4,5,6\n")
    made = run("import", "points.csv", "--robot", "INDUSTRIAL6", "--units", "deg")
    assert made.exit_code == 1
    assert "points.csv:5:1: error Y1505: 'x' in column 'j3' isn't a number" in made.stderr
    assert "1 error; nothing written" in made.stderr
    assert not (tmp_path / "points.yarc").exists()


@pytest.mark.parametrize(
    ("content", "code"),
    [(b"", "Y1504"), (b"\xff\xfej\x001\x00", "Y0103"), (b"j1,\xe4\n", "Y0103"), (b"PK\x03\x04", "Y0103")],
)
def test_files_that_are_no_text(tmp_path, content, code):
    (tmp_path / "points.csv").write_bytes(content)
    made = run("import", "points.csv", "--robot", "INDUSTRIAL6")
    assert made.exit_code == 1
    assert f"error {code}" in made.stderr


@pytest.mark.parametrize(
    "options",
    [
        ["--units", "deg,rad"],
        ["--units", "furlong"],
        ["--time", "soon"],
        ["--time", "0"],
        ["--time", "1.2.3"],
        ["--every", "0"],
        ["--tolerance", "-1"],
        ["--as", "circle"],
    ],
)
def test_wrong_usage(options):
    assert run("import", "-", "--robot", "INDUSTRIAL6", *options, input=TABLE).exit_code == 2


@pytest.mark.parametrize("time", ["MIN", "min", "50%", "12.5"])
def test_another_time(time):
    made = run("import", "-", "--robot", "INDUSTRIAL6", "--time", time, input=TIMED)
    assert f"[{time.upper()}] (mm,deg,s)" in made.stdout


def test_no_robot_and_no_file():
    assert "Y1391" in run("import", "-", input=TABLE).stderr
    missing = run("import", "nowhere.csv", "--robot", "INDUSTRIAL6")
    assert (missing.exit_code, "Y0107" in missing.stderr) == (1, True)


def test_a_file_of_named_states_is_nearly_a_module(tmp_path):
    joints = "".join(f'<joint name="J{number}" value="0.1"/>' for number in range(1, 7))
    text = f'<robot name="arm"><group_state name="ready" group="arm">{joints}</group_state></robot>'
    (tmp_path / "poses.srdf").write_text(text)
    assert run("import", "poses.srdf", "--robot", "INDUSTRIAL6").exit_code == 0
    assert run("check", "poses.yarc").exit_code == 0
    lines = (tmp_path / "poses.yarc").read_text().splitlines()
    kept = [line for line in lines if not line.startswith("ROBOT") and not line.endswith("STOP")]
    (tmp_path / "poses.yarc").write_text("\n".join(kept))
    (tmp_path / "main.yarc").write_text("ROBOT INDUSTRIAL6\nUSE POSES\nP0010 MOVEJ POSES.READY [MIN]\n")
    assert run("check", "main.yarc").exit_code == 0


def test_times_that_break_limits_are_told_by_the_check(tmp_path):
    (tmp_path / "fast.csv").write_text(TIMED.replace("t [s]", "t [ms]"))
    assert run("import", "fast.csv", "--robot", "INDUSTRIAL6").exit_code == 0
    found = run("check", "fast.yarc").stderr
    assert "Y0616" in found or "Y0617" in found
    assert (
        run("import", "fast.csv", "--robot", "INDUSTRIAL6", "--time", "MIN", "-o", "min.yarc").exit_code == 0
    )
    assert run("check", "min.yarc").exit_code == 0
