"""What moves the robot to an end that is known before: offers, programs, stops, the pace; and where it stands."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from yarclang.coordinator.backwards import backwards
from yarclang.coordinator.client.part import Part
from yarclang.coordinator.history import stands_there
from yarclang.coordinator.kept_parts import Performed
from yarclang.coordinator.messages.events import Found
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.coordinator.messages.orders import APPROACH_FIRST
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.recovering import Recovered, recovered
from yarclang.coordinator.signals import output_names
from yarclang.coordinator.undertaking import Undertaking
from yarclang.diagnostics import Diagnostic, Result
from yarclang.handling.parts import first_parts
from yarclang.pipeline.cells import holds_still
from yarclang.pipeline.stages import certified, plan_program
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.notices import Hold, Override, Resume
from yarclang.runtime.outcome import Ended
from yarclang.runtime.standing import off_the_start
from yarclang.runtime.state import State


@dataclass(frozen=True, slots=True, eq=False)
class Where:
    """Where the robot stands: `joints` (n,) commanded [rad or m], and `base_from_moving` (4, 4), the moving frame in the frame that was asked for."""

    joints: Array
    base_from_moving: Array


class Motion(Part):
    """The part of a client that moves the robot."""

    # where it stands

    async def stands(self) -> Array:
        """Return (n,) where the robot is commanded to stand [rad or m], asked now.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        return await self._coordinator.stands()

    async def where(self, base: str = "{B}", moving: str = "{TCP}") -> Result[Where]:
        """Return where the robot stands, as joints and as the pose of a frame in another.

        Args:
            base: the frame in which the pose is told; any that a motion may name as its base.
            moving: the frame whose pose it is; any that a motion may move.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        names = self._coordinator.names
        around, moved = names.base(base), names.moving(moving)
        found = (*moved.diagnostics, *around.diagnostics)
        if around.value is None or moved.value is None:
            return Result(None, found)
        joints = await self._coordinator.stands()
        pose = tool_poses(self._coordinator.robot.chain, joints[None], np.asarray(moved.value.transform))[0]
        return Result(Where(joints, np.linalg.inv(around.value.transform) @ pose), found)

    # what is planned

    async def offer(self, text: str) -> Result[Offer]:
        """Plan and certify a line, a block or several lines from where the robot stands, behind all that was accepted. Nothing moves.

        Anybody may ask. Empty text gives no offer and no finding.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        coordinator = self._coordinator
        start = await coordinator.stands()
        await coordinator.look_around()
        number = next(coordinator.numbers)
        made: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, coordinator.lines, start, number
        )
        if made.diagnostics:
            coordinator.announce(
                Found(
                    time_s=coordinator.time,
                    client=self._name,
                    findings=finding_messages(made.diagnostics),
                )
            )
        return made

    async def offer_back(self) -> Result[Offer]:
        """Plan and certify the last motion backwards, along the same path, with all that it flowed together with.

        Raises:
            Trouble: as `offer`.
        """
        coordinator = self._coordinator
        start = await coordinator.stands()
        last = coordinator.history.last()
        if last is None or not stands_there(coordinator.robot, start, last[0][-1].end):
            what = "nothing has moved yet" if last is None else "the robot was moved since its last motion"
            return Result(None, (Diagnostic("Y1614", f"there is no motion to take back: {what}"),))
        group, before = last
        program = backwards(coordinator.robot, group, before)
        if isinstance(program, Diagnostic):
            return Result(None, (program,))
        await coordinator.look_around()
        if program.cell is not None and not await coordinator.plan(holds_still, program.cell):
            what = "the cell has changed since the last motion"
            help_ = "move the robot with a new command: it is proved against the cell as it is now"
            return Result(
                None, (Diagnostic("Y1614", f"there is no motion to take back: {what}", help=help_),)
            )
        program = replace(program, start=start)
        if program.cell is not None:
            around = replace(program.cell, present=None)
            program = replace(program, cell=coordinator.carrying.kept.now_for_lines(around, start))
        request = coordinator.planner.request(start)
        number = next(coordinator.numbers)
        text = f"back: {group[-1].step.origin.name}"

        def work() -> Result[Offer]:
            planned = plan_program(program, request)
            if planned.value is None:
                return Result(None, planned.diagnostics)
            made = certified(planned.value, request)
            revision = coordinator.lines.revision
            return coordinator.planner.offered(number, text, start, made, revision)

        made: Result[Offer] = await coordinator.plan(work)
        if made.value is None:
            return made
        return Result(replace(made.value, takes_back=len(group)), made.diagnostics)

    async def offer_recovery(self, loaded: Loaded) -> Recovered:
        """Plan and certify the way from where the robot stands to a program: to its start, else to the nearest place at which it may begin. Nothing moves.

        Args:
            loaded: the program; if a command was named to begin with, there and nowhere else.

        Raises:
            Trouble: as `offer`; or nobody knows where the parts of its cell are.
        """
        return await recovered(self._coordinator, loaded)

    async def go(self, offer: Offer) -> Ended:
        """Carry an offer out: its declarations stay from now on, its motions move the robot.

        Returns:
            How it has ended; a stop, for example, is an end that isn't well.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is under way, or what was offered doesn't hold any more.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to move the robot")
        stops = coordinator.stops
        await coordinator.look_around()
        if offer.revision != coordinator.lines.revision:
            what = "a declaration has come, or the cell has changed, since this was offered"
            raise Trouble(what, "ask for it again", "Y1613")
        job = offer.job
        if job is None:
            coordinator.lines.declare(offer.parts.declarations)
            return Ended(True, joints=offer.start)
        here = await coordinator.stands()
        if off_the_start(job, here):
            what = "the robot doesn't stand any more where this was planned from"
            raise Trouble(what, "ask for it again", "Y1613")
        await self._check_surroundings(offer)
        followed = _performed(offer, job)
        if followed is not None:
            coordinator.carrying.kept.check(followed.plan.program.cell, followed.assumed)
        names = {} if offer.plan is None else output_names(offer.plan.program, offer.plan.program.cell)

        async def work() -> Ended:
            coordinator.engine.operation.outputs = names
            return await coordinator.carrying.perform(job, None, followed)

        ended = await coordinator.carry_out(
            self._name,
            offer.title,
            job.lasting,
            work,
            stops,
        )
        coordinator.history.add(offer, ended)
        coordinator.lines.count += offer.parts.count
        if ended.well:
            coordinator.lines.declare(offer.parts.declarations)
        return ended

    async def _check_surroundings(self, offer: Offer) -> None:
        """Check that the cell that an offer was proved in is the same, and that its parts are where they were.

        Raises:
            Trouble: something has changed.
        """
        cell, coordinator = offer.proved_in, self._coordinator
        if cell is None:
            return
        if not await coordinator.plan(holds_still, cell):
            raise Trouble("the cell has changed since this was offered", "ask for it again", "Y1613")
        coordinator.carrying.kept.check(cell, first_parts(cell) if cell.parts else None)

    async def run(self, loaded: Loaded, *, approach: bool = False, times: int | None = 1) -> Ended:
        """Carry a whole program out; `load_program` makes it, from a command on or command by command, if that is wanted.

        Between two commands that are carried out one by one, and at a HOLD, `resume` goes on.

        Args:
            loaded: the program.
            approach: whether to move slowly to its start first, if the robot isn't there. In a start zone of the cell that needs nobody's word.
            times: how often; None: until somebody stops it.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is under way, or the robot isn't where the program starts.
        """
        undertaking = Undertaking(loaded, self._coordinator, times)
        return await self.undertake(undertaking, approach=approach)

    async def undertake(
        self, undertaking: Undertaking, *, approach: bool = False, stops: int | None = None
    ) -> Ended:
        """Carry a whole program out, as `run` does.

        Args:
            undertaking: knows how far it is, also behind its end.
            approach: as of `run`.
            stops: how many stops were wanted when this was asked for: behind another one nothing begins. None: it is asked for now.

        Raises:
            NotOwner, Trouble: as `run`.
        """
        coordinator, loaded = self._coordinator, undertaking.loaded
        coordinator.check_owner(self._name, "to move the robot")
        stops = coordinator.stops if stops is None else stops
        here = await coordinator.stands()
        way = await coordinator.carrying.way_to_start(loaded, here)
        allowed = approach or bool(way.zone)
        if way.text and not (allowed and way.job is not None):
            remedy = APPROACH_FIRST if not allowed else "there is no joint motion to the start: move it there"
            raise Trouble(way.text, remedy, code="Y1601")
        if way.text and way.zone and not approach:
            coordinator.tell(f"{way.text}; it stands in the start zone {way.zone}: it goes there by itself")
        lasting = loaded.rest.lasting
        if undertaking.times is not None and undertaking.times > 1:
            lasting = lasting.then(loaded.program.lasting.times(undertaking.times - 1))
        if way.job is not None:
            lasting = way.job.lasting.then(lasting)
        try:
            return await coordinator.carry_out(
                self._name, loaded.name, lasting, lambda: undertaking.carry_out(way.job), stops
            )
        finally:
            undertaking.remember(coordinator.history)

    # what happens at once

    def stop(self) -> None:
        """Come to rest on the path and end what is under way. Overtakes everything; for everybody."""
        self._coordinator.stop()

    def abort(self) -> None:
        """Each motor comes to rest at once, off the path. For everybody."""
        self._coordinator.abort()

    def hold(self) -> None:
        """Come to rest on the path, ready to go on. For everybody."""
        self._coordinator.hold()

    def resume(self, answer: int | None = None) -> None:
        """Go on: behind a hold, at a HOLD of the program, to the next step.

        Args:
            answer: what the HOLD has asked for.

        Raises:
            NotOwner: this client only watches.
        """
        coordinator = self._coordinator
        coordinator.check_pace(self._name, "to go on")
        session = coordinator.engine.session
        # a hold that wasn't looked at yet is a hold
        if session.paused or coordinator.state is State.HOLD or Hold() in session.operation.orders:
            session.order(Resume(answer))

    def override(self, percent: float) -> None:
        """Another pace, for what is under way and what comes: `percent` of the programmed speed, 1 to 100.

        Raises:
            NotOwner: this client only watches.
            Trouble: the number isn't one.
        """
        coordinator = self._coordinator
        coordinator.check_pace(self._name, "to change the override")
        if not 1.0 <= percent <= 100.0:
            raise Trouble(f"an override of {percent:g} %", "it may be 1 to 100", code="Y1601")
        engine = coordinator.engine
        if engine.under_way:
            engine.session.order(Override(percent))
        else:
            engine.operation.override = percent / 100.0
            coordinator.tell(f"override {percent:g} %")
            coordinator.tell_override()

    async def clear(self) -> None:
        """Look at the controller behind a fault; where all is well, motions are possible again.

        Raises:
            NotOwner: this client only watches.
            Trouble: it isn't well, and why.
        """
        self._coordinator.check_owner(self._name, "to clear a fault")
        await self._coordinator.engine.clear()


def _performed(offer: Offer, job: Job) -> Performed | None:
    """Return what of an offer is followed: nothing if no part is in its cell."""
    plan = offer.plan
    if plan is None or plan.program.cell is None or not plan.program.cell.parts:
        return None
    return Performed(plan, 0, len(plan.program.steps), job, first_parts(plan.program.cell))
