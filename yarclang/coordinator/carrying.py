"""What is performed, and what it does to the parts of the cell: whoever performs something through here learns where they are then."""

from __future__ import annotations

import contextlib
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Any

from yarclang.cell.model import Cell
from yarclang.coordinator.engine import Engine
from yarclang.coordinator.kept_parts import KeptParts, Performed
from yarclang.coordinator.programs import Loaded, Way, way_to_start
from yarclang.diagnostics import Result
from yarclang.handling.parts import first_parts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Lost, Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.live import Live
from yarclang.runtime.outcome import Ended

Planning = Callable[..., Awaitable[Any]]
"""Calls a function with arguments somewhere and gives what it gives."""


class Carrying:
    """Performs what moves the robot, and keeps where the parts are.

    Args:
        robot: that moves.
        engine: what performs it.
        plan: where planning is done, one call at a time.
        beside: likewise, without waiting for what is planned.

    Attributes:
        kept: where the parts are.
    """

    def __init__(self, robot: Robot, engine: Engine, plan: Planning, beside: Planning) -> None:
        self.kept = KeptParts(robot)
        self._robot = robot
        self._engine = engine
        self._plan = plan
        self._beside = beside

    async def way_to_start(self, loaded: Loaded, here: Array) -> Way:
        """Return the way from where the robot stands (n,) [rad or m] to where a program begins.

        Raises:
            Trouble: the parts aren't where they were when the program was proved.
        """
        self.kept.check(loaded.around, loaded.assumed)
        around = None if loaded.around is None else self.kept.now(replace(loaded.around, present=None), here)
        way: Way = await self._plan(way_to_start, self._robot, loaded, here, around)
        return way

    async def renewed(self, loaded: Loaded, number: int) -> Loaded | Ended:
        """Return a program as it is carried out once more, from its beginning: proved anew if its parts are elsewhere now.

        Args:
            loaded: the program.
            number: of the pass that is to begin.

        Returns:
            How it has ended instead, if it can't be proved.
        """
        plan, stands = loaded.plan, loaded.program.end
        given = loaded.around if plan is None else plan.program.cell
        assumed = None if given is None or not given.parts else first_parts(given)
        try:
            self.kept.check(given, assumed)
        except Trouble as trouble:
            made: Result[Loaded] | None = None
            if plan is not None and loaded.again is not None:
                made = await self._plan(loaded.again, self.kept.now)
            if made is not None and made.value is not None:
                return made.value
            errors = () if made is None else tuple(one for one in made.diagnostics if one.is_error)
            what = errors[0].message if errors else trouble.what
            return Ended(
                False,
                f"pass {number} isn't begun: {what}",
                (errors[0].help or "") if errors else trouble.remedy,
                stands,
                code=errors[0].code if errors else trouble.code,
            )
        return loaded

    async def perform(self, job: Job, program: Job | None = None, what: Performed | None = None) -> Ended:
        """Carry a job out; for work of `Engine.move`.

        Args:
            job: what is streamed.
            program: the whole that it is a part of.
            what: the steps that it carries out; None: it takes and puts nothing.
        """
        cell = None if what is None else what.plan.program.cell
        if what is None or cell is None or not cell.parts:
            ended = await self._engine.perform(job, program)
            self.kept.stands(ended.joints)
            return ended
        try:
            ended = await self._engine.perform(job, program)
        except BaseException:
            self.kept.doubt(cell, f"{what.program.name} was ended by something unforeseen")
            raise
        outputs = {} if ended.well else await self._outputs(cell)
        # bodies are looked at, which may take a while
        await self._beside(self.kept.performed, what, ended, outputs)
        return ended

    async def perform_text(self, job: Job, program: Job, cell: Cell | None) -> Ended:
        """Carry a controller text out whose steps aren't known: if it sets a gripper, nobody knows then where the parts are."""
        ended = await self._engine.perform(job, program)
        sets = {
            variable
            for each in (job, *(leg.job for leg in job.legs if leg.job))
            for _, variable, _ in each.sets
        }
        if cell is not None and sets & {*cell.grips, *cell.removals}:
            self.kept.doubt(
                cell, f"{program.name} has moved them, and it isn't followed what a controller text does"
            )
        self.kept.stands(ended.joints)
        return ended

    async def perform_live(self, live: Live) -> Ended:
        """Carry a live motion out; for work of `Engine.move`."""
        ended = await self._engine.perform_live(live)
        self.kept.stands(ended.joints)
        return ended

    async def _outputs(self, cell: Cell) -> dict[str, float]:
        """Ask for the outputs that move parts; without those that can't be asked."""
        session, found = self._engine.session, dict[str, float]()
        with contextlib.suppress(Trouble, Lost):
            for variable in (*cell.grips, *cell.removals):
                (found[variable],) = await session.perform(
                    session.scripts.read(session.operation, (variable,))
                )
        return found
