"""`yarc man`."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("man")
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
def command(folder: Path) -> None:
    """Write the manual pages of yarc, yarcc and all commands into a folder.

    For yourself: yarc man ~/.local/share/man/man1, then man yarc-check.
    """
    from yarclang import __version__
    from yarclang.cli.manual import manual_pages
    from yarclang.cli.yarc import main as yarc
    from yarclang.cli.yarcc import main as yarcc
    from yarclang.files import reason_of, replace_file

    pages = {
        name: text
        for program, called in ((yarc, "yarc"), (yarcc, "yarcc"))
        for name, text in manual_pages(program, called, __version__)
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in pages.items():
            replace_file(folder / name, text.encode("utf-8"))
    except OSError as error:
        raise click.ClickException(f"{folder} can't be written: {reason_of(error)}") from None
    click.echo(f"{len(pages)} pages in {folder}: man yarc, man yarc-check")
