"""`yarc import` of a point cloud."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from yarclang.cli.outputs import STANDARD, beside, refuse_collisions

if TYPE_CHECKING:
    from yarclang.units import Unit


def import_cloud(
    file: str, output: str | None, units: Mapping[Any, Unit] | None, voxel: float | None
) -> NoReturn:
    """Write the mesh of a point cloud, print its line for a cell.toml, and exit.

    Args:
        file: a PCD or PLY file.
        output: path of the STL file; None for beside the input.
        units: of the file's numbers; only a length is allowed.
        voxel: edge of a cube [mm].
    """
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import write_standard_output, write_whole
    from yarclang.convert.cloud import mesh_of_cloud
    from yarclang.report.finding import count_text
    from yarclang.units import MM

    if voxel is None:
        raise click.UsageError("a point cloud becomes cubes: --voxel MM says of which edge")
    if units is None or set(units) != {"length"}:
        raise click.UsageError("a point cloud doesn't say its unit: give --units m, or --units mm")
    destination = beside(file, ".stl") if output is None else output
    if destination != STANDARD and Path(destination).suffix.lower() != ".stl":
        raise click.UsageError(f"{destination}: the mesh of a point cloud is an .stl file")
    refuse_collisions([file], [(destination, "the mesh")])
    if output is None and Path(destination).exists():
        raise click.UsageError(f"{destination} is there already; write elsewhere, or over it, with -o")
    made = mesh_of_cloud(Path(file), units["length"].factor, voxel * MM)
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
    found = made.value
    left_out = f" ({found.left_out:,} left out, which are no numbers)" if found.left_out else ""
    if destination != STANDARD:
        click.echo(
            f"written to {destination}: {found.points:,} points{left_out} in {found.cubes:,} cubes of {voxel:g} mm, {found.triangles:,} triangles; "
            f'in a cell.toml: shape = "mesh", file = "{Path(destination).name}", units = "mm"'
        )
    raise SystemExit(0)
