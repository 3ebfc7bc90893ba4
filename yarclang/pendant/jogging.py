"""Hold-to-run: while a button is pressed in a browser, the pendant sends targets to a live motion of the
robot, that is, a motion whose target can change while it runs.

A press moves the robot only while fresh messages arrive. The page sends 20 messages a second, each with the
pressed button and the last heartbeat that the page has received. If this heartbeat is too old, the message
ends the press. If no message arrives for 0.2 s, the coordinator's own watchdog ends the motion.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders, replies, wants
from yarclang.coordinator.messages.message import Message
from yarclang.coordinator.messages.orders import Order
from yarclang.pendant.accounts.accounts import Accounts
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.gate import Gate
from yarclang.pendant.going import LET_GO, Going, Wanted, deed_of
from yarclang.pendant.messages.display import Beat
from yarclang.pendant.messages.jog import Jogging, LetGo, Press
from yarclang.pendant.pressed import Pressed
from yarclang.pendant.seats import Seats
from yarclang.pendant.showing import JOG
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.units import MM

BEAT = 0.05
"""Time between two heartbeats [s]."""

FRESH = 5
"""Greatest allowed age of the heartbeat in a page's message, in heartbeats. A message with an older one ends
the press.
"""

_FRESH_FOR = (FRESH + 1) * BEAT
"""Time for which a heartbeat is fresh [s]. While this process doesn't run (because it is suspended, for
example), it sends no heartbeats, so their number alone doesn't show how old a message is.
"""

SILENCE = 0.2
"""Time without a message from the page after which a press ends [s]. The coordinator's watchdog ends the
motion after the same time.
"""

TURN = 30.0
"""Rate of a rotating jog at 100 % [deg/s]."""

_REST = 1.5
"""Longest wait for the previous jog to come to rest [s]."""

_LOOKED_EACH = 0.01

_REACHED = 2e-3
"""A step is complete if every joint is at most this far from its target position [deg or mm]."""

Say = Callable[[Message], Awaitable[None]]


class JogLine:
    """Connection through which one page jogs the robot.

    Args:
        session: session of the page.
        address: address from which the page is connected.
        robot: robot that is jogged.
        accounts: accounts for the audit trail.
        gate: checks the session's right to jog.
        seats: the sessions' clients of the coordinator.
        under_way: returns the name of the program or motion that the robot is executing; empty if none.
        say: function that sends a message to the page.
    """

    def __init__(
        self,
        session: Session,
        address: str,
        robot: Robot,
        accounts: Accounts,
        gate: Gate,
        seats: Seats,
        under_way: Callable[[], str],
        say: Say,
    ) -> None:
        self._session = session
        self._address = address
        self._robot = robot
        self._pressed = Pressed(robot)
        self._accounts = accounts
        self._gate = gate
        self._seats = seats
        self._under_way = under_way
        self._say = say
        self._beat = 0
        self._beaten: deque[float] = deque(maxlen=FRESH + 1)
        self._ended = 0
        self._active = 0
        self._rests = 0
        self._begun = False
        self._goal: wants.Want | None = None
        self._seat: Attached | None = None
        self._going: Going | None = None
        self._newest: Press | None = None
        self._arrived = asyncio.Event()
        self._now = asyncio.get_running_loop().time
        self._heard = 0.0

    async def run(self) -> None:
        """Carry out presses until cancelled; then bring the robot to rest."""
        beating = asyncio.create_task(self._beats())
        try:
            while True:
                await self._arrived.wait()
                self._arrived.clear()
                press, self._newest = self._newest, None
                if press is not None and press.press > self._ended:
                    await self._carry_out(press)
        finally:
            beating.cancel()
            self.let_go(self._active)
            self._end_going()

    def take(self, message: Press | LetGo) -> None:
        """Accept a message of the page. Returns at once."""
        if isinstance(message, LetGo):
            self.let_go(message.release)
            if message.end:
                self._end_going()
        elif message.press <= self._ended:
            pass  # the message was sent before the press ended
        elif not self._is_fresh(message.beat):
            self._over(
                message.press,
                "the pressed button's message came too late",
                "the network is slow: press again",
            )
        elif self._active and message.press != self._active:
            self._over(
                message.press, "another button is pressed already", "release all buttons, then press again"
            )
        else:
            self._heard = self._now()
            self._newest = message
            self._arrived.set()

    def _is_fresh(self, beat: int) -> bool:
        """Return True if a heartbeat was sent a short time ago."""
        age = self._beat - beat
        return 0 <= age < len(self._beaten) and self._now() - self._beaten[-1 - age] <= _FRESH_FOR

    def let_go(self, press: int) -> None:
        """End a press: the robot comes to rest on its path."""
        if press > self._ended:
            self._over(press, "")

    async def _beats(self) -> None:
        while True:
            self._beat += 1
            self._beaten.append(self._now())
            if self._active and self._now() - self._heard > SILENCE:
                what = f"the page sent nothing for {SILENCE:g} s"
                self._over(self._active, what, "press again")
            await self._say(Beat(beat=self._beat))
            await asyncio.sleep(BEAT)

    async def _carry_out(self, press: Press) -> None:
        try:
            if press.go is not None:
                await self._go(press, orders.Go(offer=press.go, held=True))
                return
            if press.home is not None:
                await self._go(press, orders.Home(motors=press.home))
                return
            if press.press == self._active:
                if self._seat is None:
                    raise Trouble(
                        "the pressed button carries out an offer or a home search",
                        "release it, then press another",
                        "",
                    )
                reply = await self._seat.ask(self._goal or await self._pressed.of(press, self._seat))
            else:
                reply = await self._begin(press)
        except Trouble as trouble:
            self._over(press.press, trouble.what, trouble.remedy, trouble.code)
            return
        if press.press <= self._ended:
            self._rest()  # the button was released during the request
            return
        if reply.behind is not None and all(abs(one) < _REACHED for one in reply.behind.values()):
            self._active = 0
            self._ended = press.press
            assert self._seat is not None
            self._seat.send(wants.Finish())  # the lines in the controller's buffer already lead to the target
            self._let_others()
            await self._say(Jogging(press=press.press, state="reached", why=""))
            return
        await self._say(Jogging(press=press.press, state="moves", why=reply.why, lag_s=reply.lag_s))

    def _admit(self, press: Press, order: Order[Any]) -> None:
        """Check that a new press of a button may move the robot.

        Args:
            press: the press.
            order: order for which the user's role must be sufficient.

        Raises:
            Trouble: the user's role isn't sufficient, the session doesn't own the robot, or another page of
                the session jogs.
        """
        self._active, self._begun, self._goal, self._seat = press.press, False, None, None
        self._rests = self._gate.rests
        self._gate.check(self._session, order, self._address)
        if not self._gate.owns(self._session):
            raise Trouble("you don't control the robot", "take control first", "")
        if self._seats.jogging.setdefault(self._session.id, self) is not self:
            raise Trouble("another of your pages is jogging already", "let go there", "")
        self._accounts.used(self._session)

    def _check_not_stopped(self) -> None:
        """Raise `Trouble` if a user has ordered a stop, hold or abort since the button was pressed."""
        self._gate.check_not_stopped(self._rests)

    async def _go(self, press: Press, order: Wanted) -> None:
        """Carry out an offer or a home search while its button is pressed."""
        going = self._going
        if press.press == self._active:
            if going is not None:
                going.keep()
                await self._say(Jogging(press=press.press, state="moves", why=""))
            return
        self._admit(press, order)
        goes_on = isinstance(order, orders.Go)  # a home search ends when its button is released
        if going is not None and goes_on and going.order == order and not going.ends:
            await going.resume(lambda: press.press > self._ended)
        else:
            await self._free(press)
            user, gate = self._session.user, self._gate
            deed = deed_of(user, self._address, lambda order: gate.meant(self._session, order))
            seat = await self._seats.of(self._session)
            if press.press <= self._ended:
                raise Trouble(LET_GO, "", "")
            going = Going(
                order,
                seat,
                self._accounts,
                deed,
                lambda: bool(self._under_way()),
                self._check_not_stopped,
                self._going_over,
            )
            self._going = going
            going.begin()

    def _going_over(self, going: Going, problem: str, help_: str) -> None:
        if going is not self._going:
            return  # another button was pressed meanwhile
        press, self._going = self._active, None
        if not press:
            self._tell(Jogging(press=self._ended, state="ended", why=problem, help=help_))
        elif problem:
            self._over(press, problem, help_)
        else:
            self._active, self._ended = 0, press
            self._let_others()
            self._tell(Jogging(press=press, state="reached", why=""))

    def _end_going(self) -> None:
        if self._going is not None:
            self._going.stop()

    async def _free(self, press: Press) -> None:
        """End the motion of this page's previous press, and wait until the robot is at rest.

        Raises:
            Trouble: a motion that this page hasn't begun is running, or the wait was too long.
        """
        going, self._going = self._going, None
        if going is not None:
            await going.stopped(_REST)
        await self._rested(press)
        if what := self._under_way():
            raise Trouble(f"{what} is under way", "wait for its end, or stop it", "")

    async def _begin(self, press: Press) -> replies.Wanted:
        self._admit(press, wants.MoveJoints(velocity={"J": 0.0}))
        detail = press.model_dump_json(include={"velocity", "twist", "step", "axes", "moving", "share"})
        self._accounts.note(Deed(self._session.user, self._address, JOG, detail))
        seat = await self._seats.of(self._session)
        await self._free(press)
        if press.step is not None:
            self._goal = await self._pressed.step(press, press.step, seat)
        want = self._goal or await self._pressed.of(press, seat)
        if press.press <= self._ended:
            raise Trouble(LET_GO, "", "")
        self._check_not_stopped()
        self._seat = seat
        await seat.ask(
            orders.Steer(
                moving=press.moving,
                speed=press.share * self._robot.jog_speed / MM,
                share=press.share,
                again=False,
                title=JOG,
            )
        )
        reply = await seat.ask(want)
        self._begun = True
        return reply

    async def _rested(self, press: Press) -> None:
        """Wait until the previous jog has come to rest."""
        until = self._now() + _REST
        while self._under_way() == JOG and self._now() < until and press.press > self._ended:
            await asyncio.sleep(_LOOKED_EACH)

    def _over(self, press: int, reason: str, help_: str = "", code: str = "") -> None:
        """End a press and all earlier ones."""
        self._ended = max(self._ended, press)
        if self._active and self._active <= self._ended:
            self._active = 0
            self._rest()
            self._let_others()
        shown = "pin" if code == "pin" else ""
        self._tell(Jogging(press=press, state="ended", why=reason, help=help_, code=shown))

    def _let_others(self) -> None:
        if self._seats.jogging.get(self._session.id) is self:
            del self._seats.jogging[self._session.id]

    def _rest(self) -> None:
        if self._going is not None:
            self._going.rest()
        if self._seat is None:
            return
        if self._begun:
            self._seat.send(orders.Leave())
        else:
            self._seat.send(orders.Stop())  # cancels a motion that is about to begin

    def _tell(self, message: Message) -> None:
        async def told() -> None:
            with contextlib.suppress(Exception):  # the page may be gone
                await self._say(message)

        task = asyncio.ensure_future(told())
        _TELLING.add(task)
        task.add_done_callback(_TELLING.discard)


_TELLING: set[asyncio.Future[None]] = set()
