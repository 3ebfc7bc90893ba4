"""`yarc reach`."""

from __future__ import annotations

from pathlib import Path

import click

from yarclang.cli.options import jobs_option, robot_argument, scheduler_option


@click.command("reach")
@robot_argument("robots", nargs=-1, metavar="[FOLDER|robot.toml|NAME]...")
@click.option(
    "-o", "--output", metavar="OUT", help="The picture, a .png (default: NAME.reach.png in this folder)."
)
@click.option(
    "--out-dir",
    type=click.Path(file_okay=False, path_type=Path),
    metavar="DIR",
    help="Folder for the pictures (default: this folder).",
)
@jobs_option
@scheduler_option
def command(
    robots: tuple[str, ...], output: str | None, out_dir: Path | None, jobs: int | None, scheduler: str
) -> None:
    """Draw where robots can hold their flanges, and in how many orientations, from the side and from above.

    The picture shows errors of a URDF: with missing joints there are few orientations, or a thin shell.
    """
    names = tuple(dict.fromkeys(robots)) or (".",)
    if output is not None and not output.lower().endswith(".png"):
        raise click.BadParameter("only .png can be drawn", param_hint="-o")
    if output is not None and (out_dir is not None or len(names) > 1):
        raise click.UsageError("-o names one picture: use --out-dir for several")
    destinations = _destinations(names, output, out_dir or Path())
    from yarclang.cli.fleet import Fleet
    from yarclang.cli.pictures import draw_robots, put
    from yarclang.cli.work import Progress

    failed = len(destinations) < len(names)
    with Progress() as progress:
        made = draw_robots(list(destinations), Fleet(jobs, scheduler))
        for number, (destination, drawn) in enumerate(zip(destinations.values(), made, strict=True), 1):
            progress.pause()
            failed |= not put(drawn, destination)
            progress.file(number, len(destinations))
    if failed:
        raise SystemExit(1)


def _destinations(names: tuple[str, ...], output: str | None, folder: Path) -> dict[str, str]:
    """Return the path of the picture for each robot. If a robot can't be read, show the findings and leave it
    out.

    Raises:
        click.UsageError: two robots have the same name.
    """
    from yarclang.cli.show import show_findings
    from yarclang.robot.description import load_robot

    found: dict[str, str] = {}
    for name in names:
        loaded = load_robot(name)
        if loaded.value is None:
            show_findings(loaded.diagnostics)
            continue
        destination = output or str(folder / f"{loaded.value.name.lower()}.reach.png")
        if destination in found.values():
            raise click.UsageError(
                f"two robots are named {loaded.value.name}: draw them into different folders"
            )
        found[name] = destination
    return found
