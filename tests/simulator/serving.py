"""A server in the test's process, and clients for it."""

import contextlib
import socket
import time

from yarclang.runtime.pmac.protocol import Connection
from yarclang.simulator.faults import parse_fault
from yarclang.simulator.network.embedded import EmbeddedSimulator


@contextlib.contextmanager
def served(machine, *faults, **options):
    """Yield the port of a server that runs in a thread."""
    with EmbeddedSimulator(
        machine, faults=[parse_fault(text) for text in faults], leashed=False, **options
    ) as simulator:
        yield simulator.port


class Client:
    """A client with the runtime's codec on a plain socket."""

    def __init__(self, port, timeout=5.0):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.connection, self.timeout = Connection(), timeout

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def ask(self, request):
        """Send a request, and return the event that answers it."""
        connection = self.connection
        data = connection.send(request, time.monotonic(), self.timeout)
        while True:
            if data:
                self.socket.sendall(data)
            try:
                data = self.socket.recv(65536)
            except TimeoutError:
                events = connection.check(connection.deadline)
            except ConnectionError:
                events = connection.close()
            else:
                events = connection.receive(data, time.monotonic()) if data else connection.close()
            if events:
                return events[0]
            data = connection.outgoing()
