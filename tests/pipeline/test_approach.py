"""Tests of the approach to a program's start in a cell: a straight path if that is free, else a detour, else
a finding with the reason.
"""

import numpy as np
from programs import codes

from tests.collision.dense import Dense
from tests.motion.avoid.cells import LEFT, POST, RIGHT, ROBOT, cell_of
from yarclang.pipeline.parts import approach

CELL = cell_of(POST)
BEFORE = np.radians([0.0, 20, -20, 0, -30, 0])


def test_it_goes_straight_where_that_is_free():
    alone, around = approach(ROBOT, LEFT, LEFT + 0.2), approach(ROBOT, LEFT, LEFT + 0.2, CELL)
    assert around.diagnostics == ()
    assert around.value.program.source.text == alone.value.program.source.text
    one, other = (made.value.plan.motions[0].curve for made in (alone, around))
    assert np.array_equal(one.points, other.points)


def test_it_goes_round_slowly_and_is_certified():
    made = approach(ROBOT, LEFT, RIGHT, CELL)
    assert made.diagnostics == ()
    (proved,) = made.value.certificate.commands
    assert proved.clearance.distance > 0.0
    assert proved.velocity.share <= ROBOT.controller.rapid_share * (1.0 + 1e-6)
    (motion,) = made.value.plan.motions
    assert np.abs(motion.curve.points[[0, -1]] - [LEFT, RIGHT]).max() < 1e-12
    q = made.value.plan.sample(np.linspace(0, made.value.plan.duration, 1000))[0]
    dense = Dense(ROBOT, CELL)
    assert dense.distances(q).min() > 0.0


def test_where_nothing_is_known_around_it_goes_as_ever():
    made = approach(ROBOT, LEFT, RIGHT)
    assert made.value.program.source.text.startswith("P0001 MOVEJ_LSPB")


def test_what_is_in_the_way_is_said():
    for here, there, said in (
        (BEFORE, LEFT, "no path can begin at the robot's position"),
        (LEFT, BEFORE, "no path can end at the program's start"),
    ):
        made = approach(ROBOT, here, there, CELL)
        assert made.value is None
        assert codes(made.diagnostics) == ["Y0926"]
        assert said in made.diagnostics[0].message
        assert "mm deep in POST" in made.diagnostics[0].message
