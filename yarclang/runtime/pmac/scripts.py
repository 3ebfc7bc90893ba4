"""All scripts for a Turbo PMAC."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.runtime.actions import Script
from yarclang.runtime.pmac import homing, servicing
from yarclang.runtime.pmac.idling import idle
from yarclang.runtime.pmac.operation import ABORT_ALL, HOLD_ALL, PATIENCE, Operation
from yarclang.runtime.pmac.performance import (
    connect,
    end_leftovers,
    end_what_runs,
    look,
    measured,
    perform,
    perform_live,
)
from yarclang.runtime.pmac.picture import picture
from yarclang.runtime.pmac.protocol import Connection
from yarclang.runtime.pmac.rest import stands_at
from yarclang.runtime.scripts import Scripts, Services


def _last_words(abort: bool) -> bytes:
    return Connection().last_words(ABORT_ALL if abort else HOLD_ALL)


def _read(operation: Operation, variables: Sequence[str]) -> Script[tuple[float, ...]]:
    return operation.numbers("".join(variables), len(variables))


def _write(operation: Operation, variable: str, value: float) -> Script[None]:
    yield from operation.ask(f"{variable}={value:.9g}")


SCRIPTS = Scripts(
    operation=Operation,
    exchange=Connection,
    last_words=_last_words,
    connect=connect,
    look=look,
    idle=idle,
    stands_at=stands_at,
    perform=perform,
    perform_live=perform_live,
    end_leftovers=end_leftovers,
    end_what_runs=end_what_runs,
    read=_read,
    write=_write,
    picture=picture,
    measured=measured,
    patience=PATIENCE,
    services=Services(
        enable=servicing.enable,
        disable=servicing.disable,
        searches=homing.searches,
        home=homing.home,
        end_search=homing.end_search,
        check_open=servicing.check_open,
        send=servicing.send,
        save=servicing.save,
    ),
)
