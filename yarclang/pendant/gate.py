"""Gate for the orders that users give to their robot. It checks the rights of the user and the files in the
order, and writes the order to the audit trail.
"""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from collections.abc import Callable
from typing import Any, TypeVar

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.messages.lines import name_of
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Ended, Loaded, Offered, Reply, Serviced, SettingsSent
from yarclang.pendant.accounts.accounts import Accounts, NotAllowed
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import AUDITED, WITH_PIN, Role, needed_for
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.messages.display import Notice
from yarclang.pendant.messages.robot import Asked, ProgramFile, Programs
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.seats import Seats
from yarclang.pendant.watched import Watched
from yarclang.runtime.actions import Trouble

R = TypeVar("R", bound=Reply)

AT_ONCE = (orders.Stop, orders.Hold, orders.Abort)
"""Orders that every user may give. They never wait for a disk or a seat (a session's client at the
coordinator).
"""

_ANYTIME = (orders.Own, orders.Give, orders.Release, orders.Override)
"""Audited orders that are carried out even if a stop, hold or abort was ordered while they were written to
the audit trail, because they neither move the robot nor set an output.
"""

_SHARED = (
    orders.AskStatus,
    orders.AskPlace,
    orders.AskFrames,
    orders.AskHealth,
    orders.AskSurroundings,
    orders.AskDeclarations,
    orders.AskParts,
    orders.AskModel,
    orders.AskScene,
    orders.Read,
    orders.Look,
    orders.Connect,
    orders.AskHoming,
    orders.AskSettings,
)
"""Orders for which a session needs no seat (a client of its own at the coordinator). The pendant's shared
client sends them.
"""

_MOST_FILES = 10_000
_MOST_CALLED = 1000
_LONGEST_DETAIL = 500
_ABSENT = 10.0
"""Time after which an absent owner loses the robot [s]: if the owner has had no open page and has given no
order for this time, and nothing is running, another session may take control.
"""


class Gate:
    """Gate between the users of a pendant and the coordinator, which drives the robot: every order of a user
    passes it.

    Args:
        accounts: accounts of the pendant.
        seats: the sessions' clients of the coordinator.
        watched: shared client of the coordinator, which knows the robot's state.
        files: files of the project; orders can't name other files.
        now: returns the time of a monotonic clock [s].
        loaded: called after a session has loaded a program. The arguments are the session, the program's
            number, and the order with resolved paths.

    Attributes:
        rests: number of stops, holds and aborts that users have ordered so far.
    """

    def __init__(
        self,
        accounts: Accounts,
        seats: Seats,
        watched: Watched,
        files: ProjectFolder,
        now: Callable[[], float],
        loaded: Callable[[Session, int, orders.Load], object] = lambda *_: None,
    ) -> None:
        self.rests = 0
        self._loaded = loaded
        self.folder = files.root
        self._files = files
        self._accounts = accounts
        self._seats = seats
        self._watched = watched
        self._now = now
        self._gone: dict[str, float] = {}
        self._called: OrderedDict[tuple[str, str, int], str] = OrderedDict()

    async def order(self, session: Session, order: Order[R], address: str) -> R:
        """Check an order, write it to the audit trail, and let the coordinator carry it out. Return the
        coordinator's reply.

        Args:
            session: session that gives the order.
            order: order to carry out.
            address: address from which the request came.

        Raises:
            NotAllowed: the order needs another role.
            Trouble: the order can't be carried out.
        """
        if type(order) in AT_ONCE:
            return await self._at_once(session, order, address)
        self.check(session, order, address)
        inside = self._within(order)
        if not isinstance(order, AUDITED):
            answer = await (await self._client(session, order)).ask(inside)
            self._remember(session, order, answer)
            if isinstance(inside, orders.Load) and isinstance(answer, Loaded) and answer.program is not None:
                self._loaded(session, answer.program.number, inside)
            return answer
        if isinstance(order, orders.Run):
            self._watched.showing.runs(self._called.get((session.id, "run", order.program), ""))
        deed = Deed(session.user, address, name_of(order), self.meant(session, order))
        rests = self.rests
        if isinstance(order, orders.Override):
            self._accounts.note(deed)
        else:
            await self._accounts.did(deed)
        try:
            self._check_open(session)  # the user may have logged out, or was removed, during the wait
            client = await self._client(session, order)
            if not isinstance(order, _ANYTIME):
                self.check_not_stopped(rests)
            reply = await client.ask(inside)
        except Trouble as trouble:
            self._accounts.note(
                Deed(session.user, address, name_of(order), deed.detail, f"refused: {trouble.what}")
            )
            raise
        if outcome := _outcome(reply):
            self._accounts.note(Deed(session.user, address, name_of(order), deed.detail, outcome))
        return reply

    def check(self, session: Session, order: Order[Any], address: str) -> None:
        """Check that a session may give an order, and that the audit trail can be written if the order
        requires it.

        Raises:
            NotAllowed: the session lacks the role or the PIN.
            Trouble: the audit trail can't be written.
        """
        self._check_open(session)
        role = needed_for(order)
        try:
            if role is None:
                raise NotAllowed(
                    f"{name_of(order)} can't be ordered through the pendant", "see the API's page", ""
                )
            self._accounts.check(session, role, pin=isinstance(order, WITH_PIN))
        except NotAllowed as refused:
            self._accounts.note(
                Deed(session.user, address, name_of(order), _detail(order), f"refused: {refused.what}")
            )
            raise
        if self._accounts.trouble is not None and isinstance(order, (*AUDITED, *wants.KINDS)):
            raise self._accounts.trouble

    def _check_open(self, session: Session) -> None:
        if self._accounts.is_over(session):
            raise NotAllowed("this session has ended", "log in again", "login")

    def check_not_stopped(self, rests: int) -> None:
        """Check that no user has ordered a stop, hold or abort since an order was given. An order waits for
        the audit trail, and a slow disk can delay it for seconds. The robot must not move after a stop that
        was ordered meanwhile.

        Args:
            rests: value of `rests` when the order was given.

        Raises:
            Trouble: a stop, hold or abort was ordered.
        """
        if self.rests != rests:
            raise Trouble("stopped before it began; nothing moved", "order it again", "")

    def _remember(self, session: Session, order: Order[Any], answer: Reply) -> None:
        """Remember the meaning of a number in the coordinator's reply: the motion or the program file. Later
        orders contain only the number, and the audit trail must show its meaning.
        """
        if isinstance(answer, Offered) and answer.offer is not None:
            meant = answer.offer.text or answer.offer.title
            self._called[session.id, "go", answer.offer.number] = meant
        elif isinstance(order, orders.Load) and isinstance(answer, Loaded) and answer.program is not None:
            self._called[session.id, "run", answer.program.number] = order.file
        while len(self._called) > _MOST_CALLED:
            self._called.popitem(last=False)

    def meant(self, session: Session, order: Order[Any]) -> str:
        """Return the text that describes an order in the audit trail."""
        number = getattr(order, "offer", None) or getattr(order, "program", None)
        meant = self._called.get((session.id, name_of(order), number or 0), "")
        return f"{meant} {_detail(order)}".strip()[:_LONGEST_DETAIL]

    async def _at_once(self, session: Session, order: Order[R], address: str) -> R:
        if not isinstance(order, orders.Stop):
            self._accounts.check(session, Role.OPERATOR)
        self.rests += 1
        made = await self._watched.attached.ask(order)
        self._accounts.note(Deed(session.user, address, name_of(order)))
        return made

    async def _client(self, session: Session, order: Order[Any]) -> Attached:
        return self._watched.attached if isinstance(order, _SHARED) else await self._seats.of(session)

    # control of the robot

    async def ask_for_control(self, session: Session, address: str) -> Asked:
        """Take control of the robot if it has no owner, or if its owner's pages have been closed for some
        time. Otherwise ask the owner for control.

        Raises:
            Trouble: the robot's owner isn't a session of this pendant, so it can't be asked.
        """
        self.check(session, orders.Own(), address)
        seat = await self._seats.of(session)
        owner = self._watched.showing.owner
        other = self._seats.session_called(owner)
        if owner and owner != seat.welcome.name and other and self._is_absent(other):
            self._seats.leave(other)
            await asyncio.sleep(0)
            owner = None
        try:
            await self.order(session, orders.Own(), address)
        except Trouble:
            if not other:
                raise
            text = f"{session.user} asks for control of the robot"
            self._watched.notice(Notice(text=text, ask=session.id), other)
            return Asked(given=False, owner=owner or "", what=f"{owner} was asked for control, and decides")
        return Asked(given=True, owner=seat.welcome.name, what="you control the robot")

    async def give_control(self, session: Session, to: str, address: str) -> Asked:
        """Give control of the robot to another session.

        Args:
            session: the session that owns the robot now.
            to: id of the other session; empty to release the robot.
            address: address from which the request came.

        Raises:
            Trouble: the session isn't the owner, or the other session has ended.
        """
        if not to:
            await self.order(session, orders.Release(), address)
            return Asked(given=True, owner="", what="nobody controls the robot")
        other = self._accounts.sessions.called(to)
        if other is None:
            raise Trouble("the person who asked has gone", "ask them again", "")
        self._accounts.check(other, Role.OPERATOR)
        seat = await self._seats.of(other)
        await self.order(session, orders.Give(to=seat.welcome.name), address)
        self._watched.notice(Notice(text=f"{session.user} gave you control of the robot"), to)
        return Asked(given=True, owner=seat.welcome.name, what=f"{seat.welcome.name} controls the robot")

    def owns(self, session: Session) -> bool:
        """Return True if a session controls the robot."""
        name = self._seats.name(session)
        return bool(name) and name == self._watched.showing.owner

    def page_gone(self, session: str) -> None:
        """Record that the last page of a session has closed."""
        self._gone[session] = self._now()

    def page_there(self, session: str) -> None:
        """Record that a session has an open page."""
        self._gone.pop(session, None)

    def _is_absent(self, session: str) -> bool:
        if self._watched.pages_of(session) or self._watched.showing.under_way:
            return False
        known = self._accounts.sessions.called(session)
        last = -_ABSENT if known is None else known.seen
        return self._now() - max(last, self._gone.get(session, last)) >= _ABSENT

    # files

    def programs(self) -> Programs:
        """Return the programs of the project, except those in hidden folders. This is slow for a large
        folder: call it in a thread.
        """
        found, _ = self._files.programs(_MOST_FILES)
        shown = [ProgramFile(file=one.file, size=one.size, changed=one.changed) for one in found]
        return Programs(folder=str(self.folder), programs=tuple(shown))

    def _within(self, order: Order[R]) -> Order[R]:
        """Return an order with the paths of its files resolved in the project."""
        if isinstance(order, orders.Load):
            named = {key: getattr(order, key) for key in ("file", "cell", "source")}
        elif isinstance(order, orders.Save):
            named = {"folder": order.folder}
        else:
            return order
        return order.model_copy(  # type: ignore[return-value]  # a copy is of the same kind
            update={key: str(self._files.path(value)) for key, value in named.items() if value is not None}
        )


def _outcome(reply: Reply) -> str:
    """Return the outcome of an order in words, for the audit trail; empty if the reply to the order states
    no outcome.
    """
    match reply:
        case Ended(well=well, what=what):
            return "ended" if well else f"ended: {what}"
        case Serviced(what=what):
            return what or "done"
        case SettingsSent(sent=sent, of=of, what=what):
            return f"{sent} of {of} lines: {what}" if what else f"all {of} lines"
        case _:
            return ""


def _detail(order: Order[Any]) -> str:
    """Return the parameters of an order as JSON, for the audit trail, without the texts of programs."""
    content = order.model_dump(mode="json", exclude={"order", "text"}, exclude_defaults=True)
    return json.dumps(content, sort_keys=True)[:_LONGEST_DETAIL] if content else ""
