"""Tests of converting joint positions to motor counts and back, by the paper's eq. 5 to 8."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.robot.actuation import counts_per_joint, from_counts, joints_per_count, to_counts
from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot

DATA: dict[str, dict[str, Any]] = json.loads(
    (Path(__file__).parents[1] / "conformance" / "actuation.json").read_text()
)
NAMES = ("industrial6", "tracked_manipulator")


def robot(name: str) -> Robot:
    value = load_robot(name).value
    assert value is not None
    return value


ROBOTS = {name: robot(name) for name in NAMES}


def test_the_counts_of_the_industrial_robot() -> None:
    arm = ROBOTS["industrial6"]
    for case in DATA["industrial6"]["cases"]:
        q, counts = np.deg2rad(case["q_deg"]), np.array(case["counts"])
        assert np.allclose(to_counts(arm, q), counts, rtol=0, atol=1e-6)
        assert np.allclose(from_counts(arm, counts), q, rtol=0, atol=1e-13)


def test_the_matrices_are_the_papers() -> None:
    arm = ROBOTS["industrial6"]
    assert np.array_equal(arm.actuation.gear, DATA["industrial6"]["K"])
    assert np.array_equal(arm.actuation.offset, DATA["industrial6"]["a0"])
    for name in NAMES:
        assert np.array_equal(ROBOTS[name].actuation.coupling, DATA[name]["J"])


def test_the_axis_definitions_are_the_papers() -> None:
    arm = ROBOTS["industrial6"]
    matrix = counts_per_joint(arm) * arm.axis_units
    for motor, row, wanted in zip(
        arm.controller.motors, matrix, DATA["industrial6"]["definitions"], strict=True
    ):
        terms = [
            f"{factor:.4f}{axis}" for factor, axis in zip(row, arm.controller.axes, strict=True) if factor
        ]
        assert f"#{motor}->{'+'.join(terms)}" == wanted


def test_the_differential_wrist() -> None:
    arm = ROBOTS["tracked_manipulator"]
    for case in DATA["tracked_manipulator"]["cases"]:
        q, turned = np.deg2rad(case["q_deg"]), np.array(case["J_q"])
        assert np.allclose(to_counts(arm, q), arm.actuation.gear * turned, rtol=0, atol=1e-8)
        assert np.allclose(from_counts(arm, arm.actuation.gear * turned), q, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", NAMES)
def test_one_matrix_both_ways(name: str) -> None:
    arm = ROBOTS[name]
    assert np.allclose(counts_per_joint(arm) @ joints_per_count(arm), np.eye(6), atol=1e-12)


@settings(max_examples=50, deadline=None, derandomize=True)
@given(name=st.sampled_from(NAMES), q=st.lists(st.floats(-7, 7), min_size=6, max_size=6))
def test_from_counts_of_to_counts_is_the_identity(name: str, q: list[float]) -> None:
    arm = ROBOTS[name]
    assert np.allclose(from_counts(arm, to_counts(arm, np.array([q, q]))), [q, q], rtol=0, atol=1e-12)
