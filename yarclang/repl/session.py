"""A session of one person: what it declares, asks and orders, and what is told of the robot. Knows no terminal."""

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
"""Messages that `.log` can show."""


class Session:
    """A session of one person, as dot commands see it.

    Args:
        attached: this person, as a client of the coordinator that owns the robot.
        robot: likewise.
        say: shows lines to the person.
        folder: where files are looked for and written.
        asks: whether to ask before something moves.
        tm: longest segment time of what is planned [ms]; None: the robot's.

    Attributes:
        picture: what the robot does.
        lines: the declarations of the session.
        planner: what plans them, for whoever only looks.
        file: the program that was loaded.
        touching: the calibration that goes on.
        jogging: the jog that goes on: keys are for it.
        has_keys: whether there are keys to hold.
        ended_live: how the last live motion has ended, if one has since this was looked at.
        messages: what was told of the robot, newest last.
        failed: whether something that was typed couldn't be carried out.
        ended: whether the person wants to go.
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

    # what is asked, and what waits

    @property
    def prompt(self) -> str:
        """What stands in front of what is typed next: a question, if one is open."""
        if self.jogging is not None:
            return f"{self.jogging.text} "
        return self._asked if self._question is not None else PROMPT

    @property
    def asked(self) -> bool:
        """Whether a question is open: what is typed next is its answer."""
        return self._question is not None

    @property
    def idle(self) -> bool:
        """Whether nothing is carried out, and nothing waits."""
        return not (self._busy or self._waiting or self._overtaking)

    @property
    def owns(self) -> bool:
        """Whether this person may move the robot."""
        return self.picture.owner == self.attached.welcome.name

    def order(self, order: orders.Order[Any]) -> None:
        """Order something at once; what is denied is said."""
        self.attached.send(order, lambda trouble: self.refuse(trouble_text(trouble)))

    def interrupt(self) -> None:
        """Ctrl-C: the robot comes to rest on its path, at once the second time; what waits, and an open question, are dropped."""
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
        """The person goes: what this person moves comes to rest on its path, and nothing more is carried out."""
        self.drop()
        if self.picture.under_way and self.owns:
            self.order(orders.Stop())
        self.ended = True
        self._arrived.set()

    def answer_nothing(self) -> None:
        """Nobody is there to answer an open question."""
        question, self._question = self._question, None
        if question is not None and not question.done():
            question.set_result("")

    def drop(self) -> None:
        """Forget what waits, an open question, and a jog."""
        if self.jogging is not None:
            self.jogging.ended = True
        if self._waiting:
            self.say(f"{len(self._waiting)} that waited {'is' if len(self._waiting) == 1 else 'are'} dropped")
            self._waiting.clear()
        self.answer_nothing()

    async def ask(self, question: str) -> str:
        """What the person answers; empty where something else came between."""
        self._question = asyncio.get_running_loop().create_future()
        self._asked = f"{question} "
        return await self._question

    async def agrees(self, question: str) -> bool:
        """Whether the person says yes."""
        return (await self.ask(f"{question} [y/N]")).strip().lower() in ("y", "yes")

    def refuse(self, text: str) -> None:
        """Say that something can't be carried out."""
        self.failed = True
        self.say(text)

    def show(self, findings: tuple[Diagnostic, ...]) -> None:
        """Say what was found, as the editor and yarcc do."""
        for one in findings:
            self.failed = self.failed or one.is_error
            self.say(finding_text(one))

    async def stands(self) -> Array:
        """Return (n,) where the robot is commanded to stand [rad or m], asked now.

        Raises:
            Trouble: the robot is under way, or there is no connection.
        """
        return np.array((await self.attached.ask(orders.AskPlace())).exact)

    async def own(self) -> None:
        """Own the robot, if this person doesn't yet.

        Raises:
            Trouble: somebody else does.
        """
        if not self.owns:
            await self.attached.ask(orders.Own(shared=True))
            self.picture.owner = self.attached.welcome.name

    async def renew(self) -> None:
        """Ask what the session declares."""
        told = await self.attached.ask(orders.AskDeclarations())
        if tuple(self.lines.declarations) != told.declarations:
            self.lines.adopt(told.declarations)
        self.lines.count = told.count

    async def offered(self, text: str) -> OfferDescribed | None:
        """Plan a text, say what was found and what it would do."""
        return self._told(await self.attached.ask(orders.Offer(text=text)))

    async def carry_out(self, text: str) -> bool:
        """Plan a text, show it, ask, and do it; whether it was done."""
        return await self.go(await self.offered(text))

    async def carry_out_back(self) -> bool:
        """The last motion backwards, likewise."""
        return await self.go(self._told(await self.attached.ask(orders.OfferBack())))

    async def go(self, offer: OfferDescribed | None) -> bool:
        """Do what was offered, if the person wants it; whether it was done."""
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
        """Say how something has ended; whether it was well."""
        self._stopping = ""
        if not ended.well:
            self.failed = True
        if moved or not ended.well:
            self.say(ended_text(ended, self.robot))
        else:
            self.say("it holds from now on")
        return ended.well

    def _told(self, made: Offered) -> OfferDescribed | None:
        self.show(findings_of(made.findings))
        offer = made.offer
        if offer is not None and offer.moves:
            self._planned = self._plan_of(offer)
            self.say(offer_text(offer))
        return offer

    def _plan_of(self, offer: OfferDescribed) -> Callable[[], MotionPlan | None]:
        """What gives the plan of an offer: it is at hand in this process, else it is made again."""
        if isinstance(self.attached, Here):
            made = self.attached.desk.offer_of(offer.number)
            return lambda: None if made is None else made.plan
        lines, start = self.lines.copy(), joints_of(self.robot, offer.start)

        def planned() -> MotionPlan | None:
            again = self.planner.offer(offer.text, lines, start, offer.number).value
            return None if again is None else again.plan

        return planned

    def planned_by(self, planned: Callable[[], MotionPlan | None]) -> None:
        """Keep what gives the plan that `.plot` draws."""
        self._planned = planned

    @property
    def has_planned(self) -> bool:
        """Whether something was planned."""
        return self._planned is not None

    @property
    def plan(self) -> MotionPlan | None:
        """What was planned last; None where nothing was, or where only another process knows it."""
        return None if self._planned is None else self._planned()

    @property
    def names(self) -> Names:
        """What the names mean that the session knows."""
        return Names(self.lines, self.planner)

    def scope(self) -> Scope:
        """The same, all of them."""
        return self.names.scope()

    # what is heard

    def hear(self, event: BaseEvent) -> None:
        """Keep what is worth knowing, and say what the person must know now."""
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
                f"{event.owner} owns the robot" if event.owner else "nobody owns the robot",
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
    """What can't be done, and what to do instead."""
    return f"{trouble.what}\n  help: {trouble.remedy}" if trouble.remedy else trouble.what
