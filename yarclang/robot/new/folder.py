"""Make a robot folder from a URDF: ask the user for unknown values, then write the files."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Result, has_errors, in_order
from yarclang.frozen import frozen
from yarclang.robot.chain import screws
from yarclang.robot.checks import MOST_JOINTS
from yarclang.robot.new.chains import ArmChain, find_chain
from yarclang.robot.new.copying import UrdfCopy, copy_urdf
from yarclang.robot.new.home import homes
from yarclang.robot.new.lookup import Lookup
from yarclang.robot.new.mending import mend
from yarclang.robot.new.packages import Packages
from yarclang.robot.new.sketch import COUNTS, EASE, RISE, Given, Said, Sketch, sketch
from yarclang.robot.new.writing import robot_toml
from yarclang.robot.urdf import Urdf, read_urdf
from yarclang.source import SourceFile, Span
from yarclang.toml.reading import read_text


@frozen
class Arm:
    """A URDF, and its chain of joints that is the arm.

    Attributes:
        path: the file.
        urdf: its content, after mistakes were mended.
        chain: the chain.
        notes: sentences about what was mended.
    """

    path: Path
    urdf: Urdf
    chain: ArmChain
    notes: tuple[str, ...] = ()


@frozen
class NewRobot:
    """The files of a new robot folder.

    Attributes:
        sketch: the values of robot.toml.
        toml: text of robot.toml.
        urdf: the copy of the URDF with its meshes.
        arm: the URDF and its chain.
        homes: joint positions that could be HOME, the best first; robot.toml contains the best one.
    """

    sketch: Sketch
    toml: str
    urdf: UrdfCopy
    arm: Arm
    homes: tuple[Said, ...]

    def with_home(self, home: Said) -> NewRobot:
        """Return the new robot with another joint position as HOME."""
        return replace(self, toml=robot_toml(self.sketch, home), homes=(home,))


@frozen
class Question:
    """A question about a value of a new robot that the URDF doesn't answer.

    Attributes:
        option: the command-line option that answers it.
        text: the question.
        rule: the rule by which the value is chosen if there is no answer.
    """

    option: str
    text: str
    rule: str


def open_arm(path: Path, base: str | None, tip: str | None, source: SourceFile | None = None) -> Result[Arm]:
    """Read a URDF and find the arm in it.

    Args:
        path: the file.
        base: the link that is {B}, or None.
        tip: the link that is {FLANGE}, or None.
        source: the URDF, if it differs from the file's content.
    """
    read = source or read_text(path, "Name a URDF file.")
    if isinstance(read, Diagnostic):
        return Result(None, (read,))
    if other := _other_format(read):
        return Result(None, (other,))
    mended = mend(read)
    source = mended.source
    urdf = read_urdf(source)
    if not urdf.sound or has_errors(urdf.findings):
        return Result(None, in_order(urdf.findings))
    chain = find_chain(urdf, base, tip)
    if isinstance(chain, Diagnostic):
        return Result(None, (chain,))
    if len(chain.joints) > MOST_JOINTS:
        message = (
            f"the chain from {chain.base} to {chain.flange} has {len(chain.joints)} joints, but a coordinate "
            f"system has {MOST_JOINTS} axes"
        )
        remedy = (
            f"Begin nearer to the tip with --base, or end earlier with --tip: the joints are "
            f"{', '.join(j.name for j in chain.joints)}."
        )
        return Result(None, (Diagnostic("Y1318", message, source, help=remedy),))
    return Result(Arm(path, urdf, chain, mended.notes), in_order(urdf.findings))


_FORMATS = {
    "mujoco": ("MJCF, MuJoCo's format", "Use the manufacturer's URDF, from which most MJCF files are made."),
    "sdf": ("SDF, Gazebo's format", "Use the manufacturer's URDF, or the xacro from which the SDF was made."),
}
"""Robot descriptions other than URDF, by their root element: the format, and what to do."""


def _other_format(source: SourceFile) -> Diagnostic | None:
    """Return the finding that a robot description has another format than URDF; None if it has not."""
    root = re.search(r"<([A-Za-z]+)", re.sub(r"<!--.*?-->", "", source.text[:10_000], flags=re.DOTALL))
    if root is None or root[1] not in _FORMATS:
        return None
    name, way = _FORMATS[root[1]]
    return Diagnostic("Y1341", f"The file is {name}, not a URDF.", source, Span.on_line(1, 1, 2), way)


def proposed_name(urdf: Urdf) -> str:
    """Return the name of the URDF's robot, converted to the form that names have in robot.toml; ROBOT if the
    URDF has no name.
    """
    said = urdf.root.attributes.get("name", "") if urdf.root else ""
    name = re.sub(r"\W+", "_", said, flags=re.ASCII).strip("_").upper()
    name = f"R{name}" if re.match(r"\d", name) else name
    return f"{name}_ARM" if re.fullmatch(r"P\d+", name) else name or "ROBOT"


def questions(arm: Arm, given: Given, named: bool, base: bool, tip: bool) -> tuple[Question, ...]:
    """Return questions about unknown values of the robot. If one question depends on the answer to another,
    the other comes first.

    Args:
        arm: the URDF and its chain.
        given: the values that are already known.
        named: True if the name is known.
        base: True if the base is known.
        tip: True if the tip is known.
    """
    chain, size = arm.chain, len(arm.chain.joints)
    open_questions: list[Question] = []
    if not tip and (chain.other_tips or chain.flange_choices):
        others = ", ".join((*chain.other_tips, *chain.flange_choices)[:8])
        open_questions.append(Question("--tip", f"which link is {{FLANGE}} (others: {others})", chain.flange))
    if not base and chain.base_choices:
        others = ", ".join(chain.base_choices[:8])
        open_questions.append(Question("--base", f"which link is {{B}} (others: {others})", chain.base))
    if not named:
        open_questions.append(Question("--name", "the robot's name", proposed_name(arm.urdf)))
    each = f"one for all, or {size} with commas"
    if given.acceleration is None:
        text = f"accelerations in deg/s^2 or mm/s^2, {each}"
        open_questions.append(
            Question("--acceleration", text, f"the velocity limit in {RISE:g} s, by [ramps]")
        )
    if given.jerk is None:
        text = f"jerks in deg/s^3 or mm/s^3, {each}"
        open_questions.append(Question("--jerk", text, f"the acceleration limit in {EASE:g} s, by [ramps]"))
    if given.counts is None:
        open_questions.append(
            Question("--counts", f"encoder counts of a deg or mm, {each}", f"{COUNTS:,.0f}")
        )
    if given.tcp is None:
        text = (
            "TCP on the flange: x,y,z in mm, roll,pitch,yaw in deg (PICKPLACE and PALLET want its z "
            "back along the tool)"
        )
        rule = f"that of the link {chain.tcp}" if chain.tcp else "FLANGE itself"
        open_questions.append(Question("--tcp", text, rule))
    if given.home is None:
        text = f"the joint position HOME, {size} values in deg or mm"
        open_questions.append(Question("--home", text, "near 0, away from limits and singularities"))
    return tuple(open_questions)


def lost_meshes(arm: Arm, meshes: Iterable[Path], packages: Iterable[Path]) -> tuple[Diagnostic, ...]:
    """Return the finding about missing collision meshes; it is reported before the user is asked anything.

    Args:
        arm: the URDF and its chain.
        meshes: folders that meshes may come from, besides the URDF's own package.
        packages: folders with ROS packages that `package://` may name.
    """
    lookup = Lookup(arm.path, meshes, Packages(arm.path, packages))
    if missing := lookup.missing(arm.urdf):
        lookup.report(arm.urdf, missing)
    return tuple(one for one in arm.urdf.findings if one.is_error)


def make(
    arm: Arm,
    given: Given,
    name: str,
    title: str,
    chosen: tuple[bool, bool],
    meshes: Iterable[Path] = (),
    packages: Iterable[Path] = (),
    partial: bool = False,
) -> Result[NewRobot]:
    """Make the files of a new robot folder.

    Args:
        arm: the URDF and its chain.
        given: the known values; all other values follow from rules.
        name: name of the robot.
        title: one line about the robot.
        chosen: two flags. The first is True if the user chose the base, the second if the user chose the tip.
        meshes: folders that meshes may come from, besides the URDF's own package.
        packages: folders with ROS packages that `package://` may name.
        partial: True to leave out missing collision meshes; otherwise they are an error.
    """
    urdf_name = f"{re.sub(r'[^A-Za-z0-9_.-]', '_', arm.path.stem) or 'robot'}.urdf"
    sketched = sketch(arm.urdf, arm.chain, given, (name, title, urdf_name, arm.path.name), chosen)
    chain = screws(arm.urdf, arm.chain.base, arm.chain.flange, arm.chain.joints)
    if chain is None or has_errors(arm.urdf.findings):
        return Result(None, in_order(arm.urdf.findings))
    copy = copy_urdf(arm.urdf, arm.path, meshes, Packages(arm.path, packages), partial)
    if has_errors(arm.urdf.findings):
        return Result(None, in_order(arm.urdf.findings))
    proposed = homes(chain, sketched, given)
    toml = robot_toml(sketched, proposed[0])
    return Result(NewRobot(sketched, toml, copy, arm, proposed), in_order(arm.urdf.findings))
