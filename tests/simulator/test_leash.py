"""A simulator in its client's process waits for the client: its time passes only with requests."""

import threading
import time

import pytest
from simulator.echo import Echo
from simulator.serving import Client

from yarclang.runtime.pmac.protocol import Answer, Ask
from yarclang.simulator.network.embedded import EmbeddedSimulator
from yarclang.simulator.network.leash import AHEAD, EXCHANGE, Leash, tick

ASK = Ask("P1")
FINEST = 0.0005


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
    assert stood - before <= 1.01 * AHEAD
    assert at_once - stood <= 2.02 * AHEAD, "what was left out isn't caught up"


def test_who_goes_on_asking_has_the_wall_clock():
    machine = Echo()
    with EmbeddedSimulator(machine) as simulator, Client(simulator.port) as client:
        for _ in range(60):
            client.ask(ASK)
            time.sleep(0.01)
        assert machine.now > 6.0 * AHEAD


def test_without_a_client_time_goes_on():
    machine = Echo()
    with EmbeddedSimulator(machine) as simulator:
        with Client(simulator.port) as client:
            client.ask(ASK)
            time.sleep(0.2)
        time.sleep(0.01)
        left = machine.now
        time.sleep(0.5)
        assert machine.now - left > 3.0 * AHEAD


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
        assert machine.now - before > 3.0 * AHEAD


@pytest.mark.parametrize("rate", [1.0, 8.0, 50.0])
def test_who_has_the_leash_says_how_far_time_goes(rate):
    machine = Echo()
    with EmbeddedSimulator(machine, rate=rate) as simulator, Client(simulator.port) as client:
        client.ask(ASK)
        simulator.leash.until = machine.now + 0.5
        time.sleep(1.0)
        # time stops at the leash's limit, or less than the machine's finest step before the limit
        assert simulator.leash.until - FINEST <= machine.now <= simulator.leash.until + 1e-9
        assert simulator.leash.until - FINEST <= simulator.leash.now() <= simulator.leash.until
        client.ask(ASK)
        assert machine.now <= simulator.leash.until + 1e-9, "a question doesn't let it go on"
        simulator.leash.until = None
        time.sleep(0.5)
        client.ask(ASK)
        assert machine.now > simulator.leash.now() - 0.5


def test_a_request_that_waits_for_a_busy_computer_lets_no_time_pass():
    """If a busy computer delays the machine's thread, the missed time doesn't pass before the answer."""
    machine = Echo()
    with EmbeddedSimulator(machine, rate=20.0) as simulator, Client(simulator.port) as client:
        client.ask(ASK)
        is_busy = threading.Event()

        def work():
            is_busy.set()
            time.sleep(0.3)

        simulator._loop.call_soon_threadsafe(work)
        assert is_busy.wait(10.0)
        before = machine.now
        client.ask(ASK)
        assert machine.now - before <= AHEAD + EXCHANGE


def test_the_clock_never_goes_back_and_goes_on_without_a_machine():
    leash = Leash(2.0, time.monotonic)
    leash.tell(1.0)
    time.sleep(0.05)
    first = leash.now()
    assert 1.0 < first <= 1.0 + 2.0 * tick(2.0) + 1e-9, "a tick ahead of the machine at most"
    leash.tell(1.001)
    assert leash.now() >= first
    leash.until = 1.2
    leash.stop()
    time.sleep(0.2)
    assert leash.now() > 1.3


def test_time_passes_in_small_steps_at_any_rate():
    assert tick(1.0) == tick(0.1) == 0.005
    assert tick(20.0) * 20.0 == pytest.approx(EXCHANGE)
    assert tick(1000.0) == 0.0005
