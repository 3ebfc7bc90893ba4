"""`yarc doc`."""

from __future__ import annotations

import click


def _modules(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:  # noqa: ARG001  (click's signature)
    """Return the standard library's modules that begin with a text, for completion."""
    from yarclang.pipeline.modules import SUFFIX, library_folder

    names = sorted(path.stem.upper() for path in library_folder().glob(f"*{SUFFIX}"))
    return [name for name in names if name.startswith(incomplete.upper())]


@click.command("doc")
@click.argument("name", required=False, metavar="[MODULE]", shell_complete=_modules)
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "markdown"]),
    default="text",
    show_default=True,
    help="Output format of the reference.",
)
def command(name: str | None, form: str) -> None:
    """Print the reference of a module; without one, list the modules.

    The module is looked up in the working directory, then in the standard library.
    """
    from pathlib import Path

    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.modules import SUFFIX, library_folder, loader
    from yarclang.report.module_text import describe_module, module_listing, module_markdown, module_plain

    load = loader(Path())
    if name is None:
        names = sorted(path.stem.upper() for path in library_folder().glob(f"*{SUFFIX}"))
        loaded = [load(one).value for one in names]
        click.echo(module_listing([describe_module(module) for module in loaded if module is not None]))
        return
    read = load(name.upper())
    show_findings(read.diagnostics)
    if read.value is None:
        raise SystemExit(1)
    reference = describe_module(read.value)
    click.echo(module_markdown(reference) if form == "markdown" else module_plain(reference))
    raise SystemExit(1 if has_errors(read.diagnostics) else 0)
