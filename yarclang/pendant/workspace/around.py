"""The files that describe a workspace: cell.toml and robot.toml. This module finds and reads them, and
computes their content with a draft (unsaved changes). The functions wait for the disk.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from yarclang.coordinator.messages.replies import Surroundings
from yarclang.diagnostics import Diagnostic
from yarclang.pendant.messages.workspace import ProposedFile, WorkspaceDraft, WorkspaceShown
from yarclang.pendant.project.folder import Changed, ProjectFolder
from yarclang.pendant.workspace.changing import with_entries, with_limits
from yarclang.pendant.workspace.reading import (
    Text,
    cell_of,
    checked_robot,
    entries_of,
    findings_of,
    frames_of,
    limits_of,
    text_in,
    units_of,
    watched_of,
)
from yarclang.pipeline.project import FILE_NAME, find_project
from yarclang.robot.library import DESCRIPTION
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.toml.reading import read_text

_WIDER = "Y1355"
"""Code of the finding for a joint limit in robot.toml that is wider than the limit in the URDF."""


@dataclass(frozen=True, slots=True)
class Around:
    """The files that describe a workspace. Files outside of the project can't be changed at the pendant.

    Attributes:
        cell: path of the session's cell.toml; None without a cell.
        text: content of cell.toml; None if the pendant can't change the file.
        why: reason why the pendant can't change cell.toml; empty if it can.
        robot_path: path of robot.toml.
        robot: content of robot.toml; None if the pendant can't change the file.
        robot_why: reason why the pendant can't change robot.toml; empty if it can.
    """

    cell: Path | None
    text: Text | None
    why: str
    robot_path: Path
    robot: Text | None
    robot_why: str


def around_of(folder: ProjectFolder, surroundings: Surroundings) -> Around:
    """Read the files of a workspace. The coordinator's reply names them."""
    cell = None if surroundings.cell is None else Path(surroundings.cell)
    text, reason = None, ""
    if cell is None:
        reason = "there is no cell: make one, or name one in yarc.toml"
        # The coordinator doesn't use a cell whose file can't be read. But users must be able to repair the
        # file here.
        project = find_project(folder.root)
        if project.value is None:
            reason = f"{FILE_NAME} can't be read: {project.diagnostics[0].message}"
        elif project.value.cell is not None:
            cell = project.value.folder / project.value.cell
    if cell is not None:
        try:
            text, reason = text_in(folder, cell), ""
        except Trouble as trouble:
            reason = f"{trouble.what}: {trouble.remedy}"
            if not cell.resolve().is_relative_to(folder.root):
                reason = (
                    f"{cell} is outside of the project: change it on the pendant's computer, or copy it "
                    f"into the project and name it in yarc.toml"
                )
    path = Path(surroundings.robot) / DESCRIPTION
    robot, robot_why = None, ""
    try:
        robot = text_in(folder, path)
    except Trouble as trouble:
        robot_why = f"{trouble.what}: {trouble.remedy}"
        if not path.resolve().is_relative_to(folder.root):
            robot_why = (
                f"{path} is outside of the project: copy the folder {path.parent.name} into the "
                f"project, name it in yarc.toml as robot, and serve the robot again"
            )
    return Around(cell, text, reason, path, robot, robot_why)


def shown_of(robot: Robot, around: Around) -> WorkspaceShown:
    """Return the message that shows the workspace, as described by its files."""
    text = around.text
    source = None if text is None else text.placed
    if source is None and around.cell is not None:
        source = _read(around.cell)
    cell, findings = (None, ()) if source is None else cell_of(source, Path(source.name).parent, robot)
    units = {} if source is None else units_of(source)
    length, angle = units.get("length"), units.get("angle")
    described = _read(around.robot_path) if around.robot is None else around.robot.placed
    return WorkspaceShown(
        cell=None if around.cell is None else text.file if text else str(around.cell),
        why=around.why,
        known="" if text is None else text.known,
        entries=() if source is None else entries_of(source),
        frames=frames_of(cell),
        watch=watched_of(robot),
        length_unit="" if length is None else length.name,
        angle_unit="" if angle is None else angle.name,
        metre=None if length is None else length.factor,
        radian=None if angle is None else angle.factor,
        findings=findings_of(findings),
        robot=around.robot.file if around.robot else str(around.robot_path),
        robot_why=around.robot_why,
        robot_known="" if around.robot is None else around.robot.known,
        joints=() if described is None else limits_of(described.text, robot),
        robot_waits=_waits(robot, around),
    )


def _read(path: Path) -> SourceFile | None:
    """Return the content of a file, which may be outside of the project; None if it can't be read. A file
    outside of the project is shown, but can't be changed.
    """
    read = read_text(path, "")
    return None if isinstance(read, Diagnostic) else read


def _waits(served: Robot, around: Around) -> bool:
    """Return True if robot.toml describes a robot that differs from the one that the pendant has loaded."""
    if around.robot is None:
        return False
    robot, _ = checked_robot(around.robot.placed, around.robot_path.parent)
    return robot is None or robot.fingerprint != served.fingerprint


def proposed_of(robot: Robot, around: Around, draft: WorkspaceDraft) -> tuple[ProposedFile, ...]:
    """Return the files that a draft changes, with their texts before and after the change.

    Raises:
        Trouble: the files have changed since the draft was begun (code "changed"), or the pendant can't
            change them.
    """
    files_found = []
    if draft.entries:
        if around.text is None:
            raise Trouble("the cell can't be changed here", around.why, "")
        check_known(around.text, draft.known)
        after, description = with_entries(around.text.source, draft.entries)
        placed = SourceFile(str(around.text.path), after)
        _, diagnostics = cell_of(placed, around.text.path.parent, robot)
        files_found.append(_file(around.text, after, description, diagnostics, ""))
    if draft.limits:
        if around.robot is None:
            raise Trouble("robot.toml can't be changed here", around.robot_why, "")
        check_known(around.robot, draft.robot_known)
        after, description = with_limits(around.robot.source, draft.limits)
        folder = around.robot_path.parent
        _, before = checked_robot(around.robot.placed, folder)
        _, diagnostics = checked_robot(SourceFile(str(around.robot.path), after), folder)
        known = {one.message for one in before}
        wider = [one.message for one in diagnostics if one.code == _WIDER and one.message not in known]
        files_found.append(_file(around.robot, after, description, diagnostics, wider[0] if wider else ""))
    return tuple(one for one in files_found if one.before != one.after)


def check_known(text: Text, known_hash: str | None) -> None:
    """Check that a file is still the version from which a draft was made.

    Raises:
        Changed: the file has changed since the draft was made.
    """
    if text.known != known_hash:
        raise Changed(text.file, text.known)


def digest_of(files: tuple[ProposedFile, ...]) -> str:
    """Return a hash of the files after a draft."""
    return hashlib.sha256("\0".join(f"{one.file}\0{one.after}" for one in files).encode()).hexdigest()


def _file(
    text: Text, after: str, subject: str, diagnostics: tuple[Diagnostic, ...], refused: str
) -> ProposedFile:
    error = next((one.message for one in diagnostics if one.is_error), "")
    return ProposedFile(
        file=text.file,
        before=text.mark + text.text,
        after=text.mark + after,
        known=text.known,
        what=subject,
        refused=refused or error,
        findings=findings_of(diagnostics),
    )
