"""Execution of all motions, and tracking of the cell's parts (workpieces and tools).

All motions are executed here, so the places of the parts are known after each motion.
"""

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
"""Type of a function that runs a planning function, in another thread or directly.

It takes the planning function and its arguments, and returns its result.
"""


class Carrying:
    """Executes all motions, and keeps track of the places of the cell's parts (workpieces and tools).

    Args:
        robot: the robot.
        engine: executes the motions.
        plan: runs planning functions, one at a time.
        beside: runs a function in parallel with planning in progress.

    Attributes:
        kept: the places of the parts.
    """

    def __init__(self, robot: Robot, engine: Engine, plan: Planning, beside: Planning) -> None:
        self.kept = KeptParts(robot)
        self._robot = robot
        self._engine = engine
        self._plan = plan
        self._beside = beside

    async def way_to_start(self, loaded: Loaded, position: Array) -> Way:
        """Return the motion from the robot's position to the start of a program.

        Args:
            loaded: the program.
            position: (n,) position of the robot [rad or m].

        Raises:
            Trouble: the parts aren't in the places that were assumed in the program's proof.
        """
        self.kept.check(loaded.around, loaded.assumed)
        around = (
            None if loaded.around is None else self.kept.now(replace(loaded.around, present=None), position)
        )
        way: Way = await self._plan(way_to_start, self._robot, loaded, position, around)
        return way

    async def renewed(self, loaded: Loaded, number: int) -> Loaded | Ended:
        """Return a program for its next pass. If the previous pass has moved parts of the cell, the program
        is proved again with their new places.

        Args:
            loaded: the program.
            number: number of the next pass.

        Returns:
            The program; the outcome of the run instead if the next pass can't be proved.
        """
        plan, stands = loaded.plan, loaded.program.end
        given = loaded.around if plan is None else plan.program.cell
        assumed = None if given is None or not given.parts else first_parts(given)
        try:
            self.kept.check(given, assumed)
        except Trouble as trouble:
            renewed: Result[Loaded] | None = None
            if plan is not None and loaded.again is not None:
                renewed = await self._plan(loaded.again, self.kept.now)
            if renewed is not None and renewed.value is not None:
                return renewed.value
            errors = () if renewed is None else tuple(one for one in renewed.diagnostics if one.is_error)
            what = errors[0].message if errors else trouble.what
            return Ended(
                False,
                f"pass {number} isn't started: {what}",
                (errors[0].help or "") if errors else trouble.remedy,
                stands,
                code=errors[0].code if errors else trouble.code,
            )
        return loaded

    async def perform(
        self, job: Job, program: Job | None = None, performed: Performed | None = None
    ) -> Ended:
        """Carry a job out, and store the places of the cell's parts after it. Call this only from a function
        that was passed to `Engine.move`.

        Args:
            job: job that is streamed.
            program: the whole program to which the job belongs.
            performed: steps of the plan that the job carries out; None: the job moves no parts.
        """
        cell = None if performed is None else performed.plan.program.cell
        if performed is None or cell is None or not cell.parts:
            ended = await self._engine.perform(job, program)
            self.kept.stands(ended.joints)
            return ended
        try:
            ended = await self._engine.perform(job, program)
        except BaseException:
            self.kept.doubt(cell, f"{performed.program.name} was ended by an unexpected error")
            raise
        outputs = {} if ended.well else await self._outputs(cell)
        # In a thread, because comparing the bodies of parts may take a while.
        await self._beside(self.kept.performed, performed, ended, outputs)
        return ended

    async def perform_text(self, job: Job, program: Job, cell: Cell | None) -> Ended:
        """Carry out a program of which only the controller text is known. Its steps are unknown, so parts
        can't be tracked: if the text sets a gripper's output, the places of the cell's parts are unknown
        afterwards.
        """
        ended = await self._engine.perform(job, program)
        sets = {
            variable
            for each in (job, *(leg.job for leg in job.legs if leg.job))
            for _, variable, _ in each.sets
        }
        if cell is not None and sets & {*cell.grips, *cell.removals}:
            self.kept.doubt(
                cell,
                f"{program.name} may have moved them, since the places of parts aren't tracked for "
                "a controller text",
            )
        self.kept.stands(ended.joints)
        return ended

    async def perform_live(self, live: Live) -> Ended:
        """Carry a live motion out. Call this only from a function that was passed to `Engine.move`."""
        ended = await self._engine.perform_live(live)
        self.kept.stands(ended.joints)
        return ended

    async def _outputs(self, cell: Cell) -> dict[str, float]:
        """Return the values of the outputs of grippers and of machines that remove parts, as far as they can
        be read now.
        """
        session, levels = self._engine.session, dict[str, float]()
        with contextlib.suppress(Trouble, Lost):
            for variable in (*cell.grips, *cell.removals):
                (levels[variable],) = await session.perform(
                    session.scripts.read(session.operation, (variable,))
                )
        return levels
