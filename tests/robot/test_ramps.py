"""Tests of [ramps], one rule for the accelerations and jerks of all joints. Planner and judge each read it
independently.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from programs import compiled

from tests.robot.made_arms import made
from tests.robot.test_description import TOML, load_texts
from tests.robot.trap_arms import arm, robot, written
from yarclang.certify.kinematics.described import ContradictionError, own_robot

RULED = re.sub(r"^(?:acceleration|jerk) = .*\n", "", TOML, flags=re.MULTILINE)
RAMPS = "[ramps]\nrise = 250\nease = 120\n"
FIELDS = ("lower", "upper", "velocity", "acceleration", "jerk", "stop_acceleration")


def with_ramps(ramps=RAMPS, toml=RULED):
    return toml.replace("[positions]", f"{ramps}[positions]", 1)


def test_the_rule_says_what_each_joint_would_say(tmp_path):
    ruled = load_texts(tmp_path, with_ramps())
    assert not ruled.diagnostics
    velocity = ruled.value.limits.velocity
    np.testing.assert_allclose(ruled.value.limits.acceleration, velocity / 0.25, rtol=1e-14)
    np.testing.assert_allclose(ruled.value.limits.jerk, velocity / 0.25 / 0.12, rtol=1e-14)
    each = re.sub(
        r"^velocity = ([0-9.]+)(.*)\n",
        lambda line: (
            f"{line[0]}acceleration = {float(line[1]) / 0.25!r}\njerk = {float(line[1]) / 0.25 / 0.12!r}\n"
        ),
        RULED,
        flags=re.MULTILINE,
    )
    spelled = load_texts(tmp_path, each)
    assert not spelled.diagnostics
    assert spelled.value.fingerprint == ruled.value.fingerprint
    for key in FIELDS:
        np.testing.assert_array_equal(
            getattr(spelled.value.limits, key), getattr(ruled.value.limits, key), key
        )


def test_the_judge_reads_the_same_limits(tmp_path):
    for toml in (with_ramps(), with_ramps(toml=RULED.replace("velocity = ", "jerk = 77\nvelocity = ", 1))):
        read = load_texts(tmp_path, toml).value
        own = own_robot(read)
        for key in FIELDS:
            np.testing.assert_allclose(getattr(own.limits, key), getattr(read.limits, key), rtol=1e-15)
    assert read.limits.jerk[0] / read.axis_units[0] == pytest.approx(77)


def test_the_judge_takes_no_joint_without_a_limit(tmp_path):
    read = load_texts(tmp_path, with_ramps()).value
    for lost in ("rise = 250\n", "ease = 120\n", RAMPS):
        torn = replace(read, written=replace(read.written, toml=with_ramps().replace(lost, "")))
        with pytest.raises(ContradictionError, match="no limit"):
            own_robot(torn)


def test_what_a_joint_says_itself_counts(tmp_path):
    read = load_texts(tmp_path, with_ramps(toml=TOML))
    assert not read.diagnostics
    plain = load_texts(tmp_path)
    for key in FIELDS:
        np.testing.assert_array_equal(getattr(plain.value.limits, key), getattr(read.value.limits, key), key)
    assert plain.value.fingerprint == read.value.fingerprint


@pytest.mark.parametrize(
    ("ramps", "code", "words"),
    [
        ("", "Y1304", "[ramps] with rise"),
        ("[ramps]\n", "Y1304", "lacks acceleration"),
        ("[ramps]\nrise = 250\n", "Y1304", "lacks jerk"),
        ("[ramps]\nease = 120\n", "Y1304", "lacks acceleration"),
        (RAMPS.replace("250", "0"), "Y1308", "rise of [ramps] is 0"),
        (RAMPS.replace("120", "1e9"), "Y1308", "at most 60,000"),
        (RAMPS.replace("120", "nan"), "Y1307", "ease"),
        (RAMPS.replace("250", '"fast"'), "Y1306", "rise"),
        (RAMPS.replace("rise", "rice"), "Y1305", "Did you mean rise?"),
    ],
)
def test_a_rule_that_is_none(ramps, code, words, tmp_path):
    read = load_texts(tmp_path, with_ramps(ramps))
    assert read.value is None
    found = {one.code: f"{one.message} {one.help}" for one in reversed(read.diagnostics)}
    assert code in found
    assert words in found[code]


def test_a_new_robot_has_the_rule_once_and_moves_by_it(tmp_path):
    file = written(tmp_path, robot(arm()))
    read = made(file, tmp_path / "r")
    text = (tmp_path / "r/robot.toml").read_text()
    assert text.count("acceleration = ") == text.count("jerk = ") == 0
    assert len(re.findall(r"^(?:rise|ease) = .*guess:", text, re.MULTILINE)) == 2
    np.testing.assert_allclose(read.limits.velocity / read.limits.acceleration, 0.25)
    np.testing.assert_allclose(read.limits.acceleration / read.limits.jerk, 0.12)
    result, diagnostics = compiled("P0010 DMOVEJ 5 4 3 2 1 -5 [MIN] (deg,mm,s)\n", str(tmp_path / "r"))
    assert result is not None, diagnostics
    made(file, tmp_path / "s", "--acceleration", "300")
    text = (tmp_path / "s/robot.toml").read_text()
    assert text.count("acceleration = 300") == 6
    assert "rise" not in text
    assert "ease = 120" in text
    made(file, tmp_path / "t", "--acceleration", "300", "--jerk", "3000")
    assert "[ramps]" not in (tmp_path / "t/robot.toml").read_text()
