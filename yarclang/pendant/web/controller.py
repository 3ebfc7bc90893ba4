"""HTTP routes to show which changed files need a restart, and to restart or shut down the pendant. Orders
to the controller have routes of their own.
"""

from __future__ import annotations

import asyncio

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.replies import Done
from yarclang.pendant.accounts.people import Deed
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.life import How
from yarclang.pendant.messages.controller import ControllerShown, EndProcess, WaitingFile
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route, Serve
from yarclang.pendant.web.service import Service, address_of
from yarclang.runtime.actions import Trouble

_RESTS = 10.0
"""Longest wait for the robot to come to rest before the process ends [s]."""

_LOOKED_EACH = 0.05


async def _controller(service: Service, request: Request) -> Response:
    service.session(request)
    watched = service.watched
    welcome, status = watched.attached.welcome, await watched.attached.ask(orders.AskStatus())
    service.descriptions.know(status.cell)
    waiting = await asyncio.to_thread(service.descriptions.waiting)
    return answer(
        ControllerShown(
            robot=service.robot.name,
            controller=status.controller,
            simulated=welcome.simulated,
            served=welcome.serves,
            since=status.since,
            waiting=tuple(WaitingFile(file=file, what=what) for file, what in waiting),
        )
    )


def _ending(way: How) -> Serve:
    async def serve(service: Service, request: Request) -> Response:
        session = service.session(request, Role.SERVICE, pin=True)
        asked = await body(request, EndProcess)
        service.accounts.used(session)
        await service.life.may(way)
        if service.watched.showing.under_way and not asked.stop and _is_ended_by(service):
            what = f"{service.watched.showing.under_way} is under way"
            raise Trouble(what, "wait for its end, or stop it first", "under-way")
        await service.accounts.did(Deed(session.user, address_of(request), way))
        if _is_ended_by(service):
            await _rested(service)
        await service.life.may(way)  # another request may have come first
        service.life.end(way)
        return answer(Done())

    return serve


def _is_ended_by(service: Service) -> bool:
    """Return True if a running motion would end together with this process: because the coordinator runs
    in this process or can't be reached, or because a user of this pendant owns the robot.
    """
    watched = service.watched
    if not watched.showing.connected or not watched.attached.welcome.serves:
        return True
    return bool(service.seats.session_called(watched.showing.owner))


async def _rested(service: Service) -> None:
    """Stop the running motion, if there is one, and wait until the robot is at rest.

    Raises:
        Trouble: the robot doesn't come to rest in time.
    """
    showing, loop = service.watched.showing, asyncio.get_running_loop()
    if not showing.under_way or not showing.connected:
        return
    await service.watched.attached.ask(orders.Stop())
    until = loop.time() + _RESTS
    while showing.under_way:
        if loop.time() > until:
            raise Trouble(
                f"{showing.under_way} isn't at rest {_RESTS:g} s after it was stopped",
                "inspect the robot; if it moves although it shouldn't, press the emergency stop",
                "",
            )
        await asyncio.sleep(_LOOKED_EACH)


ROUTES = (
    Route("GET", "/api/system/controller", _controller,
        "Return what the controller is, and which files wait for a restart.", None, ControllerShown,
            "viewer"),
    Route("POST", "/api/system/restart", _ending("restart"),
        "Restart the pendant's process; the robot rests first. Needs the PIN.", EndProcess, Done, "service"),
    Route("POST", "/api/system/shut-down", _ending("shut-down"),
        "End the pendant's process; the robot rests first. Needs the PIN.", EndProcess, Done, "service"),
)  # fmt: skip
"""All routes of this file."""
