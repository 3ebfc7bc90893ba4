"""Session that logs orders and can pause while the robot is at rest."""

from __future__ import annotations

from yarclang.runtime.log import RunLog
from yarclang.runtime.notices import Fail, Hold, Order, Override, Resume, Stop
from yarclang.runtime.session import Session


class OrderedSession(Session):
    """A session that logs users' orders, and can pause while the robot is at rest.

    Attributes:
        log: log of the orders; None if there is none.
        paused: True while the robot waits between two commands that are carried out one by one. Then a hold
            has no effect, and a new override applies to the next command.
        failure: failure that was reported during a pause.
    """

    log: RunLog | None = None
    paused = False
    failure: Fail | None = None

    def order(self, order: Order) -> None:
        """Execute an order of a user at once."""
        if self.log is not None:
            self.log.ordered(self.now(), order)
        if self.paused and isinstance(order, Hold):
            return
        if self.paused and isinstance(order, Override):
            self.operation.override = order.percent / 100.0
            return
        if self.paused and isinstance(order, Fail):
            self.failure = order
            order = Stop()
        super().order(order)

    async def pause(self) -> bool:
        """Wait until a user orders to continue. Return True if the program must end instead: a user has
        ordered its end, or something has failed.

        Orders to continue that came before the pause are discarded, because they were meant for an earlier
        pause or hold.
        """
        orders = self.operation.orders
        for early in [one for one in orders if isinstance(one, Resume)]:
            orders.remove(early)
        self.paused = True
        try:
            await self.order_given(Resume)
        finally:
            self.paused = False
        ends = bool(self.operation.orders)  # at this point, only orders that end the run are left
        self.operation.orders.clear()
        return ends
