"""A client's actions for motions whose end is known in advance (offers, programs, stops, the override), and
the position of the robot.
"""

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
    """The position of the robot: the commanded `joints` (n,) [rad or m], and the pose `base_from_moving` (4,
    4) [m] of the moving frame in the requested frame.
    """

    joints: Array
    base_from_moving: Array


class Motion(Part):
    """Group of a client's actions: move and stop the robot, and ask for its position."""

    # position

    async def stands(self) -> Array:
        """Request and return the robot's commanded position (n,) [rad or m].

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        return await self._coordinator.stands()

    async def where(self, base: str = "{B}", moving: str = "{TCP}") -> Result[Where]:
        """Return the position of the robot: its joints, and the pose of a frame in another frame.

        Args:
            base: frame in which the pose is given; any frame that a motion may name as its base.
            moving: frame whose pose is returned; any frame that a motion may move.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        names = self._coordinator.names
        around, moved = names.base(base), names.moving(moving)
        findings = (*moved.diagnostics, *around.diagnostics)
        if around.value is None or moved.value is None:
            return Result(None, findings)
        joints = await self._coordinator.stands()
        pose = tool_poses(self._coordinator.robot.chain, joints[None], np.asarray(moved.value.transform))[0]
        return Result(Where(joints, np.linalg.inv(around.value.transform) @ pose), findings)

    # planning

    async def offer(self, text: str) -> Result[Offer]:
        """Plan and certify lines that begin at the robot's present position. All declarations that were
        accepted before apply to them. Nothing moves.

        Every client may do this. For an empty text, neither an offer nor a finding is returned.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        coordinator = self._coordinator
        start = await coordinator.stands()
        await coordinator.look_around()
        number = next(coordinator.numbers)
        offered: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, coordinator.lines, start, number
        )
        if offered.diagnostics:
            coordinator.announce(
                Found(
                    time_s=coordinator.time,
                    client=self._name,
                    findings=finding_messages(offered.diagnostics),
                )
            )
        return offered

    async def offer_back(self) -> Result[Offer]:
        """Plan and certify a motion back along the path of the last motion. The motions before it are driven
        back as well, as far as the robot passed from one to the next without a stop.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        coordinator = self._coordinator
        start = await coordinator.stands()
        last = coordinator.history.last()
        if last is None or not stands_there(coordinator.robot, start, last[0][-1].end):
            problem = "nothing has moved yet" if last is None else "the robot was moved since its last motion"
            return Result(None, (Diagnostic("Y1614", f"there is no motion to reverse: {problem}"),))
        group, before = last
        program = backwards(coordinator.robot, group, before)
        if isinstance(program, Diagnostic):
            return Result(None, (program,))
        await coordinator.look_around()
        if program.cell is not None and not await coordinator.plan(holds_still, program.cell):
            problem = "the cell has changed since the last motion"
            help_ = "move the robot with a new command: it is proved against the cell as it is now"
            return Result(
                None, (Diagnostic("Y1614", f"there is no motion to reverse: {problem}", help=help_),)
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
            offered = certified(planned.value, request)
            revision = coordinator.lines.revision
            return coordinator.planner.offered(number, text, start, offered, revision)

        offered: Result[Offer] = await coordinator.plan(work)
        if offered.value is None:
            return offered
        return Result(replace(offered.value, takes_back=len(group)), offered.diagnostics)

    async def offer_recovery(self, loaded: Loaded) -> Recovered:
        """Plan and certify a motion from the robot's present position to a program. Nothing moves.

        The motion leads to the program's start, or else to the nearest position at which the program can
        begin.

        Args:
            loaded: the program. If it was loaded to begin at a certain command, only the beginning of this
                command is tried.

        Raises:
            Trouble: the robot is moving, there is no connection, or the places of the cell's parts are
                unknown.
        """
        return await recovered(self._coordinator, loaded)

    async def go(self, offer: Offer) -> Ended:
        """Carry an offer out: accept its declarations, and execute its motions.

        Returns:
            The outcome, even if the motion ended early, for example by a stop.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or the offer is no longer valid.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to move the robot")
        stops = coordinator.stops
        await coordinator.look_around()
        if offer.revision != coordinator.lines.revision:
            problem = "a declaration was added, or the cell has changed, since this motion was offered"
            raise Trouble(problem, "request it again", "Y1613")
        job = offer.job
        if job is None:
            coordinator.lines.declare(offer.parts.declarations)
            return Ended(True, joints=offer.start)
        here = await coordinator.stands()
        if off_the_start(job, here):
            problem = "the robot isn't any more at the position from which this motion was planned"
            raise Trouble(problem, "request it again", "Y1613")
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
        """Check that the cell is still the one for which an offer was planned, and that the cell's parts are
        in the places that the offer's proof assumes.

        Raises:
            Trouble: the cell or the place of a part has changed.
        """
        cell, coordinator = offer.proved_in, self._coordinator
        if cell is None:
            return
        if not await coordinator.plan(holds_still, cell):
            raise Trouble("the cell has changed since this motion was offered", "request it again", "Y1613")
        coordinator.carrying.kept.check(cell, first_parts(cell) if cell.parts else None)

    async def run(self, loaded: Loaded, *, approach: bool = False, times: int | None = 1) -> Ended:
        """Run a whole program that was loaded by `Files.load`.

        `loaded` determines at which command the run begins, and if the commands are run one by one. The
        program waits for `resume` before each such single command and at each HOLD.

        Args:
            loaded: the program.
            approach: if True, first move slowly to the start if the robot isn't there. If the robot is in a
                start zone of the cell, this is always done.
            times: number of passes; None: until somebody stops the program.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or the robot isn't at the start of the program.
        """
        undertaking = Undertaking(loaded, self._coordinator, times)
        return await self.undertake(undertaking, approach=approach)

    async def undertake(
        self, undertaking: Undertaking, *, approach: bool = False, stops: int | None = None
    ) -> Ended:
        """Run a whole program, like `run`.

        Args:
            undertaking: records the progress of the program, which can be read after the end as well.
            approach: if True, first move slowly to the start.
            stops: value of the coordinator's `stops` when the run was requested. If somebody has ordered a
                stop since the request, the program doesn't begin. None: the run is requested by this call.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or the robot isn't at the start of the program.
        """
        coordinator, loaded = self._coordinator, undertaking.loaded
        coordinator.check_owner(self._name, "to move the robot")
        stops = coordinator.stops if stops is None else stops
        here = await coordinator.stands()
        way = await coordinator.carrying.way_to_start(loaded, here)
        allowed = approach or bool(way.zone)
        if way.text and not (allowed and way.job is not None):
            no_approach = "no joint motion to the start is possible: move the robot there"
            remedy = APPROACH_FIRST if not allowed else no_approach
            raise Trouble(way.text, remedy, code="Y1601")
        if way.text and way.zone and not approach:
            coordinator.tell(
                f"{way.text}; the robot is in the start zone {way.zone}: it moves there without confirmation"
            )
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

    # immediate actions

    def stop(self) -> None:
        """Bring the robot to rest on its path, and end the current action. Allowed for every client. A stop
        is executed before all waiting orders.
        """
        self._coordinator.stop()

    def abort(self) -> None:
        """Bring each motor to rest at once, off the path. Allowed for every client."""
        self._coordinator.abort()

    def hold(self) -> None:
        """Bring the robot to rest on its path, ready to continue. Allowed for every client."""
        self._coordinator.hold()

    def resume(self, answer: int | None = None) -> None:
        """Continue after a hold, at a HOLD of the program, or with the next command of a program that is run
        command by command.

        Args:
            answer: answer to the question of the HOLD.

        Raises:
            NotOwner: this client only watches, and the owner doesn't share the robot.
        """
        coordinator = self._coordinator
        coordinator.check_pace(self._name, "to go on")
        session = coordinator.engine.session
        # A hold that was ordered but not processed yet also counts.
        if session.paused or coordinator.state is State.HOLD or Hold() in session.operation.orders:
            session.order(Resume(answer))

    def override(self, percent: float) -> None:
        """Set the override of the current action and of all later ones.

        Args:
            percent: percentage of the programmed speed, 1 to 100.

        Raises:
            NotOwner: this client only watches, and the owner doesn't share the robot.
            Trouble: the number is out of range.
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
        """Inspect the controller after a fault. If everything is in order, motions are possible again.

        Raises:
            NotOwner: this client only watches.
            Trouble: something isn't in order.
        """
        self._coordinator.check_owner(self._name, "to clear a fault")
        await self._coordinator.engine.clear()


def _performed(offer: Offer, job: Job) -> Performed | None:
    """Return the steps of an offer whose effects on parts are tracked; None if its cell contains no parts."""
    plan = offer.plan
    if plan is None or plan.program.cell is None or not plan.program.cell.parts:
        return None
    return Performed(plan, 0, len(plan.program.steps), job, first_parts(plan.program.cell))
