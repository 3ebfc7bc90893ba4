"""A simulator in a thread: it starts, stops, and reports errors inside of it."""

import socket
import threading
import time

import pytest

from tests.simulator.echo import Echo
from tests.simulator.serving import Client
from yarclang.runtime.actions import Closed
from yarclang.runtime.pmac.protocol import Answer, Ask
from yarclang.simulator.faults import parse_fault
from yarclang.simulator.network.embedded import EmbeddedSimulator
from yarclang.simulator.network.server import SimulatorServer

ASK = Ask("P1")


class Sick(Echo):
    """A machine that fails after a short time."""

    def advance(self, seconds):
        super().advance(seconds)
        if self.now > 0.05:
            raise ZeroDivisionError("sick")


class Stuck(Echo):
    """A machine that takes long for a line."""

    def __init__(self):
        super().__init__()
        self.go_on = threading.Event()

    def command(self, line, port=0):
        self.go_on.wait(30)
        return super().command(line, port)


def threads():
    return [thread for thread in threading.enumerate() if thread.name == "yarc simulator"]


@pytest.mark.parametrize("rate", [1.0, 50.0, None])
def test_it_answers_and_stops(rate):
    with EmbeddedSimulator(Echo(), rate=rate) as simulator, Client(simulator.port) as client:
        assert client.ask(ASK) == Answer(ASK, ("P1",))
        simulator.check()
        begun = time.monotonic()
    assert time.monotonic() - begun < 3.0
    assert not threads()
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", simulator.port), timeout=1)


def test_several_at_a_time():
    machines = [Echo(), Echo()]
    with EmbeddedSimulator(machines[0]) as one, EmbeddedSimulator(machines[1]) as two:
        assert one.port != two.port
        with Client(two.port) as client:
            client.ask(ASK)
    assert [machine.heard for machine in machines] == [[], [(0, "P1")]]


def test_its_time_passes_as_told():
    machine, begun = Echo(), time.monotonic()
    with EmbeddedSimulator(machine, rate=5.0):
        time.sleep(0.3)
    assert 0.5 < machine.now < (time.monotonic() - begun) * 5.0


def test_faults_and_words_about_them():
    told = []
    machine = Echo()
    with EmbeddedSimulator(machine, faults=[parse_fault("amplifier@0:3")], tell=told.append):
        time.sleep(0.1)
    assert told == ["fault amplifier@0:3"]
    assert [word for _, word, *_ in machine.done] == ["amplifier"]


def test_an_error_in_a_reply_surfaces_at_the_end():
    simulator = EmbeddedSimulator(Echo())
    with pytest.raises(ZeroDivisionError), simulator, Client(simulator.port) as client:
        assert client.ask(Ask("BUG")) == Closed(Ask("BUG"))
    assert not threads()


def test_an_error_in_its_time_surfaces_when_asked():
    with pytest.raises(ZeroDivisionError, match="sick"), EmbeddedSimulator(Sick()) as simulator:  # noqa: PT012
        for _ in range(100):
            time.sleep(0.05)
            simulator.check()
        pytest.fail("nothing was said")


def test_an_error_inside_comes_before_what_follows_from_it():
    with pytest.raises(ZeroDivisionError) as found, EmbeddedSimulator(Sick()) as simulator:  # noqa: PT012
        while simulator._error is None:
            time.sleep(0.01)
        raise ConnectionError("the other end")
    assert isinstance(found.value.__context__, ConnectionError)


def test_who_leaves_is_let_go():
    with pytest.raises(KeyboardInterrupt), EmbeddedSimulator(Sick()) as simulator:  # noqa: PT012
        while simulator._error is None:
            time.sleep(0.01)
        raise KeyboardInterrupt


def test_errors_outside_pass():
    with pytest.raises(KeyError), EmbeddedSimulator(Echo()):
        raise KeyError
    assert not threads()


def test_a_machine_that_hangs_keeps_nobody():
    machine = Stuck()
    begun = time.monotonic()
    try:
        with (
            pytest.raises(RuntimeError, match="doesn't stop within 1 s"),
            EmbeddedSimulator(machine) as simulator,
            Client(simulator.port, timeout=0.2) as client,
        ):
            client.ask(ASK)
        assert time.monotonic() - begun < 3.0
    finally:
        machine.go_on.set()
    for thread in threads():
        thread.join(10)


def test_what_keeps_it_from_listening_is_raised(monkeypatch):
    async def start(self):
        raise OSError("no sockets left")

    monkeypatch.setattr(SimulatorServer, "start", start)
    with pytest.raises(OSError, match="no sockets left"), EmbeddedSimulator(Echo()):
        pass
    assert not threads()
