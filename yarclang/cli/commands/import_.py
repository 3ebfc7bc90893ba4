"""`yarc import`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.importing_meshes import import_cloud, import_heights
from yarclang.cli.options import PositiveNumber, robot_option
from yarclang.cli.outputs import STANDARD, beside, refuse_collisions
from yarclang.cli.parameter import ParamType

if TYPE_CHECKING:
    from yarclang.convert.course import Converted, Wishes
    from yarclang.diagnostics import Diagnostic
    from yarclang.units import Kind, Unit

    UnitsByKind = dict[Kind, Unit]

_CLOUDS = (".pcd", ".ply")
_HEIGHTS = (".npy", ".csv")
_TIME = re.compile(r"MIN|[0-9]+(\.[0-9]+)?%?", re.ASCII)


class _Units(ParamType["UnitsByKind"]):
    """Parser of units separated by commas, at most one of each kind."""

    name = "LENGTH,ANGLE,TIME"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> UnitsByKind:
        """Parse units and return them by kind. An unknown unit is a usage error."""
        from yarclang.units import UNITS

        if isinstance(value, dict):
            return value
        found: UnitsByKind = {}
        for word in str(value).split(","):
            unit = UNITS.get(word.strip().lower())
            if unit is None:
                self.fail(f"{word!r} isn't a unit; the units are {', '.join(UNITS)}", param, ctx)
            if unit.kind in found:
                self.fail(f"{value!r} has two units of {unit.kind}", param, ctx)
            found[unit.kind] = unit
        return found


class _Time(ParamType[str]):
    """Parser of a motion time, as in the square brackets of a command."""

    name = "TIME"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Parse MIN, a share such as 50%, or seconds."""
        text = str(value).upper()
        if not _TIME.fullmatch(text) or float(text.strip("MIN%") or 1) <= 0:
            self.fail(f"{value!r} must be MIN, a share such as 50%, or a number of seconds", param, ctx)
        return text


@click.command("import")
@click.argument("file", type=click.Path(allow_dash=True))
@click.option("-o", "--output", metavar="OUT.yarc", help="File for the program (- for standard output).")
@robot_option
@click.option(
    "--units", type=_Units(), help="Units of the columns that don't name theirs, as in mm,deg,s (tables)."
)
@click.option(
    "--joints", metavar="NAME,NAME,...", help="The file's names for the robot's joints, in the robot's order."
)
@click.option(
    "--as",
    "form",
    type=click.Choice(["moves", "spline", "timed"]),
    help=(
        "Stop at each target, pass all in one go, or pass each at its time (default: at its time if the "
        "file has joint values with times)."
    ),
)
@click.option(
    "--time",
    type=_Time(),
    help="Duration of the whole motion (MIN, 50% or seconds), instead of the file's times.",
)
@click.option(
    "--every",
    type=click.IntRange(min=1),
    metavar="N",
    default=1,
    help="Take only every N-th target; for a height field, join N by N cells.",
)
@click.option(
    "--tolerance",
    type=PositiveNumber("T"),
    help="Take as few targets as possible, so that the others stay within T (deg and mm) of the path.",
)
@click.option(
    "--topic",
    metavar="NAME",
    help="Topic to read from a bag. Joint states are read as a recorded motion.",
)
@click.option(
    "--voxel",
    type=PositiveNumber("MM"),
    help="Edge of the cubes that a point cloud becomes, in mm.",
)
@click.option(
    "--spacing",
    type=PositiveNumber("MM"),
    help="Spacing of the grid of a height field, in mm.",
)
def command(
    file: str,
    output: str | None,
    robot: str | None,
    units: UnitsByKind | None,
    joints: str | None,
    form: Any,
    time: str | None,
    every: int,
    tolerance: float | None,
    topic: str | None,
    voxel: float | None,
    spacing: float | None,
) -> None:
    """Make a YARC program from FILE: a CSV table, a ROS trajectory (YAML, JSON, or a bag), or an SRDF.

    FILE.csv becomes FILE.yarc; - reads standard input. Waypoints keep their times; long lists go into a CSV
    file beside the program. The program isn't planned: use yarc check. A point cloud, FILE.pcd or FILE.ply,
    becomes FILE.stl, a mesh for a cell.toml; so does a height field, FILE.npy, or FILE.csv with --spacing.
    """
    suffix = Path(file).suffix.lower()
    others = {
        "robot": robot,
        "joints": joints,
        "as": form,
        "time": time,
        "tolerance": tolerance,
        "topic": topic,
    }
    given = [f"--{name}" for name, value in others.items() if value is not None]
    if suffix in _CLOUDS:
        given += ["--spacing"] * (spacing is not None) + ["--every"] * (every > 1)
        if given:
            raise click.UsageError(f"{', '.join(given)}: not for a point cloud")
        import_cloud(file, output, units, voxel)
    if suffix == ".npy" or (suffix == ".csv" and spacing is not None):
        given += ["--voxel"] * (voxel is not None)
        if given:
            raise click.UsageError(f"{', '.join(given)}: not for a height field")
        import_heights(file, output, units, spacing, every)
    if spacing is not None:
        raise click.UsageError(f"--spacing is for height fields: files that end in {' or '.join(_HEIGHTS)}")
    if voxel is not None:
        raise click.UsageError(f"--voxel is for point clouds: files that end in {' or '.join(_CLOUDS)}")
    from yarclang.cli.show import show_findings
    from yarclang.convert.course import Wishes
    from yarclang.report.finding import count_text

    destination = beside(file, ".yarc") if output is None else output
    refuse_collisions([file], [(destination, "the program")])
    if output is None and destination != STANDARD and Path(destination).exists():
        raise click.UsageError(f"{destination} exists already; replace it, or write elsewhere, with -o")
    named = tuple(name.strip() for name in joints.split(",")) if joints is not None else ()
    if form == "timed" and time is not None:
        raise click.UsageError("--as timed keeps the file's times; leave --time out")
    beside_it = None
    if destination != STANDARD:
        beside_it = re.sub(r"[^\w .-]", "_", Path(destination).name.removesuffix(".yarc"))
    wishes = Wishes(units or {}, named, form, time, every, tolerance, beside_it, topic)
    made, diagnostics = _convert(file, robot, wishes)
    places: list[str] = []
    if made is not None:
        from yarclang.cli.work import write_standard_output, write_whole

        places = [str(Path(destination).parent / name) for name, _ in made.files]
        refuse_collisions([file], [(place, "a trajectory") for place in places])
        if output is None and (present := next((one for one in places if Path(one).exists()), None)):
            raise click.UsageError(f"{present} exists already; replace it, or write elsewhere, with -o")
        for place, (_, content) in zip(places, made.files, strict=True):
            diagnostics += write_whole(Path(place), content)
        diagnostics += (
            write_standard_output(made.text)
            if destination == STANDARD
            else write_whole(Path(destination), made.text)
        )
    show_findings(diagnostics)
    failed = any(one.is_error for one in diagnostics)
    if failed:
        click.echo(
            f"{'<stdin>' if file == STANDARD else file}: {count_text(diagnostics)}; nothing written", err=True
        )
    elif destination != STANDARD:
        click.echo(f"written to {' and '.join((destination, *places))}; plan it with yarc check")
    raise SystemExit(1 if failed else 0)


def _convert(file: str, robot: str | None, wishes: Wishes) -> tuple[Converted | None, tuple[Diagnostic, ...]]:
    from yarclang.convert.bag import is_bag
    from yarclang.convert.convert import convert, convert_bag
    from yarclang.pipeline.inputs import robot_for
    from yarclang.pipeline.sources import LARGEST_DATA, read_source

    if file != STANDARD and is_bag(Path(file)):
        owner = robot_for(Path(file).parent, robot)
        if owner.value is None:
            return None, owner.diagnostics
        of_bag = convert_bag(Path(file), owner.value, wishes)
        return of_bag.value, (*owner.diagnostics, *of_bag.diagnostics)
    if wishes.topic is not None:
        raise click.UsageError(
            "--topic is for bags: files that end in .bag, .db3 or .mcap, or the folder of one"
        )
    read = read_source(file, LARGEST_DATA)
    if read.value is None:
        return None, read.diagnostics
    found = robot_for(Path.cwd() if file == STANDARD else Path(file).parent, robot)
    if found.value is None:
        return None, found.diagnostics
    converted = convert(read.value, found.value, wishes)
    return converted.value, (*found.diagnostics, *converted.diagnostics)
