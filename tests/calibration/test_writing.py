"""Tests of writing calibrated values as text, which is read back."""

import shutil

import numpy as np
import pytest
from programs import codes, planned
from scipy.spatial.transform import Rotation

from yarclang.calibration.writing import frame_line, with_offsets, with_tip
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile


@pytest.fixture
def folder(tmp_path):
    ours = load_robot("industrial6").value
    assert ours is not None
    return shutil.copytree(ours.folder, tmp_path / "arm")


def loaded(folder, text):
    (folder / "robot.toml").write_text(text)
    found = load_robot(str(folder))
    assert found.value is not None, found.diagnostics
    return found.value


def source(folder):
    return SourceFile("robot.toml", (folder / "robot.toml").read_text())


def test_offsets_change_only_their_line(folder):
    before = source(folder)
    text = with_offsets(before, np.array([1.234, -5.0, 0.0, 1e6, -0.001, 12345.678]))
    changed = [line for line in text.splitlines() if line not in before.lines]
    assert changed == ["a0 = [1.23, -5, 0, 1000000, 0, 12345.68]  # counts"]
    robot = loaded(folder, text)
    np.testing.assert_allclose(robot.actuation.offset, [1.23, -5.0, 0.0, 1e6, 0.0, 12345.68])


def test_offsets_where_the_file_has_none(folder):
    before = source(folder).text.replace("a0 = [0, 0, 0, 0, 0, 0]  # counts\n", "")
    robot = loaded(folder, with_offsets(SourceFile("robot.toml", before), np.arange(6.0)))
    np.testing.assert_allclose(robot.actuation.offset, np.arange(6.0))


@pytest.mark.parametrize("name", ["TCP", "TORCH"])
def test_a_tip_in_an_old_and_in_a_new_frame(folder, name):
    robot = loaded(folder, with_tip(source(folder), name, np.array([0.0101, -0.2, 0.0305])))
    np.testing.assert_allclose(robot.flange_from_frame[name][:3, 3], [0.0101, -0.2, 0.0305])
    np.testing.assert_allclose(robot.flange_from_frame[name][:3, :3], np.eye(3), atol=1e-12)


def test_ends_of_lines_stay(folder):
    text = source(folder).text.replace("\n", "\r\n")
    new = with_offsets(SourceFile("robot.toml", text), np.arange(6.0))
    assert new.count("\r\n") == new.count("\n") == text.count("\n")
    without = text.replace("a0 = [0, 0, 0, 0, 0, 0]  # counts\r\n", "")
    new = with_offsets(SourceFile("robot.toml", without), np.arange(6.0))
    assert new.count("\r\n") == new.count("\n") == text.count("\n")


def test_an_array_over_several_lines(folder):
    text = source(folder).text.replace(
        "a0 = [0, 0, 0, 0, 0, 0]", "a0 = [\n  0, 0, 0,  # first\n  0, 0, 0,\n]"
    )
    robot = loaded(folder, with_offsets(SourceFile("robot.toml", text), np.arange(6.0)))
    np.testing.assert_allclose(robot.actuation.offset, np.arange(6.0))


@pytest.mark.parametrize("seed", range(5))
def test_a_frame_line_is_read_as_the_frame_that_was_meant(seed):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    pose[:3, 3] = [0.9, 0.1, 0.4]
    line = frame_line("TABLE", pose, "B")
    _plan, found = planned(f"{line}\nP0010 MOVEJ_RPY {{TCP}} 0 100 0 0 0 0 [20] (mm,deg,s) {{TABLE}}\n")
    assert not {"Y0101", "Y0201", "Y0301"} & set(codes(found))
    words = line.split()
    assert words[:2] == ["FRAME", "{TABLE}"]
    assert words[8:] == ["(mm,deg)", "{B}"]
    np.testing.assert_allclose([float(word) for word in words[2:5]], [900, 100, 400])
    turned = Rotation.from_euler("ZYX", [float(word) for word in reversed(words[5:8])], degrees=True)
    np.testing.assert_allclose(turned.as_matrix(), pose[:3, :3], atol=3e-6)


def test_straight_up_has_one_way_to_be_written():
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("ZYX", [30, 90, 0], degrees=True).as_matrix()
    words = frame_line("A", pose, "B").split()[5:8]
    again = Rotation.from_euler("ZYX", [float(word) for word in reversed(words)], degrees=True)
    np.testing.assert_allclose(again.as_matrix(), pose[:3, :3], atol=1e-5)
