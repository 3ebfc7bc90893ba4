"""Tests of measuring a link: round-trip times, lines per second, and how the controller counts a refused
line.
"""

import pytest
from runtime.virtual import World, well_behaved
from simulator.machines import robot_machine

from yarclang.runtime.actions import Trouble
from yarclang.runtime.pmac.link import measure
from yarclang.runtime.pmac.messages import Ask, Write
from yarclang.runtime.pmac.performance import connect, measured


def link_of(world, robot):
    world.perform(connect(world.operation))
    link = world.perform(measure(world.operation, len(robot.controller.axes)))
    well_behaved(world)
    return link


@pytest.fixture
def machine():
    return robot_machine("INDUSTRIAL6", False)


@pytest.mark.parametrize("delay", [0.001, 0.02, 0.1])
def test_times_are_what_exchanges_take(machine, delay):
    robot, controller = machine
    link = link_of(World(controller, delay=lambda: delay), robot)
    assert link.median == pytest.approx(delay)
    assert link.worst == pytest.approx(delay)
    assert link.lines_per_second == pytest.approx(link.lines_per_packet / delay)
    assert len(link.round_trips) == 20
    assert link.lines_per_packet >= 8


def test_the_worst_of_a_link_that_varies(machine):
    robot, controller = machine
    link = link_of(World(controller, delay=0.02, seed=1), robot)
    assert 0.0 < link.round_trips[0] < link.median < link.worst < 0.02
    assert list(link.round_trips) == sorted(link.round_trips)


def test_nothing_that_means_anything_is_written(machine):
    robot, controller = machine
    world = World(controller)
    world.perform(connect(world.operation))
    before = world.say("P0..8099"), world.say("I0..8191"), world.stands(robot).tolist()
    link_of(world, robot)
    assert (world.say("P0..8099"), world.say("I0..8191"), world.stands(robot).tolist()) == before


def test_an_open_buffer_stores_nothing_of_it(machine):
    """The measurement stores no line in a buffer that an aborted run has left open on this port."""
    robot, controller = machine
    world = World(controller)
    for line in ("&1DEFINE ROT 100", "B0", "OPEN ROT"):
        controller.command(line, 0)
    link_of(world, robot)
    assert world.say("PR") == ("0",)


REFUSALS = {
    (b"\x02\x00\x03\x80", True): (1, True),
    (b"\x01\x00\x03\x80", True): (0, True),
    (b"\x01\x00\x03\x80", False): (0, False),
    (b"\x03\x00\x03\x80", True): (None, True),
    (b"\x00\x00\x03\x80", True): (None, True),
    (b"\x00\x00\x00\x00", False): (None, False),
}


@pytest.mark.parametrize("refusal", REFUSALS)
def test_how_refused_lines_are_counted(machine, refusal):
    reply, stops = refusal
    robot, controller = machine
    world = World(controller)

    def spoil(request, right):
        if isinstance(request, Write) and "ENDIF" in request.lines:
            if not stops:
                world.say("P8180=2")
            return reply
        return right

    world.spoil = spoil
    link = link_of(world, robot)
    assert (link.first_line, link.stops_at_error) == REFUSALS[refusal]


def test_the_simulator_counts_from_1_and_stops(machine):
    robot, controller = machine
    link = link_of(World(controller), robot)
    assert (link.first_line, link.stops_at_error) == (1, True)


def test_a_controller_that_refuses_the_lines(machine):
    robot, controller = machine
    world = World(controller)
    world.spoil = lambda request, reply: b"\x01\x00\x03\x80" if isinstance(request, Write) else reply
    with pytest.raises(Trouble, match="ERR003"):
        link_of(world, robot)


def test_a_link_that_breaks(machine):
    robot, controller = machine
    world = World(controller)
    world.spoil = lambda request, reply: b"\x15" if request == Ask("P8180") else reply
    world.perform(connect(world.operation))
    with pytest.raises(Trouble, match="lost while the link was measured"):
        world.perform(measured(world.operation, robot))
