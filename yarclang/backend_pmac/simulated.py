"""A simulated Turbo PMAC with a robot, in this process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from yarclang.backend import Bench, Simulated
from yarclang.backend_pmac.settings import settings_text
from yarclang.robot.model import Array, Robot
from yarclang.simulated_cell.playing import SimulatedCell
from yarclang.simulator.beside import Beside
from yarclang.simulator.commissioning import commissioned, stand
from yarclang.simulator.faults import Fault, parse_fault
from yarclang.simulator.machine import Machine
from yarclang.simulator.network.embedded import EmbeddedSimulator
from yarclang.simulator.network.server import SimulatorServer


@contextmanager
def simulated(robot: Robot, stands: Array, rate: float, cell: SimulatedCell | None) -> Iterator[Simulated]:
    """Yield a simulated controller for a robot, which runs until the context ends.

    Args:
        robot: the robot.
        stands: (n,) the robot's first joint positions [rad or m].
        rate: simulated seconds per real second.
        cell: machines around the robot; None: there are none.
    """
    machine = commissioned(robot, settings_text(robot))
    stand(machine, robot, stands)
    if cell is not None:
        cell.attach(Beside(machine))
    with EmbeddedSimulator(machine, rate=rate) as simulator:
        yield Simulated(simulator.port, simulator.leash)


class _Server(SimulatorServer):
    """A simulated Turbo PMAC that reports which words of a program it executes differently from a real
    controller.
    """

    def differences(self) -> tuple[str, ...]:
        """Return the words of executed programs that behave differently on a real controller; empty if
        there are none.
        """
        return tuple(f"{word} {_does(word)} here" for word in self.machine.unknown_words)


def _does(word: str) -> str:
    if word == "SPLINE2":
        return "runs as SPLINE1"
    return "runs as LINEAR" if word.startswith("CIRCLE") else "does nothing"


def _server(
    robot: Robot | None,
    cell: SimulatedCell | None,
    /,
    *,
    host: str,
    port: int,
    rate: float | None,
    faults: tuple[Fault, ...],
    seed: int,
    tell: Callable[[float, str], None],
) -> _Server:
    machine = Machine() if robot is None else commissioned(robot, settings_text(robot))
    if cell is not None:
        cell.attach(Beside(machine))
    return _Server(
        machine,
        host=host,
        port=port,
        rate=rate,
        faults=faults,
        seed=seed,
        tell=lambda text: tell(machine.now, text),
    )


BENCH = Bench("a bare Turbo PMAC", parse_fault, _server)
