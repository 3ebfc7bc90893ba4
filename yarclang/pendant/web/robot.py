"""HTTP routes for the robot: its description, orders to it, taking and giving control of it, and the
programs of the project.
"""

from __future__ import annotations

import asyncio
from typing import Any

from starlette.requests import Request
from starlette.responses import Response

from yarclang.coordinator.messages import orders, wants
from yarclang.coordinator.messages.lines import MOST_LINE, name_of, read_order
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Denied, Done
from yarclang.pendant.accounts.roles import AUDITED, NEEDS, Role
from yarclang.pendant.gate import AT_ONCE
from yarclang.pendant.jogging import TURN
from yarclang.pendant.messages.display import Notice
from yarclang.pendant.messages.reading import Malformed
from yarclang.pendant.messages.robot import Asked, FrameShown, GiveControl, JointShown, Programs, RobotShown
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route, Serve
from yarclang.pendant.web.service import Service, address_of
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.units import MM

OVER_HTTP: dict[type[Order[Any]], Role] = {
    kind: role for kind, role in NEEDS.items() if kind not in (*wants.KINDS, orders.Steer, orders.Leave)
}
"""Orders that can be given over HTTP, each by a route of its own, with the required roles. The WebSocket of a
page accepts them as well. Hold-to-run motions need the WebSocket for jogs instead.
"""

_BEAT = "x-yarc-beat"
"""Header with the last heartbeat that a page has received. Without it, the age of a request isn't checked."""


def order_in(text: bytes) -> tuple[Order[Any], int | str | None]:
    """Parse a JSON object as an order. Return two values: the order, and the id that the page gave to it
    (None without one).

    Raises:
        Malformed: the object isn't an order that the API accepts here.
    """
    order = read_order(text, MOST_LINE)
    if isinstance(order.what, Denied):
        raise Malformed(order.what.error, order.what.help or "see the API's page", "")
    if type(order.what) not in OVER_HTTP:
        what = f"{name_of(order.what)} can't be ordered here"
        raise Malformed(what, "send hold-to-run motions over the socket /api/jog", "")
    return order.what, order.id


def _order_route(kind: type[Order[Any]]) -> Route:
    word = kind.model_fields["order"].default

    async def serve(service: Service, request: Request) -> Response:
        session = service.session(request)
        asked = await body(request, kind)
        if kind in AUDITED and kind not in AT_ONCE:
            _check_fresh(service, request)
        service.accounts.used(session)
        return answer(await service.gate.order(session, asked, address_of(request)))

    summary = (kind.__doc__ or "").strip().split("\n\n")[0]
    made: Serve = serve
    return Route("POST", f"/api/orders/{word}", made, summary, kind, kind.answer, OVER_HTTP[kind].value)


def _check_fresh(service: Service, request: Request) -> None:
    """Check that the request of a page wasn't delayed on its way. A page names the last heartbeat that it has
    received. If the network or this process stood still, the user has seen that the connection was lost, and
    doesn't expect any more that the robot moves.

    Raises:
        Trouble: the request is too old.
    """
    beat = request.headers.get(_BEAT, "")
    if beat and not (
        beat.isascii() and beat.isdigit() and len(beat) < 16 and service.watched.is_fresh(int(beat))
    ):
        raise Trouble("the order came too late; nothing was done", "the network is slow: order it again", "")


async def _robot(service: Service, request: Request) -> Response:
    service.session(request)
    return answer(await robot_shown(service))


async def robot_shown(service: Service) -> RobotShown:
    """Return the description of the robot for pages."""
    attached = service.watched.attached
    frames = (await attached.ask(orders.AskFrames())).frames
    robot, welcome = service.robot, attached.welcome
    frames_shown = [(one, FrameShown(name=one.name, pose=one.pose)) for one in frames]
    moving = sorted(
        (frame for one, frame in frames_shown if one.on_flange), key=lambda one: one.name != "{TCP}"
    )
    return RobotShown(
        name=robot.name,
        title=robot.title,
        controller=welcome.status.controller,
        simulated=welcome.simulated,
        folder=str(service.gate.folder),
        cell=welcome.status.cell,
        joints=_joints(robot),
        jog_speed_mm_s=round(robot.jog_speed / MM, 6),
        jog_turn_deg_s=TURN,
        fixed=tuple(frame for one, frame in frames_shown if not one.on_flange),
        moving=tuple(moving),
    )


def _joints(robot: Robot) -> tuple[JointShown, ...]:
    units = robot.axis_units
    rows = zip(
        robot.joint_names,
        robot.axis_unit_names,
        (robot.limits.lower / units).round(6).tolist(),
        (robot.limits.upper / units).round(6).tolist(),
        (robot.limits.velocity / units).round(6).tolist(),
        strict=True,
    )
    return tuple(
        JointShown(name=name, unit=unit, lower=lower, upper=upper, velocity=velocity)
        for name, unit, lower, upper, velocity in rows
    )


async def _ask_control(service: Service, request: Request) -> Response:
    session = service.session(request, Role.OPERATOR)
    service.accounts.used(session)
    return answer(await service.gate.ask_for_control(session, address_of(request)))


async def _give_control(service: Service, request: Request) -> Response:
    session = service.session(request, Role.OPERATOR)
    service.accounts.used(session)
    asked = await body(request, GiveControl)
    if asked.refuse:
        if not service.gate.owns(session):
            raise Trouble("you don't control the robot", "take control first", "")
        service.watched.notice(Notice(text=f"{session.user} keeps control of the robot"), asked.to)
        return answer(Done())
    return answer(await service.gate.give_control(session, asked.to, address_of(request)))


async def _programs(service: Service, request: Request) -> Response:
    service.session(request)
    # List the files in a thread. A folder may contain 100,000 files, and this event loop also streams to the
    # robot.
    return answer(await asyncio.to_thread(service.gate.programs))


ROUTES = (
    Route("GET", "/api/robot", _robot, "Return what the robot is: joints, limits, frames.", None, RobotShown,
        "viewer"),
    Route("GET", "/api/programs", _programs, "Return the programs of the project.", None, Programs, "viewer"),
    Route("POST", "/api/control", _ask_control, "Take control of the robot, or ask its owner for it.", None,
        Asked, "operator"),
    Route("POST", "/api/control/give", _give_control,
        "Give control to the session that asked, keep it, or (to nobody) release it.", GiveControl, Asked,
            "operator"),
    *(_order_route(kind) for kind in OVER_HTTP),
)  # fmt: skip
"""All routes of this file."""
