"""The Turbo PMAC backend: the functions that the general packages call for any kind of controller,
implemented for this one. The module of each function is imported when it is first used.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, cast

from yarclang.backend import Backend, Bench, LiveWriting, Sendable, Settings, Simulated, Written
from yarclang.backend_pmac.kind import KIND
from yarclang.diagnostics import Diagnostic, Result
from yarclang.emitted.purposes import Listed, Stretch
from yarclang.memory import Memory
from yarclang.motion.limits import Grid
from yarclang.motion.plan import MotionPlan
from yarclang.pmac.program import Target
from yarclang.pmac.requests import PORT
from yarclang.robot.model import Array, Robot, Tolerance

if TYPE_CHECKING:
    from yarclang.certify.claims import Claims
    from yarclang.certify.read.reader import Reader
    from yarclang.certify.read.text import ControllerText
    from yarclang.hir import Program
    from yarclang.runtime.scripts import Scripts
    from yarclang.simulated_cell.playing import SimulatedCell


def _grid(robot: Robot, tm: float | None) -> Result[Grid]:
    from yarclang.backend_pmac.grid import segment_grid

    return segment_grid(robot, tm)


def _write(plan: MotionPlan, target: str, tolerance: Tolerance, memory: Memory) -> Result[Written]:
    from yarclang.backend_pmac.writing import streamed_only, write

    if target == "prog" and (refused := streamed_only(plan.program)) is not None:
        return Result(None, (refused,))
    return write(plan, cast("Target", target), tolerance, memory)


def _reader() -> Reader:
    from yarclang.certify.pmac.reader import READER

    return READER


def _sendable(content: ControllerText, robot: Robot) -> Sendable | Diagnostic:
    from yarclang.backend_pmac.sendable import sendable

    return sendable(content, robot)


def _scripts() -> Scripts:
    from yarclang.runtime.pmac.scripts import SCRIPTS

    return SCRIPTS


def _settings() -> Settings:
    from yarclang.backend_pmac.settings_read import SETTINGS

    return SETTINGS


def _live() -> LiveWriting:
    from yarclang.backend_pmac.live import LIVE

    return LIVE


def _bench() -> Bench:
    from yarclang.backend_pmac.simulated import BENCH

    return BENCH


def _simulated(
    robot: Robot, stands: Array, rate: float, cell: SimulatedCell | None
) -> AbstractContextManager[Simulated]:
    from yarclang.backend_pmac.simulated import simulated

    return simulated(robot, stands, rate, cell)


def _purposes(
    lines: Sequence[str], begin: int, commands: Sequence[Listed], barriers: Mapping[int, int]
) -> Iterator[Stretch]:
    from yarclang.backend_pmac.purposes import purposes

    return purposes(lines, begin, commands, barriers)


def _proof(
    text: str, content: ControllerText, program: Program, robot: Robot, tolerance: Tolerance, claims: Claims
) -> str | Diagnostic:
    from yarclang.certify.pmac.proof.document import NoProofError, proof_of

    try:
        return proof_of(text, content, program, robot, tolerance, claims)
    except NoProofError as error:
        return Diagnostic("Y1196", str(error), program.source)


BACKEND = Backend(
    kind=KIND,
    suffix=".pmc",
    targets=("rotary", "prog"),
    port=PORT,
    grid=_grid,
    write=_write,
    reader=_reader,
    sendable=_sendable,
    scripts=_scripts,
    settings=_settings,
    live=_live,
    bench=_bench,
    simulated=_simulated,
    proof=_proof,
    purposes=_purposes,
)
