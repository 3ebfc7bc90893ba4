"""A client's actions that make a controller ready for motions: enabling motors, homing, comparing and sending
settings. Only the owner may change anything.
"""

from __future__ import annotations

import hashlib
from collections.abc import Awaitable, Callable
from typing import TypeVar

from yarclang.backend import backend_of
from yarclang.coordinator.client.part import Part
from yarclang.coordinator.describing import finished
from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.events import Began
from yarclang.lasting import Lasting
from yarclang.pipeline.settings import proved_settings
from yarclang.runtime.actions import Lost, Script, Trouble
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.outcome import Ended
from yarclang.runtime.scripts import Sent, Services

T = TypeVar("T")

ENABLING, DISABLING, SENDING, SAVING = "enabling", "disabling", "sending settings", "saving settings"


def wrong_in(inspection: Inspection) -> tuple[str, ...]:
    """Return the failed checks, in words."""
    return tuple(f"{one.subject} is {one.found!r}, not {one.wanted!r}" for one in inspection.errors)


class Servicing(Part):
    """Group of a client's actions that prepare a controller."""

    @property
    def _services(self) -> Services:
        services = self._coordinator.engine.scripts.services
        if services is None:
            raise Trouble(
                "this kind of controller is set up with the manufacturer's tools", "use them", "Y1612"
            )
        return services

    def _lines(self, text: str) -> tuple[str, ...]:
        return backend_of(self._coordinator.robot).settings().lines(text)

    # motors

    async def enable(self) -> replies.Serviced:
        """Close the control loops of the motors. See `yarclang.runtime.scripts.Services`.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or there is no connection.
        """
        return await self._served(ENABLING, "to enable the motors", self._services.enable)

    async def disable(self) -> replies.Serviced:
        """Open the control loops of all motors.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or there is no connection.
        """
        return await self._served(DISABLING, "to disable the motors", self._services.disable)

    async def _served(self, name: str, wrong: str, script: Callable[..., Script[str]]) -> replies.Serviced:
        coordinator = self._coordinator
        coordinator.check_owner(self._name, wrong)
        engine, stops = coordinator.engine, coordinator.stops
        operation, robot = engine.operation, coordinator.robot

        async def work() -> tuple[str, Inspection]:
            if coordinator.stops != stops:
                raise Trouble("stopped before it began; nothing was done", "", "")
            outcome = await engine.session.perform(script(operation, robot))
            operation.orders.clear()
            return outcome, await engine.look()

        outcome, found = await self._carried_out(name, work, lambda made: made[0])
        return replies.Serviced(what=outcome, wrong=wrong_in(found))

    async def _carried_out(self, name: str, work: Callable[[], Awaitable[T]], wrong: Callable[[T], str]) -> T:
        """Carry work out, and inform all clients of its beginning and its outcome.

        Args:
            name: name of the work, for messages.
            work: function that does the work.
            wrong: function that takes the result of the work and returns what is wrong with it; empty if
                nothing is.
        """
        coordinator = self._coordinator

        async def told() -> T:
            began = Began(time_s=coordinator.time, name=name, duration_s=0.0, waits=0, client=self._name)
            coordinator.announce(began)
            ended = Ended(False, "it was ended by an unexpected error")
            try:
                result = await work()
                ended = Ended(not wrong(result), wrong(result))
            except Trouble as trouble:
                ended = Ended(False, trouble.what, trouble.remedy, code=trouble.code)
                raise
            except Lost as lost:
                ended = Ended(False, f"the connection was lost: {lost}", code="Y1606")
                raise
            finally:
                coordinator.announce(finished(coordinator.time, name, ended, coordinator.robot))
            return result

        return await coordinator.engine.move(name, told, serves=True)

    # homing

    async def searches(self) -> replies.HomeSearches:
        """Return the home searches that the controller would carry out.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        engine, robot = self._coordinator.engine, self._coordinator.robot
        searches = await engine.ask(lambda: self._services.searches(engine.operation, robot))
        return replies.HomeSearches(
            searches=tuple(
                replies.MotorSearch(
                    motor=one.motor,
                    joint=one.joint,
                    unit=one.unit,
                    speed=round(one.speed, 6),
                    longest_s=round(one.longest, 1),
                    refused=one.refused,
                    homed=motor.homed,
                )
                for one, motor in zip(searches, engine.operation.motors, strict=True)
            )
        )

    async def home(self, motors: tuple[int, ...]) -> Ended:
        """Let the controller home motors, one after the other. A hold, a stop or an abort ends the homing.

        Returns:
            The outcome.

        Raises:
            NotOwner: this client only watches.
            Trouble: something is in progress, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to home the robot")
        engine, stops = coordinator.engine, coordinator.stops
        operation, robot = engine.operation, coordinator.robot
        if unknown := [str(one) for one in motors if one not in robot.controller.motors]:
            raise Trouble(
                f"the robot has no motor {', '.join(unknown)}", "name at least one of its motors", "Y1601"
            )

        async def work() -> Ended:
            ended = Ended(True)
            try:
                for motor in motors:
                    await engine.session.perform(self._services.home(operation, robot, motor))
                    coordinator.tell(f"motor {motor} is homed")
            except Trouble as trouble:
                ended = Ended(False, trouble.what, trouble.remedy, code=trouble.code)
            # After homing, the same position of the robot has other numbers.
            coordinator.history.forget()
            coordinator.carrying.kept.doubt_all("the motors were homed")
            operation.orders.clear()
            await engine.look()
            return ended

        names = ", ".join(map(str, motors))
        many = "motors" if len(motors) > 1 else "motor"
        return await coordinator.carry_out(
            self._name, f"homing {many} {names}", Lasting(), work, stops, serves=True
        )

    # settings

    async def compared(self) -> replies.SettingsCompared:
        """Compare the controller's settings with those that the robot needs.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        coordinator = self._coordinator
        text = await coordinator.plan(proved_settings, coordinator.robot)
        found = await coordinator.engine.look_again()
        things = []
        for checked in found.checked:
            name, _, about = checked.subject.partition(", ")
            things.append(
                replies.Comparison(
                    name=name,
                    about=about,
                    found=checked.found,
                    wanted=checked.wanted,
                    verdict=checked.verdict,
                    help=checked.remedy,
                )
            )
        return replies.SettingsCompared(
            things=tuple(things), lines=len(self._lines(text)), sha256=_digest(text)
        )

    async def send(self, compared_sha: str) -> replies.SettingsSent:
        """Send the settings that the robot needs to the controller.

        Args:
            compared_sha: SHA-256 of the settings' text that the user has compared.

        Raises:
            NotOwner: this client only watches.
            Trouble: the settings have changed since the comparison, a loop is closed, something is in
                progress, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to send settings")
        engine, stops = coordinator.engine, coordinator.stops
        operation, robot = engine.operation, coordinator.robot
        text = await coordinator.plan(proved_settings, robot)
        if _digest(text) != compared_sha:
            raise Trouble("the settings have changed since they were compared", "compare them again", "Y1613")
        lines = self._lines(text)

        async def work() -> tuple[Sent, Inspection]:
            if coordinator.stops != stops:
                raise Trouble("stopped before it began; nothing was sent", "", "")
            await engine.session.perform(self._services.check_open(operation, robot))
            sent = await engine.session.perform(self._services.send(operation, lines))
            operation.orders.clear()
            return sent, await engine.look()

        sent, found = await self._carried_out(SENDING, work, lambda made: made[0].what)
        return replies.SettingsSent(
            sent=sent.sent, of=sent.of, what=sent.what, help=sent.remedy, wrong=wrong_in(found)
        )

    async def save(self) -> replies.Done:
        """Let the controller store its settings permanently.

        Raises:
            NotOwner: this client only watches.
            Trouble: the robot isn't at rest, something is in progress, or there is no connection.
        """
        coordinator = self._coordinator
        coordinator.check_owner(self._name, "to save settings")
        engine = coordinator.engine
        await self._carried_out(
            SAVING,
            lambda: engine.session.perform(self._services.save(engine.operation, coordinator.robot)),
            lambda _: "",
        )
        return replies.Done()


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
