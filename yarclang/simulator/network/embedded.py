"""A simulator within the process that uses it: a simulated controller on a free loopback port, served by a
thread.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from types import TracebackType

from yarclang.simulator.faults import Fault
from yarclang.simulator.machine import Machine
from yarclang.simulator.network.leash import Leash
from yarclang.simulator.network.server import SimulatorServer, wall_clock

_STOP_TIME = 1.0
"""Time after which a server that doesn't stop counts as hanging [s]."""


class EmbeddedSimulator:
    """Serves a simulated controller as long as the context lasts. During this time, no other code may use the
    controller.

    Args:
        machine: the controller.
        rate: seconds of the machine's time per second of the wall clock; None to run as fast as
            possible.
        faults: the faults to inject.
        seed: seed of the faults.
        tell: function that is called with a line of text for each unusual event, in the simulator's
            thread.
        leashed: True to let the machine's time wait for its client if the computer is busy (`leash.py`).

    Attributes:
        port: the port on which the server listens.
        leash: leash for the client that supervises the robot; None if the machine isn't leashed, or runs
            as fast as possible.
    """

    def __init__(
        self,
        machine: Machine,
        *,
        rate: float | None = 1.0,
        faults: Iterable[Fault] = (),
        seed: int = 0,
        tell: Callable[[str], None] | None = None,
        leashed: bool = True,
    ) -> None:
        self.port = 0
        self.leash = Leash(rate, wall_clock) if leashed and rate is not None else None
        self._server = SimulatorServer(
            machine, port=0, rate=rate, faults=faults, seed=seed, tell=tell, leash=self.leash
        )
        self._thread = threading.Thread(target=self._run, name="yarc simulator", daemon=True)
        self._listens: Future[int] = Future()
        self._error: Exception | None = None
        self._loop: asyncio.AbstractEventLoop
        self._ending: asyncio.Event

    def __enter__(self) -> EmbeddedSimulator:
        """Start to listen on `port`.

        Raises:
            OSError: the server can't listen on the loopback address.
        """
        self._thread.start()
        self.port = self._listens.result()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close all connections and stop the server.

        Raises:
            Exception: an error inside the machine, as in `check`. It replaces an error of the context, which
                may be only its consequence.
            RuntimeError: the server doesn't stop.
        """
        with contextlib.suppress(RuntimeError):  # the server's loop has ended with an error
            self._loop.call_soon_threadsafe(self._ending.set)
        self._thread.join(_STOP_TIME)
        if error is not None and not isinstance(error, Exception):
            return  # the context was left by an interrupt of the user, or by an exit
        self.check()
        if self._thread.is_alive() and error is None:
            raise RuntimeError(f"the simulator doesn't stop within {_STOP_TIME:g} s")

    def check(self) -> None:
        """Check that the machine is still served.

        Raises:
            Exception: the error inside the machine that ended its server, which is a bug of the simulator.
        """
        if self._error is not None:
            raise self._error

    def _run(self) -> None:
        """Run the server; the body of the thread."""
        try:
            asyncio.run(self._serve())
        except Exception as error:
            if self._listens.done():
                self._error = error
            else:
                self._listens.set_exception(error)

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._ending = asyncio.Event()
        await self._server.start()
        serving = asyncio.create_task(self._server.serve())
        ending = asyncio.create_task(self._ending.wait())
        self._listens.set_result(self._server.port)
        await asyncio.wait((serving, ending), return_when=asyncio.FIRST_COMPLETED)
        if serving.done():
            failure = serving.exception()
            self._error = failure if isinstance(failure, Exception) else None
        else:
            serving.cancel()
        await self._server.close()
        await ending
