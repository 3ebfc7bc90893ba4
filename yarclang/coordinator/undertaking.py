"""A program as it is carried out: the way to its start, then all of it, command by command, or again and again."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterator
from dataclasses import replace
from typing import Protocol

from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.programs import Loaded
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import Event

TO_THE_START = "to the start"
"""What the command of an approach is called."""


class Watcher(Protocol):
    """Who is told how far it is, between two jobs."""

    def begins(self, job: Job, *, instead: str = "", brief: bool = False) -> None:
        """A job begins; its command is called `instead`, if that isn't empty; `brief`: it is one of many."""

    def pauses(self, title: str, number: int, of: int) -> None:
        """It stands until somebody wants the command called `title`, the next one: `number` of so many."""

    def passes(self, number: int, of: int | None) -> None:
        """Once more: the pass `number` of so many, or without end."""


class Undertaking:
    """Carries a program out.

    Args:
        loaded: the program.
        session: where people's orders come in.
        perform: carries one job out.
        watcher: who is told.
        times: how often; None: until somebody stops it.

    Attributes:
        on_the_way: whether the robot is between where it stood and the program's start.
        moved: whether it has moved at all.
        passes: how often the program was begun.
    """

    def __init__(
        self,
        loaded: Loaded,
        session: OrderedSession,
        perform: Callable[[Job], Awaitable[Ended]],
        watcher: Watcher,
        times: int | None = 1,
    ) -> None:
        self.on_the_way = False
        self.moved = False
        self.passes = 0
        self._loaded = loaded
        self._session = session
        self._perform_job = perform
        self._watcher = watcher
        self._times = times

    async def carry_out(self, way: Job | None) -> Ended:
        """The way to the start, then the program."""
        watcher, steps = self._watcher, self._loaded.steps
        if way is not None:
            watcher.begins(way, instead=TO_THE_START)
            self.on_the_way = True
            ended = await self._perform(way)
            if not ended.well:
                # its command is none of the program's
                return replace(ended, command="", command_index="", done=0.0, concerns=None)
            self.on_the_way = False
        ended = Ended(True)
        for number, job in enumerate(self._jobs()):
            if number and steps and (stopped := await self._pause(job, number)) is not None:
                return stopped
            if number and not steps:
                watcher.passes(self.passes, self._times)
            watcher.begins(job, brief=bool(number or steps))
            ended = await self._perform(job)
            if not ended.well:
                break
        return ended

    def _jobs(self) -> Iterator[Job]:
        """The jobs of the program itself: once, in steps, or again and again."""
        if self._loaded.steps:
            yield from self._loaded.steps
            return
        job = self._loaded.rest
        while self._times is None or self.passes < self._times:
            self.passes += 1
            yield job
            job = self._loaded.program

    async def _perform(self, job: Job) -> Ended:
        ended = await self._perform_job(job)
        self.moved = self.moved or ended.well or bool(ended.command)
        return ended

    async def _pause(self, job: Job, number: int) -> Ended | None:
        """Until somebody wants the next step; how it ended, if nobody does."""
        operation = self._session.operation
        title = job.commands[0].title if job.commands else "the next command"
        self._watcher.pauses(title, number + 1, len(self._loaded.steps))
        ends = await self._session.pause()
        if (failure := self._session.failure) is not None:
            operation.go(Event.FAULT, failure.what)
            return Ended(False, failure.what, failure.remedy, job.start, done=job.offset)
        if ends:
            operation.go(Event.STOP, f"ended before {title}")
            return Ended(False, f"ended before {title}", joints=job.start, done=job.offset)
        return None
