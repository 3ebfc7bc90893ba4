"""Tuned motors: a fast motion with fine counts isn't reported as a fault."""

from dataclasses import replace

import numpy as np
import pytest
from programs import compiled

from tests.runtime.virtual import World
from yarclang.backend_pmac.settings import settings_text
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pmac.defaults import MOTOR
from yarclang.robot.description import load_robot
from yarclang.runtime.pmac.performance import connect, perform
from yarclang.simulator.commissioning import commissioned, fatal_limit

FINER = 20.0
"""Factor by which the motors' counts are finer than usual."""


@pytest.fixture(scope="module")
def fine():
    """Return an arm with fine encoders, such as those of a slide with 10,000 counts/mm."""
    robot = load_robot("INDUSTRIAL6").value
    actuation = robot.actuation
    return replace(
        robot,
        actuation=replace(actuation, gear=actuation.gear * FINER, velocity=actuation.velocity * FINER),
    )


def test_a_fast_motion_of_fine_counts_runs_to_its_end(fine):
    machine = commissioned(fine, settings_text(fine))
    speed = fine.actuation.velocity[0]
    assert machine.motors[1].fatal_limit() > 0.5e-3 * speed
    made = World(machine)
    made.perform(connect(made.operation))
    program, found = compiled("P10 MOVEJ_TOPP 60 0 0 0 0 0 [MIN] (deg,s)\n", fine)
    assert program is not None, found
    peak = program.certificate.commands[0].motor_velocity.share * speed
    assert peak * 0.5e-3 > MOTOR[11] / 16, "the default would be a fault"
    assert made.perform(perform(made.operation, job_of_compiled(program, "fine"))).well


@pytest.mark.parametrize("velocity", [0.0, 1.0, 4e6, 1e9, np.inf])
def test_the_limit_is_one_that_the_controller_keeps(velocity):
    assert 0 <= fatal_limit(velocity) <= 8_388_607
