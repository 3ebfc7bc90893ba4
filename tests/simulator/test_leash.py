"""A simulator in the process of its client waits for it: what it doesn't ask takes no time of the machine."""

import time

import pytest
from simulator.echo import Echo
from simulator.serving import Client

from yarclang.runtime.protocol import Answer, Ask
from yarclang.simulator.embedded import EmbeddedSimulator
from yarclang.simulator.leash import leash

ASK = Ask("P1")


def test_who_asks_nothing_is_waited_for():
    machine = Echo()
    with EmbeddedSimulator(machine) as simulator, Client(simulator.port) as client:
        client.ask(ASK)
        before = machine.now
        time.sleep(0.5)
        stood = machine.now
        client.ask(ASK)
        client.ask(ASK)
        at_once = machine.now
    assert stood - before <= 1.01 * leash(1.0)
    assert at_once - stood <= 2.02 * leash(1.0), "what was left out isn't caught up"


def test_who_goes_on_asking_has_the_wall_clock():
    machine = Echo()
    with EmbeddedSimulator(machine) as simulator, Client(simulator.port) as client:
        for _ in range(60):
            client.ask(ASK)
            time.sleep(0.01)
        assert machine.now > 6.0 * leash(1.0)


def test_without_a_client_time_goes_on():
    machine = Echo()
    with EmbeddedSimulator(machine) as simulator:
        with Client(simulator.port) as client:
            client.ask(ASK)
            time.sleep(0.2)
        time.sleep(0.01)
        left = machine.now
        time.sleep(0.5)
        assert machine.now - left > 3.0 * leash(1.0)


@pytest.mark.parametrize("fault", ["freeze@0.02:0.4", "slow:0.4"])
def test_who_waits_for_a_reply_is_not_waited_for(fault):
    from yarclang.simulator.faults import parse_fault

    machine = Echo()
    with (
        EmbeddedSimulator(machine, faults=[parse_fault(fault)]) as simulator,
        Client(simulator.port) as client,
    ):
        time.sleep(0.1)
        assert client.ask(ASK) == Answer(ASK, ("P1",))
        assert machine.now > 0.4


def test_a_machine_off_the_leash_keeps_up_with_the_wall_clock():
    machine = Echo()
    with EmbeddedSimulator(machine, leashed=False) as simulator, Client(simulator.port) as client:
        client.ask(ASK)
        before = machine.now
        time.sleep(0.5)
        assert machine.now - before > 3.0 * leash(1.0)


def test_a_fast_machine_goes_as_far_as_two_event_loops_need():
    assert leash(0.1) == leash(1.0) == leash(10.0) == 0.06
    assert leash(100.0) == pytest.approx(0.5)
