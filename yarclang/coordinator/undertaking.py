"""Execution of a program: the motion to its start, then the program itself, as a whole, command by command,
or repeatedly.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from yarclang.coordinator.backwards import Passed, known_behind_searches, passed
from yarclang.coordinator.carried_out import taken
from yarclang.coordinator.history import History
from yarclang.coordinator.kept_parts import Performed
from yarclang.coordinator.kept_registers import KeptRegisters, program_of
from yarclang.coordinator.messages.events import PartBegan, Paused
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.resting import resting_place
from yarclang.coordinator.shared import SharedRobot
from yarclang.coordinator.signals import output_names
from yarclang.coordinator.taught_places import teach
from yarclang.pipeline.parts import steps_of
from yarclang.runtime.actions import Replan, Replanned, Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import Event

TO_THE_START = "to the start"
"""Name of the motion to a program's start."""

BACK_ON_PATH = "back to the start of the motion"
"""Name of the motion with which a retreat begins. The motion leads back along the path to the beginning of
the held motion.
"""

_SAME_TIME = 1e-6
"""Largest difference of two times that count as equal [s]. A command is found by the time of its beginning.
"""


class Undertaking:
    """Carries a program out, and tracks its progress.

    Args:
        loaded: the program.
        coordinator: the robot's coordinator.
        times: number of passes; None: until somebody stops the program.

    Attributes:
        loaded: the program.
        times: number of passes; None: until somebody stops the program.
        on_the_way: True if the robot is on the way to the program's start.
        moved: True if the robot has moved at all.
        passes: number of passes begun so far.
    """

    def __init__(self, loaded: Loaded, coordinator: SharedRobot, times: int | None = 1) -> None:
        self.loaded = loaded
        self.times = times
        self.on_the_way = False
        self.moved = False
        self.passes = 0
        self._coordinator = coordinator
        self._session = coordinator.engine.session
        self._done: list[Passed] = []
        self._taken: frozenset[int] = frozenset()
        """Steps of the plan that the last job has passed on the executed branches."""
        self._registers: dict[str, int] = {}
        """Values of the registers at the end of the last job. The next command or pass begins with these
        values.
        """

    async def carry_out(self, way: Job | None) -> Ended:
        """Carry out the motion to the start, then the program."""
        try:
            self._begin_registers()
        except Trouble as trouble:
            return Ended(False, trouble.what, trouble.remedy, code=trouble.code)
        self._session.replanner = self._replan
        try:
            return await self._carry_out(way)
        finally:
            # The next action may execute another program.
            self._session.replanner = None

    async def _carry_out(self, way: Job | None) -> Ended:
        steps = self.loaded.steps
        self._session.operation.outputs = output_names(self.loaded.origins().program, self.loaded.around)
        if way is not None:
            self._tell(way, 1, 1, to_the_start=True)
            self.on_the_way = True
            ended = await self._perform(way, None)
            if not ended.well:
                # The motion to the start isn't a command of the program.
                return replace(ended, command="", command_index="", done=0.0, concerns=None)
            self.on_the_way = False
        ended = Ended(True)
        number = 0
        while (job := self._next(number)) is not None:
            # The user starts each command. If the robot has moved to the start, the first command also waits
            # for the user.
            waits = steps and (number or way is not None)
            if waits and (stopped := await self._pause(job, number)) is not None:
                return stopped
            self._tell(job, number + 1, len(steps) or self.times)
            ended = await self._perform(job, number)
            self._note(number, ended)
            if ended.leaves:
                return await self._leave(ended)
            number += 1
            if not ended.well or (steps and ended.finished):
                break
            if not steps and (self.times is None or self.passes < self.times):
                renewed = await self._coordinator.carrying.renewed(self.loaded, number + 1)
                if isinstance(renewed, Ended):
                    return renewed
                self.loaded = renewed
        return ended

    async def _leave(self, outcome: Ended) -> Ended:
        """Carry out the retreat after an input has held a motion: back on the path, then the motions out. All
        motions of the retreat are proved before the first one begins.

        Args:
            outcome: outcome of the job whose motion was held.
        """
        loaded, way, joints = self.loaded, outcome.leaves, outcome.joints
        operation = self._session.operation
        plan = loaded.plan or loaded.text_plan
        resting = (
            None
            if plan is None or joints is None
            else resting_place(plan, loaded.program, joints, outcome.done)
        )
        jobs: tuple[Job, ...] | str = (
            f"the path of {way} is known only from the program, and the text was run without it"
        )
        if plan is not None and joints is not None and loaded.leave is not None:
            jobs = "the robot's place on its path is unknown"
            if resting is not None:
                at = loaded.program.commands.index(resting.command)
                time = float(plan.begins[at]) + resting.done - resting.command.begins
                jobs = await self._coordinator.plan(loaded.leave, way, at, time, joints)
        if isinstance(jobs, str):
            problem = f"the robot can't retreat by {way}: {jobs}"
            remedy = "the robot is on its path; move it from there by hand, or continue with --from"
            operation.go(Event.FAULT, problem, "Y1638", remedy)
            return replace(outcome, what=problem, remedy=remedy, code="Y1638", leaves="")
        operation.remark(f"the path back and {way} are planned and proved from the robot's position")
        self._done.clear()  # after the retreat, the robot can't drive the program's motions back
        for number, job in enumerate(jobs, 1):
            coordinator, name = self._coordinator, way if number == len(jobs) else BACK_ON_PATH
            coordinator.behind = sum(one.lasting.most for one in jobs[number:])
            coordinator.announce(
                PartBegan(
                    time_s=coordinator.time,
                    name=name,
                    to_the_start=False,
                    offset_s=0.0,
                    duration_s=job.lasting.most,
                    number=number,
                    of=len(jobs),
                    leads_out=True,
                )
            )
            ended = await coordinator.carrying.perform(job, loaded.program)
            if not ended.well:
                problem = f"on the path {'of' if number == len(jobs) else 'back, before'} {way}: {ended.what}"
                return replace(ended, what=problem, command="", command_index="", done=0.0, concerns=None)
        return Ended(
            False,
            f"the program was abandoned by {way}, and has ended there",
            "find the cause; then run it again from its start",
            ended.joints,
            registers=outcome.registers,
        )

    def remember(self, history: History) -> None:
        """Add the motions that were carried out to the history, so that the robot can drive them back."""
        plan = self.loaded.plan
        if plan is not None and self._done:
            history.ran(tuple(self._done), plan.program)

    def _begin_registers(self) -> None:
        """Read the values of KEPT registers that are stored from earlier runs.

        Raises:
            Trouble: the values can't be read.
        """
        loaded, coordinator, session = self.loaded, self._coordinator, self._session
        owner = "simulated" if coordinator.simulated else f"{session.host}:{session.port}"
        source = loaded.plan.program.source.name if loaded.plan is not None else loaded.name
        if source == "<stdin>":
            session.keeper = session.teacher = None
            if names := ", ".join(register.name for register in loaded.program.registers if register.kept):
                told = f"registers of a program from standard input aren't stored: {names} begins anew"
                session.operation.remark(told, warning=True)
            return
        registers = KeptRegisters(f"{coordinator.robot.name} {owner}", program_of(source))
        self._registers, strange = registers.first(loaded.program.registers)
        for register in strange:
            session.operation.remark(register, warning=True)
        session.keeper = registers.keep
        session.teacher = partial(teach, coordinator.robot, registers.controller, registers.program)

    def _replan(self, wanted: Replan) -> Replanned | str | None:
        """Plan the rest of the program from the position at which a search has ended, or the motions of an
        OFFSET. Return None if the program can't be planned again. If planning has failed, return the reason
        as text.
        """
        loaded = self.loaded
        begins = [abs(one.begins - wanted.begins) for one in loaded.program.commands]
        if loaded.behind is None or not begins or min(begins) > _SAME_TIME:
            return None
        return loaded.behind(begins.index(min(begins)), wanted.joints, wanted.values)

    def _next(self, number: int) -> Job | None:
        """Return job `number` of the program, counted from 0; None after the last one. A job is one command
        if the program is run command by command, otherwise one pass of the whole program.
        """
        loaded = self.loaded
        if loaded.steps:
            return loaded.steps[number] if number < len(loaded.steps) else None
        if self.times is not None and self.passes >= self.times:
            return None
        self.passes += 1
        return loaded.program if number else loaded.rest

    def _tell(self, job: Job, number: int, of: int | None, *, to_the_start: bool = False) -> None:
        coordinator = self._coordinator
        ends = job.clock + job.lasting.most
        coordinator.behind = 0.0 if to_the_start else max(0.0, self.loaded.program.lasting.most - ends)
        coordinator.announce(
            PartBegan(
                time_s=coordinator.time,
                name=TO_THE_START if to_the_start else job.name,
                to_the_start=to_the_start,
                offset_s=job.clock,
                duration_s=job.lasting.most,
                number=number,
                of=of,
            )
        )

    async def _perform(self, job: Job, number: int | None) -> Ended:
        """Execute a job. `number` is its number in the program; None for the motion to the start."""
        carrying, loaded = self._coordinator.carrying, self.loaded
        goes_on = self._goes_on(job)
        if number is None:
            ended = await carrying.perform(job, loaded.program)
        elif (plan := loaded.plan or loaded.text_plan) is None:
            ended = await carrying.perform_text(goes_on, loaded.program, loaded.cell)
        else:
            is_lead = not loaded.begins_within or job is loaded.program
            span = self._span(number) if loaded.spans else (0, None)
            is_first = job is not loaded.program and bool(loaded.spans) and span[0] == loaded.spans[0][0]
            step = loaded.first_step if is_first else None
            begin, end = steps_of(plan, *span, with_lead=is_lead, step=step)
            what = Performed(plan, begin, end, loaded.program, loaded.assumed)
            ended = await carrying.perform(goes_on, loaded.program, what)
            self._taken = frozenset(
                taken(plan.program.steps, begin, len(plan.program.steps) if end is None else end, ended.ways)
            )
        self._registers.update(ended.registers)
        self.moved = self.moved or ended.well or bool(ended.command)
        return ended

    def _goes_on(self, job: Job) -> Job:
        """Return the job, changed so that its registers begin with their values at the end of the previous
        job.
        """
        if not job.registers or not self._registers:
            return job
        held = tuple(replace(one, first=self._registers.get(one.name, one.first)) for one in job.registers)
        return replace(job, registers=held)

    def _note(self, number: int, ended: Ended) -> None:
        """Store the motions that a job of the program has carried out completely or in part."""
        self._store(number, ended)
        self._done = known_behind_searches(self._done)

    def _store(self, number: int, ended: Ended) -> None:
        loaded = self.loaded
        plan = loaded.plan
        if plan is None:
            return
        begin, end = self._span(number)
        if ended.well:
            carried_out = passed(plan)[:end]
        else:
            if ended.joints is None or not ended.command:
                return
            there = resting_place(plan, loaded.program, ended.joints, ended.done)
            if there is None:
                return
            at = loaded.program.commands.index(there.command)
            time = float(plan.begins[at]) + there.done - there.command.begins
            carried_out = passed(plan, ended.joints, time)
        for motion, one in list(zip(plan.motions, carried_out, strict=False))[begin:]:
            if motion.step in self._taken:
                self._done.append(replace(one, start=self._done[-1].end) if self._done else one)

    def _span(self, number: int) -> tuple[int, int]:
        """Return the range of a job's motions in the plan: the first, and one after the last."""
        loaded = self.loaded
        return loaded.spans[number if loaded.steps else min(number, len(loaded.spans) - 1)]

    async def _pause(self, job: Job, number: int) -> Ended | None:
        """Wait until somebody orders the next command. Return the outcome of the program if it ends here
        instead; otherwise None.
        """
        coordinator, session = self._coordinator, self._session
        title = job.commands[0].title if job.commands else "the next command"
        coordinator.announce(
            Paused(time_s=coordinator.time, title=title, number=number + 1, of=len(self.loaded.steps))
        )
        ends = await session.pause()
        if (failure := session.failure) is not None:
            session.failure = None
            session.operation.go(Event.FAULT, failure.what, remedy=failure.remedy)
            return Ended(False, failure.what, failure.remedy, job.start, done=job.offset, clock=job.clock)
        if ends:
            session.operation.go(Event.STOP, f"ended before {title}")
            return Ended(False, f"ended before {title}", joints=job.start, done=job.offset, clock=job.clock)
        return None
