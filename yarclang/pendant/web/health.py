"""HTTP route for the health of the pendant's computer, its process and its data."""

from __future__ import annotations

import asyncio

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages import orders
from yarclang.pendant.health.judging import (
    Judgement,
    lasting,
    of_disks,
    of_link,
    of_memory,
    of_speed,
    of_stored,
    worst_of,
)
from yarclang.pendant.health.versions import versions
from yarclang.pendant.messages.health import SystemHealth, VersionShown, Watched
from yarclang.pendant.web.answers import answer
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service
from yarclang.robot.kinds import title_of
from yarclang.runtime.actions import Trouble


async def _health(service: Service, request: Request) -> Response:
    service.session(request)
    sampler = service.sampler
    if sampler.machine is None or sampler.stored is None:
        await sampler.look()
    judged = _judged(service)
    known = await asyncio.to_thread(versions)
    rows = (*known, *await _robot(service))
    sessions, pages = len(service.accounts.sessions.all()), sampler.pages
    history = sampler.history
    return answer(
        SystemHealth(
            level=worst_of(judged),
            watched=tuple(
                Watched(
                    group=one.group,
                    name=one.name,
                    value=one.value,
                    level=one.level,
                    limits=one.limits,
                    why=one.why,
                    remedy=one.remedy,
                    history=tuple(history.get(one.key, ())),
                )
                for one in judged
            ),
            uptime_s=round(sampler.uptime, 1),
            sessions=sessions,
            pages=pages,
            versions=tuple(VersionShown(name=name, version=version) for name, version in rows),
            text=_text(judged, rows, sampler.uptime, sessions, pages),
        )
    )


def _judged(service: Service) -> tuple[Judgement, ...]:
    sampler, showing = service.sampler, service.watched.showing
    machine, stored = sampler.machine, sampler.stored
    if machine is None or stored is None:
        return (Judgement("disk", "Disk", "Disk", "not known yet", "unknown"),)
    return (
        *of_disks(machine.disks, stored.growth),
        *of_memory(machine, sampler.first),
        *of_speed(machine, sampler.share, sampler.lag.all),
        *of_link(showing.heard_health, connected=showing.connected),
        *of_stored(
            stored.logs, stored.logs_size, stored.growth, stored.project, stored.data, stored.database,
                stored.deeds
        ),
    )  # fmt: skip


async def _robot(service: Service) -> tuple[tuple[str, str], ...]:
    robot = service.robot
    controller = "can't be reached"
    try:
        attached = service.watched.attached
        status = await attached.ask(orders.AskStatus())
        simulated = ", simulated" if attached.welcome.simulated else ""
        controller = f"{title_of(robot.controller.kind)}{simulated}, {status.state.value}"
    except Trouble:
        pass  # the page shows everything else without the controller's state
    return ("Controller", controller), ("Robot", robot.name), ("Fingerprint of the robot", robot.fingerprint)


def _text(
    judged: tuple[Judgement, ...],
    shown_rows: tuple[tuple[str, str], ...],
    uptime: float,
    sessions: int,
    pages: int,
) -> str:
    """Return the whole report as text."""
    rows = [f"{name}: {version}" for name, version in shown_rows]
    rows += ["", f"Running for {lasting(uptime)}; {sessions} sessions, {pages} pages"]
    rows += [f"{one.name}: {one.value} [{one.level}]" for one in judged]
    return "\n".join(rows) + "\n"


ROUTES = (
    Route("GET", "/api/system/health", _health,
        "Return how disk, memory, processors, link and records are, and the versions.", None, SystemHealth,
            "viewer"),
)  # fmt: skip
"""All routes of this file."""
