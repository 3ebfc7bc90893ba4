"""`yarc robot new`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.options import Numbers
from yarclang.robot.joint_names import joint_number, listed_joints

if TYPE_CHECKING:
    from collections.abc import Iterator

    from yarclang.diagnostics import Diagnostic
    from yarclang.robot.new.folder import Arm, NewRobot, Question
    from yarclang.robot.new.sketch import Given

_EACH = "one for all joints, or one per joint"


@click.command("new")
@click.argument("urdf", type=click.Path(dir_okay=False))
@click.option(
    "-o", "--output", type=click.Path(), metavar="FOLDER", help="The folder to make (default: the name)."
)
@click.option("--name", metavar="NAME", help="The robot's name in programs.")
@click.option("--title", metavar="TEXT", help="One line about it.")
@click.option("--base", metavar="LINK", help="The link of the URDF that becomes {B}, the arm's base.")
@click.option("--tip", metavar="LINK", help="The link of the URDF that becomes {FLANGE}.")
@click.option(
    "--tcp", type=Numbers("X,Y,Z[,R,P,Y]", most=6), help="Pose of {TCP} relative to the flange: mm, deg."
)
@click.option("--home", type=Numbers("Q1,Q2,..."), help="The joint position HOME: deg, mm.")
@click.option(
    "--position",
    multiple=True,
    metavar="JOINT=LOW,HIGH",
    help="Position limits of a joint: deg, mm. Repeatable.",
)
@click.option(
    "--velocity", type=Numbers("V,...", positive=True), help=f"Velocity limits, deg/s, mm/s: {_EACH}."
)
@click.option("--acceleration", type=Numbers("A,...", positive=True), help=f"Acceleration limits: {_EACH}.")
@click.option("--jerk", type=Numbers("J,...", positive=True), help=f"Jerk limits: {_EACH}.")
@click.option("--counts", type=Numbers("K,..."), help=f"Encoder counts per deg or mm: {_EACH}.")
@click.option("--motors", type=Numbers("N,...", positive=True), help="The motors' numbers: one per joint.")
@click.option(
    "--meshes",
    multiple=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    metavar="FOLDER",
    help=(
        "Also look for meshes in this folder, by the last parts of their paths, and copy them (default: "
        "only from the "
        "URDF's own package). Repeatable."
    ),
)
@click.option(
    "--package-path",
    multiple=True,
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    metavar="FOLDER",
    help=(
        "Look for the ROS packages of package:// and $(find) here, then in ROS_PACKAGE_PATH and "
        "AMENT_PREFIX_PATH. Repeatable."
    ),
)
@click.option("--arg", multiple=True, metavar="NAME=VALUE", help="An argument of a xacro file. Repeatable.")
@click.option(
    "--allow-missing-meshes",
    is_flag=True,
    help="Leave out missing collision meshes. Collisions of their links won't be found.",
)
@click.option("-y", "--yes", is_flag=True, help="Don't ask questions; fill in missing values by rules.")
def command(urdf: str, yes: bool, output: str | None, **said: Any) -> None:
    """Make a robot's folder from a URDF: robot.toml and a copy of the URDF.

    The chain, its frames and limits come from the URDF. Missing values come from the options, from answers on
    a terminal, or from rules; each value from a rule has a comment with "guess:" in robot.toml.
    """
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import Diagnostic
    from yarclang.robot.new.folder import lost_meshes, make, open_arm, proposed_name, questions

    packages = _packages(said["package_path"])
    said["source"] = None
    if said["arg"] and Path(urdf).suffix.lower() != ".xacro":
        raise click.UsageError("--arg is for xacro files, which end in .xacro")
    if Path(urdf).suffix.lower() == ".xacro" and Path(urdf).is_file():
        from yarclang.cli.xacro import expanded

        said["source"] = expanded(Path(urdf), packages, _arguments(said["arg"]))
        if isinstance(said["source"], Diagnostic):
            show_findings((said["source"],))
            raise SystemExit(1)
    opened = open_arm(Path(urdf), said["base"], said["tip"], said["source"])
    if opened.value is None:
        show_findings(opened.diagnostics)
        raise SystemExit(1)
    arm = opened.value
    unknown = questions(arm, _given(arm, said), bool(said["name"]), bool(said["base"]), bool(said["tip"]))
    if yes and arm.chain.left_out:
        show_findings((arm.chain.incomplete(arm.urdf.source),))
        raise SystemExit(1)
    if not said["allow_missing_meshes"] and (lost := lost_meshes(arm, said["meshes"], packages)):
        show_findings(lost)
        raise SystemExit(1)
    if unknown and not yes:
        arm = _ask(arm, Path(urdf), said, unknown)
    name = said["name"] or proposed_name(arm.urdf)
    folder = Path(output or name.lower())
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise click.UsageError(f"{folder} exists already and isn't empty; write elsewhere with -o")
    title = said["title"] or f"Made of {arm.path.name}"
    ends = bool(said["base"]), bool(said["tip"])
    made = make(
        arm, _given(arm, said), name, title, ends, said["meshes"], packages, said["allow_missing_meshes"]
    )
    if made.value is None:
        show_findings(made.diagnostics)
        raise SystemExit(1)
    _write(folder, made.value)


def _packages(said: tuple[Path, ...]) -> tuple[Path, ...]:
    """Return the folders in which ROS packages are looked for: first those of the options, then those of ROS
    1, then those of ROS 2.
    """
    import os

    first, second = (
        [Path(one) for one in os.environ.get(name, "").split(os.pathsep) if one]
        for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH")
    )
    around = (*first, *(one / "share" for one in second))
    return (*said, *(one for one in around if one.is_dir()))


def _arguments(said: tuple[str, ...]) -> dict[str, str]:
    """Return the arguments of a xacro file by name. ROS's form NAME:=VALUE is also accepted."""
    found = {}
    for text in said:
        name, equals, value = text.partition("=")
        name = name.removesuffix(":").strip()
        if not equals or not name:
            raise click.UsageError(f"--arg {text!r} isn't NAME=VALUE")
        found[name] = value
    return found


def _given(arm: Arm, said: dict[str, Any]) -> Given:
    """Return the values of the options. A wrong number of values is a usage error."""
    from yarclang.robot.new.sketch import Given

    size = len(arm.chain.joints)
    for option in ("velocity", "acceleration", "jerk", "counts"):
        if said[option] is not None and len(said[option]) not in (1, size):
            raise click.UsageError(
                f"--{option} has {len(said[option])} values; give 1, or {size}: one a joint"
            )
    for option in ("home", "motors"):
        if said[option] is not None and len(said[option]) != size:
            raise click.UsageError(f"--{option} has {len(said[option])} values; give {size}: one a joint")
    if said["tcp"] is not None and len(said["tcp"]) not in (3, 6):
        raise click.UsageError(f"--tcp has {len(said['tcp'])} values; give x,y,z or x,y,z,roll,pitch,yaw")
    if said["counts"] is not None and 0.0 in said["counts"]:
        raise click.UsageError("--counts has a 0: a motor without counts can't move its joint")
    motors = said["motors"]
    if motors is not None and any(number != int(number) for number in motors):
        raise click.UsageError("--motors are integers")
    return Given(
        position=dict(_position(arm, text) for text in said["position"]),
        velocity=said["velocity"],
        acceleration=said["acceleration"],
        jerk=said["jerk"],
        counts=said["counts"],
        home=said["home"],
        tcp=None if said["tcp"] is None else (*said["tcp"], 0.0, 0.0, 0.0)[:6],
        motors=None if motors is None else tuple(int(number) for number in motors),
    )


def _position(arm: Arm, text: str) -> tuple[str, tuple[float, float]]:
    """Parse JOINT=LOW,HIGH."""
    name, _, values = text.partition("=")
    names = [joint.name for joint in arm.chain.joints]
    number = joint_number(names, name)
    if number is None:
        raise click.UsageError(f"--position {text!r}: the joints are {listed_joints(names)}")
    try:
        low, high = (float(value) for value in values.split(","))
    except ValueError:
        raise click.UsageError(f"--position {text!r} isn't JOINT=LOW,HIGH") from None
    if not -1e12 < low < high < 1e12:
        raise click.UsageError(f"--position {text!r}: the lower limit isn't below the upper one")
    return names[number], (low, high)


def _ask(arm: Arm, path: Path, said: dict[str, Any], unknown: tuple[Question, ...]) -> Arm:
    """Ask the user for unknown values, and add the answers to the options. Return the arm, since another tip
    or base gives another arm.
    """
    import sys

    from yarclang.cli.show import show_findings
    from yarclang.robot.new.folder import open_arm, questions

    if not sys.stdin.isatty():
        options = ", ".join(question.option for question in unknown)
        raise click.UsageError(f"questions need a terminal: give {options}, or --yes for the rules")
    click.echo(
        "Enter accepts the value in brackets; it comes from a rule, and is marked as a guess in robot.toml.",
        err=True,
    )
    asked: set[str] = set()
    while unknown:
        question = unknown[0]
        asked.add(question.option)
        key = question.option[2:]
        while True:
            text = click.prompt(f"{question.option}: {question.text}", default=question.rule, err=True)
            if text == question.rule:
                break
            before = said[key]
            try:
                said[key] = _read(key, text)
                opened = open_arm(path, said["base"], said["tip"], said["source"])
                if opened.value is not None:
                    arm = opened.value
                    _given(arm, said)
                    break
                show_findings(opened.diagnostics)
            except click.UsageError as error:
                click.echo(error.format_message(), err=True)
            said[key] = before
        still = questions(arm, _given(arm, said), bool(said["name"]), bool(said["base"]), bool(said["tip"]))
        unknown = tuple(one for one in still if one.option not in asked)
    return arm


def _read(key: str, text: str) -> Any:
    """Parse an answer in the same way as the value of the option."""
    if key in ("tip", "base", "name"):
        return text.strip()
    option = next(one for one in command.params if one.name == key)
    return option.type.convert(text, option, None)


def _write(folder: Path, made: NewRobot) -> None:
    """Write the folder, and report its content and missing parts."""
    from yarclang.cli.choosing_home import with_home
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_whole
    from yarclang.collision.checklist import flat_meshes, touching_pairs
    from yarclang.collision.scene import scene_of
    from yarclang.robot.bare_links import bare_links
    from yarclang.robot.checklist.geometry import tool_axis
    from yarclang.robot.description import load_robot
    from yarclang.robot.new.writing import collision_table, guesses

    files: list[tuple[Path, str | bytes]] = [(folder / name, content) for name, content in made.urdf.meshes]
    files += [(folder / made.sketch.urdf, made.urdf.text), (folder / "robot.toml", made.toml)]
    written: list[Path] = []
    for path, content in files:
        found = write_whole(path, content)
        if found:
            _undo(folder, written)
            show_findings(found)
            raise SystemExit(1)
        written.append(path)
    loaded = load_robot(str(folder))
    unreadable = scene_of(loaded.value, None).diagnostics if loaded.value is not None else ()
    if loaded.value is None or unreadable:
        show_findings((*loaded.diagnostics, *unreadable))
        _undo(folder, written)
        click.echo(f"no robot can be made from this URDF; {folder} wasn't written", err=True)
        raise SystemExit(1)
    made, robot, touched = with_home(made, loaded.value)
    toml = made.toml + collision_table(touching_pairs(robot))
    if toml != files[-1][1]:
        if found := write_whole(folder / "robot.toml", toml):
            show_findings(found)
            raise SystemExit(1)
        loaded = load_robot(str(folder))
    chain = made.sketch.chain
    joints = f"{len(chain.joints)} joint{'s' * (len(chain.joints) != 1)}"
    click.echo(f"{made.sketch.name}: {joints}, {chain.base} to {chain.flange}", err=True)
    flat = flat_meshes(loaded.value) if loaded.value is not None else ()
    for note in (
        *_notes(made),
        *touched,
        *(f"{one}: the collision check treats it as having no thickness" for one in flat),
    ):
        click.echo(f"  note: {note}", err=True)
    for item in tool_axis(loaded.value) if loaded.value is not None else ():
        click.echo(f"  note: {item.found}{f'; {item.remedy}' if item.remedy else ''}", err=True)
    bare = bare_links(loaded.value) if loaded.value is not None else ()
    show_findings((*_left_out(made), *loaded.diagnostics, *bare))
    click.echo(
        f"written to {folder}; {len(guesses(toml))} values are guesses: yarc robot check {folder}",
        err=True,
    )


def _left_out(made: NewRobot) -> tuple[Diagnostic, ...]:
    """Return the warning about missing collision meshes."""
    from yarclang.diagnostics import Diagnostic
    from yarclang.robot.checklist.item import listed

    without = made.urdf.without
    if not without:
        return ()
    each = listed([f"{mesh} of {link}" for link, mesh in without], 4)
    message = f"{len(without)} collision mesh{'es' * (len(without) != 1)} left out: {each}."
    remedy = (
        "Collisions of these links won't be found. Put the files beside the URDF, and make the robot again."
    )
    return (Diagnostic("Y1366", message, made.arm.urdf.source, help=remedy),)


def _undo(folder: Path, written: list[Path]) -> None:
    """Remove the files that were written."""
    for path in written:
        path.unlink(missing_ok=True)
    for place in sorted({folder, *(path.parent for path in written)}, reverse=True):
        if place.is_dir() and not any(place.iterdir()):
            place.rmdir()


def _notes(made: NewRobot) -> list[str]:
    """Return notes about what can't be seen in the folder."""
    from yarclang.robot.checklist.item import listed
    from yarclang.robot.new.copying import VISUALS
    from yarclang.robot.urdf import UNARMED

    chain, urdf = made.sketch.chain, made.urdf
    notes: list[str] = list(made.arm.notes)
    if chain.other_tips and not made.sketch.tip_said:
        notes.append(
            f"other chains of the same length end at {', '.join(chain.other_tips[:6])}: choose one with --tip"
        )
    if chain.fingers:
        notes.append(
            "finger joints aren't part of the arm: "
            f"{', '.join(chain.fingers[:6])}{', ...' * (len(chain.fingers) > 6)}"
        )
    if chain.followers:
        notes.append(
            "joints that follow another by <mimic> (rods, counterweights) are treated as fixed at 0: "
            f"{listed(chain.followers)}"
        )
    vehicle = [name for name in chain.ignored if made.arm.urdf.joints[name].kind in UNARMED]
    if vehicle:
        notes.append(f"planar and floating joints of a vehicle are treated as fixed: {listed(vehicle)}")
    others = [name for name in chain.ignored if name not in (*chain.fingers, *chain.followers, *vehicle)]
    if others:
        notes.append(
            f"moving joints off the chain are ignored: {', '.join(others[:6])}{', ...' * (len(others) > 6)}"
        )
    drawn = sum(name.startswith(VISUALS) for name, _ in urdf.meshes)
    for what, count in (("collision", len(urdf.meshes) - drawn), ("visual", drawn)):
        if count:
            notes.append(f"{count} {what} mesh{'es' * (count != 1)} copied")
    if urdf.hulls:
        notes.append(
            "large collision meshes are replaced by their convex hulls, which the collision check uses "
            "anyway: "
            f"{listed(urdf.hulls)}"
        )
    return [*notes, *_unseen(urdf.unseen)]


def _unseen(meshes: tuple[tuple[str, str], ...]) -> Iterator[str]:
    """Yield a note for each reason why visual meshes aren't copied.

    Args:
        meshes: name of each mesh, and the reason why it isn't copied.
    """
    from yarclang.robot.checklist.item import listed

    for reason in dict.fromkeys(why for _, why in meshes):
        names = [name for name, why in meshes if why == reason]
        what = "the visual mesh" if len(names) == 1 else f"{len(names)} visual meshes:"
        missing = reason == "isn't there"
        said = "aren't there" if missing and len(names) > 1 else reason
        where = "; give the folder with --package-path or --meshes" if missing else ""
        yield (
            f"{what} {listed(names, 3)} {said}: pictures show the collision shapes of such links, "
            f"or bars from joint to joint if no link has a shape{where}"
        )
