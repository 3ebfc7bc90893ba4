"""A session whose orders are logged, and that may pause with nothing moving."""

from __future__ import annotations

from yarclang.runtime.log import RunLog
from yarclang.runtime.notices import Fail, Hold, Order, Override, Resume, Stop
from yarclang.runtime.session import Session


class OrderedSession(Session):
    """A session that logs what is ordered, and that may pause with nothing moving.

    Attributes:
        log: where orders are logged, if anywhere.
        paused: between two commands that are carried out step by step: a hold means nothing, and another pace is for what comes.
        failure: what failed meanwhile.
    """

    log: RunLog | None = None
    paused = False
    failure: Fail | None = None

    def order(self, order: Order) -> None:
        """Something that a person wants, at once."""
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
        """Wait until somebody wants it to go on; whether somebody wants the end instead, or something failed.

        Who wanted it to go on before that meant something else.
        """
        orders = self.operation.orders
        for early in [one for one in orders if isinstance(one, Resume)]:
            orders.remove(early)
        self.paused = True
        try:
            await self.order_given(Resume)
        finally:
            self.paused = False
        ends = bool(self.operation.orders)  # only what ends the run stays
        self.operation.orders.clear()
        return ends
