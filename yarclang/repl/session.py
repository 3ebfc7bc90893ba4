"""The session of one user: its declarations, questions and orders, and the robot's messages. This module
needs no terminal.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from yarclang.calibration.touching import Touching
from yarclang.coordinator.attached import Attached, Here
from yarclang.coordinator.describing import joints_of, signal_of
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.events import (
    BaseEvent,
    Finished,
    InputChanged,
    OutputSet,
    OwnerChanged,
    StateChanged,
    Told,
    WaitEnded,
)
from yarclang.coordinator.messages.findings import findings_of
from yarclang.coordinator.messages.replies import Ended, OfferDescribed, Offered
from yarclang.coordinator.names import Names
from yarclang.coordinator.offers import Planner
from yarclang.coordinator.picture import Picture
from yarclang.diagnostics import Diagnostic
from yarclang.motion.plan import MotionPlan
from yarclang.repl.answers import ended_text, offer_text
from yarclang.repl.file import LoadedFile
from yarclang.repl.jogging import Jogging
from yarclang.report.finding import finding_text
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.signals import signal_text
from yarclang.runtime.state import State
from yarclang.semantics.names.scope import Scope

PROMPT = "yarc> "

_KEPT = 200
"""Number of messages that `.log` can show."""


class Session:
    """The state of one user's session in the terminal, on which dot commands work.

    Args:
        attached: this user's connection to the coordinator that owns the robot.
        robot: the robot.
        say: function that shows lines to the user.
        folder: folder in which files are read and written.
        asks: True to ask before motions.
        tm: longest segment time for planning [ms]; None for that of the robot.

    Attributes:
        picture: the robot's state.
        lines: the declarations of the session.
        planner: plans with these declarations, without moving.
        file: the loaded program.
        touching: the calibration that is running.
        jogging: the jog that is running and receives the keys.
        has_keys: True if the terminal can report pressed keys.
        ended_live: result of the last live motion, if it ended since this attribute was last reset.
        messages: messages of the robot, the newest last.
        failed: True if a typed text couldn't be carried out.
        ended: True if the user wants to leave.
    """

    def __init__(
        self,
        attached: Attached,
        robot: Robot,
        say: Callable[[str], None],
        folder: Path,
        *,
        asks: bool = True,
        tm: float | None = None,
    ) -> None:
        self.attached = attached
        self.robot = robot
        self.picture = Picture(attached.welcome.status)
        self.lines = Lines()
        self.planner = Planner(robot, folder, tm)
        self.say = say
        self.folder = folder
        self.asks = asks
        self.file: LoadedFile | None = None
        self.touching: Touching | None = None
        self.jogging: Jogging | None = None
        self.has_keys = False
        self.ended_live: Finished | None = None
        self.messages: deque[str] = deque(maxlen=_KEPT)
        self.failed = False
        self.ended = False
        self._waiting: deque[str] = deque()
        self._arrived = asyncio.Event()
        self._busy = False
        self._question: asyncio.Future[str] | None = None
        self._asked = ""
        self._stopping = ""
        self._planned: Callable[[], MotionPlan | None] | None = None
        self._overtaking: set[asyncio.Future[None]] = set()

    # Questions and waiting texts.

    @property
    def prompt(self) -> str:
        """Return the text at which the user types: the jog, the open question, or the usual prompt."""
        if self.jogging is not None:
            return f"{self.jogging.text} "
        return self._asked if self._question is not None else PROMPT

    @property
    def asked(self) -> bool:
        """Return True if a question is open, so that the next typed text is its answer."""
        return self._question is not None

    @property
    def idle(self) -> bool:
        """Return True if nothing is running or waiting."""
        return not (self._busy or self._waiting or self._overtaking)

    @property
    def owns(self) -> bool:
        """Return True if this user may move the robot."""
        return self.picture.owner == self.attached.welcome.name

    def order(self, order: orders.Order[Any]) -> None:
        """Send an order at once, and show the reason if it is refused."""
        self.attached.send(order, lambda trouble: self.refuse(trouble_text(trouble)))

    def interrupt(self) -> None:
        """Handle Ctrl-C. The first time, stop the robot on its path; the second time, stop each motor at
        once.

        Typed texts that wait and an open question are dropped.
        """
        self.drop()
        if not self.picture.under_way:
            return
        if self._stopping == self.picture.under_way:
            self.order(orders.Abort())
            self.say("aborting: each motor stops at once")
        else:
            self._stopping = self.picture.under_way
            self.order(orders.Stop())
            self.say("stopping on the path; Ctrl-C again aborts")

    def leave(self) -> None:
        """Leave: stop this user's motions on their path, and carry out nothing more."""
        self.drop()
        if self.picture.under_way and self.owns:
            self.order(orders.Stop())
        self.ended = True
        self._arrived.set()

    def answer_nothing(self) -> None:
        """Drop an open question, because no user is there to answer."""
        question, self._question = self._question, None
        if question is not None and not question.done():
            question.set_result("")

    def drop(self) -> None:
        """Drop texts that wait, an open question and a jog."""
        if self.jogging is not None:
            self.jogging.ended = True
        if self._waiting:
            self.say(f"{len(self._waiting)} that waited {'is' if len(self._waiting) == 1 else 'are'} dropped")
            self._waiting.clear()
        self.answer_nothing()

    async def ask(self, question: str) -> str:
        """Ask the user, and return the answer; empty if the question was dropped."""
        self._question = asyncio.get_running_loop().create_future()
        self._asked = f"{question} "
        return await self._question

    async def agrees(self, question: str) -> bool:
        """Return True if the user answers yes."""
        return (await self.ask(f"{question} [y/N]")).strip().lower() in ("y", "yes")

    def refuse(self, text: str) -> None:
        """Report that a text can't be carried out."""
        self.failed = True
        self.say(text)

    def show(self, findings: tuple[Diagnostic, ...]) -> None:
        """Show findings in the same form as in the editor and in yarcc."""
        for one in findings:
            self.failed = self.failed or one.is_error
            self.say(finding_text(one))

    async def stands(self) -> Array:
        """Request the commanded joint positions (n,) [rad or m] from the robot.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        return np.array((await self.attached.ask(orders.AskPlace())).exact)

    async def own(self) -> None:
        """Become the robot's owner.

        Raises:
            Trouble: another client owns it.
        """
        if not self.owns:
            await self.attached.ask(orders.Own(shared=True))
            self.picture.owner = self.attached.welcome.name

    async def renew(self) -> None:
        """Request the session's declarations from the coordinator."""
        told = await self.attached.ask(orders.AskDeclarations())
        if tuple(self.lines.declarations) != told.declarations:
            self.lines.adopt(told.declarations)
        self.lines.count = told.count

    async def offered(self, text: str) -> OfferDescribed | None:
        """Plan a text, and show its findings and its motions."""
        return self._told(await self.attached.ask(orders.Offer(text=text)))

    async def carry_out(self, text: str) -> bool:
        """Plan a text, show it, ask, and carry it out. Return True if it was carried out."""
        return await self.go(await self.offered(text))

    async def carry_out_back(self) -> bool:
        """Plan the last motion backwards, show it, ask, and carry it out, like `carry_out`."""
        return await self.go(self._told(await self.attached.ask(orders.OfferBack())))

    async def go(self, offer: OfferDescribed | None) -> bool:
        """Start offered motions if the user agrees. Return True if they were carried out."""
        if offer is None:
            return False
        if offer.moves and self.asks and not await self.agrees("go?"):
            self.say("nothing moved")
            return False
        if offer.moves:
            await self.own()
        ended = await self.attached.ask(orders.Go(offer=offer.number))
        await self.renew()
        return self.over(ended, moved=offer.moves)

    def over(self, ended: Ended | Finished, *, moved: bool = True) -> bool:
        """Show how an order has ended. Return True if it ended well."""
        self._stopping = ""
        if not ended.well:
            self.failed = True
        if moved or not ended.well:
            self.say(ended_text(ended, self.robot))
        else:
            self.say("it is valid from now on")
        return ended.well

    def _told(self, made: Offered) -> OfferDescribed | None:
        self.show(findings_of(made.findings))
        offer = made.offer
        if offer is not None and offer.moves:
            self._planned = self._plan_of(offer)
            self.say(offer_text(offer))
        return offer

    def _plan_of(self, offer: OfferDescribed) -> Callable[[], MotionPlan | None]:
        """Return a function that returns the plan of an offer (motions that are planned and wait for a
        start).

        If the coordinator is in this process, the plan is the coordinator's. Otherwise the motions are
        planned again.
        """
        if isinstance(self.attached, Here):
            made = self.attached.desk.offer_of(offer.number)
            return lambda: None if made is None else made.plan
        lines, start = self.lines.copy(), joints_of(self.robot, offer.start)

        def planned() -> MotionPlan | None:
            again = self.planner.offer(offer.text, lines, start, offer.number).value
            return None if again is None else again.plan

        return planned

    def planned_by(self, planned: Callable[[], MotionPlan | None]) -> None:
        """Store the function that returns the plan for `.plot`."""
        self._planned = planned

    @property
    def has_planned(self) -> bool:
        """Return True if anything was planned."""
        return self._planned is not None

    @property
    def plan(self) -> MotionPlan | None:
        """Return the last plan; None if there is none, or if only another process has it."""
        return None if self._planned is None else self._planned()

    @property
    def names(self) -> Names:
        """Return the meanings of the names that the session declares."""
        return Names(self.lines, self.planner)

    def scope(self) -> Scope:
        """Return the meanings of all names that a typed line may use."""
        return self.names.scope()

    # Events.

    def hear(self, event: BaseEvent) -> None:
        """Store an event, and show urgent ones to the user."""
        self.picture.hear(event)
        if isinstance(event, Told):
            self._keep(event.text, tell=True)
        elif isinstance(event, StateChanged):
            self._keep(
                f"{event.state.value}: {event.why}" if event.why else event.state.value,
                tell=event.state in (State.FAULT, State.DISCONNECTED),
            )
        elif isinstance(event, OwnerChanged):
            self._keep(
                f"{event.owner} owns the robot" if event.owner else "the robot has no owner",
                tell=event.owner != self.attached.welcome.name,
            )
        elif isinstance(event, OutputSet | WaitEnded | InputChanged):
            self._keep(signal_text(signal_of(event)), tell=True)
        elif isinstance(event, Finished):
            self.ended_live = event

    def _keep(self, text: str, *, tell: bool) -> None:
        self.messages.append(text)
        if tell:
            self.say(text)


def trouble_text(trouble: Trouble) -> str:
    """Return the text of an error with its remedy."""
    return f"{trouble.what}\n  help: {trouble.remedy}" if trouble.remedy else trouble.what
