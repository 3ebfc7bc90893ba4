"""Hold-to-run for orders that are carried out while a button is held. These are offers (motions that were
planned and proved before the start) and home searches of motors.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.lines import name_of
from yarclang.pendant.accounts.accounts import Accounts
from yarclang.pendant.accounts.people import Deed
from yarclang.runtime.actions import Trouble

LET_GO = "the button was released before the start"


Wanted = orders.Go | orders.Home


class Going:
    """An offered motion or a home search that runs while a button is held. An object of this class exists
    from the first press of the button to the end of the motion.

    The coordinator has a watchdog for the motion: if `keep` isn't called at least every 0.2 s, the robot
    comes to rest on its path.

    Args:
        order: the order to carry out.
        seat: client of the session that gives the order.
        accounts: accounts with the audit trail.
        deed: function that returns the audit trail's entry for an order and its outcome.
        moves: returns True if the robot is executing something.
        check: raises `Trouble` if a stop was ordered since the button was pressed.
        ended: called at the end with this object, the reason for the end and a remedy. Both texts are empty
            if the robot has reached the end of the motion.

    Attributes:
        order: the order.
        ends: True as soon as the motion can't continue any more: it is over or about to end.
    """

    def __init__(
        self,
        order: Wanted,
        seat: Attached,
        accounts: Accounts,
        deed: Callable[[Wanted | orders.Resume, str], Deed],
        moves: Callable[[], bool],
        check: Callable[[], None],
        ended: Callable[[Going, str, str], None],
    ) -> None:
        self.order = order
        self.ends = False
        self._seat = seat
        self._accounts = accounts
        self._deed = deed
        self._moves = moves
        self._check = check
        self._ended = ended
        self._held = True
        self._asked = False
        self._task: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """Begin, after the order has been written to the audit trail."""
        self._task = asyncio.create_task(self._carried_out())

    def keep(self) -> None:
        """Report to the coordinator that the button is still held."""
        if self._asked and self._held:
            self._seat.send(orders.Keep())

    async def resume(self, is_held: Callable[[], bool]) -> None:
        """Continue along the same path after a release.

        Args:
            is_held: function that returns False if the button has been released again.

        Raises:
            Trouble: the motion can't continue.
        """
        order = orders.Resume()
        await self._accounts.did(self._deed(order, ""))
        if self.ends or not is_held():
            return
        self._check()
        # No await may follow before the orders are sent. Otherwise a release of the button could be handled
        # before them.
        self._held = True
        self._seat.send(orders.Keep())
        await self._seat.ask(order)

    def rest(self) -> None:
        """Bring the robot to rest on its path after a release."""
        self._held = False
        if self._asked and self._moves() and not self.ends:
            self._seat.send(orders.Hold())
        else:
            self.stop()  # an order that hasn't begun is cancelled

    def stop(self) -> None:
        """Bring the robot to rest on its path, and end the motion there."""
        self._held = False
        if self._asked and not self.ends:
            self._seat.send(orders.Stop())
        self.ends = True

    async def stopped(self, within: float) -> None:
        """End the motion, and wait until it is over.

        Args:
            within: longest wait [s].
        """
        self.stop()
        if self._task is not None:
            await asyncio.wait([self._task], timeout=within)

    async def _carried_out(self) -> None:
        order = self.order
        problem, help_, outcome = "", "", "ended"
        try:
            await self._accounts.did(self._deed(order, ""))
            if not self._held:
                raise Trouble(LET_GO, "", "")
            self._check()
            self._asked = True
            ended = await self._seat.ask(order)
            if not ended.well:
                problem, help_ = ended.what or "it was ended", ended.help or ""
                outcome = f"ended: {problem}"
        except Trouble as trouble:
            problem, help_, outcome = trouble.what, trouble.remedy, f"refused: {trouble.what}"
        finally:
            self.ends = True
        self._accounts.note(self._deed(order, outcome))
        self._ended(self, problem, help_)


def deed_of(
    user: str, address: str, described: Callable[[Wanted | orders.Resume], str]
) -> Callable[[Wanted | orders.Resume, str], Deed]:
    """Return a function that creates the audit trail's entry for an order that a held button gives.

    Args:
        user: user who holds the button.
        address: address from which the requests come.
        described: function that returns the text that describes an order.
    """

    def made(order: Wanted | orders.Resume, outcome: str) -> Deed:
        if outcome:
            return Deed(user, address, name_of(order), described(order), outcome)
        return Deed(user, address, name_of(order), described(order))

    return made
