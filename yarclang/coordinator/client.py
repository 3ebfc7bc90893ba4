"""What one client of a coordinator may do: the API of interpreters, pendants and bridges."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import replace

from yarclang.collision.zones.watched import Moving
from yarclang.coordinator.backwards import backwards
from yarclang.coordinator.commanding import Commanding
from yarclang.coordinator.events import Began, Finished, Found, Message
from yarclang.coordinator.history import stands_there
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.live.drive import Drive, check_finite
from yarclang.coordinator.live.opening import Settings, live_motion
from yarclang.coordinator.live.steering import Target
from yarclang.coordinator.offers import Offer
from yarclang.coordinator.programs import Loaded, way_to_start
from yarclang.coordinator.undertaking import Undertaking
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import LineMove
from yarclang.pipeline.stages import certified, plan_program
from yarclang.runtime.actions import Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.runtime.rest import off_the_start

LIVE = Settings()
"""How live motions are made, unless somebody says otherwise."""


class Client(Commanding):
    """One client. What moves the robot, or changes the session, is for its owner: else `NotOwner`.

    What a user does wrong in a text is a finding; what can't be done now is a `Trouble`, which says what, why and what to do.

    Attributes:
        name: what others know it by.
    """

    async def offer(self, text: str) -> Result[Offer]:
        """Plan and certify a line, a block or several lines from where the robot stands, behind all that was accepted. Nothing moves.

        Anybody may ask. Empty text gives no offer and no finding.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        coordinator = self._coordinator
        start = await coordinator.stands()
        number = next(coordinator.numbers)
        made: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, coordinator.lines, start, number
        )
        if made.diagnostics:
            coordinator.announce(Found(coordinator.now, self.name, text, made.diagnostics))
        return made

    async def adopt(self, declarations: tuple[str, ...]) -> Result[tuple[str, ...]]:
        """These declarations hold from now on, in the place of all that were accepted before: of a file, or one of them touched up.

        Returns:
            None, with findings, where they can't; then those before hold on.

        Raises:
            NotOwner: this client only watches.
            Trouble: the robot is under way, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to change the session")
        start = await coordinator.stands()
        text = "\n".join(declarations)
        made: Result[Offer] = await coordinator.plan(
            coordinator.planner.offer, text, Lines(), start, next(coordinator.numbers)
        )
        if text and made.value is None:
            return Result(None, made.diagnostics)
        coordinator.lines.adopt(declarations)
        return Result(declarations, made.diagnostics)

    async def offer_back(self) -> Result[Offer]:
        """The last motion backwards, along the same path, planned and certified like any other; with all that it flowed together with.

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
        program = replace(program, start=start)
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

    async def go(self, offer: Offer) -> Ended:
        """Carry an offer out: its declarations stay from now on, its motions move the robot.

        Returns:
            How it has ended; a stop, for example, is an end that isn't well.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is under way, or what was offered doesn't hold any more.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to move the robot")
        stops = coordinator.stops
        if offer.revision != coordinator.lines.revision:
            raise Trouble("a declaration has come since this was offered", "ask for it again", "Y1613")
        job = offer.job
        if job is None:
            coordinator.lines.declare(offer.parts.declarations)
            return Ended(True, joints=offer.start)
        here = await coordinator.stands()
        if off_the_start(job, here):
            what = "the robot doesn't stand any more where this was planned from"
            raise Trouble(what, "ask for it again", "Y1613")
        ended = await self._carry_out(
            offer.title, job.duration, lambda: coordinator.engine.perform(job), stops
        )
        coordinator.history.add(offer, ended)
        coordinator.lines.count += offer.parts.count
        if ended.well:
            coordinator.lines.declare(offer.parts.declarations)
        return ended

    async def run(self, loaded: Loaded, *, approach: bool = False, times: int | None = 1) -> Ended:
        """Carry a whole program out; `load_program` makes it, from a command on or command by command, if that is wanted.

        Between two commands that are carried out one by one, and at a HOLD, `resume` goes on.

        Args:
            loaded: the program.
            approach: whether to move slowly to its start first, if the robot isn't there.
            times: how often; None: until somebody stops it.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is under way, or the robot isn't where the program starts.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to move the robot")
        stops = coordinator.stops
        here = await coordinator.stands()
        way = way_to_start(coordinator.robot, loaded, here)
        if way.text and not (approach and way.job is not None):
            remedy = (
                "approach it first"
                if not approach
                else "there is no joint motion to the start: move it there"
            )
            raise Trouble(way.text, remedy, code="Y1601")
        undertaking = Undertaking(
            loaded, coordinator.engine.session, coordinator.engine.perform, _Telling(self._told), times
        )
        duration = loaded.rest.duration * (times or 1) + (way.job.duration if way.job else 0.0)
        return await self._carry_out(loaded.name, duration, lambda: undertaking.carry_out(way.job), stops)

    async def drive(
        self, target: Target, *, moving: str = "{TCP}", settings: Settings = LIVE, name: str = "jog"
    ) -> Result[Drive]:
        """Begin a live motion: a jog, a velocity, or a master that is followed. It goes on as long as something is wanted of it.

        Args:
            target: what is wanted at first.
            moving: the frame that twists move, and whose speed is limited.
            settings: how fast at most.
            name: what it is called.

        Returns:
            A finding instead, where no live motion can begin here.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is under way, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self.name, "to move the robot")
        stops = coordinator.stops
        check_finite(target)
        checked = self._checked(f"MOVEL {moving} 0 0 0 0 0 0 [1] (mm,deg,s) {{B}}")
        if checked.value is None:
            return Result(None, checked.diagnostics)
        step = checked.value.steps[-1]
        assert isinstance(step, LineMove)
        frame = Moving(moving.strip("{} ").upper(), step.goal.flange_from_moving)
        here = await coordinator.commanded()
        made = await coordinator.plan(
            live_motion, coordinator.robot, here, frame, checked.value.cell, settings, name
        )
        if made.value is None:
            return Result(None, made.diagnostics)
        live, generator = made.value
        engine = coordinator.engine
        generator.want(target, engine.session.now())
        running = await engine.begin(
            self._carry_out(name, 0.0, lambda: engine.perform_live(live), stops), name
        )
        return Result(
            Drive(
                coordinator.robot,
                generator,
                running,
                engine.session.now,
                self.stop,
                self._told,
                live.lead * live.job.segment,
                lambda: coordinator.check_owner(self.name, "to move the robot"),
            ),
            made.diagnostics,
        )

    async def _carry_out(
        self, name: str, duration: float, work: Callable[[], Awaitable[Ended]], stops: int
    ) -> Ended:
        """Carry work out, unless somebody has wanted a stop since there were so many `stops`."""
        coordinator = self._coordinator

        async def told() -> Ended:
            if coordinator.stops != stops:
                return Ended(False, "stopped before it began; nothing moved")
            coordinator.announce(Began(coordinator.now, name, duration, self.name))
            ended = await work()
            coordinator.announce(Finished(coordinator.now, name, ended))
            return ended

        return await coordinator.engine.move(name, told)

    def _told(self, text: str) -> None:
        self._coordinator.announce(Message(self._coordinator.now, text))


class _Telling:
    """Tells of a program between its jobs as messages."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell

    def begins(self, job: Job, *, instead: str = "", brief: bool = False) -> None:  # noqa: ARG002 (Watcher's)
        if instead:
            self._tell(f"{instead}, {job.duration:.1f} s")

    def pauses(self, title: str, number: int, of: int) -> None:
        self._tell(f"resume goes on with {title}, {number} of {of}")

    def passes(self, number: int, of: int | None) -> None:
        self._tell(f"pass {number}{f' of {of}' if of else ''}")
