"""Tests of the names J1, J2 and so on, which can be used beside the joint names of the URDF."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import codes, robot_of, source

from yarclang.cell.description import Names, read_cell
from yarclang.cell.model import JointWindow
from yarclang.coordinator.live.drive import joint_target
from yarclang.repl.dots.calibrating import Misused, _marks
from yarclang.repl.jogging import axis_of
from yarclang.report.robot import robot_text
from yarclang.robot.joint_names import (
    has_short_names,
    joint_labels,
    joint_number,
    listed_joints,
    numbers_by_name,
    short_labels,
)

LONG = (
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
)
names = st.lists(
    st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,5}", fullmatch=True)
    | st.from_regex(r"[jJ][0-9]", fullmatch=True),
    min_size=1,
    max_size=8,
    unique_by=str.upper,
)


@given(names)
def test_each_name_means_one_joint(found):
    by_name = numbers_by_name(found)
    for number, name in enumerate(found):
        assert joint_number(found, name) == joint_number(found, name.lower()) == number
    if has_short_names(found):
        assert [joint_number(found, f"j{number}") for number in range(1, len(found) + 1)] == [
            *range(len(found))
        ]
        assert len(by_name) == 2 * len(found)
    else:
        assert len(by_name) == len(found)
    assert [joint_number(found, one) for one in short_labels(found)] == [*range(len(found))]
    assert all(name in label for name, label in zip(found, joint_labels(found), strict=True))


def test_own_numbers_hold_alone():
    """If the URDF's joints are called J0 to J5, only these names are used. Otherwise J1 could mean two
    joints.
    """
    own = tuple(f"J{number}" for number in range(6))
    assert joint_number(own, "J1") == 1
    assert joint_number(own, "J6") is None
    assert joint_labels(own) == own
    assert listed_joints(LONG[:2]) == "J1 (shoulder_pan_joint), J2 (shoulder_lift_joint)"


ARM = replace(robot_of("INDUSTRIAL6"), joint_names=LONG)


def test_a_joint_is_named_in_either_way_at_the_doors():
    for name in ("J2", "j2", "shoulder_lift_joint", "SHOULDER_LIFT_JOINT"):
        assert axis_of(ARM, [name, "-"])[0].number == 1
        assert np.argmax(joint_target(ARM, name, 0.1).velocity) == 1
        assert list(_marks(ARM, [name, "90"])) == ["shoulder_lift_joint"]
    assert "J2 shoulder_lift_joint" in robot_text(ARM)


def window(joints):
    """Return the result of reading a cell with a window of joint positions."""
    text = (
        'units = "mm,deg,s"\n'
        "[[zones]]\n"
        'name = "A"\n'
        'rule = "allowed"\n'
        'shape = "joints"\n'
        f"joints = {{ {joints} }}\n"
    )
    return read_cell(source(text, "cell.toml"), Path(), Names(lambda _name: False, ARM))


def test_windows_of_zones():
    for name in ("J2", "shoulder_lift_joint"):
        result = window(f"{name} = [-90, 45]")
        assert codes(result.diagnostics) == []
        region = result.value.zones[0].region
        assert isinstance(region, JointWindow)
        assert np.degrees(region.lower)[1] == pytest.approx(-90)
    twice = window("J2 = [-90, 45], shoulder_lift_joint = [0, 5]")
    assert codes(twice.diagnostics) == ["Y1372"]
    assert "twice: J2 and shoulder_lift_joint" in twice.diagnostics[0].message


def test_a_joint_is_marked_once():
    with pytest.raises(Misused, match="named twice"):
        _marks(ARM, ["J2", "90", "shoulder_lift_joint", "80"])
    with pytest.raises(Misused, match=r"J1 \(shoulder_pan_joint\)"):
        _marks(ARM, ["J7", "90"])
