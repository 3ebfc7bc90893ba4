"""Tests of the exported package of ROS nodes: it runs without yarclang, ROS's own tools read it, and the
export overwrites no file of the user.
"""

import ast
import json
import os
import shutil
import stat
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

import yarclang
from yarclang.cli.yarc import main

NODE = Path(yarclang.__file__).parent / "ros" / "node"
PYTHON = "/usr/bin/python3"
NODES = sorted(one.stem for one in NODE.glob("ros[12].py"))
ALONE = """
import importlib, sys
from pathlib import Path
lib = Path(sys.argv[1])
sys.path.insert(0, str(lib))
for path in sorted(lib.rglob("*.py")):
    name = ".".join(path.relative_to(lib).with_suffix("").parts)
    try:
        module = importlib.import_module(name.replace(".__init__", ""))
    except ImportError as missing:
        assert not str(missing.name).startswith("yarclang"), missing
        print(name, missing.name)
        continue
    assert Path(module.__file__).is_relative_to(lib), module.__file__
for name in ("numpy", "pydantic", "click", "lark"):
    assert name not in sys.modules, name
"""


def run(*arguments):
    return CliRunner().invoke(main, ["export", "--driver", *arguments])


@pytest.fixture
def package(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = run()
    assert made.exit_code == 0, made.output
    assert f"{len(files_of(tmp_path / 'yarc_driver'))} files of yarc_driver" in made.stdout
    return tmp_path / "yarc_driver"


def files_of(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def system_python(*arguments):
    environment = {"PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        [PYTHON, *arguments],
        check=False,
        env=environment,
        cwd="/",
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.skipif(not os.access(PYTHON, os.X_OK), reason="no Python of the system")
def test_the_modules_are_alone(package):
    """Only ROS's own libraries may be missing from the package's modules."""
    done = system_python("-c", ALONE, str(package / "lib"))
    assert done.returncode == 0, done.stderr
    missing = {line.split(" ")[1].partition(".")[0] for line in done.stdout.splitlines()}
    assert missing <= {"rospy", "rosgraph", "rclpy", "actionlib", "genpy", "control_msgs"}


def test_all_of_it_is_python_3_8(package):
    programs = [*package.rglob("*.py"), *(package / "scripts").iterdir()]
    assert len(programs) > 8
    for path in programs:
        ast.parse(path.read_text(), feature_version=(3, 8))


def test_the_modules_are_those_of_this_installation(package):
    for path in NODE.glob("*.py"):
        assert (package / "lib/yarclang/ros/node" / path.name).read_bytes() == path.read_bytes()
    client = Path(yarclang.__file__).parent / "client.py"
    assert (package / "lib/yarclang/client.py").read_bytes() == client.read_bytes()


def test_scripts_can_be_run_and_nothing_else(package):
    for path in package.rglob("*"):
        if path.is_file():
            is_script = path.parent.name == "scripts"
            assert bool(path.stat().st_mode & stat.S_IXUSR) is is_script
            assert path.read_text().startswith("#!/usr/bin/python3\n") is is_script


@pytest.mark.skipif(not os.access(PYTHON, os.X_OK), reason="no Python of the system")
@pytest.mark.parametrize("name", NODES)
@pytest.mark.parametrize("place", ["source", "installed", "linked"])
def test_scripts_find_their_modules_wherever_they_are_installed(package, tmp_path, place, name):
    script = package / "scripts" / f"yarc_{name}"
    if place != "source":
        there = tmp_path / "install" / "lib" / "yarc_driver" / script.name
        there.parent.mkdir(parents=True)
        (tmp_path / "install" / "share").mkdir()
        if place == "linked":
            there.symlink_to(script)
        else:
            shutil.copy(script, there)
            shutil.copytree(package, tmp_path / "install" / "share" / "yarc_driver")
            shutil.rmtree(package)
        script = there
    done = system_python(str(script), "--help")
    assert (done.returncode, "yarc serve" in done.stdout) == (0, True), done.stderr
    for lib in tmp_path.rglob("lib/yarclang"):
        shutil.rmtree(lib)
    assert "lib of the package yarc_driver isn't there" in system_python(str(script)).stderr


def test_what_ros_reads_is_well_formed(package):
    root = ET.parse(package / "package.xml").getroot()
    assert root.findtext("name") == "yarc_driver"
    assert root.findtext("version") == yarclang.__version__
    launch = ET.parse(package / "launch" / "yarc.launch").getroot()
    declared = {one.get("name") for one in launch.findall("arg")}
    used = {
        text.partition(")")[0]
        for one in launch.iter()
        for value in one.attrib.values()
        for text in value.split("$(arg ")[1:]
    }
    assert used == declared
    for version, name in (("1", "yarc.rviz"), ("2", "yarc_ros2.rviz")):
        told = yaml.safe_load((package / "rviz" / name).read_text())["Visualization Manager"]
        shown = {one["Name"]: one for one in told["Displays"]}
        assert shown["TF"]["Enabled"] is False
        topics = [
            shown[each]["Marker Topic"] if version == "1" else shown[each]["Topic"]["Value"]
            for each in ("Scene", "Ghost")
        ]
        assert topics == ["/yarc_driver/scene", "/yarc_driver/ghost"]
        classes = {one["Class"].split("/")[1] for one in told["Displays"]}
        assert classes == {"Grid", "RobotModel", "TF", "MarkerArray"}


def test_ros_own_reader_takes_the_package(package):
    for version, build in (("1", "catkin"), ("2", "ament_cmake")):
        text = (
            "import sys; from catkin_pkg.package import parse_package; made = parse_package(sys.argv[1]); "
            f"made.evaluate_conditions({{'ROS_VERSION': '{version}'}}); print(made.get_build_type(), "
            "*(one.name for one in made.exec_depends if one.evaluated_condition))"
        )
        done = system_python("-c", text, str(package))
        if "No module named 'catkin_pkg'" in done.stderr:
            pytest.skip("no catkin_pkg")
        assert done.returncode == 0, done.stderr
        said = done.stdout.split()
        assert said[0] == build
        assert ("rospy" in said, "rclpy" in said) == (version == "1", version == "2")


def test_what_an_export_has_written_is_written_again_and_nothing_else(package):
    before = files_of(package)
    (package / "mine.txt").write_text("mine")
    (package / "lib/yarclang/client.py").write_text("changed")
    made = run()
    assert (made.exit_code, "Y1536" in made.stderr, "client.py" in made.stderr) == (1, True, True)
    assert (package / "lib/yarclang/client.py").read_text() == "changed"
    assert run("--overwrite").exit_code == 0
    assert files_of(package) == {**before, "mine.txt": b"mine"}
    listed = json.loads(before["yarc-export.json"])["files"]
    assert {*listed, "yarc-export.json"} == {*before}


def test_the_folder_of_somebody_else_stays(tmp_path):
    (tmp_path / "there" / "launch").mkdir(parents=True)
    (tmp_path / "there" / "launch" / "yarc.launch").write_text("mine")
    made = run("-o", str(tmp_path / "there"))
    assert (made.exit_code, "Y1536" in made.stderr) == (1, True)
    assert [*files_of(tmp_path / "there")] == ["launch/yarc.launch"]
    (tmp_path / "file").write_text("")
    assert run("-o", str(tmp_path / "file")).exit_code == 1
    assert run("-o", "/proc/there").exit_code == 1
