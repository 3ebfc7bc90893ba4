"""HTTP routes for frames and tools: which files declare them, the effect of a new payload on the joint
torques, and writing the payload to robot.toml.
"""

from __future__ import annotations

import asyncio

from starlette.requests import Request
from starlette.responses import Response

from yarclang.cell.model import Cell
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.replies import NamedFrame
from yarclang.motion.plan import MotionPlan
from yarclang.pendant.accounts.roles import Role
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.messages import tools as said
from yarclang.pendant.payloads import (
    RobotFile,
    differs,
    proposed,
    robot_file,
    tables_of,
    with_payload,
)
from yarclang.pendant.project.folder import Changed, ProjectFolder
from yarclang.pendant.web.answers import answer, body
from yarclang.pendant.web.routes import Route
from yarclang.pendant.web.service import Service, address_of
from yarclang.robot.description import read_robot
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile


async def _tools(service: Service, request: Request) -> Response:
    service.session(request)
    attached = service.watched.attached
    frames = (await attached.ask(orders.AskFrames())).frames
    cell = await service.signals.cell(attached)
    return answer(await asyncio.to_thread(_tools_shown, service.robot, service.files.folder, frames, cell))


def _tools_shown(
    robot: Robot, project: ProjectFolder, frames: tuple[NamedFrame, ...], cell: Cell | None
) -> said.ToolsShown:
    file, tools, reason = None, tuple[said.ToolKnown, ...](), ""
    try:
        file = robot_file(robot, project)
        tools, reason = tuple(_tools_in_file(file)), file.why_not
    except Trouble as trouble:
        reason = f"{trouble.what}: {trouble.remedy}"
    dynamics = robot.dynamics
    names = robot.joint_names
    return said.ToolsShown(
        frames=tuple(
            said.FrameKnown(
                name=one.name, on_flange=one.on_flange, pose=one.pose, origin=_origin(one, robot, cell)
            )
            for one in frames
        ),
        tools=tools,
        sits_on=tuple(robot.flange_from_frame),
        file=str(robot.folder) if file is None else file.file,
        why_not=reason,
        restart=file is None or differs(robot, file.read()),
        without_mass=()
        if dynamics is None
        else tuple(name for name, mass in zip(names, dynamics.mass.tolist(), strict=True) if mass <= 0.0),
        without_effort=()
        if dynamics is None
        else tuple(
            name
            for name, effort in zip(names, dynamics.effort.tolist(), strict=True)
            if effort == float("inf")
        ),
        checked=dynamics is not None and dynamics.is_checked,
    )


def _origin(frame: NamedFrame, robot: Robot, cell: Cell | None) -> said.Origin:
    """Return the place of a frame's declaration: a file, or the session. A frame of the session hides a frame
    of the same name in cell.toml.
    """
    name = frame.name.strip("{}").upper()
    if name in ("B", "FLANGE"):
        return "urdf"
    if frame.on_flange and name in robot.flange_from_frame:
        return "robot.toml"
    known = None if cell is None else cell.frames.get(name)
    if known is not None and tuple(map(tuple, known.mount.transform.tolist())) == frame.pose:
        return "cell.toml"
    return "session"


def _tools_in_file(file: RobotFile) -> list[said.ToolKnown]:
    """Return the tools of a file. Their invalid values are left out."""
    from yarclang.robot.draft import read_draft

    tools = read_draft(file.data).table.tools
    return [
        said.ToolKnown(
            name=name,
            frame=tools[name].frame,
            mounted=tools[name].mounted,
            mass=tools[name].mass,
            center_mm=_row(tools[name].center_of_mass),
            inertia=_row(tools[name].inertia),
        )
        for name in tables_of(file.data)
        if name in tools
    ]


def _row(values: list[float] | None) -> tuple[float, ...] | None:
    return None if values is None else tuple(values)


async def _propose(service: Service, request: Request) -> Response:
    session = service.session(request, Role.PROGRAMMER)
    asked = await body(request, said.Payload)
    service.accounts.used(session)
    plan = await _plan(service, session, asked.program)
    here = service.watched.showing.joints
    made = await asyncio.to_thread(proposed, service.robot, service.files.folder, asked, here, plan)
    return answer(made)


async def _plan(service: Service, session: Session, number: int | None) -> MotionPlan | None:
    if number is None:
        return None
    loaded = await service.program_scenes.loaded(session, number)
    return loaded.plan or loaded.text_plan


async def _save(service: Service, request: Request) -> Response:
    session = service.session(request, Role.SERVICE, pin=True)
    asked = await body(request, said.SavePayload)
    text, file = await asyncio.to_thread(_written, service.robot, service.files.folder, asked)
    what = f"mass of tool {asked.tool.upper()}: {asked.mass:g} kg"
    made = await service.files.change(session, address_of(request), file, text, asked.known, what)
    restart = await asyncio.to_thread(_restart, service.robot, service.files.folder)
    return answer(said.PayloadWritten(file=made.file, sha256=made.sha256, restart=restart))


def _written(robot: Robot, project: ProjectFolder, request_body: said.SavePayload) -> tuple[str, str]:
    """Return two values: the text of robot.toml with a tool's new payload, and the path of robot.toml.

    Raises:
        Trouble: the pendant can't change the file, the file has changed since the page showed it, or it would
            become invalid.
    """
    file = robot_file(robot, project)
    if file.outside:
        raise Trouble(file.outside, file.remedy, "outside")
    if file.sha256 != request_body.known:
        raise Changed(file.file, file.sha256)
    text = with_payload(file, request_body)
    read = read_robot(SourceFile(file.file, text), file.folder)
    if read.value is None:
        first = read.diagnostics[0]
        raise Trouble(first.clause, first.help or "enter other values", first.code)
    return text, file.file


def _restart(robot: Robot, project: ProjectFolder) -> bool:
    return differs(robot, robot_file(robot, project).read())


ROUTES = (
    Route("GET", "/api/tools", _tools,
        "Return frames with their origin, and the tools of robot.toml with their masses.", None,
            said.ToolsShown, "viewer"),
    Route("POST", "/api/tools/payload", _propose,
        "Return what a payload would change: robot.toml, its findings, and the torques of the joints. "
        "Nothing is written.", said.Payload, said.PayloadShown, "programmer"),
    Route("POST", "/api/tools/payload/save", _save,
        "Write a payload into robot.toml: 409 with the code `changed` if it isn't as it was shown.",
            said.SavePayload, said.PayloadWritten, "service"),
)  # fmt: skip
"""All routes of this file."""
