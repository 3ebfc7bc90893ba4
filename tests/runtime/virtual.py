"""The runtime against the simulator in virtual time: no socket, no clock. A reply takes as long as the test says."""

from collections.abc import Callable

from yarclang.runtime.actions import Connect, Connected, Unreachable, Wait
from yarclang.runtime.messages import Late
from yarclang.runtime.operation import Operation
from yarclang.runtime.protocol import Connection
from yarclang.simulator.ethernet import PacketReader, Station


class World:
    """A machine, an operation, and the time that they share.

    Args:
        machine: the simulator.
        delay: seconds that each exchange takes; called for each.
        reachable: whether a new connection can be made, called with the time.
    """

    def __init__(self, machine, delay: Callable[[], float] = lambda: 0.0005, reachable=lambda now: True):
        self.machine = machine
        self.operation = Operation()
        self.delay = delay
        self.reachable = reachable
        self.now = machine.now
        self.at = []  # (time, function), what shall happen
        self.told = []
        self.requests = 0
        self.drop_until = -1.0
        self._station = self._connection = self._reader = None

    def perform(self, script, until=1e9):
        """Carry a script out."""
        outcome = None
        while True:
            assert self.now < until, "it takes too long"
            self.operation.now = self.now
            try:
                action = script.send(outcome)
            except StopIteration as end:
                return end.value
            finally:
                self.told += self.operation.notices
                self.operation.notices.clear()
            match action:
                case Wait(until=then):
                    self._pass(then, wakes=True)
                    outcome = None
                case Connect():
                    self._pass(self.now + 0.001)
                    outcome = self._connect()
                case _:
                    outcome = self._exchange(action)

    def _connect(self):
        if not self.reachable(self.now):
            return Unreachable("the cable is out")
        self._station = Station(self.machine, 0)
        self._connection, self._reader = Connection(), PacketReader()
        return Connected()

    def _exchange(self, request):
        self.requests += 1
        connection = self._connection
        if connection is None or connection.lost:
            from yarclang.runtime.messages import Violation

            return Violation(request, "there is no connection")
        data = connection.send(request, self.now, 1.0)
        while True:
            if self.now < self.drop_until or not self.reachable(self.now):
                self._pass(self.now + 1.0)
                events = connection.check(self.now)
                assert isinstance(events[0], Late)
                return events[0]
            replies = b"".join(self._station.answer(packet) for packet in self._reader.receive(data))
            self._pass(self.now + self.delay())
            events = connection.receive(replies, self.now)
            data = connection.outgoing()
            if events:
                return events[0]

    def _pass(self, until, wakes=False):
        """Let time pass; what shall happen happens on its way, and an order ends a wait."""
        orders = len(self.operation.orders)
        while True:
            due = [one for one in self.at if one[0] <= until]
            if not due:
                break
            first = min(due, key=lambda one: one[0])
            self.at.remove(first)
            self._advance(max(first[0], self.now))
            first[1]()
            if wakes and len(self.operation.orders) > orders:
                return
        self._advance(max(until, self.now))

    def _advance(self, until):
        if until > self.now:
            self.machine.advance(until - self.now)
            self.now = until
