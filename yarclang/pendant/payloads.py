"""Change of a tool's payload (mass, center of mass and inertia) in robot.toml, and its effect on the joint
torques. All functions read files or take long to compute: call them in a thread.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from yarclang.coordinator.messages.findings import finding_messages
from yarclang.diagnostics import Diagnostic, Result
from yarclang.hir import Gap
from yarclang.motion.plan import MotionPlan
from yarclang.pendant.messages import tools as said
from yarclang.pendant.project.folder import ProjectFolder
from yarclang.pendant.project.git import text_of
from yarclang.robot.description import read_robot
from yarclang.robot.dynamics import holding_torques, torques
from yarclang.robot.library import DESCRIPTION
from yarclang.robot.model import Array, Dynamics, Robot
from yarclang.robot.payload import Worst, worst_holding, worst_of
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.toml.changes import ChangeError, with_table, with_value, without
from yarclang.toml.reading import parse_toml, read_text

_EACH, _MOST_INSTANTS = 16, 40_000
"""Largest number of instants at which torques are computed: for one motion, and for a whole program."""


@dataclass(frozen=True, slots=True)
class RobotFile:
    """The robot.toml of the running robot, in its present version on the disk.

    Attributes:
        file: path in the project, or absolute path.
        folder: folder that contains the file.
        text: content of the file.
        sha256: SHA-256 of the file.
        outside: reason why the pendant can't change the file; empty if it can.
        remedy: what to do if the pendant can't change the file.
    """

    file: str
    folder: Path
    text: str
    sha256: str
    outside: str = ""
    remedy: str = ""

    @property
    def why_not(self) -> str:
        """Reason why the pendant can't change the file, with the remedy, in one sentence; empty if it can."""
        return f"{self.outside}: {self.remedy}" if self.outside else ""

    @property
    def source(self) -> SourceFile:
        """Content of the file, with the name that findings report."""
        return SourceFile(self.file, self.text)

    @property
    def data(self) -> dict[str, Any]:
        """The parsed TOML.

        Raises:
            Trouble: the text is no TOML.
        """
        data = parse_toml(self.source)
        if isinstance(data, Diagnostic):
            what = f"{self.file} can't be read: {data.clause}"
            raise Trouble(what, "correct it on the page Files", data.code)
        return data

    def read(self) -> Result[Robot]:
        """Return the robot that the file describes."""
        return read_robot(self.source, self.folder)


def robot_file(robot: Robot, project: ProjectFolder) -> RobotFile:
    """Read the robot.toml of a robot.

    Args:
        robot: the running robot.
        project: files of the project, the only ones that the pendant can change.

    Raises:
        Trouble: the file can't be read.
    """
    place = robot.folder.resolve() / DESCRIPTION
    if place.is_relative_to(project.root):
        file = place.relative_to(project.root).as_posix()
        content, told = project.read(file)
        return RobotFile(file, robot.folder, text_of(file, content), told.sha256)
    text_read = read_text(place, "")
    if isinstance(text_read, Diagnostic):
        raise Trouble(text_read.clause, "check whether it was moved", text_read.code)
    outside = f"{robot.name} is described outside of the project, in {place.parent}"
    remedy = "copy that folder into the project, and start the pendant with --robot and the copy"
    sha256 = hashlib.sha256(text_read.text.encode()).hexdigest()
    return RobotFile(str(place), robot.folder, text_read.text, sha256, outside, remedy)


def tables_of(data: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return the tables [tools.NAME] of a file by the names as written in the file."""
    found = data.get("tools")
    if not isinstance(found, dict):
        return {}
    return {name: table for name, table in found.items() if isinstance(table, dict)}


def with_payload(file: RobotFile, payload: said.Payload) -> str:
    """Return the text of robot.toml with a tool's new payload. Numbers whose value doesn't change keep their
    spelling.

    Args:
        file: the robot.toml to change.
        payload: new payload of the tool.

    Raises:
        Trouble: the tool isn't in the file and can't be added, or its TOML table is written in a form that
            can't be changed.
    """
    tables = tables_of(file.data)
    named = {name.upper(): name for name in tables}
    name = named.get(payload.tool.upper())
    new_values: dict[str, object] = {"mass": payload.mass}
    if payload.mass > 0.0:
        new_values["center_of_mass"] = list(payload.center_mm)
        if payload.inertia is not None:
            new_values["inertia"] = list(payload.inertia)
    try:
        if name is None:
            if payload.frame is None:
                problem = f"{file.file} has no tool {payload.tool}"
                raise Trouble(problem, "name one of its tools, or the frame of a new tool", "")
            return with_table(
                file.source, ("tools", payload.tool.upper()), {"frame": payload.frame.upper(), **new_values}
            )
        return _changed(file, name, tables[name], new_values)
    except ChangeError as error:
        problem = f"[tools.{payload.tool}] can't be changed by the pendant: {error}"
        raise Trouble(problem, "change robot.toml by hand, on the page Files", "") from None


def _changed(file: RobotFile, name: str, table: dict[str, Any], new_values: dict[str, object]) -> str:
    """Return the text with a new mass, center of mass and inertia of an existing tool."""
    text = file.text
    for key in ("mass", "center_of_mass", "inertia"):
        path, source = ("tools", name, key), SourceFile(file.file, text)
        if key not in new_values:
            text = without(source, path) if key in table else text
        elif key in table and table[key] == new_values[key]:
            continue
        elif key not in table and key == "center_of_mass" and not any(map(bool, _numbers(new_values[key]))):
            continue  # a center of mass at the frame's origin is the default
        else:
            text = with_value(source, path, new_values[key])
    return text


def _numbers(value: object) -> Sequence[float]:
    return value if isinstance(value, list) else ()


def joints_of(robot: Robot) -> tuple[said.JointEffort, ...]:
    """Return the joints, each with the largest torque that its motor can provide."""
    efforts = np.full(robot.size, np.inf) if robot.dynamics is None else robot.dynamics.effort
    return tuple(
        said.JointEffort(
            name=name,
            unit="N" if prismatic else "N m",
            effort=float(effort) if np.isfinite(effort) else None,
        )
        for name, prismatic, effort in zip(robot.joint_names, robot.chain.is_prismatic, efforts, strict=True)
    )


def torques_of(
    robot: Robot, other: Robot, position: Array | None, plan: MotionPlan | None
) -> tuple[tuple[said.Torques, ...], str]:
    """Compare the joint torques with the present and with the new payload.

    Args:
        robot: the running robot.
        other: the robot with the new payload, read from the changed robot.toml.
        position: (n,) present joint positions [rad or m]; None if unknown.
        plan: motion plan of a program whose torques are compared as well; None for no program.

    Returns:
        Two values: the comparisons, and the reason if the torques can't be computed. Torques are compared at
        rest at the present position, at rest anywhere within the joint limits, and in the motions of the
        program.
    """
    now, dynamics_then = robot.dynamics, other.dynamics
    if now is None or dynamics_then is None or robot.joint_names != other.joint_names:
        return (), "robot.toml describes another arm than the loaded one: restart the pendant first"
    chain, limits = other.chain, other.limits
    torques = []
    if position is not None:
        q = position[None]
        before, after = holding_torques(robot.chain, now, q)[0], holding_torques(chain, dynamics_then, q)[0]
        torques.append(_comparison(robot, "here", before, Worst(after, np.repeat(q, robot.size, axis=0))))
    before = worst_holding(robot.chain, now, robot.limits.lower, robot.limits.upper).torque
    torques.append(
        _comparison(robot, "reach", before, worst_holding(chain, dynamics_then, limits.lower, limits.upper))
    )
    if plan is not None and plan.motions:
        torques.append(_of_program(robot, (now, dynamics_then), plan))
    return tuple(torques), ""


def _of_program(robot: Robot, loads: tuple[Dynamics, Dynamics], plan: MotionPlan) -> said.Torques:
    """Compare the largest torques over all motions of a program, in all of its branches."""
    each = max(2, min(_EACH, _MOST_INSTANTS // len(plan.motions)))
    rows = [one.curve.sample(np.linspace(0.0, one.curve.duration, each)) for one in plan.motions]
    q, v, a = (np.concatenate([row[part] for row in rows]) for part in range(3))
    before, after = (torques(robot.chain, one, q, v, a) for one in loads)
    at = np.abs(after).argmax(axis=0)
    titles = tuple(_title(plan, plan.motions[int(row) // each].step) for row in at)
    return _comparison(robot, "program", worst_of(before, q).torque, worst_of(after, q), titles)


def _title(plan: MotionPlan, step: int) -> str:
    found = plan.program.steps[step]
    return "" if isinstance(found, Gap) else found.origin.label


def _comparison(
    robot: Robot, quantity: Any, now: Array, after: Worst, place: tuple[str, ...] = ()
) -> said.Torques:
    return said.Torques(
        what=quantity,
        now=tuple(now.round(6).tolist()),
        then=tuple(after.torque.round(6).tolist()),
        at=tuple(map(tuple, (after.q / robot.axis_units).round(3).tolist())),
        where=place,
    )


def proposed(
    robot: Robot,
    project: ProjectFolder,
    payload: said.Payload,
    position: Array | None,
    plan: MotionPlan | None,
) -> said.PayloadShown:
    """Return the effects of a new payload: the changed text of robot.toml and the joint torques.

    Args:
        robot: the running robot.
        project: files of the project, the only ones that the pendant can change.
        payload: new payload, as the user has entered it.
        position: (n,) present joint positions [rad or m]; None if unknown.
        plan: motion plan of a program whose torques are compared as well; None for no program.

    Raises:
        Trouble: robot.toml can't be read, or can't be changed to this payload.
    """
    file = robot_file(robot, project)
    after = with_payload(file, payload)
    read = read_robot(SourceFile(file.file, after), file.folder)
    torques: tuple[said.Torques, ...] = ()
    unknown = "the changed robot.toml has errors"
    if read.value is not None:
        torques, unknown = torques_of(robot, read.value, position, plan)
    return said.PayloadShown(
        file=file.file,
        why_not=file.why_not,
        before=file.text,
        after=after,
        known=file.sha256,
        findings=finding_messages(read.diagnostics),
        sound=read.value is not None,
        joints=joints_of(read.value or robot),
        torques=torques,
        unknown=unknown,
        restart=differs(robot, file.read()),
    )


def differs(robot: Robot, read: Result[Robot]) -> bool:
    """Return True if the file describes a robot that differs from the running one."""
    if read.value is None:
        return True
    theirs, ours = read.value.dynamics, robot.dynamics
    if theirs is None or ours is None:
        return read.value.fingerprint != robot.fingerprint
    # The fingerprint doesn't depend on masses of bodies whose torques aren't checked yet, so compare the
    # efforts, too.
    return read.value.fingerprint != robot.fingerprint or not np.array_equal(theirs.effort, ours.effort)
