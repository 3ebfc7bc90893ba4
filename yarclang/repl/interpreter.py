"""What is typed, one text after the other: YARC goes to the coordinator as an offer, dot commands to `dots/`. Knows no terminal."""

from __future__ import annotations

import asyncio
import traceback
from collections import deque
from collections.abc import Callable
from pathlib import Path

from yarclang.coordinator.client import Client
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.events import Event, Message, OwnerChanged, StateChanged
from yarclang.coordinator.offers import Offer
from yarclang.diagnostics import Diagnostic, Result, suggest
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.stages import context_of
from yarclang.repl.answers import ended_text, offer_text
from yarclang.repl.dot import DotCommand, Misused, dot_commands
from yarclang.repl.file import LoadedFile
from yarclang.repl.jogging import Jogging
from yarclang.repl.touching import Touching
from yarclang.report.finding import finding_text
from yarclang.runtime.actions import Trouble
from yarclang.runtime.outcome import Ended
from yarclang.runtime.state import State
from yarclang.semantics.scope import Scope
from yarclang.semantics.unroll import declared_names
from yarclang.syntax.parse import parse

PROMPT = "yarc> "

_KEPT = 200
"""Messages that `.log` can show."""


class Interpreter:
    """A session of one person.

    Texts are carried out one after the other, in the order in which they were typed. Orders (`.stop`, `.hold`, ...) overtake everything.

    Args:
        coordinator: that owns the robot.
        client: this person's.
        say: shows lines to the person.
        folder: where files are looked for and written.
        asks: whether to ask before something moves.

    Attributes:
        file: the program that was loaded.
        touching: the calibration that goes on.
        jogging: the jog that goes on: keys are for it.
        has_keys: whether there are keys to hold.
        plan: what was planned last, for `.plot`.
        messages: what was told of the robot, newest last.
        failed: whether something that was typed couldn't be carried out.
        ended: whether the person wants to go.
    """

    def __init__(
        self,
        coordinator: Coordinator,
        client: Client,
        say: Callable[[str], None],
        folder: Path,
        *,
        asks: bool = True,
    ) -> None:
        self.coordinator = coordinator
        self.client = client
        self.say = say
        self.folder = folder
        self.asks = asks
        self.file: LoadedFile | None = None
        self.touching: Touching | None = None
        self.jogging: Jogging | None = None
        self.has_keys = False
        self.plan: MotionPlan | None = None
        self.messages: deque[str] = deque(maxlen=_KEPT)
        self.failed = False
        self.ended = False
        self._waiting: deque[str] = deque()
        self._arrived = asyncio.Event()
        self._busy = False
        self._question: asyncio.Future[str] | None = None
        self._asked = ""
        self._stopping = ""

    # what is typed

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
        return not self._busy and not self._waiting

    def typed(self, text: str) -> None:
        """One text: a line, or a block with its END. Orders are carried out at once, others when all before them are done."""
        name = text.split(maxsplit=1)[0] if text.split() else ""
        command = dot_commands().get(name.lower())
        if command is not None and command.overtakes:
            self._overtake(command, text)
        elif self._question is not None:
            question, self._question = self._question, None
            if not question.done():
                question.set_result(text)
        elif not text.strip():
            self._go_on()
        else:
            self._waiting.append(text)
            self._arrived.set()

    def _go_on(self) -> None:
        """Enter alone: on behind a hold, or to the next step; nothing where nothing waits for it."""
        if self.coordinator.under_way and self.client.owns:
            self.client.resume()

    async def serve(self) -> None:
        """Carry out what was typed, until the person goes."""
        while not self.ended:
            while self._waiting and not self.ended:
                self._busy = True
                try:
                    await self.take(self._waiting.popleft())
                finally:
                    self._busy = False
            self._arrived.clear()
            if not self.ended:
                await self._arrived.wait()

    async def take(self, text: str) -> None:
        """Carry one text out. Whatever is wrong with it is said, and raises nothing."""
        try:
            if text.lstrip().startswith("."):
                await self._dot(text.strip())
            else:
                await self.carry_out(text)
        except Trouble as trouble:
            self.refuse(trouble_text(trouble))
        except Exception as error:
            # a bug of ours must not take the prompt, and with it the stop key, from a person at a robot
            self.refuse(bug_text(error))

    def interrupt(self) -> None:
        """Ctrl-C: the robot comes to rest on its path, at once the second time; what waits, and an open question, are dropped."""
        self.drop()
        if not self.coordinator.under_way:
            return
        if self._stopping == self.coordinator.under_way:
            self.client.abort()
            self.say("aborting: each motor stops at once")
        else:
            self._stopping = self.coordinator.under_way
            self.client.stop()
            self.say("stopping on the path; Ctrl-C again aborts")

    def leave(self) -> None:
        """The person goes: what this person moves comes to rest on its path, and nothing more is carried out."""
        self.drop()
        if self.coordinator.under_way and self.client.owns:
            self.client.stop()
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

    async def _dot(self, text: str) -> None:
        name, _, rest = text.partition(" ")
        commands = dot_commands()
        command = commands.get(name.lower())
        if command is None:
            near = suggest(name.lower(), commands)
            self.refuse(f"there is no command {name}; {near.lower() or '.help lists them'}")
            return
        try:
            done = command.run(self, rest.strip())
            if done is not None:
                await done
        except Misused as misused:
            self.refuse(f"{misused}\n  it is written: {command.line}")

    def _overtake(self, command: DotCommand, text: str) -> None:
        """Carry an order out at once: it never waits."""
        try:
            command.run(self, text.partition(" ")[2].strip())
        except Trouble as trouble:
            self.refuse(trouble_text(trouble))
        except Misused as misused:
            self.refuse(f"{misused}\n  it is written: {command.line}")

    # what the dot commands need

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

    async def offered(self, text: str) -> Offer | None:
        """Plan a text, say what was found and what it would do."""
        return self._told(await self.client.offer(text))

    async def carry_out(self, text: str) -> bool:
        """Plan a text, show it, ask, and do it; whether it was done."""
        return await self.go(self._told(await self.client.offer(text)))

    async def carry_out_back(self) -> bool:
        """The last motion backwards, likewise."""
        return await self.go(self._told(await self.client.offer_back()))

    async def go(self, offer: Offer | None) -> bool:
        """Do what was offered, if the person wants it; whether it was done."""
        if offer is None:
            return False
        if offer.job is not None and self.asks and not await self.agrees("go?"):
            self.say("nothing moved")
            return False
        if offer.job is not None and not self.client.owns:
            self.client.own()
        return self.over(await self.client.go(offer), moved=offer.job is not None)

    def over(self, ended: Ended, *, moved: bool = True) -> bool:
        """Say how something has ended; whether it was well."""
        self._stopping = ""
        if not ended.well:
            self.failed = True
        if moved or not ended.well:
            self.say(ended_text(ended, self.coordinator.robot))
        else:
            self.say("it holds from now on")
        return ended.well

    def _told(self, made: Result[Offer]) -> Offer | None:
        self.show(made.diagnostics)
        offer = made.value
        if offer is not None and offer.compiled is not None:
            self.plan = offer.plan
            self.say(offer_text(offer))
        return offer

    def scope(self) -> Scope:
        """What the names mean that the session knows."""
        typed = self.coordinator.lines.behind("")
        module = parse(typed.source).value
        assert module is not None  # parsing always gives a tree
        return declared_names(
            module, context_of(self.coordinator.planner.request(self.coordinator.robot.home))
        )

    # what is heard

    def hear(self, event: Event) -> None:
        """Keep what is worth knowing, and say what the person must know now."""
        if isinstance(event, Message):
            self._keep(event.text, tell=True)
        elif isinstance(event, StateChanged):
            self._keep(
                f"{event.state.value}: {event.why}" if event.why else event.state.value,
                tell=event.state in (State.FAULT, State.DISCONNECTED),
            )
        elif isinstance(event, OwnerChanged):
            self._keep(
                f"{event.owner} owns the robot" if event.owner else "nobody owns the robot",
                tell=event.owner != self.client.name,
            )

    def _keep(self, text: str, *, tell: bool) -> None:
        self.messages.append(text)
        if tell:
            self.say(text)


def trouble_text(trouble: Trouble) -> str:
    """What can't be done, and what to do instead."""
    return f"{trouble.what}\n  help: {trouble.remedy}" if trouble.remedy else trouble.what


def bug_text(error: Exception) -> str:
    """What to say of a bug of ours, with the place to report."""
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"a bug of yarclang has ended this: {error!r}\n  help: report it, with this place: {place.filename}:{place.lineno} in {place.name}"
