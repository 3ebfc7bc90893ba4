"""`yarc export --ros`: files, options and exit statuses; `--moveit` is tested in tests/export."""

import json
import os
import sys

import pytest
import yaml
from click.testing import CliRunner

from yarclang.cli.yarc import main

PROGRAM = (
    "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\nOUTPUT GRIPPER M1\n"
    "P0010 MOVEJ 0 -10 -20 0 -60 0\nP0020 SET GRIPPER ON\nP0030 MOVEJ 5 -10 -20 0 -60 0\n"
)


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "job.yarc").write_text(PROGRAM)


def run(*arguments, **settings):
    return CliRunner().invoke(main, ["export", *arguments], **settings)


def test_the_usual_way(tmp_path):
    made = run("--ros", "job.yarc")
    assert made.exit_code == 0
    assert made.stdout.startswith("2 trajectories, ")
    assert "rad of the certified path by cubic, quintic interpolation; written to job.yaml" in made.stdout
    assert (
        "warning Y1532: 1 output can't be part of a trajectory: P0020 SET: set M1 (GRIPPER) to 1"
        in made.stderr
    )
    text = (tmp_path / "job.yaml").read_text()
    assert text.startswith("# job.yarc: the motion that yarcc has certified")
    assert len(list(yaml.safe_load_all(text))) == 2


def test_standard_streams(tmp_path):
    made = run("--ros", "-", input=PROGRAM)
    assert made.exit_code == 0
    assert len(list(yaml.safe_load_all(made.stdout))) == 2
    assert "written to standard output" in made.stderr
    assert list(tmp_path.glob("*.yaml")) == []


def test_kinds_and_versions(tmp_path):
    assert run("--ros", "job.yarc", "-o", "a.json", "--ros-version", "1", "--linear").exit_code == 0
    said = json.loads((tmp_path / "a.json").read_text())
    assert said["ros"] == 1
    assert set(said["interpolations"]) == {"linear", "cubic", "quintic"}
    assert "secs" in said["trajectories"][0]["trajectory"]["points"][0]["time_from_start"]
    assert run("--ros", "job.yarc", "-o", "a.bag").exit_code == 0
    assert (tmp_path / "a.bag").read_bytes().startswith(b"#ROSBAG V2.0")


def test_a_smaller_tolerance_takes_more_way_points(tmp_path):
    counts = []
    for tolerance in ("0.001", "0.00001"):
        assert run("--ros", "job.yarc", "-o", "a.yaml", "--tolerance", tolerance).exit_code == 0
        text = (tmp_path / "a.yaml").read_text()
        assert f"tolerance {float(tolerance) if tolerance == '0.001' else '1.0e-05'} rad" in text
        counts.append(sum(len(one["points"]) for one in yaml.safe_load_all(text)))
    assert counts[0] < counts[1]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "give one of --moveit, --driver and --ros"),
        (["--moveit", "--ros", "job.yarc"], "give one of --moveit, --driver and --ros"),
        (["--moveit", "--driver"], "give one of --moveit, --driver and --ros"),
        (["--driver", "--linear"], "--linear: only with --ros"),
        (["--driver", "--robot", "INDUSTRIAL6"], "--robot can't be used with --driver"),
        (["--moveit", "--linear"], "--linear: only with --ros"),
        (["--moveit", "--ros-version", "1"], "--ros-version: only with --ros"),
        (["--ros", "job.yarc", "-o", "a.txt"], ".txt can't be written; there are .yaml, .json and .bag"),
        (["--ros", "job.yarc", "-o", "folder"], "the extension selects the file type"),
        (["--ros", "job.yarc", "-o", "a.bag", "--ros-version", "2"], ".bag is a format of ROS 1"),
        (["--ros", "job.yarc", "--tolerance", "0"], "isn't a positive number"),
        (["--ros", "job.yarc", "--tolerance", "1e-9"], "isn't between 1e-06 and 0.1"),
    ],
)
def test_wrong_usage(arguments, said):
    made = run(*arguments)
    assert (made.exit_code, said in made.stderr) == (2, True), made.output


def test_nothing_is_overwritten_unasked(tmp_path):
    (tmp_path / "job.yaml").write_text("mine")
    made = run("--ros", "job.yarc")
    assert (made.exit_code, "job.yaml exists already" in made.stderr) == (2, True)
    assert (tmp_path / "job.yaml").read_text() == "mine"
    assert run("--ros", "job.yarc", "--overwrite").exit_code == 0
    assert (tmp_path / "job.yaml").read_text() != "mine"
    (tmp_path / "odd.json").symlink_to("job.yarc")
    made = run("--ros", "job.yarc", "-o", "odd.json")
    assert (made.exit_code, "would overwrite the source" in made.stderr) == (2, True)
    assert (tmp_path / "job.yarc").read_text() == PROGRAM


@pytest.mark.parametrize(
    ("text", "code"),
    [
        (PROGRAM + "P0040 MOVEJ 1 2\n", "Y0401"),
        (PROGRAM + "P0040 MOVEJ 900 0 0 0 0 0\n", "Y0"),
        ("ROBOT INDUSTRIAL6\nOUTPUT GRIPPER M1\nP0010 SET GRIPPER ON\n", "Y1531"),
        ("ROBOT NOBODY\nP0010 MOVEJ 1 2 3 4 5 6\n", "Y1301"),
        ("", "Y0104"),
    ],
)
def test_a_program_with_errors_leaves_no_file(tmp_path, text, code):
    (tmp_path / "job.yarc").write_text(text)
    made = run("--ros", "job.yarc")
    assert made.exit_code == 1
    assert f"error {code}" in made.stderr
    assert "nothing written" in made.stderr
    assert sorted(one.name for one in tmp_path.iterdir()) == ["job.yarc"]


def test_a_controller_text_is_no_program(tmp_path):
    (tmp_path / "job.pmc").write_text("; yarcc 0.1: job.yarc\n")
    made = run("--ros", "job.pmc", "--robot", "INDUSTRIAL6")
    assert (made.exit_code, "give the .yarc file" in made.stderr) == (1, True)


def test_places_that_cannot_be_written(tmp_path):
    (tmp_path / "folder.yaml").mkdir()
    for place in ("folder.yaml", "/proc/a.yaml", "job.yarc/a.yaml"):
        made = run("--ros", "job.yarc", "-o", place)
        assert (made.exit_code, "error Y0107" in made.stderr) == (1, True), place
        assert "nothing written" in made.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no such device")  # noqa: PTH110
def test_a_full_disk_is_told(tmp_path):
    (tmp_path / "full.yaml").symlink_to("/dev/full")
    made = run("--ros", "job.yarc", "-o", "full.yaml")
    assert (made.exit_code, "no space left on device" in made.stderr) == (1, True)


def test_a_bag_without_the_package(monkeypatch, tmp_path):
    for name in ("rosbags", "rosbags.rosbag1", "rosbags.typesys"):
        monkeypatch.setitem(sys.modules, name, None)
    made = run("--ros", "job.yarc", "-o", "a.bag")
    assert made.exit_code == 1
    assert "error Y1533" in made.stderr
    assert "pip install 'yarclang[bags]'" in made.stderr
    assert not (tmp_path / "a.bag").exists()


def test_a_bag_where_bags_cannot_be_made(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "nothing"))
    made = run("--ros", "job.yarc", "-o", "a.bag")
    assert (made.exit_code, "the folder in which bags are written, can't be used" in made.stderr) == (1, True)


@pytest.mark.parametrize("name", ["a b.yarc", "-x.yarc", "a\nb.yarc", "ö#: [.yarc", "'\".yarc"])
def test_strange_names(tmp_path, name):
    (tmp_path / name).write_text(PROGRAM)
    made = run("--ros", f"./{name}", "-o", "out.yaml")
    assert made.exit_code == 0
    assert len(list(yaml.safe_load_all((tmp_path / "out.yaml").read_text()))) == 2


def test_the_robot_of_the_project_is_exported_for_moveit(tmp_path):
    made = run("--moveit")
    assert made.exit_code == 1
    (tmp_path / "yarc.toml").write_text('robot = "INDUSTRIAL6"\n')
    made = run("--moveit", "-o", "config")
    assert (made.exit_code, made.stdout) == (0, "10 files of industrial6_moveit_config written to config\n")
    made = run("--moveit", "--robot", "NOBODY")
    assert (made.exit_code, "error Y1301" in made.stderr) == (1, True)
