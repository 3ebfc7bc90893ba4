"""Register values that other processes send to a running program: who may send them, which values are
refused, and which refusals are logged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from yarclang.coordinator.messages import message
from yarclang.coordinator.ordered import OrderedSession
from yarclang.runtime.actions import Trouble
from yarclang.runtime.notices import Fill, Wanted
from yarclang.runtime.values import checked_values

_REFUSALS, _EACH = 5, 1.0
"""Largest number of refused values that are logged in a period, and the duration of the period [s]. Of
further refusals only the number is logged, so that an endless stream of them doesn't fill the disk.
"""


class Values:
    """Accepts register values from clients, for the program that waits for them.

    Args:
        session: session that executes the program.
        under_way: returns True while something is in progress. Otherwise there is no log.
    """

    def __init__(self, session: OrderedSession, under_way: Callable[[], bool]) -> None:
        self._session = session
        self._under_way = under_way
        self._since = 0.0
        self._told = 0
        self._untold = 0

    @property
    def wanted(self) -> message.ValuesWanted | None:
        """Return the registers for which the program accepts values now, as a message; None if there are
        none.
        """
        return wanted_message(self._session.operation.wants)

    def take(self, values: Mapping[str, Any], number: int | None, client: str) -> dict[str, int]:
        """Accept either all values or none, and return the accepted values as integers.

        Args:
            values: values by the names of the registers, as sent.
            number: number of the program's question that the values answer; None: the current question.
            client: client that sends the values.

        Raises:
            Trouble: the values aren't accepted.
        """
        operation = self._session.operation
        try:
            accepted = checked_values(operation.wants, number, values)
        except Trouble as trouble:
            self.refused(client, trouble.what)
            raise
        operation.want(None)  # the question is answered: later values are meant for another question
        self._session.order(Fill(accepted, client))
        return dict(accepted)

    def refused(self, client: str, reason: str) -> None:
        """Log that values from a client were refused."""
        if not self._under_way():
            return
        now = self._session.now()
        if not 0.0 <= now - self._since < _EACH:
            self._since, self._told = now, 0
        self._told += 1
        if self._told > _REFUSALS:
            self._untold += 1
            return
        more = f" ({self._untold} earlier refusals weren't logged)" if self._untold else ""
        self._untold = 0
        self._session.operation.remark(f"values of {client} are refused: {reason}{more}", warning=True)
        self._session.wake()


def wanted_message(wanted: Wanted | None) -> message.ValuesWanted | None:
    """Return the registers for which a program waits for values, as a message."""
    if wanted is None:
        return None
    ranges = tuple(
        message.RegisterRange(name=name, low=low, high=high) for name, low, high in wanted.registers
    )
    return message.ValuesWanted(
        number=wanted.number, place=wanted.place, registers=ranges, needed=wanted.needed
    )
