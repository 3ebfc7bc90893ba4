"""`yarc export`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from yarclang.cli.options import Numbers, PositiveNumber, cell_option, robot_option, tm_option
from yarclang.cli.outputs import STANDARD, beside, refuse_collisions

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.export.package import Package
    from yarclang.export.ros.exported import Exported
    from yarclang.export.ros.writing import Version

    Found = tuple[Diagnostic, ...]

_KINDS = {".yaml": "yaml", ".yml": "yaml", ".json": "json", ".bag": "bag"}


@click.command("export")
@click.option("--moveit", is_flag=True, help="Write MoveIt's configuration of a robot, a package of ROS.")
@click.option(
    "--driver",
    is_flag=True,
    help="Write the ROS nodes that serve MoveIt's goals, a package for ROS 1 and ROS 2.",
)
@click.option(
    "--ros",
    metavar="PROGRAM.yarc",
    type=click.Path(allow_dash=True),
    help="Write a program's certified motion as trajectory_msgs/JointTrajectory (- reads standard input).",
)
@click.option(
    "-o",
    "--output",
    metavar="OUT",
    help=(
        "The folder of --moveit or --driver, or a file .yaml, .json or .bag (- for YAML on standard output)."
    ),
)
@click.option(
    "--tolerance",
    type=PositiveNumber("T", least=1e-6, most=0.1),
    help=(
        "With --ros: allowed deviation of a driver from the certified path, in rad, or m for prismatic "
        "joints (default: 0.0001)."
    ),
)
@click.option(
    "--linear",
    is_flag=True,
    help="With --ros: keep the tolerance also for drivers that interpolate linearly.",
)
@click.option(
    "--ros-version",
    "version",
    type=click.Choice(["1", "2"]),
    help="With --ros: version of ROS whose field names are used (default: 2; 1 for a .bag).",
)
@click.option(
    "--start",
    type=Numbers("Q1,Q2,..."),
    help="With --ros: start position of the robot, as for yarcc.",
)
@click.option(
    "--overwrite",
    is_flag=True,
    help="Also overwrite files that no export has written, or that were changed since.",
)
@tm_option
@cell_option
@robot_option
def command(
    moveit: bool,
    driver: bool,
    ros: str | None,
    output: str | None,
    overwrite: bool,
    robot: str | None,
    **wanted: Any,
) -> None:
    """Export to ROS: MoveIt's configuration of a robot (--moveit), the nodes that move a served robot
    (--driver), or the certified motion of a program (--ros).

    A trajectory has as few waypoints as possible with which every driver that interpolates by cubics or
    quintics stays within the tolerance of the certified path. Actions between motions (SET, WAIT, HOLD, WHEN)
    are written beside the trajectories.
    """
    if moveit + driver + (ros is not None) != 1:
        raise click.UsageError("give one of --moveit, --driver and --ros PROGRAM.yarc")
    if ros is not None:
        _export_program(ros, output, overwrite, {"robot": robot, **wanted})
        return
    given = [f"--{name.replace('version', 'ros-version')}" for name, value in wanted.items() if value]
    if given:
        raise click.UsageError(f"{', '.join(given)}: only with --ros")
    if moveit:
        _export_robot(robot, output, overwrite=overwrite)
        return
    if robot is not None:
        raise click.UsageError(
            "--robot can't be used with --driver, whose nodes serve any robot: name the robot when "
            "starting them"
        )
    from yarclang.export.driver import driver_package

    _write_package(driver_package(), output, (), overwrite=overwrite)


def _export_program(file: str, output: str | None, overwrite: bool, wanted: dict[str, Any]) -> None:
    """Write the trajectories of a program."""
    from yarclang.cli.show import show_findings
    from yarclang.report.finding import count_text

    destination = output or beside(file, ".yaml")
    kind = _kind(destination)
    version: Version = 1 if wanted["version"] == "1" or (wanted["version"] is None and kind == "bag") else 2
    if kind == "bag" and version == 2:
        raise click.UsageError(
            ".bag is a format of ROS 1; for ROS 2 export .yaml or .json, or convert the bag with "
            "rosbags-convert"
        )
    refuse_collisions([file], [(destination, "the trajectories")])
    if output is None and not overwrite and destination != STANDARD and Path(destination).exists():
        raise click.UsageError(
            f"{destination} exists already; write elsewhere with -o, or replace it with --overwrite"
        )
    made, diagnostics = _trajectories(file, wanted)
    if made is not None:
        diagnostics += _written(made, kind, version, destination)
    show_findings(diagnostics)
    if made is None or any(one.is_error for one in diagnostics):
        name = "<stdin>" if file == STANDARD else file
        click.echo(f"{name}: {count_text(diagnostics) or 'no motion'}; nothing written", err=True)
        raise SystemExit(1)
    unit = "rad" if not made.robot.chain.is_prismatic.any() else "rad or m"
    several = "y" if made.size == 1 else "ies"
    click.echo(
        f"{made.size} trajector{several}, {len(made.points.time):,} waypoints, within {made.worst:.3g} "
        f"{unit} of the certified path by {', '.join(made.proved)} interpolation; written to "
        f"{'standard output' if destination == STANDARD else destination}",
        err=destination == STANDARD,
    )


def _trajectories(file: str, wanted: dict[str, Any]) -> tuple[Exported | None, Found]:
    """Return the trajectories of a program (None with an error), and findings."""
    from yarclang.cli.work import Progress, options_from
    from yarclang.export.ros.exported import Wishes, exported
    from yarclang.pipeline.checking import check_program_file

    planning = {name: wanted[name] for name in ("robot", "start", "tm", "cell")}
    with Progress():
        checked = check_program_file(file, options_from(planning))
        if checked.compiled is None:
            return None, checked.diagnostics
        made = exported(checked.compiled, Wishes(wanted["tolerance"] or 1e-4, wanted["linear"]))
    # leave out the program's warnings: they are reported when it is compiled
    return made.value, made.diagnostics


def _written(made: Exported, kind: str, version: Version, destination: str) -> Found:
    from yarclang.cli.work import write_standard_output, write_whole
    from yarclang.export.ros.writing import json_text, yaml_text

    if kind == "bag":
        content: str | bytes | Found = _bag(made)
        if isinstance(content, tuple):
            return content
    else:
        content = (json_text if kind == "json" else yaml_text)(made, version)
    if destination == STANDARD:
        return write_standard_output(content)
    return write_whole(Path(destination), content)


def _bag(made: Exported) -> bytes | Found:
    """Return the bytes of a ROS bag, or findings if it can't be created."""
    import tempfile

    from yarclang.diagnostics import Diagnostic
    from yarclang.export.ros.bag import write_bag

    try:
        with tempfile.TemporaryDirectory(prefix="yarc-export-") as folder:
            path = Path(folder) / "made.bag"
            write_bag(path, made)
            return path.read_bytes()
    except ImportError as error:
        message = f"a bag can't be written: the package rosbags isn't installed ({error})"
        help_ = "pip install 'yarclang[bags]'; or export .yaml or .json"
        return (Diagnostic("Y1533", message, help=help_),)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        message = f"{tempfile.gettempdir()}, the folder in which bags are written, can't be used: {reason}"
        return (Diagnostic("Y0107", message, help="make room there, or set TMPDIR"),)


def _kind(destination: str) -> Literal["yaml", "json", "bag"]:
    """Return the kind of file by its extension. An unknown extension is a usage error."""
    if destination == STANDARD:
        return "yaml"
    extension = Path(destination).suffix.lower()
    if extension not in _KINDS:
        wrong = f"{extension} can't be written" if extension else "the extension selects the file type"
        raise click.BadParameter(f"{wrong}; there are .yaml, .json and .bag", param_hint="-o")
    return _KINDS[extension]  # type: ignore[return-value]


def _export_robot(name: str | None, output: str | None, *, overwrite: bool) -> None:
    """Write MoveIt's configuration of a robot."""
    from yarclang.export.moveit.package import package_of
    from yarclang.pipeline.inputs import robot_for

    found = robot_for(Path.cwd(), name)
    diagnostics = found.diagnostics
    package: Package | None = None
    if found.value is not None:
        made = package_of(found.value)
        package, diagnostics = made.value, (*diagnostics, *made.diagnostics)
    _write_package(package, output, diagnostics, overwrite=overwrite)


def _write_package(
    package: Package | None, output: str | None, diagnostics: Found, *, overwrite: bool
) -> None:
    """Write an exported package as a folder, and report the findings. The package is None if findings
    forbid it.
    """
    from yarclang.cli.show import show_findings
    from yarclang.export.folder import judged, write_folder
    from yarclang.report.finding import count_text

    if package is not None:
        folder = Path(output or package.name)
        faults = judged(folder, package, overwrite=overwrite)
        diagnostics += faults or write_folder(folder, package)
        if not any(one.is_error for one in diagnostics):
            show_findings(diagnostics)
            click.echo(f"{len(package.files) + 1} files of {package.name} written to {folder}")
            return
    show_findings(diagnostics)
    click.echo(f"{count_text(diagnostics)}; nothing written", err=True)
    raise SystemExit(1)
