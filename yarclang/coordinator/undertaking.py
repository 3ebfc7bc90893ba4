"""A program as it is carried out: the way to its start, then all of it, command by command, or again and again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from yarclang.coordinator.backwards import Passed, passed
from yarclang.coordinator.history import History
from yarclang.coordinator.messages.events import PartBegan, Paused
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.resting import resting_place
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import Event

if TYPE_CHECKING:
    from yarclang.coordinator.coordinator import Coordinator

TO_THE_START = "to the start"
"""What the command of an approach is called."""


class Undertaking:
    """Carries a program out, and tells how far it is.

    Args:
        loaded: the program.
        coordinator: whose robot is moved.
        times: how often; None: until somebody stops it.

    Attributes:
        loaded: the program.
        times: how often; None: until somebody stops it.
        on_the_way: whether the robot is between where it stood and the program's start.
        moved: whether it has moved at all.
        passes: how often the program was begun.
    """

    def __init__(self, loaded: Loaded, coordinator: Coordinator, times: int | None = 1) -> None:
        self.loaded = loaded
        self.times = times
        self.on_the_way = False
        self.moved = False
        self.passes = 0
        self._coordinator = coordinator
        self._session = coordinator.engine.session
        self._done: list[Passed] = []

    async def carry_out(self, way: Job | None) -> Ended:
        """Carry out the way to the start, then the program."""
        steps = self.loaded.steps
        if way is not None:
            self._tell(way, 1, 1, to_the_start=True)
            self.on_the_way = True
            ended = await self._perform(way)
            if not ended.well:
                # its command is none of the program's
                return replace(ended, command="", command_index="", done=0.0, concerns=None)
            self.on_the_way = False
        ended = Ended(True)
        for number, job in enumerate(self._jobs()):
            # behind the way to the start, too: who goes step by step begins each step
            waits = steps and (number or way is not None)
            if waits and (stopped := await self._pause(job, number)) is not None:
                return stopped
            self._tell(job, number + 1, len(steps) or self.times)
            ended = await self._perform(job)
            self._note(number, ended)
            if not ended.well:
                break
        return ended

    def remember(self, history: History) -> None:
        """Note in the history which motions were carried out: they can be taken back."""
        plan = self.loaded.plan
        if plan is not None and self._done:
            history.ran(tuple(self._done), plan.program)

    def _jobs(self) -> Iterator[Job]:
        """The jobs of the program itself: once, in steps, or again and again."""
        if self.loaded.steps:
            yield from self.loaded.steps
            return
        job = self.loaded.rest
        while self.times is None or self.passes < self.times:
            self.passes += 1
            yield job
            job = self.loaded.program

    def _tell(self, job: Job, number: int, of: int | None, *, to_the_start: bool = False) -> None:
        coordinator = self._coordinator
        coordinator.announce(
            PartBegan(
                time_s=coordinator.time,
                name=TO_THE_START if to_the_start else job.name,
                to_the_start=to_the_start,
                offset_s=job.offset,
                duration_s=job.duration,
                number=number,
                of=of,
            )
        )

    async def _perform(self, job: Job) -> Ended:
        ended = await self._coordinator.engine.perform(job, self.loaded.program)
        self.moved = self.moved or ended.well or bool(ended.command)
        return ended

    def _note(self, number: int, ended: Ended) -> None:
        """Keep the motions that a job of the program has carried out, wholly or in part."""
        loaded = self.loaded
        plan = loaded.plan
        if plan is None:
            return
        begin, end = loaded.spans[number if loaded.steps else min(number, len(loaded.spans) - 1)]
        if ended.well:
            self._done += passed(plan)[begin:end]
            return
        if ended.joints is None or not ended.command:
            return
        there = resting_place(plan, loaded.program, ended.joints, ended.done)
        if there is None:
            return
        at = loaded.program.commands.index(there.command)
        time = float(plan.starts[at]) + there.done - there.command.begins
        self._done += passed(plan, ended.joints, time)[begin:]

    async def _pause(self, job: Job, number: int) -> Ended | None:
        """Wait until somebody wants the next step; how it ended, if nobody does."""
        coordinator, session = self._coordinator, self._session
        title = job.commands[0].title if job.commands else "the next command"
        coordinator.announce(
            Paused(time_s=coordinator.time, title=title, number=number + 1, of=len(self.loaded.steps))
        )
        ends = await session.pause()
        if (failure := session.failure) is not None:
            session.failure = None
            session.operation.go(Event.FAULT, failure.what)
            return Ended(False, failure.what, failure.remedy, job.start, done=job.offset)
        if ends:
            session.operation.go(Event.STOP, f"ended before {title}")
            return Ended(False, f"ended before {title}", joints=job.start, done=job.offset)
        return None
