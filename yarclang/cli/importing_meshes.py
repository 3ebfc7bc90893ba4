"""Convert point clouds and height fields to meshes, for `yarc import`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

import click

from yarclang.cli.outputs import STANDARD, beside, refuse_collisions

if TYPE_CHECKING:
    from yarclang.diagnostics import Result
    from yarclang.units import Unit


class _Meshed(Protocol):
    """A file that was converted to a mesh."""

    @property
    def content(self) -> bytes:
        """Content of the binary STL file, in mm."""
        ...

    @property
    def left_out(self) -> int:
        """Number of values that were left out because they aren't numbers."""
        ...

    @property
    def triangles(self) -> int:
        """Number of triangles of the mesh."""
        ...


T = TypeVar("T", bound=_Meshed)


def import_cloud(
    file: str, output: str | None, units: Mapping[Any, Unit] | None, voxel: float | None
) -> NoReturn:
    """Convert a point cloud to a mesh, write it, print its line for a cell.toml, and exit.

    Args:
        file: a PCD or PLY file.
        output: path of the STL file; None for beside the input.
        units: units of the file's numbers; only a length is allowed.
        voxel: edge length of the cubes of which the mesh consists [mm].
    """
    from yarclang.convert.cloud import mesh_of_cloud
    from yarclang.units import MM

    if voxel is None:
        raise click.UsageError("a point cloud is converted to cubes: give their edge with --voxel MM")
    unit = _unit_of("a point cloud", units)
    destination = _destination("a point cloud", file, output)
    made = mesh_of_cloud(Path(file), unit, voxel * MM)
    found = _write(file, destination, made)
    _say(destination, found, f"{found.points:,} points", f"in {found.cubes:,} cubes of {voxel:g} mm")


def import_heights(
    file: str, output: str | None, units: Mapping[Any, Unit] | None, spacing: float | None, every: int
) -> NoReturn:
    """Convert a height field to a mesh, write it, print its line for a cell.toml, and exit.

    Args:
        file: an NPY or CSV file.
        output: path of the STL file; None for beside the input.
        units: units of the heights; only a length is allowed.
        spacing: distance of neighbouring heights [mm].
        every: edge length of a cell of the mesh, as a number of spacings.
    """
    from yarclang.convert.heights import mesh_of_heights
    from yarclang.units import MM

    if spacing is None:
        raise click.UsageError("a height field needs the spacing of its grid: give it with --spacing MM")
    unit = _unit_of("a height field", units)
    destination = _destination("a height field", file, output)
    made = mesh_of_heights(Path(file), unit, spacing * MM, every)
    found = _write(file, destination, made)
    rows, columns = found.size
    _say(destination, found, f"{rows:,} x {columns:,} heights", f"{spacing:g} mm apart")


def _unit_of(what: str, units: Mapping[Any, Unit] | None) -> float:
    """Return the unit of length [m] for a file that doesn't name its unit."""
    if units is None or set(units) != {"length"}:
        raise click.UsageError(f"{what} doesn't name its unit: give --units m, or --units mm")
    return units["length"].factor


def _destination(what: str, file: str, output: str | None) -> str:
    """Return the path of the mesh, after a check that it may be written."""
    destination = beside(file, ".stl") if output is None else output
    if destination != STANDARD and Path(destination).suffix.lower() != ".stl":
        raise click.UsageError(f"{destination}: the mesh of {what} is an .stl file")
    refuse_collisions([file], [(destination, "the mesh")])
    if output is None and Path(destination).exists():
        raise click.UsageError(f"{destination} exists already; replace it, or write elsewhere, with -o")
    return destination


def _write(file: str, destination: str, made: Result[T]) -> T:
    """Write a mesh and return its description. Exit if there is no mesh, or if it can't be written."""
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_standard_output, write_whole
    from yarclang.report.finding import count_text

    diagnostics = made.diagnostics
    if made.value is not None:
        content = made.value.content
        diagnostics += (
            write_standard_output(content)
            if destination == STANDARD
            else write_whole(Path(destination), content)
        )
    show_findings(diagnostics)
    if made.value is None or any(one.is_error for one in diagnostics):
        click.echo(f"{file}: {count_text(diagnostics)}; nothing written", err=True)
        raise SystemExit(1)
    return made.value


def _say(destination: str, found: _Meshed, what: str, how: str) -> NoReturn:
    """Print what was written and the line for a cell.toml, and exit."""
    left_out = f" ({found.left_out:,} left out, which aren't numbers)" if found.left_out else ""
    if destination != STANDARD:
        click.echo(
            f"written to {destination}: {what}{left_out} {how}, {found.triangles:,} triangles; "
            f'in a cell.toml: shape = "mesh", file = "{Path(destination).name}", units = "mm"'
        )
    raise SystemExit(0)
