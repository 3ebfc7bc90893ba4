"""Tests of the settings for a controller: definitions and feedback are inverse, limits are in counts, and
stops brake hard enough.
"""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from runtime.virtual import prepared, world_of

from yarclang.backend_pmac.settings import settings_of, settings_text
from yarclang.robot.actuation import counts_per_joint, from_counts, to_counts
from yarclang.runtime.pmac.performance import perform


def axis_definitions(robot):
    """Return the lines of the axis definitions, beginning with the coordinate system."""
    lines = settings_text(robot).splitlines()
    begin = lines.index(f"&{robot.controller.coordinate_system}")
    return lines[begin : lines.index("", begin)]


def values(text):
    """Return the values of the I-variables of a settings text."""
    return {name: float(value) for name, value in re.findall(r"^(I\d+)=(-?[0-9.]+)", text, re.M)}


@pytest.fixture(params=["industrial6", "tracked"])
def robot(request):
    return request.getfixturevalue(request.param)


def test_the_definitions_are_listing_1(industrial6, conformance):
    expected = conformance("actuation")["industrial6"]["definitions"]
    assert axis_definitions(industrial6) == ["&1", *expected]


def definitions(robot):
    """Return the matrix of the axis definitions in the text, in counts per axis unit."""
    matrix = np.zeros((robot.size, robot.size))
    for row, line in enumerate(axis_definitions(robot)[1:]):
        _, _, terms = line.partition("->")
        for share, axis in re.findall(r"([+-]?[0-9.]+)([A-Z])", terms):
            matrix[row, robot.controller.axes.index(axis)] = float(share)
    return matrix


def test_the_definitions_are_the_actuation_matrix(robot):
    assert definitions(robot) == pytest.approx(counts_per_joint(robot) * robot.axis_units, rel=1e-9)


def test_coupled_axes_are_all_of_xyz_or_all_of_uvw(robot):
    for line in axis_definitions(robot)[1:]:
        axes = set(re.findall(r"[A-Z]", line))
        assert len(axes) == 1 or axes <= set("XYZ") or axes <= set("UVW")


def test_the_feedback_plc_inverts_the_definitions(robot):
    assert_inverse(robot)


def assert_inverse(robot):
    """Check that PLC 0, evaluated as by the controller, computes joint positions from counts of the axis
    definitions.
    """
    text = settings_text(robot)
    plc = text.split("OPEN PLC 0 CLEAR\n")[1].split("CLOSE")[0].splitlines()
    rng = np.random.default_rng(4)
    for _ in range(20):
        q = rng.uniform(-90, 90, robot.size)
        counts = definitions(robot) @ q + robot.actuation.offset
        scale = robot.controller.ixx08
        variables = {f"I{motor}08": scale for motor in robot.controller.motors}
        for motor, count in zip(robot.controller.motors, counts, strict=True):
            variables[f"M{motor}62"] = count * scale * 32
        assert plc[-1] == "P8105=P8103"  # this line is the guard's heartbeat
        for line in plc[:-1]:
            name, _, expression = line.partition("=")
            variables[name] = eval(expression, {}, variables)
        assert [variables[name] for name in robot.controller.feedback] == pytest.approx(q, abs=1e-6)


def test_counts_and_joints_are_inverse(robot):
    q = np.random.default_rng(5).uniform(-1, 1, (50, robot.size))
    assert from_counts(robot, to_counts(robot, q)) == pytest.approx(q, abs=1e-12)


def test_an_abort_stops_the_joints_as_fast_as_they_bear_and_no_faster(robot):
    """The abort decelerations Ixx15 [counts/ms^2] decelerate no joint beyond its stop acceleration, whatever
    the directions of the motors, and at least one joint reaches it. The controller's default would take 6 s
    to stop joint 1.
    """
    found = values(settings_text(robot))
    rate = np.array([found[f"I{motor}15"] for motor in robot.controller.motors]) * 1e6
    worst = np.abs(np.linalg.inv(counts_per_joint(robot))) @ rate
    share = worst / robot.limits.stop_acceleration
    assert share.max() <= 1 + 1e-3
    assert share.max() >= 1 - 1e-3


def test_the_abort_of_motor_1_is_that_of_its_joint(industrial6):
    found = values(settings_text(industrial6))
    assert found["I115"] == pytest.approx(25532.8278 * 240 * 1e-6, abs=1e-3)


def test_the_software_limits_are_the_first_counts_beyond_the_joint_limits(industrial6):
    """The controller aborts a move to a target beyond a software limit, so that the software limits lie
    outside the joint limits.
    """
    found = values(settings_text(industrial6))
    assert found["I113"] == 4340581  # 170 deg are 4340580.726 counts
    assert found["I114"] == -4340581
    # 80 deg are exactly 2053430 counts: a limit there could be exceeded by rounding
    assert found["I214"] == -2053431
    # motor 3 moves with J2 + J3
    assert found["I313"] == math.ceil((90 + 80) * 29308.7083) == 4982481
    assert found["I314"] == math.floor((-80 - 170) * 29308.7083) == -7327178


def test_a_motion_to_a_joint_limit_is_not_stopped():
    """J6 moves to its limit: 360 deg are 3997635.012 counts, not an integer."""
    job, _ = prepared("P0010 MOVEJ 0 0 0 0 0 360 [10] (deg,s)\n")
    world = world_of(job)
    assert world.perform(perform(world.operation, job)).well


def test_zero_as_a_limit_is_a_count_outside(industrial6):
    """A limit of 0 would switch the software limit off, so that it is 1 or -1 count instead (TSRM 96)."""
    limits = industrial6.limits
    lower, upper = limits.lower.copy(), limits.upper.copy()
    lower[0], upper[3] = 0.0, 0.0
    found = values(settings_text(replace(industrial6, limits=replace(limits, lower=lower, upper=upper))))
    assert (found["I114"], found["I413"]) == (-1, 1)


def test_rapid_is_no_faster_than_a_motor(industrial6):
    actuation = replace(industrial6.actuation, velocity=np.full(6, 50e3))
    found = values(settings_text(replace(industrial6, actuation=actuation)))
    assert [found[f"I{motor}22"] for motor in range(1, 7)] == [50, 50, 50, 42.6608, 50, 50]


@pytest.mark.parametrize(
    ("title", "shown"),
    [
        ("arm\nM11=1", "arm?M11=1"),
        ("arm\r#1J+", "arm?#1J+"),
        ("arm\x0b#1J+", "arm?#1J+"),
        ("arm\x85#1J+", "arm?#1J+"),
        ("Schweißarm", "Schwei?arm"),
        ('a "small"  arm; blue', 'a "small"  arm; blue'),
    ],
)
def test_a_title_stays_a_comment(industrial6, title, shown):
    """A line end in a title is replaced, because the text after it would be a command."""
    text = settings_text(replace(industrial6, title=title))
    assert text == settings_text(industrial6).replace(industrial6.title, shown)


def test_numbers_have_no_exponent_and_enough_digits(industrial6):
    """Small gears and rates, large offsets and weak couplings are written without exponents."""
    coupling = np.eye(6)
    coupling[1, 2] = 2e-5
    gear = np.array([3e-6, 7.00000000004, 1e6 / 3, -0.02, 5e4, 2.0])
    offset = np.array([0.0, -1.5e10, 12345678.9123, 1e-5, 1234.5, 0.25])
    actuation = replace(industrial6.actuation, gear=gear, coupling=coupling, offset=offset)
    robot = replace(industrial6, actuation=actuation)
    made = settings_of(robot)
    assert re.search(r"[0-9]e[-+]?[0-9]|\.[^0-9]|[^0-9]\.", "\n".join(made.feedback.listing)) is None
    for line in (*(one.terms for one in made.axes), *(one.value for one in (*made.motors, *made.globals))):
        assert re.fullmatch(r"([-+]?[0-9]+(\.[0-9]+)?[A-Z]?)+", line), line
    assert definitions(robot) == pytest.approx(counts_per_joint(robot) * robot.axis_units, rel=1e-11)
    found = values(made.text)
    assert found["I115"] == pytest.approx(
        3e-6 * np.rad2deg(robot.limits.stop_acceleration[0]) * 1e-6, rel=1e-3
    )
    assert_inverse(robot)


def test_the_hold_takes_the_hold_time(robot):
    """Isx95, in units of I10 per servo interrupt, reduces the override from 100 % to 0 within the hold time
    (TSRM 177).
    """
    found = values(settings_text(robot))
    system = robot.controller.coordinate_system
    slew = found[f"I{5000 + 100 * system + 95}"]
    interrupts = found["I10"] / slew
    seconds = interrupts * found["I10"] / 2**23 * 1e-3
    assert seconds == pytest.approx(robot.controller.hold_time, rel=1e-3)


def test_the_guard_holds_when_the_rotary_is_low_and_a_program_is_armed(industrial6):
    text = settings_text(industrial6)
    assert "M8116->Y:$00203F,16,1" in text
    guard = text.split("OPEN PLC 29 CLEAR\n")[1].split("CLOSE")[0].split()
    assert guard == [
        "P8103=P8103+1",
        *("IF(P8100=1)", "IF(M8116=0)", "P8100=2", 'CMD"&1H"', "ENDIF", "ENDIF"),
        *("IF(P8104=1)", "IF(I5112<0)", "P8104=2", 'CMD"&1H"', "ENDIF", "ENDIF"),
    ]
    assert "ENABLE PLC 29" in text


def test_every_line_is_one_that_a_controller_takes(robot):
    """Each line is ASCII and short, and its comment comes after a semicolon."""
    for line in settings_text(robot).splitlines():
        assert line.isascii()
        assert len(line.partition(";")[0].rstrip()) <= 120
